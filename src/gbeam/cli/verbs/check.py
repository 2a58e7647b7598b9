"""``gbeam check``: what a scenario means, without computing a response."""

from __future__ import annotations

from dataclasses import replace

from gbeam.cli.inputs import read
from gbeam.cli.options import Json, Out, Overrides, ScenarioFile
from gbeam.cli.outputs import show, write


def check(scenario: ScenarioFile, /, *, overrides: Overrides = (), out: Out = None, json: Json = False) -> int:
    """Say what a scenario means, without computing a response.

    Loads, validates and builds everything, and prints the beam's mass, its natural frequencies at rest, the motions
    and the duration; where a value is a distribution it takes the centre. With --out also writes check.json. Exit
    status: 0 the scenario is valid, 2 it is not.
    """
    given = read("check", scenario, overrides, out)

    from gbeam.analysis.study.describe import describe
    from gbeam.report import description as report

    with given.placing():
        description = describe(given.case)
    source = given.scenario.source
    assert source is not None  # it was read from a file
    drawn = {path: str(each) for path, each in source.distributions.items()}
    description = replace(description, distributions=drawn)
    facts = given.signed(report.to_json(description))
    write(out, "check", facts)
    show(report.text(description), facts, json)
    return 0
