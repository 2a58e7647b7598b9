"""A hub with its own spring and damper, a beam at an angle on it or pointing inward, gravity in any direction."""

from __future__ import annotations

from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from exact_beams import AREA, DENSITY, INERTIA, LENGTH, MODULUS

from gbeam import (
    Beam,
    Hub,
    InputError,
    Material,
    Model,
    PointMass,
    Section,
    SmoothStep,
    assemble,
    constant,
)
from gbeam.analysis.response.problem import free_hub
from gbeam.mechanics.equations import coefficients, hub_kinetic, on_free_hub, on_prescribed_base
from gbeam.structure.loads import Load

BOX, METAL = Section.general(AREA, INERTIA, INERTIA), Material(DENSITY, MODULUS)
BEAM = Beam(LENGTH, BOX, METAL, [PointMass(LENGTH, 0.1)], 0.01)
GRAVITY = (3.0, -7.0, -5.0)
MOUNTED: dict[str, Any] = {"pointing": "inward", "setting_angle": 0.7, "gravity": GRAVITY}
HUB = Hub(radius=0.5, inertia=200.0, torque=constant(0.0), **MOUNTED, stiffness=30.0, damping=4.0)
MODELS = {"FOAM": Model("FOAM", 1, 1, 1), "exact": Model("exact", 1, 1, 1)}


def state(size: int) -> tuple[Any, Any, Any]:
    y, yd, ydd = np.random.default_rng(3).normal(size=(3, size)) * 0.2
    return jnp.asarray(y), jnp.asarray(yd), jnp.asarray(ydd)


@pytest.mark.parametrize("name", MODELS)
def test_a_free_hub_and_a_prescribed_one_are_one_thing(name: str) -> None:
    """The beam's rows are those on the prescribed base; the hub's row makes power equal to the rate of energy."""
    structure, hub = assemble(BEAM, MODELS[name]), free_hub(HUB)
    system = structure.system

    def total(y: Any, yd: Any) -> Any:
        energy = system.energy
        return hub_kinetic(energy, hub, y, yd) + energy.potential(y[1:]) + hub.potential(energy, y)

    @eqx.filter_jit
    def all_of_it(y: Any, yd: Any, ydd: Any, torque: Any) -> Any:
        free = on_free_hub(system, hub, y, yd, ydd, torque)
        base = HUB.mount.base(y[0], yd[0], ydd[0])
        given = on_prescribed_base(system, y[1:], yd[1:], ydd[1:], base.a_WO_B, base.w_WB_B, base.alpha_WB_B)
        return free, given, jax.jvp(total, (y, yd), (yd, ydd))[1]

    y, yd, ydd = state(structure.size + 1)
    free, given, power = all_of_it(y, yd, ydd, jnp.asarray(11.0))
    np.testing.assert_allclose(free[1:], given, rtol=1e-9, atol=1e-9)
    # r·ẏ is the rate of energy less what torque and dampers bring.
    brought = 11.0 * yd[0] - 4.0 * yd[0] ** 2 - yd[1:] @ system.damping @ yd[1:]
    assert float(free @ yd) == pytest.approx(float(power - brought), rel=1e-9)


def test_inward_is_a_negative_radius() -> None:
    inward, outward = (Hub(radius=0.5, rate=constant(2.0), pointing=p).base(0.0) for p in ("inward", "outward"))
    np.testing.assert_allclose(inward.a_WO_B, -outward.a_WO_B, atol=1e-12)
    np.testing.assert_allclose(inward.w_WB_B, [0, 0, 2.0])


def test_a_setting_angle_mixes_the_planes() -> None:
    """At 90° the section's z lies where y was: the lag and flap stiffnesses change places."""
    both = coefficients(assemble(BEAM, Model("FOAM", 0, 1, 1)).system)
    bases = [Hub(radius=0.5, rate=constant(2.0), setting_angle=angle).base(0.0) for angle in (0.0, np.pi / 2)]
    flat, edge = (both.at(b.a_WO_B, b.w_WB_B, b.alpha_WB_B)[1] for b in bases)
    np.testing.assert_allclose(np.diag(flat)[::-1], np.diag(edge), rtol=1e-12)
    assert flat[0, 0] < flat[1, 1]


def test_gravity_keeps_its_direction_while_a_prescribed_hub_turns() -> None:
    rate = SmoothStep(2.0, 3.0, 0.5)
    turning, weightless = (Hub(radius=0.5, rate=rate, setting_angle=0.3, gravity=g) for g in (GRAVITY, None))
    t = np.linspace(0, 7, 200001)
    angle = np.append(0, np.cumsum(np.diff(t) * np.asarray((rate(t)[1:] + rate(t)[:-1]) / 2)))
    np.testing.assert_allclose(turning.angle(t), angle, atol=1e-8)
    pull = np.asarray(weightless.base(t).a_WO_B - turning.base(t).a_WO_B) @ np.asarray(turning.mount.R_HB).T
    c, s = np.cos(angle), np.sin(angle)
    back = np.stack([c * pull[:, 0] - s * pull[:, 1], s * pull[:, 0] + c * pull[:, 1], pull[:, 2]], axis=1)
    np.testing.assert_allclose(back, np.broadcast_to(GRAVITY, back.shape), atol=1e-6)


def test_a_moment_at_the_root_drives_the_hub_as_a_torque_does() -> None:
    loaded = Beam(LENGTH, BOX, METAL, loads=[Load(0.0, moment=(0.0, 0.0, 11.0)), Load(5.0, force=(1.0, 2.0, 3.0))])
    system = assemble(loaded, Model("FOAM", 0, 1, 1)).system
    hub = free_hub(Hub(radius=0.5, inertia=200.0, torque=constant(0.0)))
    y, yd, ydd = (jnp.zeros(3) for _ in range(3))

    @eqx.filter_jit
    def row(torque: Any, applied: Any) -> Any:
        return on_free_hub(system.under(applied), hub, y, yd, ydd, torque)[0]

    # ... and a force F_y at x adds F_y (r + x).
    torque = 11.0 + 2.0 * 5.5
    assert float(row(jnp.asarray(0.0), system.applied)) == pytest.approx(-torque, rel=1e-12)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"pointing": "up"}, "pointing is 'up'"),
        ({"setting_angle": np.nan}, "setting_angle is nan"),
        ({"gravity": (1.0, 2.0)}, "gravity is"),
        ({"stiffness": -1.0}, "stiffness is -1"),
    ],
)
def test_impossible_mounts_are_refused(wrong: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        Hub(radius=0.5, inertia=200.0, torque=constant(0.0), **wrong)
