"""Solutions of systems: a motion at some times, or a state of rest, with what drives it, and what is read of it."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np

from gbeam.analysis.accuracy.correction import (
    DEFLECTION,
    PLACE,
    Correction,
    Embedding,
    IntArray,
    Posed,
    Quantity,
    Reading,
    matrix_times,
    pieces,
)
from gbeam.analysis.system.histories import Carried, carried, deflections, held_loads, loads_of
from gbeam.analysis.system.richer import Directions
from gbeam.arrays.types import Floats, Indices
from gbeam.integrate.equations import Trajectory
from gbeam.mechanics.causes import causes_of, loads_at
from gbeam.mechanics.enrichment import enrichment
from gbeam.mechanics.plausibility import bend, bent_far, stretched, unstiffened
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.equations import Inputs
from gbeam.mechanics.tree.frames import Frame
from gbeam.mechanics.tree.rigid_body import RigidBody
from gbeam.mechanics.tree.signal_names import deforming
from gbeam.mechanics.tree.system import System
from gbeam.results.parts import Base, Loads

SCAN = 200  # samples at which to look for directions without shapes that are moved
IDLE = 1e-9  # of the largest force: a direction with a smaller one gets no shapes
InputsOf = Callable[[System, Any], Inputs]  # of a system with the same joints, at times by an index or slice


@dataclass(frozen=True, eq=False)
class Solution:
    """A system, its trajectory (coordinates, rates and accelerations at times), and its inputs at these times.

    The inputs are known for every system with the same joints.
    """

    system: System
    trajectory: Trajectory
    inputs: InputsOf

    def posed(self, bodies: Iterable[str], system: System | None = None) -> Posed:
        """Equations of this or another system at the solution's times, with a function that reads `bodies`."""
        system = self.system if system is None else system
        return Posed(
            system.tree,
            partial(self.inputs, system),
            system.unknown_coordinates,
            lambda trajectory, times: Solution(system, trajectory, self.select(times).inputs).read(bodies),
            partial(departure_sizes, system, bodies),
        )

    def select(self, times: Indices) -> Solution:
        """Return the solution at indices of its times."""
        return Solution(
            self.system, self.trajectory.select(times), lambda system, part: self.inputs(system, times[part])
        )

    def insert(self, system: System, bodies: Iterable[str], shared: IntArray | None = None) -> Embedding:
        """Put the solution into another system's equations, by its unknowns' names or their indices `shared`."""
        return Embedding.lifted(self.posed(bodies, system), self.posed(bodies), self.trajectory, shared)

    def states(self, bodies: Iterable[str]) -> tuple[Floats, dict[str, Carried]]:
        """Places (t, p, 3) m of all points, and the states of some bodies by name."""
        tree, trajectory = self.system.tree, self.trajectory
        places, states = list[Floats](), {name: list[Carried]() for name in bodies}
        for times in pieces(len(trajectory.time), tree.size):
            inputs, chosen = self.inputs(self.system, times), trajectory.select(times)
            state = tree.motion(chosen.q, chosen.qd, chosen.qdd if states else 0 * chosen.q, inputs)
            places.append(state.places)
            if states:
                acting = tree.demanded(state, inputs)[2] if self.system.laden & {*states} else [[] for _ in tree.links]
                for name, body_pieces in states.items():
                    body_pieces.append(carried(self.system, state, name, acting))
        return np.concatenate(places), {name: Carried.joined(parts) for name, parts in states.items()}

    def read(self, bodies: Iterable[str]) -> Reading:
        """Places (t, p, 3) m of all points, and quantities of some bodies.

        For each body these are deflections (t, p, 3) m, force and moment (t, 3) at the root, and the largest normal and
        von Mises stress over the sections (t,). A solid has the stress (t, c) of `recovery.felt`.
        """
        places, states = self.states(bodies)
        readings: dict[Quantity, Floats] = {PLACE: places}
        for name, moved in states.items():
            body = self.system.flexible[name]
            time = self.trajectory.time
            readings |= reading_of(name, body, time, moved.q, loads_of(body, moved, time))
        return readings

    def turning(self) -> Floats:
        """Places (t, 3 k, 3) m, relative to the root in the ground's axes, of three points on each of k rigid bodies,
        which move as the body turns.

        These are the bodies without points off the root. The points lie on the body's axes at its radius of gyration.
        """
        tree, trajectory, radii = self.system.tree, self.trajectory, dict[int, float]()
        for k, name in enumerate(self.system.order):
            body = self.system.bodies[name]
            if isinstance(body, RigidBody) and not np.any(body.body.places) and body.mass > 0:
                about_root = np.trace(body.tensor) / (2 * body.mass) + np.square(body.centre).sum()
                radii[k] = float(np.sqrt(about_root))
        places = list[Floats]()
        for times in pieces(len(trajectory.time), tree.size) if radii else ():
            state = trajectory.select(times)
            roots = tree.motion(state.q, state.qd, 0 * state.q, self.inputs(self.system, times)).roots
            axes = [radius * np.swapaxes(roots[k].R, -1, -2) for k, radius in radii.items()]
            places.append(np.concatenate([np.broadcast_to(ends, (len(state.q), 3, 3)) for ends in axes], axis=1))
        return np.concatenate(places) if places else np.zeros((len(trajectory.time), 0, 3))

    def bases(self, bodies: Iterable[str]) -> dict[str, Base]:
        """Motions (t, 3) of the roots of some bodies by name, at a selection of the times."""
        times = matrix_times(len(self.trajectory.time))
        chosen = self.trajectory.select(times)
        state = self.system.tree.motion(chosen.q, chosen.qd, chosen.qdd, self.inputs(self.system, times))
        roots = {name: state.roots[k] for k, name in enumerate(self.system.order)}
        return {name: Base(roots[name].a, roots[name].w, roots[name].alpha) for name in bodies}

    def bent_directions(self, bodies: Iterable[str]) -> dict[str, Directions]:
        """Flags of x, y and z by the names of bodies: true if a body has shapes there, or would move in new ones.

        Bodies on which others hang, or forces act, may move along all.
        """
        tree, count, acted = self.system.tree, len(self.trajectory.time), self.system.laden
        directions, wanted = dict[str, Directions](), list[tuple[int, str]]()
        for k, name in enumerate(self.system.order):
            if name in bodies:
                directions[name] = True, True, True
                body = self.system.flexible[name]
                if body.source is not None and not all(body.counts[:3]) and name not in acted:
                    wanted.append((k, name))
        if wanted:
            times = np.linspace(0, count - 1, min(count, SCAN)).astype(int)
            chosen, inputs = self.trajectory.select(times), self.inputs(self.system, times)
            state = tree.motion(chosen.q, chosen.qd, chosen.qdd, inputs)
            for k, name in wanted:
                q, qd, qdd = (values[k][-1] for values in (state.q, state.qd, state.qdd))
                directions[name] = _bent_axes(self.system.flexible[name], state.roots[k], q, qd, qdd, inputs.loads[k])
        return directions

    @property
    def deformed(self) -> dict[str, Floats]:
        """Coordinates (t, n) of flexible bodies by name."""
        q = np.zeros((len(self.trajectory.time), len(self.system.coordinates)))
        q[:, self.system.tree.unknowns] = self.trajectory.q
        return {name: q[:, deforming(self.system.coordinates, name)] for name in self.system.flexible}

    @property
    def bends(self) -> dict[str, float]:
        """Largest bends, as shares of the length, of flexible bodies by name."""
        return {name: bend(self.system.flexible[name], q) for name, q in self.deformed.items()}

    @property
    def stiffness_warnings(self) -> tuple[str, ...]:
        """Warnings of bodies made of matrices, which lack stiffness by loads, with the size of that in this motion.

        Others are of bodies that bend too far for a stiffness of first order.
        """
        flexible = self.system.flexible
        lacking = [name for name, body in flexible.items() if body.unstiffened]
        bases = self.bases(lacking) if lacking else {}
        warnings = [(name, unstiffened(flexible[name], base, "its motion")) for name, base in bases.items()]
        warnings += [(name, bent_far(flexible[name], share)) for name, share in self.bends.items()]
        warnings += [(name, stretched(flexible[name], q)) for name, q in self.deformed.items()]
        return tuple(f"{name}: {warning}" for name, body_warnings in warnings for warning in body_warnings)


