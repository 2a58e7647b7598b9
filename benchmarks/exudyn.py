"""gbeam beside Exudyn on the hub-beam of 2009, at equal error, in one run.

    python benchmarks/exudyn.py [--problem slew] [--wide]

Each code's fastest setting that reaches an error is looked for among those of exudyn_choices.py (`--wide`: among many
more of Exudyn's). The tip's displacement across the beam, by a cubic spline through the samples of either, must come
within 1e-4 of the peak, at the peak or ("history") at all times, and its residual amplitude after the drive has ended
within 1 %. A model is measured against its own converged answer: Exudyn and exact against the geometrically exact one,
FOAM against FOAM.

Times are processor times of this process with all its threads, s: the first call in a new process, after the package's
import, with an empty and with a filled cache of compiled programs; and the quickest of several later calls.
"""
# ruff: noqa: E402  # this file has the name of the package

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import asdict, dataclass
from typing import Any

HERE = sys.path.pop(0)
import exudyn  # noqa: F401  # the package, before this folder is searched again

sys.path.insert(0, HERE)

import numpy as np
from exudyn_choices import PROBLEMS, Choice, Problem
from exudyn_hub_beam import Drive, HubBeam, Setting
from scipy.interpolate import CubicSpline

import gbeam as gb

PEAK, RESIDUAL = 1e-4, 1e-2


@dataclass(frozen=True)
class Errors:
    """Errors of the peak, of the residual amplitude, and at any time over the peak."""

    peak: float
    residual: float
    history: float

    def reach(self, measure: str) -> bool:
        """True if the error asked for is reached; never where the solution failed."""
        error = self.peak if measure == "peak" else self.history
        return abs(error) <= PEAK and abs(self.residual) <= RESIDUAL


class Reference:
    """A converged answer, as a spline through its samples."""

    def __init__(self, drive: Drive, model: str) -> None:
        finest = Choice(*((1, 7, "clamped-free") if model == "exact" else (2, 9, "adapted")), "gauss", drive.end / 2500)
        structure = structure_of(drive, model, finest.axial, finest.bending, finest.shapes)
        self.drive = drive
        time_, tip = tip_of(structure, drive, finest)
        self.curve, self.time = CubicSpline(time_, tip), time_
        self.peak, self.residual = self.sizes(self.curve)

    def sizes(self, curve: CubicSpline) -> tuple[float, float]:
        """Peak, and half peak-to-peak after the drive has ended, m."""
        start, end = self.drive.duration, self.drive.end
        turns = curve.derivative().roots(extrapolate=False)
        late = np.concatenate([turns[turns >= start], [start, end]])
        return float(np.abs(curve(np.append(turns, end))).max()), float(np.ptp(curve(late)) / 2)

    def errors(self, answer: tuple[np.ndarray, np.ndarray]) -> Errors:
        """Errors of an answer's samples; NaN where there are none."""
        if answer[0].size < 4 or not np.isfinite(answer[1]).all():
            return Errors(np.nan, np.nan, np.nan)
        curve = CubicSpline(*answer)
        peak, residual = self.sizes(curve)
        history = np.abs(curve(self.time) - self.curve(self.time)).max() / self.peak
        return Errors(peak / self.peak - 1, residual / self.residual - 1, float(history))


def structure_of(drive: Drive, model: str, axial: int, bending: int, shapes: str) -> gb.Structure:
    """The hub-beam in one of gbeam's models."""
    section, material = gb.Section.general(7.2968e-5, 8.2189e-9, 8.2189e-9), gb.Material(2766.7, 6.8952e10)
    masses = [gb.PointMass(8.0, drive.mass)] if drive.mass else []
    beam = gb.Beam(8.0, section, material, masses, 0.0, rotary_inertia=False)
    return gb.assemble(beam, model, axial=axial, y=bending, shapes=shapes)


def motion_of(drive: Drive) -> gb.Hub:
    """The drive as gbeam has it."""
    if drive.rate is not None:
        return gb.Hub(radius=0.5, rate=gb.SmoothStep(drive.rate, drive.duration))
    return gb.Hub(radius=0.5, inertia=200.0, torque=gb.Sine(drive.torque, drive.duration))


