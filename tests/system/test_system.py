"""Systems as users give them: what is refused and where, closed forms, and that values stay what they are."""

from __future__ import annotations

import copy
import pickle
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.special import ellipj, ellipk

import gbeam as gb
from gbeam.report import text
from tests.system.trees import flexible

ROD = gb.RigidBody(1.0, (0.0, 1 / 12, 1 / 12), centre=(0.5, 0, 0), points={"end": (1, 0, 0)})
HINGE = gb.Joint("revolute", "rod", axes=[(0, 1, 0)])
HINGED = gb.Joint("revolute", "hub", axes=[(0, 0, 1)], stiffness=5.0, damping=0.1)
TWO = {"rod": ROD, "bar": ROD}


@pytest.mark.parametrize(
    ("bodies", "joints", "where", "problem"),
    [
        ({"rod": ROD}, {}, "bodies.rod", "hangs on nothing"),
        ({"rod": ROD}, {"a": HINGE, "b": HINGE}, "joints.b.body", "which a holds already"),
        ({"rod": ROD}, {"a": gb.Joint("fixed", "bar")}, "joints.a.body", "no such body"),
        ({"rod": ROD}, {"a": gb.Joint("fixed", "rod", "rod.end")}, "joints.a.on", "loop"),
        (
            {"rod": ROD, "bar": ROD},
            {"a": gb.Joint("fixed", "rod", "bar.end"), "b": gb.Joint("fixed", "bar", "rod.end")},
            "joints.a.on",
            "loop of a, b",
        ),
        (
            {"rod": ROD, "bar": ROD},
            {"a": HINGE, "b": gb.Joint("fixed", "bar", "rod.tip")},
            "joints.b.on",
            "no such point",
        ),
        (
            {"rod": ROD, "bar": ROD},
            {"a": HINGE, "b": gb.Joint("fixed", "bar", "beam.tip")},
            "joints.b.on",
            "no body 'beam'",
        ),
        ({"rod": ROD, "bar": ROD}, {"a": HINGE, "b": gb.Joint("fixed", "bar", "rod")}, "joints.b.on", "no such point"),
    ],
)
def test_trees_that_are_none_are_refused(bodies: Any, joints: Any, where: str, problem: str) -> None:
    with pytest.raises(gb.InputError) as caught:
        gb.System(bodies, joints)
    assert caught.value.where == where and problem in caught.value.problem and caught.value.fix


@pytest.mark.parametrize(
    ("on", "fix"),
    [
        ("rod.ends", "did you mean 'rod.end'?"),
        ("rood.end", "did you mean 'rod.end'?"),
        ("sky", "choose one of rod.end, rod.root"),
    ],
)
def test_a_point_that_is_not_there_names_those_that_are(on: str, fix: str) -> None:
    with pytest.raises(gb.InputError) as caught:
        gb.System({"rod": ROD}, {"a": HINGE}, {"push": gb.PointForce(on)})
    assert (caught.value.where, caught.value.fix) == ("forces.push.on", fix)


@pytest.mark.parametrize(
    ("more", "where"),
    [
        ({"kind": "hinge"}, "kind"),
        ({"axes": None}, "axes"),
        ({"axes": [(0, 0, 0)]}, "axes"),
        ({"initial": {"angel": 0.1}}, "initial.angel"),
        ({"stiffness": -1.0}, "stiffness.angle"),
        ({"stops": (0.2, 0.1)}, "stops.angle"),
        ({"stops": (0.1, 0.2)}, "stop_stiffness"),
        ({"stop_stiffness": 3.0}, "stop_stiffness.angle"),
        ({"ease": 0.1}, "ease.angle"),
        ({"rate": 1.0, "effort": 2.0}, "effort.angle"),
        ({"kind": "fixed", "axes": None, "stiffness": 20.0}, "stiffness"),
        ({"kind": "free", "axes": None, "initial": 0.1}, "initial"),
        ({"kind": "free", "axes": None, "initial": {"e1": 0.1}}, "initial.e1"),
    ],
)
def test_joints_that_are_none_are_refused(more: dict[str, Any], where: str) -> None:
    with pytest.raises(gb.InputError) as caught:
        gb.Joint(**({"kind": "revolute", "body": "rod", "axes": [(0, 1, 0)]} | more))
    assert caught.value.where == where


