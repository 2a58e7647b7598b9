"""Stress of solids: bars and beams in closed form, NAFEMS LE10, and where margins are least."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import spsolve

import gbeam as gb
from gbeam.report import Numbers, comparison_lines, text, viewer
from gbeam.results import json_of, von_mises
from gbeam.solids import KINDS, VERTICES, NodalStress, chunks, principal, stiffness_matrix, surface_of

from ..calling import main
from .bodies import STEEL, STIFF, block, corner, solid

SIZE = (0.2, 0.03, 0.02)

QUADRATIC = [kind for kind, each in KINDS.items() if not each.linear and not each.shell]
L, B, H = 0.3, 0.02, 0.01


def bar(kind: str, material: gb.Material = STIFF) -> gb.SolidModel:
    mesh = block(kind, (12, 1, 1), (L, B, H))
    points = {"middle": (L / 2, 0.0, H / 2), "root": (0.0, B / 2, H / 2)}
    return solid(mesh, material, points=points).reduced(modes=4, damping_ratio=0.01)


@pytest.mark.parametrize("kind", QUADRATIC)
def test_a_bar_that_is_pulled_by_its_inertia(kind: str) -> None:
    """ρ a (L − x), exact, principal along x and the same in all elements; spinning, ρ ω² (L² − x²)/2."""
    model = bar(kind)
    pulled = model.stress(gb.static(model.structure, acceleration=(-0.5, 0.0, 0.0)))
    whole = STIFF.density * 0.5 * L
    assert pulled.worst.von_mises == pytest.approx(whole, rel=1e-6) and pulled.worst.place[0] == 0
    np.testing.assert_allclose(pulled.worst.principal, [whole, 0, 0], atol=1e-5 * whole)
    assert pulled.worst.spread < 1e-5 and pulled.nearest_yield is None
    np.testing.assert_allclose(pulled.point_von_mises, [[whole / 2, whole, 0]], atol=1e-5 * whole)
    np.testing.assert_allclose(pulled.node_von_mises, whole * (1 - pulled.nodes[:, 0] / L), atol=1e-5 * whole)
    spun = model.stress(gb.static(model.structure, gb.Hub(radius=0.0, rate=100.0)))
    np.testing.assert_allclose(
        spun.point_von_mises[0, :2], STIFF.density * 100**2 * L**2 / 2 * np.array([0.75, 1.0]), rtol=3e-3
    )


@pytest.mark.parametrize("kind", QUADRATIC)
def test_a_beam_that_bends(kind: str) -> None:
    """M c/I half-way, where the root no longer matters: under an acceleration along z the upper face is pressed."""
    model = bar(kind)
    rest = model.stress(gb.static(model.structure, acceleration=(0.0, 0.0, -10.0)))
    wanted = STIFF.density * B * H * 10 * (L / 2) ** 2 / 2 * (H / 2) / (B * H**3 / 12)
    close = 0.06 if kind == "tetra10" else 2e-3  # whose stress is linear in each of few elements
    assert rest.point_von_mises[0, 0] == pytest.approx(wanted, rel=close)
    # Its inertia pulls it up: the upper face is pressed.
    assert rest.point_principal[0, 0, 2] == pytest.approx(-wanted, rel=close)
    assert rest.worst.node > 0 and rest.worst.material == "" and rest.time == pytest.approx([0.0])


def test_stress_over_time_is_that_of_each_time() -> None:
    """At rest under a constant load what static has; the worst is the largest over time and place."""
    model = bar("hexahedron20")
    push = gb.Flight(z=gb.trapezoid(30.0, jerk=300.0, start=0.05, hold=0.3))
    run = gb.simulate(model.structure, push, duration=0.8, step=1e-3, integrator="gauss", name="push")
    stress = model.stress(run)
    assert stress.motion == "push" and stress.von_mises.shape == run.time.shape
    held = model.stress(gb.static(model.structure, push, 0.3))
    assert np.interp(0.42, stress.time, stress.von_mises) == pytest.approx(held.worst.von_mises, rel=0.02)
    assert stress.worst.von_mises == stress.von_mises.max() == stress.node_von_mises.max()
    assert stress.worst.time == stress.time[stress.von_mises.argmax()]
    assert "MPa at (" in repr(stress) and "margin on yield not known" in repr(stress)


def cantilever(kind: str, n: int) -> gb.SolidMesh:
    """Strip of 200 × 30 × 10 mm, of 8n × 2n × n cells."""
    return solid(block(kind, (8 * n, 2 * n, n), (0.2, 0.03, 0.01)))


@pytest.mark.parametrize("kind", ["hexahedron20", "tetra10"])
def test_the_root_of_a_cantilever_is_judged(kind: str) -> None:
    """But for the edge of its clamp: M c/I within 8 %, where a layer of elements took 24 % of it."""
    coarse, model = (cantilever(kind, n) for n in (1, 2))
    model = model.reduced(modes=2, damping_ratio=0.0, coarser=coarse.reduced(modes=2, damping_ratio=0.0))
    stress = model.stress(gb.static(model.structure, acceleration=(0, 0, 9.81)))
    root = STEEL.density * 0.03 * 0.01 * 9.81 * 0.2**2 / 2 * 0.005 / (0.03 * 0.01**3 / 12)
    assert stress.worst.von_mises == pytest.approx(root, rel=0.08) and stress.worst.place[0] < 0.013
    edge = (np.abs(stress.nodes[:, 1:]) > np.array([0.015, 0.005]) - 1e-9).any(axis=1)
    assert stress.known and stress.singular_nodes == ((stress.nodes[:, 0] == 0) & edge).sum() == 24


def test_stress_at_the_edge_of_a_clamp_is_left_out() -> None:
    """With one mesh that is not known. The stated error is more than that to a mesh twice as fine."""
    meshes = [cantilever("hexahedron20", n) for n in (1, 2, 4)]
    coarse, alone, fine = (each.reduced(modes=2, damping_ratio=0.01) for each in meshes)
    model = meshes[1].reduced(modes=2, damping_ratio=0.01, coarser=coarse)
    for k in range(3):
        push = tuple(9.81 * (np.arange(3) == k))
        rest, unjudged, truth = (gb.static(each.structure, acceleration=push) for each in (model, alone, fine))
        stress, plain, finest = model.stress(rest), alone.stress(unjudged), fine.stress(truth)
        assert stress.singular is not None and stress.singular.place[0] == 0 < stress.singular_depth < 0.0063
        assert plain.singular is None and plain.singular_nodes is None
        assert "one mesh does not tell whether the largest is there" in repr(plain)
        (same,) = np.flatnonzero(np.linalg.norm(finest.nodes - stress.worst.place, axis=1) < 1e-12)
        error = abs(stress.worst.von_mises / finest.node_von_mises[same] - 1)
        assert error < rest.errors.stress.mesh < 5 * error  # of equally stressed nodes rounding chooses one
        assert f"{stress.singular_nodes} nodes" in repr(stress) and "no limit" in repr(stress)


def test_elements_at_a_sharp_corner_are_left_out() -> None:
    coarse, model = (solid(corner("hexahedron20", n)) for n in (1, 2))
    model = model.reduced(modes=2, damping_ratio=0.01, coarser=coarse.reduced(modes=2, damping_ratio=0.01))
    rest = gb.static(model.structure, acceleration=(0, 0, 100.0))
    stress = model.stress(rest)
    assert stress.singular is not None and stress.known and stress.singular_nodes == 154
    at = np.abs(stress.singular.place - (0.04, 0.0, -0.02))
    assert at[0] < 0.0101 and at[2] < 0.0101 and stress.singular.von_mises > 1.1 * stress.worst.von_mises
    assert stress.von_mises.max() == stress.worst.von_mises and 0.1 < rest.errors.stress.mesh < 0.35


def test_where_a_tenth_of_the_nodes_would_be_left_out_the_largest_stress_is_not_known() -> None:
    """A sharp corner in 28 elements: no margin is stated, and a limit on stress is not decided, but at a point."""
    strong = replace(STEEL, yield_strength=300e6)
    few, fewer = (solid(corner(kind, 1), strong, points={"middle": (0.0, 0.02, 0.0)})
                  for kind in ("hexahedron20", "hexahedron"))  # fmt: skip
    structure = few.reduced(modes=2, damping_ratio=0.02, coarser=fewer.reduced(modes=2, damping_ratio=0.02)).structure
    rest = gb.static(structure, acceleration=(0, 0, 100.0))
    stress = rest.solid
    assert stress is not None and not stress.known and stress.nearest_yield is None
    assert json_of(stress)["known"] is False and stress.singular_nodes == 86
    for words in (repr(stress), text(rest)):
        assert "the largest stress is not known: at sharp edges" in words and "86 of 321 nodes are there" in words
        assert "MPa" not in words

    turn = gb.Flight(z=gb.Sum((gb.constant(20.0), gb.trapezoid(50.0, jerk=100.0, start=0.5, hold=0.5))))
    machine = gb.Centrifuge(turn, arm=3.3, control_point=0.05, gravity=True, smoothing=0.1, span=(0.0, 2.0))
    options: Any = {"duration": 2.0, "step": 0.01, "integrator": "gauss", "estimate": False}
    runs = [gb.simulate(structure, motion, **options) for motion in (turn, machine)]
    compared = gb.compare(*runs, accept={"stress": 0.5, "damage": 9.0})
    assert compared.decision == "NOT DECIDED" and compared.accepted is None
    assert "limits not known: stress unknown (limit 50 %), damage unknown" in " ".join(comparison_lines(compared))
    assert gb.compare(*runs, stress_at="middle", accept={"stress": 9.0}).accepted is True


def test_a_ring_of_linear_tetrahedra() -> None:
    """Nearly all of its nodes were left out, and the largest stress of none was sought; a third lies at its clamp."""

    def ring(x: np.ndarray) -> np.ndarray:
        radius, turn = 0.02 - 0.015 * x[:, 0], -1.9 * np.pi * (x[:, 1] + 0.5)
        return np.stack([radius * np.cos(turn), radius * np.sin(turn), 0.004 * x[:, 2]], axis=1)

    coarse, fine = (solid(block("tetra", (n, 6 * n, 1), (1.0, 1.0, 1.0), ring)) for n in (1, 2))
    model = fine.reduced(modes=1, damping_ratio=0.0, coarser=coarse.reduced(modes=1, damping_ratio=0.0))
    stress = model.stress(gb.static(model.structure, acceleration=(0, 0, 9.81)))
    assert not stress.known and (stress.singular_nodes, len(stress.nodes)) == (26, 78)


@pytest.mark.parametrize("verb", ["modes", "static"])
def test_colours_end_at_the_largest_stress_that_is_judged(verb: str) -> None:
    """And the view says that it is more at a sharp corner; with one mesh, which does not tell, they end there."""
    coarse, fine = (solid(corner("hexahedron20", n)) for n in (1, 2))
    shown, edge = [], []
    for coarser in (None, coarse.reduced(modes=2, damping_ratio=0.01)):
        structure = fine.reduced(modes=2, damping_ratio=0.01, coarser=coarser).structure
        if verb == "modes":
            facts, data = json_of(gb.modes(structure)), gb.modes(structure).to_xarray()
            motions = viewer("Modes", facts, {key: each.values for key, each in data.variables.items()}, Numbers())[
                "modes"
            ]
        else:
            data = gb.static(structure, acceleration=(0, 0, 9.81)).to_xarray()
            variables = {f"motions/rest/{key}": each.values for key, each in data.variables.items()}
            motions = viewer("Rest", {"motions": {"rest": {}}}, variables, Numbers())["scene"]
        shown.append(motions["motions"][0]["parts"][0]["surface"])
        edge.append(data["beam_surface_vertices"].values[~data["beam_surface_judged"].values.astype(bool)])
    assert shown[0]["beyond"] is False and not len(edge[0])
    assert shown[1]["beyond"] is (verb == "static") and len(edge[1])
    at_corner = (np.abs(edge[1][:, [0, 2]] - (0.04, -0.02)) < 0.0101).all(axis=1)
    np.testing.assert_allclose(edge[1][~at_corner, 2], 0.06)  # of the clamp
    share = shown[1]["largest"] / shown[0]["largest"]
    assert at_corner.any() and (0.5 < share < 0.98 if verb == "static" else share == 1)


def test_the_margin_is_least_in_the_weaker_material() -> None:
    """Half of a bar of half the strength, but at the tip's end, where the stress is a half."""
    mesh = block("hexahedron20", (4, 1, 1), (L, B, H))
    mesh.cell_sets = {"inner": [np.arange(2)], "outer": [np.arange(2, 4)]}
    strong, weak = replace(STIFF, yield_strength=9e6), replace(STIFF, yield_strength=1e6)
    model = solid(mesh, {"inner": strong, "outer": weak}).reduced(modes=2, damping_ratio=0)
    stress = model.stress(gb.static(model.structure, acceleration=(-1000.0, 0.0, 0.0)))
    whole = STIFF.density * 1000 * L
    assert stress.worst.material == "inner" and stress.worst.margin == pytest.approx(9e6 / whole - 1, rel=1e-4)
    near = stress.nearest_yield
    assert near is not None and near.material == "outer" and near.place[0] == pytest.approx(L / 2)
    assert near.margin == pytest.approx(1e6 / (whole / 2) - 1, rel=1e-4)
    assert f"margin on yield {near.margin:.3g} in outer" in repr(stress)


