"""Odd input from outside is an answer or one message: no traceback, no silence, no wait without end."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from gbeam.progress import INTERVAL

from ..calling import Answer, gbeam
from ..scenarios import FAST, SPECIMEN, model, response

__all__ = ["gbeam"]

POSIX = pytest.mark.skipif(os.name != "posix", reason="names of files are bytes on POSIX alone")
LINUX = pytest.mark.skipif(sys.platform != "linux", reason="other systems limit no address space")
Call = Callable[..., Answer]
TURN = """\
[motion.turn]
kind = "hub"
radius = "0.5 m"
rate = { profile = "smooth-step", level = "60 rpm", duration = "2 s" }
"""
STEADY = SPECIMEN + model("FOAM", 0, 1, 1) + TURN + response("0.4 s")


@pytest.fixture
def fast(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A flight and a centrifuge, in the current folder."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "fast.toml").write_text(FAST, encoding="utf-8")
    (tmp_path / "steady.toml").write_text(STEADY, encoding="utf-8")
    return tmp_path / "fast.toml"


def _called(folder: Path, *arguments: object, limit: int = 0, **environment: str) -> subprocess.CompletedProcess[bytes]:
    """The command line in a process of its own, in a folder, with a limit of address space, bytes."""

    def limited() -> None:
        if limit:
            import resource

            resource.setrlimit(resource.RLIMIT_AS, (limit, limit))

    command: list[Any] = [sys.executable, "-m", "gbeam", *arguments]
    return subprocess.run(
        command,
        cwd=folder,
        env=os.environ | {"OPENBLAS_NUM_THREADS": "1", **environment},
        capture_output=True,
        check=False,
        timeout=120,
        preexec_fn=limited if limit else None,
    )


@pytest.mark.parametrize("verb", ["plan", "check", "run"])
def test_a_smoothing_far_longer_than_the_flight_is_refused(verb: str, fast: Path, gbeam: Call) -> None:
    answer = gbeam(verb, fast, "--set", "motion.spin.smoothing=1e10 s")
    assert answer.status == 2 and "nothing of a flight of 0.5 s is left" in answer.err
    assert "motion.spin.smoothing" in answer.err and "give less than 5 s" in answer.err


@pytest.mark.parametrize(
    ("key", "value", "where"),
    [
        ("offset", '["1e30 m", "0 m", "0 m"]', "beam.masses[0].offset"),
        ("mass", '"1e40 kg"', "beam.masses[0].mass"),
        ("inertia", '{ x = "1e40 kg m^2", y = "1e40 kg m^2", z = "1e40 kg m^2" }', "beam.masses[0].inertia"),
    ],
)
def test_a_body_that_numbers_do_not_hold_beside_the_beam_is_refused(
    key: str, value: str, where: str, fast: Path, gbeam: Call
) -> None:
    body = {"at": '"300 mm"', "mass": '"0.1 kg"', key: value}
    masses = "masses = [{ " + ", ".join(f"{name} = {each}" for name, each in body.items()) + " }]\n[model]"
    fast.write_text(STEADY.replace("[model]", masses), encoding="utf-8")
    for verb in ("check", "modes", "static"):
        answer = gbeam(verb, fast, "--json")
        assert answer.status == 2
        (error,) = answer.json["error"]
        assert error["path"] == where and "times the beam's" in error["message"] and error["line"]


@pytest.mark.parametrize("stiffness", ["1e-30 N m/rad", "1e40 N m/rad"])
def test_a_spring_that_numbers_do_not_hold_beside_the_beam_is_refused(stiffness: str, fast: Path, gbeam: Call) -> None:
    fast.write_text(STEADY.replace("[model]", f'root = {{ rotation_y = "{stiffness}" }}\n[model]'), encoding="utf-8")
    answer = gbeam("modes", fast)
    assert answer.status == 2 and "beam.root.rotation_y: is " in answer.err


@POSIX
def test_a_folder_whose_name_is_no_text_has_what_a_plan_writes(fast: Path) -> None:
    answer = _called(fast.parent, "plan", "fast.toml", "--out", b"a\xffb")
    assert answer.returncode == 0 and b"Traceback" not in answer.stderr, answer.stderr
    commands = Path(os.fsdecode(os.fsencode(fast.parent) + b"/a\xffb")) / "commands_spin.csv"
    assert "a\\udcffb" in commands.read_text(encoding="utf-8")


@pytest.mark.parametrize("columns", ["1", "0", "-1", "100000000000000"])
def test_help_ends_on_any_terminal(columns: str, tmp_path: Path) -> None:
    answer = _called(tmp_path, "sweep", "--help", COLUMNS=columns)
    assert answer.returncode == 0 and b"Usage: gbeam sweep" in answer.stdout


@pytest.mark.parametrize("depth", [900, 100_000])
def test_json_that_is_nested_deeply_is_no_result(depth: int, fast: Path, gbeam: Call) -> None:
    assert gbeam("modes", "steady.toml", "--out", "m").status == 0
    facts = json.loads(Path("m/modes.json").read_text(encoding="utf-8"))
    for key in (*facts, "provenance.scenario", "provenance.command", "provenance.dependencies"):
        changed, inside = json.loads(json.dumps(facts)), key.split(".")
        place = changed if len(inside) == 1 else changed[inside[0]]
        place[inside[-1]] = "@"
        for opened, closed in ("[]", ('{"a":', "}")):
            deep = opened * depth + ("1" if opened != "[" else "") + closed * depth
            Path("x.json").write_text(json.dumps(changed).replace('"@"', deep), encoding="utf-8")
            for verb in ("report", "rerun"):
                answer = gbeam(verb, "x.json")
                assert answer.status == 2 and "x.json" in answer.err, (key, verb)


def test_a_title_that_is_nested_deeply_is_none(fast: Path, gbeam: Call) -> None:
    assert gbeam("modes", "steady.toml", "--out", "m").status == 0
    facts = json.loads(Path("m/modes.json").read_text(encoding="utf-8"))
    for text in ("a = " + "[" * 5000, "[" * 5000, '{"title": ' * 900 + "1" + "}" * 900):
        facts["provenance"]["scenario"] = text
        Path("x.json").write_text(json.dumps(facts), encoding="utf-8")
        assert gbeam("report", "x.json").status == 0


@pytest.mark.parametrize("text", ['{"title": "\\ud800"}', '{"a\\udfff": 1}', 'title = "\\ud800"'])
def test_half_a_character_in_a_scenario_is_refused(text: str, fast: Path, gbeam: Call) -> None:
    fast.write_text(text, encoding="utf-8")
    answer = gbeam("check", "fast.toml")
    assert answer.status == 2 and answer.err.startswith("fast.toml:1:")


@POSIX
def test_bytes_that_are_no_text_are_refused_or_written_out(fast: Path) -> None:
    answer = _called(fast.parent, "check", "fast.toml", "--set", b"title=a\xff")
    assert answer.returncode == 2 and b"\\udcff" in answer.stderr
    os.rename(fast, os.fsencode(fast.parent) + b"/n\xff.toml")
    answer = _called(fast.parent, "modes", b"n\xff.toml", "--motion", "flight", "--out", "m")
    assert answer.returncode == 0, answer.stderr
    command = json.loads((fast.parent / "m" / "modes.json").read_text(encoding="utf-8"))["provenance"]["command"]
    assert "n\\udcff.toml" in command


@LINUX
# With less, libraries crash as they are loaded.
@pytest.mark.parametrize("megabytes", [250, pytest.param(300, marks=pytest.mark.thorough), 400])
def test_too_little_memory_is_no_defect(megabytes: int, fast: Path) -> None:
    ends = []
    sweep = (
        "sweep",
        "steady.toml",
        "--verb",
        "static",
        "--measure",
        "tip.z",
        "--over",
        "beam.length=0.2 m:0.3 m:2",
        "--out",
        "s",
    )
    for words in (("check", "steady.toml"), ("modes", "steady.toml"), sweep):
        answer = _called(fast.parent, *words, limit=megabytes * 10**6)
        if answer.returncode == -signal.SIGSEGV:  # of a library, which did not look whether it got its memory
            answer = _called(fast.parent, *words, limit=megabytes * 10**6)
        ends.append(answer.returncode)
        assert answer.returncode in (0, 1), answer.stderr
        # OpenBLAS ends the process by itself where it gets no memory, and says so.
        ends_so = b"gbeam: out of memory: ", b"OpenBLAS error: Memory allocation"
        assert answer.returncode == 0 or answer.stderr.splitlines()[-1].startswith(ends_so)
    assert megabytes > 200 or 1 in ends


@pytest.mark.parametrize(
    "words", ["can't start new thread", "libhdf5.so.320: failed to map segment from shared object"]
)
def test_what_libraries_say_of_too_little_memory_is_understood(words: str) -> None:
    from gbeam.cli import lacks_memory

    kind = RuntimeError if "thread" in words else ImportError
    assert (
        lacks_memory(kind(words)) and not lacks_memory(kind("no module named x")) and not lacks_memory(OSError(words))
    )
    wrapped = ValueError("zarr is not installed")
    wrapped.__cause__ = kind(words)
    assert lacks_memory(wrapped)


def test_a_scheduler_that_is_not_there_is_one_line(fast: Path) -> None:
    pytest.importorskip("distributed")
    code = "import sys, gbeam.studies.workers as c; c.CONNECTION = 1.0; from gbeam.cli import main; "
    code += "sys.exit(main(sys.argv[1:]))"
    sweep = [
        "sweep",
        "steady.toml",
        "--verb",
        "static",
        "--measure",
        "tip.z",
        "--over",
        "beam.length=0.2 m:0.3 m:40",
        "--out",
        "s",
    ]
    command = [sys.executable, "-c", code, *sweep, "--scheduler", "tcp://127.0.0.1:9"]
    unhurried = os.environ | {INTERVAL: "100000"}  # of progress, which a busy machine shows
    answer = subprocess.run(
        command, cwd=fast.parent, capture_output=True, text=True, check=False, timeout=60, env=unhurried
    )
    assert answer.returncode == 2
    said = [line for line in answer.stderr.splitlines() if "%" not in line]
    assert len(said) == 1 and "--scheduler tcp://127.0.0.1:9 does not answer" in said[0], answer.stderr


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("\n".join(f"k{i} = 1" for i in range(60_000)), "has 60000 keys, and nothing has more than 1000"),
        ("\n".join(f"[k{i}]" for i in range(60_000)), "has 60000 keys"),
        (json.dumps({f"k{i}": 1 for i in range(60_000)}), "has 60000 keys"),
        (SPECIMEN + "masses = [" + "{}, " * 60_000 + "]", "beam.masses: has 60000 tables or lists"),
    ],
    ids=["keys", "tables", "json", "list"],
)
def test_more_keys_than_anything_has_are_one_message(text: str, problem: str, fast: Path, gbeam: Call) -> None:
    fast.write_text(text, encoding="utf-8")
    begun = time.process_time()
    answer = gbeam("check", "fast.toml")
    assert time.process_time() - begun < 3.0
    assert answer.status == 2 and problem in answer.err
    assert sum("gbeam: reading" not in line for line in answer.err.splitlines()) == 2  # which a slow machine shows


@pytest.mark.parametrize("at", ["1e-6 mm", "1e-4 mm"])
def test_a_body_beside_a_spring_has_frequencies(at: str, fast: Path, gbeam: Call) -> None:
    inertia = '{ x = "1e-4 kg m^2", y = "1e-4 kg m^2", z = "1e-4 kg m^2" }'
    body = f'masses = [{{ at = "{at}", mass = "0.1 kg", inertia = {inertia}, offset = ["1 mm", "2 mm", "3 mm"] }}]\n'
    springs = 'root = { translation_y = "1e6 N/m", rotation_y = "5e3 N m/rad", rotation_z = "5e3 N m/rad" }\n[model]'
    fast.write_text(STEADY.replace("[model]", body + springs), encoding="utf-8")
    answer = gbeam("modes", fast, "--json")
    assert answer.status == 0, answer.err


def test_more_words_than_any_command_has_are_one_message(gbeam: Call) -> None:
    begun = time.process_time()
    answer = gbeam("check", *["x"] * 60_000)
    assert time.process_time() - begun < 1.0
    assert answer.status == 2 and "has 60001 words, and 2000 are read at most" in answer.err


def test_a_critical_speed_says_what_takes_long(fast: Path, gbeam: Call, monkeypatch: pytest.MonkeyPatch) -> None:
    tlam = ("steady.toml", "--set", 'model.kind="TLAM"')
    monkeypatch.setattr("gbeam.progress._interval", lambda: 1e-3)  # shorter than any step, which none then misses
    answer = gbeam("critical-speed", *tlam)
    assert answer.status == 0, answer.err
    shares = [
        line for line in answer.err.splitlines() if "errors of the critical value, by exact with more shapes" in line
    ]
    assert shares and shares[-1].split("%")[0][-2:].strip().isdigit()
    answer = gbeam("critical-speed", *tlam, "--masses", "0.1 kg, 0.2 kg", "--positions", "0.1 m, 0.2 m")
    assert answer.status == 0 and "gbeam: critical hub rates: 50%" in answer.err
