"""Equations of a linear body contracted with the motions that its root can have, which are often few.

A linear body's equations are sums over features of its root's motion: a, α and the products of ω. On a hub that turns
about one axis all of these follow from θ̈ and θ̇², and the hub's row is one component of the wrench at the root. With the
features φ, the components w of ω and the twists τ of the root that the unknown coordinates before it can make,

    along = M q̈ + C q̇ + w G q̇ + K q + φ (f + F q),
    row   = φ (c + c1 q + ½ q c2 q) + (S1 + S2 q)·q̈ + q̇ S2 q̇ + w (g + g1 q)·q̇,

with constants that are contractions of the body's coefficients: one matrix product for all that multiply q.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from gbeam.arrays.namespace import Array, namespace
from gbeam.arrays.tree import record, static
from gbeam.arrays.types import Floats
from gbeam.mechanics.equations.linear import PAIRS, Coefficients
from gbeam.mechanics.fields.taylor import EPSILON
from gbeam.mechanics.fields.vectors import joined

PARALLEL, INDEPENDENT = 1e-9, 1e-3  # of a column's size: what is left of one that depends on others, or does not
ROUNDING = 1e-12  # of the largest part of a sum: a smaller one is none
LARGEST = 40  # columns of n each that multiply q: of more, the sums of a root that moves in any way are faster

Pivots = tuple[int, ...]


@dataclass(frozen=True)
class Reach:
    """Components that determine a carrier's motion, and that of a root on it as sums of these.

    They are its `features` of (ω ωᵀ, α, a), its `spin` of ω and its `twists` of (velocity, angular velocity). The rows
    `of_features` (k, 12), `of_spin` (k, 3) and `of_twists` (k, 6) give the root's.
    """

    features: Pivots
    spin: Pivots
    twists: Pivots
    of_features: Floats
    of_spin: Floats
    of_twists: Floats


@dataclass(frozen=True)
class Roots:
    """Samples of a frame's motion, (s, k) each: `features` (ω ωᵀ, α, a), the `spin` ω, and `twists`.

    Twists are what unknown accelerations of coordinates add to the frame's acceleration and angular acceleration.
    """

    features: Floats
    spin: Floats
    twists: Floats

    @classmethod
    def from_frames(cls, frame: Any, pushed: Any) -> Roots:
        """Sample a `frame`, and the same one, `pushed` by other accelerations of the unknown coordinates."""
        w, alpha, a = (_cleared(vectors) for vectors in (frame.w, frame.alpha, frame.a))
        squares = np.stack([w[:, i] * w[:, j] for i, j in PAIRS], axis=-1)
        twists = [_cleared(pushed.a - frame.a), _cleared(pushed.alpha - frame.alpha)]
        return cls(np.concatenate([squares, alpha, a], axis=-1), w, np.concatenate(twists, axis=-1))

    def reach(self, root: Roots) -> Reach | None:
        """Find components that determine this motion, and that of a `root` by these,
        or None where they are in doubt.
        """
        features = _span(self.features, root.features)
        spin = _span(self.spin, root.spin)
        twists = _span(self.twists, root.twists)
        if features is None or spin is None or twists is None:
            return None
        return Reach(features[0], spin[0], twists[0], features[1], spin[1], twists[1])


def _cleared(vectors: Floats) -> Floats:
    """Vectors (s, 3) with zero in place of components that are rounding."""
    sizes = np.abs(vectors).max(axis=0)
    return np.where(sizes > ROUNDING * sizes.max(), vectors, 0.0)


def _span(samples: Floats, targets: Floats) -> tuple[Pivots, Floats] | None:
    """Components that determine all others of the vectors `samples` (s, m), and rows by which they give the vectors
    `targets` (s, l).

    Components are chosen by Gram and Schmidt's method. None if some are nearly dependent, or do not determine
    `targets`.
    """
    if not (np.isfinite(samples).all() and np.isfinite(targets).all()):
        return None
    residual, pivots, sizes = samples.copy(), list[int](), np.sqrt((samples**2).sum(axis=0))
    for k in np.flatnonzero(sizes):
        size = math.sqrt(residual[:, k] @ residual[:, k])
        if PARALLEL * sizes[k] < size < INDEPENDENT * sizes[k]:
            return None
        if size >= INDEPENDENT * sizes[k]:
            direction = residual[:, k] / size
            residual -= direction[:, None] * (direction @ residual)
            pivots.append(int(k))
    rows = np.linalg.lstsq(samples[:, pivots], targets, rcond=None)[0]
    parts, largest = np.abs(rows) * np.abs(samples).max(axis=0)[pivots, None], np.abs(targets).max(axis=0)
    if (np.abs(samples[:, pivots] @ rows - targets) > PARALLEL * largest).any():
        return None
    return tuple(pivots), np.where(parts <= ROUNDING * largest, 0.0, rows)


def _root_features(features: Pivots, a: Array, w: Array, alpha: Array) -> Array:
    """One, and the components `features` of a root's (ω ωᵀ, α, a), (..., 1 + f)."""
    parts: list[Any] = [1.0]
    for k in features:
        if k < 6:
            i, j = PAIRS[k]
            parts.append(w[..., i] * w[..., j])
        elif k < 9:
            parts.append(alpha[..., k - 6])
        else:
            parts.append(a[..., k - 9])
    return joined(namespace(a, w), tuple(parts), np.broadcast_shapes(a.shape[:-1], w.shape[:-1]))


