"""A solid reduced to a few coordinates: its structure, its stress, and the error of its mesh."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gbeam.arrays.tree import Value
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.mechanics.structure import Structure
from gbeam.results.equilibrium import Deflection
from gbeam.results.response import Response
from gbeam.results.result import Floats
from gbeam.results.solids import SolidStress
from gbeam.solids.stress import NodalStress, solid_stress

if TYPE_CHECKING:
    from gbeam.solids.mesh import SolidMesh

ROUGH = 0.05  # of the lowest frequency, between two meshes


@dataclass(frozen=True, eq=False)
class SolidModel(Value):
    """A solid reduced to a few coordinates; made by :meth:`SolidMesh.reduced`.

    Parameters
    ----------
    mesh : SolidMesh
    structure : Structure
        That analyses take; its coordinates are modes of unit modal mass, ascending in frequency.
    frequency : (m,) natural frequencies of the modes, Hz
    mesh_error : (m,) estimated errors of the frequencies by the mesh, as fractions
        Their difference to those of a coarser mesh; NaN where there is none.

    Examples
    --------
    >>> metal = gb.Material(density=2700, youngs_modulus=70e9, poissons_ratio=0.33)
    >>> materials = {"bracket": metal, "camera": metal}
    >>> solid = gb.SolidMesh.read("examples/data/bracket.msh", materials=materials, clamp="screwed", unit="mm")
    >>> bracket = solid.reduced(modes=4, damping_ratio=0.02)
    >>> bracket.structure
    Structure(solid, 16 coordinates, 0.215 kg)
    """

    mesh: SolidMesh
    structure: Structure
    frequency: Floats
    mesh_error: Floats

    def __repr__(self) -> str:
        shown = ", ".join(f"{each:.4g}" for each in self.frequency[:6])
        known = np.isfinite(self.mesh_error)
        error = f"up to {100 * self.mesh_error[known].max():.2g} %" if known.any() else "unknown, give a coarser mesh"
        return f"SolidModel({self.structure.size} coordinates; {shown} Hz; error of the mesh {error})"

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
    def stress(self, answer: Response | Deflection) -> SolidStress:
        """Stress of the solid in a response, or at rest.

        Parameters
        ----------
        answer : Response or Deflection
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
        q = np.atleast_2d(np.asarray(answer.q, dtype=float))
        if answer.model != self.structure.kind or q.shape[1] != self.structure.size:
            problem = f"is of {answer.model}, with {q.shape[1]} coordinates"
            raise InputError("answer", problem, f"give one of this {self.structure.kind} with {self.structure.size}")
        time = np.atleast_1d(np.asarray(answer.time, dtype=float))
        name = answer.name if isinstance(answer, Response) else answer.motion
        about = {"motion": name, "model": answer.model, "warnings": answer.warnings, "provenance": answer.provenance}
        return solid_stress(self._nodal, time, q, **about)


def mesh_errors(frequency: Floats, coarser: SolidModel | None) -> tuple[Floats, tuple[str, ...]]:
    """Differences of frequencies to those of a coarser mesh, as fractions, and a warning where they are large."""
    error = np.full(len(frequency), np.nan)
    if coarser is None:
        return error, ()
    both = min(len(error), len(coarser.frequency))
    error[:both] = np.abs(coarser.frequency[:both] / frequency[:both] - 1)
    if error[0] <= ROUGH:
        return error, ()
    return error, (f"the mesh: a coarser one changes the lowest frequency by {100 * error[0]:.2g} %; mesh it finer",)
