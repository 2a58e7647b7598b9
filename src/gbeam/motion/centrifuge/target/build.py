"""From a flight's load to a target that a centrifuge can follow."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Annotated, Any

import numpy as np

from gbeam.arrays.namespace import is_traced
from gbeam.arrays.types import Flags, Floats
from gbeam.constants import STANDARD_GRAVITY
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import positive
from gbeam.guards.limits import KNOTS, refuse_more
from gbeam.guards.quantities import Acceleration, OfKind, Seconds
from gbeam.motion.centrifuge.target.reachability import (
    LEAST_IDLE,
    MIN_TRANSVERSE_LOAD,
    PARTED,
    refuse_far,
    refuse_reversal,
    refuse_singular,
    refuse_undirected,
)
from gbeam.motion.centrifuge.target.target import (
    BELOW_IDLE,
    GIMBALS,
    LEFT_OUT,
    NearestLoad,
    Target,
    gentle,
    merged_edges,
    off_axis,
    padded_rows,
    stretches,
    unwrapped,
)
from gbeam.motion.profiles.combine import clamped
from gbeam.motion.profiles.piecewise import PiecewiseLinear
from gbeam.motion.profiles.profile import Profile, sampled, smoothed
from gbeam.numerics.samples import joined, true_runs

_GRID = 0.01  # s, spacing of knots where a load without smoothing is held
_CURVE, _MOST = 0.002, 100_000  # s, the same along a curved profile; knots along one, unless the kernel needs more
_PER_WIDTH = 12  # knots per width of the smoothing kernel
_WIDEST = 10.0  # times the flight, of the smoothing kernel
_PATH = 0.25  # of the smoothing kernel: what rounds the path
_QUICK = 0.1  # s: time scale of the path where no arm is given
_ROUNDING = 1e-9

Stretches = Sequence[tuple[float, float]]


@typed
def build_target(
    raw: Profile,
    *,
    span: Annotated[tuple[float, float], OfKind("time")],
    idle: Acceleration | None,
    smoothing: Seconds | None,
    gravity: bool,
    arm: Annotated[float | None, OfKind("length")] = None,
    clip: bool = False,
    leave_out: Annotated[Stretches, OfKind("time")] = (),
) -> Target:
    """Make of a flight's load the nearest one that a centrifuge can follow, at every time.

    The flight's corners are rounded by a Hann kernel. Where the load is then at least idle and in reach of the gimbals,
    it is the target. Below idle, the target's size is idle. Where the gimbals do not reach, the part along the beam is
    kept and the part across it raised. The direction on the way is near the flight's, without changes quicker than the
    period 2π √(R/idle) of an arm at idle; where it is that of the flight, path and flight meet without a corner.
    Before the span the load is that of its first time, after it that of its last.

    A load whose values JAX traces has no numbers to decide on: it is taken to be one that needs no hold, and to stand
    still beyond the span.

    Parameters
    ----------
    raw : Profile
        Vector, base axes, m/s²: specific force if `gravity`, else acceleration.
    span : tuple of float
        First and last time of interest, s.
    idle : float or None
        Least load, m/s².
    smoothing : float or None
        Width of the kernel, s; None or 0 leaves the corners.
    gravity : bool
        Gravity is there on the machine and `raw` is specific force.
    arm : float, optional
        R, m; without it the path follows all but the quickest changes of direction.
    clip : bool
        Whether to carry on with the nearest load where the gimbals cannot reach; to give `idle` does so too.
    leave_out : sequence of (start, end), optional
        Stretches, s, in which the load is not followed above idle either, for an inverse that cannot: each is widened
        to the whole return above idle that it is a part of.

    Raises
    ------
    InputError
        If a number is impossible, or the load cannot be followed: it has no direction; without idle, it comes near
        zero, reverses through zero or is out of reach; without gravity, it is along the beam on its way.

    Examples
    --------
    >>> along_z = gb.Sum((gb.constant(20.0), gb.trapezoid(50.0, jerk=25.0, start=1.0, hold=2.0)))
    >>> load = gb.vector(z=along_z)
    >>> target = gb.build_target(load, span=(0.0, 8.0), idle=None, smoothing=0.1, gravity=True)
    >>> print(f"{target.load.derivatives(4.0, 0)[0][2]:.4f} m/s²")
    70.0000 m/s²
    """
    first, last = span
    if not (np.isfinite(first) and np.isfinite(last) and last > first):
        raise InputError("span", f"is {first:g} s to {last:g} s", "end after the start")
    width = 0.0 if smoothing is None else positive("smoothing", smoothing, "s", zero=True)
    least = None if idle is None else positive("idle", idle, "m/s²")
    if gravity and least is not None and least < LEAST_IDLE * STANDARD_GRAVITY:
        raise InputError(
            "idle", f"is {least / STANDARD_GRAVITY:.3g} g and gravity 1 g", f"give at least {LEAST_IDLE} g"
        )
    target_of = partial(
        Target, flight=raw, idle=0.0 if least is None else least, gravity=STANDARD_GRAVITY if gravity else 0.0,
        half_width=width / 2, span=(float(first), float(last)),
    )  # fmt: skip
    corners = clamped(raw, first, last)
    if is_traced(raw(first), width):
        load = smoothed(corners, width) if is_traced(width) or width else corners
        edges = merged_edges([], last)
        return target_of(load=load, corners=corners, stretches=padded_rows([]), edges=edges, rounded=True, turns=True)
    if width:
        fix = f"give {_PER_WIDTH * (last - first) / KNOTS:.2g} s or more, or a shorter duration"
        refuse_more("smoothing", "knots", _PER_WIDTH * (last - first) / width, KNOTS, 4000.0, fix)
        if width > _WIDEST * (last - first):
            problem = f"is {width:g} s: nothing of a flight of {last - first:g} s is left"
            raise InputError("smoothing", problem, f"give less than {_WIDEST * (last - first):.3g} s")
    flight = smoothed(corners, width) if width else corners
    times = _knots(corners, first, last, width / _PER_WIDTH or _GRID)
    loads = np.asarray(flight(times))
    size, lateral = np.linalg.norm(loads, axis=1), np.linalg.norm(loads[:, 1:], axis=1)
    out_of_reach = lateral < MIN_TRANSVERSE_LOAD * (1 - _ROUNDING) if gravity else np.zeros(times.size, bool)
    if out_of_reach.any() and least is None and not clip:
        at_corners = np.asarray(corners(times))
        out_of_reach |= np.linalg.norm(at_corners[:, 1:], axis=1) < MIN_TRANSVERSE_LOAD * (1 - _ROUNDING)
        refuse_far(times, at_corners, out_of_reach)
    low = np.zeros(times.size, bool) if least is None else size < least * (1 - _ROUNDING)
    gate = _gate(times, size, least, leave_out)
    left_out = np.zeros(times.size, bool) if gate is None else np.asarray(gate(times)) == 0
    load = flight
    if (low | out_of_reach | left_out).any():
        if least is not None:
            refuse_undirected(loads, least)
            if not gravity and not lateral.any():
                refuse_reversal(times, loads, least)
        path = _path(times, loads, low | left_out, out_of_reach, least, gravity, arm)
        load = NearestLoad(
            flight, smoothed(path, _PATH * width) if width else path, gate, least or 0.0,
            MIN_TRANSVERSE_LOAD if gravity else 0.0, has_idle=least is not None, has_least=gravity,
        )  # fmt: skip
    values = np.asarray(load(times))
    if not gravity:
        refuse_singular(times, values, least)
    steady = values if gravity else values / np.maximum(np.linalg.norm(values, axis=1), 1e-12)[:, None]
    reasons = np.select([low, left_out, out_of_reach], [BELOW_IDLE, LEFT_OUT, GIMBALS], -1)
    rows = stretches(times, reasons, size - (least or 0.0), lateral - MIN_TRANSVERSE_LOAD, corners)
    return target_of(
        load=load, corners=corners, stretches=padded_rows(rows), edges=merged_edges(rows, last),
        rounded=width > 0 or not _has_corners(load, first, last),
        turns=bool(np.max(np.abs(steady - steady[0])) > 1e-9),
    )  # fmt: skip


def _path(
    times: Floats, loads: Floats, held: Flags, out_of_reach: Flags, idle: float | None, gravity: bool, arm: Any | None
) -> PiecewiseLinear:
    """Direction of the target's load on knots (k,): its angles (k, 2), rad, about the beam and from the beam.

    They are the angles of the flight's loads (k, 3), except where the load is held at idle (`held`) or out of the
    gimbals' reach: there the angles follow a gentle path.
    """
    full_load = MIN_TRANSVERSE_LOAD if idle is None else idle
    time_scale = _QUICK if arm is None else float(np.sqrt(_number(arm) / full_load))
    load_across = np.linalg.norm(loads[:, 1:], axis=1)
    about_beam, weight = unwrapped(times, loads[:, 2], loads[:, 1], full_load)
    about_beam = gentle(times, about_beam, weight, _with_neighbours(~(held | out_of_reach)) & (weight > 0), time_scale)
    from_beam, weight = unwrapped(times, load_across, loads[:, 0], full_load)
    from_beam = gentle(times, from_beam, weight, _with_neighbours(~held), time_scale)
    if not gravity:
        from_beam = np.where(held, off_axis(from_beam), from_beam)
    return PiecewiseLinear(*_padded(times, np.stack([about_beam, from_beam], axis=1)))


def _with_neighbours(flags: Flags) -> Flags:
    """The knots and their neighbours: between them the load may cross idle."""
    return np.asarray(flags | np.append(flags[1:], False) | np.append(False, flags[:-1]))


def _number(arm: Any) -> float:
    """The arm's length as a number; InputError if JAX traces it."""
    if is_traced(arm):
        problem = "is traced by JAX, and by its number the target turns where it is another load"
        raise InputError("arm", problem, "give a number, or times at which the flight's load is followed")
    return float(arm)


