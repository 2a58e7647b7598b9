"""Flight: the root accelerates as recorded or prescribed; the axes turn only where the record holds body rates."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Self

import numpy as np

from gbeam.arrays.namespace import holds_jax, namespace
from gbeam.arrays.tree import assign, record
from gbeam.arrays.types import Floats, Numbers
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.quantities import Components, Quantity, Seconds, Times
from gbeam.motion.profiles.combine import Turned, as_profile, merged_extent, vector
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

    Raises
    ------
    InputError
        If components and vector are given, or neither, or one has the other's shape, or the scale is not positive.

    Examples
    --------
    >>> turn = gb.Flight(z=gb.trapezoid(78.5, jerk=39.2, start=0.5, hold=1.0))
    >>> turn.base(3.0).a_WO_B
    array([ 0. ,  0. , 78.5])
    """

    kind: ClassVar[str] = "flight"
    unscaled: Profile  # acceleration before the level factor
    rates: Profile | None
    scale: Any

    def __init__(
        self,
        x: Annotated[
            Profile | float | None,
            Quantity("acceleration"),
            "component along x of the root's acceleration, or of specific force",
        ] = None,
        y: Annotated[
            Profile | float | None, Quantity("acceleration"), "component along y; one left out is zero"
        ] = None,
        z: Annotated[Profile | float | None, Quantity("acceleration"), "component along z"] = None,
        *,
        acceleration: Annotated[
            Numbers | Profile | None,
            Quantity("acceleration"),
            Components(
                "An acceleration by components in base axes; those left out are zero.",
                x="profile of the component along the beam",
                y="profile of the component along the width",
                z="profile of the component through the thickness",
            ),
            "the components as one vector profile: { x, y, z }, those left out zero; or record",
        ] = None,
        rates: Annotated[
            Numbers | Profile | None,
            Quantity("angular rate"),
            "angular velocity in base axes, a vector profile without corners; α is its derivative, since the "
            "rate of a vector ω is the same seen from its own axes",
        ] = None,
        scale: Annotated[
            Any,
            Quantity("ratio", "positive"),
            "level factor of a test, such as 1.25: accelerations are flown so many times as large, gravity in a "
            "specific force included, and limits hold for these; body rates are flown as they are given",
        ] = 1.0,
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
            unscaled=load,
            rates=None if rates is None else as_profile("rates", rates, 3),
            scale=scale if holds_jax(scale) else float(scale),
        )

    @property
    def acceleration(self) -> Profile:
        """Acceleration that is flown, base axes, m/s²: the given one times the level factor."""
        if self.level_factor is None and not holds_jax(self.scale):
            return self.unscaled
        return Turned(self.unscaled, self.scale * np.eye(3))

    @property
    def level_factor(self) -> float | None:
        """Level factor, as results state it, or None of a flight at its own level, or where JAX traces it."""
        return None if holds_jax(self.scale) or self.scale == 1 else float(self.scale)

    @property
    def arguments(self) -> dict[str, Any]:
        """Arguments of the constructor by their names, with which the flight is made again."""
        return {"acceleration": self.unscaled, "rates": self.rates, "scale": self.scale}

    @property
    def record(self) -> RecordSummary | None:
        """The record that is flown, or None of a flight that is prescribed."""
        record, level = self.unscaled.record, self.level_factor
        return record if record is None or level is None else record.scaled(level)

    @property
    def free(self) -> bool:
        """False: the motion is prescribed."""
        return False

    def base(self, t: Times) -> Base:
        """Motion of the base at times `t` (s, any shape)."""
        a_WO_B = self.acceleration(t)
        if self.rates is None:
            zero = namespace(a_WO_B).zeros_like(a_WO_B)
            return Base(a_WO_B, zero, zero)
        return Base(a_WO_B, *self.rates.derivatives(t))

    def corners(self, step: Seconds) -> Floats:
        """Times that steps of length `step` (s) should not pass unseen, s, ascending."""
        breaks = self.acceleration.corners(step)
        return breaks if self.rates is None else np.union1d(breaks, self.rates.corners(step))

    @typed
    def over(self, start: Seconds, end: Seconds) -> Self:
        """The flight itself, from `start` to `end` (s): it needs no preparation."""
        return self

    def beyond(self, start: Seconds, end: Seconds) -> tuple[float, float]:
        """Nothing before `start` or after `end` (s): a flight has no spin-up of its own."""
        return 0.0, 0.0

    def part_of(self, start: Seconds, end: Seconds) -> tuple[float, float] | None:
        """First and last time of the whole flight, s, if the times `start` to `end` are only a part; else None.

        The whole of a record is its file's. A part that lacks at most one interval of the record counts as the whole.
        None, too, if the flight has no ends, or if JAX traces it.
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
