"""Where a beam rests while its base moves steadily, and where it no longer can: frozen records."""

from __future__ import annotations

from dataclasses import dataclass

from gbeam.results.response import BaseMotion
from gbeam.results.result import Figured, Floats, Result, brief
from gbeam.results.section_forces import Loads


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
        Whether the stiffness about the equilibrium is positive definite.
    loads : Loads or None
        What the sections carry, of one time.
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

    @property
    def tip(self) -> Floats:
        """Displacement of the tip, (3,) m."""
        return self.displacement[-1]

    def __repr__(self) -> str:
        of = f" {self.motion!r}" if self.motion else ""
        tip = ", ".join(f"{1e3 * each:.4g}" for each in self.tip)
        rest = "stable" if self.stable else "NOT stable: the stiffness is not positive definite"
        return f"Deflection{of} ({self.model}) at {self.time:.4g} s: tip ({tip}) mm; {rest}"


@dataclass(frozen=True, repr=False, eq=False)
class Critical(Result):
    """Where the stiffness about the relative equilibrium stops being positive definite, or something grows.

    Parameters
    ----------
    quantity, unit : str
        What was raised: ``hub rate``, rad/s; ``acceleration along x``, m/s²; or ``load factor``, times the loads.
    value : float or None
        None where it is not reached.
    searched_to : float
        End of the search.
    kind : str
        ``divergence``, ``flutter``, ``no equilibrium`` or ``none``.
    direction : str
        Of the mode that is lost; empty where there is none.
    reason : str
        The answer as a sentence.
    model : str
    """

    quantity: str
    unit: str
    value: float | None
    searched_to: float
    kind: str
    direction: str
    reason: str
    model: str

    def __repr__(self) -> str:
        value = f"none up to {self.searched_to:.6g}" if self.value is None else f"{self.value:.6g}"
        return f"Critical {self.quantity} ({self.model}): {value} {self.unit}\n  {self.reason}"


@dataclass(frozen=True, repr=False, eq=False)
class CriticalMap(Figured):
    """Critical hub rates against a mass on the beam and its position.

    Parameters
    ----------
    motion, model : str
    mass : (m,) kg
    position : (p,) m from the root
    speed : (m, p) rad/s; NaN where it is not reached
    searched_to : float
        rad/s.
    """

    motion: str
    model: str
    mass: Floats
    position: Floats
    speed: Floats
    searched_to: float

    def __repr__(self) -> str:
        return brief(self)
