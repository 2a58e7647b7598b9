"""Response over time in one environment."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array

import gbeam.arrays.jax_setup  # noqa: F401
from gbeam.analysis.imitation.plan import axes_result
from gbeam.analysis.response.outcome import describe
from gbeam.analysis.response.problem import Problem, history_of, problem_of
from gbeam.analysis.response.stepping import difference, first_step, refine, scheme_of
from gbeam.analysis.study.case import Motion, ResponseSettings
from gbeam.integrate import (
    Trajectory,
    evaluate,
    integrate,
    integrate_adaptively,
)
from gbeam.mechanics.assembly import Structure, rest_modes
from gbeam.mechanics.energy import rest_matrices
from gbeam.motion import Centrifuge, HubRate, HubTorque
from gbeam.numerics.batching import in_blocks
from gbeam.numerics.time_derivative import with_rate
from gbeam.results.response import BaseHistory, Floats, HubResult, Peaks, Response


@eqx.filter_jit
def _displacement(structure: Structure, q: Any) -> Array:
    return jax.vmap(structure.displacement)(q)


def displacement(structure: Structure, q: Floats) -> Floats:
    """Displacements of the stations, (t, s, 3) m, from coordinates (t, n); in blocks of one compiled shape."""
    block = 4096
    padded = np.concatenate([q, np.repeat(q[-1:], -len(q) % block, axis=0)])
    pieces = [np.asarray(_displacement(structure, part)) for part in np.split(padded, len(padded) // block)]
    return np.concatenate(pieces)[: len(q)]


def simulate(
    structure: Structure,
    motion: Motion,
    settings: ResponseSettings,
    *,
    name: str = "",
    progress: Callable[[str, float], None] | None = None,
) -> Response:
    """Compute the response of a beam in one environment.

    It starts in relative equilibrium with the base's motion at the start (a free hub at rest), without vibration.

    Parameters
    ----------
    structure : Structure
        From :func:`gbeam.assemble`.
    motion : Flight, Centrifuge, HubRate or HubTorque
    settings : ResponseSettings
    name : str
        For the result.
    progress : callable, optional
        Called with what is being done and the fraction done.

    Returns
    -------
    Response
        Its outcome is ``done``, ``diverged`` (the displacement left what the model can mean) or ``not converged``
        (Newton's method failed).

    Raises
    ------
    InputError
        If the integrator cannot run this model.
    ComputationError
        If there is no relative equilibrium to start from.
    """
    problem = problem_of(structure, motion, settings.start)
    coarse = first_step(structure, settings)

    def too_far(y: Floats) -> int | None:
        """A projected field means nothing once it moves by the beam's length."""
        if structure.kind == "exact":
            return None
        moved = np.abs(displacement(structure, y[:, problem.first :])).max(axis=(1, 2))
        return int(np.argmax(moved > structure.length)) + 1 if moved.max() > structure.length else None

    def run(step: float, what: str) -> Trajectory:
        report = None if progress is None else (lambda share: progress(what, share))
        return integrate(
            problem.system,
            scheme,
            problem.state,
            step=step,
            count=round(settings.duration / step),
            start=settings.start,
            stop=too_far,
            progress=report,
        )

    def tip(trajectory: Trajectory) -> Floats:
        return displacement(structure, trajectory.q[:, problem.first :])[:, -1]

    error = math.nan
    if settings.integrator == "adaptive":
        times = np.asarray(settings.start + coarse * np.arange(round(settings.duration / coarse) + 1), dtype=np.float64)
        jumps = np.asarray(motion.breaks)
        if structure.history is not None:
            jumps = np.append(jumps, np.asarray(structure.history.breaks))

        def adapt(tolerance: float) -> Trajectory:
            return integrate_adaptively(
                problem.system, problem.state, times, tolerance=tolerance, jumps=jumps, stop=too_far
            )

        loose, trajectory = adapt(settings.tolerance * 1e-2), adapt(settings.tolerance * 1e-3)
        step, error = math.nan, difference(tip(loose), tip(trajectory), 1)
    else:
        scheme = scheme_of(settings)
        if settings.step is not None:
            step = settings.duration / max(1, round(settings.duration / settings.step))
            trajectory, check = run(step, "integrating"), run(step / 2, "checking with half the step")
            gain = 2**scheme.order
            error = difference(tip(trajectory), tip(check), 2) * gain / (gain - 1)
        else:
            trajectory, step, error = refine(run, tip, coarse, scheme.order, settings)

    return _result(structure, motion, settings, problem, trajectory, name, step, error, coarse)


def _result(
    structure: Structure,
    motion: Motion,
    settings: ResponseSettings,
    problem: Problem,
    trajectory: Trajectory,
    name: str,
    step: float,
    error: float,
    coarse: float,
) -> Response:
    """Sample a trajectory on the coarse grid, which all motions of a study share, and describe it."""
    beam = slice(problem.first, None)
    fine = displacement(structure, trajectory.q[:, beam])
    peaks = _peaks(trajectory.time, fine[:, -1], settings.residual_from)
    # An automatic step is the coarse one halved: its stride brings every motion back to the same times.
    stride = 1 if settings.step is not None or math.isnan(step) else round(coarse / step)
    keep = slice(None, None, stride)
    time, q, qd, qdd = (x[keep] for x in (trajectory.time, trajectory.q, trajectory.qd, trajectory.qdd))
    if isinstance(motion, HubTorque):
        base, free = _free_hub(motion, time, q, qd, qdd)
        hub: HubResult | None = free
        environment = "hub"
    else:
        there, _ = in_blocks(evaluate, problem.system.drive, time)
        base = history_of(there)
        hub = _given_hub(motion, time) if isinstance(motion, HubRate) else None
        environment = type(motion).__name__.lower() if hub is None else "hub"
    told = describe(structure, problem, settings, trajectory, base, peaks, time, q[:, beam], error)
    outcome, message, warnings = told
    axes = axes_result(motion, time) if isinstance(motion, Centrifuge) else None
    return Response(
        name=name,
        environment=environment,
        model=structure.kind,
        outcome=outcome,
        message=message,
        warnings=warnings if axes is None else warnings + axes.warnings,
        time=time,
        stations=np.asarray(structure.stations),
        displacement=fine[keep],
        q=q[:, beam],
        qd=qd[:, beam],
        base=base,
        peaks=peaks,
        integrator=settings.integrator,
        step=step,
        steps=len(trajectory.time) - 1,
        error_estimate=error,
        residual_from=math.nan if settings.residual_from is None else settings.residual_from,
        hub=hub,
        axes=axes,
        qdd=qdd[:, beam],
        frequencies=rest_modes(*rest_matrices(structure.system.energy))[0],
    )


def _peaks(time: Floats, tip: Floats, residual_from: float | None) -> Peaks:
    size = np.abs(tip)
    residual = np.full(3, np.nan)
    if residual_from is not None and time[-1] > residual_from:
        after = tip[time >= residual_from]
        residual = (after.max(axis=0) - after.min(axis=0)) / 2
    return Peaks(size.max(axis=0), time[size.argmax(axis=0)], residual)


def _free_hub(motion: HubTorque, time: Floats, y: Floats, yd: Floats, ydd: Floats) -> tuple[BaseHistory, HubResult]:
    rate, acceleration = yd[:, 0], ydd[:, 0]
    hub = HubResult(y[:, 0], rate, acceleration, np.asarray(motion.torque(jnp.asarray(time))))
    there = motion.mount.base(*(jnp.asarray(x) for x in (y[:, 0], rate, acceleration)))
    return history_of(there), hub


def _given_hub(motion: HubRate, time: Floats) -> HubResult:
    rate, acceleration = (np.asarray(x) for x in with_rate(motion.rate, jnp.asarray(time)))
    # The trapezium rule with its end correction, since the slopes are known.
    h = np.diff(time)
    turned = h * (rate[1:] + rate[:-1]) / 2 - h**2 * np.diff(acceleration) / 12
    return HubResult(np.append(0.0, np.cumsum(turned)), rate, acceleration, np.full_like(rate, np.nan))
