"""What a file holds of an equilibrium, of modes about it, of a Campbell diagram, and of critical speeds."""

from __future__ import annotations

import numpy as np

from gbeam.io.groups import AXIS, Group, Variable, coordinate, known_attrs, variable, words
from gbeam.io.layout.responses import error_attrs, load_variables, section_coordinate
from gbeam.results.parts.errors import FrequencyErrors
from gbeam.results.response import BaseMotion
from gbeam.results.steady.equilibrium import Deflection
from gbeam.results.steady.modal import Campbell, Modes
from gbeam.results.steady.stability import Critical, CriticalMap

CAUSES = {
    "shapes": "from too few shapes",
    "model": "of the model against exact",
    "beam_theory": "of the theory of slender beams",
    "total": "in all",
}


def deflection_group(deflection: Deflection) -> Group:
    """Return what a file holds of a static deflection."""
    d = deflection
    data = {
        "displacement": variable(("station", "axis"), d.displacement, "m", "displacement relative to the base axes"),
        "coordinates": variable(
            ("coordinate",), d.q, "1" if d.model == "exact" else "m", "generalised coordinates of the beam"
        ),
        "strain_energy": variable((), d.strain_energy, "J", "strain energy"),
        **_base(d.base),
    }
    coordinates = {
        **coordinate("station", d.stations, "m", "position along the beam from the root"),
        **coordinate("coordinate", np.arange(len(d.q)), "1", "axial, along y, along z"),
        **AXIS,
    }
    if d.loads is not None:  # of one time
        data |= {
            name: Variable(each.dims[1:], each.values[0], each.attrs) for name, each in load_variables(d.loads).items()
        }
        coordinates |= section_coordinate(d.loads)
    return Group(data, coordinates, known_attrs({**_where(d), "stable": int(d.stable), **error_attrs(d.errors)}))


def modes_group(modes: Modes) -> Group:
    """Return what a file holds of modes; netCDF has no complex numbers, so parts are apart."""
    shape, k = ("mode", "station", "axis"), ("mode",)
    data = {
        "frequency": variable(k, modes.frequency, "Hz", "natural frequency"),
        "damping_ratio": variable(k, modes.damping_ratio, "1", "ratio of critical damping; negative for flutter"),
        "direction": words(k, modes.direction, "direction in which the beam moves most"),
        "shape_real": variable(shape, modes.shape.real, "1", "displacement, largest component 1: real part"),
        "shape_imag": variable(shape, modes.shape.imag, "1", "displacement, largest component 1: imaginary part"),
        "equilibrium": variable(
            ("station", "axis"), modes.equilibrium, "m", "displacement about which the beam vibrates"
        ),
        **_base(modes.base),
        **_errors(modes.errors),
        **_section(modes),
    }
    coordinates = {
        **coordinate("mode", np.arange(1, len(modes.frequency) + 1), "1", "number of the mode"),
        **coordinate("station", modes.stations, "m", "position along the beam from the root"),
        **AXIS,
    }
    attrs = {
        "damping_given": int(modes.damping_given),
        "gyroscopic": int(modes.gyroscopic),
        "rigid": modes.rigid,
        "stable": int(modes.stable),
    }
    return Group(data, coordinates, {**_where(modes), **attrs})


def _section(modes: Modes) -> dict[str, Variable]:
    if not len(modes.width):
        return {}
    return {
        "section_width": variable(("station",), modes.width, "m", "extent of the section along y"),
        "section_thickness": variable(("station",), modes.thickness, "m", "extent of the section along z"),
        "section_round": variable((), int(modes.round), "1", "whether the section is round"),
    }


def _errors(errors: FrequencyErrors | None) -> dict[str, Variable]:
    if errors is None:
        return {}
    return {
        f"frequency_error_{name}": variable(("mode",), getattr(errors, name), "1", f"estimated error {cause}")
        for name, cause in CAUSES.items()
    }


