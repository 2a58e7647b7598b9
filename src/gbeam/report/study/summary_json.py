"""A study as one JSON object: SI throughout; what is not a number is null."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from gbeam.report.machine import limits
from gbeam.report.machine.tracking import ends, peak, tracking
from gbeam.report.study import comparison
from gbeam.results.machine import AxesResult
from gbeam.results.response import HubResult, Response
from gbeam.results.result import Floats
from gbeam.results.section_forces import Loads
from gbeam.results.study import Study


def to_json(study: Study, files: Iterable[Path] = ()) -> dict[str, Any]:
    """Study as JSON.

    Parameters
    ----------
    study : Study
    files : iterable of Path
        Those written.

    Returns
    -------
    dict
        ``title``, ``outcome``, ``motions`` by name, ``comparisons`` and ``files``; NaN where there is no number.
    """
    return {
        "title": study.title,
        "outcome": study.outcome,
        "motions": {name: _response(response) for name, response in study.responses.items()}
        | {name: asdict(failure) for name, failure in study.failures.items()},
        "comparisons": [comparison.to_json(each) for each in study.comparisons],
        "files": [str(file) for file in files],
    }


def _response(response: Response) -> dict[str, Any]:
    peaks = response.peaks
    tip = zip(peaks.max_abs, peaks.time_of_max, peaks.residual_amplitude, strict=True)
    keys = ("max_abs", "time_of_max", "residual_amplitude")
    values = {
        "environment": response.environment,
        "outcome": response.outcome,
        "message": response.message,
        "tip": {axis: dict(zip(keys, row, strict=True)) for axis, row in zip("xyz", tip, strict=True)},
        "error_estimate": response.error_estimate,
        "step": response.step,
        "steps": response.steps,
        "integrator": response.integrator,
        "model": response.model,
        "warnings": list(response.warnings),
    }
    if response.loads is not None:
        values["loads"] = _loads(response.time, response.loads)
    if response.hub is not None:
        values["hub"] = _hub(response.hub)
    if response.axes is not None:
        values |= _centrifuge(response.time, response.axes)
    return values


def _loads(time: Floats, loads: Loads) -> dict[str, Any]:
    """Largest of what the base gives the root, of the stress anywhere, and of the torque for the beam on a hub."""

    def largest(values: Floats) -> dict[str, Any]:
        return {axis: asdict(peak(time, each)) for axis, each in zip("xyz", values.T, strict=True)}

    values: dict[str, Any] = {"root_force": largest(loads.root_force), "root_moment": largest(loads.root_moment)}
    if np.isfinite(loads.stress).all():
        when, where = np.unravel_index(loads.stress.argmax(), loads.stress.shape)
        values["stress"] = {
            "max": loads.stress.max(),
            "time_of_max": time[when],
            "station": loads.stations[where],
        }
    if loads.beam_torque is not None:
        values["beam_torque"] = asdict(peak(time, loads.beam_torque))
    return values


def _hub(hub: HubResult) -> dict[str, float]:
    return {"angle_end": hub.angle[-1], "rate_max": float(abs(hub.rate).max()), "rate_end": hub.rate[-1]}


def _centrifuge(time: Floats, axes: AxesResult) -> dict[str, Any]:
    def peaks(i: int) -> dict[str, Any]:
        return {
            "rate": asdict(peak(time, axes.rate[:, i])),
            "acceleration": asdict(peak(time, axes.acceleration[:, i])),
        }

    return {
        **ends(time, axes),
        "axes": {str(i + 1): peaks(i) for i in range(3)},
        "tracking_error": asdict(tracking(time, axes)),
        "limits": limits.to_json(axes),
        "not_followed": [{"start": start, "end": end, "reason": reason} for start, end, reason in axes.episodes],
        "shortfalls": [asdict(shortfall) for shortfall in axes.shortfalls],
    }
