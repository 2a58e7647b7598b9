"""Equilibria under growing loads, followed by arc length where the loads have to fall: snap-through."""

from __future__ import annotations

from typing import Literal

import numpy as np

from gbeam.analysis.steady.path_errors import judged
from gbeam.analysis.steady.subject import subject_of
from gbeam.analysis.system.drive import any_load, loaded, shaken
from gbeam.analysis.system.load_path import Loading, follow
from gbeam.analysis.system.richer import judged_bodies, left_unjudged
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import positive
from gbeam.guards.quantities import Seconds
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.system import System
from gbeam.motion.protocol import Motion, notes_on
from gbeam.numerics.continuation import CurvePoint
from gbeam.progress import Progress, tell
from gbeam.results.equilibrium import CriticalPoint, EquilibriumPath
from gbeam.results.errors import ErrorEstimate

STILL = 1e-9  # m/s², rad/s or rad/s²: less is a profile's rounding


@typed
def equilibrium_path(
    structure: Structure | System,
    motion: Motion | None = None,
    time: Seconds = 0.0,
    *,
    vary: Literal["loads", "motion"] = "loads",
    upper: float = 1.0,
    errors: bool = True,
    name: str = "",
    progress: Progress = None,
) -> EquilibriumPath:
    """Equilibria under loads times a factor that grows from none, followed where it has to fall: snap-through.

    The path is followed by arc length beyond limit points, at which a structure snaps under dead loads, and past branch
    points, at which it buckles, along the branch on which it came. It ends where the factor reaches `upper`, or falls
    to -`upper`.

    Parameters
    ----------
    structure : Structure or System
    motion : Flight, Centrifuge or Hub, optional
        Of the ground, frozen; at rest without one.
    time : float
        When loads, drives and motion are frozen, s.
    vary : str
        What is multiplied by the factor: all loads on beams and points, or the motion's accelerations, and its rates by
        the root of the factor. What is not, gravity and drives of joints among it, stays as it is.
    upper : float
        Factor at which the path ends.
    errors : bool
        Whether to estimate errors by richer models, whose paths are followed too.
    name : str
        Of the motion.
    progress : callable or bool, optional
        Called with what is done and the share of it; True shows a bar.

    Returns
    -------
    EquilibriumPath

    Raises
    ------
    InputError
        If there is nothing to vary: no load acts at the time, or there is no motion.
    ComputationError
        ``no equilibrium``: without loads there is none.

    Examples
    --------
    Two bars of a shallow frame, pinned at their feet, snap under a force at the apex.

    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> frame = gb.Line.of_points([[0, 0, 0], [0.3, 0, 0.005], [0.6, 0, 0]], smooth=False)
    >>> apex = gb.Point("apex", at=frame.length / 2)
    >>> push = gb.Load(at="apex", force=(0.0, 0.0, -10.0))
    >>> pin = gb.Support(0.0, ["x", "y", "z", "rx", "rz"])
    >>> foot = gb.Support("tip", ["x", "z"])
    >>> metal = gb.Material(2700, 70e9, poissons_ratio=0.33)
    >>> parts = {"line": frame, "supports": [pin, foot], "loads": [push], "points": [apex]}
    >>> beam = gb.Beam(frame.length, strip, metal, **parts)
    >>> path = gb.equilibrium_path(gb.assemble(beam, "FOAM", axial=2, z=6), upper=5.0)
    >>> print(path.critical[0])
    limit point at a factor of 1.104, estimated error 0.013 %
    """
    positive("upper", upper, "times the loads")
    subject = subject_of(structure, motion)
    subject.require_coordinates()
    system, drive = subject.system, subject.resting_drive(time)
    if vary == "motion":
        if subject.ground is None:
            raise InputError("motion", "is missing, whose accelerations are varied", "give a flight or a centrifuge")
        frozen = subject.ground.base(np.asarray(time))
        if max(np.abs(vector).max() for vector in (frozen.a_WO_B, frozen.w_WB_B, frozen.alpha_WB_B)) < STILL:
            raise InputError(
                "motion", f"does nothing at {time:g} s", "give a time at which it accelerates, such as 1 s"
            )
        loading = Loading.of(system, drive, shaken)
    else:
        if not any_load(drive.inputs(system)):
            fix = "add one, give a time at which one acts, or vary the motion"
            raise InputError("beam.loads" if subject.body else "forces", "has no load that acts", fix)
        loading = Loading.of(system, drive, loaded)

    def report(at: CurvePoint) -> None:
        tell(progress, f"equilibria, {at.value:.4g} times the {vary}", min(abs(at.value) / upper, 1.0) / 2)

    followed = follow(loading, upper, lambda at: 1 - abs(at.value) / upper, report)
    along, shares, doubts = ErrorEstimate(), [ErrorEstimate() for _ in followed.critical], tuple[str, ...]()
    if errors and judged_bodies(system):
        along, shares, doubts = judged(followed, upper, progress)
    return EquilibriumPath(
        motion=name,
        time=drive.time,
        model=subject.kind,
        quantity=vary,
        searched_to=upper,
        points=system.points,
        factor=np.array([at.value for at in followed.points]),
        displacement=followed.moved,
        q=np.stack([at.y for at in followed.points]),
        stable=np.array(followed.stable),
        critical=tuple(
            CriticalPoint(kind, followed.points[k].value, followed.moved[k], share)
            for (kind, k), share in zip(followed.critical, shares, strict=True)
        ),
        errors=along,
        error_note=left_unjudged(system),
        warnings=(*subject.warnings(loading.start, name, resting=True), *doubts),
        notes=notes_on({name: motion}),
        outcome="not converged" if followed.ended else "done",
        message=followed.ended,
    )
