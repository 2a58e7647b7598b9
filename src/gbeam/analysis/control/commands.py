"""Commands as splines, the goals that they have to reach, and the vibration that they leave in a linear model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gbeam.analysis.control.plants import Goal, Plant
from gbeam.arrays.types import Complex, Floats
from gbeam.errors import InputError
from gbeam.motion.profiles.pulse import SplineProfile, fit_spline
from gbeam.numerics.bspline import DEGREE, Spline

_FINE = 200  # pieces of a spline that approximates another form
_TIMES = 2001  # over a command: the splines are smooth, and vanish at the ends with four derivatives


class Commands:
    """Splines of so many pieces that drive a plant from rest. The drive is the effort if the plant is free, else the
    derivative of its rate.

    A drive (t,) is `drive` times the inner coefficients plus `fixed`. Coefficients that reach the goal are `particular`
    plus any combination of the columns of `free`.
    """

    def __init__(self, plant: Plant, goal: Goal, pieces: int) -> None:
        self.plant, self.goal = plant, goal
        self.time = np.linspace(0.0, goal.duration, _TIMES)
        basis = Spline(0.0, goal.duration / pieces, np.eye(pieces + DEGREE))
        order = 0 if plant.free else 1
        drive = np.asarray(basis.series(self.time, 1).derivatives()[order])
        self.ends = np.zeros(pieces + DEGREE)
        if goal.to_rate and not plant.free:
            self.ends[-DEGREE:] = goal.value
        self.drive, self.fixed = drive[:, DEGREE:-DEGREE], drive @ self.ends
        self.slope = np.diff(self.drive, axis=0) / np.diff(self.time)[:, None]
        self.inertia = plant.inertia if plant.free else 1.0
        rows, aims = self._aims(basis(self.time))
        self.particular: Floats = np.asarray(np.linalg.pinv(rows) @ aims, dtype=np.float64)
        _, sizes, directions = np.linalg.svd(rows)
        self.free = np.asarray(directions[int((sizes > 0).sum()) :].T)

    def _aims(self, basis: Floats) -> tuple[Floats, Floats]:
        """Linear conditions of the goal on the coefficients: rows (c, n), and the values (c,) of their products."""
        t, goal = self.time, self.goal
        if not self.plant.free:
            if goal.to_rate:  # by the coefficients at the ends
                return np.zeros((1, self.drive.shape[1])), np.zeros(1)
            turned = np.asarray(np.trapezoid(basis[:, DEGREE:-DEGREE], t, axis=0))  # ∫ rate dt
            return turned[None], np.array([goal.value])
        impulse = np.asarray(np.trapezoid(self.drive, t, axis=0))
        moved = np.asarray(np.trapezoid((goal.duration - t)[:, None] * self.drive, t, axis=0))  # ∫∫ effort dt dt
        if goal.to_rate:
            return impulse[None], np.array([self.inertia * goal.value])
        return np.stack([impulse, moved]), np.array([0.0, self.inertia * goal.value])

    def scaled(self, drive: Floats) -> Floats:
        """Multiply a drive (t,) by a factor so that it reaches the goal."""
        t, goal = self.time, self.goal
        reached = np.trapezoid(drive, t) if goal.to_rate else np.trapezoid((goal.duration - t) * drive, t)
        return np.asarray(drive * self.inertia * goal.value / reached)

    def profile(self, drive: Floats) -> SplineProfile:
        """The command of a drive (t,): the effort itself, or the rate whose derivative it is."""
        if not self.plant.free:
            drive = np.concatenate([[0.0], np.cumsum((drive[1:] + drive[:-1]) / 2 * np.diff(self.time))])
        return fit_spline(self.goal.duration, self.time, drive, _FINE)

    def command(self, inner: Floats) -> SplineProfile:
        """Return the command with these inner coefficients of its spline."""
        coefficients = self.ends.copy()
        coefficients[DEGREE:-DEGREE] = inner
        return SplineProfile(self.goal.duration, coefficients)


@dataclass(frozen=True)
class Vibration:
    """Modes at rest: eigenvalues λ (k,), and gains (k,).

    A drive u leaves the tip with the amplitude gain · |∫ exp(−λt) u dt|.
    """

    eigenvalue: Complex
    gain: Floats

    @staticmethod
    def from_plant(plant: Plant) -> Vibration:
        """Find the modes that the drive of a plant excites, by ascending frequency; InputError if there are none."""
        small = plant.small
        values, vectors = np.linalg.eig(small.a)
        excited = np.linalg.solve(vectors, small.column)
        size = np.linalg.norm(small.tip @ vectors, axis=0) * np.abs(excited)
        vibrates = values.imag > 1e-6 * np.abs(values).max()  # rigid motions do not, and one of each pair counts
        chosen = vibrates & (size > 1e-9 * size[vibrates].max(initial=0.0))
        if not chosen.any():
            fix = "give the model shapes in the plane in which it moves, such as y = 1 or more"
            raise InputError("structure", "has no vibration that the drive excites", fix)
        order = np.argsort(values[chosen].imag)
        return Vibration(values[chosen][order], 2 * size[chosen][order])

    def rows(self, time: Floats, drive: Floats, ratio: float = 1.0) -> Complex:
        """Complex amplitudes (k, ...), m, that drives (t, ...) leave in modes with eigenvalues times `ratio`."""
        # With the decay until the end in the exponent: that of a fast mode would overflow.
        weights = np.exp(ratio * (self.eigenvalue.real[:, None] * time[-1] - np.outer(self.eigenvalue, time)))
        drives = drive.reshape(len(time), -1)
        values = np.stack([np.trapezoid(weight[:, None] * drives, time, axis=0) for weight in weights])
        return (self.gain[:, None] * values).reshape(len(weights), *drive.shape[1:])

    def amplitude(self, time: Floats, drive: Floats, ratio: Floats) -> Floats:
        """Amplitudes (r,), m, of all modes together that a drive (t,) leaves with eigenvalues times each ratio (r,)."""
        return np.array([float(np.linalg.norm(self.rows(time, drive, float(value)))) for value in ratio])


def reference_drives(commands: Commands, vibration: Vibration) -> dict[str, Floats]:
    """Drives (t,) by name, to compare a command with: a smooth step and, if time allows, a shorter one with a ZVD
    shaper of the first mode.
    """
    drives = {"smooth-step": commands.scaled(_smooth(commands.time, commands.goal))}
    value = vibration.eigenvalue[0]
    half = np.pi / value.imag  # half a period
    decay = float(np.exp(value.real * half))
    duration = commands.goal.duration - 2 * half
    if duration > half:
        shorter = Goal(commands.goal.value, commands.goal.to_rate, duration)
        # Three impulses half a period apart, with the weights (1, 2 K, K²) of Singer and Seering (1990).
        weights = (1.0, 2 * decay, decay**2)
        parts = [weight * _smooth(commands.time - k * half, shorter) for k, weight in enumerate(weights)]
        drives = {"ZVD": commands.scaled(np.sum(parts, axis=0)), **drives}
    return drives


def _smooth(time: Floats, goal: Goal) -> Floats:
    """Drive (t,), not scaled, that makes the rate or angle, whichever the goal is, the smooth step of 2009 (43)."""
    phase = 2 * np.pi * time / goal.duration
    wave = 1 - np.cos(phase) if goal.to_rate else np.sin(phase)
    return np.where((time >= 0) & (time <= goal.duration), wave, 0.0)


def check_goal(plant: Plant, aims: dict[str, float | None], duration: float) -> Goal:
    """Return the goal. InputError unless exactly one aim has a value, and what is driven can have it."""
    possible = ("distance", "rate") if plant.slides else ("angle", "rate")
    stated = {name: aim for name, aim in aims.items() if aim is not None}
    wrong = next((name for name in stated if name not in possible), None)
    if wrong is not None:
        problem = f"is given, and what is driven {'slides' if plant.slides else 'turns'}"
        raise InputError(wrong, problem, f"give {possible[0]}, or a rate")
    if len(stated) != 1:
        fix = f"give the {possible[0]} to {'move' if plant.slides else 'turn'}, or the rate to reach"
        raise InputError(possible[0], "and rate are both given or both missing", fix)
    ((name, value),) = stated.items()
    if not np.isfinite(value) or value == 0:
        raise InputError(name, f"is {value:g}", "give a finite value that is not zero")
    if not (np.isfinite(duration) and duration > 0):
        raise InputError("duration", f"is {duration:g} s", "give a positive time")
    return Goal(float(value), name == "rate", float(duration))
