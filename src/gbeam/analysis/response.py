"""Response over time in one environment."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array

import gbeam._jax  # noqa: F401
from gbeam.analysis.definiteness import first_loss
from gbeam.analysis.plan import axes_result
from gbeam.analysis.static import equilibrium
from gbeam.case import Motion, ResponseSettings
from gbeam.energy import rest_matrices
from gbeam.equations import Coefficients, Damped, Hub, coefficients, on_free_hub, on_prescribed_base
from gbeam.errors import InputError
from gbeam.integrate import (
    Gauss4,
    LinearSystem,
    NonlinearSystem,
    OneStep,
    State,
    Trajectory,
    evaluate,
    generalized_alpha,
    hht,
    integrate,
    integrate_adaptively,
    newmark,
)
from gbeam.model import Structure, rest_modes
from gbeam.motion import Base, Centrifuge, HubRate, HubTorque
from gbeam.motion.blocks import in_blocks
from gbeam.motion.derivative import with_rate
from gbeam.results import BaseHistory, Floats, HubResult, Peaks, Response
from gbeam.work import Applied, LoadHistory

MAX_STEPS = 4_000_000


class _Matrices(eqx.Module):
    """C, K, F of a linear model at a base motion and under loads."""

    coefficients: Coefficients

    def __call__(self, inputs: tuple[Base, Applied | None]) -> tuple[Array, Array, Array]:
        base, applied = inputs
        return self.coefficients.at(base.a_WO_B, base.w_WB_B, base.al_WB_B, applied)


class _OnBase(eqx.Module):
    """Residual of a model on a prescribed base."""

    system: Damped

    def __call__(self, q: Array, qd: Array, qdd: Array, inputs: tuple[Base, Applied | None]) -> Array:
        base, applied = inputs
        return on_prescribed_base(self.system.under(applied), q, qd, qdd, base.a_WO_B, base.w_WB_B, base.al_WB_B)


class _OnHub(eqx.Module):
    """Residual of a model on a free hub."""

    system: Damped
    hub: Hub
    hub_force: bool = eqx.field(static=True)

    def __call__(self, y: Array, yd: Array, ydd: Array, inputs: tuple[Array, Applied | None]) -> Array:
        torque, applied = inputs
        return on_free_hub(self.system.under(applied), self.hub, y, yd, ydd, torque, hub_force=self.hub_force)


class _Inputs(eqx.Module):
    """What drives a system over time: the base's motion or the hub's torque, and the loads on the beam."""

    drive: Motion
    history: LoadHistory | None

    def __call__(self, t: Array) -> tuple[Base | Array, Applied | None]:
        base = self.drive.torque(t) if isinstance(self.drive, HubTorque) else self.drive.base(t)
        return base, None if self.history is None else self.history(t)


def free_hub(motion: HubTorque) -> Hub:
    """The hub of a motion, for the equations."""
    m = motion.mount
    return Hub(m.radius, motion.inertia, m.R_HB, motion.stiffness, motion.damping, m.gravity)


@dataclass(frozen=True)
class _Problem:
    """What the integrator runs: the system, its initial state, and where the beam's coordinates start in it."""

    system: LinearSystem | NonlinearSystem
    state: State
    first: int
    coefficients: Coefficients | None


def _problem(structure: Structure, motion: Motion, start: float) -> _Problem:
    inputs = _Inputs(motion, structure.history)
    if isinstance(motion, HubTorque):
        residual = _OnHub(structure.system, free_hub(motion), structure.hub_force)
        q = jnp.zeros(structure.size)
        if motion.mount.gravity is not None or structure.history is not None:
            o = jnp.zeros(())
            q = equilibrium(structure, motion.mount.base(o, o, o), start)
        return _Problem(NonlinearSystem(residual, inputs), State.rest(jnp.append(0.0, q)), 1, None)
    q = equilibrium(structure, jax.tree.map(lambda x: x[0], in_blocks(evaluate, inputs, np.array([start]))[0]), start)
    if structure.linear:
        constants = coefficients(structure.system)
        return _Problem(LinearSystem(constants.mass, _Matrices(constants), inputs), State.rest(q), 0, constants)
    return _Problem(NonlinearSystem(_OnBase(structure.system), inputs), State.rest(q), 0, None)


