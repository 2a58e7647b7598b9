"""Random scenarios from seeds: beams, bodies, what moves or loads them, models, shapes, integrators."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

import gbeam as gb

SETTING = ("slew", "inward hub", "free hub", "flight", "tip force", "uniform load", "centrifuge")
KINDS, SHARES = ("FOAM", "exact", "CFOAM", "SFOAM", "TLAM"), (0.45, 0.2, 0.1, 0.1, 0.15)
INTEGRATORS = ("newmark", "newmark", "gauss", "hht", "generalized-alpha")


@dataclass(frozen=True)
class Scenario:
    """A beam that bends along y, what drives it, and how it is computed.

    Parameters
    ----------
    setting : str
    beam : Beam
    motion : Flight, Hub or Centrifuge
    model : Model
    settings : ResponseSettings
    period : float
        Of the lowest mode at rest, s.
    """

    setting: str
    beam: gb.Beam
    motion: Any
    model: gb.Model
    settings: gb.ResponseSettings
    period: float


def draw(seed: int, kinds: tuple[str, ...] = KINDS) -> Scenario:
    """The scenario of a seed; deflections from 0.3 to 30 % of the length, six to twelve periods of the lowest mode."""
    random = np.random.default_rng(seed)
    setting = SETTING[seed % len(SETTING)]
    length = float(random.uniform(0.3, 2.0))
    section = gb.Section.rectangle(length / random.uniform(60, 150), length / 20)  # soft along y
    material = gb.Material(2700.0, 70e9)
    line = material.density * float(section.at(np.zeros(1)).area[0])
    # Always two bodies, which may weigh nothing: fewer compiled programs.
    tip, middle = (line * length * float(random.choice([0.0, random.uniform(0.05, 1.0)])) for _ in range(2))
    bodies = [gb.PointMass(length / 2, middle), gb.PointMass(length, tip)]
    ratio = float(random.choice([0.0, 0.005, 0.02]))
    bare = gb.Beam(length, section, material, bodies, damping_ratio=ratio, rotary_inertia=False)
    fine = gb.assemble(bare, "FOAM", axial=1, y=6, shapes="adapted")
    period = 2 * np.pi / float(fine.rest[0][0])
    share = float(np.exp(random.uniform(np.log(0.003), np.log(0.3))))
    duration = float(random.uniform(6, 12)) * period
    rise = float(random.uniform(1.0, 4.0)) * period
    per_unit = abs(float(gb.static(fine, acceleration=(0.0, 1.0, 0.0)).tip[1]))
    acceleration = share * length / per_unit
    beam, motion = bare, _motion(random, setting, acceleration, rise, duration, period, length, line)
    if setting in ("tip force", "uniform load"):
        total = acceleration * (line * length + tip + middle) * (0.4 if setting == "tip force" else 1.0)
        along = gb.trapezoid(total if setting == "tip force" else total / length, jerk=total / rise, hold=duration)
        load = gb.Load(length if setting == "tip force" else None, force=gb.vector(y=along))
        beam = replace(bare, loads=[load])
    chosen = [(kind, weight) for kind, weight in zip(KINDS, SHARES, strict=True) if kind in kinds]
    weights = np.array([weight for _, weight in chosen])
    kind = str(random.choice([kind for kind, _ in chosen], p=weights / weights.sum()))
    axial = 0 if kind == "SFOAM" else int(random.integers(1, 3))
    shapes = str(random.choice(["clamped-free", "clamped-free", "adapted"]))
    model = gb.Model(kind, axial, int(random.integers(1, 6)), 0, shapes)
    step = period / float(random.uniform(40, 150)) if random.random() < 0.25 else None
    settings = gb.ResponseSettings(duration, step=step, integrator=str(random.choice(INTEGRATORS)))
    return Scenario(setting, beam, motion, model, settings, period)


def _motion(
    random: np.random.Generator,
    setting: str,
    acceleration: float,
    rise: float,
    duration: float,
    period: float,
    length: float,
    line: float,
) -> Any:
    ramp = gb.trapezoid(acceleration, jerk=acceleration / rise, start=0.2 * period, hold=0.3 * duration)
    radius = length * float(random.uniform(0.1, 2.0))
    angular = acceleration / (radius + 0.7 * length)
    if setting == "slew":
        return gb.Hub(radius=radius, rate=gb.SmoothStep(min(angular * rise / 2, 3 / period), rise))
    if setting == "inward hub":
        rate = min(np.sqrt(0.1 * acceleration / length), 0.8 / period)
        return gb.Hub(radius=radius, pointing="inward", rate=gb.SmoothStep(float(rate), rise))
    if setting == "free hub":
        inertia = line * length**3 * float(random.uniform(0.3, 5.0))
        return gb.Hub(radius=radius, inertia=inertia, torque=gb.Sine(angular * inertia, 2 * rise))
    if setting == "flight":
        return gb.Flight(y=ramp)
    if setting == "centrifuge":
        # Never near no load, where a machine is quick and its specimen needs no errors of a model to fly apart.
        level = 0.15 * acceleration
        change = gb.smoothed(gb.trapezoid(0.5 * level, jerk=level / rise, start=rise, hold=0.3 * duration), period)
        flight = gb.Flight(y=gb.Sum((gb.constant(level), change)))
        how = {"inverse": "flat", "start": "idle", "idle": 0.5 * level, "gravity": False, "smoothing": 0.06}
        return gb.Centrifuge(flight, arm=20 * length, control_point=0.7 * length, **how).over(0.0, duration)
    return gb.Flight(y=0.0)
