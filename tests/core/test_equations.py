"""Lagrange's equations against mechanics that knows nothing of Lagrange: inertial frames, power, momentum.

Invariants as in 2009, corrected: a model derived from an energy conserves its own T + U and p_θ on a free hub; the
printed SFOAM, which drops Q_θ from the hub's row but not from the beam's, conserves neither.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import diffrax
import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from gbeam.mechanics.energy import second_order

from gbeam import assemble
from gbeam.mechanics.equations import Damped, Hub, coefficients, on_free_hub, on_prescribed_base

from .helpers import (
    BODY,
    COMPLETE,
    HUB_INERTIA,
    HUB_RADIUS,
    PLANAR,
    SPATIAL,
    TIP,
    OnHub,
    beam,
    on_hub,
    planar,
    spatial,
    states,
)

IDENTITY = 1e-10  # relative to the largest term
DRIFT = 1e-9  # of energy and momentum along a trajectory, tolerance of the integration 1e-11
LEAK = 1e-5  # what the printed SFOAM loses at least

HUB = Hub(jnp.asarray(HUB_RADIUS), jnp.asarray(HUB_INERTIA))
residual = eqx.filter_jit(on_prescribed_base)
hub_residual = eqx.filter_jit(on_free_hub)


# --- on a prescribed base


def skew(w: jax.Array) -> jax.Array:
    x, y, z = w
    return jnp.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


@cache
def virtual_work(name: str) -> Callable[..., jax.Array]:
    """Σ m_k a_k · ∂r_k/∂q + ∂U/∂q, the particles' accelerations by differentiating their paths in the world twice."""
    energy = spatial(name).system.energy

    def forces(q, qd, qdd, a_WO_B, w, al):  # type: ignore[no-untyped-def]
        def place(t: Any, q: Any) -> Any:
            # to second order in t, which is all that accelerations at t = 0 need
            attitude = jnp.eye(3) + skew(w) * t + (skew(w) @ skew(w) + skew(al)) * t**2 / 2
            return a_WO_B * t**2 / 2 + energy.particles(q) @ attitude.T

        def path(t: Any) -> Any:
            return place(t, q + qd * t + qdd * t**2 / 2)

        acceleration = jax.jacfwd(jax.jacfwd(path))(0.0)
        partial = jax.jacfwd(place, 1)(0.0, q)
        return jnp.einsum("k,ki,kij->j", energy.mass, acceleration, partial) + jax.grad(energy.potential)(q)

    return eqx.filter_jit(forces)


@pytest.mark.parametrize("name", COMPLETE)
@pytest.mark.parametrize("seed", range(2))
def test_complete_models_are_dalemberts_principle_in_the_world(name: str, seed: int) -> None:
    q, qd, qdd, a, w, al = np.split(states(24, 1, 0.5, seed)[0], [5, 10, 15, 18, 21])
    got = residual(spatial(name).system, q, qd, qdd, a, w, al)
    wanted = virtual_work(name)(q, qd, qdd, a, w, al)
    np.testing.assert_allclose(got, wanted, atol=IDENTITY * np.abs(wanted).max())


def test_coefficients_are_the_whole_truth_for_a_truncated_energy() -> None:
    system = spatial("FOAM").system
    c = coefficients(system)
    q, qd, qdd, a, w, al = np.split(states(24, 1, 1.0, seed=3)[0], [5, 10, 15, 18, 21])
    velocity, stiffness, load = c.at(a, w, al)
    linear = c.mass @ qdd + velocity @ qd + stiffness @ q - load
    np.testing.assert_allclose(
        linear, residual(system, q, qd, qdd, a, w, al), atol=IDENTITY * np.abs(stiffness @ q).max()
    )


def test_coefficients_of_a_complete_energy_are_its_linearisation() -> None:
    complete = planar("CFOAM").system
    truncated = Damped(second_order(complete.energy), complete.damping)
    for ours, wanted in zip(
        jax.tree.leaves(coefficients(complete)), jax.tree.leaves(coefficients(truncated)), strict=True
    ):
        np.testing.assert_allclose(ours, wanted, atol=1e-9 * max(float(np.abs(wanted).max()), 1.0))


def test_symmetries_of_the_coefficients() -> None:
    """M and K at rest symmetric, G skew; skew part of K(α) is ½ G with ω replaced by α: 2020 (16), (20)–(22)."""
    c = coefficients(spatial("FOAM").system)
    np.testing.assert_allclose(c.mass, c.mass.T, atol=1e-12)
    np.testing.assert_allclose(c.stiffness, c.stiffness.T, atol=1e-6)
    np.testing.assert_allclose(c.gyroscopic, -jnp.swapaxes(c.gyroscopic, 1, 2), atol=1e-12)
    np.testing.assert_allclose(c.k_al - jnp.swapaxes(c.k_al, 1, 2), c.gyroscopic, atol=1e-12)
    for symmetric in (c.k_ww, c.k_a):
        np.testing.assert_allclose(symmetric, jnp.swapaxes(symmetric, -1, -2), atol=1e-11)
    np.testing.assert_allclose(c.k_ww, jnp.swapaxes(c.k_ww, 0, 1), atol=1e-12)


