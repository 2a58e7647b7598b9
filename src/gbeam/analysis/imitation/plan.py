"""The machine's side alone: a plan from standstill to standstill, and commands at a controller's sample time."""

from __future__ import annotations

import numpy as np

from gbeam.analysis.imitation.accounting import judge
from gbeam.analysis.outline import ends_of
from gbeam.analysis.steady.subject import subject_of
from gbeam.constants import ToleranceOf
from gbeam.guards.arguments import typed
from gbeam.guards.kinds import kinds
from gbeam.guards.limits import SAMPLES, refuse_more
from gbeam.guards.quantities import Ratio, Seconds
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.system import System
from gbeam.motion.centrifuge.centrifuge import Centrifuge
from gbeam.motion.centrifuge.histories import axes_result, axis_angles, times_between
from gbeam.motion.protocol import implausible_motion
from gbeam.progress import Progress, tell
from gbeam.results.accounting import TOLERANCE
from gbeam.results.comparison import MachinePlan
from gbeam.results.criteria import BROKEN, KINDS_OF_LIMITS, Limits, checked_limits
from gbeam.results.machine import Commands

_FINE = 1e-3  # s: the angle of axis 1 is integrated on times no further apart


@kinds(accept=KINDS_OF_LIMITS)
@typed
def plan(
    name: str,
    motion: Centrifuge,
    tracks: str = "",
    *,
    specimen: Structure | System | None = None,
    tolerance: Ratio = TOLERANCE,
    tolerance_of: ToleranceOf = "peak",
    accept: Limits | None = None,
    title: str = "",
    progress: Progress = None,
) -> MachinePlan:
    """Plan one centrifuge over its whole motion, and account for the flight's load on it.

    Parameters
    ----------
    name : str
        Of the motion.
    motion : Centrifuge
        With the span of the flight that it tracks.
    tracks : str
        Name of the flight.
    specimen : Structure or System, optional
        Whose size the load along it depends on.
    tolerance, tolerance_of, accept
        As for :func:`gbeam.compare`; limits that need a response are not judged.
    title : str
        Of the scenario, for the header of the commands.
    progress : callable or bool, optional
        Called with what is being done and the fraction of it done; True shows a bar.

    Raises
    ------
    InputError
        If the motion has no span, the load cannot be followed, or a limit means nothing.

    Examples
    --------
    >>> load = gb.Sum((gb.constant(20.0), gb.trapezoid(50.0, jerk=25.0, start=1.0, hold=2.0)))
    >>> machine = gb.Centrifuge(
    ...     gb.Flight(z=load), arm=3.3, control_point=0.22, gravity=True, smoothing=0.1, span=(0.0, 8.0)
    ... )
    >>> answer = gb.plan("centrifuge", machine)
    >>> answer.outcome
    'done'
    """
    limits = checked_limits(accept)
    ends = {} if specimen is None else ends_of(subject_of(specimen, None).system)
    tell(progress, "axis motions", 0.0)
    time = times_between(*(float(end) for end in motion.extent))
    axes = axes_result(motion, time)
    run = axes.imitated
    assert run is not None  # it is a centrifuge
    outcome = "done" if axes.within_limits else BROKEN
    where, span = f"motion.{name}" if name else "motion", motion.target.span
    warnings = implausible_motion(motion, where, span)
    warnings += implausible_motion(motion.flight, f"motion.{tracks}" if tracks else "flight", span)
    tell(progress, "what the flight and the machine make", 0.5)
    accounting, largest = judge(run, span, ends, tolerance=tolerance, tolerance_of=tolerance_of)
    return MachinePlan(
        name=name,
        tracks=tracks,
        arm=float(motion.geometry.arm),
        outcome=outcome,
        message=axes.exceeding,
        time=time,
        axes=axes,
        accounting=accounting,
        gravity=float(motion.geometry.gravity),
        mounting=motion.mounting,
        peaks={"largest_load": largest},
        accept=limits,
        title=title,
        whole=motion.flight.part_of(*span),
        scale=motion.flight.level_factor,
        warnings=(*warnings, *axes.warnings),
    )


@typed
def axis_commands(motion: Centrifuge, sample: Seconds) -> Commands:
    """Return the axis motions at a controller's sample time, from their closed forms and not by interpolation.

    Parameters
    ----------
    motion : Centrifuge
    sample : float
        s; one sample is at the flight's first time. The first and the last are those at standstill, or the last that
        lies within the flight where the machine begins and ends at idle.

    Raises
    ------
    InputError
        If there are too many.

    Examples
    --------
    >>> load = gb.Sum((gb.constant(20.0), gb.trapezoid(50.0, jerk=25.0, start=1.0, hold=2.0)))
    >>> machine = gb.Centrifuge(
    ...     gb.Flight(z=load), arm=3.3, control_point=0.22, gravity=True, smoothing=0.1, span=(0.0, 8.0)
    ... )
    >>> table = gb.axis_commands(machine, sample=0.01)
    >>> print(f"{table.time[0]:.2f} s to {table.time[-1]:.2f} s")
    -5.52 s to 13.52 s
    """
    (first, _), (begin, end) = motion.target.span, motion.extent
    starts_at_rest = motion.ends.start != "idle"
    # Samples before the flight's first time and after it.
    samples_before = np.ceil(float(first - begin) / sample - 1e-9)
    samples_after = float(end - first) / sample
    samples_after = np.ceil(samples_after - 1e-9) if starts_at_rest else np.floor(samples_after * (1 + 1e-12))
    refuse_more(
        "sample",
        "samples",
        samples_before + samples_after,
        SAMPLES,
        300.0,
        f"give {(end - begin) / SAMPLES:.2g} s or more",
    )
    substeps = int(np.ceil(sample / _FINE))  # axis 1's angle is an integral: finer than the samples
    steps = np.arange(-int(samples_before) * substeps, int(samples_after) * substeps + 1)
    time = np.asarray(first + sample / substeps * steps, dtype=np.float64)
    axes = motion.axes(time)
    histories = axis_angles(axes, time), axes.rates, axes.accelerations
    return Commands(sample, time[::substeps], *(column[::substeps] for column in histories))
