"""Operating points of a system: where its flexible bodies rest, and the derivatives of its equations there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from gbeam.analysis.system.initial import Initial, on_bodies, rates_of, shape_of
from gbeam.arrays.namespace import Array, holds_jax, namespace
from gbeam.arrays.tree import each_leaf, together
from gbeam.arrays.types import Flags, Floats
from gbeam.errors import ComputationError, InputError
from gbeam.integrate.equations import Trajectory, accelerations, expanded, masses, slopes, solved
from gbeam.mechanics.tree.equations import STUCK, Inputs, Tree
from gbeam.mechanics.tree.joints import SLIDES
from gbeam.mechanics.tree.linear import frozen_equations, is_linear
from gbeam.mechanics.tree.signal_names import deforming, local_names, unit_of_effort
from gbeam.mechanics.tree.steps import Ball
from gbeam.mechanics.tree.system import System
from gbeam.motion.protocol import Motion
from gbeam.numerics.balance import (
    SAME,
    answered,
    balanced,
    carried,
    loose,
    pulled,
    relaxation,
    rooted,
    turning_on,
    unheld,
)
from gbeam.numerics.eigen import positive_definite
from gbeam.numerics.series import STEP

ITERATIONS, RELAXING = 50, 100
MASSLESS = 1e-13  # of the largest: a smaller inertia is rounding
FEW = 8  # corrections of several states at once
NEAR = 0.1  # m, rad or strain: a state so near to where its search begins is that which is meant
SHORTEST = 1 / 64  # share of what is out of balance that is taken away at once
NONE = 1e-6  # m/s² or rad/s²: a smaller acceleration is rounding
LOCATED, LEAST = 1e-4, 1e-6  # strides, shares of the drives: that locates a loss of stiffness; that is the least
NEAREST = 1e-6  # of the coordinates: a stride that ends so near to its prediction has not left the path
NOISE = 1e-8  # of the coordinates: smaller corrections may not shrink, by rounding
CLOSE = 1e-12  # of the coordinates: where the next correction would be smaller, they have converged


@dataclass(frozen=True)
class Point:
    """State of a tree: its free coordinates, their rates and accelerations (n,), and its inputs."""

    tree: Tree
    y: Floats
    yd: Floats
    ydd: Floats
    inputs: Inputs

    @property
    def minimal(self) -> bool:
        """True if it has as many coordinates as degrees of freedom."""
        return self.tree.size == self.local.tree.size

    @property
    def local(self) -> Point:
        """The point with as many coordinates as degrees of freedom."""
        if not any(isinstance(step, Ball) for link in self.tree.links for step in link.steps):
            return self
        tree, prescribed = self.tree, self.inputs.prescribed
        states = [self.y, self.yd, self.ydd]
        if prescribed is not None:
            states = [tree.whole(state, prescribed[k]) for k, state in enumerate(states)]
        reduced, y, yd, ydd = tree.local(states[0], states[1], states[2])
        free, inputs = reduced.free, self.inputs
        if inputs.efforts is not None:
            pairs = zip(tree.links, reduced.links, strict=True)
            sizes = (pair for link, less in pairs for pair in zip(link.sizes, less.sizes, strict=True))
            # Efforts act on the last coordinates of a joint, as many as it has degrees of freedom.
            kept = np.concatenate([np.arange(size) >= size - fewer for size, fewer in sizes])
            inputs = replace(inputs, efforts=inputs.efforts[..., kept])
        if prescribed is not None:
            inputs = replace(inputs, prescribed=np.stack([y, yd, ydd])[:, np.array(reduced.fixed, dtype=int)])
        return Point(reduced, y[free], yd[free], ydd[free], inputs)

    def slopes(self) -> tuple[Floats, Floats, Floats, Floats]:
        """The residual (n,) and its derivatives K, C and M (n, n) with respect to y, ẏ and ÿ, by complex steps, without
        friction: at rest its smooth law is a damper that no joint has.
        """
        if is_linear(self.tree):
            m, c, k, force = frozen_equations(self.tree, self.inputs)
            return m @ self.ydd + c @ self.yd + k @ self.y - force, k, c, m
        rubs = any(link.holder.friction.any() for link in self.tree.links)
        tree = self.tree.frictionless if rubs else self.tree
        left, (k, c, m) = expanded(tree, self.y[None], self.yd[None], self.ydd[None], self.driven())
        return self.tree(self.y, self.yd, self.ydd, self.inputs) if rubs else left[0], k[0], c[0], m[0]

    def standing(self, time: float = 0.0) -> Trajectory:
        """A trajectory of this state alone."""
        return Trajectory(np.array([time]), self.y[None], self.yd[None], self.ydd[None])

    def driven(self, *_: Any) -> Inputs:
        """Inputs with an axis of one time, as of the trajectory of `standing`; arguments are ignored."""
        return each_leaf(lambda leaf: leaf[None], self.inputs)

    def sticking(self, system: System, *, resting: bool = False) -> tuple[str, ...]:
        """Warnings of coordinates that friction may hold, which is left out; if `resting`, how far from here."""
        state, warnings, local = self.tree.motion(self.y, self.yd, self.ydd, self.inputs), list[str](), None
        for name, joint in system.joints.items():
            k = system.order.index(joint.body)
            rates = self.tree.links[k].held(state.q[k][:-1], state.qd[k][:-1])[1] if joint.frictions else ()
            for kind, friction in joint.frictions.items():
                i = joint.rate_names.index(kind)
                if kind in joint.rates or abs(rates[i]) >= STUCK:
                    continue
                words = f"friction of {name}.{kind}, {friction:.4g} {unit_of_effort(kind)}, is left out"
                if not resting:
                    warnings.append(f"{words} of small departures, which it damps or holds; rate = 0 holds the joint")
                    continue
                local = local or self.local
                _, stiffness, _, mass = local.slopes()
                names = local_names(system.coordinates)
                force = friction * np.array([names[each] == f"{name}.{joint.values[i]}" for each in local.tree.free])
                moved = answered(stiffness, mass, force)
                held = np.allclose(stiffness @ moved, force, atol=1e-6 * friction)
                far = f"up to {in_words(kind, abs(float(moved @ force)) / friction)} either way of here, to first order"
                warnings.append(f"{words}, which may hold it {far if held else 'wherever it is put'}")
        return tuple(warnings)


def in_words(kind: str, size: float) -> str:
    """Size of a displacement, m, or of a rotation, rad, of a joint, as people read it."""
    return f"{1e3 * size:.4g} mm" if kind in SLIDES else f"{np.degrees(size):.4g}°"


def refuse_massless(system: System, point: Point, mass: Floats) -> None:
    """Raise InputError if some motion of the coordinates has no kinetic energy, by M (n, n) at a point."""
    if _least_moving(mass)[0] > MASSLESS:
        return
    local = point.local  # whose names are those of degrees of freedom
    names, motion = local_names(system.coordinates), np.abs(_least_moving(local.slopes()[3])[1])
    foremost = [names[local.tree.free[k]] for k in np.flatnonzero(motion > motion.max() / 2)]
    if all(name.rpartition(".")[0] in system.flexible for name in foremost):
        return  # shapes of a body that are nearly dependent, and have mass nevertheless
    together = ", ".join(foremost)
    fix = "give the body that it moves a mass, and a moment of inertia about every axis that is free"
    fix += "; of two springs one behind the other, as a joint's and a beam's root, give one"
    raise InputError("bodies", f"leave {together} without inertia", fix)


def _least_moving(mass: Floats) -> tuple[float, Floats]:
    """The smallest singular value of the scaled M over the largest, and the motion (n,) of the coordinates with it."""
    scale = rooted(mass)
    _, sizes, rows = np.linalg.svd(mass / np.outer(scale, scale))
    return (sizes[-1] / sizes[0] if sizes.any() else 0.0, rows[-1]) if sizes.size else (np.inf, scale)


class Begun(NamedTuple):
    """Coordinates and accelerations (n,) of a start, and the index of the coordinate that goes on and on where there is
    none, else −1.
    """

    q: Array
    qdd: Array
    adrift: int = -1


def solve_start(residual: Any, q: Array, qd: Array, inputs: Any, *, bent: Flags, accelerated: Flags) -> Begun:
    """Start near q, qd (n,) at which the forces on coordinates that are `bent`, which rest there, are in balance, and
    those on `accelerated` ones are answered by their accelerations; the others are held. NaN where JAX traces it and
    there is none.
    """
    held, traced = ~(bent | accelerated), holds_jax(residual, q, qd, inputs)
    begun: Array = np.zeros(len(bent))
    if traced:
        import jax.numpy as jnp

        q, qd, begun = map(jnp.asarray, (q, qd, begun))  # beside inputs that are traced, NumPy would read them

    def forces(z: Array) -> Array:
        """Forces left over (..., n); z (..., n) are displacements and accelerations."""
        left = residual(q + bent * z, qd + 0 * z, accelerated * z, inputs)
        return namespace(left).where(held, z, left)

    def left(z: Array, share: Any, first: Array) -> Array:
        return forces(z) - (1.0 - share) * first

    if traced:
        from gbeam.mechanics.equations.compiled import root

        z = root(partial(left, first=forces(begun)), begun)
        return Begun(q + bent * z, accelerated * z)
    z, reached, stride = begun, 0.0, 1.0
    while reached < 1.0:
        share = min(reached + stride, 1.0)
        wanted = forces if share == 1.0 else partial(left, share=share, first=forces(begun))
        moved, change, converged = _root_near(wanted, z, bent)
        if converged:
            z, reached, stride = moved, share, 2 * stride
        elif stride > SHORTEST:
            stride /= 4
        else:
            return Begun(q, 0 * begun, int(np.abs(np.nan_to_num(change, nan=np.inf)).argmax()))
    return Begun(q + bent * z, accelerated * z)


@np.errstate(all="ignore")  # corrections may leave all numbers
def _root_near(left: Any, z: Floats, bent: Flags) -> tuple[Floats, Floats, bool]:
    """Root of a function near z (n,) by Newton's method, the last correction where `bent`, and True if it converged."""
    change = z
    for _ in range(ITERATIONS):
        values = left(z + 1j * STEP * np.eye(len(z)))  # whose real parts are those of z
        change = solved(values.imag.T / STEP, -values[0].real)
        z, change = z + change, np.where(bent, change, 0.0)
        if np.abs(change).max(initial=0.0) <= CLOSE * (1e-3 + np.abs(z[bent]).max(initial=0.0)):
            return z, change, True
    return z, change, False


