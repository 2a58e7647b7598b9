"""Slew a flexible beam from rest to rest: designed on a small linear model, proved on the geometrically exact one.

The beam of 2009 with 0.1 kg at its tip on a free hub of 200 kg m² is turned by one radian. Two designs read the same
linearised SFOAM (full Lagrangian form: FOAM without axial coordinates):

- an LQR on hub and beam, with all states fed back;
- a rest-to-rest torque, bang-bang, shaped by a ZVD shaper of the first vibration, in open loop.

Both are then given to the exact model. Run it: python examples/slew_control.py
"""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np
import scipy.linalg
from jax.tree_util import Partial

from gbeam import Beam, Hub, Material, Model, PointMass, Section, assemble, constant
from gbeam.analysis.control.linearization import linearize
from gbeam.analysis.steady.modal import modes
from gbeam.integrate import NonlinearEquations, integrate, newmark

ANGLE = 1.0  # rad
PUSH = 12.0  # s, of the unshaped torque: half forward, half back
END, STEP = 40.0, 0.02  # s
DAMPING = 0.01  # without any, feedback of the tip drives the modes that the design does not know


def structure(kind: str, axial: int, y: int):
    section = Section.general(7.2968e-5, 8.2189e-9, 8.2189e-9)
    return assemble(
        Beam(8.0, section, Material(2766.7, 6.8952e10), [PointMass(8.0, 0.1)], DAMPING), Model(kind, axial, y, 0)
    )


HUB = Hub(radius=0.5, inertia=200.0, torque=constant(0.0))


def driven_residual(equations, torque, y, yd, ydd, t):
    """Residual of hub and beam under torque(t, y, ẏ)."""
    return equations.residual(y, yd, ydd, torque(t, y, yd))


def simulate(beam, torque):
    """Motion of hub and beam (t, 1 + n) under torque(t, y, ẏ)."""

    # Arrays are arguments of the compiled program and not constants in it: torques of one form share a program.
    driven = Partial(driven_residual, beam.on_free_hub(HUB), torque)
    rest = np.zeros(beam.size + 1)
    found = integrate(
        NonlinearEquations(driven, lambda t: t), newmark(), rest, rest, step=STEP, count=round(END / STEP)
    )
    return found.time, found.q


def feedback(design, exact):
    """LQR gains on hub angle, tip displacement and their rates, which any model has."""
    linear = linearize(design, HUB)
    weights = np.zeros_like(linear.a)
    rows = linear.select(outputs=("hub_angle", "tip_y")).c
    # Weigh angle 1 rad and tip 0.1 m alike, and their rates less.
    n = len(linear.a) // 2
    rates = np.concatenate([np.zeros((2, n)), rows[:, :n]], axis=1)
    for row, size in zip([*rows, *rates], (1.0, 0.1, 2.0, 1.0), strict=True):
        weights += np.outer(row, row) / size**2
    effort = 1 / 10.0**2  # some 10 N m for one radian
    riccati = scipy.linalg.solve_continuous_are(linear.a, linear.b, weights, np.array([[effort]]))
    gain = (linear.b.T @ riccati / effort)[0]
    # One coordinate per direction: the design model's states are hub angle, tip deflection and their rates.
    per_tip = rows[1, 1]
    k_angle, k_tip, k_rate, k_tip_rate = gain[0], gain[1] / per_tip, gain[2], gain[3] / per_tip

    def torque(t, y, yd):
        r, rd = jax.jvp(lambda q: exact.displacement(q)[-1, 1], (y[1:],), (yd[1:],))
        return -(k_angle * (y[0] - ANGLE) + k_tip * r + k_rate * yd[0] + k_tip_rate * rd)

    return Partial(torque)


def pushes(level, late, shares, t, y, yd):
    """Torque of bang-bang pushes, each a share of `level` and so much too late."""
    since = t - late
    forth, back = (since >= 0) & (since < PUSH / 2), (since >= PUSH / 2) & (since < PUSH)
    return jnp.sum(level * shares * (1.0 * forth - 1.0 * back))


def shaped(design, zvd):
    """Bang-bang torque that turns the rigid system by ANGLE, through a ZVD shaper of the first mode or as it is."""
    linear = linearize(design, HUB).select(outputs=("hub_angle",))
    slow = 1e-4
    gain = linear.c @ np.linalg.solve(1j * slow * np.eye(len(linear.a)) - linear.a, linear.b)
    inertia = float(-1 / (gain.real[0, 0] * slow**2))
    level = 4 * inertia * ANGLE / PUSH**2
    found = modes(design, HUB, 0.0)
    half, zeta = np.pi / found.eigenvalue[0].imag, found.damping_ratio[0]
    k = np.exp(-np.pi * zeta / np.sqrt(1 - zeta**2))
    shares = np.array([1, 2 * k, k**2]) / (1 + k) ** 2
    return Partial(pushes, level, half * np.arange(3), shares if zvd else np.eye(3)[0])


def main() -> dict[str, float]:
    """Design, prove, print; return what was measured on the exact model."""
    small, exact = structure("FOAM", 0, 1), structure("exact", 1, 5)
    measured = {}
    for name, torque in (
        ("bang-bang", shaped(small, False)),
        ("ZVD", shaped(small, True)),
        ("LQR", feedback(small, exact)),
    ):
        time, y = simulate(exact, torque)
        swing, late = exact.displacement(y[:, 1:])[:, -1, 1], time > 0.8 * END
        left = np.ptp(swing[late]) / 2
        error = abs(y[-1, 0] - ANGLE)
        measured |= {f"{name} residual": float(left), f"{name} error": float(error)}
        print(
            f"{name:>9}: largest tip deflection {1e3 * np.abs(swing).max():7.2f} mm, left after {0.8 * END:.0f} s "
            f"{1e3 * left:8.4f} mm, hub off by {1e3 * error:8.4f} mrad"
        )
    return measured


if __name__ == "__main__":
    main()
