"""Runs of nonlinear equations that JAX traces: solved as all others are, outside of its programs.

Their derivative is that of the discrete solution. Differentiated, every step of a run solves with the Jacobian J of its
stages' accelerations x and the derivative L by the state z before it

    δx = −J⁻¹ (δr + L δz),    δz₊ = g δz + d δx,

where δr is the residual's own derivative by what it is made of and by what drives it: JAX traces the residual and this
recurrence, but neither Newton's method nor the run. Commands of controllers, which act in whole steps, add to δr. Along
the run a sample changes with the state that it measures, with the state of its law, and directly: these are linear,
found for all samples at once, and taken through time with the steps.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple, Protocol

import jax
import jax.numpy as jnp
import numpy as np

import gbeam.arrays.jax_setup  # noqa: F401
from gbeam.arrays.namespace import Array
from gbeam.arrays.tree import each_leaf
from gbeam.integrate.equations import Demanded, Fitted, NonlinearEquations, exact_residual, slopes
from gbeam.integrate.newton import compiled_accelerations
from gbeam.integrate.sampled import Sampling, Uncontrolled, sampling_of
from gbeam.integrate.schemes import Scheme, fitted_residual
from gbeam.integrate.steps import Steps
from gbeam.integrate.windows import windows


class TracedLaw(NamedTuple):
    """A law as a function of its parameters, the references of a sample, its time, its measurements and the state
    of the law (x,).

    The function gives the command as asked and as limited, and the next state. Samples are at `times` (s,) s, with
    references (s, k), and the first state is `start` (x,).
    """

    times: Any
    function: Any
    parameters: Any
    references: Array
    start: Array


class TracedControllers(Protocol):
    """Controllers whose values JAX traces, besides what :class:`gbeam.integrate.sampled.Controllers` do."""

    drives: list[slice]

    def laws(self, times: list[Array]) -> list[TracedLaw]:
        """Laws sampled at times (s,) s each."""
        ...

    def rebuild(self, residual: Any, laws: list[TracedLaw] | None = None) -> Any:
        """Return controllers that measure by the values of a residual, and command by those of laws."""
        ...


class Samples(NamedTuple):
    """Samples of one controller: measurements (s, k), commands as asked and as limited (s, m), states before (s, x)."""

    measured: Array
    asked: Array
    limited: Array
    state: Array


class TracedLoop:
    """The samples of controllers at given steps."""

    has_begun, failure = True, None

    def __init__(self, controllers: Any, steps: Steps) -> None:
        """Plan the samples, as :class:`gbeam.integrate.sampled.Sampling` does, and make the laws at their times."""
        plan = Sampling(controllers, None, None, steps)
        self.controllers, self.steps, self.sample_numbers = controllers, steps, plan.sample_numbers
        # Steps at whose beginning a sample is taken.
        self.sample_steps = [np.flatnonzero(taken >= 0) for taken in plan.sample_numbers]
        numbers = np.arange(len(steps))
        self.active = [
            np.searchsorted(since[: len(at)], numbers, side="right") - 1
            for since, at in zip(plan.acting_from, self.sample_steps, strict=True)
        ]  # of a step: the sample that acts, −1 before the first does
        self.laws = controllers.laws([steps.begin[at] for at in self.sample_steps])
        self.values: list[Samples] = []

    @property
    def inputs(self) -> list[tuple[Any, Array, Array]]:
        """Parameters, references and first state of each law."""
        return [(law.parameters, law.references, law.start) for law in self.laws]

    def laws_of(self, inputs: Any) -> list[TracedLaw]:
        """Return the laws with other parameters, references and first states, which are the `inputs`."""
        return [TracedLaw(law.times, law.function, *values) for law, values in zip(self.laws, inputs, strict=True)]

    @property
    def shapes(self) -> list[Samples]:
        """Shapes of the samples of each controller."""
        shapes = []
        for steps, law, part in zip(self.sample_steps, self.laws, self.controllers.drives, strict=True):
            commands = part.stop - part.start
            widths = (law.references.shape[1], commands, commands, len(law.start))
            shapes.append(Samples(*(jax.ShapeDtypeStruct((len(steps), width), float) for width in widths)))
        return shapes

    def record_samples(self, sampling: Sampling, inputs: Any) -> list[Samples]:
        """Return the samples of each controller as arrays, NaN if not taken.

        `inputs` have the laws' first states.
        """
        recorded = []
        for shapes, samples, (*_, start) in zip(self.shapes, sampling.samples, inputs, strict=True):
            arrays = Samples(*(np.full(field.shape, np.nan) for field in shapes))
            states = [start, *(next_state for *_, next_state in samples[:-1])]
            for k, ((measured, asked, limited, _), state) in enumerate(zip(samples, states, strict=False)):
                for array, value in zip(arrays, (measured, asked, limited, state), strict=True):
                    array[k] = value
            recorded.append(arrays)
        return recorded

    def sample_arrays(self, c: int) -> tuple[Array, ...]:
        """Measurements (s, k) and commands (s, m) of a controller, as asked and as limited."""
        return self.values[c][:3]

    def acting_commands(self, samples: list[Samples]) -> Array:
        """Commands that act in the steps, (t, m)."""
        parts = [
            jnp.where(active[:, None] >= 0, sample.limited[np.maximum(active, 0)], 0.0)
            for active, sample in zip(self.active, samples, strict=True)
        ]
        return jnp.concatenate([jnp.zeros((len(self.steps), 0)), *parts], axis=1)

    def changes(
        self, primals: Any, tangents: Any, run: Any, inputs: Any, by_inputs: Any, samples: list[Samples]
    ) -> _Changes:
        """Changes of samples along a run.

        `primals` are the residual and its drives where steps begin, `inputs` the laws' values. `tangents` and
        `by_inputs` are the tangents of both.
        """
        acting = self.acting_commands(samples)
        earlier = jnp.concatenate([0 * acting[:1], acting[:-1]])
        laws = zip(self.sample_steps, self.laws_of(inputs), self.laws_of(by_inputs), samples, strict=True)
        parts = []
        for c, (sample_steps, law, by_law, values) in enumerate(laws):
            state = [part[sample_steps] for part in run[:2]]
            measured = self._measurement_changes(c, primals, tangents, state, earlier[sample_steps], sample_steps)
            parts.append(measured + self._law_changes(law, by_law, values))
        return _Changes(self, parts)

    def _measurement_changes(
        self, c: int, primals: Any, tangents: Any, state: Any, before: Array, at: Array
    ) -> tuple[Array, ...]:
        """Derivatives of a controller's measurements, which are taken at the beginnings of the steps `at`.

        They are those by states (s, k, 2 n), those by the commands `before` (s, k, m), and the change (s, k) by the
        `tangents` of residual and drives alone.
        """
        q, qd = state
        (residual, driven), (by_residual, by_driven) = primals, tangents
        driven, by_driven = (jax.tree.map(lambda leaf: leaf[at], tree) for tree in (driven, by_driven))

        def measured(residual: Any, driven: Any) -> Array:
            """Measurements (s, k) as a function of what JAX traces. The states of the run are constants."""
            inputs = self.controllers.add_commands(driven, before)
            controllers = self.controllers.rebuild(exact_residual(residual))
            qdd = compiled_accelerations(residual, q, qd, inputs) if controllers.measures_accelerations(c) else 0 * q
            return controllers.measure(c, q, qd, qdd, inputs)

        values, direct = jax.jvp(measured, (residual, driven), (by_residual, by_driven))
        shapes = (*values.shape, 2 * q.shape[1]), (*values.shape, before.shape[1])

        def host(*arguments: Any) -> Any:
            """Derivatives by states and by commands, which NumPy computes outside of JAX's programs."""
            q, qd, before, residual, driven = jax.tree.map(np.asarray, arguments)
            controllers = self.controllers.rebuild(exact_residual(residual))
            sampling = Sampling(controllers, residual, None, self.steps)
            with np.errstate(all="ignore"):
                by_state, by_command = sampling.measurement_slopes(c, q, qd, controllers.add_commands(driven, before))
            return by_state, np.zeros(shapes[1]) if by_command is None else by_command

        result = tuple(jax.ShapeDtypeStruct(shape, float) for shape in shapes)
        slope = jax.pure_callback(host, result, q, qd, before, residual, driven, vmap_method="sequential")
        return *slope, direct

    def _law_changes(self, law: TracedLaw, tangent: TracedLaw, values: Samples) -> tuple[Array, ...]:
        """Derivatives of a law's commands and next states, (s, 2 m + x, ...), by measurements and by states.

        They are followed by the change of these by the `tangent` of parameters and references alone, and by the change
        of the first state.
        """

        def commands_and_state(parameters: Any, references: Array, y: Array, state: Array, t: Array) -> Array:
            """Commands as asked and as limited, and the next state of the law, (2 m + x,)."""
            return jnp.concatenate(law.function(parameters, references, t, y, state))

        sampled, axes = (values.measured, values.state, law.times), (None, 0, 0, 0, 0)
        slope = jax.vmap(jax.jacfwd(commands_and_state, (2, 3)), axes)
        by_y, by_state = slope(law.parameters, law.references, *sampled)

        def direct(parameters: Any, references: Array) -> Array:
            return jax.vmap(commands_and_state, axes)(parameters, references, *sampled)

        _, change = jax.jvp(direct, (law.parameters, law.references), (tangent.parameters, tangent.references))
        return by_y, by_state, change, tangent.start


