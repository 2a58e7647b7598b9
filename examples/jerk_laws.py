"""Vibration that a corner of the load leaves in a specimen on a centrifuge: 2020, example 4, over jerk and arm radius.

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

import numpy as np
from numpy.typing import NDArray

from gbeam import Structure

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]


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
    frequencies, modes = structure.rest
    frequency, first, c = float(frequencies[0]), modes[:, 0], structure.coefficients
    tip = float(structure.displacement(first)[-1, 2])
    f1, g1 = float(c.f_a[2] @ first), float(-c.f_al[1] @ first)
    return frequency, abs(f1 * tip) / frequency**2, abs(g1 / f1 - control_point)


def hann_transform(phase: float) -> float:
    """Fourier transform of the Hann kernel of width W at ω, from ωW: sinc(u)/(1 − u²), u = ωW/2π."""
    u = phase / (2 * np.pi)
    return 0.5 if abs(u - 1) < 1e-9 else float(np.sinc(u) / (1 - u**2))
