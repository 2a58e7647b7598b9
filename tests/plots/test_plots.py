"""The plots are there, show what they say, and leave matplotlib as it was."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.image import imread

from gbeam import InputError
from gbeam.plots import plot_axes, plot_base, plot_comparison, plot_hub, plot_shock, plot_tip, write_plots
from gbeam.plots.style import COLUMNS, line, panels, styled
from gbeam.results.machine import MachinePlan
from gbeam.results.measures import Mismatch, RootHistory, RootLoads, Shock
from gbeam.results.section_forces import Loads
from gbeam.results.steady.equilibrium import Deflection
from gbeam.results.study import Study


def _assert_labelled(figure: Figure) -> None:
    assert all(panel.get_ylabel() for panel in figure.axes)
    assert "," in figure.axes[-1].get_ylabel()  # quantity, unit
    assert figure.axes[-1].get_xlabel() == "time, s"


@pytest.fixture(scope="module")
def files(study: Study, tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """All figures of the study, written once; matplotlib's settings are as they were."""
    settings = dict(mpl.rcParams)
    made = write_plots(study, tmp_path_factory.mktemp("plots"))
    assert dict(mpl.rcParams) == settings
    return made


def test_files(files: list[Path]) -> None:
    names = {"tip", "base_flight", "base_spin", "base_slew", "axes_spin", "hub_slew"}
    assert {file.stem for file in files} == names and len(files) == 2 * len(names)
    for file in files:
        assert file.stat().st_size > 5000
        if file.suffix == ".svg":
            ET.parse(file)
        else:
            assert file.read_bytes().startswith(b"\x89PNG")


def test_both_files_show_the_same(files: list[Path]) -> None:
    """Size, clipping and lines of the SVG are those of the PNG, at 72 to 150 dots per inch."""
    by_name = {file.name: file for file in files}
    pixels, drawing = imread(by_name["tip.png"]), ET.parse(by_name["tip.svg"]).getroot()
    height, width, channels = pixels.shape
    assert channels == 3 and pixels[0, 0].tolist() == [1, 1, 1] and pixels.min() < 0.1
    size = [float(drawing.attrib[name].removesuffix("pt")) for name in ("width", "height")]
    np.testing.assert_allclose(np.array(size) * 150 / 72, [width, height], atol=1)
    svg = "{http://www.w3.org/2000/svg}"
    clipped = [each for each in drawing.iter(f"{svg}path") if "clip-path" in each.attrib]
    assert len(clipped) >= 4  # three responses, and the difference
    boxes = [[float(box.attrib[key]) for key in ("x", "y", "width", "height")] for box in drawing.iter(f"{svg}rect")]
    for x, y, wide, high in boxes:
        assert x > 0 and y > 0 and x + wide < size[0] and y + high < size[1]


def _inside(figure: Figure, panel: Axes) -> bool:
    figure.draw_without_rendering()
    box = panel.get_tightbbox()
    return box.x0 >= 0 and box.y0 >= 0 and box.x1 <= figure.bbox.x1 and box.y1 <= figure.bbox.y1


def test_nothing_leaves_the_figure_or_covers_another_panel(study: Study) -> None:
    spin = study.responses["spin"]
    wide = replace(spin.axes, acceleration=-123456.7 * spin.axes.acceleration)
    for figure in (plot_axes(spin, wide, "t"), plot_tip(study), plot_base(spin, "two\nlines")):
        assert all(_inside(figure, panel) for panel in figure.axes)
        boxes = [panel.get_tightbbox() for panel in figure.axes]
        assert all(above.y0 >= below.y1 for above, below in pairwise(boxes))
        title = figure.texts[0].get_window_extent()
        assert title.y0 >= boxes[0].y1 and title.y1 <= figure.bbox.y1


@styled
def _drawn(x: np.ndarray, y: np.ndarray) -> Figure:
    figure, (panel,) = panels("", 1)
    line(panel, x, y)
    return figure


