"""More shapes beside given ones: what the loads do to the beam statically, and what the inertia of that does in turn.

These are load-dependent Ritz vectors (Wilson, Yuan and Dickens 1982): Krylov's sequence K⁻¹F, K⁻¹M K⁻¹F, … of the beam
with its tapers, bodies and root springs. The static answer is in them, and the low modes soon.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gbeam.mechanics.fields.adapted import Space
from gbeam.mechanics.fields.basis import Families, Family, Quadrature, Shapes
from gbeam.structure.beam import Beam

Array = NDArray[np.float64]
LEVELS = (2, 3, 3)  # of the sequence, along x, y, z
APART = 3e-6  # of the longest period: the square of a frequency farther off takes the digits of the lowest
NEW = 1e-6  # of a vector's length: less of it is nothing that the others have not
TENSION = 1.0  # N L²/EI: from there on the axial force bends the shapes
Spaces = tuple[Space, Space, Space]


def axial_force(beam: Beam, rule: Quadrature, along: Array, spin: Array) -> Array:
    """Axial force (g,) N at the nodes when largest, under root accelerations (t,) m/s² along and squared rates (t,)
    across the beam.
    """
    line = beam.material.density * beam.section.at(rule.node).area
    until = rule.cumulative(rule.node)
    mass, moment = (rule.weight @ f - until @ f for f in (line, line * rule.node))
    for body in beam.masses:
        outboard = rule.node < body.at
        mass, moment = mass + body.mass * outboard, moment + body.mass * body.at * outboard
    k = int(np.argmax(np.abs(spin * moment[0] - along * mass[0])))
    return np.asarray(spin[k] * moment - along[k] * mass)


def enriched_shapes(
    beam: Beam, spaces: Spaces, own: Families, force: Array | None = None
) -> tuple[Families, tuple[int, int, int]]:
    """The given shapes and then those that they lack, also under an axial force (g,) N, and how many are new in each
    direction.
    """
    least = APART**2 * max(_period(beam, of, along) for along, of in enumerate(spaces))
    made = [_enriched(beam, spaces[along], own[along], along, force, least) for along in range(3)]
    (s, a), (v, b), (w, c) = made
    return (s, v, w), (a, b, c)


def _enriched(beam: Beam, of: Space, own: Family, along: int, force: Array | None, least: float) -> tuple[Family, int]:
    nodes = len(of.rule.node)
    given = own(of.rule.node)
    strain = given.slope if of.axial else given.curvature
    size, count = len(of.stiffness), strain.shape[1]
    # The root's motion has coordinates of its own.
    basis = np.concatenate([np.eye(size)[:, nodes:], np.pad(strain, ((0, size - nodes), (0, 0)))], axis=1)
    root = np.sqrt(of.stiffness)[:, None]
    known = np.linalg.qr(root * basis)[0]

    def shortest(vectors: Array) -> float:
        """Square of the shortest period, over 4π², of vectors that are orthonormal in energy."""
        return float(np.linalg.eigvalsh((vectors / root).T @ of.mass @ (vectors / root))[0]) if vectors.size else np.inf

    least = min(least, shortest(known) / 10)
    loads, added = _loads(beam, of, along), []
    for flexibility in _flexibilities(of, force):
        vectors = flexibility @ loads
        for _ in range(LEVELS[along]):
            for vector in (root * vectors).T:
                length = np.linalg.norm(vector)
                rest = vector - known @ (known.T @ vector)
                rest = rest - known @ (known.T @ rest)
                if not np.linalg.norm(rest) > NEW * length:
                    continue
                rest = rest / np.linalg.norm(rest)
                wider = np.concatenate([known, rest[:, None]], axis=1)
                # Beside a spring of the root a bend close to it turns the beam likewise: what is left has no inertia.
                if shortest(wider) > least:
                    known = wider
                    added.append(rest)
            vectors = flexibility @ (of.mass @ vectors)
    more = of.family(np.stack(added, axis=1) / root) if added else None

    def both(x: Array) -> Shapes:
        if more is None:
            return own(x)
        return Shapes(*(np.concatenate(pair, axis=1) for pair in zip(own(x), more(x), strict=True)))

    return (own if count == 0 and more is None else both), len(added)


def _period(beam: Beam, of: Space, along: int) -> float:
    """Square of the longest period, over 4π², by the answer to an even acceleration."""
    force = _loads(beam, of, along)[:, 0]
    answer = force / of.stiffness
    return float(answer @ of.mass @ answer / (answer @ force))


def _flexibilities(of: Space, force: Array | None) -> list[Array]:
    """The inverse of the stiffness, and of that with what an axial force adds where that matters."""
    alone = np.diag(1 / of.stiffness)
    if force is None or not bends(of, force):
        return [alone]
    _, slope = of.sensitivity(of.rule.node)
    stiffness = np.diag(of.stiffness) + slope.T @ ((of.rule.weight * force)[:, None] * slope)
    if np.linalg.eigvalsh(stiffness / np.sqrt(np.outer(of.stiffness, of.stiffness)))[0] <= 0:
        return [alone]
    return [alone, np.asarray(np.linalg.inv(stiffness))]


def bends(of: Space, force: Array) -> bool:
    """Whether an axial force (g,) is large enough beside the stiffness to change the shapes."""
    size = np.abs(force).max() * of.length**2 / np.min(of.stiffness[: len(force)] / of.rule.weight)
    return not of.axial and bool(size >= TENSION)


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
