"""Steady states of a system: its joints rest, or one of them, or the ground, turns at a constant rate."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from gbeam.analysis.system.initial import Initial
from gbeam.analysis.system.point import (
    NEAR,
    NONE,
    Point,
    adrift,
    bends_back,
    followed,
    refuse_massless,
    relaxed,
    rested,
    rested_together,
    started,
)
from gbeam.analysis.system.solution import Solution
from gbeam.arrays.tree import each_leaf
from gbeam.arrays.types import Complex, Flags, Floats
from gbeam.constants import BY_STRAINS
from gbeam.errors import ComputationError, InputError
from gbeam.mechanics.plausibility import elastic_bend
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.bodies import momentum
from gbeam.mechanics.tree.equations import Inputs, Tree
from gbeam.mechanics.tree.frames import Frame, turned_back
from gbeam.mechanics.tree.joints import SLIDES, SPIN
from gbeam.mechanics.tree.linear import is_linear
from gbeam.mechanics.tree.signal_names import deforming, local_names, unit_of_effort
from gbeam.mechanics.tree.steps import turned_on
from gbeam.mechanics.tree.system import ROOT, System
from gbeam.motion.hub import Hub
from gbeam.motion.protocol import Motion
from gbeam.numerics.balance import balanced, carried, following
from gbeam.numerics.eigen import (
    RIGID,
    Linear,
    Steady,
    positive_definite,
    stability_margin,
    symmetric,
    symmetric_modes,
    unsymmetric,
)
from gbeam.numerics.series import STEP
from gbeam.numerics.whirl import QUARTERS, Whirl, whirl_of
from gbeam.results.errors import Accelerated
from gbeam.results.parts import Base

MASSLESS = "no positive mass"  # an outcome
PREDICTED = 1e-3  # of the coordinates: a state so near to where those of lower drives lead has not left their path
SLIGHT = 1e-6  # of the loads, by which their stiffness is looked at
SAME, STILL = 1e-6, 1e-9  # of modes' matrices, and m or rad: what changes with the angle changes by more
CORRECTIONS, CLOSE = 50, 1e-12  # of joints beside bodies that are held: their number, and m or rad
TURNS = (0.7, 2.1, 4.4)  # rad, at which the equations are looked at


@dataclass(frozen=True)
class Drive:
    """Drives of a system in a steady state: profiles and motion of the ground at a time, or a frozen motion `base` of
    the ground, beside gravity; forces and loads times a factor; a coordinate, or the hub below where none is named,
    turns at a rate rad/s that changes by `faster` rad/s², and has turned by an angle.
    """

    motion: Motion | None = None
    time: float = 0.0
    coordinate: str = ""
    rate: float | None = None
    turn: float = 0.0
    factor: float = 1.0
    base: Base | None = None
    faster: float = 0.0

    def inputs(self, system: System) -> Inputs:
        """Inputs of a system's tree; a coordinate that turns without being prescribed is added as the last of these."""
        hub_turns = isinstance(self.motion, Hub) and self.rate is not None and not self.coordinate
        inputs, base = system.inputs(np.asarray(float(self.time)), None if hub_turns else self.motion), self.base
        if hub_turns:
            base = self.motion.mount.base(*(np.asarray(float(each)) for each in (self.turn, self.rate, 0.0)))  # type: ignore[union-attr, arg-type]
        if base is not None:
            ground = inputs.ground
            a = base.a_WO_B if hub_turns else base.a_WO_B + ground.a
            inputs = replace(inputs, ground=replace(ground, w=base.w_WB_B, a=a, alpha=base.alpha_WB_B))
        if self.factor != 1.0:
            loads = tuple(None if each is None else self.factor * each for each in inputs.loads)
            wrenches = None if inputs.wrenches is None else self.factor * inputs.wrenches
            inputs = replace(inputs, loads=loads, wrenches=wrenches)
        prescribed = np.zeros((3, 0)) if inputs.prescribed is None else np.array(inputs.prescribed)
        if self.coordinate and self.rate is not None:
            k = system.coordinates.index(self.coordinate)
            if k not in system.tree.fixed:
                prescribed = np.append(prescribed, [[system.start[0][k]], [0.0], [0.0]], axis=1)
            column = system.tree.fixed.index(k) if k in system.tree.fixed else -1
            prescribed[1:, column] = self.rate, self.faster
        if self.turn:
            # All prescribed coordinates go on for as long as the fastest one takes to turn so far.
            fastest = np.abs(np.append(prescribed[1], self.rate or 0.0)).max()
            before = prescribed.copy()
            prescribed[0] += prescribed[1] * self.turn / fastest
            for column, k in enumerate(system.tree.fixed):
                if system.coordinates[k].endswith(".e0"):  # the first of four Euler parameters
                    euler = slice(column, column + 4)
                    prescribed[:, euler] = turned_on(before[:, euler], self.turn / fastest)
        return replace(inputs, prescribed=prescribed if prescribed.size else None)


