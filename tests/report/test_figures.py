"""A figure is described once: Matplotlib and the page show the same lines, limits, shading, bars and labels."""

from __future__ import annotations

import html
import re
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

import gbeam as gb
from gbeam.figures import Figure, Panel, figures_of
from gbeam.numerics import thinned
from gbeam.plots import draw
from gbeam.report import COLUMNS, FITTING, Numbers, draw_figures, report_of, report_of_file
from gbeam.results import Indices, LoadDifference, Parameter, Result, RootHistory, RootLoads, Shock, Sizes, Statistics
from gbeam.results import StationStatistics as Apart

from .test_page import BEAM, _fit, _optimum, _sensitivity, _shaped, header_of

pytestmark = pytest.mark.usefixtures("reading_in_process")

GRID = np.linspace(0.1, 0.8, 8)
LENGTH = Parameter("beam.length", GRID, "m")
WIDTHS, KINDS = Parameter("beam.width", GRID[:3], "m"), Parameter("kind", np.array(["a", "b", "c"], dtype=object))
DRAWN = Parameter("beam.modulus", 1e9 * GRID, "Pa", "normal")


def _sweep(*parameters: Parameter, time: bool = False, **more: object) -> gb.Sweep:
    grid = [each for each in parameters if not each.drawn]
    shape = tuple(len(each.values) for each in grid) + ((8,) if len(grid) < len(parameters) else ())
    values = np.arange(np.prod(shape), dtype=float).reshape(shape)
    outcome = np.full(shape, "done", dtype=object)
    outcome.flat[0] = "diverged"
    histories = {"tip": values[..., None] * np.linspace(0, 1, 5)} if time else {}
    every = {"histories": histories, "time": np.linspace(0, 1, 5) if time else np.empty(0)} | more
    return gb.Sweep("toy", "run", parameters, {"tip": values}, {"tip": "m"}, outcome, 0 * outcome.astype("O"), **every)


def _sweeps() -> Iterator[Result]:
    bounds = np.stack([GRID, GRID - 0.05, GRID + 0.05], axis=-1)
    share = Indices(("a", "b"), 0.1 * np.array([[[3, 1, 5], [4, 2, 6]], [[1, 0, 2], [2, 1, 3]]]), np.array(4))
    likely = Statistics(("probability",), bounds[:, None], np.full(8, 9))
    spread = np.stack([k + np.linspace(0, 1, 5)[:, None] * [1, 0.9, 1.1] for k in range(5)], axis=1)
    names = ("mean", "standard deviation", "5 %", "median", "95 %")
    message = {"message": np.full(8, "", dtype=object)}
    for each in (
        _sweep(LENGTH),
        _sweep(KINDS),
        _sweep(LENGTH, WIDTHS),
        _sweep(LENGTH, KINDS),
        _sweep(LENGTH, replace(LENGTH, path="beam.other")),
        _sweep(DRAWN, indices={"tip": share}),
        _sweep(WIDTHS, DRAWN),
        _sweep(LENGTH, DRAWN, statistics={"tip": likely}),
        _sweep(LENGTH, time=True),
        _sweep(DRAWN, time=True, statistics={"tip": Statistics(names, spread, np.full(5, 8))}),
    ):
        yield replace(each, message=np.full(each.outcome.shape, message["message"][0], dtype=object))


def _results(study: gb.Study) -> dict[str, list[Result]]:
    structure, hub = gb.assemble(BEAM, "TLAM", y=2, z=2), gb.Hub(radius=0.5)
    machine = gb.Centrifuge(gb.Flight(z=20.0), arm=3.3, control_point=0.2, gravity=False, span=(0.0, 0.5))
    spectra = np.outer(np.arange(1.0, 6.0), [1, 1, 2])
    shock = Shock(10.0, np.geomspace(1, 100, 5), spectra, 2 * spectra)
    compared = replace(_apart(study.comparisons[0]), shock=shock)
    fit, modal = _fit(), replace(_fit(), modal=True, at=np.arange(1.0, 6.0))
    column = replace(fit.columns[0], measured=1 + fit.at)
    return {
        "study": [study, replace(study, comparisons=(compared,)), study.responses["slew"]],
        "comparison": [study.comparisons[0], compared],
        "static": [gb.static(structure, acceleration=(0, 0, 78.5))],
        "modes": [gb.modes(structure, hub)],
        "campbell": [gb.campbell(structure, hub, speeds=np.linspace(0, 30, 7))],
        "linearize": [gb.linearize(structure, hub)],
        "critical": [
            gb.critical_speed(structure, hub),
            gb.critical_speed(structure, hub, upper=1.0),
            gb.critical_load(_column(follower=True)),
            gb.buckling_acceleration(structure),
        ],
        "path": [gb.equilibrium_path(structure, gb.Flight(z=20.0), vary="motion")],
        "map": [gb.critical_speed_map(BEAM, gb.Model("TLAM", y=2, z=2), hub, [0.1], [0.1, 0.3])],
        "plan": [_sparse(gb.plan("", machine))],
        "fit": [fit, replace(modal, columns=(column,))],
        "optimize": [_optimum()],
        "sensitivity": [_sensitivity()],
        "shape": [_shaped()],
        "sweep": list(_sweeps()),
    }


