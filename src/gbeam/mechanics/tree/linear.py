"""Trees whose equations are linear: bodies of constant coefficients on roots whose motion is prescribed."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from gbeam.arrays.namespace import Array, concatenated, holds_jax, is_jax, namespace
from gbeam.arrays.tree import each_leaf
from gbeam.integrate.equations import Drive, LinearEquations, LinearTerms, masses
from gbeam.mechanics.equations.linear import Coefficients
from gbeam.mechanics.tree.bodies import Body, LinearBody
from gbeam.mechanics.tree.equations import Inputs, Tree
from gbeam.mechanics.tree.frames import Frame
from gbeam.numerics.eigen import positive_definite

SAME = 1e-10  # of the largest mass: two matrices that differ by less are one

# Of each body that deforms: motion of its root, without place, rotation and velocity, and its load components.
Roots = tuple[tuple[Frame, Array | None], ...]


def is_linear(tree: Tree) -> bool:
    """True if there are equations, linear with constant coefficients: joints move no root by an unknown, bodies are of
    second order in their coordinates, and nothing hangs, and no force acts, on a point that deforming moves.
    """
    deforming = [link.body for link in tree.links if link.body.size]
    held = 0 < len(tree.free) == sum(body.size for body in deforming)
    if not held or not all(_constant(body) for body in deforming):  # which cost less to ask than where points are
        return False
    acting = [(link.parent, link.on) for link in tree.links if link.parent >= 0]
    acting += [(force.body, force.on) for force in tree.forces]
    return all(_rests(tree.links[body].body, on) for body, on in acting)


def idle_inputs(tree: Tree, inputs: Inputs) -> Inputs | None:
    """Inputs (1, ...) in which nothing is driven, of a tree whose bodies vibrate in the same modes wherever its joints
    are, which move; None of any other. `inputs` (1, ...) are those of a ground that rests.
    """
    moved = np.concatenate(
        [np.full(size, k < len(link.steps)) for link in tree.links for k, size in enumerate(link.sizes)]
    )
    moved = moved[tree.free]
    bends = any(link.holder.bends for link in tree.links)
    if holds_jax(tree, inputs) or bends or moved.all() or not moved.any():
        return None
    forces = inputs.efforts, inputs.wrenches, inputs.prescribed
    efforts, wrenches, prescribed = (None if each is None else 0 * each for each in forces)
    loads = tuple(None if each is None else 0 * each for each in inputs.loads)
    idle = Inputs(inputs.ground, prescribed, efforts, loads, wrenches)
    # Any three positions of the joints.
    y, still = np.outer([0.2, 0.9, -1.7], moved), np.zeros((3, len(moved)))
    three = each_leaf(lambda leaf: np.repeat(leaf, 3, axis=0), idle)
    if prescribed is not None:
        three.prescribed[:, 0] += np.array([0.0, -0.7, 1.3])[:, None]
    mass = masses(tree, y, still, three)
    size = np.abs(mass).max()
    same = np.isfinite(mass).all() and (np.abs(mass - mass[0].T) <= SAME * size).all() and positive_definite(mass[0])
    return idle if same else None


def _constant(body: Body) -> bool:
    """True if the coefficients of a body's equations do not change with its coordinates."""
    return isinstance(body, LinearBody) and body.carried is None and body.coefficients.bending is None


def _rests(body: Body, on: int) -> bool:
    """True if the coordinates of a body do not move its point `on`, as its root."""
    still = np.zeros(body.size)
    return not body.size or on == len(body.relative(still, still, still))


def linear_equations(tree: Tree, drive: Drive) -> LinearEquations:
    """Equations of a tree that :func:`is_linear`, by the coefficients of its bodies and the motions of their roots;
    `drive` returns the :class:`Inputs` of the tree at times (t,).
    """
    of_bodies = [link.body.coefficients for link in tree.links if isinstance(link.body, LinearBody) and link.body.size]
    parts = [c.terms for c in of_bodies]
    terms = LinearTerms(*(_blocks([part.each[k] for part in parts]) for k in range(3)))
    mass, damping, stiffness = (_diagonal([getattr(c, name) for c in of_bodies]) for name in _MATRICES)

    def features(roots: Roots) -> Array:
        each = zip(of_bodies, parts, roots, strict=True)
        return concatenated([_features(c, len(part.force), *root) for c, part, root in each])

    # No derivative is taken through the modes: those of equal frequencies have none.
    rest = None if any(map(is_jax, (mass, damping, stiffness))) else (damping, stiffness)
    moved = partial(_roots, tree, drive)
    return LinearEquations(mass, lambda roots: terms.at(features(roots)), moved, terms, features, rest)


_MATRICES = "mass", "damping", "stiffness"


def _roots(tree: Tree, drive: Drive, t: Array) -> Roots:
    """Motions of the roots of the bodies that deform at times (t,), and their loads."""
    inputs: Inputs = drive(t)
    ground = replace(inputs.ground, R=None, p=None, v=None)
    still = np.zeros((*np.shape(t), len(tree.free)))
    state = tree.motion(still, still, still, replace(inputs, ground=ground))
    bodies = [k for k, link in enumerate(tree.links) if link.body.size]
    return tuple((state.moved(k)[1], inputs.loads[k]) for k in bodies)


def frozen_equations(tree: Tree, inputs: Inputs) -> tuple[Array, Array, Array, Array]:
    """M, C, K (n, n) and F (n,) of a tree that :func:`is_linear` under inputs of one time."""
    of_bodies = [link.body.coefficients for link in tree.links if isinstance(link.body, LinearBody) and link.body.size]
    roots = _roots(tree, lambda _: inputs, np.zeros(()))
    parts = [c.at(root.a, root.w, root.alpha, loads) for c, (root, loads) in zip(of_bodies, roots, strict=True)]
    damping, stiffness, force = zip(*parts, strict=True)
    mass = _diagonal([c.mass for c in of_bodies])
    return mass, _diagonal([*damping]), _diagonal([*stiffness]), concatenated(force)


def _features(c: Coefficients, count: int, root: Frame, loads: Array | None) -> Array:
    """Features (t, count) of a body's terms at a motion of its root; of loads that do not act they are zero."""
    features = c.features(root.a, root.w, root.alpha, loads)
    missing = count - features.shape[-1]
    return namespace(features).pad(features, ((0, 0), (0, missing))) if missing else features


def _blocks(parts: list[Any]) -> Array:
    """Terms (Σ k, Σ n) or (Σ k, Σ n, Σ n), each part's (k, n, ...) a block of its own."""
    if len(parts) == 1:
        return parts[0]
    xp, size, columns = namespace(*parts), sum(part.shape[1] for part in parts), 0
    padded = []
    for part in parts:
        before, n = columns, part.shape[1]
        padded.append(xp.pad(part, ((0, 0), *[(before, size - before - n)] * (part.ndim - 1))))
        columns += n
    return xp.concatenate(padded)


def _diagonal(parts: list[Any]) -> Array:
    """Matrix (Σ n, Σ n) with the matrices (n, n) along its diagonal."""
    return _blocks([part[None] for part in parts]).sum(axis=0) if len(parts) > 1 else parts[0]
