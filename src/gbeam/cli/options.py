"""Arguments that verbs share, and the objects of the core that they name."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, fields, make_dataclass, replace
from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeVar

from cyclopts import Parameter

from gbeam.cli.process import Watch, command
from gbeam.cli.publication import refuse_unwritable
from gbeam.errors import InputError
from gbeam.questions import QUESTIONS, Needs, Question, differentiable, motion_of, prepared, refuse_rigid

if TYPE_CHECKING:
    from gbeam.analysis.case import Case
    from gbeam.constants import Verb as Verb
    from gbeam.results.provenance import Provenance
    from gbeam.scenario.load import AnyScenario

    _Smooth = Verb
else:
    Verb = Literal[tuple(QUESTIONS)]  # with those that are declared elsewhere
    _Smooth = Literal[differentiable()]


_Function = TypeVar("_Function", bound=Callable[..., int])


def option(name: str, words: str) -> Parameter:
    """Declare an option without an opposite, whose default the help does not show."""
    return Parameter(name=name, negative="", show_default=False, help=words)


# Arguments of all verbs, or of many.
ScenarioFile = Annotated[Path, Parameter(help="Scenario file, TOML or JSON; - reads standard input.")]
Overrides = Annotated[
    tuple[str, ...],
    option("--set", 'Change the scenario, KEY=VALUE, such as "beam.length=250 mm"; any number of times.'),
]
Out = Annotated[
    Path | None,
    Parameter(name="--out", help="Folder for the files. Without it run writes to out/NAME, with --json nowhere."),
]
Json = Annotated[bool, option("--json", "Print one JSON object and nothing else.")]
Report = Annotated[
    bool,
    option(
        "--report",
        "Also write the result as one page of HTML that opens without a network, with plots that zoom and the "
        "structure in motion; without --out into out/NAME.",
    ),
]
Verbose = Annotated[
    bool,
    option("--verbose", "Print what a verdict rests on, too: displacements, loads, limits used, and every peak."),
]


def usual_folder(scenario: Path, ending: str = "") -> Path:
    """Folder of the files of a scenario where --out names none: out/stdin for standard input."""
    return Path("out") / f"{scenario.stem.strip('<>')}{ending}"


@Parameter(name="*")
@dataclass(frozen=True)
class Output:
    """Options of all verbs with an answer: changes of the scenario, and how the answer is printed and written."""

    overrides: Overrides = ()
    out: Out = None
    json: Json = False
    report: Report = False
    verbose: Verbose = False

    def folder(self, scenario: Path, *, always: bool = False) -> Path | None:
        """Folder for files, or None: that of --out, or out/NAME for --report and, unless with --json, if `always`.

        InputError if it cannot be written to.
        """
        default = self.report or (always and not self.json)
        folder = self.out if self.out is not None or not default else usual_folder(scenario)
        if folder is not None:
            refuse_unwritable(folder)
        return folder


MotionName = Annotated[
    str | None, Parameter(name="--motion", help="Which [motion.NAME]; may be left out where only one can answer.")
]
At = Annotated[
    str | None, Parameter(name="--at", help='Time at which the motion is frozen, such as "2 s"; by default the start.')
]
IgnoreLimits = Annotated[
    bool,
    option("--ignore-limits", "Exit with 0 though a machine's limit is exceeded."),
]

SmoothVerb = Annotated[_Smooth, Parameter(help="Whose figures.")]

# Arguments of fit and optimize.
SearchBounds = Annotated[
    tuple[str, ...],
    option(
        "--bounds",
        'Of a value, "beam.damping_ratio=0.1 %:5 %", any number of times; else 0.1 to 10 times its own.',
    ),
]
Starts = Annotated[int, Parameter(help="Searches: one from the scenario's values, the others spread over the bounds.")]
WriteTo = Annotated[
    Path | None, Parameter(name="--write", help="A scenario to write, with the values found and its comments.")
]

# Argument of place.
Check = Annotated[
    bool, Parameter(name="--proof", negative="--no-proof", help="Check the answer by simulation with the model.")
]


def with_options(*verbs: str) -> Callable[[_Function], _Function]:
    """Decorate a verb's function: its argument `options` becomes a record of the options of these questions.

    With several questions a user may give any of them; the question that is asked refuses options of others.
    """
    words: dict[str, dict[str, list[str]]] = {}
    declared: dict[str, Any] = {}
    for verb in verbs:
        for name, entry in QUESTIONS[verb].options.items():
            declared.setdefault(name, entry)
            words.setdefault(name, {}).setdefault(entry.words, []).append(verb)
    members: list[tuple[str, Any, Any]] = []
    for name, entry in declared.items():
        texts = []
        for text, verbs_with_it in words[name].items():
            texts.append(text if len(verbs) == 1 else f"Of {' and '.join(verbs_with_it)}: {text}")
        kind = str | type(entry.default) if entry.kind else entry.type  # a quantity is given as text
        parameter = Parameter(name=entry.flag, help=" ".join(texts))
        members.append((entry.argument, Annotated[kind, parameter], entry.default))
    options = make_dataclass("Options", members, frozen=True, namespace={"__module__": __name__})
    record = Parameter(name="*", show=bool(members))(options)

    def declare(function: _Function) -> _Function:
        function.__annotations__["options"] = record
        function.__kwdefaults__ = (function.__kwdefaults__ or {}) | {"options": record()}
        return function

    return declare


def changed_options(options: Any) -> Any:
    """Options by name whose values in a record of options differ from the defaults."""
    pairs = {field.name: (getattr(options, field.name), field.default) for field in fields(options)}
    return {name.rstrip("_"): value for name, (value, default) in pairs.items() if value != default}


@dataclass(frozen=True)
class Input:
    """A scenario as read, and the case that it describes."""

    scenario: AnyScenario
    case: Case

    @contextmanager
    def placing(self, **options: str) -> Iterator[None]:
        """Place InputErrors raised inside: at an option, of `options` by argument, or else in the scenario file."""
        try:
            yield
        except InputError as error:
            if error.where in options:
                raise error.at(options[error.where]) from None
            from gbeam.scenario.load import placed

            raise placed(self.scenario, [error]) from None

    def motion(self, name: str | None, *, kind: str = "") -> tuple[str, Any]:
        """Name and prepared motion that ``--motion`` chooses, or else the only one; of a `kind` if one is named."""
        chosen = motion_of(self.case.environments, name, kind)
        try:
            return chosen, prepared(self.case, chosen)
        except InputError as error:
            from gbeam.scenario.load import placed

            raise placed(self.scenario, [error.within(f"motion.{chosen}")]) from None

    def answer(self, question: Question, motion: str | None, at: str | None, options: Any, needs: Needs) -> Any:
        """Answer of a question with the options of the command line, while a watch shows its progress."""
        time, chosen_options = (
            None if at is None else number("--at", at, "time"),
            question.chosen(changed_options(options)),
        )
        places = {entry.argument.rstrip("_"): entry.flag for entry in question.options.values()}
        with Watch() as watch, self.placing(**places):
            if "progress" in signature(question.answer).parameters:
                chosen_options["progress"] = watch
            return question.answer(self.case, motion, time, needs, **chosen_options)

    def time(self, text: str | None, motion: str) -> float:
        """Time of ``--at``, s; for None the start of the response in a motion."""
        return self.case.start_of(motion) if text is None else number("--at", text, "time")


def signed(facts: dict[str, Any], provenance: Provenance | None) -> dict[str, Any]:
    """Add the provenance to a result's facts, as a function: to look it up takes a while, and is not always needed."""

    def origin() -> dict[str, Any]:
        from gbeam.report.facts import origin_json

        assert provenance is not None
        return origin_json(provenance)

    return facts if provenance is None else {**facts, "provenance": origin}


