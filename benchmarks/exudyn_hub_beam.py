"""The hub-beam of 2009 in Exudyn: cubic ANCF elements in the inertial frame, on a rigid hub.

What makes it fast was found by search: the build without range checks, drives as symbolic functions, dense
factorisation by Eigen, Newton with tolerances of 1e-6 and an old Jacobian, few points in the elements.
"""
# ruff: noqa: E402  # Exudyn reads its switch when it is imported

from __future__ import annotations

import sys
import time
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

sys.exudynFast = True  # type: ignore[attr-defined]
import exudyn
from exudyn import itemInterface as items
from exudyn import symbolic
from exudyn.advancedUtilities import CreateSymbolicUserFunction

# 2009, Table 1
LENGTH, DENSITY, AREA, YOUNG, INERTIA = 8.0, 2766.7, 7.2968e-5, 6.8952e10, 8.2189e-9
HUB_RADIUS, HUB_INERTIA = 0.5, 200.0
STIFF = 1e9  # N m², N: bending and axial stiffness of a hub that is an element


@dataclass(frozen=True)
class Drive:
    """A hub's drive: a rate that rises to `rate` rad/s (43) or a torque of one sine (44), over `duration` s.

    `mass` is at the tip, kg; the run ends at `end` s.
    """

    duration: float
    end: float
    rate: float | None = None
    torque: float | None = None
    mass: float = 0.0


@dataclass(frozen=True)
class Setting:
    """Settings of Exudyn.

    `hub`: rigid, a body and a joint; element, a stiff element of the hub's inertia; node, the root's node prescribed.
    `points`: Exudyn's useReducedOrderIntegration, 0 most points and 2 fewest. `method`: of its dynamic solvers.
    """

    hub: str
    elements: int
    steps: int
    points: int = 0
    contractivity: float = 0.5
    method: str = "GeneralizedAlpha"
    spectral_radius: float = 0.9
    modified_newton: bool = True
    tolerance: float = 1e-6
    linear: str = "EigenDense"

    def __str__(self) -> str:
        special = [
            f"rho {self.spectral_radius:g}" if self.spectral_radius != 0.9 else "",
            "" if self.modified_newton else "full Newton",
            f"tolerance {self.tolerance:g}" if self.tolerance != 1e-6 else "",
            self.linear if self.linear != "EigenDense" else "",
        ]
        words = [f"{self.elements} elements", f"{self.steps} steps", f"hub {self.hub}", f"points {self.points}"]
        return ", ".join([*words, f"contractivity {self.contractivity:g}", self.method, *filter(None, special)])


def node(system: Any, x: float, turned: float = 0.0) -> Any:
    """Node of a planar beam along x, turned about the origin by an angle at the start."""
    c, s = np.cos(turned), np.sin(turned)
    moved = [c * x - x, s * x, c - 1, s]
    return system.AddNode(items.NodePoint2DSlope1(referenceCoordinates=[x, 0, 1, 0], initialCoordinates=moved))


def cable(system: Any, nodes: Any, length: float, line: float, bending: float, axial: float, points: int = 0) -> Any:
    """Cubic ANCF element between two nodes, of a mass per length and stiffnesses."""
    return system.AddObject(
        items.ObjectANCFCable2D(
            length=length,
            massPerLength=line,
            bendingStiffness=bending,
            axialStiffness=axial,
            nodeNumbers=list(nodes),
            useReducedOrderIntegration=points,
        )
    )


def clamp(system: Any, hub: Any, at: float, element: Any, place: float = 0.0) -> None:
    """Hold a place along an element on one of a rigid hub."""
    markers = [
        system.AddMarker(items.MarkerBodyRigid(bodyNumber=body, localPosition=[x, 0, 0]))
        for body, x in ((hub, at), (element, place))
    ]
    system.AddObject(items.ObjectJointGeneric(markerNumbers=markers, constrainedAxes=[1, 1, 0, 0, 0, 1]))


