"""Identities of the kinetic energy and its truncation, and of the mass that the equations take from the particles."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

from gbeam import Model, PointMass, assemble
from gbeam.mechanics import bending_shapes

from ..differences import along
from ..lagrange import Complete, energy_of, second_order
from ..specimens import BODY, COMPLETE, LENGTH, RHO_A, TIP, appendage, laden, states

IDENTITY = 1e-12  # relative
SPATIAL = ("FOAM", "CFOAM", "exact")
SIZE = 7  # coordinates of the laden beam


@cache
def energy(name: str) -> Any:
    return energy_of(laden(name))


def body_moments() -> tuple[float, np.ndarray, np.ndarray]:
    """Mass, first moment and inertia about the root of beam, tip mass and body, by hand."""
    r = np.array([BODY.at, 0, 0]) + BODY.offset
    mass = RHO_A * 8 + TIP.mass + BODY.mass
    first = np.array([RHO_A * 32 + TIP.mass * 8, 0, 0]) + BODY.mass * r
    slender = RHO_A * 8**3 / 3 + TIP.mass * 64
    inertia = np.diag([0, slender, slender]) + np.diag(BODY.inertia)
    return mass, first, inertia + BODY.mass * (r @ r * np.eye(3) - np.outer(r, r))


@pytest.mark.parametrize("name", SPATIAL)
def test_undeformed_beam_is_a_rigid_body(name: str) -> None:
    mass, first, inertia = body_moments()
    v, w = states(3, 2, 1.0, seed=1)
    wanted = 0.5 * mass * v @ v + v @ np.cross(w, first) + 0.5 * w @ inertia @ w
    zero = np.zeros(SIZE)
    np.testing.assert_allclose(energy(name).kinetic(np.concatenate([v, w]), zero, zero), wanted, rtol=IDENTITY)
    # As the coefficients have it: mass, first and second moments.
    m, moment, (xx, yy, zz, xy, yz, zx) = np.split(laden(name).coefficients.rigid, [1, 4])
    second = np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]])
    np.testing.assert_allclose(m, mass, rtol=IDENTITY)
    np.testing.assert_allclose(moment, first, rtol=IDENTITY)
    np.testing.assert_allclose(np.trace(second) * np.eye(3) - second, inertia, rtol=IDENTITY, atol=1e-12)


@pytest.mark.parametrize("name", SPATIAL)
def test_on_a_base_at_rest_it_is_half_qd_m_qd(name: str) -> None:
    qd, mass = states(SIZE, 1, 0.5, seed=2)[0], laden(name).coefficients.mass
    at_rest = energy(name).kinetic(np.zeros(6), np.zeros(SIZE), qd)
    np.testing.assert_allclose(at_rest, 0.5 * qd @ mass @ qd, rtol=IDENTITY)
    np.testing.assert_allclose(mass, mass.T, atol=1e-12)
    assert np.linalg.eigvalsh(mass).min() > 0


@pytest.mark.parametrize("name", SPATIAL)
def test_homogeneous_of_degree_two_in_all_rates(name: str) -> None:
    u, q, qd = np.split(states(6 + 2 * SIZE, 1, 0.3, seed=3)[0], [6, 6 + SIZE])
    kinetic = energy(name).kinetic
    np.testing.assert_allclose(kinetic(1.7 * u, q, 1.7 * qd), 1.7**2 * kinetic(u, q, qd), rtol=IDENTITY)


@pytest.mark.parametrize("name", COMPLETE)
def test_truncation_leaves_a_remainder_of_third_order(name: str) -> None:
    complete = energy(name)
    truncated = second_order(complete)
    u, q, qd = np.split(states(6 + 2 * SIZE, 1, 0.3, seed=14)[0], [6, 6 + SIZE])
    remainder = [
        float(complete.kinetic(u, s * q, s * qd) - truncated.kinetic(u, s * q, s * qd)) for s in (0.008, 0.004)
    ]
    assert abs(remainder[0]) > 1e-10  # far above rounding: the complete energy has third-order terms
    assert remainder[0] / remainder[1] == pytest.approx(8, rel=0.1)


def test_foreshortening_is_what_foam_adds_to_tlam() -> None:
    """FOAM is CFOAM truncated; a foreshortened beam lies nearer to the axis of the spin than TLAM's."""
    foam, cfoam = (laden(name).coefficients for name in ("FOAM", "CFOAM"))
    for name in ("mass", "stiffness", "gyroscopic", "k_ww", "k_al", "k_a", "f_ww", "f_al", "f_a", "rigid"):
        np.testing.assert_allclose(getattr(foam, name), getattr(cfoam, name), atol=1e-12)
    spin = np.array([0, 0, 0, 0, 0, 2.0])
    q = states(SIZE, 1, 0.3, seed=5)[0] * [0, 1, 1, 0, 0, 0, 0]
    assert energy("FOAM").kinetic(spin, q, 0 * q) < energy("TLAM").kinetic(spin, q, 0 * q)


def test_point_body_adds_its_own_energy() -> None:
    """Adding physics is adding one term: with the tip mass T grows by ½ m |v|² of the tip."""
    model = Model("CFOAM", 1, 2, 2)
    bare, loaded = (assemble(appendage(*masses), model) for masses in ((), (PointMass(LENGTH, 0.7),)))
    u, q, qd = np.split(states(16, 1, 0.3, seed=6)[0], [6, 11])
    v = u[:3] + np.cross(u[3:], np.array([LENGTH, 0, 0]) + bare.displacement(q)[-1])
    v = v + along(lambda q: bare.displacement(q)[-1], q, qd)
    with_, without = (Complete(s).kinetic(u, q, qd) for s in (loaded, bare))
    np.testing.assert_allclose(with_ - without, 0.5 * 0.7 * v @ v, rtol=1e-10)


def test_rotary_inertia_of_a_tip_body() -> None:
    """Its mass matrix term is J f'(l) f'(l)ᵀ: about z for bending along y, about y for bending along z."""
    inertia = (0.2, 0.3, 0.4)
    with_, without = (
        assemble(appendage(PointMass(6.0, 1.0, inertia=j)), Model("CFOAM", 0, 2, 2)).coefficients.mass
        for j in (inertia, (0.0, 0.0, 0.0))
    )
    slope = bending_shapes(np.array([6.0]), LENGTH, 2).slope[0]
    none = np.zeros((2, 2))
    about = np.outer(slope, slope)
    wanted = np.block([[inertia[2] * about, none], [none, inertia[1] * about]])
    np.testing.assert_allclose(with_ - without, wanted, atol=1e-12)
