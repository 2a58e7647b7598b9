"""One result of each kind, made once."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

import gbeam as gb
from gbeam.results import (
    Accounting,
    AxesResult,
    Candidate,
    CommandRun,
    FittedColumn,
    LimitUse,
    MachinePlan,
    ModelRow,
    ModelStudy,
    Parameter,
    Placement,
    Requirement,
)

from ..solids.bodies import STEEL, block, solid

BEAM = gb.Beam(
    0.3, gb.Section.rectangle(0.02, 0.004), gb.Material(2700.0, 70e9), [gb.PointMass(0.3, 0.01)], damping_ratio=0.01
)


@pytest.fixture(scope="package")
def every() -> dict[str, Any]:
    """One result of each kind."""
    structure, hub = (
        gb.assemble(BEAM, "FOAM", y=1, z=1, stations=(0.1, 0.2)),
        gb.Hub(radius=0.5, rate=gb.constant(10.0)),
    )
    time, x = np.linspace(0, 1, 5), np.ones((5, 3))
    uses = tuple(LimitUse(f"axis {i}", "rate", "rad/s", 2.0, 1.0 if i == 1 else np.inf, 0.5) for i in (1, 2, 3))
    axes = AxesResult(x, 2 * x, 3 * x, x, x + 0.1, np.zeros(5, bool), (), uses, (), 0.15)
    options = tuple(Candidate("upright", 0.06, at, 0.1, 0.2, (1.0, 2.0, 3.0), 0.5, uses[:1]) for at in (0.2, 0.1))
    values = {place: {"tip": 0.1} for place in ("best", "current", "middle")}
    rows = (
        ModelRow("exact", "slew", "done", "", (), 0.1, 0.5, 0.0, difference=0.0, time=time, history=0.1 * time),
        ModelRow("TLAM", "slew", "diverged", "too fast", ("a warning",)),
    )
    flight = gb.Flight(z=gb.constant(9.81))
    strong = dataclasses.replace(STEEL, yield_strength=3e8)
    bracket = solid(block("hexahedron20", (2, 1, 1), (0.2, 0.05, 0.03)), strong).reduced(modes=2, damping_ratio=0.02)
    box = gb.RigidSpecimen.box(
        2.0, (0.3, 0.2, 0.1), (0, 0, 0.05), bolts=[(0, 0, 0), (0.1, 0, 0), (0, 0.1, 0)], bolt_axis=(0, 0, 1)
    )
    return {
        "stress": bracket.stress(gb.simulate(bracket.structure, flight, duration=0.01, step=1e-4)),
        "specimen": box.loads(hub, 1.0, sample=0.5, name="spin"),
        "static": gb.static(structure, flight),
        "modes": gb.modes(structure, hub),
        "campbell": gb.campbell(structure, hub, speeds=np.linspace(0, 20, 3)),
        "critical": gb.critical_speed(structure, hub, upper=30.0),
        "path": gb.equilibrium_path(structure, flight, vary="motion"),
        "critical map": gb.critical_speed_map(BEAM, gb.Model("FOAM", 0, 1, 1), hub, [0.1], [0.1, 0.3], 30.0),
        "system": gb.linearize(structure, hub),
        "plan": MachinePlan(
            "arm", "flight", 3.3, "limits exceeded", axes.exceeding, time, axes,
            Accounting(0.05, 0.1, 0.0, (0.0, 1.0), 1.0, (), ()), 0.0, "upright",
        ),
        "placement": Placement("flight", "arm", {"tip": 1.0}, 0.3, options[0], options, 0.15, values),
        "models": ModelStudy("title", "exact", {"slew": "z"}, rows),
        **dict(zip(("Rest", "Modes", "ground"), _of_a_system(structure), strict=True)),
        "response": gb.simulate(structure, flight, duration=0.05, step=1e-3, name="flight"),
    }  # fmt: skip


def _of_a_system(structure: gb.Structure) -> tuple[Any, ...]:
    arm = gb.RigidBody(1.0, (0.1, 0.1, 0.1), points={"end": (0.3, 0.0, 0.0)})
    hinge = gb.Joint("revolute", "arm", axes=[(0, 0, 1)], stiffness=5.0, effort=gb.Sine(1.0, 0.05))
    joints = {"hinge": hinge, "clamp": gb.Joint("fixed", "beam", "arm.end")}
    system = gb.System({"arm": arm, "beam": structure}, joints)
    law = gb.Feedback(lambda t, y: -2.0 * y, ["hinge.angle_rate"], ["hinge.angle"], sample=0.01)
    driven = dataclasses.replace(system, controllers={"damper": law})
    return gb.static(system), gb.modes(system), gb.simulate(driven, duration=0.05, step=5e-3, estimate=False)


@pytest.fixture(scope="package")
def matrix(every: dict[str, Any]) -> dict[str, Any]:
    """One result of each kind, by the kind's name."""
    response = every["response"]
    named = {type(each).__name__: each for each in every.values()}
    return named | {
        "Study": gb.Study("title", {"flight": response, "ground": every["ground"]}, (gb.compare(response, response),)),
        "Comparison": gb.compare(response, response),
        **_searched(),
    }


def _searched() -> dict[str, Any]:
    """Kinds that searches and sweeps give, of made numbers."""
    two, pair, square = np.array([1.0, 2.0]), np.array([[0.5, 2.0], [1.0, 3.0]]), np.eye(2)
    free = np.array([False, True])
    column = FittedColumn("tip.z", "m", two, two, two, 0.1, 0.2)
    runs = tuple(CommandRun(name, two, 1.0, two, two, np.ones((2, 3)), 0.1, "done") for name in ("shaped", "ZVD"))
    names = ("beam.length", "beam.masses[0].mass")
    grid = (Parameter("beam.length", np.array([0.3, 0.4]), "m"),)
    ended = np.array(["done", "done"], dtype=object)
    return {
        "Fit": gb.Fit(
            "title", "taps.csv", names, ("m", "kg"), two, two, two, pair, square, square, pair, free, (column,), two,
            False, 7, 2.5,
        ),
        "Optimum": gb.Optimum(
            "title", "tip.z", "m", names, ("m", "kg"), two, two, pair, free, 1.0, 0.5, 0.01,
            (Requirement("stress", "Pa", -np.inf, 3.0, 1.0, 2.0),), pair, two, 9,
        ),
        "ShapedCommand": gb.ShapedCommand(
            "rate", 1.0, False, 2.0, two, two, np.inf, 0.1, two, two, runs, "FOAM", "exact", "slew"
        ),
        "Sensitivity": gb.Sensitivity(
            "title", "run", ("tip.z",), ("m",), two[:1], names, ("m", "kg"), two, pair[:1], pair[:1],
            ("exact", "difference"), np.array([[False, True]]),
        ),
        "Sweep": gb.Sweep(
            "title", "run", grid, {"tip.z": two}, {"tip.z": "m"}, ended, np.array(["", ""], dtype=object)
        ),
    }  # fmt: skip
