"""Point a satellite with a flexible panel: LQG on four states, proved on the exact model, sampled, delayed, saturated.

Run it: python examples/closing_the_loop.py; it writes out/closing_the_loop/loop.png.
"""

from __future__ import annotations

from pathlib import Path

import control
import numpy as np

import gbeam as gb

SAMPLE, DELAY, LIMIT = 0.01, 0.01, 20.0  # s, s, N m
MEASURED = ["axis.angle", "axis.angle_rate"]


def satellite(model: str, *controllers: gb.Feedback, angle: float = 0.0, **shapes: int) -> gb.System:
    """A hub of 50 kg m² that turns about z, half a radian off, with a panel of 3 m that bends in the plane."""
    beam = gb.Beam(3.0, gb.Section.rectangle(0.5, 0.02), gb.Material(2700, 70e9), damping_ratio=0.002)
    rim = gb.Place((0.5, 0, 0), turn=(np.pi / 2, 0, 0))
    hub = gb.RigidBody(100.0, (50.0, 50.0, 50.0), points={"rim": rim})
    joints = {
        "axis": gb.Joint("revolute", "hub", axes=[(0, 0, 1)], initial=angle),
        "clamp": gb.Joint("fixed", "panel", on="hub.rim"),
    }
    bodies = {"hub": hub, "panel": gb.assemble(beam, model, **shapes)}
    return gb.System(bodies, joints, controllers=dict(zip(["lqg"], controllers, strict=False)))


def lqg() -> gb.Feedback:
    """A regulator of angle and first vibration, by the torque that acts a sample later."""
    plant = gb.linearize(satellite("FOAM", axial=1, z=4), inputs=["axis.angle"], outputs=MEASURED)
    small = control.c2d(gb.modal_truncation(plant, 1).to_control(), SAMPLE)
    n = len(small.A)
    a = np.block([[small.A, small.B], [np.zeros((1, n + 1))]])  # the torque that waits is a state
    b, c = np.eye(n + 1)[:, n:], np.hstack([small.C, np.zeros((2, 1))])
    gain, _, _ = control.dlqr(a, b, c.T @ np.diag([400.0, 400.0]) @ c, [[1e-3]])
    observer, _, _ = control.dlqe(a, b, c, [[1.0]], np.diag([1e-8, 1e-6]))
    law = control.ss(a - b @ gain - observer @ c, observer, -gain, np.zeros((1, 2)), SAMPLE)
    return gb.Feedback(law, MEASURED, ["axis.angle"], sample=SAMPLE, delay=DELAY, limit=LIMIT)


def main() -> gb.Response:
    """Turn the exact model by half a radian."""
    system = satellite("exact", lqg(), angle=-0.5, axial=1, z=4)
    return gb.simulate(system, duration=20.0, tolerance=1e-3)


if __name__ == "__main__":
    response = main()
    print(response)
    angle, loop = response.coordinate("axis.angle"), response.loop
    assert loop is not None
    print(f"angle after 10 s {angle[len(angle) // 2]:.2e} rad, after 20 s {angle[-1]:.1e} rad")
    print(f"torque limited at {100 * loop.saturated[0]:.1f} % of the samples")
    folder = Path(__file__).parents[1] / "out" / "closing_the_loop"
    folder.mkdir(parents=True, exist_ok=True)
    response.plot("loop").figure.savefig(folder / "loop.png")
