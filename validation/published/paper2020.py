"""Every number that the 2020 paper prints: what it says, what gbeam answers, and why where they differ.

The paper was read as text without its figures; "not legible" is said of that text. It does not state its arm, its
inverse kinematics, how corners are rounded, nor the profiles of Figs. 4 and 6. An arm of 3.3 m follows from its excess
at 6 g; a Hann kernel of 59.6 ms is fitted to its vibration, so that the rows on vibration are a consistency check.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from gbeam import static
from validation.published import zhang2020
from validation.published.specimens import (
    ARM_2020,
    MIDDLE_2020,
    centrifuge_2020,
    flight_2020,
    strip,
    strip_beam,
)
from validation.table import Row

TITLE = "Beam on a three-axis centrifuge (2020): every printed number"
NEEDS = ()
SOURCE = "Zhang, Lu, Liu and Yang 2020, doi:10.21595/jve.2020.21118"
KERNEL = 0.0596  # s
FITTED = f"corners rounded over {1e3 * KERNEL:.1f} ms, a width that is fitted: a consistency check"
NO_FIGURE = "not legible: the load's figure"


def row(
    case: str, quantity: str, printed: str | None, ours: float | None, unit: str, tolerance: float, remark: str = ""
) -> Row:
    """A row of this paper."""
    return Row(case, quantity, printed, ours, unit, tolerance, SOURCE, remark)


def rows() -> Iterator[Row]:
    """All rows, in the paper's order."""
    yield row("section 1", "accelerations of flight, up to", "20", None, "g", 0.0, "quoted there from its [1]")
    yield row("section 1", "jerks of flight, up to", "15", None, "g/s", 0.0, "quoted there from its [1]")
    yield from table_1()
    yield from examples_1_to_3()
    yield from example_4()
    yield row("section 4, Figs. 3–10", "curves and axes", None, None, "", 0.0, "not legible: the text has no figures")
    yield from equations()


def table_1() -> Iterator[Row]:
    """Inputs, read back from gbeam's beam, and the numbers of shapes."""
    beam = strip_beam()
    values, case = beam.section.at(0.0), "section 4, Table 1"
    width = 2 * float(values.extreme_fibre_y)
    for quantity, printed, ours, unit in (
        ("density", "2700", beam.material.density, "kg/m³"),
        ("Young's modulus", "70e9", beam.material.youngs_modulus, "N/m²"),
        ("length", "0.3", beam.length, "m"),
        ("width", "0.02", width, "m"),
        ("thickness", "0.004", 2 * float(values.extreme_fibre_z), "m"),
    ):
        yield row(case, quantity, printed, ours, unit, 1e-12)
    yield row(case, "Poisson's ratio", "0.3", None, "", 0.0, "enters neither the paper's equations nor gbeam's")
    counts = strip("FOAM", *zhang2020.COUNTS).counts
    for k, (name, printed) in enumerate((("n1", "1"), ("n2", "3"), ("n3", "3"))):
        yield row("section 3", f"number of shapes {name}", printed, counts[k], "", 0.0)
    yield row("section 4", "control point over the length", "0.5", MIDDLE_2020 / beam.length, "", 1e-12,
              "it lies on axes 2 and 3; the text says 1 and 2, which are parallel")  # fmt: skip


def tip(motion: object) -> float:
    """Static deflection of the tip along z, mm."""
    return 1e3 * float(abs(static(strip("FOAM", *zhang2020.COUNTS), motion, time=0.5).tip[2]))  # type: ignore[arg-type]


def examples_1_to_3() -> Iterator[Row]:
    """6 g in both environments; three directions."""
    case, six = "section 4.1, example 1", tip(flight_2020(6.0))
    excess = 100 * (tip(centrifuge_2020(6.0)) / six - 1)
    yield row(case, "excess of the tip on the centrifuge at 6 g", "0.02", excess, "%", 0.02,
              f"the arm of {ARM_2020} m, not printed, follows from this")  # fmt: skip
    yield row(f"{case}, Fig. 3(b)", "axis along the beam, from 0.2985 m to 0.3 m", None, None, "", 0.0,
              "not legible: the curve; both say that the centrifuge bends the tip more")  # fmt: skip
    yield row("section 4.2, example 2", "tip on the plateau of 6 g", None, six, "mm", 0.0,
              f"{NO_FIGURE}; wL⁴/8EI is 1.7240 mm")  # fmt: skip
    case = "section 4.3, example 3"
    for quantity, printed in (("on the centrifuge", "3.136"), ("in flight", "3.148")):
        yield row(case, f"largest tip deflection {quantity}", printed, None, "mm", 0.0, NO_FIGURE)
    level = 3.148 / tip(flight_2020(1.0))
    yield row(case, "steady load that gives the printed tip in flight", None, level, "g", 0.0,
              f"{NO_FIGURE}; the load must reach about this")  # fmt: skip


