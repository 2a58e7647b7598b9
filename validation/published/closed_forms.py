"""Closed forms, derived for this comparison; each row's source gives the derivation in a line.

They cover what print seldom does: vibration after pulses, forced vibration, hubs that are free, setting angles, section
forces and stress, stability under loads that follow the beam.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.optimize import brentq, minimize_scalar
from scipy.special import jn_zeros, jv

from gbeam import (
    Beam,
    Flight,
    Hub,
    Load,
    Material,
    Model,
    PointMass,
    Root,
    Section,
    Sine,
    Structure,
    assemble,
    buckling_acceleration,
    constant,
    critical_load,
    linearize,
    modes,
    simulate,
    static,
    trapezoid,
)
from validation.published import zhang2020
from validation.published.specimens import strip, strip_beam, unit_beam
from validation.table import Row

TITLE = "Closed forms"
NEEDS = ()


def rows() -> Iterator[Row]:
    """All rows."""
    yield from corner_and_pulse()
    yield from resonance()
    yield from hinged_rigid_blade()
    yield from setting_angle()
    yield from free_hub()
    yield from bar_with_tip_mass()
    yield from hanging_chain()
    yield from columns()
    yield from section_forces()


# --- response over time


def one_mode() -> tuple[Structure, float, float]:
    """The strip of 2020 in its first mode, its circular frequency, and the tip's static deflection under 1 m/s²."""
    structure = strip("FOAM", 0, 0, 1)
    c = structure.coefficients
    first = float(np.sqrt(c.stiffness[0, 0] / c.mass[0, 0]))
    per_load = abs(float(structure.displacement(np.linalg.solve(c.stiffness, c.f_a[2]))[-1, 2]))
    return structure, first, per_load


def corner_and_pulse() -> Iterator[Row]:
    """An undamped mode in flight."""
    structure, first, per_load = one_mode()
    period, level = 2 * np.pi / first, 50.0
    for share in (0.3, 1.5, 4.25):
        ramp = share * period
        load = trapezoid(level, jerk=level / ramp, start=0.0, hold=1.0)
        result = simulate(structure, Flight(z=load), duration=0.2, residual_from=ramp, integrator="gauss")
        x = first * ramp / 2
        yield Row("ramp to a plateau", f"vibration left, ramp of {share} periods", abs(np.sin(x) / x),
                  result.peaks.residual_amplitude[2] / (level * per_load), "static deflections", 1e-4,
                  "derived: q̈ + ω²q = ω² t/T leaves |sin x/x|, x = ωT/2, after its corner")  # fmt: skip
    for share in (0.4, 1.3, 2.6):
        duration, p = share * period, 2 * np.pi / (share * period)
        result = simulate(structure, Flight(z=Sine(level, duration)), duration=duration + 0.15, residual_from=duration,
                          integrator="gauss")  # fmt: skip
        left = 2 * p * first / abs(first**2 - p**2) * abs(np.sin(first * duration / 2))
        yield Row("one period of a sine", f"vibration left, {share} periods long", left,
                  result.peaks.residual_amplitude[2] / (level * per_load), "static deflections", 1e-4,
                  "derived: q̈ + ω²q = ω² sin pt leaves 2pω/|ω² − p²| |sin(πω/p)|")  # fmt: skip


def resonance() -> Iterator[Row]:
    """Driven at its natural frequency, a damped mode answers 1/(2ζ) times as much as at rest."""
    for ratio in (0.005, 0.02, 0.1):
        structure = strip("FOAM", 0, 0, 1, damping_ratio=ratio)
        plant = linearize(structure, Flight(z=0.0))
        _, first, per_load = one_mode()
        column = [s.name for s in plant.inputs].index("base_acceleration_z")
        line = [s.name for s in plant.outputs].index("tip_z")
        s = 1j * first * np.eye(len(plant.a)) - plant.a
        answer = plant.c[line] @ np.linalg.solve(s, plant.b[:, column]) + plant.d[line, column]
        yield Row("driven at resonance", f"amplification, ζ = {ratio}", 1 / (2 * ratio), abs(answer) / per_load, "",
                  1e-9, "derived: q̈ + 2ζω q̇ + ω²q = ω² sin ωt")  # fmt: skip


# --- rotation


def hinged_rigid_blade() -> Iterator[Row]:
    """A stiff blade on a root spring k: it flaps and lags as a rigid body."""
    length, radius, rate, spring = 1.0, 0.4, 5.0, 20.0
    section = Section.general(1.0, 1.0, 1.0)
    hinge = Root(rotation_y=spring, rotation_z=spring)
    beam = Beam(length, section, Material(1.0, 1e9), root=hinge, rotary_inertia=False)
    vibration = modes(assemble(beam, Model("FOAM", 0, 1, 1)), Hub(radius=radius, rate=constant(rate)))
    inertia = length**3 / 3
    stiff = spring / inertia + rate**2 * 1.5 * radius / length
    for way, square, name in (("z", stiff + rate**2, "flap"), ("y", stiff, "lag")):
        ours = 2 * np.pi * vibration.frequency[[d == way for d in vibration.direction]][0]
        plus = "Ω²(1 + 3R/2L)" if name == "flap" else "Ω² 3R/2L"
        yield Row("rigid blade on a root spring", name, np.sqrt(square), float(ours), "rad/s", 1e-6,
                  f"derived: ω² = k/J + {plus}, J = ρAL³/3")  # fmt: skip


