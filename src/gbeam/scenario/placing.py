"""What the objects of the core refuse, with its place in the scenario."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from gbeam.errors import InputError
from gbeam.scenario.text.diagnostics import Diagnostic, ScenarioError
from gbeam.scenario.text.paths import parse_path

if TYPE_CHECKING:
    from gbeam.scenario.schema import Environments
    from gbeam.scenario.text.source import Mark, Source


def placed(scenario: Environments, errors: Iterable[InputError]) -> ScenarioError:
    """Return the ScenarioError of what the objects of the core refused.

    Parameters
    ----------
    scenario : Environments
        What they were built from.
    errors : iterable of InputError
        Whose ``where`` are paths from the top of the scenario, such as ``beam.masses[0].at``.
    """
    return ScenarioError(_diagnostic(scenario.source, error) for error in errors)


def _diagnostic(source: Source | None, error: InputError) -> Diagnostic:
    if source is None:  # a scenario made without a text
        return Diagnostic("scenario", error.where, error.problem, error.fix)
    # "is given beside rate" is about the key, everything else about the value.
    mark: Mark = "key" if error.problem.startswith("is given") else "value"
    return source.diagnostic(parse_path(error.where) or (), error.problem, error.fix, mark)
