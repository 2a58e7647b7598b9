"""When a linear model's stiffness stops being positive definite: the speed at which it stops being valid."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from gbeam.mechanics.equations.linear import Coefficients
from gbeam.numerics.solvers.eigen import positive_definite
from gbeam.results.response import BaseMotion

Array = Any
_BLOCK = 2000  # times whose stiffness is looked at together
_ROW, _COLUMN = np.tril_indices(3, -1)


def first_loss(coefficients: Coefficients, time: Array, base: BaseMotion) -> tuple[float, float] | None:
    """First time at which K loses definiteness and the base's rate there, rad/s; None if it never does.

    Between the samples the lowest eigenvalue is interpolated. Only the times that can matter are looked at: K loses
    definiteness when what the base's motion takes exceeds the elastic stiffness, and the sizes of the terms, each
    measured against that stiffness once, bound it from above.
    """
    doubtful = np.flatnonzero(_bound(coefficients, base) >= 1.0)
    for i in range(0, len(doubtful), _BLOCK):
        block = doubtful[i : i + _BLOCK]
        if positive_definite(_stiffness(coefficients, base, block)):
            continue
        lost = np.flatnonzero(lowest_over_time(coefficients, base, block) < 0)
        if lost.size:
            return _between(coefficients, time, base, int(block[lost[0]]))
    return None


@lru_cache(maxsize=8)
def _shares(c: Coefficients) -> tuple[Array, Array]:
    """What a unit of each term takes of the elastic stiffness at most, (9,): of either sign; (3,): of squared rates."""
    scale = np.linalg.inv(np.linalg.cholesky(c.stiffness))  # measures a stiffness against the elastic one
    terms = np.concatenate([c.k_a, c.k_al, c.k_ww[_ROW, _COLUMN], c.k_ww[range(3), range(3)]])
    shares = np.linalg.eigvalsh(scale @ (terms + np.swapaxes(terms, 1, 2)) @ scale.T / 2)
    return np.abs(shares[:9]).max(axis=1), np.maximum(-shares[9:, 0], 0.0)


def _bound(c: Coefficients, base: BaseMotion) -> Array:
    """An upper bound of what the base's motion takes of the elastic stiffness, (t,)."""
    either, softened = _shares(c)
    w = base.w_WB_B
    across = np.abs(np.concatenate([base.a_WO_B, base.alpha_WB_B, 2 * w[:, _ROW] * w[:, _COLUMN]], axis=1))
    return np.asarray(across @ either + w**2 @ softened)


def _stiffness(c: Coefficients, base: BaseMotion, times: Array) -> Array:
    """K at some of the times, (t, n, n)."""
    return np.asarray(c.at(base.a_WO_B[times], base.w_WB_B[times], base.alpha_WB_B[times])[1])


def lowest_over_time(c: Coefficients, base: BaseMotion, times: Array) -> Array:
    """Lowest eigenvalue of K, M-normalised, at some of the times: negative where K is not positive definite, rad²/s².

    The antisymmetric part of K, from the angular acceleration, stores no energy and is left out.
    """
    scale = np.linalg.inv(np.linalg.cholesky(c.mass))
    k = _stiffness(c, base, times)
    return np.linalg.eigvalsh(scale @ (k + np.swapaxes(k, -1, -2)) @ scale.T / 2)[..., 0]


def _between(c: Coefficients, time: Array, base: BaseMotion, i: int) -> tuple[float, float]:
    """Where between the samples i − 1 and i the lowest eigenvalue is zero."""
    rate = np.linalg.norm(base.w_WB_B, axis=1)
    if i == 0:
        return float(time[0]), float(rate[0])
    before, after = lowest_over_time(c, base, np.array([i - 1, i]))
    share = before / (before - after)
    return float(time[i - 1] + share * (time[i] - time[i - 1])), float(rate[i - 1] + share * (rate[i] - rate[i - 1]))
