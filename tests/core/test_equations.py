"""The equations against mechanics that knows nothing of them: inertial frames, power, momentum.

Invariants as in 2009, corrected: a model derived from an energy conserves its own T + U and p_θ on a free hub; the
printed SFOAM, which drops Q_θ from the hub's row but not from the beam's, conserves neither.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.integrate._ivp import dop853_coefficients as dop853

from gbeam import Structure
from gbeam.integrate import compiled_accelerations as accelerations
from gbeam.mechanics import Bodies, Particles, inertia_of
from gbeam.results import Base
from validation.residuals import Hinged, hinged

from ..differences import along, jacobian, rate
from ..lagrange import energy_of, hub_kinetic, on_prescribed_base
from ..residuals import HUB, on_base, on_hub
from ..specimens import BODY, COMPLETE, HUB_INERTIA, HUB_RADIUS, hub_beam, laden, states

IDENTITY = 1e-10  # relative to the largest term
DRIFT = 1e-9  # of energy and momentum along a trajectory
STEPS = 100  # of the integration, in a tenth of a trajectory: its own error is 1e-10 and less
LEAK = 1e-5  # what the printed SFOAM loses at least

# The Lagrangian models on a hub, which turns about z; FOAM without axial coordinates is SFOAM's Lagrangian form.
PLANAR = {"TLAM": ("TLAM", 1), "FOAM": ("FOAM", 1), "FOAM axial=0": ("FOAM", 0), "CFOAM": ("CFOAM", 1)}
PLANAR["exact"] = ("exact", 1)
PRINTED = ("SFOAM", 0)  # drops Q_θ: not Lagrangian
OUTWARD = (HUB_RADIUS, HUB_INERTIA, np.eye(3))


# --- on a prescribed base


def skew(w: np.ndarray) -> np.ndarray:
    x, y, z = w
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def virtual_work_of_inertia(
    structure: Structure, q: np.ndarray, qd: np.ndarray, qdd: np.ndarray, base: Base
) -> np.ndarray:
    """Σ m_k a_k · ∂r_k/∂q + ∂U/∂q, the particles' accelerations by differentiating their paths in the world twice."""
    energy, w = energy_of(structure), base.w_WB_B

    def path(t: Any) -> np.ndarray:
        # To second order in t, which is all that accelerations at t = 0 need.
        attitude = np.eye(3) + skew(w) * t + (skew(w) @ skew(w) + skew(base.alpha_WB_B)) * t**2 / 2
        return base.a_WO_B * t**2 / 2 + energy.particles(q + qd * t + qdd * t**2 / 2) @ attitude.T

    acceleration = rate(lambda t: along(path, t, 1.0))
    inertia = np.einsum("k,ki,kij->j", energy.mass, acceleration, jacobian(energy.particles, q))
    return inertia + jacobian(energy.potential, q)


def spatial_state(name: str, seed: int, scale: float = 0.5) -> tuple[Any, ...]:
    """q, q̇ and q̈ of the laden beam, and a base."""
    a, w, al = states(3, 3, scale, seed)
    return *states(laden(name).size, 3, scale, seed + 10), Base(a, w, al)


@pytest.mark.parametrize("name", [*COMPLETE, "thick"])
@pytest.mark.parametrize("seed", range(2))
def test_complete_models_are_dalemberts_principle_in_the_world(name: str, seed: int) -> None:
    structure, (q, qd, qdd, base) = laden(name), spatial_state(name, seed)
    got = on_base(structure, q, qd, qdd, base) - structure.coefficients.damping @ qd
    wanted = virtual_work_of_inertia(structure, q, qd, qdd, base)
    np.testing.assert_allclose(got, wanted, atol=IDENTITY * np.abs(wanted).max())


@pytest.mark.parametrize("name", ["exact", "thick"])
def test_sections_and_bodies_have_the_inertia_of_their_particles(name: str) -> None:
    """Sections by their mass and moments of inertia, bodies off the axis as particles."""
    inertia, (a, w, alpha) = laden(name).inertia, states(3, 3, 2.0, seed=8)
    assert inertia is not None and isinstance(inertia.reduced, Bodies)
    motion = *states(laden(name).size, 3, 0.3, seed=9), a, w, alpha
    ours, theirs = inertia.forces(*motion), replace(inertia, reduced=Particles(inertia.field, inertia.mass))
    for each, other in zip(ours, theirs.forces(*motion), strict=True):
        np.testing.assert_allclose(each, other, rtol=0, atol=1e-11 * np.abs(other).max())


