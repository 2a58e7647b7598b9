"""Internal loads: what the base gives is the rate of the particles' momentum; a hub's power that of their energy."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from gbeam import (
    Beam,
    Flight,
    Hub,
    Load,
    Material,
    Model,
    PointMass,
    Root,
    Section,
    Sine,
    Structure,
    assemble,
    constant,
    simulate,
    solve_equilibrium,
    static,
)
from gbeam.analysis import influence
from gbeam.arrays import each_leaf
from gbeam.mechanics import closed_forms, section_forces
from gbeam.results import Base, Loads

from ..differences import along, rate
from ..lagrange import energy_of, hub_kinetic
from ..residuals import on_base
from ..specimens import HUB_RADIUS, TIP, appendage, laden

MATERIAL = Material(2700.0, 70e9)
SPECIMEN = Beam(0.3, Section.rectangle(0.02, 0.004), MATERIAL, damping_ratio=0.0, rotary_inertia=False)
M, L = 2700 * 0.02 * 0.004, 0.3
TAPERED = Beam(
    8.0,
    Section.rectangle([0.02, 0.015, 0.01], [0.01, 0.01, 0.006], stations=[0, 3, 8]),
    MATERIAL,
    [PointMass(8.0, 0.1), PointMass(5.0, 0.3, inertia=(0.02, 0.03, 0.04), offset=(0.05, -0.1, 0.08))],
)
STILL = Base(*np.zeros((3, 3)))
STIFF = np.array([1e-3, 1, 1, 0.01, 0.01, 0.1, 0.1])  # sizes of the laden beam's coordinates: stretch and springs less
SPATIAL = {kind: Model(kind, 1, 2, 2) for kind in ("TLAM", "FOAM", "CFOAM", "exact")}


def carried(structure: Structure, base: Base, q: np.ndarray, qd: np.ndarray, qdd: np.ndarray, **more: Any) -> Loads:
    """Section forces at one time, or at many: arrays (n,) or (t, n)."""
    over_time = each_leaf(np.atleast_2d, base)
    rows = [np.atleast_2d(x) for x in (q, qd, qdd)]
    loads = section_forces(structure, over_time, *rows, np.zeros(len(rows[0])), **more)
    assert loads is not None
    return loads


@pytest.mark.parametrize("kind", SPATIAL)
def test_root_reaction_is_the_rate_of_momentum(kind: str) -> None:
    structure = assemble(TAPERED, SPATIAL[kind], [2.0, 5.0])
    rng = np.random.default_rng(7)
    waves, phase = rng.normal(size=(3, structure.size + 6)), rng.uniform(0, 6, structure.size + 6)
    scale = 0.05 if kind == "exact" else 0.3
    places = structure.particles.positions

    def motion(t: Any) -> np.ndarray:
        """q, v_O and ω over time: random and smooth."""
        s = waves[0] * np.sin(1.3 * t + phase) + waves[1] * np.cos(2.1 * t)
        return np.append(scale * s[:-6], s[-6:])

    def momenta(t: float) -> np.ndarray:
        """Linear momentum and angular momentum about the root, base axes."""
        state, rates = motion(t), along(motion, t, 1.0)
        q, v_O, w = state[:-6], state[-6:-3], state[-3:]
        r, rd = places(q), along(places, q, rates[:-6])
        p = structure.mass[:, None] * (v_O + np.cross(w, r) + rd)
        return np.append(p.sum(axis=0), np.cross(r, p).sum(axis=0))

    times = np.linspace(0.0, 2.0, 5)
    now, first = np.stack([motion(t) for t in times]), np.stack([along(motion, t, 1.0) for t in times])
    second = np.stack([rate(lambda dt, t=t: along(motion, t + dt, 1.0)) for t in times])
    (q, v_O, w), (qd, vd, al), (qdd, _, _) = ((x[:, :-6], x[:, -6:-3], x[:, -3:]) for x in (now, first, second))
    loads = carried(structure, Base(vd + np.cross(w, v_O), w, al), q, qd, qdd)
    for i, t in enumerate(times):
        (p, h), slope = momenta(t).reshape(2, 3), rate(lambda dt, t=t: momenta(t + dt)).reshape(2, 3)
        force = slope[0] + np.cross(w[i], p)
        moment = slope[1] + np.cross(w[i], h) + np.cross(v_O[i], p)
        np.testing.assert_allclose(loads.root_force[i], force, rtol=1e-8, atol=1e-8 * np.abs(force).max())
        np.testing.assert_allclose(loads.root_moment[i], moment, rtol=1e-8, atol=1e-8 * np.abs(moment).max())


@pytest.mark.parametrize("kind", ["CFOAM", "exact"])
def test_power_of_a_driven_hub_is_the_rate_of_energy(kind: str) -> None:
    """Of a beam with a body off its axis and springs at its root, less what its dampers take."""
    structure = laden(kind)
    unloaded, energy, n = replace(structure, history=None), energy_of(structure), structure.size
    rng = np.random.default_rng(3)

    def total(q: np.ndarray, qd: np.ndarray, turn: float) -> float:
        state, rates = np.append(0.0, q), np.append(turn, qd)
        return float(hub_kinetic(energy, HUB_RADIUS, 0.0, np.eye(3), state, rates) + energy.potential(q))

    for _ in range(4):
        q, qd = (rng.normal(size=n) * s * STIFF for s in (0.05, 0.1))
        turn, acceleration = rng.normal(size=2)
        axis = np.array([0.0, 0.0, 1.0])
        root = np.array([-HUB_RADIUS * turn**2, HUB_RADIUS * acceleration, 0.0])
        base = Base(root, turn * axis, acceleration * axis)
        # The residual is linear in q̈.
        rest = on_base(structure, q, qd, 0 * q, base)
        mass = np.stack([on_base(structure, q, qd, each, base) - rest for each in np.eye(n)], axis=1)
        qdd = np.linalg.solve(mass, -rest)
        power = rate(
            lambda t, q=q, qd=qd, qdd=qdd, turn=turn, acceleration=acceleration: total(
                q + qd * t, qd + qdd * t, turn + acceleration * t
            ),
            step=1e-4,
        )
        loads = carried(unloaded, base, q, qd, qdd)
        torque = loads.root_moment[0, 2] + HUB_RADIUS * loads.root_force[0, 1]
        damped = qd @ structure.coefficients.damping @ qd
        np.testing.assert_allclose(torque * turn, power + damped, rtol=1e-9)


@pytest.mark.parametrize("kind", SPATIAL)
def test_uniform_load(kind: str) -> None:
    a, x = 0.01, np.linspace(0, L, 7)  # so small that the arm keeps its length
    structure = assemble(SPECIMEN, SPATIAL[kind], x)
    base = Base(np.array([3 * a, a, a]), np.zeros(3), np.zeros(3))
    q = solve_equilibrium(structure, base).q
    loads = carried(structure, base, q, 0 * q, 0 * q)
    beyond = M * a * (L - loads.stations)
    np.testing.assert_allclose(loads.root_force[0], M * L * a * np.array([3, 1, 1]), rtol=1e-12)
    np.testing.assert_allclose(loads.root_moment[0] / (M * L**2 * a / 2), [0, -1, 1], atol=1e-5)
    np.testing.assert_allclose(
        loads.section_force[0] / (M * L * a), np.outer(beyond / (M * L * a), [-3, -1, -1]), atol=1e-5
    )
    arm = M * a * (L - loads.stations) ** 2 / 2
    np.testing.assert_allclose(loads.section_moment[0, :, 1], arm, atol=1e-5 * arm[0])
    np.testing.assert_allclose(loads.section_moment[0, :, 2], -arm, atol=1e-5 * arm[0])
    # Outer fibre: both bendings, 6M/(bh²) and 6M/(hb²), beside the compression of the forward acceleration.
    bending = 6 * arm / (0.02 * 0.004**2) + 6 * arm / (0.004 * 0.02**2)
    axial = 3 * beyond / (0.02 * 0.004)
    for answer, stress in (
        (loads.stress, bending + axial),
        (loads.stress_tension, bending - axial),
        (loads.stress_compression, -bending - axial),
    ):
        np.testing.assert_allclose(answer[0], stress, rtol=1e-5, atol=1e-5 * bending[0])


def test_bending_moment_is_what_the_section_bends_for() -> None:
    """The integral's moment is the constitutive one: EI_y κ_y, which converges from below with the shapes."""
    base = Base(np.array([0.0, 0.0, 0.1]), np.zeros(3), np.zeros(3))
    errors = []
    for count in (3, 6, 12):
        structure = assemble(SPECIMEN, Model("FOAM", 0, 0, count), [0.1])
        q = solve_equilibrium(structure, base).q
        _, _, along_z, *_ = closed_forms(L, structure.counts)
        about_y = -float(along_z(np.array([0.1])).curvature[0] @ q)
        bent = 70e9 * 0.02 * 0.004**3 / 12 * about_y
        errors.append(abs(bent / (M * 0.1 * (L - 0.1) ** 2 / 2) - 1))
    assert errors[-1] < 0.02 and errors[-1] < errors[0]


