"""The estimated error of the time steps against a method of twentieth order that starts anew at every corner.

Each load has what once made the estimate wrong: jumps of the acceleration between steps, corners at odd times, pulses
shorter than a step, rounded or not.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from numpy.polynomial import legendre

import gbeam as gb
from gbeam.analysis import Posed, observed_order, peaks_of_coordinates, plan_refinement, pose, prepared, run_plan
from gbeam.integrate import Trajectory
from gbeam.mechanics import section_forces
from tests.crossing import crossed
from validation.accuracy import integrators

from .helpers import strip

BOUND = 3.0  # times the estimate bound the error
SOFT, STIFF = strip("FOAM", (0, 2, 0), 0.01), strip("FOAM", (0, 0, 2), 0.01)
RECORD = np.cumsum(np.random.default_rng(3).normal(size=13)) * 3
# Structure, motion, duration, corners that the reference starts anew at.
CASES: dict[str, tuple[gb.Structure, Any, float, list[float]]] = {
    "sine of a hub's rate": (SOFT, gb.Hub(radius=0.1, rate=gb.Sine(3.0, 0.0751)), 0.12, [0.0751]),
    "trapezoid of a hub's rate": (
        SOFT,
        gb.Hub(radius=0.1, rate=gb.trapezoid(1.0, jerk=37.0, start=0.0111, hold=0.03)),
        0.12,
        [0.0111, 0.0111 + 1 / 37, 0.0411 + 1 / 37, 0.0411 + 2 / 37],
    ),
    "kick": (STIFF, gb.Flight(z=gb.tabulated([0.0, 0.002, 1.0], [0.0, 50.0, 50.0])), 0.15, [0.002]),
    "record": (
        STIFF,
        gb.Flight(z=gb.tabulated(np.arange(13) / 30, RECORD - RECORD[0])),
        0.39,
        list(np.arange(1, 12) / 30),
    ),
    "rounded pulse": (
        STIFF,
        gb.Flight(z=gb.smoothed(gb.tabulated([0, 0.5, 0.5003, 0.5006, 2], [0, 0, 400, 0, 0]), 0.0004)),
        0.55,
        [0.4998, 0.5001, 0.5002, 0.5004, 0.5005, 0.5008],
    ),
    "short slew": (SOFT, gb.Hub(radius=0.1, rate=gb.SmoothStep(2.0, 0.001, 0.1)), 0.12, [0.1, 0.101]),
}
INTEGRATORS = ["newmark", "generalized-alpha", "gauss"]


# Collocation at ten Gauss points: their places on a panel of unit length, and integrals from its start to each and to
# its end of the polynomial through values at them.
POINTS = (1 + legendre.leggauss(10)[0]) / 2
INTEGRALS = np.stack(
    [
        legendre.legval(np.append(2 * POINTS - 1, 1.0), legendre.legint(each, lbnd=-1, scl=0.5))
        for each in np.linalg.inv(legendre.legvander(2 * POINTS - 1, 9)).T
    ],
    axis=-1,
)


def posed(name: str) -> Posed:
    structure, motion, duration, _ = CASES[name]
    settings = gb.ResponseSettings(duration)
    return pose(prepared(structure, motion, settings), settings, duration / 100)


@cache
def states(name: str) -> tuple[np.ndarray, np.ndarray]:
    """Ends of panels, of which none has a corner inside, and the solution (q, q̇) at each one's start and its points.

    The equations are linear: all panels are solved at once for what their starts and the loads bring, then joined.
    """
    structure, _, duration, corners = CASES[name]
    problem = posed(name)
    equations: Any = problem.equations
    fastest = float(structure.rest[0][-1])
    stretches = pairwise([0.0, *corners, duration])
    ends = np.concatenate([[0.0], *(np.linspace(a, b, 4 + int((b - a) * fastest))[1:] for a, b in stretches)])
    widths, n = np.diff(ends), len(problem.start.y)
    time = (ends[:-1, None] + widths[:, None] * POINTS).ravel()
    c, k, f = equations.matrices(equations.drive(time))
    rates, arguments = np.zeros((len(time), 2 * n, 2 * n)), np.zeros((len(time), 2 * n))
    rates[:, :n, n:] = np.eye(n)
    rates[:, n:] = -np.linalg.solve(equations.mass, np.concatenate([k, c], axis=2))
    arguments[:, n:] = np.linalg.solve(equations.mass, f.T).T
    panels, m, size = len(widths), len(POINTS), 2 * n
    rates, arguments = rates.reshape(panels, m, size, size), arguments.reshape(panels, m, size)
    scaled = widths[:, None, None] * INTEGRALS
    coupling = np.einsum("pij,pjab->piajb", scaled[:, :-1], rates).reshape(panels, m * size, m * size)
    right = np.concatenate(
        [
            np.broadcast_to(np.tile(np.eye(size), (m, 1)), (panels, m * size, size)),
            (scaled[:, :-1] @ arguments).reshape(panels, -1, 1),
        ],
        axis=2,
    )
    at_points = np.linalg.solve(np.eye(m * size) - coupling, right).reshape(panels, m, size, size + 1)
    state, values = np.concatenate([problem.start.y, problem.start.yd]), np.empty((panels, m + 1, size))
    for p in range(panels):
        values[p, 0], values[p, 1:] = state, at_points[p] @ np.append(state, 1.0)
        state = state + scaled[p, -1] @ (np.einsum("iab,ib->ia", rates[p], values[p, 1:]) + arguments[p])
    return ends, values


def truth(name: str, time: np.ndarray) -> tuple[np.ndarray, Any]:
    """The tip's displacement and the loads at times."""
    structure, motion, _, _ = CASES[name]
    ends, values = states(name)
    panel = np.clip(np.searchsorted(ends, time) - 1, 0, len(values) - 1)
    places = 2 * (time - ends[panel]) / np.diff(ends)[panel] - 1
    through = np.linalg.inv(legendre.legvander(np.append(-1.0, 2 * POINTS - 1), len(POINTS)))
    both = np.einsum("tk,tks->ts", legendre.legvander(places, len(POINTS)), (through @ values)[panel])
    q, qd = np.split(both, 2, axis=1)
    equations: Any = posed(name).equations
    c, k, f = equations.matrices(equations.drive(time))
    force = f - (k @ q[..., None] + c @ qd[..., None])[..., 0]
    qdd, base = np.linalg.solve(equations.mass, force.T).T, motion.base(time)
    loads = section_forces(structure, base, q, qd, qdd, time, motion=motion)
    return np.asarray(structure.displacement(q)[:, -1]), loads


