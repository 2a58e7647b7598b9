"""The pages of an equilibrium, and of where it is lost."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from gbeam.report import words
from gbeam.report.page.parts import Cell, Value, heading, known, paragraph, plot_places, raised, table
from gbeam.report.page.series import Numbers, Plots

Facts = Mapping[str, Any]


def static_body(facts: Facts, _: Mapping[str, Any], numbers: Numbers, plots: Plots, header: dict[str, Any]) -> str:
    """Where the beam rests in every motion, and what its sections carry."""
    motions = facts["motions"]
    parts = [
        paragraph(f"motion {name}: unstable, no beam would stay there", "bad")
        for name, each in motions.items()
        if not each["stable"]
    ]
    parts += [heading("Deflection"), _tips(motions), _loads(motions)]
    drawn = [plot for i, axis in enumerate("xyz") if (plot := _shape(motions, axis, colour=i, plots=plots)) is not None]
    return "".join([*parts, heading("Along the beam"), plot_places([*drawn, *_moments(motions, plots)])])


def _tips(motions: Facts) -> str:
    def row(name: str, each: Facts) -> list[Value]:
        error = known(each["errors"]["displacement"]["total"])
        return [name, each["time"], each["model"], *(1e3 * each["tip"][axis] for axis in "xyz"), words.percent(error)]

    head = ("motion", "at, s", "model", "x, mm", "y, mm", "z, mm", "estimated error")
    return table(head, (row(*each) for each in motions.items()), "Displacement of the tip", words=(0, 2))


def _loads(motions: Facts) -> str:
    def row(name: str, loads: Facts) -> list[Value]:
        stress = [known(each) for each in loads["stress"]]
        vectors = [loads[key][axis] for key in ("root_force", "root_moment") for axis in "xyz"]
        return [name, *vectors, 1e-6 * max(stress, default=np.nan)]

    head = ("motion", *(f"{of} {axis}" for of in ("force, N:", "moment, N m:") for axis in "xyz"), "stress, MPa")
    rows = (row(name, each["loads"]) for name, each in motions.items() if "loads" in each)
    return table(head, rows, "Of the base on the root, base axes; largest stress anywhere")


def _shape(motions: Facts, axis: str, *, colour: int, plots: Plots) -> tuple[str, str] | None:
    largest = max(abs(known(v)) for each in motions.values() for a in "xyz" for v in each["displacement"][a])
    values = {name: 1e3 * np.array(each["displacement"][axis], dtype=float) for name, each in motions.items()}
    if not any(np.abs(each).max() > 10 * largest for each in values.values()):  # a hundredth, in mm of m
        return None
    lines = [
        {"label": name, "x": np.array(motions[name]["stations"]), "y": each, "colour": i}
        for i, (name, each) in enumerate(values.items())
    ]
    title = f"Displacement along {axis}"
    return plots.add(title, "displacement, mm", lines, x="position along the beam, m"), title


def _moments(motions: Facts, plots: Plots) -> list[tuple[str, str]]:
    loads = {name: each["loads"] for name, each in motions.items() if "loads" in each}
    lines = [
        {
            "label": name,
            "x": np.array(each["stations"]),
            "y": np.linalg.norm([each["section_moment"][axis] for axis in "xyz"], axis=0),
            "colour": i,
        }
        for i, (name, each) in enumerate(loads.items())
    ]
    title = "Moment of the sections"
    return [(plots.add(title, "moment, N m", lines, x="position along the beam, m"), title)] if lines else []


def critical_body(facts: Facts, _: Mapping[str, Any], numbers: Numbers, plots: Plots, header: dict[str, Any]) -> str:
    """The value at which the equilibrium is lost, or that there is none up to the end of the search."""
    value = next((facts[key] for key in facts if key.startswith("critical_")), None)
    unit = f", {raised(facts['unit'])}" if facts["unit"] else ""
    rows: list[list[Value]] = [
        [f"{facts['quantity']}{unit}", value if value is not None else Cell("none")],
        [f"searched to{unit}", facts["searched_to"]],
        ["how it is lost", Cell(facts["kind"] or "–")],
        ["along", Cell(facts["direction"] or "–")],
        ["model", Cell(facts["model"])],
        ["estimated error", Cell(words.percent(known(facts["error_estimate"])))],
    ]
    motion = f"motion {facts['motion']}: " if facts["motion"] else ""
    return paragraph(f"{motion}{facts['reason']}", "verdict") + table(("", ""), rows)


def critical_map_body(
    facts: Facts, _: Mapping[str, Any], numbers: Numbers, plots: Plots, header: dict[str, Any]
) -> str:
    """Hub rates at which the equilibrium is lost, against one more mass and where it sits."""
    speed = np.array(facts["critical_speed"], dtype=float)
    head = ("at, m", *(f"{words.number(mass)} kg" for mass in facts["mass"]))
    rows = ([place, *values] for place, values in zip(facts["position"], speed.T.tolist(), strict=True))
    caption = f"Critical hub rate, rad/s, with one more mass; –: none up to {words.number(facts['searched_to'])} rad/s"
    lines = [
        {"label": f"{words.number(mass)} kg", "x": np.array(facts["position"]), "y": values, "colour": i % 6}
        for i, (mass, values) in enumerate(zip(facts["mass"], speed, strict=True))
    ]
    drawn = []
    if np.isfinite(speed).any():
        name = plots.add("Critical hub rate", "critical rate, rad/s", lines, x="position of the mass, m")
        drawn.append((name, "Critical hub rate with one more mass"))
    text = paragraph(f"motion {facts['motion']}, model {facts['model']}")
    return text + table(head, rows, caption, words=()) + plot_places(drawn)
