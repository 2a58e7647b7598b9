"""Causes of the answers of a structure: its loads over time, and what the stress of a solid is linear in."""

from __future__ import annotations

from gbeam.arrays.namespace import Array, namespace
from gbeam.mechanics.structure import Structure


def loads_at(structure: Structure, time: Array) -> Array | None:
    """Components (t, loads, 6) of a structure's loads at times (t,), s; None without any."""
    return None if structure.history is None else structure.history(time)


def causes_of(structure: Structure, q: Array, loads: Array | None) -> Array:
    """Causes (t, n + h) of the stress of a solid: coordinates (t, n) and the rise of its temperature, K, among the
    components of its `loads` (t, loads, 6), where it has one.
    """
    if not structure.heated or loads is None:
        return q
    xp = namespace(q, loads)
    return xp.concatenate([q, xp.broadcast_to(loads[..., -1, :1], (*q.shape[:-1], 1))], axis=-1)
