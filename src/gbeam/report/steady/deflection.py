"""Where the beam rests, and what its sections carry."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import numpy as np

from gbeam.report.words import error_words, percent, stress_words, tidy, warning_lines, xyz, xyz_lists
from gbeam.results.declared import json_of
from gbeam.results.equilibrium import Deflection
from gbeam.results.errors import Errors
from gbeam.results.parts import Loads


def to_json(title: str, deflections: Iterable[Deflection]) -> dict[str, Any]:
    """Deflections by motion as JSON; m, J, N, N m, Pa."""
    return {"title": title, "outcome": "done", "motions": {each.motion: _deflection(each) for each in deflections}}


def _deflection(deflection: Deflection) -> dict[str, Any]:
    values = json_of(deflection)
    return values if deflection.loads is None else values | {"loads": loads_json(deflection.loads)}


def loads_json(loads: Loads) -> dict[str, Any]:
    """Loads of one time as JSON: of the base on the root, base axes; along the beam, section axes."""
    values: dict[str, Any] = {
        "root_force": xyz(loads.root_force[0]),
        "root_moment": xyz(loads.root_moment[0]),
        "stations": loads.stations.tolist(),
        "section_force": xyz_lists(loads.section_force[0]),
        "section_moment": xyz_lists(loads.section_moment[0]),
        **{name: getattr(loads, name)[0].tolist() for name in ("stress", "stress_tension", "stress_compression")},
    }
    if loads.margin is not None:
        values |= {"yield_strength": loads.yield_strength, "margin": loads.margin[0].tolist()}
    if loads.beam_torque is not None:
        values["beam_torque"] = float(loads.beam_torque[0])
    return values


def text(deflections: Iterable[Deflection]) -> str:
    """Deflections on two lines each."""
    return "\n".join(map(_lines, deflections))


def _lines(deflection: Deflection) -> str:
    x, y, z = tidy(1e3 * deflection.tip, 1e3 * float(np.abs(deflection.displacement).max()))
    warning = "" if deflection.stable else "; UNSTABLE: no beam would stay there"
    tip = f"tip x {x:.6g} mm, y {y:.6g} mm, z {z:.6g} mm"
    first = f"{deflection.motion} at {deflection.time:.4g} s: {tip} ({deflection.model}){warning}"
    loads = [] if deflection.loads is None else [f"  {_loads(deflection.loads)}"]
    return "\n".join([first, *loads, f"  {_errors(deflection.errors)}", *warning_lines(deflection)])


def _errors(errors: Errors) -> str:
    if not math.isfinite(errors.displacement.total):
        return f"no error estimate: {errors.note}" if errors.note else "no error estimate"
    tip, loads = error_words(errors.displacement), percent(errors.loads.total)
    return f"estimated error {tip} of the tip's displacement, {loads} of the root loads"


def _loads(loads: Loads) -> str:
    largest = float(np.abs(loads.force).max())
    lever = max(float(np.abs(loads.moment).max()), largest * float(loads.stations[-1]))
    force, moment = (
        ", ".join(f"{value:.5g}" for value in tidy(vector[0], size))
        for vector, size in ((loads.root_force, largest), (loads.root_moment, lever))
    )
    words = f"base on root: force ({force}) N, moment ({moment}) N m"
    if np.isfinite(loads.stress).all():
        extremes = loads.stress_tension[0], loads.stress_compression[0]
        words += f"; {stress_words(loads.stations, *extremes, loads.yield_strength)}"
    if loads.beam_torque is not None:
        words += f"; torque for the beam {tidy(loads.beam_torque, lever)[0]:.5g} N m"
    return words
