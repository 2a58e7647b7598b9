"""Cases per second of batches: beside Exudyn at equal error, and how the cost grows.

    python benchmarks/batch.py [--plot FILE] [--memory] [--cases 1000]

Times are processor times of this process, s, of the quickest run but the first, which compiles, with everything that a
case takes from a motion to its response: initial state, corners, integration, peaks, warnings; no loads and no estimate
of errors. Every case has a drive of its own. Exudyn's is the quickest of the settings of exudyn_choices.py that comes
within the errors of exudyn.py for the nominal drive, one case after the other, its model built before. Both compute in
turn, a second and a batch each, seven times: the median is shown, with the least and the largest.
"""
# ruff: noqa: E402  # a file beside this one has the name of a package

from __future__ import annotations

import argparse
import gc
import importlib.util
import os
import resource
import sys
import time
from collections.abc import Iterator
from typing import Any

os.environ.setdefault("XLA_FLAGS", "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1")
HERE = sys.path.pop(0)
import exudyn  # noqa: F401  # the package, before this folder is searched again

sys.path.insert(0, HERE)

import jax
import numpy as np
from exudyn_choices import PROBLEMS, Choice, Problem

import gbeam as gb
from gbeam.analysis import TOGETHER
from gbeam.integrate import side_by_side

spec = importlib.util.spec_from_file_location("comparison", os.path.join(HERE, "exudyn.py"))
assert spec is not None and spec.loader is not None
comparison = importlib.util.module_from_spec(spec)
sys.modules["comparison"] = comparison
spec.loader.exec_module(comparison)

SLEW, HUB = PROBLEMS["slew, FOAM"], PROBLEMS["free hub, exact"]
ROUNDS, ROUND = 7, 1.0  # of both codes in turn; how long the other takes in each, s
SLEW_5_5 = Choice(5, 5, "clamped-free", "newmark", 1 / 29)  # the longest step within 1e-4 of the peak


def motions(problem: Problem, count: int) -> Iterator[gb.Hub]:
    """Drives of 0.8 to 1 of the nominal size."""
    for share in np.linspace(0.8, 1.0, count):
        if problem.drive.rate is not None:
            yield gb.Hub(radius=0.5, rate=gb.SmoothStep(share * problem.drive.rate, problem.drive.duration))
        else:
            torque = gb.Sine(share * problem.drive.torque, problem.drive.duration)
            yield gb.Hub(radius=0.5, inertia=200.0, torque=torque)


def seconds(problem: Problem, choice: Choice, count: int, runs: int = 2, end: float | None = None) -> float:
    """Processor time of a batch, s: the quickest run but the first, if there are more."""
    structure = comparison.structure_of(problem.drive, problem.model, choice.axial, choice.bending, choice.shapes)
    times = []
    gc.freeze()  # what other settings left in this process is no part of the batch
    for _ in range(runs):
        began, done = time.process_time(), 0
        cases = ((structure, motion) for motion in motions(problem, count))
        how = {"integrator": choice.integrator, "step": choice.step, "duration": end or problem.drive.end}
        for _, response in gb.simulate_batch(cases, loads=False, one_structure=True, **how):
            done += response.outcome == "done"
        assert done == count
        times.append(time.process_time() - began)
    return min(times[1:] or times)


def beside_exudyn(name: str, problem: Problem, count: int, goal: float) -> None:
    """Print both codes' cases per second at equal error of the peak."""
    rated = {}
    for code, choices in (("Exudyn", problem.settings), ("gbeam", problem.choices)):
        reference = comparison.Reference(problem.drive, "exact" if code == "Exudyn" else problem.model)
        tried = [(choice, *comparison.later_calls(problem, choice, 2)) for choice in choices]
        rated[code] = [(s, choice) for choice, s, answer in tried if reference.errors(answer).reach("peak")]
    # Of Exudyn those that are quick in a run, of gbeam those of few steps and shapes, which is what a batch costs.
    rated["Exudyn"] = sorted(rated["Exudyn"], key=lambda row: row[0])[:3]
    rated["gbeam"] = sorted(rated["gbeam"], key=lambda row: (row[1].axial + row[1].bending) / row[1].step)[:6]
    of_theirs = [(comparison.later_calls(problem, choice, 5)[0], choice) for _, choice in rated["Exudyn"]]
    system = comparison.HubBeam(problem.drive, min(of_theirs, key=lambda row: row[0])[1])
    _, choice = min(((seconds(problem, choice, count, 3), choice) for _, choice in rated["gbeam"]), key=lambda r: r[0])
    theirs, ours = [], []
    for _ in range(ROUNDS):  # in turn: a machine that others use is slow for both
        began, solved = time.process_time(), 0
        while (took := time.process_time() - began) < ROUND:
            system.solve()
            solved += 1
        theirs.append(took / solved)
        ours.append(seconds(problem, choice, count, 1) / count)
    ratios, rates = np.divide(theirs, ours), [1 / np.median(each) for each in (theirs, ours)]
    print(
        f"{name}: Exudyn {rates[0]:.4g} cases/s, gbeam {rates[1]:.4g} ({count} cases, {choice}): "
        f"{np.median(ratios):.1f} times as many, {ratios.min():.1f} to {ratios.max():.1f} (goal {goal:g})",
        flush=True,
    )


