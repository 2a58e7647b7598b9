"""Documents: the whole page of a result, and the short one that notebooks show."""

from __future__ import annotations

import base64
import hashlib
import json
import tomllib
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from importlib.resources import files
from typing import Any

from gbeam.errors import InputError
from gbeam.figures.registry import Describe
from gbeam.guards.limits import parse_json
from gbeam.printable import json_printable
from gbeam.report.blocks import FIGURES, Block, Blocks, Section, Sentence, Verbatim, pairs
from gbeam.report.facts import facts_text
from gbeam.report.lines import blocks_of, remarks_of
from gbeam.report.page.parts import Numbers, badge, draw_blocks, draw_figures, escaped, heading
from gbeam.report.page.records import figures_in
from gbeam.report.page.scene import scene, shapes
from gbeam.report.words import as_json
from gbeam.results.criteria import VALID
from gbeam.results.result import Result

VERBS = {  # of kinds that have a page of their own
    "Study": "run",
    "Comparison": "run",
    "SolidStress": "run",
    "SpecimenLoads": "run",
    "ModelStudy": "models",
    "StateSpace": "linearize",
    "Rest": "static",
    "MachinePlan": "plan",
    "Modes": "modes",
    "Campbell": "campbell",
    "Critical": "critical-speed",
    "CriticalMap": "critical-speed --masses",
    "EquilibriumPath": "path",
    "Placement": "place",
    "Sweep": "sweep",
    "Fit": "fit",
    "Optimum": "optimize",
    "Sensitivity": "sensitivity",
    "ShapedCommand": "shape",
}


def html(
    facts: Mapping[str, Any],
    variables: Mapping[str, Any] | None = None,
    origin: Mapping[str, Any] | None = None,
    figures: Mapping[str, Describe] | None = None,
) -> str:
    """Return a whole page. `figures` are read from `facts` and `variables` if they are not given."""
    facts = json.loads(as_json(facts))  # what is not finite is null, as in a file
    kind = facts.get("form", {}).get("kind", "")
    if not kind:
        fix = f"give the result of {', '.join(dict.fromkeys(f'gbeam {verb}' for verb in VERBS.values()))}"
        raise InputError("result", "is of a kind that has no report", fix)
    origin = facts.get("provenance") or origin or {}
    descriptions = figures_in(kind, facts, variables or {}) if figures is None else figures
    verb = VERBS.get(kind) or (origin.get("command") or kind).removeprefix("gbeam ").split()[0]
    warnings, notes = remarks_of(facts)
    blocks = [Section("Warnings", (warnings,)), Section("Notes", (notes,)), *blocks_of(kind, facts)]
    state, title = facts.get("state", facts["outcome"]), facts.get("title") or _title(origin) or f"gbeam {verb}"
    return assemble_page(
        title, state, verb, blocks, origin, descriptions, partial(viewer, kind, facts, variables or {})
    )


def assemble_page(
    title: str,
    state: str,
    verb: str,
    blocks: Iterable[Block],
    origin: Mapping[str, Any],
    figures: Mapping[str, Describe],
    view: Callable[[Numbers], Mapping[str, Any]] = lambda _: {},
) -> str:
    """Return a whole page of blocks and figures.

    `view` returns what the viewer shows, and may add to the page's numbers.
    """
    numbers = Numbers()
    header: dict[str, Any] = {"plots": [], "maps": []}
    plots = draw_figures((describe() for describe in figures.values()), numbers, header)
    header |= view(numbers)
    viewer_place = '<div id="gbeam-viewer"></div>' if header.keys() & {"scene", "modes"} else ""
    body = draw_blocks([*blocks, *_origin(origin)], viewer_place, plots)
    return _page(title, badge(state), _subject(verb, origin), body, header, numbers)


def description_page(words: str, origin: Mapping[str, Any], figures: Mapping[str, Describe]) -> str:
    """Return the page of what a scenario means, in the words of `gbeam check`, with the figures of its records."""
    title, _, meaning = words.partition("\n")
    blocks = Section("Meaning", (Verbatim(meaning),)), Section("Records", (FIGURES,))
    return assemble_page(title, VALID, "check", blocks, origin, figures)


def viewer(
    kind: str, facts: Mapping[str, Any], variables: Mapping[str, Any], numbers: Numbers
) -> dict[str, dict[str, Any]]:
    """Return what the viewer shows, as ``modes`` or ``scene``, from JSON and variables, or empty if nothing moves."""
    if kind == "Modes" and facts["modes"] and "hangs_on" in variables:
        return {"modes": shapes(facts, variables, numbers)}
    motions = facts["motions"] if kind == "Study" else {}
    if kind == "Rest":
        motions = {name: {"environment": "rest"} for name in facts["motions"]}
    environments = {name: motion["environment"] for name, motion in motions.items() if "environment" in motion}
    viewed = scene(environments, variables, numbers)
    return {} if viewed is None else {"scene": viewed}


def _subject(verb: str, origin: Mapping[str, Any]) -> str:
    version = f", gbeam {origin['gbeam']}" if "gbeam" in origin else ""
    date = f", {_date(origin['date'])}" if origin.get("date") else ""
    return f"gbeam {verb}{version}{date}"


def _date(text: str) -> str:
    """A time of ISO 8601 as it is read: 2026-01-31 12:00 UTC."""
    return text[:16].replace("T", " ") + " UTC"


def _title(origin: Mapping[str, Any]) -> str:
    """The scenario's title, or empty where there is none."""
    text = origin.get("scenario", "")
    try:
        scenario = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError):  # JSON, or damaged
        try:
            scenario = parse_json(text)
        except ValueError:
            return ""
    return str(scenario.get("title", "")) if isinstance(scenario, dict) else ""


def _origin(origin: Mapping[str, Any]) -> Blocks:
    """Section on the origin of a result: command, files, versions, changes and scenario; none if `origin` is empty."""
    if not origin:
        return
    rows = [
        ("date", _date(origin["date"]) if origin.get("date") else ""),
        ("command", origin["command"]),
        *(
            (f"file of {record['motion']}", f"{record['file']}, SHA-256 {record['sha256']}")
            for record in origin["records"]
        ),
        ("SHA-256 of what it says", origin["scenario_sha256"]),
        ("gbeam", origin["gbeam"]),
        ("Python", origin["python"]),
        ("platform", origin["platform"]),
        ("packages", ", ".join(f"{name} {version}" for name, version in origin["dependencies"].items())),
    ]
    changes = (Sentence("changed by --set: " + ", ".join(origin["overrides"])),) if origin["overrides"] else ()
    scenario = Section("", (Verbatim(origin["scenario"]),) if origin["scenario"] else (), folded="Scenario file")
    yield Section("Scenario and provenance", (*changes, scenario, pairs(row for row in rows if row[1])))


def _page(title: str, state: str, subject: str, body: str, header: Mapping[str, Any], numbers: Numbers) -> str:
    """HTML of a whole page. Its script draws `header` and `numbers`; its policy lets nothing else run."""
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
    """Return a result as HTML for a notebook: the blocks of its page, without figures and viewer."""
    facts = json.loads(facts_text(result))
    blocks = draw_blocks([*remarks_of(facts), *blocks_of(str(facts["form"]["kind"]), facts)], "", "")
    title, state = facts.get("title", ""), badge(facts.get("state", facts["outcome"]))
    return f"<div>{heading(title, 3) if title else ''}<p>{state}</p>{blocks}</div>"
