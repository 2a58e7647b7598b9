"""Errors of a closed loop by shapes that are left out: against a panel by its closed-form modes, and python-control."""

from __future__ import annotations

import math
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

import gbeam as gb
from examples import closing_the_loop
from gbeam.analysis import NOT_ALL
from gbeam.analysis.accuracy import beam_theory
from gbeam.mechanics import gains

SAMPLE = 0.02  # s, by which the torque is late, too
LENGTH, WIDTH, THICKNESS, DENSITY, MODULUS, RIM, HUB = 3.0, 0.5, 0.02, 2700.0, 70e9, 0.5, 50.0
NAMES = ["axis.angle", "axis.angle_rate"]
STEADY = np.array([[20.0, 60.0]])  # N m/rad, N m s/rad
MODES = 12


def satellite(shapes: int, factor: float, panel: gb.Structure | None = None) -> gb.System:
    """A hub with a panel that bends in its plane, in place of which another may be given, under PD by some gains."""
    beam = gb.Beam(LENGTH, gb.Section.rectangle(WIDTH, THICKNESS), gb.Material(DENSITY, MODULUS), damping_ratio=0.01)
    rim = gb.Place((RIM, 0.0, 0.0), (np.pi / 2, 0.0, 0.0))
    hub = gb.RigidBody(50.0, (HUB,) * 3, points={"rim": rim})
    axis = gb.Joint("revolute", "hub", axes=[(0, 0, 1)], initial=-0.5)
    joints = {"axis": axis, "clamp": gb.Joint("fixed", "panel", "hub.rim")}
    pd = gb.Feedback(gains((-factor * STEADY).tolist()), NAMES, ["axis.angle"], SAMPLE, SAMPLE)
    bodies: Any = {"hub": hub, "panel": gb.assemble(beam, "FOAM", z=shapes) if panel is None else panel}
    return gb.System(bodies, joints, controllers={"pd": pd})


class Truth(NamedTuple):
    """Growth of the closed loop, 1/s, and margins of the open one, rad and s."""

    growth: float
    gain: float
    phase: float
    delay: float
    modulus: float


@cache
def truth(factor: float) -> Truth:
    """The loop of the panel's twelve lowest clamped modes, in closed form, held from sample to sample."""
    x, weight = np.polynomial.legendre.leggauss(400)
    x, weight = LENGTH * (x + 1) / 2, weight * LENGTH / 2
    line, rigidity = DENSITY * WIDTH * THICKNESS, MODULUS * WIDTH * THICKNESS**3 / 12
    frequency, coupling = [], []
    for k in range(MODES):
        middle = (2 * k + 1) * np.pi / 2
        root = brentq(lambda b: np.cos(b) + 1 / np.cosh(b), middle - 0.4, middle + 0.4, xtol=1e-14)
        sigma = (np.cosh(root) + np.cos(root)) / (np.sinh(root) + np.sin(root))
        b = root * x / LENGTH
        shape = np.cosh(b) - np.cos(b) - sigma * (np.sinh(b) - np.sin(b))
        shape /= np.sqrt((weight * line) @ shape**2)
        frequency.append((root / LENGTH) ** 2 * np.sqrt(rigidity / line))
        coupling.append((weight * line) @ (shape * (RIM + x)))
    w = np.array(frequency)
    mass = np.eye(MODES + 1)
    mass[0, 0] = HUB + (weight * line) @ (RIM + x) ** 2
    mass[0, 1:] = mass[1:, 0] = coupling
    stiffness, damping = np.diag([0.0, *w**2]), np.diag([0.0, *(2 * 0.01 * w)])
    n = len(mass)
    a = np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(mass, stiffness), -np.linalg.solve(mass, damping)]])
    b = np.concatenate([np.zeros(n), np.linalg.solve(mass, np.eye(n)[:, 0])])[:, None]
    c = np.zeros((2, 2 * n))
    c[0, 0] = c[1, n] = 1.0
    over = expm(SAMPLE * np.block([[a, b], [np.zeros((1, 2 * n + 1))]]))
    # The torque that is asked for acts a sample later, and is a state until then.
    held = over.copy()
    held[-1] = 0.0
    waits, law = np.eye(2 * n + 1)[:, -1:], np.append(factor * STEADY @ c, 0.0)[None]
    growth = np.log(np.abs(np.linalg.eigvals(held - waits @ law)).max()) / SAMPLE
    return Truth(float(growth), *margins(held, waits, law))


