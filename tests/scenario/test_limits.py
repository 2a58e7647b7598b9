"""The cost of a scenario is limited before it is read, parsed or allocated; the message says what it would take."""

from __future__ import annotations

import json
import os
import re
import time
import tomllib
from pathlib import Path

import numpy as np
import pytest

import gbeam as gb
from gbeam.guards import NESTING, SCENARIO_BYTES, UnitError, in_bytes, quantity, refuse_large_file
from gbeam.motion import filtered
from gbeam.scenario import ScenarioError, excess, load, loads

from ..scenarios import FAST


def _refused(text: str, *overrides: str) -> str:
    start = time.process_time()
    with pytest.raises(ScenarioError) as caught:
        loads(text, "s.toml", overrides)
    assert time.process_time() - start < 5
    return str(caught.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            FAST + "x = " + "[" * 3000 + "]" * 3000,
            f"s.toml:{len(FAST.splitlines()) + 1}:37: has more than 32 tables or lists in one another",
        ),
        ('{"a":' * 3000, "has more than 32 tables or lists in one another"),
        (".".join(["a"] * 100_000) + " = 1", "s.toml:1:1: has more than 32 tables or lists"),
        ("[" + ".".join(["'a'"] * 100_000) + "]", "s.toml:1:2: has more than 32 tables or lists"),
        ("x = " + "9" * 4400, "s.toml:1:5: has a number of 4400 characters"),
        ("x = 1." + "0_1" * 500, "s.toml:1:5: has a number of 1502 characters"),
        ("x = 0x" + "f" * 4400, "s.toml:1:5: has a number of 4402 characters"),
        ("#" * (SCENARIO_BYTES + 1), "has 1.05 MB, and 1.05 MB are read at most\n.*give long tables as a record"),
        ("\n".join(f"a{i} = 1" for i in range(300)), "^s.toml: has 302 errors, of which 50 are listed"),
    ],
    ids=["brackets", "json", "key", "header", "digits", "underscores", "hexadecimal", "long", "errors"],
)
def test_text(text: str, message: str) -> None:
    assert re.search(message, _refused(text), re.DOTALL)


def test_brackets_in_strings_and_comments_do_not_count() -> None:
    many = "[" * 50
    sound = f'a = "{many}"\nb = \'{many}\'\n# {many}\nc = """{many}\n" {many}""""\nd = \'\'\'{many}\'{many}\'\'\'\n'
    assert excess(sound + "e = " + "[" * NESTING + "]" * NESTING) is None
    assert excess(sound + "e = " + "[" * (NESTING + 1)) is not None
    assert excess('{"a\\"": "' + many + '"}') is None


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("beam.length=" + "9" * 4400, "has a number of 4400 characters"),
        ("title=" + "[" * 3000, "has more than 32 tables"),
        ("beam" + ".a" * 50 + "=1", "has more than 32 tables"),
        ("beam.masses[" + "9" * 5000 + "].mass=1", "is not key=value"),
        ("beam.length=1 " + "m" * 200, "has 202 characters"),
        ("model.modes.y=200", "200 is more than is computed\n.*give 40 or less"),
        ("motion.flight.acceleration.z.level=1e300 g", "1e300 g is too large to compute with"),
        ("motion.flight.acceleration.z.level=1e-300", "too small to compute with"),
        ("title=" + "x" * 201, "has 201 characters"),
        ('title="a\\u0000b"', r"title: holds \\x00, which cannot be printed"),
        ("title=a\x1b[31m", r"title: holds \\x1b"),
        ("motion." + "x" * 65 + ".kind=flight", "has 65 characters\n.*give 64 or fewer"),
        ("response.stations=[" + "0," * 1001 + "]", "at most 1000"),
    ],
)
def test_overrides(override: str, message: str) -> None:
    text = _refused(FAST, override)
    assert re.search(message, text, re.DOTALL) and len(text) < 3000


def test_lone_surrogates_from_json() -> None:
    data = tomllib.loads(FAST) | {"title": "\ud800"}
    assert r"holds \ud800, half a character" in _refused(json.dumps(data))


