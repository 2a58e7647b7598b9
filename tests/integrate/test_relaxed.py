"""Steps by mean matrices, with changes as forces, are those by the map of every step."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from gbeam.integrate import LinearEquations, chain, gauss, integrate, linear, matrix_powers, take_equal_steps

COUNT, SIZE = 700, 14


def vibrating(change: float) -> LinearEquations:
    """Coupled vibrations, damped and driven, with a stiffness that changes by a share."""
    random = np.random.default_rng(5)
    root = random.normal(size=(SIZE, SIZE))
    mass = np.eye(SIZE) + 0.01 * root @ root.T
    rate = np.geomspace(3.0, 900.0, SIZE)
    turn = np.linalg.qr(root)[0]
    shares = random.normal(size=(SIZE, SIZE))
    shares = (shares + shares.T) / np.linalg.norm(shares + shares.T, 2)
    stiffness, changing = (turn @ (rate[:, None] * each * rate) @ turn.T for each in (np.eye(SIZE), shares))
    force = random.normal(size=SIZE)

    def matrices(t: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        k = stiffness + change * np.sin(7 * t)[:, None, None] * changing
        return 1e-4 * k, k, np.cos(11 * t)[:, None] * force

    return LinearEquations(mass, matrices, np.asarray)


def run(equations: LinearEquations) -> np.ndarray:
    """Coordinates and rates by steps that resolve all but the fastest vibrations."""
    moved = integrate(equations, gauss(), np.full(SIZE, 1e-3), np.zeros(SIZE), step=2e-3, count=COUNT)
    return np.stack([np.asarray(moved.q), np.asarray(moved.qd)])


@pytest.mark.parametrize(("change", "settles"), [(1e-4, True), (1e-3, True), (0.9, False)])
def test_they_are_those_by_all_maps(change: float, settles: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[bool] = []

    def watched(*values: Any) -> Any:
        answer = take_equal_steps(*values)
        asked.append(answer is not None)
        return answer

    monkeypatch.setattr(linear, "take_equal_steps", watched)
    settled = run(vibrating(change))
    assert asked and set(asked) == {settles}
    monkeypatch.setattr(linear, "FEWEST", SIZE + 1)
    by_maps = run(vibrating(change))
    for one, other in zip(settled, by_maps, strict=True):
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-11 * np.abs(other).max())


@pytest.mark.parametrize("count", [1, 2, 9, 50, 77])
def test_a_chain_is_step_after_step(count: int) -> None:
    random = np.random.default_rng(count)
    step, added, state = 0.4 * random.normal(size=(3, 3)), random.normal(size=(count, 3)), random.normal(size=3)
    states = chain(matrix_powers(step, count), added, state)
    assert len(states) == count + 1
    for before, after, more in zip(states, states[1:], added, strict=False):
        np.testing.assert_allclose(after, step @ before + more, atol=1e-12)
