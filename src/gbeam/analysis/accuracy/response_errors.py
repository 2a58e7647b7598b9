"""Errors of a beam's response from too few shapes and from its model, by the exact model with more shapes, and from the
theory of slender beams.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from types import MappingProxyType
from typing import Any

import numpy as np

from gbeam.analysis.accuracy.beam_theory import Lacking, beyond, described
from gbeam.analysis.accuracy.correction import PLACE, IntArray, Posed, Quantity, Reading, State, Within
from gbeam.analysis.accuracy.estimate import BEAM, UNMOVED, Judgement, negligible, unjudged
from gbeam.arrays.tree import each_leaf
from gbeam.arrays.types import Floats
from gbeam.integrate.equations import Trajectory
from gbeam.mechanics.enrichment import Enrichment, Twin
from gbeam.mechanics.section_forces import section_forces, sections
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.theory import theory_of
from gbeam.results.errors import Errors
from gbeam.results.parts import Base
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
    theory = (described(structure, beyond.causes.get(BEAM, {})),)
    return Errors(tip, tip, loads, stress, (BEAM,), theory=theory, note=unjudged(structure))
