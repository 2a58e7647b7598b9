"""Theorems about the displacement fields: the exact one at any rotation, the projected one to second order."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import jax
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import BarycentricInterpolator
from scipy.linalg import expm

from gbeam import Line, Model, Structure, assemble
from gbeam.mechanics import (
    ProjectedField,
    RootedField,
    SeriesField,
    StrainField,
    bar_shapes,
    bending_shapes,
    closed_forms,
    legendre_shapes,
    projected_field,
    quadrature,
    rotation_matrix,
    split,
    strain_field,
)

from ..differences import hessian, jacobian
from ..lagrange import quickly_compiled
from ..specimens import BOW, LENGTH, SPRINGS, appendage, states

ROUNDING = 1e-12
SPECTRAL = 1e-9  # of the shapes' quadrature, at rotations of a radian
ODE = 1e-9
PLACE = 5.0  # where a body might sit: the axial strain vanishes at the tip
STATIONS = np.linspace(0.5, 7.5, 8)


@cache
def exact(strain: int = 2, y: int = 3, z: int = 3) -> Structure:
    return assemble(appendage(), Model("exact", strain, y, z), STATIONS)


def bent(structure: Structure, seed: int, strain: float = 0.01, angle: float = 0.8) -> np.ndarray:
    """Random coordinates of the exact field: strains of per cents, rotations of the order of a radian."""
    count = structure.counts[:3]
    scale = np.repeat([strain, angle, angle], count)
    return states(sum(count), 1, 1.0, seed)[0] * scale


def sampled(structure: Structure, q: np.ndarray) -> tuple[Any, ...]:
    """Places and rotations of the points, strains at the nodes, and the energy."""
    field = structure.field
    assert isinstance(field, StrainField)
    strains = [part + np.zeros(len(field.rest[0])) for part in field.strain(q)]
    return field.positions(q), field.rotation(q), strains, structure.strain_energy(q)


def nodes_of(structure: Structure) -> np.ndarray:
    """Positions of the quadrature nodes: the field's points before the stations, undeformed."""
    r, *_ = sampled(structure, np.zeros(structure.size))
    return r[: structure.first_station, 0]


@pytest.mark.parametrize("seed", range(3))
def test_exact_sections_only_turn(seed: int) -> None:
    _, rotation, _, _ = sampled(exact(), bent(exact(), seed))
    np.testing.assert_allclose(
        rotation @ np.swapaxes(rotation, 1, 2), np.broadcast_to(np.eye(3), rotation.shape), atol=ROUNDING
    )
    np.testing.assert_allclose(np.linalg.det(rotation), 1, atol=ROUNDING)


@pytest.mark.parametrize("seed", range(3))
def test_exact_axis_has_slope_one_plus_strain_along_the_section_normal(seed: int) -> None:
    structure = exact()
    position, rotation, strains, _ = sampled(structure, bent(structure, seed))
    x, n = nodes_of(structure), structure.first_station
    slope = np.stack([BarycentricInterpolator(x, np.asarray(position)[:n, i]).derivative(x) for i in range(3)], axis=1)
    np.testing.assert_allclose(slope, strains[0][:, None] * rotation[:n, :, 0], atol=1e-7)


def test_exact_field_in_a_plane_is_the_integral_of_cosine_and_sine() -> None:
    structure = exact(2, 4, 0)
    q = bent(structure, seed=3, angle=1.5)
    position, _, strains, _ = sampled(structure, q)
    fine = (np.arange(20000) + 0.5) / 20000 * LENGTH
    angle = legendre_shapes(fine, LENGTH, 4).value @ q[2:]
    strain = legendre_shapes(fine, LENGTH, 2).slope @ q[:2] * LENGTH
    tip = [np.mean((1 + strain) * f(angle)) * LENGTH for f in (np.cos, np.sin)]
    np.testing.assert_allclose(position[-1], [*tip, 0], atol=1e-7)  # the midpoint rule's own error
    np.testing.assert_allclose(strains[4], 0, atol=1e-15)


