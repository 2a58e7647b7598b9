"""The tip's displacement in all environments, and how a centrifuge's differs from the flight's."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from gbeam.plots.style import REFERENCE, colour, heading, legend, line, panels, scale_to, shade, show_zero, styled
from gbeam.results.study import Study


@styled
def plot_tip(study: Study) -> Figure:
    """Plot the tip's displacement along the axis in which it moves most.

    Parameters
    ----------
    study : Study

    Returns
    -------
    Figure
        All environments overlaid; below, for each comparison, centrifuge less flight, with the held times shaded.
    """
    responses = study.responses
    axis = main_axis(study)
    heights = [1.6 if study.comparisons else 2.0] + [1.0] * len(study.comparisons)
    title = heading(study.title, f"tip displacement along {'xyz'[axis]}, relative to the base", responses.values())
    figure, (top, *below) = panels(title, len(heights), heights=heights)
    flights = {c.flight for c in study.comparisons}
    others = [name for name in responses if name not in flights]
    for name, response in responses.items():
        dot = "o" if len(response.time) == 1 else ""  # what diverged at once is no line
        # A flight is drawn thin on what imitates it: a vibration would hide it.
        if name in flights:
            style = {"color": REFERENCE, "lw": 0.8, "zorder": 3}
        else:
            style = {"color": colour(others.index(name)), "lw": 1.6 if flights else 1.1}
        line(top, response.time, 1e3 * response.tip[:, axis], marker=dot, label=name, **style)
    show_zero(top)
    top.set_ylabel("displacement, mm")
    together = all(np.array_equal(each.covered, study.comparisons[0].covered) for each in study.comparisons)
    if study.comparisons and together:
        shade(top, study.comparisons[0].time, ~study.comparisons[0].covered)
    if len(responses) > 1:
        legend(top)
    for panel, compared in zip(below, study.comparisons, strict=True):
        difference, covered = 1e3 * compared.difference[:, axis], compared.covered
        line(panel, compared.time, difference, color=colour(others.index(compared.centrifuge)))
        shade(panel, compared.time, ~covered)
        if not together and not covered.all():
            legend(panel)
        show_zero(panel)
        panel.set_ylabel("difference, mm")
        # What happens while the target is held is no difference from flight: it must not set the scale.
        scaled = ", scaled to the times compared" if scale_to(panel, covered, difference) else ""
        panel.set_title(f"{compared.centrifuge} − {compared.flight}{scaled}", loc="left", fontsize=9)
    return figure


def main_axis(study: Study) -> int:
    """Axis (0, 1, 2) along which the tip moves most, in flight where there is one."""
    flights = [each for each in study.responses.values() if each.environment == "flight"]
    largest = [each.peaks.max_abs for each in flights or study.responses.values()]
    return int(np.argmax(np.max(largest, axis=0)))
