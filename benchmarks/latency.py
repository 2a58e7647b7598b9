"""Time of each command, in units of `import jax` on the same machine in the same run.

    python benchmarks/latency.py [--runs 5] [--only run]

Processor time is user and system time of the command with all its threads and children. Each repetition runs every
command once, so that a machine that slows down slows all of them; medians are shown. "warm" finds its compiled
programs in the cache, "cold" starts with an empty cache folder. Python keeps its bytecode, as of an installed package,
also where the environment tells it not to.
"""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

EXAMPLES = Path(__file__).parents[1] / "examples"
F16 = str(EXAMPLES / "f16_8g_turn.toml")
SLEW = str(EXAMPLES / "hubbeam2009_slew_3.toml")
UNIT = "import jax"


@dataclass
class Command:
    """One command line of gbeam, its goal in units of `import jax`, and its measured times, s."""

    name: str
    words: list[str]
    goal: float | None
    cold: bool = False
    processor: list[float] = field(default_factory=list)
    wall: list[float] = field(default_factory=list)


def commands(out: Path) -> list[Command]:
    """Every command that has a goal; files go to `out`."""
    tlam = ["--set", "model.kind=TLAM"]  # FOAM on this hub has no critical speed
    slew, f16 = ["run", SLEW, "--out", str(out / "slew")], ["run", F16, "--out", str(out / "f16")]
    return [
        Command("--help", ["--help"], 0.6),
        Command("check, F-16", ["check", F16], 1),
        Command("modes, hub beam", ["modes", SLEW], 2),
        Command("static, hub beam", ["static", SLEW], 2),
        Command("campbell, hub beam", ["campbell", SLEW], 2),
        Command("critical-speed, hub beam", ["critical-speed", SLEW, *tlam], 2),
        Command("linearize, hub beam", ["linearize", SLEW], 2),
        Command("run, hub slew, warm", slew, 4),
        Command("run, hub slew, cold", slew, 6, cold=True),
        Command("plan, F-16", ["plan", F16], 5),
        Command("run, F-16, warm", f16, 9),
        Command("run, F-16, cold", f16, 14, cold=True),
    ]


def measure(command: Command, cache: str, folder: Path) -> tuple[float, float]:
    """Processor and wall time of one run, s."""
    words = ["-c", "import jax"] if command.name == UNIT else ["-m", "gbeam", *command.words]
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    environment |= {"JAX_COMPILATION_CACHE_DIR": cache, "PYTHONPYCACHEPREFIX": str(folder / "bytecode")}
    with (folder / "stderr").open("w+") as errors:
        began = time.perf_counter()
        child = subprocess.Popen(
            [sys.executable, *words],
            cwd=folder,
            env=environment,
            stdout=subprocess.DEVNULL,
            stderr=errors,
        )
        _, status, usage = os.wait4(child.pid, 0)
        wall = time.perf_counter() - began
        child.returncode = os.waitstatus_to_exitcode(status)
        if child.returncode:
            errors.seek(0)
            raise SystemExit(f"{' '.join(words)} ended with {child.returncode}:\n{errors.read()}")
    return usage.ru_utime + usage.ru_stime, wall


def repeat(measured: list[Command], runs: int, folder: Path) -> None:
    """Run every command `runs` times and once before, to warm the caches of programs and of the file system."""
    warm = str(folder / "warm")
    for run in range(runs + 1):
        for command in measured:
            with tempfile.TemporaryDirectory() as empty:
                processor, wall = measure(command, empty if command.cold else warm, folder)
            if run:
                command.processor.append(processor)
                command.wall.append(wall)
        print(f"\r{run}/{runs}", end="", file=sys.stderr, flush=True)
    print(file=sys.stderr)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=5, help="runs of each command")
    parser.add_argument("--only", default="", help="only commands whose name contains this")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        unit = Command(UNIT, [], None)
        measured = [unit, *(command for command in commands(folder) if options.only in command.name)]
        repeat(measured, options.runs, folder)
    one, one_wall = statistics.median(unit.processor), statistics.median(unit.wall)
    print(f"{'':26}{'processor':>11}{'units':>7}{'goal':>6}  {'wall':>8}{'units':>7}")
    for command in measured:
        processor, wall = statistics.median(command.processor), statistics.median(command.wall)
        goal = "" if command.goal is None else f"{command.goal:g}"
        reached = "" if command.goal is None else "yes" if processor / one <= command.goal else "no"
        print(
            f"{command.name:26}{processor:9.2f} s{processor / one:7.2f}{goal:>6}  {wall:6.2f} s{wall / one_wall:7.2f}"
            f"  {reached}"
        )


if __name__ == "__main__":
    main()
