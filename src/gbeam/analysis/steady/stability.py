"""Loss of the relative equilibrium: critical hub rates, divergence of a beam pointing inward, buckling.

About a relative equilibrium on a steadily turning base the energy that counts is the amended potential, whose second
derivative is K. While K is positive definite the equilibrium is stable, with any damping inside the beam too. Once it
is not, such damping destroys whatever gyroscopic coupling might have saved (Kelvin, Tait, Chetayev). So the
definiteness of K decides, for every model. Only loads that follow the beam make K unsymmetric, and then the eigenvalues
decide. There damping matters: the least of it lowers the flutter load of Beck's column (Ziegler's paradox).
"""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Annotated

import numpy as np

from gbeam.analysis.steady.loss import doubtful_loss, first_loss_along, judged, with_frequencies
from gbeam.analysis.steady.subject import Subject, subject_of
from gbeam.analysis.system.drive import Drive, loaded, pushed, turning_at, turning_of
from gbeam.analysis.system.path import Path, refuse_changing, share_of_loads
from gbeam.arrays.types import Numbers
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import positive
from gbeam.guards.quantities import OfKind, Quantity, Seconds
from gbeam.mechanics.assembly import assemble
from gbeam.mechanics.models import Model
from gbeam.mechanics.plausibility import input_warnings
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.system import System
from gbeam.motion.hub import Hub
from gbeam.motion.profiles.profile import Profile
from gbeam.motion.protocol import Motion, notes_on
from gbeam.progress import Progress, tell
from gbeam.results.equilibrium import Critical, CriticalMap, MapErrors
from gbeam.results.errors import ErrorEstimate
from gbeam.results.parts import Base
from gbeam.structure.attachments import PointMass
from gbeam.structure.beam import Beam

SEARCH_FACTOR = 10.0  # of the lowest natural frequency: how far a search goes by default
INSTEAD = "ask `gbeam modes` for its frequencies at a time, or `gbeam static` for its shape"
SLOW = 1e-6  # rad/s
NOTHING = 1e-12  # of the beam's stiffness: loads that add less are none


def hub_of(motion: Motion, verb: str, instead: str, name: str = "") -> Hub:
    """Return `motion` if it is a hub; else raise InputError that says what needs one, and what to ask `instead`."""
    if isinstance(motion, Hub):
        return motion
    raise InputError(
        f"motion.{name}" if name else "motion",
        f"is a {motion.kind}, which has no hub to turn faster: {verb} needs one",
        instead,
    )


@typed
def critical_speed(
    structure: Structure | System,
    motion: Motion | None = None,
    *,
    turning: str | None = None,
    upper: Annotated[float, Quantity("angular rate")] | None = None,
    time: Seconds = 0.0,
    name: str = "",
    progress: Progress = None,
) -> Critical:
    """Lowest rate at which the relative equilibrium on a hub, or of a system that turns, is lost, the rate being held.

    Parameters
    ----------
    structure : Structure or System
    motion : Hub, optional
        Its own rate or torque is not used. A system needs none where one of its joints turns.
    turning : str, optional
        Of a system: the joint's angle that turns, ``joint.angle``; without a hub by default the only prescribed one,
        or the only one.
    upper : float, optional
        End of the search, rad/s; by default ten times the lowest natural frequency.
    time : float
        Of a system: when its loads and other joints are frozen, s.
    name : str
        Of the motion, for what is said of it.
    progress : callable or bool, optional
        Called with what is done and the share of it; True shows a bar.

    Returns
    -------
    Critical
        ``value`` is None where there is none: TLAM has one (2009 section 4), the models with foreshortening have
        none below the speeds at which the beam would be torn apart.

    Raises
    ------
    InputError
        If the motion has no hub, a system has no such angle, or its equations change as it turns.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    >>> hub = gb.Hub(radius=0.5)
    >>> print(gb.critical_speed(gb.assemble(beam, "FOAM", axial=1, y=2, z=2), hub, upper=100.0).value)
    None
    >>> loss = gb.critical_speed(gb.assemble(beam, "TLAM", axial=1, y=2, z=2), hub)
    >>> print(f"{loss.value:.4g} rad/s")
    1148 rad/s
    """
    subject = subject_of(structure, motion)
    path, _ = turned(subject, turning, time, "a critical speed", INSTEAD, name, held=True)
    loss = first_lost_speed(subject, path, upper, progress)
    return replace(with_frequencies(loss, path, subject.system, progress), notes=notes_on({name: motion}))


