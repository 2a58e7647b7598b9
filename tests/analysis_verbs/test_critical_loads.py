"""Loads, speeds and accelerations under which beams give way: classics in closed form.

Euler 1744; Greenhill 1881; Beck 1952 and Leipholz 1962 for loads that follow the beam (Bolotin 1963; Langthjem and
Sugiyama 2000): 20.0509536 and 40.0537, both by flutter. The exact beam also shortens: by 2e-5 under Beck's load here.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import jv

import gbeam as gb

from .beams import slender

BECK, BECK_FREQUENCY, LEIPHOLZ = 20.0509536, 11.0156, 40.0537
GREENHILL = 9 / 4 * brentq(lambda z: jv(-1 / 3, z), 1.5, 2.2) ** 2
MODELS = {
    "FOAM": gb.Model("FOAM", 1, 0, 8),
    "SFOAM": gb.Model("SFOAM", 0, 0, 8),
    "CFOAM": gb.Model("CFOAM", 1, 0, 6),
    "exact": gb.Model("exact", 1, 0, 7),
}


def column(model: gb.Model, *loads: gb.Load, damping: float = 0.0):
    """ρA = EI = L = 1."""
    section, material = gb.Section.general(1e-2, 1e-8, 1e-8), gb.Material(1e2, 1e8)
    return gb.assemble(gb.Beam(1.0, section, material, damping_ratio=damping, loads=loads), model)


@pytest.mark.parametrize("kind", MODELS)
def test_euler(kind):
    critical = gb.critical_load(column(MODELS[kind], gb.Load(1.0, force=(-0.5, 0.0, 0.0))))
    assert critical.frame == "ground"
    # Clamped-free shapes know nothing of the load and converge slowly; polynomials at once.
    assert critical.value == pytest.approx(2 * np.pi**2 / 4, rel=1e-5 if kind == "exact" else 6e-4)
    assert (critical.kind, critical.direction, critical.unit) == ("divergence", "z", "times the loads")
    assert critical.errors.slender == pytest.approx(abs(critical.value / (np.pi**2 / 2) - 1), rel=0.1, abs=3e-6)


@pytest.mark.parametrize("kind", MODELS)
def test_beck(kind):
    structure = column(MODELS[kind], gb.Load(1.0, force=(-1.0, 0.0, 0.0), follower=True))
    critical = gb.critical_load(structure)
    assert critical.value == pytest.approx(BECK, rel=3e-5 if kind == "exact" else 4e-4)
    assert (critical.kind, critical.direction) == ("flutter", "z")
    assert critical.errors.slender == pytest.approx(abs(critical.value / BECK - 1), rel=0.1, abs=3e-5)


def test_becks_two_modes_meet():
    """Just below the critical load two frequencies are nearly one; above it `modes` says flutter."""
    close, beyond = (
        gb.modes(
            column(MODELS["exact"], gb.Load(1.0, force=(-share * BECK, 0.0, 0.0), follower=True)),
            gb.Flight(z=gb.constant(0.0)),
            0.0,
        )
        for share in (0.99999, 1.001)
    )
    assert close.stable and 2 * np.pi * close.frequency[:2] == pytest.approx(BECK_FREQUENCY, rel=1e-2)
    assert [each.kind for each in beyond.instabilities] == ["flutter"]


def test_leipholz():
    structure = column(MODELS["exact"], gb.Load(distributed=(-1.0, 0.0, 0.0), follower=True))
    critical = gb.critical_load(structure)
    assert critical.value == pytest.approx(LEIPHOLZ, rel=1e-4) and critical.kind == "flutter"


def test_a_dead_load_along_the_beam_is_greenhills():
    critical = gb.critical_load(column(MODELS["FOAM"], gb.Load(distributed=(-1.0, 0.0, 0.0))))
    assert critical.value == pytest.approx(GREENHILL, rel=2e-5)
    assert pytest.approx(7.8373, abs=1e-4) == GREENHILL


@pytest.mark.parametrize("kind", ["FOAM", "exact"])
def test_buckling_under_its_own_inertia(kind):
    """a_x pushes the root: 7.8373 EI/(m L³)."""
    answer = gb.buckling_acceleration(column(MODELS[kind]))
    assert answer.value == pytest.approx(GREENHILL, rel=4e-5)


def test_loads_of_another_time_and_none():
    ramp = gb.Load(1.0, force=gb.vector(x=gb.SmoothStep(-1.0, 2.0)))
    structure = column(MODELS["FOAM"], ramp)
    with pytest.raises(gb.InputError, match="has no load that acts"):
        gb.critical_load(structure)
    assert gb.critical_load(structure.at_time(1.0)).value == pytest.approx(np.pi**2 / 2, rel=6e-4)
    with pytest.raises(gb.InputError, match="gbeam critical-speed"):
        gb.critical_load(column(MODELS["FOAM"]))


def test_pulling_never_buckles():
    critical = gb.critical_load(column(MODELS["FOAM"], gb.Load(1.0, force=(1.0, 0.0, 0.0))))
    assert critical.value is None and critical.kind == "none" and critical.searched_to == pytest.approx(24.7, abs=0.1)


def test_dead_load_lowers_the_frequency():
    """ω² falls nearly in proportion to the load, and vanishes with Euler's."""
    rest, half = (
        gb.modes(column(MODELS["exact"], gb.Load(1.0, force=(-p, 0.0, 0.0))), gb.Flight(z=gb.constant(0.0)), 0.0)
        for p in (1e-9, np.pi**2 / 8)
    )
    assert (half.frequency[0] / rest.frequency[0]) ** 2 == pytest.approx(0.5, abs=0.02)


