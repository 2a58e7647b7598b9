"""The sentence that says how well a machine reproduces a flight, from the accounting of all of it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from gbeam.constants import STANDARD_GRAVITY
from gbeam.results.imitation.accounting import Accounting, LoadPeak, PeakPair
from gbeam.results.result import part_words

_FINEST = 1e-3  # how well a load peak is said to be reproduced at most
_TIMES = 3.0  # from here on a ratio says more than a change of so many per cent
_APART = 0.1  # s: the machine's peak has a time of its own


def verdict(
    flight: str,
    machine: str,
    peaks: Mapping[str, PeakPair],
    accounting: Accounting,
    within: float | None = None,
    margins: tuple[float, float] | None = None,
    whole: tuple[float, float] | None = None,
    point: str = "tip",
) -> str:
    """Return one sentence about the whole flight between motions of these names.

    The part of it that was run; the flight's largest load peak, where that is not reproduced; the largest load
    anywhere on the specimen, the tip's, or another `point`'s, and the root moment's peaks, of which the tip's counts as
    reproduced `within` a share (the load's tolerance by default), and the least `margins` on yield in flight and on the
    machine; how many load peaks are reproduced and how well; the time followed and why the rest is not; and what is
    loaded beyond.
    """
    within = accounting.tolerance if within is None else within
    said = [] if whole is None else [part_words(accounting.span, whole)]
    main = accounting.main
    if main is not None and main.reason:
        said.append(
            f"{flight}'s load peak of {in_g(main.load)} at {main.time:.2f} s is not reproduced: {machine} makes "
            f"{in_g(main.reproduced)} ({main.reason})"
        )
    largest = peaks.get("largest_load", PeakPair())
    if math.isfinite(largest.machine):
        said.append(_largest(flight, machine, largest))
    if "tip" in peaks:
        said.append(_tip(flight, machine, peaks["tip"], within, point))
    moment = peaks.get("root_moment", PeakPair())
    if math.isfinite(moment.ratio):
        said.append(f"root moment {change(moment.ratio)}")
    if margins is not None:
        beyond = [name for name, margin in zip((flight, machine), margins, strict=True) if margin < 0]
        above = f", ABOVE YIELD in {' and '.join(beyond)}" if beyond else ""
        said.append(f"margin on yield {margins[0]:.3g} in {flight}, {margins[1]:.3g} on {machine}{above}")
    said.append(_load_peaks(accounting))
    said += _missed(accounting, main)
    said.append(_time(accounting))
    if accounting.preloads:
        worst = max(accounting.preloads, key=lambda each: each.load - max(each.flight, accounting.idle))
        said.append(
            f"preload: {machine} makes {in_g(worst.load)} at {worst.time:.2f} s, where {flight} has "
            f"{in_g(worst.flight)}{f' and idle is {in_g(accounting.idle)}' if accounting.idle else ''}"
        )
    return "; ".join(said)


def _largest(flight: str, machine: str, load: PeakPair) -> str:
    ends = (
        f"{name} {in_g(size)}{f' at {place}' if place else ''} at {time:.2f} s"
        for name, size, place, time in (
            (flight, load.flight, load.place_flight, load.time_flight),
            (machine, load.machine, load.place_machine, load.time_machine),
        )
    )
    by = f" ({change(load.ratio)})" if math.isfinite(load.ratio) else ""
    return f"largest load anywhere on the specimen: {', '.join(ends)}{by}"


def _tip(flight: str, machine: str, tip: PeakPair, within: float, point: str) -> str:
    deflection = metres(tip.machine)
    if not math.isfinite(tip.ratio):
        return f"{point}: not moved by {flight}, by up to {deflection} on {machine}"
    begin = f"{point}: {flight}'s peak {metres(tip.flight)} at {tip.time_flight:.2f} s"
    when = f" at {tip.time_machine:.2f} s" if abs(tip.time_machine - tip.time_flight) > _APART else ""
    if abs(tip.ratio - 1) <= within:
        return f"{begin} reproduced as {deflection} ({change(tip.ratio)}){when}"
    return f"{begin} not reproduced: {deflection} on {machine} ({change(tip.ratio)}){when}"


def _load_peaks(accounting: Accounting) -> str:
    count, above = len(accounting.peaks), f" above {in_g(accounting.idle)}" if accounting.idle else ""
    if not count:
        return f"no load peak{above}"
    good = [peak for peak in accounting.peaks if not peak.reason]
    noun = "load peak" if count == 1 else "load peaks"
    within = f" within {percent(max(_FINEST, *(peak.error for peak in good)), up=True)}" if good else ""
    return f"{len(good)} of {count} {noun}{above} reproduced{within}"


def _missed(accounting: Accounting, main: LoadPeak | None) -> Iterator[str]:
    """The largest of the other peaks that are not reproduced."""
    others = [peak for peak in accounting.missed if peak is not main]
    if others:
        worst = max(others, key=lambda peak: peak.load)
        yield f"not the {in_g(worst.load)} at {worst.time:.2f} s: {in_g(worst.reproduced)} ({worst.reason})"


def _time(accounting: Accounting) -> str:
    followed = f"{100 * accounting.followed_share:.0f} % of the time followed within {against(accounting)}"
    shares = accounting.shares
    if len(shares) == 1:
        return f"{followed}; the rest is {next(iter(shares))}"
    # A share that rounds to nothing is listed among the stretches.
    parts = [f"{percent(share)} {reason}" for reason, share in shares.items() if share >= 0.005]
    return f"{followed}, {', '.join(parts)}" if parts else followed


def against(accounting: Accounting) -> str:
    """Write the difference from the flight's load within which it counts as followed."""
    share = percent(accounting.tolerance)
    if accounting.tolerance_of == "instant":
        return f"{share} of the load at the time"
    return f"{in_g(accounting.allowed)} ({share} of the largest load)"


def in_g(load: float) -> str:
    """Write a load, m/s², in g."""
    return f"{load / STANDARD_GRAVITY:.3g} g"


def metres(length: float) -> str:
    """Write a length in m, or in mm below 1 m."""
    return f"{length:.4g} m" if abs(length) >= 1 else f"{1e3 * length:.4g} mm"


def change(ratio: float) -> str:
    """Write by how much a ratio differs from one, with its sign; the ratio where it is large."""
    share = 100 * (ratio - 1)
    if ratio >= _TIMES:
        return f"× {ratio:.2g}" if ratio < 100 else f"× {ratio:.0f}"
    if abs(share) < 0.05:
        return "0.0 %"
    return f"{share:+.0f} %" if abs(share) >= 10 else f"{share:+.1f} %"


def percent(share: float, *, up: bool = False) -> str:
    """Write a share with two digits and no exponent; rounded `up` where it is a bound."""
    if not math.isfinite(share):
        return "an unknown share"
    value = 100 * share
    if up and value > 0:
        unit = 10.0 ** (math.floor(math.log10(value)) - 1)
        value = math.ceil(value / unit - 1e-9) * unit
    return f"{float(f'{value:.2g}'):g} %"
