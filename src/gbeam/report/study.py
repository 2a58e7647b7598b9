"""Reports of responses over time, of their comparison with flight's, and of the study of models."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from gbeam.constants import RPM
from gbeam.printable import level_words
from gbeam.report.arm import balance, levels
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
    name_rows,
    quantities,
    table,
)
from gbeam.report.loads import (
    by_body,
    errors,
    errors_by_body,
    loads_table,
    parts_tables,
    points_table,
    several,
    stations_table,
    supports_table,
)
from gbeam.report.machine import (
    ends_line,
    error_words,
    judged_lines,
    limits,
    not_followed_stretches,
    peak_lines,
    tracking_words,
    verdict,
    verdict_sections,
)
from gbeam.report.words import angle_words, errors_in_words, float_of, largest_loads, number, percent, sentence, tidy
from gbeam.results.accounting import in_g, metres, seconds
from gbeam.results.accounting import percent as share_of
from gbeam.results.body_response import BodyResponse
from gbeam.results.comparison import Comparison
from gbeam.results.criteria import RULES
from gbeam.results.errors import ErrorEstimate
from gbeam.results.facts import facts_of
from gbeam.results.response import Response
from gbeam.results.result import Floats
from gbeam.results.system import joint_histories

ROUNDING = 1e-9  # of what it belongs to: a smaller number is none
EPISODES = 8  # of holding listed; a rough record has hundreds
SHORTFALLS = 2


def response_lines(response: Response) -> Iterator[str]:
    """Yield sentences on a response: accuracy, start, joints, controllers, loads, hub, energy, samples, machine."""
    if response.coordinates:
        yield _accuracy(response)
        if response.initial:
            yield response.initial
    free_hub = response.hub is not None and response.base is None  # freely: the hub's line has its coordinate
    joints = {} if free_hub else joint_histories(response)
    if joints:
        yield f"at the end {_at_end(response, joints)}"
    if response.loop is not None:
        shares = zip(response.loop.drives, response.loop.saturated, strict=True)
        yield "; ".join(f"{drive} limited at {100 * share:.3g} % of the samples" for drive, share in shares)
    if response.several and response.maxima is not None:
        force, moment = response.maxima.ground_force.size, response.maxima.ground_moment.size
        yield (
            f"on the ground: largest force {number(float(force.value))} N at {float(force.time):.4g} s, moment "
            f"{number(float(moment.value))} N m at {float(moment.time):.4g} s"
        )
    for name, body in response.bodies.items():
        prefix = f"{name}: " if len(response.bodies) > 1 else ""
        yield from (f"{prefix}{line}" for line in _body_lines(body))
    if response.hub is not None:
        angle, rate = response.hub.angle_end, response.hub.rate_max
        rpm = number(rate / RPM)
        yield f"{response.environment}: angle at the end {angle_words(angle)}, largest rate {rpm} rpm"
        if free_hub and np.any(response.body.damping_ratio):
            yield _damping(response.body)
    if response.invariants is not None:
        energy = response.invariants.energy
        first, last = map(number, tidy(energy[[0, -1]].sum(axis=1).tolist(), float(np.abs(energy).max())))
        yield f"energy {first} J at the start, {last} J at the end"
    if response.kept_every > 1:
        recorded_times = response.time[:: response.kept_every]
        yield (
            f"a result file keeps {len(recorded_times)} of {len(response.time)} samples of its histories, "
            f"{seconds(float(recorded_times[1] - recorded_times[0]))} apart; histories of [response] says otherwise"
        )
    yield from _machine_lines(response)


def _at_end(response: Response, joints: Mapping[str, tuple[Floats, str, Floats]]) -> str:
    """Coordinates of joints at the end, with their units. Rounding errors are shown as zero."""
    size = max(float(np.abs(history).max()) for history, *_ in joints.values())
    at_end = [float(history[-1]) for history, *_ in joints.values()]
    scale = float(np.abs(response.place).max(initial=0.0))
    ends = tidy(at_end, max(size, float(response.largest.max(initial=0.0))), scale)
    units = [unit for _, unit, _ in joints.values()]
    words = []
    for name, end, unit in zip(joints, ends, units, strict=True):
        words.append(f"{name} {angle_words(end)}" if unit == "rad" else f"{name} {number(end)} {unit}")
    return ", ".join(words)


def _body_lines(body: BodyResponse) -> Iterator[str]:
    """Sentences on the loads of a body's root, and on the stress of a mesh or the loads of a rigid specimen."""
    if body.specimen is not None:
        yield from body.specimen.lines
        return
    if body.loads is not None and body.peaks.loads is not None:
        yield largest_loads(body.peaks.loads)
    if body.solid is not None:
        yield from body.solid.lines


