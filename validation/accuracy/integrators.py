"""The errors of the steps of automatic runs, as stated and as they are: a strip with a tip mass on a hub that is slewed
(FOAM, CFOAM), jerked (FOAM, exact), or driven by a torque (FOAM), without damping and with 1 %. The truth is the same
model by Gauss's method with a sixtieth of the highest mode's period. A step aims at 1e-4 of the tip's history and at a
third of the tolerance, 1 %, of the root's loads, or the run says that another integrator needs fewer steps.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

import gbeam as gb
from validation.table import Row

TITLE = "Every integrator with an automatic step"
NEEDS = ("numpy", "scipy", "jax")
INTEGRATORS = ("newmark", "hht", "generalized-alpha", "gauss")
DAMPING = (0.0, 0.01)
AIM = 1e-4  # of an automatic step at the default tolerance
LOADS_AIM = 1e-2 / 3
PER_PERIOD = 60
SOURCE = f"Gauss's method, {PER_PERIOD} steps to the shortest period"
_SLEW = gb.Hub(radius=0.1, rate=gb.SmoothStep(6.0, 0.3))
JERK = gb.Hub(radius=0.1, rate=gb.Sine(3.0, 0.075))  # the acceleration jumps at both ends
_TORQUE = gb.Hub(radius=0.1, inertia=0.05, torque=gb.Sine(0.5, 0.3))
CASES: dict[str, tuple[str, Any, float]] = {
    "slew (FOAM)": ("FOAM", _SLEW, 0.8),
    "jerk (FOAM)": ("FOAM", JERK, 0.12),
    "torque (FOAM)": ("FOAM", _TORQUE, 0.8),
    "slew (CFOAM)": ("CFOAM", _SLEW, 0.8),
    "jerk (exact)": ("exact", JERK, 0.12),
}


class Judged(NamedTuple):
    """Stated and true errors of the steps of a run, by quantity, and how many steps it took."""

    integrator: str
    case: str
    errors: dict[str, tuple[float, float]]
    steps: int
    advised: bool


def _apart(ours: np.ndarray, theirs: np.ndarray) -> float:
    return float(np.linalg.norm(theirs - ours, axis=-1).max() / np.linalg.norm(theirs, axis=-1).max())


def strip(kind: str, damping: float) -> gb.Structure:
    """600 x 4 x 20 mm of aluminium with 20 g at the tip: 7.2 and 48.8 Hz across, 1.85 kHz along."""
    section, metal = gb.Section.rectangle(0.004, 0.02), gb.Material(2700.0, 70e9)
    beam = gb.Beam(0.6, section, metal, [gb.PointMass(0.6, 0.02)], damping_ratio=damping, rotary_inertia=False)
    return gb.assemble(beam, kind, axial=1, y=2)


def judge() -> Iterator[Judged]:
    """Every case by every integrator."""
    for name, (kind, motion, duration) in CASES.items():
        for damping in DAMPING:
            structure = strip(kind, damping)
            shortest = 2 * np.pi / float(structure.rest[0][-1])
            runs = [gb.simulate(structure, motion, duration=duration, integrator=each) for each in INTEGRATORS]
            interval = float(runs[0].time[1])
            finer = math.ceil(interval / shortest * PER_PERIOD)
            truth = gb.simulate(structure, motion, duration=duration, integrator="gauss", step=interval / finer)
            for run in runs:
                yield Judged(run.integrator, name, _errors(run, truth, finer), run.steps, "gauss" in str(run.warnings))


def _errors(run: gb.Response, truth: gb.Response, finer: int) -> dict[str, tuple[float, float]]:
    ours, theirs = run.loads, truth.loads
    assert ours is not None and theirs is not None
    kept, stated = slice(None, None, finer), run.errors
    root = ("root_force", "root_moment")
    return {
        "tip": (stated.displacement.step, _apart(run.tip, truth.tip[kept])),
        "root loads": (
            stated.loads.step,
            max(_apart(getattr(ours, each), getattr(theirs, each)[kept]) for each in root),
        ),
        "stress": (stated.stress.step, _apart(ours.stress[..., None], theirs.stress[kept][..., None])),
    }


def rows() -> Iterator[Row]:
    """For each integrator, whether the stated errors hold, and the true ones."""
    judged = list(judge())
    for integrator in INTEGRATORS:
        runs = [each for each in judged if each.integrator == integrator]
        pairs = [pair for each in runs for pair in each.errors.values()]
        case = f"{integrator}, {min(each.steps for each in runs)} to {max(each.steps for each in runs)} steps"
        within = float(np.mean([true <= 3 * stated for stated, true in pairs]))
        quantity = f"true error within three times the stated one, share of {len(pairs)}"
        outside = [_outside(each) for each in runs if each.advised]
        yield Row(case, quantity, 1.0, within, "–", 0.0, SOURCE, "; ".join(each for each in outside if each))
        tip = max(each.errors["tip"][1] for each in runs)
        yield Row(case, "true error of the tip over what the step aims at, largest", 0.0, tip / AIM, "–", 1.0, SOURCE)
        remark = "; ".join(_words(each) for each in runs if each.advised)
        loads = max(each.errors["root loads"][1] for each in runs if not each.advised) / LOADS_AIM
        yield Row(case, "the same of the root's loads", 0.0, loads, "–", 1.0, SOURCE, remark)


def _words(run: Judged) -> str:
    stated, true = run.errors["root loads"]
    return f"{run.case}, {run.steps} steps: stated {stated:.1g}, true {true:.1g}, and the run advises gauss"


def _outside(run: Judged) -> str:
    """Quantities of a run that advises gauss that are wrong by more than three times what it states."""
    pairs = ((name, stated, true) for name, (stated, true) in run.errors.items() if true > 3 * stated)
    words = [f"{name}, stated {stated:.1g}, true {true:.1g}" for name, stated, true in pairs]
    return f"{run.case}: {', '.join(words)}, and the run advises gauss" if words else ""
