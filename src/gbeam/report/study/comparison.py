"""A comparison of a centrifuge's response with flight's: as JSON, and as lines below its verdict."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

from gbeam.report.machine import accounting
from gbeam.report.words import number, xyz
from gbeam.results.imitation.comparison import Comparison
from gbeam.results.imitation.criteria import RULES
from gbeam.results.imitation.measures import Fatigue, Mismatch, RootLoads, Sizes, StressCycles
from gbeam.results.imitation.verdict import metres, percent

_PLACES = ("flight", "centrifuge", "difference")
_FELT = 0.01  # of flight's peak: a mismatch that bends the tip by less is no reason to move the specimen


def to_json(comparison: Comparison) -> dict[str, Any]:
    """Comparison as JSON, SI: ``stations``, ``mismatch``, ``root``, ``fatigue``, ``shock`` where it has them."""
    values = {
        "flight": comparison.flight,
        "centrifuge": comparison.centrifuge,
        "verdict": comparison.verdict,
        **accounting.judged_json(comparison),
        "margin": None
        if comparison.margins is None
        else dict(zip(("flight", "machine"), comparison.margins, strict=True)),
        "covered": float(comparison.covered.mean()),
        "max_difference": xyz(comparison.max_difference),
        "rms_difference": xyz(comparison.rms_difference),
        "peak_flight": xyz(comparison.peak_flight),
        "peak_centrifuge": xyz(comparison.peak_centrifuge),
        "relative": xyz(comparison.relative),
        "lines": list(lines(comparison)),
    }
    if comparison.stations is not None:
        values["cutoff"] = comparison.stations.cutoff
        values["stations"] = [
            {"at": float(x), **{place: _sizes(getattr(comparison.stations, place), k) for place in _PLACES}}
            for k, x in enumerate(comparison.stations.stations)
        ]
    if comparison.mismatch is not None:
        values["mismatch"] = _mismatch(comparison.mismatch)
    if comparison.root is not None:
        values["root"] = _root(comparison.root)
    if comparison.fatigue is not None:
        values["fatigue"] = _fatigue(comparison.fatigue)
    if comparison.shock is not None:
        values["shock"] = {
            "quality": comparison.shock.quality,
            "frequency": comparison.shock.frequency.tolist(),
            "flight": comparison.shock.flight.tolist(),
            "centrifuge": comparison.shock.centrifuge.tolist(),
            "extremes": [asdict(each) for each in comparison.shock.extremes],
        }
    return values


def _sizes(sizes: Sizes, station: int) -> dict[str, Any]:
    return {name: xyz(getattr(sizes, name)[station]) for name in ("peak", "rms", "residual")}


def _mismatch(mismatch: Mismatch) -> dict[str, Any]:
    names = ("max_gradient", "max_acceleration", "tip_bound", "force_bound", "moment_bound")
    return {"control_point": mismatch.control_point, **{name: xyz(getattr(mismatch, name)) for name in names}}


def _root(root: RootLoads) -> dict[str, Any]:
    return {
        "force": {place: xyz(getattr(root, f"force_{place}")) for place in _PLACES},
        "moment": {place: xyz(getattr(root, f"moment_{place}")) for place in _PLACES},
        "stress": {place: getattr(root, f"stress_{place}") for place in _PLACES},
    }


def _fatigue(fatigue: Fatigue) -> dict[str, Any]:
    """Numbers of cycles and their ranges, Pa."""
    values: dict[str, Any] = {"exponent": fatigue.exponent, "damage_ratio": fatigue.damage_ratio}
    for place in ("flight", "machine"):
        cycles: StressCycles = getattr(fatigue, place)
        values[place] = {
            "cycles": cycles.total,
            "largest_range": cycles.largest,
            "equivalent_range": cycles.equivalent_range(fatigue.exponent),
        }
    return values


def lines(comparison: Comparison) -> Iterator[str]:
    """What was accepted, load peaks, differences, vibration, and a bound on what the mismatch field can do."""
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
