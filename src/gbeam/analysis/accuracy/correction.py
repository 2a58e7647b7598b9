"""Solutions put into equations with more shapes, their residuals there, and the small departures that cancel these.

Modes that the samples resolve answer in time, by Gauss's method. The others follow statically.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gbeam.arrays.types import Flags, Floats, Indices
from gbeam.integrate.driver import integrate
from gbeam.integrate.equations import LinearEquations, Trajectory, slopes
from gbeam.integrate.schemes import gauss
from gbeam.numerics.balance import balanced, loose
from gbeam.numerics.eigen import UNSYMMETRIC, positive_definite, symmetric, symmetric_modes

IntArray = NDArray[np.int_]
Quantity = tuple[str, str]  # a body or "", and the name of what is read: deflection, force, moment, stress, place
Reading = Mapping[Quantity, Floats]  # over time, (t, ...)
State = tuple[Floats, Floats]  # coordinates and rates, (n,) each
PLACE: Quantity = ("", "place")
LOADS = "force", "moment", "stress"  # of a body, whose errors are estimated
DEFLECTION = "deflection"  # of a body, relative to its root
MOVED = PLACE[1], DEFLECTION  # whose peaks are not judged apart
LOOKED = 61  # times at which M, C and K are found; between them they are straight lines
RESOLVED = 2.5  # rad between two samples: a mode that turns faster follows statically
PARAMETERS = tuple(f".e{k}" for k in range(4))  # ends of the names of a ball's unknowns
AT_ONCE = 20_000  # numbers of a state's frames computed together, times coordinates


def pieces(count: int, size: int) -> list[slice]:
    """Slices of `count` times, so short that all frames of a tree of `size` coordinates at one slice fit in memory."""
    step = max(1, AT_ONCE // max(size, 1))
    return [slice(first, first + step) for first in range(0, count, step)]


def matrix_times(count: int) -> IntArray:
    """Indices of the `LOOKED` out of `count` times at which M, C and K are computed."""
    return np.unique(np.linspace(0, count - 1, min(count, LOOKED)).astype(int))


class Posed(NamedTuple):
    """Equations of motion at the times of a solution: residual(q, q̇, q̈, inputs), and the inputs at an index or slice
    of the times.

    `names` are those of the unknowns (`body.q1` of a body's shapes). `read` reads a trajectory over those times that
    have some indices, and `sizes` gives the sizes (t, k) that a small departure has to first order.
    """

    residual: Any
    inputs: Callable[[Any], Any]
    names: Sequence[str]
    read: Callable[[Trajectory, Indices], Reading]
    sizes: Callable[[Correction], Floats]

    @property
    def bodies(self) -> list[str]:
        """For each unknown the name of the body whose shape it is, or "" for those of joints."""
        return [name.rpartition(".q")[0] for name in self.names]


class Correction(NamedTuple):
    """Correction of a solution, and its first two derivatives in time, (t, n) each."""

    value: Floats
    rate: Floats
    acceleration: Floats

    def minus(self, other: Correction) -> Correction:
        """This correction minus another."""
        return Correction(*(a - b for a, b in zip(self, other, strict=True)))

    def select(self, times: Indices) -> Correction:
        """Return the correction at indices of its times."""
        return Correction(*(history[times] for history in self))


class Vibration(NamedTuple):
    """Squares of frequencies, rad²/s², and modes (n, n), columns of unit modal mass, of a solution's mean equations;
    `resolved` flags the modes that its samples are close enough to follow.
    """

    square: Floats
    modes: Floats
    resolved: Flags


@dataclass(frozen=True, eq=False)
class Departures:
    """Linear equations of small departures from a solution at equally spaced times: K, C and M (k, n, n) at the times
    `at`.

    `elastic` flags the unknowns of bodies (n,), `turned` those of balls with an angular acceleration.
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
        """Time between two samples, s."""
        return float(self.time[-1] - self.time[0]) / (len(self.time) - 1)

    @property
    def unheld(self) -> Flags:
        """Flags (n,) of all unknowns, or, where joints have Euler parameters, of those of bodies."""
        mass = self.m.mean(axis=0)
        return self.elastic | (np.abs(mass - mass.T).max() <= UNSYMMETRIC * np.abs(mass).max())

    @property
    def inert(self) -> bool:
        """True if every motion has kinetic energy. One of second order in what bends may leave some without."""
        free = self.unheld
        return positive_definite(self.m[:, free][..., free])

    @cached_property
    def vibration(self) -> Vibration:
        """Modes of the mean K and M, or of the first K if unstable. Joints with Euler parameters are held."""
        mass, square, modes = self.m.mean(axis=0), np.zeros(len(self.elastic)), np.eye(len(self.elastic))
        free = self.unheld
        inside = np.ix_(free, free)
        for k in (self.k.mean(axis=0), self.k[0]):
            square[free], modes[inside] = symmetric_modes(symmetric(k[inside]), symmetric(mass[inside]))
            if square[free][0] >= -1e-9 * square.max():
                break
        resolved = np.sqrt(np.maximum(square, 0)) * self.interval < RESOLVED
        resolved[np.argsort(square)[:2]] = True
        return Vibration(square, modes, resolved)

    def stiffer(self, stiffness: Floats) -> Departures:
        """Departures with more stiffness (n, n)."""
        return replace(self, k=self.k + stiffness)

    def settled(self, residual: Floats, bent: Flags | None = None, accelerated: Flags | None = None) -> State:
        """Departure at rest that balances a residual (n,).

        Unknowns that are `bent`, by default those of bodies, are displaced. Those that are `accelerated`, by default
        those of joints, take up the residual by their inertia. The others are held.
        """
        bent = self.elastic if bent is None else bent
        accelerated = ~bent if accelerated is None else accelerated
        active = np.flatnonzero(bent | accelerated)
        inside, change = np.ix_(active, active), np.zeros_like(residual)
        # Unknowns of the linear system are displacements where bent, accelerations elsewhere.
        change[active] = np.linalg.solve(np.where(bent, self.k[0], self.m[0])[inside], -residual[active])
        return np.where(bent, change, 0.0), np.zeros_like(residual)

    def modal_state(self, start: State) -> State:
        """Modal coordinates and rates (n,) of a state."""
        displaced, velocity = (np.asarray(np.linalg.solve(self.vibration.modes, values)) for values in start)
        return displaced, velocity

    def ringing(self, residual: Floats, start: State | None) -> tuple[Floats, Floats]:
        """Frequencies (k,) rad/s of the unresolved modes, and bounds (n, k) of the amplitudes of their free vibration.

        The start, and corners and jumps of a residual (t, n), excite it. The second difference of the modal force at a
        corner bounds its part.
        """
        square, modes, kept = self.vibration
        rate, force = np.sqrt(square[~kept]), residual @ modes[:, ~kept]
        displaced, velocity = (values[~kept] for values in self.modal_state(start or self.settled(residual[0])))
        by_start = np.abs(displaced + force[0] / rate**2) + np.abs(velocity) / rate
        by_corners = np.abs(np.diff(force, n=2, axis=0)).max(axis=0) / rate**2
        return rate, modes[:, ~kept] * (by_corners + by_start)

    def answer(self, residual: Floats, start: State | None = None) -> Correction:
        """Correction that cancels a residual (t, n), from an initial departure, by default that of bodies at rest.

        For a solution of one time it is the static one.
        """
        if len(self.time) == 1:
            which = loose(self.k[0], self.c[0]) | self.turned
            displaced, faster = balanced(residual[0], self.k[0], self.m[0], which)
            return Correction(displaced[None], np.zeros_like(residual), faster[None])
        square, modes, kept = self.vibration
        phi, stiff = modes[:, kept], modes[:, ~kept]
        k, c, m = (phi.T @ matrices @ phi for matrices in (self.k, self.c, self.m))
        inverse, count = np.linalg.inv(m), len(self.time)
        c, k = inverse @ c, inverse @ k
        force = -(_interpolate(self.at, inverse, self.time) @ (residual @ phi)[..., None])[..., 0]

        def matrices(t: Any) -> tuple[Floats, Floats, Floats]:
            return _interpolate(self.at, c, t), _interpolate(self.at, k, t), _interpolate(self.time, force, t)

        rest = symmetric(c.mean(axis=0)), np.diag(square[kept])
        equations = LinearEquations(np.eye(phi.shape[1]), matrices, np.asarray, rest=rest)
        first, rate = (values[kept] for values in self.modal_state(start or self.settled(residual[0])))
        moved = integrate(
            equations, gauss(), first, rate, step=self.interval, count=count - 1, start=float(self.time[0])
        )
        static = -residual @ (stiff / square[~kept] @ stiff.T)  # of the modes that samples do not resolve
        if not moved.reached_end:
            return Correction(*np.full((3, *static.shape), np.nan))
        return Correction(moved.q @ phi.T + static, moved.qd @ phi.T, moved.qdd @ phi.T)


def _interpolate(known_time: Floats, values: Any, time: Floats) -> Floats:
    """Interpolate values (k, ...) at the times `known_time` (k,) linearly to other times (t,)."""
    place = np.interp(time, known_time, np.arange(len(known_time)))
    low = np.minimum(place.astype(int), len(values) - 2)
    share = (place - low).reshape(-1, *[1] * (values.ndim - 1))
    return np.asarray(values[low] * (1 - share) + values[low + 1] * share)


class Embedding(NamedTuple):
    """A solution of the equations `simpler`, as a `trajectory` of the equations `richer`, which have more shapes.

    `shared` are the indices of its unknowns among theirs.
    """

    richer: Posed
    simpler: Posed
    shared: IntArray
    trajectory: Trajectory

    @classmethod
    def lifted(cls, richer: Posed, simpler: Posed, solution: Trajectory, shared: IntArray | None = None) -> Embedding:
        """Put a solution into richer equations, whose unknowns have its names, or have it at the indices `shared`."""
        if shared is None:
            shared = np.array([richer.names.index(name) for name in simpler.names], dtype=int)
        states = np.zeros((3, len(solution.time), len(richer.names)))
        for state, values in zip(states, (solution.q, solution.qd, solution.qdd), strict=True):
            state[:, shared] = values
        return cls(richer, simpler, shared, Trajectory(solution.time, *states))

    def residual(self) -> Floats:
        """Residual (t, n) of the solution in the `richer` equations, minus that in its own."""
        parts = pieces(len(self.trajectory.time), len(self.richer.names))
        return np.concatenate([self._residual_at(times, self.trajectory.select(times)) for times in parts])

    def held_residual(self, accelerated: Flags) -> Floats:
        """Residual (n,) at the start if only the unknowns that are `accelerated` had an acceleration."""
        first = self.trajectory.select(slice(1))
        return self._residual_at(slice(1), replace(first, known=np.where(accelerated, first.qdd, 0.0)))[0]

    def _residual_at(self, times: slice, states: Trajectory) -> Floats:
        """Residual (t, n) of states at a slice of the times, without the one in the solution's own equations.

        The solution has one of its own where inputs jump.
        """
        residual = np.array(self.richer.residual(states.q, states.qd, states.qdd, self.richer.inputs(times)))
        state = (values[:, self.shared] for values in (states.q, states.qd, states.qdd))
        residual[:, self.shared] -= self.simpler.residual(*state, self.simpler.inputs(times))
        return residual

    def new_part(self, residual: Floats) -> Floats:
        """Part of a residual (..., n) in the new coordinates, which too few shapes leave. The rest is the model's."""
        new = residual.copy()
        new[..., self.shared] = 0.0
        return new

    def departures(self, equations: Posed | None = None) -> Departures:
        """Linear equations of small departures from the solution, by the `richer` or by other `equations`."""
        richer = equations or self.richer
        chosen = matrix_times(len(self.trajectory.time))
        state = self.trajectory.select(chosen)
        elastic = np.array([".q" in name for name in self.richer.names], dtype=bool)
        k, c, m = slopes(richer.residual, state.q, state.qd, state.qdd, richer.inputs(chosen))
        balls = [name.rpartition(".")[0] if name.endswith(PARAMETERS) else "" for name in self.richer.names]
        faster = {ball for ball, accelerated in zip(balls, state.qdd.any(axis=0), strict=True) if ball and accelerated}
        turned = np.array([ball in faster for ball in balls], dtype=bool)
        return Departures(self.trajectory.time, state.time, k, c, m, elastic, turned)

    def read(self, times: Indices) -> Reading:
        """Read the solution in the `richer` equations at indices of its times."""
        return self.richer.read(self.trajectory.select(times), times)

    def read_corrected(self, correction: Correction, times: Indices) -> Reading:
        """Read the solution with a correction added, at indices of its times."""
        state, change = self.trajectory.select(times), correction.select(times)
        corrected = replace(
            state, q=state.q + change.value, qd=state.qd + change.rate, known=state.qdd + change.acceleration
        )
        return self.richer.read(corrected, times)
