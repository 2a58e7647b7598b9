"""Many runs of one shape at once, compiled by JAX: a step of all of them is one program.

The runs share their sizes, the scheme and the number of steps; equations, initial states, drives and lengths of steps
are each one's own. The steps are those that :func:`gbeam.integrate.driver.integrate` takes.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from itertools import tee
from typing import Any, cast

import jax
import numpy as np

from gbeam.integrate import lanes, newton
from gbeam.integrate.equations import Fitted, LinearEquations, LinearTerms, NonlinearEquations, Trajectory
from gbeam.integrate.newton import chunks, stretches
from gbeam.integrate.schemes import Scheme, added, to_modes
from gbeam.integrate.steps import Steps
from gbeam.numerics.eigen import symmetric

Array = Any
Histories = tuple[Array, Array, Array]  # q, q̇, q̈ of b runs at the start and the ends of the steps, (b, t + 1, n) each


@dataclass(frozen=True, eq=False)
class Run:
    """A run from q, qd (n,); `common` is what all runs' nonlinear residuals share, multiplied for all at once."""

    equations: LinearEquations | NonlinearEquations
    q: Array
    qd: Array
    steps: Steps
    scheme: Scheme
    common: Any = None

    @cached_property
    def shape(self) -> Hashable | None:
        """Key of runs that can be integrated together; None of one that has to be integrated alone."""
        steps = self.steps
        if isinstance(self.equations, NonlinearEquations):
            leaves, form = self.residual
            alike = self.equations.vibrates, len(steps), steps.anew.tobytes()
            return "nonlinear", form, *map(np.shape, leaves), *alike
        if self.terms is None or (self.scheme.ends and steps.anew.any()):
            return None
        return "linear", len(self.q), len(steps), self.parts

    @cached_property
    def residual(self) -> tuple[list[Array], Any]:
        """Arrays and form of the residual of nonlinear equations."""
        assert isinstance(self.equations, NonlinearEquations)
        leaves, form = jax.tree.flatten(self.equations.residual)
        return leaves, form

    @property
    def terms(self) -> LinearTerms | None:
        """Terms of linear equations that have them."""
        return getattr(self.equations, "terms", None)

    @cached_property
    def inputs(self) -> Any:
        """Inputs (1 + t s, ...) of linear equations: first, at every stage, and at the end of a step without one."""
        steps, offsets = self.steps, self.scheme.offsets
        at = [steps.times(offset) for offset in offsets] + ([] if self.scheme.ends else [steps.end])
        return self.equations.drive(np.append(steps.first[:1], np.stack(at, axis=1)))

    @property
    def at_times(self) -> Any:
        """Inputs at the result's times; None where these are not known, for they jump at the first."""
        if self.steps.first[0] != self.steps.begin[0]:
            return None
        kept = np.append(True, self.steps.kept)
        return jax.tree.map(lambda leaf: leaf[:: lanes.stages(self.scheme)][kept], self.inputs)

    @cached_property
    def features(self) -> Array:
        """Features of the inputs of linear equations, (1 + t s, k)."""
        assert isinstance(self.equations, LinearEquations) and self.equations.features is not None
        return self.equations.features(self.inputs)

    @cached_property
    def parts(self) -> lanes.Parts:
        """Indices for C, K and F of features with a term that is not zero, and that are not zero all the time."""
        assert self.terms is not None
        driven = np.any(self.features, axis=0)
        c, k, f = (tuple(np.flatnonzero(driven & some).tolist()) for some in self.terms.nonzero)
        return c, k, f

    @property
    def alive(self) -> LinearTerms:
        """The terms of these features."""
        assert self.terms is not None
        return LinearTerms(*(term[list(part)] for term, part in zip(self.terms.each, self.parts, strict=True)))


