"""Steady states of systems that turn: frequencies against the rate, and where equilibria are lost."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import gbeam as gb
from gbeam.analysis import Drive, Path, Point, turning_at
from gbeam.analysis import RicherModels as Richer
from gbeam.figures import figure_of
from gbeam.results import json_of
from tests.analysis_verbs.beams import slender
from tests.crossing import crossed
from validation.published.tables import UNIFORM_FLAP

STRIP = gb.Beam(0.3, gb.Section.rectangle(width=0.02, thickness=0.004), gb.Material(2700.0, 70e9), damping_ratio=0.01)
BUS = gb.RigidBody(1.0, (1.0, 1.0, 1.0), points={"rim": (0.5, 0, 0), "back": gb.Place((-0.5, 0, 0), (0, 0, np.pi))})
SPIN = gb.Joint("revolute", "bus", axes=[(0, 0, 1)], rate=1.0)
FREE = gb.Joint("revolute", "bus", axes=[(0, 0, 1)])


def panels(structure: gb.Structure, spin: gb.Joint, *on: str) -> gb.System:
    clamps = {f"clamp_{each}": gb.Joint("fixed", f"panel_{each}", on=f"bus.{each}") for each in on}
    beams = {f"panel_{each}": structure for each in on}
    return gb.System({"bus": BUS, **beams}, {"spin": spin, **clamps})


@pytest.mark.parametrize(
    ("kind", "inertia"),
    crossed(lambda kind, inertia: (kind == "FOAM") == (inertia is not None), ("TLAM", "FOAM", "exact"), (None, 1.0)),
)
def test_a_panel_on_a_joint_is_a_beam_on_a_hub(kind: str, inertia: float | None) -> None:
    structure = gb.assemble(STRIP, kind, axial=1, y=2, z=2)
    hub, spin = gb.Hub(radius=0.5, inertia=inertia), SPIN if inertia is None else FREE
    options = {"end": 60.0, "count": 3, "modes": 4}
    alone = gb.campbell(structure, hub, **options)
    held = gb.campbell(panels(structure, spin, "rim"), turning="spin.angle", **options)
    assert held.frequency == pytest.approx(alone.frequency, rel=1e-12)
    assert held.damping_ratio == pytest.approx(alone.damping_ratio, abs=1e-12)
    assert [each.speed for each in held.crossings] == pytest.approx([each.speed for each in alone.crossings], rel=1e-9)
    assert held.direction == tuple(f"panel_rim {way}" for way in alone.direction)


def test_two_panels_move_as_one_or_against_each_other() -> None:
    """On a held bus every frequency is double; a free one keeps those of the panels that leave it at rest."""
    structure = gb.assemble(STRIP, "FOAM", axial=1, y=2, z=2)
    options = {"turning": "spin.angle", "end": 60.0, "count": 2, "modes": 8}
    one = gb.campbell(panels(structure, SPIN, "rim"), **options | {"modes": 4})
    held, free = (gb.campbell(panels(structure, each, "rim", "back"), **options) for each in (SPIN, FREE))
    assert held.frequency == pytest.approx(np.repeat(one.frequency, 2, axis=1), rel=1e-10)
    assert held.direction[:2] == ("panel_rim z", "panel_back z") or held.direction[:2] == (
        "panel_back z",
        "panel_rim z",
    )
    apart = np.abs(free.frequency[:, :, None] / one.frequency[:, None] - 1).min(axis=1)
    assert apart.max() < 1e-10 and (np.abs(free.frequency[0, :, None] / one.frequency[0] - 1).min(axis=1) > 1e-3).any()


def test_wrights_frequencies_through_a_tree() -> None:
    """A clamped uniform blade on a hub without radius, in units of √(EI/ρA)/L²."""
    blade = assemble_blade()
    chosen = sorted(UNIFORM_FLAP)
    diagram = gb.campbell(blade, speeds=[float(each) for each in chosen], modes=3)
    at = np.searchsorted(diagram.speed, chosen)
    assert 2 * np.pi * diagram.frequency[at] == pytest.approx(np.array([UNIFORM_FLAP[k][1] for k in chosen]), rel=5e-5)


def assemble_blade() -> gb.System:
    structure = gb.assemble(replace(slender(1e4), damping_ratio=0.0), "FOAM", axial=0, y=0, z=10)
    joints = {
        "spin": gb.Joint("revolute", "hub", axes=[(0, 0, 1)], rate=1.0),
        "grip": gb.Joint("fixed", "blade", "hub.root"),
    }
    return gb.System({"hub": gb.RigidBody(0.0), "blade": structure}, joints)


def disc(rate: object, inertia: tuple[float, float, float] = (0.3, 0.3, 0.5)) -> gb.System:
    """A disc that spins about the end of a mast that tilts in both directions."""
    mast = gb.RigidBody(0.0, (0.0, 0.0, 0.0), points={"top": (0, 0, 0.4)})
    tilt = gb.Joint("universal", "mast", axes=[(1, 0, 0), (0, 1, 0)], stiffness={"angle_1": 50.0, "angle_2": 50.0})
    spin = gb.Joint("revolute", "rotor", on="mast.top", axes=[(0, 0, 1)], rate=rate)
    return gb.System({"mast": mast, "rotor": gb.RigidBody(2.0, inertia)}, {"tilt": tilt, "spin": spin})


def test_a_disc_on_a_mast_whirls_forward_and_backward() -> None:
    """I λ² ∓ i I_p Ω λ + k = 0, with I about the mast's foot."""
    about, polar, k = 0.3 + 2.0 * 0.4**2, 0.5, 50.0
    diagram = gb.campbell(disc(30.0), count=3, modes=2)
    turn = polar * diagram.speed / (2 * about)
    whirl = np.sqrt(turn**2 + k / about)[:, None] + turn[:, None] * [-1, 1]
    assert 2 * np.pi * np.sort(diagram.frequency, axis=1) == pytest.approx(whirl, rel=1e-9)
    kept = gb.critical_speed(disc(30.0), upper=100.0)
    assert kept.value is None and json_of(kept)["critical_speed"] is None


