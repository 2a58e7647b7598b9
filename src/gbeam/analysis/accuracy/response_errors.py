"""Errors of a beam's response from too few shapes and from its model, by the exact model with more shapes, and from the
theory of slender beams.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from gbeam.analysis.accuracy.beam_theory import Lacking, beyond, described, largest
from gbeam.analysis.accuracy.correction import PLACE, RESOLVED, IntArray, Posed, Quantity, Reading, State, Within
from gbeam.analysis.accuracy.estimate import BEAM, UNMOVED, Judgement, negligible, of_bodies, unjudged
from gbeam.arrays.tree import each_leaf
from gbeam.arrays.types import Floats
from gbeam.errors import ComputationError
from gbeam.integrate.equations import Trajectory
from gbeam.mechanics.enrichment import Enrichment, Twin, enrichment
from gbeam.mechanics.section_forces import section_forces, sections
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.theory import theory_of
from gbeam.motion.protocol import Motion
from gbeam.results.errors import ErrorEstimate, Errors, StepErrors
from gbeam.results.parts import Base, Loads
from gbeam.structure.section import extreme_stresses

FORCE, MOMENT, STRESS, SHEARED = ((BEAM, each) for each in ("force", "moment", "stress", "sheared"))
Begin = Callable[[Structure], tuple[Floats, Floats]]
SCAN = 200  # samples at which to look for directions without shapes that are moved
BENT = 0.1  # of the length: a tip that moves by less leaves the beam straight for small departures
IDLE = 1e-9  # of the largest force: a direction with a smaller one gets no shapes
FEWEST, PER_PERIOD = 500, 6  # samples looked at, in all and in a period of the lowest mode
MOST = 20_000  # samples where fast modes may ring
LARGEST = 2.0  # times (v/L)²: error of a second-order model, up to what a beam that points inward on a hub has
TOO_FAR = "the solution is too far from the exact model's for an estimate; it is the bound 2 (v/L)² of its class"


@dataclass(frozen=True, eq=False)
class Solution:
    """A structure, its trajectory `of` (coordinates, rates and accelerations at times), and its inputs at these times:
    the motion of its base, or the torque on a free `hub`, and its loads.
    """

    structure: Structure
    of: Trajectory
    inputs: Any
    hub: Any = None

    @classmethod
    def driven(cls, structure: Structure, motion: Any, of: Trajectory) -> Solution:
        """Solution with the inputs of a motion."""
        loads = None if structure.history is None else np.asarray(structure.history(of.time))
        if motion.free:
            return cls(structure, of, (np.asarray(motion.torque(of.time)), loads), motion)
        return cls(structure, of, (each_leaf(np.asarray, motion.base(of.time)), loads))

    @property
    def first(self) -> int:
        """Index of the beam's first coordinate among the unknowns."""
        return int(self.hub is not None)

    @property
    def loads(self) -> Floats | None:
        """Components of the loads, (t, loads, 6); None without loads."""
        return self.inputs[1]

    @property
    def base(self) -> Base:
        """Motion of its base."""
        of = self.of
        base = self.inputs[0] if self.hub is None else self.hub.mount.base(of.q[:, 0], of.qd[:, 0], of.qdd[:, 0])
        return each_leaf(np.asarray, base)

    def at(self, times: Any) -> Solution:
        """The solution at an index, slice or array of its times."""
        return replace(self, of=self.of.at(times), inputs=each_leaf(lambda leaf: leaf[times], self.inputs))

    def posed(self, structure: Structure | None = None) -> Posed:
        """Equations of its structure, or of another, under its inputs."""
        structure = self.structure if structure is None else structure
        return Posed(
            structure.residual(self.hub),
            lambda times: self.at(times).inputs,
            ["hub.angle"] * self.first + [f"{BEAM}.q{k + 1}" for k in range(structure.size)],
            lambda of: replace(self, structure=structure, of=of).read(),
        )

    def within(self, rich: Structure, index: IntArray | None = None) -> Within:
        """The solution put into the equations of another structure, where its shapes have the numbers `index`."""
        index = np.arange(self.structure.size) if index is None else index
        shared = np.append(np.arange(self.first), self.first + index)
        return Within.lifted(self.posed(rich), self.posed(), self.of, shared)

    def read(self) -> Reading:
        """Displacement of the tip (t, 3) m, force and moment (t, 3) at the root, and the largest normal stress over the
        sections (t,); of a solid the stress (t, c) of `recovery.felt`, of other structures NaN.
        """
        structure, of, base = self.structure, self.of, self.base
        q, qd, qdd = (values[:, self.first :] for values in (of.q, of.qd, of.qdd))
        if structure.sections is None:
            ends = section_forces(structure, base, q, qd, qdd, of.time)
            stress = np.full(len(q), np.nan) if structure.recovery is None else structure.recovery.felt(q)
            tip = np.asarray(structure.displacement(q))[:, -1]
            return {PLACE: tip, FORCE: ends.force[:, 0], MOMENT: ends.moment[:, 0], STRESS: stress}
        loads = sections(structure, structure.sections, base, q, qd, qdd, self.loads)
        tip = loads.place[:, -1] - structure.station_places.r0[-1]
        pair = extreme_stresses(structure.sections.values, loads.section_force, loads.section_moment)
        stress = np.maximum(pair[0], -pair[1]).max(axis=1)
        return {PLACE: tip, FORCE: loads.force[:, 0], MOMENT: loads.moment[:, 0], STRESS: stress}

    def along(self, more: Enrichment | Twin) -> tuple[bool, bool, bool]:
        """Flags of x, y and z: True if the solution has shapes along the axis, or would move new ones."""
        structure = self.structure
        if isinstance(more, Twin) or all(structure.counts[:3]):
            return True, True, True
        rich, index = more.model(structure.kind)
        at, base, c = self.within(rich, index).of, self.base, rich.coefficients
        p, pd, pdd = (values[:, self.first :] for values in (at.q, at.qd, at.qdd))
        residual = c.residual(p, pd, pdd, base.a_WO_B, base.w_WB_B, base.alpha_WB_B, self.loads)
        counts = np.cumsum([0, *rich.counts])
        forces = [np.abs(residual[:, a:b]).max(initial=0.0) for a, b in pairwise(counts)]
        limit = IDLE * max(np.abs(p @ c.stiffness).max(), *forces)
        axial, along_y, along_z = (n > 0 or size > limit for n, size in zip(structure.counts[:3], forces, strict=False))
        return axial, along_y, along_z

    def theory(self, begin: Begin | None = None, *, straight: bool) -> Lacking:
        """Differences to the theory of thick beams, which begin by `begin`, or in equilibrium if it is None; `straight`
        if they may be linearised about the straight beam.
        """
        if self.structure.source is None:
            return Lacking()
        theory = theory_of(self.structure) if straight else theory_of(self.structure).exact

        def begun(*_: Any) -> State | None:
            if begin is None:
                return None
            slender, thick = (begin(structure) for structure in (theory.slender, theory.thick))
            new = theory.thick.size - theory.slender.size
            q, qd = (
                np.pad(more - np.pad(less, (0, new)), (self.first, 0))
                for less, more in zip(slender, thick, strict=True)
            )
            return q, qd

        return beyond(self.posed(), self.of, {BEAM: theory}, lambda beams: self.posed(beams[BEAM]), begun)


