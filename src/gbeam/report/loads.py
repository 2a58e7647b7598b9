"""Tables of the bodies of responses and of states of rest: points, loads, stress and estimated errors."""

from __future__ import annotations

import math

import numpy as np

from gbeam.report.blocks import (
    Block,
    Blocks,
    Cell,
    Columns,
    Facts,
    Items,
    Sentence,
    Value,
    name_rows,
    number_rows,
    table,
)
from gbeam.report.words import float_of, number, percent, tidy
from gbeam.results.declared import declarations
from gbeam.results.errors import ErrorEstimate
from gbeam.results.parts import margin_words


def several(motion: Facts) -> bool:
    """Return True if points are on other bodies than one that deforms."""
    bodies = motion.get("bodies", {})
    return len(bodies) != 1 or {point.partition(".")[0] for point in motion["points"]} != {*bodies}


def by_body(motions: Facts) -> tuple[str, Facts]:
    """Return the bodies of all motions by the name of their row, and the head of the column of these names.

    A name is the motion where it has one body, the body where there is one motion, or both. Each body also has its name
    as `body` and its motion as `of`.
    """
    rows = []
    for name, motion in motions.items():
        for body, facts in motion.get("bodies", {}).items():
            rows.append((name, body, {**facts, "body": body, "of": motion}))
    if not any(map(several, motions.values())):
        return "motion", {name: facts for name, _, facts in rows}
    if len(motions) == 1:
        return "body", {body: facts for _, body, facts in rows}
    return "motion and body", {f"{name}, {body}": facts for name, body, facts in rows}


def resting_loads(loads: Facts, row_of: str = "motion") -> Block:
    """Table of root loads and stress at rest. `row_of` says what a row is: a motion, a body or both."""
    cells = {row_of: "name", "force, N": "force", "moment, N m": "moment"}
    cells |= {"stress, MPa": "stress", "largest in": "place"}
    cells |= {"margin on yield": "least", "torque about the axis, N m": "beam_torque"}
    rows = [_at_rest(body_loads) for body_loads in name_rows(loads)]
    stressed = any(row["stress"] for row in rows)
    caption = f"Of the base on the root, base axes{'; largest stress anywhere' if stressed else ''}"
    return table(rows, cells, caption, optional=tuple(cells)[3:])


def _at_rest(loads: Facts) -> Facts:
    """Row of loads at rest: root force and moment, with rounding errors as zero, and the extreme stress in words."""
    low = np.array(loads["stress_compression"], dtype=float)
    high = np.array(loads["stress_tension"], dtype=float)
    force = float(np.abs(list(loads["section_force"].values())).max())
    moment = float(np.abs(list(loads["section_moment"].values())).max())
    sizes = {"force": force, "moment": max(moment, force * loads["stations"][-1])}
    row = {**loads}
    for key, size in sizes.items():
        row[key] = f"({', '.join(map(number, tidy(loads[f'root_{key}'].values(), size)))})"
    if not max(high.max(), -low.min()) > 1e-20:  # rounding, or not known
        return row | {"stress": None}
    sign = "tension" if high.max() >= -low.min() else "compression"
    shares = [share for share in loads.get("margin", ()) if share is not None]
    return row | {
        "stress": f"{number(1e-6 * low.min())} to {number(1e-6 * high.max())}",
        "place": f"{sign}, {number(loads['stations'][int(np.maximum(high, -low).argmax())])} m",
        "least": margin(min(shares, default=None)),
    }


def loads_table(bodies: Facts, row_of: str) -> Block:
    """Table of the largest root loads and stress. `row_of` says what a row is: a motion, a body or both."""
    rows = [{"name": name, **body["loads"]} for name, body in bodies.items() if "loads" in body]
    cells: Columns = {
        row_of: "name",
        "root force, N": "root_force.size.max_abs",
        "at, s": "root_force.size.time_of_max",
        "root moment, N m": _root_moment,
        "at, s ": "root_moment.size.time_of_max",
        "stress, MPa": "stress.max",
        "at, s  ": "stress.time_of_max",
        "margin on yield": lambda body: margin(body.get("margin", {}).get("min")),
    }
    stressed = any(float_of(body.get("stress", {}).get("max")) > 0 for body in rows)  # of extreme fibres
    caption = f"Largest loads of the root{', and stress anywhere' if stressed else ''}"
    return table(rows, cells, caption, optional=tuple(cells)[5:], detail=True)


def supports_table(bodies: Facts, row_of: str) -> Block:
    """Table of the largest loads of supports on bodies. `row_of` says what a row of bodies is."""
    rows = [
        {"name": name, **support}
        for name, body in bodies.items()
        for support in body.get("loads", {}).get("supports", ())
    ]
    cells: Columns = {
        row_of: "name",
        "support at": _support_words,
        "force, N": "force.size.max_abs",
        "at, s": "force.size.time_of_max",
        "moment, N m": "moment.size.max_abs",
        "at, s ": "moment.size.time_of_max",
    }
    return table(rows, cells, "Largest loads of supports on the body", detail=True)


