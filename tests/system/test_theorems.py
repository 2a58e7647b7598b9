"""Theorems on random trees: Lagrange's equations, rates as derivatives, momentum, reciprocity, cuts, exchanges."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import gbeam as gb
from gbeam.mechanics import (
    measurements,
    parameters_of_matrices,
    rotation_by_parameters,
    rotation_by_vector,
    rotation_vector,
    signals_of,
    turned,
)
from gbeam.numerics import STEP
from tests.system.trees import JOINTS, flexible, tree

LINK = st.tuples(
    st.sampled_from(["rigid", "rigid", "exact", "FOAM", "CFOAM", "fourth-order", "particles"]),
    st.sampled_from(JOINTS),
    st.integers(0, 8),
)
GRAVITY = np.array([1.0, 2.0, -9.0])


def _lagrange(system: gb.System, y: np.ndarray, yd: np.ndarray, ydd: np.ndarray) -> np.ndarray:
    """d/dt ∂T/∂ẏ − ∂(T − U)/∂y: T is quadratic in the rates, so that its derivative is a difference, and exact."""
    inputs = system.inputs(np.asarray(0.0))

    def energies(q: np.ndarray, qd: np.ndarray) -> np.ndarray:
        return system.tree.invariants(system.tree.motion(q, qd, 0 * qd, inputs), GRAVITY)[2]

    n, eye = len(y), np.eye(len(y))
    at, rate = y + 1j * STEP * yd, yd + 1j * STEP * ydd
    along = energies(np.tile(at, (n, 1)), rate + eye)[:, 0] - energies(at, rate)[0]
    momentum = (along - energies(np.tile(at, (n, 1)), eye + 0j)[:, 0]).imag / STEP
    parts = energies(y + 1j * STEP * eye, np.tile(yd + 0j, (n, 1))).imag / STEP
    return momentum - parts[:, 0] + parts[:, 1] + parts[:, 2]


@settings(max_examples=40)
@given(st.lists(LINK, min_size=1, max_size=5), st.integers(0, 1000))
def test_dalembert_is_lagrange(kinds: list[tuple[str, str, int]], seed: int) -> None:
    kinds = [(body, "universal" if held in ("spherical", "free") else held, on) for body, held, on in kinds]
    system = tree(kinds, seed)
    y, yd, ydd = 0.3 * np.random.default_rng(seed).normal(size=(3, system.tree.size))
    alone = gb.System(system.bodies, system.joints, gravity=GRAVITY)
    rows = alone.tree(y, yd, ydd, alone.inputs(np.asarray(0.0)))
    np.testing.assert_allclose(
        rows, _lagrange(alone, y, yd, ydd), rtol=1e-9, atol=1e-10 * np.abs(rows).max(initial=1.0)
    )


@settings(max_examples=25)
@given(st.lists(LINK, min_size=1, max_size=4), st.integers(0, 1000))
def test_rates_of_points_are_derivatives(kinds: list[tuple[str, str, int]], seed: int) -> None:
    system = tree(kinds, seed)
    y, yd, ydd = 0.3 * np.random.default_rng(seed).normal(size=(3, system.tree.size))
    y = y + (np.array([name.endswith("e0") for name in system.coordinates]) * 1.0)
    inputs, step = system.inputs(np.asarray(0.0)), 1j * STEP
    moving = system.tree.motion(y + step * yd, yd + step * ydd, ydd + 0j, inputs)
    for frame in moving.every_point:
        velocity = turned(frame.R, frame.v)
        np.testing.assert_allclose(frame.p.imag / STEP, velocity.real, rtol=1e-9, atol=1e-9)
        specific = turned(frame.R.real, frame.a.real) + GRAVITY
        np.testing.assert_allclose(velocity.imag / STEP, specific, rtol=1e-8, atol=1e-8 * (10 + np.abs(specific).max()))
        spin = frame.R.real.T @ frame.R.imag / STEP
        np.testing.assert_allclose([spin[2, 1], spin[0, 2], spin[1, 0]], frame.w.real, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(frame.w.imag / STEP, frame.alpha.real, rtol=1e-8, atol=1e-8)


@settings(max_examples=15)
@given(st.lists(LINK, min_size=1, max_size=4), st.integers(0, 1000))
def test_forces_do_their_work_and_euler_parameters_are_a_rotation_vector(
    kinds: list[tuple[str, str, int]], seed: int
) -> None:
    """A force and a moment on a point do work as the point moves, in the coordinates and in those local to a place."""
    system = tree([("rigid", "free", 0), *kinds], seed)
    y, yd, ydd = 0.3 * np.random.default_rng(seed).normal(size=(3, system.tree.size))
    y = y + (np.array([name.endswith("e0") for name in system.coordinates]) * 1.0)
    pushed, still = system.inputs(np.asarray(0.0)), gb.System(system.bodies, system.joints, gravity=GRAVITY)
    local, q, qd, qdd = system.tree.local(y, yd, ydd)
    without = gb.System(system.bodies, system.joints, gravity=GRAVITY).tree.local(y, yd, ydd)[0]
    force = without(q, qd, qdd, still.inputs(np.asarray(0.0))) - local(q, qd, qdd, pushed)
    body, point = system.tree.forces[0].body, system.tree.forces[0].on
    moving = local.motion(q + 1j * STEP * np.eye(len(q)), 0j * np.eye(len(q)), 0j * np.eye(len(q)), pushed)
    frame = moving.points_of(body)[point]
    turn = (frame.R.imag / STEP) @ frame.R[0].real.T
    angle = np.stack([turn[:, 2, 1], turn[:, 0, 2], turn[:, 1, 0]], axis=1)
    work = frame.p.imag / STEP @ [1.0, 2.0, 3.0] + angle @ [0.3, 0.2, 0.1]
    np.testing.assert_allclose(force, work, rtol=1e-8, atol=1e-8 * np.abs(work).max(initial=1.0))
    # And the points are where they were.
    whole, reduced = (
        state.every_point for state in (system.tree.motion(y, yd, ydd, pushed), local.motion(q, qd, qdd, pushed))
    )
    for one, other in zip(whole, reduced, strict=True):
        for name in ("R", "p", "v", "w", "a", "alpha"):
            np.testing.assert_allclose(getattr(one, name), getattr(other, name), rtol=1e-9, atol=1e-9)


def test_free_tree_keeps_momentum() -> None:
    """The rows of a free joint are the rate of momentum: no inner force changes it."""
    system = tree([("rigid", "free", 0), ("exact", "fixed", 1), ("FOAM", "revolute", 1), ("rigid", "spherical", 4)], 3)
    system = gb.System(system.bodies, system.joints)
    y, yd = 0.3 * np.random.default_rng(1).normal(size=(2, system.tree.size))
    y[3] = 1.0
    inputs = system.inputs(np.asarray(0.0))
    rest = system.tree(y, yd, 0 * y, inputs)
    mass = (system.tree(np.tile(y, (len(y), 1)), np.tile(yd, (len(y), 1)), np.eye(len(y)), inputs) - rest).T
    ydd = np.linalg.solve(mass, -rest)
    state = system.tree.motion(y + 1j * STEP * yd, yd + 1j * STEP * ydd, 0 * yd, inputs)
    moving = system.tree.invariants(state, np.zeros(3))
    large = np.abs(ydd).max()
    for rate, size in zip(moving, (large, large, np.abs(moving[2].imag).max() / STEP), strict=True):
        np.testing.assert_allclose(rate.imag.sum() / STEP, 0.0, atol=1e-10 * size)


def test_reciprocity() -> None:
    """Displacement at one point by a force at another is the same with the two exchanged, at every frequency."""
    system = tree([("rigid", "sprung", 0), ("exact", "fixed", 1), ("FOAM", "revolute", 4)], 5)
    places = ("b1.middle", "b2.tip")
    forces = {f"at{k}": gb.PointForce(place) for k, place in enumerate(places)}
    held = gb.System(system.bodies, system.joints, forces)
    names = [f"at{k}.force_{axis}" for k in (0, 1) for axis in "xyz"]
    plant = gb.linearize(held, inputs=names, outputs=[f"{place}.place_{axis}" for place in places for axis in "xyz"])
    gain = plant.c @ np.linalg.solve(30j * np.eye(len(plant.a)) - plant.a, plant.b) + plant.d
    np.testing.assert_allclose(gain, gain.T, rtol=1e-8, atol=1e-10 * np.abs(gain).max())


def test_a_beam_cut_in_two_is_the_beam() -> None:
    section, material = gb.Section.rectangle(0.03, 0.02), gb.Material(2700.0, 70e9, poissons_ratio=0.3)
    shapes = {"axial": 3, "y": 7, "z": 7, "twist": 4, "shear_y": 6, "shear_z": 6}
    parts = [
        gb.assemble(gb.Beam(length, section, material, damping_ratio=0.0, rotary_inertia=True), "exact", **shapes)
        for length in (1.0, 0.4, 0.6)
    ]
    whole = gb.System({"a": parts[0]}, {"clamp": gb.Joint("fixed", "a")})
    cut = gb.System(
        {"a": parts[1], "b": parts[2]}, {"clamp": gb.Joint("fixed", "a"), "weld": gb.Joint("fixed", "b", "a.tip")}
    )
    np.testing.assert_allclose(
        gb.modes(cut, errors=False).frequency[:4], gb.modes(whole, errors=False).frequency[:4], rtol=1e-7
    )
    load = {"push": gb.PointForce("a.tip", (0.0, 3e3, 2e3))}, {"push": gb.PointForce("b.tip", (0.0, 3e3, 2e3))}
    bent = [gb.static(gb.System(each.bodies, each.joints, f)) for each, f in zip((whole, cut), load, strict=True)]
    np.testing.assert_allclose(bent[0].at("a.tip"), bent[1].at("b.tip"), rtol=1e-6)
    assert np.linalg.norm(bent[0].displacement[0]) > 0.3


@pytest.mark.parametrize("kind", ["exact", "fourth-order", "FOAM", "CFOAM"])
def test_structure_on_a_hub_is_a_system(kind: str) -> None:
    """On a free hub, and on one whose rate is prescribed, by a joint and by the motion of the ground."""
    structure = flexible(kind)
    hub = gb.RigidBody(1.0, (4.0, 4.0, 5.0), points={"rim": (0.4, 0, 0)})
    turn = gb.Joint("revolute", "hub", axes=[(0, 0, 1)])
    system = gb.System({"hub": hub, "beam": structure}, {"axis": turn, "clamp": gb.Joint("fixed", "beam", "hub.rim")})
    modes = gb.modes(structure, gb.Hub(radius=0.4, inertia=5.0), errors=False)
    np.testing.assert_allclose(gb.modes(system, errors=False).frequency, modes.frequency, rtol=1e-9)
    rate = gb.trapezoid(2.0, jerk=4.0, start=0.0, hold=0.3)
    driven = gb.System(
        system.bodies, {**system.joints, "axis": gb.Joint("revolute", "hub", axes=[(0, 0, 1)], rate=rate)}
    )
    carried = gb.System({"beam": structure}, {"clamp": gb.Joint("fixed", "beam")})
    motion = gb.Hub(radius=0.4, rate=rate)
    y, yd, ydd = 0.1 * np.random.default_rng(2).normal(size=(3, structure.size))
    for t in (0.3, 0.7):
        inputs = driven.inputs(np.asarray(t)), carried.inputs(np.asarray(t), motion)
        np.testing.assert_allclose(driven.tree(y, yd, ydd, inputs[0]), carried.tree(y, yd, ydd, inputs[1]), rtol=1e-10)
        base = motion.base(np.asarray(t))
        single = structure.equations.residual(y, yd, ydd, base.a_WO_B, base.w_WB_B, base.alpha_WB_B)
        np.testing.assert_allclose(single, carried.tree(y, yd, ydd, inputs[1]), rtol=1e-9, atol=1e-9)


def test_rotations() -> None:
    rng = np.random.default_rng(0)
    phi, rate, change = rng.normal(size=(3, 50, 3)) * np.geomspace(1e-4, 3, 50)[:, None]
    step = 1j * STEP
    R, w, alpha = rotation_by_vector(phi + step * rate, rate + step * change, change + 0j, plane=False)
    np.testing.assert_allclose(R.real @ np.swapaxes(R.real, 1, 2), np.broadcast_to(np.eye(3), R.shape), atol=1e-14)
    spin = np.swapaxes(R.real, 1, 2) @ R.imag / STEP
    np.testing.assert_allclose(spin[:, [2, 0, 1], [1, 2, 0]], w.real, rtol=1e-11, atol=1e-14)
    np.testing.assert_allclose(w.imag / STEP, alpha.real, rtol=1e-10, atol=1e-14)
    np.testing.assert_allclose(rotation_by_parameters(parameters_of_matrices(R.real)), R.real, atol=1e-14)
    short = np.linalg.norm(phi, axis=1) < 3.0
    back = rotation_vector(parameters_of_matrices(R[short]))
    np.testing.assert_allclose(back.real, phi[short], rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose(back.imag / STEP, rate[short], rtol=1e-10, atol=1e-13)


def test_measurements_are_those_of_results() -> None:
    system = tree([("rigid", "free", 0), ("exact", "revolute", 1)], 2)
    response = gb.simulate(gb.System(system.bodies, system.joints), duration=0.02, step=0.01, estimate=False)
    names = list(signals_of(system))
    still = gb.System(system.bodies, system.joints)
    zero = np.zeros_like(response.q)
    read = measurements(still, still.tree, response.q, response.qd, zero, still.inputs(response.time), names)
    np.testing.assert_allclose(read[:, names.index("b1.tip.place_y")], response.at("b1.tip")[:, 1], rtol=1e-12)
    np.testing.assert_allclose(read[:, names.index("b1.tip.attitude_y")], response.signal("b1.tip.attitude_y"))
    np.testing.assert_allclose(read[:, names.index("j1.angle")], response.coordinate("j1.angle"))