class Rings(NamedTuple):
    """Bounds (k,) of the ringing of modes that the samples do not resolve: rad/s, m, N, N m."""

    rate: Floats
    place: Floats
    force: Floats
    moment: Floats


def lacking(
    solution: Solution, computed: Reading, begin: Begin | None, *, straight: bool
) -> tuple[Reading, Reading, Rings]:
    """Readings by the exact model with more shapes, and with the shapes of the solution; bounds of unresolved modes.
    `straight` linearises the exact model about the straight beam, not about the solution.
    """
    kind, count = solution.structure.kind, len(solution.of.time)
    more = enrichment(solution.structure, solution.base)
    directions = solution.at(np.linspace(0, count - 1, min(count, SCAN)).astype(int)).along(more)
    exact, index = more.model("exact", directions=directions)
    within = solution.within(exact, index)
    linear = solution.posed(replace(exact, linear=True)) if straight else None
    departures, residual = within.departures(linear), within.residual()

    def start(richer: Structure) -> State | None:
        return None if begin is None else _departure(begin, richer, within.of)

    begun, few_shapes = start(exact), computed
    total = departures.answer(residual, begun)
    if kind != exact.kind:
        same = more.model(kind, directions=directions)[0]
        few_shapes = within.moved(total.less(departures.answer(within.of_new(residual), start(same))))
    return within.moved(total), few_shapes, _rings(exact, *departures.shaken(residual, begun))


