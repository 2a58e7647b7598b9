"""What a verb answers to one case, as the JSON that the command line prints."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from gbeam.errors import InputError

if TYPE_CHECKING:
    from gbeam.analysis.study.case import Case
    from gbeam.mechanics.structure import Structure
    from gbeam.motion.protocol import Motion
    from gbeam.results.study import Study


Facts = Mapping[str, Any]


@dataclass(frozen=True)
class Needs:
    """Which costly parts of an answer a measure is among; the others need not be computed.

    Parameters
    ----------
    errors : bool
        What the answer says of its own errors: most of the time of a steady state.
    loads : bool
        What the sections carry.
    """

    errors: bool = True
    loads: bool = True


def _run(case: Case, motion: str | None, at: float | None, needs: Needs) -> Facts:
    from gbeam.analysis.study.study import study

    return study_facts(study(reduced(case, needs)))


def reduced(case: Case, needs: Needs) -> Case:
    """The case whose responses have what is needed, to the last digit as before.

    Automatic numbers of shapes follow from the errors, and an automatic step from the loads.
    """
    if needs.errors or case.model.automatic:
        return case
    response = replace(case.response, estimate=False)
    if response.step is not None and not needs.loads:
        response = replace(response, loads=False)
    return replace(case, response=response)


def study_facts(answer: Study) -> Facts:
    """What ``run`` answers, with the comparisons by the centrifuge's name, and the figures of each verdict."""
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


def _static(case: Case, motion: str | None, at: float | None, needs: Needs) -> Facts:
    from gbeam.analysis.equilibrium.static import static
    from gbeam.report.steady import deflection

    structure, time = _structure(case, needs), _time(case, at)
    names = list(case.motions) if motion is None else [motion]
    return deflection.to_json(case.title, [static(structure, _prepared(case, name), time, name=name) for name in names])


def _modes(case: Case, motion: str | None, at: float | None, needs: Needs) -> Facts:
    from gbeam.analysis.vibration import modal
    from gbeam.results.declared import json_of

    name = _only(case, motion, "")
    return json_of(modal.modes(_structure(case, needs), _prepared(case, name), _time(case, at), name=name))


def _critical_speed(case: Case, motion: str | None, at: float | None, needs: Needs) -> Facts:
    from gbeam.analysis.vibration import stability
    from gbeam.report.steady import critical

    name = _only(case, motion, "hub")
    structure = _structure(case, needs).at_time(_time(case, at))
    found = stability.critical_speed(structure, _prepared(case, name), name=name)
    return critical.to_json(found, name)


def _plan(case: Case, motion: str | None, at: float | None, needs: Needs) -> Facts:
    from gbeam.analysis.imitation.plan import plan
    from gbeam.report.machine import plan as report
    from gbeam.results.imitation.criteria import judging

    if motion is not None:
        _prepared(case, motion)  # or there is none of that name
    machines = {name: m for name, m in case.motions.items() if m.kind == "centrifuge" and motion in (None, name)}
    if not machines:
        raise InputError("motion", "has no centrifuge to plan", "add a motion of kind centrifuge")
    plans = [
        plan(name, _prepared(case, name), case.tracks[name], beam=case.beam, **judging(case.accept.get(name, {})))  # type: ignore[arg-type]
        for name in machines
    ]
    facts = report.to_json(case.title, plans, [])
    reasons = "; ".join(
        f"{each.name}: {each.message or each.refusal}" for each in plans if each.message or each.refusal
    )
    motions = {name: _limits_by_name(each) for name, each in facts["motions"].items()}
    return {**facts, "motions": motions, "message": reasons}


def _place(case: Case, motion: str | None, at: float | None, needs: Needs) -> Facts:
    from gbeam.analysis.imitation.choice import choice_of
    from gbeam.analysis.imitation.place import place
    from gbeam.motion import Centrifuge
    from gbeam.report.machine import placement

    name = _only(case, motion, "centrifuge")
    current = _prepared(case, name)
    if not isinstance(current, Centrifuge):
        raise InputError(f"motion.{name}", "is no centrifuge to put a specimen on", "add one that tracks the flight")
    names = case.tracks[name], name
    # Without the check by simulation, which would cost more than the answer: `run` at the placement is that.
    found = place(
        case.assemble(), current.flight, choice_of(current), case.response, {"tip": 1.0}, current=current, names=names
    )
    return placement.to_json(found)


# Of a case, a motion's name, the time at which it is frozen, and what is needed.
VERBS: Mapping[str, Callable[[Case, str | None, float | None, Needs], Facts]] = {
    "run": _run,
    "static": _static,
    "modes": _modes,
    "critical-speed": _critical_speed,
    "plan": _plan,
    "place": _place,
}


def _structure(case: Case, needs: Needs) -> Structure:
    """The case's structure; where no errors are needed it does not know what it was made of, and states none."""
    structure = case.assemble()
    return structure if needs.errors else replace(structure, source=None)


def _prepared(case: Case, name: str) -> Motion:
    """A motion prepared for the response's times."""
    if name not in case.motions:
        raise InputError("--motion", f"is {name!r}", f"the scenario has {', '.join(case.motions)}")
    first = case.response.start
    return case.motions[name].over(first, first + case.response.duration)


def _time(case: Case, at: float | None) -> float:
    return case.response.start if at is None else at


def _only(case: Case, name: str | None, kind: str) -> str:
    """The motion's name: the one given, or the only one (of a kind)."""
    if name is not None:
        if name not in case.motions:
            raise InputError("--motion", f"is {name!r}", f"the scenario has {', '.join(case.motions)}")
        return name
    choice = [each for each, motion in case.motions.items() if motion.kind == kind] or list(case.motions)
    if len(choice) > 1:
        raise InputError("--motion", "is missing", f"name one of {', '.join(choice)}")
    return choice[0]
