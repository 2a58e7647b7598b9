"""Modes: small vibrations about a relative equilibrium, with or without gyroscopic coupling."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, overload

import numpy as np

from gbeam.analysis.steady.frequency_errors import Richer, doubtful
from gbeam.analysis.steady.operating_point import Linear, OperatingPoint, linear_matrices, operating_point
from gbeam.analysis.system.linear import system_modes
from gbeam.guards.arguments import typed
from gbeam.mechanics.plausibility import input_warnings
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.system import System
from gbeam.motion.protocol import Motion
from gbeam.numerics.eigen import ZERO, eigenvalues, growth_limit
from gbeam.results.modal import Instability, Modes, outermost
from gbeam.results.result import Complex, Floats
from gbeam.results.system import SystemModes


def _sensitivity(structure: Structure, q: Any) -> tuple[Floats, Floats]:
    """Derivatives of the particles' places with respect to q, (k, 3, n), and of the stations', (s, 3, n)."""
    return structure.particles.slopes(q), structure.station_slopes(q)


def directions(structure: Structure, point: OperatingPoint, coordinates: Complex | Floats) -> tuple[str, ...]:
    """Axis along which each mode (n, k) moves the structure most, or twist where that moves the sections' edges more
    than their centres.
    """
    particles, stations = _sensitivity(structure, point.q)
    ways = ["xyz"[i] for i in np.abs(np.concatenate([particles, stations]) @ coordinates).max(axis=0).argmax(axis=0)]
    twist = structure.station_twist(point.q)
    if twist is not None:
        twisted, moved = (np.abs(each @ coordinates) for each in (_extent(structure)[:, None] * twist, stations))
        more = twisted.max(axis=0) > moved.max(axis=(0, 1))
        ways = ["twist" if each else way for way, each in zip(ways, more, strict=True)]
    return tuple(ways)


def _extent(structure: Structure) -> Floats:
    """Distance of the outermost fibres from the axis at the stations, m."""
    drawn = _drawn(structure)
    return outermost(drawn["width"], drawn["thickness"], is_round=drawn["round"])


def modes_at(
    structure: Structure,
    point: OperatingPoint,
    linear: Linear | None = None,
    *,
    gyroscopic: bool = True,
    name: str = "",
    time: float = float("nan"),
) -> Modes:
    """Modes about an operating point; `linear` is its :func:`linear_matrices`, if known."""
    linear = linear_matrices(point) if linear is None else linear
    value, mode = eigenvalues(*linear[:3], gyroscopic=gyroscopic)
    _, stations = _sensitivity(structure, point.q)
    size = np.abs(value).max()
    zero, real = np.abs(value) <= ZERO * size, np.abs(value.imag) <= ZERO * size
    beam = mode[point.first :]

    def pick(chosen: np.ndarray) -> tuple[Complex, Complex, tuple[str, ...]]:
        order = np.flatnonzero(chosen)[np.argsort(np.abs(value[chosen]), kind="stable")]
        return value[order], beam[:, order], directions(structure, point, beam[:, order])

    oscillating, coordinates, direction = pick(~zero & ~real & (value.imag > 0))
    growing, _, grows = pick(~zero & real & (value.real > 0))
    shape = np.moveaxis(stations @ coordinates, -1, 0)
    # Turn each shape so that its largest component is 1.
    largest, turns = _largest(shape), structure.station_twist(point.q)
    twist = None if turns is None else (turns @ coordinates).T
    if twist is not None:
        largest = np.where(np.array(direction) == "twist", _largest(twist * _extent(structure)), largest)
    scale = np.where(largest == 0, 1, largest)
    flutter = oscillating.real > growth_limit(oscillating, size)
    return Modes(
        motion=name,
        model=structure.kind,
        time=time,
        base=point.frozen,
        gyroscopic=gyroscopic,
        eigenvalue=oscillating,
        direction=direction,
        coordinates=coordinates.T,
        stations=np.asarray(structure.stations),
        shape=shape / scale[:, None, None],
        twist=None if twist is None else twist / scale[:, None],
        equilibrium=np.asarray(structure.displacement(point.q)),
        instabilities=tuple(
            [Instability("divergence", float(v.real), 0.0, d) for v, d in zip(growing, grows, strict=True)]
            + [
                Instability("flutter", float(v.real), float(abs(v) / (2 * np.pi)), d)
                for v, d, bad in zip(oscillating, direction, flutter, strict=True)
                if bad
            ]
        ),
        rigid=int(point.first and not np.abs(linear.stiffness[:, 0]).any()),
        damping_given=structure.damping_ratio is not None,
        overdamped=np.sort(value[~zero & real & (value.real < 0)].real),
    )


def _largest(shape: Complex) -> Complex:
    """The component of each mode (k, ...) that is largest."""
    flat = shape.reshape(len(shape), -1) if shape.size else np.ones((len(shape), 1))
    return flat[np.arange(len(flat)), np.abs(flat).argmax(axis=1)]


@overload
def modes(
    structure: System, motion: Motion | None = None, time: float = 0.0, *, gyroscopic: bool = True, name: str = ""
) -> SystemModes: ...
@overload
def modes(
    structure: Structure, motion: Motion | None = None, time: float = 0.0, *, gyroscopic: bool = True, name: str = ""
) -> Modes: ...
@typed
def modes(
    structure: Structure | System,
    motion: Motion | None = None,
    time: float = 0.0,
    *,
    gyroscopic: bool = True,
    name: str = "",
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
    name : str
        For the result.

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
    [  36.6  182.8  229.1 1145.5 4243.1]
    """
    if isinstance(structure, System):
        return system_modes(structure, motion, time, gyroscopic=gyroscopic, name=name)
    point = operating_point(structure, motion, time)
    warnings = input_warnings(structure, motion, name=name, span=(time, time), base=point.base)
    computed = modes_at(structure, point, gyroscopic=gyroscopic, name=name, time=time)
    errors = None
    if structure.source is not None and not structure.traced:
        errors = Richer(structure, point.base).errors(
            point, computed.eigenvalue, computed.coordinates, gyroscopic=gyroscopic
        )
        warnings += doubtful(errors)
    return replace(computed, errors=errors, warnings=warnings, **_drawn(structure))


def _drawn(structure: Structure) -> dict[str, Any]:
    """The beam as a picture of the shapes needs it."""
    if structure.source is None or structure.traced:
        return {}
    section = structure.source.beam.section.at(structure.stations)
    width, thickness = section.extents()
    return {"width": width, "thickness": thickness, "round": section.round}
