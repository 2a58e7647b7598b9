"""Stress over sections by all that they carry: normal stress, shear by torsion and by shear force, von Mises'.

A shape says its stresses at points by a unit of each of N, V_y, V_z, T, M_y and M_z: (points, 3, 6), normal and shear
along two directions. Torsion is Saint-Venant's; shear forces bring Jourawski's parabola, and on a round surface its
tangential part.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
ALONG = np.linspace(-1, 1, 9)  # of a face, between corners
_EDGE = np.array([(u, v) for u in ALONG for v in (-1.0, 1.0)])
POINTS = np.concatenate([_EDGE, _EDGE[:, ::-1], np.zeros((1, 2))])  # of a rectangle: y and z over half of its sides
AROUND = 2 * np.pi * np.arange(24) / 24
TERMS = np.arange(1, 40, 2.0)  # of Saint-Venant's series
BLOCK = 1 << 21  # numbers at once


def rectangle_stresses(width: Array, thickness: Array) -> Array:
    """Stresses of rectangles (s,) at points of their faces and at the centre, by unit loads, (points, 3, 6, s)."""
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


def saint_venant(long: Array, thin: Array, along: Array, across: Array) -> tuple[Array, Array]:
    """Shear stress of a rectangle by a unit torque, along its long side and along its short one, at places −1 to 1 of
    both (Timoshenko and Goodier, Theory of Elasticity, 109).
    """
    n = TERMS[:, None, None] if np.ndim(along) > 1 else TERMS[:, None]
    half, reach = thin / 2, n * np.pi / 2
    slender = long / thin
    grown = np.exp(reach * slender * (np.abs(along) - 1)) * (1 + np.exp(-2 * reach * slender * np.abs(along)))
    decay = grown / (1 + np.exp(-2 * reach * slender))  # cosh over cosh, and likewise sinh over cosh
    sinh = np.sign(along) * np.exp(reach * slender * (np.abs(along) - 1))
    sinh = sinh * (1 - np.exp(-2 * reach * slender * np.abs(along))) / (1 + np.exp(-2 * reach * slender))
    sign = (-1.0) ** ((n - 1) / 2)
    scale = 8 / np.pi**2 * 2 * half
    on_long = scale * (np.pi**2 / 8 * across - (sign / n**2 * decay * np.sin(reach * across)).sum(axis=0))
    on_long = np.where(np.abs(along) < 1, on_long, 0.0)  # where the series is that of the first term
    on_short = scale * (sign / n**2 * sinh * np.cos(reach * across)).sum(axis=0)
    constant = long * thin**3 / 3 * (1 - 192 / np.pi**5 / slender * (np.tanh(reach * slender) / n**5).sum(axis=0))
    return on_long / constant, on_short / constant


def round_stresses(diameter: Array, wall: Array | None = None) -> Array:
    """Stresses of circles or tubes (s,) around their surface by unit loads, (points, 3, 6, s)."""
    radius = diameter / 2
    inner = 0 * radius if wall is None else radius - wall
    area, inertia = np.pi * (radius**2 - inner**2), np.pi / 4 * (radius**4 - inner**4)
    shear = 4 / 3 * (radius**2 + radius * inner + inner**2) / (radius**2 + inner**2) / area
    out = np.zeros((len(AROUND), 3, 6, len(diameter)))
    c, s = np.cos(AROUND)[:, None], np.sin(AROUND)[:, None]
    out[:, 0, 0], out[:, 0, 4], out[:, 0, 5] = 1 / area, s * radius / inertia, -c * radius / inertia
    out[:, 1, 1], out[:, 1, 2], out[:, 1, 3] = -s * shear, c * shear, radius / (2 * inertia)
    return out


def von_mises(stresses: Array | None, force: Any, moment: Any) -> Array:
    """Largest von Mises stress (t, s) Pa over sections' points, by force N and moment N m (t, s, 3) in their axes; NaN
    where the shape has no formulas.
    """
    carried = np.concatenate([force, moment], axis=-1)
    out = np.full(carried.shape[:2], np.nan)
    if stresses is None:
        return out
    some = max(1, BLOCK // (3 * len(stresses) * max(carried.shape[1], 1)))
    for i in range(0, len(carried), some):
        normal, *shear = np.einsum("pcks,tsk->ctsp", stresses, carried[i : i + some], optimize=True)
        out[i : i + some] = np.sqrt(normal**2 + 3 * (shear[0] ** 2 + shear[1] ** 2)).max(axis=-1)
    return out