def campbell_group(diagram: Campbell) -> Group:
    """Return what a file holds of a Campbell diagram."""
    vk, c = ("speed", "mode"), ("crossing",)
    data = {
        "frequency": variable(vk, diagram.frequency, "Hz", "natural frequency; missing where it does not oscillate"),
        "damping_ratio": variable(vk, diagram.damping_ratio, "1", "ratio of critical damping"),
        "mac": variable(vk, diagram.mac, "1", "modal assurance criterion to the speed before"),
        "direction": words(("mode",), diagram.direction, "direction in which the beam moves most, at the first speed"),
    }
    data |= _errors(diagram.errors)
    if diagram.crossings:
        numbers = {
            "mode": ([each.track + 1 for each in diagram.crossings], "1", "number of the mode"),
            "order": ([each.order for each in diagram.crossings], "1", "multiple of the speed"),
            "speed": ([each.speed for each in diagram.crossings], "rad s-1", "speed"),
            "frequency": ([each.frequency for each in diagram.crossings], "Hz", "frequency"),
        }
        for name, (values, unit, long_name) in numbers.items():
            data[f"crossing_{name}"] = variable(c, values, unit, f"{long_name} at which a mode meets a multiple")
        for name, cause in CAUSES.items():
            values = [getattr(each.errors, name) for each in diagram.crossings]
            data[f"crossing_error_{name}"] = variable(c, values, "1", f"estimated error of the speed {cause}")
    if diagram.critical is not None:
        data |= {f"critical_{name}": each for name, each in critical_group(diagram.critical).variables.items()}
    coordinates = coordinate("speed", diagram.speed, "rad s-1", "hub rate")
    coordinates |= coordinate("mode", np.arange(1, len(diagram.direction) + 1), "1", "number of the mode")
    attrs = {"motion": diagram.motion, "model": diagram.model, "orders": np.array(diagram.orders, dtype=np.int64)}
    critical = {} if diagram.critical is None else {f"critical_{k}": x for k, x in _critical(diagram.critical).items()}
    return Group(data, coordinates, attrs | critical)


def critical_group(critical: Critical) -> Group:
    """Return what a file holds of a critical value."""
    value = np.nan if critical.value is None else critical.value
    data = {
        "value": variable((), value, critical.unit, f"critical {critical.quantity}; missing where it is not reached"),
        "searched_to": variable((), critical.searched_to, critical.unit, "end of the search"),
    }
    for name, cause in CAUSES.items():
        if np.isfinite(value := getattr(critical.errors, name)):
            data[f"error_{name}"] = variable((), value, "1", f"estimated error {cause}, a fraction")
    return Group(data, {}, _critical(critical))


def critical_map_group(critical: CriticalMap) -> Group:
    """Return what a file holds of a map of critical speeds."""
    long_name = "critical hub rate; missing where it is not reached"
    coordinates = coordinate("mass", critical.mass, "kg", "mass on the beam")
    coordinates |= coordinate("position", critical.position, "m", "its position from the root")
    attrs = {"motion": critical.motion, "model": critical.model, "searched_to": critical.searched_to}
    data = {"speed": variable(("mass", "position"), critical.speed, "rad s-1", long_name)}
    if critical.errors is not None:
        for name, cause in CAUSES.items():
            values = getattr(critical.errors, name)
            data[f"speed_error_{name}"] = variable(("mass", "position"), values, "1", f"estimated error {cause}")
    return Group(data, coordinates, attrs)


def _critical(critical: Critical) -> dict[str, str]:
    return {name: getattr(critical, name) for name in ("quantity", "kind", "direction", "reason", "model")}


def _where(result: Deflection | Modes) -> dict[str, str | float]:
    return {"motion": result.motion, "model": result.model, "time": result.time}


def _base(base: BaseMotion) -> dict[str, Variable]:
    return {
        "root_acceleration": variable(("axis",), base.a_WO_B, "m s-2", "acceleration of the root"),
        "angular_velocity": variable(("axis",), base.w_WB_B, "rad s-1", "angular velocity of the base"),
        "angular_acceleration": variable(("axis",), base.alpha_WB_B, "rad s-2", "angular acceleration of the base"),
    }
