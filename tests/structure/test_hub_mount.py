"""A hub with its own spring and damper, a beam at an angle on it or pointing inward, gravity in any direction."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from exact_beams import AREA, DENSITY, INERTIA, LENGTH, MODULUS

import gbeam as gb
from validation.residuals import hinged

from ..differences import rate
from ..lagrange import energy_of, hub_kinetic
from ..residuals import MOUNTED_HUB, gravity_potential, on_base, on_hub
from ..scenarios import SLEWING
from ..specimens import HUB_INERTIA, HUB_RADIUS, laden, states

BOX, METAL = gb.Section.general(AREA, INERTIA, INERTIA), gb.Material(DENSITY, MODULUS)
BEAM = gb.Beam(LENGTH, BOX, METAL, [gb.PointMass(LENGTH, 0.1)], 0.01)
GRAVITY = (3.0, -7.0, -5.0)


@pytest.mark.parametrize("name", ["FOAM", "exact"])
def test_a_free_hub_and_a_prescribed_one_are_one_thing(name: str) -> None:
    """The beam's rows are those on the prescribed base; the hub's row makes power equal to the rate of energy."""
    structure = laden(name)
    energy, hub, torque = energy_of(structure), MOUNTED_HUB, 11.0
    # The stretch and the springs less than the others, so that no energy is the difference of large ones.
    scale = np.array([1.0, 1e-3, 1.0, 1.0, 1e-2, 1e-2, 0.1, 0.1])
    y, yd, ydd = states(structure.size + 1, 3, 0.2, seed=3) * scale

    def total(t: float) -> float:
        at, rates = y + yd * t, yd + ydd * t
        moving = hub_kinetic(energy, HUB_RADIUS, HUB_INERTIA, hub.mount.R_HB, at, rates)
        resting = energy.potential(at[1:]) + gravity_potential(structure, hub, at) + 15.0 * at[0] ** 2
        return float(moving + resting)

    free, _ = on_hub(structure, y, yd, ydd, torque, hub=hub)
    base = hub.mount.base(y[0], yd[0], ydd[0])
    np.testing.assert_allclose(free[1:], on_base(structure, y[1:], yd[1:], ydd[1:], base), rtol=1e-9, atol=1e-9)
    # r·ẏ is the rate of energy less what torque and dampers bring.
    brought = torque * yd[0] - 4.0 * yd[0] ** 2 - yd[1:] @ structure.coefficients.damping @ yd[1:]
    assert float(free @ yd) == pytest.approx(float(rate(total, step=1e-3)) - brought, rel=1e-9)


def test_inward_is_a_negative_radius() -> None:
    inward, outward = (gb.Hub(radius=0.5, rate=gb.constant(2.0), pointing=p).base(0.0) for p in ("inward", "outward"))
    np.testing.assert_allclose(inward.a_WO_B, -outward.a_WO_B, atol=1e-12)
    np.testing.assert_allclose(inward.w_WB_B, [0, 0, 2.0])


@pytest.mark.parametrize("pointing", ["outward", "inward"])
def test_a_setting_angle_turns_the_sections_y_about_the_beam_towards_the_hubs_axis(pointing: str) -> None:
    side = 1.0 if pointing == "outward" else -1.0
    base = gb.Hub(radius=0.5, rate=gb.constant(2.0), setting_angle=np.pi / 6, pointing=pointing).base(0.0)
    # y, which lay in the plane of rotation, rises towards z: half of the rate is about it.
    np.testing.assert_allclose(base.w_WB_B, [0, 1.0, 3**0.5], atol=1e-12)
    np.testing.assert_allclose(base.a_WO_B, [-2.0 * side, 0, 0], atol=1e-12)


def test_a_setting_angle_mixes_the_planes() -> None:
    """At 90° the section's z lies where y was: the lag and flap stiffnesses change places."""
    both = gb.assemble(BEAM, gb.Model("FOAM", 0, 1, 1)).coefficients
    bases = [gb.Hub(radius=0.5, rate=gb.constant(2.0), setting_angle=angle).base(0.0) for angle in (0.0, np.pi / 2)]
    flat, edge = (both.evaluate(b.a_WO_B, b.w_WB_B, b.alpha_WB_B)[1] for b in bases)
    np.testing.assert_allclose(np.diag(flat)[::-1], np.diag(edge), rtol=1e-12)
    assert flat[0, 0] < flat[1, 1]


def test_gravity_keeps_its_direction_while_a_prescribed_hub_turns() -> None:
    turn = gb.SmoothStep(2.0, 3.0, 0.5)
    turning, weightless = (gb.Hub(radius=0.5, rate=turn, setting_angle=0.3, gravity=g) for g in (GRAVITY, None))
    t = np.linspace(0, 7, 200001)
    angle = np.append(0, np.cumsum(np.diff(t) * np.asarray((turn(t)[1:] + turn(t)[:-1]) / 2)))
    np.testing.assert_allclose(turning.angle(t), angle, atol=1e-8)
    pull = np.asarray(weightless.base(t).a_WO_B - turning.base(t).a_WO_B) @ np.asarray(turning.mount.R_HB).T
    c, s = np.cos(angle), np.sin(angle)
    back = np.stack([c * pull[:, 0] - s * pull[:, 1], s * pull[:, 0] + c * pull[:, 1], pull[:, 2]], axis=1)
    np.testing.assert_allclose(back, np.broadcast_to(GRAVITY, back.shape), atol=1e-6)


def test_a_moment_at_the_root_drives_the_hub_as_a_torque_does() -> None:
    loaded = gb.Beam(
        LENGTH, BOX, METAL, loads=[gb.Load(0.0, moment=(0.0, 0.0, 11.0)), gb.Load(5.0, force=(1.0, 2.0, 3.0))]
    )
    structure = gb.assemble(loaded, gb.Model("FOAM", 0, 1, 1))
    hub = gb.Hub(radius=0.5, inertia=200.0, torque=gb.constant(0.0))
    y, yd, ydd = np.zeros((3, 3))
    row = hinged(structure, hub)(y, yd, ydd, (0.0, structure.load_values))[0]

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
    with pytest.raises(gb.InputError, match=words):
        gb.Hub(radius=0.5, inertia=200.0, torque=gb.constant(0.0), **wrong)


def test_the_drive_of_a_slewing_hub_turns_hub_and_beam(tmp_path: Path) -> None:
    """τ = J dΩ/dt + what the beam takes: of a scenario's hub with a rate and an inertia, in its file."""
    file = tmp_path / "slew.toml"
    file.write_text(SLEWING, encoding="utf-8")
    changes = ["motion.slew.inertia=200 kg m^2", "response.step=20 ms", "model.kind=FOAM", "response.duration=5 s"]
    slew = gb.study(gb.read_scenario(file, changes)).responses["slew"]
    assert slew.hub is not None and slew.loads is not None and slew.loads.beam_torque is not None
    turned = 200.0 * slew.hub.acceleration + slew.loads.beam_torque
    np.testing.assert_allclose(slew.hub.drive_torque, turned, atol=1e-9 * np.abs(turned).max())
    np.testing.assert_array_equal(slew.to_xarray()["drive_torque"], slew.hub.drive_torque)
    unknown = gb.study(gb.read_scenario(file, changes[1:])).responses["slew"]
    assert "drive_torque" not in unknown.to_xarray() and unknown.hub is not None and unknown.hub.drive_torque is None
