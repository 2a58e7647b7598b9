"""Shapes of cross-sections: their areas and second moments, how they twist and shear, and the stress over them.

Closed forms for arrays of dimensions, NumPy's or JAX's; y is along the width, z through the thickness. A shape says its
stresses at points by a unit of each of N, V_y, V_z, T, M_y and M_z: (points, 3, 6), normal and shear along two
directions. Torsion is Saint-Venant's; shear forces bring Jourawski's parabola, and on a round surface its tangential
part.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any, Final, NamedTuple, TypedDict

import numpy as np
from numpy.typing import ArrayLike

from gbeam.arrays.namespace import Array, namespace
from gbeam.arrays.types import Floats
from gbeam.constants import SectionShape
from gbeam.guards.quantities import OneOrSome, Quantity
from gbeam.structure import matrices

ALONG = np.linspace(-1, 1, 9)  # of a face, between corners
_EDGE = np.array([(u, v) for u in ALONG for v in (-1.0, 1.0)])
POINTS = np.concatenate([_EDGE, _EDGE[:, ::-1], np.zeros((1, 2))])  # of a rectangle: y and z over half of its sides
AROUND = 2 * np.pi * np.arange(24) / 24
TERMS = np.arange(1, 40, 2.0)  # of Saint-Venant's series
BLOCK = 1 << 21  # numbers at once


def rectangle_stresses(width: Floats, thickness: Floats) -> Floats:
    """Stresses (points, 3, 6, s) of rectangles (s,) under unit loads, at points of their faces and at the centre.

    The components are normal stress and shear along y and z; the loads are axial force, shear along y and z, torque,
    and moments about y and z.
    """
    u, v = POINTS[:, :1], POINTS[:, 1:]
    area, about_y, about_z = width * thickness, width * thickness**3 / 12, thickness * width**3 / 12
    wide = width >= thickness
    long, thin = np.where(wide, width, thickness), np.where(wide, thickness, width)
    on_long, on_short = saint_venant(long, thin, np.where(wide, u, v), np.where(wide, v, u))
    out = np.zeros((len(POINTS), 3, 6, len(width)))
    out[:, 0, 0], out[:, 0, 4], out[:, 0, 5] = 1 / area, v * thickness / 2 / about_y, -u * width / 2 / about_z
    # T is the integral of y τ_xz − z τ_xy.
    out[:, 1, 1], out[:, 1, 3] = 1.5 * (1 - u**2) / area, np.where(wide, -on_long, -on_short)
    out[:, 2, 2], out[:, 2, 3] = 1.5 * (1 - v**2) / area, np.where(wide, on_short, on_long)
    return out


def saint_venant(long: Floats, thin: Floats, along: Floats, across: Floats) -> tuple[Floats, Floats]:
    """Shear stresses of a rectangle, `long` by `thin` m, under a unit torque, along its long and its short side.

    The places `along` and `across` are from −1 to 1 of these sides (Timoshenko and Goodier, Theory of Elasticity, 109).
    """
    n = TERMS[:, None, None] if np.ndim(along) > 1 else TERMS[:, None]
    half, reach = thin / 2, n * np.pi / 2
    aspect = long / thin
    # cosh(reach aspect along) and sinh of it, over cosh(reach aspect), by exponentials that do not overflow.
    cosh = np.exp(reach * aspect * (np.abs(along) - 1)) * (1 + np.exp(-2 * reach * aspect * np.abs(along)))
    cosh = cosh / (1 + np.exp(-2 * reach * aspect))
    sinh = np.sign(along) * np.exp(reach * aspect * (np.abs(along) - 1))
    sinh = sinh * (1 - np.exp(-2 * reach * aspect * np.abs(along))) / (1 + np.exp(-2 * reach * aspect))
    sign = (-1.0) ** ((n - 1) / 2)
    scale = 8 / np.pi**2 * 2 * half
    on_long = scale * (np.pi**2 / 8 * across - (sign / n**2 * cosh * np.sin(reach * across)).sum(axis=0))
    on_long = np.where(np.abs(along) < 1, on_long, 0.0)  # zero on the short sides: the series cancels the first term
    on_short = scale * (sign / n**2 * sinh * np.cos(reach * across)).sum(axis=0)
    constant = long * thin**3 / 3 * (1 - 192 / np.pi**5 / aspect * (np.tanh(reach * aspect) / n**5).sum(axis=0))
    return on_long / constant, on_short / constant


def round_stresses(diameter: Floats, wall: Floats | None = None) -> Floats:
    """Stresses (points, 3, 6, s) of circles or tubes (s,) around their surface under unit loads, as of
    :func:`rectangle_stresses`.
    """
    radius = diameter / 2
    inner = 0 * radius if wall is None else radius - wall
    area, inertia = np.pi * (radius**2 - inner**2), np.pi / 4 * (radius**4 - inner**4)
    shear = 4 / 3 * (radius**2 + radius * inner + inner**2) / (radius**2 + inner**2) / area
    out = np.zeros((len(AROUND), 3, 6, len(diameter)))
    c, s = np.cos(AROUND)[:, None], np.sin(AROUND)[:, None]
    out[:, 0, 0], out[:, 0, 4], out[:, 0, 5] = 1 / area, s * radius / inertia, -c * radius / inertia
    out[:, 1, 1], out[:, 1, 2], out[:, 1, 3] = -s * shear, c * shear, radius / (2 * inertia)
    return out


def von_mises(stresses: Floats | None, force: Any, moment: Any) -> Floats:
    """Largest von Mises stress (t, s), Pa, of sections under force and moment (t, s, 3); NaN without formulas."""
    carried = np.concatenate([force, moment], axis=-1)
    out = np.full(carried.shape[:2], np.nan)
    if stresses is None:
        return out
    count = max(1, BLOCK // (3 * len(stresses) * max(carried.shape[1], 1)))  # times at once
    for i in range(0, len(carried), count):
        normal, *shear = np.einsum("pcks,tsk->ctsp", stresses, carried[i : i + count], optimize=True)
        out[i : i + count] = np.sqrt(normal**2 + 3 * (shear[0] ** 2 + shear[1] ** 2)).max(axis=-1)
    return out


MATRICES: Final = "matrices"
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
    """Area, I_y, I_z and extreme fibres as they are given. Fibres that are not given are NaN: there is no stress."""
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
    """A shape of sections: functions of its dimensions for area m², I_y, I_z m⁴ and extreme fibres m (`values`), for
    torsion constant m⁴, shear coefficients, and stresses by unit loads (points, 3, 6, s), None without formulas; and
    the names of the dimensions that it requires, and may have.
    """

    values: Rule
    torsion: Callable[..., Array]
    shear: Callable[..., tuple[Array, Array]]
    required: tuple[str, ...]
    optional: tuple[str, ...] = ()
    stresses: Callable[..., Array] | None = None


Lengths = Annotated[ArrayLike, Quantity("length", "positive"), OneOrSome()]
Areas = Annotated[ArrayLike, Quantity("area", "positive"), OneOrSome()]
SecondMoments = Annotated[ArrayLike, Quantity("second moment of area", "positive"), OneOrSome()]
ShearCoefficients = Annotated[ArrayLike, Quantity("ratio", "positive"), OneOrSome()]


class Dimensions(TypedDict, total=False):
    """Dimensions of all shapes, as :meth:`gbeam.Section.of` takes those of one."""

    width: Lengths | None
    thickness: Lengths | None
    diameter: Lengths | None
    wall: Lengths | None
    area: Areas | None
    inertia_y: SecondMoments | None
    inertia_z: SecondMoments | None
    extreme_fibre_y: Lengths | None
    extreme_fibre_z: Lengths | None
    torsion_constant: SecondMoments | None
    shear_coefficient_y: ShearCoefficients | None
    shear_coefficient_z: ShearCoefficients | None
    stiffness: ArrayLike | None
    mass: ArrayLike | None


SHAPES: dict[SectionShape, Shape] = {
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