def integrate_together(runs: Sequence[Run]) -> list[Trajectory | None]:
    """Integrate runs of one shape; None in place of one that has to be integrated alone, for its corrections failed."""
    solve = _linear if isinstance(runs[0].equations, LinearEquations) else _nonlinear
    histories, solved = solve(runs)
    trajectories = []
    for run, fine, *state in zip(runs, solved, *histories, strict=True):
        kept = np.append(True, run.steps.kept)
        time = np.append(run.steps.begin[0], run.steps.end)
        if not kept.all():
            time, *state = (x[kept] for x in (time, *state))
        trajectories.append(Trajectory(time, *state) if fine and np.isfinite(state[2]).all() else None)
    return trajectories


def _stacked(parts: Sequence[Any], axis: int = 0) -> Any:
    def stack(first: Any, *others: Any) -> Any:
        if all(other is first for other in others):  # of one structure, most often
            return np.repeat(np.expand_dims(first, axis), len(parts), axis)
        return np.stack([first, *others], axis=axis)

    return jax.tree.map(stack, *parts)


def _linear(runs: Sequence[Run]) -> tuple[Histories, Array]:
    scheme, count, stages = runs[0].scheme, len(runs[0].steps), lanes.stages(runs[0].scheme)
    needed = np.unique(np.concatenate(runs[0].parts)).astype(int)
    parts = tuple(tuple(np.searchsorted(needed, part).tolist()) for part in runs[0].parts)
    features = np.stack([run.features[:, needed] for run in runs], axis=-1)
    lengths = _stacked([run.steps.length for run in runs], axis=-1)
    terms = _stacked([run.alive for run in runs], axis=-1)
    equations: list[Any] = [run.equations for run in runs]
    mass, q, qd = _stacked([(e.mass, run.q, run.qd) for e, run in zip(equations, runs, strict=True)], axis=-1)
    of_mass, damping = _stacked(
        [added(e, scheme, run.steps.longest) for e, run in zip(equations, runs, strict=True)], -1
    )
    inverse = np.moveaxis(np.linalg.inv(np.moveaxis(mass, -1, 0)), 0, -1)
    qdd = lanes.accelerations(inverse, terms, features[0], parts, q, qd)
    z = np.einsum("bmk,knb->mnb", scheme.tableau(lengths[0]).first, np.stack([q, qd, qdd]))
    histories = np.empty((3, len(runs), count + 1, len(q)))
    histories[:, :, 0] = np.moveaxis(np.stack([q, qd, qdd]), -1, 1)
    features = features[1:].reshape(count, stages, *features.shape[1:])
    for begin in range(0, count, lanes.STEPS):
        # The last piece is filled, so that one program serves every duration.
        chosen, those = np.minimum(np.arange(begin, begin + lanes.STEPS), count - 1), min(lanes.STEPS, count - begin)
        arguments = mass + of_mass, damping, inverse, terms, scheme.unit, z, lengths[chosen], features[chosen], those
        z, piece = lanes.steps(*arguments, parts=parts, ends=scheme.ends)
        for whole, part in zip(histories, piece, strict=True):
            whole[:, begin + 1 : begin + 1 + those] = np.asarray(part)[:, :those]
    return (histories[0], histories[1], histories[2]), np.ones(len(runs), dtype=bool)


def _over_runs(solve: Callable[..., Any], *more_axes: int | None) -> Callable[..., Any]:
    """A function of a residual and more for many runs, (form, axes, leaves, ...): the residual's by arrays and axes."""

    @partial(jax.jit, static_argnums=(0, 1))
    def over_runs(form: Any, axes: tuple[int | None, ...], leaves: list[Array], *args: Any) -> Any:
        def of_one(leaves: list[Array], *args: Any) -> Any:
            return solve(jax.tree.unflatten(form, leaves), *args)

        return jax.vmap(of_one, in_axes=(list(axes), *more_axes))(leaves, *args)

    return over_runs


_slopes = _over_runs(newton.slopes, 0, 0, 0, 0)
_accelerations = _over_runs(newton.accelerations, 0, 0, 0)
_steps = _over_runs(newton.steps, 0, 0, 0, 0, None, None)


Residuals = tuple[Any, tuple[int | None, ...], list[Array]]  # form, axes and arrays: no axis of those that are common