def started(system: System, motion: Motion | None, time: float, initial: Initial) -> Point:
    """State at the start of the joints, with the accelerations that its forces make. ComputationError where no shape of
    the bodies is as `initial` says: see :class:`gbeam.Initial`.
    """
    tree, inputs = system.tree, system.inputs(np.asarray(time), motion)
    y, yd = (each[tree.free] for each in system.start)
    undeformed = Point(tree, y, yd, np.zeros_like(y), inputs)
    refuse_massless(system, undeformed, masses(tree, y[None], yd[None], undeformed.driven())[0])
    begun, bent, accelerated = _begun(system, inputs, initial)
    y, yd = begun.q, _moving(system, begun.q, yd, initial)
    if begun.adrift >= 0:
        body, fix = system.coordinates[tree.free[begun.adrift]].rpartition(".")[0], 'begin with initial = "undeformed"'
        raise ComputationError("no equilibrium", f"{body} has no place to rest at the start; {fix}")
    ydd = begun.qdd
    if initial.acceleration is not None or initial.moving or not (bent | accelerated).all():  # what was held is let go
        (ydd,) = accelerations(tree, y[None], yd[None], undeformed.driven())
    return Point(tree, y, yd, ydd, inputs)


def started_traced(system: System, motion: Motion | None, time: float, initial: Initial) -> tuple[Array, Array]:
    """Coordinates and rates (n,) as `started` has them, of a system that JAX traces; NaN where no shape is at rest."""
    y = _begun(system, system.inputs(np.asarray(time), motion), initial)[0].q
    return y, _moving(system, y, system.start[1][system.tree.free], initial)


