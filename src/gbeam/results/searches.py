"""Values of a scenario that a search finds: fits, optima and commands of hubs."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from gbeam.results.declared import BESIDE, declared, fact, internal, labels, quantity, rows
from gbeam.results.result import Figured, Flags, Floats, Part

ON_BOUND = ("inside", "at_bound")


@dataclass(frozen=True, repr=False, eq=False)
class FittedColumn(Part):
    """One column of the data, and the fitted scenario's values of the same quantity."""

    name: str = labels("name of the column")
    unit: str = quantity("", "SI unit of the column", name="column_unit")
    measured: Floats = quantity("", "data, in the column's unit", "at")
    fitted: Floats = quantity("", "the same of the fitted scenario", "at")
    before: Floats = quantity("", "the same of the scenario as it was", "at", name="computed_before")
    noise: float = quantity(
        BESIDE, "standard deviation of the residual", note="with the degrees of freedom that the fit leaves"
    )
    correlation: float = quantity(
        "",
        "correlation of each residual with the next one",
        name=None,
        key="correlation_of_residuals",
        note="NaN where the data are no history; noise has none",
    )

    @declared("", "data in the column", name=None)
    def data(self) -> int:
        return len(self.measured)

    @property
    def residual(self) -> Floats:
        """Measured less fitted."""
        return np.asarray(self.measured - self.fitted)


@dataclass(frozen=True, repr=False, eq=False)
class Fit(Figured[Literal["fit"]]):
    """Values of a scenario at which it is nearest to a measurement, in the sense of least squares.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import mkdtemp
    >>> import numpy as np
    >>> taps = Path(mkdtemp()) / "taps.csv"
    >>> measured = [(1, 0.46, 0.01), (2, 2.88, 0.01), (3, 8.06, 0.01)]
    >>> np.savetxt(taps, measured, delimiter=",", header="mode,frequency,damping_ratio", comments="")
    >>> hub = "examples/hubbeam2009_slew_2p8.toml"
    >>> answer = gb.fit(hub, taps, ["beam.material.youngs_modulus"])
    >>> print(f"{answer.values[0]:.4g} ± {answer.errors[0]:.1g} {answer.units[0]}")
    6.788e+10 ± 6e+08 Pa
    """

    json_rows: ClassVar[dict[str, str]] = {"parameter": "parameters"}

    title: str = fact("title of the scenario")
    data: str = fact("file of the measurement")
    parameters: tuple[str, ...] = labels("paths of the values", "parameter")
    units: tuple[str, ...] = quantity("", "SI unit of the value", "parameter", name="value_unit", key="unit")
    before: Floats = quantity("", "value of the scenario, in its unit", "parameter")
    values: Floats = quantity("", "value of the best fit, in its unit", "parameter", name="value", key="value")
    errors: Floats = quantity(
        "",
        "standard deviation of the value, in its unit",
        "parameter",
        name="error",
        key="error",
        note="if the residuals are noise",
    )
    intervals: Floats = quantity(
        "",
        "interval that holds it with a probability of 95 %",
        "parameter side",
        name="interval",
        key="interval",
        note="by Student's t",
    )
    covariance: Floats = quantity("", "covariance of the values", "parameter other", key="/covariance")
    correlation: Floats = quantity("", "correlation of their errors", "parameter other", key="/correlation")
    bounds: Floats = quantity("", "bounds of the search", "parameter side")
    at_bound: Flags = quantity(
        "", "whether the value lies on its bound", "parameter", flags=ON_BOUND, note="then it has no error"
    )
    columns: tuple[FittedColumn, ...] = rows("columns of the data", "column")
    at: Floats = quantity(
        lambda self: "" if self.modal else "s", "time, or number of the mode", "at", role="coordinate"
    )
    modal: bool = internal("", "whether the data are of modes")
    evaluations: int = fact("evaluations of the scenario", name=None)
    condition: float = fact(
        "condition of the derivatives, each parameter's of unit length",
        note="1 where the data tell them apart perfectly",
    )
    starts: int = fact("searches", key="starts.tried", default=1)
    agreed: int = fact("searches that ended at these values", key="starts.agreed", default=1)

    @property
    def file_dims(self) -> dict[str, str]:
        """Names that dimensions have in files."""
        return {"at": "mode" if self.modal else "time"}

    @declared("", "paths of the values", "other", role="labels", key=None)
    def other(self) -> tuple[str, ...]:
        return self.parameters

    def __repr__(self) -> str:
        rows = [
            f"{path} = {value:.6g} ± {error:.2g} {unit}".rstrip()
            for path, value, error, unit in zip(self.parameters, self.values, self.errors, self.units, strict=True)
        ]
        return self._with_warnings(f"Fit to {self.data}", *rows)