def reading_of(name: str, body: Structure, time: Floats, q: Floats, loads: Loads) -> Reading:
    """Quantities of one body, as :meth:`Solution.read` reads them, from its coordinates (t, n) and its loads at times
    (t,), s.
    """
    stress = loads.stress.max(axis=1)
    if body.recovery is not None:
        stress = body.recovery.felt(causes_of(body, q, loads_at(body, time)))
    sheared = loads.stress if loads.von_mises is None else np.nan_to_num(loads.von_mises)
    force, moment = held_loads(loads)
    return {
        (name, DEFLECTION): deflections(body, q),
        (name, "force"): force,
        (name, "moment"): moment,
        (name, "stress"): stress,
        (name, "sheared"): sheared.max(axis=1),
    }


def first_order_sizes(body: Structure, q: Floats, accelerations: Floats) -> tuple[Floats, Floats, Floats]:
    """Sizes (t,), to first order, of the displacement of a body's end by coordinates (t, n), and of the force and
    moment at its root by accelerations (t, n) of the coordinates.
    """
    c = body.coefficients
    vectors = q @ body.station_places.first[-1].T, accelerations @ c.f_a.T, accelerations @ c.f_al.T
    deflection, force, moment = (np.linalg.norm(vector, axis=1) for vector in vectors)
    return deflection, force, moment