def first_lost_speed(subject: Subject, path: Path, upper: float | None, progress: Progress) -> Critical:
    """Lowest rate at which the equilibrium is lost along a path that holds the rate, with its errors."""
    limit = SEARCH_FACTOR * lowest_frequency(path, subject.system) if upper is None else positive("to", upper, "rad/s")
    refuse_changing(path, subject.system, limit / SEARCH_FACTOR)
    loss = first_loss_along(path, subject, limit, subject.rate, "rad/s", progress)
    return judged(loss, path, subject, progress)


def lowest_frequency(path: Path, system: System) -> float:
    """Lowest natural frequency where a path begins, rad/s."""
    limit = float(path(system, 0.0).moving.frequency.min(initial=np.inf))
    if not np.isfinite(limit):
        raise InputError("to", "is missing, and nothing oscillates at rest", "give the end of the search")
    return limit


def turned(
    subject: Subject, angle: str | None, time: float, verb: str, instead: str, name: str, *, held: bool = False
) -> tuple[Path, Profile | None]:
    """Path of steady states by the rate of a subject that turns about an `angle`, by default a hub's.

    Besides, the history of the rate in the motion, if any. InputError, with the words `verb` and `instead`, if there is
    nothing to turn.
    """
    subject.require_coordinates()
    system, motion = subject.system, subject.ground
    if subject.body:
        if angle is not None:
            raise InputError("turning", "is given of one beam", "leave it out: its hub turns")
        if subject.motion is None:
            fix = 'give gb.Hub(radius=...), or [motion.NAME] with kind = "hub"'
            raise InputError("motion", f"is missing: {verb} needs a hub", fix)
        hub_of(subject.motion, verb, instead, name)
    coordinate = turning_of(system, motion, angle)
    joint, _, kind = coordinate.rpartition(".")
    history = system.joints[joint].rates.get(kind) if joint else motion.rate  # type: ignore[union-attr]
    path = Path(Drive(motion, time, coordinate), turning_at, held)
    # At a rate so slow that no equilibrium is lost: changing equations may be why there is none at larger rates.
    refuse_changing(replace(path, held=False), system, SLOW)
    return path, history


@typed
def critical_speed_map(
    beam: Beam,
    model: Model,
    motion: Motion,
    masses: Annotated[Numbers, Quantity("mass")],
    positions: Annotated[Numbers, OfKind("length")],
    upper: Annotated[float, Quantity("angular rate")] | None = None,
    *,
    name: str = "",
    progress: Progress = None,
) -> CriticalMap:
    """Critical hub rates with one more mass on the beam, against its size and position (2009 Fig. 9).

    Parameters
    ----------
    beam : Beam
    model : Model
    motion : Hub
    masses : (m,) kg
    positions : (p,) m from the root
    upper : float, optional
        End of the search, rad/s; by default ten times the lowest natural frequency without the mass.
    name : str
        Of the motion.
    progress : callable or bool, optional
        Called with what is done and the share of it; True shows a bar.

    Returns
    -------
    CriticalMap

    Raises
    ------
    InputError
        If the motion has no hub, or a mass or a position is impossible.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    >>> model = gb.Model("TLAM", axial=1, y=2)
    >>> answer = gb.critical_speed_map(beam, model, gb.Hub(radius=0.5), [0.01, 0.1], [0.15, 0.3])
    >>> print(answer.speed.round(1))
    [[1109.4  901.4]
     [ 869.1  424.8]]
    """
    hub, unloaded = hub_of(motion, "a critical speed", INSTEAD, name), assemble(beam, model)
    limit = SEARCH_FACTOR * float(unloaded.rest[0][0]) if upper is None else upper
    speed = np.full((len(masses), len(positions)), np.nan)
    errors = MapErrors(*np.full((len(fields(MapErrors)), *speed.shape), np.nan))
    largest = ErrorEstimate(total=0.0)
    for i, mass in enumerate(masses):
        for j, position in enumerate(positions):
            tell(progress, "critical hub rates", (i * len(positions) + j) / speed.size)
            loaded = replace(beam, masses=(*beam.masses, PointMass(position, mass)))
            subject = subject_of(assemble(loaded, model), hub)
            path, _ = turned(subject, None, 0.0, "", "", "", held=True)
            loss = judged(first_loss_along(path, subject, limit, "hub rate", "rad/s"), path, subject)
            speed[i, j] = np.nan if loss.value is None else loss.value
            for part in fields(errors):
                getattr(errors, part.name)[i, j] = getattr(loss.errors, part.name)
            if loss.errors.total > largest.total:
                largest = loss.errors
    warnings = input_warnings(unloaded, motion, name=name) + doubtful_loss("hub rate, at worst,", model.kind, largest)
    axes = np.asarray(masses, dtype=float), np.asarray(positions, dtype=float)
    notes = notes_on({name: motion})
    return CriticalMap(name, model.kind, *axes, speed, limit, errors, warnings=warnings, notes=notes)


