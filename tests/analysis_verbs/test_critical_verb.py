"""``gbeam critical-speed`` with everything that it can raise, and its map."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from gbeam.cli import main

COLUMN = """\
[beam]
length = "8 m"
section = { area = "7.2968e-5 m^2", inertia_y = "8.2189e-9 m^4", inertia_z = "8.2189e-9 m^4" }
material = { density = "2766.7 kg/m^3", youngs_modulus = "6.8952e10 Pa" }
damping_ratio = 0
[[beam.loads]]
at = "8 m"
force = { x = { profile = "smooth-step", level = "-1 N", duration = "1 s" } }
follower = true
[model]
kind = "TLAM"
modes = { axial = 1, y = 5, z = 0 }
[motion.slew]
kind = "hub"
radius = "0.5 m"
rate = { profile = "constant", level = "0 rad/s" }
[motion.flight]
kind = "flight"
acceleration = { y = { profile = "constant", level = "0 g" } }
[response]
duration = "2 s"
"""
BENDING = 6.8952e10 * 8.2189e-9 / 64  # EI/L², N


@pytest.fixture
def call(tmp_path, monkeypatch, capsys):
    """Call the verb: exit status, JSON, stderr."""
    monkeypatch.chdir(tmp_path)
    Path("column.toml").write_text(COLUMN)

    def run(*options):
        status = main(["critical-speed", "column.toml", "--json", *options])
        said = capsys.readouterr()
        assert "Traceback" not in said.err
        return status, json.loads(said.out), said.err

    return run


def test_loads(call):
    foam = ("--set", "model.kind=FOAM", "--vary", "loads", "--at", "1 s", "--motion", "flight")
    status, told, _ = call(*foam)
    assert status == 0 and told["critical_load_factor"] == pytest.approx(20.0510 * BENDING, rel=1e-3)
    assert told["kind"] == "flutter"
    _, told, _ = call(*foam, "--set", "beam.loads[0].follower=false")
    assert told["critical_load_factor"] == pytest.approx(np.pi**2 / 4 * BENDING, rel=1e-3)
    status, told, said = call("--vary", "loads", "--motion", "flight")
    assert status == 2 and "none that acts" in said and told["error"][0]["path"] == "beam.loads"


def test_acceleration(call):
    status, told, _ = call("--set", "model.kind=FOAM", "--vary", "acceleration")
    wanted = 7.8373 * BENDING / (2766.7 * 7.2968e-5 * 8.0)
    assert status == 0 and told["critical_acceleration"] == pytest.approx(wanted, rel=1e-3)


def test_map(call):
    """2009 Fig. 9, and the critical speeds of its section 4 at the tip."""
    status, told, _ = call("--masses", "0 kg, 0.1 kg, 0.5 kg", "--positions", "4 m, 8 m", "--out", "there")
    speed = np.array(told["critical_speed"])
    assert status == 0 and speed.shape == (3, 2)
    assert speed[:, 1] == pytest.approx([2.9107, 2.6043, 1.9366], abs=1e-4)
    listed = np.loadtxt("there/critical_speed.csv", delimiter=",", skiprows=1)
    np.testing.assert_allclose(listed, np.column_stack([[4.0, 8.0], speed.T]))
    assert {it.suffix for it in Path("there").iterdir()} == {".csv", ".json", ".png", ".svg"}
    status, told, _ = call("--set", "model.kind=FOAM", "--masses", "0.5 kg", "--positions", "8 m", "--to", "10 rad/s")
    assert status == 0 and told["critical_speed"] == [[None]]


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--motion", "flight"), "gbeam modes"),
        (("--masses", "0.1 m"), "--masses"),
        (("--masses", "1 kg, -1 kg"), "negative"),
        (("--masses", "1 kg", "--positions", "9 m"), "off the beam"),
        (("--masses", "1 kg", "--vary", "loads"), "a map is of hub rates"),
        (("--positions", "1 m"), "stands without --masses"),
        (("--to", "3 kg"), "--to"),
        (("--to", "-3 rad/s"), "to"),
    ],
)
def test_refusals(call, options, words):
    status, _, said = call(*options)
    assert status == 2 and words in said
