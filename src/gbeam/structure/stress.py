"""Normal stress and strain over a section under axial force and bending moments."""

from __future__ import annotations

from typing import Any

import numpy as np

from gbeam.arrays.namespace import namespace
from gbeam.structure.beam import Beam
from gbeam.structure.section import SectionValues

Array = Any
_ROUND = 24  # directions of fibres of a round section; the worst lies within 7.5°: 0.9 % of its bending stress


def extreme_stresses(values: SectionValues, force: Array, moment: Array) -> tuple[Array, Array]:
    """Largest and smallest normal stress (..., s) Pa, N/A ± (|M_y| c_z/I_y + |M_z| c_y/I_z), or N/A ± √(M_y² + M_z²)
    c/I of round sections, from force N and moment N m (..., s, 3) in section axes; NaN where extreme fibres are
    unknown.
    """
    xp = namespace(force, moment, values.area)
    along_z = moment[..., 1] * values.extreme_fibre_z / values.inertia_y
    along_y = moment[..., 2] * values.extreme_fibre_y / values.inertia_z
    if values.round:
        square = along_z**2 + along_y**2
        bent = square > 0  # the root's derivative at zero is none that could be passed on
        bending = xp.where(bent, xp.sqrt(xp.where(bent, square, 1.0)), square)
    else:
        bending = xp.abs(along_z) + xp.abs(along_y)
    mean = force[..., 0] / values.area
    return mean + bending, mean - bending


def fibre_stress(values: SectionValues, force: Array, moment: Array, y: Array, z: Array) -> Array:
    """Normal stress N/A + M_y z/I_y − M_z y/I_z at places (y, z) m in sections (s,), (..., s) Pa."""
    along_z, along_y = moment[..., 1] * z / values.inertia_y, moment[..., 2] * y / values.inertia_z
    return force[..., 0] / values.area + along_z - along_y


def fibre_strain(beam: Beam, at: Array, force: Array, moment: Array, y: Array, z: Array) -> Array:
    """Normal strain, (..., s), at places (y, z) m in a beam's sections `at` (s,) m, by what these carry."""
    axial, along_z, along_y = beam.rigidities(at)
    return force[..., 0] / axial + moment[..., 1] * z / along_z - moment[..., 2] * y / along_y


def worst_fibre(values: SectionValues, section: int, force: Array, moment: Array) -> Array:
    """Normal stress (t,) Pa, N/A + M_y z/I_y − M_z y/I_z, at that corner of a section, or that of 24 points around a
    round one, where it ranges most; force and moment (t, s, 3).
    """
    here = values[section]
    points = [(1, 1), (1, -1), (-1, 1), (-1, -1)]
    if values.round:
        points = [(np.cos(a), np.sin(a)) for a in 2 * np.pi * np.arange(_ROUND) / _ROUND]
    fibres = [(y * here.extreme_fibre_y, z * here.extreme_fibre_z) for y, z in points]
    return max((fibre_stress(here, force[:, section], moment[:, section], y, z) for y, z in fibres), key=np.ptp)