def apart(values: np.ndarray, reference: np.ndarray) -> float:
    """Largest length of the difference of two vectors' histories, over the largest length."""
    return float(np.linalg.norm(values - reference, axis=-1).max() / np.linalg.norm(reference, axis=-1).max())


def judge(response: gb.Response, name: str) -> None:
    tip, loads = truth(name, response.time)
    assert response.loads is not None
    error, estimate = apart(response.tip, tip), response.errors.displacement.step
    assert error <= BOUND * estimate
    force, moment = (
        apart(mine[:, 0], reference[:, 0])
        for mine, reference in (
            (response.loads.section_force, loads.section_force),
            (response.loads.section_moment, loads.section_moment),
        )
    )
    assert max(force, moment) <= BOUND * response.errors.loads.step
    stress = apart(response.loads.stress[..., None], loads.stress[..., None])
    assert stress <= BOUND * response.errors.stress.step


@pytest.mark.parametrize(
    ("name", "integrator"),
    crossed(lambda name, how: how != "generalized-alpha" or name.startswith("sine"), CASES, INTEGRATORS),
)
def test_an_automatic_step_keeps_its_tolerance(name: str, integrator: str) -> None:
    structure, motion, duration, _ = CASES[name]
    how = {"integrator": integrator, "tolerance": 1e-3, "estimate": False}  # that of the steps is known without
    response = gb.simulate(structure, motion, duration=duration, **how)
    judge(response, name)
    assert response.errors.displacement.step <= 1e-4
    assert apart(response.tip, truth(name, response.time)[0]) <= 2e-4
    assert response.steps < 200_000


@pytest.mark.parametrize("integrator", ["newmark", "gauss"])
@pytest.mark.parametrize("name", ["sine of a hub's rate", "kick", "record"])
def test_a_given_step_has_an_honest_error(name: str, integrator: str) -> None:
    """However coarse: the order is observed, not taken on trust."""
    structure, motion, duration, _ = CASES[name]
    for share in (400, 1600):
        judge(gb.simulate(structure, motion, duration=duration, integrator=integrator, step=duration / share), name)


