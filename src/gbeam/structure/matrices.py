"""Sections by their stiffness and mass matrices (6, 6), of composites and of any shape.

The order of strains and of rows is that of the exact field: stretch, shears along y and z, twist, curvatures about y
and z; x is along the beam. VABS has the same order. BECAS, whose z is along the beam, has shears, stretch, curvatures
and twist: its rows (2, 0, 1, 5, 3, 4) are those of axes y = its x and z = its y. Files of both are read, and what is
drawn is analysed by the finite elements of sectionproperties, which is an optional extra.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from gbeam.arrays.namespace import is_jax, is_traced, namespace
from gbeam.arrays.types import Floats
from gbeam.errors import InputError
from gbeam.guards.checks import array
from gbeam.guards.limits import TEXT_BYTES, existing, refuse_large_file
from gbeam.guards.units import UnitError, quantity
from gbeam.structure.material import Material

Matrix = Any  # tuples of numbers, or an array that JAX traces
CLOSE = 1e-3  # of the largest alike entry: tables are printed with four digits
# Particles in place of a section that has second moments about three axes, in radii of gyration.
TETRAHEDRON = np.array([(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)], dtype=float)
LATTICE = np.concatenate([np.zeros((1, 3)), np.eye(3), -np.eye(3), 1 - np.eye(3)])
UPPER = np.triu_indices(3)


def listed(name: str, value: Any) -> tuple[Matrix, ...]:
    """Matrices, one for each station, of an array (6, 6) or (stations, 6, 6), as tuples unless JAX traces them.

    InputError unless they have this shape and are finite.
    """
    matrices = array(name, value)
    traced = is_traced(matrices)
    matrices = matrices[None] if np.ndim(matrices) == 2 else matrices
    if matrices.ndim != 3 or matrices.shape[1:] != (6, 6) or not (traced or np.isfinite(matrices).all()):
        raise InputError(name, f"is an array {np.shape(value)}", "give (6, 6), or (stations, 6, 6), finite")
    if traced:
        return tuple(matrices)
    return tuple(tuple(map(tuple, matrix.tolist())) for matrix in matrices)


def refuse_impossible(dimensions: dict[str, tuple[Any, ...]]) -> None:
    """Raise InputError if a matrix is not symmetric, a stiffness not positive definite, or a mass that of no body."""
    for name, matrices in dimensions.items():
        for i, matrix in enumerate(() if is_traced(*matrices) else np.asarray(matrices)):
            place = f"{name}[{i}]" if len(matrices) > 1 else name
            size = np.sqrt(np.abs(np.outer(np.diag(matrix), np.diag(matrix))))
            if not (np.abs(matrix - matrix.T) <= CLOSE * size + 1e-300).all():
                raise InputError(place, "is not symmetric", "give energy's second derivatives: K[i, j] = K[j, i]")
            if name == "stiffness" and not _least(matrix) > 0:
                fix = "every strain takes energy; is the order stretch, shears, twist, curvatures?"
                raise InputError(place, "is not positive definite", fix)
            if name == "mass":
                _refuse_no_body(place, matrix)


def _least(matrix: Floats) -> float:
    """Least eigenvalue of a matrix scaled to a diagonal of ones; −1 where its diagonal is not positive."""
    size = np.diag(matrix)
    if not (size > 0).all():
        return -1.0
    return float(np.linalg.eigvalsh((matrix + matrix.T) / 2 / np.sqrt(np.outer(size, size)))[0])


def _refuse_no_body(place: str, matrix: Floats) -> None:
    """Raise InputError unless a mass matrix (6, 6) is a rigid slice's: m 1, m [c]× and moments of inertia."""
    if not matrix[0, 0] > 0:
        raise InputError(place, f"has the mass {matrix[0, 0]:g} kg/m", "give a positive one in the first three rows")
    mass, (x, y, z), _ = body_of(matrix)
    couples = mass * np.array([[0, z, -y], [-z, 0, x], [y, -x, 0]])
    size = mass * np.sqrt(max(float(np.abs(matrix[3:, 3:]).max()) / mass, 1e-300))
    is_isotropic = np.abs(matrix[:3, :3] - mass * np.eye(3)).max() <= CLOSE * mass
    if not is_isotropic or np.abs(matrix[:3, 3:] - couples).max() > CLOSE * size:
        fix = "give m 1, m [c]× and the moments of inertia about the axis of one and the same body"
        raise InputError(place, "is that of no rigid body", fix)
    if radii(matrix[None]) is None:
        raise InputError(place, "has moments that no body has", "none exceeds the sum of the other two")


