"""Stretches of time in which a machine does not follow the flight, shaded, each reason in its own pattern."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection

from gbeam.results.imitation.accounting import Accounting
from gbeam.results.machine import AxesResult
from gbeam.results.result import Floats

Stretch = tuple[float, float, str]  # start, end s, reason

# Colour and hatch, which tells them apart in print.
_PATTERNS = {
    "spin-up": ("#F8F8F8", "///"),
    "spin-down": ("#F8F8F8", "\\\\\\"),
    "below idle": ("#DEDEDE", None),
    "gimbals": ("#F5E3BE", "..."),
    "left out": ("#EFD3E4", "xxx"),
    "corner": ("#CFE8DE", "---"),
}
_LIMIT = ("#F7CDB8", "+++")  # of the machine, by its name
_HATCH = "#CCCCCC"
_SPAN = 1e-6  # s: shorter is rounding


def stretches(axes: AxesResult | None, time: Floats, accounting: Accounting | None = None) -> list[Stretch]:
    """Return the spin-up, what is not followed and why, and the spin-down, in order of time.

    Parameters
    ----------
    axes : AxesResult or None
        Of a machine; None for what has none.
    time : (t,) s
        Drawn.
    accounting : Accounting, optional
        Of the comparison with the flight, whose stretches are measured; else those of the machine's target.
    """
    if axes is None and accounting is None:
        return []
    if accounting is not None:
        held: list[Stretch] = [(each.start, each.end, each.reason) for each in accounting.not_followed]
    else:
        held = [] if axes is None else list(axes.episodes)
    first, last = (float(time[0]), float(time[-1])) if axes is None else axes.span
    ends = [(float(time[0]), first, "spin-up"), *held, (last, float(time[-1]), "spin-down")]
    return [(start, end, reason) for start, end, reason in ends if end - start > _SPAN]


def shade(panels: Sequence[Axes], marked: Iterable[Stretch], *, label: bool = True) -> None:
    """Shade stretches of time in all panels, and name their reasons in the legend of the first.

    Parameters
    ----------
    panels : sequence of Axes
    marked : iterable of (start s, end s, reason)
    label : bool
        Whether they are named.
    """
    by_reason: dict[str, list[Stretch]] = {}
    for each in marked:
        by_reason.setdefault(_short(each[2]), []).append(each)
    for panel in panels:
        for reason, some in by_reason.items():
            face, hatch = _PATTERNS.get(reason, _LIMIT)
            corners = [[(a, 0.0), (a, 1.0), (b, 1.0), (b, 0.0)] for a, b, _ in some]
            options: dict[str, Any] = {"label": reason} if label and panel is panels[0] else {"label": f"_{reason}"}
            # Not added as data, or the panel would stretch to it.
            panel.add_collection(
                PolyCollection(
                    corners,
                    transform=panel.get_xaxis_transform(),
                    facecolor=face,
                    edgecolor=_HATCH if hatch else "none",
                    hatch=hatch,
                    lw=0,
                    zorder=0,
                    **options,
                ),
                autolim=False,
            )


def _short(reason: str) -> str:
    """A reason as a legend has it: of several limits that are used up, ``axis 2 jerk, axis 3 jerk``, the axes only."""
    limits = reason.split(", ")
    if len(limits) == 1:
        return reason
    return f"limits of {' and '.join(sorted({each.rpartition(' ')[0] for each in limits}))}"
