"""Responses made by hand: plots and reports read records, so no beam is needed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import gbeam as gb
from gbeam.results import (
    Accounting,
    AxesResult,
    Base,
    ErrorEstimate,
    Errors,
    HubResult,
    LimitUse,
    LoadPeak,
    NotFollowed,
    PeakPair,
    Peaks,
)

from ..responses import of_beam

TIME = np.linspace(0, 2, 201)


def _response(name: str, environment: str, turning: float) -> gb.Response:
    wave = 1e-3 * np.sin(np.outer(2 * np.pi * TIME, [1, 2, 3])) * [0.1, 0.2, 1.0]
    zero = np.zeros((len(TIME), 3))
    return of_beam(
        name,
        environment,
        TIME,
        Base(zero + np.array([0, 0, 60.0]), zero + np.array([0, turning, 0]), zero),
        stations=np.array([0.3]),
        displacement=wave[:, None],
        peaks=Peaks(np.abs(wave).max(axis=0), TIME[np.abs(wave).argmax(axis=0)], np.array([0.0, 1e-4, 2e-4])),
        integrator="newmark",
        step=1e-3,
        steps=2000,
        error_estimate=1e-5,
        errors=Errors(ErrorEstimate(8e-6, 0.0, 2e-6, 0.0, total=1e-5)),
        residual_from=1.0,
    )


@pytest.fixture(scope="session")
def study() -> gb.Study:
    """A flight, a centrifuge that is held in the middle, a hub; one comparison."""
    flight = _response("flight", "flight", 0.0)
    held = (TIME > 0.5) & (TIME < 0.8)
    rate = np.outer(np.sin(TIME), [4.0, 1.0, 0.5])
    load = np.outer(np.ones_like(TIME), [0, 0, 60.0])
    off = np.where(held, 9.0, 0.3 * TIME)[:, None] * [0, 0, 1.0]
    allowed = ((9.0, 8.0), (2.5, 2.0), (100.0, 1.0))
    limits = tuple(
        LimitUse(f"axis {i}", "acceleration", "rad/s^2", used, most, 1.0) for i, (most, used) in enumerate(allowed, 1)
    )
    axes = AxesResult(
        rate, rate, 2 * rate * [1, -1, 1], load, load + off, held, ((0.505, 0.795, "below idle"),), limits,
        jerk=3 * rate, span=(0.1, 1.9), flight=flight.base.a_WO_B,
    )  # fmt: skip
    hub = HubResult(TIME, 2 * TIME, np.full_like(TIME, 2.0), np.cos(TIME))
    spin = replace(_response("spin", "centrifuge", 4.0), axes=axes)
    slew = replace(_response("slew", "hub", 1.0), hub=hub)
    difference = 0.1 * flight.tip
    peaks = np.abs(flight.tip).max(axis=0)
    accounting = Accounting(
        0.05, 3.0, 14.0, (0.0, 2.0), 0.85,
        (LoadPeak(0.0, 60.0, 2.0, 60.6, 0.01, (0.02, -0.01), (0.0, 0.0)),),
        (NotFollowed(0.5, 0.8, "below idle", 60.0),),
    )  # fmt: skip
    pairs = {"tip": PeakPair(1e-3, 1.1e-3, 0.75, 0.75)}
    comparison = gb.Comparison(
        "flight", "spin", TIME, difference, ~held, 0.1 * peaks, 0.05 * peaks, peaks, peaks, pairs, accounting
    )
    return gb.Study("a title", {"flight": flight, "spin": spin, "slew": slew}, (comparison,))
