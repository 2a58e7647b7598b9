"""Files, syntax, several errors at once, records, JSON."""

from __future__ import annotations

import json
import pickle
import subprocess
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest
from pydantic import ValidationError

from gbeam import ComputationError, InputError
from gbeam.errors import naming, placing_within
from gbeam.scenario import Diagnostic, Scenario, ScenarioError, build, load, loads, placed

Errors = Callable[..., tuple[Diagnostic, ...]]
INLINE = 'acceleration = { z = { profile = "constant", level = "6 g" } }'
RECORD = 'record = { file = "f.csv", time = "t", x = "0", y = "-y", z = "z", unit = "g" }'


def test_values_are_si(text: str) -> None:
    scenario = loads(text)
    assert scenario.beam.length == 0.3
    assert scenario.beam.section.model_dump() == {
        "shape": "rectangle", "width": 0.02, "thickness": 0.004, "stations": (), "plate": False,
    }  # fmt: skip
    assert scenario.motion["slew"].model_dump()["rate"]["level"] == pytest.approx(6.283185307179586)
    assert scenario.response.step == "auto"
    assert scenario.response.parameters == {}


def test_is_frozen(text: str) -> None:
    with pytest.raises(ValidationError, match="frozen"):
        loads(text).beam.length = 1.0  # type: ignore[misc]


def test_is_sent_to_other_processes(text: str) -> None:
    force = 'loads = [ { at = 0.1, force = { z = { profile = "sine", amplitude = 1, duration = 1 } } } ]'
    scenario = loads(text.replace("damping_ratio = 0.01", f"damping_ratio = 0.01\n{force}"))
    assert pickle.loads(pickle.dumps(scenario)) == scenario


def test_all_errors_at_once_in_order(text: str, errors: Errors) -> None:
    wrong = text.replace('"300 mm"', '"300 kg"').replace("axial = 1", "axal = 1").replace('"4 s"', "-4")
    diagnostics = errors(wrong.replace('"3.3 m"', '"3.3"'))
    assert [(error.line, error.path) for error in diagnostics] == [
        (3, "beam.length"),
        (10, "model.modes.axal"),
        (17, "motion.spin.arm"),
        (26, "response.duration"),
    ]


def test_printed_like_a_compiler(text: str, errors: Errors) -> None:
    (error,) = errors(text.replace('at = "200 mm"', 'at = "400 mm"'), building=True)
    assert str(error) == (
        "s.toml:7:19: beam.masses[0].at: is 0.4 m, beyond the tip\n"
        '    7 | masses = [ { at = "400 mm", mass = "0.1 kg" } ]\n'
        "      |                   ^^^^^^^^\n"
        "      = give 0 to 0.3 m from the root"
    )
    assert json.loads(json.dumps(ScenarioError([error]).as_json()))[0]["column"] == 19


def test_a_wrong_scenario_is_a_wrong_input_that_keeps_its_places(text: str) -> None:
    """Caught as any other wrong input; whoever names another place for what is raised inside leaves the file's."""
    wrong = text.replace('"300 mm"', '"300 kg"').replace('"4 s"', "-4")
    refused = pytest.raises(InputError, match=r"s.toml:\d+:\d+: beam.length: ")
    with refused as caught, naming("--over"), placing_within("motion"):
        loads(wrong, "s.toml")
    error = caught.value
    assert isinstance(error, ScenarioError) and error.where == "beam.length"
    assert [each.path for each in error.diagnostics] == ["beam.length", "response.duration"]
    again = pickle.loads(pickle.dumps(error))
    assert (str(again), again.diagnostics) == (str(error), error.diagnostics)
    other = pickle.loads(pickle.dumps(InputError("beam.length", "is 0 m", "give more")))
    assert str(other) == "beam.length is 0 m; give more" and other.fix == "give more"
    failed = pickle.loads(pickle.dumps(ComputationError("diverged", "at 1 s")))
    assert (failed.outcome, str(failed)) == ("diverged", "at 1 s")
    assert str(placed(loads(text, "s.toml"), [error])) == str(error)


