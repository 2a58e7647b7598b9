"""Errors of the speeds at which modes meet multiples of the speed: shapes', the model's and the beam theory's."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from gbeam.analysis.accuracy.doubts import LIMIT, cause_and_cure, percent
from gbeam.analysis.equilibrium.point import OperatingPoint
from gbeam.analysis.vibration.errors import Richer
from gbeam.errors import ComputationError
from gbeam.results.errors import ErrorEstimate
from gbeam.results.modal import Crossing
from gbeam.results.result import Complex


def crossing_errors(
    crossing: Crossing, mode: Complex, slope: float, richer: Richer, point_at: Callable[[float], OperatingPoint]
) -> ErrorEstimate:
    """Errors of a crossing's speed, from where the mode (n,) of richer models meets the same multiple; infinite if
    nowhere near.
    """
    own, order = crossing.speed, crossing.order

    def gaps(rate: float) -> tuple[float, float]:
        """Of the same model with more shapes, and of the exact one, rad/s."""
        same, exact = richer.references(point_at(rate), mode[None])
        return float(same[0]) - order * rate, float(exact[0]) - order * rate

    first = gaps(own)

    def root(which: int) -> float:
        """By a step of Newton's with the model's own slope; where that is a long one, one of the secant method more."""
        near = own - first[which] / (slope - order)
        if not 0 < near < math.inf or abs(near / own - 1) < LIMIT:
            return near if near > 0 else math.inf
        try:
            second = gaps(near)[which]
        except ComputationError:
            return math.inf
        better = near - second * (near - own) / (second - first[which])
        return better if 0 < better < math.inf else math.inf

    exact = root(1)
    same = exact if richer.same is richer.exact else root(0)
    away = ErrorEstimate(0.0, _apart(own, same), _apart(same, exact), total=_apart(own, exact))
    share = float(richer.by_theory(point_at(own), mode[None]).shares[0])
    return away.with_theory(share * order / abs(slope - order))


def _apart(value: float, reference: float) -> float:
    if math.isinf(reference):
        return 0.0 if value == reference else math.inf
    return math.inf if math.isinf(value) else abs(value / reference - 1)


def doubtful_crossings(crossings: Sequence[Crossing], theory: str) -> tuple[str, ...]:
    """What to say where speeds of crossings are wrong by more than one in a hundred."""
    above = [each for each in crossings if each.errors.total > LIMIT]
    if not above:
        return ()
    worst = max(above, key=lambda each: each.errors.total)
    where = f"mode {worst.track + 1} meets {worst.order} × speed"
    if len(above) > 1:
        where += f", and {len(above) - 1} more where modes meet multiples,"
    if math.isinf(worst.errors.total):
        return (
            f"the speed at which {where} is {'not' if len(above) == 1 else 'in part not'} one of the exact model's",
        )
    cause, cure = cause_and_cure(worst.errors.shapes, worst.errors.model, worst.errors.beam_theory, theory)
    size = percent(worst.errors.total) + (" at most" if len(above) > 1 else "")
    return (f"the speed at which {where} is wrong by an estimated {size}: {cause}; {cure}",)
