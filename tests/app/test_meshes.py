"""Meshes that are dropped on the page: their skin and groups, and the scenario that they become."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gbeam.scenario import template

from ..scenarios import FAST
from .conftest import Site

pytestmark = pytest.mark.usefixtures("reading_in_process")

meshio = pytest.importorskip("meshio")
BRACKET = Path(__file__).parents[2] / "examples" / "data" / "bracket.msh"
CLAMPED = {"mesh": "bracket.msh", "unit": "mm", "clamp": "screwed"}


def _dropped(site: Site, name: str, content: bytes) -> Any:
    return site.call("PUT", f"/api/records/{name}", site.opened, content=content)


def _used(site: Site, text: str, mesh: dict[str, Any], body: str = "bracket") -> dict[str, Any]:
    answer = site.call("POST", "/api/mesh", site.opened, json={"text": text, "body": body, "mesh": mesh})
    built: dict[str, Any] = answer.json()
    return built


def test_a_mesh_shows_its_skin_and_its_groups(site: Site) -> None:
    head = _dropped(site, "bracket.msh", BRACKET.read_bytes()).json()
    assert site.call("GET", "/api/records/bracket.msh", site.opened).json() == head
    skin = head["skin"]
    corners = np.reshape(skin["vertices"], (-1, 3))[np.reshape(skin["triangles"], (-1, 3))]
    # A closed surface: every edge has two faces.
    edges = np.sort(np.reshape(skin["triangles"], (-1, 3))[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    points = np.asarray(meshio.read(BRACKET).points)
    np.testing.assert_allclose([low, high], [points.min(axis=0), points.max(axis=0)], rtol=1e-5, atol=1e-4)
    groups = {each["name"]: each for each in skin["groups"]}
    assert list(groups) == ["screwed", "bracket", "camera"] and groups["screwed"]["nodes"] == 93
    # The screwed face is a plane.
    held = np.reshape(skin["vertices"], (-1, 3))[groups["screwed"]["vertices"]]
    assert np.ptp(held, axis=0).min() == 0.0


def test_a_mesh_becomes_the_specimen_of_a_new_scenario(site: Site) -> None:
    _dropped(site, "bracket.msh", BRACKET.read_bytes())
    built = _used(site, FAST, CLAMPED)
    data, before = tomllib.loads(built["text"]), tomllib.loads(FAST)
    assert data["bodies"] == {"bracket": CLAMPED} and "beam" not in data and data["motion"] == before["motion"]
    # What is still missing is said at its field.
    assert [each["field"] for each in built["errors"]] == ["bodies.bracket.damping_ratio"]
    body = {"text": built["text"], "path": "bodies.bracket.damping_ratio", "value": "2 %"}
    built = site.call("POST", "/api/edit", site.opened, json=body).json()
    assert [each["path"] for each in built["errors"]] == ["bodies.bracket"]
    assert "material is missing" in built["errors"][0]["message"]
    metal = 'material = { density = "2700 kg/m^3", youngs_modulus = "70 GPa", poissons_ratio = 0.33 }  # a comment\n'
    text = built["text"].replace("[bodies.bracket]\n", f"[bodies.bracket]\n{metal}")
    whole = site.call("POST", "/api/document", site.opened, json={"text": text}).json()
    assert whole["errors"] == [] and "bracket   solid" in whole["meaning"]
    # Another clamp changes that alone.
    changed = _used(site, text, {**CLAMPED, "clamp": ["screwed", "camera"]})
    assert changed["text"] == text.replace('clamp = "screwed"', 'clamp = ["screwed", "camera"]')
    other = _used(site, text, {**CLAMPED, "clamp": "hole"})["errors"]
    assert [each["path"] for each in other] == ["bodies.bracket.clamp"] and "choose from screwed" in other[0]["hint"]


def test_a_mesh_is_another_body_of_a_system(site: Site) -> None:
    _dropped(site, "bracket.msh", BRACKET.read_bytes())
    before = template("system")
    built = _used(site, before, CLAMPED | {"damping_ratio": "1 %"})
    data = tomllib.loads(built["text"])
    assert data["bodies"].pop("bracket")["clamp"] == "screwed" and data == tomllib.loads(before)


SQUARE = [[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("empty.inp", b"", "is empty"),
        ("nodes.inp", b"*ELEMENT, TYPE=C3D4\n", "has no solid elements"),
        ("bad.vtk", b"nothing of the kind\n", "cannot be read"),
        ("part.step", b"ISO-10303-21;\n", "cannot be read"),
    ],
)
def test_what_is_no_mesh_of_a_solid_is_refused(
    site: Site, tmp_path: Path, name: str, content: bytes, said: str
) -> None:
    """And is not kept, where the file of that name before stays."""
    for before in ([], [name]):
        answer = _dropped(site, name, content)
        (error,) = answer.json()["errors"]
        assert answer.status_code == 422 and said in error["message"] and str(tmp_path) not in error["message"]
        assert site.call("GET", "/api/records", site.opened).json() == before
        (tmp_path / "records" / name).write_bytes(b"before")
    assert (tmp_path / "records" / name).read_bytes() == b"before"
    assert [each.name for each in (tmp_path / "records").iterdir()] == [name]


def test_other_files_of_scenarios_are_kept(site: Site, tmp_path: Path) -> None:
    """Nodes without elements, matrices, a body and a section of other programs, which are no records and no meshes."""
    examples = BRACKET.parent
    np.savez(tmp_path / "model.npz", M=np.eye(3), K=np.eye(3))
    (tmp_path / "nodes.inp").write_text("*NODE\n1, 0.0, 0.0, 0.0\n")
    files = [examples / "strip.sid", tmp_path / "model.npz", tmp_path / "nodes.inp"]
    for file in files:
        answer = _dropped(site, file.name, file.read_bytes())
        assert answer.json() == {"name": file.name, "columns": [], "suggested": {}}
    assert set(site.call("GET", "/api/records", site.opened).json()) == {file.name for file in files}


def test_a_mesh_of_shells_is_a_thin_sheet(site: Site, tmp_path: Path) -> None:
    mesh = meshio.Mesh(SQUARE, {"triangle": [[0, 1, 2], [0, 2, 3]]}, point_sets={"edge": np.array([0, 1])})
    meshio.write(tmp_path / "flat.inp", mesh)
    skin = _dropped(site, "flat.inp", (tmp_path / "flat.inp").read_bytes()).json()["skin"]
    assert len(skin["vertices"]) == 3 * 8 and len(skin["triangles"]) == 3 * 12
    (edge,) = (each for each in skin["groups"] if each["name"] == "edge")
    assert edge["nodes"] == 2 and len(edge["vertices"]) == 4


def test_a_group_that_only_a_number_names_and_a_set_of_nodes(site: Site, tmp_path: Path) -> None:
    points = [*SQUARE, *([x, y, 1.0] for x, y, _ in SQUARE)]
    cube = meshio.Mesh(points, {"hexahedron": [range(8)]}, point_sets={"floor": np.arange(4), "all": np.arange(8)})
    meshio.write(tmp_path / "cube.inp", cube)
    skin = _dropped(site, "cube.inp", (tmp_path / "cube.inp").read_bytes()).json()["skin"]
    assert [(each["name"], each["nodes"], each["vertices"]) for each in skin["groups"]] == [
        ("floor", 4, [0, 1, 2, 3]),
        ("all", 8, [0, 1, 2, 3, 4, 5, 6, 7]),
    ]
    numbered = meshio.Mesh(points, {"hexahedron": [range(8)]}, cell_data={"part": [[7]]})
    meshio.write(tmp_path / "cube.vtk", numbered)
    skin = _dropped(site, "cube.vtk", (tmp_path / "cube.vtk").read_bytes()).json()["skin"]
    assert [each["name"] for each in skin["groups"]] == ["7"] and len(skin["triangles"]) == 36


@pytest.mark.parametrize("key", ["mesh", "coarser"])
@pytest.mark.parametrize("name", ["/etc/hostname", "../bracket.msh", "other.msh"])
def test_files_of_bodies_are_those_of_the_folder(site: Site, key: str, name: str) -> None:
    _dropped(site, "bracket.msh", BRACKET.read_bytes())
    built = _used(site, FAST, {**CLAMPED, "damping_ratio": "1 %", key: name})
    assert [each["path"] for each in built["errors"]] == [f"bodies.bracket.{key}"]
    text = f'[bodies.b]\nmatrices = ["bracket.msh", "{name}"]\n'
    said = site.call("POST", "/api/document", site.opened, json={"text": text}).json()["errors"]
    assert [each["path"] for each in said] == ["bodies.b.matrices"]
    options = [f"over=bodies.bracket.{key}={name}", "measure=flight.tip.size.max_abs"]
    body = {"text": built["text"], "verb": "sweep", "options": options}
    assert site.call("POST", "/api/runs", site.opened, json=body).status_code == 422


def test_the_example_of_a_bracket_has_a_form(site: Site) -> None:
    text = BRACKET.parents[1].joinpath("bracket.toml").read_text(encoding="utf-8").replace("data/", "")
    for file in ("bracket.msh", "f16_8g_turn.csv"):
        _dropped(site, file, BRACKET.with_name(file).read_bytes())
    built = site.call("POST", "/api/document", site.opened, json={"text": text}).json()
    assert built["errors"] == []
    bodies = next(each for each in built["form"] if each["path"] == "bodies")["inside"]
    keys = {each["key"]: each.get("value") for each in bodies[0]["inside"]}
    assert bodies[0]["choice"] == "solid" and keys["clamp"] == "screwed" and keys["mesh"] == "bracket.msh"
