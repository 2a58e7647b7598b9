"""The inside of pages of steady states: deflections, modes, Campbell diagrams, critical values."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from gbeam.figures.description import raised
from gbeam.report import words
from gbeam.report.page.parts import Cell, Value, heading, known, listed, paragraph, section, table
from gbeam.report.steady import RESTING, ROUNDING
from gbeam.report.words import number, percent
from gbeam.results.errors import along

Facts = Mapping[str, Any]


def modes_body(facts: Facts, viewer: str, drawn: str) -> str:
    """Frequencies, damping and errors, and the shapes as they move."""
    base = facts["base"]
    rate = float(np.linalg.norm(list(base["angular_velocity"].values())))
    coupling = "in" if facts["gyroscopic"] else "left out"
    rate = rate if rate > RESTING else 0.0
    where = f"motion {facts['motion']} at {number(facts['time'])} s, model {facts['model']}"
    parts = [paragraph(f"{where}, base turning at {number(rate)} rad/s, Coriolis coupling {coupling}")]
    growing = [
        f"{each['kind']} {along(each['direction'])}: grows by {number(each['growth_rate'])} per second"
        for each in facts["instabilities"]
    ]
    parts += [listed(growing, "bad"), heading("Modes"), modes_table(facts)]
    if not facts["damping_given"]:
        parts.append(paragraph("undamped: beam.damping_ratio is not given", "faint"))
    if facts["modes"]:
        scale = "to scale" if facts.get("section", {}).get("width") else "not to scale: the result does not hold it"
        drawing = paragraph(f"largest displacement 15 % of the length; the section is drawn {scale}", "faint")
        parts.append(section("Shapes", viewer and viewer + drawing + drawn))
    return "".join(parts)


def campbell_body(facts: Facts, viewer: str, drawn: str) -> str:
    """Frequencies against speed, the multiples of the speed, and where they meet."""
    parts = [section("Campbell diagram", drawn)]
    if facts["critical_speed"] is not None:
        parts.append(paragraph(f"the equilibrium is lost at {number(facts['critical_speed'])} rad/s", "bad"))
    parts += [heading("Modes"), tracks_table(facts), heading("Crossings")]
    return "".join([*parts, crossings_table(facts) or paragraph("none in this range", "faint")])


def modes_table(facts: Facts) -> str:
    """Frequencies, damping ratios and errors."""
    rows = [
        [
            str(i),
            each["frequency"],
            percent(each["damping_ratio"] if abs(each["damping_ratio"]) > ROUNDING else 0.0),
            each["direction"],
            _error(each),
        ]
        for i, each in enumerate(facts["modes"], 1)
    ]
    return table(("mode", "frequency, Hz", "damping ratio", "along", "estimated error"), rows, words=(3,))


def tracks_table(facts: Facts) -> str:
    """First and last frequency of every mode of a Campbell diagram."""
    low, high = (f"Hz at {number(facts['speed'][at])} rad/s" for at in (0, -1))
    rows = [
        [str(i), each["direction"], each["frequency"][0], each["frequency"][-1], _error(each)]
        for i, each in enumerate(facts["tracks"], 1)
    ]
    return table(("mode", "along", low, high, "estimated error"), rows, words=(1,))


def crossings_table(facts: Facts) -> str:
    """Crossings of modes with multiples of the speed."""
    rows = [
        [
            str(each["track"] + 1),
            f"{each['order']} ×",
            each["speed"],
            60 * each["speed"] / (2 * np.pi),
            each["frequency"],
            _error(each),
        ]
        for each in facts["crossings"]
    ]
    heads = "mode", "multiple", "speed, rad/s", "speed, rpm", "frequency, Hz", "estimated error"
    return table(heads, rows)


def _error(facts: Facts) -> str:
    error = facts.get("error_estimate")
    return percent(np.nan if error is None else error)


def static_body(facts: Facts, viewer: str, drawn: str) -> str:
    """Deflection in every motion, and the loads of the sections."""
    motions = facts["motions"]
    parts = [
        paragraph(f"motion {name}: unstable, no beam would stay there", "bad")
        for name, each in motions.items()
        if not each["stable"]
    ]
    parts += [heading("Deflection"), _tips(motions), loads_table(motions)]
    return "".join([*parts, section("Along the beam", drawn)])


def _tips(motions: Facts) -> str:
    def row(name: str, each: Facts) -> list[Value]:
        error = known(each["errors"]["displacement"]["total"])
        return [name, each["time"], each["model"], *(1e3 * each["tip"][axis] for axis in "xyz"), words.percent(error)]

    head = ("motion", "at, s", "model", "x, mm", "y, mm", "z, mm", "estimated error")
    return table(head, (row(*each) for each in motions.items()), "Displacement of the tip", words=(0, 2))


def loads_table(motions: Facts, of: str = "motion") -> str:
    """Loads of the root and stress at rest, in every motion, or `of` every beam."""

    def row(name: str, loads: Facts) -> list[Value]:
        stress = [known(each) for each in loads["stress"]]
        vectors = [loads[key][axis] for key in ("root_force", "root_moment") for axis in "xyz"]
        return [name, *vectors, 1e-6 * max(stress, default=np.nan)]

    head = (of, *(f"{what} {axis}" for what in ("force, N:", "moment, N m:") for axis in "xyz"), "stress, MPa")
    rows = (row(name, each["loads"]) for name, each in motions.items() if "loads" in each)
    return table(head, rows, "Of the base on the root, base axes; largest stress anywhere")


def critical_body(facts: Facts, viewer: str, drawn: str) -> str:
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


def critical_map_body(facts: Facts, viewer: str, drawn: str) -> str:
    """Hub rates at which the equilibrium is lost, against one more mass and where it sits."""
    speed = np.array(facts["critical_speed"], dtype=float)
    head = ("at, m", *(f"{words.number(mass)} kg" for mass in facts["mass"]))
    rows = ([place, *values] for place, values in zip(facts["position"], speed.T.tolist(), strict=True))
    caption = f"Critical hub rate, rad/s, with one more mass; –: none up to {words.number(facts['searched_to'])} rad/s"
    text = paragraph(f"motion {facts['motion']}, model {facts['model']}")
    return text + table(head, rows, caption, words=()) + section("Figure", drawn)