def _column(*, follower: bool, **modes: int) -> gb.Structure:
    push = gb.Load(0.3, force=(-1.0, 0.0, 0.0), follower=follower)
    return gb.assemble(replace(BEAM, loads=(push,), damping_ratio=0.0), "SFOAM", **modes or {"z": 3})


def _apart(compared: gb.Comparison) -> gb.Comparison:
    """A comparison with root loads, a difference of the load, trends and vibrations."""
    t, one = compared.time, np.ones((1, 3))
    waves = [np.outer(k + np.sin(t), [1.0, 2.0, 3.0]) for k in range(9)]
    root = RootLoads(*(np.arange(3.0) + k for k in range(6)), 1.0, 2.0, 3.0, RootHistory(*waves[:4]))
    most = np.abs(waves[4]).max(axis=0)
    load_difference = LoadDifference(0.1, waves[4], most, 0.2 * most, most, most, most, length=0.3)
    sizes = [Sizes(one, one, one) for _ in range(3)]
    return replace(
        compared, root=root, load_difference=load_difference, stations=Apart(np.array([0.3]), 5.0, *sizes, *waves[5:])
    )


def _sparse(plan: gb.MachinePlan) -> gb.MachinePlan:
    """Every sixth sample: with so few no line becomes an envelope."""
    histories = {name: each[::6] for name, each in vars(plan.axes).items() if isinstance(each, np.ndarray)}
    return replace(plan, time=plan.time[::6], axes=replace(plan.axes, **histories))


NAMES = [
    "study",
    "comparison",
    "static",
    "modes",
    "campbell",
    "linearize",
    "critical",
    "map",
    "plan",
    "fit",
    "optimize",
    "sensitivity",
    "shape",
    "sweep",
]


@pytest.fixture(scope="module")
def results(study: gb.Study) -> dict[str, list[Result]]:
    return _results(study)


@pytest.mark.parametrize("kind", NAMES)
def test_both_renderers_show_the_same(kind: str, results: dict[str, list[Result]]) -> None:
    for result in results[kind]:
        every = figures_of(result)
        assert every
        for describe in every.values():
            _compare(describe())


def _compare(figure: Figure) -> None:
    numbers, header = Numbers(), {"plots": [], "maps": []}
    page = html.unescape(draw_figures([figure], numbers, header))
    specs, maps = iter(header["plots"]), iter(header["maps"])
    shown = draw(figure)
    assert (
        all(note.lower() in page.lower() for note in (figure.subject, *figure.notes))
        and figure.subject in shown.get_suptitle()
    )
    for axes, panel in zip(shown.axes, figure.panels, strict=False):  # the scale of a map is beside them
        if panel.bars is not None:
            widths = [bar.get_width() for bars in axes.containers for bar in getattr(bars, "patches", ())]
            np.testing.assert_allclose(widths, np.concatenate(list(panel.bars.values.values())))
            assert all(f"{width:#.4g}".rstrip(".") in page for width in widths if width)
            assert [each.get_text() for each in axes.get_yticklabels()] == list(panel.bars.names)
            assert all(name in re.sub("<wbr>", "", page) for name in panel.bars.names)
        elif panel.map is not None:
            spec = next(maps)
            kept = numbers.array[spec["values"]["at"] :][: panel.map.values.size].reshape(panel.map.values.shape)
            np.testing.assert_allclose(axes.collections[0].get_array(), kept.T, rtol=1e-6)
        else:
            _compare_lines(axes, panel, next(specs), numbers.array)
    assert next(specs, None) is next(maps, None) is None


