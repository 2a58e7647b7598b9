"""A solid reduced to a few coordinates: its structure, its stress, and the same of a coarser mesh beside it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from gbeam.arrays.tree import Value
from gbeam.arrays.types import Floats, Indices
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.mechanics.causes import causes_of, loads_at
from gbeam.mechanics.fields.taylor import Places
from gbeam.mechanics.structure import Structure
from gbeam.results.equilibrium import Rest
from gbeam.results.response import Response
from gbeam.results.solids import SolidStress
from gbeam.solids.edges import singular_nodes
from gbeam.solids.elements import mass_matrix
from gbeam.solids.geometry import Mesh
from gbeam.solids.plausibility import locking
from gbeam.solids.stress import NodalStress, solid_stress

MOST = 0.1  # of the nodes: where more would be left out, the largest stress is not known
COARSER = 2**0.5  # times as large elements, from where an error of second order is less than the difference


@dataclass(frozen=True, eq=False)
class SolidModel(Value):
    """A solid reduced to a few coordinates; made by :meth:`SolidMesh.reduced`.

    Parameters
    ----------
    mesh : Mesh
    structure : Structure
        That analyses take; its coordinates are modes of unit modal mass, ascending in frequency.
    frequency : (m,) natural frequencies of the modes, Hz

    Examples
    --------
    >>> metal = gb.Material(density=2700, youngs_modulus=70e9, poissons_ratio=0.33)
    >>> materials = {"bracket": metal, "camera": metal}
    >>> solid = gb.SolidMesh.read("examples/data/bracket.msh", materials=materials, clamp="screwed", unit="mm")
    >>> bracket = solid.reduced(modes=4, damping_ratio=0.02)
    >>> bracket.structure
    Structure(solid, 16 coordinates, 0.215 kg)
    """

    mesh: Mesh
    structure: Structure
    frequency: Floats

    @property
    def mesh_error(self) -> Floats:
        """Estimated errors (m,) of the frequencies at rest by the mesh, as fractions: their differences from those of a
        coarser mesh. They are NaN where there is none, or where elements lock.
        """
        if self.structure.coarser is None:
            return np.full(len(self.frequency), np.nan)
        rough = self.structure.coarser.rest[0][: len(self.frequency)] / (2 * np.pi)
        return np.asarray(np.abs(rough / self.frequency - 1))

    def __repr__(self) -> str:
        frequencies = ", ".join(f"{frequency:.4g}" for frequency in self.frequency[:6])
        is_known = np.isfinite(self.mesh_error)
        cure = "its elements lock" if locking(self.mesh) else "give a coarser mesh"
        error = f"up to {100 * self.mesh_error[is_known].max():.2g} %" if is_known.any() else f"unknown, {cure}"
        return f"SolidModel({self.structure.size} coordinates; {frequencies} Hz; error of the mesh {error})"

    @property
    def shapes(self) -> Floats:
        """Displacements of the nodes per coordinate, (k, 3, n)."""
        return self._nodal.shapes

    @property
    def _nodal(self) -> NodalStress:
        nodal = self.structure.recovery
        assert isinstance(nodal, NodalStress)
        return nodal

    @typed
    def stress(self, answer: Response | Rest) -> SolidStress:
        """Stress of the solid in a response, or at rest.

        Parameters
        ----------
        answer : Response or Rest
            Of this model's structure.

        Returns
        -------
        SolidStress
            At the nodes, at the times of the answer.

        Raises
        ------
        InputError
            If the answer is that of another structure.

        Examples
        --------
        >>> metal = gb.Material(density=2700, youngs_modulus=70e9, poissons_ratio=0.33, yield_strength=240e6)
        >>> materials = {"bracket": metal, "camera": metal}
        >>> solid = gb.SolidMesh.read("examples/data/bracket.msh", materials=materials, clamp="screwed", unit="mm")
        >>> bracket = solid.reduced(modes=4, damping_ratio=0.02)
        >>> stress = bracket.stress(gb.static(bracket.structure, acceleration=(78.5, 0.0, 0.0)))
        >>> print(f"{1e-6 * stress.worst.von_mises:.1f} MPa, margin {stress.nearest_yield.margin:.0f}")
        14.0 MPa, margin 16
        """
        bent = answer.body
        q = np.atleast_2d(np.asarray(bent.q, dtype=float))
        if bent.model != self.structure.kind or q.shape[1] != self.structure.size:
            problem = f"is of {bent.model}, with {q.shape[1]} coordinates"
            raise InputError("answer", problem, f"give one of this {self.structure.kind} with {self.structure.size}")
        time = np.atleast_1d(np.asarray(answer.time, dtype=float))
        causes = causes_of(self.structure, q, loads_at(self.structure, time))
        name = answer.name if isinstance(answer, Response) else answer.motion
        origin = {"motion": name, "model": bent.model, "warnings": answer.warnings, "provenance": answer.provenance}
        return solid_stress(self._nodal, time, causes, **origin)


def attach_coarser(coarser: SolidModel, finer: Structure) -> Structure:
    """Join the structure of a coarser mesh to the `finer` one as its `coarser`.

    The coarser one is expressed in coordinates whose shapes are most like the finer one's, with the same named points,
    and with stress compared at the same places.
    """
    from scipy.spatial import cKDTree

    rough, fine = coarser._nodal, finer.recovery
    assert isinstance(fine, NodalStress)
    structure, n = coarser.structure, finer.size
    if structure.size < n and structure.richer is not None:
        structure = structure.richer
    if structure.size < n or coarser.structure.resolved < finer.resolved:
        problem = f"has {coarser.structure.resolved} modes, and the mesh {finer.resolved}"
        raise InputError("coarser", problem, "give it as many, or more nodes")
    if structure.heated != finer.heated:
        words = "a temperature, and the mesh none" if structure.heated else "no temperature, and the mesh one"
        raise InputError("coarser", f"has {words}", "give it the same")
    for noun, have, want in (
        ("points", structure.points, finer.points),
        ("materials", tuple(dict.fromkeys(rough.material)), tuple(dict.fromkeys(fine.material))),
    ):
        if set(have) != set(want):
            problem = f"has the {noun} {', '.join(have)}, and the mesh {', '.join(want)}"
            raise InputError("coarser", problem, "give it the same")
    size_of_basis, mesh = max(n, coarser.structure.size), rough.mesh
    shapes = rough.every_shape[..., :size_of_basis]
    mass = mass_matrix(mesh.points, mesh.blocks)
    moved = (mass @ shapes.reshape(len(shapes), -1)).reshape(shapes.shape) + mesh.point_masses[:, None, None] * shapes
    _, nearest = cKDTree(fine.mesh.points).query(mesh.points)
    likeness = np.tensordot(moved, fine.shapes[nearest], ((0, 1), (0, 1)))  # mass products of both meshes' shapes
    # A soft shape takes only as much of a stiff one as the forces that hold it bend: more of it would strain the mesh.
    rough_rates, fine_rates = (np.diagonal(s.coefficients.stiffness) for s in (structure, finer))
    forced = np.minimum(1.0, 1 / np.divide.outer(rough_rates[:size_of_basis], fine_rates))
    turn, size = np.linalg.qr(likeness * forced)
    basis = np.zeros((structure.size, n))
    basis[:size_of_basis] = turn * np.where(np.diagonal(size) < 0, -1.0, 1.0)
    padded = np.pad(basis, ((0, rough.every_shape.shape[-1] - len(basis)), (0, 0)))
    without = singular_nodes(fine.mesh)
    excess = int(without.sum()) if without.mean() > MOST else 0
    singular = without[fine.node] & (excess == 0)
    # Where both have a node: stress changes fast near those where it is largest.
    nearest = np.unique(_nearest(fine, rough, np.arange(len(rough.known))))
    shared = nearest[~singular[nearest]]
    felt_at = fine.most_stressed(shared if len(shared) else np.flatnonzero(~singular))
    compared = replace(fine, singular=singular, compared=True, excess=excess, felt_at=felt_at)
    nodal = replace(
        rough,
        every_shape=rough.every_shape @ padded,
        every_table=rough.every_table @ padded,
        size=n,
        felt_at=_nearest(rough, compared, felt_at),
    )
    turned = structure.turned(basis)
    first, places = np.array(turned.station_places.first), finer.station_places
    tip = np.linalg.norm(mesh.points - places.r0[-1], axis=1).argmin()  # of several as far from the root the same
    first[-1] = nodal.shapes[tip]
    stations = Places(places.r0, first, turned.station_places.second)
    turned = replace(
        turned, station_places=stations, stations=finer.stations, length=finer.length, recovery=nodal, richer=None
    )
    richer = finer.richer and replace(finer.richer, recovery=replace(compared, size=finer.richer.size))
    return replace(finer, recovery=compared, richer=richer, coarser=turned)


def _nearest(stress: NodalStress, other: NodalStress, pairs: Indices) -> Indices:
    """Pairs of node and material in one mesh that are nearest to `pairs` of the other, in the same materials."""
    from scipy.spatial import cKDTree

    nearest, materials, wanted = np.zeros_like(pairs), np.array(stress.material), np.array(other.material)[pairs]
    for name in np.unique(wanted):
        candidates, which = np.flatnonzero(materials == name), wanted == name
        tree = cKDTree(stress.mesh.points[stress.node[candidates]])
        nearest[which] = candidates[tree.query(other.mesh.points[other.node[pairs[which]]])[1]]
    return nearest


def hardly_coarser(coarser: Mesh, finer: Mesh) -> tuple[str, ...]:
    """Warn if a coarser mesh's elements are hardly larger than the finer one's, on average in each direction."""

    def size(mesh: Mesh) -> Floats:
        boxes = [np.ptp(mesh.points[block.nodes], axis=1) for block in mesh.blocks]
        return np.asarray(np.concatenate(boxes).mean(axis=0))

    ratio = float((size(coarser) / size(finer)).max())
    if ratio >= COARSER:
        return ()
    return (
        f"the coarser mesh has elements {ratio:.2g} times as large: the error of the mesh may be larger than the "
        "difference; give one of about twice the size",
    )
