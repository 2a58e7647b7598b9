"""The flying rods and the right-angle cantilever of Simo and Vu-Quoc (1986, 1988) in Exudyn's geometrically exact
beams, against gbeam's exact model.

A free rod of length 10, pushed at its lower end by a force and a moment, flies off, turns over and bends far: in a
plane, and in space. Two legs of length 10, one of them clamped, at a right angle are pushed at the elbow, out of their
plane, and swing freely once the force is gone. The papers print curves only, of beams without units. Exudyn's answer is
extrapolated from 20 and 40 elements a beam, whose errors fall with the square of an element; "mesh" is what the two
differ by.

The right angle's printed curves, digitised by others, are up to 0.3 from both codes' on the elbow's first rise, meet
its first peak, and are up to 0.9 away later. That is not their mesh and not their step: with 4 to 40 elements a leg,
and with 5 and 10 in steps of 0.1 s, Exudyn's elbow stays 0.7 to 0.9 away. Nor is it the inertia: with half of that
about a leg's axis, or twice all, gbeam's would be 6 and more away.

The extreme printed as -3.87 near 10.8 s, -4.06 here, is -4.06 in Exudyn's own example of this cantilever too. A
twentieth of a stiffness or a rotary inertia moves it by 0.1 at most, of mass or force by 0.15. Longer steps do make it
smaller: by Newmark's trapezoidal rule with two-node elements it is -4.06 in steps of 0.05 and 0.1 s, -3.96 in steps
of 0.25 s with ten elements a leg, -3.80 in steps of 0.5 s with five; but such steps bring the rest of the curve no
nearer (0.41 rms in steps of 0.25 s, 0.32 in short ones). What is read off the print is as uncertain: another's reading
(hortulanusT/dynLattice, transient/test3) is up to 0.2 from this one, 0.064 rms, and 0.05 where all is at rest.

No data of the problem were found that make the curve. Of gbeam's 0.35 rms at the points that were read, each of
stiffness, mass and the first leg's length, fitted alone, leaves 0.28 to 0.31, and all twelve data together, to first
order and within 12 % each, 0.21: three times what reading leaves. So no data near the given ones were found that make
what was printed. It is a hard test, too: 1 % of a leg's length moves the elbow by 0.21 rms.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import Any

import exudyn
import numpy as np
from exudyn import itemInterface as items
from exudyn.utilities import RotationMatrix2EulerParameters

import gbeam as gb
from validation.table import Row

TITLE = "Exudyn: flying rods and a right-angle cantilever"
NEEDS = ("exudyn", "numpy", "scipy")
LENGTH, MASS = 10.0, np.diag([1.0, 1.0, 1.0, 20.0, 10.0, 10.0])
UP = np.pi - np.arctan2(8.0, 6.0)  # from (6, 0, 0) to (0, 0, 8)
SAMPLE = 0.02
Load = Callable[[float], list[float]]


# Out of the plane, extremes at times, s: of curves digitised by others
CURVES = "Simo and Vu-Quoc 1988, digitised in luizpancini/AeroBeams.jl, elbowFrame"
PRINTED = (
    ("elbow", "first.tip", {3.0479: 5.5035, 10.819: -3.8714, 25.160: 6.1051}),
    ("tip", "second.tip", {7.6655: 8.2947, 15.987: -9.6734}),
)


def stiffness(bending: float, stretching: float = 1e4) -> np.ndarray:
    """EA = GA, and EI = GJ."""
    return np.diag([stretching] * 3 + [bending] * 3)


def rows() -> Iterator[Row]:
    """In a plane, and in space; then the right angle."""
    yield from flying("rod in a plane", 1e2, lambda t: 80.0 if t < 2.5 else 0.0, 0.0, 8.0)
    yield from flying("rod in space", 5e2, lambda t: float(np.interp(t, [0, 2.5, 5], [0, 200, 0])), 0.5, 6.0)
    yield from right_angle()


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
    response = gb.simulate(system, duration=end, step=SAMPLE, estimate=False, initial="undeformed")
    push = [lambda t, u=u: list(size(t) * u) for u in unit]
    meshes = [_flying_in_exudyn(bending, *push, end, elements) for elements in (20, 40)]
    yield from _compared(case, response.at("rod.tip"), meshes, response.time)
    assert response.invariants is not None
    late = response.time > 5.01
    held = response.invariants.angular_momentum[late]
    drift = float(np.ptp(held, axis=0).max() / np.abs(held).max())
    words = "drift of the angular momentum once pushed, over itself"
    yield Row(case, words, 0.0, drift, "", 1e-3, "closed form; steps of 20 ms")


def _compared(
    case: str, ours: np.ndarray, meshes: list[np.ndarray], time: np.ndarray, name: str = "tip"
) -> Iterator[Row]:
    """A point, the tip, where it has moved farthest along each axis, and the largest difference at any time."""
    coarse, fine = meshes
    reference = fine + (fine - coarse) / 3
    mesh, source = float(np.abs(fine - coarse).max()), "geometrically exact elements, two meshes, extrapolated"
    for axis in range(3):
        moved, mine = (each[:, axis] - each[0, axis] for each in (reference, ours))
        at = int(np.abs(moved).argmax())
        if abs(moved[at]) > 1e-3:
            words = f"{name} moved along {'xyz'[axis]} at {time[at]:g} s"
            yield Row(case, words, moved[at], mine[at], "", 2e-3, source, f"mesh {mesh:.1g}")
    worst = float(np.linalg.norm(ours - reference, axis=1).max())
    yield Row(case, f"largest difference of the {name} at any time", 0.0, worst, "", 0.05, source, f"mesh {mesh:.1g}")


def _flying_in_exudyn(bending: float, force: Load, moment: Load, end: float, elements: int) -> np.ndarray:
    """Places of the tip every SAMPLE."""
    axes = np.array([[np.cos(UP), 0, -np.sin(UP)], [0, 1, 0], [np.sin(UP), 0, np.cos(UP)]])
    system = exudyn.SystemContainer().AddSystem()
    nodes = _beam(system, stiffness(bending), np.array([6.0, 0.0, 0.0]), axes, elements)
    lower = system.AddMarker(items.MarkerNodeRigid(nodeNumber=nodes[0]))
    _push(system, lower, items.LoadForceVector, force)
    _push(system, lower, items.LoadTorqueVector, moment)
    (tip,) = _paths(system, [nodes[-1]], end, SAMPLE / 10, 1e-8)
    return tip


def right_angle() -> Iterator[Row]:
    """A force at the elbow, which grows to 50 within 1 s and is gone after 2 s."""
    case, end, times, sizes = "right-angle cantilever", 30.0, [0.0, 1.0, 2.0, 30.0], [0.0, 50.0, 0.0, 0.0]
    beam = gb.Beam(LENGTH, gb.Section.of_matrices(stiffness(1e3, 1e6), MASS), damping_ratio=0.0)
    leg = gb.assemble(beam, "exact", axial=1, y=6, z=6, twist=6, shear_y=2, shear_z=2)
    corner = gb.Joint("fixed", "second", "first.tip", turn=(0.0, 0.0, np.pi / 2))
    joints = {"clamp": gb.Joint("fixed", "first"), "corner": corner}
    push = {"push": gb.PointForce("first.tip", gb.vector(z=gb.tabulated(np.array(times), np.array(sizes))))}
    system = gb.System({"first": leg, "second": leg}, joints, push)
    response = gb.simulate(system, duration=end, step=2 * SAMPLE, estimate=False, initial="undeformed")
    coarse, fine = (_right_angle_in_exudyn(end, elements) for elements in (20, 40))
    for k, (name, point) in enumerate((("elbow", "first.tip"), ("tip", "second.tip"))):
        yield from _compared(case, response.at(point), [coarse[k][::2], fine[k][::2]], response.time, name)
    energy = response.invariants.energy[response.time > 2.01].sum(axis=1)
    drift = float(np.ptp(energy) / energy.max())
    yield Row(case, "drift of the energy once pushed, over itself", 0.0, drift, "", 1e-3, "closed form; steps of 40 ms")
    for name, point, extremes in PRINTED:
        moved = response.at(point)[:, 2]
        for time, theirs in extremes.items():
            near = moved[np.abs(response.time - time) < 1.0]
            ours = float(near.max() if theirs > 0 else near.min())
            words = f"{name} out of the plane, extreme near {time:.1f} s"
            tried = "-3.96 in steps of 0.25 s; no data near these found that make the printed curve"
            remark = tried if theirs == -3.8714 else ""
            yield Row(case, words, theirs, ours, "", 0.01, CURVES, remark)


def _right_angle_in_exudyn(end: float, elements: int) -> list[np.ndarray]:
    """Places of the elbow and of the tip every SAMPLE."""
    system = exudyn.SystemContainer().AddSystem()
    turned = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    first = _beam(system, stiffness(1e3, 1e6), np.zeros(3), np.eye(3), elements)
    second = _beam(system, stiffness(1e3, 1e6), LENGTH * np.eye(3)[0], turned, elements)
    ground = system.AddMarker(items.MarkerBodyRigid(bodyNumber=system.AddObject(items.ObjectGround())))
    root, elbow = (system.AddMarker(items.MarkerNodeRigid(nodeNumber=first[at])) for at in (0, -1))
    back = exudyn.HT(rotation=turned.T, translation=[0, 0, 0])
    onward = system.AddMarker(items.MarkerNodeRigid(nodeNumber=second[0], localHT=back))
    for pair in ([ground, root], [elbow, onward]):
        system.AddObject(items.ObjectJointGeneric(markerNumbers=pair))
    _push(system, elbow, items.LoadForceVector, lambda t: [0.0, 0.0, float(np.interp(t, [0, 1, 2], [0, 50, 0]))])
    return _paths(system, [first[-1], second[-1]], end, SAMPLE / 2, 1e-6)


def _beam(system: Any, rigidity: np.ndarray, start: np.ndarray, axes: np.ndarray, elements: int) -> list[Any]:
    """Nodes of a straight beam along the first of its axes (columns)."""
    section = exudyn.BeamSection()
    section.stiffnessMatrix, section.massPerLength, section.inertia = rigidity, 1.0, MASS[3:, 3:]
    turn = list(RotationMatrix2EulerParameters(axes))
    places = start + np.linspace(0.0, LENGTH, elements + 1)[:, None] * axes[:, 0]
    nodes = [system.AddNode(items.NodeRigidBodyEP(referenceCoordinates=[*place, *turn])) for place in places]
    for pair in pairwise(nodes):
        length = LENGTH / elements
        system.AddObject(items.ObjectBeamGeometricallyExact(nodeNumbers=list(pair), length=length, sectionData=section))
    return nodes


def _push(system: Any, marker: Any, kind: Any, load: Load) -> None:
    """Put a force or a torque, given over time, on a marker."""
    system.AddLoad(kind(markerNumber=marker, loadVector=[1, 1, 1], loadVectorUserFunction=lambda _, t, v: load(t)))


def _paths(system: Any, nodes: list[Any], end: float, step: float, tolerance: float) -> list[np.ndarray]:
    """Integrate; places of nodes every SAMPLE."""
    place = exudyn.OutputVariableType.Position
    stored = {"outputVariableType": place, "storeInternal": True, "writeToFile": False}
    sensors = [system.AddSensor(items.SensorNode(nodeNumber=node, **stored)) for node in nodes]
    system.Assemble()
    settings = exudyn.SimulationSettings()
    integration = settings.timeIntegration
    integration.endTime, integration.numberOfSteps, integration.adaptiveStep = end, round(end / step), False
    integration.newton.relativeTolerance = integration.newton.absoluteTolerance = tolerance
    integration.newton.useModifiedNewton = True
    integration.generalizedAlpha.spectralRadius = 0.9
    integration.verboseMode = 0
    settings.solution.sensors.writePeriod, settings.solution.file.write = SAMPLE, False
    settings.linearSolver.solverType = exudyn.LinearSolverType.EigenSparse
    system.SolveDynamic(settings)
    paths = [system.GetSensorStoredData(sensor)[:, 1:] for sensor in sensors]
    assert len(paths[0]) == round(end / SAMPLE) + 1
    return paths