_MOVING = ("run", "place")  # verbs that need the plans of all machines


def read(verb: str, file: Path, overrides: Sequence[str]) -> Input:
    """Load and build the scenario of a verb. InputError if the verb needs a body that deforms and there is none."""
    from gbeam.scenario.build import build  # not needed, nor imported, for help
    from gbeam.scenario.load import load, provenance

    with Watch(f"reading {file}" + (" and planning its machines" if verb in _MOVING else "")):
        scenario = load(file, overrides, distributions=verb == "check")
        case = build(scenario, ahead=verb in _MOVING)
    loaded = Input(scenario, replace(case, provenance=provenance(scenario, command())))
    with loaded.placing():
        if verb in QUESTIONS:
            QUESTIONS[verb].refuse(case)
        elif verb == "linearize":
            refuse_rigid(case, verb)
    return loaded


def number(option: str, text: str, kind: str) -> float:
    """Read an option with a unit."""
    from gbeam.guards.units import read_quantity  # not needed, nor imported, for help

    return read_quantity(option, text, kind)


def numbers(option: str, text: str, kind: str) -> list[float]:
    """Read the quantities, none negative, of one option, separated by commas."""
    values = [number(option, part.strip(), kind) for part in text.split(",")]
    if min(values) < 0:
        raise InputError(option, f"has {min(values):g}", "give none that is negative")
    return values


def names(texts: Sequence[str]) -> list[str]:
    """Return the names in all values of an option, separated by commas in each."""
    parts = ",".join(texts).split(",")
    return [name.strip() for name in parts if name.strip()]


def search_bounds(texts: Sequence[str]) -> dict[str, tuple[str, str]]:
    """Read the bounds of a search's values, each ``PATH=LOW:HIGH``, and return them by path."""
    values = {}
    for text in texts:
        path, equals, ends = text.partition("=")
        low, colon, high = ends.partition(":")
        if not (equals and colon):
            raise InputError("--bounds", f"is {text!r}", 'write "beam.damping_ratio=0.1 %:5 %"')
        values[path.strip()] = (low.strip(), high.strip())
    return values