def bent_most(system: System, names: Sequence[str], q: Floats) -> tuple[str, float]:
    """Name of the second-order body that moves most over its size at coordinates (k, n), and that ratio."""
    bent = {"a body": 0.0}
    for name, body in system.flexible.items():
        if body.kind not in BY_STRAINS:
            moved, size = body.displacement(q[:, deforming(names, name)]), np.abs(body.station_places.r0).max()
            bent[name] = float(np.abs(moved).max()) / max(float(size), 1e-300)
    most = max(bent, key=lambda name: bent[name])
    return most, bent[most]


def massless(system: System, names: Sequence[str], q: Floats) -> str:
    """Say which body is bent so far at coordinates (n,) that its model leaves a motion without kinetic energy."""
    most, _ = bent_most(system, names, q[None])
    exact = "give it the exact model, or " if getattr(system.bodies.get(most), "field", None) is not None else ""
    fix = f"{exact}load it less, or put the mass of what holds it, a hub or a bearing, on its joint as a rigid body"
    return f"bent so far, the model of {most} has no positive mass: {fix}"


@dataclass(frozen=True, eq=False)
class SteadySystem(Steady):
    """A system in a steady state, and small departures from it."""

    system: System
    drive: Drive
    point: Point
    known: tuple[Floats, ...] | None = None  # K, C and M, where they have been found
    begins: bool = False  # True of a state of motion, at the start
    stuck: tuple[str, ...] = ()  # sentences on joints that friction holds
    first = 0

    @property
    def of(self) -> System:
        """The system."""
        return self.system

    @property
    def zero(self) -> float:  # type: ignore[override]
        """Share of the largest eigenvalue below which one is of a motion that nothing holds; bodies hold themselves."""
        size = sum(link.body.size for link in self.point.tree.links)
        return 0.0 if len(self.point.tree.free) == size else RIGID

    @property
    def base(self) -> Base | None:
        """Motion of the ground; None where it rests."""
        if self.drive.motion is None and self.drive.base is None:
            return None
        ground = self.local.inputs.ground
        return Base(*(np.asarray(each, dtype=float) for each in (ground.a, ground.w, ground.alpha)))

    def base_of(self, body: str) -> Base:
        """Motion of the root of a body, (3,)."""
        local = self.local
        root = local.tree.motion(local.y, local.yd, local.ydd, local.inputs).roots[self.system.order.index(body)]
        return Base(root.a, root.w, root.alpha)

    @property
    def solution(self) -> Solution:
        """The state, as a solution of one time, what turns free as in the system."""
        point = _released(self, held=False).point
        return Solution(self.system, point.standing(), point.driven)

    def bent(self, bodies: Mapping[str, Structure]) -> float:
        """Largest displacement of a station of some of the bodies from its place at rest, over the body's length."""
        q = {name: self.local.y[deforming(self.names, name)] for name in bodies}
        moved = (np.abs(body.displacement(q[name])).max() / body.length for name, body in bodies.items())
        return float(max(moved, default=0.0))

    def standing(self, of: System) -> Solution:
        """Solution, of one time, of another system in such a state, what turns free as in that system."""
        drive, state = self.drive, self if of is self.system else self.richer(of)
        if drive.coordinate and self.system.coordinates.index(drive.coordinate) not in self.system.tree.fixed:
            drive = replace(drive, coordinate="", rate=None)
        point = _released(state, held=False).point

        def inputs(system: System, _: Any) -> Inputs:
            return each_leaf(lambda leaf: leaf[None], drive.inputs(system))

        return Solution(of, point.standing(drive.time), inputs)

    @property
    def bend(self) -> float:
        solution = self.solution
        bases = solution.bases(self.system.flexible)
        elastic = (elastic_bend(body, bases[name]) for name, body in self.system.flexible.items() if body.size)
        return max((*solution.bends.values(), *elastic), default=0.0)

    @cached_property
    def stable(self) -> bool:
        """True if it would stay there: see :func:`stability_margin`. Angular accelerations bring a skew stiffness, half
        the rate of the gyroscopic coupling, which feeds no energy and is left out.
        """
        m, c, k, _ = self.linear
        if not len(m):
            return True  # nothing moves
        if unsymmetric(k):
            inputs = self.local.inputs
            ground, prescribed = inputs.ground, inputs.prescribed
            even = replace(ground, alpha=0 * ground.alpha)
            prescribed = None if prescribed is None else prescribed * [[1.0], [1.0], [0.0]]
            without = replace(self.local, inputs=replace(inputs, ground=even, prescribed=prescribed)).slopes()[1]
            brought = self.local.slopes()[1] - without
            k = k - (brought - brought.T) / 2
        return stability_margin(m, c, k, self.zero**2) > 0

    @property
    def warnings(self) -> tuple[str, ...]:
        """Doubts about the bodies' models, and what they leave out in this state."""
        return self.stuck + self.system.warnings + self.solution.left_out + self._held_spin + self._spun_up

    @property
    def _held_spin(self) -> tuple[str, ...]:
        """Warning of joints that turn freely at the start and rest in this state."""
        tree, names = self.local.tree, self.names
        rates = self.system.tree.local(*self.system.start, 0 * self.system.start[0])[2][tree.free]
        if self.point.yd.any() or not rates.any():
            return ()
        k, _, m = self.local.slopes()[1:]
        (stiffness,) = carried(m, self.adrift, k)
        stiffness[:, self.adrift] = 0.0
        size = np.abs(stiffness).max(axis=0)
        unsprung = size <= STILL * size.max() if stiffness.any() else np.ones(len(m), dtype=bool)
        goes_on = (name.rpartition(".") for name, on in zip(names, unsprung & (rates != 0), strict=True) if on)
        turning = dict.fromkeys(joint for joint, _, kind in goes_on if kind not in SLIDES)
        words = f'{" and ".join(turning)} did not turn, as at the start: gb.linearize(at="start") is about that motion'
        return (f"as if {words}",) if turning else ()

    @property
    def _spun_up(self) -> tuple[str, ...]:
        """Warnings of joints with an angular acceleration: the moment that turns them, and the time to turn by 1°."""
        if self.point.yd.any():
            return ()
        warnings, tree, names = [], self.local.tree, self.names
        turns = [each for each in tree.turning if self.local.ydd[each].any() and self.adrift[each].all()]
        mass = self.local.slopes()[3] if turns else np.zeros((0, 0))
        for turn in turns:
            alpha, slides = self.local.ydd[turn], tree.sliding & self.adrift
            moment = carried(mass, slides, mass)[0][turn][:, turn] @ alpha
            size, rate = np.linalg.norm(moment), np.linalg.norm(alpha)
            axis = ", ".join(f"{each + 0.0:.3g}" for each in np.round(moment / size, 3))
            joint = names[int(np.flatnonzero(turn)[0])].rpartition(".")[0]
            where = f"({axis}) of {self.system.joints[joint].body}.root" if len(moment) == 3 else "its axis"
            warnings.append(
                f"{joint} begins to turn ever faster: {size:.4g} N m about {where} accelerate it by {rate:.4g} rad/s², "
                f"and this is the state at that instant, which lasts while it has hardly turned: by 1° in "
                f"{np.sqrt(2 * np.deg2rad(1) / rate):.3g} s"
            )
        return tuple(warnings)

    @property
    def q(self) -> Floats:
        """Local coordinates, (n,)."""
        return self.local.y

    @cached_property
    def local(self) -> Point:
        """The point with as many coordinates as degrees of freedom."""
        return self.point.local

    @cached_property
    def linear(self) -> Linear:
        """M, C and K of small departures; a ComputationError where a body's model has no positive mass."""
        k, c, m = self.known or self.local.slopes()[1:]
        if not positive_definite(m):
            raise ComputationError(MASSLESS, massless(self.system, self.names, self.local.y))
        if self.point.minimal:  # of others mass is looked at where they rest
            refuse_massless(self.system, self.point, m)
        for name, body in self.system.flexible.items():
            if (bending := body.coefficients.bending) is not None:
                columns = deforming(self.names, name)
                q, k = self.local.y[columns], np.array(k)
                k[np.ix_(columns, columns)] += bending.stiffness(q) - bending.slope(q)
        return Linear(m, c, k - m @ self.follows, np.zeros((len(m), 0)))

    @cached_property
    def adrift(self) -> Flags:
        """Flags of the local coordinates that nothing holds, so that forces accelerate them."""
        # Rotations stand for the last three of four Euler parameters.
        kept = [not self.system.coordinates[k].endswith(".e0") for k in self.point.tree.free]
        left, *slope = self.point.slopes()
        return adrift(self.point, left, slope)[kept]

    @cached_property
    def follows(self) -> Floats:
        """Minus the derivatives (n, n) of the accelerations ÿ with respect to y: the axis of an angular acceleration
        turns with the body.
        """
        slope = np.zeros((len(self.local.y), len(self.local.y)))
        for turn in self.local.tree.turning if not self.point.yd.any() else ():
            if self.local.ydd[turn].any() and self.adrift[turn].all():
                slope[np.ix_(turn, turn)] = following(self.local.ydd[turn])
        return slope

    @property
    def coordinates(self) -> Floats:
        """All coordinates (n,)."""
        whole = np.array(self.system.start[0])
        whole[self.point.tree.free] = self.point.y
        return whole

    @property
    def grows(self) -> bool:
        """True if a small departure grows; False where that is not known."""
        with suppress(ComputationError):
            return len(self.moving.growing) > 0
        return False

    def moved(self, start: Floats) -> float:
        """Largest distance of a joint's coordinate, m or rad, from coordinates `start` (n,)."""
        joints = [".q" not in name for name in self.system.coordinates]
        return float(np.abs((self.coordinates - start)[joints]).max(initial=0.0))

    @property
    def names(self) -> list[str]:
        """Names of the local coordinates: those of the system, Euler parameters but for the first one as rotations."""
        local = local_names(self.system.coordinates)
        return [local[k] for k in self.local.tree.free]

    @property
    def accelerated(self) -> tuple[Accelerated, ...]:
        """Coordinates that are accelerated evenly; none where others are accelerated too."""
        ydd, slides = self.local.ydd, self.local.tree.sliding
        if ydd[~slides].any() and (self.point.yd.any() or ydd[~(slides | self.adrift)].any()):
            return ()
        columns = zip(self.names, ydd.tolist(), slides, strict=True)
        return tuple(
            Accelerated(name, size) if slide else Accelerated(name, angular_acceleration=size)
            for name, size, slide in columns
            if abs(size) > NONE
        )

    @property
    def frames(self) -> list[Frame]:
        """Motions of all points."""
        return self.local.tree.motion(self.local.y, self.local.yd, self.local.ydd, self.local.inputs).every_point

    @cached_property
    def slopes_of_frames(self) -> tuple[Floats, Floats]:
        """Derivatives of the places of all points and of their rotations, ground's axes, with respect to the
        coordinates, (p, 3, n) each, by a complex step.
        """
        n = len(self.local.y)
        moved = self.local.y + 1j * STEP * np.eye(n)
        frames = self.local.tree.motion(moved, 0 * moved, 0 * moved, self.local.inputs).every_point
        rotations = [np.broadcast_to(frame.R, (n, 3, 3)) for frame in frames]
        skew = np.stack([R.imag @ np.swapaxes(R.real, -1, -2) / STEP for R in rotations])
        turns = np.stack([skew[..., 2, 1], skew[..., 0, 2], skew[..., 1, 0]], axis=1)
        return np.stack([frame.p.imag.T / STEP for frame in frames]), turns

    @property
    def whirl(self) -> Whirl | None:
        """Its points, of rigid bodies the roots, as they turn in the ground frame; None where nothing turns."""
        ground, prescribed = self.local.inputs.ground, self.local.inputs.prescribed
        driven = self.drive.rate if self.drive.coordinate else None
        rates = np.append(0.0 if prescribed is None else prescribed[1], driven or 0.0)
        rate = float(np.abs(rates).max())
        of_points = ((body, point) for body in self.system.order for point in self.system.points_of(body))
        kept = [k for k, (body, point) in enumerate(of_points) if body in self.system.flexible or point == ROOT]
        angles = QUARTERS if rate > STILL else np.zeros(1)
        states = [replace(self, point=self._turned(angle), known=None) if angle else self for angle in angles]
        places = np.array([[frame.p for frame in state.frames] for state in states])[:, kept]
        slopes = np.array([np.concatenate(state.slopes_of_frames, axis=1) for state in states])[:, kept]
        return whirl_of(places, slopes, rate, np.asarray(ground.w), np.asarray(ground.a))

    @property
    def slopes_of_points(self) -> Floats:
        """Derivatives of the places of all points with respect to the coordinates, (p, 3, n)."""
        return self.slopes_of_frames[0]

    def shares(self, modes: Complex) -> Floats:
        """Shares (k, bodies) of the bodies in the kinetic energy of modes (n, k), without that of the steady state."""
        tree, inputs = self.local.tree, self.local.inputs
        still = Frame(*(np.eye(3) if k == 0 else np.zeros(3) for k in range(6)))
        prescribed = inputs.prescribed
        at_rest = replace(
            inputs, ground=still, prescribed=None if prescribed is None else prescribed * [[1.0], [0.0], [0.0]]
        )
        energies = np.zeros((modes.shape[1], len(tree.links)))
        for rates in (modes.real.T, modes.imag.T):
            state = tree.motion(np.broadcast_to(self.local.y, rates.shape), rates, 0 * rates, at_rest)
            for k, link in enumerate(tree.links):
                energies[:, k] += momentum(link.body, state.q[k][-1], state.qd[k][-1], state.roots[k])[0]
        return np.asarray(energies / np.maximum(energies.sum(axis=1, keepdims=True), 1e-300))

    def directions(self, modes: Complex) -> tuple[str, ...]:
        """Names such as "arm x": of each mode (n, k) the body with most kinetic energy, and the axis of its root along
        which one of its points moves most; "arm rx", about which it turns most, where none of its points moves.
        """
        of_point = [body for body, name in enumerate(self.system.order) for _ in self.system.points_of(name)]
        roots = self.local.tree.motion(self.local.y, self.local.yd, self.local.ydd, self.local.inputs).roots
        moved, turning = (np.einsum("pan,nk->kpa", each, modes) for each in self.slopes_of_frames)
        names = []
        for body, *of_mode in zip(self.shares(modes).argmax(axis=1), moved, turning, strict=True):
            along, about = (turned_back(roots[body].R, each[np.equal(of_point, body)]) for each in of_mode)
            turns = np.abs(along).max() <= STILL * np.abs(about).max()
            axis = "xyz"[np.abs(about if turns else along).max(axis=0).argmax()]
            names.append(f"{self.system.order[body]} {'r' if turns else ''}{axis}")
        return tuple(names)

    def richer(self, system: System) -> SteadySystem:
        """State of a system with richer bodies under the same drives; ComputationError if it has none."""
        try:
            if self.begins:
                return beginning(system, self.drive)
            # Joints begin where they rest here: there may be several places.
            resting = zip(self.system.coordinates, self.coordinates, strict=True)
            joints = {name: value for name, value in resting if ".q" not in name}
            pairs = zip(system.coordinates, system.start[0], strict=True)
            return steady(system, self.drive, start=np.array([joints.get(*pair) for pair in pairs]))
        except InputError as error:
            raise ComputationError("no equilibrium", f"with richer bodies, {error}") from error

    @property
    def changing(self) -> bool:
        """True if the residual, K, C or M are others after a turn: the state is not the same at all angles."""
        prescribed = self.local.inputs.prescribed
        if not self.drive.rate and (prescribed is None or not prescribed[1].any()):
            return False
        square, modes = symmetric_modes(*(symmetric(each) for each in (self.linear.stiffness, self.linear.mass)))
        rate = np.sqrt(np.abs(square))
        rate = np.maximum(rate, 1e-6 * rate.max(initial=0.0) or 1.0)
        left, *before = self._turned(0.0).local.slopes()
        for turn in TURNS:
            left_after, *after = self._turned(turn).local.slopes()
            moved = np.append(*balanced(left_after - left, before[0], before[2], self.adrift))
            # K, C and M in modes of unit mass, over their frequencies.
            pairs = zip(before, after, (1.0, 0.5, 0.0), strict=True)
            changes = [modes.T @ (b - a) @ modes / np.outer(rate, rate) ** power for a, b, power in pairs]
            if np.abs(moved).max(initial=0.0) > STILL or np.abs(changes).max(initial=0.0) > SAME:
                return True
        return False

    def _turned(self, turn: float) -> Point:
        """The point with all that turns ahead by an angle, rad, and the other coordinates as they are."""
        tree, inputs = self.point.tree, replace(self.drive, turn=turn).inputs(self.system)
        y, prescribed = np.array(self.point.y), inputs.prescribed
        if self.drive.coordinate:
            k = self.system.coordinates.index(self.drive.coordinate)
            if k not in tree.fixed:
                y[np.searchsorted(tree.free, k)] += turn
                prescribed = prescribed[:, :-1] if prescribed is not None else None
        inputs = replace(inputs, prescribed=None if prescribed is None or not prescribed.size else prescribed)
        return replace(self.point, y=y, inputs=inputs)


