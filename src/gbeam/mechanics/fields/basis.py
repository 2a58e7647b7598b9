"""Shape functions along the beam and their derivatives, free of cosh cancellation; quadrature along the beam."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from gbeam.arrays.types import Floats


class Shapes(NamedTuple):
    """Shape functions at positions: value, slope, curvature (derivatives with respect to x), each (points, shapes)."""

    value: Floats
    slope: Floats
    curvature: Floats


Family = Callable[[Floats], Shapes]
Counts = tuple[int, int, int, int, int, int]
FAMILIES = ("axial", "y", "z", "twist", "shear_y", "shear_z")  # of shapes, as the coordinates come
# Of the axial displacement, those along y and z, the twist, and the displacements by shear along y and z.
Families = tuple[Family, Family, Family, Family, Family, Family]


def joined_family(family: Family, added: Family) -> Family:
    """Return the family of the shapes of two."""

    def both(x: Floats) -> Shapes:
        return Shapes(*(np.concatenate(pair, axis=1) for pair in zip(family(x), added(x), strict=True)))

    return both


def bar_shapes(x: Floats, length: float, count: int) -> Shapes:
    """Fixed-free bar shapes √2 sin((2i−1)πx/2L), ∫f² dx = L (2020 (13a), corrected: its root covers the sine)."""
    k = (2 * np.arange(1, count + 1) - 1) * np.pi / (2 * length)
    phase = np.outer(x, k)
    return Shapes(np.sqrt(2) * np.sin(phase), np.sqrt(2) * k * np.cos(phase), -np.sqrt(2) * k**2 * np.sin(phase))


@cache
def bending_roots(count: int) -> Floats:
    """Roots λ of cos λ + 1/cosh λ = 0, ascending: the clamped-free beam's; read only."""
    guess = (np.arange(1, count + 1) - 0.5) * np.pi
    # The root leaves (i − ½)π by about 2 e^{−λ}, alternately up and down.
    root = guess - 2 * (-1.0) ** np.arange(1, count + 1) * np.exp(-guess)
    for _ in range(8):  # Newton's method
        sech = 2 * np.exp(-root) / (1 + np.exp(-2 * root))
        root = root - (np.cos(root) + sech) / (-np.sin(root) - sech * np.tanh(root))
    root.flags.writeable = False
    return root


def bending_shapes(x: Floats, length: float, count: int) -> Shapes:
    """Clamped-free shapes cosh βx − cos βx − σ(sinh βx − sin βx) with ∫f² dx = L.

    They are written by decaying exponentials, which do not cancel: c/2 e^{β(x−L)} + (1+σ)/2 e^{−βx} − cos βx + σ sin
    βx, c = (1−σ) e^{λ}.
    """
    lam = bending_roots(count)
    beta = lam / length
    exp_lam = np.exp(-lam)
    den = 1 - exp_lam**2 + 2 * exp_lam * np.sin(lam)
    sigma = (1 + exp_lam**2 + 2 * exp_lam * np.cos(lam)) / den
    half_c = (np.sin(lam) - np.cos(lam) - exp_lam) / den
    phase = np.outer(x, beta)
    growing = half_c * np.exp(phase - lam)
    decaying = (1 + sigma) / 2 * np.exp(-phase)
    sine, cosine = np.sin(phase), np.cos(phase)
    return Shapes(
        growing + decaying - cosine + sigma * sine,
        beta * (growing - decaying + sine + sigma * cosine),
        beta**2 * (growing + decaying + cosine - sigma * sine),
    )


def legendre_shapes(x: Floats, length: float, count: int) -> Shapes:
    """Integrated Legendre shapes ∫₀ˣ P_k(2s/L − 1) ds/L, k = 0 … count−1: zero at the root, slopes polynomials."""
    xi = 2 * np.asarray(x) / length - 1
    values, slopes, curvatures = np.zeros((3, len(xi), count))
    for k in range(count):
        p = legendre.Legendre.basis(k)
        values[:, k] = p.integ(lbnd=-1)(xi) / 2
        slopes[:, k] = p(xi) / length
        curvatures[:, k] = p.deriv()(xi) * 2 / length**2
    return Shapes(values, slopes, curvatures)


def legendre_bending(x: Floats, length: float, count: int) -> Shapes:
    """Shapes whose slopes are the integrated Legendre shapes: polynomials, zero with their slopes at the root."""
    turn = legendre_shapes(x, length, count)
    xi = 2 * np.asarray(x) / length - 1
    value = [legendre.Legendre.basis(k).integ(2, lbnd=-1)(xi) * length / 4 for k in range(count)]
    return Shapes(np.stack(value, axis=-1) if count else turn.value, turn.value, turn.slope)


def closed_forms(length: float, counts: Counts) -> Families:
    """Families of the bare uniform beam: fixed-free bar and clamped-free bending shapes, Legendre's in
    twist and shear.
    """

    def family(shapes: Callable[[Floats, float, int], Shapes], count: int) -> Family:
        return lambda x: shapes(x, length, count)

    axial, along_y, along_z, twist, shear_y, shear_z = counts
    bending = family(bending_shapes, along_y), family(bending_shapes, along_z)
    strains = family(legendre_shapes, twist), family(legendre_shapes, shear_y), family(legendre_shapes, shear_z)
    return family(bar_shapes, axial), *bending, *strains


