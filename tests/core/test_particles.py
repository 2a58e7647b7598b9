"""A structure that is not a beam: whatever gives masses, places and their derivatives, or a geometric stiffness."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import gbeam as gb
from gbeam.mechanics import Geometric
from gbeam.results import Base

from ..specimens import HUB_RADIUS, hub_beam

LOADS = 1e-4  # of the largest: what ends at second order in the coordinates beside what ends at the places
SAME = 1e-10  # relative
SLEW = gb.Hub(radius=HUB_RADIUS, rate=gb.SmoothStep(3.0, 2.0))


def geometric(structure: gb.Structure) -> Geometric:
    """Σ m H in the fields of unit inertial loads, particle by particle."""
    axes = np.eye(3)
    r0, second, mass = structure.places.r0, structure.places.second, structure.mass

    def weighted(field: np.ndarray) -> np.ndarray:
        return np.einsum("k,ka,kaij->ij", mass, field, second)

    al = [weighted(np.cross(e, r0)) for e in axes]
    ww = [[weighted(np.cross(e, np.cross(f, r0)) + np.cross(f, np.cross(e, r0))) / 2 for f in axes] for e in axes]
    return Geometric(np.array([weighted(e + 0 * r0) for e in axes]), np.array(al), np.array(ww))


@cache
def beam() -> gb.Structure:
    return hub_beam("FOAM", 1, 2, 2, damping_ratio=0.01)


@cache
def particles(*, by_stress: bool) -> gb.Structure:
    """The particles of that beam, with their second derivatives or with the geometric stiffness in their place."""
    whole = beam()
    places = {"geometric": geometric(whole)} if by_stress else {"second": whole.places.second}
    return gb.Structure.of_particles(
        whole.mass,
        whole.places.r0,
        whole.places.first,
        whole.coefficients.stiffness,
        damping_ratio=0.01,
        **places,  # type: ignore[arg-type]
    )


@pytest.mark.parametrize("by_stress", [False, True])
def test_particles_of_a_beam_are_the_beam(by_stress: bool) -> None:
    ours, whole = particles(by_stress=by_stress), beam()
    assert ours.size == whole.size and ours.length == pytest.approx(8.0)
    for name in ("mass", "damping", "stiffness", "gyroscopic", "k_ww", "k_al", "k_a", "f_ww", "f_al", "f_a", "rigid"):
        theirs = getattr(whole.coefficients, name)
        np.testing.assert_allclose(getattr(ours.coefficients, name), theirs, atol=1e-12 * max(np.abs(theirs).max(), 1))
    spinning = gb.Hub(radius=HUB_RADIUS, rate=gb.constant(2.0))
    answer, wanted = gb.modes(ours, spinning, errors=False), gb.modes(whole, spinning, errors=False)
    np.testing.assert_allclose(answer.frequency, wanted.frequency, rtol=SAME)
    np.testing.assert_allclose(answer.damping_ratio, wanted.damping_ratio, rtol=1e-8)
    assert answer.direction == wanted.direction
    rests = [gb.static(s, acceleration=(1.0, 2.0, 3.0)) for s in (ours, whole)]
    np.testing.assert_allclose(rests[0].q, rests[1].q, rtol=SAME)
    np.testing.assert_allclose(rests[0].strain_energy, rests[1].strain_energy, rtol=SAME)
    np.testing.assert_allclose(rests[0].tip[1:], rests[1].tip[1:], rtol=SAME)
    carried = [each.loads for each in rests]
    for name in ("root_force", "root_moment"):  # to third order in the coordinates
        of_particles, of_sections = (getattr(each, name) for each in carried)
        np.testing.assert_allclose(of_particles, of_sections, atol=LOADS * np.abs(of_sections).max())
    curves = [gb.campbell(s, SLEW, end=3.0, count=4, modes=3) for s in (ours, whole)]
    np.testing.assert_allclose(curves[0].frequency, curves[1].frequency, rtol=SAME)


@pytest.mark.parametrize("by_stress", [False, True])
def test_particles_of_a_beam_respond_as_the_beam_does(by_stress: bool) -> None:
    bodies = particles(by_stress=by_stress), beam()
    ours, theirs = (gb.simulate(s, SLEW, duration=4.0, step=0.02, integrator="newmark") for s in bodies)
    np.testing.assert_allclose(ours.q, theirs.q, atol=SAME * np.abs(theirs.q).max())
    np.testing.assert_allclose(ours.tip[:, 1:], theirs.tip[:, 1:], atol=SAME * np.abs(theirs.tip).max())
    steps = [each.errors.displacement.step for each in (ours, theirs)]
    # Without second derivatives of the places the tip has no displacement of second order, along x, and its error none.
    assert ours.outcome == "done" and steps[0] == pytest.approx(steps[1], rel=0.1 if by_stress else 1e-5)
    assert ours.error_estimate == steps[0] and "not judged" in ours.errors.note  # shapes and model
    assert ours.loads is not None and theirs.loads is not None
    force, moment = ([getattr(each.loads, name) for each in (ours, theirs)] for name in ("root_force", "root_moment"))
    np.testing.assert_allclose(force[0], force[1], atol=LOADS * np.abs(force[1]).max())
    # The moment of sections has terms of third order, which are large where the tip moves by most of the length.
    begin = int(np.argmax(np.linalg.norm(theirs.tip, axis=1) > 0.02 * 8.0))
    assert begin > 10
    scale = np.abs(moment[1][:begin]).max()
    np.testing.assert_allclose(moment[0][:begin], moment[1][:begin], atol=5e-3 * scale)


def test_particles_on_a_free_hub() -> None:
    free = gb.Hub(radius=HUB_RADIUS, inertia=200.0, torque=gb.constant(20.0))
    ours, theirs = (
        gb.simulate(s, free, duration=1.0, step=0.02, estimate=False) for s in (particles(by_stress=True), beam())
    )
    assert ours.hub is not None and theirs.hub is not None
    np.testing.assert_allclose(ours.hub.angle, theirs.hub.angle, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(ours.q, theirs.q, atol=1e-9 * np.abs(theirs.q).max())


def test_one_of_second_derivatives_and_geometric_stiffness() -> None:
    whole = beam()
    arguments = whole.mass, whole.places.r0, whole.places.first, whole.coefficients.stiffness
    for both in ({}, {"second": whole.places.second, "geometric": geometric(whole)}):
        with pytest.raises(gb.InputError, match="exactly one"):
            gb.Structure.of_particles(*arguments, **both)  # type: ignore[arg-type]


# --- a blade of cubic finite elements, without dimensions: ρA = EI = L = 1


@cache
def blade(tip: float = 0.0, elements: int = 24) -> gb.Structure:
    """Point masses at the Gauss points of Hermite's elements, held by their tension in unit inertial loads.

    Coordinates are the deflections along z and the slopes of the nodes; a point mass at the tip.
    """
    h, size = 1 / elements, 2 * elements + 2
    s, weight = (np.polynomial.legendre.leggauss(5)[0] + 1) / 2, np.polynomial.legendre.leggauss(5)[1] / 2
    shape = [1 - 3 * s**2 + 2 * s**3, h * (s - 2 * s**2 + s**3), 3 * s**2 - 2 * s**3, h * (s**3 - s**2)]
    slope = np.array([-6 * s + 6 * s**2, h * (1 - 4 * s + 3 * s**2), 6 * s - 6 * s**2, h * (3 * s**2 - 2 * s)]) / h
    curve = np.array([-6 + 12 * s, h * (-4 + 6 * s), 6 - 12 * s, h * (6 * s - 2)]) / h**2
    x = (np.arange(elements)[:, None] + s) * h
    moved = np.zeros((elements, len(s), size))
    stiffness, pushed, spun = np.zeros((3, size, size))
    for k in range(elements):
        ends = slice(2 * k, 2 * k + 4)
        moved[k, :, ends] = np.transpose(shape)
        stiffness[ends, ends] += (curve * weight * h) @ curve.T
        # Tension of the mass outboard: an acceleration of the root pushes it, a spin pulls it out.
        pushed[ends, ends] -= (slope * weight * h * (1 - x[k] + tip)) @ slope.T
        spun[ends, ends] += (slope * weight * h * ((1 - x[k] ** 2) / 2 + tip)) @ slope.T
    first = np.zeros((elements * len(s) + 1, 3, size))
    first[:-1, 2] = moved.reshape(-1, size)
    first[-1, 2, -2] = 1.0
    a, ww = np.zeros((3, size, size)), np.zeros((3, 3, size, size))
    a[0], ww[1, 1], ww[2, 2] = pushed, spun, spun
    clamped = slice(2, None)
    return gb.Structure.of_particles(
        np.append(np.tile(weight * h, elements), tip),
        np.stack([np.append(x.ravel(), 1.0), *np.zeros((2, elements * len(s) + 1))], axis=1),
        first[..., clamped],
        stiffness[clamped, clamped],
        geometric=Geometric(a[:, clamped, clamped], np.zeros((3, size - 2, size - 2)), ww[..., clamped, clamped]),
        kind="finite elements",
    )


# Wright et al. (1982), J. Appl. Mech. 49, 197: flap against the speed, without and with a tip mass of the blade's mass.
FLAP = {0: (3.516015, 22.034492, 61.697214), 6: (7.360373, 26.809082, 66.683914), 12: (13.17015, 37.603112, 79.614478)}
TIP_MASS = {0: (1.5573, 16.25009), 5: (5.52185, 26.04153), 12: (12.48137, 50.85939)}


def spin(rate: float) -> gb.Hub:
    return gb.Hub(radius=0.0, rate=gb.constant(float(rate)))


@pytest.mark.parametrize("rate", FLAP)
def test_rotating_blade_of_finite_elements(rate: float) -> None:
    vibration = gb.modes(blade(), spin(rate))
    np.testing.assert_allclose(2 * np.pi * vibration.frequency[:3], FLAP[rate], rtol=1e-5)
    assert vibration.model == "finite elements" and set(vibration.direction) == {"z"}


@pytest.mark.parametrize("rate", TIP_MASS)
def test_rotating_blade_of_finite_elements_with_a_tip_mass(rate: float) -> None:
    vibration = 2 * np.pi * gb.modes(blade(1.0), spin(rate)).frequency[:2]
    np.testing.assert_allclose(vibration, TIP_MASS[rate], rtol=1e-4)


def test_blade_of_finite_elements_under_steady_loads() -> None:
    """At rest w L⁴/8EI; compressed, Greenhill's column."""
    rest = gb.static(blade(), acceleration=(0.0, 0.0, 1e-3))
    assert rest.tip[2] == pytest.approx(-1e-3 / 8, rel=1e-6)
    for push, stable in ((7.83, True), (7.84, False)):
        assert gb.solve_equilibrium(blade(), Base(np.array([push, 0.0, 0.0]), *np.zeros((2, 3)))).stable == stable
    few = blade(elements=8)
    diagram = gb.campbell(few, spin(0.0), end=12.0, count=4, modes=2)
    np.testing.assert_allclose(2 * np.pi * diagram.frequency[-1], FLAP[12][:2], rtol=3e-4)
    held = gb.simulate(few, gb.Flight(z=gb.constant(1e-3)), duration=1.0, step=0.02)
    np.testing.assert_allclose(held.tip[:, 2], -1e-3 / 8, rtol=1e-6)


