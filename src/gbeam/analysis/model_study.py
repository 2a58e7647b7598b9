"""One scenario by every model that can answer it, compared with the exact one (2009 section 4)."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import minimize_scalar

from gbeam.analysis.case import Case
from gbeam.analysis.response.settings import ResponseSettings
from gbeam.analysis.response.simulation import simulate
from gbeam.errors import ComputationError, InputError
from gbeam.guards.arguments import typed
from gbeam.mechanics.models import KINDS, Model
from gbeam.mechanics.structure import Structure
from gbeam.motion.protocol import Motion
from gbeam.progress import Progress, tell
from gbeam.results.response import Response
from gbeam.results.result import Floats
from gbeam.results.study import Failure, ModelRow, ModelStudy

REFERENCE = "exact"
CONVERGED = (3, 6)  # strain and rotation shapes at least of the reference five digits with them
# Share of the peak by which its last shapes may move the tip: the error has been up to 12 times that.
SHAPES_FINE = 1e-5
PATIENCE = 5.0  # s: what took longer is not run again to time it without compilation


def counterpart(model: Model, kind: str) -> Model:
    """The model of another kind with the same shapes; the reference with enough of its own."""
    axial, y, z = model.counts[:3]
    if kind == REFERENCE:
        axial, y, z = max(axial, CONVERGED[0]), *(max(n, CONVERGED[1]) if n else 0 for n in (y, z))
        return replace(model, kind=kind, axial=axial, y=y, z=z)
    return replace(model, kind=kind, axial=axial if KINDS[kind].axial else 0, twist=0, shear_y=0, shear_z=0)


@typed
def compare_models(case: Case, kinds: Sequence[str] = tuple(KINDS), progress: Progress = None) -> ModelStudy:
    """Run a case with every model and compare the tip's displacement with the exact model's.

    Parameters
    ----------
    case : Case
        Its own kind of model is one among them; the others have as many shapes, exact at least 3 of strain and 6 of
        rotation.
    kinds : sequence of str
        Models to run beside exact.
    progress : callable or bool, optional
        Called with what is being done and the fraction done; True shows a bar.

    Returns
    -------
    ModelStudy
        A model that diverges or cannot answer has a row that says why; where that is exact, the others have rows
        without errors. What makes a row doubtful is among its warnings: a step not fine enough, too few shapes of
        exact, a stiffness lost.

    Raises
    ------
    InputError
        If a kind is unknown, or the beam has no damping ratio.

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
        if kind not in KINDS:
            raise InputError("kinds", f"has {kind!r}", f"choose from {', '.join(KINDS)}")
    chosen = [REFERENCE, *(k for k in kinds if k != REFERENCE)]
    answers = {}
    for i, kind in enumerate(chosen):
        structure = _structure(case, kind)
        if isinstance(structure, Structure):
            structure.require_damping("the response")
        for name, motion in case.motions.items():

            def report(what: str, share: float, doing: str = f"{kind} on {name}", done: int = i) -> None:
                tell(progress, f"{doing}: {what}", (done + share) / len(chosen))

            run = partial(_answer, structure, motion, case.response, name, report)
            answers[kind, name] = _timed(run)
    rows, direction = [], {}
    for name in case.motions:
        reference = answers[REFERENCE, name][0]
        axis = _most_moved(answers, name) if isinstance(reference, Failure) else _axis(reference.peaks.max_abs)
        direction[name] = "xyz"[axis]
        rows += [_row(kind, name, *answers[kind, name], reference, axis) for kind in KINDS if kind in chosen]
    return ModelStudy(case.title, REFERENCE, direction, tuple(rows), provenance=case.provenance)


def _structure(case: Case, kind: str) -> Structure | Failure:
    try:
        return replace(case, model=counterpart(case.model, kind)).assemble()
    except InputError as error:
        return Failure("cannot", str(error))


def _answer(
    structure: Structure | Failure,
    motion: Motion,
    settings: ResponseSettings,
    name: str,
    progress: Callable[[str, float], None],
) -> Response | Failure:
    """Response of one model, or why there is none."""
    if isinstance(structure, Failure):
        return structure
    try:
        response = simulate(structure, motion, settings, name=name, progress=progress)
    except InputError as error:
        return Failure("cannot", str(error))
    except ComputationError as error:
        return Failure(error.outcome, str(error))
    if structure.kind != REFERENCE or response.outcome != "done":
        return response
    tail = shape_tail(structure, response)
    if tail <= SHAPES_FINE:
        return response
    warning = (
        f"the last shapes of exact still move the tip by {tail:.2g} of the peak: it has not converged; "
        "raise model.modes"
    )
    return replace(response, warnings=(*response.warnings, warning))


