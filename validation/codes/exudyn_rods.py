"""The flying rods of Simo and Vu-Quoc (1986, 1988) in Exudyn's geometrically exact beams, against gbeam's exact model.

A free rod of length 10, pushed at its lower end by a force and a moment, flies off, turns over and bends far: in a
plane, and in space. The papers print curves only, of beams without units. Exudyn's answer is extrapolated from 20 and
40 elements, whose errors fall with the square of an element; "mesh" is what the two differ by.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise

import numpy as np

import gbeam as gb
from validation.table import Row

TITLE = "Exudyn: flying rods"
NEEDS = ("exudyn", "numpy", "scipy")
LENGTH, MASS = 10.0, np.diag([1.0, 1.0, 1.0, 20.0, 10.0, 10.0])
UP = np.pi - np.arctan2(8.0, 6.0)  # from (6, 0, 0) to (0, 0, 8)
SAMPLE = 0.02
Load = Callable[[float], list[float]]


def stiffness(bending: float) -> np.ndarray:
    """EA = GA = 1e4, and EI = GJ."""
    return np.diag([1e4] * 3 + [bending] * 3)


def rows() -> Iterator[Row]:
    """In a plane, and in space."""
    yield from flying("rod in a plane", 1e2, lambda t: 80.0 if t < 2.5 else 0.0, 0.0, 8.0)
    yield from flying("rod in space", 5e2, lambda t: float(np.interp(t, [0, 2.5, 5], [0, 200, 0])), 0.5, 6.0)


def flying(case: str, bending: float, size: Callable[[float], float], aside: float, end: float) -> Iterator[Row]:
    """A moment of this size about −y, `aside` of it about −z, and a tenth of it as a force along x."""
    unit = np.array([0.1, 0.0, 0.0]), np.array([0.0, -1.0, -aside])
    beam = gb.Beam(LENGTH, gb.Section.of_matrices(stiffness(bending), MASS), damping_ratio=0.0)
    sides = {"y": 10, "twist": 8, "shear_y": 8} if aside else {}
    rod = gb.assemble(beam, "exact", axial=6, z=10, shear_z=8, **sides)
    times = np.array([0.0, 2.5, 2.5 + 1e-9, 5.0, end])
    values = [size(t) for t in (0.0, 2.5 - 1e-12, 2.5 + 1e-9, 5.0, end)]
    force, moment = (
        gb.vector(**{a: gb.tabulated(times, np.array(values) * u) for a, u in zip("xyz", each, strict=True)})
        for each in unit
    )
    free = gb.Joint("free", "rod", at=(6.0, 0.0, 0.0), turn=(0.0, -UP, 0.0))
    system = gb.System({"rod": rod}, {"free": free}, {"push": gb.PointForce("rod.root", force, moment)})
    found = gb.simulate(system, duration=end, step=SAMPLE, estimate=False, initial="undeformed")
    push = [lambda t, u=u: list(size(t) * u) for u in unit]
    meshes = [_flying_in_exudyn(bending, *push, end, elements) for elements in (20, 40)]
    yield from _compared(case, found.at("rod.tip"), meshes, found.time)
    assert found.invariants is not None
    late = found.time > 5.01
    held = found.invariants.angular_momentum[late]
    drift = float(np.ptp(held, axis=0).max() / np.abs(held).max())
    words = "drift of the angular momentum once pushed, over itself"
    yield Row(case, words, 0.0, drift, "", 1e-3, "closed form; steps of 20 ms")


def _compared(case: str, ours: np.ndarray, meshes: list[np.ndarray], time: np.ndarray) -> Iterator[Row]:
    """The tip where it has moved farthest along each axis, and the largest difference at any time."""
    coarse, fine = meshes
    reference = fine + (fine - coarse) / 3
    mesh, source = float(np.abs(fine - coarse).max()), "geometrically exact elements, two meshes, extrapolated"
    for axis in range(3):
        moved, mine = (each[:, axis] - each[0, axis] for each in (reference, ours))
        at = int(np.abs(moved).argmax())
        if abs(moved[at]) > 1e-3:
            words = f"tip moved along {'xyz'[axis]} at {time[at]:g} s"
            yield Row(case, words, moved[at], mine[at], "", 2e-3, source, f"mesh {mesh:.1g}")
    worst = float(np.linalg.norm(ours - reference, axis=1).max())
    yield Row(case, "largest difference of the tip at any time", 0.0, worst, "", 0.05, source, f"mesh {mesh:.1g}")


def _flying_in_exudyn(bending: float, force: Load, moment: Load, end: float, elements: int) -> np.ndarray:
    """Places of the tip every SAMPLE."""
    import exudyn
    from exudyn import itemInterface as items
    from exudyn.utilities import RotationMatrix2EulerParameters

    axes = np.array([[np.cos(UP), 0, -np.sin(UP)], [0, 1, 0], [np.sin(UP), 0, np.cos(UP)]])
    system = exudyn.SystemContainer().AddSystem()
    section = exudyn.BeamSection()
    section.stiffnessMatrix, section.massPerLength, section.inertia = stiffness(bending), 1.0, MASS[3:, 3:]
    turn = list(RotationMatrix2EulerParameters(axes))
    places = [6.0, 0.0, 0.0] + np.linspace(0.0, LENGTH, elements + 1)[:, None] * axes[:, 0]
    nodes = [system.AddNode(items.NodeRigidBodyEP(referenceCoordinates=[*place, *turn])) for place in places]
    for pair in pairwise(nodes):
        length = LENGTH / elements
        system.AddObject(items.ObjectBeamGeometricallyExact(nodeNumbers=list(pair), length=length, sectionData=section))
    marker = system.AddMarker(items.MarkerNodeRigid(nodeNumber=nodes[0]))
    for kind, load in ((items.LoadForceVector, force), (items.LoadTorqueVector, moment)):
        system.AddLoad(
            kind(markerNumber=marker, loadVector=[1, 1, 1], loadVectorUserFunction=lambda _, t, v, f=load: f(t))
        )
    place = exudyn.OutputVariableType.Position
    sensor = system.AddSensor(
        items.SensorNode(nodeNumber=nodes[-1], outputVariableType=place, storeInternal=True, writeToFile=False)
    )
    system.Assemble()
    settings = exudyn.SimulationSettings()
    integration, samples = settings.timeIntegration, round(end / SAMPLE)
    integration.endTime, integration.numberOfSteps, integration.adaptiveStep = end, 10 * samples, False
    integration.newton.relativeTolerance = integration.newton.absoluteTolerance = 1e-8
    integration.newton.useModifiedNewton = True
    integration.generalizedAlpha.spectralRadius = 0.9
    integration.verboseMode = 0
    settings.solution.sensors.writePeriod, settings.solution.file.write = SAMPLE, False
    settings.linearSolver.solverType = exudyn.LinearSolverType.EigenSparse
    system.SolveDynamic(settings)
    stored = system.GetSensorStoredData(sensor)
    assert len(stored) == samples + 1
    return stored[:, 1:]
