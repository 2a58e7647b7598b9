"""Errors of frequencies: from too few shapes, against the same model with more; in all, against the exact one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gbeam.analysis.equilibrium.equilibrium import equilibrium_about
from gbeam.analysis.equilibrium.point import Linear, OperatingPoint, stepped
from gbeam.errors import ComputationError
from gbeam.mechanics.enrichment import enrichment
from gbeam.mechanics.equations.hub import free_hub
from gbeam.mechanics.equations.residuals import OnHub
from gbeam.mechanics.structure import Structure
from gbeam.motion.bases.base import Base
from gbeam.numerics.solvers.oscillations import ZERO, eigenvalues, mac
from gbeam.results.parts.errors import FrequencyErrors
from gbeam.results.result import Complex, Floats

LIMIT = 0.01  # an error above is warned of


def doubtful(errors: FrequencyErrors) -> tuple[str, ...]:
    """What to say where frequencies are wrong by more than one in a hundred."""
    above = np.flatnonzero(errors.total > LIMIT)
    if not above.size:
        return ()
    worst = int(above[errors.total[above].argmax()])
    which = f"mode {above[0] + 1}" if len(above) == 1 else f"{len(above)} modes, from mode {above[0] + 1} on,"
    cause, cure = "too few shapes", "raise model.modes or leave them out"
    if errors.model[worst] > errors.shapes[worst]:
        cause, cure = "the model", 'check with model.kind = "exact"'
    size = f"{100 * errors.total[worst]:.2g} %" + " at most" * (len(above) > 1)
    return (f"the frequency of {which} is wrong by an estimated {size}: {cause}; {cure}",)


class Richer:
    """A structure's model with more shapes, and the exact one.

    Parameters
    ----------
    structure : Structure
        With a source.
    base : Base
        Where it turns fastest.
    """

    def __init__(self, structure: Structure, base: Base) -> None:
        more, (_, along_y, along_z) = enrichment(structure, base), structure.counts
        directions = True, along_y > 0, along_z > 0
        self.exact = more.model("exact", directions=directions)
        self.same = self.exact if structure.kind == "exact" else more.model(structure.kind, directions=directions)

    def errors(
        self, point: OperatingPoint, eigenvalue: Complex, coordinates: Complex, *, gyroscopic: bool = True
    ) -> FrequencyErrors:
        """Errors of the frequencies of some modes about an operating point.

        Parameters
        ----------
        point : OperatingPoint
            Of the structure, in equilibrium.
        eigenvalue : (k,) 1/s
        coordinates : (k, n)
            Of the beam.
        gyroscopic : bool
        """
        own = np.abs(eigenvalue)
        same, exact = self.references(point, coordinates, gyroscopic=gyroscopic)
        return FrequencyErrors(np.abs(own / same - 1), np.abs(same / exact - 1), np.abs(own / exact - 1))

    def references(
        self, point: OperatingPoint, coordinates: Complex, *, gyroscopic: bool = True
    ) -> tuple[Floats, Floats]:
        """Circular frequencies of these modes by the same model with more shapes and by the exact one, (k,) rad/s each.

        NaN where there is no equilibrium. The arguments are those of :meth:`errors`.
        """

        def reference(richer: tuple[Structure, NDArray[np.int_]]) -> Floats:
            try:
                return _frequencies(*richer, point, coordinates, gyroscopic=gyroscopic)
            except (ComputationError, np.linalg.LinAlgError):
                return np.full(len(coordinates), np.nan)

        exact = reference(self.exact)
        return exact if self.same is self.exact else reference(self.same), exact


def pole_errors(structure: Structure, point: OperatingPoint, linear: Linear) -> tuple[Floats, FrequencyErrors]:
    """Frequencies (k,) Hz of the poles that oscillate about an operating point, ascending, and their errors."""
    value, mode = eigenvalues(*linear[:3])
    oscillating = np.flatnonzero(value.imag > ZERO * np.abs(value).max())
    chosen = oscillating[np.argsort(np.abs(value[oscillating]), kind="stable")]
    errors = Richer(structure, point.base).errors(point, value[chosen], mode[point.first :, chosen].T)
    return np.abs(value[chosen]) / (2 * np.pi), errors


def _frequencies(
    rich: Structure, index: NDArray[np.int_], point: OperatingPoint, coordinates: Complex, *, gyroscopic: bool
) -> Floats:
    """Circular frequencies of the rich structure's modes that are most like those given, rad/s."""
    linear, first = _about_equilibrium(rich, point), point.first
    value, mode = eigenvalues(*linear[:3], gyroscopic=gyroscopic)
    oscillating = value.imag > 0
    lifted = np.zeros((len(coordinates), rich.size), dtype=complex)
    lifted[:, index] = coordinates
    beam = slice(first, None)
    alike = mac(lifted, mode[beam, oscillating].T, linear.mass[beam, beam])
    return np.asarray(np.abs(value[oscillating])[alike.argmax(axis=1)])


def _about_equilibrium(rich: Structure, point: OperatingPoint) -> Linear:
    """M, C and K of a rich structure about its own equilibrium on the base of a point."""
    loads, base = point.residual.unpack(point.u)[1], point.base
    rich = replace(rich, load_values=loads)
    if not isinstance(point.residual, OnHub):
        return resting(rich, base)
    (q, _), c = equilibrium_about(rich, base)
    q = q if rich.linear else 0 * q
    hub = point.residual
    equations = free_hub(c, hub.mount, hub.equations.ground, hub_force=rich.hub_force)
    y, yd, ydd = (np.append(x[0], beam) for x, beam in ((point.y, q), (point.yd, 0 * q), (point.ydd, 0 * q)))
    n = len(y)
    d = stepped(OnHub(equations, hub.mount), y, yd, ydd, point.u)
    return Linear(d[:, 2 * n : 3 * n], d[:, n : 2 * n], d[:, :n], -d[:, 3 * n :])


def resting(structure: Structure, base: Base) -> Linear:
    """M, C and K of a structure about its equilibrium on a base, under its loads, by NumPy for complete models too."""
    _, c = equilibrium_about(structure, base)
    velocity, stiffness, _ = c.at(base.a_WO_B, base.w_WB_B, base.alpha_WB_B, structure.load_values)
    return Linear(c.mass, velocity, stiffness, np.zeros((structure.size, 0)))