def _compare_lines(axes: object, panel: Panel, spec: dict, numbers: np.ndarray) -> None:
    label, (quantity, _, unit) = axes.get_ylabel().replace("\n", " "), panel.y.rpartition(", ")
    assert label == panel.y and axes.get_xlabel() in ("", spec["x"])
    # On a page a long quantity is in the caption alone.
    assert (
        spec["y"] == (label if len(label) <= FITTING else unit) and (panel.title or quantity or label) in spec["title"]
    )
    assert axes.get_title(loc="left") in spec["title"]
    lines, series = axes.get_lines(), spec["series"][len(spec["series"]) - len(panel.lines) :]
    assert len(lines) == len(panel.lines) + len(panel.levels) + len(panel.marks)
    low, high = panel.limits or (-np.inf, np.inf)
    for one, line, each in zip(panel.lines, lines, series, strict=False):
        x, y = (numbers[each[way]["at"] :][: each[way]["shape"][0]] for way in "xy")
        along, values = thinned(line.get_xdata(), line.get_ydata(), COLUMNS)
        np.testing.assert_allclose(x, along, rtol=1e-6, atol=1e-6 * np.ptp(along))
        np.testing.assert_allclose(y, np.clip(values, low, high), rtol=1e-6, atol=1e-6 * np.ptp(values))
        assert line.get_label() == one.label if panel.named and one.label else line.get_label().startswith("_")
        assert each["label"] == (one.label.removeprefix("_") or panel.y)
    levels = [line.get_ydata()[0] for line in lines[len(panel.lines) :][: len(panel.levels)]]
    assert levels == [each["value"] for each in spec["levels"]]
    shaded = [
        (path.vertices[:, 0].min(), path.vertices[:, 0].max())
        for each in axes.collections[len(panel.areas) :]
        for path in each.get_paths()
    ]
    bands = [tuple(band) for band in spec["bands"]][: len(panel.spans)]
    assert sorted(shaded) == sorted(bands) and len(shaded) == len(panel.spans)
    for mark, (start, end) in zip(panel.marks, spec["bands"][len(panel.spans) :], strict=True):
        assert start == end == mark.value


def test_frequencies_fall_to_the_critical_value() -> None:
    """Under a dead load with one shape f² = f₀² (1 − P/P_c); two of Beck's column, undamped, meet where it flutters."""
    euler = gb.critical_load(_column(follower=False, z=1))
    assert euler.value is not None
    share = 1 - euler.followed / euler.value
    square = euler.frequency[:, 0] ** 2  # which ends near zero
    np.testing.assert_allclose(square, square[0] * share, rtol=1e-6, atol=1e-8 * square[0])
    assert np.isnan(euler.frequency[:, 1:]).all() and euler.followed[0] == 0.0 < share[-1] < 1e-5
    beck = gb.critical_load(_column(follower=True, z=3))
    apart = np.diff(beck.frequency[:, :2], axis=1)[:, 0]
    assert beck.kind == "flutter" and (np.diff(apart) < 0).all() and apart[-1] < 5e-3 * apart[0]
    (panel,) = figures_of(euler)["critical"]().panels
    (mark,), ((start, end, reason),) = panel.marks, panel.spans
    assert mark.value == euler.value and mark.label == "divergence along z" and reason == "estimated error"
    assert (start, end) == pytest.approx([euler.value * (1 + sign * euler.errors.total) for sign in (-1, 1)])
    kept = gb.critical_speed(gb.assemble(BEAM, "FOAM", axial=1, y=1, z=1), gb.Hub(radius=0.5), upper=30.0)
    (panel,) = figures_of(kept)["critical"]().panels
    assert not panel.marks and not panel.spans and kept.followed[-1] == 30.0
    assert figures_of(replace(kept, followed=np.empty(0), frequency=np.empty((0, 0)))) == {}  # as in earlier files


def test_poles_that_grow_are_told_from_those_that_do_not(results: dict[str, list[Result]]) -> None:
    (linear,) = results["linearize"]
    a = np.array([[-1.0, 6.0, 0.0], [-6.0, -1.0, 0.0], [0.0, 0.0, 2.0]])  # poles −1 ± 6i and 2, 1/s
    (panel,) = figures_of(replace(linear, a=a))["poles"]().panels
    drawn_as = {line.label: (line.x.tolist(), line.y.tolist()) for line in panel.lines}
    assert drawn_as == {
        "decays or stays": ([pytest.approx(-1.0)], [pytest.approx(6 / (2 * np.pi))]),
        "grows": ([2.0], [0.0]),
    }


@pytest.mark.parametrize("kind", NAMES)
def test_the_page_of_a_file_has_every_figure(kind: str, results: dict[str, list[Result]], tmp_path: object) -> None:
    """Read back from a file, a result has the figures that it had."""
    for result in results[kind]:
        page = report_of(result)
        header = header_of(page)
        panels = [panel for describe in figures_of(result).values() for panel in describe().panels]
        assert len(header["plots"]) == sum(panel.bars is None and panel.map is None for panel in panels)
        result.save(tmp_path / "result.nc")
        assert report_of_file(tmp_path / "result.nc") == page
