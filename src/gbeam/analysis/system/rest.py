"""Steady states of a system, found from where its joints begin, or given."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any

import numpy as np

from gbeam.analysis.system.drive import Drive
from gbeam.analysis.system.initial import Initial
from gbeam.analysis.system.point import Point
from gbeam.analysis.system.search import NEAR, followed, holds_bodies, relaxed, rested
from gbeam.analysis.system.solution import Solution
from gbeam.analysis.system.start import starting_point
from gbeam.analysis.system.steady import SteadySystem, release
from gbeam.arrays.tree import each_leaf
from gbeam.arrays.types import Floats
from gbeam.errors import ComputationError, InputError
from gbeam.mechanics.tree.closures import DIRECTIONS
from gbeam.mechanics.tree.equations import Inputs, Tree
from gbeam.mechanics.tree.joints import SPIN
from gbeam.mechanics.tree.linear import is_linear
from gbeam.mechanics.tree.signal_names import unit_of_effort
from gbeam.mechanics.tree.system import System

PREDICTED = 1e-3  # of the coordinates: a state so near to where those of lower drives lead has not left their path
CLOSED = 1e-8  # m, rad, m/s or rad/s: a larger gap, or rate of one, is that of a loop that does not stay closed
CORRECTIONS, CLOSE = 50, 1e-12  # of joints beside bodies that are held: their number, and m or rad


def steady_state(system: System, drive: Drive, *, held: bool = False, start: Floats | None = None) -> SteadySystem:
    """System in equilibrium relative to what turns. The coordinate that turns is free under the effort that it needs,
    unless it is `held`.

    The search begins at coordinates `start`, by default those of the joints. Where it ends nowhere, or in an unstable
    state far from there, the system moves from the start down its forces, to a stable state if it can.
    """
    start = system.start[0] if start is None else start
    if system.closing:
        y = start[system.tree.unknowns]
        _refuse_moving_loops(system, Point(system.tree, y, 0 * y, 0 * y, drive.inputs(system)))
    state = _branch(system, drive, start)
    _refuse_moving_loops(system, state.point)
    if state.accelerated and state.changing:
        names = " and ".join(motion.coordinate for motion in state.accelerated)
        problem = f"{names} is accelerated by what turns, and not evenly: hold it, or take away what pushes it"
        raise ComputationError("no equilibrium", problem)
    return release(state, held=held)


def _refuse_moving_loops(system: System, point: Point) -> None:
    """Raise ComputationError where loops do not stay closed in a state of rest: a prescribed joint moves them."""
    tree = point.tree
    if not tree.closures:
        return
    gaps, rates, _ = tree.gap_rates(tree.motion(point.y, point.yd, point.ydd, point.inputs))
    sizes = np.maximum(np.abs(gaps), np.abs(rates)).reshape(-1, DIRECTIONS).max(axis=1)
    if sizes.max() > CLOSED:
        name = system.closing[int(sizes.argmax())]
        problem = f"the loop that {name} closes does not stay closed there, or a prescribed joint moves it"
        raise ComputationError("no equilibrium", f"{problem}; hold that joint, or ask for a run in time")


def settled(system: System, drive: Drive) -> SteadySystem:
    """System in equilibrium, as of :func:`steady_state`, without friction.

    Where there is none, or the system would not stay there, joints without a spring are held where they begin, if their
    friction suffices. The joint whose friction suffices least is freed first.
    """
    state, lost, stuck = None, ComputationError("no equilibrium", ""), _rubbing(system)
    try:
        state = steady_state(system, drive)
    except ComputationError as error:
        lost = error
    while stuck and (state is None or state.grows):
        try:
            held = steady_state(_holding(system, stuck), drive)
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
    """The system with rates of joints prescribed to be zero, and without efforts along them."""
    joints = dict(system.joints)
    for name, kinds in stuck.items():
        joint: Any = joints[name]
        efforts = {kind: effort for kind, effort in joint.efforts.items() if kind not in kinds}
        joints[name] = replace(joint, rate=joint.rates | dict.fromkeys(kinds, 0.0), effort=efforts)
    return replace(system, joints=joints)


def _rubbing(system: System) -> dict[str, tuple[str, ...]]:
    """Rates, by joint, that friction alone may hold: without spring, prescribed rate and controller."""
    driven = {drive for controller in system.controllers.values() for drive in controller.drive}
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
    point = starting_point(system, drive.motion, drive.time, Initial("relief"))
    if system.closing and (point.yd.any() or any(joint.rates for joint in system.joints.values())):
        problem = f"moves, and {system.closing[0]} closes a loop, whose small departures are those of a state of rest"
        raise InputError("at", f'is "start", where the system {problem}', 'give at = "rest"')
    return SteadySystem(system, drive, point, begins=True)


def _branch(system: System, drive: Drive, start: Floats) -> SteadySystem:
    """The equilibrium of :func:`steady_state`, while what turns is held.

    Three searches follow one another: Newton's method from the start; where only bodies give way, along the path of
    growing drives; and, where joints move, down the forces.
    """
    tree, inputs, state, lost = held_tree(system, drive), drive.inputs(system), None, None
    only_bodies = len(tree.unknowns) == sum(link.body.size for link in tree.links)
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
        distance = np.abs(y - start[tree.unknowns]).max(initial=0.0)
        off_path = distance > PREDICTED * np.abs(y).max(initial=0.0) and not holds_bodies(tree, state.point.slopes()[1])
    if off_path:
        try:
            state = SteadySystem(system, drive, followed(system, tree, inputs))
        except ComputationError as error:
            if only_bodies:
                raise error from None
    if state is not None and (state.largest_departure(start) <= NEAR or not state.grows):
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


def held_tree(system: System, drive: Drive) -> Tree:
    """The system's tree with the coordinate that turns among the prescribed ones."""
    tree = system.tree
    k = system.coordinates.index(drive.coordinate) if drive.coordinate else -1
    return tree if k < 0 or k in tree.fixed else replace(tree, fixed=(*tree.fixed, k))


