"""Groups that are numbers, elements that are there twice, and nodes that are not merged."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest

import gbeam as gb

from .bodies import STEEL, block

LENGTH, WIDTH, THICKNESS = 0.1, 0.02, 0.01


def numbered(path: Path, key: str, **options: Any) -> Path:
    """A cantilever of hexahedra, whose wall is surface 1 and whose elements are volume 1, without names."""
    bar = block("hexahedron20", (6, 1, 1), (LENGTH, WIDTH, THICKNESS))
    nodes = bar.cells[0].data
    wall = nodes[np.isclose(bar.points[nodes[:, 0], 0], 0.0)][:1, [0, 3, 7, 4]]
    cells = [("quad", wall), ("hexahedron20" if key.startswith("gmsh") else "hexahedron", nodes)]
    if key.startswith("medit"):  # it has no elements of 20 nodes
        cells[1] = ("hexahedron", nodes[:, :8])
    tags = [np.full(len(members), 1) for _, members in cells]
    data = {key: tags} | ({"gmsh:geometrical": tags} if key.startswith("gmsh") else {})
    meshio.write(path, meshio.Mesh(bar.points, cells, cell_data=data), **options)
    return path


@pytest.mark.parametrize(
    ("name", "key", "options"),
    [
        ("bar.msh", "gmsh:physical", {"file_format": "gmsh22", "binary": False}),
        ("binary.msh", "gmsh:physical", {"file_format": "gmsh22", "binary": True}),
        ("bar.mesh", "medit:ref", {}),
    ],
)
def test_a_number_of_a_surface_and_a_volume_is_refused(
    tmp_path: Path, name: str, key: str, options: dict[str, Any]
) -> None:
    """The fix that the message offers is taken, and holds the wall alone; materials name volumes only."""
    path = numbered(tmp_path / name, key, **options)
    with pytest.raises(gb.InputError, match=re.escape("clamp is '1', which is a surface and a volume")) as caught:
        gb.SolidMesh.read(path, materials=STEEL, clamp="1", unit="m")
    fix = re.findall(r'"(.*?)"', str(caught.value.fix))
    assert fix == ["surface 1", "volume 1"]
    held = gb.SolidMesh.read(path, materials={"1": STEEL}, clamp=fix[0], unit="m")
    assert (held.points[held.clamped, 0] == 0).all() and held.clamps == {"surface 1": 4}
    with pytest.raises(gb.InputError, match="holds all"):
        gb.SolidMesh.read(path, materials=STEEL, clamp=fix[1], unit="m")
    with pytest.raises(gb.InputError, match="choose from surface 1, volume 1"):
        gb.SolidMesh.read(path, materials=STEEL, clamp="screwed", unit="m")


def test_the_description_says_how_many_nodes_a_clamp_holds(tmp_path: Path) -> None:
    case = gb.read_scenario("examples/bracket.toml")
    assert next(iter(gb.describe(case).bodies.values())).clamps == {"screwed": "93 of 2,213 nodes"}


def cantilever(repeated: int = 0) -> meshio.Mesh:
    """A cantilever, some of whose elements are there twice."""
    bar = block("hexahedron20", (6, 1, 1), (LENGTH, WIDTH, THICKNESS))
    bar.cells[0].data = np.concatenate([bar.cells[0].data, bar.cells[0].data[:repeated]])
    return bar


def test_elements_on_the_nodes_of_others_are_refused() -> None:
    once = gb.SolidMesh.read(cantilever(), materials=STEEL, clamp="wall", unit="m")
    assert once.mass == pytest.approx(STEEL.density * LENGTH * WIDTH * THICKNESS)
    with pytest.raises(gb.InputError, match="mesh has 2 elements on the nodes of others: 7 on those of 1, 8 on those"):
        gb.SolidMesh.read(cantilever(2), materials=STEEL, clamp="wall", unit="m")
    turned = cantilever(1)  # the same corners in another order, and another kind
    last = turned.cells[0].data[-1, [1, 2, 3, 0, 5, 6, 7, 4]]
    whole = meshio.Mesh(
        turned.points,
        [("hexahedron20", turned.cells[0].data[:-1]), ("hexahedron", last[None])],
        point_sets=turned.point_sets,
    )
    with pytest.raises(gb.InputError, match="mesh has 1 element on the nodes of others: 7 on those of 1"):
        gb.SolidMesh.read(whole, materials=STEEL, clamp="wall", unit="m")


def test_nodes_at_one_place_that_are_not_merged_are_told() -> None:
    """A bar of two halves that both are clamped along their bottom, and do not hold together between them."""
    bar = cantilever()
    halves = bar.cells[0].data[:3], bar.cells[0].data[3:] + len(bar.points)
    seam = np.intersect1d(halves[0], halves[1] - len(bar.points))
    points = np.concatenate([bar.points, bar.points])
    bottom = {"bottom": np.flatnonzero(points[:, 2] == points[:, 2].min())}
    apart = meshio.Mesh(points, {"hexahedron20": np.concatenate(halves)}, point_sets=bottom)
    solid = gb.SolidMesh.read(apart, materials=STEEL, clamp="bottom", unit="m")
    (told,) = [warning for warning in solid.warnings if "one place" in warning]
    assert told.startswith(f"{len(seam)} pairs of nodes lie at one place and are not merged, such as ")
    first, second = map(int, re.findall(r"such as (\d+) and (\d+)", told)[0])
    np.testing.assert_array_equal(points[first - 1], points[second - 1])
    merged = gb.SolidMesh.read(cantilever(), materials=STEEL, clamp="wall", unit="m")
    assert not [warning for warning in merged.warnings if "one place" in warning]
