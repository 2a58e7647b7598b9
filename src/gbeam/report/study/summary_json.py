"""A study as one JSON object: SI throughout; what is not a number is null."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from gbeam.report import words
from gbeam.report.machine import limits
from gbeam.report.machine.tracking import ends, peak, tracking_json
from gbeam.report.study import comparison, sentences
from gbeam.results.machine import AxesResult
from gbeam.results.parts import Extremes, LoadPeaks, Loads, VectorPeaks, yield_margin
from gbeam.results.response import HubResult, Response
from gbeam.results.result import Floats
from gbeam.results.study import Study


def to_json(study: Study, files: Iterable[Path] = ()) -> dict[str, Any]:
    """Study as JSON."""
    return {
        "title": study.title,
        "outcome": study.outcome,
        "state": study.state,
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
        "tip": {axis: dict(zip(keys, row, strict=True)) for axis, row in zip("xyz", tip, strict=True)}
        | {"size": {"max_abs": peaks.max_size, "time_of_max": peaks.time_of_max_size}},
        "error_estimate": response.error_estimate,
        "errors": asdict(response.errors),
        "step": response.step,
        "steps": response.steps,
        "integrator": response.integrator,
        "model": response.model,
        "damping_ratio": response.damping_ratio,
        "initial": response.initial,
        "warnings": list(response.warnings),
        "lines": [*sentences.of_beam(response), *sentences.of_machine(response)],
    }
    values["histories"] = {"samples": len(response.time), "written": len(response.time[:: response.kept_every])}
    if response.whole is not None:
        values |= {"span": words.ends(response.flight_span), "whole": words.ends(response.whole)}
    if peaks.displacement is not None:
        values["stations"] = [
            {"at": float(x), **_vector(peaks.displacement[k])} for k, x in enumerate(response.stations)
        ]
    if response.loads is not None and peaks.loads is not None:
        values["loads"] = _loads(response.loads, peaks.loads)
    if response.hub is not None:
        values["hub"] = _hub(response.hub)
    if response.axes is not None:
        values |= _centrifuge(response.time, response.axes)
    return values


def _loads(loads: Loads, peaks: LoadPeaks) -> dict[str, Any]:
    """Largest of what the base gives the root, of what each section carries, and of the torque for the beam."""
    known = bool(np.isfinite(peaks.tension.value).all())
    values: dict[str, Any] = {
        "root_force": _vector(peaks.force[0]),
        "root_moment": _vector(peaks.moment[0]),
        "sections": [_section(loads, peaks, k, known) for k in range(len(loads.stations))],
    }
    if known:
        stress, tension, compression = peaks.stress, peaks.tension, peaks.compression
        values["stress"] = {
            **_extreme("max", stress, int(stress.value.argmax()), loads),
            "tension": _extreme("max", tension, int(tension.value.argmax()), loads),
            "compression": _extreme("min", compression, int(compression.value.argmin()), loads),
        }
    if known and loads.yield_strength is not None:
        values["yield_strength"] = loads.yield_strength
        values["margin"] = _extreme("min", _margin(loads, peaks), int(peaks.stress.value.argmax()), loads)
    if peaks.beam_torque is not None:
        values["beam_torque"] = _largest(peaks.beam_torque.value, peaks.beam_torque.time)
    return values


def _section(loads: Loads, peaks: LoadPeaks, k: int, known: bool) -> dict[str, Any]:
    values: dict[str, Any] = {"force": _vector(peaks.force[k]), "moment": _vector(peaks.moment[k])}
    if known:
        values |= {"tension": float(peaks.tension.value[k]), "compression": float(peaks.compression.value[k])}
    if known and loads.yield_strength is not None:
        values["margin"] = float(_margin(loads, peaks).value[k])
    return {"at": float(loads.stations[k]), **values}


def _margin(loads: Loads, peaks: LoadPeaks) -> Extremes:
    assert loads.yield_strength is not None
    return Extremes(yield_margin(loads.yield_strength, peaks.stress.value), peaks.stress.time)


def _extreme(kind: str, extremes: Extremes, k: int, loads: Loads) -> dict[str, float]:
    when = {f"time_of_{kind}": float(extremes.time[k]), "station": float(loads.stations[k])}
    return {kind: float(extremes.value[k]), **when}


def _vector(peaks: VectorPeaks) -> dict[str, Any]:
    """Peaks of a vector's components and of its size."""
    c = peaks.components
    parts = {axis: _largest(*each) for axis, *each in zip("xyz", c.value, c.time, strict=True)}
    return parts | {"size": _largest(peaks.size.value, peaks.size.time)}


def _largest(value: Any, time: Any) -> dict[str, float]:
    return {"max_abs": float(value), "time_of_max": float(time)}


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
        **tracking_json(time, axes),
        "limits": limits.to_json(axes),
        "not_followed": [{"start": start, "end": end, "reason": reason} for start, end, reason in axes.episodes],
        "shortfalls": [asdict(shortfall) for shortfall in axes.shortfalls],
    }
