"""Rest of a system, and small departures from it or from a motion: its modes, and its state-space model."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from types import MappingProxyType
from typing import Any

import numpy as np

from gbeam.analysis.system.drive import Drive
from gbeam.analysis.system.gauges import Strained, read_signals
from gbeam.analysis.system.point import Point
from gbeam.analysis.system.rest import beginning, settled
from gbeam.analysis.system.steady import SteadySystem
from gbeam.arrays.types import Complex, Floats
from gbeam.guards.checks import choice
from gbeam.mechanics.tree.equations import Inputs
from gbeam.mechanics.tree.signal_names import local_names
from gbeam.mechanics.tree.signals import Driven, drives_of, measurable, signals_of
from gbeam.mechanics.tree.system import System
from gbeam.motion.protocol import Motion, notes_on
from gbeam.numerics.eigen import Steady, Vibrations
from gbeam.numerics.series import STEP
from gbeam.numerics.whirl import Whirl
from gbeam.results.errors import Instability
from gbeam.results.state_space import Signal, StateSpace


def framed(whirl: Whirl | None, frequency: Floats, modes: Complex) -> dict[str, Any]:
    """Fields of a result that say in which frame frequencies (k,) Hz of modes (n, k) are, with those in the ground
    frame. They are empty where nothing turns.
    """
    if whirl is None or not whirl.turning:
        return {}
    return {"frame": "turning", "ground_frequency": whirl.in_ground(frequency, modes)}


def largest_component(shape: Complex) -> Complex:
    """The component of each mode (k, ...) that has the largest absolute value, (k,)."""
    components = shape.reshape(len(shape), -1) if shape.size else np.ones((len(shape), 1))
    return components[np.arange(len(components)), np.abs(components).argmax(axis=1)]


def instabilities(
    point: Steady, vibrations: Vibrations, directions: Callable[..., tuple[str, ...]] | None = None
) -> tuple[Instability, ...]:
    """Growing motions about a steady state, described by its words for directions, or by other ones."""
    say = partial(directions, point) if directions else point.directions

    def directions_of(modes: Complex) -> tuple[str, ...]:
        return say(modes) if modes.size else ()

    flutter = np.flatnonzero(vibrations.flutter)
    diverging = zip(vibrations.diverging, directions_of(vibrations.divergence), strict=True)
    fluttering = zip(vibrations.value[flutter], directions_of(vibrations.modes[:, flutter]), strict=True)
    return (
        *(Instability("divergence", float(v.real), 0.0, way) for v, way in diverging),
        *(Instability("flutter", float(v.real), float(abs(v) / (2 * np.pi)), way) for v, way in fluttering),
    )


def frozen(system: System, motion: Motion | None, time: float, at: str) -> SteadySystem:
    """State of a system to linearise about: its equilibrium if `at` is "rest", or its motion at the start, with bodies
    bent as in inertia relief, if it is "start".
    """
    choice("at", at, ("rest", "start"))
    drive = Drive(motion, time)
    return settled(system, drive) if at == "rest" else beginning(system, drive)


def linearize_system(
    state: SteadySystem,
    *,
    inputs: Sequence[str] | None,
    outputs: Sequence[str] | None,
    strained: Mapping[str, Strained] = MappingProxyType({}),
    name: str,
) -> StateSpace:
    """State-space model of small departures of a system, without its controllers.

    The inputs are efforts on joints' coordinates, the components of forces at points, and accelerations of the base and
    of prescribed coordinates. The outputs are the joints' coordinates and rates and the places of points, as named.
    """
    system = state.system
    local = state.local
    drivable = drives_of(system) | _moves_of(system, state.drive.motion)
    driven = default_inputs(system, state.drive.motion) if inputs is None else inputs
    for signal in driven:
        choice("inputs", signal, drivable)
    units = measurable(system) | dict.fromkeys(strained, "1")
    wanted = [*default_outputs(system), *strained] if outputs is None else [*outputs]
    for signal in wanted:
        choice("outputs", signal, units)
    read = partial(read_signals, system, local.tree, wanted, strained=strained)
    values, (by_y, by_yd, by_ydd) = _outputs(local, read)
    slopes = by_y - by_ydd @ state.follows, by_yd, by_ydd
    b, direct = _inputs(system, local, state.names, [drivable[signal] for signal in driven], read)
    chosen, motions = np.arange(len(state.names)), state.motions
    if motions is not None:
        by_y, by_yd, by_ydd = slopes
        chosen, b, slopes = state.independent, motions.T @ b, (by_y @ motions, by_yd @ motions, by_ydd @ motions)
    driving = tuple(Signal(signal, drivable[signal].unit) for signal in driven)
    a, b, c, d = state.linear._replace(inputs=b).state_space(*slopes, direct)
    names = [state.names[k] for k in chosen]
    suffixes = {"": "", "_rate": "/s"}  # of names and units; rotations of a ball are counted from this state
    states = [Signal(f"{q}{end}", units[q] + suffixes[end] if units.get(q) else "") for end in suffixes for q in names]
    return StateSpace(
        a=a,
        b=b,
        c=c,
        d=d,
        states=tuple(states),
        inputs=driving,
        outputs=tuple(Signal(signal, units[signal]) for signal in wanted),
        state=np.concatenate([local.y[chosen], local.yd[chosen]]),
        input=np.zeros(len(driving)),
        output=values,
        model="system",
        motion=name,
        time=state.drive.time,
        accelerated=state.accelerated,
        warnings=state.warnings + state.point.sticking(system),
        notes=notes_on({name: state.drive.motion}),
    )


def named_acceleration(motion: Any) -> str:
    """Word for the accelerations of a motion: "specific_force" if gravity is in them, else "acceleration"."""
    weight = motion.kind == "centrifuge" and float(motion.geometry.gravity) > 0
    weight = weight or (motion.kind == "hub" and motion.mount.gravity is not None)
    return "specific_force" if weight else "acceleration"


def _moves_of(system: System, motion: Motion | None) -> dict[str, Driven]:
    """Accelerations of the base, where one moves, and of prescribed coordinates, by name."""
    moves: dict[str, Driven] = {}
    if motion is not None:
        kinds = ("a", named_acceleration(motion), "m/s^2"), ("alpha", "angular_acceleration", "rad/s^2")
        for way, kind, unit in kinds:
            moves |= {f"base_{kind}_{axis}": Driven(way, k, unit) for k, axis in enumerate("xyz")}
    units = signals_of(system)
    for k, name in enumerate(local_names(system.coordinates[index] for index in system.tree.fixed)):
        moves[f"{name}_acceleration"] = Driven("prescribed", k, f"{units[name]}/s^2")
    return moves


def default_inputs(system: System, motion: Motion | None) -> list[str]:
    """Names of driven coordinates, force components, and accelerations of base and prescribed coordinates."""
    driven = {f"{name}.{coordinate}" for name, joint in system.joints.items() for coordinate in joint.efforts}
    drives = [name for name in drives_of(system) if name in driven or name.partition(".")[0] in system.forces]
    return [*drives, *_moves_of(system, motion)]


def default_outputs(system: System) -> list[str]:
    """Names of coordinates, their rates and the places of points."""
    quantities = ("acceleration", "velocity", "attitude", "spin")
    return [name for name in signals_of(system) if not name.rpartition(".")[2].startswith(quantities)]


def _inputs(
    system: System, local: Point, names: Sequence[str], chosen: Sequence[Driven], read: Callable[..., Any]
) -> tuple[Floats, Floats]:
    """Generalised forces (n, m) of unit inputs, and their feedthrough (k, m) to what `read` reads, by complex steps."""
    state = local.y + 0j, local.yd + 0j, local.ydd + 0j
    state_now = tuple(values[None] for values in state)
    forces, direct = (
        np.zeros((len(names), len(chosen))),
        np.zeros((read(*state_now, local.inputs).shape[-1], len(chosen))),
    )
    for k, drive in enumerate(chosen):
        if drive.way == "effort":
            (name,) = local_names([system.coordinates[drive.at]])
            forces[names.index(name), k] = 1.0
            continue
        moved = _perturbed_inputs(local.inputs, drive)
        forces[:, k] = -local.tree(*state, moved).imag / STEP
        direct[:, k] = read(*state_now, moved)[0].imag / STEP
    return forces, direct


def _perturbed_inputs(inputs: Inputs, driven: Driven) -> Inputs:
    """Inputs with a complex step in one of them: in an acceleration of the ground, or in an entry of an array."""
    if driven.way in ("a", "alpha"):
        faster = getattr(inputs.ground, driven.way) + 1j * STEP * np.eye(3)[driven.at]
        return replace(inputs, ground=replace(inputs.ground, **{driven.way: faster}))
    row = driven.force if driven.way == "wrenches" else 2  # of prescribed values, rates and accelerations the last
    values: Any = np.array(getattr(inputs, driven.way), dtype=complex)
    values[row, driven.at] += 1j * STEP
    return replace(inputs, **{driven.way: values})


def _outputs(local: Point, read: Callable[..., Any]) -> tuple[Floats, tuple[Floats, Floats, Floats]]:
    """Values (k,) of the outputs that `read` reads, and their derivatives (k, n) with respect to y, ẏ and ÿ."""
    n = len(local.y)
    state = np.concatenate([local.y, local.yd, local.ydd])
    moved = np.concatenate([state[None] + 0j, state + 1j * STEP * np.eye(3 * n)]).reshape(3 * n + 1, 3, n)
    measured = read(moved[:, 0], moved[:, 1], moved[:, 2], local.inputs)
    slopes = (measured[1:].imag / STEP).reshape(3, n, measured.shape[-1]).transpose(0, 2, 1)
    return measured[0].real, (slopes[0], slopes[1], slopes[2])
