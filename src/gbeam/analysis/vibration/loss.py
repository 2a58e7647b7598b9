"""Where a relative equilibrium is lost as a quantity is raised from zero."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np

from gbeam.analysis.equilibrium.point import OperatingPoint, linear_matrices, on_base
from gbeam.analysis.vibration.modal import directions, modes_at
from gbeam.errors import ComputationError
from gbeam.mechanics.plausibility import input_warnings
from gbeam.mechanics.structure import Structure
from gbeam.motion.bases.base import Base
from gbeam.numerics.solvers.eigen import symmetric_modes
from gbeam.numerics.solvers.oscillations import stability_margin
from gbeam.numerics.solvers.roots import brent
from gbeam.results.equilibrium import Critical

SCAN = 64  # points at which a loss is looked for before its root is closed in on


def _point(structure: Structure, base: Base) -> OperatingPoint | None:
    try:
        return on_base(structure, base)
    except ComputationError:
        return None


def first_loss_along(
    path: Callable[[float], tuple[Structure, Base]], upper: float, quantity: str, unit: str
) -> Critical:
    """Raise a quantity from zero until the relative equilibrium is lost: first on a grid of 64 points, then by Brent's
    method.
    """

    @cache
    def margin(value: float) -> float:
        point = _point(*path(value))
        return -1.0 if point is None else stability_margin(*linear_matrices(point)[:3])

    def answer(value: float | None, kind: str, direction: str, reason: str) -> Critical:
        words = kind, direction, reason, structure.kind
        return Critical(quantity, unit, value, upper, *words, warnings=input_warnings(structure))

    structure, _ = path(0.0)
    grid = [float(value) for value in np.linspace(0.0, upper, SCAN + 1)]
    first = next((i for i, value in enumerate(grid) if margin(value) < 0), None)
    if first is None:
        why = f"{structure.kind} keeps its equilibrium at every {quantity} up to {upper:.4g} {unit}"
        return answer(None, "none", "", why)
    if first == 0:
        return answer(0.0, "divergence", "", "the beam is unstable before anything moves")
    root = brent(margin, grid[first - 1], grid[first], xtol=1e-11)
    point = _point(*path(root)) or on_base(*path(grid[first - 1]))
    beyond = _point(*path(root * (1 + 1e-5)))
    if beyond is None:
        kind, direction = "no equilibrium", ""
    else:
        grown = modes_at(structure, beyond).instabilities
        kind, direction = (grown[0].kind, grown[0].direction) if grown else ("divergence", "")
    if kind == "divergence":
        linear = linear_matrices(point)
        parts = ((each + each.T) / 2 for each in (linear.stiffness, linear.mass))  # the rest stores no energy
        lowest = symmetric_modes(*parts)[1][:, :1]
        direction = directions(structure, point, lowest)[0]
    along = f" along {direction}" if direction else ""
    return answer(root, kind, direction, f"{structure.kind}: {kind}{along} at {root:.6g} {unit}")
