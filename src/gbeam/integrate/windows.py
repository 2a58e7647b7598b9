"""Nonlinear equations in time without compiling: windows of many steps solved together.

One call of the residual evaluates all stages of a window, and one correction of Newton's method for all its unknowns is
a recurrence over its steps: with the residual r of a step's stages, its Jacobian J with respect to their accelerations
x and L with respect to the state z before it,

    δx = −J⁻¹ (r + L δz),    δz₊ = g δz + d δx + (g z + d x − z₊).

The window slides: steps that have converged leave it at its beginning, and where its last one is near more follow, each
at first like the last, of which the next correction makes the linear response about that state. The derivatives at its
first state serve a whole window until corrections shrink slowly; then they are found at some of the steps that have
moved since they were, and interpolated between these, until corrections shrink fast for long. Steps that stay far are
taken out; where the first one does, the window begins anew and shorter, with a single step at last, which takes
Newton's method proper. Where derivatives are interpolated, which may be wrong, a step is left only if the residual is
small beside its forces, too.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, cast

import numpy as np

from gbeam.arrays.namespace import Array
from gbeam.arrays.tree import each_leaf
from gbeam.integrate.equations import NonlinearEquations, accelerations, exact, slopes, solved
from gbeam.integrate.linear import recurrence
from gbeam.integrate.sampled import Held, Sampling
from gbeam.integrate.schemes import Scheme, Tableau, stepped
from gbeam.integrate.steps import Steps

Piece = tuple[Any, ...]
FIRST, MOST, LONGEST = 100, 200, 1000  # steps in a window: at first, at most, and where derivatives hold all along
NEAR, APART, FAR = 4, 8, 24  # stages between derivatives: at least, at first, and at most
NEAREST = 6  # derivatives, between which others are found
AHEAD, ENOUGH = 400, 100  # steps whose drives are evaluated at once, and whose ends are found together, at least
FEW = 64  # steps under way, up to which more follow: of many, a call of the residual costs little beside its sums
LATE, ALONE = 6, 25  # corrections of a step until it is near, and of a single one, or the first, until it converges
HALVINGS = 8  # of a correction of a single step
MOVED, STALE = 0.3, 1.0  # sizes of a correction of steps that are far, and of several after which derivatives are old
QUICK = 2  # corrections until the last step is near, up to which more steps follow it the next time
SLOW, FAST = 0.5, 0.01  # of the last correction: where one is larger, derivatives are closer, where smaller farther
QUICKEST, STALLED = 0.01, 0.9  # factors of corrections: none is thought to be smaller, and where they do not shrink
TOLERANCE, ROUNDING = 1e-12, 1e-6  # of the largest acceleration: error left by the last correction, and where it stalls
STUCK = 4  # corrections of a step from which on, where they do not shrink, its inputs' rounding is asked for, too
TINY = float(np.finfo(float).tiny)
CANCELLED = 100 * float(np.finfo(float).eps)  # of the forces at a coordinate, each a sum of many: their rounding
BALANCED = 1e-9  # of the forces at a step: what is left of them where a correction may be the last
SUMMED = 1e-10  # of the largest acceleration: rounding, which adds up over steps, where corrections cease to be quick
SETTLED = 1e-9  # of the largest acceleration: error left by a correction after which samples are taken no more
GROWN = 10.0  # times the rounding of steps that have converged, which is known, unlike that of iterates that diverge
EARLIER = 0.01  # of the largest acceleration before a step, whose own may all vanish: to be told from none


def windows(
    equations: NonlinearEquations, scheme: Scheme, q: Array, qd: Array, steps: Steps, samples: Sampling | None = None
) -> Iterator[Piece]:
    """Integrate, and take the `samples` of controllers; yields pieces of kept q, q̇, q̈ (k, n) and flags (k,) of those
    solved, first the initial state. q̈ is left out unless the scheme's last stage is the end of the step.
    """
    if not q.size:  # all motion is prescribed
        empty = np.zeros((1 + np.count_nonzero(steps.kept), 0))
        yield from ((piece, piece, piece, np.ones(len(piece), dtype=bool)) for piece in (empty[:1], empty[1:]))
        return
    drive, residual = equations.drive, stepped(equations, scheme, steps, len(q))

    def demanded(t: Any, q: Array, qd: Array) -> Array:
        return accelerations(exact(residual), q[None], qd[None], drive(np.array([t])))[0]

    with np.errstate(all="ignore"):  # of iterates that diverge
        qdd = demanded(steps.first[0], q, qd)
    yield *(x[None] for x in (q, qd, qdd)[: 2 + scheme.ends]), np.array([True])
    window, begin = _Window(residual, drive, scheme, steps, samples), 0
    # A scheme whose last stage is the end of a step begins anew after a jump: no window goes beyond one.
    for end in np.append(np.flatnonzero(steps.anew[:-1]) + 1 if scheme.ends else [], len(steps)).astype(int):
        window.begin(scheme.tableau(steps.length[begin]).first @ np.stack([q, qd, qdd]), qdd)
        while begin < end:
            with np.errstate(all="ignore"):
                converged = window.solve(end, min(end, begin + ENOUGH))
                if window.first > begin:
                    ended = window.ended()
                    q, qd = ended[0][-1], ended[1][-1]
                    if scheme.ends and window.first == end and steps.anew[end - 1]:
                        qdd, ended[2][-1] = (demanded(time[end - 1], q, qd) for time in (steps.resume, steps.end))
                    kept = steps.kept[begin : window.first]
                    yield *(ends[kept] for ends in ended), np.ones(np.count_nonzero(kept), dtype=bool)
            if not converged:
                if window.sampling is not None:
                    window.sampling.stopped(window.first)
                yield *np.full((2 + scheme.ends, 1, len(qdd)), np.nan), np.array([False])
                return
            begin = window.first


class _Window:
    """The steps under way, from number `first` on, corrected in place: states z (t + 1, m, n) and accelerations x
    (t, s, n) of stages, with their residual `left` (t, s n). `slope` holds K, C and M (1 or t, s, 3, n, n), found at
    stages `apart` from one another, `reached` (3, n, n) those where the window began. Rows of `corrections` (5, t) are
    the size of a step's last one, the same as a share of its accelerations, their number, the sum of the shares since
    its derivatives were found, and the least factor by which one shrank by the same derivatives.
    """

    z: Array
    x: Array
    start: Array
    slope: Any
    reached: Array
    left: Array
    maps: Any
    corrections: Array
    most: float

    def __init__(self, residual: Any, drive: Any, scheme: Scheme, steps: Steps, sampling: Sampling | None) -> None:
        self.residual, self.drive, self.scheme, self.steps, self.sampling = residual, drive, scheme, steps, sampling
        self.first, self.apart, self.more, self.again = 0, FAR + 1, FIRST, LONGEST
        self.ahead, self.driven, self.held = range(0), cast(Any, None), cast(Any, None)
        self.done, self.lengths = list[tuple[Array, ...]](), np.zeros(0)

    def begin(self, z: Array, x: Array) -> None:
        """Begin with no step, from a state z (m, n) and accelerations (n,)."""
        self.z, self.x, self.start, self.slope = z[None], np.zeros((0, len(self.scheme.offsets), len(x))), x, None
        self.corrections, self.most, self.maps = np.zeros((5, 0)), np.inf, None

    @property
    def even(self) -> bool:
        """True if the derivatives at its first state serve a whole window."""
        return self.apart > FAR

    @property
    def _sampled(self) -> Held | None:
        """Commands to be corrected: none where they have settled."""
        return None if self.held is None or self.held.settled else self.held

    def solve(self, end: int, enough: int) -> bool:
        """Correct the steps of the window, all before `end`, by Newton's method until the first `enough` steps of the
        run have converged and left; return False where a single step fails. Flags are (t,), one a step.
        """
        while self.first < enough:
            self._follow(end)
            states = self._states()
            self._differentiate(states)
            self._factor(states)
            size, moved, count, since, least = self.corrections  # its rows, written in place
            fresh, before, last_far, alone = since == 0, size.copy(), not moved[-1] <= MOVED, len(size) == 1
            forces = self._forces(states)
            rounding = self._rounding(forces) if count.any() else 0 * size  # which a first one hides
            size[:] = self._correct(states, *self.maps)
            count += 1
            if alone:
                self._shorten(self.maps[0])
            reach = _reach(self.x)
            moved[:] = size / reach
            if self.held is not None:
                self.held.settled = bool((size * QUICKEST <= SETTLED * reach).all())
            if last_far and moved[-1] <= MOVED and count[-1] <= QUICK:
                self.more = min(self.more + self.more // 2 + 1, LONGEST)
            # By derivatives of another state corrections may shrink slowly without being rounding.
            quick, noise = least <= FAST, np.minimum(rounding, self.most)
            stuck = (count >= STUCK) & ~(size <= SLOW * before)
            loads = self._of_inputs(states) if stuck.any() else 0 * forces
            noise = noise + self._left_of(loads)
            good = _converged(size, before, reach, noise, fresh=fresh, quick=quick)
            # Interpolated from states far away, derivatives may be far too large, and corrections by them small.
            trusted = (alone & fresh) | (len(self.slope) == 1 and (self.slope == self.reached).all())
            balanced = _largest(self.left) <= BALANCED * _largest(forces) + CANCELLED * _largest(loads)
            doubtful = good & ~trusted & ~balanced
            good &= ~doubtful
            least[:] = np.fmin(least, size / np.where(fresh | np.isinf(before), np.nan, before))
            slow = (~good & (count > 1) & ~(size <= SLOW * before)) | (alone & doubtful)
            since[:] = np.where(slow, np.inf, since + moved)
            if slow.any():
                self.apart = APART if self.even else max(self.apart // 2, NEAR)
            elif (size < FAST * before).all():
                self.apart += 1
            lost = ~np.isfinite(size) | (~(moved <= MOVED) & (count >= (ALONE if alone else LATE)))
            lost[0] |= count[0] >= ALONE
            if self.sampling is None or good.all():
                done = _first(good)
                self._leave(done, rounding)
                lost = lost[done:]
            if lost.any() and not self._withdraw(int(np.argmax(lost))):
                return False
        return True

    def _follow(self, end: int) -> None:
        """Append steps before `end`, at first like the last one, if that is near its solution."""
        count = len(self.x)
        if count and (self.sampling is not None or count > FEW or self.again == 1):
            return
        if count and not self.corrections[1, -1] <= MOVED:
            return
        longest = LONGEST if self.slope is not None and len(self.slope) == 1 else MOST
        added = min(self.more, end - self.first - count, longest - count)
        if added <= 0:
            return
        last = self.x[-1:, -1:] if count else self.start
        if not count and self.even:
            self.slope = None
        self.z = np.concatenate([self.z, np.repeat(self.z[-1:], added, axis=0)])
        self.x = np.concatenate([self.x, np.broadcast_to(last, (added, *self.x.shape[1:]))])
        if self.slope is not None and len(self.slope) == count > 1 and not self.even:
            of_last = np.broadcast_to(self.slope[-1:, -1:], (added, *self.slope.shape[1:]))
            self.slope = np.concatenate([self.slope, of_last])
        elif self.slope is not None:
            self.slope, self.maps = self.slope[-1:, -1:], None
        uncorrected = np.repeat([[np.inf], [np.inf], [0.0], [0.0], [np.inf]], added, axis=1)
        self.corrections = np.concatenate([self.corrections, uncorrected], axis=1)
        self._place()

    def _place(self) -> None:
        """Set tableau, times and inputs of the steps under way; drives are evaluated for `AHEAD` steps at once."""
        stages, last = len(self.scheme.offsets), self.first + len(self.x)
        if last > self.ahead.stop:
            self.ahead = range(self.first, min(max(last, self.first + AHEAD), len(self.steps)))
            ahead = self.steps[self.ahead.start : self.ahead.stop]
            self.times = np.stack([ahead.times(offset) for offset in self.scheme.offsets], axis=1).ravel()
            self.driven = self.drive(self.times)
        length, begin = self.steps.length[self.first : last], self.first - self.ahead.start
        lengths = length[:1] if (length == length[0]).all() else length
        if not np.array_equal(lengths, self.lengths):
            t: Tableau = self.scheme.tableau(lengths)
            rows = [np.concatenate(pair, axis=-1) for pair in ((t.w_q, t.c_q), (t.w_v, t.c_v))]
            self.lengths, self.t, self.weights = lengths, t, np.stack(rows, axis=1)
        under_way = slice(stages * begin, stages * (begin + len(length)))
        self.stage_times = self.times[under_way]
        self.inputs = self.free = each_leaf(lambda leaf: leaf[under_way], self.driven)
        if self.sampling is not None:
            self.maps = None
            self.held = Held(self.sampling, self.first, len(length))
            self.held.begin(self.z[:-1])
            self.inputs = self.held.driven(self.free, stages)

    def _leave(self, count: int, rounding: Array) -> None:
        """Move the first `count` steps, which have converged to their `rounding` (t,), out of the window to `done`."""
        if not count:
            return
        z, x, t = self.z[:count], self.x[:count], self.t
        end_z, end_x = (weights if len(weights) == 1 else weights[:count] for weights in (t.end_z, t.end_x))
        ends = end_z @ z + end_x @ x
        self.done.append((ends[:, 0], ends[:, 1], *([x[:, -1]] if self.scheme.ends else [])))
        self.start, self.most = x[-1, -1], GROWN * float(rounding[:count].max())
        self.first, self.again = self.first + count, LONGEST
        self._keep(slice(count, None))

    def _keep(self, kept: slice) -> None:
        """Reduce the window to a slice of its steps, the first or the last."""
        states, count = slice(kept.start, kept.stop if kept.stop is None else kept.stop + 1), len(self.x)
        self.z, self.x, self.corrections = self.z[states], self.x[kept], self.corrections[:, kept]
        if len(self.slope) == count > 1:
            self.slope = self.slope[kept] if len(self.x) else self.slope[-1:, -1:]
        self.maps = self._maps_of(kept)
        if len(self.x):
            self._place()

    def _withdraw(self, first: int) -> bool:
        """Take out the steps from `first` on, which stay far, or begin anew with fewer where that is the window's own
        first; return False where the window is a single step.
        """
        if first:
            self.more = max(min(self.more, len(self.x)) // 2, 1)
            self._keep(slice(None, first))
            return True
        if len(self.x) == self.again == 1:
            return False
        self.more = self.again = max(min(len(self.x), self.again) // 4, 1)
        self.begin(self.z[0], self.start)
        return True

    def ended(self) -> tuple[Array, ...]:
        """q, q̇ and, where the scheme has them, q̈ (t, n) at the ends of the steps that have left since the last call."""
        ends = tuple(map(np.concatenate, zip(*self.done, strict=True)))
        self.done = []
        return ends

    def _states(self) -> Array:
        """q, q̇, q̈ (3, t s, n) at the stages."""
        both = self.weights @ np.concatenate([self.z[:-1], self.x], axis=1)[:, None]
        return np.concatenate([both, self.x[:, None]], axis=1).swapaxes(0, 1).reshape(3, -1, self.x.shape[-1])

    def _differentiate(self, states: Array) -> None:
        """Renew K, C and M from the first step on whose derivatives are old, found at some stages and interpolated;
        where there are none yet, find them at the first stage alone.
        """
        (count, stages, n), since = self.x.shape, self.corrections[3]

        def function(*state: Any) -> Array:
            return slopes(self.residual, *state).swapaxes(0, 1)

        if self.slope is None:
            self.slope = self._between(function, states, None)[:, None]
            self.reached = self.slope[0, 0]
        stale = ~(since < np.inf if self.even and count > 1 else since <= (STALE if count > 1 else MOVED))
        if not stale.any():
            return
        first = int(np.argmax(stale))
        renewed = self._between(function, states, first).reshape(-1, stages, 3, n, n)
        self.slope = np.concatenate([np.broadcast_to(self.slope, (count, *renewed.shape[1:]))[:first], renewed])
        since[first:], self.maps = 0.0, self._maps_of(slice(first))

    def _between(self, function: Any, states: Array, first: int | None = 0) -> Array:
        """Values (t s, ...) of a function of states and inputs at all stages from step `first` on, interpolated between
        some; at the first stage of the window alone where `first` is None.
        """
        steps, stages, _ = self.x.shape
        begin, count = (0, 1) if first is None else (stages * first, stages * (steps - first))
        size = 1 + math.ceil((count - 1) / (1 if steps == 1 else self.apart))
        chosen = begin + np.linspace(0, count - 1, size).round().astype(int)
        if first is not None:  # of the first step all, so that it converges as by Newton's method
            chosen = np.union1d(chosen, begin + np.arange(stages))
        values = function(*states[:, chosen], each_leaf(lambda leaf: leaf[chosen], self.inputs))
        if len(chosen) == 1:
            return values
        return _interpolated(self.stage_times[chosen], values, self.stage_times[begin : begin + count])

    def _factor(self, states: Array) -> None:
        """Complete `maps` by those of steps that have none or new derivatives: J⁻¹ (t, s n, s n), J⁻¹ L (t, s n, m n)
        and S = g − d J⁻¹ L, from δz to δz₊ (t, m n, m n); one of each where all steps are alike.
        """
        (*_, stages, m), (count, _, n) = self.t.w_q.shape, self.x.shape
        done = 0 if self.maps is None else len(self.maps[0])
        if done in (1, count):
            return
        t = self.t if len(self.t.d) == 1 else each_leaf(lambda leaf: leaf[done:], self.t)
        jacobian, by_state = t.jacobians(*np.moveaxis(self.slope if len(self.slope) == 1 else self.slope[done:], 2, 0))
        unit = np.broadcast_to(np.eye(stages * n), jacobian.shape)
        inverse, answer = np.split(solved(jacobian, np.concatenate([unit, by_state], axis=-1)), [stages * n], axis=-1)
        step = (t.g[:, :, None, :, None] * np.eye(n)[:, None, :]).reshape(-1, m * n, m * n)
        if self.held is not None:
            self.held.push(inverse, t, self._between(self.held.sampling.onto, states))
        by_stages = t.d @ answer.reshape(-1, stages, n * m * n)
        maps = inverse, answer, step - by_stages.reshape(-1, m * n, m * n)
        self.maps = maps if not done else tuple(map(np.concatenate, zip(self.maps, maps, strict=True)))

    def _forces(self, states: Array) -> Array:
        """Sizes (t, s n) of the forces that cancel at stages, |K| |q| + |C| |q̇| + |M| |q̈|, derived where it began."""
        return (np.abs(self.reached) @ np.abs(states).swapaxes(1, 2)).sum(axis=0).T.reshape(len(self.x), -1)

    def _of_inputs(self, states: Array) -> Array:
        """Sizes (t, s n) of the forces if every component of an input changed by the largest: a weight counts even
        where it acts across all that a joint lets move.
        """
        shifted = each_leaf(lambda leaf: leaf + CANCELLED * np.abs(leaf).max(initial=0.0), self.inputs)
        change = self.residual(*states, shifted) - self.residual(*states, self.inputs)
        return np.asarray(np.abs(change).reshape(len(self.x), -1) / CANCELLED)

    def _left_of(self, forces: Array) -> Array:
        """Largest accelerations (t,) that the rounding of forces (t, s n) makes where they cancel."""
        return _largest(CANCELLED * _products(np.abs(self.maps[0]), forces))

    def _rounding(self, forces: Array) -> Array:
        """Accelerations (t,) that are rounding, which no correction takes away; a window's first ones bound all."""
        rounding = self._left_of(forces)
        if self.most == np.inf:
            self.most = GROWN * float(rounding.max())
        return rounding

    def _maps_of(self, kept: slice) -> Any:
        """Maps of a slice of the steps, to be kept; None where they are found anew: one for all, or by controllers."""
        if self.maps is None or self.held is not None:
            return None
        maps = tuple(each[kept] for each in self.maps)
        return maps if len(maps[0]) > 1 else None

    def _correct(self, states: Array, inverse: Array, answer: Array, step: Array) -> Array:
        """Correct states and stages of all steps by Newton's method; return each step's largest change of x, (t,)."""
        t, count = self.t, len(self.x)
        self.left = self.residual(*states, self.inputs).reshape(count, -1)
        by_residual = _products(inverse, self.left)
        defect = t.g @ self.z[:-1] + t.d @ (self.x - by_residual.reshape(self.x.shape)) - self.z[1:]
        moved = self._moved(step, defect.reshape(count, -1))
        change = (by_residual + _products(answer, moved[:-1])).reshape(self.x.shape)
        if self._sampled is not None:
            change = change + self._sampled.changed(self.x.shape)
            self.inputs = self._sampled.driven(self.free, self.x.shape[1])
        self.change = moved.reshape(self.z.shape), change
        self.z += self.change[0]
        self.x -= change
        return _largest(change)

    def _moved(self, step: Array, defect: Array) -> Array:
        """Changes δz (t + 1, m n) of states, δz₊ = S δz + defect, by `step` S (1 or t, m n, m n), `defect` (t, m n)."""
        count, held = len(defect), self._sampled
        if len(step) > 1 and held is None:
            return recurrence(np, np.concatenate([step, defect[..., None]], axis=-1), np.zeros(defect.shape[1]))
        moved = np.zeros((count + 1, defect.shape[1]))
        if held is None:  # sums of powers of one map, each twice as long as the last
            moved[1:], power, reach = defect, step[0].T, 1
            while reach < count:
                moved[1 + reach :] += moved[1:-reach] @ power
                power, reach = power @ power, 2 * reach
            return moved
        held.measure(self.z[:-1])
        by_step = zip(np.broadcast_to(step, (count, *step.shape[1:])), defect, moved[:-1], moved[1:], strict=True)
        for k, (of_step, gap, before, after) in enumerate(by_step):
            after[:] = of_step.dot(before) + gap + held.sampled(k, before)
        return moved

    def _shorten(self, inverse: Array) -> None:
        """Halve a single step's correction until the next would be smaller: friction or a stop bends the residual."""
        (state, change), share = self.change, 1.0
        whole = np.linalg.norm(change)
        for _ in range(HALVINGS):
            following = inverse @ self.residual(*self._states(), self.inputs).reshape(1, -1, 1)
            if np.linalg.norm(following) <= (1 - share / 2) * whole or whole <= ROUNDING * np.linalg.norm(self.x):
                return
            share /= 2
            self.z -= share * state
            self.x += share * change


