"""Beams in three dimensions in Exudyn, in the inertial frame, against gbeam's models in base axes.

A rod on the three-axis centrifuge, over whole records from standstill to standstill: the machine's commands as gbeam
writes them for its controller turn three rotations that are written here, and the root of a chain of ANCF cables
follows that path, under gravity; neither accelerations nor gbeam's kinematics are used. Both codes have damping
proportional to the stiffness. What is compared is the tip's path in the specimen's axes, at every step of the record.

A free hub with a rigid body at the beam's tip, its centre off the axis in all directions: Exudyn's elements with shear
have a shear stiffness as great as the axial one, and are nearly rigid in torsion, as gbeam's beam without shapes of
twist is; then both have the torsion of the section.

References are extrapolated: over the record from two steps, on the hub from two meshes, the errors of which fall with
the square of either.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from scipy.interpolate import BPoly, CubicSpline
from scipy.spatial.transform import Rotation

import gbeam as gb
from validation.codes.exudyn_space_beams import HubAndBody, Rod, driven_cable, hub_with_body
from validation.table import Row

TITLE = "Exudyn in three dimensions: a rod on the centrifuge, a hub with an offset body"
NEEDS = ("exudyn", "numpy", "scipy", "jax")
ROD = Rod(0.3, 0.004, 2700.0, 70e9, viscosity=4e-5)
ARM, CONTROL_POINT = 3.3, 0.22
RECORD = Path(__file__).parents[2] / "examples" / "data" / "f16_8g_turn.csv"
GRAVITY = 9.80665


def rows() -> Iterator[Row]:
    """The centrifuge, then the hub."""
    pull = gb.Flight(z=gb.trapezoid(10 * GRAVITY, jerk=4 * GRAVITY, start=1.0, hold=4.0))
    yield from on_centrifuge("trapezoid to 10 g at 4 g/s", pull, 10.0)
    columns = {"time": "time_s", "x": "n_x_g", "y": "-n_y_g", "z": "-n_z_g", "unit": "g"}
    yield from on_centrifuge("F-16 record, 8 g turn", gb.Flight(acceleration=gb.read_record(RECORD, **columns)), 16.0)
    yield from on_hub()


def on_centrifuge(case: str, flight: gb.Flight, duration: float) -> Iterator[Row]:
    """Peaks of the tip in the specimen's axes, and the largest difference at any time."""
    machine = gb.Centrifuge(
        flight,
        arm=ARM,
        control_point=CONTROL_POINT,
        limits=gb.machines["specimen-3.3m"],
        gravity=True,
        idle=1.4 * GRAVITY,
        smoothing=0.02,
    ).over(0.0, duration)
    commands = gb.axis_commands(machine, 1e-3)
    coarse, fine = (tip_of_cable(commands, 6, step) for step in (5e-4, 2.5e-4))
    source = "6 cubic ANCF cables, generalised-α, 0.5 and 0.25 ms"
    for kind in ("exact", "FOAM"):
        response = gb.simulate(damped(kind), machine, duration=duration, integrator="gauss", tolerance=1e-5)
        shown = (response.time > coarse.x[0]) & (response.time < coarse.x[-1])
        time, ours = response.time[shown], np.asarray(response.tip)[shown]
        reference = fine(time) + (fine(time) - coarse(time)) / 3
        peak = np.linalg.norm(reference, axis=1).max()
        for axis in (1, 2):
            at = np.abs(reference[:, axis]).argmax()
            if abs(reference[at, axis]) > 0.01 * peak:
                yield Row(case, f"tip along {'xyz'[axis]}, {kind}, at {time[at]:.2f} s", 1e3 * reference[at, axis],
                          1e3 * ours[at, axis], "mm", 5e-4, source)  # fmt: skip
        stated = response.errors.displacement.total
        worst, alone = (np.linalg.norm(other - reference, axis=1).max() / peak for other in (ours, fine(time)))
        yield Row(case, f"largest difference at any time, {kind}, over the peak", 0.0, worst, "", 5e-4, source,
                  f"0.25 ms alone is {alone:.1g} off; gbeam states {stated:.1g}")  # fmt: skip