def _residuals(runs: Sequence[Run]) -> Residuals:
    """The runs' residuals."""
    common = {id(leaf) for leaf in jax.tree.leaves(runs[0].common)}
    every = list(zip(*(run.residual[0] for run in runs), strict=True))
    axes = [None if id(leaf[0]) in common and all(x is leaf[0] for x in leaf) else 0 for leaf in every]
    leaves = [leaf[0] if axis is None else _stacked(leaf) for leaf, axis in zip(every, axes, strict=True)]
    return runs[0].residual[1], tuple(axes), leaves


def _fitted(runs: Sequence[Run], residuals: Residuals) -> Residuals:
    """The residuals that steps solve: fitted to their modes, as by :func:`gbeam.integrate.schemes.stepped`."""
    exponent, equations = runs[0].scheme.exponent, cast(NonlinearEquations, runs[0].equations)
    if exponent is None or not equations.vibrates:
        return residuals
    form, axes, leaves = residuals
    zero, first = np.zeros((len(runs), len(runs[0].q))), runs[0].steps.first[:1]
    still = jax.tree.map(lambda leaf: np.zeros((len(runs), *np.shape(leaf)[1:])), equations.drive(first))
    k, c, m = (symmetric(np.asarray(each)) for each in _slopes(*residuals, zero, zero, zero, still))
    more = to_modes(exponent, [run.steps.longest for run in runs], m, c, k)
    leaves, form = jax.tree.flatten(Fitted(jax.tree.unflatten(form, leaves), *more))
    return form, (*axes, 0, 0), leaves


def _nonlinear(runs: Sequence[Run]) -> tuple[Histories, Array]:
    scheme = runs[0].scheme
    equations: list[Any] = [run.equations for run in runs]
    residual = _fitted(runs, _residuals(runs))
    q, qd = (np.stack([getattr(run, name) for run in runs]) for name in ("q", "qd"))

    def accelerations(times: Sequence[float], q: Array, qd: Array) -> Array:
        inputs = _stacked([e.drive(np.array([t])) for e, t in zip(equations, times, strict=True)])
        return np.asarray(_accelerations(*residual, q[:, None], qd[:, None], inputs))[:, 0]

    def begun(q: Array, qd: Array, qdd: Array, lengths: Sequence[float]) -> newton.Carry:
        x = np.broadcast_to(qdd[:, None], (len(q), len(scheme.offsets), q.shape[1]))
        return newton.Carry(scheme.tableau(np.array(lengths)).first @ np.stack([q, qd, qdd], axis=1), x, x)

    qdd = accelerations([run.steps.first[0] for run in runs], q, qd)
    carry = begun(q, qd, qdd, [run.steps.length[0] for run in runs])
    pieces, sound = [[x[:, None] for x in (q, qd, qdd)]], np.ones(len(runs), dtype=bool)
    equal, size = Counter(run.steps for run in runs), newton.PER_JACOBIAN[scheme.order]
    laid = {steps: iter(tee(stretches(scheme, steps, size), count)) for steps, count in equal.items()}  # most are equal
    of_runs = [chunks(run.equations.drive, scheme, next(laid[run.steps])) for run in runs]
    for every in zip(*of_runs, strict=True):
        inside, ends = every[0].inside, [chunk.end for chunk in every]
        tableau, inputs, at_ends = _stacked([(chunk.tableau, chunk.inputs, chunk.at_ends) for chunk in every])
        carry, history = _steps(*residual, tableau, carry, inputs, at_ends, every[0].last, every[0].count)
        *piece, left = (np.asarray(values)[:, inside] for values in history)
        sound &= (left <= newton.ACCEPTED).all(axis=1)  # NaN is not
        if scheme.ends and ends[0].anew:
            q, qd = piece[0][:, -1], piece[1][:, -1]
            begin, final = (accelerations([getattr(end, at) for end in ends], q, qd) for at in ("resume", "end"))
            carry, piece[2][:, -1] = begun(q, qd, begin, [end.following for end in ends]), final
        pieces.append(piece)
    q, qd, qdd = (np.concatenate(part, axis=1) for part in zip(*pieces, strict=True))
    return (q, qd, qdd), sound
