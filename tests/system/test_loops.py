"""Loops of joints: linkages against closed forms, conserved quantities, and the same mechanism cut elsewhere."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import gbeam as gb
from gbeam.arrays import Floats

Z = [(0, 0, 1)]
CRANK, COUPLER, ROCKER, BASE = 1.0, 3.0, 2.5, 3.2


def rod(length: float, mass: float) -> gb.RigidBody:
    inertia = (1e-3, mass * length**2 / 12, mass * length**2 / 12)
    return gb.RigidBody(mass, inertia, centre=(length / 2, 0, 0), points={"end": (length, 0, 0)})


RODS = {"crank": rod(CRANK, 1.0), "coupler": rod(COUPLER, 2.0), "rocker": rod(ROCKER, 1.5)}


def angles(crank: float) -> tuple[float, float]:
    """Angles of coupler and rocker against the ground, elbow up."""
    pin = CRANK * np.array([np.cos(crank), np.sin(crank)])
    across = np.array([BASE, 0.0]) - pin
    span = np.hypot(*across)
    inner = np.arccos((COUPLER**2 + span**2 - ROCKER**2) / (2 * COUPLER * span))
    coupler = np.arctan2(across[1], across[0]) + inner
    end = pin + COUPLER * np.array([np.cos(coupler), np.sin(coupler)])
    return float(coupler), float(np.arctan2(end[1], end[0] - BASE))


def hinge(body: str, on: str = "ground", at: Any = (0, 0, 0), **more: Any) -> gb.Joint:
    return gb.Joint("revolute", body, on=on, at=at, axes=Z, **more)


def four_bar(cut: str = "tip", start: float = np.pi / 2, **drive: Any) -> gb.System:
    """A four-bar linkage under gravity, cut at the end of its coupler, its crank's pin, or its rocker's foot."""
    coupler, rocker = angles(start)
    joints = {"main": hinge("crank", initial=start, **drive)}
    if cut != "foot":
        joints["foot"] = hinge("rocker", at=(BASE, 0, 0), initial=rocker)
    if cut == "tip":
        joints |= {
            "pin": hinge("coupler", "crank.end", initial=coupler - start),
            "tip": hinge("coupler.end", "rocker.end"),
        }
        return gb.System(RODS, joints, gravity=(0, -9.81, 0))
    turned = {**RODS, "coupler": gb.RigidBody(2.0, (1e-3, 1.5, 1.5), centre=(-1.5, 0, 0), points={"end": (-3, 0, 0)})}
    if cut == "pin":
        joints |= {
            "tip": hinge("coupler", "rocker.end", initial=coupler - rocker),
            "pin": hinge("coupler.end", "crank.end"),
        }
        return gb.System(turned, joints, gravity=(0, -9.81, 0))
    back = {
        **RODS,
        "rocker": gb.RigidBody(1.5, (1e-3, 0.78125, 0.78125), centre=(-1.25, 0, 0), points={"end": (-2.5, 0, 0)}),
    }
    joints |= {
        "pin": hinge("coupler", "crank.end", initial=coupler - start),
        "tip": hinge("rocker", "coupler.end", initial=rocker - coupler),
        "foot": hinge("rocker.end", at=(BASE, 0, 0)),
    }
    return gb.System(back, joints, gravity=(0, -9.81, 0))


def energy(response: gb.Response) -> Floats:
    assert response.invariants is not None
    return np.asarray(response.invariants.energy).sum(axis=-1)


def test_a_four_bar_turns_on_with_its_energy() -> None:
    """A crank turns right round, through configurations that no choice of dependent angles serves alone."""
    system = four_bar(initial_rate=6.0)
    changes, gaps = list[float](), list[float]()
    for step in (4e-3, 2e-3):
        response = gb.simulate(system, duration=1.2, step=step, estimate=False)
        total = energy(response)
        changes.append(float(np.abs(total - total[0]).max() / np.abs(total[0])))
        assert response.closures is not None
        gaps.append(float(response.closures.largest_gap[0]))
    assert response.last[0] - np.pi / 2 > 2 * np.pi
    assert changes[1] < 1e-8 and changes[0] > 8 * changes[1]  # of fourth order
    assert gaps[1] < 1e-8 and gaps[0] > 8 * gaps[1]


def test_what_closes_the_loop_does_not_matter() -> None:
    """Accelerations, joint loads and the load on the ground at an instant, with the cut placed elsewhere."""
    answers = {
        cut: gb.simulate(four_bar(cut, initial_rate=4.0), duration=0.02, step=1e-3) for cut in ("tip", "pin", "foot")
    }
    first = answers["tip"]
    crank = first.points.index("crank.end")
    for response in answers.values():
        k = response.points.index("crank.end")
        assert response.acceleration[0, k] == pytest.approx(first.acceleration[0, crank], rel=1e-9)
        assert response.ground_force[0] == pytest.approx(first.ground_force[0], rel=1e-9, abs=1e-9)
        assert response.place[-1, k] == pytest.approx(first.place[-1, crank], rel=1e-8)


def slider(rate: float) -> gb.System:
    """A slider-crank of 0.1 m and 0.4 m whose crank is driven at a constant rate."""
    crank = gb.RigidBody(0.5, (1e-3, 1e-3, 1e-3), points={"pin": (0.1, 0, 0)})
    joints = {
        "main": hinge("crank", rate=rate),
        "pin": hinge("rod", "crank.pin"),
        "way": gb.Joint("prismatic", "piston", axes=[(1, 0, 0)], initial=0.5),
        "wrist": hinge("rod.end", "piston.root"),
    }
    return gb.System({"crank": crank, "rod": rod(0.4, 0.2), "piston": gb.RigidBody(0.3, (1e-4, 1e-4, 1e-4))}, joints)


def test_a_driven_slider_crank_has_its_closed_form() -> None:
    """Place of the piston, and the drive's torque by the change of kinetic energy."""
    rate, r, length = 20.0, 0.1, 0.4
    response = gb.simulate(slider(rate), duration=0.4, step=5e-4, estimate=False)
    turn = rate * response.time

    def place(theta: Floats) -> Floats:
        return np.asarray(r * np.cos(theta) + np.sqrt(length**2 - (r * np.sin(theta)) ** 2))

    def kinetic(theta: Floats) -> Floats:
        """Of piston and rod, by differences of their places: the crank's does not change."""
        h = 1e-5
        speed = (place(theta + h) - place(theta - h)) / (2 * h) * rate
        tilt = -np.cos(theta) * r / np.sqrt(length**2 - (r * np.sin(theta)) ** 2) * rate
        pin = rate * r * np.stack([-np.sin(theta), np.cos(theta)])
        middle = (pin + np.stack([speed, 0 * speed])) / 2
        return np.asarray(0.15 * speed**2 + 0.1 * (middle**2).sum(axis=0) + 0.2 * length**2 / 24 * tilt**2)

    piston = response.points.index("piston.root")
    assert response.place[:, piston, 0] == pytest.approx(place(turn), abs=1e-8)
    h = 1e-4
    torque = (kinetic(turn + h) - kinetic(turn - h)) / (2 * h)
    assert response.effort[:, response.coordinates.index("main.angle")] == pytest.approx(torque, abs=1e-5)


