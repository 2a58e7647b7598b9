"""Linear equations of rest in which some coordinates are accelerated in place of displaced."""

from __future__ import annotations

from typing import Any

import numpy as np

from gbeam.arrays.types import Flags, Floats

HELD = 1e-12  # of the largest stiffness, scaled: a smaller one holds nothing
STRIDE = 0.3  # m, rad or strain
SAME = 1e-8  # of what a rotation changes where nothing is accelerated anew: less is rounding


def loose(stiffness: Floats, velocity: Floats) -> Flags:
    """Flags of the coordinates on which, and on whose rates, no force depends, by K and C (n, n)."""
    return np.asarray(~(stiffness.any(axis=0) | velocity.any(axis=0)))


def keeps_turning(k: Floats, mass: Floats, faster: Floats, is_light: Flags, turn: Flags) -> bool:
    """True if a body can go on turning as the accelerations `faster` (n,) of its light coordinates turn with it.

    `turn` flags the one or three coordinates of its rotation. By K and M (n, n), turning may change no force but the
    directions of these accelerations.
    """
    (pulled_forces,) = carried(mass, is_light, k)
    size = np.abs(k) + np.abs(k - pulled_forces) + np.abs(mass)
    moved = pulled(k, mass, is_light)[turn][:, turn] + following(faster[turn])
    decoupled = np.abs(pulled_forces[:, turn]).max() <= SAME * size[:, turn].max()
    return bool(decoupled and np.abs(moved).max() <= SAME * (1.0 + np.abs(faster[turn]).max()))


def following(alpha: Floats) -> Floats:
    """Derivative of an angular acceleration (1,) or (3,), axes of a body, as it turns on: none about a fixed axis."""
    return np.cross(alpha, np.eye(3)).T if len(alpha) == 3 else np.zeros((1, 1))


def carried(mass: Floats, is_light: Flags, *forces: Floats) -> tuple[Floats, ...]:
    """Forces (n, ...) plus the inertia of the light coordinates.

    These, flagged in `is_light`, are so accelerated that the forces on them vanish.
    """
    inertia = mass[:, is_light] @ np.linalg.pinv(mass[is_light][:, is_light])
    return tuple(force - inertia @ force[is_light] for force in forces)


def pulled(residual: Floats, mass: Floats, is_light: Flags) -> Floats:
    """Accelerations (n, ...) of the coordinates `is_light` alone that leave nothing of a residual (n, ...) on them."""
    faster = np.zeros_like(residual)
    faster[is_light] = -np.linalg.pinv(mass[is_light][:, is_light]) @ residual[is_light]
    return faster


def rooted(mass: Floats) -> Floats:
    """Square roots (n,) of the largest entry in each row of M (n, n); 1 where a coordinate moves no inertia."""
    root = np.sqrt(np.abs(mass).max(axis=1, initial=0.0))
    return np.asarray(np.where(root > 0, root, 1.0))


def scales(stiffness: Floats, mass: Floats) -> Floats:
    """Units (n,) of displacement in which stiffness is judged: of unit kinetic energy, smaller where it is stiff."""
    unit = 1.0 / rooted(mass)
    square = np.abs(np.diag(stiffness)) * unit**2  # rad²/s² of each alone
    # What is stiffer than the geometric mean of the stiffest and 1/s² counts as that, so that it hides nothing soft.
    ceiling = max(1.0, float(np.sqrt(square.max(initial=0.0))))
    return np.asarray(unit * np.sqrt(np.minimum(1.0, ceiling / np.maximum(square, 1.0))))


def answered(stiffness: Floats, mass: Floats, forces: Floats) -> Floats:
    """Least displacements (n,), in the units of :func:`scales`, under forces (n,), along what the stiffness holds."""
    size = scales(stiffness, mass)
    answer: Any = np.linalg.lstsq(size[:, None] * stiffness * size, size * forces, rcond=HELD)[0]
    return np.asarray(size * answer)


def unheld(stiffness: Floats, mass: Floats) -> Floats:
    """Orthogonal directions (n, k) of forces that no stiffness balances, judged in the units of :func:`scales`."""
    size = scales(stiffness, mass)
    directions, sizes, _ = np.linalg.svd(size[:, None] * stiffness * size)
    return np.linalg.qr(size[:, None] * directions[:, sizes <= HELD * sizes.max(initial=0.0)])[0]


def relaxation(residual: Floats, stiffness: Floats, mass: Floats, is_free: Flags) -> Floats:
    """Displacements (n,) of a step down the forces of a residual (n,), with the coordinates `is_free` accelerated.

    They are about STRIDE where the forces are large, and those of Newton's method near a state that the stiffness
    holds.
    """
    is_held = ~is_free
    force, k, m = carried(mass, is_free, residual, stiffness, mass)
    force, k, m = force[is_held], k[is_held][:, is_held], m[is_held][:, is_held]
    acceleration, square = np.linalg.solve(m, force), np.linalg.eigvals(np.linalg.solve(m, k))
    # With so much inertia added, the stiffness is positive, and no coordinate moves far.
    shift = max(0.0, -2 * square.real.min(initial=0.0)) + np.abs(acceleration).max(initial=0.0) / STRIDE
    change = np.zeros_like(residual)
    change[is_held] = np.linalg.solve(k + (shift + HELD * np.abs(square).max(initial=0.0)) * m, -force)
    return change


def balanced(residual: Floats, stiffness: Floats, mass: Floats, is_free: Flags) -> tuple[Floats, Floats]:
    """Displacements (n,), and accelerations (n,) of the coordinates `is_free`, that balance a residual (n,)."""
    remaining, k = carried(mass, is_free, residual, stiffness)
    k[:, is_free] = 0.0  # of slides already; a rotation that changes nothing else keeps its angle
    change = answered(k, mass, -remaining)
    return change, pulled(residual + stiffness @ change, mass, is_free)