class _Changes:
    """Changes of samples, carried through the steps of a run. Each step passes the change of its state."""

    def __init__(self, loop: TracedLoop, parts: list[tuple[Array, ...]]) -> None:
        """Arrange the derivatives by steps, and find how many commands of each controller wait until they act."""
        self.drives, self.sample_steps = loop.controllers.drives, loop.sample_steps
        self.starts = [part[-1] for part in parts]
        # Commands wait in a ring, as long as the latest is ahead of the one that acts.
        newest = [np.maximum.accumulate(taken) for taken in loop.sample_numbers]
        self.rings = [int((new - act).max()) + 1 for new, act in zip(newest, loop.active, strict=True)]
        self.by_step = [
            (taken, active, *(values[np.maximum(new, 0)] for values in part[:-1]))
            for taken, active, new, part in zip(loop.sample_numbers, loop.active, newest, parts, strict=True)
        ]

    @property
    def begin(self) -> Any:
        """The laws' states and rings, and no commands before."""
        sizes = [part.stop - part.start for part in self.drives]
        rings = [jnp.zeros(shape) for shape in zip(self.rings, sizes, strict=True)]
        return list(zip(self.starts, rings, strict=True)), jnp.zeros(sum(sizes))

    def step(self, carried: Any, dz: Array, entry: Any) -> tuple[Any, Array, Any]:
        """Carry the changes through one step whose state changes by dz (m, n). `entry` has its entries of `by_step`.

        Returns the changes of the laws' states and rings after the step, of the commands that act in it, and of the
        samples at its beginning.
        """
        laws, earlier = carried
        laws_after, acting, sampled = [], [], []
        for (state, ring), (taken, active, by_z, by_command, y, by_y, by_state, direct) in zip(
            laws, entry, strict=True
        ):
            count, m = ring.shape
            measured = by_z @ dz.ravel() + by_command @ earlier + y
            asked, limited, following = jnp.split(by_y @ measured + by_state @ state + direct, (m, 2 * m))
            sampled.append(Samples(measured, asked, limited, state))
            state = jnp.where(taken >= 0, following, state)
            ring = jnp.where(taken >= 0, ring.at[taken % count].set(limited), ring)
            laws_after.append((state, ring))
            acting.append(jnp.where(active >= 0, ring[active % count], 0.0))
        commands = jnp.concatenate([earlier[:0], *acting])
        return (laws_after, commands), commands, sampled


