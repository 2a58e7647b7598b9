"""Reports of one instant: equilibrium and its loss, small vibrations, and the state-space model."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from itertools import zip_longest

import numpy as np

from gbeam.constants import RPM
from gbeam.printable import raised
from gbeam.report.blocks import (
    FIGURES,
    Block,
    Blocks,
    Cell,
    Column,
    Columns,
    Facts,
    Items,
    Place,
    Section,
    Sentence,
    Value,
    factor,
    name_rows,
    number_rows,
    pairs,
    table,
)
from gbeam.report.loads import by_body, errors, errors_by_body, parts_tables, resting_loads, resting_supports, several
from gbeam.report.words import errors_in_words, float_of, number, percent, tidy
from gbeam.results.equilibrium import CriticalMap
from gbeam.results.errors import Accelerated, direction_words
from gbeam.results.state_space import ACCURATE

SYSTEM = "system"  # in the place of a model's name, of several bodies
RESTING = 1e-9  # rad/s: a smaller rate of a base is a profile's rounding
ROUNDING = 1e-10  # a damping ratio smaller than this is none


def rest(facts: Facts) -> Blocks:
    """Report of states of rest: displacements of bodies and points in every motion, loads, stress, and the errors."""
    motions = facts["motions"]
    of_systems = {name: motion for name, motion in motions.items() if several(motion)}
    head, bodies = by_body(motions)
    messages = (f"motion {name}: {motion['message']}" for name, motion in motions.items() if motion["message"])
    yield Items(tuple(messages), "bad")
    for motion in motions.values():
        yield from acceleration_sentence(motion)
    yield Section("View", (Place("viewer"),))
    tips: Columns = {head: "name", "at, s": "of.time", "model": "model"}
    tips |= {f"{axis}, mm": f"tip.{axis}" for axis in "xyz"}
    bending = [body for body in name_rows(bodies) if "specimen" not in body]
    yield Section("Deflection", (table(bending, tips, "Displacement of the tip"), *_points(of_systems)))
    loads = {name: body["loads"] for name, body in bodies.items() if "loads" in body}
    of_bodies = resting_loads(loads, head), resting_supports(loads, head), *parts_tables(bodies, head)
    yield Section("Loads", (*of_bodies, *_on_ground(of_systems)))
    if bodies:
        by_bodies = (errors_by_body(motion["errors"]) for motion in of_systems.values())
        yield Section("Accuracy", (*errors(motions), *by_bodies))
    yield Section("Figures", (FIGURES,))


def _points(motions: Facts) -> Blocks:
    """Tables of the displacements of points and, on a page, of all coordinates and drives."""
    points: list[Facts] = []
    coordinates: list[Facts] = []
    for name, rest in motions.items():
        points += [{"motion": name, **point} for point in name_rows(rest["points"])]
        coordinates += [{"motion": name, **coordinate} for coordinate in name_rows(rest["coordinates"])]
    motion_column: Columns = {"motion": "motion"} if len(motions) > 1 else {}
    cells = motion_column | {"point": "name"} | {f"{axis}, mm": f"displacement.{axis}" for axis in "xyz"}
    scale = max((abs(component) for point in points for component in point["place"].values()), default=0.0)
    yield table(points, cells, "Displacement of points from the start, axes of the ground", scale=scale)
    cells = motion_column | {"coordinate": "name", "at rest, m or rad": "q", "drive, N or N m": "effort"}
    yield table(coordinates, cells, "Coordinates", detail=True)


def _on_ground(motions: Facts) -> Blocks:
    """Sentences on the force and the moment that act on the ground in every motion."""
    for name, motion in motions.items():
        force, moment = [*motion["ground_force"].values()], [*motion["ground_moment"].values()]
        largest = max(map(abs, force + moment))
        force_words = ", ".join(map(number, tidy(force, largest)))
        moment_words = ", ".join(map(number, tidy(moment, largest)))
        prefix = f"motion {name}: " if len(motions) > 1 else ""
        yield Sentence(f"{prefix}on the ground: force ({force_words}) N, moment ({moment_words}) N m")


def modes(facts: Facts) -> Blocks:
    """Report of modes: frequencies, damping and errors, the direction of motion and the bodies' shares,
    and the shapes.
    """
    bodies, several = facts.get("bodies", {}), len(facts["body_names"]) > 1

    def shares(mode: Facts) -> Value:
        pairs = zip(facts["body_names"], mode["share"], strict=True)
        # Bodies of equal shares in their own order, whatever the last digits say.
        ranked = sorted(pairs, key=lambda pair: -round(pair[1], 2))
        return ", ".join(f"{body} {100 * share:.0f} %" for body, share in ranked if share > 0.005) if several else None

    rates = [np.linalg.norm([*body["base"]["angular_velocity"].values()]) for body in bodies.values()]
    rate = float(max(rates, default=0.0))
    turning_words = [f"turning at {number(rate)} rad/s"] if rate > RESTING else []
    coupling = [] if facts["gyroscopic"] else ["Coriolis coupling left out"]
    yield subject_sentence(facts, f"at {number(facts['time'])} s", *turning_words, *coupling)
    yield from acceleration_sentence(facts)
    yield instability_items(facts, lambda mode: f" {direction_words(mode['direction'])}")
    yield modes_table(facts, {"along": "direction"} | ERROR | {"kinetic energy": shares})
    reached = float_of(facts["reached"])
    if any(mode["frequency"] > reached for mode in facts["modes"]):
        yield Sentence(f"above {reached:.4g} Hz, to which the modes of meshes and matrices reach, upper bounds")
    undamped = [f"{name}.damping_ratio" for name, body in bodies.items() if not body["damping_given"]]
    if undamped:
        yield Sentence(f"undamped: {', '.join(undamped)} {'is' if len(undamped) == 1 else 'are'} not given", "faint")
    if facts["rigid"]:
        yield Sentence(f"and {facts['rigid']} motion{'' if facts['rigid'] == 1 else 's'} of zero frequency")
    drawing = "largest displacement 15 % of the length at most; the rest is drawn to scale"
    yield Section("Shapes", (Place("viewer", drawing), FIGURES))


def subject_sentence(facts: Facts, *words: str) -> Sentence:
    """Sentence on the motion, if it has a name, the models, and other words."""
    motion = f"motion {facts['motion']}" if facts["motion"] else ""
    modelled = [facts, *facts.get("bodies", {}).values()]  # a rigid body has no model
    models = dict.fromkeys(part["model"] for part in modelled if "model" in part)
    model_words = [f"model {model}" for model in models if model != SYSTEM]
    return Sentence(", ".join(filter(None, (motion, *model_words, *words))))


ERROR: Columns = {"estimated error": "error_estimate:%"}


def modes_table(facts: Facts, columns: Mapping[str, Column]) -> Block:
    """Table of the frequency, damping and further `columns` of every mode, and a note on errors not estimated."""

    def damping(mode: Facts) -> Value:
        return f"{mode['damping_ratio'] if abs(mode['damping_ratio']) > ROUNDING else 0.0:.4g}"

    cells: Columns = {"mode": "number", "frequency, Hz": "frequency", GROUND: "ground_frequency"}
    cells |= {"damping ratio": damping, **columns}
    modes_of = table(number_rows(facts["modes"]), cells, optional=(GROUND, *ERROR, "kinetic energy"))
    return Section("Modes", (modes_of, *frame_sentence(facts), *error_notes(facts)))


def acceleration_sentence(facts: Facts) -> Blocks:
    """Sentence on the coordinates that a steady state accelerates: translations (m/s²), then rotations (rad/s²)."""
    accelerated = [Accelerated(**row) for row in facts.get("accelerated", ())]
    slides = ", ".join(str(coordinate) for coordinate in accelerated if not math.isnan(coordinate.acceleration))
    turns = ", ".join(str(coordinate) for coordinate in accelerated if math.isnan(coordinate.acceleration))
    parts = [f"in axes of the ground: {slides}"] if slides else []
    parts += [f"about axes of its root: {turns}"] if turns else []
    if parts:
        yield Sentence(f"accelerated evenly, {', '.join(parts)}; all else rests")


def instability_items(facts: Facts, describe: Callable[[Facts], str]) -> Block:
    """Items on what grows, with words of `which` mode that is, and that stability is not known."""
    grows = (
        f"{instability['kind']}{describe(instability)}: grows by {number(instability['growth_rate'])} per second"
        for instability in facts["instabilities"]
    )
    return Items(tuple(filter(None, (*grows, facts.get("message")))), "bad")


def error_notes(facts: Facts) -> list[Block]:
    """Sentence on what the errors of frequencies leave out, or on why there are no errors."""
    note = facts.get("error_note")
    rows = facts.get("modes", facts.get("tracks", facts.get("poles", [])))
    errors = [row.get("errors", {}) for row in rows]
    judged = any(row_errors.get("total") is not None for row_errors in errors)
    has_bend = any(row_errors.get("model") is not None for row_errors in errors)
    judged |= any(margin.get("modulus_error") is not None for margin in facts.get("margins", ()))
    words = f"errors are of modes left out{' and of the bend' * has_bend}" if judged else "no error estimate"
    return [Sentence(f"{words}: {note}", "faint")] if note else []


_SPEEDS = {"rad/s": 1.0, "rpm": 1 / RPM}


def campbell(facts: Facts, speeds: Mapping[str, float] = _SPEEDS) -> Blocks:
    """Report of a Campbell diagram: ends of each mode, crossings with multiples of the speed, and a critical speed.

    `speeds` are the units of speed, with their number in 1 rad/s.
    """

    def speed(factor: float) -> Column:
        return lambda row: factor * row["speed"]

    low, high = facts["speed"][0], facts["speed"][-1]
    span = subject_sentence(
        facts, *(f"{factor * low:.4g} to {factor * high:.4g} {unit}" for unit, factor in speeds.items())
    )
    yield Section("Campbell diagram", (span, FIGURES))
    if facts["critical_speed"] is not None:
        critical = ", ".join(f"{number(factor * facts['critical_speed'])} {unit}" for unit, factor in speeds.items())
        reason = f" ({facts['critical_speed_reason']})" if facts.get("critical_speed_reason") else ""
        error = _error_clause(facts.get("critical_speed_errors", {}))
        goes_on = high > facts["critical_speed"]
        stability = "; stable beyond" if goes_on and not facts["unstable"] else ""
        event = "critical" if goes_on else "the equilibrium is lost"
        yield Sentence(f"{event} at {critical}{reason}{error}{stability}", "bad")
    yield Items(tuple(_stretch(stretch, speeds) for stretch in facts["unstable"]), "bad")
    (unit, factor), *_ = speeds.items()
    ends: Columns = {}
    for speed_at_end, path, space in ((low, "frequency.0", " "), (high, "frequency.-1", "")):
        ends[f"at {factor * speed_at_end:.4g} {raised(unit)}, Hz{space}"] = path
    ends |= {GROUND: "ground_frequency.-1"}
    cells: Columns = {"mode": "number", "along": "direction", **ends, **ERROR}
    tracks = table(number_rows(facts["tracks"]), cells, optional=(GROUND,))
    yield Section("Modes", (tracks, *frame_sentence(facts), *error_notes(facts)))
    crossings: Columns = {
        "mode": lambda row: row["track"] + 1,
        "multiple": lambda row: f"{row['order']} ×",
        **{f"speed, {raised(unit)}": speed(factor) for unit, factor in speeds.items()},
        "frequency, Hz": "frequency",
        **ERROR,
    }
    remark = () if facts["crossings"] else (Sentence("no crossing in this range", "faint"),)
    yield Section("Crossings", (table(facts["crossings"], crossings), *remark))


def _stretch(stretch: Facts, speeds: Mapping[str, float]) -> str:
    """Words for a stretch of speed in which the equilibrium is not stable."""
    ends = ", ".join(
        f"{number(k * stretch['start'])} to {number(k * stretch['end'])} {unit}" for unit, k in speeds.items()
    )
    if stretch["growth"] is None:
        return f"{ends}: no equilibrium"
    return f"{ends}: not stable, growing with up to {number(stretch['growth'])} 1/s"


GROUND = "in the ground frame, Hz"


def frame_sentence(facts: Facts) -> list[Block]:
    """Sentence on the frame of frequencies, where it turns."""
    return [Sentence("frequencies in the turning frame", "faint")] if facts["frame"] == "turning" else []


def critical(facts: Facts) -> Blocks:
    """Report of a search: the value at which the equilibrium is lost, or that none was found."""
    value = next((facts[key] for key in facts if key.startswith("critical_")), None)
    unit = f", {raised(facts['unit'])}" if facts["unit"] else ""
    note = f"; {facts['error_note']}" if facts.get("error_note") else ""
    motion = f"motion {facts['motion']}: " if facts["motion"] else ""
    yield Sentence(f"{motion}{facts['reason']}{_error_clause(facts['errors'])}{note}", "verdict")
    rows: list[tuple[str, Value]] = [
        (f"{facts['quantity']}{unit}", value if value is not None else "none"),
        (f"searched to{unit}", facts["searched_to"]),
        ("how it is lost", facts["kind"] or "–"),
        ("along", facts["direction"] or "–"),
        ("model", facts["model"]),
    ]
    yield Section("", (pairs(rows), *frame_sentence(facts)), detail=True)


def equilibrium_path(facts: Facts) -> Blocks:
    """Report of an equilibrium path: the points at which stability is lost or regained, and the path itself."""
    motion = f"motion {facts['motion']}: " if facts["motion"] else ""
    note = f"; {facts['error_note']}" if facts.get("error_note") else ""
    for point in facts["critical"]:
        words = f"{point['kind']} at {number(point['factor'])} times the {facts['quantity']}"
        yield Sentence(f"{motion}{words}{_error_clause(point['errors'])}{note}", "verdict")
    if not facts["critical"]:
        factor = number(facts["path"][-1]["factor"])
        yield Sentence(
            f"{motion}stable up to {factor} times the {facts['quantity']}{_error_clause(facts['errors'])}{note}",
            "verdict",
        )
    yield Items(tuple(filter(None, [facts["message"]])), "bad")
    end = facts["path"][-1]
    moved = zip(facts["points"], *(end["displacement"][axis] for axis in "xyz"), strict=True)
    cells: Columns = {"point": "0", "x, mm": "1", "y, mm": "2", "z, mm": "3"}
    yield table(
        moved, cells, f"Displacement at {number(end['factor'])} times the {facts['quantity']}, axes of the ground"
    )
    yield Section("Figure", (FIGURES,))


def _error_clause(errors: Facts) -> str:
    """Clause on the estimated error of a critical value, or empty where there is none."""
    if errors.get("total") is not None:
        return f"; estimated error {errors_in_words(errors)}"
    shapes = errors.get("shapes")
    return "" if shapes is None else f"; estimated error from too few shapes {percent(shapes)}"


def critical_map(facts: Facts) -> Blocks:
    """Table of the hub rates at which the equilibrium is lost, by the size and the position of one more mass."""
    speed, errors_by_source = facts["critical_speed"], facts.get("errors", {})
    masses = {f"{mass:.4g} kg": f"{k}:.5f" for k, mass in enumerate(facts["mass"], 1)}
    yield subject_sentence(facts)
    rows = zip(facts["position"], *speed, strict=True)
    yield table(rows, {"at, m": "0:.4g"} | masses, "Critical hub rate, rad/s, with one more mass")
    if any(None in rates for rates in speed):
        yield Sentence(f"–: none up to {facts['searched_to']:.4g} rad/s")
    shapes = np.nanmax(np.array(errors_by_source.get("shapes", 0.0), dtype=float), initial=0.0)
    total = np.nanmax(np.array(errors_by_source.get("total", 0.0), dtype=float), initial=0.0)
    if shapes:
        in_all = f", {percent(total)} in all" if total else ""
        yield Sentence(f"largest estimated error {percent(shapes)} from too few shapes{in_all}")
    yield Section("Figure", (FIGURES,))


SLOWEST = 4  # poles of a loop that are named


def state_space(facts: Facts) -> Blocks:
    """Report of a state space: its signals, accuracy of the poles, a loop's margins, and what a
    reduction leaves out.
    """
    yield subject_sentence(facts, f"{len(facts['states'])} states")
    yield from acceleration_sentence(facts)
    signals = ("states", "inputs", "outputs")
    # Angles are of the scale of a radian, beams' coordinates, which have no unit, of that of lengths.
    sizes = {"rad": 1.0}
    for name in signals:
        for signal in facts[name]:
            sizes[signal["unit"]] = max(sizes.get(signal["unit"], 0.0), abs(signal["value"]))
    cells: Columns = {
        "name": "name",
        "unit": lambda signal: raised(signal["unit"]),
        "at equilibrium": lambda signal: tidy((signal["value"],), sizes[signal["unit"]], max(1.0, sizes.get("m", 0.0)))[
            0
        ],
    }
    for name in signals:
        yield Section(name, (table(facts[name], cells),), titled=True)
    gauges: Columns = {
        "gauge": lambda gauge: f"strain_{gauge['number']}",
        "at": lambda gauge: ", ".join(filter(None, (gauge["body"], _station(gauge["at"])))),
        "fibre y, mm": lambda gauge: None if isinstance(gauge["at"], str) else 1e3 * gauge["y"],
        "fibre z, mm": lambda gauge: None if isinstance(gauge["at"], str) else 1e3 * gauge["z"],
        "along": lambda gauge: "({:g}, {:g}, {:g})".format(*gauge["along"]),
    }
    names = {output["name"] for output in facts["outputs"]}
    used = [gauge for gauge in number_rows(facts.get("gauges", ())) if f"strain_{gauge['number']}" in names]
    yield table(used, gauges, "Gauges", optional=("fibre y, mm", "fibre z, mm"))
    yield from frame_sentence(facts)
    yield from _accuracy(facts)
    if facts["step"]:
        yield from _in_steps(facts)
    if facts["truncation"]:
        yield from _left_out(facts, facts["truncation"])
    poles = {"frequency, Hz": "frequency", "error": "errors.total:%"}
    yield Section("poles", (table(facts["poles"], poles),), titled=True, detail=True)
    yield Sentence("--json prints the matrices, --out writes them for MATLAB too.", "faint")


def _station(station: float | str) -> str:
    return station if isinstance(station, str) else f"{station:g} m"


def _accuracy(facts: Facts) -> Blocks:
    """Sentence on the frequency up to which poles are accurate, the others' errors, and the model they come from."""
    errors = [pole.get("errors", {}) for pole in facts["poles"]]
    totals = np.array([pole_errors.get("total") for pole_errors in errors], dtype=float)
    if not np.isfinite(totals).any():
        yield from error_notes(facts)
        return
    accurate = int(np.append(np.flatnonzero(~(totals <= ACCURATE)), len(totals))[0])  # poles before the first other
    words = []
    if accurate:
        largest, end = percent(float(totals[:accurate].max())), facts["accurate_to"]
        words.append(f"frequencies accurate to {largest} up to {number(end)} Hz ({accurate} of {len(totals)})")
    if accurate < len(totals):
        known_totals = totals[accurate:][np.isfinite(totals[accurate:])]
        error = f"up to {percent(float(known_totals.max()))} off" if len(known_totals) else "not judged"
        words.append(f"{'higher ones' if accurate else 'frequencies'} {error}")
    reference = "the model with more modes"
    if any(pole_errors.get("beam_theory") is not None for pole_errors in errors):
        reference = "the exact model with more shapes and the theory of thick beams"
    elif any(pole_errors.get("model") is not None for pole_errors in errors):
        reference += " and forces of higher order"
    note = f"; {facts['error_note']}" if facts.get("error_note") else ""
    yield Sentence(f"{'; '.join(words)}, by {reference}{note}")


