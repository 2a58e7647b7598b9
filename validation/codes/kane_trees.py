"""Random trees of rigid bodies by Kane's equations, written here without gbeam: partial velocities of every body from
the ground out, what they leave of the accelerations by a complex step along the motion, and an explicit Runge-Kutta
method of eighth order. Joints of every kind, with springs, dampers, friction, stops, drives and prescribed rates,
forces that follow and that do not, and gravity along any direction. Friction is Coulomb's, with a sign and events,
until it holds something: gbeam's is smooth about zero rate.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

import gbeam as gb
from validation.table import Row

TITLE = "Kane's equations of random trees"
NEEDS = ("numpy", "scipy")
SOURCE = "Kane's equations, DOP853"
COUNT, DURATION = 24, 0.6
ALLOWED = {"smooth laws": 1e-8, "friction or stops": 1e-4}
STEP = 1e-30
SLIDING = 0.02  # m/s or rad/s: at a faster rate gbeam's friction, smooth about zero, is Coulomb's
DIRECTIONS = ("x", "y", "z", "rx", "ry", "rz")
NAMES = {
    "fixed": (),
    "revolute": ("angle",),
    "prismatic": ("displacement",),
    "cylindrical": ("displacement", "angle"),
    "universal": ("angle_1", "angle_2"),
    "spherical": (),
    "free": ("x", "y", "z"),
}
LAWS_BEND = ("friction", "stops")  # within less than a step: what the steps' order does not know
Array = Any


def rows() -> Iterator[Row]:
    """Largest differences of trees whose laws are smooth, and of those with friction or stops."""
    kinds: dict[str, list[Compared]] = {"smooth laws": [], "friction or stops": []}
    for seed in range(COUNT):
        apart = compared(seed)
        if apart is not None:
            bent = any(name in joint.laws for joint in drawn(seed)[1].joints for name in LAWS_BEND)
            kinds["friction or stops" if bent else "smooth laws"].append(apart)
    for kind, all_apart in kinds.items():
        case = f"{len(all_apart)} random trees, {kind}"
        words = ("places", "velocities", "force on the ground", "moment on the ground", "drives", "energy")
        for word, differences in zip(words, zip(*all_apart, strict=True), strict=False):
            yield Row(
                case, f"{word}, largest difference of the largest", 0.0, max(differences), "–", ALLOWED[kind], SOURCE
            )


@dataclass
class Body:
    """A rigid body: mass, centre and inertia about it, and points with their axes (place, rotation)."""

    mass: float
    centre: Array
    inertia: Array
    points: list[tuple[Array, Array]]


@dataclass
class Joint:
    """A joint on a point (place, rotation) of a parent, −1 for the ground; laws by the number of its coordinate."""

    kind: str
    parent: int
    point: tuple[Array, Array]
    at: Array
    turn: Array
    axes: Array
    names: tuple[str, ...]
    start: Array
    rate: Array
    spin: Array
    laws: dict[str, dict[int, Any]] = field(default_factory=dict)
    prescribed: dict[int, tuple[float, float]] = field(default_factory=dict)  # amplitude and period of a sine

    @property
    def ball(self) -> bool:
        """True if it turns by Euler parameters."""
        return self.kind in ("spherical", "free")

    def law(self, name: str, k: int) -> float:
        """Value of a law on a coordinate, zero unless there is one."""
        return float(self.laws.get(name, {}).get(k, 0.0))


class Push(NamedTuple):
    """A force and moment on a point of a body, in its axes if they follow."""

    body: int
    point: int
    force: Array
    moment: Array
    follows: bool


class Motion(NamedTuple):
    """At one time: speeds' derivatives, efforts of prescribed speeds (NaN of others), the wrench on the ground, places
    and velocities of the bodies' roots (k, 3), and energies: kinetic, elastic, of gravity.
    """

    change: Array
    effort: Array
    force: Array
    moment: Array
    place: Array
    velocity: Array
    energy: Array


def skew(v: Array) -> Array:
    """Matrix of the cross product by v."""
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def turned(phi: Array) -> tuple[Array, Array]:
    """Rotation by a vector, and its left Jacobian, which makes angular velocity of its rate; also complex."""
    s, k = phi @ phi, skew(phi)
    if abs(s) < 1e-8:
        return np.eye(3) + k + k @ k / 2, np.eye(3) + k / 2 + k @ k / 6
    a = np.sqrt(s)
    sine, versine = np.sin(a) / a, (1 - np.cos(a)) / s
    return np.eye(3) + sine * k + versine * k @ k, np.eye(3) + versine * k + (1 - sine) / s * k @ k


def by_parameters(e: Array) -> Array:
    """Rotation by Euler parameters."""
    s, v = e[0], e[1:]
    return (s * s - v @ v) * np.eye(3) + 2 * np.outer(v, v) + 2 * s * skew(v)


@dataclass
class Tree:
    """A tree of rigid bodies, each with the joint of its number. The state has the coordinates of every joint, Euler
    parameters last; speeds are their rates, of a ball its angular velocity in turned axes.
    """

    bodies: list[Body]
    joints: list[Joint]
    pushes: list[Push]
    gravity: Array

    def layout(self) -> Iterator[tuple[Joint, slice, slice]]:
        """Joints with their parts of the coordinates and of the speeds."""
        q = u = 0
        for joint in self.joints:
            n, m = len(joint.names) + 4 * joint.ball, len(joint.names) + 3 * joint.ball
            yield joint, slice(q, q + n), slice(u, u + m)
            q, u = q + n, u + m

    def start(self) -> tuple[Array, Array]:
        """Coordinates and speeds at the start."""
        q = [np.concatenate([joint.start, [1, 0, 0, 0][: 4 * joint.ball]]) for joint in self.joints]
        u = [np.concatenate([j.rate, (turned(j.turn)[0] @ j.spin)[: 3 * j.ball]]) for j in self.joints]
        return np.concatenate(q), np.concatenate(u)

    def rates(self, q: Array, u: Array) -> Array:
        """Rates of the coordinates."""
        out = np.zeros(len(q))
        for joint, at, of in self.layout():
            n = len(joint.names)
            out[at][:n] = u[of][:n]
            if joint.ball:
                e, w = q[at][n:], u[of][n:]
                out[at][n:] = np.concatenate([[-e[1:] @ w], e[0] * w + skew(e[1:]) @ w]) / 2
        return out

    def frames(self, q: Array, speeds: int) -> list[tuple[Array, Array, Array, Array]]:
        """Rotation and place of every root, and its partial velocities and angular velocities (3, speeds)."""
        out: list[tuple[Array, Array, Array, Array]] = []
        for joint, at, of in self.layout():
            none = np.zeros((3, speeds), dtype=q.dtype)
            R, p, v, w = (np.eye(3), np.zeros(3), none, none) if joint.parent < 0 else out[joint.parent]
            v, w = v.copy(), w.copy()

            def carried(r: Array, R: Array, p: Array, v: Array, w: Array) -> tuple[Array, Array]:
                return p + R @ r, v - skew(R @ r) @ w

            p, v = carried(joint.point[0], R, p, v, w)
            R = R @ joint.point[1]
            p, v = carried(joint.at, R, p, v, w)
            x, first, n = q[at], of.start, len(joint.names)
            slides = [(k, np.eye(3)[DIRECTIONS.index(name)]) for k, name in enumerate(joint.names) if name in "xyz"]
            slides += [(k, joint.axes[0]) for k, name in enumerate(joint.names) if name == "displacement"]
            for k, axis in slides:
                p, v = carried(axis * x[k], R, p, v, w)
                v[:, first + k] += R @ axis
            angles = [k for k, name in enumerate(joint.names) if name.startswith("angle")]
            for axis, k in zip(joint.axes[-len(angles) :], angles, strict=False):
                w[:, first + k] += R @ axis
                R = R @ turned(axis * x[k])[0]
            vector = {k: np.eye(3)["xyz".index(name[1])] for k, name in enumerate(joint.names) if name[0] == "r"}
            if vector:
                by, left = turned(sum((axis * x[k] for k, axis in vector.items()), start=np.zeros(3)))
                for k, axis in vector.items():
                    w[:, first + k] += R @ left @ axis
                R = R @ by
            if joint.ball:
                R = R @ by_parameters(x[n:])
                w[:, first + n : first + n + 3] += R
            out.append((R @ turned(joint.turn)[0], p, v, w))
        return out

    def motion(self, t: float, q: Array, u: Array, sense: Array) -> Motion:
        """Solve the equations at one time."""
        q, u, known, change = q.copy(), u.copy(), np.zeros(len(u), dtype=bool), np.zeros(len(u))
        for joint, at, of in self.layout():
            for k, (size, period) in joint.prescribed.items():
                turn = 2 * math.pi * t / period
                q[at.start + k] = joint.start[k] + size * period / (2 * math.pi) * (1 - math.cos(turn))
                u[of.start + k], known[of.start + k] = size * math.sin(turn), True
                change[of.start + k] = size * 2 * math.pi / period * math.cos(turn)
        moving = self.frames(q + 1j * STEP * self.rates(q, u), len(u))
        mass, forces, applied, energy = np.zeros((len(u), len(u))), np.zeros(len(u)), np.zeros(6), np.zeros(3)
        inertial, parts = [], [tuple(each.real for each in frame) for frame in moving]
        for body, (R, p, v, w), frame in zip(self.bodies, parts, moving, strict=True):
            arm, inertia = R @ body.centre, R @ body.inertia @ R.T
            of_centre = v - skew(arm) @ w
            a = (frame[2] - skew(frame[0] @ body.centre) @ frame[3]).imag @ u / STEP
            spin, alpha = w @ u, frame[3].imag @ u / STEP
            gyro = inertia @ alpha + skew(spin) @ inertia @ spin
            mass += body.mass * of_centre.T @ of_centre + w.T @ inertia @ w
            forces += of_centre.T @ (body.mass * (self.gravity - a)) - w.T @ gyro
            inertial.append((body.mass, p + arm, of_centre, a, inertia, w, gyro))
            speed = of_centre @ u
            energy += (body.mass * speed @ speed + spin @ inertia @ spin) / 2, 0, -body.mass * self.gravity @ (p + arm)
        for push in self.pushes:
            (R, p, v, w), (r, axes) = parts[push.body], self.bodies[push.body].points[push.point]
            force, moment = ((R @ axes @ each) if push.follows else each for each in (push.force, push.moment))
            forces += (v - skew(R @ r) @ w).T @ force + w.T @ moment
            applied += np.concatenate([force, moment + skew(p + R @ r) @ force])
        for joint, at, of in self.layout():
            for k in range(len(joint.names)):
                x, rate = q[at.start + k], u[of.start + k]
                low, high = joint.laws.get("stops", {}).get(k, (-np.inf, np.inf))
                beyond = max(x - high, 0.0) - max(low - x, 0.0)
                eased, stop = x - joint.law("ease", k), joint.law("stop_stiffness", k) * beyond
                held = joint.law("stiffness", k) * eased + joint.law("damping", k) * rate + stop
                held += joint.law("friction", k) * sense[of.start + k]
                forces[of.start + k] += joint.law("effort", k) - held
                energy[1] += (joint.law("stiffness", k) * eased**2 + stop * beyond) / 2
        free = np.ix_(~known, ~known)
        change[~known] = np.linalg.solve(mass[free], (forces - mass @ change)[~known])
        effort = np.where(known, mass @ change - forces, np.nan)
        force, moment = -applied[:3], -applied[3:]
        for m, centre, of_centre, a, inertia, w, gyro in inertial:
            needed = m * (a + of_centre @ change - self.gravity)
            force, moment = force + needed, moment + skew(centre) @ needed + inertia @ (w @ change) + gyro
        place, velocity = np.array([p for _, p, _, _ in parts]), np.array([v @ u for _, _, v, _ in parts])
        return Motion(change, effort, -force, -moment, place, velocity, energy)

    def run(self, times: Array) -> dict[int, Motion]:
        """Integrate, and give the motion at those of some times, by their numbers, at which all that rubs slides, until
        friction by Coulomb's law holds a coordinate; friction turns round where its rate passes zero.
        """
        q, u = self.start()
        n, now, sense, out = len(q), 0.0, np.sign(u), dict[int, Motion]()
        rubbing = [
            of.start + k for joint, _, of in self.layout() for k in range(len(joint.names)) if joint.law("friction", k)
        ]

        def change(t: float, y: Array) -> Array:
            return np.concatenate([self.rates(y[:n], y[n:]), self.motion(t, y[:n], y[n:], sense).change])

        def passes(k: int) -> Callable[[float, Array], float]:
            def event(_: float, y: Array) -> float:
                return float(y[n + k] * sense[k])

            event.terminal, event.direction = True, -1  # type: ignore[attr-defined]
            return event

        y, events, options = np.concatenate([q, u]), [passes(k) for k in rubbing], {"rtol": 1e-9, "atol": 1e-11}
        while now < times[-1]:
            run = solve_ivp(change, (now, times[-1]), y, "DOP853", None, True, events, max_step=0.02, **options)
            assert run.success, run.message
            y, before, now = run.y[:, -1], now, float(run.t[-1])
            for i in np.flatnonzero((times >= before) & (times < now if run.status else times <= now)):
                q, u = np.split(run.sol(times[i]), [n])
                if np.abs(u[rubbing]).min(initial=np.inf) > SLIDING:
                    out[int(i)] = self.motion(times[i], q, u, sense)
            for k in (k for k, crossed in zip(rubbing, run.t_events or (), strict=True) if len(crossed)):
                y[n + k], sense[k] = 0.0, -sense[k]
                if self.motion(now, y[:n], y[n:], sense).change[k] * sense[k] < 0:
                    return out  # it is held
        return out


def drawn(seed: int, count: int | None = None) -> tuple[gb.System, Tree]:
    """A random tree for gbeam and for Kane's equations."""
    rng = np.random.default_rng(seed)
    bodies, joints, systems = [], [], dict[str, gb.RigidBody]()
    held, on = dict[str, gb.Joint](), [(-1, "ground", np.zeros(3), np.eye(3))]
    for b in range(count or rng.integers(1, 5)):
        spread = rng.normal(size=(6, 3)) / 2
        tensor = np.eye(3) * (spread**2).sum() - spread.T @ spread
        vectors = rng.normal(size=(2, 2, 3)) / 2
        points = [(r, Rotation.from_rotvec(turn).as_matrix()) for r, turn in vectors]
        body = Body(rng.uniform(0.5, 3), rng.normal(size=3) / 3, tensor, points)
        bodies.append(body)
        places = {name: gb.Place(r, turn) for name, (r, turn) in zip("ab", vectors, strict=True)}
        systems[f"b{b}"] = gb.RigidBody(body.mass, tensor, body.centre, places)
        parent, name, *point = on[rng.integers(len(on))]
        joint = _joint(rng, parent, (point[0], point[1]))
        joints.append(joint)
        held[f"j{b}"] = _of_gbeam(joint, f"b{b}", name)
        on += [(b, f"b{b}.{name}", *point) for name, point in zip("ab", points, strict=True)]
        on.append((b, f"b{b}.root", np.zeros(3), np.eye(3)))
    pushes = [
        Push(int(rng.integers(len(bodies))), int(rng.integers(2)), *(5 * rng.normal(size=(2, 3))), bool(k))
        for k in range(rng.integers(3))
    ]
    forces = {
        f"f{k}": gb.PointForce(f"b{each.body}.{'ab'[each.point]}", each.force, each.moment, follower=each.follows)
        for k, each in enumerate(pushes)
    }
    gravity = 5 * rng.normal(size=3)
    return gb.System(systems, held, forces, gravity), Tree(bodies, joints, pushes, gravity)


