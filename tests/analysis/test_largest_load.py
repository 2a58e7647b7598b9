"""The largest load anywhere on a specimen, against sums written out and against many points; spin-up is part of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gbeam import (
    Beam,
    Comparison,
    InputError,
    Joint,
    PointMass,
    Response,
    RigidBody,
    System,
    assemble,
    compare,
    constant,
    simulate,
)
from gbeam import Flight as InFlight
from gbeam.analysis import ends_of, largest_load
from gbeam.results import Base

from .helpers import ALUMINIUM, LENGTH, SECTION, of_tip

G = 9.80665
TIME = np.linspace(-2.0, 4.0, 601)
ZERO = np.zeros((len(TIME), 3))
ALONG_X, ALONG_Z = np.eye(3)[[0, 2]]
RADIUS = 1.0  # m, of the arm: to the control point


def on_an_arm(rate: np.ndarray, at: float, **changes: np.ndarray) -> Response:
    """A specimen along the radius of an arm that turns about z at `rate` (t,), its control point at `at` m."""
    load = -(rate**2 * (RADIUS - at))[:, None] * ALONG_X
    base = Base(load, rate[:, None] * ALONG_Z, np.gradient(rate, TIME)[:, None] * ALONG_Z)
    return replace(of_tip("arm", TIME, 0 * load + 1e-3), base=base, **changes)


def in_flight(load: np.ndarray) -> Response:
    during = TIME >= 0
    return replace(
        of_tip("flight", TIME[during], 0 * load[during] + 1e-3), base=Base(load[during], *2 * [ZERO[during]])
    )


@pytest.fixture
def compared() -> Comparison:
    """10 g at 3 s in flight; an arm that makes it at a tenth of the specimen, and more in its spin-up."""
    level = np.interp(TIME, [-2, -1.5, -1, 0, 2, 3, 4], [0, 9, 3, 3, 3, 10, 3]) * G
    return compare(in_flight(-level[:, None] * ALONG_X), on_an_arm(np.sqrt(level / RADIUS), 0.1 * LENGTH))


def test_the_tip_further_out_on_the_arm_carries_more(compared: Comparison) -> None:
    pair = compared.peaks["largest_load"]
    assert (pair.flight, pair.time_flight, pair.place_flight) == (pytest.approx(10 * G), 3.0, "")
    rate, angular = (
        np.sqrt(10 * G / RADIUS),
        np.gradient(np.sqrt(np.interp(TIME, [2, 3, 4], [3, 10, 3]) * G), TIME)[500],
    )
    out = RADIUS + 0.9 * LENGTH
    assert pair.machine == pytest.approx(np.hypot(rate**2 * out, angular * LENGTH), rel=1e-6)
    assert (pair.time_machine, pair.place_machine) == (3.0, "the tip")
    assert pair.ratio == pytest.approx(out / RADIUS, rel=1e-3)
    assert compared.findings[0] == (
        "Largest load: 12.7 g at the tip at 3.00 s, 27 % above the flight's 10 g (no limit set)."
    )


def test_the_spin_up_counts_and_the_limit_is_over_all_times() -> None:
    """14 g on the way to a flight of 10 g: every peak of the flight is right, and the specimen had 14 g."""
    level = np.interp(TIME, [-2, -1.5, -1, 0, 2, 3, 4], [0, 14, 3, 3, 3, 10, 3]) * G
    pair = in_flight(-level[:, None] * ALONG_X), on_an_arm(np.sqrt(level / RADIUS), 0.0)
    compared = compare(*pair, accept={"largest_load": 0.5, "peaks": 0.01})
    load = compared.peaks["largest_load"]
    assert load.time_machine == pytest.approx(-1.5) and load.machine > 14 * G
    (limit, peaks) = compared.criteria
    assert (limit.name, limit.passed, peaks.passed) == ("largest_load", False, True) and compared.accepted is False
    assert limit.value == pytest.approx(load.ratio - 1) and limit.where == "at the tip at -1.50 s"
    assert str(limit).endswith("% at the tip at -1.50 s (limit 50 %)")
    assert compare(*pair, accept={"largest_load": 1.0}).accepted is True


def test_too_small_is_not_accepted_either() -> None:
    level = np.interp(TIME, [-2, 0, 3, 4], [0, 3, 10, 3]) * G
    pair = in_flight(-2 * level[:, None] * ALONG_X), on_an_arm(np.sqrt(level / RADIUS), LENGTH)
    (limit,) = compare(*pair, accept={"largest_load": 0.4}).criteria
    assert limit.value == pytest.approx(-0.5, abs=0.02) and not limit.passed


def test_no_point_of_the_specimen_carries_more() -> None:
    """Bases in any motion, a beam and bodies off its axis: against many points, and twice the rigid body's formula."""
    random = np.random.default_rng(7)
    for _ in range(20):
        base = Base(*(random.normal(size=(50, 3)) * size for size in (10.0, 5.0, 20.0)))
        bodies = random.normal(size=(2, 3)) * 0.2 + [0.15, 0, 0]
        named = {"the root": np.zeros(3), "the tip": LENGTH * ALONG_X}
        named |= {f"the body at {1e3 * body[0]:.4g} mm": body for body in bodies}
        value, when, place = largest_load(np.arange(50.0), base, named)
        along = np.linspace(0, LENGTH, 31)[:, None] * ALONG_X
        everywhere = np.concatenate([along, *(np.linspace(point, body, 9) for point in along for body in bodies)])
        w, al = base.w_WB_B[:, None], base.alpha_WB_B[:, None]
        loads = base.a_WO_B[:, None] + np.cross(al, everywhere) + np.cross(w, np.cross(w, everywhere))
        sizes = np.linalg.norm(loads, axis=-1)
        assert value == pytest.approx(sizes.max()) and when == np.unravel_index(sizes.argmax(), sizes.shape)[0]
        far = everywhere[sizes.max(axis=0).argmax()]
        np.testing.assert_allclose(named[place], far, atol=1e-12)


