"""Beams on lines that supports hold: arches and a frame, against closed forms of their buckling and their snap."""

from __future__ import annotations

import numpy as np
import pytest

import gbeam as gb

from .test_supports import DENSITY, EI, LENGTH, MODULUS, PIN, THICKNESS, WIDTH, beam


@pytest.mark.parametrize("kind", ["FOAM", "exact"])
def test_a_line_without_curvature_is_held_as_a_straight_beam(kind: str) -> None:
    """Their shapes differ: on a line every family has polynomials and the strains of every unit load."""
    straight = gb.Line(LENGTH, lambda x: np.zeros((len(x), 3)))
    supports = [gb.Support(0.4, ["z"], stiffness={"ry": 50.0}), gb.Support(LENGTH, ["x", "y", "z", "rz"])]
    held = [gb.assemble(beam(*supports, line=line), kind, axial=2, y=5, z=5) for line in (None, straight)]
    one, other = (gb.modes(model).frequency[0] for model in held)
    assert other == pytest.approx(one, rel=2e-4)
    one, other = (gb.static(model, acceleration=(0.0, 5.0, 100.0)).loads.support_force for model in held)
    assert other == pytest.approx(one, rel=2e-2, abs=1e-2 * np.abs(one).max())


@pytest.mark.parametrize("kind", ["FOAM", "exact"])
def test_an_arch_and_its_supports_balance(kind: str) -> None:
    """A quarter of a circle between a pin and a clamp that is turned by 90°: the axes of supports are the root's."""
    radius = 0.4
    arc = gb.Line(np.pi / 2 * radius, lambda x: np.stack([0 * x, 1 / radius + 0 * x, 0 * x], axis=1))
    section = gb.Section.rectangle(WIDTH, THICKNESS)
    supports = [PIN, gb.Support("tip", ["x", "y", "z", "rx", "ry", "rz"])]
    metal = gb.Material(DENSITY, MODULUS, poissons_ratio=0.3)
    arch = gb.Beam(arc.length, section, metal, supports=supports, line=arc)
    rest = gb.static(gb.assemble(arch, kind, axial=3, y=4, z=5, twist=2), acceleration=(3.0, 2.0, 9.81))
    loads = rest.loads
    assert loads is not None and loads.base_force is not None and loads.support_force is not None
    mass = DENSITY * WIDTH * THICKNESS * arc.length
    assert loads.base_force[0] == pytest.approx(mass * np.array([3.0, 2.0, 9.81]), rel=1e-9)
    assert np.linalg.norm(rest.tip) < 1e-15
    assert rest.errors.loads.total < 0.05


def test_a_pinned_arch_buckles_at_the_pressure_of_the_closed_form() -> None:
    """Of a half-angle α under a pressure that follows it, p = EI/R³ (π²/α² − 1), where it does not shorten.

    The square of its lowest frequency falls as the pressure grows to that.
    """
    radius, angle = 0.5, np.pi / 4
    arc = gb.Line(2 * angle * radius, lambda x: np.stack([0 * x, 1 / radius + 0 * x, 0 * x], axis=1))
    section, metal = gb.Section.rectangle(WIDTH, THICKNESS), gb.Material(DENSITY, MODULUS, poissons_ratio=0.0)
    supports = [PIN, gb.Support("tip", ["x", "z"])]
    critical, lowest = EI / radius**3 * ((np.pi / angle) ** 2 - 1), list[float]()
    for share in (0.5, 0.995):
        pressure = gb.Load(distributed=(0.0, 0.0, -share * critical), follower=True)
        arch = gb.Beam(arc.length, section, metal, supports=supports, line=arc, loads=[pressure])
        lowest.append(gb.modes(gb.assemble(arch, "FOAM", axial=1, z=4)).frequency[0])
    assert lowest[1] / lowest[0] == pytest.approx(np.sqrt(0.005 / 0.5), rel=0.05)


