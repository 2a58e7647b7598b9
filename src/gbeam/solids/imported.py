"""Mass and stiffness matrices of other programs, whole or reduced to interfaces, as a structure on a moving base."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from gbeam.arrays.tree import Value
from gbeam.arrays.types import Flags, Floats, Indices
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import array, choice
from gbeam.guards.limits import MODES
from gbeam.guards.quantities import (
    MODAL_DAMPING,
    MODES_KEPT,
    Count,
    Mass,
    ModalDamping,
    OfKind,
    PositionVector,
    Quantity,
)
from gbeam.io.models.registry import model_of
from gbeam.mechanics.equations.linear import PAIRS, Coefficients, Geometric, coefficients, inertial_forces
from gbeam.mechanics.fields.taylor import Places
from gbeam.mechanics.holding import Held, Holding
from gbeam.mechanics.reduction import equivalent_particles, particles_of, reduce
from gbeam.mechanics.structure import Structure, linear_structure
from gbeam.solids.foreign import unit_size
from gbeam.solids.held import about, levers, refuse_free
from gbeam.solids.matrices import (
    EXACT,
    MOST,
    OWN,
    compare_mass,
    displaced,
    every_unknown,
    extent_of,
    fields_of,
    mass_defect,
    mass_of_nodes,
    refuse_held,
    resisted,
    rigid_body,
    rigid_motions,
    sparse_matrix,
    turned,
    with_tip,
)
from gbeam.solids.plausibility import refuse_far
from gbeam.structure.attachments import TIP
from gbeam.structure.supports import DIRECTIONS, Support

InertialLoad = Literal[
    "a_x", "a_y", "a_z", "alpha_x", "alpha_y", "alpha_z", "w_xx", "w_yy", "w_zz", "w_xy", "w_yz", "w_zx"
]
LOADS = get_args(InertialLoad)


@typed
@dataclass(frozen=True, eq=False)
class ImportedModel(Value):
    """A structure by the matrices of a finite-element program; see :meth:`read` for its files.

    Parameters
    ----------
    mass, stiffness : (u, u)
        Arrays, or sparse ones, such as :func:`gbeam.read_matrix` gives; SI.
    nodes : (k, 3)
        Places of the nodes from the root, base axes, m.
    unknowns : (u, 2) int, optional
        Of each row its node, from 0, and its direction: 1 to 3 along x, y, z, 4 to 6 about them; 0 of a coordinate that
        belongs to no node, such as a mode of a Craig-Bampton model. Left out, all nodes have three unknowns, or six.
    numbers : (k,) int, optional
        Numbers of the nodes by which they are named, 0 to k - 1 if left out.

    Raises
    ------
    InputError
        If a matrix is not square or symmetric, or does not fit the nodes.

    Examples
    --------
    >>> model = gb.ImportedModel(
    ...     [[2.0, 0, 0], [0, 2, 0], [0, 0, 2]],
    ...     [[800.0, 0, 0], [0, 5000, 0], [0, 0, 9000]],
    ...     nodes=[(0.1, 0, 0)],
    ... )
    >>> oscillator = model.reduced(modes=2, damping_ratio=0.01)
    >>> print(f"{oscillator.rest[0][0]:.1f} rad/s")
    20.0 rad/s
    """

    mass: Any
    stiffness: Any
    nodes: Annotated[ArrayLike, OfKind("length")]
    unknowns: ArrayLike | None = None
    numbers: ArrayLike | None = None

    def __post_init__(self) -> None:
        """Check the matrices, nodes, unknowns and numbers, and store them as arrays."""
        m = sparse_matrix("mass", self.mass)
        k = sparse_matrix("stiffness", self.stiffness, m.shape[0])
        places = np.asarray(array("nodes", self.nodes), dtype=float)
        size = m.shape[0]
        if places.ndim != 2 or places.shape[1:] != (3,) or not len(places) or not np.isfinite(places).all():
            raise InputError("nodes", f"has the shape {places.shape}", "give a row of x, y, z for each node, finite")
        refuse_far("nodes", places)
        if self.unknowns is None:
            unknowns = every_unknown(places, size)
        else:
            unknowns = np.asarray(self.unknowns, dtype=int)
            if unknowns.shape != (size, 2):
                raise InputError("unknowns", f"has the shape {unknowns.shape}", f"give ({size}, 2): node and direction")
            bad = (unknowns[:, 1] < 0) | (unknowns[:, 1] > 6)
            bad |= (unknowns[:, 1] != OWN) & ((unknowns[:, 0] < 0) | (unknowns[:, 0] >= len(places)))
            if bad.any():
                i = int(np.flatnonzero(bad)[0])
                fix = f"give nodes from 0 to {len(places) - 1} and directions from 0 to 6"
                raise InputError(f"unknowns[{i}]", f"is {unknowns[i].tolist()}", fix)
        numbers = np.arange(len(places)) if self.numbers is None else np.asarray(self.numbers, dtype=int)
        if numbers.shape != (len(places),) or len(np.unique(numbers)) < len(places):
            raise InputError("numbers", f"are {numbers.shape}, or repeat", f"give {len(places)} different ones")
        checked = {"mass": m, "stiffness": k, "nodes": places, "unknowns": unknowns, "numbers": numbers}
        for name, value in checked.items():
            object.__setattr__(self, name, value)

    def __repr__(self) -> str:
        modes = int((np.asarray(self.unknowns)[:, 1] == OWN).sum())
        of_modes = f", {modes} of them modes" if modes else ""
        return f"ImportedModel({len(np.asarray(self.nodes))} nodes, {self.mass.shape[0]} unknowns{of_modes})"

    @classmethod
    @typed
    def read(
        cls,
        *paths: Annotated[str | os.PathLike[str], "one file or several that complete one another"],
        mass: Annotated[str, "name of the mass matrix in the files, where it is not the usual one"] = "",
        stiffness: Annotated[str, "name of the stiffness matrix, likewise"] = "",
        nodes: Annotated[
            ArrayLike | None,
            "places of the nodes (k, 3), in the unit of length, where no file has them: then three or six rows are of "
            "each",
        ] = None,
        length_unit: Annotated[str, "unit of length of the program, such as mm; of time it is the second"] = "m",
        mass_unit: Annotated[str, "unit of mass of the program, such as Mg"] = "kg",
    ) -> ImportedModel:
        """Read the matrices of a model in the files of other programs.

        They are NumPy's .npz and .npy, Matrix Market's .mtx and MATLAB's .mat, with M and K, with ``nodes``, and with
        P, the origins of the interface frames, as Simscape's Reduced Order Flexible Solid takes them; matrices of
        Abaqus and CalculiX (.mtx, and .sti and .mas with .dof), with nodes of an .inp; by the extra ``nastran`` .op4,
        .op2 and direct matrix input (.pch), with nodes of bulk data (.bdf, .dat, .nas, .blk) or of an external
        superelement (.asm with .pch).

        Raises
        ------
        InputError
            If a file is none of these, cannot be read, or something that the model needs is in none of them.

        Examples
        --------
        >>> import numpy as np, os, tempfile
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     path = os.path.join(folder, "model.npz")
        ...     np.savez(path, M=2 * np.eye(3), K=np.diag([800.0, 5000.0, 9000.0]))
        ...     print(gb.ImportedModel.read(path, nodes=[(100, 0, 0)], length_unit="mm").nodes)
        [[0.1 0.  0. ]]
        """
        if not paths:
            raise InputError("paths", "are none", "give one file or more")
        model = model_of(paths)
        m, k, unknowns = model.pair(mass, stiffness)
        places, numbers, unknowns, axes = model.nodes_of(nodes, unknowns)
        size, weight = unit_size("length_unit", length_unit, "length"), unit_size("mass_unit", mass_unit, "mass")
        if unknowns is None:
            unknowns = every_unknown(places, m.shape[0])
        if axes is not None:
            m, k = (_in_base_axes(matrix, unknowns, axes) for matrix in (m, k))
        # Displacements in m, rotations and modes' coordinates as they are.
        from scipy.sparse import diags_array

        scale = diags_array(np.where((unknowns[:, 1] > 0) & (unknowns[:, 1] < 4), 1.0, size))
        m, k = (weight * (scale @ matrix @ scale) for matrix in (m, k))
        return cls(m, k, size * np.asarray(places, dtype=float), unknowns, numbers)

    @typed
    def reduced(
        self,
        *,
        modes: Annotated[int, Count(1, MODES), MODES_KEPT] = 10,
        damping_ratio: Annotated[ModalDamping, MODAL_DAMPING],
        clamp: Annotated[
            Sequence[int] | Indices,
            "numbers of nodes that follow the base; none where the matrices are of the others alone",
        ] = (),
        points: Annotated[
            Mapping[str, int] | None,
            "numbers of nodes of output by name; the ``tip`` is the free one farthest from the root otherwise",
        ] = None,
        interfaces: Annotated[
            Sequence[str],
            "names of points, with displacements and rotations, on which other bodies hang: the static answers to "
            "forces and moments there come on top, so that the reduction is one by Craig and Bampton",
        ] = (),
        supports: Annotated[
            Sequence[Support],
            "places that the base holds besides: [ { at, holds, stiffness, damping } ], each a point by its name",
        ] = (),
        geometric: Annotated[
            Mapping[InertialLoad, Any] | None,
            "stiffness that the stress of a static load adds, by the motion of the root whose inertial load it is: "
            "``a_x``, ``a_y``, ``a_z`` of 1 m/s², ``alpha_x`` and so on of 1 rad/s², ``w_xx``, ``w_yy``, ``w_zz`` of a "
            "rotation of 1 rad/s, ``w_xy``, ``w_yz``, ``w_zx`` half of what two of them add beside their own",
        ] = None,
        total_mass: Annotated[Mass | None, "mass that the matrices must have, within 1 %"] = None,
        centre: Annotated[PositionVector | None, "centre of mass that they must have: [x, y, z]"] = None,
        inertia: Annotated[
            ArrayLike | None,
            Quantity("moment of inertia"),
            "inertia about the centre of mass that they must have: [x, y, z], or three rows",
        ] = None,
        kind: Annotated[str, "name for results"] = "matrices",
    ) -> Structure:
        """Reduce the model to its lowest modes and its static answers to unit inertial loads.

        Raises
        ------
        InputError
            If the stiffness is not positive definite, or resists rigid motion of what is clamped, a node is not there,
            an interface has no rotations, or the matrices have another mass.

        Notes
        -----
        Without `geometric` the stress of loads neither stiffens nor softens: every result says so, and of how much in
        its motion. The modes and the inertial forces are those of the whole mass matrix; Coriolis forces, and what
        centrifugal ones add to the stiffness, are those of the mass of the nodes' displacements, and the share of a
        mode's mass beside it is said. Of coordinates of no node matrices do not say where their mass is: these forces
        are left out.

        Examples
        --------
        >>> model = gb.ImportedModel([[2.0, 0, 0], [0, 2, 0], [0, 0, 2]], [[800.0, 0, 0], [0, 5000, 0], [0, 0, 9000]],
        ...                          nodes=[(0.1, 0, 0)])
        >>> model.reduced(modes=3, damping_ratio=0.01, total_mass=2.0)
        Structure(matrices, 3 coordinates, 2 kg)
        """
        from scipy.linalg import block_diag

        places, unknowns = np.asarray(self.nodes), np.asarray(self.unknowns)
        held = [self._node(f"clamp[{i}]", number) for i, number in enumerate(clamp)]
        named = {name: self._node(f"points.{name}", number) for name, number in (points or {}).items()}
        named = with_tip(named, places, held)
        fields = fields_of(places, unknowns)
        rigid = rigid_motions(fields)
        body = rigid_body(self.mass, rigid)
        compare_mass(body, float(np.linalg.norm(np.ptp(places, axis=0))), total_mass, centre, inertia)
        if held:
            refuse_held(self.stiffness, rigid)
        free = (unknowns[:, 1] == OWN) | ~np.isin(unknowns[:, 0], held)
        places_held = [self._held(i, support, named, free) for i, support in enumerate(supports)]
        rooted = bool(held or resisted(self.stiffness, rigid).any())
        if places_held and not rooted:
            elastic = [(each, way) for each in places_held for way in (*each.support.rigid, *each.support.stiffness)]
            moved = [each.motions[way][1] @ about(each.centre) for each, way in elastic]
            refuse_free("supports", np.concatenate([np.zeros((0, 6)), *moved]), places)
        attached = self._attached(interfaces, named)
        loads = np.concatenate([-(self.mass @ fields), attached], axis=1)
        length = extent_of(places, body)
        tip = self._number(named[TIP])
        tip_clamped = [f"the tip, node {tip}, is clamped and stays at 0"] if named[TIP] in held else []
        holding = Holding(places_held, int(free.sum()))
        stiffness = self.stiffness[free][:, free] + holding.stiffness
        reduction = reduce(
            holding.condense(stiffness),
            holding.condense(self.mass[free][:, free]),
            np.concatenate([holding.condense(loads[free]), holding.condense(holding.yielding.T.toarray())], axis=1),
            modes,
            apart=holding.static_loads(stiffness),
        )
        motions, total = holding.expand(reduction.shapes, reduction.apart), len(reduction.stiffness)
        lifting = motions[:, total:].T @ (stiffness @ motions[:, total:])
        every_shape = np.zeros((len(free), motions.shape[1]))
        every_shape[free] = motions

        def moving(chosen: Indices, stiffness: Floats, damping_ratio: Any) -> Structure:
            """Structure in the chosen of all motions, of which those of the reduction have unit mass."""
            shapes = every_shape[:, chosen]
            products = (fields.T @ (self.mass @ shapes)).reshape(3, 4, -1)
            stress, unstressed = _geometric(geometric, shapes)
            count = int((chosen < total).sum())
            terms, particles, omitted = self._terms(shapes, stiffness, products, body, stress, count)
            first, turns = self._outputs(list(named.values()), shapes)
            return linear_structure(
                terms,
                *particles,
                Places(places[list(named.values())], first),
                length=length,
                turns=turns,
                damping_ratio=damping_ratio,
                points=tuple(named),
                kind=kind,
                warnings=(*unstressed, *omitted, *tip_clamped),
                unstiffened=bool(unstressed or omitted),
                modes=modes,
            )

        def build(n: int, damping_ratio: Any) -> Structure:
            """Structure in the first coordinates."""
            stiffness = reduction.stiffness[:n, :n]
            structure = moving(np.arange(n), stiffness, damping_ratio)
            if not supports:
                return structure
            chosen = np.r_[:n, total : motions.shape[1]]
            whole = moving(chosen, block_diag(stiffness, lifting), 0.0)
            return holding.hold(structure, whole, motions[:, chosen], rooted=rooted)

        return reduction.structure(build, damping_ratio)

    def _held(self, i: int, support: Support, named: Mapping[str, int], free: Flags) -> Held:
        """Motions of the point of the support number `i` by the `free` ones (u,) of the unknowns."""
        from scipy.sparse import csr_array, eye_array

        choice(f"supports[{i}].at", support.name, tuple(named))
        node, unknowns = named[support.name], np.asarray(self.unknowns)
        rows, motions = eye_array(len(free), format="csr")[:, np.flatnonzero(free)], {}
        for way in (*support.rigid, *support.yielding):
            row = np.flatnonzero((unknowns[:, 0] == node) & (unknowns[:, 1] == 1 + DIRECTIONS.index(way)))
            if not len(row):
                problem = f"holds {way} at {support.name}, whose node has no such unknown in the matrices"
                raise InputError(f"supports[{i}]", problem, f"leave {way} out, or export a node that has it")
            motions[way] = rows[row], levers(np.zeros((1, 3)), way)
        moved = csr_array((3, rows.shape[1]))
        for axis in range(3):
            row = np.flatnonzero((unknowns[:, 0] == node) & (unknowns[:, 1] == 1 + axis))
            moved += csr_array(np.eye(3)[:, [axis] * len(row)]) @ rows[row]
        return Held(support, np.asarray(self.nodes)[node], motions, moved)

    def _node(self, where: str, number: int) -> int:
        """Index of the node with a number. InputError about `where` if there is none."""
        numbers = np.asarray(self.numbers)
        index = np.flatnonzero(numbers == number)
        if not index.size:
            range_words = f"from {numbers.min()} to {numbers.max()}"
            raise InputError(where, f"is {number}, which is no node", f"give the number of one, {range_words}")
        return int(index[0])

    def _number(self, node: int) -> int:
        return int(np.asarray(self.numbers)[node])

    def _attached(self, interfaces: Sequence[str], named: Mapping[str, int]) -> Floats:
        """Unit forces and moments on the interfaces as loads (u, 6 i) on the unknowns."""
        columns = []
        for i, name in enumerate(interfaces):
            choice(f"interfaces[{i}]", name, tuple(named))
            rows = turned(np.asarray(self.unknowns), named[name])
            if rows is None:
                fix = "name a point whose node has three displacements and three rotations"
                raise InputError(f"interfaces[{i}]", f"is {name!r}, which does not turn in the matrices", fix)
            columns.append(np.eye(self.mass.shape[0])[:, rows])
        return np.concatenate([np.zeros((self.mass.shape[0], 0)), *columns], axis=1)

    def _outputs(self, nodes: list[int], shapes: Floats) -> tuple[Floats, Floats]:
        """Displacements and rotations (s, 3, n) of nodes per coordinate of shapes (u, n); NaN for rotations not
        given.
        """
        moved = np.full((len(nodes), 6, shapes.shape[1]), np.nan)
        for i, node in enumerate(nodes):
            for row in np.flatnonzero(np.asarray(self.unknowns)[:, 0] == node):
                way = np.asarray(self.unknowns)[row, 1]
                if way != OWN:
                    moved[i, way - 1] = shapes[row]
            if not np.isfinite(moved[i, :3]).all():
                problem = f"has node {self._number(node)}, which lacks a displacement"
                raise InputError("points", problem, "name one that has all three")
        return moved[:, :3], moved[:, 3:]

    def _terms(
        self, shapes: Floats, stiffness: Floats, products: Floats, body: Floats, stress: Geometric, count: int
    ) -> tuple[Coefficients, tuple[Floats, Places], list[str]]:
        """Coefficients of the equations, particles with their places, and warnings of what the matrices leave out.

        `products` (3, 4, n) are those of the shapes with the fields 1, x, y, z along each axis, `body` (10,) is that of
        :func:`rigid_body`. The first `count` shapes have unit mass.
        """
        nodes, rows = displaced(np.asarray(self.unknowns), len(np.asarray(self.nodes)))
        of_nodes, moved = mass_of_nodes(self.mass, rows), shapes[rows]
        sums, moments, missing = products[:, 0], products[:, 1:], mass_defect(of_nodes, moved[..., :count])
        unknown = missing > MOST and (np.asarray(self.unknowns)[:, 1] == OWN).any()
        if unknown:
            mass, *paths = equivalent_particles(body, sums, moments)
        else:
            mass, *paths = particles_of(np.asarray(self.nodes)[nodes], moved, of_nodes)
        places = Places(*paths)
        terms = coefficients(mass, places, stiffness, geometric=stress)
        whole = shapes.T @ (self.mass @ shapes)
        whole[:count, :count] = np.eye(count)
        terms = replace(terms, mass=whole, rigid=body, **inertial_forces(sums, moments))
        if missing <= EXACT:
            return terms, (mass, places), []
        if not unknown:
            warning = f"up to {100 * missing:.2g} % of a mode's mass does not feel Coriolis and centrifugal forces"
            return terms, (mass, places), [warning]
        terms = replace(terms, gyroscopic=0 * terms.gyroscopic, k_ww=stress.ww, k_al=stress.al)
        warning = (
            "the matrices do not say where the mass of their modes is: Coriolis forces, and the change of the "
            "centrifugal force from the root to the rest of the body, are left out"
        )
        return terms, (mass, places), [warning]


def _in_base_axes(matrix: Any, unknowns: Indices, axes: Floats) -> Any:
    """Transform a matrix into base axes, at the nodes that have axes (k, 3, 3) of their own."""
    from scipy.sparse import lil_array

    turn = lil_array(matrix.shape)
    turn.setdiag(1.0)
    for node in np.flatnonzero(np.abs(axes - np.eye(3)).max(axis=(1, 2)) > 0):
        for first in (1, 4):
            rows = [np.flatnonzero((unknowns[:, 0] == node) & (unknowns[:, 1] == first + i)) for i in range(3)]
            count = sum(map(len, rows))
            if count == 3:
                which = np.concatenate(rows)
                turn[np.ix_(which, which)] = axes[node]
            elif count:
                problem = f"has {count} of three directions in axes of its own"
                raise InputError("unknowns", f"of node {node} {problem}", "export the matrices in the basic axes")
    turn = turn.tocsr()
    return turn @ matrix @ turn.T


def _geometric(geometric: Mapping[InertialLoad, Any] | None, shapes: Floats) -> tuple[Geometric, list[str]]:
    """Geometric stiffness in the coordinates of shapes (u, n), and a warning of the loads for which none is given."""
    n = shapes.shape[1]
    matrices: dict[str, Any] = {}
    for name, matrix in (geometric or {}).items():
        choice("geometric", name, LOADS)
        if matrix.shape != (len(shapes), len(shapes)):
            raise InputError(f"geometric.{name}", f"has the shape {matrix.shape}", f"give {(len(shapes),) * 2}")
        matrices[name] = shapes.T @ ((matrix + matrix.T) / 2 @ shapes)
    zero = np.zeros((n, n))
    a, al = (np.stack([matrices.get(f"{way}_{axis}", zero) for axis in "xyz"]) for way in ("a", "alpha"))
    ww = np.zeros((3, 3, n, n))
    for name, (i, j) in zip(LOADS[6:], PAIRS, strict=True):
        ww[i, j] = ww[j, i] = matrices.get(name, zero)
    missing = [name for name in LOADS if name not in matrices]
    if not missing:
        return Geometric(a, al, ww), []
    loads = "" if len(missing) == len(LOADS) else f" of {', '.join(missing)}"
    return Geometric(a, al, ww), [
        f"no geometric stiffness{loads} is given: what the stress of loads stiffens or softens is left out"
    ]
