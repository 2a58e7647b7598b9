"""Errors of the theory of slender beams: by shear, rotary inertia and twist, unless the model has them, and by plate
action.

The solution is put into the linear equations of the thick beam; what they leave of it beyond those of the slender one
is answered by the thick beam, without plate action and with it: the larger counts.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from gbeam.analysis.accuracy.correction import (
    Correction,
    Sampled,
    Vibration,
    complete_residual,
    linear_residual,
    operator,
    responses,
)
from gbeam.analysis.accuracy.response_errors import Begin, Quantities, Solution, at_rest, lifted, quantities, settled
from gbeam.errors import ComputationError
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.theory import Theory, theory_of
from gbeam.motion.bases.base import Base
from gbeam.motion.protocol import Motion
from gbeam.results.result import Floats
from gbeam.structure.beam import assumptions

NAMED, NONE = 0.02, 1e-9  # of the largest cause, and of the energy: a smaller one is not named
WORDS = {"shear": "shear", "rotary": "rotary inertia", "twist": "twist", "plate": "plate action"}


class Lacking(NamedTuple):
    """Largest differences of quantities to the theory of thick beams, each cause's share of the energy, and bodies'
    distances (b,) m.
    """

    sizes: dict[str, float]
    causes: dict[str, float]
    bodies: Floats


UNKNOWN = Lacking(dict.fromkeys(Quantities._fields, math.nan), {}, np.zeros(0))


class _Gap(NamedTuple):
    """Residuals (t, first + n) of a solution in the thick beam's equations: as a beam, and as a plate."""

    beam: Floats
    plate: Floats

    @property
    def both(self) -> tuple[Floats, Floats]:
        """The residual of the thick beam, and that with plate action."""
        return self.beam, self.beam + self.plate


def response_theory(structure: Structure, motion: Motion, solution: Solution, begin: Begin | None = None) -> Lacking:
    """Find what a response lacks; NaN where the thick beam has no answer; without `begin` it starts in equilibrium."""
    theory, index = theory_of(structure), np.arange(structure.size)
    full, thin = (lifted(each, index, motion, solution) for each in (theory.thick, theory.slender))
    plate = theory.plate(full.p)
    gap, rest = (_gap(theory, *pair, plate) for pair in ((full, thin), (at_rest(full), at_rest(thin))))

    def answer(thick: Structure, residual: Floats, residual_at_rest: Floats) -> Correction:
        of = operator(thick, full)
        first = of.mass.shape[0] - thick.size
        start = settled(of, residual_at_rest[0, first:])
        if begin is not None:
            slender, begun = begin(theory.slender), begin(thick)
            q, qd = (b - np.pad(a, (0, thick.size - len(a))) for a, b in zip(slender, begun, strict=True))
            start = np.pad(q, (first, 0)), np.pad(qd, (first, 0))
        return responses(of, Vibration.of(of, solution.time), solution.time)(residual, start)

    ways = 2 if plate.any() else 1
    pairs = [*zip(theory.variants(plate), gap.both, rest.both, strict=True)][:ways]
    try:
        return _lacking(theory, full, thin, gap, [answer(*each) for each in pairs])
    except (ComputationError, np.linalg.LinAlgError):
        return UNKNOWN


def static_theory(structure: Structure, resting: Callable[[Structure], Sampled]) -> Lacking:
    """Find what an equilibrium lacks, given a function that finds it for another structure; NaN where there is none."""
    theory = theory_of(structure) if structure.linear else theory_of(structure).exact
    full, thin = resting(theory.thick), resting(theory.slender)
    plate, still = theory.plate(full.p), np.zeros_like(full.p)
    left = linear_residual if structure.linear else complete_residual
    beam = left(theory.thick, full)
    beam[:, : theory.slender.size] -= left(theory.slender, thin)
    gap = _Gap(beam, full.p @ plate)

    def about(thick: Structure) -> Structure:
        """The beam as small departures from the equilibrium see it."""
        loaded = replace(thick, load_values=None if full.loads is None else full.loads[0])
        return replace(thick, coefficients=loaded.about(full.p[0])[0])

    pairs = zip(theory.variants(plate), gap.both, strict=True)
    try:
        moved = [np.linalg.solve(operator(about(thick), full).first(), -residual[0])[None] for thick, residual in pairs]
    except np.linalg.LinAlgError:
        return UNKNOWN
    return _lacking(theory, full, thin, gap, [Correction(each, still, still) for each in moved])