def body_of(matrix: Any) -> tuple[Any, Any, Any]:
    """Mass, kg/m, centre, m, and second moments ∫ r rᵀ dm about the centre, kg m, of mass matrices (..., 6, 6)."""
    xp, mass = namespace(matrix), matrix[..., 0, 0]
    # The blocks beside the diagonal are m [c]×: each component of the centre stands there twice.
    z = (matrix[..., 0, 4] - matrix[..., 1, 3]) / 2 / mass
    y = (matrix[..., 2, 3] - matrix[..., 0, 5]) / 2 / mass
    x = (matrix[..., 1, 5] - matrix[..., 2, 4]) / 2 / mass
    centre = xp.stack([x, y, z], axis=-1)
    inertia = (matrix[..., 3:, 3:] + xp.swapaxes(matrix[..., 3:, 3:], -1, -2)) / 2
    second = xp.trace(inertia, axis1=-2, axis2=-1)[..., None, None] / 2 * np.eye(3) - inertia
    return mass, centre, second - mass[..., None, None] * centre[..., :, None] * centre[..., None, :]


def radii(matrix: Any) -> Any:
    """Matrices L (..., 3, 3), m, with L Lᵀ = second moments/mass of mass matrices; None if a moment is negative."""
    mass, _, second = body_of(np.asarray(matrix))
    value, vector = np.linalg.eigh(second / mass[..., None, None])
    if (value < -CLOSE * np.abs(value).max(axis=-1, keepdims=True) - 1e-300).any():
        return None
    return vector * np.sqrt(np.maximum(value, 0))[..., None, :]


def particles(matrix: Any, *, rotary: bool) -> tuple[Any, Any]:
    """Particles that stand for slices with mass matrices (g, 6, 6): shares of the mass (k, g) and
    places (k, g, 3), m.
    """
    mass, centre, second = body_of(matrix)
    xp = namespace(mass)
    if not rotary:
        return xp.ones((1, len(mass))), centre[None]
    if not is_jax(mass):
        arms = np.moveaxis(radii(matrix) @ TETRAHEDRON.T, -1, 0)
        return np.full(arms.shape[:2], 1 / len(arms)), centre + arms
    # A square root has no derivative at a moment of zero, as along x in a slice. Under JAX the places of a lattice are
    # fixed, and the moments determine the shares of mass there.
    square = xp.trace(second, axis1=-2, axis2=-1) / mass  # of the lattice's size
    square = xp.where(square > 0, square, 1.0)
    products_of_inertia = second[:, *UPPER] / (mass * square)[:, None]
    moments = xp.concatenate([xp.ones((len(mass), 1)), xp.zeros((len(mass), 3)), products_of_inertia], axis=1)
    products = LATTICE[:, UPPER[0]] * LATTICE[:, UPPER[1]]
    to_shares = np.linalg.inv(np.column_stack([np.ones(len(LATTICE)), LATTICE, products]).T)
    return to_shares @ moments.T, centre + LATTICE[:, None] * xp.sqrt(square)[:, None]


def between(stations: tuple[float, ...], matrices: tuple[Matrix, ...], x: Any) -> Floats:
    """Matrices (..., 6, 6) at positions x (...), m, by linear interpolation between the stations."""
    xp = namespace(*matrices)
    values, positions = xp.asarray(matrices), np.asarray(x, dtype=float)
    if not stations:
        return xp.broadcast_to(values[0], (*positions.shape, 6, 6))
    i = np.clip(np.searchsorted(stations, positions) - 1, 0, len(stations) - 2)
    low, high = np.asarray(stations)[i], np.asarray(stations)[i + 1]
    share = np.clip((positions - low) / (high - low), 0, 1)[..., None, None]
    return xp.asarray((1 - share) * values[i] + share * values[i + 1])