def test_coefficients_are_the_whole_truth_for_a_truncated_energy() -> None:
    structure, (q, qd, qdd, base) = laden("FOAM"), spatial_state("FOAM", 3, 1.0)
    c = structure.coefficients
    velocity, stiffness, load = c.evaluate(base.a_WO_B, base.w_WB_B, base.alpha_WB_B)
    linear = c.mass @ qdd + velocity @ qd + stiffness @ q - load
    whole = on_prescribed_base(energy_of(structure), c.damping, q, qd, qdd, base.a_WO_B, base.w_WB_B, base.alpha_WB_B)
    np.testing.assert_allclose(linear, whole, atol=IDENTITY * np.abs(stiffness @ q).max())


@pytest.mark.parametrize("name", COMPLETE)
def test_coefficients_of_a_complete_model_are_its_linearisation(name: str) -> None:
    """Their rest is of second order: a quarter at half the state."""
    structure, (q, qd, qdd, base) = laden(name), spatial_state(name, 5)
    c = structure.coefficients
    velocity, stiffness, load = c.evaluate(base.a_WO_B, base.w_WB_B, base.alpha_WB_B)

    def left(s: float) -> np.ndarray:
        linear = c.mass @ (s * qdd) + velocity @ (s * qd) + stiffness @ (s * q) - load
        return on_base(structure, s * q, s * qd, s * qdd, base) - linear

    sizes = [np.linalg.norm(left(s)) for s in (2e-3, 1e-3)]
    assert sizes[0] > 1e-6
    assert sizes[0] / sizes[1] == pytest.approx(4, rel=0.05)


def test_symmetries_of_the_coefficients() -> None:
    """M and K at rest symmetric, G skew; skew part of K(α) is ½ G with ω replaced by α: 2020 (16), (20)–(22)."""
    c = laden("FOAM").coefficients
    np.testing.assert_allclose(c.mass, c.mass.T, atol=1e-12)
    np.testing.assert_allclose(c.stiffness, c.stiffness.T, atol=1e-6)
    np.testing.assert_allclose(c.gyroscopic, -np.swapaxes(c.gyroscopic, 1, 2), atol=1e-12)
    np.testing.assert_allclose(c.k_al - np.swapaxes(c.k_al, 1, 2), c.gyroscopic, atol=1e-12)
    for symmetric in (c.k_ww, c.k_a):
        np.testing.assert_allclose(symmetric, np.swapaxes(symmetric, -1, -2), atol=1e-11)
    np.testing.assert_allclose(c.k_ww, np.swapaxes(c.k_ww, 0, 1), atol=1e-12)


def test_only_the_roots_acceleration_matters_not_the_place_of_the_axis() -> None:
    """A hub of radius r at the rate Ω is a base with a_O = (−rΩ², r dΩ/dt, 0): two forms of one residual."""
    structure, (q, qd, qdd) = laden("CFOAM"), states(7, 3, 0.3, seed=4)
    turn, spin = 1.3, 0.7
    root, o = np.array([-HUB_RADIUS * turn**2, HUB_RADIUS * spin, 0]), np.zeros(2)
    arguments = on_base(structure, q, qd, qdd, Base(root, np.append(o, turn), np.append(o, spin)))
    y, yd, ydd = (np.append(a, b) for a, b in ((0.4, q), (turn, qd), (spin, qdd)))
    on_the_hub, _ = on_hub(structure, y, yd, ydd, 5.0)
    np.testing.assert_allclose(on_the_hub[1:], arguments, atol=IDENTITY * np.abs(arguments).max())


def test_damping_is_a_force_against_the_rates() -> None:
    (q, qd, qdd), still = states(4, 3, 0.3, seed=5), Base(*np.zeros((3, 3)))
    structure = hub_beam("FOAM", damping_ratio=0.02)
    undamped = replace(structure, coefficients=structure.coefficients.damped(np.zeros((4, 4))))
    force = on_base(structure, q, qd, qdd, still) - on_base(undamped, q, qd, qdd, still)
    np.testing.assert_allclose(force, structure.coefficients.damping @ qd, atol=1e-9)
    assert qd @ force > 0


# --- on a free hub


