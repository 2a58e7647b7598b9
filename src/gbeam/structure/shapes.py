"""Shapes of cross-sections: what they take, their areas and second moments, and how they twist and shear.

Closed forms for arrays of dimensions, NumPy's or JAX's; y is along the width, z through the thickness.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from gbeam.arrays.namespace import namespace
from gbeam.structure import matrices
from gbeam.structure.stress import rectangle_stresses, round_stresses

MATRICES = "matrices"
Array = Any
Rule = Callable[..., tuple[Array, ...]]
ASSUMED_SHEAR = 0.5  # shear coefficient of a section known by its properties only: between a tube's and a channel's web
_TERMS = np.arange(1, 12, 2)  # of Saint-Venant's series, whose sum they leave 1e-6 short


def rectangle(width: Array, thickness: Array) -> tuple[Array, ...]:
    """Area, I_y, I_z, extreme fibres along y and z of a rectangle: width along y, thickness along z."""
    return width * thickness, width * thickness**3 / 12, thickness * width**3 / 12, width / 2, thickness / 2


def circle(diameter: Array) -> tuple[Array, ...]:
    """Area, I_y, I_z, extreme fibres of a solid circle."""
    inertia = np.pi * diameter**4 / 64
    return np.pi * diameter**2 / 4, inertia, inertia, diameter / 2, diameter / 2


def tube(diameter: Array, wall: Array) -> tuple[Array, ...]:
    """Area, I_y, I_z, extreme fibres of a round tube: outer diameter and wall thickness."""
    inner = diameter - 2 * wall
    inertia = np.pi * (diameter**4 - inner**4) / 64
    return np.pi * (diameter**2 - inner**2) / 4, inertia, inertia, diameter / 2, diameter / 2


def general(
    area: Array,
    inertia_y: Array,
    inertia_z: Array,
    extreme_fibre_y: Array | None = None,
    extreme_fibre_z: Array | None = None,
    **_: Array,
) -> tuple[Array, ...]:
    """Area and second moments as given; the extreme fibres, if unknown, are NaN (no stress is known)."""
    unknown = namespace(area).full_like(area, np.nan)
    return (
        area,
        inertia_y,
        inertia_z,
        unknown if extreme_fibre_y is None else extreme_fibre_y,
        unknown if extreme_fibre_z is None else extreme_fibre_z,
    )


def rectangle_torsion(width: Array, thickness: Array) -> Array:
    """Saint-Venant's torsion constant of a rectangle, m⁴ (Timoshenko and Goodier, Theory of Elasticity, 109)."""
    xp = namespace(width, thickness)
    wide, thin = xp.maximum(width, thickness), xp.minimum(width, thickness)
    odd = _TERMS.reshape(-1, *[1] * np.ndim(wide))
    series = (xp.tanh(odd * np.pi * wide / (2 * thin)) / odd**5).sum(axis=0)
    return wide * thin**3 / 3 * (1 - 192 / np.pi**5 * thin / wide * series)


def round_torsion(**dimensions: Array) -> Array:
    """Torsion constant of a circle or a round tube, its polar second moment, m⁴."""
    _, about_y, about_z, *_ = (tube if "wall" in dimensions else circle)(**dimensions)
    return about_y + about_z


def rectangle_shear(ratio: float, **_: Array) -> tuple[float, float]:
    """Cowper's shear coefficients of a rectangle along y and z, at a Poisson's ratio (J. Appl. Mech. 33, 1966)."""
    coefficient = 10 * (1 + ratio) / (12 + 11 * ratio)
    return coefficient, coefficient


def round_shear(ratio: float, diameter: Array, wall: Array | None = None) -> tuple[Array, Array]:
    """Cowper's shear coefficients of a circle or a round tube."""
    hollow = 0.0 if wall is None else 1 - 2 * wall / diameter
    square = (1 + hollow**2) ** 2
    coefficient = 6 * (1 + ratio) * square / ((7 + 6 * ratio) * square + (20 + 12 * ratio) * hollow**2)
    return coefficient, coefficient


def general_torsion(area: Array, torsion_constant: Array | None = None, **_: Array) -> Array:
    """The torsion constant as given, NaN where it is not."""
    return namespace(area).full_like(area, np.nan) if torsion_constant is None else torsion_constant


def general_shear(
    _: float, shear_coefficient_y: Array = ASSUMED_SHEAR, shear_coefficient_z: Array = ASSUMED_SHEAR, **__: Array
) -> tuple[Array, Array]:
    """The shear coefficients as given, or assumed."""
    return shear_coefficient_y, shear_coefficient_z


class Shape(NamedTuple):
    """A shape: area m², I_y, I_z m⁴ and extreme fibres m (`values`), torsion constant m⁴, shear coefficients, and where
    there are formulas stresses by unit loads (points, 3, 6, s), of its dimensions.
    """

    values: Rule
    torsion: Callable[..., Array]
    shear: Callable[..., tuple[Array, Array]]
    required: tuple[str, ...]
    optional: tuple[str, ...] = ()
    stresses: Callable[..., Array] | None = None


SHAPES: dict[str, Shape] = {
    "rectangle": Shape(rectangle, rectangle_torsion, rectangle_shear, ("width", "thickness"), (), rectangle_stresses),
    "circle": Shape(circle, round_torsion, round_shear, ("diameter",), (), round_stresses),
    "tube": Shape(tube, round_torsion, round_shear, ("diameter", "wall"), (), round_stresses),
    "general": Shape(
        general,
        general_torsion,
        general_shear,
        ("area", "inertia_y", "inertia_z"),
        (
            "extreme_fibre_y",
            "extreme_fibre_z",
            "torsion_constant",
            "shear_coefficient_y",
            "shear_coefficient_z",
        ),
    ),
    MATRICES: Shape(matrices.values, matrices.no_torsion, matrices.no_shear, ("stiffness", "mass")),
}
ROUND = ("circle", "tube")
