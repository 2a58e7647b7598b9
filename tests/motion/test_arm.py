"""A plain arm against closed forms with weight: corners, forces and bolts of a box in any direction, onset and ramp."""

import numpy as np
import pytest

import gbeam as gb

G = 9.80665
RADIUS, LEVEL, RAMP, DWELL = 3.3, 9 * G, 20.0, 60.0
CENTRE = np.array([0.012, -0.004, 0.052])
WORDS = [f"{sign}{axis}" for axis in "xyz" for sign in "+-"]
BOLTS = np.array([(x, y, 0.0) for x in (-0.14, 0.14) for y in (-0.08, 0.08)])


def unit(word):
    return float(f"{word[0]}1") * np.eye(3)["xyz".index(word[1])]


def box():
    corners = [(x, y, z) for x in (-0.16, 0.16) for y in (-0.1, 0.1) for z in (0.0, 0.12)]
    inertia = np.diag([0.030, 0.063, 0.076])
    return gb.RigidSpecimen(6.5, CENTRE, inertia, corners, bolts=BOLTS, bolt_axis=(0, 0, 1))


def arm(load, up, **changed):
    asked = {"radius": RADIUS, "control_point": CENTRE, "level": LEVEL, "ramp": RAMP, "dwell": DWELL} | changed
    return gb.plain_arm(load=load, up=up, **asked)


def felt(place, inward, upward, rate, acceleration, weight=G):
    """Specific force at a place from the root: the axis passes at the radius from the control point, along `inward`."""
    from_axis = place - (CENTRE + RADIUS * inward)
    from_axis = from_axis - (from_axis @ upward) * upward
    return -(rate**2) * from_axis + np.cross(acceleration * upward, from_axis) + weight * upward


@pytest.mark.parametrize("load", WORDS)
def test_a_box_in_six_directions_with_its_weight(load):
    up = "+x" if load[1] == "z" else "+z"
    inward, upward, specimen = unit(load), unit(up), box()
    loads = specimen.loads(arm(load, up), duration=100.0, sample=5.0)
    at = int(np.searchsorted(loads.time, 50.0))
    rate = np.sqrt(LEVEL / RADIUS)
    corners = [felt(corner, inward, upward, rate, 0.0) for corner in np.asarray(specimen.corners)]
    assert loads.acceleration[at] == pytest.approx(np.array(corners), abs=1e-9)
    centre = LEVEL * inward + G * upward
    assert loads.centre[at] == pytest.approx(centre, abs=1e-9)
    assert loads.force[at] == pytest.approx(6.5 * centre, abs=1e-9)
    # The moment about the root: of the force at the centre, and of the spin about an axis that is a principal one.
    assert loads.moment[at] == pytest.approx(np.cross(CENTRE, 6.5 * centre), abs=1e-9)
    # Bolts alike: an even share of the force, and of the moment by their places.
    assert loads.bolt_force[at].sum(axis=0) == pytest.approx(6.5 * centre, abs=1e-9)
    assert np.cross(BOLTS, loads.bolt_force[at]).sum(axis=0) == pytest.approx(loads.moment[at], abs=1e-9)


def test_on_the_way_up_the_arm_accelerates_along_its_path_too():
    inward, upward = unit("-y"), unit("+z")
    base = arm("-y", "+z").base(RAMP / 2)
    rate = np.sqrt(LEVEL / RADIUS)
    expected = felt(np.zeros(3), inward, upward, rate / 2, 2 * rate / RAMP)
    assert np.asarray(base.a_WO_B) == pytest.approx(expected, abs=1e-9)
    assert base.w_WB_B == pytest.approx(rate / 2 * upward, abs=1e-12)


def test_an_oblique_mounting_and_an_up_that_is_not_quite_across():
    oblique = np.array([1.0, 2.0, 2.0]) / 3
    base = arm(oblique, (0.3, 0.0, 1.0)).base(50.0)
    upward = np.array([0.3, 0.0, 1.0]) - (np.array([0.3, 0.0, 1.0]) @ oblique) * oblique
    upward /= np.linalg.norm(upward)
    expected = felt(np.zeros(3), oblique, upward, np.sqrt(LEVEL / RADIUS), 0.0)
    assert np.asarray(base.a_WO_B) == pytest.approx(expected, abs=1e-9)


def test_weight_is_left_out_only_by_name():
    level = arm("+x", "+z", control_point=(0, 0, 0)).base(50.0).a_WO_B
    assert level == pytest.approx([LEVEL, 0, G])
    weightless = arm("+x", "+z", control_point=(0, 0, 0), gravity=False)
    assert weightless.base(50.0).a_WO_B == pytest.approx([LEVEL, 0, 0])
    assert box().loads(weightless, duration=1.0, sample=0.5).notes == ()


def test_the_onset_is_the_largest_rate_at_which_the_level_rises():
    onset = 0.5 * G
    motion = arm("+x", "+z", ramp=None, onset=onset)
    ramp = 2.521152657241058 * LEVEL / onset
    assert motion.rate.extent == pytest.approx((0.0, 2 * ramp + DWELL))
    time = np.linspace(0.0, ramp, 20001)
    rises = np.gradient(RADIUS * np.asarray(motion.rate(time)) ** 2, time)
    assert rises.max() == pytest.approx(onset, rel=1e-7)


