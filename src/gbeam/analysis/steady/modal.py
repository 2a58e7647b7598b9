"""Modes: small vibrations about a relative equilibrium, with or without gyroscopic coupling."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any, TypeVar, overload

import numpy as np

from gbeam.analysis.accuracy.estimate import not_known
from gbeam.analysis.steady.frequency_errors import BY_RICHER, Richer, doubtful, unknown_errors
from gbeam.analysis.steady.subject import Subject, drawn, extent, subject_of
from gbeam.analysis.system.linear import framed, instabilities, largest_component, system_modes
from gbeam.analysis.system.richer import judged_bodies
from gbeam.analysis.system.steady import SteadySystem, settled
from gbeam.guards.arguments import typed
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.system import System
from gbeam.motion.protocol import Motion, notes_on
from gbeam.numerics.eigen import Vibrations
from gbeam.progress import Progress, tell
from gbeam.results.modal import Modes
from gbeam.results.system import SystemModes

AnyModes = TypeVar("AnyModes", Modes, SystemModes)


def modes_of_body(
    subject: Subject, state: SteadySystem, moving: Vibrations, *, gyroscopic: bool = True, name: str = ""
) -> Modes:
    """Modes, among those `moving`, of one body about a steady state, each scaled to a largest component of one."""
    structure, columns = subject.structure, subject.columns(state)
    q, others = state.q[columns], len(state.names) - len(columns)
    rigid = others if others and not np.abs(state.linear.stiffness[:, 0]).any() else 0
    # With the mode of a hub that a spring holds, and those of the body that are its own.
    moving = moving.oscillating(slice(structure.resolved + others - rigid))
    coordinates, direction = moving.modes[columns], subject.directions(state, moving.modes)
    shape = np.moveaxis(structure.station_slopes(q) @ coordinates, -1, 0)
    # Turn each shape so that its largest component is 1.
    largest, turns = largest_component(shape), structure.station_twist(q)
    twist = None if turns is None else (turns @ coordinates).T
    if twist is not None:
        largest = np.where(np.array(direction) == "twist", largest_component(twist * extent(structure)), largest)
    scale = np.where(largest == 0, 1, largest)
    recovery, whirl = structure.recovery, state.whirl
    return Modes(
        motion=name,
        model=structure.kind,
        time=state.drive.time,
        base=subject.base(state),
        gyroscopic=gyroscopic,
        eigenvalue=moving.value,
        direction=direction,
        **framed(whirl, moving.frequency / (2 * np.pi), moving.modes),
        coordinates=coordinates.T,
        stations=np.asarray(structure.stations),
        shape=shape / scale[:, None, None],
        twist=None if twist is None else twist / scale[:, None],
        equilibrium=np.asarray(structure.displacement(q)),
        instabilities=instabilities(state, moving, subject.directions),
        rigid=rigid,
        damping_given=structure.damping_ratio is not None,
        overdamped=moving.decaying,
        surface=None if recovery is None or not len(moving.value) else recovery.in_modes((coordinates / scale).T),
        notes=notes_on({name: subject.motion}),
        warnings=subject.warnings(state, name),
        **drawn(structure),
    )


def decided(computed: AnyModes, bend: float) -> AnyModes:
    """Modes about a state, without the instabilities of a stiffness of first order where it bends too far for that."""
    undecided = not_known(bend, str(computed.instabilities[0])) if computed.instabilities else {}
    return replace(computed, instabilities=(), **undecided) if undecided else computed


@overload
def modes(
    structure: System,
    motion: Motion | None = None,
    time: float = 0.0,
    *,
    gyroscopic: bool = True,
    errors: bool = True,
    name: str = "",
    progress: Progress = None,
) -> SystemModes: ...
@overload
def modes(
    structure: Structure,
    motion: Motion | None = None,
    time: float = 0.0,
    *,
    gyroscopic: bool = True,
    errors: bool = True,
    name: str = "",
    progress: Progress = None,
) -> Modes: ...
@typed
def modes(
    structure: Structure | System,
    motion: Motion | None = None,
    time: float = 0.0,
    *,
    gyroscopic: bool = True,
    errors: bool = True,
    name: str = "",
    progress: Progress = None,
) -> Modes | SystemModes:
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
    Modes or SystemModes

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
    if not subject.body:
        subject.system.require_damping("that of its modes")
    state = settled(subject.system, subject.drive(time))
    moving = state.vibrations(gyroscopic=gyroscopic)
    computed: Any = (
        modes_of_body(subject, state, moving, gyroscopic=gyroscopic, name=name)
        if subject.body
        else system_modes(state, moving, time, name)
    )
    computed = decided(computed, state.bend)
    if not errors:
        return computed
    stated = unknown_errors(subject.system, len(computed.eigenvalue))
    if judged_bodies(subject.system):
        tell(progress, BY_RICHER, 0.5)
        moving = moving.oscillating(slice(len(computed.eigenvalue)))
        stated = Richer(state).errors(state, moving.value, moving.modes.T, gyroscopic=gyroscopic)
        # Modes above those that are known have their own warning.
        reached = math.inf if subject.body else computed.reached
        computed = replace(computed, warnings=computed.warnings + doubtful(stated[~(computed.frequency > reached)]))
    return replace(computed, errors=stated)