def _accuracy(response: Response) -> str:
    """Sentence on the models, the time steps and the estimated errors, with what the errors leave out."""
    errors, total = response.errors, response.errors.displacement.total
    if math.isnan(response.error_estimate) or response.outcome != "done":
        error = "no error estimate"
    else:
        largest = "a body's largest deflection" if len(response.bodies) > 1 else "the largest displacement"
        shares = percent(response.error_estimate)
        if not math.isnan(total):
            shares = errors_in_words(facts_of(errors.displacement))
        error = f"estimated error {shares} of {largest}"
        if response.several and response.bodies and math.isfinite(errors.place.total):
            error += f", {percent(errors.place.total)} of places"
        if math.isfinite(errors.loads.total):
            error += f", {_of_largest(errors.loads, 'root load')}"
        if math.isfinite(errors.stress.total) and any(body.solid is not None for body in response.bodies.values()):
            error += f", {_of_largest(errors.stress, 'stress')}"
        if errors.note:
            link = ", of the time step alone: " if math.isnan(errors.displacement.shapes) else "; "
            error += f"{link}{errors.note}"
    models = dict.fromkeys(body.model for body in response.bodies.values())
    return f"{', '.join([*models, response.integrator, response.steps_in_words])}; {error}"


def _of_largest(error: ErrorEstimate, quantity: str) -> str:
    """Error of the largest load or stress and, apart, that of an instant, as a share of it."""
    if math.isnan(error.peak):
        return f"{percent(error.total)} of the largest {quantity}"
    return f"{percent(error.peak)} of the largest {quantity} ({percent(error.total)} of it at any one instant)"


def _damping(body: BodyResponse) -> str:
    """Modes that the damping ratio is of, where that is not obvious: with a free hub the beam's modes are others."""
    ratios = np.atleast_1d(body.damping_ratio)
    size = " to ".join(f"{100 * ratio:.3g}" for ratio in sorted({float(ratios.min()), float(ratios.max())}))
    return f"damping {size} % of critical, of the modes of the beam on a hub at rest; those with the free hub have more"


def _machine_lines(response: Response) -> Iterator[str]:
    """Sentences on how a centrifuge begins, follows the load and ends, and on where it does not follow."""
    axes = response.axes
    if axes is None:
        return
    yield ends_line(response.time, axes)
    yield tracking_words(response)
    stretches = not_followed_stretches(axes)
    for start, end, reason in stretches[:EPISODES]:
        yield f"target is not the flight's load {start:.3f} to {end:.3f} s: {reason}"
    if len(stretches) > EPISODES:
        yield f"target is not the flight's load {len(stretches) - EPISODES} times more: see the result file"
    # Stretches in which the target is held are listed above; a load that is followed and yet out of reach is news.
    not_held = []
    for shortfall in axes.shortfalls:
        if not any(start <= shortfall.time <= end for start, end, _ in stretches):
            not_held.append(shortfall)
    for shortfall in not_held[:SHORTFALLS]:
        yield f"warning: {shortfall}"
    if len(not_held) > SHORTFALLS:
        yield f"warning: and {len(not_held) - SHORTFALLS} more: see `gbeam plan`"


_FELT = 0.01  # of flight's peak: a difference that bends the tip by less is no reason to move the specimen