@eqx.filter_jit
def _displacement(structure: Structure, q: Any) -> Array:
    return jax.vmap(structure.displacement)(q)


def displacement(structure: Structure, q: Floats) -> Floats:
    """Displacements of the stations, (t, s, 3) m, from coordinates (t, n); in blocks of one compiled shape."""
    block = 4096
    padded = np.concatenate([q, np.repeat(q[-1:], -len(q) % block, axis=0)])
    pieces = [np.asarray(_displacement(structure, part)) for part in np.split(padded, len(padded) // block)]
    return np.concatenate(pieces)[: len(q)]


def _scheme(settings: ResponseSettings, linear: bool) -> OneStep | Gauss4:
    match settings.integrator:
        case "newmark":
            return newmark(**settings.parameters)
        case "hht":
            return hht(**{"alpha": -0.1, **settings.parameters})
        case "generalized-alpha":
            return generalized_alpha(**{"rho_inf": 0.9, **settings.parameters})
        case "gauss":
            if not linear:
                raise InputError(
                    "response.integrator",
                    "is gauss, which needs a linear model on a prescribed base",
                    "use newmark, generalized-alpha or adaptive",
                )
            return Gauss4()
    raise InputError(
        "response.integrator",
        f"is {settings.integrator!r}",
        "choose newmark, hht, generalized-alpha, gauss or adaptive",
    )


def first_step(structure: Structure, settings: ResponseSettings) -> float:
    """Step of the results, s: an even number over the duration, at least 500 and 40 to the lowest period."""
    frequency, _ = rest_modes(*rest_matrices(structure.system.energy))
    wanted = min(2 * math.pi / frequency[0] / 40, settings.duration / 500)
    return settings.duration / (2 * math.ceil(settings.duration / wanted / 2))


def respond(
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
    problem = _problem(structure, motion, settings.start)
    coarse = first_step(structure, settings)
    linear = isinstance(problem.system, LinearSystem)

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
        step, error = math.nan, _difference(tip(loose), tip(trajectory), 1)
    else:
        scheme = _scheme(settings, linear)
        if settings.step is not None:
            step = settings.duration / max(1, round(settings.duration / settings.step))
            trajectory, check = run(step, "integrating"), run(step / 2, "checking with half the step")
            gain = 2**scheme.order
            error = _difference(tip(trajectory), tip(check), 2) * gain / (gain - 1)
        else:
            trajectory, step, error = _refine(run, tip, coarse, scheme.order, settings)

    return _result(structure, motion, settings, problem, trajectory, name, step, error, coarse)


def _difference(coarse: Floats, fine: Floats, ratio: int) -> float:
    """Largest difference of two tip histories at the coarse one's times, over the largest displacement."""
    n = min(len(coarse), (len(fine) - 1) // ratio + 1)
    size = np.abs(fine).max()
    return float(np.abs(coarse[:n] - fine[: (n - 1) * ratio + 1 : ratio]).max() / size) if size > 0 else 0.0


def _refine(
    run: Callable[[float, str], Trajectory],
    tip: Callable[[Trajectory], Floats],
    coarse: float,
    order: int,
    settings: ResponseSettings,
) -> tuple[Trajectory, float, float]:
    """Halve the step, from twice the results', until the error estimated from two runs is within the tolerance.

    The estimate is Richardson's: with steps h and h/r the finer run's error is their difference over rᵖ − 1.
    """
    old, level = run(2 * coarse, "integrating"), -1
    ratio = 2
    while True:
        step = coarse / 2**level / ratio
        new = run(step, f"refining the step to {1e3 * step:.3g} ms")
        error = _difference(tip(old), tip(new), ratio) / (ratio**order - 1)
        level += round(math.log2(ratio))
        whole = new.converged and not new.stopped
        if (error <= settings.tolerance and whole) or (not whole and not (old.converged and not old.stopped)):
            return new, step, error
        # Jump to the step that the order promises, at most 16 times finer.
        wanted = math.ceil(math.log2(max(error / settings.tolerance, 2.0)) / order) if math.isfinite(error) else 1
        ratio = 2 ** min(max(wanted, 1), 4)
        if settings.duration / step * ratio > MAX_STEPS:
            return new, step, error
        old = new


def _result(
    structure: Structure,
    motion: Motion,
    settings: ResponseSettings,
    problem: _Problem,
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
        base = BaseHistory(*(np.asarray(x) for x in (there.a_WO_B, there.w_WB_B, there.al_WB_B)))
        hub = _given_hub(motion, time) if isinstance(motion, HubRate) else None
        environment = type(motion).__name__.lower() if hub is None else "hub"
    outcome, message, warnings = _describe(structure, problem, settings, trajectory, base, peaks, time, error)
    return Response(
        name=name,
        environment=environment,
        model=structure.kind,
        outcome=outcome,
        message=message,
        warnings=warnings,
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
        axes=axes_result(motion, time) if isinstance(motion, Centrifuge) else None,
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
    return BaseHistory(*(np.asarray(x) for x in (there.a_WO_B, there.w_WB_B, there.al_WB_B))), hub


def _given_hub(motion: HubRate, time: Floats) -> HubResult:
    rate, acceleration = (np.asarray(x) for x in with_rate(motion.rate, jnp.asarray(time)))
    # The trapezium rule with its end correction, since the slopes are known.
    h = np.diff(time)
    turned = h * (rate[1:] + rate[:-1]) / 2 - h**2 * np.diff(acceleration) / 12
    return HubResult(np.append(0.0, np.cumsum(turned)), rate, acceleration, np.full_like(rate, np.nan))


def _describe(
    structure: Structure,
    problem: _Problem,
    settings: ResponseSettings,
    trajectory: Trajectory,
    base: BaseHistory,
    peaks: Peaks,
    time: Floats,
    error: float,
) -> tuple[str, str, tuple[str, ...]]:
    """Outcome, message and warnings of a run."""
    constants = problem.coefficients
    if constants is None and structure.linear:
        constants = coefficients(structure.system)
    loss = None if constants is None else first_loss(constants, time, base)
    lost = (
        ""
        if loss is None
        else f"{structure.kind}'s stiffness is not positive definite from t = {loss[0]:.4g} s, where the base turns at "
        f"{loss[1]:.4g} rad/s"
    )
    warnings = []
    end = trajectory.time[-1]
    if trajectory.stopped:
        why = f"{lost}: the model is not valid beyond that speed; use FOAM or exact" if lost else "use exact"
        return (
            "diverged",
            f"the displacement exceeded the beam's length, {structure.length:.4g} m, at t = {end:.4g} s; {why}",
            (),
        )
    if not trajectory.converged:
        return (
            "not converged",
            f"no acceleration satisfies the equations in the step after t = {end:.4g} s; "
            f'try a smaller response.step, or response.integrator = "generalized-alpha" with rho_inf = 0.8',
            (),
        )
    if lost:
        warnings.append(f"{lost}; the result beyond is not to be trusted")
    share = float(peaks.max_abs[1:].max() / structure.length)
    if structure.kind != "exact" and share > 0.1:
        warnings.append(
            f"the tip moves by {share:.1%} of the length: second-order models are then wrong by about "
            f'{0.35 * share**2:.1%} of the peak (TLAM and CFOAM by more); check with model.kind = "exact"'
        )
    if math.isfinite(error) and error > settings.tolerance:
        warnings.append(
            f"the estimated error, {error:.2g} of the largest displacement, is above the tolerance "
            f'{settings.tolerance:g}; give a smaller step, or "auto"'
        )
    return "done", "", tuple(warnings)
