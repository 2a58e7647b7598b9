"""Forces of second and third order that the lowest modes of a solid, which bend it far, bring to its modes.

With Green's strain the stiffness of a bent solid is that of the straight one, a term linear in the bend and one
quadratic in it. Both are large and wrong alone: a strip that is bent by a linear map of coordinates becomes longer.
Displacements of second order, with which the solid answers the forces of the bend, take most of them away. What is left
is small in a stout solid, and in a thin one of the size of its stiffness.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from gbeam.arrays.types import Floats
from gbeam.mechanics.equations.linear import Bending
from gbeam.numerics.sparse import add_to_rows
from gbeam.solids.elements import FEW, TENSOR, chunks, geometric_stiffness, nearby_modes
from gbeam.solids.geometry import Mesh
from gbeam.solids.linked import Linked

SOFT = 2  # modes that bend a solid far: those of a rod of any section
ROWS, COLUMNS = np.array([[0, 1, 2, 1, 0, 0], [0, 1, 2, 2, 2, 1]])  # of strains
REACH = 3.0  # times the highest frequency of the modes: shapes of higher ones follow statically


def bending(
    mesh: Mesh,
    linked: Linked,
    modes: int,
    stations: Callable[[Floats], Floats],
    shapes: Floats,
    stiffness: Floats,
    solve: Callable[[Floats], Floats],
) -> Bending:
    """Forces of higher order in the lowest modes of a solid that moves in shapes (u, n) of unit mass, with a stiffness
    (n, n).

    `solve` answers loads on the unknowns. `stations` reads displacements (k, 3, m) of the nodes at the stations, (s, 3,
    m).
    """
    squares, basis = np.linalg.eigh(stiffness)
    reached = squares <= REACH**2 * squares[modes - 1]
    squares, basis = squares[reached], basis[:, reached]
    count, r, b = len(mesh.points), len(squares), min(SOFT, len(squares))
    displacements = linked.displacements(shapes @ basis)[:count]
    forces, quartic = _higher_order_terms(mesh, displacements, b)
    loads = linked.condensed(forces.reshape(3 * count, b * r))
    answers = -solve(loads)
    condensed = (loads.T @ answers).reshape(b, r, b, r).swapaxes(1, 2)
    displaced = linked.displacements(answers)[:count].reshape(count, 3, b, r)
    # Displacements of the modes that bend the solid, then those of second order to each pair of these.
    static = np.concatenate([displacements[..., :b], displaced[..., :b].reshape(count, 3, b * b)], axis=2)
    halves = geometric_stiffness(mesh.points, mesh.blocks, static, displacements)
    halves = halves + halves.swapaxes(2, 3)
    linear, of_second = np.split(halves.sum(axis=0), [b])
    close = nearby_modes(squares)
    first = (linear - halves[0, :b]) * ~close  # the model has it between modes near in frequency
    alone = quartic + of_second.reshape(b, b, r, r) / 2 + condensed
    by_modes = np.einsum("kim,lmj->klmij", linear, linear)
    by_first = np.einsum("kim,lmj->klmij", first, first)
    # The first modes while all others follow statically.
    by_bend = alone + ((by_modes + by_first / 2)[:, :, :b] / squares[:b, None, None]).sum(axis=2)
    drawn, cubic = (first - linear / 2)[:, :b, :b], by_bend[..., :b, :b] / 3
    drawn = (drawn + np.transpose(drawn, (2, 1, 0))) / 2
    cubic = sum(np.transpose(cubic, axes) for axes in ((0, 1, 2, 3), (0, 3, 2, 1), (3, 1, 2, 0))) / 3
    # All modes, moved by others as these vibrate with them.
    with np.errstate(divide="ignore"):
        answer = np.where(close, 0.0, 1 / (squares[:, None] - squares))
    vibrating = (by_first * (answer[:, :, None] + answer[:, None]) / 2).sum(axis=2)
    second = (alone + (by_modes / squares[:, None, None]).sum(axis=2) - vibrating) * close
    at_rest = stations(displacements)
    places = stations(displaced[..., :b].reshape(count, 3, b * b)).reshape(*at_rest.shape[:2], b, b)
    places = places + np.einsum("sam,kmi->saki", at_rest[..., :b] / squares[:b], linear[:, :b, :b])
    return Bending(basis, drawn, cubic, second, places)


def _higher_order_terms(mesh: Mesh, displacements: Floats, b: int) -> tuple[Floats, Floats]:
    """Forces of second order on the nodes, (k, 3, b, r), and stiffness of fourth degree, (b, b, r, r).

    The solid moves in shapes (k, 3, r) while the first b of them bend it. The stiffness is that by the strains of
    second order.
    """
    count, _, r = displacements.shape
    forces, quartic, of_bend = np.zeros((count, b, 3, r)), np.zeros((b * r, b * r)), np.zeros((b, b, r, r))
    # Of each point the bends k, axes x and y, components c and shapes i, in this order.
    for part in chunks(mesh.points, mesh.blocks, "stiffness", FEW):
        of_elements, volume = part.slopes(displacements), part.volume.ravel()[:, None, None, None, None]
        stress = part.stress(displacements, of_elements)[:, :, TENSOR].reshape(-1, 3, 3, r)
        slopes = of_elements.reshape(-1, 3, 3, r)
        bend_slopes, wide = np.moveaxis(slopes[..., :b], 3, 1), slopes.reshape(-1, 1, 3, 3 * r)
        shape = (len(slopes), b, 3, 3, r)
        products = (bend_slopes @ np.swapaxes(slopes, 1, 2).reshape(-1, 1, 3, 3 * r)).reshape(shape)
        strain = products[:, :, ROWS, COLUMNS]
        strain[:, :, 3:] += products[:, :, COLUMNS[3:], ROWS[3:]]
        stretched = part.elasticity @ strain * volume[..., 0]
        # The stress of the bend in the slopes of the shapes, and that of the shapes in the slopes of the bend.
        pull = (np.moveaxis(stress[..., :b], 3, 1) @ wide).reshape(shape)
        pull += np.swapaxes((bend_slopes.swapaxes(2, 3) @ stress.reshape(-1, 1, 3, 3 * r)).reshape(shape), 2, 3)
        pull = pull * volume + stretched[:, :, TENSOR]
        e, q, n, _ = part.gradients.shape
        gradients = part.gradients.swapaxes(1, 2).reshape(e, n, 3 * q)
        at_nodes = gradients @ pull.swapaxes(1, 2).reshape(e, 3 * q, 3 * b * r)
        add_to_rows(forces, part.nodes.ravel(), at_nodes.reshape(-1, b, 3, r))
        tall_strain = np.moveaxis(strain, 2, 1).reshape(-1, b * r)
        tall_stress = np.moveaxis(stretched, 2, 1).reshape(-1, b * r)
        quartic += tall_strain.T @ tall_stress
        for k, l in np.ndindex(b, b):
            pull_by_slopes = stretched[:, k, :, l][:, TENSOR] @ wide[:, 0]
            of_bend[k, l] += slopes.reshape(-1, r).T @ pull_by_slopes.reshape(-1, r) / 2
    return np.swapaxes(forces, 1, 2), quartic.reshape(b, r, b, r).swapaxes(1, 2) + of_bend