def comparison_lines(comparison: Comparison) -> Iterator[str]:
    """Yield sentences on acceptance, load peaks, differences, stress cycles, shock, vibration and load along it."""
    main = comparison.main_axis
    if "." in comparison.point:
        yield f"the tip is {comparison.point}, the root the ground, the stress the largest of all beams and meshes"
    elif comparison.point:
        yield f"the tip is {comparison.point}"
    yield from judged_lines(comparison)
    yield from peak_lines(comparison.peaks)
    if comparison.margins is not None:
        yield "margin on yield {:.3g} in flight, {:.3g} on the centrifuge".format(*comparison.margins)
    if comparison.covered.any() and np.isfinite(comparison.relative).any():
        root = "" if comparison.root is None else f", root moment by up to {share_of(comparison.root.moment_agreement)}"
        yield (
            f"while the target is the flight's load: tip differs along {'xyz'[main]} by up to "
            f"{metres(comparison.max_difference[main])}, {share_of(comparison.relative[main])} of its peak{root}"
        )
    if comparison.fatigue is not None and math.isfinite(comparison.fatigue.damage_ratio):
        fatigue = comparison.fatigue
        in_flight, machine = (1e-6 * cycles.largest for cycles in (fatigue.flight, fatigue.machine))
        yield (
            f"stress cycles {fatigue.place} up to {in_flight:.4g} MPa in flight, {machine:.4g} MPa on the centrifuge: "
            + f"{number(fatigue.damage_ratio, 3)} times flight's damage (Wöhler exponent {fatigue.exponent:g})"
        )
    if comparison.shock is not None and comparison.shock.extremes:
        lowest, highest = sorted(comparison.shock.extremes, key=lambda extreme: extreme.ratio)
        write = RULES["srs"].write
        yield (
            f"shock response spectra of {comparison.shock.control} on the centrifuge {write(lowest.ratio)} {lowest} to "
            f"{write(highest.ratio)} {highest}, beside flight's"
        )
    if comparison.stations is not None:
        environments = comparison.stations.flight, comparison.stations.centrifuge
        flight, centrifuge = (1e3 * sizes.residual[comparison.stations.tip, main] for sizes in environments)
        yield (
            f"elastic vibration of the tip {flight:.3g} mm in flight, {centrifuge:.3g} mm on the centrifuge "
            f"(above {comparison.stations.cutoff:.3g} Hz, zero phase)"
        )
    if comparison.load_difference is not None:
        load_difference = comparison.load_difference
        bound = load_difference.tip_bound[main]
        matters = bound > _FELT * comparison.peak_flight[main]
        advice = "; `gbeam place` finds the best control point" if matters and not load_difference.placed else ""
        bent = f", which bends the tip by up to {1e3 * bound:.3g} mm quasi-statically" if math.isfinite(bound) else ""
        yield f"load along the beam differs by up to {in_g(load_difference.max_acceleration[main])}{bent}{advice}"


HINT = "Drag across a plot to zoom all of them, double-click to see all again, click to take the viewer to that time."


def study(facts: Facts) -> Blocks:
    """Report of a study: verdicts on centrifuges, largest displacements and loads, machines, errors, sentences."""
    motions = {name: motion for name, motion in facts["motions"].items() if "environment" in motion}
    head, bodies = by_body(motions)
    yield from verdicts(facts)
    yield Section("Motion", (Place("viewer"),))
    yield Section("Histories", (Place("figures", HINT),))
    yield Section("Arm", (levels(motions), balance(motions)))
    single = {name: body for name, body in bodies.items() if not several(body["of"])}
    response = (
        _tips(bodies, head),
        stations_table(single),
        loads_table(bodies, head),
        supports_table(bodies, head),
        *parts_tables(bodies, head),
    )
    yield Section("Response", response, verbose=compared_in(facts).issuperset(motions))
    for name, motion in motions.items():
        if several(motion):
            tables = points_table(motion), errors_by_body(motion["errors"]), *_of_joints(motion, units_in(facts))
            yield Section(f"motion {name}", tables, titled=True, verbose=name in compared_in(facts))
    for name, motion in motions.items():
        if "limits" in motion:
            yield Section(f"Machine: {name}", (limits(motion), Sentence(error_words(motion))), titled=True, detail=True)
    yield Section("Accuracy", tuple(errors(motions)), detail=True)
    yield from in_words_of(facts)


def units_in(facts: Facts) -> dict[str, str]:
    """Return the units of the quantities of one motion, by their paths in it."""
    return {path.removeprefix("motions.*."): unit for path, unit in facts.get("units", {}).items()}


_TOLD = ("points", "coordinates", "bodies", "errors", "limits", "name", "environment", "message")


def _of_joints(motion: Facts, units: dict[str, str]) -> Blocks:
    """Coordinates of several bodies at the end, and all else, for a page only."""
    yield table(name_rows(motion["coordinates"]), {"coordinate": "name", "at the end, m or rad": "end"}, detail=True)
    other_facts = {key: value for key, value in motion.items() if key not in _TOLD}
    yield Section("", tuple(quantities(other_facts, units)), detail=True)


def verdicts(facts: Facts) -> Blocks:
    """Runs that went wrong, and the verdict on how each centrifuge imitates its flight."""
    lines = []
    for name, run in facts["motions"].items():
        if run["outcome"] != "done":
            lines.append(Sentence(f"motion {name} {run['outcome']}: {run['message']}", "bad"))
    yield Section("Outcome", tuple(lines), detail=True)
    several = len(facts["comparisons"]) > 1
    if several:
        yield Section("Verdicts", (_of_records(facts),), detail=True)
    for compared in facts["comparisons"]:
        names = level_words(compared["flight"], compared.get("scale")), compared["centrifuge"]
        yield from verdict(compared, names, f"Verdict: {names[1]}" if several else "Verdict")