def condensed(stiffness: Floats, kept: list[int]) -> Floats:
    """Stiffness (..., k, k) of the k strains `kept` of six where the others carry no force and take any value."""
    if len(kept) == 6:
        return stiffness
    xp = namespace(stiffness)
    flexibility = xp.linalg.inv(stiffness)[..., kept, :][..., kept]
    return xp.asarray(xp.linalg.inv(flexibility))


def values(stiffness: Floats, mass: Floats) -> tuple[Floats, ...]:
    """Mass, and its second moments ∫z² dm and ∫y² dm about the centre, as of a material of unit density; no fibres."""
    line, _, second = body_of(mass)
    unknown = np.full(line.shape, np.nan)
    return line, second[..., 2, 2], second[..., 1, 1], unknown, unknown


def no_torsion(stiffness: Floats, **_: Floats) -> Floats:
    """NaN in the place of the torsion constant, which matrices have in their stiffness."""
    return np.full(stiffness.shape[:-2], np.nan)


def no_shear(_: float, stiffness: Floats, **__: Floats) -> tuple[Floats, Floats]:
    """NaN in the place of the shear coefficients, which matrices have in their stiffness."""
    unknown = np.full(stiffness.shape[:-2], np.nan)
    return unknown, unknown


class Program(NamedTuple):
    """A program that writes a section's matrices: the ending of its files, the titles above them, the indices in its
    file of our six strains, and what to ask it for where a matrix is missing.
    """

    ending: str
    stiffness: str
    mass: str
    rows: tuple[int, ...]
    fix: str


# VABS writes x along the beam, BECAS z. Another program is one line here.
PROGRAMS = {
    "VABS": Program(
        ".K",
        "Timoshenko Stiffness Matrix (1-extension",
        "The 6X6 Mass Matrix",
        (0, 1, 2, 3, 4, 5),
        "ask VABS for Timoshenko's model, with densities of the materials",
    ),
    "BECAS": Program(
        ".out",
        "Stiffness matrix w.r.t. to the cross section reference point",
        "Mass matrix w.r.t. to the cross section reference point",
        (2, 0, 1, 5, 3, 4),
        "write the output by BECAS 2.3 or later, which has the mass matrix",
    ),
}


def read_matrices(path: str | os.PathLike[str], length_unit: str, mass_unit: str) -> tuple[Floats, Floats]:
    """Stiffness and mass matrices (6, 6) of a file, in SI. The file's unit of time is the second."""
    if not existing(Path(path)):
        raise InputError("path", f"{path} is no file", "give the output of one section")
    refuse_large_file("path", path, TEXT_BYTES, "give the output of one section")
    lines = Path(path).read_text(encoding="utf-8", errors="replace").splitlines()
    writers = [
        name for name, program in PROGRAMS.items() if _rows(lines, program.stiffness) or _rows(lines, program.mass)
    ]
    if not writers:
        outputs = ", or ".join(f"the {program.ending} of {name}" for name, program in PROGRAMS.items())
        raise InputError("path", f"{path} has no matrices of a section", f"give {outputs}; or the matrices themselves")
    program = PROGRAMS[writers[0]]
    matrices = []
    for kind, title in (("stiffness", program.stiffness), ("mass", program.mass)):
        rows = _rows(lines, title)
        if len(rows) != 6:
            raise InputError("path", f"{path} of {writers[0]} has no {kind} matrix of six rows", program.fix)
        matrices.append(np.array(rows)[np.ix_(program.rows, program.rows)])
    length, mass = _size("length_unit", length_unit, "length"), _size("mass_unit", mass_unit, "mass")
    arms = np.repeat([1.0, length], 3)  # rows of moments have a length more
    stiffness, inertia = (np.outer(arms, arms) * matrix for matrix in matrices)
    return stiffness * mass * length, inertia * mass / length


def _rows(lines: list[str], title: str) -> list[list[float]]:
    """Six rows of six numbers, or fewer, below the first line that begins with a title."""
    start = next((k for k, line in enumerate(lines) if line.strip().startswith(title)), None)
    return [] if start is None else list(_matrix(lines[start + 1 : start + 12]))


def _matrix(lines: list[str]) -> Iterator[list[float]]:
    """Yield the first six rows of six numbers that follow one another."""
    count = 0
    for line in lines:
        try:
            row = [float(number.replace("D", "E")) for number in line.split()]
        except ValueError:  # rules, names
            row = []
        if len(row) == 6:
            count += 1
            yield row
        if count == 6 or (count and len(row) != 6):
            return


