"""Loads along the beams of a tree: those of one beam, of the joints that hold them, and in balance at every cut."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import gbeam as gb
from gbeam.report import as_json, report_of, viewer_data
from gbeam.results import json_of
from tests.system.trees import BEAM, flexible

SLOW: dict[str, Any] = {"duration": 0.2, "step": 1e-3, "integrator": "gauss", "estimate": False}


def test_one_body_on_a_turning_joint_carries_what_the_beam_on_a_hub_does() -> None:
    structure, rate = gb.assemble(BEAM, "exact", [0.2, 0.8], axial=1, y=1, z=2), gb.SmoothStep(1.0, 0.2)
    bodies = {"hub": gb.RigidBody(1.0, (4.0, 4.0, 5.0), points={"rim": (0.4, 0, 0)}), "beam": structure}
    turning = gb.Joint("revolute", "hub", axes=[(0, 0, 1)], rate=rate)
    system = gb.System(bodies, {"axis": turning, "clamp": gb.Joint("fixed", "beam", "hub.rim")})
    of_tree = gb.simulate(system, **SLOW).bodies["beam"]
    beam = gb.simulate(structure, gb.Hub(radius=0.4, rate=rate, inertia=5.0), **SLOW)
    assert beam.loads is not None and beam.peaks.loads is not None
    for name in ("force", "moment", "section_force", "section_moment", "stress", "von_mises", "acceleration"):
        alone = getattr(beam.loads, name)
        np.testing.assert_allclose(getattr(of_tree.loads, name), alone, atol=1e-10 * np.abs(alone).max())
    worst, of_beam = of_tree.peaks.loads.largest_stress, beam.peaks.loads.largest_stress
    assert worst is not None and of_beam is not None
    assert (worst.value, worst.time, worst.station) == pytest.approx((of_beam.value, of_beam.time, of_beam.station))


def _branched(kind: str) -> gb.System:
    """A beam held by the ground, turned, that carries a rigid body at its middle and another beam at its tip."""
    bodies = {"first": flexible(kind), "lump": gb.RigidBody(0.5, (0.01, 0.02, 0.02)), "last": flexible(kind)}
    joints = {
        "clamp": gb.Joint("fixed", "first", turn=(0.3, -0.5, 0.8)),
        "bolt": gb.Joint("fixed", "lump", "first.middle", at=(0, 0.1, 0)),
        "hinge": gb.Joint("revolute", "last", "first.tip", axes=[(0, 1, 0)], turn=(0, 0, 0.4), stiffness=3.0),
    }
    forces = {
        "push": gb.PointForce("last.tip", (0.2, 1.0, -0.5), (0.1, 0.0, 0.2)),
        "thrust": gb.PointForce("first.middle", (0.5, 0.0, 1.0), follower=True),
    }
    return gb.System(bodies, joints, forces, (1.0, 2.0, -9.0))


@pytest.mark.parametrize(("kind", "moments"), [("exact", 1e-10), ("CFOAM", 1e-10), ("FOAM", 1e-3)])
def test_sections_carry_what_joints_do(kind: str, moments: float) -> None:
    """At the root what the ground feels, at the tip what the next body's root does; moments of second order to third,
    while the tip has moved by a thousandth of the length.
    """
    response = gb.simulate(_branched(kind), initial="undeformed", **SLOW)
    some = slice(None) if moments < 1e-6 else slice(21)
    first, last = (response.bodies[name].loads for name in ("first", "last"))
    turned = gb.Joint("fixed", "first", turn=(0.3, -0.5, 0.8)).steps[0].R
    pairs = [
        (first.force[:, 0] @ turned.T, response.ground_force, 1e-10),
        (first.moment[:, 0] @ turned.T, response.ground_moment, moments),
        # Neither force nor inertia lies between the tip and the hinge.
        (*(np.linalg.norm(each, axis=-1) for each in (first.section_force[:, -1], last.force[:, 0])), 1e-10),
        (*(np.linalg.norm(each, axis=-1) for each in (first.section_moment[:, -1], last.moment[:, 0])), moments),
    ]
    for of_section, of_joint, tolerance in pairs:
        np.testing.assert_allclose(of_section[some], of_joint[some], atol=tolerance * np.abs(of_joint).max())


def test_a_tree_at_rest_balances_at_every_cut() -> None:
    """A stiff strip with a weight at its middle and another strip on its tip, by hand."""
    strip = gb.Beam(
        1.0,
        gb.Section.rectangle(0.05, 0.02),
        gb.Material(2700.0, 70e12, yield_strength=1e6),
        damping_ratio=0.0,
        points=[gb.Point("middle", 0.5)],
    )
    beam = gb.assemble(strip, "exact", [0.25], axial=0, y=0, z=3)
    joints = {
        "clamp": gb.Joint("fixed", "near"),
        "bolt": gb.Joint("fixed", "lump", "near.middle"),
        "weld": gb.Joint("fixed", "far", "near.tip"),
    }
    bodies = {"near": beam, "lump": gb.RigidBody(0.5, (0.01, 0.01, 0.01)), "far": beam}
    rest = gb.static(gb.System(bodies, joints, gravity=(0, 0, -10.0)))
    x = np.array([0.0, 0.25, 0.5, 1.0])
    weight = 2700 * 0.05 * 0.02 * 10
    shear = -weight * (2 - x) - 5.0 * (x <= 0.5)
    bending = weight * (2 - x) ** 2 / 2 + 5.0 * np.maximum(0.5 - x, 0)
    near = rest.bodies["near"].loads
    assert near.stations == pytest.approx(x)
    np.testing.assert_allclose(near.section_force[0, :, 2], shear, rtol=1e-6)
    np.testing.assert_allclose(near.section_moment[0, :, 1], bending, rtol=1e-6)
    stress = bending[0] * 0.01 / (0.05 * 0.02**3 / 12)
    assert near.stress[0, 0] == pytest.approx(stress, rel=1e-6)
    known = json.loads(as_json(json_of(rest)))["bodies"]["near"]["loads"]
    assert known["stress"][0] == pytest.approx(stress, rel=1e-6)
    assert known["margin"][0] == pytest.approx(1e6 / stress - 1, rel=1e-6)


def test_a_ball_takes_no_moment_of_rounding() -> None:
    """A pendulum on a ball: its root's moment was 5e-15 N m, which was written and drawn."""
    joints = {"ball": gb.Joint("spherical", "rod", turn=(0.0, 1.0, 0.0), initial_rate={"wz": 1.0})}
    response = gb.simulate(gb.System({"rod": flexible("exact")}, joints, gravity=(0, 0, -9.81)), **SLOW)
    loads = response.bodies["rod"].loads
    assert not loads.moment[:, 0].any() and not loads.section_moment[:, 0].any()
    assert np.abs(loads.force[:, 0]).max() > 0.1 and np.abs(loads.moment[:, 1]).max() > 1e-4


