"""Reports of searches: sensitivities, fits, optima, shaped commands, and the place of a specimen on a centrifuge."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from gbeam.printable import LEAST_SHARE, raised
from gbeam.report.blocks import (
    FIGURES,
    Block,
    Blocks,
    Cell,
    Column,
    Columns,
    Facts,
    Items,
    Section,
    Sentence,
    Value,
    Verbatim,
    name_rows,
    pairs,
    six,
    table,
)
from gbeam.report.words import float_of, number, percent
from gbeam.results.accounting import change, in_g
from gbeam.results.placement import degrees
from gbeam.results.searches import COMMANDS, GOALS


def sensitivity(facts: Facts) -> Blocks:
    """Report of sensitivities: a table for each measure, with the parameters that change it most first."""
    for name, measure in facts["measures"].items():
        yield Section(f"{name} = {_with_unit(measure)}", (_effects(measure),), titled=True)
    methods = [row["method"] for row in next(iter(facts["measures"].values()))["parameters"]]
    exact = methods.count("exact")
    error = float_of(facts["run_error"])
    of_run = f"; the run's own estimated error: {percent(error)}" if math.isfinite(error) else ""
    notes = []
    if exact:
        notes.append(
            f"{exact} of {len(methods)} parameters by the exact derivative of the run, its steps held fixed{of_run}."
        )
    if exact < len(methods):
        notes.append("± is how far the differences of second and fourth order are apart.")
    yield Section("", (FIGURES, Items((*notes, *(f"not varied: {path}" for path in facts["not_varied"])))))


def _effects(measure: Facts) -> Block:
    """Table of the effect of each parameter on a measure."""

    def change(parameter: Facts) -> Value:
        # A figure without a unit is a ratio, and its change one too.
        df, size = 0.01 * float_of(parameter["derivative"]) * float_of(parameter["value"]), float_of(measure["value"])
        return percent(df / size) if measure["unit"] and size else f"{number(df)} {raised(measure['unit'])}".rstrip()

    columns: Columns = {
        "of": "path",
        "value": lambda parameter: f"{float_of(parameter['value']):.6g} {raised(parameter['unit'])}".rstrip(),
        "+1 % changes it by": change,
        "derivative, SI": lambda parameter: number(
            float_of(parameter["derivative"])
        ),  # of many units: each has its own size
        "±": lambda parameter: number(float_of(parameter["error"]), 1),
        "by": lambda parameter: f"{parameter['method']}{' kink' if parameter['kink'] else ''}",
    }
    return table(measure["parameters"], columns, optional=("±",))


def _with_unit(figure: Facts) -> str:
    return f"{number(float_of(figure['value']))} {raised(figure['unit'])}".rstrip()


def _interval(ends: str) -> Column:
    """Column of the interval at the key `ends`; "on its bound" where the value lies on the bound of the search."""

    def cell(row: Facts) -> Value:
        return Cell("on its bound", "bad") if row["at_bound"] else " to ".join(six(end).text for end in row[ends])

    return cell


_VALUE: Columns = {"value": "name", "was": "before:.6g", "is": "value:.6g"}
_UNIT: Columns = {"unit": lambda each: raised(each["unit"])}


def fit(facts: Facts) -> Blocks:
    """Report of a fit: a row for each value, correlations of their errors, and the residuals."""
    sigma: Columns = {"one sigma": lambda value: f"± {number(float_of(value['error']), 2)}"}
    paths = list(facts["parameters"])
    correlations = []
    for k, path in enumerate(paths):
        for j in range(k):
            correlation = facts["correlation"][k][j]
            if correlation is not None:
                correlations.append((f"{paths[j]} and {path}", f"{correlation:+.4f}"))
    values = table(name_rows(facts["parameters"]), _VALUE | sigma | {"95 %": _interval("interval")} | _UNIT)
    residuals = {"column": "name", "residual": "noise", "data": "data"}
    yield Section("Values", (Sentence(f"fitted to {facts['data']}", "faint"), values))
    yield pairs(correlations, "correlation of the errors of")
    yield table(name_rows(facts["columns"]), residuals | _UNIT, "standard deviation of the residual")
    yield Section("", (_searches(facts),))
    yield Section("Data and fit", (FIGURES,))


def optimum(facts: Facts) -> Blocks:
    """Report of an optimum: the figure before and after, the values, the requirements, and the steps of the search."""

    def verdict(requirement: Facts) -> Value:
        if not requirement["kept"]:
            return Cell("NOT KEPT", "bad")
        return Cell("decides" if requirement["active"] else "kept", "good")

    goal = facts["minimise"]
    requirements: Columns = {
        "requirement": "name",
        "at least": "low",
        "at most": "high",
        "was": "before",
        "is": "value",
    }
    yield Sentence(f"least {goal['name']}: {_with_unit(goal)}, was {number(float_of(goal['before']))}", "verdict")
    values = table(name_rows(facts["parameters"]), _VALUE | {"bounds": _interval("bounds")} | _UNIT)
    yield Section("Values", (values,))
    limits = table(facts["subject_to"], requirements | _UNIT | {"": verdict}, optional=("at least", "at most"))
    yield Section("Requirements", (limits,))
    error = float_of(facts["error_estimate"])
    of_run = f"; the last run's estimated error is {percent(error)}" if math.isfinite(error) else ""
    yield Section("", (_searches(facts, of_run),))
    yield Section("Way to the optimum", (FIGURES,))


def _searches(facts: Facts, remark: str = "") -> Block:
    tried, agreed = facts["starts"]["tried"], facts["starts"]["agreed"]
    several = (f"{agreed} of {tried} searches end at these values",) if tried > 1 else ()
    return Items((*several, f"{facts['evaluations']} evaluations of the scenario{remark}"))


def shaped_command(facts: Facts) -> Blocks:
    """Table of the vibration that each command leaves, the shaped one first."""
    ((goal, size),) = facts["goal"].items()
    span = f", for frequencies wrong by up to {percent(facts['robust'])}" if facts["robust"] else ""
    words = f"{facts['kind']} {GOALS[goal].format(size)} in {number(facts['duration'])} s"
    columns: Columns = {
        "command": "name",
        "vibration left, mm": "residual_amplitude:#.3g",
        f"largest command, {raised(COMMANDS[facts['kind']][1])}": "largest",
        "run": "outcome",
    }
    yield Sentence(f"{words}, designed on {facts['design']}, run on {facts['check']}{span}")
    yield Section("Commands", (table(name_rows(facts["commands"]), columns),))
    yield FIGURES


_PLACES = {"current": "now", "best": "placed", "middle": "at mid-span"}
_LISTED = 12  # options in a terminal


def placement(facts: Facts) -> Blocks:
    """Report of a placement: the best one, how to apply it, measures before and after, simulations, and options."""
    weights = facts["measure"]
    terms = list(weights)
    if len(weights) > 1:
        terms = [f"{weight:g} × {name}" for name, weight in weights.items()]
    measure = " + ".join(terms)
    if facts["point"] and {"tip", "vibration"} & weights.keys():
        measure += f" of {facts['point']}"
    remark = "" if facts["outcome"] == "done" else " (nearest to the limits, which none keeps)"
    yield Sentence(f"{facts['centrifuge']}, tracking {facts['flight']}: least {measure}{remark}", "verdict")
    yield Section("Placement", (pairs(_placement_rows(facts)),))
    if facts["set"]:
        flags = " ".join(f'--set "{change}"' for change in facts["set"])
        written_words = (
            f"it is written to {facts['written']}" if facts.get("written") else "or place again with --write"
        )
        yield Sentence("to apply it, add to the command line:")
        yield Verbatim(flags)
        yield Sentence(written_words, "faint")
    if facts["message"]:
        yield Sentence(facts["message"], "" if facts["outcome"] == "done" else "bad")
    places = _PLACES if facts["fraction_of_length"] else _PLACES | {"middle": "mid-way"}
    for title, key in (
        ("Difference of the load along the specimen alone", "difference"),
        ("With smoothing and tracking", "total_error"),
    ):
        yield _measures(facts[key], places, title)
    yield from _verification_table(facts, places)
    refused = Items(tuple(f"cannot: {reason}" for reason in facts["refused"]))
    yield Section("Options", (_options(facts["options"], measure), refused))


def _placement_rows(facts: Facts) -> Iterator[tuple[str, Value]]:
    """Rows of the best placement (control point, largest load, mounting, smoothing), beside the present one."""
    length_share, present, first_option = facts["fraction_of_length"], facts["before"], facts["options"][0]
    present_point = _point(present) if present else f"{number(1e3 * facts['current_control_point'])} mm"
    length = f", {length_share:.4f} of the length" if length_share else ""
    yield "control point", f"{_point(facts)} from the root{length} (now {present_point})"
    yield "largest load", _largest_load(first_option["largest_load"], present and present["largest_load"])
    yield "mounting", facts["mounting"] + _turn_words(facts)
    yield "smoothing", f"{number(1e3 * facts['smoothing'])} ms{_range(facts)}"


def _largest_load(load: Facts, present: Facts | None) -> str:
    """Largest load anywhere on the specimen as placed, in flight, and as it is mounted now."""
    if load["machine"] is None:
        return "not known"
    present_words = f"; now {_load(present)}" if present else ""
    return f"anywhere on the specimen {_load(load)}, {in_g(load['flight'])} in flight{present_words}"


def _load(load: Facts) -> str:
    place = f" at {load['place_machine']}" if load.get("place_machine") else ""
    return f"{in_g(float_of(load['machine']))}{place} ({change(float_of(load['ratio']))})"


def _range(facts: Facts) -> str:
    """Range of smoothing that was searched, and a remark if the best lies at its end,
    or empty if only one was tried.
    """
    low, high = facts["smoothing_range"]
    if low == high:
        return ""
    range_words = f", of {1e3 * low:.4g} to {1e3 * high:.4g} ms"
    if facts["smoothing"] > low * (1 + 1e-6):
        return range_words + (": the widest tried" if facts["smoothing"] > high * (1 - 1e-6) else "")
    share = float_of(facts["options"][0]["share"])
    unlimited = "; no limit of the machine forbids less" if share < 1 else ""
    return f"{range_words}: the least tried{unlimited}"


def _measures(values: Facts, places: dict[str, str], title: str) -> Block:
    """Table of every measure at every place, as a share of the flight's peak."""

    def share_column(place: str) -> Column:
        return lambda name: _peak_share(values.get(place, {}).get(name))

    cells: Columns = {"of flight's peak": lambda name: name}
    cells |= {words: share_column(place) for place, words in places.items()}
    return table(values.get("best", ()), cells, title)


