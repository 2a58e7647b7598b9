"""Derivatives of a window alone: where they are found, between which they are interpolated, and what they map."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from gbeam.integrate import Derivatives, Stages, derivatives, gauss, interpolate, newmark


class Spring:
    """A unit mass on a spring whose stiffness (t, n) is its input; it counts the states at which it is derived."""

    def __init__(self) -> None:
        self.derived: list[int] = []

    def __call__(self, q: Any, qd: Any, qdd: Any, stiffness: Any) -> Any:
        if np.iscomplexobj(q):
            self.derived.append(q.shape[1])
        return qdd + stiffness * q


def stages(stiffness: Any, per_step: int = 1) -> Stages:
    """Stages of steps at rest with a stiffness (t s,) each."""
    values = np.asarray(stiffness, dtype=float)[:, None]
    return Stages(np.arange(len(values)) / per_step, np.zeros((3, len(values), 1)), values)


def stiffnesses(spring: Spring, spacing: int, stiffness: Any) -> np.ndarray:
    """Stiffness that derivatives so far apart have at all stages, each found as if they were old."""
    built = Derivatives(spring, None)
    built.extend(len(stiffness))
    built.spacing = spacing
    built.age[:] = np.inf
    built.renew(stages(stiffness))
    return np.asarray(built.slope[:, 0, 0, 0, 0])


def test_one_state_serves_all_steps_until_corrections_shrink_slowly() -> None:
    spring, built, soft = Spring(), Derivatives(Spring(), None), np.linspace(1.0, 2.0, 30)
    built.residual = spring
    built.extend(30)
    built.renew(stages(soft))
    built.grow_old(np.full(30, 0.5), np.zeros(30, dtype=bool), fast=False)
    built.renew(stages(soft))
    assert spring.derived == [1] and built.has_one_set and built.constant and built.trusted_steps.all()
    slow = np.arange(30) == 20
    built.grow_old(np.full(30, 0.1), slow, fast=False)
    built.renew(stages(soft))
    assert built.spacing == derivatives.APART and len(built.slope) == 30 and spring.derived == [1, 3]
    assert built.fresh_steps.tolist() == [False] * 20 + [True] * 10 and not built.trusted_steps.any()
    np.testing.assert_allclose(built.slope[:, 0, 0, 0, 0], np.where(np.arange(30) < 20, 1.0, soft), rtol=1e-12)


def test_derivatives_come_closer_where_corrections_shrink_slowly_and_go_apart_where_fast() -> None:
    built = Derivatives(Spring(), None)
    built.extend(2)
    spacings = []
    for slow in (True, True, True, False, False):
        built.grow_old(np.zeros(2), np.array([slow, False]), fast=True)
        spacings.append(built.spacing)
    near = derivatives.NEAR
    assert spacings == [derivatives.APART, near, near, near + 1, near + 2]
    for _ in range(derivatives.FAR):
        built.grow_old(np.zeros(2), np.zeros(2, dtype=bool), fast=True)
    assert built.constant


def test_steps_leave_and_are_cut_with_their_derivatives() -> None:
    built = Derivatives(Spring(), None)
    built.extend(10)
    built.spacing, built.age = derivatives.NEAR, np.full(10, np.inf)
    held = stages(np.arange(10.0))
    built.renew(held)
    built.factor(held, newmark().tableau(np.array([0.1])), None)
    built.leave(2)
    built.cut(5)
    assert len(built.age) == len(built.maps[0]) == 5
    np.testing.assert_allclose(built.slope[:, 0, 0, 0, 0], np.arange(2.0, 7.0), rtol=1e-12)
    built.extend(2)
    np.testing.assert_allclose(built.slope[5:, 0, 0, 0, 0], 6.0, rtol=1e-12)
    built.leave(7)
    assert built.has_one_set and built.maps is None  # the last ones serve the steps that follow


def test_maps_are_those_of_the_steps_of_a_linear_spring() -> None:
    """One step of Gauss's method by the maps is the solution of its equations, written out."""
    h, k, t = 0.3, 4.0, gauss().tableau(np.array([0.3]))
    built, at = Derivatives(Spring(), None), stages([k, k], 2)
    built.extend(1)
    built.renew(at)
    built.factor(at, t, None)
    inverse, answer, step = (each[0] for each in built.maps)
    a = np.array([[0.25, 0.25 - 3**0.5 / 6], [0.25 + 3**0.5 / 6, 0.25]])
    jacobian, onto = np.eye(2) + k * h**2 * a @ a, k * np.stack([np.ones(2), h * a.sum(axis=1)], axis=1)
    np.testing.assert_allclose(inverse, np.linalg.inv(jacobian), rtol=1e-12)
    np.testing.assert_allclose(answer, np.linalg.inv(jacobian) @ onto, rtol=1e-12)
    np.testing.assert_allclose(step, t.g[0] - t.d[0] @ answer, rtol=1e-12)
    assert np.linalg.det(step) == pytest.approx(1.0, abs=1e-12)  # no damping


def interpolates_quintics() -> None:
    at, points = np.array([0.0, 0.7, 1.1, 2.0, 3.1, 3.8, 5.0, 5.5]), np.linspace(0.0, 5.5, 40)
    quintic = np.polynomial.Polynomial([1.0, -2.0, 0.5, 0.3, -0.2, 0.04])
    np.testing.assert_allclose(interpolate(at, quintic(at), points), quintic(points), atol=1e-12)


def follows_a_swing() -> None:
    """A pendulum that swings by one radian has its stiffness within 2 % at 40 stages a cycle."""
    swing = np.cos(np.sin(2 * np.pi * np.arange(200) / 40))
    np.testing.assert_allclose(stiffnesses(Spring(), derivatives.NEAR, swing), swing, atol=0.02)


@pytest.mark.parametrize(
    ("name", "value", "holds"),
    [("NEAREST", derivatives.NEAREST // 2, interpolates_quintics), ("NEAR", 2 * derivatives.NEAR, follows_a_swing)],
)
def test_what_a_number_half_or_twice_as_large_breaks(
    name: str, value: int, holds: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    holds()
    monkeypatch.setattr(derivatives, name, value)
    with pytest.raises(AssertionError):
        holds()
