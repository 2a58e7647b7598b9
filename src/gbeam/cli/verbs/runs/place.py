"""``gbeam place``: where to put the specimen on the centrifuge."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from gbeam.cli.inputs import Input, naming, number, read
from gbeam.cli.options import (
    CentrifugeName,
    Check,
    IgnoreLimits,
    Json,
    Measure,
    Out,
    Overrides,
    Report,
    ScenarioFile,
    Widths,
    option,
)
from gbeam.cli.outputs import folder_of, show, write
from gbeam.cli.publication import publish
from gbeam.cli.terminal.failures import FAILED, complain
from gbeam.errors import InputError


def place(
    scenario: ScenarioFile,
    /,
    *,
    measure: Measure = "tip",
    motion: CentrifugeName = None,
    smoothing: Widths = (),
    check: Check = True,
    overrides: Overrides = (),
    out: Out = None,
    json: Json = False,
    ignore_limits: IgnoreLimits = False,
    report: Report = False,
    write_back: Annotated[
        bool,
        option("--write", "Write the answer into the scenario file."),
    ] = False,
) -> int:
    """Find the control point, mounting and smoothing that change the specimen's response least.

    Prints the --set options that apply the answer; --write writes it, and no change made by --set, into the scenario
    file, whose comments stay. Options that exceed the machine's limits are listed but not chosen, unless
    --ignore-limits is given. With --out also writes place.json, with --report place.html. Exit status: 0 done, 1 every
    option exceeds the limits, 2 the input is wrong.
    """
    weights = parse(measure)
    widths = [number("--smoothing", text, "time") for text in smoothing]
    folder = folder_of(out, scenario, default=report)
    given = read("place", scenario, overrides, folder)
    name, current = given.motion(motion, kind="centrifuge")

    from gbeam.analysis.imitation import place as analysis
    from gbeam.analysis.imitation.choice import choice_of
    from gbeam.motion import Centrifuge
    from gbeam.report.machine import placement as words

    if not isinstance(current, Centrifuge):
        fix = "add one that tracks the flight; `gbeam new` shows how"
        raise InputError(f"motion.{name}", "is no centrifuge to put a specimen on", fix)
    analysis.check_weights(weights, "--measure")
    with naming("--smoothing"):
        choice = choice_of(current, widths, limited=not ignore_limits)
    with given.placing():
        placement = analysis.place(
            given.case.assemble(),
            current.flight,
            choice,
            given.case.response,
            weights,
            current=current,
            names=(given.case.tracks[name], name),
            check=check,
        )
    written = _apply(given, scenario, name, placement.changes) if write_back and placement.changes else None
    facts = given.signed(words.to_json(placement, written))
    write(folder, "place", facts, report=report)
    show(words.text(placement, written), facts, json)
    if placement.outcome != "done":
        complain(f"{placement.outcome}: motion.{name}: {placement.message}")
        return FAILED
    return 0


def _apply(given: Input, file: Path, name: str, changes: dict[str, str]) -> str:
    """Write the changes of one centrifuge into the scenario file; return its name."""
    from gbeam.scenario.text.edit import edited

    source = given.scenario.source
    assert source is not None  # it was read from a file
    text, place = edited(source, ("motion", name), changes), file.resolve()
    with naming("--write"):
        publish(place.parent, lambda hidden: (hidden / place.name).write_bytes(text.encode()))
    return str(file)


def parse(measure: str) -> dict[str, float]:
    """Read a measure or a weighted sum of measures."""
    weights: dict[str, float] = {}
    for term in measure.split(","):
        name, _, weight = term.partition("=")
        try:
            weights[name.strip()] = float(weight) if weight else 1.0
        except ValueError:
            raise InputError(
                "--measure", f"has the weight {weight.strip()!r}", 'write "tip=1, root-moment=0.5"'
            ) from None
    return weights
