"""Materials of beams and of solids."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from gbeam.arrays.namespace import is_jax
from gbeam.arrays.tree import Value
from gbeam.arrays.types import Numbers
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.quantities import Density, Factor, Modulus, Quantity, Ratio, Shape, Strength

FATIGUE_EXPONENT = 5.0
ASSUMED_RATIO = 0.3  # Poisson's, of metals
NEARLY_INCOMPRESSIBLE = 0.495
Moduli = Annotated[Numbers, Quantity("pressure", "positive", "modulus"), Shape((3,))]


@typed
@dataclass(frozen=True, eq=False)
class Material(Value):
    """Linear elastic material.

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

    density: Annotated[Density, "mass per volume"]
    youngs_modulus: Annotated[Modulus, "Young's modulus"]
    yield_strength: Annotated[
        Strength | None,
        "normal stress at which it yields, in tension and in compression; with it results give the margin",
    ] = None
    fatigue_exponent: Annotated[
        Factor, "m of Wöhler's curve, N Δσᵐ = constant: about 3 for welds, 10 for smooth parts; 5 where left out"
    ] = FATIGUE_EXPONENT
    poissons_ratio: Annotated[
        Ratio | None, "of plates, and for the stated error, where 0.3 is taken if it is left out"
    ] = None
    shear_modulus: Annotated[
        Modulus | None,
        "of twist and shear, in exact and in the stated error; that of an isotropic material, E/(2 (1 + ν)), where "
        "left out",
    ] = None

    expansion: Annotated[
        Annotated[float, Quantity("expansion")] | None,
        "strain by a kelvin; of bodies that have a temperature",
    ] = None

    def __post_init__(self) -> None:
        ratio = self.poissons_ratio
        if ratio is not None and not is_jax(ratio) and not -1 < ratio <= 0.5:
            fix = "no isotropic material has one outside -1 to 0.5: give one such as 0.3"
            raise InputError("poissons_ratio", f"is {ratio:g}", fix)

    @property
    def thermal_strain(self) -> Any:
        """Strain (3, 3) by a kelvin; an InputError where the expansion is missing."""
        if self.expansion is None:
            raise _no_expansion("expansion", '"23e-6 1/K"')
        return self.expansion * np.eye(3)

    @property
    def ratio(self) -> Any:
        """Poisson's ratio, 0.3 where it is not given."""
        return ASSUMED_RATIO if self.poissons_ratio is None else self.poissons_ratio

    @property
    def rigidity(self) -> Any:
        """Shear modulus, Pa: as given, or that of an isotropic material."""
        return isotropic(self) if self.shear_modulus is None else self.shear_modulus

    @property
    def elasticity(self) -> Any:
        """Stresses (6, 6) Pa of unit strains xx, yy, zz, yz, xz, xy in a solid, with twice the tensor's shear; an
        InputError where Poisson's ratio is missing, or the material is not isotropic and compressible.
        """
        if self.poissons_ratio is None:
            raise InputError("poissons_ratio", "is missing, and a solid needs it", "give one such as 0.3")
        if self.shear_modulus is not None and not np.isclose(self.shear_modulus, isotropic(self), rtol=1e-3):
            fix = "leave it out, or give a gb.Orthotropic"
            raise InputError("shear_modulus", f"is {self.shear_modulus:g} Pa, not E/(2 (1 + ν))", fix)
        if self.poissons_ratio > NEARLY_INCOMPRESSIBLE:
            fix = f"give at most {NEARLY_INCOMPRESSIBLE:g}: elements of displacements alone lock beyond"
            raise InputError("poissons_ratio", f"is {self.poissons_ratio:g}", fix)
        shear, ratio = isotropic(self), self.poissons_ratio
        elasticity = np.diag([2 * shear] * 3 + [shear] * 3)
        elasticity[:3, :3] += 2 * shear * ratio / (1 - 2 * ratio)
        return elasticity


def _no_expansion(name: str, such: str) -> InputError:
    """Error about the key `name` of a material without expansion."""
    return InputError(name, "is missing, and the body has a temperature", f"give it, such as {such}")


def isotropic(material: Material) -> Any:
    """Shear modulus of an isotropic material, Pa."""
    return material.youngs_modulus / (2 * (1 + material.ratio))


