"""Rigid links in solids, bodies on them and springs between them, beside closed forms and bodies of a system."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest

import gbeam as gb
from gbeam.solids import WAYS, Linked, stiffness_matrix

from .bodies import STIFF, block, solid

pytestmark = pytest.mark.usefixtures("reading_in_process")

L, H = 0.2, 0.01
GROUPS = {"end": lambda x: np.isclose(x[:, 0], L), "inner": lambda x: np.isclose(x[:, 0], L / 2)}
GROUND = {"between": ["a"], "stiffness": {"x": 0.0}}
BODY = gb.RigidBody(0.4, (2e-4, 3e-4, 2.5e-4), centre=(0.05, 0.01, 0.02))


def strip(clamp: Any = "wall", cells: tuple[int, int, int] = (8, 1, 1), **more: Any) -> gb.SolidMesh:
    mesh = block("hexahedron20", cells, (L, H, H), groups=GROUPS)
    return gb.SolidMesh.read(mesh, materials=STIFF, clamp=clamp, unit="m", **more)


def frequencies(mesh: gb.SolidMesh, count: int = 4, **more: Any) -> np.ndarray:
    return mesh.reduced(modes=6, damping_ratio=0.01, **more).frequency[:count]


def test_a_body_on_springs_has_its_closed_form() -> None:
    """A stiff block that nothing else holds: √(k/m) along each axis, √(k/J) about those through its middle."""
    stiffness = {"x": 1e3, "y": 2e3, "z": 3e3, "rx": 2.0, "ry": 4.0, "rz": 5.0}
    mesh = block(
        "hexahedron20", (2, 1, 1), (0.04, 0.02, 0.03), lambda x: x - (0.02, 0, 0), groups={"all": lambda x: x[:, 0] < 1}
    )
    springs = {"mount": {"between": ["body"], "stiffness": stiffness}}
    solid = gb.SolidMesh.read(mesh, materials=STIFF, clamp=[], unit="m", links={"body": "all"}, springs=springs)
    a, b, c = 0.04, 0.02, 0.03
    inertia = solid.mass / 12 * np.array([b * b + c * c, a * a + c * c, a * a + b * b])
    expected = np.sqrt(np.array([1e3, 2e3, 3e3, *(np.array([2, 4, 5]) / inertia * solid.mass)]) / solid.mass)
    model = solid.reduced(modes=6, damping_ratio=0.0)
    np.testing.assert_allclose(2 * np.pi * model.frequency, np.sort(expected), rtol=1e-7)
    pulled = gb.static(model.structure, acceleration=(0.0, 0.0, 1.0))
    np.testing.assert_allclose(pulled.tip[2], -solid.mass / 3e3, rtol=1e-7)


@pytest.mark.parametrize("load", [-50.0, 0.0, 50.0])
def test_a_weight_on_a_rigid_arm_swings_as_a_pendulum(load: float) -> None:
    """On a spring that turns: ω² = (k + m a h)/(J + m h²), hanging down or standing up."""
    mesh = block(
        "hexahedron20", (1, 1, 1), (0.02, 0.02, 0.02), lambda x: x - (0.01, 0, 0), groups={"all": lambda x: x[:, 0] < 1}
    )
    stiff = dict.fromkeys(("x", "y", "z"), 1e9) | {"rx": 1e6, "rz": 1e6}
    springs = {"hinge": {"between": ["arm"], "stiffness": stiff | {"ry": 10.0}}}
    body = gb.RigidBody(0.5, (1e-4, 2e-4, 3e-4), centre=(0.0, 0.0, 0.2))
    arm: dict[str, Any] = {"links": {"arm": "all"}, "carried": {"arm": body}, "springs": springs}
    solid = gb.SolidMesh.read(mesh, materials=STIFF, clamp=[], unit="m", **arm)
    (frequency, *_) = gb.modes(
        solid.reduced(modes=6, damping_ratio=0).structure, gb.Flight(z=gb.constant(load))
    ).frequency
    inertia = STIFF.density * 0.02**5 / 6 + 2e-4 + 0.5 * 0.2**2
    assert (2 * np.pi * frequency) ** 2 == pytest.approx((10.0 - 0.5 * load * 0.2) / inertia, rel=1e-4)


def two_blocks(offset: tuple[float, float, float], **more: Any) -> gb.SolidMesh:
    """Two rigid blocks apart, of which `more` says the springs."""
    one = block("hexahedron20", (1, 1, 1), (0.02, 0.02, 0.02))
    cells, count = one.cells[0].data, len(one.points)
    points = np.concatenate([one.points, one.points + offset])
    sets = {"a": np.arange(count), "b": np.arange(count) + count}
    mesh = meshio.Mesh(points, {"hexahedron20": np.concatenate([cells, cells + count])}, point_sets=sets)
    return gb.SolidMesh.read(mesh, materials=STIFF, clamp=[], unit="m", links={"a": "a", "b": "b"}, **more)


def test_blocks_in_a_row_swing_as_masses_on_springs() -> None:
    ground = dict.fromkeys(WAYS, 1e4)
    springs = {
        "ground": {"between": ["a"], "stiffness": ground},
        "between": {"between": ["a", "b"], "stiffness": dict.fromkeys(WAYS, 1e9) | {"x": 2e4}},
    }
    model = two_blocks((0.05, 0.0, 0.0), springs=springs).reduced(modes=6, damping_ratio=0)
    squares = np.linalg.eigvalsh(np.array([[3e4, -2e4], [-2e4, 2e4]]) / (STIFF.density * 0.02**3))
    apart = np.abs(model.frequency[:, None] / (np.sqrt(squares) / 2 / np.pi) - 1).min(axis=0)
    assert (apart < 1e-6).all()


def test_links_and_springs_move_and_turn_as_one_without_strain() -> None:
    """Blocks beside one another in all three directions, and a spring whose ends would strain if it turned alone."""
    stiffness = dict(zip(WAYS, (1e6, 2e6, 3e6, 4e3, 5e3, 6e3), strict=True))
    solid = two_blocks((0.05, 0.01, 0.02), springs={"s": {"between": ["a", "b"], "stiffness": stiffness}, "g": GROUND})
    linked = Linked(solid)
    elastic = linked.elastic(0 * stiffness_matrix(solid.points, solid.blocks))
    matrix = linked.condensed_stiffness(elastic).toarray()
    middles = [solid.points[solid.links.nodes[name]].mean(axis=0) for name in ("a", "b")]
    for move, turn in (((1, 2, 3), (0, 0, 0)), ((0, 0, 0), (0.3, -0.2, 0.5))):
        unknowns = np.concatenate([[*(move + np.cross(turn, middle)), *turn] for middle in middles])
        assert np.abs(matrix @ unknowns).max() < 1e-9 * np.abs(matrix).max()
    assert np.linalg.matrix_rank(matrix, tol=1e-9 * np.abs(matrix).max()) == 6


def test_nodes_of_a_link_keep_their_distances() -> None:
    """Two faces of a strip in one link, in every mode and static answer."""
    model = strip(links={"ends": ["inner", "end"]}).reduced(modes=8, damping_ratio=0)
    nodes = model.mesh.links.nodes["ends"]
    assert len(nodes) == 16 and np.ptp(model.mesh.points[nodes, 0]) == pytest.approx(L / 2)
    apart = model.mesh.points[nodes][:, None] - model.mesh.points[nodes]
    moved = model.shapes[nodes][:, None] - model.shapes[nodes]
    stretch = np.einsum("ijc,ijcn->ijn", apart, moved)
    assert np.abs(stretch).max() < 1e-12 * np.abs(model.shapes).max() and np.abs(moved).max() > 0.1


def test_a_carried_body_is_that_of_a_system() -> None:
    """On a face that is rigid, at rest and where the load of gravity stiffens or softens: modes of both."""
    apart = strip(interfaces={"seat": "end"}, links={"face": "end"}).reduced(modes=10, damping_ratio=0.0).structure
    joints = {"wall": gb.Joint("fixed", "arm"), "seat": gb.Joint("fixed", "body", on="arm.seat")}
    carried = strip(links={"face": "end"}, carried={"face": BODY}).reduced(modes=6, damping_ratio=0.0)
    assert carried.mesh.mass == pytest.approx(STIFF.density * L * H**2 + 0.4)
    for way in (0.0, 30.0, -30.0):
        system = gb.System({"arm": apart, "body": BODY}, joints, gravity=(way, 0, 0))
        one = gb.modes(system).frequency[:3]
        other = gb.modes(carried.structure, gb.Flight(x=gb.constant(-way))).frequency[:3]
        np.testing.assert_allclose(other, one, rtol=2e-4)


SCENARIO = """
[bodies.arm]
mesh = "arm.inp"
unit = "m"
clamp = "wall"
modes = 4
damping_ratio = 0.01
material = { density = 2700.0, youngs_modulus = "70 GPa", poissons_ratio = 0.0 }
links = { face = "end" }
carried.face = { mass = "400 g", centre = ["50 mm", "10 mm", "20 mm"], inertia = [2e-4, 3e-4, 2.5e-4] }
springs.stay = { between = ["face"], stiffness = { z = "2 N/mm", rx = "3 N m/rad" } }

