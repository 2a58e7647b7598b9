"""The response of one body: how it deforms relative to its root, and what it carries."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gbeam.arrays.types import Numbers
from gbeam.constants import BY_STRAINS
from gbeam.errors import InputError
from gbeam.guards.checks import index_of
from gbeam.results.declared import INSIDE, declared, fact, internal, part, quantity
from gbeam.results.parts import Base, Influence, Loads, Outline, Peaks, Supports, VectorPeaks, judged_point
from gbeam.results.result import Floats, Part
from gbeam.results.solids import SolidStress, SpecimenLoads, Surface


@dataclass(frozen=True, repr=False, eq=False)
class BodyResponse(Part):
    """One body that deforms, or a rigid specimen, over time, in axes of its root."""

    json_rows: ClassVar[dict[str, str]] = {"station": "stations"}

    model: str = fact("kind of the model")
    base: Base = part("motion of its root", "time")
    stations: Floats = quantity(
        "m", "position along the body from the root", "station", role="coordinate", key="at", note="the last is the tip"
    )
    displacement: Floats = quantity("m", "displacement relative to the root", "time station axis")
    q: Floats = internal(
        lambda self: "" if self.model in BY_STRAINS else "m",
        "generalised coordinates of the body",
        "time coordinate",
        note="of the exact model and that of fourth order angles and strains; in files they are the system's",
    )
    qd: Floats = internal(
        lambda self: "1/s" if self.model in BY_STRAINS else "m/s",
        "rates of the generalised coordinates",
        "time coordinate",
    )
    peaks: Peaks = part("largest values between all steps", key=INSIDE)
    points: tuple[str, ...] = quantity(
        "", "name of the station", "station", name="station_name", key="name", optional=True,
        note="tip, that of a point of the body, or its position", default=(),
    )  # fmt: skip
    qdd: Floats = internal("", "accelerations of the coordinates", "time coordinate", empty=True)
    acceleration: Floats | None = quantity(
        "m/s^2", "absolute acceleration of the stations", "time station axis",
        note="specific force where gravity acts; None without loads", name="station_acceleration", default=None,
    )  # fmt: skip
    loads: Loads | None = part("internal loads at the root and the stations", key=None, default=None)
    frequencies: Floats = internal("rad/s", "natural frequencies, the root held", "mode", note="ascending", empty=True)
    damping_ratio: float | tuple[float, ...] = fact(
        "modal damping ratio", note="of the modes of the body on a root at rest", default=math.nan
    )
    shapes: Mapping[str, int] | None = fact(
        "numbers of shapes of a beam's model, by strain", optional=True, note="None of other bodies", default=None
    )
    influence: Influence | None = internal(
        "", "static answer to acceleration fields", note="of a straight beam on a centrifuge", default=None
    )
    outline: Outline | None = part(
        "shape of a beam at some of the times, and what carries it", key=None, note="None of other bodies", default=None
    )
    supports: Supports | None = part(
        "places at which the body is held, for pictures", name="holder_", key=None, note="None without supports",
        default=None,
    )  # fmt: skip
    solid: SolidStress | None = part("stress of a solid", name="solid_", key="solid", optional=True, default=None)
    surface: Surface | None = part("surface of a solid, for pictures", name="surface_", key=None, default=None)
    specimen: SpecimenLoads | None = part(
        "loads of a rigid specimen", name="specimen_", key="specimen", optional=True, default=None
    )

    @declared("", "station that moves farthest, where supports hold the tip", role="fact", name=None, optional=True)
    def farthest(self) -> str:
        """Name of the station by which the body is judged where supports hold its tip,
        or empty where that is the tip.
        """
        peaks = self.peaks.displacement
        if self.loads is None or self.loads.supports is None or peaks is None:
            return ""
        station = judged_point(peaks.size.value)
        return "" if station == len(self.stations) - 1 else self.points[station]

    @declared(
        "m", "largest displacement of every named point", "point", role="rows", name=None, key="points", optional=True
    )
    def point_peaks(self) -> Mapping[str, VectorPeaks]:
        peaks = self.peaks.displacement
        if peaks is None:
            return {}
        indices = [(k, name) for k, name in enumerate(self.points) if name.isidentifier() and name != "tip"]
        return {name: peaks[k] for k, name in indices}

    @property
    def tip(self) -> Floats:
        """Displacement of the tip relative to the root, (t, 3) m."""
        return self.displacement[:, -1]

    @property
    def bends(self) -> bool:
        """True of a body that is drawn along its length: it is neither a mesh nor a rigid specimen."""
        return self.solid is None and self.specimen is None

    def at(self, point: str) -> Floats:
        """Return the displacement of a named point relative to the root, (t, 3) m.

        Parameters
        ----------
        point : str
            tip, or the name of another point of the body.

        Raises
        ------
        InputError
            If there is no such point.
        """
        return self.displacement[:, index_of("point", point, self.points)]

    @property
    def signals(self) -> tuple[str, ...]:
        """Names of vectors of which :meth:`signal` returns components."""
        return (*self.points, "root_force", "root_moment")

    def lines(self, time: Floats) -> tuple[str, ...]:
        """Peak of the tip over the response's times (t,) s, or the loads of a rigid specimen, in words."""
        if self.specimen is not None:
            return tuple(self.specimen.lines)
        axis = int(np.argmax(self.peaks.max_abs))
        return (
            f"tip up to {1e3 * self.peaks.max_abs[axis]:.4g} mm along {'xyz'[axis]}, "
            f"at {self.peaks.time_of_max[axis]:.4g} s of {time[0]:.4g} to {time[-1]:.4g} s",
        )

    def signal(self, name: str) -> Floats:
        """Return a component of a displacement or of the root's load by its name, (t,) SI.

        Parameters
        ----------
        name : str
            ``tip.x`` or that of another named point; ``root_force.x``, ``root_moment.x``, NaN without loads.

        Raises
        ------
        InputError
            If there is no such signal.
        """
        owner, _, component = name.rpartition(".")
        axis = index_of("name", component, ("x", "y", "z"))
        if owner not in ("root_force", "root_moment"):
            return self.at(owner)[:, axis]
        if self.loads is None:
            return np.full(len(self.displacement), np.nan)
        return np.asarray(getattr(self.loads, owner)[:, axis])

    def strain_at(self, point: str, along: Numbers = (1.0, 0.0, 0.0)) -> Floats:
        """Return what a strain gauge at a named point of a solid reads, (t,).

        Parameters
        ----------
        point : str
            A node with a name, or an interface, whose strain is the mean of its nodes'.
        along : (3,)
            Direction of its grid, in axes of the point.

        Raises
        ------
        InputError
            If it is no solid with loads, or has no such point.
        """
        if self.solid is None:
            raise InputError("response", "has no stress of a solid", "simulate a mesh, with loads = true")
        return self.solid.strain_at(point, along)
