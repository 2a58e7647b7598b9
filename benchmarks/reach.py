"""Every figure of reach: gbeam beside Exudyn at equal error, in turn in one process, and how long first calls take.

    python benchmarks/reach.py [--only driven] [--markdown]

What was measured is kept in reach.json, each figure as it was last; `--markdown` prints docs/speed.md of that, which
`make docs` writes.
"""
# ruff: noqa: E402  # a file beside this one has the name of a package

from __future__ import annotations

import argparse
import cProfile
import importlib.util
import json
import os
import pstats
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

HERE = Path(sys.path.pop(0))
import exudyn  # the package, before this folder is searched again

sys.path.insert(0, str(HERE))
import closed_loop  # takes this folder out of those that are searched

sys.path.insert(0, str(HERE))
import space_beams  # likewise

sys.path.insert(0, str(HERE))
import numpy as np
from exudyn_choices import PROBLEMS, Choice, Setting

import gbeam as gb

spec = importlib.util.spec_from_file_location("comparison", HERE / "exudyn.py")
assert spec is not None and spec.loader is not None
comparison = importlib.util.module_from_spec(spec)
sys.modules["comparison"] = comparison
spec.loader.exec_module(comparison)

Call = Callable[[], Any]
Settings = dict[str, Call]  # by words
RECORD, WITHIN = HERE / "reach.json", 1e-4
TURNS, FEW = 5, 8  # of the quickest settings in a plane, where a run takes milliseconds: the least time counts
SPELL = 0.25  # s of each code in a turn
DEFAULTS = ", all defaults"  # of a row where little is set
ELEMENTS, GUESSES = 8, (100, 1000, 10_000)  # of Exudyn's beam there, and numbers of steps that are tried
PATIENCE = 60  # s
SPACE = {  # goal; gbeam's reference, its settings and Exudyn's: numbers of shapes, of elements, and steps, s
    "driven": (10, "driven base in space, torsion", (7, 0.02), [(5, 0.04), (6, 0.02)], [(64, 0.005), (128, 0.0025)]),
    "free hub in space": (
        None,
        "free hub in space, torsion",
        (6, 0.025),
        [(4, 0.1), (5, 0.05)],
        [(64, 0.005), (128, 0.0025)],
    ),
    "satellite": (
        10,
        "free body with two panels in space",
        (8, 0.0025),
        [(7, 0.01)],
        [(128, 0.00125)],
    ),
}
RUNS = {
    "driven": (space_beams.driven_ours, space_beams.driven_theirs),
    "free hub in space": (space_beams.free_ours, space_beams.free_theirs),
    "satellite": (space_beams.satellite_ours, space_beams.satellite_theirs),
}
BOTH = (False, True)  # a run's own steps, and compiled ones
PLANE = {
    "slew, FOAM": (60, [Choice(0, 3, "clamped-free", "gauss", step) for step in (0.25, 0.3)]),
    "free hub, FOAM": (12, [Choice(0, 3, "adapted", "gauss", 10 / n, how) for n in (33, 40) for how in BOTH]),
    "free hub, exact": (8, [Choice(0, 3, "adapted", "gauss", 10 / n, how) for n in (33, 40) for how in BOTH]),
}
PARTS = {  # of a call, and functions
    "corrections": "_correct",
    "laws in them": "sampled",
    "derivatives": "_differentiate",
    "factors": "_factor",
    "ends": "accelerations",
    "compiled steps": "integrate_together",
}
LIMITS = {  # of what misses its goal
    "slew, FOAM": "Of 14 ms of a run of 170 steps a fifth are the steps, an eighth the start in equilibrium. Six "
    "tenths read what the response of every system has and one beam alone once did without: motions of its points, "
    "the load on the ground, the peaks of both between steps, and whether the beam stays stable. That makes 11,000 "
    "calls of Python and NumPy, none of which takes more than 3 %: of arrays of 170 times the calls count.",
    "free hub, FOAM": "Of 20,000 calls of Python and NumPy the compiled steps take a seventh of the time, the "
    "response four tenths, the equations, contracted for this tree, a sixth, the start and the hub's tree a tenth "
    "each. `gb.simulate`, which compiles nothing, takes as long.",
    "closed loop": "The law is a function of Python, which three corrections call at each sample, one after another: "
    "each gains four digits of what it measures. A fourth, of the motion alone, gives it all twelve.",
    "free hub, exact": "Compiled steps take a quarter of the time, half of it 340 corrections and 20 derivatives, "
    "each a chain of some fifty small operations on 16 sections that wait for one another. The rest are calls of "
    "Python and NumPy as of FOAM, 24,000 in all.",
    "first calls": "Nothing is compiled. Of the strip's runs the last has 44,000 steps, which follow its second "
    "vibration in the hub's plane, 1,139 Hz where the hub is held: the torque begins suddenly.",
}
PAGE = """# How fast

Each row: gbeam and Exudyn, each by the quickest of its settings that comes within 1e-4 of the peak (1.2e-4 in a loop)
or, where none does, by the most accurate, and later calls of both in turn in one process: processor times. The ratio is
Exudyn's time over gbeam's, to be no less than the goal. First calls are those of new processes, the slowest of six
models, and a run of 20 s by FOAM after one; of these the goal is the longest time; Python finds its bytecode, as of an
installed package. Compiled steps are those of `gb.simulate_batch` with `together=1`: the first call of a new size takes
3 s of FOAM and 6 to 8 s of exact, by `gb.simulate` what the row of first calls says. Made by
`python benchmarks/reach.py` from what was measured last, on machines that did other things, too: their load, of two
processors, slows both codes, and the times of first calls.

In rows of all defaults little is set: of gbeam the number of shapes and the end, the rest follows, errors included. Of
Exudyn 8 elements and the end, and the least of 100, 1,000 and 10,000 steps with which its own settings end within a
minute; it states no error.
"""
MODELS = ("TLAM", "FOAM", "SFOAM", "CFOAM", "fourth-order", "exact")
FIRST = """
import sys, time
import gbeam as gb
strip = gb.Section.rectangle(width=0.02, thickness=0.004)
beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
hub = gb.Hub(radius=0.5, inertia=0.02, torque=gb.Sine(0.2, 1.0))
times = []
for end in (0.5, 20.0) if sys.argv[1] == "FOAM" else (0.5,):
    began = time.process_time()
    gb.simulate(gb.assemble(beam, sys.argv[1], y=4, z=1), hub, duration=end, estimate=False, loads=False)
    times.append(time.process_time() - began)
print(*times)
"""