def traced(
    equations: NonlinearEquations, scheme: Scheme, q: Array, qd: Array, steps: Steps
) -> tuple[tuple[Array, ...], TracedLoop | None]:
    """Integrate nonlinear equations that JAX traces; return q, q̇, q̈ (t + 1, n) at the start and the ends of steps,
    and the samples of controllers, if any.

    All values and their derivatives are NaN from a step on that fails.
    """
    ends = [] if scheme.ends else [steps.end]
    loop = TracedLoop(equations.controllers or Uncontrolled(), steps)
    times = np.concatenate(
        [steps.drive_begin[:1], *(steps.times(offset) for offset in scheme.offsets), *ends, steps.begin]
    )
    steps = replace(steps, kept=np.ones(len(steps), dtype=bool))
    shape = (len(steps) + 1, len(q))
    step_residual = fitted_residual(equations, scheme, steps, len(q))

    def solved(residual: Any, q: Any, qd: Any, driven: Any, inputs: Any) -> Any:
        """Histories (3, t + 1, n) and samples of a run, computed by NumPy outside of JAX's programs."""
        residual, q, qd, driven, inputs = jax.tree.map(np.asarray, (residual, q, qd, driven, inputs))
        order = np.argsort(times)

        def drive(t: Any) -> Any:
            index = order[np.searchsorted(times, t, sorter=order)]
            return each_leaf(lambda leaf: leaf[index], driven)

        untraced, histories, done = NonlinearEquations(residual, drive), np.full((3, *shape), np.nan), 0
        laws = loop.laws_of(inputs)
        if laws:
            untraced = replace(untraced, controllers=loop.controllers.rebuild(exact_residual(residual), laws))
        samples = sampling_of(untraced, steps)
        with np.errstate(all="ignore"):  # of what is no number
            for *piece, _ in windows(untraced, scheme, q, qd, steps, samples):
                histories[: len(piece), done : done + len(piece[0])] = piece
                done += len(piece[0])
            if not scheme.ends:
                histories[2, :done] = Demanded(untraced, steps, histories[0], histories[1], samples)(np.arange(done))
        return tuple(histories), [] if samples is None else loop.record_samples(samples, inputs)

    @jax.custom_jvp
    def run(residual: Any, q: Array, qd: Array, driven: Any, inputs: Any) -> Any:
        result = (jax.ShapeDtypeStruct(shape, float),) * 3, loop.shapes
        return jax.pure_callback(solved, result, residual, q, qd, driven, inputs, vmap_method="sequential")

    @run.defjvp
    def _(primals: Any, tangents: Any) -> Any:
        (residual, _, _, driven, inputs), (by_residual, dq, dqd, by_driven, by_inputs) = primals, tangents
        results, in_loop = run(*primals), (loop, inputs, by_inputs)
        return results, _changes(scheme, steps, results, (residual, driven), (by_residual, by_driven), dq, dqd, in_loop)

    inputs = jax.tree.map(lambda leaf: jnp.asarray(leaf, dtype=float), loop.inputs)
    start = jnp.asarray(q, dtype=float), jnp.asarray(qd, dtype=float)
    histories, samples = run(step_residual, *start, equations.drive(times), inputs)
    loop.values = samples
    return tuple(histories), loop if loop.laws else None


