"""Relative equilibrium of a system at a frozen motion of its ground."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from operator import itemgetter
from typing import Any

import numpy as np

from gbeam.analysis.accuracy.correction import DEFLECTION, LOADS, PLACE, Quantity
from gbeam.analysis.accuracy.estimate import LIMIT, not_known
from gbeam.analysis.outline import assembly_of, box_of, outline_of, supports_of
from gbeam.analysis.steady.subject import Subject, subject_of
from gbeam.analysis.system.accuracy import FAR, doubts, system_errors
from gbeam.analysis.system.drive import Drive
from gbeam.analysis.system.histories import ROUNDING, carried, histories, loads_of
from gbeam.analysis.system.rest import settled, steady_solution, transfer
from gbeam.analysis.system.richer import theories_of, with_beams
from gbeam.analysis.system.steady import SteadySystem
from gbeam.arrays.tree import each_leaf
from gbeam.arrays.types import Floats, Numbers
from gbeam.errors import ComputationError, InputError
from gbeam.guards.arguments import typed
from gbeam.guards.quantities import AccelerationVector, Seconds
from gbeam.mechanics.causes import causes_of, loads_at
from gbeam.mechanics.models import TORSION
from gbeam.mechanics.section_forces import add_hub_torques
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.signals import units_of
from gbeam.mechanics.tree.system import System
from gbeam.motion.protocol import Motion, notes_on
from gbeam.progress import Progress, tell
from gbeam.results.equilibrium import BodyRest, Rest
from gbeam.results.errors import Errors
from gbeam.results.parts import Base

LOST = "shapes and model are not judged: the exact model with more shapes comes to no equilibrium there"


def stepless(system: System) -> dict[Quantity, float]:
    """Errors of the time steps for a state of rest, which takes none: zero for every quantity."""
    kinds = (DEFLECTION, *LOADS, "sheared")
    return {PLACE: 0.0} | {(name, kind): 0.0 for name in system.flexible for kind in kinds}


def rest_errors(state: SteadySystem, start: Floats, *, stable: bool) -> tuple[Errors, tuple[str, ...]]:
    """Estimated errors of an equilibrium, stable or not, whose points (p, 3) begin at a `start`, and warnings."""
    system, solution = state.system, steady_solution(state, state.system)
    errors, off_axis = system_errors(
        lambda _: solution, partial(steady_solution, state), stepless(system), start=start, tolerance=LIMIT
    )
    errors = replace(errors, note=LOST) if FAR in errors.note else errors
    sideways = _sideways(state) if stable and errors.note != LOST else ()
    return errors, (*doubts(errors, LIMIT), *off_axis, *sideways)


def _sideways(state: SteadySystem) -> tuple[str, ...]:
    """Warn of an equilibrium that a beam with torsion would not keep, as a strip on edge that buckles sideways."""
    theories = theories_of(state.system)
    if not theories:
        return ()
    thick = with_beams(state.system, {name: theory.thick for name, theory in theories.items()})
    try:
        if transfer(state, thick).stable:
            return ()
    except (ComputationError, np.linalg.LinAlgError):
        pass
    return (f"a beam that twists would not stay there, but buckle sideways: {TORSION}",)


@typed
def static(
    structure: Structure | System,
    motion: Motion | None = None,
    time: Seconds = 0.0,
    *,
    acceleration: AccelerationVector | None = None,
    name: str = "",
    progress: Progress = None,
) -> Rest:
    """Equilibrium relative to a base whose motion is frozen at a time, and what bodies and ground carry.

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
    Rest

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
    return rest_of(subject, state, name)


def _pushed(motion: Motion | None, time: float, acceleration: Numbers) -> Drive:
    """Drives at a time, s, on ground with an acceleration, m/s²; InputError if there is a motion, too."""
    if motion is not None:
        raise InputError("acceleration", "is given beside a motion", "give one of them")
    a = np.asarray(acceleration, dtype=float)
    if a.shape != (3,) or not np.isfinite(a).all():
        raise InputError("acceleration", f"is {acceleration!r}", "give three finite components, x, y and z, in m/s²")
    return Drive(None, time, base=Base(a, np.zeros(3), np.zeros(3)))


