"""Table of what plain arms hold, and what rigid specimens feel of it, by motion: in six directions six rows."""

from __future__ import annotations

from gbeam.constants import STANDARD_GRAVITY
from gbeam.report.blocks import Block, Columns, Facts, table
from gbeam.report.words import along, number


def levels(motions: Facts) -> Block:
    """Table of the levels of plain arms, a row for each of them and each of their rigid specimens."""
    rows = [{"name": item, **each["hub"]["level"], "felt": felt} for name, each in motions.items()
            if "level" in each.get("hub", {}) for item, felt in _felt(name, each).items()]  # fmt: skip
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


def _felt(name: str, motion: Facts) -> dict[str, Facts]:
    """Largest loads of the centre and of every corner of rigid specimens, m/s², by motion and body; nothing of other
    bodies.
    """
    bodies = motion.get("bodies", {})
    specimens = {key: each["specimen"] for key, each in bodies.items() if "specimen" in each}
    felt = {
        key: {"centre": each["centre"], "corners": [corner["max_abs"] for corner in each["corners"]]}
        for key, each in specimens.items()
    }
    return {f"{name}, {key}" if len(bodies) > 1 else name: each for key, each in felt.items()} or {name: {}}


def _range(sizes: list[float]) -> str:
    in_g = [size / STANDARD_GRAVITY for size in sizes]
    return f"{number(min(in_g))} to {number(max(in_g))}" if in_g else "–"
