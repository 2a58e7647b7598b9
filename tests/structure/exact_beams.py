"""Frequencies of Euler-Bernoulli beams from their transcendental equations, independent of gbeam."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy import special
from scipy.optimize import brentq

Array = NDArray[np.float64]
# The beam of 2009 Table 1.
LENGTH, DENSITY, AREA, MODULUS, INERTIA = 8.0, 2766.7, 7.2968e-5, 6.8952e10, 8.2189e-9
EI, RHO_A = MODULUS * INERTIA, DENSITY * AREA


def roots(determinant: Callable[[float], float], count: int, start: float, stride: float) -> Array:
    """First roots of a function, found by its changes of sign."""
    answer: list[float] = []
    low, before = start, determinant(start)
    while len(answer) < count:
        high = low + stride
        after = determinant(high)
        if before * after < 0:
            answer.append(float(brentq(determinant, low, high, xtol=1e-14, rtol=1e-14)))
        low, before = high, after
    return np.array(answer)


def waves(x: float, beta: float, length: float) -> Array:
    """Derivatives 0 to 3, over powers of β, of e^{−βx}, e^{β(x−L)}, cos βx, sin βx: (4, 4)."""
    decay, grow, c, s = np.exp(-beta * x), np.exp(beta * (x - length)), np.cos(beta * x), np.sin(beta * x)
    return np.array([[decay, grow, c, s], [-decay, grow, -s, c], [decay, grow, -c, -s], [-decay, grow, s, -c]])


def with_bodies(
    count: int,
    *,
    mass: float = 0.0,
    inertia: float = 0.0,
    offset: float = 0.0,
    at: float | None = None,
    rotation: float = np.inf,
    translation: float = np.inf,
) -> Array:
    """Circular frequencies, rad/s, of the uniform beam with a tip body, or a mass at `at`, and root springs.

    Tip: −EI w''' = ω² m (w + d w'), EI w'' = ω² [J w' + m d (w + d w')]; root: EI w'' = k w', EI w''' = −k w;
    a jump of EI w''' by ω² m w at a mass in mid-span.
    """

    def determinant(beta: float) -> float:
        square = EI * beta**4 / RHO_A
        power = beta ** np.arange(4)[:, None]
        root, tip = (waves(x, beta, LENGTH) * power for x in (0.0, LENGTH))
        first = root[1] if np.isinf(rotation) else EI * root[2] / rotation - root[1]
        second = root[0] if np.isinf(translation) else EI * root[3] / translation + root[0]
        m, j, d = (0.0, 0.0, 0.0) if at is not None else (mass, inertia, offset)
        centre = tip[0] + d * tip[1]
        shear = EI * tip[3] + square * m * centre
        bending = EI * tip[2] - square * (j * tip[1] + m * d * centre)
        rows = [first, second, shear, bending]
        if at is not None:
            shape, none = waves(at, beta, LENGTH) * power, np.zeros(4)
            rows = [np.append(row, none) for row in rows[:2]] + [np.append(none, row) for row in rows[2:]]
            rows += [np.append(shape[k], -shape[k]) for k in range(3)]
            rows.append(np.append(EI * shape[3] + square * mass * shape[0], -EI * shape[3]))
        scaled = np.array([row / np.abs(row).max() for row in rows])
        return float(np.linalg.det(scaled))

    return np.sqrt(EI / RHO_A) * roots(determinant, count, 0.02, 0.01) ** 2


def truncated_wedge(count: int, length: float, root: float, tip: float, modulus: float, density: float) -> Array:
    """Circular frequencies, rad/s, of a cantilever of constant width whose thickness falls from `root` to `tip`, m.

    Kirchhoff 1879: w = x^{-1/2} Z₁(2k√x) with J, Y, I, K for Z, x from the wedge's point.
    """
    start = length * tip / (root - tip)
    slope = tip / start

    def determinant(k: float) -> float:
        def z(n: int, x: float) -> Array:
            at = 2 * k * np.sqrt(x)
            return np.array([special.jv(n, at), special.yv(n, at), special.iv(n, at), special.kv(n, at)])

        end = start + length
        rows = [
            z(1, end),
            z(2, end) * [-1, -1, 1, -1],
            z(3, start),
            z(2, start) * [1, 1, 1, -1],
        ]
        columns = np.abs(rows).max(axis=0)
        return float(np.linalg.det(np.array(rows) / columns))

    # k⁴ = ρA ω² / EI at x = 1, where A/I = 12/slope².
    return roots(determinant, count, 0.1, 0.02) ** 2 * slope * np.sqrt(modulus / (12 * density))
