"""Protocol of profiles: a quantity prescribed over time, with its derivatives; its smoothing."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gbeam.guards.arguments import refuse_units, typed
from gbeam.guards.checks import positive
from gbeam.guards.limits import KNOTS, refuse_more
from gbeam.numerics.series import Series

if TYPE_CHECKING:
    from gbeam.results.description import RecordSummary

_FOR_EVER = 1e12  # s: knots no nearer than a profile needs them
TOGETHER = 1_000_000  # knots or nodes of the windows around some times: what more would take comes piece by piece
STEPS_PER_EVENT = 4  # a rounded corner or a pulse of so many steps is resolved


class Profile(ABC):
    """A scalar or vector given over time, with its time derivatives in closed form.

    NumPy arrays in, NumPy arrays out; JAX arrays and tracers pass, in the times as in the profile's own values, which
    are the leaves of a pytree: profiles can be traced, mapped and differentiated with respect to them.
    """

    @abstractmethod
    def series(self, t: Any, order: int) -> Series:
        """Value and time derivatives up to `order` at times `t` (s): of the shape of `t`, with a last 3 for a vector.

        Where a derivative jumps, it is the one from the right.
        """

    def __call__(self, t: Any) -> Any:
        """Value at times `t` (s, any shape): of the shape of `t`, with a trailing 3 for a vector."""
        refuse_units("t", t)
        return self.series(t, 0).value

    def derivatives(self, t: Any, order: int = 1) -> tuple[Any, ...]:
        """Value and time derivatives up to `order` at times `t` (s), each like the value."""
        refuse_units("t", t)
        return self.series(t, order).derivatives()

    def integral(self, t: Any) -> Any | None:
        """Integral over time up to times `t` (s), but for a constant; None where it has no closed form here."""
        return None

    @property
    @abstractmethod
    def breaks(self) -> Any:
        """Times (s, ascending) at which a derivative jumps, shape (b,); empty if the third is continuous."""

    def corners(self, step: float) -> NDArray[np.float64]:
        """Times (s, ascending) that steps of length `step` (s) should not pass unseen; breaks are among them."""
        return np.asarray(self.breaks, dtype=np.float64)

    @abstractmethod
    def knots(self, step: float) -> NDArray[np.float64]:
        """Times (s, ascending) between which the profile is straight, or which are `step` apart at most."""

    @property
    def record(self) -> RecordSummary | None:
        """The flight's record that it is, perhaps with its corners rounded; None of any other profile."""
        return None

    @property
    def extent(self) -> tuple[float, float] | None:
        """First and last time of what it prescribes, s, whatever rounds its corners; None if it is constant."""
        times = self.knots(_FOR_EVER)
        return (float(times[0]), float(times[-1])) if times.size > 1 else None

    def smoothed(self, width: Any) -> Profile:
        """The profile convolved with the Hann kernel (1 + cos 2πt/W)/W on abs(t) < W/2, W = `width` s.

        By quadrature, but for profiles that know a better way.
        """
        from gbeam.motion.profiles.convolution import Convolved  # itself a profile

        return Convolved(self, width)


@typed
def smoothed(profile: Profile, width: Any) -> Profile:
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

    Examples
    --------
    >>> ramp = gb.smoothed(gb.trapezoid(50.0, jerk=25.0, hold=2.0), width=0.2)
    >>> print(f"{ramp.derivatives(0.0, 0)[0]:.4f}")
    0.3717
    """
    return profile.smoothed(positive("smoothing", width, "s"))


def rounded_corners(corners: Any, width: float, step: float) -> NDArray[np.float64]:
    """Corners that a kernel rounds: none where steps resolve its `width`, else no nearer than they then would be."""
    apart, times = float(width) / STEPS_PER_EVENT, np.asarray(corners, dtype=np.float64)
    if apart >= step or not times.size:
        return times[:0]
    return np.asarray(times[0] + apart * np.unique(np.round((times - times[0]) / apart)))


def sampled(start: float, end: float, step: float) -> NDArray[np.float64]:
    """Evenly spaced times from `start` to `end`, s, no further apart than `step`; InputError if they are too many."""
    count = np.ceil((end - start) / step)
    fix = f"give {KNOTS * step:.3g} s or less, or smooth over more time"
    refuse_more("", f"knots over {end - start:.4g} s", count, KNOTS, 4000.0, fix)
    return np.linspace(start, end, int(count) + 1)


class Rounded(Profile):
    """A profile convolved with a kernel of some width, s, whose times are those of the sharp one."""

    width: Any

    @property
    @abstractmethod
    def sharp(self) -> Profile:
        """The profile that is rounded."""

    @property
    def breaks(self) -> Any:
        """None: the third derivative is continuous."""
        return self.sharp.breaks[:0]

    def corners(self, step: float) -> NDArray[np.float64]:
        """Corners of the sharp profile, s, where steps are long beside the width."""
        return rounded_corners(self.sharp.corners(step), self.width, step)

    def knots(self, step: float) -> NDArray[np.float64]:
        """Times, s, no further apart than `step` within half a width of the sharp profile's knots."""
        half, inner = float(self.width) / 2, self.sharp.knots(step)
        return sampled(float(inner[0]) - half, float(inner[-1]) + half, step)

    @property
    def record(self) -> RecordSummary | None:
        """The flight's record that the sharp profile is, if it is one."""
        return self.sharp.record

    @property
    def extent(self) -> tuple[float, float] | None:
        """First and last time of the sharp profile, s."""
        return self.sharp.extent