def setting_angle() -> Iterator[Row]:
    """A blade that is soft one way, turned about its axis by ψ."""
    structure, rate = assemble(unit_beam(1e4), Model("FOAM", 0, 0, 12)), 5.0

    def first(angle: float) -> float:
        hub = Hub(radius=0.0, rate=constant(rate), setting_angle=np.deg2rad(angle))
        return float(2 * np.pi * modes(structure, hub).frequency[0])

    flat = first(0.0)
    for angle in (30.0, 60.0, 90.0):
        wanted = np.sqrt(flat**2 - (rate * np.sin(np.deg2rad(angle))) ** 2)
        yield Row("blade at a setting angle", f"first frequency, ψ = {angle:g}°, γ = 5", float(wanted), first(angle),
                  "√(EI/mL⁴)", 1e-9, "derived: ω² = ω_flap² − Ω² sin² ψ, the spin's own softening")  # fmt: skip


def free_hub() -> Iterator[Row]:
    """A beam on a free hub of inertia J h mL³: w = 0 and w'' = −h β⁴ w' at the root."""
    for ratio in (0.02, 0.5, 10.0):

        def determinant(beta: float, h: float = ratio) -> float:
            x = np.array([0.0, beta])
            c, s, ch, sh = np.cos(x), np.sin(x), np.cosh(x), np.sinh(x)
            w = np.array([[c, s, ch, sh], [-s, c, sh, ch], [-c, -s, ch, sh], [s, -c, sh, ch]])
            root, tip = w[:, :, 0], w[:, :, 1]
            return float(np.linalg.det([root[0], root[2] + h * beta**3 * root[1], tip[2], tip[3]]))

        grid = np.linspace(0.5, 12.0, 4000)
        values = [determinant(b) for b in grid]
        betas = [brentq(determinant, grid[k], grid[k + 1]) for k in range(3999) if values[k] * values[k + 1] < 0][:3]
        structure = assemble(unit_beam(1e4), Model("FOAM", 0, 30, 0))
        frequency = 2 * np.pi * modes(structure, Hub(radius=0.0, inertia=ratio)).frequency
        for mode, beta in enumerate(betas):
            yield Row("beam on a free hub", f"mode {mode + 1}, J = {ratio} mL³", float(beta**2), float(frequency[mode]),
                      "√(EI/mL⁴)", 1e-4, "derived: w = w'' + (J/mL³) β⁴ w' = 0 at the root, free tip",
                      "30 clamped-free shapes, which know nothing of a root that turns")  # fmt: skip


# --- along the beam


def bar_with_tip_mass() -> Iterator[Row]:
    """Longitudinal vibration."""
    for ratio in (0.2, 1.0, 5.0):
        beam = Beam(1.0, Section.general(1.0, 1.0, 1.0), Material(1.0, 1.0), [PointMass(1.0, ratio)])
        ours = assemble(beam, Model("FOAM", 4, 0, 0, "adapted")).rest[0]
        for mode in range(2):
            low = mode * np.pi + 1e-9
            wanted = brentq(lambda z, m=ratio: m * z * np.sin(z) - np.cos(z), low, low + np.pi / 2, xtol=1e-14)
            yield Row("bar with a tip mass", f"mode {mode + 1}, m = {ratio} ρAL", float(wanted), float(ours[mode]),
                      "√(E/ρL²)", 1e-9, "derived: EA u' = ω² m u at the tip: (m/ρAL) z tan z = 1")  # fmt: skip


def hanging_chain() -> Iterator[Row]:
    """Bending stiffness all but nothing, a weight per length that pulls: Bernoulli's chain."""
    slack = 1e-9  # EI over ρA g L³
    beam = Beam(1.0, Section.general(1.0, slack * 1e-6, slack * 1e-6), Material(1.0, 1e6),
                root=Root(rotation_y=slack), rotary_inertia=False)  # fmt: skip
    structure = assemble(beam, Model("exact", 0, 0, 14)).coefficients
    o = np.zeros(3)
    _, stiffness, _ = structure.evaluate(np.array([-1.0, 0.0, 0.0]), o, o)
    square = np.linalg.eigvals(np.linalg.solve(structure.mass, stiffness)).real
    ours = np.sqrt(np.sort(square))
    for mode, zero in enumerate(jn_zeros(0, 3)):
        yield Row("hanging chain", f"mode {mode + 1}", float(zero / 2), float(ours[mode]), "√(g/L)", 1e-5,
                  "derived: ((1 − x) w')' + ω² w = 0: J₀(2ω √(L/g)) = 0")  # fmt: skip


