"""Derivatives and batches through systems of bodies: two panels on a hub that turns freely, on springs, twisting."""

from __future__ import annotations

from functools import cache
from typing import Any

import jax
import numpy as np
import pytest

import gbeam as gb

from ..lagrange import quickly_compiled
from .test_gradients import agree

AT = {"modulus": 70e9, "spring": 5.0, "inertia": 0.02, "torque": 0.2, "pull": 9.81}
KINDS = {"exact": {"z": 1, "twist": 1, "shear_z": 1}, "FOAM": {"z": 1}}


def satellite(at: dict[str, Any]) -> gb.System:
    """A hub with an exact panel on a hinge with a spring, and one of FOAM that is clamped."""
    at = AT | at
    material = gb.Material(2700.0, at["modulus"], poissons_ratio=0.33)
    section = gb.Section.rectangle(width=0.02, thickness=0.004)
    beam = gb.Beam(0.3, section, material, damping_ratio=0.01, rotary_inertia=True)
    panels = {kind: gb.assemble(beam, kind, **counts) for kind, counts in KINDS.items()}
    points = {"left": (0.1, 0.0, 0.0), "right": gb.Place((-0.1, 0.0, 0.0), (0.0, 0.0, np.pi))}
    hub = gb.RigidBody(1.0, (at["inertia"],) * 3, points=points)
    joints = {
        "axis": gb.Joint("revolute", "hub", axes=[(0, 0, 1)], effort=gb.Sine(at["torque"], 1.0)),
        "hinge": gb.Joint("revolute", "exact", "hub.left", axes=[(0, 1, 0)], stiffness=at["spring"], damping=0.01),
        "clamp": gb.Joint("fixed", "FOAM", "hub.right"),
    }
    return gb.System({"hub": hub, **panels}, joints, gravity=[0.0, 1.0, -at["pull"]])


def places(at: dict[str, Any], step: float = 0.005) -> Any:
    """Places of both tips over time, m."""
    run = gb.simulate(satellite(at), duration=0.1, step=step, estimate=False, loads=False)
    return np.array([1.0, 2.0, 3.0]) @ (run.at("exact.tip") + run.at("FOAM.tip")).T


def moved(at: dict[str, Any]) -> Any:
    return (places(at)[-8:] ** 2).sum()


SPRINGS = np.array([AT["spring"], 4.0, 6.0, np.nan])


@cache
def batch() -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Values and derivatives with several springs: one program, which takes long to compile."""
    every = {name: np.full(len(SPRINGS), value) for name, value in AT.items()} | {"spring": SPRINGS}
    values, slopes = quickly_compiled(jax.vmap(jax.value_and_grad(moved)))(every)
    return np.asarray(values), {name: np.asarray(each) for name, each in slopes.items()}


def test_derivatives_with_respect_to_what_bodies_joints_and_drives_are_made_of() -> None:
    agree(moved, AT, {name: each[0] for name, each in batch()[1].items()})


def test_a_batch_is_as_many_runs_and_no_number_has_no_derivative() -> None:
    values, slopes = batch()[0], batch()[1]["spring"]
    for value, spring in zip(values[:3], SPRINGS[:3], strict=True):
        assert value == pytest.approx(moved({"spring": float(spring)}), rel=1e-12)
    assert (slopes[:3] != 0).all() and np.isnan(values[3]) and np.isnan(slopes[3])


def test_what_a_traced_system_cannot_have_is_said() -> None:
    def last(spring: Any, **options: Any) -> Any:
        return gb.simulate(satellite({"spring": spring}), duration=0.1, **options).time[-1] * spring

    with pytest.raises(gb.InputError, match="step is automatic"):
        quickly_compiled(jax.grad(last))(5.0)
