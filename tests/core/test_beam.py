"""The structure: every shape of section, tapers, bodies as particles, and all that is refused."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gbeam import Beam, InputError, Material, PointMass, Section

EXACT = 1e-13  # relative, closed forms
CELLS = 3e-3  # relative, of counting cells
STEEL = Material(7800.0, 2.1e11)
ROUND = Section.circle(0.02)


def tapered(stations: list[float], **dimensions: object) -> Section:
    return Section.of("rectangle", stations, **{"width": 0.02, "thickness": 0.004, **dimensions})  # type: ignore[arg-type]


# what is refused: where, part of the problem, how
REFUSED: list[tuple[str, str, Callable[[], object]]] = [
    ("density", "is 'heavy'", lambda: Material("heavy", 7e10)),  # type: ignore[arg-type]
    ("density", "is None", lambda: Material(None, 7e10)),  # type: ignore[arg-type]
    ("density", "is 0 kg/m³", lambda: Material(0.0, 7e10)),
    ("density", "is -1 kg/m³", lambda: Material(-1.0, 7e10)),
    ("youngs_modulus", "is inf Pa", lambda: Material(2700.0, np.inf)),
    ("youngs_modulus", "is nan Pa", lambda: Material(2700.0, np.nan)),
    ("shape", "is 'square'", lambda: Section.of("square", width=0.1)),
    ("thickness", "is missing", lambda: Section.of("rectangle", width=0.1)),
    ("thickness", "is missing", lambda: Section.of("rectangle", width=0.1, thickness=None)),
    ("wall", "does not belong to a circle", lambda: Section.of("circle", diameter=0.1, wall=0.01)),
    ("width", "is -0.02 m", lambda: Section.rectangle(-0.02, 0.004)),
    ("area", "is 0 m²", lambda: Section.general(0.0, 1e-8, 1e-8)),
    ("inertia_y", "is nan m⁴", lambda: Section.general(1e-4, np.nan, 1e-8)),
    ("extreme_fibre_z", "is -0.1 m", lambda: Section.general(1e-4, 1e-8, 1e-8, extreme_fibre_z=-0.1)),
    ("thickness[1]", "is 0 m", lambda: tapered([0.0, 1.0], thickness=[0.004, 0.0])),
    ("thickness", "has 3 value(s) for 2 station(s)", lambda: tapered([0.0, 1.0], thickness=[1.0, 1.0, 1.0])),
    ("width", "has 2 value(s) for 1 station(s)", lambda: Section.rectangle([0.1, 0.2], 0.004)),
    ("stations[2]", "is 0.5 m, after 0.5 m", lambda: tapered([0.0, 0.5, 0.5])),
    ("stations[1]", "is nan m", lambda: tapered([0.0, np.nan, 1.0])),
    ("stations", "has one value", lambda: tapered([0.0])),
    ("stations", "not finite", lambda: tapered([0.0, np.inf])),
    ("stations", "not finite", lambda: tapered([-np.inf, 1.0])),
    ("wall", "is 0.03 m", lambda: Section.tube(0.05, 0.03)),
    ("wall", "is 0.02 m", lambda: Section.tube([0.05, 0.03], 0.02, [0.0, 1.0])),
    ("at", "is -0.1 m", lambda: PointMass(-0.1, 1.0)),
    ("mass", "is -1 kg", lambda: PointMass(0.1, -1.0)),
    ("mass", "is 0 kg with a moment of inertia", lambda: PointMass(0.1, 0.0, inertia=(1.0, 1.0, 1.0))),
    ("inertia", "is (1.0, 1.0)", lambda: PointMass(0.1, 1.0, inertia=(1.0, 1.0))),  # type: ignore[arg-type]
    ("inertia[2]", "nan", lambda: PointMass(0.1, 1.0, inertia=(1.0, 1.0, np.nan))),
    ("inertia[1]", "is -1 kg m²", lambda: PointMass(0.1, 1.0, inertia=(1.0, -1.0, 1.0))),
    ("inertia", "kg m²", lambda: PointMass(0.1, 1.0, inertia=(1.0, 1.0, 2.1))),
    ("offset[1]", "inf", lambda: PointMass(0.1, 1.0, offset=(0.0, np.inf, 0.0))),
    ("length", "is 0 m", lambda: Beam(0.0, ROUND, STEEL)),
    ("masses[1].at", "beyond the tip", lambda: Beam(1.0, ROUND, STEEL, [PointMass(1.0, 1), PointMass(1.1, 1)])),
    ("section.stations", "cover 0.1 to 1 m", lambda: Beam(1.0, tapered([0.1, 1.0]), STEEL)),
    ("section.stations", "cover 0 to 0.9 m", lambda: Beam(1.0, tapered([0.0, 0.9]), STEEL)),
    ("section.stations", "cover 0 to 1.1 m", lambda: Beam(1.0, tapered([0.0, 1.1]), STEEL)),
    ("damping_ratio", "is -0.01", lambda: Beam(1.0, ROUND, STEEL, damping_ratio=-0.01)),
    ("damping_ratio", "is 1", lambda: Beam(1.0, ROUND, STEEL, damping_ratio=1.0)),
    ("damping_ratio", "is 'little'", lambda: Beam(1.0, ROUND, STEEL, damping_ratio="little")),
    ("damping_ratio[1]", "is nan", lambda: Beam(1.0, ROUND, STEEL, damping_ratio=[0.01, np.nan])),
]


@pytest.mark.parametrize(
    ("where", "problem", "make"), REFUSED, ids=[f"{where}: {problem}" for where, problem, _ in REFUSED]
)
def test_refused_with_place_problem_and_fix(where: str, problem: str, make: Callable[[], object]) -> None:
    with pytest.raises(InputError) as caught:
        make()
    assert caught.value.where == where
    assert problem in caught.value.problem
    assert caught.value.fix
    assert str(caught.value).startswith(where)


def test_error_seen_from_further_out() -> None:
    inner = InputError("masses[0].at", "is 2 m", "give less")
    assert inner.within("beam").where == "beam.masses[0].at"
    assert InputError("[1]", "is bad", "mend it").within("beam.masses").where == "beam.masses[1]"
    assert InputError("", "is bad", "mend it").within("beam").where == "beam"


def test_limits_that_are_allowed() -> None:
    assert PointMass(0.0, 0.0).particles()[0] == [0.0]
    assert PointMass(0.1, 1.0, inertia=(1.0, 1.0, 2.0)).second_moments == (1.0, 1.0, 0.0)  # a flat plate
    assert Beam(1.0, ROUND, STEEL, [PointMass(1.0, 1.0)]).masses == (PointMass(1.0, 1.0),)
    assert Beam(1.0, ROUND, STEEL, damping_ratio=[0.0, 0.5]).damping_ratio == (0.0, 0.5)


def moments(inside: Callable[[np.ndarray, np.ndarray], np.ndarray], half: float) -> tuple[float, float, float]:
    """Area, ∫z² dA, ∫y² dA by counting cells: independent of all closed forms."""
    line = (np.arange(2000) + 0.5) / 2000 * 2 * half - half
    y, z = np.meshgrid(line, line, indexing="ij")
    cell = inside(y, z) * (line[1] - line[0]) ** 2
    return float(cell.sum()), float((cell * z**2).sum()), float((cell * y**2).sum())


@pytest.mark.parametrize(
    ("section", "inside", "fibres"),
    [
        (Section.rectangle(0.06, 0.03), lambda y, z: (abs(y) < 0.03) & (abs(z) < 0.015), (0.03, 0.015)),
        (Section.circle(0.06), lambda y, z: y**2 + z**2 < 0.03**2, (0.03, 0.03)),
        (Section.tube(0.06, 0.01), lambda y, z: (y**2 + z**2 < 0.03**2) & (y**2 + z**2 > 0.02**2), (0.03, 0.03)),
    ],
    ids=["rectangle", "circle", "tube"],
)
def test_section_against_counted_cells(
    section: Section, inside: Callable[[np.ndarray, np.ndarray], np.ndarray], fibres: tuple[float, float]
) -> None:
    at = section.at(0.3)
    np.testing.assert_allclose((at.area, at.inertia_y, at.inertia_z), moments(inside, 0.036), rtol=CELLS)
    assert (at.extreme_fibre_y, at.extreme_fibre_z) == fibres


def test_closed_forms() -> None:
    flat = Section.rectangle(0.02, 0.004).at(0.0)  # 2020 Table 1: I_y = b h³/12, I_z = h b³/12
    np.testing.assert_allclose(
        (flat.area, flat.inertia_y, flat.inertia_z), (8e-5, 0.02 * 0.004**3 / 12, 0.004 * 0.02**3 / 12), rtol=EXACT
    )
    full, solid = Section.tube(0.06, 0.03).at(0.0), Section.circle(0.06).at(0.0)
    np.testing.assert_allclose((full.area, full.inertia_y), (solid.area, solid.inertia_y), rtol=EXACT)


def test_general_section_knows_only_what_it_was_given() -> None:
    given_ = Section.general(1e-4, 2e-8, 3e-8, extreme_fibre_z=0.01).at([0.0, 0.5])
    np.testing.assert_array_equal(given_.area, [1e-4, 1e-4])
    np.testing.assert_array_equal(given_.inertia_y, [2e-8, 2e-8])
    np.testing.assert_array_equal(given_.inertia_z, [3e-8, 3e-8])
    np.testing.assert_array_equal(given_.extreme_fibre_z, [0.01, 0.01])
    assert np.isnan(given_.extreme_fibre_y).all()


def test_taper_interpolates_dimensions_not_properties() -> None:
    taper = Section.rectangle([0.04, 0.02, 0.02], [0.004, 0.002, 0.001], [0.0, 0.6, 1.0])
    at = taper.at([0.0, 0.3, 0.6, 0.8, 1.0])
    width, thickness = np.array([0.04, 0.03, 0.02, 0.02, 0.02]), np.array([0.004, 0.003, 0.002, 0.0015, 0.001])
    np.testing.assert_allclose(at.area, width * thickness, rtol=EXACT)
    np.testing.assert_allclose(at.inertia_y, width * thickness**3 / 12, rtol=EXACT)
    np.testing.assert_allclose(at.extreme_fibre_y, width / 2, rtol=EXACT)


def test_scalar_dimension_holds_at_every_station() -> None:
    assert Section.rectangle([0.04, 0.02], 0.004, [0.0, 1.0]).dimensions["thickness"] == (0.004, 0.004)


size = st.floats(0.0, 1.0)


@settings(max_examples=30)
@given(st.floats(1e-3, 1e3), st.tuples(size, size, size), st.tuples(*[st.floats(-1.0, 1.0)] * 3))
def test_particles_are_the_body(
    mass: float, extents: tuple[float, float, float], centre: tuple[float, float, float]
) -> None:
    second = mass * np.square(extents)  # ∫x², ∫y², ∫z² dm of any body with these radii of gyration
    inertia = tuple(float(second.sum() - s) for s in second)
    body = PointMass(0.1, mass, inertia=inertia, offset=centre)  # type: ignore[arg-type]
    m, r = body.particles()
    np.testing.assert_allclose(m.sum(), mass, rtol=EXACT)
    np.testing.assert_allclose(m @ r / mass, centre, atol=1e-14)
    arm = r - np.array(centre)
    about_centre = np.einsum(
        "k,kij->ij", m, np.sum(arm**2, 1)[:, None, None] * np.eye(3) - arm[:, :, None] * arm[:, None]
    )
    np.testing.assert_allclose(about_centre, np.diag(inertia), atol=1e-7 * max(mass, 1e-3))
