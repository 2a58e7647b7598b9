"""Supports as figures, pages and descriptions show them: where they are, and what they hold."""

from __future__ import annotations

from typing import Any

import pytest
from matplotlib.markers import CARETUP

import gbeam as gb
from gbeam.figures import figures_of
from gbeam.plots import draw
from gbeam.report import description_text as text
from gbeam.report import report_of

from .test_page import header_of

pytestmark = pytest.mark.usefixtures("reading_in_process")

LENGTH = 0.6
PIN = gb.Support(0.0, ["x", "y", "z", "rx", "rz"])
BEARING = gb.Support(0.4, ["y"], {"z": 2e4, "ry": 2.0}, {"z": 2.0})
WORDS = "supports: at 0 mm holds x y z rx rz; at 400 mm holds y, spring z ry, damper z"


def held() -> gb.Structure:
    section, metal = gb.Section.rectangle(0.02, 0.004), gb.Material(2700, 70e9, poissons_ratio=0.3)
    return gb.assemble(gb.Beam(LENGTH, section, metal, damping_ratio=0.01, supports=[PIN, BEARING]), "FOAM", y=3, z=3)


@pytest.fixture(scope="module")
def rest() -> gb.Rest:
    return gb.static(held(), acceleration=(0.0, 0.0, 80.0))


def test_figures_along_the_beam_have_symbols_where_it_is_held(rest: gb.Rest) -> None:
    """In the direction z both supports hold, along the beam the pin alone."""
    described = figures_of(rest)["static"]()
    assert WORDS in described.notes
    along = {
        panel.y[0]: [each.x.tolist() for each in panel.lines if each.marks == "supports"] for panel in described.panels
    }
    assert along["z"] == [[0.0, 400.0]] and along.get("x", [[0.0]]) == [[0.0]]
    symbols = [line for line in draw(described).axes[-1].lines if line.get_marker() == CARETUP]
    assert [line.get_xdata().tolist() for line in symbols] == [[0.0, 400.0]]
    assert not any(line.marks == "supports" for line in figures_of(gb.static(free()))["static"]().panels[0].lines)


def free() -> gb.Structure:
    return gb.assemble(gb.Beam(LENGTH, gb.Section.rectangle(0.02, 0.004), gb.Material(2700, 70e9)), "FOAM", z=3)


def test_loads_and_modes_have_them_too(rest: gb.Rest) -> None:
    for result, name in ((rest, "loads"), (gb.modes(held()), "modes")):
        described = figures_of(result)[name]()
        assert WORDS in described.notes
        for panel in described.panels:
            assert [each.x.tolist() for each in panel.lines if each.marks == "supports"] == [[0.0, 400.0]]


def test_the_page_hands_them_to_the_viewer(rest: gb.Rest) -> None:
    header: Any = header_of(report_of(rest))
    (part,) = header["scene"]["motions"][0]["parts"]
    assert part["beam"]["supports"] == [
        {"words": "holds x y z rx rz", "rigid": "x y z rx rz", "yielding": "", "at": 0.0},
        {"words": "holds y, spring z ry, damper z", "rigid": "y", "yielding": "z ry", "at": 0.4},
    ]
    assert any(each.get("supports") for each in header["plots"][-1]["series"])


def test_springs_alone_are_read_from_files(rest: gb.Rest, tmp_path: Any) -> None:
    """A column of empty words, that nothing is rigid, is one, too."""
    spring = gb.Support(LENGTH, stiffness={"z": 1e4})
    section, metal = gb.Section.rectangle(0.02, 0.004), gb.Material(2700, 70e9)
    sprung = gb.assemble(gb.Beam(LENGTH, section, metal, damping_ratio=0.01, supports=[spring]), "FOAM", z=3)
    response = gb.simulate(sprung, gb.Flight(z=gb.constant(9.0)), duration=0.1)
    response.save(tmp_path / "response.nc")
    response.report(tmp_path / "response.html")
    header: Any = header_of((tmp_path / "response.html").read_text(encoding="utf-8"))
    (part,) = header["scene"]["motions"][0]["parts"]
    assert part["beam"]["supports"] == [{"words": "spring z", "rigid": "", "yielding": "z", "at": LENGTH}]


