"""Quantities of a response by which two runs of a specimen are compared."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from gbeam.arrays.types import Flags, Floats
from gbeam.errors import InputError
from gbeam.guards.checks import index_of
from gbeam.mechanics.tree.rigid_body import ROOT
from gbeam.numerics.peaks import maxima, near_maxima, seven_point, vector_peaks
from gbeam.results.body_response import BodyResponse
from gbeam.results.parts import Base, Extremes, Loads, VectorPeaks
from gbeam.results.response import Response
from gbeam.results.solids import SolidStress

Peak = tuple[float, float]  # value and time, s; NaN where unknown
UNKNOWN = math.nan, math.nan


@dataclass(frozen=True)
class Quantities:
    """Quantities of a run by which it is compared.

    They are displacements (t, p, 3) m of a specimen's points from their undeformed places relative to the base, their
    absolute accelerations (t, p, 3) m/s², and force and moment (t, 3) of the `root` on the base, in the base's axes.
    The last two are None where a run has no loads. `body` is the only one, where the base holds it by its root.
    """

    response: Response
    base: Base
    points: tuple[str, ...]
    displacement: Floats
    acceleration: Floats | None
    root: tuple[Floats, Floats] | None
    body: BodyResponse | None = None

    @classmethod
    def from_response(cls, where: str, response: Response) -> Quantities:
        """Take the quantities of a response, which is passed as the argument `where`.

        InputError if the ground rests, or if loads are lacking where bodies hang on joints.
        """
        deforming = sum(body.q.shape[1] for body in response.bodies.values())
        away = np.any(response.place[0, -1]) or np.any(response.attitude[0, -1, 1:])  # of an only body the root
        jointed = response.several or len(response.coordinates) > deforming or bool(away)
        if response.base is None or (jointed and response.assembly is None):
            fix = "simulate it on a flight, and on a centrifuge that tracks it, with loads"
            raise InputError(where, "is on a ground at rest, or without loads", fix)
        if jointed:
            return cls._from_points(response, response.base)
        body, loads = response.body, response.body.loads
        return cls(
            response,
            response.base,
            body.points,
            body.displacement,
            body.acceleration,
            None if loads is None else (loads.section_force[:, 0], loads.section_moment[:, 0]),
            body,
        )

    @classmethod
    def _from_points(cls, response: Response, base: Base) -> Quantities:
        """Quantities of a response of several bodies, or of one on a joint, by its points."""
        from scipy.spatial.transform import Rotation  # 0.2 s to import, which no comparison of one body needs

        assert response.assembly is not None
        turns = np.roll(response.attitude, -1, axis=-1)
        felt = Rotation.from_quat(turns.reshape(-1, 4)).apply(response.acceleration.reshape(-1, 3))
        return cls(
            response,
            base,
            response.points,
            response.place - response.assembly.undeformed,
            felt.reshape(response.acceleration.shape),
            (response.ground_force, response.ground_moment),
        )

    @property
    def farthest(self) -> str:
        """Point whose displacement is compared where none is named. It is empty for the tip of the only body, unless
        supports hold it; else the point that moves farthest.
        """
        if self.body is None:
            return self.points[int(self.response.largest.argmax())]
        return self.points[self.body.points.index(self.body.farthest)] if self.body.farthest else ""

    def index(self, where: str, point: str) -> int:
        """Return the number of a named point, with or without the name of the only body; that of the last one if the
        name is empty. InputError at the keyword `where` if there is no such point.
        """
        if not point:
            return self.displacement.shape[1] - 1
        names = [point]
        if len(self.response.bodies) == 1:
            (body,) = self.response.bodies
            names += [f"{body}.{point}", point.removeprefix(f"{body}.")]
        existing = next((name for name in names if name in self.points), point)
        return index_of(where, existing, self.points)

    def peaks(self, part: slice | Flags, point: int) -> dict[str, Peak]:
        """Largest sizes over a part of the times, and their times, by name. "tip" is the point of number `point`.

        Peaks between steps, which the response knows over all of its run, are taken if they lie in the part.
        """
        time, recorded = self.response.time[part], self._recorded(point)
        force, moment = self.root or (None, None)
        histories = {"tip": self.displacement[:, point], "root_force": force, "root_moment": moment}
        if not self.response.q.shape[1]:
            del histories["tip"]  # a rigid one stays
        largest = dict[str, Peak]()
        for name, vectors in histories.items():
            peak = _peak_in_part(time, recorded[name].size) if name in recorded else None
            if peak is None:
                peak = UNKNOWN if vectors is None else _largest_peak(*vector_peaks(time, vectors[part]))
            largest[name] = peak
        return largest | {"stress": max(self._stresses(time, part), key=_peak_size, default=UNKNOWN)}

    def _recorded(self, point: int) -> dict[str, VectorPeaks]:
        """Peaks over all steps that the response has, by name. "tip" is the point of number `point`."""
        if self.body is None:
            maxima = self.response.maxima
            return {} if maxima is None else {"root_force": maxima.ground_force, "root_moment": maxima.ground_moment}
        moved, loads = self.body.peaks.displacement, self.body.peaks.loads
        peaks = dict[str, VectorPeaks]()
        if moved is not None:
            peaks["tip"] = moved[point]
        if loads is not None:
            peaks |= {"root_force": loads.root_force, "root_moment": loads.root_moment}
        return peaks

    def _stresses(self, time: Floats, part: slice | Flags) -> Iterator[Peak]:
        """Yield the largest stress of each body that has one, over a part of the times (t,), s."""
        for body in self.response.bodies.values():
            solid, loads = body.solid, sections_of(body)
            if solid is not None:
                yield largest(time, solid.von_mises[part, None]) if solid.known else UNKNOWN
            elif loads is not None and body.peaks.loads is not None:
                stress = body.peaks.loads.stress
                peak = _peak_in_part(time, stress, int(np.argmax(stress.value)))
                if peak is None:
                    sizes = np.concatenate([loads.stress_tension[part], -loads.stress_compression[part]], axis=1)
                    peak = largest(time, sizes)
                yield peak

    @property
    def root_stress(self) -> Floats:
        """Largest normal stress at the roots of bodies with sections, (t,) Pa, or NaN without any."""
        roots = [loads.stress[:, 0] for loads in map(sections_of, self.response.bodies.values()) if loads is not None]
        return np.max(roots, axis=0) if roots else np.full(len(self.response.time), math.nan)

    @property
    def yield_strength(self) -> float | None:
        """Yield strength of the bodies with sections, Pa, or None where it differs, or others have stress, too."""
        strengths = {loads.yield_strength for loads in map(sections_of, self.response.bodies.values()) if loads}
        return strengths.pop() if len(strengths) == 1 and not solids_of(self.response) else None

    @property
    def margin(self) -> float | None:
        """Least margin on yield of the materials of solids, or None where that of some body is not known."""
        solids = solids_of(self.response)
        if not all(solid.known for solid in solids) or any(map(sections_of, self.response.bodies.values())):
            return None
        margins = [solid.nearest_yield.margin for solid in solids if solid.nearest_yield is not None]
        return min((margin for margin in margins if margin is not None), default=None)

    def stress_at(self, where: str, point: str) -> Floats | None:
        """Return the stress (t,) Pa at a named point: of a mesh von Mises', of a beam the normal stress.

        None if the point belongs to neither. InputError at the keyword `where` if there is no such point.
        """
        solid, loads, k = self.stressed(where, point)
        if solid is not None:
            return solid.point_von_mises[:, k]
        return None if loads is None else loads.stress[:, k]

    def stressed(self, where: str, point: str) -> tuple[SolidStress | None, Loads | None, int]:
        """Return the body's stress at a named point: that of its solid, or the loads of its sections, and the point's
        number there.

        Both are None if the body has neither. InputError at the keyword `where` if there is no such point.
        """
        body, name = self.body, self.points[self.index(where, point)]
        if body is None:
            owner, _, name = name.partition(".")
            body = self.response.bodies.get(owner)
        if body is None:
            return None, None, 0
        if body.solid is not None:
            points = body.solid.points
            return (body.solid, None, points.index(name)) if name in points else (None, None, 0)
        names = (ROOT, *body.points)
        return (None, sections_of(body), names.index(name)) if name in names else (None, None, 0)


def sections_of(body: BodyResponse) -> Loads | None:
    """Loads of a body that has sections. None for other bodies, and without loads."""
    return None if body.loads is None or body.loads.fibre is None else body.loads


def solids_of(response: Response) -> list[SolidStress]:
    """Stresses of solids."""
    return [body.solid for body in response.bodies.values() if body.solid is not None]


def largest(time: Floats, values: Floats) -> Peak:
    """Largest value of histories (t, k), and its time. They are known at samples alone and interpolated between them;
    NaN if one is not known.
    """
    if not np.isfinite(values).all():
        return UNKNOWN
    return _largest_peak(*maxima(time, values, *seven_point(time, values, near_maxima(time, values))))


def _peak_in_part(time: Floats, extremes: Extremes, k: Any = ()) -> Peak | None:
    """A peak over all of a run, the `k`-th of several, or None if unknown, or outside the part with times (t,), s."""
    value, peak_time = float(extremes.value[k]), float(extremes.time[k])
    return (value, peak_time) if np.isfinite(value) and time[0] <= peak_time <= time[-1] else None


def _largest_peak(values: Floats, times: Floats) -> Peak:
    """Largest of values (k,), and its time."""
    index = int(np.argmax(values))
    return float(values[index]), float(times[index])


def _peak_size(peak: Peak) -> float:
    """Sort key of peaks by their sizes. One that is unknown counts as the largest."""
    return math.inf if math.isnan(peak[0]) else peak[0]
