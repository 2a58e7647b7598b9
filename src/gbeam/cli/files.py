"""Verbs of files: ``gbeam check``, ``new``, ``presets``, ``schema``; and ``gbeam app``, which edits and runs them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from gbeam.cli.options import Json, Output, ScenarioFile, option, read, signed
from gbeam.cli.outputs import list_files, show, write_json
from gbeam.cli.process import Watch, figures_wanted
from gbeam.cli.publication import publish, refuse_unwritable
from gbeam.constants import PresetName
from gbeam.errors import InputError
from gbeam.printable import printable

if TYPE_CHECKING:
    from gbeam.results.description import Description


def check(scenario: ScenarioFile, /, *, output: Output = Output()) -> int:
    """Say what a scenario means, without computing a response.

    Loads, validates and builds everything, and prints the beam's mass, its natural frequencies at rest, the motions
    and the duration; where a value is a distribution it takes the centre. With --out also writes check.json, and
    of every record a plot of what was read over what is flown, with --report check.html. Exit status: 0 the scenario is
    valid, 2 it is not.
    """
    folder = output.folder(scenario)
    loaded = read("check", scenario, output.overrides)

    from gbeam.analysis.describe import describe
    from gbeam.report.description import description_text
    from gbeam.results.facts import facts_of

    with loaded.placing():
        description = describe(loaded.case)
    source = loaded.scenario.source
    assert source is not None  # it was read from a file
    distributions = {path: str(distribution) for path, distribution in source.distributions.items()}
    description = replace(description, distributions=distributions)
    facts, words = signed(facts_of(description), loaded.case.provenance), description_text(description)
    on_page = words if output.report else ""
    show(words, facts, output.json)
    if folder is not None:
        with Watch("drawing the records") as watch:
            files = publish(folder, lambda hidden: _write(hidden, description, facts, on_page, watch))
        if not output.json:
            list_files(folder, sorted(files))
    return 0


def _write(folder: Path, description: Description, facts: dict[str, Any], words: str, watch: Watch) -> None:
    """Write a scenario's description as JSON, figures of its records, and a page of its `words` if there are any."""
    from gbeam.figures.registry import figures_of

    write_json(folder / "check.json", facts)
    described = figures_of(description)
    if words:
        from gbeam.report.page.document import description_page
        from gbeam.report.words import json_value

        html = description_page(words, json_value(facts)["provenance"], described)
        (folder / "check.html").write_text(html, encoding="utf-8")
    if described and figures_wanted():
        from gbeam.plots.output import write_figures

        write_figures(described, folder, "gbeam check", watch)


def new(
    file: Annotated[Path, Parameter(help="File to write, such as wing.toml; never overwritten.")],
    /,
    *,
    kind: Annotated[
        Literal["flight", "hub", "arm", "system"],
        Parameter(help="Flight and centrifuge, a hub, a box on a plain arm, or a system of bodies."),
    ] = "flight",
    json: Json = False,
) -> int:
    """Write a commented scenario to start from.

    Exit status: 0 written, 2 there is such a file or it cannot be written.
    """
    from gbeam.scenario.template import template

    if file.suffix != ".toml":
        raise InputError(str(file), "does not end in .toml", f"name it {file.stem or 'wing'}.toml")
    try:
        with file.open("x", encoding="utf-8") as new_file, _removed_if_incomplete(file):
            new_file.write(template(kind))
            new_file.flush()
    except FileExistsError:
        raise InputError(str(file), "exists", "name a new file, or delete it first") from None
    except OSError as error:
        raise InputError(str(file), f"cannot be written ({error.strerror})", "name another place") from None
    show(f"{file} written; `gbeam run {file}` computes it", {"file": str(file), "kind": kind}, json)
    return 0


@contextmanager
def _removed_if_incomplete(file: Path) -> Iterator[None]:
    try:
        yield
    except OSError:  # the disk is full
        file.unlink()
        raise


def presets(
    name: Annotated[PresetName | None, Parameter(help="Of a preset, to print its text.")] = None,
    /,
    *,
    json: Json = False,
) -> int:
    """Tests of standards on a plain arm, with their figures and clauses: their names, or the text of one.

    A scenario takes one by its name at the key preset of a motion of kind arm, and gives what it asks for.
    """
    from gbeam.scenario.presets import PRESETS, preset_of, text_of

    if name is not None:
        show(text_of(name).rstrip("\n"), asdict(preset_of(name)), json)
        return 0
    by_name = {key: preset_of(key) for key in PRESETS}
    widest = max(map(len, by_name))
    lines = [f"{key:<{widest}}  {preset.standard}: {preset.title}" for key, preset in by_name.items()]
    show("\n".join(lines), {key: asdict(preset) for key, preset in by_name.items()}, json)
    return 0


def schema(
    *,
    json: Json = False,
    markdown: Annotated[bool, option("--markdown", "The keys as a page to read instead.")] = False,
    results: Annotated[bool, option("--results", "Of the JSON that verbs print, instead of scenario files.")] = False,
) -> int:
    """Print the JSON schema of scenario files, for editors; or every key, with unit, default and meaning.

    Parameters
    ----------
    json
        As every verb takes it: the schema is one JSON object anyway.
    """
    if results:
        from gbeam.report.facts import json_schema_of_results, reference_of_results

        print(reference_of_results() if markdown and not json else json_schema_of_results(), end="")
        return 0
    from gbeam.scenario.template import json_schema

    if markdown and not json:
        from gbeam.scenario.reference import reference

        print(reference(), end="")
        return 0
    print(json_schema())
    return 0


def app(
    *,
    folder: Annotated[Path | None, Parameter(help="Where records and runs are kept; gbeam-app by default.")] = None,
    port: Annotated[int, Parameter(help="To listen on, on this computer only; by default any that is free.")] = 0,
) -> int:
    """Edit, run and compare scenarios in a browser, on this computer only.

    Prints the address to open, which holds a secret: whoever has it may run scenarios here. Needs the extra app. Runs
    go on when the page is closed, and earlier ones are there again after a restart. Ends with Ctrl-C.
    """
    place = Path("gbeam-app") if folder is None else folder
    if not 0 <= port < 65536:
        raise InputError("--port", f"is {port}", "give 0 to 65535")
    refuse_unwritable(place)
    try:
        from gbeam.app.server import serve
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] not in ("fastapi", "starlette", "uvicorn"):
            raise
        raise InputError("app", f"needs {error.name}, which is not installed", "pip install 'gbeam[app]'") from None
    serve(place.resolve(), port, lambda address: print(printable(address), flush=True))
    return 0