def test_groups_of_one_material_share_their_stress() -> None:
    """Named by both, the same as of one group; a material that differs in nothing but its strength is another one."""
    mesh = block("hexahedron20", (4, 1, 1), (L, B, H))
    mesh.cell_sets = {"inner": [np.arange(2)], "outer": [np.arange(2, 4)]}
    strong = replace(STIFF, yield_strength=9e6)

    def bent(materials: Any) -> gb.SolidStress:
        model = solid(mesh, materials, points={"joint": (L / 2, 0.0, H / 2)}).reduced(modes=2, damping_ratio=0)
        return model.stress(gb.static(model.structure, acceleration=(0.0, 0.0, 10.0)))

    whole, same, apart = (bent(each) for each in (strong, dict.fromkeys(("inner", "outer"), strong),
                                                  {"inner": strong, "outer": STIFF}))  # fmt: skip
    assert same.worst.material == "inner, outer" and same.worst.margin == pytest.approx(whole.worst.margin, rel=1e-7)
    np.testing.assert_allclose(same.point_von_mises, whole.point_von_mises, rtol=1e-7)
    np.testing.assert_allclose(same.node_von_mises, whole.node_von_mises, atol=1e-7 * whole.worst.von_mises)
    assert apart.worst.material == "inner"
    assert abs(apart.point_von_mises[0, 0] / whole.point_von_mises[0, 0] - 1) > 1e-3


