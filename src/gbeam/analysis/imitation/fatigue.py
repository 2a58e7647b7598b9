"""Fatigue damage of a specimen in two runs, by the material where its stress is."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from gbeam.analysis.response.peaks import turning_points
from gbeam.arrays.types import Floats
from gbeam.guards.checks import index_of
from gbeam.mechanics.tree.system import ROOT
from gbeam.results.measures import Fatigue, StressCycles
from gbeam.results.parts import Loads
from gbeam.results.response import Response
from gbeam.results.solids import SolidStress
from gbeam.results.system import SystemResponse

_NOTHING = 1e-9  # of the largest stress: a smaller cycle is rounding


class Cyclic(NamedTuple):
    """Normal stress (t,) on the fibre or plane where it ranges most, Pa, and the exponent of the material."""

    stress: Floats
    exponent: float


def fatigue(
    flight: Response | SystemResponse, machine: Response | SystemResponse, at: str | None = None
) -> Fatigue | None:
    """Rainflow cycles of the stress at a named point, or where :class:`Fatigue` says, in both runs; None where one has
    no stress there, or not that of the same material.
    """
    if at is None:
        every = places_of(flight)
        place = max(every, key=lambda name: np.ptp(every[name].stress), default="")
        one, two = every.get(place), places_of(machine).get(place)
    else:
        place, one, two = f"at {at}", cyclic_at(flight, at), cyclic_at(machine, at)
    if one is None or two is None or not np.array_equal(one.exponent, two.exponent, equal_nan=True):
        return None
    if not (np.isfinite(one.stress).all() and np.isfinite(two.stress).all()):
        return None
    cycles = stress_cycles(flight.time, one.stress), stress_cycles(machine.time, two.stress)
    return Fatigue(one.exponent, *cycles, place)


def places_of(response: Response | SystemResponse) -> dict[str, Cyclic]:
    """Stresses at the roots of beams, and where each material of a mesh is stressed most, by the place in words."""
    if isinstance(response, SystemResponse):
        roots = ((f"of the root of {body}", _of_section(each.loads, 0)) for body, each in response.beams.items())
        meshes = (_worst(each, f"{body}'s ") for body, each in response.solids.items())
        return {place: each for place, each in roots if each is not None} | {
            place: each for some in meshes for place, each in some.items()
        }
    if response.solid is not None:
        return _worst(response.solid)
    root = None if response.loads is None else _of_section(response.loads, 0)
    return {} if root is None else {"of the root": root}


def cyclic_at(response: Response | SystemResponse, at: str) -> Cyclic | None:
    """Stress at a named point; None where there is none."""
    solid, loads, k = stressed_at("damage_at", response, at)
    if solid is not None:
        return Cyclic(solid.point_normal[:, k], float(solid.point_exponent[k]))
    return None if loads is None else _of_section(loads, k)


def stress_at_point(response: Response | SystemResponse, at: str) -> Floats | None:
    """Von Mises stress of a mesh, or normal stress of a beam, at a named point (t,); None where there is none."""
    solid, loads, k = stressed_at("stress_at", response, at)
    if solid is not None:
        return solid.point_von_mises[:, k]
    return None if loads is None else np.maximum(loads.stress_tension[:, k], -loads.stress_compression[:, k])


def stressed_at(
    where: str, response: Response | SystemResponse, at: str
) -> tuple[SolidStress | None, Loads | None, int]:
    """Mesh or beam that has the stress at a named point, and the number of the point or section in it."""
    index_of(where, at, response.points)
    if isinstance(response, SystemResponse):
        body, _, point = at.partition(".")
        beam, solid = response.beams.get(body), response.solids.get(body)
        loads, names = (None, ()) if beam is None else (beam.loads, (ROOT, *beam.points))
    else:
        point, solid, loads, names = at, response.solid, response.loads, ("", *response.points)
    if solid is not None and point in solid.points:
        return solid, None, solid.points.index(point)
    return (None, loads, names.index(point)) if loads is not None and point in names else (None, None, 0)


def _of_section(loads: Loads, section: int) -> Cyclic | None:
    return None if loads.fibre is None else Cyclic(loads.fibre[:, section], loads.fatigue_exponent)


def _worst(solid: SolidStress, of: str = "") -> dict[str, Cyclic]:
    """Stress where each material of a mesh is stressed most."""
    several = len(solid.materials) > 1
    return {
        f"where {of}{name if several else 'mesh' if of else 'it'} is stressed most": Cyclic(stress, float(exponent))
        for name, stress, exponent in zip(solid.materials, solid.material_normal.T, solid.exponents, strict=True)
    }


def stress_cycles(time: Floats, stress: Floats) -> StressCycles:
    """Rainflow cycles of a stress over time (t,), s, Pa, with its extremes between samples."""
    import rainflow

    rows = [row[:3] for row in rainflow.extract_cycles(turning_points(time, stress).tolist())]
    cycles = np.array(rows, dtype=float).reshape(-1, 3)
    cycles = cycles[cycles[:, 0] > _NOTHING * np.abs(stress).max()]
    return StressCycles(*cycles[np.argsort(-cycles[:, 0], kind="stable")].T)
