"""Reachability of loads: those that no centrifuge makes, and the smoothing that others need.

No centrifuge makes loads near zero, along the beam, or across it below gravity. Vectors in base axes, m/s².
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from gbeam.arrays.types import Flags, Floats
from gbeam.constants import STANDARD_GRAVITY
from gbeam.errors import InputError
from gbeam.motion.centrifuge.target.target import IDLE_BAND, Target
from gbeam.motion.profiles.profile import Profile
from gbeam.numerics.samples import joined, true_runs
from gbeam.numerics.series import sqrt, square, where
from gbeam.results.machine import Shortfall

LEAST_IDLE = 1.1  # g, with gravity
UNTOUCHED = 1 + IDLE_BAND / 2  # times idle: a larger load is not raised
PARTED = 0.97  # times idle: two returns above idle between which the load is smaller are two
UNDIRECTED = 0.05  # of idle: a smaller load has no direction worth following
# The beam stays horizontal, so that gravity always acts across it: no attitude gives less than one g there, and near
# one g the gimbals would have to turn infinitely fast.
MIN_TRANSVERSE_LOAD = 1.05 * STANDARD_GRAVITY  # least load across the beam that the gimbals make where gravity acts
OPPOSED = 0.1  # two unit vectors whose chord passes this near to zero count as opposite
_NEAR_ZERO = 0.02  # of the peak load
_ALONG_BEAM = 1e-3  # of the peak load


def refuse_undirected(load: Floats, idle: float) -> None:
    """Raise InputError if no load (k, 3) is large enough to have a direction."""
    if not np.any(np.linalg.norm(load, axis=1) >= UNDIRECTED * idle):
        raise InputError(
            "tracks",
            f"stays below {UNDIRECTED * idle / STANDARD_GRAVITY:.2g} g, too little to have a direction",
            "track a motion with a load, or lower idle",
        )


def refuse_far(times: Floats, load: Floats, out_of_reach: Flags) -> None:
    """Raise InputError: the load (k, 3) leaves the gimbals' reach, and the target must be the flight's load.

    It names the worst time and the load across the beam that would be enough.
    """
    if out_of_reach.all():
        raise InputError(
            "tracks",
            f"never loads the beam across by {MIN_TRANSVERSE_LOAD / STANDARD_GRAVITY:g} g, and gravity alone is 1 g",
            'set idle = "1.4 g" or more, or gravity = false',
        )
    refuse_reversal(times, load[:, 1:], OPPOSED * STANDARD_GRAVITY)
    lateral = np.linalg.norm(load[:, 1:], axis=1) / STANDARD_GRAVITY
    index = int(np.argmin(lateral))
    unreached = np.flatnonzero(out_of_reach)
    raise InputError(
        "tracks",
        f"loads the beam across by {lateral[index]:.3g} g only at {times[index]:.3f} s; where gravity acts the gimbals "
        f"reach {MIN_TRANSVERSE_LOAD / STANDARD_GRAVITY:g} g or more (out of reach from {times[unreached[0]]:.3f} s, "
        f"last at {times[unreached[-1]]:.3f} s)",
        'set idle = "1.4 g", or clip = true to carry on with the nearest load in reach, '
        f"or add {missing_across(lateral[index] * STANDARD_GRAVITY)} across the beam",
    )


def missing_across(load: float) -> str:
    """Least addition to a load across the beam, m/s², that brings it into reach; rounded up."""
    return f"{np.ceil(100 * (MIN_TRANSVERSE_LOAD - load) / STANDARD_GRAVITY - 1e-6) / 100:g} g"


def refuse_reversal(times: Floats, points: Floats, least: float) -> None:
    """Raise InputError if the polyline through `points` (k, n) at `times` passes within `least` of zero."""
    reversal_time, distance = nearest_to_zero(times, points)
    if distance < least:
        raise InputError(
            "tracks",
            f"reverses its load through zero at {reversal_time:.3f} s",
            "a centrifuge must carry the specimen round and cannot do so at once: "
            'set idle = "1.4 g", or track a part of the motion before or after, or add a steady load',
        )


def refuse_singular(times: Floats, load: Floats, idle: float | None) -> None:
    """Refuse a load (k, 3), without gravity, that comes near to zero or to the beam's axis: there the
    axes would spin.
    """
    peak = float(np.max(np.linalg.norm(load, axis=1)))
    if idle is None:
        singular_time, distance = nearest_to_zero(times, load)
        if distance <= _NEAR_ZERO * peak:
            raise InputError(
                "tracks",
                f"has next to no load at {singular_time:.3f} s, where the arm's acceleration is singular",
                'set idle = "1.4 g", or what the machine idles at',
            )
    singular_time, distance = nearest_to_zero(times, load[:, 1:])
    if distance < _ALONG_BEAM * peak and np.any(load[:, 1:]):
        raise InputError(
            "tracks",
            f"loads the beam along its axis only at {singular_time:.3f} s, where the roll axis has no defined angle",
            "add a steady load across the beam, or leave the components across it at zero throughout",
        )


def nearest_to_zero(times: Floats, points: Floats) -> tuple[float, float]:
    """Time and distance at which the polyline through `points` (k, n) comes nearest to zero."""
    if len(points) == 1:
        return float(times[0]), float(np.linalg.norm(points[0]))
    start, segments = points[:-1], np.diff(points, axis=0)
    length2 = np.sum(segments**2, axis=1)
    # The foot of the perpendicular from zero on each segment, clipped to its ends.
    share = np.clip(-np.sum(start * segments, axis=1) / np.where(length2 > 0, length2, 1.0), 0.0, 1.0)
    distance = np.linalg.norm(start + share[:, None] * segments, axis=1)
    i = int(np.argmin(distance))
    return float(times[i] + share[i] * (times[i + 1] - times[i])), float(distance[i])


_WIDEST, _LADDER = 3.0, 1.05  # s; ratio of two widths tried one after the other
_LEAST = 0.01  # s: the first width tried where there is no smoothing
_PER_WIDTH = 30  # times over the narrowest kernel
_QUICK = 512
_BY_DIFFERENCES = 1e-3  # of what the arm allows: what finite differences leave


def required_smoothing(
    corners: Profile, gravity: float, idle: float, arm: float, time: Floats, runs: Sequence[slice], width: float
) -> list[float | None]:
    """For each stretch of times, the smallest smoothing with which nothing in it turns too sharply for the arm.

    It is found by trying wider and wider kernels. A formula would not do: on a slope that gravity bends, −ä <= a²/R may
    need more than a corner's 2jR/a², or be out of any smoothing's reach.

    `time` (t,) s.
    """
    step = min(float(time[1] - time[0]), max(width, _LEAST) / _PER_WIDTH)
    count = np.ceil((time[-1] - time[0] + _WIDEST) / step)
    # A number of times whose Fourier transform is quick.
    times = time[0] - _WIDEST / 2 + step * np.arange(_QUICK * int(np.ceil(count / _QUICK)))
    spectrum = np.fft.rfft(corners(times), axis=0)
    ends = [(float(time[run.start]), float(time[run.stop - 1])) for run in runs]
    widths: list[float | None] = [None] * len(runs)
    kernel_width = max(width, _LEAST / _LADDER) * _LADDER
    index = np.arange(times.size)
    offset = np.minimum(index, times.size - index) * step
    across = MIN_TRANSVERSE_LOAD if gravity else 0.0
    while None in widths and kernel_width <= _WIDEST:
        kernel = np.where(offset < kernel_width / 2, 1 + np.cos(2 * np.pi * offset / kernel_width), 0.0)
        load = np.fft.irfft(spectrum * np.fft.rfft(kernel / kernel.sum())[:, None], times.size, axis=0)
        total = np.linalg.norm(load, axis=1)
        is_held = (total < UNTOUCHED * idle) | (np.linalg.norm(load[:, 1:], axis=1) < across)
        size = np.sqrt(np.maximum(total**2 - gravity**2, 1e-12))
        turn = -np.gradient(np.gradient(size, step), step)
        sharp = times[(turn > size**2 / arm * (1 + _BY_DIFFERENCES)) & ~is_held]
        for i, (start, end) in enumerate(ends):
            if widths[i] is None and not np.any((sharp > start - kernel_width / 2) & (sharp < end + kernel_width / 2)):
                widths[i] = kernel_width
        kernel_width *= _LADDER
    return widths


TOO_SHARP = "too sharp for the arm"
_GRID, _MOST = 0.002, 2_000_000  # s between the times that are looked at; most of them, over an hour
_JOINED = 0.1  # s: two stretches of one kind nearer than this are reported as one
_ROUNDING = 1e-6


def shortfalls(target: Target, arm: float, *, turns: bool = True) -> tuple[Shortfall, ...]:
    """List where the flight's load is below idle, below gravity across the beam, and where it turns too sharply."""
    time = _times(target)
    flight = np.asarray(target.flight(time))
    idle, gravity = float(target.idle), float(target.gravity)
    stretches = [shortfall for shortfall, _ in sharp_turns(target, arm)] if turns else []
    total, lateral = np.linalg.norm(flight, axis=-1), np.linalg.norm(flight[:, 1:], axis=-1)
    stretches += _idle_shortfalls(
        time, total, idle, "below idle", lambda run: _idle_remedy(total[run], lateral[run], gravity)
    )
    if gravity:
        least = MIN_TRANSVERSE_LOAD
        rest = f"across the beam, or track a part of the flight with {MIN_TRANSVERSE_LOAD / STANDARD_GRAVITY:g} g there"
        stretches += _idle_shortfalls(
            time,
            lateral,
            least,
            "across below gravity",
            lambda run: f"add {missing_across(np.min(lateral[run]))} {rest}",
        )
    return tuple(sorted(stretches, key=lambda stretch: stretch.start))