@pytest.mark.parametrize("name", ["short slew", "kick", "sine of a hub's rate"])
def test_steps_that_end_at_corners_keep_the_order_of_gauss(name: str) -> None:
    """Fitted to the vibration at rest they leave so little of the sine that it falls faster."""
    structure, motion, duration, _ = CASES[name]
    errors = []
    for count in (3200, 6400):  # so many that steps see the short slew alike
        how = {"integrator": "gauss", "step": duration / count, "estimate": False}
        response = gb.simulate(structure, motion, duration=duration, **how)
        errors.append(apart(response.tip, truth(name, response.time)[0]))
    order = np.log2(errors[0] / errors[1])
    assert order > 3.8 and (order < 4.2 or name == "sine of a hub's rate")


def test_loads_that_a_jump_excites_are_followed_or_the_run_says_what_follows_them() -> None:
    """The axial mode is nothing in the tip's displacement, and a quarter of the root's force."""
    structure, motion = integrators.strip("FOAM", 0.0), integrators.JERK
    answer, rough = (
        gb.simulate(structure, motion, duration=0.12, integrator=integrator) for integrator in ("gauss", "newmark")
    )
    truth = gb.simulate(structure, motion, duration=0.12, integrator="gauss", step=answer.step / 2, estimate=False)
    assert answer.loads is not None and truth.loads is not None
    stride = round(answer.time[1] / truth.step)
    error = apart(answer.loads.root_force, truth.loads.root_force[::stride])
    assert error <= BOUND * answer.errors.loads.step <= BOUND * 1e-2 / 3
    assert not any("integrator" in each for each in answer.warnings)
    assert rough.errors.loads.step > 1e-2 / 3
    assert any('integrator = "gauss" follows it in fewer' in each for each in rough.warnings)


def test_a_run_of_very_many_steps_says_why_and_what_needs_fewer() -> None:
    """An undamped vibration goes on for 22 cycles after a jump: a scheme of second order delays it."""
    structure, motion = strip("FOAM", (0, 2, 0)), CASES["sine of a hub's rate"][1]
    many, few = (
        gb.simulate(structure, motion, duration=0.12, integrator=integrator) for integrator in ("newmark", "gauss")
    )
    assert many.steps > 10 * few.steps and max(each.errors.displacement.step for each in (many, few)) <= 1e-4
    assert any(f"took {many.steps} steps" in each and "gauss" in each for each in many.warnings)
    assert not any("steps" in each for each in few.warnings)


def test_a_step_found_by_a_large_jump_is_checked() -> None:
    """Of a mode that coarse steps do not resolve at all, they do not show how its error falls."""
    settings, slow, fast, resolved = gb.ResponseSettings(duration=10.0), 9.0, 4e-4, 0.005

    def error(step: float) -> float:
        return slow * step**2 + fast * min(1.0, step / resolved) ** 2

    def vector(q: np.ndarray) -> np.ndarray:
        return np.asarray(q * np.array([0.0, 0.0, 1.0]))

    @dataclass(frozen=True)
    class Wave:
        flight: Trajectory
        step: float
        reached_end, bends, event_warnings = True, False, ()

        @property
        def displacements(self) -> list[np.ndarray]:
            return [vector(self.flight.q)]

        @property
        def peaks(self) -> list[np.ndarray]:
            return [peaks_of_coordinates(self.flight, self.displacements[0], vector)] * 2

        def aims(self, aim: float, enough: float) -> list[float]:
            return [aim]

        def loads(self, stride: int) -> list[np.ndarray]:
            return []

    def run(step: float, _: str) -> Wave:
        time = step * np.arange(round(10 / step) + 1)
        q, qd = ((1 + error(step)) * wave(time)[:, None] for wave in (np.sin, np.cos))
        return Wave(Trajectory(time, q, qd, -q), step)

    assert error(0.0025) > 1.5 * settings.aim  # the step that the order promises to be enough
    answer, errors = run_plan(plan_refinement(0.02, 2, settings), run)
    assert error(answer.step) <= min(settings.aim, BOUND * errors.displacement)


@pytest.mark.parametrize(("ratios", "order"), [((2, 2), 2.0), ((2, 16), 1.3), ((4, 4), 4.0), ((2, 8), 1.0)])
def test_observed_order_is_that_of_the_differences(ratios: tuple[int, int], order: float) -> None:
    h = np.array([1.0, 1 / ratios[0], 1 / (ratios[0] * ratios[1])])
    before, now = -np.diff(h**order)
    assert observed_order(before, now, ratios, 4.0) == pytest.approx(order, rel=1e-6)
    assert observed_order(before, now, ratios, 1.0) == pytest.approx(1.0)
    assert observed_order(before, 10 * before, ratios, 4.0) == observed_order(0.0, now, ratios, 4.0) == 0.5
    assert observed_order(before, 0.0, ratios, 4.0) == 4.0
