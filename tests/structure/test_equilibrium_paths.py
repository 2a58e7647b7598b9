"""Equilibria under growing loads beyond limit points, against closed forms of frames and shallow arches."""

from __future__ import annotations

import numpy as np
import pytest

import gbeam as gb

from .test_arches import toggle
from .test_supports import DENSITY, EI, LENGTH, MODULUS, PIN, THICKNESS, WIDTH

FLAT = gb.Material(DENSITY, MODULUS, poissons_ratio=0.0)
UNIT, WAVE = 2 * THICKNESS / np.sqrt(12), np.pi / LENGTH  # a rise of 2 √(I/A), and that of half a sine


def shallow(rise: float, kind: str, points: int = 15, **shapes: int) -> gb.Structure:
    """Pinned arch of half a sine with a rise of `rise` units, under the load whose half sine has q̂ = 1."""
    x = np.linspace(0, LENGTH, points)
    line = gb.Line.of_points(np.stack([x, 0 * x, rise * UNIT * np.sin(WAVE * x)], axis=1))
    load = gb.Load(distributed=(0.0, 0.0, -EI * WAVE**4 * UNIT * np.pi / 4))
    middle, foot = gb.Point("middle", at=line.length / 2), gb.Support("tip", ["x", "z"])
    section = gb.Section.rectangle(WIDTH, THICKNESS)
    arch = gb.Beam(line.length, section, FLAT, supports=[PIN, foot], line=line, loads=[load], points=[middle])
    return gb.assemble(arch, kind, **shapes)  # type: ignore[arg-type]


def sinking(path: gb.EquilibriumPath) -> np.ndarray:
    """Displacement along -z of the point in the middle, m."""
    return -path.displacement[:, [name.rpartition(".")[2] for name in path.points].index("middle"), 2]


@pytest.mark.parametrize("kind", ["FOAM", "exact"])
def test_a_shallow_arch_snaps_at_the_load_of_the_closed_form_and_goes_on_beyond(kind: str) -> None:
    """q̂ = (λ − η) + (λ² − η²) η for the rise η left, between limits at η = ±√((λ² − 1)/3).

    A uniform load bends it a little besides, as odd multiples of half the sine: by a hundredth or so.
    """
    rise = 1.5
    path = gb.equilibrium_path(shallow(rise, kind, axial=1, z=5), upper=4.0, errors=False)
    left = rise - sinking(path) / UNIT
    load = (rise - left) + (rise**2 - left**2) * left
    assert left.min() < -1.0  # it has snapped through
    assert path.factor == pytest.approx(load, abs=0.03 * load.max())
    limits = np.array([1, -1]) * np.sqrt((rise**2 - 1) / 3)
    assert [point.kind for point in path.critical] == ["limit point"] * 2
    closed = (rise - limits) + (rise**2 - limits**2) * limits
    assert [point.factor for point in path.critical] == pytest.approx(closed, rel=0.01)
    falls = np.diff(path.factor) < 0
    assert falls.any() and not path.stable[1:-1][falls[1:] & falls[:-1]].any()


def test_a_higher_arch_leaves_its_path_sideways_before_it_snaps() -> None:
    """Its thrust reaches the second load of Euler, λ² − η² = 4, where it may bend as a whole sine."""
    rise = 3.0
    path = gb.equilibrium_path(shallow(rise, "FOAM", axial=1, z=6), upper=12.0, errors=False)
    left = np.sqrt(rise**2 - 4)
    branch = path.critical[0]
    assert branch.kind == "branch point"
    assert branch.factor == pytest.approx(rise - left + 4 * left, rel=0.02)