def _support_words(support: Facts) -> str:
    """Name of a support, or its position along a beam."""
    return support.get("name") or f"{number(1e3 * support['at'])} mm"


def resting_supports(loads: Facts, row_of: str = "motion") -> Block:
    """Table of the loads of supports on bodies at rest. `row_of` says what a row of loads is."""
    rows = list[Facts]()
    for of_body in name_rows(loads):
        places = of_body.get("supports", ())
        names = of_body.get("support_names", [None] * len(places))
        for k, place in enumerate(places):
            row: dict[str, Cell | str] = {"name": of_body["name"]}
            row["at"] = _support_words({"at": place, "name": names[k]})
            for key in ("force", "moment"):
                vectors = [[*vector.values()] for vector in _by_place(of_body[f"support_{key}"], len(places))]
                size = max((abs(component) for vector in vectors for component in vector), default=0.0)
                row[key] = f"({', '.join(map(number, tidy(vectors[k], size)))})"
            rows.append(row)
    cells: Columns = {row_of: "name", "support at": "at", "force, N": "force", "moment, N m": "moment"}
    return table(rows, cells, "Of the supports on the body, axes of the root")


def _by_place(vectors: Facts, count: int) -> list[Facts]:
    """Vectors of places by component, from their components by place."""
    return [{axis: vectors[axis][k] for axis in "xyz"} for k in range(count)]


def _root_moment(loads: Facts) -> float | None:
    """Largest moment of the root, or zero where it is rounding beside the force's on the length."""
    force, moment = (float_of(loads[key]["size"]["max_abs"]) for key in ("root_force", "root_moment"))
    size = max(moment, force * float_of(loads["sections"][-1]["at"]))
    return tidy((moment,), size)[0] if math.isfinite(moment) else None


def margin(value: float | None) -> Cell:
    """Cell of a margin on yield, marked where it is negative."""
    if value is None:
        return Cell("–")
    return Cell(margin_words(value).removeprefix("margin on yield "), "bad" if value < 0 else "")


def parts_tables(bodies: Facts, row_of: str) -> tuple[Block, ...]:
    """Tables of the largest stress of meshes, and of the loads of rigid specimens."""
    solids = {name: body["solid"] for name, body in bodies.items() if "solid" in body}
    rigid = {name: body["specimen"] for name, body in bodies.items() if "specimen" in body}
    return *_stress_table(solids, row_of), *_specimen_tables(rigid, row_of)


def _stress_table(solids: Facts, row_of: str) -> Blocks:
    """Tables of the largest von Mises stress of meshes, its place and least margin, and remarks on what is left out."""
    cells: Columns = {
        row_of: "name",
        "von Mises, MPa": "worst.von_mises",
        **_place("worst.place"),
        "node": "worst.node",
        "at, s": "worst.time:.4g",
        "material": lambda solid: solid["worst"]["material"] or "–",
        "elements differ by": lambda solid: percent(solid["worst"]["spread"] or math.nan),  # none of one element
        "least margin on yield": lambda solid: (
            margin(solid["nearest_yield"]["margin"]) if solid.get("nearest_yield") else "not known"
        ),
    }
    judged = {name: solid for name, solid in solids.items() if solid.get("known", True)}
    yield table(name_rows(judged), cells, "Largest stress, and where it is", optional=("node",))
    remarks = {name: solid["left_out"] for name, solid in solids.items() if solid.get("left_out")}
    if len(remarks) == len(solids) and len(set(remarks.values())) == 1:  # the same of all
        yield Items(tuple(set(remarks.values())))
    elif remarks:
        yield Items(tuple(f"{name}: {remark}" for name, remark in remarks.items()))


_READ: Columns = {
    "accelerometer reads, g": "sensor.size.max_abs",
    "von Mises, MPa": "solid.von_mises",
    "strain along x, µm/m": "solid.strain",
}


def _read(motion: Facts, body: str, point: str) -> Facts:
    """Readings of the accelerometer at a point of a body, and the largest stress and strain of a mesh there."""
    bodies, sensors = motion.get("bodies", {}), motion.get("sensors", {})
    only_body = sensors.get(point) if [*bodies] == [body] else None
    solid = bodies.get(body, {}).get("solid", {"points": {}})
    return {"sensor": sensors.get(f"{body}.{point}", only_body), "solid": solid["points"].get(point)}


def points_table(motion: Facts) -> Block:
    """Table of the largest motions of the points of several bodies, with what is read there."""
    residual = f"residual from {float_of(motion.get('residual_from')):g} s, m"
    moved = {"point": "name", "moves by, m": "displacement_max", "acceleration, m/s²": "acceleration_max"}
    rows = [{**point, **_read(motion, *point["name"].split(".", 1))} for point in name_rows(motion["points"])]
    return table(rows, {**moved, **_READ, residual: "residual_size"}, optional=(*_READ, residual))