def test_a_level_is_told_as_it_is_held():
    response = gb.simulate(box().structure, arm("+x", "+z", down=10.0), duration=90.0, step=0.1)
    level = response.hub.level
    assert (level.level, level.radius) == pytest.approx((LEVEL, RADIUS))
    assert (level.reached, level.ends) == pytest.approx((RAMP, RAMP + DWELL), abs=1e-9)
    assert level.rate == pytest.approx(np.sqrt(LEVEL / RADIUS))
    assert level.load == pytest.approx([1, 0, 0])
    assert level.up == pytest.approx([0, 0, 1])
    # The way down takes half the time: twice the tangential acceleration of the way up.
    assert level.tangential == pytest.approx(2 * np.sqrt(LEVEL * RADIUS) / 10.0)
    assert level.onset == pytest.approx(2.521152657241058 * LEVEL / RAMP, rel=1e-5)


def test_the_drive_turns_what_lies_beside_the_arm():
    inertia, from_axis = 0.076 + 6.5 * (RADIUS**2), 2 * np.sqrt(LEVEL / RADIUS) / RAMP
    torques = [gb.static(box().structure, arm("-y", "+z"), time=time).loads.beam_torque for time in (RAMP / 2, 50.0)]
    assert np.ravel(torques) == pytest.approx([inertia * from_axis, 0.0], abs=1e-9)


def test_a_hub_on_its_side_is_an_arm_that_points_outward():
    rate = gb.SmoothStep(5.0, 2.0)
    hub = gb.Hub(radius=RADIUS, rate=rate, gravity=(0, 0, -G))
    turned = gb.Hub(radius=RADIUS + 0.2, rate=rate, gravity=(0, 0, -G), turn=(0, 0, 0), control_point=(0.2, 0, 0))
    for time in (1.0, 3.0):
        assert turned.base(time).a_WO_B == pytest.approx(hub.base(time).a_WO_B)
    assert gb.simulate(box().structure, hub, duration=3.0, step=0.1).hub.level is None


def test_a_beam_on_an_arm_is_that_on_a_hub_which_points_inward():
    strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    structure = gb.assemble(beam, "FOAM", axial=1, y=2, z=2)
    motion = gb.plain_arm(radius=1.0, load="+x", up="-z", level=LEVEL, ramp=1.0, dwell=1.0)
    hub = gb.Hub(radius=1.0, rate=motion.rate, pointing="inward", setting_angle=np.pi, gravity=(0, 0, -G))
    on_arm, on_hub = (gb.simulate(structure, each, duration=3.0, estimate=False) for each in (motion, hub))
    assert on_arm.displacement == pytest.approx(on_hub.displacement, abs=1e-12)
    frequencies = [gb.campbell(structure, each, end=20.0).frequency[-1] for each in (motion, hub)]
    assert frequencies[0] == pytest.approx(frequencies[1])


def test_a_beam_across_an_arm_bends_as_under_the_level():
    strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    structure = gb.assemble(beam, "FOAM", axial=1, y=2, z=2)
    motion = gb.plain_arm(radius=1.0, control_point=(0.15, 0, 0), load="+z", up="+y", level=5 * G, ramp=1.0, dwell=1.0)
    load, stiffness = 5 * G * 2700 * 0.02 * 0.004, 70e9 * 0.02 * 0.004**3 / 12
    tip = gb.static(structure, motion, time=1.5).tip[2]
    assert tip == pytest.approx(-load * 0.3**4 / (8 * stiffness), rel=2e-3)


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"load": "+z", "up": "-z"}, "up.*along load"),
        ({"load": "z", "up": "+x"}, "load"),
        ({"load": (0, 0, 0), "up": "+x"}, "load.*zero"),
        ({"load": "+x", "up": "+z", "onset": 5.0}, "onset.*beside ramp"),
        ({"load": "+x", "up": "+z", "ramp": None}, "onset.*missing"),
        ({"load": "+x", "up": "+z", "level": -1.0}, "level"),
        ({"load": "+x", "up": "+z", "dwell": 0.0}, "dwell"),
    ],
)
def test_refusals_name_the_argument(changed, words):
    with pytest.raises((gb.InputError, TypeError), match=words):
        arm(**changed)


def test_a_turn_says_all_of_a_hubs_mounting():
    with pytest.raises(gb.InputError, match="setting_angle"):
        gb.Hub(radius=1.0, rate=1.0, turn=(0, 0, 1), setting_angle=1.0)
    with pytest.raises(gb.InputError, match="pointing"):
        gb.Hub(radius=1.0, rate=1.0, turn=(0, 0, 1), pointing="inward")


def test_a_beam_beside_the_axis_is_drawn_on_its_arm():
    beam = gb.Beam(0.3, gb.Section.rectangle(0.02, 0.004), gb.Material(2700, 70e9), damping_ratio=0.01)
    motion = gb.plain_arm(radius=1.2, control_point=(0.15, 0, 0), load="+z", up="+x", level=9 * G, ramp=1.0, dwell=0.5)
    run = gb.simulate(gb.assemble(beam, "FOAM"), motion, duration=2.5, step=0.02, estimate=False, name="test")
    assert run.environment == "arm" and "(arm, FOAM)" in repr(run)
    outline = run.body.outline
    assert outline.arm_root == pytest.approx([1.2, 0, -0.15], abs=1e-12) and outline.radius == pytest.approx(1.2)
