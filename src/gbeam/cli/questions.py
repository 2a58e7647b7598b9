"""Verbs of questions, with their options. ``campbell``, ``critical-speed`` and ``linearize`` have more."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from gbeam.cli.failures import report_outcomes
from gbeam.cli.options import (
    At,
    Input,
    MotionName,
    Output,
    ScenarioFile,
    changed_options,
    number,
    numbers,
    option,
    read,
    with_options,
)
from gbeam.cli.outputs import deliver
from gbeam.cli.process import Watch
from gbeam.errors import InputError, naming
from gbeam.questions import QUESTIONS, Needs, Question

if TYPE_CHECKING:
    from gbeam.mechanics.tree.system import System
    from gbeam.results.state_space import Gauge

_STATUS = "Exit status: 0 done, 1 there is no answer or stability is not known, 2 the input is wrong."


def __getattr__(name: str) -> Callable[..., int]:
    """Make the function of a question's verb when it is imported by its name."""
    for question in QUESTIONS.values():
        if question.name.replace("-", "_") == name:
            return verb_of(question)
    raise AttributeError(name)


def verb_of(question: Question) -> Callable[..., int]:
    """Return the function of the verb that asks a question."""
    name = question.name.replace("-", "_")

    @with_options(question.name)
    def verb(
        scenario: ScenarioFile,
        /,
        *,
        motion: MotionName = None,
        at: At = None,
        options: Any = None,
        output: Output = Output(),
    ) -> int:
        folder = output.folder(scenario)
        loaded = read(question.name, scenario, output.overrides)
        chosen = motion  # None: all motions, unless the question needs one of a kind
        if question.motion is not None or motion is not None:
            chosen, _ = loaded.motion(motion, kind=question.motion or "")
        answer = loaded.answer(question, chosen, at, options, Needs(shapes=True))
        deliver(
            answer, name, folder, output, verb=question.name, origin=loaded.case.provenance,
            title=loaded.case.title, listed=False,
        )  # fmt: skip
        return report_outcomes(*(answer if isinstance(answer, tuple) else (answer,)))

    verb.__name__ = name
    several = "Without --motion for all of them. " if question.motion is None else ""
    files = f"With --out also writes {name}.json and plots, with --report {name}.html."
    verb.__doc__ = f"{question.about}\n\n{several}{files} {_STATUS}"
    return verb


@with_options("campbell")
def campbell(
    scenario: ScenarioFile,
    /,
    *,
    motion: MotionName = None,
    options: Any = None,
    output: Output = Output(),
) -> int:
    """Frequencies against the speed of a hub or a joint, in the unit of --to or --from, and where multiples meet them.

    Writes campbell.json, the diagram and with --report campbell.html into --out, by default out/ and the scenario's
    name; with --json only if --out or --report is given. Exit status: 0 done, 1 there is no equilibrium, 2 the input is
    wrong, such as a motion without a hub.
    """
    folder = output.folder(scenario, always=True)
    loaded = read("campbell", scenario, output.overrides)
    name, _ = loaded.motion(motion, kind="hub")
    diagram = loaded.answer(QUESTIONS["campbell"], name, None, options, Needs())

    from gbeam.figures import steady
    from gbeam.guards.units import unit_of

    # Words and diagram show speeds in the unit of --to or --from.
    unit, size = unit_of(
        changed_options(options).get("to") or changed_options(options).get("from", "0"), "angular rate"
    )
    figures = {"campbell": partial(steady.campbell, diagram, loaded.case.title, (1 / size, unit))}
    deliver(
        diagram, "campbell", folder, output, origin=loaded.case.provenance, figures=figures, speeds={unit: 1 / size},
    )  # fmt: skip
    return 0


@with_options("critical-speed")
def critical_speed(
    scenario: ScenarioFile,
    /,
    *,
    motion: MotionName = None,
    at: At = None,
    options: Any = None,
    masses: Annotated[str | None, Parameter(help='A map instead, with one more mass: "0.1 kg, 0.5 kg".')] = None,
    positions: Annotated[
        str | None, Parameter(help='Where that mass sits: "2 m, 5 m, 8 m"; by default all along.')
    ] = None,
    output: Output = Output(),
) -> int:
    """The rate, load or acceleration at which the equilibrium of a beam or a system is lost.

    Where there is none up to the end of the search, the value is null and the reason says so; that is an answer, with
    exit status 0. 1: a solid bends too far for a stiffness of first order, and it is not known. 2: the input is wrong,
    such as a motion without a hub. With --out writes critical_speed.json and a plot of the lowest frequencies on the
    way there, a map also as CSV; with --report also critical_speed.html.
    """
    folder = output.folder(scenario)
    loaded = read("critical-speed", scenario, output.overrides)
    question = QUESTIONS["critical-speed"]
    if masses is None and positions is not None:
        raise InputError("--positions", "stands without --masses", 'add --masses "0.1 kg, 0.5 kg"')
    if masses is not None:
        with naming("--masses"):
            loaded.case.require_beam()
        chosen = question.chosen(changed_options(options))
        if "vary" in chosen:
            raise InputError("--masses", f"stands beside --vary {chosen['vary']}", "a map is of hub rates")
        return critical_map(loaded, motion, masses, positions, chosen.get("to"), folder, output)
    name, _ = loaded.motion(motion, kind="hub")
    critical = loaded.answer(question, name, at, options, Needs())

    from gbeam.figures import steady

    deliver(
        critical, "critical_speed", folder, output, origin=loaded.case.provenance, listed=False,
        figures={"critical_speed": partial(steady.critical, critical, loaded.case.title)},
    )  # fmt: skip
    return report_outcomes(critical)