@pytest.mark.parametrize("turning", [None, "spin.angle"])
def test_what_changes_as_it_turns_is_refused(turning: str | None) -> None:
    """A rotor that is not round on a mast that tilts, and gravity across the axis; along it there is an answer."""
    with pytest.raises(gb.InputError, match="change with the angle") as caught:
        gb.campbell(disc(30.0, (0.2, 0.4, 0.5)), turning=turning)
    assert caught.value.where == "joints.spin"
    structure = gb.assemble(STRIP, "FOAM", axial=1, y=1, z=1)
    system = panels(structure, SPIN, "rim")
    across, along = (gb.System(system.bodies, system.joints, gravity=g) for g in ((0, -9.81, 0), (0, 0, -9.81)))
    with pytest.raises(gb.InputError, match="change with the angle"):
        gb.critical_speed(across, turning=turning, upper=20.0)
    assert gb.campbell(along, turning=turning, end=5.0, count=1, modes=1).frequency.shape == (2, 1)
    doubt = gb.modes(across)
    assert any("equations with it" in each for each in doubt.warnings) and not gb.modes(along).warnings


def test_it_is_refused_where_what_turns_cannot_rest_either() -> None:
    """A rod on a hinge across gravity, on a cart that nothing holds, which the turning rod would shake."""
    rod = gb.RigidBody(1.0, (0.0, 0.02, 0.02), centre=(0.3, 0, 0))
    joints = {
        "rail": gb.Joint("prismatic", "cart", axes=[(1, 0, 0)]),
        "pin": gb.Joint("revolute", "rod", on="cart.root", axes=[(0, 1, 0)], initial=0.1, stiffness=5.0),
    }
    system = gb.System({"cart": gb.RigidBody(2.0), "rod": rod}, joints, gravity=(0, 0, -9.81))
    for ask in (gb.campbell, gb.critical_speed):
        with pytest.raises(gb.InputError, match="change with the angle"):
            ask(system, turning="pin.angle", **({"end": 5.0} if ask is gb.campbell else {}))
    # What hangs on the rod is shaken more than the cart, but it is the cart that nothing holds.
    flap = gb.Joint("revolute", "flap", on="rod.root", axes=[(0, 1, 0)], stiffness=50.0)
    bodies = {**system.bodies, "flap": gb.RigidBody(0.1, (0.0, 1e-4, 1e-4), centre=(0.05, 0, 0))}
    spun = gb.System(bodies, {**joints, "pin": replace(joints["pin"], rate=5.0), "flap": flap})
    with pytest.raises(gb.ComputationError, match=r"rail\.displacement is accelerated by what turns") as caught:
        gb.static(spun)
    assert caught.value.outcome == "no equilibrium"


