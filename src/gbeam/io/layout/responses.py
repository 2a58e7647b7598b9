"""Files of a response: the beam's motion, its outline, its loads, and what its base did."""

from __future__ import annotations

from dataclasses import asdict

import numpy as np

from gbeam.io.groups import AXIS, Group, Variable, coordinate, known, known_attrs, variable, whole_flight
from gbeam.io.layout.machine import MACHINE_AXIS, machine_variables
from gbeam.results.errors import Errors
from gbeam.results.parts import LoadPeaks, Loads, Outline
from gbeam.results.response import HubResult, Response


def outline_coordinates(outline: Outline) -> dict[str, Variable]:
    """Where the points are, and when."""
    return {
        **coordinate("outline_time", outline.time, "s", "some of the times"),
        **coordinate("point", outline.points, "m", "position of the point along the beam from the root"),
    }


def outline_variables(outline: Outline) -> dict[str, Variable]:
    """Variables over the dimensions outline_time, point, axis and body."""
    v, p = variable, ("point",)
    made = {
        "outline": v(("outline_time", "point", "axis"), outline.displacement, "m", "displacement of the beam's axis"),
        "outline_width": v(p, outline.width, "m", "extent of the section along y"),
        "outline_thickness": v(p, outline.thickness, "m", "extent of the section along z"),
        "outline_round": v((), int(outline.round), "1", "whether the section is round"),
    }
    if len(outline.bodies):  # netCDF takes a dimension of length zero for an unlimited one
        made["body_position"] = v(("body",), outline.bodies[:, 0], "m", "position of the body from the root")
        made["body_mass"] = v(("body",), outline.bodies[:, 1], "kg", "mass of the body")
    if np.isfinite(outline.arm):
        made["arm"] = v((), outline.arm, "m", "from axis 1 of the centrifuge to the control point")
    if np.isfinite(outline.radius):
        made["hub_radius"] = v((), outline.radius, "m", "from the hub's axis to the root")
        rotation = "rotation from base axes (columns) to hub axes (rows)"
        made["hub_mounting"] = v(("hub_axis", "axis"), outline.R_HB, "1", rotation)
    if outline.attitude is not None:
        rotation = "rotation (w, x, y, z) of the base axes since the first time, by the angular velocity given"
        made["attitude"] = v(("outline_time", "quaternion"), outline.attitude, "1", rotation)
    return made


_T, _TA, _TC, _TS, _TSA = (
    ("time",),
    ("time", "axis"),
    ("time", "coordinate"),
    ("time", "section"),
    ("time", "section", "axis"),
)
_SECTION_AXES = "S: axes of the deformed section"


def response_group(response: Response) -> Group:
    """Return what a file holds of a response."""
    v, base, peaks = variable, response.base, response.peaks
    # A rotation shape's coordinate is an angle and a strain shape's a strain: only projected fields' are lengths.
    length, rate = ("1", "s-1") if response.model == "exact" else ("m", "m s-1")
    data = {
        "displacement": v(
            ("time", "station", "axis"), response.displacement, "m", "displacement relative to the base axes"
        ),
        "coordinates": v(_TC, response.q, length, "generalised coordinates of the beam"),
        "coordinate_rates": v(_TC, response.qd, rate, "rates of the generalised coordinates"),
        "root_acceleration": v(
            _TA, base.a_WO_B, "m s-2", "acceleration of the root; specific force where gravity acts"
        ),
        "angular_velocity": v(_TA, base.w_WB_B, "rad s-1", "angular velocity of the base"),
        "angular_acceleration": v(_TA, base.alpha_WB_B, "rad s-2", "angular acceleration of the base"),
        "tip_max_abs": v(("axis",), peaks.max_abs, "m", "largest displacement of the tip, between steps"),
        "tip_time_of_max": v(("axis",), peaks.time_of_max, "s", "time of that displacement"),
        "tip_max_size": v((), peaks.max_size, "m", "largest length of the tip's displacement"),
        "tip_time_of_max_size": v((), peaks.time_of_max_size, "s", "time of that displacement"),
        "tip_residual_amplitude": v(
            ("axis",), peaks.residual_amplitude, "m", "half peak-to-peak of the tip from residual_from on"
        ),
    }
    coordinates = {
        **coordinate("time", response.time, "s", "time"),
        **coordinate("station", response.stations, "m", "position along the beam from the root"),
        **coordinate("coordinate", np.arange(response.q.shape[1]), "1", "axial, along y, along z"),
        **AXIS,
    }
    data |= whole_flight(response.whole)
    if peaks.displacement is not None:
        size = peaks.displacement.size
        data["station_max_size"] = v(("station",), size.value, "m", "largest length of the displacement")
        data["station_time_of_max_size"] = v(("station",), size.time, "s", "time of that displacement")
    if response.loads is not None:
        data |= load_variables(response.loads)
        if peaks.loads is not None:
            data |= _load_peaks(peaks.loads)
        coordinates |= section_coordinate(response.loads)
    if response.hub is not None:
        data |= _hub(response.hub)
    if response.axes is not None:
        data |= machine_variables(response.axes)
        coordinates |= MACHINE_AXIS
    if response.outline is not None:
        data |= outline_variables(response.outline)
        coordinates |= outline_coordinates(response.outline)
    attrs = {name: getattr(response, name) for name in ("environment", "model", "outcome", "message", "initial")}
    attrs["warnings"] = "\n".join(response.warnings)
    attrs |= {name: getattr(response, name) for name in ("integrator", "step", "steps", "error_estimate")}
    attrs |= error_attrs(response.errors)
    attrs |= {"damping_ratio": np.squeeze(response.damping_ratio)[()], "residual_from": response.residual_from}
    return Group(known(data), coordinates, known_attrs(attrs))


