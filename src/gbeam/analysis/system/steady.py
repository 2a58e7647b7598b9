"""Steady states of a system: its joints rest, or one of them, or the ground, turns at a constant rate."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from gbeam.analysis.system.drive import Drive
from gbeam.analysis.system.point import Point, refuse_massless
from gbeam.analysis.system.search import NONE, adrift
from gbeam.analysis.system.solution import Solution
from gbeam.arrays.types import Complex, Flags, Floats, Indices
from gbeam.constants import BY_STRAINS
from gbeam.errors import ComputationError
from gbeam.mechanics.fields.products import turned_back
from gbeam.mechanics.plausibility import elastic_bend
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.bodies import momentum
from gbeam.mechanics.tree.closing import independent_motions
from gbeam.mechanics.tree.frames import Frame
from gbeam.mechanics.tree.joints import SLIDES
from gbeam.mechanics.tree.rigid_body import ROOT
from gbeam.mechanics.tree.signal_names import deforming, local_names
from gbeam.mechanics.tree.system import System
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
SAME, STILL = 1e-6, 1e-9  # of modes' matrices, and m or rad: what changes with the angle changes by more
TURNS = (0.7, 2.1, 4.4)  # rad, at which the equations are looked at


def bent_most(system: System, names: Sequence[str], q: Floats) -> tuple[str, float]:
    """Name of the second-order body that moves most for its size at coordinates (k, n), and this proportion."""
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
    def zero(self) -> float:  # type: ignore[override]
        """Share of the largest eigenvalue below which one counts as zero, as of a motion that nothing holds. It is zero
        where only bodies move, which hold themselves.
        """
        size = sum(link.body.size for link in self.point.tree.links)
        return 0.0 if len(self.point.tree.unknowns) == size else RIGID

    @property
    def base(self) -> Base | None:
        """Motion of the ground; None where it rests."""
        if self.drive.motion is None and self.drive.base is None:
            return None
        ground = self.local.inputs.ground
        return Base(*(np.asarray(vector, dtype=float) for vector in (ground.a, ground.w, ground.alpha)))

    def base_of(self, body: str) -> Base:
        """Motion of the root of a body, (3,)."""
        local = self.local
        root = local.tree.motion(local.y, local.yd, local.ydd, local.inputs).roots[self.system.order.index(body)]
        return Base(root.a, root.w, root.alpha)

    @property
    def solution(self) -> Solution:
        """The state as a solution of one time, in which what turns is free as in the system."""
        point = release(self, held=False).point
        return Solution(self.system, point.trajectory(), point.driven)

    def bent(self, bodies: Mapping[str, Structure]) -> float:
        """Largest displacement of a station of some bodies from its place at rest, as a share of the body's length."""
        q = {name: self.local.y[deforming(self.names, name)] for name in bodies}
        moved = (np.abs(body.displacement(q[name])).max() / body.length for name, body in bodies.items())
        return float(max(moved, default=0.0))

    @property
    def bend(self) -> float:
        """Largest bend of a body, by the state or by the stiffness that its loads add, as a share of the length."""
        solution = self.solution
        bases = solution.bases(self.system.flexible)
        elastic = (elastic_bend(body, bases[name]) for name, body in self.system.flexible.items() if body.size)
        return max((*solution.bends.values(), *elastic), default=0.0)

    @cached_property
    def stable(self) -> bool:
        """True if the system would stay there: see :func:`stability_margin`.

        Angular accelerations bring a skew stiffness, half the rate of the gyroscopic coupling, which feeds no energy
        and is left out.
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
            (brought,) = self.along(self.local.slopes()[1] - without)
            k = k - (brought - brought.T) / 2
        return stability_margin(m, c, k, self.zero**2) > 0

    @property
    def warnings(self) -> tuple[str, ...]:
        """Doubts about the bodies' models, and what they leave out in this state."""
        return (
            self.stuck
            + self.system.warnings
            + self.solution.stiffness_warnings
            + self._spin_warnings
            + self._acceleration_warnings
        )

    @property
    def _spin_warnings(self) -> tuple[str, ...]:
        """Warn of joints that turn freely at the start and rest in this state."""
        tree, names = self.local.tree, self.names
        rates = self.system.tree.local(*self.system.start, 0 * self.system.start[0])[2][tree.unknowns]
        if self.point.yd.any() or not rates.any():
            return ()
        # A joint goes on turning if no stiffness acts on it, but for that of what is adrift.
        k, _, m = self.local.slopes()[1:]
        (stiffness,) = carried(m, self.adrift, k)
        stiffness[:, self.adrift] = 0.0
        size = np.abs(stiffness).max(axis=0)
        unsprung = size <= STILL * size.max() if stiffness.any() else np.ones(len(m), dtype=bool)
        goes_on = unsprung & (rates != 0)
        coordinates = (name.rpartition(".") for name, free in zip(names, goes_on, strict=True) if free)
        turning = dict.fromkeys(joint for joint, _, kind in coordinates if kind not in SLIDES)
        words = f'{" and ".join(turning)} did not turn, as at the start: gb.linearize(at="start") is about that motion'
        return (f"as if {words}",) if turning else ()

    @property
    def _acceleration_warnings(self) -> tuple[str, ...]:
        """Warn of joints with an angular acceleration: of the moment that turns them, and the time to turn by 1°."""
        if self.point.yd.any():
            return ()
        warnings, tree, names = [], self.local.tree, self.names
        turns = [turn for turn in tree.turning if self.local.ydd[turn].any() and self.adrift[turn].all()]
        mass = self.local.slopes()[3] if turns else np.zeros((0, 0))
        for turn in turns:
            alpha, slides = self.local.ydd[turn], tree.sliding & self.adrift
            moment = carried(mass, slides, mass)[0][turn][:, turn] @ alpha
            size, rate = np.linalg.norm(moment), np.linalg.norm(alpha)
            axis = ", ".join(f"{component + 0.0:.3g}" for component in np.round(moment / size, 3))
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
        """M, C and K of small departures. ComputationError where a body's model has no positive mass."""
        local_k, *others = self.known or self.local.slopes()[1:]
        for name, body in self.system.flexible.items():
            bending = body.coefficients.bending
            if bending is not None:
                columns = deforming(self.names, name)
                q, local_k = self.local.y[columns], np.array(local_k)
                local_k[np.ix_(columns, columns)] += bending.stiffness(q) - bending.slope(q)
        k, c, m = self.along(local_k, *others)
        if not positive_definite(m):
            raise ComputationError(MASSLESS, massless(self.system, self.names, self.local.y))
        if self.point.minimal:  # of others mass is looked at where they rest
            refuse_massless(self.system, self.point, m)
        return Linear(m, c, k - m @ self.along(self.follows)[0], np.zeros((len(m), 0)))

    @cached_property
    def _independent(self) -> tuple[Indices, Floats] | None:
        """Indices (k,) of independent local coordinates, and motions (n, k) by these; None where all are."""
        local = self.local
        if not local.tree.closures:
            return None
        return independent_motions(local.tree, local.tree.motion(local.y, local.yd, local.ydd, local.inputs))

    @property
    def motions(self) -> Floats | None:
        """Motions (n, k) of the local coordinates by those that are independent, or None where all are."""
        return None if self._independent is None else self._independent[1]

    def along(self, *matrices: Floats) -> tuple[Floats, ...]:
        """Matrices (k, k) along the independent coordinates of matrices (n, n) of all local ones."""
        motions = self.motions
        return matrices if motions is None else tuple(motions.T @ matrix @ motions for matrix in matrices)

    @property
    def independent(self) -> Indices:
        """Indices (k,) of the local coordinates that are independent."""
        return np.arange(len(self.local.y)) if self._independent is None else self._independent[0]

    @cached_property
    def adrift(self) -> Flags:
        """Flags of the local coordinates that nothing holds, so that forces accelerate them."""
        # Rotations stand for the last three of four Euler parameters.
        kept = [not self.system.coordinates[k].endswith(".e0") for k in self.point.tree.unknowns]
        residual, *slope = self.point.slopes()
        return adrift(self.point, residual, slope)[kept]

    @cached_property
    def follows(self) -> Floats:
        """Minus the derivatives (n, n) of ÿ with respect to y: an angular acceleration's axis turns with the body."""
        slope = np.zeros((len(self.local.y), len(self.local.y)))
        for turn in self.local.tree.turning if not self.point.yd.any() else ():
            if self.local.ydd[turn].any() and self.adrift[turn].all():
                slope[np.ix_(turn, turn)] = following(self.local.ydd[turn])
        return slope

    @property
    def coordinates(self) -> Floats:
        """All coordinates (n,)."""
        whole = np.array(self.system.start[0])
        whole[self.point.tree.unknowns] = self.point.y
        return whole

    @property
    def grows(self) -> bool:
        """True if a small departure grows; False where that is not known."""
        with suppress(ComputationError):
            return len(self.moving.growing) > 0
        return False

    def largest_departure(self, start: Floats) -> float:
        """Largest distance of a joint's coordinate, m or rad, from coordinates `start` (n,)."""
        joints = [".q" not in name for name in self.system.coordinates]
        return float(np.abs((self.coordinates - start)[joints]).max(initial=0.0))

    @property
    def names(self) -> list[str]:
        """Names of the local coordinates: the system's, with rotations in place of balls' Euler parameters."""
        local = local_names(self.system.coordinates)
        return [local[k] for k in self.local.tree.unknowns]

    @property
    def accelerated(self) -> tuple[Accelerated, ...]:
        """Coordinates that are accelerated evenly; none if other coordinates are accelerated, too."""
        ydd, slides = self.local.ydd, self.local.tree.sliding
        if ydd[~slides].any() and (self.point.yd.any() or ydd[~(slides | self.adrift)].any()):
            return ()  # held coordinates are accelerated, or the system moves
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
        """Derivatives (p, 3, n) of the places and of the rotations of all points, in the ground's axes, with respect to
        the coordinates, by a complex step.
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
        """Places of its points, of rigid bodies the roots, as they turn in the ground frame; None if nothing turns."""
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
        """Shares (k, bodies) of the bodies in the kinetic energy of modes (n, k), on ground at rest."""
        tree, inputs = self.local.tree, self.local.inputs
        still = Frame(*(np.eye(3) if k == 0 else np.zeros(3) for k in range(6)))
        prescribed = inputs.prescribed
        if prescribed is not None:
            prescribed = prescribed * [[1.0], [0.0], [0.0]]  # without rates and accelerations
        at_rest = replace(inputs, ground=still, prescribed=prescribed)
        energies = np.zeros((modes.shape[1], len(self.system.order)))
        for rates in (modes.real.T, modes.imag.T):
            state = tree.motion(np.broadcast_to(self.local.y, rates.shape), rates, 0 * rates, at_rest)
            for k, link in zip(range(len(self.system.order)), tree.links, strict=False):
                energies[:, k] += momentum(link.body, state.q[k][-1], state.qd[k][-1], state.roots[k])[0]
        return np.asarray(energies / np.maximum(energies.sum(axis=1, keepdims=True), 1e-300))

    def directions(self, modes: Complex) -> tuple[str, ...]:
        """Words such as "arm x" for each mode (n, k): the body with most kinetic energy, and the axis of its root along
        which one of its points moves most.

        Where none of its points moves, it is the axis about which one turns most, as in "arm rx".
        """
        of_point = [body for body, name in enumerate(self.system.order) for _ in self.system.points_of(name)]
        roots = self.local.tree.motion(self.local.y, self.local.yd, self.local.ydd, self.local.inputs).roots
        moved, turning = (np.einsum("pan,nk->kpa", slopes, modes) for slopes in self.slopes_of_frames)
        names = []
        for body, of_places, of_turns in zip(self.shares(modes).argmax(axis=1), moved, turning, strict=True):
            points = np.equal(of_point, body)
            along, about = turned_back(roots[body].R, of_places[points]), turned_back(roots[body].R, of_turns[points])
            turns = np.abs(along).max() <= STILL * np.abs(about).max()
            axis = "xyz"[np.abs(about if turns else along).max(axis=0).argmax()]
            names.append(f"{self.system.order[body]} {'r' if turns else ''}{axis}")
        return tuple(names)

    @property
    def changing(self) -> bool:
        """True if the state is not the same at all angles: the residual, K, C or M are others after a turn."""
        prescribed = self.local.inputs.prescribed
        if not self.drive.rate and (prescribed is None or not prescribed[1].any()):
            return False
        square, modes = symmetric_modes(symmetric(self.linear.stiffness), symmetric(self.linear.mass))
        rate = np.sqrt(np.abs(square))
        rate = np.maximum(rate, 1e-6 * rate.max(initial=0.0) or 1.0)
        residual, *before = self._turned(0.0).local.slopes()
        for turn in TURNS:
            residual_after, *after = self._turned(turn).local.slopes()
            moved = np.append(*balanced(residual_after - residual, before[0], before[2], self.adrift))
            # K, C and M in modes of unit mass, over their frequencies.
            pairs = zip(before, after, (1.0, 0.5, 0.0), strict=True)
            changes = [modes.T @ (b - a) @ modes / np.outer(rate, rate) ** power for a, b, power in pairs]
            if np.abs(moved).max(initial=0.0) > STILL or np.abs(changes).max(initial=0.0) > SAME:
                return True
        return False

    def _turned(self, turn: float) -> Point:
        """The point with everything that turns ahead by an angle, rad, while the other coordinates stay as they are."""
        tree, inputs = self.point.tree, replace(self.drive, turn=turn).inputs(self.system)
        y, prescribed = np.array(self.point.y), inputs.prescribed
        if self.drive.coordinate:
            k = self.system.coordinates.index(self.drive.coordinate)
            if k not in tree.fixed:
                y[np.searchsorted(tree.unknowns, k)] += turn
                prescribed = prescribed[:, :-1] if prescribed is not None else None
        inputs = replace(inputs, prescribed=None if prescribed is None or not prescribed.size else prescribed)
        return replace(self.point, y=y, inputs=inputs)


def open_loops(system: System) -> tuple[str, ...]:
    """Warning of controllers, which act over time only and not in a steady state."""
    if not system.controllers:
        return ()
    names = ", ".join(system.controllers)
    return (f"without its controllers, {names}, as if these were off; `gbeam linearize --loop closed` has them",)


def release(state: SteadySystem, *, held: bool) -> SteadySystem:
    """Free the coordinate that turns, unless it is `held` or prescribed. The constant effort by which it goes on has no
    part in small departures.
    """
    fixed, tree = state.point, state.system.tree
    if held or fixed.tree is tree:
        return state
    inputs = fixed.inputs
    assert inputs.prescribed is not None
    pairs = zip((fixed.y, fixed.yd, fixed.ydd), inputs.prescribed, strict=True)
    whole = [fixed.tree.complete(unknown, prescribed) for unknown, prescribed in pairs]
    others = inputs.prescribed[:, :-1]
    inputs = replace(inputs, prescribed=others if others.size else None)
    y, yd, ydd = (state_of_all[tree.unknowns] for state_of_all in whole)
    return SteadySystem(state.system, state.drive, Point(tree, y, yd, ydd, inputs))
