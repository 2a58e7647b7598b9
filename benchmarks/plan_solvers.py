"""The plan of a minute at 100 Hz by other solvers: processor time, cost, limits. Needs casadi, clarabel and osqp:

    python -m pip install casadi clarabel osqp
    python benchmarks/plan_solvers.py

Quadratic programs: the same sequence, each program solved by PIQP, Clarabel or OSQP. Ipopt: the whole problem at once,
with exact second derivatives by CasADi and the arm's power as it is, on the same splines; from coarse to fine knots as
well, and on the finest alone. Nothing else should run.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from importlib import import_module
from importlib.metadata import files
from typing import Any

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
import scipy.sparse
from plan_minute import TIME, f16, maneuvers

from gbeam import Centrifuge, Flight, MachineLimits, machines
from gbeam.constants import STANDARD_GRAVITY
from gbeam.motion import PiecewiseLinear
from gbeam.motion.centrifuge import course

sequential = import_module("gbeam.numerics.minimise")  # altered below
G, IDLE, LAST = STANDARD_GRAVITY, 1.4 * STANDARD_GRAVITY, 60.0
MACHINE = machines["specimen-3.3m"]
LIMITS = MachineLimits(*MACHINE.limits.axes, inertia=2000.0, power=80e3)


def clarabel(hessian: Any, slope: Any, rows: Any, lower: Any, upper: Any) -> Any:
    """One quadratic program by Clarabel, to PIQP's tolerances."""
    import clarabel

    above, below = upper < np.inf, lower > -np.inf
    matrix = scipy.sparse.csc_matrix(scipy.sparse.vstack([rows[above], -rows[below]]))
    bounds = np.append(upper[above], -lower[below])
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_feas, settings.tol_gap_abs, settings.tol_gap_rel = 1e-7, 1e-9, 1e-5
    cones = [clarabel.NonnegativeConeT(bounds.size)]
    solved = clarabel.DefaultSolver(
        scipy.sparse.csc_matrix(scipy.sparse.triu(hessian)), slope, matrix, bounds, cones, settings
    ).solve()
    return np.array(solved.x) if "Solved" in str(solved.status) else None


def osqp(hessian: Any, slope: Any, rows: Any, lower: Any, upper: Any) -> Any:
    """One quadratic program by OSQP, to a tolerance that it reaches."""
    import osqp

    solver = osqp.OSQP()
    solver.setup(
        scipy.sparse.csc_matrix(scipy.sparse.triu(hessian)), slope, scipy.sparse.csc_matrix(rows), lower, upper,
        verbose=False, eps_abs=1e-5, eps_rel=1e-5, max_iter=20_000, polishing=True,
    )  # fmt: skip
    solved = solver.solve()
    return np.array(solved.x) if solved.info.status_val in (1, 2) else None


def ipopt(cost: Any, limits: Any, x: Any) -> tuple[Any, float]:
    """The whole problem on one grid by Ipopt."""
    import casadi as ca

    def constant(matrix: Any) -> Any:
        columns = scipy.sparse.csc_matrix(matrix)
        columns.sort_indices()
        return ca.DM(ca.Sparsity(*columns.shape, columns.indptr.tolist(), columns.indices.tolist()), columns.data)

    unknown = ca.MX.sym("x", x.size)
    count = cost.weight.size
    states = ca.mtimes(constant(cost.states), unknown)
    rate, acceleration, yaw, roll = (states[k * count : (k + 1) * count] for k in range(4))
    radial, tangential, gravity = -cost.arm * rate**2, cost.arm * acceleration, cost.gravity
    along = radial * ca.cos(yaw) + tangential * ca.sin(yaw)
    across = tangential * ca.cos(yaw) - radial * ca.sin(yaw)
    load = along, across * ca.cos(roll) + gravity * ca.sin(roll), gravity * ca.cos(roll) - across * ca.sin(roll)
    error = [cost.weight * (imitated - flown) for imitated, flown in zip(load, cost.flight.T, strict=True)]
    value = (ca.sumsqr(ca.vertcat(*error)) + ca.dot(unknown, ca.mtimes(constant(cost.ease), unknown))) / 2
    kept = ca.vertcat(ca.mtimes(constant(limits.rows), unknown), rate * acceleration / limits.power)
    problem = {"x": unknown, "f": value, "g": kept}
    quiet = {"print_time": 0, "ipopt.print_level": 0, "ipopt.sb": "yes", "ipopt.tol": 1e-6, "ipopt.max_iter": 500}
    solved = ca.nlpsol("plan", "ipopt", problem, quiet)(
        x0=x, lbg=np.append(limits.lower, -np.ones(count)), ubg=np.append(limits.upper, np.ones(count))
    )
    commands = np.array(solved["x"]).ravel()
    return commands, cost.cost(commands)


def measure(load: Any, minimise: Callable[..., Any]) -> str:
    """Processor time, cost above its bound, largest error above idle and largest share of a limit."""
    costs = []

    def observed(cost: Any, limits: Any, x: Any) -> tuple[Any, float]:
        x, value = minimise(cost, limits, x)
        costs.append(value - cost.bound)
        return x, value

    flight = Flight(acceleration=PiecewiseLinear(TIME, load * G))
    course.planned.cache_clear()  # what another solver found for the same machine
    sequential.minimise, before = observed, sequential.minimise
    try:
        began = time.process_time()
        machine = Centrifuge(
            flight, arm=MACHINE.arm, control_point=0.15, inverse="planned", limits=LIMITS, gravity=True, idle=IDLE,
            smoothing=0.06, span=(0.0, LAST),
        )  # fmt: skip
        spent = time.process_time() - began
    finally:
        sequential.minimise = before
    t = np.linspace(0, LAST, 60001)
    flown = np.asarray(flight.acceleration(t))
    error = np.linalg.norm(machine.actual(t) - flown, axis=1)[np.linalg.norm(flown, axis=1) >= IDLE]
    share = max(use.share for use in machine.usage())
    return f"{spent:.1f} s, {costs[-1]:.5g}, {error.max():.3g} / {np.sqrt(np.mean(error**2)):.3g}, {share:.6f}"


def installed(package: str) -> str:
    """Size of a package's files, MB."""
    return f"{sum(file.size or 0 for file in files(package) or []) / 1e6:.0f} MB"


def main() -> None:
    """Print the table."""
    loads = {"F-16 to and fro": f16(), "eight maneuvers": maneuvers()}
    piqp = sequential.solve_quadratic
    for name, solver in (("piqp", piqp), ("clarabel", clarabel), ("osqp", osqp)):
        sequential.solve_quadratic = solver
        told = [measure(load, sequential.minimise) for load in loads.values()]
        print(f"| quadratic programs by {name} | {installed(name)} | {' | '.join(told)} |", flush=True)
    sequential.solve_quadratic = piqp
    told = [measure(load, ipopt) for load in loads.values()]
    print(f"| Ipopt, coarse to fine | {installed('casadi')} | {' | '.join(told)} |", flush=True)
    course._COARSE, course._GENTLER = course._FINE, (1.0,)
    told = [measure(load, ipopt) for load in loads.values()]
    print(f"| Ipopt, finest knots at once | {installed('casadi')} | {' | '.join(told)} |", flush=True)


if __name__ == "__main__":
    main()
