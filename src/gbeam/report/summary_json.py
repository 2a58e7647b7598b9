"""A study as one JSON object: design.md, section 4. SI throughout; what is not a number is null."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from gbeam.report.comparison import comparison_parts
from gbeam.report.figures import peak, tracking
from gbeam.report.limits import limits_json
from gbeam.results.comparison import Comparison
from gbeam.results.response import AxesResult, Floats, HubResult, Response, Study
from gbeam.results.section_forces import Loads


def summary_json(study: Study, files: Iterable[Path] = ()) -> dict[str, Any]:
    """Return what `run --json` prints.

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
        "motions": {name: _motion(it) for name, it in study.responses.items()}
        | {name: asdict(it) for name, it in study.failures.items()},
        "comparisons": [_comparison(it) for it in study.comparisons],
        "files": [str(file) for file in files],
    }


def as_json(value: Any) -> str:
    """Write a value as JSON, with null for what is not finite, which JSON has no word for."""
    return json.dumps(_plain(value), indent=2, ensure_ascii=False, allow_nan=False)


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _plain(each) for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(each) for each in value]
    if isinstance(value, float):  # numpy's float64 is one
        return float(value) if math.isfinite(value) else None
    return value


def _xyz(values: Iterable[float]) -> dict[str, float]:
    return dict(zip("xyz", values, strict=True))


def _motion(it: Response) -> dict[str, Any]:
    peaks = it.peaks
    tip = zip(peaks.max_abs, peaks.time_of_max, peaks.residual_amplitude, strict=True)
    keys = ("max_abs", "time_of_max", "residual_amplitude")
    told = {
        "environment": it.environment,
        "outcome": it.outcome,
        "message": it.message,
        "tip": {axis: dict(zip(keys, row, strict=True)) for axis, row in zip("xyz", tip, strict=True)},
        "error_estimate": it.error_estimate,
        "step": it.step,
        "steps": it.steps,
        "integrator": it.integrator,
        "model": it.model,
        "warnings": list(it.warnings),
    }
    if it.loads is not None:
        told["loads"] = _loads(it.time, it.loads)
    if it.hub is not None:
        told["hub"] = _hub(it.hub)
    if it.axes is not None:
        told |= _centrifuge(it, it.axes)
    return told


def _loads(time: Floats, it: Loads) -> dict[str, Any]:
    """Largest of what the base gives the root, of the stress anywhere, and of the torque for the beam on a hub."""

    def largest(values: Floats) -> dict[str, Any]:
        return {axis: asdict(peak(time, each)) for axis, each in zip("xyz", values.T, strict=True)}

    told: dict[str, Any] = {"root_force": largest(it.root_force), "root_moment": largest(it.root_moment)}
    if np.isfinite(it.stress).all():
        when, where = np.unravel_index(it.stress.argmax(), it.stress.shape)
        told["stress"] = {"max": it.stress.max(), "time_of_max": time[when], "station": it.stations[where]}
    if it.beam_torque is not None:
        told["beam_torque"] = asdict(peak(time, it.beam_torque))
    return told


def _hub(it: HubResult) -> dict[str, float]:
    return {"angle_end": it.angle[-1], "rate_max": float(abs(it.rate).max()), "rate_end": it.rate[-1]}


def _centrifuge(response: Response, it: AxesResult) -> dict[str, Any]:
    def peaks(i: int) -> dict[str, Any]:
        return {
            "rate": asdict(peak(response.time, it.rate[:, i])),
            "acceleration": asdict(peak(response.time, it.acceleration[:, i])),
        }

    return {
        "axes": {str(i + 1): peaks(i) for i in range(3)},
        "tracking_error": asdict(tracking(response.time, it)),
        "limits": limits_json(it),
        "not_followed": [{"start": start, "end": end, "reason": reason} for start, end, reason in it.episodes],
        "shortfalls": [asdict(each) for each in it.shortfalls],
    }


def _comparison(it: Comparison) -> dict[str, Any]:
    return {
        "flight": it.flight,
        "centrifuge": it.centrifuge,
        "verdict": it.verdict,
        "covered": float(it.covered.mean()),
        "max_difference": _xyz(it.max_difference),
        "rms_difference": _xyz(it.rms_difference),
        "peak_flight": _xyz(it.peak_flight),
        "peak_centrifuge": _xyz(it.peak_centrifuge),
        "relative": _xyz(it.relative),
        **comparison_parts(it),
    }
