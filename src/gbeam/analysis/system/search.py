"""Search for points at which a tree rests: by Newton's method, along growing drives, or down its forces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from gbeam.analysis.system.point import Point, refuse_massless
from gbeam.arrays.tree import stack_trees
from gbeam.arrays.types import Flags, Floats
from gbeam.errors import ComputationError, InputError
from gbeam.integrate.equations import slopes
from gbeam.mechanics.tree.equations import Inputs, Tree
from gbeam.mechanics.tree.linear import is_linear
from gbeam.mechanics.tree.signal_names import local_names, unit_of_effort
from gbeam.mechanics.tree.system import System
from gbeam.numerics.balance import (
    SAME,
    answered,
    balanced,
    carried,
    keeps_turning,
    loose,
    pulled,
    relaxation,
    unheld,
)
from gbeam.numerics.eigen import positive_definite

ITERATIONS, RELAXING = 50, 100
FEW = 8  # corrections of several states at once
NEAR = 0.1  # m, rad or strain: a state so near to where its search begins is that which is meant
SHORTEST = 1 / 64  # share of what is out of balance that is taken away at once
NONE = 1e-6  # m/s² or rad/s²: a smaller acceleration is rounding
LOCATED, LEAST = 1e-4, 1e-6  # strides, shares of the drives: that locates a loss of stiffness; that is the least
NEAREST = 1e-6  # of the coordinates: a stride that ends so near to its prediction has not left the path
NOISE = 1e-8  # of the coordinates: smaller corrections may not shrink, by rounding
CLOSE = 1e-12  # of the coordinates: where the next correction would be smaller, they have converged


def _farthest(system: System, tree: Tree, values: Any) -> str:
    """Name of the free coordinate with the largest value (n,), or of the rotation that an Euler parameter is of."""
    name = system.coordinates[tree.unknowns[int(np.abs(np.nan_to_num(values, nan=np.inf)).argmax())]]
    return name if local_names([name]) == [name] else f"the rotation of {name.rpartition('.')[0]}"


def _turns_evenly(point: Point, residual: Floats, k: Floats, mass: Floats, turn: Flags) -> bool:
    """True if turning a hinge, flagged by `turn`, changes no residual; `k` and `mass` are its columns."""
    elsewhere = point.tree(point.y + turn, point.yd, point.ydd, point.inputs)
    changed = max(np.abs(k).max(), np.abs(elsewhere - residual).max())
    return bool(changed <= SAME * (np.abs(mass).max() + np.abs(residual).max()))


def adrift(point: Point, residual: Floats, slope: Sequence[Floats]) -> Flags:
    """Flags (n,) of the coordinates that nothing holds, from the residual (n,) and K, C and M.

    They are slides from the ground, and balls and hinges behind them if the equations stay the same as all that hangs
    on these turns with them.
    """
    tree, (k, c, m) = point.tree, slope
    slides = np.asarray(tree.sliding & loose(k, c))
    turning = list[Flags]()
    for turn in tree.turning:
        is_ball = turn.sum() > 1
        if is_ball or _turns_evenly(point, residual, k[:, turn], m[:, turn], turn):
            turning.append(turn)
    if not turning:
        return slides
    candidates = np.any([slides, *turning], axis=0)
    local = replace(point, ydd=point.ydd + pulled(residual, m, candidates)).local
    _, k, c, m = local.slopes()
    turns = local.tree.turning
    candidates = np.any([local.tree.sliding & loose(k, c), *turns], axis=0)
    free = [not c[:, turn].any() and keeps_turning(k, m, local.ydd, candidates, turn) for turn in turns]
    return np.any([slides, *(turn for turn, turns_on in zip(turning, free, strict=True) if turns_on)], axis=0)


class _Iterate(NamedTuple):
    """End of Newton's method: K, C and M before the last correction, this (n,), and True if it converged."""

    point: Point
    slope: tuple[Floats, ...]
    change: Floats
    converged: bool


