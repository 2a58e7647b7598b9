"""Small vibrations, steady deflections and a slew of beams on a turning base, by cubic finite elements written for this
purpose in `validation/codes/hermite_beam.py`: stretch and both deflections, consistent mass, tension integrated along
the beam, Coriolis' and Euler's forces, taper and a mass at the tip. That is the theory of FOAM, by other means. The
difference is the number of gbeam's shapes, and for the slew the steps.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

import gbeam as gb
from validation.codes.hermite_beam import HermiteBeam
from validation.table import Row

TITLE = "Hermite finite elements: beams on a turning base"
NEEDS = ("numpy", "scipy")
SOURCE = "40 cubic elements"
CLOSE = 2e-5
STATED = 0.2  # of a stated error: its size is asked for, not its digits


def rows() -> Iterator[Row]:
    """Frequencies, deflections and a slew."""
    yield from unit_blades()
    yield from fast_blade()
    yield from tapered_blade()
    yield from strip_in_space()
    yield from slew()


def hub_base(rate: float, radius: float, setting: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Acceleration of the root and angular velocity at a steady rate, axes turned by `setting` about the beam."""
    return np.array([-radius * rate**2, 0, 0]), rate * np.array([0, np.sin(setting), np.cos(setting)])


def unit_blade(slenderness: float, tip: float, elements: int) -> tuple[HermiteBeam, gb.Beam]:
    """ρA = EI_y = L = 1 and I_z = 4 I_y, in either code: rates and frequencies are in √(EI_y/(ρAL⁴))."""
    i_y = slenderness**-2.0
    fine = HermiteBeam(
        1.0, np.ones_like, lambda x: i_y + 0 * x, lambda x: 4 * i_y + 0 * x, 1.0, slenderness**2, tip, elements
    )
    masses = [gb.PointMass(1.0, tip)] if tip else []
    section, material = gb.Section.general(1.0, i_y, 4 * i_y), gb.Material(1.0, slenderness**2)
    return fine, gb.Beam(1.0, section, material, masses, rotary_inertia=False)


def unit_blades() -> Iterator[Row]:
    """At slenderness 70 the stretch takes part; a setting angle couples flap and chord."""
    cases = [(12.0, 0.0, 0.0, 0.0, 1e3), (4.0, 3.0, 0.0, 1.0, 1e3), (10.0, 0.0, 0.0, 0.0, 70.0),
             (10.0, 1.0, 30.0, 0.5, 70.0)]  # fmt: skip
    for rate, radius, degrees, tip, slenderness in cases:
        setting = np.deg2rad(degrees)
        elements, beam = unit_blade(slenderness, tip, 40)
        reference = elements.frequencies(*hub_base(rate, radius, setting), 4)
        structure = gb.assemble(beam, "FOAM", axial=8, y=20, z=20, shapes="adapted")
        ours = 2 * np.pi * gb.modes(structure, gb.Hub(radius=radius, rate=rate, setting_angle=setting)).frequency
        case = (
            f"blade, slenderness {slenderness:g}, rate {rate:g}, hub {radius:g}, tip mass {tip:g}, set at {degrees:g}°"
        )
        for i in range(4):
            yield Row(case, f"frequency {i + 1}", reference[i], ours[i], "", CLOSE, SOURCE)


def fast_blade() -> Iterator[Row]:
    """Blade whose tension outweighs its bending: the modes at rest are a slow basis."""
    elements, beam = unit_blade(1e3, 0.0, 80)
    reference = elements.frequencies(*hub_base(50.0, 0.0), 2)
    for count in (3, 10, 30):
        structure = gb.assemble(beam, "FOAM", axial=8, y=count, z=count)
        vibration = gb.modes(structure, gb.Hub(radius=0.0, rate=50.0))
        for i, direction in enumerate(("chord", "flap")):
            case, words = "blade, slenderness 1000, rate 50", f"first {direction}, {count} shapes"
            ours = 2 * np.pi * vibration.frequency[i]
            yield Row(case, words, reference[i], ours, "", CLOSE, "80 cubic elements",
                      "too few shapes: converging from above")  # fmt: skip
            true, stated = 100 * (ours / reference[i] - 1), 100 * vibration.errors.shapes[i]
            yield Row(case, f"{words}: its error, true and as stated", true, stated, "%", STATED, "80 cubic elements")


