"""Motion of the base axes as the beam takes it: acceleration and rotation."""

from __future__ import annotations

from typing import Any

from gbeam.arrays.namespace import namespace
from gbeam.results.parts import Base as Base


def gradient(w_WB_B: Any, alpha_WB_B: Any) -> Any:
    """Growth of the acceleration along x of a base in rotation, base axes, (..., 3) 1/s² (2020 (4))."""
    xp = namespace(w_WB_B, alpha_WB_B)
    (wx, wy, wz), (_, aly, alz) = (xp.moveaxis(each, -1, 0) for each in (w_WB_B, alpha_WB_B))
    return xp.stack([-(wy**2 + wz**2), wx * wy + alz, wx * wz - aly], axis=-1)


def gradients(w_WB_B: Any, alpha_WB_B: Any) -> Any:
    """Gradients of the acceleration along x, y and z, in columns, (..., 3, 3) 1/s²: a(r) = a(0) + product with r."""
    xp = namespace(w_WB_B, alpha_WB_B)
    (wx, wy, wz), (alx, aly, alz) = (xp.moveaxis(each, -1, 0) for each in (w_WB_B, alpha_WB_B))
    along_y = xp.stack([wx * wy - alz, -(wz**2 + wx**2), wy * wz + alx], axis=-1)
    along_z = xp.stack([wx * wz + aly, wy * wz - alx, -(wx**2 + wy**2)], axis=-1)
    return xp.stack([gradient(w_WB_B, alpha_WB_B), along_y, along_z], axis=-1)
