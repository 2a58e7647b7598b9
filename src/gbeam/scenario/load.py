"""From a file, or text, to a validated scenario."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

from pydantic import ValidationError

from gbeam.limits import PROBLEMS
from gbeam.scenario.schema import Environments, Scenario
from gbeam.scenario.text.diagnostics import Diagnostic, ScenarioError
from gbeam.scenario.text.overrides import override
from gbeam.scenario.text.source import Source, parse, read_text

T = TypeVar("T", bound=Environments)


def load(path: str | os.PathLike[str], overrides: Iterable[str] = ()) -> Scenario:
    """Read and validate a scenario file.

    Parameters
    ----------
    path : path
        TOML, or JSON if its text begins with a brace. File names in it are relative to its folder.
    overrides : iterable of str
        Changes such as ``beam.length=250 mm`` or ``beam.masses[0].mass=0.2 kg``, made before validation.

    Returns
    -------
    Scenario
        Frozen, SI floats.

    Raises
    ------
    ScenarioError
        With everything that is wrong, each with its place.
    """
    file = Path(path)
    return loads(read_text(file), os.fspath(path), overrides, folder=file.parent)


def loads(
    text: str, name: str = "scenario", overrides: Iterable[str] = (), *, folder: str | os.PathLike[str] = "."
) -> Scenario:
    """Validate the text of a scenario.

    Parameters
    ----------
    text : str
        TOML, or JSON if it begins with a brace.
    name : str
        What messages call it.
    overrides : iterable of str
        As for :func:`load`.
    folder : path
        That relative file names in the scenario start from.

    Returns
    -------
    Scenario

    Raises
    ------
    ScenarioError
        With everything that is wrong, each with its place.
    """
    return _validated(Scenario, _source(text, name, overrides, folder))


def change(source: Source, overrides: Iterable[str]) -> Scenario:
    """Validate a scenario that is parsed already, with more changes: what differs between the cases of a sweep.

    Parameters
    ----------
    source : Source
        Of a scenario that was read.
    overrides : iterable of str
        As for :func:`load`, after those in the source.

    Raises
    ------
    ScenarioError
        With everything that is wrong, each with its place.
    """
    data, done = override(source.data, source.name, overrides)
    return _validated(Scenario, replace(source, data=data, overrides=source.overrides + done))


def load_environments(path: str | os.PathLike[str], overrides: Iterable[str] = ()) -> Environments:
    """Read a scenario file that may lack the beam, for questions about the machine alone.

    Parameters, errors
        As for :func:`load`.

    Returns
    -------
    Environments
        A Scenario if the file has a [beam] or a [model], which are then validated too.
    """
    file = Path(path)
    source = _source(read_text(file), os.fspath(path), overrides, file.parent)
    kind = Scenario if {"beam", "model"} & source.data.keys() else Environments
    return _validated(kind, source)


def _source(text: str, name: str, overrides: Iterable[str], folder: str | os.PathLike[str]) -> Source:
    data, done = override(parse(name, text), name, overrides)
    return Source(name, text, Path(folder), data, done)


def _validated(kind: type[T], source: Source) -> T:
    try:
        return kind.model_validate(source.data, context={"folder": source.folder, "source": source})
    except ValidationError as error:
        from gbeam.scenario.explain import explain  # needed only where something is wrong

        details = error.errors(include_url=False, include_input=False)
        problems = [explain(source, detail) for detail in details[:PROBLEMS]]
        if len(details) > PROBLEMS:
            more = f"has {len(details)} errors, of which {PROBLEMS} are listed"
            problems.append(Diagnostic(source.name, "", more, "correct these first"))
        raise ScenarioError(problems) from None
