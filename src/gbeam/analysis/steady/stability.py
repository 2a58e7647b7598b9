"""Loss of the relative equilibrium: critical hub rates, divergence of a beam pointing inward, buckling.

About a relative equilibrium on a steadily turning base the energy that counts is the amended potential, whose second
derivative is K. While K is positive definite the equilibrium is stable, with any damping inside the beam too; once it
is not, such damping destroys whatever gyroscopic coupling might have saved (Kelvin, Tait, Chetayev). So the
definiteness of K decides, for every model; only loads that follow the beam make K unsymmetric, and then the
eigenvalues decide. There damping matters: the least of it lowers the flutter load of Beck's column (Ziegler's paradox).
"""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np

from gbeam.analysis.steady.loss import Path, doubtful_loss, first_loss_along, judged, with_frequencies
from gbeam.analysis.steady.operating_point import REST, OperatingPoint, on_base, on_hub, steady_base
from gbeam.analysis.system.steady import Drive, Loaded, Turning, turning_of
from gbeam.arrays.types import Numbers
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import positive
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


def hub_of(motion: Motion, what: str, instead: str, name: str = "") -> Hub:
    """Return `motion` if it is a hub; else raise InputError with the verb that can answer."""
    if isinstance(motion, Hub):
        return motion
    raise InputError(
        f"motion.{name}" if name else "motion",
        f"is a {motion.kind}, which has no hub to turn faster: {what} needs one",
        instead,
    )


def lowest_frequency(structure: Structure) -> float:
    """Lowest natural frequency of the beam on a base at rest, rad/s."""
    structure.require_coordinates()
    return float(structure.rest[0][0])


