"""200 random scenarios: the error that is stated against the error that is there. The truth is the exact model with
eight adapted shapes by Gauss's method with 150 steps to the lowest period or more; other codes above agree with it.
What the theory of slender beams leaves out is in neither.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

import gbeam as gb
from gbeam.errors import GbeamError
from validation.accuracy.draw import Scenario, draw
from validation.table import Row

TITLE = "Stated against true errors"
NEEDS = ("numpy", "scipy", "jax")
COUNT = 200
PER_PERIOD = 150
SURE = 3e-6  # a true error below is not known from the truth's own
SOURCE = "exact with eight adapted shapes, small steps"


class Judged(NamedTuple):
    """A stated and a true error of one scenario, of the tip's displacement and of the root's moment or force."""

    seed: int
    scenario: Scenario
    tip: tuple[float, float]
    loads: tuple[float, float]


def judge(seed: int, scenario: Scenario) -> Judged | None:
    """Stated and true errors; None where the run or the truth has no answer."""
    counts = scenario.model
    structure = gb.assemble(scenario.beam, counts)
    try:
        response = gb.simulate(structure, scenario.motion, scenario.settings)
        interval = float(response.time[1] - response.time[0])
        finer = math.ceil(interval / scenario.period * PER_PERIOD)
        exact = gb.assemble(scenario.beam, "exact", axial=2, y=8, shapes="adapted")
        small = {"step": interval / finer, "integrator": "gauss", "estimate": False}
        truth = gb.simulate(exact, scenario.motion, duration=scenario.settings.duration, **small)
    except GbeamError:
        return None
    if response.outcome != "done" or truth.outcome != "done" or response.loads is None or truth.loads is None:
        return None

    def error(ours: np.ndarray, theirs: np.ndarray) -> float:
        sizes = np.linalg.norm(ours, axis=1)
        return float(np.linalg.norm(theirs[::finer][: len(ours)] - ours, axis=1).max() / sizes.max())

    pairs = ("root_force", "root_moment")
    loads = max(error(getattr(response.loads, name), getattr(truth.loads, name)) for name in pairs)
    tip = error(response.tip, truth.tip)
    return Judged(seed, scenario, (response.errors.displacement.slender, tip), (response.errors.loads.slender, loads))


def ratios(pairs: list[tuple[float, float]]) -> np.ndarray:
    """Stated over true errors, where the true one is known."""
    return np.array([stated / true for stated, true in pairs if true > SURE])


def rows() -> Iterator[Row]:
    """Shares of the scenarios in which the estimate holds."""
    judged = [each for seed in range(COUNT) if (each := judge(seed, draw(seed))) is not None]
    for name in ("tip", "loads"):
        of = ratios([getattr(each, name) for each in judged])
        case = f"{len(of)} of {COUNT} random scenarios, {'displacement of the tip' if name == 'tip' else 'root loads'}"
        within, tenth = float((3 * of >= 1).mean()), float((of >= 0.1).mean())
        yield Row(case, "true error within three times the stated one, share", 1.0, within, "–", 0.05, SOURCE)
        yield Row(case, "stated error at least a tenth of the true one, share", 1.0, tenth, "–", 0.0, SOURCE)
        remark = "the rest are diverged runs, or errors too small to be known"
        yield Row(case, "stated over true error, median", 1.0, float(np.median(of)), "–", 0.5, SOURCE, remark)