def steady(system: System, drive: Drive, *, held: bool = False, start: Floats | None = None) -> SteadySystem:
    """System in equilibrium relative to what turns, whose coordinate is free, under the effort that it needs, unless
    `held`. The search begins at coordinates `start`, by default those of the joints. Where it ends nowhere, or far from
    there in a state that is unstable, the system goes from there down its forces, to one that is stable if it can.
    """
    state = _branch(system, drive, system.start[0] if start is None else start)
    if state.accelerated and state.changing:
        names = " and ".join(each.coordinate for each in state.accelerated)
        problem = f"{names} is accelerated by what turns, and not evenly: hold it, or take away what pushes it"
        raise ComputationError("no equilibrium", problem)
    return _released(state, held=held)


def settled(system: System, drive: Drive) -> SteadySystem:
    """System in equilibrium as of :func:`steady`, without friction; where it has none, or would not stay there, joints
    without a spring are held where they begin, if their friction suffices.
    """
    state, lost, stuck = None, ComputationError("no equilibrium", ""), _rubbing(system)
    try:
        state = steady(system, drive)
    except ComputationError as error:
        lost = error
    while stuck and (state is None or state.grows):
        try:
            held = steady(_holding(system, stuck), drive)
        except ComputationError:
            break
        point, efforts = held.point, drive.inputs(system).efforts
        force, _ = point.tree.rows(point.y, point.yd, point.ydd, point.inputs)
        force = np.abs(force - (0.0 if efforts is None else efforts))
        shares, words = dict[str, float](), list[str]()
        for name, kinds in stuck.items():
            for kind in kinds:
                size, friction = force[system.row(f"{name}.{kind}")], system.joints[name].frictions[kind]
                shares[name] = max(shares.get(name, 0.0), size / friction)
                share = f"{size:.4g} of its {friction:.4g} {unit_of_effort(kind)}"
                held_by = f"nothing but friction holds {name}.{kind}, where it begins, with {share}"
                words.append(f"{held_by}; small departures are those with it held")
        worst = max(shares, key=lambda name: shares[name])
        if shares[worst] <= 1:
            return replace(held, stuck=tuple(words))
        del stuck[worst]
    if state is None:
        raise lost
    return state


