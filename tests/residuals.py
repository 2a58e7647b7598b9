"""The equations of structures as functions of numbers, which NumPy evaluates and JAX can compile."""

from __future__ import annotations

from typing import Any

import numpy as np

from gbeam import Hub, Structure
from gbeam.results import Base
from validation.residuals import hinged

from .differences import jacobian
from .specimens import HUB_INERTIA, HUB_RADIUS

Array = Any
HUB = Hub(radius=HUB_RADIUS, inertia=HUB_INERTIA, gravity=(0.0, 0.0, 0.0))
MOUNTED: dict[str, Any] = {"pointing": "inward", "setting_angle": 0.7, "gravity": (3.0, -7.0, -5.0)}
MOUNTED_HUB = Hub(radius=HUB_RADIUS, inertia=HUB_INERTIA, stiffness=30.0, damping=4.0, **MOUNTED)


def base_residual(structure: Structure, q: Array, qd: Array, qdd: Array, base: Base, loads: Array) -> Array:
    return structure.equations.residual(q, qd, qdd, base.a_WO_B, base.w_WB_B, base.alpha_WB_B, loads)


def hub_residual(
    structure: Structure, hub: Hub, y: Array, yd: Array, ydd: Array, torque: Array, loads: Array
) -> tuple[Array, Array]:
    residual = hinged(structure, hub)

    def hub_row(acceleration: Array) -> Array:
        return residual(y, 0 * yd, acceleration, (torque, loads))[0]

    # The row of the mass matrix, times the rates.
    return residual(y, yd, ydd, (torque, loads)), hub_row(yd) - hub_row(0 * yd)


def _values(structure: Structure, loaded: bool) -> Array:
    values = structure.load_values
    return values if loaded or values is None else 0 * values


def on_base(structure: Structure, q: Array, qd: Array, qdd: Array, base: Base, *, loaded: bool = False) -> np.ndarray:
    """Residual on a base whose motion is given, with or without the structure's loads."""
    return np.asarray(base_residual(structure, q, qd, qdd, base, _values(structure, loaded)))


def on_hub(
    structure: Structure, y: Array, yd: Array, ydd: Array, torque: float = 0.0, *, hub: Hub = HUB, loaded: bool = False
) -> tuple[np.ndarray, float]:
    """Residual on a free hub, y = (θ, q), and its angular momentum."""
    values, momentum = hub_residual(structure, hub, y, yd, ydd, np.asarray(torque), _values(structure, loaded))
    return np.asarray(values), float(momentum)


def gravity_potential(structure: Structure, hub: Hub, y: Array) -> Array:
    """Energy of the beam in the hub's gravity, J; of a linear model to second order in q."""
    mount, total = hub.mount, structure.mass.sum()
    first = structure.mass @ structure.particles.positions(y[1:])
    x, y_, z = mount.R_HB @ first + total * mount.radius * np.array([1.0, 0, 0])
    c, s = np.cos(y[0]), np.sin(y[0])
    return -mount.gravity @ np.stack([c * x - s * y_, s * x + c * y_, z])


def virtual_work(structure: Structure, q: Array) -> np.ndarray:
    """Resultant of the structure's loads at the root, base axes, and their forces on the coordinates, (6 + n,).

    F·δr + M·δθ from the places and the rotations themselves.
    """
    work, values = structure.work, structure.load_values
    assert work is not None and values is not None
    place, attitude = work.field.positions, work.field.rotation
    r, R, slope, turn = place(q), attitude(q), jacobian(place, q), jacobian(attitude, q)
    spin = np.einsum("pabi,pcb->paci", turn, R)
    spin = 0.5 * (spin - np.swapaxes(spin, 1, 2))  # of polynomials, whose products leave a symmetric part
    angle = np.stack([spin[:, 2, 1], spin[:, 0, 2], spin[:, 1, 0]], axis=1)
    axes = np.where(work.follower[:, None, None], R, np.eye(3))
    force, moment = (
        np.einsum("p,pab,pb->pa", work.weight, axes, part) for part in np.split(values[work.load], 2, axis=1)
    )
    along = np.einsum("pai,pa->i", slope, force) + np.einsum("pai,pa->i", angle, moment)
    return np.concatenate([force.sum(axis=0), (np.cross(r, force) + moment).sum(axis=0), along])
