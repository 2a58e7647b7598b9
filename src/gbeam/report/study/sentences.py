"""Sentences on one response: accuracy, loads, hub, and how well a machine follows."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from gbeam.report.machine.tracking import ends_line, not_followed_stretches, tracked
from gbeam.report.words import error_words, number, percent, stress_words
from gbeam.results.parts import LoadPeaks, Loads
from gbeam.results.response import HubResult, Response

ROUNDING = 1e-9  # of what it belongs to: a smaller number is none
EPISODES = 8  # of holding listed; a rough record has hundreds
SHORTFALLS = 2


def of_beam(response: Response) -> Iterator[str]:
    """Sentences on accuracy, beginning, root loads, hub, and the samples that a file keeps."""
    yield _accuracy(response)
    if response.initial:
        yield response.initial
    if response.loads is not None and response.peaks.loads is not None:
        yield _loads(response.loads, response.peaks.loads)
    if response.hub is not None:
        yield _hub(response.hub)
        if response.hub.free and np.any(response.damping_ratio):
            yield _damping(response)
    if response.kept_every > 1:
        kept = response.time[:: response.kept_every]
        yield (
            f"a result file keeps {len(kept)} of {len(response.time)} samples of its histories, "
            f"{_time(float(kept[1] - kept[0]))} apart; histories of [response] says otherwise"
        )


def _accuracy(response: Response) -> str:
    step = f"{response.steps} steps of {_time(response.step)}"
    if math.isnan(response.error_estimate) or response.outcome != "done":
        error = "no error estimate"
    else:
        error = f"estimated error {error_words(response.errors.displacement)} of the largest displacement"
        if math.isfinite(response.errors.loads.total):
            error += f", {percent(response.errors.loads.total)} of the largest root load"
    return f"{response.model}, {response.integrator}, {step}; {error}"


def _damping(response: Response) -> str:
    """Modes that the damping ratio is of, where that is not obvious: with a free hub the beam's modes are others."""
    ratios = np.atleast_1d(response.damping_ratio)
    size = " to ".join(f"{100 * each:.3g}" for each in sorted({float(ratios.min()), float(ratios.max())}))
    return f"damping {size} % of critical, of the modes of the beam on a hub at rest; those with the free hub have more"


def _time(seconds: float) -> str:
    return f"{number(1e3 * seconds)} ms" if seconds < 1 else f"{number(seconds)} s"


def _loads(loads: Loads, peaks: LoadPeaks) -> str:
    """Largest sizes over time: at the root, of the stress, and of the torque about a hub's axis."""
    force, moment = (float(each[0].size.value) for each in (peaks.force, peaks.moment))
    words = f"root: largest force {number(force)} N, moment {number(moment)} N m"
    if np.isfinite(peaks.tension.value).all():
        extremes = peaks.tension.value, peaks.compression.value
        words += f"; {stress_words(loads.stations, *extremes, loads.yield_strength)}"
    if peaks.beam_torque is not None:
        words += f"; torque for the beam {number(float(peaks.beam_torque.value))} N m"
    return words


def _hub(hub: HubResult) -> str:
    rate = float(abs(hub.rate).max())
    return f"hub: angle at the end {number(hub.angle[-1])} rad, largest rate {number(rate)} rad/s"


def of_machine(response: Response) -> Iterator[str]:
    """Sentences on how a centrifuge begins and ends, follows the load, and where it does not."""
    axes = response.axes
    if axes is None:
        return
    yield ends_line(response.time, axes)
    yield tracked(response)
    stretches = not_followed_stretches(axes)
    for start, end, reason in stretches[:EPISODES]:
        yield f"target held {start:.3f} to {end:.3f} s: {reason}"
    if len(stretches) > EPISODES:
        yield f"target held {len(stretches) - EPISODES} times more: see the result file"
    # Stretches in which the target is held are listed above; a load that is followed and yet out of reach is news.
    others = [each for each in axes.shortfalls if not any(start <= each.time <= end for start, end, _ in stretches)]
    for each in others[:SHORTFALLS]:
        yield f"warning: {each}"
    if len(others) > SHORTFALLS:
        yield f"warning: and {len(others) - SHORTFALLS} more: see `gbeam plan`"