def _begun(system: System, inputs: Inputs, initial: Initial) -> tuple[Begun, Flags, Flags]:
    """Coordinates and accelerations of a start, and flags (n,) of the coordinates that were bent and accelerated."""
    tree, moved = system.tree, on_bodies(system.flexible, initial.displaced)
    y, yd = (each[tree.free] for each in system.start)
    bent, accelerated = unknown_at_start(system, initial.state)
    if initial.acceleration is not None:  # joints are held, and what floats deforms, too
        bodies = [_of_body(system, name).any(axis=0) for name in system.flexible]
        bent, accelerated = np.any([bent, *bodies], axis=0), np.zeros_like(bent)
        inputs, yd = _accelerated(inputs, np.asarray(initial.acceleration)), 0 * yd
    for name, components in moved.items():
        if components:
            onto = _of_body(system, name)
            y = y + shape_of(system.flexible[name], components) @ onto
            held = ~onto.any(axis=0)
            bent, accelerated = bent & held, accelerated & held
    if not (bent | accelerated).any():
        return Begun(y, 0 * y), bent, accelerated
    return solve_start(tree, y, yd, inputs, bent=bent, accelerated=accelerated), bent, accelerated


def _of_body(system: System, name: str) -> Floats:
    """Entries of one (m, n) at the free coordinates that deform a body."""
    return (np.array(deforming(system.coordinates, name), dtype=int)[:, None] == system.tree.free).astype(float)