def critical_map(
    loaded: Input,
    motion: str | None,
    masses: str,
    positions: str | None,
    upper: float | None,
    folder: Path | None,
    output: Output,
) -> int:
    """Print and write a map of critical speeds. Arguments are those of :func:`critical_speed`, with
    `upper` in rad/s.
    """
    name, chosen = loaded.motion(motion, kind="hub")
    case = loaded.case
    kilograms = numbers("--masses", masses, "mass")
    length = case.beam.length
    places = [length * i / 8 for i in range(1, 9)] if positions is None else numbers("--positions", positions, "length")
    if max(places) > length:
        raise InputError("--positions", f"has {max(places):g} m, off the beam", f"give 0 to {length:g} m")

    from gbeam.analysis.steady.stability import critical_speed_map
    from gbeam.figures import steady
    from gbeam.report.steady import map_csv

    with Watch() as watch, loaded.placing():
        critical = critical_speed_map(
            case.beam, case.model, chosen, kilograms, places, upper, name=name, progress=watch
        )
    deliver(
        critical, "critical_speed", folder, output, verb="critical-speed", origin=case.provenance,
        figures={"critical_speed": partial(steady.critical_map, critical, case.title)}, listed=False,
        more=lambda hidden: (hidden / "critical_speed.csv").write_text(map_csv(critical), encoding="utf-8"),
    )  # fmt: skip
    return 0


def linearize(
    scenario: ScenarioFile,
    /,
    *,
    motion: MotionName = None,
    at: At = None,
    rate: Annotated[str | None, Parameter(help='A hub\'s steady rate in place of a time, such as "2 rad/s".')] = None,
    modes: Annotated[
        int | None,
        Parameter(help='Keep so many of the slowest modes, "4", besides what has no frequency; else all.'),
    ] = None,
    balanced: Annotated[
        int | None,
        Parameter(help='Keep so many states by balanced truncation, "6", besides what does not decay.'),
    ] = None,
    strain_at: Annotated[
        tuple[str, ...],
        option(
            "--strain-at",
            'Strain at a station, "10 mm", on the faces towards +z and +y, or at a point of a solid, "fillet", along '
            'its axes; in a system "arm.10 mm", "bracket.fillet"; any number of times.',
        ),
    ] = (),
    inputs: Annotated[str | None, Parameter(help='Only these, "torque"; by default all. So with --outputs.')] = None,
    outputs: Annotated[str | None, Parameter(help='Only these, "tip_y, hub_angle".')] = None,
    loop: Annotated[
        str,
        Parameter(
            help="Of a system with controllers: open; closed, from sample to sample, with margins; or cut at a drive, "
            '"pointing: axis.angle".',
        ),
    ] = "open",
    output: Output = Output(),
) -> int:
    """State-space model A, B, C, D about the equilibrium at one time of a motion.

    With --out writes linear.json, linear.mat and a plot of the poles, with --report linear.html. Exit status: 0 done,
    1 there is no equilibrium, 2 the input is wrong.
    """
    folder = output.folder(scenario)
    loaded = read("linearize", scenario, output.overrides)
    name, chosen = loaded.motion(motion, kind="" if rate is None else "hub")
    time = loaded.time(at, name)
    steady = None if rate is None else number("--rate", rate, "angular rate")
    for flag, other_flag, excluded in (
        ("--loop", "--balanced or --modes", loop != "open" and (modes is not None or balanced is not None)),
        ("--balanced", "--modes", modes is not None and balanced is not None),
        ("--rate", "--at", rate is not None and at is not None),
    ):
        if excluded:
            raise InputError(flag, f"stands beside {other_flag}", "give one of them")

    from gbeam.analysis.control.linearization import linearize

    structure = loaded.case.subject
    gauges = [gauge for text in strain_at for gauge in _gauges_at(loaded.case.system, text)]
    options = {
        "order": "--balanced",
        "modes": "--modes",
        "inputs": "--inputs",
        "outputs": "--outputs",
        "loop": "--loop",
        "rate": "--rate",
    }
    with Watch(), loaded.placing(**options):
        system = linearize(
            structure, chosen, time,
            rate=steady, gauges=gauges, inputs=_names(inputs), outputs=_names(outputs), loop=loop, name=name,
        )  # fmt: skip
        if modes is not None or balanced is not None:
            from gbeam.analysis.control import reduction

            if modes is not None:
                system = reduction.modal_truncation(system, modes)
            elif balanced is not None:
                system, _ = reduction.balanced_truncation(system, balanced)
    system = replace(system, provenance=loaded.case.provenance)
    deliver(
        system, "linear", folder, output, facts={"gauges": [asdict(gauge) for gauge in gauges]}, listed=False,
        more=lambda hidden: system.to_mat(hidden / "linear.mat"),
    )  # fmt: skip
    return 0


def _gauges_at(system: System, text: str) -> list[Gauge]:
    """Gauges of one --strain-at: on two faces of a beam at a position, or along the three axes at a
    point of a solid.
    """
    from gbeam.analysis.control.outputs import surface_gauges
    from gbeam.guards.checks import choice, index_of
    from gbeam.results.state_space import Gauge

    body, name, structure = "", text, system.only_structure
    if structure is None:
        body, _, name = text.partition(".")
        choice("--strain-at", body, system.flexible)
        structure = system.flexible[body]
    if structure.source is None:
        index_of("--strain-at", name, structure.points)
        return [Gauge(name, along=axis, body=body) for axis in ((1, 0, 0), (0, 1, 0), (0, 0, 1))]
    beam = structure.source.beam
    with naming("--strain-at"):
        place = beam.named_points[name] if name in beam.named_points else number("--strain-at", name, "length")
        return [replace(gauge, body=body) for gauge in surface_gauges(beam, [place])]


def _names(text: str | None) -> tuple[str, ...] | None:
    return None if text is None else tuple(name.strip() for name in text.split(","))
