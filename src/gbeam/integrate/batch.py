"""Many runs of one shape at once, compiled by JAX: a step of all of them is one program.

The runs share their sizes, the scheme and the number of steps; equations, initial states, drives and lengths of steps
are each one's own. The steps are those that :func:`gbeam.integrate.driver.integrate` takes.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

import gbeam.arrays.jax_setup  # noqa: F401
from gbeam.integrate import linear, newton
from gbeam.integrate.driver import Trajectory, chunks
from gbeam.integrate.equations import LinearEquations, LinearTerms, NonlinearEquations
from gbeam.integrate.schemes import Scheme, Tableau
from gbeam.integrate.steps import Steps

Array = Any
_PIECE = 200  # steps of linear equations per compiled call


@dataclass(frozen=True, eq=False)
class Run:
    """One of the runs.

    Parameters
    ----------
    equations : LinearEquations or NonlinearEquations
        Linear ones with their terms.
    q, qd : (n,)
        Initial state.
    steps : Steps
    """

    equations: LinearEquations | NonlinearEquations
    q: Array
    qd: Array
    steps: Steps

    def shape(self, scheme: Scheme) -> Hashable | None:
        """What runs have in common that are integrated together; None of one that has to be integrated alone."""
        steps = self.steps
        if isinstance(self.equations, NonlinearEquations):
            leaves, form = jax.tree.flatten(self.equations.residual)
            return "nonlinear", form, *(np.shape(leaf) for leaf in leaves), len(steps), steps.anew.tobytes()
        if self.terms is None or (scheme.ends and steps.anew.any()):
            return None
        return "linear", self.terms.velocity.shape, len(steps), steps.equal

    @cached_property
    def terms(self) -> LinearTerms | None:
        """Those of linear equations that have them."""
        terms = getattr(self.equations, "terms", None)
        return None if terms is None else jax.tree.map(np.asarray, terms())


def integrate_together(runs: Sequence[Run], scheme: Scheme) -> list[Trajectory | None]:
    """Integrate runs of one shape; None in place of one that has to be integrated alone, for its corrections failed."""
    solve = _linear if isinstance(runs[0].equations, LinearEquations) else _nonlinear
    made = []
    for run, (q, qd, qdd), sound in zip(runs, *solve(runs, scheme), strict=True):
        kept = np.append(True, run.steps.kept)
        time = np.append(run.steps.begin[0], run.steps.end)[kept]
        fine = sound and np.isfinite(qdd).all()
        made.append(Trajectory(time, q[kept], qd[kept], qdd[kept]) if fine else None)
    return made


def _stacked(parts: Sequence[Any]) -> Any:
    return jax.tree.map(lambda *leaves: np.stack([np.asarray(leaf) for leaf in leaves]), *parts)


def _linear(runs: Sequence[Run], scheme: Scheme) -> tuple[list[Any], list[bool]]:
    equal, count = runs[0].steps.equal, len(runs[0].steps)
    equations: list[Any] = [run.equations for run in runs]
    starts = [linear.start(e, scheme, run.steps, run.q, run.qd) for e, run in zip(equations, runs, strict=True)]
    z = np.stack([start for start, _ in starts])
    by_run = []
    for e, run in zip(equations, runs, strict=True):
        at = [run.steps.times(offset) for offset in scheme.offsets] + ([] if scheme.ends else [run.steps.end])
        by_run.append(e.features(e.drive(np.concatenate(at))).reshape(len(at), count, -1))
    phi = np.stack([np.moveaxis(features, 0, 1) for features in by_run], axis=1)  # (t, b, s, k)
    driven = phi.any(axis=(0, 1, 2))
    phi, parts = phi[..., driven], [jax.tree.map(lambda part: part[driven], run.terms) for run in runs]
    # What does not depend on the rates has no part in C.
    rates = np.append(0, 1 + np.flatnonzero(np.any([part.velocity[1:].any(axis=(1, 2)) for part in parts], axis=0)))
    parts = [LinearTerms(part.velocity[rates], part.stiffness, part.force) for part in parts]
    own = [(e.mass, part) for e, part in zip(equations, parts, strict=True)]
    alike = all(
        np.array_equal(a, b) for each in own[1:] for a, b in zip(*map(jax.tree.leaves, (own[0], each)), strict=True)
    )
    mass, terms = own[0] if alike else _stacked(own)
    lengths = np.stack([run.steps.length for run in runs], axis=1)
    tableau = scheme.tableau(lengths[:1, 0] if equal else lengths)
    how = {"equal": equal, "alike": alike, "ends": scheme.ends}
    pieces = []
    for begin in range(0, count, _PIECE):
        # The last piece is filled with its last step, so that one program serves every duration.
        chosen = np.minimum(np.arange(begin, begin + _PIECE), count - 1)
        those = tableau if equal else jax.tree.map(lambda leaf, chosen=chosen: leaf[chosen], tableau)
        z, piece = _linear_steps(mass, terms, rates, z, those, phi[chosen], **how)
        pieces.append([np.asarray(x)[: count - begin] for x in piece])
    histories = [np.concatenate(part) for part in zip(*pieces, strict=True)]
    made = []
    for k, (run, (_, qdd)) in enumerate(zip(runs, starts, strict=True)):
        firsts = run.q, run.qd, qdd
        made.append(tuple(np.concatenate([x[None], part[:, k]]) for x, part in zip(firsts, histories, strict=True)))
    return made, [True] * len(runs)


@partial(jax.jit, static_argnames=("equal", "alike", "ends"))
def _linear_steps(
    mass: Array, terms: LinearTerms, rates: Array, z: Array, tableau: Tableau, phi: Array, **how: bool
) -> Any:
    """Steps of all runs from z (b, m, n).

    Parameters
    ----------
    mass, terms
        Of the runs, (b, ...), or of all where they are `alike`.
    rates : (r,)
        Indices of the features that C depends on.
    tableau : Tableau
        Of the steps and runs (t, b, ...), or (1, ...) of all where they are `equal`.
    phi : (t, b, s, k)
        Features at the stages of the steps and, where the last stage is no end, at their `ends`.

    Returns
    -------
    z after them, and q, q̇, q̈ at their ends, (t, b, n) each
    """
    equal, alike, ends = how["equal"], how["alike"], how["ends"]
    inverse = None if ends else jnp.linalg.inv(mass)

    # Products as sums of products: a batch of small matrix products is slow.
    def times(matrices: Array, vectors: Array) -> Array:
        return jnp.sum(matrices * vectors[:, None, :], axis=-1)

    def weighted(features: Array, parts: Array) -> Array:
        return jnp.sum(jnp.expand_dims(features, tuple(range(2, parts.ndim + 1))) * parts, axis=1)

    def stage_equations(mass: Array, terms: LinearTerms, z: Array, t: Tableau, phi: Array) -> Any:
        """C, K, F at the stages, and the system for their accelerations."""
        stages = len(t.c_q)
        c, k, f = weighted(phi[:, rates], terms.velocity), weighted(phi, terms.stiffness), weighted(phi, terms.force)
        rows = []
        for i in range(stages):
            blocks = [t.c_v[i, j] * c[i] + t.c_q[i, j] * k[i] + (mass if i == j else 0.0) for j in range(stages)]
            rows.append(jnp.concatenate(blocks, axis=1))
        known = times(c[:stages], t.w_v @ z) + times(k[:stages], t.w_q @ z)
        return (c, k, f), jnp.concatenate(rows), jnp.ravel(f[:stages] - known)

    def after(inverse: Array, of_stages: Any, z: Array, t: Tableau, x: Array) -> Any:
        """The next z, and q, q̇, q̈ at the end."""
        x = jnp.reshape(x, (len(t.c_q), -1))
        q, qd = t.end_z @ z + t.end_x @ x
        c, k, f = of_stages
        force = f[-1:] - times(k[-1:], q[None]) - times(c[-1:], qd[None])
        return t.g @ z + t.d @ x, (q, qd, x[-1] if ends else times(inverse[None], force)[0])

    own, by_run = None if alike else 0, None if equal else 0
    stages_of = jax.vmap(stage_equations, in_axes=(own, own, 0, by_run, 0))
    ends_of = jax.vmap(after, in_axes=(None if ends else own, 0, 0, by_run, 0))
    if equal:
        tableau = jax.tree.map(lambda leaf: leaf[0], tableau)

    def turn(z: Array, at: Any) -> Any:
        t, phi = (tableau, at) if equal else at
        matrices, left, right = stages_of(mass, terms, z, t, phi)
        return ends_of(inverse, matrices, z, t, _eliminated(left, right))

    return jax.lax.scan(turn, z, phi if equal else (tableau, phi))


def _eliminated(left: Array, right: Array) -> Array:
    """Solutions of many small systems (b, n, n), (b, n) by elimination, all of them in every operation.

    Without a choice of pivots: M and what a step adds to it is definite but for antisymmetric parts.
    """
    rows = jnp.moveaxis(jnp.concatenate([left, right[..., None]], axis=-1), 0, -1)
    pivots = []
    while len(rows):
        pivots.append(rows[0, 1:] / rows[0, :1])
        rows = rows[1:, 1:] - rows[1:, :1] * pivots[-1]
    x: list[Array] = []
    for pivot in reversed(pivots):
        x.insert(0, pivot[-1] - sum(pivot[j] * value for j, value in enumerate(x)))
    return jnp.stack(x, axis=-1)


_accelerations = jax.jit(jax.vmap(newton.accelerations))
_quick = jax.jit(jax.vmap(newton.steps, in_axes=(0, 0, 0, 0, 0, None, None, None)))


def _nonlinear(runs: Sequence[Run], scheme: Scheme) -> tuple[list[Any], list[bool]]:
    equations: list[Any] = [run.equations for run in runs]
    residual = _stacked([e.residual for e in equations])
    q, qd = (np.stack([getattr(run, name) for run in runs]) for name in ("q", "qd"))

    def accelerations(times: Sequence[float], q: Array, qd: Array) -> Array:
        inputs = _stacked([e.drive(np.array([t])) for e, t in zip(equations, times, strict=True)])
        return np.asarray(_accelerations(residual, q[:, None], qd[:, None], inputs))[:, 0]

    def begun(q: Array, qd: Array, qdd: Array, lengths: Sequence[float]) -> newton.Carry:
        x = np.broadcast_to(qdd[:, None], (len(q), len(scheme.offsets), q.shape[1]))
        return newton.Carry(scheme.tableau(np.array(lengths)).first @ np.stack([q, qd, qdd], axis=1), x, x)

    qdd = accelerations([run.steps.first[0] for run in runs], q, qd)
    carry = begun(q, qd, qdd, [run.steps.length[0] for run in runs])
    pieces, sound = [[x[:, None] for x in (q, qd, qdd)]], np.ones(len(runs), dtype=bool)
    size, corrections = newton.PER_JACOBIAN[scheme.order], newton.CORRECTIONS[scheme.order]
    for every in zip(
        *(chunks(e.drive, scheme, run.steps, size) for e, run in zip(equations, runs, strict=True)), strict=True
    ):
        inside, ends = every[0].inside, [chunk.end for chunk in every]
        tableau, inputs, at_ends = _stacked([(chunk.tableau, chunk.inputs, chunk.at_ends) for chunk in every])
        for tries in (corrections, newton.PATIENT[0]):
            given = tableau, carry, inputs, at_ends, every[0].last, tries, every[0].count
            after, (*piece, left) = _quick(residual, *given)
            solved = (np.asarray(left)[:, inside] <= newton.ACCEPTED).all(axis=1)  # NaN is not
            if (solved | ~sound).all():
                break
        sound, carry = sound & solved, after
        piece = [np.array(values)[:, inside] for values in piece]
        if scheme.ends and ends[0].anew:
            q, qd = piece[0][:, -1], piece[1][:, -1]
            begin, there = (accelerations([getattr(end, at) for end in ends], q, qd) for at in ("resume", "end"))
            carry, piece[2][:, -1] = begun(q, qd, begin, [end.following for end in ends]), there
        pieces.append(piece)
    histories = [np.concatenate(part, axis=1) for part in zip(*pieces, strict=True)]
    return [tuple(part[k] for part in histories) for k in range(len(runs))], sound.tolist()
