"""Plants of shaped commands: a hub with its beam, or a joint of a system."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from gbeam.analysis.control.linearization import linearize
from gbeam.analysis.response.differentiated import Differentiated, Grid
from gbeam.analysis.response.peaks import half_ranges
from gbeam.analysis.response.settings import ResponseSettings
from gbeam.analysis.response.simulation import simulate
from gbeam.analysis.response.stepping import scheme_of
from gbeam.analysis.response.systems import simulate_system
from gbeam.analysis.system.histories import deflection
from gbeam.analysis.system.point import started
from gbeam.analysis.system.steady import Drive, SteadySystem, steady
from gbeam.arrays.tree import altered
from gbeam.errors import InputError
from gbeam.guards.checks import choice
from gbeam.integrate.driver import through
from gbeam.integrate.equations import NonlinearEquations, accelerations, slopes
from gbeam.integrate.steps import Corners, fitted
from gbeam.integrate.tangent import tangent
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.joints import SLIDES
from gbeam.mechanics.tree.system import System, stations_of
from gbeam.motion.bases.hub import Hub
from gbeam.motion.profiles.profile import Profile
from gbeam.numerics.eigen import RIGID, Linear, symmetric, symmetric_modes
from gbeam.numerics.series import STEP
from gbeam.results.response import Response
from gbeam.results.result import Floats

Pair = tuple[Profile, Profile]
HELD = 1e-9  # of the forces that stiffness or damping has: a rigid motion without is free


class Ran(NamedTuple):
    """Displacement of the tip (t, 3) m under a command, what is left of it, and the step."""

    time: Floats
    tip: Floats
    outcome: str
    message: str
    residual: float
    step: float


class SmallMotions(NamedTuple):
    """State matrix (n, n), column (n,) of the drive, and rows (3, n) of the tip, about rest."""

    a: Floats
    column: Floats
    tip: Floats


def driven(hub: Hub, profile: Profile) -> Hub:
    """The hub under a command, mounted as it is."""
    commanded: Hub = altered(hub, **{"torque" if hub.free else "rate": profile})
    return commanded


def turning_inertia(structure: Structure, hub: Hub) -> float:
    """Moment of inertia of hub and straight beam about the hub's axis, kg m²."""
    mass, sx, sy, sz, xx, yy, zz, xy, yz, zx = (float(each) for each in np.asarray(structure.coefficients.rigid))
    to_hub = np.asarray(hub.mount.R_HB)
    second = to_hub @ np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]]) @ to_hub.T
    first, radius = to_hub @ np.array([sx, sy, sz]), float(hub.radius)
    assert hub.inertia is not None
    return float(hub.inertia) + mass * radius**2 + 2 * radius * float(first[0]) + float(second[0, 0] + second[1, 1])


@dataclass(frozen=True)
class OnHub:
    """A beam on a hub, driven by its torque if it is free, else by its rate."""

    structure: Structure
    hub: Hub

    @property
    def kind(self) -> str:
        """Kind of the model."""
        return self.structure.kind

    @property
    def free(self) -> bool:
        """Whether the drive is a torque."""
        return self.hub.free

    @property
    def inertia(self) -> float:
        """Moment of inertia of all that turns, kg m²."""
        return turning_inertia(self.structure, self.hub)

    def refuse_moving(self) -> None:
        """Raise InputError unless it is at rest without a command."""
        if self.hub.mount.gravity is not None:
            raise InputError("gravity", "bends the beam as it turns, which no command undoes", "leave it out")
        if not self.hub.free and float(np.abs(self.hub.base(np.zeros(1)).w_WB_B).max()) > 0:
            raise InputError("rate", "is not zero: the hub turns already", "leave it out")

    @property
    def small(self) -> SmallMotions:
        """Small motions about rest."""
        linear = linearize(self.structure, self.hub)
        if self.hub.free:
            return SmallMotions(linear.a, linear.b[:, 0], linear.c[:3])
        base = self.hub.mount.base(np.zeros(1), np.zeros(1), np.ones(1))
        column = linear.b[:, :3] @ base.a_WO_B[0] + linear.b[:, 3:6] @ base.alpha_WB_B[0]
        return SmallMotions(linear.a, column, linear.c[:3])

    def run(self, profile: Profile, settings: ResponseSettings, name: str = "") -> Ran:
        """Run a command."""
        return _ran(simulate(self.structure, driven(self.hub, profile), settings, name=name))

    def about(
        self, profile: Profile, settings: ResponseSettings, pairs: Sequence[Pair], width: float
    ) -> tuple[Ran, Iterator[tuple[Ran, Ran]]]:
        """A run of given steps, and those of pairs of commands that differ by a width, along its exact derivatives."""
        assert settings.step is not None
        hub = driven(self.hub, profile)
        about = Differentiated(self.structure, hub, settings, Grid(settings.step, 1), "", loads=False)
        posed = [about.pair(*((None, driven(self.hub, each)) for each in pair)) for pair in pairs]
        both = about.responses(posed, np.full(len(posed), width))
        return _ran(about.own()), ((_ran(less), _ran(more)) for less, more in both)


