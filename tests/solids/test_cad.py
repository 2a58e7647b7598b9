"""Solids of STEP files, meshed by Gmsh, against closed forms and another mesh."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gbeam as gb
from gbeam.scenario import ScenarioError

from .bodies import STEEL, block, solid

try:
    import gmsh
except OSError as error:
    pytest.skip(f"Gmsh's wheel lacks a library of the system: {error}", allow_module_level=True)

LENGTH, WIDTH, THICKNESS, HOLE = 100.0, 20.0, 5.0, 4.0  # mm


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """A bar, a plate with a hole and another bar beside its end, a surface, and half a file."""
    folder = tmp_path_factory.mktemp("cad")
    of = {name: folder / name for name in ("bar.step", "plate.stp", "face.step", "half.step", "bar.igs")}
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    shapes = gmsh.model.occ

    def written(*names: str) -> None:
        shapes.synchronize()
        for name in names:
            gmsh.write(str(of[name]))
        gmsh.clear()

    shapes.addBox(0, 0, 0, LENGTH, WIDTH, THICKNESS)
    written("bar.step", "bar.igs")
    plate = shapes.addBox(0, 0, 0, LENGTH, WIDTH, THICKNESS)
    shapes.cut([(3, plate)], [(3, shapes.addCylinder(LENGTH / 2, WIDTH / 2, 0, 0, 0, THICKNESS, HOLE))])
    shapes.addBox(LENGTH, 0, 0, 10, WIDTH, THICKNESS)
    written("plate.stp")
    shapes.addRectangle(0, 0, 0, 10, 10)
    written("face.step")
    gmsh.finalize()
    whole = of["bar.step"].read_text(encoding="utf-8")
    of["half.step"].write_text(whole[: len(whole) // 2], encoding="utf-8")
    return of


def read(file: Path, **options: Any) -> gb.SolidMesh:
    return gb.SolidMesh.read(file, **{"materials": STEEL, "clamp": "surface 1", "element_size": 5e-3} | options)


def test_a_bar_vibrates_as_one_of_another_mesh(files: dict[str, Path]) -> None:
    """The surface at the foot is the first one; beside hexahedra of 20 nodes the file's tetrahedra are stiffer."""
    bar = read(files["bar.step"], element_size=3e-3).reduced(modes=4, damping_ratio=0.0)
    bricks = block("hexahedron20", (20, 4, 2), (0.1, 0.02, 0.005))
    reference = solid(bricks).reduced(modes=4, damping_ratio=0.0)
    np.testing.assert_allclose(bar.frequency, reference.frequency, rtol=2e-3)


def test_parts_that_touch_are_joined_and_round_ones_weigh_what_they_are(files: dict[str, Path]) -> None:
    plate = read(files["plate.stp"], materials={"solid 1": STEEL, "solid 2": STEEL})
    area = (LENGTH + 10) * WIDTH - np.pi * HOLE**2
    assert plate.mass == pytest.approx(7850 * area * THICKNESS * 1e-9, rel=1e-4)
    assert plate.reduced(modes=1, damping_ratio=0.0).frequency[0] > 100  # it hangs together


def test_stress_at_a_hole_is_judged(files: dict[str, Path]) -> None:
    """Pulled by its own weight: 3.74 of the nominal stress at the hole (Howland 1930, a hole of 0.4 of the width); what
    is left out of an unstructured mesh lies at the clamp's edge.
    """
    parts = {"solid 1": STEEL, "solid 2": STEEL}
    plates = [read(files["plate.stp"], materials=parts, element_size=size) for size in (4e-3, 8e-3)]
    coarse = plates[1].reduced(modes=1, damping_ratio=0.0)
    model = plates[0].reduced(modes=1, damping_ratio=0.0, coarser=coarse)
    stress = model.stress(gb.static(model.structure, acceleration=(-1000.0, 0.0, 0.0)))
    pulling = 7850 * 1000 * 1e-3 * (LENGTH / 2 + 10 - np.pi * HOLE**2 / 2 / WIDTH)  # what is beyond the hole's middle
    assert stress.worst.von_mises == pytest.approx(3.74 * pulling, rel=0.08)
    place = 1e3 * stress.worst.place - (LENGTH / 2, WIDTH / 2, 0)
    assert np.hypot(*place[:2]) == pytest.approx(HOLE, rel=1e-3) and abs(place[0]) < 1.5
    left_out = np.unique(model.structure.recovery.node[model.structure.recovery.singular])  # type: ignore[union-attr]
    assert len(left_out) < 0.02 * len(stress.nodes)
    np.testing.assert_allclose(stress.nodes[left_out, 0], 0.0, atol=1e-9)


@pytest.mark.parametrize(
    ("name", "options", "words"),
    [
        ("bar.step", {"element_size": 1e-5}, r"element_size makes 1\.5e\+11 unknowns, whose factors would take"),
        ("bar.step", {"clamp": "foot"}, r"clamp is 'foot'.*surface 1, at \(0, 10, 2.5\) mm, 100 mm²; surface 2"),
        ("bar.step", {"unit": "mm"}, "unit is 'mm' beside a file that says its own; leave it out"),
        ("bar.step", {"element_size": None}, "element_size is missing; give the one to mesh"),
        ("bar.step", {"element_size": 0.0}, "element_size is 0 m"),
        ("face.step", {}, "has no solids; export the part as a solid"),
        ("bar.igs", {"element_size": None}, "bar.igs is IGES, which holds surfaces .* export the part as STEP"),
        ("half.step", {}, "half.step is not meshed by Gmsh: Could not read file"),
    ],
)
def test_what_cannot_be_meshed_is_refused(
    files: dict[str, Path], name: str, options: dict[str, Any], words: str
) -> None:
    with pytest.raises(gb.InputError, match=words):
        read(files[name], **options)


