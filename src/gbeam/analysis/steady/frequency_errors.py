"""Errors of frequencies: from too few shapes, of the model, and of the theory of slender beams.

They are compared with those of the same model with more shapes, of the exact one, and of a thick beam beside a slender.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from gbeam.analysis.accuracy.beam_theory import described, mode_causes
from gbeam.analysis.accuracy.estimate import LIMIT, percent, wrong_by
from gbeam.analysis.steady.operating_point import OperatingPoint, Steady
from gbeam.analysis.system.richer import bases_of, judged_beams, richer
from gbeam.analysis.system.steady import SteadySystem
from gbeam.arrays.tree import each_leaf
from gbeam.errors import ComputationError
from gbeam.mechanics.enrichment import enrichment
from gbeam.mechanics.models import TORSION
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.theory import theory_of
from gbeam.mechanics.tree.system import System
from gbeam.numerics.eigen import mac, matched
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


class More(NamedTuple):
    """A structure or a system with more shapes, and names there of coordinates that are called otherwise."""

    model: Any
    renamed: Mapping[str, str]


class Richer:
    """Models with more shapes beside a steady state, the fastest of several: of the same kinds, exact, and of one beam
    the thick ones.
    """

    def __init__(self, state: OperatingPoint | SteadySystem) -> None:
        if isinstance(state, SteadySystem):
            self.theory, bodies = None, [*judged_beams(state.system).values()]
        else:
            self.theory, bodies = theory_of(state.structure), [state.structure]
        self.exact = _with_more(state, exact=True)
        only_exact = all(body.kind == "exact" for body in bodies)
        self.same = self.exact if only_exact else _with_more(state, exact=False)

    def errors(
        self, state: Any, eigenvalue: Complex, coordinates: Complex, *, gyroscopic: bool = True
    ) -> FrequencyErrors:
        """Errors of the frequencies of modes (k, n) with eigenvalues (k,) about a steady state."""
        frequency = np.abs(eigenvalue)
        same, exact = self.references(state, coordinates, gyroscopic=gyroscopic)
        by_theory = self.by_theory(state, coordinates, gyroscopic=gyroscopic)
        shapes, model, total = (np.abs(a / b - 1) for a, b in ((frequency, same), (same, exact), (frequency, exact)))
        theory = "" if self.theory is None else described(state.structure, by_theory.causes)
        shares = by_theory.shares
        return FrequencyErrors(shapes, model, shares, total + np.nan_to_num(shares), theory, by_theory.unseen)

    def references(self, state: Any, coordinates: Complex, *, gyroscopic: bool = True) -> tuple[Floats, Floats]:
        """Circular frequencies (k,) of modes by the models with more shapes and by exact ones; NaN where these do not
        rest.
        """

        def reference(richer: More) -> Floats:
            try:
                other = state.richer(richer.model)
                rate, modes = _oscillating(other, gyroscopic=gyroscopic)
            except (ComputationError, np.linalg.LinAlgError):
                return np.full(len(coordinates), np.nan)
            if not rate.size:
                return np.full(len(coordinates), np.nan)
            lifted = np.zeros((len(coordinates), modes.shape[1]), dtype=complex)
            lifted[:, [other.names.index(richer.renamed.get(name, name)) for name in state.names]] = coordinates
            mass = other.linear.mass[state.first :, state.first :]
            return np.asarray(rate[mac(lifted, modes, mass).argmax(axis=1)])

        exact = reference(self.exact)
        return exact if self.same is self.exact else reference(self.same), exact

    def by_theory(self, point: Any, coordinates: Complex, *, gyroscopic: bool = True) -> ByTheory:
        """Errors of these modes' frequencies by the theory of slender beams, which are not known of a system."""
        theory, k = self.theory, len(coordinates)
        if theory is None:
            return ByTheory(np.full(k, np.nan), {}, ())
        plate = theory.plate(np.asarray(np.pad(point.q, (0, theory.thick.size - len(point.q))))[None])
        try:
            others = [point.richer(each) for each in (theory.slender, *theory.variants(plate))]
            (slender, shape), (thick, deep), (plated, flat) = (
                _oscillating(each, gyroscopic=gyroscopic) for each in others
            )
        except (ComputationError, np.linalg.LinAlgError):
            return ByTheory(np.full(k, np.nan), {}, ())
        mass = others[1].linear.mass[point.first :, point.first :]
        mode, shape = (np.pad(each, ((0, 0), (0, len(mass) - each.shape[1]))) for each in (coordinates, shape))
        chosen = mac(mode, shape, mass).argmax(axis=1)
        looked = slice(None, chosen.max(initial=-1) + 1)
        among, beside = (matched(mac(shape[looked], each, mass))[0] for each in (deep, flat))
        pairs = (thick, among), (plated, beside)
        shares = np.max([np.abs(slender[chosen] / rate[match[chosen]] - 1) for rate, match in pairs], axis=0)
        bent = deep[:, : theory.slender.size]
        moving = np.einsum("ki,ij,kj->k", bent.conj(), mass[: bent.shape[1], : bent.shape[1]], bent).real
        alone = np.setdiff1d(np.arange(len(thick)), among)
        unseen = [j for j in alone if moving[j] > BENT and thick[j] < slender[looked].max(initial=0.0)]
        loads = point.residual.unpack(point.u)[1]
        worst = np.zeros(0, dtype=int) if not k else np.array([np.nan_to_num(shares).argmax()])
        return ByTheory(
            shares,
            mode_causes(theory, point.base, loads, coordinates[worst], slender[chosen[worst]], plate),
            tuple(float(thick[j]) / (2 * np.pi) for j in unseen),
        )


def pole_errors(state: Any) -> tuple[Floats, FrequencyErrors]:
    """Frequencies (k,) Hz of the poles that oscillate about a steady state, ascending, and their errors."""
    moving = state.moving
    errors = Richer(state).errors(state, moving.value, moving.modes[state.first :].T)
    return moving.frequency / (2 * np.pi), errors


def judgeable(of: Structure | System) -> bool:
    """Whether frequencies of a beam, or of a system with beams, have estimated errors."""
    return bool(judged_beams(of)) if isinstance(of, System) else of.source is not None and not of.traced


def _with_more(state: OperatingPoint | SteadySystem, *, exact: bool) -> More:
    """More shapes than a steady state has, in exact models or in models of its own kinds."""
    if isinstance(state, SteadySystem):
        point = state.point
        bases = bases_of(state.system, point.standing(), lambda _, __: each_leaf(lambda x: x[None], point.inputs))
        rich = richer(state.system, bases, exact=exact)
        return More(rich.system, rich.renamed)
    structure, (_, along_y, along_z, *_) = state.structure, state.structure.counts
    kind, directions = "exact" if exact else structure.kind, (True, along_y > 0, along_z > 0)
    model, index = enrichment(structure, state.base).model(kind, directions=directions)
    return More(model, {own: f"q{at + 1}" for own, at in zip(state.names, index, strict=True)})


def _oscillating(state: Steady, *, gyroscopic: bool) -> tuple[Floats, Complex]:
    """Circular frequencies (k,) of the modes that oscillate, ascending, and the coordinates in them, (k, n)."""
    moving = state.vibrations(gyroscopic=gyroscopic)
    return moving.frequency, moving.modes[state.first :].T
