"""Many runs of one shape at once, compiled by JAX: a step of all of them is one program.

The runs share their sizes, the scheme and about the number of steps. Equations, initial states, drives and lengths of
steps are each one's own. The steps are those that :func:`gbeam.integrate.driver.integrate` takes.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from itertools import tee
from math import ceil, log
from typing import Any, cast

import jax
import jax.numpy as jnp
import numpy as np

from gbeam.arrays.namespace import Array, namespace
from gbeam.integrate import newton
from gbeam.integrate.equations import Fitted, LinearEquations, LinearTerms, NonlinearEquations, Trajectory
from gbeam.integrate.newton import chunks, stretches
from gbeam.integrate.schemes import Scheme, Tableau, fitting_terms, powers_of_step, to_modes
from gbeam.integrate.steps import Steps
from gbeam.numerics.eigen import symmetric

Parts = tuple[tuple[int, ...], ...]  # of C, K and F: which of the features each of their terms has
STEPS = 256  # per compiled call at most
NEARLY = 1.2  # numbers of steps within this ratio are taken together: the shorter runs are repeated at their end


@partial(jax.jit, static_argnames=("parts", "ends"))
def taken_together(
    mass: Array,
    damping: Array,
    inverse: Array,
    terms: LinearTerms,
    unit: Tableau,
    z: Array,
    lengths: Array,
    features: Array,
    count: Array,
    *,
    parts: Parts,
    ends: bool,
) -> tuple[Array, tuple[Array, ...]]:
    """Take the first `count` of t steps of b runs from z (m, n, b); return the next z, and q, q̇, q̈ (b, t, n).

    Matrices are (n, n, b), `lengths` (t, b). Features (t, s, k, b) are those at the stages and, unless the last stage
    `ends` the step, at its end. `inverse` is that of the true mass.
    """

    def step(z: Array, h: Array, phi: Array) -> tuple[Array, tuple[Array, Array, Array]]:
        """Take one step of all runs, of lengths h (b,); return the next z, and q, q̇, q̈ (n, b) at its end."""
        t = _tableau(unit, h)
        stages, (_, n, b) = len(t.c_q), z.shape
        c, k, f = (
            [_sum(matrix_terms, at_time, chosen) for at_time in phi]
            for matrix_terms, chosen in zip(terms.arrays, parts, strict=True)
        )
        # The compiler would compute these anew wherever they are read, and the matrix below for each of its pivots.
        c, k, f = jax.lax.optimization_barrier((c, k, f))
        # (c_v C + c_q K + M) x = F − C v₀ − K q₀ at all stages together
        q0, v0 = _combined(t.w_q, z), _combined(t.w_v, z)
        rows, damped = [], [c_stage + damping for c_stage in c[:stages]]
        for i in range(stages):
            blocks = [t.c_v[i, j] * damped[i] + t.c_q[i, j] * k[i] + (mass if i == j else 0.0) for j in range(stages)]
            right_side = f[i] - _times(damped[i], v0[i]) - _times(k[i], q0[i])
            rows.append(jnp.concatenate([*blocks, right_side[:, None]], axis=1))
        x = eliminate(jax.lax.optimization_barrier(jnp.concatenate(rows))).reshape(stages, n, b)
        q, qd = _combined(t.end_z, z) + _combined(t.end_x, x)
        qdd = x[-1] if ends else _times(inverse, f[-1] - _times(k[-1], q) - _times(c[-1], qd))
        return _combined(t.g, z) + _combined(t.d, x), (q, qd, qdd)

    def take_next(i: Any, state: Any) -> Any:
        z, history = state
        z, ends = step(z, lengths[i], features[i])
        put = partial(jax.lax.dynamic_update_index_in_dim, index=i, axis=0)
        return z, tuple(put(history_array, part) for history_array, part in zip(history, ends, strict=True))

    history = (jnp.zeros((len(lengths), *z.shape[1:])),) * 3
    z, history = jax.lax.fori_loop(0, count, take_next, (z, history))
    return z, tuple(jnp.moveaxis(x, -1, 0) for x in history)


def eliminate(rows: Array) -> Array:
    """Solve b small linear systems at once, by Gauss's elimination without pivoting.

    `rows` (n, n + 1, b) has their matrices and right-hand sides. The solutions are (n, b).
    """
    pivots = []
    while len(rows):
        pivots.append(rows[0, 1:] / rows[0, :1])
        rows = rows[1:, 1:] - rows[1:, :1] * pivots[-1]
    x: list[Array] = []
    for pivot in reversed(pivots):
        x.insert(0, pivot[-1] - sum(pivot[j] * value for j, value in enumerate(x)))
    return jnp.stack(x)


def stage_count(scheme: Scheme) -> int:
    """Number of times of a step at which its features are read."""
    return len(scheme.offsets) + (not scheme.ends)


def accelerations(inverse: Array, terms: LinearTerms, features: Array, parts: Parts, q: Array, qd: Array) -> Array:
    """Accelerations q̈ (n, b) that satisfy the equations at features (k, b)."""
    c, k, f = (_sum(matrix_terms, features, chosen) for matrix_terms, chosen in zip(terms.arrays, parts, strict=True))
    return _times(inverse, f - _times(k, q) - _times(c, qd))


def _tableau(unit: Tableau, h: Array) -> Tableau:
    """The scheme's tableau at steps of lengths h (b,), which are the last axis of its arrays."""
    powers = jnp.stack([1 / h**2, 1 / h, jnp.ones_like(h), h, h**2])
    shapes = powers_of_step(*unit.d.shape)
    return Tableau(**{name: getattr(unit, name)[..., None] * powers[power + 2] for name, power in shapes.items()})


