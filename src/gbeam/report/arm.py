"""Table of what plain arms hold, and what rigid specimens feel of it, by motion: in six directions six rows."""

from __future__ import annotations

from gbeam.constants import STANDARD_GRAVITY
from gbeam.report.blocks import Block, Columns, Facts, table
from gbeam.report.words import axis_words, number


def levels(motions: Facts) -> Block:
    """Table of the levels of plain arms: a row for each motion, or for each rigid specimen on it."""
    rows = []
    for name, motion in motions.items():
        if "level" in motion.get("hub", {}):
            for label, loads in _felt(name, motion).items():
                rows.append({"name": label, **motion["hub"]["level"], "felt": loads})
    cells: Columns = {
        "motion": "name",
        "along": lambda row: axis_words([*row["load"].values()]),
        "up": lambda row: axis_words([*row["up"].values()]),
        "level, g": "level",
        "centre, g": "felt.centre",
        "corners, g": lambda row: _range(row["felt"].get("corners", ())),
        "rate, rpm": "rate",
        "up in, s": "reached",
        "held, s": lambda row: row["ends"] - row["reached"],
        "onset, g/s": "onset",
        "tangential, g": "tangential",
    }
    caption = "Level at the control point, and with the weight what the centre of mass and the corners feel at most"
    felt = any(row["felt"] for row in rows)
    return table(rows, cells, caption if felt else "Level at the control point", optional=("centre, g", "corners, g"))


def balance(motions: Facts) -> Block:
    """Table of the imbalance of what plain arms carry and of the counterweights, a row for each motion."""
    rows = []
    for name, motion in motions.items():
        hub = motion.get("hub", {})
        if "imbalance" in hub:
            rows.append({"name": name, **hub["imbalance"], "radius": hub["level"]["radius"]})
    cells: Columns = {
        "motion": "name",
        "imbalance, kg m": "size",
        "from the arm, deg": "angle",
        "counterweight, kg": "counterweight",
        "at, m": "radius",
        "above the control point, mm": "height",
        "left over, kg m²": "left",
    }
    return table(rows, cells, "Imbalance about the arm's axis, without the arm itself, and the counterweight across it")


def _felt(name: str, motion: Facts) -> dict[str, Facts]:
    """Largest loads, m/s², of the centre and of every corner of each rigid specimen, by the name of its row.

    The name is the motion, with the body where there are several. Without a specimen the motion has one empty row.
    """
    bodies = motion.get("bodies", {})
    felt: dict[str, Facts] = {}
    for body_name, body in bodies.items():
        if "specimen" in body:
            label = f"{name}, {body_name}" if len(bodies) > 1 else name
            corners = [corner["max_abs"] for corner in body["specimen"]["corners"]]
            felt[label] = {"centre": body["specimen"]["centre"], "corners": corners}
    return felt or {name: {}}


def _range(sizes: list[float]) -> str:
    in_g = [size / STANDARD_GRAVITY for size in sizes]
    return f"{number(min(in_g))} to {number(max(in_g))}" if in_g else "–"