MARGINS = {
    "gain": "gain",
    "gain_low": "gain not below",
    "phase": "phase, deg",
    "delay": "delay, ms",
    "modulus": "least distance from -1",
}


def _in_steps(facts: Facts) -> Blocks:
    """Tables of a loop in steps: its slowest decays, and its margins of gain, phase and delay, with their errors."""
    keys = "eigenvalue", "eigenvalue_imaginary", "decay_error", "oscillation_error"
    poles = [dict(zip(keys, values, strict=True)) for values in zip_longest(*(facts.get(key, ()) for key in keys))]
    upper = [pole for pole in poles if pole["eigenvalue_imaginary"] >= 0]  # the others are their conjugates
    slowest = [pole for pole in upper if pole["eigenvalue"] > -math.pi / facts["step"]][:SLOWEST]
    decays: Columns = {
        "decay, 1/s": "eigenvalue",
        "error": "decay_error:%",
        "frequency, Hz": lambda pole: pole["eigenvalue_imaginary"] / (2 * math.pi),
        "error ": "oscillation_error:%",
    }
    errors = "error", "error "
    yield table(slowest, decays, f"in steps of {1e3 * facts['step']:.4g} ms; slowest to decay", optional=errors)
    rows = []
    for loop in facts.get("margins", ()):
        for kind, words in MARGINS.items():
            error = loop[f"{kind}_error"]
            rows.append({
                "drive": loop["drive"] if kind == "gain" else "",
                "margin": words,
                "value": _margin(loop, kind),
                "error": None if error is None else percent(error),
                "frequency": loop.get(f"{kind}_frequency"),
            })  # fmt: skip
    margins: Columns = {"drive": "drive", "margin": "margin", "": "value", "error": "error"}
    margins |= {"at, Hz": lambda row: row["frequency"]}
    yield table(rows, margins, "Margins", optional=("error",))