def _joint(rng: np.random.Generator, parent: int, point: tuple[Array, Array]) -> Joint:
    """A joint of any kind with any laws."""
    kind = str(rng.choice([*NAMES, "sprung"]))
    names: tuple[str, ...] = NAMES.get(kind, ())
    if kind == "sprung":
        names = tuple(name for name in DIRECTIONS if rng.random() < 0.6) or ("rz",)
    n = len(names)
    axes = rng.normal(size=({"fixed": 0, "spherical": 0, "free": 0, "sprung": 0, "universal": 2}.get(kind, 1), 3))
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    joint = Joint(
        kind,
        parent,
        point,
        rng.normal(size=3) / 3,
        rng.normal(size=3),
        axes,
        names,
        rng.normal(size=n) * (0.2 if kind == "sprung" else 0.5),
        rng.normal(size=n) / 2,
        3 * rng.normal(size=3),
    )
    chances = {"stiffness": 0.6, "damping": 0.6, "friction": 0.4, "stops": 0.4, "effort": 0.4}
    sizes = {"stiffness": (1, 30), "damping": (0.1, 2), "friction": (0.1, 1), "effort": (-4, 4)}
    for law, chance in chances.items():
        if n and (rng.random() < chance or (kind == "sprung" and law == "stiffness")):
            if law == "stops":
                joint.laws[law] = {k: (-rng.uniform(0.2, 0.6), rng.uniform(0.2, 0.6)) for k in range(n)}
                joint.laws["stop_stiffness"] = {k: rng.uniform(100, 500) for k in range(n)}
            else:
                scale = 10 if kind == "sprung" and law == "stiffness" else 1
                joint.laws[law] = {k: scale * rng.uniform(*sizes[law]) for k in range(n)}
    if "stiffness" in joint.laws:
        joint.laws["ease"] = {k: 0.2 * rng.normal() for k in range(n)}
    if n and kind != "sprung" and rng.random() < 0.4:
        k = int(rng.integers(n))
        joint.prescribed[k] = 2 * rng.normal(), rng.uniform(1.0, 2.0) * DURATION
        joint.rate[k] = 0.0
        for values in joint.laws.values():
            values.pop(k, None)
    return joint


