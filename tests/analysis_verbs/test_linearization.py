"""The linearisation is the residual's derivative, whatever the model; its exports and reductions keep the answer."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.io

import gbeam as gb
from gbeam.analysis import Drive, outputs_of, placed, settled, subject_of
from gbeam.report import text
from gbeam.results import Base, Signal, json_of

from .beams import ALUMINIUM, BOX, FREE_2009, HUB_2009, beam_2009, structure_2009

SOFT = structure_2009("SFOAM", 0, 3, mass=0.1, damping=0.01)
BASE = Base(*(np.array(v) for v in ([-2.0, 0.5, 0.3], [0.1, 0.2, 1.5], [0.3, -0.1, 0.2])))


def transfer(system, frequency):
    """Matrix of gains at a circular frequency."""
    return system.c @ np.linalg.solve(1j * frequency * np.eye(len(system.a)) - system.a, system.b) + system.d


@pytest.mark.parametrize("kind", ["TLAM", "FOAM", "CFOAM", "fourth-order", "exact"])
def test_matrices_are_finite_differences(kind):
    structure = gb.assemble(beam_2009(0.1), gb.Model(kind, 1, 2, 1))
    q = np.random.default_rng(3).normal(size=4) * [1e-4, 0.1, 0.02, 0.1]
    subject = subject_of(structure, None)
    at = placed(subject.system, Drive(base=BASE), q, None)
    point, linear, outputs = at.point, at.linear, outputs_of(structure, at, ())
    u = outputs.holding_inputs
    forces = outputs.matrices(point)[2]
    state = [np.asarray(x) for x in (point.y, point.yd, point.ydd, u)]
    for which, matrix in ((0, linear.stiffness), (1, linear.velocity), (2, linear.mass), (3, -forces)):
        for k in range(matrix.shape[1]):
            h = 1e-4 if which else 1e-6
            ends = []
            for sign in (1, -1):
                moved = [x.copy() for x in state]
                moved[which][k] += sign * h
                ends.append(point.tree(*moved[:3], outputs.inputs(moved[3])))
            column = (ends[0] - ends[1]) / (2 * h)
            assert column == pytest.approx(matrix[:, k], rel=1e-6, abs=1e-6 * np.abs(matrix).max())


def test_a_free_hub_keeps_its_momentum():
    structure = structure_2009("FOAM", 1, 3)
    subject = subject_of(structure, FREE_2009)
    state = settled(subject.system, Drive(coordinate="hinge.angle", rate=1.3))
    linear = state.linear
    assert float(outputs_of(structure, state, ()).holding_inputs[0]) == pytest.approx(0, abs=1e-9)
    assert np.abs(linear.stiffness[:, 0]).max() == 0


def test_state_space_of_a_free_hub():
    system = gb.linearize(SOFT, FREE_2009, gauges=[gb.Gauge(0.0, y=0.01)])
    assert [each.name for each in system.inputs] == ["torque"]
    assert system.states[0] == Signal("hub_angle", "rad")
    # A slow torque turns hub and beam as one rigid body.
    angle = system.select(outputs=("hub_angle",))
    rho, length, radius = 2766.7 * 7.2968e-5, 8.0, 0.5
    inertia = 200 + rho * ((radius + length) ** 3 - radius**3) / 3 + 0.1 * (radius + length) ** 2
    assert abs(transfer(angle, 1e-3)[0, 0]) == pytest.approx(1 / (inertia * 1e-6), rel=1e-5)
    # The root moment turns the beam: what the torque leaves after the hub, of which the root force takes its lever.
    strain, moment = (abs(transfer(system.select(outputs=(n,)), 0.5)[0, 0]) for n in ("strain_1", "root_moment_z"))
    assert strain == pytest.approx(moment * 0.01 / (6.8952e10 * 8.2189e-9), rel=1e-9)
    with pytest.raises(gb.InputError, match="choose from"):
        system.select(outputs=("nose",))


def test_springs_at_the_root_are_states_with_their_own_units():
    beam = gb.Beam(8.0, BOX, ALUMINIUM, damping_ratio=0.0, root=gb.Root(rotation_y=500.0, translation_z=2e4))
    system = gb.linearize(gb.assemble(beam, gb.Model("FOAM", 0, 0, 1)), HUB_2009, rate=1.0)
    assert [(each.name, each.unit) for each in system.states[:6]] == [
        ("q_z_1", "m"),
        ("q_root_translation_z", "m"),
        ("q_root_rotation_y", "rad"),
        ("rate_q_z_1", "m/s"),
        ("rate_q_root_translation_z", "m/s"),
        ("rate_q_root_rotation_y", "rad/s"),
    ]


def test_state_space_of_a_turning_base_has_its_rate():
    system = gb.linearize(structure_2009("FOAM", 1, 3, mass=0.1, damping=0.01), HUB_2009, rate=2.0)
    # The rate about x moves nothing in the plane, but the tip's accelerometer feels it.
    assert [each.name for each in system.states[-2:]] == ["base_rate_x", "base_rate_z"]
    assert system.a.shape == (10, 10) and system.b.shape == (10, 6)
    faster = gb.linearize(structure_2009("FOAM", 1, 3, mass=0.1, damping=0.01), HUB_2009, rate=2.0001)
    stretch = (faster.output - system.output)[0] / 1e-4
    n = 8
    slope = system.c[0, :n] @ np.linalg.solve(-system.a[:n, :n], system.a[:n, -1]) + system.c[0, -1]
    # The root's own acceleration −rΩ² changes as well: an input.
    slope += (system.c[:1, :n] @ np.linalg.solve(-system.a[:n, :n], system.b[:n]) + system.d[:1])[0, 0] * -2 * 0.5 * 2.0
    assert stretch == pytest.approx(slope, rel=1e-3)


@pytest.mark.parametrize(("gravity", "word"), [(True, "specific_force"), (False, "acceleration")])
def test_a_machine_is_frozen_and_names_what_moves_its_base(gravity, word):
    machine = gb.Centrifuge(gb.Flight(z=gb.constant(20.0)), arm=3.3, control_point=0.1, gravity=gravity).over(0.0, 1.0)
    system = gb.linearize(SOFT, machine, 0.5)
    assert [each.name for each in system.inputs[:3]] == [f"base_{word}_{i}" for i in "xyz"]
    assert system.input[:3] == pytest.approx(machine.base(0.5).a_WO_B)
    assert system.output[:3] == pytest.approx(gb.static(SOFT, machine, 0.5).tip, abs=1e-15)


def test_reductions():
    system = gb.linearize(SOFT, FREE_2009).select(outputs=("tip_y", "hub_angle"))
    small = gb.modal_truncation(system, 1)
    assert len(small.a) == 4  # turning, and one vibration
    assert transfer(small, 1.0) == pytest.approx(transfer(system, 1.0), rel=2e-3)
    assert gb.modal_truncation(system, 3) is system
    with pytest.raises(gb.InputError, match="1 to 3"):
        gb.modal_truncation(system, 4)
    balanced, hankel = gb.balanced_truncation(system, 4)
    assert len(balanced.a) == 6 and (np.diff(hankel) <= 1e-12).all()
    for frequency in (0.5, 2.0, 3.5):
        error = np.linalg.norm(transfer(balanced, frequency) - transfer(system, frequency), 2)
        assert error <= 2 * hankel[4:].sum() + 1e-9
    with pytest.raises(gb.InputError, match="damping_ratio"):
        gb.balanced_truncation(gb.linearize(structure_2009("SFOAM", 0, 3), FREE_2009), 2)


def test_truncations_state_what_they_leave_out():
    """Two undamped oscillators, by hand; then that no gain anywhere is wrong by more than is stated."""
    rates, gains = np.array([2.0, 10.0]), np.array([1.0, 3.0])
    signals = [tuple(Signal(f"{name}_{k}", unit) for k in range(n)) for name, unit, n in (("x", "1", 4), ("u", "N", 1))]
    system = gb.StateSpace(
        a=np.block([[np.zeros((2, 2)), np.eye(2)], [-np.diag(rates**2), np.zeros((2, 2))]]),
        b=np.array([[0.0, 0.0, 1.0, 1.0]]).T,
        c=np.array([[*gains, 0.0, 0.0]]),
        d=np.zeros((1, 1)),
        states=signals[0],
        inputs=signals[1],
        outputs=(Signal("y", "m"),),
        state=np.zeros(4),
        input=np.zeros(1),
        output=np.zeros(1),
        frequency=rates / (2 * np.pi),
    )
    left_out = gb.modal_truncation(system, 1).truncation
    assert (left_out.method, left_out.states) == ("modal", 2) and left_out.end == pytest.approx(2.0 / (2 * np.pi))
    assert left_out.error[0, 0] == pytest.approx(3.0 / (100.0 - 4.0) - 3.0 / 100.0, rel=1e-9)
    damped = gb.linearize(SOFT, FREE_2009).select(outputs=("tip_y", "root_moment_z"))
    for small in (gb.modal_truncation(damped, 2), gb.balanced_truncation(damped, 2)[0]):
        left_out = small.truncation
        for rate in np.geomspace(0.1, 2 * np.pi * left_out.end, 300):
            apart = transfer(small, rate) - transfer(damped, rate)
            assert (np.abs(apart) <= left_out.error * 1.01 + 1e-12).all()
            assert not np.linalg.norm(apart, 2) > left_out.bound
        assert 0 < left_out.share.max() < 1
        kept = small.select(outputs=("root_moment_z",))
        assert kept.truncation.share == pytest.approx(left_out.share[1:])
        assert f"{left_out.method} truncation" in repr(small) and f"{left_out.method} truncation" in text(small)
        assert json_of(small)["truncation"]["states_left_out"] == left_out.states
        held = small.to_xarray()
        assert held["truncation_error"].values == pytest.approx(left_out.error)
    assert left_out.bound == 2 * left_out.hankel[2:].sum()
    assert damped.truncation is None and json_of(damped)["truncation"] is None


def test_exports(tmp_path):
    control = pytest.importorskip("control")
    system = gb.linearize(SOFT, FREE_2009)
    theirs = system.to_control()
    assert isinstance(theirs, control.StateSpace) and theirs.input_labels == ["torque"]
    assert np.asarray(theirs(2.0j)) == pytest.approx(transfer(system, 2.0))
    assert pytest.approx(system.a) == system.to_scipy().A
    system.to_mat(tmp_path / "x.mat")
    read = scipy.io.loadmat(tmp_path / "x.mat", squeeze_me=True)
    assert read["A"] == pytest.approx(system.a) and read["output_name"][1] == "tip_y"


def test_nonlinear_system_has_the_same_linearisation():
    pytest.importorskip("control")
    system, theirs = gb.linearize(SOFT, FREE_2009), gb.nonlinear_system(SOFT, FREE_2009)
    linear = theirs.linearize(np.zeros(8), np.zeros(1), eps=1e-8)
    assert pytest.approx(system.a, rel=1e-5, abs=1e-5) == linear.A
    assert pytest.approx(system.c, rel=1e-4, abs=1e-3) == linear.C


def test_a_gauge_off_the_beam():
    with pytest.raises(gb.InputError, match="off the beam"):
        gb.linearize(SOFT, gb.Hub(radius=0.5, rate=gb.constant(1.0)), gauges=[gb.Gauge(9.0)])


def test_a_hub_on_a_spring_rests_where_it_balances_the_torque():
    hub = gb.Hub(radius=0.5, inertia=200.0, torque=gb.constant(30.0), stiffness=600.0, damping=5.0)
    structure = structure_2009("FOAM", 1, 3)
    subject = subject_of(structure, hub)
    point = settled(subject.system, subject.drive(2.0)).point
    assert float(point.y[0]) == pytest.approx(0.05) and float(point.yd[0]) == 0
    vibration = gb.modes(structure, hub, 2.0)
    assert vibration.rigid == 0 and vibration.damping_ratio[0] > 0 and vibration.stable


def test_a_state_space_model_states_the_errors_of_its_frequencies(tmp_path):
    """Errors of a beam with a tip mass and five clamped-free shapes, of which the fifth is 1.8 % too high."""
    beam = beam_2009(0.5)
    few, many = (gb.assemble(beam, gb.Model("FOAM", 1, n, 0, how)) for n, how in ((5, "clamped-free"), (9, "adapted")))
    plant = gb.linearize(few, gb.Hub(radius=0.5), rate=0.0)
    truth = gb.modes(many, gb.Hub(radius=0.5)).frequency[:5]
    np.testing.assert_allclose(plant.frequency, gb.modes(few).frequency, rtol=1e-9)
    np.testing.assert_allclose(plant.errors.slender[:5], plant.frequency[:5] / truth - 1, rtol=0.05, atol=1e-6)
    assert plant.accurate_to == plant.frequency[3] and "up to" in repr(plant) and not plant.warnings
    plant.to_mat(tmp_path / "plant.mat")
    np.testing.assert_allclose(scipy.io.loadmat(tmp_path / "plant.mat")["frequency_error"][:, 0], plant.errors.total)
    small = gb.modal_truncation(plant, 2)
    np.testing.assert_array_equal(small.frequency, plant.frequency[:2])
    assert small.accurate_to == small.frequency[1] and len(small.errors.total) == 2
    textbook = gb.linearize(gb.assemble(beam, gb.Model("TLAM", 1, 3, 0)), gb.Hub(radius=0.5), rate=1.0)
    assert textbook.accurate_to == 0 and any("the model" in each for each in textbook.warnings)
