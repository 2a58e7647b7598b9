"""A root held by springs, in every model."""

from __future__ import annotations

import numpy as np
import pytest
from exact_beams import AREA, DENSITY, EI, INERTIA, LENGTH, MODULUS, with_bodies
from scipy.optimize import brentq

from gbeam import Beam, InputError, Load, Material, Model, PointMass, Root, Section, assemble, solve_equilibrium
from gbeam.results import Base

from ..specimens import appendage

BOX, METAL = Section.general(AREA, INERTIA, INERTIA), Material(DENSITY, MODULUS)
STILL = Base(*np.zeros((3, 3)))
TIP = PointMass(LENGTH, 0.1)
SOFT = Root(rotation_y=5 * EI / LENGTH, translation_z=40 * EI / LENGTH**3)


def frequencies(root: Root, model: Model) -> np.ndarray:
    return assemble(appendage(TIP, root=root), model).rest[0]


@pytest.mark.parametrize("kind", ["TLAM", "FOAM", "SFOAM", "CFOAM", "exact"])
def test_frequency_equation(kind: str) -> None:
    truth = with_bodies(3, mass=0.1, rotation=5 * EI / LENGTH, translation=40 * EI / LENGTH**3)
    np.testing.assert_allclose(frequencies(SOFT, Model(kind, 0, 0, 4, "adapted"))[:3], truth, rtol=1e-7)


def test_clamped_free_shapes_converge_to_it_too() -> None:
    truth = with_bodies(3, mass=0.1, rotation=5 * EI / LENGTH, translation=40 * EI / LENGTH**3)
    np.testing.assert_allclose(frequencies(SOFT, Model("CFOAM", 0, 0, 8))[:3], truth, rtol=3e-3)


@pytest.mark.parametrize("kind", ["CFOAM", "exact"])
def test_stiff_springs_clamp(kind: str) -> None:
    ways = [f"{motion}_{axis}" for motion in ("translation", "rotation") for axis in "xyz"]
    stiff = Root(**dict.fromkeys(filter("rotation_x".__ne__, ways), 1e9))
    clamped = frequencies(Root(), Model(kind, 1, 3, 3, "adapted"))
    np.testing.assert_allclose(frequencies(stiff, Model(kind, 1, 3, 3, "adapted"))[:6], clamped[:6], rtol=1e-5)


def test_a_stiff_beam_turns_by_a_large_angle_about_its_root() -> None:
    """k φ = F L cos φ: the root's rotation is exact, not linear."""
    stiff = Section.general(AREA, 1e3 * INERTIA, 1e3 * INERTIA)
    hinge = Root(rotation_y=100.0, translation_z=1e9)
    beam = Beam(2.0, stiff, METAL, root=hinge, loads=[Load(2.0, force=(0.0, 0.0, 80.0))])
    structure = assemble(beam, Model("exact", 0, 0, 4))
    moved = structure.displacement(solve_equilibrium(structure, STILL).q)[-1]
    angle = brentq(lambda p: 100.0 * p - 160.0 * np.cos(p), 0, 2)
    np.testing.assert_allclose(moved, [2 * np.cos(angle) - 2, 0, 2 * np.sin(angle)], atol=2e-3)


@pytest.mark.parametrize("kind", ["FOAM", "exact"])
def test_a_tip_force_moves_root_and_beam(kind: str) -> None:
    """w(L) = F (1/k_t + L²/k_r + L³/3EI) for small forces."""
    force = 1e-4
    beam = Beam(LENGTH, BOX, METAL, root=SOFT, loads=[Load(LENGTH, force=(0.0, 0.0, force))])
    structure = assemble(beam, Model(kind, 0, 0, 4, "adapted" if kind == "exact" else "clamped-free"))
    moved = structure.displacement(solve_equilibrium(structure, STILL).q)[-1]
    wanted = force * (1 / SOFT.springs["translation_z"] + LENGTH**2 / SOFT.springs["rotation_y"] + LENGTH**3 / (3 * EI))
    assert float(moved[2]) == pytest.approx(wanted, rel=1e-3)


def test_damping_counts_the_springs_modes() -> None:
    beam = Beam(LENGTH, BOX, METAL, [TIP], [0.01, 0.02, 0.03, 0.04], root=SOFT)
    structure = assemble(beam, Model("CFOAM", 0, 0, 2))
    frequency, modes = structure.rest
    ratio = np.diag(modes.T @ structure.coefficients.damping @ modes) / (2 * frequency)
    np.testing.assert_allclose(ratio, beam.damping_ratio, rtol=1e-9)
    assert structure.size == 4


def test_an_impossible_spring_is_refused() -> None:
    with pytest.raises(InputError, match="rotation_y is -1 N m/rad"):
        Root(rotation_y=-1.0)
