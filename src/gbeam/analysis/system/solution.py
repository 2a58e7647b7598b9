"""Solutions of systems: a motion at some times, or a state of rest, with what drives it, and what is read of it."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from gbeam.analysis.accuracy.correction import PLACE, IntArray, Posed, Quantity, Reading, Within, looked, pieces
from gbeam.analysis.system.histories import Carried, carried, loads_of
from gbeam.arrays.types import Floats
from gbeam.integrate.equations import Trajectory
from gbeam.mechanics.plausibility import unstiffened
from gbeam.mechanics.tree.equations import Inputs
from gbeam.mechanics.tree.system import RigidBody, System
from gbeam.results.parts import Base

InputsOf = Callable[[System, Any], Inputs]  # of a system with the same joints, at some (index) of the times


@dataclass(frozen=True, eq=False)
class Solution:
    """A system with its coordinates and rates at some times, and the inputs then of every system with its joints."""

    system: System
    of: Trajectory
    inputs: InputsOf

    def posed(self, bodies: Iterable[str], system: System | None = None) -> Posed:
        """The equations of its system, or of another, at its times, and what is read of some of the bodies."""
        system = self.system if system is None else system
        names = [system.coordinates[k] for k in system.tree.free]
        return Posed(
            system.tree,
            partial(self.inputs, system),
            names,
            lambda of: replace(self, system=system, of=of).read(bodies),
        )

    def within(self, system: System, bodies: Iterable[str], shared: IntArray | None = None) -> Within:
        """It put into the equations of another system, where its unknowns have the same names, or are those shared."""
        return Within.lifted(self.posed(bodies, system), self.posed(bodies), self.of, shared)

    def read(self, bodies: Iterable[str]) -> Reading:
        """Places (t, p, 3) m of all points, and of some bodies the force and moment (t, 3) at the root and the largest
        size of the normal stress, and that of von Mises, over the sections (t,), or a solid's stress (t, c).
        """
        tree, of = self.system.tree, self.of
        places, along = list[Floats](), {name: list[Carried]() for name in bodies}
        for some in pieces(len(of.time), tree.size):
            now, at = self.inputs(self.system, some), of.at(some)
            state = tree.motion(at.q, at.qd, at.qdd if along else 0 * at.q, now)
            places.append(np.stack([frame.p for frame in state.every_point], axis=1))
            if along:
                acting = tree.demanded(state, now)[2]
                for name, each in along.items():
                    each.append(carried(self.system, state, name, acting))
        out: dict[Quantity, Floats] = {PLACE: np.concatenate(places)}
        for name, each in along.items():
            body = self.system.flexible[name]
            loads = loads_of(body, each, of.time)
            sheared = loads.stress if loads.von_mises is None else np.nan_to_num(loads.von_mises)
            stress = loads.stress.max(axis=1)
            if body.recovery is not None:
                stress = body.recovery.felt(np.concatenate([part.q for part in each]))
            out |= {(name, "force"): loads.root_force, (name, "moment"): loads.root_moment}
            out |= {(name, "stress"): stress, (name, "sheared"): sheared.max(axis=1)}
        return out

    def turning(self) -> Floats:
        """Places (t, 3 k, 3) m from the root, ground's axes, of three points at the radius of gyration of each rigid
        body that has no points beside its root, which do not show how it turns.
        """
        tree, of, radii = self.system.tree, self.of, dict[int, float]()
        for k, name in enumerate(self.system.order):
            body = self.system.bodies[name]
            if isinstance(body, RigidBody) and not np.any(body.body.places) and body.mass > 0:
                about_root = np.trace(body.tensor) / (2 * body.mass) + np.square(body.centre).sum()
                radii[k] = float(np.sqrt(about_root))
        turned = list[Floats]()
        for some in pieces(len(of.time), tree.size) if radii else ():
            at = of.at(some)
            roots = tree.motion(at.q, at.qd, 0 * at.q, self.inputs(self.system, some)).roots
            axes = [radius * np.swapaxes(roots[k].R, -1, -2) for k, radius in radii.items()]
            turned.append(np.concatenate([np.broadcast_to(each, (len(at.q), 3, 3)) for each in axes], axis=1))
        return np.concatenate(turned) if turned else np.zeros((len(of.time), 0, 3))

    def bases(self, bodies: Iterable[str]) -> dict[str, Base]:
        """Motions of the roots of some bodies, at some of the times (t, 3)."""
        some = looked(len(self.of.time))
        at = self.of.at(some)
        state = self.system.tree.motion(at.q, at.qd, at.qdd, self.inputs(self.system, some))
        roots = {name: state.roots[k] for k, name in enumerate(self.system.order)}
        return {name: Base(roots[name].a, roots[name].w, roots[name].alpha) for name in bodies}

    @property
    def unstiffened(self) -> tuple[str, ...]:
        """Warnings of how large the stiffness by loads is that bodies by matrices lack, moved as their roots are."""
        lacking = [name for name, body in self.system.flexible.items() if body.unstiffened]
        bases = self.bases(lacking) if lacking else {}
        said = ((name, unstiffened(self.system.flexible[name], base, "its motion")) for name, base in bases.items())
        return tuple(f"{name}: {each}" for name, words in said for each in words)