def _newton(point: Point, remaining: Floats, *, relaxing: bool = False, shrinking: bool = False) -> _Iterate:
    """Solve residual = `remaining` (n,) by Newton's method.

    Coordinates that nothing holds are accelerated in place of displaced. If `relaxing`, each correction goes down the
    forces, as the tree itself would, and so ends where the stiffness holds. If `shrinking`, corrections that do not
    shrink, which may lead far away, are a failure.
    """
    tree, accelerated = point.tree, point.tree.sliding
    if accelerated.any() or tree.turning:
        residual, *slope = point.slopes()
        accelerated = adrift(point, residual, slope)
        point = replace(point, ydd=point.ydd + pulled(residual - remaining, slope[-1], accelerated))
    size_before = 0.0  # of the correction before, as much as was taken of it
    for _ in range(RELAXING if relaxing else ITERATIONS):
        residual, k, c, m = point.slopes()
        if not np.isfinite(residual).all():
            return _Iterate(point, (k, c, m), residual, False)
        if relaxing:
            change = relaxation(residual, k, m, accelerated)
        else:
            change, _ = balanced(residual - remaining, k, m, accelerated)
        size = float(np.abs(change).max(initial=0.0))
        # Steps of a radian at most: a beam far from its equilibrium turns by as much.
        point = replace(point, y=point.y + change / max(1.0, size))
        # With other accelerations than those of the forces a body that turns with all that pushes it would change them.
        residual = tree(point.y, point.yd, point.ydd, point.inputs) if accelerated.any() else residual
        point = replace(point, ydd=point.ydd + pulled(residual - remaining, m, accelerated))
        largest = np.abs(point.y).max(initial=0.0)
        # The next correction is smaller by what this one is smaller than the last one, at least.
        shrinkage = min(size / size_before, 1.0) if size_before else 1.0
        if min(size, 1.0) * shrinkage <= CLOSE * (1.0 + largest):
            return _Iterate(point, (k, c, m), change, True)
        if shrinking and size_before and size > size_before / 2 and size > NOISE * largest:
            break
        size_before = min(size, 1.0)
    return _Iterate(point, (k, c, m), change, False)


def solve_rests(
    system: System, tree: Tree, drives: Sequence[Inputs], starts: Floats
) -> list[tuple[Point, tuple[Floats, ...]] | None]:
    """Find states of rest of a system's tree under several inputs, from starts (t, n) of all coordinates.

    Each has its K, C and M. One that Newton's method does not find near its start is None.
    """
    inputs, sliding, sloped = stack_trees(drives), tree.sliding, tree.frictionless
    y, begun = starts[:, tree.unknowns], starts[:, tree.unknowns]
    still, ydd, before = np.zeros_like(y), np.zeros_like(y), np.full(len(y), np.inf)
    converged, lost = np.zeros((2, len(y)), dtype=bool)
    with np.errstate(all="ignore"):  # of states that diverge
        which = np.zeros(y.shape, dtype=bool)
        for count in range(FEW):
            if sliding.any():
                if not count:
                    k, c, m = slopes(sloped, y, still, ydd, inputs)
                    which = sliding & np.array([loose(*pair) for pair in zip(k, c, strict=True)])
                residual = tree(y, still, ydd, inputs)
                ydd = ydd + [pulled(*state) for state in zip(residual, m, which, strict=True)]
            residual, (k, c, m) = tree(y, still, ydd, inputs), slopes(sloped, y, still, ydd, inputs)
            settled = converged  # where the derivatives are those of a state that has converged
            if (settled | lost).all():
                break
            lost = lost | ~np.isfinite(np.concatenate([residual[:, None], k], axis=1)).all(axis=(1, 2))
            change = np.zeros_like(y)
            for i in np.flatnonzero(~lost).tolist():
                change[i], _ = balanced(residual[i], k[i], m[i], which[i])
            size = np.abs(change).max(axis=1, initial=0.0)
            shrunk = np.where(np.isfinite(before) & (before > 0), np.minimum(size / before, 1.0), 1.0)
            limit = CLOSE * (1.0 + np.abs(y).max(axis=1, initial=0.0))
            y, before = np.where(lost[:, None], begun, y + change), size
            converged = ~lost & (np.minimum(size, 1.0) * shrunk <= limit)
    nearby = settled & ~lost & (np.abs(y - begun).max(axis=1, initial=0.0) <= NEAR)
    points: list[tuple[Point, tuple[Floats, ...]] | None] = [None] * len(y)
    for i in np.flatnonzero(nearby).tolist():
        slope = k[i], c[i], m[i]
        if not holds_bodies(tree, k[i]):
            continue
        try:
            points[i] = _steady(system, Point(tree, y[i], still[i], ydd[i], drives[i]), slope), slope
        except (InputError, ComputationError, np.linalg.LinAlgError):
            continue
    return points