def _sum(terms: Array, features: Array, chosen: tuple[int, ...]) -> Array:
    """Sum (..., b) of terms (j, ..., b), each multiplied by its feature: `chosen` (j,) among features (k, b)."""
    if not chosen:
        return namespace(terms).zeros(terms.shape[1:])
    return sum(term * features[i] for term, i in zip(terms, chosen, strict=True))


def _times(matrices: Array, vectors: Array) -> Array:
    """Products of matrices (n, n, b) and vectors (n, b); a compiled sum along an axis is slower."""
    return sum(matrices[:, j] * vector for j, vector in enumerate(vectors))


def _combined(weights: Array, vectors: Array) -> Array:
    """Sums of vectors (m, n, b) with weights (s, m, b), (s, n, b)."""
    return jnp.sum(weights[:, :, None] * vectors, axis=1)


Histories = tuple[Array, Array, Array]  # q, q̇, q̈ of b runs at the start and the ends of the steps, (b, t + 1, n) each


@dataclass(frozen=True, eq=False)
class Run:
    """A run from q, qd (n,). `common` is a tree of the arrays that the residuals of all nonlinear runs share."""

    equations: LinearEquations | NonlinearEquations
    q: Array
    qd: Array
    steps: Steps
    scheme: Scheme
    common: Any = None

    @cached_property
    def shape(self) -> Hashable | None:
        """Key of runs that can be integrated together: of equal sizes and nearly equal numbers of steps. It is None for
        a run that has to be integrated alone.
        """
        steps = self.steps
        magnitude = ceil(log(len(steps), NEARLY))  # equal for numbers of steps that are nearly equal
        if isinstance(self.equations, NonlinearEquations):
            leaves, form = self.residual
            return "nonlinear", form, *map(np.shape, leaves), self.equations.idle_inputs is None, magnitude
        if self.terms is None or (self.scheme.ends and steps.anew.any()):
            return None  # its equations are no sums of terms, or its steps start anew at times of its own
        return "linear", len(self.q), magnitude, self.parts

    @property
    def is_linear(self) -> bool:
        """True if its equations are linear."""
        return isinstance(self.equations, LinearEquations)

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
        """Inputs (1 + t s, ...) of linear equations: at the start, at stages, and at ends that are no stages."""
        steps, offsets = self.steps, self.scheme.offsets
        times = [steps.times(offset) for offset in offsets] + ([] if self.scheme.ends else [steps.end])
        return self.equations.drive(np.append(steps.drive_begin[:1], np.stack(times, axis=1)))

    @cached_property
    def features(self) -> Array:
        """Features of the inputs of linear equations, (1 + t s, k)."""
        assert isinstance(self.equations, LinearEquations) and self.equations.features is not None
        return self.equations.features(self.inputs)

    @cached_property
    def parts(self) -> Parts:
        """Indices, for C, K and F each, of the features that are not always zero and whose term is not zero."""
        assert self.terms is not None
        driven = np.any(self.features, axis=0)
        c, k, f = (tuple(np.flatnonzero(driven & nonzero).tolist()) for nonzero in self.terms.nonzero)
        return c, k, f

    @property
    def alive(self) -> LinearTerms:
        """The terms of the features in `parts`."""
        assert self.terms is not None
        return LinearTerms(*(term[list(part)] for term, part in zip(self.terms.arrays, self.parts, strict=True)))


