"""The load that a machine follows, the stretches in which it is not the flight's, and the nearest loads that gimbals
can follow.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gbeam.arrays.namespace import as_array, is_traced, namespace
from gbeam.arrays.tree import assign, record, static
from gbeam.arrays.types import Flags, Floats
from gbeam.guards.quantities import Seconds, Times
from gbeam.motion.profiles.combine import merged_breaks
from gbeam.motion.profiles.profile import Profile, append_axes, soft_floor, soft_step
from gbeam.numerics.samples import true_runs
from gbeam.numerics.series import Series, sin_cos, sqrt, square, stack, where

REASONS = ("below idle", "gimbals", "left out")
BELOW_IDLE, GIMBALS, LEFT_OUT = range(len(REASONS))

_TOUCH = 1e-9  # s
IDLE_BAND = 0.2  # of idle: how softly the hold sets in, by at most 1.5 % of idle
REACH_BAND = 0.1  # of the least load across the beam: likewise

Row = tuple[float, float, float, float]  # start s, end s, number of the reason, the flight's largest load m/s²


def stretches(times: Floats, reasons: NDArray[np.int64], size: Floats, reach: Floats, flight: Profile) -> list[Row]:
    """Stretches of time in which the target is not the flight's load, by their start.

    `reasons` (k,) numbers the reason at each knot, of `REASONS`. An edge of a stretch lies where `size` or `reach`,
    (k,) m/s², passes zero: the load's excess over idle, and over the least that the gimbals reach.
    """

    def edge(outside: int, inside: int) -> float:
        """Time at which the reason changes between two neighbouring knots, by linear interpolation."""
        if outside < 0 or outside == times.size:
            return float(times[inside])
        pair = reasons[outside], reasons[inside]
        excess = reach if GIMBALS in pair and BELOW_IDLE not in pair else size
        rise = excess[outside] - excess[inside]
        share = np.clip(-excess[inside] / rise, 0.0, 1.0) if rise != 0 else 1.0
        return float(times[inside] + share * (times[outside] - times[inside]))

    rows: list[Row] = []
    for number in range(len(REASONS)):
        for run in true_runs(reasons == number):
            start, end = edge(run.start - 1, run.start), edge(run.stop, run.stop - 1)
            if end > start:
                loads = flight(np.concatenate([[start], times[run], [end]]))
                rows.append((start, end, float(number), float(np.linalg.norm(loads, axis=1).max())))
    return sorted(rows)


def padded_rows(rows: list[Row]) -> Floats:
    """Rows (8 k, 4), filled up with infinite ones, so that targets share their programs."""
    padded = np.full((8 * (len(rows) // 8 + 1), 4), np.inf)
    padded[: len(rows)] = np.reshape(rows, (-1, 4))
    return padded


def merged_edges(rows: list[Row], last: float) -> Floats:
    """Ascending starts and ends of stretches, s, where those that touch are joined.

    A stretch that lasts until `last`, the end of the span, never ends. The array is filled up with infinite times to a
    multiple of 16: compiled programs see few lengths.
    """
    edges: list[float] = []
    for start, end, *_ in rows:
        if edges and start <= edges[-1] + _TOUCH:
            edges[-1] = max(edges[-1], end)
        else:
            edges += [start, end]
    if edges and edges[-1] >= last:
        edges[-1] = np.inf
    return np.append(edges, np.full(16 * (len(edges) // 16 + 1) - len(edges), np.inf))


@dataclass(frozen=True)
class Episode:
    """A stretch of time in which the target is not the flight's load."""

    start: float  # s
    end: float
    reason: str  # below idle; above it, gimbals (out of their reach) or left out (the inverse cannot follow)
    flight_peak: float  # largest load of the flight in it, m/s²


@record
class Target:
    """Reference load at the control point; built by :func:`gbeam.motion.build_target`."""

    # Vector, base axes, m/s²: specific force where gravity acts, else acceleration. It stands still from half the
    # kernel's width before the span on, and from half of it after.
    load: Profile
    flight: Profile  # the flight's own load, likewise, with its corners
    corners: Profile  # the flight's, standing still beyond the span: what is rounded
    idle: Any  # least load, m/s²; zero if there is none
    gravity: float = static()  # γ, m/s²: 9.80665 or 0
    half_width: Any  # of the kernel that rounds corners, s
    span: tuple[Any, Any]  # the flight's first and last time, s
    # (m, 4): start s, end s, place of the reason in `REASONS` and the flight's largest load m/s² of every stretch in
    # which the target is not the flight's load; unused rows are infinite.
    stretches: Any
    edges: Any  # (2 m,) ascending: where it stops being the flight's load, or is it again, s; unused ones infinite
    rounded: bool = static()  # whether the load has no corners
    turns: bool = static()  # whether its direction, or with gravity its size, changes: the gimbals must move

    def not_followed(self, t: Any) -> Any:
        """Tell at which times `t` (s, any shape) the target is not the flight's load."""
        time = as_array(t)
        xp = namespace(time, self.edges)
        return xp.searchsorted(xp.asarray(self.edges), time, side="right") % 2 == 1

    def episodes(self) -> list[Episode]:
        """Stretches within the span where the load is not the flight's, by start."""
        rows = np.asarray(self.stretches)
        return [
            Episode(float(start), float(end), REASONS[int(code)], float(peak))
            for start, end, code, peak in rows[np.isfinite(rows[:, 0])]
        ]


