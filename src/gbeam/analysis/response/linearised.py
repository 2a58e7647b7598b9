"""The equations of motion linearised about a run, with their derivatives with respect to parameters.

A parameter enters by pairs of problems, a little less and a little more of it. The residual of a linear model is one
product, of terms that know the motion and of coefficients that know the beam, either of which is differentiated with
the other held; that of a nonlinear model is evaluated for either of a pair at the run's states, with derivatives by
complex steps.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gbeam.analysis.response.problem import Problem
from gbeam.integrate.equations import LinearEquations, accelerations, slopes
from gbeam.integrate.schemes import Scheme, added
from gbeam.integrate.tangent import System
from gbeam.mechanics.equations.linear import Coefficients
from gbeam.mechanics.structure import Structure
from gbeam.motion.bases.base import Base
from gbeam.results.result import Floats

Array = Any
_I, _J = np.triu_indices(3)  # pairs of angular velocities, each once


def terms(q: Array, qd: Array, qdd: Array, base: Base, loads: Array | None) -> Array:
    """Terms (t, f) of r = terms @ coefficients, at q (t, n), base motions (t, 3) and load components (t, loads, 6).

    r = M q̈ + (C + ω·G) q̇ + (K + ωω:K_ww + α·K_al + a·K_a − loads) q − F
    """
    w = base.w_WB_B
    inputs = [w[:, _I] * w[:, _J], base.alpha_WB_B, base.a_WO_B]
    if loads is not None:
        inputs.append(loads.reshape(len(q), -1))
    u = np.concatenate(inputs, axis=1)
    return np.concatenate([qdd, qd, _outer(w, qd), q, _outer(u, q), u], axis=1)


def coefficient_matrix(c: Coefficients, *, loaded: bool) -> Array:
    """Coefficients (f, n) in the order of the terms."""
    twice = np.where(_I == _J, 1.0, 2.0)
    k = [twice[:, None, None] * c.k_ww[_I, _J], c.k_al, c.k_a]
    f = [twice[:, None] * c.f_ww[_I, _J], c.f_al, c.f_a]
    if loaded:
        assert c.loads is not None
        slope, constant = c.loads.slope[:, :, 6:], c.loads.constant[:, :, 6:]
        k.append(-slope.reshape(-1, *slope.shape[2:]))
        f.append(constant.reshape(-1, constant.shape[2]))
    matrices = [c.mass[None], c.damping[None], c.gyroscopic, c.stiffness[None], *k]
    rows = [np.swapaxes(each, 1, 2).reshape(-1, c.size) for each in matrices]
    return np.concatenate([*rows, *(-each for each in f)])


def _outer(u: Array, q: Array) -> Array:
    """Products u_i q_j, (t, i j)."""
    return (u[:, :, None] * q[:, None, :]).reshape(len(q), -1)


@dataclass(frozen=True)
class Posed:
    """A structure in an environment, and the problem that they pose."""

    structure: Structure
    motion: Any
    problem: Problem


Pair = tuple[Posed, Posed]  # of less and of more of a parameter


def linearised(
    nominal: Posed, pairs: Sequence[Pair], width: Floats, within: tuple[Scheme, float] | None = None
) -> System:
    """Return the equations (those that fitted steps solve `within` a length) linearised about states of the nominal
    problem, for pairs of parameters that differ by `width` (p,).
    """
    if isinstance(nominal.problem.equations, LinearEquations):
        return _linear(nominal, pairs, width, within)
    return _nonlinear(nominal, pairs, width)


def _linear(nominal: Posed, pairs: Sequence[Pair], width: Floats, within: tuple[Scheme, float] | None) -> System:
    equations: Any = nominal.problem.equations
    loaded = nominal.structure.history is not None
    n = nominal.structure.size

    def fit(posed: Posed) -> tuple[Floats, Floats]:
        return (np.zeros((n, n)),) * 2 if within is None else added(_equations(posed), *within)

    def matrix(posed: Posed) -> Floats:
        c, (mass, damping) = posed.structure.coefficients, fit(posed)
        return coefficient_matrix(replace(c, mass=c.mass + mass, damping=c.damping + damping), loaded=loaded)

    more_mass, more_damping = fit(nominal)
    mass_of_steps = equations.mass + more_mass
    coefficients = matrix(nominal)
    by_beam = np.stack([(matrix(more) - matrix(less)) / w for (less, more), w in zip(pairs, width, strict=True)], 1)
    flat = by_beam.reshape(len(coefficients), -1)
    # A parameter of the beam alone leaves the motion as it is.
    moving = [k for k, pair in enumerate(pairs) if _moves(nominal, pair)]

    def system(time: Floats, q: Floats, qd: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        inputs = equations.drive(time)
        c, k, f = equations.matrices(inputs)
        c = c + more_damping
        qdd = np.linalg.solve(mass_of_steps, (f - (k @ q[..., None] + c @ qd[..., None])[..., 0]).T).T
        forces = -(terms(q, qd, qdd, *inputs) @ flat).reshape(len(time), -1, n)
        for j in moving:
            less, more = (terms(q, qd, qdd, *posed.problem.equations.drive(time)) for posed in pairs[j])
            forces[:, j] -= (more - less) / width[j] @ coefficients
        return np.broadcast_to(mass_of_steps, k.shape), c, k, np.swapaxes(forces, 1, 2)

    return system


def _moves(nominal: Posed, pair: Pair) -> bool:
    return any(posed.motion is not nominal.motion or posed.structure.history is not None for posed in pair)


def _equations(posed: Posed) -> Any:
    return posed.problem.equations


def _nonlinear(nominal: Posed, pairs: Sequence[Pair], width: Floats) -> System:
    equations: Any = nominal.problem.equations

    def system(time: Floats, q: Floats, qd: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        residual, inputs = equations.residual, equations.drive(time)
        qdd = accelerations(residual, q, qd, inputs)
        k, c, mass = slopes(residual, q, qd, qdd, inputs)
        forces = np.empty((*q.shape, len(pairs)))
        for j, pair in enumerate(pairs):
            less, more = (each.residual(q, qd, qdd, each.drive(time)) for each in (_equations(posed) for posed in pair))
            forces[..., j] = -(more - less) / width[j]
        return mass, c, k, forces

    return system