def test_planar_and_spatial_forms_agree_in_either_plane() -> None:
    q = bent(exact(2, 3, 0), seed=4)
    none = np.zeros(3)
    wide = {"y": np.concatenate([q, none]), "z": np.concatenate([q[:2], none, q[2:]])}
    for plane, counts in (("y", (2, 3, 0)), ("z", (2, 0, 3))):
        flat, full = sampled(exact(*counts), q), sampled(exact(), wide[plane])
        for ours, theirs in zip((*flat[:2], *flat[2], flat[3]), (*full[:2], *full[2], full[3]), strict=True):
            np.testing.assert_allclose(ours, theirs, atol=1e-10)


@pytest.mark.parametrize("seed", range(3))
def test_turning_the_bending_plane_of_a_round_beam_turns_the_field_and_keeps_the_energy(seed: int) -> None:
    structure, turn = exact(), 0.7 + seed
    q = bent(structure, seed)
    along_y, along_z = q[2:5], q[5:]
    c, s = np.cos(turn), np.sin(turn)
    turned = np.concatenate([q[:2], c * along_y - s * along_z, s * along_y + c * along_z])
    about_x = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    (r, R, _, U), (r_turned, R_turned, _, U_turned) = sampled(structure, q), sampled(structure, turned)
    np.testing.assert_allclose(r_turned, r @ about_x.T, atol=1e-10)
    np.testing.assert_allclose(R_turned, about_x @ R @ about_x.T, atol=1e-10)
    np.testing.assert_allclose(U_turned, U, rtol=1e-10)


@pytest.mark.parametrize("seed", range(3))
def test_exact_frame_is_the_integral_of_its_curvatures_without_torsion(seed: int) -> None:
    """R' = R [κ]× with κ = (0, κ_y, κ_z) from `strain`, integrated independently, gives the same frame and tip."""
    structure = exact(2, 3, 3)
    position, rotation, strains, _ = sampled(structure, bent(structure, seed, angle=0.5))
    x = nodes_of(structure)
    stretch, about_y, about_z = (BarycentricInterpolator(x, strains[k]) for k in (0, 4, 5))

    def rates(s: float, y: np.ndarray) -> np.ndarray:
        R, ky, kz = y[3:].reshape(3, 3), about_y(s), about_z(s)
        bend = np.array([[0, -kz, ky], [kz, 0, 0], [-ky, 0, 0]])
        return np.concatenate([stretch(s) * R[:, 0], (R @ bend).ravel()])

    start = np.concatenate([np.zeros(3), np.eye(3).ravel()])
    end = solve_ivp(rates, (0, LENGTH), start, method="DOP853", rtol=1e-11, atol=1e-12).y[:, -1]
    np.testing.assert_allclose(position[-1], end[:3], atol=LENGTH * ODE)
    np.testing.assert_allclose(rotation[-1], end[3:].reshape(3, 3), atol=ODE)


def test_exact_field_is_smooth_through_small_angles() -> None:
    """The series near zero and the closed forms meet: second derivatives are continuous across the switch."""
    structure = exact(0, 1, 1)
    direction = np.array([0.6, 0.8])

    def tip(size: Any) -> Any:
        q = size * direction
        return structure.field.positions(q)[-1]

    second = quickly_compiled(jax.jacfwd(jax.jacfwd(tip)))
    for switch in (1e-2, 1e-1):  # φ² = 1e-4 and 1e-2 at the tip
        below, above = (np.asarray(second(switch * (1 + side))) for side in (-1e-6, 1e-6))
        np.testing.assert_allclose(below, above, atol=1e-5)
    assert np.isfinite(second(0.0)).all()


def test_rotation_matrix_is_the_exponential() -> None:
    from scipy.spatial.transform import Rotation

    angles = np.concatenate([states(3, 5, 1.5, seed=5), states(3, 5, 1e-3, seed=6), np.zeros((1, 3))])
    np.testing.assert_allclose(rotation_matrix(angles), Rotation.from_rotvec(angles).as_matrix(), atol=ROUNDING)