def _verification_table(facts: Facts, places: dict[str, str]) -> Blocks:
    """Table of simulated differences at each control point, and the factor by which the best one vibrates less."""
    checks = facts["verifications"]
    cells = {
        "control point": "name",
        "tip, mm": "tip_difference",
        "vibration, mm": "vibration",
        f"root {'shear' if facts['fraction_of_length'] else 'force'}, N": "force_difference",
        "root moment, N m": "moment_difference",
    }
    rows = [{**checks[place], "name": words} for place, words in places.items() if place in checks]
    yield table(rows, cells, "By simulation, largest difference from flight")
    gain = float_of(facts["vibration_gain_over_middle"])
    if math.isfinite(gain):
        middle = "at mid-span" if facts["fraction_of_length"] else "in the middle of the specimen"
        yield Sentence(f"{gain:.3g} times less vibration than with the control point {middle}")


def _options(options: Sequence[Facts], measure: str) -> Block:
    """Table of the options, best first, each with its share of a limit or the limits that it exceeds."""

    def limits(option: Facts) -> Value:
        words = "; ".join(
            f"{use['axis']} {use['quantity']} {number(use['used'])} of {number(use['allowed'])} {use['unit']}"
            for use in option["exceeded"]
        )
        if words:
            return Cell(f"exceeds {words}", "bad")
        return f"{100 * option['share']:.0f} % of a limit" if option["share"] else ""

    cells: Columns = {
        "mounting": lambda option: option["mounting"] + _turn_words(option),
        "smoothing, ms": "smoothing",
        "control point, mm": lambda option: _point(option).removesuffix(" mm"),
        "error": lambda option: _peak_share(option["total_error"]),
        "largest load, g": "largest_load.machine",
        "at": lambda option: option["largest_load"].get("place_machine", "").removeprefix("the "),
        "of axes 1, 2, 3, rad/s²": lambda option: ", ".join(
            f"{float_of(peak):.3g}" for peak in option["accelerations"]
        ),
        "limits": limits,
    }
    caption = f"Options, best first by {measure}, with the errors of smoothing and tracking"
    return table(options, cells, caption, optional=("largest load, g", "at", "limits"), most=_LISTED)


def _peak_share(share: float | None) -> str:
    """Write a share of the flight's peak: 0 below 1e-8, which is rounding; above 1e8 that peak is rounding."""
    if share is None:
        return "–"
    if share > 1e8:
        return "none in flight"
    if share < LEAST_SHARE:
        return percent(share if share > 1e-8 else 0.0)
    return f"{100 * share:.3g} %"


def _point(facts: Facts) -> str:
    """A control point, along x or anywhere."""
    words = [number(1e3 * component) for component in facts["place"].values()]
    return f"({', '.join(words)}) mm" if any([*facts["place"].values()][1:]) else f"{words[0]} mm"


def _turn_words(facts: Facts) -> str:
    """A rotation vector, rad, or empty where there is none."""
    turn = [*facts["turn"].values()]
    return f", turned by {degrees(turn)}" if any(turn) else ""
