"""The questions that a case answers, each declared once: its function, what it needs, which record it gives.

Sweeps, sensitivities and optimisation take their figures from these answers, by the names in this list; so do the
command line, the app and the schema of scenarios. To add one, decorate its function, and name it in
:data:`gbeam.constants.Verb`, its options in :data:`Options`. Nothing heavy is imported here.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypedDict, get_args, get_origin, get_type_hints

from gbeam.constants import Verb
from gbeam.errors import InputError
from gbeam.printable import advise

if TYPE_CHECKING:
    from gbeam.analysis.case import Case
    from gbeam.mechanics.tree.system import System
    from gbeam.results.comparison import MachinePlan
    from gbeam.results.equilibrium import Critical, EquilibriumPath, Rest
    from gbeam.results.modal import Campbell, Modes
    from gbeam.results.placement import Placement
    from gbeam.results.study import Study

Varied = Literal["rate", "loads", "acceleration"]
Grown = Literal["loads", "motion"]
# Options of all questions by name, as studies take them; quantities are numbers in SI, or texts.
Options = TypedDict(
    "Options",
    {
        "gyroscopic": bool,
        "vary": Varied | Grown,
        "turning": str | None,
        "from": float | str | None,
        "to": float | str | None,
        "modes": int,
        "orders": int,
    },
    total=False,
)
HUB, CENTRIFUGE = "hub", "centrifuge"
STATIONS = 81  # along the beam, at which shapes are given


@dataclass(frozen=True)
class Needs:
    """Parts of an answer that will be read; costly parts that will not be read need not be computed."""

    errors: bool = True  # estimates of errors, which take most of the time of a steady state
    loads: bool = True  # of the sections
    shapes: bool = False  # shapes all along the beam, not only at the case's own stations


@dataclass(frozen=True)
class Option:
    """An option of a question: an argument of its function, with the words of its help."""

    argument: str
    type: Any
    default: Any
    words: str
    kind: str | Callable[[Mapping[str, Any]], str] = ""  # of a quantity, or a function of all options that gives it

    @property
    def flag(self) -> str:
        """Name on the command line."""
        return f"--{self.argument.rstrip('_').replace('_', '-')}"

    def read(self, value: Any, options: Mapping[str, Any]) -> Any:
        """Return the value for the function, of a quantity in SI; InputError if it is no choice or not of the kind."""
        types = (self.type, *get_args(self.type))
        choices = next((get_args(kind) for kind in types if get_origin(kind) is Literal), ())
        if choices and value not in choices:
            raise InputError(self.flag, f"is {value!r}", advise(str(value), choices))
        if not (self.kind and isinstance(value, str)):
            return value
        from gbeam.guards.units import read_quantity

        return read_quantity(self.flag, value, self.kind if isinstance(self.kind, str) else self.kind(options))


@dataclass(frozen=True)
class Question:
    """A question that a case answers."""

    name: str  # the command line's verb
    about: str  # in one sentence
    # Function of a case, the name of a motion or None, the time at which it is frozen or None, needs, and options by
    # keyword; it returns a record, or a tuple of several.
    answer: Callable[..., Any]
    motion: str | None = ""  # kind of motion that it asks about, "" for any; None for all that can answer
    differentiable: bool = True  # true if its figures are smooth in the scenario's values
    deforms: bool = True  # true if it needs a specimen that deforms
    # Figures that studies take where none is named, for every {motion}, {body} that deforms, whose name is left out
    # where it is the only one, centrifuge ({machine}), centrifuge with limits of acceptance ({limited}), and figure
    # that its verdict is on ({judged}).
    usual: tuple[str, ...] = ()

    @property
    def options(self) -> dict[str, Option]:
        """Options by name: the keyword-only arguments of the function that are annotated with words."""
        keywords = [p for p in inspect.signature(self.answer).parameters.values() if p.kind is p.KEYWORD_ONLY]
        annotated = SimpleNamespace(__annotations__={p.name: p.annotation for p in keywords})
        hints = get_type_hints(annotated, self.answer.__globals__, include_extras=True)
        declared = [(p, get_args(hints[p.name])) for p in keywords if get_origin(hints[p.name]) is Annotated]
        options = [Option(p.name, hint, p.default, *words) for p, (hint, *words) in declared]
        return {option.flag[2:]: option for option in options}

    def chosen(self, options: Mapping[str, Any]) -> dict[str, Any]:
        """Return options by name as keywords for the function, checked and in SI; InputError if one is unknown."""
        declared = self.options
        for name in options:
            if name not in declared:
                problem = f"is no option of {self.name}"
                raise InputError(f"--{name}", problem, advise(name, declared) if declared else "leave it out")
        values = {name: option.default for name, option in declared.items()} | dict(options)
        return {declared[name].argument: declared[name].read(value, values) for name, value in options.items()}

    @property
    def records(self) -> tuple[type, ...]:
        """Classes of the records that it returns."""
        from gbeam.results.study import KINDS

        annotation = self.answer.__annotations__["return"]
        if isinstance(annotation, type):
            return (annotation,)
        names = (part.strip().removeprefix("tuple[").partition(",")[0] for part in annotation.split("|"))
        return tuple(self.answer.__globals__.get(name) or KINDS[name] for name in names)

    def refuse(self, case: Case) -> None:
        """Raise InputError if nothing of the case deforms, and the question is of what does."""
        if self.deforms:
            refuse_rigid(case, self.name)


def refuse_rigid(case: Case, verb: str) -> None:
    """Raise InputError if the only body is held and rigid, and so has no coordinates."""
    body = case.system.only_structure
    if body is not None and not body.size:
        fix = "ask for run, which has the load at its corners, or plan; or give it as a solid"
        raise InputError(f"bodies.{case.system.order[0]}", f"is rigid, and {verb} is of what deforms", fix)


QUESTIONS: dict[str, Question] = {}
_Answer = Callable[..., Any]


def question(name: Verb, about: str, **more: Any) -> Callable[[_Answer], _Answer]:
    """Declare the question that a function answers: see :class:`Question`."""

    def declare(answer: _Answer) -> _Answer:
        QUESTIONS[name] = Question(name, about, answer, **more)
        return answer

    return declare


def question_of(verb: str) -> Question:
    """Return the question of a verb; InputError if there is none."""
    if verb not in QUESTIONS:
        raise InputError("--verb", f"is {verb!r}", advise(verb, QUESTIONS))
    return QUESTIONS[verb]


def differentiable() -> tuple[str, ...]:
    """Names of the questions whose figures have derivatives."""
    return tuple(name for name, question in QUESTIONS.items() if question.differentiable)


def motion_of(motions: Mapping[str, Any], name: str | None, kind: str = "") -> str:
    """Return `name` if it is a motion; for None the name of the only motion, or of the only one of a kind."""
    if name is not None:
        if name not in motions:
            raise InputError("--motion", f"is {name!r}", f"the scenario has {', '.join(motions)}")
        return name
    fitting = [candidate for candidate, motion in motions.items() if motion is not None and motion.kind == kind]
    choice = fitting or list(motions)
    if not choice:
        kind_words = f' with kind = "{kind}"' if kind else ""
        raise InputError("motion", "is missing", f"add [motion.NAME]{kind_words}; `gbeam new` shows how")
    if len(choice) > 1 and (fitting or not kind):
        raise InputError("--motion", "is missing", f"name one of {', '.join(choice)}")
    return choice[0]  # if it is of another kind, the question refuses it with a reason


def prepared(case: Case, name: str) -> Any:
    """Return a motion prepared for the response's times, or None for ground at rest."""
    motion = case.environments[name]
    if motion is None or case.response is None:
        return motion
    settings = case.settings_of(name)
    return motion.over(settings.start, settings.start + settings.duration)


