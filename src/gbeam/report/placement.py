"""Words of a placement of the specimen."""

from __future__ import annotations

import math
import textwrap

from gbeam.report.words import sentence, warning_lines
from gbeam.results.imitation.accounting import PeakPair
from gbeam.results.imitation.placement import Candidate, Placement
from gbeam.results.imitation.verdict import change, in_g

_PLACES = ("current", "best", "middle")
_LISTED = 6  # candidates of either kind
_WIDTH = 110  # columns


def placement(placement: Placement, written: str | None = None) -> str:
    """The best placement and how to apply it, every measure before and after, the simulations, the other candidates."""
    best, before = placement.best, placement.before
    parts = {name: weight for name, weight in placement.weights.items() if weight}
    measure = (
        " + ".join(f"{weight:g} × {name}" for name, weight in parts.items()) if len(parts) > 1 else next(iter(parts))
    )
    nearest = "" if placement.outcome == "done" else " (nearest to the limits, which none keeps)"
    lines = [
        f"{placement.centrifuge}, tracking {placement.flight}: least {measure}{nearest}",
        f"  control point  {1e3 * best.control_point:.2f} mm from the root, {placement.fraction:.4f} of the length "
        f"(now {1e3 * placement.current:.2f} mm)",
        f"  largest load   {largest(best.largest_load, None if before is None else before.largest_load)}",
        f"  mounting       {best.mounting}",
        f"  smoothing      {1e3 * best.smoothing:.4g} ms{_range(placement)}",
    ]
    if placement.changes:
        flags = " ".join(f'--set "{each}"' for each in placement.settings)
        lines.append(f"  to apply it    {flags}")
        lines.append(f"                 {f'written to {written}' if written else 'or place again with --write'}")
    lines += warning_lines(placement)
    if placement.message and placement.outcome == "done":
        lines += ["", *textwrap.wrap(sentence(placement.message), _WIDTH)]
    return "\n".join([*lines, *_measures(placement), *_verified(placement), *_candidates(placement, measure)])


def largest(load: PeakPair, before: PeakPair | None) -> str:
    """Largest load anywhere on the specimen as placed, in flight, and as it is mounted now."""
    if not math.isfinite(load.machine):
        return "not known"
    now = "" if before is None else f"; now {_load(before)}"
    return f"anywhere on the specimen {_load(load)}, {in_g(load.flight)} in flight{now}"


def _load(load: PeakPair) -> str:
    place = f" at {load.place_machine}" if load.place_machine else ""
    return f"{in_g(load.machine)}{place} ({change(load.ratio)})"


def _measures(placement: Placement) -> list[str]:
    """Every measure at every place: the mismatch field alone, and with the load's own error at the control point."""
    lines = ["", "Of flight's peak".ljust(19) + "".join(each.ljust(39) for each in ("mismatch field", "with tracking"))]
    lines.append(" " * 19 + 2 * "".join(place.ljust(13) for place in ("now", "placed", "at mid-span")))
    for name in placement.values["best"]:
        rows = (placement.values, placement.totals)
        cells = [_percent(each[place][name]) if each else "–" for each in rows for place in _PLACES]
        lines.append(f"  {name:<17}" + "".join(cell.ljust(13) for cell in cells))
    return [line.rstrip() for line in lines]


def _percent(share: float) -> str:
    return f"{100 * share:.3g} %" if share > 1e-8 else "0 %"  # below, it is rounding


def _range(placement: Placement) -> str:
    """Range that was searched, and whether the best lies at its end."""
    low, high = placement.widths
    if low == high:
        return ""
    searched = f", of {1e3 * low:.4g} to {1e3 * high:.4g} ms"
    if placement.best.smoothing > low * (1 + 1e-6):
        return searched + (": the widest tried" if placement.best.smoothing > high * (1 - 1e-6) else "")
    unlimited = "; no limit of the machine forbids less" if placement.best.share < 1 else ""
    return f"{searched}: the least tried{unlimited}"


def _verified(placement: Placement) -> list[str]:
    if not placement.verifications:
        return []
    checks = placement.checks
    lines = [
        "",
        "By simulation, largest difference from flight",
        " " * 19 + "tip          vibration    root shear   moment",
    ]
    for place, label in zip(_PLACES, ("now", "placed", "at mid-span"), strict=True):
        check = checks[place]
        values = (
            f"{1e3 * check.tip_difference:.4g} mm",
            f"{1e3 * check.vibration:.3g} mm",
            f"{check.force_difference:.3g} N",
            f"{check.moment_difference:.3g} N m",
        )
        lines.append(f"  {label:<17}" + "".join(value.ljust(13) for value in values).rstrip())
    gain = placement.vibration_gain
    return [*lines, f"  {gain:.3g} times less vibration than with the control point at mid-span"]


def _candidates(placement: Placement, measure: str) -> list[str]:
    kept = [candidate for candidate in placement.options if not candidate.exceeded]
    broken = [candidate for candidate in placement.options if candidate.exceeded]
    listed = [*kept[:_LISTED], *broken[:_LISTED]]
    lines = ["", f"Options by {measure} with what smoothing and tracking change of the load, best first"]
    lines += [_candidate(candidate) for candidate in listed]
    more = len(placement.options) - len(listed)
    lines += [f"  and {more} more: see --json"] if more else []
    return [*lines, *(f"  cannot: {reason}" for reason in placement.refused)]


def _candidate(candidate: Candidate) -> str:
    words = f"  {candidate.mounting}, {1e3 * candidate.smoothing:.4g} ms: {100 * candidate.total_error:.3g} % "
    words += f"at {1e3 * candidate.control_point:.2f} mm; "
    if candidate.exceeded:
        worst, others = max(candidate.exceeded, key=lambda use: use.share), len(candidate.exceeded) - 1
        return words + f"exceeds {worst}" + (f" and {others} more" if others else "")
    if math.isfinite(candidate.largest_load.machine):
        words += f"largest load {_load(candidate.largest_load)}; "
    peaks = ", ".join(f"{acceleration:.3g}" for acceleration in candidate.accelerations)
    share = f", {candidate.share:.0%} of a limit" if candidate.share else ""
    return words + f"axis accelerations {peaks} rad/s²{share}"