_TIGHT = 1e-3  # of a bound: nearer, it decides


@dataclass(frozen=True, repr=False, eq=False)
class Requirement(Part):
    """A bound on a figure."""

    name: str = labels("name of the figure", key="")
    unit: str = quantity("", "SI unit of the figure", name=None)
    low: float = quantity(BESIDE, "least value", name=None, note="minus infinity where there is none")
    high: float = quantity(BESIDE, "largest value", name=None, note="infinite where there is none")
    before: float = quantity(BESIDE, "figure in the scenario as it was", name=None)
    value: float = quantity("", "figure at the best values", name="required")

    @declared("", "bound of the figure", key=None)
    def bound(self) -> float:
        """The one that is nearer to the value."""
        return self.high if abs(self.high - self.value) <= abs(self.value - self.low) else self.low

    @declared("", "whether the value lies within", name=None)
    def kept(self) -> bool:
        """True if the value lies within, but for a thousandth of the bound."""
        slack = _TIGHT * abs(self.bound)
        return self.low - slack <= self.value <= self.high + slack

    @declared("", "whether the value lies on the bound", name=None)
    def active(self) -> bool:
        """True if it decides: the value lies on the bound."""
        return math.isfinite(self.bound) and abs(self.value - self.bound) <= _TIGHT * max(abs(self.bound), 1e-300)


@dataclass(frozen=True, repr=False, eq=False)
class Optimum(Figured[Literal["optimum"]]):
    """Values of a scenario at which a figure is least, within bounds and requirements.

    Examples
    --------
    >>> scenario = "examples/zhang2020_example1.toml"
    >>> over = ["motion.centrifuge.control_point"]
    >>> answer = gb.optimise(scenario, "verdict.tip", over, overrides=["response.step=5 ms"])
    >>> answer.outcome, answer.minimise
    ('done', 'verdict.tip')
    """

    json_rows: ClassVar[dict[str, str]] = {"parameter": "parameters"}

    title: str = fact("title of the scenario")
    minimise: str = fact("the figure", key="minimise.name", note="of what has no unit, such as a verdict, its size")
    unit: str = fact("SI unit of the figure", name=None, key="minimise.unit")
    parameters: tuple[str, ...] = labels("paths of the values", "parameter")
    units: tuple[str, ...] = quantity("", "SI unit of the value", "parameter", name="value_unit", key="unit")
    before: Floats = quantity("", "value of the scenario, in its unit", "parameter")
    values: Floats = quantity("", "best value, in its unit", "parameter", name="value", key="value")
    bounds: Floats = quantity("", "bounds of the search", "parameter side")
    at_bound: Flags = quantity("", "whether the value lies on its bound", "parameter", flags=ON_BOUND)
    figure_before: float = fact("the figure of the scenario, by a run with steps of its own", key="minimise.before")
    figure: float = fact("the figure at the best values, by a run with steps of its own", key="minimise.value")
    error: float = fact(
        "estimated total error of the tip's displacement in the run at the optimum",
        name=None,
        key="error_estimate",
        note="NaN where there is no run",
    )
    requirements: tuple[Requirement, ...] = rows("bounds on other figures", "requirement", key="subject_to")
    path: Floats = quantity("", "values tried that were better than those before", "better parameter")
    history: Floats = quantity(BESIDE, "the figure there", "better")
    evaluations: int = fact("evaluations of the scenario", name=None)
    outcome: str = fact(
        "how it ended", note="done, or limits exceeded where no values within the bounds keep the requirements",
        default="done",
    )  # fmt: skip
    starts: int = fact("searches", key="starts.tried", default=1)
    agreed: int = fact("searches that ended at these values", key="starts.agreed", default=1)

    def __repr__(self) -> str:
        rows = [
            f"{path} = {value:.6g} {unit}".rstrip() + f" (was {start:.6g})"
            for path, value, start, unit in zip(self.parameters, self.values, self.before, self.units, strict=True)
        ]
        end = "" if self.outcome == "done" else f" ({self.outcome})"
        heading = f"Optimum of {self.minimise}: {self.figure:.4g} {self.unit}".rstrip()
        return self._with_warnings(f"{heading}, was {self.figure_before:.4g}{end}", *rows)


GOALS = {"angle": "by {:.4g} rad", "distance": "by {:.4g} m", "rate": "to {:.4g} rad/s", "speed": "to {:.4g} m/s"}
# Units of a command of every kind, and of the largest torque or force, or the acceleration, under it.
COMMANDS = {"torque": ("N m", "N m"), "force": ("N", "N"), "rate": ("rad/s", "rad/s^2"), "speed": ("m/s", "m/s^2")}