@pytest.mark.parametrize("word", ["APPLIED_EXTERNAL_IDENTIFICATION_ASSIGNMENT", "aeia"])
def test_a_shape_that_refers_to_other_files_is_refused(files: dict[str, Path], word: str) -> None:
    """Open CASCADE opens them, wherever they lie."""
    entity = f"#9001={word}('/etc/hostname',#9002,#9003,(#9004));\nENDSEC;\nEND-ISO"
    path = files["bar.step"].with_name("more.step")
    path.write_text(files["bar.step"].read_text(encoding="utf-8").replace("ENDSEC;\nEND-ISO", entity))
    assert word in path.read_text(encoding="utf-8")
    with pytest.raises(gb.InputError, match=r"more\.step refers to other files.*export the assembly as one file"):
        read(path)


def test_a_scenario_takes_a_shape_and_a_coarser_size(files: dict[str, Path]) -> None:
    scenario = files["bar.step"].with_name("bar.toml")
    scenario.write_text(
        """
        [bodies.bar]
        mesh = "bar.step"
        element_size = "4 mm"
        coarser_size = "8 mm"
        clamp = "surface 1"
        modes = 3
        damping_ratio = "1 %"
        material = { density = "7850 kg/m^3", youngs_modulus = "210 GPa", poissons_ratio = 0.3 }

        [motion.flight]
        kind = "flight"
        acceleration = { z = { profile = "trapezoid", level = "5 g", jerk = "20 g/s", start = 0.1, hold = 0.2 } }

        [response]
        duration = "1 s"
        """,
        encoding="utf-8",
    )
    structure = gb.read_scenario(scenario).subject
    truth = solid(block("hexahedron20", (20, 4, 2), (0.1, 0.02, 0.005))).reduced(modes=3, damping_ratio=0.01)
    np.testing.assert_allclose(gb.modes(structure).frequency[:3], truth.frequency, rtol=5e-3)
    meshes = [read(files["bar.step"], element_size=size) for size in (4e-3, 8e-3)]
    finer, coarser = (mesh.reduced(modes=3, damping_ratio=0.01) for mesh in meshes)
    stated = meshes[0].reduced(modes=3, damping_ratio=0.01, coarser=coarser).mesh_error
    np.testing.assert_allclose(stated, np.abs(coarser.frequency / finer.frequency - 1), rtol=0.5)
    text = scenario.read_text(encoding="utf-8")
    for key, good, bad in (("clamp", '"surface 1"', '"hole"'), ("coarser_size", '"8 mm"', '"3 mm"')):
        scenario.write_text(text.replace(good, bad), encoding="utf-8")
        with pytest.raises(ScenarioError, match=f"bodies.bar.{key}: "):
            gb.read_scenario(scenario)


def test_a_size_is_for_shapes_and_a_unit_for_meshes() -> None:
    mesh = block("tetra10", (1, 1, 1), (1.0, 1.0, 1.0))
    for options, words in (
        ({"unit": "m", "element_size": 0.1}, "element_size is given beside a mesh"),
        ({}, "unit is missing; give the one that the coordinates are in"),
    ):
        with pytest.raises(gb.InputError, match=words):
            gb.SolidMesh.read(mesh, materials=STEEL, clamp="wall", **options)


def test_a_mesh_of_med_is_that_of_gmsh(tmp_path: Path) -> None:
    """Its elements are numbered as in a mirror, and its groups are names of families."""
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    box = gmsh.model.occ.addBox(0, 0, 0, LENGTH, WIDTH, THICKNESS)
    gmsh.model.occ.synchronize()
    (foot,) = (tag for dim, tag in gmsh.model.getEntities(2) if gmsh.model.occ.getCenterOfMass(dim, tag)[0] < 1e-9)
    gmsh.model.addPhysicalGroup(3, [box], name="a bar")
    gmsh.model.addPhysicalGroup(2, [foot], name="wall")
    gmsh.option.setNumber("Mesh.MeshSizeMax", 10.0)
    gmsh.model.mesh.generate(3)
    files = []
    for order in (1, 2):
        gmsh.model.mesh.setOrder(order)
        files += [(tmp_path / f"{order}.med", tmp_path / f"{order}.msh")]
        for file in files[-1]:
            gmsh.write(str(file))
    gmsh.finalize()
    for pair in files:
        bars = [gb.SolidMesh.read(file, materials={"a bar": STEEL}, clamp="wall", unit="mm") for file in pair]
        med, msh = (bar.reduced(modes=2, damping_ratio=0.0).frequency for bar in bars)
        assert med == pytest.approx(msh, rel=1e-9)


def test_what_meshio_reads_in_part_is_refused(tmp_path: Path) -> None:
    """XDMF, whose numbers stand in another file unless it is asked for one, and CGNS."""
    import meshio

    mesh = block("hexahedron", (2, 1, 1), (0.2, 0.02, 0.01))
    whole = meshio.Mesh(mesh.points, mesh.cells, cell_data={"part": [np.array([1, 2])]})
    options: dict[str, Any] = {"element_size": None, "clamp": "1", "unit": "m"}
    meshio.write(tmp_path / "one.xdmf", whole, data_format="XML")
    assert read(tmp_path / "one.xdmf", **options).mass == pytest.approx(STEEL.density * 4e-5)
    meshio.write(tmp_path / "two.xdmf", whole)
    with pytest.raises(gb.InputError, match=r"two.xdmf keeps its numbers in two.h5; write one file: VTU, or XDMF"):
        read(tmp_path / "two.xdmf", **options)
    with pytest.raises(gb.InputError, match=r"a.cgns is CGNS, of which meshio reads no groups; write it for Gmsh"):
        read(tmp_path / "a.cgns", **options)
