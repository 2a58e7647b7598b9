"""Static deflection: the relative equilibrium at a frozen base motion, along the beam."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, overload

import numpy as np

from gbeam.analysis.accuracy.beam_theory import largest
from gbeam.analysis.accuracy.correction import PLACE, Reading
from gbeam.analysis.accuracy.estimate import BEAM, LIMIT, cause_and_cure, not_known, of_bodies, percent, unjudged
from gbeam.analysis.accuracy.response_errors import BENT, Solution, errors_of
from gbeam.analysis.steady.equilibrium import keeps, solve_equilibrium
from gbeam.analysis.steady.operating_point import OperatingPoint, on_base, operating_point
from gbeam.analysis.system.linear import system_rest
from gbeam.analysis.system.steady import Drive, settled
from gbeam.arrays.tree import each_leaf
from gbeam.arrays.types import Floats, Numbers
from gbeam.errors import ComputationError, InputError
from gbeam.guards.arguments import typed
from gbeam.integrate.equations import Trajectory
from gbeam.mechanics.enrichment import enrichment
from gbeam.mechanics.models import TORSION
from gbeam.mechanics.plausibility import bend, bent_far, input_warnings
from gbeam.mechanics.section_forces import section_forces
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.theory import theory_of
from gbeam.mechanics.tree.system import System
from gbeam.motion.protocol import Motion, notes_on
from gbeam.progress import Progress, tell
from gbeam.results.equilibrium import Deflection
from gbeam.results.errors import Errors
from gbeam.results.parts import Base
from gbeam.results.system import SystemRest

LOST = "shapes and model are not judged: the exact model with more shapes comes to no equilibrium there"


def static_errors(point: OperatingPoint) -> tuple[Errors, tuple[str, ...]]:
    """Estimated errors of an equilibrium, over the displacement, root loads and stress, and warnings."""
    structure = point.structure
    if not structure.judged:
        return Errors(note=unjudged(structure)), ()
    loaded = None if structure.load_values is None else np.asarray(structure.load_values)[None]
    inputs = each_leaf(lambda x: np.asarray(x)[None], point.base), loaded
    solution, more = Solution(structure, _resting(point.q), inputs), enrichment(structure, point.base)
    directions = solution.along(more)
    exact = more.model("exact", directions=directions)[0]

    def rested(rich: Structure) -> Reading | None:
        """Reading of a structure with more shapes at its own equilibrium; None where there is none."""
        rich = replace(rich, load_values=structure.load_values)
        try:
            q = np.asarray(solve_equilibrium(rich, point.base).q)
        except (ComputationError, np.linalg.LinAlgError):
            return None
        return replace(solution, structure=rich, of=_resting(q)).read()

    computed, truth = solution.read(), rested(exact)
    if truth is None:
        return Errors(note=LOST), (LOST,)
    same = truth if structure.kind == exact.kind else rested(more.model(structure.kind, directions=directions)[0])
    unknown = {quantity: np.nan * values for quantity, values in truth.items()}
    sizes = {quantity: max(largest(values), largest(truth[quantity])) for quantity, values in computed.items()}
    beyond = solution.theory(straight=sizes[PLACE] <= BENT * structure.length)
    same, steps = same or unknown, dict.fromkeys(computed, 0.0)
    mesh = None if structure.coarser is None else (rested(structure.coarser) or unknown, computed)
    causes, bodies = beyond.causes.get(BEAM, {}), beyond.bodies.get(BEAM, np.zeros(0))
    errors = errors_of(structure, (computed, same), (same, truth), beyond, steps, sizes, mesh)
    return errors, (
        *_doubtful(errors),
        *of_bodies(structure, "", causes, bodies, sizes[PLACE], LIMIT),
        *_sideways(point),
    )


def _sideways(point: OperatingPoint) -> tuple[str, ...]:
    """Warn of an equilibrium that a beam with torsion would not keep: a strip on edge buckles sideways."""
    drive = point.base, point.loads
    if (
        point.structure.source is None
        or not keeps(point.about, *drive)
        or keeps(theory_of(point.structure).thick.coefficients, *drive)
    ):
        return ()
    return (f"a beam that twists would not stay there, but buckle sideways: {TORSION}",)


def _doubtful(errors: Errors) -> tuple[str, ...]:
    """Warn of an equilibrium that is wrong by more than one in a hundred."""
    if not (above := errors.above(LIMIT)):
        return ()
    worst = max(above.values(), key=lambda error: error.total)
    cause, cure = cause_and_cure(worst, errors.causes)
    sizes = ", ".join(f"the {name} by {percent(error.total)}" for name, error in above.items())
    return (f"estimated to be wrong: {sizes}, mostly from {cause}; {cure}",)


def _resting(q: Floats) -> Trajectory:
    """Trajectory of one time, at rest at coordinates (n,)."""
    return Trajectory(np.zeros(1), q[None], *np.zeros((2, 1, len(q))))


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
    if isinstance(structure, System):
        if acceleration is not None:
            raise InputError("acceleration", "is given of a system", "give it gravity, which is its opposite")
        state = settled(structure, Drive(motion, time))
        tell(progress, "loads, and errors by richer models", 0.5)
        return system_rest(state, name)
    if acceleration is None:
        point = operating_point(structure, motion, time)
    elif motion is not None:
        raise InputError("acceleration", "is given beside a motion", "give one of them")
    else:
        a = np.asarray(acceleration, dtype=float)
        if a.shape != (3,) or not np.isfinite(a).all():
            raise InputError(
                "acceleration", f"is {acceleration!r}", "give three finite components, x, y and z, in m/s²"
            )
        point = on_base(structure.at_time(time), Base(a, np.zeros(3), np.zeros(3)))
    tell(progress, "loads, and errors by richer models", 0.5)
    return deflection_at(structure, point, motion, time, name)


def deflection_at(
    structure: Structure, point: OperatingPoint, motion: Motion | None, time: float, name: str = ""
) -> Deflection:
    """Describe the deflection at an operating point, with loads, errors and warnings."""
    base, q = each_leaf(np.asarray, (point.base, point.q))
    over_time = each_leaf(lambda x: x[None], base)
    still = np.zeros((1, structure.size))
    displacement = np.asarray(structure.displacement(q))
    loads = section_forces(structure, over_time, q[None], still, still, np.array([time]), motion=motion)
    errors, doubts = static_errors(point)
    warnings = input_warnings(structure, motion, name=name, span=(time, time), base=base) + doubts
    warnings += tuple(bent_far(structure, bend(structure, q)))
    names = {"motion": name, "model": structure.kind, "environment": "" if motion is None else motion.kind}
    recovery, times = structure.recovery, np.array([time])
    stable: bool | None = keeps(point.about, point.base, point.loads)
    undecided = {} if stable else not_known(point.bend, "its stiffness is not positive definite")
    parts: dict[str, Any] = {} if recovery is None else recovery.parts(times, over_time, q[None], **names)
    return Deflection(
        motion=name,
        model=structure.kind,
        time=time,
        base=base,
        stations=np.asarray(structure.stations),
        displacement=displacement,
        q=q,
        strain_energy=float(structure.strain_energy(q)),
        stable=None if undecided else stable,
        warnings=warnings,
        notes=notes_on({name: motion}),
        loads=loads,
        errors=errors,
        **{key: parts[key] for key in ("solid", "surface", "specimen") if key in parts},
        **undecided,
    )
