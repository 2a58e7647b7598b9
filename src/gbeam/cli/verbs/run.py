"""``gbeam run``: the response in every environment of a scenario, and their comparisons."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from threading import Thread

from gbeam.cli.console import Watch, stdout
from gbeam.cli.failures import FAILED, complain
from gbeam.cli.inputs import read
from gbeam.cli.options import IgnoreLimits, Json, Out, Overrides, ScenarioFile
from gbeam.cli.outputs import publish, refuse_unwritable


def run(
    scenario: ScenarioFile,
    /,
    *,
    overrides: Overrides = (),
    out: Out = None,
    json: Json = False,
    ignore_limits: IgnoreLimits = False,
) -> int:
    """Compute the response in every environment of a scenario, and compare them.

    Writes result.nc and plots into --out, by default out/ and the scenario's name; with --json only if --out is
    given. Exit status: 0 done, 1 the computation failed or a machine's limit is exceeded, 2 the input is wrong.
    """
    folder = out if out is not None or json else Path("out") / scenario.stem
    if folder is not None:
        refuse_unwritable(folder)
    given = read("run", scenario, overrides)

    from gbeam.analysis.study.study import study

    if folder is not None:
        # Two seconds of imports, beside the compilation, which leaves a core idle.
        Thread(target=lambda: [*map(import_module, ("gbeam.io.netcdf", "gbeam.plots"))], daemon=True).start()
    with Watch() as watch, given.placing():
        answer = study(given.case, watch)

    from gbeam.report import as_json, summary, summary_json

    files: list[Path] = []
    if folder is not None:
        from gbeam.io import netcdf
        from gbeam.plots import write_plots

        def make(hidden: Path) -> None:
            netcdf.write(answer, hidden / "result.nc", given.provenance())
            write_plots(answer, hidden)

        files = publish(folder, make)
    if json:
        print(as_json(summary_json(answer, files)))
    else:
        console = stdout()
        console.print(summary(answer))
        console.print(f"\n{len(files)} files in {folder}: {', '.join(_names(files))}", soft_wrap=True, markup=False)
    for name, failure in answer.unfinished.items():
        complain(f"motion.{name} {failure.outcome}: {failure.message}")
    broken = {name: it.axes.exceeding for name, it in answer.responses.items() if it.axes and it.axes.exceeding}
    for name, which in broken.items():
        complain(f"motion.{name} limits exceeded: {which}" + (" (allowed)" if ignore_limits else ""))
    return 0 if answer.outcome == "done" and (ignore_limits or not broken) else FAILED


def _names(files: list[Path]) -> list[str]:
    """Names of the files; a plot's two formats as one."""
    return [f"{it.stem}.png/.svg" if it.suffix == ".png" else it.name for it in files if it.suffix != ".svg"]