def stations_table(bodies: Facts) -> Block:
    """Table of the largest values at named stations, by motion. It is empty if there is only a tip without a sensor."""
    rows = []
    for name, body in bodies.items():
        for station in body["stations"]:
            if station.get("name"):
                rows.append({"motion": name, **station, **_read(body["of"], body["body"], station["name"])})
    rigid = any("specimen" in body for body in bodies.values())
    rows = [row for row in rows if row["sensor"] or not rigid]
    if all(row["name"] == "tip" and not row["sensor"] for row in rows):
        return Items(())
    moves = {} if rigid else {"moves by, mm": "size.max_abs"}
    return table(
        rows, {"motion": "motion", "point": "name", **moves, **_READ}, "Largest at named points", optional=_READ
    )


def _place(path: str) -> Columns:
    return {f"{axis}, mm": f"{path}.{axis}:.4g" for axis in "xyz"}


def _specimen_tables(rigid: Facts, row_of: str) -> Blocks:
    """Tables of the loads of rigid specimens: at the corners, on the fixture and on the bolts."""

    def spread(specimen: Facts) -> Value:
        verdicts = {True: (", PASS", "good"), False: (", NOT ACCEPTED", "bad"), None: ("", "")}
        words, tone = verdicts[specimen.get("within_limit")]
        return Cell(f"{100 * float_of(specimen['spread']):.3g} %{words}", tone)

    corners: Columns = {
        row_of: "name",
        "largest, g": "largest_load.size",
        **_place("largest_load.place"),
        "at, s": "largest_load.time",
        "spread over the specimen": spread,
        "limit": "spread_limit:%",
        "on the fixture, N": "force.max_abs",
        "and, N m": "moment.max_abs",
    }
    yield table(name_rows(rigid), corners, "Load at the corners", optional=("limit",))
    bolts: list[Facts] = []
    for name, specimen in rigid.items():
        bolts += [{"name": name, **bolt} for bolt in number_rows(specimen["bolts"])]
    bolt_columns: Columns = {row_of: "name", "bolt": "number", **_place("place")}
    bolt_columns |= {f"{name}, N": name for name in ("tension", "compression", "shear")}
    yield table(
        bolts, bolt_columns, "Largest loads of the bolts, alike and without preload", optional=("compression, N",)
    )


def errors(motions: Facts) -> Blocks:
    """Table of the estimated errors in every motion by their causes, and sentences on errors that are not estimated."""
    rows = []
    for name, motion in motions.items():
        no_steps: Facts = {} if "steps" in motion else {"step": None}  # a state of rest takes none
        for quantity in _error_quantities(motion):
            estimate = motion["errors"][quantity]
            if estimate["total"] is not None:
                rows.append({"name": name, "of": quantity, **estimate, **no_steps})
    names = [name for name, _ in declarations(ErrorEstimate) if name != "slender"]  # for comparisons: files have it
    causes = {name.replace("_", " "): f"{name}:%" for name in names}
    cells = {"motion": "name", "of": "of"} | causes
    yield table(rows, cells, "Estimated errors, of the largest value", optional=causes)
    if not rows and any("displacement" in _error_quantities(motion) for motion in motions.values()):
        yield Sentence("no error estimate", "faint")
    for name, motion in motions.items():
        if motion["errors"].get("note"):
            yield Sentence(f"{name}: {motion['errors']['note']}", "faint")


def _error_quantities(motion: Facts) -> tuple[str, ...]:
    """Quantities whose errors are told: of loads alone where all is rigid and rests on its base."""
    bodies = motion.get("bodies", {}).values()
    if bodies and all("specimen" in body for body in bodies):
        return ("loads",)
    places_differ = several(motion) and motion["errors"]["place"] != motion["errors"]["displacement"]
    return ("displacement", "place", "loads", "stress") if places_differ else ("displacement", "loads", "stress")


def errors_by_body(errors: Facts) -> Block:
    """Table of the share of each body in the estimated errors, of lists with one entry for each body."""
    count = len(errors.get("beams", ()))
    by_body = {key: values for key, values in errors.items() if isinstance(values, list) and values}
    rows = []
    for k in range(count):
        rows.append({key: values[k] for key, values in by_body.items()})
    shares = {"deflection": "displacement_by_beam:%", "places: shapes and model": "by_beam:%"}
    shares |= {"root loads": "loads_by_beam:%", "their peaks": "load_peaks_by_beam:%"}
    shares |= {"stress": "stress_by_beam:%", "its peak": "stress_peaks_by_beam:%"}
    cells = {"body": "beams", **shares, "beam theory": "theory"}
    return table(rows, cells, "Estimated errors that each body brings, of the largest value", optional=tuple(cells)[1:])