def by_mesh(solution: Solution, computed: Reading, begin: Begin | None) -> tuple[Reading, Reading] | None:
    """Pair of readings: by a coarser mesh, and as computed; None if the structure has no coarser mesh."""
    rough = solution.structure.coarser
    if rough is None:
        return None
    within = solution.within(rough)
    begun = None if begin is None else _departure(begin, rough, within.of)
    return within.moved(within.departures().answer(within.residual(), begun)), computed


def _rings(exact: Structure, rate: Floats, amplitude: Floats) -> Rings:
    """Bounds of ringing at the tip and, by the elastic forces, at the root, by amplitudes (first + n, k) of modes."""
    c, q = exact.coefficients, amplitude[-exact.size :]
    inertia = np.linalg.solve(c.mass, c.stiffness @ q)
    vectors = exact.displacement(q.T)[:, -1], (c.f_a @ inertia).T, (c.f_al @ inertia).T
    return Rings(rate, *(np.linalg.norm(vector, axis=1) for vector in vectors))


def _departure(begin: Begin, richer: Structure, of: Trajectory) -> State:
    """Initial state of a richer structure, by `begin`, minus the first state; NaN if it has none."""
    departure = np.zeros((2, of.q.shape[1]))
    try:
        state = begin(richer)
    except ComputationError:
        departure[:] = np.nan
        return departure[0], departure[1]
    for row, begun, coordinates in zip(departure, state, (of.q[0], of.qd[0]), strict=True):
        row[-richer.size :] = begun - coordinates[-richer.size :]  # the axial shapes, which SFOAM lacks, come first
    return departure[0], departure[1]


def stated(structure: Structure, tip: Floats, loads: Loads, q: Floats) -> Reading:
    """Readings of a response as it is stated, from its tip's displacement (t, 3) m, loads and coordinates (t, n)."""
    felt = loads.stress.max(axis=1) if structure.recovery is None else structure.recovery.felt(q)
    sheared = np.zeros(len(tip)) if loads.von_mises is None else np.nan_to_num(loads.von_mises).max(axis=1)
    return {PLACE: tip, FORCE: loads.force[:, 0], MOMENT: loads.moment[:, 0], STRESS: felt, SHEARED: sheared}


def errors_of(
    structure: Structure,
    shapes: tuple[Reading, Reading],
    model: tuple[Reading, Reading],
    beyond: Lacking,
    steps: Mapping[Quantity, float],
    sizes: Mapping[Quantity, float],
    mesh: tuple[Reading, Reading] | None,
    time: Floats | None = None,
    peaks_by_step: Mapping[Quantity, float] = MappingProxyType({}),
) -> Errors:
    """Errors of a structure alone by pairs of readings that differ by shapes, model (of beams) and mesh; of a response,
    at times (t,) s, also of peaks.
    """
    nothing = negligible(sizes, BEAM, structure.length)
    if sizes[PLACE] <= UNMOVED * structure.length:
        nothing.add(PLACE)
    judgement = Judgement(shapes, model, beyond, steps, sizes, nothing, mesh, time, peaks_by_step)
    tip, loads, stress = judgement.error(PLACE), judgement.loads(BEAM), judgement.error(STRESS)
    if structure.source is None and structure.exact:
        tip, loads, stress = (replace(error, model=math.nan) for error in (tip, loads, stress))
    return Errors(tip, loads, stress, unjudged(structure), described(structure, beyond.causes.get(BEAM, {})))


