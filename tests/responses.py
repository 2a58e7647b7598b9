"""Responses of a beam on a base made by hand, without a beam."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

import gbeam as gb
from gbeam.results import Assembly, Base, BodyResponse, Extremes, Maxima, Outline, Peaks, VectorPeaks


def of_beam(
    name: str,
    environment: str,
    time: np.ndarray,
    base: Base,
    values: Callable[..., np.ndarray] = lambda *shape: np.zeros(shape),
    *,
    peaks: Peaks,
    stations: np.ndarray,
    displacement: np.ndarray,
    size: int = 3,
    **more: Any,
) -> gb.Response:
    """Response of a beam with `size` coordinates; what is not given has `values` of a shape."""
    times, axes = len(time), (len(time), 3)
    points, coordinates = ("beam.tip", "beam.root"), tuple(f"beam.q{k + 1}" for k in range(size))
    q, qd = values(times, size), values(times, size)
    body = BodyResponse(
        model="FOAM", base=base, stations=stations, displacement=displacement, q=q, qd=qd, peaks=peaks,
        shapes={"axial": 1, "y": 1, "z": 1},
    )  # fmt: skip
    ending: dict[str, Any] = {"outcome": "done", "message": "", "step": float(time[1] - time[0]), "steps": times - 1}
    return gb.Response(
        name=name,
        environment=environment,
        time=time,
        points=points,
        coordinates=coordinates,
        units=("",) * size,
        place=values(times, 2, 3),
        velocity=values(times, 2, 3),
        acceleration=values(times, 2, 3),
        attitude=values(times, 2, 4),
        angular_velocity=values(times, 2, 3),
        q=q,
        qd=qd,
        effort=values(times, size),
        ground_force=values(*axes),
        ground_moment=values(*axes),
        bodies={"beam": body},
        base=base,
        maxima=Maxima(
            points,
            coordinates,
            *(values(2) for _ in range(6)),
            *(values(size) for _ in range(8)),
            *(VectorPeaks(Extremes(values(3), values(3)), Extremes(values(), values())) for _ in range(2)),
        ),
        **ending | more,
    )


def with_body(response: gb.Response, **more: Any) -> gb.Response:
    """Return a response of one body with other values of the body."""
    ((name, body),) = response.bodies.items()
    return replace(response, bodies={name: replace(body, **more)})


def clamped(response: gb.Response, outline: Outline) -> gb.Response:
    """Return a response of a straight beam on its base as it is drawn, with an outline."""
    still, unknown = np.zeros((1, 3)), np.full((1, 3), np.nan)
    held = Assembly(("beam",), ("ground",), ("fixed",), still, np.zeros((2, 3)), unknown, unknown, unknown[None])
    upright = np.tile([1.0, 0.0, 0.0, 0.0], (len(response.time), 2, 1))
    return replace(with_body(response, outline=outline), assembly=held, attitude=upright)
