"""The stable one of several equilibria, and rotors beyond critical speeds, in the turning and the ground frame."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import gbeam as gb
from gbeam.results import json_of

GRAVITY = (0.0, 0.0, -9.81)
ROD = gb.RigidBody(1.0, (0.0, 0.03, 0.03), centre=(0.3, 0, 0), points={"tip": (0.6, 0, 0)})


def pendulum(angle: float, **more: Any) -> gb.System:
    """A rod on a hinge, at an angle downwards from level."""
    hinge = gb.Joint("revolute", "rod", axes=[(0, 1, 0)], initial=angle)
    return gb.System({"rod": ROD}, {"hinge": hinge}, gravity=GRAVITY, **more)


@pytest.mark.parametrize("angle", [0.0, 1.0, -1.2, np.pi])
def test_a_pendulum_hangs_wherever_it_is_drawn(angle: float) -> None:
    """Level there is no stiffness, and above level Newton's method goes up: ω² = m g c/(J + m c²)."""
    rest = gb.static(pendulum(angle))
    assert rest.coordinate("hinge.angle") == pytest.approx(np.pi / 2, rel=1e-12) and rest.stable
    (frequency,) = gb.modes(pendulum(angle)).frequency
    assert frequency == pytest.approx(0.788179, rel=1e-6)
    assert 2 * np.pi * frequency == pytest.approx(np.sqrt(9.81 * 0.3 / (0.03 + 0.3**2)), rel=1e-12)


def test_a_pendulum_that_is_drawn_upright_stays_there() -> None:
    """As a controller's plant: an equilibrium near the start is meant, stable or not."""
    rest = gb.static(pendulum(-np.pi / 2 + 0.05))
    assert rest.coordinate("hinge.angle") == pytest.approx(-np.pi / 2, rel=1e-12) and not rest.stable


def sdll403() -> gb.System:
    section, steel = gb.Section.rectangle(0.004, 0.01), gb.Material(2700.0, 70e9, 0.3)
    rod = gb.assemble(gb.Beam(0.6, section, steel, damping_ratio=0.0), "exact", axial=2, y=0, z=7)
    spin = gb.Joint("revolute", "shaft", axes=[(0, 0, 1)], rate=10.0)
    hinge = gb.Joint("revolute", "rod", on="shaft.pivot", axes=[(0, 1, 0)])
    shaft = gb.RigidBody(1.0, (1.0, 1.0, 1.0), points={"pivot": (0.1, 0, 0)})
    return gb.System({"shaft": shaft, "rod": rod}, {"spin": spin, "hinge": hinge}, gravity=GRAVITY)


def test_a_rod_on_a_spinning_shaft_is_followed_as_it_hangs() -> None:
    """SDLL403: 11.270° below level, and 1.7555, 100.26, 324.50 and 676.85 Hz, in all three answers."""
    frequencies = [1.7555, 100.26, 324.50, 676.85]
    rest, still = gb.static(sdll403()), np.sqrt(1.5 * 9.81 / 0.6) / (2 * np.pi)
    assert np.degrees(rest.coordinate("hinge.angle")) == pytest.approx(11.270, abs=0.01)
    assert gb.modes(sdll403(), errors=False).frequency[:4] == pytest.approx(frequencies, rel=1e-3)
    diagram = gb.campbell(sdll403(), count=4, modes=4, orders=())
    assert diagram.frequency[-1] == pytest.approx(frequencies, rel=1e-3) and diagram.critical is None
    assert diagram.frequency[0, 0] == pytest.approx(still, rel=1e-4)  # a rod that hangs, of 0.6 m
    assert diagram.frame == "turning" and not diagram.ground_frequency.size and not diagram.unstable


def jeffcott(stiff: float) -> gb.System:
    """A mass of 1 kg on springs of 100 and `stiff` N/m across the axis that turn with it."""
    spin = gb.Joint("revolute", "chuck", axes=[(1, 0, 0)], rate=30.0)
    springs = {"y": 100.0, "z": stiff}
    shaft = gb.Joint("fixed", "disc", on="chuck.root", stiffness=springs)
    bodies = {"chuck": gb.RigidBody(1.0, (1.0,) * 3), "disc": gb.RigidBody(1.0)}
    return gb.System(bodies, {"spin": spin, "shaft": shaft})


