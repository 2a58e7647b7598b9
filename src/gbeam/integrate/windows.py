"""Nonlinear equations in time without compiling: windows of many steps solved together.

One call of the residual evaluates all stages of a window, and one correction of Newton's method for all its unknowns is
a recurrence over its steps: with the residual r of a step's stages, its Jacobian J with respect to their accelerations
x and L with respect to the state z before it,

    δx = −J⁻¹ (r + L δz),    δz₊ = g δz + d δx + (g z + d x − z₊).

A window begins with every step like the last one before it, of which the first correction makes the linear response
about that state. Derivatives are found at some of its steps and interpolated between these. Where the corrections do
not shrink, what has converged at the window's beginning is kept and a shorter window begins behind it, a single step
at last, which takes Newton's method proper.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from gbeam.arrays.tree import each_leaf
from gbeam.integrate.equations import NonlinearEquations, accelerations, slopes, solved
from gbeam.integrate.sampled import Held, sampling_of
from gbeam.integrate.schemes import Scheme, Tableau
from gbeam.integrate.steps import Steps

Array = Any
Piece = tuple[Any, ...]
FIRST, MOST, LONGEST = 100, 200, 1000  # steps in a window: at first, at most, and where derivatives hold all along
NEAR, APART, FAR = 4, 12, 24  # stages between derivatives: at least, at first, and at most
CORRECTIONS, ALONE = 10, 25  # of a window at most, and of a single step
HALVINGS = 8  # of a correction of a single step
MOVED = 0.3  # size of a correction after which derivatives are found anew
FEW = 3  # times, after which a window that is still so far away ends, and up to which the next one may be longer
SLOW, FAST = 0.3, 0.01  # of the last correction: where one is larger, derivatives are closer, where smaller farther
CLOSE = 0.03  # of the last correction of accelerations at ends: where one is larger, the mass is found there
QUICKEST, STALLED = 0.01, 0.9  # factors of corrections: none is thought to be smaller, and where they do not shrink
LEAST = 4  # steps behind those that have converged, which go on with what they have: at least
TOLERANCE, ROUNDING = 1e-9, 1e-6  # of the largest acceleration: error left by the last correction, and where it stalls
TINY = float(np.finfo(float).tiny)
CANCELLED = 100 * float(np.finfo(float).eps)  # of the forces at a coordinate, each a sum of many: their rounding
GROWN = 10.0  # times the rounding where a window begins, which is known there, unlike that of iterates that diverge
EARLIER = 0.01  # of the largest acceleration before a step, whose own may all vanish: to be told from none


def windows(equations: NonlinearEquations, scheme: Scheme, q: Array, qd: Array, steps: Steps) -> Iterator[Piece]:
    """Integrate; yields the initial state, then by windows the kept q, q̇, q̈ (k, n) and whether each was solved."""
    if not q.size:  # all motion is prescribed
        still = np.zeros((1 + np.count_nonzero(steps.kept), 0))
        yield from ((each, each, each, np.ones(len(each), dtype=bool)) for each in (still[:1], still[1:]))
        return
    residual, drive, sampling = equations.residual, equations.drive, sampling_of(equations, steps)

    def demanded(t: Any, q: Array, qd: Array) -> Array:
        return accelerations(residual, q[None], qd[None], drive(np.array([t])))[0]

    with np.errstate(all="ignore"):  # of iterates that diverge
        qdd = demanded(steps.first[0], q, qd)
    yield q[None], qd[None], qdd[None], np.array([True])
    # A scheme whose last stage is the end of a step begins anew after a jump: no window goes beyond one.
    ends = np.append(np.flatnonzero(steps.anew[:-1]) + 1 if scheme.ends else [], len(steps)).astype(int)
    z, x = scheme.tableau(steps.length[0]).first @ np.stack([q, qd, qdd]), qdd
    done, size, apart, slope, noise = 0, FIRST, APART, None, np.inf
    start: Any = z, x, slope
    while done < len(steps):
        part = steps[done : min(done + size, ends[np.searchsorted(ends, done, side="right")])]
        with np.errstate(all="ignore"):
            held = None if sampling is None else Held(sampling, done, len(part))
            window = _Window(residual, drive, scheme, part, z, x, slope, apart, held, noise)
            count, near, times = window.solve()
            noise = window.most
            apart = window.apart if count == len(part) else max(window.apart // 2, NEAR)
            if not count and len(part) == 1:
                failed = np.full((1, z.shape[-1]), np.nan)
                yield failed, failed, failed, np.array([False])
                return
            # What is near goes on, in a shorter window than this one.
            going = near > count + LEAST and near - count < len(part)
            if count == len(part):
                size = min(size + size // 2 + 1, MOST if times else LONGEST) if times <= FEW else size
            elif going:
                size = near - count
            else:
                size = max(count, len(part) // 2)
            if count:
                # Between derivatives of iterates that diverged lies nothing to begin with.
                slope = window.slope_at(count - 1) if count == len(part) else None
                start = window.z[count], window.x[count - 1, -1], slope
            z, x, slope = window.behind(count, near) if going else start
            if not count:
                continue
            q, qd, qdd = window.ended(count)
            end = part[count - 1]
            if scheme.ends and end.anew:
                x = demanded(end.resume, q[-1], qd[-1])
                qdd[-1] = demanded(end.end, q[-1], qd[-1])
                z = scheme.tableau(end.following).first @ np.stack([q[-1], qd[-1], x])
                start = z, x, slope
        done, kept = done + count, part.kept[:count]
        yield q[kept], qd[kept], qdd[kept], np.ones(np.count_nonzero(kept), dtype=bool)


class _Window:
    """Steps that are solved together: their states z (t + 1, m, n) and accelerations x (t, s, n), corrected in place,
    and the `slope` of the equations, K, C and M (1 or t, s, n, n), from stages so far `apart`.
    """

    def __init__(
        self,
        residual: Any,
        drive: Any,
        scheme: Scheme,
        steps: Steps,
        z: Array,
        x: Array,
        slope: Any,
        apart: int,
        held: Held | None,
        noise: float,
    ) -> None:
        self.residual, self.drive, self.scheme, self.steps, self.apart = residual, drive, scheme, steps, apart
        equal = bool((steps.length == steps.length[0]).all())
        self.t: Tableau = scheme.tableau(steps.length[:1] if equal else steps.length)
        self.inputs = drive(np.stack([steps.times(offset) for offset in scheme.offsets], axis=1).ravel())
        self.z = np.array(np.broadcast_to(z, (len(steps) + 1, *z.shape[-2:])))
        self.x = np.array(np.broadcast_to(x, (len(steps), len(scheme.offsets), x.shape[-1])))
        self.slope, self.held, self.free = slope, held, self.inputs
        if held is not None:
            held.begin(self.z[:-1])
            self.inputs = held.driven(self.free, len(scheme.offsets))
        if slope is None or not all(np.isfinite(each).all() for each in slope):
            self._differentiate(alone=True)
        self.most = noise if len(self.slope[0]) > 1 else np.inf

    def solve(self) -> tuple[int, int, int]:
        """Correct the window; returns how many of its steps have converged, from the first on, how many are near, and
        how many times derivatives were found.
        """
        count, times = len(self.steps), 0
        size, good = np.full(count, np.inf), np.zeros(count, dtype=bool)
        moved = size
        maps, fresh = self._maps(), False
        for _ in range(ALONE if count == 1 else CORRECTIONS):
            before, size, last = size, self._correct(*maps), moved.max()
            if count == 1:
                self._shorten(maps[0])
            # By derivatives of another state corrections may shrink slowly without being rounding.
            good, fresh = _converged(size, before, self.x, self.noise, stalls=fresh), False
            moved = size / _reach(self.x)
            largest = moved.max()
            if good.all() or not np.isfinite(size[0]) or (not largest <= MOVED and times > FEW and count > 1):
                break
            if largest > MOVED or not largest <= SLOW * last:
                if times and largest <= MOVED:
                    self.apart = max(self.apart // 2, NEAR)
                self._differentiate()
                maps, times, fresh = self._maps(), times + 1, True
            elif largest < FAST * last:
                self.apart = min(self.apart + 1, FAR)
        return _first(good), _first(moved <= MOVED), times

    def ended(self, count: int) -> tuple[Array, Array, Array]:
        """q, q̇, q̈ (count, n) at the ends of the first steps."""
        z, x, t = self.z[:count], self.x[:count], self.t
        ends = t.end_z[:count] @ z + t.end_x[:count] @ x
        q, qd = ends[:, 0], ends[:, 1]
        if self.scheme.ends:
            return q, qd, x[:, -1].copy()
        inputs, mass, size = self._at_ends(count), self.slope[2], np.full(count, np.inf)
        at = np.arange(len(self.x))[:, None] + np.array(self.scheme.offsets)
        qdd = _interpolated(at.ravel(), self.x.reshape(-1, self.x.shape[-1]), np.arange(1, count + 1))
        mass = (mass[:, -1] + np.concatenate([mass[1:, 0], mass[-1:, -1]])) / 2
        for _ in range(CORRECTIONS):  # with the mass at hand, for the equations are linear in q̈
            change = solved(mass[:count], self.residual(q, qd, qdd, inputs)[..., None])[..., 0]
            qdd = qdd - change
            before, size = size, _largest(change)
            if _converged(size, before, qdd, 0.0, stalls=True).all():
                return q, qd, qdd
            if not (size < CLOSE * before).all():
                break
        return q, qd, accelerations(self.residual, q, qd, inputs)

    def _at_ends(self, count: int) -> Any:
        """Inputs at the ends of the first steps."""
        inputs = self.drive(self.steps.end[:count])
        return inputs if self.held is None else self.held.at_ends(inputs, count)

    def behind(self, count: int, near: int) -> tuple[Array, Array, Any]:
        """States, accelerations and slope of the steps from `count` to `near`."""
        some = slice(count, near)
        slope = tuple(each[some] if len(each) > 1 else each for each in self.slope)
        return self.z[count : near + 1], self.x[some], slope

    def slope_at(self, step: int) -> tuple[Array, ...]:
        """K, C and M (1, 1, n, n) at the last stage of a step."""
        return tuple(each[step:, -1:][:1] if len(each) > 1 else each[:, -1:] for each in self.slope)

    def _stages(self) -> tuple[Array, Array, Array]:
        """q, q̇, q̈ (t s, n) at the stages."""
        t, z, x = self.t, self.z[:-1], self.x
        q, qd = t.w_q @ z + t.c_q @ x, t.w_v @ z + t.c_v @ x
        n = x.shape[-1]
        return q.reshape(-1, n), qd.reshape(-1, n), x.reshape(-1, n)

    def _differentiate(self, *, alone: bool = False) -> None:
        """Find K, C and M at some stages, and between these; at the first `alone`."""
        n = self.x.shape[-1]
        slope = self._between(lambda *state: np.stack(slopes(self.residual, *state), axis=1), alone=alone)
        self.slope = tuple(np.moveaxis(slope.reshape(*(self.x.shape[:2] if len(slope) > 1 else (1, 1)), 3, n, n), 2, 0))

    def _between(self, function: Any, *, alone: bool = False) -> Array:
        """Values (t s or 1, ...) of a function of states and inputs at stages and between; at the first `alone`."""
        count = self.x.shape[0] * self.x.shape[1]
        samples = 1 if alone else 1 + math.ceil((count - 1) / (1 if len(self.x) == 1 else self.apart))
        at = np.linspace(0, count - 1, samples).round().astype(int)
        values = function(*(each[at] for each in self._stages()), each_leaf(lambda leaf: leaf[at], self.inputs))
        return _interpolated(at, values, np.arange(count)) if samples > 1 else values

    def _maps(self) -> tuple[Array, Array, Array]:
        """Inverse J⁻¹ (t, s n, s n) of steps, J⁻¹ L (t, s n, m n), and maps of δz over the steps, (t, m n, m n)."""
        t, (_, stages, states), n = self.t, self.t.w_q.shape, self.x.shape[-1]
        jacobian, onto = t.jacobians(*self.slope)
        unit = np.broadcast_to(np.eye(stages * n), jacobian.shape)
        both = solved(jacobian, np.concatenate([unit, onto], axis=-1))
        inverse, answer = both[..., : stages * n], both[..., stages * n :]
        # Of forces that cancel something is left, which no correction of the accelerations takes away.
        sizes = (np.abs(each).reshape(-1, stages, n, 1) for each in self._stages())
        forces = sum(np.abs(by) @ each for by, each in zip(self.slope, sizes, strict=True))
        noise = _largest(CANCELLED * _products(np.abs(inverse), forces.reshape(-1, stages * n)))
        if self.most == np.inf:
            self.most = GROWN * float(noise.max())
        self.noise = np.minimum(noise, self.most)
        step = (t.g[:, :, None, :, None] * np.eye(n)[:, None, :]).reshape(-1, states * n, states * n)
        if self.held is not None:
            self.held.push(inverse, t, self._between(self.held.sampling.onto))
        through = t.d @ answer.reshape(-1, stages, n * states * n)
        return inverse, answer, step - through.reshape(-1, states * n, states * n)

    def _correct(self, inverse: Array, answer: Array, step: Array) -> Array:
        """Correct every step; returns the sizes of the corrections, (t,)."""
        t, count = self.t, len(self.x)
        alone = _products(inverse, self.residual(*self._stages(), self.inputs).reshape(count, -1))
        defect = t.g @ self.z[:-1] + t.d @ (self.x - alone.reshape(self.x.shape)) - self.z[1:]
        moved = self._moved(step, defect.reshape(count, -1))
        change = (alone + _products(answer, moved[:-1])).reshape(self.x.shape)
        if self.held is not None:
            change = change + self.held.changed(self.x.shape)
            self.inputs = self.held.driven(self.free, self.x.shape[1])
        self.moved = moved.reshape(self.z.shape), change
        self.z += self.moved[0]
        self.x -= change
        return _largest(change)

    def _moved(self, step: Array, defect: Array) -> Array:
        """Changes δz (t + 1, m n) of the states by δz₊ = S δz + the defects (t, m n)."""
        count, moved = len(defect), np.zeros((len(defect) + 1, defect.shape[1]))
        if len(step) == 1 and self.held is None:  # sums of powers of one map, each twice as long as the last
            moved[1:], power, reach = defect, step[0].T, 1
            while reach < count:
                moved[1 + reach :] += moved[1:-reach] @ power
                power, reach = power @ power, 2 * reach
            return moved
        if self.held is not None:
            self.held.measure(self.z[:-1])
        every = zip(np.broadcast_to(step, (count, *step.shape[1:])), defect, moved[:-1], moved[1:], strict=True)
        for k, (one, more, before, after) in enumerate(every):
            np.dot(one, before, out=after)
            after += more
            if self.held is not None:
                after += self.held.sampled(k, before)
        return moved

    def _shorten(self, inverse: Array) -> None:
        """Halve a single step's correction until the next is smaller: a friction or a stop bends within a step."""
        (state, change), share = self.moved, 1.0
        whole = np.linalg.norm(change)
        for _ in range(HALVINGS):
            following = inverse @ self.residual(*self._stages(), self.inputs).reshape(1, -1, 1)
            if np.linalg.norm(following) <= (1 - share / 2) * whole or whole <= ROUNDING * np.linalg.norm(self.x):
                return
            share /= 2
            self.z -= share * state
            self.x += share * change


