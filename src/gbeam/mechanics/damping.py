"""Modal damping of a structure on a base at rest."""

from __future__ import annotations

from typing import Any

import numpy as np

from gbeam.arrays.namespace import as_array, is_jax, namespace
from gbeam.errors import InputError
from gbeam.numerics.eigen import symmetric_modes

Array = Any


def rest_modes(mass: Array, stiffness: Array) -> tuple[Array, Array]:
    """Circular frequencies (n,) rad/s, ascending, and mass-normalised modes (n, n) of a structure on a base at rest."""
    square, modes = symmetric_modes(stiffness, mass)
    xp = namespace(square)
    return xp.sqrt(xp.maximum(square, 0)), modes


def damping_matrix(ratio: Any, mass: Array, stiffness: Array) -> Array:
    """Modal damping matrix M Φ diag(2ζω) Φᵀ M, (n, n), of one ratio or one per mode, ascending in frequency."""
    n, ratio = mass.shape[0], as_array(ratio)
    if ratio.ndim and len(ratio) != n:
        raise InputError(
            "damping_ratio",
            f"lists {len(ratio)} values for the {n} modes of the model",
            f"give one value for all, or {n}, ascending in frequency",
        )
    xp = namespace(ratio, mass, stiffness)
    if not is_jax(ratio) and not np.any(ratio):
        return xp.zeros((n, n))
    if xp is not np and ratio.ndim == 0:
        # With one ratio for all, 2ζ M √(M⁻¹K): a function of matrices that has a derivative where frequencies meet.
        return 2 * ratio * _weighted_root(mass, stiffness)
    frequency, modes = rest_modes(mass, stiffness)
    weighted = mass @ modes
    return (weighted * (2 * ratio * frequency)) @ weighted.T


def _weighted_root(mass: Array, stiffness: Array) -> Array:
    """M Φ diag(ω) Φᵀ M = L √(L⁻¹KL⁻ᵀ) Lᵀ with M = LLᵀ, differentiable also at equal frequencies."""
    import jax
    import jax.numpy as jnp

    @jax.custom_jvp
    def root(a: Array) -> Array:
        value, vector = jnp.linalg.eigh(a)
        return (vector * jnp.sqrt(jnp.maximum(value, 0))) @ vector.T

    @root.defjvp
    def _(primals: tuple[Array], tangents: tuple[Array]) -> tuple[Array, Array]:
        (a,), (da,) = primals, tangents
        value, vector = jnp.linalg.eigh(a)
        size = jnp.sqrt(jnp.maximum(value, 0))
        # X dX + dX X = dA, in the eigenvectors of A.
        change = (vector.T @ da @ vector) / (size[:, None] + size[None, :])
        return (vector * size) @ vector.T, vector @ change @ vector.T

    low = jnp.linalg.cholesky(mass)
    inverse = jnp.linalg.inv(low)
    return low @ root(inverse @ stiffness @ inverse.T) @ low.T
