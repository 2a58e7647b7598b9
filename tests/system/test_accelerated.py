"""Steady states of what nothing holds: bodies that fall, or that a thrust accelerates evenly, and modes about them."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.polynomial import legendre
from numpy.typing import NDArray

import gbeam as gb
from gbeam.analysis import Drive, steady_state
from gbeam.results import json_of
from tests.crossing import crossed

LENGTH, WIDTH, THICKNESS, DENSITY, MODULUS = 2.0, 0.02, 0.004, 2700.0, 70e9
EA, EI = MODULUS * WIDTH * THICKNESS, MODULUS * WIDTH * THICKNESS**3 / 12
LINEAR = DENSITY * WIDTH * THICKNESS  # kg/m
UNIT = np.sqrt(EI / LINEAR) / LENGTH**2  # rad/s
FLUTTER = 109.69  # T L²/EI at which the lowest two frequencies meet, by `frequencies`
FREE = gb.Joint("free", "rod")


def rod(kind: str, z: int, *points: gb.Point) -> gb.Structure:
    section = gb.Section.rectangle(width=WIDTH, thickness=THICKNESS)
    beam = gb.Beam(LENGTH, section, gb.Material(DENSITY, MODULUS), damping_ratio=0.0, points=points)
    return gb.assemble(beam, kind, axial=2, y=0, z=z)


def rocket(kind: str, load: float) -> gb.System:
    """A uniform rod that a thrust T at its end pushes along itself, with load = T L²/EI."""
    thrust = gb.PointForce("rod.root", force=(load * EI / LENGTH**2, 0, 0), follower=True)
    return gb.System({"rod": rod(kind, 8)}, {"air": FREE}, forces={"thrust": thrust})


def frequencies(load: float, count: int = 14) -> NDArray[np.complex128]:
    """ω L² √(μ/EI) of a free-free rod under a follower thrust, by Galerkin's method with Legendre polynomials.

    ∫ μ ẅ v + EI w'' v'' − T (1 − x/L) w' v' dx = T w'(0) v(0), all over L.
    """
    at, weight = legendre.leggauss(40)
    share = (1 - at) / 2
    eye = np.eye(count)
    value, slope, bend = (
        2**k * np.array([legendre.legval(at, legendre.legder(each, k) if k else each) for each in eye])
        for k in range(3)
    )
    end = np.array([legendre.legval(-1.0, each) for each in eye])
    turn = 2 * np.array([legendre.legval(-1.0, legendre.legder(each)) for each in eye])
    mass, stiffness, thrust = (each * weight / 2 @ each.T for each in (value, bend, slope * np.sqrt(share)))
    square = np.linalg.eigvals(np.linalg.solve(mass, stiffness - load * (thrust + np.outer(end, turn))))
    square = square[np.abs(square) > 1e-2]
    return np.asarray(np.sqrt(square[np.argsort(square.real)].astype(complex)))


@pytest.mark.parametrize("kind", ["FOAM", "exact"])
def test_a_rod_under_thrust_is_pressed_as_it_is_accelerated(kind: str) -> None:
    """It carries T (1 − x/L) and is shorter by T L/2EA."""
    thrust = 2.5 * EI / LENGTH**2
    rest = gb.static(rocket(kind, 2.5))
    (faster,) = rest.accelerated
    assert faster.coordinate == "air.x" and faster.acceleration == pytest.approx(thrust / LINEAR / LENGTH, rel=1e-9)
    shorter = rest.at("rod.root")[0] - rest.at("rod.tip")[0] + LENGTH
    assert shorter == pytest.approx(thrust * LENGTH / 2 / EA, rel=1e-2)
    loads = rest.bodies["rod"].loads
    assert loads.section_force[0, :, 0] == pytest.approx(thrust * (loads.stations / LENGTH - 1), abs=1e-2 * thrust)
    assert not rest.ground_force.any() and not rest.ground_moment.any() and rest.stable
    assert rest.errors.loads_by_beam == pytest.approx([0.0])  # of a free root, which carries rounding
    assert json_of(rest)["accelerated"] == [{"coordinate": "air.x", "acceleration": faster.acceleration}]
    assert f"accelerated evenly: {faster}" in str(rest)


@pytest.mark.parametrize(
    ("kind", "load"),
    crossed(lambda kind, load: kind == "exact" or load == 100.0, ("FOAM", "exact"), (0.0, 2.5, 50.0, 100.0)),
)
def test_frequencies_of_a_rod_under_thrust(kind: str, load: float) -> None:
    moving = gb.modes(rocket(kind, load), errors=False)
    truth = frequencies(load)[:2]
    assert moving.rigid == 6 and moving.stable and not truth.imag.any()
    assert np.abs(moving.eigenvalue[:2]) / UNIT == pytest.approx(truth.real, rel=2e-3)
    plant = gb.linearize(rocket(kind, load), outputs=["rod.tip.place_z"])
    assert plant.frequency[:2] == pytest.approx(moving.frequency[:2], rel=1e-9)
    assert plant.accelerated == () if load == 0 else plant.accelerated[0].coordinate == "air.x"


def test_modes_of_a_rod_under_thrust_solve_its_equations() -> None:
    """Its free motions too: (λ² M + λ C + K) φ = 0 of the whole system."""
    state = steady_state(rocket("exact", 50.0), Drive())
    mass, velocity, stiffness, _ = state.linear
    for value, mode in zip(state.moving.value, state.moving.modes.T, strict=True):
        left = value**2 * mass @ mode + value * velocity @ mode + stiffness @ mode
        assert np.abs(left).max() < 1e-9 * np.abs(value**2 * mass @ mode).max()


def test_a_rod_flutters_under_thrust() -> None:
    """Where the truth's frequencies meet those of the model do."""
    assert not frequencies(FLUTTER - 0.02)[:2].imag.any() and frequencies(FLUTTER + 0.02)[:2].imag.any()
    below, above = (gb.modes(rocket("exact", load), errors=False) for load in (0.999 * FLUTTER, 1.002 * FLUTTER))
    assert below.stable and [each.kind for each in above.instabilities] == ["flutter"]
    grown = frequencies(112.0)[:2]
    (fluttering,) = gb.modes(rocket("exact", 112.0), errors=False).instabilities
    assert fluttering.growth_rate / UNIT == pytest.approx(np.abs(grown.imag).max(), rel=0.02)


