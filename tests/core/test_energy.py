"""Identities of the kinetic energy and its truncation."""

from __future__ import annotations

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from gbeam.mechanics.energy import rest_matrices, second_order
from gbeam.mechanics.field import exact_field

from gbeam import Model, PointMass, assemble
from gbeam.mechanics.fields.basis import bending_shapes, quadrature

from .helpers import BODY, BOX, COMPLETE, MATERIAL, SPATIAL, TIP, beam, planar, spatial, states

IDENTITY = 1e-12  # relative


@eqx.filter_jit
def kinetic(energy, u, q, qd):  # type: ignore[no-untyped-def]
    return energy.kinetic(u, q, qd)


def body_moments() -> tuple[float, np.ndarray, np.ndarray]:
    """Mass, first moment and inertia about the root of beam, tip mass and body, by hand."""
    line = MATERIAL.density * float(BOX.at(0.0).area)
    r = np.array([BODY.at, 0, 0]) + BODY.offset
    mass = line * 8 + TIP.mass + BODY.mass
    first = np.array([line * 32 + TIP.mass * 8, 0, 0]) + BODY.mass * r
    slender = line * 8**3 / 3 + TIP.mass * 64
    inertia = np.diag([0, slender, slender]) + np.diag(BODY.inertia)
    return mass, first, inertia + BODY.mass * (r @ r * np.eye(3) - np.outer(r, r))


@pytest.mark.parametrize("name", SPATIAL)
def test_undeformed_beam_is_a_rigid_body(name: str) -> None:
    mass, first, inertia = body_moments()
    v, w = states(3, 2, 1.0, seed=1)
    wanted = 0.5 * mass * v @ v + v @ np.cross(w, first) + 0.5 * w @ inertia @ w
    zero = np.zeros(5)
    got = kinetic(spatial(name).system.energy, np.concatenate([v, w]), zero, zero)
    np.testing.assert_allclose(got, wanted, rtol=IDENTITY)


@pytest.mark.parametrize("name", SPATIAL)
def test_on_a_base_at_rest_it_is_half_qd_m_qd(name: str) -> None:
    energy = spatial(name).system.energy
    qd = states(5, 1, 0.5, seed=2)[0]
    mass, _ = rest_matrices(energy)
    got = kinetic(energy, np.zeros(6), np.zeros(5), qd)
    np.testing.assert_allclose(got, 0.5 * qd @ mass @ qd, rtol=IDENTITY)
    np.testing.assert_allclose(mass, mass.T, atol=1e-12)
    assert np.linalg.eigvalsh(mass).min() > 0


@pytest.mark.parametrize("name", SPATIAL)
def test_homogeneous_of_degree_two_in_all_rates(name: str) -> None:
    energy = spatial(name).system.energy
    u, q, qd = np.split(states(16, 1, 0.3, seed=3)[0], [6, 11])
    np.testing.assert_allclose(kinetic(energy, 1.7 * u, q, 1.7 * qd), 1.7**2 * kinetic(energy, u, q, qd), rtol=IDENTITY)


@pytest.mark.parametrize("name", COMPLETE)
def test_truncation_leaves_a_remainder_of_third_order(name: str) -> None:
    complete = planar(name).system.energy
    truncated = second_order(complete)
    u, q, qd = np.split(states(14, 1, 0.3, seed=14)[0], [6, 10])
    remainder = [
        float(kinetic(complete, u, s * q, s * qd) - kinetic(truncated, u, s * q, s * qd)) for s in (0.008, 0.004)
    ]
    assert abs(remainder[0]) > 1e-10  # far above rounding: the complete energy has third-order terms
    assert remainder[0] / remainder[1] == pytest.approx(8, rel=0.1)


def test_foreshortening_is_what_foam_adds_to_tlam() -> None:
    """FOAM is CFOAM truncated; a foreshortened beam lies nearer to the axis of the spin than TLAM's."""
    foam, cfoam, tlam = (planar(name).system.energy for name in ("FOAM", "CFOAM", "TLAM"))
    for ours, wanted in zip(jax.tree.leaves(foam), jax.tree.leaves(second_order(cfoam)), strict=True):
        np.testing.assert_allclose(ours, wanted, atol=1e-12)
    spin = np.array([0, 0, 0, 0, 0, 2.0])
    q = states(4, 1, 0.3, seed=5)[0] * [0, 1, 1, 1]
    assert kinetic(foam, spin, q, 0 * q) < kinetic(tlam, spin, q, 0 * q)


def test_point_body_adds_its_own_energy() -> None:
    """Adding physics is adding one term: with the tip mass T grows by ½ m |v|² of the tip."""
    model = Model("CFOAM", 1, 2, 2)
    bare, loaded = (assemble(beam(*masses), model) for masses in ((), (PointMass(8.0, 0.7),)))
    u, q, qd = np.split(states(16, 1, 0.3, seed=6)[0], [6, 11])
    displacement, rate = jax.jvp(lambda q: bare.displacement(q)[-1], (jnp.array(q),), (jnp.array(qd),))
    v = u[:3] + np.cross(u[3:], np.array([8.0, 0, 0]) + displacement) + rate
    difference = kinetic(loaded.system.energy, u, q, qd) - kinetic(bare.system.energy, u, q, qd)
    np.testing.assert_allclose(difference, 0.5 * 0.7 * v @ v, rtol=1e-10)


def test_rotary_inertia_of_a_tip_body() -> None:
    """Its mass matrix term is J f'(l) f'(l)ᵀ: about z for bending along y, about y for bending along z."""
    inertia = (0.2, 0.3, 0.4)
    with_, without = (
        np.asarray(
            rest_matrices(assemble(beam(PointMass(6.0, 1.0, inertia=j)), Model("CFOAM", 0, 2, 2)).system.energy)[0]
        )
        for j in (inertia, (0.0, 0.0, 0.0))
    )
    slope = bending_shapes(np.array([6.0]), 8.0, 2).slope[0]
    none = np.zeros((2, 2))
    about = np.outer(slope, slope)
    wanted = np.block([[inertia[2] * about, none], [none, inertia[1] * about]])
    np.testing.assert_allclose(with_ - without, wanted, atol=1e-12)


def test_exact_field_wants_the_quadrature_nodes_first() -> None:
    rule = quadrature(1.0, 8)
    with pytest.raises(ValueError, match="start with the quadrature nodes"):
        exact_field(1.0, rule, np.array([1.0]), (1, 1, 1))
