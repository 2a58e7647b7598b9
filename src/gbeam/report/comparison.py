"""The parts of a comparison as JSON and as lines for a terminal."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from gbeam.results.comparison import Comparison, Mismatch, RootLoads, Sizes


def _xyz(values: Iterable[float]) -> dict[str, float]:
    return {axis: float(value) for axis, value in zip("xyz", values, strict=True)}


def comparison_parts(it: Comparison) -> dict[str, Any]:
    """Return ``stations``, ``mismatch``, ``root`` and ``shock`` of a comparison, those that it has; SI units."""
    parts: dict[str, Any] = {}
    if it.stations is not None:
        names = ("flight", "centrifuge", "difference")
        parts["cutoff"] = it.stations.cutoff
        parts["stations"] = [
            {"at": float(x), **{name: _sizes(getattr(it.stations, name), k) for name in names}}
            for k, x in enumerate(it.stations.stations)
        ]
    if it.mismatch is not None:
        parts["mismatch"] = _mismatch(it.mismatch)
    if it.root is not None:
        parts["root"] = _root(it.root)
    if it.shock is not None:
        parts["shock"] = {
            "quality": it.shock.quality,
            "frequency": it.shock.frequency.tolist(),
            "flight": it.shock.flight.tolist(),
            "centrifuge": it.shock.centrifuge.tolist(),
        }
    return parts


def _sizes(it: Sizes, station: int) -> dict[str, Any]:
    return {name: _xyz(getattr(it, name)[station]) for name in ("peak", "rms", "residual")}


def _mismatch(it: Mismatch) -> dict[str, Any]:
    names = ("max_gradient", "max_acceleration", "tip_bound", "force_bound", "moment_bound")
    return {"control_point": it.control_point, **{name: _xyz(getattr(it, name)) for name in names}}


def _root(it: RootLoads) -> dict[str, Any]:
    places = ("flight", "centrifuge", "difference")
    return {
        "force": {place: _xyz(getattr(it, f"force_{place}")) for place in places},
        "moment": {place: _xyz(getattr(it, f"moment_{place}")) for place in places},
        "stress": {place: getattr(it, f"stress_{place}") for place in places},
    }


def comparison_lines(it: Comparison) -> Iterator[str]:
    """What a person wants to know beside the verdict: root loads, vibration, and what the mismatch can do."""
    main = it.main_axis
    if it.root is not None:
        r, bent = it.root, int(np.argmax(it.root.moment_flight))
        yield (
            f"root moment {r.moment_flight[bent]:.4g} N m in flight, {r.moment_centrifuge[bent]:.4g} N m here; "
            f"stress {1e-6 * r.stress_flight:.4g} and {1e-6 * r.stress_centrifuge:.4g} MPa"
        )
    if it.stations is not None:
        flight, here = (1e3 * sizes.residual[-1, main] for sizes in (it.stations.flight, it.stations.centrifuge))
        yield (
            f"elastic vibration of the tip {flight:.3g} mm in flight, {here:.3g} mm here "
            f"(above {it.stations.cutoff:.3g} Hz, zero phase)"
        )
    if it.mismatch is not None:
        bound = it.mismatch.tip_bound[main]
        yield (
            f"mismatch up to {it.mismatch.max_acceleration[main]:.3g} m/s² along the beam, worth {1e3 * bound:.3g} mm "
            "at the tip if it acted slowly; `gbeam place` says where to put the specimen"
        )