def reduced(case: Case, needs: Needs) -> Case:
    """Return the case with settings by which only what is needed is computed, with the same digits. A case with
    automatic numbers of shapes, which follow from the errors, is returned as it is.
    """
    if needs.errors or case.automatic:
        return case
    compared = case.system.only_structure is None and case.tracks  # whose comparisons read the loads of its beams
    loads = case.over_time.loads and bool(needs.loads or compared)
    return replace(case, response=replace(case.over_time, estimate=False, loads=loads))


def _subject(case: Case, needs: Needs) -> System:
    """Argument of the analyses; if no errors are needed, without what a steady state would judge them by."""
    if case.only_beam is None:
        return case.system
    if needs.shapes:
        length = case.beam.length
        case = case.remade(stations=[length * (i / (STATIONS - 1)) for i in range(STATIONS)])
    if needs.errors:
        return case.system
    bodies = {
        name: replace(body, source=None, richer=None, coarser=None) for name, body in case.system.flexible.items()
    }
    return replace(case.system, bodies=bodies)


def _time(case: Case, name: str, at: float | None) -> float:
    return case.start_of(name) if at is None else at


@question(
    "run",
    "Compute the response in every environment of a scenario, and compare them.",
    motion=None,
    deforms=False,
    usual=(
        "comparisons.{judged}",
        "motions.{motion}.bodies.{body}.tip.size.max_abs",
        "motions.{motion}.bodies.{body}.loads.root_moment.size.max_abs",
        "comparisons.{machine}.verdict.followed",
        "comparisons.{limited}.verdict.accepted",
    ),
)
def run(case: Case, motion: str | None = None, at: float | None = None, needs: Needs = Needs()) -> Study:
    """Responses in all motions."""
    from gbeam.analysis.environments import study

    return study(reduced(case, needs))