@typed
def buckling_acceleration(
    structure: Structure | System,
    *,
    time: Seconds = 0.0,
    upper: Annotated[float, Quantity("acceleration")] | None = None,
    progress: Progress = None,
) -> Critical:
    """Acceleration of the root along +x at which the beam, pushed by it, buckles under its own inertia.

    The heavy column of Greenhill (1881): 7.8373 EI/(m L³) for a uniform beam without masses.

    Parameters
    ----------
    structure : Structure or System
        Of a system its ground is accelerated, beside its gravity.
    time : float
        When loads and joints are frozen, s.
    upper : float, optional
        End of the search, m/s²; by default ten times the length, or the system's extent, times the square of the lowest
        natural frequency.
    progress : callable or bool, optional
        Called with what is done and the share of it; True shows a bar.

    Returns
    -------
    Critical

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    >>> structure = gb.assemble(beam, "FOAM", axial=1, y=2, z=2)
    >>> print(f"{gb.buckling_acceleration(structure).value:.4g} m/s²")
    1.005e+04 m/s²
    """
    subject, path = subject_of(structure, None), Path(Drive(None, time), pushed)
    subject.require_coordinates()
    if upper is None:
        extent = float(np.linalg.norm(np.ptp(subject.system.undeformed, axis=0)))
        upper = SEARCH_FACTOR * lowest_frequency(path, subject.system) ** 2 * extent
    loss = first_loss_along(path, subject, upper, "acceleration along x", "m/s²", progress)
    return with_frequencies(judged(loss, path, subject, progress), path, subject.system, progress)


@typed
def critical_load(
    structure: Structure | System,
    base: Base | None = None,
    *,
    time: Seconds = 0.0,
    motion: Motion | None = None,
    upper: float | None = None,
    progress: Progress = None,
) -> Critical:
    """Factor on all loads on the beam, or on a system's beams and points, at which the relative equilibrium is lost.

    Euler's column under a dead load (π²/4 EI/L²), Beck's under one that follows the tip (20.05 EI/L², flutter).

    Parameters
    ----------
    structure : Structure or System
        With loads. Gravity and drives of a system stay as they are.
    base : Base, optional
        Frozen motion of the ground, arrays (3,), in place of a motion; by default at rest.
    time : float
        When loads, drives and motion are frozen, s.
    motion : Flight, Centrifuge or Hub, optional
        Of the ground, at rest without one.
    upper : float, optional
        End of the search; by default ten times the factor that makes the loads' stiffness as large as the beam's.
    progress : callable or bool, optional
        Called with what is done and the share of it; True shows a bar.

    Returns
    -------
    Critical

    Raises
    ------
    InputError
        If there is no load, or none acts at the time, or they change no stiffness.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> push = gb.Load(at=0.3, force=(-1.0, 0.0, 0.0))
    >>> column = gb.Beam(0.3, strip, gb.Material(2700, 70e9), loads=[push])
    >>> euler = gb.critical_load(gb.assemble(column, "FOAM", axial=1, z=4))
    >>> print(f"{euler.value:.4g} N")
    204.9 N
    """
    subject = subject_of(structure, motion)
    subject.require_coordinates()
    path = Path(replace(subject.resting_drive(time), base=base), loaded, held=True)
    share = share_of_loads(path, subject.system)
    if share < NOTHING:
        where, subject_words = ("beam.loads", "a hub's") if subject.body else ("forces", "a joint's")
        fix = (
            f"add one, or give a time at which one acts; `gbeam critical-speed` can raise {subject_words} rate instead"
        )
        raise InputError(where, "has no load that acts", fix)
    limit = SEARCH_FACTOR / share if upper is None else positive("to", upper, "times the loads")
    loss = first_loss_along(path, subject, limit, "load factor", "times the loads", progress)
    return with_frequencies(judged(loss, path, subject, progress), path, subject.system, progress)
