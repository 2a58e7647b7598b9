"""Rotations along a beam from its curvatures, R' = R [κ]×: angles in a plane, sixth-order steps out of it."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from gbeam.arrays.namespace import Array, is_jax, namespace
from gbeam.arrays.tree import record
from gbeam.arrays.types import Numbers
from gbeam.mechanics.fields.basis import Quadrature
from gbeam.mechanics.fields.vectors import (
    UNTURNED,
    Rotation,
    Vector,
    absent,
    add,
    cross,
    dot,
    exponential_of,
    mapped,
    plane_rotation,
    scaled,
    sine_cosine,
    turned,
)
from gbeam.structure.line import NEAR

Turn = tuple[Array, ...]  # a quaternion by components
_GAUSS = np.sqrt(15) / 10 * np.array([-1.0, 0.0, 1.0]) + 0.5
# i, j and k times a quaternion: its components in another order, with signs.
_UNITS = (((1, 0, 3, 2), (-1, 1, -1, 1)), ((2, 3, 0, 1), (-1, 1, 1, -1)), ((3, 2, 1, 0), (-1, -1, 1, 1)))
_ROOT = 10  # nodes along the turn of a root about several axes: R(sφ), s from 0 to 1, to rounding


@record
class Frames:
    """Steps from section to section, of `size` (i,) m, with three curvatures in each from those at the nodes, `onto`
    (3 i, G); which frames are those of the nodes (G,) and of the points (p,), and the `angles` of both from curvatures
    that turn about one axis, (G, G) and (p, G).
    """

    size: Array
    onto: Array
    nodes: Array
    points: Array
    node_angles: Array
    angles: Array

    def at(self, curvatures: Vector, *, points: bool) -> tuple[Rotation, Rotation]:
        """Rotations (..., G) at the nodes and, where wanted, (..., p) at the points, by curvatures (..., G)."""
        about = [axis for axis in range(3) if not absent(curvatures[axis])]
        if not about:
            return UNTURNED, UNTURNED
        if len(about) == 1:
            onto = (self.node_angles, self.angles) if points else (self.node_angles,)
            at = [plane_rotation(about[0], *reversed(sine_cosine(curvatures[about[0]] @ each.T))) for each in onto]
        else:
            parts = tuple(curvatures[axis] for axis in about)
            turns = _differentiable() if any(map(is_jax, parts)) else _turns
            at = [_matrix(each) for each in turns(tuple(about), points, self, parts)]
        return at[0], at[-1]

    def between(self, curvatures: Vector) -> Array:
        """Unit quaternions (4, ..., 1 + i) of the sections between the steps, the root's first (Magnus' expansion)."""
        shape = next(part.shape for part in curvatures if not absent(part))
        xp = namespace(*curvatures)
        count = len(self.size)
        stages: list[list[Any]] = [[], [], []]
        for part in curvatures:
            values = None if absent(part) else xp.reshape(part @ self.onto.T, (*shape[:-1], 3, count))
            for k, stage in enumerate(stages):
                stage.append(0 if values is None else values[..., k, :])
        first, middle, last = (scaled(self.size, (stage[0], stage[1], stage[2])) for stage in stages)
        a1, a2 = middle, scaled(np.sqrt(15) / 3, add(last, scaled(-1.0, first)))
        a3 = scaled(10 / 3, add(last, scaled(-2.0, middle), first))
        c1 = _bracket(a1, a2)
        c2 = scaled(-1 / 60, _bracket(a1, add(scaled(2.0, a3), c1)))
        outer = _bracket(add(scaled(-20.0, a1), scaled(-1.0, a3), c1), add(a2, c2))
        step = add(a1, scaled(1 / 12, a3), scaled(1 / 240, outer))
        sinc, _, cosine = exponential_of(dot(step, step) / 4)
        x, y, z = scaled(sinc / 2, step)
        turns = xp.stack([cosine, *(xp.broadcast_to(part, cosine.shape) for part in (x, y, z))])
        reach = 1
        while reach < count:  # products of all steps up to each one, doubling how many
            after = _product(turns[..., :-reach], turns[..., reach:])
            turns = xp.concatenate([turns[..., :reach], after], axis=-1)
            reach *= 2
        start = xp.stack([xp.zeros((*cosine.shape[:-1], 1)) + one for one in (1, 0, 0, 0)])
        return xp.concatenate([start, turns], axis=-1)


def _turns(about: tuple[int, ...], points: bool, frames: Frames, parts: tuple[Array, ...]) -> tuple[Turn, ...]:
    """Unit quaternions of the nodes' sections, and the points' if wanted, by the curvatures about some axes."""
    between = frames.between(_spread(about, parts))
    return tuple(tuple(between[..., each]) for each in ((frames.nodes, frames.points) if points else (frames.nodes,)))


def _spread(about: tuple[int, ...], parts: tuple[Array, ...]) -> Vector:
    x, y, z = (parts[about.index(axis)] if axis in about else 0 for axis in range(3))
    return x, y, z


@cache
def _differentiable() -> Any:
    """The quaternions for JAX, which then differentiates no steps: they turn by the integral of R δκ."""
    import jax

    turns = jax.custom_jvp(_turns, nondiff_argnums=(0, 1))

    @turns.defjvp
    def _(about: tuple[int, ...], points: bool, primals: Any, tangents: Any) -> Any:
        frames, parts = primals
        at = turns(about, points, frames, parts)
        turning = turned(_matrix(at[0]), _spread(about, tangents[1]))
        changes = []
        for (w, x, y, z), onto in zip(at, (frames.node_angles, frames.angles), strict=False):
            half = scaled(0.5, mapped(turning, onto))
            changes.append((-dot(half, (x, y, z)), *add(scaled(w, half), cross(half, (x, y, z)))))
        return at, tuple(changes)

    return turns


def _bracket(left: Vector, right: Vector) -> Vector:
    """Commutator, with the sign of R' = R [κ]×."""
    return cross(right, left)


