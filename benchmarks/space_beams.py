"""Exact beams in space with torsion and shear, gbeam beside Exudyn, in turn in one process.

    python benchmarks/space_beams.py

A beam with a rigid body beside its tip on a free hub under a torque (the case of validation's "Exudyn in three
dimensions") and on a hub that is driven to and fro, and a free satellite with two panels under torques about all axes.
Exudyn has geometrically exact elements, whose error falls with the square of their length. The error is the largest of
the tip's place at times that all runs have, over its peak, from the finest run of gbeam. Times are processor times, s,
of the first call and of another.
"""
# a file of this folder has the name of the package

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

sys.path.pop(0)
sys.path.insert(0, str(Path(__file__).parents[1]))
import exudyn
import numpy as np
from exudyn import itemInterface as items
from exudyn.rigidBodyUtilities import eulerParameters0

import gbeam as gb
from validation.codes.exudyn_space_beams import HubAndBody, dynamic_settings, hub_with_body

Answer = tuple[np.ndarray, np.ndarray]  # times (t,) s and the tip's place (t, 3) m
CASE = HubAndBody(8.0, 7.2968e-5, 8.2189e-9, 2766.7, 6.8952e10, 0.5, 200.0, 0.5, (0.02, 0.03, 0.04), (0.05, -0.1, 0.3))
TORQUE, DURATION, END, TORSION = 100.0, 10.0, 20.0, 436.0
TOLERANCE = 1e-4  # N: of Exudyn's forces, which it takes a fifth longer to bring to 1e-6; of many elements it cannot
RATE, COMMON = 0.9, 0.1  # rad/s, and the interval of times that all runs have, s
LENGTH, WIDTH, THICKNESS, DENSITY, MODULUS, RATIO = 3.0, 0.1, 0.002, 2700.0, 70e9, 0.33
HALF, MASS, MOMENTS, TORQUES, SLEW, AFTER = 0.5, 50.0, (8.0, 10.0, 12.0), (3.0, 5.0, 40.0), 2.0, 6.0


