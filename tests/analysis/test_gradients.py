"""Derivatives and batches through assembly and response: JAX's arrays pass where physical values are numbers."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import gbeam.arrays.jax_setup  # noqa: F401
from gbeam import Beam, Hub, InputError, Material, Model, PointMass, Sine, SmoothStep, assemble, simulate

from ..lagrange import quickly_compiled
from ..specimens import ALUMINIUM, BOX, HUB_INERTIA, HUB_RADIUS, LENGTH, METAL, STRIP

AGREES = 1e-5  # relative, with central differences
E = METAL.youngs_modulus
MOTIONS: dict[str, Hub] = {
    "slew": Hub(radius=HUB_RADIUS, rate=SmoothStep(3.0, 2.0)),
    "torque": Hub(radius=HUB_RADIUS, inertia=HUB_INERTIA, torque=Sine(200.0, 2.0)),
}


def tip_of(motion: Hub) -> Callable[[Any], Any]:
    """Tip displacement along y over time, as a function of Young's modulus."""

    def tip(modulus: Any) -> Any:
        beam = Beam(LENGTH, BOX, Material(METAL.density, modulus), [PointMass(LENGTH, 0.1)], damping_ratio=0.01)
        return simulate(assemble(beam, Model("FOAM", 0, 2, 0)), motion, duration=3.0, step=0.02).tip[:, 1]

    return tip


@pytest.mark.parametrize("name", MOTIONS)
def test_derivative_of_the_peak_with_respect_to_youngs_modulus(name: str) -> None:
    tip, h = tip_of(MOTIONS[name]), 1e-4 * E
    slope = quickly_compiled(jax.grad(lambda modulus: jnp.abs(tip(modulus)).max()))(E)
    ends = [np.abs(tip(E + sign * h)).max() for sign in (1, -1)]
    assert slope < 0  # the stiffer, the less
    assert float(slope) == pytest.approx((ends[0] - ends[1]) / (2 * h), rel=AGREES)


@pytest.mark.parametrize("name", MOTIONS)
def test_a_batch_of_moduli_is_as_many_runs(name: str) -> None:
    tip, moduli = tip_of(MOTIONS[name]), np.array([0.8, 1.0, 1.3]) * E
    together = quickly_compiled(jax.vmap(tip))(moduli)
    for batched, modulus in zip(together, moduli, strict=True):
        alone = tip(modulus)
        np.testing.assert_allclose(batched, alone, atol=1e-8 * np.abs(alone).max())


@pytest.mark.parametrize(
    ("beam", "words"),
    [
        (lambda x: Beam(x, STRIP, ALUMINIUM), "length is traced by JAX"),
        (lambda x: Beam(0.3, STRIP, ALUMINIUM, [PointMass(x, 0.1)]), r"masses\[0\].at is traced by JAX"),
    ],
)
def test_what_places_the_shapes_cannot_be_traced(beam: Any, words: str) -> None:
    with pytest.raises(InputError, match=words):
        jax.grad(lambda x: assemble(beam(x), "FOAM", z=2).coefficients.mass.sum())(0.25)


def test_adapted_shapes_cannot_be_traced() -> None:
    def stiffness(modulus: Any) -> Any:
        beam = Beam(0.3, STRIP, Material(2700.0, modulus))
        return assemble(beam, "FOAM", z=2, shapes="adapted").coefficients.stiffness.sum()

    with pytest.raises(InputError, match="shapes adapted to a beam that JAX traces"):
        jax.grad(stiffness)(70e9)
