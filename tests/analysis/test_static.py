"""Relative equilibrium: closed forms while deflections are small, the heavy elastica when they are not."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_bvp

from gbeam import (
    Beam,
    ComputationError,
    Load,
    Material,
    Model,
    PointMass,
    Section,
    Structure,
    assemble,
    solve_equilibrium,
    static,
)
from gbeam.analysis import Drive, rest_of, settled, subject_of
from gbeam.results import Base

from .helpers import EA, EI, LENGTH, LINE, strip

MODAL = 3e-5  # ten modes, relative
ELASTICA = 1e-6  # of the length


def translating(x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Base:
    return Base(np.array([x, y, z]), np.zeros(3), np.zeros(3))


def tip(structure: Structure, base: Base) -> np.ndarray:
    return np.asarray(structure.displacement(solve_equilibrium(structure, base).q)[-1])


def test_uniform_acceleration_is_the_textbooks_cantilever() -> None:
    """w L⁴/8EI across, w L²/2EA along; the load is against the acceleration."""
    a = 10.0
    structure = strip("FOAM", (10, 0, 10))
    np.testing.assert_allclose(tip(structure, translating(z=a))[2], -LINE * a * LENGTH**4 / (8 * EI), rtol=MODAL)
    # the sines converge to the linear tip displacement as 1/k²
    np.testing.assert_allclose(tip(structure, translating(x=a))[0], -LINE * a * LENGTH**2 / (2 * EA), rtol=5e-3)


def test_linear_models_are_linear() -> None:
    structure = strip()
    one, two = (solve_equilibrium(structure, translating(z=a)).q for a in (7.0, 14.0))
    np.testing.assert_allclose(two, 2 * one, rtol=1e-12)


def test_small_loads_do_not_tell_the_models_apart() -> None:
    answer = [tip(strip(kind, (1, 0, 5)), translating(x=0.3, z=1.0))[2] for kind in ("FOAM", "exact")]
    np.testing.assert_allclose(answer, answer[0], rtol=2e-5)


@cache
def heavy_beam(counts: tuple[int, int, int]) -> Structure:
    """EI = 1 N m², ρA = 1 kg/m, L = 1 m, hardly extensible: the acceleration is the load parameter w L³/EI."""
    beam = Beam(1.0, Section.general(1.0, 1e-8, 1e-8), Material(1.0, 1e8))
    return assemble(beam, Model("exact", *counts))


def heavy_elastica(load: float, inwards: float = 0.0) -> np.ndarray:
    """Tip (x, y) under dead loads, w along +y, p along −x: θ'' = −(1 − s)(w cos θ + p sin θ), θ(0) = 0 = θ'(1)."""

    def right(s: np.ndarray, y: np.ndarray) -> np.ndarray:
        across = load * np.cos(y[0]) + inwards * np.sin(y[0])
        return np.stack([y[1], -(1 - s) * across, np.cos(y[0]), np.sin(y[0])])

    def ends(a: np.ndarray, b: np.ndarray) -> np.ndarray:
        return np.array([a[0], b[1], a[2], a[3]])

    s = np.linspace(0, 1, 201)
    guess = np.stack([np.tanh(load * s / 4), 0 * s, s, 0 * s])
    answer = solve_bvp(right, ends, s, guess, tol=1e-10, max_nodes=100_000)
    assert answer.success
    return answer.y[2:, -1]


@pytest.mark.parametrize("load", [1.0, 10.0, 40.0])
def test_exact_model_is_the_heavy_elastica(load: float) -> None:
    """At 40 the tip has all but turned into the load."""
    x, y = heavy_elastica(load)
    np.testing.assert_allclose(tip(heavy_beam((1, 10, 0)), translating(y=-load)), [x - 1, y, 0], atol=ELASTICA)


def test_a_beam_that_is_pressed_and_bent_over_rests_where_it_is_stable() -> None:
    """Newton's method in one stride comes to a coiled beam that cannot stand; along the path the tip turns over."""
    x, y = heavy_elastica(400.0, 160.0)
    beam = heavy_beam((1, 10, 0))
    resting = solve_equilibrium(beam, translating(x=160.0, y=-400.0))
    assert x < -0.2 and resting.stable
    np.testing.assert_allclose(beam.displacement(resting.q)[-1], [x - 1, y, 0], atol=2e-3)


def test_beam_hangs_straight_and_stretched() -> None:
    answer = tip(heavy_beam((1, 10, 0)), translating(x=-40.0))
    np.testing.assert_allclose(answer, [40.0 / 2e8, 0, 0], atol=1e-11)


