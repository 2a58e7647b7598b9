"""Motion of a frame and the wrench on it, carried from one frame to the next.

Vectors are in the axes of the frame itself, so that they need no more than the relative rotation of two frames. A frame
Q whose origin is at r in a frame P, turned by C = R_PQ, moves with

    v_Q = v + ω × r + ṙ,    a_Q = a + α × r + ω × (ω × r) + 2 ω × ṙ + r̈,    ω_Q = Cᵀ ω + ω_PQ,
    α_Q = Cᵀ α + α_PQ + (Cᵀ ω) × ω_PQ,

and a wrench on Q acts on P by f_P = C f_Q and n_P = C n_Q + r × f_P. All arrays may have leading axes.
"""

from __future__ import annotations

import numpy as np

from gbeam.arrays.namespace import Array
from gbeam.arrays.tree import record

_NEXT, _LAST = np.array([1, 2, 0]), np.array([2, 0, 1])  # component after each, and the one before


def cross(left: Array, right: Array) -> Array:
    """Vector product of vectors (..., 3)."""
    return left.take(_NEXT, -1) * right.take(_LAST, -1) - left.take(_LAST, -1) * right.take(_NEXT, -1)


def turned(R: Array, v: Array) -> Array:
    """R v of matrices (..., 3, 3) and vectors (..., 3)."""
    return v @ R.T if R.ndim == 2 else (R @ v[..., None])[..., 0]


def turned_back(R: Array, v: Array) -> Array:
    """Rᵀ v."""
    return v @ R if R.ndim == 2 else (v[..., None, :] @ R)[..., 0, :]


def product(left: Array, right: Array) -> Array:
    """Product of rotation matrices (..., 3, 3)."""
    return left @ right


@record
class Relative:
    """Motion of a frame Q in a frame P: place, velocity and acceleration (..., 3) in axes P, R_PQ (..., 3, 3) or None
    where it is not turned, and angular velocity and acceleration (..., 3) in axes Q, or None.
    """

    r: Array
    rd: Array | None = None
    rdd: Array | None = None
    R: Array | None = None
    w: Array | None = None
    alpha: Array | None = None


@record
class Frame:
    """Motion of a frame: R_WF (..., 3, 3), its origin in the world (..., 3) m, world axes; velocity, angular velocity,
    acceleration (specific force where gravity acts) and angular acceleration (..., 3), its own axes. R, p and v are
    None where only forces are computed.
    """

    R: Array
    p: Array
    v: Array
    w: Array
    a: Array
    alpha: Array

    def carried(self, by: Relative) -> Frame:
        """Motion, in its own axes, of the frame that moves `by` in this one; None in `by` is zero, or no turn."""
        swept = cross(self.w, by.r)
        a = self.a + cross(self.alpha, by.r) + cross(self.w, swept if by.rd is None else swept + 2 * by.rd)
        if by.rd is not None:
            a = a + by.rdd
        R, p, v, w, alpha = self.R, self.p, self.v, self.w, self.alpha
        if R is not None:
            p = p + turned(R, by.r)
            v = v + (swept if by.rd is None else swept + by.rd)
        if by.R is not None:
            w, alpha, a = (turned_back(by.R, each) for each in (w, alpha, a))
            if R is not None:
                R, v = product(R, by.R), turned_back(by.R, v)
        if by.w is not None:
            w, alpha = w + by.w, alpha + by.alpha + cross(w, by.w)
        return Frame(R, p, v, w, a, alpha)


@record
class Wrench:
    """Force N and moment N m about the origin of a frame (..., 3), its axes."""

    force: Array
    moment: Array

    def __add__(self, other: Wrench) -> Wrench:
        return Wrench(self.force + other.force, self.moment + other.moment)

    def brought(self, by: Relative) -> Wrench:
        """Return the wrench about the origin, and in the axes, of the frame in which its present one moves `by`."""
        force, moment = self.force, self.moment
        if by.R is not None:
            force, moment = turned(by.R, force), turned(by.R, moment)
        return Wrench(force, moment + cross(by.r, force))
