"""A strip that bends along z, and responses made by hand."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from gbeam import Beam, Material, Model, Response, Section, Structure, assemble
from gbeam.results import AxesResult, Base, BodyResponse, Peaks

LENGTH = 0.3
SECTION = Section.rectangle(0.02, 0.004)
ALUMINIUM = Material(2700.0, 7e10)
LINE = 2700.0 * 0.02 * 0.004  # kg/m
TIP = np.array([LENGTH, 0.0, 0.0])
EI = 7e10 * 0.02 * 0.004**3 / 12  # N m², bending along z
EA = 7e10 * 0.02 * 0.004
OMEGA = 1.875104068711961**2 * np.sqrt(EI / (LINE * LENGTH**4))  # of the first mode, rad/s


def with_body(response: Response, **changes: Any) -> Response:
    """The response with other fields of its only body."""
    ((name, body),) = response.bodies.items()
    return replace(response, bodies={name: replace(body, **changes)})


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
    base = Base(none, none, none)
    peaks = Peaks(np.abs(tip).max(0), np.zeros(3), np.full(3, np.nan))
    body = BodyResponse(
        model="FOAM", base=base, stations=np.array([LENGTH]), points=("tip",), displacement=tip[:, None, :],
        q=np.zeros((n, 1)), qd=np.zeros((n, 1)), peaks=peaks,
    )  # fmt: skip
    place = np.stack([np.array([LENGTH, 0.0, 0.0]) + tip, none], axis=1)
    still, turned = np.zeros((n, 2, 3)), np.tile([1.0, 0.0, 0.0, 0.0], (n, 2, 1))
    return Response(
        name=name, environment="flight", outcome="done", message="", warnings=(), time=time,
        points=("beam.tip", "beam.root"), coordinates=("beam.q1",), units=("",), place=place, velocity=still,
        acceleration=still, attitude=turned, angular_velocity=still, q=body.q, qd=body.qd, effort=np.zeros((n, 1)),
        ground_force=none, ground_moment=none, bodies={"beam": body}, base=base, integrator="newmark", step=0.1,
        steps=n - 1, error_estimate=0.0, axes=axes, ends={"the root": 0 * TIP, "the tip": TIP},
    )  # fmt: skip
