"""Solids, imported and measured models, and rigid specimens of a scenario as objects of the core."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gbeam.errors import InputError, naming, placing_within
from gbeam.scenario.schema import specimen as schema

if TYPE_CHECKING:
    from gbeam.mechanics.structure import Structure
    from gbeam.mechanics.tree.system import RigidBody
    from gbeam.scenario.load import Collector
    from gbeam.scenario.schema import system
    from gbeam.solids.model import SolidModel
    from gbeam.solids.rigid import RigidSpecimen


def solid_of(parts: Collector, where: str, table: schema.SolidBody) -> Structure | None:
    """The structure of a mesh."""
    from gbeam.io.kept import content_of, kept
    from gbeam.solids.foreign import is_mesh
    from gbeam.solids.mesh import SolidMesh

    laws: Any = (
        {name: _material(parts, f"{where}.materials.{name}", each) for name, each in table.materials.items()}
        if table.material is None
        else _material(parts, f"{where}.material", table.material)
    )
    held = parts.attempt(
        where,
        lambda: {
            "points": _points(table),
            "carried": {name: _carried(name, each) for name, each in table.carried.items()},
        },
    )
    if held is None or laws is None or (isinstance(laws, dict) and None in laws.values()):
        return None

    about: dict[str, Any] = {
        "materials": laws,
        "clamp": table.clamp,
        "unit": table.unit,
        "thickness": table.thicknesses or table.thickness,
        "point_masses": table.masses,
        "interfaces": table.interfaces,
        "links": table.links,
        "springs": {name: each.model_dump() for name, each in table.springs.items()},
        "origin": table.origin,
        "turn": table.turn,
        "scale": table.scale,
        "mass_unit": table.mass_unit,
        **held,
    }
    options: dict[str, Any] = {"modes": table.modes, "damping_ratio": table.damping_ratio}

    def read(file: str, size: float | None) -> SolidMesh:
        try:
            return SolidMesh.read(file, element_size=size, **about)
        except InputError as error:  # the scenario's own names of what Python calls otherwise
            one = error.where.replace("point_masses", "masses")
            renamed = one.replace("materials", "material", 1) if table.material is not None else one
            renamed = renamed.replace("thickness", "thicknesses", 1) if table.thicknesses else renamed
            raise error.at(renamed) from None

    def source(file: str, size: float | None) -> Any:
        """The file's content and how it is read, or the mesh where it may lie in several files."""
        content = content_of(file) if is_mesh(file) else None
        return read(file, size) if content is None else (content, Path(file).name, size, about)

    def reduced(file: str, size: float | None, coarser: Callable[[], SolidModel] | None, *sources: Any) -> SolidModel:
        def make() -> SolidModel:
            mesh = sources[0] if isinstance(sources[0], SolidMesh) else read(file, size)
            rough = None if coarser is None else coarser()
            with naming({"stiffness": "springs" if table.springs else "clamp"}):
                return mesh.reduced(**options, coarser=rough)

        return kept(f"reducing {file}", (options, *sources), make)

    def model() -> Structure:
        size, of = table.element_size, source(table.mesh, table.element_size)
        if table.coarser is None and table.coarser_size is None:
            return reduced(table.mesh, size, None, of).structure
        file, key = (table.mesh, "coarser_size") if table.coarser is None else (table.coarser, "coarser")
        with naming({"coarser": key}):
            with _of_coarser():
                rough = source(file, table.coarser_size)

            def coarser() -> SolidModel:
                with _of_coarser():
                    return reduced(file, table.coarser_size, None, rough)

            return reduced(table.mesh, size, coarser, of, rough).structure

    return parts.attempt(where, model)


@contextmanager
def _of_coarser() -> Iterator[None]:
    """Name the coarser mesh in errors of its own."""
    try:
        yield
    except InputError as error:
        raise InputError("coarser", f"{error.where} {error.problem}", error.fix) from None


def _points(table: schema.SolidBody | system.RigidBody) -> dict[str, Any]:
    """Points of a body by name: groups and places as they are, and places with axes."""
    from gbeam.mechanics.tree.system import Place

    return {
        name: Place(each.at, each.turn) if isinstance(each, schema.PlaceOfBody) else each
        for name, each in table.points.items()
    }


def _carried(name: str, table: schema.Carried) -> RigidBody:
    """A body on a rigid link."""
    from gbeam.mechanics.tree.system import RigidBody

    with placing_within(f"carried.{name}"):
        return RigidBody(table.mass, table.inertia, table.centre)


def _material(parts: Collector, where: str, table: Any) -> Any:
    from gbeam.structure.material import Material, Orthotropic

    kind = Orthotropic if isinstance(table, schema.Orthotropic) else Material
    return parts.attempt(where, kind, **table.model_dump(exclude_none=True))