def test_bodies_that_are_none_are_refused() -> None:
    with pytest.raises(gb.InputError, match="principal moments"):
        gb.RigidBody(1.0, (1.0, 1.0, 3.0))
    bar = gb.Structure.of_particles(
        np.ones(1), np.array([[1.0, 0, 0]]), np.ones((1, 3, 1)), np.eye(1), second=np.zeros((1, 3, 1, 1))
    )
    joints = {"a": gb.Joint("fixed", "bar"), "b": gb.Joint("fixed", "rod", "bar.tip")}
    with pytest.raises(gb.InputError, match="do not say how it turns"):
        gb.System({"bar": bar, "rod": ROD}, joints)
    with pytest.raises(gb.InputError, match="without inertia"):
        gb.modes(gb.System({"rod": ROD}, {"a": gb.Joint("free", "rod")}))
    ball = gb.RigidBody(1.0, (1.0, 1.0, 1.0))
    still = gb.System({"rod": ball}, {"a": gb.Joint("free", "rod")}, gravity=(0, 0, -9.81))
    assert [str(each) for each in gb.static(still).accelerated] == ["a.z by -9.81 m/s²"]


def test_pendulum_by_elliptic_functions() -> None:
    """A rod let go at 60 degrees: sin(θ/2) = k sn(K − ω₀ t), to the error that is stated."""
    start, rate = np.pi / 3, np.sqrt(1.5 * 9.81)
    held = gb.Joint("revolute", "rod", axes=[(0, 1, 0)], initial=np.pi / 2 - start)
    response = gb.simulate(gb.System({"rod": ROD}, {"hinge": held}, gravity=(0, 0, -9.81)), duration=3.0)
    k = np.sin(start / 2)
    angle = 2 * np.arcsin(k * ellipj(ellipk(k**2) - rate * response.time, k**2)[0])
    error = np.abs(np.pi / 2 - response.coordinate("hinge.angle") - angle).max()
    assert error < max(3 * response.error_estimate, 1e-9)
    assert response.invariants is not None and response.invariants.energy_change < 1e-6
    # The hinge carries weight and centripetal force, at the lowest place 1 + 3 (1 − cos 60°)/2 times the weight.
    assert np.abs(response.ground_force[:, 2]).max() / 9.81 == pytest.approx(1 + 1.5 * (1 - np.cos(start)), rel=1e-4)


def test_two_rods_vibrate_as_in_the_closed_form() -> None:
    joints = {"top": gb.Joint("revolute", "a", axes=[(0, 1, 0)], initial=1.0)}
    joints["elbow"] = gb.Joint("revolute", "b", "a.end", axes=[(0, 1, 0)])
    modes = gb.modes(gb.System({"a": ROD, "b": ROD}, joints, gravity=(0, 0, -9.81)))
    square = (3 + np.array([-6, 6]) / np.sqrt(7)) * 9.81
    np.testing.assert_allclose(modes.frequency, np.sqrt(square) / 2 / np.pi, rtol=1e-10)


def test_torque_free_body_by_elliptic_functions() -> None:
    """Euler's equations: ω₁ = a cn(pt), ω₂ = b sn(pt), ω₃ = c dn(pt), through the instability about the middle axis."""
    moments = np.array([3.0, 2.0, 1.0])
    first, third = 1.0, 1.3
    energy = moments[0] * first**2 + moments[2] * third**2
    square = (moments[0] * first) ** 2 + (moments[2] * third) ** 2
    # Of the order in which 2 T I₂ > L² or below it: Landau and Lifshitz, section 37.
    middle = np.sqrt((square - energy * moments[2]) / (moments[1] * (moments[1] - moments[2])))
    upper = np.sqrt((energy * moments[0] - square) / (moments[1] * (moments[0] - moments[1])))
    larger, smaller = max(middle, upper), min(middle, upper)
    joint = gb.Joint("free", "top", initial_rate={"wx": first, "wz": third, "x": 0.5})
    response = gb.simulate(gb.System({"top": gb.RigidBody(2.0, moments)}, {"free": joint}), duration=10.0)
    spin = response.angular_velocity[:, 0]
    k = smaller / larger
    rate = larger * np.sqrt((moments[0] - moments[1]) * (moments[1] - moments[2]) / (moments[0] * moments[2]))
    sn, cn, dn, _ = ellipj(rate * response.time, k**2)
    along = (cn, dn) if smaller == middle else (dn, cn)
    exact = np.stack([first * along[0], smaller * sn, third * along[1]], axis=1)
    sign = np.sign(spin[5, 1] * exact[5, 1])
    np.testing.assert_allclose(spin, exact * [1, sign, 1], atol=3 * max(response.error_estimate, 1e-8) * third)
    invariants = response.invariants
    assert invariants is not None and max(invariants.momentum_change, invariants.angular_momentum_change) < 1e-4


