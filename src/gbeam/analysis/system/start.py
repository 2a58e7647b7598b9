"""Starts of a run: coordinates at which bodies rest, or are bent, while joints are where they begin."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from gbeam.analysis.system.initial import Initial, assign_to_bodies, rates_of, shape_of
from gbeam.analysis.system.point import Point, refuse_massless
from gbeam.analysis.system.search import CLOSE, ITERATIONS, SHORTEST
from gbeam.arrays.namespace import Array, holds_jax, namespace
from gbeam.arrays.types import Flags, Floats
from gbeam.errors import ComputationError
from gbeam.integrate.equations import accelerations, masses, solve_systems
from gbeam.mechanics.tree.closing import following
from gbeam.mechanics.tree.equations import Inputs, State, Tree
from gbeam.mechanics.tree.signal_names import deforming
from gbeam.mechanics.tree.system import System
from gbeam.motion.protocol import Motion
from gbeam.numerics.series import STEP


class Begun(NamedTuple):
    """Coordinates and accelerations (n,) of a start.

    `adrift` is the index of a coordinate that moves on without limit, so that there is no start; −1 if none does.
    """

    q: Array
    qdd: Array
    adrift: int = -1


def solve_start(residual: Any, q: Array, qd: Array, inputs: Any, *, bent: Flags, accelerated: Flags) -> Begun:
    """Solve for a start near q, qd (n,).

    Coordinates that are `bent` rest with their forces in balance. Those that are `accelerated` have the accelerations
    that their forces make. The others are held. The result is NaN where JAX traces the residual and there is no start.
    """
    is_held, traced = ~(bent | accelerated), holds_jax(residual, q, qd, inputs)
    begun: Array = np.zeros(len(bent))
    if traced:
        import jax.numpy as jnp

        q, qd, begun = map(jnp.asarray, (q, qd, begun))  # beside inputs that are traced, NumPy would read them

    def forces(z: Array) -> Array:
        """Residual (..., n) at displacements and accelerations z (..., n); z itself for coordinates that are held."""
        remaining = residual(q + bent * z, qd + 0 * z, accelerated * z, inputs)
        return namespace(remaining).where(is_held, z, remaining)

    def partial_forces(z: Array, share: Any, first: Array) -> Array:
        """Residual less the rest, 1 − `share`, of the `first` one: its root balances only this share of the forces."""
        return forces(z) - (1.0 - share) * first

    if traced:
        from gbeam.mechanics.equations.compiled import root

        z = root(partial(partial_forces, first=forces(begun)), begun)
        return Begun(q + bent * z, accelerated * z)
    z, reached, stride = begun, 0.0, 1.0
    while reached < 1.0:
        share = min(reached + stride, 1.0)
        wanted = forces if share == 1.0 else partial(partial_forces, share=share, first=forces(begun))
        moved, change, converged = _find_root(wanted, z, bent)
        if converged:
            z, reached, stride = moved, share, 2 * stride
        elif stride > SHORTEST:
            stride /= 4
        else:
            return Begun(q, 0 * begun, int(np.abs(np.nan_to_num(change, nan=np.inf)).argmax()))
    return Begun(q + bent * z, accelerated * z)


@np.errstate(all="ignore")  # corrections may leave all numbers
def _find_root(function: Any, z: Floats, bent: Flags) -> tuple[Floats, Floats, bool]:
    """Find the root of a function near z (n,) by Newton's method.

    Returns the root, the last correction of the coordinates that are `bent`, and True if the method has converged.
    """
    change = z
    for _ in range(ITERATIONS):
        values = function(z + 1j * STEP * np.eye(len(z)))  # whose real parts are those of z
        change = solve_systems(values.imag.T / STEP, -values[0].real)
        z, change = z + change, np.where(bent, change, 0.0)
        if np.abs(change).max(initial=0.0) <= CLOSE * (1e-3 + np.abs(z[bent]).max(initial=0.0)):
            return z, change, True
    return z, change, False


def starting_point(system: System, motion: Motion | None, time: float, initial: Initial) -> Point:
    """Return the state in which joints begin, with the accelerations that its forces make.

    Raises ComputationError where the bodies have no shape as `initial` says: see :class:`gbeam.Initial`.
    """
    tree, inputs = system.tree, system.inputs(np.asarray(time), motion)
    y, yd = system.start[0][tree.unknowns], system.start[1][tree.unknowns]
    undeformed = Point(tree, y, yd, np.zeros_like(y), inputs)
    refuse_massless(system, undeformed, masses(tree, y[None], yd[None], undeformed.driven())[0])
    begun, bent, accelerated = _solve_for_start(system, inputs, initial)
    y, yd = begun.q, _starting_rates(system, begun.q, yd, initial)
    if begun.adrift >= 0:
        body, fix = (
            system.coordinates[tree.unknowns[begun.adrift]].rpartition(".")[0],
            'begin with initial = "undeformed"',
        )
        raise ComputationError("no equilibrium", f"{body} has no place to rest at the start; {fix}")
    ydd = begun.qdd
    if initial.acceleration is not None or initial.moving or not (bent | accelerated).all():  # what was held is let go
        (ydd,) = accelerations(tree, y[None], yd[None], undeformed.driven())
    return Point(tree, y, yd, ydd, inputs)


def starting_state(system: System, motion: Motion | None, time: float, initial: Initial) -> tuple[Array, Array]:
    """Return the coordinates and rates (n,) of :func:`starting_point` for a system that JAX traces.

    They are NaN where the bodies have no shape at rest.
    """
    y = _solve_for_start(system, system.inputs(np.asarray(time), motion), initial)[0].q
    return y, _starting_rates(system, y, system.start[1][system.tree.unknowns], initial)


def _solve_for_start(system: System, inputs: Inputs, initial: Initial) -> tuple[Begun, Flags, Flags]:
    """Solve for the coordinates and accelerations of a start.

    Returns flags (n,), too, of the coordinates that were bent and of those that were accelerated. Bodies with displaced
    points take their shapes from these points. What remains to bend or accelerate is solved for.
    """
    tree, moved = system.tree, assign_to_bodies(system.flexible, initial.displaced)
    y, yd = system.start[0][tree.unknowns], system.start[1][tree.unknowns]
    bent, accelerated = unknown_at_start(system, initial.state)
    if initial.acceleration is not None:  # joints are held, and what floats deforms, too
        bodies = [_body_selection(system, name).any(axis=0) for name in system.flexible]
        bent, accelerated = np.any([bent, *bodies], axis=0), np.zeros_like(bent)
        inputs, yd = _accelerate_ground(inputs, np.asarray(initial.acceleration)), 0 * yd
    for name, components in moved.items():
        if components:
            selection = _body_selection(system, name)
            y = y + shape_of(system.flexible[name], components) @ selection
            is_held = ~selection.any(axis=0)
            bent, accelerated = bent & is_held, accelerated & is_held
    if not (bent | accelerated).any():
        return Begun(y, 0 * y), bent, accelerated
    if tree.closures:
        tree, bent = _loosened(system, tree.motion(y, yd, 0 * y, inputs), bent, accelerated)
    return solve_start(tree, y, yd, inputs, bent=bent, accelerated=accelerated), bent, accelerated


def _loosened(system: System, state: State, bent: Flags, accelerated: Flags) -> tuple[Tree, Flags]:
    """Tree, and flags (n,) of the coordinates that a start bends, by which loops stay closed as bodies bend: of the
    joints that are held, those that follow the others move along.
    """
    tree = system.tree
    is_held = ~(bent | accelerated)
    loosened = bent | (following(tree, state, is_held) & ~accelerated)
    # What holds the others is no part of the conditions' balance.
    weights = np.array(tree.weights)
    weights[tree.unknowns[~(loosened | accelerated)]] = 0.0
    return replace(tree, weights=weights), loosened


def _body_selection(system: System, name: str) -> Floats:
    """Selection matrix (m, n) of the m coordinates of a body among the free ones."""
    return (np.array(deforming(system.coordinates, name), dtype=int)[:, None] == system.tree.unknowns).astype(float)


def _starting_rates(system: System, y: Array, yd: Array, initial: Initial) -> Array:
    """Rates (n,) at coordinates y: `yd` of joints, and those of bodies by the initial velocities of their points."""
    for name, components in assign_to_bodies(system.flexible, initial.moving).items():
        if components:
            selection = _body_selection(system, name)
            yd = yd + rates_of(system.flexible[name], selection @ y, components) @ selection
    return yd


def _accelerate_ground(inputs: Inputs, acceleration: Floats) -> Inputs:
    """Return inputs by which the ground has this acceleration and nothing else, and joints rest."""
    ground, zero = inputs.ground, 0 * inputs.ground.w
    prescribed = inputs.prescribed
    return replace(
        inputs,
        ground=replace(ground, a=zero + acceleration, w=zero, alpha=zero),
        prescribed=None if prescribed is None else prescribed * np.array([[1.0], [0.0], [0.0]]),
    )


def unknown_at_start(system: System, initial: str) -> tuple[Flags, Flags]:
    """Flags (n,) of the free coordinates that a start bends and of those that it accelerates. The others are held.

    With `initial` = "equilibrium" joints hold what they move. Springs of a clamp bend as a body does, unless their
    start is given. Springs at the root of a body that deforms let it go, since it has no mass at the root by which it
    could be held. Bodies that float are undeformed.
    """
    bent, accelerated = list[bool](), list[bool]()
    for k in system.tree.unknowns:
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
