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

from gbeam import Comparison, InputError, Response, Rest, Study
from gbeam.figures import figure_of, figures_of
from gbeam.plots import BROAD, draw, write_figures
from gbeam.report import report_of, report_of_file
from gbeam.results import (
    AxesResult,
    Base,
    BodyRest,
    HubResult,
    LimitUse,
    LoadDifference,
    Loads,
    MachinePlan,
    RootHistory,
    RootLoads,
    Shock,
    declarations,
)

from ..responses import with_body


def _plot(result: object, what: str, title: str = "") -> Figure:
    return draw(figure_of(result, what, title))


def plot_axes(of: Response, axes: AxesResult, quantity: str, title: str = "") -> Figure:
    return _plot(replace(of, axes=axes), f"axes_{quantity}", title)


def plot_tracking(of: Response, axes: AxesResult, title: str = "") -> Figure:
    return _plot(replace(of, axes=axes), "tracking", title)


def plot_hub(of: Response, hub: HubResult, title: str = "") -> Figure:
    return _plot(replace(of, hub=hub), of.environment, title)


def plot_tip(study: Study) -> Figure:
    return _plot(study, "tip")


def plot_base(of: Response, title: str = "") -> Figure:
    return _plot(of, "base", title)


def plot_comparison(compared: Comparison, title: str = "") -> Figure:
    return _plot(compared, "parts", title)


def plot_shock(compared: Comparison, shock: Shock, title: str = "") -> Figure:
    return _plot(replace(compared, shock=shock), "shock", title)


def _assert_labelled(figure: Figure) -> None:
    assert all(panel.get_ylabel() for panel in figure.axes)
    assert "," in figure.axes[-1].get_ylabel()  # quantity, unit
    assert figure.axes[-1].get_xlabel() == "time, s"