def pendulum(mass: float = 2.0, arm: float = 0.4, spring: float = 12.0) -> gb.Structure:
    """A mass on an arm without mass, on a hinge with a spring."""
    return gb.Structure.of_particles(
        np.array([mass]),
        np.array([[arm, 0.0, 0.0]]),
        np.array([[[0.0], [arm], [0.0]]]),
        np.array([[spring]]),
        second=np.array([[[[-arm]], [[0.0]], [[0.0]]]]),
    )


@pytest.mark.parametrize("rate", [0.0, 5.0, 10.0])
def test_pendulum_on_a_rotor(rate: float) -> None:
    """ω² = k/(mL²) + Ω² r/L, the law of centrifugal pendulums."""
    vibration = gb.modes(pendulum(), gb.Hub(radius=0.5, rate=rate)).frequency
    assert 2 * np.pi * vibration == pytest.approx([np.sqrt(12 / (2 * 0.4**2) + rate**2 * 0.5 / 0.4)], rel=1e-12)


def test_pendulum_that_points_inward_falls_over() -> None:
    """Beyond the critical speed no mode of it oscillates."""
    inward = gb.Hub(radius=0.5, pointing="inward")
    assert gb.critical_speed(pendulum(), inward).value == pytest.approx(np.sqrt(12 / (2 * 0.4 * 0.5)), rel=1e-9)
    fallen = gb.modes(pendulum(), gb.Hub(radius=0.5, pointing="inward", rate=6.0))
    assert fallen.frequency.size == 0 and not fallen.stable


