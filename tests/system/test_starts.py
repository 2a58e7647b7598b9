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


def bent(system: gb.System, response: gb.Response) -> np.ndarray:
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
    largest = response.bodies["panel"].peaks.loads
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
        largest = np.abs(one.body.q).max(axis=0)
        assert (np.abs(tree.body.q - one.body.q).max(axis=0) < 1e-6 * largest).all()
        assert one.initial == tree.initial
        assert (one.body.q[0] != 0).tolist() == {"equilibrium": [False, True], "relief": [True, True]}.get(
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
    assert words in [line.strip() for line in after]
    relief = gbeam("run", file, "--set", "response.initial.state=relief", "--json").json["motions"]["ground"]
    assert relief["initial"] == "begins in inertia relief, joints at their initial values"
    assert relief["initial"] in relief["lines"]
    refused = gbeam("run", file, "--set", "response.initial.state=releif")
    assert refused.status == 2 and "did you mean 'relief'" in refused.err
    drawn_aside = gbeam("run", file, "--set", 'response.initial.displacement={"panel.tip" = {y = "2 mm"}}', "--json")
    words = "begins with panel.tip displaced by y 2 mm, as by a force there, at rest, joints at their initial values"
    assert drawn_aside.json["motions"]["ground"]["initial"] == words
    missing = gbeam("run", file, "--set", 'response.initial.displacement={"panel.end" = {y = "2 mm"}}')
    assert missing.status == 2 and "response.initial.displacement.panel.end: is of panel.end" in missing.err


def drawn(**more: Any) -> gb.Response:
    """Run of a hub on a hinge with two panels, of which one begins displaced and moving."""
    hub = gb.RigidBody(1.0, (INERTIA,) * 3, points={"far": (-0.2, 0.0, 0.0)})
    joints = {
        "axis": gb.Joint("revolute", "hub", axes=[(0, 0, 1)]),
        "clamp": gb.Joint("fixed", "panel", on="hub.root"),
        "other": gb.Joint("fixed", "still", on="hub.far", turn=(0, 0, np.pi)),
    }
    beam = panel(axial=1, y=2, z=2)
    system = gb.System({"hub": hub, "panel": beam, "still": beam}, joints, gravity=(0.0, 0.0, -9.81))
    return gb.simulate(system, duration=0.02, step=5e-4, estimate=False, **more)


def test_a_point_of_a_system_is_drawn_aside_and_let_go() -> None:
    initial = gb.Initial(displacement={"panel.tip": {"z": 4e-3}}, velocity={"panel.tip": {"y": 0.2}})
    response = drawn(initial=initial)
    words = "begins with panel.tip displaced by z 4 mm, as by a force there, panel.tip moving at y 0.2 m/s"
    assert response.initial == f"{words}, joints at their initial values"
    beam = panel(axial=1, y=2, z=2)
    alone = gb.simulate(beam, gb.Flight(z=0.0), duration=0.02, step=5e-4, estimate=False, initial=gb.Initial(
        tip_displacement={"z": 4e-3}, tip_velocity={"y": 0.2}
    ))  # fmt: skip
    settled = drawn()
    names = response.coordinates
    of_panel, of_still = (
        [k for k, name in enumerate(names) if name.startswith(f"{body}.")] for body in ("panel", "still")
    )
    # The panel as alone; the other one in equilibrium under gravity, at rest.
    np.testing.assert_allclose(response.q[0, of_panel], alone.q[0], rtol=1e-12, atol=1e-18)
    np.testing.assert_allclose(response.qd[0, of_panel], alone.qd[0], rtol=1e-12, atol=1e-18)
    np.testing.assert_allclose(response.q[0, of_still], settled.q[0, of_still], rtol=1e-9, atol=1e-15)
    assert np.abs(settled.q[0, of_still]).max() > 1e-3 and not response.qd[0, of_still].any()
    assert not response.q[0, names.index("axis.angle")]


def test_a_system_is_released_from_a_static_deflection() -> None:
    response = drawn(initial=gb.Initial(acceleration=(0.0, 3.0, 20.0)))
    static = gb.static(panel(axial=1, y=2, z=2), acceleration=(0.0, 3.0, 20.0)).tip
    at = [response.points.index(f"{body}.tip") for body in ("panel", "still")]
    rooted = [response.points.index(f"{body}.root") for body in ("panel", "still")]
    moved = response.place[0, at] - response.place[0, rooted] - [[LENGTH, 0, 0], [-LENGTH, 0, 0]]
    # The other panel points the other way.
    np.testing.assert_allclose(moved[:, 1:], [static[1:], static[1:]], rtol=1e-6)
    assert response.initial.startswith("begins in the static deflection under (0, 3, 20) m/s², at rest, joints")


def test_what_is_displaced_states_the_error_that_one_body_states() -> None:
    how: dict[str, Any] = {"duration": 0.5, "step": 1e-3, "integrator": "newmark"}
    beam = gb.assemble(gb.Beam(LENGTH, gb.Section.rectangle(WIDTH, THICKNESS), gb.Material(DENSITY, MODULUS),
        damping_ratio=0.01), "FOAM", axial=1, y=1, z=1)  # fmt: skip
    one = gb.simulate(beam, gb.Flight(z=0.0), initial=gb.Initial(tip_displacement={"z": 5e-3}), **how)
    of_system = gb.simulate(
        gb.System.of(beam, "strip"), initial=gb.Initial(displacement={"strip.tip": {"z": 5e-3}}), **how
    )
    assert one.errors.displacement.shapes > 1e-3
    for part in ("shapes", "model", "beam_theory"):
        ours, theirs = (getattr(errors.displacement, part) for errors in (of_system.errors, one.errors))
        assert ours == pytest.approx(theirs, rel=0.01, abs=1e-9), part


def test_a_traced_start_is_that_of_numbers() -> None:
    import jax

    from gbeam.analysis import starting_point, starting_state

    initial = gb.Initial(displacement={"panel.tip": {"z": 4e-3, "y": 1e-3}}, velocity={"panel.tip": {"z": 0.1}})

    def system(thickness: Any) -> gb.System:
        section = gb.Section.rectangle(WIDTH, thickness)
        beam = gb.Beam(LENGTH, section, gb.Material(DENSITY, MODULUS), damping_ratio=0.0)
        return craft(gb.Joint("revolute", "hub", axes=[(0, 0, 1)]), gb.assemble(beam, "FOAM", axial=0, y=2, z=2), 1.0)

    def begun(thickness: Any) -> Any:
        return starting_state(system(thickness), None, 0.0, initial)

    point, traced = starting_point(system(THICKNESS), None, 0.0, initial), jax.jit(begun)(THICKNESS)
    for ours, theirs in zip(traced, (point.y, point.yd), strict=True):
        np.testing.assert_allclose(ours, theirs, rtol=1e-9, atol=1e-14)


REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "no point": (
        {"displacement": {"panel.end": {"z": 1e-3}}},
        r"displacement\.panel\.end is of panel\.end, which is no",
    ),
    "two bodies": (
        {"tip_displacement": {"z": 1e-3}},
        r"tip_displacement is of tip, and 2 bodies deform; name one of pan",
    ),
    "no shapes": (
        {"velocity": {"still.tip": {"x": 1.0}}},
        r"velocity\.still\.tip\.x is along a direction without shapes",
    ),
    "a body that is rigid": ({"displacement": {"hub.far": {"x": 1e-3}}}, "no point of a body that deforms"),
    "no axis": ({"displacement": {"panel.tip": {"w": 1e-3}}}, "choose one of x, y, z"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_a_start_of_no_point_is_refused(name: str) -> None:
    of, message = REFUSED[name]
    beam = panel(axial=0, y=1, z=1)
    hub = gb.RigidBody(1.0, (INERTIA,) * 3, points={"far": (-0.2, 0.0, 0.0)})
    joints = {"axis": gb.Joint("revolute", "hub", axes=[(0, 0, 1)])}
    joints |= {name: gb.Joint("fixed", name, on="hub.far") for name in ("panel", "still")}
    with pytest.raises(gb.InputError, match=message):
        gb.simulate(gb.System({"hub": hub, "panel": beam, "still": beam}, joints), initial=gb.Initial(**of), **SHORT)