def test_an_answer_of_another_structure_is_refused() -> None:
    model = bar("hexahedron20")
    other = gb.static(solid(block("tetra10", (1, 1, 1), (L, B, H))).reduced(modes=1, damping_ratio=0).structure)
    with pytest.raises(gb.InputError, match=r"answer is of solid, with \d+ coordinates; give one of this solid with"):
        model.stress(other)


def test_invariants_of_stress() -> None:
    """In pure shear von Mises' is √3 of it, in pressure none, and neither depends on the axes."""
    shear = np.array([0, 0, 0, 5.0, 0, 0])
    assert von_mises(shear) == pytest.approx(5 * np.sqrt(3)) and principal(shear) == pytest.approx([5, 0, -5])
    assert von_mises(np.array([2.0, 2, 2, 0, 0, 0])) == 0
    stress = np.random.default_rng(3).normal(size=6)
    first, second, third = principal(stress)
    by_principal = np.sqrt(((first - second) ** 2 + (second - third) ** 2 + (third - first) ** 2) / 2)
    assert von_mises(stress) == pytest.approx(by_principal)


# NAFEMS, The Standard NAFEMS Benchmarks, LE10: σ_yy at D of a thick plate under 1 MPa, MPa.
LE10 = -5.38


def test_nafems_le10_thick_plate() -> None:
    """A quarter of an elliptic plate, 0.6 m thick, held at its rim; D is (2, 0, 0.6) m."""

    def plate(x: np.ndarray) -> np.ndarray:
        s, angle, z = x[:, 0], np.pi / 2 * (x[:, 1] + 0.5), 0.6 * (x[:, 2] + 0.5)
        return np.stack([(2 + 1.25 * s) * np.cos(angle), (1 + 1.75 * s) * np.sin(angle), z], axis=1)

    steel = gb.Material(density=7800, youngs_modulus=210e9, poissons_ratio=0.3)
    mesh = solid(block("hexahedron20", (6, 8, 4), (1.0, 1.0, 1.0), plate), steel)
    x, y, z = mesh.points.T
    rim = np.abs((x / 3.25) ** 2 + (y / 2.75) ** 2 - 1) < 1e-6
    held = np.stack([rim | (x < 1e-9), rim | (y < 1e-9), rim & (np.abs(z - 0.3) < 1e-9)], axis=1).ravel()
    top = z > 0.6 - 1e-9
    load = np.zeros((len(z), 3))
    for part in chunks(mesh.points, mesh.blocks, "stiffness"):
        # By Gauss's theorem the integral of a shape function over the top.
        np.add.at(load[:, 2], part.nodes, -1e6 * np.einsum("eq,eqk->ek", part.volume, part.gradients[..., 2]))
    load[~top] = 0
    area = np.pi / 4 * (3.25 * 2.75 - 2.0)
    assert load[:, 2].sum() == pytest.approx(-1e6 * area, rel=1e-3)
    stiffness = csc_matrix(stiffness_matrix(mesh.points, mesh.blocks))[~held][:, ~held]
    moved = np.zeros(len(held))
    moved[~held] = spsolve(stiffness, load.ravel()[~held])
    stress = NodalStress.from_shapes(mesh, moved.reshape(-1, 3, 1))
    (corner,) = np.flatnonzero(np.linalg.norm(mesh.points - (2.0, 0.0, 0.6), axis=1) < 1e-9)
    assert 1e-6 * stress.table[corner, 1, 0] == pytest.approx(LE10, rel=0.01)


