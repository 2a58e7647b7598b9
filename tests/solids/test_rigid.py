"""A rigid specimen: sums over particles, textbooks' bolts, and the F-16's record."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gbeam as gb

DATA = Path(__file__).parents[2] / "examples" / "data" / "f16_8g_turn.csv"
G = 9.80665


def tumbling(seed: int) -> gb.Flight:
    rng = np.random.default_rng(seed)
    times = np.linspace(0, 2, 9)
    rates = gb.smoothed(gb.tabulated(times, rng.normal(size=(9, 3))), 0.3)
    return gb.Flight(acceleration=gb.tabulated(times, 30 * rng.normal(size=(9, 3))), rates=rates)


@pytest.mark.parametrize("seed", range(3))
def test_force_and_moment_are_those_of_particles(seed: int) -> None:
    """D'Alembert's sum over a cloud of them, whose mass, centre and inertia the specimen has."""
    rng = np.random.default_rng(seed)
    mass, r = rng.random(20), rng.normal(size=(20, 3))
    centre = mass @ r / mass.sum()
    arms = r - centre
    inertia = (mass * (arms**2).sum(axis=1)).sum() * np.eye(3) - (mass[:, None] * arms).T @ arms
    body = gb.RigidSpecimen(mass.sum(), centre, inertia, corners=r)
    flight = tumbling(seed)
    loads = body.loads(flight, 2.0, sample=0.05)
    assert loads.time[0] == 0 and loads.time[-1] == 2 and np.diff(loads.time).max() < 0.0501
    np.testing.assert_allclose(loads.force, np.einsum("k,tki->ti", mass, loads.acceleration), atol=1e-10)
    turned = np.cross(r, mass[:, None] * loads.acceleration).sum(axis=1)
    np.testing.assert_allclose(loads.moment, turned, atol=1e-10 * np.abs(turned).max())


@pytest.mark.parametrize("seed", range(3))
def test_bolts_carry_what_the_fixture_gives(seed: int) -> None:
    """Their forces and moments add up, however they lie."""
    rng = np.random.default_rng(seed)
    box = gb.RigidSpecimen.box(3.0, (0.3, 0.2, 0.1), (0.02, -0.01, 0.06), bolts=rng.random((5, 3)), bolt_axis=(0, 0, 2))
    loads = box.loads(tumbling(seed), 2.0, sample=0.05)
    np.testing.assert_allclose(loads.bolt_force.sum(axis=1), loads.force, atol=1e-9)
    moment = np.cross(loads.bolts, loads.bolt_force).sum(axis=1)
    np.testing.assert_allclose(moment, loads.moment, atol=1e-9)
    along = loads.tension - loads.compression
    np.testing.assert_allclose(along**2 + loads.shear**2, (loads.bolt_force**2).sum(axis=-1))
    assert not np.any((loads.tension > 0) & (loads.compression > 0)) and min(along.min(), -along.max()) < 0


def test_a_textbooks_bolt_group() -> None:
    """Four bolts in a rectangle under a force above them: F/4 of shear each, and M y/Σy² of tension."""
    bolts = [(0.1, 0.05, 0), (-0.1, 0.05, 0), (0.1, -0.05, 0), (-0.1, -0.05, 0)]
    box = gb.RigidSpecimen.box(2.0, (0.1, 0.1, 0.2), (0, 0, 0.1), bolts=bolts, bolt_axis=(0, 0, 1))
    loads = box.loads(gb.Flight(x=gb.constant(50.0)), 1.0, sample=1.0)
    # Accelerated along x at a height of 0.1 m: the rear pair holds it down.
    np.testing.assert_allclose(loads.shear, 100 / 4)
    np.testing.assert_allclose(loads.tension[0], 100 * 0.1 * 0.1 / (4 * 0.1**2) * np.array([1, 0, 1, 0]))
    np.testing.assert_allclose(loads.compression[0], 100 * 0.1 * 0.1 / (4 * 0.1**2) * np.array([0, 1, 0, 1]))
    sideways = gb.RigidSpecimen.box(2.0, (0.1, 0.1, 0.2), (0.3, 0, 0), bolts=bolts, bolt_axis=(0, 0, 1))
    twisted = sideways.loads(gb.Flight(y=gb.constant(50.0)), 1.0, sample=1.0)
    # In-plane: F/n and T r/Σr², Σr² = 4 (0.1² + 0.05²).
    turn = 100 * 0.3 / (4 * (0.1**2 + 0.05**2))
    np.testing.assert_allclose(twisted.bolt_force[0, 0], [-turn * 0.05, 25 + turn * 0.1, 0], atol=1e-12)


def test_a_box_in_the_turn_of_the_f16() -> None:
    """In translation the load is that of the record everywhere, and the force the weight times it."""
    record = np.genfromtxt(DATA, delimiter=",", names=True)
    load = G * np.stack([record["n_x_g"], -record["n_y_g"], -record["n_z_g"]], axis=1)
    flight = gb.Flight(acceleration=gb.read_record(DATA, "time_s", "n_x_g", "-n_y_g", "-n_z_g", "g"))
    box = gb.RigidSpecimen.box(3.0, (0.3, 0.2, 0.1), (0, 0, 0.05))
    loads = box.loads(flight, 15.99, sample=0.01, name="flight")
    np.testing.assert_allclose(loads.force, 3.0 * load, atol=1e-9)
    np.testing.assert_allclose(loads.moment, np.cross((0, 0, 0.05), 3.0 * load), atol=1e-9)
    size = np.linalg.norm(load, axis=1)
    assert loads.largest.size == pytest.approx(size.max()) and loads.largest.time == pytest.approx(0.01 * size.argmax())
    assert loads.spread_max < 1e-12 and f"{size.max() / G:.4g} g" in repr(loads)


def test_a_box_on_a_centrifuge_by_hand() -> None:
    """On a hub at 10 rad/s, ω² (R + x) along −x and gravity up: a spread of half the length over the radius."""
    box = gb.RigidSpecimen.box(2.0, (0.4, 0.2, 0.1), (0.0, 0.0, 0.0))
    loads = box.loads(gb.Hub(radius=2.0, rate=10.0), 1.0, sample=0.5)
    far = np.hypot(100 * 2.2, 100 * 0.1)
    assert loads.largest.size == pytest.approx(far) and loads.largest.place[0] == pytest.approx(0.2)
    np.testing.assert_allclose(loads.force, [[-400.0, 0, 0]] * 3, atol=1e-9)
    assert loads.spread_max == pytest.approx(np.hypot(0.2, 0.1) / 2.0)
    spun = box.loads(gb.Hub(radius=2.0, rate=gb.SmoothStep(10.0, 4.0)), 4.0, sample=0.01)
    # Euler's moment about the axis, I α, and the tangential force, m R α.
    rate = np.gradient(100 * 0 + 10 * _smooth(spun.time / 4.0), spun.time)
    np.testing.assert_allclose(spun.moment[5:-5, 2], 2.0 / 12 * (0.4**2 + 0.2**2) * rate[5:-5], atol=1e-3)
    np.testing.assert_allclose(spun.force[5:-5, 1], 2.0 * 2.0 * rate[5:-5], atol=1e-2)


def _smooth(s: np.ndarray) -> np.ndarray:
    """s − sin(2πs)/2π."""
    return s - np.sin(2 * np.pi * s) / (2 * np.pi)


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"mass": -1.0}, "mass is -1 kg"),
        ({"corners": np.zeros((0, 3))}, r"corners has the shape \(0, 3\)"),
        ({"inertia": np.diag([1.0, 1.0, 3.0])}, r"inertia has the principal moments 1, 1 and 3 kg m²; none is larger"),
        ({"inertia": np.diag([-1.0, 1.0, 1.0])}, "inertia has the principal moments"),
        ({"inertia": [[1, 0.5, 0], [0, 1, 0], [0, 0, 1]]}, "inertia is not symmetric"),
        ({"bolts": [(0, 0, 0), (1, 0, 0)]}, "bolt_axis is missing beside bolts"),
        ({"bolts": [(0, 0, 0), (1, 0, 0)], "bolt_axis": (0, 0, 0)}, "bolt_axis is zero; give their direction"),
        ({"bolt_axis": (0, 0, 1)}, "bolt_axis is given without bolts; give their places"),
        ({"bolts": [(0, 0, 0), (1, 0, 0)], "bolt_axis": (0, 0, 1)}, "bolts are 2 on a line, which carry no moment"),
    ],
)
def test_specimens_that_cannot_be_are_refused(changed: dict[str, Any], words: str) -> None:
    sound = {"mass": 1.0, "centre": (0, 0, 0), "inertia": np.eye(3), "corners": [(0, 0, 0)]}
    with pytest.raises(gb.InputError, match=words):
        gb.RigidSpecimen(**(sound | changed))


def test_a_free_hub_is_refused() -> None:
    box = gb.RigidSpecimen.box(2.0, (0.4, 0.2, 0.1), (0.0, 0.0, 0.0))
    with pytest.raises(gb.InputError, match="motion is a free hub"):
        box.loads(gb.Hub(radius=2.0, inertia=10.0, torque=gb.constant(1.0)), 1.0, sample=0.5)


def test_what_deforms_is_not_asked_of_a_box() -> None:
    box, hub = gb.RigidSpecimen.box(2.0, (0.4, 0.2, 0.1), (0.0, 0.0, 0.0)).structure, gb.Hub(radius=2.0)
    for ask in (
        lambda: gb.modes(box),
        lambda: gb.linearize(box, hub),
        lambda: gb.campbell(box, hub, end=1.0),
        lambda: gb.critical_speed(box, hub),
        lambda: gb.buckling_acceleration(box),
    ):
        with pytest.raises(gb.InputError, match="structure is rigid, and this is of what deforms; ask simulate"):
            ask()


def test_a_box_at_rest_says_what_each_bolt_carries() -> None:
    """Of four bolts under a centre of mass 50 mm above them, under a specific force of 10 m/s² along x and z."""
    bolts = [(x, y, 0.0) for x in (-0.1, 0.1) for y in (-0.08, 0.08)]
    box = gb.RigidSpecimen.box(3.0, (0.3, 0.2, 0.1), (0, 0, 0.05), bolts=bolts, bolt_axis=(0, 0, 1))
    rest = gb.static(box.structure, acceleration=(10.0, 0.0, 10.0))
    assert rest.stable and rest.specimen is not None and rest.loads is not None
    np.testing.assert_allclose(rest.loads.root_force[0], (30.0, 0.0, 30.0))
    # The moment 0.05 m × 30 N presses the row behind and lifts that in front, 0.2 m apart; the weight presses on all.
    pressed = [30 / 4 - np.sign(x) * 0.05 * 30 / 0.2 / 2 for x, *_ in bolts]
    np.testing.assert_allclose(rest.specimen.compression[0], pressed, rtol=1e-12)
    np.testing.assert_array_equal(rest.specimen.tension, 0)
    np.testing.assert_allclose(rest.specimen.shear[0], 30 / 4)
    assert "bolts: tension up to 0 N, compression up to 11.25 N, shear up to 7.5 N" in repr(rest)


@pytest.mark.parametrize(("down", "pulled", "pressed"), [(1, 67.84, 35.97), (-1, 38.70, 70.57)])
def test_the_weight_of_the_example_counts_on_its_bolts(down: int, pulled: float, pressed: float) -> None:
    """By hand: 9 g on 52 mm tips the box, the weight pulls or presses, and tips it by 12 mm; bolts 280 mm apart."""
    case = gb.read_scenario("examples/rigid_box.toml", [f'motion.arm.gravity=[0, 0, "{down} g"]'])
    (arm,) = case.motions.values()
    weight, along = 6.5 * G, 6.5 * 3.312 * 5.1622**2
    tipped = (0.052 * along - down * 0.012 * weight) / (2 * 0.28)
    rest = gb.static(case.subject, arm, time=40.0, name="arm").specimen
    assert rest is not None
    np.testing.assert_allclose(rest.tension[0, ::2], down * weight / 4 + tipped, rtol=1e-9)
    np.testing.assert_allclose(rest.compression[0, 1::2], tipped - down * weight / 4, rtol=1e-9)
    assert (rest.bolt_tension.max(), rest.bolt_compression.max()) == pytest.approx((pulled, pressed), rel=1e-4)


def test_a_box_on_the_f16_flight_is_newtons() -> None:
    """At every time of the record: force m a, moment c × m a, the bolts' sums; nothing is spread, without rates."""
    case = gb.read_scenario("examples/f16_8g_turn.toml")
    bolts = np.array([(-0.1, -0.08, 0.0), (0.1, -0.08, 0.0), (-0.1, 0.08, 0.0), (0.1, 0.08, 0.0)])
    box = gb.RigidSpecimen.box(3.0, (0.3, 0.2, 0.1), (0.01, 0.02, 0.05), bolts=bolts, bolt_axis=(0, 0, 1))
    response = gb.simulate(box.structure, case.motions["flight"], duration=15.99, step=2e-3, estimate=False)
    loads, a = response.specimen, response.base.a_WO_B
    assert loads is not None and response.loads is not None
    assert loads.acceleration == pytest.approx(np.broadcast_to(a[:, None], loads.acceleration.shape), abs=1e-12)
    moment = np.cross((0.01, 0.02, 0.05), 3.0 * a)
    for force, turning in ((loads.force, loads.moment), (response.loads.root_force, response.loads.root_moment)):
        assert force == pytest.approx(3.0 * a, abs=1e-10) and turning == pytest.approx(moment, abs=1e-10)
    assert loads.bolt_force.sum(axis=1) == pytest.approx(3.0 * a, abs=1e-10)
    assert np.cross(bolts, loads.bolt_force).sum(axis=1) == pytest.approx(moment, abs=1e-10)
    assert loads.spread_max == pytest.approx(0.0, abs=1e-12)


