"""Pages of one case: the inside of a run's, and of those of steady states.

A run has its verdict and accounting, response, machine and accuracy; a steady state its deflections, modes, Campbell
diagram or critical values. Every part is read from the facts of ``--json``."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from gbeam.figures.description import raised
from gbeam.report.page.machine import machine_section, verdict
from gbeam.report.page.parts import Cell, Value, folded, heading, known, listed, paragraph, section, table
from gbeam.report.steady import RESTING, ROUNDING
from gbeam.report.words import number, percent, tidy
from gbeam.results.errors import along

Facts = Mapping[str, Any]


def run_body(facts: Facts, viewer: str, drawn: str) -> str:
    """The page's inside."""
    motions = {name: each for name, each in facts["motions"].items() if "environment" in each}
    parts = [verdicts(facts), section("Motion", viewer)]
    parts.append(section("Histories", drawn and paragraph(_HINT, "faint gbeam-screen") + drawn))
    parts += [heading("Response"), tips_table(motions), loads_table(motions)]
    parts += [stress_table({name: each["solid"] for name, each in motions.items() if "solid" in each})]
    parts += [specimen_tables({name: each["specimen"] for name, each in motions.items() if "specimen" in each})]
    parts += [machine_section(name, each) for name, each in motions.items() if "limits" in each]
    parts += [heading("Accuracy"), _errors(motions)]
    parts += [folded(f"{name}: in words", listed(each["lines"])) for name, each in motions.items()]
    return "".join(parts)


_HINT = "Drag across a plot to zoom all of them, double-click to see all again, click to take the viewer to that time."


def warnings(facts: Facts) -> list[str]:
    """Warnings of all motions, each once."""
    every = {warning: name for name, each in reversed(facts["motions"].items()) for warning in each.get("warnings", ())}
    several = len(facts["motions"]) > 1
    return [f"{name}: {warning}" if several else warning for warning, name in reversed(every.items())]


def verdicts(facts: Facts) -> str:
    """Runs that went wrong, and how well each centrifuge imitates its flight."""
    parts = []
    for name, each in facts["motions"].items():
        if each["outcome"] != "done":
            parts.append(paragraph(f"motion {name} {each['outcome']}: {each['message']}", "bad"))
    for compared in facts["comparisons"]:
        parts.append(verdict(compared, (compared["flight"], compared["centrifuge"])))
    return "".join([heading("Verdict"), *parts]) if parts else ""


def tips_table(motions: Facts) -> str:
    """Largest displacements of the tip."""
    rows = []
    for name, each in motions.items():
        for axis, peak in each["tip"].items():
            size, left = (known(peak.get(key)) for key in ("max_abs", "residual_amplitude"))
            if size > 1e-9 * max(known(other["max_abs"]) for other in each["tip"].values()):
                rows.append([name, axis, 1e3 * size, peak["time_of_max"], 1e3 * left])
    head = ("motion", "tip along", "largest, mm", "at, s", "residual amplitude, mm")
    return table(head, rows, "Displacement of the tip relative to the base axes", words=(0, 1), optional=(4,))


def loads_table(motions: Facts, of: str = "motion") -> str:
    """Largest loads of the root and stress, in every motion, or `of` every beam."""
    rows = []
    for name, each in motions.items():
        if "loads" in each:
            loads = each["loads"]
            force, moment = loads["root_force"]["size"], loads["root_moment"]["size"]
            stress = loads.get("stress", {})
            largest, margin = known(stress.get("max")), loads.get("margin", {}).get("min")
            row = [name, force["max_abs"], force["time_of_max"], moment["max_abs"], moment["time_of_max"]]
            rows.append([*row, 1e-6 * largest, stress.get("time_of_max"), margin])
    head = (of, "root force, N", "at, s", "root moment, N m", "at, s", "stress, MPa", "at, s", "margin on yield")
    stressed = any(math.isfinite(row[5]) for row in rows)  # of extreme fibres
    caption = f"Largest loads of the root{', and stress anywhere' if stressed else ''}"
    return table(head, rows, caption, optional=(5, 6, 7))


ERRORS = {
    "total": "total",
    "beam_theory": "of the beam theory",
    "mesh": "of the mesh",
    "model": "of the model",
    "shapes": "of too few shapes",
    "step": "of the time step",
}


def _errors(motions: Facts) -> str:
    rows = []
    for name, motion in motions.items():
        for quantity in ("loads",) if "specimen" in motion else ("displacement", "loads", "stress"):
            parts = [known(motion["errors"][quantity][key]) for key in ERRORS]
            if math.isfinite(parts[0]):
                rows.append([name, quantity, *map(percent, parts)])
    head, caption = ("motion", "of", *ERRORS.values()), "Estimated errors, of the largest size"
    shown = table(head, rows, caption, words=(0, 1), optional=range(3, len(head)))
    notes = {name: each["errors"].get("note") for name, each in motions.items()}
    said = "".join(paragraph(f"{name}: {note}", "faint") for name, note in notes.items() if note)
    return (shown or paragraph("no error estimate", "faint")) + said


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
    parts += [listed(growing, "bad"), heading("Modes"), modes_table(facts), noted(facts)]
    if not facts["damping_given"]:
        parts.append(paragraph("undamped: beam.damping_ratio is not given", "faint"))
    if facts["modes"]:
        unknown = "" if facts.get("section", {}).get("width") else "; a beam's section, which the result lacks, is not"
        drawing = paragraph(f"largest displacement 15 % of the length; the rest is drawn to scale{unknown}", "faint")
        parts.append(section("Shapes", viewer and viewer + drawing + drawn))
    return "".join(parts)