def test_points_are_counted_from_the_root_wherever_the_base_is_known() -> None:
    """The same machine by the motion of its root, and by that of its control point at 0.2 m."""
    rate = 3.0 + np.sin(TIME)
    arm = on_an_arm(rate, 0.2).base
    at_c = replace(arm, a_WO_B=-(rate**2 * RADIUS)[:, None] * ALONG_X + 0.2 * arm.alpha_WB_B[:, [0, 2, 1]])
    points = {"the root": np.zeros(3), "the tip": LENGTH * ALONG_X}
    assert largest_load(TIME, at_c, points, 0.2) == pytest.approx(largest_load(TIME, arm, points))


def test_a_response_knows_its_bodies_off_the_axis() -> None:
    body = PointMass(0.2, 0.01, offset=(0.0, 0.1, 0.0))
    beam = Beam(LENGTH, SECTION, ALUMINIUM, [body], damping_ratio=0.01)
    response = simulate(assemble(beam, "FOAM", z=1), InFlight(z=constant(G)), duration=0.02, step=1e-3)
    assert list(response.ends) == ["the root", "the tip", "the body at 200 mm"]
    np.testing.assert_array_equal(response.ends["the body at 200 mm"], [0.2, 0.1, 0.0])
    spun = replace(response, base=replace(response.base, w_WB_B=0 * response.base.w_WB_B + 10 * ALONG_X))
    pair = compare(response, spun).peaks["largest_load"]
    assert (pair.place_machine, pair.machine) == ("the body at 200 mm", pytest.approx(np.hypot(G, 100 * 0.1)))


def test_a_limit_by_another_name_is_refused() -> None:
    level = np.full(len(TIME), G)
    with pytest.raises(InputError, match="largest_load"):
        compare(in_flight(-level[:, None] * ALONG_X), on_an_arm(np.sqrt(level), 0.0), accept={"largest": 0.1})


def test_ends_of_bodies_are_where_their_joints_hold_them() -> None:
    """A leg stands on the tip of another, and a box with a point hangs beside them."""
    leg = assemble(Beam(LENGTH, SECTION, ALUMINIUM, damping_ratio=0.01), "FOAM", z=1)
    box = RigidBody(1.0, (1.0, 1.0, 1.0), centre=(0.0, 0.0, 0.1), points={"lid": (0.0, 0.0, 0.2)})
    joints = {
        "clamp": Joint("fixed", "foot"),
        "corner": Joint("fixed", "leg", "foot.tip", turn=(0.0, -np.pi / 2, 0.0)),
        "screws": Joint("fixed", "box", at=(0.0, 0.5, 0.0)),
    }
    ends = ends_of(System({"foot": leg, "leg": leg, "box": box}, joints))
    places = {
        "the tip of foot": (LENGTH, 0, 0),
        "the tip of leg": (LENGTH, 0, LENGTH),
        "the point lid of box": (0, 0.5, 0.2),
        "the centre of mass of box": (0, 0.5, 0.1),
    }
    for name, place in places.items():
        np.testing.assert_allclose(ends[name], place, atol=1e-12)
    assert ends.keys() - places == {"the root of foot", "the root of leg", "the root of box"}