def on_hub(hub: gb.Hub, shapes: int, step: float) -> Answer:
    """The beam on a hub: as many shapes along y and z, and half as many of twist."""
    section = gb.Section.general(CASE.area, CASE.inertia, CASE.inertia, torsion_constant=TORSION / 2.6e10)
    material = gb.Material(CASE.density, CASE.modulus, shear_modulus=2.6e10)
    body = gb.PointMass(CASE.length, CASE.mass, inertia=CASE.moments, offset=CASE.offset)
    beam = gb.Beam(CASE.length, section, material, [body], damping_ratio=0.0, rotary_inertia=True)
    structure = gb.assemble(beam, "exact", axial=1, y=shapes, z=shapes, twist=shapes // 2)
    settings = {"integrator": "gauss", "step": step, "initial": "undeformed", "estimate": False, "loads": False}
    run = gb.simulate(structure, hub, duration=END, **settings)
    return np.asarray(run.time), np.asarray(run.tip)


def free_ours(shapes: int, step: float) -> Answer:
    """The beam on the free hub."""
    torque = gb.Sine(TORQUE, DURATION)
    return on_hub(gb.Hub(radius=CASE.radius, inertia=CASE.hub_inertia, torque=torque), shapes, step)


def driven_ours(shapes: int, step: float) -> Answer:
    """The beam on the driven hub."""
    return on_hub(gb.Hub(radius=CASE.radius, rate=gb.Sine(RATE, DURATION)), shapes, step)


def free_theirs(elements: int, step: float) -> Answer:
    """Answer of Exudyn."""

    def torque(t: float) -> float:
        return TORQUE * np.sin(2 * np.pi * t / DURATION) if t < DURATION else 0.0

    at, values = hub_with_body(CASE, torque, TORSION, END, step, elements, tolerance=TOLERANCE)
    return at, values[:, :3]


def driven_theirs(elements: int, step: float) -> Answer:
    """The beam on the driven hub by Exudyn."""

    def angle(t: float) -> float:
        turn = DURATION / (2 * np.pi)
        return RATE * turn * (1 - np.cos(t / turn)) if t < DURATION else 0.0

    at, values = hub_with_body(CASE, lambda _: 0.0, TORSION, END, step, elements, angle, TOLERANCE)
    return at, values[:, :3]


def satellite_ours(shapes: int, step: float) -> Answer:
    """The satellite: shapes along z, half as many along y and two fewer of twist, a product of both curvatures."""
    section, material = gb.Section.rectangle(WIDTH, THICKNESS), gb.Material(DENSITY, MODULUS, poissons_ratio=RATIO)
    beam = gb.Beam(LENGTH, section, material, damping_ratio=0.0, rotary_inertia=True)
    panel = gb.assemble(beam, "exact", y=shapes // 2, z=shapes, twist=shapes - 2)
    points = {"left": gb.Place((-HALF, 0, 0), (0, 0, np.pi)), "right": (HALF, 0, 0)}
    moment = gb.vector(*(gb.Sine(each, SLEW) for each in TORQUES))
    system = gb.System(
        {"bus": gb.RigidBody(MASS, MOMENTS, points=points), "a": panel, "b": panel},
        {
            "free": gb.Joint("free", "bus"),
            "ja": gb.Joint("fixed", "a", "bus.right"),
            "jb": gb.Joint("fixed", "b", "bus.left"),
        },
        forces={"drive": gb.PointForce("bus.root", moment=moment, follower=True)},
    )
    run = gb.simulate(system, duration=AFTER, step=step, estimate=False, loads=False)
    return np.asarray(run.time), np.asarray(run.at("a.tip"))


def satellite_theirs(elements: int, step: float) -> Answer:
    """Answer of Exudyn."""
    system = exudyn.SystemContainer().AddSystem()
    area, shear = WIDTH * THICKNESS, MODULUS / (2 * (1 + RATIO))
    wide, thin = THICKNESS * WIDTH**3 / 12, WIDTH * THICKNESS**3 / 12
    torsion = float(gb.Section.rectangle(WIDTH, THICKNESS).torsion_constant(0.0))
    section = exudyn.BeamSection()
    stiffness = [MODULUS * area, shear * area, shear * area, shear * torsion, MODULUS * thin, MODULUS * wide]
    section.stiffnessMatrix = np.diag(stiffness)
    section.massPerLength, section.inertia = DENSITY * area, DENSITY * np.diag([wide + thin, thin, wide])

    def node(x: float) -> Any:
        return system.AddNode(items.NodeRigidBodyEP(referenceCoordinates=[x, 0, 0, *eulerParameters0]))

    centre = node(0.0)
    bus = system.AddObject(items.ObjectRigidBody(mass=MASS, inertia=[*MOMENTS, 0, 0, 0], nodeNumber=centre))
    tips = []
    for side in (1, -1):
        nodes = [node(side * (HALF + x)) for x in np.linspace(0, LENGTH, elements + 1)]
        for pair in pairwise(nodes):
            ends = list(pair) if side > 0 else list(reversed(pair))
            each = items.ObjectBeamGeometricallyExact(nodeNumbers=ends, length=LENGTH / elements, sectionData=section)
            system.AddObject(each)
        rim = system.AddMarker(items.MarkerBodyRigid(bodyNumber=bus, localPosition=[side * HALF, 0, 0]))
        root = system.AddMarker(items.MarkerNodeRigid(nodeNumber=nodes[0]))
        system.AddObject(items.ObjectJointGeneric(markerNumbers=[rim, root]))
        tips.append(nodes[-1])

    def drive(mbs, t, loadVector):  # type: ignore[no-untyped-def]  # names that Exudyn checks
        wave = np.sin(2 * np.pi * t / SLEW) if t < SLEW else 0.0
        return [wave * each for each in TORQUES]

    marker = system.AddMarker(items.MarkerNodeRigid(nodeNumber=centre))
    load = items.LoadTorqueVector(
        markerNumber=marker, loadVector=[0, 0, 1], bodyFixed=True, loadVectorUserFunction=drive
    )
    system.AddLoad(load)
    stored = {"storeInternal": True, "writeToFile": False}
    kind = exudyn.OutputVariableType.Position
    sensor = system.AddSensor(items.SensorNode(nodeNumber=tips[0], outputVariableType=kind, **stored))
    system.Assemble()
    system.SolveDynamic(dynamic_settings(step, round(AFTER / step), "EigenSparse", TOLERANCE))
    data = system.GetSensorStoredData(sensor)
    return data[:, 0], data[:, 1:]


# Of gbeam the first is the converged run from which all errors are taken.
PROBLEMS: dict[str, tuple[tuple[str, Callable[[int, float], Answer], list[tuple[int, float]]], ...]] = {
    "free hub, body beside the tip": (
        ("gbeam", free_ours, [(6, 0.025), (4, 0.1), (5, 0.05)]),
        ("Exudyn", free_theirs, [(16, 0.01), (32, 0.01), (64, 0.01)]),
    ),
    "driven hub, body beside the tip": (
        ("gbeam", driven_ours, [(6, 0.025), (5, 0.1), (5, 0.05), (6, 0.05)]),
        ("Exudyn", driven_theirs, [(16, 0.01), (32, 0.01), (64, 0.005), (128, 0.005)]),
    ),
    "satellite with two panels": (
        ("gbeam", satellite_ours, [(8, 0.0025), (6, 0.01), (7, 0.01)]),
        ("Exudyn", satellite_theirs, [(32, 0.005), (64, 0.0025), (128, 0.00125)]),
    ),
}


def main() -> None:
    """Print a line for each setting."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--problem", default="", help="only problems whose name contains this")
    chosen = parser.parse_args().problem
    for name, codes in PROBLEMS.items():
        if chosen not in name:
            continue
        print(name)
        reference: tuple[np.ndarray, np.ndarray] | None = None
        for code, run, settings in codes:
            for size, step in settings:
                times = []
                for _ in range(1 if reference is None else 2):
                    start = time.process_time()
                    at, tip = run(size, step)
                    times.append(time.process_time() - start)
                if reference is None:
                    reference = at, tip
                    peak = np.linalg.norm(tip - tip[0], axis=1).max()
                    common = np.arange(0.0, at[-1], COMMON)
                away = [each[np.searchsorted(times, common - 1e-9)] for times, each in ((at, tip), reference)]
                error = np.linalg.norm(away[0] - away[1], axis=1).max() / peak
                words = f"  {code:7}{size:4} {'shapes' if code == 'gbeam' else 'elements'}, {1e3 * step:g} ms"
                print(f"{words:34} first {times[0]:7.3f} s, later {times[-1]:7.3f} s, error {error:.1e}", flush=True)


if __name__ == "__main__":
    main()