def _of_gbeam(joint: Joint, body: str, on: str) -> gb.Joint:
    def named(values: Any) -> dict[str, Any]:
        return {joint.names[k]: each for k, each in (values.items() if isinstance(values, dict) else enumerate(values))}

    rates = named(joint.rate) | (dict(zip(("wx", "wy", "wz"), joint.spin, strict=True)) if joint.ball else {})
    options: dict[str, Any] = {name: named(values) for name, values in joint.laws.items()}
    if joint.prescribed:
        options["rate"] = named({k: gb.Sine(*each) for k, each in joint.prescribed.items()})
        rates = {name: each for name, each in rates.items() if name not in options["rate"]}
    return gb.Joint(
        "fixed" if joint.kind == "sprung" else joint.kind,
        body,
        on,
        axes=joint.axes if len(joint.axes) else None,
        at=joint.at,
        turn=joint.turn,
        initial=named(joint.start) or None,
        initial_rate=rates or None,
        **options,
    )


class Compared(NamedTuple):
    """Differences of places and velocities, ground's force and moment, efforts and energy, of the largest of each, and
    what gbeam states of the error of its steps.
    """

    place: float
    velocity: float
    force: float
    moment: float
    effort: float
    energy: float
    stated: float


def compared(seed: int, count: int | None = None) -> Compared | None:
    """Differences of a random tree from Kane's equations; None of one that cannot move."""
    system, tree = drawn(seed, count)
    if not len(system.tree.unknowns):
        return None
    run = gb.simulate(system, duration=DURATION, tolerance=1e-5, estimate=False)
    assert run.outcome == "done", run.message
    some = np.linspace(0, len(run.time) - 1, 13).round().astype(int)
    motions = tree.run(run.time[some])
    some, truth = some[[*motions]], Motion(*(np.array(each) for each in zip(*motions.values(), strict=True)))
    order = list(system.order)
    roots = [run.points.index(f"{name}.root") for name in order]
    bodies = [int(name[1:]) for name in order]

    def apart(one: Array, other: Array, size: Array | None = None) -> float:
        if not one.size:
            return 0.0
        scale = float(np.abs(other if size is None else size).max())
        return float(np.abs(one - other).max()) / (scale or 1.0)

    moved = truth.place - truth.place[0]
    prescribed = [
        (run.coordinates.index(f"j{b}.{joint.names[k]}"), of.start + k)
        for b, (joint, _, of) in enumerate(tree.layout())
        for k in joint.prescribed
    ]
    ours, theirs = (np.array([pair[i] for pair in prescribed], dtype=int) for i in (0, 1))
    return Compared(
        apart(run.place[some][:, roots], truth.place[:, bodies], moved),
        apart(run.velocity[some][:, roots], truth.velocity[:, bodies]),
        apart(run.ground_force[some], truth.force),
        apart(run.ground_moment[some], truth.moment),
        apart(run.effort[some][:, ours], truth.effort[:, theirs]),
        apart(run.invariants.energy[some], truth.energy),  # type: ignore[union-attr]
        float(run.errors.displacement.step),
    )