def _size(where: str, unit: str, kind: str) -> float:
    """Size of a unit of a kind of quantity in SI; InputError if there is no such unit."""
    try:
        return quantity(f"1 {unit}", kind)
    except UnitError as error:
        raise InputError(where, f"is {unit!r}: {error.problem}", error.hint or "give one such as mm, or kg") from None


ELEMENTS = 400  # in the area of a section, about, where no size is given


def _analysed(outline: Any, holes: Any, element_size: float | None, ratio: float) -> Any:
    """Analyse an outline (k, 2), m, with holes by sectionproperties, for a Young's modulus of one.

    Returns its analysis and the size, m, that is its unit of length. InputError if the outline encloses no area.
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
    hole_corners = [np.array(hole.coords) / size for hole in polygon.interiors]
    scaled = Polygon(np.array(polygon.exterior.coords) / size, hole_corners)
    geometry = Geometry(scaled, material=Unit("unit", 1.0, ratio, 1.0, 1.0, "grey"))
    section = Section(geometry.create_mesh(mesh_sizes=[area / size**2]))
    section.calculate_geometric_properties()
    section.calculate_warping_properties()
    return section, size


def matrices_of(
    outline: Any, holes: Any, material: Material, axis: Any, element_size: float | None
) -> tuple[Floats, Floats]:
    """Stiffness and mass matrices (6, 6) of a drawn section about an axis [y, z], m, or about its centroid."""
    section, size = _analysed(outline, holes, element_size, material.ratio)
    modulus, shear = material.youngs_modulus, material.rigidity
    area = section.get_area() * size**2
    # ∫z² dA, ∫y² dA and ∫yz dA about the centroid.
    about_y, about_z, product = (moment * size**4 for moment in section.get_eic())
    along_y, along_z, coupled = (getattr(section.section_props, name) for name in ("a_sx", "a_sy", "a_sxy"))
    # Shear flexibilities add as the energy of two shear forces does (Pilkey, Analysis and Design of Elastic Beams).
    flexibility = np.array([[1 / along_y, 1 / coupled], [1 / coupled, 1 / along_z]]) / (shear * size**2)
    shear_and_torsion = np.zeros((6, 6))
    shear_and_torsion[1:3, 1:3] = np.linalg.inv(flexibility)
    shear_and_torsion[3, 3] = shear * section.get_ej() * size**4
    axial_and_bending, mass = np.zeros((6, 6)), np.zeros((6, 6))
    axial_and_bending[0, 0] = modulus * area
    axial_and_bending[4:, 4:] = modulus * np.array([[about_y, -product], [-product, about_z]])
    mass[:3, :3] = material.density * area * np.eye(3)
    mass[3, 3] = material.density * (about_y + about_z)
    mass[4:, 4:] = axial_and_bending[4:, 4:] * material.density / modulus
    centre, shear_centre = np.array(section.get_c()) * size, np.array(section.get_sc()) * size
    origin = centre if axis is None else array("axis", axis)
    if origin.shape != (2,) or not np.isfinite(origin).all():
        raise InputError("axis", f"is {axis!r}", "give one place [y, z], m")
    at_centre, at_shear = _moved(*(centre - origin)), _moved(*(shear_centre - origin))
    return (
        at_centre.T @ axial_and_bending @ at_centre + at_shear.T @ shear_and_torsion @ at_shear,
        at_centre.T @ mass @ at_centre,
    )


def _moved(y: float, z: float) -> Floats:
    """Matrix (6, 6) of the strains at the place (y, z), m, by those at the section's origin."""
    strain_map = np.eye(6)
    strain_map[:3, 3:] = [[0, z, -y], [-z, 0, 0], [y, 0, 0]]
    return strain_map


def _corners(where: str, corners: Any) -> Floats:
    """Corners (k, 2) m; InputError unless there are three or more finite ones."""
    places = array(where, corners)
    if places.ndim != 2 or places.shape[1] != 2 or len(places) < 3 or not np.isfinite(places).all():
        raise InputError(where, f"is an array {places.shape}", "give three corners [y, z] or more, m")
    return places
