"""Fatigue damage of a specimen in two runs, by the material where its stress is."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from gbeam.analysis.imitation.quantities import Quantities, sections_of
from gbeam.arrays.types import Floats
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


def fatigue(flight: Quantities, machine: Quantities, at: str | None = None) -> Fatigue | None:
    """Rainflow cycles of the stress in both runs at a named point, or where the stress ranges most in flight.

    None if either run has no stress there, or another material.
    """
    if at is None:
        candidates = places_of(flight.response)
        place = max(candidates, key=lambda name: np.ptp(candidates[name].stress), default="")
        in_flight, on_machine = candidates.get(place), places_of(machine.response).get(place)
    else:
        place, in_flight, on_machine = f"at {at}", cyclic_stress(flight, at), cyclic_stress(machine, at)
    if in_flight is None or on_machine is None:
        return None
    if not np.array_equal(in_flight.exponent, on_machine.exponent, equal_nan=True):
        return None
    if not (np.isfinite(in_flight.stress).all() and np.isfinite(on_machine.stress).all()):
        return None
    flown = stress_cycles(flight.response.time, in_flight.stress)
    spun = stress_cycles(machine.response.time, on_machine.stress)
    return Fatigue(in_flight.exponent, flown, spun, place)


def places_of(response: Response) -> dict[str, Cyclic]:
    """Stresses by their places in words: at the roots of beams, and where each material of a mesh is stressed most."""
    places, several = dict[str, Cyclic](), len(response.bodies) > 1
    for name, body in response.bodies.items():
        loads, solid = sections_of(body), body.solid
        if solid is not None:
            places |= _largest_stresses(solid, f"{name}'s " if several else "")
        elif loads is not None:
            places[f"of the root of {name}" if several else "of the root"] = _section_stress(loads, 0)
    return places


def cyclic_stress(run: Quantities, at: str) -> Cyclic | None:
    """Normal stress and exponent at a named point, or None if the point is neither on a beam nor on a mesh."""
    solid, loads, k = run.stressed("damage_at", at)
    if solid is not None:
        return Cyclic(solid.point_normal[:, k], float(solid.point_exponent[k]))
    return None if loads is None else _section_stress(loads, k)


def _section_stress(loads: Loads, section: int) -> Cyclic:
    """Stress on the fibre of a section where it ranges most."""
    assert loads.fibre is not None
    return Cyclic(loads.fibre[:, section], loads.fatigue_exponent)


def _largest_stresses(solid: SolidStress, owner: str) -> dict[str, Cyclic]:
    """Stress where each material of a mesh is stressed most, by the place in words,
    or empty where that is not known.
    """
    if not solid.known:
        return {}
    stresses = dict[str, Cyclic]()
    for name, stress, exponent in zip(solid.materials, solid.material_normal.T, solid.exponents, strict=True):
        noun = name if len(solid.materials) > 1 else "mesh" if owner else "it"
        stresses[f"where {owner}{noun} is stressed most"] = Cyclic(stress, float(exponent))
    return stresses


def stress_cycles(time: Floats, stress: Floats) -> StressCycles:
    """Rainflow cycles of a stress (t,) Pa at times (t,) s, the largest ranges first, with extremes between samples."""
    import rainflow

    rows = [row[:3] for row in rainflow.extract_cycles(turning_points(time, stress).tolist())]
    cycles = np.array(rows, dtype=float).reshape(-1, 3)
    cycles = cycles[cycles[:, 0] > _NOTHING * np.abs(stress).max()]
    return StressCycles(*cycles[np.argsort(-cycles[:, 0], kind="stable")].T)
