"""The load a centrifuge is asked to make: a flight's, held where it cannot follow, its corners rounded."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, ArrayLike, Bool, Float
from numpy.typing import NDArray

from gbeam.checks import positive
from gbeam.errors import InputError
from gbeam.motion.bases.record import STANDARD_GRAVITY
from gbeam.motion.centrifuge.target.load_floor import Lifted
from gbeam.motion.centrifuge.target.load_limits import (
    OPPOSED,
    REACH,
    hold_idle,
    keep_in_reach,
    nearest_to_zero,
    refuse_far,
    refuse_reversal,
)
from gbeam.motion.centrifuge.target.smooth_hold import settle, without_gaps
from gbeam.motion.profiles.hold import held_before
from gbeam.motion.profiles.piecewise import PiecewiseLinear
from gbeam.motion.profiles.profile import Profile, sampled, smoothed
from gbeam.numerics.time_derivative import with_rate

_GRID = 0.01  # s, spacing of knots where a load without smoothing is held
_CURVE = 0.002  # s, the same along a curved profile
_PER_WIDTH = 6  # knots per width of the smoothing kernel
_NEAR_ZERO = 0.02  # of the peak load
_ALONG_BEAM = 1e-3  # of the peak load
LEAST_IDLE = 1.1  # g, with gravity
# The guard lies wholly between gravity and the least load asked for: it leaves every reachable load as it is.
_FLOOR, _BAND = 1.03 * STANDARD_GRAVITY, 0.04 * STANDARD_GRAVITY


@dataclass(frozen=True)
class Episode:
    """A stretch of time, s, in which the target is not the flight's load, and why."""

    start: float
    end: float
    reason: str


class Target(eqx.Module):
    """Load wanted at the control point; built by :func:`build_target`.

    Parameters
    ----------
    load : Profile
        Vector, base axes, m/s²: specific force where gravity acts, else acceleration.
    flight : Profile
        What it was made from, likewise.
    corners : Profile
        The load before its corners were rounded, likewise.
    idle : array
        Least load, m/s²; zero if there is none.
    gravity : array
        γ, m/s²: 9.80665 or 0.
    times : array, shape (k,)
        Knots at which it was decided whether to hold, s.
    below_idle, out_of_reach : array of int, shape (k + 1,)
        Running count of the knots changed for either reason.
    reach : array
        How far a changed knot acts beyond its neighbours: half the kernel's width, s.
    span : array, shape (2,)
        s.
    ready : array
        End of the spin-up, s: before, the load waits at the one that it has then. The span's start if there is none.
    rounded : bool
        The load has no corners.
    turns : bool
        Its direction, or with gravity its size, changes, so that the gimbals must move.
    """

    load: Profile
    flight: Profile
    corners: Profile
    idle: Float[Array, ""]
    gravity: Float[Array, ""]
    times: Float[Array, " k"]
    below_idle: Array
    out_of_reach: Array
    reach: Float[Array, ""]
    span: Float[Array, " 2"]
    ready: Float[Array, ""]
    rounded: bool = eqx.field(static=True)
    turns: bool = eqx.field(static=True)

    def not_followed(self, t: ArrayLike) -> Bool[Array, "*t"]:
        """Tell at which times `t` (s, any shape) the machine spins up or a changed knot has a say in the load."""
        now = jnp.asarray(t, dtype=float)
        count, last = self.below_idle + self.out_of_reach, self.times.size - 1
        before = jnp.searchsorted(self.times, now - self.reach, side="right") - 1
        after = jnp.searchsorted(self.times, now + self.reach, side="left")
        return (now < self.ready) | (count[jnp.minimum(after, last) + 1] > count[jnp.clip(before, 0, last)])

    def episodes(self) -> list[Episode]:
        """Stretches within the span where the load is not the flight's, by start; two reasons may overlap."""
        reasons = (("below idle", self.below_idle), ("out of reach of the gimbals", self.out_of_reach))
        changes = ((reason, np.diff(np.asarray(count))) for reason, count in reasons)
        found = [Episode(*run, reason) for reason, changed in changes for run in self._runs(changed)]
        first, ready = float(self.span[0]), float(self.ready)
        found += [Episode(first, ready, "spin-up")] if ready > first else []
        return sorted(found, key=lambda episode: episode.start)

    def _runs(self, changed: NDArray[np.int64]) -> list[tuple[float, float]]:
        """Start and end of each run of changed knots, joined where they act on the same times."""
        times, reach = np.asarray(self.times), float(self.reach)
        first, last = float(self.ready), float(self.span[1])
        edges = np.diff(changed, prepend=0, append=0)
        runs: list[tuple[float, float]] = []
        for start, stop in zip(np.flatnonzero(edges > 0), np.flatnonzero(edges < 0), strict=True):
            begin = max(float(times[start - 1]) - reach, first) if start > 0 else first
            end = min(float(times[stop]) + reach, last) if stop < times.size else last
            if runs and begin <= runs[-1][1]:
                runs[-1] = (runs[-1][0], end)
            elif begin < end:
                runs.append((begin, end))
        return runs


