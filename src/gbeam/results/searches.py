"""Values of a scenario that a search finds: fits, optima and commands of hubs."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gbeam.results.result import Figured, Flags, Floats, Part


@dataclass(frozen=True, repr=False, eq=False)
class FittedColumn(Part):
    """One column of the data, and what the fitted scenario says of it.

    Parameters
    ----------
    name, unit : str
        SI.
    measured, fitted, before : (t,)
        `before` is of the scenario as it was.
    noise : float
        Standard deviation of the residual, with the degrees of freedom that the fit leaves.
    correlation : float
        Of each residual with the next one; NaN where the data are no history. Noise has none.
    """

    name: str
    unit: str
    measured: Floats
    fitted: Floats
    before: Floats
    noise: float
    correlation: float

    @property
    def residual(self) -> Floats:
        """Measured less fitted."""
        return np.asarray(self.measured - self.fitted)


@dataclass(frozen=True, repr=False, eq=False)
class Fit(Figured):
    """Values of a scenario at which it is nearest to a measurement, in the sense of least squares.

    Parameters
    ----------
    title : str
        Of the scenario.
    data : str
        The measurement's file.
    parameters, units : tuple of str
        Paths, and SI units.
    before, values : (p,)
        The scenario's values, and those found.
    errors : (p,)
        Standard deviations, one sigma, of the values, if the residuals are noise.
    intervals : (p, 2)
        That hold each value with a probability of 95 %, by Student's t.
    covariance, correlation : (p, p)
    bounds : (p, 2)
    at_bound : (p,) of bool
        Whether a value lies on its bound: then it has no error.
    columns : tuple of FittedColumn
    at : (t,)
        Times, s, or numbers of the modes.
    modal : bool
    evaluations : int
        Of the scenario.
    starts, agreed : int
        Searches, and how many of them ended at these values.
    condition : float
        Of the derivatives, each parameter's of unit length: 1 where the data tell them apart perfectly.

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

    title: str
    data: str
    parameters: tuple[str, ...]
    units: tuple[str, ...]
    before: Floats
    values: Floats
    errors: Floats
    intervals: Floats
    covariance: Floats
    correlation: Floats
    bounds: Floats
    at_bound: Flags
    columns: tuple[FittedColumn, ...]
    at: Floats
    modal: bool
    evaluations: int
    condition: float
    starts: int = 1
    agreed: int = 1

    def __repr__(self) -> str:
        rows = [
            f"{path} = {value:.6g} ± {error:.2g} {unit}".rstrip()
            for path, value, error, unit in zip(self.parameters, self.values, self.errors, self.units, strict=True)
        ]
        return self._with_warnings(f"Fit of {len(self.parameters)} values to {self.data}", *rows)


BROKEN = "limits exceeded"  # an outcome
_TIGHT = 1e-3  # of a bound: nearer, it decides


@dataclass(frozen=True, repr=False, eq=False)
class Requirement(Part):
    """A bound on a figure.

    Parameters
    ----------
    name, unit : str
        Of the figure, SI.
    low, high : float
        Infinite where there is none.
    before, value : float
        Of the figure in the scenario as it was, and at the optimum.
    """

    name: str
    unit: str
    low: float
    high: float
    before: float
    value: float

    @property
    def bound(self) -> float:
        """The one that is nearer to the value."""
        return self.high if abs(self.high - self.value) <= abs(self.value - self.low) else self.low

    @property
    def kept(self) -> bool:
        """Whether the value lies within, but for a thousandth of the bound."""
        slack = _TIGHT * abs(self.bound)
        return self.low - slack <= self.value <= self.high + slack

    @property
    def active(self) -> bool:
        """Whether it decides: the value lies on the bound."""
        return math.isfinite(self.bound) and abs(self.value - self.bound) <= _TIGHT * max(abs(self.bound), 1e-300)


