"""The configuration in which loops begin: closed from what is known, with the conditions that are independent.

Gaps are closed by Newton's method, by the changes of coordinates that are least when weighted by inertia. Coordinates
without a value move first, and the others only where that does not do.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gbeam.arrays.tree import each_leaf
from gbeam.arrays.types import Flags, Floats, Indices
from gbeam.integrate.equations import masses
from gbeam.mechanics.fields.held import null_basis
from gbeam.mechanics.tree.closures import DIRECTIONS
from gbeam.mechanics.tree.equations import Inputs, State, Tree
from gbeam.mechanics.tree.steps import Ball, composed_parameters, parameter_rates, parameters_of_vector

ITERATIONS = 60  # of Newton's method at most
CLOSED = 1e-12  # of the mechanism's size, or rad: a gap that is none
LIGHTEST = 1e-3  # of the largest inertia: the least that a coordinate without mass counts with
DEPENDENT = 1e-9  # of the largest: a smaller row follows from others
NEARBY, ASIDE = 3, 0.02  # configurations in which conditions are compared, and their distance in coordinates


@dataclass(frozen=True)
class Closed:
    """A tree whose loops are closed: with independent conditions, and unknown coordinates and rates (n,) that meet all
    of them. A `gap` (m or rad) of more than rounding is left where they cannot be met.
    """

    tree: Tree
    y: Floats
    yd: Floats
    gap: float


def close(tree: Tree, y: Floats, yd: Floats, inputs: Inputs, size: float, known: tuple[Flags, Flags]) -> Closed:
    """Close the loops of a tree from unknown coordinates and rates (n,) near; `size`, m, is that of the mechanism.

    Flags (n,) say which coordinates, and which rates, of joints are `known`. Bodies deform last.
    """
    scales = np.tile(np.repeat([1 / size, 1.0], 3), len(tree.closures))
    weights, left = _weights(tree, y, inputs), np.inf
    begun, of_joint = y, _joint_flags(tree)
    for may_move in (of_joint & ~known[0], of_joint, np.ones(len(y), dtype=bool)):
        if left > CLOSED:
            y, left = _met(tree, begun, inputs, weights * may_move, scales)
    slopes = _slopes(tree, y, inputs, scales)
    for may_move in (of_joint & ~known[1], of_joint, np.ones(len(y), dtype=bool)):
        rates = tree.gap_rates(tree.motion(y, yd, 0 * y, inputs))[1] * scales
        yd = yd - _turned_rates(tree, y, _least(slopes, weights * may_move, rates))
    conditions = _independent(tree, y, inputs, weights, scales)
    of_all = np.ones(tree.size)
    of_all[tree.unknowns] = weights
    return Closed(replace(tree, conditions=conditions, weights=of_all), y, yd, left)


def _joint_flags(tree: Tree) -> Flags:
    """Flags (n,) of the unknown coordinates that are joints'."""
    flags = [np.arange(sum(link.sizes)) < sum(link.sizes) - link.body.size for link in tree.links]
    return np.concatenate(flags)[tree.unknowns]


def _weights(tree: Tree, y: Floats, inputs: Inputs) -> Floats:
    """One over the inertia of each row of the unknown coordinates (n,)."""
    batch: Inputs = each_leaf(lambda leaf: leaf[None], inputs)
    inertia = np.abs(masses(replace(tree, closures=()), y[None], 0 * y[None], batch)[0]).sum(axis=1)
    return 1 / np.maximum(inertia, LIGHTEST * inertia.max())


def _slopes(tree: Tree, y: Floats, inputs: Inputs, scales: Floats) -> Floats:
    """Scaled derivatives G (m, n) of the gaps."""
    state = tree.motion(y, 0 * y, 0 * y, inputs)
    return np.asarray(tree.closing_slopes(state)) * scales[:, None]


def _least(slopes: Floats, weights: Floats, gaps: Floats) -> Floats:
    """Change (n,) of coordinates, least when weighted, that makes gaps (m,)."""
    rooted = np.sqrt(weights)
    change: Floats = rooted * np.linalg.lstsq(slopes * rooted, gaps, rcond=DEPENDENT)[0]
    return change


def _met(tree: Tree, y: Floats, inputs: Inputs, weights: Floats, scales: Floats) -> tuple[Floats, float]:
    """Coordinates (n,) at which all gaps are closed, and the largest scaled gap that is left."""
    best, least_gap = y, np.inf
    for _ in range(ITERATIONS):
        gaps = np.asarray(tree.gaps(tree.motion(y, 0 * y, 0 * y, inputs))) * scales
        size = float(np.abs(gaps).max())
        if size < least_gap:
            best, least_gap = y, size
        if size <= CLOSED:
            break
        change = _least(_slopes(tree, y, inputs, scales), weights, gaps)
        reach = np.abs(change).max()
        if not reach:
            break
        y = _advanced(tree, y, -change / max(reach, 1.0))
    return best, least_gap


