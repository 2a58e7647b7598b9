"""A solid of finite elements on a moving base, read from a file, and its reduction to a structure."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated, Any

import numpy as np

from gbeam.arrays.types import Floats, Numbers
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.kinds import Kinds, kinds
from gbeam.guards.limits import MODES
from gbeam.guards.quantities import (
    MODAL_DAMPING,
    MODES_KEPT,
    Count,
    Length,
    Mass,
    ModalDamping,
    PositionVector,
    Quantity,
    Shape,
)
from gbeam.mechanics.equations.linear import coefficients, geometric_of
from gbeam.mechanics.fields.taylor import Places
from gbeam.mechanics.holding import Holding
from gbeam.mechanics.reduction import inertial_loads, linear_fields, particles_of, reduce
from gbeam.mechanics.structure import Structure, linear_structure
from gbeam.mechanics.tree.joints import kind_of_value
from gbeam.mechanics.tree.rigid_body import RigidBody
from gbeam.solids.bending import bending
from gbeam.solids.elements import coupled, geometric_stiffness, mass_matrix, stiffness_matrix
from gbeam.solids.geometry import Mesh
from gbeam.solids.heat import Heat
from gbeam.solids.linked import Linked
from gbeam.solids.links import WAYS, LinkSpring
from gbeam.solids.model import SolidModel, attach_coarser, hardly_coarser
from gbeam.solids.plausibility import locking
from gbeam.solids.reading import read_solid
from gbeam.solids.stations import Stations
from gbeam.solids.stress import NodalStress
from gbeam.structure.material import Material, Orthotropic
from gbeam.structure.supports import Support
from gbeam.structure.temperature import Temperature

LOCKED = "the error of the mesh is not known: meshes whose elements lock differ by less than they are wrong"


def _kinds_of_points(arguments: Mapping[str, Any]) -> Kinds:
    """Kinds of places by name, some of which are names of groups."""
    points = arguments.get("points")
    places = points.items() if isinstance(points, Mapping) else ()
    return {name: "length" for name, place in places if not isinstance(place, str)}


@dataclass(frozen=True, eq=False)
class SolidMesh(Mesh):
    """A solid of finite elements, clamped at some nodes; made by :meth:`read`.

    Parameters
    ----------
    points : (k, 3) places of the nodes from the root, base axes, m
        Of shells those on their two faces, which have the number of their node.
    blocks : tuple of Block
        Elements of one kind and material each.
    clamped : (k,) bool
        Nodes that follow the base.
    numbers : (k,) int
        Of the nodes in the file, or from 1 in its order where it has none.
    point_masses : (k,) masses on the nodes, kg
    stations : dict of int
        Nodes that are put out, by their names; the last is the tip.
    strengths : dict of float
        Yield strengths of materials by the names of their groups, Pa, of those that have one.
    exponents : dict of float
        Exponents of the Wöhler curves of materials by their names.
    turns : dict of (3,)
        Rotation vectors of the axes of points in the base axes, by their names, of those that are turned, rad.
    warnings : tuple of str
        What is implausible in it.
    interfaces : dict of (g,) int
        Nodes of the groups on which other bodies hang, by their names.
    links : Links
        Nodes that move as rigid bodies, what they carry, and springs between them.
    clamps : dict of int
        Numbers of nodes that each group of the clamp holds, by its name.
    supports : tuple of HeldPlace
        Places that supports hold.
    temperature : Temperature or None
        Its temperature over time.

    Examples
    --------
    >>> metal = gb.Material(density=2700, youngs_modulus=70e9, poissons_ratio=0.33)
    >>> materials = {"bracket": metal, "camera": metal}
    >>> solid = gb.SolidMesh.read("examples/data/bracket.msh", materials=materials, clamp="screwed", unit="mm")
    >>> list(solid.stations), int(solid.clamped.sum())
    (['tip'], 93)
    """

    @classmethod
    @kinds(
        springs={"*": {"stiffness": {way: kind_of_value("stiffness", way) for way in WAYS}}}, points=_kinds_of_points
    )
    @typed
    def read(
        cls,
        source: Annotated[
            Any,
            "file of Gmsh, Nastran bulk data, Abaqus, CalculiX, VTK, Exodus or another format of meshio, in a scenario "
            'relative to the folder of its file; or of STEP, which Gmsh meshes, with pip install "gbeam[gmsh]"; or a '
            "meshio.Mesh",
        ],
        *,
        materials: Annotated[
            Material | Orthotropic | Mapping[str, Material | Orthotropic],
            "of all elements, or of the elements of each group: a physical group of Gmsh, a property's number, an "
            "element set. Poisson's ratio is needed",
        ],
        clamp: Annotated[
            str | Sequence[str],
            "name of the group whose nodes follow the base or the joint, or a list of them; none where supports hold "
            'the solid. A number that surfaces and volumes have is refused: it is written "surface 1" or "volume 1"',
        ] = (),
        unit: Annotated[str | None, 'unit of the coordinates in the mesh, such as "mm"; STEP files say theirs'] = None,
        mass_unit: Annotated[
            str | None,
            'unit of mass in a file of Nastran, Abaqus or CalculiX, such as "Mg" beside mm, N and s: with it the '
            "file's masses, rigid links and springs are read, which are left out otherwise, with a warning",
        ] = None,
        thickness: Annotated[
            Length | Mapping[str, Length] | None,
            "of all triangles and quadrilaterals of a mesh without solids, which are shells by it and have the mesh as "
            "their middle surface, or of the shells of each group; in a mesh with solids other surfaces only name "
            "groups",
        ] = None,
        element_size: Annotated[
            Length | None,
            "largest edge of the elements by which STEP files are meshed; 12 are around a full circle. The error of a "
            "group that is not there says where each solid and each surface is",
        ] = None,
        point_masses: Annotated[
            Mapping[str, Mass] | None,
            "masses by the name of a point, or of a group over whose nodes each is spread evenly",
        ] = None,
        points: Annotated[
            Mapping[str, Any] | None,
            "points of output by name: the place [x, y, z] from the root for the nearest node, of shells on the face "
            "on whose side it is, or a group of one node, or with axes of stress and strain { at, turn }; tip is the "
            "free node farthest from the root where it is not given",
        ] = None,
        interfaces: Annotated[
            Mapping[str, str] | None,
            "groups by the name of a point that moves and turns as their nodes do on average: other bodies hang on it, "
            "and it is put out",
        ] = None,
        links: Annotated[
            Mapping[str, str | Sequence[str]] | None,
            "rigid links by name: a group, or a list of them, whose nodes move together as one rigid body",
        ] = None,
        carried: Annotated[
            Mapping[str, RigidBody] | None,
            "bodies by the name of the rigid link that carries each, its root in the middle of the link's nodes: "
            "{ mass, centre, inertia }",
        ] = None,
        springs: Annotated[
            Mapping[str, LinkSpring] | None,
            "springs by name, between two rigid links or one and the base: { between, stiffness }, in the middle of "
            "the first link's nodes and along the axes of the base",
        ] = None,
        supports: Annotated[
            Sequence[Support],
            "places that the base holds besides: [ { at, holds, stiffness, damping } ], each a group, every node of "
            "which is held, a point, or an interface or rigid link by its mean motion. A node that the clamp or an "
            "earlier support holds in a direction is that one's",
        ] = (),
        temperature: Annotated[
            Temperature | None,
            "temperature, the same in all of the mesh: { value, reference }; it needs the expansion of every material. "
            "The base, and rigid links, do not expand",
        ] = None,
        origin: Annotated[PositionVector, "the root in the mesh, whose acceleration the motion gives: [x, y, z]"] = (
            0.0,
            0.0,
            0.0,
        ),
        turn: Annotated[
            Annotated[Numbers, Quantity("angle"), Shape((3,))],
            "rotation vector of the mesh's axes, and of those of its materials, in those of the base: [x, y, z]",
        ] = (0.0, 0.0, 0.0),
        scale: Annotated[
            Annotated[Numbers, Quantity("ratio", "positive"), Shape((3,))],
            "factors of the mesh's coordinates, before everything else, such as [1, 1, 1.25] for a board a quarter "
            "thicker",
        ] = (1.0, 1.0, 1.0),
    ) -> SolidMesh:
        """Read a mesh of solid elements, of shells, or of both.

        Raises
        ------
        InputError
            If the file cannot be read, has no elements or one that is folded, a group is not there, elements have no
            material or thickness or two, a part of the mesh is not held by the clamp, or the factors would not fit into
            memory.

        Notes
        -----
        Tetrahedra of 4 and 10 nodes, hexahedra of 8, 20 and 27 and wedges of 6 and 15 are read, and as shells triangles
        of 3 and 6 nodes and quadrilaterals of 4, 8 and 9, whose middle is left out; other surfaces and lines only name
        groups. Nodes without such elements are left out. Shells carry transverse shear (Mindlin and Reissner), meet at
        any angle, and share nodes with solids.

        Examples
        --------
        >>> aluminium = gb.Material(density=2700, youngs_modulus=70e9, poissons_ratio=0.33)
        >>> materials = {"bracket": aluminium, "camera": aluminium}
        >>> gb.SolidMesh.read("examples/data/bracket.msh", materials=materials, clamp="screwed", unit="mm")
        SolidMesh(2213 nodes, 352 hexahedron20, 0.215 kg, screwed holds 93)
        """
        return read_solid(
            cls, source, materials=materials, clamp=clamp, unit=unit, thickness=thickness, element_size=element_size,
            points=points or {}, point_masses=point_masses or {}, interfaces=interfaces or {}, links=links or {},
            carried=carried or {}, springs=springs or {}, supports=supports, temperature=temperature,
            origin=origin, turn=turn, scale=scale, mass_unit=mass_unit,
        )  # fmt: skip

    def __repr__(self) -> str:
        counts: dict[str, int] = {}
        for block in self.blocks:
            counts[block.kind] = counts.get(block.kind, 0) + len(block.nodes)
        elements = ", ".join(f"{count} {kind}" for kind, count in counts.items())
        counts = self.clamps | {place.name: len(np.unique(place.node)) for place in self.supports}
        count_words = ", ".join(f"{name} holds {count}" for name, count in counts.items())
        return f"SolidMesh({len(np.unique(self.numbers))} nodes, {elements}, {self.mass:.4g} kg, {count_words})"

    @typed
    def reduced(
        self,
        *,
        modes: Annotated[int, Count(1, MODES), MODES_KEPT] = 10,
        damping_ratio: Annotated[ModalDamping, MODAL_DAMPING],
        kind: Annotated[str, "name of the model in results"] = "solid",
        coarser: Annotated[
            SolidModel | None,
            "of a coarser mesh of the same solid, with as many modes and the same points: by the differences of its "
            "answers to those of the finer one the mesh's error is estimated, which is unknown without one",
        ] = None,
    ) -> SolidModel:
        """Reduce the solid to its lowest modes and its static answers to unit inertial loads.

        Besides the modes there are up to twelve static answers to even accelerations and rotations of the base, six of
        each interface to forces and moments there (attachment modes: a reduction by Craig and Bampton about the clamp),
        and one to a rise of the temperature. So steady loads of these kinds deform the solid as all of its elements
        would.

        Returns
        -------
        SolidModel

        Raises
        ------
        InputError
            If more modes are asked for than there are unknowns, or the coarser mesh is none, or has fewer modes or
            other points.

        Examples
        --------
        >>> metal = gb.Material(density=2700, youngs_modulus=70e9, poissons_ratio=0.33)
        >>> materials = {"bracket": metal, "camera": metal}
        >>> solid = gb.SolidMesh.read("examples/data/bracket.msh", materials=materials, clamp="screwed", unit="mm")
        >>> [f"{each:.0f} Hz" for each in solid.reduced(modes=2, damping_ratio=0.02).frequency]
        ['65 Hz', '190 Hz']
        """
        from scipy.linalg import block_diag
        from scipy.sparse import diags_array, eye_array, kron

        if coarser is not None and len(coarser.mesh.points) >= len(self.points):
            problem = f"has {len(coarser.mesh.points)} nodes, and the mesh {len(self.points)}"
            raise InputError("coarser", problem, "give one with larger elements")
        linked = Linked(self)
        count = len(self.points)
        mass = (linked.widened(mass_matrix(self.points, self.blocks), 1) + diags_array(linked.masses)).tocsr()
        # Body forces −1, −x, −y and −z along x, then along y, then along z.
        loads = inertial_loads(mass @ linear_fields(linked.points))
        named, heat = Stations.from_mesh(self), Heat.from_mesh(self)
        heating = linked.widened_loads(heat.forces)
        loads = np.concatenate([loads, linked.widened_loads(named.forces), heating], axis=1)
        stiffness = linked.elastic(stiffness_matrix(self.points, self.blocks))
        tied, stiffness = linked.tied_rows(stiffness), linked.condensed_stiffness(stiffness)
        places = [linked.held(i, place) for i, place in enumerate(self.supports)]
        holding = Holding(places, stiffness.shape[0])
        if holding.sprung:
            stiffness = stiffness + holding.stiffness
        free_links = linked.narrowed(holding.basis) if holding.taken else linked
        reduced = reduce(
            holding.condense(stiffness),
            free_links.condensed(kron(mass, eye_array(3), format="csr")),
            np.concatenate([free_links.condensed(loads), holding.condense(holding.yielding.T.toarray())], axis=1),
            modes,
            # Links would have to turn by more than their linear map.
            None if linked.tied else partial(bending, self, free_links, modes, named.displacements),
            holding.static_loads(stiffness),
        )
        motions = holding.expand(reduced.shapes, reduced.apart)
        total = len(reduced.stiffness)
        lifting = motions[:, total:].T @ (stiffness @ motions[:, total:])
        del stiffness
        everywhere, static = linked.displacements(motions), free_links.displacements(reduced.static)
        shapes = everywhere[:count, :, :total]
        # Of moments on interfaces the stress is left out.
        pushed = [12 + 6 * i + axis for i in range(len(named.centres)) for axis in range(3)]
        cold, hot = [*range(12), *pushed], [*range(loads.shape[1] - heat.number, loads.shape[1])]
        stressed, by_heat = [*cold, *hot], len(cold)
        by_loads = geometric_stiffness(self.points, self.blocks, static[:count, :, cold], everywhere[:count])
        by_rise = heat.geometric_stiffness(self, static[:count, :, hot], everywhere[:count])
        halves = np.concatenate([by_loads, by_rise], axis=1)
        lifted, pulls = everywhere[:count, :, total:], None
        if lifted.size:
            # Along these the stress of the coordinates is in `pulls`: loads add none, and a rise what is beside them.
            by_expansion = heat.geometric_stiffness(self, 0 * static[:count, :, hot], everywhere[:count])[0]
            by_expansion = np.concatenate([np.zeros_like(by_loads[0]), by_expansion])
            halves[0, :, total:], halves[0, ..., total:] = by_expansion[:, total:], by_expansion[..., total:]
            pulls = geometric_stiffness(self.points, self.blocks, lifted, shapes, strained=False).sum(axis=0)
        halves += free_links.geometric_stiffness(
            tied, mass, loads[:, stressed], reduced.static[:, stressed], reduced, linked.rotations(motions[:, total:])
        )
        frequency = np.sqrt(np.diagonal(reduced.stiffness)[:modes]) / (2 * np.pi)
        locked = coarser is not None and bool(locking(self))
        doubts = () if coarser is None else (*hardly_coarser(coarser.mesh, self), *[LOCKED] * locked)
        nodal = NodalStress.from_shapes(self, shapes, heat.swelling)
        length = float(np.linalg.norm(linked.points, axis=1).max())
        heated = motions.T @ linked.condensed(heating)

        def moving(columns: Any, stiffness: Floats, fields: Floats, damping_ratio: Any) -> Structure:
            """Structure in the chosen of all motions, with its geometric stiffness by the loads' `fields`."""
            masses, *paths = particles_of(linked.points, everywhere[..., columns], mass)
            inertial = fields[:12].reshape(3, 4, *stiffness.shape)
            stress = geometric_of(inertial[:, 0], inertial[:, 1:].swapaxes(0, 1))
            stations, turns = named.expansion(everywhere[:count, :, columns], fields[12:by_heat])
            terms = heat.terms(heated[columns], fields[by_heat:])
            return linear_structure(
                coefficients(masses, Places(*paths), stiffness, geometric=stress, loads=terms),
                masses,
                Places(*paths),
                stations,
                length=length,
                turns=turns,
                damping_ratio=damping_ratio,
                points=self.named_points,
                kind=kind,
                warnings=(*self.warnings, *doubts),
                modes=modes,
            )

        def build(n: int, damping_ratio: Any) -> Structure:
            """Structure in the first coordinates."""
            stiffness = reduced.stiffness[:n, :n]
            fields = coupled(halves[..., :n, :n], stiffness)
            structure = moving(slice(n), stiffness, fields, damping_ratio)
            structure = replace(heat.apply(structure), recovery=replace(nodal, size=n))
            if not holding.places:
                return structure
            columns = np.r_[:n, total : everywhere.shape[2]]
            first = halves[0][:, columns[:, None], columns]
            # Those of the lifted motions are as of stiff modes, which no soft ones turn.
            fields_of_all = first + first.swapaxes(1, 2)
            fields_of_all[:, :n, :n] = fields
            free_structure = moving(columns, block_diag(stiffness, lifting), fields_of_all, 0.0)
            second = None if pulls is None else pulls[:, :n, :n] + pulls[:, :n, :n].swapaxes(1, 2)
            return holding.hold(structure, free_structure, motions[:, columns], second, rooted=bool(self.clamps))

        structure = reduced.structure(build, damping_ratio)
        if coarser is not None:
            structure = attach_coarser(coarser, structure)
            structure = replace(structure, coarser=None) if locked else structure
        return SolidModel(self, structure, frequency)