@pytest.mark.parametrize("kind", ["FOAM", "exact"])
def test_what_falls_is_not_deformed(kind: str) -> None:
    bodies = {"hull": gb.RigidBody(1.2, (0.01, 0.01, 0.02)), "rod": rod(kind, 4)}
    joints = {"air": gb.Joint("free", "hull", turn=(0.0, 0.4, 0.0)), "weld": gb.Joint("fixed", "rod", on="hull.root")}
    falls, floats = (gb.System(bodies, joints, gravity=g) for g in ((0, 0, -9.81), None))
    rest = gb.static(falls)
    assert np.abs(rest.point_displacement).max() < 1e-12 and rest.stable
    assert [str(each) for each in rest.accelerated] == ["air.z by -9.81 m/s²"]
    assert np.abs(rest.bodies["rod"].loads.section_moment).max() < 1e-9
    assert not gb.static(floats).accelerated
    moving, beside = (gb.modes(each, errors=False) for each in (falls, floats))
    assert moving.rigid == beside.rigid == 6
    assert moving.frequency == pytest.approx(beside.frequency, rel=1e-9)
    assert moving.accelerated == rest.accelerated or str(moving.accelerated[0]) == str(rest.accelerated[0])


def craft(kind: str, *rotors: str, thrust: float) -> gb.System:
    """A hub of 1 kg with two arms, at whose tips rotors push."""
    arm, half = rod(kind, 3), (0, 0, np.pi)
    return gb.System(
        {"hub": gb.RigidBody(1.0, (0.01, 0.01, 0.02)), "right": arm, "left": arm},
        {
            "air": gb.Joint("free", "hub"),
            "clamp": gb.Joint("fixed", "right", on="hub.root"),
            "other": gb.Joint("fixed", "left", on="hub.root", turn=half),
        },
        gravity=(0, 0, -9.81),
        forces={name: gb.PointForce(f"{name}.tip", force=(0, 0, thrust), follower=True) for name in rotors},
    )


