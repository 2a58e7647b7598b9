"""Equations of motion by sympy's KanesMethod, which knows nothing of beams: a rigid hub and one particle, whose place
in the hub's axes depends on the coordinates of one axial and one bending shape. The beam is the sum of such particles
at 40 Gauss points, with a mass at the tip, plus the forces of its strain energy. FOAM and TLAM are the same expressions
cut off at the order that an energy to second order leaves: the second in the hub's row, the first in the others. The
exact model's shapes are a uniform strain and a uniform curvature, a circular arc.

What is compared is the residual of the equations at random states that satisfy nothing: each row's difference over the
largest inertia force of that row.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache

import numpy as np
import sympy as sp
from sympy.physics import mechanics as me

import gbeam as gb
from validation.residuals import hinged
from validation.table import Row

TITLE = "Kane's method (sympy): the equations of motion"
NEEDS = ("sympy", "numpy", "jax")
SOURCE = "KanesMethod, summed over particles"

# 2009, Table 1, and a mass at the tip
LENGTH, DENSITY, AREA, YOUNG, INERTIA = 8.0, 2766.7, 7.2968e-5, 6.8952e10, 8.2189e-9
RADIUS, HUB, TIP = 0.5, 200.0, 0.5
STATES = 100
# Of the axial and the bending coordinates; of the exact model they are a strain and an angle.
SIZES = {"exact": (0.01, 1.0)}

_GAUSS, _WEIGHT = np.polynomial.legendre.leggauss(40)
X = np.append((_GAUSS + 1) * LENGTH / 2, LENGTH)
MASS = np.append(DENSITY * AREA * _WEIGHT * LENGTH / 2, TIP)


def rows() -> Iterator[Row]:
    """On a free hub every kind of model, then FOAM in space."""
    for kind in ("TLAM", "FOAM", "CFOAM", "exact"):
        yield from on_hub(kind)
    yield from in_space()


@cache
def shapes() -> tuple[np.ndarray, ...]:
    """Axial and bending shape at the particles, and ∫f'², in the textbook's form."""
    z = sp.Symbol("z")
    root = float(sp.nsolve(sp.cos(z) * sp.cosh(z) + 1, 1.9))
    sigma, beta = (np.cosh(root) + np.cos(root)) / (np.sinh(root) + np.sin(root)), root / LENGTH

    def slope(x: np.ndarray) -> np.ndarray:
        return beta * (np.sinh(beta * x) + np.sin(beta * x) - sigma * (np.cosh(beta * x) - np.cos(beta * x)))

    inside = X[:, None] * (_GAUSS + 1) / 2
    shortening = (slope(inside) ** 2) @ _WEIGHT * X / 2
    bending = np.cosh(beta * X) - np.cos(beta * X) - sigma * (np.sinh(beta * X) - np.sin(beta * X))
    return np.sqrt(2) * np.sin(np.pi * X / (2 * LENGTH)), bending, shortening


def stiffnesses(kind: str) -> tuple[float, float]:
    """Stiffnesses of the axial and the bending coordinate: ∫EA f₁'² and ∫EI f₂''²; of the exact model EAL and EI/L."""
    if kind == "exact":
        return YOUNG * AREA * LENGTH, YOUNG * INERTIA / LENGTH
    return YOUNG * AREA * (np.pi / 2) ** 2 / LENGTH, YOUNG * INERTIA * 1.875104068711961**4 / LENGTH**3


def cut(expression: sp.Expr, small: list[sp.Symbol], order: int) -> sp.Expr:
    """The Taylor polynomial in the symbols `small` together."""
    e = sp.Symbol("e")
    series = sp.expand(expression.subs({s: e * s for s in small}, simultaneous=True))
    return sum(series.coeff(e, power) for power in range(order + 1))


