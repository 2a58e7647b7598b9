"""The plots are there, show what they say, and leave matplotlib as it was."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from gbeam.plots import plot_axes, plot_base, plot_comparison, plot_hub, plot_shock, plot_tip, write_plots
from gbeam.results.comparison import Mismatch, Shock
from gbeam.results.response import Study


def _assert_labelled(figure: Figure) -> None:
    assert all(panel.get_ylabel() for panel in figure.axes)
    assert "," in figure.axes[-1].get_ylabel()  # quantity, unit
    assert figure.axes[-1].get_xlabel() == "time, s"


def test_files(study: Study, tmp_path: Path) -> None:
    settings = dict(mpl.rcParams)
    files = write_plots(study, tmp_path)
    names = {"tip", "base_flight", "base_spin", "base_slew", "axes_spin", "hub_slew"}
    assert {it.stem for it in files} == names and len(files) == 2 * len(names)
    for file in files:
        assert file.stat().st_size > 5000
        if file.suffix == ".svg":
            ET.parse(file)
        else:
            assert file.read_bytes().startswith(b"\x89PNG")
    assert dict(mpl.rcParams) == settings


def test_tip(study: Study) -> None:
    figure = plot_tip(study)
    top, below = figure.axes
    _assert_labelled(figure)
    assert "along z" in figure.get_suptitle()
    lines = {line.get_label(): line for line in top.get_lines()}
    assert list(lines) == ["flight", "spin", "slew"]
    np.testing.assert_array_equal(lines["spin"].get_ydata(), 1e3 * study.responses["spin"].tip[:, 2])
    np.testing.assert_array_equal(below.get_lines()[0].get_ydata(), 1e3 * study.comparisons[0].difference[:, 2])
    assert len(below.patches) == 1  # the time it was held


def test_a_constant_is_seen_at_its_size(study: Study) -> None:
    flight = study.responses["flight"]
    constant = replace(flight, displacement=np.full_like(flight.displacement, -1.7e-3))
    (panel,) = plot_tip(Study("", {"flight": constant}, ())).axes
    low, high = panel.get_ylim()
    assert low < -1.7 and high > 0


def test_base_shows_turning_only_where_it_turns(study: Study) -> None:
    assert len(plot_base(study.responses["flight"], "").axes) == 1
    figure = plot_base(study.responses["spin"], "")
    assert len(figure.axes) == 3
    _assert_labelled(figure)


def test_axes(study: Study) -> None:
    spin = study.responses["spin"]
    figure = plot_axes(spin, spin.axes, "t")
    _assert_labelled(figure)
    assert all(len(panel.patches) == 1 for panel in figure.axes)


def test_hub_without_a_torque(study: Study) -> None:
    slew = study.responses["slew"]
    assert len(plot_hub(slew, slew.hub, "").axes) == 3
    given = replace(slew.hub, torque=np.full_like(slew.time, np.nan))
    assert len(plot_hub(slew, given, "").axes) == 2


def test_what_diverged_says_so(study: Study) -> None:
    diverged = replace(study.responses["slew"], outcome="diverged")
    for figure in (plot_tip(Study("t", {"slew": diverged}, ())), plot_hub(diverged, diverged.hub, "t")):
        assert figure.get_suptitle().startswith("DIVERGED – t\n")


def test_comparison(study: Study) -> None:
    compared, flight, spin = study.comparisons[0], study.responses["flight"], study.responses["spin"]
    gradient = np.outer(np.linspace(0, -4, len(compared.time)), [1.0, 2.0, 3.0])
    bounds = {name: np.array([1e-6, 2e-6, 3e-6]) for name in ("tip_bound", "force_bound", "moment_bound")}
    most = np.abs(gradient).max(axis=0)
    full = replace(compared, mismatch=Mismatch(0.1, gradient, most, 0.2 * most, **bounds))
    (panel,) = plot_comparison(full, flight, spin, "t").axes
    lines = {line.get_label(): line.get_ydata() for line in panel.get_lines()}
    np.testing.assert_allclose(lines["at the root"], -0.1 * gradient[:, 2])
    np.testing.assert_allclose(lines["at the tip"], 0.2 * gradient[:, 2])
    assert len(panel.patches) == 1  # the time it was held

    spectra = np.outer(np.arange(1.0, 6.0), [1, 1, 2])
    shock = Shock(10.0, np.geomspace(1, 100, 5), spectra, 2 * spectra)
    (panel,) = plot_shock(full, shock, "t").axes
    assert panel.get_xscale() == panel.get_yscale() == "log"
    np.testing.assert_array_equal(panel.get_lines()[0].get_ydata(), 2 * spectra[:, 2])
