"""Materials of a beam."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from gbeam.arrays.namespace import is_jax
from gbeam.arrays.tree import Value
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import finite, positive
from gbeam.guards.ranges import possible

FATIGUE_EXPONENT = 5.0
ASSUMED_RATIO = 0.3  # Poisson's, of metals


@typed
@dataclass(frozen=True, eq=False)
class Material(Value):
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
    poissons_ratio : float, optional
        Of bending plates and in the stated error of the beam theory, where 0.3 is assumed if it is left out.
    shear_modulus : float, optional
        Pa, in the stated error of the beam theory; left out, that of an isotropic material, E/(2 (1 + ν)).

    Raises
    ------
    InputError
        If a value is not positive and finite, or Poisson's ratio not between -1 and 0.5.

    Examples
    --------
    >>> aluminium = gb.Material(density=2700, youngs_modulus=70e9, poissons_ratio=0.33)
    >>> print(f"{aluminium.rigidity:.4g} Pa")
    2.632e+10 Pa
    """

    density: float
    youngs_modulus: float
    yield_strength: float | None = None
    fatigue_exponent: float = FATIGUE_EXPONENT
    poissons_ratio: float | None = None
    shear_modulus: float | None = None

    def __post_init__(self) -> None:
        possible("density", "density", positive("density", self.density, "kg/m³"))
        possible("youngs_modulus", "modulus", positive("youngs_modulus", self.youngs_modulus, "Pa"))
        if self.yield_strength is not None:
            positive("yield_strength", self.yield_strength, "Pa")
        positive("fatigue_exponent", self.fatigue_exponent, "(a number)")
        if self.shear_modulus is not None:
            possible("shear_modulus", "modulus", positive("shear_modulus", self.shear_modulus, "Pa"))
        ratio = self.poissons_ratio
        if ratio is not None and not is_jax(ratio) and not -1 < finite("poissons_ratio", ratio) <= 0.5:
            fix = "no isotropic material has one outside -1 to 0.5: give one such as 0.3"
            raise InputError("poissons_ratio", f"is {ratio:g}", fix)

    @property
    def ratio(self) -> Any:
        """Poisson's ratio, 0.3 where it is not given."""
        return ASSUMED_RATIO if self.poissons_ratio is None else self.poissons_ratio

    @property
    def rigidity(self) -> Any:
        """Shear modulus, Pa: as given, or that of an isotropic material."""
        isotropic = self.youngs_modulus / (2 * (1 + self.ratio))
        return isotropic if self.shear_modulus is None else self.shear_modulus