def test_a_free_body_closed_on_the_ground_is_a_pendulum() -> None:
    """Loops with Euler parameters: a body that is free but for a joint that closes on the ground."""
    body = gb.RigidBody(2.0, (0.1, 0.4, 0.5), centre=(0.3, 0.1, -0.05), points={"eye": (-0.2, 0.05, 0.1)})
    start = {"x": 0.2, "y": -0.05, "z": -0.1}
    for kind, axes in (("revolute", [(0.0, 0.6, 0.8)]), ("spherical", None)):
        free = gb.System(
            {"bob": body},
            {"loose": gb.Joint("free", "bob", initial=start), "eye": gb.Joint(kind, "bob.eye", axes=axes)},
            gravity=(0, 0, -9.81),
        )
        turned = gb.RigidBody(2.0, (0.1, 0.4, 0.5), centre=(0.5, 0.05, -0.15), points={"root_": (0.2, -0.05, -0.1)})
        tree = gb.System({"bob": turned}, {"eye": gb.Joint(kind, "bob", axes=axes)}, gravity=(0, 0, -9.81))
        loop, plain = (gb.simulate(each, duration=0.8, step=1e-3, estimate=False) for each in (free, tree))
        places = loop.place[:, loop.points.index("bob.root")], plain.place[:, plain.points.index("bob.root_")]
        assert places[0] == pytest.approx(places[1], abs=1e-9)
        assert loop.ground_force == pytest.approx(plain.ground_force, abs=1e-6)


