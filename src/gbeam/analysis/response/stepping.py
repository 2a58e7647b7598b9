"""Which scheme, and which step: halved until the error estimated from two runs is within the tolerance."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from gbeam.analysis.response.peaks import vector_peaks
from gbeam.analysis.response.settings import ResponseSettings
from gbeam.errors import InputError
from gbeam.integrate.driver import Trajectory
from gbeam.integrate.schemes import Scheme, gauss, generalized_alpha, hht, newmark
from gbeam.mechanics.structure import Structure
from gbeam.motion.protocol import Motion
from gbeam.results.result import Floats

MAX_STEPS = 4_000_000
ONE_CORNER = 1e-6  # of the duration: corners nearer to one another are one
PEAKS = 10  # how many times more accurate than the histories the peaks are


def scheme_of(settings: ResponseSettings) -> Scheme:
    """The integration scheme that the settings name."""
    match settings.integrator:
        case "newmark":
            return newmark(**settings.parameters)
        case "hht":
            return hht(**{"alpha": -0.1, **settings.parameters})
        case "generalized-alpha":
            return generalized_alpha(**{"rho_inf": 0.9, **settings.parameters})
        case "gauss":
            return gauss()
    raise InputError(
        "response.integrator",
        f"is {settings.integrator!r}",
        "choose newmark, hht, generalized-alpha, gauss or adaptive",
    )


def first_step(structure: Structure, motion: Motion, settings: ResponseSettings) -> float:
    """Step of the results, s: an even number over the duration, at least 500 and 20 to the lowest period.

    No step is longer than the shortest time between two corners of the motion or of the loads, so that no pulse between
    them goes unseen.
    """
    largest = min(2 * math.pi / float(structure.rest[0][0]) / 20, settings.duration / 500)
    inside = np.unique(np.clip(corners(structure, motion) - settings.start, 0.0, settings.duration))
    gaps = np.diff(inside)
    largest = min(largest, gaps.min(where=gaps > ONE_CORNER * settings.duration, initial=largest))
    return settings.duration / (2 * math.ceil(settings.duration / largest / 2))


def corners(structure: Structure, motion: Motion) -> Floats:
    """Times at which the motion or the loads have a corner or jump, s."""
    breaks = [] if structure.history is None else [structure.history.breaks]
    return np.concatenate([np.asarray(motion.breaks), *breaks])


def difference(coarse: Floats, fine: Floats, ratio: int) -> float:
    """Largest difference of two tip histories at the coarse one's times, over the largest displacement."""
    n = min(len(coarse), (len(fine) - 1) // ratio + 1)
    size = np.abs(fine).max()
    return float(np.abs(coarse[:n] - fine[: (n - 1) * ratio + 1 : ratio]).max() / size) if size > 0 else 0.0


def peak_difference(coarse: Floats, fine: Floats) -> float:
    """Difference of the peaks of a vector's components and length in two runs, (4,), over the largest."""
    return float(np.abs(coarse - fine).max() / fine.max()) if fine.max() > 0 else 0.0


def refine(
    run: Callable[[float, str], Trajectory],
    tip: Callable[[Trajectory], Floats],
    moment: Callable[[Trajectory], Floats],
    coarse: float,
    order: int,
    settings: ResponseSettings,
) -> tuple[Trajectory, float, float]:
    """Halve the step, from twice the results', until the error estimated from two runs is within the tolerance.

    The estimate is Richardson's: with steps h and h/r the finer run's error is their difference over rᵖ − 1. Most of it
    is a delay, and peaks are better: they are refined until those of the tip and of the root's moment, (t, 3) each, are
    within a tenth of the tolerance.
    """

    def read(trajectory: Trajectory) -> tuple[Floats, list[Floats]]:
        """Displacement of the tip over time; its peaks and those of the root's moment."""
        moved = tip(trajectory)
        return moved, [vector_peaks(trajectory.time, each)[0] for each in (moved, moment(trajectory))]

    old, level, ratio = run(2 * coarse, "integrating"), -1, 2
    before, peaks_before = read(old)
    while True:
        step = coarse / 2**level / ratio
        new = run(step, f"refining the step to {1e3 * step:.3g} ms")
        moved, peaks = read(new)
        share = ratio**order - 1
        error = difference(before, moved, ratio) / share
        of_peaks = max(peak_difference(*each) / share for each in zip(peaks_before, peaks, strict=True))
        worst = max(error, PEAKS * of_peaks)
        level += round(math.log2(ratio))
        if (worst <= settings.tolerance and new.whole) or not (new.whole or old.whole):
            return new, step, error
        # Jump to the step that the order promises, at most 16 times finer.
        halvings = math.ceil(math.log2(max(worst / settings.tolerance, 2.0)) / order) if math.isfinite(worst) else 1
        ratio = 2 ** min(max(halvings, 1), 4)
        if settings.duration / step * ratio > MAX_STEPS:
            return new, step, error
        old, before, peaks_before = new, moved, peaks