@pytest.mark.parametrize("kind", ["FOAM", "exact"])
def test_a_craft_on_two_rotors(kind: str) -> None:
    """Its tips rise by F L³/3EI − μ (a + g) L⁴/8EI, it climbs by ½ a t², and is not deformed further."""
    thrust, mass = 0.15, 1.0 + 2 * LINEAR * LENGTH
    felt = 2 * thrust / mass
    system = craft(kind, "right", "left", thrust=thrust)
    rest = gb.static(system)
    (climb,) = rest.accelerated
    assert climb.coordinate == "air.z" and climb.acceleration == pytest.approx(felt - 9.81, rel=1e-4)
    sag = thrust * LENGTH**3 / 3 / EI - LINEAR * felt * LENGTH**4 / 8 / EI
    assert rest.at("right.tip")[2] == pytest.approx(sag, rel=2e-3) and rest.errors.displacement.total < 2e-3
    response = gb.simulate(system, duration=0.2, step=2e-3, initial="relief", estimate=False)
    elastic = [k for k, name in enumerate(response.coordinates) if ".q" in name]
    assert np.abs(response.q[:, elastic] - rest.q[elastic]).max() < 1e-9 * np.abs(rest.q[elastic]).max()
    assert response.at("hub.root")[-1, 2] == pytest.approx(climb.acceleration * 0.02, rel=1e-6)


ACROSS = 0.05  # N


def pushed_across(kind: str) -> gb.System:
    """A free rod that a force at its end pushes across itself."""
    push = gb.PointForce("rod.root", force=(0, 0, ACROSS), follower=True)
    points = (gb.Point("third", LENGTH / 3), gb.Point("half", LENGTH / 2))
    return gb.System({"rod": rod(kind, 8, *points)}, {"air": FREE}, forces={"push": push})


@pytest.mark.parametrize("kind", ["FOAM", "exact"])
def test_a_rod_pushed_across_is_relieved_by_its_inertia(kind: str) -> None:
    """α = 6 F/m L; it carries −F L ξ (1 − ξ)² and its tip is F L³/20 EI off the tangent of its root, ξ = x/L."""
    rest = gb.static(pushed_across(kind))
    mass, faster = LINEAR * LENGTH, {each.coordinate: each for each in rest.accelerated}
    assert faster["air.ry"].angular_acceleration == pytest.approx(6 * ACROSS / mass / LENGTH, rel=1e-5)
    # The root goes on with 4 F/m: F/m of the mass centre and α L/2.
    assert faster["air.z"].acceleration == pytest.approx(4 * ACROSS / mass, rel=1e-5)
    share = rest.bodies["rod"].loads.stations / LENGTH
    carried = -ACROSS * LENGTH * share * (1 - share) ** 2
    assert rest.bodies["rod"].loads.section_moment[0, :, 1] == pytest.approx(carried, abs=1e-5 * ACROSS * LENGTH)
    assert rest.at("rod.tip")[2] == pytest.approx(ACROSS * LENGTH**3 / 20 / EI, rel=2e-3)
    assert np.abs(rest.ground_force).max() < 1e-9 * ACROSS and rest.stable
    said = [each for each in rest.warnings if each.startswith("air begins to turn ever faster")]
    assert f"{ACROSS * LENGTH / 2:.4g} N m about (0, 1, 0) of rod.root" in said[0]
    assert f"by 1° in {np.sqrt(np.pi / 90 / (6 * ACROSS / mass / LENGTH)):.3g} s" in said[0]
    assert (
        "air.ry by 0.3472 rad/s²" in str(rest)
        and {
            "coordinate": "air.ry",
            "angular_acceleration": faster["air.ry"].angular_acceleration,
        }
        in json_of(rest)["accelerated"]
    )
    saved = rest.to_xarray()
    assert saved.accelerated_angular_acceleration.attrs["units"] == "rad s-2"
    assert np.isnan(saved.accelerated_acceleration).sum() == 1 and np.isfinite(saved.accelerated_acceleration).any()
    begun = gb.simulate(pushed_across(kind), duration=2e-3, step=1e-3, initial="relief")
    elastic = [k for k, name in enumerate(begun.coordinates) if ".q" in name]
    assert np.abs(begun.q[0, elastic] - rest.q[elastic]).max() < 1e-9 * np.abs(rest.q[elastic]).max()


