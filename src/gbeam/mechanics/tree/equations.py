"""Equations of a tree of bodies: the motion of every frame from the ground out, the wrenches back to it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import accumulate, pairwise
from typing import Any

import numpy as np

from gbeam.arrays.namespace import Array, concatenated, holds_jax, is_jax, namespace
from gbeam.arrays.tree import record, static
from gbeam.mechanics.equations.contraction import Roots
from gbeam.mechanics.fields.products import cross, turned, turned_back
from gbeam.mechanics.tree.bodies import Acting, DeformingBody, Rigid, momentum
from gbeam.mechanics.tree.closures import DIRECTIONS, Closure, closing_loads, gap, gap_with_rates, settling
from gbeam.mechanics.tree.frames import Frame, Wrench
from gbeam.mechanics.tree.links import Holder, Link
from gbeam.mechanics.tree.steps import Ball, Placed, Rotation, Slide, Step, Turning

SAMPLES = 40  # states by which the motions that roots can have are found


@record
class Inputs:
    """Drives of a tree at one time or many.

    They are the motion of the ground, prescribed coordinates with their rates (..., 3, k), efforts (..., n) on all
    coordinates, load components (..., l, 6) of each body, and wrenches (..., p, 6) on points. Each is None where there
    is nothing of the kind. Wrenches `closing` loops (..., c, 6), axes of the points that they close on, are solved for
    where they are None.
    """

    ground: Frame
    prescribed: Array | None
    efforts: Array | None
    loads: tuple[Array | None, ...]
    wrenches: Array | None
    closing: Array | None = None


@record
class Force:
    """A force and moment on point `on` of body `body`, in the ground's axes, or those of the point if it follows."""

    body: int = static()
    on: int = static()
    follower: bool = static()


def _unturned(steps: tuple[Step, ...], first: int) -> tuple[Step, ...]:
    """Steps of a body on a resting ground, from the `first` with coordinates on.

    That step loses its own turn if it rotates about one axis: on a ground at rest nothing feels the turn.
    """
    step = steps[first] if first < len(steps) else None
    if isinstance(step, Rotation) and step.size == 1:
        return (replace(step, R0=None), *steps[first + 1 :])
    return steps


class State:
    """Motion of a tree's frames at all coordinates and rates: of each body's root, and of its points when asked for."""

    def __init__(self, tree: Tree, y: Array, yd: Array, ydd: Array, ground: Frame) -> None:
        self.shape = np.broadcast_shapes(y.shape[:-1], yd.shape[:-1], ydd.shape[:-1])
        self.links, self._ground, self._bodies = tree.links, ground, range(len(tree.links) - len(tree.closures))
        self._moved, self._relative = dict[int, tuple[list[Any], Frame]](), dict[int, list[Any]]()
        self._points = dict[int, list[Frame]]()
        self.q, self.qd, self.qdd = tree.parted(y, yd, ydd)

    @cached_property
    def ground(self) -> Frame:
        """Motion of the ground, broadcast to the shape of the states."""
        xp, frame = namespace(*self.q[0], self._ground.a), self._ground
        R = None if frame.R is None else xp.broadcast_to(frame.R, (*self.shape, 3, 3))
        vectors = frame.p, frame.v, frame.w, frame.a, frame.alpha
        spread = (None if vector is None else xp.broadcast_to(vector, (*self.shape, 3)) for vector in vectors)
        return Frame(R, *spread)

    def step_motions(self, body: int) -> tuple[list[Any], Frame]:
        """Motions of the steps of a body's joint, and the motion of the body's root; computed once."""
        if body not in self._moved:
            link, steps = self.links[body], list[Any]()
            frame = self.ground if link.parent < 0 else self.point(link.parent, link.on)
            *joint, _ = zip(self.q[body], self.qd[body], self.qdd[body], strict=True)
            for step, coordinates in zip(link.steps, joint, strict=True):
                steps.append(step.motion(*coordinates))
                frame = frame.carried(steps[-1])
            self._moved[body] = steps, frame.filled(self.shape)
        return self._moved[body]

    def point(self, body: int, on: int) -> Frame:
        """Motion of a body's point `on`, −1 its root."""
        return self.step_motions(body)[1] if on < 0 else self.points_of(body)[on]

    @property
    def roots(self) -> list[Frame]:
        """Motions of the roots of all bodies."""
        return [self.step_motions(body)[1] for body in self._bodies]

    def relative(self, body: int) -> list[Any]:
        """Motions of a body's points in its root's axes."""
        if body not in self._relative:
            coordinates = self.q[body][-1], self.qd[body][-1], self.qdd[body][-1]
            self._relative[body] = self.links[body].body.relative(*coordinates)
        return self._relative[body]

    def points_of(self, body: int) -> list[Frame]:
        """Motions of a body's points, its root the last."""
        if body not in self._points:
            _, root = self.step_motions(body)
            self._points[body] = [*(root.carried(relative) for relative in self.relative(body)), root]
        return self._points[body]

    @property
    def places(self) -> Array:
        """Positions (..., p, 3), m, of the points of all bodies, in the order of :attr:`every_point`."""
        places = list[Array]()
        for body, link in zip(self._bodies, self.links, strict=False):
            root = self.step_motions(body)[1]
            relative = link.body.places_of(self.q[body][-1])
            points = root.p[..., None, :] + relative @ namespace(root.R).swapaxes(root.R, -1, -2)
            places += [points, root.p[..., None, :]]
        return namespace(*places).concatenate(places, axis=-2)

    @property
    def every_point(self) -> list[Frame]:
        """Motions of the points of all bodies, one after the other, each with its root the last."""
        return [frame for body in self._bodies for frame in self.points_of(body)]