def integrate_together(runs: Sequence[Run]) -> list[Trajectory | None]:
    """Integrate runs of one shape. A run whose corrections have failed is None, to be integrated alone."""
    solve = _integrate_linear if isinstance(runs[0].equations, LinearEquations) else _integrate_nonlinear
    histories, converged = solve(runs)
    trajectories = []
    for run, sound, *state in zip(runs, converged, *histories, strict=True):
        recorded = np.append(True, run.steps.kept)
        time = np.append(run.steps.begin[0], run.steps.end)
        q, qd, qdd = (x[: len(recorded)] for x in state)  # without the steps that fill a shorter run
        if not recorded.all():
            time, q, qd, qdd = time[recorded], q[recorded], qd[recorded], qdd[recorded]
        trajectories.append(Trajectory(time, q, qd, qdd) if sound and np.isfinite(qdd).all() else None)
    return trajectories


def _stacked(parts: Sequence[Any], axis: int = 0) -> Any:
    """Stack the leaves of equal trees along a new axis, the first or the last."""

    def stack(*leaves: Any) -> Array:
        stacked = np.asarray(leaves)
        return stacked if axis == 0 else np.moveaxis(stacked, 0, axis)

    return jax.tree.map(stack, *parts)


def _filled(values: Array, count: int) -> Array:
    """Values (t, ...) repeated at their end to (count, ...)."""
    missing = count - len(values)
    return np.concatenate([values, np.repeat(values[-1:], missing, axis=0)]) if missing else values


def _integrate_linear(runs: Sequence[Run]) -> tuple[Histories, Array]:
    """Histories of linear runs, and flags (b,) of those that converged: all."""
    scheme, stages = runs[0].scheme, stage_count(runs[0].scheme)
    count = max(len(run.steps) for run in runs)
    # The features that some term has, and the terms' indices among these; runs of one shape have the same.
    needed = np.unique(np.concatenate(runs[0].parts)).astype(int)
    parts = tuple(tuple(np.searchsorted(needed, part).tolist()) for part in runs[0].parts)
    features = np.stack([_filled(run.features[:, needed], 1 + count * stages) for run in runs], axis=-1)
    lengths = _stacked([_filled(run.steps.length, count) for run in runs], axis=-1)
    terms = _stacked([run.alive for run in runs], axis=-1)
    equations: list[Any] = [run.equations for run in runs]
    mass, q, qd = _stacked([(e.mass, run.q, run.qd) for e, run in zip(equations, runs, strict=True)], axis=-1)
    # Terms that fit steps to the runs' modes.
    mass_terms, damping = _stacked(
        [fitting_terms(e, scheme, run.steps.longest) for e, run in zip(equations, runs, strict=True)], -1
    )
    inverse = np.moveaxis(np.linalg.inv(np.moveaxis(mass, -1, 0)), 0, -1)
    qdd = accelerations(inverse, terms, features[0], parts, q, qd)
    z = np.einsum("bmk,knb->mnb", scheme.tableau(lengths[0]).initial, np.stack([q, qd, qdd]))
    histories = np.empty((3, len(runs), count + 1, len(q)))
    histories[:, :, 0] = np.moveaxis(np.stack([q, qd, qdd]), -1, 1)
    features = features[1:].reshape(count, stages, *features.shape[1:])
    for begin in range(0, count, STEPS):
        # The last piece is filled, so that one program serves every duration.
        chosen, count_taken = np.minimum(np.arange(begin, begin + STEPS), count - 1), min(STEPS, count - begin)
        arguments = (
            mass + mass_terms,
            damping,
            inverse,
            terms,
            scheme.unit,
            z,
            lengths[chosen],
            features[chosen],
            count_taken,
        )
        z, piece = taken_together(*arguments, parts=parts, ends=scheme.ends)
        for history_array, part in zip(histories, piece, strict=True):
            history_array[:, begin + 1 : begin + 1 + count_taken] = np.asarray(part)[:, :count_taken]
    return (histories[0], histories[1], histories[2]), np.ones(len(runs), dtype=bool)