def matrices_of(parts: Collector, where: str, table: schema.MatricesBody) -> Structure | None:
    """The structure of the matrices of another program."""
    from gbeam.io.models.registry import read_matrix
    from gbeam.solids.imported import ImportedModel

    def places() -> Any:
        if table.nodes is None:
            return None
        with naming("nodes"):
            read = read_matrix(table.nodes)
        return read.toarray() if hasattr(read, "toarray") else read

    def model() -> Structure:
        files = (table.matrices,) if isinstance(table.matrices, str) else table.matrices
        inertia = None if table.inertia is None else _inertia(table.inertia)
        named = {"mass": table.mass_matrix, "stiffness": table.stiffness_matrix}
        places_of = {key: f"{key}_matrix" if file else "matrices" for key, file in named.items()}
        with naming(places_of | {"paths": "matrices", "path": "matrices"}):
            imported = ImportedModel.read(
                *files,
                mass=table.mass_matrix,
                stiffness=table.stiffness_matrix,
                nodes=places(),
                length_unit=table.length_unit,
                mass_unit=table.mass_unit,
            )
            return imported.reduced(
                **{key: getattr(table, key) for key in _AS_THEY_ARE},
                inertia=inertia,
            )

    return parts.attempt(where, model)


_AS_THEY_ARE = ("modes", "damping_ratio", "clamp", "points", "interfaces", "total_mass", "centre")


def standard_input_of(parts: Collector, where: str, table: schema.StandardInputBody) -> Structure | None:
    """The structure of standard input data."""
    from gbeam.solids.standard_input import read_sid

    def model() -> Structure:
        with naming({"path": "standard_input_data"}):
            return read_sid(table.standard_input_data, damping_ratio=table.damping_ratio, points=table.points)

    return parts.attempt(where, model)


def modal_test_of(parts: Collector, where: str, table: schema.ModalTestBody) -> Structure | None:
    """The structure of measured modes."""
    from gbeam.solids.modal_test import ModalTest

    def test() -> ModalTest:
        if table.modal_test is None:
            measured: dict[str, Any] = {key: getattr(table, key) for key in schema.MEASURED}
            return ModalTest(**measured | {"shapes": _same_nodes(table.shapes, len(measured["nodes"]))})
        read = ModalTest.read(table.modal_test, modal_mass=table.modal_mass)
        return read if table.damping_ratio is None else replace(read, damping_ratio=table.damping_ratio)

    def model() -> Structure:
        with naming({"path": "modal_test"}):
            measured = test()
        count = len(np.asarray(measured.nodes))
        masses = np.full(count, table.masses) if np.ndim(table.masses) == 0 else table.masses
        try:
            return measured.structure(masses, points=table.points)
        except InputError as error:
            raise error.at(error.where.replace("mass", "masses", 1)) from None

    return parts.attempt(where, model)


def _same_nodes(shapes: Any, count: int) -> Any:
    """Shapes by mode (m, k, 3) as displacements of nodes (k, 3, m)."""
    for i, shape in enumerate(shapes):
        if len(shape) != count:
            fix = f"give {count} of [x, y, z]"
            raise InputError(f"shapes[{i}]", f"has {len(shape)} displacements for {count} nodes", fix)
    return np.moveaxis(np.asarray(shapes), 0, -1)


def rigid_body_of(parts: Collector, where: str, table: system.RigidBody) -> RigidBody | None:
    """A rigid body of a system."""
    from gbeam.mechanics.tree.system import RigidBody

    def body() -> RigidBody:
        return RigidBody(table.mass, _moments(table), table.centre, _points(table))

    return parts.attempt(where, body)


def rigid_of(parts: Collector, where: str, table: system.RigidBody) -> Structure | None:
    """A rigid specimen."""
    from gbeam.solids.rigid import RigidSpecimen

    def specimen() -> RigidSpecimen:
        points: dict[str, Any] = {name: getattr(each, "at", each) for name, each in table.points.items()}
        corners = [*table.corners, *points.values()]
        if table.size is not None:
            ways = np.array(list(product((-0.5, 0.5), repeat=3)))
            corners = [*(_middle(table) + ways * np.asarray(table.size)), *corners]
        if not corners:
            raise InputError("size", "is missing", "give the box that it fills, or its corners")
        bolts = table.bolts or None
        moments = _inertia(_moments(table))
        return RigidSpecimen(
            table.mass, table.centre, moments, corners, bolts, table.bolt_axis, table.spread_limit, points
        )

    built = parts.attempt(where, specimen)
    return None if built is None else built.structure


def _middle(table: system.RigidBody) -> Any:
    return np.asarray(table.centre if table.middle is None else table.middle)


def _moments(table: system.RigidBody) -> Any:
    """Inertia as given, or of an even box."""
    if table.size is None:
        if table.middle is not None:
            raise InputError("middle", "is given without a size", "give the edges of the box: size = [x, y, z]")
        return table.inertia
    for i, edge in enumerate(table.size):
        if not edge > 0:
            raise InputError(f"size[{i}]", f"is {edge:g} m", "give a positive length")
    if "inertia" in table.model_fields_set:
        return table.inertia
    if not np.allclose(_middle(table), table.centre):
        fix = "give it: the box is not even, whose middle is not its centre of mass"
        raise InputError("inertia", "is missing", fix)
    squares = np.square(table.size)
    return tuple(table.mass / 12 * (squares.sum() - squares))


def _inertia(moments: Any) -> Any:
    """Principal moments, or three rows, as rows."""
    return np.diag(moments) if np.ndim(moments) == 1 else np.asarray(moments, dtype=float)