def between_corners(x: Floats, edges: Sequence[float], count: int) -> Floats:
    """Legendre polynomials between corners, (points, count): the constants of all pieces, then the next degree of all.

    Each is zero outside its piece.
    """
    pieces, values = len(edges) - 1, np.zeros((len(x), count))
    piece_of_point = np.searchsorted(edges[1:-1], x)
    for k in range(count):
        degree, piece = divmod(k, pieces)
        low, high = edges[piece : piece + 2]
        values[piece_of_point == piece, k] = legendre.Legendre.basis(degree, domain=[low, high])(
            x[piece_of_point == piece]
        )
    return values


def polynomials(length: float, counts: Counts, corners: Sequence[float] = ()) -> Families:
    """Legendre polynomials as strains, twist and curvatures of the exact field, in pieces between the `corners`."""
    if corners:

        def broken(count: int, scale: float) -> Family:
            def shapes(x: Floats) -> Shapes:
                values = scale * between_corners(x, [0.0, *corners, length], count)
                return Shapes(np.full_like(values, np.nan), values, values)  # slope or curvature, as the family has it

            return shapes

        scales = (1.0, 1 / length, 1 / length, 1 / length, 1.0, 1.0)
        s, v, w, t, a, b = (broken(count, scale) for count, scale in zip(counts, scales, strict=True))
        return s, v, w, t, a, b

    def strain(count: int) -> Family:
        return lambda x: Shapes(*(length * part for part in legendre_shapes(x, length, count)))

    def turn(count: int) -> Family:
        return lambda x: legendre_shapes(x, length, count)

    def curvature(count: int) -> Family:
        return lambda x: legendre_bending(x, length, count)

    axial, along_y, along_z, twist, shear_y, shear_z = counts
    bending = curvature(along_y), curvature(along_z)
    return strain(axial), *bending, turn(twist), strain(shear_y), strain(shear_z)


class Quadrature(NamedTuple):
    """Gauss-Legendre nodes (g,) m and weights (g,) m over the beam, in panels with the given edges."""

    node: Floats
    weight: Floats
    edges: Floats

    def cumulative(self, x: Floats) -> Floats:
        """Matrix (points, g) that integrates nodal values from the root to each x, spectrally in each panel."""
        return self._matrix(x, integrate=True)

    def interpolation(self, x: Floats) -> Floats:
        """Matrix (points, g) that interpolates nodal values at each x by the polynomial of its panel."""
        return self._matrix(x, integrate=False)

    def _matrix(self, x: Floats, *, integrate: bool) -> Floats:
        """Matrix (points, g) of :meth:`cumulative` or :meth:`interpolation`, by Legendre series in each panel."""
        per_panel = len(self.node) // (len(self.edges) - 1)
        to_coefficients = _operator(per_panel, integrate=integrate)
        panel = np.clip(np.searchsorted(self.edges, x, side="left") - 1, 0, len(self.edges) - 2)
        low, high = self.edges[panel], self.edges[panel + 1]
        in_panel = legendre.legvander(2 * (x - low) / (high - low) - 1, per_panel) @ to_coefficients
        node_panel = np.arange(len(self.node)) // per_panel
        matrix = np.zeros((len(x), len(self.node)))
        matrix[node_panel == panel[:, None]] = (
            in_panel * ((high - low) / 2)[:, None] if integrate else in_panel
        ).ravel()
        if integrate:  # panels before the point's count whole
            return np.where(node_panel < panel[:, None], self.weight, matrix)
        return matrix


@cache
def _gauss(nodes: int) -> tuple[Floats, Floats]:
    """Gauss-Legendre nodes and weights on [−1, 1]."""
    return legendre.leggauss(nodes)


@cache
def _operator(nodes: int, *, integrate: bool) -> Floats:
    """Matrix from values at Gauss-Legendre nodes on [−1, 1] to the Legendre coefficients of their polynomial, or of its
    integral from −1.
    """
    xi, _ = _gauss(nodes)
    to_coefficients = np.linalg.inv(legendre.legvander(xi, nodes - 1))
    if not integrate:
        return np.concatenate([to_coefficients, np.zeros((1, nodes))])
    return np.asarray(legendre.legint(to_coefficients, lbnd=-1))


def quadrature(length: float, per_panel: int, breaks: Sequence[float] = ()) -> Quadrature:
    """Gauss-Legendre rule on [0, length], `per_panel` nodes between neighbouring `breaks` (corners of the section)."""
    slack = 1e-9 * length
    inner: list[float] = []
    for b in sorted(breaks):
        if slack < b < length - slack and (not inner or b - inner[-1] > slack):
            inner.append(b)
    edges = np.array([0.0, *inner, length])
    xi, w = _gauss(per_panel)
    half = np.diff(edges)[:, None] / 2
    return Quadrature((edges[:-1, None] + half * (xi + 1)).ravel(), (half * w).ravel(), edges)
