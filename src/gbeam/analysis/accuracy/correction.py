"""Solutions put into equations with more shapes, what they leave there, and the small departures that answer it.

Modes that the samples resolve answer in time, by Gauss's method; the others follow statically.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gbeam.arrays.types import Flags, Floats
from gbeam.integrate.driver import integrate
from gbeam.integrate.equations import LinearEquations, Trajectory, slopes
from gbeam.integrate.schemes import gauss
from gbeam.numerics.balance import balanced, loose
from gbeam.numerics.eigen import UNSYMMETRIC, symmetric, symmetric_modes

IntArray = NDArray[np.int_]
Quantity = tuple[str, str]  # a body, or none, and what is read of it
Reading = Mapping[Quantity, Floats]  # over time, (t, ...)
State = tuple[Floats, Floats]  # coordinates and rates, (n,) each
PLACE: Quantity = ("", "place")
LOOKED = 61  # times at which M, C and K are found; between them they are straight lines
RESOLVED = 2.5  # rad between two samples: a mode that turns faster follows statically
PARAMETERS = tuple(f".e{k}" for k in range(4))  # ends of the names of a ball's unknowns
AT_ONCE = 20_000  # numbers of a state's frames computed together, times coordinates


def pieces(count: int, size: int) -> list[slice]:
    """Stretches of so many times of which all frames are held in memory at once."""
    step = max(1, AT_ONCE // max(size, 1))
    return [slice(first, first + step) for first in range(0, count, step)]


def looked(count: int) -> IntArray:
    """Indices of the times at which M, C and K are found, of so many."""
    return np.unique(np.linspace(0, count - 1, min(count, LOOKED)).astype(int))


class Posed(NamedTuple):
    """Equations of motion at the times of a solution: their residual, what drives them at some (index) of the times,
    names of their unknowns, those of bodies `body.q1`, and what is read of a solution.
    """

    residual: Any
    inputs: Callable[[Any], Any]
    names: Sequence[str]
    read: Callable[[Trajectory], Reading]

    @property
    def bodies(self) -> list[str]:
        """Names of the bodies whose shapes the unknowns are; of a joint's none."""
        return [name.rpartition(".q")[0] for name in self.names]


class Correction(NamedTuple):
    """Correction of a solution, and its first two derivatives in time, (t, n) each."""

    value: Floats
    rate: Floats
    acceleration: Floats

    def less(self, other: Correction) -> Correction:
        """The part of it without another."""
        return Correction(*(a - b for a, b in zip(self, other, strict=True)))


class Vibration(NamedTuple):
    """Modes (n, n), columns of unit length in M, about a solution's mean stiffness, and which its samples resolve."""

    square: Floats
    modes: Floats
    resolved: Flags


@dataclass(frozen=True, eq=False)
class Departures:
    """Small departures from a solution at equal intervals of time: K, C and M (k, n, n) at the times `at` that are
    looked at, and which of the unknowns are of bodies, and of balls that a state of rest turns ever faster (n,).
    """

    time: Floats
    at: Floats
    k: Floats
    c: Floats
    m: Floats
    elastic: Flags
    turned: Flags

    @property
    def interval(self) -> float:
        """Between two times, s."""
        return float(self.time[-1] - self.time[0]) / (len(self.time) - 1)

    @cached_property
    def vibration(self) -> Vibration:
        """Modes about the mean, or, where unstable, about the start; joints by Euler parameters are held."""
        mass, square, modes = self.m.mean(axis=0), np.zeros(len(self.elastic)), np.eye(len(self.elastic))
        held = ~self.elastic & (np.abs(mass - mass.T).max() > UNSYMMETRIC * np.abs(mass).max())
        inside = np.ix_(~held, ~held)
        for k in (self.k.mean(axis=0), self.k[0]):
            square[~held], modes[inside] = symmetric_modes(symmetric(k[inside]), symmetric(mass[inside]))
            if square[~held][0] >= -1e-9 * square.max():
                break
        resolved = np.sqrt(np.maximum(square, 0)) * self.interval < RESOLVED
        resolved[np.argsort(square)[:2]] = True
        return Vibration(square, modes, resolved)

    def stiffer(self, by: Floats) -> Departures:
        """Departures with more stiffness (n, n)."""
        return replace(self, k=self.k + by)

    def settled(self, residual: Floats) -> State:
        """State of bodies that rest where they would leave nothing of a residual (n,); joints are accelerated."""
        unknown = np.where(self.elastic, self.k[0], self.m[0])
        return np.where(self.elastic, np.linalg.solve(unknown, -residual), 0.0), np.zeros_like(residual)

    def of_state(self, start: State) -> State:
        """A state in all modes."""
        displaced, moving = (np.asarray(np.linalg.solve(self.vibration.modes, each)) for each in start)
        return displaced, moving

    def shaken(self, residual: Floats, start: State | None) -> tuple[Floats, Floats]:
        """Rates (k,) rad/s and amplitudes (n, k) at which the start, and corners and jumps of a residual (t, n), may
        make unresolved modes ring: beside a corner the second difference of the force exceeds the ring's own.
        """
        square, modes, kept = self.vibration
        rate, force = np.sqrt(square[~kept]), residual @ modes[:, ~kept]
        displaced, moving = (each[~kept] for each in self.of_state(start or self.settled(residual[0])))
        away = np.abs(displaced + force[0] / rate**2) + np.abs(moving) / rate
        return rate, modes[:, ~kept] * (np.abs(np.diff(force, n=2, axis=0)).max(axis=0) / rate**2 + away)

    def answer(self, residual: Floats, start: State | None = None) -> Correction:
        """The response to −R, (t, n), from a state, or from where bodies rest; at one time at rest."""
        if len(self.time) == 1:
            which = loose(self.k[0], self.c[0]) | self.turned
            displaced, faster = balanced(residual[0], self.k[0], self.m[0], which)
            return Correction(displaced[None], np.zeros_like(residual), faster[None])
        square, modes, kept = self.vibration
        phi, stiff = modes[:, kept], modes[:, ~kept]
        k, c, m = (phi.T @ each @ phi for each in (self.k, self.c, self.m))
        back, count = np.linalg.inv(m), len(self.time)
        c, k = back @ c, back @ k
        force = -(_between(self.at, back, self.time) @ (residual @ phi)[..., None])[..., 0]

        def matrices(t: Any) -> tuple[Floats, Floats, Floats]:
            return _between(self.at, c, t), _between(self.at, k, t), _between(self.time, force, t)

        rest = symmetric(c.mean(axis=0)), np.diag(square[kept])
        equations = LinearEquations(np.eye(phi.shape[1]), matrices, np.asarray, rest=rest)
        first, moving = (each[kept] for each in self.of_state(start or self.settled(residual[0])))
        moved = integrate(
            equations, gauss(), first, moving, step=self.interval, count=count - 1, start=float(self.time[0])
        )
        static = -residual @ (stiff / square[~kept] @ stiff.T)
        if not moved.whole:
            return Correction(*np.full((3, *static.shape), np.nan))
        return Correction(moved.q @ phi.T + static, moved.qd @ phi.T, moved.qdd @ phi.T)