def _holding(system: System, stuck: Mapping[str, Sequence[str]]) -> System:
    """The system with rates, by joint, prescribed to be zero, and no efforts along them."""
    joints = dict(system.joints)
    for name, kinds in stuck.items():
        joint: Any = joints[name]
        efforts = {kind: effort for kind, effort in joint.efforts.items() if kind not in kinds}
        joints[name] = replace(joint, rate=joint.rates | dict.fromkeys(kinds, 0.0), effort=efforts)
    return replace(system, joints=joints)


def _rubbing(system: System) -> dict[str, tuple[str, ...]]:
    """Rates, by joint, that friction alone may hold: no spring, no prescribed rate and no controller has them."""
    driven = {each for controller in system.controllers.values() for each in controller.drive}
    rubbing = {}
    for name, joint in system.joints.items():
        sprung = dict(zip(joint.rate_names, joint.holder.stiffness, strict=True))
        kinds = [
            kind
            for kind in joint.frictions
            if kind not in joint.rates and not sprung[kind] and f"{name}.{kind}" not in driven
        ]
        if not {*SPIN} <= {*kinds}:  # a ball is held about all axes or none
            kinds = [kind for kind in kinds if kind not in SPIN]
        if kinds:
            rubbing[name] = tuple(kinds)
    return rubbing


