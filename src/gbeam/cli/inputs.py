"""From the command line's scenario to the objects of the core."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from gbeam.errors import InputError
from gbeam.scenario import Scenario, build, load, placed

if TYPE_CHECKING:
    from gbeam.analysis.study.case import Case
    from gbeam.io.netcdf import Provenance


@dataclass(frozen=True)
class Input:
    """A scenario as read, and the case that it describes."""

    scenario: Scenario
    case: Case
    command: str

    @contextmanager
    def placing(self) -> Iterator[None]:
        """Give the InputErrors raised inside their place in the scenario file."""
        try:
            yield
        except InputError as error:
            raise placed(self.scenario, [error]) from None

    def provenance(self) -> Provenance:
        """What a result file says about where it came from."""
        from gbeam.io.netcdf import Provenance

        source = self.scenario.source
        if source is None:
            return Provenance(command=self.command)
        return Provenance(source.text, tuple(it.text for it in source.overrides), self.command)


def read(verb: str, file: Path, overrides: Sequence[str]) -> Input:
    """Load and build the scenario that a verb was given.

    Raises
    ------
    ScenarioError
        With everything that is wrong, each with its place.
    """
    scenario = load(file, overrides)
    changes = [word for change in overrides for word in ("--set", change)]
    return Input(scenario, build(scenario), shlex.join(["gbeam", verb, str(file), *changes]))
