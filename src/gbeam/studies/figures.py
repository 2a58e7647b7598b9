"""Figures of a case, named by the end of their path in a verb's JSON, with units; and histories over time."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, reduce
from operator import getitem
from typing import TYPE_CHECKING, Any

import numpy as np

from gbeam.analysis.case import Case
from gbeam.errors import InputError
from gbeam.mechanics.tree.body_terms import stations_of
from gbeam.printable import advise, closest
from gbeam.questions import HUB, question_of
from gbeam.results.result import Floats
from gbeam.scenario.values import path_text
from gbeam.studies.template import Template

if TYPE_CHECKING:
    from gbeam.results.facts import Entry
    from gbeam.results.study import Study

Facts = Mapping[str, Any]
KIND = ""  # key in facts of the class of the answer; no figure's path begins so


def answer_facts(answer: Any, title: str = "") -> Facts:
    """Facts of an answer, as in its JSON, with comparisons by centrifuge and limits by axis and quantity."""
    from gbeam.results.facts import json_of
    from gbeam.results.study import by_motion

    several = isinstance(answer, tuple)
    facts = by_motion(answer, title) if several else json_of(answer)
    for motion in facts.get("motions", {}).values():
        if "limits" in motion:
            motion["limits"] = _by_axis(motion["limits"])
    if "comparisons" in facts:
        # The figures that may be limited stand under the verdict whether or not a limit is given.
        by_centrifuge = {}
        for comparison, pair_facts in zip(answer.comparisons, facts["comparisons"], strict=True):
            verdict = comparison.figures | _accepted(pair_facts["accepted"])
            by_centrifuge[comparison.centrifuge] = {**pair_facts, "verdict": verdict}
        facts["comparisons"] = by_centrifuge
    if hasattr(answer, "responses"):
        facts["study"] = answer  # for histories
    kind = type(answer[0]) if several else type(answer)
    return {**facts, KIND: kind, "message": _message(answer) or facts.get("message", "")}


@cache  # by kind, whose declarations do not change; nobody writes into it
def tree_of_figures(kind: type) -> dict[str, Any]:
    """Declared entries of the answers of a class, as a tree like `answer_facts`. The key ANY stands for any name."""
    from gbeam.results.criteria import RULES
    from gbeam.results.facts import ANY, Entry
    from gbeam.results.study import tree_of_answers

    tree = tree_of_answers(kind)
    for motion in tree.get("motions", {}).values():
        if "limits" in motion:
            motion["limits"] = {ANY: {ANY: dict(motion["limits"])}}
    if "comparisons" in tree:
        accepted = {"accepted": Entry("", "whether every limit is kept")}
        judged = {rule.name: Entry("", f"value that the limit `{rule.name}` is on") for rule in RULES.values()}
        tree["comparisons"] = {ANY: {**tree["comparisons"], "verdict": judged | accepted}}
    return tree


def choices(verb: str) -> dict[str, Entry]:
    """Entry of every figure of a verb's answers by its path: ``*`` is any name, ``[i]`` any place in a list."""
    from gbeam.results.facts import paths_of

    entries: dict[str, Entry] = {}
    for kind in question_of(verb).records:
        entries |= paths_of(tree_of_figures(kind))
    return entries


def _message(answer: Any) -> str:
    """Reasons, by motion, why there is no answer, or why it is refused, or empty if there are none."""
    if isinstance(answer, tuple):
        reasons = {plan.name: plan.message or plan.refusal for plan in answer if hasattr(plan, "refusal")}
    elif hasattr(answer, "unfinished"):
        reasons = {name: failure.message for name, failure in answer.unfinished.items()} or answer.refusals
    else:
        reasons = {}
    return "; ".join(f"{name}: {reason}" for name, reason in reasons.items() if reason)


def _by_axis(limits: list[Facts]) -> Facts:
    """Limits of a machine by axis and quantity, as scenarios name them."""
    axes: dict[str, dict[str, Facts]] = {}
    for limit in limits:
        axes.setdefault(limit["axis"].replace(" ", ""), {})[limit["quantity"]] = limit
    return axes


def _accepted(accepted: bool | None) -> Facts:
    return {} if accepted is None else {"accepted": accepted}


OPTION = "--measure"
BODIES = "bodies"  # key under which facts have bodies by name
Keys = tuple[str | int, ...]
_MANY = 12  # figures that a message lists