def beginning(system: System, drive: Drive) -> SteadySystem:
    """System in motion as it starts, its bodies bent as in inertia relief, so that none of them is shaken."""
    return SteadySystem(system, drive, started(system, drive.motion, drive.time, Initial("relief")), begins=True)


def _branch(system: System, drive: Drive, start: Floats) -> SteadySystem:
    """The equilibrium of :func:`steady`, what turns held."""
    tree, inputs, state, lost = _held(system, drive), drive.inputs(system), None, None
    only_bodies = len(tree.free) == sum(link.body.size for link in tree.links)
    try:
        # Where nothing but bodies gives way, a state that is not near is found along the path of growing drives.
        state = SteadySystem(system, drive, rested(system, tree, inputs, start, nearby=only_bodies))
        if is_linear(tree):
            return state
    except ComputationError as error:
        lost = error
    if state is None:
        off_path = only_bodies and not is_linear(tree)
    else:
        y = state.point.y
        apart = np.abs(y - start[tree.free]).max(initial=0.0)
        off_path = apart > PREDICTED * np.abs(y).max(initial=0.0) and not bends_back(tree, state.point.slopes()[1])
    if off_path:
        try:
            state = SteadySystem(system, drive, followed(system, tree, inputs))
        except ComputationError as error:
            if only_bodies:
                raise error from None
    if state is not None and (state.moved(start) <= NEAR or not state.grows):
        return state
    if only_bodies:
        raise lost or ComputationError("no equilibrium", "")
    with suppress(ComputationError, np.linalg.LinAlgError):
        other = SteadySystem(system, drive, relaxed(system, tree, inputs, start))
        if state is None or not other.grows:
            return other
    if state is None:
        raise lost or ComputationError("no equilibrium", "")
    return state


