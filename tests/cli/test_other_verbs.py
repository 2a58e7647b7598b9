"""gbeam check, new and schema; and that help is fast and light."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from gbeam.cli import function, verbs

from ..calling import spent

Call = Callable[..., Any]
EXAMPLES = Path(__file__).parents[2] / "examples"


def test_check(fast: Path, gbeam: Call) -> None:
    facts = gbeam("check", fast, "--json").json
    assert (beam := facts["bodies"]["beam"])["mass"] == facts["mass"] == pytest.approx(2700 * 0.3 * 0.02 * 0.004)
    # β₁² √(EI/ρA) / 2π L² of a cantilever
    assert beam["modes"][0] == {"frequency": pytest.approx(36.56, rel=1e-3), "direction": "z"}
    assert facts["motions"] == {"flight": {"kind": "flight"}, "spin": {"kind": "centrifuge", "tracks": "flight"}}
    assert facts["response"]["duration"] == 0.5
    text = gbeam("check", fast).out
    assert "0.0648 kg" in text and "36.56 (z)" in text and "spin: centrifuge that tracks flight" in text
    assert not Path("out").exists()


def test_check_writes_what_it_prints(hub: Path, gbeam: Call) -> None:
    answer = gbeam("check", hub, "--json", "--out", "there")
    assert json.loads(Path("there/check.json").read_text(encoding="utf-8")) == answer.json
    assert "check.json is of a kind that has no report" in gbeam("report", "there/check.json").err


@pytest.mark.parametrize("kind", ["flight", "hub", "arm"])
def test_new_writes_a_sound_scenario_once(kind: str, tmp_path: Path, gbeam: Call) -> None:
    file = tmp_path / "mine.toml"
    assert gbeam("new", file, "--kind", kind).status == 0
    assert gbeam("check", file).status == 0
    written = file.read_text()
    again = gbeam("new", file)
    assert again.status == 2 and "exists" in again.err
    assert file.read_text() == written


def test_new_needs_a_place(tmp_path: Path, gbeam: Call) -> None:
    assert "cannot be written" in gbeam("new", tmp_path / "no" / "x.toml").err
    answer = gbeam("new", tmp_path / "x.json")
    assert answer.status == 2 and "x.toml" in answer.err


def test_schema(gbeam: Call) -> None:
    assert "beam" in gbeam("schema").json["properties"]


def test_presets_are_listed_and_read(gbeam: Call) -> None:
    listed = gbeam("presets")
    assert "mil-std-810h-513-structural" in listed.out and "IEC 60068-2-7" in listed.out
    text = gbeam("presets", "mil-std-810h-513-structural").out
    assert 'dwell = "60 s"' in text and "table 513.8-I" in text
    assert gbeam("presets", "aectp-400-404", "--json").json["asked"].keys() == {"level", "dwell", "directions"}
    assert gbeam("presets", "mil-std").status == 2


def test_version(gbeam: Call) -> None:
    assert gbeam("--version").out.strip()


@pytest.mark.parametrize("verb", verbs())
def test_every_verb_has_help(verb: str, gbeam: Call) -> None:
    answer = gbeam(verb, "--help")
    assert answer.status == 0
    docstring = function(verb).__doc__ or ""
    assert " ".join(docstring.partition("Parameters\n")[0].split()) in " ".join(answer.out.split())


def imported(heavy: tuple[str, ...], *calls: tuple[object, ...]) -> tuple[list[str], list[str]]:
    """Modules, of some, that calls of the command line import in a process of their own; and what each call prints."""
    code = (
        "import json, sys; from gbeam.cli import main;"
        "status = max((main(call), print('\\0', end=''))[0] for call in json.loads(sys.argv[1]));"
        f"print(*[name for name in {heavy} if name in sys.modules], file=sys.stderr); sys.exit(status)"
    )
    command = [sys.executable, "-c", code, json.dumps([[str(word) for word in call] for call in calls])]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    lines = [line for line in done.stderr.splitlines() if not line.startswith("gbeam: ")]  # progress, on a busy machine
    return " ".join(lines).split(), done.stdout.split("\0")[:-1]


def test_help_is_light() -> None:
    seconds = []  # of processor time: the wall's belong to whatever else runs
    for _ in range(3):
        start = spent()
        heavy, (out,) = imported(("jax", "numpy", "xarray", "matplotlib", "pint", "pydantic", "scipy"), ("--help",))
        seconds.append(spent() - start)
    assert heavy == []
    assert all(verb in out for verb in verbs())
    assert min(seconds) < 0.5


NOT_FOR_READING = (
    "jax", "xarray", "matplotlib", "pandas", "pint", "rich", "tomlkit",
)  # fmt: skip


def test_reading_and_describing_is_light() -> None:
    files = [EXAMPLES / f"{name}.toml" for name in ("f16_8g_turn", "hubbeam2009_slew_3")]
    heavy, outputs = imported((*NOT_FOR_READING, "gbeam.results.response"), *(("check", file) for file in files))
    assert heavy == [] and all(out.endswith("Scenario valid.\n") for out in outputs)
    # Without a machine whose axes are planned, all of SciPy besides.
    assert imported(("scipy",), ("check", files[1]), ("modes", files[1], "--json"))[0] == []


def test_questions_about_a_linear_model_need_no_jax() -> None:
    steady = ("static", "modes", "campbell", "critical-speed", "linearize")
    hub = [(verb, EXAMPLES / "hubbeam2009_slew_3.toml", "--json") for verb in steady]
    flight = ("static", EXAMPLES / "f16_8g_turn.toml", "--json")
    heavy, outputs = imported(NOT_FOR_READING, *hub, flight)
    assert heavy == [] and [json.loads(out)["outcome"] for out in outputs] == 6 * ["done"]


@pytest.mark.skipif(shutil.which("bash") is None, reason="no bash")
def test_a_shell_completes_verbs_options_and_choices(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, gbeam: Call
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    assert gbeam("--install-completion", "--shell", "bash").status == 0
    (script,) = tmp_path.rglob("completions/gbeam")
    assert str(script) in (tmp_path / ".bashrc").read_text(encoding="utf-8")
    lines = [f". '{script}'", "called=$(complete -p gbeam | sed 's/.*-F \\([^ ]*\\).*/\\1/')"]
    for words in (("gbeam", "cri"), ("gbeam", "modes", "--mot"), ("gbeam", "optimize", "--verb", "")):
        quoted = " ".join(f"'{each}'" for each in words)
        lines.append(f"COMPREPLY=(); COMP_WORDS=({quoted}); COMP_CWORD={len(words) - 1}")
        lines.append(f"$called gbeam '{words[-1]}' '{words[-2]}'; echo ${{COMPREPLY[@]}}")
    answer = subprocess.run(["bash", "-c", "\n".join(lines)], capture_output=True, text=True, check=True)
    assert answer.stdout.splitlines() == ["critical-speed", "--motion", "run static modes critical-speed plan"]


def test_a_place_needs_a_motion(gbeam: Call) -> None:
    answer = gbeam("place", EXAMPLES / "robot_arm.toml")
    assert answer.status == 2 and 'motion is missing; add [motion.NAME] with kind = "centrifuge"' in answer.err


@pytest.mark.parametrize(("verb", "tree"), [("static", "beam_on_a_station"), ("linearize", "top")])
def test_what_is_zero_is_printed_as_zero(gbeam: Call, verb: str, tree: str) -> None:
    """A beam whose load begins at nothing, and one that hangs straight: they had 2e-16 mm, 1e-57 rad and 2e-20 %."""
    answer = gbeam(verb, EXAMPLES.parent / "fuzz" / "trees" / f"{tree}.toml")
    assert answer.status == 0 and not re.findall(r"\S*e-(?:1[4-9]|[2-9]\d)\b", answer.out)


def test_a_joint_that_turns_has_a_diagram(tmp_path: Path, gbeam: Call, with_figures: None) -> None:
    """The base of the arm is named; the elbow, whose axis leans with it, changes the equations."""
    few = 'bodies.strip.model={ kind = "FOAM", modes = { axial = 0, y = 1, z = 1 } }'
    arm = EXAMPLES / "robot_arm.toml", "--set", few
    asked = gbeam("campbell", *arm, "--to", "30 rpm")
    assert asked.status == 2 and "--turning is missing; say which angle turns: base.angle, elbow.angle" in asked.err
    answer = gbeam("campbell", *arm, "--turning", "base.angle", "--to", "30 rpm", "--out", tmp_path)
    assert answer.status == 0 and "strip z" in answer.out and (tmp_path / "campbell.svg").exists()
    assert gbeam("critical-speed", *arm, "--turning", "base.angle", "--to", "10 rad/s").status == 0
    refused = gbeam("campbell", *arm, "--turning", "elbow.angle", "--to", "30 rpm")
    assert refused.status == 2 and "joints.elbow: turns a system whose equations change" in refused.err