@pytest.mark.parametrize(
    "text",
    ["3 m^9^9^9", "3 m**9**9", "3 m^(9^9)", "3 m^99", "3 m⁹⁹", "3 m^1e9", "3 m^9.5e9", "3 " + "Gm^9*" * 6 + "Gm"],
)
def test_powers_of_units(text: str) -> None:
    start = time.process_time()
    with pytest.raises(UnitError):
        quantity(text, "length")
    assert time.process_time() - start < 2


@pytest.mark.skipif(os.name != "posix", reason="makes pipes and sparse files")
def test_files_that_are_no_files_are_refused_at_once(tmp_path: Path) -> None:
    pipe, sparse = tmp_path / "pipe.toml", tmp_path / "sparse.toml"
    os.mkfifo(pipe)
    with sparse.open("wb") as file:
        file.truncate(2 * 2**30)
    for path, problem in (
        (Path("/dev/zero"), "is a device or a pipe"),
        (pipe, "is a device or a pipe"),
        (sparse, "has 2.15 GB, and 1.05 MB are read"),
        (tmp_path, "is a folder"),
        (tmp_path / ("a" * 300), "cannot be read .File name too long"),
        (tmp_path / "a\0b", "is no name of a file"),
    ):
        with pytest.raises(ScenarioError, match=problem):
            load(path)
    for path in (Path("/dev/zero"), pipe):
        with pytest.raises(gb.InputError, match="is a device or a pipe"):
            gb.read_record(path, "t", "x", "y", "z", "g")
    with pytest.raises(gb.InputError, match=r"has 2.15 GB, and 537 MB are read at most"):
        gb.read_record(sparse, "t", "x", "y", "z", "g")


def test_a_file_that_another_program_makes_longer(tmp_path: Path) -> None:
    file = tmp_path / "x"
    file.write_bytes(b"12345")
    refuse_large_file("f", file, 5, "")
    with pytest.raises(gb.InputError, match="has 5 B, and 4 B are read at most"):
        refuse_large_file("f", file, 4, "")


def test_samples_and_knots() -> None:
    times = np.linspace(0, 10, 1001)
    with pytest.raises(gb.InputError, match=r"resample makes 1e\+10 samples, which would take 720 GB; give 4e\+05 Hz"):
        filtered(times, np.zeros((1001, 3)), None, 1e9)
    flight = gb.Flight(z=gb.trapezoid(78.5, jerk=39.2, start=1, hold=4))
    with pytest.raises(gb.InputError, match=r"smoothing makes 1.2e\+08 knots, which would take 480 GB; give 0.00024 s"):
        gb.Centrifuge(flight, arm=3.3, control_point=0.1, inverse="flat", gravity=False, smoothing=1e-6, span=(0, 10))
    with pytest.raises(gb.InputError, match="knots over 1e"):
        gb.Centrifuge(flight, arm=3.3, control_point=0.1, inverse="flat", gravity=False, smoothing=0, span=(0, 1e300))


def test_steps() -> None:
    beam = gb.Beam(0.3, gb.Section.rectangle(0.02, 0.004), gb.Material(2700, 70e9), damping_ratio=0.01)
    model = gb.assemble(beam, "FOAM", z=1)
    with pytest.raises(gb.InputError, match=r"response.duration makes 7.\d+e\+07 steps, which would take 25"):
        gb.simulate(model, gb.Flight(z=gb.Sine(10.0, duration=0.03, start=50.0)), duration=1e5)
    with pytest.raises(gb.InputError, match=r"step makes 1e\+08 steps, .* give 2.5e-06 s or more"):
        gb.simulate(model, gb.Flight(z=10.0), duration=10.0, step=1e-7)


def test_stations_of_a_section() -> None:
    at = np.linspace(0, 0.3, 1000)
    beam = gb.Beam(0.3, gb.Section.rectangle(0.02, np.full(1000, 0.004), stations=at), gb.Material(2700, 70e9))
    with pytest.raises(gb.InputError, match=r"section.stations makes 2.398e\+04 nodes of integration, .* 13.8 GB"):
        gb.assemble(beam, "FOAM", z=3)


def test_sizes_in_words() -> None:
    assert [in_bytes(n) for n in (5, 24e9, 1e15)] == ["5 B", "24 GB", "1e+03 TB"]
