"""The stated error of the modes that a solid's model leaves out, beside that of one with forty."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gbeam as gb
from gbeam.report import text
from validation.codes.calculix_specimens import BORE, sector

from .bodies import block
from .bodies import solid as block_of

pytestmark = pytest.mark.usefixtures("reading_in_process")

EXAMPLES = Path(__file__).parents[2] / "examples"
METAL = gb.Material(density=2700, youngs_modulus=70e9, poissons_ratio=0.33)
STATED = ("displacement", "loads", "stress")


@pytest.fixture(scope="module")
def bracket() -> dict[int, gb.Structure]:
    """The example's bracket with few modes and with many."""
    solid = gb.SolidMesh.read(
        EXAMPLES / "data" / "bracket.msh", materials={"bracket": METAL, "camera": METAL}, clamp="screwed", unit="mm"
    )
    return {n: of_first_order(solid.reduced(modes=n, damping_ratio=0.02).structure) for n in (2, 8, 40)}


@pytest.fixture(scope="module")
def column() -> dict[int, gb.Structure]:
    """A straight column with a mass that is not on its middle line, with few modes and with many."""
    straight = block("hexahedron20", (12, 2, 1), (0.3, 0.02, 0.006))
    points = {"middle": (0.1, 0.0, 0.0), "above": (0.2, 0.0, 0.003)}
    heavy = block_of(straight, points=points, point_masses={"middle": 5.0})
    return {n: heavy.reduced(modes=n, damping_ratio=0.02).structure for n in (1, 8, 40)}


def of_first_order(structure: gb.Structure) -> gb.Structure:
    """Without the forces of higher order by which the model's own error is judged, as of matrices."""
    assert structure.richer is not None
    return replace(structure, richer=replace(structure.richer, bending=None))


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
    assert any("too few modes" in each for each in run.warnings)


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
    """A list of ratios is of the model's modes, or of all its coordinates: the last one is that of the rest."""
    solid = bracket[2].recovery.mesh  # type: ignore[union-attr]
    tested = solid.reduced(modes=2, damping_ratio=[0.01, 0.03]).structure
    vibration = gb.modes(tested, errors=False)
    np.testing.assert_allclose(vibration.damping_ratio, [0.01, 0.03], rtol=1e-6)
    assert tested == solid.reduced(modes=2, damping_ratio=[0.01] + [0.03] * 13).structure
    with pytest.raises(gb.InputError, match="damping_ratio lists 3 values for the 14"):
        solid.reduced(modes=2, damping_ratio=[0.01] * 3)
    listed = solid.reduced(modes=2, damping_ratio=[0.02] * 14).structure
    assert listed.size == 14 and listed.richer is not None and listed.richer.size > 14
    even = bracket[2].richer
    assert even is not None
    np.testing.assert_allclose(listed.richer.coefficients.damping, even.coefficients.damping, atol=1e-6)
    assert replace(listed, richer=None).judged is False


def hub(**more: Any) -> gb.Hub:
    return gb.Hub(radius=0.3, **more)


def judged(few: gb.Modes, many: gb.Modes) -> tuple[np.ndarray, np.ndarray]:
    """True errors of frequencies, beside those of many modes, and stated ones."""
    nearest = np.abs(many.frequency - few.frequency[:, None]).argmin(axis=1)
    assert few.errors is not None
    return np.abs(few.frequency / many.frequency[nearest] - 1), few.errors.shapes


@pytest.mark.parametrize(("modes", "largest"), [(2, 3e-3), (8, 1e-3)])
def test_frequencies_under_spin(bracket: dict[int, gb.Structure], modes: int, largest: float) -> None:
    """At rest they are exact; at 200 rad/s errors above 1e-3 are stated within a factor of 2.5, and none is overstated.

    Its stress couples the modes to those up to the fortieth, of which six more have the larger part.
    """
    few = gb.modes(bracket[modes], hub(rate=200.0))
    true, stated = judged(few, gb.modes(bracket[40], hub(rate=200.0), errors=False))
    assert (stated[true > 1e-3] > 0.4 * true[true > 1e-3]).all() and (stated < 1.1 * true).all()
    errors = few.errors
    assert errors is not None and true.max() > largest
    np.testing.assert_array_equal(errors.total, stated)
    assert np.isnan(errors.model).all() and np.isnan(errors.beam_theory).all()
    assert few.error_note == "the mesh is not judged"
    still = gb.modes(bracket[modes], hub(rate=0.0)).errors
    assert still is not None and still.shapes.max() < 1e-10


def test_frequencies_of_a_spinning_sector_of_a_disc() -> None:
    """So fast that they are wrong by 1e-4 to 7e-3, stated within a factor of 2."""
    spun = gb.Hub(radius=1e-3 * BORE, rate=4000.0)
    many = gb.modes(sector().reduced(modes=40, damping_ratio=0.01).structure, spun, errors=False)
    for count in (2, 4):
        true, stated = judged(gb.modes(sector().reduced(modes=count, damping_ratio=0.01).structure, spun), many)
        assert true.max() > 6e-3 and (stated > true / 2).all() and (stated < true).all()


