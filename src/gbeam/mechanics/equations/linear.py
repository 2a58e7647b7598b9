"""The equations of a linear model: constant coefficients, plain sums over the particles.

A particle k of mass m sits at r = r0 + J q + ½ q H q in base axes. D'Alembert's sum Σ m (∂r/∂q)·a over the particles,
a = a_O + α × r + ω × (ω × r) + 2 ω × ṙ + r̈, kept to first order in (q, q̇, q̈), is

    M q̈ + (C + ω·G) q̇ + (K + ωω:K_ww + α·K_al + a_O·K_a) q = ωω:F_ww + α·F_al + a_O·F_a + loads.

For a model whose places end there (TLAM, FOAM, SFOAM) that is the whole truth; for a complete one the linearisation
about the straight beam. Nothing here knows a beam: a structure may say its masses, places and their first derivatives,
and in place of the second ones its geometric stiffness under unit inertial loads.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from gbeam.arrays.namespace import Array, as_array, concatenated, is_jax, namespace
from gbeam.arrays.tree import record
from gbeam.errors import InputError
from gbeam.guards.checks import damping_ratios
from gbeam.integrate.equations import LinearTerms
from gbeam.mechanics.fields.taylor import EPSILON, Places
from gbeam.numerics.eigen import symmetric_modes

PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))  # axes of six symmetric entries: xx, yy, zz, xy, yz, zx
NOTHING = 1e-13  # of the sizes of what is summed: less is rounding


@record
class Geometric:
    """Geometric stiffness at the static stress of unit inertial loads, by an acceleration `a` (3, n, n), an angular
    acceleration `al` (3, n, n) and pairs of angular velocities `ww` (3, 3, n, n).
    """

    a: Array
    al: Array
    ww: Array

    def turned(self, basis: Array) -> Geometric:
        """Geometric stiffness in coordinates p with q = basis p."""
        return Geometric(*(basis.T @ part @ basis for part in (self.a, self.al, self.ww)))

    def __add__(self, other: Geometric) -> Geometric:
        return Geometric(self.a + other.a, self.al + other.al, self.ww + other.ww)


@record
class LoadTerms:
    """Generalised forces of each load's six unit components at q: constant (loads, 6, 6 + n) + slope (loads, 6, 6 + n,
    n) q. The first six are the resultant force and moment at the root, the others the forces on the coordinates.
    """

    constant: Array
    slope: Array

    def generalised(self, q: Array, values: Array) -> Array:
        """Resultant at the root and forces on the coordinates under load components (..., loads, 6), (..., 6 + n)."""
        xp, n = namespace(self.constant, q, values), q.shape[-1]
        rows = xp.reshape(values, (*values.shape[:-2], -1))
        constant, slope = (xp.reshape(part, (rows.shape[-1], -1)) for part in (self.constant, self.slope))
        by_coordinate = xp.reshape(rows @ slope, (*rows.shape[:-1], -1, n))
        return rows @ constant + (by_coordinate * q[..., None, :]).sum(axis=-1)

    def turned(self, basis: Array) -> LoadTerms:
        """Terms in coordinates p with q = basis p."""

        def rows(part: Array) -> Array:
            xp = namespace(part, basis)
            return xp.concatenate([part[:, :, :6], xp.einsum("lcn...,nk->lck...", part[:, :, 6:], basis)], axis=2)

        return LoadTerms(rows(self.constant), rows(self.slope @ basis))


@record
class Bending:
    """Elastic forces of second and third order in modes p = basisᵀ q, (n, r), of which the first b, c, bend a body far.

    Among themselves these have the forces `drawn` (b, b, b) c c and `bent` (b, b, b, b) c c c, symmetric in the modes
    whose c they are multiplied by, while all others follow. They add `second` (b, b, r, r) c c to the stiffness of all
    modes. `places` (s, 3, b, b) are second derivatives of the places of stations.
    """

    basis: Array
    drawn: Array
    bent: Array
    second: Array
    places: Array

    @property
    def soft(self) -> Array:
        """Coordinates (n, b) of the modes that bend the body far."""
        return self.basis[:, : len(self.drawn)]

    def forces(self, q: Array) -> Array:
        """Forces (..., n) at coordinates (..., n)."""
        xp, c = namespace(self.basis, q), q @ self.soft
        forces = xp.einsum("kij,...k,...j->...i", self.drawn, c, c)
        return (forces + xp.einsum("klij,...k,...l,...j->...i", self.bent, c, c, c)) @ self.soft.T

    def slope(self, q: Array) -> Array:
        """Derivatives (n, n) of the forces at coordinates (n,)."""
        xp, c = namespace(self.basis, q), q @ self.soft
        slope = 2 * xp.einsum("kij,k->ij", self.drawn, c) + 3 * xp.einsum("klij,k,l->ij", self.bent, c, c)
        return self.soft @ slope @ self.soft.T

    def stiffness(self, q: Array) -> Array:
        """Stiffness (n, n) added at coordinates (n,), where all other modes move too."""
        xp, c = namespace(self.basis, q), q @ self.soft
        return self.basis @ xp.einsum("k,l,klij->ij", c, c, self.second) @ self.basis.T


@record
class Coefficients:
    """Constant coefficients of a linear model (2020 (16), (20)–(22); 2009 (24)–(34)). `rigid` (10,) is of the straight
    structure: mass, first moment, second moments xx, yy, zz, xy, yz, zx.
    """

    mass: Array
    damping: Array
    stiffness: Array
    gyroscopic: Array
    k_ww: Array
    k_al: Array
    k_a: Array
    f_ww: Array
    f_al: Array
    f_a: Array
    rigid: Array
    loads: LoadTerms | None = None
    bending: Bending | None = None

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return int(self.mass.shape[0])

    @property
    def second_moment(self) -> Array:
        """Moments of inertia (3, 3) of the straight structure about its root, kg m²."""
        xp = namespace(self.rigid)
        xx, yy, zz, xy, yz, zx = (self.rigid[4 + k] for k in range(6))
        rows = [[yy + zz, -xy, -zx], [-xy, zz + xx, -yz], [-zx, -yz, xx + yy]]
        return xp.stack([xp.stack(row) for row in rows])

    def evaluate(
        self, a_WO_B: Array, w_WB_B: Array, alpha_WB_B: Array, load_values: Array | None = None
    ) -> tuple[Array, Array, Array]:
        """C + G, K and F, (..., n, n) and (..., n), at base motions (..., 3) and load components (..., loads, 6)."""
        return self.terms.evaluate(self.features(a_WO_B, w_WB_B, alpha_WB_B, load_values))

    def frozen(
        self, a_WO_B: Array, w_WB_B: Array, alpha_WB_B: Array, load_values: Array | None = None
    ) -> tuple[Array, Array]:
        """C + G and K, (..., n, n), that decide whether the motion of an instant is stable.

        They are those of :meth:`evaluate`, without the skew part of α's stiffness: it feeds no energy.
        """
        xp = namespace(self.k_al, alpha_WB_B)
        velocity, stiffness, _ = self.evaluate(a_WO_B, w_WB_B, alpha_WB_B, load_values)
        skew = (self.k_al - xp.swapaxes(self.k_al, 1, 2)) / 2
        return velocity, stiffness - xp.tensordot(alpha_WB_B, skew, axes=1)

    @property
    def terms(self) -> LinearTerms:
        """Velocity (k, n, n), stiffness (k, n, n) and force (k, n) of a unit of each of the k :meth:`features`."""
        xp, n = namespace(self.mass, self.damping, self.stiffness), self.size
        k_ww = xp.reshape(self.k_ww, (9, *self.k_ww.shape[2:]))
        f_ww = xp.reshape(self.f_ww, (9, *self.f_ww.shape[2:]))
        stiffness = [self.stiffness[None], xp.zeros((3, n, n)), k_ww, self.k_al, self.k_a]
        force = [xp.zeros((4, n)), f_ww, self.f_al, self.f_a]
        if self.loads is not None:
            stiffness.append(-xp.reshape(self.loads.slope[:, :, 6:], (-1, n, n)))
            force.append(xp.reshape(self.loads.constant[:, :, 6:], (-1, n)))
        velocity = [self.damping[None], self.gyroscopic, xp.zeros((sum(map(len, stiffness)) - 4, n, n))]
        return LinearTerms(*map(xp.concatenate, (velocity, stiffness, force)))

    def features(self, a_WO_B: Array, w_WB_B: Array, alpha_WB_B: Array, load_values: Array | None = None) -> Array:
        """Quantities (..., k) that the coefficients are linear in, of base motions (..., 3): 1, ω, ω ωᵀ, α, a_O and
        load components.
        """
        xp, shape = namespace(a_WO_B, w_WB_B, load_values), w_WB_B.shape[:-1]
        w2 = w_WB_B[..., :, None] * w_WB_B[..., None, :]
        parts = [xp.ones((*shape, 1)), w_WB_B, xp.reshape(w2, (*shape, 9)), alpha_WB_B, a_WO_B]
        if load_values is not None and self.loads is not None:
            parts.append(xp.reshape(load_values, (*load_values.shape[:-2], -1)))
        return concatenated(parts)

    def residual(
        self,
        q: Array,
        qd: Array,
        qdd: Array,
        a_WO_B: Array,
        w_WB_B: Array,
        alpha_WB_B: Array,
        load_values: Array | None = None,
    ) -> Array:
        """Residual on a base whose motion is given, (..., n), or zero where the equations hold."""
        velocity, stiffness, force = self.evaluate(a_WO_B, w_WB_B, alpha_WB_B, load_values)
        internal = velocity @ qd[..., None] + stiffness @ q[..., None]
        residual = qdd @ self.mass + internal[..., 0] - force
        return residual if self.bending is None else residual + self.bending.forces(q)

    def elastic(self, q: Array) -> Array:
        """Elastic forces (..., n) at coordinates (..., n)."""
        linear = q @ self.stiffness
        return linear if self.bending is None else linear + self.bending.forces(q)

    def linearise(self, q: Array) -> Coefficients:
        """Return the coefficients of small departures from coordinates (n,)."""
        if self.bending is None:
            return self
        return replace(self, stiffness=self.stiffness + self.bending.stiffness(q), bending=None)

    def strain_energy(self, q: Array) -> Array:
        """½ qᵀKq, J."""
        return 0.5 * q @ self.stiffness @ q

    def turned(self, basis: Array) -> Coefficients:
        """Coefficients in coordinates p with q = basis p."""
        squares = ("mass", "damping", "stiffness", "gyroscopic", "k_ww", "k_al", "k_a")
        matrices = {name: basis.T @ getattr(self, name) @ basis for name in squares}
        forces = {name: getattr(self, name) @ basis for name in ("f_ww", "f_al", "f_a")}
        return replace(self, **matrices, **forces, loads=self.loads and self.loads.turned(basis))

    def damped(self, damping: Array) -> Coefficients:
        """Replace the damping matrix."""
        return replace(self, damping=damping)


def coefficients(
    mass: Array,
    places: Places,
    stiffness: Array,
    *,
    damping: Array | None = None,
    geometric: Geometric | None = None,
    loads: LoadTerms | None = None,
) -> Coefficients:
    """Sum a linear model's coefficients over particles (k,) kg; `geometric` replaces second derivatives of places."""
    xp = namespace(mass, places.r0, places.first, stiffness)
    r0, first = places.r0, places.first
    axes, n = r0.shape[1], first.shape[2]
    # Products of shapes for each pair of directions, (3, 3, n, n): one matrix product.
    rows = xp.reshape(first, (-1, axes * n))
    pairs = xp.reshape(_summed(xp, mass[:, None] * rows, rows), (axes, n, axes, n))
    pairs = xp.moveaxis(pairs, 2, 1)
    weighted = mass[:, None] * r0
    sums = xp.reshape(_summed(xp, mass[:, None], rows), (axes, n))
    moments = xp.moveaxis(xp.reshape(_summed(xp, weighted, rows), (axes, axes, n)), 0, 1)
    extra = geometric_by(mass, places) if geometric is None else geometric
    second = _summed(xp, weighted, r0)
    rigid = xp.stack(
        [
            mass.sum(),
            *weighted.sum(axis=0),
            *(second[i, j] for i, j in PAIRS),
        ]
    )
    zero = xp.zeros((n, n))
    return Coefficients(
        mass=xp.einsum("aaij->ij", pairs),
        damping=zero if damping is None else damping,
        stiffness=stiffness,
        gyroscopic=2 * _spin_up_coefficients(xp, pairs),
        k_ww=_spin_coefficients(xp, pairs) + extra.ww,
        k_al=_spin_up_coefficients(xp, pairs) + extra.al,
        k_a=extra.a,
        **inertial_forces(sums, moments),
        rigid=rigid,
        loads=loads,
    )


