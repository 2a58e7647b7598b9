"""The camera's bracket in the F-16's turn of 8 g and on the centrifuge that imitates it, three seconds of each about
the largest load, in CalculiX and in gbeam on the same mesh. The base's acceleration is an even load of CalculiX's own;
the rest of the machine's field, α × r + ω × (ω × r), nine loads on the nodes by the mass matrix, one for each component
of its gradient: three to a run, whose answers are added, for CalculiX takes one history at a component of a node. It
sums 120 modes exactly, after the first load has risen slowly and been held. Its equations are linear, without the
stress of the load in the stiffness and without Coriolis forces, which gbeam has: under a thousandth of the flight,
where that stress is nothing, the two are as near as 120 modes allow. Displacement of the camera's edge, and the
largest von Mises stress at the 27 points of the element that is stressed most in flight.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

import gbeam as gb
from gbeam.analysis import gradients
from gbeam.results import von_mises
from gbeam.solids import chunks, mass_matrix
from validation.codes.calculix_solid import DAMPING, SMALL, moved, solid
from validation.table import Row

TITLE = "CalculiX: a bracket of solid elements in flight and on the centrifuge"
NEEDS = ("calculix-ccx", "numpy", "scipy", "scikit-fem", "meshio")
SCENARIO = Path(__file__).parents[2] / "examples" / "bracket.toml"
START, DURATION, SAMPLE = 4.0, 3.0, 1e-3  # s of the flight; the largest load is at 4.92 s
RISE, HOLD = 0.4, 0.3  # s, of the first load in CalculiX: 24 periods and 5 decays of the lowest mode
CLOSE, SAME = 1e-2, 1e-3
Loads = list[tuple[str | np.ndarray, np.ndarray]]


def field(motion: gb.Flight | gb.Centrifuge, time: np.ndarray) -> Iterator[Loads]:
    """Loads and histories of the inertia of everything on a base that moves, in runs that have one history at a
    component of a node.
    """
    mesh, base = solid(), motion.base(time)
    even: Loads = [
        (f"EALL, GRAV, 1., {', '.join(map(str, way))}", -a) for way, a in zip(np.eye(3), base.a_WO_B.T, strict=True)
    ]
    growth = gradients(base.w_WB_B, base.alpha_WB_B)
    if not growth.any():
        yield even
        return
    weighed = mass_matrix(mesh.points, mesh.blocks) @ mesh.points
    for j in range(3):
        along: Loads = [(weighed[:, [j]] * way, -growth[:, i, j]) for i, way in enumerate(np.eye(3))]
        yield [*(even if j == 0 else []), *along]


def rows() -> Iterator[Row]:
    """Over time, at the largest and where the two are farthest apart."""
    mesh = solid()
    model = mesh.reduced(modes=40, damping_ratio=DAMPING)
    motions = gb.read_scenario(SCENARIO, ['motion.centrifuge.start="idle"']).motions
    source, tip = f"{sum(len(block.nodes) for block in mesh.blocks)} C3D20", list(mesh.stations.values())[-1]
    lead = round((RISE + HOLD) / SAMPLE)
    rise = np.asarray(gb.SmoothStep(level=1.0, duration=RISE)(np.minimum(SAMPLE * np.arange(lead), RISE)))

    def flown(motion: gb.Flight | gb.Centrifuge) -> gb.Response:
        return gb.simulate(
            model.structure, motion, start=START, duration=DURATION, step=SAMPLE, integrator="gauss", estimate=False
        )

    runs = {name: flown(motions[name]) for name in ("flight", "centrifuge")}
    largest = int(np.linalg.norm(runs["flight"].tip, axis=1).argmax())
    chosen = int(points_of(model, runs["flight"].q[[largest]]).max(axis=(1, 2)).argmax())
    for name, ours in runs.items():
        clock = SAMPLE * np.arange(lead + len(ours.time))
        parts = []
        for loads in field(motions[name].over(START, START + DURATION), ours.time):
            led: Loads = [(load, np.append(rise * history[0], history)) for load, history in loads]
            parts.append(moved(tip, clock, led, chosen + 1))
        place, stress = (sum(each)[lead:] for each in zip(*parts, strict=True))
        case, over = f"{name}, {START:g} to {START + DURATION:g} s", von_mises(stress).max(axis=1)
        mine = points_of(model, ours.q, chosen)[0].max(axis=0)
        yield from compared(case, place, ours.tip, over, mine, CLOSE, source)
        if name == "flight":
            time, load = ours.time, SMALL * motions[name].base(ours.time).a_WO_B
            light = flown(gb.Flight(acceleration=gb.tabulated(time, load)))
            mine = points_of(model, light.q, chosen)[0].max(axis=0)
            less = f"{case}, {SMALL:g} of the load"
            yield from compared(less, place, light.tip / SMALL, over, mine / SMALL, SAME, source)


def compared(
    case: str, theirs: np.ndarray, ours: np.ndarray, stress: np.ndarray, mine: np.ndarray, close: float, source: str
) -> Iterator[Row]:
    """Largest sizes and the largest difference at any time, of displacements (t, 3) and stress (t,)."""
    pairs = [
        (f"displacement {axis} of the camera's edge", 1e6 * one, 1e6 * other, "µm")
        for axis, one, other in zip("xyz", theirs.T, ours.T, strict=True)
        if np.abs(one).max() > 0.05 * np.abs(theirs).max()
    ]
    for words, one, other, unit in [*pairs, ("von Mises stress", 1e-6 * stress, 1e-6 * mine, "MPa")]:
        size = np.abs(one).max()
        yield Row(case, f"{words}, largest", size, np.abs(other).max(), unit, close, source)
        away = 100 * np.abs(other - one).max() / size
        yield Row(case, f"{words}, largest difference over its size", 0.0, away, "%", 100 * close, source)


def points_of(model: gb.SolidModel, q: np.ndarray, chosen: int | None = None) -> np.ndarray:
    """Von Mises stress (e, points, t) Pa in all elements, or in one, at coordinates (t, n)."""
    parts, first = [], 0
    for part in chunks(model.mesh.points, model.mesh.blocks, "stiffness"):
        which = np.arange(len(part.nodes))
        which = which if chosen is None else which[which + first == chosen]
        first += len(part.nodes)
        if len(which):
            parts.append(von_mises(np.moveaxis(part.stress(model.shapes)[which] @ q.T, 2, -1)))
    return np.concatenate(parts)