def _advanced(tree: Tree, y: Floats, change: Floats) -> Floats:
    """Coordinates (n,) after a change along the rows: of balls a rotation vector in turned axes."""
    result = y + change
    for first in _balls(tree):
        spin = change[first + 1 : first + 4]
        result[first : first + 4] = composed_parameters(y[first : first + 4], parameters_of_vector(spin))
    return result


def _turned_rates(tree: Tree, y: Floats, rates: Floats) -> Floats:
    """Rates (n,) of coordinates by those along the rows: of balls by the angular velocity in turned axes."""
    result = rates.copy()
    for first in _balls(tree):
        result[first : first + 4] = parameter_rates(y[first : first + 4], rates[first + 1 : first + 4])
    return result


def _balls(tree: Tree) -> list[int]:
    """Indices among the unknown coordinates of the first parameters of balls."""
    firsts, count = list[int](), 0
    for link in tree.links:
        for step, size in zip([*link.steps, None], link.sizes, strict=True):
            if isinstance(step, Ball) and count in tree.unknowns:
                firsts.append(int(np.searchsorted(tree.unknowns, count)))
            count += size
    return firsts


def _independent(tree: Tree, y: Floats, inputs: Inputs, weights: Floats, scales: Floats) -> tuple[int, ...]:
    """Indices of the conditions that do not follow from others, here or in a closed configuration nearby."""
    random, rooted = np.random.default_rng(0), np.sqrt(weights)
    slopes = _slopes(tree, y, inputs, scales) * rooted
    chosen, rank = _pivots(slopes)
    for _ in range(NEARBY):
        _, sizes, rows = np.linalg.svd(slopes)
        null = rows[int((sizes > DEPENDENT * sizes[0]).sum()) :]
        if not len(null):
            break
        step = random.normal(size=len(null)) @ null
        aside = rooted * step
        near, left = _met(tree, _advanced(tree, y, ASIDE * aside / np.abs(aside).max()), inputs, weights, scales)
        if left > CLOSED:
            continue
        chosen_near, rank_near = _pivots(_slopes(tree, near, inputs, scales) * rooted)
        if rank_near > rank:
            chosen, rank = chosen_near, rank_near
    return chosen


def _pivots(slopes: Floats) -> tuple[tuple[int, ...], int]:
    """Indices of independent rows of a matrix, and their number."""
    order, rank = _factored(slopes.T)
    return tuple(sorted(int(k) for k in order[:rank])), rank


def _factored(matrix: Floats) -> tuple[Indices, int]:
    """Columns of a matrix, the most independent first, and its rank."""
    from scipy.linalg import qr  # which only loops take

    _, triangle, order = qr(matrix, mode="economic", pivoting=True)
    diagonal = np.abs(np.diag(triangle))
    return order, int((diagonal > DEPENDENT * diagonal[0]).sum()) if diagonal.size else 0


def independent_motions(tree: Tree, state: State) -> tuple[Indices, Floats]:
    """Indices (k,) of unknown coordinates of a tree with loops that are independent in a state, and the motions (n, k)
    of all by which these move: one of each alone, which the others follow.

    Coordinates with little inertia follow those with more.
    """
    slopes = np.asarray(tree.closing_slopes(state, tree.conditions))
    weights = np.asarray(tree.weights)[tree.unknowns]
    dependent = np.sort(_factored(slopes * np.sqrt(weights))[0][: len(slopes)])
    return np.delete(np.arange(slopes.shape[1]), dependent), null_basis(slopes, dependent.tolist())


def following(tree: Tree, state: State, candidates: Flags) -> Flags:
    """Flags (n,) of unknown coordinates that follow the others, among `candidates` (n,) if these suffice."""
    weights = np.asarray(tree.weights)[tree.unknowns]
    slopes = np.asarray(tree.closing_slopes(state, tree.conditions)) * np.sqrt(weights)
    order, rank = _factored(np.where(candidates, slopes, 0.0))
    if rank < len(slopes):
        order, _ = _factored(slopes)
    flags = np.zeros(len(candidates), dtype=bool)
    flags[order[: len(slopes)]] = True
    return flags


def mobility(tree: Tree) -> int:
    """Number of free motions of a tree with loops."""
    return len(tree.unknowns) - len(_balls(tree)) - len(tree.conditions)


def undetermined(tree: Tree) -> Sequence[tuple[int, int]]:
    """Pairs of a closure and a direction whose condition follows from others."""
    every = range(DIRECTIONS * len(tree.closures))
    return [divmod(k, DIRECTIONS) for k in every if k not in tree.conditions]