def undeformed(system: System) -> SteadySystem:
    """System at its start with undeformed bodies, all at rest on ground at rest. It need not be in equilibrium."""
    y, still = system.start[0][system.tree.unknowns], np.zeros(len(system.tree.unknowns))
    return SteadySystem(system, Drive(), Point(system.tree, y, still, still, system.inputs(np.zeros(()))))


def placed(system: System, drive: Drive, q: Floats | None, qd: Floats | None) -> SteadySystem:
    """System whose bodies are held at coordinates and rates (n,), by default those of :func:`steady_state`.

    They accelerate as their equations say. Joints are where the drive and their springs hold them.
    """
    if q is None and qd is None:
        return steady_state(system, drive)
    if q is None:
        state = steady_state(system, drive)
    else:
        tree, inputs = held_tree(system, drive), drive.inputs(system)
        still = np.zeros(len(tree.unknowns))
        point = Point(tree, system.start[0][tree.unknowns], still, still, inputs)
        state = release(SteadySystem(system, drive, point), held=False)
    point, names = state.point, [system.coordinates[k] for k in state.point.tree.unknowns]
    bent = np.array([".q" in name for name in names])  # coordinates of bodies
    y, yd = np.array(point.y), np.array(point.yd)
    y[bent] = y[bent] if q is None else q
    if q is not None and not drive.coordinate and not bent.all():
        # Newton's method for the joints alone.
        joints = Point(point.tree, y, yd, point.ydd, point.inputs)
        for _ in range(CORRECTIONS):
            residual, k, *_ = joints.slopes()
            change = np.zeros_like(residual)
            change[~bent] = np.linalg.lstsq(k[~bent][:, ~bent], -residual[~bent], rcond=None)[0]
            joints = replace(joints, y=joints.y + change)
            if np.abs(change).max() <= CLOSE:
                break
        y = joints.y
    yd[bent] = yd[bent] if qd is None else qd
    residual, _, _, m = Point(point.tree, y, yd, np.where(bent, 0.0, point.ydd), point.inputs).slopes()
    ydd = np.array(point.ydd)
    ydd[bent] = np.linalg.solve(m[bent][:, bent], -residual[bent])
    return replace(state, point=replace(point, y=y, yd=yd, ydd=ydd))


def transfer(state: SteadySystem, system: System) -> SteadySystem:
    """Transfer a state to a system with richer bodies under the same drives; ComputationError if it has none."""
    try:
        if state.begins:
            return beginning(system, state.drive)
        # Joints begin where they rest in the state: there may be several places.
        resting = zip(state.system.coordinates, state.coordinates, strict=True)
        joints = {name: value for name, value in resting if ".q" not in name}
        pairs = zip(system.coordinates, system.start[0], strict=True)
        return steady_state(system, state.drive, start=np.array([joints.get(*pair) for pair in pairs]))
    except InputError as error:
        raise ComputationError("no equilibrium", f"with richer bodies, {error}") from error


def steady_solution(state: SteadySystem, target: System) -> Solution:
    """Express a steady state as a solution of one time, for its system or a richer `target`. What turns is free."""
    drive, system = state.drive, state.system
    moved = state if target is system else transfer(state, target)
    if drive.coordinate and system.coordinates.index(drive.coordinate) not in system.tree.fixed:
        drive = replace(drive, coordinate="", rate=None)
    point = release(moved, held=False).point

    def inputs(system: System, _: Any) -> Inputs:
        return each_leaf(lambda leaf: leaf[None], drive.inputs(system))

    return Solution(target, point.trajectory(drive.time), inputs)
