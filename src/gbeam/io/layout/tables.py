"""Files of answers that are tables: models, placements, state-space models, and a static deflection."""

from __future__ import annotations

import numpy as np

from gbeam.io.groups import Group, Variable, coordinate, known_attrs, labels, variable, words
from gbeam.io.layout.declared import whole_group
from gbeam.io.layout.responses import error_attrs, load_variables, section_coordinate
from gbeam.results.equilibrium import Deflection
from gbeam.results.imitation.placement import Placement
from gbeam.results.state_space import StateSpace
from gbeam.results.study import ModelStudy


def deflection_group(deflection: Deflection) -> Group:
    """Return what a file holds of a static deflection."""
    group = whole_group(deflection)
    if deflection.loads is not None:  # of one time
        loads = load_variables(deflection.loads).items()
        group.variables.update({name: Variable(each.dims[1:], each.values[0], each.attrs) for name, each in loads})
        group.coordinates.update(section_coordinate(deflection.loads))
    return Group(group.variables, group.coordinates, known_attrs(group.attrs | error_attrs(deflection.errors)))


_ROW = {
    "peak": ("m", "peak of the tip's displacement"),
    "time_of_peak": ("s", "time of the peak"),
    "peak_error": ("1", "peak over the reference's, less one"),
    "residual": ("m", "amplitude of the vibration left"),
    "residual_error": ("1", "the same over the reference's, less one"),
    "phase": ("rad", "phase of the vibration left, ahead of the reference's"),
    "difference": ("1", "largest distance of the histories over the reference's peak"),
    "hub_angle": ("rad", "angle of a free hub at the end"),
    "error_estimate": ("1", "total estimated error over the largest displacement"),
    "steps": ("1", "number of steps"),
    "seconds": ("s", "time to compute it"),
}


def models_group(study: ModelStudy) -> Group:
    """Return what a file holds of a study of models, a row for each motion and model."""
    data = {name: variable(("row",), [getattr(row, name) for row in study.rows], *how) for name, how in _ROW.items()}
    for name in ("motion", "model", "outcome", "message"):
        data[name] = words(("row",), [getattr(row, name) for row in study.rows], name)
    data["warnings"] = words(("row",), ["\n".join(row.warnings) for row in study.rows], "warnings")
    data["direction"] = words(("row",), [study.direction[row.motion] for row in study.rows], "direction compared")
    return Group(data, {}, {"title": study.title, "reference": study.reference})


def placement_group(placement: Placement) -> Group:
    """Return what a file holds of a placement, the best candidate first."""
    o, options = ("option",), placement.options
    data = {
        "mounting": words(o, [each.mounting for each in options], "which way up the specimen is mounted"),
        "smoothing": variable(o, [each.smoothing for each in options], "s", "width of the target's kernel"),
        "control_point": variable(o, [each.control_point for each in options], "m", "control point, from the root"),
        "mismatch": variable(o, [each.mismatch for each in options], "1", "weighted measure of the mismatch field"),
        "total_error": variable(
            o, [each.total_error for each in options], "1", "the same with what smoothing and tracking change"
        ),
        "largest_load": variable(
            o, [each.largest_load.machine for each in options], "m s-2", "largest load anywhere on the specimen"
        ),
        "largest_load_place": words(o, [each.largest_load.place_machine for each in options], "where that is"),
        "acceleration": variable(
            ("option", "machine_axis"), [each.accelerations for each in options], "rad s-2", "largest of each axis"
        ),
        "share": variable(o, [each.share for each in options], "1", "largest share of a limit that is used"),
        "exceeded": words(o, ["; ".join(str(use) for use in each.exceeded) for each in options], "limits exceeded"),
    }
    measures = {f"weight_{name.replace('-', '_')}": weight for name, weight in placement.weights.items()}
    attrs = {
        "flight": placement.flight,
        "centrifuge": placement.centrifuge,
        "length": placement.length,
        "outcome": placement.outcome,
        "message": placement.message,
        "current_control_point": placement.current,
        "vibration_gain_over_middle": placement.vibration_gain,
        "refused": "\n".join(placement.refused),
    }
    return Group(data, coordinate("machine_axis", [1, 2, 3], "1", "axis of the centrifuge"), attrs | measures)


def state_space_group(system: StateSpace) -> Group:
    """Return what a file holds of ẋ = Ax + Bu, y = Cx + Du."""
    signals = {"state": system.states, "input": system.inputs, "output": system.outputs}
    names = {kind: [each.name for each in every] for kind, every in signals.items()}
    data = {
        "A": variable(("state", "state_of"), system.a, "mixed", "rates of the states from the states"),
        "B": variable(("state", "input"), system.b, "mixed", "rates of the states from the inputs"),
        "C": variable(("output", "state"), system.c, "mixed", "outputs from the states"),
        "D": variable(("output", "input"), system.d, "mixed", "outputs from the inputs"),
    }
    coordinates = labels("state_of", names["state"])
    for kind, every in signals.items():
        coordinates |= labels(kind, names[kind])
        value = np.asarray(getattr(system, kind))
        data[f"{kind}_value"] = variable((kind,), value, "mixed", f"{kind} at the operating point")
        data[f"{kind}_unit"] = words((kind,), [each.unit for each in every], f"unit of the {kind}")
    if system.errors is not None:
        data["pole_frequency"] = variable(("pole",), system.frequency, "Hz", "frequency of a pole that oscillates")
        data["pole_error"] = variable(("pole",), system.errors.total, "1", "its estimated error, a fraction")
    attrs = {"model": system.model, "motion": system.motion, "time": system.time}
    if (left_out := system.truncation) is not None:
        dims, up_to = ("output", "input"), f"up to {left_out.end:.6g} Hz"
        data["truncation_error"] = variable(dims, left_out.error, "mixed", f"largest gain of what is left out {up_to}")
        data["truncation_gain"] = variable(dims, left_out.gain, "mixed", f"largest gain of the larger model {up_to}")
        attrs |= {"truncation": left_out.method, "states_left_out": left_out.states}
        if left_out.method == "balanced":
            data["hankel_singular_value"] = variable(("hankel",), left_out.hankel, "mixed", "of what decays")
            attrs |= {"truncation_bound": left_out.bound}
    return Group(data, coordinates, attrs)
