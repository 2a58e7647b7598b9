"""A body on springs that are coupled: the 6 × 6 stiffness and mass of a fixture."""

from __future__ import annotations

from typing import Any

import jax
import numpy as np
import pytest
from scipy.linalg import eigh

import gbeam as gb

from ..lagrange import quickly_compiled

WAYS = ("x", "y", "z", "rx", "ry", "rz")


def fixture(seed: int) -> np.ndarray:
    """A random stiffness, N/m and N m."""
    spread = np.random.default_rng(seed).normal(size=(9, 6)) * [1e3, 1e3, 1e3, 50, 50, 50]
    return spread.T @ spread


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_body_on_a_fixture_has_the_frequencies_of_its_matrices(seed: int) -> None:
    k = fixture(seed)
    pairs = {f"{WAYS[i]}-{WAYS[j]}": k[i, j] for i in range(6) for j in range(i)}
    joint = gb.Joint("fixed", "box", stiffness=dict(zip(WAYS, np.diag(k), strict=True)), coupling=pairs)
    x, y, z = centre = (0.02, -0.03, 0.05)
    system = gb.System({"box": gb.RigidBody(2.0, (0.01, 0.012, 0.015), centre)}, {"fixture": joint})
    turn = np.array([[0, z, -y], [-z, 0, x], [y, -x, 0]])
    move = np.block([[np.eye(3), turn], [np.zeros((3, 3)), np.eye(3)]])
    mass = move.T @ np.diag([2.0, 2.0, 2.0, 0.01, 0.012, 0.015]) @ move
    squares = eigh(k, mass, eigvals_only=True)
    np.testing.assert_allclose(gb.modes(system).frequency * 2 * np.pi, np.sqrt(squares), rtol=1e-8)
    pushed = gb.System(
        {"box": gb.RigidBody(2.0, (0.01, 0.012, 0.015))}, {"fixture": joint},
        {"push": gb.PointForce("box.root", (1e-4, 2e-4, 0.0))},
    )  # fmt: skip
    rest = np.asarray(gb.static(pushed).q)
    np.testing.assert_allclose(rest, np.linalg.solve(k, [1e-4, 2e-4, 0, 0, 0, 0]), atol=1e-6 * np.abs(rest).max())


def test_couplings_that_cannot_be_are_refused() -> None:
    springs = {"x": 1e4, "ry": 10.0}
    for coupling, words in (
        ({"x-rz": 1.0}, r"coupling\.x-rz is no pair of coordinates; give two of x, ry"),
        ({"x": 1.0}, r"coupling\.x is no pair of coordinates"),
        ({"x-ry": 1e4}, "makes springs that give energy"),
        (3.0, r"coupling is 3\.0; name pairs"),
    ):
        with pytest.raises(gb.InputError, match=words):
            gb.Joint("fixed", "box", stiffness=springs, coupling=coupling)


def test_a_coupling_has_derivatives() -> None:
    """Of where a box swings, which its coupling pushes aside; none at all is a fixture without."""

    def aside(coupling: Any) -> Any:
        springs = {"y": 2e3, "rz": 40.0}
        joint = gb.Joint("fixed", "box", stiffness=springs, coupling={"y-rz": coupling}, initial={"y": 0.01})
        box = gb.System({"box": gb.RigidBody(1.0, (0.1, 0.2, 0.3))}, {"foot": joint})
        return gb.simulate(box, duration=0.1, step=5e-3, estimate=False).signal("foot.rz")[-1]

    slope, difference = quickly_compiled(jax.grad(aside))(-100.0), (aside(-100.1) - aside(-99.9)) / -0.2
    assert slope == pytest.approx(difference, rel=1e-5)
    assert gb.Joint("fixed", "box", coupling={}).holder.coupling is None