def seconds(call: Call, spell: float = 0.0) -> float:
    """Processor time of the quickest of the calls in a spell, at least one, s."""
    least, end = np.inf, time.process_time() + spell
    while least == np.inf or time.process_time() < end:
        began = time.process_time()
        call()
        least = min(least, time.process_time() - began)
    return least


def quickest(
    settings: Settings, error: Callable[[Any], float], within: float, turns: int
) -> tuple[str, float, list[str]]:
    """Words and error of the quickest setting within an error, of the most accurate one where none is; what failed."""
    rows, failed = [], []
    for words, call in settings.items():
        try:
            reached = error(call())
        except exudyn.SolverError:
            failed.append(words)
            continue
        rows.append((not reached <= within, seconds(call) if reached <= within else reached, words, reached))
    rows.sort()
    if turns > 1 and not rows[0][0]:  # times of milliseconds scatter: of the quickest once more
        again = [(words, reached) for far, _, words, reached in rows[:FEW] if not far]
        rows = sorted((False, seconds(settings[words], SPELL), words, e) for words, e in again)
    return *rows[0][2:], failed


def compared(
    ours: Settings, theirs: Settings, errors: tuple[Any, Any], within: float, turns: int = 1
) -> dict[str, Any]:
    """Both codes' quickest settings within an error, their times in turn, and gbeam's profile."""
    (mine, reached, _), (other, away, failed) = (
        quickest(settings, error, within, turns) for settings, error in zip((ours, theirs), errors, strict=True)
    )
    spell = SPELL if turns > 1 else 0.0
    times = [(seconds(ours[mine], spell), seconds(theirs[other], spell)) for _ in range(turns)]
    quick, slow = (min(each) for each in zip(*times, strict=True))
    profile = cProfile.Profile(time.process_time)
    profile.runcall(ours[mine])
    stats: Any = pstats.Stats(profile).stats  # type: ignore[attr-defined]
    within_calls: dict[str, float] = {}
    for (_, _, name), row in stats.items():
        within_calls[name] = max(row[3], within_calls.get(name, 0.0))
    whole = max(within_calls.values())
    shares = {part: round(within_calls[name] / whole, 2) for part, name in PARTS.items() if name in within_calls}
    rows = {"gbeam": [mine, quick, reached], "Exudyn": [other, slow, away]}
    return {"measured": round(slow / quick, 2), "unit": "times Exudyn", **rows, "failed": failed, "profile": shares}


