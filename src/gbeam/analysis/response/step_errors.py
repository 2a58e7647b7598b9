"""The error of the time steps, observed from runs with different ones.

Where the error goes as C hᵖ, runs with three steps give p and C. An order that has not been observed is taken as one.
Of histories it counts as two at most: the first mode shows the order of Gauss's method at steps at which higher modes
do not yet, and their error would be underestimated fivefold. Of loads, which contain more of the modes that such steps
do not resolve, it counts as one at most.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any, Protocol

import numpy as np

from gbeam.arrays.types import Floats
from gbeam.numerics.peaks import peak_difference
from gbeam.results.errors import StepErrors

# Limits of the observed order of histories: runs that hardly converge differ by less than their error.
LOWEST_ORDER, HIGHEST_ORDER = 0.5, 2.0
_SAMPLES = 2000  # times at most at which the loads of two runs are compared


class Stepped(Protocol):
    """A run by steps of one length, s, as the choice of steps and their errors see it."""

    @property
    def step(self) -> float:
        """Length of the steps in the flight, s."""
        ...

    @property
    def flight(self) -> Any:
        """Trajectory over the flight's times."""
        ...

    @property
    def reached_end(self) -> bool:
        """True if the run came to its end."""
        ...

    @property
    def bends(self) -> bool:
        """True if a force law has corners within steps, so that errors do not fall by the order of the scheme."""
        ...

    @property
    def event_warnings(self) -> tuple[str, ...]:
        """Warning of events that the steps may miss, which makes their error unknown; else empty."""
        ...

    @property
    def displacements(self) -> Sequence[Floats]:
        """Histories (t, k) of displacements."""
        ...

    @property
    def peaks(self) -> Sequence[Floats]:
        """Peaks (4,) of vectors."""
        ...

    def aims(self, aim: float, enough: float) -> Sequence[float]:
        """Errors of each history of :attr:`displacements` at which automatic steps aim. `enough` is the largest."""
        ...

    def loads(self, stride: int) -> Sequence[Floats]:
        """Histories (t, ..., k) of force, moment and stress of each body in turn, at every `stride`-th step."""
        ...