def test_projected_field_is_the_sum_of_shapes_and_the_foreshortening() -> None:
    x, counts = np.array([2.0, 5.0]), (2, 2, 2, 0, 0, 0)
    q = states(6, 1, 0.3, seed=7)[0]
    s, v, w = (
        shapes(x, LENGTH, 2).value @ part
        for shapes, part in zip((bar_shapes, bending_shapes, bending_shapes), np.split(q, 3), strict=True)
    )
    fine = (np.arange(4000) + 0.5) / 4000
    short = [
        np.mean(sum((bending_shapes(fine * at, LENGTH, 2).slope @ part) ** 2 for part in np.split(q, 3)[1:])) * at / 2
        for at in x
    ]
    for foreshortening in (True, False):
        rule, families = quadrature(LENGTH, 20), closed_forms(LENGTH, counts)
        field = projected_field(rule, x, counts, families, foreshortening=foreshortening)
        wanted = np.stack([x + s - foreshortening * np.array(short), v, w], axis=1)
        np.testing.assert_allclose(field.places().positions(q), wanted, atol=1e-7)


@pytest.mark.parametrize(
    "moving", [[0, 1, 1, 1, 1], [1, 1, 1, 0, 0]], ids=["bending in two planes", "bending and stretch in one plane"]
)
def test_projected_sections_follow_the_torsion_free_frame_to_second_order(moving: list[int]) -> None:
    """A body off the axis feels the sections' rotation to the second order that T needs (field.py says so).

    The frame of the axis r(x; q), carried along without torsion, differs from `rotation` by O(q³): an eighth at half q.
    """
    structure = assemble(appendage(), Model("CFOAM", 1, 2, 2), [PLACE])
    q = states(5, 1, 0.5, seed=8)[0] * moving

    def tangent(x: float, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        at = np.array([x])
        s, bend = bar_shapes(at, LENGTH, 1), bending_shapes(at, LENGTH, 2)
        v1, w1 = bend.slope[0] @ q[1:3], bend.slope[0] @ q[3:]
        v2, w2 = bend.curvature[0] @ q[1:3], bend.curvature[0] @ q[3:]
        t = np.array([1 + s.slope[0, 0] * q[0] - (v1**2 + w1**2) / 2, v1, w1])
        return t, np.array([s.curvature[0, 0] * q[0] - v1 * v2 - w1 * w2, v2, w2])

    def torsion_free(q: np.ndarray) -> np.ndarray:
        """Parallel transport of the second axis along the curve: e₂' = −(t·t')… with no turn about t."""

        def rates(x: float, e: np.ndarray) -> np.ndarray:
            t, rate = tangent(x, q)
            size = np.linalg.norm(t)
            unit = t / size
            change = (rate - unit * (unit @ rate)) / size
            return -unit * (change @ e)

        end = solve_ivp(rates, (0, PLACE), [0.0, 1.0, 0.0], method="DOP853", rtol=1e-11, atol=1e-13).y[:, -1]
        unit = tangent(PLACE, q)[0]
        unit /= np.linalg.norm(unit)
        return np.stack([unit, end, np.cross(unit, end)], axis=1)

    def error(scale: float) -> float:
        rotation = structure.field.rotation(scale * q)[-2]
        return float(np.abs(rotation - torsion_free(scale * q)).max())

    assert error(0.1) / error(0.05) == pytest.approx(8, rel=0.3)


def test_exact_field_to_second_order_has_foams_kinematics() -> None:
    """Where no load acts across the beam the coordinates do not matter: equal frequencies at a steady spin."""
    structures = [assemble(appendage(), model) for model in (Model("FOAM", 2, 10, 0), Model("exact", 3, 11, 0))]
    spin, radius = np.array([0.0, 1.0, 2.0]), 0.5
    root = radius * np.array([-(spin @ spin), 0.0, 0.0])
    frequencies = []
    for c in (structure.coefficients for structure in structures):
        velocity, stiffness, _ = c.evaluate(root, spin, np.zeros(3))
        n = len(velocity)
        first_order = np.block(
            [[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(c.mass, np.hstack([stiffness, velocity]))]]
        )
        frequencies.append(np.sort(np.abs(np.linalg.eigvals(first_order).imag))[::2][:3])
    np.testing.assert_allclose(*frequencies, rtol=2e-4)  # FOAM's ten modes at 2 rad/s
    at_rest = [structure.rest[0][:3] for structure in structures]
    np.testing.assert_allclose(*at_rest, rtol=1e-7)


def test_displacement_history_is_that_of_its_moments() -> None:
    for kind in ("FOAM", "CFOAM", "exact"):
        structure = assemble(appendage(), Model(kind, 1, 1, 1), [2.0])
        q = states(3, 5000, 0.1, seed=9)
        history = structure.displacement(q)
        assert history.shape == (5000, 2, 3)
        for i in (0, 4095, 4096, 4999):
            np.testing.assert_allclose(history[i], structure.displacement(q[i]), atol=1e-14)


# --- polynomials at the straight beam

NODES = 8
RULE = quadrature(LENGTH, NODES)
POINTS = np.concatenate([RULE.node, [PLACE, LENGTH]])
MOVE, TURN = SPRINGS.directions()


def projected(name: str) -> ProjectedField:
    counts = (1, 2, 2, 0, 0, 0)
    return projected_field(RULE, POINTS, counts, closed_forms(LENGTH, counts), foreshortening=name == "FOAM")


@pytest.mark.parametrize("rooted", [False, True], ids=["clamped", "on springs"])
@pytest.mark.parametrize("name", ["FOAM", "TLAM"])
def test_polynomials_are_the_derivatives_of_places_and_rotations(name: str, rooted: bool) -> None:
    inner = projected(name)
    field = RootedField(inner, POINTS, MOVE, TURN, linear=name == "TLAM") if rooted else inner
    springs = MOVE.shape[1] if rooted else 0

    def position(q: np.ndarray) -> np.ndarray:
        """The root turns and moves what the inner field places; of TLAM to first order."""
        beam, root = q[: len(q) - springs], q[len(q) - springs :]
        r = inner.places().positions(beam)
        if not rooted:
            return r
        return r @ rotation_matrix(TURN @ root).T + MOVE @ root

    places, turns = field.places(), field.turns()
    zero = np.zeros(places.first.shape[-1])
    np.testing.assert_allclose(places.r0, position(zero), atol=1e-12)
    np.testing.assert_allclose(places.first, jacobian(position, zero), atol=1e-12)
    if name == "FOAM":
        np.testing.assert_allclose(places.second, hessian(position, zero), atol=1e-11)
    else:
        assert not places.second.any()
    np.testing.assert_allclose(field.rotation(zero), np.broadcast_to(np.eye(3), (len(places.r0), 3, 3)), atol=1e-15)
    np.testing.assert_allclose(turns.first, jacobian(field.rotation, zero), atol=1e-12)
    np.testing.assert_allclose(turns.second, hessian(field.rotation, zero), atol=1e-11)


@pytest.mark.parametrize("order", [1, 2], ids=["linear", "with second derivatives"])
def test_places_follow_their_polynomial(order: int) -> None:
    """Positions, velocities and accelerations along a path, by differentiating the path."""
    places = projected("FOAM").places()
    places = places if order == 2 else replace(places, second=None)
    q, qd, qdd = states(places.first.shape[-1], 3, 0.3, seed=6)

    def path(t: Any) -> Any:
        return places.positions(q + qd * t[0] + qdd * t[0] ** 2 / 2)

    start = np.zeros(1)
    derivatives = path(start), jacobian(path, start)[..., 0], hessian(path, start)[..., 0, 0]
    for ours, theirs in zip(places.paths(q, qd, qdd), derivatives, strict=True):
        np.testing.assert_allclose(ours, theirs, atol=1e-10)
    np.testing.assert_allclose(places.slopes(q), jacobian(places.positions, q), atol=1e-12)


# --- the field of strains: all six, clamped and on springs, on the axis and off it

FINE = quadrature(LENGTH, 20)


def strained(plane: bool = False, springs: bool = True, offset: bool = True) -> StrainField:
    """Field of two polynomials for each strain, or for stretch and one curvature, at the nodes and two points more."""
    chosen = [0, 5] if plane else range(6)
    count, extra = 2 * len(chosen), MOVE.shape[1] if springs else 0
    strains = np.zeros((6, len(FINE.node), count + extra))
    for i, k in enumerate(chosen):
        strains[k, :, 2 * i : 2 * i + 2] = legendre_shapes(FINE.node, LENGTH, 2).slope
    still = np.zeros((3, count))
    root = (np.concatenate([still, each], axis=1) for each in (MOVE, TURN)) if springs else (None, None)
    field = strain_field(FINE, np.append(FINE.node, [PLACE, LENGTH]), strains, *root)
    arms = np.random.default_rng(3).normal(size=(len(field.cumulative), 3))
    return replace(field, offset=arms) if offset else field


def of_fourth_order(field: StrainField) -> SeriesField:
    return SeriesField.of(replace(field, offset=None), 4).points(slice(None), field.offset)


FIELDS = {
    "in space": strained(offset=False, springs=False),
    "in space, on springs, off the axis": strained(),
    "in a plane": strained(plane=True, springs=False),
    "of fourth order, on springs, off the axis": of_fourth_order(strained()),
    "of fourth order, in a plane": of_fourth_order(strained(plane=True, springs=False)),
}


@pytest.mark.parametrize("name", FIELDS)
def test_strain_fields_derivatives_are_those_of_places_and_rotations(name: str) -> None:
    """First and second, about a state where sections turn by about a radian."""
    field = FIELDS[name][-3:]
    q = states(field.size, 1, 0.3, seed=4)[0]
    places, rotation, turns = field.curved(q)
    np.testing.assert_allclose(places.r0, field.positions(q), atol=1e-12)
    np.testing.assert_allclose(rotation, field.rotation(q), atol=1e-12)
    np.testing.assert_allclose(places.first, jacobian(field.positions, q), atol=LENGTH * SPECTRAL)
    np.testing.assert_allclose(places.second, hessian(field.positions, q), atol=LENGTH * SPECTRAL)
    np.testing.assert_allclose(turns.first, jacobian(field.rotation, q), atol=SPECTRAL)
    np.testing.assert_allclose(turns.second, hessian(field.rotation, q), atol=SPECTRAL)


@pytest.mark.parametrize("name", FIELDS)
def test_strain_fields_motions_are_those_of_their_places(name: str) -> None:
    field = FIELDS[name][-3:]
    q, qd, qdd = states(field.size, 3, 0.3, seed=6)

    def path(t: Any) -> Any:
        return field.positions(q + qd * t[0] + qdd * t[0] ** 2 / 2)

    start = np.zeros(1)
    derivatives = path(start), jacobian(path, start)[..., 0], hessian(path, start)[..., 0, 0]
    for ours, theirs in zip(field.paths(q, qd, qdd), derivatives, strict=True):
        np.testing.assert_allclose(ours, theirs, atol=LENGTH * SPECTRAL)


@pytest.mark.parametrize("name", FIELDS)
def test_forces_come_back_as_motion_goes_out(name: str) -> None:
    """Generalised forces are the transpose of the motion: F·δr + M·δθ, at one time and at many."""
    field = FIELDS[name][-3:]
    q = states(field.size, 4, 0.3, seed=7)
    force, moment = np.random.default_rng(8).normal(size=(2, 4, 3, 3))
    moved, angle = field.jacobians(q)
    wanted = np.einsum("tpa,tpai->ti", force, moved) + np.einsum("tpa,tpai->ti", moment, angle)
    np.testing.assert_allclose(field.generalised_forces(q, split(force), split(moment)), wanted, atol=1e-11)
    np.testing.assert_allclose(field.generalised_forces(q[2], split(force[2]), split(moment[2])), wanted[2], atol=1e-11)


@pytest.mark.parametrize("order", [1, 2, 4])
@pytest.mark.parametrize("line", [None, BOW], ids=["straight", "curved"])
def test_places_of_an_order_leave_out_the_next(line: Line | None, order: int) -> None:
    """On the axis and beside it, straight at rest or not: halving coordinates divides the gap by 2 ** (order + 1)."""
    breaks = [] if line is None else line.panels
    rule = quadrature(LENGTH, 20, breaks)
    strains = np.zeros((6, len(rule.node), 12))
    for k in range(6):
        strains[k, :, 2 * k : 2 * k + 2] = legendre_shapes(rule.node, LENGTH, 2).slope
    exact = strain_field(rule, np.array([PLACE, LENGTH]), strains, line=line)
    arms = np.array([[0.1, 0.2, -0.3], [0.0, -0.2, 0.1]])
    q = states(12, 1, 0.5, seed=9)[0]
    whole, ended = exact.points(slice(None), arms), SeriesField.of(exact, order).points(slice(None), arms)
    coarse, fine = (np.abs(whole.positions(s * q) - ended.positions(s * q)).max(axis=1) for s in (0.02, 0.01))
    np.testing.assert_allclose(np.log2(coarse / fine), order + 1, atol=0.05)


@pytest.mark.parametrize("turns", [0.4, 3.0])
def test_even_strains_make_a_helix(turns: float) -> None:
    """Twist and both curvatures even along the beam: a screw, by the exponential of a matrix, however far it turns."""
    field = strained(springs=False, offset=False)
    strain = np.array([1.03, 0.02, -0.01, 0.3, -0.7, 0.6]) * np.where(np.arange(6) < 3, 1, turns * 2 * np.pi / LENGTH)
    q = np.zeros(field.size)
    q[::2] = (strain - field.rest[:, -1]) * LENGTH
    x, y, z = strain[3:]
    rate = np.zeros((4, 4))
    rate[:3, :3], rate[:3, 3] = [[0, -z, y], [z, 0, -x], [-y, x, 0]], strain[:3]
    for at, r, rotation in zip([PLACE, LENGTH], field.positions(q)[-2:], field.rotation(q)[-2:], strict=True):
        end = expm(rate * at)
        tolerance = 1e-9 if turns < 1 else 1e-4  # steps of a tenth of a turn
        np.testing.assert_allclose(r, end[:3, 3], atol=LENGTH * tolerance)
        np.testing.assert_allclose(rotation, end[:3, :3], atol=tolerance)


def test_steps_along_the_beam_are_of_sixth_order() -> None:
    """Frames of curvatures that differ along the beam, by the order at which their error falls with the nodes."""
    q = states(6, 1, 1.0, seed=2)[0]

    def frame(nodes: int) -> np.ndarray:
        rule = quadrature(LENGTH, nodes)
        strains = np.zeros((6, nodes, 6))
        for i, k in enumerate((3, 4, 5)):
            strains[k, :, 2 * i : 2 * i + 2] = legendre_shapes(rule.node, LENGTH, 2).slope * 2
        return strain_field(rule, np.array([LENGTH]), strains).rotation(q)[-1]

    truth, sizes = frame(120), np.array([6, 12])
    coarse, fine = (np.abs(frame(nodes) - truth).max() for nodes in sizes)
    assert np.log2(coarse / fine) == pytest.approx(6, abs=1.5)


@pytest.mark.parametrize("name", FIELDS)
def test_a_field_at_some_points_is_the_field_there(name: str) -> None:
    field, at = FIELDS[name], np.array([2, 5, 7])
    q = states(field.size, 1, 0.2, seed=4)[0]
    np.testing.assert_allclose(field[at].positions(q), field.positions(q)[at], atol=1e-14)
    np.testing.assert_allclose(field[at].rotation(q), field.rotation(q)[at], atol=1e-14)
    np.testing.assert_allclose(field.rotation(q, at), field.rotation(q)[at], atol=1e-14)


@pytest.mark.parametrize("name", ["in a plane", "of fourth order, in a plane"])
def test_a_field_is_the_same_under_jax(name: str) -> None:
    """The same lines serve JAX's arrays: positions and rotations compiled, and their derivatives by JAX."""
    field = FIELDS[name][-2:]
    q = states(field.size, 1, 0.2, seed=5)[0]

    @quickly_compiled
    def compiled(field: Any, q: Any) -> Any:
        def both(q: Any) -> Any:
            return field.positions(q), field.rotation(q)

        return both(q), jax.jacfwd(both)(q)

    (r, R), (dr, dR) = compiled(field, q)
    np.testing.assert_allclose(r, field.positions(q), atol=1e-13)
    np.testing.assert_allclose(R, field.rotation(q), atol=1e-13)
    np.testing.assert_allclose(dr, jacobian(field.positions, q), atol=1e-12)
    np.testing.assert_allclose(dR, jacobian(field.rotation, q), atol=1e-12)
