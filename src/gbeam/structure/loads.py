"""Loads on the beam: forces and moments at a station or along the length, dead or following the section."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gbeam.arrays.namespace import is_jax
from gbeam.arrays.tree import Value
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import array, positive

if TYPE_CHECKING:
    from gbeam.motion import Profile


@typed
@dataclass(frozen=True, eq=False)
class Load(Value):
    """A force and a moment at a station, or per length along the whole beam.

    Parameters
    ----------
    at : float or None
        Position from the root, m; None spreads the load evenly over the length.
    force, moment : sequence of three floats, or vector Profile of time, or None
        N and N m; N/m and N m/m where spread. Along x, y, z of the base axes, which a dead load keeps.
    follower : bool
        Whether the axes are those of the section, with which a following load turns.

    Raises
    ------
    InputError
        If the position is impossible, a component is not finite, or there is neither force nor moment.
    """

    at: float | None = None
    force: Sequence[float] | Profile | None = None
    moment: Sequence[float] | Profile | None = None
    follower: bool = False

    def __post_init__(self) -> None:
        if self.at is not None:
            positive("at", self.at, "m", zero=True)
        if self.force is None and self.moment is None:
            raise InputError("", "has neither force nor moment", "give one of them, or both")
        for name, value in (("force", self.force), ("moment", self.moment)):
            if value is None or callable(value):
                continue
            components = array(name, value)
            if components.shape != (3,) or not (is_jax(components) or np.isfinite(components).all()):
                raise InputError(name, f"is {value!r}", "give three finite components, along x, y and z, or a profile")