def tip_of(structure: gb.Structure, drive: Drive, choice: Choice) -> tuple[np.ndarray, np.ndarray]:
    """Times, and the tip's displacement across the beam, m; compiled steps are those of a batch of one case."""
    motion = motion_of(drive)
    how: Any = {"duration": drive.end, "integrator": choice.integrator, "step": choice.step, "loads": False}
    if choice.compiled:
        ((_, response),) = gb.simulate_batch([(structure, motion)], together=1, one_structure=True, **how)
    else:
        response = gb.simulate(structure, motion, estimate=False, **how)
    return np.asarray(response.time), np.asarray(response.tip[:, 1])


def later_calls(problem: Problem, choice: Choice | Setting, repeat: int) -> tuple[float, tuple[np.ndarray, np.ndarray]]:
    """Processor time of the quickest of `repeat` calls after a first one, s; the answer."""
    if isinstance(choice, Setting):
        system = HubBeam(problem.drive, choice)
        solve = system.solve
    else:
        structure = structure_of(problem.drive, problem.model, choice.axial, choice.bending, choice.shapes)

        def solve() -> tuple[np.ndarray, np.ndarray]:
            return tip_of(structure, problem.drive, choice)

    answer, times = solve(), [np.inf]
    for _ in range(repeat if answer[0].size else 0):
        began = time.process_time()
        solve()
        times.append(time.process_time() - began)
    return min(times), answer


def first_call(name: str, choice: Choice | Setting, cache: str) -> float:
    """Processor time of building and solving in a new process, after the imports above, s."""
    words = [sys.executable, __file__, "--first", name, type(choice).__name__, json.dumps(asdict(choice))]
    environment = os.environ | {"JAX_COMPILATION_CACHE_DIR": cache}
    return float(subprocess.run(words, env=environment, check=True, capture_output=True, text=True).stdout.split()[-1])


def print_first_call(name: str, kind: str, fields: str) -> None:
    """Print the time of a first call, in the new process of :func:`first_call`."""
    problem, choice = PROBLEMS[name], {"Choice": Choice, "Setting": Setting}[kind](**json.loads(fields))
    began = time.process_time()
    later_calls(problem, choice, 0)
    print(time.process_time() - began)


def compare(name: str, problem: Problem, wide: bool, repeat: int, cache: str) -> None:
    """Print the table of one problem."""
    references = {
        "Exudyn": Reference(problem.drive, "exact"),
        "gbeam": Reference(problem.drive, problem.model),
    }
    candidates = {"Exudyn": problem.wide if wide else problem.settings, "gbeam": problem.choices}
    tried = {
        code: [(choice, *later_calls(problem, choice, 2)) for choice in choices] for code, choices in candidates.items()
    }
    print(f"\n{name}: gbeam should be {problem.goal:g} times faster")
    for measure in ("peak", "history"):
        quickest = {}
        for code, those in tried.items():
            rated = [(choice, s, references[code].errors(answer)) for choice, s, answer in those]
            good = sorted((row for row in rated if row[2].reach(measure)), key=lambda row: row[1])
            if not good:
                print(f"  {measure}: no setting of {code} reaches it")
                continue
            # The quickest few once more: processor times on a shared machine scatter.
            again = [(later_calls(problem, choice, repeat)[0], choice, e) for choice, _, e in good[:3]]
            best = min(again, key=lambda row: row[0])
            quickest[code], choice, e = best
            with tempfile.TemporaryDirectory() as empty:
                cold = first_call(name, choice, empty)
            warm = min(first_call(name, choice, cache) for _ in range(2))
            print(
                f"  {measure:8}{code:8}{quickest[code]:8.4f} s; first call {cold:.2f} s, compiled before {warm:.2f} s; "
                f"errors {e.peak:+.1e} {e.residual:+.1e} {e.history:.1e}; {choice}",
                flush=True,
            )
        if len(quickest) == 2:
            print(f"  {measure:8}gbeam is {quickest['Exudyn'] / quickest['gbeam']:.1f} times faster", flush=True)


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--problem", default="", help="only problems whose name contains this")
    parser.add_argument("--wide", action="store_true", help="search among many more of Exudyn's settings; half an hour")
    parser.add_argument("--repeat", type=int, default=5, help="calls of which the quickest counts")
    parser.add_argument("--first", nargs=3, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.first:
        print_first_call(*options.first)
        return
    with tempfile.TemporaryDirectory() as cache:
        for name, problem in PROBLEMS.items():
            if options.problem in name:
                compare(name, problem, options.wide, options.repeat, cache)


if __name__ == "__main__":
    main()