# --- stability


def column(*loads: Load) -> Structure:
    """ρA = EI = L = 1, slender."""
    section, material = Section.general(1e-2, 1e-8, 1e-8), Material(1e2, 1e8)
    return assemble(Beam(1.0, section, material, loads=loads, rotary_inertia=False), Model("exact", 1, 0, 7))


def beck(load: float) -> float:
    """Smallest height of the frequency equation's bump between the first two modes: zero where they meet.

    w'''' + p w'' = ω² w, w = w' = 0 at the root, w'' = w''' = 0 at the tip, a thrust p that follows:
    p² + 2ω² (1 + cos a cosh b) + p ω sin a sinh b = 0, a², b² = √(p²/4 + ω²) ± p/2.
    """

    def frequency_equation(w: float) -> float:
        root = np.sqrt(load**2 / 4 + w**2)
        a, b = np.sqrt(root + load / 2), np.sqrt(root - load / 2)
        return float(load**2 + 2 * w**2 * (1 + np.cos(a) * np.cosh(b)) + load * w * np.sin(a) * np.sinh(b))

    return float(
        minimize_scalar(frequency_equation, bounds=(6.0, 18.0), method="bounded", options={"xatol": 1e-10}).fun
    )


def columns() -> Iterator[Row]:
    """Dead and following thrust, at the tip and spread; own weight."""
    thrust = critical_load(column(Load(1.0, force=(-1.0, 0.0, 0.0)))).value
    yield Row("column", "dead thrust at the tip", np.pi**2 / 4, thrust, "EI/L²", 1e-5, "Euler: cos √p L = 0")
    following = critical_load(column(Load(1.0, force=(-1.0, 0.0, 0.0), follower=True))).value
    yield Row("column", "following thrust at the tip (Beck)", float(brentq(beck, 19.0, 21.0)), following, "EI/L²", 5e-5,
              "derived: two roots of the frequency equation meet", "the exact beam shortens by 2e-5")  # fmt: skip
    weight = 9 / 4 * brentq(lambda z: jv(-1 / 3, z), 1.5, 2.2) ** 2
    spread = critical_load(column(Load(distributed=(-1.0, 0.0, 0.0)))).value
    pushed = buckling_acceleration(column()).value
    source = "Greenhill: 9/4 z², J₋₁⸝₃(z) = 0"
    yield Row("column", "dead thrust, spread", weight, spread, "EI/L³", 5e-5, source)
    yield Row("column", "acceleration along the beam", weight, pushed, "EI/(ρAL³)", 5e-5, source)


# --- what sections carry


def section_forces() -> Iterator[Row]:
    """The strip of 2020 in steady flight and on a hub."""
    beam, g = strip_beam(masses=(PointMass(0.3, 0.02),)), 60.0
    line, tip, length = zhang2020.LINE, 0.02, zhang2020.LENGTH
    rest = static(assemble(beam, Model("FOAM", 1, 0, 12)), acceleration=(0.0, 0.0, g))
    assert rest.loads is not None
    moment = line * g * length**2 / 2 + tip * g * length
    force, source = (line * length + tip) * g, "derived: statics of the straight beam"
    stress = 6 * moment / (zhang2020.WIDTH * zhang2020.THICKNESS**2)
    deflection = (line * length**4 / 8 + tip * length**3 / 3) * g / (zhang2020.YOUNG * zhang2020.INERTIA_Y)
    for quantity, theirs, ours, unit, allowed in (
        ("root force", force, np.linalg.norm(rest.loads.force[0, 0]), "N", 1e-9),
        ("root moment", moment, np.linalg.norm(rest.loads.moment[0, 0]), "N m", 1e-4),
        ("stress at the root", stress / 1e6, float(np.nanmax(rest.loads.stress_tension[0, 0])) / 1e6, "MPa", 1e-4),
        ("tip deflection", deflection * 1e3, abs(rest.tip[2]) * 1e3, "mm", 1e-4),
    ):
        lever = "the bent beam's lever is shorter" if "moment" in quantity or "stress" in quantity else ""
        yield Row("strip with 20 g at its tip, 60 m/s²", quantity, float(theirs), float(ours), unit, allowed, source,
                  lever)  # fmt: skip
    radius, rate = 0.5, 40.0
    spun = static(assemble(beam, Model("FOAM", 8, 0, 1)), Hub(radius=radius, rate=constant(rate)))
    assert spun.loads is not None
    pull = rate**2 * (line * (radius * length + length**2 / 2) + tip * (radius + length))
    ours = float(np.linalg.norm(spun.loads.force[0, 0]))
    yield Row("the same on a hub, 40 rad/s", "root force", pull, ours, "N", 1e-5,
              "derived: Ω² ∫ρA (R + x) dx + m Ω² (R + L)", "the stretch adds its share")  # fmt: skip
