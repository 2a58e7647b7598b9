"""Response of a system that a run leaves, with its errors."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from gbeam.analysis.outline import assembly_of, outline_of
from gbeam.analysis.response.outcome import Ending, ending_of, yielding
from gbeam.analysis.response.peaks import half_ranges, load_peaks, system_peaks
from gbeam.analysis.response.posed import begun_in_words
from gbeam.analysis.response.run import Run
from gbeam.analysis.response.stepping import scheme_of
from gbeam.analysis.system.accuracy import doubts
from gbeam.analysis.system.histories import beams_of, deflection, meshes_of
from gbeam.arrays.namespace import namespace
from gbeam.arrays.types import Floats
from gbeam.mechanics.tree.signals import units_of
from gbeam.motion import Centrifuge
from gbeam.motion.centrifuge.kinematics import axes_result
from gbeam.motion.protocol import level_factor, notes_on
from gbeam.progress import Progress
from gbeam.results.errors import Errors, StepErrors
from gbeam.results.machine import AxesResult
from gbeam.results.system import BeamResponse, Invariants, SystemResponse
from gbeam.structure.beam import names_at


def system_response_of(
    run: Run,
    of_steps: StepErrors,
    name: str,
    progress: Progress = None,
    *,
    axes_of: Callable[[Any, Floats], AxesResult | None] = axes_result,
) -> SystemResponse:
    """Response at all steps; the residual vibration is measured over the flight's times alone."""
    trajectory, stride, system, motion = run.trajectory, run.stride, run.posed.system, run.posed.motion
    settings, traced, warnings = run.posed.settings, run.traced, tuple[str, ...]()
    time, errors = trajectory.time, Errors()
    if not traced:
        errors, of_bodies = run.errors(of_steps, progress)
        warnings = run.doubts + of_bodies
    over_time, along = run.histories(np.arange(len(time)), loads=settings.loads)
    beams, yielded = dict[str, BeamResponse](), []
    for body, loads in along.items():
        beam = beams_of(system)[body]

        peaks = None if traced else load_peaks(loads, time)
        first = system.coordinates.index(f"{body}.q1")
        q = over_time["q"][:, first : first + beam.size]
        names = () if traced or beam.source is None else names_at(beam.source.beam, beam.stations)
        beams[body] = BeamResponse(loads, peaks, None if traced else outline_of(beam, None, time, q), names)
        yielded += yielding(peaks, f" of {body}")
    kind = "ground" if motion is None else motion.kind
    drawn = settings.loads and not traced
    solids, surfaces = meshes_of(system, time, over_time["q"], name, kind) if drawn else ({}, {})
    invariants = None
    if motion is None:
        invariants = Invariants(*(over_time.pop(key) for key in ("momentum", "angular_momentum", "energy")))
    base: Any = None if motion is None else motion.base(time)
    ending = Ending() if traced else ending_of(run, run.alone(), time)
    warnings += (*ending.warnings, *settings.warnings, *yielded)
    of_errors = doubts(errors, settings.tolerance)
    warnings += tuple(warning for warning in of_errors if warning not in warnings) + system.warnings
    warnings += () if traced else run.solution(1).left_out
    residual: Any = None
    if settings.residual_from is not None:
        # Points of flexible bodies vibrate about their roots, others about the ground.
        relative = (deflection(system, point, over_time["q"]) for point in system.points)
        moved = [over_time["place"][:, k] if bent is None else bent for k, bent in enumerate(relative)]
        all_points = namespace(*moved).concatenate(moved, axis=1)
        flown = run.in_flight
        residual = half_ranges(time[flown], all_points[flown], settings.residual_from).reshape(-1, 3)
    return SystemResponse(
        name=name,
        environment=kind,
        outcome=ending.outcome,
        message=ending.message,
        time=time,
        points=system.points,
        coordinates=system.coordinates,
        units=units_of(system),
        invariants=invariants,
        loop=run.loop,
        beams=beams,
        solids=solids,
        surfaces=surfaces,
        base=base,
        axes=axes_of(motion, time) if isinstance(motion, Centrifuge) else None,
        assembly=assembly_of(system) if drawn else None,
        integrator=scheme_of(settings).name,
        step=run.step,
        steps=len(trajectory.time) - 1,
        errors=errors,
        residual_from=math.nan if settings.residual_from is None else settings.residual_from,
        residual_amplitude=residual,
        kept_every=settings.kept_every(len(time), run.step, stride),
        peaks=None if traced else system_peaks(system, time, over_time),
        initial=begun_in_words(system, settings.begin),
        warnings=warnings,
        notes=notes_on({name: motion}),
        scale=level_factor(motion),
        **over_time,
    )
