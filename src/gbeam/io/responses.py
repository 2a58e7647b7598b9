"""What a file holds of a response: the beam's motion, its loads, and what its base did."""

from __future__ import annotations

import numpy as np

from gbeam.io.groups import AXIS, Group, Variable, coordinate, variable
from gbeam.io.machine import MACHINE_AXIS, machine_variables
from gbeam.results.response import HubResult, Response
from gbeam.results.section_forces import Loads

_T, _TA, _TC, _TSA = ("time",), ("time", "axis"), ("time", "coordinate"), ("time", "section", "axis")
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
        "tip_max_abs": v(("axis",), peaks.max_abs, "m", "largest displacement of the tip at any step computed"),
        "tip_time_of_max": v(("axis",), peaks.time_of_max, "s", "time of that displacement"),
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
    if response.loads is not None:
        data |= load_variables(response.loads)
        coordinates |= section_coordinate(response.loads)
    if response.hub is not None:
        data |= _hub(response.hub)
    if response.axes is not None:
        data |= machine_variables(response.axes)
        coordinates |= MACHINE_AXIS
    attrs = {name: getattr(response, name) for name in ("environment", "model", "outcome", "message")}
    attrs["warnings"] = "\n".join(response.warnings)
    attrs |= {name: getattr(response, name) for name in ("integrator", "step", "steps", "error_estimate")}
    return Group(data, coordinates, attrs | {"residual_from": response.residual_from})


def section_coordinate(loads: Loads) -> dict[str, Variable]:
    """Where the sections are."""
    return coordinate("section", loads.stations, "m", "position of the section along the beam from the root")


def load_variables(loads: Loads) -> dict[str, Variable]:
    """What the sections carry, over the dimensions time, section and axis."""
    v = variable
    data = {
        "section_force": v(_TSA, loads.section_force, "N", "axial force and shear", frame=_SECTION_AXES),
        "section_moment": v(_TSA, loads.section_moment, "N m", "torque and bending moments", frame=_SECTION_AXES),
        "stress": v(("time", "section"), loads.stress, "Pa", "largest normal stress at the outer fibre"),
        "acceleration": v(
            _TSA, loads.acceleration, "m s-2", "acceleration in the world, base axes; specific force with gravity"
        ),
    }
    if loads.beam_torque is not None:
        data["beam_torque"] = v(_T, loads.beam_torque, "N m", "torque about the hub's axis that the beam takes")
    if loads.drive_torque is not None:
        data["drive_torque"] = v(_T, loads.drive_torque, "N m", "the same with the hub's own inertia: the drive's")
    return data


def _hub(hub: HubResult) -> dict[str, Variable]:
    names = {"angle": "rad", "rate": "rad s-1", "acceleration": "rad s-2"}
    data = {
        f"hub_{name}": variable(_T, getattr(hub, name), unit, f"hub {name} about z") for name, unit in names.items()
    }
    if np.isfinite(hub.drive_torque).any():  # of a free hub it is given, and better than what its inertia implies
        data["drive_torque"] = variable(_T, hub.drive_torque, "N m", "torque of the hub's drive about z")
    return data
