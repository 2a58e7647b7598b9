"""A system that is flown and spun, as the specimen of a comparison: its base, one point, and all of its loads."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from gbeam.errors import InputError
from gbeam.results.parts import Loads, Peaks
from gbeam.results.response import Response
from gbeam.results.solids import SolidStress
from gbeam.results.system import SystemResponse


def specimen_of(response: SystemResponse) -> Response:
    """The response of a system on a moving ground: displacement of its points, loads of the ground, and the stress of
    all beams and meshes.
    """
    if response.base is None or response.assembly is None:
        fix = "simulate it on a flight, and on a centrifuge that tracks it, with loads"
        raise InputError("", "is a system on a ground at rest, or without loads", fix)
    from scipy.spatial.transform import Rotation  # 0.2 s to import, which no comparison of beams needs

    chosen = [beam.loads for beam in response.beams.values()]
    felt = [
        Rotation.from_quat(np.roll(response.attitude[:, k], -1, axis=-1)).apply(response.acceleration[:, k])
        for k in range(len(response.points))
    ]
    nothing, solid = np.full(3, math.nan), None
    if response.solids:
        solid = _together(response)
    # What the ground takes, then the largest stress at the roots; the sections of the beams follow.
    tension = [np.max([each.stress_tension[:, 0] for each in chosen], axis=0)[:, None]] if chosen else []
    compression = [np.min([each.stress_compression[:, 0] for each in chosen], axis=0)[:, None]] if chosen else []
    tension += [each.stress_tension for each in chosen]
    compression += [each.stress_compression for each in chosen]
    unknown = np.full((len(response.time), 1), math.nan)
    strengths = {each.yield_strength for each in chosen}
    loads = Loads(
        stations=np.arange(float(1 + sum(each.stress_tension.shape[1] for each in chosen))),
        force=response.ground_force[:, None],
        moment=response.ground_moment[:, None],
        section_force=response.ground_force[:, None],
        section_moment=response.ground_moment[:, None],
        stress_tension=np.concatenate(tension, axis=1) if chosen else unknown,
        stress_compression=np.concatenate(compression, axis=1) if chosen else unknown,
        acceleration=felt[-1][:, None],
        yield_strength=strengths.pop() if len(strengths) == 1 and solid is None else None,
    )
    return Response(
        name=response.name,
        environment=response.environment,
        model="system",
        outcome=response.outcome,
        message=response.message,
        time=response.time,
        stations=np.arange(float(len(response.points))),
        points=response.points,
        displacement=response.place - response.assembly.undeformed,
        point_acceleration=np.stack(felt, axis=1),
        q=response.q,
        qd=response.qd,
        base=response.base,
        peaks=Peaks(nothing, nothing, nothing),
        integrator=response.integrator,
        step=response.step,
        steps=response.steps,
        error_estimate=response.error_estimate,
        residual_from=response.residual_from,
        loads=loads,
        solid=solid,
        axes=response.axes,
        envelope=response.assembly.undeformed,
        kept_every=response.kept_every,
    )


def _together(response: SystemResponse) -> SolidStress:
    """Stress of all meshes as that of one: the largest of them and of the beams over time, where a mesh is stressed
    most, and its least margin where there is no beam besides.
    """
    every, beams = response.solids, [each.loads.stress.max(axis=1) for each in response.beams.values()]
    worst = max(every.values(), key=lambda each: each.worst.von_mises)
    near = [each.nearest_yield for each in every.values() if each.nearest_yield is not None and not beams]
    return replace(
        worst,
        von_mises=np.max([*(each.von_mises for each in every.values()), *beams], axis=0),
        nearest_yield=min(near, key=lambda each: each.margin or math.inf, default=None),
    )
