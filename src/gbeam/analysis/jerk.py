"""How much a corner of the load makes a specimen vibrate on a centrifuge: 2020, example 4, over jerk and arm radius.

The arm's angular acceleration at a corner is a linear load along the beam, about the control point at mid-span; its
lever on the first mode is κ = g₁/f₁ − x_c, with f₁ = ∫mφ₁, g₁ = ∫m x φ₁; a step of the load by one unit swings the tip
by c₁ = f₁ φ₁(L)/ω₁².

- quasi-static from rest, ω = sqrt(jt/R): A = c₁ κ ½ sqrt(π j ω₁/R), the √j law;
- flat (yaw-compensated) at a corner smoothed by a Hann kernel K: the lag δ jumps by δ₀ = j √R/(2 a^1.5) and
  A = c₁ κ ω₁² δ₀ |K̂(ω₁)|, the j√R law.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

import gbeam._jax  # noqa: F401
from gbeam.analysis.response import respond
from gbeam.case import ResponseSettings
from gbeam.energy import rest_matrices
from gbeam.equations import coefficients
from gbeam.errors import InputError
from gbeam.model import Structure, rest_modes
from gbeam.motion import Base, Centrifuge, Profile, build_target, smoothed, stack, table
from gbeam.motion.derivative import with_rate
from gbeam.results import Floats

LAWS = ("from-rest", "flat")
_PERIODS = 6  # of the first mode, watched after the corner


@dataclass(frozen=True)
class JerkStudy:
    """Vibration of the tip over jerk and arm radius, m: simulated and by the law.

    Parameters
    ----------
    law : str
        from-rest or flat.
    jerks : (j,)
        m/s³.
    arms : (r,)
        m.
    simulated, predicted : (j, r)
        m.
    """

    law: str
    jerks: Floats
    arms: Floats
    simulated: Floats
    predicted: Floats

    @property
    def error(self) -> Floats:
        """Simulated over predicted, less one, (j, r)."""
        return self.simulated / self.predicted - 1


class _FromRest(eqx.Module):
    """A specimen across a planar arm that starts from rest: R ω² = j t, the tangential acceleration ignored.

    z points inwards and x backwards along the arm's motion, so that α × gives the load along z a slope along x.
    """

    rate: Profile
    arm: jax.Array
    control_point: jax.Array

    def base(self, t: jax.Array) -> Base:
        """Motion of the root."""
        w, al = with_rate(self.rate, jnp.asarray(t, dtype=float))
        o, x = jnp.zeros_like(w), -self.control_point
        a = jnp.stack([-self.arm * al - w**2 * x, o, self.arm * w**2 - al * x], axis=-1)
        return Base(a, jnp.stack([o, w, o], axis=-1), jnp.stack([o, al, o], axis=-1))

    @property
    def breaks(self) -> jax.Array:
        """None: the rate is smooth."""
        return self.rate.breaks


def jerk_study(
    structure: Structure,
    jerks: Sequence[float],
    arms: Sequence[float],
    *,
    law: str,
    level: float,
    control_point: float | None = None,
    smoothing: float | None = None,
) -> JerkStudy:
    """Simulate the vibration that a ramp of the load leaves at the tip, along z, and put the law beside it.

    Parameters
    ----------
    structure : Structure
        Undamped, of a linear model with bending along z.
    jerks : sequence of float
        m/s³.
    arms : sequence of float
        m.
    law : str
        ``from-rest``: the quasi-static inverse, watched on the ramp after the start. ``flat``: the yaw-compensated
        inverse, watched on the plateau after a ramp from half its level.
    level : float
        Of the plateau, m/s².
    control_point : float, optional
        From the root, m; by default mid-span.
    smoothing : float, optional
        Width of the kernel at the corner, s; needed for ``flat``.

    Raises
    ------
    InputError
        If the law is unknown, the width missing, or a number is impossible.
    """
    if law not in LAWS:
        raise InputError("law", f"is {law!r}", f"choose one of {', '.join(LAWS)}")
    if law == "flat" and not smoothing:
        raise InputError("smoothing", "is missing", "a flat inverse needs rounded corners: give a width such as 0.06 s")
    at = structure.length / 2 if control_point is None else control_point
    frequency, c1, lever = first_mode(structure, at)
    period = 2 * np.pi / frequency
    simulated, predicted = np.zeros((2, len(jerks), len(arms)))
    for i, j in enumerate(jerks):
        for k, arm in enumerate(arms):
            if law == "from-rest":
                simulated[i, k] = _from_rest(structure, j, arm, at, period)
                predicted[i, k] = c1 * lever * 0.5 * np.sqrt(np.pi * j * frequency / arm)
            else:
                assert smoothing is not None
                simulated[i, k] = _flat(structure, j, arm, at, level, smoothing, period)
                jump = j * np.sqrt(arm) / (2 * level**1.5)
                predicted[i, k] = c1 * lever * frequency**2 * jump * abs(hann_transform(frequency * smoothing))
    return JerkStudy(law, np.asarray(jerks, dtype=float), np.asarray(arms, dtype=float), simulated, predicted)


def first_mode(structure: Structure, control_point: float) -> tuple[float, float, float]:
    """ω₁ rad/s, c₁ = f₁φ₁(L)/ω₁² m per m/s², and the lever κ, m."""
    c = coefficients(structure.system)
    frequency, modes = rest_modes(*rest_matrices(structure.system.energy))
    first = modes[:, 0]
    per_q = np.asarray(jax.jacfwd(structure.displacement)(jnp.zeros(structure.size)))[-1, 2]
    f1, g1 = float(np.asarray(c.f_a)[2] @ first), float(-np.asarray(c.f_al)[1] @ first)
    return float(frequency[0]), abs(f1 * float(per_q @ first)) / float(frequency[0]) ** 2, abs(g1 / f1 - control_point)


def hann_transform(phase: float) -> float:
    """Fourier transform of the Hann kernel of width W at ω, from ωW: sinc(u)/(1 − u²), u = ωW/2π."""
    u = phase / (2 * np.pi)
    return 0.5 if abs(u - 1) < 1e-9 else float(np.sinc(u) / (1 - u**2))


def _run(
    structure: Structure, motion: object, start: float, duration: float, step: float
) -> tuple[Floats, Floats, float]:
    """Times, the tip's displacement along z, and ω₁."""
    settings = ResponseSettings(start=start, duration=duration, step=step, integrator="gauss")
    response = respond(structure, motion, settings)  # type: ignore[arg-type]  # a motion like any other
    return response.time, response.tip[:, 2], float(response.frequencies[0])