def carriage(spring: float = 100.0) -> gb.Structure:
    """A kilogram on a spring across the root, 10 mm out."""
    slope = np.array([[[0.0], [1.0], [0.0]]])
    return gb.Structure.of_particles(
        np.ones(1),
        np.array([[0.01, 0.0, 0.0]]),
        slope,
        np.array([[spring]]),
        second=np.zeros((1, 3, 1, 1)),
        damping_ratio=0.05,
    )


def test_a_particle_moves_farther_than_it_rests_from_the_root() -> None:
    """2 F / k but for the damping; a beam's length had stopped it at 10 mm, and told it to use exact."""
    pulled = gb.simulate(carriage(), gb.Flight(y=gb.constant(10.0)), duration=0.5, step=0.01, initial="undeformed")
    overshoot = 1 + np.exp(-np.pi * 0.05 / np.sqrt(1 - 0.05**2))
    assert pulled.outcome == "done" and pulled.peaks.max_size == pytest.approx(0.1 * overshoot, rel=2e-3)
    assert any("no particle rests farther than 0.01 m" in each for each in pulled.warnings)


def test_particles_that_fall_over_have_diverged_and_are_told_of_no_other_model() -> None:
    """A rate from the start on pushes along the arm alone; a quick spin-up bends it far, so that it is not known."""
    start, name = gb.Initial(acceleration=(0.0, 1.0, 0.0)), "inward"
    inward, quick = (
        gb.Hub(radius=0.5, pointing=name, rate=rate) for rate in (gb.constant(20.0), gb.SmoothStep(20.0, 0.5))
    )
    bent = gb.simulate(pendulum(), quick, duration=10.0, step=0.01, initial=start)
    assert bent.outcome == "not known" and "its stiffness is of first order in that" in bent.message
    fallen = gb.simulate(pendulum(), inward, duration=10.0, step=0.01, initial=start)
    assert fallen.outcome == "diverged" and "exceeded 1e+09 m" in fallen.message
    assert "stiffness is not positive definite" in fallen.message and "exact" not in fallen.message


