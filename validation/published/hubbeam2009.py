"""The hub, beam and tip mass of the 2009 paper, and its equations as they should have been printed.

Built from numpy alone, with the textbook's shape functions: nothing of gbeam is used here.

Errata of the paper (from a scan: an erratum may be the scan's or the print's; either way the form used here is right)

 1  captions of Tables 2 and 3 are swapped (2 holds frequencies, 3 holds Q_θ); Table 3's torques read "50 100 200 400"
 2  Table 2 gives ω/(2·3.14), not ω/2π: all 15 values are 0.0507 % high
 3  "2.62 N m … about 6.5 % of τ" is 0.655 %
 4  (12), (36), (37): T holds two gyroscopic cubic terms, 2ω[(q₂ᵀSq̇₂) f₂q₂ − ½(q₂ᵀSq₂) f₂q̇₂]; the text shows one
 5  (37) counts an acceleration term twice: it belongs to ΔM_θ2
 6  (38): the signs inside are ΔQ₁ = <f₁ᵀ(q̇₂ᵀSq̇₂ + q₂ᵀSq̈₂ − ω² q₂ᵀSq₂/2)>; prefactors of (34), (38), (39) illegible
 7  (24)–(39): M_12 = 0 holds for FOAM only; CFOAM has ΔM_12 and ΔM_22
 8  (26): M_θ1 = −(R q₂)ᵀ; (32), (A9) need the factor 2ω; (A6) is −m_t f₁ᵀf₂
 9  (A1)–(A10): every quantity of the tip mass is taken at l, S(l) and r_A + l included
10  (12) "r₀ + x" is r_A + x; (9) m_t is a mass; section 4.4 "Fig. 4 (3 rad/s)" is Fig. 5
11  critical speed "1.91" for 0.5 kg is 1.94 (1.91 belongs to 0.525 kg); it does not depend on r_A
12  "the end mass stiffens FOAM": true of the eigenvalues of K only; the frequencies fall
13  "TLAM at 2 rad/s almost the same as FOAM": 22 % apart in the peak
14  "diverges above 3 rad/s" against its own critical 2.91 rad/s
15  two different SFOAMs: (40) derived from FOAM, and one "without Q_θ", which conserves nothing
16  CFOAM is not more accurate than FOAM
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

Array = NDArray[np.float64]

# Table 1
LENGTH, DENSITY, AREA = 8.0, 2766.7, 7.2968e-5
YOUNG, INERTIA = 6.8952e10, 8.2189e-9
HUB_INERTIA, HUB_RADIUS = 200.0, 0.5


def axial_shapes(x: Array, count: int) -> tuple[Array, Array]:
    """√2 sin((2i−1)πx/2L) and slopes."""
    k = (2 * np.arange(1, count + 1) - 1) * np.pi / (2 * LENGTH)
    return np.sqrt(2) * np.sin(np.outer(x, k)), np.sqrt(2) * k * np.cos(np.outer(x, k))


def bending_shapes(x: Array, count: int) -> tuple[Array, Array]:
    """The printed form, good to 5e-12 for four modes, and slopes."""
    lam = np.array([brentq(lambda z: np.cos(z) * np.cosh(z) + 1, (i - 0.9) * np.pi, (i - 0.1) * np.pi, xtol=1e-14)
                    for i in range(1, count + 1)])  # fmt: skip
    beta, sigma = lam / LENGTH, (np.cosh(lam) + np.cos(lam)) / (np.sinh(lam) + np.sin(lam))
    z = np.outer(x, beta)
    value = np.cosh(z) - np.cos(z) - sigma * (np.sinh(z) - np.sin(z))
    return value, beta * (np.sinh(z) + np.sin(z) - sigma * (np.cosh(z) - np.cos(z)))


@dataclass(frozen=True)
class Paper:
    """Equations M(q) q̈ + h = (τ, 0, 0) for n1 axial and n2 bending shapes and a mass `mt` at `l`.

    The particles are Gauss points of the beam and the tip mass: every integral of the paper is a sum over them.
    """

    n1: int
    n2: int
    mt: float = 0.0
    l: float = LENGTH

    def __post_init__(self) -> None:
        xi, weight = np.polynomial.legendre.leggauss(60)
        x = np.append((xi + 1) * LENGTH / 2, self.l)
        mass = np.append(weight * LENGTH / 2 * DENSITY * AREA, self.mt)
        f1, f2 = axial_shapes(x, self.n1)[0], bending_shapes(x, self.n2)[0]
        S = np.empty((len(x), self.n2, self.n2))
        for k, end in enumerate(x):  # S(x) = ∫₀ˣ f₂'ᵀ f₂' dσ
            slope = bending_shapes((xi + 1) * end / 2, self.n2)[1]
            S[k] = slope.T @ (weight[:, None] * end / 2 * slope)
        values = dict(mass=mass, x=x, f1=f1, f2=f2, S=S)
        for name, value in values.items():
            object.__setattr__(self, name, value)

    @property
    def stiffness(self) -> tuple[Array, Array]:
        """K1 = EA L k², K2 = EI λ⁴/L³."""
        k = (2 * np.arange(1, self.n1 + 1) - 1) * np.pi / (2 * LENGTH)
        lam = np.array([1.875104068711961, 4.694091132974175, 7.854757438237613, 10.99554073487547])[: self.n2]
        return np.diag(YOUNG * AREA * LENGTH * k**2), np.diag(YOUNG * INERTIA * lam**4 / LENGTH**3)

    def total(self, integrand: Array) -> Array:
        """<·> = ∫ρA · dx + m_t (·)|_l."""
        return np.einsum("k,k...->...", self.mass, integrand)

    def parts(self, y: Array) -> tuple[float, Array, Array]:
        return y[0], y[1 : 1 + self.n1], y[1 + self.n1 :]

    def first_order(self, y: Array, yd: Array, foreshortening: float = 1.0) -> tuple[Array, Array]:
        """M and h of FOAM, (24)–(34) corrected; TLAM without foreshortening (D = 0)."""
        (_, q1, q2), (w, q1d, q2d) = self.parts(y), self.parts(yd)
        r = HUB_RADIUS + self.x
        J1, V1, V2 = self.total(r**2), self.total(r[:, None] * self.f1), self.total(r[:, None] * self.f2)
        M1, M2, R = (
            self.total(a[:, :, None] * b[:, None])
            for a, b in ((self.f1, self.f1), (self.f2, self.f2), (self.f1, self.f2))
        )
        D = foreshortening * self.total(r[:, None, None] * self.S)
        K1, K2 = self.stiffness
        M_tt = HUB_INERTIA + J1 + 2 * V1 @ q1 + q1 @ M1 @ q1 + q2 @ (M2 - D) @ q2  # (25)
        M_t1, M_t2 = -R @ q2, V2 + q1 @ R  # (26), (27)
        zero = np.zeros((self.n1, self.n2))
        M = np.block(
            [[np.atleast_2d(M_tt), M_t1[None], M_t2[None]], [M_t1[:, None], M1, zero], [M_t2[:, None], zero.T, M2]]
        )
        h = [
            [2 * w * (q1 @ M1 @ q1d + V1 @ q1d + q2 @ (M2 - D) @ q2d)],  # −Q_θ of (32)
            -2 * w * R @ q2d + (K1 - w**2 * M1) @ q1 - w**2 * V1,  # (29), (30), (33)
            2 * w * R.T @ q1d + (K2 - w**2 * M2 + w**2 * D) @ q2,  # (31), (34)
        ]
        return M, np.concatenate(h)

    def complete(self, y: Array, yd: Array) -> tuple[Array, Array]:
        """M and h of CFOAM as the point cloud that it is: no expansion."""
        (_, q1, q2), (w, q1d, q2d) = self.parts(y), self.parts(yd)
        Sq, Sqd = self.S @ q2, self.S @ q2d
        X, Y = HUB_RADIUS + self.x + self.f1 @ q1 - Sq @ q2 / 2, self.f2 @ q2
        Xd, Yd = self.f1 @ q1d - Sq @ q2d, self.f2 @ q2d
        Jx = np.hstack([-Y[:, None], self.f1, -Sq])
        Jy = np.hstack([X[:, None], 0 * self.f1, self.f2])
        ax, ay = -Sqd @ q2d - 2 * w * Yd - w**2 * X, 2 * w * Xd - w**2 * Y
        M = self.total(Jx[:, :, None] * Jx[:, None] + Jy[:, :, None] * Jy[:, None])
        M[0, 0] += HUB_INERTIA
        K1, K2 = self.stiffness
        return M, self.total(Jx * ax[:, None] + Jy * ay[:, None]) + np.concatenate([[0], K1 @ q1, K2 @ q2])

    def higher_order(self, y: Array, yd: Array) -> tuple[Array, Array]:
        """Terms that CFOAM adds to FOAM: (35)–(39), corrected and with the tip mass."""
        (_, q1, q2), (w, q1d, q2d) = self.parts(y), self.parts(yd)
        Sq, Sqd = self.S @ q2, self.S @ q2d
        sg, sd, sdd = Sq @ q2, Sq @ q2d, Sqd @ q2d
        u, ud, v, vd = self.f1 @ q1, self.f1 @ q1d, self.f2 @ q2, self.f2 @ q2d
        col = (slice(None), None)
        M_tt = self.total(sg**2 / 4 - u * sg)  # (35)
        M_t2 = self.total(v[col] * Sq - sg[col] * self.f2 / 2)
        M_12 = -self.total(self.f1[:, :, None] * Sq[:, None])
        M_22 = self.total(Sq[:, :, None] * Sq[:, None])
        M = np.block([
            [np.atleast_2d(M_tt), np.zeros((1, self.n1)), M_t2[None]],
            [np.zeros((self.n1, 1)), np.zeros((self.n1, self.n1)), M_12],
            [M_t2[:, None], M_12.T, M_22],
        ])  # fmt: skip
        h_t = self.total(w * (sg * sd - ud * sg - 2 * u * sd) + v * sdd)  # (36), (37)
        h_1 = self.total(self.f1 * (-sdd + w**2 * sg / 2)[col])  # (38)
        h_2 = self.total(
            2 * w * (vd[col] * Sq - sd[col] * self.f2) + (sdd + w**2 * u - w**2 * sg / 2)[col] * Sq
        )  # (39)
        return M, np.concatenate([[h_t], h_1, h_2])
