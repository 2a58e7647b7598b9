"""Steps fitted to the vibration at rest: what they add to mass and damping, so that its phase and decay are exact.

A scheme multiplies a vibration e^λt by R(λh) in a step h, which is e^λh to its order only: lightly damped, it is
delayed more with every cycle. With μ/h in place of λ, R(μ) = e^λh, it keeps its time. Mass and damping are changed
so; stiffness and forces stay as they are, and with them the deflection under slow loads. The changes are of the
scheme's order in h, and so is the error that remains, of forces and of frequencies that the motion of the base
changes. Such methods are known as exponentially fitted (Gautschi, 1961).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gbeam.integrate.equations import LinearEquations
from gbeam.integrate.schemes import Scheme
from gbeam.numerics.eigen import symmetric_modes

FITTED = 2.0  # rad in a step, up to which a mode is fitted; a faster one takes what that one does

Floats = NDArray[np.float64]


def added(equations: LinearEquations, scheme: Scheme, step: float) -> tuple[Floats, Floats]:
    """Matrices (n, n) that steps of a length (s) add to M and C; zero of a scheme that does not fit."""
    if scheme.exponent is None or equations.rest is None:
        nothing = np.zeros(np.shape(equations.mass))
        return nothing, nothing
    damping, stiffness = equations.rest
    square, modes = symmetric_modes(stiffness, equations.mass)
    frequency = np.sqrt(np.maximum(square, 0.0))
    rate = np.einsum("ia,ij,ja->a", modes, damping, modes)
    fits = (frequency > 0) & (np.abs(rate) < 2 * frequency)
    frequency, rate, modes = frequency[fits], rate[fits], modes[:, fits]
    angle = np.minimum(frequency * step, FITTED)
    ratio = rate / (2 * frequency)
    z = angle * (-ratio + 1j * np.sqrt(1 - ratio**2))
    mu = scheme.exponent(z)
    # μ² m + μ h c + (ω h)² = 0 with the mode's own stiffness.
    mass = np.abs(z / mu) ** 2
    slower = np.divide(mu.real, z.real, out=np.ones_like(ratio), where=ratio > 0)
    shapes = equations.mass @ modes
    return shapes * (mass - 1) @ shapes.T, shapes * (rate * (slower * mass - 1)) @ shapes.T
