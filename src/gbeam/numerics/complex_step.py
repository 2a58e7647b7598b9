"""Derivatives of NumPy functions without truncation error: a step along the imaginary axis."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

_STEP = 1e-30


def complex_step(
    function: Callable[[NDArray[np.complex128]], NDArray[np.complex128]], x: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Jacobian (m, n) of a function of a vector (n,) that is analytic and computes with complex numbers.

    f(x + ih) = f(x) + ih f'(x) − …: the imaginary part holds the derivative to rounding, whatever the step.
    """
    columns = []
    for k in range(len(x)):
        moved = x.astype(complex)
        moved[k] += 1j * _STEP
        columns.append(np.imag(function(moved)) / _STEP)
    return np.stack(columns, axis=-1)
