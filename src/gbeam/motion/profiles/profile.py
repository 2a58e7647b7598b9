"""What a profile is: a quantity prescribed over time; and the two ways of combining profiles."""

from __future__ import annotations

from abc import abstractmethod

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, ArrayLike, Float
from numpy.typing import NDArray

import gbeam.arrays.jax_setup  # noqa: F401
from gbeam.checks import positive
from gbeam.errors import InputError


class Profile(eqx.Module):
    """A scalar or vector given over time; elementwise in time, it can be traced, mapped and differentiated.

    Its arrays are leaves: two scenarios that differ in numbers only share one compiled function.
    """

    @abstractmethod
    def __call__(self, t: ArrayLike) -> Float[Array, "*t"]:
        """Value at times `t` (s, any shape): of the shape of `t`, with a trailing 3 for a vector."""

    @property
    @abstractmethod
    def breaks(self) -> Float[Array, " b"]:
        """Times (s, ascending) at which a derivative jumps; empty if the third is continuous."""

    @abstractmethod
    def knots(self, step: float) -> NDArray[np.float64]:
        """Times (s, ascending) between which the profile is straight, or which are `step` apart at most."""

    @abstractmethod
    def smoothed(self, width: float) -> Profile:
        """The profile convolved with the Hann kernel (1 + cos 2πt/W)/W on abs(t) < W/2, W = `width` s."""


def smoothed(profile: Profile, width: float) -> Profile:
    """Round the corners of a profile: its convolution with a Hann kernel, three times differentiable.

    Parameters
    ----------
    profile : Profile
    width : float
        Full width W of the kernel (1 + cos 2πt/W)/W, s.

    Returns
    -------
    Profile
        Of the same unit and shape; equal to `profile` where that is straight within W/2 either side.

    Raises
    ------
    InputError
        If the width is not positive and finite.
    """
    return profile.smoothed(positive("smoothing", width, "s"))


def sampled(start: float, end: float, step: float) -> NDArray[np.float64]:
    """Evenly spaced times from `start` to `end`, s, no further apart than `step`."""
    return np.linspace(start, end, int(np.ceil((end - start) / step)) + 1)


class Sum(Profile):
    """Sum of profiles of the same unit.

    Parameters
    ----------
    parts : tuple of Profile
        One or more, all scalar or all vectors.

    Raises
    ------
    InputError
        If there is no part.
    """

    parts: tuple[Profile, ...]

    def __check_init__(self) -> None:
        if not self.parts:
            raise InputError("parts", "is empty", "list one profile or more")

    def __call__(self, t: ArrayLike) -> Float[Array, "*t"]:
        """Value at times `t` (s)."""
        return jnp.sum(jnp.stack([part(t) for part in self.parts]), axis=0)

    @property
    def breaks(self) -> Float[Array, " b"]:
        """Times of the parts' jumps, s."""
        return jnp.sort(jnp.concatenate([part.breaks for part in self.parts]))

    def knots(self, step: float) -> NDArray[np.float64]:
        """Union of the parts' knots, s."""
        return np.unique(np.concatenate([part.knots(step) for part in self.parts]))

    def smoothed(self, width: float) -> Profile:
        """Convolution is linear: the sum of the smoothed parts."""
        return Sum(tuple(part.smoothed(width) for part in self.parts))


class Stack(Profile):
    """A vector profile made of three scalar ones; see :func:`stack`."""

    parts: tuple[Profile, Profile, Profile]

    def __call__(self, t: ArrayLike) -> Float[Array, "... 3"]:
        """Vector at times `t` (s)."""
        return jnp.stack([part(t) for part in self.parts], axis=-1)

    @property
    def breaks(self) -> Float[Array, " b"]:
        """Times of the components' jumps, s."""
        return jnp.sort(jnp.concatenate([part.breaks for part in self.parts]))

    def knots(self, step: float) -> NDArray[np.float64]:
        """Union of the components' knots, s."""
        return np.unique(np.concatenate([part.knots(step) for part in self.parts]))

    def smoothed(self, width: float) -> Profile:
        """Component by component."""
        x, y, z = (part.smoothed(width) for part in self.parts)
        return Stack((x, y, z))
