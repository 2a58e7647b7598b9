"""Errors of the theory of slender beams: by shear, rotary inertia and twist, unless the model has them, and by plate
action.

A solution is put into the equations of thick beams, bent as it is. The residual there, beyond that of slender beams, is
answered by the thick beams, without plate action and with it: the larger answer counts.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import reduce
from itertools import compress
from typing import Any, NamedTuple, TypeVar

import numpy as np

from gbeam.analysis.accuracy.correction import MOVED, Correction, Departures, Embedding, Posed, Quantity, Reading, State
from gbeam.analysis.accuracy.looks import Looks
from gbeam.arrays.types import Floats
from gbeam.errors import ComputationError
from gbeam.integrate.equations import Trajectory
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.theory import Theory
from gbeam.structure.beam import assumptions

NAMED, NEGLIGIBLE = 0.02, 1e-9  # of the largest cause, and of the energy: a smaller one is not named
LESSER = 0.1  # of a difference: a smaller one beside it is not worth a run
_K = TypeVar("_K")
WORDS = {"shear": "shear", "rotary": "rotary inertia", "twist": "twist", "plate": "plate action"}


# Initial departure, or None for equilibrium, by linear equations, with a stiffness (n, n) that these have besides.
Begun = Callable[[Departures, Embedding, Floats], State | None]


class Lacking(NamedTuple):
    """Largest difference of each quantity between slender and thick beams, or empty where thick beams have no answer.

    By beam there are the share of each cause in the energy, and the displacements (b,) m of the masses on it between
    the two. Over time there is the difference of each quantity's peaks.
    """

    sizes: Mapping[Quantity, float] = {}
    causes: Mapping[str, Mapping[str, float]] = {}
    bodies: Mapping[str, Floats] = {}
    peaks: Mapping[Quantity, float] = {}

    def or_larger(self, other: Lacking) -> Lacking:
        """Return the larger of both differences for each quantity, with the causes of this one."""
        sizes, peaks = _larger(self.sizes, other.sizes), _larger(self.peaks, other.peaks)
        return Lacking(sizes, self.causes, _larger(self.bodies, other.bodies), peaks)

    def is_significant(self, largest: Lacking) -> bool:
        """True if the difference of a quantity is more than a LESSER part of the largest."""
        return any(size > LESSER * largest.sizes[key] for key, size in self.sizes.items())


def _larger(one: Mapping[_K, Any], other: Mapping[_K, Any]) -> dict[_K, Any]:
    """Return the larger of both values of every key, or NaN where one is NaN."""
    return {key: np.maximum(value, other[key]) for key, value in one.items()}


def thick_beam_differences(
    solved: Posed,
    trajectory: Trajectory,
    theories: Mapping[str, Theory],
    pose: Callable[[Mapping[str, Structure]], Posed],
    begun: Begun,
    look: Callable[[Floats], Looks],
    rerun: Callable[[Mapping[str, Structure]], Reading] | None = None,
) -> Lacking:
    """Differences between slender and thick beams at a solution of the equations `solved`, their `trajectory`.

    `pose` returns equations with other beams, `begun` the difference of their initial states, and `look` the times to
    read, chosen by sizes of departures.

    With `rerun`, systems with slender and thick beams are run instead, as in a loop, whose controllers answer too.
    Thick beams run with and without plate action, unless the answers without controllers say that one of the two makes
    only a LESSER part of every difference.
    """
    compared = _Compared.from_solution(solved, trajectory, theories, pose)
    try:
        linear = compared.answered(begun, look)
        largest = reduce(Lacking.or_larger, linear)
        if rerun is None:
            return largest
        worth_a_run = (lacking.is_significant(largest) for lacking in linear)
        plated = [*compress(compared.plated, worth_a_run)] or compared.plated
        run = compared.run(rerun, plated)
    except (ComputationError, np.linalg.LinAlgError):
        return Lacking()
    return reduce(Lacking.or_larger, run)._replace(causes=largest.causes)


class _Compared(NamedTuple):
    """A solution put into the equations of slender beams, `thin`, and of thick ones, `full`.

    By beam there are its columns among the unknowns of `full` and its stiffness (n, n) by plate action. `plated` has a
    flag for each kind of thick beams that is compared: without plate action, and with it.
    """

    theories: Mapping[str, Theory]
    thin: Embedding
    full: Embedding
    columns: Mapping[str, list[int]]
    plates: Mapping[str, Floats]
    plated: Sequence[bool]

    @classmethod
    def from_solution(
        cls,
        solved: Posed,
        trajectory: Trajectory,
        theories: Mapping[str, Theory],
        pose: Callable[[Mapping[str, Structure]], Posed],
    ) -> _Compared:
        """Put a solution of the equations `solved` into those of slender and of thick beams."""
        slender = {name: theory.slender for name, theory in theories.items()}
        thick = {name: theory.thick for name, theory in theories.items()}
        thin = Embedding.lifted(pose(slender), solved, trajectory)
        full = Embedding.lifted(pose(thick), thin.richer, thin.trajectory)
        columns = {name: [k for k, body in enumerate(full.richer.bodies) if body == name] for name in theories}
        plates = {name: theory.plate(full.trajectory.q[:, columns[name]]) for name, theory in theories.items()}
        plated = (False, True) if any(plate.any() for plate in plates.values()) else (False,)
        return cls(theories, thin, full, columns, plates, plated)

    def answered(self, begun: Begun, look: Callable[[Floats], Looks]) -> list[Lacking]:
        """Differences by the small departures of thick beams that cancel the residual, for each flag of `plated`."""
        q, residual = self.full.trajectory.q, self.full.residual()
        shares, stiffness = dict[str, Mapping[str, float]](), np.zeros((q.shape[1],) * 2)  # of all plates
        for name, theory in self.theories.items():
            columns, plate = self.columns[name], self.plates[name]
            bent = q[:, columns]
            shares[name] = causes(theory, bent, residual[:, columns], bent @ plate)
            stiffness[np.ix_(columns, columns)] = plate
        departures, answers = self.full.departures(), list[Correction]()
        for plated in self.plated:
            added = plated * stiffness
            stiffer = departures.stiffer(added)
            answers.append(stiffer.answer(residual + q @ added, begun(stiffer, self.full, added)))
        looks = look(np.concatenate([self.full.richer.sizes(answer) for answer in answers], axis=1))
        slender_reading, differences = self.thin.read(looks.at), list[Lacking]()
        for answer in answers:
            sizes, peaks = _differences(looks, slender_reading, self.full.read_corrected(answer, looks.at))
            bodies = dict[str, Floats]()
            for name, theory in self.theories.items():
                moved = np.einsum("bai,ti->tba", theory.bodies, answer.value[:, self.columns[name]])
                bodies[name] = np.linalg.norm(moved, axis=2).max(axis=0)
            differences.append(Lacking(sizes, shares, bodies, peaks))
        return differences

    def run(self, rerun: Callable[[Mapping[str, Structure]], Reading], plated: Sequence[bool]) -> list[Lacking]:
        """Differences between runs of systems with slender beams and with thick ones, for each flag of plate action."""
        slender_reading = rerun({name: theory.slender for name, theory in self.theories.items()})
        answers = list[Lacking]()
        for flag in plated:
            stiff = {name: theory.variants(self.plates[name])[flag] for name, theory in self.theories.items()}
            sizes, peaks = _differences(Looks.all_times(self.full.trajectory.time), slender_reading, rerun(stiff))
            answers.append(Lacking(sizes, peaks=peaks))
        return answers


def _differences(
    looks: Looks, slender_reading: Reading, thick_reading: Reading
) -> tuple[dict[Quantity, float], dict[Quantity, float]]:
    """Largest differences of readings, and over time the differences of their peaks."""
    sizes = {key: largest(thick_reading[key] - values) for key, values in slender_reading.items()}
    judged = [key for key in slender_reading if len(looks.at) > 1 and key[1] not in MOVED]
    return sizes, {key: looks.peak_difference(slender_reading[key], thick_reading[key]) for key in judged}


def causes(theory: Theory, p: Any, beam: Any, plate: Any) -> dict[str, float]:
    """Energy of each cause as a share of the strain energy of solutions p (t, n), to first order.

    It is the work of the forces (t, n) that thick beams (`beam`) and their plate action (`plate`) leave in the thick
    beams' equations.
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
    """Largest absolute value over time of numbers (t,), or largest norm of vectors (t, ..., 3)."""
    return float(np.abs(values).max()) if values.ndim == 1 else float(np.sqrt((values**2).sum(axis=-1)).max())


def words(causes: Mapping[str, float]) -> str:
    """Names of the causes that are not negligible, the largest first, such as ``shear and rotary inertia``."""
    limit = max(NAMED * max(causes.values(), default=0.0), NEGLIGIBLE)
    ordered = sorted(causes.items(), key=lambda item: -item[1])
    chosen = [WORDS[name] for name, share in ordered if share > limit]
    return " and ".join([", ".join(chosen[:-1]), chosen[-1]] if len(chosen) > 1 else chosen)


def described(structure: Structure, causes: Mapping[str, float]) -> str:
    """Names of the causes, and the assumptions of the estimate, such as ``shear; assumed: Poisson's ratio 0.3``."""
    if structure.source is None or not causes:
        return ""
    named, assumed = words(causes), assumptions(structure.source.beam)
    return f"{named}; assumed: {', '.join(assumed)}" if named and assumed else named
