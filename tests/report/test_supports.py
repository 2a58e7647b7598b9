"""Supports as figures, pages and descriptions show them: where they are, and what they hold."""

from __future__ import annotations

from typing import Any

import meshio
import numpy as np
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
    assert told(part) == [
        ("0 mm", "holds x y z rx rz", "x y z rx rz", "", [0, 0, 0]),
        ("400 mm", "holds y, spring z ry, damper z", "y", "z ry", [0.4, 0, 0]),
    ]
    pin, bearing = part["supports"]
    assert bearing["extents"] == pytest.approx([0, 0.02, 0.004]) and bearing["size"] == pytest.approx(LENGTH)
    assert (pin["beyond"], bearing["beyond"]) == ([False, False, False], [True, False, False])
    assert rest.body.supports is not None
    moved, carried = rest.body.supports.displacement[0], rest.loads
    assert carried is not None and carried.support_force is not None
    pull = carried.support_force[0, 0, 2]
    assert np.abs(moved[0]).max() < 1e-3 * np.abs(moved[1]).max()
    assert moved[1, 2] == pytest.approx(-pull / BEARING.stiffness["z"], rel=1e-2)
    assert any(each.get("supports") for each in header["plots"][-1]["series"])


def told(part: Any) -> list[tuple[Any, ...]]:
    """Names of the supports of a part of the scene, what they hold, and where."""
    keys = ("name", "words", "rigid", "yielding", "place")
    return [tuple(support[key] for key in keys) for support in part["supports"]]


def on_springs(kind: str) -> gb.Structure:
    """A plate of shells, matrices of a mass on a stalk, or a box on feet, sprung along z at its first support."""
    spring = {"z": 2e4}
    if kind == "mesh":
        edge = np.linspace(0, 0.2, 5)
        nodes = np.array([(x, y, 0.0) for x in edge for y in edge])
        corner = (5 * np.arange(4)[:, None] + np.arange(4)).ravel()
        groups = {"pad": np.arange(20, 25), "left": np.arange(5)}
        mesh = meshio.Mesh(nodes, [("quad", corner[:, None] + [0, 5, 6, 1])], point_sets=groups)
        metal, held = gb.Material(2700, 70e9, poissons_ratio=0.3), [gb.Support("pad", ["y"], spring)]
        plate = gb.SolidMesh.read(mesh, materials=metal, unit="m", thickness=2e-3, clamp="left", supports=held)
        return plate.reduced(modes=4, damping_ratio=0.02).structure
    if kind == "matrices":
        stalk = gb.ImportedModel(np.eye(3), np.diag([1e6, 1e4, 1e4]), [(0.3, 0.0, 0.0)])  # its foot is left out
        return stalk.reduced(modes=2, damping_ratio=0.02, supports=[gb.Support("tip", ["y"], spring)])
    feet = {"front": (0.15, 0, 0), "left": (-0.15, 0.1, 0), "right": (-0.15, -0.1, 0)}
    ways: dict[str, list[Any]] = {"front": ["x", "y"], "left": ["x"], "right": []}
    held = [gb.Support(name, held, spring) for name, held in ways.items()]
    whole = gb.RigidSpecimen.box(3.0, (0.3, 0.2, 0.1), (0.0, 0.0, 0.05))
    return gb.RigidSpecimen(3.0, whole.centre, whole.inertia, whole.corners, points=feet, supports=held).structure


@pytest.mark.parametrize(("kind", "first"), [("mesh", "pad"), ("matrices", "tip"), ("box", "front")])
def test_places_held_move_by_what_their_springs_carry(kind: str, first: str) -> None:
    """At rest, over time and in modes; what is held rigidly stays where it is, in the middle of the nodes."""
    structure = on_springs(kind)
    rest = gb.static(structure, acceleration=(3.0, 2.0, 80.0))
    pulse = gb.Flight(z=gb.trapezoid(50.0, jerk=2e3, start=0.02, hold=0.05))
    response, modes = gb.simulate(structure, pulse, duration=0.2, estimate=False), gb.modes(structure)
    results: tuple[gb.Rest | gb.Response, ...] = (rest, response)
    for result in results:
        supports, loads = result.body.supports, result.body.loads
        assert supports is not None and loads is not None and loads.support_force is not None
        assert supports.name == loads.support_names and supports.name[0] == first
        pulls, moved = loads.support_force[..., 2], supports.displacement
        assert np.abs(moved[..., 2]).max() > 1e-5
        np.testing.assert_allclose(pulls, -2e4 * moved[..., 2], rtol=1e-3, atol=1e-4 * np.abs(pulls).max())
        assert np.abs(moved[:, 0, 1]).max() <= 1e-9 * np.abs(moved).max()
    body = modes.body
    assert body.supports is not None and body.support_shape is not None
    assert np.abs(body.support_shape[..., 2]).max() > 0.1
    assert np.abs(body.support_shape[:, 0, 1]).max() <= 1e-9 and not body.supports.displacement.any()
    word = "holds x y, spring z" if kind == "box" else "holds y, spring z"
    for shown, name in ((rest, "static"), (modes, "modes")):
        (note,) = (note for note in figures_of(shown)[name]().notes if note.startswith("supports"))
        assert note.startswith(f"supports: at {first} {word}")