def test_bodies_count_as_outboard_of_their_own_station() -> None:
    beam = Beam(L, Section.rectangle(0.02, 0.004), MATERIAL, [PointMass(L, 0.5)])
    structure = assemble(beam, Model("FOAM", 0, 0, 3))
    zero = np.zeros(3)
    loads = carried(structure, Base(np.array([0, 0, 2.0]), zero, zero), zero, zero, zero)
    np.testing.assert_allclose(loads.force[0, :, 2], [-2 * (M * L + 0.5), -1.0])


def test_response_carries_accelerations_and_gravity_hangs_on_the_root() -> None:
    structure = assemble(SPECIMEN, Model("FOAM", 1, 1, 3))
    response = simulate(structure, Flight(z=constant(9.80665)), duration=0.05)
    loads = response.loads
    assert loads is not None
    assert response.body.qdd.shape == response.q.shape
    np.testing.assert_allclose(loads.root_force[:, 2], M * L * 9.80665, rtol=1e-6)  # it starts in equilibrium
    np.testing.assert_allclose(loads.acceleration[:, -1, 2], 9.80665, rtol=1e-6)


def test_loads_on_the_beam_are_carried_to_the_root() -> None:
    loads = [Load(L, force=(0, 0, 5.0)), Load(distributed=(0, 2.0, 0)), Load(0.1, moment=(0, 0.3, 0))]
    beam = Beam(L, Section.rectangle(0.02, 0.004), MATERIAL, loads=loads)
    structure = assemble(beam, Model("FOAM", 0, 2, 3), [0.2])
    q = np.zeros(5)
    answer = carried(structure, STILL, q, q, q)
    np.testing.assert_allclose(answer.root_force[0], [0, -2 * L, -5], atol=1e-12)
    np.testing.assert_allclose(answer.root_moment[0], [0, 5 * L - 0.3, -2 * L**2 / 2], atol=1e-12)
    np.testing.assert_allclose(answer.section_force[0, 1], [0, 2 * (L - 0.2), 5], atol=1e-12)
    np.testing.assert_allclose(answer.section_moment[0, 1], [0, -5 * (L - 0.2), 2 * (L - 0.2) ** 2 / 2], atol=1e-12)