def rested(system: System, tree: Tree, inputs: Inputs, start: Floats | None = None, *, nearby: bool = False) -> Point:
    """State of a tree in relative equilibrium: rates are zero, and only coordinates that nothing holds are accelerated.

    Linear equations are solved at once. Of several states the one nearest to coordinates `start` is found, by default
    the joints' start with undeformed bodies. Where Newton's method fails from there, the residual at the start is taken
    away in shares; a state that has to be `nearby` is not searched so. ComputationError if there is no equilibrium.
    """
    still = np.zeros(len(tree.unknowns))
    if is_linear(tree):
        return _solve_linear_rest(Point(tree, still, still, still, inputs))
    begun = point = Point(tree, (system.start[0] if start is None else start)[tree.unknowns], still, still, inputs)
    residual, reached, stride = tree(begun.y, still, still, inputs), 0.0, 1.0
    if not np.isfinite(residual).all():
        raise ComputationError("no equilibrium", "the forces are not finite where the search begins")
    while reached < 1.0:
        share = min(reached + stride, 1.0)
        moved, slope, change, converged = _newton(point, (1.0 - share) * residual, shrinking=nearby)
        if converged:
            point, reached, stride = moved, share, 2 * stride
        elif stride > SHORTEST and not nearby:
            stride /= 4
        else:
            _steady(system, begun, begun.slopes()[1:])
            name = _farthest(system, tree, change)
            problem = f"no place was found in which the system rests: {name} goes on and on; hold what is free"
            raise ComputationError("no equilibrium", problem)
    return _steady(system, point, slope)


def _solve_linear_rest(point: Point) -> Point:
    """Solve linear equations for a state of rest; ComputationError where their stiffness is singular."""
    residual, k, _, _ = point.slopes()
    try:
        y: Any = np.linalg.solve(k, -residual)
    except np.linalg.LinAlgError:
        y = np.nan * residual
    if not np.isfinite(y).all():
        cause = "the stiffness is singular, or the base's motion not finite"
        raise ComputationError("not converged", f"no relative equilibrium: {cause}; {_turns(point)}")
    return replace(point, y=y)


def _turns(point: Point) -> str:
    """Say at which rate the ground turns."""
    return f"the rate is {float(np.linalg.norm(point.inputs.ground.w)):.4g} rad/s"


def holds_bodies(tree: Tree, stiffness: Floats) -> bool:
    """True if the stiffness K (n, n) holds the bodies that deform while joints are held."""
    deforms = [np.full(size, k == len(link.steps)) for link in tree.links for k, size in enumerate(link.sizes)]
    kept = np.concatenate(deforms)[tree.unknowns]
    return positive_definite(stiffness[kept][:, kept])


def _eased(inputs: Inputs, share: float) -> Inputs:
    """Inputs of which only a share acts: accelerations and forces times the share, rates times its root."""
    ground, root = inputs.ground, np.sqrt(share)
    slower = replace(ground, a=share * ground.a, w=root * ground.w, alpha=share * ground.alpha)
    forces = {name: getattr(inputs, name) for name in ("efforts", "wrenches")}
    acting = {name: None if force is None else share * force for name, force in forces.items()}
    loads = tuple(None if load is None else share * load for load in inputs.loads)
    moving = inputs.prescribed
    moving = None if moving is None else moving * np.array([[1.0], [root], [share]])
    return replace(inputs, ground=slower, prescribed=moving, loads=loads, **acting)


def followed(system: System, tree: Tree, inputs: Inputs) -> Point:
    """State of rest at the end of a path on which the drives grow from nothing.

    Strides are shortened where one fails, or where the bodies' stiffness is lost in a long one that ends far from its
    prediction. Where the path ends, a ComputationError says which share of the drives was reached.
    """
    still, y = np.zeros(len(tree.unknowns)), system.start[0][tree.unknowns]
    residual, k, _, m = Point(tree, y, still, still, _eased(inputs, 0.0)).slopes()
    pull = residual - tree(y, still, still, inputs)
    # dy/dshare, along which a stride starts
    course = answered(k, m, pull) if np.isfinite(pull).all() else still
    holds, reached, stride = True, 0.0, 1.0
    while reached < 1.0:
        share = min(reached + stride, 1.0)
        ahead = y + (share - reached) * course
        point = Point(tree, ahead, still, still, _eased(inputs, share))
        moved, slope, _, converged = _newton(point, still, shrinking=True)
        held = converged and holds_bodies(tree, slope[0])
        as_predicted = converged and np.abs(moved.y - ahead).max() < NEAREST * np.abs(moved.y).max()
        if held or (converged and (not holds or stride < LOCATED or as_predicted)):
            course = (moved.y - y) / (share - reached)
            y, holds, reached, stride = moved.y, held, share, 2 * stride
            continue
        stride /= 4
        if stride < LEAST:
            which = "the beam" if len(system.bodies) == 1 else "a body"
            problem = f"no relative equilibrium beyond {reached:.4g} of the load: {which} buckles or diverges there"
            raise ComputationError("not converged", f"{problem}; {_turns(point)}")
    return _steady(system, moved, slope)