def sharp_turns(target: Target, arm: float) -> list[tuple[Shortfall, float | None]]:
    """List where the load turns too sharply, with the smoothing, s, that is enough, or None where none is.

    At a maximum, and at the corner before a plateau, the horizontal load a can be followed without a jump of the yaw
    rate only where −ä <= a²/R, docs/theory.md (8.5). A corner of slope change j rounded over T has −ä = 2j/T, and a
    straight slope j of a load f that gravity is part of −ä = (jγ)²/a³, which no rounding changes. At a corner short of
    a maximum somewhat more can be followed, and axis 2 pays: 2.3 times the acceleration for 1.3 times the turn.
    """
    time = _times(target)
    size, _, second_rate = size_and_rates(target.load, target.gravity, time)
    not_followed = np.asarray(target.not_followed(time))
    allowed = size**2 / arm
    runs = joined(true_runs((-second_rate > allowed * (1 + _ROUNDING)) & ~not_followed), time, _JOINED)
    if not runs:
        return []
    gravity, width = float(target.gravity), 2 * float(target.half_width)
    widths = required_smoothing(target.corners, gravity, float(target.idle), arm, time, runs, width)
    total = np.linalg.norm(target.flight(time), axis=-1)
    remedies = [_sharp_remedy(wide, float(np.max(total[run]))) for wide, run in zip(widths, runs, strict=True)]
    return list(zip(_sharp_shortfalls(time, -second_rate, allowed, runs, remedies), widths, strict=True))


