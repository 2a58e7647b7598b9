"""The same scenario by every model that can answer it, compared with the exact one (2009 section 4)."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from scipy.optimize import minimize_scalar

from gbeam.analysis.case_study import structure_of
from gbeam.analysis.response import respond
from gbeam.case import Case
from gbeam.errors import ComputationError, InputError
from gbeam.model import KINDS, Model
from gbeam.results import Floats, Response
from gbeam.results_modal import ModelRow, ModelStudy

REFERENCE = "exact"
CONVERGED = (3, 6)  # strain and rotation shapes at least of the reference five digits with them
PATIENCE = 5.0  # s: what took longer is not run again to time it without compilation


def counterpart(model: Model, kind: str) -> Model:
    """The model of another kind with the same shapes; the reference with enough of its own."""
    axial, y, z = model.counts
    if kind == REFERENCE:
        axial, y, z = max(axial, CONVERGED[0]), *(max(n, CONVERGED[1]) if n else 0 for n in (y, z))
        return replace(model, kind=kind, axial=axial, y=y, z=z)
    return replace(model, kind=kind, axial=axial if KINDS[kind].axial else 0)


def compare_models(
    case: Case, kinds: Sequence[str] = tuple(KINDS), progress: Callable[[str, float], None] | None = None
) -> ModelStudy:
    """Run a case with every model and compare the tip's displacement with the exact model's.

    Parameters
    ----------
    case : Case
        Its own kind of model is one among them; the others have as many shapes, exact at least 3 of strain and 6 of
        rotation.
    kinds : sequence of str
        Models to run beside exact.
    progress : callable, optional
        Called with what is being done and the fraction done.

    Returns
    -------
    ModelStudy
        A model that diverges has a row that says so.

    Raises
    ------
    InputError
        If a kind is unknown.
    """
    for kind in kinds:
        if kind not in KINDS:
            raise InputError("kinds", f"has {kind!r}", f"choose from {', '.join(KINDS)}")
    settings = case.response if case.response.integrator != "gauss" else replace(case.response, integrator="newmark")
    left_out: dict[str, str] = {}
    answers: dict[str, dict[str, tuple[Response | str, float]]] = {}
    chosen = [REFERENCE, *(k for k in kinds if k != REFERENCE)]
    for i, kind in enumerate(chosen):
        try:
            structure = structure_of(replace(case, model=counterpart(case.model, kind)))
        except InputError as error:
            left_out[kind] = str(error)
            continue
        answers[kind] = {}
        for name, motion in case.motions.items():
            if progress is not None:
                progress(f"{kind} on {name}", i / len(chosen))
            try:
                response, seconds = _timed(partial(respond, structure, motion, settings, name=name))
                answers[kind][name] = response, seconds
            except ComputationError as error:
                answers[kind][name] = f"{error.outcome}: {error}", float("nan")
    if REFERENCE not in answers:
        raise InputError("model", f"exact cannot answer: {left_out[REFERENCE]}", "change the scenario so that it can")
    rows, direction = [], {}
    for name in case.motions:
        reference = answers[REFERENCE][name][0]
        axis = 0 if isinstance(reference, str) else int(np.argmax(reference.peaks.max_abs))
        direction[name] = "xyz"[axis]
        for kind in [k for k in KINDS if k in answers]:
            rows.append(_row(kind, name, *answers[kind][name], reference, axis))
    return ModelStudy(case.title, REFERENCE, direction, tuple(rows), left_out)


def _timed(run: Callable[[], Response]) -> tuple[Response, float]:
    """Run, and run again if that is quick: the first time includes compilation."""
    start = clock.perf_counter()
    response = run()
    seconds = clock.perf_counter() - start
    if seconds < PATIENCE:
        start = clock.perf_counter()
        run()
        seconds = clock.perf_counter() - start
    return response, seconds


def _row(kind: str, name: str, it: Response | str, seconds: float, reference: Response | str, axis: int) -> ModelRow:
    nan = float("nan")
    if isinstance(it, str):
        outcome, _, message = it.partition(": ")
        return ModelRow(kind, name, outcome, message, nan, nan, nan, nan, nan, nan, nan, nan, 0, seconds)
    peak, residual = float(it.peaks.max_abs[axis]), float(it.peaks.residual_amplitude[axis])
    angle = nan if it.hub is None or not np.isfinite(it.hub.torque).all() else float(it.hub.angle[-1])
    against = (nan, nan, nan, nan)
    if not isinstance(reference, str) and it.outcome == reference.outcome == "done":
        top, left = float(reference.peaks.max_abs[axis]), float(reference.peaks.residual_amplitude[axis])
        there = np.interp(it.time, reference.time, reference.tip[:, axis])
        largest = float(np.abs(it.tip[:, axis] - there).max())
        after = it.time >= it.residual_from
        phase = _phase(it.time[after], it.tip[after, axis], there[after]) if after.sum() > 8 else nan
        if top > 0:
            against = (peak / top - 1, residual / left - 1 if left > 0 else nan, phase, largest / top)
    return ModelRow(
        model=kind,
        motion=name,
        outcome=it.outcome,
        message=it.message,
        peak=peak,
        time_of_peak=float(it.peaks.time_of_max[axis]),
        peak_error=against[0],
        residual=residual,
        residual_error=against[1],
        phase=against[2],
        difference=against[3],
        hub_angle=angle,
        steps=it.steps,
        seconds=seconds,
    )


def _phase(time: Floats, ours: Floats, theirs: Floats) -> float:
    """Phase by which one vibration is ahead of another at the other's dominant frequency, rad."""
    if len(time) < 8 or np.ptp(theirs) == 0 or np.ptp(ours) == 0:
        return float("nan")

    def fit(values: Floats, omega: float) -> tuple[complex, float]:
        basis = np.stack([np.cos(omega * time), np.sin(omega * time), np.ones_like(time)], axis=1)
        found, *_ = np.linalg.lstsq(basis, values, rcond=None)
        return complex(found[0], -found[1]), float(np.sum((values - basis @ found) ** 2))

    step, span = float(np.mean(np.diff(time))), float(time[-1] - time[0])
    spectrum = np.abs(np.fft.rfft((theirs - theirs.mean()) * np.hanning(len(theirs))))
    coarse = 2 * np.pi * np.fft.rfftfreq(len(theirs), step)[1 + int(np.argmax(spectrum[1:]))]
    width = 2 * np.pi / span
    best = minimize_scalar(
        lambda w: fit(theirs, w)[1], bounds=(max(coarse - width, 1e-3 * width), coarse + width), method="bounded"
    )
    return float(np.angle(fit(ours, best.x)[0] / fit(theirs, best.x)[0]))