@record
class RigidRows:
    """Wrench at the root of a rigid body, `rows` (1 + f, 6) by one and the components `features` of its motion: those
    of its components that the tree asks for.
    """

    rows: Array
    features: Pivots = static()

    def wrench(self, a: Array, w: Array, alpha: Array) -> Array:
        """Force and moment (..., 6)."""
        return _root_features(self.features, a, w, alpha) @ self.rows


def rigid_rows(mass: Any, S: Floats, J: Floats, reach: Reach) -> RigidRows:
    """Contract mass, first moment (3,) and moments of inertia (3, 3) about its root with what a body's root can do."""
    by_mass, by_S, by_J = _factors(reach.of_twists)
    rows = reach.of_features @ (mass * by_mass + by_S @ S + np.einsum("tkab,ab->tk", by_J, J)).T
    rows = np.concatenate([0 * rows[:1], rows]) if len(rows) else np.zeros((1, len(by_mass)))
    return RigidRows(rows @ np.eye(6)[list(reach.twists)], reach.features)


def _factors(twists: Floats) -> tuple[Floats, Floats, Floats]:
    """Factors of mass (t, 12), first moment (t, 12, 3) and moments of inertia (t, 12, 3, 3) in a work.

    Each of twelve features demands a wrench of a rigid body. The work is that of this wrench along `twists` (t, 6).
    """
    by_mass, by_S, by_J = (np.tensordot(twists, factors, 1) for factors in _unit_factors())
    return by_mass, by_S, by_J


@cache
def _unit_factors() -> tuple[Floats, Floats, Floats]:
    """Factors, as :func:`_factors` returns them, of unit components of a twist (velocity V and angular velocity Ω)."""
    unit, (V, turns) = np.eye(3), np.eye(6).reshape(6, 2, 3).swapaxes(0, 1)
    across, whirl = (np.einsum("abc,tb->tca", EPSILON, vector) for vector in (V, turns))  # v × e_c and Ω × e_c
    by_mass, by_S, by_J = np.zeros((6, 12)), np.zeros((6, 12, 3)), np.zeros((6, 12, 3, 3))
    for k, (i, j) in enumerate(PAIRS):
        for first, second in {(i, j), (j, i)}:
            by_S[:, k] += np.cross(across[:, first], unit[second])
            by_J[:, k, :, second] += whirl[:, first]
    by_S[:, 6:9] = across
    for k in range(3):
        by_J[:, 6 + k, :, k] = turns
        by_S[:, 9 + k] = np.cross(unit[k], turns)
    by_mass[:, 9:] = V
    return by_mass, by_S, by_J


@record
class Contraction:
    """Constants of a linear body's equations on a root whose motion is told by few components.

    These are the f − 1 `features` of (ω ωᵀ, α, a), the s − 1 components `spin` of ω and the t `twists` of (velocity,
    angular velocity). `of_q` and `of_qd` (n, k n) hold k matrices (n, n) side by side, by which q and q̇ are multiplied.
    `constant` (k n,) is what q = 0 has in place of q `of_q`. `rigid` (f, t) are factors of 1 and the features.
    """

    mass: Array
    of_q: Array
    of_qd: Array
    constant: Array
    rigid: Array
    loads: Array
    places: Array
    features: Pivots = static()
    spin: Pivots = static()
    twists: Pivots = static()

    def demanded(self, q: Array, qd: Array, qdd: Array, a: Array, w: Array, alpha: Array) -> tuple[Array, Array]:
        """Forces on the coordinates (..., n), and the components `twists` of the wrench at the root, (..., t).

        Each constant is contracted once with q or q̇; what results is multiplied by the features of the root's motion.
        """
        xp, n, t = namespace(q, qd, qdd, a, w, self.of_q), q.shape[-1], len(self.twists)
        features = _root_features(self.features, a, w, alpha)  # φ, (..., f), the first of which is 1
        spin = joined(xp, (1.0, *(w[..., k] for k in self.spin)), w.shape[:-1])  # 1 and w, (..., s)
        f, s = features.shape[-1], spin.shape[-1]
        # One product with q and one with q̇ hold all blocks (..., n): of each feature one for the forces along the
        # coordinates and one for each twist; then, of q, one for each twist by q̈, and by each w and q̇.
        by_q, by_qd = q @ self.of_q + self.constant, qd @ self.of_qd
        end = f * (1 + t) * n
        feature_blocks = by_q[..., :end].reshape(*by_q.shape[:-1], f, (1 + t) * n)
        spin_blocks = by_qd[..., : s * n].reshape(*by_qd.shape[:-1], s, n)
        by_features = xp.einsum("...f,...fk->...k", features, feature_blocks)
        generalised = qdd @ self.mass + by_features[..., :n] + xp.einsum("...k,...kn->...n", spin, spin_blocks)
        if not t:
            return generalised, by_features[..., :0]
        gyro_blocks = by_q[..., end + t * n :].reshape(*by_q.shape[:-1], s - 1, t * n)
        by_rates = by_qd[..., s * n :] + xp.einsum("...k,...kn->...n", spin[..., 1:], gyro_blocks)
        products = (by_features[..., n:], q), (by_q[..., end : end + t * n], qdd), (by_rates, qd)
        return generalised, features @ self.rigid + sum(_dots(slopes, rates, t) for slopes, rates in products)


