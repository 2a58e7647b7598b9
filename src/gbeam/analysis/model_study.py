"""One scenario by every model that can answer it, compared with the exact one (2009 section 4)."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import NamedTuple, get_args

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import minimize_scalar

from gbeam.analysis.case import Case
from gbeam.analysis.one_body import refuse_no_point
from gbeam.analysis.response.settings import ResponseSettings
from gbeam.analysis.response.simulation import simulate
from gbeam.arrays.types import Floats
from gbeam.constants import ModelKind
from gbeam.errors import ComputationError, InputError
from gbeam.guards.arguments import typed
from gbeam.mechanics.assembly import model_of, remade
from gbeam.mechanics.models import MODEL_KINDS, Model
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.system import System
from gbeam.motion.protocol import Motion, notes_on
from gbeam.numerics.peaks import vector_peaks
from gbeam.progress import Progress, tell
from gbeam.results.response import Response
from gbeam.results.study import Failure, ModelRow, ModelStudy

REFERENCE: ModelKind = "exact"
CONVERGED = (3, 6)  # strain and rotation shapes at least of the reference five digits with them
PATIENCE = 5.0  # s: a first run that took less is run again, to time it without imports
# Share of the peak by which the last shapes may move the tip: the error has been up to 12 times that.
SHAPES_FINE = 1e-5


def counterpart(model: Model, kind: ModelKind) -> Model:
    """The model of another kind with as many shapes; of a kind by strains with at least the numbers `CONVERGED`."""
    axial, y, z = model.counts[:3]
    if MODEL_KINDS[kind].strains:
        strains, rotations = CONVERGED
        y, z = max(y, rotations) if y else 0, max(z, rotations) if z else 0
        return replace(model, kind=kind, axial=max(axial, strains), y=y, z=z)
    return replace(model, kind=kind, axial=axial if MODEL_KINDS[kind].axial else 0, twist=0, shear_y=0, shear_z=0)


@typed
def compare_models(
    case: Case,
    kinds: Sequence[ModelKind] = get_args(ModelKind),
    progress: Progress = None,
    *,
    point: str | None = None,
) -> ModelStudy:
    """Run a case with every model and compare the tip's displacement with the exact model's.

    Parameters
    ----------
    case : Case
        Its own kind of model is one among them; the others have as many shapes, exact and fourth-order at least 3 of
        strain and 6 of rotation. All beams of a system are of the same model.
    kinds : sequence of str
        Models to run beside exact.
    progress : callable or bool, optional
        Called with what is being done and the fraction done; True shows a bar.
    point : str, optional
        The one whose displacement is compared: of a flexible body relative to its root, elsewhere from its place at the
        start. By default the tip of the beam that deflects most.

    Returns
    -------
    ModelStudy
        A model that diverges or cannot answer has a row that says why; where that is exact, the others have rows
        without errors. What makes a row doubtful is among its warnings: a step not fine enough, too few shapes of
        exact, a stiffness lost.

    Raises
    ------
    InputError
        If a kind is unknown, the beam has no damping ratio, or no body is a beam, or there is no such point.

    Examples
    --------
    >>> shorter = ["response.duration=2 s", "response.residual_from=1 s"]
    >>> case = gb.read_scenario("examples/hubbeam2009_slew_2p8.toml", shorter)
    >>> for row in gb.compare_models(case, kinds=["TLAM", "FOAM"]).rows:
    ...     print(row.model, row.outcome)
    TLAM done
    FOAM done
    exact done
    """
    for kind in kinds:
        if kind not in MODEL_KINDS:
            raise InputError("kinds", f"has {kind!r}", f"choose from {', '.join(MODEL_KINDS)}")
    _refuse(case, point)
    case.system.require_damping("the response")
    chosen = [REFERENCE, *(k for k in kinds if k != REFERENCE)]
    answers: dict[tuple[str, str], tuple[_Tip | Failure, float]] = {}
    for i, kind in enumerate(chosen):
        counterpart = _counterpart(case, kind)
        for name, motion in case.environments.items():

            def report(stage: str, share: float, doing: str = f"{kind} on {name}", done: int = i) -> None:
                tell(progress, f"{doing}: {stage}", (done + share) / len(chosen))

            run = partial(_answer, counterpart, motion, case.settings_of(name), name, point, report)
            answer, seconds = _timed(run)
            if not answers and seconds < PATIENCE:
                answer, seconds = _timed(run)
            answers[kind, name] = answer, seconds
            if isinstance(answer, _Tip) and answer.response.several:
                point = point or answer.point
    rows, direction = [], {}
    for name in case.environments:
        reference = answers[REFERENCE, name][0]
        axis = _largest_axis(answers, name) if isinstance(reference, Failure) else _axis(reference.peak)
        direction[name] = f"{point} {'xyz'[axis]}" if point else "xyz"[axis]
        rows += [_row(kind, name, *answers[kind, name], reference, axis) for kind in MODEL_KINDS if kind in chosen]
    notes = notes_on(case.motions)
    return ModelStudy(case.title, REFERENCE, direction, tuple(rows), notes=notes, provenance=case.provenance)


class _Tip(NamedTuple):
    """Displacement `moved` (t, 3) m of the point compared in a response, with its peaks (3,)."""

    response: Response
    point: str
    moved: Floats
    peak: Floats
    time_of_peak: Floats
    residual: Floats
    residual_from: float
    hub_angle: float


def _refuse(case: Case, point: str | None) -> None:
    """Raise InputError where no body is a beam, or a point is named that is not there."""
    if not any(body.source for body in case.system.flexible.values()):
        raise InputError("bodies", "have no beam, whose model could be another", "ask for run")
    if point is not None:
        refuse_no_point(case.system, "point", point)


def _counterpart(case: Case, kind: ModelKind) -> Case | Failure:
    """The case with its beams in one kind of model, or the reason why there is none."""
    try:
        return replace(case, system=convert_models(case.system, kind))
    except InputError as error:
        return Failure("cannot", str(error))


def convert_models(system: System, kind: ModelKind) -> System:
    """Put all beams of a system into one kind of model, each with as many shapes as before."""
    beams = {name: body for name, body in system.flexible.items() if body.source is not None}
    bodies = {name: remade(body, counterpart(model_of(body), kind), body.stations[:-1]) for name, body in beams.items()}
    return replace(system, bodies={**system.bodies, **bodies})


def _answer(
    case: Case | Failure,
    motion: Motion | None,
    settings: ResponseSettings,
    name: str,
    point: str | None,
    progress: Callable[[str, float], None],
) -> _Tip | Failure:
    """Simulate one model and return the displacement of the point, or the reason why there is no answer. The exact
    model warns where its last shapes still count.
    """
    if isinstance(case, Failure):
        return case
    try:
        response = simulate(case.system, motion, settings, name=name, progress=progress)
    except InputError as error:
        return Failure("cannot", str(error))
    except ComputationError as error:
        return Failure(error.outcome, str(error))
    tip = _tip_of(response, point)
    name = tip.point.partition(".")[0]
    body = case.system.flexible.get(name)
    if response.outcome != "done" or body is None or body.kind != REFERENCE:
        return tip
    tail = shape_tail(body, response.bodies[name].q)
    if tail <= SHAPES_FINE:
        return tip
    warning = (
        f"the last shapes of exact still move the tip by {tail:.2g} of the peak: it has not converged; "
        "raise model.modes"
    )
    return tip._replace(response=replace(response, warnings=(*response.warnings, warning)))


def _tip_of(response: Response, point: str | None) -> _Tip:
    """Displacement of a point with its peaks; by default of the tip of the beam that deflects most."""
    if point is None:
        tips = {name: body.tip for name, body in response.bodies.items() if body.shapes is not None}
        point = max(tips, key=lambda name: float(np.abs(tips[name]).max())) + ".tip"
    k = response.point("point", point)
    point = response.points[k]
    owner, _, name = point.partition(".")
    body, residuals, hub = response.bodies.get(owner), response.residual_amplitude, response.hub
    residual = np.full(3, np.nan) if residuals is None else residuals[k]
    angle = float("nan") if hub is None or response.base is not None else float(hub.angle[-1])  # of a free hub
    if body is not None and name in body.points and body.peaks.displacement is not None:
        moved, peaks = body.at(name), body.peaks.displacement[body.points.index(name)].components
        return _Tip(response, point, moved, peaks.value, peaks.time, residual, response.residual_from, angle)
    moved = response.place[:, k] - response.place[0, k]
    value, peak_time = vector_peaks(response.time, moved)
    return _Tip(response, point, moved, value[:3], peak_time[:3], residual, response.residual_from, angle)


def shape_tail(structure: Structure, q: Floats) -> float:
    """Largest displacement of the tip by the last shapes of all families at q (t, n), as a share of the largest."""
    ends = np.cumsum(structure.counts) - 1
    last = [int(end) for end, count in zip(ends, structure.counts, strict=True) if count > 1]
    tip = structure.displacement(q)[:, -1]
    size = float(np.abs(tip).max())
    if not last or size == 0:
        return 0.0
    truncated = q.copy()
    truncated[:, last] = 0
    return float(np.abs(structure.displacement(truncated)[:, -1] - tip).max() / size)


def _timed(run: Callable[[], _Tip | Failure]) -> tuple[_Tip | Failure, float]:
    """Run a function; return its answer and the time it took, s."""
    start = clock.perf_counter()
    answer = run()
    return answer, clock.perf_counter() - start


def _axis(moved: Floats) -> int:
    return int(np.argmax(moved))


def _largest_axis(answers: dict[tuple[str, str], tuple[_Tip | Failure, float]], name: str) -> int:
    """Number of the axis along which the models with an answer move the tip most in an environment."""
    peaks = [answer.peak for (_, where), (answer, _) in answers.items() if where == name and isinstance(answer, _Tip)]
    return _axis(np.sum(peaks, axis=0)) if peaks else 0


def _row(
    kind: str, name: str, answer: _Tip | Failure, seconds: float, reference: _Tip | Failure, axis: int
) -> ModelRow:
    """Row of one model in one environment: its figures along an axis, and their errors against the reference."""
    nan = float("nan")
    if isinstance(answer, Failure):
        return ModelRow(kind, name, answer.outcome, answer.message, (), seconds=seconds)
    response = answer.response
    if response.outcome != "done":
        return ModelRow(kind, name, response.outcome, response.message, response.warnings, seconds=seconds)
    peak, residual = float(answer.peak[axis]), float(answer.residual[axis])
    peak_error, residual_error, phase, difference = nan, nan, nan, nan
    if isinstance(reference, _Tip) and reference.response.outcome == "done":
        reference_peak, reference_residual = float(reference.peak[axis]), float(reference.residual[axis])
        tip = reference.moved[:, axis]
        if not np.array_equal(reference.response.time, response.time):
            # At 40 samples to the lowest period a cubic is wrong by 1e-5 of a vibration, a straight line by 0.3 %.
            tip = CubicSpline(reference.response.time, tip)(response.time)
        largest = float(np.abs(answer.moved[:, axis] - tip).max())
        is_residual = response.time >= answer.residual_from
        if reference_peak > 0:
            peak_error, difference = peak / reference_peak - 1, largest / reference_peak
            residual_error = residual / reference_residual - 1 if reference_residual > 0 else nan
            if is_residual.sum() > 8:
                phase = _phase(response.time[is_residual], answer.moved[is_residual, axis], tip[is_residual])
    return ModelRow(
        model=kind,
        motion=name,
        outcome=response.outcome,
        message=response.message,
        warnings=response.warnings,
        peak=peak,
        time_of_peak=float(answer.time_of_peak[axis]),
        peak_error=peak_error,
        residual=residual,
        residual_error=residual_error,
        phase=phase,
        difference=difference,
        hub_angle=answer.hub_angle,
        error_estimate=response.error_estimate,
        steps=response.steps,
        seconds=seconds,
        time=response.time,
        history=answer.moved[:, axis],
    )


def _phase(time: Floats, ours: Floats, theirs: Floats) -> float:
    """Phase, rad, by which `ours` leads `theirs` (t,) at the dominant frequency of `theirs`,
    or NaN if one is constant.
    """
    if len(time) < 8 or np.ptp(theirs) == 0 or np.ptp(ours) == 0:
        return float("nan")

    def fit(values: Floats, omega: float) -> tuple[complex, float]:
        """Fit a vibration of a frequency, rad/s; return its complex amplitude and the residual sum of squares."""
        basis = np.stack([np.cos(omega * time), np.sin(omega * time), np.ones_like(time)], axis=1)
        fitted, *_ = np.linalg.lstsq(basis, values, rcond=None)
        return complex(fitted[0], -fitted[1]), float(np.sum((values - basis @ fitted) ** 2))

    step, span = float(np.mean(np.diff(time))), float(time[-1] - time[0])
    spectrum = np.abs(np.fft.rfft((theirs - theirs.mean()) * np.hanning(len(theirs))))
    coarse = 2 * np.pi * np.fft.rfftfreq(len(theirs), step)[1 + int(np.argmax(spectrum[1:]))]
    width = 2 * np.pi / span
    bounds = max(coarse - width, 1e-3 * width), coarse + width
    best_fit = minimize_scalar(lambda w: fit(theirs, w)[1], bounds=bounds, method="bounded")
    return float(np.angle(fit(ours, best_fit.x)[0] / fit(theirs, best_fit.x)[0]))
