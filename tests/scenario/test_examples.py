"""The examples and the templates load, and build what they say. (That they run is tested elsewhere.)"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from gbeam import InputError, read_scenario
from gbeam.scenario import build, json_schema, load, loads, template

EXAMPLES = Path(__file__).parents[2] / "examples"
FILES = sorted(EXAMPLES.glob("*.toml"))


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_loads(file: Path) -> None:
    assert load(file).title


@pytest.mark.parametrize("name", ["hubbeam2009_slew_3", "hubbeam2009_torque_200", "zhang2020_example1"])
def test_builds(name: str) -> None:
    scenario = load(EXAMPLES / f"{name}.toml")
    built = build(scenario)
    assert list(built.motions) == list(scenario.motion)
    assert built.beam.length == scenario.beam.length
    assert built.model.counts[:3] == (scenario.model.modes.axial, scenario.model.modes.y, scenario.model.modes.z)


def test_tip_mass_variants() -> None:
    built = read_scenario(EXAMPLES / "hubbeam2009_slew_3.toml", ["beam.masses[0].mass=0.5 kg"])
    assert (built.beam.masses[0].at, built.beam.masses[0].mass) == (8.0, 0.5)


def test_flight_and_centrifuge_of_a_record() -> None:
    built = read_scenario(EXAMPLES / "f16_8g_turn.toml")
    assert built.tracks == {"centrifuge": "flight"}
    assert built.response.duration == pytest.approx(15.99)
    # The aircraft's z points down and its record reads -1 g in level flight; the beam's points up.
    assert float(built.motions["flight"].base(0.0).a_WO_B[2]) > 9.0  # type: ignore[union-attr]


@pytest.mark.parametrize("kind", ["flight", "hub", "arm", "system"])
def test_template_builds(kind: str) -> None:
    assert build(loads(template(kind))).title


def test_unknown_template() -> None:
    with pytest.raises(InputError, match="did you mean 'flight'"):
        template("fligth")


def test_schema_describes_every_field() -> None:
    schema = json.loads(json_schema())
    tables = {"Scenario": schema} | schema["$defs"]
    assert "Trapezoid-of-acceleration" in tables
    for name, table in tables.items():
        assert table["additionalProperties"] is False, name
        for key, field in table["properties"].items():
            assert field["description"], f"{name}.{key}"
    references = _references(schema)
    assert references and references <= {f"#/$defs/{name}" for name in schema["$defs"]}
    assert tables["Piece"]["properties"]["length"]["x-unit"] == "m"


def _references(node: Any) -> set[str]:
    if isinstance(node, dict):
        references = {value for key, value in node.items() if key == "$ref"}
        return references.union(*map(_references, node.values()))
    return set().union(*map(_references, node)) if isinstance(node, list) else set()
