"""A strip that bends along z, and responses made by hand."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from gbeam import Beam, Material, Model, Response, Section, Structure, assemble
from gbeam.results.machine import AxesResult
from gbeam.results.parts import Base
from gbeam.results.response import Peaks

LENGTH = 0.3
SECTION = Section.rectangle(0.02, 0.004)
ALUMINIUM = Material(2700.0, 7e10)
LINE = 2700.0 * 0.02 * 0.004  # kg/m
EI = 7e10 * 0.02 * 0.004**3 / 12  # N m², bending along z
EA = 7e10 * 0.02 * 0.004
OMEGA = 1.875104068711961**2 * np.sqrt(EI / (LINE * LENGTH**4))  # of the first mode, rad/s


@cache
def strip(kind: str = "FOAM", counts: tuple[int, int, int] = (0, 0, 2), damping_ratio: float = 0.0) -> Structure:
    beam = Beam(LENGTH, SECTION, ALUMINIUM, damping_ratio=damping_ratio, rotary_inertia=False)
    return assemble(beam, Model(kind, *counts))


def of_tip(name: str, time: np.ndarray, tip: np.ndarray, held: np.ndarray | None = None) -> Response:
    """A response of which only the tip's history matters, and where a centrifuge's target was held."""
    n, none = len(time), np.zeros((len(time), 3))
    axes: Any = None
    if held is not None:
        axes = AxesResult(none, none, none, none, none, held, ())
    return Response(
        name=name, environment="flight", model="FOAM", outcome="done", message="", warnings=(), time=time,
        stations=np.array([LENGTH]), displacement=tip[:, None, :], q=np.zeros((n, 1)), qd=np.zeros((n, 1)),
        base=Base(none, none, none), peaks=Peaks(np.abs(tip).max(0), np.zeros(3), np.full(3, np.nan)),
        integrator="newmark", step=0.1, steps=n - 1, error_estimate=0.0, residual_from=np.nan, axes=axes,
    )  # fmt: skip
