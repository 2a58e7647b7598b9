"""Strips of solid elements (C3D20R) between two ends in CalculiX, with large deformations, and beams in gbeam: von
Kármán's clamped beam under an even load, a shallow arch of half a sine on two pins, whose rise is three radii of
gyration, and Williams' toggle frame, pushed through their snap in the middle. CalculiX has no arc length: there the
middle's section is moved and its force read, here `gb.equilibrium_path` follows the load. Poisson's ratio is 0; the
pins are the middles of rigid ends. Elements half as long, and twice as many through the thickness, change CalculiX's
limit loads by less than 2e-5.

What the curves differ by is told along displacements up to twice the rise, as a share of the largest load on the way. A
force in the middle bends a beam with a kink in its curvature, to which shapes come slowly: FOAM has six along z (for
the frame `path` states the error in the remark), and the exact model ten, and shear. CalculiX's stress is linear in
Green's strain, a beam's forces in the stretch: under a thrust N it has EI (1 - 3 N/EA) and EA (1 - 3/2 N/EA), which
"as compressed" tells of a limit load, and a bent strip's thrust is less by the mean of 3/2 EI κ². Of the frame at twice
its rise, with κ = 6 w/l² at the ends of its members, that is 16 N, most of what the exact model's thrust differs by.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache, partial
from typing import NamedTuple

import meshio
import numpy as np
from scipy.interpolate import CubicSpline

import gbeam as gb
from gbeam.constants import ModelKind
from gbeam.mechanics import section_forces
from gbeam.results import Base
from validation.codes.calculix_solid import Specimen, run
from validation.codes.calculix_specimens import grid
from validation.table import Row

TITLE = "CalculiX: a beam, an arch and a frame of solid elements between two ends, through their snap"
NEEDS = ("calculix-ccx", "numpy", "scipy", "meshio")
COUNTS, CAP = (120, 1, 2), 2  # elements along, across and through the thickness; of a rigid end
SOURCE = "{} × {} × {} C3D20R".format(*COUNTS)
STEPS, PAST = 50, 2.0  # of a push; times the rise
INCH, POUND = 0.0254, 4.4482216152605
EA, EI = 1.885e6 * POUND, 9.27e3 * POUND * INCH**2  # of Williams' frame
METAL = gb.Material(2700.0, 70e9, poissons_ratio=0.0)
RIGID = gb.Material(2700.0, 70e13, poissons_ratio=0.0)
HELD, LIMIT, ALONG = 1e-3, 2e-3, 1.5e-2
EVEN = 2000.0  # m/s² on the clamped beam
KINDS: dict[str, tuple[ModelKind, dict[str, int]]] = {
    "FOAM": ("FOAM", {"axial": 2, "z": 6}),
    "exact": ("exact", {"axial": 2, "z": 10, "shear_z": 4}),
}


class Strip(NamedTuple):
    """A strip over a span along x, m: straight, or two straight halves, or half a sine on pins, up to its rise."""

    span: float
    width: float
    thickness: float
    rise: float = 0.0
    pinned: bool = False

    def middle(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Height of its middle at x, m, and its slope."""
        if self.pinned:
            wave = np.pi / self.span
            return self.rise * np.sin(wave * x), self.rise * wave * np.cos(wave * x)
        slope = 2 * self.rise / self.span
        return slope * np.minimum(x, self.span - x), slope + 0 * x


SHEET = 0.004
BEAM = Strip(0.6, 0.02, SHEET)
ARCH = Strip(0.6, 0.02, SHEET, rise=3 * SHEET / np.sqrt(12), pinned=True)
DEPTH = np.sqrt(12 * EI / EA)
TOGGLE = Strip(2 * 12.943 * INCH, EA / METAL.youngs_modulus / DEPTH, DEPTH, rise=0.386 * INCH)
# What each is pushed by along z, N, and times that at which gbeam's path ends.
PUSHED = {"shallow arch": (ARCH, 8.0, 1.8), "Williams' frame": (TOGGLE, 150.0, 4.0)}