def test_a_linkage_on_a_spring_vibrates_by_its_one_coordinate() -> None:
    """Equilibrium and frequency of a four-bar on a spring, by energies of the crank's angle."""
    stiffness, ease = 300.0, 1.5
    system = four_bar(start=1.4, stiffness=stiffness, ease=ease)

    def centres(theta: float) -> list[tuple[float, Floats, float, float]]:
        coupler, rocker = angles(theta)
        pin, foot = CRANK * np.array([np.cos(theta), np.sin(theta)]), np.array([BASE, 0.0])

        def along(angle: float) -> Floats:
            return np.array([np.cos(angle), np.sin(angle)])

        return [
            (1.0, pin / 2, CRANK**2 / 12, theta),
            (2.0, pin + 1.5 * along(coupler), 2.0 * COUPLER**2 / 12, coupler),
            (1.5, foot + 1.25 * along(rocker), 1.5 * ROCKER**2 / 12, rocker),
        ]

    def potential(theta: float) -> float:
        return sum(9.81 * mass * place[1] for mass, place, *_ in centres(theta)) + stiffness * (theta - ease) ** 2 / 2

    def inertia(theta: float) -> float:
        h, total = 1e-5, 0.0
        for before, after in zip(centres(theta - h), centres(theta + h), strict=True):
            speed, spin = (after[1] - before[1]) / (2 * h), (after[3] - before[3]) / (2 * h)
            total += before[0] * speed @ speed + before[2] * spin**2
        return total

    rest = gb.static(system)
    theta, h = float(rest.q[0]), 1e-3
    below, level, above = (potential(theta + k * h) for k in (-1, 0, 1))
    assert abs(above - below) / (2 * h) < 1e-3
    modes = gb.modes(system)
    expected = np.sqrt((above - 2 * level + below) / h**2 / inertia(theta)) / (2 * np.pi)
    assert modes.frequency == pytest.approx([expected], rel=1e-5)
    model = gb.linearize(system)
    assert len(model.states) == 2
    assert np.abs(np.linalg.eigvals(model.a)) == pytest.approx(2 * np.pi * expected, rel=1e-5)


STRIP = gb.Section.rectangle(width=0.02, thickness=0.004)
METAL = gb.Material(2700, 70e9)


def test_a_beam_cut_in_two_and_closed_is_the_beam() -> None:
    """Its halves hang on two walls and meet in the middle: a beam clamped at both ends."""
    half = gb.assemble(gb.Beam(0.3, STRIP, METAL, damping_ratio=0.01), "exact", axial=1, y=1, z=4)
    walls = {
        "left": gb.Joint("fixed", "a"),
        "right": gb.Joint("fixed", "b", at=(0.6, 0, 0), turn=(0, 0, np.pi)),
        "middle": gb.Joint("fixed", "a.tip", on="b.tip"),
    }
    system = gb.System({"a": half, "b": half}, walls)
    bending = np.sqrt(70e9 * 0.02 * 0.004**3 / 12 / (2700 * 0.02 * 0.004)) / 0.6**2 / (2 * np.pi)
    frequencies = np.asarray(gb.modes(system).frequency)[:2]
    assert frequencies == pytest.approx(np.array([4.730041, 7.853205]) ** 2 * bending, rel=2e-3)


BAD = {
    "too short": (
        lambda: gb.System(
            {"a": rod(1.0, 1.0), "b": rod(1.0, 1.0)},
            {"p": hinge("a"), "q": hinge("b", at=(3.0, 0, 0)), "c": hinge("a.end", "b.end")},
        ),
        "joints.c",
        "cannot be closed: a gap of",
    ),
    "held twice": (
        lambda: gb.System({"a": rod(1.0, 1.0)}, {"p": hinge("a"), "q": hinge("a", at=(1.0, 0, 0))}),
        "joints.q.body",
        "name a point",
    ),
    "no such point": (
        lambda: gb.System({"a": rod(1.0, 1.0)}, {"p": hinge("a"), "q": hinge("a.nose", at=(1.0, 0, 0))}),
        "joints.q.body",
        "a has no such point",
    ),
}


@pytest.mark.parametrize("case", BAD)
def test_what_cannot_be_closed_is_named(case: str) -> None:
    make, where, words = BAD[case]
    with pytest.raises(gb.InputError) as caught:
        make()
    assert caught.value.args and where in str(caught.value) and words in str(caught.value)


def test_a_start_that_closing_moves_is_told() -> None:
    coupler, rocker = angles(1.0)
    joints = {
        "main": hinge("crank", initial=1.0),
        "foot": hinge("rocker", at=(BASE, 0, 0), initial=rocker + 0.1),
        "pin": hinge("coupler", "crank.end", initial=coupler - 1.0),
        "tip": hinge("coupler.end", "rocker.end"),
    }
    system = gb.System(RODS, joints)
    assert "closing tip moves the start" in system.warnings[0] and "foot.angle by" in system.warnings[0]
    known = gb.System(
        RODS, joints | {"foot": hinge("rocker", at=(BASE, 0, 0)), "pin": hinge("coupler", "crank.end", initial=0.5)}
    )
    assert known.tree.closures and known.coordinates[-1] == "tip.angle"


def test_a_loop_that_a_drive_moves_has_no_rest() -> None:
    with pytest.raises(gb.ComputationError, match="stay closed"):
        gb.static(slider(20.0))
