"""The beam of Zhang 2020 and its coefficients M, G, K, F as they should have been printed, from numpy alone.

Errata of the paper (from a scan: an erratum may be the scan's or the print's; either way the form used here is right)

 1  (8): EI_y with u2 and EI_z with u3 are swapped; (14) and (22) are right (a factor of 25 in stiffness)
 2  all integrals take ρ as mass per length; Table 1 gives kg/m³: ρA is meant (else inertia is 12500 times too large)
 3  (13a): the root covers the sine; sqrt(2/(ρL)) sin is meant. r_i is not given (it is −σ_i)
 4  (9)–(11): the index q = 1..3 hides i; (15a) ∂ρ̇_1i is ∂Q̇_1i
 5  (17): Q̇ for Q and Q̈; (ω_x ω_x + ω̇_y) is (ω_x ω_z + ω̇_y); +2ω_z∫ρΦ_1iΦ_2j Q̇_2j is missing
 6  (18): a_y^a is a_y^o; Q̇ for Q and Q̈; (ω_x ω_y − ω̇_x) is (ω_y ω_z − ω̇_x); −2ω_x∫Φ_2iΦ_1j is −2ω_z
 7  (19): a_y is a_z; (ω_x ω_x − ω̇_y) is (ω_x ω_z − ω̇_y), twice; (ω_y ω_z − ω̇_x)Q2 is (ω_y ω_z + ω̇_x)Q2
 8  (22): the inner integrals lack dσ and arguments; Φ_3y is Φ_3i. The signs of (20)–(22) are all right
 9  (20)–(22) hold blockwise only; F is missing
10  section 4: the control point lies on axes 2 and 3 (1 and 2 are parallel)
11  G is called damping; it is gyroscopic and skew. The model has no damping: every corner's vibration stays
12  arm, gravity, inverse kinematics, corners, time step, start and the profiles of Figs. 4 and 6 are not stated
13  a_C cannot be prescribed exactly at sharp corners
14  the shift from the control point to the root matters: test_variants_of_the_shift in tests/literature
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

Array = NDArray[np.float64]

# Table 1
LENGTH, WIDTH, THICKNESS = 0.3, 0.02, 0.004
DENSITY, YOUNG = 2700.0, 7e10
LINE = DENSITY * WIDTH * THICKNESS  # m = ρA, kg/m
INERTIA_Y, INERTIA_Z = WIDTH * THICKNESS**3 / 12, THICKNESS * WIDTH**3 / 12
G0 = 9.81  # the paper's static figures follow with this g
COUNTS = (1, 3, 3)


def shapes(x: Array) -> list[tuple[Array, Array, Array]]:
    """Φ, Φ', Φ'' of the three directions, normalised to ∫mΦ² dx = 1: (13), corrected."""
    n1, n2, _ = COUNTS
    k = (2 * np.arange(1, n1 + 1) - 1) * np.pi / (2 * LENGTH)
    z, root = np.outer(x, k), np.sqrt(2 / (LINE * LENGTH))
    bar = root * np.sin(z), root * k * np.cos(z), -root * k**2 * np.sin(z)
    lam = np.array([brentq(lambda z: np.cos(z) * np.cosh(z) + 1, (i - 0.9) * np.pi, (i - 0.1) * np.pi, xtol=1e-14)
                    for i in range(1, n2 + 1)])  # fmt: skip
    b, sigma = lam / LENGTH, (np.cosh(lam) + np.cos(lam)) / (np.sinh(lam) + np.sin(lam))
    z, norm = np.outer(x, b), (LINE * LENGTH) ** -0.5
    c, s, ch, sh = np.cos(z), np.sin(z), np.cosh(z), np.sinh(z)
    bend = (
        norm * (ch - c - sigma * (sh - s)),
        norm * b * (sh + s - sigma * (ch - c)),
        norm * b**2 * (ch + c - sigma * (sh + s)),
    )
    return [bar, bend, bend]


@dataclass(frozen=True)
class Matrices:
    """M, G, K, F of M Q̈ + G Q̇ + K Q = F, (16), (20)–(22) corrected, in the paper's coordinates Q, m √kg."""

    M: Array
    G: Array
    K: Array
    F: Array


def matrices(a0: Array, w: Array, al: Array) -> Matrices:
    """At a base motion: acceleration of O3, angular velocity and acceleration, components along the module's axes."""
    xi, weight = np.polynomial.legendre.leggauss(60)
    x, weight = (xi + 1) * LENGTH / 2, weight * LENGTH / 2
    phi, slope, curve = zip(*shapes(x), strict=True)
    wx, wy, wz = w
    (ax, ay, az), (alx, aly, alz) = a0, al

    def inner(f: Array, g: Array, density: Array | float = LINE) -> Array:
        return f.T @ ((weight * density)[:, None] * g)

    def mass(i: int, j: int) -> Array:
        return inner(phi[i], phi[j])

    def tension(i: int) -> Array:
        """Geometric stiffness −a0x D + (ωy² + ωz²) E: the load between x and the tip."""
        load = LINE * ((wy**2 + wz**2) * (LENGTH**2 - x**2) / 2 - ax * (LENGTH - x))
        return inner(slope[i], slope[i], load)

    f, g = [LINE * weight @ p for p in phi], [LINE * weight * x @ p for p in phi]
    area = WIDTH * THICKNESS
    M = [[mass(i, j) * (i == j) for j in range(3)] for i in range(3)]
    G = [
        [0 * mass(0, 0), -2 * wz * mass(0, 1), 2 * wy * mass(0, 2)],
        [2 * wz * mass(1, 0), 0 * mass(1, 1), -2 * wx * mass(1, 2)],
        [-2 * wy * mass(2, 0), 2 * wx * mass(2, 1), 0 * mass(2, 2)],
    ]
    K = [
        [
            inner(slope[0], slope[0], YOUNG * area) - (wy**2 + wz**2) * mass(0, 0),
            (wx * wy - alz) * mass(0, 1),
            (wx * wz + aly) * mass(0, 2),
        ],
        [
            (wx * wy + alz) * mass(1, 0),
            inner(curve[1], curve[1], YOUNG * INERTIA_Z) - (wx**2 + wz**2) * mass(1, 1) + tension(1),
            (wy * wz - alx) * mass(1, 2),
        ],
        [
            (wx * wz - aly) * mass(2, 0),
            (wy * wz + alx) * mass(2, 1),
            inner(curve[2], curve[2], YOUNG * INERTIA_Y) - (wx**2 + wy**2) * mass(2, 2) + tension(2),
        ],
    ]
    F = [-ax * f[0] + (wy**2 + wz**2) * g[0], -ay * f[1] - (wx * wy + alz) * g[1], -az * f[2] - (wx * wz - aly) * g[2]]
    return Matrices(np.block(M), np.block(G), np.block(K), np.concatenate(F))