@cache
def solid(strip: Strip) -> gb.SolidMesh:
    """Its mesh, of sections along z: held at its ends, or at their middles, with rigid elements beyond."""
    along, *others = COUNTS
    more = CAP * strip.pinned
    beyond = more * strip.span / along
    points, cells = grid((along + 2 * more, *others), (strip.span + 2 * beyond, strip.width, strip.thickness))
    x, across, through = points.T
    x = x - beyond
    nearest = np.clip(x, 0, strip.span)
    height, slope = strip.middle(nearest)
    places = np.stack([x, across, height + slope * (x - nearest) + through * np.sqrt(1 + slope**2)], axis=1)
    held = (np.isclose(x, 0) | np.isclose(x, strip.span)) & (~strip.pinned | np.isclose(through, 0))
    centre = x[cells].mean(axis=1)
    inside = (centre > 0) & (centre < strip.span)
    parts = {"strip": [np.flatnonzero(inside)]} | ({"rigid": [np.flatnonzero(~inside)]} if strip.pinned else {})
    mesh = meshio.Mesh(
        places, {"hexahedron20": cells}, point_sets={"held": np.flatnonzero(held)}, cell_sets=parts
    )  # fmt: skip
    return gb.SolidMesh.read(mesh, materials=metals(strip), clamp="held", unit="m")


def metals(strip: Strip) -> dict[str, gb.Material]:
    """Materials by the name of the part."""
    return {"strip": METAL} | ({"rigid": RIGID} if strip.pinned else {})


def followed(strip: Strip, load: str, count: int) -> np.ndarray:
    """Displacement of the middle along -z, m, force on it along -z and thrust at the first end, N, in (count + 1) rows,
    as a load grows from none.
    """
    mesh = solid(strip)
    x = mesh.points[:, 0]
    sets = {"ROOT": mesh.clamped & (x < strip.span / 2), "APEX": np.isclose(x, strip.span / 2)}
    lines = list[str]()
    for name, which in sets.items():
        lines += [f"*NSET, NSET={name}", *map(str, np.flatnonzero(which) + 1)]
    lines += ["*STEP, NLGEOM, INC=100000", "*CONTROLS, PARAMETERS=FIELD", "1e-6, 1e-6, , , 1e-6, , ,"]
    lines += ["*STATIC, DIRECT", f"{1 / count:.12g}, 1.", load, "*NODE PRINT, NSET=APEX", "U"]
    lines += [line for name in sets for line in (f"*NODE PRINT, NSET={name}, TOTALS=ONLY", "RF")]
    text = run("\n".join([*lines, "*END STEP", ""]), "dat", Specimen(partial(solid, strip), metals(strip), "C3D20R"))
    moved = re.findall(r"displ.*\n\n((?: +\d+ .*\n)+)", text)
    sunk = [np.mean([float(line.split()[3]) for line in table.splitlines()]) for table in moved]
    force, thrust = (
        np.array(re.findall(rf"total force.*set {name} .*\n\n +(\S+) +(\S+) +(\S+)", text), dtype=float)
        for name in ("APEX", "ROOT")
    )
    return np.vstack([np.zeros(3), np.stack([-np.array(sunk), -force[:, 2], thrust[:, 0]], axis=1)])


@cache
def model(strip: Strip, kind: str, push: float = 0.0, thrust: float = 0.0) -> gb.Structure:
    """The strip in gbeam, under a force in its middle of `push` N for each second, and as compressed by a thrust, N."""
    x = np.linspace(0, strip.span, 9)
    corners = x if strip.pinned else np.array([0, strip.span / 2, strip.span])
    line = gb.Line.of_points(np.stack([corners, 0 * corners, strip.middle(corners)[0]], axis=1), smooth=strip.pinned)
    ends = [gb.Support("tip", ["x", "z", "ry"])]
    if strip.pinned:
        ends = [gb.Support(0.0, ["x", "y", "z", "rx", "rz"]), gb.Support("tip", ["x", "z"])]
    section = gb.Section.rectangle(strip.width, strip.thickness)
    if thrust:
        area, even = strip.width * strip.thickness, np.ones(2)
        strain = thrust / (METAL.youngs_modulus * area)
        shear = section.shear_coefficients(0.0, 0.0)
        section = gb.Section.general(
            area * (1 - 1.5 * strain) * even,
            area * strip.thickness**2 / 12 * (1 - 3 * strain) * even,
            area * strip.width**2 / 12 * even,
            line.length * np.arange(2),
            torsion_constant=section.torsion_constant(0.0) * even,
            shear_coefficient_y=float(shear[0]) * even,
            shear_coefficient_z=float(shear[1]) * even,
        )
    clock = np.array([-5.0, 0.0, 5.0])
    force = gb.tabulated(clock, np.outer(clock, [0.0, 0.0, -push]))
    beam = gb.Beam(
        line.length, section, METAL, supports=ends, line=line if strip.rise else None,
        loads=[gb.Load(at="middle", force=force)] * bool(push), points=[gb.Point("middle", at=line.length / 2)],
    )  # fmt: skip
    name, shapes = KINDS[kind]
    return gb.assemble(beam, name, **shapes)


