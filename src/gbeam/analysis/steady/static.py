"""Static deflection: the relative equilibrium at a frozen base motion, along the beam."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, overload

import numpy as np

from gbeam.analysis.accuracy.estimate import LIMIT, cause_and_cure, not_known, percent
from gbeam.analysis.steady.subject import Subject, subject_of
from gbeam.analysis.system.accuracy import FAR, system_errors
from gbeam.analysis.system.linear import stepless, system_rest
from gbeam.analysis.system.richer import theories_of, with_beams
from gbeam.analysis.system.steady import Drive, SteadySystem, settled
from gbeam.arrays.tree import each_leaf
from gbeam.arrays.types import Numbers
from gbeam.errors import ComputationError, InputError
from gbeam.guards.arguments import typed
from gbeam.mechanics.models import TORSION
from gbeam.mechanics.section_forces import section_forces
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.system import System
from gbeam.motion.protocol import Motion, notes_on
from gbeam.progress import Progress, tell
from gbeam.results.equilibrium import Deflection
from gbeam.results.errors import Errors
from gbeam.results.parts import Base
from gbeam.results.system import SystemRest

LOST = "shapes and model are not judged: the exact model with more shapes comes to no equilibrium there"


def deflection_errors(subject: Subject, state: SteadySystem) -> tuple[Errors, tuple[str, ...]]:
    """Estimated errors of an equilibrium of one body, over its displacement, root loads and stress, and warnings."""
    solution, structure = state.standing(subject.system), subject.structure
    steps, start = stepless(subject.system), subject.system.undeformed
    errors, off_axis = system_errors(lambda _: solution, state.standing, steps, start=start, tolerance=LIMIT)
    errors = replace(errors, note=LOST) if FAR in errors.note else errors
    if not structure.judged:
        return errors, ()
    if errors.note == LOST:
        return errors, (LOST,)
    return errors, (*_doubtful(errors), *off_axis, *_sideways(subject, state))


def _sideways(subject: Subject, state: SteadySystem) -> tuple[str, ...]:
    """Warn of an equilibrium that a beam with torsion would not keep: a strip on edge buckles sideways."""
    theories = theories_of(subject.system)
    if not theories or not state.stable:
        return ()
    thick = with_beams(subject.system, {name: theory.thick for name, theory in theories.items()})
    try:
        if state.richer(thick).stable:
            return ()
    except (ComputationError, np.linalg.LinAlgError):
        pass
    return (f"a beam that twists would not stay there, but buckle sideways: {TORSION}",)


def _doubtful(errors: Errors) -> tuple[str, ...]:
    """Warn of an equilibrium that is wrong by more than one in a hundred."""
    if not (above := errors.above(LIMIT)):
        return ()
    worst = max(above.values(), key=lambda error: error.total)
    cause, cure = cause_and_cure(worst, errors.causes)
    sizes = ", ".join(f"the {name} by {percent(error.total)}" for name, error in above.items())
    return (f"estimated to be wrong: {sizes}, mostly from {cause}; {cure}",)


@overload
def static(
    structure: System,
    motion: Motion | None = None,
    time: float = 0.0,
    *,
    acceleration: Numbers | None = None,
    name: str = "",
    progress: Progress = None,
) -> SystemRest: ...
@overload
def static(
    structure: Structure,
    motion: Motion | None = None,
    time: float = 0.0,
    *,
    acceleration: Numbers | None = None,
    name: str = "",
    progress: Progress = None,
) -> Deflection: ...
@typed
def static(
    structure: Structure | System,
    motion: Motion | None = None,
    time: float = 0.0,
    *,
    acceleration: Numbers | None = None,
    name: str = "",
    progress: Progress = None,
) -> Deflection | SystemRest:
    """Equilibrium relative to a base whose motion is frozen at a time, and what its sections carry.

    Parameters
    ----------
    structure : Structure or System
        From :func:`gbeam.assemble`; shape and loads are given at its stations. A system rests in its joints too, but
        for what slides freely, as a free body that falls or is pushed: it is accelerated evenly, `accelerated`.
        Where it begins to turn ever faster too, it is the state at that instant (inertia relief), with a warning.
        Joints rest without their friction; one that nothing else holds is held where it begins, if friction suffices.
    motion : Flight, Centrifuge or Hub, optional
        Without one the base is at rest, or accelerates as given.
    time : float
        s.
    acceleration : (3,), optional
        In place of a motion: acceleration of the root, or specific force, base axes, m/s².
    name : str
        For the result.
    progress : callable or bool, optional
        Called with what is being done and the fraction of it done; True shows a bar.

    Returns
    -------
    Deflection or SystemRest

    Raises
    ------
    InputError
        If both a motion and an acceleration are given.
    ComputationError
        ``not converged``: the beam buckles or diverges before the whole load is on.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    >>> structure = gb.assemble(beam, "FOAM", axial=1, y=2, z=2)
    >>> rest = gb.static(structure, acceleration=(0.0, 0.0, 78.5))
    >>> print(f"{1e3 * rest.tip[2]:.3f} mm")
    -2.297 mm
    """
    tell(progress, "equilibrium", 0.0)
    subject = subject_of(structure, motion)
    state = settled(
        subject.system, subject.drive(time) if acceleration is None else _pushed(motion, time, acceleration)
    )
    tell(progress, "loads, and errors by richer models", 0.5)
    return deflection(subject, state, name) if subject.body else system_rest(state, name)


def _pushed(motion: Motion | None, time: float, acceleration: Numbers) -> Drive:
    """Drives at a time, s, on ground that is accelerated, m/s²; InputError beside a motion."""
    if motion is not None:
        raise InputError("acceleration", "is given beside a motion", "give one of them")
    a = np.asarray(acceleration, dtype=float)
    if a.shape != (3,) or not np.isfinite(a).all():
        raise InputError("acceleration", f"is {acceleration!r}", "give three finite components, x, y and z, in m/s²")
    return Drive(None, time, base=Base(a, np.zeros(3), np.zeros(3)))


def deflection(subject: Subject, state: SteadySystem, name: str = "") -> Deflection:
    """Describe the deflection of one body in a steady state, with loads, errors and warnings."""
    structure, base, time, motion = subject.structure, subject.base(state), state.drive.time, subject.motion
    q = state.q[subject.columns(state)]
    over_time, still, times = each_leaf(lambda x: x[None], base), np.zeros((1, structure.size)), np.array([time])
    errors, doubts = deflection_errors(subject, state)
    undecided = {} if state.stable else not_known(state.bend, "its stiffness is not positive definite")
    names: dict[str, Any] = {"motion": name, "model": structure.kind}
    environment, recovery = "" if motion is None else motion.kind, structure.recovery
    parts: dict[str, Any] = (
        {} if recovery is None else recovery.parts(times, over_time, q[None], environment=environment, **names)
    )
    return Deflection(
        **names,
        time=time,
        base=base,
        stations=np.asarray(structure.stations),
        displacement=np.asarray(structure.displacement(q)),
        q=q,
        strain_energy=float(structure.strain_energy(q)),
        stable=None if undecided else state.stable,
        warnings=subject.warnings(state, name) + doubts,
        notes=notes_on({name: motion}),
        loads=section_forces(structure, over_time, q[None], still, still, times, motion=motion),
        errors=errors,
        **{key: parts[key] for key in ("solid", "surface", "specimen") if key in parts},
        **undecided,
    )
