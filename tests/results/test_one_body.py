"""Quantities of the only body that deforms are there without its name; of several they are refused."""

from __future__ import annotations

import numpy as np
import pytest

import gbeam as gb

STRIP = gb.Beam(0.3, gb.Section.rectangle(0.02, 0.004), gb.Material(2700.0, 70e9))
FOOT = gb.RigidBody(1.0, (0.1, 0.1, 0.1), points={"end": (0.1, 0.0, 0.0)})


def on_foot(*names: str) -> gb.System:
    """Strips without a damping ratio, side by side on a sprung foot."""
    strip, clamps = gb.assemble(STRIP, "FOAM", axial=0, y=1, z=1), ((name, "foot.end") for name in names)
    hinge = gb.Joint("revolute", "foot", axes=[(0, 1, 0)], stiffness=50.0)
    joints = {"hinge": hinge} | {f"clamp_{name}": gb.Joint("fixed", name, on) for name, on in clamps}
    return gb.System({"foot": FOOT} | dict.fromkeys(names, strip), joints, gravity=(0, 0, -9.81))


def test_of_one_body_that_deforms_the_name_may_be_left_out() -> None:
    rest, modes = (ask(on_foot("strip")) for ask in (gb.static, gb.modes))
    assert rest.body is rest.bodies["strip"] and modes.body is modes.bodies["strip"]
    assert rest.tip is not None and np.array_equal(rest.tip, rest.bodies["strip"].displacement[-1])
    assert rest.strain_energy > 0 and rest.loads is rest.body.loads and modes.shape is modes.body.shape
    # The tip goes with the foot, too.
    assert rest.point_displacement[rest.points.index("strip.tip")][2] < rest.tip[2] < 0


def test_of_several_the_bodies_are_named() -> None:
    rest, modes = (ask(on_foot("left", "right")) for ask in (gb.static, gb.modes))
    for read in (lambda: rest.tip, lambda: rest.loads, lambda: modes.shape, lambda: modes.stations):
        with pytest.raises(gb.InputError, match=r"left, right, and this is of one; ask one of them: bodies\['left'\]"):
            read()
    with pytest.raises(gb.InputError, match="bodies are rigid"):
        gb.static(gb.System({"foot": FOOT}, {"clamp": gb.Joint("fixed", "foot")})).tip  # noqa: B018


def test_modes_of_a_system_without_damping_ratios_are_undamped() -> None:
    modes = gb.modes(on_foot("left", "right"), errors=False)
    assert not modes.damping_given and np.abs(modes.damping_ratio).max() < 1e-10
    assert modes.bodies["left"].direction[0] == "z"
