"""The last guard of a target: smooth, and idle wherever the load can be reached."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from gbeam.arrays.namespace import as_array, is_traced
from gbeam.arrays.tree import assign, record
from gbeam.motion.profiles.convolution import Convolved
from gbeam.motion.profiles.hann import soft_floor
from gbeam.motion.profiles.profile import Profile
from gbeam.numerics.series import Series, sqrt, square, stack, where


@record
class LoadFloor(Profile):
    """A load kept above a floor across the beam, so that the gimbals stay clear of their singular attitude.

    Rounding and bridging can cut below what each knot keeps. Where the load across the beam is above
    floor + band/2, this changes nothing.

    Parameters
    ----------
    load : Profile
        Vector, m/s².
    floor, band : float
        m/s²; see :func:`gbeam.motion.profiles.hann.soft_floor`.
    """

    load: Profile
    floor: Any
    band: Any

    def __post_init__(self) -> None:
        assign(self, floor=as_array(self.floor), band=as_array(self.band))

    def series(self, t: Any, order: int) -> Series:
        """Load at times `t` (s), m/s²."""
        load = self.load.series(t, order)
        size2 = square(load[..., 1:])
        free = size2.value > (self.floor + self.band / 2) ** 2
        if not is_traced(free) and free.all():
            return load
        size = sqrt(where(size2.value > 0, size2, 1.0))  # the root has no derivative at zero
        lift = soft_floor(size, self.floor, self.band) / size
        return load * stack([0.0 * lift + 1.0, lift, lift])

    @property
    def breaks(self) -> Any:
        """Those of the load, s."""
        return self.load.breaks

    def knots(self, step: float) -> NDArray[np.float64]:
        """Those of the load, s."""
        return self.load.knots(step)

    def smoothed(self, width: Any) -> Profile:
        """By quadrature."""
        return Convolved(self, width)