def _moving(system: System, y: Array, yd: Array, initial: Initial) -> Array:
    """Rates (n,) of coordinates y, of which the joints' begin with `yd`."""
    for name, components in on_bodies(system.flexible, initial.moving).items():
        if components:
            onto = _of_body(system, name)
            yd = yd + rates_of(system.flexible[name], onto @ y, components) @ onto
    return yd


def _accelerated(inputs: Inputs, acceleration: Floats) -> Inputs:
    """Inputs of a ground with an acceleration alone, and joints that rest."""
    ground, still = inputs.ground, 0 * inputs.ground.w
    moving = inputs.prescribed
    return replace(
        inputs,
        ground=replace(ground, a=still + acceleration, w=still, alpha=still),
        prescribed=None if moving is None else moving * np.array([[1.0], [0.0], [0.0]]),
    )


def unknown_at_start(system: System, initial: str) -> tuple[Flags, Flags]:
    """Flags (n,) of the free coordinates that a start bends and of those that it accelerates; the others are held.

    By `initial` = "equilibrium" joints hold what they move. Springs of a clamp bend as a body does, unless it is said
    where they begin; springs at the root of a body that deforms let it go, for it has no mass there to be held by. What
    floats is undeformed.
    """
    bent, accelerated = list[bool](), list[bool]()
    for k in system.tree.free:
        owner, _, coordinate = system.coordinates[k].rpartition(".")
        if coordinate.startswith("q"):
            body, deforms, gives = owner, True, False
        else:
            joint = system.joints[owner]
            body, deforms = joint.body, joint.kind == "fixed" and joint.initial is None and initial == "equilibrium"
            gives = joint.sprung and body in system.flexible
        floats = body in system.floating
        bends = deforms and {"equilibrium": not floats, "undeformed": False, "relief": True}[initial]
        bent.append(bends)
        accelerated.append(not bends and (initial != "equilibrium" or floats or gives))
    return np.array(bent, dtype=bool), np.array(accelerated, dtype=bool)


def _farthest(system: System, tree: Tree, values: Any) -> str:
    """Name of the free coordinate with the largest value (n,); of an Euler parameter, the rotation of its joint."""
    name = system.coordinates[tree.free[int(np.abs(np.nan_to_num(values, nan=np.inf)).argmax())]]
    return name if local_names([name]) == [name] else f"the rotation of {name.rpartition('.')[0]}"


def _alike(point: Point, left: Floats, k: Floats, mass: Floats, turn: Flags) -> bool:
    """True if turning one hinge by a radian changes no residual; `turn` flags it, `k` and `mass` are its columns."""
    elsewhere = point.tree(point.y + turn, point.yd, point.ydd, point.inputs)
    changed = max(np.abs(k).max(), np.abs(elsewhere - left).max())
    return bool(changed <= SAME * (np.abs(mass).max() + np.abs(left).max()))


def adrift(point: Point, left: Floats, slope: Sequence[Floats]) -> Flags:
    """Flags (n,) of the coordinates that nothing holds, by the residual `left` and K, C, M: slides from the ground, and
    balls and hinges behind them if the equations stay the same as all beyond turns with them.
    """
    tree, (k, c, m) = point.tree, slope
    slides = np.asarray(tree.sliding & loose(k, c))
    turning = [turn for turn in tree.turning if turn.sum() > 1 or _alike(point, left, k[:, turn], m[:, turn], turn)]
    if not turning:
        return slides
    candidates = np.any([slides, *turning], axis=0)
    local = replace(point, ydd=point.ydd + pulled(left, m, candidates)).local
    _, k, c, m = local.slopes()
    turns = local.tree.turning
    candidates = np.any([local.tree.sliding & loose(k, c), *turns], axis=0)
    free = [not c[:, turn].any() and turning_on(k, m, local.ydd, candidates, turn) for turn in turns]
    return np.any([slides, *(turn for turn, turns_on in zip(turning, free, strict=True) if turns_on)], axis=0)