@question(
    "static",
    "Where the beam rests relative to its base at one time of the motions, or the system in its joints.",
    motion=None,
    deforms=False,
)
def static(case: Case, motion: str | None = None, at: float | None = None, needs: Needs = Needs()) -> tuple[Rest, ...]:
    """Rest in all motions, or one."""
    from gbeam.analysis.automatic import sufficient
    from gbeam.analysis.steady.static import static

    needs = replace(needs, errors=needs.errors or case.automatic)
    if all(body.history is None for body in case.system.flexible.values()):  # else the loads of a beam bend it
        case.require_motion()
    names = list(case.environments) if motion is None else [motion_of(case.environments, motion)]
    bases = {name: prepared(case, name) for name in names}

    def rests_of(case: Case) -> tuple[Rest, ...]:
        structure = _subject(case, needs)
        return tuple(static(structure, base, _time(case, name, at), name=name) for name, base in bases.items())

    _, rests = sufficient(case, rests_of, lambda rests: [rest.errors for rest in rests])
    return rests


@question(
    "modes",
    "Frequencies, damping and shapes about the equilibrium at one time of a motion.",
    usual=("modes[0].frequency",),
)
def modes(
    case: Case,
    motion: str | None = None,
    at: float | None = None,
    needs: Needs = Needs(),
    *,
    gyroscopic: Annotated[bool, "Keep Coriolis coupling."] = True,
) -> Modes:
    """Small vibrations about the equilibrium."""
    from gbeam.analysis.automatic import lowest_errors, sufficient
    from gbeam.analysis.steady import modal

    name = motion_of(case.environments, motion)
    time = _time(case, name, at)
    errors = needs.errors or case.automatic
    options: dict[str, Any] = {"gyroscopic": gyroscopic, "errors": errors, "name": name}
    base = prepared(case, name)

    def ask(case: Case) -> Any:
        structure = _subject(case, replace(needs, errors=True))  # the source has the sections: twist shows at edges
        return modal.modes(structure, base, time, **options)

    return sufficient(case, ask, lambda modes: [lowest_errors(modes.frequency, modes.errors)])[1]


