"""Steady states of a system along a path on which the drives grow."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np

from gbeam.analysis.system.drive import Drive, any_load
from gbeam.analysis.system.rest import held_tree, steady_state
from gbeam.analysis.system.search import solve_rests
from gbeam.analysis.system.steady import SteadySystem, release
from gbeam.arrays.types import Floats
from gbeam.errors import InputError
from gbeam.mechanics.tree.linear import is_linear
from gbeam.mechanics.tree.system import System
from gbeam.numerics.eigen import (
    RIGID,
    symmetric,
    symmetric_modes,
)

SLIGHT = 1e-6  # of the loads, by which their stiffness is looked at


class Equilibria:
    """Workspace of a search: steady states of systems, in which what turns is held, by the rate or factor of their
    drives.

    A search for a new one begins at coordinates extrapolated from up to three lower values, and so takes fewer
    corrections.
    """

    def __init__(self) -> None:
        self._of: dict[int, tuple[System, dict[float, SteadySystem]]] = {}

    def steady(self, system: System, value: float, drive: Drive, *, held: bool = False) -> SteadySystem:
        """Return the steady state of a system under its drive, whose rate or factor is the value."""
        states = self._states(system)
        if value not in states:
            start = None if is_linear(held_tree(system, drive)) else _continued(states, value)
            states[value] = steady_state(system, drive, held=True, start=start)
        return release(states[value], held=held)

    def prepare(self, system: System, drives: Mapping[float, Drive]) -> None:
        """Solve for the states at several values at once. Those that fail are left to `steady`, one by one."""
        states = self._states(system)
        new = {value: drive for value, drive in drives.items() if value not in states}
        if not new or not states:
            return
        tree = held_tree(system, next(iter(new.values())))
        if is_linear(tree):
            return  # which takes no search
        starts = np.array([_continued(states, value) for value in new])
        points = solve_rests(system, tree, [drive.inputs(system) for drive in new.values()], starts)
        for (value, drive), solved in zip(new.items(), points, strict=True):
            if solved is not None:
                point, slopes = solved
                states[value] = SteadySystem(system, drive, point, slopes if point.minimal else None)

    def _states(self, system: System) -> dict[float, SteadySystem]:
        """States of a system by their values; the system is stored, too, so that its id stays its own."""
        return self._of.setdefault(id(system), (system, {}))[1]


def _continued(states: Mapping[float, SteadySystem], value: float) -> Floats | None:
    """Extrapolate coordinates (n,) to a value from the states at up to three lower ones; None if there are none."""
    below: list[float] = []
    for lower in sorted(states, reverse=True):
        # The nearest one, then others at least as far from one another as it is from the value.
        if lower <= value and len(below) < 3 and (not below or below[-1] - lower >= value - below[0]):
            below.append(lower)
    if not below:
        return None
    from scipy.interpolate import KroghInterpolator

    return np.asarray(KroghInterpolator(below, [states[lower].coordinates for lower in below])(value))


@dataclass(frozen=True)
class Path:
    """Steady states of a system, or of richer ones, as a value of the drives is `varied`; what turns may be `held`."""

    drive: Drive
    varied: Callable[[Drive, float], Drive]
    held: bool = False
    equilibria: Equilibria = field(default_factory=Equilibria, repr=False, compare=False)

    def __call__(self, system: System, value: float) -> SteadySystem:
        return self.equilibria.steady(system, value, self.varied(self.drive, value), held=self.held)

    def prepare(self, system: System, values: Iterable[float]) -> None:
        """Solve for the states at several values at once."""
        self.equilibria.prepare(system, {value: self.varied(self.drive, value) for value in values})


def refuse_changing(path: Path, system: System, rate: float) -> None:
    """Refuse a system whose equations change as it turns at a rate, rad/s. Such a system has no frequencies."""
    if path(system, rate).changing:
        joint = path.drive.coordinate.rpartition(".")[0]
        fix = (
            "let gravity be along its axis, and all that does not turn with it, or all that does, be alike about "
            "that axis; `gbeam run` answers for the others"
        )
        where = f"joints.{joint}" if joint else "motion"
        raise InputError(where, "turns a system whose equations change with the angle: it has no frequencies", fix)


def share_of_loads(path: Path, system: System) -> float:
    """The larger of two effects of loads and forces to first order: their stiffness as a share of the system's, and the
    displacement as a share of its extent.

    The path is that of :func:`loaded` drives.
    """
    if not any_load(path.drive.inputs(system)):
        return 0.0  # which the differences below are not, by rounding
    rest, slight = path(system, 0.0), path(system, SLIGHT)
    square, modes = symmetric_modes(symmetric(rest.linear.stiffness), symmetric(rest.linear.mass))
    elastic = square > RIGID**2 * square[-1]
    shapes = modes[:, elastic] / np.sqrt(square[elastic])  # of unit strain energy
    added = shapes.T @ (slight.linear.stiffness - rest.linear.stiffness) @ shapes / SLIGHT
    places = np.stack([frame.p for frame in rest.frames])
    moved = np.stack([frame.p for frame in slight.frames]) - places
    size = max(np.abs(places).max(), 1e-300)
    return float(max(np.linalg.norm(added, 2), np.abs(moved).max() / SLIGHT / size))
