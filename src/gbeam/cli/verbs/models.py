"""``gbeam models``: the same scenario by every model, compared with the exact one."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from gbeam.cli.common import write
from gbeam.cli.console import Watch, stdout
from gbeam.cli.failures import FAILED, complain
from gbeam.cli.inputs import read
from gbeam.cli.options import Json, Out, Overrides, ScenarioFile
from gbeam.cli.outputs import refuse_unwritable

if TYPE_CHECKING:
    from rich.table import Table

    from gbeam.results.modal import ModelStudy

HEADINGS = ("motion", "model", "outcome", "peak, mm", "error", "residual, mm", "error", "phase, rad", "seconds")


def models(scenario: ScenarioFile, /, *, overrides: Overrides = (), out: Out = None, json: Json = False) -> int:
    """The same scenario by every model, compared with the exact one.

    Peak, residual vibration, its phase and the cost. A model that diverges or cannot answer has a row that says why.
    The exact model in three dimensions takes minutes. With --out also writes models.json. Exit status: 0 done, 1 exact
    has no answer to compare with, 2 the input is wrong.
    """
    if out is not None:
        refuse_unwritable(out)
    given = read("models", scenario, overrides)

    from gbeam.analysis.study.model_study import compare_models
    from gbeam.report import as_json

    with Watch() as watch, given.placing():
        study = compare_models(given.case, progress=watch)
    facts = to_json(study)
    write(out, facts, "models", {})
    if json:
        print(as_json(facts))
    else:
        console = stdout()
        console.print(_table(study))
        for remark in _remarks(study):
            console.print(remark, markup=False)
    for it in study.rows:
        if it.model == study.reference and it.outcome != "done":
            complain(f"motion.{it.motion}: nothing to compare with, {it.model} {it.outcome}: {it.message}")
    return 0 if study.compared else FAILED


def to_json(study: ModelStudy) -> dict[str, Any]:
    """Study as JSON; m, s, rad."""
    return {
        "title": study.title,
        "outcome": "done" if study.compared else "not compared",
        "reference": study.reference,
        "direction": study.direction,
        "rows": [asdict(row) for row in study.rows],
    }


def _remarks(study: ModelStudy) -> list[str]:
    """Why a model has no answer, and why one may not be what it seems."""
    said = []
    for it in study.rows:
        here = f"{it.motion}, {it.model}"
        if it.message:
            said.append(f"{here} {it.outcome}: {it.message}")
        # To check with exact is what this verb has just done.
        said += [f"{here}: {why}" for why in it.warnings if "check with model.kind" not in why]
    return said


def _table(study: ModelStudy) -> Table:
    from rich.table import Table

    def say(value: float, form: str, scale: float = 1.0) -> str:
        told = format(scale * value, form) if math.isfinite(value) else "–"
        return told if any(digit in told for digit in "123456789") else told.replace("-", "+")

    table = Table(box=None, padding=(0, 2, 0, 0), header_style="dim", title=study.title or None, title_justify="left")
    for i, heading in enumerate(HEADINGS):
        table.add_column(heading, justify="left" if i < 3 else "right")
    for it in study.rows:
        table.add_row(
            f"{it.motion}, {study.direction[it.motion]}",
            it.model,
            it.outcome,
            say(it.peak, ".5g", 1e3),
            say(it.peak_error, "+.2%"),
            say(it.residual, ".4g", 1e3),
            say(it.residual_error, "+.2%"),
            say(it.phase, "+.4f"),
            say(it.seconds, ".2f"),
        )
    return table