@cache
def particle_on_hub(kind: str) -> Callable[..., list[float]]:
    """Rows of a particle in the equations on a free hub, of (states, constants)."""
    q, u = me.dynamicsymbols("theta s q"), me.dynamicsymbols("omega sd qd")
    x, m, f1, f2, shortening = sp.symbols("x m f1 f2 S")
    if kind == "exact":
        turned = q[2] * x / LENGTH
        scale = (1 + q[1]) * LENGTH / q[2]
        along, across = scale * sp.sin(turned), scale * (1 - sp.cos(turned))
    else:
        bent = 0 if kind == "TLAM" else shortening * q[2] ** 2 / 2
        along, across = x + f1 * q[1] - bent, f2 * q[2]
    world = me.ReferenceFrame("W")
    axes = world.orientnew("A", "Axis", [q[0], world.z])
    centre, point = me.Point("O"), me.Point("P")
    centre.set_vel(world, 0)
    point.set_pos(centre, (RADIUS + along) * axes.x + across * axes.y)
    point.set_vel(world, point.pos_from(centre).dt(world).subs(dict(zip([v.diff() for v in q], u, strict=True))))
    kane = me.KanesMethod(world, q, u, [rate - v.diff() for v, rate in zip(q, u, strict=True)])
    _, inertial = kane.kanes_equations([me.Particle("P", point, m)], [])
    rates = {v.diff(): rate for v, rate in zip(q, u, strict=True)}
    udot = sp.symbols("alpha sdd qdd")
    plain = sp.symbols("theta_ s_ q_ omega_ sd_ qd_")
    instant = dict(zip([*q, *u], plain, strict=True))
    forces = [
        -row.subs(rates).subs(dict(zip([v.diff() for v in u], udot, strict=True))).subs(instant) for row in inertial
    ]
    if kind in {"TLAM", "FOAM"}:
        small = [plain[1], plain[2], plain[4], plain[5], udot[1], udot[2]]
        forces = [cut(row, small, order) for row, order in zip(forces, (2, 1, 1), strict=True)]
    return sp.lambdify([*plain, *udot, x, m, f1, f2, shortening], forces, "numpy", cse=True)


def by_kane_on_hub(kind: str, y: np.ndarray, yd: np.ndarray, ydd: np.ndarray) -> np.ndarray:
    """Residual of hub and beam, (3,)."""
    particles = particle_on_hub(kind)(*y, *yd, *ydd, X, MASS, *shapes())
    total = np.array([np.sum(row) for row in particles])
    return total + np.array([HUB * ydd[0], *(np.array(stiffnesses(kind)) * y[1:])])


def on_hub(kind: str) -> Iterator[Row]:
    """A model on the free hub at random states."""
    section, material = gb.Section.general(AREA, INERTIA, INERTIA), gb.Material(DENSITY, YOUNG)
    beam = gb.Beam(LENGTH, section, material, [gb.PointMass(LENGTH, TIP)], rotary_inertia=False)
    equations = hinged(gb.assemble(beam, kind, axial=1, y=1), gb.Hub(radius=RADIUS, inertia=HUB))
    size = np.array([1.0, *SIZES.get(kind, (0.02, 0.5))])
    states = np.random.default_rng(2009).normal(size=(STATES, 3, 3)) * size
    theirs = np.array([by_kane_on_hub(kind, *state) for state in states])
    ours = np.array([np.asarray(equations.residual(*state, np.zeros(()), None)) for state in states])
    for i, name in enumerate(("hub", "axial", "bending")):
        case = f"{kind} on a free hub, {name} row"
        unit = "N m" if i == 0 or kind == "exact" else "N"
        yield Row(case, "residual at the first state", theirs[0, i], ours[0, i], unit, 1e-10, SOURCE)
        elastic = 0.0 if i == 0 else stiffnesses(kind)[i - 1] * states[:, 0, i]
        yield difference(case, ours[:, i], theirs[:, i], theirs[:, i] - elastic)


def difference(case: str, ours: np.ndarray, theirs: np.ndarray, inertia: np.ndarray) -> Row:
    """Largest difference of a row of the equations over its largest inertia force."""
    worst = np.abs(ours - theirs).max() / np.abs(inertia).max()
    return Row(case, f"largest difference in {STATES} states", 0.0, worst, "", 1e-10, SOURCE)