def test_only_the_roots_acceleration_matters_not_the_place_of_the_axis() -> None:
    """A hub of radius r at the rate Ω is a base with a_O = (−rΩ², r dΩ/dt, 0): two forms of one residual."""
    system, (q, qd, qdd) = planar("CFOAM").system, states(4, 3, 0.3, seed=4)
    rate, spin = 1.3, 0.7
    root = np.array([-HUB_RADIUS * rate**2, HUB_RADIUS * spin, 0])
    on_base = residual(system, q, qd, qdd, root, np.array([0, 0, rate]), np.array([0, 0, spin]))
    y, yd, ydd = (np.append(a, b) for a, b in ((0.4, q), (rate, qd), (spin, qdd)))
    on_the_hub = hub_residual(system, HUB, y, yd, ydd, jnp.asarray(5.0))
    np.testing.assert_allclose(on_the_hub[1:], on_base, atol=IDENTITY * np.abs(on_base).max())


def test_damping_is_a_force_against_the_rates() -> None:
    (q, qd, qdd), o = states(4, 3, 0.3, seed=5), np.zeros(3)
    system = planar("FOAM", 0.02).system
    undamped = Damped(system.energy, jnp.zeros((4, 4)))
    force = residual(system, q, qd, qdd, o, o, o) - residual(undamped, q, qd, qdd, o, o, o)
    np.testing.assert_allclose(force, system.damping @ qd, atol=1e-9)
    assert qd @ force > 0


# --- on a free hub


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
    on, torque = on_hub(name, damping_ratio), 30.0
    for seed in range(3):
        y, yd = random_state(on.structure, seed)
        ydd = on.acceleration(y, yd, torque)
        power, momentum_rate = on.rates(y, yd, ydd)
        wanted = torque * yd[0] - yd[1:] @ on.structure.system.damping @ yd[1:]
        scale = np.abs(ydd).max() * np.abs(yd).max() + np.abs(wanted)
        np.testing.assert_allclose(power, wanted, atol=IDENTITY * scale)
        np.testing.assert_allclose(momentum_rate, torque, rtol=1e-8)


@eqx.filter_jit
def trajectory(acceleration: Any, torque: Any, y: Any, yd: Any, times: Any) -> Any:
    """States at times, by an explicit method of eighth order that damps nothing."""
    solution = diffrax.diffeqsolve(
        diffrax.ODETerm(lambda t, s, _: (s[1], acceleration(s[0], s[1], torque(t)))),
        diffrax.Dopri8(),
        times[0],
        times[-1],
        None,
        (y, yd),
        saveat=diffrax.SaveAt(ts=times),
        stepsize_controller=diffrax.PIDController(rtol=1e-11, atol=1e-14),
        max_steps=200_000,
    )
    return solution.ys


def drive(on: OnHub, start: tuple[np.ndarray, np.ndarray], duration: float, torque: Callable[[Any], Any]) -> Any:
    """Times, energy and momentum from the start to the duration."""
    times = jnp.linspace(0, duration, 11)
    y, yd = trajectory(on.acceleration, torque, *start, times)
    energy, momentum = (
        np.array([float(f(*s)) for s in zip(y, yd, strict=True)]) for f in (on.total_energy, on.momentum)
    )
    return np.asarray(times), energy, momentum


@pytest.mark.parametrize("name", PLANAR)
def test_free_hub_conserves_energy_and_momentum(name: str) -> None:
    on = on_hub(name)
    start = random_state(on.structure, seed=7)
    _, energy, momentum = drive(on, start, 1.0, lambda t: 0.0)
    elastic = float(on.structure.system.energy.potential(start[0][1:]))
    assert elastic > 0.1  # J: the beam is really bent
    assert np.abs(energy - energy[0]).max() < DRIFT * energy[0]
    assert np.abs(momentum - momentum[0]).max() < DRIFT * momentum[0]


def test_printed_sfoam_conserves_nothing() -> None:
    """2009 "SFOAM … does not include Q_θ" against (40) "from FOAM by deleting q1": only the second is Lagrangian."""
    on = on_hub("SFOAM")
    _, energy, momentum = drive(on, random_state(on.structure, seed=7), 1.0, lambda t: 0.0)
    assert np.abs(energy - energy[0]).max() > LEAK * energy[0]
    assert np.abs(momentum - momentum[0]).max() > LEAK * momentum[0]


def test_printed_sfoam_lacks_the_hub_force_only() -> None:
    """2009 (32): the rest of the hub's row, and the beam's rows, are those of FOAM without axial coordinates."""
    printed, lagrangian = on_hub("SFOAM"), on_hub("FOAM axial=0")
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
    on, period = on_hub(name), 1.0
    none = np.zeros(on.structure.size + 1)
    times, energy, momentum = drive(on, (none, none), period, lambda t: 200 * jnp.sin(2 * jnp.pi * t / period))
    impulse = 200 * period / (2 * np.pi) * (1 - np.cos(2 * np.pi * times / period))
    np.testing.assert_allclose(momentum, impulse, atol=DRIFT * 100)
    assert energy[-1] > 1e-3  # the beam still vibrates


def test_body_off_the_axis_is_in_all_of_them() -> None:
    """The spatial structures above carry a body with inertia off the axis; without it the residual differs."""
    q, qd, qdd, a, w, al = np.split(states(24, 1, 0.5, 0)[0], [5, 10, 15, 18, 21])
    plain = assemble(beam(TIP), SPATIAL["CFOAM"])
    change = residual(spatial("CFOAM").system, q, qd, qdd, a, w, al) - residual(plain.system, q, qd, qdd, a, w, al)
    assert np.abs(change).min() > 1e-3 * BODY.mass
