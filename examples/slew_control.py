"""Slew a flexible beam from rest to rest: designed on a small linear model, proved on the geometrically exact one.

The beam of 2009 with 0.1 kg at its tip on a free hub of 200 kg m² is turned by one radian. Two designs read the same
linearised SFOAM (full Lagrangian form: FOAM without axial coordinates):

- an LQR on hub and beam, with all states fed back, sampled at 50 Hz;
- a rest-to-rest torque, bang-bang, shaped by a ZVD shaper of the first vibration, in open loop.

Both are then given to the exact model. Run it: python examples/slew_control.py
"""

from __future__ import annotations

import numpy as np
import scipy.linalg

import gbeam as gb

ANGLE = 1.0  # rad
PUSH = 12.0  # s, of the unshaped torque: half forward, half back
SWITCH = 1e-3  # s, from one level of the torque to the next
END, STEP = 40.0, 0.02  # s
LENGTH, RADIUS, INERTIA = 8.0, 0.5, 200.0
HUB = gb.Hub(radius=RADIUS, inertia=INERTIA, torque=gb.constant(0.0))


def structure(kind: str, axial: int, y: int) -> gb.Structure:
    """The beam; without any damping, feedback of the tip drives the modes that the design does not know."""
    section, material = gb.Section.general(7.2968e-5, 8.2189e-9, 8.2189e-9), gb.Material(2766.7, 6.8952e10)
    beam = gb.Beam(LENGTH, section, material, [gb.PointMass(LENGTH, 0.1)], damping_ratio=0.01)
    return gb.assemble(beam, kind, axial=axial, y=y)


def respond(beam: gb.Structure, torque: gb.Sum | gb.Feedback) -> gb.Response:
    """Response of hub and beam to a torque over time, or to a controller."""
    closed = isinstance(torque, gb.Feedback)
    axis = gb.Joint("revolute", "hub", axes=[(0, 0, 1)], effort=None if closed else torque)
    hub = gb.RigidBody(1.0, (INERTIA,) * 3, points={"rim": (RADIUS, 0.0, 0.0)})
    joints = {"axis": axis, "clamp": gb.Joint("fixed", "beam", "hub.rim")}
    system = gb.System({"hub": hub, "beam": beam}, joints, controllers={"lqr": torque} if closed else {})
    return gb.simulate(system, duration=END, step=STEP, estimate=False)


def feedback(design: gb.Structure) -> gb.Feedback:
    """LQR gains on hub angle, tip displacement and their rates, which any model has."""
    linear = gb.linearize(design, HUB)
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
    gains = gain / np.array([1.0, rows[1, 1], 1.0, rows[1, 1]])

    def law(t: float, y: np.ndarray) -> np.ndarray:
        angle, rate, *moved = y
        across = np.array([-np.sin(angle), np.cos(angle)])  # of the hub's axes, in those of the ground
        place, velocity = np.array(moved[:2]), np.array(moved[2:])
        along = np.array([across[1], -across[0]])
        state = angle - ANGLE, across @ place, rate, across @ velocity - rate * (along @ place)
        return -np.atleast_1d(gains @ np.array(state))

    tip = [f"beam.tip.{kind}_{axis}" for kind in ("place", "velocity") for axis in "xy"]
    return gb.Feedback(law, ["axis.angle", "axis.angle_rate", *tip], ["axis.angle"], sample=STEP)


def shaped(design: gb.Structure, *, zvd: bool) -> gb.Sum:
    """Bang-bang torque that turns the rigid system by ANGLE, through a ZVD shaper of the first mode or as it is."""
    linear = gb.linearize(design, HUB).select(outputs=("hub_angle",))
    slow = 1e-4
    gain = linear.c @ np.linalg.solve(1j * slow * np.eye(len(linear.a)) - linear.a, linear.b)
    inertia = float(-1 / (gain.real[0, 0] * slow**2))
    level = 4 * inertia * ANGLE / PUSH**2
    modes = gb.modes(design, HUB)
    half, zeta = np.pi / modes.eigenvalue[0].imag, modes.damping_ratio[0]
    k = np.exp(-np.pi * zeta / np.sqrt(1 - zeta**2))
    shares = np.array([1, 2 * k, k**2]) / (1 + k) ** 2 if zvd else np.ones(1)
    times, levels = np.array([0.0, PUSH / 2, PUSH]), np.array([0.0, 1.0, 1.0, -1.0, -1.0, 0.0])
    switched = np.stack([times, times + SWITCH], axis=1).ravel()
    return gb.Sum(tuple(gb.tabulated(half * i + switched, level * each * levels) for i, each in enumerate(shares)))


def main() -> dict[str, float]:
    """Design, prove, print; return what was measured on the exact model."""
    small, exact = structure("FOAM", 0, 1), structure("exact", 1, 5)
    measured = {}
    designs = {"bang-bang": shaped(small, zvd=False), "ZVD": shaped(small, zvd=True), "LQR": feedback(small)}
    for name, torque in designs.items():
        response = respond(exact, torque)
        place, angle = response.at("beam.tip"), response.coordinate("axis.angle")
        swing, late = np.cos(angle) * place[:, 1] - np.sin(angle) * place[:, 0], response.time > 0.8 * END
        left = np.ptp(swing[late]) / 2
        error = abs(angle[-1] - ANGLE)
        measured |= {f"{name} residual": float(left), f"{name} error": float(error)}
        print(
            f"{name:>9}: largest tip deflection {1e3 * np.abs(swing).max():7.2f} mm, left after {0.8 * END:.0f} s "
            f"{1e3 * left:8.4f} mm, hub off by {1e3 * error:8.4f} mrad"
        )
    return measured


if __name__ == "__main__":
    main()
