"""Modes: small vibrations about a relative equilibrium, with or without gyroscopic coupling."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from gbeam.analysis.accuracy.estimate import not_known
from gbeam.analysis.outline import assembly_of, box_in_modes, outline_in_modes, supports_in_modes
from gbeam.analysis.steady.frequency_errors import BY_RICHER, RicherModels, doubtful, unknown_errors
from gbeam.analysis.steady.subject import Subject, directions_of, edges_of, subject_of
from gbeam.analysis.system.linear import framed, instabilities, largest_component
from gbeam.analysis.system.rest import settled
from gbeam.analysis.system.richer import judged_bodies
from gbeam.analysis.system.steady import SteadySystem
from gbeam.arrays.types import Complex, Floats
from gbeam.guards.arguments import typed
from gbeam.guards.quantities import Seconds
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.signal_names import deforming
from gbeam.mechanics.tree.steps import parameters_of_matrices
from gbeam.mechanics.tree.system import System
from gbeam.motion.protocol import Motion, notes_on
from gbeam.numerics.eigen import Vibrations
from gbeam.progress import Progress, tell
from gbeam.results.modal import BodyModes, Modes

STILL = 1e-9  # of the largest coordinate of a body in any mode: it does not deform


def modes_of(
    subject: Subject, state: SteadySystem, vibrations: Vibrations, *, gyroscopic: bool = True, name: str = ""
) -> Modes:
    """Describe those modes of a system about a steady state that are among the `vibrations`.

    Each is scaled so that the largest component of its points and of its bodies' stations and edges is one.
    """
    system = state.system
    rigid = len(state.linear.mass) - len(vibrations.value) - (len(vibrations.diverging) + len(vibrations.decaying)) // 2
    # Static shapes of a body bring modes where others hang on it, and beside others those that are not its own.
    hung = {joint.on.partition(".")[0] for joint in system.joints.values()}
    static = 0
    if len(system.flexible) == 1:
        ((name_of_body, body_alone),) = system.flexible.items()
        static = 0 if name_of_body in hung else body_alone.size - body_alone.resolved
    vibrations = vibrations.oscillating(slice(len(state.linear.mass) - static - rigid))
    shape, turn = (np.einsum("pan,nk->kpa", slopes, vibrations.modes) for slopes in state.slopes_of_frames)
    bodies = dict[str, tuple[Structure, Floats, Complex]]()
    for body_name, structure in system.flexible.items():
        columns = deforming(state.names, body_name)
        if columns:
            bodies[body_name] = structure, state.q[columns], vibrations.modes[columns]
    moved = [shape, *(part for of_body in bodies.values() for part in _mode_displacements(*of_body))]
    components = [part.reshape(len(part), int(np.prod(part.shape[1:]))) for part in moved]
    largest = largest_component(np.concatenate(components, axis=1))
    scale = np.where(largest == 0, 1, largest)
    of_frame = framed(state.whirl, vibrations.frequency / (2 * np.pi), vibrations.modes)
    warnings, time = subject.warnings(state, name), state.drive.time
    if state.changing:
        of_frame.pop("ground_frequency", None)
        warnings += (f"the system turns, and its equations with it: these are modes of the place at {time:g} s",)
    reduced = [body for body in system.flexible.values() if body.resolved < body.size]
    return Modes(
        motion=name,
        time=time,
        base=state.base,
        gyroscopic=gyroscopic,
        eigenvalue=vibrations.value,
        direction=subject.directions(state, vibrations.modes),
        points=system.points,
        body_names=system.order,
        point_shape=shape / scale[:, None, None],
        point_turn=turn / scale[:, None, None],
        share=state.shares(vibrations.modes),
        place=np.stack([frame.p for frame in state.frames]),
        attitude=parameters_of_matrices(np.stack([frame.R for frame in state.frames])),
        bodies={body_name: _in_modes(state, body_name, *of_body, scale) for body_name, of_body in bodies.items()},
        instabilities=instabilities(state, vibrations, subject.directions),
        rigid=rigid,
        overdamped=vibrations.decaying,
        accelerated=state.accelerated,
        reached=min((float(body.rest[0][body.resolved - 1]) / (2 * np.pi) for body in reduced), default=math.nan),
        assembly=assembly_of(system),
        notes=notes_on({name: subject.motion}),
        warnings=warnings,
        **of_frame,
    )


def _mode_displacements(structure: Structure, q: Floats, modes: Complex) -> list[Any]:
    """Displacements (k, ...) of the stations of a body, and of the edges of its sections, in modes (n, k)."""
    edges = edges_of(structure, q, modes)
    stations = np.moveaxis(structure.station_slopes(q) @ modes, -1, 0)
    return [stations] if edges is None else [stations, edges.T]


def _in_modes(
    state: SteadySystem, name: str, structure: Structure, q: Floats, modes: Complex, scale: Complex
) -> BodyModes:
    """Describe one body in modes (n, k) of a system, each divided by its `scale`."""
    scaled, recovery, twist = modes / scale, structure.recovery, structure.twist_slopes(q)
    shape = np.moveaxis(structure.station_slopes(q) @ scaled, -1, 0)
    moves = np.abs(scaled).max(axis=0, initial=0.0) > STILL * np.abs(scaled).max(initial=0.0)
    ways = zip(directions_of(structure, q, scaled), moves, strict=True)
    outlines = outline_in_modes(structure, q, scaled)
    surface = box_in_modes(structure, scaled) if recovery is None else recovery.in_modes(scaled.T)
    return BodyModes(
        model=structure.kind,
        base=state.base_of(name),
        damping_given=structure.damping_ratio is not None,
        direction=tuple(way if in_motion else "" for way, in_motion in ways),
        coordinates=modes.T,
        stations=np.asarray(structure.stations),
        shape=shape,
        equilibrium=np.asarray(structure.displacement(q)),
        twist=None if twist is None else (twist @ scaled).T,
        surface=surface if modes.size else None,
        **outlines,
        **supports_in_modes(structure, q, scaled, outlines),
    )


def decided(computed: Modes, bend: float) -> Modes:
    """Modes about a state. Where it bends too far for a stiffness of first order, that stiffness cannot decide
    instabilities, and they are left out.
    """
    undecided = not_known(bend, str(computed.instabilities[0])) if computed.instabilities else {}
    return replace(computed, instabilities=(), **undecided) if undecided else computed


@typed
def modes(
    structure: Structure | System,
    motion: Motion | None = None,
    time: Seconds = 0.0,
    *,
    gyroscopic: bool = True,
    errors: bool = True,
    name: str = "",
    progress: Progress = None,
) -> Modes:
    """Small vibrations of a beam about its relative equilibrium on a base frozen at a time, or of a system of bodies.

    Parameters
    ----------
    structure : Structure or System
        From :func:`gbeam.assemble`; the shapes are given at its stations. Of a system they are given at its points,
        about its static equilibrium.
    motion : Flight, Centrifuge or Hub, optional
        Without one the base is at rest. A free hub turns with the beam: its angle is a coordinate, and its mode of zero
        frequency is left out.
    time : float
        s.
    gyroscopic : bool
        Whether to keep Coriolis coupling.
    errors : bool
        Whether to estimate the errors of the frequencies, which takes most of the time.
    name : str
        For the result.
    progress : callable or bool, optional
        Called with what is being done and the fraction of it done; True shows a bar.

    Returns
    -------
    Modes

    Raises
    ------
    ComputationError
        If there is no relative equilibrium.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    >>> structure = gb.assemble(beam, "FOAM", axial=1, y=2, z=2)
    >>> print(gb.modes(structure).frequency.round(1))
    [  36.6  182.6  229.  1138.7 4243.1]
    """
    tell(progress, "equilibrium", 0.0)
    subject = subject_of(structure, motion)
    subject.require_coordinates()
    state = settled(subject.system, subject.drive(time))
    vibrations = state.vibrations(gyroscopic=gyroscopic)
    computed = modes_of(subject, state, vibrations, gyroscopic=gyroscopic, name=name)
    computed = decided(computed, state.bend)
    if not errors:
        return computed
    stated = unknown_errors(subject.system, len(computed.eigenvalue))
    if judged_bodies(subject.system):
        tell(progress, BY_RICHER, 0.5)
        vibrations = vibrations.oscillating(slice(len(computed.eigenvalue)))
        stated = RicherModels(state).errors(state, vibrations.value, vibrations.modes.T, gyroscopic=gyroscopic)
        # Modes above those that are known have their own warning.
        is_known = stated[~(computed.frequency > computed.reached)]
        computed = replace(computed, warnings=computed.warnings + doubtful(is_known))
    return replace(computed, errors=stated)
