"""Errors of a response from too few shapes and from its model, by the exact model with more shapes."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from gbeam.analysis.accuracy.correction import correction, operator
from gbeam.analysis.accuracy.reference import Sampled, complete_residual, linear_residual
from gbeam.mechanics.enrichment import Enrichment
from gbeam.mechanics.equations.sampled import paths
from gbeam.mechanics.section_forces import sections
from gbeam.mechanics.structure import Structure
from gbeam.motion.bases.base import Base
from gbeam.motion.protocol import Motion
from gbeam.results.result import Floats
from gbeam.structure.stress import extreme_stresses

IDLE = 1e-9  # of the largest force: a direction that feels less stays out


class Quantities(NamedTuple):
    """Tip (t, 3) m, the root's force and moment (t, 3), and the largest size of the stress over all sections (t,)."""

    tip: Floats
    force: Floats
    moment: Floats
    stress: Floats


class Parts(NamedTuple):
    """Errors over time, as differences from the truth."""

    shapes: Quantities
    model: Quantities
    total: Quantities


def lacking(
    structure: Structure, motion: Motion, time: Floats, y: Floats, yd: Floats, ydd: Floats, own: Quantities
) -> Parts:
    """What a solution lacks, quantity by quantity, over time.

    Parameters
    ----------
    structure : Structure
        With a source.
    motion : Motion
    time : (t,) s
    y, yd, ydd : (t, n)
        Coordinates and rates; of a free hub its angle first.
    own : Quantities
        Of the solution.
    """
    more = Enrichment(structure)
    exact, index = more.model("exact", directions=_driven(more, structure, motion, time, y, yd, ydd))
    at = _lifted(exact, index, motion, time, y, yd, ydd)
    of = operator(exact, at)
    residual, start = complete_residual(exact, at), _start(exact, at)
    total = correction(of, time, residual, start)
    # In its own coordinates the solution leaves what its model leaves out, in the new ones what its shapes do.
    first = residual.shape[1] - exact.size
    own_rows = np.append(np.arange(first), first + index)
    new, at_start = residual.copy(), start.copy()
    new[:, own_rows] = at_start[own_rows] = 0.0
    shapes = correction(of, time, new, at_start)
    best = at.moved(*total)
    without = at.moved(*(a - b for a, b in zip(total, shapes, strict=True)))
    truth, same_shapes = quantities(exact, best), quantities(exact, without)
    return Parts(
        Quantities(*(a - b for a, b in zip(truth, same_shapes, strict=True))),
        Quantities(*(a - b for a, b in zip(same_shapes, own, strict=True))),
        Quantities(*(a - b for a, b in zip(truth, own, strict=True))),
    )


def quantities(structure: Structure, at: Sampled) -> Quantities:
    """Tip, root loads and stress of a complete model at a solution."""
    assert structure.sections is not None
    force, moment, section_force, section_moment, _ = sections(
        structure, structure.sections, at.base, at.p, at.pd, at.pdd, at.loads, compiled=False
    )
    tip = structure.displacement(at.p)[:, -1]
    pair = extreme_stresses(structure.sections.values, section_force, section_moment)
    return Quantities(tip, force[:, 0], moment[:, 0], np.maximum(pair[0], -pair[1]))


def _driven(more, structure, motion, time, y, yd, ydd):
    """Whether new shapes along x, y and z would be moved."""
    kind = structure.kind if structure.linear else "FOAM"
    rich, index = more.model(kind)
    at = _lifted(rich, index, motion, time, y, yd, ydd)
    residual = linear_residual(rich, at)
    counts = np.cumsum([0, *rich.counts])
    largest = [np.abs(residual[:, a:b]).max(initial=0.0) for a, b in zip(counts, counts[1:], strict=False)]
    c = rich.coefficients
    limit = IDLE * max(np.abs(at.p @ c.stiffness).max(), *largest)
    return tuple(n > 0 or size > limit for n, size in zip(structure.counts, largest, strict=True))


def _lifted(structure: Structure, index, motion: Any, time, y, yd, ydd) -> Sampled:
    hub, first = None, 0
    if motion.free:
        hub, first = np.stack([x[:, 0] for x in (y, yd, ydd)], axis=1), 1
        base = motion.mount.base(*hub.T)
    else:
        base = motion.base(time)
    base = Base(*(np.asarray(x) for x in (base.a_WO_B, base.w_WB_B, base.alpha_WB_B)))
    p = np.zeros((3, len(time), structure.size))
    for k, x in enumerate((y, yd, ydd)):
        p[k][:, index] = x[:, first:]
    loads = None if structure.history is None else np.asarray(structure.history(time))
    return Sampled(time, base, *p, hub, motion if motion.free else None, loads)


def _start(exact: Structure, at: Sampled) -> Floats:
    """Residual of the first state at rest."""
    base, hub = Base(*(x[:1] for x in (at.base.a_WO_B, at.base.w_WB_B, at.base.alpha_WB_B))), at.hub
    if hub is not None:
        hub = hub[:1] * [1, 0, 0]
        base = at.motion.mount.base(*hub.T)
    still = np.zeros((1, exact.size))
    loads = None if at.loads is None else at.loads[:1]
    first = complete_residual(exact, Sampled(at.time[:1], base, at.p[:1], still, still, hub, at.motion, loads))[0]
    if hub is not None:
        first[0] = 0.0
    return first
