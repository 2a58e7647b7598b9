"""Figures of a response: the tip, and what the sections carry."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gbeam.plots.lines import FLIGHT, Stretch, components, line, machine, shade, stretches
from gbeam.plots.style import (
    colour,
    heading,
    judged,
    limits,
    moving,
    named,
    panels,
    scale_to,
    show_zero,
    styled,
    subtitle,
)
from gbeam.plots.units import largest, not_drawn, unit_for
from gbeam.results.equilibrium import Deflection
from gbeam.results.imitation.comparison import Comparison
from gbeam.results.parts import Loads
from gbeam.results.response import Response
from gbeam.results.result import Floats
from gbeam.results.study import Study


@styled
def plot_tip(study: Study) -> Figure:
    """Plot the tip's displacement along every axis in which it moves."""
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


def _stretches(responses: Mapping[str, Response], compared: Comparison) -> list[Stretch]:
    response = responses.get(compared.centrifuge)
    if response is None:
        return stretches(None, compared.time, compared.accounting)
    return stretches(response.axes, response.time, compared.accounting)


FORCES = ("axial N", "shear V_y", "shear V_z")
MOMENTS = ("torque", "bending M_y", "bending M_z")


@styled
def plot_loads_along(deflection: Deflection, loads: Loads, title: str = "") -> Figure:
    """Plot along the beam at rest the sections' force and moment and, where known, the largest and smallest stress."""
    subject = f"internal loads at rest, {deflection.model}, t = {deflection.time:.4g} s"
    at, known = unit_for("length", loads.stations), bool(np.isfinite(loads.stress).all())
    errors = {"loads": deflection.errors.loads.total, "stress": deflection.errors.stress.total if known else math.nan}
    figure, drawn = panels(heading(title, judged(named(deflection.motion, subject), errors), []), 2 + known)
    drawn[-1].set_xlabel(f"position from the root, {at.name}")
    where, stress = at.factor * loads.stations, (loads.stress_tension[0], loads.stress_compression[0])
    _carried(drawn, where, loads.section_force[0], loads.section_moment[0], stress if known else None, loads)
    return figure


@styled
def plot_loads(response: Response, loads: Loads, title: str = "") -> Figure:
    """Plot over time what the root's section carries, the extreme stresses along the beam, and a hub's torque."""
    torque, known = loads.beam_torque, bool(np.isfinite(loads.stress).all())
    subject = named(response.name, "loads in the root's section, and stress anywhere along the beam")
    errors = {"loads": response.errors.loads.total, "stress": response.errors.stress.total if known else math.nan}
    figure, drawn = panels(heading(title, judged(subject, errors), [response]), 2 + known + (torque is not None))
    shade(drawn, stretches(response.axes, response.time))
    stress = (loads.stress_tension.max(axis=1), loads.stress_compression.min(axis=1)) if known else None
    _carried(drawn, response.time, loads.section_force[:, 0], loads.section_moment[:, 0], stress, loads)
    if torque is not None:
        unit = unit_for("moment", torque)
        line(drawn[-1], response.time, unit.factor * torque, color=colour(0))
        drawn[-1].set_ylabel(f"torque for\nthe beam, {unit.name}")
    return figure


def _carried(
    drawn: list[Axes], where: Floats, force: Floats, moment: Floats, stress: tuple[Floats, Floats] | None, loads: Loads
) -> None:
    """Draw forces and moments (k, 3) and, where they are known, the largest and the smallest stress (k,)."""
    for panel, kind, values, names in ((drawn[0], "force", force, FORCES), (drawn[1], "moment", moment, MOMENTS)):
        unit = unit_for(kind, values)
        components(panel, where, unit.factor * values, names)
        show_zero(panel)
        panel.set_ylabel(f"{kind}, {unit.name}")
    if stress is None:
        return
    panel, unit = drawn[2], unit_for("stress", *stress)
    for k, (values, name) in enumerate(zip(stress, ("largest", "smallest"), strict=True)):
        line(panel, where, unit.factor * values, color=colour(k), label=name)
    strength = math.inf if loads.yield_strength is None else loads.yield_strength
    limits(panel, unit.factor * strength, unit.factor * np.concatenate(stress), "yield strength")
    panel.set_ylabel(f"stress, {unit.name}")
