"""The hub-beam of 2009 in Exudyn: planar cubic ANCF elements in the inertial frame on a rigid hub with a joint
(`benchmarks/exudyn_hub_beam.py`), against gbeam's exact model, which works in the hub's axes with polynomial strains
and rotations. Slews (43) and torques (44) of the paper and beyond. "Mesh and step" is what half the elements and twice
the step change in Exudyn's answer.

FOAM is not exact, nor is the exact model with too few shapes: the last rows of a case compare the largest difference of
their tip from Exudyn's across the beam, over their own peak, with the error that gbeam states beside their result.
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
STATED = 0.2  # of a stated error: its size is asked for, not its digits


@dataclass(frozen=True)
class Answer:
    """Displacement of the tip across the beam, m, over time, s, and the hub's last angle, rad; what gbeam states as its
    error, a fraction of the peak.
    """

    drive: Drive
    tip: CubicSpline
    angle: float
    stated_error: float = np.nan

    @property
    def peak(self) -> float:
        """Largest size of the tip's displacement, m."""
        return float(np.abs(self.tip(self._turns)).max())

    @property
    def residual(self) -> float:
        """Half peak-to-peak after the drive has ended, m."""
        late = np.append(self._turns[self._turns >= self.drive.duration], [self.drive.duration, self.drive.end])
        return float(np.ptp(self.tip(late)) / 2)

    @property
    def _turns(self) -> np.ndarray:
        return self.tip.derivative().roots(extrapolate=False)


def rows() -> Iterator[Row]:
    """Peak, residual vibration and, on a free hub, its angle; then FOAM's error."""
    source = f"{ELEMENTS} elements, generalised-α, {1e3 * STEP:g} ms"
    quantities = {
        "peak of the tip": ("peak", "m", PEAK),
        "residual vibration": ("residual", "m", RESIDUAL),
        "hub's last angle": ("angle", "rad", PEAK),
    }
    for case, drive in CASES.items():
        theirs, coarse = exudyn(drive, ELEMENTS, STEP), exudyn(drive, ELEMENTS // 2, 2 * STEP)
        ours = gbeam(drive, "exact", 7)
        for words, (name, unit, tolerance) in quantities.items():
            if name == "angle" and drive.rate is not None:
                continue
            reference, computed = getattr(theirs, name), getattr(ours, name)
            change = getattr(coarse, name) / reference - 1
            near = abs(computed / reference - 1) < 2 * abs(change)
            yield Row(case, words, reference, computed, unit, tolerance, source,
                      f"mesh and step {100 * change:+.1g} %" if near else "")  # fmt: skip
        for kind, count in (("FOAM", 7), ("exact", 1), ("exact", 2)):
            coarser = gbeam(drive, kind, count)
            true = np.abs(theirs.tip(coarser.tip.x) - coarser.tip(coarser.tip.x)).max() / coarser.peak
            words = f"error of {kind} with {count} shape{'s' * (count > 1)}, true and as stated"
            yield Row(case, words, 100 * true, 100 * coarser.stated_error, "%", STATED, source)


def exudyn(drive: Drive, elements: int, step: float) -> Answer:
    """Exudyn's answer."""
    system = HubBeam(drive, Setting("rigid", elements, round(drive.end / step)))
    return Answer(drive, CubicSpline(*system.solve()), float(system.angle[-1]))


def gbeam(drive: Drive, kind: str, shapes: int) -> Answer:
    """The answer of a model."""
    masses = [gb.PointMass(8.0, drive.mass)] if drive.mass else []
    section, material = gb.Section.general(7.2968e-5, 8.2189e-9, 8.2189e-9), gb.Material(2766.7, 6.8952e10)
    beam = gb.Beam(8.0, section, material, masses, damping_ratio=0.0, rotary_inertia=False)
    structure = gb.assemble(beam, kind, axial=2, y=shapes)
    if drive.rate is not None:
        hub = gb.Hub(radius=0.5, rate=gb.SmoothStep(drive.rate, drive.duration))
    else:
        hub = gb.Hub(radius=0.5, inertia=200.0, torque=gb.Sine(drive.torque, drive.duration))
    response = gb.simulate(structure, hub, duration=drive.end, integrator="gauss", step=0.02)
    tip = CubicSpline(response.time, response.tip[:, 1])
    stated = response.errors.displacement.slender  # Exudyn's cable is slender too
    return Answer(drive, tip, float(response.hub.angle[-1]), stated)
