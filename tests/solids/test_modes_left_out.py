"""The stated error of the modes that a solid's model leaves out, beside that of one with forty."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gbeam as gb

EXAMPLES = Path(__file__).parents[2] / "examples"
METAL = gb.Material(density=2700, youngs_modulus=70e9, poissons_ratio=0.33)
STATED = ("displacement", "loads", "stress")


@pytest.fixture(scope="module")
def bracket() -> dict[int, gb.Structure]:
    """The example's bracket with few modes and with many."""
    solid = gb.SolidMesh.read(
        EXAMPLES / "data" / "bracket.msh", materials={"bracket": METAL, "camera": METAL}, clamp="screwed", unit="mm"
    )
    return {n: solid.reduced(modes=n, damping_ratio=0.02).structure for n in (2, 8, 40)}


def errors(structure: gb.Structure, truth: gb.Structure, motion: Any, **settings: Any) -> tuple[Any, Any, gb.Response]:
    """True and stated errors of displacement, root loads and stress, and the run."""
    run = gb.simulate(structure, motion, integrator="gauss", **settings)
    other = gb.simulate(truth, motion, integrator="gauss", estimate=False, **settings)

    def apart(a: Any, b: Any) -> float:
        sizes = (np.linalg.norm(each.reshape(len(each), -1), axis=1).max() for each in (a - b, b))
        return float(next(sizes) / next(sizes))

    def read(of: gb.Response) -> list[Any]:
        assert of.loads is not None and of.solid is not None
        return [of.displacement[:, -1], of.loads.force[:, 0], of.loads.moment[:, 0], of.solid.von_mises]

    tip, force, moment, stress = map(apart, read(run), read(other))
    return np.array([tip, max(force, moment), stress]), np.array([getattr(run.errors, k).shapes for k in STATED]), run


@pytest.mark.parametrize(
    ("modes", "axis", "frequency", "large"), [(2, "x", 4665, 0.1), (2, "y", 4665, 0.1), (8, "y", 10804, 0.3)]
)
def test_a_mode_left_out_that_a_shock_excites(
    bracket: dict[int, gb.Structure], modes: int, axis: str, frequency: float, large: float
) -> None:
    """A period of a sine near the frequency of a mode that the model lacks: 10 to 60 % of the loads, and said."""
    time = 1 / frequency
    motion = gb.Flight(**{axis: gb.Sine(500.0, duration=time)})
    true, stated, run = errors(bracket[modes], bracket[40], motion, duration=12 * time, step=time / 40)
    assert true[1] > large and (stated > true / 2).all() and (stated < 3 * true).all()
    assert any("too few modes (raise modes)" in each for each in run.warnings)


@pytest.mark.parametrize("modes", [2, 8])
def test_static_shapes_hold_nearly_all_of_a_slow_turn(bracket: dict[int, gb.Structure], modes: int) -> None:
    """To 1e-5 with two modes; a shaking of an eighth of a second leaves more than rounding of each."""
    motion = gb.Flight(x=gb.SmoothStep(100.0, 0.01), y=gb.SmoothStep(30.0, 0.01), z=gb.SmoothStep(100.0, 0.01))
    true, stated, run = errors(bracket[modes], bracket[40], motion, duration=0.06, step=5e-5)
    assert (stated < 1e-4).all() and stated[0] == pytest.approx(true[0], rel=0.5)
    assert true[2] / 2 < stated[2] < 5 * true[2] and stated[1] + run.errors.loads.step > true[1] / 2
    assert run.errors.note == "the mesh is not judged" and np.isnan(run.errors.displacement.model)


def test_a_run_that_begins_moving_lacks_nothing_by_that(bracket: dict[int, gb.Structure]) -> None:
    """On a machine a flight begins after the spin-up, where the bracket rings: it was taken for what it lacks."""
    turn = gb.Flight(x=gb.SmoothStep(20.0, 0.2), z=20.0)
    machine = gb.Centrifuge(turn, arm=3.3, control_point=0.04, gravity=False, span=(0.0, 0.4))
    run = gb.simulate(bracket[8], machine, duration=0.4, step=1e-3, integrator="gauss")
    assert run.errors.displacement.shapes < 1e-5


def test_at_rest_and_by_spin(bracket: dict[int, gb.Structure]) -> None:
    """Static answers to even accelerations are among the shapes; a spin's stress stiffens what they lack."""
    still = gb.static(bracket[2], acceleration=(0.0, 0.0, 9.81)).errors
    assert still.displacement.shapes < 1e-5 and still.loads.shapes < 1e-9
    hub = gb.Hub(rate=30.0, radius=0.3)
    few, many = (gb.static(bracket[n], hub) for n in (2, 40))
    true = np.linalg.norm(few.tip - many.tip) / np.linalg.norm(many.tip)
    assert few.errors.displacement.shapes == pytest.approx(true, rel=0.5) and "shapes" in repr(few.errors.stress)


def test_a_model_of_all_modes_lacks_none() -> None:
    """Two masses on springs by their matrices, and all of their modes: the error is none, and that of one is not."""
    mass, stiffness = 2 * np.eye(6), np.diag([800.0, 5000.0, 9000.0, 7e4, 8e4, 9e4])
    stiffness[0, 3] = stiffness[3, 0] = -4e3
    model = gb.ImportedModel(mass, stiffness, nodes=[(0.1, 0, 0), (0.2, 0, 0.05)])
    motion = gb.Flight(x=gb.SmoothStep(10.0, 0.05))
    runs = [
        gb.simulate(model.reduced(modes=n, damping_ratio=0.01), motion, duration=0.3, step=1e-4, integrator="gauss")
        for n in (1, 6)
    ]
    assert runs[1].errors.displacement.shapes < 1e-12 and runs[1].errors.loads.shapes < 1e-12
    assert np.isnan(runs[1].errors.stress.total) and "the mesh is not judged" in runs[1].errors.note


def test_damping_by_coordinates_reaches_the_modes_besides(bracket: dict[int, gb.Structure]) -> None:
    """A list of ratios is of the model's coordinates: the last one is that of all modes that it lacks."""
    solid = bracket[2].recovery.mesh  # type: ignore[union-attr]
    listed = solid.reduced(modes=2, damping_ratio=[0.02] * 14).structure
    assert listed.size == 14 and listed.richer is not None and listed.richer.size > 14
    even = bracket[2].richer
    assert even is not None
    np.testing.assert_allclose(listed.richer.coefficients.damping, even.coefficients.damping, atol=1e-6)
    assert replace(listed, richer=None).judged is False
