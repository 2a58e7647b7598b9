"""More shapes beside given ones: what the loads do to the beam statically, and what the inertia of that does in turn.

These are load-dependent Ritz vectors (Wilson, Yuan and Dickens 1982): Krylov's sequence K⁻¹F, K⁻¹M K⁻¹F, … of the beam
with its tapers, bodies and root springs. The static answer is in them, and the low modes soon.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gbeam.mechanics.fields.adapted import Space, space
from gbeam.mechanics.fields.basis import Families, Family, Quadrature, Shapes
from gbeam.structure.beam import Beam

Array = NDArray[np.float64]
LEVELS = (2, 3, 3)  # of the sequence, along x, y, z
NEW = 1e-6  # of a vector's length: less of it is nothing that the others have not


def enriched_shapes(beam: Beam, rule: Quadrature, own: Families) -> tuple[Families, tuple[int, int, int]]:
    """The given shapes first, then those that they lack, direction by direction.

    Parameters
    ----------
    beam : Beam
    rule : quadrature with panels that end at the section's corners, at the bodies and at the loads
    own : the given shapes

    Returns
    -------
    families, and how many shapes are new in each
    """
    made = [_enriched(beam, space(beam, rule, along), own[along], along) for along in range(3)]
    (s, a), (v, b), (w, c) = made
    return (s, v, w), (a, b, c)


def _enriched(beam: Beam, of: Space, own: Family, along: int) -> tuple[Family, int]:
    nodes = len(of.rule.node)
    given = own(of.rule.node)
    strain = given.slope if of.axial else given.curvature
    size, count = len(of.stiffness), strain.shape[1]
    # The root's motion has coordinates of its own.
    basis = np.concatenate([np.eye(size)[:, nodes:], np.pad(strain, ((0, size - nodes), (0, 0)))], axis=1)
    root = np.sqrt(of.stiffness)[:, None]
    known = np.linalg.qr(root * basis)[0]
    vectors, added = _loads(beam, of, along) / of.stiffness[:, None], []
    for _ in range(LEVELS[along]):
        for vector in (root * vectors).T:
            length = np.linalg.norm(vector)
            rest = vector - known @ (known.T @ vector)
            rest = rest - known @ (known.T @ rest)
            if length > 0 and np.linalg.norm(rest) > NEW * length:
                rest = rest / np.linalg.norm(rest)
                known = np.concatenate([known, rest[:, None]], axis=1)
                added.append(rest)
        vectors = of.mass @ vectors / of.stiffness[:, None]
    more = of.family(np.stack(added, axis=1) / root) if added else None

    def both(x: Array) -> Shapes:
        if more is None:
            return own(x)
        return Shapes(*(np.concatenate(pair, axis=1) for pair in zip(own(x), more(x), strict=True)))

    return (own if count == 0 and more is None else both), len(added)


def _loads(beam: Beam, of: Space, along: int) -> Array:
    """Generalised forces (n, k) of what loads the beam: accelerations, even and growing along it, and its loads."""
    x, line = of.rule.node, beam.material.density * beam.section.at(of.rule.node).area * of.rule.weight
    value, slope = of.sensitivity(x)
    uniform, growing = line @ value, (line * x) @ value
    columns = []
    for body in beam.masses:
        moved, turned = of.sensitivity(np.array([body.at]))
        uniform, growing = uniform + body.mass * moved[0], growing + body.mass * body.at * moved[0]
        if along and (any(body.offset) or any(body.inertia)):
            columns.append(turned[0])
    for load in beam.loads:
        moved, turned = (value, slope) if load.at is None else of.sensitivity(np.array([load.at]))
        weight = of.rule.weight if load.at is None else np.ones(1)
        columns += [weight @ part for part, given in ((moved, load.force), (turned, load.moment)) if given is not None]
    return np.stack([uniform, growing, *columns], axis=1)
