"""The verb of a question that has no file of its own: its options are those of the question."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from gbeam.cli.options import At, MotionName, Output, ScenarioFile, options_of, read
from gbeam.cli.outputs import deliver
from gbeam.questions import QUESTIONS, Needs, Question

_STATUS = "Exit status: 0 done, 1 there is no answer, 2 the input is wrong."


def __getattr__(name: str) -> Callable[..., int]:
    """The function of a verb by its name, made when it is called."""
    for each in QUESTIONS.values():
        if each.name.replace("-", "_") == name:
            return verb_of(each)
    raise AttributeError(name)


def verb_of(question: Question) -> Callable[..., int]:
    """The function of a question's verb."""
    name, options_type = question.name.replace("-", "_"), options_of(question.name)
    unset = options_type()

    def verb(
        scenario: ScenarioFile,
        /,
        *,
        motion: MotionName = None,
        at: At = None,
        options: Any = unset,
        output: Output = Output(),
    ) -> int:
        folder = output.folder(scenario)
        loaded = read(question.name, scenario, output.overrides)
        chosen = motion
        if question.motion is not None or motion is not None:
            chosen, _ = loaded.motion(motion, kind=question.motion or "")
        answer = loaded.answer(question, chosen, at, options, Needs(shapes=True))
        deliver(
            answer, name, folder, output, verb=question.name, origin=loaded.case.provenance,
            title=loaded.case.title, listed=False,
        )  # fmt: skip
        return 0

    verb.__name__ = name
    several = "Without --motion for all of them. " if question.motion is None else ""
    files = f"With --out also writes {name}.json and plots, with --report {name}.html."
    verb.__doc__ = f"{question.about}\n\n{several}{files} {_STATUS}"
    verb.__annotations__["options"] = options_type
    return verb
