"""What a beam is made of."""

from __future__ import annotations

from dataclasses import dataclass

from gbeam.checks import positive


@dataclass(frozen=True)
class Material:
    """Linear elastic material.

    Parameters
    ----------
    density : float
        Mass per volume, kg/m³.
    youngs_modulus : float
        Pa.

    Raises
    ------
    InputError
        If a value is not positive and finite.
    """

    density: float
    youngs_modulus: float

    def __post_init__(self) -> None:
        positive("density", self.density, "kg/m³")
        positive("youngs_modulus", self.youngs_modulus, "Pa")
