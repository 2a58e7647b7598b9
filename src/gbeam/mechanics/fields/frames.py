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
    """Steps (i,) from section to section along the beam, `size` m long: `onto` (3 i, G) interpolates curvatures at the
    nodes to three places in each. `nodes` (G,) and `points` (p,) are the numbers of steps before them; `node_angles`
    (G, G) and `angles` (p, G) integrate curvatures to angles there where all turn about one axis.
    """

    size: Array
    onto: Array
    nodes: Array
    points: Array
    node_angles: Array
    angles: Array

    def at(self, curvatures: Vector, *, points: bool) -> tuple[Rotation, Rotation]:
        """Rotations of the sections at the nodes, (..., G), and the points, (..., p), by curvatures at the nodes.

        Without `points` the second are the nodes' again. Curvature about one axis is integrated. About several it takes
        :meth:`between`.
        """
        axes = [axis for axis in range(3) if not absent(curvatures[axis])]
        if not axes:
            return UNTURNED, UNTURNED
        if len(axes) == 1:
            sums = (self.node_angles, self.angles) if points else (self.node_angles,)
            angles = (curvatures[axes[0]] @ matrix.T for matrix in sums)
            rotations = [plane_rotation(axes[0], *reversed(sine_cosine(angle))) for angle in angles]
        else:
            parts = tuple(curvatures[axis] for axis in axes)
            turns = _differentiable() if any(map(is_jax, parts)) else _turns
            rotations = [_matrix(turn) for turn in turns(tuple(axes), points, self, parts)]
        return rotations[0], rotations[-1]

    def between(self, curvatures: Vector) -> Array:
        """Unit quaternions (4, ..., 1 + i) of the sections between the steps, beginning at the root.

        Each step turns by Magnus' expansion of sixth order. The products of all steps before a section are its turn.
        """
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
        start = xp.stack([xp.zeros((*cosine.shape[:-1], 1)) + component for component in (1, 0, 0, 0)])
        return xp.concatenate([start, turns], axis=-1)


def _turns(about: tuple[int, ...], points: bool, frames: Frames, parts: tuple[Array, ...]) -> tuple[Turn, ...]:
    """Unit quaternions of the nodes' sections, and the points' if wanted, by the curvatures `parts` about some axes."""
    between = frames.between(_spread(about, parts))
    wanted = (frames.nodes, frames.points) if points else (frames.nodes,)
    return tuple(tuple(between[..., index]) for index in wanted)


def _spread(about: tuple[int, ...], parts: tuple[Array, ...]) -> Vector:
    """Vector of components about some axes, absent about the others."""
    x, y, z = (parts[about.index(axis)] if axis in about else 0 for axis in range(3))
    return x, y, z


@cache
def _differentiable() -> Any:
    """Return :func:`_turns` for JAX, with derivatives by the integral of R δκ: no step is differentiated."""
    import jax

    turns = jax.custom_jvp(_turns, nondiff_argnums=(0, 1))

    @turns.defjvp
    def _(axes: tuple[int, ...], points: bool, primals: Any, tangents: Any) -> Any:
        frames, parts = primals
        values = turns(axes, points, frames, parts)
        turning = turned(_matrix(values[0]), _spread(axes, tangents[1]))
        changes = []
        for (w, x, y, z), sums in zip(values, (frames.node_angles, frames.angles), strict=False):
            half = scaled(0.5, mapped(turning, sums))  # δq = ½ δθ q, as quaternions
            changes.append((-dot(half, (x, y, z)), *add(scaled(w, half), cross(half, (x, y, z)))))
        return values, tuple(changes)

    return turns


def _bracket(left: Vector, right: Vector) -> Vector:
    """Commutator, with the sign of R' = R [κ]×."""
    return cross(right, left)


def _product(p: Array, q: Array) -> Array:
    """Products of quaternions (4, ...), a row of the table at a time."""
    total = p[0] * q
    for part, (order, signs) in zip(p[1:], _UNITS, strict=True):
        if is_jax(total):
            total = total + part * (np.reshape(signs, (4, *[1] * part.ndim)) * q[np.array(order)])
            continue
        for row, k, sign in zip(total, order, signs, strict=True):  # in place, which takes NumPy a third of the time
            (np.add if sign > 0 else np.subtract)(row, part * q[k], out=row)
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
    """Nodes (r,) that stand for a root on springs, which moves by `move` q and turns by `turn` q, (3, n) each.

    The turn is that of a piece of unit length without extent, bent evenly. A first node moves; others, if any, turn.
    Returns weights (r,) by which they move all that is outboard, weights (r, r) by which they move one another, and
    flags (r,) of those that turn.
    """
    turning_axes = int(np.any(turn, axis=1).sum())
    moves = int(np.any(move))
    turns = _ROOT if turning_axes > 1 else turning_axes
    xi, w = np.polynomial.legendre.leggauss(max(turns, 1))
    values = np.linalg.inv(np.polynomial.legendre.legvander(xi, len(xi) - 1))
    inner = np.polynomial.legendre.legvander(xi, len(xi)) @ np.polynomial.legendre.legint(values, lbnd=-1) / 2
    weights = np.concatenate([np.ones(moves), w[:turns] / 2])
    among = np.zeros((moves + turns, moves + turns))
    among[moves:, moves:] = inner[:turns, :turns]
    return weights, among, np.arange(moves + turns) >= moves


def beyond(corners: Numbers, x: Array) -> Array:
    """Flags (p, c), 1.0 where a point (p,) m lies beyond a corner (c,) m; at a corner it does only at the root."""
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
    """Frames at the quadrature nodes and at points x (p,), m, of a beam.

    The nodes of the root come first, with flags `turning` (r,) and weights `root` (r, r) of :func:`root_rule`, then
    those of the beam's corners, m.
    """
    before = len(turning) + len(corners)
    stops = np.unique(np.concatenate([rule.edges, rule.node, x]))
    size = np.diff(stops)
    inner = (stops[:-1] + _GAUSS[:, None] * size).ravel()
    onto = np.concatenate([np.zeros((len(inner), before)), rule.interpolation(inner)], axis=1)
    nodes, points = np.searchsorted(stops, rule.node), np.searchsorted(stops, x)
    if len(corners):
        after = [int(np.abs(stops - place).argmin()) for place in corners]
        corner_rows = np.eye(before, before + len(rule.node))[len(turning) :]
        onto = np.insert(onto.reshape(3, len(size), -1), after, corner_rows, axis=1)
        size = np.insert(size, after, 1.0)
        onto = onto.reshape(3 * len(size), -1)
        nodes, points = (at + beyond(corners, stops[at]).sum(axis=1).astype(int) for at in (nodes, points))
    if turning.any():
        places = root[turning][:, turning].sum(axis=1)
        steps = np.diff(np.concatenate([[0.0], places, [1.0]]))
        root_row = np.zeros(before + len(rule.node))
        root_row[np.flatnonzero(turning)[0]] = 1.0  # it bends evenly: any of its nodes will do
        shape = (3, len(steps), len(root_row))
        onto = np.concatenate([np.broadcast_to(root_row, shape), onto.reshape(3, len(size), -1)], axis=1)
        onto, size = onto.reshape(-1, len(root_row)), np.concatenate([steps, size])
        nodes, points = nodes + len(steps), points + len(steps)
    of_root = np.zeros(before, dtype=int)  # corners have no shapes, to which their frames would matter
    of_root[: len(turning)] = np.where(turning, np.cumsum(turning), 0)
    return Frames(size, onto, np.concatenate([of_root, nodes]), points, node_cumulative, cumulative)
