"""Automatic numbers of shapes, which are raised until the errors of an answer say that they are enough."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from gbeam.analysis.case import Case
from gbeam.arrays.types import Floats
from gbeam.errors import InputError
from gbeam.mechanics.assembly import model_of, remade, stations_asked
from gbeam.mechanics.models import STRAINS, Model, StrainName
from gbeam.mechanics.plausibility import refuse_unknown
from gbeam.mechanics.structure import Structure
from gbeam.results.errors import FrequencyErrors, Lacking
from gbeam.structure.beam import Beam

Answer = TypeVar("Answer")
LIMIT = 0.01  # error by too few shapes, or by strains that the model lacks, from which on a steady state is warned of
LOWEST = 6  # frequencies for which the numbers of shapes are enough


def sufficient(
    case: Case,
    ask: Callable[[Case], Answer],
    errors_of: Callable[[Answer], Iterable[Lacking | None]],
    *,
    shapes: float = LIMIT,
    strains: float = LIMIT,
) -> tuple[Case, Answer]:
    """Return the answer to a question, and the case whose answer it is: where its numbers of shapes are automatic, with
    as many as leave out no more than errors of `shapes`, and of `strains` where the material gives these.
    """
    answer = ask(case)
    while case.automatic:
        errors = [each for each in errors_of(answer) if each is not None]
        richer = _richer_bodies(case, errors, shapes, strains)
        if not richer:
            break
        case = replace(case, system=replace(case.system, bodies={**case.system.bodies, **richer}))
        answer = ask(case)
    return case, answer


def of_lowest(frequency: Floats, errors: FrequencyErrors | None) -> FrequencyErrors | None:
    """Errors of the lowest of frequencies (k,) Hz, and of what lies unseen below the highest of these; None of none."""
    if errors is None or not len(frequency):
        return None
    lowest = np.argsort(frequency)[:LOWEST]
    unseen = tuple(each for each in errors.unseen if each < frequency[lowest[-1]])
    return replace(errors[lowest], unseen=unseen)


def _richer_bodies(case: Case, errors: list[Lacking], shapes: float, strains: float) -> dict[str, Structure]:
    """Beams of a case with what the errors of one with fewer shapes ask for, by name."""
    richer = {}
    for name, body in case.automatic_beams.items():
        source: Any = body.source
        model = _richer(model_of(body), source.beam, errors, shapes, strains)
        if model is not None:
            richer[name] = remade(body, model, stations_asked(body))
    return richer


def _richer(model: Model, beam: Beam, errors: Iterable[Lacking], shapes: float, strains: float) -> Model | None:
    """Model with what the errors of one with fewer shapes ask for; None where that is nothing, or too much."""
    few = max((each.few_shapes for each in errors), default=0.0)
    if max((each.few_strains for each in errors), default=0.0) > strains and (lacking := strains_lacking(model, beam)):
        return model.with_strains(lacking)
    return model.richer() if few > shapes else None


def strains_lacking(model: Model, beam: Beam) -> tuple[StrainName, ...]:
    """Names of the strains, of twist and shear, that a model lacks and whose stiffness the beam gives."""
    return tuple(name for name in STRAINS if not getattr(model, name) and _known(beam, name))


def _known(beam: Beam, strain: StrainName) -> bool:
    """True if a beam gives the stiffness of a strain."""
    try:
        refuse_unknown(beam, **{name: name == strain for name in STRAINS})
    except InputError:
        return False
    return True