def build_target(
    raw: Profile,
    *,
    span: tuple[float, float],
    idle: float | None,
    smoothing: float | None,
    gravity: bool,
    arm: float | None = None,
    clip: bool = False,
    spin_up: float | None = None,
) -> Target:
    """Make of a flight's load one that a centrifuge can follow.

    Loads below idle are raised to it in their own direction, those across the beam that gravity alone exceeds
    are bridged; a load that needs neither is kept as it is. Corners are then rounded by a Hann kernel.

    While the load is held, only what an arm at idle could follow is followed: changes of direction faster than the
    period 2π √(R/idle), the quickest oscillation of the load with −ä ≤ a²/R, are smoothed, and visits to the flight's
    load shorter than half of it are left out.

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
        Whether to carry on with a held target where the gimbals cannot reach; to give `idle` is to ask for it too.
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
    ready = first if spin_up is None else first + _spin_up(spin_up, width, final - first)
    # The corner at which the load leaves the one that it waited at is over when the spin-up is.
    leaves = ready - width / 2
    times = _knots(raw, leaves, final + width / 2, width / _PER_WIDTH or _GRID)
    wanted = np.asarray(_sample(raw, times))
    asked, low, far = _hold(times, wanted, least, gravity)
    if far.any() and least is None and not clip:
        refuse_far(times, wanted, far)
    if least is not None and arm is not None and (low | far).any():
        period = 2 * np.pi * np.sqrt(arm / least)
        altered = without_gaps(times, low | far, period / 2)
        asked = settle(times, asked, altered, period, least, REACH if gravity else 0.0)
        low = altered & ~far
    times, asked, low, far = _padded(times, asked, low, far)
    waiting = raw if spin_up is None else held_before(raw, leaves)
    corners = PiecewiseLinear(times, asked) if (low | far).any() else waiting
    load = smoothed(corners, width) if width else corners
    _refuse_singular(times, load, (ready, final), least, gravity)
    if gravity:
        load = Lifted(load, jnp.asarray(_FLOOR, dtype=float), jnp.asarray(_BAND, dtype=float))
    steady = asked if gravity else asked / np.maximum(np.linalg.norm(asked, axis=1), 1e-12)[:, None]
    return Target(
        load=load,
        flight=raw,
        corners=corners,
        idle=jnp.asarray(least or 0.0, dtype=float),
        gravity=jnp.asarray(STANDARD_GRAVITY if gravity else 0.0, dtype=float),
        times=jnp.asarray(times),
        below_idle=_running(low),
        out_of_reach=_running(far),
        reach=jnp.asarray(width / 2, dtype=float),
        span=jnp.asarray([first, final], dtype=float),
        ready=jnp.asarray(ready, dtype=float),
        rounded=width > 0 or not _has_corners(load, first, final),
        turns=bool(np.max(np.abs(steady - steady[0])) > 1e-9),
    )


def _spin_up(given: float, width: float, duration: float) -> float:
    """Return the time to spin up, s; InputError if it is not well within the duration and above the smoothing."""
    time = positive("spin_up", given, "s")
    if not 2 * width <= time < duration:
        limits = f"from {2 * width:g} s (twice the smoothing) " if width else ""
        raise InputError("spin_up", f"is {time:g} s of {duration:g} s", f"give a time {limits}to below {duration:g} s")
    return time


def _hold(
    times: NDArray[np.float64], load: NDArray[np.float64], idle: float | None, gravity: bool
) -> tuple[NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_]]:
    """Load held at idle and within the gimbals' reach; which knots were below idle, which out of reach."""
    held, low = (load, np.zeros(times.size, bool)) if idle is None else hold_idle(times, load, idle)
    if not gravity:
        return held, low, np.zeros(times.size, bool)
    held, far = keep_in_reach(times, held)
    if idle is not None and far.any():
        again, _ = hold_idle(times, held, idle)
        held = np.where(far[:, None], again, held)
    return held, low, far


