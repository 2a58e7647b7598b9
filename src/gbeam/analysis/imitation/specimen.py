"""A specimen as comparisons and placements see it: loads on its base, displacements of its points, and its modes.

The load at a place r from the root is a + G r: the root's acceleration, or specific force, and its growth along x, y
and z, G = α× + ω ωᵀ − ω² 1 (2020 (4)). Everything static is linear in these twelve numbers, of a beam, a system, a
solid and a rigid box alike."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from gbeam.analysis.outline import ends_of
from gbeam.analysis.system.drive import Drive
from gbeam.analysis.system.point import Point
from gbeam.analysis.system.rest import steady_state
from gbeam.arrays.tree import each_leaf
from gbeam.arrays.types import Floats
from gbeam.errors import InputError
from gbeam.mechanics.equations.linear import PAIRS, rest_modes
from gbeam.mechanics.tree.body_terms import stations_of
from gbeam.mechanics.tree.system import System
from gbeam.numerics.eigen import RIGID, symmetric

ALIKE = 1e-3  # of the displacement by a mode: two modes that differ by less count as equal


class Answer(NamedTuple):
    """Values by unit accelerations (3, ...) of the root, and by unit growths G (3, 3, ...) of the load."""

    a: Floats
    growth: Floats

    @classmethod
    def from_units(cls, a: Floats, alpha: Floats, ww: Floats) -> Answer:
        """Combine the answers to unit accelerations and unit angular accelerations (3, ...), and to unit products of
        rates (3, 3, ...).

        The growth G = α× + ω ωᵀ − ω² 1 has its antisymmetric part from α, and its symmetric part from ω.
        """
        unit = np.eye(9).reshape(3, 3, 3, 3)
        symmetric_part = (unit + unit.swapaxes(2, 3)) / 2
        odd = (unit - unit.swapaxes(2, 3)) / 2
        angular = np.stack([odd[..., 2, 1], odd[..., 0, 2], odd[..., 1, 0]], axis=-1)  # α of each unit growth
        trace = np.trace(symmetric_part, axis1=2, axis2=3)[..., None, None]
        pairs = symmetric_part - trace / 2 * np.eye(3)  # ω ωᵀ of each
        return cls(a, np.tensordot(angular, alpha, 1) + np.tensordot(pairs, ww, 2))

    def map(self, values: Any) -> Answer:
        """Return the answer with its values mapped by a matrix (..., k)."""
        return Answer(self.a @ values, self.growth @ values)

    def evaluate(self, a: Floats, growth: Floats) -> Floats:
        """Values at accelerations (..., 3) and growths (..., 3, 3) of the root."""
        return np.asarray(np.tensordot(a, self.a, 1) + np.tensordot(growth, self.growth, 2))


@dataclass(frozen=True)
class Modes:
    """Modes of a specimen: circular frequencies (n,) rad/s, damping ratios (n,), modal forces (n,), and displacements
    (p, 3, n) of its points by unit amplitudes.
    """

    frequency: Floats
    damping: Floats
    force: Answer
    shape: Floats

    def one(self, k: int) -> Modes:
        """Return mode k alone."""
        force = Answer(self.force.a[..., k], self.force.growth[..., k])
        return Modes(self.frequency[k], self.damping[k], force, self.shape[..., k])

    def foremost(self, point: int, a: Floats, growth: Floats) -> Modes:
        """Return the slowest of the modes that displace a point most, statically, under loads (t, 3), (t, 3, 3)."""
        force = np.abs(self.force.evaluate(a, growth)).max(axis=0)
        moved = np.linalg.norm(self.shape[point], axis=0) * force / self.frequency**2
        return self.one(int(np.argmax(moved >= (1 - ALIKE) * moved.max())))


@dataclass(frozen=True)
class Specimen:
    """Answers of a specimen to loads: force and moment on its base, displacement of its points by name, and modes,
    which a rigid one does not have. `ends` are the places (3,) m, by name, at one of which the load is largest.
    """

    force: Answer
    moment: Answer
    displacement: Mapping[str, Answer]
    modes: Modes | None
    ends: Mapping[str, Floats]
    straight: bool
    corners: Callable[[float], Floats]

    @classmethod
    def from_system(cls, system: System, times: Floats) -> Specimen:
        """Find the answers of a system about its rest on a ground at rest; InputError if it moves at times (t,), s."""
        _refuse_drives(system, times)
        state = steady_state(system, Drive(time=float(times[0])))
        local, stiffness = state.local, state.linear.stiffness
        forces, force, moment = _answers(local)
        displacement, modes, free = dict[str, Answer](), None, len(local.y)
        if free:
            square, shapes = np.linalg.eigh(symmetric(stiffness))
            if not square[0] > RIGID**2 * square[-1]:
                loose = state.names[int(np.abs(shapes[:, 0]).argmax())]
                fix = "give it a spring, or hold it, while a place is searched for"
                raise InputError("joints", f"leave {loose} held by nothing that resists a load at rest", fix)
            judged = _judged(system)
            moved = state.slopes_of_points[[system.points.index(name) for name in judged]]
            by_load = np.linalg.solve(stiffness, moved.reshape(-1, free).T).reshape(free, -1, 3)
            displacement = {name: forces.map(by_load[:, k]) for k, name in enumerate(judged)}
            mass, damping, stiffness = (symmetric(matrix) for matrix in state.linear[:3])
            modes = _modes(mass, damping, stiffness, forces, moved)
        beams = [None if body.source is None else body.source.beam for body in system.flexible.values()]
        straight = len(system.bodies) == 1 and any(beam is not None and beam.line is None for beam in beams)
        return cls(force, moment, displacement, modes, ends_of(system), straight, system.corners)

    @property
    def extent(self) -> Floats:
        """Least and largest coordinates (2, 3) of its ends, m."""
        ends = np.array([*self.ends.values()])
        return np.stack([ends.min(axis=0), ends.max(axis=0)])


def _judged(system: System) -> list[str]:
    """Names of the points whose displacement is judged: the tip of the only body, else all points."""
    if len(system.bodies) == len(system.flexible) == 1:
        ((name, body),) = system.flexible.items()
        points = stations_of(body)
        return [f"{name}.{max(points, key=points.__getitem__)}"]
    return [*system.points]


def _modes(mass: Floats, damping: Floats, stiffness: Floats, forces: Answer, moved: Floats) -> Modes:
    """Modes from M, C and K (n, n), and from forces and displacements (p, 3, n) of points per coordinate."""
    frequency, modes = rest_modes(mass, stiffness)
    ratio = np.einsum("nk,nm,mk->k", modes, damping, modes) / (2 * frequency)
    return Modes(frequency, ratio, forces.map(modes), moved @ modes)


def _refuse_drives(system: System, times: Floats) -> None:
    """Raise InputError if controllers or prescribed rates move a system, which then has no place of rest."""
    if system.controllers:
        fix = "give the joints springs in their place, and compare runs with them by `gbeam sweep`"
        raise InputError("controllers", "hold joints, and a place is judged by what rests", fix)
    prescribed = system.inputs(times).prescribed
    if prescribed is not None and np.any(prescribed[:, 1]):
        name = system.coordinates[system.tree.fixed[int(np.abs(prescribed[:, 1]).max(axis=0).argmax())]]
        fix = "give it the rate 0, at each position that is of interest"
        raise InputError("joints", f"move {name}, and a place is judged by what rests", fix)


def _answers(local: Point) -> tuple[Answer, Answer, Answer]:
    """Answers of a state of rest: forces on its coordinates, and force and moment on the ground.

    Thirteen motions of the ground are evaluated: none, three of a, three of α, and six pairs of ω.
    """
    eye = np.eye(3)
    pairs = [eye[i] + (eye[j] if i != j else 0.0) for i, j in PAIRS]
    zeros, count = np.zeros((3, 3)), 13
    a = np.concatenate([np.zeros((1, 3)), eye, zeros, zeros, zeros])
    alpha = np.concatenate([np.zeros((1, 3)), zeros, eye, zeros, zeros])
    w = np.concatenate([np.zeros((1, 3)), zeros, zeros, pairs])
    inputs = each_leaf(lambda leaf: np.broadcast_to(leaf, (count, *np.shape(leaf))), local.inputs)
    inputs = replace(inputs, ground=replace(inputs.ground, a=a, alpha=alpha, w=w))
    y, yd, ydd = (np.broadcast_to(state, (count, len(state))) for state in (local.y, local.yd, local.ydd))
    rows, ground = local.tree.rows(y, yd, ydd, inputs)

    def answer(values: Floats) -> Answer:
        """Answer from the values (13, ...) in all motions. Those of two rates at once hold the squares of both."""
        change = values[0] - np.broadcast_to(values, (count, values.shape[-1]))
        ww = np.zeros((3, 3, change.shape[-1]))
        for k, (i, j) in enumerate(PAIRS):
            product = change[7 + k] if i == j else (change[7 + k] - change[7 + i] - change[7 + j]) / 2
            ww[i, j] = ww[j, i] = product
        return Answer.from_units(change[1:4], change[4:7], ww)

    return answer(rows[:, local.tree.unknowns]), answer(ground.force), answer(ground.moment)