_DIRECTED = 0.2  # of what counts as a whole load: below, the angle about the beam is not looked at
_POLE = 0.05  # rad from the beam: nearer to it the angle about it would run away
_LEAST_WEIGHT = 1e-3  # of values without a direction: what keeps the path in one piece between them
_CARRIED = 0.2  # rad: how far a slope beside the path may carry it away
_WIDENING = 0.3  # s per s: how its time scale grows from there


def unwrapped(times: Floats, y: Floats, x: Floats, full_load: float) -> tuple[Floats, Floats]:
    """Angle atan2(y, x), rad, of a load over times (k,), s, without jumps, and the weight of the angle at each time.

    `x` and `y` (k,) are components of the load, m/s². The weight is the load's share of `full_load`, at most 1. Where
    the load is too small to have a direction the weight is 0 and the angle is interpolated.
    """
    size = np.hypot(y, x)
    directed = size >= _DIRECTED * full_load
    if not directed.any():
        return np.full(times.size, np.pi / 2), np.zeros(times.size)
    angle = np.unwrap(np.arctan2(y[directed], x[directed]))
    return np.interp(times, times[directed], angle), np.where(directed, np.minimum(size / full_load, 1.0), 0.0)


def off_axis(angle: Floats) -> Floats:
    """Angles from the beam, rad, kept away from its axis."""
    return np.clip(angle, _POLE, np.pi - _POLE)


def gentle(times: Floats, values: Floats, weight: Floats, fixed: Flags, time_scale: float) -> Floats:
    """Replace the values (k,) that are not `fixed` by a smooth path near them, at `times` (k,), s.

    It minimises ∫ w (z − values)² + T⁴ z''² dt with the fixed values kept, so that it leaves and meets them without a
    corner. Changes quicker than a period of 2πT are left out. T is `time_scale`. It is shorter beside fixed values that
    change quickly, since the path would go on with their slope and drift away.
    """
    if fixed.all() or times.size < 4:
        return values
    from scipy.linalg import solve_banded  # imported when a path is sought

    steps_before, steps_after = np.diff(times)[:-1], np.diff(times)[1:]
    stiffness = _time_scales(times, values, fixed, time_scale)[1:-1] ** 2 * np.sqrt((steps_before + steps_after) / 2)
    # Weighted second differences: of each inner knot, by the value before it, at it and after it.
    two_steps = steps_before + steps_after
    second = (
        2
        * stiffness
        * np.stack([1 / (steps_before * two_steps), -1 / (steps_before * steps_after), 1 / (steps_after * two_steps)])
    )
    # The unknowns are, at each knot in turn, the distance z − values and the weighted z''. Normal equations of the
    # distance alone would square z'' and lose all digits where knots are close.
    band, right_side = np.zeros((7, 2 * times.size)), np.zeros(2 * times.size)
    band[3, ::2] = np.where(fixed, 1.0, np.gradient(times) * np.maximum(weight, _LEAST_WEIGHT))
    band[3, 1::2] = -1.0
    rows = times.size - 2
    knots, curvature_rows = 2 * np.arange(times.size), 2 * np.arange(1, rows + 1) + 1
    for i in range(3):
        columns, free = knots[i : i + rows], ~fixed[i : i + rows]
        band[3 + curvature_rows - columns, columns] = second[i] * free
        band[3 + columns - curvature_rows, curvature_rows] = second[i] * free
        right_side[curvature_rows] -= second[i] * values[i : i + rows]
    return np.asarray(values + solve_banded((3, 3), band, right_side)[::2])


def _time_scales(times: Floats, values: Floats, fixed: Flags, longest: float) -> Floats:
    """Time scale T of the path at every knot, s, shorter near fixed values with a slope v: the path goes on by v T."""
    scale = np.full(times.size, longest)
    for run in true_runs(~fixed):
        for edge, inward in ((run.start - 1, -1), (run.stop, 1)):
            outer_edge = edge + inward
            if min(edge, outer_edge) < 0 or max(edge, outer_edge) >= times.size:
                continue
            slope = abs((values[outer_edge] - values[edge]) / (times[outer_edge] - times[edge]))
            allowed = _CARRIED / max(slope, _CARRIED / longest) + _WIDENING * np.abs(times[run] - times[edge])
            scale[run] = np.minimum(scale[run], allowed)
    return scale


# Times idle: where a load is its own size again after the gimbals' reach has raised it, and where its direction is
# wholly its own. Between idle and there the path agrees with it, up to what rounding the path changes.
_SIZED, _FOLLOWED = 1.1, 1.5
_FREE = 1.5  # times the least load across the beam: the same


