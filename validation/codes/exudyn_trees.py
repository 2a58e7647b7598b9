"""Trees of bodies in Exudyn, in the inertial frame, against gbeam's systems.

Two rigid bodies with products of inertia on hinges that are not parallel fall under gravity: Exudyn's bodies have Euler
parameters and joints are constraints, where gbeam's tree has two angles.

A free hub in the plane carries two beams of different lengths and turns under a torque of one sine: planar cubic ANCF
elements on a rigid body, against exact beams on a free joint, whose momentum is conserved after the torque. "Mesh and
step" is what half the elements and twice the step change in Exudyn's answer.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

import gbeam as gb
from validation.table import Row

TITLE = "Exudyn: trees of bodies"
NEEDS = ("exudyn", "numpy", "scipy")
AXIS = np.array([1.0, 1.0, 0.5]) / 1.5
UPPER, LOWER = np.diag([0.02, 0.09, 0.1]), np.array([[0.03, 0.005, 0.0], [0.005, 0.06, 0.002], [0.0, 0.002, 0.07]])
FALL, SPIN = 2.0, 8.0  # s
MODULUS, DENSITY, WIDTH, THICKNESS = 70e9, 2700.0, 0.1, 0.004
LENGTHS, RADIUS, MASS, INERTIA, TORQUE = (3.0, 2.0), 0.4, 20.0, 5.0, 30.0
SAMPLES = 400


def rows() -> Iterator[Row]:
    """The falling bodies, then the free hub."""
    ours = _fallen()
    theirs = [_fallen_in_exudyn(steps) for steps in (4000, 8000)]
    reference = theirs[1] + (theirs[1] - theirs[0]) / 3
    for axis in range(3):
        at = np.abs(reference[:, axis] - reference[0, axis]).argmax()
        words = f"end along {'xyz'[axis]}, at {at * FALL / SAMPLES:.2f} s"
        yield Row("two bodies on hinges", words, reference[at, axis],
                  ours[at, axis], "m", 1e-5, "generalised-α, 0.5 and 0.25 ms, extrapolated")  # fmt: skip
    worst = np.linalg.norm(ours - reference, axis=1).max()
    yield Row("two bodies on hinges", "largest difference at any time", 0.0, worst, "m", 2e-5, "likewise")
    response = _spun()
    time = response.time
    coarse, fine = _spun_in_exudyn(12, 8000), _spun_in_exudyn(24, 16000)
    reference = fine + (fine - coarse) / 3
    kept = np.arange(0, len(time), (len(time) - 1) // SAMPLES)
    assert np.allclose(time[kept], np.linspace(0, SPIN, SAMPLES + 1))
    for k, name in enumerate(("a.tip", "b.tip", "hub.root")):
        place = response.at(name)[kept, :2]
        mine, other = place - place[0], reference[:, 2 * k : 2 * k + 2] - reference[0, 2 * k : 2 * k + 2]
        size = np.linalg.norm(other, axis=1).max()
        at = int(np.linalg.norm(other, axis=1).argmax())
        mesh = np.linalg.norm(fine - coarse, axis=1).max()
        for axis in (0, 1):
            if abs(other[at, axis]) > 0.1 * size:
                words = f"{name} along {'xy'[axis]}, at {time[kept][at]:.2f} s"
                yield Row("free hub, two beams", words, other[at, axis],
                          mine[at, axis], "m", 5e-4, "12 and 24 ANCF elements a beam, 1 and 0.5 ms, extrapolated",
                          f"mesh and step {mesh:.1g} m")  # fmt: skip
    assert response.invariants is not None
    late = time > 2.0
    spin = response.invariants.angular_momentum
    yield Row("free hub, two beams", "angular momentum after the torque, change over its size", 0.0,
              float(np.ptp(spin[late, 2]) / np.abs(spin).max()), "", 1e-6, "conserved")  # fmt: skip


def _fallen() -> np.ndarray:
    upper = gb.RigidBody(1.0, UPPER, (0.5, 0.0, 0.0), {"end": (1.0, 0.0, 0.0)})
    lower = gb.RigidBody(1.5, LOWER, (0.3, 0.1, 0.05), {"end": (0.6, 0.0, 0.0)})
    joints = {
        "top": gb.Joint("revolute", "upper", axes=[(0, 1, 0)]),
        "elbow": gb.Joint("revolute", "lower", "upper.end", axes=[AXIS]),
    }
    system = gb.System({"upper": upper, "lower": lower}, joints, gravity=(0.0, 0.0, -9.81))
    response = gb.simulate(system, duration=FALL, step=FALL / SAMPLES, estimate=False)
    return np.asarray(response.at("lower.end"))


def _fallen_in_exudyn(steps: int) -> np.ndarray:
    import exudyn
    from exudyn.utilities import RigidBodyInertia, SensorBody

    system = exudyn.SystemContainer().AddSystem()
    ground = system.CreateGround()
    bodies = [ground]
    about = ((1.0, (0.5, 0.0, 0.0), UPPER, (0.0, 0.0, 0.0)), (1.5, (0.3, 0.1, 0.05), LOWER, (1.0, 0.0, 0.0)))
    for mass, centre, inertia, place in about:
        body = RigidBodyInertia(mass=mass, com=[0, 0, 0], inertiaTensor=inertia).Translated(list(centre))
        bodies.append(system.CreateRigidBody(inertia=body, referencePosition=list(place), gravity=[0, 0, -9.81]))
    for pair, place, axis in ((bodies[:2], (0, 0, 0), (0, 1, 0)), (bodies[1:], (1, 0, 0), tuple(AXIS))):
        system.CreateRevoluteJoint(bodyNumbers=pair, position=list(place), axis=list(axis), useGlobalFrame=True)
    kind = exudyn.OutputVariableType.Position
    sensor = system.AddSensor(
        SensorBody(bodyNumber=bodies[2], localPosition=[0.6, 0, 0], storeInternal=True, outputVariableType=kind)
    )
    system.Assemble()
    system.SolveDynamic(_settings(FALL, steps, 1.0, 1e-8))
    return _sampled(system, [sensor], FALL)


def _spun() -> gb.Response:
    section, material = gb.Section.rectangle(WIDTH, THICKNESS), gb.Material(DENSITY, MODULUS)
    bodies: dict[str, gb.RigidBody | gb.Structure] = {}
    turned = {"a": gb.Place((RADIUS, 0, 0), (np.pi / 2, 0, 0)), "b": gb.Place((-RADIUS, 0, 0), (0, np.pi, 0))}
    turned["b"] = gb.Place((-RADIUS, 0, 0), tuple(np.pi * np.array([0, 1, 1]) / np.sqrt(2)))
    bodies["hub"] = gb.RigidBody(MASS, (INERTIA,) * 3, points=turned)
    joints = {"free": gb.Joint("free", "hub")}
    for name, length in zip("ab", LENGTHS, strict=True):
        beam = gb.Beam(length, section, material, damping_ratio=0.0, rotary_inertia=False)
        bodies[name] = gb.assemble(beam, "exact", axial=2, y=0, z=6)
        joints[f"clamp_{name}"] = gb.Joint("fixed", name, f"hub.{name}")
    moment = gb.vector(z=gb.Sine(TORQUE, 2.0))
    system = gb.System(bodies, joints, {"turn": gb.PointForce("hub.root", moment=moment)})
    return gb.simulate(system, duration=SPIN, step=SPIN / SAMPLES / 4, estimate=False)


def _spun_in_exudyn(elements: int, steps: int) -> np.ndarray:
    import exudyn
    from exudyn import itemInterface as items
    from exudyn.utilities import SensorNode

    from benchmarks.exudyn_hub_beam import cable, clamp, node

    system = exudyn.SystemContainer().AddSystem()
    centre = system.AddNode(items.NodeRigidBody2D(referenceCoordinates=[0, 0, 0]))
    hub = system.AddObject(items.ObjectRigidBody2D(mass=MASS, inertia=INERTIA, nodeNumber=centre))
    area, second = WIDTH * THICKNESS, WIDTH * THICKNESS**3 / 12
    tips = []
    for way, length in zip((1.0, -1.0), LENGTHS, strict=True):
        x = np.sort(way * np.linspace(RADIUS, RADIUS + length, elements + 1))  # all along x
        nodes = [node(system, each) for each in x]
        values = length / elements, DENSITY * area, MODULUS * second, MODULUS * area
        cables = [cable(system, pair, *values) for pair in pairwise(nodes)]
        clamp(system, hub, way * RADIUS, *((cables[0], 0.0) if way > 0 else (cables[-1], length / elements)))
        tips.append(nodes[-1] if way > 0 else nodes[0])

    def torque(mbs, t, load):  # type: ignore[no-untyped-def]  # names that Exudyn checks
        return load * np.sin(np.pi * t) if t < 2.0 else 0.0

    turning = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=centre, coordinate=2))
    system.AddLoad(items.LoadCoordinate(markerNumber=turning, load=TORQUE, loadUserFunction=torque))
    kind = exudyn.OutputVariableType.Position
    sensors = [
        system.AddSensor(SensorNode(nodeNumber=node, storeInternal=True, outputVariableType=kind))
        for node in (*tips, centre)
    ]
    system.Assemble()
    system.SolveDynamic(_settings(SPIN, steps, 0.9, 1e-5))
    every = _sampled(system, sensors, SPIN)
    return np.concatenate([every[:, 3 * k : 3 * k + 2] for k in range(3)], axis=1)


def _settings(end: float, steps: int, radius: float, tolerance: float) -> object:
    import exudyn

    settings = exudyn.SimulationSettings()
    settings.timeIntegration.numberOfSteps = steps
    settings.timeIntegration.endTime = end
    settings.timeIntegration.generalizedAlpha.spectralRadius = radius
    newton = settings.timeIntegration.newton
    newton.useModifiedNewton, newton.relativeTolerance, newton.absoluteTolerance = True, tolerance, tolerance
    settings.timeIntegration.verboseMode = 0
    settings.timeIntegration.adaptiveStep = False
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = 0.0  # every step
    return settings


def _sampled(system: object, sensors: list[object], end: float) -> np.ndarray:
    """Values of sensors side by side at evenly spaced times from the start."""
    data = [system.GetSensorStoredData(sensor) for sensor in sensors]  # type: ignore[attr-defined]
    data = [each[:: (len(each) - 1) // SAMPLES] for each in data]
    assert np.allclose(data[0][:, 0], np.linspace(0, end, SAMPLES + 1))
    return np.concatenate([each[:, 1:4] for each in data], axis=1)