def _compile_for_runs(solve: Callable[..., Any], *more_axes: int | None) -> Callable[..., Any]:
    """Compile `solve(residual, ...)` for many runs at once.

    The result is a function of the residuals' form, axes and leaves, as in :data:`Residuals`, and of the other
    arguments, whose axes of runs are `more_axes`.
    """

    @partial(jax.jit, static_argnums=(0, 1))
    def over_runs(form: Any, axes: tuple[int | None, ...], leaves: list[Array], *args: Any) -> Any:
        def solve_run(leaves: list[Array], *args: Any) -> Any:
            return solve(jax.tree.unflatten(form, leaves), *args)

        return jax.vmap(solve_run, in_axes=(list(axes), *more_axes))(leaves, *args)

    return over_runs


_slopes = _compile_for_runs(newton.slopes, 0, 0, 0, 0)
_accelerations = _compile_for_runs(newton.compiled_accelerations, 0, 0, 0)
_steps = _compile_for_runs(newton.steps, 0, 0, 0, 0, 0, None)


Residuals = tuple[Any, tuple[int | None, ...], list[Array]]  # form, axes and arrays: no axis of those that are common


def _residuals(runs: Sequence[Run]) -> Residuals:
    """The runs' residuals: arrays stacked along a first axis of runs, but for those that all share by `common`."""
    common = {id(leaf) for leaf in jax.tree.leaves(runs[0].common)}
    axes, leaves = list[int | None](), list[Array]()
    for run_leaves in zip(*(run.residual[0] for run in runs), strict=True):
        first = run_leaves[0]
        shared = id(first) in common and all(leaf is first for leaf in run_leaves)
        axes.append(None if shared else 0)
        leaves.append(first if shared else np.asarray(run_leaves))
    return runs[0].residual[1], tuple(axes), leaves


def _fitted(runs: Sequence[Run], residuals: Residuals) -> Residuals:
    """Fit the residuals of runs to their modes, as :func:`gbeam.integrate.schemes.fitted_residual` does for one."""
    exponent, equations = runs[0].scheme.exponent, [cast(NonlinearEquations, run.equations) for run in runs]
    if exponent is None or equations[0].idle_inputs is None:
        return residuals
    form, axes, leaves = residuals
    zero = np.zeros((len(runs), len(runs[0].q)))
    idle_inputs = (run_equations.idle_inputs for run_equations in equations)
    idle = jax.tree.map(lambda *leaves: np.concatenate(leaves), *idle_inputs)
    k, c, m = (symmetric(np.asarray(slope)) for slope in _slopes(*residuals, zero, zero, zero, idle))
    mass_terms, damping_terms = to_modes(exponent, [run.steps.longest for run in runs], m, c, k)
    leaves, form = jax.tree.flatten(Fitted(jax.tree.unflatten(form, leaves), mass_terms, damping_terms))
    return form, (*axes, 0, 0), leaves