def _phasor(t: Floats, z: Floats, frequency: float, trend: tuple[float, ...]) -> complex:
    """Amplitude and phase, from t = 0, of the vibration at ω₁ beside a trend of powers of t, by least squares."""
    scale = t[-1]
    columns = [np.cos(frequency * t), np.sin(frequency * t), *((t / scale) ** power for power in trend)]
    found, *_ = np.linalg.lstsq(np.stack(columns, axis=1), z, rcond=None)
    return complex(found[0], -found[1])


def _from_rest(structure: Structure, jerk: float, arm: float, at: float, period: float) -> float:
    end = (2 + _PERIODS) * period
    # The square root begins vertically: knots graded towards zero, rounded over a thirtieth of a period.
    grid = end * np.linspace(0, 1, 2001) ** 2
    rate = smoothed(table(grid, np.sqrt(jerk * grid / arm)), period / 30)
    motion = _FromRest(rate, jnp.asarray(arm), jnp.asarray(at))
    t, z, w = _run(structure, motion, -period / 15, end * 0.95, period / 200)
    late = t > 2 * period
    # The beam follows the load, ∝ t, and the arm's acceleration, ∝ t^-½ with its second derivative.
    return abs(_phasor(t[late], z[late], w, (0, 1, -0.5, -2.5)))


def _flat(structure: Structure, jerk: float, arm: float, at: float, level: float, width: float, period: float) -> float:
    corner, watched = 0.5 * level / jerk, _PERIODS * period
    first, last = corner - width / 2, corner + width / 2
    start, end = first - watched, last + watched
    load = stack(z=table([0.0, corner], [0.5 * level, level]))
    target = build_target(load, span=(start, end), idle=None, smoothing=width, gravity=False)
    motion = Centrifuge(target, arm, at, "flat", False)
    t, z, w = _run(structure, motion, start, end - start, period / 100)
    # The run starts on the ramp without the ramp's speed, and so with a vibration of its own: not the corner's.
    before, after = (_phasor(t[part], z[part], w, (0, 1, 2)) for part in (t < first, t > last))
    return abs(after - before)