def _product(p: Array, q: Array) -> Array:
    """Products of quaternions (4, ...)."""
    total = p[0] * q
    for part, (order, signs) in zip(p[1:], _UNITS, strict=True):
        if is_jax(total):
            total = total + part * (np.reshape(signs, (4, *[1] * part.ndim)) * q[np.array(order)])
            continue
        for row, of, sign in zip(total, order, signs, strict=True):  # in place, which takes NumPy a third of the time
            (np.add if sign > 0 else np.subtract)(row, part * q[of], out=row)
    return total


def _matrix(turn: Turn) -> Rotation:
    """Rotation matrices of unit quaternions."""
    w, x, y, z = turn
    return (
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )


def root_rule(move: Array, turn: Array) -> tuple[Array, Array, Array]:
    """Nodes of a root that moves and turns by columns (3, n): weights (r,) of all that is outboard, weights (r, r) from
    node to node, and which of them turn.

    The turn is that of a piece of unit length without extent, bent evenly.
    """
    about = int(np.any(turn, axis=1).sum())
    moves, turns = int(np.any(move)), 0 if not about else (1 if about == 1 else _ROOT)
    xi, w = np.polynomial.legendre.leggauss(max(turns, 1))
    values = np.linalg.inv(np.polynomial.legendre.legvander(xi, len(xi) - 1))
    inner = np.polynomial.legendre.legvander(xi, len(xi)) @ np.polynomial.legendre.legint(values, lbnd=-1) / 2
    weights = np.concatenate([np.ones(moves), w[:turns] / 2])
    onto = np.zeros((moves + turns, moves + turns))
    onto[moves:, moves:] = inner[:turns, :turns]
    return weights, onto, np.arange(moves + turns) >= moves


def beyond(corners: Numbers, x: Array) -> Array:
    """Flags (p, c) of points (p,) m that lie beyond corners; one at a corner does not, but at the root."""
    at = np.array(corners, dtype=float)
    return np.asarray((x[:, None] > at * (1 + NEAR)) | (at == 0), dtype=float)


def frames_along(
    rule: Quadrature,
    x: Array,
    turning: Array,
    root: Array,
    cumulative: Array,
    node_cumulative: Array,
    corners: Numbers = (),
) -> Frames:
    """Frames at the quadrature nodes and at points (p,) m of a beam behind the nodes of its root, some of them
    `turning` (r,), with their weights between each other, `root` (r, r), and behind those of its corners.
    """
    before = len(turning) + len(corners)
    stops = np.unique(np.concatenate([rule.edges, rule.node, x]))
    size = np.diff(stops)
    inner = (stops[:-1] + _GAUSS[:, None] * size).ravel()
    onto = np.concatenate([np.zeros((len(inner), before)), rule.interpolation(inner)], axis=1)
    nodes, points = np.searchsorted(stops, rule.node), np.searchsorted(stops, x)
    if len(corners):
        after = [int(np.abs(stops - place).argmin()) for place in corners]
        even = np.eye(before, before + len(rule.node))[len(turning) :]
        onto = np.insert(onto.reshape(3, len(size), -1), after, even, axis=1)
        size = np.insert(size, after, 1.0)
        onto = onto.reshape(3 * len(size), -1)
        nodes, points = (at + beyond(corners, stops[at]).sum(axis=1).astype(int) for at in (nodes, points))
    if turning.any():
        places = root[turning][:, turning].sum(axis=1)
        steps = np.diff(np.concatenate([[0.0], places, [1.0]]))
        even = np.zeros(before + len(rule.node))
        even[np.flatnonzero(turning)[0]] = 1.0
        shape = (3, len(steps), len(even))
        onto = np.concatenate([np.broadcast_to(even, shape), onto.reshape(3, len(size), -1)], axis=1)
        onto, size = onto.reshape(-1, len(even)), np.concatenate([steps, size])
        nodes, points = nodes + len(steps), points + len(steps)
    of_root = np.zeros(before, dtype=int)  # corners have no shapes, to which their frames would matter
    of_root[: len(turning)] = np.where(turning, np.cumsum(turning), 0)
    return Frames(size, onto, np.concatenate([of_root, nodes]), points, node_cumulative, cumulative)