def _dots(left: Array, right: Array, rows: int) -> Array:
    """Products (..., rows) of vectors side by side, (..., rows n), with one vector (..., n)."""
    xp, vectors = namespace(left, right), left.reshape(*left.shape[:-1], rows, right.shape[-1])
    return xp.einsum("...jn,...n->...j", vectors, right)


def contraction(c: Coefficients, reach: Reach, *, felt: bool) -> Contraction | None:
    """Contract coefficients with what a body's root can do, or None where that is so much that it would not be faster.

    Unless deforming is `felt`, the root feels no rates of the coordinates.
    """
    phi, W, T = reach.of_features, reach.of_spin, reach.of_twists
    n, f, s, t = c.size, 1 + len(phi), len(W), len(T)
    if f * (1 + t) + t + s * t > LARGEST:
        return None
    # By the twelve features: symmetric products of ω, α and a.
    unit = np.eye(3)
    products = np.array([(np.outer(unit[i], unit[j]) + np.outer(unit[j], unit[i])) / (1 + (i == j)) for i, j in PAIRS])
    stiffness = _combine(phi, np.concatenate([np.tensordot(products, c.k_ww, 2), c.k_al, c.k_a]))
    force = _combine(phi, np.concatenate([np.tensordot(products, c.f_ww, 2), c.f_al, c.f_a]))
    # Derivatives of the first moment of mass, of the moments of inertia and of the momentum.
    S, S1, S2, J, J1, J2, h, h1 = (
        c.rigid[1:4],
        -c.f_a,
        c.k_a,
        c.second_moment,
        2 * c.f_ww,
        -2 * c.k_ww,
        -c.f_al,
        c.k_al,
    )
    by_mass, by_S, by_J = _factors(T)
    rigid = c.rigid[0] * by_mass + by_S @ S + np.einsum("tkab,ab->tk", by_J, J)
    slope = by_S @ S1 + np.einsum("tkab,abn->tkn", by_J, J1)
    bend = np.einsum("tka,anm->tknm", by_S, S2) + np.einsum("tkab,abnm->tknm", by_J, J2)
    rigid, slope, bend = (_combine(phi, values.swapaxes(0, 1)) for values in (rigid, slope, bend))
    V, turns = T[:, :3], T[:, 3:]
    of_mass = np.tensordot(V, S2, 1) + np.tensordot(turns, h1, 1)
    # Of each component of ω and twist: 2 (v × e)·Ṡ + Ω·J̇ e + (Ω × e)·h.
    across, whirl = (np.einsum("abc,tb->cta", EPSILON, vectors) for vectors in (V, turns))
    gyro = 2 * across @ S1 + np.einsum("ta,akn->ktn", turns, J1) + whirl @ h
    gyro_slope = 2 * np.tensordot(across, S2, 1) + np.einsum("ta,aknm->ktnm", turns, J2) + np.tensordot(whirl, h1, 1)
    share = 1.0 if felt else 0.0
    gyro, gyro_slope, drawn = share * _combine(W, gyro), share * _combine(W, gyro_slope), share * of_mass
    by_feature = np.zeros((f, 1 + t, n, n))
    by_feature[0, 0], by_feature[1:, 0], by_feature[1:, 1:] = c.stiffness, stiffness, bend / 2
    constant = np.zeros((f, 1 + t, n))
    constant[1:, 0], constant[1:, 1:] = -force, slope
    return Contraction(
        mass=c.mass,
        of_q=_columns(by_feature, of_mass, gyro_slope),
        of_qd=_columns(c.damping, _combine(W, c.gyroscopic), drawn),
        constant=np.concatenate([constant.ravel(), (V @ S1 + turns @ h).ravel(), gyro.ravel()]),
        rigid=np.concatenate([np.zeros((1, t)), rigid]),
        loads=T.T,
        places=np.eye(6)[list(reach.twists)],
        features=reach.features,
        spin=reach.spin,
        twists=reach.twists,
    )


def _combine(rows: Floats, values: Floats) -> Floats:
    """Sums (k, ...) of values (m, ...) by rows (k, m)."""
    return np.tensordot(rows, values, 1)


def _columns(*matrices: Array) -> Array:
    """Matrix (n, k n) by which a row q has products M q with matrices (..., n, n), one after the other."""
    n = matrices[0].shape[-1]
    return np.ascontiguousarray(np.concatenate([matrix.reshape(-1, n) for matrix in matrices]).T)
