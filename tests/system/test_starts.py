"""States in which systems begin: what floats undeformed, what is held in equilibrium, or all in inertia relief."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gbeam as gb

from ..calling import Answer, gbeam

__all__ = ["gbeam"]

LENGTH, WIDTH, THICKNESS, DENSITY, MODULUS = 1.0, 0.02, 0.004, 2700.0, 70e9
LINE, BENDING = DENSITY * WIDTH * THICKNESS, MODULUS * THICKNESS * WIDTH**3 / 12  # kg/m, and about z, N m²
INERTIA, TORQUE = 0.5, 0.4  # of the hub, kg m², and on it, N m
EIGENVALUE = 1.875104069  # of the first shape of a cantilever, whose tip is 2 where its mean square is 1
SHORT: dict[str, Any] = {"duration": 0.1, "step": 5e-4, "estimate": False}


def panel(**counts: int) -> gb.Structure:
    section = gb.Section.rectangle(WIDTH, THICKNESS)
    beam = gb.Beam(LENGTH, section, gb.Material(DENSITY, MODULUS), damping_ratio=0.0)
    return gb.assemble(beam, "FOAM", **{"axial": 0, "y": 1, "z": 0, **counts})


def craft(joint: gb.Joint, beam: gb.Structure, mass: float = 1e9, **more: Any) -> gb.System:
    """A rigid hub, so heavy that its centre stays, with a panel."""
    hub = gb.RigidBody(mass, (INERTIA,) * 3)
    joints = {"axis": joint, "clamp": gb.Joint("fixed", "panel", on="hub.root")}
    return gb.System({"hub": hub, "panel": beam}, joints, **more)


PUSH = {"push": gb.PointForce("hub.root", moment=(0.0, 0.0, TORQUE))}
CRAFTS: dict[str, tuple[gb.System, str]] = {
    "on a hinge": (
        craft(gb.Joint("revolute", "hub", axes=[(0, 0, 1)], effort=TORQUE), panel()),
        "begins in relative equilibrium, joints at their initial values",
    ),
    "free": (
        craft(gb.Joint("free", "hub"), panel(), forces=PUSH),
        "begins undeformed (it floats), joints at their initial values",
    ),
}


def bent(system: gb.System, response: gb.SystemResponse) -> np.ndarray:
    """Deflection of the panel's tip along y, m."""
    first = response.coordinates.index("panel.q1")
    return np.asarray(system.flexible["panel"].displacement(response.q[:, first:])[:, -1, 1])


@pytest.mark.parametrize("name", CRAFTS)
def test_a_torque_from_the_start_shakes_what_is_free_to_turn(name: str) -> None:
    """Of hub and one shape, J θ̈ + b q̈ = T and b θ̈ + m q̈ + k q = 0: q = −b T/(J k) (1 − cos ωt), ω² = k/(m − b²/J)."""
    system, words = CRAFTS[name]
    mass, moment = LINE * LENGTH, 2 * LINE * LENGTH**2 / EIGENVALUE**2
    stiffness, inertia = BENDING * EIGENVALUE**4 / LENGTH**3, INERTIA + LINE * LENGTH**3 / 3
    rate = np.sqrt(stiffness / (mass - moment**2 / inertia))
    still = -2 * moment * TORQUE / inertia / stiffness
    response = gb.simulate(system, **SHORT)
    assert response.initial == words
    wave = np.cos(rate * response.time)
    np.testing.assert_allclose(bent(system, response), still * (1 - wave), atol=1e-3 * abs(still))
    swept = LINE * LENGTH**3 / 3 / inertia
    carried = swept * TORQUE + (moment - swept * moment) * still / 2 * rate**2 * wave
    largest = response.beams["panel"].peaks
    assert largest is not None
    assert largest.root_moment.size.value == pytest.approx(np.abs(carried).max(), rel=1e-4)
    relieved = gb.simulate(system, initial="relief", **SHORT)
    assert relieved.initial == "begins in inertia relief, joints at their initial values"
    np.testing.assert_allclose(bent(system, relieved), still, rtol=3e-4)


def test_on_a_hinge_it_begins_as_on_a_free_hub() -> None:
    """Sagging along the hinge, and straight across it; relieved, bent by the angular acceleration as well."""
    beam, along = panel(z=1), (0.0, 0.0, -9.81)
    hinge = gb.Joint("revolute", "hub", axes=[(0, 0, 1)], effort=TORQUE)
    hub = gb.Hub(radius=0.0, inertia=INERTIA, torque=TORQUE, gravity=along)
    for state in ("equilibrium", "undeformed", "relief"):
        one = gb.simulate(beam, hub, initial=state, **SHORT)
        tree = gb.simulate(craft(hinge, beam, gravity=along), initial=state, **SHORT)
        first = tree.coordinates.index("panel.q1")
        largest = np.abs(one.q).max(axis=0)
        assert (np.abs(tree.q[:, first:] - one.q).max(axis=0) < 1e-6 * largest).all()
        assert one.initial == f"begins {tree.initial.removeprefix('begins ').partition(',')[0]}, at rest"
        assert (one.q[0] != 0).tolist() == {"equilibrium": [False, True], "relief": [True, True]}.get(
            state, [False] * 2
        )


