"""Static deflections and the loads of sections in words."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from gbeam.report.words import error_words, percent, stress_words, tidy, warning_lines
from gbeam.results.equilibrium import Deflection
from gbeam.results.errors import Errors
from gbeam.results.parts import Loads


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
