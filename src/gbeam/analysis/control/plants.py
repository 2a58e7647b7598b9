"""Plants of shaped commands: joints of systems, the hinge of a hub with its beam among them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from gbeam.analysis.response.peaks import half_ranges
from gbeam.analysis.response.posed import pose, prepared
from gbeam.analysis.response.settings import ResponseSettings
from gbeam.analysis.response.simulation import simulate
from gbeam.analysis.response.stepping import scheme_of
from gbeam.analysis.system.drive import Drive
from gbeam.analysis.system.histories import deflection
from gbeam.analysis.system.rest import steady_state
from gbeam.analysis.system.steady import SteadySystem
from gbeam.arrays.types import Floats
from gbeam.errors import ComputationError, InputError
from gbeam.guards.checks import choice
from gbeam.integrate.driver import integrate_steps
from gbeam.integrate.equations import accelerations, slopes
from gbeam.integrate.tangent import tangent
from gbeam.mechanics.tree.body_terms import stations_of
from gbeam.mechanics.tree.joints import SLIDES
from gbeam.mechanics.tree.one_body import HINGE, hub_system
from gbeam.mechanics.tree.system import System
from gbeam.motion.hub import Hub
from gbeam.motion.profiles.profile import Profile
from gbeam.numerics.eigen import RIGID, Linear, symmetric, symmetric_modes
from gbeam.numerics.series import STEP
from gbeam.progress import Progress

Pair = tuple[Profile, Profile]
Share = Callable[[float], None]  # told the share of a computation that is done
_SAG, _LEAST = 1e-6, 1e-6  # of the largest deflection, and m: a smaller change of the sag on the way is none
_ASIDE = 1e-4  # m or rad: a joint that begins so near to its place of rest hardly swings
_PLACES = (0.0, 0.19, 0.37, 0.61, 0.83, 1.0)  # shares of the way at which the sag is looked at
_BENT = "bends the beam otherwise as it moves, which no command undoes", "leave it out, or let it be along the axis"
BRAKING = 1e-9  # of the largest damping: a rigid motion with less is not braked


@dataclass(frozen=True)
class Goal:
    """Angle to turn, rad, or rate to reach, rad/s (if it slides m and m/s), and the time for it, s."""

    value: float
    to_rate: bool
    duration: float


# Words for a command and for the quantity that is limited, by two flags: an effort drives; the coordinate slides.
DRIVES = {
    (True, False): ("torque", "torque"),
    (True, True): ("force", "force"),
    (False, False): ("rate", "angular acceleration"),
    (False, True): ("speed", "acceleration"),
}


class Ran(NamedTuple):
    """Displacement (t, 3) m of the point under a command, residual vibration, m, step, s, driven coordinate and
    rate.
    """

    time: Floats
    tip: Floats
    outcome: str
    message: str
    residual: float
    step: float
    driven: tuple[Floats, Floats] | None = None


class SmallMotions(NamedTuple):
    """Linear model about rest: state matrix (n, n), column (n,) of the drive, and rows (3, n) of the tip."""

    a: Floats
    column: Floats
    tip: Floats


def movable(system: System) -> list[str]:
    """Names of the coordinates of joints that a command may drive: all but Euler parameters."""
    names = (f"{name}.{kind}" for name, joint in system.joints.items() for kind in joint.coordinates)
    return [name for name in names if not name.rpartition(".")[2].startswith("e")]


@dataclass(frozen=True)
class Plant:
    """A system on the ground, driven by the rate of a joint's coordinate if it has one, else by the effort on it."""

    system: System
    coordinate: str
    point: str  # whose vibration is made least

    @staticmethod
    def from_hub(system: System, hub: Hub, point: str | None) -> Plant:
        """Make the plant of a hub that carries the only body, whose tip is to rest. InputError if the body is rigid,
        the hub turns already, or there are other bodies.
        """
        body = system.only_structure
        if body is None:
            raise InputError("hub", "is a hub, and carries a system", 'name what moves, such as "joint.angle"')
        if point is not None:
            fix = "leave it out: the tip of the only body is to rest"
            raise InputError("point", f"is {point!r}, and the hub carries {system.order[0]}", fix)
        body.require_coordinates()
        body.require_free_tip("a command")
        if not hub.free and float(np.abs(hub.base(np.zeros(1)).w_WB_B).max()) > 0:
            raise InputError("rate", "is not zero: the hub turns already", "leave it out")
        return Plant(hub_system(body, hub, system.order[0]), f"{HINGE}.angle", f"{system.order[0]}.tip")

    @staticmethod
    def from_coordinate(system: System, coordinate: str, point: str | None) -> Plant:
        """Make the plant of a system's coordinate. If no point is named, it is the tip of the only flexible body."""
        if not movable(system):
            problem = f"is {coordinate!r}, and no joint moves {', '.join(system.order)}"
            raise InputError("hub", problem, "give a Hub, which carries a body alone")
        choice("joint", coordinate, movable(system))
        tips = [f"{name}.tip" for name in system.flexible]
        if point is None and len(tips) != 1:
            fix = f"choose from {', '.join(tips or system.points)}"
            raise InputError("point", "is missing: it says whose vibration is made least", fix)
        chosen = tips[0] if point is None else point
        system.point("point", chosen)
        return Plant(system, coordinate, chosen)

    @property
    def kind(self) -> str:
        """Kind of the model of the point's body; "system" if that is rigid."""
        body = self.system.flexible.get(self.point.partition(".")[0])
        return "system" if body is None else body.kind

    @property
    def slides(self) -> bool:
        """True if the driven coordinate is a displacement."""
        return self.coordinate.rpartition(".")[2] in SLIDES

    @property
    def free(self) -> bool:
        """True if the drive is an effort."""
        rates = {f"{name}.{kind}" for name, joint in self.system.joints.items() for kind in joint.rates}
        return self.coordinate not in rates

    def refuse_moving(self, goal: Goal) -> None:
        """Raise InputError unless the system rests without a command, with the same sag all the way."""
        if np.abs(self.system.start[1]).max(initial=0.0) > 0:
            raise InputError("initial_rate", "is not zero: the system moves already", "leave it out")
        if self.system.controllers:
            problem = "act besides the command, whose small motions know nothing of them"
            raise InputError("controllers", problem, "shape the command of the system without them")
        if goal.to_rate and self._deflection(self.system.start[0][None]) is None:
            fix = "name a point of a flexible body, or give no rate"
            raise InputError("point", f"is {self.point!r}, which goes on at the rate that is reached", fix)
        rest = self._resting_state(0.0)
        start = dict(zip(rest.system.coordinates, rest.system.start[0], strict=True))
        for name, value in zip(rest.names, rest.local.y, strict=True):
            joint, _, kind = name.rpartition(".")
            if joint in self.system.joints and abs(value - start.get(name, value)) > _ASIDE:
                problem = f"is {start[name]:.4g}, and it rests at {round(value, 12) + 0.0:.6g}"
                raise InputError(f"joints.{joint}.initial.{kind}", problem, "let it begin there")
        if self.system.gravity is not None and np.any(np.asarray(self.system.gravity)):
            way = goal.value * goal.duration / 2 if goal.to_rate else goal.value
            sags = [self._resting_state(share * way).local.y for share in _PLACES]
            if np.ptp(sags, axis=0).max(initial=0.0) > _SAG * max(np.abs(sags).max(initial=0.0), _LEAST):
                raise InputError("gravity", *_BENT)

    def _resting_state(self, moved: float) -> SteadySystem:
        """Find the system at rest with the driven coordinate held at its start plus `moved`, rad or m."""
        name, _, coordinate = self.coordinate.rpartition(".")
        joint = self.system.joints[name]
        initial = {key: value + moved * (key == coordinate) for key, value in joint.start_values.items()}
        efforts = {key: effort for key, effort in joint.efforts.items() if key != coordinate}
        moves: dict[str, Any] = {"initial": initial, "rate": {**joint.rates, coordinate: 0.0}, "effort": efforts}
        fixed_joint = replace(joint, **moves)
        return steady_state(replace(self.system, joints={**self.system.joints, name: fixed_joint}), Drive())

    def _deflection(self, q: Floats) -> Floats | None:
        """Displacement (t, 3) m of the point relative to its body's root, by all coordinates (t, n),
        or None if rigid.
        """
        moved = deflection(self.system, self.point, q)
        return None if moved is None else np.asarray(moved)

    @cached_property
    def _rest(self) -> tuple[SteadySystem, Linear]:
        """The system at rest, and the linear equations of its small motions under a unit drive."""
        state = steady_state(self.commanded(None), Drive())
        local, inputs = state.local, state.local.inputs
        if self.free:
            return state, state.linear._replace(inputs=np.equal(state.names, self.coordinate)[:, None].astype(float))
        prescribed = np.array(inputs.prescribed)
        prescribed[2, self.system.tree.fixed.index(self.system.coordinates.index(self.coordinate))] += 1.0
        faster = replace(inputs, prescribed=prescribed)  # by a unit acceleration of the driven coordinate
        force = local.tree(local.y, local.yd, local.ydd, inputs) - local.tree(local.y, local.yd, local.ydd, faster)
        return state, state.linear._replace(inputs=force[:, None])

    @property
    def inertia(self) -> float:
        """Inertia, kg m² or kg, that the effort moves as a rigid body; InputError if that motion is held or braked."""
        state, (m, c, k, force) = self._rest
        square, modes = symmetric_modes(symmetric(k), symmetric(m))
        rigid = modes[:, square <= RIGID**2 * square[-1]]
        shares = force[:, 0] @ rigid
        if not np.abs(shares).max(initial=0.0) > 0:
            raise InputError("joint", f"is {self.coordinate!r}, which a spring or gravity holds", "give it a rate")
        rubs = np.abs(rigid[np.isin(state.names, self.system.rubbing)]).max(initial=0.0) > BRAKING * np.abs(rigid).max()
        if rubs or np.abs(rigid.T @ c @ rigid).max() > BRAKING * np.abs(c).max(initial=1e-300):
            fix = "leave out damping and friction of what is driven"
            raise InputError("joint", f"is {self.coordinate!r}, whose motion friction or a damper brakes", fix)
        return float(1 / (shares @ shares))  # modes have unit mass

    @property
    def small(self) -> SmallMotions:
        """Linear model of the system about rest, with the column of a unit effort or acceleration."""
        state, linear = self._rest
        name, point_index = self.system.point("point", self.point)
        tip = np.zeros((3, len(linear.mass)))
        if self._deflection(self.system.start[0][None]) is None:
            tip = state.slopes_of_points[self.system.points.index(self.point)]
        else:
            body = self.system.flexible[name]
            first, station = state.names.index(f"{name}.q1"), list(stations_of(body).values())[point_index]
            tip[:, first : first + body.size] = np.asarray(body.station_places.first[station])
        a, b, c, _ = linear.state_space(tip, 0 * tip, 0 * tip, np.zeros((3, 1)))
        return SmallMotions(a, b[:, 0], c)

    def commanded(self, profile: Profile | None) -> System:
        """The system with a command as the effort or rate of the coordinate, or zero without one."""
        name, _, coordinate = self.coordinate.rpartition(".")
        joint = self.system.joints[name]
        other_commands = joint.efforts if self.free else joint.rates
        command: Any = {**other_commands, coordinate: 0.0 if profile is None else profile}
        joint = replace(joint, **{"effort" if self.free else "rate": command})
        return replace(self.system, joints={**self.system.joints, name: joint})

    def run(self, profile: Profile, settings: ResponseSettings, name: str = "", progress: Progress = None) -> Ran:
        """Simulate the system under a command."""
        system = self.commanded(profile)
        run = simulate(system, None, settings, name=name, progress=progress)
        k = system.coordinates.index(self.coordinate)
        driven = run.q[:, k] - run.q[0, k], run.qd[:, k]
        tip, residual = self._tip(system, run.time, run.q, settings)
        return Ran(run.time, tip, run.outcome, run.message, residual, run.step, driven)

    def _tip(self, system: System, time: Floats, q: Floats, settings: ResponseSettings) -> tuple[Floats, float]:
        """Displacement (t, 3) m, or place if rigid, of the point by all coordinates (t, n); residual vibration, m."""
        tip = self._deflection(q)
        if tip is None:
            y, k = q[:, system.tree.unknowns], system.points.index(self.point)
            tip = np.asarray(system.tree.motion(y, 0 * y, 0 * y, system.inputs(time)).every_point[k].p)
        return tip, float(np.linalg.norm(half_ranges(time, tip, settings.residual_from or 0.0)))

    def perturbed_runs(
        self, profile: Profile, settings: ResponseSettings, pairs: Sequence[Pair], width: float, share: Share
    ) -> tuple[Ran, Iterator[tuple[Ran, Ran]]]:
        """Run a command by given steps, and iterate over pairs of runs of commands that differ by a `width`.

        The pairs follow from exact derivatives of the run.
        """
        assert settings.step is not None
        system, scheme = self.commanded(profile), scheme_of(settings)
        tree, k = system.tree, system.coordinates.index(self.coordinate)
        result_step = settings.duration / round(settings.duration / settings.step)
        posed = pose(prepared(system, None, settings), settings, result_step)
        grid = posed.steps(result_step)
        # Derivatives need the states at all ends of split steps, too.
        steps = replace(grid, kept=np.ones(len(grid), dtype=bool))
        run = integrate_steps(posed.equations, scheme, posed.start.y, posed.start.yd, steps)
        if len(run.q) <= len(steps):
            raise ComputationError("diverged", f"the run of a command ends at {run.time[-1]:.4g} s, before its time")

        def command(profile: Profile, time: Floats) -> Floats:
            """The effort (t, 1), or angle, rate and acceleration (t, 3)."""
            if self.free:
                return np.asarray(profile(time))[:, None]
            return np.stack([Hub(radius=0.0, rate=profile).angle(time), *profile.derivatives(time)], axis=-1)

        def linear(time: Floats, q: Floats, qd: Floats) -> tuple[Floats, Floats, Floats, Floats]:
            """M, C, K (t, n, n) about states, and forces (t, n, p) by unit differences of each pair."""
            share(float(time[0] - settings.start) / settings.duration)
            inputs = system.inputs(time)
            qdd = accelerations(tree, q, qd, inputs)
            stiffness, damping, mass = slopes(tree, q, qd, qdd, inputs)
            if self.free:
                slope = -np.broadcast_to(
                    np.equal(tree.unknowns, k).astype(float)[:, None], (len(time), len(tree.unknowns), 1)
                )
            else:
                slope = np.empty((len(time), len(tree.unknowns), 3))
                for j in range(3):
                    prescribed = np.array(inputs.prescribed, dtype=complex)
                    prescribed[:, j, tree.fixed.index(k)] += 1j * STEP
                    residual = tree(q + 0j, qd + 0j, qdd + 0j, replace(inputs, prescribed=prescribed))
                    slope[..., j] = residual.imag / STEP
            changes = [command(after, time) - command(before, time) for before, after in pairs]
            changed = np.stack(changes, axis=-1) / width
            return mass, damping, stiffness, -slope @ changed

        ends = np.append(0, 1 + np.flatnonzero(grid.kept))

        def read(change: Floats | float) -> Ran:
            """Read the run with a change added to its unknown coordinates."""
            q = np.zeros((len(ends), tree.size))
            q[:, tree.unknowns] = run.q[ends] + change
            tip, residual = self._tip(system, run.time[ends], q, settings)
            return Ran(run.time[ends], tip, "done", "", residual, settings.step or np.nan)

        def varied() -> Iterator[tuple[Ran, Ran]]:
            """Yield the runs of each pair, half a `width` before and behind this one."""
            zeros = np.zeros((len(tree.unknowns), len(pairs)))
            changes = tangent(linear, scheme, steps, run, zeros, zeros, accelerations=False)[0]
            for change in np.moveaxis(width / 2 * changes[ends], -1, 0):
                yield read(-change), read(change)

        return read(0.0), varied()