def error_attrs(errors: Errors) -> dict[str, float | str]:
    """Estimated errors, fractions."""
    named = {name: asdict(getattr(errors, name)) for name in ("displacement", "loads", "stress")}
    values = {f"error_{name}_{part}": value for name, parts in named.items() for part, value in parts.items()}
    return {**values, "error_note": errors.note, "error_theory": errors.theory}


def section_coordinate(loads: Loads) -> dict[str, Variable]:
    """Where the sections are."""
    return coordinate("section", loads.stations, "m", "position of the section along the beam from the root")


def load_variables(loads: Loads) -> dict[str, Variable]:
    """What the sections carry, over the dimensions time, section and axis."""
    v = variable
    data = {
        "section_force": v(_TSA, loads.section_force, "N", "axial force and shear", frame=_SECTION_AXES),
        "section_moment": v(_TSA, loads.section_moment, "N m", "torque and bending moments", frame=_SECTION_AXES),
        "stress": v(_TS, loads.stress, "Pa", "largest size of the normal stress over the section"),
        "stress_tension": v(_TS, loads.stress_tension, "Pa", "largest normal stress over the section"),
        "stress_compression": v(_TS, loads.stress_compression, "Pa", "smallest normal stress over the section"),
        "acceleration": v(
            _TSA, loads.acceleration, "m s-2", "acceleration in the world, base axes; specific force with gravity"
        ),
    }
    if loads.root_fibre is not None:
        data["root_fibre_stress"] = v(
            _T, loads.root_fibre, "Pa", "normal stress at the extreme fibre of the root where it ranges most"
        )
    if loads.margin is not None:
        data["yield_margin"] = v(_TS, loads.margin, "1", "yield strength over stress less one")
    if loads.beam_torque is not None:
        data["beam_torque"] = v(_T, loads.beam_torque, "N m", "torque about the hub's axis that the beam takes")
    if loads.drive_torque is not None:
        data["drive_torque"] = v(_T, loads.drive_torque, "N m", "the same with the hub's own inertia: the drive's")
    return data


def _load_peaks(peaks: LoadPeaks) -> dict[str, Variable]:
    every = {
        "section_force_max": (peaks.force.size, "N", "largest force that the section carries"),
        "section_moment_max": (peaks.moment.size, "N m", "largest moment that the section carries"),
        "stress_tension_max": (peaks.tension, "Pa", "largest normal stress"),
        "stress_compression_min": (peaks.compression, "Pa", "smallest normal stress"),
    }
    data = {}
    for name, (extremes, unit, what) in every.items():
        data[name] = variable(("section",), extremes.value, unit, f"{what}, between steps")
        data[f"{name}_time"] = variable(("section",), extremes.time, "s", f"time of {name}")
    return data


def _hub(hub: HubResult) -> dict[str, Variable]:
    names = {"angle": "rad", "rate": "rad s-1", "acceleration": "rad s-2"}
    data = {
        f"hub_{name}": variable(_T, getattr(hub, name), unit, f"hub {name} about z") for name, unit in names.items()
    }
    if hub.drive_torque is not None:  # of a free hub it is given, and better than what its inertia implies
        data["drive_torque"] = variable(_T, hub.drive_torque, "N m", "torque of the hub's drive about z")
    return data
