"""A solid of finite elements on a moving base, read from a file, and its reduction to a structure."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np

from gbeam.arrays.tree import Value
from gbeam.arrays.types import Flags, Floats, Indices, Numbers
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import positive
from gbeam.guards.kinds import Kinds, kinds
from gbeam.mechanics.equations.linear import coefficients, geometric_of
from gbeam.mechanics.fields.taylor import Places
from gbeam.mechanics.plausibility import implausible_material
from gbeam.mechanics.reduction import inertial_loads, linear_fields, particles_of, reduce
from gbeam.mechanics.structure import Structure, linear_structure
from gbeam.mechanics.tree.joints import kind_of_value
from gbeam.mechanics.tree.system import Place, RigidBody
from gbeam.numerics.sparse import refuse_cost
from gbeam.solids.bending import bending
from gbeam.solids.cad import mesh_of
from gbeam.solids.cards import Cards
from gbeam.solids.elements import (
    Block,
    coupled,
    geometric_stiffness,
    mass_matrix,
    masses,
    stiffness_matrix,
)
from gbeam.solids.foreign import (
    THICKNESS,
    Elements,
    assigned,
    elements_of,
    left_out,
    node_numbers_of,
    nodes_in,
    numbers_of,
    refuse_missing,
    unit_size,
)
from gbeam.solids.links import WAYS, Linked, Links, LinkSpring, attached, refuse_names
from gbeam.solids.model import SolidModel, beside, hardly_coarser
from gbeam.solids.placed import Placed, with_cards
from gbeam.solids.plausibility import doubts_of, locking, refuse_folded, refuse_loose, refuse_twice
from gbeam.solids.shells import points_of, refuse_oblique
from gbeam.solids.stress import NodalStress
from gbeam.structure.attachments import TIP, checked_name
from gbeam.structure.material import Material, Orthotropic

LOCKED = "the error of the mesh is not known: meshes whose elements lock differ by less than they are wrong"
MIDDLE = 1e-6  # of half of the thickness of a shell: a place that is nearer to the middle is on neither side


def _kinds_of_points(arguments: Mapping[str, Any]) -> Kinds:
    """Kinds of places by name, some of which are names of groups."""
    points = arguments.get("points")
    places = points.items() if isinstance(points, Mapping) else ()
    return {name: "length" for name, at in places if not isinstance(at, str)}


@dataclass(frozen=True, eq=False)
class SolidMesh(Value):
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

    Examples
    --------
    >>> metal = gb.Material(density=2700, youngs_modulus=70e9, poissons_ratio=0.33)
    >>> materials = {"bracket": metal, "camera": metal}
    >>> solid = gb.SolidMesh.read("examples/data/bracket.msh", materials=materials, clamp="screwed", unit="mm")
    >>> list(solid.stations), int(solid.clamped.sum())
    (['tip'], 93)
    """

    points: Floats
    blocks: tuple[Block, ...]
    clamped: Flags
    numbers: Indices
    point_masses: Floats
    stations: dict[str, int]
    strengths: dict[str, float] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    interfaces: dict[str, Indices] = field(default_factory=dict)
    links: Links = field(default_factory=Links)
    exponents: dict[str, float] = field(default_factory=dict)
    turns: dict[str, Numbers] = field(default_factory=dict)
    clamps: dict[str, int] = field(default_factory=dict)

    @classmethod
    @kinds(
        springs={"*": {"stiffness": {way: kind_of_value("stiffness", way) for way in WAYS}}}, points=_kinds_of_points
    )
    @typed
    def read(
        cls,
        source: Any,
        *,
        materials: Material | Orthotropic | Mapping[str, Material | Orthotropic],
        clamp: str | Sequence[str],
        unit: str | None = None,
        thickness: float | Mapping[str, float] | None = None,
        element_size: float | None = None,
        points: Mapping[str, Any] | None = None,
        point_masses: Mapping[str, float] | None = None,
        interfaces: Mapping[str, str] | None = None,
        links: Mapping[str, str | Sequence[str]] | None = None,
        carried: Mapping[str, RigidBody] | None = None,
        springs: Mapping[str, LinkSpring] | None = None,
        origin: Numbers = (0.0, 0.0, 0.0),
        turn: Numbers = (0.0, 0.0, 0.0),
        scale: Numbers = (1.0, 1.0, 1.0),
        mass_unit: str | None = None,
    ) -> SolidMesh:
        """Read a mesh of solid elements, of shells, or of both.

        Parameters
        ----------
        source : path or meshio.Mesh
            A file of Gmsh, Nastran bulk data, Abaqus or CalculiX, VTK, Exodus or another format of meshio.
            Tetrahedra of 4 and 10 nodes, hexahedra of 8, 20 and 27 and wedges of 6 and 15 are read, and as shells
            triangles of 3 and 6 nodes and quadrilaterals of 4, 8 and 9, whose middle is left out; other surfaces and
            lines only name groups. Nodes without such elements are left out. Or a file of STEP, which Gmsh
            meshes by tetrahedra of 10 nodes; needs the extra ``gmsh``.
        materials : Material, Orthotropic or dict
            Of all elements, or by group: a physical group of Gmsh, a property's number, an element set. Poisson's
            ratio is needed.
        clamp : str or sequence of str
            Groups whose nodes follow the base. A number that surfaces and volumes have is refused: it is written
            "surface 1" or "volume 1".
        unit : str
            Of the mesh's coordinates, such as ``mm``; STEP files say theirs.
        thickness : float or dict of float, optional
            Of shells, m: of all triangles and quadrilaterals, or by group. The mesh is their middle surface. Shells
            carry transverse shear (Mindlin and Reissner), meet at any angle, and share nodes with solids.
        element_size : float
            Largest edge of the elements by which STEP files are meshed, m; 12 are around a full circle. The error of
            a group that is not there says where each solid and each surface is.
        points : dict, optional
            Places of output by name: (x, y, z) in m and base axes, for the nearest node, or a group of one node, of
            shells on the face on whose side the place is, or on that to which the normal of the first element points; a
            :class:`gbeam.Place` has axes too, in which stress and strain there are put out. The ``tip`` is the
            free node farthest from the root where it is not given.
        point_masses : dict, optional
            Masses by the name of a point, or of a group over whose nodes it is spread evenly, kg.
        interfaces : dict of str, optional
            Groups of nodes or elements by the name of a point that moves and turns as their nodes do on average: bodies
            of a :class:`gbeam.System` hang on it by joints, and it is put out.
        links : dict of str or of sequence of str, optional
            Rigid links by name: groups of nodes that move together as one rigid body.
        carried : dict of RigidBody, optional
            Bodies by the name of the rigid link that carries each: its root is in the middle of the link's nodes, its
            axes are those of the base.
        springs : dict, optional
            Springs by name: ``between``, the names of two rigid links or of one that a spring holds to the base, and
            ``stiffness``, a dict of ``x``, ``y`` and ``z`` in N/m and of ``rx``, ``ry`` and ``rz`` in N m/rad, in the
            middle of the first link's nodes and along the axes of the base.
        origin : (3,)
            Root in the mesh's coordinates, m: the point whose acceleration the motion gives.
        turn : (3,)
            Rotation vector of the mesh's axes, and of those of its materials, in the base axes, rad.
        scale : (3,)
            Factors of the mesh's coordinates, before everything else.
        mass_unit : str, optional
            Unit of mass of a file of Nastran, Abaqus or CalculiX, such as ``Mg`` beside mm, N and s: with it the
            file's masses, rigid links and springs are read, which are left out otherwise, with a warning.

        Raises
        ------
        InputError
            If the file cannot be read, has no elements or one that is folded, a group is not there, elements have no
            material or thickness or two, a part of the mesh is not held by the clamp, or the factors would not fit into
            memory.

        Examples
        --------
        >>> aluminium = gb.Material(density=2700, youngs_modulus=70e9, poissons_ratio=0.33)
        >>> materials = {"bracket": aluminium, "camera": aluminium}
        >>> gb.SolidMesh.read("examples/data/bracket.msh", materials=materials, clamp="screwed", unit="mm")
        SolidMesh(2213 nodes, 352 hexahedron20, 0.215 kg, screwed holds 93)
        """
        from scipy.spatial.transform import Rotation

        mesh, size = mesh_of(source, unit, element_size, cards=mass_unit is not None)
        places = np.asarray(mesh.points, dtype=float)
        if places.ndim != 2 or places.shape[1] != 3 or not np.isfinite(places).all():
            raise InputError("mesh", f"has points of shape {places.shape}, or not finite", "give x, y and z of each")
        elements = elements_of(mesh, thickness)
        used = np.unique(np.concatenate([block.nodes.ravel() for block in elements]))
        refuse_cost("mesh", 3 * len(used) * (1 if thickness is None else 2))
        refuse_missing(mesh, elements)
        for i, factor in enumerate(scale):
            positive(f"scale[{i}]", factor, "")
        rotation = Rotation.from_rotvec(turn).as_matrix()
        middles = (size * places * np.asarray(scale, dtype=float) - np.asarray(origin, dtype=float)) @ rotation.T
        vertices, numbers, nodes_of = points_of(middles, elements)

        def group(where: str, name: str) -> Indices:
            nodes = np.flatnonzero(np.isin(numbers, nodes_in(mesh, where, name)))
            if not len(nodes):
                raise InputError(
                    where, f"is {name!r}, which has no node of a solid element or shell", "merge their nodes"
                )
            return nodes

        clamps = {name: group("clamp", name) for name in ([clamp] if isinstance(clamp, str) else clamp)}
        clamped = np.isin(np.arange(len(vertices)), np.concatenate([np.zeros(0, dtype=int), *clamps.values()]))
        named = {
            name: _node(vertices, middles[numbers], name, getattr(place, "at", place), group)
            for name, place in (points or {}).items()
        }
        tip = named.pop(TIP, int(np.argmax(np.linalg.norm(middles[numbers], axis=1) * ~clamped)))
        weights = np.zeros(len(vertices))
        for name, mass in (point_masses or {}).items():
            where = f"point_masses.{name}"
            nodes = np.array([tip if name == TIP else named[name]]) if name in {*named, TIP} else group(where, name)
            weights[nodes] += positive(where, mass, "kg") / len(nodes)
        blocks = _blocks(mesh, vertices, elements, nodes_of, materials, rotation)
        by_group = materials if isinstance(materials, Mapping) else {"": materials}
        names = _names(by_group)
        kinds = {names[name]: material for name, material in by_group.items()}
        strengths = {name: metal.yield_strength for name, metal in kinds.items() if metal.yield_strength is not None}
        refuse_names(interfaces or {}, named | {TIP: tip})
        hung = {name: group(f"interfaces.{name}", of) for name, of in (interfaces or {}).items()}
        exponents = {name: float(material.fatigue_exponent) for name, material in kinds.items()}
        fields: dict[str, Any] = {"strengths": strengths, "exponents": exponents, "interfaces": hung}
        fields["clamps"] = {name: len(np.unique(numbers[nodes])) for name, nodes in clamps.items()}
        tied = Links.of(group, links or {}, carried or {}, springs or {}, vertices, clamped)
        statements_read = tuple[str, ...]()
        if mass_unit is not None:
            cards, weight = getattr(mesh, "cards", Cards()), unit_size("mass_unit", mass_unit, "mass")
            tied, lumped = with_cards(cards, tied, Placed(middles, rotation, vertices, numbers, clamped), size, weight)
            weights, statements_read = weights + lumped, cards.words
        if thickness is not None:
            statements_read += THICKNESS
        fields["links"] = tied
        turned = {name: place for name, place in (points or {}).items() if isinstance(place, Place)}
        fields["turns"] = {name: tuple(place.turn) for name, place in turned.items()}
        solid = cls(vertices, blocks, clamped, node_numbers_of(mesh)[numbers], weights, named | {TIP: tip}, **fields)
        refuse_folded(solid)
        refuse_twice(solid)
        refuse_loose(solid)
        doubts = [*doubts_of(solid, unit or "that of the file"), *left_out(source, mesh, statements_read)]
        for name, material in by_group.items():
            doubts += implausible_material(f"materials.{name}" if name else "material", material)
        return replace(solid, warnings=tuple(doubts))

    def __repr__(self) -> str:
        counts: dict[str, int] = {}
        for block in self.blocks:
            counts[block.kind] = counts.get(block.kind, 0) + len(block.nodes)
        elements = ", ".join(f"{count} {kind}" for kind, count in counts.items())
        held = ", ".join(f"{name} holds {count}" for name, count in self.clamps.items())
        return f"SolidMesh({len(np.unique(self.numbers))} nodes, {elements}, {self.mass:.4g} kg, {held})"

    @property
    def mass(self) -> float:
        """Mass with that on the nodes and of the bodies that it carries, kg."""
        elements = sum(masses(self.points, block).sum() for block in self.blocks)
        return float(elements + self.point_masses.sum() + sum(body.mass for body in self.links.bodies.values()))

    @typed
    def reduced(
        self, *, modes: int, damping_ratio: Any, kind: str = "solid", coarser: SolidModel | None = None
    ) -> SolidModel:
        """Reduce the solid to its lowest modes and its static answers to unit inertial loads.

        Parameters
        ----------
        modes : int
            Number of modes; up to twelve static shapes come on top, so that any steady acceleration and rotation of
            the base deforms the solid as all of its elements would, and six for each interface, so that forces and
            moments there do (attachment modes: a reduction by Craig and Bampton about the clamp).
        damping_ratio : float or sequence
            Of critical damping, of all coordinates, or one for each mode, of which static shapes have the last one's.
        kind : str
            Name of the model in results.
        coarser : SolidModel, optional
            Of a coarser mesh of the same solid, with as many modes and the same points, by which the mesh's error is
            estimated: its answers' differences to those of the finer one. Without one it is unknown.

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
        from scipy.sparse import diags_array, eye_array, kron

        if coarser is not None and len(coarser.mesh.points) >= len(self.points):
            problem = f"has {len(coarser.mesh.points)} nodes, and the mesh {len(self.points)}"
            raise InputError("coarser", problem, "give one with larger elements")
        linked = Linked(self)
        count = len(self.points)
        mass = (linked.widened(mass_matrix(self.points, self.blocks), 1) + diags_array(linked.masses)).tocsr()
        # Body forces −1, −x, −y and −z along x, then along y, then along z.
        loads = inertial_loads(mass @ linear_fields(linked.points))
        centres, forces = attached(self.points, self.interfaces)
        forces[np.repeat(self.clamped, 3)] = 0.0  # what the clamp takes
        loads = np.concatenate([loads, linked.widened_loads(forces)], axis=1)
        stiffness = linked.elastic(stiffness_matrix(self.points, self.blocks))
        held, stiffness = linked.held(stiffness), linked.condensed_stiffness(stiffness)
        reduced = reduce(
            stiffness,
            linked.condensed(kron(mass, eye_array(3), format="csr")),
            linked.condensed(loads),
            modes,
            # Links would have to turn by more than their linear map.
            None if linked.tied else partial(bending, self, linked, modes, partial(self._at_stations, centres, forces)),
        )
        del stiffness
        everywhere, static = (linked.displacements(unknowns) for unknowns in (reduced.shapes, reduced.static))
        shapes = everywhere[:count]
        # Of moments on interfaces the stress is left out.
        pushed = [12 + 6 * i + axis for i in range(len(centres)) for axis in range(3)]
        stressed = [*range(12), *pushed]
        halves = geometric_stiffness(self.points, self.blocks, static[:count, :, stressed], shapes)
        halves += linked.geometric_stiffness(held, mass, loads[:, stressed], reduced.static[:, stressed], reduced)
        frequency = np.sqrt(np.diagonal(reduced.stiffness)[:modes]) / (2 * np.pi)
        locked = coarser is not None and bool(locking(self))
        doubts = () if coarser is None else (*hardly_coarser(coarser.mesh, self), *[LOCKED] * locked)
        nodal, length = NodalStress.of(self, shapes), float(np.linalg.norm(linked.points, axis=1).max())

        def build(n: int, damping_ratio: Any) -> Structure:
            """Structure in the first coordinates."""
            masses, *paths = particles_of(linked.points, everywhere[..., :n], mass)
            stiffness = reduced.stiffness[:n, :n]
            fields = coupled(halves[..., :n, :n], stiffness)
            inertial = fields[:12].reshape(3, 4, n, n)
            stress = geometric_of(inertial[:, 0], inertial[:, 1:].swapaxes(0, 1))
            stations, turns = self._outputs(centres, forces, shapes[..., :n], fields[12:])
            structure = linear_structure(
                coefficients(masses, Places(*paths), stiffness, geometric=stress),
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
            return replace(structure, recovery=replace(nodal, size=n))

        structure = reduced.structure(build, damping_ratio)
        if coarser is not None:
            structure = beside(coarser, structure)
            structure = replace(structure, coarser=None) if locked else structure
        return SolidModel(self, structure, frequency)

    @property
    def named_points(self) -> tuple[str, ...]:
        """Names of the points that are put out: nodes, interfaces, and the tip."""
        *names, tip = self.stations
        return (*names, *self.interfaces, tip)

    def axes(self, point: str) -> Floats:
        """Return the axes of a named point in the base axes, in columns (3, 3).

        Parameters
        ----------
        point : str
            Its name.
        """
        from scipy.spatial.transform import Rotation

        return np.asarray(Rotation.from_rotvec(self.turns.get(point, (0.0, 0.0, 0.0))).as_matrix())

    def _at_stations(self, centres: Floats, forces: Floats, fields: Floats) -> Floats:
        """Displacements (s, 3, m) of the named points by those (k, 3, m) of all, of interfaces by the `forces` on their
        centres.
        """
        moved = (forces.T @ fields.reshape(-1, fields.shape[-1])).reshape(len(centres), 2, 3, fields.shape[-1])
        return np.insert(
            fields[[*self.stations.values()]], [len(self.stations) - 1] * len(centres), moved[:, 0], axis=0
        )

    def _outputs(self, centres: Floats, forces: Floats, shapes: Floats, pushed: Floats) -> tuple[Places, Floats | None]:
        """Places of the named points, of interfaces by the `forces` on their centres and, to second order, what these
        add to the stiffness, `pushed`; and rotations (s, 3, n), not a number where unknown, or None without interfaces.
        """
        n, count = shapes.shape[-1], len(centres)
        ends, before_tip = [*self.stations.values()], [len(self.stations) - 1] * count
        r0, first = (
            np.insert(self.points[ends], before_tip, centres, axis=0),
            self._at_stations(centres, forces, shapes),
        )
        if not count:
            return Places(r0, first), None
        moved = (forces.T @ shapes.reshape(-1, n)).reshape(count, 2, 3, n)
        # Work of a force in displacements of second order: what its stress adds to the stiffness, with the other sign.
        second = np.insert(np.zeros((len(ends), 3, n, n)), before_tip, -pushed.reshape(count, 3, n, n), axis=0)
        turns = np.insert(np.full((len(ends), 3, n), np.nan), before_tip, moved[:, 1], axis=0)
        return Places(r0, first, second), turns


def _node(vertices: Floats, middles: Floats, name: str, place: Any, group: Any) -> int:
    """Number of the node nearest to a place, or of a group's only one; of a shell on the face on the place's side, or
    the upper one.
    """
    where = f"points.{name}"
    if name != TIP:
        try:
            checked_name(name)
        except InputError as error:
            raise error.within("points") from None
    if isinstance(place, str):
        nodes = group(where, place)
        if len(count := np.unique(middles[nodes], axis=0)) != 1:
            raise InputError(where, f"is the group {place!r} of {len(count)} nodes", "give one node, or a place")
        return int(nodes[0])
    place = np.asarray(place, dtype=float)
    if place.shape != (3,) or not np.isfinite(place).all():
        raise InputError(where, f"is {place!r}", "give x, y and z in m, or a group")
    away = np.linalg.norm(middles - place, axis=1)
    size = float(np.linalg.norm(np.ptp(vertices, axis=0)))
    if away.min() > 0.1 * size:
        x, y, z = middles[away.argmin()]
        fix = f"give a place on the solid, in m: that node is at ({x:.4g}, {y:.4g}, {z:.4g}) m"
        raise InputError(where, f"is {away.min():.3g} m from the nearest node", fix)
    nodes = np.flatnonzero(away == away.min())
    arms = vertices[nodes] - middles[nodes]
    return int(nodes[(arms @ (place - middles[nodes[0]]) > MIDDLE * (arms**2).sum(axis=1)).argmax()])


def _names(materials: Mapping[str, Material | Orthotropic]) -> dict[str, str]:
    """Names of materials by those of their groups: of groups of the same material all, for stress is shared by them."""
    return {
        name: ", ".join(other for other, alike in materials.items() if alike == each)
        for name, each in materials.items()
    }


def _blocks(
    mesh: Any, points: Floats, elements: list[Elements], nodes_of: list[Indices], materials: Any, rotation: Floats
) -> tuple[Block, ...]:
    """Elements of each kind and material, whose axes are turned with the mesh."""
    by_group = materials if isinstance(materials, Mapping) else {"": materials}
    owner = assigned(mesh, "materials", materials, (part.block for part in elements))
    without = sum(int((owner[part.block][part.which] < 0).sum()) for part in elements)
    if without:
        raise InputError("materials", f"give {without} elements none", "name the groups of all elements")
    numbers, names, blocks = numbers_of(mesh), _names(by_group), []
    for m, (name, material) in enumerate(by_group.items()):
        where = f"materials.{name}" if name else "materials"
        try:
            turned = isinstance(material, Orthotropic)
            along = replace(material, axes=np.asarray(material.axes) @ rotation.T) if turned else material
            elasticity = along.elasticity
        except InputError as error:
            raise error.within(where) from None
        for (i, which, kind, _, thickness), nodes in zip(elements, nodes_of, strict=True):
            chosen = owner[i][which] == m
            if thickness is not None and turned:
                refuse_oblique(where, points, nodes[chosen], kind, along.axes)
            if chosen.any():
                named = numbers[i][which[chosen]]
                blocks.append(Block(kind, nodes[chosen], named, names[name], float(material.density), elasticity))
    return tuple(blocks)