def test_a_blade_that_flaps_is_asked_for() -> None:
    """A rod on a hinge 0.2 m off the axis, whose frequency is √(1 + 3 e / 2 L) of the rate and nothing at rest."""
    rod = gb.RigidBody(1.0, (1e-9, 1 / 12, 1 / 12), centre=(0.5, 0, 0))
    hinge = gb.Joint("revolute", "flap", on="hub.rim", axes=[(0, 1, 0)])
    bodies = {"hub": gb.RigidBody(1.0, (1.0, 1.0, 1.0), points={"rim": (0.2, 0, 0)}), "flap": rod, "held": rod}
    joints = {
        "shaft": gb.Joint("revolute", "hub", axes=[(0, 0, 1)], rate=gb.constant(10.0)),
        "hinge": hinge,
        "spring": replace(hinge, body="held", stiffness=10.0),
    }
    from_rest, later = (gb.campbell(gb.System(bodies, joints), start=each, count=2) for each in (0.0, 5.0))
    assert from_rest.frequency.shape[1] == 1 and later.frequency.shape[1] == 2 and not later.warnings
    assert from_rest.warnings == (
        "a motion begins to oscillate as it turns faster, and is not followed from 0 rad/s: begin later",
    )
    assert 2 * np.pi * later.frequency[-1].min() == pytest.approx(10 * np.sqrt(1.3), rel=1e-6)


def test_what_falls_is_said_to_be_accelerated() -> None:
    """A free body with a stiff strip: gravity was less than the strip's rounding, and the strip stood upright."""
    bodies = {"hull": gb.RigidBody(1.2, (0.01, 0.01, 0.02)), "arm": gb.assemble(STRIP, "FOAM", axial=1, y=1, z=1)}
    joints = {"air": gb.Joint("free", "hull"), "weld": gb.Joint("fixed", "arm", on="hull.root")}
    falls = gb.System(bodies, joints, gravity=(0, 0, -9.81))
    for ask in (gb.static, gb.modes):
        assert [str(each) for each in ask(falls).accelerated] == ["air.z by -9.81 m/s²"]
    assert gb.static(gb.System(bodies, joints)).point_displacement.max() == 0
    # Its run is one of positive masses, which those of Euler parameters are not.
    fallen = gb.simulate(falls, duration=0.1)
    assert fallen.outcome == "done" and not any("positive mass" in each for each in fallen.warnings)
    assert fallen.at("hull.root")[-1, 2] == pytest.approx(-0.04905, rel=1e-6)


def test_what_may_turn_is_asked_for_where_it_is_not_the_only_angle() -> None:
    structure = gb.assemble(STRIP, "FOAM", axial=1, y=1, z=1)
    one = panels(structure, FREE, "rim")
    two = gb.System(one.bodies, {**one.joints, "clamp_rim": replace(FREE, body="panel_rim", on="bus.rim")})
    assert gb.critical_speed(one, upper=5.0).value == gb.critical_speed(one, turning="spin.angle", upper=5.0).value
    for system, turning, problem in ((two, None, "is missing"), (one, "clamp_rim.x", "no angle")):
        with pytest.raises(gb.InputError, match=problem) as caught:
            gb.campbell(system, turning=turning, end=5.0)
        assert caught.value.where == "turning" and "spin.angle" in caught.value.fix
    for turning, problem in ((None, "needs a hub"), ("clamp.angle", "turning is given of one beam")):
        with pytest.raises(gb.InputError, match=problem):
            gb.campbell(gb.System({"a": structure}, {"clamp": gb.Joint("fixed", "a")}), turning=turning, end=5.0)
    with pytest.raises(gb.InputError, match="no rate is prescribed"):
        gb.campbell(panels(structure, FREE, "rim"), turning="spin.angle")


COLUMN = gb.Beam(1.0, gb.Section.general(1e-2, 1e-8, 1e-8), gb.Material(1e2, 1e8), damping_ratio=0.0)