def test_a_box_on_the_centrifuge_is_newtons() -> None:
    """By numerical derivatives of where its points are, carried by the axes of the machine."""
    case = gb.read_scenario("examples/f16_8g_turn.toml")
    machine = case.motions["centrifuge"].over(0.0, 15.99)
    inertia = ((0.02, 0.001, 0.0), (0.001, 0.03, 0.002), (0.0, 0.002, 0.04))
    box = gb.RigidSpecimen(3.0, (0.01, 0.02, 0.05), inertia, [(0.2, 0.1, 0.1), (-0.1, -0.1, 0.0)])
    loads = box.loads(machine, duration=15.99, sample=0.05)
    base = machine.base(loads.time)
    w, alpha = base.w_WB_B, base.alpha_WB_B
    for k, corner in enumerate(np.asarray(box.corners)):
        # a + Ω̇ r with Ω = skew ω: the matrix of the rotation's second derivative.
        skew = np.stack([np.cross(np.eye(3)[i], -w) for i in range(3)], axis=-1)
        turning = np.stack([np.cross(np.eye(3)[i], -alpha) for i in range(3)], axis=-1)
        field = base.a_WO_B + np.einsum("tij,j->ti", turning + skew @ skew, corner)
        assert loads.acceleration[:, k] == pytest.approx(field, abs=1e-9)
    # Its moment of momentum about the centre changes by the moment there: power of the moment is the energy's rate.
    about_centre = loads.moment - np.cross((0.01, 0.02, 0.05), loads.force)
    power = (about_centre * w).sum(axis=1)
    assert power == pytest.approx(np.einsum("ti,ij,tj->t", w, np.array(inertia), alpha), abs=1e-9)