def in_space(name: str) -> dict[str, Any]:
    """A beam, or two, in space: errors from a converged run of gbeam, of the tip's place at common times."""
    goal, words, finest, *settings = SPACE[name]
    at, tip = RUNS[name][0](*finest)
    common, peak = np.arange(0.0, at[-1], 0.2), np.linalg.norm(tip - tip[0], axis=1).max()
    reference = tip[np.searchsorted(at, common - 1e-9)]

    def error(answer: Any) -> float:
        places = answer[1][np.searchsorted(answer[0], common - 1e-9)]
        return float(np.linalg.norm(places - reference, axis=1).max() / peak)

    ours, theirs = (
        {
            f"{size} {kind}, {1e3 * step:g} ms": lambda run=run, size=size, step=step: run(size, step)
            for size, step in of
        }
        for run, of, kind in zip(RUNS[name], settings, ("shapes", "elements"), strict=True)
    )
    return {"figure": words, "goal": goal, **compared(ours, theirs, (error, error), WITHIN)}


def in_plane(name: str) -> dict[str, Any]:
    """The hub-beam of 2009: errors of the peak and the residual amplitude, from each model's converged run."""
    (goal, choices), problem = PLANE[name], PROBLEMS[name]

    def error_of(model: str) -> Any:
        reference = comparison.Reference(problem.drive, model)

        def error(answer: Any) -> float:
            errors = reference.errors(answer)
            return abs(errors.peak) if errors.reach("peak") else np.inf

        return error

    def call(choice: Any) -> Call:
        if isinstance(choice, Choice):
            beam = comparison.structure_of(problem.drive, problem.model, choice.axial, choice.bending, choice.shapes)
            return lambda: comparison.tip_of(beam, problem.drive, choice)
        return comparison.HubBeam(problem.drive, choice).solve

    ours, theirs = ({str(choice): call(choice) for choice in each} for each in (choices, problem.settings))
    errors = error_of(problem.model), error_of("exact")
    return {"figure": name, "goal": goal, **compared(ours, theirs, errors, WITHIN, TURNS)}


def by_default(name: str) -> dict[str, Any]:
    """The hub-beam of 2009 as both codes compute it where little is set: of gbeam the shapes and the end, and of Exudyn
    elements, the end and a number of steps, the least of some with which it ends within a minute.
    """
    problem = PROBLEMS[name.removesuffix(DEFAULTS)]
    section, material = gb.Section.general(7.2968e-5, 8.2189e-9, 8.2189e-9), gb.Material(2766.7, 6.8952e10)
    masses = [gb.PointMass(8.0, problem.drive.mass)] if problem.drive.mass else []
    beam = gb.assemble(gb.Beam(8.0, section, material, masses, 0.0), problem.model, y=3)
    motion = comparison.motion_of(problem.drive)

    def ours() -> gb.Response:
        return gb.simulate(beam, motion, duration=problem.drive.end)

    response = ours()
    finest = comparison.Reference(problem.drive, "exact")
    error = abs(finest.errors((np.asarray(response.time), np.asarray(response.tip[:, 1]))).peak)
    words = f"{problem.model}, 3 shapes, {response.steps} steps, stated error {response.error_estimate:.1e}"
    quick = min(seconds(ours, SPELL) for _ in range(TURNS))
    rows = {"gbeam": [words, quick, error]}
    failed = []
    for steps in GUESSES:
        arguments = ["--alone", name.removesuffix(DEFAULTS), "--steps", str(steps)]
        try:
            answer = subprocess.check_output([sys.executable, __file__, *arguments], text=True, timeout=PATIENCE)
        except subprocess.TimeoutExpired:
            failed.append(f"{steps} steps, after {PATIENCE} s")
            continue
        took, reached = json.loads(answer.splitlines()[-1])
        rows["Exudyn"] = [f"{ELEMENTS} elements, {steps} steps", took, reached]
        break
    measured = round(rows["Exudyn"][1] / quick, 2) if "Exudyn" in rows else None
    figure = {"figure": name, "goal": None, "measured": measured, "unit": "times Exudyn" if measured else ""}
    return figure | rows | {"failed": failed, "profile": {}}


def alone(name: str, steps: int) -> tuple[float, float]:
    """Processor time, s, of Exudyn by its own settings and a number of steps, and the error of the peak."""
    drive = PROBLEMS[name].drive
    hub_beam = comparison.HubBeam(drive, Setting("rigid", ELEMENTS, steps))
    error = abs(comparison.Reference(drive, "exact").errors(hub_beam.solve_by_default()).peak)
    return min(seconds(hub_beam.solve_by_default, SPELL) for _ in range(TURNS)), error


