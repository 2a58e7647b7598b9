"""Random trees of bodies."""

from __future__ import annotations

from functools import cache

import numpy as np

import gbeam as gb
from gbeam.constants import BY_STRAINS

BEAM = gb.Beam(
    1.0,
    gb.Section.rectangle(0.05, 0.02),
    gb.Material(2700.0, 70e6, poissons_ratio=0.3),
    [gb.PointMass(0.6, 0.3, offset=(0.0, 0.1, 0.02))],
    damping_ratio=0.0,
    rotary_inertia=True,
    points=[gb.Point("middle", 0.5)],
)
JOINTS = ("fixed", "sprung", "revolute", "prismatic", "cylindrical", "universal", "spherical", "free")


@cache
def flexible(kind: str) -> gb.Structure:
    if kind == "particles":
        return particles()
    shapes = {"twist": 1, "shear_z": 1} if kind in BY_STRAINS else {}
    return gb.assemble(BEAM, kind, axial=1, y=1, z=2, **shapes)


def particles() -> gb.Structure:
    """A block of eight particles whose shapes are at random, which hardly bend it."""
    rng = np.random.default_rng(7)
    first, second = 0.3 * rng.normal(size=(8, 3, 3)), 0.1 * rng.normal(size=(8, 3, 3, 3))
    return gb.Structure.of_particles(
        np.full(8, 0.2),
        np.array([[x, y, z] for x in (0.2, 1.0) for y in (-0.2, 0.2) for z in (-0.1, 0.1)]),
        first,
        np.diag([40.0, 90.0, 200.0]),
        second=second + np.swapaxes(second, -1, -2),
        stations=np.array([0, 7]),
        turns=0.2 * rng.normal(size=(2, 3, 3)),
        points=("middle", "tip"),
    )


def rigid(rng: np.random.Generator) -> gb.RigidBody:
    spread = rng.normal(size=(9, 3))
    tensor = np.eye(3) * (spread**2).sum() - spread.T @ spread
    places = {name: gb.Place(rng.normal(size=3), rng.normal(size=3)) for name in ("left", "right")}
    return gb.RigidBody(rng.uniform(1, 3), tensor, rng.normal(size=3) / 5, places)


def joint(kind: str, body: str, on: str, rng: np.random.Generator) -> gb.Joint:
    number = {"revolute": 1, "prismatic": 1, "cylindrical": 1, "universal": 2}.get(kind, 0)
    more: dict[str, object] = {"axes": rng.normal(size=(number, 3))} if number else {}
    if kind == "sprung":
        kind, more = "fixed", {"stiffness": {"y": 900.0, "rx": 30.0, "rz": 50.0}}
    if kind == "revolute":
        more |= {"stiffness": 4.0, "ease": 0.2}
    return gb.Joint(kind, body, on, at=rng.normal(size=3), turn=rng.normal(size=3), **more)


def tree(kinds: list[tuple[str, str, int]], seed: int) -> gb.System:
    """A system of bodies, each of a kind, on a joint of a kind, on the point of an earlier one, or on the ground."""
    rng = np.random.default_rng(seed)
    bodies: dict[str, gb.RigidBody | gb.Structure] = {}
    joints: dict[str, gb.Joint] = {}
    points = ["ground"]
    for k, (body, held, on) in enumerate(kinds):
        name = f"b{k}"
        bodies[name] = rigid(rng) if body == "rigid" else flexible(body)
        joints[f"j{k}"] = joint(held, name, points[on % len(points)], rng)
        points += [f"{name}.{each}" for each in (("left", "root") if body == "rigid" else ("middle", "tip"))]
    return gb.System(bodies, joints, {"push": gb.PointForce(points[-1], (1.0, 2.0, 3.0), (0.3, 0.2, 0.1))}, (1, 2, -9))