def test_a_box_has_one_largest_force_and_one_largest_moment() -> None:
    """Between samples too, whichever part of an answer says them: of a sine they are its amplitude."""
    box = gb.RigidSpecimen.box(2.0, (0.2, 0.1, 0.1), (0.0, 0.0, 0.05))
    shaken = gb.Flight(x=gb.Sine(30.0, 1.0))
    response = gb.simulate(box.structure, shaken, duration=1.0, step=0.035)
    loads, peaks = response.specimen, response.peaks.loads
    assert loads is not None and peaks is not None
    for largest, between, samples, size in (
        (loads.force_max, peaks.root_force, loads.force, 60.0),
        (loads.moment_max, peaks.root_moment, loads.moment, 3.0),
    ):
        assert largest == between.size.value == pytest.approx(size, rel=1e-4)
        assert np.abs(samples).max() < 0.999 * size
    assert f"on the fixture up to {60.0:.4g} N and {3.0:.4g} N m" in repr(response)


FEET = {"a": (-0.15, -0.1, 0.0), "b": (0.15, -0.1, 0.0), "c": (0.15, 0.1, 0.01), "d": (-0.15, 0.1, 0.0)}
RESTS = [gb.Support("a", ["x", "y", "z"]), gb.Support("b", ["y", "z"]), gb.Support("c", ["z"])]