def _of_records(facts: Facts) -> Block:
    """Table of the verdicts on several imitations, with the file of each flight's record."""
    records = facts.get("provenance", {}).get("records", ())
    files = {record["motion"]: Path(record["file"]).name for record in records}

    def verdict_of(compared: Facts) -> Cell:
        criteria = compared["criteria"]
        if not all(criterion["passed"] for criterion in criteria):
            return Cell(compared["verdict"], "bad")
        return Cell(compared["verdict"], "good" if criteria else "")

    cells: Columns = {
        "flight": lambda comparison: level_words(comparison["flight"], comparison.get("scale")),
        "record": lambda comparison: files.get(comparison["flight"], ""),
        "machine": "centrifuge",
        "verdict": verdict_of,
    }
    return table(facts["comparisons"], cells, optional=("record",))


def compared_in(facts: Facts) -> set[str]:
    """Names of the motions that verdicts are on."""
    return {comparison[key] for comparison in facts["comparisons"] for key in ("flight", "centrifuge")}


def in_words_of(facts: Facts) -> Blocks:
    """Outcome and sentences of every run, and every verdict with the figures that it rests on."""
    compared = compared_in(facts)
    for name, run in facts["motions"].items():
        kind = run.get("environment", name)
        flight_name = level_words(name, run.get("scale")) if kind == "flight" else name
        title = f"{flight_name}{'' if kind == name else f' ({kind})'}: {run['outcome']}"
        folded, tone = (title, "good") if run["outcome"] == "done" else ("", "bad")
        message = (Sentence(sentence(run["message"]), "bad"),) if run.get("message") else ()
        limits_used = (limits(run),) if "limits" in run else ()
        lines = Items(tuple(run.get("lines", ())))
        blocks, verbose = (*message, *limits_used, lines), name in compared and run["outcome"] == "done"
        yield Section(title, blocks, titled=True, folded=folded, tone=tone, verbose=verbose)
    several = len(facts["comparisons"]) > 1
    for comparison in facts["comparisons"]:
        yield from verdict_sections(comparison, comparison["centrifuge"] if several else "")


def _tips(bodies: Facts, head: str) -> Block:
    """Table of the largest displacements of tips: a row for every `head` (motion, body or both) and moving axis."""
    rows = []
    for name, body in bodies.items():
        if body.get("farthest"):
            continue
        sizes = {axis: float_of(peak["max_abs"]) for axis, peak in body["tip"].items()}
        # A direction that nothing drives holds rounding errors, whose time would mean nothing.
        axes = [axis for axis, size in sizes.items() if size > ROUNDING * max(sizes.values())]
        shown_axes = [axis for axis in axes if axis != "size" or len(axes) > 2]
        rows += [{"name": name, "axis": axis, **body["tip"][axis]} for axis in shown_axes]
    cells: Columns = {
        head: "name",
        "tip along": "axis",
        "largest, mm": "max_abs",
        "at, s": "time_of_max:.3f",
        "residual amplitude, mm": "residual_amplitude",
    }
    caption = f"Displacement of the tip relative to the {'base' if head == 'motion' else 'root'} axes"
    return table(rows, cells, caption, optional=("residual amplitude, mm",))


def model_study(facts: Facts) -> Blocks:
    """Table with a row for each motion and model, and remarks on rows that have no answer or may be doubted."""

    def formatted(key: str, form: str, scale: float = 1.0) -> Column:
        return lambda row: "–" if row[key] is None else _signed(format(scale * row[key], form))

    cells: Columns = {
        "motion": lambda row: f"{row['motion']}, {facts['direction'][row['motion']]}",
        "model": "model",
        "outcome": lambda row: Cell(row["outcome"], "" if row["outcome"] == "done" else "bad"),
        "peak, mm": formatted("peak", ".5g", 1e3),
        "error": formatted("peak_error", "+.2%"),
        "residual, mm": formatted("residual", ".4g", 1e3),
        "error ": formatted("residual_error", "+.2%"),
        "phase, rad": formatted("phase", "+.4f"),
        "seconds": formatted("seconds", ".2f"),
    }
    yield table(facts["rows"], cells)
    remarks = []
    for row in facts["rows"]:
        row_name = f"{row['motion']}, {row['model']}"
        if row["message"]:
            remarks.append(f"{row_name} {row['outcome']}: {row['message']}")
        # To check with exact is what this study has just done.
        remarks += [f"{row_name}: {warning}" for warning in row["warnings"] if "check with model.kind" not in warning]
    yield Items(tuple(remarks))
    yield Section("Figures", (FIGURES,))


def _signed(words: str) -> str:
    """Write zero with a plus sign: -0.00 % as +0.00 %; any other number as it is."""
    return words if any(digit in words for digit in "123456789") else words.replace("-", "+")
