"""Answers of questions to one case as the JSON that the command line prints, from which figures are taken."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from gbeam.questions import QUESTIONS, Needs, motion_of

if TYPE_CHECKING:
    from gbeam.analysis.case import Case
    from gbeam.results.imitation.plan import MachinePlan
    from gbeam.results.study import Study

Facts = Mapping[str, Any]
DECLARED = ""  # key of the units of a record that declares them; no figure's path begins so


def answered(verb: str, case: Case, motion: str | None, at: float | None, needs: Needs) -> Facts:
    """The facts of a question's answer."""
    from gbeam.results.declared import json_of, units_of

    question = QUESTIONS[verb]
    answer = question.answer(case, motion, at, needs)
    facts = _FACTS.get(verb)
    return {**json_of(answer), DECLARED: units_of(type(answer))} if facts is None else facts(case, motion, answer)


def study_facts(answer: Study) -> Facts:
    """The facts of ``run``, with the comparisons by the centrifuge's name, and the figures of each verdict."""
    from gbeam.report.study.summary_json import to_json

    facts = to_json(answer)
    # By name, not by number; and what may be accepted stands under the verdict whether or not a limit is given.
    facts["comparisons"] = {
        each.centrifuge: {**found, "verdict": {**each.figures, **_accepted(found.pop("accepted"))}}
        for each, found in zip(answer.comparisons, facts["comparisons"], strict=True)
    }
    facts["motions"] = {name: _limits_by_name(each) for name, each in facts["motions"].items()}
    facts["study"] = answer  # for histories
    reasons = {name: failure.message for name, failure in answer.unfinished.items()} or answer.refusals
    facts["message"] = "; ".join(f"{name}: {reason}" for name, reason in reasons.items())
    return facts


def _limits_by_name(motion: Facts) -> Facts:
    """The facts of a motion with a machine's limits by axis and quantity, as scenarios name them."""
    if "limits" not in motion:
        return motion
    axes: dict[str, dict[str, Facts]] = {}
    for each in motion["limits"]:
        axes.setdefault(each["axis"].replace(" ", ""), {})[each["quantity"]] = each
    return {**motion, "limits": axes}


def _accepted(accepted: bool | None) -> Facts:
    return {} if accepted is None else {"accepted": accepted}


def _static(case: Case, motion: str | None, answer: Any) -> Facts:
    from gbeam.report.steady import deflection

    return deflection.to_json(case.title, answer)


def _critical_speed(case: Case, motion: str | None, answer: Any) -> Facts:
    from gbeam.report.steady import critical

    return critical.to_json(answer, motion_of(case.motions, motion, "hub"))


def _plan(case: Case, motion: str | None, answer: tuple[MachinePlan, ...]) -> Facts:
    from gbeam.report.machine import plan as report

    facts = report.to_json(case.title, answer, [])
    reasons = "; ".join(
        f"{each.name}: {each.message or each.refusal}" for each in answer if each.message or each.refusal
    )
    motions = {name: _limits_by_name(each) for name, each in facts["motions"].items()}
    return {**facts, "motions": motions, "message": reasons}


def _place(case: Case, motion: str | None, answer: Any) -> Facts:
    from gbeam.report.machine import placement

    return placement.to_json(answer)


_FACTS: Mapping[str, Callable[[Case, str | None, Any], Facts]] = {
    "run": lambda case, motion, answer: study_facts(answer),
    "static": _static,
    "critical-speed": _critical_speed,
    "plan": _plan,
    "place": _place,
}