def _padded(times: NDArray[np.float64], *columns: NDArray[Any]) -> tuple[NDArray[Any], ...]:
    """Repeat the last knot, later and later, up to a round number: loads that differ in width share their programs."""
    count, step = times.size, times[-1] - times[-2]
    size = 1 << (count - 1).bit_length()
    size = 3 * size // 4 if count <= 3 * size // 4 else size
    later = times[-1] + step * np.arange(1, size - count + 1)
    unchanged = [np.concatenate([it, np.repeat(it[-1:], size - count, axis=0)]) for it in columns]
    return np.append(times, later), *unchanged


_sample = eqx.filter_jit(lambda profile, t: profile(t))  # one compilation rather than one per operation


def _running(changed: NDArray[np.bool_]) -> Array:
    return jnp.asarray(np.append(0, np.cumsum(changed)))


def _knots(raw: Profile, start: float, end: float, step: float) -> NDArray[np.float64]:
    """Knots of `raw` and a grid, without grid points so near a knot that a slope would be mere rounding."""
    own = raw.knots(min(step, _CURVE))
    own = np.unique(np.concatenate([[start], own[(own > start) & (own < end)], [end]]))
    grid = sampled(start, end, step)
    after = np.clip(np.searchsorted(own, grid), 1, own.size - 1)
    distance = np.minimum(np.abs(grid - own[after - 1]), np.abs(own[after] - grid))
    return np.union1d(own, grid[distance > step / 4])


def _refuse_singular(
    times: NDArray[np.float64], load: Profile, span: tuple[float, float], idle: float | None, gravity: bool
) -> None:
    """Refuse a load that comes so near to zero, or to the beam's axis, that the axes would have to spin."""
    fine = np.unique(np.concatenate([times, (times[1:] + times[:-1]) / 2]))
    points = np.asarray(_sample(load, fine))
    asked = np.clip(fine, *span)  # the load before the start counts as the load at the start
    if gravity:
        refuse_reversal(asked, points[:, 1:], 2 * OPPOSED * STANDARD_GRAVITY)
        return
    peak = float(np.max(np.linalg.norm(points, axis=1)))
    if idle is None:
        when, distance = nearest_to_zero(asked, points)
        if distance <= _NEAR_ZERO * peak:
            raise InputError(
                "tracks",
                f"has next to no load at {when:.3f} s, where the arm's acceleration is singular",
                'set idle = "1.4 g", or what the machine idles at',
            )
    else:
        refuse_reversal(asked, points, 2 * OPPOSED * idle)
    when, distance = nearest_to_zero(asked, points[:, 1:])
    if distance < _ALONG_BEAM * peak and np.any(points[:, 1:]):
        raise InputError(
            "tracks",
            f"loads the beam along its axis only at {when:.3f} s, where the roll axis has no defined angle",
            "add a steady load across the beam, or leave the components across it at zero throughout",
        )


def _has_corners(load: Profile, start: float, end: float) -> bool:
    """Tell whether the slope jumps anywhere between `start` and `end`."""
    breaks = np.asarray(load.breaks)
    inside = jnp.asarray(breaks[(breaks > start) & (breaks < end)])
    before, after = (with_rate(load, inside + side)[1] for side in (-1e-7, 1e-7))
    slope = np.max(np.abs(load(inside)), initial=0.0) / (end - start)
    return bool(np.any(np.abs(after - before) > 1e-6 * slope))
