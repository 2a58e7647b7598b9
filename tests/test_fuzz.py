"""A slice of the fuzzer: `make fuzz` runs a hundred times as many, interrupts runs and fills disks."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import gbeam as gb

ROOT = Path(__file__).parents[1]
sys.path.append(str(ROOT))

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="forks, with limits on time and memory")


def test_malformed_inputs_are_refused_with_their_place() -> None:
    command = [sys.executable, "-m", "fuzz", "--count", "30", "--seed", "10"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == 0 and done.stdout.endswith("no faults\n"), done.stdout + done.stderr
    refused = sum(int(words.split()[0]) for words in done.stdout.replace(":", ",").split(",") if "status 2" in words)
    assert refused > 20


@pytest.mark.parametrize("seed", range(12))
def test_trees_at_random_are_scenarios(seed: int, tmp_path: Path) -> None:
    from fuzz.walk import planted

    case = gb.read_scenario(planted(tmp_path, seed))
    assert len(case.system.order) == len(case.system.joints)


@pytest.mark.parametrize(
    ("status", "out", "err", "fault"),
    [
        (2, "", "s.toml:1:1: beam is missing\n", ""),
        (2, "", "gbeam: --out x: no\n", ""),
        (0, "Scenario valid.\n", "", ""),
        (3, "", "gbeam: defect: KeyError\n", "defect"),
        (1, "", "Traceback (most recent call last):\nKeyError\n", "defect"),
        (-24, "", "", "hang"),
        (-11, "", "", "killed by SIGSEGV"),
        (2, "half", "s.toml:1:1: beam is missing\n", "output of a refused input"),
        (2, "", "something\n", "no place"),
        (2, "", "s.toml: \x1b[31m\n", "control characters"),
        (1, "", "", "failed without a word"),
        (1, "", "gbeam: out of memory: x\n", "memory"),
        (0, "", "a.py:1: RuntimeWarning: overflow\n", "warning"),
    ],
)
def test_the_judge_sees_faults(status: int, out: str, err: str, fault: str) -> None:
    from fuzz.cases import Case
    from fuzz.judge import judge
    from fuzz.worker import Answer

    answer = judge(Case("scenario", ["check", "s.toml"]), Answer(status, out, err, 0.1, 1, (), ""))
    assert answer.startswith(fault) and bool(answer) == bool(fault)


RECORDED = """\
[motion.flight.record]
file = "r.csv"
unit = "g"
skip_checks = ["sign"]
"""


@pytest.mark.parametrize(
    ("hints", "fault"),
    [
        (
            {"g": 'write unit = "m/s^2"; if it is right, add skip_checks = ["unit"]', "m/s^2": 'write unit = "g"'},
            "circle",
        ),
        ({"g": 'if it is a rocket\'s, add vehicle = "rocket"'}, "a fix that mends nothing"),
        ({"g": 'write unit = "m/s^2"; add despike = true', "m/s^2": "put a number there"}, ""),
    ],
)
def test_fixes_are_followed_to_their_end(hints: dict[str, str], fault: str) -> None:
    """A message for every unit: fixes that lead to each other, or to the same message again, are faults."""
    import tomllib

    from fuzz.cases import Case
    from fuzz.fixes import circle
    from fuzz.worker import Answer

    def call(case: Case) -> Answer:
        record = tomllib.loads(case.files["s.toml"].decode())["motion"]["flight"]["record"]
        unit = record["unit"]
        if "unit" in record["skip_checks"] or "despike" in record or unit not in hints:
            return Answer(0, "", "", 0.1, 1, (), "")
        place = f's.toml:3:8: motion.flight.record.unit: is {unit}\n    3 | unit = "{unit}"\n      |        ^^^\n'
        return Answer(2, "", f"{place}      = {hints[unit]}\n", 0.1, 1, (), "")

    answer = circle(Case("fixes", ["check", "s.toml"], {"s.toml": RECORDED.encode()}), call)
    assert answer.startswith(fault) and bool(answer) == bool(fault)
