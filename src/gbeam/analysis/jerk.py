"""How much a corner of the load makes a specimen vibrate on a centrifuge: 2020, example 4, over jerk and arm radius.

The arm's angular acceleration at a corner is a linear load along the beam, about the control point at mid-span; its
lever on the first mode is κ = g₁/f₁ − x_c, with f₁ = ∫mφ₁, g₁ = ∫m x φ₁; a step of the load by one unit swings the tip
by c₁ = f₁ φ₁(L)/ω₁². What vibrates on afterwards is the Fourier transform of the force at ω₁: its corners decide.
Each law has a leading order, a product of powers of j and R, and a next order, a complex factor of it.

- From rest, quasi-static, ω = sqrt(jt/R): α = ½ sqrt(j/(Rt)) has the transform ½ sqrt(πj/(Rω₁)) but for its phase, so
  A = c₁ κ ½ sqrt(π j ω₁/R), the √j law. The load's own kink, jt, has the transform j/ω₁², of the other sign and 3π/4
  apart in phase: a factor 1 − ρ e^{3iπ/4}, ρ = 2 sqrt(jR/π)/(κ ω₁^1.5).
- Flat (yaw-compensated), at the end of a ramp to the level a, its corner rounded by a Hann kernel K of width W. The lag
  falls from δ₀ = j √R/(2 a^1.5) to zero and α = −δ'': A = c₁ κ ω₁² δ₀ |K̂(ω₁W)|, the j√R law. But within the kernel
  the load is below a: a − j r with the rounded ramp r, r' = −s, where s falls from 1 to 0. From
  tan δ = j s √R / (2 (a − j r)^1.5)

      δ/δ₀ = s + (3/2) ε s r/W − (δ₀²/3) s³ + …,    ε = jW/a,

  whose transforms follow from those of the compact derivatives s', (r²)''' and (s³)': a factor
  1 + (3/2) ε E − (δ₀²/3) D, with E and D functions of ω₁W alone. Because K is smooth, K̂ is small (0.02 in 2020's
  example); s³ is as smooth, but its transform falls off later: |D| is 8 there. That is why the leading order drifts
  by 5 to 10 % long before ε or δ₀ are large.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray

import gbeam.arrays.jax_setup  # noqa: F401
from gbeam.analysis.response.simulation import simulate
from gbeam.analysis.study.case import ResponseSettings
from gbeam.checks import positive
from gbeam.errors import InputError
from gbeam.mechanics.assembly import Structure, rest_modes
from gbeam.mechanics.energy import rest_matrices
from gbeam.mechanics.equations import coefficients
from gbeam.motion import Base, Centrifuge, Profile, build_target, smoothed, stack, tabulated
from gbeam.numerics.time_derivative import with_rate
from gbeam.results.response import Floats

Complexes = NDArray[np.complex128]

LAWS = ("from-rest", "flat")
MOST = 0.5  # of the leading order: a correction that large is refused, since the order after it is not known
_SMALL = 0.1  # where the leading order's powers are looked for
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
    simulated, leading, predicted : (j, r)
        m: by simulation, by the law's leading order, with its next order.
    correction : (j, r)
        Size of the next order's terms, summed, over the leading order.
    """

    law: str
    jerks: Floats
    arms: Floats
    simulated: Floats
    leading: Floats
    predicted: Floats
    correction: Floats

    @property
    def error(self) -> Floats:
        """Simulated over predicted, less one, (j, r)."""
        return self.simulated / self.predicted - 1

    @property
    def exponents(self) -> tuple[float, float]:
        """Powers of j and of R that the simulated vibration goes with where the correction is below a tenth.

        Least squares over all such points; NaN where they do not differ in both.
        """
        j, r = np.nonzero(self.correction < _SMALL)
        rows = np.stack([np.ones(len(j)), np.log(self.jerks[j]), np.log(self.arms[r])], axis=1)
        found, _, rank, _ = np.linalg.lstsq(rows, np.log(self.simulated[j, r]), rcond=None)
        return (float(found[1]), float(found[2])) if rank == 3 else (np.nan, np.nan)


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
        If the law is unknown, the width missing, a number impossible, the law's next order above half its leading one,
        or the ramp so short that its two corners cannot be told apart.

    Notes
    -----
    For 2020's specimen, 10 g and 60 ms the law holds from 1 to 15 g/s and from 1.5 to 15 m.
    """
    if law not in LAWS:
        raise InputError("law", f"is {law!r}", f"choose one of {', '.join(LAWS)}")
    if law == "flat" and not smoothing:
        raise InputError("smoothing", "is missing", "a flat inverse needs rounded corners: give a width such as 0.06 s")
    j, r = np.meshgrid(
        [positive("jerks", it, "m/s³") for it in jerks], [positive("arms", it, "m") for it in arms], indexing="ij"
    )
    at = structure.length / 2 if control_point is None else control_point
    frequency, c1, lever = first_mode(structure, at)
    period, width = 2 * np.pi / frequency, smoothing or 0.0
    if law == "from-rest":
        leading, terms = c1 * lever * 0.5 * np.sqrt(np.pi * j * frequency / r), from_rest_terms(j, r, frequency, lever)
    else:
        _refuse_short(float(j.max()), level, _PERIODS * period + width)
        jump = j * np.sqrt(r) / (2 * level**1.5)
        leading = c1 * lever * frequency**2 * jump * abs(hann_transform(frequency * width))
        terms = flat_terms(j, jump, level, width, frequency)
    correction = np.sum(np.abs(terms), axis=0)
    if correction.max() > MOST:
        worst = np.unravel_index(correction.argmax(), correction.shape)
        raise InputError(
            "jerks",
            f"hold {j[worst]:.4g} m/s³ at an arm of {r[worst]:.3g} m, where the law's next order is "
            f"{correction[worst]:.0%} of its leading one",
            f"give smaller jerks or arms: the law is known up to {MOST:.0%}",
        )

    def simulate(jerk: float, arm: float) -> float:
        if law == "from-rest":
            return _from_rest(structure, jerk, arm, at, period)
        return _flat(structure, jerk, arm, at, level, width, period)

    simulated = np.vectorize(simulate, otypes=[float])(j, r)
    predicted = leading * np.abs(1 + np.sum(terms, axis=0))
    return JerkStudy(law, j[:, 0], r[0], simulated, leading, predicted, correction)


def _refuse_short(jerk: float, level: float, needed: float) -> None:
    """Refuse a ramp over half the level within which the vibration of its two corners cannot be told apart."""
    ramp = 0.5 * level / jerk
    if ramp < needed:
        problem = f"reach {jerk:.3g} m/s³, which passes half the level in {ramp:.3g} s"
        fix = f"give {0.5 * level / needed:.3g} m/s³ or less: {_PERIODS} periods must pass between the corners"
        raise InputError("jerks", problem, fix)


def from_rest_terms(j: Floats, r: Floats, frequency: float, lever: float) -> Complexes:
    """Next order of the √j law over its leading one, (1, …): the load's own kink."""
    return np.asarray(-2 * np.sqrt(j * r / np.pi) / (lever * frequency**1.5) * np.exp(0.75j * np.pi))[None]


