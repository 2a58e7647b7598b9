"""A beam of cubic Hermite elements on a moving base: small displacements about the straight beam, in base axes.

Virtual work of d'Alembert's forces in a rotating frame, with the tension that they make in the straight beam. Stretch u
and deflections v and w are cubic in every element, each with its value and slope at the nodes as unknowns. Nothing is
shared with gbeam: no shapes, no particles, no foreshortening.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.linalg

Function = Callable[[np.ndarray], np.ndarray]
_XI, _WEIGHT = np.polynomial.legendre.leggauss(6)
_FINE, _FINE_WEIGHT = np.polynomial.legendre.leggauss(40)


class HermiteBeam:
    """Matrices of a clamped beam with a mass at its tip.

    Parameters
    ----------
    length : float
        m.
    area, inertia_y, inertia_z : callable
        Section at positions x: m², and ∫z² dA, ∫y² dA, m⁴.
    density, modulus, tip_mass : float
        kg/m³, Pa, kg.
    elements : int
    """

    def __init__(
        self,
        length: float,
        area: Function,
        inertia_y: Function,
        inertia_z: Function,
        density: float,
        modulus: float,
        tip_mass: float = 0.0,
        elements: int = 40,
    ) -> None:
        size, h = 2 * elements + 2, length / elements
        self._x = np.concatenate([(k + (_XI + 1) / 2) * h for k in range(elements)])
        self._weight = np.tile(_WEIGHT * h / 2, elements)
        value, slope, curvature = np.zeros((3, len(self._x), size))
        for k in range(elements):
            rows, columns = slice(6 * k, 6 * k + 6), slice(2 * k, 2 * k + 4)
            value[rows, columns], slope[rows, columns], curvature[rows, columns] = _cubics((_XI + 1) / 2, h)
        clamped = np.s_[:, 2:]  # value and slope of the root's deflections are zero
        self._slope = {"u": slope[:, 1:], "v": slope[clamped], "w": slope[clamped]}
        self._value = {"u": value[:, 1:], "v": value[clamped], "w": value[clamped]}
        self._curvature = curvature[clamped]
        self._tip = {name: np.eye(block.shape[1])[-2] for name, block in self._value.items()}
        self._tip_mass, self._length = tip_mass, length
        self._line = density * area(self._x)
        self._moments = self._beyond(lambda x: density * area(x))
        stretch = self._sum(modulus * area(self._x), self._slope["u"], self._slope["u"])
        bend_y = self._sum(modulus * inertia_z(self._x), self._curvature, self._curvature)
        bend_z = self._sum(modulus * inertia_y(self._x), self._curvature, self._curvature)
        self._elastic = scipy.linalg.block_diag(stretch, bend_y, bend_z)
        # ∫ρA d_i d_j of directions i and j, and ∫ρA d_i, ∫ρA x d_i, with the mass at the tip.
        names = ("u", "v", "w")
        self._pairs = [[self._inertia(a, b) for b in names] for a in names]
        self._first = [self._loads(name, np.ones_like(self._x), 1.0) for name in names]
        self._second = [self._loads(name, self._x, length) for name in names]
        self.mass = self._blocks(np.eye(3))

    def _beyond(self, line: Function) -> tuple[np.ndarray, np.ndarray]:
        """Mass and first moment of what lies beyond each point, kg, kg m."""
        half = (self._length - self._x)[:, None] / 2
        x = self._x[:, None] + half * (_FINE + 1)
        weight = half * _FINE_WEIGHT * line(x)
        return weight.sum(axis=1) + self._tip_mass, (weight * x).sum(axis=1) + self._tip_mass * self._length

    def _sum(self, factor: np.ndarray, left: np.ndarray, right: np.ndarray) -> np.ndarray:
        return (left * (self._weight * factor)[:, None]).T @ right

    def _inertia(self, a: str, b: str) -> np.ndarray:
        at_tip = self._tip_mass * np.outer(self._tip[a], self._tip[b])
        return self._sum(self._line, self._value[a], self._value[b]) + at_tip

    def _loads(self, name: str, factor: np.ndarray, at_tip: float) -> np.ndarray:
        return (self._weight * self._line * factor) @ self._value[name] + self._tip_mass * at_tip * self._tip[name]

    def _blocks(self, operator: np.ndarray) -> np.ndarray:
        return np.block([[operator[i, j] * self._pairs[i][j] for j in range(3)] for i in range(3)])

    def on_base(
        self, a: np.ndarray, w: np.ndarray, alpha: np.ndarray | None = None
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Gyroscopic matrix, stiffness and force at the root's acceleration, the rate and its derivative, base axes."""
        turn = _cross(np.zeros(3) if alpha is None else alpha) + _cross(w) @ _cross(w)
        mass, moment = self._moments
        tension = -(a[0] * mass + turn[0, 0] * moment)
        stressed = [self._sum(tension, self._slope[name], self._slope[name]) for name in ("v", "w")]
        geometric = scipy.linalg.block_diag(np.zeros_like(self._pairs[0][0]), *stressed)
        force = -np.concatenate([a[i] * self._first[i] + turn[i, 0] * self._second[i] for i in range(3)])
        return self._blocks(2 * _cross(w)), self._elastic + geometric + self._blocks(turn), force

    def frequencies(self, a: np.ndarray, w: np.ndarray, count: int, directions: str = "uvw") -> np.ndarray:
        """Lowest circular frequencies on a base in steady motion, rad/s, of some of the unknowns."""
        names = np.repeat(list("uvw"), [len(block) for block in self._first])
        kept = np.ix_(*[np.isin(names, list(directions))] * 2)
        gyroscopic, stiffness, mass = (each[kept] for each in (*self.on_base(a, w)[:2], self.mass))
        if not gyroscopic.any():
            return np.sqrt(scipy.linalg.eigh(stiffness, mass, eigvals_only=True, subset_by_index=(0, count - 1)))
        lower = -np.linalg.solve(mass, np.hstack([stiffness, gyroscopic]))
        value = np.linalg.eigvals(np.vstack([np.eye(len(mass), 2 * len(mass), len(mass)), lower]))
        return np.sort(value.imag[value.imag > 0])[:count]

    def static(self, a: np.ndarray, w: np.ndarray, alpha: np.ndarray | None = None) -> np.ndarray:
        """Displacement of the tip in steady motion, (3,) m."""
        _, stiffness, force = self.on_base(a, w, alpha)
        return self.tip(np.linalg.solve(stiffness, force))

    def tip(self, d: np.ndarray) -> np.ndarray:
        """Displacement of the tip of unknowns (..., n), (..., 3) m."""
        ends = np.cumsum([len(block) for block in self._first])
        return d[..., ends - 2]

    def history(self, base: Callable[[float], tuple[np.ndarray, ...]], times: np.ndarray) -> np.ndarray:
        """Displacement of the tip from rest, (t, 3) m, by the trapezoidal rule (Newmark's) at equal steps.

        `base` gives (a, w, alpha) at a time.
        """
        h = times[1] - times[0]
        d, rate = np.zeros((2, len(self.mass)))
        acceleration = np.linalg.solve(self.mass, self.on_base(*base(times[0]))[2])
        tips = [self.tip(d)]
        for t in times[1:]:
            gyroscopic, stiffness, force = self.on_base(*base(t))
            foreseen, foreseen_rate = d + h * rate + h**2 / 4 * acceleration, rate + h / 2 * acceleration
            effective = self.mass + h / 2 * gyroscopic + h**2 / 4 * stiffness
            acceleration = np.linalg.solve(effective, force - stiffness @ foreseen - gyroscopic @ foreseen_rate)
            d, rate = foreseen + h**2 / 4 * acceleration, foreseen_rate + h / 2 * acceleration
            tips.append(self.tip(d))
        return np.array(tips)


def _cubics(s: np.ndarray, h: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Values, slopes and curvatures of the four Hermite cubics at s in 0 … 1 of an element of length h, (s, 4)."""
    value = [1 - 3 * s**2 + 2 * s**3, h * (s - 2 * s**2 + s**3), 3 * s**2 - 2 * s**3, h * (s**3 - s**2)]
    slope = [-6 * s + 6 * s**2, h * (1 - 4 * s + 3 * s**2), 6 * s - 6 * s**2, h * (3 * s**2 - 2 * s)]
    curvature = [-6 + 12 * s, h * (-4 + 6 * s), 6 - 12 * s, h * (6 * s - 2)]
    return np.transpose(value), np.transpose(slope) / h, np.transpose(curvature) / h**2


def _cross(v: np.ndarray) -> np.ndarray:
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])
