"""Trees whose equations are linear: bodies of constant coefficients on roots whose motion is prescribed."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import gbeam as gb
from gbeam.mechanics import is_linear, linear_equations
from tests.system.trees import BEAM, flexible, rigid

LOADED = gb.assemble(
    gb.Beam(
        1.0, BEAM.section, gb.Material(2700.0, 70e9, poissons_ratio=0.3), damping_ratio=0.02,
        loads=[gb.Load(0.7, force=(3.0, -1.0, 2.0))],
    ),
    "FOAM", axial=1, y=1, z=2,
)  # fmt: skip
BODIES = "rigid", "rigid", "FOAM", "TLAM", "particles", "loaded"
RATES = {"fixed": (), "revolute": ("angle",), "prismatic": ("displacement",), "cylindrical": ("displacement", "angle")}


def held_tree(kinds: list[tuple[str, str, int]], seed: int) -> gb.System:
    """Bodies on joints whose every rate is prescribed, on points of earlier rigid bodies, roots, or the ground."""
    rng = np.random.default_rng(seed)
    bodies: dict[str, Any] = {}
    joints = {}
    points = ["ground"]
    for k, (kind, joint, on) in enumerate(kinds):
        name = f"b{k}"
        bodies[name] = rigid(rng) if kind == "rigid" else LOADED if kind == "loaded" else flexible(kind)
        rates = {each: gb.Sine(rng.uniform(0.5, 2), rng.uniform(0.5, 2)) for each in RATES[joint]}
        axes = {"axes": rng.normal(size=(1, 3))} if rates else {}
        place = {"at": rng.normal(size=3), "turn": rng.normal(size=3)}
        joints[f"j{k}"] = gb.Joint(joint, name, points[on % len(points)], rate=rates or None, **place, **axes)
        points += [f"{name}.{each}" for each in (("left", "root") if kind == "rigid" else ("root",))]
    return gb.System(bodies, joints, {"push": gb.PointForce(points[-1], (1.0, 2.0, 3.0), (0.3, 0.2, 0.1))})


def turning(seed: int) -> gb.Flight:
    rng = np.random.default_rng(seed)
    times = np.linspace(0, 2, 9)
    rates = gb.smoothed(gb.tabulated(times, rng.normal(size=(9, 3))), 0.3)
    return gb.Flight(acceleration=gb.tabulated(times, 10 * rng.normal(size=(9, 3))), rates=rates)


@settings(max_examples=30)
@given(
    st.lists(st.tuples(st.sampled_from(BODIES), st.sampled_from(sorted(RATES)), st.integers(0, 8)), max_size=4),
    st.integers(0, 1000),
)
def test_linear_equations_are_those_of_the_recursion(kinds: list[tuple[str, str, int]], seed: int) -> None:
    """M q̈ + C q̇ + K q − F is the wrenches' sum at any state, on a base that moves or rests."""
    system = held_tree([("FOAM", "fixed", 0), *kinds], seed)
    assert is_linear(system.tree)
    drive = partial(system.inputs, motion=turning(seed) if seed % 3 else None)
    equations = linear_equations(system.tree, drive)
    rng = np.random.default_rng(seed)
    t, (y, yd, ydd) = rng.uniform(0, 2, size=5), 0.3 * rng.normal(size=(3, 5, len(system.tree.unknowns)))
    c, k, f = equations.matrices(equations.drive(t))
    sums = ydd @ equations.mass + (c @ yd[..., None] + k @ y[..., None])[..., 0] - f
    residual = system.tree(y, yd, ydd, drive(t))
    np.testing.assert_allclose(sums, residual, rtol=1e-10, atol=1e-12 * np.abs(residual).max())


@pytest.mark.parametrize("model", ["FOAM", "TLAM"])
@pytest.mark.parametrize("integrator", ["gauss", "newmark"])
@pytest.mark.parametrize("seed", range(4))
def test_a_beam_as_a_system_is_the_beam(model: str, integrator: str, seed: int) -> None:
    """By equal steps its coordinates are equal to rounding, in flight and on a hub that is driven."""
    beam = gb.assemble(LOADED.source.beam, model, axial=1, y=1, z=2)
    hub = gb.Hub(radius=0.4, rate=gb.SmoothStep(2.0, 0.7), gravity=(0, 0, -9.81))
    motion = hub if seed == 0 else turning(seed)
    how: dict[str, Any] = {"duration": 1.5, "step": 2e-3, "integrator": integrator, "estimate": False}
    alone = gb.simulate(beam, motion, **how)
    joined = gb.simulate(gb.System({"beam": beam}, {"clamp": gb.Joint("fixed", "beam")}), motion, **how)
    for name in ("q", "qd"):
        one, other = getattr(alone.body, name), getattr(joined.body, name)
        np.testing.assert_allclose(other, one, rtol=1e-12, atol=1e-12 * np.abs(one).max())


def test_what_deforming_moves_is_not_linear() -> None:
    """A body on a tip, a force there, a free joint, and a model that bends far; on the root all is linear."""
    strip, mass = flexible("FOAM"), gb.RigidBody(0.2, (1e-3,) * 3)

    def linear(on: str, **more: Any) -> bool:
        joints = {"clamp": gb.Joint(more.pop("clamp", "fixed"), "strip"), "bolt": gb.Joint("fixed", "mass", on)}
        return is_linear(gb.System({"strip": more.pop("strip", strip), "mass": mass}, joints, **more).tree)

    assert linear("strip.root") and linear("ground")
    assert not linear("strip.tip") and not linear("strip.root", clamp="free")
    assert not linear("strip.root", forces={"push": gb.PointForce("strip.tip", (0, 0, 1.0))})
    assert not linear("strip.root", strip=flexible("exact")) and not linear("strip.root", strip=flexible("CFOAM"))
