"""Scene of the viewer, from the variables of a result's file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from gbeam.report.page.series import Numbers
from gbeam.report.words import number
from gbeam.results.modal import Modes
from gbeam.results.result import Floats

Variables = Mapping[str, Any]
SHOWN = 33  # points of a mode shape
WIDE, THICK = 0.03, 0.012  # of the length: of a beam whose section a result does not hold


def scene(motions: Mapping[str, str], variables: Variables, numbers: Numbers) -> dict[str, Any] | None:
    """Return the motions that have an outline, and the first one's time of largest deflection, if any."""
    shown = [
        motion(name, environment, variables, numbers)
        for name, environment in motions.items()
        if f"motions/{name}/outline" in variables
    ]
    if not shown:
        return None
    first = f"motions/{shown[0]['name']}"
    tip = (variables[f"{first}/outline"][:, -1] ** 2).sum(axis=-1)
    return {"motions": shown, "start": float(variables[f"{first}/outline_time"][tip.argmax()])}


def motion(name: str, environment: str, variables: Variables, numbers: Numbers) -> dict[str, Any]:
    """One motion: the beam's outline, stress, load, and the turning of what carries it."""

    def of(key: str) -> Any:
        return variables.get(f"motions/{name}/{key}")

    time, some = of("time"), of("outline_time")
    index = np.searchsorted(time, some - 1e-12).clip(max=len(time) - 1)  # of the response's own times
    outline = of("outline")
    header: dict[str, Any] = {
        "name": name,
        "environment": environment,
        **shape(of("point"), of("outline_width"), of("outline_thickness"), of("outline_round")),
        "bodies": [] if of("body_mass") is None else np.stack([of("body_position"), of("body_mass")], axis=1).tolist(),
        "time": numbers.add(some),
        "displacement": numbers.add(outline),
        "largest": _largest(outline),
    }
    stress = of("stress")
    if stress is not None and np.isfinite(stress).all():
        largest = float(np.max(stress))
        header["stress"] = {"at": of("section").tolist(), "values": numbers.add(stress[index]), "largest": largest}
    actual = of("load_actual")
    load = of("root_acceleration") if actual is None else actual
    header["load"], header["largestLoad"] = numbers.add(load[index]), _largest(load)
    if actual is not None:
        header["reference"] = numbers.add(of("load_reference")[index])
        header["controlPoint"] = float(of("control_point"))
        header["axes"], header["arm"] = numbers.add(of("axis_angle")[index]), float(of("arm"))
        header["span"] = [max(float(of("flight_from")), float(time[0])), min(float(of("flight_to")), float(time[-1]))]
    if of("attitude") is not None:
        header["attitude"] = numbers.add(of("attitude"))
    if of("hub_radius") is not None:
        header["radius"], header["mounting"] = float(of("hub_radius")), np.ravel(of("hub_mounting")).tolist()
        header["angle"] = numbers.add(of("hub_angle")[index])
    return header


def shape(points: Floats, width: Floats, thickness: Floats, is_round: Any) -> dict[str, Any]:
    """The straight beam."""
    return {
        "points": np.asarray(points).tolist(),
        "width": np.asarray(width).tolist(),
        "thickness": np.asarray(thickness).tolist(),
        "round": bool(is_round),
    }


def shapes(modes: Modes, numbers: Numbers) -> dict[str, Any]:
    """Shapes of every mode at some of the stations."""
    x = modes.stations
    some = np.unique(np.linspace(0, len(x) - 1, SHOWN).round().astype(int))
    sizes = [
        (each if each.size else x[-1] * part * np.ones(len(x)))[some]
        for each, part in ((modes.width, WIDE), (modes.thickness, THICK))
    ]
    ways = zip(modes.frequency, modes.direction, strict=True)
    return {
        **shape(x[some], sizes[0], sizes[1], modes.round),
        "labels": [f"{i}: {number(frequency)} Hz, {way}" for i, (frequency, way) in enumerate(ways, 1)],
        "real": numbers.add(modes.shape.real[:, some]),
        "imaginary": numbers.add(modes.shape.imag[:, some]),
        **(
            {}
            if modes.twist is None
            else {"twist": [numbers.add(part[:, some]) for part in (modes.twist.real, modes.twist.imag)]}
        ),
    }


def _largest(vectors: Floats) -> float:
    return float(np.sqrt((vectors**2).sum(axis=-1).max()))
