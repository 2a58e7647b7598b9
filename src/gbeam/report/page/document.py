"""Documents: the whole page of a result, and the short one that notebooks show."""

from __future__ import annotations

import base64
import hashlib
import json
import tomllib
from collections.abc import Callable, Iterator, Mapping
from importlib.resources import files
from typing import Any, NamedTuple

from gbeam.errors import InputError
from gbeam.figures import Describe
from gbeam.figures.description import raised
from gbeam.guards.limits import parse_json
from gbeam.printable import json_printable
from gbeam.report.facts import facts_text
from gbeam.report.page import answers, machine, searches
from gbeam.report.page.parts import (
    Numbers,
    Value,
    badge,
    drawn,
    escaped,
    folded,
    heading,
    listed,
    paragraph,
    section,
    table,
    verbatim,
)
from gbeam.report.page.records import figures_in, modes_in
from gbeam.report.page.scene import scene, shapes, shapes_of_system
from gbeam.report.words import as_json
from gbeam.results.result import Result

Body = Callable[[Mapping[str, Any], str, str], str]  # of the JSON, the viewer's place, and the figures


class Page(NamedTuple):
    """Page of a kind of result: its verb, the body, and keys by which files of 0.2, which name no kind, are known."""

    verb: str
    body: Body
    keys: tuple[str, ...]
    of_motions: tuple[str, ...] = ()


_APART = ("form", "units", "provenance", "warnings", "files", "title", "outcome", "state")


def _quantities(facts: Mapping[str, Any], viewer: str, plots: str) -> str:
    """The inside of the page of a kind that has none of its own: its quantities, and a table for each list of them."""
    known = {key: value for key, value in facts.items() if key not in _APART}
    return "".join([section("View", viewer), *_inside(known, facts.get("units", {}), ""), section("Figures", plots)])


def _system_study(facts: Mapping[str, Any], viewer: str, plots: str) -> str:
    """The verdicts on centrifuges, the quantities of all responses, and what the axes do."""
    motions = {name: each for name, each in facts["motions"].items() if "limits" in each}
    alone = {key: value for key, value in facts.items() if key != "comparisons"}
    alone["motions"] = {n: {k: v for k, v in each.items() if k != "limits"} for n, each in facts["motions"].items()}
    machines = "".join(machine.machine_section(name, each) for name, each in motions.items())
    return answers.verdicts(facts) + _quantities(alone, viewer, plots) + machines


def _inside(known: Mapping[str, Any], units: Mapping[str, str], place: str) -> Iterator[str]:
    """Single values in a table, lists and named rows of them in one each; what such rows hold stands below its name."""
    single = {key: value for key, value in known.items() if not isinstance(value, (dict, list))}
    told = {key: value for key, value in single.items() if value not in (None, "")}
    rows = [(key.replace("_", " "), _shown(value), raised(units.get(place + key, ""))) for key, value in told.items()]
    yield table(("", "", ""), rows, words=(0, 2))
    for key, value in known.items():
        below = f"{place}{key}[i]."
        if key == "beams":
            beams = {name: {"loads": each} for name, each in value.items()}
            over_time = all("sections" in each for each in value.values())
            yield (answers.loads_table if over_time else answers.resting_loads_table)(beams, "beam")
            continue
        if key == "solids":
            yield answers.stress_table(value, "body")
            continue
        if isinstance(value, dict):
            below = f"{place}{key}.*."
            if key == "motions":
                for name, each in value.items():
                    yield heading(f"motion {name}", 3)
                    yield from _inside({k: v for k, v in each.items() if k not in _APART}, units, below)
                continue
            value = [{"": name, **each} for name, each in value.items() if isinstance(each, dict)]
        if isinstance(value, list) and value and all(isinstance(each, dict) for each in value):
            yield heading(key.replace("_", " "), 3)
            yield _rows_table(value, units, below)


def _rows_table(rows: list[Mapping[str, Any]], units: Mapping[str, str], place: str) -> str:
    """A table of records: a column for each of their single values."""
    names = [key for key in rows[0] if not isinstance(rows[0][key], (dict, list))]
    words = [k for k, key in enumerate(names) if any(isinstance(row.get(key), str) for row in rows)]
    cells = [[_shown(row.get(key)) for key in names] for row in rows]
    heads = [", ".join(filter(None, (name.replace("_", " "), raised(units.get(place + name, ""))))) for name in names]
    return table(heads, cells, words=words)


