"""The symmetric eigenproblem, and small oscillations about an equilibrium."""

from __future__ import annotations

from functools import cached_property
from typing import Any, ClassVar, NamedTuple

import numpy as np

from gbeam.arrays.namespace import Array, namespace
from gbeam.arrays.types import Complex, Flags, Floats, Indices
from gbeam.numerics.whirl import Whirl


def symmetric_modes(stiffness: Array, mass: Array) -> tuple[Array, Array]:
    """Eigenvalues (..., n), ascending, and eigenvectors (..., n, n) in columns, of unit length in M."""
    xp = namespace(stiffness, mass)
    scale = xp.linalg.inv(xp.linalg.cholesky(mass))
    transposed = xp.swapaxes(scale, -1, -2)
    value, vector = xp.linalg.eigh(scale @ stiffness @ transposed)
    return value, transposed @ vector


def positive_definite(matrices: Array) -> bool:
    """True if the symmetric parts of all matrices (..., n, n) are positive definite, by Cholesky's factors."""
    try:
        np.linalg.cholesky(matrices + np.swapaxes(matrices, -1, -2))
    except np.linalg.LinAlgError:
        return False
    return True


def symmetric(matrices: Array) -> Array:
    """The symmetric parts of matrices (..., n, n)."""
    return (matrices + namespace(matrices).swapaxes(matrices, -1, -2)) / 2


ZERO = 1e-11  # of the largest eigenvalue: a smaller one is rounding about zero
RIGID = 1e-7  # likewise of systems, in which motions that nothing holds are the roots of rounding
# Of a mode's frequency: a base that speeds up, once frozen, feeds or drains a mode by 1e-7, and means nothing by it.
FLUTTER = 1e-6
NONE = 1e-13  # of the largest stiffness: a smaller one is none
EQUAL = 1e-9  # of an eigenvalue: two that differ by less are one
UNSYMMETRIC = 1e-9  # of K: above it the loads follow the beam


def growth_limit(value: Complex, largest: float) -> Floats:
    """Real parts, 1/s, above which eigenvalues (k,) count as growing. `largest` is the largest size of all."""
    return np.maximum(np.where(value.imag != 0, FLUTTER * np.abs(value), 0.0), ZERO * largest)


def eigenvalues(
    mass: Floats, velocity: Floats, stiffness: Floats, *, gyroscopic: bool = True
) -> tuple[Complex, Complex]:
    """Eigenvalues λ and modes of M ÿ + C ẏ + K y = 0, matrices (n, n)."""
    damping = velocity if gyroscopic else (velocity + velocity.T) / 2
    free, held = _separate_free(mass, damping, stiffness)
    value, mode = _constrained_eigenvalues(*(held.T @ matrix @ held for matrix in (mass, damping, stiffness)))
    mode = held @ mode
    if free.shape[1]:
        # Free motions N a follow: λ² a + Nᵀ K N a = −Nᵀ (λ C + K) y, with thrust that turns with the body in Nᵀ K N.
        pull = free.T @ (value * (damping @ mode) + stiffness @ mode)
        inertia = value[:, None, None] ** 2 * np.eye(free.shape[1]) + free.T @ stiffness @ free
        inertia[value == 0] = np.eye(free.shape[1])  # any, of a motion that stays: no force belongs to it
        mode = mode - free @ np.linalg.solve(inertia, pull.T[..., None])[..., 0].T
    weight = np.sqrt(np.einsum("ik,ij,jk->k", mode.conj(), mass, mode).real)
    return value, mode / weight


def _separate_free(mass: Floats, damping: Floats, stiffness: Floats) -> tuple[Floats, Floats]:
    """Bases, in columns, of the free motions (n, d) and of all others, orthogonal to them in M. Forces on the others
    depend neither on free motions nor on their rates, so that the others are a problem of their own. Free motions are
    found one after the other: a body that turns with its thrust is accelerated by it, and by nothing else.
    """
    held: Any = np.linalg.inv(np.linalg.cholesky(symmetric(mass))).T
    free = held[:, :0]
    while held.shape[1]:
        k, c = (held.T @ matrix @ held for matrix in (stiffness, damping))
        size = np.abs(k).max()
        _, sizes, directions = np.linalg.svd(np.concatenate([k / (size or 1.0), c / np.sqrt(size or 1.0)]))
        loose = sizes <= NONE
        if not loose.any():
            break
        free = np.concatenate([free, held @ directions[loose].T], axis=1)
        held = held @ directions[~loose].T
    return free, held if free.shape[1] else np.eye(len(mass))


