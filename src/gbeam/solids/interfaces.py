"""Interfaces of a solid: groups of nodes whose mean rigid motion holds other bodies."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from gbeam.errors import InputError
from gbeam.numerics.eigen import Floats
from gbeam.solids.shape_functions import Indices
from gbeam.structure.attachments import checked_name

FLAT = 1e-9  # of the largest second moment: nodes on a line


def coupling(where: str, points: Floats) -> tuple[Floats, Floats]:
    """Centre (3,) of nodes (g, 3), and its mean displacement and rotation (6, g, 3) by those of the nodes.

    The rotation is that which leaves the least squares; forces and moments on the centre are shared out by the
    transpose, so that the nodes may move between themselves.
    """
    centre = points.mean(axis=0)
    arms = points - centre
    second = (arms**2).sum() * np.eye(3) - arms.T @ arms
    moments = np.linalg.eigvalsh(second)
    if not moments[0] > FLAT * moments[2]:
        fix = "name a group with three nodes or more that lie on no line"
        raise InputError(where, f"has {len(points)} nodes on a line, which do not say how it turns", fix)
    cross = np.zeros((3, len(points), 3))  # [axis, node, component]: r × e
    for axis, (i, j) in enumerate(((1, 2), (2, 0), (0, 1))):
        cross[axis, :, j], cross[axis, :, i] = arms[:, i], -arms[:, j]
    turn = np.einsum("ab,bkc->akc", np.linalg.inv(second), cross)
    shift = np.broadcast_to(np.eye(3)[:, None] / len(points), (3, len(points), 3))
    return centre, np.concatenate([shift, turn])


def attached(points: Floats, interfaces: Mapping[str, Indices]) -> tuple[Floats, Floats]:
    """Centres (i, 3) of interfaces, and unit forces and moments on them as loads (3 k, 6 i) on the nodes, by which
    displacements of the nodes also give theirs.
    """
    centres, loads = np.zeros((len(interfaces), 3)), np.zeros((len(points), 3, 6 * len(interfaces)))
    for i, (name, nodes) in enumerate(interfaces.items()):
        centres[i], mean = coupling(f"interfaces.{name}", points[nodes])
        loads[nodes, :, 6 * i : 6 * i + 6] = np.moveaxis(mean, 0, -1)
    return centres, loads.reshape(3 * len(points), -1)


def refuse_names(interfaces: Mapping[str, str], points: Mapping[str, int]) -> None:
    """Refuse names of interfaces that points have, or that are none."""
    for name in interfaces:
        try:
            checked_name(name)
        except InputError as error:
            raise error.within("interfaces") from None
        if name in points:
            raise InputError(f"interfaces.{name}", "is the name of a point too", "choose another")
