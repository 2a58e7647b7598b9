"""Relative equilibrium of the beam at a frozen base motion."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from gbeam.arrays.namespace import Array, is_jax
from gbeam.errors import ComputationError
from gbeam.guards.arguments import typed
from gbeam.mechanics.equations.linear import Coefficients
from gbeam.mechanics.structure import Structure
from gbeam.numerics.eigen import positive_definite, stability_margin
from gbeam.results.parts import Base

_ITERATIONS = 30  # of Newton's method
_LOCATED, _SHORTEST = 1e-4, 1e-6  # strides, shares of the load: that locates a loss of stability; that is the least
_NEAR = 1e-6  # of the beam's length: a stride that ends so near to its prediction has not left the path
_NOISE = 1e-8  # of the coordinates: smaller corrections may not shrink, by rounding


class Equilibrium(NamedTuple):
    """Coordinates (n,) at which the beam rests, and True if it would stay there: see :func:`keeps`."""

    q: Array
    stable: bool


@typed
def solve_equilibrium(structure: Structure, base: Base, time: float | None = None) -> Equilibrium:
    """Coordinates at which the beam rests relative to a base whose motion is frozen, under its loads, stable or not.

    A linear model's equations are solved at once; others by Newton's method, along a path of growing load where one
    stride fails.

    Parameters
    ----------
    structure : Structure
    base : Base
        Of one time: arrays (3,).
    time : float, optional
        Time at which the beam's loads are taken, s; without, those that the structure has, of time zero or of its
        :meth:`~gbeam.Structure.at_time`.

    Returns
    -------
    Equilibrium
        Where JAX traces the structure, the base or the loads, NaN if there is none, and stability is not judged.

    Raises
    ------
    ComputationError
        ``not converged``, with the share of the load that was reached.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    >>> structure = gb.assemble(beam, "FOAM", axial=1, y=2, z=2)
    >>> base = gb.Hub(radius=0.5, rate=20.0).base(0.0)
    >>> equilibrium = gb.solve_equilibrium(structure, base)
    >>> print(f"{1e6 * structure.tip(equilibrium.q)[0]:.3f} µm")
    0.495 µm
    """
    structure = structure if time is None else structure.at_time(time)
    frozen = base.a_WO_B, base.w_WB_B, base.alpha_WB_B, structure.load_values
    if not (structure.traced or any(map(is_jax, frozen))):
        return equilibrium_about(structure, base)[0]
    import jax.numpy as jnp

    from gbeam.mechanics.equations.compiled import resting

    if structure.linear:
        return Equilibrium(jnp.linalg.solve(*structure.coefficients.at(*frozen)[1:]), True)
    return Equilibrium(resting(structure.residual(), base, structure.load_values), True)


@np.errstate(all="ignore")  # a stride may end at coordinates beyond all numbers, and then fails
def equilibrium_about(structure: Structure, base: Base) -> tuple[Equilibrium, Coefficients]:
    """Relative equilibrium, and the coefficients about it; ComputationError if there is none."""
    values = structure.load_values
    if not structure.linear:
        return _along_a_path(structure, base, values)
    c = structure.coefficients
    _, stiffness, force = c.at(base.a_WO_B, base.w_WB_B, base.alpha_WB_B, values)
    q = _solved(stiffness, force)
    if c.bending is not None:
        q = _bent(c, base, values, q)
        c = c.about(q)
        stiffness = c.at(base.a_WO_B, base.w_WB_B, base.alpha_WB_B, values)[1]
    if np.isfinite(q).all():
        stable = positive_definite(stiffness) if values is None else keeps(c, base, values)
        return Equilibrium(q, stable), c
    raise ComputationError(
        "not converged",
        f"no relative equilibrium: the stiffness is singular, or the base's motion not finite; "
        f"the rate is {_rate(base):.4g} rad/s",
    )


def expanded(structure: Structure, q: Array) -> tuple[Coefficients, Array]:
    """Coefficients of small departures from coordinates `q` (n,), and the elastic forces there, (n,)."""
    if np.any(q):
        return structure.about(q)
    return structure.coefficients, np.zeros(structure.size)


def _along_a_path(structure: Structure, base: Base, values: Array | None) -> tuple[Equilibrium, Coefficients]:
    """Equilibrium by Newton's method from the straight beam, in strides of load that are shortened where one fails, or
    where stability is lost in a long one that ends far from its prediction.
    """
    straight = np.zeros(structure.size)
    about = structure.coefficients
    slope = _solved(about.stiffness, about.at(base.a_WO_B, base.w_WB_B, base.alpha_WB_B, values)[2])
    slope = slope if np.isfinite(slope).all() else straight  # dq/dshare, along which a stride starts
    q, stable, reached, stride = straight, True, 0.0, 1.0
    while reached < 1.0:
        attempt = min(reached + stride, 1.0)
        ahead = q + (attempt - reached) * slope
        moved, stiffness, c, ok = _newton(structure, base, values, attempt, ahead)
        definite = ok and positive_definite(stiffness)
        if definite or (ok and (not stable or stride < _LOCATED or _near(structure, moved, ahead))):
            slope = (moved - q) / (attempt - reached)
            q, about, stable, reached, stride = moved, c, definite, attempt, 2 * stride
            continue
        stride /= 4
        if stride < _SHORTEST:
            raise ComputationError(
                "not converged",
                f"no relative equilibrium beyond {reached:.4g} of the load: the beam buckles or diverges there; "
                f"the rate is {_rate(base):.4g} rad/s",
            )
    return Equilibrium(q, stable if values is None else keeps(about, base, values)), about


def _bent(c: Coefficients, base: Base, values: Array | None, q: Array) -> Array:
    """Equilibrium (n,) of a body that bends far, from that of its linear equations, by Newton's method; NaN where it
    does not converge.
    """
    assert c.bending is not None
    frozen, still = (base.a_WO_B, base.w_WB_B, base.alpha_WB_B, values), np.zeros_like(q)
    stiffness = c.at(*frozen)[1]
    for _ in range(_ITERATIONS):
        correction = _solved(stiffness + c.bending.slope(q), -c.residual(q, still, still, *frozen))
        q = q + correction
        if not np.abs(correction).max() > 1e-13 + 1e-12 * np.abs(q).max():
            return q
    return np.nan * q


def _near(structure: Structure, q: Array, other: Array) -> bool:
    """True if no station differs by more than a small share of the length between two sets of coordinates."""
    apart = structure.displacement(q) - structure.displacement(other)
    return bool(np.abs(apart).max() < _NEAR * structure.length)


def keeps(c: Coefficients, base: Base, values: Array | None) -> bool:
    """True if an equilibrium is stable, by the coefficients about it; eigenvalues decide if loads follow the beam."""
    if not c.size:
        return True  # nothing deforms
    mass, velocity, stiffness = map(np.asarray, (c.mass, *c.frozen(base.a_WO_B, base.w_WB_B, base.alpha_WB_B, values)))
    return stability_margin(mass, velocity, stiffness) > 0


def _newton(
    structure: Structure, base: Base, values: Array | None, share: float, q: Array
) -> tuple[Array, Array, Coefficients, bool]:
    """Solve at a share of loads and accelerations (of rates its root); return q, tangent stiffness, coefficients, and
    True if it converged. Corrections that do not shrink count as a failure: they may lead far away.
    """
    frozen = share * base.a_WO_B, np.sqrt(share) * base.w_WB_B, share * base.alpha_WB_B
    loads = None if values is None else share * values
    stiffness = structure.coefficients.stiffness
    last = np.inf
    for _ in range(_ITERATIONS):
        c, elastic = expanded(structure, q)
        _, stiffness, force = c.at(*frozen, loads)
        correction = _solved(stiffness, force - elastic)
        q = q + correction
        size, scale = np.abs(correction).max(), np.abs(q).max()
        if not size > 1e-13 + 1e-12 * scale:
            return q, stiffness, c, bool(np.isfinite(q).all())
        if size > last / 2 and size > _NOISE * scale:
            break
        last = size
    return q, stiffness, c, False


def _solved(matrix: Array, right: Array) -> Array:
    """Solution of linear equations, NaN if they are singular."""
    try:
        return np.linalg.solve(matrix, right)
    except np.linalg.LinAlgError:
        return np.full(len(right), np.nan)


def _rate(base: Base) -> float:
    return float(np.linalg.norm(base.w_WB_B))
