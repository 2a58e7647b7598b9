"""Closures: joints between two points that the tree moves already, which make loops.

The joint's own steps carry a massless frame from one of the points. Six conditions say that this frame is that of the
other point: its place r from there, and its rotation vector φ, both in axes of the point, are zero. With the rates G ẏ
of these and the forces Gᵀ λ of unit wrenches between the two, D'Alembert's sum r(y, ẏ, ÿ) of the tree holds along what
is left free:

    r − Gᵀ A (G W r − c) = 0,    A = (G W Gᵀ)⁻¹,    c = g̈ + 2 s ġ + s² g.

Multiplied by G W it says c = 0, and so r is Gᵀ λ. There are as many equations as coordinates, and none of them chooses
which coordinates depend on the others. W are constant weights, one over the inertia of each row.
"""

from __future__ import annotations

import numpy as np

from gbeam.arrays.namespace import Array, namespace
from gbeam.arrays.tree import record, static
from gbeam.integrate.equations import solve_systems
from gbeam.mechanics.fields.measures import rotation_vectors, vector_rates
from gbeam.mechanics.fields.products import cross, turned, turned_back
from gbeam.mechanics.tree.frames import Frame, product

SETTLING = 1.0  # 1/s: rate at which a gap closes that steps have left, as the size of Euler parameters does
WAYS = "along x", "along y", "along z", "about x", "about y", "about z"  # of the place and of the rotation vector
DIRECTIONS = len(WAYS)


@record
class Closure:
    """A closure: the frame at the end of link `frame` is that of point `on` of body `body`, −1 its root."""

    frame: int = static()
    body: int = static()
    on: int = static()


def gap(frame: Frame, point: Frame) -> Array:
    """Place (m) and rotation vector (rad) of a `frame` in the axes of a `point`, (..., 6)."""
    xp = namespace(frame.p, point.p)
    place = turned_back(point.R, frame.p - point.p)
    turn = rotation_vectors(product(xp.swapaxes(point.R, -1, -2), frame.R))
    return xp.concatenate(xp.broadcast_arrays(place, turn), axis=-1)


def gap_with_rates(frame: Frame, point: Frame) -> tuple[Array, Array, Array]:
    """Gap (..., 6), as :func:`gap` returns it, with its two derivatives with respect to time."""
    xp = namespace(frame.p, point.p)
    C = product(xp.swapaxes(point.R, -1, -2), frame.R)
    place, phi = turned_back(point.R, frame.p - point.p), rotation_vectors(C)
    w = turned(C, frame.w)
    sweep = turned(C, frame.v) - point.v
    rate = sweep - cross(point.w, place)
    pull = turned(C, frame.a) - point.a
    change = pull - cross(point.alpha, place) - cross(point.w, cross(point.w, place) + 2 * rate)
    spin = w - point.w
    spin_rate = turned(C, frame.alpha) - point.alpha - cross(point.w, w)
    by_spin, by_vector = vector_rates(phi)
    phi_rate = turned(by_spin, spin)
    phi_change = turned(by_spin, spin_rate) + turned(by_vector(phi_rate), spin)

    def six(first: Array, second: Array) -> Array:
        return xp.concatenate(xp.broadcast_arrays(first, second), axis=-1)

    return six(place, phi), six(rate, phi_rate), six(change, phi_change)


def closing_loads(rows: Array, slopes: Array, weights: Array, change: Array) -> Array:
    """Loads λ (..., m) by which rows (..., n) of a tree hold together with conditions.

    The conditions have the `slopes` G (..., m, n), and c, their `change` (..., m), which the loads bring to zero.
    """
    weighted = slopes * weights
    inertia = weighted @ namespace(slopes).swapaxes(slopes, -1, -2)
    remaining = (weighted @ rows[..., None])[..., 0] - change
    return solve_systems(inertia, remaining[..., None])[..., 0]


def settling(value: Array, rate: Array, change: Array) -> Array:
    """Return c = g̈ + 2 s ġ + s² g, which vanishes where a gap stays closed or closes."""
    return change + 2 * SETTLING * rate + SETTLING**2 * value


def in_words_of_gap(size: float, direction: int) -> str:
    """Size of a gap in words: mm along x, y and z, the first three directions, degrees about them."""
    return f"{1e3 * size:.4g} mm {WAYS[direction]}" if direction < 3 else f"{np.degrees(size):.4g}° {WAYS[direction]}"