def _gate(times: Floats, size: Floats, idle: float | None, leave_out: Stretches) -> PiecewiseLinear | None:
    """Gate over time: 0 on returns above idle that `leave_out` names, 1 on others, linear between, or None
    if all are 1.
    """
    if idle is None or not leave_out:
        return None
    gate = np.full(times.size, np.nan)
    # Returns that are fewer than four knots apart count as one.
    for run in joined(true_runs(size > PARTED * idle), np.arange(times.size, dtype=float), 4):
        closed = any(times[run.start] <= end and start <= times[run.stop - 1] for start, end in leave_out)
        gate[run] = 0.0 if closed else 1.0
    is_set = np.isfinite(gate)
    return PiecewiseLinear(times[is_set], gate[is_set]) if is_set.any() else None


def _padded(times: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Repeat the last knot, later and later, up to a round number: loads that differ in width share their programs."""
    count, step = times.size, times[-1] - times[-2]
    size = 1 << (count - 1).bit_length()
    size = 3 * size // 4 if count <= 3 * size // 4 else size
    later = times[-1] + step * np.arange(1, size - count + 1)
    return np.append(times, later), np.concatenate([values, np.repeat(values[-1:], size - count, axis=0)])


def _knots(raw: Profile, start: float, end: float, step: float) -> Floats:
    """Knots of `raw` and of a grid with spacing `step`, s. Points that nearly coincide are left out: slopes between
    them would be rounding.
    """
    tolerance = 1e-4 * step
    first, last = raw.extent or (start, end)
    knots = raw.knots(min(step, max(_CURVE, (last - first) / _MOST)))
    knots = np.concatenate([[start], knots[(knots > start + tolerance) & (knots < end - tolerance)], [end]])
    knots = knots[np.diff(knots, prepend=-np.inf) > tolerance]
    grid = sampled(start, end, step)
    next_knot = np.clip(np.searchsorted(knots, grid), 1, knots.size - 1)
    distance = np.minimum(np.abs(grid - knots[next_knot - 1]), np.abs(knots[next_knot] - grid))
    return np.union1d(knots, grid[distance > step / 4])


def _has_corners(load: Profile, start: float, end: float) -> bool:
    """True if the slope jumps anywhere between `start` and `end`."""
    breaks = np.asarray(load.breaks)
    inside = breaks[(breaks > start) & (breaks < end)]
    before, after = (load.derivatives(inside + side)[1] for side in (-1e-7, 1e-7))
    slope = np.max(np.abs(load(inside)), initial=0.0) / (end - start)
    return bool(np.any(np.abs(after - before) > 1e-6 * slope))
