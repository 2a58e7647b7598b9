"""Beams and random states for the identity tests, and what they ask of an energy, compiled once per model."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray

from gbeam import Beam, Material, Model, PointMass, Section, Structure, assemble
from gbeam.mechanics.equations import Hub, hub_kinetic, on_free_hub

Array = NDArray[np.float64]

# The beam of 2009 Table 1: shapes of amplitude 0.1 m bend it by some degrees.
HUB_RADIUS, HUB_INERTIA = 0.5, 200.0
MATERIAL = Material(2766.7, 6.8952e10)
BOX = Section.general(7.2968e-5, 8.2189e-9, 8.2189e-9)
TIP = PointMass(8.0, 0.1)
# A body off the axis, with inertia, part of the way along.
BODY = PointMass(5.0, 0.3, inertia=(0.02, 0.03, 0.04), offset=(0.05, -0.1, 0.08))

# The Lagrangian models on a hub, which turns about z; FOAM without axial coordinates is SFOAM's Lagrangian form.
PLANAR = {
    "TLAM": Model("TLAM", 1, 3, 0),
    "FOAM": Model("FOAM", 1, 3, 0),
    "FOAM axial=0": Model("FOAM", 0, 3, 0),
    "CFOAM": Model("CFOAM", 1, 3, 0),
    "exact": Model("exact", 1, 3, 0),
}
PRINTED = Model("SFOAM", 0, 3, 0)  # drops Q_θ: not Lagrangian
SPATIAL = {
    "FOAM": Model("FOAM", 1, 2, 2),
    "CFOAM": Model("CFOAM", 1, 2, 2),
    "exact": Model("exact", 1, 2, 2),
}
COMPLETE = ("CFOAM", "exact")


def beam(*masses: PointMass, damping_ratio: float = 0.0) -> Beam:
    """The beam of 2009 with bodies."""
    return Beam(8.0, BOX, MATERIAL, masses, damping_ratio)


@cache
def planar(name: str, damping_ratio: float = 0.0) -> Structure:
    """The beam with its tip mass in a planar model."""
    model = PRINTED if name == "SFOAM" else PLANAR[name]
    return assemble(beam(TIP, damping_ratio=damping_ratio), model)


@cache
def spatial(name: str) -> Structure:
    """The beam with a tip mass and a body off its axis, in a model with both directions of bending."""
    return assemble(beam(TIP, BODY), SPATIAL[name])


def states(size: int, count: int, scale: float, seed: int) -> Array:
    """`count` random vectors (count, size)."""
    return np.random.default_rng(seed).normal(size=(count, size)) * scale


@dataclass(frozen=True)
class OnHub:
    """A model on a free hub: compiled functions of y = (θ, q), ẏ, ÿ and a torque.

    `rates` are those of T + U and of p_θ = ∂T/∂θ̇ along (ẏ, ÿ).
    """

    structure: Structure
    residual: Any
    acceleration: Any
    total_energy: Any
    momentum: Any
    rates: Any


@cache
def on_hub(name: str, damping_ratio: float = 0.0) -> OnHub:
    """A planar model on the hub of 2009."""
    structure = planar(name, damping_ratio)
    hub, system = Hub(jnp.asarray(HUB_RADIUS), jnp.asarray(HUB_INERTIA)), structure.system

    def residual(y: Any, yd: Any, ydd: Any, torque: Any) -> Any:
        torque = jnp.asarray(torque, dtype=float)
        return on_free_hub(system, hub, y, yd, ydd, torque, hub_force=structure.hub_force)

    def acceleration(y: Any, yd: Any, torque: Any) -> Any:
        none = jnp.zeros_like(y)
        mass = jax.jacfwd(residual, 2)(y, yd, none, torque)
        return jnp.linalg.solve(mass, -residual(y, yd, none, torque))

    def kinetic(y: Any, yd: Any) -> Any:
        return hub_kinetic(system.energy, hub, y, yd)

    def total(y: Any, yd: Any) -> Any:
        return kinetic(y, yd) + system.energy.potential(y[1:])

    def momentum(y: Any, yd: Any) -> Any:
        return jax.grad(kinetic, 1)(y, yd)[0]

    def rates(y: Any, yd: Any, ydd: Any) -> Any:
        return tuple(jax.jvp(f, (y, yd), (yd, ydd))[1] for f in (total, momentum))

    functions = (eqx.filter_jit(f) for f in (residual, acceleration, total, momentum, rates))
    return OnHub(structure, *functions)
