"""Static deflection: the relative equilibrium at a frozen base motion, along the beam."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from gbeam.analysis.equilibrium.equilibrium import keeps
from gbeam.analysis.equilibrium.errors import static_errors
from gbeam.analysis.equilibrium.operating_point import operating_point
from gbeam.analysis.equilibrium.point import OperatingPoint, on_base
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.mechanics.plausibility import input_warnings
from gbeam.mechanics.section_forces import section_forces
from gbeam.mechanics.structure import Structure
from gbeam.motion.bases.base import Base
from gbeam.motion.protocol import Motion
from gbeam.results.equilibrium import Deflection
from gbeam.results.response import BaseMotion


@typed
def static(
    structure: Structure,
    motion: Motion | None = None,
    time: float = 0.0,
    *,
    acceleration: Sequence[float] | None = None,
    name: str = "",
) -> Deflection:
    """Where the beam rests relative to a base whose motion is frozen at a time, and what its sections carry.

    Parameters
    ----------
    structure : Structure
        From :func:`gbeam.assemble`; shape and loads are given at its stations.
    motion : Flight, Centrifuge or Hub, optional
        Without one the base is at rest, or accelerates as given.
    time : float
        s.
    acceleration : (3,), optional
        In place of a motion: acceleration of the root, or specific force, base axes, m/s².
    name : str
        For the result.

    Returns
    -------
    Deflection

    Raises
    ------
    InputError
        If both a motion and an acceleration are given.
    ComputationError
        ``not converged``: the beam buckles or diverges before the whole load is on.
    """
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
    return deflection_at(structure, point, motion, time, name)


def deflection_at(
    structure: Structure, point: OperatingPoint, motion: Motion | None, time: float, name: str = ""
) -> Deflection:
    """The deflection at an operating point."""
    base, q = point.frozen, np.asarray(point.q)
    over_time = BaseMotion(*(x[None] for x in (base.a_WO_B, base.w_WB_B, base.alpha_WB_B)))
    still = np.zeros((1, structure.size))
    displacement = np.asarray(structure.displacement(q))
    loads = section_forces(structure, over_time, q[None], still, still, np.array([time]), motion=motion)
    errors, doubts = static_errors(point, displacement, loads)
    warnings = input_warnings(structure, motion, name=name, span=(time, time), base=base) + doubts
    return Deflection(
        motion=name,
        model=structure.kind,
        time=time,
        base=base,
        stations=np.asarray(structure.stations),
        displacement=displacement,
        q=q,
        strain_energy=float(structure.strain_energy(q)),
        stable=keeps(point.about, point.base, point.residual.unpack(point.u)[1]),
        warnings=warnings,
        loads=loads,
        errors=errors,
    )