def _held(system: System, drive: Drive) -> Tree:
    """The system's tree with the coordinate that turns among the prescribed ones."""
    tree = system.tree
    k = system.coordinates.index(drive.coordinate) if drive.coordinate else -1
    return tree if k < 0 or k in tree.fixed else replace(tree, fixed=(*tree.fixed, k))


def _released(state: SteadySystem, *, held: bool) -> SteadySystem:
    """Free the coordinate that turns; nothing changes if it is `held` or prescribed. The constant effort by which it
    goes on has no part in small departures.
    """
    fixed, tree = state.point, state.system.tree
    if held or fixed.tree is tree:
        return state
    inputs = fixed.inputs
    assert inputs.prescribed is not None
    pairs = zip((fixed.y, fixed.yd, fixed.ydd), inputs.prescribed, strict=True)
    whole = [fixed.tree.whole(unknown, prescribed) for unknown, prescribed in pairs]
    others = inputs.prescribed[:, :-1]
    inputs = replace(inputs, prescribed=others if others.size else None)
    y, yd, ydd = (each[tree.free] for each in whole)
    return SteadySystem(state.system, state.drive, Point(tree, y, yd, ydd, inputs))


def undeformed(system: System) -> SteadySystem:
    """System at its start, bodies undeformed and all at rest, as nothing need hold it, on ground at rest."""
    y, still = system.start[0][system.tree.free], np.zeros(len(system.tree.free))
    return SteadySystem(system, Drive(), Point(system.tree, y, still, still, system.inputs(np.zeros(()))))