_TURNING = "Of a system, the angle that turns, base.angle; else its only prescribed one, or only one."
_SPEED = 'Such as "60 rpm"; by default from rest to the largest rate of the motion.'
# Kind of quantity of each value that is raised.
_VARIED: dict[Varied, str] = {"rate": "angular rate", "loads": "ratio", "acceleration": "acceleration"}


def _kind_varied(options: Mapping[str, Any]) -> str:
    return _VARIED[options["vary"]]


@question(
    "critical-speed",
    "The rate, load or acceleration at which the equilibrium of a beam or a system is lost.",
    motion=HUB,
)
def critical_speed(
    case: Case,
    motion: str | None = None,
    at: float | None = None,
    needs: Needs = Needs(),
    *,
    vary: Annotated[
        Varied,
        "What is raised: the rate of the hub or joint; all loads on beams and points, by one factor, the base being "
        "frozen; or the acceleration of the root along the beam, which pushes it.",
    ] = "rate",
    turning: Annotated[str | None, _TURNING] = None,
    to: Annotated[
        float | None, 'End of search, such as "20 rad/s"; by default ten times what the beam resists.', _kind_varied
    ] = None,
    progress: Callable[[str, float], None] | None = None,
) -> Critical:
    """Lowest rate, factor of the loads, or acceleration of the root, up to `to`, at which the equilibrium is lost."""
    from gbeam.analysis.automatic import sufficient
    from gbeam.analysis.steady import stability

    if to is not None and not to > 0:
        raise InputError("to", f"is {to:g}", "give a value above zero, where the search ends")
    name = motion_of(case.environments, motion, HUB)
    time = _time(case, name, at)
    base, needs = prepared(case, name), replace(needs, errors=needs.errors or case.automatic)
    options: dict[str, Any] = {"time": time, "upper": to, "progress": progress}

    def ask(case: Case) -> Critical:
        structure = _subject(case, needs)
        if vary == "acceleration":
            return stability.buckling_acceleration(structure, **options)
        moved = options | {"motion": base}
        if vary == "loads":
            return stability.critical_load(structure, **moved)
        return replace(stability.critical_speed(structure, turning=turning, name=name, **moved), motion=name)

    return sufficient(case, ask, lambda critical: [critical.errors])[1]


@question(
    "path",
    "Where a beam or a system rests as its loads or its motion grow, also where they have to fall: snap-through.",
    differentiable=False,
    usual=("critical[0].factor",),
)
def path(
    case: Case,
    motion: str | None = None,
    at: float | None = None,
    needs: Needs = Needs(),
    *,
    vary: Annotated[Grown, "What grows: all loads, or the motion as it is at one time, by one factor."] = "loads",
    to: Annotated[float, "Factor at which the path ends; 1 for what is varied as it is.", "ratio"] = 1.0,
    progress: Callable[[str, float], None] | None = None,
) -> EquilibriumPath:
    """Equilibria under what is varied times a factor from none to `to`, by arc length beyond limit points."""
    from gbeam.analysis.automatic import sufficient
    from gbeam.analysis.steady.equilibrium_path import equilibrium_path

    if not to > 0:
        raise InputError("to", f"is {to:g}", "give a value above zero, where the path ends")
    name = motion_of(case.environments, motion)
    base, time, errors = prepared(case, name), _time(case, name, at), needs.errors or case.automatic

    def ask(case: Case) -> EquilibriumPath:
        structure = _subject(case, replace(needs, errors=errors))
        options: dict[str, Any] = {"vary": vary, "upper": to, "errors": errors, "name": name}
        return equilibrium_path(structure, base, time, **options, progress=progress)

    return sufficient(case, ask, lambda path: [path.errors, *(point.errors for point in path.critical)])[1]