def test_tabs_and_wide_characters_before_the_caret(text: str, errors: Errors) -> None:
    (error,) = errors(text.replace('title = "test"', 'title = "é"\t# ∫').replace('arm = "3.3 m"', '\tarm = "3.3 ü"'))
    excerpt, carets = str(error).split("\n")[1:3]
    assert excerpt.endswith('| \tarm = "3.3 ü"')
    assert carets.endswith("| \t      ^^^^^^^")


@pytest.mark.parametrize(
    ("text", "line", "column", "message"),
    [
        ('title = "a"\nbeam = \n', 2, 8, "invalid value"),
        ('title = "a"\nx', 2, 2, "expected '=' after a key in a key/value pair"),
        ("a = 1\na = 2\n", 2, 6, "cannot overwrite a value"),
        ('{"a": 1,\n  2}', 2, 3, "expecting property name enclosed in double quotes"),
    ],
)
def test_syntax(text: str, line: int, column: int, message: str, errors: Errors) -> None:
    (error,) = errors(text)
    assert (error.line, error.message) == (line, message)
    assert abs((error.column or 0) - column) <= 1  # Python's versions differ by one
    assert error.hint == f"this is not valid {'JSON' if text[0] == '{' else 'TOML'}"
    assert str(error).split("\n")[2].endswith("^")


def test_empty_text_misses_every_table(errors: Errors) -> None:
    assert [str(error).split("\n")[0] for error in errors("")] == [
        f"s.toml:1:1: {name} is missing" for name in ("beam", "model")
    ]


def test_unknown_table(text: str, errors: Errors) -> None:
    (error,) = errors(text.replace("[response]", "[respons]"))
    assert (error.path, error.hint, error.line) == ("respons", "did you mean 'response'?", 25)


def test_motion_without_a_name(text: str, errors: Errors) -> None:
    diagnostics = errors(text.replace("[motion.slew]", "[motion]"))
    assert [error.path for error in diagnostics] == ["motion.kind", "motion.radius", "motion.rate"]
    assert all("[motion.NAME]" in error.hint for error in diagnostics[:2])
    assert diagnostics[2].message == "kind is missing"


def test_files(tmp_path: Path, text: str) -> None:
    file = tmp_path / "turn.toml"
    file.write_text(text.replace("\n", "\r\n"), newline="")
    assert load(file).title == "test"
    file.write_bytes(b"\xef\xbb\xbf" + text.replace('"3.3 m"', '"3.3 kg"').encode())
    with pytest.raises(ScenarioError, match=f"{file}:17:7: motion.spin.arm"):
        load(str(file))
    with pytest.raises(ScenarioError, match=r"' ': there is no such file"):
        load(" ")
    with pytest.raises(ScenarioError, match=r"trun.toml: there is no such file\n.*did you mean '.*turn.toml'"):
        load(tmp_path / "trun.toml")
    with pytest.raises(ScenarioError, match="gbeam new"):
        load(tmp_path / "other" / "x")
    with pytest.raises(ScenarioError, match="is a folder"):
        load(tmp_path)
    file.write_bytes(b"\x89PNG\r\n\x1a\n\x00")
    with pytest.raises(ScenarioError, match=r"is not UTF-8 text\n.*save it as UTF-8, or give the path of a scenario"):
        load(file)


@pytest.mark.parametrize("mark", [b"", b"\xef\xbb\xbf"])
def test_a_scenario_in_latin_1_is_told_its_first_byte(tmp_path: Path, mark: bytes) -> None:
    file = tmp_path / "wing.toml"
    file.write_bytes(mark + "# a — b\r\n".encode() + 'title = "Flügel, heiß"\r\n[beam]\n'.encode("latin-1"))
    with pytest.raises(ScenarioError) as refused:
        load(file)
    assert str(refused.value) == "\n".join(
        [
            f"{file}:2:12: the byte 0xfc, 'ü' in Latin-1, is not UTF-8",
            '    2 | title = "Flügel, heiß"',
            "      |            ^",
            "      = save it as UTF-8",
        ]
    )


