"""The table of questions by kinds of specimen, made by asking all of them.

``python -m tests.questions.table > docs/questions.md`` writes its page; with names of questions behind it, it prints
their cells and the seconds that each takes.
"""

from __future__ import annotations

import re
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

import gbeam as gb
from gbeam.questions import QUESTIONS
from gbeam.report import report_of, viewer_data
from tests.questions.specimens import FLIGHT, KINDS, MACHINE, Kind, write

HEAD = """\
# Which question for which specimen?

Every question is asked of one small specimen of every kind, and the table says what came of it: an answer, **yes**, or
a number, which stands for the reason below; that is what the command or the function says itself. The robot's arm and
the satellite have several bodies, a strip or a panel among them; the others stand alone on a base that flies, is spun
or turns, and have a hinge where a controller acts on them.

"""
TAIL = """
This page is written by `python -m tests.questions.table`, which asks; a test compares the two.
"""


@dataclass(frozen=True)
class Cell:
    """Answer to a question about a kind of specimen: `reason` is the message where there is none."""

    reason: str = ""


class Scenario:
    """A specimen in a folder, with the cases that questions ask about."""

    def __init__(self, kind: Kind, folder: Path) -> None:
        self.kind, self.folder = kind, folder
        self.cases: dict[str, gb.Case] = {}

    def file(self, text: str) -> Path:
        """File of a scenario with this text."""
        path = self.folder / "scenario.toml"
        path.write_text(text, encoding="utf-8")
        return path

    def case(self, text: str) -> Any:
        """Case of a scenario with this text; those that are asked for again are kept."""
        if text not in self.cases:
            self.cases[text] = gb.read_scenario(self.file(text))
        return self.cases[text]

    @property
    def alone(self) -> Any:
        """Case in a flight, or of what nothing holds at rest."""
        return self.case(self.kind.alone())


Ask = Callable[[Scenario], Any]
ASKED: dict[str, Ask] = {}


def asked(name: str) -> Callable[[Ask], Ask]:
    """Enter a question under its name."""

    def enter(ask: Ask) -> Ask:
        ASKED[name] = ask
        return ask

    return enter


def answer(case: Any, verb: str, **options: Any) -> Any:
    """Answer of a verb to a case, as the command line asks for it; all of it is finite and done."""
    question = QUESTIONS[verb]
    question.refuse(case)
    answers = question.answer(case, **options)
    for each in answers if isinstance(answers, tuple) else (answers,):
        assert getattr(each, "outcome", "done") == "done", each.outcome
    return answers


def response_of(case: Any) -> Any:
    """First response of a case."""
    return next(iter(gb.study(case).responses.values()))


@asked("simulate")
def _simulate(scenario: Scenario) -> Any:
    study = gb.study(scenario.alone)
    assert study.outcome == "done"
    return study


@asked("static")
def _static(scenario: Scenario) -> Any:
    return answer(scenario.alone, "static")


@asked("modes")
def _modes(scenario: Scenario) -> Any:
    modes = answer(scenario.alone, "modes")
    assert modes.frequency[0] > 0
    return modes


@asked("campbell")
def _campbell(scenario: Scenario) -> Any:
    return answer(scenario.case(scenario.kind.turned()), "campbell", to=1.0, modes=1, orders=1)


@asked("critical-speed")
def _critical_speed(scenario: Scenario) -> Any:
    return answer(scenario.case(scenario.kind.turned()), "critical-speed", to=1.0)


@asked("path")
def _path(scenario: Scenario) -> Any:
    case = scenario.alone
    return answer(case, "path", vary="motion" if case.motions else "loads")


@asked("linearize")
def _linearize(scenario: Scenario) -> Any:
    case = scenario.alone
    motion = next(iter(case.motions.values()), None)
    model = gb.linearize(case.subject, motion)
    assert np.isfinite(model.a).all() and len(model.a)
    return model


def machine_of(scenario: Scenario) -> Any:
    """Case of a specimen in a flight and on the machine that imitates it."""
    return scenario.case(scenario.kind.moved(FLIGHT, MACHINE))


@asked("compare")
def _compare(scenario: Scenario) -> Any:
    study = gb.study(machine_of(scenario))
    assert study.outcome == "done" and study.comparisons
    return study.comparisons


