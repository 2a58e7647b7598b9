"""Output at named points: stations, bodies and the tip by their names."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gbeam as gb
from gbeam.scenario import ScenarioError

STRIP, ALUMINIUM = gb.Section.rectangle(0.02, 0.004), gb.Material(2700.0, 70e9)
SENSOR = gb.PointMass(0.2, 0.01, name="sensor")
BEAM = gb.Beam(0.3, STRIP, ALUMINIUM, [SENSOR], damping_ratio=0.01, points=[gb.Point("camera", 0.12)])
FLIGHT = gb.Flight(z=gb.trapezoid(30.0, jerk=300.0, start=0.02, hold=0.1))
RUN: dict[str, Any] = {"duration": 0.2, "step": 1e-3, "estimate": False}


@pytest.fixture(scope="module")
def response() -> gb.Response:
    return gb.simulate(gb.assemble(BEAM, "FOAM", z=2), FLIGHT, **RUN)


def test_points_are_stations_with_names(response: gb.Response) -> None:
    plain = replace(BEAM, points=[], masses=[replace(SENSOR, name="")])
    same = gb.simulate(gb.assemble(plain, "FOAM", z=2, stations=[0.12, 0.2]), FLIGHT, **RUN)
    assert response.points == ("beam.camera", "beam.sensor", "beam.tip", "beam.root")
    body = response.body
    assert body.points == ("camera", "sensor", "tip") and same.body.points == ("120 mm", "200 mm", "tip")
    np.testing.assert_array_equal(response.displacement, same.displacement)
    for k, name in enumerate(body.points):
        np.testing.assert_array_equal(body.at(name), same.displacement[:, k])
        place = response.at(f"beam.{name}") - [body.stations[k], 0.0, 0.0]
        np.testing.assert_allclose(place, body.at(name), atol=1e-12 * BEAM.length)
    np.testing.assert_array_equal(body.at("tip"), response.tip)
    with pytest.raises(gb.InputError, match="choose from camera, sensor, tip"):
        body.at("lens")
    with pytest.raises(gb.InputError, match=r"point is 'tip'"):  # a place is not taken for a deflection
        response.at("tip")


def test_figures_of_points_have_their_names(response: gb.Response) -> None:
    from gbeam.results import facts_of

    known = facts_of(response)["bodies"]["beam"]
    assert [row["name"] for row in known["stations"]] == ["camera", "sensor", "tip"]
    assert list(known["points"]) == ["camera", "sensor"]  # the tip has its place
    largest = np.abs(response.body.at("camera")[:, 2]).max()
    assert known["points"]["camera"]["z"]["max_abs"] == pytest.approx(largest, rel=1e-3)
    assert list(response.to_xarray()["beam_station_name"].values) == ["camera", "sensor", "tip"]


def test_names_that_cannot_be_are_refused() -> None:
    for name in ("tip", "my point", "hub", ""):
        with pytest.raises(gb.InputError, match="name is"):
            gb.Point(name, 0.1)
    with pytest.raises(gb.InputError, match="name is 'root_force'"):
        gb.PointMass(0.1, 0.01, name="root_force")
    with pytest.raises(gb.InputError, match=r"masses\[0\]\.name is 'sensor' a second time"):
        replace(BEAM, points=[gb.Point("sensor", 0.1)])
    with pytest.raises(gb.InputError, match=r"points\[0\]\.at is 0\.4 m, beyond the tip"):
        replace(BEAM, points=[gb.Point("far", 0.4)])
    with pytest.raises(gb.InputError, match=r"at is -0\.1 m"):
        gb.Point("behind", -0.1)


SCENARIO = """
[beam]
length = "300 mm"
section = { shape = "rectangle", width = "20 mm", thickness = "4 mm" }
material = { density = "2700 kg/m^3", youngs_modulus = "70 GPa" }
damping_ratio = "1 %"
points = [ { name = "camera", at = "120 mm" } ]
[model]
kind = "FOAM"
modes = { axial = 0, y = 0, z = 2 }
[motion.flight]
kind = "flight"
acceleration.z = { profile = "constant", level = "3 g" }
[response]
duration = "100 ms"
step = "1 ms"
estimate = false
"""


def test_points_of_a_scenario_are_measured_and_drawn_over_time(tmp_path: Path) -> None:
    file = tmp_path / "points.toml"
    file.write_text(SCENARIO, encoding="utf-8")
    swept = gb.sweep(
        file, ["beam.points[0].at=100 mm, 150 mm"], ["points.camera.z.max_abs"], histories=["camera.z"], times=5
    )
    small, large = swept.measures["points.camera.z.max_abs"]
    assert 0 < small < large and swept.histories["camera.z"].shape == (2, 5)
    with pytest.raises(gb.InputError, match=r"of camera\.x, camera\.y, camera\.z, tip\.x"):
        gb.sweep(file, ["beam.points[0].at=100 mm, 150 mm"], histories=["lens.z"], times=5)
    file.write_text(SCENARIO.replace(" } ]", ' }, { name = "camera", at = "9 mm" } ]', 1), encoding="utf-8")
    with pytest.raises(ScenarioError, match="'camera' a second time"):
        gb.read_scenario(file)
