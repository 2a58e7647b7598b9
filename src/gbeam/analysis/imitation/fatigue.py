"""Fatigue damage of a specimen in two runs, by the material where its stress is."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from gbeam.arrays.types import Floats
from gbeam.guards.checks import index_of
from gbeam.mechanics.tree.system import ROOT
from gbeam.numerics.peaks import turning_points
from gbeam.results.measures import Fatigue, StressCycles
from gbeam.results.parts import Loads
from gbeam.results.response import Response
from gbeam.results.solids import SolidStress

_NOTHING = 1e-9  # of the largest stress: a smaller cycle is rounding


class Cyclic(NamedTuple):
    """Normal stress (t,) on the fibre or plane where it ranges most, Pa, and the exponent of the material."""

    stress: Floats
    exponent: float


def fatigue(
    flight: Response, machine: Response, at: str | None = None
) -> Fatigue | None:
    """Rainflow cycles of the stress in both runs at a named point, or where the stress ranges most in flight; None if
    either run has no stress there, or another material.
    """
    if at is None:
        candidates = places_of(flight)
        place = max(candidates, key=lambda name: np.ptp(candidates[name].stress), default="")
        in_flight, on_machine = candidates.get(place), places_of(machine).get(place)
    else:
        place, in_flight, on_machine = f"at {at}", cyclic_at(flight, at), cyclic_at(machine, at)
    if in_flight is None or on_machine is None:
        return None
    if not np.array_equal(in_flight.exponent, on_machine.exponent, equal_nan=True):
        return None
    if not (np.isfinite(in_flight.stress).all() and np.isfinite(on_machine.stress).all()):
        return None
    cycles = stress_cycles(flight.time, in_flight.stress), stress_cycles(machine.time, on_machine.stress)
    return Fatigue(in_flight.exponent, *cycles, place)


def places_of(response: Response) -> dict[str, Cyclic]:
    """Stresses at the roots of beams, and where each material of a mesh is stressed most, by the place in words."""
    if isinstance(response, SystemResponse):
        roots = ((f"of the root of {body}", _of_section(beam.loads, 0)) for body, beam in response.beams.items())
        meshes = (_worst(solid, f"{body}'s ") for body, solid in response.solids.items())
        return {place: cyclic for place, cyclic in roots if cyclic is not None} | {
            place: cyclic for mesh in meshes for place, cyclic in mesh.items()
        }
    if response.solid is not None:
        return _worst(response.solid)
    root = None if response.loads is None else _of_section(response.loads, 0)
    return {} if root is None else {"of the root": root}


def cyclic_at(response: Response, at: str) -> Cyclic | None:
    """Normal stress and exponent at a named point; None if the point is of no beam or mesh."""
    solid, loads, k = stressed_at("damage_at", response, at)
    if solid is not None:
        return Cyclic(solid.point_normal[:, k], float(solid.point_exponent[k]))
    return None if loads is None else _of_section(loads, k)


def stress_at_point(response: Response, at: str) -> Floats | None:
    """Stress (t,) Pa at a named point, von Mises of a mesh, normal of a beam; None if the point is of neither."""
    solid, loads, k = stressed_at("stress_at", response, at)
    if solid is not None:
        return solid.point_von_mises[:, k]
    return None if loads is None else np.maximum(loads.stress_tension[:, k], -loads.stress_compression[:, k])


def stressed_at(
    where: str, response: Response, at: str
) -> tuple[SolidStress | None, Loads | None, int]:
    """The mesh, or the loads of the beam, that a named point belongs to, else None, and its number there; InputError,
    at the keyword `where`, if there is no such point.
    """
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
    """Stress on the fibre of a section where it ranges most; None if not known."""
    return None if loads.fibre is None else Cyclic(loads.fibre[:, section], loads.fatigue_exponent)


def _worst(solid: SolidStress, of: str = "") -> dict[str, Cyclic]:
    """Stress where each material of a mesh is stressed most, by the place in words; empty where that is not known."""
    several = len(solid.materials) > 1
    if not solid.known:
        return {}
    return {
        f"where {of}{name if several else 'mesh' if of else 'it'} is stressed most": Cyclic(stress, float(exponent))
        for name, stress, exponent in zip(solid.materials, solid.material_normal.T, solid.exponents, strict=True)
    }


def stress_cycles(time: Floats, stress: Floats) -> StressCycles:
    """Rainflow cycles of a stress (t,) Pa at times (t,) s, by its extremes between samples, largest ranges first."""
    import rainflow

    rows = [row[:3] for row in rainflow.extract_cycles(turning_points(time, stress).tolist())]
    cycles = np.array(rows, dtype=float).reshape(-1, 3)
    cycles = cycles[cycles[:, 0] > _NOTHING * np.abs(stress).max()]
    return StressCycles(*cycles[np.argsort(-cycles[:, 0], kind="stable")].T)