def difference(coarse: Floats, fine: Floats, ratio: int) -> float:
    """Largest difference of histories (t, ..., c), with `ratio` fine steps to a coarse one, over the largest length."""
    n = min(len(coarse), (len(fine) - 1) // ratio + 1)
    size = np.linalg.norm(fine, axis=-1).max()
    apart = np.linalg.norm(coarse[:n] - fine[: (n - 1) * ratio + 1 : ratio], axis=-1).max()
    return float(apart / size) if size > 0 else 0.0


def observed_order(coarse: float, fine: float, ratios: tuple[int, int], highest: float) -> float:
    """Order p of three runs, steps 1, 1/r₁, 1/(r₁ r₂): errors C hᵖ differ as (r₁ᵖ − 1)/(1 − r₂⁻ᵖ)."""
    first, second = ratios

    def lack(p: float) -> float:
        """Observed difference before the last one, less the difference that an order p implies. It falls with p."""
        return coarse - fine * (first**p - 1) / (1 - second**-p)

    if not (math.isfinite(coarse) and math.isfinite(fine)) or lack(LOWEST_ORDER) <= 0:
        return LOWEST_ORDER
    if lack(highest) >= 0:
        return highest
    low, high = LOWEST_ORDER, highest
    for _ in range(30):
        middle = (low + high) / 2
        low, high = (middle, high) if lack(middle) > 0 else (low, middle)
    return low


def ratio(coarse: Stepped, fine: Stepped) -> int:
    """Number of steps of one run in one of the other."""
    return round(coarse.step / fine.step)


def share(runs: Sequence[Stepped], differences: Sequence[float], highest: float) -> float:
    """Error of the last of two or three runs over its difference from the one before.

    It follows from the order observed, which counts as `highest` at most.
    """
    order = 1.0
    if len(runs) > 2 and runs[-3].reached_end:
        ratios = ratio(runs[-3], runs[-2]), ratio(runs[-2], runs[-1])
        order = observed_order(differences[-2], differences[-1], ratios, highest)
    return 1 / (ratio(runs[-2], runs[-1]) ** order - 1)


def remaining_error(runs: Sequence[Stepped], differences: Sequence[float], highest: float) -> float:
    """Error that remains in the last of two or three runs, by their differences and the order observed.

    A law that bends within steps has no order, and two runs may agree by chance: there the larger difference counts.
    """
    if runs[-1].bends and len(runs) > 2:
        return max(differences[-1], differences[-2] / ratio(runs[-2], runs[-1]))
    return differences[-1] * share(runs, differences, highest)


@dataclass(frozen=True)
class Estimate:
    """Estimated errors of the last of two or three runs, of each history of displacements and of peaks.

    The first ones follow from the order observed, the promised ones from the scheme's order.
    """

    displacements: tuple[float, ...]
    peaks: float
    promised_displacements: tuple[float, ...]
    promised_peaks: float

    @staticmethod
    def from_runs(runs: Sequence[Stepped], order: int) -> Estimate:
        """Estimate the errors of the last of several runs with falling steps, by a scheme of an order."""
        pairs = [(ratio(a, b), a.displacements, b.displacements) for a, b in pairwise(runs)]
        differences = [[difference(a, b, jump) for a, b in zip(*histories, strict=True)] for jump, *histories in pairs]
        peaks = max(
            (_relative_difference(a, b) for a, b in zip(runs[-2].peaks, runs[-1].peaks, strict=True)), default=0.0
        )
        jump, highest = ratio(*runs[-2:]), min(order, HIGHEST_ORDER)
        moved = tuple(remaining_error(runs, of_history, highest) for of_history in zip(*differences, strict=True))
        return Estimate(
            moved,
            peaks * share(runs, [entry[0] for entry in differences], order),
            moved if runs[-1].bends else tuple(entry / (jump**highest - 1) for entry in differences[-1]),
            peaks / (jump**order - 1),
        )


def _relative_difference(coarse: Floats, fine: Floats) -> float:
    """Largest difference of peaks over the largest peak."""
    return float(np.abs(coarse - fine).max() / fine.max()) if fine.max() > 0 else 0.0


def estimate_step_errors(runs: Sequence[Stepped], order: int) -> StepErrors:
    """Estimate the errors of the last run: of displacements, of the roots' loads and of stress, or NaN if not known."""
    moved = Estimate.from_runs(runs, order).displacements
    errors_of_moved = StepErrors(max(moved, default=0.0), moved=moved)
    if not all(run.reached_end for run in runs[-2:]):
        return errors_of_moved
    runs, differences, of_peaks = runs if runs[0].reached_end else runs[-2:], [], []
    for coarse, fine in pairwise(runs):
        stride = max(1, (len(coarse.flight.time) - 1) // _SAMPLES)
        time, loads_of_both = (
            coarse.flight.time[::stride],
            (coarse.loads(stride), fine.loads(stride * ratio(coarse, fine))),
        )
        differences.append([difference(a, b, 1) for a, b in zip(*loads_of_both, strict=True)])
        of_peaks.append([_difference_of_peaks(time, a, b) for a, b in zip(*loads_of_both, strict=True)])
    errors = [remaining_error(runs, of_history, 4 / order) for of_history in zip(*differences, strict=True)]
    if not errors:
        return errors_of_moved
    if len(runs) > 2:  # peaks may agree by chance: as much is left as the order says of the runs before
        times = ratio(*runs[:2]) ** order
        of_peaks[-1] = [max(now, before / times) for before, now in zip(*of_peaks[-2:], strict=True)]
    peaks = tuple(remaining_error(runs, quantity, 4 / order) for quantity in zip(*of_peaks, strict=True))
    # Force, moment and stress of each body in turn.
    loads, stress = (
        max(errors[::3] + errors[1::3]),
        max((quantity for quantity in errors[2::3] if not math.isnan(quantity)), default=math.nan),
    )
    return replace(errors_of_moved, loads=loads, stress=stress, each=tuple(errors), peaks=peaks)


def _difference_of_peaks(time: Floats, coarse: Floats, fine: Floats) -> float:
    """Largest difference of the peaks of histories (t, ..., c) over the largest length."""
    n, size = min(len(coarse), len(fine)), np.linalg.norm(fine, axis=-1).max()
    if fine.ndim == 3:  # stress at every section
        coarse, fine = (np.abs(stress).max(axis=(1, 2)) for stress in (coarse, fine))
    return peak_difference(time[:n], coarse[:n], fine[:n]) / float(size) if size > 0 else 0.0