def example_4() -> Iterator[Row]:
    """Table 2: jerks of 4, 8 and 10 g/s to a plateau of 10 g."""
    sys.path.insert(0, str(Path(__file__).parents[2] / "examples"))
    from jerk_study import jerk_study

    structure, g, case = strip("FOAM", *zhang2020.COUNTS), zhang2020.G0, "section 4.4, Table 2"
    jerks = np.array([4.0, 8.0, 10.0])
    study = jerk_study(structure, jerks * g, [ARM_2020], law="flat", level=10 * g, smoothing=KERNEL)
    flight, machine = tip(flight_2020(10.0)), tip(centrifuge_2020(10.0))
    why = "0.04 %, unexplained; wL⁴/8EI is 2.8734 mm with g = 9.81 m/s²"
    for jerk, printed, ours in zip(jerks, ("0.083", "0.170", "0.215"), 1e3 * study.simulated[:, 0], strict=True):
        at = f"{jerk:g} g/s"
        yield row(case, f"static tip on the centrifuge, {at}", "2.876", machine, "mm", 2e-4, why)
        yield row(case, f"elastic vibration on the centrifuge, {at}", printed, float(ours), "mm", 8e-3, FITTED)
        yield row(case, f"static tip in flight, {at}", "2.875", flight, "mm", 2e-4, why)
    c = structure.coefficients
    mode = 4  # the first along z, after one axial and three along y
    first = np.sqrt(c.stiffness[mode, mode] / c.mass[mode, mode])
    corner = 2 * abs(c.f_a[2, mode]) / c.mass[mode, mode] * 4 * g / first**3  # c₁ j/ω₁, |f(L)| = 2
    ratio = study.simulated[0, 0] / corner
    yield row("section 4.4", 'elastic vibration in flight, "much smaller": centrifuge over flight at 4 g/s', None,
              float(ratio), "", 0.0, "no number is printed; in flight a sharp corner leaves c₁ j/ω₁")  # fmt: skip
    for quantity, printed in (("plateau", "10 g"), ("kept for", "4 s"), ("start", "1 s")):
        yield row(case, f"load: {quantity} {printed}", None, None, "", 0.0,
                  "an input; the vibration after the plateau's corner depends on the plateau alone")  # fmt: skip


def equations() -> Iterator[Row]:
    """(20)–(22) and the F that is not printed, with the errata of zhang2020.py, at a random motion of the base."""
    a, w, al = np.random.default_rng(0).normal(size=(3, 3)) * [[100], [30], [1000]]
    paper, c = zhang2020.matrices(a, w, al), strip("FOAM", *zhang2020.COUNTS).coefficients
    scale = zhang2020.LINE * zhang2020.LENGTH  # Φ = f/√(mL)
    G, K, F = c.evaluate(a, w, al)
    errata = "with the errata beside the equations (validation/published/zhang2020.py), as printed they differ"
    for name, equation, ours, theirs in (
        ("M", "(20)", c.mass / scale, paper.M),
        ("G", "(21)", G / scale, paper.G),
        ("K", "(22)", K / scale, paper.K),
        ("F", "(16), not printed", F / np.sqrt(scale), paper.F),
    ):
        gap = float(np.abs(ours - theirs).max() / np.abs(theirs).max())
        yield row(f"appendix A2, {equation}", f"{name}: largest difference", "0", gap, "", 1e-10, errata)
    square = np.linalg.eigvals(np.linalg.solve(c.mass, c.stiffness)).real.min()
    yield row("section 3, (13)", "first natural frequency", None, float(np.sqrt(square) / (2 * np.pi)), "Hz", 0.0,
              "not in the paper; independent: 36.5565 Hz")  # fmt: skip
