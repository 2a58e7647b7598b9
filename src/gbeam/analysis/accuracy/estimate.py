"""The error estimate of a response: the time step's, too few shapes', the model's, the beam theory's, and of all."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import numpy as np

from gbeam.analysis.accuracy.beam_theory import UNKNOWN as UNKNOWN_THEORY
from gbeam.analysis.accuracy.beam_theory import Lacking, described, largest, response_theory
from gbeam.analysis.accuracy.correction import RESOLVED
from gbeam.analysis.accuracy.response_errors import Begin, Quantities, Rings, Solution, lacking
from gbeam.mechanics.models import TORSION
from gbeam.mechanics.structure import Structure
from gbeam.motion.protocol import Motion
from gbeam.results.errors import ErrorEstimate, Errors
from gbeam.results.parts import Loads
from gbeam.results.result import Floats

LIMIT = 0.01  # an error of a steady state above is warned of
BEYOND = 'kind = "exact" with modes.twist, shear_y, shear_z has all but plate action'


def percent(share: float) -> str:
    """A share in percent: ``1.3 %``, ``110 %``."""
    return f"{100 * share:{'.0f' if share > 0.1 else '.2g'}} %"


def cause_and_cure(shapes: float, model: float, beam_theory: float, theory: str) -> tuple[str, str]:
    """The largest of the errors from too few shapes, of the model and of the beam theory, and what helps."""
    if beam_theory > max(shapes, model):
        return f"the theory of slender beams ({theory})", BEYOND
    if math.isnan(model) and not math.isnan(shapes):  # of a solid, whose model is not judged
        return FEW_MODES
    if not shapes >= model:
        return "the model", 'check with model.kind = "exact"'
    return "too few shapes", "raise model.modes, which one [beam] may leave out"


def fuller(model: float) -> str:
    """The model that tells an error, of which that of a model is a part, or not known."""
    return "the model with more modes" if math.isnan(model) else "the exact model"


def wrong_by(what: str, size: str, errors: ErrorEstimate, theory: str) -> str:
    """Say by how much a quantity of a steady state is wrong, mostly from what, and what helps."""
    cause, cure = cause_and_cure(errors.shapes, errors.model, errors.beam_theory, theory)
    return f"{what} is wrong by an estimated {size}: {cause}; {cure}"


def apart(value: float, reference: float) -> float:
    """Relative difference of two values, either of which may not be reached."""
    if math.isinf(reference):
        return 0.0 if value == reference else math.inf
    return math.inf if math.isinf(value) else abs(value / reference - 1)


def of_bodies(structure: Structure, lacking: Lacking, tip: float, limit: float) -> Iterator[str]:
    """Warn of bodies, off the tip's axis, that are elsewhere by more than a share of its displacement, m."""
    assert structure.source is not None
    for i, (body, moved) in enumerate(zip(structure.source.beam.masses, lacking.bodies, strict=False)):
        arm = float((body.offset[1] ** 2 + body.offset[2] ** 2) ** 0.5)
        if arm and moved > limit * tip and lacking.causes.get("twist", 0.0) > 0:
            share = f"{percent(moved / tip)} of the tip's displacement"
            yield (
                f"beam.masses[{i}] lies {1e3 * arm:.4g} mm off the axis: the beam twists under it, and it moves by an "
                f"estimated {1e3 * moved:.3g} mm more or less than computed, {share}; {TORSION}"
            )


NOTHING = 1e-7  # of what another load makes
UNMOVED = 1e-14  # of the length
FEWEST, PER_PERIOD = 500, 6  # samples looked at, in all and in a period of the lowest mode
MOST = 20_000  # samples where fast modes may ring
LARGEST = 2.0  # times (v/L)²: error of a second-order model, up to what a beam that points inward on a hub has
TOO_FAR = "the solution is too far from the exact model's for an estimate; it is the bound 2 (v/L)² of its class"
FEW_MODES = "too few modes", "raise modes"
UNKNOWN = "shapes and model are not judged: it is neither a beam, a mesh nor matrices"


def negligible(sizes: Mapping[str, float], length: float) -> set[str]:
    """Quantities whose largest sizes are rounding, such as the normal stress under a torque alone."""
    least = {
        "tip": UNMOVED / NOTHING * length,
        "force": sizes["moment"] / length,
        "moment": sizes["force"] * length,
        "stress": sizes["sheared"],
    }
    return {name for name, each in least.items() if name in sizes and sizes[name] <= NOTHING * each}


def unjudged(structure: Structure) -> str:
    """The errors of a structure that are not judged, in words."""
    if structure.source is not None:
        return ""
    if structure.mesh_error is None:
        return UNKNOWN
    known = structure.mesh_error[0]
    mesh = "" if math.isnan(known) else f", by a coarser one {percent(known)} of the lowest frequency"
    return f"the mesh is not judged{mesh}"


