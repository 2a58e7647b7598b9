"""What a file holds of a beam's outline: its shape over some of the times, and what carries it."""

from __future__ import annotations

import numpy as np

from gbeam.io.groups import Variable, coordinate, variable
from gbeam.results.parts.outline import Outline


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
