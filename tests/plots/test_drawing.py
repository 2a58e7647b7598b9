"""Parts of all figures: lines and envelopes, units, limits, the files and their signatures."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.image import imread

from gbeam.figures import Figure as Described
from gbeam.figures import Line, Panel, components, limit_levels, scale_of, stretches
from gbeam.plots import BINS, COLUMNS, DPI, ENVELOPE, STYLE, draw, line, save, signature
from gbeam.results import AxesResult


def _panel() -> Axes:
    return Figure().add_subplot()


def _figure(*panels: Panel, title: str = "a title") -> Figure:
    return draw(Described(title, "", panels))


def test_a_long_line_keeps_its_extremes() -> None:
    time = np.linspace(0, 1, 40_001)
    values = np.sin(2 * np.pi * 20 * time)
    values[[7, 20_002, 39_999]] = [3.0, -4.0, 5.0]
    panel = _panel()
    line(panel, time, values)
    (drawn,) = panel.get_lines()
    x, y = drawn.get_data()
    assert len(x) < 5 * COLUMNS and (x[0], x[-1]) == (0, 1) and np.all(np.diff(x) > 0)
    np.testing.assert_array_equal(y, values[np.searchsorted(time, x)])
    assert {3.0, -4.0, 5.0} <= set(y)
    for k in range(0, 40_000, 4_000):  # of every stretch
        inside = (x >= time[k]) & (x <= time[k + 4_000])
        assert np.ptp(y[inside]) == np.ptp(values[k : k + 4_001])


@pytest.mark.parametrize("samples", [8_000, 60_001])
def test_a_fast_vibration_is_an_envelope(samples: int) -> None:
    """A ramp that vibrates in the middle third: filled there between the extremes, a line elsewhere, in one piece."""
    time = np.linspace(0, 3, samples)
    size = np.where((time > 1) & (time < 2), 0.5, 0.0)
    values = time + size * np.sin(2 * np.pi * 400 * time)
    panel = _panel()
    line(panel, time, values, label="tip", color="red")
    (envelope,) = panel.collections
    assert envelope.get_label() == ENVELOPE
    middle, low, high = (each.get_data() for each in panel.get_lines())
    bin_width = 3 / BINS
    inside = (low[0] > 1 + 2 * bin_width) & (low[0] < 2 - 2 * bin_width)
    assert inside.sum() > BINS / 3 - 6
    # Within the ramp of one bin, and within what eight samples of a period leave of a sine.
    np.testing.assert_allclose(high[1][inside] - low[0][inside], 0.5, atol=bin_width + 0.04)
    np.testing.assert_allclose(low[1][inside] - low[0][inside], -0.5, atol=bin_width + 0.04)
    outside = (low[0] < 1 - 2 * bin_width) | (low[0] > 2 + 2 * bin_width)
    assert not outside.any()
    assert np.isfinite(middle[1]).all() and np.all(np.diff(middle[0]) >= 0)
    np.testing.assert_allclose(middle[1], middle[0], atol=0.1 + bin_width)
    assert np.abs(np.diff(middle[1])).sum() < 3 + 1  # no block: about the ramp's own length
    line(panel, time, values)
    assert [each.get_label() == ENVELOPE for each in panel.collections] == [True, False]  # named once


def test_what_can_be_seen_stays_a_line() -> None:
    time = np.linspace(0, 1, 20_001)
    panel = _panel()
    for frequency in (1.0, 20.0, 60.0):  # 60 periods: four bins each
        line(panel, time, np.sin(2 * np.pi * frequency * time))
    line(panel, time, np.full(20_001, 2.0))
    line(panel, time, time + 1e-5 * np.sin(2 * np.pi * 2000 * time))  # rounding, at the size of the line
    assert not panel.collections and len(panel.get_lines()) == 5


def test_what_is_not_finite_is_a_gap() -> None:
    time = np.linspace(0, 1, 5_000)
    values = np.sin(2 * np.pi * 400 * time)
    values[2_000:] = np.nan
    panel = _panel()
    line(panel, time, values)
    assert len(panel.collections) == 1 and np.nanmax(panel.get_lines()[2].get_ydata()) > 0.95


@pytest.mark.parametrize(
    ("si", "size", "factor", "name"),
    [
        ("m", 2.5, 1, "m"),
        ("m", 0.3, 1e3, "mm"),
        ("m", 2e-4, 1e3, "mm"),
        ("m", 3e-5, 1e6, "µm"),
        ("m", 0.0, 1e3, "mm"),
        ("N", 5.0, 1, "N"),
        ("N", 5e4, 1e-3, "kN"),
        ("N m", 2e5, 1e-3, "kN m"),
        ("N m", 1e-3, 1e3, "mN m"),
        ("Pa", 2e8, 1e-6, "MPa"),
        ("m/s^2", 80.0, 1 / 9.80665, "g"),
        ("m/s^2", 0.2, 1, "m/s²"),
    ],
)
def test_units_suit_the_size(si: str, size: float, factor: float, name: str) -> None:
    scale, unit = scale_of(si, np.array([0.0, np.nan]), np.array([-size, np.inf, 0.1 * size]))
    assert scale == pytest.approx(factor) and unit == name


def test_components_that_hardly_count_are_named() -> None:
    t = np.linspace(0, 1, 9)
    panel = components(t, np.outer(t, [0.005, 1.0, 0.0]), ("N", "V_y", "V_z"), Panel("force, N"))
    assert [each.label for each in panel.lines] == ["V_y"] and panel.title == "N: below 1 %, not drawn"
    (axes,) = _figure(panel).axes
    assert [each.get_label() for each in axes.get_lines()] == ["V_y"] and axes.get_title(loc="left") == panel.title


def test_limits() -> None:
    values = np.array([-0.001, 2.0, 3.0])
    levels = limit_levels(4.0, values)
    (panel,) = _figure(Panel("", (Line(np.arange(3.0), values),), levels=levels)).axes
    assert [each.get_ydata()[0] for each in panel.get_lines()[1:]] == [4.0] and panel.get_ylim()[1] > 4
    assert limit_levels(40.0, values) == limit_levels(np.inf, values) == ()
    assert [each.value for each in limit_levels(4.0, np.array([-3.0, 3.0]))] == [4.0, -4.0]


def test_reasons_in_the_legend() -> None:
    assert stretches(None, np.zeros(3)) == ()
    held = ((0, 1, "gimbals"), (2, 3, "axis 2 jerk"), (4, 5, "axis 3 rate, axis 2 jerk"), (6, 7, "gimbals"))
    none = np.zeros((2, 3))
    axes = AxesResult(none, none, none, none, none, np.zeros(2, dtype=bool), held, span=(0, 8))
    spans = stretches(axes, np.array([0.0, 8.0]))
    drawn = _figure(Panel("", spans=spans), Panel("", spans=spans)).axes
    named = [each.get_label() for each in drawn[0].collections]
    assert named == ["gimbals", "axis 2 jerk", "limits of axis 2 and axis 3"]
    assert len(drawn[0].collections[0].get_paths()) == 2 and drawn[0].get_ylim() == (0, 1)
    assert len({(*each.get_facecolor()[0], each.get_hatch()) for each in drawn[0].collections}) == 2
    assert [each.get_label() for each in drawn[1].collections] == [f"_{name}" for name in named]


def test_signature(tmp_path: Path) -> None:
    figure = _figure(Panel(""))
    for file in save(figure, tmp_path, "loads_<a> & b", "gbeam run"):
        assert signature(file) == "gbeam run"
        copy = file.with_stem("mine")
        copy.write_bytes(file.read_bytes())
        assert signature(copy) == ""  # a copy is no longer what the command made
    assert [signature(file) for file in save(figure, tmp_path, "plain")] == ["", ""]
    for file in save(figure, tmp_path, "Böe λ", "gbeam run"):
        assert signature(file) == "gbeam run"
        for content in (b"", b"<svg", file.read_bytes()[:60], b'<?xml version="1.0" encoding="none"?><svg/>'):
            file.write_bytes(content)
            assert signature(file) == ""


def _of_all_kinds() -> Figure:
    x = np.array([0.0, 2.5])
    rising = Panel("", (Line(x, np.array([-0.3, 0.7]), "rising"),))
    larger = Panel("of two lines, because of its many words", (Line(x, np.array([-3e7, 0.0])),))  # a power of ten above
    return _figure(rising, Panel("", (Line(x + 1, np.array([1.0, 1e3])),), x="f", logarithmic=True), larger)


def test_a_saved_figure_is_as_matplotlib_draws_it(tmp_path: Path) -> None:
    figure = _of_all_kinds()
    for changed in (False, True):
        if changed:
            for panel in figure.axes:
                panel.tick_params(labelsize=13, colors="red")
        png, svg = save(figure, tmp_path, "figure")
        with rc_context(STYLE):
            figure.set_dpi(DPI)
            canvas = FigureCanvasAgg(figure)
            canvas.draw()
            figure.set_dpi(100)
        expected = np.asarray(canvas.buffer_rgba())[:, :, :3]
        np.testing.assert_array_equal(np.round(255 * imread(png)[:, :, :3]), expected)
        assert "<!-- 2.5 -->" in svg.read_text(encoding="utf-8")