def response_errors(
    structure: Structure,
    motion: Motion,
    solution: Solution,
    tip: Floats,
    loads: Loads | None,
    steps: tuple[float, float, float],
    *,
    stride: int = 1,
    begin: Begin | None = None,
    tolerance: float = math.inf,
) -> tuple[Errors, tuple[str, ...]]:
    """Estimated errors of a response, as fractions of the largest tip displacement (t, 3), load and stress, and
    warnings; `steps` are those of the time step, and the solution has `stride` steps to each of the results.
    """
    note = unjudged(structure)
    if not structure.judged or loads is None or len(tip) < 3:
        alone = [ErrorEstimate(step=step, total=step) for step in steps]
        if loads is None or not np.isfinite(loads.stress).any():  # such as that of particles, which is not known
            alone[2] = ErrorEstimate()
        return Errors(alone[0], alone[1], alone[2], note), ()
    every = tip, loads.force[:, 0], loads.moment[:, 0], loads.stress.max(axis=1)
    sizes = dict(zip(Quantities._fields, map(largest, every), strict=True))
    if structure.recovery is not None:
        sizes["stress"] = largest(structure.recovery.felt(solution.y[:, -structure.size :])[:, None])
    sheared = 0.0 if loads.von_mises is None else float(np.nan_to_num(loads.von_mises).max())
    nothing = negligible(sizes | {"sheared": sheared}, structure.length)
    period = 2 * math.pi / float(structure.rest[0][0])
    step, least = float(solution.time[1] - solution.time[0]), math.ceil(len(solution.time) / MOST)
    few = max(1, min(int(period / PER_PERIOD / (stride * step)), len(tip) // FEWEST))
    stride *= few
    beyond, theory = UNKNOWN_THEORY, ""
    if structure.source is not None:
        with np.errstate(all="ignore"):
            beyond = response_theory(structure, motion, solution.some(slice(None, None, stride)), begin)
        theory = described(structure, beyond.causes)

    def judged(stride: int, computed: Quantities | None = None) -> tuple[Errors, float]:
        """Errors by every so many steps, and the rate of the fastest mode that these may have missed, rad/s."""
        few = solution.some(slice(None, None, stride))
        with np.errstate(all="ignore"):
            parts, rings = lacking(structure, motion, few, computed, begin=begin)
        if not np.isfinite(parts.total.tip).all():
            bounded = structure.source is not None
            return _bounded(structure, sizes["tip"], steps[0]) if bounded else Errors(ErrorEstimate(steps[0])), 0.0

        def fractions(name: str, step: float) -> ErrorEstimate:
            size = 0.0 if name in nothing else sizes[name] or largest(getattr(parts.total, name))
            if math.isnan(size):  # of the stress of imported matrices
                return ErrorEstimate()
            shares = (largest(getattr(part, name)) / size if size else 0.0 for part in parts)
            shapes, model, total = shares
            step = 0.0 if name in nothing else step
            exact = 0.0 if structure.kind == "exact" else math.nan if structure.source is None else model
            away = ErrorEstimate(step, shapes, exact, total=step + total)
            return away.with_theory(beyond.sizes[name] / size if size else 0.0)

        force, moment = fractions("force", steps[1]), fractions("moment", steps[1])
        worst = max(force, moment, key=lambda each: each.total)
        stress = fractions("stress", steps[2])
        errors = Errors(fractions("tip", steps[0]), worst, stress, note=note, theory=theory)
        return errors, _missed(rings, sizes, errors, RESOLVED / (least * step))

    errors, rate = judged(stride, Quantities(*(each[::few] for each in every)))
    finer = max(least, int(RESOLVED / (rate * step))) if rate else stride
    if finer < stride:
        errors, _ = judged(finer)
    return errors, tuple(of_bodies(structure, beyond, sizes["tip"], tolerance)) if structure.source else ()


def _missed(rings: Rings, sizes: dict[str, float], errors: Errors, fastest: float) -> float:
    """Circular frequency, rad/s, of the fastest mode up to the `fastest` resolved that may ring too much, or zero."""
    limits = zip(("tip", "force", "moment"), (errors.displacement, errors.loads, errors.loads), strict=True)
    visible = np.zeros(len(rings.rate), dtype=bool)
    for name, stated in limits:
        visible |= getattr(rings, name) > stated.slender * sizes[name]
    return float(rings.rate[visible & (rings.rate < fastest)].max(initial=0.0))


def _bounded(structure: Structure, size: float, step: float) -> Errors:
    model = LARGEST * (size / structure.length) ** 2
    return Errors(ErrorEstimate(step, math.nan, model, total=step + model), note=TOO_FAR)