class Turning:
    """A planar model on the hub of 2009: y = (θ, q), its accelerations, and the energy and momentum that T gives it."""

    def __init__(self, kind: str, axial: int, damping_ratio: float) -> None:
        self.structure = hub_beam(kind, axial, damping_ratio=damping_ratio)
        self.energy = energy_of(self.structure)
        self.equations = hinged(self.structure, HUB)

    def residual(self, y: np.ndarray, yd: np.ndarray, ydd: np.ndarray, torque: float) -> np.ndarray:
        return self.equations(y, yd, ydd, (np.asarray(torque), None))

    def acceleration(self, y: np.ndarray, yd: np.ndarray, torque: float) -> np.ndarray:
        if not self.structure.linear:
            return np.asarray(accelerations(self.equations, y[None], yd[None], (np.array([torque]), None)))[0]
        # The residual is linear in ÿ.
        rest = self.residual(y, yd, 0 * y, torque)
        mass = np.stack([self.residual(y, yd, each, torque) - rest for each in np.eye(len(y))], axis=1)
        return np.linalg.solve(mass, -rest)

    def total_energy(self, y: np.ndarray, yd: np.ndarray) -> float:
        return float(hub_kinetic(self.energy, *OUTWARD, y, yd) + self.energy.potential(y[1:]))

    def momentum(self, y: np.ndarray, yd: np.ndarray) -> float:
        """∂T/∂θ̇: T is of second degree in the rates."""
        unit = np.eye(len(y))[0]
        ends = (hub_kinetic(self.energy, *OUTWARD, y, yd + sign * unit) for sign in (1, -1))
        return float(next(ends) - next(ends)) / 2


@cache
def turning(name: str, damping_ratio: float = 0.0) -> Turning:
    return Turning(*(PRINTED if name == "SFOAM" else PLANAR[name]), damping_ratio)