def _times(target: Target) -> Floats:
    first, last = (float(end) for end in target.span)
    return np.linspace(first, last, int(np.ceil((last - first) / max(_GRID, (last - first) / _MOST))) + 1)


def size_and_rates(load: Profile, gravity: float, time: Any) -> tuple[Any, Any, Any]:
    """Horizontal load H = sqrt(f² − γ²), m/s², and its first two time derivatives, each of the shape of time."""
    horizontal2 = square(load.series(time, 2)) - gravity**2
    size = sqrt(where(horizontal2.value > 1e-12, horizontal2, 1e-12))
    value, rate, second = size.derivatives()
    return value, rate, second


def _idle_remedy(total: Floats, across: Floats, gravity: float) -> str:
    """Change that makes loads below idle, m/s², trackable, in words."""
    least = np.floor(100 * np.min(total) / UNTOUCHED / STANDARD_GRAVITY) / 100
    if least >= (LEAST_IDLE if gravity else 0.02):
        return f'idle = "{least:.2f} g" or less would follow it'
    if not gravity:
        return "no machine follows a load so near to zero: the target keeps away from it"
    if np.min(across) >= MIN_TRANSVERSE_LOAD:
        return "without idle it would be followed"
    least = MIN_TRANSVERSE_LOAD / STANDARD_GRAVITY
    return f"no machine follows a load below {least:g} g across the beam: the target stays above it"


def _sharp_remedy(width: float | None, load: float) -> str:
    """Change that makes a turn trackable: the smoothing, s, if that is enough; else the idle, m/s²."""
    if width is not None:
        return f'smoothing = "{np.ceil(1e3 * width):.0f} ms" or more is trackable'
    idle = np.ceil(100 * load / UNTOUCHED / STANDARD_GRAVITY) / 100
    return f'no smoothing makes it trackable; idle = "{idle:.2f} g" would hold it'


def _idle_shortfalls(
    time: Floats, load: Floats, least: float, reason: str, remedy: Callable[[slice], str]
) -> list[Shortfall]:
    """Stretches in which a load (t,), m/s², is below the least that a machine makes."""
    stretches = []
    for run in joined(true_runs(load < least * (1 - _ROUNDING)), time, _JOINED):
        index = run.start + int(np.argmin(load[run]))
        reference, possible = load[index] / STANDARD_GRAVITY, least / STANDARD_GRAVITY
        start, end, worst_time = float(time[run.start]), float(time[run.stop - 1]), float(time[index])
        stretches.append(Shortfall(start, end, reason, worst_time, float(reference), float(possible), "g", remedy(run)))
    return stretches


def _sharp_shortfalls(
    time: Floats, turn: Floats, allowed: Floats, runs: list[slice], remedies: list[str]
) -> list[Shortfall]:
    """Stretches, the `runs` of times, in which the load's −ä, `turn`, exceeds what the arm allows, both (t,), m/s⁴."""
    stretches = []
    for run, remedy in zip(runs, remedies, strict=True):
        index = run.start + int(np.argmax(turn[run] / allowed[run]))
        start, end, worst_time = float(time[run.start]), float(time[run.stop - 1]), float(time[index])
        reference, possible = float(turn[index]), float(allowed[index])
        stretches.append(Shortfall(start, end, TOO_SHARP, worst_time, reference, possible, "m/s^4", remedy))
    return stretches