def _products(matrices: Array, vectors: Array) -> Array:
    """Products (t, a) of matrices (1 or t, a, b) and vectors (t, b)."""
    return vectors @ matrices[0].T if len(matrices) == 1 else (matrices @ vectors[..., None])[..., 0]


def _interpolated(at: Array, values: Array, points: Array) -> Array:
    """Values (p, ...) at times `points` (p,), by polynomials through the nearest of values (k, ...) at times (k,)."""
    size = min(NEAREST, len(at))
    first: Array = np.clip(np.searchsorted(at, points) - size // 2, 0, len(at) - size)
    index = first[:, None] + np.arange(size)
    near, diagonal = at[index], np.eye(size, dtype=bool)
    numerator = np.where(diagonal, 1.0, points[:, None, None] - near[:, None, :])
    denominator = np.where(diagonal, 1.0, near[:, :, None] - near[:, None, :])
    weight = (numerator / denominator).prod(axis=-1)
    weights = np.zeros((len(points), len(at)))
    np.put_along_axis(weights, index, weight, axis=1)
    return (weights @ values.reshape(len(at), -1)).reshape(len(points), *values.shape[1:])


def _first(flags: Array) -> int:
    """Number of flags before the first that is false."""
    return len(flags) if flags.all() else int(np.argmin(flags))


def _largest(values: Array) -> Array:
    """Largest (t,) of values (t, ..., n)."""
    return np.abs(values).max(axis=tuple(range(1, values.ndim)))


def _reach(x: Array) -> Array:
    """Size (t,) of the accelerations x (t, ..., n) of steps, to which errors are related: beside what came before."""
    largest = _largest(x)
    return largest + EARLIER * np.maximum.accumulate(largest) + TINY


def _converged(size: Array, before: Array, reach: Array, noise: Array, *, fresh: Array, quick: Array) -> Array:
    """Flags (t,) of steps whose last correction, `size`, leaves no more error than a tolerance and rounding, `noise`.
    Corrections shrink by a constant factor, size / before; by `fresh` derivatives it is unknown and taken as 1. After
    the first correction any error may be left. What is left is rounding, too, where small corrections stall: by fresh
    derivatives, or after `quick` ones, for the rounding of earlier steps adds to a step's own.
    """
    again, factor = np.isfinite(before), size / np.maximum(before, 1e-300)
    left = np.where(again, size * np.where(fresh, 1.0, np.clip(factor, QUICKEST, 1.0)), np.inf)
    stalled = (fresh & again & (factor > STALLED)) | (quick & (factor > SLOW) & (size <= SUMMED * reach))
    return (left <= TOLERANCE * reach + noise) | (stalled & (size <= ROUNDING * reach))
