"""Inputs and outputs of the linearisation: slopes of the nonlinear model, and the section forces."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import gbeam as gb
from gbeam.arrays import each_leaf
from gbeam.mechanics import section_forces

from ..specimens import COMPLETE

MODELS = {
    "TLAM": gb.Model("TLAM", 1, 1, 1),
    "FOAM": gb.Model("FOAM", 1, 1, 1),
    "SFOAM": gb.Model("SFOAM", 0, 1, 1),
    "CFOAM": gb.Model("CFOAM", 1, 1, 1),
    "exact": gb.Model("exact", 1, 1, 0),
}
BEAM = gb.Beam(
    2.0,
    gb.Section.rectangle([0.03, 0.02], [0.008, 0.006], stations=[0.0, 2.0]),
    gb.Material(2700.0, 7e8),
    [gb.PointMass(2.0, 0.1, inertia=(2e-4, 3e-4, 4e-4), offset=(0.02, 0.01, -0.01))],
    damping_ratio=0.02,
    root=gb.Root(rotation_y=200.0),
    loads=[
        gb.Load(1.5, force=(0.3, 0.1, -0.2), moment=(0.0, 0.05, 0.02), follower=True),
        gb.Load(distributed=(0.0, 0.1, 0.3)),
    ],
    points=[gb.Point("camera", 0.7), gb.Point("end", 2.0)],
)
# A complete model's programs grow with all there is: its beam has a point mass and a clamped root.
PLAIN = replace(BEAM, masses=[gb.PointMass(2.0, 0.1)], root=gb.Root())
MOUNT = {"setting_angle": 0.4, "gravity": (1.0, -7.0, -5.0)}
HUBS = {
    "free": gb.Hub(radius=0.5, inertia=3.0, torque=gb.constant(0.0), stiffness=20.0, damping=4.0, **MOUNT),
    "prescribed": gb.Hub(radius=0.5, rate=gb.constant(1.2), **MOUNT),
}
GAUGES = [gb.Gauge(0.01, y=0.015), gb.Gauge(1.0, z=0.003)]


@cache
def structure(kind):
    return gb.assemble(PLAIN if kind in COMPLETE else BEAM, MODELS[kind])


def slope(function, x, k, h):
    """Central difference of fourth order."""
    step = h * np.eye(len(x))[k]
    return (8 * (function(x + step) - function(x - step)) - (function(x + 2 * step) - function(x - 2 * step))) / (
        12 * h
    )


# Every model, and every kind of base with a second-order and a complete one: compiling takes most of the time.
PAIRS = [("free", "FOAM"), ("free", "SFOAM"), ("free", "exact"), ("prescribed", "TLAM"), ("prescribed", "CFOAM")]


@pytest.mark.parametrize(("base", "kind"), PAIRS)
def test_finite_differences_of_the_nonlinear_model(base, kind):
    """A, B, C, D about a bent and moving beam on a tilted hub with gravity and loads."""
    pytest.importorskip("control")
    q, qd = np.random.default_rng(5).normal(size=(2, structure(kind).size)) * 0.03
    options = {"q": q, "qd": qd, "gauges": GAUGES}
    system = gb.linearize(structure(kind), HUBS[base], **options, **({"rate": 1.2} if base == "free" else {}))
    model = gb.nonlinear_system(structure(kind), HUBS[base], gauges=GAUGES)
    assert list(model.input_labels) == [signal.name for signal in system.inputs]
    assert list(model.output_labels) == [signal.name for signal in system.outputs]

    place = [list(model.state_labels).index(state.name) for state in system.states]
    n, z = len(place), np.concatenate([system.state, system.input])

    def both(z):
        full = np.zeros(len(model.state_labels))
        full[place] = z[:n]
        return np.concatenate([model.dynamics(0.0, full, z[n:])[place], model.output(0.0, full, z[n:])])

    expected = np.block([[system.a, system.b], [system.c, system.d]])
    slopes = np.stack([slope(both, z, k, 1e-3) for k in range(len(z))], axis=1)
    size = np.abs(expected).max(axis=1, keepdims=True)
    size[size == 0] = 1.0  # what is across the plane of the exact model
    np.testing.assert_allclose(slopes / size, expected / size, atol=1e-6)

    rates, outputs = np.split(both(z), [n])
    np.testing.assert_allclose(system.output, outputs, rtol=1e-12, atol=1e-12 * np.abs(outputs).max())
    carried(kind, base, system, rates)


def carried(kind, base, system, rates):
    """Root moment and accelerations are those of the section forces; with hub and ground they make up the torque."""
    beam, size, first = structure(kind), structure(kind).size, int(base == "free")
    mount, states = HUBS[base].mount, {state.name: k for k, state in enumerate(system.states)}
    half = first + size
    turned = (system.state[0], 1.2, rates[half]) if first else (0.0, 1.2, 0.0)
    at = mount.base(*map(np.asarray, turned))
    q, qd, qdd = system.state[first:half], system.state[half + first : 2 * half], rates[half + first : 2 * half]
    assert ("hub_angle" in states) == bool(first)
    history = each_leaf(lambda x: np.asarray(x)[None], at)
    loads = section_forces(beam, history, q[None], qd[None], qdd[None], np.zeros(1))
    outputs = dict(zip([signal.name for signal in system.outputs], system.output, strict=True))
    for i, axis in enumerate("xyz"):
        assert outputs[f"root_moment_{axis}"] == pytest.approx(loads.root_moment[0, i], rel=1e-9, abs=1e-9)
        for name, station in (("tip", -1), ("camera", -2), ("end", -1)):
            a, moved = loads.acceleration[0, station, i], beam.displacement(q)[station, i]
            assert outputs[f"{name}_specific_force_{axis}"] == pytest.approx(a, rel=1e-9, abs=1e-9)
            assert outputs[f"{name}_{axis}"] == pytest.approx(moved, rel=1e-9, abs=1e-12)
    if first and kind in COMPLETE:  # the others' hub does not feel terms of third order
        force, moment = (np.asarray(mount.R_HB) @ x[0] for x in (loads.root_force, loads.root_moment))
        spring, damper = 20.0 * turned[0], 4.0 * turned[1]
        torque = moment[2] + 0.5 * force[1] + 3.0 * turned[2] + spring + damper
        assert system.input[0] == pytest.approx(torque, rel=1e-9)


def test_names_say_whether_gravity_is_in():
    beam = gb.assemble(
        gb.Beam(1.0, gb.Section.rectangle(0.02, 0.004), gb.Material(2700.0, 7e10), damping_ratio=0.0),
        gb.Model("FOAM", 0, 1, 1),
    )
    for motion, word in (
        (gb.Flight(z=gb.constant(9.8)), "acceleration"),
        (gb.Hub(radius=0.5, rate=gb.constant(1.0)), "acceleration"),
        (gb.Hub(radius=0.5, rate=gb.constant(1.0), gravity=(0.0, 0.0, -9.8)), "specific_force"),
    ):
        system = gb.linearize(beam, motion)
        assert system.outputs[3].name == f"tip_{word}_x" and system.inputs[0].name == f"base_{word}_x"
    still = gb.linearize(beam, gb.Hub(radius=0.5, inertia=3.0, torque=gb.constant(0.0), gravity=(0.0, 0.0, -9.8)))
    assert still.output[5] == pytest.approx(9.8)  # what an accelerometer shows that stays where it is


def test_a_swinging_hub_is_refused():
    beam = gb.assemble(
        gb.Beam(1.0, gb.Section.rectangle(0.02, 0.004), gb.Material(2700.0, 7e10), damping_ratio=0.0),
        gb.Model("FOAM", 0, 1, 0),
    )
    swinging = gb.Hub(radius=0.5, inertia=3.0, torque=gb.constant(0.0), gravity=(0.0, -9.8, 0.0))
    with pytest.raises(gb.InputError, match="gbeam run"):
        gb.linearize(beam, swinging, 2.0)
