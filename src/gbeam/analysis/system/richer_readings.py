"""Readings of richer systems beside those of a solution, by small departures from it or by runs, with ringing.

The residual that a solution leaves in a richer system is answered by that system's small departures, over time or at
rest. Systems with controllers, and states of rest, are computed again instead.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np

from gbeam.analysis.accuracy.beam_theory import Lacking, thick_beam_differences
from gbeam.analysis.accuracy.correction import (
    DEFLECTION,
    PLACE,
    Correction,
    Departures,
    Embedding,
    Quantity,
    Reading,
    State,
)
from gbeam.analysis.accuracy.looks import Looks
from gbeam.analysis.system.richer import coarser, judged_bodies, linear_about_rest, richer, theories_of, with_beams
from gbeam.analysis.system.solution import Solution, elastic_accelerations, first_order_sizes
from gbeam.arrays.types import Flags, Floats
from gbeam.errors import ComputationError
from gbeam.integrate.equations import Trajectory
from gbeam.mechanics.tree.system import System
from gbeam.results.parts import Base

Recompute = Callable[[System], Solution]  # solution of another system, at the results' times
Rerun = Callable[[System, Iterable[str]], Reading]  # runs another system, and reads some of its bodies
TOGETHER = "with more shapes of the same models the system does not follow: too few shapes count as the models' error"
UNKNOWN = "errors by the theory of slender beams are not known: "
BENT_FAR = UNKNOWN + "thick beams do not follow"
LOOP_LOST = UNKNOWN + "controllers do not hold the system with more shapes in its beams"
RUNAWAY = 10.0  # times the motion, or the extent of the system: a larger answer of linear equations is none


@dataclass(frozen=True)
class Starting:
    """Starts of richer systems. `flags` tell what is bent and accelerated, see :func:`unknown_at_start`. `state` gives
    the coordinates and rates at which they begin, or the last of these.
    """

    flags: Callable[[System], tuple[Flags, Flags]]
    state: Callable[[System], State] | None = None


class Ringing(NamedTuple):
    """Bounds (k,) of the ringing of unresolved modes: their frequencies, rad/s, and the amplitudes of quantities."""

    rate: Floats
    sizes: Mapping[Quantity, Floats]


class RicherReadings(NamedTuple):
    """Readings, at the times of the `looks`, of what is computed and of richer systems.

    `truth` is the exact model with more shapes. `shapes` and `model` are pairs that differ by too few shapes and by the
    models. `alone` are systems in which one body alone is richer, `mesh` is the one with coarser meshes. The `note`
    says why models are not judged by themselves.
    """

    looks: Looks
    computed: Reading
    truth: Reading
    shapes: tuple[Reading, Reading]
    model: tuple[Reading, Reading]
    alone: list[Reading]
    mesh: Reading | None
    rings: Ringing | None = None
    note: str = ""


def reader_of_runs(recompute: Recompute, count: int) -> Rerun:
    """Function that runs a system and reads some bodies; ComputationError if the run has fewer than `count` times."""

    def rerun(system: System, bodies: Iterable[str]) -> Reading:
        solution = recompute(system)
        if len(solution.trajectory.time) < count:
            raise ComputationError("not converged", "the richer system has no response")
        return solution.read(bodies)

    return rerun


def run_richer(solution: Solution, rerun: Rerun, bases: Mapping[str, Base], computed: Reading) -> RicherReadings:
    """Read richer systems by running them, beside the readings `computed` from a solution."""
    system = solution.system
    judged = judged_bodies(system)
    exact = all(body.exact for body in judged.values())
    truth = rerun(richer(system, bases, exact=True).system, judged)
    alone = list[Reading]()
    if len(bases) > 1:
        for name, base in bases.items():
            alone.append(_run_one_richer(rerun, richer(system, {name: base}, exact=True).system, truth))
    same, note = truth, ""  # the same models with more shapes
    if not exact:
        try:
            same = rerun(richer(system, bases, exact=False).system, judged)
        except ComputationError:
            same, note = computed, TOGETHER
    rough, looks = coarser(system), Looks.all_times(solution.trajectory.time)
    mesh = None if rough is None else rerun(rough, judged)
    # The errors of models lie between the system with more shapes of the same models and the exact one.
    return RicherReadings(looks, computed, truth, (computed, same), (same, truth), alone, mesh, note=note)


def _run_one_richer(rerun: Rerun, system: System, truth: Reading) -> Reading:
    """Readings of a system in which one body alone is richer, of the same quantities as `truth`.

    They are NaN where its run fails, as for a craft that the other bodies keep in balance only if they are richer, too.
    """
    try:
        return rerun(system, [name for name, _ in truth if name])
    except ComputationError:
        return {quantity: np.nan * values for quantity, values in truth.items()}


def depart_to_richer(
    solution: Solution,
    bases: Mapping[str, Base],
    look: Callable[[Floats], Looks],
    starting: Starting | None,
    *,
    straight: bool,
) -> RicherReadings:
    """Read linearised richer systems: the exact models with more shapes, the same models with more shapes, of several
    bodies each alone richer, and the system with coarser meshes.

    If `straight`, departures are those from undeformed bodies.
    """
    directions = solution.bent_directions(bases)
    rich = richer(solution.system, bases, exact=True, bent_directions=directions)
    embedding = solution.insert(rich.system, bases, rich.shared)
    linear = solution.posed(bases, linear_about_rest(rich.system, bases)) if straight else None
    departures, residual = embedding.departures(linear), embedding.residual()
    if linear is not None and not departures.inert:  # light arms on hinges that follow one another
        departures = embedding.departures()
    begun = _initial_departure(starting, rich.system, embedding, departures)
    total, of_model = departures.answer(residual, begun), None
    if not all(solution.system.flexible[name].exact for name in bases):
        same = richer(solution.system, bases, exact=False, bent_directions=directions).system
        start = _initial_departure(starting, rich.system, embedding, departures, embedding.new_part, like=same)
        of_model = total.minus(departures.answer(embedding.new_part(residual), start))
    alone = list[Correction]()
    for name in bases if len(bases) > 1 else ():
        # The residual of a system in which this body alone is exact. The others feel it only through the joints.
        one_richer = richer(solution.system, {name: bases[name]}, exact=True, bent_directions=directions)
        one = solution.insert(one_richer.system, (), one_richer.shared)
        kept = [k for k, body in enumerate(one.richer.bodies) if body == name or body not in bases]
        onto = np.zeros((len(one.richer.names), residual.shape[1]))  # from its unknowns to those of all richer bodies
        onto[kept, [embedding.richer.names.index(one.richer.names[k]) for k in kept]] = 1.0
        start = _initial_departure(starting, one_richer.system, one, departures, lambda r: r @ onto, rich.system)  # noqa: B023
        alone.append(departures.answer(one.residual() @ onto, start))
    rough = _coarser_departure(solution, bases, starting)
    parts = [total, *([] if of_model is None else [of_model, total.minus(of_model)]), *alone]
    sizes = [embedding.richer.sizes(part) for part in parts]
    sizes += [] if rough is None else [rough[0].richer.sizes(rough[1])]
    looks = look(np.concatenate(sizes, axis=1))
    computed, truth = solution.select(looks.at).read(bases), embedding.read_corrected(total, looks.at)
    few_shapes = computed if of_model is None else embedding.read_corrected(of_model, looks.at)
    return RicherReadings(
        looks, computed, truth, (few_shapes, truth), (computed, few_shapes),
        [embedding.read_corrected(departure, looks.at) for departure in alone],
        None if rough is None else rough[0].read_corrected(rough[1], looks.at),
        _ringing(rich.system, bases, embedding, *departures.ringing(residual, begun)),
    )  # fmt: skip


def _coarser_departure(
    solution: Solution, bodies: Iterable[str], starting: Starting | None
) -> tuple[Embedding, Correction] | None:
    """The solution in the system with coarser meshes, and its departure there, or None if no solid has one."""
    rough = coarser(solution.system)
    if rough is None:
        return None
    embedding = solution.insert(rough, bodies)
    departures = embedding.departures()
    start = _initial_departure(starting, rough, embedding, departures)
    return embedding, departures.answer(embedding.residual(), start)


def _ringing(system: System, bodies: Iterable[str], embedding: Embedding, rate: Floats, amplitude: Floats) -> Ringing:
    """Bounds of the ringing of deflections and root loads, by elastic forces, from amplitudes (n, k) of modes."""
    sizes = dict[Quantity, Floats]()
    for name in bodies:
        body, columns = system.flexible[name], [k for k, owner in enumerate(embedding.richer.bodies) if owner == name]
        q = amplitude[columns].T
        deflection, force, moment = first_order_sizes(body, q, elastic_accelerations(body, q))
        sizes |= {(name, DEFLECTION): deflection, (name, "force"): force, (name, "moment"): moment}
    return Ringing(rate, sizes)


def differences_to_thick_beams(
    solution: Solution,
    rerun: Rerun | None,
    extent: float,
    look: Callable[[Floats], Looks],
    starting: Starting | None,
) -> tuple[Lacking, str]:
    """Differences between slender and thick beams, and the reason in words if they are not known.

    In a loop they follow from runs, else from the residual in the equations of thick beams, bent as the solution is,
    since a bend couples to twist.
    """
    theories = theories_of(solution.system)
    if not theories:
        return Lacking(), ""
    loop = rerun if len(solution.trajectory.time) > 1 else None
    bent = partial(with_beams, solution.system)
    thick = bent({name: theory.thick for name, theory in theories.items()})

    def begun(departures: Departures, embedding: Embedding, plate: Floats) -> State | None:
        """Initial departure of thick beams from slender ones."""
        if starting is None or starting.state is None:
            return _initial_departure(
                starting, thick, embedding, departures, lambda r: r + embedding.trajectory.q[0] @ plate
            )
        departure = np.zeros((2, len(embedding.richer.names)))
        for sign, other in ((-1, bent({name: theory.slender for name, theory in theories.items()})), (1, thick)):
            names, values = other.unknown_coordinates, np.array(starting.state(other))
            departure[:, [embedding.richer.names.index(name) for name in names[-values.shape[1] :]]] += sign * values
        return departure[0], departure[1]

    lacking = thick_beam_differences(
        solution.posed(theories),
        solution.trajectory,
        theories,
        lambda beams: solution.posed(theories, bent(beams)),
        begun,
        look,
        None if loop is None else lambda beams: loop(bent(beams), theories),
    )
    if lacking.sizes.get(PLACE, math.nan) <= RUNAWAY * extent:
        return lacking, ""
    return Lacking(), BENT_FAR if loop is None else LOOP_LOST


def _initial_departure(
    starting: Starting | None,
    system: System,
    embedding: Embedding,
    departures: Departures,
    part: Callable[[Floats], Floats] = np.asarray,
    departing: System | None = None,
    like: System | None = None,
) -> State | None:
    """Initial departure of a solution within another `system`, or None in equilibrium.

    It follows from a `part` of the residual at the start, or leads to the state in which the system begins, or one
    `like` it. The `departing` system is the same unless another one is passed.
    """
    if starting is None:
        return None
    if starting.state is not None:
        return _difference_of_starts(starting.state, system if like is None else like, embedding.trajectory)
    flags = starting.flags(system)
    residual = part(embedding.held_residual(flags[1]))
    return departures.settled(residual, *(flags if departing is None else starting.flags(departing)))


def _difference_of_starts(state: Callable[[System], State], system: System, trajectory: Trajectory) -> State:
    """Initial state of a system, or of its last coordinates, minus that of a trajectory, or NaN if it has none."""
    departure = np.zeros((2, trajectory.q.shape[1]))
    try:
        start = state(system)
    except ComputationError:
        departure[:] = np.nan
        return departure[0], departure[1]
    for row, values, coordinates in zip(departure, start, (trajectory.q[0], trajectory.qd[0]), strict=True):
        size = len(values)
        row[-size:] = values - coordinates[-size:]  # the axial shapes, which SFOAM lacks, come first
    return departure[0], departure[1]
