"""A profile that is a uniform quintic spline, as commands are designed."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from gbeam.arrays.namespace import as_array, namespace
from gbeam.arrays.tree import assign, record
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import array, finite, positive
from gbeam.motion.profiles.profile import Profile, sampled
from gbeam.numerics.bspline import DEGREE, PIECE, Spline
from gbeam.numerics.series import Series


@typed
@record
class SplineProfile(Profile):
    """A uniform quintic B-spline over a duration; constant before and after, four times continuously differentiable.

    Parameters
    ----------
    duration : float
        s.
    coefficients : (k,)
        Of the basis functions, k − 5 pieces; the first five alike, and the last five: the values before and after.
    start : float
        s.

    Raises
    ------
    InputError
        If a number is impossible, there are fewer than eleven coefficients, or the ends differ.

    Examples
    --------
    >>> import numpy as np
    >>> slew = gb.SplineProfile(2.0, np.repeat([0.0, 3.0], [6, 6]))
    >>> print(f"{slew.derivatives(1.0, 0)[0]:.4f}")
    1.5000
    """

    duration: Any
    coefficients: Any
    start: Any = 0.0

    def __post_init__(self) -> None:
        coefficients = array("coefficients", self.coefficients)
        if coefficients.ndim != 1 or len(coefficients) < 2 * DEGREE + 1:
            raise InputError("coefficients", f"have the shape {coefficients.shape}", "give eleven or more in a row")
        assign(
            self,
            duration=as_array(positive("duration", self.duration, "s")),
            coefficients=coefficients,
            start=as_array(finite("start", self.start)),
        )

    def series(self, t: Any, order: int) -> Series:
        since = as_array(t) - self.start
        xp = namespace(since, self.coefficients)
        spline = Spline(0.0, self.duration / (self.coefficients.shape[0] - DEGREE), self.coefficients[:, None])
        inside = spline.series(xp.clip(since, 0.0, self.duration), order)
        beyond = (since < 0) | (since > self.duration)
        first, *rest = (each[..., 0] for each in inside.coefficients)
        return Series((first, *(xp.where(beyond, 0.0, each) for each in rest)))

    @property
    def breaks(self) -> Any:
        """None: the fourth derivative is continuous."""
        return np.empty(0)

    def corners(self, step: float) -> NDArray[np.float64]:
        """Start and end, s, and the ends of the pieces where these are of few steps."""
        pieces = len(self.coefficients) - DEGREE
        short = float(self.duration) / pieces < PIECE * step
        return np.asarray(self.start + self.duration * np.linspace(0, 1, 1 + (pieces if short else 1)))

    def knots(self, step: float) -> NDArray[np.float64]:
        """Times over the duration, s, no further apart than `step`."""
        return sampled(float(self.start), float(self.start + self.duration), step)


def through(duration: float, time: Any, values: Any, pieces: int) -> SplineProfile:
    """The spline nearest to values at times from 0 to the duration (s), which begin and end flat."""
    basis = Spline(0.0, duration / pieces, np.eye(pieces + DEGREE))(time)
    ends = np.zeros(pieces + DEGREE)
    ends[:DEGREE], ends[-DEGREE:] = values[0], values[-1]
    inner, *_ = np.linalg.lstsq(basis[:, DEGREE:-DEGREE], values - basis @ ends, rcond=None)
    ends[DEGREE:-DEGREE] = inner
    return SplineProfile(duration, ends)
