"""Shape functions: orthogonal, clamped and free, accurate to mode 30; quadrature exact for what it claims."""

from __future__ import annotations

from collections.abc import Callable

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gbeam.mechanics import Shapes, bar_shapes, bending_roots, bending_shapes, legendre_shapes, quadrature

L = 0.3
MODES = 30
ORTHOGONAL = 1e-11  # relative; 30 modes, 160 nodes
SPECTRAL = 1e-11  # relative to the largest value
FAMILIES = [bar_shapes, bending_shapes, legendre_shapes]
Family = Callable[[np.ndarray, float, int], Shapes]


def textbook(mode: int, x: float) -> tuple[mpmath.mpf, mpmath.mpf, mpmath.mpf]:
    """cosh βx − cos βx − σ(sinh βx − sin βx) and its derivatives (2009 below (19); 2020 (13b)), to 80 digits."""
    with mpmath.workdps(80):
        lam = mpmath.findroot(lambda z: mpmath.cos(z) * mpmath.cosh(z) + 1, (mode - 0.5) * mpmath.pi)
        sigma = (mpmath.cos(lam) + mpmath.cosh(lam)) / (mpmath.sin(lam) + mpmath.sinh(lam))
        b, z = lam / L, lam / L * x
        c, s, ch, sh = mpmath.cos(z), mpmath.sin(z), mpmath.cosh(z), mpmath.sinh(z)
        return ch - c - sigma * (sh - s), b * (sh + s - sigma * (ch - c)), b**2 * (ch + c - sigma * (sh + s))


def test_bending_roots() -> None:
    roots = bending_roots(MODES)
    np.testing.assert_allclose(
        roots[:5], [1.875104068711961, 4.694091132974175, 7.854757438237613, 10.99554073487547, 14.13716839104647],
        rtol=1e-15,
    )  # fmt: skip
    np.testing.assert_allclose(roots[-1], (MODES - 0.5) * np.pi, rtol=1e-15)
    assert np.abs(np.cos(roots) + 1 / np.cosh(roots)).max() < 1e-13
    assert (np.diff(roots) > 2.8).all()


@pytest.mark.parametrize("mode", [1, 2, 5, 12, 30])
def test_bending_shapes_equal_the_textbook_form_taken_to_80_digits(mode: int) -> None:
    x = np.array([0.0, 0.01, 0.5, 0.99, 1.0]) * L
    ours = bending_shapes(x, L, mode)
    exact = np.array([[float(v) for v in textbook(mode, at)] for at in x]).T
    for values, wanted in zip(ours, exact, strict=True):
        np.testing.assert_allclose(values[:, -1], wanted, atol=1e-13 * mode * np.abs(wanted).max())


def test_bending_shapes_are_orthogonal_with_closed_form_stiffness() -> None:
    rule = quadrature(L, 160)
    f = bending_shapes(rule.node, L, MODES)
    mass = f.value.T @ (rule.weight[:, None] * f.value) / L
    stiffness = f.curvature.T @ (rule.weight[:, None] * f.curvature)
    np.testing.assert_allclose(mass, np.eye(MODES), atol=ORTHOGONAL)
    wanted = bending_roots(MODES) ** 4 / L**3  # ∫f''² dx = λ⁴/L³
    scale = np.sqrt(np.outer(wanted, wanted))
    np.testing.assert_allclose(stiffness / scale, np.eye(MODES), atol=ORTHOGONAL)


def test_bending_shapes_are_clamped_and_free() -> None:
    root, tip = (bending_shapes(np.array([x]), L, MODES) for x in (0.0, L))
    lam = bending_roots(MODES)
    np.testing.assert_allclose(root.value, 0, atol=1e-14)
    np.testing.assert_allclose(root.slope * L / lam, 0, atol=1e-14)
    np.testing.assert_allclose(tip.curvature * L**2 / lam**2, 0, atol=1e-13)
    np.testing.assert_allclose(tip.value[0], 2 * (-1.0) ** np.arange(MODES), atol=1e-13)
    # f'''(L) = 0, from ∫x f'''' dx = L f'''(L) − f''(L) + f''(0) and f'''' = β⁴ f
    rule = quadrature(L, 160)
    first_moment = rule.weight * rule.node @ bending_shapes(rule.node, L, MODES).value
    shear = first_moment * (lam / L) ** 2 - root.curvature[0] / (lam / L) ** 2
    np.testing.assert_allclose(shear / lam**2, 0, atol=1e-14)


