"""Energy, momentum and power: what the particles have is what torques and forces gave them.

The energies are summed over the particles here, from their places alone; gbeam writes no energy. At given motions of
the base the same is asserted in tests/loads/test_loads.py for all models.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gbeam import Beam, Hub, Model, Structure, assemble
from gbeam.integrate import LinearEquations, gauss, integrate, newmark
from validation.residuals import hinged

from .strategies import beams, first_frequency, numbers, theorem, vectors

COUNTS = (1, 2, 2)
SMALL = np.array([1e-5, 0.02, 0.01, 0.02, 0.01])  # of the length: stretch, and bending in two directions


def truncated(function: Any, q: Any, qd: Any) -> Any:
    """The part up to second order in (q, q̇) of a polynomial of fourth order, by its values at five scales."""
    scales = np.array([-1.0, -0.5, 0.0, 0.5, 1.0])
    values = np.array([function(s * q, s * qd) for s in scales])
    coefficients = np.linalg.solve(np.vander(scales, increasing=True), values)
    return coefficients[:3].sum(axis=0)


def places(structure: Structure, hub: Hub, q: Any) -> Any:
    """Places of the particles, from the hub's centre, axes of the hub, m."""
    return structure.places.positions(q) @ hub.mount.R_HB.T + np.array([float(hub.radius), 0.0, 0.0])


def weight(structure: Structure, hub: Hub, angle: Any, q: Any) -> tuple[Any, Any]:
    """Potential energy of the particles in gravity, J, and its torque about the hub's axis, N m."""
    x, y, z = np.asarray(hub.mount.gravity)
    c, s = np.cos(angle), np.sin(angle)
    g = np.array([c * x + s * y, c * y - s * x, z + 0 * c])
    r, m = places(structure, hub, q), structure.mass
    return -(m * (r @ g)).sum(), (m * (r[:, 0] * g[1] - r[:, 1] * g[0])).sum()


def motion(structure: Structure, hub: Hub, rate: Any, q: Any, qd: Any) -> tuple[Any, Any]:
    """Kinetic energy, J, and angular momentum about the hub's axis, N m s, of the particles, axes of the hub."""
    r = places(structure, hub, q)
    rd = structure.places.slopes(q) @ qd @ hub.mount.R_HB.T
    v = rd + rate * np.stack([-r[:, 1], r[:, 0], 0 * r[:, 0]], axis=1)
    m = structure.mass
    return 0.5 * (m[:, None] * v * v).sum(), (m * (r[:, 0] * v[:, 1] - r[:, 1] * v[:, 0])).sum()


@pytest.mark.parametrize("kind", ["FOAM", "TLAM"])
@theorem
@given(
    beam=beams(springs=True),
    size=vectors(1.0, 2 * 7 + 3),
    setting=numbers(0.0, 1.5),
    radius=numbers(0.0, 1.0),
    gravity=vectors(1.0),
)
def test_a_free_hub(
    kind: str, beam: Beam, size: np.ndarray, setting: float, radius: float, gravity: np.ndarray
) -> None:
    """dE/dt = τθ̇ − q̇·Cq̇ − c θ̇², dp/dt = τ − cθ̇ − kθ and gravity's torque, at any state and any setting angle."""
    structure = assemble(beam, Model(kind, *COUNTS))
    n = structure.size
    inertia = float(structure.coefficients.rigid[4]) * 3 + beam.length**2
    scale = first_frequency(beam)
    hub = Hub(radius=radius * beam.length, inertia=inertia, stiffness=inertia * scale**2 / 50,
              damping=inertia * scale / 9, setting_angle=setting,
              gravity=0.05 * scale**2 * beam.length * gravity)  # fmt: skip
    lengths = beam.length * np.append(SMALL, np.full(n - len(SMALL), 0.01))
    q, qd = size[:n] * lengths, size[n : 2 * n] * lengths * scale
    angle, rate, torque = size[-3], size[-2] * scale / 4, size[-1] * inertia * scale**2 / 20
    equations = hinged(structure, hub)
    y, yd = np.append(angle, q), np.append(rate, qd)
    rest = equations.residual(y, yd, 0 * y, torque)
    mass = np.stack([equations.residual(y, yd, unit, torque) - rest for unit in np.eye(n + 1)], axis=1)
    ydd = np.linalg.solve(mass, -rest)

    def totals(t: complex) -> tuple[Any, Any]:
        turned, now, speeds = angle + rate * t, q + qd * t, qd + ydd[1:] * t
        spin = rate + ydd[0] * t
        energy = truncated(lambda a, b: motion(structure, hub, spin, a, b)[0], now, speeds)
        momentum = truncated(lambda a, b: motion(structure, hub, spin, a, b)[1], now, speeds)
        stored = 0.5 * now @ structure.coefficients.stiffness @ now + 0.5 * hub.stiffness * turned**2
        stored = stored + truncated(lambda a, _: weight(structure, hub, turned, a)[0], now, speeds)
        return energy + stored + 0.5 * inertia * spin**2, momentum + inertia * spin

    power, moment = (np.imag(x) / 1e-20 for x in totals(1e-20j))  # derivatives, by a complex step
    lost = qd @ structure.coefficients.damping @ qd + hub.damping * rate**2
    terms = np.abs(yd) @ np.abs(mass) @ np.abs(ydd)
    np.testing.assert_allclose(power, torque * rate - lost, atol=1e-9 * terms, rtol=0)
    given_ = torque - hub.damping * rate - hub.stiffness * angle
    given_ = given_ + truncated(lambda a, _: weight(structure, hub, angle, a)[1], q, qd)
    np.testing.assert_allclose(moment, given_, atol=1e-9 * np.abs(mass[0]) @ np.abs(ydd), rtol=0)


@theorem
@given(beam=beams(damping=0.0), a=vectors(50.0), w=vectors(1.0), start=vectors(1.0, 10), scheme=st.sampled_from([0, 1]))
def test_jacobis_integral(beam: Beam, a: np.ndarray, w: np.ndarray, start: np.ndarray, scheme: int) -> None:
    """On a base in steady motion ½q̇Mq̇ + ½qKq − F·q stays, and both schemes keep a quadratic integral."""
    structure = assemble(beam, Model("FOAM", *COUNTS))
    c, scale = structure.coefficients, first_frequency(beam)
    spin = 0.3 * scale * w
    velocity, stiffness, force = c.evaluate(a, spin, np.zeros(3))
    np.testing.assert_allclose(stiffness, stiffness.T, atol=1e-12 * np.abs(stiffness).max())
    np.testing.assert_allclose(velocity, -velocity.T, atol=1e-12 * np.abs(velocity).max())
    q, qd = start[:5] * SMALL * beam.length, start[5:] * SMALL * beam.length * scale

    def held(t: np.ndarray) -> np.ndarray:
        return t

    def matrices(t: np.ndarray) -> tuple[np.ndarray, ...]:
        return tuple(np.broadcast_to(x, (len(t), *x.shape)) for x in (velocity, stiffness, force))

    run = integrate(LinearEquations(c.mass, matrices, held), (newmark(), gauss())[scheme], q, qd,
                    step=0.3 / scale, count=60)  # fmt: skip
    kinetic = 0.5 * np.einsum("ti,ij,tj->t", run.qd, c.mass, run.qd)
    potential = 0.5 * np.einsum("ti,ij,tj->t", run.q, stiffness, run.q) - run.q @ force
    size = np.abs(kinetic).max() + np.abs(potential).max()
    np.testing.assert_allclose(kinetic + potential, (kinetic + potential)[0], atol=1e-10 * size)
