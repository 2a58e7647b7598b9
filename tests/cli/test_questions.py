"""A question that a test declares, in two places: its record and its function. Everything else follows."""

from __future__ import annotations

import json
import os
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from ..scenarios import FAST

RECORD = '''
from __future__ import annotations
from dataclasses import dataclass
from gbeam.results import Result, fact

@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Droop(Result):
    """Deflection of the tip under a load across it."""
    load: float = fact("load across the tip", "N")
    tip: float = fact("deflection of the tip", "m")
'''
QUESTION = '''
from __future__ import annotations
from typing import Annotated
from gbeam.questions import Needs, question
from record_of_droop import Droop

@question("droop", "Deflection of the tip under a load across it.", motion=None)
def droop(
    case, motion=None, at=None, needs=Needs(), *, load: Annotated[float, 'Across the tip, "1 N".', "force"] = 1.0
) -> Droop:
    """F L^3 / (3 E I)."""
    stiffness = case.beam.material.youngs_modulus * float(case.beam.section.at(0.0).inertia_y)
    return Droop(load=load, tip=load * case.beam.length**3 / (3 * stiffness))
'''
# A process that knows the question, and calls the command line with one list of words after the other.
CALLS = """
import io, json, sys, contextlib, question_of_droop
from gbeam.cli import main
printed = []
for words in json.loads(sys.argv[1]):
    with contextlib.redirect_stdout(io.StringIO()) as out:
        assert main(words) == 0, words
    printed.append(out.getvalue())
print(json.dumps(printed))
"""
STIFFNESS = 70e9 * 0.02 * 0.004**3 / 12  # N m^2
TIP = 0.3**3 / (3 * STIFFNESS)  # m of 1 N


def python(code: str, *words: str) -> Any:
    """Output of a Python that knows the question, which is JSON."""
    answer = subprocess.run(
        [sys.executable, "-c", code, *words], capture_output=True, text=True,
        env=os.environ | {"PYTHONPATH": os.pathsep.join([".", *sys.path])},
    )  # fmt: skip
    assert answer.returncode == 0, answer.stderr
    return json.loads(answer.stdout)


def called(*commands: str) -> list[str]:
    """Outputs of some commands of the command line."""
    return python(CALLS, json.dumps([shlex.split(each) for each in commands]))


@pytest.fixture(autouse=True)
def droop(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The two files, and a scenario, in the current folder."""
    monkeypatch.chdir(tmp_path)
    Path("record_of_droop.py").write_text(RECORD, encoding="utf-8")
    Path("question_of_droop.py").write_text(QUESTION, encoding="utf-8")
    Path("fast.toml").write_text(FAST, encoding="utf-8")


def test_it_is_a_verb_with_its_options_and_a_report() -> None:
    told, words, its_help, every = called(
        "droop fast.toml --load '2 N' --json --report --out there", "droop fast.toml", "droop --help", "--help"
    )
    facts = json.loads(told)
    assert facts["tip"] == pytest.approx(2 * TIP) and facts["units"] == {"load": "N", "tip": "m"}
    assert json.loads(Path("there/droop.json").read_text(encoding="utf-8"))["tip"] == facts["tip"]
    page = Path("there/droop.html").read_text(encoding="utf-8")
    assert "<td>tip</td>" in page and "gbeam droop," in page
    rows = [line.split(maxsplit=3) for line in words.splitlines()]
    assert rows[0] == ["load", "1.000", "N", "load across the tip"]
    assert rows[1] == ["tip", f"{TIP:#.4g}", "m", "deflection of the tip"]
    assert 'Across the tip, "1 N".' in its_help and "droop" in every


def test_it_is_swept_differentiated_and_minimised() -> None:
    asked = "fast.toml --verb droop --json --out out"
    swept, slope, best = map(
        json.loads,
        called(
            f"sweep {asked} --over 'beam.length=300 mm, 600 mm' --measure tip",
            f"sensitivity {asked} --of tip --with beam.length",
            f"optimize {asked} --minimise tip --over beam.length --bounds 'beam.length=250 mm:350 mm' "
            "--set 'motion.spin.control_point=0.2 m'",
        ),
    )
    assert swept["measures"]["tip"] == {"unit": "m", "values": pytest.approx([TIP, 8 * TIP])}
    (value,) = slope["measures"]["tip"]["parameters"]
    assert value["derivative"] == pytest.approx(3 * TIP / 0.3, rel=1e-6)
    assert best["minimise"]["unit"] == "m" and best["minimise"]["value"] == pytest.approx(TIP * (25 / 30) ** 3)


def test_it_is_in_the_app_and_in_the_schema() -> None:
    code = """
import json, question_of_droop
from gbeam.app import verb_facts
from gbeam.scenario import json_schema
print(json.dumps([verb_facts(), json.loads(json_schema())]))
"""
    verbs, schema = python(code)
    (load,) = [each for each in verbs["droop"]["options"] if each["name"] == "load"]
    assert load["example"] == "1 N"
    (whose,) = [each for each in verbs["sweep"]["options"] if each["name"] == "verb"]
    assert "droop" in whose["choices"]
    assert "droop" in schema["$defs"]["Sweep"]["properties"]["verb"]["enum"]
