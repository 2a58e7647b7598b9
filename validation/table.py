"""A row of evidence: what another source says, what gbeam says, and whether they agree."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

AGREES, DIFFERS, EXPLAINED, NOT_COMPARED = "agrees", "DIFFERS", "differs", "not compared"


@dataclass(frozen=True)
class Row:
    """One quantity of one case.

    Parameters
    ----------
    case, quantity, unit
        What was computed. `unit` is "" or "–" for a pure number.
    reference, ours
        Numbers in `unit`. Text is shown as it stands and read as a number ("0.020", as printed). None where there is
        none: not legible, or nothing like it in gbeam; then `remark` says why.
    tolerance
        Largest difference that counts as agreement, as a fraction of the reference; of 1 `unit` where that is zero.
    source
        Where the reference comes from: a code and its model, or a paper with its table or equation.
    remark
        Why they differ, or what decides the tolerance. A difference above the tolerance needs one.
    """

    case: str
    quantity: str
    reference: float | str | None
    ours: float | str | None
    unit: str
    tolerance: float
    source: str
    remark: str = ""

    def __post_init__(self) -> None:
        if self.tolerance < 0:
            raise ValueError(f"{self.case}, {self.quantity}: tolerance {self.tolerance} is negative")
        if self.difference is None and not self.remark:
            raise ValueError(f"{self.case}, {self.quantity}: nothing to compare, and no remark says why")

    @property
    def difference(self) -> float | None:
        """(ours − reference)/|reference|, or ours where the reference is zero; None without both numbers."""
        if self.reference is None or self.ours is None:
            return None
        reference, ours = float(self.reference), float(self.ours)
        return (ours - reference) / (abs(reference) or 1.0)

    @property
    def verdict(self) -> str:
        """AGREES, EXPLAINED by its remark, DIFFERS without one, or NOT_COMPARED."""
        if self.difference is None:
            return NOT_COMPARED
        if abs(self.difference) <= self.tolerance:
            return AGREES
        # NaN agrees with nothing, and no remark excuses it.
        return EXPLAINED if self.remark and math.isfinite(self.difference) else DIFFERS

    def numbers(self) -> tuple[str, str]:
        """Reference and ours, with as many digits as show their difference, four to seven, and as text has."""
        digits = 4
        if isinstance(self.reference, str):
            digits = max(digits, len(re.sub(r"\D", "", self.reference.split("e")[0]).lstrip("0")))
        if self.reference is not None and float(self.reference) == 0:
            digits = 2  # ours is all error
        elif self.difference:
            digits = min(max(digits, 2 - math.floor(math.log10(abs(self.difference)))), 7)
        shown = [
            "–" if value is None else value if isinstance(value, str) else significant(value, digits)
            for value in (self.reference, self.ours)
        ]
        return shown[0], shown[1]

    def deviation(self) -> str:
        """The difference in words: percent, or in `unit` where the reference is zero."""
        if self.difference is None:
            return "–"
        if float(self.reference or 0) == 0:
            return f"{self.difference:+.1e}"
        return f"{100 * self.difference:+.2g} %"


def significant(value: float, digits: int) -> str:
    """A number with so many significant digits, zeros at the end included."""
    if value == 0 or not math.isfinite(value):
        return f"{value:g}"
    power = math.floor(math.log10(abs(value)))
    if -4 <= power < 7:
        return f"{value:.{max(digits - 1 - power, 0)}f}"
    return f"{value:.{digits - 1}e}"
