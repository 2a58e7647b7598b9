"""What a file holds of an equilibrium beside what its record declares."""

from __future__ import annotations

from gbeam.io.groups import Group, Variable, known_attrs
from gbeam.io.layout.declared import whole_group
from gbeam.io.layout.responses import error_attrs, load_variables, section_coordinate
from gbeam.results.steady.equilibrium import Deflection


def deflection_group(deflection: Deflection) -> Group:
    """Return what a file holds of a static deflection."""
    group = whole_group(deflection)
    if deflection.loads is not None:  # of one time
        loads = load_variables(deflection.loads).items()
        group.variables.update({name: Variable(each.dims[1:], each.values[0], each.attrs) for name, each in loads})
        group.coordinates.update(section_coordinate(deflection.loads))
    return Group(group.variables, group.coordinates, known_attrs(group.attrs | error_attrs(deflection.errors)))
