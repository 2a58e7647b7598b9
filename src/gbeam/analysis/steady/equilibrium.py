"""Relative equilibrium of the beam at a frozen base motion."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from gbeam.analysis.system.drive import Drive
from gbeam.analysis.system.rest import steady_state
from gbeam.arrays.namespace import Array, holds_jax
from gbeam.guards.arguments import typed
from gbeam.guards.quantities import Seconds
from gbeam.mechanics.equations.linear import Coefficients
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.system import System
from gbeam.numerics.eigen import positive_definite
from gbeam.results.parts import Base


class Equilibrium(NamedTuple):
    """Coordinates (n,) at which the beam rests, and True if it would stay there: see :func:`stability_margin`."""

    q: Array
    stable: bool


@typed
def solve_equilibrium(structure: Structure, base: Base, time: Seconds | None = None) -> Equilibrium:
    """Coordinates at which the beam rests relative to a base whose motion is frozen, under its loads, stable or not.

    It is that of the system of this body alone. A linear model's equations are solved at once; others by Newton's
    method, along a path of growing load where one stride fails.

    Parameters
    ----------
    structure : Structure
    base : Base
        Of one time: arrays (3,).
    time : float, optional
        Time at which the beam's loads are taken, s; without, those that the structure has, of time zero or of its
        :meth:`~gbeam.Structure.at_time`.

    Returns
    -------
    Equilibrium
        Where JAX traces the structure, the base or the loads, NaN if there is none, and stability is not judged.

    Raises
    ------
    ComputationError
        ``not converged``, with the share of the load that was reached.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    >>> structure = gb.assemble(beam, "FOAM", axial=1, y=2, z=2)
    >>> base = gb.Hub(radius=0.5, rate=20.0).base(0.0)
    >>> equilibrium = gb.solve_equilibrium(structure, base)
    >>> print(f"{1e6 * structure.tip(equilibrium.q)[0]:.3f} µm")
    0.495 µm
    """
    structure = structure if time is None else structure.at_time(time)
    loads = structure.load_values
    if not (structure.traced or holds_jax(base, loads)):
        state = steady_state(System.of(structure, "beam"), Drive(base=base))
        # Loads that follow the beam may shake it, which inertia decides.
        stable = positive_definite(state.point.slopes()[1]) if loads is None else state.stable
        return Equilibrium(state.point.y, stable)
    import jax.numpy as jnp

    from gbeam.mechanics.equations.compiled import resting

    if structure.linear:
        frozen = base.a_WO_B, base.w_WB_B, base.alpha_WB_B, loads
        return Equilibrium(jnp.linalg.solve(*structure.coefficients.evaluate(*frozen)[1:]), True)
    return Equilibrium(resting(structure.equations, base, loads), True)


def expanded(structure: Structure, q: Array) -> tuple[Coefficients, Array]:
    """Coefficients of small departures from coordinates `q` (n,), and the elastic forces (n,) there."""
    if np.any(q):
        return structure.linearise(q)
    return structure.coefficients, np.zeros(structure.size)
