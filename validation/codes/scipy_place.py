"""Place of a solid on the centrifuge, beside a minimum that SciPy finds from the axes' angles alone.

The machine's angles over time are gbeam's; all else is not. The specimen's axes are SciPy's rotations by these angles,
every millisecond, differentiated twice as splines: RᵀR̈ is how the load grows from the control point, and Rᵀ(p̈ + g) of
the arm's end the load there. gbeam looks at every second of these times, and 0.1 % of the box's peak is between them.

The largest difference from the flight's load is that at any time at any corner of the specimen's hull, and its least
over all places in the specimen's box is SLSQP's. The places themselves are not compared: the least is flat along the
axis about which the machine turns most. For the force the place is the centre of mass.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from scipy.interpolate import make_interp_spline
from scipy.optimize import minimize
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

import gbeam as gb
from gbeam.results import Placement
from validation.codes.calculix_solid import model, solid
from validation.table import Row

SOURCE = "SLSQP, from the axes' angles"
TITLE = "SciPy: a solid's place on the centrifuge"
NEEDS = ("numpy", "scipy", "scikit-fem", "meshio")
ARM, G, END = 3.3, 9.80665, 3.5
PULL = gb.Sum((gb.constant(25.0), gb.trapezoid(30.0, jerk=40.0, start=0.5, hold=1.0)))
FLIGHT = gb.Flight(x=gb.trapezoid(12.0, jerk=30.0, start=0.4, hold=0.8), y=gb.constant(14.0), z=PULL)
SPELL = gb.ResponseSettings(start=0.0, duration=END, step=2e-3, integrator="gauss", estimate=False)
BOX = gb.RigidSpecimen(
    6.5, (0.17, 0.09, 0.05), np.diag([0.030, 0.063, 0.076]),
    corners=[(x, y, z) for x in (0, 0.32) for y in (0, 0.2) for z in (0, 0.12)],
)  # fmt: skip


def rows() -> Iterator[Row]:
    """A box of instruments by its corner, and the bracket of examples/bracket.py by its mesh."""
    mesh = solid()
    hull = mesh.points[ConvexHull(mesh.points).vertices]
    yield from placed("box", BOX.structure, np.array(BOX.corners))
    yield from placed("bracket", model().structure, hull)
    for axis, theirs, ours in zip("xyz", BOX.centre, found_for(BOX.structure, "root-shear").best.place, strict=True):
        yield Row("box, for the force", f"place, {axis}", 1e3 * theirs, 1e3 * ours, "mm", 1e-4, "the centre of mass")


def spun() -> gb.Centrifuge:
    """The machine, with the specimen by its root."""
    return gb.Centrifuge(
        FLIGHT, arm=ARM, control_point=(0.0, 0.0, 0.0), inverse="flat", gravity=True, smoothing=0.1, span=(0.0, END)
    )


def found_for(structure: gb.Structure, measure: str) -> Placement:
    """gbeam's place, upright."""
    machine = spun()
    choice = replace(gb.choice_of(machine, [0.1]), mountings=("upright",))
    return gb.place(structure, FLIGHT, choice, SPELL, {measure: 1.0}, current=machine)


def placed(case: str, structure: gb.Structure, ends: np.ndarray) -> Iterator[Row]:
    """The least difference, as gbeam states it and as it is at gbeam's place, and that with what the machine misses."""
    placement = found_for(structure, "load")
    growth, missed, peak = felt(spun())
    least = least_difference(growth / peak, ends)
    apart = np.einsum("tij,ej->tei", growth, ends - np.asarray(placement.best.place))
    at_place, whole = (float(np.linalg.norm(each, axis=-1).max() / peak) for each in (apart, apart + missed[:, None]))
    yield Row(
        case, "largest difference of the load, over its peak: least", least, placement.best.difference, "", 2e-3, SOURCE
    )
    yield Row(case, "and at gbeam's place", least, at_place, "", 2e-3, SOURCE)
    stated = placement.totals["best"]["load"]
    yield Row(case, "there, with what tracking misses", whole, stated, "", 2e-3, "from the axes' angles")


def felt(machine: gb.Centrifuge) -> tuple[np.ndarray, np.ndarray, float]:
    """Growth of the load from the control point, (t, 3, 3) 1/s², its difference there, (t, 3) m/s², and its peak."""
    commands = gb.axis_commands(machine, 1e-3)
    first, second, third = commands.angle.T
    axes = Rotation.from_euler("ZX", np.stack([first + second, third], axis=1)).as_matrix()
    arm = ARM * np.stack([np.cos(first), np.sin(first), 0 * first], axis=1)
    turned, moved = (make_interp_spline(commands.time, each, k=5).derivative(2) for each in (axes, arm))
    time = commands.time[(commands.time >= 0) & (commands.time <= END)]
    back = np.swapaxes(axes[(commands.time >= 0) & (commands.time <= END)], 1, 2)
    load = np.einsum("tij,tj->ti", back, moved(time) + np.array([0, 0, G]))
    in_flight = FLIGHT.base(time).a_WO_B
    return back @ turned(time), load - in_flight, float(np.linalg.norm(in_flight, axis=1).max())


def least_difference(growth: np.ndarray, ends: np.ndarray) -> float:
    """Least over places in the box of some ends (e, 3) of the largest |G (end − place)|.

    It is the least s with s ≥ |G (end − place)| of some times and ends, to which those are added that are worst there.
    """
    some = np.zeros((0, 3, 3)), np.zeros((0, 3))
    bounds = [*zip(ends.min(axis=0), ends.max(axis=0), strict=True), (0.0, None)]
    u = np.append(ends.min(axis=0), 0.0)
    for _ in range(50):
        sizes = np.linalg.norm(np.einsum("tij,ej->tei", growth, ends - u[:3]), axis=-1)
        if sizes.max() <= u[3] * (1 + 1e-9):
            return float(sizes.max())
        t, e = np.unravel_index(np.argsort(sizes, axis=None)[-20:], sizes.shape)
        some = np.concatenate([some[0], growth[t]]), np.concatenate([some[1], ends[e]])

        def slack(u: np.ndarray, some: tuple[np.ndarray, np.ndarray] = some) -> np.ndarray:
            return np.asarray(u[3] - np.linalg.norm(np.einsum("kij,kj->ki", some[0], some[1] - u[:3]), axis=1))

        u[3] = sizes.max()
        u = minimize(
            lambda u: u[3], u, jac=lambda u: np.eye(4)[3], method="SLSQP", bounds=bounds,
            constraints={"type": "ineq", "fun": slack}, options={"maxiter": 500, "ftol": 1e-14},
        ).x  # fmt: skip
    raise RuntimeError("the places do not converge")