def _shown(value: Any) -> Value:
    if isinstance(value, bool):
        return "yes" if value else "no"
    return str(value) if isinstance(value, int) else value


PAGES = {
    "Study": Page("run", answers.run_body, ("motions", "comparisons")),
    "Comparison": Page("run", machine.comparison_body, ("verdict", "flight", "centrifuge")),
    "ModelStudy": Page("models", _quantities, ("reference", "rows")),
    "StateSpace": Page("linearize", _quantities, ("states", "inputs", "outputs")),
    "Deflection": Page("static", answers.static_body, ("motions",), ("displacement", "tip", "stable")),
    "MachinePlan": Page("plan", machine.plan_body, ("motions",), ("limits", "tracks")),
    "Modes": Page("modes", answers.modes_body, ("modes", "instabilities")),
    "Campbell": Page("campbell", answers.campbell_body, ("tracks", "crossings")),
    "Critical": Page("critical-speed", answers.critical_body, ("quantity", "searched_to", "reason")),
    "CriticalMap": Page("critical-speed --masses", answers.critical_map_body, ("mass", "position", "critical_speed")),
    "Placement": Page("place", machine.placement_body, ("fraction_of_length", "options")),
    "SystemStudy": Page("run", _system_study, ("motions",), ("points", "coordinates", "steps")),
    "SystemRest": Page("static", _quantities, ("motions",), ("points", "coordinates", "ground_force")),
    "SystemModes": Page("modes", _quantities, ("modes", "body_names")),
    "Sweep": Page("sweep", searches.sweep_body, ("parameters", "measures")),
    "Fit": Page("fit", searches.fit_body, ("covariance", "columns")),
    "Optimum": Page("optimize", searches.optimum_body, ("minimise", "subject_to")),
    "Sensitivity": Page("sensitivity", searches.sensitivity_body, ("measures", "run_error")),
    "ShapedCommand": Page("shape", searches.shaping_body, ("commands", "coefficients")),
}


def _kind(facts: Mapping[str, Any]) -> str | None:
    if "form" in facts:
        return str(facts["form"]["kind"])
    motions = facts.get("motions", {}).values()
    if "outcome" not in facts:  # as of gbeam check, which computes nothing
        return None
    for name, page in PAGES.items():
        if facts.keys() >= set(page.keys) and all(motion.keys() >= set(page.of_motions) for motion in motions):
            return name
    return None


def _body(kind: str) -> Body:
    return PAGES[kind].body if kind in PAGES else _quantities


def html(
    facts: Mapping[str, Any],
    variables: Mapping[str, Any] | None = None,
    origin: Mapping[str, Any] | None = None,
    figures: Mapping[str, Describe] | None = None,
) -> str:
    """Return a whole page; `figures` are read from `facts` and `variables` where they are not given."""
    facts = json.loads(as_json(facts))  # what is not finite is null, as in a file
    kind = _kind(facts)
    if kind is None:
        fix = f"give the result of {', '.join(dict.fromkeys(f'gbeam {page.verb}' for page in PAGES.values()))}"
        raise InputError("result", "is of a kind that has no report", fix)
    origin = facts.get("provenance") or origin or {}
    numbers = Numbers()
    header: dict[str, Any] = {"plots": [], "maps": []}
    described = figures_in(kind, facts, variables or {}) if figures is None else figures
    plots = drawn((each() for each in described.values()), numbers, header)
    verb = PAGES[kind].verb if kind in PAGES else kind
    header |= viewer(kind, facts, variables or {}, numbers)
    body = _body(kind)(facts, '<div id="gbeam-viewer"></div>' if header.keys() & {"scene", "modes"} else "", plots)
    title = facts.get("title") or _title(origin) or f"gbeam {verb}"
    warnings = answers.warnings(facts) if "motions" in facts else facts.get("warnings", [])
    if warnings:
        body = heading("Warnings") + listed(warnings, "warning") + body
    return _page(
        title,
        badge(facts.get("state", facts["outcome"])),
        _subject(verb, origin),
        body + _origin(origin),
        header,
        numbers,
    )