def _gap(theory: Theory, full: Sampled, thin: Sampled, plate: Floats) -> _Gap:
    c, count = theory.thick.coefficients, theory.size
    features = c.features(full.base.a_WO_B, full.base.w_WB_B, full.base.alpha_WB_B, full.loads)
    mass, terms = theory.beyond
    velocity, stiffness, force = terms.each
    # Feature by feature: no matrix is made for every time.
    p, pd, pdd = (each[:, :count] for each in (full.p, full.pd, full.pdd))
    beam = pdd @ mass.T - features @ force
    for feature, by_rate, by_place in zip(features.T, velocity, stiffness, strict=True):
        beam += feature[:, None] * (pd @ by_rate.T + p @ by_place.T)
    flat = full.p @ plate
    if full.hub is None:
        return _Gap(beam, flat)
    thick, slender = (complete_residual(*each)[:, 0] for each in ((theory.thick, full), (theory.slender, thin)))
    return _Gap(np.concatenate([(thick - slender)[:, None], beam], axis=1), np.pad(flat, ((0, 0), (1, 0))))


def _lacking(theory: Theory, full: Sampled, thin: Sampled, gap: _Gap, answers: list[Correction]) -> Lacking:
    """The larger of what is lacking without and with plate action: how far a clamp keeps a section flat is not sure."""
    thick, slender = theory.thick, quantities(theory.slender, thin)
    sizes, bodies = dict.fromkeys(Quantities._fields, 0.0), np.zeros(len(theory.bodies))
    for answer in answers:
        truth = quantities(thick, full.moved(*answer))
        for name, size in sizes.items():
            sizes[name] = max(size, largest(getattr(truth, name) - getattr(slender, name)))
        moved = np.einsum("bai,ti->tba", theory.bodies, answer.value[:, -thick.size :])
        bodies = np.maximum(bodies, np.linalg.norm(moved, axis=2).max(axis=0))
    return Lacking(sizes, causes(theory, full.p, *(each[:, -thick.size :] for each in gap)), bodies)


def causes(theory: Theory, p: Any, beam: Any, plate: Any) -> dict[str, float]:
    """Share of each cause in the strain energy of solutions (t, n) that leave residuals (t, n), to first order."""
    stiffness = theory.thick.coefficients.stiffness
    energy = np.abs(np.einsum("ti,ij,tj->t", p.conj(), stiffness, p)).max(initial=0.0)
    if energy == 0:
        return {}
    slender = slice(theory.slender.size)
    work = {
        "rotary": (p.conj()[:, slender] * beam[:, slender]).sum(axis=1),
        "plate": (p.conj() * plate).sum(axis=1),
    }
    for name, columns in theory.columns.items():
        forces = beam[:, columns]
        work[name] = (forces.conj() * np.linalg.solve(stiffness[columns, columns], forces.T).T).sum(axis=1)
    return {name: float(np.abs(each).max(initial=0.0) / energy) for name, each in work.items()}


def mode_causes(theory: Theory, base: Base, loads: Any, mode: Any, rate: Any, plate: Floats) -> dict[str, float]:
    """Share of each cause in the energy of modes (k, own) at rates (k,) on a base (3,), without a free hub's."""
    a, w, alpha = (np.asarray(x)[None] for x in (base.a_WO_B, base.w_WB_B, base.alpha_WB_B))
    load_row = None if loads is None else np.asarray(loads)[None]
    features = theory.thick.coefficients.features(a, w, alpha, load_row)[0]
    mass, terms = theory.beyond
    velocity, stiffness = (np.tensordot(features, each, 1) for each in (terms.velocity, terms.stiffness))
    rate = np.asarray(rate)[:, None]
    residual = mode @ stiffness.T + 1j * rate * (mode @ velocity.T) - rate**2 * mode @ mass.T
    p = np.pad(mode, ((0, 0), (0, theory.thick.size - mode.shape[1])))
    return causes(theory, p, residual, p @ plate)


def largest(values: Floats) -> float:
    """Largest size of numbers over time (t,), or of vectors (t, 3)."""
    return float(np.abs(values).max()) if values.ndim == 1 else float(np.sqrt((values**2).sum(axis=-1)).max())


def words(causes: Mapping[str, float]) -> str:
    """The causes that matter, the largest first: ``shear and rotary inertia``."""
    limit = max(NAMED * max(causes.values(), default=0.0), NONE)
    chosen = [WORDS[name] for name, share in sorted(causes.items(), key=lambda item: -item[1]) if share > limit]
    return " and ".join([", ".join(chosen[:-1]), chosen[-1]] if len(chosen) > 1 else chosen)


def described(structure: Structure, causes: Mapping[str, float]) -> str:
    """The causes that matter, and what the estimate assumes: ``shear; assumed: Poisson's ratio 0.3``."""
    assert structure.source is not None
    named, assumed = words(causes), assumptions(structure.source.beam)
    return f"{named}; assumed: {', '.join(assumed)}" if named and assumed else named
