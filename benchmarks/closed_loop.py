"""A satellite under a sampled controller, gbeam beside Exudyn, in turn in one process.

    python benchmarks/closed_loop.py

Hub of 50 kg m² with a panel of 3 × 0.5 × 0.02 m, a PD law sampled at 100 Hz with a limit, 20 s. In Exudyn the law is a
user function of Python that holds its torque between samples; planar cubic ANCF elements on a rigid hub. The difference
of the hub's angle from a converged run of each code itself is printed beside its time: processor time, s, of building
and solving, the first call and the quickest of three more.
"""

# a file of this folder has the name of the package

from __future__ import annotations

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

import gbeam as gb
from benchmarks.exudyn_hub_beam import cable, clamp, node

LENGTH, WIDTH, THICKNESS, DENSITY, MODULUS = 3.0, 0.5, 0.02, 2700.0, 70e9
RADIUS, INERTIA, SAMPLE, END, LIMIT = 0.5, 50.0, 0.01, 20.0, 20.0
GAINS, START = np.array([-60.0, -150.0]), -0.5


def ours(step: float, kind: str = "FOAM") -> np.ndarray:
    """Angle of the hub at its samples, by gbeam."""
    section, material = gb.Section.rectangle(WIDTH, THICKNESS), gb.Material(DENSITY, MODULUS)
    beam = gb.Beam(LENGTH, section, material, damping_ratio=0.0, rotary_inertia=False)
    hub = gb.RigidBody(1.0, (INERTIA,) * 3, points={"rim": gb.Place((RADIUS, 0, 0), (np.pi / 2, 0, 0))})
    joints = {
        "axis": gb.Joint("revolute", "hub", axes=[(0, 0, 1)], initial=START),
        "clamp": gb.Joint("fixed", "panel", "hub.rim"),
    }
    law = gb.Feedback(
        lambda t, y: GAINS @ y, ["axis.angle", "axis.angle_rate"], ["axis.angle"], sample=SAMPLE, limit=LIMIT
    )
    bodies: dict[str, Any] = {"hub": hub, "panel": gb.assemble(beam, kind, axial=1, y=0, z=3)}
    system = gb.System(bodies, joints, controllers={"law": law})
    response = gb.simulate(system, duration=END, step=step, estimate=False, loads=False)
    return response.coordinate("axis.angle")[:: round(SAMPLE / step)]


def theirs(elements: int, steps: int) -> np.ndarray:
    """Angle of the hub at its samples, by Exudyn."""
    container = exudyn.SystemContainer()
    system = container.AddSystem()
    ground = system.AddMarker(
        items.MarkerNodeCoordinate(nodeNumber=system.AddNode(items.NodePointGround()), coordinate=0)
    )
    centre = system.AddNode(items.NodeRigidBody2D(referenceCoordinates=[0, 0, 0], initialCoordinates=[0, 0, START]))
    hub = system.AddObject(items.ObjectRigidBody2D(mass=1.0, inertia=INERTIA, nodeNumber=centre))
    for coordinate in (0, 1):
        marker = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=centre, coordinate=coordinate))
        system.AddObject(items.ObjectConnectorCoordinate(markerNumbers=[ground, marker]))
    nodes = [node(system, x, START) for x in np.linspace(RADIUS, RADIUS + LENGTH, elements + 1)]
    area, second = WIDTH * THICKNESS, WIDTH * THICKNESS**3 / 12
    values = LENGTH / elements, DENSITY * area, MODULUS * second, MODULUS * area
    cables = [cable(system, pair, *values) for pair in pairwise(nodes)]
    clamp(system, hub, RADIUS, cables[0])
    kind = exudyn.OutputVariableType.Coordinates
    sensor = system.AddSensor(items.SensorNode(nodeNumber=centre, storeInternal=True, outputVariableType=kind))
    held = {"sample": -1, "torque": 0.0}

    def torque(mbs, t, load):  # type: ignore[no-untyped-def]  # names that Exudyn checks
        sample = int((t - 1e-9) / SAMPLE)
        if sample > held["sample"]:
            angle = mbs.GetNodeOutput(centre, exudyn.OutputVariableType.Coordinates)[2]
            rate = mbs.GetNodeOutput(centre, exudyn.OutputVariableType.Coordinates_t)[2]
            held.update(sample=sample, torque=float(np.clip(GAINS @ [angle, rate], -LIMIT, LIMIT)))
        return held["torque"]

    turning = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=centre, coordinate=2))
    system.AddLoad(items.LoadCoordinate(markerNumber=turning, load=1.0, loadUserFunction=torque))
    system.Assemble()
    settings = exudyn.SimulationSettings()
    settings.timeIntegration.numberOfSteps, settings.timeIntegration.endTime = steps, END
    settings.timeIntegration.generalizedAlpha.spectralRadius = 0.9
    newton = settings.timeIntegration.newton
    newton.useModifiedNewton, newton.relativeTolerance, newton.absoluteTolerance = True, 1e-5, 1e-5
    settings.timeIntegration.verboseMode = 0
    settings.parallel.numberOfThreads = 1
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = 0.0
    system.SolveDynamic(settings)
    data = system.GetSensorStoredData(sensor)
    return np.asarray(data[:: (len(data) - 1) // round(END / SAMPLE), 3])


def timed(run: Callable[[], np.ndarray]) -> tuple[list[float], np.ndarray]:
    """Processor times of four calls, and the answer."""
    times = []
    for _ in range(4):
        start = time.process_time()
        answer = run()
        times.append(time.process_time() - start)
    return times, answer


def main() -> None:
    """Print a line for each setting."""
    references = {"gbeam": ours(SAMPLE / 8), "Exudyn": theirs(8, round(8 * END / SAMPLE))}
    size = np.abs(references["gbeam"]).max()
    print(
        f"converged runs differ by {np.abs(references['gbeam'] - references['Exudyn']).max() / size:.1e} of the angle"
    )
    settings: tuple[tuple[str, str, Callable[[], np.ndarray]], ...] = (
        ("gbeam", "FOAM, axial shapes in, 10 ms", lambda: ours(SAMPLE)),
        ("gbeam", "exact, 10 ms", lambda: ours(SAMPLE, "exact")),
        ("Exudyn", "4 elements, 10 ms", lambda: theirs(4, round(END / SAMPLE))),
        ("Exudyn", "4 elements, 5 ms", lambda: theirs(4, round(2 * END / SAMPLE))),
        ("Exudyn", "4 elements, 2.5 ms", lambda: theirs(4, round(4 * END / SAMPLE))),
        ("Exudyn", "8 elements, 2.5 ms", lambda: theirs(8, round(4 * END / SAMPLE))),
    )
    for code, words, run in settings:
        times, answer = timed(run)
        error = np.abs(answer - references[code]).max() / size
        print(f"{code:7} {words:30} first {times[0]:6.3f} s, later {min(times[1:]):6.3f} s, error {error:.1e}")


if __name__ == "__main__":
    main()
