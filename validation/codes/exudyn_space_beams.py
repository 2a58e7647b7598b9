"""Three-dimensional beams in Exudyn, in the inertial frame: a cable whose root follows a given path, and elements with
shear and torsion on a rigid hub, with a rigid body at the tip.
"""
# ruff: noqa: E402  # Exudyn reads its switch when it is imported

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

sys.exudynFast = True  # type: ignore[attr-defined]
import exudyn
from exudyn import itemInterface as items
from exudyn.rigidBodyUtilities import eulerParameters0


@dataclass(frozen=True)
class Rod:
    """A round rod: m, kg/m³, Pa; damping proportional to stiffness, s."""

    length: float
    diameter: float
    density: float
    modulus: float
    viscosity: float = 0.0

    @property
    def area(self) -> float:
        return np.pi * self.diameter**2 / 4

    @property
    def inertia(self) -> float:
        return np.pi * self.diameter**4 / 64


def driven_cable(
    rod: Rod, place: np.ndarray, tangent: np.ndarray, step: float, gravity: float, elements: int
) -> np.ndarray:
    """Path of the tip in the world, (t, 3) m, of cubic ANCF elements without torsion.

    The root's place (t, 3) and tangent (t, 3) are given at equal steps; the first hold for the static start. Gravity
    acts along −Z, m/s².
    """
    system = exudyn.SystemContainer().AddSystem()
    ground = _coordinate(system, system.AddNode(items.NodePointGround()), 0)
    nodes = [
        system.AddNode(items.NodePointSlope1(referenceCoordinates=[*(place[0] + x * tangent[0]), *tangent[0]]))
        for x in np.linspace(0, rod.length, elements + 1)
    ]
    bending, axial = rod.modulus * rod.inertia, rod.modulus * rod.area
    for pair in pairwise(nodes):
        cable = system.AddObject(
            items.ObjectANCFCable(
                length=rod.length / elements,
                massPerLength=rod.density * rod.area,
                bendingStiffness=bending,
                axialStiffness=axial,
                bendingDamping=rod.viscosity * bending,
                axialDamping=rod.viscosity * axial,
                nodeNumbers=list(pair),
            )
        )
        mass = system.AddMarker(items.MarkerBodyMass(bodyNumber=cable))
        system.AddLoad(items.LoadMassProportional(markerNumber=mass, loadVector=[0, 0, -gravity]))
    moving = [False]
    path = np.hstack([place - place[0], tangent - tangent[0]])
    for coordinate in range(6):
        follow = _lookup(path[:, coordinate].tolist(), step, moving)
        markers = [ground, _coordinate(system, nodes[0], coordinate)]
        system.AddObject(items.ObjectConnectorCoordinate(markerNumbers=markers, offsetUserFunction=follow))
    sensor = _sensor(system, nodes[-1], exudyn.OutputVariableType.Position)
    system.Assemble()
    settings = dynamic_settings(step, len(path) - 1, "EigenDense")
    system.SolveStatic(settings, updateInitialValues=True)
    moving[0] = True
    system.SolveDynamic(settings)
    return system.GetSensorStoredData(sensor)[-len(path) :, 1:]


def _lookup(values: list[float], step: float, moving: list[bool]) -> Callable[..., float]:
    """Value at the nearest step of a table, zero until it moves."""
    last = len(values) - 1

    def follow(mbs, t, itemNumber, lOffset):  # type: ignore[no-untyped-def]
        return values[min(int(t / step + 0.5), last)] if moving[0] else 0.0

    return follow


@dataclass(frozen=True)
class HubAndBody:
    """A beam on a free hub, and a rigid body at its tip with its centre off the axis; SI."""

    length: float
    area: float
    inertia: float
    density: float
    modulus: float
    radius: float
    hub_inertia: float
    mass: float
    moments: tuple[float, float, float]
    offset: tuple[float, float, float]