def placed(system: System, drive: Drive, q: Floats | None, qd: Floats | None) -> SteadySystem:
    """System whose bodies are held at coordinates and rates (n,), by default those of :func:`steady`, and accelerate as
    their equations say; joints are where the drive and their springs hold them.
    """
    if q is None and qd is None:
        return steady(system, drive)
    if q is None:
        state = steady(system, drive)
    else:
        tree, inputs = _held(system, drive), drive.inputs(system)
        still = np.zeros(len(tree.free))
        point = Point(tree, system.start[0][tree.free], still, still, inputs)
        state = _released(SteadySystem(system, drive, point), held=False)
    point, names = state.point, [system.coordinates[k] for k in state.point.tree.free]
    bent = np.array([".q" in name for name in names])
    y, yd = np.array(point.y), np.array(point.yd)
    y[bent] = y[bent] if q is None else q
    if q is not None and not drive.coordinate and not bent.all():
        joints = Point(point.tree, y, yd, point.ydd, point.inputs)
        for _ in range(CORRECTIONS):
            left, k, *_ = joints.slopes()
            change = np.zeros_like(left)
            change[~bent] = np.linalg.lstsq(k[~bent][:, ~bent], -left[~bent], rcond=None)[0]
            joints = replace(joints, y=joints.y + change)
            if np.abs(change).max() <= CLOSE:
                break
        y = joints.y
    yd[bent] = yd[bent] if qd is None else qd
    left, _, _, m = Point(point.tree, y, yd, np.where(bent, 0.0, point.ydd), point.inputs).slopes()
    ydd = np.array(point.ydd)
    ydd[bent] = np.linalg.solve(m[bent][:, bent], -left[bent])
    return replace(state, point=replace(point, y=y, yd=yd, ydd=ydd))


def open_loops(system: System) -> tuple[str, ...]:
    """Warning of controllers, which act over time only."""
    if not system.controllers:
        return ()
    names = ", ".join(system.controllers)
    return (f"without its controllers, {names}, as if these were off; `gbeam linearize --loop closed` has them",)


def turning_of(system: System, motion: Motion | None, turning: str | None) -> str:
    """Name of the coordinate that turns: `turning`, or the only prescribed angle, or the only angle; "" for a hub."""
    angles = [
        f"{name}.{each}"
        for name, joint in system.joints.items()
        for each in joint.coordinates
        if each.startswith("angle")
    ]
    if turning is None and isinstance(motion, Hub):
        return ""
    if not angles:
        fix = "hold a body by a revolute joint, whose rate is raised, or let the ground move as a hub"
        raise InputError("joints", "have no angle that turns", fix)
    if turning is not None:
        if turning not in angles:
            fix = f"choose from {', '.join(angles)}"
            raise InputError("turning", f"is {turning!r}, which is no angle of a joint", fix)
        return turning
    choices = [each for each in angles if system.coordinates.index(each) in system.tree.fixed] or angles
    if len(choices) != 1:
        raise InputError("turning", "is missing", f"say which angle turns: {', '.join(choices)}")
    return choices[0]