def random_state(structure: Any, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Hub at about 1 rad/s, tip moving by decimetres; the stiff axial coordinate by a hundredth of a millimetre."""
    axial = structure.counts[0]
    bending = 0.2 if structure.kind == "exact" else 0.05  # rad or m
    scale = np.concatenate([[1.0], np.full(axial, 1e-5), np.full(structure.size - axial, bending)])
    y, yd = states(structure.size + 1, 2, 1.0, seed) * scale
    yd[0] = 1.0 + 0.2 * yd[0]
    return y, yd


@pytest.mark.parametrize("name", PLANAR)
@pytest.mark.parametrize("damping_ratio", [0.0, 0.02])
def test_power_balance(name: str, damping_ratio: float) -> None:
    """d(T + U)/dt = τθ̇ − q̇ᵀCq̇ and dp_θ/dt = τ at any state, whatever the accelerations' size."""
    on, torque = turning(name, damping_ratio), 30.0
    for seed in range(3):
        y, yd = random_state(on.structure, seed)
        ydd = on.acceleration(y, yd, torque)

        def moved(t: float, y: Any = y, yd: Any = yd, ydd: Any = ydd) -> tuple[Any, Any]:
            return y + yd * t + ydd * t**2 / 2, yd + ydd * t

        power, momentum_rate = (
            float(rate(lambda t, f=f: f(*moved(t)), step=1e-3)) for f in (on.total_energy, on.momentum)
        )
        wanted = torque * yd[0] - yd[1:] @ on.structure.coefficients.damping @ yd[1:]
        scale = np.abs(ydd).max() * np.abs(yd).max() + np.abs(wanted)
        np.testing.assert_allclose(power, wanted, atol=IDENTITY * scale)
        np.testing.assert_allclose(momentum_rate, torque, rtol=1e-8)


@jax.jit
def trajectory(equations: Hinged, start: Any, step: Any, amplitude: Any) -> Any:
    """States (y, ẏ) at ten times and STEPS between them, by Dormand and Prince's method of eighth order.

    It is explicit and damps nothing. The torque is one sine over the ten times.
    """
    n, (a, b, c) = start.shape[0] // 2, (jnp.asarray(x) for x in (dop853.A, dop853.B, dop853.C))
    stages = len(dop853.B)

    def rates(t: Any, s: Any) -> Any:
        torque = amplitude * jnp.sin(2 * jnp.pi * t / (10 * STEPS * step))
        answer = accelerations(equations, s[None, :n], s[None, n:], (jnp.atleast_1d(torque), None))[0]
        return jnp.concatenate([s[n:], answer])

    def one(s: Any, k: Any) -> Any:
        def stage(i: Any, rate: Any) -> Any:
            return rate.at[i].set(rates((k + c[i]) * step, s + step * (a[i, :stages] @ rate)))

        after = s + step * (b @ jax.lax.fori_loop(0, stages, stage, jnp.zeros((stages, 2 * n))))
        return after, after

    _, states = jax.lax.scan(one, start, jnp.arange(10 * STEPS))
    return states[STEPS - 1 :: STEPS]


def drive(
    on: Turning, start: tuple[np.ndarray, np.ndarray], duration: float, amplitude: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times, energy and momentum as a torque A sin 2πt/T drives the hub over the duration T."""
    first, n = np.concatenate(start), len(start[0])
    later = np.asarray(trajectory(on.equations, first, duration / (10 * STEPS), amplitude))
    along_it = np.concatenate([first[None], later])
    energy, momentum = (np.array([f(s[:n], s[n:]) for s in along_it]) for f in (on.total_energy, on.momentum))
    return np.linspace(0, duration, 11), energy, momentum


@pytest.mark.parametrize("name", PLANAR)
def test_free_hub_conserves_energy_and_momentum(name: str) -> None:
    on = turning(name)
    start = random_state(on.structure, seed=7)
    _, energy, momentum = drive(on, start, 1.0, 0.0)
    assert float(on.energy.potential(start[0][1:])) > 0.1  # J: the beam is really bent
    assert np.abs(energy - energy[0]).max() < DRIFT * energy[0]
    assert np.abs(momentum - momentum[0]).max() < DRIFT * momentum[0]


def test_printed_sfoam_conserves_nothing() -> None:
    """2009 "SFOAM … does not include Q_θ" against (40) "from FOAM by deleting q1": only the second is Lagrangian."""
    on = turning("SFOAM")
    _, energy, momentum = drive(on, random_state(on.structure, seed=7), 1.0, 0.0)
    assert np.abs(energy - energy[0]).max() > LEAK * energy[0]
    assert np.abs(momentum - momentum[0]).max() > LEAK * momentum[0]


def test_printed_sfoam_lacks_the_hub_force_only() -> None:
    """2009 (32): the rest of the hub's row, and the beam's rows, are those of FOAM without axial coordinates."""
    printed, lagrangian = turning("SFOAM"), turning("FOAM axial=0")
    y, yd = random_state(printed.structure, seed=8)
    ydd = states(4, 1, 1.0, seed=9)[0]
    dropped, kept = (on.residual(y, yd, ydd, 3.0) for on in (printed, lagrangian))
    np.testing.assert_allclose(kept[1:], dropped[1:], atol=1e-10)
    assert abs(kept[0] - dropped[0]) > 1e-3
    at_rest = [on.residual(y, 0 * yd, ydd, 3.0) for on in (printed, lagrangian)]
    np.testing.assert_allclose(at_rest[0], at_rest[1], atol=1e-10)


@pytest.mark.parametrize("name", ["FOAM", "exact"])
def test_driven_hub_gains_the_momentum_of_the_torque(name: str) -> None:
    """θ is cyclic: p_θ(t) = ∫τ dt, zero after one period of 2009 (44)."""
    on, period = turning(name), 1.0
    none = np.zeros(on.structure.size + 1)
    times, energy, momentum = drive(on, (none, none), period, 200.0)
    impulse = 200 * period / (2 * np.pi) * (1 - np.cos(2 * np.pi * times / period))
    np.testing.assert_allclose(momentum, impulse, atol=DRIFT * 100)
    assert energy[-1] > 1e-3  # the beam still vibrates


def test_body_off_the_axis_is_in_all_of_them() -> None:
    """The laden beam carries a body with inertia off the axis; without its mass the residual differs."""
    loaded, (q, qd, qdd, base) = laden("CFOAM"), spatial_state("CFOAM", 0)
    off_axis = np.abs(loaded.places.r0[:, 1:]).any(axis=1) | (np.abs(loaded.places.r0[:, 0] - BODY.at) < 1)
    off_axis = off_axis & (np.arange(len(loaded.mass)) >= len(loaded.mass) - 7)
    bare = replace(loaded, inertia=inertia_of(loaded.particles, np.where(off_axis, 0.0, loaded.mass)))
    assert off_axis.sum() == 6
    change = on_base(loaded, q, qd, qdd, base) - on_base(bare, q, qd, qdd, base)
    assert np.abs(change).min() > 1e-3 * BODY.mass
