"""D'Alembert's sum against Lagrange's equations of T by automatic differentiation, for every kind of model.

The beam carries a tip mass and a body off its axis, is held by springs and loaded by a follower and a dead load; the
hub has a spring, a damper and gravity, and the beam points inward on it at an angle.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

from gbeam import Structure
from gbeam.results import Base

from ..differences import jacobian, rate
from ..lagrange import (
    Complete,
    Quadratic,
    coefficients,
    energy_of,
    hub_kinetic,
    on_free_hub,
    on_prescribed_base,
    second_order,
    twist,
)
from ..residuals import MOUNTED_HUB, gravity_potential, on_base, on_hub, virtual_work
from ..specimens import HUB_INERTIA, HUB_RADIUS, laden, states

SUMS = 3e-12  # relative to the largest entry
RESIDUAL = 1e-10  # relative to the largest entry
KINDS = ["TLAM", "FOAM", "CFOAM", "fourth-order", "exact", "thick", "bow", "bow FOAM", "bow fourth-order", "composite",
         "composite FOAM"]  # fmt: skip
R_HB = np.asarray(MOUNTED_HUB.mount.R_HB)


@cache
def truncated(kind: str) -> Quadratic:
    return second_order(Complete(laden(kind)))


@cache
def energy(kind: str) -> Any:
    return truncated(kind) if laden(kind).linear else energy_of(laden(kind))


def close(ours: Any, theirs: Any, tolerance: float) -> None:
    np.testing.assert_allclose(ours, theirs, rtol=0, atol=tolerance * np.abs(theirs).max())


def work(structure: Structure, q: np.ndarray) -> np.ndarray:
    """Generalised forces of the loads; to first order in the coordinates where the model is linear."""
    if not structure.linear:
        return virtual_work(structure, q)
    return virtual_work(structure, 0 * q) + rate(lambda t: virtual_work(structure, t * q))


def weight(structure: Structure, y: np.ndarray) -> np.ndarray:
    """Forces of gravity on the angle and the coordinates."""
    return -jacobian(lambda y: gravity_potential(structure, MOUNTED_HUB, y), y)


@pytest.mark.parametrize("kind", KINDS)
def test_coefficients_are_those_of_the_truncated_energy(kind: str) -> None:
    """Of a complete model they are the linearisation about the straight beam."""
    for name, theirs in coefficients(truncated(kind)).items():
        close(getattr(laden(kind).coefficients, name), theirs, SUMS)


def test_sfoam_is_foam_without_axial_coordinates() -> None:
    theirs = coefficients(truncated("FOAM"))
    for name, value in theirs.items():
        kept = value[..., 1:] if name.startswith("f_") else value[..., 1:, 1:]
        close(getattr(laden("SFOAM").coefficients, name), kept, SUMS)


@pytest.mark.parametrize("kind", KINDS)
def test_residual_on_a_given_base(kind: str) -> None:
    structure = laden(kind)
    q, qd, qdd = states(structure.size, 3, 0.1, seed=1)
    a, w, al = states(3, 3, 1.0, seed=2)
    ours = on_base(structure, q, qd, qdd, Base(a, w, al), loaded=True)
    damping = structure.coefficients.damping
    theirs = on_prescribed_base(energy(kind), damping, q, qd, qdd, a, w, al) - work(structure, q)[6:]
    close(ours, theirs, RESIDUAL)


@pytest.mark.parametrize("kind", KINDS)
def test_residual_on_a_free_hub(kind: str) -> None:
    structure, torque = laden(kind), 11.0
    y, yd, ydd = states(structure.size + 1, 3, 0.1, seed=3)
    ours, momentum = on_hub(structure, y, yd, ydd, torque, hub=MOUNTED_HUB, loaded=True)
    hub = (HUB_RADIUS, HUB_INERTIA, R_HB)
    theirs = on_free_hub(energy(kind), structure.coefficients.damping, *hub, y, yd, ydd)
    forces = work(structure, y[1:])
    theirs -= np.append(twist(HUB_RADIUS, R_HB) @ forces[:6], forces[6:]) + weight(structure, y)
    theirs[0] += 30.0 * y[0] + 4.0 * yd[0] - torque
    close(ours[1:], theirs[1:], RESIDUAL)
    assert ours[0] == pytest.approx(theirs[0], rel=RESIDUAL, abs=RESIDUAL * np.abs(ydd).max() * HUB_INERTIA)
    # T is of second degree in the rates: this difference is its derivative.
    unit = np.eye(len(y))[0]
    kinetic = [hub_kinetic(energy(kind), *hub, y, yd + sign * unit) for sign in (1, -1)]
    assert momentum == pytest.approx((kinetic[0] - kinetic[1]) / 2, rel=RESIDUAL)


def test_sfoam_on_a_free_hub_lacks_q_theta() -> None:
    """2009 (32), and the stretch: the rest is Lagrange's of FOAM with the axial coordinate held at zero."""
    structure, none = laden("SFOAM"), np.zeros(1)
    y, yd, ydd = states(structure.size + 1, 3, 0.1, seed=4)
    hub = (HUB_RADIUS, HUB_INERTIA, R_HB)
    damping = np.pad(structure.coefficients.damping, ((1, 0), (1, 0)))
    wide, still = ([np.concatenate([x[:1], none, x[1:]]) for x in each] for each in ((y, yd, ydd), (y, yd, 0 * ydd)))
    theirs, at_rest = (on_free_hub(energy("FOAM"), damping, *hub, *each) for each in (wide, still))
    theirs[0] -= at_rest[0]
    ours, _ = on_hub(structure, y, yd, ydd, hub=MOUNTED_HUB)
    gravity = weight(structure, y)
    theirs = np.delete(theirs, 1) - gravity
    theirs[0] += 30.0 * y[0] + 4.0 * yd[0]
    close(ours, theirs, RESIDUAL)


@pytest.mark.parametrize("kind", KINDS)
def test_first_order_forces_are_the_derivatives_of_the_complete_ones(kind: str) -> None:
    """Of every component of every load, resultant at the root included."""
    structure, terms = laden(kind), laden(kind).coefficients.loads
    assert terms is not None and structure.load_values is not None
    values = structure.load_values
    zero = np.zeros(structure.size)
    close(np.einsum("li,lij->j", values, terms.constant), virtual_work(structure, zero), SUMS)
    slopes = [rate(lambda t, e=e: virtual_work(structure, t * e)) for e in np.eye(structure.size)]
    close(np.einsum("li,lijn->jn", values, terms.slope), np.stack(slopes, axis=-1), RESIDUAL)
