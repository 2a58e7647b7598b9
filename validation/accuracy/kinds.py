"""Stated against true errors of every kind of specimen, and of systems of bodies, in random motions. The truth is the
exact model with eight adapted shapes across, or a mesh of half the size with more modes, by Gauss's method with 150
steps to the lowest period or more. Of matrices and of rigid boxes only the steps are judged, and stated.

What the theory of slender beams leaves out is in neither.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from typing import Any, NamedTuple

import numpy as np

import gbeam as gb
from gbeam.errors import GbeamError
from tests.former.cases import LENGTH, SPECIMENS, case
from tests.solids.bodies import STIFF, block, solid
from validation.table import Row

TITLE = "Stated against true errors of every kind of specimen"
NEEDS = ("numpy", "scipy", "jax", "meshio")
SEEDS = range(200, 300)  # the cases of answers that are recorded have those before
SYSTEMS = range(9)
PER_PERIOD = 150
SURE = 3e-6  # a true error below is not known from the truth's own
SOURCE = "more shapes, exact, or a finer mesh with more modes; small steps"
MOST = 3.0  # times the stated error
METAL = gb.Material(2700.0, 70e9, poissons_ratio=0.3)


class Judged(NamedTuple):
    """Stated and true errors of a case, of the deflections of bodies and of the loads at their roots."""

    kind: str
    deflections: tuple[float, float]
    loads: tuple[float, float]


def judged_specimen(seed: int) -> Judged | None:
    """Errors of the specimen of a seed, alone on what moves it; None where it or the truth has no answer.

    The elements of the cases' bracket lock, so that its mesh is not judged: another takes its place.
    """
    of = case(seed)
    specimen = _bracket(6, 2 + seed % 3) if of.kind == "solid" else of.structure
    period = 2 * math.pi / float(specimen.rest[0][0]) if specimen.size else of.settings.duration / 5
    return judged(of.kind, specimen, fuller(specimen), of.motion, of.settings, period)


def judged_system(seed: int) -> Judged | None:
    """Errors of the system of a seed; None where it or the truth has no answer."""
    kind, system, truth, period = drawn(seed)
    return judged(kind, system, truth, None, gb.ResponseSettings(2 * period, initial="undeformed"), period)


def judged(kind: str, specimen: Any, truth: Any, motion: Any, settings: gb.ResponseSettings, period: float) -> Any:
    """Stated and true errors, the latter by the truth's response; None where one of both has none."""
    moved = () if motion is None else (motion,)
    try:
        response = gb.simulate(specimen, *moved, settings=settings)
        interval = float(response.time[1] - response.time[0])
        finer = math.ceil(max(interval / period * PER_PERIOD, 2 * interval / response.step))
        small = replace(settings, step=interval / finer, integrator="gauss", estimate=False)
        fine = gb.simulate(truth, *moved, settings=small)
    except GbeamError:
        return None
    if response.outcome != "done" or fine.outcome != "done":
        return None
    names = [name for name, body in response.bodies.items() if body.loads is not None]
    deflections = [apart(response.bodies[name].displacement, fine.bodies[name].displacement, finer) for name in names]
    loads = [
        apart(getattr(response.bodies[name].loads, load), getattr(fine.bodies[name].loads, load), finer)
        for name in names
        for load in ("root_force", "root_moment")
    ]
    errors = response.errors
    unjudged = truth is specimen  # but for the steps
    stated = (each.step if unjudged else each.slender for each in (errors.displacement, errors.loads))
    true = max(deflections, default=0.0), max(loads, default=0.0)
    return Judged(kind, *zip(stated, true, strict=True))


def apart(ours: np.ndarray, theirs: np.ndarray, finer: int) -> float:
    """Largest difference of two histories, over the largest size of ours; zero where nothing is."""
    size = np.linalg.norm(ours, axis=-1).max()
    return float(np.linalg.norm(theirs[::finer][: len(ours)] - ours, axis=-1).max() / size) if size else 0.0


def fuller(structure: gb.Structure) -> gb.Structure:
    """The specimen by the exact model with more shapes, or of a finer mesh with more modes; else itself."""
    if structure.source is not None:
        _, y, z, twist, shear_y, shear_z = structure.counts
        strains = {"twist": 4 * bool(twist), "shear_y": 4 * bool(shear_y), "shear_z": 4 * bool(shear_z)}
        across = {"y": 8 * bool(y), "z": 8 * bool(z)}
        beam = structure.source.beam
        shapes = "adapted" if beam.line is None else "clamped-free"
        return gb.assemble(beam, "exact", axial=3, shapes=shapes, **across, **strains)
    return _bracket(12, 10) if structure.kind == "solid" else structure


