"""What the objects of the core refuse: collected, so that one mistake does not hide the next, and put at its place."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any, TypeVar

from gbeam.errors import InputError
from gbeam.scenario.text.diagnostics import Diagnostic, ScenarioError
from gbeam.scenario.values.paths import parse_path

if TYPE_CHECKING:
    from gbeam.scenario.schema import Environments
    from gbeam.scenario.text.source import Mark, Source

T = TypeVar("T")


class Collector:
    """Collects the InputErrors of what it attempts, in `errors`."""

    def __init__(self) -> None:
        self.errors: list[InputError] = []

    def attempt(self, where: str, make: Callable[..., T], *args: Any, **options: Any) -> T | None:
        """Return ``make(*args, **options)``; None, with its error kept as one of `where`, if it refuses."""
        try:
            return make(*args, **options)
        except InputError as error:
            self.errors.append(error.within(where))
            return None


def placed(scenario: Environments, errors: Iterable[InputError]) -> ScenarioError:
    """Return the ScenarioError of what the objects of the core refused."""
    return ScenarioError(_diagnostic(scenario.source, error) for error in errors)


def _diagnostic(source: Source | None, error: InputError) -> Diagnostic:
    if source is None:  # a scenario made without a text
        return Diagnostic("scenario", error.where, error.problem, error.fix)
    # "is given beside rate" is about the key, everything else about the value.
    mark: Mark = "key" if error.problem.startswith("is given") else "value"
    return source.diagnostic(parse_path(error.where) or (), error.problem, error.fix, mark)
