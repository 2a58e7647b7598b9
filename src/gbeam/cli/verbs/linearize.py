"""``gbeam linearize``: A, B, C, D about a frozen motion."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from cyclopts import Parameter

from gbeam.cli.common import At, MotionName, motion_of, number, time_of
from gbeam.cli.console import Watch, stdout
from gbeam.cli.inputs import read
from gbeam.cli.options import Json, Out, Overrides, ScenarioFile
from gbeam.cli.outputs import publish, refuse_unwritable
from gbeam.errors import InputError

if TYPE_CHECKING:
    from gbeam.analysis.control.linearization import Gauge
    from gbeam.analysis.control.state_space import StateSpace
    from gbeam.structure.beam import Beam

WIDTH = 100  # columns of the text


def linearize(
    scenario: ScenarioFile,
    /,
    *,
    motion: MotionName = None,
    at: At = None,
    rate: Annotated[
        str | None, Parameter(name="--rate", help='A hub\'s steady rate in place of a time, such as "2 rad/s".')
    ] = None,
    modes: Annotated[
        int | None,
        Parameter(
            name="--modes", help="Keep so many of the slowest modes, besides what has no frequency; by default all."
        ),
    ] = None,
    balanced: Annotated[
        int | None,
        Parameter(name="--balanced", help="Keep so many states by balanced truncation, besides what does not decay."),
    ] = None,
    strain_at: Annotated[
        tuple[str, ...],
        Parameter(
            name="--strain-at",
            negative="",
            show_default=False,
            help='Strain at a station, "10 mm", on the faces towards +z and +y; any number of times.',
        ),
    ] = (),
    inputs: Annotated[
        str | None, Parameter(name="--inputs", help='Only these, "torque"; by default all. So with --outputs.')
    ] = None,
    outputs: Annotated[str | None, Parameter(name="--outputs", help='Only these, "tip_y, hub_angle".')] = None,
    overrides: Overrides = (),
    out: Out = None,
    json: Json = False,
) -> int:
    """State-space model A, B, C, D about the equilibrium at one time of a motion.

    With --out writes linear.json and linear.mat. Exit status: 0 done, 1 there is no equilibrium, 2 the input is wrong.
    """
    if out is not None:
        refuse_unwritable(out)
    given = read("linearize", scenario, overrides)
    name, chosen = motion_of(given, motion, hubs_only=rate is not None)
    time = time_of(given, at)
    turning = None if rate is None else number("--rate", rate, "angular rate")
    for option, beside, both in (
        ("--balanced", "--modes", modes is not None and balanced is not None),
        ("--rate", "--at", rate is not None and at is not None),
    ):
        if both:
            raise InputError(option, f"stands beside {beside}", "give one of them")

    from gbeam.analysis.control.linearization import linearize as find
    from gbeam.analysis.control.reduction import balanced_truncation, modal_truncation
    from gbeam.analysis.study.study import structure_of
    from gbeam.report import as_json

    gauges = gauges_at(given.case.beam, strain_at)
    with Watch(), given.placing():
        found = find(structure_of(given.case), chosen, time, rate=turning, gauges=gauges, name=name)
    hankel: Iterable[float] = ()
    try:
        found = found.select(inputs=_names(inputs), outputs=_names(outputs))
        if modes is not None:
            found = modal_truncation(found, modes)
        elif balanced is not None:
            found, hankel = balanced_truncation(found, balanced)
    except InputError as error:
        option = "--balanced" if error.where == "order" else f"--{error.where}"
        raise InputError(option, error.problem, error.fix) from None
    extra = {"gauges": [asdict(it) for it in gauges], "hankel_singular_values": [float(it) for it in hankel]}
    text = as_json({**to_json(found), **extra})
    if out is not None:

        def make(hidden: Path) -> None:
            found.to_mat(hidden / "linear.mat")
            (hidden / "linear.json").write_text(text + "\n", encoding="utf-8")

        publish(out, make)
    if json:
        print(text)
    else:
        stdout().print(_text(found, gauges, hankel), markup=False)
    return 0


def _names(text: str | None) -> tuple[str, ...] | None:
    return None if text is None else tuple(it.strip() for it in text.split(","))


def gauges_at(beam: Beam, stations: tuple[str, ...]) -> list[Gauge]:
    """Two gauges at each station, on the outer fibres towards +z and +y."""
    from gbeam.analysis.control.linearization import Gauge

    gauges: list[Gauge] = []
    for text in stations:
        at = number("--strain-at", text, "length")
        if not 0 <= at <= beam.length:
            raise InputError("--strain-at", f"is {at:g} m, off the beam", f"give 0 to {beam.length:g} m")
        section = beam.section.at(np.array([at]))
        fibres = float(section.extreme_fibre_y[0]), float(section.extreme_fibre_z[0])
        if not np.isfinite(fibres).all():
            raise InputError(
                "--strain-at", "needs the outer fibres", "add extreme_fibre_y and extreme_fibre_z to beam.section"
            )
        gauges += [Gauge(at, z=fibres[1]), Gauge(at, y=fibres[0])]
    return gauges


def to_json(found: StateSpace) -> dict[str, Any]:
    """State space as JSON."""

    def signals(listed: Any, values: Any) -> list[dict[str, Any]]:
        return [{"name": it.name, "unit": it.unit, "value": float(v)} for it, v in zip(listed, values, strict=True)]

    return {
        "outcome": "done",
        "motion": found.motion,
        "time": found.time,
        "model": found.model,
        "states": signals(found.states, found.state),
        "inputs": signals(found.inputs, found.input),
        "outputs": signals(found.outputs, found.output),
        **{key: getattr(found, key.lower()).tolist() for key in "ABCD"},
    }


def _text(found: StateSpace, gauges: Iterable[Gauge], hankel: Iterable[float]) -> str:
    lines = [f"{found.motion}: {found.model}, {len(found.a)} states"]
    for what in ("states", "inputs", "outputs"):
        # No line ends between a name and its unit.
        signals = ", ".join(f"{it.name} [{it.unit}]".replace(" ", "\N{NO-BREAK SPACE}") for it in getattr(found, what))
        lines += wrap(
            signals, WIDTH, initial_indent=f"  {what:<8} ", subsequent_indent=11 * " ", break_on_hyphens=False
        )
    told = {it.name for it in found.outputs}
    for name, it in ((f"strain_{k}", it) for k, it in enumerate(gauges, 1)):
        if name in told:
            lines.append(f"  {name} at {it.at:g} m, fibre y {1e3 * it.y:g} mm, z {1e3 * it.z:g} mm")
    if hankel := list(hankel):
        lines.append("  Hankel singular values " + " ".join(f"{it:.3g}" for it in hankel))
    return "\n".join([*lines, "--json prints the matrices, --out writes them for MATLAB too."])