def _products(matrices: Array, vectors: Array) -> Array:
    """Products (t, a) of matrices (1 or t, a, b) and vectors (t, b)."""
    return vectors @ matrices[0].T if len(matrices) == 1 else (matrices @ vectors[..., None])[..., 0]


def _interpolated(at: Array, values: Array, points: Array) -> Array:
    """Values (k, ...) at places (k,), interpolated at points (p,) by the cubic through the nearest four."""
    size = min(4, len(at))
    first: Array = np.clip(np.searchsorted(at, points) - size // 2, 0, len(at) - size)
    index = first[:, None] + np.arange(size)
    near, itself = at[index], np.eye(size, dtype=bool)
    apart = np.where(itself, 1.0, points[:, None, None] - near[:, None, :])
    between = np.where(itself, 1.0, near[:, :, None] - near[:, None, :])
    weight = (apart / between).prod(axis=-1).reshape(len(points), size, *(1,) * (values.ndim - 1))
    out = weight[:, 0] * values[index[:, 0]]
    for k in range(1, size):
        out += weight[:, k] * values[index[:, k]]
    return out


def _first(flags: Array) -> int:
    """Number of flags before the first that is false."""
    return len(flags) if flags.all() else int(np.argmin(flags))


def _largest(values: Array) -> Array:
    """Largest (t,) of values (t, ..., n)."""
    return np.abs(values).max(axis=tuple(range(1, values.ndim)))


def _reach(x: Array) -> Array:
    """Accelerations (t,) by which errors in those of steps x (t, ..., n) are measured, in whatever units."""
    largest = _largest(x)
    return largest + EARLIER * np.maximum.accumulate(largest) + TINY


def _converged(size: Array, before: Array, x: Array, noise: Array | float, *, stalls: bool) -> Array:
    """Whether the last two sizes (t,) of corrections, which shrink by a constant factor, leave no more than a tolerance
    and rounding. The first one moves states of which it does not know what acts there: it leaves any. Where they
    stall at less than a part of the accelerations x (t, ..., n), all that is left is rounding.
    """
    reach, shrunk = _reach(x), size / np.maximum(before, 1e-300)
    left = np.where(np.isfinite(before), size * np.clip(shrunk, QUICKEST, 1.0), np.inf)
    return (left <= TOLERANCE * reach + noise) | (stalls & (shrunk > STALLED) & (size <= ROUNDING * reach))
