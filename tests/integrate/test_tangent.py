"""The derivative of a run is that of its discrete solution, for every scheme, across steps that are split at jumps."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from gbeam.integrate import (
    Corners,
    LinearEquations,
    Scheme,
    gauss,
    generalized_alpha,
    hht,
    integrate_steps,
    make_steps,
    newmark,
    tangent,
)

MASS = np.array([[2.0, 0.3], [0.3, 1.0]])
JUMP = 0.137


def forced(stiffness: float, damping: float, level: float) -> LinearEquations:
    """Two masses, a force that jumps within a step."""

    def matrices(force: Any) -> Any:
        k = np.array([[stiffness, -20.0], [-20.0, 80.0]])
        c = damping * np.array([[1.0, -0.2], [-0.2, 0.5]])
        return np.broadcast_to(c, (len(force), 2, 2)), np.broadcast_to(k, (len(force), 2, 2)), force

    def drive(t: Any) -> Any:
        t = np.asarray(t)
        return np.stack([level * np.sin(3 * t), np.where(t < JUMP, 0.0, 1.0 + t)], axis=-1)

    return LinearEquations(MASS, matrices, drive)


@pytest.mark.parametrize("make", [newmark, lambda: hht(-0.1), lambda: generalized_alpha(0.7), gauss])
def test_tangent_is_the_derivative_of_the_discrete_solution(make: Callable[[], Scheme]) -> None:
    scheme, p = make(), np.array([50.0, 0.4, 5.0])
    start = np.array([0.1, -0.2]), np.array([0.3, 0.0])
    steps = make_steps(0.0, 0.02, 30, Corners(np.array([JUMP]), np.array([True])))
    steps = replace(steps, kept=np.ones(len(steps), dtype=bool))
    assert len(steps) == 31  # one is split

    def run(p: Any) -> Any:
        return integrate_steps(forced(*p), scheme, *start, steps)

    equations = forced(*p)

    def system(t: Any, q: Any, qd: Any) -> Any:
        c, k, _ = equations.matrices(equations.drive(t))
        forces = np.zeros((*q.shape, 3))
        forces[:, 0, 0] = -q[:, 0]
        forces[..., 1] = -(qd @ np.array([[1.0, -0.2], [-0.2, 0.5]]))
        forces[:, 0, 2] = np.sin(3 * t)
        return np.broadcast_to(MASS, k.shape), c, k, forces

    answer = tangent(system, scheme, steps, run(p), np.zeros((2, 3)), np.zeros((2, 3)))
    for j, h in enumerate(1e-4 * p):
        ends = [run(p + s * h * np.eye(3)[j]) for s in (1, -1)]
        for name, values in zip(("q", "qd", "qdd"), answer, strict=True):
            difference = (getattr(ends[0], name) - getattr(ends[1], name)) / (2 * h)
            np.testing.assert_allclose(values[..., j], difference, atol=2e-8 * np.abs(difference).max())
