"""Table of what plain arms hold, and what rigid specimens feel of it, by motion: in six directions six rows."""

from __future__ import annotations

from gbeam.constants import STANDARD_GRAVITY
from gbeam.report.blocks import Block, Columns, Facts, table
from gbeam.report.words import along, number


def levels(motions: Facts) -> Block:
    """Table of the levels of plain arms, a row for each of them."""
    rows = [{"name": name, **each["hub"]["level"], "felt": _felt(each)} for name, each in motions.items()
            if "level" in each.get("hub", {})]  # fmt: skip
    cells: Columns = {
        "motion": "name",
        "along": lambda row: along([*row["load"].values()]),
        "up": lambda row: along([*row["up"].values()]),
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
    """Table of the imbalance of what plain arms carry, and the counterweight, a row for each of them."""
    rows = [{"name": name, **each["hub"]["imbalance"], "radius": each["hub"]["level"]["radius"]}
            for name, each in motions.items() if "imbalance" in each.get("hub", {})]  # fmt: skip
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


def _felt(motion: Facts) -> Facts:
    """Largest loads of the centre and of every corner of the only rigid specimen, m/s²; nothing of other bodies."""
    specimens = [each["specimen"] for each in motion.get("bodies", {}).values() if "specimen" in each]
    if len(specimens) != 1:
        return {}
    return {"centre": specimens[0]["centre"], "corners": [each["max_abs"] for each in specimens[0]["corners"]]}


def _range(sizes: list[float]) -> str:
    in_g = [size / STANDARD_GRAVITY for size in sizes]
    return f"{number(min(in_g))} to {number(max(in_g))}" if in_g else "–"