@question("plan", "Plan the axis motions of a centrifuge within its limits; needs no beam.", motion=None, deforms=False)
def plan(
    case: Case, motion: str | None = None, at: float | None = None, needs: Needs = Needs()
) -> tuple[MachinePlan, ...]:
    """Plans of all centrifuges, or one."""
    from gbeam.analysis.imitation.plan import plan
    from gbeam.results.criteria import judging

    named = None if motion is None else motion_of(case.motions, motion)
    machines = [name for name, m in case.motions.items() if m.kind == CENTRIFUGE and named in (None, name)]
    if not machines:
        raise InputError("motion", "has no centrifuge to plan", "add a motion of kind centrifuge")
    limits = {name: judging(case.accept.get(name, {}), response=False) for name in machines}
    return tuple(
        plan(name, prepared(case, name), case.tracks[name], specimen=case.system, **limits[name]) for name in machines
    )


@question(
    "place",
    "Find where to put the specimen on the centrifuge.",
    motion=CENTRIFUGE,
    differentiable=False,
    deforms=False,
)
def place(case: Case, motion: str | None = None, at: float | None = None, needs: Needs = Needs()) -> Placement:
    """Best placement, without the check by simulation, which takes longer: ``run`` at the placement is that check."""
    from gbeam.analysis.imitation.place import default_turns, default_weights, place
    from gbeam.analysis.imitation.place_measures import choice_of

    name, current = machine_of(case, motion)
    system, names = case.system, (case.tracks[name], name)
    choice, settings = choice_of(current, turns=default_turns(system)), case.settings_of(name)
    return place(system, current.flight, choice, settings, default_weights(system), current=current, names=names)


@question(
    "campbell",
    "Frequencies against the speed of a hub, or of a joint that turns, and where its multiples meet them.",
    motion=HUB,
    differentiable=False,
)
def campbell(
    case: Case,
    motion: str | None = None,
    at: float | None = None,
    needs: Needs = Needs(),
    *,
    turning: Annotated[str | None, _TURNING] = None,
    from_: Annotated[float | None, _SPEED, "angular rate"] = None,
    to: Annotated[float | None, _SPEED, "angular rate"] = None,
    modes: Annotated[int, "How many to follow."] = 8,
    orders: Annotated[int, "Multiples of the speed, 1 to this."] = 4,
    progress: Callable[[str, float], None] | None = None,
) -> Campbell:
    """Frequencies from one rate of a hub or a joint to another, rad/s, and crossings with multiples of the rate."""
    from gbeam.analysis.automatic import sufficient
    from gbeam.analysis.steady import campbell

    if orders < 0:
        raise InputError("orders", f"is {orders}", "give 0 or more")
    name = motion_of(case.environments, motion, HUB)
    base = prepared(case, name)
    if to is None and getattr(base, "free", False):
        raise InputError("to", "is missing: the hub is driven by a torque", 'give the largest speed, such as "5 rad/s"')
    options: dict[str, Any] = {"turning": turning, "start": from_ or 0.0, "end": to, "modes": modes}
    options |= {"orders": range(1, orders + 1), "time": _time(case, name, at), "name": name, "progress": progress}

    def ask(case: Case) -> Campbell:
        return campbell.campbell(case.system, base, **options)

    return sufficient(case, ask, lambda diagram: [diagram.errors])[1]


def machine_of(case: Case, motion: str | None) -> tuple[str, Any]:
    """Return name and prepared motion of the centrifuge chosen by `motion`; InputError if that is none."""
    from gbeam.motion.centrifuge.centrifuge import Centrifuge

    name = motion_of(case.motions, motion, CENTRIFUGE)
    current = prepared(case, name)
    if not isinstance(current, Centrifuge):
        fix = "add one that tracks the flight; `gbeam new` shows how"
        raise InputError(f"motion.{name}", "is no centrifuge to put a specimen on", fix)
    return name, current
