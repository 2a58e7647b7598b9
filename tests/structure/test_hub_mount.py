"""A hub with its own spring and damper, a beam at an angle on it or pointing inward, gravity in any direction."""

from __future__ import annotations

from typing import Any

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
from gbeam.mechanics.equations.residuals import OnBase, OnHub
from gbeam.structure.loads import Load

from ..lagrange import energy_of, hub_kinetic

BOX, METAL = Section.general(AREA, INERTIA, INERTIA), Material(DENSITY, MODULUS)
BEAM = Beam(LENGTH, BOX, METAL, [PointMass(LENGTH, 0.1)], 0.01)
GRAVITY = (3.0, -7.0, -5.0)
MOUNTED: dict[str, Any] = {"pointing": "inward", "setting_angle": 0.7, "gravity": GRAVITY}
HUB = Hub(radius=0.5, inertia=200.0, torque=constant(0.0), **MOUNTED, stiffness=30.0, damping=4.0)
MODELS = {"FOAM": Model("FOAM", 1, 1, 1), "exact": Model("exact", 1, 1, 1)}


def state(size: int) -> tuple[Any, Any, Any]:
    y, yd, ydd = np.random.default_rng(3).normal(size=(3, size)) * 0.2
    return jnp.asarray(y), jnp.asarray(yd), jnp.asarray(ydd)


def grounded(structure: Any, y: Any) -> Any:
    """Energy of the hub's spring, and of the beam in gravity, J; of a linear model to second order in q."""
    inertia = structure.places if structure.linear else structure.inertia
    moment = structure.mass @ inertia.positions(y[1:])
    centre = HUB.mount.R_HB @ moment + jnp.array([0.5, 0.0, 0.0]) * structure.mass.sum()
    c, s = jnp.cos(y[0]), jnp.sin(y[0])
    turned = jnp.stack([c * centre[0] - s * centre[1], s * centre[0] + c * centre[1], centre[2]])
    return 15.0 * y[0] ** 2 - jnp.asarray(GRAVITY) @ turned


@pytest.mark.parametrize("name", MODELS)
def test_a_free_hub_and_a_prescribed_one_are_one_thing(name: str) -> None:
    """The beam's rows are those on the prescribed base; the hub's row makes power equal to the rate of energy."""
    structure = assemble(BEAM, MODELS[name])

    @jax.jit
    def all_of_it(structure: Any, energy: Any, y: Any, yd: Any, ydd: Any, torque: Any) -> Any:
        def total(y: Any, yd: Any) -> Any:
            moving = hub_kinetic(energy, 0.5, 200.0, HUB.mount.R_HB, y, yd)
            return moving + energy.potential(y[1:]) + grounded(structure, y)

        free = OnHub(structure.on_free_hub(HUB), HUB.mount)(y, yd, ydd, (torque, None))
        base = HUB.mount.base(y[0], yd[0], ydd[0])
        given = OnBase(structure.equations)(y[1:], yd[1:], ydd[1:], (base, None))
        return free, given, jax.jvp(total, (y, yd), (yd, ydd))[1]

    y, yd, ydd = state(structure.size + 1)
    free, given, power = all_of_it(structure, energy_of(structure), y, yd, ydd, jnp.asarray(11.0))
    np.testing.assert_allclose(free[1:], given, rtol=1e-9, atol=1e-9)
    # r·ẏ is the rate of energy less what torque and dampers bring.
    brought = 11.0 * yd[0] - 4.0 * yd[0] ** 2 - yd[1:] @ structure.coefficients.damping @ yd[1:]
    assert float(free @ yd) == pytest.approx(float(power - brought), rel=1e-9)


def test_inward_is_a_negative_radius() -> None:
    inward, outward = (Hub(radius=0.5, rate=constant(2.0), pointing=p).base(0.0) for p in ("inward", "outward"))
    np.testing.assert_allclose(inward.a_WO_B, -outward.a_WO_B, atol=1e-12)
    np.testing.assert_allclose(inward.w_WB_B, [0, 0, 2.0])


def test_a_setting_angle_mixes_the_planes() -> None:
    """At 90° the section's z lies where y was: the lag and flap stiffnesses change places."""
    both = assemble(BEAM, Model("FOAM", 0, 1, 1)).coefficients
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
    structure = assemble(loaded, Model("FOAM", 0, 1, 1))
    hub = Hub(radius=0.5, inertia=200.0, torque=constant(0.0))
    y, yd, ydd = np.zeros((3, 3))
    row = OnHub(structure.on_free_hub(hub), hub.mount)(y, yd, ydd, (0.0, structure.load_values))[0]

    # ... and a force F_y at x adds F_y (r + x).
    torque = 11.0 + 2.0 * 5.5
    assert row == pytest.approx(-torque, rel=1e-12)


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