@pytest.mark.parametrize(("kind", "follower", "value"), [("exact", False, np.pi**2 / 4), ("exact", True, 20.0509536)])
def test_columns_of_euler_and_beck_in_a_system(kind: str, follower: bool, value: float) -> None:
    structure = gb.assemble(COLUMN, kind, axial=1, z=7)
    push = gb.PointForce("column.tip", force=(-1.0, 0, 0), follower=follower)
    system = gb.System({"column": structure}, {"foot": gb.Joint("fixed", "column")}, {"push": push})
    lost = gb.critical_load(system)
    assert lost.value == pytest.approx(value, rel=3e-5)
    assert lost.errors.slender == pytest.approx(abs(lost.value / value - 1), rel=0.1, abs=3e-5)
    assert lost.kind == ("flutter" if follower else "divergence") and lost.direction == "column z"
    with pytest.raises(gb.InputError, match="no load that acts"):
        gb.critical_load(gb.System(system.bodies, system.joints))
    hung = {"foot": gb.Joint("spherical", "column")}  # rounding of what swings is no load
    with pytest.raises(gb.InputError, match="no load that acts"):
        gb.critical_load(gb.System(system.bodies, hung, gravity=(9.81, 0, 0)))


def test_a_beam_that_points_inward_is_lost_as_on_a_hub() -> None:
    structure = gb.assemble(STRIP, "TLAM", axial=1, y=2, z=2)
    alone = gb.critical_speed(structure, gb.Hub(radius=0.5))
    lost = gb.critical_speed(panels(structure, SPIN, "rim"))
    assert lost.value == pytest.approx(alone.value, rel=1e-9) and np.isinf(lost.errors.model)
    assert lost.errors.shapes == pytest.approx(alone.errors.shapes, abs=1e-8)
    assert any("critical rate is the system's own" in each for each in lost.warnings)


def test_rates_belong_to_their_coordinates_whatever_the_order() -> None:
    """The joints are named from the tip inward, and the bodies from the ground outward."""
    joints = {
        "elbow": gb.Joint("revolute", "fore", on="upper.end", axes=[(0, 1, 0)], rate=0.5),
        "base": gb.Joint("revolute", "upper", axes=[(0, 0, 1)], rate=2.0),
        "wrist": gb.Joint("revolute", "hand", on="fore.end", axes=[(0, 1, 0)]),
    }
    rod = gb.RigidBody(1.0, (0.0, 1 / 12, 1 / 12), centre=(0.5, 0, 0), points={"end": (1, 0, 0)})
    response = gb.simulate(gb.System({"hand": rod, "upper": rod, "fore": rod}, joints), duration=0.5)
    assert response.coordinate("base.angle")[-1] == pytest.approx(1.0, rel=1e-12)
    assert response.coordinate("elbow.angle")[-1] == pytest.approx(0.25, rel=1e-12)


def test_friction_that_holds_is_warned_of_where_the_rotor_turns() -> None:
    """Small departures of a hinge in a rotor are without its friction; that of the joint that turns is overcome."""
    rotor = gb.RigidBody(1.0, (0.1, 0.1, 0.1), points={"rim": (0.2, 0, 0)})
    flap = gb.RigidBody(0.2, (1e-3, 0.01, 0.01), centre=(0.2, 0, 0))

    def spinning(friction: float) -> gb.System:
        joints = {
            "spin": gb.Joint("revolute", "rotor", axes=[(0, 0, 1)], friction=0.3),
            "hinge": gb.Joint("revolute", "flap", "rotor.rim", axes=[(0, 1, 0)], stiffness=5.0, friction=friction),
        }
        return gb.System({"rotor": rotor, "flap": flap}, joints)

    frequencies = []
    for friction in (0.0, 0.5):
        diagram = gb.campbell(spinning(friction), turning="spin.angle", end=20.0, count=2, modes=1)
        for answer in (diagram, gb.critical_speed(spinning(friction), turning="spin.angle", upper=20.0)):
            said = [each for each in answer.warnings if "friction" in each]
            assert [each.split(", ")[0] for each in said] == ["friction of hinge.angle"] * (friction > 0)
        frequencies.append(diagram.frequency)
    np.testing.assert_array_equal(*frequencies)


def test_newtons_method_goes_in_shares_where_it_fails_at_once() -> None:
    """A panel with a mass, with the shapes that shear and twist ask for, at 800 rad/s: none was found, which was taken
    for a loss of the equilibrium. A beam on a hub is pulled there by shares of the load.
    """
    material, mass = gb.Material(2700.0, 70e9, poissons_ratio=0.33), gb.PointMass(0.3, 0.5)
    heavy = gb.Beam(0.3, STRIP.section, material, [mass], damping_ratio=0.01)
    system, path = (
        panels(gb.assemble(heavy, "exact", y=2, z=2), SPIN, "rim"),
        Path(Drive(None, 0.0, "spin.angle"), turning_at),
    )
    _, thick, *_ = Richer(path(system, 0.0)).systems_by_theory(system)[0]
    steady, beam = path(thick, 800.0), thick.bodies["panel_rim"]
    alone = gb.solve_equilibrium(beam, gb.Hub(radius=0.5, rate=800.0).base(0.0))
    stretched = steady.frames[-2].p - (0.8, 0, 0)
    assert stretched == pytest.approx(beam.tip(alone.q), rel=1e-9, abs=1e-15) and stretched[0] > 1e-4
    assert steady.margin > 0