def _margin(loop: Facts, kind: str) -> Value:
    """Cell of the margin of a drive of this kind."""
    if kind in loop["unknown"].split(", "):
        return Cell("not known", "bad")
    return "any" if loop[kind] is None else number(factor(MARGINS[kind]) * loop[kind])


def _left_out(facts: Facts, left_out: Facts) -> Blocks:
    """Sentences on the states that a reduction leaves out, their share of the gain, and a bound of the error."""
    shares, states = np.array(left_out["share"], dtype=float), left_out["states_left_out"]
    words = f"{left_out['method']} truncation leaves out {states} of {states + len(facts['states'])} states"
    if shares.size:
        largest_place = np.unravel_index(int(shares.argmax()), shares.shape)
        output, input_ = facts["outputs"][largest_place[0]]["name"], facts["inputs"][largest_place[1]]["name"]
        words += (
            f": up to {number(left_out['to'])} Hz {percent(float(shares[largest_place]))} of the largest gain at most"
        )
        words += f" ({output} by {input_})" if shares.size > 1 else ""
    yield Sentence(words)
    if left_out["method"] == "balanced":
        values = " ".join(f"{value:.3g}" for value in facts["hankel_singular_values"])
        bound = f"no gain is wrong by more than {left_out['bound']:.3g}, twice the sum of the values left out"
        yield Sentence(f"{bound}, of Hankel singular values {values}")


def map_csv(critical: CriticalMap) -> str:
    """Return a map as CSV: a row a position, a column a mass, then columns of errors; nan where nothing is known."""
    heads = ["position_m", *(f"critical_rad_per_s_with_{m:g}_kg" for m in critical.mass)]
    columns = [critical.position, *critical.speed]
    if critical.errors is not None:
        heads += [f"error_with_{m:g}_kg" for m in critical.mass]
        columns += [*critical.errors.total]
    lines = [",".join(heads)]
    for row in zip(*columns, strict=True):
        lines.append(",".join(f"{value:.12g}" for value in row))
    return "\n".join([*lines, ""])