def test_a_pinned_arch_under_pressure_buckles_sideways_along_its_path() -> None:
    """EI/R³ (π²/α² − 1) of a half-angle α, under a pressure that follows it."""
    radius, angle = 0.5, np.pi / 4
    arc = gb.Line(2 * angle * radius, lambda x: np.stack([0 * x, 1 / radius + 0 * x, 0 * x], axis=1))
    critical = EI / radius**3 * ((np.pi / angle) ** 2 - 1)
    pressure, foot = gb.Load(distributed=(0.0, 0.0, -critical), follower=True), gb.Support("tip", ["x", "z"])
    section = gb.Section.rectangle(WIDTH, THICKNESS)
    arch = gb.Beam(arc.length, section, FLAT, supports=[PIN, foot], line=arc, loads=[pressure])
    path = gb.equilibrium_path(gb.assemble(arch, "FOAM", axial=1, z=4), upper=1.2, errors=False)
    assert path.critical[0].kind == "branch point"
    assert path.critical[0].factor == pytest.approx(1.0, rel=2e-3)


@pytest.mark.parametrize("kind", ["FOAM", "exact"])
def test_williams_toggle_frame_is_followed_through_its_snap(kind: str) -> None:
    """The whole curve by the functions of beam-columns, whose thrust grows and falls along it."""
    inch, pound = 0.0254, 4.4482216152605
    length, rise, axial, bending = 12.943 * inch, 0.386 * inch, 1.885e6 * pound, 9.27e3 * pound * inch**2
    thrusts = np.linspace(10.0, 1.9 * np.pi**2 * bending / length**2, 8000)
    curve = [toggle(thrust, length, rise, axial, bending, flat) for flat in (False, True) for thrust in thrusts]
    loads, sunk = np.array(curve).T
    known = ~np.isnan(loads)
    thickness = np.sqrt(12 * bending / axial)
    section = gb.Section.rectangle(axial / MODULUS / thickness, thickness)
    line = gb.Line.of_points([[0, 0, 0], [length, 0, rise], [2 * length, 0, 0]], smooth=False)
    push = gb.Load(at="middle", force=(0.0, 0.0, -pound))
    apex, clamp = gb.Point("middle", at=line.length / 2), gb.Support("tip", ["x", "z", "ry"])
    frame = gb.Beam(line.length, section, FLAT, supports=[clamp], line=line, loads=[push], points=[apex])
    path = gb.equilibrium_path(gb.assemble(frame, kind, axial=2, z=6), upper=45.0, errors=False)  # type: ignore[arg-type]
    limits = [point.factor for point in path.critical]
    assert limits[0] == pytest.approx(33.89, rel=2e-3) and 30 < limits[1] < limits[0]
    points = np.stack([path.factor * pound / loads[known].max(), sinking(path) / rise], axis=1)
    closed = np.stack([loads[known] / loads[known].max(), sunk[known] / rise], axis=1)
    distance = np.linalg.norm(points[:, None] - closed[None], axis=-1).min(axis=1)
    assert distance.max() < 0.01


def test_its_error_bounds_that_of_few_shapes_and_a_bar_that_twists_is_told() -> None:
    """A narrow strip on edge is pushed in its plane: it leaves the path sideways, which a flat model does not see."""
    rise = 1.5
    few = gb.equilibrium_path(shallow(rise, "FOAM", 5, axial=1, z=1), upper=2.5)
    many = gb.equilibrium_path(shallow(rise, "exact", 5, axial=2, z=7), upper=2.5, errors=False)
    for one, other in zip(few.critical, many.critical, strict=True):
        true = abs(one.factor / other.factor - 1)
        assert true < 3 * one.errors.total and one.errors.total < 3 * true + 0.01
    assert 0 < few.errors.total < 0.2


def test_without_a_load_there_is_no_path() -> None:
    strip = gb.Section.rectangle(WIDTH, THICKNESS)
    bare = gb.assemble(gb.Beam(LENGTH, strip, FLAT), "FOAM", z=3)
    with pytest.raises(gb.InputError, match=r"beam\.loads has no load that acts; add one"):
        gb.equilibrium_path(bare)
    with pytest.raises(gb.InputError, match="upper is -1"):
        gb.equilibrium_path(bare, upper=-1.0)