@cache
def particle_in_space() -> Callable[..., list[float]]:
    """Rows of a particle on a base whose motion is given, to first order in the coordinates."""
    q, u = me.dynamicsymbols("s v w"), me.dynamicsymbols("sd vd wd")
    velocity, turning = me.dynamicsymbols("v1 v2 v3"), me.dynamicsymbols("w1 w2 w3")
    x, m, f1, f2, shortening = sp.symbols("x m f1 f2 S")
    world, base = me.ReferenceFrame("W"), me.ReferenceFrame("B")
    base.set_ang_vel(world, sum((w * e for w, e in zip(turning, base, strict=True)), start=me.Vector(0)))
    root, point = me.Point("O"), me.Point("P")
    root.set_vel(world, sum((v * e for v, e in zip(velocity, base, strict=True)), start=me.Vector(0)))
    short = shortening * (q[1] ** 2 + q[2] ** 2) / 2
    place = (x + f1 * q[0] - short) * base.x + f2 * q[1] * base.y + f2 * q[2] * base.z
    rates = {v.diff(): rate for v, rate in zip(q, u, strict=True)}
    seen = place.dt(base).subs(rates) + base.ang_vel_in(world).cross(place)
    point.set_vel(world, root.vel(world) + seen)
    kane = me.KanesMethod(world, q, u, [rate - v.diff() for v, rate in zip(q, u, strict=True)])
    _, inertial = kane.kanes_equations([me.Particle("P", point, m)], [])
    # The root's acceleration in base axes is dv/dt + ω × v: with v = 0 at the instant, dv/dt.
    instant = {v.diff(): a for v, a in zip(velocity, sp.symbols("a1:4"), strict=True)}
    instant |= {w.diff(): a for w, a in zip(turning, sp.symbols("al1:4"), strict=True)}
    instant |= {v.diff(): a for v, a in zip(u, sp.symbols("sdd vdd wdd"), strict=True)}
    plain = sp.symbols("s_ v_ w_ sd_ vd_ wd_ om1:4")
    now = dict(zip([*q, *u, *turning], plain, strict=True)) | dict.fromkeys(velocity, 0)
    small = [*plain[:6], *sp.symbols("sdd vdd wdd")]
    forces = [cut(-row.subs(rates).subs(instant).subs(now), small, 1) for row in inertial]
    names = [*plain[:6], *sp.symbols("sdd vdd wdd a1:4"), *plain[6:], *sp.symbols("al1:4"), x, m, f1, f2, shortening]
    return sp.lambdify(names, forces, "numpy", cse=True)


def in_space() -> Iterator[Row]:
    """FOAM in three dimensions at random motions of its base, I_z four times I_y."""
    section, material = gb.Section.general(AREA, INERTIA, 4 * INERTIA), gb.Material(DENSITY, YOUNG)
    beam = gb.Beam(LENGTH, section, material, [gb.PointMass(LENGTH, TIP)], rotary_inertia=False)
    equations = gb.assemble(beam, "FOAM", axial=1, y=1, z=1).equations
    random = np.random.default_rng(2020)
    stretch, bend = stiffnesses("FOAM")
    ours, theirs, inertia = np.zeros((3, STATES, 3))
    for i in range(STATES):
        q, qd, qdd = random.normal(size=(3, 3)) * [0.02, 0.5, 0.5]
        a, w, alpha = random.normal(size=(3, 3)) * [[50.0], [5.0], [20.0]]
        particles = particle_in_space()(*q, *qd, *qdd, *a, *w, *alpha, X, MASS, *shapes())
        inertia[i] = [np.sum(row) for row in particles]
        theirs[i] = inertia[i] + np.array([stretch, 4 * bend, bend]) * q
        ours[i] = equations.residual(q, qd, qdd, a, w, alpha)
    for i, name in enumerate(("axial", "y", "z")):
        case = f"FOAM in space on a given base, {name} row"
        yield Row(case, "residual at the first state", theirs[0, i], ours[0, i], "N", 1e-10, SOURCE)
        yield difference(case, ours[:, i], theirs[:, i], inertia[:, i])
