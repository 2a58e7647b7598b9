"""Bodies that the beam carries: point masses and small rigid bodies."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from gbeam.arrays.namespace import is_jax, namespace
from gbeam.arrays.tree import Value
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import positive


@typed
@dataclass(frozen=True, eq=False)
class PointMass(Value):
    """A mass, or a small rigid body, fixed to the beam.

    Parameters
    ----------
    at : float
        Position from the root, m.
    mass : float
        kg.
    inertia : tuple of float
        Principal moments of inertia about its centre, axes of the section (x, y, z), kg m²; zero for a point.
    offset : tuple of float
        Centre of mass from the beam's axis, in axes of the section, m.

    Raises
    ------
    InputError
        If a value is impossible, or the moments break the triangle inequality of a rigid body.
    """

    at: float
    mass: float
    inertia: tuple[float, float, float] = (0.0, 0.0, 0.0)
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        positive("at", self.at, "m", zero=True)
        positive("mass", self.mass, "kg", zero=True)
        for name, values in (("inertia", self.inertia), ("offset", self.offset)):
            if len(values) != 3 or not all(is_jax(v) or math.isfinite(v) for v in values):
                raise InputError(name, f"is {values!r}", "give three finite values, along x, y and z")
        if self._traced:
            return
        for axis, value in zip("xyz", self.inertia, strict=True):
            positive(f"inertia.{axis}", value, "kg m²", zero=True)
        if any(self.inertia) and self.mass == 0:
            raise InputError("mass", "is 0 kg with a moment of inertia", "give the body its mass")
        if min(self.second_moments) < -1e-12 * max(self.inertia):
            raise InputError(
                "inertia",
                f"is {self.inertia!r} kg m²",
                "no moment of a rigid body exceeds the sum of the other two",
            )

    @property
    def second_moments(self) -> tuple[float, float, float]:
        """∫x² dm, ∫y² dm, ∫z² dm about the centre, kg m²."""
        jx, jy, jz = self.inertia
        return (jy + jz - jx) / 2, (jz + jx - jy) / 2, (jx + jy - jz) / 2

    def particles(self) -> tuple[Any, Any]:
        """Equivalent particles: masses (p,) kg and positions (p, 3) m from the beam's axis, in section axes.

        Six particles at ±sqrt(3 S_i/m) along the principal axes have the body's mass, centre and inertia, so that a
        rigid body needs no energy of its own; without inertia one particle is enough.
        """
        xp = namespace(self.mass, *self.inertia, *self.offset)
        centre = xp.asarray(self.offset)
        if not any(is_jax(moment) or moment for moment in self.inertia):
            return xp.reshape(xp.asarray(self.mass), (1,)), centre[None]
        arms = xp.diag(xp.sqrt(3 * xp.maximum(xp.asarray(self.second_moments), 0) / self.mass))
        return xp.full(6, self.mass / 6), centre + xp.concatenate([arms, -arms])

    @property
    def _traced(self) -> bool:
        """Whether a value is JAX's, which has nothing to check."""
        return any(is_jax(value) for value in (self.mass, *self.inertia))
