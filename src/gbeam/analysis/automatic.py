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
    """Return the answer to a question, and the case whose answer it is.

    Where the case leaves its numbers of shapes open, they are raised until too few shapes leave errors of at most
    `shapes`, and missing strains, whose stiffness the material gives, errors of at most `strains`.
    """
    answer = ask(case)
    while case.automatic:
        errors = [lacking for lacking in errors_of(answer) if lacking is not None]
        richer = _richer_bodies(case, errors, shapes, strains)
        if not richer:
            break
        case = replace(case, system=replace(case.system, bodies={**case.system.bodies, **richer}))
        answer = ask(case)
    return case, answer


def lowest_errors(frequency: Floats, errors: FrequencyErrors | None) -> FrequencyErrors | None:
    """Errors of the `LOWEST` frequencies of (k,) Hz, and of unseen ones below the highest of these, or None if none."""
    if errors is None or not len(frequency):
        return None
    lowest = np.argsort(frequency)[:LOWEST]
    unseen = tuple(hidden for hidden in errors.unseen if hidden < frequency[lowest[-1]])
    return replace(errors[lowest], unseen=unseen)


def _richer_bodies(case: Case, errors: list[Lacking], shapes: float, strains: float) -> dict[str, Structure]:
    """Beams of a case, by name, with the shapes and strains whose lack the errors show."""
    richer = {}
    for name, body in case.automatic_beams.items():
        source: Any = body.source
        model = _richer(model_of(body), source.beam, errors, shapes, strains)
        if model is not None:
            richer[name] = remade(body, model, stations_asked(body))
    return richer


def _richer(model: Model, beam: Beam, errors: Iterable[Lacking], shapes: float, strains: float) -> Model | None:
    """Model with strains added if the lack of them makes the errors too large, or else with more shapes.

    None if the errors ask for neither, or the model cannot have more.
    """
    few_shapes = max((error.few_shapes for error in errors), default=0.0)
    few_strains = max((error.few_strains for error in errors), default=0.0)
    lacking = strains_lacking(model, beam) if few_strains > strains else ()
    if lacking:
        return model.with_strains(lacking)
    return model.richer() if few_shapes > shapes else None


def strains_lacking(model: Model, beam: Beam) -> tuple[StrainName, ...]:
    """Names of the strains, of twist and shear, that a model lacks and whose stiffness the beam gives."""
    return tuple(name for name in STRAINS if not getattr(model, name) and _has_stiffness(beam, name))


def _has_stiffness(beam: Beam, strain: StrainName) -> bool:
    """True if a beam gives the stiffness of a strain."""
    try:
        refuse_unknown(beam, **{name: name == strain for name in STRAINS})
    except InputError:
        return False
    return True
