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
from gbeam.mechanics.fields.products import cross, turned, turned_back


def product(left: Array, right: Array) -> Array:
    """Product of rotation matrices (..., 3, 3)."""
    return left @ right


@record
class Relative:
    """Motion of a frame Q in a frame P: place, velocity and acceleration (..., 3) in axes P, R_PQ (..., 3, 3), and
    angular velocity and acceleration (..., 3) in axes Q. None is no place beside the origin, no motion or no turn.
    """

    r: Array | None = None
    rd: Array | None = None
    rdd: Array | None = None
    R: Array | None = None
    w: Array | None = None
    alpha: Array | None = None


@record
class Frame:
    """Motion of a frame.

    R_WF (..., 3, 3) and the origin in the world (..., 3) m are in world axes. Velocity, angular velocity, acceleration
    (specific force where gravity acts) and angular acceleration (..., 3) are in the frame's own axes. R, p and v are
    None where only forces are computed, and `a`, or `w` and `alpha` together, where they are zero for all states.
    """

    R: Array
    p: Array
    v: Array
    w: Array
    a: Array
    alpha: Array

    def carried(self, relative: Relative) -> Frame:
        """Motion, in its own axes, of a frame that moves by `relative` in this one; None is zero, or not needed."""
        R, p, v, w, a, alpha = self.R, self.p, self.v, self.w, self.a, self.alpha
        if w is not None and relative.r is not None:
            # a + α × r + ω × (ω × r + 2 ṙ), with r̈ added below.
            swept = cross(w, relative.r)
            a = _sum(a, cross(alpha, relative.r) + cross(w, swept if relative.rd is None else swept + 2 * relative.rd))
        if R is not None and relative.r is not None:
            p = p + turned(R, relative.r)
            v = v + (swept if relative.rd is None else swept + relative.rd)
        if relative.rdd is not None:
            a = _sum(a, relative.rdd)
        if relative.R is not None:
            w, alpha, a = (None if vector is None else turned_back(relative.R, vector) for vector in (w, alpha, a))
            if R is not None:
                R, v = product(R, relative.R), turned_back(relative.R, v)
        if relative.w is not None:
            alpha = relative.alpha if w is None else alpha + relative.alpha + cross(w, relative.w)
            w = _sum(w, relative.w)
        return Frame(R, p, v, w, a, alpha)

    def filled(self, shape: tuple[int, ...]) -> Frame:
        """Fill in zeros, of a shape of states, for the vectors that are None because they are zero."""
        if self.w is not None and self.a is not None:
            return self
        zero = np.zeros((*shape, 3))
        w, a, alpha = (zero if vector is None else vector for vector in (self.w, self.a, self.alpha))
        return Frame(self.R, self.p, self.v, w, a, alpha)


def _sum(first: Array | None, second: Array) -> Array:
    """Sum of two vectors, of which the first may be None: zero."""
    return second if first is None else first + second


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
        return Wrench(force, moment if by.r is None else moment + cross(by.r, force))
