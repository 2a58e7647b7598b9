"""Modes: small vibrations about a relative equilibrium, with or without gyroscopic coupling."""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar, overload

import numpy as np

from gbeam.analysis.accuracy.estimate import not_known
from gbeam.analysis.steady.frequency_errors import BY_RICHER, Richer, doubtful, judgeable, unknown_errors
from gbeam.analysis.steady.operating_point import OperatingPoint, drawn, extent, operating_point
from gbeam.analysis.system.linear import framed, instabilities, largest_component, system_modes
from gbeam.analysis.system.steady import Drive, settled
from gbeam.arrays.tree import each_leaf
from gbeam.guards.arguments import typed
from gbeam.mechanics.plausibility import bend, bent_far, input_warnings
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.system import System
from gbeam.motion.protocol import Motion, notes_on
from gbeam.progress import Progress, tell
from gbeam.results.modal import Modes
from gbeam.results.system import SystemModes

AnyModes = TypeVar("AnyModes", Modes, SystemModes)


def modes_at(
    structure: Structure,
    point: OperatingPoint,
    *,
    gyroscopic: bool = True,
    name: str = "",
    time: float = float("nan"),
) -> Modes:
    """Modes about an operating point, each scaled to a largest component of one."""
    rigid = int(point.first and not np.abs(point.linear.stiffness[:, 0]).any())
    deforming = slice(structure.resolved + point.first - rigid)  # with a sprung hub's own mode
    moving = point.vibrations(gyroscopic=gyroscopic).oscillating(deforming)
    coordinates, direction = moving.modes[point.first :], point.directions(moving.modes)
    shape = np.moveaxis(structure.station_slopes(point.q) @ coordinates, -1, 0)
    # Turn each shape so that its largest component is 1.
    largest, turns = largest_component(shape), structure.station_twist(point.q)
    twist = None if turns is None else (turns @ coordinates).T
    if twist is not None:
        largest = np.where(np.array(direction) == "twist", largest_component(twist * extent(structure)), largest)
    scale = np.where(largest == 0, 1, largest)
    recovery = structure.recovery
    return Modes(
        motion=name,
        model=structure.kind,
        time=time,
        base=each_leaf(np.asarray, point.base),
        gyroscopic=gyroscopic,
        eigenvalue=moving.value,
        direction=direction,
        **framed(point.whirl, moving.frequency / (2 * np.pi), moving.modes),
        coordinates=coordinates.T,
        stations=np.asarray(structure.stations),
        shape=shape / scale[:, None, None],
        twist=None if twist is None else twist / scale[:, None],
        equilibrium=np.asarray(structure.displacement(point.q)),
        instabilities=instabilities(point, moving),
        rigid=rigid,
        damping_given=structure.damping_ratio is not None,
        overdamped=moving.decaying,
        surface=None if recovery is None or not len(moving.value) else recovery.in_modes((coordinates / scale).T),
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
    if isinstance(structure, System):
        structure.require_damping("that of its modes")
        state = settled(structure, Drive(motion, time))
        moving = state.vibrations(gyroscopic=gyroscopic)
        of_system = decided(system_modes(state, moving, time, name), state.bend)
        if not errors:
            return of_system
        if not judgeable(structure):
            return replace(of_system, errors=unknown_errors(structure, len(moving.value)))
        tell(progress, BY_RICHER, 0.5)
        judged = Richer(state).errors(state, moving.value, moving.modes.T, gyroscopic=gyroscopic)
        doubts = doubtful(judged[~(of_system.frequency > of_system.reached)])  # modes above have their own warning
        return replace(of_system, errors=judged, warnings=of_system.warnings + doubts)
    structure.require_coordinates()
    point = operating_point(structure, motion, time)
    warnings = input_warnings(structure, motion, name=name, span=(time, time), base=point.base)
    computed = decided(modes_at(structure, point, gyroscopic=gyroscopic, name=name, time=time), point.bend)
    warnings += tuple(bent_far(structure, bend(structure, point.q)))
    stated = None
    if errors and judgeable(structure):
        tell(progress, BY_RICHER, 0.5)
        stated = Richer(point).errors(point, computed.eigenvalue, computed.coordinates, gyroscopic=gyroscopic)
        warnings += doubtful(stated)
    elif errors:
        stated = unknown_errors(structure, len(computed.eigenvalue))
    return replace(computed, errors=stated, warnings=warnings, notes=notes_on({name: motion}), **drawn(structure))
