"""Rotating beams of the literature: frequencies against speed, the stretched bar, the spin-up of a robot arm.

"Published" was transcribed from the named place, "independent" computed outside this project with formulations written
for the purpose (finite elements, transcendental equations).
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import scipy.linalg

from gbeam import (
    Beam,
    Hub,
    Material,
    Model,
    PointMass,
    ResponseSettings,
    Section,
    SmoothStep,
    Structure,
    assemble,
    simulate,
    solve_equilibrium,
)
from gbeam.analysis.equilibrium.point import linear_matrices, on_base
from gbeam.mechanics.equations.linear import Coefficients
from gbeam.motion import Base

from .test_elastica import PLANAR

# A beam of unit length, unit mass per length and unit EI: nondimensional, with EA = α², α the slenderness.
ROUNDED = 6e-4  # published values have three decimals, in places rounded twice
MODES = 15  # the clamped-free modes converge slowly at high speed


def unit_beam(slenderness: float = 1000.0, tip: float = 0.0) -> Beam:
    area, inertia, modulus = 1.0, slenderness**-2, slenderness**2
    section = Section.general(area, inertia, inertia)
    return Beam(1.0, section, Material(1.0, modulus), [PointMass(1.0, tip)])


def spinning(rate: float, axis: int, radius: float = 0.0) -> Base:
    """Steady rotation about y (axis 1) or z (axis 2)."""
    return Base(np.array([-radius * rate**2, 0.0, 0.0]), rate * np.eye(3)[axis], np.zeros(3))


@cache
def constants(counts: tuple[int, int, int], slenderness: float = 1000.0, tip: float = 0.0) -> Coefficients:
    return assemble(unit_beam(slenderness, tip), Model("FOAM", *counts)).coefficients


def frequencies(c: Coefficients, base: Base, count: int) -> np.ndarray:
    """Lowest circular frequencies of M q̈ + G q̇ + K q = 0."""
    G, K, _ = c.at(base.a_WO_B, base.w_WB_B, base.alpha_WB_B)
    return gyroscopic_frequencies(c.mass, G, K, count)


def gyroscopic_frequencies(M: np.ndarray, G: np.ndarray, K: np.ndarray, count: int) -> np.ndarray:
    n = len(M)
    rates = scipy.linalg.eigvals(
        np.block([[np.zeros((n, n)), np.eye(n)], [-K, -G]]), scipy.linalg.block_diag(np.eye(n), M)
    )
    assert np.abs(rates.real).max() < 1e-6 * np.abs(rates).max()  # stable
    return np.sort(rates.imag[rates.imag > 0])[:count]


# --- flap, Wright, Smith, Thresher, Wang (1982), J. Appl. Mech. 49(1) 197-202, hub radius 0; via Bir (2009) AIAA
#     2009-1035, Table 3a, as transcribed in SMI-Lab-Inha/pyBModes, tests/fem/test_rotating_uniform_blade.py.
#     ω and Ω in units of √(EI/(mL⁴)).

# speed: published flap 1, 2, 3; independent
UNIFORM = {
    0: ([3.516, 22.035, 61.697], [3.516015, 22.034492, 61.697214]),
    1: ([3.682, 22.181, 61.842], [3.681647, 22.181011, 61.841763]),
    2: ([4.137, 22.615, 62.273], [4.13732, 22.614922, 62.273184]),
    3: ([4.797, 23.32, 62.985], [4.797279, 23.320264, 62.984967]),
    6: ([7.36, 26.809, 66.684], [7.360373, 26.809082, 66.683914]),
    10: ([11.202, 33.64, 74.649], [11.202328, 33.640366, 74.649295]),
    12: ([13.17, 37.603, 79.615], [13.17015, 37.603112, 79.614478]),
}


@pytest.mark.parametrize("speed", UNIFORM)
def test_uniform_blade_flap(speed: float) -> None:
    published, independent = UNIFORM[speed]
    found = frequencies(constants((0, MODES, 0)), spinning(speed, axis=1), 3)
    np.testing.assert_allclose(found, published, atol=ROUNDED)
    np.testing.assert_allclose(found, independent, rtol=6e-6)
    # The exact field to second order is the same theory, and its polynomials converge faster.
    np.testing.assert_allclose(frequencies(polynomial_shapes(), spinning(speed, axis=1), 3), independent, atol=6e-7)


@cache
def polynomial_shapes() -> Coefficients:
    return assemble(unit_beam(), Model("exact", 0, 12, 0)).coefficients


# Wright et al. (1982) via Bir (2010) NREL/CP-500-47953, Table 5: tip mass m_t = mL
TIP_MASS = {
    0: ([1.557, 16.25], [1.5573, 16.25009]),
    2: ([2.67, 18.19], [2.66964, 18.19097]),
    5: ([5.522, 26.04], [5.52185, 26.04153]),
    10: ([10.49, 43.45], [10.48644, 43.45172]),
    12: ([12.48, 50.86], [12.48137, 50.85939]),
}


@pytest.mark.parametrize("speed", TIP_MASS)
def test_blade_with_tip_mass_flap(speed: float) -> None:
    """Clamped-free shapes know nothing of the tip mass and converge slowly: 15 of them."""
    published, independent = TIP_MASS[speed]
    found = frequencies(constants((0, MODES, 0), tip=1.0), spinning(speed, axis=1), 2)
    np.testing.assert_allclose(found, published, rtol=5e-4)
    np.testing.assert_allclose(found, independent, rtol=5e-5)


SOUTHWELL = [1.193336374, 6.478224864, 17.859519880]


def test_southwell_coefficients() -> None:
    """d(ω²)/d(Ω²) of flap at Ω = 0: ∫(1 − x²)/2 f'² dx over the modes at rest; the first, 1.193, is textbook.

    Another list has 1.19333, 6.47744, 17.85944, said to hold to 1e-5: 6e-6, 8e-4 and 8e-5 off. No definition that was
    tried has this pattern (rounded roots λ or σ, a secant over a finite Ω, few elements, tension constant in each
    element). The rounding of a secant over a small Ω has: 20 cubic elements and Ω = 0.01 in double precision give
    1.19441, 6.47746, 17.85925. The slope itself, by perturbation, is the
    same to nine digits by quadrature of the closed forms, by Legendre polynomials and by collocation.
    """
    c = constants((0, MODES, 0))
    slope = np.diag(c.k_ww[1, 1])[:3] / np.diag(c.mass)[:3]
    np.testing.assert_allclose(slope, SOUTHWELL, atol=1e-8)
    np.testing.assert_allclose(southwell_by_collocation(24), SOUTHWELL, atol=1e-6)
    # in the plane of rotation the spin itself softens by one
    in_plane = np.diag(c.k_ww[2, 2])[:3] / np.diag(c.mass)[:3]
    np.testing.assert_allclose(in_plane, slope - 1, atol=1e-10)


def southwell_by_collocation(n: int) -> np.ndarray:
    """Perturbation of (w'')'' − Ω² (T w')' = ω² w, T = (1 − x²)/2, collocated at n + 1 Chebyshev points."""
    k = np.arange(n + 1)
    x = np.cos(np.pi * k / n)
    c = np.where((k == 0) | (k == n), 2.0, 1.0) * (-1.0) ** k
    d = np.outer(c, 1 / c) / (x[:, None] - x + np.eye(n + 1))
    d = 2 * (d - np.diag(d.sum(axis=1)))
    at, one = (x + 1) / 2, np.eye(n + 1)  # from the tip to the root
    bending, tension, mass = d @ d @ d @ d, -d @ np.diag((1 - at**2) / 2) @ d, one.copy()
    for row, condition in ((0, (d @ d)[0]), (1, (d @ d @ d)[0]), (n - 1, d[n]), (n, one[n])):
        bending[row], tension[row], mass[row] = condition, 0.0, 0.0
    square, left, right = scipy.linalg.eig(bending, mass, left=True)
    real = np.flatnonzero(np.isfinite(square) & (np.abs(square.imag) < 1e-6 * np.abs(square)) & (square.real > 1))
    lowest = real[np.argsort(square[real].real)][:3]

    def share(matrix: np.ndarray) -> np.ndarray:
        return np.einsum("ik,ij,jk->k", left[:, lowest].conj(), matrix, right[:, lowest])

    return (share(tension) / share(mass)).real


# --- flap and chord, Hamza Cherif and Houmat, 24th ICAS 2004, Table 2 (slenderness 70), as in
#     octave-user/mboct-fem-pkg, inst/fem_tests_060.tst: chord with gyroscopic coupling to the stretch (Yoo and Shin)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("speed", "flap", "chord", "exact_chord"), [(2, 4.1373, 3.6195, 3.6186), (10, 11.2023, 4.97, 4.9484)]
)
def test_flap_and_chord_of_slenderness_70(speed: float, flap: float, chord: float, exact_chord: float) -> None:
    c = constants((6, MODES, 0), slenderness=70.0)
    assert frequencies(c, spinning(speed, axis=1), 1)[0] == pytest.approx(flap, abs=1e-4)
    assert frequencies(c, spinning(speed, axis=2), 1)[0] == pytest.approx(chord, abs=1e-4)
    # The exact beam is stretched by the rotation before it vibrates: it differs, as it should (independent).
    stretched = vibration_about_equilibrium(exact_chordwise(70.0), spinning(speed, axis=2), 1)
    assert stretched[0] == pytest.approx(exact_chord, rel=1e-4)
    assert abs(stretched[0] - chord) > 8e-4


@cache
def exact_chordwise(slenderness: float) -> Structure:
    return assemble(unit_beam(slenderness), Model("exact", *PLANAR))


def vibration_about_equilibrium(s: Structure, base: Base, count: int) -> np.ndarray:
    at = linear_matrices(on_base(s, base))
    return gyroscopic_frequencies(at.mass, at.velocity, at.stiffness, count)


# --- the rotating bar, code_aster V3.04.104 and V3.04.105: u(x) = sin ax/(a cos aL) − x, a = ω √(ρ/E)


def unit_bar() -> Beam:
    return Beam(1.0, Section.general(1.0, 1e-4, 1e-4), Material(1.0, 1.0), [PointMass(1.0, 0.0)])


@pytest.mark.parametrize("a", [0.1, 0.7])
def test_rotating_bar(a: float) -> None:
    """Centrifugal force on the displaced bar, ω²(x + u): FOAM and exact share the formula, each to its own shapes."""
    base = spinning(a, axis=2)  # unit bar with EA = 1: a = ω
    bar = unit_bar()
    tip = np.tan(a) / a - 1
    exact = assemble(bar, Model("exact", *PLANAR))
    q = solve_equilibrium(exact, base).q
    np.testing.assert_allclose(exact.displacement(q)[-1], [tip, 0, 0], atol=1e-9)

    foam = assemble(bar, Model("FOAM", 6, 1, 0))
    amplitudes = solve_equilibrium(foam, base).q[:6]
    x = (np.arange(20000) + 0.5) / 20000
    u = np.sin(a * x) / (a * np.cos(a)) - x
    k = (2 * np.arange(1, 7) - 1) * np.pi / 2
    projected = np.mean(u * np.sqrt(2) * np.sin(np.outer(k, x)), axis=1)  # the formula's own share of each shape
    np.testing.assert_allclose(amplitudes, projected, atol=1e-9)
    # without the follower term u(x) = ρω²/(2E) (xL² − x³/3): the limit of slow rotation
    linear = a**2 / 2 * (1 - 1 / 3)
    assert tip / linear == pytest.approx(1 + 0.4 * a**2, rel=0.25 * a**4)


def test_rotating_bar_on_a_hub() -> None:
    """r'' + a² r = 0 with r(0) = R and r'(L) = 1."""
    a, radius = 0.5, 0.8
    exact = assemble(unit_bar(), Model("exact", *PLANAR))
    base = spinning(a, axis=2, radius=radius)
    B = (1 / a + radius * np.sin(a)) / np.cos(a)
    tip = radius * np.cos(a) + B * np.sin(a) - radius - 1
    np.testing.assert_allclose(exact.displacement(solve_equilibrium(exact, base).q)[-1, 0], tip, atol=1e-9)


# --- straight blade of Epps and Chandra (1996) J. Am. Helicopter Soc. 41:29, as modelled by Hodges, Shang and Cesnik
#     (1995), in byuflowlab/GXBeam.jl, test/examples/rotating.jl. Inch, pound force, s.

# rpm: flap 1 to 3 measured on the blade without sweep; flap 1 to 4 of Euler and Bernoulli's beam (independent), Hz
BLADE = {
    0: ([1.4, 10.3, 27.7], [1.49, 9.32, 26.1, 51.14]),
    500: ([10.2, 25.2, 47.0], [9.19, 23.84, 44.55, 72.61]),
    750: ([14.8, 36.1, 62.9], [13.55, 34.0, 59.49, 91.81]),
}


@pytest.mark.parametrize("rpm", BLADE)
def test_straight_blade_flap(rpm: float) -> None:
    """Measured within 10 % (the scatter of the experiment), independent to the printed digit."""
    measured, independent = BLADE[rpm]
    blade = Beam(37.5, Section.rectangle(1.0, 0.063), Material(2.51e-4, 1.06e7))
    c = assemble(blade, Model("FOAM", 0, 0, 26)).coefficients
    found = frequencies(c, spinning(rpm * np.pi / 30, axis=2, radius=2.5), 4) / (2 * np.pi)
    np.testing.assert_allclose(found, independent, atol=6e-3)
    np.testing.assert_allclose(found[:3], measured, rtol=0.1)


# --- spin-up, Simo and Vu-Quoc (1988) CMAME 66:125-161, example 5.1; Kane, Ryan and Banerjee (1987)

SPIN_UP = SmoothStep(6.0, 15.0)  # ψ' of ψ = 6/15 (t²/2 + (15/2π)² (cos(2πt/15) − 1)), 6 rad/s after


@cache
def robot_arm(counts: tuple[int, int, int] = (2, 5, 0)) -> Structure:
    """EA = 2.8e7 N, EI = 1.4e4 N m², ρA = 1.2 kg/m, L = 10 m; shear (GA = 1e7 N) and rotary inertia are left out."""
    section = Section.general(4e-4, 2e-7, 2e-7)
    none = PointMass(10.0, 0.0)  # the size of 2009's beam
    return assemble(Beam(10.0, section, Material(3000.0, 7e10), [none]), Model("exact", *counts))


@pytest.mark.slow
def test_spin_up_of_the_robot_arm() -> None:
    """Peaks: published within 2 %, independent (exact beam, finite elements) within 0.05 %."""
    settings = ResponseSettings(duration=20.0, step=5e-3, residual_from=15.5)
    result = simulate(robot_arm(), Hub(radius=0.0, rate=SPIN_UP), settings)
    time, (axial, across) = result.time, result.tip[:, :2].T
    assert across.min() == pytest.approx(-0.57384, rel=5e-4)
    assert across.min() == pytest.approx(-0.5723, rel=2e-2)
    assert time[across.argmin()] == pytest.approx(6.76, abs=0.03)
    assert axial.min() == pytest.approx(-0.018823, rel=5e-4)
    assert axial.min() == pytest.approx(-0.01869, rel=2e-2)
    assert result.peaks.residual_amplitude[1] == pytest.approx(0.00365, rel=2e-3)  # printed to three digits
    turned = np.abs(np.rad2deg(np.arctan2(*across_slope(result.q))))  # of the tip's section against the root's
    assert turned.max() == pytest.approx(4.4288, rel=5e-4)
    assert turned.max() == pytest.approx(4.37, rel=2e-2)
    assert time[turned.argmax()] == pytest.approx(6.72, abs=0.03)


def across_slope(q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    s = robot_arm()
    tip = s.field.rotation(q, slice(-1, None))[:, 0]
    return tip[:, 1, 0], tip[:, 0, 0]


def test_steady_state_of_the_robot_arm() -> None:
    """At 6 rad/s: stretch tan(aL)/a − L = 5.143174550e-4 m, first in-plane frequency 4.51147 rad/s (independent)."""
    base = spinning(6.0, axis=2)
    arm = robot_arm(PLANAR)
    stretch = arm.displacement(solve_equilibrium(arm, base).q)[-1, 0]
    np.testing.assert_allclose(stretch, 5.143174550426011e-4, rtol=1e-6)
    assert vibration_about_equilibrium(arm, base, 1)[0] == pytest.approx(4.51147, rel=2e-4)