def campbell_body(facts: Facts, viewer: str, drawn: str) -> str:
    """Frequencies against speed, the multiples of the speed, and where they meet."""
    parts = [section("Campbell diagram", drawn)]
    if facts["critical_speed"] is not None:
        parts.append(paragraph(f"the equilibrium is lost at {number(facts['critical_speed'])} rad/s", "bad"))
    parts += [heading("Modes"), tracks_table(facts), noted(facts), heading("Crossings")]
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
    return table(
        ("mode", "frequency, Hz", "damping ratio", "along", "estimated error"), rows, words=(3,), optional=(4,)
    )


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


def noted(facts: Facts) -> str:
    """Paragraph on what estimated errors of frequencies leave out, or why there are none."""
    note = facts.get("error_note")
    return paragraph(f"estimated errors: {note}", "faint") if note else ""


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
    rigid = {name: each["specimen"] for name, each in motions.items() if "specimen" in each}
    bending = {name: each for name, each in motions.items() if name not in rigid}
    parts += [
        section("View", viewer),
        heading("Deflection" if bending else "Loads"),
        _tips(bending),
        resting_loads_table(motions),
    ]
    parts += [stress_table({name: each["solid"] for name, each in motions.items() if "solid" in each})]
    parts += [specimen_tables(rigid)]
    return "".join([*parts, section("Along the beam", drawn)])


def _tips(motions: Facts) -> str:
    def row(name: str, each: Facts) -> list[Value]:
        error = known(each["errors"]["displacement"]["total"])
        return [name, each["time"], each["model"], *(1e3 * each["tip"][axis] for axis in "xyz"), percent(error)]

    head = ("motion", "at, s", "model", "x, mm", "y, mm", "z, mm", "estimated error")
    return table(head, (row(*each) for each in motions.items()), "Displacement of the tip", words=(0, 2))


def resting_loads_table(motions: Facts, of: str = "motion") -> str:
    """Loads of the root and stress at rest, in every motion, or `of` every beam."""

    def row(name: str, loads: Facts) -> list[Value]:
        stress = [known(each) for each in loads["stress"]]
        vectors = [loads[key][axis] for key in ("root_force", "root_moment") for axis in "xyz"]
        return [name, *vectors, 1e-6 * max(stress, default=np.nan)]

    head = (of, *(f"{what} {axis}" for what in ("force, N:", "moment, N m:") for axis in "xyz"), "stress, MPa")
    loads = {name: each["loads"] for name, each in motions.items() if "loads" in each}
    stressed = any(size is not None for each in loads.values() for size in each["stress"])
    caption = f"Of the base on the root, base axes{'; largest stress anywhere' if stressed else ''}"
    return table(head, (row(*each) for each in loads.items()), caption, optional=(7,))


def stress_table(solids: Facts, of: str = "motion") -> str:
    """Largest von Mises stress of a mesh in every motion, or `of` every body, with its place and the least margin."""

    def row(name: str, solid: Facts) -> list[Value]:
        worst, near = solid["worst"], solid.get("nearest_yield")
        place = [1e3 * worst["place"][axis] for axis in "xyz"]
        margin = np.nan if near is None else near["margin"]
        apart = percent(worst["spread"]) if worst["spread"] else "–"  # of one element
        return [name, 1e-6 * worst["von_mises"], *place, Cell(worst["material"] or "–"), apart, margin]

    head = (of, "von Mises, MPa", "x, mm", "y, mm", "z, mm", "material", "elements differ by", "least margin on yield")
    return table(head, (row(*each) for each in solids.items()), "Largest stress, and where it is", words=(0, 5))


def specimen_tables(rigid: Facts) -> str:
    """Load at the corners of a rigid specimen in every motion, and on its bolts."""

    def row(name: str, each: Facts) -> list[Value]:
        worst, limit = each["largest_load"], known(each.get("spread_limit"))
        place = [1e3 * worst["place"][axis] for axis in "xyz"]
        held = {None: "", True: "good", False: "bad"}[each.get("within_limit")]
        return [name, worst["g"], *place, worst["time"], Cell(percent(each["spread"]), held), percent(limit)]

    head = ("motion", "largest, g", "x, mm", "y, mm", "z, mm", "at, s", "spread over the specimen", "limit")
    corners = table(head, (row(*each) for each in rigid.items()), "Load at the corners")
    force = max((each["force"]["max_abs"] for each in rigid.values()), default=0.0)
    bolts = [
        [name, f"{k}", *(1e3 * bolt["place"][axis] for axis in "xyz"), *tidy((bolt["tension"], bolt["shear"]), force)]
        for name, each in rigid.items()
        for k, bolt in enumerate(each["bolts"], 1)
    ]
    of_bolts = ("motion", "bolt", "x, mm", "y, mm", "z, mm", "tension, N", "shear, N")
    return corners + table(of_bolts, bolts, "Largest loads of the bolts, alike and without preload", words=(0, 1))


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
        ["estimated error", Cell(percent(known(facts["error_estimate"])))],
    ]
    motion = f"motion {facts['motion']}: " if facts["motion"] else ""
    return paragraph(f"{motion}{facts['reason']}", "verdict") + table(("", ""), rows) + noted(facts)


def critical_map_body(facts: Facts, viewer: str, drawn: str) -> str:
    """Hub rates at which the equilibrium is lost, against one more mass and where it sits."""
    speed = np.array(facts["critical_speed"], dtype=float)
    head = ("at, m", *(f"{number(mass)} kg" for mass in facts["mass"]))
    rows = ([place, *values] for place, values in zip(facts["position"], speed.T.tolist(), strict=True))
    caption = f"Critical hub rate, rad/s, with one more mass; –: none up to {number(facts['searched_to'])} rad/s"
    text = paragraph(f"motion {facts['motion']}, model {facts['model']}")
    return text + table(head, rows, caption, words=()) + section("Figure", drawn)
