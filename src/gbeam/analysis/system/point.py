"""Points: states of a tree, and the derivatives of its equations there."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gbeam.arrays.tree import each_leaf
from gbeam.arrays.types import Floats
from gbeam.errors import InputError
from gbeam.integrate.equations import Trajectory, values_and_slopes
from gbeam.mechanics.tree.equations import Inputs, Tree
from gbeam.mechanics.tree.joints import SLIDES
from gbeam.mechanics.tree.linear import frozen_equations, is_linear
from gbeam.mechanics.tree.links import STUCK
from gbeam.mechanics.tree.signal_names import local_names, unit_of_effort
from gbeam.mechanics.tree.steps import Ball
from gbeam.mechanics.tree.system import System
from gbeam.numerics.balance import (
    answered,
    rooted,
)

MASSLESS = 1e-13  # of the largest: a smaller inertia is rounding


@dataclass(frozen=True)
class Point:
    """State of a tree: its free coordinates, their rates and accelerations (n,), and its inputs."""

    tree: Tree
    y: Floats
    yd: Floats
    ydd: Floats
    inputs: Inputs

    @property
    def minimal(self) -> bool:
        """True if it has as many coordinates as degrees of freedom."""
        return self.tree.size == self.local.tree.size

    @property
    def local(self) -> Point:
        """The point with as many coordinates as degrees of freedom: rotations in place of Euler parameters."""
        if not any(isinstance(step, Ball) for link in self.tree.links for step in link.steps):
            return self
        tree, prescribed = self.tree, self.inputs.prescribed
        states = [self.y, self.yd, self.ydd]
        if prescribed is not None:
            states = [tree.complete(state, prescribed[k]) for k, state in enumerate(states)]
        reduced, y, yd, ydd = tree.local(states[0], states[1], states[2])
        free, inputs = reduced.unknowns, self.inputs
        if inputs.efforts is not None:
            # Efforts act on the last coordinates of a joint, as many as it has degrees of freedom.
            kept = list[Any]()
            for link, reduced_link in zip(tree.links, reduced.links, strict=True):
                for size, fewer in zip(link.sizes, reduced_link.sizes, strict=True):
                    kept.append(np.arange(size) >= size - fewer)
            inputs = replace(inputs, efforts=inputs.efforts[..., np.concatenate(kept)])
        if prescribed is not None:
            inputs = replace(inputs, prescribed=np.stack([y, yd, ydd])[:, np.array(reduced.fixed, dtype=int)])
        return Point(reduced, y[free], yd[free], ydd[free], inputs)

    def slopes(self) -> tuple[Floats, Floats, Floats, Floats]:
        """The residual (n,) and its derivatives K, C and M (n, n) with respect to y, ẏ and ÿ, by complex steps.

        The derivatives are without friction: at rest its smooth law is a damper that no joint has.
        """
        if is_linear(self.tree):
            m, c, k, force = frozen_equations(self.tree, self.inputs)
            return m @ self.ydd + c @ self.yd + k @ self.y - force, k, c, m
        rubs = any(link.holder.friction.any() for link in self.tree.links)
        tree = self.tree.frictionless if rubs else self.tree
        residual, (k, c, m) = values_and_slopes(tree, self.y[None], self.yd[None], self.ydd[None], self.driven())
        with_friction = self.tree(self.y, self.yd, self.ydd, self.inputs) if rubs else residual[0]
        return with_friction, k[0], c[0], m[0]

    def trajectory(self, time: float = 0.0) -> Trajectory:
        """A trajectory of this state alone."""
        return Trajectory(np.array([time]), self.y[None], self.yd[None], self.ydd[None])

    def driven(self, *_: Any) -> Inputs:
        """Inputs with an axis of one time, like the trajectory of `standing`. Arguments are ignored, so that it serves
        as the inputs of a solution.
        """
        return each_leaf(lambda leaf: leaf[None], self.inputs)

    def sticking(self, system: System, *, resting: bool = False) -> tuple[str, ...]:
        """Warn of coordinates that friction, which is left out, may hold; if `resting`, how far from this place."""
        state, warnings, local = self.tree.motion(self.y, self.yd, self.ydd, self.inputs), list[str](), None
        for name, joint in system.joints.items():
            k = system.link(name)
            rates = self.tree.links[k].spring_values(state.q[k][:-1], state.qd[k][:-1])[1] if joint.frictions else ()
            for kind, friction in joint.frictions.items():
                i = joint.rate_names.index(kind)
                if kind in joint.rates or abs(rates[i]) >= STUCK:
                    continue
                words = f"friction of {name}.{kind}, {friction:.4g} {unit_of_effort(kind)}, is left out"
                if not resting:
                    warnings.append(f"{words} of small departures, which it damps or holds; rate = 0 holds the joint")
                    continue
                local = local or self.local
                _, stiffness, _, mass = local.slopes()
                names = local_names(system.coordinates)
                coordinate = f"{name}.{joint.values[i]}"
                force = friction * np.array([names[index] == coordinate for index in local.tree.unknowns])
                moved = answered(stiffness, mass, force)
                if np.allclose(stiffness @ moved, force, atol=1e-6 * friction):
                    reach = in_words(kind, abs(float(moved @ force)) / friction)
                    far = f"up to {reach} either way of here, to first order"
                else:
                    far = "wherever it is put"
                warnings.append(f"{words}, which may hold it {far}")
        return tuple(warnings)


def in_words(kind: str, size: float) -> str:
    """Size of a joint's displacement, m, or rotation, rad, in words with mm or degrees."""
    return f"{1e3 * size:.4g} mm" if kind in SLIDES else f"{np.degrees(size):.4g}°"


def refuse_massless(system: System, point: Point, mass: Floats) -> None:
    """Raise InputError if M (n, n) at a point says that some motion of the coordinates has no kinetic energy."""
    if _least_moving(mass)[0] > MASSLESS:
        return
    local = point.local  # whose names are those of degrees of freedom
    names, motion = local_names(system.coordinates), np.abs(_least_moving(local.slopes()[3])[1])
    foremost = [names[local.tree.unknowns[k]] for k in np.flatnonzero(motion > motion.max() / 2)]
    if all(name.rpartition(".")[0] in system.flexible for name in foremost):
        return  # shapes of a body that are nearly dependent, and have mass nevertheless
    together = ", ".join(foremost)
    fix = "give the body that it moves a mass, and a moment of inertia about every axis that is free"
    fix += "; of two springs one behind the other, as a joint's and a beam's root, give one"
    raise InputError("bodies", f"leave {together} without inertia", fix)


def _least_moving(mass: Floats) -> tuple[float, Floats]:
    """Smallest singular value of the scaled M as a share of the largest, and the motion (n,) that belongs to it."""
    scale = rooted(mass)
    _, sizes, rows = np.linalg.svd(mass / np.outer(scale, scale))
    if not sizes.size:
        return np.inf, scale
    return sizes[-1] / sizes[0] if sizes.any() else 0.0, rows[-1]