def find(facts: Facts, name: str) -> Keys:
    """Return the keys of the figure whose path in the facts of a case ends in `name`, such as ``tip.z.max_abs``."""
    keys_of = {path_text(keys): keys for keys, _ in figures_in(facts)}
    ending = f".{name}"
    fits = [path for path in keys_of if f".{path}".endswith(ending)]
    # Of the only body that deforms, its name may be left out.
    fits = fits or [path for path, keys in keys_of.items() if f".{path_text(without_body(keys))}".endswith(ending)]
    if not fits:
        ends = set()
        for path in keys_of:
            steps = path.split(".")
            ends |= {".".join(steps[k:]) for k in range(len(steps))}
        guess = closest(name, sorted(ends, key=lambda end: (abs(end.count(".") - name.count(".")), end)))
        fix = f"did you mean {guess!r}?" if guess else "list names every figure, with its unit"
        if name.endswith("verdict.accepted"):
            fix = "a verdict is accepted or not by limits: set them in [motion.NAME.accept]"
        raise InputError(OPTION, f"{name!r} is no figure of this", fix)
    if len(fits) > 1 and name not in fits:
        choices = ", ".join(fits[:_MANY]) + (", …" if len(fits) > _MANY else "")
        raise InputError(OPTION, f"{name!r} could be any of {len(fits)} figures", f"name one of {choices}")
    return keys_of[name if name in fits else fits[0]]


def check_figures(verb: str, names: Iterable[str], option: str = OPTION) -> None:
    """Refuse a name that no figure of a verb can have, before anything is computed."""
    paths = [_segments(path) for path in choices(verb)]
    for name in names:
        ends = _segments(name)
        if '"' not in name and not any(_fits(ends, path) for path in paths):
            # Ends of paths as long as the name, with the name's own words where any name may stand.
            candidates = []
            for path in paths:
                end_keys = path[-len(ends) :]
                pairs = zip(end_keys, ends[-len(end_keys) :], strict=True)
                candidates.append(".".join(end if key == "*" else key for key, end in pairs))
            guess = closest(name, candidates)
            fix = f"did you mean {guess!r}?" if guess else "list names every figure, with its unit"
            raise InputError(option, f"{name!r} is no figure of {verb}", fix)


def without_body(keys: Sequence[Any]) -> tuple[Any, ...]:
    """Keys of a figure without those that lead to a body."""
    place = keys.index(BODIES) if BODIES in keys else len(keys)
    return (*keys[:place], *keys[place + 2 :])


def _segments(path: str) -> list[str]:
    return re.sub(r"\[(?:i|\d+)\]", "[i]", path).split(".")


def _fits(ends: Sequence[str], path: Sequence[str]) -> bool:
    """True if a path can end in the keys `ends`. Its ``*`` stand for any name, which may contain dots.

    The name of a body may be left out.
    """
    if BODIES in path and _fits(ends, without_body(path)):
        return True
    return _ending(tuple(path)).fullmatch(".".join(ends)) is not None


@cache
def _ending(path: tuple[str, ...]) -> re.Pattern[str]:
    """Compile the pattern of the ends of a path."""
    pattern = ""
    for key in path[:-1]:
        word = ".+" if key == "*" else re.escape(key)
        pattern = rf"(?:{pattern}{word}\.)?"
    last_word = "[^.]+" if path[-1] == "*" else re.escape(path[-1])
    return re.compile(pattern + last_word)


def usual_figures(template: Template, verb: str, *, judged: bool = False) -> tuple[str, ...]:
    """Figures of a verb that are taken if none is named; those of comparisons only if `judged`.

    These begin with what the verdict is on: limits of acceptance, or the largest load where there is none.
    """
    case = template.built()
    patterns, deforming = question_of(verb).usual, tuple(case.system.flexible)
    limited = [name for name in case.tracks if case.accept.get(name)]
    figures = [pattern for pattern in patterns if "{judged}" in pattern]
    for name in case.environments:
        figures += [pattern.replace("{motion}", name) for pattern in patterns if "{motion}" in pattern]
    figures += [pattern for pattern in patterns if not any(key in pattern for key in ("{judged}", "{motion}"))]
    if len(deforming) == 1:
        figures = [figure.replace(f"{BODIES}.{{body}}.", "") for figure in figures]
    verdicts = []
    for name in case.tracks:
        limits = case.accept.get(name) or ("largest_load",)
        verdicts += [f"{name}.verdict.{limit}" for limit in limits]
    names_by_key: dict[str, Sequence[str]] = {
        "{body}": deforming,
        "{machine}": tuple(case.tracks),
        "{limited}": limited,
        "{judged}": verdicts,
    }
    for key, words in names_by_key.items():
        filled = []
        for figure in figures:
            filled += [figure.replace(key, word) for word in words] if key in figure else [figure]
        figures = filled
    return tuple(dict.fromkeys(figure for figure in figures if judged or not figure.startswith("comparisons.")))


def value_at(facts: Facts, keys: Keys) -> float:
    """Figure at `keys`, 1 or 0 for a truth, or NaN where this case has none."""
    try:
        node = node_at(facts, keys)
    except (KeyError, IndexError, TypeError):
        return math.nan
    return float(node) if _is_figure(node) else math.nan


