"""The problems of the comparison with Exudyn, and what both codes may choose from."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

from exudyn_hub_beam import Drive, Setting

SLEW = Drive(duration=30.0, end=50.0, rate=3.0)
TORQUE = Drive(duration=10.0, end=20.0, torque=200.0, mass=0.5)


@dataclass(frozen=True)
class Choice:
    """Settings of gbeam: numbers of axial and bending shapes, which, scheme, step, s, and if steps are compiled."""

    axial: int
    bending: int
    shapes: str
    integrator: str
    step: float
    compiled: bool = False

    def __str__(self) -> str:
        how = ", compiled" if self.compiled else ""
        return f"{self.axial}+{self.bending} shapes, {self.shapes}, {self.integrator}, step {self.step:g} s{how}"


@dataclass(frozen=True)
class Problem:
    """A drive, gbeam's model, how many times faster it should be, and what both codes may choose from."""

    drive: Drive
    model: str
    goal: float
    choices: tuple[Choice, ...]
    settings: tuple[Setting, ...]
    wide: tuple[Setting, ...]


def _choices(counts: list[tuple[int, int]], shapes: list[str], **steps: list[float]) -> tuple[Choice, ...]:
    return tuple(
        Choice(*those, kind, scheme, step)
        for those in counts
        for kind in shapes
        for scheme, lengths in steps.items()
        for step in lengths
    )


def _settings(**lists: list) -> tuple[Setting, ...]:
    return tuple(Setting(**dict(zip(lists, values, strict=True))) for values in itertools.product(*lists.values()))


# What was quickest in the search of --wide, and its neighbours.
SLEW_SETTINGS = (
    *_settings(
        hub=["node"],
        elements=[4, 5, 6],
        steps=[5000, 5500, 6000, 6500, 8000, 10_000],
        points=[2],
        contractivity=[0.5, 0.7],
    ),
    *_settings(hub=["node"], elements=[6, 7], steps=[5000, 5500], contractivity=[0.7]),
    *_settings(hub=["rigid"], elements=[4, 6], steps=[5500, 8000], points=[2], contractivity=[0.7]),
)
TORQUE_SETTINGS = (
    *_settings(hub=["rigid"], elements=[4, 5, 6], steps=[900, 1000, 1200, 4000], points=[2], contractivity=[0.3, 0.5]),
    *_settings(hub=["element"], elements=[5, 6, 8], steps=[1200, 1500, 4000], points=[2], contractivity=[0.3, 0.5]),
    *_settings(hub=["rigid"], elements=[12, 16], steps=[1500, 4000]),
    Setting("rigid", 6, 1200, 2, method="TrapezoidalIndex2"),
)
SLEW_WIDE = _settings(
    hub=["rigid", "node"],
    elements=[4, 5, 6, 7, 8, 12],
    steps=[4500, 5000, 5500, 6000, 6500, 8000, 10000, 15000, 20000],
    points=[0, 2],
    contractivity=[0.5, 0.7],
    spectral_radius=[0.8, 0.9],
)
TORQUE_WIDE = (
    *_settings(
        hub=["rigid", "element"],
        elements=[4, 5, 6, 8, 10, 12, 16],
        steps=[700, 800, 900, 1000, 1200, 1500, 2000, 3000, 4000, 6000],
        points=[0, 2],
        contractivity=[0.3, 0.5],
        method=["GeneralizedAlpha", "TrapezoidalIndex2"],
    ),
    *_settings(hub=["rigid"], elements=[6], steps=[1000, 4000], points=[2], modified_newton=[False]),
    *_settings(hub=["rigid"], elements=[6], steps=[1000, 4000], points=[2], tolerance=[1e-4, 1e-5, 1e-7]),
    *_settings(hub=["rigid"], elements=[6], steps=[1000, 4000], points=[2], linear=["EXUdense", "EigenSparse"]),
    *_settings(hub=["element"], elements=[4, 6], steps=[100_000, 200_000], points=[2], method=["RK44"]),
)
PROBLEMS = {
    "slew, FOAM": Problem(
        SLEW,
        "FOAM",
        50,
        _choices(
            [(0, 3), (0, 4), (0, 5), (1, 5)],
            ["clamped-free"],
            gauss=[0.1, 0.125, 0.2, 0.25, 0.3125, 0.4, 0.5],
            newmark=[0.01, 0.02, 0.04],
        ),
        SLEW_SETTINGS,
        SLEW_WIDE,
    ),
    "free hub, FOAM": Problem(
        TORQUE,
        "FOAM",
        10,
        _choices(
            [(0, 3), (0, 4), (0, 5), (1, 5)],
            ["adapted"],
            gauss=[0.05, 0.08, 0.1, 0.125, 0.15625, 0.2, 0.25, 0.3125, 0.4],
            newmark=[0.0025, 0.005, 0.01, 0.02],
        ),
        TORQUE_SETTINGS,
        TORQUE_WIDE,
    ),
    "free hub, exact": Problem(
        TORQUE,
        "exact",
        2,
        _choices(
            [(0, 3), (0, 4), (0, 5)],
            ["clamped-free", "adapted"],
            gauss=[0.05, 0.08, 0.1, 0.125, 0.15625, 0.2, 0.25, 0.3125, 0.4],
            newmark=[0.004, 0.005, 0.01, 0.02],
        ),
        TORQUE_SETTINGS,
        TORQUE_WIDE,
    ),
}
