"""A comparison of a centrifuge's response with flight's, as lines below its verdict."""

from __future__ import annotations

import math
from collections.abc import Iterator

from gbeam.report.machine import accounting
from gbeam.report.words import number
from gbeam.results.imitation.comparison import Comparison
from gbeam.results.imitation.criteria import RULES
from gbeam.results.imitation.verdict import metres, percent

_FELT = 0.01  # of flight's peak: a mismatch that bends the tip by less is no reason to move the specimen


def lines(comparison: Comparison) -> Iterator[str]:
    """Acceptance, load peaks, differences, vibration, and a bound on what the mismatch field can do."""
    main = comparison.main_axis
    yield from accounting.judged_lines(comparison)
    yield from accounting.peak_lines(comparison.peaks)
    if comparison.covered.any():
        root = "" if comparison.root is None else f", root moment by up to {percent(comparison.root.moment_agreement)}"
        yield (
            f"while the target is the flight's load: tip differs along {'xyz'[main]} by up to "
            f"{metres(comparison.max_difference[main])}, {percent(comparison.relative[main])} of its peak{root}"
        )
    if comparison.fatigue is not None and math.isfinite(comparison.fatigue.damage_ratio):
        fatigue = comparison.fatigue
        ranges = (1e-6 * each.largest for each in (fatigue.flight, fatigue.machine))
        yield (
            "stress cycles of the root up to {:.4g} MPa in flight, {:.4g} MPa on the centrifuge: ".format(*ranges)
            + f"{number(fatigue.damage_ratio, 3)} times flight's damage (Wöhler exponent {fatigue.exponent:g})"
        )
    if comparison.shock is not None and comparison.shock.extremes:
        least, most = sorted(comparison.shock.extremes, key=lambda each: each.ratio)
        written = RULES["srs"].written
        yield (
            f"shock response spectra of the tip on the centrifuge {written(least.ratio)} {least} to "
            f"{written(most.ratio)} {most}, beside flight's"
        )
    if comparison.stations is not None:
        both = comparison.stations.flight, comparison.stations.centrifuge
        flight, centrifuge = (1e3 * sizes.residual[-1, main] for sizes in both)
        yield (
            f"elastic vibration of the tip {flight:.3g} mm in flight, {centrifuge:.3g} mm on the centrifuge "
            f"(above {comparison.stations.cutoff:.3g} Hz, zero phase)"
        )
    if comparison.mismatch is not None:
        mismatch = comparison.mismatch
        felt = mismatch.tip_bound[main] > _FELT * comparison.peak_flight[main]
        advice = "; `gbeam place` finds the best control point" if felt and not mismatch.placed else ""
        yield (
            f"mismatch up to {mismatch.max_acceleration[main]:.3g} m/s² along the beam, which bends the tip "
            f"by up to {1e3 * mismatch.tip_bound[main]:.3g} mm quasi-statically{advice}"
        )