@cache
def _bracket(cells: int, modes: int) -> gb.Structure:
    """The bracket of the cases, of elements that do not lock, with a mesh of half as many beside it."""
    fine, coarse = (
        solid(block("hexahedron27", (count, 1, 1), (LENGTH, 0.02, 0.005)), STIFF) for count in (cells, cells // 2)
    )
    beside = coarse.reduced(modes=modes, damping_ratio=0.01)
    return fine.reduced(modes=modes, damping_ratio=0.01, coarser=beside).structure


def drawn(seed: int) -> tuple[str, gb.System, gb.System, float]:
    """A kind, a system, the same with exact beams of more shapes, and the lowest period of its beams held, s."""
    random = np.random.default_rng(seed)
    beams = [_strip(random), _strip(random)]
    kind = str(random.choice(["FOAM", "exact", "CFOAM"]))
    counts = [{"axial": 1, "y": int(random.integers(1, 3)), "z": int(random.integers(1, 4)), "twist": 1} for _ in beams]
    ours = [gb.assemble(beam, kind, **count) for beam, count in zip(beams, counts, strict=True)]
    truth = [gb.assemble(beam, "exact", axial=1, y=4, z=5, twist=2, shapes="adapted") for beam in beams]
    period = max(2 * math.pi / float(body.rest[0][0]) for body in truth)
    build = (_arm, _satellite, _rotor)[seed % 3]
    state = random.bit_generator.state
    systems = list[gb.System]()
    for bodies in (ours, truth):
        random.bit_generator.state = state
        systems.append(build(random, bodies, beams, period))
    return build.__name__.strip("_"), *systems, period


def _strip(random: np.random.Generator) -> gb.Beam:
    length = float(random.uniform(0.3, 1.0))
    section = gb.Section.rectangle(length / random.uniform(15, 40), length / random.uniform(60, 120))
    masses = [gb.PointMass(length, float(random.uniform(0.0, 0.1)))]
    return gb.Beam(length, section, METAL, masses, damping_ratio=float(random.choice([0.0, 0.01])))


def _torque(random: np.random.Generator, beams: list[gb.Beam], period: float) -> Any:
    """A torque that swings the beams by about 0.01 to 0.2 rad in a period."""
    inertia = sum(gb.assemble(beam, "FOAM", axial=0, y=0, z=1).mass.sum() * beam.length**2 for beam in beams)
    angle = float(np.exp(random.uniform(math.log(0.01), math.log(0.2))))
    swing = angle * inertia * 2 * math.pi / period**2
    return gb.Sine(swing, float(random.uniform(1, 3)) * period)


def _arm(random: np.random.Generator, bodies: list[gb.Structure], beams: list[gb.Beam], period: float) -> gb.System:
    """Two beams, a driven hinge at the shoulder and a sprung one between them."""
    spring = float(random.uniform(0.5, 3.0))
    joints = {
        "shoulder": gb.Joint("revolute", "upper", axes=[(0, 1, 0)], effort=_torque(random, beams, period)),
        "elbow": gb.Joint("revolute", "fore", on="upper.tip", axes=[(0, 1, 0)], stiffness=spring, damping=0.01),
    }
    return gb.System(dict(zip(("upper", "fore"), bodies, strict=True)), joints)


def _satellite(
    random: np.random.Generator, bodies: list[gb.Structure], beams: list[gb.Beam], period: float
) -> gb.System:
    """A free bus with two panels, turned by a torque about an axis of its own."""
    bus = gb.RigidBody(float(random.uniform(0.5, 3.0)), (0.05, 0.05, 0.08))
    torque = _torque(random, beams, period)
    size = float(random.uniform(0.2, 0.6))
    push = gb.PointForce("bus.root", moment=gb.vector(x=gb.constant(0.0), y=torque, z=gb.constant(0.0)))
    joints = {
        "space": gb.Joint("free", "bus"),
        "right": gb.Joint("fixed", "right", on="bus.root", at=(0.1, 0.0, 0.0)),
        "left": gb.Joint("fixed", "left", on="bus.root", at=(-0.1, 0.0, 0.0), turn=(0.0, math.pi, size)),
    }
    return gb.System({"bus": bus, **dict(zip(("right", "left"), bodies, strict=True))}, joints, {"wheel": push})


def _rotor(random: np.random.Generator, bodies: list[gb.Structure], beams: list[gb.Beam], period: float) -> gb.System:
    """A hub at a given rate with two blades."""
    rate = gb.SmoothStep(float(random.uniform(0.1, 1.0)) / period, float(random.uniform(1, 3)) * period)
    hub = gb.RigidBody(1.0, (0.1, 0.1, 0.1))
    joints = {
        "shaft": gb.Joint("revolute", "hub", axes=[(0, 1, 0)], rate=rate),
        "first": gb.Joint("fixed", "first", on="hub.root", at=(0.1, 0.0, 0.0)),
        "second": gb.Joint("fixed", "second", on="hub.root", at=(-0.1, 0.0, 0.0), turn=(0.0, math.pi, 0.0)),
    }
    return gb.System({"hub": hub, **dict(zip(("first", "second"), bodies, strict=True))}, joints)


def rows() -> Iterator[Row]:
    """Shares of the cases of each kind in which the stated errors hold."""
    every = [judged_specimen(seed) for seed in SEEDS] + [judged_system(seed) for seed in SYSTEMS]
    answered = [each for each in every if each is not None]
    for kind in dict.fromkeys([*SPECIMENS, *(each.kind for each in answered)]):
        pairs = [pair for each in answered if each.kind == kind for pair in (each.deflections, each.loads)]
        known = [(stated, true) for stated, true in pairs if true > SURE and not math.isnan(stated)]
        if not known:
            continue
        within = float(np.mean([true <= MOST * stated for stated, true in known]))
        quantity = f"true error within three times the stated one, share of {len(known)}"
        remark = f"largest true error {max(true for _, true in known):.2g}"
        yield Row(kind, quantity, 1.0, within, "–", 0.05, SOURCE, remark)