def test_a_description_says_what_is_held(tmp_path: Any) -> None:
    (tmp_path / "strip.toml").write_text(
        """
[beam]
length = "600 mm"
section = { shape = "rectangle", width = "20 mm", thickness = "4 mm" }
material = { density = "2700 kg/m^3", youngs_modulus = "70 GPa" }
supports = [ { at = "600 mm", holds = ["y"], stiffness = { z = "5 N/mm" } }, { at = "600 mm", holds = ["rz"] } ]
[model]
kind = "FOAM"
""",
        encoding="utf-8",
    )
    described = gb.describe(gb.read_scenario(tmp_path / "strip.toml"))
    assert described.bodies["beam"].supports == {"600 mm": "holds y, spring z; holds rz"}
    assert "supports at 600 mm holds y, spring z; holds rz" in text(described)


def test_reactions_are_drawn_over_time_with_their_peaks_and_errors() -> None:
    """The pin has none, for it is the root; where a support gives no moment there is no panel of it."""
    strip = gb.Beam(
        LENGTH,
        gb.Section.rectangle(0.02, 0.004),
        gb.Material(2700, 70e9, poissons_ratio=0.3),
        damping_ratio=0.01,
        supports=[PIN, BEARING, gb.Support(LENGTH, ["z"])],
    )
    flight = gb.Flight(z=gb.trapezoid(50.0, jerk=2e3, start=0.02, hold=0.05))
    response = gb.simulate(gb.assemble(strip, "FOAM", y=3, z=3), flight, duration=0.2)
    described = figures_of(response)["supports"]()
    assert [panel.y for panel in described.panels] == [
        "force at 400 mm, N",
        "moment at 400 mm, mN m",
        "force at 600 mm, N",
    ]
    loads, peaks = response.loads, response.peaks.loads
    assert loads is not None and loads.support_force is not None and peaks is not None
    assert peaks.support_force is not None
    (line,) = described.panels[2].lines
    assert line.y.tolist() == loads.support_force[:, 1, 2].tolist()
    largest = peaks.support_force.size
    assert f"force at 600 mm up to {largest.value[1]:.4g} N at {largest.time[1]:.4g} s" in described.notes[0]
    assert described.notes[-1].startswith("estimated error: loads ")
    study = gb.Study("", {"first": response, "second": response})
    words = [panel.y for panel in figures_of(study)["sizes"]().panels]
    assert words[3:] == ["support force at 400 mm, N", "support moment at 400 mm, mN m", "support force at 600 mm, N"]


def test_a_body_is_judged_by_the_point_that_moves_farthest_where_its_tip_is_held() -> None:
    """The page begins when that point is farthest; a beam whose tip moves is judged by it."""
    flight = gb.Flight(z=gb.trapezoid(50.0, jerk=2e3, start=0.02, hold=0.05))
    section, metal = gb.Section.rectangle(0.02, 0.004), gb.Material(2700, 70e9)
    for supports, name in (([gb.Support(LENGTH, ["z"])], "span"), ([gb.Support(0.3, stiffness={"z": 1e3})], "")):
        strip = gb.Beam(LENGTH, section, metal, damping_ratio=0.01, supports=supports)
        response = gb.simulate(gb.assemble(strip, "FOAM", z=3), flight, duration=0.2, estimate=False)
        assert response.body.farthest == name
        if name:
            header: Any = header_of(report_of(gb.Study("", {"flight": response})))
            time = response.body.peaks.displacement.size.time[0]  # type: ignore[union-attr]
            assert header["scene"]["start"] == pytest.approx(time, abs=2e-3)