def peak_flops() -> float:
    """Operations per second of a product of matrices on one core."""
    a = np.random.default_rng(0).normal(size=(1000, 1000))
    times = []
    for _ in range(5):
        began = time.perf_counter()
        a @ a
        times.append(time.perf_counter() - began)
    return 2e9 / min(times)


def steps_of(choice: Choice, problem: Problem) -> None:
    """Print what a compiled step of the linear equations takes."""
    seen: list[Any] = []
    original = side_by_side.taken_together

    def watched(*values: Any, **how: Any) -> Any:
        seen.append((values, how))
        return original(*values, **how)

    side_by_side.taken_together = watched  # type: ignore[assignment]
    seconds(problem, choice, TOGETHER)
    side_by_side.taken_together = original
    values, how = seen[0]
    steps, together = values[-1], values[0].shape[-1]
    times = []
    for _ in range(10):
        began = time.process_time()
        jax.block_until_ready(original(*values, **how))
        times.append(time.process_time() - began)
    each = min(times) / steps / together
    cost = original.lower(*values, **how).compile().cost_analysis()
    # The compiler counts the body of a loop once.
    flops = cost["flops"] / together
    peak = peak_flops()
    rate, size = flops / each, cost["bytes accessed"] / together
    print(f"a step of {choice.axial} + {choice.bending} modes, {choice.integrator}: ", end="")
    print(f"{1e6 * each:.3g} us, {flops:.0f} flops, {size:.0f} bytes; {rate / 1e9:.2g} Gflop/s, ", end="")
    print(f"{100 * rate / peak:.2g} % of the core's {peak / 1e9:.3g} in a product of large matrices", flush=True)


def growth(file: str | None) -> None:
    """Print, and plot, time per case over modes, steps and cases."""
    modes, steps, cases = (2, 4, 6, 8, 10, 12), (250, 500, 1000, 2000, 4000), (64, 128, 256, 512, 1024)

    def slews(bending: int, count: int, number: int) -> float:
        return seconds(SLEW, Choice(0, bending, "clamped-free", "newmark", SLEW.drive.end / count), number)

    table = {
        "modes": (modes, [1e3 * slews(k, 1000, 256) / 256 for k in modes]),
        "steps": (steps, [1e3 * slews(4, k, 256) / 256 for k in steps]),
        "cases": (cases, [slews(4, 1000, k) for k in cases]),
    }
    for name, (values, times) in table.items():
        unit = "s in all" if name == "cases" else "ms a case"
        print(
            f"{name}: " + ", ".join(f"{v}: {t:.3g}" for v, t in zip(values, times, strict=True)) + f" {unit}",
            flush=True,
        )
    if file:
        import matplotlib.pyplot as plt

        figure, panels = plt.subplots(1, 3, figsize=(10, 3), layout="constrained")
        for panel, (name, (values, times)) in zip(panels, table.items(), strict=True):
            panel.plot(values, times, "o-")
            panel.set(xlim=(0, None), ylim=(0, None))
            panel.set(xlabel=name, ylabel="processor time, s" if name == "cases" else "processor time of a case, ms")
            panel.grid(True, alpha=0.3)
        figure.savefig(file, dpi=120)


def memory() -> None:
    """Print the largest resident size of 100,000 small cases, GiB."""
    took = seconds(SLEW, Choice(0, 2, "clamped-free", "newmark", 0.1), 100_000, 1, end=10.0)
    largest = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    print(f"100,000 cases of 2 modes and 100 steps: {took:.4g} s, {largest:.3g} GiB at most")


def main() -> None:
    """Print everything."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--plot", help="file for the plot of how the cost grows")
    parser.add_argument("--memory", action="store_true", help="100,000 cases; minutes")
    parser.add_argument("--cases", type=int, default=1000)
    options = parser.parse_args()
    if options.memory:
        memory()
        return
    took = seconds(SLEW, SLEW_5_5, options.cases, 3)
    print(f"{options.cases} slews, {SLEW_5_5}, {SLEW.drive.end:g} s: {took:.3g} s (goal for 1,000: 4 s)", flush=True)
    beside_exudyn("slew", SLEW, options.cases, 100)
    beside_exudyn("free hub, exact", HUB, options.cases // 4, 20)
    for choice in (SLEW_5_5, Choice(0, 3, "clamped-free", "gauss", 0.2)):
        steps_of(choice, SLEW)
    growth(options.plot)


if __name__ == "__main__":
    main()
