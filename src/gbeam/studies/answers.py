"""Answers of questions to one case as records of numbers, from which figures of merit are taken by their paths."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from gbeam.questions import QUESTIONS, Needs

if TYPE_CHECKING:
    from gbeam.analysis.case import AnyCase
    from gbeam.results.facts import Entry

Facts = Mapping[str, Any]
KIND = ""  # key of the kind of answers in facts; no figure's path begins so


def answered(verb: str, case: AnyCase, motion: str | None, at: float | None, needs: Needs) -> Facts:
    """The facts of a question's answer."""
    QUESTIONS[verb].refuse(case)
    return answer_facts(QUESTIONS[verb].answer(case, motion, at, needs), case.title)


def answer_facts(answer: Any, title: str = "") -> Facts:
    """The facts of an answer with what has a name by its name: comparisons, and the limits of machines."""
    from gbeam.results.facts import json_of
    from gbeam.results.kinds import by_motion

    several = isinstance(answer, tuple)
    facts = by_motion(answer, title) if several else json_of(answer)
    for motion in facts.get("motions", {}).values():
        if "limits" in motion:
            motion["limits"] = _by_axis(motion["limits"])
    if "comparisons" in facts:
        # By name, not by number; and what may be accepted stands under the verdict whether or not a limit is given.
        facts["comparisons"] = {
            each.centrifuge: {**compared, "verdict": each.figures | _accepted(compared.pop("accepted"))}
            for each, compared in zip(answer.comparisons, facts["comparisons"], strict=True)
        }
        facts["study"] = answer  # for histories
    kind = type(answer[0]) if several else type(answer)
    return {**facts, KIND: kind, "message": _message(answer) or facts.get("message", "")}


def tree_of_figures(kind: type) -> dict[str, Any]:
    """The figures of answers of a kind, each at its place in the facts."""
    from gbeam.results.facts import ANY, Entry
    from gbeam.results.imitation.criteria import RULES
    from gbeam.results.kinds import tree_of_answers

    tree = tree_of_answers(kind)
    for motion in tree.get("motions", {}).values():
        if "limits" in motion:
            motion["limits"] = {ANY: {ANY: dict(motion["limits"])}}
    if "comparisons" in tree:
        kept = {"accepted": Entry("", "whether every limit is kept")}
        judged = {rule.name: Entry("", f"value that the limit `{rule.name}` is on") for rule in RULES.values()}
        tree["comparisons"] = {ANY: {**tree["comparisons"], "verdict": judged | kept}}
    return tree


def choices(verb: str) -> dict[str, Entry]:
    """Every figure of a question's answers, of beams and of systems, by its path: ``*`` is a name, ``[i]`` a place in a
    list.
    """
    from gbeam.results.facts import paths_of

    return {path: each for kind in QUESTIONS[verb].records for path, each in paths_of(tree_of_figures(kind))}


def _message(answer: Any) -> str:
    """Why an answer in some motions is none, or which limits it does not keep."""
    if isinstance(answer, tuple):
        reasons = {each.name: each.message or each.refusal for each in answer if hasattr(each, "refusal")}
    elif hasattr(answer, "unfinished"):
        reasons = {name: failure.message for name, failure in answer.unfinished.items()} or answer.refusals
    else:
        reasons = {}
    return "; ".join(f"{name}: {reason}" for name, reason in reasons.items() if reason)


def _by_axis(limits: list[Facts]) -> Facts:
    """Limits of a machine by axis and quantity, as scenarios name them."""
    axes: dict[str, dict[str, Facts]] = {}
    for each in limits:
        axes.setdefault(each["axis"].replace(" ", ""), {})[each["quantity"]] = each
    return axes


def _accepted(accepted: bool | None) -> Facts:
    return {} if accepted is None else {"accepted": accepted}