def in_loop(_: str) -> dict[str, Any]:
    """The satellite under a sampled controller: errors of the hub's angle from each code's converged run."""
    settings: tuple[Settings, Settings] = (
        {"FOAM, 10 ms": lambda: closed_loop.ours(0.01), "exact, 10 ms": lambda: closed_loop.ours(0.01, "exact")},
        {f"4 elements, {step:g} ms": lambda s=step: closed_loop.theirs(4, round(2e4 / s)) for step in (10, 5, 2.5)},
    )
    finest = closed_loop.ours(0.01 / 8), closed_loop.theirs(8, 16_000)
    errors = tuple(lambda answer, of=of: float(np.abs(answer - of).max() / np.abs(of).max()) for of in finest)
    return {"figure": "closed loop of the satellite, 20 s", "goal": 1, **compared(*settings, errors, 1.2e-4, TURNS)}


def first_calls(_: str) -> dict[str, Any]:
    """First calls in new processes, every model on a free hub, the slowest, and 20 s of a stiff strip by FOAM."""
    rows, environment = {}, {key: value for key, value in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"}
    with tempfile.TemporaryDirectory() as folder:
        environment["PYTHONPYCACHEPREFIX"] = folder
        for model in 2 * MODELS:  # the first time bytecode is written
            words = [sys.executable, "-c", FIRST, model]
            answer = subprocess.check_output(words, text=True, env=environment)
            rows[model] = [round(float(each), 2) for each in answer.split()]
    first, later = max(row[0] for row in rows.values()), rows["FOAM"][1]
    figure = "first call of a new size in a new process, and 20 s of a stiff strip after it"
    return {"figure": figure, "goal": [2, 1], "measured": [first, later], "unit": "s", "models": rows}


FIGURES = {name: in_space for name in SPACE} | {name: in_plane for name in PLANE}
FIGURES |= {name + DEFAULTS: by_default for name in PLANE}
FIGURES |= {"closed loop": in_loop, "first calls": first_calls}


def page(record: dict[str, Any]) -> Iterator[str]:
    """Lines of docs/speed.md."""
    yield PAGE
    yield "| figure | goal | measured | gbeam | Exudyn | where gbeam's time goes | load |"
    yield "|---|---|---|---|---|---|---|"
    for row in record.values():
        codes = []
        for code in ("gbeam", "Exudyn"):
            words, took, error = row.get(code, ("", 0.0, 0.0))
            codes.append(f"{words}: {took:.3g} s, error {error:.1e}" if words else "–")
        if row.get("failed"):
            codes[-1] += f"; failed at {', '.join(row['failed'])}"
        parts = row["models"] if "models" in row else row["profile"]
        where = ", ".join(
            f"{k} {100 * v:.0f} %" if isinstance(v, float) else f"{k} {words_of(v)} s" for k, v in parts.items()
        )
        goal, measured = (words_of(row[key]) for key in ("goal", "measured"))
        load = row["versions"].rpartition(" ")[2]
        yield f"| {row['figure']} | {goal} | {measured} {row['unit']} | {' | '.join(codes)} | {where or '–'} | {load} |"
    missed = [name for name in LIMITS if name in record and misses(record[name])]
    if missed:
        yield "\n## Goals that are missed"
    for name in missed:
        yield f"\n**{record[name]['figure']}**: {LIMITS[name]}"


def misses(row: dict[str, Any]) -> bool:
    """True if a figure misses its goal: a ratio that is less, or one of two times that is more."""
    if isinstance(row["goal"], list):
        return any(took > goal for took, goal in zip(row["measured"], row["goal"], strict=True))
    return bool(row["measured"] < row["goal"])


def words_of(value: Any) -> str:
    """A goal or measurement, or two of them."""
    return "–" if value is None else " and ".join(map(str, value)) if isinstance(value, list) else str(value)


def main() -> None:
    """Measure, and keep what was measured."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", default="", help="only figures whose name contains this")
    parser.add_argument("--alone", help="print time and error of Exudyn by its own settings: for the rows of defaults")
    parser.add_argument("--steps", type=int, help="of --alone")
    parser.add_argument("--markdown", action="store_true", help="measure nothing: print the page of the record")
    options = parser.parse_args()
    if options.alone:
        print(json.dumps(alone(options.alone, options.steps)))
        return
    record = json.loads(RECORD.read_text()) if RECORD.exists() else {}
    for name, measure in FIGURES.items() if not options.markdown else ():
        if options.only in name:
            record[name] = measure(name) | {"versions": f"gbeam {gb.__version__}, load {os.getloadavg()[0]:.0f}"}
            print(json.dumps(record[name], ensure_ascii=False), flush=True)
            RECORD.write_text(json.dumps(record, indent=1, ensure_ascii=False) + "\n")
    if options.markdown:
        print("\n".join(page(record)))


if __name__ == "__main__":
    main()
