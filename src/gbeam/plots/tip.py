"""The tip's displacement in all environments, and how a centrifuge's differs from the flight's."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gbeam.plots.drawing.lines import FLIGHT, line, machine
from gbeam.plots.drawing.stretches import Stretch, shade, stretches
from gbeam.plots.drawing.style import colour, heading, judged, moving, panels, scale_to, show_zero, styled, subtitle
from gbeam.plots.drawing.units import largest, not_drawn, unit_for
from gbeam.results.imitation.comparison import Comparison
from gbeam.results.response import Response
from gbeam.results.study import Study


@styled
def plot_tip(study: Study) -> Figure:
    """Plot the tip's displacement along every axis in which it moves.

    Parameters
    ----------
    study : Study

    Returns
    -------
    Figure
        Per axis all environments overlaid, and for each comparison centrifuge less flight; the times that are not
        followed shaded. An axis along which the tip moves by less than a hundredth of the most is named only.
    """
    responses, compared = study.responses, study.comparisons
    sizes = [each.peaks.max_abs for each in responses.values()]
    shown = sorted(moving(*sizes), key=lambda axis: -max(each[axis] for each in sizes))
    heights = [each for _ in shown for each in (1.6 if len(shown) == 1 else 1.2, *[0.9] * len(compared))]
    heights = heights if len(heights) > 1 else [2.0]
    subject = f"tip displacement relative to the base{not_drawn(shown, *sizes)}"
    errors = {name if len(responses) > 1 else "": each.error_estimate for name, each in responses.items()}
    title = heading(study.title, judged(subject, errors), responses.values())
    figure, drawn = panels(title, len(heights), heights=heights)
    marked = [_stretches(responses, each) for each in compared]
    alone = [] if compared else [each for r in responses.values() for each in stretches(r.axes, r.time)]
    rows = len(compared) + 1
    for k, axis in enumerate(shown):
        top, *below = drawn[rows * k : rows * (k + 1)]
        _displacement(top, study, axis, named=len(responses) > 1 and k == 0)
        for panel, each in zip(below, compared, strict=True):
            _difference(panel, each, axis, colours(study)[each.centrifuge])
        if len(compared) == 1:
            shade([top, *below], marked[0], label=k == 0)
        elif compared:
            for panel, some in zip(below, marked, strict=True):
                shade([panel], some)
        elif len(responses) == 1:
            shade([top], alone, label=k == 0)
    return figure


def colours(study: Study) -> dict[str, int]:
    """Number of the colour of every environment that is no flight of a comparison."""
    flights = {each.flight for each in study.comparisons}
    return {name: k for k, name in enumerate(name for name in study.responses if name not in flights)}


def _displacement(panel: Axes, study: Study, axis: int, *, named: bool) -> None:
    responses, flights = study.responses, {each.flight for each in study.comparisons}
    unit = unit_for("length", *(each.tip[:, axis] for each in responses.values()))
    for name, response in responses.items():
        if name in flights:
            style = dict(FLIGHT)
        else:
            k = colours(study)[name]
            style = machine(k) if flights else {"color": colour(k)}
        dot = "o" if len(response.time) == 1 else ""  # what diverged at once is no line
        line(
            panel,
            response.time,
            unit.factor * response.tip[:, axis],
            marker=dot,
            label=name if named else None,
            **style,
        )
    show_zero(panel)
    panel.set_ylabel(f"{'xyz'[axis]}, {unit.name}")


def _difference(panel: Axes, compared: Comparison, axis: int, index: int) -> None:
    difference, covered = compared.difference[:, axis], compared.covered
    unit = unit_for("length", difference[covered] if covered.any() else difference)
    line(panel, compared.time, unit.factor * difference, **machine(index))
    show_zero(panel)
    panel.set_ylabel(f"difference in {'xyz'[axis]},\n{unit.name}")
    # What happens while the target is held is no difference from flight: it must not set the scale.
    scaled = scale_to(panel, covered, unit.factor * difference)
    beyond = scaled and largest(difference) > 1.05 * largest(difference[covered])
    subtitle(panel, f"{compared.centrifuge} − {compared.flight}" + (", scaled to the times compared" if beyond else ""))


def _stretches(responses: dict[str, Response], compared: Comparison) -> list[Stretch]:
    response = responses.get(compared.centrifuge)
    if response is None:
        return stretches(None, compared.time, compared.accounting)
    return stretches(response.axes, response.time, compared.accounting)