@pytest.mark.parametrize(("kind", "counts"), [("FOAM", (1, 8, 0)), ("exact", (2, 7, 0))])
def test_a_beam_pointing_inward_diverges(kind, counts):
    """Chebyshev collocation of w'''' − Ω²((Tw')' + w) = 0, T = −∫_x^1 (R − ξ) dξ: root at R, the beam to the axis."""
    radius = 2.0
    n = 24
    k = np.arange(n + 1)
    x = np.cos(np.pi * k / n)
    c = np.where((k == 0) | (k == n), 2.0, 1.0) * (-1.0) ** k
    d = np.outer(c, 1 / c) / (x[:, None] - x + np.eye(n + 1))
    d = 2 * (d - np.diag(d.sum(axis=1)))  # on x from 1 (first) to 0 (last)
    at = (x + 1) / 2
    tension = -(radius * (1 - at) - (1 - at**2) / 2)
    stiff, spin = d @ d @ d @ d, d @ np.diag(tension) @ d + np.eye(n + 1)
    for row, condition in ((0, (d @ d)[0]), (1, (d @ d @ d)[0]), (n, np.eye(n + 1)[n]), (n - 1, d[n])):
        stiff[row], spin[row] = condition, 0.0
    square = 1 / np.linalg.eigvals(np.linalg.solve(stiff, spin)).real.max()
    critical = gb.critical_speed(
        gb.assemble(slender(1e4), gb.Model(kind, *counts)),
        gb.Hub(radius=radius, rate=gb.constant(1.0), pointing="inward"),
    )
    assert critical.value == pytest.approx(np.sqrt(square), rel=2e-5)
    assert (critical.kind, critical.direction) == ("divergence", "y")


@pytest.mark.parametrize(("load", "kept"), [(15.0, True), (21.0, False)])
@pytest.mark.parametrize("kind", ["FOAM", "exact"])
def test_a_column_under_a_follower_force_is_stable_up_to_becks_load(kind, load, kept):
    """It was called unstable where the symmetric part of its stiffness, which decides nothing, is indefinite."""
    structure = column(MODELS[kind], gb.Load(1.0, force=(-load, 0.0, 0.0), follower=True))
    resting = gb.static(structure)
    assert resting.stable == kept
    system = gb.linearize(structure, gb.Flight(z=gb.constant(0.0)))
    assert any("not stable: flutter along z" in each for each in system.warnings) == (not kept)
    assert gb.modes(structure, gb.Flight(z=gb.constant(0.0))).stable == kept


def test_one_shape_under_becks_load_is_unstable_with_more():
    """It flutters by two motions, of which one shape has none."""
    for load, flutters in ((0.98 * BECK, False), (1.02 * BECK, True)):
        push = gb.Load(1.0, force=(-load, 0.0, 0.0), follower=True)
        one, eight = (column(gb.Model("FOAM", 1, 0, z), push) for z in (1, 8))
        assert gb.modes(one).stable and gb.modes(eight).stable != flutters
        for answer, said in (
            (gb.modes(one), flutters),
            (gb.linearize(one, gb.Flight(z=0.0)), flutters),
            (gb.modes(eight), False),
        ):
            assert any(each.startswith("not stable with more shapes: ") for each in answer.warnings) == said


def test_a_run_under_a_follower_force_below_becks_load_is_not_warned_of():
    structure = column(MODELS["FOAM"], gb.Load(1.0, force=(-15.0, 0.0, 0.0), follower=True))
    response = gb.simulate(structure, gb.Flight(z=gb.constant(1e-3)), duration=0.1, step=1e-3, estimate=False)
    assert not any("not stable" in each for each in response.warnings)
    beyond = column(MODELS["FOAM"], gb.Load(1.0, force=(-21.0, 0.0, 0.0), follower=True))
    response = gb.simulate(beyond, gb.Flight(z=gb.constant(1e-3)), duration=0.1, step=1e-3, estimate=False)
    assert any("equilibrium that is not stable" in each for each in response.warnings)
