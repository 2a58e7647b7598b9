"""The inverses by name, and how each is built; one that must solve or plan ahead does so in its builder."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from gbeam.motion.centrifuge.ends import Ends
from gbeam.motion.centrifuge.inverses.closed_form import Flat, Geometry, Inverse, QuasiStatic
from gbeam.motion.centrifuge.inverses.exact import exact, unfollowable
from gbeam.motion.centrifuge.inverses.planned import planned
from gbeam.motion.centrifuge.limits import Limits
from gbeam.motion.centrifuge.target.target import Target


class Method(NamedTuple):
    """Method by which an inverse is built.

    Parameters
    ----------
    build : callable
        Of target, geometry, limits and ends; an inverse that plans its own ends says so by its `extent`.
    follows_corners : bool
        Whether it can follow corners of a load that does not turn.
    solved : bool
        Whether it is solved for numerically, and so needs numbers.
    leaves_out : callable, optional
        Of target and geometry: stretches, s, that it cannot follow and that the target is to leave out.
    plans : bool
        Whether it plans for any load within the limits, which takes a second: it is done where the motion is needed.
    """

    build: Callable[[Target, Geometry, Limits, Ends], Inverse]
    follows_corners: bool
    solved: bool
    leaves_out: Callable[[Target, Geometry], list[tuple[float, float]]] | None = None
    plans: bool = False


INVERSES: dict[str, Method] = {
    "quasi-static": Method(lambda target, geometry, limits, ends: QuasiStatic(geometry), True, False),
    "flat": Method(lambda target, geometry, limits, ends: Flat(geometry), False, False),
    "exact": Method(lambda target, geometry, limits, ends: exact(target, geometry), False, True, unfollowable),
    "planned": Method(planned, True, True, plans=True),
}
