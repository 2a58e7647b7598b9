"""Estimated errors by their causes, steps, too few shapes, model, mesh and theory of slender beams, and in words."""

from __future__ import annotations

import math
import sys
from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from operator import itemgetter
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from gbeam.analysis.accuracy.beam_theory import WORDS, Lacking, largest
from gbeam.analysis.accuracy.correction import DEFLECTION, MOVED, Quantity, Reading
from gbeam.analysis.accuracy.looks import Looks
from gbeam.arrays.types import Floats
from gbeam.mechanics.models import TORSION
from gbeam.mechanics.plausibility import first_order_clause
from gbeam.mechanics.structure import Structure
from gbeam.printable import percent as percent
from gbeam.results.errors import ErrorEstimate
from gbeam.results.result import NOT_KNOWN

BEAM = "beam"  # name of a beam that is alone
LIMIT = 0.01  # an error of a steady state above is warned of


def cure_of_theory(theory: str) -> str:
    """Advice against an error of the theory of slender beams. `theory` names its causes in words."""
    if theory.partition(";")[0] == WORDS["plate"]:
        return "no model of a beam has it: plate = true of its section says how much it is at most, a mesh how much"
    return 'kind = "exact" with modes.twist, shear_y, shear_z has all but plate action'


Cause = tuple[float, str, str]  # an error, its cause in words, and advice against it


def causes(errors: ErrorEstimate, theory: str, *, several: bool = False) -> list[Cause]:
    """Errors by too few shapes, model, beam theory and mesh, without those that are zero, the largest first.

    With `several` bodies the advice is on one of them.
    """
    of_solid = math.isnan(errors.beam_theory) and not math.isnan(errors.shapes)
    few = "too few shapes", "raise model.modes, or leave them out: then there are enough for the lowest six"
    bent = "the model", 'check with model.kind = "exact"'
    if of_solid:
        few, bent = FEW_MODES, BENT_FAR
    if several:
        few = few[0], MORE_SHAPES
    every = [
        (errors.shapes, *few),
        (errors.model, *bent),
        (errors.beam_theory, f"the theory of slender beams ({theory})", cure_of_theory(theory)),
        (errors.mesh, *ROUGH_MESH),
    ]
    return sorted((cause for cause in every if cause[0] > 0), key=itemgetter(0), reverse=True)


def reference_model(errors: ErrorEstimate) -> str:
    """Words for the model that errors are judged by."""
    if math.isnan(errors.model):
        return "the model with more modes"
    return "the model with forces of higher order" if math.isnan(errors.beam_theory) else "the exact model"


def error_warning(quantity: str, size: str, errors: ErrorEstimate, theory: str) -> str:
    """Warn that a quantity of a steady state is wrong by a `size` in words, with its largest cause and advice."""
    return f"{quantity} is wrong by an estimated {size}: {causes_in_words(causes(errors, theory)[:1])}"


def causes_in_words(causes: list[Cause], worst_body: str = "") -> str:
    """Causes with advice against each; of several, with their sizes, and the words about the `worst_body`."""
    if len(causes) == 1:
        ((_, cause, cure),) = causes
        return f"{cause}{worst_body}; {cure}"
    clauses = []
    for size, cause, cure in causes:
        advised = f"{cause[:-1]}; {cure})" if cause.endswith(")") else f"{cause} ({cure})"
        clauses.append(f"{percent(size)} from {advised}")
    return ", ".join(clauses) + worst_body


def relative_difference(value: float, reference: float) -> float:
    """Relative difference of two values. A critical value is infinite if there is none up to the limit."""
    if math.isinf(reference):
        return 0.0 if value == reference else math.inf
    return math.inf if math.isinf(value) else abs(value / reference - 1)


def twist_warnings(
    structure: Structure, name: str, causes: Mapping[str, float], distances: Floats, bent: float, limit: float
) -> Iterator[str]:
    """Warn of each mass off a beam's axis that would move further if the model had twist.

    The twist displaces the masses by the `distances`, m. A warning is given above `limit` times the beam's deflection
    `bent`, m. The beam has a `name` if it is one among several bodies.
    """
    if structure.source is None or causes.get("twist", 0.0) <= 0:
        return
    for i, (mass, difference) in enumerate(zip(structure.source.beam.masses, distances, strict=False)):
        arm = float((mass.offset[1] ** 2 + mass.offset[2] ** 2) ** 0.5)
        if arm and difference > limit * bent:
            share = f"{percent(difference / bent)} of the tip's displacement"
            yield (
                f"{name or 'beam'}.masses[{i}] lies {1e3 * arm:.4g} mm off the axis: the beam twists under it, and it "
                f"moves by an estimated {1e3 * difference:.3g} mm more or less than computed, {share}; {TORSION}"
            )


def not_known(bend: float, lost: str) -> dict[str, Any]:
    """Outcome and message, by name, of a state that is `lost` with a stiffness of first order.

    They are empty unless its bend, as a share of the length, is too far for such a stiffness.
    """
    clause = first_order_clause(bend)
    words = f"whether it would stay there is not known: {lost}, but {clause}"
    return {"outcome": NOT_KNOWN, "message": words} if clause else {}