@asked("plan")
def _plan(scenario: Scenario) -> Any:
    return answer(machine_of(scenario), "plan")


@asked("place")
def _place(scenario: Scenario) -> Any:
    return answer(machine_of(scenario), "place")


@asked("shape")
def _shape(scenario: Scenario) -> Any:
    goal: dict[str, Any] = {} if scenario.kind.held else {"joint": "orbit.z", "distance": 0.01}
    return gb.shape_hub_command(scenario.file(scenario.kind.turned()), duration=0.05, **goal)


@asked("sweep")
def _sweep(scenario: Scenario) -> Any:
    value = scenario.kind.value
    template = scenario.file(scenario.kind.alone().replace('step = "2 ms"\n', ""))  # else JAX compiles a batch
    low, high = (repr(share * _value(template, value)) for share in (1.0, 1.1))
    swept = gb.sweep(template, [f"{value}={low}, {high}"], [scenario.kind.figure])
    assert np.isfinite(swept.measures[scenario.kind.figure]).all(), swept.message
    return swept


def _value(template: Path, path: str) -> float:
    from gbeam.studies import select_values, template_of

    (parameter,) = select_values(template_of(template), [path], "--with")
    return parameter.value


@asked("sensitivity")
def _sensitivity(scenario: Scenario) -> Any:
    kind = scenario.kind
    return gb.sensitivity(scenario.file(kind.alone()), [kind.figure], [kind.value])


@asked("fit")
def _fit(scenario: Scenario) -> Any:
    kind = scenario.kind
    study = gb.study(scenario.alone)
    response = next(iter(study.responses.values()))
    data = scenario.folder / "measured.csv"
    rows = np.stack([response.time, response.signal(kind.measured)], axis=1)[::4]
    np.savetxt(data, rows, delimiter=",", header=f"time,{kind.measured}", comments="")
    return gb.fit(scenario.file(kind.alone()), data, [kind.value])


@asked("optimize")
def _optimize(scenario: Scenario) -> Any:
    kind = scenario.kind
    value = _value(file := scenario.file(kind.alone()), kind.value)
    return gb.optimise(file, kind.figure, [kind.value], bounds={kind.value: (0.99 * value, 1.01 * value)})


@asked("models")
def _models(scenario: Scenario) -> Any:
    study = gb.compare_models(scenario.alone, ["FOAM"])
    assert study.compared
    return study


@asked("simulate_batch")
def _simulate_batch(scenario: Scenario) -> Any:
    case = scenario.alone
    pairs = [(case.subject, motion) for motion in (*case.environments.values(), *case.environments.values())]
    answers = list(gb.simulate_batch(pairs, case.over_time))
    assert len(answers) == 2 and all(response.outcome == "done" for _, response in answers)
    return answers


@asked("gradients")
def _gradients(scenario: Scenario) -> Any:
    import jax

    case = scenario.alone
    settings = replace(case.over_time, duration=0.004)

    def moved(level: Any) -> Any:
        flight = gb.Flight(z=gb.SmoothStep(level, 0.002))
        response = gb.simulate(case.subject, flight, settings)
        return (response.tip if case.system.only_structure is not None else response.place[:, 0]).sum()

    # Followed, not compiled, which takes ten seconds each: tests of gradients have the numbers.
    with jax.enable_x64(True):
        return jax.eval_shape(jax.grad(moved), 10.0)


@asked("controllers")
def _controllers(scenario: Scenario) -> Any:
    response = response_of(scenario.case(scenario.kind.controlled()))
    assert response.outcome == "done" and response.loop is not None
    return response


@asked("automatic numbers of shapes")
def _automatic(scenario: Scenario) -> Any:
    kind = scenario.kind
    text = kind.alone().replace("estimate = false", 'tolerance = "20 %"')
    for said in ((f", {kind.modes}", ""), (kind.modes, "")) if kind.modes else ():
        text = text.replace(*said)
    return gb.study(scenario.case(text))


@asked("initial states")
def _initial(scenario: Scenario) -> Any:
    start = gb.Initial(tip_displacement={"z": 1e-4})
    case = scenario.alone
    motion = next(iter(case.motions.values()), None)
    response = gb.simulate(case.subject, motion, replace(case.over_time, initial=start))
    assert response.outcome == "done"
    return response


