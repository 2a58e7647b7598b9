"""The inverses by name, and how each is built; one that must solve or plan ahead does so in its builder."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from gbeam.motion.exact import exact
from gbeam.motion.inverse import Flat, Geometry, Inverse, QuasiStatic
from gbeam.motion.limits import Limits
from gbeam.motion.planned import planned
from gbeam.motion.target import Target


class Method(NamedTuple):
    """How to build an inverse, and whether it can follow corners of a load that does not turn."""

    build: Callable[[Target, Geometry, Limits], Inverse]
    follows_corners: bool


INVERSES: dict[str, Method] = {
    "quasi-static": Method(lambda target, geometry, limits: QuasiStatic(geometry), True),
    "flat": Method(lambda target, geometry, limits: Flat(geometry), False),
    "exact": Method(lambda target, geometry, limits: exact(target, geometry), False),
    "planned": Method(planned, False),
}
