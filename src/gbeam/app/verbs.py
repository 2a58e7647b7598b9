"""What the page can do with a scenario: verbs of the command line, and of their options those that name no file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from gbeam.errors import InputError
from gbeam.printable import unprintable
from gbeam.scenario.values.distributions import find_distributions
from gbeam.scenario.values.paths import parse_path, written_at

PLAIN = 'give text such as "2 s" or "tip.z.max_abs"'


@dataclass(frozen=True)
class Option:
    """An option of a verb.

    Parameters
    ----------
    name : str
        As the command line has it.
    help : str
    example : str
    choices : tuple of str
        What it may be; empty for any text.
    many : int
        How often it may be given.
    of : str
        What it names: a ``motion``, a ``record`` that is kept, or, before "=", a value of the scenario that varies,
        ``values``.
    ticked : str
        What the command line has where it is chosen, of an option that has no value to give.
    """

    name: str
    help: str
    example: str = ""
    choices: tuple[str, ...] = ()
    many: int = 1
    of: str = ""
    ticked: str = ""


@dataclass(frozen=True)
class Verb:
    """A verb: what it answers, its options, and whether it writes a report; the others answer in words."""

    about: str
    options: tuple[Option, ...] = ()
    report: bool = True


_MOTION = Option("motion", "which motion; may be left out where only one can answer", of="motion")
_AT = Option("at", "time at which the motion is frozen; the start where left out", "2 s")
_MEASURE = Option("measure", "figures of the result", "tip.size.max_abs")
_BOUNDS = Option("bounds", "of a value", "beam.damping_ratio=0.1 %:5 %", many=2)
_STARTS = Option("starts", "searches: one from the scenario's values, the others spread over the bounds", "5")
_WRITE = Option("write", "make a scenario with the values found", ticked="--write=found.toml")
_LIMITS = Option("ignore-limits", "done though a machine's limit is exceeded", ticked="--ignore-limits")
_WHOSE = Option(
    "verb", "whose figures; of run where left out", choices=("run", "static", "modes", "critical-speed", "plan")
)
VERBS = {
    "run": Verb("the response in every motion, and how they compare", (_LIMITS,)),
    "modes": Verb(
        "frequencies, damping and shapes at one time of a motion",
        (_MOTION, _AT, Option("no-gyroscopic", "leave out Coriolis coupling", ticked="--no-gyroscopic")),
    ),
    "static": Verb("where the beam rests at one time of the motions", (_MOTION, _AT)),
    "campbell": Verb(
        "frequencies against the speed of a hub",
        (
            _MOTION,
            Option("from", "least speed", "0 rpm"),
            Option("to", "largest speed", "60 rpm"),
            Option("modes", "how many to follow", "8"),
            Option("orders", "multiples of the speed, 1 to this", "4"),
        ),
    ),
    "critical-speed": Verb(
        "the hub rate, load or acceleration at which the equilibrium is lost",
        (
            _MOTION,
            Option("vary", "what is raised", choices=("rate", "loads", "acceleration")),
            _AT,
            Option("to", "end of the search", "20 rad/s"),
            Option("masses", "a map instead, with one more mass", "0.1 kg, 0.5 kg"),
            Option("positions", "where that mass sits; all along where left out", "2 m, 5 m, 8 m"),
        ),
    ),
    "plan": Verb(
        "the machine's axis motions, without a beam",
        (Option("sample", "sample time of the commands", "5 ms"), _LIMITS),
    ),
    "place": Verb(
        "the control point, mounting and smoothing that change the response least",
        (
            Option("measure", "root-shear, root-moment, vibration or tip, or a weighted sum", "tip=1, root-moment=0.5"),
            _MOTION,
            Option("smoothing", "width of the kernel to keep; twice, the ends of the search", "60 ms", many=2),
            Option("no-proof", "without a check by simulation", ticked="--no-proof"),
            _LIMITS,
            Option("write", "make the scenario with the answer", ticked="--write"),
        ),
    ),
    "sweep": Verb(
        "figures of many cases",
        (
            Option("over", "what varies: values or a range", "beam.length=250 mm:350 mm:5", many=2, of="values"),
            _MEASURE,
            Option("verb", _WHOSE.help, choices=(*_WHOSE.choices, "place")),
            _MOTION,
            _AT,
            Option("samples", "how many are drawn from distributions", "64"),
            Option("sampler", "how they are drawn", choices=("sobol", "latin", "random", "saltelli")),
            Option("seed", "the same draws the same samples", "1"),
            Option("workers", "processes", "2"),
            Option("history", "of a motion, a quantity and an axis", "flight.tip.z"),
            Option("netcdf", "sweep.nc, to download", ticked="--netcdf"),
        ),
    ),
    "sensitivity": Verb(
        "which values a figure depends on, and how much",
        (
            Option("of", "figures", "tip.z.max_abs"),
            Option("with", "only these values", "beam.length, beam.damping_ratio"),
            _WHOSE,
            _MOTION,
            _AT,
        ),
    ),
    "optimize": Verb(
        "the values at which a figure is least",
        (
            Option("minimise", "the figure", "tip.y.residual_amplitude"),
            Option("over", "values to choose", "motion.centrifuge.control_point"),
            Option("subject-to", '"limits", or a bound on a figure', "tip.z.max_abs <= 2 mm", many=2),
            _BOUNDS,
            _WHOSE,
            _MOTION,
            _AT,
            _STARTS,
            _WRITE,
        ),
    ),
    "fit": Verb(
        "the values of the scenario that a measurement shows",
        (
            Option("data", "a file that was dropped on the page, with measured columns", "measured.csv", of="record"),
            Option("free", "values to find", "beam.damping_ratio, beam.material.youngs_modulus"),
            _BOUNDS,
            _MOTION,
            _AT,
            _STARTS,
            _WRITE,
        ),
    ),
    "shape": Verb(
        "the rate or torque of a hub that leaves the least vibration, and the scenario with it",
        (
            Option("angle", "to turn by from rest to rest; or rate", "1 rad"),
            Option("rate", "to reach from rest; or angle", "3 rad/s"),
            Option("duration", "of the command; the scenario's own where left out", "6 s"),
            Option("limit", "on the torque, or on the angular acceleration of a hub without one", "45 N m"),
            Option("robust", "share by which all frequencies may be wrong", "20 %"),
            Option("check", "model that the commands are run on", choices=("TLAM", "FOAM", "SFOAM", "CFOAM", "exact")),
            _MOTION,
        ),
    ),
    "models": Verb("the same by every model, compared with the exact one", report=False),
    "linearize": Verb(
        "a state-space model at one time of a motion",
        (
            _MOTION,
            _AT,
            Option("rate", "a hub's steady rate in place of a time", "2 rad/s"),
            Option("modes", "keep so many of the slowest modes", "4"),
            Option("balanced", "keep so many states by balanced truncation", "6"),
            Option("inputs", "only these", "torque"),
            Option("outputs", "only these", "tip_y, hub_angle"),
            Option("strain-at", "strain of the faces at a station", "10 mm", many=2),
        ),
        report=False,
    ),
}


def offered() -> dict[str, Any]:
    """The verbs and their options, for the page."""
    return {name: asdict(verb) for name, verb in VERBS.items()}


def arguments(verb: str, options: Sequence[str], data: Mapping[str, Any]) -> list[str]:
    """Return a verb's arguments, each of which stands for itself alone.

    Parameters
    ----------
    verb : str
    options : sequence of str
        ``NAME=VALUE`` each, NAME alone of what is ticked.
    data : mapping
        The parsed scenario.

    Raises
    ------
    InputError
        If the verb is none of the page's, or an option none of its; if a sweep varies what is no value of the scenario,
        or the name of a file, which would lead out of the folder.
    """
    known = VERBS.get(verb)
    if known is None:
        raise InputError("verb", f"is {verb[:100]!r}", f"choose of {', '.join(VERBS)}")
    by_name = {option.name: option for option in known.options}
    made: list[str] = []
    counts: dict[str, int] = {}
    for each in options:
        name, _, value = each.partition("=")
        option = by_name.get(name)
        if option is None:
            raise InputError(name[:100] or "option", f"is no option of {verb} here", f"give {', '.join(by_name)}")
        counts[name] = counts.get(name, 0) + 1
        if counts[name] > option.many:
            raise InputError(name, f"is given {counts[name]} times", f"give it {option.many} times at most")
        if option.ticked:
            if value:
                raise InputError(name, f"is {value[:100]!r}", "give it without a value")
            made.append(option.ticked)
            continue
        if not value.strip() or value.startswith("--") or unprintable(value):
            raise InputError(name, "holds nothing that can be read", PLAIN)
        if option.choices and value not in option.choices:
            raise InputError(name, f"is {value[:100]!r}", f"choose of {', '.join(option.choices)}")
        if option.of == "values":
            path, _, values = value.partition("=")
            if not values.strip():
                raise InputError(name, f"has no values of {path[:100]}", f"write it such as {option.example}")
            _refuse_file(path.strip(), data)
        made.append(f"--{name}={value}")
    if verb == "sweep":
        table = data.get("sweep")
        over = table.get("over") if isinstance(table, dict) else None
        inside = over if isinstance(over, dict) else {}
        for path in inside:
            _refuse_file(path, data)
        if not inside and "over" not in counts and not any(find_distributions(data)):
            raise InputError("over", "is missing", "say what varies over which values")
    return made


def records(verb: str, options: Sequence[str]) -> list[str]:
    """The names of files among a verb's options."""
    named = {option.name for option in VERBS[verb].options if option.of == "record"}
    return [value for name, _, value in (each.partition("=") for each in options) if name in named]


def _refuse_file(path: str, data: Mapping[str, Any]) -> None:
    place = parse_path(path)
    written = None if place is None or place[-1] == "file" else written_at(data, place)
    if written is None or isinstance(written, (dict, list)):
        raise InputError(path[:100] or "over", "cannot be varied", "choose a number or a word of the scenario")
