"""Errors of frequencies: from too few shapes, of the model, and of the theory of slender beams.

They are compared with those of the same model with more shapes, of the exact one, and of a thick beam beside a slender.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gbeam.analysis.accuracy.beam_theory import described, mode_causes
from gbeam.analysis.accuracy.estimate import LIMIT, percent, wrong_by
from gbeam.analysis.steady.equilibrium import equilibrium_about
from gbeam.analysis.steady.operating_point import OperatingPoint, stepped
from gbeam.errors import ComputationError
from gbeam.mechanics.enrichment import enrichment
from gbeam.mechanics.equations.hub import free_hub
from gbeam.mechanics.equations.residuals import OnHub
from gbeam.mechanics.models import TORSION
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.theory import theory_of
from gbeam.motion.bases.base import Base
from gbeam.numerics.eigen import Linear, mac, matched, vibrations
from gbeam.results.errors import PARTS, ErrorEstimate, FrequencyErrors
from gbeam.results.result import Complex, Floats

BENT = 0.01  # of its kinetic energy: a mode of twist with less bending is excited by nothing that bends the beam
SHOWN = 3  # frequencies that no model has, named at once


def doubtful(errors: FrequencyErrors) -> tuple[str, ...]:
    """Warn of frequencies that are wrong by more than one in a hundred, and of those that are left out."""
    said = []
    above = np.flatnonzero(errors.total > LIMIT)
    if above.size:
        worst = int(above[errors.total[above].argmax()])
        which = f"mode {above[0] + 1}" if len(above) == 1 else f"{len(above)} modes, from mode {above[0] + 1} on,"
        parts = ErrorEstimate(**{part: float(getattr(errors, part)[worst]) for part in PARTS})
        size = percent(parts.total) + " at most" * (len(above) > 1)
        said.append(wrong_by(f"the frequency of {which}", size, parts, errors.theory))
    if errors.unseen:
        named = ", ".join(f"{each:.4g}" for each in errors.unseen[:SHOWN])
        more = f" and {len(errors.unseen) - SHOWN} more" if len(errors.unseen) > SHOWN else ""
        said.append(f"there are modes of bending and twist at {named} Hz{more} besides: {TORSION}")
    return tuple(said)


class ByTheory(NamedTuple):
    """Errors (k,) by the theory of slender beams, the causes of the largest, and frequencies unknown to it, Hz."""

    shares: Floats
    causes: dict[str, float]
    unseen: tuple[float, ...]


class Richer:
    """A structure's model with more shapes, the exact one, and the thick beam, on the base where it turns fastest."""

    def __init__(self, structure: Structure, base: Base) -> None:
        more, (_, along_y, along_z, *_) = enrichment(structure, base), structure.counts
        directions = True, along_y > 0, along_z > 0
        self.structure, self.theory = structure, theory_of(structure)
        self.exact = more.model("exact", directions=directions)
        self.same = self.exact if structure.kind == "exact" else more.model(structure.kind, directions=directions)

    def errors(
        self, point: OperatingPoint, eigenvalue: Complex, coordinates: Complex, *, gyroscopic: bool = True
    ) -> FrequencyErrors:
        """Errors of the frequencies of modes (k, n) with eigenvalues (k,) about an equilibrium."""
        frequency = np.abs(eigenvalue)
        same, exact = self.references(point, coordinates, gyroscopic=gyroscopic)
        by_theory = self.by_theory(point, coordinates, gyroscopic=gyroscopic)
        shapes, model, total = (np.abs(a / b - 1) for a, b in ((frequency, same), (same, exact), (frequency, exact)))
        theory = described(self.structure, by_theory.causes)
        shares = by_theory.shares
        return FrequencyErrors(shapes, model, shares, total + np.nan_to_num(shares), theory, by_theory.unseen)

    def references(
        self, point: OperatingPoint, coordinates: Complex, *, gyroscopic: bool = True
    ) -> tuple[Floats, Floats]:
        """Circular frequencies (k,) of modes by the model with more shapes and by the exact one; NaN without an
        equilibrium.
        """

        def reference(richer: tuple[Structure, NDArray[np.int_]]) -> Floats:
            try:
                return _frequencies(*richer, point, coordinates, gyroscopic=gyroscopic)
            except (ComputationError, np.linalg.LinAlgError):
                return np.full(len(coordinates), np.nan)

        exact = reference(self.exact)
        return exact if self.same is self.exact else reference(self.same), exact

    def theory_shares(self, point: OperatingPoint, coordinates: Complex) -> Floats:
        """Errors (k,) of these modes' frequencies by the theory of slender beams."""
        return self.by_theory(point, coordinates).shares

    def by_theory(self, point: OperatingPoint, coordinates: Complex, *, gyroscopic: bool = True) -> ByTheory:
        """Errors of these modes' frequencies by the theory of slender beams; arguments as above."""
        theory, first, k = self.theory, point.first, len(coordinates)
        plate = theory.plate(np.asarray(np.pad(point.q, (0, theory.thick.size - len(point.q))))[None])
        try:
            linear = [_about_equilibrium(each, point) for each in (theory.slender, *theory.variants(plate))]
            (slender, shape), (thick, deep), (plated, flat) = (
                _oscillating(each, first, gyroscopic=gyroscopic) for each in linear
            )
        except (ComputationError, np.linalg.LinAlgError):
            return ByTheory(np.full(k, np.nan), {}, ())
        mass = linear[1].mass[first:, first:]
        mode, shape = (np.pad(each, ((0, 0), (0, len(mass) - each.shape[1]))) for each in (coordinates, shape))
        chosen = mac(mode, shape, mass).argmax(axis=1)
        looked = slice(None, chosen.max(initial=-1) + 1)
        among, beside = (matched(mac(shape[looked], each, mass))[0] for each in (deep, flat))
        pairs = (thick, among), (plated, beside)
        shares = np.max([np.abs(slender[chosen] / rate[match[chosen]] - 1) for rate, match in pairs], axis=0)
        bent = deep[:, : theory.slender.size]
        moving = np.einsum("ki,ij,kj->k", bent.conj(), mass[: bent.shape[1], : bent.shape[1]], bent).real
        others = np.setdiff1d(np.arange(len(thick)), among)
        unseen = [j for j in others if moving[j] > BENT and thick[j] < slender[looked].max(initial=0.0)]
        loads = point.residual.unpack(point.u)[1]
        worst = np.zeros(0, dtype=int) if not k else np.array([np.nan_to_num(shares).argmax()])
        return ByTheory(
            shares,
            mode_causes(theory, point.base, loads, coordinates[worst], slender[chosen[worst]], plate),
            tuple(float(thick[j]) / (2 * np.pi) for j in unseen),
        )