def _between(at: Floats, values: Any, time: Floats) -> Floats:
    """Values (k, ...) of times (k,) at others (t,), by straight lines."""
    place = np.interp(time, at, np.arange(len(at)))
    low = np.minimum(place.astype(int), len(values) - 2)
    share = (place - low).reshape(-1, *[1] * (values.ndim - 1))
    return np.asarray(values[low] * (1 - share) + values[low + 1] * share)


class Within(NamedTuple):
    """A solution, which `less` solve, in equations with more shapes, where its unknowns are those `shared`."""

    more: Posed
    less: Posed
    shared: IntArray
    of: Trajectory

    @classmethod
    def lifted(cls, more: Posed, less: Posed, of: Trajectory, shared: IntArray | None = None) -> Within:
        """A solution of equations in others, which have unknowns of the same names, or in order those `shared`."""
        if shared is None:
            shared = np.array([more.names.index(each) for each in less.names], dtype=int)
        states = np.zeros((3, len(of.time), len(more.names)))
        for onto, each in zip(states, (of.q, of.qd, of.qdd), strict=True):
            onto[:, shared] = each
        return cls(more, less, shared, Trajectory(of.time, *states))

    def residual(self) -> Floats:
        """Residual (t, n) of the equations with more shapes, less that of the others."""
        out = []
        for some in pieces(len(self.of.time), len(self.more.names)):
            at, (more, less) = self.of.at(some), (each.inputs(some) for each in (self.more, self.less))
            left = np.array(self.more.residual(at.q, at.qd, at.qdd, more))
            # At a jump of what drives it a solution leaves something of its own.
            left[:, self.shared] -= self.less.residual(*(each[:, self.shared] for each in (at.q, at.qd, at.qdd)), less)
            out.append(left)
        return np.concatenate(out)

    def of_new(self, residual: Floats) -> Floats:
        """Part of a residual (t, n) in the new coordinates: what shapes lack; in the shared ones is what models do."""
        new = residual.copy()
        new[:, self.shared] = 0.0
        return new

    def departures(self, equations: Posed | None = None) -> Departures:
        """The linear equations of small departures from it, or by other equations in the same unknowns."""
        more = equations or self.more
        chosen = looked(len(self.of.time))
        at = self.of.at(chosen)
        elastic = np.array([".q" in name for name in self.more.names], dtype=bool)
        k, c, m = slopes(more.residual, at.q, at.qd, at.qdd, more.inputs(chosen))
        balls = [name.rpartition(".")[0] if name.endswith(PARAMETERS) else "" for name in self.more.names]
        faster = {ball for ball, each in zip(balls, at.qdd.any(axis=0), strict=True) if ball and each}
        turned = np.array([ball in faster for ball in balls], dtype=bool)
        return Departures(self.of.time, at.time, k, c, m, elastic, turned)

    def moved(self, by: Correction) -> Reading:
        """Read the solution with a correction added."""
        of = self.of
        return self.more.read(replace(of, q=of.q + by.value, qd=of.qd + by.rate, known=of.qdd + by.acceleration))
