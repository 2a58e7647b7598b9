"""Stiffness and mass matrices of sections: in files of VABS and BECAS, and of what is drawn, by the finite elements of
sectionproperties, which is an optional extra.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gbeam.errors import InputError
from gbeam.guards.checks import array
from gbeam.guards.limits import TEXT_BYTES, refuse_large_file
from gbeam.guards.units import UnitError, quantity
from gbeam.structure.material import Material

Array = NDArray[np.float64]


class Program(NamedTuple):
    """A program that writes a section's matrices: their titles, its rows in our order, and what to ask it for."""

    stiffness: str
    mass: str
    rows: tuple[int, ...]
    fix: str


# VABS writes x along the beam, BECAS z. Another program is one line here.
PROGRAMS = {
    "VABS": Program(
        "Timoshenko Stiffness Matrix (1-extension",
        "The 6X6 Mass Matrix",
        (0, 1, 2, 3, 4, 5),
        "ask VABS for Timoshenko's model, with densities of the materials",
    ),
    "BECAS": Program(
        "Stiffness matrix w.r.t. to the cross section reference point",
        "Mass matrix w.r.t. to the cross section reference point",
        (2, 0, 1, 5, 3, 4),
        "write the output by BECAS 2.3 or later, which has the mass matrix",
    ),
}


def read_matrices(path: str | os.PathLike[str], length_unit: str, mass_unit: str) -> tuple[Array, Array]:
    """Stiffness and mass matrices (6, 6) of a file, in SI, whose unit of time is the second."""
    refuse_large_file("path", path, TEXT_BYTES, "give the output of one section")
    lines = Path(path).read_text(encoding="utf-8", errors="replace").splitlines()
    written = [name for name, each in PROGRAMS.items() if _rows(lines, each.stiffness) or _rows(lines, each.mass)]
    if not written:
        known = "the .K of VABS, or the .out of BECAS"
        raise InputError("path", f"{path} has no matrices of a section", f"give {known}; or the matrices themselves")
    program = PROGRAMS[written[0]]
    both = []
    for what, title in (("stiffness", program.stiffness), ("mass", program.mass)):
        rows = _rows(lines, title)
        if len(rows) != 6:
            raise InputError("path", f"{path} of {written[0]} has no {what} matrix of six rows", program.fix)
        both.append(np.array(rows)[np.ix_(program.rows, program.rows)])
    length, mass = _size("length_unit", length_unit, "length"), _size("mass_unit", mass_unit, "mass")
    turned = np.repeat([1.0, length], 3)
    scale = np.outer(turned, turned)
    return both[0] * scale * mass * length, both[1] * scale * mass / length


def _rows(lines: list[str], title: str) -> list[list[float]]:
    """Rows of six numbers below the first line that has a title."""
    at = next((k for k, line in enumerate(lines) if line.strip().startswith(title)), None)
    return [] if at is None else list(_matrix(lines[at + 1 : at + 12]))


def _matrix(lines: list[str]) -> Iterator[list[float]]:
    count = 0
    for line in lines:
        try:
            row = [float(each.replace("D", "E")) for each in line.split()]
        except ValueError:  # rules, names
            row = []
        if len(row) == 6:
            count += 1
            yield row
        if count == 6 or (count and len(row) != 6):
            return


def _size(where: str, unit: str, kind: str) -> float:
    try:
        return quantity(f"1 {unit}", kind)
    except UnitError as error:
        raise InputError(where, f"is {unit!r}: {error.problem}", error.hint or "give one such as mm, or kg") from None


ELEMENTS = 400  # in the area of a section, about, where no size is given


