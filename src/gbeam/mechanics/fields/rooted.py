"""A projected field on a root that springs hold."""

from __future__ import annotations

from typing import Any

from gbeam.arrays.namespace import namespace
from gbeam.arrays.tree import record, static
from gbeam.mechanics.fields.projected import ProjectedField
from gbeam.mechanics.fields.rotation import rotation_matrix
from gbeam.mechanics.fields.series import SeriesField
from gbeam.mechanics.fields.strains import ExpandedField, StrainField
from gbeam.mechanics.fields.taylor import EPSILON, Expanded, Places, Turns, exponential

Array = Any


@record
class RootedField(Expanded):
    """A field on a root that springs hold: moved by p and turned by R(φ), whose components are the last coordinates, m
    and rad.
    """

    inner: ProjectedField
    x: Array
    move: Array
    turn: Array
    linear: bool = static()

    def _split(self, q: Array) -> tuple[Array, Array]:
        springs = self.move.shape[1]
        return q[..., :-springs], q[..., -springs:]

    def rotation(self, q: Array, at: Any = slice(None)) -> Array:
        """Rotations of the sections `at` some points at coordinates (..., n), (..., points, 3, 3)."""
        beam, root = self._split(q)
        return rotation_matrix(root @ self.turn.T)[..., None, :, :] @ self.inner.rotation(beam, at)

    def places(self) -> Places:
        """Taylor polynomial of the positions."""
        xp = namespace(self.x, self.inner.x)
        inner, springs = self.inner.places(), self.move.shape[1]
        n = inner.first.shape[-1]
        # p + φ × r, and to second order φ × (J q) and ½ φ × (φ × r).
        about = xp.einsum("acb,ci,pb->pai", EPSILON, self.turn, inner.r0)
        first = xp.concat([inner.first, about + self.move], axis=-1)
        second = xp.pad(inner.second, ((0, 0), (0, 0), (0, springs), (0, springs)))
        if not self.linear:
            mixed = xp.einsum("acb,ci,pbj->paij", EPSILON, self.turn, inner.first)
            twice = 0.5 * xp.einsum("acb,ci,pbj->paij", EPSILON, self.turn, about)
            half = xp.pad(xp.concat([mixed, twice], axis=-1), ((0, 0), (0, 0), (n, 0), (0, 0)))
            second = second + half + xp.swapaxes(half, -1, -2)
        return Places(inner.r0, first, second)

    def turns(self) -> Turns:
        """Taylor polynomial of the rotations."""
        xp = namespace(self.x, self.inner.x)
        inner, springs = self.inner.turns(), self.move.shape[1]
        points, _, _, n = inner.first.shape
        first = xp.pad(xp.broadcast_to(self.turn, (points, 3, springs)), ((0, 0), (0, 0), (n, 0)))
        root = exponential(first, xp.zeros((points, 3, n + springs, n + springs)))
        padded = Turns(
            xp.pad(inner.first, ((0, 0),) * 3 + ((0, springs),)),
            xp.pad(inner.second, ((0, 0),) * 3 + ((0, springs),) * 2),
        )
        return root.after(padded)


Field = StrainField | SeriesField | ExpandedField | ProjectedField | RootedField