@dataclass(frozen=True, repr=False, eq=False)
class CommandRun(Part):
    """One command, and the vibration that it leaves."""

    name: str = labels("shaped, ZVD or smooth-step")
    command: Floats = internal("", "torque, N m, force, N, rate, rad/s, or speed, m/s", "time")
    largest: float = quantity("", "largest torque, N m, force, N, or acceleration, rad/s^2 or m/s^2")
    by_ratio: Floats = quantity(
        "m",
        "amplitude left by the design's modes",
        "ratio",
        key=None,
        note="where all their frequencies are so many times as high",
    )
    time: Floats = internal("s", "times of the check's run", "run_time")
    tip: Floats = internal("m", "displacement of the tip", "run_time axis")
    residual: float = quantity("m", "amplitude of the tip after the command", key="residual_amplitude")
    outcome: str = quantity("", "how the run ended")


@dataclass(frozen=True, repr=False, eq=False)
class ShapedCommand(Figured[Literal["shaping", "robustness"]]):
    """A torque, force, rate or speed of a hub or a joint that leaves the least vibration.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    >>> structure = gb.assemble(beam, "FOAM", axial=1, y=2, z=2)
    >>> hub = gb.Hub(radius=0.0, rate=0.0)
    >>> command = gb.shape_command(structure, hub, angle=1.0, duration=0.5)
    >>> command.outcome, command.unit
    ('done', 'rad/s')
    """

    kind: str = fact("torque, rate, force or speed")
    goal: float = fact("angle, rad, or distance, m, or the rate, rad/s, or speed, m/s, that is reached", key=None)
    to_rate: bool = internal("", "whether the goal is a rate")
    duration: float = fact("duration of the command", "s")
    coefficients: Floats = quantity(BESIDE, "coefficients of the command, a gbeam.SplineProfile", "spline")
    time: Floats = quantity("s", "time", "time", role="coordinate", note="of the commands")
    limit: float = fact(
        "limit of the torque, N m, the force, N, or the acceleration, rad/s^2 or m/s^2",
        name=None,
        note="infinite where there is none",
    )
    robust: float = fact("share by which all frequencies may be wrong")
    frequency: Floats = quantity("Hz", "frequencies that the design knows", "mode", key="frequencies")
    ratio: Floats = quantity("", "frequencies over those of the design", "ratio", role="coordinate", key=None)
    runs: tuple[CommandRun, ...] = rows("commands, the shaped one first", "run", key="commands")
    design: str = fact("model that it was designed on")
    check: str = fact("model of the runs")
    motion: str = fact("name of the scenario's hub, where there is one", name=None, default="")

    @declared("", "unit of the command", role="fact", name=None)
    def unit(self) -> str:
        return COMMANDS[self.kind][0]

    @declared(
        "", "angle, rad, or distance, m, or the rate, rad/s, or speed, m/s, reached", role="fact", name=None, key="goal"
    )
    def aim(self) -> dict[str, float]:
        names = ("distance", "speed") if self.kind in ("force", "speed") else ("angle", "rate")
        return {names[self.to_rate]: self.goal}

    @property
    def task(self) -> str:
        """Words for what the command does, such as "by 1 rad"."""
        ((name, goal),) = self.aim.items()
        return GOALS[name].format(goal)

    @declared(BESIDE, "torque, force, rate or speed", "run time", name="command")
    def command(self) -> Floats:
        return np.stack([run.command for run in self.runs])

    @declared("s", "time", "run_time", role="coordinate")
    def run_time(self) -> Floats:
        return self.runs[0].time

    @declared("m", "displacement of the tip", "run run_time axis", name="tip")
    def tip(self) -> Floats:
        histories = []
        for run in self.runs:
            components = [np.interp(self.run_time, run.time, component) for component in run.tip.T]
            histories.append(np.stack(components, axis=1))
        return np.stack(histories)

    @property
    def outcome(self) -> str:
        """``done`` where every command's run is, else the first other outcome."""
        return next((run.outcome for run in self.runs if run.outcome != "done"), "done")

    @property
    def residual(self) -> float:
        """Amplitude that the shaped command leaves in the check's run, m."""
        return self.runs[0].residual

    def __repr__(self) -> str:
        residuals = ", ".join(f"{run.name} {1e3 * run.residual:.3g} mm" for run in self.runs)
        words = f"Shaped {self.kind} {self.task} in {self.duration:.4g} s"
        return self._with_warnings(f"{words}; left by {self.check}: {residuals}")
