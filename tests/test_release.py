"""Every place that describes a release says the same of it."""

from __future__ import annotations

import ast
import importlib.util
import json
import re
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest

import gbeam

ROOT = Path(__file__).parents[1]
SETTINGS = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
PROJECT, TOOLS = SETTINGS["project"], SETTINGS["tool"]


def test_the_version_is_the_newest_of_the_changes_and_the_one_to_cite() -> None:
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    headings = re.findall(r"^## (.*)$", changes, re.MULTILINE)
    assert headings[0] == "Unreleased"
    newest = re.fullmatch(r"(\d+)\.(\d+)\.(\d+) – \d{4}-\d\d-\d\d", headings[1])
    assert newest is not None
    released, following = ".".join(newest.groups()), f"{newest[1]}.{int(newest[2]) + 1}.0.dev0"
    assert gbeam.__version__ in (released, following)  # what is not released has a version of its own
    assert f"\nversion: {released}\n" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert "version" in PROJECT["dynamic"]  # read from gbeam.__version__ as the wheel is built


def test_the_changelog_has_forty_lines_a_release_at_most() -> None:
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    releases = re.split(r"^## ", changes, flags=re.MULTILINE)[1:]
    assert max(sum(bool(line.strip()) for line in each.splitlines()[1:]) for each in releases) <= 40


def test_every_fragment_of_the_changelog_has_a_kind_and_tells_something() -> None:
    kinds = {each["directory"] for each in TOOLS["towncrier"]["type"]}
    fragments = [path for path in (ROOT / "changes").iterdir() if path.name != "README.md"]
    for fragment in fragments:
        name = re.fullmatch(r"\+[a-z0-9-]+\.([a-z]+)\.md", fragment.name)
        assert name is not None and name[1] in kinds, fragment.name
        assert len(fragment.read_text(encoding="utf-8").split()) in range(4, 120), fragment.name
    about = (ROOT / "changes" / "README.md").read_text(encoding="utf-8")
    assert set(re.findall(r"^\| `(\w+)`", about, re.MULTILINE)) == kinds


def test_the_oldest_python_is_the_first_of_the_classifiers() -> None:
    pythons = [name.rpartition(" ")[2] for name in PROJECT["classifiers"] if re.search(r":: 3\.\d+$", name)]
    assert f">={pythons[0]}" == PROJECT["requires-python"]
    assert [int(name[2:]) for name in pythons] == list(range(int(pythons[0][2:]), int(pythons[0][2:]) + len(pythons)))
    tried = re.search(r"^PYTHONS = \((.*)\)$", (ROOT / ".ci" / "wheels.py").read_text(encoding="utf-8"), re.MULTILINE)
    assert tried is not None and re.findall(r'"(.*?)"', tried[1]) == pythons


# Modules that come with an extra, whose absence is named with its command before anything is computed.
OF_EXTRAS = {
    "anywidget", "control", "distributed", "fastapi", "gmsh", "pypardiso", "pyyeti", "rslab", "sectionproperties",
    "shapely", "starlette", "traitlets", "uvicorn",
}  # fmt: skip
MODULES = {  # by distribution
    "h5netcdf": {"h5netcdf", "h5py"},
    "jax": {"jax", "jaxlib"},
    "matplotlib": {"matplotlib", "mpl_toolkits"},
    "pillow": {"PIL"},
    "pydantic": {"pydantic", "pydantic_core"},
    "scikit-fem": {"skfem"},
}


def test_all_that_the_package_imports_comes_with_it_or_with_an_extra() -> None:
    """A run of any example after `pip install gbeam` ends in no missing module: the bracket's once lacked skfem."""
    imported = set[str]()
    for file in (ROOT / "src").rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                imported |= {alias.name.partition(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and not node.level:
                imported.add(str(node.module).partition(".")[0])
    names = [re.split(r"[\[>=<]", line)[0] for line in PROJECT["dependencies"]]
    brought = set[str]().union(*(MODULES.get(name, {name.replace("-", "_")}) for name in names))
    assert not imported - brought - OF_EXTRAS - set(sys.stdlib_module_names) - {"gbeam"}


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


@pytest.mark.parametrize("name", ["requirements.lock", "requirements-dev.lock"])
def test_every_file_that_is_installed_has_its_hash(name: str) -> None:
    lines = (ROOT / name).read_text(encoding="utf-8").replace(" \\\n", " ").splitlines()
    assert len(lines) > 50
    for line in lines:
        assert re.match(r"[A-Za-z0-9._-]+==\S+ .*--hash=sha256:[0-9a-f]{64}\b", line), line[:80]
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    assert f"--require-hashes -r {name}\n" in makefile and makefile.count("--generate-hashes") == 2


def test_actions_are_pinned_by_commit() -> None:
    workflow = (ROOT / ".github" / "workflows" / "ci.yml").read_text(encoding="utf-8")
    used = re.findall(r"uses: (.*)", workflow)
    assert used and all(re.fullmatch(r"[\w-]+/[\w-]+@[0-9a-f]{40}  # v\d+\.\d+\.\d+", each) for each in used)


@pytest.fixture
def audit(monkeypatch: pytest.MonkeyPatch) -> Any:
    """The script behind `make audit`, and what pip-audit would answer: none where there is no network."""
    spec = importlib.util.spec_from_file_location("audit", ROOT / ".ci" / "audit.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    module.known = {}

    def answered(command: list[Any], **_: Any) -> Any:
        lines = Path(command[command.index("--requirement") + 1]).read_text(encoding="utf-8").split()
        if module.known is not None:
            each = [line.split("==") for line in lines]
            facts = [{"name": n, "version": v, "vulns": module.known.get((n, v), [])} for n, v in each]
            Path(command[-1]).write_text(json.dumps({"dependencies": facts}), encoding="utf-8")
        return subprocess.CompletedProcess(command, 1, "", "x\nConnectionError: pypi.org")

    monkeypatch.setattr(module.subprocess, "run", answered)
    return module


def test_the_audit_says_what_is_known_and_that_nothing_is(
    audit: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    lock = tmp_path / "a.lock"
    lock.write_text("a==1 ; python_version < '3.12' \\\n    --hash=sha256:0\na==2\nb==3 \\\n", encoding="utf-8")
    assert audit.rounds(audit.pinned([lock])) == [[("a", "1"), ("b", "3")], [("a", "2")]]
    assert audit.main([str(lock), str(lock)]) == 0
    assert capsys.readouterr().out == "3 versions, no known vulnerabilities\n"
    audit.known = {("a", "2"): [{"id": "PYSEC-1", "fix_versions": ["2.1"]}]}
    assert audit.main([str(lock)]) == 1
    assert capsys.readouterr().out == "a 2: PYSEC-1, mended in 2.1\n3 versions, 1 known vulnerabilities\n"
    audit.known = None
    assert audit.main([str(lock)]) == 2
    assert "no answer, so nothing is known: ConnectionError: pypi.org; is there a network?" in capsys.readouterr().err
