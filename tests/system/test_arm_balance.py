"""Several items on a plain arm: the imbalance by hand, the counterweight that cures it, and a swing platform."""

import numpy as np
import pytest

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