def _analysed(outline: Any, holes: Any, element_size: float | None, ratio: float) -> Any:
    """Analysis by sectionproperties of the polygon of an outline (k, 2) m with holes, by a Young's modulus of one and a
    Poisson's ratio, in lengths of a size m, which follows.
    """
    try:
        from sectionproperties.analysis import Section
        from sectionproperties.pre import Geometry
        from sectionproperties.pre import Material as Unit
        from shapely import Polygon
    except ImportError as error:
        fix = 'install it with: pip install "gbeam[sections]"'
        raise InputError("outline", f"needs {error.name}, which is not installed", fix) from None
    polygon = Polygon(_corners("outline", outline), [_corners(f"holes[{i}]", hole) for i, hole in enumerate(holes)])
    if not polygon.is_valid or not polygon.area > 0:
        fix = "give corners in order, of an outline that does not cross itself, with its holes inside"
        raise InputError("outline", "encloses no area, or crosses itself or a hole", fix)
    area = polygon.area / ELEMENTS if element_size is None else np.sqrt(3) / 4 * element_size**2
    # In lengths of the section's own size: the mesher's slack is absolute.
    size = np.sqrt(polygon.area)
    scaled = Polygon(
        np.array(polygon.exterior.coords) / size, [np.array(each.coords) / size for each in polygon.interiors]
    )
    geometry = Geometry(scaled, material=Unit("unit", 1.0, ratio, 1.0, 1.0, "grey"))
    section = Section(geometry.create_mesh(mesh_sizes=[area / size**2]))
    section.calculate_geometric_properties()
    section.calculate_warping_properties()
    return section, size


def matrices_of(
    outline: Any, holes: Any, material: Material, axis: Any, element_size: float | None
) -> tuple[Array, Array]:
    """Stiffness and mass matrices (6, 6) of a drawn section about an axis [y, z] m, or the centroid."""
    section, size = _analysed(outline, holes, element_size, material.ratio)
    modulus, shear = material.youngs_modulus, material.rigidity
    area = section.get_area() * size**2
    about_y, about_z, product = (each * size**4 for each in section.get_eic())  # ∫z², ∫y² and ∫yz about the centroid
    along_y, along_z, both = (getattr(section.section_props, name) for name in ("a_sx", "a_sy", "a_sxy"))
    # Shear flexibilities add as the energy of two shear forces does (Pilkey, Analysis and Design of Elastic Beams).
    flexible = np.array([[1 / along_y, 1 / both], [1 / both, 1 / along_z]]) / (shear * size**2)
    sheared = np.zeros((6, 6))
    sheared[1:3, 1:3] = np.linalg.inv(flexible)
    sheared[3, 3] = shear * section.get_ej() * size**4
    stretched, mass = np.zeros((6, 6)), np.zeros((6, 6))
    stretched[0, 0] = modulus * area
    stretched[4:, 4:] = modulus * np.array([[about_y, -product], [-product, about_z]])
    mass[:3, :3] = material.density * area * np.eye(3)
    mass[3, 3] = material.density * (about_y + about_z)
    mass[4:, 4:] = stretched[4:, 4:] * material.density / modulus
    centre, shear_centre = (np.array(each) * size for each in (section.get_c(), section.get_sc()))
    origin = centre if axis is None else array("axis", axis)
    if origin.shape != (2,) or not np.isfinite(origin).all():
        raise InputError("axis", f"is {axis!r}", "give one place [y, z], m")
    at_centre, at_shear = _moved(*(centre - origin)), _moved(*(shear_centre - origin))
    return at_centre.T @ stretched @ at_centre + at_shear.T @ sheared @ at_shear, at_centre.T @ mass @ at_centre


def _moved(y: float, z: float) -> Array:
    """Strains (6, 6) at a place of the section by those at the origin."""
    moved = np.eye(6)
    moved[:3, 3:] = [[0, z, -y], [-z, 0, 0], [y, 0, 0]]
    return moved


def _corners(where: str, corners: Any) -> Array:
    at = array(where, corners)
    if at.ndim != 2 or at.shape[1] != 2 or len(at) < 3 or not np.isfinite(at).all():
        raise InputError(where, f"is an array {at.shape}", "give three corners [y, z] or more, m")
    return at
