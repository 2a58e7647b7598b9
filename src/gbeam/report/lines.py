"""Lines and blocks of any result, from its JSON: by the function of its kind, or every quantity as it is."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from importlib import import_module
from typing import Any

from gbeam.report.blocks import FIGURES, Block, Facts, Items, Place, Section, Sentence, in_words, quantities
from gbeam.report.words import json_value
from gbeam.results.result import Result, each_once

# Kinds by the module that has a function of their name; of others every quantity is listed.
_MODULES = {
    "cases": ("Sweep",),
    "machine": ("MachinePlan", "Comparison"),
    "searches": ("Sensitivity", "Fit", "Optimum", "ShapedCommand", "Placement"),
    "steady": ("Rest", "Modes", "Campbell", "Critical", "CriticalMap", "EquilibriumPath", "StateSpace"),
    "study": ("Study", "ModelStudy"),
}
_TITLED = ("Study", "MachinePlan", "ModelStudy")  # in a terminal


def blocks_of(
    kind: str, facts: Facts, words: Mapping[str, str] | None = None, options: Mapping[str, Any] | None = None
) -> Iterable[Block]:
    """Return what a report says of a kind of result, from its JSON, with `words` of its quantities by their paths.

    `options` are those of the function of the kind, such as the unit of speeds.
    """
    module = next((name for name, kinds in _MODULES.items() if kind in kinds), None)
    if module is None:
        return _plain_quantities(facts, words)
    name = re.sub(r"(?<!^)(?=[A-Z])", "_", kind).lower()
    blocks: Iterable[Block] = getattr(import_module(f"gbeam.report.{module}"), name)(facts, **(options or {}))
    return blocks


def _plain_quantities(facts: Facts, words: Mapping[str, str] | None) -> Iterable[Block]:
    """Yield the quantities of a result as they are, which no module describes."""
    yield Section("View", (Place("viewer"),))
    yield from quantities(facts, words=words)
    yield Section("Figures", (FIGURES,))


def lines_of(kind: type, facts: Facts, *, verbose: bool = True, **options: Any) -> list[tuple[str, str]]:
    """Return the lines that a terminal shows of a kind of result, from its JSON, each with its tone.

    Without `verbose` the figures that a verdict rests on are left out.
    """
    from gbeam.results.facts import paths_of
    from gbeam.results.study import tree_of_answers  # of every kind, which `gbeam check` does without

    title = [Sentence(facts["title"], "verdict")] if facts.get("title") and kind.__name__ in _TITLED else []
    words = {path: declaration.words for path, declaration in paths_of(tree_of_answers(kind))}
    blocks = list(blocks_of(kind.__name__, facts, words, options))
    lines = in_words([*title, *blocks, *remarks_of(facts)], verbose=verbose)
    hidden = not verbose and any(isinstance(block, Section) and block.verbose for block in blocks)
    return [*lines, ("", ""), ("Everything else: --verbose, --report or --json.", "faint")] if hidden else lines


def text(*answers: Result) -> str:
    """Return a result, or several of one kind, in words."""
    from gbeam.report.facts import facts, json_form

    return "\n".join(line for line, _ in lines_of(type(json_form(answers[0])), json_value(facts(*answers))))


def remarks_of(facts: Facts) -> tuple[Items, Items]:
    """Return the warnings and the notes of a result, or of several by motion, each once."""
    answers = facts.get("motions", {})

    def remarks(kind: str) -> tuple[str, ...]:
        by_motion = {name: answer.get(kind, ()) for name, answer in answers.items()}
        return tuple(dict.fromkeys((*facts.get(kind, ()), *each_once(by_motion))))

    return Items(remarks("warnings"), "warning"), Items(remarks("notes"), "note")
