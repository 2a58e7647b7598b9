"""The page of a run: verdict and accounting, response, machine, accuracy; every part from the facts of ``--json``."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from gbeam.report import words
from gbeam.report.page.machine import machine_section, verdict
from gbeam.report.page.parts import folded, heading, known, listed, paragraph, section, table

Facts = Mapping[str, Any]


def body(facts: Facts, viewer: str, drawn: str) -> str:
    """The page's inside."""
    motions = {name: each for name, each in facts["motions"].items() if "environment" in each}
    parts = [verdicts(facts), section("Motion", viewer)]
    parts.append(section("Histories", drawn and paragraph(_HINT, "faint gbeam-screen") + drawn))
    parts += [heading("Response"), tips_table(motions), loads_table(motions)]
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
    """What went wrong, and how well each centrifuge imitates its flight."""
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
    head = ["motion", "tip along", "largest, mm", "at, s", "residual amplitude, mm"]
    if all(math.isnan(float(row[-1])) for row in rows):
        head, rows = head[:-1], [row[:-1] for row in rows]
    return table(head, rows, "Displacement of the tip relative to the base axes", words=(0, 1))


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
    head = [of, "root force, N", "at, s", "root moment, N m", "at, s", "stress, MPa", "at, s", "margin on yield"]
    if all(row[-1] is None for row in rows):
        head, rows = head[:-1], [row[:-1] for row in rows]
    if all(math.isnan(row[5]) for row in rows):  # without extreme fibres
        head, rows = head[:5], [row[:5] for row in rows]
    return table(head, rows, "Largest loads of the root, and stress anywhere")


ERRORS = {
    "total": "total",
    "beam_theory": "of the beam theory",
    "model": "of the model",
    "shapes": "of too few shapes",
    "step": "of the time step",
}


def _errors(motions: Facts) -> str:
    rows = []
    for name, motion in motions.items():
        for quantity in ("displacement", "loads", "stress"):
            parts = [known(motion["errors"][quantity][key]) for key in ERRORS]
            if math.isfinite(parts[0]):
                rows.append([name, quantity, *(words.percent(part) for part in parts)])
    head = ("motion", "of", *ERRORS.values())
    caption = "Estimated errors, of the largest size"
    return table(head, rows, caption, words=(0, 1)) or paragraph("no error estimate", "faint")
