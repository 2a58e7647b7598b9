"""Output of verbs: text, JSON and figures."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any, TypeVar

from gbeam.cli.inputs import naming, signed
from gbeam.cli.process import command, figures_wanted
from gbeam.cli.publication import publish
from gbeam.errors import InputError
from gbeam.printable import printable

if TYPE_CHECKING:
    from rich.console import RenderableType

    from gbeam.figures import Describe
    from gbeam.results.cases import Sensitivity
    from gbeam.results.searches import Fit, Optimum, ShapedCommand

Found = TypeVar("Found", "Fit", "Optimum", "Sensitivity", "ShapedCommand")
LIST = "list"  # in place of a figure's name
_PLAIN_WIDTH = 110  # columns of a table where stdout is a file


def show(words: str, facts: Mapping[str, Any], json: bool) -> None:
    """Print a result as JSON, or in words."""
    from gbeam.report import as_json

    print(as_json(facts) if json else printable(words))


def show_table(table: RenderableType) -> None:
    """Print what rich draws: as wide as the terminal, and as wide in a file as a table needs."""
    from rich.console import Console
    from rich.segment import Segment, Segments

    console = Console(highlight=False, width=None if sys.stdout.isatty() else _PLAIN_WIDTH)
    drawn = [Segment(printable(text), style, control) for text, style, control in console.render(table)]
    console.print(Segments(drawn), end="")


def list_figures(verb: str, json: bool) -> int:
    """Print every figure of a question, with its unit and what it is."""
    from gbeam.report.words import terminal_width
    from gbeam.studies.answers import choices

    every = choices(verb)
    units = {path: "" if each.unit == "unit" else each.unit for path, each in every.items()}
    named = {path: f"{path} [{unit}]" if unit else path for path, unit in units.items()}
    wide, room = max(map(len, named.values())), terminal_width()
    lines = []
    for path, each in every.items():
        if 0 < room < wide + 40:
            lines += [named[path], *wrap(each.words, room - 2, initial_indent="  ", subsequent_indent="  ")]
        else:
            lines.append(f"{named[path]:<{wide}}  {each.words}")
    note = "* is a name, such as a motion's or an axis, [i] a place in a list, [0] the first. A path's end is enough."
    facts = {path: {"unit": units[path], "words": each.words} for path, each in every.items()}
    show("\n".join([*lines, *wrap(note, room or len(note))]), facts, json)
    return 0


def list_files(folder: Path | None, files: Sequence[Path]) -> None:
    """Print the names of the files written; a plot's two formats as one."""
    if folder is not None and files:
        kept = [file for file in files if file.suffix != ".svg"]
        names = [f"{file.stem}.png/.svg" if file.suffix == ".png" else file.name for file in kept]
        print(printable(f"\n{len(files)} files in {folder}: {', '.join(names)}"))


def folder_of(out: Path | None, scenario: Path, *, default: bool) -> Path | None:
    """The folder of --out; without it out/ and the scenario's name where there is a default, else none."""
    return out if out is not None or not default else Path("out") / scenario.stem


def write(
    folder: Path | None,
    name: str,
    facts: Mapping[str, Any],
    figures: Mapping[str, Describe] | None = None,
    *,
    report: bool = False,
) -> list[Path]:
    """Write NAME.json, the figures and NAME.html, made only then, into a folder, if there is one; return the files."""
    if folder is None:
        return []

    def make(hidden: Path) -> None:
        write_json(hidden / f"{name}.json", facts)
        if report:
            from gbeam.report.page.document import html

            (hidden / f"{name}.html").write_text(html(facts, figures=figures), encoding="utf-8")
        if figures and figures_wanted():
            from gbeam.plots import write_figures

            write_figures(figures, hidden, f"gbeam {name}")

    return publish(folder, make)


def write_json(file: Path, facts: Mapping[str, Any]) -> None:
    """Write one result as JSON."""
    from gbeam.report import as_json

    file.write_text(as_json(facts) + "\n", encoding="utf-8")


def refuse_changes(write: Path | None, overrides: Sequence[str]) -> None:
    """Raise InputError where values that were found are to be written beside changes of the scenario."""
    if write is not None and overrides:
        fix = "change the file itself first: it is what --write copies"
        raise InputError("--write", "is given beside --set", fix)


def show_found(
    answer: Found,
    words: Any,
    verb: str,
    stem: str,
    folder: Path | None,
    *,
    json: bool,
    report: bool,
    written: Path | None = None,
    more: Callable[[Path], None] | None = None,
) -> None:
    """Print a study's answer, and write it, its plots, its page and what a verb has `more` into a folder."""

    from gbeam.report.facts import facts

    def make(hidden: Path) -> None:
        from gbeam.figures import figures_of
        from gbeam.plots import write_figures

        answer.save(hidden / f"{stem}.nc")
        named = {re.sub(r"[^\w.-]+", "", name): each for name, each in figures_of(answer).items()}
        write_figures(named, hidden, f"gbeam {verb}")
        if report:
            answer.report(hidden / f"{stem}.html")
        if more is not None:
            more(hidden)

    files = [] if folder is None else publish(folder, make)
    assert answer.provenance is not None  # it is of a scenario
    show(words.text(answer), signed(facts(answer, files=files), answer.provenance), json)
    if not json:
        if written is not None:
            print(f"\n{written} has these values")
        list_files(folder, files)


def commanded(answer: Found) -> Found:
    """Return an answer that knows the command that it is of."""
    assert answer.provenance is not None  # it is of a scenario
    return replace(answer, provenance=replace(answer.provenance, command=command()))


def write_found(answer: Fit | Optimum, scenario: Path, file: Path | None) -> None:
    """Write a scenario with the values that a search found, if a file is named."""
    if file is None:
        return
    from gbeam.studies.parameters import with_values

    with naming("--write"):
        text, place = with_values(answer.parameters, answer.values.tolist(), scenario, file.parent), file.resolve()
        publish(place.parent, lambda hidden: (hidden / place.name).write_bytes(text.encode()))
