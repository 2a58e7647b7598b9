"""Every result prints on a few lines, goes to xarray and to a file, and draws itself where it has a figure."""

from __future__ import annotations

import warnings
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import jax
import numpy as np
import pytest
import xarray as xr

import gbeam as gb
from gbeam.report import facts as facts_of

from .conftest import BEAM

KINDS = (
    "static", "modes", "campbell", "critical", "critical map", "system", "plan", "placement", "models", "response"
)  # fmt: skip


@pytest.mark.parametrize("kind", KINDS)
def test_prints_on_a_few_lines(every: dict[str, Any], kind: str) -> None:
    lines = repr(every[kind]).splitlines()
    assert 1 <= len(lines) <= 6 and max(len(line) for line in lines) <= 160
    assert lines[0].startswith(type(every[kind]).__name__) and "array(" not in repr(every[kind])


@pytest.mark.parametrize("kind", KINDS)
def test_notebooks_show_it_as_html(every: dict[str, Any], kind: str) -> None:
    shown = ElementTree.fromstring(every[kind]._repr_html_())  # every tag is closed
    words = " ".join("".join(shown.itertext()).split())
    assert shown.tag in ("div", "pre") and words and "nan" not in words


def test_what_does_not_move_is_not_viewed(every: dict[str, Any]) -> None:
    with pytest.raises(gb.InputError, match="has no motion"):
        every["campbell"].view()


@pytest.mark.parametrize("kind", KINDS)
def test_goes_to_xarray_and_to_a_file(every: dict[str, Any], kind: str, tmp_path: Path) -> None:
    built = every[kind].to_xarray()
    every[kind].save(tmp_path / "x.nc")
    # The file also has its figures as JSON, for a report.
    read = xr.load_dataset(tmp_path / "x.nc", engine="h5netcdf").drop_vars("facts", errors="ignore")
    xr.testing.assert_identical(read, built)
    for name, variable in built.variables.items():
        if variable.dtype.kind == "f":
            assert variable.attrs["units"] and variable.attrs["long_name"], name


def test_values_in_xarray(every: dict[str, Any]) -> None:
    static, modes, system = every["static"], every["modes"], every["system"]
    tip = static.to_xarray()["beam_displacement"].isel(beam_station=-1).sel(axis="z")
    assert float(tip) == static.tip[2]
    first = modes.to_xarray().sel(mode=1)
    assert float(first["frequency"]) == modes.frequency[0] and str(first["direction"].values) == modes.direction[0]
    campbell = every["campbell"].to_xarray()
    np.testing.assert_array_equal(campbell["frequency"].sel(speed=20.0), every["campbell"].frequency[-1])
    matrix = system.to_xarray()["A"]
    assert matrix.dims == ("state", "state_of") and list(matrix["state"].values) == [s.name for s in system.states]
    np.testing.assert_array_equal(matrix, system.a)
    assert list(every["models"].to_xarray()["outcome"].values) == ["done", "diverged"]
    assert every["placement"].to_xarray().attrs["weight_tip"] == 1.0


@pytest.mark.parametrize("kind", ["static", "modes", "campbell", "critical map", "plan", "response", "models"])
def test_draws_itself(every: dict[str, Any], kind: str) -> None:
    axes = every[kind].plot(title="a title")
    assert all("," in panel.get_ylabel() for panel in axes) and "," in axes[-1].get_xlabel()  # quantity, unit
    figure = axes[0].figure
    assert figure is axes.figure
    assert figure.get_suptitle().startswith(("a title\n", "LIMITS EXCEEDED – a title\n"))
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # such as of words far out of their panel
        figure.draw_without_rendering()


def test_parts_print_their_shapes(every: dict[str, Any]) -> None:
    response = every["response"]
    assert repr(response.base) == "Base(a_WO_B=(51, 3), w_WB_B=(51, 3), alpha_WB_B=(51, 3))"
    assert "section_force=(51, 4, 3)" in repr(response.loads) and len(repr(response.loads)) < 320
    assert "control_point=0.15, warnings=()" in repr(every["plan"].axes)


def test_what_is_traced_prints_its_shapes(every: dict[str, Any]) -> None:
    words = []

    def moved(scale: Any) -> Any:
        response = every["response"]
        traced = replace(response, q=scale * response.q)
        words.append(repr(traced))
        return (traced.q**2).sum()

    assert float(jax.grad(moved)(1.0)) > 0
    assert words[0].startswith("Response(name='flight', environment='flight'") and "place=(51, 2, 3)" in words[0]


def test_a_study_prints_its_responses_and_comparisons(every: dict[str, Any]) -> None:
    response = every["response"]
    study = gb.Study("title", {"flight": response}, (gb.compare(response, response),))
    lines = repr(study).splitlines()
    assert lines[0] == "Study 'title': done" and lines[1].startswith("Response 'flight' (flight, FOAM): done")
    said = [line.strip() for line in lines]
    assert "Comparison: No limits set: largest load 1 g (flight 1 g), followed 100 % of the time" in said
    assert any(line.startswith("Tip: ") and "within 0.1 % of the flight's" in line for line in said)


def test_a_response_states_its_errors(tmp_path: Path) -> None:
    flight = gb.simulate(gb.assemble(BEAM, "FOAM", z=2), gb.Flight(z=gb.constant(9.81)), duration=0.1, name="flight")
    shown = facts_of(gb.Study("", {"flight": flight}, ()))["motions"]["flight"]
    assert shown["errors"]["displacement"]["total"] == shown["error_estimate"] == flight.error_estimate
    flight.save(tmp_path / "flight.nc")
    with xr.open_dataset(tmp_path / "flight.nc") as saved:
        for kind in ("displacement", "loads", "stress"):  # each under its own name
            known = getattr(flight.errors, kind)
            assert float(saved[f"error_{kind}_total"]) == known.total > 0
            assert float(saved[f"error_{kind}_step"]) == known.step