def _newton(
    point: Point, left_over: Floats, *, relaxing: bool = False, shrinking: bool = False
) -> tuple[Point, tuple[Floats, ...], Floats, bool]:
    """Solve residual = `left_over` (n,) by Newton's method: the point, K, C, M, last correction, True if converged. If
    `relaxing` each correction goes down the forces, as the tree itself would, and so ends where the stiffness holds. If
    `shrinking`, corrections that do not shrink, which may lead far away, are a failure.
    """
    before, tree, accelerated = 0.0, point.tree, point.tree.sliding
    if accelerated.any() or tree.turning:
        left, *slope = point.slopes()
        accelerated = adrift(point, left, slope)
        point = replace(point, ydd=point.ydd + pulled(left - left_over, slope[-1], accelerated))
    for _ in range(RELAXING if relaxing else ITERATIONS):
        left, k, c, m = point.slopes()
        if not np.isfinite(left).all():
            return point, (k, c, m), left, False
        change = relaxation(left, k, m, accelerated) if relaxing else balanced(left - left_over, k, m, accelerated)[0]
        size = float(np.abs(change).max(initial=0.0))
        # Steps of a radian at most: a beam far from its equilibrium turns by as much.
        point = replace(point, y=point.y + change / max(1.0, size))
        # With other accelerations than those of the forces a body that turns with all that pushes it would change them.
        left = tree(point.y, point.yd, point.ydd, point.inputs) if accelerated.any() else left
        point = replace(point, ydd=point.ydd + pulled(left - left_over, m, accelerated))
        # The next correction is smaller by what this one is smaller than the last one, at least.
        limit = CLOSE * (1.0 + np.abs(point.y).max(initial=0.0))
        if min(size, 1.0) * min(size / before if before else 1.0, 1.0) <= limit:
            return point, (k, c, m), change, True
        if shrinking and before and size > before / 2 and size > NOISE * np.abs(point.y).max(initial=0.0):
            break
        before = min(size, 1.0)  # as much as was taken of it
    return point, (k, c, m), change, False


def rested_together(
    system: System, tree: Tree, drives: Sequence[Inputs], starts: Floats
) -> list[tuple[Point, tuple[Floats, ...]] | None]:
    """States of rest of a system's tree under several inputs, each with its K, C and M, from starts (t, n) of all
    coordinates; None for each that Newton's method does not find near its start.
    """
    inputs, sliding, sloped = together(drives), tree.sliding, tree.frictionless
    y, begun = starts[:, tree.free], starts[:, tree.free]
    still, ydd, before = np.zeros_like(y), np.zeros_like(y), np.full(len(y), np.inf)
    converged, lost = np.zeros((2, len(y)), dtype=bool)
    with np.errstate(all="ignore"):  # of states that diverge
        which = np.zeros(y.shape, dtype=bool)
        for count in range(FEW):
            if sliding.any():
                if not count:
                    k, c, m = slopes(sloped, y, still, ydd, inputs)
                    which = sliding & np.array([loose(*pair) for pair in zip(k, c, strict=True)])
                left = tree(y, still, ydd, inputs)
                ydd = ydd + [pulled(*state) for state in zip(left, m, which, strict=True)]
            left, (k, c, m) = tree(y, still, ydd, inputs), slopes(sloped, y, still, ydd, inputs)
            settled = converged  # where the derivatives are those of a state that has converged
            if (settled | lost).all():
                break
            lost = lost | ~np.isfinite(np.concatenate([left[:, None], k], axis=1)).all(axis=(1, 2))
            change = np.zeros_like(y)
            for i in np.flatnonzero(~lost).tolist():
                change[i], _ = balanced(left[i], k[i], m[i], which[i])
            size = np.abs(change).max(axis=1, initial=0.0)
            shrunk = np.where(np.isfinite(before) & (before > 0), np.minimum(size / before, 1.0), 1.0)
            limit = CLOSE * (1.0 + np.abs(y).max(axis=1, initial=0.0))
            y, before = np.where(lost[:, None], begun, y + change), size
            converged = ~lost & (np.minimum(size, 1.0) * shrunk <= limit)
    near = settled & ~lost & (np.abs(y - begun).max(axis=1, initial=0.0) <= NEAR)
    points: list[tuple[Point, tuple[Floats, ...]] | None] = [None] * len(y)
    for i in np.flatnonzero(near).tolist():
        slope = k[i], c[i], m[i]
        if not bends_back(tree, k[i]):
            continue
        try:
            points[i] = _steady(system, Point(tree, y[i], still[i], ydd[i], drives[i]), slope), slope
        except (InputError, ComputationError, np.linalg.LinAlgError):
            continue
    return points