def _integrate_nonlinear(runs: Sequence[Run]) -> tuple[Histories, Array]:
    """Histories of nonlinear runs, and flags (b,) of those whose steps have all converged."""
    scheme = runs[0].scheme
    equations: list[Any] = [run.equations for run in runs]
    residual = _fitted(runs, _residuals(runs))
    q, qd = (np.stack([getattr(run, name) for run in runs]) for name in ("q", "qd"))

    def accelerations(times: Sequence[Any], q: Array, qd: Array) -> Array:
        inputs = _stacked([e.drive(np.array([t])) for e, t in zip(equations, times, strict=True)])
        return np.asarray(_accelerations(*residual, q[:, None], qd[:, None], inputs))[:, 0]

    def begin_steps(q: Array, qd: Array, qdd: Array, lengths: Sequence[Any]) -> newton.Carry:
        x = np.broadcast_to(qdd[:, None], (len(q), len(scheme.offsets), q.shape[1]))
        return newton.Carry(scheme.tableau(np.array(lengths)).initial @ np.stack([q, qd, qdd], axis=1), x, x)

    qdd = accelerations([run.steps.drive_begin[0] for run in runs], q, qd)
    carry = begin_steps(q, qd, qdd, [run.steps.length[0] for run in runs])
    pieces, sound = [[x[:, None] for x in (q, qd, qdd)]], np.ones(len(runs), dtype=bool)
    counted = [np.ones((len(runs), 1), dtype=bool)]  # flags of the states that are no fillings
    equal, size = Counter(run.steps for run in runs), newton.PER_JACOBIAN[scheme.order]
    # Most runs have equal steps, which are divided once.
    divided = {steps: iter(tee(stretches(scheme, steps, size), count)) for steps, count in equal.items()}
    runs_chunks = [chunks(run.equations.drive, scheme, next(divided[run.steps])) for run in runs]
    current = [next(run_chunks) for run_chunks in runs_chunks]
    going = np.ones(len(runs), dtype=bool)
    while going.any():
        counts = np.stack([chunk.counted for chunk in current]) & going[:, None]  # of the steps, without fillings
        ends = [chunk.end for chunk in current]
        tableau, inputs, at_ends = _stacked([(chunk.tableau, chunk.inputs, chunk.at_ends) for chunk in current])
        last, count = np.stack([chunk.last_counted for chunk in current]), max(chunk.count for chunk in current)
        carry, history = _steps(*residual, tableau, carry, inputs, at_ends, last, count)
        *piece, error = (np.asarray(values) for values in history)
        sound &= ((error <= newton.ACCEPTED) | ~counts).all(axis=1)  # NaN is not
        anew = going & [end.anew for end in ends]
        if scheme.ends and anew.any():
            at_last = np.arange(len(runs)), counts.shape[1] - 1 - counts[:, ::-1].argmax(axis=1)
            q, qd = piece[0][at_last], piece[1][at_last]
            begin = accelerations([end.resume for end in ends], q, qd)
            final = accelerations([end.end for end in ends], q, qd)
            begun = begin_steps(q, qd, begin, [end.following for end in ends])
            carry = newton.Carry(
                *(np.where(anew[:, None, None], *carries) for carries in zip(begun, carry, strict=True))
            )
            piece[2] = piece[2].copy()
            piece[2][at_last[0][anew], at_last[1][anew]] = final[anew]
        pieces.append(piece)
        counted.append(counts)
        following = [next(run_chunks, None) for run_chunks in runs_chunks]
        going = np.array([chunk is not None for chunk in following])
        # A run that has ended repeats its last chunk.
        current = [chunk or previous for chunk, previous in zip(following, current, strict=True)]
    flags = np.concatenate(counted, axis=1)
    filled = [np.concatenate(parts, axis=1) for parts in zip(*pieces, strict=True)]
    histories: Any = ([run[counts] for run, counts in zip(values, flags, strict=True)] for values in filled)
    return tuple(histories), sound