def relaxed(system: System, tree: Tree, inputs: Inputs, start: Floats) -> Point:
    """State of rest to which a tree moves from coordinates `start` down its forces; ComputationError if to none."""
    still = np.zeros(len(tree.unknowns))
    point, slope, _, converged = _newton(Point(tree, start[tree.unknowns], still, still, inputs), still, relaxing=True)
    if not converged:
        raise ComputationError("no equilibrium", "no place was found in which the system comes to rest")
    return _steady(system, point, slope)


def _steady(system: System, point: Point, slope: Sequence[Floats]) -> Point:
    """Check a point of rest, with K, C and M, and set accelerations to zero that are rounding.

    ComputationError where forces would accelerate coordinates besides those that nothing holds, InputError where some
    motion has no mass.
    """
    tree, (k, c, m) = point.tree, slope
    if len(tree.unknowns) == sum(link.body.size for link in tree.links) and holds_bodies(tree, k):
        return point  # the stiffness holds all, whatever its mass
    refuse_massless(system, point, m)
    slides, residual = tree.sliding & loose(k, c), tree(point.y, point.yd, point.ydd, point.inputs)
    turns = any(np.abs(point.ydd[turn]).max() > NONE for turn in tree.turning)
    accelerated = adrift(point, residual, slope) if turns else slides
    (residual,), (k,) = carried(m, slides, residual), carried(m, accelerated, k)
    k[:, accelerated] = 0.0
    # Only forces that no stiffness balances are judged: the rounding of a stiff body's forces is more than gravity.
    directions = unheld(k, m)
    yields = np.linalg.solve(m, directions) @ directions.T
    rounding = np.abs(yields) @ np.abs(k).sum(axis=1)
    if np.abs(yields @ residual).max(initial=0.0) > NONE * max(1.0, 1e-6 * rounding.max(initial=0.0)):
        raise ComputationError("no equilibrium", _unheld(system, point.local))
    # Of a ball all three or none: an acceleration about one axis is no rounding of another's.
    faster = np.abs(point.ydd) > NONE
    for turn in tree.turning:
        faster |= turn & faster[turn].any()
    point = replace(point, ydd=np.where(faster, point.ydd, 0.0))
    if faster.any():
        _refuse_rubbing(system, point.local)
    return point


def _refuse_rubbing(system: System, local: Point) -> None:
    """Raise ComputationError where a coordinate with friction is accelerated: it slips, or friction holds it."""
    for index in np.flatnonzero(local.ydd).tolist():
        name = local_names(system.coordinates)[local.tree.unknowns[index]]
        if _friction(system, name):
            without = np.where(np.arange(len(local.ydd)) == index, 0.0, local.ydd)
            residual = local.tree(local.y, local.yd, without, local.inputs)
            raise ComputationError("no equilibrium", _pushed(system, name, residual[index]))


def _unheld(system: System, local: Point) -> str:
    """Say which coordinate is accelerated, and by which force or moment."""
    residual, k, c, m = local.slopes()
    force, k = carried(m, local.tree.sliding & loose(k, c), residual, k)
    force = force - k @ answered(k, m, force)  # without what stiffness balances
    # Of the coordinates that are accelerated together, the one on which the most force acts for its mass.
    row = int(np.abs(force / np.sqrt(np.diag(m))).argmax())
    name = local_names(system.coordinates)[local.tree.unknowns[row]]
    joint, _, kind = name.rpartition(".")
    size = f"{abs(force[row]):.4g} {unit_of_effort(kind)}"
    if joint in system.joints and kind in ("rx", "ry", "rz") and system.joints[joint].kind == "free":
        about = f"{kind[1]} of {system.joints[joint].body}.root"
        fix = "push in line with the mass centre, balance the moment, or hold it"
        return f"{joint} is turned ever faster by {size} about {about} through the mass centre: {fix}"
    return _pushed(system, name, force[row])


def _friction(system: System, name: str) -> float:
    """Friction, N or N m, along a local coordinate with this name; 0 where there is none."""
    owner, _, kind = name.rpartition(".")
    joint = system.joints.get(owner)
    return 0.0 if joint is None else joint.frictions.get(joint.rate_names[joint.values.index(kind)], 0.0)


def _pushed(system: System, name: str, force: float) -> str:
    """Say by which force, N or N m, a local coordinate is accelerated, and how much of it friction holds."""
    unit, friction = unit_of_effort(name.rpartition(".")[2]), _friction(system, name)
    size, fix = f"{abs(force):.4g} {unit}", "hold it, or take away what pushes it"
    if not friction:
        return f"{name} is accelerated by {size}, which nothing holds: {fix}"
    if abs(force) > friction:
        return f"{name} is accelerated by {size}, of which friction holds {friction:.4g} {unit}: {fix}"
    return f"nothing but friction holds {name}, with {size} of its {friction:.4g} {unit}: give rate = 0, which does too"