def rested(system: System, tree: Tree, inputs: Inputs, start: Floats | None = None, *, nearby: bool = False) -> Point:
    """State of a tree in relative equilibrium: rates are zero, and only coordinates that nothing holds are accelerated.

    Linear equations are solved at once. If there are several states, the nearest one to coordinates `start`, by default
    the joints' start with bodies undeformed. Where Newton's method fails from there, the residual at the start is taken
    away in shares, or not at all if the state has to be `nearby`. ComputationError if there is no equilibrium.
    """
    still = np.zeros(len(tree.free))
    if is_linear(tree):
        return _rested_at_once(Point(tree, still, still, still, inputs))
    begun = point = Point(tree, (system.start[0] if start is None else start)[tree.free], still, still, inputs)
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


def _rested_at_once(point: Point) -> Point:
    """State of rest of linear equations; ComputationError where their stiffness is singular."""
    left, k, _, _ = point.slopes()
    try:
        y: Any = np.linalg.solve(k, -left)
    except np.linalg.LinAlgError:
        y = np.nan * left
    if not np.isfinite(y).all():
        problem = (
            f"no relative equilibrium: the stiffness is singular, or the base's motion not finite; {_turns(point)}"
        )
        raise ComputationError("not converged", problem)
    return replace(point, y=y)


def _turns(point: Point) -> str:
    """Say at which rate the ground turns."""
    return f"the rate is {float(np.linalg.norm(point.inputs.ground.w)):.4g} rad/s"


def bends_back(tree: Tree, stiffness: Floats) -> bool:
    """True if the stiffness K (n, n) holds the bodies that deform, alone."""
    deforms = [np.full(size, k == len(link.steps)) for link in tree.links for k, size in enumerate(link.sizes)]
    kept = np.concatenate(deforms)[tree.free]
    return positive_definite(stiffness[kept][:, kept])


def _eased(inputs: Inputs, share: float) -> Inputs:
    """Inputs of which a share acts: of accelerations and forces, and of rates its root."""
    ground, root = inputs.ground, np.sqrt(share)
    slower = replace(ground, a=share * ground.a, w=root * ground.w, alpha=share * ground.alpha)
    forces = {name: getattr(inputs, name) for name in ("efforts", "wrenches")}
    acting = {name: None if each is None else share * each for name, each in forces.items()}
    loads = tuple(None if each is None else share * each for each in inputs.loads)
    moving = inputs.prescribed
    moving = None if moving is None else moving * np.array([[1.0], [root], [share]])
    return replace(inputs, ground=slower, prescribed=moving, loads=loads, **acting)


def followed(system: System, tree: Tree, inputs: Inputs) -> Point:
    """State of rest at the end of a path on which the drives grow from nothing, in strides that are shortened where one
    fails, or where the bodies' stiffness is lost in a long one that ends far from its prediction; ComputationError with
    the share that was reached where the path ends.
    """
    still, y = np.zeros(len(tree.free)), system.start[0][tree.free]
    left, k, _, m = Point(tree, y, still, still, _eased(inputs, 0.0)).slopes()
    pull = left - tree(y, still, still, inputs)
    # dy/dshare, along which a stride starts
    course = answered(k, m, pull) if np.isfinite(pull).all() else still
    holds, reached, stride = True, 0.0, 1.0
    while reached < 1.0:
        share = min(reached + stride, 1.0)
        ahead = y + (share - reached) * course
        point = Point(tree, ahead, still, still, _eased(inputs, share))
        moved, slope, _, converged = _newton(point, still, shrinking=True)
        held = converged and bends_back(tree, slope[0])
        near = converged and np.abs(moved.y - ahead).max() < NEAREST * np.abs(moved.y).max()
        if held or (converged and (not holds or stride < LOCATED or near)):
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
    """State of rest, as of `rested`, to which a tree goes from coordinates `start` down its forces; ComputationError
    where it goes on.
    """
    still = np.zeros(len(tree.free))
    point, slope, _, converged = _newton(Point(tree, start[tree.free], still, still, inputs), still, relaxing=True)
    if not converged:
        raise ComputationError("no equilibrium", "no place was found in which the system comes to rest")
    return _steady(system, point, slope)