def tapered_blade() -> Iterator[Row]:
    """Width and thickness halve from root to tip, with a mass on it."""
    length, density, modulus, tip, rate, radius = 0.3, 2700.0, 70e9, 0.002, 300.0, 0.1

    def width(x: np.ndarray) -> np.ndarray:
        return 0.02 * (1 - x / (2 * length))

    def thickness(x: np.ndarray) -> np.ndarray:
        return 0.004 * (1 - x / (2 * length))

    elements = HermiteBeam(
        length,
        lambda x: width(x) * thickness(x),
        lambda x: width(x) * thickness(x) ** 3 / 12,
        lambda x: thickness(x) * width(x) ** 3 / 12,
        density,
        modulus,
        tip,
    )
    section = gb.Section.rectangle((0.02, 0.01), (0.004, 0.002), stations=(0.0, length))
    beam = gb.Beam(length, section, gb.Material(density, modulus), [gb.PointMass(length, tip)], rotary_inertia=False)
    structure = gb.assemble(beam, "FOAM", axial=3, y=10, z=10, shapes="adapted")
    reference = elements.frequencies(*hub_base(rate, radius), 4) / (2 * np.pi)
    ours = gb.modes(structure, gb.Hub(radius=radius, rate=rate)).frequency
    for i in range(4):
        yield Row("blade tapered to half, tip mass 2 g, 300 rad/s", f"frequency {i + 1}", reference[i], ours[i], "Hz",
                  CLOSE, SOURCE)  # fmt: skip


def strip_in_space() -> Iterator[Row]:
    """The strip of 2020 at 10 g and 1 g along it, turning about all three axes: rates beyond what a machine does."""
    a, w = np.array([-9.8, 30.0, 98.0]), np.array([40.0, 25.0, -60.0])
    elements = HermiteBeam(0.3, *(lambda x, c=c: c + 0 * x for c in (8e-5, 20 * 4**3 / 12e12, 4 * 20**3 / 12e12)),
                           2700.0, 70e9)  # fmt: skip
    beam = gb.Beam(0.3, gb.Section.rectangle(0.02, 0.004), gb.Material(2700.0, 70e9), rotary_inertia=False)
    structure = gb.assemble(beam, "FOAM", axial=8, y=8, z=8)
    flight = gb.Flight(acceleration=gb.constant(a), rates=gb.constant(w))
    tip, ours = elements.static(a, w), gb.static(structure, flight).tip
    case = "strip of 2020, 10 g across, turning about all axes"
    for i, axis in enumerate("yz", 1):
        yield Row(case, f"tip, {axis}", 1e3 * tip[i], 1e3 * ours[i], "mm", CLOSE, SOURCE)
    reference = elements.frequencies(a, w, 4) / (2 * np.pi)
    frequency = gb.modes(structure, flight).frequency
    for i in range(4):
        yield Row(case, f"frequency {i + 1}", reference[i], frequency[i], "Hz", CLOSE, SOURCE)


def slew() -> Iterator[Row]:
    """The hub-beam of 2009, slewed to 3 rad/s in 30 s: peak and residual of the tip."""
    level, duration, end, step = 3.0, 30.0, 50.0, 0.01

    def base(t: float) -> tuple[np.ndarray, ...]:
        s = min(t / duration, 1.0)
        rate = level * (s - np.sin(2 * np.pi * s) / (2 * np.pi))
        acceleration = level / duration * (1 - np.cos(2 * np.pi * s))
        return np.array([-0.5 * rate**2, 0.5 * acceleration, 0]), np.array([0, 0, rate]), np.array([0, 0, acceleration])

    constants = (7.2968e-5, 8.2189e-9, 8.2189e-9)
    elements = HermiteBeam(8.0, *(lambda x, c=c: c + 0 * x for c in constants), 2766.7, 6.8952e10, elements=8)
    times = np.arange(0.0, end + step / 2, step)
    tip = elements.history(base, times)[:, 1]
    section, metal = gb.Section.general(*constants), gb.Material(2766.7, 6.8952e10)
    beam = gb.Beam(8.0, section, metal, damping_ratio=0.0, rotary_inertia=False)
    structure = gb.assemble(beam, "FOAM", axial=2, y=8)
    hub = gb.Hub(radius=0.5, rate=gb.SmoothStep(level, duration))
    ours = gb.simulate(structure, hub, duration=end, step=step, integrator="newmark", residual_from=duration)
    case, source = "hub-beam of 2009, slew to 3 rad/s, FOAM", "8 cubic elements, trapezoidal rule, 10 ms"
    late = tip[times >= duration]
    yield Row(case, "peak of the tip", np.abs(tip).max(), ours.peaks.max_abs[1], "m", 1e-4, source)
    yield Row(case, "residual vibration", 1e3 * np.ptp(late) / 2, 1e3 * ours.peaks.residual_amplitude[1], "mm", 5e-3,
              source)  # fmt: skip
