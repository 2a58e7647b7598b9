"""``gbeam critical-speed`` with everything that it can vary, and its map."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ..scenarios import COLUMN

BENDING = 6.8952e10 * 8.2189e-9 / 64  # EI/L², N


@pytest.fixture
def call(tmp_path, monkeypatch, gbeam):
    """Call the verb: exit status, JSON, stderr."""
    monkeypatch.chdir(tmp_path)
    Path("column.toml").write_text(COLUMN, encoding="utf-8")

    def run(*options):
        answer = gbeam("critical-speed", "column.toml", "--json", *options)
        return answer.status, answer.json, answer.err

    return run


def test_loads(call):
    foam = ("--set", "model.kind=FOAM", "--vary", "loads", "--at", "1 s", "--motion", "flight")
    status, facts, _ = call(*foam)
    assert status == 0 and facts["critical_load_factor"] == pytest.approx(20.0510 * BENDING, rel=1e-3)
    assert facts["kind"] == "flutter"
    _, facts, _ = call(*foam, "--set", "beam.loads[0].follower=false")
    assert facts["critical_load_factor"] == pytest.approx(np.pi**2 / 4 * BENDING, rel=1e-3)
    status, facts, err = call("--vary", "loads", "--motion", "flight")
    assert status == 2 and "no load that acts" in err and facts["error"][0]["path"] == "beam.loads"


def test_acceleration(call):
    status, facts, _ = call("--set", "model.kind=FOAM", "--vary", "acceleration")
    expected = 7.8373 * BENDING / (2766.7 * 7.2968e-5 * 8.0)
    assert status == 0 and facts["critical_acceleration"] == pytest.approx(expected, rel=1e-3)


def test_map(call, with_figures):
    """2009 Fig. 9, and the critical speeds of its section 4 at the tip."""
    status, facts, _ = call("--masses", "0 kg, 0.1 kg, 0.5 kg", "--positions", "4 m, 8 m", "--out", "there")
    speed = np.array(facts["critical_speed"])
    assert status == 0 and speed.shape == (3, 2)
    assert speed[:, 1] == pytest.approx([2.9107, 2.6043, 1.9366], abs=1e-4)
    listed = np.loadtxt("there/critical_speed.csv", delimiter=",", skiprows=1)
    assert np.array(facts["errors"]["shapes"])[2, 1] == pytest.approx(speed[2, 1] / 1.93645 - 1, abs=1e-5)
    assert facts["errors"]["total"] == [[None, None]] * 3 and any("TLAM's own" in each for each in facts["warnings"])
    np.testing.assert_allclose(listed, np.column_stack([[4.0, 8.0], speed.T, np.full((2, 3), np.inf)]))
    assert {file.suffix for file in Path("there").iterdir()} == {".csv", ".json", ".png", ".svg"}
    status, facts, _ = call("--set", "model.kind=FOAM", "--masses", "0.5 kg", "--positions", "8 m", "--to", "10 rad/s")
    assert status == 0 and facts["critical_speed"] == [[None]]


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
    status, _, err = call(*options)
    assert status == 2 and words in err
