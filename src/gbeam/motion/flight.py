"""Flight: the root accelerates as recorded or prescribed; the axes turn only where the record holds body rates."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np

from gbeam.arrays.namespace import holds_jax, namespace
from gbeam.arrays.tree import assign, record
from gbeam.arrays.types import Floats
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.motion.profiles.combine import as_profile, merged_extent, vector
from gbeam.motion.profiles.piecewise import PiecewiseLinear
from gbeam.motion.profiles.profile import Profile, smoothed
from gbeam.results.parts import Base

if TYPE_CHECKING:
    from gbeam.results.description import RecordSummary

_ROUNDING = 1e-6


@typed
@record
class Flight:
    """A base in flight: in translation (ω = α = 0), or turning at given body rates.

    Parameters
    ----------
    x, y, z : Profile or float, optional
        Components of the root's acceleration, or specific force, in base axes, m/s²; one left out is zero.
    acceleration : Profile, optional
        The same as one vector profile, such as a record, in place of x, y and z.
    rates : Profile, optional
        Vector profile: angular velocity in base axes, rad/s, without corners; α is its derivative, since the rate of a
        vector ω is the same seen from its own axes.

    Raises
    ------
    InputError
        If components and vector are given, or neither, or one has the other's shape.

    Examples
    --------
    >>> turn = gb.Flight(z=gb.trapezoid(78.5, jerk=39.2, start=0.5, hold=1.0))
    >>> turn.base(3.0).a_WO_B
    array([ 0. ,  0. , 78.5])
    """

    kind: ClassVar[str] = "flight"
    acceleration: Profile
    rates: Profile | None

    def __init__(
        self,
        x: Profile | Any | None = None,
        y: Profile | Any | None = None,
        z: Profile | Any | None = None,
        *,
        acceleration: Profile | Any | None = None,
        rates: Profile | Any | None = None,
    ) -> None:
        components = [name for name, value in (("x", x), ("y", y), ("z", z)) if value is not None]
        if acceleration is None and not components:
            raise InputError("acceleration", "is missing", "give x, y or z, or acceleration")
        if acceleration is not None and components:
            raise InputError(
                components[0], "is given beside acceleration", "keep the components or the vector, not both"
            )
        load = vector(x, y, z) if acceleration is None else as_profile("acceleration", acceleration, 3)
        assign(
            self,
            acceleration=load,
            rates=None if rates is None else as_profile("rates", rates, 3),
        )

    @property
    def arguments(self) -> dict[str, Any]:
        """Arguments of the constructor by their names, with which the flight is made again."""
        return {"acceleration": self.acceleration, "rates": self.rates}

    @property
    def record(self) -> RecordSummary | None:
        """The record that is flown; None of a flight that is prescribed."""
        return self.acceleration.record

    @property
    def free(self) -> bool:
        """False: the motion is prescribed."""
        return False

    def base(self, t: Any) -> Base:
        """Motion of the base at times `t` (s, any shape)."""
        a_WO_B = self.acceleration(t)
        if self.rates is None:
            zero = namespace(a_WO_B).zeros_like(a_WO_B)
            return Base(a_WO_B, zero, zero)
        return Base(a_WO_B, *self.rates.derivatives(t))

    def corners(self, step: float) -> Floats:
        """Times that steps of length `step` (s) should not pass unseen, s, ascending."""
        breaks = self.acceleration.corners(step)
        return breaks if self.rates is None else np.union1d(breaks, self.rates.corners(step))

    @typed
    def over(self, start: float, end: float) -> Self:
        """The flight itself, from `start` to `end` (s): it needs no preparation."""
        return self

    def beyond(self, start: float, end: float) -> tuple[float, float]:
        """Nothing before `start` or after `end` (s): a flight has no spin-up of its own."""
        return 0.0, 0.0

    def part_of(self, start: float, end: float) -> tuple[float, float] | None:
        """First and last time of the whole flight, s, of which the times from `start` to `end` are a part.

        The whole of a record is its file's. None if at most an interval of the record is left out, if the flight has
        no ends, or if JAX traces it.
        """
        if holds_jax(self):
            return None
        if self.record is not None:
            (first, last), slack = self.record.whole, (1 + _ROUNDING) / self.record.read.rate
        else:
            extent = merged_extent(*(profile for profile in (self.acceleration, self.rates) if profile is not None))
            if extent is None:
                return None
            (first, last), slack = extent, _ROUNDING * (extent[1] - extent[0])
        left_out = start > first + slack or end < last - slack
        return (min(start, first), max(end, last)) if left_out else None


def body_rates(recorded: PiecewiseLinear, smoothing: float = 0.0) -> Profile:
    """Return recorded body rates without corners, ready to be differentiated."""
    times = recorded.times
    interval = float(times[-1] - times[0]) / max(times.size - 1, 1)
    return smoothed(recorded, max(smoothing, 4 * interval))