def viewer(
    kind: str, facts: Mapping[str, Any], variables: Mapping[str, Any], numbers: Numbers
) -> dict[str, dict[str, Any]]:
    """Return the modes or the scene that the viewer shows of a result, by its JSON and variables; nothing of others."""
    if kind == "Modes" and facts["modes"]:
        return {"modes": shapes(modes_in(facts), variables, numbers)}
    if kind == "SystemModes" and facts["modes"] and "hangs_on" in variables:
        return {"modes": shapes_of_system(facts, variables, numbers)}
    motions = facts["motions"] if kind in ("Study", "SystemStudy") else {}
    if kind in ("Deflection", "SystemRest"):
        motions = {name: {"environment": "rest"} for name in facts["motions"]}
    if kind == "SystemResponse":  # of one motion, alone
        motions = {facts["name"] or facts["environment"]: facts}
        variables = {f"motions/{name}/{key}": each for name in motions for key, each in variables.items()}
    environments = {name: each["environment"] for name, each in motions.items() if "environment" in each}
    shown = scene(environments, variables, numbers)
    return {} if shown is None else {"scene": shown}


def _subject(verb: str, origin: Mapping[str, Any]) -> str:
    version = f", gbeam {origin['gbeam']}" if "gbeam" in origin else ""
    date = f", {_date(origin['date'])}" if origin.get("date") else ""
    return f"gbeam {verb}{version}{date}"


def _date(text: str) -> str:
    """A time of ISO 8601 as it is read: 2026-01-31 12:00 UTC."""
    return text[:16].replace("T", " ") + " UTC"


def _title(origin: Mapping[str, Any]) -> str:
    """The scenario's title; empty where there is none."""
    text = origin.get("scenario", "")
    try:
        scenario = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError):  # JSON, or damaged
        try:
            scenario = parse_json(text)
        except ValueError:
            return ""
    return str(scenario.get("title", "")) if isinstance(scenario, dict) else ""


def _origin(origin: Mapping[str, Any]) -> str:
    if not origin:
        return ""
    changes = paragraph("changed by --set: " + ", ".join(origin["overrides"])) if origin["overrides"] else ""
    rows = [
        ("date", _date(origin["date"]) if origin.get("date") else ""),
        ("command", origin["command"]),
        *((f"file of {each['motion']}", f"{each['file']}, SHA-256 {each['sha256']}") for each in origin["records"]),
        ("SHA-256 of what it says", origin["scenario_sha256"]),
        ("gbeam", origin["gbeam"]),
        ("Python", origin["python"]),
        ("platform", origin["platform"]),
        ("packages", ", ".join(f"{name} {version}" for name, version in origin["dependencies"].items())),
    ]
    facts = table(("", ""), [row for row in rows if row[1]], words=(0, 1))
    scenario = folded("Scenario file", verbatim(origin["scenario"])) if origin["scenario"] else ""
    return heading("Scenario and provenance") + changes + scenario + facts


def _page(title: str, state: str, subject: str, body: str, header: Mapping[str, Any], numbers: Numbers) -> str:
    assets = files("gbeam.report.page") / "assets"
    script, style = ((assets / name).read_text(encoding="utf-8") for name in ("gbeam.js", "gbeam.css"))
    data = json_printable(json.dumps(header, ensure_ascii=False, allow_nan=False)).replace("<", "\\u003c")
    policy = (
        f"default-src 'none'; script-src '{_hash(script)}'; style-src '{_hash(style)}'; img-src data: blob:; "
        "base-uri 'none'; form-action 'none'"
    )
    return f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{policy}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{escaped(title)}</title>
<style>{style}</style>
</head>
<body class="gbeam-report">
<header><h1>{escaped(title)}</h1>{state}<p class="origin">{escaped(subject)}</p></header>
<main>{body}</main>
<footer><p id="gbeam-theme"></p></footer>
<noscript><p>Plots and the viewer need JavaScript; words and tables do not.</p></noscript>
<script type="application/json" id="gbeam-header">{data}</script>
<script type="text/plain" id="gbeam-numbers">{numbers.encoded()}</script>
<script type="module">{script}</script>
</body>
</html>
"""


def _hash(text: str) -> str:
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode("ascii")


def html_of(result: Result) -> str:
    """Return the inside of a result's page, without its figures and the viewer."""
    known = json.loads(facts_text(result))
    kind = str(known["form"]["kind"])
    title, inside = known.get("title", ""), _body(kind)(known, "", "")
    warnings = answers.warnings(known) if "motions" in known else known["warnings"]
    said = badge(known.get("state", known["outcome"]))
    return f"<div>{heading(title, 3) if title else ''}<p>{said}</p>{listed(warnings, 'warning')}{inside}</div>"