def test_friction_and_stops() -> None:
    """A block on a slide comes to rest by friction after v²/2μg, and one on a stop turns back at its speed."""
    block, along = gb.RigidBody(2.0), {"axes": [(1, 0, 0)], "initial_rate": 1.0}
    rubbed = gb.System({"block": block}, {"slide": gb.Joint("prismatic", "block", friction=4.0, **along)})
    way = gb.simulate(rubbed, duration=1.0).coordinate("slide.displacement")
    assert way[-1] == pytest.approx(1.0 / (2 * 4.0 / 2.0), rel=2e-3)
    stopped = gb.Joint("prismatic", "block", stops=(-1.0, 0.2), stop_stiffness=2e4, **along)
    back = gb.simulate(gb.System({"block": block}, {"slide": stopped}), duration=0.5)
    assert back.qd[-1, 0] == pytest.approx(-1.0, rel=1e-3)
    assert back.q[:, 0].max() == pytest.approx(0.2 + np.sqrt(2.0 / 2e4), rel=1e-3)


def test_prescribed_rates_say_what_their_drives_need() -> None:
    """The torque of a drive that turns a beam is the moment of the same beam's inertia about the axis."""
    structure, rate = flexible("exact"), gb.SmoothStep(1.0, 0.5)
    hub = gb.RigidBody(1.0, (4.0, 4.0, 5.0), points={"rim": (0.4, 0, 0)})
    joints = {"axis": gb.Joint("revolute", "hub", axes=[(0, 0, 1)], rate=rate)}
    joints["clamp"] = gb.Joint("fixed", "beam", "hub.rim")
    system = gb.System({"hub": hub, "beam": structure}, joints)
    options: dict[str, Any] = {"duration": 0.5, "step": 1e-3, "integrator": "gauss", "residual_from": 0.2}
    response = gb.simulate(system, **options)
    beam = gb.simulate(structure, gb.Hub(radius=0.4, rate=rate, inertia=5.0), **options)
    assert beam.hub is not None and beam.loads is not None and beam.loads.drive_torque is not None
    place = response.at("beam.tip")
    axis = response.coordinate("axis.angle")
    inward = np.stack(
        [
            np.cos(axis) * place[:, 0] + np.sin(axis) * place[:, 1],
            np.cos(axis) * place[:, 1] - np.sin(axis) * place[:, 0],
        ]
    )
    np.testing.assert_allclose(inward[1], beam.tip[:, 1], atol=1e-6 * np.abs(beam.tip).max())
    drive = response.effort[:, response.coordinates.index("axis.angle")]
    np.testing.assert_allclose(drive, beam.loads.drive_torque, atol=2e-3 * np.abs(drive).max())
    # And what is left of the vibration is the beam's, relative to its root; of a rigid body it is of its place.
    left = dict(zip(response.points, np.asarray(response.residual_amplitude), strict=True))
    np.testing.assert_allclose(left["beam.tip"], beam.peaks.residual_amplitude, rtol=1e-6)
    late = response.at("hub.rim")[response.time >= 0.2]
    np.testing.assert_allclose(left["hub.rim"], np.ptp(late, axis=0) / 2, rtol=1e-6)
    assert "residual from 0.2 s, m" in text(response)


def test_systems_stay_what_they_are() -> None:
    system = gb.System({"rod": ROD, "beam": flexible("FOAM")}, {"a": HINGE, "b": gb.Joint("fixed", "beam", "rod.end")})
    before = pickle.dumps(system)
    assert pickle.loads(before) == system == copy.deepcopy(system) == gb.System(system.bodies, system.joints)
    gb.modes(system)
    gb.linearize(system, outputs=["a.angle"])
    assert pickle.dumps(system) == before
    assert system != gb.System(system.bodies, system.joints, gravity=(0, 0, -1))


def test_linear_model_follows_the_response() -> None:
    """A small push on a hinged rod with a spring, by the matrices and by the equations."""
    hinge = gb.Joint("revolute", "rod", axes=[(0, 1, 0)], stiffness=20.0, damping=0.1, effort=gb.Sine(1e-4, 0.5))
    system = gb.System({"rod": ROD}, {"hinge": hinge})
    names = ["hinge.angle", "hinge.angle_rate", "rod.end.acceleration_z"]
    plant = gb.linearize(system, outputs=names)
    assert [each.unit for each in plant.outputs] == ["rad", "rad/s", "m/s^2"] and plant.inputs[0].name == "hinge.angle"
    response = gb.simulate(system, duration=0.5, tolerance=1e-5)
    driven = plant.to_control()
    import control

    _, y = control.forced_response(driven, response.time, gb.Sine(1e-4, 0.5)(response.time))
    size = np.abs(y).max(axis=1)
    np.testing.assert_allclose(y[0], response.coordinate("hinge.angle"), atol=2e-5 * size[0])
    np.testing.assert_allclose(y[2], response.acceleration[:, 0, 2], atol=2e-3 * size[2])