def _steady(system: System, point: Point, slope: Sequence[Floats]) -> Point:
    """The point with accelerations that are rounding set to zero; ComputationError where forces would accelerate other
    coordinates, InputError where some motion has no mass. `slope` is K, C and M.
    """
    tree, (k, c, m) = point.tree, slope
    if len(tree.free) == sum(link.body.size for link in tree.links) and bends_back(tree, k):
        return point  # the stiffness holds all, whatever its mass
    refuse_massless(system, point, m)
    slides, left = tree.sliding & loose(k, c), tree(point.y, point.yd, point.ydd, point.inputs)
    turns = any(np.abs(point.ydd[turn]).max() > NONE for turn in tree.turning)
    accelerated = adrift(point, left, slope) if turns else slides
    (left,), (k,) = carried(m, slides, left), carried(m, accelerated, k)
    k[:, accelerated] = 0.0
    # Only forces that no stiffness balances are judged: the rounding of a stiff body's forces is more than gravity.
    directions = unheld(k, m)
    yields = np.linalg.solve(m, directions) @ directions.T
    rounding = np.abs(yields) @ np.abs(k).sum(axis=1)
    if np.abs(yields @ left).max(initial=0.0) > NONE * max(1.0, 1e-6 * rounding.max(initial=0.0)):
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
        name = local_names(system.coordinates)[local.tree.free[index]]
        if _friction(system, name):
            faster = np.where(np.arange(len(local.ydd)) == index, 0.0, local.ydd)
            left = local.tree(local.y, local.yd, faster, local.inputs)
            raise ComputationError("no equilibrium", _pushed(system, name, left[index]))


def _unheld(system: System, local: Point) -> str:
    """Say which coordinate is accelerated, and by which force or moment."""
    left, k, c, m = local.slopes()
    left, k = carried(m, local.tree.sliding & loose(k, c), left, k)
    left = left - k @ answered(k, m, left)
    # Of the coordinates that are accelerated together, the one on which the force left over acts.
    row = int(np.abs(left / np.sqrt(np.diag(m))).argmax())
    name = local_names(system.coordinates)[local.tree.free[row]]
    joint, _, kind = name.rpartition(".")
    size = f"{abs(left[row]):.4g} {unit_of_effort(kind)}"
    if joint in system.joints and kind in ("rx", "ry", "rz") and system.joints[joint].kind == "free":
        about = f"{kind[1]} of {system.joints[joint].body}.root"
        fix = "push in line with the mass centre, balance the moment, or hold it"
        return f"{joint} is turned ever faster by {size} about {about} through the mass centre: {fix}"
    return _pushed(system, name, left[row])


def _friction(system: System, name: str) -> float:
    """Friction, N or N m, along a local coordinate by its name; 0 where there is none."""
    owner, _, kind = name.rpartition(".")
    joint = system.joints.get(owner)
    return 0.0 if joint is None else joint.frictions.get(joint.rate_names[joint.values.index(kind)], 0.0)


def _pushed(system: System, name: str, force: float) -> str:
    """Say by which force, N or N m, a local coordinate is accelerated, and what friction holds of it."""
    unit, friction = unit_of_effort(name.rpartition(".")[2]), _friction(system, name)
    size, fix = f"{abs(force):.4g} {unit}", "hold it, or take away what pushes it"
    if not friction:
        return f"{name} is accelerated by {size}, which nothing holds: {fix}"
    if abs(force) > friction:
        return f"{name} is accelerated by {size}, of which friction holds {friction:.4g} {unit}: {fix}"
    return f"nothing but friction holds {name}, with {size} of its {friction:.4g} {unit}: give rate = 0, which does too"
