"""From the command line's scenario and options to the objects of the core."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gbeam.cli.process import Watch, command
from gbeam.errors import InputError
from gbeam.questions import QUESTIONS, motion_of, prepared

if TYPE_CHECKING:
    from gbeam.analysis.case import AnyCase, Case
    from gbeam.results.provenance import Provenance
    from gbeam.scenario.load import AnyScenario


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
                raise InputError(options[error.where], error.problem, error.fix) from None
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

    def time(self, text: str | None) -> float:
        """Time of ``--at``, s; the response's start where it is not given."""
        return self.case.response.start if text is None else number("--at", text, "time")


def signed(facts: dict[str, Any], provenance: Provenance | None) -> dict[str, Any]:
    """The facts of a result, as JSON, with where they come from: found when it is printed, since that takes a while."""

    def origin() -> dict[str, Any]:
        from gbeam.report.facts import origin_json

        assert provenance is not None
        return origin_json(provenance)

    return facts if provenance is None else {**facts, "provenance": origin}


_MOVING = ("run", "place")  # verbs that need all motions
_ANY = ("check", "linearize")  # verbs of beams and systems, beside the questions of both


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
        elif verb not in _ANY:
            case.one_beam("bodies", f"gbeam {verb}")
    return loaded


@contextmanager
def naming(option: str) -> Iterator[None]:
    """Name an option as the place of the InputErrors raised inside."""
    try:
        yield
    except InputError as error:
        raise InputError(option, error.problem, error.fix) from None


def number(option: str, text: str, kind: str) -> float:
    """Read an option with a unit."""
    from gbeam.guards.units import UnitError, argument

    try:
        return argument(text, kind)
    except UnitError as error:
        raise InputError(option, error.problem, error.hint or "write a number with its unit") from None


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