def test_a_box_on_springs_is_drawn_as_it_moves() -> None:
    """Its farthest corner is its tip; the triangles of its faces point outwards, around its volume."""
    structure = on_springs("box")
    rest, modes = gb.static(structure, acceleration=(3.0, 2.0, 80.0)), gb.modes(structure)
    surface = rest.body.surface
    assert surface is not None and not surface.judged.any()
    faces = surface.vertices[surface.triangles]
    assert np.linalg.det(faces).sum() / 6 == pytest.approx(0.3 * 0.2 * 0.1)
    moved = np.einsum("ts,sva->tva", surface.sizes, surface.shapes)[0]
    tip = np.linalg.norm(surface.vertices - structure.station_places.r0[-1], axis=1).argmin()
    np.testing.assert_allclose(moved[tip], rest.tip, atol=1e-2 * np.abs(rest.tip).max())
    in_modes: Any = modes.body.surface
    shape = np.einsum("ks,sa->ka", in_modes.sizes, in_modes.shapes[:, tip])
    np.testing.assert_allclose(shape, modes.shape[:, -1], atol=1e-9)
    assert gb.static(on_springs("matrices")).body.surface is None


def test_a_box_that_stands_rigidly_has_them_where_they_are() -> None:
    feet = {"a": (-0.15, -0.1, 0), "b": (0.15, -0.1, 0), "c": (0.0, 0.1, 0)}
    held = [gb.Support(name, ways) for name, ways in zip(feet, (["x", "y", "z"], ["y", "z"], ["z"]), strict=True)]  # type: ignore[arg-type]
    whole = gb.RigidSpecimen.box(3.0, (0.3, 0.2, 0.1), (0.0, 0.0, 0.05))
    box = gb.RigidSpecimen(3.0, whole.centre, whole.inertia, whole.corners, points=feet, supports=held)
    supports = gb.static(box.structure, acceleration=(0.0, 0.0, 9.8)).body.supports
    assert supports is not None and supports.name == ("a", "b", "c")
    np.testing.assert_allclose(supports.place, list(feet.values()), atol=1e-15)
    assert not supports.displacement.any()
    (part,) = header_of(report_of(gb.static(box.structure)))["scene"]["motions"][0]["parts"]  # type: ignore[index]
    assert {"surface", "supports"} <= part.keys()


@pytest.mark.parametrize("kind", ["mesh", "matrices", "box"])
def test_the_viewer_has_them_of_every_body_at_rest_in_motion_and_in_modes(kind: str, tmp_path: Any) -> None:
    structure = on_springs(kind)
    response = gb.simulate(structure, gb.Flight(z=gb.constant(9.0)), duration=0.1, estimate=False)
    response.save(tmp_path / "response.nc")
    response.report(tmp_path / "response.html")
    over_time: Any = header_of((tmp_path / "response.html").read_text(encoding="utf-8"))["scene"]
    at_rest: Any = header_of(report_of(gb.static(structure, acceleration=(0.0, 0.0, 80.0))))["scene"]
    in_modes: Any = header_of(report_of(gb.modes(structure)))["modes"]
    places = {"mesh": [0.2, 0.1, 0.0], "matrices": [0.3, 0.0, 0.0], "box": [0.15, 0.0, 0.0]}
    for scene in (over_time, at_rest, in_modes):
        (part,) = scene["motions"][0]["parts"]
        _, words, _, yielding, place = told(part)[0]
        assert (words.startswith("holds"), yielding, place) == (True, "z", pytest.approx(places[kind]))
        support = part["supports"][0]
        assert support["beyond"][0] and support["extents"] == [0, 0, 0] and 0.2 <= support["size"] <= 0.5
        assert support["displacement"]["shape"][1:] == [3]


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
    assert told(part) == [(f"{1e3 * LENGTH:.4g} mm", "spring z", "", "z", pytest.approx([LENGTH, 0, 0]))]


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