def shape_tail(structure: Structure, response: Response) -> float:
    """Share of the largest displacement by which the last shape of each family moves the tip: what a next may add."""
    q, ends = response.q, np.cumsum(structure.counts) - 1
    last = [int(end) for end, count in zip(ends, structure.counts, strict=True) if count > 1]
    size = float(response.peaks.max_abs.max())
    if not last or size == 0:
        return 0.0
    without = q.copy()
    without[:, last] = 0
    return float(np.abs(structure.displacement(without)[:, -1] - response.tip).max() / size)


def _timed(run: Callable[[], Response | Failure]) -> tuple[Response | Failure, float]:
    """Run, and run again if that is quick: the first time includes compilation."""
    start = clock.perf_counter()
    answer = run()
    seconds = clock.perf_counter() - start
    if seconds < PATIENCE and isinstance(answer, Response):
        start = clock.perf_counter()
        run()
        seconds = clock.perf_counter() - start
    return answer, seconds


def _axis(moved: Floats) -> int:
    return int(np.argmax(moved))


def _most_moved(answers: dict[tuple[str, str], tuple[Response | Failure, float]], name: str) -> int:
    """Axis along which the models that have an answer move the tip most."""
    peaks = [
        answer.peaks.max_abs
        for (_, where), (answer, _) in answers.items()
        if where == name and isinstance(answer, Response)
    ]
    return _axis(np.sum(peaks, axis=0)) if peaks else 0


def _row(
    kind: str, name: str, answer: Response | Failure, seconds: float, reference: Response | Failure, axis: int
) -> ModelRow:
    nan = float("nan")
    if not isinstance(answer, Response) or answer.outcome != "done":
        warnings = answer.warnings if isinstance(answer, Response) else ()
        return ModelRow(kind, name, answer.outcome, answer.message, warnings, seconds=seconds)
    peak, residual = float(answer.peaks.max_abs[axis]), float(answer.peaks.residual_amplitude[axis])
    angle = nan if answer.hub is None or not answer.hub.free else float(answer.hub.angle[-1])
    against = (nan, nan, nan, nan)
    if isinstance(reference, Response) and reference.outcome == "done":
        top, left = float(reference.peaks.max_abs[axis]), float(reference.peaks.residual_amplitude[axis])
        tip = reference.tip[:, axis]
        if not np.array_equal(reference.time, answer.time):
            # 40 samples to the lowest period: a cubic is wrong there by 1e-5 of a vibration, a straight line by 0.3 %.
            tip = CubicSpline(reference.time, tip)(answer.time)
        largest = float(np.abs(answer.tip[:, axis] - tip).max())
        after = answer.time >= answer.residual_from
        phase = _phase(answer.time[after], answer.tip[after, axis], tip[after]) if after.sum() > 8 else nan
        if top > 0:
            against = (peak / top - 1, residual / left - 1 if left > 0 else nan, phase, largest / top)
    return ModelRow(
        model=kind,
        motion=name,
        outcome=answer.outcome,
        message=answer.message,
        warnings=answer.warnings,
        peak=peak,
        time_of_peak=float(answer.peaks.time_of_max[axis]),
        peak_error=against[0],
        residual=residual,
        residual_error=against[1],
        phase=against[2],
        difference=against[3],
        hub_angle=angle,
        error_estimate=answer.error_estimate,
        steps=answer.steps,
        seconds=seconds,
        time=answer.time,
        history=answer.tip[:, axis],
    )


def _phase(time: Floats, ours: Floats, theirs: Floats) -> float:
    """Phase by which one vibration is ahead of another at the other's dominant frequency, rad."""
    if len(time) < 8 or np.ptp(theirs) == 0 or np.ptp(ours) == 0:
        return float("nan")

    def fit(values: Floats, omega: float) -> tuple[complex, float]:
        basis = np.stack([np.cos(omega * time), np.sin(omega * time), np.ones_like(time)], axis=1)
        fitted, *_ = np.linalg.lstsq(basis, values, rcond=None)
        return complex(fitted[0], -fitted[1]), float(np.sum((values - basis @ fitted) ** 2))

    step, span = float(np.mean(np.diff(time))), float(time[-1] - time[0])
    spectrum = np.abs(np.fft.rfft((theirs - theirs.mean()) * np.hanning(len(theirs))))
    coarse = 2 * np.pi * np.fft.rfftfreq(len(theirs), step)[1 + int(np.argmax(spectrum[1:]))]
    width = 2 * np.pi / span
    best = minimize_scalar(
        lambda w: fit(theirs, w)[1], bounds=(max(coarse - width, 1e-3 * width), coarse + width), method="bounded"
    )
    return float(np.angle(fit(ours, best.x)[0] / fit(theirs, best.x)[0]))