def test_what_yields_is_said_and_written() -> None:
    weak = gb.Beam(1.0, BEAM.section, gb.Material(2700.0, 70e9, yield_strength=1e3), damping_ratio=0.01)
    system = gb.System(
        {"strip": gb.assemble(weak, "FOAM", axial=0, y=0, z=2)},
        {"clamp": gb.Joint("fixed", "strip")},
        gravity=(0, 0, -9),
    )
    response = gb.simulate(system, duration=0.1)
    assert any("m of strip" in each and "above the yield strength" in each for each in response.warnings)
    saved = response.to_xarray()
    assert saved["strip_section_force"].dims == ("time", "strip_section", "axis")
    assert saved["strip_section"].values == pytest.approx([0.0, 1.0]) and saved["strip_stress"].units == "Pa"
    assert json_of(response)["bodies"]["strip"]["loads"]["margin"]["min"] < 0
    bare = gb.simulate(system, duration=0.1, loads=False, estimate=False)
    assert bare.bodies["strip"].loads is None and "strip_section" not in bare.to_xarray()


def test_the_scene_has_every_body_where_it_is() -> None:
    """A bus with a beam that carries a body: the carried one is shifted by the beam's deflection."""
    bus = gb.RigidBody(50.0, (8.0, 10.0, 12.0), points={"side": (0.5, 0, 0)})
    bodies = {"bus": bus, "boom": flexible("exact"), "lump": gb.RigidBody(0.5, (0.01, 0.02, 0.02))}
    joints = {
        "orbit": gb.Joint("free", "bus", initial_rate={"x": 0.2, "wz": 2.0, "wx": 0.5}),
        "hinge": gb.Joint("revolute", "boom", "bus.side", axes=[(0, 1, 0)], stiffness=20.0),
        "bolt": gb.Joint("fixed", "lump", "boom.tip"),
    }
    response = gb.simulate(gb.System(bodies, joints), duration=1.5, step=5e-3, estimate=False)
    header, numbers = viewer_data(response)
    (motion,) = header["scene"]["motions"]
    hub, boom, lump = motion["parts"]

    def array(ref: Any) -> Any:
        return numbers.array[ref["at"] :][: np.prod(ref["shape"])].reshape(ref["shape"])

    assert "joint" in boom and "joint" not in hub and motion["length"] == pytest.approx(1.0, rel=1e-12)
    # Of a body with these moments 6 (I_y + I_z - I_x)/m is the square of its length along x.
    assert sorted(hub["box"]["size"]) == pytest.approx(np.sqrt(6 / 50 * np.array([6.0, 10.0, 14.0])))
    assert hub["points"] == [pytest.approx([0.5, 0, 0], abs=1e-9)]
    for part, point in ((hub, "bus.root"), (boom, "boom.root"), (lump, "lump.root")):
        np.testing.assert_allclose(array(part["frame"])[:, :3], response.at(point), atol=1e-6)
    turn = Rotation.from_quat(np.roll(array(boom["frame"])[:, 3:7], -1, axis=1))
    bent = array(boom["beam"]["displacement"])[:, -1]
    np.testing.assert_allclose(array(boom["frame"])[:, 7:], 0, atol=1e-9)
    np.testing.assert_allclose(array(lump["frame"])[:, 7:], turn.apply(bent), atol=1e-6)
    np.testing.assert_allclose(
        turn.apply(bent + np.array([1.0, 0, 0])) + response.at("boom.root"), response.at("boom.tip"), atol=1e-6
    )
    assert np.abs(bent).max() > 1e-3
    # The same of the file, and of a study.
    assert '"joint"' in report_of(response) and '"scene"' in report_of(response)
