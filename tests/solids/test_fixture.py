"""A meshed fixture with a meshed specimen on it: between two ways of seating it lies one mesh of both."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import gbeam as gb

from .bodies import STEEL, block, solid

FIXTURE, LENGTH, SIZE = 0.06, 0.2, (0.03, 0.02)
METAL = gb.Material(2700, 70e9, poissons_ratio=0.3)
OPTIONS: dict[str, Any] = {"duration": 0.4, "step": 5e-4, "integrator": "gauss", "estimate": False}


def of_both() -> gb.SolidModel:
    """One mesh, whose elements at the seam share their nodes."""

    def stretched(p: Any) -> Any:
        k = 13 * p[:, 0]  # of the elements along x
        return np.column_stack([np.where(k <= 3, k * FIXTURE / 3, FIXTURE + (k - 3) * LENGTH / 10), p[:, 1:]])

    mesh = block("hexahedron20", (13, 2, 2), (1.0, *SIZE), bent=stretched)
    middle = mesh.points[mesh.cells[0].data[:, :8]].mean(axis=1)[:, 0]
    mesh.cell_sets = {"near": [np.flatnonzero(middle < FIXTURE)], "far": [np.flatnonzero(middle > FIXTURE)]}
    return solid(mesh, {"near": METAL, "far": STEEL}).reduced(modes=16, damping_ratio=0.02)


def seated(**more: Any) -> gb.System:
    """The specimen clamped on an interface of the fixture."""
    mesh = block("hexahedron20", (3, 2, 2), (FIXTURE, *SIZE), groups={"top": lambda x: x[:, 0] > FIXTURE - 1e-9})
    parts = {
        "fixture": solid(mesh, METAL, interfaces={"top": "top"}, **more),
        "strip": solid(block("hexahedron20", (10, 2, 2), (LENGTH, *SIZE)), STEEL),
    }
    bodies = {name: each.reduced(modes=8, damping_ratio=0.02).structure for name, each in parts.items()}
    screws = gb.Joint("fixed", "strip", on="fixture.top")
    return gb.System(bodies, {"base": gb.Joint("fixed", "fixture"), "screws": screws})


def test_one_mesh_of_both_lies_between_a_seat_that_gives_and_a_rigid_one() -> None:
    """In its lowest frequencies, its deflection in flight and the stress at the foot of the fixture."""
    whole = of_both()
    soft, stiff = seated(), seated(links={"seat": "top"})
    low, high = (gb.modes(each, errors=False).frequency[:3] / whole.frequency[:3] - 1 for each in (soft, stiff))
    assert (low < 0).all() and (high > 0).all() and low.min() > -0.03 and high.max() < 0.01
    flight = gb.Flight(z=gb.trapezoid(78.5, jerk=392, start=0.05, hold=0.1))
    wanted, run = gb.simulate(whole.structure, flight, **OPTIONS), gb.simulate(stiff, flight, **OPTIONS)
    moved = np.abs(run.at("strip.tip") - run.at("strip.tip")[0]).max(axis=0)
    assert moved[2] == pytest.approx(wanted.peaks.max_abs[2], rel=0.02)
    assert wanted.solid is not None and run.bodies["fixture"].solid.worst.node == wanted.solid.worst.node
    assert run.bodies["fixture"].solid.worst.von_mises == pytest.approx(wanted.solid.worst.von_mises, rel=0.005)
