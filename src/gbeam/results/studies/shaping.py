"""A hub's command that leaves little vibration, beside usual ones."""

from __future__ import annotations

from dataclasses import dataclass

from gbeam.results.result import Figured, Floats, Part


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