def flat_terms(j: Floats, jump: Floats, level: float, width: float, frequency: float) -> Complexes:
    """Next order of the j√R law over its leading one, (2, …): the load below the plateau's, and tan δ against δ."""
    below, bent = corner_transforms(frequency * width)
    return np.stack([1.5 * j * width / level * below, -(jump**2) / 3 * bent])


def corner_transforms(phase: float) -> tuple[complex, complex]:
    """E and D: transforms of s r/W and of s³ over that of s, at ω from ωW.

    With u = t/W and ϱ = r/W, s r/W = −½ (ϱ²)'; the transform of f is (i/p)ⁿ times that of its n-th derivative, which
    is compact. The integrands are polynomials times harmonics on abs(u) < ½: Gauss's points leave only rounding.
    """
    nodes, weights = np.polynomial.legendre.leggauss(64)
    u, p = nodes / 2, phase
    kernel, slope = 1 + np.cos(2 * np.pi * u), -2 * np.pi * np.sin(2 * np.pi * u)
    s = 0.5 - u - np.sin(2 * np.pi * u) / (2 * np.pi)
    ramp = (0.5 - u) ** 2 / 2 - (1 + np.cos(2 * np.pi * u)) / (2 * np.pi) ** 2

    def transform(values: Floats) -> complex:
        return complex(np.sum(weights / 2 * values * np.exp(1j * p * u)))

    first = (1j / p) * transform(-kernel)
    below = -0.5 * (p / 1j) * (1j / p) ** 3 * transform(2 * ramp * slope - 6 * s * kernel)
    bent = (1j / p) * transform(-3 * s**2 * kernel)
    return below / first, bent / first


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
    response = simulate(structure, motion, settings)  # type: ignore[arg-type]  # a motion like any other
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
    rate = smoothed(tabulated(grid, np.sqrt(jerk * grid / arm)), period / 30)
    motion = _FromRest(rate, jnp.asarray(arm), jnp.asarray(at))
    t, z, w = _run(structure, motion, -period / 15, end * 0.95, period / 200)
    late = t > 2 * period
    # The beam follows the load, ∝ t, and the arm's acceleration, ∝ t^-½ with its second derivative.
    return abs(_phasor(t[late], z[late], w, (0, 1, -0.5, -2.5)))


def _flat(structure: Structure, jerk: float, arm: float, at: float, level: float, width: float, period: float) -> float:
    corner, watched = 0.5 * level / jerk, _PERIODS * period
    first, last = corner - width / 2, corner + width / 2
    start, end = first - watched, last + watched
    load = stack(z=tabulated([0.0, corner], [0.5 * level, level]))
    target = build_target(load, span=(start, end), idle=None, smoothing=width, gravity=False)
    motion = Centrifuge(target, arm, at, "flat", False)
    t, z, w = _run(structure, motion, start, end - start, period / 100)
    # The run starts on the ramp without the ramp's speed, and so with a vibration of its own: not the corner's.
    before, after = (_phasor(t[part], z[part], w, (0, 1, 2)) for part in (t < first, t > last))
    return abs(after - before)
