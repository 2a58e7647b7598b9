"""Degrees of freedom of a system with loops, counted in words."""

from __future__ import annotations

from gbeam.mechanics.tree.closing import mobility, undetermined
from gbeam.mechanics.tree.closures import WAYS
from gbeam.mechanics.tree.system import System


def mobility_in_words(system: System) -> str:
    """Count the free motions that loops leave, and name the loads that the conditions do not determine."""
    tree, count = system.tree, len(system.order)
    shapes = sum(body.size for body in system.flexible.values())
    free = mobility(tree) - shapes
    bodies = f"{count} bod{'y' if count == 1 else 'ies'}, {len(system.joints)} joints"
    motions = f"{free} free motion{'' if free == 1 else 's'}" if free > 0 else "no free motion"
    beside = f" beside {shapes} coordinates that deform bodies" if shapes and free >= 0 else ""
    if free < 0:
        motions = f"{-free} fewer than the {shapes} coordinates that deform bodies"
    lost: dict[str, list[str]] = {}
    for closure, direction in undetermined(tree):
        lost.setdefault(system.closing[closure], []).append(WAYS[direction])
    words = f"{bodies}, {', '.join(system.closing)} closing: {motions}{beside}"
    total = sum(map(len, lost.values()))
    if not total:
        return words
    loads = "; ".join(f"{name} {', '.join(directions)}" for name, directions in lost.items())
    conditions = f"{total} condition{' is' if total == 1 else 's are'} redundant"
    return f"{words}; {conditions}, and not determined are the loads of {loads}"