def tip_of_cable(commands: gb.Commands, elements: int, step: float) -> CubicSpline:
    """Displacement of the tip in the specimen's axes over the flight's time."""
    values = np.stack([commands.angle, commands.rate, commands.acceleration], axis=1)
    count = int((commands.time[-1] - commands.time[0]) / step)
    time = commands.time[0] + step * np.arange(count + 1)
    first, second, third = BPoly.from_derivatives(commands.time, values)(time).T
    outward = np.stack([np.cos(first), np.sin(first), 0 * first], axis=1)
    axes = Rotation.from_euler("ZX", np.stack([first + second, third], axis=1)).as_matrix()
    root = ARM * outward - CONTROL_POINT * axes[:, :, 0]
    path = driven_cable(ROD, root, axes[:, :, 0], step, GRAVITY, elements)
    return CubicSpline(time, np.einsum("tij,ti->tj", axes, path - root) - [ROD.length, 0, 0])


def damped(kind: str) -> gb.Structure:
    """The rod in a model, with modal ratios that make its damping proportional to its stiffness."""
    section, material = gb.Section.circle(ROD.diameter), gb.Material(ROD.density, ROD.modulus)

    def structure(ratios: float | tuple[float, ...]) -> gb.Structure:
        beam = gb.Beam(ROD.length, section, material, damping_ratio=ratios, rotary_inertia=False)
        return gb.assemble(beam, kind, axial=1, y=4, z=4)

    return structure(tuple(ROD.viscosity * structure(0.0).rest[0] / 2))


def on_hub() -> Iterator[Row]:
    """The beam of 2009, a body of 0.5 kg whose centre is 0.32 m off the tip, a torque of one sine."""
    amplitude, duration, end = 100.0, 10.0, 20.0
    case = HubAndBody(
        8.0, 7.2968e-5, 8.2189e-9, 2766.7, 6.8952e10, 0.5, 200.0, 0.5, (0.02, 0.03, 0.04), (0.05, -0.1, 0.3)
    )

    def torque(t: float) -> float:
        return amplitude * np.sin(2 * np.pi * t / duration) if t < duration else 0.0

    body = gb.PointMass(case.length, case.mass, inertia=case.moments, offset=case.offset)
    metal = gb.Material(case.density, case.modulus, poissons_ratio=0.3)
    hub = gb.Hub(radius=case.radius, inertia=case.hub_inertia, torque=gb.Sine(amplitude, duration))

    def run(torsion: float, **shapes: int) -> gb.Response:
        constant = torsion * 2.6 / case.modulus
        section = gb.Section.general(case.area, case.inertia, case.inertia, torsion_constant=constant)
        beam = gb.Beam(case.length, section, metal, [body], damping_ratio=0.0, rotary_inertia=bool(shapes))
        structure = gb.assemble(beam, "exact", axial=2, y=6, z=6, **shapes)
        return gb.simulate(structure, hub, duration=end, integrator="gauss", step=0.02)

    quantities = [f"{name} along {axis}" for name in ("tip", "root force") for axis in "xyz"]
    quantities += [*(f"root moment about {axis}" for axis in "xyz"), "hub's angle"]
    units = ["m"] * 3 + ["N"] * 3 + ["N m"] * 3 + ["rad"]
    for words, torsion, shapes in (("stiff in torsion", 1e5, {}), ("torsion of the section", 436.0, {"twist": 5})):
        done = run(torsion, **shapes)
        ours = np.column_stack([done.tip, done.loads.root_force, done.loads.root_moment, done.hub.angle])
        coarse, fine = (CubicSpline(*hub_with_body(case, torque, torsion, end, 5e-3, n))(done.time) for n in (16, 32))
        reference = fine + (fine - coarse) / 3
        for i, (name, unit) in enumerate(zip(quantities, units, strict=True)):
            at = np.abs(reference[:, i]).argmax()
            mesh = fine[at, i] / reference[at, i] - 1
            near = abs(ours[at, i] / reference[at, i] - 1) < abs(mesh)
            yield Row(f"hub, offset body, {words}", f"{name}, at {done.time[at]:.2f} s", reference[at, i], ours[at, i],
                      unit, 2e-4, "16 and 32 elements, extrapolated, 5 ms",
                      f"32 elements alone are {100 * mesh:+.1g} % off" if near else "")  # fmt: skip
