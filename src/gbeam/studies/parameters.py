"""The physical values of a scenario that answers can be differentiated with respect to."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from gbeam.errors import InputError
from gbeam.scenario.schema.common.quantities import quantities
from gbeam.scenario.schema.scenario import Scenario
from gbeam.scenario.values.kinds import KINDS
from gbeam.scenario.values.suggest import advise

# Values of the computation, not of what is computed.
_FIXED = {
    r"response\.(?!initial\.)": "is a setting of the computation, which stays as it is while one differentiates",
    r"motion\.[\w-]+\.accept\.": "is a limit of acceptance, which changes no response",
    r"motion\.[\w-]+\.commands\.": "is the controller's sample time, which changes no response",
}
# Not among the default choice: lists of points, and limits, of which a motion may use none.
_UNUSUAL = re.compile(r"\.(times|values|stations)\[|\.limits\.|\.record\.|fatigue_exponent")
_AT_TIP = re.compile(r"(\.at|stations\[\d+\]|\.control_point)$")
LENGTH = "beam.length"


@dataclass(frozen=True)
class PhysicalValue:
    """A number in a scenario.

    Parameters
    ----------
    path : str
        Its key, such as ``beam.material.youngs_modulus``.
    value : float
        SI.
    kind : str
        Of quantity, a key of ``KINDS``.
    followers : tuple of str
        Positions at the tip, which move with the beam's length.
    """

    path: str
    value: float
    kind: str
    followers: tuple[str, ...] = ()

    def overrides(self, value: float) -> tuple[str, ...]:
        """Changes of the scenario that give it another value."""
        return tuple(f"{path}={float(value)!r}" for path in (self.path, *self.followers))

    @property
    def unit(self) -> str:
        """SI unit; empty for a plain number."""
        return KINDS[self.kind].unit

    @property
    def of_motion(self) -> str:
        """Name of the motion that it belongs to; empty for the beam's."""
        first, _, rest = self.path.partition(".")
        return rest.partition(".")[0] if first == "motion" else ""


def physical_values(scenario: Scenario, names: Sequence[str] = ()) -> list[PhysicalValue]:
    """The values of those names; without names every one that is not zero.

    Raises
    ------
    InputError
        If a name is no physical value of the scenario.
    """
    every = quantities(scenario)
    if not names:
        usual = [
            path
            for path, (value, _) in every.items()
            if value and not _UNUSUAL.search(path) and _why_fixed(path) is None
        ]
        return [_made(path, every) for path in usual]
    for k, name in enumerate(names):
        if name in names[:k]:
            raise InputError("--with", f"names {name} twice", "name each value once")
        if name not in every:
            possible = [path for path in every if _why_fixed(path) is None]
            fix = advise(name, possible, listed="the scenario has")
            raise InputError("--with", f"{name!r} is no physical value that the scenario gives", fix)
        if (why := _why_fixed(name)) is not None:
            raise InputError("--with", f"{name} {why}", "leave it out, or compare runs by gbeam sweep")
    return [_made(name, every) for name in names]


def _made(path: str, every: dict[str, tuple[float, str]]) -> PhysicalValue:
    value, kind = every[path]
    return PhysicalValue(path, value, kind, tuple(_at_tip(every)) if path == LENGTH else ())


def _at_tip(every: dict[str, tuple[float, str]]) -> Iterable[str]:
    length, _ = every[LENGTH]
    return (path for path, (value, _) in every.items() if value == length and _AT_TIP.search(path))


def _why_fixed(path: str) -> str | None:
    return next((why for pattern, why in _FIXED.items() if re.match(pattern, path)), None)