def elastic_accelerations(body: Structure, q: Floats) -> Floats:
    """Accelerations (t, n) whose inertia balances the elastic forces of coordinates (t, n)."""
    return np.asarray(np.linalg.solve(body.coefficients.mass, body.coefficients.stiffness @ q.T).T)


def departure_sizes(system: System, bodies: Iterable[str], correction: Correction) -> Floats:
    """Sizes (t, k) of a small departure: of all coordinates and their accelerations and, for some `bodies`, of the
    deflections, the root loads by inertia and by elastic forces, and the elastic energy.
    """
    names, sizes = (
        system.unknown_coordinates,
        list[Floats]([*np.abs(correction.value).T, *np.abs(correction.acceleration).T]),
    )
    for name in bodies:
        columns, body = deforming(names, name), system.flexible[name]
        q, qdd = correction.value[:, columns], correction.acceleration[:, columns]
        sizes += [*first_order_sizes(body, q, qdd), *first_order_sizes(body, q, elastic_accelerations(body, q))[1:]]
        sizes.append(np.einsum("ti,ij,tj->t", q, body.coefficients.stiffness, q))
    return np.stack(sizes, axis=1)


def _bent_axes(body: Structure, root: Frame, q: Floats, qd: Floats, qdd: Floats, loads: Floats | None) -> Directions:
    """Flags of x, y and z: true if a beam with this motion of its root has shapes there, or would move in new ones."""
    rich, index = enrichment(body, Base(root.a, root.w, root.alpha)).model(body.kind)
    c, lifted = rich.coefficients, np.zeros((3, len(q), rich.size))
    lifted[:, :, index] = q, qd, qdd
    residual = c.residual(lifted[0], lifted[1], lifted[2], root.a, root.w, root.alpha, loads)
    counts = np.cumsum([0, *rich.counts])
    forces = [np.abs(residual[:, a:b]).max(initial=0.0) for a, b in pairwise(counts)]
    limit = IDLE * max(np.abs(lifted[0] @ c.stiffness).max(), *forces)
    axial, along_y, along_z = (n > 0 or size > limit for n, size in zip(body.counts[:3], forces, strict=False))
    return axial, along_y, along_z
