"""Output of verbs as text, JSON and files."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any, Literal

from gbeam.cli.options import Output, signed
from gbeam.cli.process import Watch, command, figures_wanted
from gbeam.cli.publication import publish
from gbeam.errors import InputError, naming
from gbeam.printable import printable

if TYPE_CHECKING:
    from gbeam.figures.registry import Describe
    from gbeam.results.provenance import Provenance
    from gbeam.results.searches import Fit, Optimum

LIST = "list"  # in place of a figure's name


def deliver(
    answer: Any,
    name: str,
    folder: Path | None,
    output: Output,
    *,
    verb: str = "",  # that signs the figures, if its name is another
    origin: Provenance | None = None,  # if the answer has none
    title: str = "",  # of the scenario
    suffix: Literal[".json", ".nc", ""] = ".json",  # of its file, if it has one
    page: str = "",  # name of the page, if it is another
    figures: Mapping[str, Describe] | None = None,  # in place of the answer's
    facts: Mapping[str, Any] | None = None,  # besides the answer's
    more: Callable[[Path], object] | None = None,  # writes further files
    also: Sequence[Path] = (),  # files that are there already
    listed: bool = True,  # say which files were written
    copy: Path | None = None,  # scenario with the values of the answer, which is there already
    **options: Any,  # of the text
) -> None:
    """Print an answer, or a tuple of several, as JSON or in words; write its files into the folder, if not None."""
    origin = origin or answer.provenance
    assert origin is not None  # it is of a scenario
    origin = replace(origin, command=command())
    answers = answer if isinstance(answer, tuple) else (answer,)

    def signed_facts(files: Sequence[Path] | None = None) -> dict[str, Any]:
        from gbeam.report.facts import facts as facts_of

        return signed(facts_of(*answers, title=title, files=files) | dict(facts or {}), origin)

    def make(watch: Watch, hidden: Path) -> None:
        """Write all files into a folder."""
        from gbeam.figures.registry import figures_of

        described = figures_of(answer, title) if figures is None else figures
        if suffix == ".nc":
            replace(answer, provenance=origin).save(hidden / f"{name}.nc")
        elif suffix:
            write_json(hidden / f"{name}.json", signed_facts())
        if output.report:
            from gbeam.report.page.result import report_of

            html = report_of(answer, signed_facts(), described)
            (hidden / f"{page or name}.html").write_text(html, encoding="utf-8")
        if described and figures_wanted():
            from gbeam.plots.output import write_figures

            write_figures(described, hidden, f"gbeam {verb or name}", watch)
        if more is not None:
            more(hidden)

    if not output.json:
        from gbeam.report.lines import lines_of
        from gbeam.report.words import json_value

        show_lines(lines_of(type(answers[0]), json_value(signed_facts()), verbose=output.verbose, **options))
        if copy is not None:
            print(printable(f"\n{copy} has these values"))
    files: list[Path] = []
    if folder is not None:
        with Watch("writing results") as watch:
            files = sorted([*publish(folder, partial(make, watch)), *also])
    if output.json:
        show("", signed_facts(files if listed else None), output.json)
    elif listed:
        list_files(folder, files)


def show(words: str, facts: Mapping[str, Any], json: bool) -> None:
    """Print a result as JSON, or in words."""
    from gbeam.report.words import as_json

    if json:
        print(as_json(facts))
    else:
        show_lines((line, "") for line in words.split("\n"))


_STYLES = {"good": "green", "bad": "bold red", "warning": "yellow", "faint": "dim", "verdict": "bold"}


def show_lines(lines: Iterable[tuple[str, str]]) -> None:
    """Print lines, each with its tone. On a terminal they are coloured, and wrapped with an indent."""
    from gbeam.report.words import terminal_width

    width = terminal_width()
    if not width:
        print("\n".join(printable(line) for line, _ in lines))
        return

    from rich.console import Console
    from rich.text import Text

    console = Console(highlight=False)
    for line, tone in lines:
        indent = " " * (len(line) - len(line.lstrip()) + 2)
        wrapped = wrap(printable(line), width, subsequent_indent=indent) or [""]
        console.print(Text("\n".join(wrapped), style=_STYLES.get(tone, "")))


def list_figures(verb: str, json: bool) -> int:
    """Print every figure of a question, with its unit and its words."""
    from gbeam.report.words import terminal_width
    from gbeam.studies.figures import choices

    figures = choices(verb)
    units = {path: "" if figure.unit == "unit" else figure.unit for path, figure in figures.items()}
    headings = {path: f"{path} [{unit}]" if unit else path for path, unit in units.items()}
    longest, width = max(map(len, headings.values())), terminal_width()
    lines = []
    for path, figure in figures.items():
        if 0 < width < longest + 40:
            lines += [headings[path], *wrap(figure.words, width - 2, initial_indent="  ", subsequent_indent="  ")]
        else:
            lines.append(f"{headings[path]:<{longest}}  {figure.words}")
    note = "* is a name, such as a motion's or an axis, [i] a place in a list, [0] the first. A path's end is enough."
    facts = {path: {"unit": units[path], "words": figure.words} for path, figure in figures.items()}
    show("\n".join([*lines, *wrap(note, width or len(note))]), facts, json)
    return 0


def list_files(folder: Path | None, files: Sequence[Path]) -> None:
    """Print the names of the files written; a plot's two formats as one."""
    if folder is not None and files:
        listed = [file for file in files if file.suffix != ".svg"]
        names = [f"{file.stem}.png/.svg" if file.suffix == ".png" else file.name for file in listed]
        count = "1 file" if len(files) == 1 else f"{len(files)} files"
        show_lines([("", ""), (f"{count} in {folder}: {', '.join(names)}", "")])


def write_json(file: Path, facts: Mapping[str, Any]) -> None:
    """Write one result as JSON."""
    from gbeam.report.words import as_json

    file.write_text(as_json(facts) + "\n", encoding="utf-8")


def refuse_changes(write: Path | None, overrides: Sequence[str]) -> None:
    """Raise InputError if --write stands beside --set: the scenario that is copied lacks the changes."""
    if write is not None and overrides:
        fix = "change the file itself first: it is what --write copies"
        raise InputError("--write", "is given beside --set", fix)


def write_found(answer: Fit | Optimum, scenario: Path, file: Path | None) -> None:
    """Write a copy of the scenario with the values that a search found, unless `file` is None."""
    if file is None:
        return
    from gbeam.studies.parameters import with_values

    with naming("--write"):
        text = with_values(answer.parameters, answer.values.tolist(), scenario, file.parent)
        place = file.resolve()
        publish(place.parent, lambda hidden: (hidden / place.name).write_bytes(text.encode()))