def test_first_order_model_stiffens_in_tension_and_softens_in_compression() -> None:
    """Against Euler's column of distributed weight: FOAM loses stiffness at w L³/EI = 7.837 (Greenhill), not before."""
    beam = Beam(1.0, Section.general(1.0, 1e-8, 1e-8), Material(1.0, 1e8))
    foam = assemble(beam, Model("FOAM", 0, 8, 0))
    sideways = [tip(foam, translating(x=a, y=-1e-3))[1] for a in (-5.0, 0.0, 5.0, 7.8)]
    assert sideways[0] < sideways[1] < sideways[2] < sideways[3]
    assert sideways[3] > 100 * sideways[1]
    assert tip(foam, translating(x=7.87, y=-1e-3))[1] < 0  # beyond, the answer is not an equilibrium one can stand in


@pytest.mark.parametrize(("kind", "says"), [("FOAM", "not finite"), ("exact", "beyond 0 of the load")])
def test_no_equilibrium_is_an_error_that_says_how_far_it_got(kind: str, says: str) -> None:
    with pytest.raises(ComputationError, match=f"no relative equilibrium.*{says}") as caught:
        solve_equilibrium(strip(kind), translating(z=np.nan))
    assert caught.value.outcome == "not converged"


@pytest.mark.parametrize("seed", range(6))
def test_an_equilibrium_states_its_error(seed: int) -> None:
    """Of the tip and of the root's moment, against the exact model with twelve shapes across, solved by NumPy."""
    random = np.random.default_rng(seed)
    kind = ("FOAM", "TLAM", "SFOAM")[seed % 3]
    bodies = [PointMass(LENGTH * random.uniform(0.4, 1), random.choice([0.0, 0.05]))]
    beam = Beam(LENGTH, Section.rectangle(0.02, 0.004), Material(2700.0, 7e10), bodies)
    along_y, along_z = (int(n) for n in random.integers(1, 4, 2))
    axial = 0 if kind == "SFOAM" else int(random.integers(1, 4))
    size = 10 ** random.uniform(1, 3)
    base = Base(size * random.normal(size=3), 10 * random.normal(size=3), 30 * random.normal(size=3))
    few, exact = (assemble(beam, model) for model in (Model(kind, axial, along_y, along_z), Model("exact", 6, 12, 12)))
    subjects = subject_of(few, None), subject_of(exact, None)
    answer, true = (rest_of(each, settled(each.system, Drive(base=base))) for each in subjects)
    for name, ours, theirs in (
        ("displacement", answer.tip, true.tip),
        ("loads", answer.loads.root_moment[0], true.loads.root_moment[0]),
    ):
        error = np.linalg.norm(theirs - ours) / max(np.linalg.norm(theirs), np.linalg.norm(ours))
        stated = getattr(answer.errors, name).total
        assert error <= 1.2 * stated + 1e-6 and stated >= (error if name == "displacement" else 0) / 1.2
    assert bool([each for each in answer.warnings if "wrong" in each]) == (
        max(answer.errors.displacement.total, answer.errors.loads.total) > 0.01
    )
    assert f"estimated error {100 * answer.errors.displacement.total:.2g} %" in repr(answer)


def test_an_equilibrium_that_the_exact_model_does_not_reach_is_doubted() -> None:
    """Of a material softer than 1 Pa; at 200 Pa the exact beam hangs down, FOAM's lies millions of lengths away."""
    soft = [Beam(LENGTH, Section.rectangle(0.02, 0.004), Material(2700.0, modulus)) for modulus in (0.2, 200.0)]
    lost, wrong = (static(assemble(beam, Model("FOAM", 0, 1, 1)), acceleration=(0, 0, 9.81)) for beam in soft)
    assert np.isnan(lost.errors.displacement.total)
    assert any("comes to no equilibrium there" in each for each in lost.warnings)
    assert wrong.errors.displacement.total == pytest.approx(1.0, abs=1e-3)


def test_a_moment_that_twists_is_warned_of() -> None:
    """Torsion is in no model: the moment about x moves nothing, and the load is named."""
    loads = [Load(LENGTH, force=(0.0, 0.0, 1.0)), Load(LENGTH, moment=(0.4, 0.0, 0.1))]
    beam = Beam(LENGTH, Section.rectangle(0.02, 0.004), Material(2700.0, 7e10), loads=loads)
    rest = static(assemble(beam, Model("FOAM", 1, 1, 1)))
    (warning,) = (each for each in rest.warnings if "twists" in each)
    assert "beam.loads[1].moment" in warning and "0.4 N m" in warning
    bent = replace(beam, loads=[loads[0], Load(LENGTH, moment=(0.0, 0.0, 0.1))])
    assert not any("twists" in each for each in static(assemble(bent, Model("FOAM", 1, 1, 1))).warnings)
