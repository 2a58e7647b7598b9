"""The residual of a linear model as one product: of terms that know the motion, and of coefficients that know the beam.

    r = M q̈ + (C + ω·G) q̇ + (K + ωω:K_ww + α·K_al + a·K_a − loads) q − F = terms(q, q̇, q̈, base, loads) @ coefficients

Either factor may be differentiated with the other held: by the beam's values, or by those of the motion.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from gbeam.mechanics.equations.linear import Coefficients
from gbeam.motion.bases.base import Base

Array = Any
_I, _J = np.triu_indices(3)  # pairs of angular velocities, each once


def terms(q: Array, qd: Array, qdd: Array, base: Base, loads: Array | None) -> Array:
    """Terms (t, f) at coordinates and rates (t, n), base motions (t, 3) and load components (t, loads, 6)."""
    w = base.w_WB_B
    inputs = [w[:, _I] * w[:, _J], base.alpha_WB_B, base.a_WO_B]
    if loads is not None:
        inputs.append(loads.reshape(len(q), -1))
    u = np.concatenate(inputs, axis=1)
    return np.concatenate([qdd, qd, _outer(w, qd), q, _outer(u, q), u], axis=1)


def coefficient_matrix(c: Coefficients, *, loaded: bool) -> Array:
    """Coefficients (f, n) in the order of the terms."""
    twice = np.where(_I == _J, 1.0, 2.0)
    k = [twice[:, None, None] * c.k_ww[_I, _J], c.k_al, c.k_a]
    f = [twice[:, None] * c.f_ww[_I, _J], c.f_al, c.f_a]
    if loaded:
        assert c.loads is not None
        slope, constant = c.loads.slope[:, :, 6:], c.loads.constant[:, :, 6:]
        k.append(-slope.reshape(-1, *slope.shape[2:]))
        f.append(constant.reshape(-1, constant.shape[2]))
    own = [c.mass[None], c.damping[None], c.gyroscopic, c.stiffness[None], *k]
    rows = [np.swapaxes(each, 1, 2).reshape(-1, c.size) for each in own]
    return np.concatenate([*rows, *(-each for each in f)])


def _outer(u: Array, q: Array) -> Array:
    """Products u_i q_j, (t, i j)."""
    return (u[:, :, None] * q[:, None, :]).reshape(len(q), -1)