@pytest.mark.parametrize(
    ("by_stress", "motion"),
    [
        (False, gb.Flight(z=gb.constant(1.0))),
        *((by, gb.Hub(radius=HUB_RADIUS, rate=gb.constant(2.0))) for by in (False, True)),
        *((by, gb.Hub(radius=HUB_RADIUS, inertia=200.0, torque=gb.constant(0.0))) for by in (False, True)),
    ],
)
def test_particles_of_a_beam_are_linearized_as_the_beam(by_stress: bool, motion: gb.Flight | gb.Hub) -> None:
    ours, whole = (gb.linearize(s, motion) for s in (particles(by_stress=by_stress), beam()))
    for name in "abcd":
        theirs = getattr(whole, name)
        np.testing.assert_allclose(getattr(ours, name), theirs, atol=1e-12 * np.abs(theirs).max())
    assert (ours.inputs, ours.outputs) == (whole.inputs, whole.outputs)
    assert [each.name for each in ours.states if "q_1" in each.name] == ["q_1", "rate_q_1"]
    with pytest.raises(gb.InputError, match="gauges are given of no beam and no mesh"):
        gb.linearize(particles(by_stress=by_stress), motion, gauges=[gb.Gauge(1.0)])


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"mass": np.array([-1.0])}, r"mass\[0\] is -1 kg"),
        ({"mass": np.array([0.0])}, "leaves a motion of the coordinates without mass"),
        ({"r0": np.zeros((1, 2))}, r"r0 has the shape \(1, 2\); give \(1, 3\)"),
        ({"stiffness": np.array([[np.nan]])}, "stiffness has values that are not finite"),
    ],
)
def test_particles_that_cannot_be_are_refused(changed: dict[str, np.ndarray], words: str) -> None:
    sound = {"mass": np.ones(1), "r0": np.zeros((1, 3)), "first": np.ones((1, 3, 1)), "stiffness": np.eye(1)}
    with pytest.raises(gb.InputError, match=words):
        gb.Structure.of_particles(**(sound | changed), second=np.zeros((1, 3, 1, 1)))