@pytest.mark.parametrize("kind", ["FOAM", "exact"])
def test_modes_of_what_begins_to_turn(kind: str) -> None:
    """A force as small leaves the frequencies of the free rod, and six motions without one."""
    system = pushed_across(kind)
    moving = gb.modes(system, errors=False)
    assert moving.rigid == 6 and moving.stable and "begins to turn ever faster" in str(moving)
    assert np.abs(moving.eigenvalue[:2]) / UNIT == pytest.approx(np.abs(frequencies(0.0)[:2]), rel=1e-3)
    plant = gb.linearize(system, outputs=["rod.tip.acceleration_z", "rod.tip.attitude_y"])
    assert plant.frequency[:2] == pytest.approx(moving.frequency[:2], rel=1e-9)
    # To an axis of its own what turns as it does is at rest: its sensors read the same however it lies.
    states = [each.name for each in plant.states]
    at = states.index("air.ry")
    assert abs(plant.c[0, at]) < 1e-9 and plant.c[1, at] == pytest.approx(1.0)
    assert np.abs(plant.a[len(states) // 2 + 3 :, at]).max() < 1e-9


def test_a_missile_whose_thrust_is_off_its_mass_centre() -> None:
    case = gb.read_scenario("fuzz/trees/missile.toml")
    moving = gb.modes(case.system, errors=False)
    assert moving.rigid == 6 and moving.stable and moving.frequency[0] == pytest.approx(83.15, rel=1e-3)
    assert any("flight begins to turn ever faster: 4.15 N m" in each for each in moving.warnings)


def test_a_craft_on_one_rotor() -> None:
    """α = J⁻¹ M about a mass centre that is the hub but for what bends."""
    rest = gb.static(craft("FOAM", "right", thrust=0.15))
    about = 0.02 + 2 * LINEAR * LENGTH**3 / 3
    faster = {each.coordinate: each for each in rest.accelerated}
    assert faster["air.ry"].angular_acceleration == pytest.approx(-0.15 * LENGTH / about, rel=2e-2)


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"damping": {"wy": 1.0}}, r"air is turned ever faster by (\S+) N m about y of hub.root"),
        ({"friction": {"wy": 1e-3}}, r"air\.ry is accelerated by 0\.3 N m, of which friction holds 0\.001 N m"),
    ],
)
def test_what_does_not_go_on_turning_faster_is_refused(more: dict[str, object], words: str) -> None:
    system = craft("FOAM", "right", thrust=0.15)
    held = gb.Joint("free", "hub", **more)  # type: ignore[arg-type]
    with pytest.raises(gb.ComputationError, match=words) as said:
        gb.static(gb.System(system.bodies, {**system.joints, "air": held}, forces=system.forces))
    assert said.value.outcome == "no equilibrium"


@pytest.mark.parametrize("joint", ["free", "spherical"])
def test_a_moment_that_changes_with_the_angle_turns_the_body_until_there_is_none(joint: str) -> None:
    """A force of constant direction off the mass centre, and off a pivot, pulls it into line, about which it swings."""
    body = gb.RigidBody(1.0, (0.01, 0.02, 0.02), centre=(0.3, 0, 0), points={"end": (0.5, 0, 0)})
    for follower in (True, False):
        push = gb.PointForce("b.end", force=(0, 0, 1.0), follower=follower)
        system = gb.System({"b": body}, {"air": gb.Joint(joint, "b")}, forces={"push": push})
        if follower:
            about = 0.02 if joint == "free" else 0.02 + 0.09
            arm = 0.2 if joint == "free" else 0.5
            faster = gb.static(system).accelerated[-1]
            assert faster.coordinate == "air.ry" and faster.angular_acceleration == pytest.approx(-arm / about)
        else:
            rest, arm, about = gb.static(system), *((0.2, 0.02) if joint == "free" else (0.5, 0.02 + 0.09))
            assert rest.place[0] - rest.place[1] == pytest.approx([0, 0, 0.5], abs=1e-12) and rest.stable
            assert [str(each) for each in rest.accelerated] == (["air.z by 1 m/s²"] if joint == "free" else [])
            assert 2 * np.pi * gb.modes(system).frequency == pytest.approx([np.sqrt(arm / about)] * 2, rel=1e-9)


PANEL, OFFSET, HUB = 1.0, 0.2, 2.0  # m, m, kg m²


