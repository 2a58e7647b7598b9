"""Where a beam rests while its base moves steadily: a frozen record."""

from __future__ import annotations

import math
from dataclasses import dataclass

from gbeam.results.declared import declared, fact, part, quantity
from gbeam.results.parts.errors import Errors
from gbeam.results.parts.section_forces import Loads
from gbeam.results.response import BaseMotion
from gbeam.results.result import Figured, Floats


@dataclass(frozen=True, repr=False, eq=False)
class Deflection(Figured):
    """Relative equilibrium at a frozen base motion."""

    motion: str = fact("name of the motion", key=None)
    model: str = fact("kind of the model")
    time: float = fact("time at which the motion is frozen", "s")
    base: BaseMotion = part("motion of the base at that time")
    stations: Floats = quantity(
        "m", "position along the beam from the root", "station", role="coordinate", note="the last is the tip"
    )
    displacement: Floats = quantity("m", "displacement relative to the base axes", "station", "axis")
    q: Floats = quantity(
        lambda self: "" if self.model == "exact" else "m",
        "generalised coordinates of the beam",
        "coordinate",
        name="coordinates",
        key=None,
    )
    strain_energy: float = quantity("J", "strain energy")
    stable: bool = fact(
        "whether the stiffness about the equilibrium is positive definite",
        note="under loads that follow the beam, whether no vibration about it grows",
    )
    loads: Loads | None = part("forces, moments and stresses of the sections, of one time",
                               name=None, key=None, default=None)  # fmt: skip
    errors: Errors = part("of displacement, root loads and stress", name=None, default_factory=Errors)

    @property
    @declared("m", "displacement of the tip relative to the base axes", "axis", name=None)
    def tip(self) -> Floats:
        """Displacement of the tip, (3,) m."""
        return self.displacement[-1]

    def __repr__(self) -> str:
        of = f" {self.motion!r}" if self.motion else ""
        tip = ", ".join(f"{1e3 * each:.4g}" for each in self.tip)
        rest = "stable" if self.stable else "NOT stable: no beam would stay there"
        total = self.errors.displacement.total
        error = f"; estimated error {100 * total:.2g} %" if math.isfinite(total) else ""
        return self._with_warnings(f"Deflection{of} ({self.model}) at {self.time:.4g} s: tip ({tip}) mm{error}; {rest}")
