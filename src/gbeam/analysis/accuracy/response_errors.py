"""Errors of a response from too few shapes and from its model, by the exact model with more shapes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gbeam.analysis.accuracy.correction import (
    Operator,
    Sampled,
    State,
    Vibration,
    complete_residual,
    linear_residual,
    operator,
    responses,
)
from gbeam.errors import ComputationError
from gbeam.mechanics.enrichment import Enrichment, Twin, enrichment
from gbeam.mechanics.section_forces import section_forces, sections
from gbeam.mechanics.structure import Structure
from gbeam.motion.bases.base import Base, mapped
from gbeam.motion.protocol import Motion
from gbeam.results.response import BaseMotion
from gbeam.results.result import Floats
from gbeam.structure.section import extreme_stresses

IntArray = NDArray[np.int_]
Begin = Callable[[Structure], tuple[Floats, Floats]]
SCAN = 200  # samples at which to look for that
IDLE = 1e-9  # of the largest force: a direction that feels less stays out


class Quantities(NamedTuple):
    """Tip (t, 3) m, the root's force and moment (t, 3), and the largest size of the stress over all sections (t,), of a
    structure without sections none.
    """

    tip: Floats
    force: Floats
    moment: Floats
    stress: Floats


class Parts(NamedTuple):
    """Errors over time, as differences from the truth."""

    shapes: Quantities
    model: Quantities
    total: Quantities


class Rings(NamedTuple):
    """Bounds (k,) of the ringing of modes that the samples do not resolve: rad/s, m, N, N m."""

    rate: Floats
    tip: Floats
    force: Floats
    moment: Floats


@dataclass(frozen=True, eq=False)
class Solution:
    """A solution at equal intervals: y and its rates (t, n), of a free hub its angle first."""

    time: Floats
    y: Floats
    yd: Floats
    ydd: Floats

    def some(self, chosen: slice | IntArray) -> Solution:
        """The solution at some of the times."""
        return Solution(*(x[chosen] for x in (self.time, self.y, self.yd, self.ydd)))


def lacking(
    structure: Structure,
    motion: Motion,
    solution: Solution,
    computed: Quantities | None = None,
    *,
    begin: Begin | None = None,
) -> tuple[Parts, Rings]:
    """Find what a solution lacks, quantity by quantity, over time, and what its samples may hide."""
    more = enrichment(structure, _base(motion, solution)[0])
    count = len(solution.time)
    few = solution.some(np.linspace(0, count - 1, min(count, SCAN)).astype(int))
    directions = driven(more, lambda rich, at: lifted(rich, at, motion, few))
    exact, index = more.model("exact", directions=directions)
    at = lifted(exact, index, motion, solution)
    mine = lifted(structure, np.arange(structure.size), motion, solution)
    of = operator(exact, at)
    vibration = Vibration.of(of, solution.time)
    residual = complete_residual(exact, at)
    # In its own coordinates the solution leaves what its model leaves out, in the new ones what its shapes do.
    first = residual.shape[1] - exact.size
    new = residual.copy()
    new[:, np.append(np.arange(first), first + index)] = 0.0
    if begin is None:
        rest = complete_residual(exact, at_rest(at))[0, first:]
        # After a machine's spin-up the solution does not begin at rest: that is nothing that it lacks.
        rest[index] -= complete_residual(structure, at_rest(mine))[0, first:]
        new_at_rest = rest.copy()
        new_at_rest[index] = 0.0
        start, start_of_shapes = (settled(of, each) for each in (rest, new_at_rest))
    else:
        same = exact if structure.kind == exact.kind else more.model(structure.kind, directions=directions)[0]
        start, start_of_shapes = (_departure(begin, each, at) for each in (exact, same))
    correction = responses(of, vibration, solution.time)
    total = correction(residual, start)
    if computed is None:
        computed = quantities(structure, mine)
    truth, same_shapes = quantities(exact, at.moved(*total)), computed
    if structure.kind != exact.kind:
        shapes = correction(new, start_of_shapes)
        same_shapes = quantities(exact, at.moved(*(a - b for a, b in zip(total, shapes, strict=True))))
    parts = Parts(
        Quantities(*(a - b for a, b in zip(truth, same_shapes, strict=True))),
        Quantities(*(a - b for a, b in zip(same_shapes, computed, strict=True))),
        Quantities(*(a - b for a, b in zip(truth, computed, strict=True))),
    )
    if exact.recovery is not None:
        stress = np.linalg.norm(exact.recovery.felt(total.value[:, first:]), axis=1)
        parts = Parts(*(each._replace(stress=stress) for each in parts))
    return parts, _rings(exact, *vibration.shaken(of, residual, start))


def _rings(exact: Structure, rate: Floats, amplitude: Floats) -> Rings:
    """Ringing of modes with amplitudes (first + n, k) at the tip and, by the elastic forces, at the root."""
    c, q = exact.coefficients, amplitude[-exact.size :]
    inertia = np.linalg.solve(c.mass, c.stiffness @ q)
    at = exact.displacement(q.T)[:, -1], (c.f_a @ inertia).T, (c.f_al @ inertia).T
    return Rings(rate, *(np.linalg.norm(each, axis=1) for each in at))


def quantities(structure: Structure, at: Sampled) -> Quantities:
    """Tip, root loads and stress at a solution, by NumPy for complete models too."""
    if structure.sections is None:
        base = BaseMotion(at.base.a_WO_B, at.base.w_WB_B, at.base.alpha_WB_B)
        ends = section_forces(structure, base, at.p, at.pd, at.pdd, at.time)
        tip = np.asarray(structure.displacement(at.p))[:, -1]
        return Quantities(tip, ends.force[:, 0], ends.moment[:, 0], np.zeros(len(tip)))
    loads = sections(structure, structure.sections, at.base, at.p, at.pd, at.pdd, at.loads)
    tip = loads.place[:, -1] - structure.station_places.r0[-1]
    pair = extreme_stresses(structure.sections.values, loads.section_force, loads.section_moment)
    return Quantities(tip, loads.force[:, 0], loads.moment[:, 0], np.maximum(pair[0], -pair[1]).max(axis=1))


def driven(more: Enrichment | Twin, lifted: Callable[[Structure, IntArray], Sampled]) -> tuple[bool, bool, bool]:
    """True if new shapes along x, y and z would be moved by a solution, lifted into a structure that has them."""
    structure = more.structure
    if isinstance(more, Twin) or all(structure.counts[:3]):
        return True, True, True
    rich, index = more.model(structure.kind)
    at = lifted(rich, index)
    residual = linear_residual(rich, at)
    counts = np.cumsum([0, *rich.counts])
    largest = [np.abs(residual[:, a:b]).max(initial=0.0) for a, b in pairwise(counts)]
    c = rich.coefficients
    limit = IDLE * max(np.abs(at.p @ c.stiffness).max(), *largest)
    axial, along_y, along_z = (n > 0 or size > limit for n, size in zip(structure.counts[:3], largest, strict=False))
    return axial, along_y, along_z


def lifted(structure: Structure, index: IntArray, motion: Any, solution: Solution) -> Sampled:
    """A solution in the coordinates of a structure with more shapes, its own at `index`."""
    time, y, yd, ydd = solution.time, solution.y, solution.yd, solution.ydd
    base, hub = _base(motion, solution)
    first = 0 if hub is None else 1
    p, pd, pdd = lifted = np.zeros((3, len(time), structure.size))
    for onto, x in zip(lifted, (y, yd, ydd), strict=True):
        onto[:, index] = x[:, first:]
    loads = None if structure.history is None else np.asarray(structure.history(time))
    return Sampled(time, base, p, pd, pdd, hub, motion if motion.free else None, loads)


def _base(motion: Any, solution: Solution) -> tuple[Base, Floats | None]:
    """Motion of the base; of a free hub its angle, rate and acceleration too, (t, 3)."""
    hub = None
    if motion.free:
        hub = np.stack([x[:, 0] for x in (solution.y, solution.yd, solution.ydd)], axis=1)
    base = motion.base(solution.time) if hub is None else motion.mount.base(*hub.T)
    return mapped(base, np.asarray), hub


def settled(of: Operator, rest: Floats) -> State:
    """Departure from the first state of the equilibrium, by the residual there at rest; a free hub is held."""
    beam = slice(of.mass.shape[0] - len(rest), None)
    return np.asarray(np.linalg.solve(of.first()[beam, beam], -rest)), np.zeros_like(rest)


def _departure(begin: Begin, richer: Structure, at: Sampled) -> State:
    """Departure from the first state of that in which a richer structure begins; NaN where there is none."""
    departure = np.zeros((2, at.p.shape[1]))
    try:
        state = begin(richer)
    except ComputationError:
        departure[:] = np.nan
        return departure[0], departure[1]
    for each, begun, coordinates in zip(departure, state, (at.p[0], at.pd[0]), strict=True):
        each[-richer.size :] = begun - coordinates[-richer.size :]  # the axial shapes, which SFOAM lacks, come first
    return departure[0], departure[1]


def at_rest(at: Sampled) -> Sampled:
    """The first state at rest, a free hub at its angle."""
    base, hub = mapped(at.base, lambda x: x[:1]), at.hub
    if hub is not None:
        hub = hub[:1] * [1, 0, 0]
        base = at.motion.mount.base(*hub.T)
    still = np.zeros_like(at.p[:1])
    loads = None if at.loads is None else at.loads[:1]
    return Sampled(at.time[:1], base, at.p[:1], still, still, hub, at.motion, loads)