class Equilibria:
    """Workspace of a search: steady states of systems, what turns held, by the rate or factor of their drives. A new
    one begins at coordinates extrapolated from up to three lower values, and so takes fewer corrections.
    """

    def __init__(self) -> None:
        self._of: dict[int, tuple[System, dict[float, SteadySystem]]] = {}

    def steady(self, system: System, value: float, drive: Drive, *, held: bool = False) -> SteadySystem:
        """Return the steady state of a system by its drive, whose rate or factor is the value."""
        known = self._known(system)
        if value not in known:
            start = None if is_linear(_held(system, drive)) else _continued(known, value)
            known[value] = steady(system, drive, held=True, start=start)
        return _released(known[value], held=held)

    def ahead(self, system: System, drives: Mapping[float, Drive]) -> None:
        """Solve for states at several values at once; those that fail are left to `steady`, one by one."""
        known = self._known(system)
        new = {value: drive for value, drive in drives.items() if value not in known}
        if not new or not known:
            return
        tree = _held(system, next(iter(new.values())))
        if is_linear(tree):
            return  # which takes no search
        starts = np.array([_continued(known, value) for value in new])
        points = rested_together(system, tree, [drive.inputs(system) for drive in new.values()], starts)
        for (value, drive), solved in zip(new.items(), points, strict=True):
            if solved is not None:
                point, slopes = solved
                known[value] = SteadySystem(system, drive, point, slopes if point.minimal else None)

    def _known(self, system: System) -> dict[float, SteadySystem]:
        return self._of.setdefault(id(system), (system, {}))[1]


def _continued(states: Mapping[float, SteadySystem], value: float) -> Floats | None:
    """Coordinates (n,) extrapolated to a value from states at up to three lower ones; None if there are none."""
    below: list[float] = []
    for lower in sorted(states, reverse=True):
        # The nearest one, then those as far apart as it is from the value.
        if lower <= value and len(below) < 3 and (not below or below[-1] - lower >= value - below[0]):
            below.append(lower)
    if not below:
        return None
    from scipy.interpolate import KroghInterpolator

    return np.asarray(KroghInterpolator(below, [states[lower].coordinates for lower in below])(value))


@dataclass(frozen=True)
class Path:
    """Steady states of a system, or of richer ones, as a value of the drives is `varied`; what turns may be `held`."""

    drive: Drive
    varied: Callable[[Drive, float], Drive]
    held: bool = False
    equilibria: Equilibria = field(default_factory=Equilibria, repr=False, compare=False)

    def __call__(self, of: System, value: float) -> SteadySystem:
        return self.equilibria.steady(of, value, self.varied(self.drive, value), held=self.held)

    def ahead(self, of: System, values: Iterable[float]) -> None:
        """Solve for the states at several values at once."""
        self.equilibria.ahead(of, {value: self.varied(self.drive, value) for value in values})


def turning_at(drive: Drive, value: float) -> Drive:
    """Return drives whose coordinate turns at a rate, rad/s."""
    return replace(drive, rate=value)


def loaded(drive: Drive, value: float) -> Drive:
    """Return drives with loads and forces times a factor."""
    return replace(drive, factor=value)


def pushed(drive: Drive, value: float) -> Drive:
    """Return drives whose ground is accelerated along its x axis, m/s²."""
    return replace(drive, base=Base(np.array([value, 0.0, 0.0]), np.zeros(3), np.zeros(3)))


def refuse_changing(path: Path, system: System, rate: float) -> None:
    """Refuse a system whose equations change as it turns at a rate, rad/s: it has no frequencies."""
    if path(system, rate).changing:
        joint = path.drive.coordinate.rpartition(".")[0]
        fix = (
            "let gravity be along its axis, and all that does not turn with it, or all that does, be alike about "
            "that axis; `gbeam run` answers for the others"
        )
        where = f"joints.{joint}" if joint else "motion"
        raise InputError(where, "turns a system whose equations change with the angle: it has no frequencies", fix)


def share_of_loads(path: Path, system: System) -> float:
    """The larger of two effects of loads and forces, to first order: stiffness over the system's, displacement over
    its extent. The path is that of :func:`loaded` drives.
    """
    inputs = path.drive.inputs(system)
    if not any(each is not None and np.any(each) for each in (*inputs.loads, inputs.wrenches)):
        return 0.0  # which the differences below are not, by rounding
    rest, slight = path(system, 0.0), path(system, SLIGHT)
    square, modes = symmetric_modes(*(symmetric(each) for each in (rest.linear.stiffness, rest.linear.mass)))
    elastic = square > RIGID**2 * square[-1]
    shapes = modes[:, elastic] / np.sqrt(square[elastic])  # of unit strain energy
    added = shapes.T @ (slight.linear.stiffness - rest.linear.stiffness) @ shapes / SLIGHT
    places, moved = (np.stack([frame.p for frame in each.frames]) for each in (rest, slight))
    size = max(np.abs(places).max(), 1e-300)
    return float(max(np.linalg.norm(added, 2), np.abs(moved - places).max() / SLIGHT / size))
