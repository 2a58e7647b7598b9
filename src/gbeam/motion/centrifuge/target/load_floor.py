"""The last guard of a target: smooth, and idle wherever the load can be reached."""

from __future__ import annotations

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, ArrayLike, Float
from numpy.typing import NDArray

from gbeam.motion.profiles.convolution import Convolved
from gbeam.motion.profiles.hann import soft_floor
from gbeam.motion.profiles.profile import Profile


class Lifted(Profile):
    """A load kept above a floor across the beam, so that the gimbals stay clear of their singular attitude.

    Rounding and bridging can cut below what each knot keeps. Where the load across the beam is above
    floor + band/2, this changes nothing.

    Parameters
    ----------
    load : Profile
        Vector, m/s².
    floor, band : array
        m/s²; see :func:`gbeam.motion.hann.soft_floor`.
    """

    load: Profile
    floor: Float[Array, ""]
    band: Float[Array, ""]

    def __call__(self, t: ArrayLike) -> Float[Array, "... 3"]:
        """Load at times `t` (s), m/s²."""
        load = self.load(t)
        size2 = jnp.sum(load[..., 1:] ** 2, axis=-1, keepdims=True)
        size = jnp.sqrt(jnp.where(size2 > 0, size2, 1.0))  # sqrt has no derivative at zero
        lift = soft_floor(size, self.floor, self.band) / size
        return load * jnp.concatenate([jnp.ones_like(lift), lift, lift], axis=-1)

    @property
    def breaks(self) -> Float[Array, " b"]:
        """Those of the load, s."""
        return self.load.breaks

    def knots(self, step: float) -> NDArray[np.float64]:
        """Those of the load, s."""
        return self.load.knots(step)

    def smoothed(self, width: float) -> Profile:
        """By quadrature."""
        return Convolved(self, width)
