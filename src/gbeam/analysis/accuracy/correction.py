"""Linear response of the exact model with more shapes to the residual that a solution leaves there.

Modes that the samples resolve answer in time, by Gauss's method; the others follow statically.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from gbeam.integrate.driver import integrate
from gbeam.integrate.equations import LinearEquations, LinearTerms
from gbeam.integrate.schemes import gauss
from gbeam.mechanics.equations.dalembert import FreeHub, free_hub, ground_of
from gbeam.mechanics.structure import Structure
from gbeam.motion.bases.base import Base
from gbeam.numerics.eigen import symmetric_modes
from gbeam.results.result import Floats


@dataclass(frozen=True, eq=False)
class Sampled:
    """A solution (t, n) at times (t,) in more shapes' coordinates; `hub` (t, 3) has angle, rate and acceleration."""

    time: Floats
    base: Base
    p: Floats
    pd: Floats
    pdd: Floats
    hub: Floats | None = None
    motion: Any = None
    loads: Floats | None = None

    def moved(self, d: Floats, dd: Floats, ddd: Floats) -> Sampled:
        """Add corrections (t, first + n) and their rates, of a hub's angle in the first column."""
        hub, base = self.hub, self.base
        if hub is not None:
            hub = hub + np.stack([x[:, 0] for x in (d, dd, ddd)], axis=1)
            base = self.motion.mount.base(*hub.T)
            d, dd, ddd = (x[:, 1:] for x in (d, dd, ddd))
        return Sampled(self.time, base, self.p + d, self.pd + dd, self.pdd + ddd, hub, self.motion, self.loads)


def complete_residual(structure: Structure, at: Sampled) -> Floats:
    """Residual (t, first + n) of a structure's complete equations; a free hub's row comes first."""
    if at.hub is None:
        base = at.base
        values = structure.equations.residual(at.p, at.pd, at.pdd, base.a_WO_B, base.w_WB_B, base.alpha_WB_B, at.loads)
        return np.asarray(values)
    y, yd, ydd = (np.concatenate([at.hub[:, [k]], x], axis=1) for k, x in enumerate((at.p, at.pd, at.pdd)))
    return np.asarray(structure.on_free_hub(at.motion).residual(y, yd, ydd, at.motion.torque(at.time), at.loads))


def linear_residual(structure: Structure, at: Sampled) -> Floats:
    """Residual (t, n) of a linear model's equations on the base that the solution has."""
    base = at.base
    velocity, stiffness, force = structure.coefficients.at(base.a_WO_B, base.w_WB_B, base.alpha_WB_B, at.loads)
    inside = (velocity @ at.pd[..., None] + stiffness @ at.p[..., None])[..., 0]
    return np.asarray(at.pdd @ structure.coefficients.mass + inside - force)


State = tuple[Floats, Floats]  # coordinates and rates of the beam, (n,) each
RESOLVED = 2.5  # rad between two samples: a mode that turns faster follows statically


class Operator(Protocol):
    """M (n, n), and C and K at the times of the samples; a free hub's row and column come first."""

    @property
    def mass(self) -> Floats:
        """M, (n, n)."""
        ...

    def first(self) -> Floats:
        """K at the first sample, (n, n)."""
        ...

    def mean(self) -> Floats:
        """Mean of K over the samples, (n, n)."""
        ...

    def within(self, shapes: Floats) -> tuple[Floats, Floats]:
        """C and K of some shapes (n, r) at all samples, (t, r, r) each."""
        ...


class OfFeatures(NamedTuple):
    """The operator on a prescribed base: sums over what its motion is at each time, of which no (t, n, n) is made."""

    mass: Floats
    features: Floats
    terms: LinearTerms

    def first(self) -> Floats:
        """K at the first sample."""
        return np.asarray(np.tensordot(self.features[0], self.terms.stiffness, 1))

    def mean(self) -> Floats:
        """Mean of K."""
        return np.asarray(np.tensordot(self.features.mean(axis=0), self.terms.stiffness, 1))

    def within(self, shapes: Floats) -> tuple[Floats, Floats]:
        """C and K of some shapes."""
        c, k = (
            np.tensordot(self.features, shapes.T @ each @ shapes, 1)
            for each in (self.terms.velocity, self.terms.stiffness)
        )
        return c, k


class OfSamples(NamedTuple):
    """The operator on a free hub: C and K (t, n, n) at every sample."""

    mass: Floats
    velocity: Floats
    stiffness: Floats

    def first(self) -> Floats:
        """K at the first sample."""
        return np.asarray(self.stiffness[0])

    def mean(self) -> Floats:
        """Mean of K."""
        return np.asarray(self.stiffness.mean(axis=0))

    def within(self, shapes: Floats) -> tuple[Floats, Floats]:
        """C and K of some shapes."""
        return shapes.T @ self.velocity @ shapes, shapes.T @ self.stiffness @ shapes


class Correction(NamedTuple):
    """Correction of a solution, and its first two derivatives in time, (t, n) each."""

    value: Floats
    rate: Floats
    acceleration: Floats


def operator(structure: Structure, at: Sampled) -> Operator:
    """The linear equations of small departures from a solution, their places' expansion being the straight beam's."""
    c, motion = structure.coefficients, (at.base.a_WO_B, at.base.w_WB_B, at.base.alpha_WB_B)
    if at.hub is None:
        return OfFeatures(c.mass, c.features(*motion, at.loads), c.terms)
    velocity, stiffness, _ = c.at(*motion, at.loads)
    return _hub_operator(free_hub(c, at.motion.mount, ground_of(at.motion)), at, velocity, stiffness)


