"""The arguments that verbs share, and from them to the objects of the core."""

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
    from gbeam.analysis.case import AnyCase, Case
    from gbeam.questions import Verb as Verb
    from gbeam.results.provenance import Provenance
    from gbeam.scenario.load import AnyScenario

    _Smooth = Verb
else:
    Verb = Literal[tuple(QUESTIONS)]
    _Smooth = Literal[differentiable()]


_Function = TypeVar("_Function", bound=Callable[..., int])


def option(name: str, words: str) -> Parameter:
    """An option without an opposite, whose default is not worth a word in the help."""
    return Parameter(name=name, negative="", show_default=False, help=words)


# Of all verbs, or of many.
ScenarioFile = Annotated[Path, Parameter(help="Scenario file, TOML or JSON.")]
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


@Parameter(name="*")
@dataclass(frozen=True)
class Output:
    """Options of every verb that answers: the changes of its scenario, and how its answer is printed and written."""

    overrides: Overrides = ()
    out: Out = None
    json: Json = False
    report: Report = False

    def folder(self, scenario: Path, *, always: bool = False) -> Path | None:
        """The folder of --out, which can be written to; without it out/ and the scenario's name for a page, or always.

        With --json nothing is written that was not asked for.
        """
        default = self.report or (always and not self.json)
        folder = self.out if self.out is not None or not default else Path("out") / scenario.stem
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

# Of fit and optimize.
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

# Of place.
Check = Annotated[
    bool, Parameter(name="--proof", negative="--no-proof", help="Check the answer by simulation with the model.")
]


def with_options(*verbs: str) -> Callable[[_Function], _Function]:
    """Give a function of the command line, as its argument `options`, a record of the options of some questions.

    Of several questions those that a user gives are of one of them, which refuses the others.
    """
    words: dict[str, dict[str, list[str]]] = {}
    known: dict[str, Any] = {}
    for verb in verbs:
        for name, each in QUESTIONS[verb].options.items():
            known.setdefault(name, each)
            words.setdefault(name, {}).setdefault(each.words, []).append(verb)
    every: list[tuple[str, Any, Any]] = []
    for name, each in known.items():
        said = [text if len(verbs) == 1 else f"Of {' and '.join(of)}: {text}" for text, of in words[name].items()]
        kind = str | type(each.default) if each.kind else each.type  # a quantity is given as text
        every.append((each.argument, Annotated[kind, Parameter(name=each.flag, help=" ".join(said))], each.default))
    record = Parameter(name="*")(make_dataclass("Options", every, frozen=True, namespace={"__module__": __name__}))

    def declare(function: _Function) -> _Function:
        function.__annotations__["options"] = record
        function.__kwdefaults__ = (function.__kwdefaults__ or {}) | {"options": record()}
        return function

    return declare


def asked(options: Any) -> Any:
    """Options of a question that were given, by their names: those that are not as without them."""
    every = {each.name: (getattr(options, each.name), each.default) for each in fields(options)}
    return {name.rstrip("_"): value for name, (value, default) in every.items() if value != default}


@dataclass(frozen=True)
class Input:
    """A scenario as read, and the case that it describes."""

    scenario: AnyScenario
    case: AnyCase

    @contextmanager
    def placing(self, **options: str) -> Iterator[None]:
        """Give InputErrors their place in the scenario file, or the option that sets the argument they name."""
        try:
            yield
        except InputError as error:
            if error.where in options:
                raise error.at(options[error.where]) from None
            from gbeam.scenario import placed

            raise placed(self.scenario, [error]) from None

    @property
    def beam(self) -> Case:
        """The case of one beam: of a system none is read by its verb."""
        return self.case.one_beam("bodies", "this")

    def motion(self, name: str | None, *, kind: str = "") -> tuple[str, Any]:
        """Name and prepared motion of ``--motion``; without one the only one, or the only one of a kind."""
        chosen = motion_of(self.case.environments, name, kind)
        try:
            return chosen, prepared(self.case, chosen)
        except InputError as error:
            from gbeam.scenario import placed

            raise placed(self.scenario, [error.within(f"motion.{chosen}")]) from None

    def answer(self, question: Question, motion: str | None, at: str | None, options: Any, needs: Needs) -> Any:
        """Answer of a question with the options of the command line."""
        time, chosen = self.time(at), question.chosen(asked(options))
        places = {each.argument.rstrip("_"): each.flag for each in question.options.values()}
        with Watch() as watch, self.placing(**places):
            if "progress" in signature(question.answer).parameters:
                chosen["progress"] = watch
            return question.answer(self.case, motion, time, needs, **chosen)

    def time(self, text: str | None) -> float:
        """Time of ``--at``, s; the response's start where it is not given."""
        return self.case.start if text is None else number("--at", text, "time")


def signed(facts: dict[str, Any], provenance: Provenance | None) -> dict[str, Any]:
    """The facts of a result, as JSON, with where they come from: found when it is printed, since that takes a while."""

    def origin() -> dict[str, Any]:
        from gbeam.report.facts import origin_json

        assert provenance is not None
        return origin_json(provenance)

    return facts if provenance is None else {**facts, "provenance": origin}


_MOVING = ("run", "place")  # verbs that need all motions
_ANY = ("check", "models")  # verbs of beams and systems, beside the questions of both


def read(verb: str, file: Path, overrides: Sequence[str]) -> Input:
    """Load and build the scenario of a verb."""
    from gbeam.scenario import build, load, provenance  # not needed, nor imported, for help

    with Watch(f"reading {file}" + (" and planning its machines" if verb in _MOVING else "")):
        scenario = load(file, overrides, distributions=verb == "check")
        case = build(scenario, ahead=verb in _MOVING)
    loaded = Input(scenario, replace(case, provenance=provenance(scenario, command())))
    with loaded.placing():
        if verb in QUESTIONS:
            QUESTIONS[verb].refuse(case, "gbeam ")
        elif verb == "linearize":
            refuse_rigid(case, verb)
        elif verb not in _ANY:
            case.one_beam("bodies", f"gbeam {verb}")
    return loaded


def number(option: str, text: str, kind: str) -> float:
    """Read an option with a unit."""
    from gbeam.guards.units import read_quantity  # not needed, nor imported, for help

    return read_quantity(option, text, kind)


def numbers(option: str, text: str, kind: str) -> list[float]:
    """Read the quantities of one option, separated by commas."""
    values = [number(option, part.strip(), kind) for part in text.split(",")]
    if min(values) < 0:
        raise InputError(option, f"has {min(values):g}", "give none that is negative")
    return values


def names(texts: Sequence[str]) -> list[str]:
    """Names given to an option that may be option, separated by commas in each."""
    return [name.strip() for text in texts for name in text.split(",") if name.strip()]


def search_bounds(texts: Sequence[str]) -> dict[str, tuple[str, str]]:
    """Bounds of the values of a search, each ``PATH=LOW:HIGH``, by path."""
    values = {}
    for text in texts:
        path, equals, ends = text.partition("=")
        low, colon, high = ends.partition(":")
        if not (equals and colon):
            raise InputError("--bounds", f"is {text!r}", 'write "beam.damping_ratio=0.1 %:5 %"')
        values[path.strip()] = (low.strip(), high.strip())
    return values
