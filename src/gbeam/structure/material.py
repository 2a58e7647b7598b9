"""What a beam is made of."""

from __future__ import annotations

from dataclasses import dataclass

from gbeam.guards.checks import positive
from gbeam.guards.plausibility import possible

FATIGUE_EXPONENT = 5.0


@dataclass(frozen=True)
class Material:
    """Linear elastic material.

    Parameters
    ----------
    density : float
        Mass per volume, kg/m³.
    youngs_modulus : float
        Pa.
    yield_strength : float, optional
        Normal stress at which it yields, in tension and in compression, Pa.
    fatigue_exponent : float
        m of Wöhler's curve, N Δσᵐ = constant. The default is a convention between those of welded joints, about 3, and
        of smooth parts, about 10.

    Raises
    ------
    InputError
        If a value is not positive and finite.
    """

    density: float
    youngs_modulus: float
    yield_strength: float | None = None
    fatigue_exponent: float = FATIGUE_EXPONENT

    def __post_init__(self) -> None:
        possible("density", "density", positive("density", self.density, "kg/m³"))
        possible("youngs_modulus", "modulus", positive("youngs_modulus", self.youngs_modulus, "Pa"))
        if self.yield_strength is not None:
            positive("yield_strength", self.yield_strength, "Pa")
        positive("fatigue_exponent", self.fatigue_exponent, "(a number)")