@pytest.mark.parametrize(("modes", "radius"), [(1, 0.05), (1, 0.3), (8, 0.05)])
def test_speeds_at_which_a_column_buckles(column: dict[int, gb.Structure], modes: int, radius: float) -> None:
    """With one mode 1.3 % or 6e-4 too fast, with eight 7e-4, and said; straight, it is exact to first order."""
    inward = gb.Hub(radius=radius, pointing="inward")
    few, many = (gb.critical_speed(column[n], inward) for n in (modes, 40))
    assert few.value is not None and many.value is not None
    true = abs(few.value / many.value - 1)
    assert 0.7 * true < few.errors.shapes < 1.2 * true
    assert few.errors.total == pytest.approx(few.errors.shapes, abs=1e-6)  # the tolerance of both roots
    assert few.errors.model < 1e-6 and few.error_note == "the mesh is not judged"
    assert any("1.2 %: too few modes; raise modes" in each for each in few.warnings) == (true > 0.01)
    assert "; the mesh is not judged" in text(few)


def test_an_acceleration_that_buckles_a_column(column: dict[int, gb.Structure]) -> None:
    few, many = (gb.buckling_acceleration(column[n]).value for n in (1, 40))
    assert few is not None and many is not None
    stated = gb.buckling_acceleration(column[1]).errors.shapes
    assert stated == pytest.approx(abs(few / many - 1), rel=0.15)


def test_what_more_modes_alone_lose_is_said(column: dict[int, gb.Structure]) -> None:
    """With eight modes it keeps its equilibrium to 136.1313 rad/s, with more or with forty to 136.1293."""
    kept = gb.critical_speed(column[8], hub(pointing="inward"), upper=136.1305)
    assert kept.value is None and kept.error_note == "the mesh is not judged"
    said = "with more modes, which this model has not, the equilibrium is lost at an estimated 136.1 rad/s"
    assert said in kept.warnings


def test_a_campbell_diagram_and_its_crossings(bracket: dict[int, gb.Structure]) -> None:
    few, many = (gb.campbell(bracket[n], hub(), end=160.0, count=8, modes=4) for n in (2, 40))
    assert few.errors is not None and few.error_note == "the mesh is not judged"
    true = np.abs(few.frequency[-1] / many.frequency[-1, :2] - 1)
    assert (0.4 * true < few.errors.shapes).all() and (few.errors.shapes < 1.1 * true).all() and true.max() > 3e-4
    for ours, theirs in zip(few.crossings, many.crossings, strict=False):
        assert (ours.track, ours.order) == (theirs.track, theirs.order)
        true_speed = abs(ours.speed / theirs.speed - 1)
        assert 0.4 * true_speed < ours.errors.total < 1.1 * true_speed and np.isnan(ours.errors.model)
    assert len(few.crossings) == 2 and "errors are of modes left out: the mesh is not judged" in text(few)


def test_a_column_in_a_system_buckles_as_alone(column: dict[int, gb.Structure]) -> None:
    inward = hub(pointing="inward")
    system = gb.System({"column": column[1]}, {"foot": gb.Joint("fixed", "column")})
    lost, alone = gb.critical_speed(system, inward), gb.critical_speed(column[1], inward)
    assert lost.value == pytest.approx(alone.value, rel=1e-6)
    assert lost.errors.shapes == pytest.approx(alone.errors.shapes, rel=1e-3)


def test_a_bracket_in_a_system_errs_as_alone(bracket: dict[int, gb.Structure]) -> None:
    """On a hub, and on a joint that turns; beside a beam the theory of slender beams is the beam's."""
    system = gb.System({"bracket": bracket[2]}, {"foot": gb.Joint("fixed", "bracket")})
    turning = hub(rate=150.0)
    alone, held = gb.modes(bracket[2], turning), gb.modes(system, turning)
    assert alone.errors is not None and held.errors is not None
    np.testing.assert_allclose(held.errors.shapes, alone.errors.shapes, rtol=1e-3)
    assert np.isnan(held.errors.model).all() and held.error_note == alone.error_note == "the mesh is not judged"
    assert held.reached == pytest.approx(190.2, abs=0.1)
    assert not any("wrong" in each for each in held.warnings)


def test_poles_of_a_linear_model(bracket: dict[int, gb.Structure]) -> None:
    """The frequencies of its modes are those of the mesh, and not all of those of its static shapes."""
    space = gb.linearize(bracket[2], hub(rate=50.0))
    assert space.errors is not None and len(space.frequency) == bracket[2].size
    true = gb.modes(bracket[40], hub(rate=50.0), errors=False).frequency
    count = int((space.frequency <= space.accurate_to).sum())
    assert 2 < count < bracket[2].size
    np.testing.assert_allclose(space.frequency[:count], true[:count], rtol=0.01)
    assert "by the model with more modes; the mesh is not judged" in text(space)


def test_why_there_are_no_errors_is_said() -> None:
    """Of particles, alone and in a system, of which nothing more is known."""
    points, k = np.array([(0.1, 0.0, 0.0), (0.2, 0.0, 0.0)]), np.diag([400.0, 900.0])
    first = np.zeros((2, 3, 2))
    first[0, 2, 0] = first[1, 2, 1] = 1.0
    particles = gb.Structure.of_particles(np.ones(2), points, first, k, second=np.zeros((2, 3, 2, 2)))
    system = gb.System({"rod": particles}, {"foot": gb.Joint("fixed", "rod")})
    spun = hub(rate=1.0)
    alone = "shapes and model are not judged: it is neither a beam, a mesh nor matrices"
    for of in (particles, system):
        for answer in (gb.modes(of, spun), gb.campbell(of, spun, end=2.0, count=4, modes=1), gb.linearize(of, spun)):
            assert answer.error_note == alone and answer.errors is not None and np.isnan(answer.errors.total).all()
        assert gb.critical_speed(of, spun).error_note == alone
    assert f"no error estimate: {alone}" in text(gb.modes(particles, spun))
    assert f"no error estimate: {alone}" in text(gb.linearize(particles, spun))