def test_json_is_taken_and_located(text: str, errors: Errors) -> None:
    as_json = json.dumps(tomllib.loads(text), indent=1)
    assert loads(as_json).model_dump() == loads(text).model_dump()
    (error,) = errors(as_json.replace('"200 mm"', '"400 mm"'), building=True)
    assert error.source_line is not None and error.column is not None and error.end is not None
    assert error.source_line[error.column - 1 : error.end - 1] == '"400 mm"'
    (error,) = errors(as_json.replace('"mass": "0.1 kg"', '"mass": null'))
    assert error.message == "null is not a number"


class TestRecord:
    def write(self, folder: Path, header: str = "t,y,z", unit: float = 1.0) -> None:
        rows = "\n".join(f"{0.01 * i + 1:.2f},0,{unit * i}" for i in range(6))
        (folder / "f.csv").write_text(f"{header}\n{rows}\n")

    def test_file_beside_the_scenario_gives_the_duration(self, tmp_path: Path, text: str) -> None:
        self.write(tmp_path)
        only = text[: text.index("[motion.spin]")].replace(INLINE, RECORD)
        (tmp_path / "s.toml").write_text(only)
        built = build(load(tmp_path / "s.toml"))
        assert built.response.start == 1.0
        assert built.response.duration == pytest.approx(0.05)
        with pytest.raises(
            ScenarioError, match=r"--set response.residual_from=3 s: .*\n.*give a time from 1 s on, before 1.05 s"
        ):
            build(load(tmp_path / "s.toml", ["response.residual_from=3 s"]))

    def test_missing_file(self, tmp_path: Path, text: str, errors: Errors) -> None:
        recorded = text.replace(INLINE, RECORD)
        (error,) = errors(recorded)
        assert (error.path, error.message) == ("motion.flight.record.file", "there is no file 'f.csv'")
        self.write(tmp_path)
        (error,) = errors(recorded.replace("f.csv", "ff.csv"))
        assert error.hint == "did you mean 'f.csv'?"
        (error,) = errors(recorded.replace('"g"', '"m/s3"'))
        assert (error.path, error.hint) == ("motion.flight.record.unit", "did you mean 'm/s^2'?")
        (error,) = errors(recorded.replace("[motion.spin]", INLINE + "\n[motion.spin]"))
        assert (error.path, error.message) == ("motion.flight.acceleration", "is given beside record")

    def test_column(self, tmp_path: Path, text: str, errors: Errors) -> None:
        self.write(tmp_path, header="t,yy,z")
        (error,) = errors(text.replace(INLINE, RECORD), building=True)
        assert (error.path, error.line, error.column) == ("motion.flight.record.y", 13, 53)
        assert "did you mean 'yy'?" in error.hint


def test_errors_of_the_core_are_all_told(text: str, errors: Errors) -> None:
    wrong = text.replace('"0.1 kg" }', '"0 kg", inertia = { x = 1, y = 1, z = 1 } }').replace(
        'profile = "constant", level = "6 g"',
        'profile = "trapezoid", level = 0, jerk = 1, start = 0, hold = 0',
    )
    assert [error.path for error in errors(wrong, building=True)] == [
        "beam.masses[0].mass",
        "motion.flight.acceleration.z.level",
    ]


def test_placed_without_a_text(text: str) -> None:
    scenario = Scenario.model_validate(tomllib.loads(text))
    error = InputError("beam.length", "is too long", "shorten it")
    assert str(placed(scenario, [error])) == "scenario: beam.length: is too long\n    = shorten it"
    assert str(placed(loads(text, "s.toml"), [error])).startswith("s.toml:3:10: beam.length: is too long")


def test_loading_imports_nothing_heavy() -> None:
    code = (
        "import sys, gbeam.scenario as s; s.json_schema(); s.template('hub'); "
        "heavy = ('jax', 'xarray', 'matplotlib', 'pint', 'tomlkit'); "
        "print([module for module in heavy if module in sys.modules])"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert out.strip() == "[]"
