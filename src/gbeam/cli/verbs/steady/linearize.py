"""``gbeam linearize``: A, B, C, D about a frozen motion."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from gbeam.cli.inputs import naming, number, read
from gbeam.cli.options import (
    At,
    Balanced,
    Inputs,
    Json,
    ModesKept,
    MotionName,
    Out,
    Outputs,
    Overrides,
    Rate,
    ScenarioFile,
    StrainAt,
)
from gbeam.cli.outputs import show, write_json
from gbeam.cli.publication import publish
from gbeam.cli.terminal.console import Watch
from gbeam.errors import InputError


def linearize(
    scenario: ScenarioFile,
    /,
    *,
    motion: MotionName = None,
    at: At = None,
    rate: Rate = None,
    modes: ModesKept = None,
    balanced: Balanced = None,
    strain_at: StrainAt = (),
    inputs: Inputs = None,
    outputs: Outputs = None,
    overrides: Overrides = (),
    out: Out = None,
    json: Json = False,
) -> int:
    """State-space model A, B, C, D about the equilibrium at one time of a motion.

    With --out writes linear.json and linear.mat. Exit status: 0 done, 1 there is no equilibrium, 2 the input is wrong.
    """
    given = read("linearize", scenario, overrides, out)
    name, chosen = given.motion(motion, kind="" if rate is None else "hub")
    time = given.time(at)
    steady = None if rate is None else number("--rate", rate, "angular rate")
    stations = [number("--strain-at", text, "length") for text in strain_at]
    for option, beside, both in (
        ("--balanced", "--modes", modes is not None and balanced is not None),
        ("--rate", "--at", rate is not None and at is not None),
    ):
        if both:
            raise InputError(option, f"stands beside {beside}", "give one of them")

    from gbeam.analysis.control.gauges import surface_gauges
    from gbeam.analysis.control.linearization import linearize
    from gbeam.report.steady import state_space as report

    with naming("--strain-at"):
        gauges = surface_gauges(given.case.beam, stations)
    options = {"order": "--balanced", "modes": "--modes", "inputs": "--inputs", "outputs": "--outputs"}
    with Watch(), given.placing(**options):
        system = linearize(given.case.assemble(), chosen, time, rate=steady, gauges=gauges, name=name)
        system = system.select(inputs=_names(inputs), outputs=_names(outputs))
        if modes is not None or balanced is not None:
            from gbeam.analysis.control import reduction

            if modes is not None:
                system = reduction.modal_truncation(system, modes)
            elif balanced is not None:
                system, _ = reduction.balanced_truncation(system, balanced)
    system = replace(system, provenance=given.case.provenance)
    facts = given.signed(report.to_json(system, gauges))

    def make(hidden: Path) -> None:
        system.to_mat(hidden / "linear.mat")
        write_json(hidden / "linear.json", facts)

    if out is not None:
        publish(out, make)
    show(report.text(system, gauges), facts, json)
    return 0


def _names(text: str | None) -> tuple[str, ...] | None:
    return None if text is None else tuple(name.strip() for name in text.split(","))
