"""Further cases that were found in the literature and in other codes' test data, each with where it was read.

Curves digitised by others scatter by a few percent; a table's misprints and errors are kept, with what shows them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipeinc, ellipkinc

from gbeam import Beam, Load, Material, Model, PointMass, Root, Section, Structure, assemble, solve_equilibrium
from gbeam.results import Base
from validation.published.specimens import PLANAR, frequencies, spinning, unit_beam
from validation.table import Row

TITLE = "Further cases of the literature and of other codes"
NEEDS = ()
STILL = Base(*np.zeros((3, 3)))


def rows() -> Iterator[Row]:
    """All rows."""
    yield from double_taper()
    yield from tip_body()
    yield from tip_mass_equation()
    yield from tip_mass_ratios()
    yield from root_spring()
    yield from cable()
    yield from tip_force()
    yield from tip_moment()
    yield from following_spread_force()
    yield from following_tip_force()
    yield from composite_cantilever()


# --- vibration


def at_rest(beam: Beam, count: int, shapes: int = 8) -> np.ndarray:
    """Lowest circular frequencies of bending along z, rad/s, with shapes adapted to the beam."""
    return assemble(beam, Model("FOAM", 0, 0, shapes, "adapted")).rest[0][:count]


# Taper ratios of height and width: first three frequencies over √(EI₀/ρA₀L⁴), of Ozdemir Ozgumus and Kaya as quoted
DOUBLE_TAPER = {
    (0.0, 0.0): (3.51602, 22.0345, 61.6972),
    (0.0, 0.8): (5.39759, 25.6558, 65.7470),
    (0.4, 0.4): (4.31878, None, 51.3346),
    (0.6, 0.2): (4.18235, 17.8557, 44.4175),
    (0.8, 0.0): (4.29249, 15.7427, 36.8846),
    (0.8, 0.8): (6.19639, 18.3855, 39.8336),
}


def double_taper() -> Iterator[Row]:
    """Height and width fall linearly towards the tip."""
    source = "doi:10.1186/s40712-015-0040-0, Table 1, quoting Ozdemir Ozgumus and Kaya"
    for (height, width), published in DOUBLE_TAPER.items():
        section = Section.rectangle([1e-2, 1e-2 * (1 - width)], [1e-3, 1e-3 * (1 - height)], [0.0, 1.0])
        ours = at_rest(Beam(1.0, section, Material(1.0, 1.0), rotary_inertia=False), 3) / np.sqrt(1e-6 / 12)
        for mode, (theirs, mine) in enumerate(zip(published, ours, strict=True), start=1):
            case = f"taper of height {height}, of width {width}"
            if theirs is not None:
                yield Row(case, f"mode {mode}", theirs, float(mine), "√(EI₀/ρA₀L⁴)", 1e-5, source)
            else:
                yield Row(case, f"mode {mode}", "38.4920", float(mine), "√(EI₀/ρA₀L⁴)", 1e-5, source,
                          "misprint: the table's other column has 20.0500")  # fmt: skip
        if height == width == 0:
            yield Row("taper of height 0, of width 0", "mode 1, the table's own", "3.15601", float(ours[0]),
                      "√(EI₀/ρA₀L⁴)", 1e-5, source, "misprint: digits of 3.51602 exchanged")  # fmt: skip


# J/(mL³) of a tip body of the beam's own mass: first three frequencies over √(EI/mL⁴)
TIP_BODY = {
    0.0: (1.557298, 16.25009, 50.89584),
    0.001: (1.558671, 16.57872, 53.50208),
    1.0: (2.550441, 23.86031, 63.40190),
}


def with_inertia(count: int, inertia: float) -> list[float]:
    """Roots β² of the frequency equation: w''' = −β⁴ w and w'' = J β⁴ w' at the tip, w = w' = 0 at the root."""

    def determinant(beta: float) -> float:
        c, s, ch, sh = np.cos(beta), np.sin(beta), np.cosh(beta), np.sinh(beta)
        w = np.array([[ch - c, sh - s], [sh + s, ch - c], [ch + c, sh + s], [sh - s, ch + c]])
        shear, moment = w[3] * beta**3 + beta**4 * w[0], w[2] * beta**2 - inertia * beta**5 * w[1]
        return float(shear[0] * moment[1] - shear[1] * moment[0])

    grid = np.arange(0.05, 12.0, 0.003)
    values = [determinant(b) for b in grid]
    signs = [k for k in range(len(grid) - 1) if values[k] * values[k + 1] < 0]
    return [float(brentq(determinant, grid[k], grid[k + 1])) ** 2 for k in signs[:count]]


def tip_body() -> Iterator[Row]:
    """A body at the tip, without and with rotary inertia."""
    source = "doi:10.1155/2017/1568019, Table 1"
    for inertia, published in TIP_BODY.items():
        body = PointMass(1.0, 1.0, inertia=(0.0, inertia, inertia))
        beam = Beam(1.0, Section.general(1.0, 1e-6, 1e-6), Material(1.0, 1e6), [body], rotary_inertia=False)
        ours, closed, reversed_ = at_rest(beam, 3), with_inertia(3, inertia), with_inertia(3, -inertia)
        for mode in range(3):
            why = (
                f"wrong sign of the table's moment (inertia cannot raise a frequency); reversed: {reversed_[mode]:.5f}"
            )
            case = f"tip body of mass mL, J = {inertia:g} mL³"
            yield Row(case, f"mode {mode + 1}", published[mode], float(ours[mode]), "√(EI/mL⁴)", 1e-6, source,
                      why if inertia else "")  # fmt: skip
            yield Row(case, f"mode {mode + 1}", closed[mode], float(ours[mode]), "√(EI/mL⁴)", 1e-6,
                      "derived: the frequency equation")  # fmt: skip


def handbook_root(function: Callable[[float], float], low: float, high: float) -> float:
    """Root λ of a frequency equation, as λ²."""
    return float(brentq(function, low, high, xtol=1e-14)) ** 2


def tip_mass_equation() -> Iterator[Row]:
    """1 + cos λ cosh λ = n λ (sin λ cosh λ − cos λ sinh λ)."""
    source = "Karnovsky and Lebed, handbook, section 7.5.3 (excerpt); also SMI-Lab-Inha/pyBModes"
    for ratio in (0.05, 0.5, 5.0):

        def equation(z: float, n: float = ratio) -> float:
            c, s, ch, sh = np.cos(z), np.sin(z), np.cosh(z), np.sinh(z)
            return float(1 + c * ch - n * z * (s * ch - c * sh))

        ours = at_rest(unit_beam(tip=ratio), 1)[0]
        yield Row("cantilever with a tip mass", f"mode 1, m = {ratio} ρAL", handbook_root(equation, 0.1, 2.5),
                  float(ours), "√(EI/ρAL⁴)", 1e-8, source)  # fmt: skip


def tip_mass_ratios() -> Iterator[Row]:
    """Measured beam of which the excerpt gives frequencies, not sizes: their ratios have no dimensions."""
    source = "doi:10.3390/app9152996, Tables 1 and 2"
    bare, heavy = at_rest(unit_beam(), 5), at_rest(unit_beam(tip=0.2), 5)
    theirs = (14.58 / 19.63, 101.64 / 123.02, 299.00 / 344.45, 604.02 / 674.97, 1018.48 / 1115.79)
    for mode in range(5):
        yield Row("tip mass of a fifth of the beam's", f"mode {mode + 1} over that without", theirs[mode],
                  float(heavy[mode] / bare[mode]), "", 1e-3, source, "four digits are printed")  # fmt: skip


def root_spring() -> Iterator[Row]:
    """Rotational spring k* = k L/EI: k* (1 + cos λ cosh λ) = λ (sin λ cosh λ − cos λ sinh λ)."""
    source = "Karnovsky and Lebed, handbook, section 7.5.3 (excerpt), M = 0"
    for spring in (0.1, 1.0, 10.0):

        def equation(z: float, k: float = spring) -> float:
            c, s, ch, sh = np.cos(z), np.sin(z), np.cosh(z), np.sinh(z)
            return float(k * (1 + c * ch) - z * (s * ch - c * sh))

        section, root = Section.general(1.0, 1e-6, 1e-6), Root(rotation_y=spring)
        beam = Beam(1.0, section, Material(1.0, 1e6), root=root, rotary_inertia=False)
        for mode, (low, high) in enumerate(((0.1, 2.5), (3.5, 5.5)), start=1):
            yield Row("root on a rotational spring", f"mode {mode}, k L/EI = {spring}",
                      handbook_root(equation, low, high),
                      float(at_rest(beam, 2)[mode - 1]), "√(EI/ρAL⁴)", 1e-7, source)  # fmt: skip


def cable() -> Iterator[Row]:
    """A spinning cable, hinged at the root: bending stiffness and root spring all but nothing."""
    source = "Bir 2009 AIAA 2009-1035, III.B: ω = Ω √(k(2k − 1)), in SMI-Lab-Inha/pyBModes"
    slack = 1e-9  # EI over mL⁴Ω²
    section = Section.general(1.0, slack * 1e-6, slack * 1e-6)
    beam = Beam(1.0, section, Material(1.0, 1e6), root=Root(rotation_y=slack), rotary_inertia=False)
    c = assemble(beam, Model("exact", 0, 0, 12)).coefficients
    ours = frequencies(c, spinning(1.0, axis=2), 3)
    for k in (1, 2, 3):
        yield Row("spinning cable, flap", f"mode {k}", float(np.sqrt(k * (2 * k - 1))), float(ours[k - 1]), "Ω", 1e-6,
                  source)  # fmt: skip


# --- large deflection


def bent(beam: Beam) -> tuple[float, float, float]:
    """Displacement along x and z, m, and angle, rad, of the tip of the exact model at rest."""
    structure = assemble(beam, Model("exact", PLANAR[0], 0, PLANAR[1]))
    q = solve_equilibrium(structure, STILL).q
    return (*tip_place(structure, q), tip_angle(structure, q))


def tip_place(structure: Structure, q: np.ndarray, station: int = -1) -> tuple[float, float]:
    """Displacement along x and z, m."""
    moved = structure.displacement(q)[station]
    return float(moved[0]), float(moved[2])


def tip_angle(structure: Structure, q: np.ndarray) -> float:
    """By which the tip's tangent has turned, rad, from −π to π."""
    assert structure.field is not None
    tangent = structure.field.rotation(q)[-1][:, 0]
    return float(np.arctan2(tangent[2], tangent[0]))


def rod(length: float, bending: float, axial: float, load: Load) -> Beam:
    """EI and EA, with one load."""
    return Beam(length, Section.general(axial, bending, bending), Material(1.0, 1.0), loads=[load])


def tip_force() -> Iterator[Row]:
    """Elliptic integrals, with the amplitude δ as parameter: λ = FL²/EI."""
    source = "elliptic integrals as in byuflowlab/GXBeam.jl, test/examples/tipforce.jl"
    for load in (4.0, 8.0, 16.0):

        def force(delta: float) -> float:
            m = (np.cos(np.pi / 4) / np.sin(delta)) ** 2
            return float((ellipkinc(np.pi / 2, m) - ellipkinc(delta, m)) ** 2)

        delta = brentq(lambda d, load=load: force(d) - load, np.pi / 4 + 1e-9, np.pi / 2 - 1e-9, xtol=1e-14)
        k = np.cos(np.pi / 4) / np.sin(delta)
        angle = 2 * (np.pi / 4 - np.arccos(k))
        shorter = np.sqrt(2 * np.sin(angle) / load) - 1
        across = 1 - 2 / np.sqrt(load) * (ellipeinc(np.pi / 2, k**2) - ellipeinc(delta, k**2))
        deflection = bent(rod(1.0, 1.0, 1e9, Load(1.0, force=(0, 0, load))))
        for quantity, theirs, ours in zip(
            ("along", "across", "angle"), (shorter, across, angle), deflection, strict=True
        ):
            yield Row("cantilever, dead tip force", f"tip {quantity}, FL²/EI = {load:g}", float(theirs), ours,
                      "rad" if quantity == "angle" else "L", 2e-6, source)  # fmt: skip


def tip_moment() -> Iterator[Row]:
    """An arc of radius EI/M."""
    source = "closed form as in byuflowlab/GXBeam.jl, test/examples/tipmoment.jl"
    for share in (0.4, 0.8, 1.2, 1.6, 1.8):
        radius = 1 / (share * np.pi)
        along, across, _ = bent(rod(1.0, 1.0, 1e9, Load(1.0, moment=(0, -share * np.pi, 0))))
        case, at = "cantilever, tip moment", f"M = {share} πEI/L"
        yield Row(case, f"tip along, {at}", radius * np.sin(1 / radius) - 1, along, "L", 1e-7, source)
        yield Row(case, f"tip across, {at}", radius * (1 - np.cos(1 / radius)), across, "L", 1e-7, source)


def following_spread_force() -> Iterator[Row]:
    """EI = 3.5 N m², L = 1 m, a force per length that stays across the beam."""
    source = "curves digitised in luizpancini/AeroBeams.jl, test/referenceData/distributedLoadCantilever"
    case = "cantilever, following spread force"
    along = {20.425: 0.27256, 40.138: 0.76727, 59.267: 1.1552, 96.676: 1.4147}
    across = {20.921: 0.63846, 41.396: 0.84946, 57.551: 0.77837, 79.815: 0.56245}
    for which, curve in ((0, along), (1, across)):
        for q, theirs in curve.items():
            deflection = bent(rod(1.0, 3.5, 4.2e5, Load(distributed=(0, 0, q), follower=True)))[which]
            quantity = f"{('shortening', 'deflection')[which]}, {q:g} N/m"
            yield Row(case, quantity, theirs, -deflection if which == 0 else deflection, "m", 0.02, source, "digitised")


def following_tip_force() -> Iterator[Row]:
    """L = 100 in, EI = 3.5e7 lbf in²: the beam winds itself up (Argyris and Symeonidis)."""
    source = "curves digitised in luizpancini/AeroBeams.jl, test/referenceData/tipFollowerForceCantilever"
    case = "cantilever, following tip force"
    along = {9.8102: 40.702, 21.014: 95.994, 34.743: 110.05, 60.745: 84.406}
    across = {5.5235: 48.519, 15.017: 78.903, 30.040: 60.454, 60.417: 39.896}
    for which, curve in ((0, along), (1, across)):
        for force, theirs in curve.items():
            load = Load(100.0, force=(0, 0, 1e3 * force), follower=True)
            deflection = bent(rod(100.0, 3.5e7, 4.2e8, load))[which]
            quantity = f"{('shortening', 'deflection')[which]}, {force:g} klbf"
            yield Row(
                case, quantity, theirs, -deflection if which == 0 else deflection, "in", 0.02, source, "digitised"
            )


def composite_cantilever() -> Iterator[Row]:
    """Beam 1 of Minguet and Dugundji: a weight hung at the tip of a 550 mm laminate, seen at 500 mm."""
    source = "Minguet and Dugundji 1990, measured; digitised in luizpancini/AeroBeams.jl, compositeCantileverMD"
    measured = {20: 1.4125e-2, 50: 3.5861e-2, 100: 6.9113e-2, 200: 0.13090, 400: 0.21790}
    for grams, theirs in measured.items():
        weight = 9.80665e-3 * grams
        beam = Beam(0.55, Section.general(1.0, 0.707 / 3.7e6, 276 / 3.7e6), Material(1.0, 3.7e6),
                    loads=[Load(0.55, force=(0, 0, -weight))])  # fmt: skip
        structure = assemble(beam, Model("exact", PLANAR[0], 0, PLANAR[1]), [0.5])
        ours = -tip_place(structure, solve_equilibrium(structure, STILL).q, 0)[1]
        yield Row("laminated cantilever", f"deflection at 500 mm, {grams} g", theirs, ours, "m", 0.1, source,
                  "measured; EI = 0.707 N m² is computed from the plies")  # fmt: skip