@dataclass(frozen=True, repr=False, eq=False)
class Optimum(Figured):
    """Values of a scenario at which a figure is least, within bounds and requirements.

    Parameters
    ----------
    title : str
        Of the scenario.
    minimise, unit : str
        The figure, SI; of what has no unit, such as a verdict, the size is minimised.
    parameters, units : tuple of str
        Paths, and SI units.
    before, values : (p,)
        The scenario's values, and the best.
    bounds : (p, 2)
    at_bound : (p,) of bool
        Whether the best value lies on its bound.
    figure_before, figure : float
        By runs with steps of their own.
    error : float
        Estimated total error of the tip's displacement in the run at the optimum; NaN where there is no run.
    requirements : tuple of Requirement
    path : (k, p)
        The values tried that were better than those before.
    history : (k,)
        The figure there.
    evaluations : int
    starts, agreed : int
        Searches, and how many of them ended at these values.
    outcome : str
        done, or ``limits exceeded`` where no values within the bounds keep the requirements.

    Examples
    --------
    >>> scenario = "examples/zhang2020_example1.toml"
    >>> over = ["motion.centrifuge.control_point"]
    >>> answer = gb.optimise(scenario, "verdict.tip", over, overrides=["response.step=5 ms"])
    >>> answer.outcome, answer.minimise
    ('done', 'verdict.tip')
    """

    title: str
    minimise: str
    unit: str
    parameters: tuple[str, ...]
    units: tuple[str, ...]
    before: Floats
    values: Floats
    bounds: Floats
    at_bound: Flags
    figure_before: float
    figure: float
    error: float
    requirements: tuple[Requirement, ...]
    path: Floats
    history: Floats
    evaluations: int
    outcome: str = "done"
    starts: int = 1
    agreed: int = 1

    def __repr__(self) -> str:
        rows = [
            f"{path} = {value:.6g} {unit}".rstrip() + f" (was {old:.6g})"
            for path, value, old, unit in zip(self.parameters, self.values, self.before, self.units, strict=True)
        ]
        end = "" if self.outcome == "done" else f" ({self.outcome})"
        what = f"Optimum of {self.minimise}: {self.figure:.4g} {self.unit}".rstrip()
        return self._with_warnings(f"{what}, was {self.figure_before:.4g}{end}", *rows)


@dataclass(frozen=True, repr=False, eq=False)
class CommandRun(Part):
    """One command, and what it leaves.

    Parameters
    ----------
    name : str
        shaped, ZVD or smooth-step.
    command : (t,)
        Torque, N m, or rate, rad/s.
    largest : float
        Torque, N m, or angular acceleration, rad/s².
    by_ratio : (r,)
        Amplitude left by the design's modes, m, where all their frequencies are so many times as high.
    time, tip : (k,), (k, 3)
        Of the check's run, s and m.
    residual : float
        Amplitude of the tip's vibration in that run after the command, m.
    outcome : str
        Of that run.
    """

    name: str
    command: Floats
    largest: float
    by_ratio: Floats
    time: Floats
    tip: Floats
    residual: float
    outcome: str


@dataclass(frozen=True, repr=False, eq=False)
class ShapedCommand(Figured):
    """A torque or rate of a hub that leaves the least vibration of its beam.

    Parameters
    ----------
    kind : str
        torque or rate.
    goal : float
        Angle turned, rad, or rate reached, rad/s.
    to_rate : bool
        Whether `goal` is a rate.
    duration : float
        Of the command, s.
    coefficients : (k,)
        Of :class:`gbeam.SplineProfile`, which is the command.
    time : (t,)
        Of the commands, s.
    limit : float
        On the torque, N m, or the angular acceleration, rad/s²; infinite where there is none.
    robust : float
        Share by which all frequencies may be wrong.
    frequency : (f,)
        Of the modes that the design knows, Hz.
    ratio : (r,)
        At which `by_ratio` of each run is given.
    runs : tuple of CommandRun
        The shaped command's first.
    design, check : str
        Models that it was designed on, and that the runs are of.
    motion : str
        Name of the scenario's hub, where there is one.

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

    kind: str
    goal: float
    to_rate: bool
    duration: float
    coefficients: Floats
    time: Floats
    limit: float
    robust: float
    frequency: Floats
    ratio: Floats
    runs: tuple[CommandRun, ...]
    design: str
    check: str
    motion: str = ""

    @property
    def unit(self) -> str:
        """Of the command."""
        return "N m" if self.kind == "torque" else "rad/s"

    @property
    def outcome(self) -> str:
        """``done`` where every command's run is, else the first other outcome."""
        return next((run.outcome for run in self.runs if run.outcome != "done"), "done")

    @property
    def residual(self) -> float:
        """Amplitude that the shaped command leaves in the check's run, m."""
        return self.runs[0].residual

    def __repr__(self) -> str:
        aim = f"to {self.goal:.4g} rad/s" if self.to_rate else f"by {self.goal:.4g} rad"
        left = ", ".join(f"{run.name} {1e3 * run.residual:.3g} mm" for run in self.runs)
        return self._with_warnings(f"Shaped {self.kind} {aim} in {self.duration:.4g} s; left by {self.check}: {left}")