def test_a_round_rotor_has_its_frequency_in_the_ground_frame_at_every_speed() -> None:
    """|ω ∓ Ω| in the turning frame and ω in the ground's; the springs give way at ω, and hold again beyond."""
    diagram = gb.campbell(jeffcott(100.0), count=7, modes=2, orders=(3,))
    speed, far = diagram.speed, np.abs(diagram.speed - 10.0) > 1e-6
    expected = np.stack([np.abs(10.0 - speed), 10.0 + speed], axis=1)
    assert 2 * np.pi * np.sort(diagram.frequency, axis=1) == pytest.approx(expected, rel=1e-6)
    assert 2 * np.pi * diagram.ground_frequency[far] == pytest.approx(10.0, rel=1e-9)
    assert diagram.frame == "turning" and not diagram.unstable
    assert diagram.critical is not None and diagram.critical.value == pytest.approx(10.0, rel=1e-6)
    slower = int(np.nanargmin(diagram.frequency[1]))
    assert 2 * np.pi * diagram.frequency[-1] == pytest.approx([20.0, 40.0] if slower == 0 else [40.0, 20.0], rel=1e-9)
    # Each meets three times the speed but once: |10 − Ω| at 2.5 rad/s, 10 + Ω at 5.
    assert [each.speed for each in diagram.crossings] == pytest.approx([2.5, 5.0], rel=1e-6)
    modes = gb.modes(jeffcott(100.0))
    assert modes.frame == "turning" and 2 * np.pi * modes.ground_frequency == pytest.approx([10.0, 10.0], rel=1e-9)
    assert gb.linearize(jeffcott(100.0)).frame == "turning"
    assert gb.modes(gb.System({"disc": gb.RigidBody(1.0)}, {"shaft": SPRINGS})).frame == "ground"


SPRINGS = gb.Joint("fixed", "disc", stiffness={"y": 100.0, "z": 100.0})


def test_a_stretch_of_speed_that_is_unstable_ends() -> None:
    """Between the two frequencies of springs that differ a rotor grows: λ⁴ + (a + b + 4 Ω²) λ² + a b, a = ω₁² − Ω²."""
    diagram = gb.campbell(jeffcott(225.0), count=30, modes=2, orders=())
    (stretch,) = diagram.unstable
    assert (stretch.start, stretch.end) == pytest.approx((10.0, 15.0), rel=1e-4)
    square = diagram.speed**2
    a, b = 100.0 - square, 225.0 - square
    half = (a + b + 4 * square) / 2
    root = np.sqrt(half**2 - a * b)
    growth, slow, fast = np.sqrt(np.maximum(root - half, 0.0)), np.sqrt(np.maximum(half - root, 0.0)), half + root
    assert stretch.growth == pytest.approx(growth.max(), rel=1e-9)
    assert 2 * np.pi * diagram.frequency[:, 1] == pytest.approx(np.sqrt(fast), rel=1e-9)
    vibrates = slow > 1e-6  # neither at the ends of the stretch nor in it
    assert 2 * np.pi * diagram.frequency[vibrates, 0] == pytest.approx(slow[vibrates], rel=1e-6)
    assert np.isnan(diagram.frequency[~vibrates, 0]).all() and vibrates[-1]
    assert not diagram.ground_frequency.size  # each mode has two there
    facts = json_of(diagram)["unstable"]
    assert facts == [{"start": stretch.start, "end": stretch.end, "growth": stretch.growth}]