@record
class Tree:
    """A tree of links, each after its parent. `fixed` are the indices of prescribed coordinates among all. With `rests`
    the ground does not move, and no equation depends on where a frame is.

    Its `closures` make loops. Of their conditions, six each, those of indices `conditions` are independent. `weights`
    are one over the inertia of each row, of all coordinates.
    """

    links: tuple[Link, ...]
    forces: tuple[Force, ...]
    fixed: tuple[int, ...] = static(default=())
    rests: bool = static(default=False)
    closures: tuple[Closure, ...] = ()
    conditions: tuple[int, ...] = static(default=())
    weights: Array | None = None

    @property
    def size(self) -> int:
        """Number of all coordinates, prescribed ones too."""
        return sum(sum(link.sizes) for link in self.links)

    @property
    def frictionless(self) -> Tree:
        """Tree without friction, otherwise as it is."""
        return self._holding(lambda holder: replace(holder, friction=0 * holder.friction))

    def slipping(self, rate: float) -> Tree:
        """Return the same tree with friction that is smooth below another rate, rad/s or m/s."""
        return self._holding(lambda holder: replace(holder, slip=rate))

    def _holding(self, changed: Callable[[Holder], Holder]) -> Tree:
        return replace(self, links=tuple(replace(link, holder=changed(link.holder)) for link in self.links))

    @property
    def unknowns(self) -> Array:
        """Indices of the coordinates that are unknown."""
        return np.delete(np.arange(self.size), self.fixed)

    @property
    def sliding(self) -> Array:
        """Flags of the unknown coordinates that shift all that follows: without forces no equation changes with them.

        They are slides that follow only slides from the ground and meet no stop.
        """
        if self.closures:
            return np.zeros(len(self.unknowns), dtype=bool)
        flags, only_slid = list[bool](), {-1: True}  # by body: only slides, and no deformation, from the ground to it
        for body, link in enumerate(self.links):
            slid, first = only_slid[link.parent], 0
            for step in link.steps:
                stops = link.holder.stop[first : first + step.size]
                flags += (stops == 0).tolist() if slid and isinstance(step, Slide) else [False] * step.size
                slid, first = slid and isinstance(step, Slide | Placed), first + step.size
            flags += [False] * link.body.size
            only_slid[body] = slid and not link.body.size
        return np.array(flags, dtype=bool)[self.unknowns]

    @property
    def turning(self) -> list[Array]:
        """Flags, for the unknown coordinates, of joints that turn all that follows; one array for each joint.

        These are balls that follow only slides from the ground and meet no stop, and hinges that do and that nothing
        holds.
        """
        flags, only_slid, first = list[Array](), {-1: not self.closures}, 0
        for body, link in enumerate(self.links):
            slid = only_slid[link.parent]
            for step in link.steps:
                free_hinge = isinstance(step, Rotation) and step.size == 1 and not link.holder.holds
                if slid and (free_hinge or (isinstance(step, Ball | Turning) and not link.holder.stop.any())):
                    flags.append((first <= self.unknowns) & (self.unknowns < first + step.size))
                slid, first = slid and isinstance(step, Slide | Placed), first + step.size
            only_slid[body], first = slid and not link.body.size, first + link.body.size
        return [joint for joint in flags if joint.any()]

    def parted(self, *coordinates: Array) -> list[list[list[Array]]]:
        """Split each array of coordinates by links and, within a link, by the steps of its joint and its body."""
        spans, end = list[list[slice]](), 0
        for link in self.links:
            ends = list(accumulate(link.sizes, initial=end))
            spans.append([slice(*pair) for pair in pairwise(ends)])
            end = ends[-1]
        return [[[y[..., span] for span in link_spans] for link_spans in spans] for y in coordinates]

    def complete(self, y: Array, prescribed: Array) -> Array:
        """Merge the unknown and the prescribed coordinates to all, (..., n)."""
        xp = namespace(y, prescribed)
        order = np.argsort(np.concatenate([self.unknowns, np.array(self.fixed)]))
        shape = np.broadcast_shapes(y.shape[:-1], prescribed.shape[:-1])
        parts = [xp.broadcast_to(values, (*shape, values.shape[-1])) for values in (y, prescribed)]
        return xp.concatenate(parts, axis=-1)[..., order]

    def motion(self, y: Array, yd: Array, ydd: Array, inputs: Inputs) -> State:
        """Motion of every frame at the unknown coordinates and their rates (..., n)."""
        return self._state(y, yd, ydd, inputs, inputs.ground)

    def _state(self, y: Array, yd: Array, ydd: Array, inputs: Inputs, ground: Frame) -> State:
        if inputs.prescribed is not None:
            y = self.complete(y, inputs.prescribed[..., 0, :])
            yd = self.complete(yd, inputs.prescribed[..., 1, :])
            ydd = self.complete(ydd, inputs.prescribed[..., 2, :])
        return State(self, y, yd, ydd, ground)

    def __call__(self, y: Array, yd: Array, ydd: Array, inputs: Inputs) -> Array:
        """Residual (..., n) of the equations of the unknown coordinates, or zero where they hold."""
        ground = inputs.ground
        if self.closures:
            return self._closed_rows(self._state(y, yd, ydd, inputs, ground), inputs)
        if self.rests:
            ground = Frame(None, None, None, None, None, None)
        elif all(force.follower for force in self.forces):  # nothing asks where the frames are
            ground = Frame(None, None, None, ground.w, ground.a, ground.alpha)
        rows = self._demanded(self._state(y, yd, ydd, inputs, ground), inputs, ground=False)[0]
        return rows[..., self.unknowns] if self.fixed else rows

    def contracted(self, ground: Frame | None = None) -> Tree:
        """Return the same equations of the unknown coordinates with fewer sums.

        Bodies with constant coefficients are contracted with the motions that their roots can have, on a `ground` with
        this constant motion (3,), or on any. These motions are found by random states.
        """
        if holds_jax(self) or self.closures:
            return self
        random = np.random.default_rng(0)  # any numbers: none of a root's motions is left out but by chance
        y, yd, ydd = random.normal(size=(3, SAMPLES, self.size))
        # The same states with other accelerations of the unknown coordinates.
        other_ydd, ground_motion = ydd.copy(), random.normal(size=(3, SAMPLES, 3))
        other_ydd[:, self.unknowns] = random.normal(size=(SAMPLES, len(self.unknowns)))
        rests = False
        if ground is not None:
            motion = np.stack([ground.w, ground.a, ground.alpha])
            ground_motion = np.broadcast_to(motion[:, None], ground_motion.shape)
            rests = not motion.any() and all(force.follower for force in self.forces)
        frame = Frame(None, None, None, *ground_motion)
        states = [State(self, y, yd, accelerations, frame) for accelerations in (ydd, other_ydd)]
        acted = {link.parent for link in self.links} | {force.body for force in self.forces}
        links = list[Link]()
        for k, link in enumerate(self.links):
            carrier = k
            if k not in acted and link.idle == len(link.steps) and link.parent >= 0:
                carrier = link.parent if isinstance(self.links[link.parent].body, Rigid) else k
            body = link.body
            if isinstance(body, DeformingBody | Rigid):
                carrier_roots = Roots.from_frames(*(state.step_motions(carrier)[1] for state in states))
                own_roots = Roots.from_frames(*(state.step_motions(k)[1] for state in states))
                body = body.contracted(carrier_roots, own_roots)
            loose = link.loose or not (link.holder.holds or link.holder.coupling is not None)
            if rests and link.parent < 0:
                link = replace(link, steps=_unturned(link.steps, link.idle))
            if body is not link.body and carrier != k:
                links.append(replace(link, steps=(), body=body, parent=carrier, on=-1, loose=True))
            else:
                links.append(replace(link, body=body, loose=loose))
        return replace(self, links=tuple(links), rests=rests)

    def rows(self, y: Array, yd: Array, ydd: Array, inputs: Inputs) -> tuple[Array, Wrench]:
        """Forces (..., n) that all coordinates demand of their drives, and the wrench on the ground."""
        return self.demanded(self.motion(y, yd, ydd, inputs), inputs)[:2]

    def demanded(self, state: State, inputs: Inputs) -> tuple[Array, Wrench, list[list[Acting]]]:
        """Forces (..., n) and the wrench on the ground that a motion demands, and those on the points of each body."""
        return self._demanded(state, self.closed(state, inputs), ground=True)

    def closed(self, state: State, inputs: Inputs) -> Inputs:
        """Return inputs with the wrenches that close loops at a motion."""
        if not self.closures or inputs.closing is not None:
            return inputs
        return replace(inputs, closing=self.closing_wrenches(state, inputs))

    def closing_wrenches(self, state: State, inputs: Inputs) -> Array:
        """Wrenches (..., c, 6) that closures put on their frames at a motion, in axes of the points they close on.

        Those along conditions that depend on others are zero: a rigid mechanism does not determine them.
        """
        loads = self._closing_loads(state, inputs, np.zeros(DIRECTIONS * len(self.closures)))[2]
        spread = loads @ np.eye(DIRECTIONS * len(self.closures))[np.array(self.conditions, dtype=int)]
        return spread.reshape(*spread.shape[:-1], len(self.closures), DIRECTIONS)

    def _closing_loads(self, state: State, inputs: Inputs, change: Array) -> tuple[Array, Array, Array]:
        """Rows (..., n) of the unknowns, slopes (..., m, n) of the independent conditions, and their loads (..., m).

        The loads bring a `change` (..., 6 c) of all conditions to zero.
        """
        assert self.weights is not None
        rows = self._demanded(state, inputs, ground=False)[0][..., self.unknowns]
        slopes, chosen = self.closing_slopes(state, self.conditions), np.array(self.conditions, dtype=int)
        return rows, slopes, closing_loads(rows, slopes, self.weights[self.unknowns], change[..., chosen])

    def gaps(self, state: State) -> Array:
        """Gaps (..., 6 c) of the closures: places, m, and rotation vectors, rad."""
        return concatenated([gap(*self._closed_frames(state, closure)) for closure in self.closures])

    def gap_rates(self, state: State) -> tuple[Array, Array, Array]:
        """Gaps (..., 6 c) of the closures with their two derivatives with respect to time."""
        parts = [gap_with_rates(*self._closed_frames(state, closure)) for closure in self.closures]
        values, rates, changes = (concatenated(list(part)) for part in zip(*parts, strict=True))
        return values, rates, changes

    def closing_slopes(self, state: State, conditions: Sequence[int] | None = None) -> Array:
        """Derivatives G (..., m, n) of the gaps' rates, or of m of them, by those of the unknowns: the rows of unit
        wrenches.
        """
        chosen = np.arange(DIRECTIONS * len(self.closures)) if conditions is None else np.array(conditions, dtype=int)
        units = np.eye(DIRECTIONS * len(self.closures))[chosen]
        units = np.concatenate([units, 0 * units[:1]])
        units = units.reshape(len(units), *(1 for _ in state.shape), len(self.closures), DIRECTIONS)
        rows = self._inboard(state, self._closing(state, units))[0][..., self.unknowns]
        return namespace(rows).moveaxis(rows[-1] - rows[:-1], 0, -2)

    def _closed_frames(self, state: State, closure: Closure) -> tuple[Frame, Frame]:
        """Frame at the end of a closing joint, and the point where it is to be."""
        return state.step_motions(closure.frame)[1], state.point(closure.body, closure.on)

    def _closing(self, state: State, wrenches: Array) -> list[tuple[int, int, Wrench]]:
        """Wrenches that motion demands of bodies' points, by body and point, where closures act by `wrenches`."""
        acting = list[tuple[int, int, Wrench]]()
        for k, closure in enumerate(self.closures):
            frame, point = self._closed_frames(state, closure)
            force, moment = wrenches[..., k, :3], wrenches[..., k, 3:]
            turn = namespace(frame.R).swapaxes(frame.R, -1, -2) @ point.R
            acting.append((closure.frame, -1, Wrench(-turned(turn, force), -turned(turn, moment))))
            acting.append((closure.body, closure.on, Wrench(force, moment)))
        return acting

    def _closed_rows(self, state: State, inputs: Inputs) -> Array:
        """Residual (..., n) of the unknown coordinates of a tree with loops."""
        rows, slopes, loads = self._closing_loads(state, inputs, settling(*self.gap_rates(state)))
        return rows - (loads[..., None, :] @ slopes)[..., 0, :]

    def _demanded(self, state: State, inputs: Inputs, *, ground: bool) -> tuple[Array, Wrench, list[list[Acting]]]:
        """Forces and wrenches as :meth:`demanded`; without `ground` that on it is left out, which saves time."""
        acting = list[tuple[int, int, Wrench]]()
        for k, force in enumerate(self.forces):
            frame = state.points_of(force.body)[force.on]
            assert inputs.wrenches is not None
            f, m = -inputs.wrenches[..., k, :3], -inputs.wrenches[..., k, 3:]
            if not force.follower:
                f, m = turned_back(frame.R, f), turned_back(frame.R, m)
            acting.append((force.body, force.on, Wrench(f, m)))
        if inputs.closing is not None:
            acting += self._closing(state, inputs.closing)
        demanded, *rest = self._inboard(state, acting, inputs, ground=ground)
        return demanded if inputs.efforts is None else demanded - inputs.efforts, *rest

    def _inboard(
        self, state: State, acting: list[tuple[int, int, Wrench]], inputs: Inputs | None = None, *, ground: bool = False
    ) -> tuple[Array, Wrench, list[list[Acting]]]:
        """Carry wrenches from bodies' points to the ground: those `acting`, by body and point, and, with `inputs`, what
        the motion of the bodies and their loads demand.
        """
        xp = namespace(*state.q[0], *state.qd[0], *state.qdd[0], *(wrench.force for *_, wrench in acting))
        on_points: list[list[Acting]] = [[] for _ in self.links]
        on_roots: list[list[Wrench]] = [[] for _ in self.links]

        def act(body: int, on: int, wrench: Wrench) -> None:
            if on < 0 or on == len(state.relative(body)):
                on_roots[body].append(wrench)
            else:
                on_points[body].append(Acting(on, state.relative(body)[on], wrench))

        for owner, point, demand in acting:
            act(owner, point, demand)
        rows: list[Array] = []
        on_ground = Wrench(xp.zeros(3), xp.zeros(3))
        for k in reversed(range(len(self.links))):
            link, (steps, root) = self.links[k], state.step_motions(k)
            *joint, body = zip(state.q[k], state.qd[k], state.qdd[k], strict=True)
            generalised, wrench = 0 * body[0], Wrench(xp.zeros(3), xp.zeros(3))
            if inputs is not None:
                generalised, wrench = link.body.demanded(*body, root, inputs.loads[k])
            if on_points[k]:
                generalised = generalised + link.body.generalised_forces(body[0], on_points[k])
            wrench = sum((acting.wrench.brought(acting.by) for acting in on_points[k]), start=wrench)
            wrench = sum(on_roots[k], start=wrench)
            on_steps: list[Array] = []
            # No row is asked of what lies between the ground and the first step with coordinates.
            idle = 0 if ground or link.parent >= 0 else link.idle + 1
            for i, (step, relative, coordinates) in reversed(
                list(enumerate(zip(link.steps, steps, joint, strict=True)))
            ):
                on_steps.insert(0, step.rows(*coordinates, wrench))
                wrench = wrench if i < idle else wrench.brought(relative)
            if on_steps:
                if not link.loose and inputs is not None:
                    holding = link.holding([q for q, _, _ in joint], [qd for _, qd, _ in joint])
                    on_steps = [demand + effort for demand, effort in zip(on_steps, holding, strict=True)]
                generalised = concatenated([*on_steps, generalised])
            rows.insert(0, generalised)
            if link.parent < 0:
                on_ground = on_ground + wrench if ground else on_ground
            else:
                act(link.parent, link.on, wrench)
        return concatenated(rows), on_ground, on_points

    def invariants(self, state: State, gravity: Array) -> tuple[Array, Array, Array]:
        """Momentum, N s, and angular momentum, N m s, (..., 3) in the ground's axes, and kinetic, elastic and
        gravitational energy (..., 3), J.
        """
        total_momentum = total_spin = kinetic = elastic = potential = 0.0
        for k, link in enumerate(self.links):
            q, qd, (_, root) = state.q[k], state.qd[k], state.step_motions(k)
            energy, impulse = momentum(link.body, q[-1], qd[-1], root)
            push, spin = turned(root.R, impulse.force), turned(root.R, impulse.moment)
            total_momentum, total_spin = total_momentum + push, total_spin + spin + cross(root.p, push)
            kinetic = kinetic + energy
            elastic = elastic + link.body.stored(q[-1])
            if not link.loose:
                elastic = elastic + link.stored(q[:-1], qd[:-1])
            potential = potential + 0.0 * kinetic
            if is_jax(gravity) or gravity.any():
                mass, first_moment = link.body.mass_moment(q[-1])
                potential = potential - ((mass * root.p + turned(root.R, first_moment)) * gravity).sum(axis=-1)
        return total_momentum, total_spin, namespace(kinetic, elastic).stack([kinetic, elastic, potential], axis=-1)

    def local(self, y: Array, yd: Array, ydd: Array) -> tuple[Tree, Array, Array, Array]:
        """Return the same tree by as many coordinates as degrees of freedom, and these with their two rates.

        Euler parameters are replaced by a rotation vector, which is zero at the coordinates `y` (n,).
        """
        new_numbers: dict[int, int] = {}  # among the fewer coordinates, by those among all
        links, states, count = [], [], 0  # number of all coordinates so far
        for link, *parts in zip(self.links, *self.parted(y, yd, ydd), strict=True):
            steps, is_local = [], []  # flags of coordinates: a ball loses its first one
            for step, *rates in zip(link.steps, *parts, strict=False):
                reduced, *state = step.minimal_form(*rates)
                steps.append(reduced)
                states.append(state)
                is_local += [step.size - reduced.size <= k for k in range(step.size)]
            states.append([coordinates[-1] for coordinates in parts])  # those of the body
            is_local += [True] * link.body.size
            for k in np.flatnonzero(is_local).tolist():
                new_numbers[count + k] = len(new_numbers)
            count += len(is_local)
            links.append(replace(link, steps=tuple(steps)))
        joined = (np.concatenate(arrays) for arrays in zip(*states, strict=True))
        fixed = tuple(new_numbers[k] for k in self.fixed if k in new_numbers)
        weights = None if self.weights is None else self.weights[list(new_numbers)]
        tree = replace(self, links=tuple(links), fixed=fixed, weights=weights)
        return tree, *joined  # type: ignore[return-value]