def _constrained_eigenvalues(mass: Floats, damping: Floats, stiffness: Floats) -> tuple[Complex, Complex]:
    """Eigenvalues and modes of :func:`eigenvalues` where no motion is free."""
    # In modes of the symmetric part, each scaled by its own frequency, all blocks are of the size of the frequencies:
    # the raw companion matrix loses half the digits of the low ones.
    square, basis = symmetric_modes(symmetric(stiffness), symmetric(mass))
    reference = np.sqrt(np.abs(square).max(initial=0.0))
    scale = np.maximum(np.sqrt(np.abs(square)), 1e-6 * reference or 1.0)
    k, c = basis.T @ stiffness @ basis, basis.T @ damping @ basis
    n = len(square)
    is_moving = np.abs(k).max(axis=0, initial=0.0) > NONE * reference**2
    a = np.block([[np.zeros((n, n)), np.diag(scale)], [-k / scale, -c]])
    keep = np.concatenate([is_moving, np.ones(n, dtype=bool)])
    value, vector = np.linalg.eig(a[np.ix_(keep, keep)])
    # The velocities hold a mode also where its coordinate was dropped.
    return value, basis @ vector[len(vector) - n :]


class Linear(NamedTuple):
    """M δÿ + C δẏ + K δy = B δu; C holds damping and gyroscopic coupling. (n, n), (n, n), (n, n), (n, inputs)."""

    mass: Array
    velocity: Array
    stiffness: Array
    inputs: Array

    def state_space(self, by_y: Floats, by_yd: Floats, by_ydd: Floats, by_u: Floats) -> tuple[Floats, ...]:
        """A, B, C and D with the states (δy, δẏ), of outputs with derivatives (m, n) by y, ẏ and ÿ, and by u."""
        k, c, b = (np.linalg.solve(self.mass, x) for x in (self.stiffness, self.velocity, self.inputs))
        state = np.block([[np.zeros_like(k), np.eye(len(k))], [-k, -c]])
        drive = np.concatenate([np.zeros_like(b), b])
        output = np.concatenate([by_y - by_ydd @ k, by_yd - by_ydd @ c], axis=1)
        return state, drive, output, by_ydd @ b + by_u


class Vibrations(NamedTuple):
    """Eigenvalues and modes of a system's motions.

    `value` (k,) 1/s are the eigenvalues of oscillating motions, one of each pair, the slowest first, with modes (n, k).
    Eigenvalues `diverging` and modes `divergence` are those of motions that grow without oscillating. Eigenvalues of
    motions that decay so, and the size of the largest of all, are held besides.
    """

    value: Complex
    modes: Complex
    diverging: Complex
    divergence: Complex
    decaying: Floats
    largest: float

    def oscillating(self, chosen: Any) -> Vibrations:
        """Return the vibrations with only the oscillating modes `chosen`, indices or flags."""
        return self._replace(value=self.value[chosen], modes=self.modes[:, chosen])

    @property
    def frequency(self) -> Floats:
        """Natural frequencies, rad/s."""
        return np.abs(self.value)

    @property
    def flutter(self) -> Flags:
        """Flags of those that oscillate and grow."""
        return np.asarray(self.value.real > growth_limit(self.value, self.largest))

    @property
    def growing(self) -> Complex:
        """Eigenvalues 1/s of all that grows, the fastest first."""
        growing = np.concatenate([self.diverging, self.value[self.flutter]])
        return np.asarray(growing[np.argsort(-growing.real, kind="stable")])


def vibrations(linear: Linear, *, gyroscopic: bool = True, zero: float = ZERO) -> Vibrations:
    """Small motions about an equilibrium, without eigenvalues less than a share `zero` of the largest."""
    value, mode = eigenvalues(*linear[:3], gyroscopic=gyroscopic)
    size = float(np.abs(value).max(initial=0.0))
    is_moving, real = np.abs(value) > zero * size, np.abs(value.imag) <= ZERO * size

    def chosen(which: Flags) -> tuple[Complex, Complex]:
        order = np.flatnonzero(is_moving & which)
        order = order[np.argsort(np.abs(value[order]), kind="stable")]
        return value[order], _separate_equal(value[order], mode[:, order], linear.mass)

    decaying = np.sort(value[is_moving & real & (value.real < 0)].real)
    return Vibrations(*chosen(~real & (value.imag > 0)), *chosen(real & (value.real > 0)), decaying, size)


