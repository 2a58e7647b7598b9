"""Cases by seed: every kind of specimen on every kind of motion, by every model that it has, asked every question."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

import gbeam as gb
from tests.solids.bodies import STIFF, block, solid

COUNT = 200
MODELS = "FOAM", "TLAM", "exact", "CFOAM", "fourth-order", "SFOAM"
MOTIONS = "flight", "turning flight", "outward hub", "inward hub", "free hub", "centrifuge", "rest"
QUESTIONS = "static", "modes", "campbell", "critical"
INTEGRATORS = "gauss", "newmark", "hht", "generalized-alpha"
LENGTH = 0.4
ALUMINIUM = gb.Material(2700.0, 70e9, poissons_ratio=0.3)


@dataclass(frozen=True)
class Former:
    """A structure in a motion, the settings of its response, and a further question that is asked."""

    kind: str
    structure: gb.Structure
    motion: Any
    settings: gb.ResponseSettings
    question: str


@cache
def case(seed: int) -> Former:
    """The case of a seed: kinds and motions go round, the rest is drawn."""
    random = np.random.default_rng(seed)
    kind, of_motion = list(SPECIMENS)[seed % len(SPECIMENS)], MOTIONS[seed // len(SPECIMENS) % len(MOTIONS)]
    if kind == "box" and of_motion == "free hub":
        of_motion = "outward hub"
    structure = SPECIMENS[kind](random, of_motion)
    period = 2 * np.pi / float(structure.rest[0][0]) if structure.size else 0.02
    moved = abs(float(gb.static(structure, acceleration=(0, 0, 1.0)).tip[2])) if structure.size else 1e-6
    per_unit = float(f"{moved:.6g}")  # of which no machine has other digits
    size = float(np.exp(random.uniform(np.log(1e-4), np.log(0.03)))) * LENGTH / max(per_unit, 1e-6)
    duration = float(random.uniform(3, 6)) * period
    motion = _motion(random, of_motion, min(size, 300.0), period, duration)
    begin: Any = str(random.choice(["equilibrium", "equilibrium", "undeformed", "relief"]))
    if of_motion == "rest" and structure.size:
        begin = gb.Initial(acceleration=(0.0, 0.1 * size, size)) if random.random() < 0.5 else _drawn(structure, random)
    default = "gauss" if of_motion == "free hub" else "newmark"  # as it was when the answers were recorded
    integrator = (default, *INTEGRATORS)[int(random.integers(1 + len(INTEGRATORS)))]
    fixed = random.random() < 0.85 or of_motion == "centrifuge" or structure.kind in ("fourth-order", "solid")
    step = period / float(random.uniform(40, 150)) if fixed else None
    settings = gb.ResponseSettings(duration, step=step, integrator=integrator, initial=begin)
    # A search for the critical rate of an exact beam takes as long as ten others.
    questions = QUESTIONS[: 2 if "ward hub" not in of_motion else 3 if structure.kind == "exact" else 4]
    question = "static" if of_motion == "centrifuge" else questions[seed % len(questions)]
    return Former(kind, structure, motion, settings, question)


def _drawn(structure: gb.Structure, random: np.random.Generator) -> gb.Initial:
    """Release from a displaced and moving tip, along axes that have shapes."""
    axes = [axis for axis in "yz" if "xyz".index(axis) not in structure.axes_without_shapes]
    size = LENGTH * float(random.uniform(1e-3, 1e-2))
    return gb.Initial(tip_displacement={axes[0]: size}, tip_velocity={axes[-1]: 2 * size})


def _motion(random: np.random.Generator, kind: str, size: float, period: float, duration: float) -> Any:
    """A motion of a kind whose acceleration is about a size, m/s²."""
    rise = float(random.uniform(0.5, 2.0)) * period
    turned = {"gravity": (0.0, 0.0, -9.81)} if random.random() < 0.5 else {}
    if kind == "flight":
        ramp = gb.trapezoid(size, jerk=size / rise, start=0.2 * period, hold=0.5 * duration)
        return gb.Flight(x=gb.Sine(0.3 * size, 2 * rise), y=gb.constant(0.1 * size), z=ramp)
    if kind == "turning flight":
        times = np.linspace(0.0, duration, 7)
        values = gb.tabulated(times, size * random.normal(size=(7, 3)))
        rates = gb.smoothed(gb.tabulated(times, np.sqrt(size) * random.normal(size=(7, 3))), rise / 2)
        return gb.Flight(acceleration=gb.smoothed(values, rise / 2), rates=rates)
    rate = gb.SmoothStep(min(float(np.sqrt(size / LENGTH)), 0.3 / period), rise)
    if kind == "outward hub":
        return gb.Hub(radius=LENGTH * float(random.uniform(0.1, 1.0)), rate=rate, **turned)
    if kind == "inward hub":
        return gb.Hub(radius=LENGTH * float(random.uniform(1.5, 3.0)), pointing="inward", rate=rate, **turned)
    if kind == "free hub":
        torque = gb.Sine(0.1 * size, 2 * rise)
        return gb.Hub(radius=0.5 * LENGTH, inertia=0.1, torque=torque, damping=float(random.choice([0.0, 0.05])))
    if kind == "centrifuge":
        level = max(size, 1.0)
        change = gb.smoothed(gb.trapezoid(0.5 * level, jerk=level / rise, start=rise, hold=0.3 * duration), period)
        flight = gb.Flight(z=gb.Sum((gb.constant(level), change)))
        how: dict[str, Any] = {"inverse": "flat", "start": "idle", "idle": 0.5 * level, "gravity": False}
        return gb.Centrifuge(flight, arm=5.0, control_point=0.7 * LENGTH, smoothing=0.1 * period, **how)
    return gb.Flight(z=0.0)


def _beam(random: np.random.Generator, motion: str) -> gb.Structure:
    """A straight beam with bodies, loads or a sprung root, by any model."""
    kind = MODELS[int(random.integers(len(MODELS)))]
    section = gb.Section.rectangle(LENGTH / random.uniform(10, 30), LENGTH / random.uniform(60, 150))
    masses = [gb.PointMass(LENGTH, float(random.choice([0.0, 0.05])))]
    if random.random() < 0.3:
        masses += [gb.PointMass(LENGTH / 2, 0.02, inertia=(1e-5, 2e-5, 2e-5), offset=(0.0, 0.01, -0.005))]
    root = gb.Root(rotation_y=40.0, rotation_z=60.0) if random.random() < 0.2 else gb.Root()
    loads = (
        [gb.Load(0.8 * LENGTH, force=gb.vector(y=gb.constant(0.02), z=gb.Sine(0.1, 0.3)))] if motion == "rest" else []
    )
    ratio = float(random.choice([0.0, 0.005, 0.02]))
    beam = gb.Beam(LENGTH, section, ALUMINIUM, masses, damping_ratio=ratio, root=root, loads=loads)
    shapes = "clamped-free" if root == gb.Root() and random.random() < 0.6 else "adapted"
    axial = 0 if kind == "SFOAM" else int(random.integers(1, 3))
    return gb.assemble(
        beam, kind, axial=axial, y=int(random.integers(1, 3)), z=int(random.integers(1, 4)), shapes=shapes
    )


def _bent(random: np.random.Generator, motion: str) -> gb.Structure:
    """A beam on a curved and twisted line."""
    line = gb.Line.of_pieces([LENGTH], twist=[0.4], turn_y=[float(random.uniform(-0.8, 0.8))], turn_z=[0.3])
    section = gb.Section.rectangle(LENGTH / 20, LENGTH / 80)
    beam = gb.Beam(LENGTH, section, ALUMINIUM, [gb.PointMass(LENGTH, 0.02)], damping_ratio=0.01, line=line)
    return gb.assemble(beam, str(random.choice(["FOAM", "exact"])), axial=1, y=2, z=2, twist=1)


def _tapered(random: np.random.Generator, motion: str) -> gb.Structure:
    """A beam of sections that change, thick enough to shear."""
    section = gb.Section.rectangle([LENGTH / 10, LENGTH / 16], [LENGTH / 30, LENGTH / 60], stations=[0.0, LENGTH])
    beam = gb.Beam(LENGTH, section, ALUMINIUM, damping_ratio=0.01)
    kind = str(random.choice(["FOAM", "exact", "fourth-order"]))
    more = {"shear_z": 1, "twist": 1} if kind == "exact" else {}
    return gb.assemble(beam, kind, axial=1, y=1, z=2, shapes="adapted", **more)


def _particles(random: np.random.Generator, motion: str) -> gb.Structure:
    """Particles in a mesh's mass and stiffness matrices."""
    nodes = np.column_stack([np.linspace(0.0, LENGTH, 6), np.zeros((6, 2))])
    stretch, bend = np.diff(np.eye(6), axis=0), np.diff(np.eye(6), 2, axis=0)
    of_axes = 1e7 * stretch.T @ stretch, 4e4 * bend.T @ bend, 1e4 * bend.T @ bend
    stiffness = sum(np.kron(k, np.outer(axis, axis)) for k, axis in zip(of_axes, np.eye(3), strict=True))
    model = gb.ImportedModel(0.02 * np.eye(18), stiffness, nodes)
    modes = int(random.integers(2, 5))
    return model.reduced(modes=modes, damping_ratio=0.01, clamp=[0, 1], points={"tip": 5})