def slewed(kind: str, gravity: tuple[float, float, float] | None = None, **more: object) -> gb.System:
    """A panel on a hub that a torque of 1 N m turns about an axis which stays."""
    strip = gb.Beam(PANEL, gb.Section.rectangle(0.05, 0.002), gb.Material(DENSITY, MODULUS), damping_ratio=0.0)
    bodies = {"hub": gb.RigidBody(10.0, (1.0, HUB, 1.0)), "panel": gb.assemble(strip, kind, axial=1, y=0, z=3)}
    pin = gb.Joint("revolute", "hub", axes=[(0, -1, 0)], effort=1.0, **more)  # type: ignore[arg-type]
    clamp = gb.Joint("fixed", "panel", "hub.root", at=(OFFSET, 0, 0))
    return gb.System(bodies, {"pin": pin, "clamp": clamp}, gravity=gravity)


@pytest.mark.parametrize("gravity", [None, (0.0, -9.81, 0.0)])
@pytest.mark.parametrize("kind", ["FOAM", "exact"])
def test_a_hub_that_begins_to_turn_bends_its_panel(kind: str, gravity: tuple[float, float, float] | None) -> None:
    """α = M/J, and the tip stays behind by μ α (11 L⁵/120 + r L⁴/8)/EI; what is left of K is that of a free hub."""
    bending, linear = MODULUS * 0.05 * 0.002**3 / 12, DENSITY * 0.05 * 0.002
    alpha = 1.0 / (HUB + linear * PANEL * (PANEL**2 / 3 + OFFSET * PANEL + OFFSET**2))
    rest = gb.static(slewed(kind, gravity))
    (faster,) = rest.accelerated
    assert faster.coordinate == "pin.angle" and faster.angular_acceleration == pytest.approx(alpha, rel=1e-3)
    sag = linear * alpha * (11 * PANEL**5 / 120 + OFFSET * PANEL**4 / 8) / bending
    assert rest.at("panel.tip")[2] == pytest.approx(-sag, rel=2e-3)
    assert any("pin begins to turn ever faster: 1 N m about its axis" in each for each in rest.warnings)
    moving = gb.modes(slewed(kind, gravity), errors=False)
    assert moving.rigid == 1 and moving.stable
    free = gb.modes(gb.System(slewed(kind).bodies, {**slewed(kind).joints, "pin": FREE_PIN}), errors=False)
    assert moving.frequency[:2] == pytest.approx(free.frequency[:2], rel=1e-3)
    run = gb.simulate(slewed(kind, gravity), duration=1e-3, step=1e-3, initial="relief")
    elastic = [k for k, name in enumerate(run.coordinates) if name.startswith("panel.q")]
    np.testing.assert_allclose(run.q[0, elastic], rest.q[elastic], atol=1e-8)


FREE_PIN = gb.Joint("revolute", "hub", axes=[(0, -1, 0)])


@pytest.mark.parametrize("by", [{"gravity": (0, 0, -9.81)}, {"forces": {"push": gb.PointForce("b.end", (0, 0, 1.0))}}])
def test_a_pendulum_is_not_turned_ever_faster(by: dict[str, object]) -> None:
    """Drawn level, where its moment is largest and K none, it hangs from the pin, or along the force."""
    body = gb.RigidBody(1.0, (0.01, 0.02, 0.02), centre=(0.3, 0, 0), points={"end": (0.5, 0, 0)})
    pin = gb.Joint("revolute", "b", axes=[(0, 1, 0)])
    rest = gb.static(gb.System({"b": body}, {"pin": pin}, **by))  # type: ignore[arg-type]
    assert rest.coordinate("pin.angle") == pytest.approx(np.pi / 2 * (1 if "gravity" in by else -1), rel=1e-12)
    assert rest.stable and not rest.accelerated


@pytest.mark.parametrize(
    ("more", "words"),
    [({"damping": 1.0}, "which nothing holds"), ({"friction": 0.1}, r"of which friction holds 0\.1 N m")],
)
def test_a_hub_that_does_not_go_on_turning_faster_is_refused(more: dict[str, object], words: str) -> None:
    with pytest.raises(gb.ComputationError, match=rf"pin\.angle is accelerated by 1 N m, {words}"):
        gb.static(slewed("FOAM", **more))


