"""Beams under supports in batches, gradients, loops and on a turning hub, against runs alone and closed forms."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import gbeam as gb

LENGTH, RADIUS = 0.6, 0.1
STRIP, METAL = gb.Section.rectangle(0.02, 0.004), gb.Material(2700, 70e9, poissons_ratio=0.3)
PROP = gb.Support(LENGTH, ["z"])
FLIGHT = gb.Flight(z=gb.trapezoid(50.0, jerk=2e3, start=0.02, hold=0.05))


def held(kind: Any, *supports: gb.Support, material: gb.Material = METAL, axial: int = 0, z: int = 2) -> gb.Structure:
    beam = gb.Beam(LENGTH, STRIP, material, damping_ratio=0.01, supports=supports)
    return gb.assemble(beam, kind, axial=axial, z=z)


@pytest.mark.parametrize("kind", ["FOAM", "exact"])
def test_a_batch_is_its_runs_alone(kind: Any) -> None:
    """Of a prop, and of springs of two stiffnesses: deflections, reactions and their peaks."""
    springs = [gb.Support(LENGTH, stiffness={"z": k}, damping={"z": 1.0}) for k in (2e3, 8e3)]
    structures = [held(kind, PROP)] * (kind == "FOAM") + [held(kind, spring) for spring in springs]
    together = dict(gb.simulate_batch(((each, FLIGHT) for each in structures), duration=0.04, step=2e-3))
    for k, structure in enumerate(structures):
        alone = gb.simulate(structure, FLIGHT, duration=0.04, step=2e-3, estimate=False)
        assert alone.loads is not None and together[k].loads is not None
        for a, b in (
            (together[k].displacement, alone.displacement),
            (together[k].loads.support_force, alone.loads.support_force),
        ):
            assert a is not None and b is not None
            np.testing.assert_allclose(a, b, atol=1e-8 * np.abs(b).max())


def moved(kind: Any, parameter: str, value: Any) -> Any:
    """Reaction of a support at the end of a run, N, by one value of the beam."""
    material = gb.Material(2700, value, poissons_ratio=0.3) if parameter == "modulus" else METAL
    spring, damper = (value if parameter == name else number for name, number in (("spring", 5e3), ("damper", 1.0)))
    supports = [gb.Support(LENGTH, stiffness={"z": spring}, damping={"z": damper})]
    if parameter == "root damper":
        pin = gb.Support(0.0, ["x", "y", "z", "rx", "rz"], {"ry": 2.0}, {"ry": value})
        supports = [pin, PROP]
    structure = held(kind, *supports, material=material)
    keys: dict[str, Any] = {"duration": 0.03, "step": 3e-3, "estimate": False, "integrator": "newmark"}
    loads = gb.simulate(structure, FLIGHT, **keys).loads
    assert loads is not None and loads.support_force is not None
    return loads.support_force[-1, 0, 2]


@pytest.mark.parametrize(("kind", "parameter", "value"), [
    ("FOAM", "modulus", 70e9),
    ("FOAM", "spring", 5e3),
    ("FOAM", "root damper", 0.01),
    ("exact", "spring", 5e3),
])  # fmt: skip
def test_jax_follows_what_supports_do(kind: Any, parameter: str, value: float) -> None:
    """The derivative of a reaction is that by central differences."""
    import jax

    derivative = jax.jit(jax.grad(lambda x: moved(kind, parameter, x)))(value)
    h = 1e-4 * value
    difference = (moved(kind, parameter, value + h) - moved(kind, parameter, value - h)) / (2 * h)
    assert derivative == pytest.approx(difference, rel=1e-4)


def test_jax_follows_no_place_of_a_support() -> None:
    import jax

    with pytest.raises(gb.InputError, match=r"supports\[0\].at is traced by JAX"):
        jax.grad(lambda x: gb.modes(held("exact", gb.Support(x, ["z"]))).frequency[0])(0.4)


@pytest.mark.parametrize("kind", ["FOAM", "exact"])
def test_a_loop_that_gives_a_constant_torque_is_that_torque(kind: Any) -> None:
    """A hub under a controller turns as under the torque alone, and sensors read what the response has."""
    panel, hub = (
        held(kind, PROP),
        gb.RigidBody(0.05, (1e-3,) * 3, points={"rim": gb.Place((RADIUS, 0, 0), (np.pi / 2, 0, 0))}),
    )
    joints = {"axis": gb.Joint("revolute", "hub", axes=[(0, 0, 1)]), "clamp": gb.Joint("fixed", "panel", "hub.rim")}
    measured = ["axis.angle", "panel.root.moment_y", "panel.span.acceleration_z"]
    law = gb.Feedback(lambda _t, _y: np.array([0.02]), measured, ["axis.angle"], sample=0.01)
    driven = gb.Joint("revolute", "hub", axes=[(0, 0, 1)], effort=gb.constant(0.02))
    bodies: dict[str, Any] = {"hub": hub, "panel": panel}
    keys: dict[str, Any] = {"duration": 0.1, "step": 2.5e-4, "estimate": False}
    loop = gb.simulate(gb.System(bodies, joints, controllers={"pd": law}), **keys)
    alone = gb.simulate(gb.System(bodies, joints | {"axis": driven}), **keys)
    for response in (loop, alone):
        assert response.bodies["panel"].loads is not None
    angle = alone.coordinate("axis.angle")
    np.testing.assert_allclose(loop.coordinate("axis.angle"), angle, atol=1e-3 * angle.max())
    first, second = loop.bodies["panel"].loads, alone.bodies["panel"].loads
    assert first is not None and second is not None
    assert first.support_force is not None and second.support_force is not None
    np.testing.assert_allclose(
        first.support_force[1:], second.support_force[1:], atol=1e-2 * np.abs(second.support_force).max()
    )
    assert loop.loop is not None
    read, at = loop.loop.measured[:, 1], slice(0, -1, 40)  # the samples
    np.testing.assert_allclose(read[at], first.section_moment[at, 0, 1], atol=1e-8 * np.abs(read).max())


@pytest.mark.parametrize("kind", ["FOAM", "exact"])
@pytest.mark.parametrize("ring", [False, True])
def test_a_propped_beam_on_a_turning_hub_stiffens_as_rayleigh_says(kind: Any, *, ring: bool) -> None:
    """Out of the hub's plane: dω²/dΩ² = ∫ T φ'² dx / ∫ m φ² dx of the mode at rest, T of Ω = 1.

    The tip slides, or a ring holds it along the beam: then the pulls on both ends leave its length as it is.
    """
    x, beta = np.linspace(0.0, LENGTH, 4001), 3.92660231 / LENGTH
    sigma = (np.cosh(beta * LENGTH) - np.cos(beta * LENGTH)) / (np.sinh(beta * LENGTH) - np.sin(beta * LENGTH))
    mode = np.cosh(beta * x) - np.cos(beta * x) - sigma * (np.sinh(beta * x) - np.sin(beta * x))
    tension = ((RADIUS + LENGTH) ** 2 - (RADIUS + x) ** 2) / 2  # over the mass per length
    if ring:
        tension = tension - np.trapezoid(tension, x) / LENGTH
    stiffening = np.trapezoid(tension * np.gradient(mode, x) ** 2, x) / np.trapezoid(mode**2, x)
    speeds = np.array([0.0, 20.0])
    prop = gb.Support(LENGTH, ["x", "z"]) if ring else PROP
    diagram = gb.campbell(held(kind, prop, axial=2, z=6), gb.Hub(radius=RADIUS, rate=gb.constant(1.0)), speeds=speeds)
    lowest = (2 * np.pi * diagram.frequency[:, 0]) ** 2
    assert (lowest[1] - lowest[0]) / speeds[1] ** 2 == pytest.approx(stiffening, rel=1e-2)