@asked("stations and named points")
def _stations(scenario: Scenario) -> Any:
    kind = scenario.kind
    text = kind.alone()
    if any(body.sections is not None for body in scenario.alone.system.flexible.values()):
        text = text.replace('kind = "beam"\n', 'kind = "beam"\nstations = ["50 mm"]\n')
    response = response_of(scenario.case(text))
    response.point("point", kind.point)
    return response


@asked("sensors")
def _sensors(scenario: Scenario) -> Any:
    point = scenario.kind.point
    text = scenario.kind.alone() + f'[sensors."{point}"]\nturn = ["90 deg", 0, 0]\n'
    response = response_of(scenario.case(text))
    assert response.readings is not None
    return response


@asked("loads of the root and the sections")
def _loads(scenario: Scenario) -> Any:
    response = response_of(scenario.alone)
    loads = (response.bodies[scenario.kind.last] if scenario.kind.joints else response.body).loads
    assert np.isfinite(loads.root_force).all() and np.abs(loads.root_force).max() > 0
    return loads


@asked("stress")
def _stress(scenario: Scenario) -> Any:
    """As a limit of acceptance on it, which is refused where there is none; of the satellite, what its panel bears."""
    kind = scenario.kind
    if not kind.held:
        return response_of(scenario.alone).bodies[kind.last].loads.stress
    text = kind.moved(FLIGHT, MACHINE + '[motion.machine.accept]\nstress = "50 %"\n')
    (comparison,) = gb.study(scenario.case(text)).comparisons
    assert comparison.decision
    return comparison


@asked("viewer")
def _viewer(scenario: Scenario) -> Any:
    return viewer_data(gb.study(scenario.alone))


@asked("report")
def _report(scenario: Scenario) -> Any:
    return report_of(gb.study(scenario.alone))


_PLACE = re.compile(r"^\S*scenario\.toml(:\d+)*: ")


def cell(ask: Ask, scenario: Scenario) -> Cell:
    """Ask a question of a specimen."""
    try:
        ask(scenario)
    except gb.GbeamError as error:
        return Cell(_PLACE.sub("", str(error).splitlines()[0]))
    except Exception as error:  # a defect, which the table shows
        return Cell(f"{type(error).__name__}: {error}".splitlines()[0])
    return Cell()


@contextmanager
def scenarios() -> Iterator[dict[str, Scenario]]:
    """The specimens by the names of their kinds, with their files in a folder."""
    with tempfile.TemporaryDirectory() as folder:
        write(Path(folder))
        yield {kind.name: Scenario(kind, Path(folder)) for kind in KINDS}


Table = dict[str, dict[str, Cell]]


def asked_all() -> Table:
    """All cells, by question, then kind of specimen."""
    with scenarios() as by_kind:
        return {name: {kind: cell(ask, each) for kind, each in by_kind.items()} for name, ask in ASKED.items()}


def page_of(table: Table) -> str:
    """The page of a table: reasons are numbered as they come, and alike ones share a number."""
    reasons: dict[str, int] = {}
    rows = []
    for question, cells in table.items():
        said = [
            f"[{reasons.setdefault(each.reason, len(reasons) + 1)}]" if each.reason else "yes"
            for each in cells.values()
        ]
        rows.append(f"| {question} | {' | '.join(said)} |\n")
    kinds = [kind.name for kind in KINDS]
    head = f"| | {' | '.join(kinds)} |\n|---|{'---|' * len(kinds)}\n"
    listed = "".join(f"{number}. {reason}\n" for reason, number in reasons.items())
    return f"{HEAD}{head}{''.join(rows)}\n{listed}{TAIL}"


def _timed(names: list[str]) -> None:
    """Print the cells of some questions, and the seconds that each takes."""
    with scenarios() as by_kind:
        for name in names:
            for kind, each in by_kind.items():
                start = time.process_time()
                reason = cell(ASKED[name], each).reason
                print(f"{name:28} {kind:15} {time.process_time() - start:5.2f} {reason or 'yes'}", flush=True)


if __name__ == "__main__":
    if sys.argv[1:]:
        _timed(sys.argv[1:])
    else:
        sys.stdout.write(page_of(asked_all()))