@record
class NearestLoad(Profile):
    """A flight's load where the machine can make it, else the nearest one that it can.

    - Below idle its size is idle and its direction that of a path.
    - Where gravity acts and the load across the beam is below the least that the gimbals make, that part is the least,
      in the direction of the path, and the part along the beam is kept.

    Three times differentiable in size where the load is. The direction goes over to the path's where they agree.
    """

    flight: Profile  # vector, base axes, m/s², without corners
    path: Profile  # angles, rad, φ = atan2(f_z, f_y) about the beam and β = atan2(hypot(f_y, f_z), f_x) from it
    gate: Profile | None  # one, and zero where the load is held at idle, at whose ends it is below that; None if one
    idle: Any  # least size, m/s²; zero where there is none
    least: Any  # least load across the beam, m/s², likewise
    has_idle: bool = static()
    has_least: bool = static()

    def __post_init__(self) -> None:
        assign(self, idle=as_array(self.idle), least=as_array(self.least))

    def series(self, t: Times, order: int) -> Series:
        time = as_array(t)
        flight = self.flight.series(time, order)
        xp = namespace(time, flight.value, self.idle)
        # The load is the flight's own where `free`; it has a part across the beam, with a direction, where `bent`.
        size2, across2 = square(flight), square(flight[..., 1:])
        free = (size2.value >= (_FOLLOWED * self.idle) ** 2) & (across2.value >= (_FREE * self.least) ** 2)
        gate: Any = 1.0
        if self.gate is not None:
            # A straight ramp between 0 and 1 without its corners: eight times differentiable.
            gate = soft_step(soft_step(self.gate.series(time, order), 0.5, 1.0), 0.5, 1.0)
            free = free & (gate.value == 1)
        if not is_traced(free) and free.all():
            return flight
        bent = across2.value > 0
        lateral = sqrt(where(bent, across2, 1.0))  # the root has no derivative at zero
        unit = [flight[..., k] / lateral for k in (1, 2)]
        lateral = where(bent, lateral, 0.0)
        axial, reached = flight[..., 0], lateral
        share: Any = where(bent, 1.0 + 0.0 * lateral, 0.0)  # of the flight's own direction about the beam
        if self.has_least:
            reached = soft_floor(lateral, self.least, REACH_BAND * self.least)
            share = share * soft_step(lateral, (1 + _FREE) / 2 * self.least, (_FREE - 1) * self.least)
        sine, cosine = sin_cos(self.path.series(time, order))
        if not self.has_idle:
            direction = _blend(share, unit, [cosine[..., 0], sine[..., 0]])
            return stack([axial, *(reached * component for component in direction)])
        size = sqrt(where(size2.value > (self.idle / 2) ** 2, size2, self.idle**2 / 4))
        sized, directed = (
            gate * soft_step(size, (1 + end) / 2 * self.idle, (end - 1) * self.idle) for end in (_SIZED, _FOLLOWED)
        )
        raised_size = self.idle + gate * (soft_floor(size, self.idle, IDLE_BAND * self.idle) - self.idle)
        y, z = _blend(share * directed, unit, [cosine[..., 0], sine[..., 0]])
        x, yz = _blend(directed, [axial / size, lateral / size], [cosine[..., 1], sine[..., 1]])
        if self.has_least:
            full = sqrt(where(bent | (size2.value > 0), axial * axial + reached * reached, 1.0))
            raised_size = raised_size + sized * (full - size)
            # Idle is above the least across the beam, by little where it is lowest.
            band = xp.minimum(REACH_BAND * self.least, self.idle - self.least)
            x, yz = _raise_lateral_load(raised_size * x, raised_size * yz, self.least, band)
        else:
            x, yz = raised_size * x, raised_size * yz
        load = stack([x, yz * y, yz * z])
        return where(xp.asarray(append_axes(free, 1)), flight, load)

    @property
    def breaks(self) -> Any:
        return merged_breaks(self.flight, self.path)

    def corners(self, step: Seconds) -> Floats:
        return np.union1d(self.flight.corners(step), self.path.corners(step))

    def knots(self, step: Seconds) -> Floats:
        return np.union1d(self.flight.knots(step), self.path.knots(step))


def _blend(share: Series, flight: list[Series], path: list[Series]) -> list[Series]:
    """Unit vector along `share` times the flight's plus the rest times the path's."""
    mixed = [share * of_flight + (1 - share) * of_path for of_flight, of_path in zip(flight, path, strict=True)]
    size = sqrt(square(stack(mixed)))
    return [component / size for component in mixed]


def _raise_lateral_load(axial: Series, lateral: Series, least: Any, band: Any) -> tuple[Series, Series]:
    """Raise the load across the beam smoothly to at least `least`, and reduce the load along the beam
    to keep the size.
    """
    raised_part = lateral.value < least + band / 2
    raised = soft_floor(lateral, least, band)
    # Where it is raised the part along the beam is not small: idle is above the least across the beam.
    along_squared, total = axial * axial, axial * axial + lateral * lateral
    remaining_share = where(raised_part, (total - raised * raised) / where(raised_part, along_squared, 1.0), 1.0)
    return axial * sqrt(remaining_share), where(raised_part, raised, lateral)
