"""A cantilever of straight frame elements in three dimensions, written for the tests: Euler's beam with Saint-Venant's
torsion (McGuire, Gallagher and Ziemian, Matrix Structural Analysis, 4.34), or Timoshenko's with shear and rotary
inertia (Przemieniecki, Theory of Matrix Structural Analysis, 5.116 and 11.63); bodies on rigid arms.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.linalg

Array = np.ndarray


class Frame(NamedTuple):
    """Stiffness and mass of a cantilever's free nodes, six coordinates each: u, v, w, and turns about x, y, z."""

    stiffness: Array
    mass: Array

    def frequencies(self, count: int) -> Array:
        """Lowest, Hz."""
        square = scipy.linalg.eigh(self.stiffness, self.mass, eigvals_only=True, subset_by_index=(0, count - 1))
        return np.sqrt(square) / (2 * np.pi)

    def deflection(self, acceleration: tuple[float, float, float]) -> Array:
        """Static displacement of the nodes (nodes, 6) on a root with this acceleration, m/s²."""
        rigid = np.tile(np.concatenate([acceleration, np.zeros(3)]), len(self.mass) // 6)
        return np.linalg.solve(self.stiffness, -self.mass @ rigid).reshape(-1, 6)


def cantilever(
    length: float,
    density: float,
    modulus: float,
    section: dict[str, float],
    *,
    shear_modulus: float,
    shear: tuple[float, float] | None = None,
    elements: int = 40,
    body: tuple[float, tuple[float, float, float]] | None = None,
) -> Frame:
    """Assemble a cantilever.

    Parameters
    ----------
    section : area, inertia_y (bends along z), inertia_z, torsion
    shear : coefficients along y and z of Timoshenko's beam; without them Euler's
    body : mass at the tip, and its arm from the axis
    """
    e, h = modulus, length / elements
    a, iy, iz, j = (section[name] for name in ("area", "inertia_y", "inertia_z", "torsion"))
    n = 6 * (elements + 1)
    stiffness, mass = np.zeros((2, n, n))
    line = density * a
    for i in range(elements):
        k, m = np.zeros((2, 12, 12))
        bar, rod = e * a / h, shear_modulus * j / h
        for at, value, inertia in ((0, bar, line), (3, rod, density * (iy + iz))):
            both = np.ix_([at, at + 6], [at, at + 6])
            k[both] += value * np.array([[1, -1], [-1, 1]])
            m[both] += inertia * h / 6 * np.array([[2, 1], [1, 2]])
        for ends, inertia, coefficient, sign in (
            ((1, 5, 7, 11), iz, shear and shear[0], 1),  # along y: turns about z
            ((2, 4, 8, 10), iy, shear and shear[1], -1),
        ):
            phi = 0.0 if coefficient is None else 12 * e * inertia / (coefficient * shear_modulus * a * h**2)
            turn = np.diag([1, sign, 1, sign])
            both = np.ix_(ends, ends)
            k[both] += turn @ _bending(phi, h) @ turn * e * inertia / h**3 / (1 + phi)
            m[both] += turn @ _moving(phi, h) @ turn * line * h / (1 + phi) ** 2
            if coefficient is not None:
                m[both] += turn @ _turning(phi, h) @ turn * density * inertia / h / (1 + phi) ** 2
        both = slice(6 * i, 6 * i + 12)
        stiffness[both, both] += k
        mass[both, both] += m
    if body is not None:
        weight, (x, y, z) = body
        arm = np.hstack([np.eye(3), np.array([[0, z, -y], [-z, 0, x], [y, -x, 0]])])
        mass[-6:, -6:] += weight * arm.T @ arm
    return Frame(stiffness[6:, 6:], mass[6:, 6:])


def _bending(phi: float, h: float) -> Array:
    return np.array(
        [
            [12, 6 * h, -12, 6 * h],
            [6 * h, (4 + phi) * h**2, -6 * h, (2 - phi) * h**2],
            [-12, -6 * h, 12, -6 * h],
            [6 * h, (2 - phi) * h**2, -6 * h, (4 + phi) * h**2],
        ]
    )


def _moving(phi: float, h: float) -> Array:
    a, b = 13 / 35 + 7 / 10 * phi + phi**2 / 3, (11 / 210 + 11 / 120 * phi + phi**2 / 24) * h
    c, d = 9 / 70 + 3 / 10 * phi + phi**2 / 6, (13 / 420 + 3 / 40 * phi + phi**2 / 24) * h
    f, g = (1 / 105 + phi / 60 + phi**2 / 120) * h**2, (1 / 140 + phi / 60 + phi**2 / 120) * h**2
    return np.array([[a, b, c, -d], [b, f, d, -g], [c, d, a, -b], [-d, -g, -b, f]])


def _turning(phi: float, h: float) -> Array:
    a, b = 6 / 5, (1 / 10 - phi / 2) * h
    f, g = (2 / 15 + phi / 6 + phi**2 / 3) * h**2, (1 / 30 + phi / 6 - phi**2 / 6) * h**2
    return np.array([[a, b, -a, b], [b, f, -b, -g], [-a, -b, a, -b], [b, -g, -b, f]])
