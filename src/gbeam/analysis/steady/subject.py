"""Subjects of questions about steady states: systems, and structures alone in a motion as systems of one body."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from gbeam.analysis.accuracy.estimate import BEAM
from gbeam.analysis.steady.hinged import turned_by_effort
from gbeam.analysis.system.drive import Drive
from gbeam.analysis.system.steady import SteadySystem, open_loops
from gbeam.arrays.types import Complex, Floats
from gbeam.errors import InputError
from gbeam.mechanics.plausibility import bend, bent_far, input_warnings, stretched
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.one_body import HINGE, hub_system
from gbeam.mechanics.tree.signal_names import deforming, local_names
from gbeam.mechanics.tree.system import System
from gbeam.motion.protocol import Motion
from gbeam.numerics.eigen import Steady
from gbeam.results.modal import outermost
from gbeam.results.parts import Base


@dataclass(frozen=True, eq=False)
class Subject:
    """A system, and the motion of its ground, that a question is about. If one body is alone, `body` is its name, and
    `motion` the one in which it was given.
    """

    system: System
    ground: Motion | None
    body: str
    motion: Motion | None

    @property
    def structure(self) -> Structure:
        """The body that is alone."""
        return self.system.flexible[self.body]

    @property
    def kind(self) -> str:
        """Kind of the body's model; "system" of a system."""
        return self.structure.kind if self.body else self.system.kind

    @property
    def noun(self) -> str:
        """Word for it."""
        return "beam" if self.body else "system"

    @property
    def rate(self) -> str:
        """Word for the rate at which it turns."""
        return "hub rate" if self.body else "rate"

    def drive(self, time: float) -> Drive:
        """Drives at a time, s. On a hub that turns freely without a spring, the rate is that of the angular momentum of
        torque and damper since time zero.
        """
        drive = Drive(self.ground, time)
        if not self.body or self.motion is None or not self.motion.free:
            return drive
        hub: Any = self.motion
        if float(hub.stiffness) > 0:
            return drive
        if time > 0 and (self.structure.history is not None or hub.mount.gravity is not None):
            raise InputError(
                "time",
                f"is {time:g} s, when gravity or loads have moved a free hub",
                "give time 0 or a rate, or ask `gbeam run` how it moves",
            )
        return turned_by_effort(self.system, HINGE, time)

    def resting_drive(self, time: float) -> Drive:
        """Drives at a time, s, on which a free hub is held at rest, at angle zero."""
        free = self.body and self.motion is not None and self.motion.free
        return Drive(self.ground, time, f"{HINGE}.angle", rate=0.0) if free else Drive(self.ground, time)

    def require_coordinates(self) -> None:
        """Raise InputError where one body is rigid, and an answer is about what deforms."""
        if self.body:
            self.structure.require_coordinates()

    def columns(self, state: Steady) -> list[int]:
        """Indices of a steady state's coordinates that deform the body that is alone; of a system all of them."""
        return deforming(state.names, self.body) if self.body else [*range(len(state.names))]

    def directions(self, state: Any, modes: Complex | Floats) -> tuple[str, ...]:
        """Words for what each mode (n, k) moves most: a body and an axis of its root. For one body alone they are the
        axis, or twist where the sections' edges move more.
        """
        if not self.body:
            return state.directions(modes)
        columns = self.columns(state)
        return directions_of(state.system.flexible[self.body], state.q[columns], modes[columns])

    def base(self, state: SteadySystem) -> Base:
        """Motion of the root of the body that is alone, (3,)."""
        return state.base_of(self.body)

    def doubts(
        self, name: str = "", base: Base | None = None, span: tuple[float, float] = (0.0, 0.0)
    ) -> tuple[str, ...]:
        """Doubts about the bodies' models. For one body there are doubts about its motion, too, called `name`, or about
        a motion of its `base`, over a span of time, s.
        """
        if not self.body:
            return self.system.warnings
        return input_warnings(self.structure, self.motion, name=name, span=span, base=base)

    def warnings(self, state: SteadySystem, name: str, *, resting: bool = False) -> tuple[str, ...]:
        """Doubts about the models of the bodies in a state, and about what they leave out in it. The state is
        `resting`, or one from which a system departs. `name` is that of the motion.
        """
        if not self.body:
            return state.warnings + state.point.sticking(state.system, resting=resting) + open_loops(self.system)
        structure, time = self.structure, state.drive.time
        doubts = input_warnings(structure, self.motion, name=name, span=(time, time), base=self.base(state))
        q = state.q[self.columns(state)]
        return (*doubts, *bent_far(structure, bend(structure, q)), *stretched(structure, q))

    @property
    def unstiffened(self) -> bool:
        """True if the stress of loads is left out of the stiffness of one body."""
        return bool(self.body) and self.structure.unstiffened

    @property
    def resolved(self) -> int:
        """Number of the lowest modes that belong to the bodies, and not to static shapes among their coordinates."""
        shapes = sum(body.size - body.resolved for body in self.system.flexible.values())
        return len(local_names(self.system.coordinates)) - shapes


def subject_of(structure: Structure | System, motion: Motion | None) -> Subject:
    """Subject of a question about a system whose ground has a motion, or about a structure alone in it. The latter is
    the same as the system of this structure.
    """
    system = structure if isinstance(structure, System) else System.of(structure, BEAM)
    body = system.only_structure
    if body is None:
        return Subject(system, motion, "", motion)
    (name,) = system.order
    if motion is None or not motion.free:
        return Subject(system, motion, name, motion)
    return Subject(hub_system(body, motion, name), None, name, motion)


def directions_of(structure: Structure, q: Floats, modes: Complex | Floats) -> tuple[str, ...]:
    """Axes of the root along which a body at coordinates (n,) moves most in modes (n, k) of these, or twist where the
    sections' edges move more.
    """
    particles, stations = structure.particles.slopes(q), structure.station_slopes(q)
    moved = np.abs(np.concatenate([particles, stations]) @ modes).max(axis=0)
    ways = ["xyz"[i] for i in moved.argmax(axis=0)]
    edges = edges_of(structure, q, modes)
    if edges is None:
        return tuple(ways)
    twisted = np.abs(edges).max(axis=0) > np.abs(stations @ modes).max(axis=(0, 1))
    return tuple("twist" if flag else way for way, flag in zip(ways, twisted, strict=True))


def edges_of(structure: Structure, q: Floats, modes: Complex | Floats) -> Complex | Floats | None:
    """Displacements (s, k) of the stations' outermost fibres by twist in modes (n, k), or None without twist."""
    twist = structure.twist_slopes(q)
    if twist is None or structure.source is None:
        return None
    section = structure.source.beam.section.at(structure.stations)
    fibre = outermost(*section.extents(), is_round=section.round)
    return fibre[:, None] * (twist @ modes)
