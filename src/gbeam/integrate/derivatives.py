"""Derivatives of a window of steps: K, C and M at their stages, when they are found anew, and what steps map by them.

Those at the window's first state serve the whole window until corrections shrink slowly. Then derivatives are found at
some of the steps that have moved since they were last found, and interpolated between these. That lasts until
corrections shrink fast for long.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from gbeam.arrays.namespace import Array
from gbeam.arrays.tree import each_leaf
from gbeam.arrays.types import Flags
from gbeam.integrate.equations import slopes, solve_systems
from gbeam.integrate.sampled import HeldCommands, Sampling
from gbeam.integrate.schemes import Tableau

# Speed: factors by which corrections of 14 runs become more if a number is half or twice as large (mean, and most).
# With NEAR or STALE twice as large, a chaotic run at long steps fails; of 12 starts of it, 0 to 2 do with any of these.
NEAR = 4  # stages between derivatives at least: half asks for 1.4 times the derivatives (3.5 times in one run)
APART = 8  # stages between derivatives at first; speed: 0.98, 0.96 (most 1.5)
FAR = 24  # stages between derivatives at most; beyond, those of one state serve all. Speed: 1.00, 1.00
NEAREST = 6  # derivatives, between which others are found
STALE = 1.0  # sum of corrections, as shares of the accelerations, after which derivatives are old; speed: 0.95, 1.04
STALE_ALONE = 0.3  # the same of a single step; speed: 1.00, 1.00


class Stages(NamedTuple):
    """Stages of t steps, s each: times (t s,), q, q̇, q̈ (3, t s, n), and inputs (t s, ...)."""

    times: Array
    states: Array
    inputs: Any


class Derivatives:
    """Derivatives of the residual at the stages of a window's steps, and the maps of steps that follow from them.

    `slope` holds K, C and M (1 or t, s, 3, n, n), which are computed at stages `spacing` from one another. `reached`
    (3, n, n) are those where the window began. `age` (t,) is the sum of the corrections, as shares of the
    accelerations, since a step's derivatives were computed. `maps` are J⁻¹ (t, s n, s n), J⁻¹ L (t, s n, m n) and S = g
    − d J⁻¹ L (t, m n, m n), from δz to δz₊. There is one of each where all steps are alike.
    """

    slope: Any
    reached: Array
    maps: Any
    age: Array

    def __init__(self, residual: Any, sampling: Sampling | None) -> None:
        self.residual, self.sampling, self.spacing = residual, sampling, FAR + 1
        self.begin()

    def begin(self) -> None:
        """Begin with no step."""
        self.slope, self.maps, self.age = None, None, np.zeros(0)

    @property
    def constant(self) -> bool:
        """True if the derivatives at its first state serve a whole window."""
        return self.spacing > FAR

    @property
    def has_one_set(self) -> bool:
        """True if all stages have the same derivatives."""
        return self.slope is not None and len(self.slope) == 1

    @property
    def fresh_steps(self) -> Flags:
        """Flags (t,) of the steps that have not been corrected by their derivatives yet."""
        flags: Flags = self.age == 0
        return flags

    @property
    def trusted_steps(self) -> Flags:
        """Flags (t,) of the steps whose derivatives are not interpolated.

        They are a step's own, or those where the window began.
        """
        is_single = len(self.age) == 1
        return (is_single & self.fresh_steps) | (self.has_one_set and (self.slope == self.reached).all())

    def extend(self, added: int) -> None:
        """Append steps with the derivatives of the last one, or of the stage whose derivatives serve all."""
        count = len(self.age)
        by_step = self.slope is not None and len(self.slope) == count > 1
        if not count and self.constant:
            self.slope = None  # a new window computes its own
        elif by_step and not self.constant:
            repeated = np.broadcast_to(self.slope[-1:, -1:], (added, *self.slope.shape[1:]))
            self.slope = np.concatenate([self.slope, repeated])
        elif self.slope is not None:
            self.slope, self.maps = self.slope[-1:, -1:], None
        self.age = np.append(self.age, np.zeros(added))

    def cut(self, count: int) -> None:
        """Take out all but the first `count` steps."""
        self._keep(slice(count))

    def leave(self, count: int) -> None:
        """Let the first `count` steps leave."""
        self._keep(slice(count, None))

    def _keep(self, rows: slice) -> None:
        """Keep a slice of the steps. If it is empty, the last derivatives serve the steps that follow."""
        count, self.age = len(self.age), self.age[rows]
        if len(self.slope) == count > 1:
            self.slope = self.slope[rows] if len(self.age) else self.slope[-1:, -1:]
        self.maps = self._maps_of(rows)

    def grow_old(self, shares: Array, slow: Flags, *, fast: bool) -> None:
        """Add the last corrections (t,), as shares of the accelerations, to the age of the derivatives.

        Where corrections shrink slowly, the derivatives are old at once, and the next ones are computed closer to one
        another; where all shrink fast, farther apart.
        """
        self.age = np.where(slow, np.inf, self.age + shares)
        if slow.any():
            self.spacing = APART if self.constant else max(self.spacing // 2, NEAR)
        elif fast:
            self.spacing += 1

    def renew(self, stages: Stages) -> None:
        """Compute K, C and M again from the first step whose derivatives are old to the last.

        They are computed at some of the stages, and interpolated between these. If there are none yet, they are
        computed at the first stage alone.
        """
        count = len(self.age)
        per_step, n = len(stages.times) // count, stages.states.shape[-1]

        def function(*state: Any) -> Array:
            return slopes(self.residual, *state).swapaxes(0, 1)

        if self.slope is None:
            self.slope = self._interpolate(function, stages, None)[:, None]
            self.reached = self.slope[0, 0]
        if count == 1:
            valid = self.age <= STALE_ALONE
        elif self.constant:
            valid = self.age < np.inf
        else:
            valid = self.age <= STALE
        if valid.all():
            return
        first = int(np.argmin(valid))
        renewed = self._interpolate(function, stages, first).reshape(-1, per_step, 3, n, n)
        self.slope = np.concatenate([np.broadcast_to(self.slope, (count, *renewed.shape[1:]))[:first], renewed])
        self.age[first:], self.maps = 0.0, self._maps_of(slice(first))

    def factor(self, stages: Stages, tableau: Tableau, commands: HeldCommands | None) -> None:
        """Compute the maps of steps that have none, or whose derivatives are new.

        The `commands` of controllers receive their effect on the steps.
        """
        (*_, per_step, m), count, n = tableau.w_q.shape, len(self.age), stages.states.shape[-1]
        done = 0 if self.maps is None else len(self.maps[0])
        if done in (1, count):
            return
        t = tableau if len(tableau.d) == 1 else each_leaf(lambda leaf: leaf[done:], tableau)
        slope = self.slope if self.has_one_set else self.slope[done:]
        jacobian, by_state = t.jacobians(*np.moveaxis(slope, 2, 0))
        # One solution of the linear systems gives J⁻¹ and J⁻¹ L.
        size = per_step * n
        unit = np.broadcast_to(np.eye(size), jacobian.shape)
        inverse, answer = np.split(solve_systems(jacobian, np.concatenate([unit, by_state], axis=-1)), [size], axis=-1)
        if commands is not None:
            commands.push(inverse, t, self._interpolate(commands.sampling.residual_slopes, stages, 0))
        # S = g − d J⁻¹ L
        step = (t.g[:, :, None, :, None] * np.eye(n)[:, None, :]).reshape(-1, m * n, m * n)
        by_stages = t.d @ answer.reshape(-1, per_step, n * m * n)
        maps = inverse, answer, step - by_stages.reshape(-1, m * n, m * n)
        self.maps = maps if not done else tuple(map(np.concatenate, zip(self.maps, maps, strict=True)))

    def forces(self, states: Array) -> Array:
        """Sizes (t, s n) of the forces that cancel at the stages: |K| |q| + |C| |q̇| + |M| |q̈|.

        K, C and M are the window's first ones.
        """
        sizes: Array = np.abs(self.reached) @ np.abs(states).swapaxes(1, 2)
        return sizes.sum(axis=0).T.reshape(len(self.age), -1)

    def accelerations(self, forces: Array) -> Array:
        """Upper bounds (t,) of the accelerations that forces of sizes (t, s n) make."""
        return np.abs(products(np.abs(self.maps[0]), forces)).max(axis=1)

    def _interpolate(self, function: Any, stages: Stages, first: int | None) -> Array:
        """Values (t s, ...) of a function of states and inputs at all stages from step `first` on.

        The function is evaluated at some of the stages, and interpolated at the others. Where `first` is None, the
        result is the value at the window's first stage alone.
        """
        steps = len(self.age)
        per_step = len(stages.times) // steps
        begin, count = (0, 1) if first is None else (per_step * first, per_step * (steps - first))
        size = 1 + math.ceil((count - 1) / (1 if steps == 1 else self.spacing))
        chosen = begin + np.linspace(0, count - 1, size).round().astype(int)
        if first is not None:  # all stages of the first step, so that it converges as by Newton's method
            chosen = np.union1d(chosen, begin + np.arange(per_step))
        values = function(*stages.states[:, chosen], each_leaf(lambda leaf: leaf[chosen], stages.inputs))
        if len(chosen) == 1:
            return values
        return interpolate(stages.times[chosen], values, stages.times[begin : begin + count])

    def _maps_of(self, rows: slice) -> Any:
        """Maps of a slice of the steps, or None if one serves all, or with controllers: these are computed again."""
        if self.maps is None or self.sampling is not None:
            return None
        maps = tuple(by_step[rows] for by_step in self.maps)
        return maps if len(maps[0]) > 1 else None


def products(matrices: Array, vectors: Array) -> Array:
    """Products (t, a) of matrices (1 or t, a, b) and vectors (t, b)."""
    return vectors @ matrices[0].T if len(matrices) == 1 else (matrices @ vectors[..., None])[..., 0]


def interpolate(times: Array, values: Array, points: Array) -> Array:
    """Interpolate values (k, ...) at ascending `times` (k,) at the times `points` (p,).

    The result (p, ...) is that of Lagrange's polynomials through the `NEAREST` values about each point.
    """
    size = min(NEAREST, len(times))
    first: Array = np.clip(np.searchsorted(times, points) - size // 2, 0, len(times) - size)
    index = first[:, None] + np.arange(size)
    nodes, diagonal = times[index], np.eye(size, dtype=bool)
    numerator = np.where(diagonal, 1.0, points[:, None, None] - nodes[:, None, :])
    denominator = np.where(diagonal, 1.0, nodes[:, :, None] - nodes[:, None, :])
    weight = (numerator / denominator).prod(axis=-1)
    weights = np.zeros((len(points), len(times)))
    np.put_along_axis(weights, index, weight, axis=1)
    return (weights @ values.reshape(len(times), -1)).reshape(len(points), *values.shape[1:])
