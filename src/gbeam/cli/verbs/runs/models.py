"""``gbeam models``: the same scenario by every model, compared with the exact one."""

from __future__ import annotations

from gbeam.cli.inputs import read
from gbeam.cli.options import Json, Out, Overrides, ScenarioFile
from gbeam.cli.outputs import show, show_table, write
from gbeam.cli.terminal.console import Watch
from gbeam.cli.terminal.failures import FAILED, complain


def models(scenario: ScenarioFile, /, *, overrides: Overrides = (), out: Out = None, json: Json = False) -> int:
    """The same scenario by every model, compared with the exact one.

    Peak, residual vibration, its phase and the cost. A model that diverges or cannot answer has a row that says why.
    The exact model in three dimensions takes minutes. With --out also writes models.json. Exit status: 0 done, 1 exact
    has no answer to compare with, 2 the input is wrong.
    """
    given = read("models", scenario, overrides, out)

    from gbeam.analysis.study.model_study import compare_models
    from gbeam.report.study import models as report

    with Watch() as watch, given.placing():
        study = compare_models(given.case, progress=watch)
    facts = given.signed(report.to_json(study))
    write(out, "models", facts)
    if json:
        show("", facts, json)
    else:
        show_table(report.table(study))
    for row in study.rows:
        if row.model == study.reference and row.outcome != "done":
            complain(f"motion.{row.motion}: nothing to compare with, {row.model} {row.outcome}: {row.message}")
    return 0 if study.compared else FAILED
