"""Loops of joints: those that close them, turned so that they begin at zero, and the start that they allow."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from gbeam.arrays.types import Flags, Floats
from gbeam.errors import InputError
from gbeam.mechanics.tree.bodies import Rigid
from gbeam.mechanics.tree.closing import Closed, close
from gbeam.mechanics.tree.closures import DIRECTIONS, Closure, in_words_of_gap
from gbeam.mechanics.tree.equations import Inputs, State, Tree
from gbeam.mechanics.tree.joints import SLIDES, Joint
from gbeam.mechanics.tree.links import Link
from gbeam.mechanics.tree.steps import parameters_of_matrices, rotation_vector

FRAME = Rigid(np.array(0.0), np.zeros(3), np.zeros((3, 3)), np.zeros((0, 3)), np.zeros((0, 3, 3)))  # without mass
OPEN = 1e-9  # of the mechanism's size, or rad: a gap larger than rounding leaves
MOVED = 1e-3  # m or rad: a value at the start that closing changes by more is told


class Ends(NamedTuple):
    """Indices of the body, −1 for the ground, and of its point, that a joint hangs on, and of those it closes on."""

    on: tuple[int, int]
    to: tuple[int, int]


def turned_joint(joint: Joint, ends: Ends, state: State) -> Joint:
    """Return a joint that closes a loop with the turn by which its coordinates begin at zero, unless it has one."""
    if joint.turn is not None:
        return joint
    carrier = state.ground if ends.on[0] < 0 else state.point(*ends.on)
    relative = np.asarray(carrier.R).T @ np.asarray(state.point(*ends.to).R)
    turn = rotation_vector(parameters_of_matrices(relative[None])[0])
    return replace(joint, turn=tuple(turn.tolist()))


def looped(tree: Tree, joints: Sequence[Joint], ends: Sequence[Ends]) -> Tree:
    """Tree with joints that close loops: each carries a frame without mass, which is to be the point it closes on."""
    links, closures = list(tree.links), list[Closure]()
    for joint, (on, to) in zip(joints, ends, strict=True):
        closures.append(Closure(len(links), *to))
        links.append(Link(joint.steps, joint.holder, FRAME, *on, joint.loose))
    return replace(tree, links=tuple(links), closures=tuple(closures))


def closed_start(
    tree: Tree, joints: Mapping[str, Joint], start: tuple[Floats, Floats], inputs: Inputs, size: float
) -> tuple[Tree, tuple[Floats, Floats]]:
    """Return a tree with independent conditions, and all coordinates and rates at a start that meets all of them.

    `joints` by name are those of the links in turn, `size`, m, is that of the mechanism. An InputError says how large a
    gap is that remains.
    """
    free, (q, qd) = tree.unknowns, start
    known = [np.concatenate(_known(tree, joints, key))[free] for key in ("initial", "initial_rate")]
    closed = close(tree, q[free], qd[free], inputs, size, (known[0], known[1]))
    if closed.gap > OPEN:
        _refuse_gap(tree, list(joints), closed, inputs)
    q, qd = q.copy(), qd.copy()
    q[free], qd[free] = closed.y, closed.yd
    return closed.tree, (q, qd)


def _known(tree: Tree, joints: Mapping[str, Joint], key: str) -> list[Flags]:
    """Flags of the coordinates of each link whose value at the start is known: those of bodies are not."""
    bodies = (np.zeros(link.body.size, dtype=bool) for link in tree.links)
    flags = (np.array(joint.start_flags(key), dtype=bool) for joint in joints.values())
    return [np.concatenate(parts) for parts in zip(flags, bodies, strict=True)]


def _refuse_gap(tree: Tree, names: list[str], closed: Closed, inputs: Inputs) -> None:
    """Raise InputError for a loop that cannot be closed, with its largest gap."""
    zeros = 0 * closed.y
    gaps = np.abs(np.asarray(tree.gaps(tree.motion(closed.y, zeros, zeros, inputs))))
    largest = int(np.argmax(gaps))
    closure, direction = divmod(largest, DIRECTIONS)
    name = names[tree.closures[closure].frame]
    fix = "change places, axes or initial values, or choose a kind of joint that leaves this free"
    problem = f"cannot be closed: a gap of {in_words_of_gap(float(gaps[largest]), direction)} remains"
    raise InputError(f"joints.{name}", problem, fix)


def moved_in_words(
    closing: Sequence[str], joints: Mapping[str, Joint], tree: Tree, start: tuple[Floats, Floats]
) -> tuple[str, ...]:
    """Warning of values at the start that closing the loops has changed. `joints` are those of the links in turn."""
    changes, first = list[str](), 0
    for (name, joint), link in zip(joints.items() if closing else (), tree.links, strict=False):
        for k, (coordinate, is_given) in enumerate(zip(joint.coordinates, joint.start_flags("initial"), strict=True)):
            change = float(start[0][first + k] - joint.start[k])
            if is_given and abs(change) > MOVED:
                size = f"{1e3 * change:+.4g} mm" if coordinate in SLIDES else f"{np.degrees(change):+.4g}°"
                changes.append(f"{name}.{coordinate} by {size}")
        first += sum(link.sizes)
    return (f"closing {', '.join(closing)} moves the start: {', '.join(changes)}",) if changes else ()
