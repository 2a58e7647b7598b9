"""Rigid bases: rotations, and the motion at another point."""

from __future__ import annotations

from typing import Any

import numpy as np

from gbeam.arrays.namespace import holds_jax, namespace
from gbeam.arrays.types import Floats
from gbeam.errors import InputError
from gbeam.guards.checks import vector
from gbeam.results.parts import Base


def shift_base(base: Base, offset: Any) -> Base:
    """Return the motion at another point (3,) m of the same rigid base: a + α × r + ω × (ω × r)."""
    xp = namespace(base.a_WO_B, base.w_WB_B, offset)
    r = xp.broadcast_to(xp.asarray(offset, dtype=float), base.w_WB_B.shape)
    by_rotation = xp.cross(base.alpha_WB_B, r) + xp.cross(base.w_WB_B, xp.cross(base.w_WB_B, r))
    return Base(base.a_WO_B + by_rotation, base.w_WB_B, base.alpha_WB_B)


def rotation_of(turn: Any) -> Floats:
    """Rotation matrix of a rotation vector, rad."""
    from scipy.spatial.transform import Rotation  # 0.2 s to import, which few motions need

    return np.asarray(Rotation.from_rotvec(turn).as_matrix())


def turn_of(turn: Any) -> tuple[float, float, float]:
    """Return a rotation vector as three numbers, rad; InputError if it is none, or traced by JAX."""
    if holds_jax(turn):
        raise InputError("turn", "is traced by JAX", "give three numbers")
    x, y, z = map(float, vector("turn", turn))
    return x, y, z