class HubBeam:
    """The assembled system of a drive and a setting."""

    def __init__(self, drive: Drive, setting: Setting) -> None:
        self.drive, self.setting = drive, setting
        self.container = exudyn.SystemContainer()
        self.system = self.container.AddSystem()
        self._functions: list[object] = []  # Exudyn does not keep them alive
        self._ground = self.system.AddMarker(
            items.MarkerNodeCoordinate(nodeNumber=self.system.AddNode(items.NodePointGround()), coordinate=0)
        )
        self.nodes = [node(self.system, HUB_RADIUS + x) for x in np.linspace(0, LENGTH, setting.elements + 1)]
        values = LENGTH / setting.elements, DENSITY * AREA, YOUNG * INERTIA, YOUNG * AREA, setting.points
        self.elements = [cable(self.system, pair, *values) for pair in pairwise(self.nodes)]
        if drive.mass:
            self.system.AddObject(items.ObjectMassPoint2D(mass=drive.mass, nodeNumber=self.nodes[-1]))
        hub = {"rigid": self._rigid_hub, "element": self._element_hub, "node": self._prescribed_node}[setting.hub]()
        self._sensors = [
            self.system.AddSensor(
                items.SensorNode(
                    nodeNumber=node,
                    outputVariableType=exudyn.OutputVariableType.Coordinates,
                    storeInternal=True,
                    writeToFile=False,
                )
            )
            for node in (self.nodes[-1], hub)
        ]
        self.system.Assemble()

    def _function(self, name: str, item: object, function: object) -> object:
        built = CreateSymbolicUserFunction(self.system, function, name, item)
        self._functions.append(built)
        return built

    def _fix(self, node: object, coordinate: int, offset: object = None, rate: object = None) -> None:
        """Hold a coordinate of a node, or let it follow a function of time."""
        marker = self.system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=coordinate))
        item = self.system.AddObject(items.ObjectConnectorCoordinate(markerNumbers=[self._ground, marker]))
        for name, function in (("offsetUserFunction", offset), ("offsetUserFunction_t", rate)):
            if function is not None:
                self.system.SetObjectParameter(item, name, self._function(name, item, _of_time(function)))

    def _rigid_hub(self) -> object:
        node = self.system.AddNode(items.NodeRigidBody2D(referenceCoordinates=[0, 0, 0]))
        body = self.system.AddObject(items.ObjectRigidBody2D(mass=1.0, inertia=HUB_INERTIA, nodeNumber=node))
        self._fix(node, 0)
        self._fix(node, 1)
        clamp(self.system, body, HUB_RADIUS, self.elements[0])
        if self.drive.rate is not None:
            self._fix(node, 2, self._angle, self._rate)
            return node
        turning = self.system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=2))
        load = self.system.AddLoad(items.LoadCoordinate(markerNumber=turning, load=1.0))

        def torque(mbs, t, load):  # type: ignore[no-untyped-def]
            return self._torque(t)

        self.system.SetLoadParameter(load, "loadUserFunction", self._function("loadUserFunction", load, torque))
        return node

    def _element_hub(self) -> object:
        """A free hub without a joint: continuous with the beam in place and slope."""
        centre = node(self.system, 0.0)
        # Of a bar about its end: m L²/3 is the inertia.
        line = 3 * HUB_INERTIA / HUB_RADIUS**3
        bar = cable(self.system, [centre, self.nodes[0]], HUB_RADIUS, line, STIFF, STIFF, self.setting.points)
        self._fix(centre, 0)
        self._fix(centre, 1)
        marker = self.system.AddMarker(items.MarkerBodyRigid(bodyNumber=bar, localPosition=[0, 0, 0]))
        load = self.system.AddLoad(items.LoadTorqueVector(markerNumber=marker, loadVector=[0, 0, 1]))

        def torque(mbs, t, loadVector):  # type: ignore[no-untyped-def]
            return symbolic.Vector([symbolic.Real(0.0), symbolic.Real(0.0), self._torque(t)])

        function = self._function("loadVectorUserFunction", load, torque)
        self.system.SetLoadParameter(load, "loadVectorUserFunction", function)
        return self.nodes[0]

    def _prescribed_node(self) -> object:
        """The root's place and slope follow the hub; its strain is held at zero."""
        root = self.nodes[0]
        self._fix(root, 0, lambda t: HUB_RADIUS * (symbolic.cos(self._angle(t)) - 1))
        self._fix(root, 1, lambda t: HUB_RADIUS * symbolic.sin(self._angle(t)))
        self._fix(root, 2, lambda t: symbolic.cos(self._angle(t)) - 1)
        self._fix(root, 3, lambda t: symbolic.sin(self._angle(t)))
        return root

    def _angle(self, t):  # type: ignore[no-untyped-def]
        level, d = self.drive.rate, self.drive.duration
        wave = (d / (2 * np.pi)) ** 2 * (symbolic.cos(2 * np.pi / d * t) - 1)
        return symbolic.IfThenElse(t < d, level / d * (t * t / 2 + wave), level * (t - d / 2))

    def _rate(self, t):  # type: ignore[no-untyped-def]
        level, d = self.drive.rate, self.drive.duration
        rise = level / d * (t - d / (2 * np.pi) * symbolic.sin(2 * np.pi / d * t))
        return symbolic.IfThenElse(t < d, rise, symbolic.Real(level))

    def _torque(self, t):  # type: ignore[no-untyped-def]
        d = self.drive.duration
        wave = self.drive.torque * symbolic.sin(2 * np.pi / d * t)
        return symbolic.IfThenElse(t < d, wave, symbolic.Real(0.0))

    def solve(self) -> tuple[np.ndarray, np.ndarray]:
        """Times, and the tip's displacement across the beam in hub axes, m; empty where the solver fails.

        `angle` is the hub's from then on, rad, where the hub is rigid.
        """
        setting, settings = self.setting, exudyn.SimulationSettings()
        integration = settings.timeIntegration
        integration.endTime, integration.numberOfSteps = self.drive.end, setting.steps
        integration.adaptiveStep = False
        newton = integration.newton
        newton.relativeTolerance = newton.absoluteTolerance = setting.tolerance
        newton.useModifiedNewton = setting.modified_newton
        newton.modifiedNewtonContractivity = setting.contractivity
        integration.generalizedAlpha.spectralRadius = setting.spectral_radius
        settings.linearSolver.solverType = getattr(exudyn.LinearSolverType, setting.linear)
        settings.parallel.numberOfThreads = 1
        settings.solution.file.write = False
        settings.solution.sensors.writePeriod = self.drive.end / setting.steps
        try:
            done = self.system.SolveDynamic(settings, solverType=getattr(exudyn.DynamicSolverType, setting.method))
        except exudyn.SolverError:
            done = False
        return self._tip() if done else (np.zeros(0), np.zeros(0))

    def solve_by_default(self) -> tuple[np.ndarray, np.ndarray]:
        """Times and the tip's displacement as of `solve`, by Exudyn's own settings but the end and number of steps."""
        settings = exudyn.SimulationSettings()
        settings.timeIntegration.endTime = self.drive.end
        settings.timeIntegration.numberOfSteps = self.setting.steps
        settings.solution.file.write = False
        settings.solution.sensors.writePeriod = self.drive.end / self.setting.steps
        self.system.SolveDynamic(settings)
        return self._tip()

    def _tip(self) -> tuple[np.ndarray, np.ndarray]:
        """Times, and the tip's displacement across the beam in hub axes, m, as the sensors have stored them."""
        tip, hub = (self.system.GetSensorStoredData(sensor) for sensor in self._sensors)
        x, y = HUB_RADIUS + LENGTH + tip[:, 1], tip[:, 2]
        if self.setting.hub == "rigid":
            self.angle = angle = hub[:, 3]
            return tip[:, 0], np.cos(angle) * y - np.sin(angle) * x
        along, across = 1 + hub[:, 3], hub[:, 4]
        return tip[:, 0], (along * y - across * x) / np.hypot(along, across)


def _of_time(function):  # type: ignore[no-untyped-def]
    """A function of time with the arguments that Exudyn checks by name."""

    def follow(mbs, t, itemNumber, lOffset):  # type: ignore[no-untyped-def]
        return function(t)

    return follow


def timed(drive: Drive, setting: Setting, repeat: int) -> tuple[float, float, tuple[np.ndarray, np.ndarray]]:
    """Processor time, s, of building and solving once, and of the quickest of `repeat` more solutions; the answer."""
    began = time.process_time()
    system = HubBeam(drive, setting)
    answer = system.solve()
    first = time.process_time() - began
    later = []
    for _ in range(repeat if answer[0].size else 0):
        began = time.process_time()
        system.solve()
        later.append(time.process_time() - began)
    return first, min(later, default=np.nan), answer