def node_at(facts: Facts, keys: Keys) -> Any:
    """Entry at `keys` as it is, of any type; KeyError, IndexError or TypeError if there is none."""
    node: Any = facts
    return reduce(getitem, keys, node)


def declared_unit(facts: Facts, keys: Keys) -> str | None:
    """Unit of the figure at `keys`, empty where it has none, or None where no unit is declared for its place."""
    from gbeam.results.facts import unit_at

    return unit_at(facts, tree_of_figures(facts[KIND]), keys)


def unit_at(facts: Facts, keys: Keys) -> str:
    """SI unit of the figure at `keys`, or empty where it has none."""
    return declared_unit(facts, keys) or ""


def own_keys(keys: Keys) -> Keys:
    """Keys of a figure without the name of its motion, which could be any word."""
    return keys[:1] + keys[2:] if keys[0] in ("motions", "comparisons") else keys


def figures_in(node: Any, keys: Keys = ()) -> Iterator[tuple[Keys, float]]:
    """Keys and value of every number, truth value and missing value (None) in the facts."""
    if isinstance(node, Mapping):
        for key, value in node.items():
            yield from figures_in(value, (*keys, str(key)))
    elif isinstance(node, (list, tuple)):
        for index, value in enumerate(node):
            yield from figures_in(value, (*keys, index))
    elif _is_figure(node) or node is None:
        yield keys, node


def _is_figure(value: Any) -> bool:
    # A truth is a figure too: 1 where accepted.
    return isinstance(value, (int, float)) or (hasattr(value, "dtype") and getattr(value, "ndim", 1) == 0)


HISTORY = "--history"
TIMES = 501  # by default
_LOADS = {"root_force": "N", "root_moment": "N m"}
_OF_HUBS = {"hub.angle": "rad", "hub.rate": "rad/s"}


@dataclass(frozen=True)
class History:
    """One signal over time in the motion of that name, such as a point's or a beam's root load along an axis."""

    name: str
    motion: str
    quantity: str  # as the response's `signal` names it
    unit: str  # SI

    def interpolate(self, study: Study, times: Floats) -> Floats:
        """Values at times (t,), s, or NaN where the response has none."""
        response = study.responses.get(self.motion)
        if response is None:
            return np.full(len(times), math.nan)
        from scipy.interpolate import CubicSpline

        # Twenty steps to the shortest period: straight lines between them would be off by 1 % of a vibration.
        time, values = response.time, response.signal(self.quantity)
        slack = 1e-9 * float(time[-1] - time[0])
        is_inside = (times >= time[0] - slack) & (times <= time[-1] + slack)
        return np.where(is_inside, CubicSpline(time, values)(times), math.nan)


def read_history(text: str, case: Case, where: str = HISTORY, chosen: str | None = None) -> History:
    """Read a history of a case: a signal of its responses, such as ``flight.tip.z``.

    The motion's name may be left out if there is only one, or if it is the `chosen` one.
    """
    units, names = signals_of_case(case), list(case.environments)
    motion = next((name for name in names if text.startswith(f"{name}.") and text not in units), "")
    signal = text.removeprefix(f"{motion}.") if motion else text
    first, _, rest = text.partition(".")
    if signal not in units and rest in units:
        raise InputError(where, f"{text!r} names no motion", advise(first, names))
    if signal not in units:
        raise InputError(where, f"{text!r} is no history", advise(signal, units))
    motion = motion or chosen or (names[0] if len(names) == 1 else "")
    if not motion:
        raise InputError(where, f"{text!r} leaves the motion out", f"write {names[0]}.{text}")
    motion_object = case.environments[motion]
    if signal in _OF_HUBS and HUB not in case.system.joints and (motion_object is None or motion_object.kind != HUB):
        raise InputError(where, f"has {text!r}, and {motion} is no hub", "leave it out")
    return History(text, motion, signal, units[signal])


def signals_of_case(case: Case) -> dict[str, str]:
    """SI units, by name, of the signals that responses to a case have.

    If a single body deforms, its signals are also there without its name.
    """
    from gbeam.mechanics.tree.signals import signals_of

    owners, units = case.system.flexible, dict[str, str]()
    for name, body in owners.items():
        units |= {f"{name}.{point}.{axis}": "m" for point in stations_of(body) for axis in "xyz"}
        units |= {f"{name}.{load}.{axis}": unit for load, unit in _LOADS.items() for axis in "xyz"}
    units |= signals_of(case.system)
    short_names = {}
    if len(owners) == 1:
        prefix = f"{next(iter(owners))}."
        short_names = {signal.removeprefix(prefix): unit for signal, unit in units.items() if signal.startswith(prefix)}
    return short_names | units | _OF_HUBS
