"""Errors of a critical value: from too few shapes, and of the model against the exact one."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np

from gbeam.analysis.vibration.errors import LIMIT, resting
from gbeam.errors import ComputationError
from gbeam.mechanics.enrichment import enrichment
from gbeam.mechanics.structure import Structure
from gbeam.motion.bases.base import Base
from gbeam.numerics.solvers.oscillations import stability_margin
from gbeam.numerics.solvers.roots import brent
from gbeam.results.parts.errors import ErrorEstimate
from gbeam.results.steady.stability import Critical

# Shares of the critical value at which richer models are looked at, from below.
SHARES = 0.25, 0.5, 0.7, 0.8, 0.9, 0.95, 0.98, 0.995, 1.005, 1.02, 1.05, 1.1, 1.2, 1.5, 2.0, 3.0
CLOSE = 1e-6  # of the critical value: how closely a root is found

Path = Callable[[float], tuple[Structure, Base]]


def judged(found: Critical, path: Path) -> Critical:
    """A critical value with its estimated errors, and warnings where they are above one in a hundred.

    Parameters
    ----------
    found : Critical
    path : callable
        Of the quantity that was raised: the structure, with its loads, and the base motion.
    """
    structure, _ = path(0.0)
    if not found.value or structure.source is None:
        return found
    at, (_, along_y, along_z) = found.value, structure.counts
    more, directions = enrichment(structure, path(at)[1]), (True, along_y > 0, along_z > 0)

    def lost(kind: str) -> float:
        return _lost(more.model(kind, directions=directions)[0], path, at)

    exact = lost("exact")
    same = exact if structure.kind == "exact" else lost(structure.kind)
    shapes = abs(at / same - 1)
    model, total = (math.inf, math.inf) if math.isinf(exact) else (abs(same / exact - 1), abs(at / exact - 1))
    errors = ErrorEstimate(0.0, shapes, model, total)
    return replace(found, errors=errors, warnings=found.warnings + doubtful_loss(found.quantity, found.model, errors))


def _lost(rich: Structure, path: Path, near: float) -> float:
    """Value at which a richer model loses its equilibrium; infinity where it keeps it to the last of the shares."""

    @cache
    def margin(value: float) -> float:
        structure, base = path(value)
        try:
            return stability_margin(*resting(replace(rich, load_values=structure.load_values), base)[:3])
        except (ComputationError, np.linalg.LinAlgError):
            return -1.0

    low = 0.0
    for share in SHARES:
        if margin(share * near) < 0:
            return brent(margin, low, share * near, xtol=CLOSE * near)
        low = share * near
    return math.inf


def doubtful_loss(quantity: str, model: str, errors: ErrorEstimate) -> tuple[str, ...]:
    """What to say of a critical value with errors above one in a hundred, or that the exact model does not have."""
    if math.isinf(errors.total):
        return (
            f"the critical {quantity} is {model}'s own: the exact model keeps its equilibrium to {SHARES[-1]:g} times "
            "that at least",
        )
    if not errors.total > LIMIT:
        return ()
    cause, cure = "too few shapes", "raise model.modes or leave them out"
    if errors.model > errors.shapes:
        cause, cure = "the model", 'check with model.kind = "exact"'
    return (f"the critical {quantity} is wrong by an estimated {100 * errors.total:.2g} %: {cause}; {cure}",)
