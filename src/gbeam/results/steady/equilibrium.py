"""Where a beam rests while its base moves steadily: a frozen record."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from gbeam.results.parts.errors import Errors
from gbeam.results.parts.section_forces import Loads
from gbeam.results.response import BaseMotion
from gbeam.results.result import Figured, Floats


@dataclass(frozen=True, repr=False, eq=False)
class Deflection(Figured):
    """Relative equilibrium at a frozen base motion.

    Parameters
    ----------
    motion, model : str
    time : float
        s.
    base : BaseMotion
        At that time, (3,).
    stations : (s,) m, the last is the tip
    displacement : (s, 3)
        Relative to the base axes, m.
    q : (n,)
        Coordinates.
    strain_energy : float
        J.
    stable : bool
        Whether the stiffness about the equilibrium is positive definite; under loads that follow the beam, whether no
        vibration about it grows.
    loads : Loads or None
        What the sections carry, of one time.
    errors : Errors
        Of displacement, root loads and stress; there are no time steps.
    """

    motion: str
    model: str
    time: float
    base: BaseMotion
    stations: Floats
    displacement: Floats
    q: Floats
    strain_energy: float
    stable: bool
    loads: Loads | None = None
    errors: Errors = field(default_factory=Errors)

    @property
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
