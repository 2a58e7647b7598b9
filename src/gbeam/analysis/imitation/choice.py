"""What a placement may choose beside the control point: mounting and width of smoothing."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.motion.centrifuge.centrifuge import MOUNTINGS, Centrifuge
from gbeam.motion.centrifuge.inverses.registry import INVERSES
from gbeam.numerics.solvers.bounded_search import coarse

_FACTOR = 4.0  # of the centrifuge's own smoothing, either way


@typed
@dataclass(frozen=True)
class Choice:
    """What may be chosen beside the control point.

    Parameters
    ----------
    make : callable
        Of mounting and width of smoothing, s: a centrifuge that tracks the flight; InputError where it cannot.
    mountings : tuple of str
        The scenario's own first.
    widths : tuple of float
        Tried with every mounting, ascending, s.
    refined : bool
        Whether to search on between the best of them and its neighbours.
    limited : bool
        Whether the machine's limits must be kept.
    """

    make: Callable[[str, float], Centrifuge]
    mountings: tuple[str, ...]
    widths: tuple[float, ...]
    refined: bool = True
    limited: bool = True


@dataclass(frozen=True)
class Altered:
    """A centrifuge with another mounting and width of smoothing."""

    centrifuge: Centrifuge

    def __call__(self, mounting: str, width: float) -> Centrifuge:
        """Return the centrifuge itself where both are its own: it need not be planned again."""
        same = mounting == self.centrifuge.mounting and width == width_of(self.centrifuge)
        return self.centrifuge if same else self.centrifuge.altered(mounting=mounting, smoothing=width)


def width_of(centrifuge: Centrifuge) -> float:
    """Width of the smoothing of its target, s; zero where there is none."""
    return float(centrifuge.smoothing or 0.0)


@typed
def choice_of(centrifuge: Centrifuge, smoothing: Sequence[float] = (), *, limited: bool = True) -> Choice:
    """Both mountings of a centrifuge, its own first, and widths of smoothing.

    Parameters
    ----------
    centrifuge : Centrifuge
        Prepared for the times that are looked at.
    smoothing : sequence of float
        Width of the kernel to keep, s, or the two ends of a range; without it from a quarter to four times the
        centrifuge's own, or, where the axis motions are planned within the limits and need no smoothing, its own.
    limited : bool
        Whether the machine's limits must be kept.

    Raises
    ------
    InputError
        If there are more than two widths, or one of two is not positive.
    """
    if len(smoothing) > 2:
        raise InputError("smoothing", f"is given {len(smoothing)} times", "give one width, or the ends of a range")
    if len(smoothing) == 2 and min(smoothing) <= 0:
        raise InputError("smoothing", f"is {min(smoothing):g} s", "give two positive widths")
    own = width_of(centrifuge)
    searched = [own] if INVERSES[centrifuge.method].plans else [own / _FACTOR, own * _FACTOR]
    ends = sorted(smoothing) or searched
    widths = coarse(ends[0], ends[-1])

    others = tuple(name for name in MOUNTINGS if name != centrifuge.mounting)
    return Choice(Altered(centrifuge), (centrifuge.mounting, *others), widths, len(widths) > 1, limited)