def test_a_linear_model_is_driven_by_its_base_and_by_prescribed_joints() -> None:
    """As the beam alone is on its base; a joint's acceleration is one of the base and one of its angle."""
    structure, flight = flexible("FOAM"), gb.Flight(x=1.0, z=3.0)
    clamped = gb.System({"beam": structure}, {"clamp": gb.Joint("fixed", "beam")})
    alone = gb.linearize(structure, flight)
    carried = gb.linearize(clamped, flight, outputs=[f"beam.tip.{each}" for each in ("place_y", "place_z", "spin_y")])
    assert [each.name for each in carried.inputs] == [each.name for each in alone.inputs]

    def gains(plant: gb.StateSpace, outputs: list[str]) -> np.ndarray:
        rows = [[each.name for each in plant.outputs].index(name) for name in outputs]
        return (plant.c @ np.linalg.solve(7.3j * np.eye(len(plant.a)) - plant.a, plant.b) + plant.d)[rows]

    ours = gains(carried, ["beam.tip.place_y", "beam.tip.place_z"])
    np.testing.assert_allclose(ours, gains(alone, ["tip_y", "tip_z"]), rtol=1e-10, atol=1e-12)
    felt = gb.linearize(clamped, flight, inputs=["base_acceleration_z"], outputs=["beam.root.acceleration_z"])
    assert gains(felt, ["beam.root.acceleration_z"]) == pytest.approx(1.0)
    hub = gb.RigidBody(1.0, (4.0, 4.0, 5.0), points={"rim": (0.4, 0, 0)})
    joints = {"axis": gb.Joint("revolute", "hub", axes=[(0, 0, 1)], rate=0.0)}
    joints["clamp"] = gb.Joint("fixed", "beam", "hub.rim")
    turned = gb.linearize(gb.System({"hub": hub, "beam": structure}, joints), outputs=["beam.tip.place_y"])
    assert [(each.name, each.unit) for each in turned.inputs] == [("axis.angle_acceleration", "rad/s^2")]
    still = gains(gb.linearize(structure, gb.Flight(z=0.0)), ["tip_y"])[0]
    assert gains(turned, ["beam.tip.place_y"])[0, 0] == pytest.approx(0.4 * still[1] + still[5], rel=1e-10)
    with pytest.raises(gb.InputError, match="inputs reach and outputs see 0 of the states"):
        gb.balanced_truncation(gb.linearize(gb.System({"hub": hub, "beam": structure}, {**joints, "axis": HINGED})), 2)


def test_a_free_body_has_six_motions_of_no_frequency() -> None:
    free = gb.modes(gb.System({"rod": gb.RigidBody(1.0, (1.0, 1.0, 1.0))}, {"hold": gb.Joint("free", "rod")}))
    assert free.frequency.shape == (0,) and free.rigid == 6 and free.stable


def test_a_body_that_turns_in_its_place_is_said_to_turn() -> None:
    """No point moves: words and figure are of the hinge; what is a hundredth of the largest motion has no panel."""
    wheel = gb.RigidBody(1.0, (1.0, 1.0, 1.0), points={"rim": (1.0, 0.0, 0.0)})
    hub = replace(wheel, points={})
    hinge = gb.Joint("revolute", "wheel", axes=[(0, 0, 1)], effort=1.0, stiffness=5.0)
    assert repr(gb.static(gb.System({"wheel": hub}, {"hinge": hinge}))).startswith(
        "Rest at 0 s: no point moves; hinge.angle reaches 0.2 rad"
    )
    turned = gb.simulate(gb.System({"wheel": hub}, {"hinge": hinge}), duration=0.5, step=0.01)
    assert f"no point moves; hinge.angle reaches {turned.q[-1, 0]:.4g} rad" in repr(turned)
    assert "energy 0 J at the start, 0." in repr(turned)
    assert [panel.get_ylabel() for panel in turned.plot()] == ["hinge.angle, rad", "drive, N m"]
    moved = gb.simulate(gb.System({"wheel": wheel}, {"hinge": hinge}), duration=0.02, step=0.01)
    (panel,) = moved.plot()
    assert panel.get_ylabel() == "y, mm"
    assert f"(not drawn: x by {1e6 * (1 - np.cos(moved.q[-1, 0])):.2g} µm at most)" in panel.figure.texts[0].get_text()
