"""What a release says of itself is the same in every place that says it."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import gbeam

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def test_the_version_is_the_newest_of_the_changes_and_the_one_to_cite() -> None:
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    headings = re.findall(r"^## (.*)$", changes, re.MULTILINE)
    assert headings[0] == "Unreleased"
    assert re.fullmatch(rf"{re.escape(gbeam.__version__)} – \d{{4}}-\d\d-\d\d", headings[1])
    assert f"\nversion: {gbeam.__version__}\n" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert "version" in PROJECT["dynamic"]  # read from gbeam.__version__ as the wheel is built


def test_the_oldest_python_is_the_first_of_the_classifiers() -> None:
    pythons = [name.rpartition(" ")[2] for name in PROJECT["classifiers"] if re.search(r":: 3\.\d+$", name)]
    assert f">={pythons[0]}" == PROJECT["requires-python"]
    assert [int(name[2:]) for name in pythons] == list(range(int(pythons[0][2:]), int(pythons[0][2:]) + len(pythons)))
    tried = re.search(r"^PYTHONS = \((.*)\)$", (ROOT / ".ci" / "wheels.py").read_text(encoding="utf-8"), re.MULTILINE)
    assert tried is not None and re.findall(r'"(.*?)"', tried[1]) == pythons


def test_the_workflow_runs_what_developers_run_and_the_hook_is_make_check() -> None:
    workflow = (ROOT / ".github" / "workflows" / "ci.yml").read_text(encoding="utf-8")
    assert "bash .ci/run" in workflow and (ROOT / ".ci" / "run").exists()
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    targets = re.search(r"target: \[(.*)\]", workflow)
    assert targets is not None and all(f"\n{name}:" in makefile for name in targets[1].split(", "))
    assert "entry: make check\n" in (ROOT / ".pre-commit-config.yaml").read_text(encoding="utf-8")


def test_reports_say_the_version_and_the_scenario() -> None:
    for name in ("wrong_answer", "fault"):
        form = (ROOT / ".github" / "ISSUE_TEMPLATE" / f"{name}.yml").read_text(encoding="utf-8")
        assert "gbeam --version" in form and "label: The scenario\n" in form