def _ran(of: Response) -> Ran:
    left = float(np.linalg.norm(of.peaks.residual_amplitude))
    return Ran(of.time, np.asarray(of.tip), of.outcome, of.message, left, of.step)


@dataclass(frozen=True)
class OnJoint:
    """A system on the ground, driven by the effort on a coordinate of a joint if it is free, else by its rate."""

    system: System
    coordinate: str
    point: str  # of the beam whose vibration is made least

    @staticmethod
    def of(system: System, coordinate: str, point: str | None) -> OnJoint:
        """The joint of a system, and the tip of the only beam where no point is named."""
        angles = [f"{name}.{each}" for name, joint in system.joints.items() for each in joint.coordinates]
        choice("joint", coordinate, [each for each in angles if not each.rpartition(".")[2].startswith("e")])
        tips = [f"{name}.tip" for name, body in system.bodies.items() if isinstance(body, Structure)]
        if point is None and len(tips) != 1:
            fix = f"choose from {', '.join(tips)}" if tips else "give the system a beam"
            raise InputError("point", "is missing: it says whose vibration is made least", fix)
        chosen = tips[0] if point is None else point
        name, at = system.point("point", chosen)
        body = system.bodies[name]
        if not isinstance(body, Structure) or at >= len(stations_of(body)):
            raise InputError("point", f"is {chosen!r}, which does not deflect", "choose a point of a beam")
        return OnJoint(system, coordinate, chosen)

    @property
    def kind(self) -> str:
        """Kind of the model of the beam."""
        return self._beam[0].kind

    @property
    def free(self) -> bool:
        """Whether the drive is an effort."""
        return self.coordinate not in self._rates

    @property
    def _rates(self) -> set[str]:
        return {f"{name}.{each}" for name, joint in self.system.joints.items() for each in joint.rates}

    @property
    def _beam(self) -> tuple[Structure, int]:
        name, at = self.system.point("point", self.point)
        body = self.system.bodies[name]
        assert isinstance(body, Structure)
        return body, list(stations_of(body).values())[at]

    def refuse_moving(self) -> None:
        """Raise InputError unless it is at rest without a command."""
        if self.system.gravity is not None and np.any(np.asarray(self.system.gravity)):
            raise InputError("gravity", "bends the beam as it turns, which no command undoes", "leave it out")
        if np.abs(self.system.start[1]).max(initial=0.0) > 0:
            raise InputError("initial_rate", "is not zero: the system moves already", "leave it out")
        if self.coordinate.rpartition(".")[2] in SLIDES:
            raise InputError("joint", f"is {self.coordinate!r}, which is no angle", "name one that turns")

    @property
    def _rest(self) -> tuple[SteadySystem, Linear]:
        """The system at rest, and its small motions under the drive."""
        state = steady(self.commanded(None), Drive())
        local, inputs = state.local, state.local.inputs
        if self.free:
            return state, state.linear._replace(inputs=np.equal(state.names, self.coordinate)[:, None].astype(float))
        moved = np.array(inputs.prescribed)
        moved[2, self.system.tree.fixed.index(self.system.coordinates.index(self.coordinate))] += 1.0
        faster = replace(inputs, prescribed=moved)
        left = local.tree(local.y, local.yd, local.ydd, inputs) - local.tree(local.y, local.yd, local.ydd, faster)
        return state, state.linear._replace(inputs=left[:, None])

    @property
    def inertia(self) -> float:
        """Inertia that the effort turns where nothing vibrates, kg m²: of the motions that no spring holds."""
        m, c, k, force = self._rest[1]
        square, modes = symmetric_modes(symmetric(k), symmetric(m))
        rigid = modes[:, square <= RIGID**2 * square[-1]]
        moved = force[:, 0] @ rigid
        if not np.abs(moved).max(initial=0.0) > 0:
            raise InputError("joint", f"is {self.coordinate!r}, which a spring holds", "leave the spring out")
        if np.abs(rigid.T @ c @ rigid).max() > HELD * np.abs(c).max(initial=1e-300):
            fix = "leave out damping and friction of what is driven"
            raise InputError("joint", f"is {self.coordinate!r}, whose motion a damper brakes", fix)
        return float(1 / (moved @ moved))

    @property
    def small(self) -> SmallMotions:
        """Small motions about rest."""
        (state, linear), (beam, station) = self._rest, self._beam
        tip, first = np.zeros((3, len(linear.mass))), state.names.index(f"{self.point.partition('.')[0]}.q1")
        tip[:, first : first + beam.size] = np.asarray(beam.station_places.first[station])
        a, b, c, _ = linear.state_space(tip, 0 * tip, 0 * tip, np.zeros((3, 1)))
        return SmallMotions(a, b[:, 0], c)

    def commanded(self, profile: Profile | None) -> System:
        """The system under a command; at rest without."""
        name, _, coordinate = self.coordinate.rpartition(".")
        joint = self.system.joints[name]
        others = joint.efforts if self.free else joint.rates
        command = {**others, coordinate: 0.0 if profile is None else profile}
        joint = replace(joint, effort=command) if self.free else replace(joint, rate=command)
        return replace(self.system, joints={**self.system.joints, name: joint})

    def run(self, profile: Profile, settings: ResponseSettings, name: str = "") -> Ran:
        """Run a command."""
        of = simulate_system(self.commanded(profile), None, settings, name)
        return self._ran(of.time, of.q, settings, of.outcome, of.message, of.step)

    def _ran(self, time: Floats, q: Floats, settings: ResponseSettings, outcome: str, message: str, step: float) -> Ran:
        """A run by all coordinates (t, n)."""
        tip = np.asarray(deflection(self.system, self.point, q))
        left = float(np.linalg.norm(half_ranges(time, tip, settings.residual_from or 0.0)))
        return Ran(time, tip, outcome, message, left, step)

    def about(
        self, profile: Profile, settings: ResponseSettings, pairs: Sequence[Pair], width: float
    ) -> tuple[Ran, Iterator[tuple[Ran, Ran]]]:
        """A run of given steps, and those of pairs of commands that differ by a width, along its exact derivatives."""
        assert settings.step is not None
        system, scheme = self.commanded(profile), scheme_of(settings)
        tree, k = system.tree, system.coordinates.index(self.coordinate)
        point = started(system, None, settings.start, settings.begin.state)
        equations = NonlinearEquations(tree, system.inputs)
        count = round(settings.duration / settings.step)
        end = settings.start + settings.duration
        corners = Corners.of(system.corners(settings.step), equations.drive, settings.start, end)
        grid = fitted(settings.start, settings.duration / count, count, corners.felt_by(scheme))
        # With the ends of the parts of split steps, too.
        steps = replace(grid, kept=np.ones(len(grid), dtype=bool))
        run = through(equations, scheme, point.y, point.yd, steps)

        commanded = [[self.commanded(each) for each in pair] for pair in pairs]

        def command(of: System, time: Floats) -> Floats:
            """The effort (t, 1), or angle, rate and acceleration (t, 3)."""
            inputs = of.inputs(time)
            if self.free:
                return np.asarray(inputs.efforts)[:, [k]]
            return np.asarray(inputs.prescribed)[..., tree.fixed.index(k)]

        def linear(time: Floats, q: Floats, qd: Floats) -> tuple[Floats, Floats, Floats, Floats]:
            inputs = system.inputs(time)
            qdd = accelerations(tree, q, qd, inputs)
            stiffness, damping, mass = slopes(tree, q, qd, qdd, inputs)
            if self.free:
                driven = -np.broadcast_to(np.equal(tree.free, k).astype(float)[:, None], (len(time), len(tree.free), 1))
            else:
                driven = np.empty((len(time), len(tree.free), 3))
                for j in range(3):
                    moved = np.array(inputs.prescribed, dtype=complex)
                    moved[:, j, tree.fixed.index(k)] += 1j * STEP
                    left = tree(q + 0j, qd + 0j, qdd + 0j, replace(inputs, prescribed=moved))
                    driven[..., j] = left.imag / STEP
            changed = np.stack([command(more, time) - command(less, time) for less, more in commanded], axis=-1) / width
            return mass, damping, stiffness, -driven @ changed

        still = np.zeros((len(tree.free), len(pairs)))
        changes = tangent(linear, scheme, steps, run, still, still)[0]
        kept = np.append(0, 1 + np.flatnonzero(grid.kept))

        def moved(by: Floats | float) -> Ran:
            q = np.zeros((len(kept), tree.size))
            q[:, tree.free] = run.q[kept] + by
            return self._ran(run.time[kept], q, settings, "done", "", settings.step or np.nan)

        halves = (width / 2 * changes[kept, :, j] for j in range(len(pairs)))
        return moved(0.0), ((moved(-half), moved(half)) for half in halves)


Plant = OnHub | OnJoint