NOTHING = 1e-7  # of what another load makes
UNMOVED = 1e-14  # of the length
ROUNDING = sys.float_info.epsilon  # of a peak
FEW_MODES = "too few modes", "raise modes"
MORE_SHAPES = "raise its model.modes, of a mesh its modes"
BENT_FAR = "the bend, in which its stiffness is of first order", "give a strip or a rod as [beam], which is exact"
ROUGH_MESH = "the mesh", "mesh it finer"
NO_MESH = "the mesh is not judged"
UNKNOWN = "shapes and model are not judged: it is neither a beam, a mesh nor matrices"


def negligible(sizes: Mapping[Quantity, float], body: str, length: float, inertia: float = 0.0) -> set[Quantity]:
    """Quantities of a body that are rounding.

    Root force and moment are compared with one another (by `length`, m) and with the body's inertia force `inertia`, N;
    normal stress with the shear stress; deflection with the length.
    """
    references = {
        "force": max(sizes[body, "moment"] / length, inertia),
        "moment": max(sizes[body, "force"], inertia) * length,
        "stress": sizes.get((body, "sheared"), 0.0),
    }
    rounding = {(body, what) for what, reference in references.items() if sizes[body, what] <= NOTHING * reference}
    if sizes.get((body, DEFLECTION), math.inf) <= UNMOVED * length:
        rounding.add((body, DEFLECTION))
    return rounding


def unjudged(structure: Structure) -> str:
    """Sentence that says which errors of a structure are not judged, or empty if all are."""
    if structure.source is not None or not structure.size:  # a rigid structure has neither shapes nor mesh
        return ""
    if structure.modes is None:
        return UNKNOWN
    return NO_MESH if structure.coarser is None else ""


class Judgement(NamedTuple):
    """Pairs of readings that differ by too few shapes, by the model and, if known, by the mesh.

    Besides there are differences by the beam theory, relative errors of the steps, the sizes to which others are
    relative, and quantities that are only rounding. A response has the times that are read, relative errors of peaks by
    the steps, and those of the law of friction.
    """

    shapes: tuple[Reading, Reading]
    model: tuple[Reading, Reading]
    theory: Lacking
    steps: Mapping[Quantity, float]
    sizes: Mapping[Quantity, float]
    nothing: Collection[Quantity]
    mesh: tuple[Reading, Reading] | None = None
    looks: Looks | None = None
    peaks_by_step: Mapping[Quantity, float] = MappingProxyType({})
    friction: Mapping[Quantity, float] = MappingProxyType({})

    def difference(self, key: Quantity, *pairs: tuple[Reading, Reading]) -> float:
        """Largest size of the sum of the differences of pairs of readings, as a share of the quantity's size."""
        away = largest(np.sum([fine[key] - coarse[key] for coarse, fine in pairs], axis=0))
        size = 0.0 if key in self.nothing else self.sizes[key] or away
        return away / size if size else 0.0

    def error(self, key: Quantity) -> ErrorEstimate:
        """Error of a quantity by its causes, all unknown if its size is NaN, as for stress in bodies by matrices."""
        if math.isnan(self.sizes[key]):
            return ErrorEstimate()
        nothing, size = key in self.nothing, self.sizes[key]
        shapes, model = self.difference(key, self.shapes), self.difference(key, self.model)
        total = self.difference(key, self.shapes, self.model)
        step = 0.0 if nothing else self.steps.get(key, math.nan)
        estimate = ErrorEstimate(step, shapes, model, total=total + (0.0 if math.isnan(step) else step))
        if self.mesh is not None:
            estimate = estimate.adding(mesh=self.difference(key, self.mesh))
        if key in self.friction:
            estimate = estimate.adding(friction=0.0 if nothing else self.friction[key])
        theory = self.theory.sizes.get(key, math.nan)
        estimate = estimate.adding(beam_theory=0.0 if nothing or size == 0 else theory / size)
        peaks = self.looks is not None and key[1] not in MOVED
        return replace(estimate, peak=self.peak(key, estimate.total)) if peaks else estimate

    def peak(self, key: Quantity, total: float) -> float:
        """Error of the largest values of a quantity over time, whenever they are reached.

        It is the sum of the differences that shapes and model, mesh, theory, steps and friction make, so that none
        hides another, and at most the `total`.
        """
        if self.looks is None or not self.sizes[key] or not math.isfinite(total):
            return total
        # From what is computed to the exact model with more shapes; what lies between is no solution.
        first, last = (self.model, self.shapes) if self.shapes[0] is self.model[1] else (self.shapes, self.model)
        pairs = [(first[0], last[1]), *([] if self.mesh is None else [self.mesh])]
        difference = sum(self.looks.peak_difference(coarse[key], fine[key]) for coarse, fine in pairs)
        by_run = self.peaks_by_step.get(key, 0.0), self.friction.get(key, 0.0)
        causes = (difference + self.theory.peaks.get(key, 0.0)) / self.sizes[key], *by_run
        return min(max(float(np.nansum(causes)), ROUNDING), total)

    def loads(self, body: str) -> ErrorEstimate:
        """The larger errors of the force and the moment at a body's root."""
        return ErrorEstimate.from_largest(self.error((body, load)) for load in ("force", "moment"))
