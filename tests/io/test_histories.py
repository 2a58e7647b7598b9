"""Samples of long histories that a file keeps: one of so many samples, by a rule or by choice, and it is said."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import gbeam as gb
from gbeam.analysis.response import settings

from ..calling import Answer, gbeam
from ..scenarios import FAST

__all__ = ["gbeam"]


@pytest.fixture
def scenario(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A flight and its machine; 501 samples of the flight."""
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "s.toml"
    file.write_text(FAST, encoding="utf-8")
    return file


def test_a_file_keeps_what_is_chosen_and_figures_are_of_all(scenario: Path, gbeam: Callable[..., Answer]) -> None:
    whole = gbeam("run", scenario, "--out", "whole", "--json").json
    chosen = gbeam("run", scenario, "--set", "response.histories=5 ms", "--out", "some", "--json").json
    a, b = (xr.open_datatree(f"{name}/result.nc").load() for name in ("whole", "some"))
    for name in ("motions/flight", "motions/spin", "comparisons/spin"):
        every = b[name].attrs["histories_every"]
        assert every == 5 and "histories_every" not in a[name].attrs
        assert (
            b[name].attrs["histories"]
            == f"one of 5 samples, of {a[name].sizes['time']}; peaks, errors and comparisons are of all"
        )
        assert set(a[name].variables) == set(b[name].variables)
        for variable, values in a[name].variables.items():
            kept = values.isel(time=slice(None, None, every)) if "time" in values.dims else values
            assert kept.dims == b[name][variable].dims
            np.testing.assert_array_equal(kept.values, b[name][variable].values)
    assert np.diff(b["motions/flight"]["time"]) == pytest.approx(0.005)
    for each in ("verdict", "peaks", "accounting"):
        assert whole["comparisons"][0][each] == chosen["comparisons"][0][each]
    samples = a["motions/flight"].sizes["time"]
    assert chosen["motions"]["flight"]["histories"] == {
        "samples": samples,
        "written": b["motions/flight"].sizes["time"],
    }
    assert whole["motions"]["flight"]["histories"] == {"samples": samples, "written": samples}
    line = (
        f"a result file keeps {b['motions/flight'].sizes['time']} of {samples} samples of its histories, 5.000 ms apart"
    )
    assert any(each.startswith(line) for each in chosen["motions"]["flight"]["lines"])
    assert gbeam("rerun", "some/result.nc").out.endswith("the same to the last digit\n")


def test_of_long_histories_a_file_keeps_a_part_by_itself(scenario: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(settings, "KEPT", 200)
    study = gb.study(gb.read_scenario(scenario))
    study.save("part.nc")
    flight = study.responses["flight"]
    assert flight.kept_every == 3 and len(flight.time) == 501
    assert xr.open_datatree("part.nc")["motions/flight"].sizes["time"] == 167
    assert study.to_xarray()["motions/flight"].sizes["time"] == 501
    assert gb.ResponseSettings(duration=1.0).kept_every(200, 1e-3) == 1
    assert gb.ResponseSettings(duration=1.0, histories=1e-6).kept_every(10**6, 1e-3) == 1
    with pytest.raises(gb.InputError, match="histories is 0 s"):
        gb.ResponseSettings(duration=1.0, histories=0.0)