def test_bar_shapes_are_orthogonal_fixed_and_free() -> None:
    rule = quadrature(L, 80)
    f = bar_shapes(rule.node, L, MODES)
    np.testing.assert_allclose(f.value.T @ (rule.weight[:, None] * f.value), L * np.eye(MODES), atol=ORTHOGONAL * L)
    k = (2 * np.arange(1, MODES + 1) - 1) * np.pi / (2 * L)
    stiffness = f.slope.T @ (rule.weight[:, None] * f.slope)
    np.testing.assert_allclose(stiffness / np.outer(k, k), L * np.eye(MODES), atol=ORTHOGONAL * L)
    assert not bar_shapes(np.array([0.0]), L, MODES).value.any()
    np.testing.assert_allclose(bar_shapes(np.array([L]), L, MODES).slope / k, 0, atol=1e-13)


@pytest.mark.parametrize("family", FAMILIES)
def test_slope_and_curvature_are_derivatives(family: Family) -> None:
    rule = quadrature(L, 48, [0.1 * L, 0.4 * L])
    f = family(rule.node, L, 10)
    at_root = family(np.array([0.0]), L, 10)
    integral = rule.cumulative(rule.node)
    for rate, value, start in ((f.slope, f.value, at_root.value), (f.curvature, f.slope, at_root.slope)):
        wanted = value - start
        np.testing.assert_allclose(integral @ rate, wanted, atol=SPECTRAL * np.abs(value).max())


def test_legendre_shapes_start_at_zero_with_legendre_slopes() -> None:
    rule = quadrature(L, 20)
    assert not legendre_shapes(np.array([0.0]), L, 8).value.any()
    slope = legendre_shapes(rule.node, L, 8).slope
    gram = slope.T @ (rule.weight[:, None] * slope) * L
    np.testing.assert_allclose(gram, np.diag(1 / (2 * np.arange(8) + 1)), atol=SPECTRAL)
    np.testing.assert_allclose(legendre_shapes(np.array([L]), L, 3).value[0], [1, 0, 0], atol=1e-15)


@pytest.mark.parametrize("family", FAMILIES)
def test_no_shapes_wanted(family: Family) -> None:
    assert family(np.array([0.1, 0.2]), L, 0).value.shape == (2, 0)


def test_quadrature_is_exact_to_its_degree_in_panels() -> None:
    rule = quadrature(L, 4, [0.0, 0.1, 0.25, L, 2 * L])
    np.testing.assert_array_equal(rule.edges, [0.0, 0.1, 0.25, L])
    assert len(rule.node) == 12
    for degree in range(8):
        np.testing.assert_allclose(rule.weight @ rule.node**degree, L ** (degree + 1) / (degree + 1), rtol=1e-13)
    # a corner at a break costs nothing
    np.testing.assert_allclose(rule.weight @ np.abs(rule.node - 0.25), (0.25**2 + 0.05**2) / 2, rtol=1e-13)


@settings(max_examples=20)
@given(st.lists(st.floats(-1.0, 1.0), min_size=5, max_size=5), st.lists(st.floats(0.0, L), min_size=1, max_size=6))
def test_cumulative_is_exact_for_a_polynomial_in_each_panel(coefficients: list[float], x: list[float]) -> None:
    rule = quadrature(L, 5, [0.08, 0.2])
    p = np.polynomial.Polynomial(coefficients)
    bend = np.polynomial.Polynomial([-0.2, 1.0])

    def integrand(at: np.ndarray) -> np.ndarray:
        return p(at / L) + np.maximum(bend(at), 0)  # quartic, with a corner at the second break

    def integral(at: np.ndarray) -> np.ndarray:
        return L * p.integ(lbnd=0)(at / L) + np.maximum(bend(at), 0) ** 2 / 2

    at = np.array(x)
    np.testing.assert_allclose(rule.cumulative(at) @ integrand(rule.node), integral(at), atol=1e-14)


def test_cumulative_ends() -> None:
    rule = quadrature(L, 6, [0.1])
    np.testing.assert_allclose(rule.cumulative(np.array([0.0, 0.1, L]))[0], 0, atol=1e-16)
    np.testing.assert_allclose(rule.cumulative(np.array([L]))[0], rule.weight, rtol=1e-12)
    np.testing.assert_allclose(rule.cumulative(np.array([0.1]))[0], [*rule.weight[:6], *[0.0] * 6], atol=1e-16)
