"""Errors of the theory of slender beams: by shear, rotary inertia and twist, unless the model has them, and by plate
action.

A solution is put into the equations of thick beams, bent as it is. The residual there, beyond that of slender beams, is
answered by the thick beams, without plate action and with it: the larger answer counts.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np

from gbeam.analysis.accuracy.correction import MOVED, Departures, Posed, Quantity, Reading, State, Within
from gbeam.arrays.types import Floats
from gbeam.errors import ComputationError
from gbeam.integrate.equations import Trajectory
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.theory import Theory
from gbeam.numerics.peaks import peaks_apart
from gbeam.structure.beam import assumptions

NAMED, NONE = 0.02, 1e-9  # of the largest cause, and of the energy: a smaller one is not named
WORDS = {"shear": "shear", "rotary": "rotary inertia", "twist": "twist", "plate": "plate action"}


# Initial departure, or None for equilibrium, by linear equations, with a stiffness (n, n) that these have besides.
Begun = Callable[[Departures, Within, Floats], State | None]


class Lacking(NamedTuple):
    """Largest difference of each quantity between slender and thick beams; by beam, each cause's share of the energy,
    and the displacements (b,) m of its bodies between the two; over time the difference of each quantity's peaks. Empty
    where thick beams have no answer.
    """

    sizes: Mapping[Quantity, float] = {}
    causes: Mapping[str, Mapping[str, float]] = {}
    bodies: Mapping[str, Floats] = {}
    peaks: Mapping[Quantity, float] = {}


def beyond(
    solved: Posed,
    of: Trajectory,
    theories: Mapping[str, Theory],
    pose: Callable[[Mapping[str, Structure]], Posed],
    begun: Begun,
    again: Callable[[Mapping[str, Structure]], Reading] | None = None,
) -> Lacking:
    """Differences between slender and thick beams at a solution `of` the equations `solved`; `pose` returns equations
    with other beams, `begun` the difference of their initial states. With `again`, systems with either are run instead.
    """
    slender, thick = ({name: getattr(each, kind) for name, each in theories.items()} for kind in ("slender", "thick"))
    thin = Within.lifted(pose(slender), solved, of)
    full = Within.lifted(pose(thick), thin.more, thin.of)
    columns = {name: [k for k, body in enumerate(full.more.bodies) if body == name] for name in theories}
    bent = {name: full.of.q[:, columns[name]] for name in theories}
    plates = {name: theory.plate(bent[name]) for name, theory in theories.items()}
    added = np.zeros((full.of.q.shape[1],) * 2)
    for name, plate in plates.items():
        added[np.ix_(columns[name], columns[name])] = plate
    by, bodies = dict[str, Mapping[str, float]](), dict[str, Floats]()
    sizes, peaks = dict[Quantity, float](), dict[Quantity, float]()
    try:
        residual = full.residual()
        for name, theory in theories.items():
            by[name] = causes(theory, bent[name], residual[:, columns[name]], bent[name] @ plates[name])
        departures = full.departures()
        without = thin.more.read(thin.of) if again is None else again(slender)
        for plate in (0 * added, added) if added.any() else (added,):
            if again is None:
                stiffer = departures.stiffer(plate)
                answer = stiffer.answer(residual + full.of.q @ plate, begun(stiffer, full, plate))
                truth = full.moved(answer)
                for name, theory in theories.items():
                    moved = np.einsum("bai,ti->tba", theory.bodies, answer.value[:, columns[name]])
                    distance = np.linalg.norm(moved, axis=2).max(axis=0)
                    bodies[name] = np.maximum(bodies.get(name, 0.0), distance)
            else:
                stiff = {name: theory.variants(plates[name])[1] for name, theory in theories.items()}
                truth = again(stiff if plate.any() else thick)
            for quantity, values in without.items():
                sizes[quantity] = max(sizes.get(quantity, 0.0), largest(truth[quantity] - values))
                if len(of.time) > 1 and quantity[1] not in MOVED:
                    apart = peaks_apart(of.time, values, truth[quantity])
                    peaks[quantity] = max(peaks.get(quantity, 0.0), apart)
    except (ComputationError, np.linalg.LinAlgError):
        return Lacking()
    return Lacking(sizes, by, bodies, peaks)


def causes(theory: Theory, p: Any, beam: Any, plate: Any) -> dict[str, float]:
    """Each cause's energy over the strain energy of solutions p (t, n), to first order, by the forces (t, n) that thick
    beams (`beam`) and their plate action leave in the thick beams' equations.
    """
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
    return {name: float(np.abs(values).max(initial=0.0) / energy) for name, values in work.items()}


def largest(values: Floats) -> float:
    """Largest size of numbers over time (t,), or of vectors (t, ..., 3)."""
    return float(np.abs(values).max()) if values.ndim == 1 else float(np.sqrt((values**2).sum(axis=-1)).max())


def words(causes: Mapping[str, float]) -> str:
    """Names of the causes that are not negligible, the largest first: ``shear and rotary inertia``."""
    limit = max(NAMED * max(causes.values(), default=0.0), NONE)
    chosen = [WORDS[name] for name, share in sorted(causes.items(), key=lambda item: -item[1]) if share > limit]
    return " and ".join([", ".join(chosen[:-1]), chosen[-1]] if len(chosen) > 1 else chosen)


def described(structure: Structure, causes: Mapping[str, float]) -> str:
    """Names of the causes, and the assumptions of the estimate: ``shear; assumed: Poisson's ratio 0.3``."""
    if structure.source is None or not causes:
        return ""
    named, assumed = words(causes), assumptions(structure.source.beam)
    return f"{named}; assumed: {', '.join(assumed)}" if named and assumed else named