def hub_with_body(
    case: HubAndBody,
    torque: Callable[[float], float],
    torsion: float,
    end: float,
    step: float,
    elements: int,
    angle: Callable[[float], float] | None = None,
    tolerance: float = 1e-6,
) -> tuple[np.ndarray, np.ndarray]:
    """Times (t,) s; displacement of the tip m, force N and moment N m of the hub on the root in its axes, and its angle
    rad, (t, 10).

    `torsion` is the torsional stiffness, N m²; the stiffness in shear is that in tension. A hub whose `angle` is given,
    rad, is driven by it, and by no torque. `tolerance` is that of Newton's method, of forces in N.
    """
    system = exudyn.SystemContainer().AddSystem()
    section = exudyn.BeamSection()
    axial, bending = case.modulus * case.area, case.modulus * case.inertia
    section.stiffnessMatrix = np.diag([axial, axial, axial, torsion, bending, bending])
    section.massPerLength = case.density * case.area
    section.inertia = case.density * case.inertia * np.diag([2.0, 1.0, 1.0])

    def node(x: float) -> object:
        return system.AddNode(items.NodeRigidBodyEP(referenceCoordinates=[x, 0, 0, *eulerParameters0]))

    nodes = [node(case.radius + x) for x in np.linspace(0, case.length, elements + 1)]
    for pair in pairwise(nodes):
        length = case.length / elements
        system.AddObject(items.ObjectBeamGeometricallyExact(nodeNumbers=list(pair), length=length, sectionData=section))
    system.AddObject(items.ObjectRigidBody(nodeNumber=nodes[-1], **_about_node(case)))
    centre = node(0.0)
    hub = system.AddObject(
        items.ObjectRigidBody(mass=1.0, inertia=[1, 1, case.hub_inertia, 0, 0, 0], nodeNumber=centre)
    )
    ground, axle, root = (
        system.AddMarker(items.MarkerBodyRigid(bodyNumber=system.AddObject(items.ObjectGround()))),
        system.AddMarker(items.MarkerNodeRigid(nodeNumber=centre)),
        system.AddMarker(items.MarkerNodeRigid(nodeNumber=nodes[0])),
    )
    rim = system.AddMarker(items.MarkerBodyRigid(bodyNumber=hub, localPosition=[case.radius, 0, 0]))
    axis = {"constrainedAxes": [1, 1, 1, 1, 1, 0]}
    if angle is not None:

        def driven(mbs, t, itemNumber, parameters):  # type: ignore[no-untyped-def]
            return [0, 0, 0, 0, 0, angle(t)]

        axis = {"offsetUserFunction": driven}
    system.AddObject(items.ObjectJointGeneric(markerNumbers=[ground, axle], **axis))
    clamp = system.AddObject(items.ObjectJointGeneric(markerNumbers=[rim, root]))

    def drive(mbs, t, loadVector):  # type: ignore[no-untyped-def]
        return [0.0, 0.0, torque(t)]

    system.AddLoad(items.LoadTorqueVector(markerNumber=axle, loadVector=[0, 0, 1], loadVectorUserFunction=drive))
    outputs, stored = exudyn.OutputVariableType, {"storeInternal": True, "writeToFile": False}
    sensors = [
        _sensor(system, nodes[-1], outputs.Position),
        _sensor(system, centre, outputs.RotationMatrix),
        *(
            system.AddSensor(items.SensorObject(objectNumber=clamp, outputVariableType=output, **stored))
            for output in (outputs.ForceLocal, outputs.TorqueLocal)
        ),
    ]
    system.Assemble()
    system.SolveDynamic(dynamic_settings(step, round(end / step), "EigenSparse", tolerance))
    time = system.GetSensorStoredData(sensors[0])[:, 0]
    tip, turned, force, multipliers = (system.GetSensorStoredData(sensor)[:, 1:] for sensor in sensors)
    axes = turned.reshape(-1, 3, 3)
    moved = np.einsum("tij,ti->tj", axes, tip) - [case.radius + case.length, 0, 0]
    # The joint's torques are multipliers of z0·y1, z0·x1 and x0·y1: with the force's sign, of turns about x, −y and −z.
    moment = multipliers * [-1, 1, 1]
    angle = np.unwrap(np.arctan2(axes[:, 1, 0], axes[:, 0, 0]))
    return time, np.column_stack([moved, -force, moment, angle])


def _about_node(case: HubAndBody) -> dict[str, object]:
    """The body's properties about the tip: Exudyn's order of moments is xx, yy, zz, yz, xz, xy."""
    offset = np.array(case.offset)
    about = np.diag(case.moments) + case.mass * (offset @ offset * np.eye(3) - np.outer(offset, offset))
    moments = [about[i] for i in ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))]
    return {"mass": case.mass, "centerOfMass": list(offset), "inertia": moments}


def _coordinate(system: exudyn.MainSystem, node: object, coordinate: int) -> object:
    return system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=coordinate))


def _sensor(system: exudyn.MainSystem, node: object, output: object) -> object:
    stored = {"storeInternal": True, "writeToFile": False}
    return system.AddSensor(items.SensorNode(nodeNumber=node, outputVariableType=output, **stored))


def dynamic_settings(step: float, steps: int, linear: str, tolerance: float = 1e-6) -> exudyn.SimulationSettings:
    settings = exudyn.SimulationSettings()
    integration = settings.timeIntegration
    integration.endTime, integration.numberOfSteps, integration.adaptiveStep = step * steps, steps, False
    integration.newton.relativeTolerance, integration.newton.absoluteTolerance = 1e-6, tolerance
    integration.newton.useModifiedNewton = True
    integration.generalizedAlpha.spectralRadius = 0.8
    # In the static start rounding at 3 m from the axis leaves 1e-8 N.
    settings.staticSolver.newton.relativeTolerance = settings.staticSolver.newton.absoluteTolerance = 1e-6
    settings.staticSolver.verboseMode = 0
    settings.linearSolver.solverType = getattr(exudyn.LinearSolverType, linear)
    settings.parallel.numberOfThreads = 1
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = step
    return settings