def test_sprung_root_carries_the_same() -> None:
    beam = Beam(L, Section.rectangle(0.02, 0.004), MATERIAL, root=Root(rotation_y=200.0, translation_z=1e5))
    structure = assemble(beam, Model("FOAM", 0, 0, 3))
    zero, q = np.zeros(3), np.zeros(5)
    answer = carried(structure, Base(np.array([0, 0, 2.0]), zero, zero), q, q, q)
    np.testing.assert_allclose(answer.root_force[0], [0, 0, 2 * M * L], rtol=1e-12)
    np.testing.assert_allclose(answer.root_moment[0], [0, -(M * L**2), 0], rtol=1e-12, atol=1e-18)


def test_unknown_fibres_leave_the_stress_open() -> None:
    beam = Beam(L, Section.general(8e-5, 1e-10, 2e-9), MATERIAL)
    structure = assemble(beam, Model("FOAM", 1, 1, 1))
    zero = np.zeros(3)
    assert np.isnan(carried(structure, STILL, zero, zero, zero).stress).all()


def test_static_influence_of_a_uniform_cantilever() -> None:
    answer = influence(assemble(SPECIMEN, Model("FOAM", 4, 8, 8)))
    ei = 70e9 * np.array([0.004 * 0.02**3, 0.02 * 0.004**3]) / 12
    np.testing.assert_allclose(answer.tip_uniform[1:], -M * L**4 / 8 / ei, rtol=1e-5)
    np.testing.assert_allclose(answer.tip_linear[1:], -M * L**5 * 11 / 120 / ei, rtol=1e-5)
    np.testing.assert_allclose(answer.moment_linear[1:], -M * L**3 / 3, rtol=1e-12)
    np.testing.assert_allclose(answer.force_linear, -M * L**2 / 2, rtol=1e-12)


@pytest.mark.parametrize(("pointing", "angle"), [("outward", 0.0), ("inward", 0.6)])
def test_torque_for_the_beam_and_the_hub_is_what_drives_them(pointing: str, angle: float) -> None:
    """Torque less what spring and damper take, however the beam is mounted; in gravity too."""
    structure = assemble(appendage(TIP), Model("CFOAM", 1, 1, 1))
    hub = Hub(
        radius=0.5,
        inertia=20.0,
        torque=Sine(10.0, 0.4),
        pointing=pointing,
        setting_angle=angle,
        gravity=[1.0, 2.0, -9.8],
        stiffness=30.0,
        damping=2.0,
    )
    response = simulate(structure, hub, duration=0.2, step=2e-3, estimate=False)
    loads = response.loads
    assert response.hub is not None and loads is not None and loads.drive_torque is not None
    left = response.hub.drive_torque - 30.0 * response.hub.angle - 2.0 * response.hub.rate
    np.testing.assert_allclose(loads.drive_torque, left, atol=1e-6 * np.abs(left).max())
    assert loads.beam_torque is not None
    np.testing.assert_allclose(loads.beam_torque, left - 20.0 * response.hub.acceleration, atol=1e-6)


def test_static_loads_are_those_of_the_frozen_slew() -> None:
    """At rest on a steadily turning hub: the centripetal force of the beam, and no torque for it."""
    structure = assemble(SPECIMEN, Model("FOAM", 2, 2, 0), [0.0, 0.15])
    rest = static(structure, Hub(radius=0.4, rate=constant(5.0)), 0.0)
    assert rest.loads is not None and rest.loads.beam_torque is not None
    np.testing.assert_allclose(rest.loads.root_force[0], [-M * 25 * (0.4 * L + L**2 / 2), 0, 0], rtol=1e-5)
    np.testing.assert_allclose(
        rest.loads.section_force[0, -2, 0], M * 25 * (0.4 * 0.15 + (L**2 - 0.15**2) / 2), rtol=1e-5
    )
    assert abs(rest.loads.beam_torque[0]) < 1e-12
    assert rest.loads.stress[0, 0] == pytest.approx(-rest.loads.root_force[0, 0] / 8e-5)