@pytest.mark.parametrize("kind", ["FOAM", "exact"])
def test_a_shallow_arch_sinks_as_the_closed_form_says_until_it_snaps(kind: str) -> None:
    """Of a half sine with a rise of λ times 2 √(I/A), under a load q: q̂ = (λ − η) + (λ² − η²) η, with the rise η left.

    Up to its largest q̂, at η² = (λ² − 1)/3; q̂ EI (π/L)⁴ 2 √(I/A) is the part of the load that is a half sine, 4 q/π.
    """
    rise, unit, wave = 1.5, 2 * THICKNESS / np.sqrt(12), np.pi / LENGTH
    x = np.linspace(0, LENGTH, 11)
    line = gb.Line.of_points(np.stack([x, 0 * x, rise * unit * np.sin(wave * x)], axis=1))
    section, metal = gb.Section.rectangle(WIDTH, THICKNESS), gb.Material(DENSITY, MODULUS, poissons_ratio=0.0)
    still = gb.Flight(z=0.0).base(0.0)
    for left in (1.2, 0.8, 0.7):  # it snaps at 0.65
        load = ((rise - left) + (rise**2 - left**2) * left) * EI * wave**4 * unit * np.pi / 4
        pushed = [gb.Load(distributed=(0.0, 0.0, -load))]
        supports = [PIN, gb.Support("tip", ["x", "z"])]
        arch = gb.Beam(line.length, section, metal, supports=supports, line=line, loads=pushed)
        model = gb.assemble(arch, kind, axial=1, z=5)
        equilibrium = gb.solve_equilibrium(model, still)
        middle = model.displacement(equilibrium.q)[0, 2]
        assert equilibrium.stable and middle == pytest.approx((left - rise) * unit, rel=0.02)


def toggle(
    thrust: float, length: float, rise: float, axial: float, bending: float, flat: bool = False
) -> tuple[float, float]:
    """Load and sinking of the apex of a shallow frame of two members, clamped at its feet, by the functions of
    beam-columns: a member under a thrust N with k² = N/EI bends as kx − sin kx − tan(kl/2) (1 − cos kx), shortens by
    βw − ½∫y'² dx = Nl/EA, and carries Nβ + Nkw/(2 tan(kl/2) − kl). Of two sinkings under one thrust it is the less, or
    that of the frame pushed `flat`.
    """
    k, slope = np.sqrt(thrust / bending), rise / length
    x = np.linspace(0.0, length, 2001)
    tangent = np.tan(k * length / 2)
    angle = k * ((1 - np.cos(k * x)) - tangent * np.sin(k * x)) / (k * length - 2 * tangent)
    bent = np.trapezoid(angle**2, x)
    root = slope**2 - 2 * bent * thrust * length / axial
    sinking = (slope + (1 if flat else -1) * np.sqrt(root)) / bent if root > 0 else np.nan
    return 2 * thrust * (slope + k * sinking / (2 * tangent - k * length)), sinking


@pytest.mark.parametrize("kind", ["FOAM", "exact"])
def test_williams_toggle_frame_sinks_until_it_snaps(kind: str) -> None:
    """International Journal of Mechanical Sciences 6, 1964: EA 1.885e6 lb, EI 9.27e3 lb in², 12.943 in and 0.386 in."""
    inch, pound = 0.0254, 4.4482216152605
    length, rise, axial, bending = 12.943 * inch, 0.386 * inch, 1.885e6 * pound, 9.27e3 * pound * inch**2
    thrusts = np.linspace(10.0, 1.5 * np.pi**2 * bending / length**2, 4000)
    curve = np.array([toggle(thrust, length, rise, axial, bending) for thrust in thrusts])
    known = ~np.isnan(curve[:, 0])
    limit = curve[known, 0].max()
    thickness = np.sqrt(12 * bending / axial)
    section = gb.Section.rectangle(axial / MODULUS / thickness, thickness)
    metal = gb.Material(DENSITY, MODULUS, poissons_ratio=0.0)
    line = gb.Line.of_points([[0, 0, 0], [length, 0, rise], [2 * length, 0, 0]], smooth=False)
    still = gb.Flight(z=0.0).base(0.0)

    def frame(share: float) -> gb.Structure:
        push = gb.Load(at="apex", force=(0.0, 0.0, -share * limit))
        apex, clamp = gb.Point("apex", at=line.length / 2), gb.Support("tip", ["x", "z", "ry"])
        held = gb.Beam(line.length, section, metal, supports=[clamp], line=line, loads=[push], points=[apex])
        return gb.assemble(held, kind, axial=2, z=6)  # type: ignore[arg-type]

    for share in (0.3, 0.9):
        model = frame(share)
        k = int(np.argmin(np.abs(model.stations - line.length / 2)))
        sunk = -model.displacement(gb.solve_equilibrium(model, still).q)[k, 2]
        rising = curve[known][: int(np.argmax(curve[known, 0]))]
        assert sunk == pytest.approx(np.interp(share * limit, rising[:, 0], rising[:, 1]), rel=0.02)
    with pytest.raises(gb.ComputationError, match=r"no relative equilibrium beyond 0\.9"):
        gb.solve_equilibrium(frame(1.02), still)
