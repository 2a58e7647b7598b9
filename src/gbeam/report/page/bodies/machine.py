"""The machine's part of a page, and the page of a plan."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from gbeam.report.machine.tracking import followed
from gbeam.report.page import curves
from gbeam.report.page.bodies.verdict import verdict
from gbeam.report.page.parts import Cell, Value, folded, heading, listed, paragraph, plot_places, raised, table
from gbeam.report.page.series import Numbers, Plots

Facts = Mapping[str, Any]


def plan_body(facts: Facts, variables: Mapping[str, Any], _: Numbers, plots: Plots, header: dict[str, Any]) -> str:
    """The verdict, what the axes do, what that uses of the limits, and where the target is held."""
    parts = []
    if "time" in variables:  # of the file of one plan
        variables = {f"motions/{name}/{key}": each for name in facts["motions"] for key, each in variables.items()}
    for name, each in facts["motions"].items():
        if each["outcome"] != "done":
            parts.append(paragraph(f"motion {name} {each['outcome']}: {each['message']}", "bad"))
        parts += [heading("Verdict"), verdict(each, (each["tracks"] or "flight", name))]
        parts.append(machine_section(name, each))
        rows = [[f"{part['start']:.3f}", f"{part['end']:.3f}", part["reason"]] for part in each["not_followed"]]
        held = table(("from, s", "to, s", "why"), rows, "The target is held", words=(2,))
        parts.append(held if len(rows) <= 12 else folded(f"{len(rows)} stretches in which the target is held", held))
        lacks = [f"{part['reason']} at {part['time']:.3f} s: {part['remedy']}" for part in each["shortfalls"]]
        parts.append(listed(lacks[:12], "warning"))
    drawn = curves.of_plan(facts["motions"], variables, plots)
    if drawn:
        parts += [heading("Histories"), plot_places(drawn)]
    return "".join(parts)


def machine_section(name: str, motion: Facts) -> str:
    """What is used of every limit, and how well the load is followed."""

    def row(use: Facts) -> list[Value]:
        limited = use["allowed"] is not None and math.isfinite(use["allowed"])
        kind = "bad" if use["exceeded"] else ""
        share = Cell(f"{use['share']:.0%}".replace("%", " %"), kind, use["share"]) if limited else "no limit"
        what = f"{use['axis']} {use['quantity']}"
        return [
            what,
            use["used"],
            use["allowed"],
            raised(use["unit"]),
            share,
            f"{use['time']:.3f}" if use["used"] else "–",
        ]

    head = ("", "used", "allowed", "unit", "share", "at, s")
    rows = map(row, motion["limits"])
    return heading(f"Machine: {name}") + table(head, rows, "Limits used", words=(0, 3)) + paragraph(followed(motion))
