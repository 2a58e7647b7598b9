"""Errors of a relative equilibrium: from too few shapes, and of the model, against the exact one with more shapes."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from gbeam.analysis.accuracy.estimate import UNKNOWN
from gbeam.analysis.accuracy.reference import Sampled
from gbeam.analysis.accuracy.response_errors import IntArray, Quantities, driven, quantities
from gbeam.analysis.equilibrium.equilibrium import solve_equilibrium
from gbeam.analysis.equilibrium.point import OperatingPoint
from gbeam.errors import ComputationError
from gbeam.mechanics.enrichment import enrichment
from gbeam.mechanics.structure import Structure
from gbeam.motion.bases.base import Base
from gbeam.results.parts.errors import ErrorEstimate, Errors
from gbeam.results.parts.section_forces import Loads
from gbeam.results.result import Floats

LIMIT = 0.01  # an error above is warned of
NOTHING = 1e-6  # of the other load, over a length of the beam: a force or moment that is less is none
LOST = "shapes and model are not judged: the exact model with more shapes comes to no equilibrium there"


def static_errors(point: OperatingPoint, displacement: Floats, loads: Loads | None) -> Errors:
    """Estimated errors of an equilibrium, as fractions of displacement, root load and stress.

    Parameters
    ----------
    point : OperatingPoint
    displacement : (s, 3) m
    loads : Loads or None
        Of one time.
    """
    structure = point.structure
    if structure.source is None or loads is None:
        return Errors(note=UNKNOWN)
    own = Quantities(displacement[-1:], loads.force[:, 0], loads.moment[:, 0], loads.stress.max(axis=1))
    more = enrichment(structure, point.base)
    which = driven(more, lambda rich, index: _lifted(rich, index, point))
    exact = _solved(more.model("exact", directions=which)[0], point)
    if exact is None:
        return Errors(note=LOST)
    same = exact if structure.kind == "exact" else _solved(more.model(structure.kind, directions=which)[0], point)
    length = structure.length

    def fractions(name: str, least: float) -> ErrorEstimate:
        def apart(a: Quantities | None, b: Quantities | None) -> float:
            if a is None or b is None:
                return math.nan
            away = float(np.linalg.norm(getattr(a, name) - getattr(b, name)))
            return away / size if size > least else 0.0

        size = max(float(np.linalg.norm(getattr(each, name))) for each in (own, exact))
        return ErrorEstimate(0.0, apart(own, same), apart(same, exact), apart(own, exact))

    force, moment = (float(np.linalg.norm(each)) for each in (exact.force, exact.moment))
    worst = max(
        fractions("force", NOTHING * moment / length),
        fractions("moment", NOTHING * force * length),
        key=lambda each: each.total,
    )
    return Errors(fractions("tip", NOTHING**2 * length), worst, fractions("stress", 0.0))


def doubtful(errors: Errors) -> tuple[str, ...]:
    """What to say of an equilibrium that is wrong by more than one in a hundred, or that the exact model has not."""
    if errors.note == LOST:
        return (errors.note,)
    quantities = {"tip's displacement": errors.displacement, "root's loads": errors.loads}
    above = {name: each for name, each in quantities.items() if each.total > LIMIT}
    if not above:
        return ()
    worst = max(above.values(), key=lambda each: each.total)
    cause, cure = "too few shapes", "raise model.modes or leave them out"
    if not worst.shapes >= worst.model:
        cause, cure = "the model", 'check with model.kind = "exact"'
    sizes = " and ".join(
        f"the {name} by {100 * each.total:{'.0f' if each.total > 0.1 else '.2g'}} %" for name, each in above.items()
    )
    return (f"estimated to be wrong: {sizes}, mostly from {cause}; {cure}",)


def _lifted(rich: Structure, index: IntArray, point: OperatingPoint) -> Sampled:
    """An equilibrium in the coordinates of a structure with more shapes, its own at `index`."""
    q = np.zeros(rich.size)
    q[index] = point.q
    return _resting(q, point)


def _resting(q: Floats, point: OperatingPoint) -> Sampled:
    base, loads, still = point.base, point.structure.load_values, np.zeros((1, len(q)))
    at = Base(*(np.asarray(x)[None] for x in (base.a_WO_B, base.w_WB_B, base.alpha_WB_B)))
    return Sampled(np.zeros(1), at, q[None], still, still, loads=None if loads is None else np.asarray(loads)[None])


def _solved(rich: Structure, point: OperatingPoint) -> Quantities | None:
    """What a structure with more shapes has at its own equilibrium; None where there is none."""
    rich = replace(rich, load_values=point.structure.load_values)
    try:
        q = solve_equilibrium(rich, point.base).q
    except (ComputationError, np.linalg.LinAlgError):
        return None
    return quantities(rich, _resting(np.asarray(q), point))
