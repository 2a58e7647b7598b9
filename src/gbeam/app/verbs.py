"""Verbs of the command line that the page offers, with those of their options that lead to no file outside."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gbeam.app.form import file_keys
from gbeam.cli import program
from gbeam.errors import InputError
from gbeam.printable import unprintable
from gbeam.scenario.values import find_distributions, parse_path, written_at

if TYPE_CHECKING:
    from cyclopts import Argument, ArgumentCollection

INPUT = "input"  # folder, in that of a run, of its scenario and the files that are read
PLAIN = 'give text such as "2 s" or "tip.z.max_abs"'
# Options that the page sets itself, or that lead away from this computer; * is a record of options.
_OF_THE_PAGE = {"SCENARIO", "*", "set", "out", "json", "report", "scheduler", "resume", "yes"}
_WRITTEN = "found.toml"  # a scenario that a verb makes
_REPEATED = re.compile("any number of times|given twice")


@dataclass(frozen=True)
class Option:
    """An option of a verb, as the command line has it.

    `many` is how often it may be given. `of` says that it names a ``motion``, a ``record``, or before "=" one of the
    scenario's ``values``. `ticked` is the argument of an option without a value where that is chosen.
    """

    name: str
    help: str
    example: str = ""
    choices: tuple[str, ...] = ()
    many: int = 1
    of: str = ""
    ticked: str = ""


@dataclass(frozen=True)
class Verb:
    """A verb: its line of help, and its options."""

    about: str
    options: tuple[Option, ...] = ()


@cache
def verbs() -> dict[str, Verb]:
    """Return the verbs that compute something of a scenario, as the command line has them."""
    verbs = {}
    for name, description in program.verbs().items():
        arguments = program.arguments(name)
        if arguments[0].name == "SCENARIO" and name != "check":  # the page does that
            verbs[name] = Verb(description, _options(arguments))
    return verbs


def _options(arguments: ArgumentCollection) -> tuple[Option, ...]:
    """Options of a verb by its arguments, without those that the page has itself."""
    by_name = {argument.names[0].removeprefix("--"): argument for argument in arguments}
    return tuple(_option(name, argument) for name, argument in by_name.items() if name not in _OF_THE_PAGE)


def _option(name: str, argument: Argument) -> Option:
    """Option of a verb. The words of its help give the example, and say if it may be repeated."""
    words, default = str(argument.parameter.help), argument.field_info.default
    if argument.hint is bool:
        if default:  # the page offers its opposite
            opposite = argument.names[1].removeprefix("--")
            return Option(opposite, f"do not {words[0].lower()}{words[1:]}", ticked=f"--{opposite}")
        return Option(name, words, ticked=f"--{name}")
    if "Path" in str(argument.hint) and not argument.required:
        return Option(name, words, ticked=f"--{name}={_WRITTEN}")
    if "PATH=" in words:
        suggestions = "values"
    elif argument.hint is Path:
        suggestions = "record"
    else:
        suggestions = "motion" if name == "motion" else ""
    quoted = re.search(r'"([^"]+)"', words)
    if quoted:
        example = quoted[1]
    else:
        example = "" if default is None else str(default)
    choices = argument.get_choices() or ()
    count = 2 if _REPEATED.search(words) else 1
    return Option(name, words, example=example, choices=choices, many=count, of=suggestions)


def verb_facts() -> dict[str, Any]:
    """Return the verbs and their options, for JSON."""
    return {name: asdict(verb) for name, verb in verbs().items()}


def arguments(verb: str, options: Sequence[str], data: Mapping[str, Any]) -> list[str]:
    """Return a verb's arguments from texts ``NAME=VALUE``, or NAME for an option that is ticked.

    An InputError says which is wrong. It refuses a sweep that varies the name of a file, which could lead out of the
    folder.
    """
    offered_verb = verbs().get(verb)
    if offered_verb is None:
        raise InputError("verb", f"is {verb[:100]!r}", f"choose of {', '.join(verbs())}")
    by_name = {option.name: option for option in offered_verb.options}
    line: list[str] = []
    counts: dict[str, int] = {}
    for text in options:
        name, _, value = text.partition("=")
        option = by_name.get(name)
        if option is None:
            raise InputError(name[:100] or "option", f"is no option of {verb} here", f"give {', '.join(by_name)}")
        counts[name] = counts.get(name, 0) + 1
        if counts[name] > option.many:
            raise InputError(name, f"is given {counts[name]} times", f"give it {option.many} times at most")
        if option.ticked:
            if value:
                raise InputError(name, f"is {value[:100]!r}", "give it without a value")
            line.append(option.ticked.replace(_WRITTEN, f"{INPUT}/{_WRITTEN}"))  # beside its records
            continue
        if not value.strip() or value.startswith("--") or unprintable(value):
            raise InputError(name, "holds nothing that can be read", PLAIN)
        if option.choices and value not in option.choices:
            raise InputError(name, f"is {value[:100]!r}", f"choose of {', '.join(option.choices)}")
        if option.of == "values":
            path, _, values = value.partition("=")
            if not values.strip():
                raise InputError(name, f"has no values of {path[:100]}", f"write it such as {option.example}")
            _refuse_file(path.strip(), data)
        line.append(f"--{name}={INPUT}/{value}" if option.of == "record" else f"--{name}={value}")
    if verb == "sweep":
        table = data.get("sweep")
        over = table.get("over") if isinstance(table, dict) else None
        ranges = over if isinstance(over, dict) else {}
        for path in ranges:
            _refuse_file(path, data)
        if not ranges and "over" not in counts and not any(find_distributions(data)):
            raise InputError("over", "is missing", "say what varies over which values")
    return line


def records(verb: str, options: Sequence[str]) -> list[str]:
    """Return the names of files among a verb's options."""
    file_options = {option.name for option in verbs()[verb].options if option.of == "record"}
    pairs = (text.partition("=") for text in options)
    return [value for name, _, value in pairs if name in file_options]


def _refuse_file(path: str, data: Mapping[str, Any]) -> None:
    """Raise InputError unless a path leads to a value of the scenario that names no file."""
    place = parse_path(path)
    key = next((step for step in reversed(place or ()) if isinstance(step, str)), "file")
    value = None if place is None or key in file_keys() else written_at(data, place)
    if value is None or isinstance(value, (dict, list)):
        raise InputError(path[:100] or "over", "cannot be varied", "choose a number or a word of the scenario")
