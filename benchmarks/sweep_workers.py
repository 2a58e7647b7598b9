"""How much faster two workers compute a sweep than one: processes of this machine, and a Dask cluster on it.

    python benchmarks/sweep_workers.py [CASES]

Prints wall times in s and their ratio to that of one process, each with the start of the processes and without: the
time of one case more, which is what counts in a long sweep. The aim is 1.8. Needs two cores that do nothing else.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import Any

import gbeam as gb

SCENARIO = Path(__file__).parents[1] / "examples" / "hubbeam2009_slew_3.toml"
MEASURE = ["slew.tip.y.max_abs"]


def seconds(cases: int, **options: Any) -> float:
    """Wall time of a sweep over so many cases."""
    begin = time.perf_counter()
    over = {"motion.slew.rate.level": f"2:3:{cases} rad/s"}
    found = gb.sweep(SCENARIO, over, MEASURE, **options)
    assert found.counts == {"done": cases}
    return time.perf_counter() - begin


def main() -> None:
    """Print the table."""
    from distributed import LocalCluster

    cases = int(sys.argv[1]) if len(sys.argv) > 1 else 120
    few = cases // 4
    seconds(2)
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0") as cluster:
        ways = {
            "one process": {},
            "--workers 2": {"workers": 2},
            "--scheduler": {"scheduler": cluster.scheduler_address},
        }
        rates: dict[str, tuple[float, float]] = {}
        for name, options in ways.items():
            short, whole = seconds(few, **options), seconds(cases, **options)
            rates[name] = whole, (whole - short) / (cases - few)
    print(f"{cases} cases    wall, s  ratio    s per case more  ratio")
    one, each_one = rates["one process"]
    for name, (whole, each) in rates.items():
        print(f"{name:<12} {whole:8.2f} {one / whole:6.2f} {each:18.4f} {each_one / each:6.2f}")


if __name__ == "__main__":
    main()