@typed
def critical_speed(
    structure: Structure | System,
    motion: Motion | None = None,
    *,
    turning: str | None = None,
    upper: float | None = None,
    time: float = 0.0,
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
    path, _ = turned(structure, motion, turning, time, "a critical speed", INSTEAD, name, held=True)
    lost = first_lost_speed(structure, path, upper, progress)
    return replace(with_frequencies(lost, path, structure, progress), notes=notes_on({name: motion}))


def first_lost_speed(structure: Structure | System, path: Path, upper: float | None, progress: Progress) -> Critical:
    """Lowest rate, with its errors, at which the equilibrium is lost along a path that holds the rate."""
    if upper is not None:
        limit = positive("to", upper, "rad/s")
    elif isinstance(structure, Structure):
        limit = SEARCH_FACTOR * lowest_frequency(structure)
    else:
        limit = SEARCH_FACTOR * float(path(structure, 0.0).moving.frequency.min(initial=np.inf))
        if not np.isfinite(limit):
            raise InputError("to", "is missing, and nothing oscillates at rest", "give the end of the search")
    if isinstance(path, Turning) and isinstance(structure, System):
        path.refuse_changing(structure, limit / SEARCH_FACTOR)
    words = "hub rate" if isinstance(structure, Structure) else "rate"
    return judged(first_loss_along(path, structure, limit, words, "rad/s", progress), path, structure, progress)


def turned(
    structure: Structure | System,
    motion: Motion | None,
    turning: str | None,
    time: float,
    what: str,
    instead: str,
    name: str,
    *,
    held: bool = False,
) -> tuple[Path, Profile | None]:
    """Path of steady states by the rate, of a structure on a hub or of a system that turns, and the history of the rate
    in the motion, if any; InputError, with the words `what` and `instead`, if there is nothing to turn.
    """
    if isinstance(structure, System):
        coordinate = turning_of(structure, motion, turning)
        joint, _, angle = coordinate.rpartition(".")
        history = structure.joints[joint].rates.get(angle) if joint else motion.rate  # type: ignore[union-attr]
        of_system = Turning(Drive(motion, time, coordinate), held)
        # At a rate so slow that no equilibrium is lost: changing equations may be why there is none at larger rates.
        replace(of_system, held=False).refuse_changing(structure, SLOW)
        return of_system, history
    structure.require_coordinates()
    if turning is not None:
        raise InputError("turning", "is given of one beam", "leave it out: its hub turns")
    if motion is None:
        fix = 'give gb.Hub(radius=...), or [motion.NAME] with kind = "hub"'
        raise InputError("motion", f"is missing: {what} needs a hub", fix)
    hub, values = hub_of(motion, what, instead, name), structure.load_values

    def path(of: Structure, rate: float) -> OperatingPoint:
        of = replace(of, load_values=values)
        return on_hub(of, hub, rate) if hub.free and not held else on_base(of, steady_base(hub, rate))

    return path, hub.rate


@typed
def critical_speed_map(
    beam: Beam,
    model: Model,
    motion: Motion,
    masses: Numbers,
    positions: Numbers,
    upper: float | None = None,
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
    limit = SEARCH_FACTOR * lowest_frequency(unloaded) if upper is None else upper
    speed = np.full((len(masses), len(positions)), np.nan)
    errors = MapErrors(*np.full((len(fields(MapErrors)), *speed.shape), np.nan))
    worst = ErrorEstimate(total=0.0)
    for i, mass in enumerate(masses):
        for j, position in enumerate(positions):
            tell(progress, "critical hub rates", (i * len(positions) + j) / speed.size)
            loaded = replace(beam, masses=(*beam.masses, PointMass(position, mass)))
            structure = assemble(loaded, model)
            path, _ = turned(structure, hub, None, 0.0, "", "", "", held=True)
            loss = judged(first_loss_along(path, structure, limit, "hub rate", "rad/s"), path, structure)
            speed[i, j] = np.nan if loss.value is None else loss.value
            for part in fields(errors):
                getattr(errors, part.name)[i, j] = getattr(loss.errors, part.name)
            if loss.errors.total > worst.total:
                worst = loss.errors
    warnings = input_warnings(unloaded, motion, name=name) + doubtful_loss("hub rate, at worst,", model.kind, worst)
    axes = np.asarray(masses, dtype=float), np.asarray(positions, dtype=float)
    notes = notes_on({name: motion})
    return CriticalMap(name, model.kind, *axes, speed, limit, errors, warnings=warnings, notes=notes)


@typed
def buckling_acceleration(structure: Structure, *, upper: float | None = None, progress: Progress = None) -> Critical:
    """Acceleration of the root along +x at which the beam, pushed by it, buckles under its own inertia.

    The heavy column of Greenhill (1881): 7.8373 EI/(m L³) for a uniform beam without masses.

    Parameters
    ----------
    structure : Structure
    upper : float, optional
        End of the search, m/s²; by default ten times the length times the square of the lowest natural frequency.
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
    limit = SEARCH_FACTOR * lowest_frequency(structure) ** 2 * structure.length if upper is None else upper

    values = structure.load_values

    def pushed(of: Structure, acceleration: float) -> OperatingPoint:
        base = Base(np.array([acceleration, 0.0, 0.0]), np.zeros(3), np.zeros(3))
        return on_base(replace(of, load_values=values), base)

    lost = first_loss_along(pushed, structure, limit, "acceleration along x", "m/s²", progress)
    return with_frequencies(judged(lost, pushed, structure, progress), pushed, structure, progress)


@typed
def critical_load(
    structure: Structure | System,
    base: Base | None = None,
    *,
    time: float = 0.0,
    motion: Motion | None = None,
    upper: float | None = None,
    progress: Progress = None,
) -> Critical:
    """Factor on all loads on the beam, or on a system's beams and points, at which the relative equilibrium is lost.

    Euler's column under a dead load (π²/4 EI/L²), Beck's under one that follows the tip (20.05 EI/L², flutter).

    Parameters
    ----------
    structure : Structure or System
        With loads, a structure's of time zero or of its :meth:`~gbeam.Structure.at_time`. Gravity and drives of a
        system stay as they are.
    base : Base, optional
        Frozen motion of a structure's base, arrays (3,); by default at rest.
    time : float
        Of a system: when its loads, drives and motion are frozen, s.
    motion : Flight, Centrifuge or Hub, optional
        Of a system's ground, at rest without one.
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
    path: Path
    if isinstance(structure, System):
        path = Loaded(Drive(motion, time))
        share = path.share(structure)
    else:
        values = structure.load_values
        share = 0.0 if values is None else _share(structure, values)

        def path(of: Structure, factor: float) -> OperatingPoint:
            of = replace(of, load_values=None if values is None else factor * values)
            return on_base(of, REST if base is None else base)

    if share < NOTHING:
        where, what = ("forces", "a joint's") if isinstance(structure, System) else ("beam.loads", "a hub's")
        fix = f"add one, or give a time at which one acts; `gbeam critical-speed` can raise {what} rate instead"
        raise InputError(where, "have none that act", fix)
    limit = SEARCH_FACTOR / share if upper is None else positive("to", upper, "times the loads")
    lost = first_loss_along(path, structure, limit, "load factor", "times the loads", progress)
    return with_frequencies(judged(lost, path, structure, progress), path, structure, progress)


def _share(structure: Structure, values: np.ndarray) -> float:
    """Larger of two effects of the loads: stiffness over the beam's own, and deflection over its length."""
    c = structure.coefficients
    assert c.loads is not None
    scale = np.linalg.inv(np.linalg.cholesky(c.stiffness))
    added = np.einsum("li,linm->nm", values, c.loads.slope[:, :, 6:])
    size = np.linalg.norm(scale @ added @ scale.T, 2)
    # Loads across the straight beam add no stiffness, but bend it.
    bend = np.linalg.norm(np.linalg.solve(c.stiffness, np.einsum("li,lin->n", values, c.loads.constant[:, :, 6:])))
    return float(max(size, bend / structure.length))
