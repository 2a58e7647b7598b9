"""The verb of a question that has no file of its own: its options are those of the question's function."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Annotated, Any, get_args, get_type_hints

from cyclopts import Parameter

from gbeam.cli.options import At, MotionName, Output, ScenarioFile, number, read
from gbeam.cli.outputs import deliver
from gbeam.cli.process import Watch
from gbeam.questions import QUESTIONS, Needs, Question

_KEYWORD = inspect.Parameter.KEYWORD_ONLY
_BEFORE = {"motion": (MotionName, None), "at": (At, None)}
_AFTER = {"output": (Output, Output())}
_STATUS = "Exit status: 0 done, 1 there is no answer, 2 the input is wrong."


def __getattr__(name: str) -> Callable[..., int]:
    """The function of a verb by its name, made when it is called."""
    for each in QUESTIONS.values():
        if each.name.replace("-", "_") == name:
            return verb_of(each)
    raise AttributeError(name)


def verb_of(question: Question) -> Callable[..., int]:
    """The function of a question's verb."""
    name, kinds, declared = question.name.replace("-", "_"), dict[str, str](), {}
    options = [each for each in inspect.signature(question.answer).parameters.values() if each.kind is _KEYWORD]
    written = SimpleNamespace(__annotations__={each.name: each.annotation for each in options})
    hints = get_type_hints(written, question.answer.__globals__, include_extras=True)
    for each in options:
        hint, words, *kind = get_args(hints[each.name])
        kinds[each.name] = kind[0] if kind else ""
        declared[each.name] = Annotated[str | None if kind else hint, Parameter(help=words)], each.default

    arguments = {**_BEFORE, **declared, **_AFTER}

    def verb(scenario: Path, /, **options: Any) -> int:
        defaults = {key: default for key, (_, default) in arguments.items()}
        return _answer(question, name, kinds, scenario, **(defaults | options))

    verb.__name__ = name
    several = "Without --motion for all of them. " if question.motion is None else ""
    files = f"With --out also writes {name}.json and plots, with --report {name}.html."
    verb.__doc__ = f"{question.about}\n\n{several}{files} {_STATUS}"
    signature = [inspect.Parameter("scenario", inspect.Parameter.POSITIONAL_ONLY, annotation=ScenarioFile)]
    for key, (annotation, default) in arguments.items():
        signature.append(inspect.Parameter(key, _KEYWORD, default=default, annotation=annotation))
    verb.__signature__ = inspect.Signature(signature)  # type: ignore[attr-defined]
    verb.__annotations__ = {each.name: each.annotation for each in signature}
    return verb


def _answer(
    question: Question,
    name: str,
    kinds: dict[str, str],
    scenario: Path,
    *,
    motion: str | None,
    at: str | None,
    output: Output,
    **options: Any,
) -> int:
    folder = output.folder(scenario)
    loaded = read(question.name, scenario, output.overrides)
    chosen = motion
    if question.motion is not None or motion is not None:
        chosen, _ = loaded.motion(motion, kind=question.motion or "")
    time = loaded.time(at)
    places = {key: f"--{key.replace('_', '-')}" for key in kinds}
    for key, value in options.items():
        if kinds[key] and isinstance(value, str):
            options[key] = number(places[key], value, kinds[key])
    with Watch(), loaded.placing(**places):
        answer = question.answer(loaded.case, chosen, time, Needs(shapes=True), **options)

    deliver(
        answer, name, folder, output, verb=question.name, origin=loaded.case.provenance,
        title=loaded.case.title, listed=False,
    )  # fmt: skip
    return 0