def _solid(random: np.random.Generator, motion: str) -> gb.Structure:
    """A bracket of solid elements, with a coarser one beside it."""
    return _reduced(int(random.integers(2, 5)))


@cache
def _reduced(modes: int) -> gb.Structure:
    meshes = (solid(block("hexahedron20", cells, (LENGTH, 0.02, 0.005)), STIFF) for cells in ((6, 1, 1), (3, 1, 1)))
    fine, coarse = meshes
    beside = coarse.reduced(modes=modes, damping_ratio=0.01)
    return fine.reduced(modes=modes, damping_ratio=0.01, coarser=beside).structure


def _box(random: np.random.Generator, motion: str) -> gb.Structure:
    """A rigid specimen on bolts."""
    bolts = [(0.1, 0.05, 0), (-0.1, 0.05, 0), (0.1, -0.05, 0), (-0.1, -0.05, 0)]
    centre = (0.01, 0.0, float(random.uniform(0.03, 0.06)))
    return gb.RigidSpecimen.box(2.0, (0.3, 0.2, 0.1), centre, bolts=bolts, bolt_axis=(0, 0, 1)).structure


SPECIMENS: dict[str, Callable[[np.random.Generator, str], gb.Structure]] = {
    "beam": _beam,
    "bent beam": _bent,
    "tapered beam": _tapered,
    "solid": _solid,
    "matrices": _particles,
    "box": _box,
    "another beam": _beam,
}