def inertial_forces(sums: Array, moments: Array) -> dict[str, Array]:
    """Coefficients f_ww, f_al and f_a of the forces that the root's motion exerts on the coordinates, by the sums
    Σ m ∂r_a/∂q (3, n) and the moments Σ m r_b ∂r_a/∂q (3, 3, n), a first.
    """
    xp = namespace(sums, moments)
    return {"f_ww": -_spin_coefficients(xp, moments), "f_al": -_spin_up_coefficients(xp, moments), "f_a": -sums}


def geometric_by(mass: Array, places: Places) -> Geometric:
    """Geometric stiffness by the second derivatives H of the places of particles (k,) kg."""
    xp = namespace(mass, places.r0, places.first, places.second)
    points, axes, n, _ = places.second.shape
    rows = xp.reshape(places.second, (points, -1))
    even, growing = _summed(xp, mass[:, None], rows), _summed(xp, mass[:, None] * places.r0, rows)
    return geometric_of(xp.reshape(even, (axes, n, n)), xp.reshape(growing, (-1, axes, n, n)))


def _summed(xp: Any, left: Array, right: Array) -> Array:
    """Sums leftᵀ right over the particles; under NumPy zero where terms cancel and only their rounding is left."""
    sums = left.T @ right
    if xp is not np:
        return sums
    sizes = (np.sqrt(np.einsum("ki,ki->i", columns, columns)) for columns in (left, right))
    return np.where(np.abs(sums) > NOTHING * np.multiply.outer(*sizes), sums, 0.0)