def test_an_overhung_disc_is_stable_beyond_its_critical_speed() -> None:
    """On a shaft without mass, in the ground frame: det(K − ω² diag(m, J) + ω Ω diag(0, J_p)) = 0, ω < 0 backward."""
    length, mass, across, polar, spin = 0.5, 5.0, 0.02, 0.04, 200 * np.pi
    k = 210e9 * np.pi * 0.02**4 / 64 / length**3 * np.array([[12.0, -6 * length], [-6 * length, 4 * length**2]])
    first, second = np.array([-mass, 0.0, k[0, 0]]), np.array([-across, spin * polar, k[1, 1]])
    whirl = np.roots(np.polysub(np.polymul(first, second), [k[0, 1] ** 2])).real / (2 * np.pi)
    assert np.sort(np.abs(whirl)) == pytest.approx([10.455, 17.199, 70.626, 263.882], rel=5e-5)
    squares = np.roots(np.polysub(np.polymul([-mass, k[0, 0]], [polar - across, k[1, 1]]), [k[0, 1] ** 2]))
    circle, steel = gb.Section.circle(0.02), gb.Material(1.0, 210e9, 0.3)
    disc = gb.PointMass(length, mass, inertia=(polar, across, across))
    beam = gb.Beam(length, circle, steel, damping_ratio=0.0, masses=[disc], rotary_inertia=False)
    turns = gb.Joint("revolute", "chuck", axes=[(1, 0, 0)], rate=gb.constant(spin))
    chuck, shaft = gb.RigidBody(1.0, (1.0,) * 3), gb.assemble(beam, "exact", axial=0, y=4, z=4)
    clamp = gb.Joint("fixed", "shaft", on="chuck.root")
    system = gb.System({"chuck": chuck, "shaft": shaft}, {"spin": turns, "clamp": clamp})
    modes = gb.modes(system, errors=False)
    assert modes.frame == "turning"
    turning = np.sort(np.abs(whirl - spin / (2 * np.pi)))
    assert turning == pytest.approx([82.8013, 110.4552, 163.8821, 170.6256], rel=5e-6)
    assert modes.frequency[:4] == pytest.approx(turning, rel=5e-5)
    assert np.sort(modes.ground_frequency[:4]) == pytest.approx(np.sort(np.abs(whirl)), rel=5e-5)
    diagram = gb.campbell(system, count=6, modes=4, orders=())
    assert diagram.critical is not None
    assert diagram.critical.value == pytest.approx(np.sqrt(squares[squares > 0].min()), rel=1e-4)
    assert diagram.critical.value == pytest.approx(865.2 * np.pi / 30, rel=1e-4)
    assert diagram.speed[-1] == pytest.approx(spin) and not diagram.unstable
    assert np.sort(diagram.ground_frequency[-1]) == pytest.approx(np.sort(np.abs(whirl)), rel=5e-5)


def test_a_beam_along_the_axis_of_its_base_vibrates_in_the_ground_frame_as_at_rest() -> None:
    """A round beam without rotary inertia knows nothing of its spin, in one [beam] and in a system."""
    beam = gb.Beam(0.5, gb.Section.circle(0.02), gb.Material(7800.0, 210e9), damping_ratio=0.0)
    shaft = gb.assemble(beam, "FOAM", axial=1, y=2, z=2)
    spun = gb.Flight(z=0.0, rates=gb.vector(gb.constant(50.0), gb.constant(0.0), gb.constant(0.0)))
    still, clamp = gb.modes(shaft, errors=False), {"clamp": gb.Joint("fixed", "shaft")}
    assert still.frame == "ground" and not still.ground_frequency.size
    for turning in (
        gb.modes(shaft, spun, errors=False),
        gb.modes(gb.System({"shaft": shaft}, clamp), spun, errors=False),
    ):
        assert turning.frame == "turning"
        assert np.sort(turning.ground_frequency) == pytest.approx(still.frequency, rel=1e-4)
        assert np.abs(turning.frequency - still.frequency)[:2] == pytest.approx(50 / (2 * np.pi), rel=1e-3)
    aside = gb.modes(shaft, gb.Hub(radius=0.2, rate=gb.constant(50.0)), errors=False)
    assert aside.frame == "turning" and np.isnan(aside.ground_frequency).all()
    free = gb.campbell(shaft, gb.Hub(radius=0.2, inertia=0.1), end=5.0, count=2, modes=2, orders=())
    assert free.frame == "turning" and not free.ground_frequency.size