[motion.turn]
kind = "hub"
radius = 0.3
rate = { profile = "constant", level = 5.0 }

[response]
duration = "1 s"
"""


def test_a_scenario_has_links_too(tmp_path: Path) -> None:
    meshio.write(tmp_path / "arm.inp", block("hexahedron20", (4, 1, 1), (L, H, H), groups=GROUPS))
    (tmp_path / "scenario.toml").write_text(SCENARIO)
    springs = {"stay": {"between": ["face"], "stiffness": {"z": 2e3, "rx": 3.0}}}
    how: dict[str, Any] = {"links": {"face": "end"}, "carried": {"face": BODY}, "springs": springs}
    solid = gb.SolidMesh.read(tmp_path / "arm.inp", materials=STIFF, clamp="wall", unit="m", **how)
    case = gb.read_scenario(tmp_path / "scenario.toml")
    assert case.subject == solid.reduced(modes=4, damping_ratio=0.01).structure
    (tmp_path / "scenario.toml").write_text(SCENARIO.replace("3e-4", "3e-3"))
    with pytest.raises(gb.GbeamError, match=r"bodies.arm.carried.face.inertia: has the principal moments"):
        gb.read_scenario(tmp_path / "scenario.toml")
    loose = SCENARIO.replace('clamp = "wall"', "clamp = []")
    (tmp_path / "scenario.toml").write_text(loose)
    with pytest.raises(gb.GbeamError, match=r"bodies.arm.springs: is (singular|not positive definite)"):
        gb.read_scenario(tmp_path / "scenario.toml")


REFUSED: list[tuple[dict[str, Any], str]] = [
    ({"carried": {"face": BODY}}, "carried.face is 'face', which is no rigid link; name its groups in links"),
    (
        {"links": {"face": "end", "more": ["end"]}},
        "links.more shares 8 nodes with links.face; name all their groups in one",
    ),
    ({"links": {"face": ["end", "wall"]}}, "links.face has 8 clamped nodes; leave those out, or clamp the whole group"),
    ({"links": {"face": "edge"}}, "links.face is 'edge', which is no group of the mesh"),
    (
        {"links": {"face": "end"}, "springs": {"s": {"between": ["face", "other"], "stiffness": {"x": 1.0}}}},
        r"springs.s.between\[1\] is 'other', which is no rigid link; choose from face",
    ),
    (
        {"links": {"face": "end"}, "springs": {"s": {"between": ["face", "face"], "stiffness": {"x": 1.0}}}},
        r"springs.s.between is \['face', 'face'\]; name one link, for a spring to the base, or two",
    ),
    (
        {"links": {"face": "end"}, "springs": {"s": {"between": ["face"], "stiffness": {"u": 1.0}}}},
        "springs.s.stiffness has 'u'; choose from x, y, z, rx, ry, rz",
    ),
    (
        {"links": {"face": "end"}, "springs": {"s": {"between": ["face"], "stiffness": {"x": -1.0}}}},
        "springs.s.stiffness.x is -1",
    ),
    ({"springs": {"s": {"betwen": ["face"], "stiffness": {}}}}, "springs.s is 'betwen'; did you mean 'between'"),
    ({"springs": {"s": {"stiffness": {}}}}, "springs.s.between is missing"),
    ({"springs": {"s": 3.0}}, "springs is .*; give a mapping"),
]


@pytest.mark.parametrize(("arguments", "words"), REFUSED)
def test_links_that_cannot_be_are_refused(arguments: dict[str, Any], words: str) -> None:
    with pytest.raises(gb.InputError, match=words):
        strip(**arguments)


def test_what_springs_do_not_hold_is_refused() -> None:
    springs = {"s": {"between": ["face"], "stiffness": {"x": 1e3}}}
    with pytest.raises(gb.InputError, match=r"stiffness is (singular|not positive definite); hold the structure"):
        strip(clamp=[], links={"face": "end"}, springs=springs).reduced(modes=2, damping_ratio=0)


def test_a_body_that_outweighs_the_solid_beyond_all_digits_is_refused_as_that() -> None:
    """True if the modes that are asked for have mass beside it, or the static answers to inertia; the clamp holds."""
    body = {"end": gb.RigidBody(1e9, 1e5 * np.eye(3))}
    for modes, words in (
        (12, "modes is 12, and only . motions move mass; give at most"),
        (3, "next to none .* or carry"),
    ):
        with pytest.raises(gb.InputError, match=words):
            strip(links={"end": "end"}, carried=body).reduced(modes=modes, damping_ratio=0)


def test_a_weight_beside_the_axis_of_a_spinning_bar_is_that_of_a_tree() -> None:
    """The load bends the bar, and the forces of vibration on the arm of the weight turn with it: to first order."""
    bar = gb.Section.rectangle(0.02, 0.01)
    mesh = block("hexahedron27", (8, 4, 2), (0.3, 0.02, 0.01), groups={"end": lambda x: x[:, 0] > 0.3 - 1e-9})
    weight = gb.RigidBody(2.0, (2e-3, 2e-3, 2e-3), centre=(0, 0, 0.04))
    model = solid(mesh, STIFF, links={"end": "end"}, carried={"end": weight}).reduced(modes=6, damping_ratio=0)
    beam = gb.assemble(gb.Beam(0.3, bar, STIFF, damping_ratio=0.0), "exact", axial=1, z=5, y=4, twist=3)
    joints = {"wall": gb.Joint("fixed", "bar"), "end": gb.Joint("fixed", "weight", on="bar.tip")}
    system = gb.System({"bar": beam, "weight": weight}, joints)
    shift = []
    for each in (model.structure, system):
        still, spun = (
            gb.modes(each, gb.Hub(radius=0.2, rate=rate), errors=False).frequency[:2] ** 2 for rate in (0.0, 5.0)
        )
        shift.append(spun - still)
    np.testing.assert_allclose(shift[0], shift[1], rtol=0.01)