def geometric_of(even: Array, growing: Array) -> Geometric:
    """Geometric stiffness by the sums Σ m H, (3, n, n), and Σ m r0_b H, (3, 3, n, n), b first."""
    xp = namespace(even, growing)
    of_place = xp.swapaxes(growing, 0, 1)
    return Geometric(even, _spin_up_coefficients(xp, of_place), _spin_coefficients(xp, of_place))


def _spin_coefficients(xp: Any, x: Array) -> Array:
    """Coefficients (3, 3, ...) of ω ωᵀ in a·(ω × (ω × b)) = (a·ω)(b·ω) − a·b ω², symmetric in the two rates, where
    x[a, b, ...] holds the products of components of a and b.
    """
    trace = xp.einsum("aa...->...", x)
    ones = xp.reshape(xp.eye(3), (3, 3) + (1,) * (x.ndim - 2))
    return 0.5 * (x + xp.swapaxes(x, 0, 1)) - ones * trace


def _spin_up_coefficients(xp: Any, x: Array) -> Array:
    """Coefficients (3, ...) of α in a·(α × b), where x[a, b, ...] holds the products of components of a and b."""
    return xp.tensordot(xp.asarray(EPSILON), x, axes=((0, 2), (0, 1)))


def rest_modes(mass: Array, stiffness: Array) -> tuple[Array, Array]:
    """Circular frequencies (n,) rad/s, ascending, and mass-normalised modes (n, n) of a structure on a base at rest."""
    square, modes = symmetric_modes(stiffness, mass)
    xp = namespace(square)
    return xp.sqrt(xp.maximum(square, 0)), modes


def damping_matrix(ratio: Any, mass: Array, stiffness: Array) -> Array:
    """Modal damping matrix M Φ diag(2ζω) Φᵀ M, (n, n), of one ratio ζ, or of one ratio a mode,
    ascending in frequency.
    """
    n, ratio = mass.shape[0], as_array(ratio)
    if ratio.ndim and len(ratio) != n:
        raise InputError(
            "damping_ratio",
            f"lists {len(ratio)} values for the {n} modes of the model",
            f"give one value for all, or {n}, ascending in frequency",
        )
    if not is_jax(ratio):
        damping_ratios("damping_ratio", ratio)
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
    """Matrix M Φ diag(ω) Φᵀ M of all modes, differentiable also at equal frequencies.

    It is L √(L⁻¹KL⁻ᵀ) Lᵀ with M = LLᵀ: a root of a matrix, whose derivative solves a Sylvester equation.
    """
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