def carts(**more: object) -> gb.System:
    rail = gb.Joint("prismatic", "front", axes=[(1, 0, 0)], effort=6.0, **more)  # type: ignore[arg-type]
    coupling = gb.Joint("prismatic", "back", on="front.root", axes=[(1, 0, 0)], stiffness=50.0)
    return gb.System({"front": gb.RigidBody(2.0), "back": gb.RigidBody(1.0)}, {"rail": rail, "coupling": coupling})


def test_carts_on_a_rail() -> None:
    """One pulls the other by a spring, a = F/(m + M), x = −m a/k, ω² = k (1/m + 1/M); and both free are two answers."""
    rest, moving = gb.static(carts()), gb.modes(carts())
    assert [str(each) for each in rest.accelerated] == ["rail.displacement by 2 m/s²"]
    assert rest.coordinate("coupling.displacement") == pytest.approx(-0.04, rel=1e-12)
    assert 2 * np.pi * moving.frequency == pytest.approx([np.sqrt(75.0)], rel=1e-12) and moving.rigid == 1
    loose = gb.Joint("prismatic", "back", on="front.root", axes=[(1, 0, 0)])
    both = gb.static(gb.System(carts().bodies, {**carts().joints, "coupling": loose}))
    assert [each.acceleration for each in both.accelerated] == pytest.approx([3.0, -3.0], rel=1e-12)


def test_what_is_pushed_rests_at_its_stop() -> None:
    stops = {"stops": (-1.0, 1.0), "stop_stiffness": 1e5}
    hub, rail = gb.static(slewed("FOAM", **stops)), gb.static(carts(**stops))
    assert hub.coordinate("pin.angle") == pytest.approx(1.0 + 1.0 / 1e5, rel=1e-12) and hub.stable
    assert rail.coordinate("rail.displacement") == pytest.approx(1.0 + 6.0 / 1e5, rel=1e-12) and rail.stable


@pytest.mark.parametrize(
    ("more", "words"), [({"damping": 1.0}, "which nothing holds"), ({"friction": 1.0}, "of which friction holds 1 N")]
)
def test_what_does_not_go_on_evenly_is_refused(more: dict[str, object], words: str) -> None:
    with pytest.raises(gb.ComputationError, match=rf"rail\.displacement is accelerated by 6 N, {words}"):
        gb.static(carts(**more))


@pytest.mark.parametrize("axis", range(3))
def test_small_departures_of_a_spinning_body_are_in_its_axes(axis: int) -> None:
    """λ² = −Ω² (J − J₁)(J − J₂)/(J₁ J₂) about a principal axis; a tilt that stays turns by −Ω."""
    inertia, rate = (1.0, 1.5, 2.0), 3.0
    body = gb.RigidBody(1.0, inertia)
    spun = gb.Joint("free", "rod", turn=(0.3, 0.2, -0.5), initial_rate={f"w{'xyz'[axis]}": rate})
    poles = gb.linearize(gb.System({"rod": body}, {"air": spun}), at="start").eigenvalue
    one, *others = np.roll(inertia, -axis)
    square = -(rate**2) * (one - others[0]) * (one - others[1]) / np.prod(others)
    for truth in (1j * rate, np.sqrt(complex(square))):
        assert np.abs(poles - truth).min() < 1e-6 * rate and np.abs(poles + truth).min() < 1e-6 * rate
    assert np.sort(np.abs(poles))[:8] == pytest.approx(0, abs=1e-6)


def test_a_spin_that_is_left_out_is_said() -> None:
    """Of what goes on turning by itself: not of a pendulum, which swings about its rest whatever its rate."""
    body = gb.RigidBody(1.0, (1.0, 1.5, 2.0), centre=(0.1, 0, 0))
    spun = gb.System({"rod": body}, {"air": gb.Joint("free", "rod", initial_rate={"wz": 1.0, "x": 5.0})})
    hinge = gb.Joint("revolute", "rod", axes=[(0, 1, 0)], initial=np.pi / 2, initial_rate=1.0)
    swings = gb.System({"rod": body}, {"pin": hinge}, gravity=(0, 0, -9.81))
    for ask in (gb.static, gb.modes):
        (said,) = ask(spun).warnings
        assert said.startswith("as if air did not turn, as at the start") and not ask(swings).warnings
    assert not gb.linearize(spun, at="start").warnings