def _changes(
    scheme: Scheme, steps: Steps, results: Any, primals: Any, tangents: Any, dq: Array, dqd: Array, in_loop: Any
) -> Any:
    """Changes of a run's `results`: q, q̇, q̈ (t + 1, n) and samples.

    They follow from the `tangents` of its residual and drives, the `primals`, from dq, dqd (n,) at the start, and from
    the tangents of its controllers' laws in `in_loop`.
    """
    (run, samples), (loop, *laws), t = results, in_loop, scheme.tableau(steps.length)
    (q, qd, qdd), (residual, drives), (by_residual, by_drives) = run, primals, tangents
    count, n, stages, first = len(steps), q.shape[1], len(scheme.offsets), scheme.tableau(steps.length[0]).initial
    x: Array
    z: Array
    if scheme.ends:
        x = qdd[1:, None]
        start = first @ jnp.stack([q[0], qd[0], qdd[0]])
        _, z = jax.lax.scan(lambda z, at: (at[0] @ z + at[1] @ at[2], z), start, (t.g, t.d, x))
    else:  # z is q and q̇: what a step adds to it says what its stages' accelerations were
        z = jnp.stack([q, qd], axis=1)
        x, z = jnp.linalg.solve(t.d, z[1:] - t.g @ z[:-1]), z[:-1]
    at_stages = t.w_q @ z + t.c_q @ x, t.w_v @ z + t.c_v @ x, x
    # At the start, at every first stage, at every second one and, unless a stage is there, at the ends of steps.
    states = tuple(
        jnp.concatenate([whole[:1], *jnp.moveaxis(at_stage, 1, 0), *([] if scheme.ends else [whole[1:]])])
        for whole, at_stage in zip(run, at_stages, strict=True)
    )
    driven, begun = (
        [jax.tree.map(lambda leaf, part=part: leaf[part], values) for values in (drives, by_drives)]
        for part in (slice(len(states[0])), slice(len(states[0]), None))
    )
    held, add_commands = loop.acting_commands(samples), loop.controllers.add_commands
    commands = jnp.concatenate([0 * held[:1], *[held] * ((len(states[0]) - 1) // count)])
    follow = loop.changes((residual, begun[0]), (by_residual, begun[1]), run, *laws, samples)

    def host(*arguments: Any) -> Any:
        (q, qd, qdd), residual, driven, commands = jax.tree.map(np.asarray, arguments)
        inputs = add_commands(driven, commands)
        with np.errstate(all="ignore"):
            onto = Sampling(loop.controllers, residual, None, steps).residual_slopes(q, qd, qdd, inputs)
            return (*slopes(residual, q, qd, qdd, inputs), onto)

    square = (jax.ShapeDtypeStruct((len(states[0]), n, n), float),) * 3
    wide = jax.ShapeDtypeStruct((len(states[0]), n, commands.shape[1]), float)
    arguments = states, residual, driven[0], commands
    *slope, onto = jax.pure_callback(host, (*square, wide), *arguments, vmap_method="sequential")
    _, direct = jax.jvp(
        lambda residual, driven: residual(*states, add_commands(driven, commands)),
        (residual, driven[0]),
        (by_residual, driven[1]),
    )

    def acceleration_changes(part: slice, dq: Array, dqd: Array, du: Array) -> Array:
        """Changes of q̈ at some of the states, by those of q, q̇ and commands there."""
        k, c, m = (matrices[part] for matrices in slope)
        if isinstance(residual, Fitted):
            c, m = c - residual.damping, m - residual.mass
        force = direct[part] + (k @ dq[..., None] + c @ dqd[..., None] + onto[part] @ du[..., None])[..., 0]
        return -jnp.linalg.solve(m, force[..., None])[..., 0]

    def select_stages(values: Array) -> Array:
        """Return the values at the stages alone, (t, s, ...), of those at all states."""
        return jnp.moveaxis(values[1 : 1 + stages * count].reshape(stages, count, *values.shape[1:]), 0, 1)

    jacobian, by_z = t.jacobians(*map(select_stages, slope))
    inverse = jnp.linalg.inv(jacobian)

    def step(carried: Any, entry: Any) -> Any:
        """Take the changes of state and laws through one step: δx = −J⁻¹ (δr + L δz), δz₊ = g δz + d δx."""
        dz, law = carried
        inverse, by_z, by_command, direct, g, d, sampled = entry
        law, du, taken = follow.step(law, dz, sampled)
        change = direct.ravel() + by_z @ dz.ravel() + (by_command @ du).ravel()
        dx = -(inverse @ change).reshape(stages, n)
        return (g @ dz + d @ dx, law), (dz, dx, du, taken)

    dqdd = acceleration_changes(slice(0, 1), dq[None], dqd[None], jnp.zeros((1, commands.shape[1])))
    begin = first @ jnp.stack([dq, dqd, dqdd[0]]), follow.begin
    by_step = inverse, by_z, select_stages(onto), select_stages(direct), t.g, t.d, follow.by_step
    _, (dz, dx, du, taken) = jax.lax.scan(step, begin, by_step)
    ends = t.end_z @ dz + t.end_x @ dx
    changes = ends[:, 0], ends[:, 1]
    at_ends = dx[:, -1] if scheme.ends else acceleration_changes(slice(-count, None), *changes, du)
    before = dq[None], dqd[None], dqdd
    histories = tuple(jnp.concatenate(pair) for pair in zip(before, (*changes, at_ends), strict=True))
    return histories, [
        Samples(*(values[k] for values in of_law)) for of_law, k in zip(taken, follow.sample_steps, strict=True)
    ]