def pole_errors(structure: Structure, point: OperatingPoint) -> tuple[Floats, FrequencyErrors]:
    """Frequencies (k,) Hz of the poles that oscillate about an operating point, ascending, and their errors."""
    moving = point.moving
    errors = Richer(structure, point.base).errors(point, moving.value, moving.modes[point.first :].T)
    return moving.frequency / (2 * np.pi), errors


def _frequencies(
    rich: Structure, index: NDArray[np.int_], point: OperatingPoint, coordinates: Complex, *, gyroscopic: bool
) -> Floats:
    """Circular frequencies of the rich structure's modes that are most like those given, rad/s."""
    linear, first = _about_equilibrium(rich, point), point.first
    rate, modes = _oscillating(linear, first, gyroscopic=gyroscopic)
    if not rate.size:
        return np.full(len(coordinates), np.nan)
    lifted = np.zeros((len(coordinates), rich.size), dtype=complex)
    lifted[:, index] = coordinates
    return np.asarray(rate[mac(lifted, modes, linear.mass[first:, first:]).argmax(axis=1)])


def _oscillating(linear: Linear, first: int, *, gyroscopic: bool) -> tuple[Floats, Complex]:
    """Circular frequencies (k,) of the modes that oscillate, ascending, and the beam's coordinates in them, (k, n)."""
    moving = vibrations(linear, gyroscopic=gyroscopic)
    return moving.frequency, moving.modes[first:].T


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