def margins(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> tuple[float, float, float, float]:
    """Gain, phase, delay and least distance from -1 of a loop by its gain on a dense grid of frequencies."""
    poles = np.log(np.linalg.eigvals(a).astype(complex) + 1e-300) / SAMPLE
    near = [np.abs(pole.imag) + np.abs(pole.real) * np.linspace(-10, 10, 200) for pole in poles]
    w = np.unique(np.concatenate([np.geomspace(1e-2, np.pi / SAMPLE, 4000), *near]))
    w = w[(w > 1e-2) & (w < np.pi / SAMPLE)]
    z = np.exp(1j * w * SAMPLE)
    gain = np.squeeze(c @ np.linalg.solve(z[:, None, None] * np.eye(len(a)) - a, b[None]))

    def crossing(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        at = np.flatnonzero(values[:-1] * values[1:] < 0)
        share = values[at] / (values[at] - values[at + 1])
        return w[at] + share * (w[at + 1] - w[at]), gain[at] + share * (gain[at + 1] - gain[at])

    _, reals = crossing(gain.imag)
    ones, gains_of_one = crossing(np.log(np.abs(gain)))
    factors, angles = -1 / reals.real[reals.real < 0], np.angle(-gains_of_one)
    least = float(factors[factors > 1].min(initial=np.inf))
    delay = float(((angles % (2 * np.pi)) / ones).min(initial=np.inf))
    return least, float(np.abs(angles).min()), delay, float(np.abs(1 + gain).min())


KINDS = ("gain", "phase", "delay", "modulus")


@pytest.mark.parametrize(("shapes", "factor"), [(1, 1.0), (1, 8.0), (3, 8.0)])
def test_errors_of_margins_are_those_of_shapes_left_out(shapes: int, factor: float) -> None:
    """A margin that is stated is within its error of twelve modes; one that is more than half wrong is not stated."""
    system, exact = satellite(shapes, factor), truth(factor)
    (margin,) = gb.linearize(system, loop="closed").margins
    cut = gb.linearize(system, loop="pd: axis.angle")
    computed = dict(zip(KINDS, margins(cut.a, cut.b, cut.c), strict=True))
    for kind in KINDS:
        error, better = getattr(margin, f"{kind}_error"), getattr(exact, kind)
        if kind in margin.unknown:
            assert error > 0.5 and np.isnan(getattr(margin, kind))
            of_shapes = abs(better / computed[kind] - 1)
            assert of_shapes - 0.01 < error < of_shapes + 0.1  # by the theory of slender beams
        else:
            assert error < 0.5 and getattr(margin, kind) == pytest.approx(better, rel=1.5 * error + 1e-4)
    assert margin.unknown == ("" if shapes == 3 else "gain, modulus" if factor == 8.0 else "gain")
    assert np.isnan(margin.gain_frequency) == (shapes == 1)


def test_a_loop_that_more_shapes_make_unstable_has_no_margins() -> None:
    """Gains at which one shape decays with 0.43 1/s, and the panel grows with 0.58."""
    growth = truth(14.0).growth
    one, three = (gb.linearize(satellite(shapes, 14.0), loop="closed") for shapes in (1, 3))
    assert one.eigenvalue[0].real < -0.4
    (warning,) = one.warnings
    assert warning.startswith("the closed loop is not stable with more shapes: it grows with ")
    assert float(warning.split("with ")[2].split()[0]) == pytest.approx(growth, rel=2e-3)
    (margin,) = one.margins
    assert margin.unknown == "gain, gain_low, phase, delay, modulus" and np.isinf(margin.gain_error)
    assert "gain margin not known, phase margin not known" in repr(one)
    assert not three.margins
    assert three.warnings == ("the closed loop is not stable: it grows with 0.5807 1/s, and has no margins",)
    cut = gb.linearize(satellite(1, 14.0), loop="pd: axis.angle")
    assert cut.warnings == one.warnings and np.isnan(cut.margins[0].gain)


def test_a_run_says_that_its_loop_is_unstable_with_more_shapes() -> None:
    for factor, unstable in ((8.0, False), (14.0, True)):
        run = gb.simulate(satellite(1, factor), duration=0.2, step=0.02)
        words = [warning for warning in run.warnings if warning.startswith("the closed loop is not stable with more")]
        assert bool(words) == unstable


def test_an_observer_keeps_its_order_around_the_richer_panel() -> None:
    """LQG of five states, on one shape and on six: margins of the latter, and slowest poles, within stated errors."""
    law = closing_the_loop.lqg()
    one, three, six = (
        gb.linearize(closing_the_loop.satellite("exact", law, axial=1, z=z), loop="closed") for z in (1, 3, 6)
    )
    assert one.margins[0].unknown == "gain, delay, modulus" and six.margins[0].unknown == ""
    (gain,) = (
        each for each in one.warnings if each.startswith("margins of lqg: axis.angle are not known: gain 4.157, ")
    )
    assert float(gain.split("gain 4.157, ")[1].split()[0]) == pytest.approx(six.margins[0].gain, rel=5e-3)
    assert three.margins[0].gain == pytest.approx(six.margins[0].gain, rel=1.5 * three.margins[0].gain_error)
    pole, better = three.eigenvalue[0], six.eigenvalue[0]
    assert pole.real == pytest.approx(better.real, rel=1.5 * three.decay_error[0])
    assert pole.imag == pytest.approx(better.imag, rel=1.5 * three.oscillation_error[0])
    assert 0.01 < three.decay_error[0] < 0.1 and three.oscillation_error[0] < 0.05


def test_margins_are_exact_of_rigid_bodies_and_not_judged_of_particles() -> None:
    whole = satellite(1, 8.0).flexible["panel"]
    first, second = whole.places.first, whole.places.second
    stiffness = whole.coefficients.stiffness
    panel = gb.Structure.of_particles(whole.mass, whole.places.r0, first, stiffness, second=second, damping_ratio=0.01)
    closed = gb.linearize(satellite(1, 8.0, panel), loop="closed")
    assert closed.margins[0].gain == pytest.approx(6.528, rel=1e-3) and np.isnan(closed.margins[0].gain_error)
    assert np.isnan(closed.decay_error).all() and closed.error_note == NOT_ALL.format("panel")
    rigid = gb.System(
        {"hub": gb.RigidBody(1.0, (60.0,) * 3)},
        {"axis": gb.Joint("revolute", "hub", axes=[(0, 0, 1)])},
        controllers={"pd": gb.Feedback(gains([[-20.0, -60.0]]), NAMES, ["axis.angle"], SAMPLE, SAMPLE)},
    )
    exact = gb.linearize(rigid, loop="closed")
    assert exact.margins[0].gain_error == 0 and not exact.decay_error.any() and not exact.warnings


def test_of_plate_action_and_none_the_one_that_counts_is_run(monkeypatch: pytest.MonkeyPatch) -> None:
    """Strips of a panel are stiffer by 2 % as plates, and by 6e-5 softer in shear."""
    spoken, panel = list[str](), satellite(2, 1.0)

    def heard(words: str, done: float | None = None) -> None:
        spoken.extend([words] if done == 0 else [])

    def stated() -> tuple[int, gb.Response]:
        spoken.clear()
        response = gb.simulate(panel, duration=1.0, step=0.01, progress=heard)
        return len(spoken), response

    fewer, quick = stated()
    monkeypatch.setattr(beam_theory, "LESSER", 0.0)
    more, both = stated()
    assert fewer == more - 1
    for of in ("displacement", "place", "loads", "stress"):
        one, two = getattr(quick.errors, of), getattr(both.errors, of)
        assert one.total == pytest.approx(two.total, rel=1e-12), of
        assert math.isnan(one.peak) or two.peak / 2 < one.peak <= two.peak
    assert quick.errors.displacement.beam_theory > 0.01