def response_errors(
    structure: Structure,
    motion: Motion,
    of: Trajectory,
    tip: Floats,
    loads: Loads | None,
    steps: StepErrors,
    *,
    stride: int = 1,
    begin: Begin | None = None,
    tolerance: float = math.inf,
) -> tuple[Errors, tuple[str, ...]]:
    """Estimated errors of a response, as fractions of the largest tip displacement, load and stress, and warnings.

    `steps` are those of the time steps; `tip` (t, 3) and `loads` are the results, one for every
    `stride` steps of the solution `of`. A solution that does not resolve a mode that rings is judged at more steps.
    """
    if not structure.judged or loads is None or len(tip) < 3:
        force, moment, stress = steps.peaks or (math.nan,) * 3
        parts = (steps.displacement, math.nan), (steps.loads, max(force, moment)), (steps.stress, stress)
        of_steps = [ErrorEstimate(step=step, total=step, peak=peak) for step, peak in parts]
        if loads is None or not np.isfinite(loads.stress).any():  # such as that of particles, which is not known
            of_steps[2] = ErrorEstimate()
        return Errors(of_steps[0], of_steps[1], of_steps[2], unjudged(structure)), ()
    readings = stated(structure, tip, loads, of.q[::stride, -structure.size :])
    sizes = {quantity: largest(values) for quantity, values in readings.items()}
    straight = sizes[PLACE] <= BENT * structure.length
    period = 2 * math.pi / float(structure.rest[0][0])
    step, least = float(of.time[1] - of.time[0]), math.ceil(len(of.time) / MOST)
    skipped = max(1, min(int(period / PER_PERIOD / (stride * step)), len(tip) // FEWEST))
    stride *= skipped
    by_step = {PLACE: steps.displacement, FORCE: steps.loads, MOMENT: steps.loads, STRESS: steps.stress}
    peaks_by_step = dict(zip((FORCE, MOMENT, STRESS), steps.peaks, strict=False))
    solution = Solution.driven(structure, motion, of.at(slice(None, None, stride)))
    with np.errstate(all="ignore"):
        beyond = solution.theory(begin, straight=straight)

    def judged(solution: Solution, computed: Reading) -> tuple[Errors, float]:
        """Errors by a solution at some of the steps, and the frequency, rad/s, of a mode that these do not resolve."""
        with np.errstate(all="ignore"):
            truth, exact, rings = lacking(solution, computed, begin, straight=straight)
            mesh = by_mesh(solution, computed, begin)
        if not np.isfinite(truth[PLACE]).all():
            bounded = structure.source is not None
            of_steps = steps.displacement
            return _bounded(structure, sizes[PLACE], of_steps) if bounded else Errors(ErrorEstimate(of_steps)), 0.0
        apart, time = ((exact, truth), (computed, exact)), solution.of.time
        errors = errors_of(structure, *apart, beyond, by_step, sizes, mesh, time, peaks_by_step)
        return errors, _missed(rings, sizes, errors, RESOLVED / (least * step))

    errors, rate = judged(solution, {quantity: values[::skipped] for quantity, values in readings.items()})
    finer = max(least, int(RESOLVED / (rate * step))) if rate else stride
    if finer < stride:
        solution = Solution.driven(structure, motion, of.at(slice(None, None, finer)))
        errors, _ = judged(solution, solution.read())
    return errors, tuple(of_bodies(structure, beyond, sizes[PLACE], tolerance))


def _missed(rings: Rings, sizes: dict[Quantity, float], errors: Errors, fastest: float) -> float:
    """Frequency, rad/s, of the fastest mode, below `fastest`, whose ringing may exceed the stated errors; 0 if none."""
    limits = zip((PLACE, FORCE, MOMENT), (errors.displacement, errors.loads, errors.loads), strict=True)
    visible = np.zeros(len(rings.rate), dtype=bool)
    for quantity, error in limits:
        visible |= getattr(rings, quantity[1]) > error.slender * sizes[quantity]
    return float(rings.rate[visible & (rings.rate < fastest)].max(initial=0.0))


def _bounded(structure: Structure, size: float, step: float) -> Errors:
    """Errors of a response too far from the exact model's for an estimate, by a bound on the largest displacement."""
    model = LARGEST * (size / structure.length) ** 2
    return Errors(ErrorEstimate(step, math.nan, model, total=step + model), note=TOO_FAR)