def rest_of(subject: Subject, state: SteadySystem, name: str = "") -> Rest:
    """Describe a system at rest in a steady state: places, efforts and loads, with errors and warnings."""
    system, point, solution = state.system, state.point, steady_solution(state, state.system)
    inputs = solution.inputs(system, None)

    def values_at(y: Floats) -> dict[str, Any]:
        """Values by key at coordinates y (n,), with the rates and accelerations of the state."""
        by_key, _ = histories(system, y[None], point.yd[None], point.ydd[None], inputs, inertial=False)
        return {key: history[0] for key, history in by_key.items()}

    begun, values = values_at(system.start[0][system.tree.unknowns]), values_at(point.y)
    # Forces on the ground that are rounding beside the inertia of accelerated bodies are none.
    motions = point.tree.motion(point.y, point.yd, point.ydd, point.inputs)
    links = zip(point.tree.links, motions.q, motions.roots, strict=False)  # those that close loops have no body
    inertia = sum(float(link.body.mass_moment(q[-1])[0] * np.linalg.norm(root.a)) for link, q, root in links)
    for key, size in ("ground_force", inertia), ("ground_moment", inertia * np.abs(values["place"]).max(initial=0.0)):
        values[key] = np.where(np.abs(values[key]) > ROUNDING * size, values[key], 0.0)
    stable, unstable, undecided = _stability(state)
    errors, doubted = rest_errors(state, begun["place"], stable=bool(stable))
    return Rest(
        motion=name,
        time=state.drive.time,
        base=state.base,
        points=system.points,
        coordinates=system.coordinates,
        units=units_of(system),
        point_displacement=values["place"] - begun["place"],
        errors=errors,
        accelerated=state.accelerated,
        stable=stable,
        warnings=(*unstable, *doubted, *subject.warnings(state, name, resting=True)),
        notes=notes_on({name: subject.motion}),
        assembly=assembly_of(system),
        bodies=_bodies_at_rest(subject, state, name),
        **{key: values[key] for key in ("place", "attitude", "q", "effort", "ground_force", "ground_moment")},
        **undecided,
    )


def _bodies_at_rest(subject: Subject, state: SteadySystem, name: str) -> dict[str, BodyRest]:
    """Describe the bodies that deform, and rigid specimens, in a steady state by their names."""
    system, point, time = state.system, state.point, np.array([state.drive.time])
    inputs = steady_solution(state, system).inputs(system, None)
    motions = system.tree.motion(point.y[None], point.yd[None], point.ydd[None], inputs)
    acting = system.tree.demanded(motions, inputs)[2]
    environment = "rest" if subject.motion is None else subject.motion.kind
    bodies = {}
    for body, structure in system.flexible.items():
        state_of = carried(system, motions, body, acting)
        base, q = state_of.base, np.asarray(state_of.q)
        loads = loads_of(structure, state_of, time)
        if body == subject.body:
            loads = add_hub_torques(loads, subject.motion, base.alpha_WB_B)
        names = {"motion": name, "model": structure.kind, "environment": environment}
        recovery = structure.recovery
        causes = causes_of(structure, q, loads_at(structure, time))
        parts: dict[str, Any] = {**box_of(structure, time, q)}
        if recovery is not None:
            parts |= recovery.parts(time, base, causes, **names)
        outline = outline_of(structure, None, time, q)
        bodies[body] = BodyRest(
            model=structure.kind,
            base=each_leaf(itemgetter(0), base),
            stations=np.asarray(structure.stations),
            displacement=np.asarray(structure.displacement(q[0])),
            q=q[0],
            strain_energy=float(structure.strain_energy(q[0])),
            loads=loads,
            outline=outline,
            supports=supports_of(structure, outline, time, q),
            **{key: parts[key] for key in ("solid", "surface", "specimen") if key in parts},
        )
    return bodies


def _stability(state: SteadySystem) -> tuple[bool | None, tuple[str, ...], dict[str, Any]]:
    """Stability of a steady state, or None if unknown; a warning if it is lost; and why it is unknown."""
    try:
        growing = state.moving.growing
    except ComputationError as error:
        return False, (f"whether it would stay there is not known, {error}",), {}
    if len(growing):
        lost = f"what deviates grows by {growing[0].real:.4g} per second"
    elif state.stable or not _coupled_alone(state):
        return True, (), {}
    else:
        lost = "its stiffness is not positive definite, and any damping would spoil what gyroscopic coupling holds"
    undecided = not_known(state.bend, lost)
    if undecided:
        return None, (), undecided
    return False, (f"unstable, it would not stay there: {lost}",), {}


def _coupled_alone(state: SteadySystem) -> bool:
    """True if gyroscopic coupling, but no damping, acts on small departures."""
    velocity = state.linear.velocity
    damping = np.abs(velocity + velocity.T).max(initial=0.0)
    coupling = np.abs(velocity - velocity.T).max(initial=0.0)
    return bool(coupling > 0 and damping <= ROUNDING * coupling)
