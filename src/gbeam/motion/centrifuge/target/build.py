"""From a flight's load to a target that a centrifuge can follow."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from gbeam.arrays.namespace import is_traced
from gbeam.checks import positive
from gbeam.errors import InputError
from gbeam.motion.bases.conditioning import STANDARD_GRAVITY
from gbeam.motion.centrifuge.target.load_floor import LoadFloor
from gbeam.motion.centrifuge.target.load_limits import (
    MIN_TRANSVERSE_LOAD,
    OPPOSED,
    hold_idle,
    keep_in_reach,
    nearest_to_zero,
    refuse_far,
    refuse_reversal,
)
from gbeam.motion.centrifuge.target.smooth_hold import smooth_hold, without_gaps
from gbeam.motion.centrifuge.target.target import Target
from gbeam.motion.profiles.hold import hold_until
from gbeam.motion.profiles.piecewise import PiecewiseLinear
from gbeam.motion.profiles.profile import Profile, sampled, smoothed

_GRID = 0.01  # s, spacing of knots where a load without smoothing is held
_CURVE = 0.002  # s, the same along a curved profile
_PER_WIDTH = 6  # knots per width of the smoothing kernel
_NEAR_ZERO = 0.02  # of the peak load
_ALONG_BEAM = 1e-3  # of the peak load
LEAST_IDLE = 1.1  # g, with gravity
# The guard lies wholly between gravity and the least load across the beam: it leaves every reachable load as it is.
_FLOOR, _BAND = 1.03 * STANDARD_GRAVITY, 0.04 * STANDARD_GRAVITY

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]


def build_target(
    raw: Profile,
    *,
    span: tuple[float, float],
    idle: float | None,
    smoothing: float | None,
    gravity: bool,
    arm: Any | None = None,
    clip: bool = False,
    spin_up: float | None = None,
) -> Target:
    """Make of a flight's load one that a centrifuge can follow.

    Loads below idle are raised to it in their own direction, those across the beam that gravity alone exceeds
    are bridged; a load that needs neither is kept as it is. Corners are then rounded by a Hann kernel.

    While the load is held, only what an arm at idle could follow is followed: changes of direction faster than the
    period 2π √(R/idle), the quickest oscillation of the load with −ä ≤ a²/R, are smoothed, and visits to the flight's
    load shorter than half of it are left out.

    A load whose values JAX traces has no numbers to decide on: it is taken to be one that needs no hold.

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
        R, m; without it a held load follows every change of direction.
    clip : bool
        Whether to carry on with a held target where the gimbals cannot reach; to give `idle` does so too.
    spin_up : float, optional
        Time that the machine takes from standstill, s: until then the load waits at the one that it has at its end.

    Raises
    ------
    InputError
        If a number is impossible, or the load cannot be followed: it comes near zero, reverses through
        zero, or is out of reach throughout.
    """
    first, final = span
    if not (np.isfinite(first) and np.isfinite(final) and final > first):
        raise InputError("span", f"is {first:g} s to {final:g} s", "end after the start")
    width = 0.0 if smoothing is None else positive("smoothing", smoothing, "s", zero=True)
    least = None if idle is None else positive("idle", idle, "m/s²")
    if gravity and least is not None and least < LEAST_IDLE * STANDARD_GRAVITY:
        raise InputError(
            "idle", f"is {least / STANDARD_GRAVITY:.3g} g and gravity 1 g", f"give at least {LEAST_IDLE} g"
        )
    # The corner at which the load leaves the one that it waited at is over when the spin-up is.
    ready = first if spin_up is None else first + _spin_up(spin_up, width, final - first)
    waiting = raw if spin_up is None else hold_until(ready - width / 2, raw)
    if is_traced(raw(first), width):
        load = smoothed(waiting, width) if is_traced(width) or width else waiting
        if gravity:
            load = LoadFloor(load, _FLOOR, _BAND)
        none = np.zeros(3)
        parts = (load, raw, waiting, np.array([first, final]), none, none)
        return _target(*parts, least, gravity, width, (first, final), ready, rounded=True, turns=True)
    times = _knots(raw, ready - width / 2, final + width / 2, width / _PER_WIDTH or _GRID)
    own = np.asarray(raw(times))
    held, low, far = _hold(times, own, least, gravity)
    if far.any() and least is None and not clip:
        refuse_far(times, own, far)
    if least is not None and arm is not None and (low | far).any():
        period = 2 * np.pi * np.sqrt(_number(arm) / least)
        altered = without_gaps(times, low | far, period / 2)
        held = smooth_hold(times, held, altered, period, least, MIN_TRANSVERSE_LOAD if gravity else 0.0)
        low = altered & ~far
    times, held, low, far = _padded(times, held, low, far)
    corners = PiecewiseLinear(times, held) if (low | far).any() else waiting
    load = smoothed(corners, width) if width else corners
    _refuse_singular(times, load, (ready, final), least, gravity)
    if gravity:
        load = LoadFloor(load, _FLOOR, _BAND)
    steady = held if gravity else held / np.maximum(np.linalg.norm(held, axis=1), 1e-12)[:, None]
    parts = (load, raw, corners, times, _running(low), _running(far))
    rounded = width > 0 or not _has_corners(load, first, final)
    turns = bool(np.max(np.abs(steady - steady[0])) > 1e-9)
    return _target(*parts, least, gravity, width, (first, final), ready, rounded=rounded, turns=turns)


def _target(
    load: Profile, flight: Profile, corners: Profile, times: Floats, low: Any, far: Any, idle: Any, gravity: bool,
    width: Any, span: tuple[float, float], ready: float, *, rounded: bool, turns: bool,
) -> Target:  # fmt: skip
    return Target(
        load=load,
        flight=flight,
        corners=corners,
        idle=0.0 if idle is None else idle,
        gravity=STANDARD_GRAVITY if gravity else 0.0,
        times=times,
        below_idle=low,
        out_of_reach=far,
        half_width=width / 2,
        span=(float(span[0]), float(span[1])),
        ready=float(ready),
        rounded=rounded,
        turns=turns,
    )


def _number(arm: Any) -> float:
    if is_traced(arm):
        raise InputError("arm", "is traced by JAX where the target is held", "prepare the machine before: over(...)")
    return float(arm)


def _spin_up(given: float, width: float, duration: float) -> float:
    """Return the time to spin up, s; InputError if it is not well within the duration and above the smoothing."""
    time = float(positive("spin_up", given, "s"))
    if not 2 * width <= time < duration:
        limits = f"from {2 * width:g} s (twice the smoothing) " if width else ""
        raise InputError("spin_up", f"is {time:g} s of {duration:g} s", f"give a time {limits}to below {duration:g} s")
    return time


def _hold(times: Floats, load: Floats, idle: float | None, gravity: bool) -> tuple[Floats, Flags, Flags]:
    """Load held at idle and within the gimbals' reach; which knots were below idle, which out of reach."""
    held, low = (load, np.zeros(times.size, bool)) if idle is None else hold_idle(times, load, idle)
    if not gravity:
        return held, low, np.zeros(times.size, bool)
    held, far = keep_in_reach(times, held)
    if idle is not None and far.any():
        again, _ = hold_idle(times, held, idle)
        held = np.where(far[:, None], again, held)
    return held, low, far


