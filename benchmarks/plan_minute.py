"""Time of `gbeam plan` over a minute at 100 Hz with inverse = "planned", and how well the load is followed.

From standstill to standstill, two records, each with seven sets of limits; every run is a fresh process:

    python benchmarks/plan_minute.py

Prints a table: wall and processor time in s, largest tracking error while the load is followed, the most used limit.
The aim is 10 s on two cores with all limits.
"""

from __future__ import annotations

import json
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from gbeam import machines

F16 = Path(__file__).parents[1] / "examples" / "data" / "f16_8g_turn.csv"
SCENARIO = """\
[motion.flight]
kind = "flight"
record = { file = "record.csv", time = "time_s", x = "n_x_g", y = "n_y_g", z = "n_z_g", unit = "g" }
[motion.spin]
kind = "centrifuge"
tracks = "flight"
arm = "3.3 m"
control_point = "150 mm"
inverse = "planned"
gravity = true
idle = "1.4 g"
smoothing = "60 ms"
[response]
"""
TIME = np.arange(6001) / 100
CASES = {
    "no limits": {},
    "5 % above what that uses": None,
    "axis 1: 5.5 rad/s²; axis 2: 100 rad/s², 3000 rad/s³; axis 3: 30 rad/s²; arm 2000 kg m², 80 kW": {
        "axis1.acceleration": 5.5, "axis2.acceleration": 100, "axis2.jerk": 3000, "axis3.acceleration": 30,
        "inertia": 2000, "power": 80e3,
    },
    "axis 1: 1 rad/s², 3 rad/s³; axis 2: 1 rad/s, 5 rad/s², 20 rad/s³; axis 3: 0.3 rad/s, 20 rad/s³": {
        "axis1.acceleration": 1, "axis1.jerk": 3, "axis2.rate": 1, "axis2.acceleration": 5, "axis2.jerk": 20,
        "axis3.rate": 0.3, "axis3.jerk": 20,
    },
    "axis 1: 4 rad/s, 6 rad/s²; axis 2: 100 rad/s²; arm 2000 kg m², 20 kW": {
        "axis1.rate": 4, "axis1.acceleration": 6, "axis2.acceleration": 100, "inertia": 2000, "power": 20e3,
    },
    "axis 1: 4 rad/s": {"axis1.rate": 4},
    'machine = "specimen-3.3m"; arm 2000 kg m², 80 kW': {
        f"axis{i + 1}.{quantity}": getattr(axis, quantity)
        for i, axis in enumerate(machines["specimen-3.3m"].limits.axes)
        for quantity in ("rate", "acceleration", "jerk")
    } | {"inertia": 2000, "power": 80e3},
}  # fmt: skip


def f16() -> np.ndarray:
    """The shipped record to and fro, in the beam's axes, g."""
    table = np.genfromtxt(F16, delimiter=",", names=True)
    once = np.column_stack([table["n_x_g"], -table["n_y_g"], -table["n_z_g"]])[1:]
    return np.concatenate([once, once[-2::-1], once[1:], once[-2::-1]])[: TIME.size]


def maneuvers() -> np.ndarray:
    """Eight pulls of 4 to 10 g with some roll, g."""
    load = np.column_stack([0 * TIME, 0 * TIME, 1.5 + 0.05 * np.sin(2 * np.pi * 1.7 * TIME)])
    for start, level, rise, hold in (
        (2, 4, 1, 3), (9, 7, 1.5, 2), (16, 3, 0.6, 1), (20, 8, 1.2, 4), (29, 5, 1, 2), (35, 6, 2, 1), (42, 8.5, 1.5, 3),
        (51, 4.5, 0.8, 2),
    ):  # fmt: skip
        begin, end = (np.clip((TIME - when) / rise, 0, 1) for when in (start, start + rise + hold))
        pull = level * ((3 - 2 * begin) * begin**2 - (3 - 2 * end) * end**2)
        load += pull[:, None] * np.column_stack(
            [0 * TIME + 0.1, 0.15 * np.sin(2 * np.pi * 0.7 * (TIME - start)), 0 * TIME + 1]
        )
    return load


def run(scenario: Path, limits: dict[str, float]) -> tuple[float, float, dict[str, object]]:
    """Wall and processor time, s, and the facts of the machine."""
    changes = [word for key, value in limits.items() for word in ("--set", f"motion.spin.limits.{key}={value!r}")]
    command = [sys.executable, "-c", "import sys; from gbeam.cli import main; sys.exit(main())", "plan", str(scenario)]
    before, began = processor_time(), time.perf_counter()
    done = subprocess.run([*command, "--json", *changes], capture_output=True, text=True)
    wall = time.perf_counter() - began
    if done.returncode:
        raise SystemExit(done.stderr)
    return wall, processor_time() - before, json.loads(done.stdout)["motions"]["spin"]


def processor_time() -> float:
    """Processor time of all runs so far, s."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def main() -> None:
    """Print the table."""
    for name, load in (("F-16 to and fro", f16()), ("eight maneuvers", maneuvers())):
        with tempfile.TemporaryDirectory() as folder:
            scenario, record = Path(folder) / "minute.toml", Path(folder) / "record.csv"
            scenario.write_text(SCENARIO, encoding="utf-8")
            np.savetxt(
                record, np.column_stack([TIME, load]), "%.8g", ",", header="time_s,n_x_g,n_y_g,n_z_g", comments=""
            )
            used: dict[str, float] = {}
            for case, limits in CASES.items():
                wall, processor, facts = run(scenario, used if limits is None else limits)
                if not used:
                    used = {
                        f"{each['axis'].replace(' ', '')}.{each['quantity']}": each["used"] for each in facts["limits"]
                    }
                    used = {limit: 1.05 * value for limit, value in used.items()}
                error, most = facts["tracking_error"], max(facts["limits"], key=lambda each: each["share"])
                row = name, case, f"{wall:.1f}", f"{processor:.1f}", f"{error['max']:.3g} ({error['fraction']:.2%})"
                print(f"| {' | '.join(row)} | {most['axis']} {most['quantity']} {most['share']:.1%} |", flush=True)


if __name__ == "__main__":
    main()