def test_a_long_line_keeps_its_extremes() -> None:
    time = np.linspace(0, 1, 40_001)
    values = np.sin(2 * np.pi * 500 * time)
    values[[7, 20_002, 39_999]] = [3.0, -4.0, 5.0]
    x, y = _drawn(time, values).axes[0].get_lines()[0].get_data()
    assert len(x) < 5 * COLUMNS and (x[0], x[-1]) == (0, 1) and np.all(np.diff(x) > 0)
    np.testing.assert_array_equal(y, values[np.searchsorted(time, x)])
    assert {3.0, -4.0, 5.0} <= set(y)
    for k in range(0, 40_000, 4_000):  # of every stretch
        inside = (x >= time[k]) & (x <= time[k + 4_000])
        assert np.ptp(y[inside]) == np.ptp(values[k : k + 4_001])


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
    given = replace(slew.hub, drive_torque=np.full_like(slew.time, np.nan))
    assert len(plot_hub(slew, given, "").axes) == 2


def test_what_diverged_says_so(study: Study) -> None:
    diverged = replace(study.responses["slew"], outcome="diverged")
    for figure in (plot_tip(Study("t", {"slew": diverged}, ())), plot_hub(diverged, diverged.hub, "t")):
        assert figure.get_suptitle().startswith("DIVERGED – t\n")


def test_comparison(study: Study) -> None:
    compared = study.comparisons[0]
    gradient = np.outer(np.linspace(0, -4, len(compared.time)), [1.0, 2.0, 3.0])
    bounds = {name: np.array([1e-6, 2e-6, 3e-6]) for name in ("tip_bound", "force_bound", "moment_bound")}
    most = np.abs(gradient).max(axis=0)
    full = replace(compared, mismatch=Mismatch(0.1, gradient, most, 0.2 * most, **bounds, length=0.3))
    (panel,) = plot_comparison(full, "t").axes
    lines = {line.get_label(): line.get_ydata() for line in panel.get_lines()}
    np.testing.assert_allclose(lines["at the root"], -0.1 * gradient[:, 2])
    np.testing.assert_allclose(lines["at the tip"], 0.2 * gradient[:, 2])
    assert len(panel.patches) == 1  # the time it was held

    spectra = np.outer(np.arange(1.0, 6.0), [1, 1, 2])
    shock = Shock(10.0, np.geomspace(1, 100, 5), spectra, 2 * spectra)
    (panel,) = plot_shock(full, shock, "t").axes
    assert panel.get_xscale() == panel.get_yscale() == "log"
    np.testing.assert_array_equal(panel.get_lines()[0].get_ydata(), 2 * spectra[:, 2])


def test_comparison_with_root_loads_or_without_parts(study: Study) -> None:
    compared = study.comparisons[0]
    t = compared.time
    history = RootHistory(*(np.outer(k + np.sin(t), [1.0, 2.0, 3.0]) for k in range(4)))
    root = RootLoads(*(np.arange(3.0) + k for k in range(6)), 1.0, 2.0, 3.0, history)
    shear, moment = replace(compared, root=root).plot(title="t").axes
    lines = {each.get_label(): each.get_ydata() for each in shear.get_lines()}
    np.testing.assert_array_equal(lines["spin"], history.force_centrifuge[:, 2])
    np.testing.assert_array_equal(lines["flight"], history.force_flight[:, 2])
    assert moment.get_ylabel().endswith("M_z, N m")
    (alone,) = compared.plot().axes
    np.testing.assert_array_equal(alone.get_lines()[0].get_ydata(), 1e3 * compared.difference[:, 2])


def test_a_result_draws_itself(study: Study) -> None:
    spin = study.responses["spin"]
    assert "tip displacement" in spin.plot(title="mine").get_suptitle()
    assert "axes of the machine" in spin.plot("axes").get_suptitle()
    assert study.plot().get_suptitle().startswith("a title\n") and "the hub" in study.plot("hub slew").get_suptitle()
    with pytest.raises(InputError, match="choose from tip, base, axes"):
        spin.plot("loads")
    plan = MachinePlan("spin", "flight", 3.3, "done", "", spin.time, spin.axes)
    assert len(plan.plot().axes) == 4
    x = np.linspace(0, 0.3, 5)
    along = Loads(x, *(np.ones((1, 5, 3)) for _ in range(4)), *np.ones((2, 1, 5)), np.ones((1, 5, 3)))
    moved = np.outer(x, [0.0, 1.0, 2.0])
    rest = Deflection("flight", "FOAM", 0.0, spin.base, x, moved, np.zeros(3), 0.0, True, along)
    assert [len(rest.plot(what).axes) for what in ("", "shape", "loads")] == [2, 2, 3]