@pytest.fixture(scope="module")
def files(study: Study, tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """All figures of the study, written once; matplotlib's settings are as they were."""
    settings = dict(mpl.rcParams)
    told: list[tuple[str, float]] = []
    written = write_figures(figures_of(study), tmp_path_factory.mktemp("plots"), "", lambda *news: told.append(news))
    assert dict(mpl.rcParams) == settings
    assert told[1][0] == f"drawing {written[2].stem}" and np.isclose(told[1][1], 2 / len(written))
    return written


def test_files(files: list[Path]) -> None:
    names = {"tip", "base_flight", "base_spin", "base_slew", "tracking_spin", "hub_slew"}
    names |= {f"axes_{each}_spin" for each in ("rate", "acceleration", "jerk")}
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
    assert channels == 4 and pixels[0, 0].tolist() == [1, 1, 1, 1] and pixels.min() < 0.1
    size = [float(drawing.attrib[name].removesuffix("pt")) for name in ("width", "height")]
    np.testing.assert_allclose(np.array(size) * 150 / 72, [width, height], atol=1)
    svg = "{http://www.w3.org/2000/svg}"
    clipped = [each for each in drawing.iter(f"{svg}path") if "clip-path" in each.attrib]
    assert len(clipped) >= 4  # three responses, and the difference
    clips = [box for clip in drawing.iter(f"{svg}clipPath") for box in clip.iter(f"{svg}rect")]
    boxes = [[float(box.attrib[key]) for key in ("x", "y", "width", "height")] for box in clips]
    assert boxes
    for x, y, wide, high in boxes:
        assert x > 0 and y > 0 and x + wide < size[0] and y + high < size[1]


def _inside(figure: Figure, panel: Axes) -> bool:
    figure.draw_without_rendering()
    box = panel.get_tightbbox()
    return box.x0 >= 0 and box.y0 >= 0 and box.x1 <= figure.bbox.x1 and box.y1 <= figure.bbox.y1


def test_nothing_leaves_the_figure_or_covers_another_panel(study: Study) -> None:
    spin = study.responses["spin"]
    wide = replace(spin.axes, acceleration=-123456.7 * spin.axes.acceleration)
    for figure in (
        plot_axes(spin, wide, "acceleration", "t"),
        plot_tracking(spin, wide),
        plot_tip(study),
        plot_base(spin, "two\nlines"),
    ):
        assert all(_inside(figure, panel) for panel in figure.axes)
        boxes = [panel.get_tightbbox() for panel in figure.axes]
        assert all(above.y0 >= below.y1 for above, below in pairwise(boxes))
        title = figure.texts[0].get_window_extent()
        assert title.y0 >= boxes[0].y1 and title.y1 <= figure.bbox.y1


def _lines(panel: Axes) -> dict[str, np.ndarray]:
    return {line.get_label(): line.get_ydata() for line in panel.get_lines()}


def _shaded(panel: Axes) -> dict[str, list[tuple[float, float]]]:
    """Shaded stretches by their reason; those that the legend does not name begin with an underscore."""
    return {
        each.get_label(): [(path.vertices[:, 0].min(), path.vertices[:, 0].max()) for path in each.get_paths()]
        for each in panel.collections
    }


def test_tip(study: Study) -> None:
    figure = plot_tip(study)
    _assert_labelled(figure)
    z, z_off, y, _, x, x_off = figure.axes  # the largest first
    assert [panel.get_ylabel() for panel in (z, y, x)] == ["z, mm", "y, mm", "x, mm"]
    assert z_off.get_ylabel() == "difference in z, mm" and x_off.get_ylabel() == "difference in x, µm"
    assert "not drawn" not in figure.get_suptitle()
    lines = _lines(z)
    assert list(lines) == ["flight", "spin", "slew"]
    np.testing.assert_array_equal(lines["spin"], 1e3 * study.responses["spin"].tip[:, 2])
    np.testing.assert_array_equal(*(each[0].get_ydata() for each in (y.get_lines()[1:2], y.get_lines()[2:3])))
    np.testing.assert_array_equal(z_off.get_lines()[0].get_ydata(), 1e3 * study.comparisons[0].difference[:, 2])
    spans = {"spin-up": [(0.0, 0.1)], "below idle": [(0.5, 0.8)], "spin-down": [(1.9, 2.0)]}
    assert _shaded(z) == spans == {key[1:]: each for key, each in _shaded(x_off).items()}


def _with_two_bodies(response: Response) -> Response:
    """The same with two bodies, of which the first alone has loads."""
    left = with_body(response, loads=replace(_loads(response.time, 2), yield_strength=None)).body
    right = with_body(response, displacement=2 * response.displacement).body
    points = tuple(f"{name}.{point}" for name in ("left", "right") for point in ("tip", "root"))
    twice = [
        replace(of, points=points, **{
            name: np.concatenate([getattr(of, name)] * 2, axis=each.dims.index("point"))
            for name, each in declarations(type(of))
            if "point" in each.dims and isinstance(getattr(of, name), np.ndarray) and name != "residual_size"
        })
        for of in (response.maxima, response)
    ]  # fmt: skip
    return replace(twice[1], bodies={"left": left, "right": right}, maxima=twice[0])


def test_figures_follow_from_what_a_response_holds(study: Study) -> None:
    flight, slew = (study.responses[name] for name in ("flight", "slew"))
    assert [*figures_of(flight)] == ["tip", "base"]
    assert [*figures_of(slew)] == ["tip", "base", "hub"]
    turning = replace(slew, base=None, coordinates=("hinge.angle", "beam.q1", "beam.q2"), units=("rad", "", ""))
    assert [*figures_of(turning)] == ["tip", "base", "hub"]  # which shows the hinge's angle
    jointed = replace(turning, hub=None)
    assert [*figures_of(jointed)] == ["tip", "coordinates"]
    two = _with_two_bodies(flight)
    names = [*figures_of(two)]
    assert [name for name in names if name not in ("points", "base")] == ["tip left", "tip right", "loads left"]
    (z, _, _) = figures_of(two)["tip right"]().panels
    np.testing.assert_array_equal(z.lines[0].y, 2e3 * flight.tip[:, 2])
    assert "tip displacement of right relative to its root" in figures_of(two)["tip right"]().heading


def test_a_difference_stands_with_the_tip_that_it_is_of(study: Study) -> None:
    both = {name: _with_two_bodies(each) for name, each in study.responses.items()}
    (compared,) = study.comparisons
    of = replace(study, responses=both, comparisons=(replace(compared, point="right.tip"),))
    shown = {name: [panel.y for panel in figures_of(of)[f"tip {name}"]().panels] for name in ("left", "right")}
    assert not any("difference" in label for label in shown["left"]) and "difference in z, mm" in shown["right"]
    assert "comparison spin" not in figures_of(of)
    apart = replace(of, comparisons=(replace(compared, point="left.root"),))
    assert "comparison spin" in figures_of(apart)  # a figure of its own


def test_bodies_in_a_file_keep_their_loads_apart(study: Study, tmp_path: Path) -> None:
    two = Study("", {"flight": _with_two_bodies(study.responses["flight"])}, ())
    two.save(tmp_path / "result.nc")
    assert report_of_file(tmp_path) == report_of(two)


def test_a_direction_that_hardly_moves_is_named(study: Study) -> None:
    flight = study.responses["flight"]
    wave = flight.displacement * [0.05, 1.0, 1.0]  # x: 5 µm of 1 mm
    still = with_body(flight, displacement=wave, peaks=replace(flight.peaks, max_abs=np.abs(wave[:, 0]).max(axis=0)))
    figure = plot_tip(Study("", {"flight": still}, ()))
    assert [panel.get_ylabel() for panel in figure.axes] == ["z, mm", "y, mm"]
    assert figure.get_suptitle().endswith("(not drawn: x by 5 µm at most)\nestimated error: 0.001 %")


def test_flight_is_seen_below_what_imitates_it(study: Study) -> None:
    spin = study.responses["spin"]
    figures = plot_tip(study), plot_tracking(spin, spin.axes), plot_comparison(_with_root(study))
    for figure in figures:
        by_name = {line.get_label(): line for line in figure.axes[0].get_lines()}
        flown, machine = by_name["flight"], by_name.get("spin", by_name.get("machine"))
        assert flown.get_linewidth() == BROAD >= 3 * machine.get_linewidth()
        assert flown.get_zorder() < machine.get_zorder() and flown.get_color() != machine.get_color()


def test_a_constant_is_seen_at_its_size(study: Study) -> None:
    flight = study.responses["flight"]
    constant = with_body(flight, displacement=np.full_like(flight.displacement, -1.7e-3))
    panel = plot_tip(Study("", {"flight": constant}, ())).axes[0]
    low, high = panel.get_ylim()
    assert low < -1.7 and high > 0


def test_base_shows_turning_only_where_it_turns(study: Study) -> None:
    assert len(plot_base(study.responses["flight"], "").axes) == 1
    figure = plot_base(study.responses["spin"], "")
    assert len(figure.axes) == 3
    _assert_labelled(figure)


def test_axes(study: Study) -> None:
    """A panel for each axis, with the limits that are near and the others named; shaded from spin-up to spin-down."""
    spin = study.responses["spin"]
    figure = plot_axes(spin, spin.axes, "acceleration", "t")
    _assert_labelled(figure)
    arm, yaw, roll = figure.axes
    np.testing.assert_array_equal(arm.get_lines()[0].get_ydata(), spin.axes.acceleration[:, 0])
    assert [line.get_ydata()[0] for line in arm.get_lines()[1:]] == [9.0]  # the arm only speeds up
    assert arm.get_ylim()[1] > 9 and [line.get_ydata()[0] for line in yaw.get_lines()[1:]] == [-2.5]
    assert len(roll.get_lines()) == 1 and roll.get_title(loc="left").endswith("of 100 rad/s², beyond the panel")
    spans = {"spin-up": [(0.0, 0.1)], "below idle": [(0.505, 0.795)], "spin-down": [(1.9, 2.0)]}
    assert _shaded(arm) == spans and all(key.startswith("_") for key in _shaded(roll))
    assert {text.get_text() for text in arm.get_legend().get_texts()} == {"limit", *spans}
    jerk = plot_axes(spin, spin.axes, "jerk").axes
    assert [panel.get_ylabel() for panel in jerk] == ["jerk, rad/s³"] * 3


def test_power_limits_the_arms_acceleration(study: Study) -> None:
    spin = study.responses["spin"]
    rate, acceleration = spin.axes.rate[:, 0], spin.axes.acceleration[:, 0]
    power = 7.0 * rate * acceleration  # 7 kg m²
    use = LimitUse("arm", "power", "W", power.max(), 50.0, 1.0)
    arm = plot_axes(spin, replace(spin.axes, limits=(use,)), "acceleration").axes[0]
    bound = _lines(arm)["limit of the power"]
    near = bound < 9 * np.abs(acceleration).max()
    assert near.any()
    np.testing.assert_allclose(7.0 * np.abs(rate * bound)[near], 50.0)


def test_tracking(study: Study) -> None:
    spin = study.responses["spin"]
    figure = plot_tracking(spin, replace(spin.axes, idle=14.0), "t")
    _assert_labelled(figure)
    size, z, error = figure.axes
    assert list(_lines(size)) == ["flight", "target", "machine", "idle"]
    flown = next(line for line in size.get_lines() if line.get_label() == "flight").get_xdata()
    assert (flown[0], flown[-1]) == pytest.approx(spin.axes.span)  # between spin-up and spin-down
    np.testing.assert_allclose(_lines(size)["machine"], spin.axes.actual[:, 2] / 9.80665)
    assert z.get_ylabel() == "z, g" and error.get_ylabel() == "tracking error, g"
    # Scaled to what is followed: 0.6 m/s² at the end, not the 9 m/s² where the target is held.
    assert error.get_ylim()[1] == pytest.approx(0.63 / 9.80665) and all(_shaded(panel) for panel in figure.axes)


def test_hub_without_a_torque(study: Study) -> None:
    slew = study.responses["slew"]
    assert len(plot_hub(slew, slew.hub, "").axes) == 3
    arguments = replace(slew.hub, drive_torque=None)
    assert len(plot_hub(slew, arguments, "").axes) == 2


def test_what_diverged_says_so(study: Study) -> None:
    diverged = replace(study.responses["slew"], outcome="diverged")
    for figure in (plot_tip(Study("t", {"slew": diverged}, ())), plot_hub(diverged, diverged.hub, "t")):
        assert figure.get_suptitle().startswith("DIVERGED – t\n")


def test_comparison(study: Study) -> None:
    compared = study.comparisons[0]
    gradient = np.outer(np.linspace(0, -4, len(compared.time)), [1.0, 2.0, 3.0])
    bounds = {name: np.array([1e-6, 2e-6, 3e-6]) for name in ("tip_bound", "force_bound", "moment_bound")}
    most = np.abs(gradient).max(axis=0)
    full = replace(compared, load_difference=LoadDifference(0.1, gradient, most, 0.2 * most, **bounds, length=0.3))
    (panel,) = plot_comparison(full, "t").axes
    lines = _lines(panel)
    np.testing.assert_allclose(lines["at the root"], -0.1 * gradient[:, 2])
    np.testing.assert_allclose(lines["at the tip"], 0.2 * gradient[:, 2])
    assert _shaded(panel) == {"below idle": [(0.5, 0.8)]}
    (panel,) = full.plot("parts y")
    np.testing.assert_allclose(_lines(panel)["at the root"], -0.1 * gradient[:, 1])

    spectra = np.outer(np.arange(1.0, 6.0), [1, 1, 2])
    shock = Shock(10.0, np.geomspace(1, 100, 5), spectra, 2 * spectra)
    drawn = plot_shock(full, shock, "t").axes
    assert len(drawn) == 3  # in the order of the figures: the axis that moves most first
    assert drawn[0].get_xscale() == drawn[0].get_yscale() == "log"
    np.testing.assert_allclose(_lines(drawn[0])["flight"], spectra[:, 2] / 9.80665)
    np.testing.assert_allclose(_lines(drawn[0])["spin"], 2 * spectra[:, 2] / 9.80665)
    assert drawn[0].get_ylabel().endswith(", g")
    beside = replace(shock, flight=spectra * [1, 0, 0], centrifuge=spectra * [1, 0, 0])  # of a sensor that is turned
    (only,) = plot_shock(full, beside, "t").axes
    np.testing.assert_allclose(_lines(only)["flight"], spectra[:, 0] / 9.80665)


def _with_root(study: Study) -> Comparison:
    compared = study.comparisons[0]
    t = compared.time
    history = RootHistory(*(np.outer(k + np.sin(t), [1.0, 2.0, 3.0]) for k in range(4)))
    root = RootLoads(*(np.arange(3.0) + k for k in range(6)), 1.0, 2.0, 3.0, history)
    return replace(compared, root=root)


def test_comparison_with_root_loads_or_without_parts(study: Study) -> None:
    compared = _with_root(study)
    history = compared.root.history
    shear, moment = compared.plot(title="t")
    np.testing.assert_array_equal(_lines(shear)["spin"], history.force_centrifuge[:, 2])
    np.testing.assert_array_equal(_lines(shear)["flight"], history.force_flight[:, 2])
    # What moves along z bends about y.
    assert moment.get_ylabel() == "moment about y, N m"
    np.testing.assert_array_equal(_lines(moment)["flight"], history.moment_flight[:, 1])
    (alone,) = replace(compared, root=None).plot()
    np.testing.assert_array_equal(alone.get_lines()[0].get_ydata(), 1e3 * compared.difference[:, 2])


def _loads(t: np.ndarray, stations: int) -> Loads:
    """Random, of two stations or more; section and base axes differ."""
    random = np.random.default_rng(5)
    return Loads(
        np.linspace(0, 0.3, stations),
        *(random.standard_normal((len(t), stations, 3)) for _ in range(4)),
        1e6 * random.random((len(t), stations)),
        -1e6 * random.random((len(t), stations)),
        random.standard_normal((len(t), stations, 3)),
        yield_strength=1.2e6,
    )


def test_loads_have_the_signs_of_the_comparison(study: Study) -> None:
    """Of the section, in both: positive where the fibre is stretched."""
    spin = study.responses["spin"]
    loads = _loads(spin.time, 2)
    force, moment, stress = _plot(with_body(spin, loads=loads), "loads").axes
    assert [panel.get_ylabel() for panel in (force, moment, stress)] == ["force, N", "moment, N m", "stress, MPa"]
    for panel, names, values in (
        (force, ("axial N", "shear V_y", "shear V_z"), loads.section_force),
        (moment, ("torque", "bending M_y", "bending M_z"), loads.section_moment),
    ):
        for i, name in enumerate(names):
            np.testing.assert_array_equal(_lines(panel)[name], values[:, 0, i])
    assert _lines(stress)["yield strength"][0] == pytest.approx(1.2)
    assert {"spin-up", "below idle", "spin-down"} <= set(_shaded(force))


def at_rest(name: str, base: Base, x: np.ndarray, moved: np.ndarray, loads: Loads | None = None) -> Rest:
    """A beam at rest, displaced so."""
    body = BodyRest("FOAM", base, x, moved, np.zeros(3), 0.0, loads)
    tip, still, none = ("beam.tip",), np.zeros((1, 4)), np.zeros(3)
    return Rest(
        name, 0.0, base, tip, ("beam.q1",), ("",), moved[-1:], moved[-1:], still, none, none, True, none, none,
        {"beam": body},
    )  # fmt: skip


def test_several_at_rest_are_all_seen(study: Study) -> None:
    base, x = study.responses["spin"].base, np.linspace(0, 40.0, 5)  # a long blade
    rest = [at_rest(name, base, x, np.outer(x, [0.0, 1e-4, 0.05])) for name in ("flight", "spin")]
    (panel,) = _plot(rest, "static").axes
    assert (panel.get_xlabel(), panel.get_ylabel()) == ("position from the root, m", "z, m")
    wide, thin = panel.get_lines()
    assert wide.get_linewidth() > 3 * thin.get_linewidth() and wide.get_zorder() < thin.get_zorder()


def test_a_result_draws_itself(study: Study) -> None:
    spin = study.responses["spin"]
    assert "tip displacement" in spin.plot(title="mine").figure.get_suptitle()
    assert "rate of the machine's axes" in spin.plot("axes_rate").figure.get_suptitle()
    assert study.plot().figure.get_suptitle().startswith("a title\n")
    hub = study.plot("hub slew")
    assert isinstance(hub, tuple) and list(hub) == hub.figure.axes and "the hub" in hub.figure.get_suptitle()
    assert hub._repr_png_()[:8] == b"\x89PNG\r\n\x1a\n"  # a notebook shows them
    with pytest.raises(InputError, match="choose from tip, base, tracking, axes_rate"):
        spin.plot("loads")
    accounting = study.comparisons[0].accounting
    plan = MachinePlan("spin", "flight", 3.3, "done", "", spin.time, spin.axes, accounting, 9.80665, "upright")
    assert len(plan.plot()) == 3 and len(plan.plot("axes_jerk")) == 3
    x = np.linspace(0, 0.3, 5)
    along = Loads(x, *(np.ones((1, 5, 3)) for _ in range(4)), *np.ones((2, 1, 5)), np.ones((1, 5, 3)))
    moved = np.outer(x, [0.0, 1.0, 2.0])
    rest = at_rest("flight", spin.base, x, moved, along)
    assert [len(rest.plot(what)) for what in ("", "static", "loads flight")] == [2, 2, 3]
