"""A field on a root that springs hold."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from gbeam.arrays.namespace import namespace
from gbeam.arrays.tree import record, static
from gbeam.mechanics.fields.rotation import Field, Strains, rotation_matrix
from gbeam.mechanics.fields.taylor import EPSILON, Places, Turns, exponential

Array = Any


@record
class RootedField:
    """A field on a root that springs hold: moved by p and turned by R(φ), whose components are the last coordinates, m
    and rad.
    """

    inner: Field
    x: Array
    move: Array
    turn: Array
    linear: bool = static()

    @property
    def cumulative(self) -> Array:
        """Weights (points, g) of the inner field."""
        return self.inner.cumulative

    def _split(self, q: Array) -> tuple[Array, Array]:
        springs = self.move.shape[1]
        return q[..., :-springs], q[..., -springs:]

    def position(self, q: Array) -> Array:
        """Positions of the points of the axis at coordinates (..., n), (..., points, 3) m."""
        xp = namespace(self.x, q)
        beam, root = self._split(q)
        r, turned, moved = self.inner.position(beam), root @ self.turn.T, (root @ self.move.T)[..., None, :]
        if self.linear:
            straight = xp.stack([self.x, 0 * self.x, 0 * self.x], axis=-1)
            return r + moved + xp.cross(turned[..., None, :], straight)
        return r @ xp.swapaxes(rotation_matrix(turned), -1, -2) + moved

    def components(self, q: Array) -> tuple[Array, Array, Array]:
        """None: see `cumulates`."""
        raise TypeError("the positions of this field are no plain sums of nodal vectors")

    def rotation(self, q: Array, at: Any = slice(None)) -> Array:
        """Rotations of the sections `at` some points at coordinates (..., n), (..., points, 3, 3)."""
        beam, root = self._split(q)
        return rotation_matrix(root @ self.turn.T)[..., None, :, :] @ self.inner.rotation(beam, at)

    def strains(self, q: Array) -> Strains:
        """Strains of the beam, and the springs' stretches."""
        beam, root = self._split(q)
        return self.inner.strains(beam)._replace(root=root)

    def sampled(self, at: Any) -> RootedField:
        """The field at some of the points."""
        return replace(self, inner=self.inner.sampled(at), x=self.x[at])

    @property
    def cumulates(self) -> bool:
        """The positions are no plain sums of nodal vectors."""
        return False

    @property
    def linear_strains(self) -> bool:
        """Whether the strains are linear in q: those of the inner field."""
        return self.inner.linear_strains

    def strain_slopes(self) -> Strains:
        """Derivatives of the strains at the straight beam, (g, n) each; the springs' (springs, n)."""
        xp = namespace(self.x, self.inner.cumulative)
        springs = self.move.shape[1]
        inner = self.inner.strain_slopes()
        axial, about_y, about_z = (xp.pad(part, ((0, 0), (0, springs))) for part in inner[:3])
        return Strains(axial, about_y, about_z, xp.eye(springs, axial.shape[1], k=axial.shape[1] - springs))

    def places(self) -> Places:
        """Taylor polynomial of the positions."""
        xp = namespace(self.x, self.inner.cumulative)
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
        xp = namespace(self.x, self.inner.cumulative)
        inner, springs = self.inner.turns(), self.move.shape[1]
        points, _, _, n = inner.first.shape
        first = xp.pad(xp.broadcast_to(self.turn, (points, 3, springs)), ((0, 0), (0, 0), (n, 0)))
        root = exponential(first, xp.zeros((points, 3, n + springs, n + springs)))
        padded = Turns(
            xp.pad(inner.first, ((0, 0),) * 3 + ((0, springs),)),
            xp.pad(inner.second, ((0, 0),) * 3 + ((0, springs),) * 2),
        )
        return root.after(padded)