@pytest.mark.parametrize("joint", ["fixed", "spherical"])
@pytest.mark.parametrize("held", [True, False])
def test_steady_states_found_at_once_are_those_found_alone(
    held: bool, joint: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With their small departures, those of a ball as well, whose Euler parameters are more than its freedoms."""
    structure = gb.assemble(STRIP, "exact", axial=1, y=2, z=2)
    turn = (0.0, 0.7, 0.3) if joint == "fixed" else (0.0, 0.1, 0.05)
    clamp = gb.Joint(joint, "panel", on="bus.rim", turn=turn)
    system = gb.System({"bus": BUS, "panel": structure}, {"spin": SPIN if held else FREE, "clamp": clamp})
    drive, rates = Drive(coordinate="spin.angle"), np.linspace(10.0, 60.0, 6).tolist()
    path = Path(drive, turning_at, held)
    path(system, rates[0])
    for some in (rates[1:2], rates[2:4], rates[4:]):
        path.prepare(system, some)
    monkeypatch.setattr("gbeam.analysis.system.path.steady_state", None)  # none is looked for alone
    states = [path(system, rate) for rate in rates]
    monkeypatch.undo()
    for rate, state in zip(rates, states, strict=True):
        alone = Path(drive, turning_at, held)(system, rate)
        np.testing.assert_allclose(state.point.y, alone.point.y, atol=1e-11)
        for part, other in zip(state.linear, alone.linear, strict=True):
            np.testing.assert_allclose(part, other, atol=1e-9 * np.abs(other).max(initial=0.0))
    assert np.abs(states[-1].point.y).max() > 0.005


def test_a_steady_state_that_is_far_is_found_alone() -> None:
    """Newton's method for several at once takes none but what is near where lower ones lead."""
    structure = gb.assemble(STRIP, "exact", axial=1, y=2, z=2)
    swept = gb.Joint("fixed", "panel", on="bus.rim", turn=(0.0, 0.7, 0.3))
    system = gb.System({"bus": BUS, "panel": structure}, {"spin": SPIN, "clamp": swept})
    path = Path(Drive(coordinate="spin.angle"), turning_at)
    path(system, 1.0)
    path.prepare(system, [2.0, 500.0])
    assert path.equilibria._states(system).keys() == {1.0, 2.0}


@pytest.mark.parametrize("held", [True, False])
def test_a_steady_state_begins_where_lower_ones_lead(held: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """States are those found from rest, in fewer corrections."""
    structure = gb.assemble(STRIP, "exact", axial=1, y=2, z=2)
    swept = gb.Joint("fixed", "panel", on="bus.rim", turn=(0.0, 0.7, 0.3))
    system = gb.System({"bus": BUS, "panel": structure}, {"spin": SPIN if held else FREE, "clamp": swept})
    slopes, count = Point.slopes, 0

    def counted(point: Point) -> object:
        nonlocal count
        count += 1
        return slopes(point)

    monkeypatch.setattr(Point, "slopes", counted)
    drive, rates, answers = Drive(coordinate="spin.angle"), np.linspace(10.0, 120.0, 12), []
    for paths in ([Path(drive, turning_at, held)] * 12, [Path(drive, turning_at, held) for _ in rates]):
        count = 0
        states = [path(system, float(rate)) for path, rate in zip(paths, rates, strict=True)]
        answers.append((count, np.array([each.point.y for each in states])))
    (fewer, led), (more, alone) = answers
    assert np.abs(led).max() > 0.02 and fewer < 0.85 * more
    np.testing.assert_allclose(led, alone, atol=1e-11)


def test_shares_of_energy_are_those_of_both_parts_of_a_mode() -> None:
    """Two slides across each other on a turning bus: in a mode one moves a quarter of a period after the other."""
    rate, outer, inner, along, across = 30.0, 2.0, 0.5, 8000.0, 2000.0
    point, still = (1e-9, 1e-9, 1e-9), {"p": (0, 0, 0)}
    bodies = {
        "bus": gb.RigidBody(1.0, (1.0, 1.0, 1.0), points=still),
        "a": gb.RigidBody(outer, point, points=still),
        "b": gb.RigidBody(inner, point),
    }
    slides = {
        "sx": gb.Joint("prismatic", "a", on="bus.p", axes=[(1, 0, 0)], stiffness={"displacement": along}),
        "sy": gb.Joint("prismatic", "b", on="a.p", axes=[(0, 1, 0)], stiffness={"displacement": across}),
    }
    spin = gb.Joint("revolute", "bus", axes=[(0, 0, 1)], rate=rate)
    modes = gb.modes(gb.System(bodies, {"spin": spin, **slides}), errors=False)
    mass = np.diag([outer + inner, inner])
    stiffness = np.diag([along, across]) - rate**2 * mass
    coriolis = 2 * inner * rate * np.array([[0.0, -1.0], [1.0, 0.0]])
    lower = -np.linalg.solve(mass, np.hstack([stiffness, coriolis]))
    value, vector = np.linalg.eig(np.vstack([np.eye(4)[2:], lower]))
    rising = np.argsort(value.imag)[2:]
    x, y = np.abs(vector[2:, rising]) ** 2
    energy = np.stack([0 * x, outer * x, inner * (x + y)])
    assert modes.frequency == pytest.approx(value.imag[rising] / (2 * np.pi), rel=1e-9)
    np.testing.assert_allclose(modes.share, (energy / energy.sum(axis=0)).T, atol=1e-8)


def test_the_effort_that_holds_a_weight_is_against_its_moment() -> None:
    """A weight at 0.4 m along x turns about +y as it falls: the hinge, held by a rate of zero, pushes back."""
    arm = gb.RigidBody(1.0, (0.1, 0.2, 0.3), centre=(0.4, 0, 0))
    held = gb.System(
        {"arm": arm}, {"axis": gb.Joint("revolute", "arm", axes=[(0, 1, 0)], rate=0.0)}, gravity=(0, 0, -10)
    )
    rest = gb.static(held)
    assert rest.effort == pytest.approx([-4.0]) and rest.ground_moment == pytest.approx([0.0, 4.0, 0.0])


@pytest.mark.parametrize("driven", [False, True])
def test_an_arm_that_stands_on_a_shaft_falls_at_the_rate_in_closed_form(driven: bool) -> None:
    """k = (I_xx − I_zz) Ω² about y; the shaft is turned against a damper, or at a prescribed rate."""
    hub = gb.RigidBody(10.0, (1.0, 1.0, 2.0), points={"p": (0.0, 0.0, 0.0)})
    arm = gb.RigidBody(3.0, (0.05, 0.04, 0.01), centre=(0.0, 0.0, 0.4))
    turned: dict[str, Any] = {"rate": 1.0} if driven else {"damping": 2.0, "effort": 5.0}
    stiff = {"angle_1": 45.0, "angle_2": 30.0}
    joints = {
        "shaft": gb.Joint("revolute", "hub", axes=[(0, 0, 1)], **turned),
        "hinge": gb.Joint("universal", "arm", "hub.p", axes=[(1, 0, 0), (0, 1, 0)], stiffness=stiff),
    }
    lost = gb.critical_speed(gb.System({"hub": hub, "arm": arm}, joints), turning="shaft.angle", upper=60.0)
    assert lost.kind == "divergence" and lost.direction == "arm ry"
    xx, yy, zz = 0.05 + 3.0 * 0.4**2, 0.04 + 3.0 * 0.4**2, 0.01
    assert lost.value == pytest.approx(np.sqrt(30.0 / (xx - zz)), rel=1e-8)
    # (K_x − I_xx ω²) (K_y − I_yy ω²) = ((I_xx + I_yy − I_zz) Ω ω)², as the arm vibrates in the frame of the shaft.
    for rate, frequency in zip(lost.followed, lost.frequency, strict=True):
        k, gyroscopic = (45.0 - (yy - zz) * rate**2, 30.0 - (xx - zz) * rate**2), (xx + yy - zz) * rate
        squares = np.roots([xx * yy, -(k[0] * yy + k[1] * xx + gyroscopic**2), k[0] * k[1]])
        np.testing.assert_allclose(2 * np.pi * frequency[:2], np.sort(np.sqrt(squares)), rtol=1e-4, atol=1e-3)
    assert lost.frame == json_of(lost)["frame"] == "turning"
    assert figure_of(lost).panels[0].y == "frequency in the turning frame, Hz"