@pytest.mark.parametrize("kind", ["tetra10", "hexahedron20", "wedge"])
def test_the_surface_for_pictures_is_closed_and_that_of_the_block(kind: str) -> None:
    mesh = solid(block(kind, (4, 2, 3), SIZE))
    nodes, triangles = surface_of(mesh)
    corners = mesh.points[nodes][triangles]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum() / 2
    x, y, z = SIZE
    assert area == pytest.approx(2 * (x * y + y * z + z * x), rel=1e-9)
    edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()


def test_a_large_surface_is_thinned_for_pictures() -> None:
    mesh = solid(block("hexahedron", (40, 40, 4), (0.4, 0.4, 0.04)))
    nodes, triangles = surface_of(mesh)
    assert 0.3 * VERTICES < len(nodes) < 1.5 * VERTICES
    assert np.ptp(mesh.points[nodes], axis=0) == pytest.approx((0.4, 0.4, 0.04), rel=0.1)
    assert triangles.max() == len(nodes) - 1


def test_few_shapes_hold_what_the_surface_does() -> None:
    """Of a response: displacement and stress of a vertex, by all coordinates and by the shapes of the picture."""
    model = solid(block("hexahedron20", (4, 1, 1), SIZE)).reduced(modes=4, damping_ratio=0.02)
    turn = gb.Flight(z=gb.trapezoid(78.5, jerk=400.0, start=0.1, hold=0.2))
    response = gb.simulate(model.structure, turn, duration=1.0, step=1e-3, integrator="gauss", estimate=False)
    surface = response.body.surface
    assert surface is not None and len(surface.shapes) < model.structure.size / 2
    moved = np.einsum("ts,sva->tva", surface.sizes, surface.shapes)
    tip = np.linalg.norm(surface.vertices - mesh_tip(model), axis=1).argmin()
    index = np.searchsorted(response.time, surface.time)
    assert moved[:, tip] == pytest.approx(response.tip[index], abs=2e-3 * np.abs(response.tip).max())


