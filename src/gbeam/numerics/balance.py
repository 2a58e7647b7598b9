"""Linear equations of rest in which some coordinates are accelerated in place of displaced."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
HELD = 1e-12  # of the largest stiffness: a smaller one holds nothing


def loose(stiffness: Floats, velocity: Floats) -> NDArray[np.bool_]:
    """Flags of the coordinates on which, and on whose rates, no force depends, by K and C (n, n)."""
    return np.asarray(~(stiffness.any(axis=0) | velocity.any(axis=0)))


def carried(mass: Floats, which: NDArray[np.bool_], *forces: Floats) -> tuple[Floats, ...]:
    """Forces (n, ...) with the inertia of some coordinates, accelerated so that theirs vanish."""
    inertia = mass[:, which] @ np.linalg.pinv(mass[which][:, which])
    return tuple(each - inertia @ each[which] for each in forces)


def pulled(residual: Floats, mass: Floats, which: NDArray[np.bool_]) -> Floats:
    """Accelerations (n,) of some coordinates alone, for which nothing of a residual (n,) is left on them."""
    faster = np.zeros_like(residual)
    faster[which] = -np.linalg.pinv(mass[which][:, which]) @ residual[which]
    return faster


def balanced(residual: Floats, stiffness: Floats, mass: Floats, which: NDArray[np.bool_]) -> tuple[Floats, Floats]:
    """Displacements and accelerations (n,) that answer a residual (n,): accelerations of some coordinates."""
    left, k = carried(mass, which, residual, stiffness)
    change: Any = np.linalg.lstsq(k, -left, rcond=HELD)[0]
    return change, pulled(residual + stiffness @ change, mass, which)
