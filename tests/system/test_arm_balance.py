"""Several items on a plain arm: the imbalance by hand, the counterweight that cures it, and a swing platform."""

import numpy as np
import pytest
from scipy.optimize import brentq

import gbeam as gb

G, RADIUS, CONTROL = 9.80665, 3.0, np.array([3.0, 0.0, 0.052])
ITEMS = {"radio": (6.5, (3.0, 0.0, 0.052)), "camera": (2.0, (-2.5, 0.2, 0.03))}


def spun(items, level=9 * G, **changed):
    """Response of rigid items, by mass and centre from the axis, on an arm with its ground at the axis."""
    bodies = {name: gb.RigidBody(mass, (0.02, 0.03, 0.04)) for name, (mass, _) in items.items()}
    joints = {name: gb.Joint("fixed", name, at=centre) for name, (_, centre) in items.items()}
    arm = gb.plain_arm(
        radius=RADIUS, control_point=CONTROL, load="-x", up="+z", level=level, ramp=5.0, dwell=10.0, **changed
    )
    return gb.simulate(gb.System(bodies, joints), arm, duration=20.0, step=0.05)


@pytest.mark.parametrize("gravity", [True, False])
def test_the_imbalance_is_the_sum_of_masses_times_places(gravity):
    imbalance = spun(ITEMS, gravity=gravity).hub.imbalance
    static = sum(mass * np.array([x, y, 0.0]) for mass, (x, y, z) in ITEMS.values())
    dynamic = sum(mass * (z - CONTROL[2]) * np.array([x, y, 0.0]) for mass, (x, y, z) in ITEMS.values())
    assert imbalance.static == pytest.approx(static, abs=1e-9)
    assert imbalance.dynamic == pytest.approx(dynamic, abs=1e-9)
    assert imbalance.counterweight == pytest.approx(np.linalg.norm(static) / RADIUS)


def test_the_counterweight_cures_it():
    imbalance = spun(ITEMS).hub.imbalance
    across = -RADIUS * imbalance.static / imbalance.size
    place = (across[0], across[1], CONTROL[2] + imbalance.height)
    cured = spun(ITEMS | {"counterweight": (imbalance.counterweight, place)}).hub.imbalance
    assert cured.size == pytest.approx(0.0, abs=1e-9)
    assert np.linalg.norm(cured.dynamic) == pytest.approx(imbalance.left, abs=1e-9)


def test_a_principal_axis_askew_is_a_dynamic_imbalance():
    tilted = np.array([[0.02, 0.0, -0.005], [0.0, 0.03, 0.0], [-0.005, 0.0, 0.04]])
    box = gb.RigidSpecimen(2.0, (0.0, 0.0, 0.0), tilted, corners=[(0.1, 0, 0)])
    arm = gb.plain_arm(radius=RADIUS, load="-x", up="+z", level=9 * G, ramp=5.0, dwell=10.0)
    imbalance = gb.simulate(box.structure, arm, duration=20.0, step=0.05).hub.imbalance
    assert imbalance.static == pytest.approx([2.0 * RADIUS, 0, 0])
    assert imbalance.dynamic == pytest.approx([0.005, 0, 0], abs=1e-9)  # ∫ x z dm is minus the product


def test_no_level_no_imbalance():
    box = gb.RigidSpecimen.box(2.0, (0.1, 0.1, 0.1), (0, 0, 0))
    hub = gb.Hub(radius=1.0, rate=3.0, gravity=(0, 0, -G))
    assert gb.simulate(box.structure, hub, duration=1.0, step=0.1).hub.imbalance is None


def platform(length=0.4, mass=20.0, damping=0.0):
    """A platform that hangs from a hinge across an arm: a mass at a length below it."""
    body = gb.RigidBody(mass, (0.0, 0.0, 0.0), centre=(0, 0, -length))
    swing = gb.Joint("revolute", "platform", axes=[(0, -1, 0)], damping=damping)
    return gb.System({"platform": body}, {"swing": swing})


@pytest.mark.parametrize(("length", "level"), [(0.4, 9.0), (0.4, 1.0), (0.002, 4.0)])
def test_a_swing_platform_hangs_along_the_load_and_swings_about_it(length, level):
    arm = gb.plain_arm(radius=RADIUS, load="-x", up="+z", level=level * G, ramp=20.0, dwell=20.0)
    square = level * G / RADIUS
    angle = brentq(lambda t: G * np.tan(t) - square * (RADIUS + length * np.sin(t)), 0.0, 1.57, xtol=1e-14)
    rest = gb.static(platform(length), arm, time=30.0)
    assert rest.coordinate("swing.angle") == pytest.approx(angle, abs=1e-9)
    assert np.arctan(level) == pytest.approx(angle, abs=length / RADIUS)  # of a short one atan(Ω² r/g)
    out = RADIUS + length * np.sin(angle)
    stiffness = G * np.cos(angle) / length + square * (out * np.sin(angle) / length - np.cos(angle) ** 2)
    assert gb.modes(platform(length), arm, time=30.0).frequency[0] == pytest.approx(np.sqrt(stiffness) / (2 * np.pi))


def test_a_swing_platform_follows_the_arm_up():
    arm = gb.plain_arm(radius=RADIUS, load="-x", up="+z", level=9 * G, ramp=20.0, dwell=20.0)
    response = gb.simulate(platform(damping=40.0), arm, duration=40.0)
    angle = gb.static(platform(), arm, time=30.0).coordinate("swing.angle")
    at = int(np.searchsorted(response.time, 40.0 - 1e-6))
    assert response.q[at, 0] == pytest.approx(angle, abs=1e-5)
    # The mass has swung out: the imbalance is that of the radius there.
    assert response.hub.imbalance.static[0] == pytest.approx(20.0 * (RADIUS + 0.4 * np.sin(angle)), rel=1e-5)