def _hub_operator(hub: FreeHub, at: Sampled, velocity: Floats, stiffness: Floats) -> OfSamples:
    assert at.hub is not None
    angle, rate, acceleration = at.hub.T
    n, t = len(hub.f2), len(angle)
    swept = hub.f2 - at.p @ hub.k2
    mass = np.zeros((n + 1, n + 1))
    mass[0, 0], mass[0, 1:], mass[1:, 0], mass[1:, 1:] = hub.ground.inertia + hub.rigid, hub.b0, hub.b0, hub.mass
    c, k = np.zeros((2, t, n + 1, n + 1))
    c[:, 0, 0] = hub.ground.damping + 2 * (swept * at.pd).sum(axis=1)
    c[:, 0, 1:] = 2 * rate[:, None] * swept + at.pd @ (hub.b1 + hub.b1.T).T
    c[:, 1:, 0] = -2 * rate[:, None] * swept + at.pd @ hub.gyroscopic.T
    c[:, 1:, 1:], k[:, 1:, 1:] = velocity, stiffness
    k[:, 0, 0] = hub.ground.stiffness
    k[:, 0, 1:] = 2 * acceleration[:, None] * swept + at.pdd @ hub.b1 - 2 * rate[:, None] * (at.pd @ hub.k2)
    if hub.weight is not None:
        w, (x, y, _) = hub.weight, hub.weight.gravity
        cos, sin, o = np.cos(angle), np.sin(angle), np.zeros(t)
        turned = np.stack([-sin * x + cos * y, -cos * x - sin * y, o], axis=1) @ w.R_HB  # ∂g/∂θ, base axes
        e = w.R_HB[2]
        k[:, 0, 0] -= turned @ np.cross(e, w.s0)
        k[:, 1:, 0] -= turned @ w.s1
        k[:, 0, 1:] -= turned @ w.s1
    return OfSamples(mass, c, k)


class Vibration(NamedTuple):
    """Modes (n, n), columns of unit length in M, about a solution's mean stiffness, and which its samples resolve."""

    square: Floats
    modes: Floats
    resolved: NDArray[np.bool_]

    @staticmethod
    def of(equations: Operator, time: Floats) -> Vibration:
        """Modes of equations at equal intervals of time (t,) s."""
        mean = equations.mean()
        square, modes = symmetric_modes((mean + mean.T) / 2, equations.mass)
        if square[0] < -1e-9 * square[-1]:
            rest = equations.first()
            square, modes = symmetric_modes((rest + rest.T) / 2, equations.mass)
        resolved = np.sqrt(np.maximum(square, 0)) * _interval(time) < RESOLVED
        resolved[:2] = True
        return Vibration(square, modes, resolved)

    def shaken(self, of: Operator, residual: Floats, start: State) -> tuple[Floats, Floats]:
        """Rates (k,) rad/s and amplitudes (n, k) at which the start, and corners and jumps of a residual (t, n), may
        make unresolved modes ring: beside a corner the second difference of the force exceeds the ring's own.
        """
        fast = ~self.resolved
        rate, force = np.sqrt(self.square[fast]), residual @ self.modes[:, fast]
        displaced, moving = (each[fast] for each in self.of_state(of, start))
        away = np.abs(displaced + force[0] / rate**2) + np.abs(moving) / rate
        return rate, self.modes[:, fast] * (np.abs(np.diff(force, n=2, axis=0)).max(axis=0) / rate**2 + away)

    def of_state(self, of: Operator, start: State) -> State:
        """A state of the beam in all modes; a free hub is held."""
        beam = slice(len(self.modes) - len(start[0]), None)
        displaced, moving = (self.modes.T @ of.mass[:, beam] @ each for each in start)
        return displaced, moving


def responses(of: Operator, vibration: Vibration, time: Floats) -> Callable[[Floats, State], Correction]:
    """The linear response to −R, (t, n), as a function of R (t, n) and of the initial state."""
    square, modes, kept = vibration
    step = _interval(time)
    phi, stiff = modes[:, kept], modes[:, ~kept]
    flexibility = stiff / square[~kept] @ stiff.T
    c, k = of.within(phi)
    damping = c.mean(axis=0)
    rest = (damping + damping.T) / 2, np.diag(square[kept])

    def drive(t: Any) -> Any:
        place = np.clip((t - time[0]) / step, 0, len(time) - 1)
        before = np.minimum(place.astype(int), len(time) - 2)
        return before, place - before

    def correction(residual: Floats, start: State) -> Correction:
        force = -residual @ phi
        first, moving = (each[kept] for each in vibration.of_state(of, start))

        def matrices(at: Any) -> tuple[Floats, Floats, Floats]:
            before, share = at

            def between(x: Floats) -> Floats:
                weight = share.reshape(-1, *[1] * (x.ndim - 1))
                return x[before] * (1 - weight) + x[before + 1] * weight

            return between(c), between(k), between(force)

        equations = LinearEquations(np.eye(phi.shape[1]), matrices, drive, rest=rest)
        trajectory = integrate(equations, gauss(), first, moving, step=step, count=len(time) - 1, start=float(time[0]))
        static = -residual @ flexibility
        if not trajectory.whole:
            return Correction(*np.full((3, *static.shape), np.nan))
        return Correction(trajectory.q @ phi.T + static, trajectory.qd @ phi.T, trajectory.qdd @ phi.T)

    return correction


def _interval(time: Floats) -> float:
    return float(time[-1] - time[0]) / (len(time) - 1)