def path(
    strip: Strip, kind: str, push: float, upper: float, *, errors: bool, thrust: float = 0.0
) -> tuple[gb.EquilibriumPath, np.ndarray]:
    """Path under a push, and what :func:`followed` has of CalculiX."""
    structure = model(strip, kind, push, thrust)
    answer = gb.equilibrium_path(structure, time=1.0, upper=upper, errors=errors)
    place = [name.rpartition(".")[2] for name in answer.points].index("middle")
    still, rest = np.zeros((len(answer.q), 3)), 0 * answer.q
    loads = section_forces(structure, Base(still, still, still), answer.q, rest, rest, answer.factor)
    assert loads.support_force is not None
    columns = -answer.displacement[:, place, 2], push * answer.factor, -loads.support_force[:, -1, 0]
    return answer, np.stack(columns, axis=1)


def rows() -> Iterator[Row]:
    """A clamped beam by its load, the other two by their displacement."""
    yield from clamped_beam()
    for name, (strip, push, upper) in PUSHED.items():
        theirs = followed(strip, f"*BOUNDARY\nAPEX, 3, 3, {-PAST * strip.rise:.12g}", STEPS)
        for kind in KINDS:
            yield from snapped(name, strip, kind, push, upper, theirs)


def clamped_beam() -> Iterator[Row]:
    """Deflection and the force along x at its ends."""
    theirs = followed(BEAM, f"*DLOAD\nEALL, GRAV, {EVEN}, 0., 0., -1.", 10)
    for kind in KINDS:
        for step in (1, 4, 10):
            rest = gb.static(model(BEAM, kind), acceleration=(0.0, 0.0, EVEN * step / 10))
            assert rest.loads is not None and rest.loads.support_force is not None
            case, thrust = f"clamped beam, {kind}, {EVEN * step / 10:g} m/s²", rest.loads.support_force[0, -1, 0]
            yield Row(case, "deflection", 1e3 * theirs[step, 0], -1e3 * rest.at("beam.middle")[2], "mm", HELD, SOURCE)
            yield Row(case, "pull along x at the ends", -theirs[step, 2], thrust, "N", HELD, SOURCE)


def snapped(name: str, strip: Strip, kind: str, push: float, upper: float, theirs: np.ndarray) -> Iterator[Row]:
    """Limit loads, and loads and thrusts along the path."""
    case, sunk = f"{name}, {kind}", theirs[:, 0]
    force, thrust = (CubicSpline(sunk, column) for column in theirs.T[1:])
    turns = force.derivative().roots(extrapolate=False)
    judged = not strip.pinned  # those of the arch take minutes
    answer, ours = path(strip, kind, push, upper, errors=judged and kind == "FOAM")
    remarks = ["", ""]
    if judged and kind == "FOAM":
        remarks = [f"{100 * point.errors.total:.1g} % stated" for point in answer.critical]
    elif judged:
        pressed, _ = path(strip, kind, push, 1.1, errors=False, thrust=float(thrust(turns[0])))
        changes = [one.factor / other.factor - 1 for one, other in zip(pressed.critical, answer.critical, strict=True)]
        remarks = [f"{100 * change:+.1g} % as compressed" for change in changes]
    words = "largest load before the snap", "least load after it"
    for quantity, wanted, point, remark in zip(words, force(turns), answer.critical, remarks, strict=True):
        yield Row(case, quantity, float(wanted), push * point.factor, "N", LIMIT, SOURCE, remark)
    along = ours[ours[:, 0] <= sunk[-1]]
    sizes = {"load": np.abs(theirs[:, 1]).max(), "thrust": np.abs(theirs[:, 2]).max()}
    for column, ((quantity, size), curve) in enumerate(zip(sizes.items(), (force, thrust), strict=True), 1):
        mine = CubicSpline(ours[:, 0], ours[:, column])
        for times in (0.5, 1.0, 1.5):
            reference, answered = (float(each(times * strip.rise)) for each in (curve, mine))
            yield Row(case, f"{quantity} at {times:g} times the rise", reference, answered, "N", ALONG, SOURCE)
        away = 100 * np.abs(along[:, column] - curve(along[:, 0])).max() / size
        yield Row(case, f"{quantity}, largest difference over its size", 0.0, float(away), "%", 100 * ALONG, SOURCE)