def test_what_floats_does_not_bend_what_is_held() -> None:
    """An arm on a wall under its weight stays, whatever falls from its tip, and where that is straight."""
    arm, down = panel(y=0, z=2), (0.0, 0.0, -9.81)
    bodies: dict[str, Any] = {"arm": arm, "panel": panel(z=1)}
    joints = {"wall": gb.Joint("fixed", "arm"), "let_go": gb.Joint("free", "panel", on="arm.tip")}
    response = gb.simulate(gb.System(bodies, joints, gravity=down), **SHORT)
    assert response.initial == (
        "begins with arm in relative equilibrium, panel undeformed (it floats), joints at their initial values"
    )
    alone = gb.static(gb.System({"arm": arm}, {"wall": joints["wall"]}, gravity=down))
    sag = alone.at("arm.tip")[2]
    assert sag < -1e-2 and np.abs(response.at("arm.tip")[:, 2] - sag).max() < 1e-9
    names = [k for k, name in enumerate(response.coordinates) if name.startswith("panel.q")]
    assert np.abs(response.q[:, names]).max() < 1e-9


def test_springs_of_a_clamp_are_bent_with_the_body_unless_they_are_drawn() -> None:
    """As a root spring of one beam: M/k by the weight; drawn to an angle, the beam swings from there."""
    down = (0.0, 0.0, -9.81)

    def clamped(**more: Any) -> gb.System:
        clamp = gb.Joint("fixed", "panel", stiffness={"ry": 50.0}, **more)
        return gb.System({"panel": panel(y=0, z=2)}, {"clamp": clamp}, gravity=down)

    held = gb.simulate(clamped(), **SHORT)
    sagged = LINE * 9.81 * LENGTH**2 / 2 / 50.0
    assert held.coordinate("clamp.ry") == pytest.approx(sagged, rel=2e-3)
    assert np.ptp(held.coordinate("clamp.ry")) < 1e-9
    drawn = gb.simulate(clamped(initial={"ry": 0.05}), **SHORT)
    assert drawn.coordinate("clamp.ry")[0] == 0.05 and np.ptp(drawn.coordinate("clamp.ry")) > 0.01


def test_springs_or_prescribed_rates_hold_a_free_joint() -> None:
    beam = panel()
    for more, floating in (
        ({}, ("hub", "panel")),
        ({"stiffness": {"x": 10.0}}, ()),
        ({"rate": dict.fromkeys(("x", "y", "z", "wx", "wy", "wz"), 0.0)}, ()),
        ({"rate": {"x": 1.0}}, ("hub", "panel")),
        ({"damping": {"x": 1.0}}, ("hub", "panel")),
    ):
        assert craft(gb.Joint("free", "hub", **more), beam).floating == floating


SCENARIO = """
[bodies.hub]
kind = "rigid"
mass = "2 kg"
inertia = ["0.5 kg m^2", "0.5 kg m^2", "0.5 kg m^2"]

[bodies.panel]
kind = "beam"
length = "1 m"
damping_ratio = 0.01
section = { shape = "rectangle", width = "20 mm", thickness = "4 mm" }
material = { density = "2700 kg/m^3", youngs_modulus = "70 GPa" }
model = { kind = "FOAM", modes = { axial = 0, y = 1, z = 0 } }

[joints.air]
kind = "free"
body = "hub"

[joints.clamp]
kind = "fixed"
body = "panel"
on = "hub.root"

[forces.push]
on = "hub.root"
moment = { z = "0.4 N m" }

[response]
duration = "0.2 s"
step = "1 ms"
estimate = false
"""


def test_commands_say_how_it_begins(gbeam: Callable[..., Answer], tmp_path: Path) -> None:
    file = tmp_path / "s.toml"
    file.write_text(SCENARIO, encoding="utf-8")
    words = "begins undeformed (it floats), joints at their initial values"
    answer = gbeam("run", file, "--out", tmp_path)
    after = answer.out[answer.out.index("ground: done") :].splitlines()
    assert after[1].strip() == words
    relief = gbeam("run", file, "--set", "response.initial.state=relief", "--json").json["motions"]["ground"]
    assert relief["initial"] == relief["lines"][0] == "begins in inertia relief, joints at their initial values"
    refused = gbeam("run", file, "--set", "response.initial.state=releif")
    assert refused.status == 2 and "did you mean 'relief'" in refused.err