@typed
@dataclass(frozen=True, eq=False)
class Orthotropic(Value):
    """Linear elastic material with three planes of symmetry, such as a laminate: of solids.

    Raises
    ------
    InputError
        If a value is not positive, the axes are not perpendicular, or some strain has no energy.

    Examples
    --------
    >>> board = gb.Orthotropic(
    ...     density=1900,
    ...     youngs_moduli=(22e9, 22e9, 10e9),
    ...     poissons_ratios=(0.15, 0.3, 0.3),
    ...     shear_moduli=(5e9, 3e9, 3e9),
    ...     axes=((1, 0, 0), (0, 1, 0)),
    ... )
    >>> print(f"{board.elasticity[3, 3]:.3g} Pa")
    3e+09 Pa
    """

    density: Annotated[Density, "mass per volume"]
    youngs_moduli: Annotated[Moduli, "along its axes 1, 2 and 3"]
    poissons_ratios: Annotated[
        Annotated[Numbers, Quantity("ratio"), Shape((3,))],
        "ν12, ν23 and ν13: contraction along the second axis by a pull along the first",
    ]
    shear_moduli: Annotated[Moduli, "G12, G23 and G13"]
    axes: Annotated[
        Annotated[ArrayLike, Quantity("ratio"), Shape((2, 3))], "directions of its axes 1 and 2, in axes of the mesh"
    ] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    expansions: Annotated[
        Annotated[Numbers, Quantity("expansion"), Shape((3,))] | None,
        "strains along its axes 1, 2 and 3 by a kelvin; of bodies that have a temperature",
    ] = None
    yield_strength: ClassVar[None] = None
    fatigue_exponent: ClassVar[float] = FATIGUE_EXPONENT

    def __post_init__(self) -> None:
        """Refuse axes that are not perpendicular, and moduli and ratios with which a strain has no energy."""
        for name in ("youngs_moduli", "poissons_ratios", "shear_moduli", "expansions"):
            if getattr(self, name) is not None and len(getattr(self, name)) != 3:
                raise InputError(name, f"has {len(getattr(self, name))} values", "give three")
        axes = np.asarray(self.axes, dtype=float)
        lengths = np.linalg.norm(axes, axis=1) if axes.shape == (2, 3) else np.zeros(2)
        if not np.all(lengths):
            raise InputError("axes", f"is {self.axes!r}", "give two directions, such as ((1, 0, 0), (0, 1, 0))")
        if abs(axes[0] @ axes[1]) > 1e-6 * lengths.prod():
            raise InputError("axes", "are not perpendicular", "give the directions of the material's axes 1 and 2")
        if not (np.linalg.eigvalsh(self._compliance) > 0).all():
            fix = "ν12² is below E1/E2, and so are the others: are they ν12, ν23 and ν13?"
            raise InputError("poissons_ratios", "leave a strain without energy", fix)

    @property
    def _compliance(self) -> Any:
        """Compliance matrix: strains (6, 6) of unit stresses xx, yy, zz, yz, xz, xy, in the material's own axes."""
        (e1, e2, e3), (v12, v23, v13), (g12, g23, g13) = self.youngs_moduli, self.poissons_ratios, self.shear_moduli
        compliance = np.diag([1 / e1, 1 / e2, 1 / e3, 1 / g23, 1 / g13, 1 / g12])
        compliance[0, 1] = compliance[1, 0] = -v12 / e1
        compliance[1, 2] = compliance[2, 1] = -v23 / e2
        compliance[0, 2] = compliance[2, 0] = -v13 / e1
        return compliance

    @property
    def _columns(self) -> Any:
        """Directions (3, 3) of its axes, in columns."""
        first, second = (axis / np.linalg.norm(axis) for axis in np.asarray(self.axes, dtype=float))
        return np.stack([first, second, np.cross(first, second)], axis=1)

    @property
    def thermal_strain(self) -> Any:
        """Strain (3, 3) by a kelvin, base axes; an InputError where the expansions are missing."""
        if self.expansions is None:
            raise _no_expansion("expansions", '["16e-6 1/K", "16e-6 1/K", "55e-6 1/K"]')
        return (self._columns * np.asarray(self.expansions)) @ self._columns.T

    @property
    def elasticity(self) -> Any:
        """Stresses (6, 6) Pa of unit strains xx, yy, zz, yz, xz, xy, base axes, with twice the tensor's shear."""
        turned = self._columns
        pairs = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))
        voigt = np.array([[0, 5, 4], [5, 1, 3], [4, 3, 2]])
        tensor = np.linalg.inv(self._compliance)[voigt[:, :, None, None], voigt]
        tensor = np.einsum("ai,bj,ck,dl,ijkl->abcd", turned, turned, turned, turned, tensor)
        return np.array([[tensor[p][q] for q in pairs] for p in pairs])
