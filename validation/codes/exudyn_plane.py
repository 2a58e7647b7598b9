"""The hub-beam of 2009 in Exudyn: planar cubic ANCF elements in the inertial frame on a rigid hub with a joint
(`benchmarks/exudyn_hub_beam.py`), against gbeam's exact model, which works in the hub's axes with polynomial strains
and rotations. Slews (43) and torques (44) of the paper and beyond. "Mesh and step" is what half the elements and twice
the step change in Exudyn's answer.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

import gbeam as gb
from benchmarks.exudyn_hub_beam import Drive, HubBeam, Setting
from validation.table import Row

TITLE = "Exudyn in the plane: slews and torques"
NEEDS = ("exudyn", "numpy", "scipy", "jax")
CASES = {
    "slew to 2.8 rad/s": Drive(30.0, 50.0, rate=2.8),
    "slew to 3 rad/s": Drive(30.0, 50.0, rate=3.0),
    "slew to 5 rad/s": Drive(30.0, 50.0, rate=5.0),
    "slew to 3 rad/s in 5 s, 0.1 kg": Drive(5.0, 20.0, rate=3.0, mass=0.1),
    "torque of 50 N m, 0.5 kg": Drive(10.0, 20.0, torque=50.0, mass=0.5),
    "torque of 200 N m": Drive(10.0, 20.0, torque=200.0),
    "torque of 200 N m, 0.5 kg": Drive(10.0, 20.0, torque=200.0, mass=0.5),
    "torque of 400 N m, 0.5 kg": Drive(10.0, 20.0, torque=400.0, mass=0.5),
}
ELEMENTS, STEP = 24, 2e-3
PEAK, RESIDUAL = 1e-4, 2e-3


@dataclass(frozen=True)
class Sizes:
    """Peak and residual amplitude of the tip across the beam, m, and the hub's last angle, rad."""

    peak: float
    residual: float
    angle: float


def rows() -> Iterator[Row]:
    """Peak, residual vibration and, on a free hub, its angle."""
    source = f"{ELEMENTS} elements, generalised-α, {1e3 * STEP:g} ms"
    for case, drive in CASES.items():
        theirs, coarse, ours = exudyn(drive, ELEMENTS, STEP), exudyn(drive, ELEMENTS // 2, 2 * STEP), exact(drive)
        names = {"peak": ("m", PEAK), "residual": ("m", RESIDUAL), "angle": ("rad", PEAK)}
        for name, (unit, tolerance) in names.items():
            if name == "angle" and drive.rate is not None:
                continue
            reference, found = getattr(theirs, name), getattr(ours, name)
            change = getattr(coarse, name) / reference - 1
            what = {"residual": "residual vibration", "angle": "hub's last angle"}.get(name, "peak of the tip")
            row = Row(case, what, reference, found, unit, tolerance, source)
            near = abs(row.difference or 0.0) < 2 * abs(change)
            yield Row(case, what, reference, found, unit, tolerance, source,
                      f"mesh and step {100 * change:+.1g} %" if near else "")  # fmt: skip


def sizes(drive: Drive, time: np.ndarray, tip: np.ndarray, angle: float) -> Sizes:
    """Of a history: its extremes, by a cubic spline."""
    curve = CubicSpline(time, tip)
    turns = curve.derivative().roots(extrapolate=False)
    late = np.append(turns[turns >= drive.duration], [drive.duration, drive.end])
    return Sizes(float(np.abs(curve(turns)).max()), float(np.ptp(curve(late)) / 2), angle)


def exudyn(drive: Drive, elements: int, step: float) -> Sizes:
    """Exudyn's answer."""
    system = HubBeam(drive, Setting("rigid", elements, round(drive.end / step)))
    return sizes(drive, *system.solve(), float(system.angle[-1]))


def exact(drive: Drive) -> Sizes:
    """The answer of gbeam's exact model."""
    masses = [gb.PointMass(8.0, drive.mass)] if drive.mass else []
    section, material = gb.Section.general(7.2968e-5, 8.2189e-9, 8.2189e-9), gb.Material(2766.7, 6.8952e10)
    structure = gb.assemble(gb.Beam(8.0, section, material, masses, damping_ratio=0.0), "exact", axial=2, y=7)
    if drive.rate is not None:
        hub = gb.Hub(radius=0.5, rate=gb.SmoothStep(drive.rate, drive.duration))
    else:
        hub = gb.Hub(radius=0.5, inertia=200.0, torque=gb.Sine(drive.torque, drive.duration))
    found = gb.simulate(structure, hub, duration=drive.end, integrator="gauss", step=0.02)
    return sizes(drive, np.asarray(found.time), np.asarray(found.tip[:, 1]), float(found.hub.angle[-1]))
