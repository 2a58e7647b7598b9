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
from gbeam.mechanics.tree.bodies import Body, moments_of
from gbeam.mechanics.tree.equations import Inputs, Tree
from gbeam.mechanics.tree.frames import Frame
from gbeam.numerics.eigen import positive_definite

SAME = 1e-10  # of the largest mass: two matrices that differ by less are one

# Of each body that deforms: motion of its root, without place, rotation and velocity, and its load components.
Roots = tuple[tuple[Frame, Array | None], ...]


def is_linear(tree: Tree) -> bool:
    """True if the tree's equations are linear with constant coefficients.

    Then joints move no root by an unknown, bodies are of second order in their coordinates, and no body hangs, and no
    force acts, on a point that deforming moves. There is at least one equation.
    """
    deforming = [link.body for link in tree.links if link.body.size]
    only_deforming = 0 < len(tree.unknowns) == sum(body.size for body in deforming)
    if (
        tree.closures or not only_deforming or not all(_constant(body) for body in deforming)
    ):  # asked first: it is cheap
        return False
    load_points = [(link.parent, link.on) for link in tree.links if link.parent >= 0]
    load_points += [(force.body, force.on) for force in tree.forces]
    return all(_rests(tree.links[body].body, on) for body, on in load_points)


def idle_inputs(tree: Tree, inputs: Inputs) -> Inputs | None:
    """Inputs (1, ...) in which nothing is driven, if the bodies vibrate in the same modes wherever joints are.

    None of any other tree, and of one without joints that move. `inputs` (1, ...) are those of a ground that rests.
    """
    of_joint = np.concatenate(
        [np.full(size, k < len(link.steps)) for link in tree.links for k, size in enumerate(link.sizes)]
    )
    of_joint = of_joint[tree.unknowns]
    bends = any(link.holder.bends for link in tree.links)
    if holds_jax(tree, inputs) or bends or of_joint.all() or not of_joint.any():
        return None
    forces = inputs.efforts, inputs.wrenches, inputs.prescribed
    efforts, wrenches, prescribed = (None if values is None else 0 * values for values in forces)
    loads = tuple(None if values is None else 0 * values for values in inputs.loads)
    idle = Inputs(inputs.ground, prescribed, efforts, loads, wrenches)
    # The modes are the same if the mass matrix is, at any three positions of the joints.
    y, zeros = np.outer([0.2, 0.9, -1.7], of_joint), np.zeros((3, len(of_joint)))
    three = each_leaf(lambda leaf: np.repeat(leaf, 3, axis=0), idle)
    if prescribed is not None:
        three.prescribed[:, 0] += np.array([0.0, -0.7, 1.3])[:, None]
    mass = masses(tree, y, zeros, three)
    size = np.abs(mass).max()
    is_constant = (
        np.isfinite(mass).all() and (np.abs(mass - mass[0].T) <= SAME * size).all() and positive_definite(mass[0])
    )
    return idle if is_constant else None


def _constant(body: Body) -> bool:
    """True if the coefficients of a body's equations do not change with its coordinates."""
    equations = moments_of(body)
    return equations is not None and equations.carried is None and equations.coefficients.bending is None


def _rests(body: Body, on: int) -> bool:
    """True if the coordinates of a body do not move its point `on`, as its root."""
    zeros = np.zeros(body.size)
    return not body.size or on == len(body.relative(zeros, zeros, zeros))


def linear_equations(tree: Tree, drive: Drive) -> LinearEquations:
    """Equations of a tree that :func:`is_linear`, from the coefficients of its bodies and the motions of their roots.

    `drive` returns the :class:`Inputs` of the tree at times (t,).
    """
    of_bodies = _coefficients(tree)
    parts = [c.terms for c in of_bodies]
    terms = LinearTerms(*(_blocks([part.arrays[k] for part in parts]) for k in range(3)))
    mass, damping, stiffness = (_diagonal([getattr(c, name) for c in of_bodies]) for name in _MATRICES)

    def features(roots: Roots) -> Array:
        bodies = zip(of_bodies, parts, roots, strict=True)
        return concatenated([_features(c, len(part.force), *root) for c, part, root in bodies])

    # No derivative is taken through the modes: those of equal frequencies have none.
    rest = None if any(map(is_jax, (mass, damping, stiffness))) else (damping, stiffness)
    moved = partial(_roots, tree, drive)
    return LinearEquations(mass, lambda roots: terms.evaluate(features(roots)), moved, terms, features, rest)


_MATRICES = "mass", "damping", "stiffness"


def _coefficients(tree: Tree) -> list[Coefficients]:
    """Coefficients of the bodies that deform."""
    equations = (moments_of(link.body) for link in tree.links if link.body.size)
    return [moments.coefficients for moments in equations if moments is not None]


def _roots(tree: Tree, drive: Drive, t: Array) -> Roots:
    """Motions at times (t,) of the roots of the bodies that deform, and their loads."""
    inputs: Inputs = drive(t)
    ground = replace(inputs.ground, R=None, p=None, v=None)
    zeros = np.zeros((*np.shape(t), len(tree.unknowns)))
    state = tree.motion(zeros, zeros, zeros, replace(inputs, ground=ground))
    bodies = [k for k, link in enumerate(tree.links) if link.body.size]
    return tuple((state.step_motions(k)[1], inputs.loads[k]) for k in bodies)


def frozen_equations(tree: Tree, inputs: Inputs) -> tuple[Array, Array, Array, Array]:
    """M, C, K (n, n) and F (n,) of a tree that :func:`is_linear`, under the inputs of one time."""
    body_coefficients = _coefficients(tree)
    roots = _roots(tree, lambda _: inputs, np.zeros(()))
    parts = [
        c.evaluate(root.a, root.w, root.alpha, loads) for c, (root, loads) in zip(body_coefficients, roots, strict=True)
    ]
    damping, stiffness, force = zip(*parts, strict=True)
    mass = _diagonal([c.mass for c in body_coefficients])
    return mass, _diagonal([*damping]), _diagonal([*stiffness]), concatenated(force)


def _features(c: Coefficients, count: int, root: Frame, loads: Array | None) -> Array:
    """Features (t, count) of a body's terms at a motion of its root; of loads that do not act they are zero."""
    features = c.features(root.a, root.w, root.alpha, loads)
    padding = count - features.shape[-1]
    return namespace(features).pad(features, ((0, 0), (0, padding))) if padding else features


def _blocks(parts: list[Any]) -> Array:
    """Terms (Σ k, Σ n) or (Σ k, Σ n, Σ n) of several parts: each part's (k, n, ...) is a block on the diagonal."""
    if len(parts) == 1:
        return parts[0]
    xp, size, columns = namespace(*parts), sum(part.shape[1] for part in parts), 0
    padded = []
    for part in parts:
        start, n = columns, part.shape[1]
        padded.append(xp.pad(part, ((0, 0), *[(start, size - start - n)] * (part.ndim - 1))))
        columns += n
    return xp.concatenate(padded)


def _diagonal(parts: list[Any]) -> Array:
    """Matrix (Σ n, Σ n) with the matrices (n, n) along its diagonal."""
    return _blocks([part[None] for part in parts]).sum(axis=0) if len(parts) > 1 else parts[0]
