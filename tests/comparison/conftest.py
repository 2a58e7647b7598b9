"""The beam of 2020 on a 3.3 m arm, from 5 g to a plateau of 10 g: one corner, no idle."""

from __future__ import annotations

from collections.abc import Callable

import pytest

import gbeam as gb
from gbeam.motion import Profile

G = 9.80665
STRIP, METAL = gb.Section.rectangle(0.02, 0.004), gb.Material(2700.0, 70e9)
SPECIMEN = gb.Beam(0.3, STRIP, METAL, damping_ratio=0.0, rotary_inertia=False)


@pytest.fixture(scope="session")
def load() -> Profile:
    return gb.vector(z=gb.tabulated([0.0, 1.25], [5 * G, 10 * G]))  # 4 g/s


@pytest.fixture(scope="session")
def structure() -> gb.Structure:
    return gb.assemble(SPECIMEN, gb.Model("FOAM", 1, 1, 3))


@pytest.fixture(scope="session")
def settings() -> gb.ResponseSettings:
    return gb.ResponseSettings(start=0.5, duration=1.5, integrator="gauss", step=0.5e-3)


@pytest.fixture(scope="session")
def spin(flight: gb.Flight) -> Callable[..., gb.Centrifuge]:
    def make(
        smoothing: float = 0.0596, control_point: float = 0.15, sign: int = 1, limits: gb.MachineLimits | None = None
    ) -> gb.Centrifuge:
        return gb.Centrifuge(
            flight, arm=3.3, control_point=control_point, inverse="flat", gravity=False, limits=limits,
            smoothing=smoothing, mounting="upright" if sign == 1 else "inverted", span=(0.2, 2.3),
        )  # fmt: skip

    return make


@pytest.fixture(scope="session")
def flight(load: Profile) -> gb.Flight:
    return gb.Flight(acceleration=load)
