"""Trees whose constant coefficients are contracted once have the equations that they have otherwise."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import gbeam as gb
from gbeam.mechanics import Tree, idle_inputs, moving_system
from tests.system.trees import BEAM, flexible, tree

HUBS: dict[str, dict[str, Any]] = {
    "at rest": {},
    "inward": {"pointing": "inward"},
    "set": {"setting_angle": 0.4},
    "sprung under gravity": {"gravity": (1.0, -9.0, 3.0), "stiffness": 5.0, "damping": 0.1},
}


def on_hub(kind: str = "FOAM", **more: Any) -> gb.System:
    """A beam on a hub that turns freely."""
    return moving_system(flexible(kind), gb.Hub(radius=0.2, inertia=0.5, torque=gb.constant(3.0), **more))[0]


def contracted(system: gb.System, *, rests: bool) -> Tree:
    """Equations of a system on a ground that rests, or moves in any way."""
    return system.tree.contracted(system.inputs(np.zeros(())).ground if rests else None)


def counts(of: Tree) -> list[int]:
    """Numbers of features by which the bodies are told that are contracted."""
    equations = [getattr(link.body, "equations", link.body) for link in of.links]
    constants = [getattr(getattr(each, "free", each), "contraction", None) for each in equations]
    return [len(each.features) for each in constants if each is not None]


def apart(system: gb.System, of: Tree, motion: Any = None) -> float:
    """Largest difference of the equations at random states from those that are not contracted, as a share of these."""
    rng, count = np.random.default_rng(5), 30
    y, yd, ydd = rng.normal(size=(3, count, len(system.tree.unknowns))) * np.array([0.1, 1.0, 1.0])[:, None, None]
    inputs = system.inputs(np.linspace(0.0, 1.0, count), motion)
    want = system.tree(y, yd, ydd, inputs)
    return float(np.abs(of(y, yd, ydd, inputs) - want).max() / np.abs(want).max())


@pytest.mark.parametrize("kind", ["FOAM", "TLAM", "particles"])
@pytest.mark.parametrize("hub", HUBS)
def test_a_body_on_a_hub_is_told_by_the_hubs_rates(kind: str, hub: str) -> None:
    system = on_hub(kind, **HUBS[hub])
    of = contracted(system, rests=True)
    # θ̇² and θ̈ tell all of hub and body; gravity adds its components, which turn with the hub.
    told = 5 if "gravity" in HUBS[hub] else 2
    # Solids on a free root feel the mean motion of deforming, which is no polynomial.
    assert counts(of) == ([told] if kind == "particles" else [told, told])
    assert apart(system, of) < 1e-13
    assert apart(system, contracted(system, rests=False)) < 1e-13


def test_a_body_with_loads_is_contracted() -> None:
    loads = [gb.Load(0.7, force=gb.constant((1.0, 2.0, 3.0)), follower=True)]
    beam = gb.Beam(1.0, BEAM.section, BEAM.material, damping_ratio=0.01, loads=loads)
    structure = gb.assemble(beam, "FOAM", axial=1, y=1, z=2)
    system, _ = moving_system(structure, gb.Hub(radius=0.2, inertia=0.5, torque=gb.constant(3.0)))
    assert apart(system, contracted(system, rests=True)) < 1e-13


def test_sfoam_on_a_free_hub_feels_no_rates() -> None:
    hub = gb.Hub(radius=0.2, inertia=0.5, torque=gb.constant(3.0))
    system, _ = moving_system(gb.assemble(BEAM, "SFOAM", y=1, z=2), hub)
    assert counts(contracted(system, rests=True)) == [2, 2]
    assert apart(system, contracted(system, rests=True)) < 1e-13


@pytest.mark.parametrize("seed", range(12))
def test_random_trees_have_the_same_equations(seed: int) -> None:
    rng = np.random.default_rng(seed)
    bodies, joints = ("rigid", "FOAM", "particles", "exact"), ("fixed", "revolute", "prismatic", "universal", "free")
    kinds = [(str(rng.choice(bodies)), str(rng.choice(joints)), int(rng.integers(5))) for _ in range(3)]
    system = tree(kinds, seed)
    assert apart(system, contracted(system, rests=True)) < 1e-12


def test_prescribed_joints_and_a_moving_ground_tell_more() -> None:
    rod = gb.RigidBody(2.0, (0.1, 0.2, 0.3), points={"end": (0.5, 0.0, 0.0)})
    joints = {
        "hinge": gb.Joint("revolute", "rod", axes=[(0, 0, 1)], rate=gb.constant(2.0)),
        "wrist": gb.Joint("revolute", "beam", on="rod.end", axes=[(0, 1, 0)]),
    }
    system = gb.System({"rod": rod, "beam": flexible("FOAM")}, joints)
    motion = gb.Flight(acceleration=gb.constant((1.0, 0.0, 2.0)), rates=gb.constant((0.0, 0.5, 0.1)))
    of = contracted(system, rests=False)
    assert apart(system, of, motion) < 1e-13 and counts(of)[0] == 12
    assert apart(system, contracted(system, rests=True)) < 1e-13


def test_steps_are_fitted_where_modes_hold_wherever_joints_are() -> None:
    arm = {
        "shoulder": gb.Joint("revolute", "upper", axes=[(0, 0, 1)]),
        "elbow": gb.Joint("revolute", "lower", on="upper.tip", axes=[(0, 0, 1)]),
    }
    two = gb.System({"upper": flexible("FOAM"), "lower": flexible("FOAM")}, arm)
    free = gb.System({"body": flexible("FOAM")}, {"root": gb.Joint("free", "body")})
    clamped = gb.System.of(flexible("exact"))
    rubbing = gb.System({"body": flexible("FOAM")}, {"h": gb.Joint("revolute", "body", axes=[(0, 0, 1)], friction=1.0)})
    for system, fitted in ((on_hub(), True), (on_hub("exact"), True), (two, False), (free, False)):
        assert (idle_inputs(system.tree, system.inputs(np.zeros(1))) is not None) == fitted
    for system in (clamped, rubbing):
        assert idle_inputs(system.tree, system.inputs(np.zeros(1))) is None


def test_fitted_steps_of_a_hub_keep_the_time_of_its_vibration() -> None:
    """Steps of 20 ms leave 1e-5 of the bending in the plane, and would 1.5e-4 if they were not fitted."""
    system = on_hub()

    def swung(step: float) -> gb.Response:
        return gb.simulate(system, duration=2.0, step=step, integrator="gauss", estimate=False, loads=False)

    fine, coarse = swung(1e-3), swung(0.02)
    bending = fine.coordinates.index("beam.q2")
    error = np.abs(coarse.q - fine.q[::20])[:, bending].max()
    assert error < 5e-5 * np.abs(fine.q[:, 1:]).max()