def on_feet(supports: list[gb.Support], **more: Any) -> gb.RigidSpecimen:
    whole = gb.RigidSpecimen.box(3.0, (0.3, 0.2, 0.1), (0.01, 0.0, 0.05))
    return gb.RigidSpecimen(3.0, whole.centre, whole.inertia, whole.corners, points=FEET, supports=supports, **more)


@pytest.mark.parametrize("seed", range(2))
def test_a_box_on_six_rigid_directions_stands_as_statics_says(seed: int) -> None:
    """It has no coordinates, and the six reactions are those that six equations of equilibrium have."""
    box, flight = on_feet(RESTS), tumbling(seed)
    structure = box.structure
    response = gb.simulate(structure, flight, duration=2.0, step=0.01, estimate=False)
    loads: Any = response.body.loads
    assert structure.size == 0 and loads.support_names == ("a", "b", "c")
    unknown = [(each.at, "xyz".index(way)) for each in RESTS for way in each.holds]
    force = np.stack([np.eye(3)[way] for _, way in unknown])
    moment = np.stack([np.cross(FEET[at], np.eye(3)[way]) for at, way in unknown])
    rigid = box.loads(flight, 2.0, sample=0.01)
    needed = np.concatenate([rigid.force, rigid.moment], axis=1)
    sizes = np.linalg.solve(np.concatenate([force, moment], axis=1).T, needed.T).T
    at_samples = [int(np.argmin(np.abs(rigid.time - t))) for t in response.time]
    for k, (at, way) in enumerate(unknown):
        reaction = loads.support_force[:, loads.support_names.index(at), way]
        np.testing.assert_allclose(reaction, sizes[at_samples, k], atol=1e-9 * np.abs(sizes).max())
    assert not np.any(loads.root_force) and not np.any(loads.support_moment)


