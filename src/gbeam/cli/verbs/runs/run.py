"""``gbeam run``: the response in every environment of a scenario, and their comparisons."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from threading import Thread

from gbeam.cli.inputs import read
from gbeam.cli.options import IgnoreLimits, Json, Out, Overrides, Report, ScenarioFile
from gbeam.cli.outputs import folder_of, list_files, show, show_table
from gbeam.cli.process import figures_wanted
from gbeam.cli.publication import publish
from gbeam.cli.terminal.console import Watch
from gbeam.cli.terminal.failures import FAILED, complain


def run(
    scenario: ScenarioFile,
    /,
    *,
    overrides: Overrides = (),
    out: Out = None,
    json: Json = False,
    ignore_limits: IgnoreLimits = False,
    report: Report = False,
) -> int:
    """Compute the response in every environment of a scenario, and compare them.

    Writes result.nc, plots and with --report report.html into --out, by default out/ and the scenario's name; with
    --json only if --out or --report is given. Exit status: 0 done, 1 the computation failed, a machine's limit is
    exceeded or a [motion.NAME.accept] is not met, 2 the input is wrong.
    """
    folder = folder_of(out, scenario, default=report or not json)
    given = read("run", scenario, overrides, folder)
    if folder is not None:
        # A second of imports, beside the computation, which leaves a core idle.
        Thread(target=_import_leaves, daemon=True).start()

    from gbeam.analysis.study.study import study

    with Watch() as watch, given.placing():
        answer = study(given.case, watch)

    def make(hidden: Path) -> None:
        answer.save(hidden / "result.nc")
        if report:
            answer.report(hidden / "report.html")
        if figures_wanted():
            from gbeam.plots import write_plots

            write_plots(answer, hidden, "gbeam run")

    if not json:
        from gbeam.report.study.summary import table

        show_table(table(answer))
    files = []
    if folder is not None:
        with Watch() as watch:
            watch("writing results and plots", 0.0)
            files = publish(folder, make)
    if json:
        from gbeam.report.study.summary_json import to_json

        show("", given.signed(to_json(answer, files)), json)
    list_files(None if json else folder, files)
    for name, failure in answer.unfinished.items():
        complain(f"motion.{name} {failure.outcome}: {failure.message}")
    broken = {name: each.axes.exceeding for name, each in answer.responses.items() if each.axes}
    for name, which in broken.items():
        if which:
            complain(f"motion.{name} limits exceeded: {which}" + (" (allowed)" if ignore_limits else ""))
    refused = [each for each in answer.comparisons if each.accepted is False]
    for each in refused:
        complain(f"motion.{each.centrifuge} not accepted: {each.refusal}")
    return 0 if answer.outcome == "done" and not refused and (ignore_limits or not any(broken.values())) else FAILED


def _import_leaves() -> None:
    with suppress(Exception):  # raised again where it is needed
        if figures_wanted():
            import gbeam.plots
        import gbeam.io.netcdf  # noqa: F401
