"""Static deflection: the relative equilibrium at a frozen base motion, along the beam."""

from __future__ import annotations

import numpy as np
import scipy.linalg

from gbeam.analysis.equilibrium.operating_point import OperatingPoint, linear_matrices, operating_point
from gbeam.analysis.response.problem import history_of
from gbeam.analysis.response.section_forces import about_the_hub, section_loads
from gbeam.analysis.study.case import Motion
from gbeam.analysis.vibration.modal import frozen
from gbeam.mechanics.assembly import Structure
from gbeam.results.modal import Deflection
from gbeam.results.section_forces import Loads
from gbeam.structure.beam import Beam


def lowest_stiffness_at(mass: np.ndarray, stiffness: np.ndarray) -> tuple[float, np.ndarray]:
    """Lowest eigenvalue of the symmetric part of K in the measure of M, rad²/s², and its mode (n,)."""
    value, mode = scipy.linalg.eigh((stiffness + stiffness.T) / 2, (mass + mass.T) / 2, subset_by_index=(0, 0))
    return float(value[0]), mode[:, 0]


def beam_block(point: OperatingPoint) -> tuple[np.ndarray, np.ndarray]:
    """M and K of the beam's own coordinates about an operating point."""
    linear, i = linear_matrices(point), point.first
    return linear.mass[i:, i:], linear.stiffness[i:, i:]


def static(
    structure: Structure, motion: Motion, time: float, *, name: str = "", beam: Beam | None = None
) -> Deflection:
    """Where the beam rests relative to a base whose motion is frozen at a time.

    Parameters
    ----------
    structure : Structure
        From :func:`gbeam.assemble`; the shape is told at its stations.
    motion : Flight, Centrifuge, HubRate or HubTorque
    time : float
        s.
    name : str
        For the result.
    beam : Beam, optional
        The one that the structure was assembled from: with it the loads along the beam are told.

    Returns
    -------
    Deflection

    Raises
    ------
    ComputationError
        ``not converged``: the beam buckles or diverges before the whole load is on.
    """
    point = operating_point(structure, motion, time)
    lowest, _ = lowest_stiffness_at(*beam_block(point))
    return Deflection(
        motion=name,
        model=structure.kind,
        time=time,
        base=frozen(point.base),
        stations=np.asarray(structure.stations),
        displacement=np.asarray(structure.displacement(point.q)),
        q=np.asarray(point.q),
        strain_energy=float(structure.system.energy.potential(point.q)),
        stable=lowest > 0,
        loads=None if beam is None else _carried(structure, beam, motion, point, time),
    )


def _carried(structure: Structure, beam: Beam, motion: Motion, point: OperatingPoint, time: float) -> Loads:
    """Loads along the beam at rest, and about the hub's axis if there is one."""
    base = history_of(point.base)
    q = np.asarray(point.q)[None]
    loads = section_loads(structure, beam, base, q, 0 * q, 0 * q, np.array([time]))
    return about_the_hub(loads, motion, base.alpha_WB_B)