def test_a_box_on_isolators_moves_as_six_equations_say() -> None:
    """Frequencies and static reactions of M and K by the feet's places, and the damping of one that bounces evenly."""
    springs = {"a": (1e5, 1e5, 4e5), "b": (2e5, 1e5, 3e5), "c": (1e5, 3e5, 4e5), "d": (1e5, 1e5, 2e5)}
    supports = [gb.Support(name, stiffness=dict(zip("xyz", each, strict=True))) for name, each in springs.items()]  # type: ignore[arg-type]
    box = on_feet(supports)
    structure = box.structure
    stiffness = np.zeros((6, 6))
    maps = {}
    for name, each in springs.items():
        arm = np.subtract(FEET[name], box.centre)
        maps[name] = np.concatenate([np.eye(3), np.cross(np.eye(3), arm).T], axis=1)
        stiffness += maps[name].T @ np.diag(each) @ maps[name]
    mass = np.zeros((6, 6))
    mass[:3, :3], mass[3:, 3:] = 3.0 * np.eye(3), np.asarray(box.inertia)
    squares = np.linalg.eigvals(np.linalg.solve(mass, stiffness)).real
    np.testing.assert_allclose(gb.modes(structure).frequency, np.sqrt(np.sort(squares)) / (2 * np.pi), rtol=1e-9)
    acceleration = 1e-3 * np.array([3.0, -2.0, 9.0])
    moved = np.linalg.solve(stiffness, -np.append(3.0 * acceleration, np.zeros(3)))
    loads: Any = gb.static(structure, acceleration=tuple(acceleration)).loads
    for k, (name, each) in enumerate(springs.items()):
        np.testing.assert_allclose(loads.support_force[0, k], -np.array(each) * (maps[name] @ moved), rtol=1e-6)
    even = {name: (x, y, 0.0) for name, (x, y, _) in FEET.items()}
    feet = [gb.Support(name, ["x", "y"][: 2 - k // 2], {"z": 1e5}, {"z": 30.0}) for k, name in enumerate(even)]
    bouncing = gb.RigidSpecimen(
        3.0, (0, 0, 0.0), box.inertia, box.corners, points=even,
        supports=[gb.Support(each.at, (), {"x": 1e8, "y": 1e8, **each.stiffness}, each.damping) for each in feet],
    ).structure  # fmt: skip
    modes = gb.modes(bouncing)
    k = int(np.argmin(np.abs(modes.frequency - np.sqrt(4e5 / 3.0) / (2 * np.pi))))
    assert modes.frequency[k] == pytest.approx(np.sqrt(4e5 / 3.0) / (2 * np.pi), rel=1e-6)
    assert modes.damping_ratio[k] == pytest.approx(4 * 30.0 / 2 / np.sqrt(4e5 * 3.0), rel=1e-6)


def test_a_box_on_isolators_hangs_in_a_tree() -> None:
    """A heavy car carries it as a wall does."""
    supports = [gb.Support(name, stiffness={"x": 1e5, "y": 1e5, "z": 2e5}) for name in FEET]
    alone = on_feet(supports).structure
    joints = {"free": gb.Joint("free", "car"), "deck": gb.Joint("fixed", "box", on="car.deck")}
    car = gb.RigidBody(1e6, (1e6, 1e6, 1e6), points={"deck": (0, 0, 0.2)})
    carried = gb.modes(gb.System({"car": car, "box": alone}, joints), errors=False)
    np.testing.assert_allclose(carried.frequency, gb.modes(alone).frequency, rtol=1e-4)


@pytest.mark.parametrize(
    ("supports", "more", "words"),
    [
        (
            [*RESTS, gb.Support("d", ["z"])],
            {},
            r"supports\[3\] holds z at d, where it is held already; leave z out, or ho",
        ),
        (RESTS[:2], {}, r"supports leave the body free to move about x; hold that at one more place"),
        ([gb.Support("lid", ["z"])], {}, r"supports\[0\]\.at is 'lid'; choose one of a, b, c, d, tip"),
        (RESTS, {"spread_limit": 0.1}, r"spread_limit is of a body that its root holds; leave it out beside supports"),
        (
            RESTS,
            {"bolts": [(0, 0, 0), (1, 0, 0), (0, 1, 0)], "bolt_axis": (0, 0, 1)},
            r"supports and bolts are both given",
        ),
    ],
)
def test_how_a_box_cannot_stand_is_refused(supports: list[gb.Support], more: dict[str, Any], words: str) -> None:
    with pytest.raises(gb.InputError, match=words):
        _ = on_feet(supports, **more).structure
