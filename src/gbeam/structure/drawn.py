"""Matrices of drawn sections, by the finite elements of sectionproperties, which is an optional extra."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from gbeam.errors import InputError
from gbeam.guards.checks import array
from gbeam.structure.material import Material

Array = NDArray[np.float64]
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