def mesh_tip(model: gb.SolidModel) -> np.ndarray:
    return np.asarray(model.mesh.points[model.mesh.stations["tip"]])


UNDECIDED = """\
[bodies.foot]
mesh = "fine.inp"
coarser = "coarse.inp"
unit = "m"
clamp = "wall"
modes = 2
damping_ratio = 0.02
material = { density = "7850 kg/m^3", youngs_modulus = "210 GPa", poissons_ratio = 0.3, yield_strength = "300 MPa" }

[motion.flight]
kind = "flight"
acceleration = { z = { profile = "constant", level = "2 g" } }

[motion.spin]
kind = "centrifuge"
tracks = "flight"
arm = "3.3 m"
control_point = "50 mm"
inverse = "flat"
gravity = false
start = "idle"
idle = "2 g"
accept = { stress = 0.5, tip = 0.5 }

[response]
duration = "0.02 s"
step = "2 ms"
"""


def test_a_run_whose_limit_is_not_decided_ends_with_status_1(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Neither accepted nor refused: the limit that is kept is said apart."""
    for name, kind in {"fine": "hexahedron20", "coarse": "hexahedron"}.items():
        corner(kind, 1).write(tmp_path / f"{name}.inp")
    (tmp_path / "s.toml").write_text(UNDECIDED, encoding="utf-8")
    assert main(["run", str(tmp_path / "s.toml"), "--json"]) == 1
    answer = capsys.readouterr()
    assert "motion.spin NOT DECIDED: stress unknown (limit 50 %)\n" in answer.err
    facts = json.loads(answer.out)
    (compared,) = facts["comparisons"]
    assert (facts["outcome"], facts["state"], compared["accepted"]) == ("done", "NOT DECIDED", None)
    assert {each["name"]: each["passed"] for each in compared["criteria"]} == {"stress": None, "tip": True}