def _padded(times: Floats, *columns: NDArray[Any]) -> tuple[NDArray[Any], ...]:
    """Repeat the last knot, later and later, up to a round number: loads that differ in width share their programs."""
    count, step = times.size, times[-1] - times[-2]
    size = 1 << (count - 1).bit_length()
    size = 3 * size // 4 if count <= 3 * size // 4 else size
    later = times[-1] + step * np.arange(1, size - count + 1)
    unchanged = [np.concatenate([column, np.repeat(column[-1:], size - count, axis=0)]) for column in columns]
    return np.append(times, later), *unchanged


def _running(changed: Flags) -> Floats:
    return np.append(0.0, np.cumsum(changed))


def _knots(raw: Profile, start: float, end: float, step: float) -> Floats:
    """Knots of `raw` and a grid, without grid points so near a knot that a slope would be mere rounding."""
    own = raw.knots(min(step, _CURVE))
    own = np.unique(np.concatenate([[start], own[(own > start) & (own < end)], [end]]))
    grid = sampled(start, end, step)
    after = np.clip(np.searchsorted(own, grid), 1, own.size - 1)
    distance = np.minimum(np.abs(grid - own[after - 1]), np.abs(own[after] - grid))
    return np.union1d(own, grid[distance > step / 4])


def _refuse_singular(
    times: Floats, load: Profile, span: tuple[float, float], idle: float | None, gravity: bool
) -> None:
    """Refuse a load that comes so near to zero, or to the beam's axis, that the axes would have to spin."""
    fine = np.unique(np.concatenate([times, (times[1:] + times[:-1]) / 2]))
    points = np.asarray(load(fine))
    clock = np.clip(fine, *span)  # the load before the start counts as the load at the start
    if gravity:
        refuse_reversal(clock, points[:, 1:], 2 * OPPOSED * STANDARD_GRAVITY)
        return
    peak = float(np.max(np.linalg.norm(points, axis=1)))
    if idle is None:
        when, distance = nearest_to_zero(clock, points)
        if distance <= _NEAR_ZERO * peak:
            raise InputError(
                "tracks",
                f"has next to no load at {when:.3f} s, where the arm's acceleration is singular",
                'set idle = "1.4 g", or what the machine idles at',
            )
    else:
        refuse_reversal(clock, points, 2 * OPPOSED * idle)
    when, distance = nearest_to_zero(clock, points[:, 1:])
    if distance < _ALONG_BEAM * peak and np.any(points[:, 1:]):
        raise InputError(
            "tracks",
            f"loads the beam along its axis only at {when:.3f} s, where the roll axis has no defined angle",
            "add a steady load across the beam, or leave the components across it at zero throughout",
        )


def _has_corners(load: Profile, start: float, end: float) -> bool:
    """Tell whether the slope jumps anywhere between `start` and `end`."""
    breaks = np.asarray(load.breaks)
    inside = breaks[(breaks > start) & (breaks < end)]
    before, after = (load.derivatives(inside + side)[1] for side in (-1e-7, 1e-7))
    slope = np.max(np.abs(load(inside)), initial=0.0) / (end - start)
    return bool(np.any(np.abs(after - before) > 1e-6 * slope))
