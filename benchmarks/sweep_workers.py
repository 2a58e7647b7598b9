"""Speed of two workers at a sweep beside one: processes of this machine, and a Dask cluster on it.

    python benchmarks/sweep_workers.py [CASES [waiting]]

Prints the wall time of a sweep in s, and the time of one case more, which is what counts in a long sweep, each with its
ratio to that of one process. The aim is 1.8, as far as the machine allows: two copies of the sweep at once, each in a
process of its own, take longer than one alone, and the first line says how many times one's cases per second both make
together. Needs two cores that do nothing else; with `waiting` a case sleeps 0.2 s instead of computing, so that what
handing out the cases costs is seen on a machine that is busy too.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # as the command line and Dask's workers do

import gbeam as gb

SCENARIO = Path(__file__).parents[1] / "examples" / "hubbeam2009_slew_3.toml"
MEASURE = ["slew.tip.y.max_abs"]


def waiting(case: gb.Case) -> float:
    """Sleep."""
    time.sleep(0.2)
    return float(case.beam.length)


def seconds(cases: int, measure: Any, **options: Any) -> float:
    """Wall time of a sweep over so many cases."""
    begin = time.perf_counter()
    over = {"motion.slew.rate.level": f"2:3:{cases} rad/s"}
    swept = gb.sweep(SCENARIO, over, measure, **options)
    assert swept.counts == {"done": cases}
    return time.perf_counter() - begin


def ceiling(cases: int) -> float:
    """Cases per second of two independent processes over those of one."""
    command = [sys.executable, __file__, str(cases), "copy"]

    def together(copies: int) -> float:
        running = [subprocess.Popen(command, stdout=subprocess.PIPE, text=True) for _ in range(copies)]
        return max(float(each.communicate()[0]) for each in running)

    return 2 * together(1) / together(2)


def main() -> None:
    """Print the table."""
    cases = int(sys.argv[1]) if len(sys.argv) > 1 else 120
    measure: Any = {"waiting": waiting} if "waiting" in sys.argv[2:] else MEASURE
    few = cases // 4
    if "copy" in sys.argv[2:]:
        seconds(2, measure)
        print(seconds(cases, measure))
        return
    from distributed import LocalCluster

    print(f"two copies at once: {ceiling(cases):.2f} times the cases per second of one", flush=True)
    seconds(2, measure)
    rates: dict[str, tuple[float, float]] = {}

    def timed(name: str, **options: Any) -> None:
        short, whole = seconds(few, measure, **options), seconds(cases, measure, **options)
        rates[name] = whole, (whole - short) / (cases - few)

    timed("one process")
    timed("--workers 2", workers=2)
    # Started when the others are measured: its processes are never quite idle.
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0") as cluster:
        timed("--scheduler", scheduler=cluster.scheduler_address)
    print(f"{cases} cases    wall, s  ratio    s per case more  ratio")
    one, each_one = rates["one process"]
    for name, (whole, each) in rates.items():
        print(f"{name:<12} {whole:8.2f} {one / whole:6.2f} {each:18.4f} {each_one / each:6.2f}")


if __name__ == "__main__":
    main()