def _separate_equal(value: Complex, modes: Complex, mass: Floats) -> Complex:
    """Modes (n, k), equal eigenvalues side by side, with one reproducible basis for each group of equal ones.

    Two equal beams have such groups. The basis is orthonormal in the mass, along the principal axes of a mass weighted
    by coordinate number.
    """
    starts = np.flatnonzero(np.abs(np.diff(value)) > EQUAL * np.abs(value[1:])) + 1
    separated = modes.copy()
    weight = np.sqrt(np.arange(1.0, len(mass) + 1))
    for group in np.split(np.arange(len(value)), starts):
        if len(group) > 1:
            basis = modes[:, group]
            basis = basis @ np.linalg.inv(np.linalg.cholesky(basis.conj().T @ mass @ basis)).conj().T
            weighed = weight[:, None] * basis
            separated[:, group] = basis @ np.linalg.eigh(weighed.conj().T @ mass @ weighed)[1]
    return separated


def unsymmetric(stiffness: Floats) -> bool:
    """True if a stiffness (n, n) is that of loads that follow the beam, and feed it or take from it."""
    return bool(np.abs(stiffness - stiffness.T).max() > UNSYMMETRIC * np.abs(stiffness).max())


def stability_margin(mass: Floats, velocity: Floats, stiffness: Floats, zero: float = 0.0) -> float:
    """Number that is positive while nothing grows.

    It is the lowest eigenvalue of K in M, rad²/s², with the share `zero` of the largest added, which is rounding. Where
    K is unsymmetric it is found by the real parts of all eigenvalues, 1/s.
    """
    if not unsymmetric(stiffness):
        square = symmetric_modes(symmetric(stiffness), symmetric(mass))[0]
        return float(square[0] + zero * np.abs(square).max())
    value, _ = eigenvalues(mass, velocity, stiffness)
    return float((growth_limit(value, np.abs(value).max()) - value.real).min()) if value.size else 0.0


class Steady:
    """A steady state of a structure or of a system, and small departures from it."""

    zero: ClassVar[float]  # of the largest eigenvalue: a smaller one is none
    first: int  # index of the first coordinate by which modes are recognised

    @property
    def linear(self) -> Linear:
        """M, C, K and B of small departures."""
        raise NotImplementedError

    @property
    def names(self) -> list[str]:
        """Names of the coordinates by which modes are recognised, those that deform a body ``body.q1``."""
        raise NotImplementedError

    @property
    def bend(self) -> float:
        """Largest bend of a body whose stiffness is of first order in it, as a share of its length."""
        raise NotImplementedError

    @property
    def whirl(self) -> Whirl | None:
        """Points as they turn in the ground frame, or None where nothing turns."""
        raise NotImplementedError

    def directions(self, modes: Complex) -> tuple[str, ...]:
        """Words for what each mode (n, k) moves most."""
        raise NotImplementedError

    @property
    def motions(self) -> Floats | None:
        """Motions (n, k) of all coordinates by those of `linear`, or None where these are all."""
        return None

    def vibrations(self, *, gyroscopic: bool = True) -> Vibrations:
        """Vibrations, growing and decaying motions about it, with modes of all coordinates."""
        moving = vibrations(self.linear, gyroscopic=gyroscopic, zero=max(self.zero, ZERO))
        if self.motions is None:
            return moving
        return moving._replace(modes=self.motions @ moving.modes, divergence=self.motions @ moving.divergence)

    @cached_property
    def moving(self) -> Vibrations:
        """Vibrations with gyroscopic coupling."""
        return self.vibrations()

    @property
    def margin(self) -> float:
        """Positive while nothing grows: see :func:`stability_margin`."""
        return stability_margin(*self.linear[:3], self.zero**2)


def matched(likeness: Floats) -> tuple[Indices, Floats]:
    """For each row of MACs (k, l) the column that it resembles most, each of them once, −1 for none; and their MAC."""
    rows, columns = np.arange(len(likeness)), likeness.argmax(axis=1)
    if len(set(columns)) < len(columns):  # two want the same one
        from scipy.optimize import linear_sum_assignment

        rows, columns = linear_sum_assignment(-likeness)
    match, value = np.full(len(likeness), -1), np.full(len(likeness), np.nan)
    match[rows], value[rows] = columns, likeness[rows, columns]
    return match, value


def growth_rate(mass: Floats, velocity: Floats, stiffness: Floats) -> float:
    """Real part of the eigenvalue that grows fastest, 1/s, or zero where none grows."""
    value, _ = eigenvalues(mass, velocity, stiffness)
    return float(value.real.max(where=value.real > growth_limit(value, np.abs(value).max(initial=0.0)), initial=0.0))


def mac(first: Complex, second: Complex, mass: Floats) -> Floats:
    """Modal assurance criteria |φᴴMψ|²/(φᴴMφ ψᴴMψ) of modes in rows, (k, l)."""
    left, right = (np.einsum("ki,ij,kj->k", x.conj(), mass, x).real for x in (first, second))
    return np.abs(first.conj() @ mass @ second.T) ** 2 / np.outer(left, right)
