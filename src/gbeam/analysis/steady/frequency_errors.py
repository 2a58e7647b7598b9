"""Errors of frequencies: from too few shapes, of the model, and of the theory of slender beams.

Frequencies are compared with those of the same model with more shapes and of the exact model, and those of slender with
those of thick beams. Those of meshes and matrices, which have no other model, are compared with the same with more
modes, and of meshes with coarser ones.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from gbeam.analysis.accuracy.beam_theory import WORDS, causes, described
from gbeam.analysis.accuracy.estimate import LIMIT, MORE_SHAPES, error_warning, percent
from gbeam.analysis.system.rest import transfer
from gbeam.analysis.system.richer import (
    Directions,
    coarser,
    judged_bodies,
    left_unjudged,
    richer,
    theories_of,
    with_beams,
)
from gbeam.analysis.system.steady import SteadySystem
from gbeam.arrays.types import Complex, Floats
from gbeam.errors import ComputationError
from gbeam.mechanics.models import TORSION
from gbeam.mechanics.tree.signal_names import deforming
from gbeam.mechanics.tree.system import System
from gbeam.numerics.eigen import Steady, mac, matched
from gbeam.results.errors import PARTS, ErrorEstimate, FrequencyErrors

BENT = 0.01  # of the kinetic energy: a mode of twist with less bending is hardly excited
BY_RICHER = "errors, by richer models"  # words of the progress
NO_REST = "with more shapes no place was found in which it rests"
STRAIGHT = 0.02  # of the length: beams that bend by less are straight for their theory; beyond, bend and twist couple
SHOWN = 3  # frequencies that the model lacks, named at most


def doubtful(errors: FrequencyErrors) -> tuple[str, ...]:
    """Warn of frequencies that are wrong by more than 1 %, of motions that grow, and of modes that the model lacks."""
    warnings = []
    if errors.growth:
        warnings.append(f"not stable with more shapes: a motion grows with {errors.growth:.4g} 1/s; {MORE_SHAPES}")
    above_limit = np.flatnonzero(errors.total > LIMIT)
    if above_limit.size:
        largest = int(above_limit[errors.total[above_limit].argmax()])
        modes = (
            f"mode {above_limit[0] + 1}"
            if len(above_limit) == 1
            else f"{len(above_limit)} modes, from mode {above_limit[0] + 1} on,"
        )
        parts = ErrorEstimate(**{part: float(getattr(errors, part)[largest]) for part in PARTS})
        size = percent(float(errors.total[largest])) + (" at most" if len(above_limit) > 1 else "")
        warnings.append(error_warning(f"the frequency of {modes}", size, parts, errors.theory))
    if errors.unseen:
        named = ", ".join(f"{frequency:.4g}" for frequency in errors.unseen[:SHOWN])
        further = f" and {len(errors.unseen) - SHOWN} more" if len(errors.unseen) > SHOWN else ""
        warnings.append(f"there are modes of bending and twist at {named} Hz{further} besides: {TORSION}")
    return tuple(warnings)


class ByTheory(NamedTuple):
    """Errors (k,) by the theory of slender beams, causes of the largest in words, and frequencies, Hz, that it
    lacks.
    """

    shares: Floats
    words: str
    unseen: tuple[float, ...]


class More(NamedTuple):
    """A system with more shapes. `renamed` has the new names of those coordinates whose names have changed."""

    model: System
    renamed: Mapping[str, str]


class RicherModels:
    """Richer models that judge a steady state's: with more shapes, the exact one, thick beams, and coarser meshes."""

    def __init__(self, state: SteadySystem, *, near: bool = True) -> None:
        """Make the richer models, of which thick beams may be linear where a state, and all that is asked, is `near`
        the straight one. `one_model` is true where no body has another model than its own.
        """
        system = state.system
        bodies, rough = judged_bodies(system), coarser(system)
        self.theories = theories_of(system, straight=near and state.bent(bodies) <= STRAIGHT)
        self.beams = {name: bodies[name] for name in self.theories}
        self.exact = _enriched(state, exact=True)
        self.one_model = all(body.richer is not None and body.exact for body in bodies.values())
        only_exact = all(body.exact for body in bodies.values())
        self.same = self.exact if only_exact else _enriched(state, exact=False)
        self.rough = None if rough is None else More(rough, {})

    def errors(
        self, state: Any, eigenvalue: Complex, coordinates: Complex, *, gyroscopic: bool = True
    ) -> FrequencyErrors:
        """Errors of the frequencies of modes (k, n) with eigenvalues (k,) about a steady state."""
        frequency = np.abs(eigenvalue)
        same, exact, rough, growth = self.references(state, coordinates, gyroscopic=gyroscopic)
        by_theory = self.theory_errors(state, coordinates, gyroscopic=gyroscopic)
        shapes, model = np.abs(frequency / same - 1), np.abs(same / exact - 1)
        total = np.abs(frequency / exact - 1)
        mesh = np.abs(rough / frequency - 1)
        total = total + np.nan_to_num(by_theory.shares) + (0.0 if self.rough is None else mesh)
        note = left_unjudged(state.system)
        if not note and len(frequency) and np.isnan(total).all():
            note = NO_REST
        growth = 0.0 if not gyroscopic or len(state.moving.growing) else growth
        return FrequencyErrors(
            shapes, self.model_share(model), by_theory.shares, mesh, total, *by_theory[1:], note, growth
        )

    def model_share(self, share: Any) -> Any:
        """Return a share of an error that is the model's, or NaN where no body has another model."""
        return np.nan * share if self.one_model else share

    def references(
        self, state: Any, coordinates: Complex, *, gyroscopic: bool = True
    ) -> tuple[Floats, Floats, Floats, float]:
        """Circular frequencies (k,) of the modes most like these (k, n) in three other models.

        The models are the same with more shapes, the exact one, and one with coarser meshes, or NaN if one is lacking
        or has no equilibrium. Last comes the rate, 1/s, at which a motion grows in the exact one, or zero where none
        does.
        """
        growth = 0.0

        def reference(richer: More | None) -> Floats:
            """Frequencies in one of the models, or NaN if it is lacking or has no equilibrium."""
            nonlocal growth
            unknown = np.full(len(coordinates), np.nan)
            if richer is None:
                return unknown
            try:
                richer_state = transfer(state, richer.model)
                vibrations = richer_state.vibrations(gyroscopic=gyroscopic)
            except (ComputationError, np.linalg.LinAlgError):
                return unknown
            if richer is self.exact:
                growth = float(vibrations.growing.real.max(initial=0.0))
            rate, modes = vibrations.frequency, vibrations.modes[richer_state.first :].T
            if not rate.size:
                return unknown
            lifted = among([richer.renamed.get(name, name) for name in state.names], richer_state.names, coordinates)
            mass = richer_state.linear.mass[state.first :, state.first :]
            return np.asarray(rate[mac(lifted, modes, mass).argmax(axis=1)])

        exact = reference(self.exact)
        same = exact if self.same is self.exact else reference(self.same)
        return same, exact, reference(self.rough), growth

    def systems_by_theory(self, system: System, state: Any = None) -> tuple[list[System], dict[str, Floats]]:
        """The system with slender beams, with thick ones, and with thick ones and plate action.

        They are followed by the stiffness (n, n) of plate action, by beam.
        Plate action depends on the bend, which is that of a state or, by default, negligible.
        """
        variants, plates = [], dict[str, Floats]()
        for name, theory in self.theories.items():
            q = np.zeros(0) if state is None else state.q[deforming(state.names, name)]
            plates[name] = theory.plate(np.pad(q, (0, theory.thick.size - len(q)))[None])
            variants.append((theory.slender, *theory.variants(plates[name])))
        kinds = zip(*variants, strict=True)  # all slender beams, all thick ones, all with plate action
        return [with_beams(system, dict(zip(self.theories, beams, strict=True))) for beams in kinds], plates

    def theory_errors(self, point: Any, coordinates: Complex, *, gyroscopic: bool = True) -> ByTheory:
        """Errors of the frequencies of modes (k, n) by the theory of slender beams, or NaN if they are not known."""
        k = len(coordinates)
        if not self.theories:
            return ByTheory(np.full(k, np.nan), "", ())
        models, plates = self.systems_by_theory(point.system, point)
        try:
            states = [transfer(point, model) for model in models]
            by_model = [_oscillating(state, gyroscopic=gyroscopic) for state in states]
        except (ComputationError, np.linalg.LinAlgError):
            return ByTheory(np.full(k, np.nan), "", ())
        # Frequencies, and modes in coordinates of each model.
        (slender, shape), (thick, deep), (plated, plate_shape) = by_model
        of_slender, of_thick = states[:2]
        mass = of_thick.linear.mass[point.first :, point.first :]
        mode = among(point.names, of_thick.names, coordinates)
        shape = among(of_slender.names, of_thick.names, shape)
        chosen = mac(mode, shape, mass).argmax(axis=1)
        lower = slice(None, chosen.max(initial=-1) + 1)
        like = matched(mac(shape[lower], deep, mass))[0]
        like_plated = matched(mac(shape[lower], plate_shape, mass))[0]
        pairs = (thick, like), (plated, like_plated)
        shares = np.max([np.abs(slender[chosen] / rate[match[chosen]] - 1) for rate, match in pairs], axis=0)
        # Modes of thick beams that no slender one resembles, and that bend enough to be excited.
        shared = [of_thick.names.index(name) for name in of_slender.names]
        bending = deep[:, shared]
        energy = np.einsum("ki,ij,kj->k", bending.conj(), mass[np.ix_(shared, shared)], bending).real
        unmatched = np.setdiff1d(np.arange(len(thick)), like)
        unseen = [j for j in unmatched if energy[j] > BENT and thick[j] < slender[lower].max(initial=0.0)]
        largest = np.zeros(0, dtype=int) if not k else np.array([np.nan_to_num(shares).argmax()])
        words = self.in_words(of_slender, of_thick, mode[largest], slender[chosen[largest]], plates)
        return ByTheory(shares, words, tuple(float(thick[j]) / (2 * np.pi) for j in unseen))

    def in_words(
        self, slender: Steady, thick: Steady, mode: Complex, rate: Floats, plates: Mapping[str, Floats]
    ) -> str:
        """Causes of the beam theory's error in a mode (1, n) at a rate (1,) rad/s, in words.

        They follow from its residual in the equations of thick beams beyond that in those of slender ones.
        """
        shared = np.ix_(*[[thick.names.index(name) for name in slender.names]] * 2)
        residual = np.zeros_like(mode)
        factors = -(rate**2), 1j * rate, np.ones(1)  # of M, C and K
        for of_thick, of_slender, factor in zip(thick.linear, slender.linear, factors, strict=False):
            difference = np.array(of_thick[thick.first :, thick.first :])
            difference[shared] -= of_slender[slender.first :, slender.first :]
            residual += factor[:, None] * (mode @ difference.T)
        energies, by_beam = dict[str, float](), dict[str, dict[str, float]]()
        for name, theory in self.theories.items():
            columns = deforming(thick.names, name)
            p = mode[:, columns]
            energies[name] = float(np.einsum("ti,ij,tj->", p.conj(), theory.thick.coefficients.stiffness, p).real)
            by_beam[name] = causes(theory, p, residual[:, columns], p @ plates[name])
        total = sum(energies.values()) or 1.0
        merged = dict.fromkeys(WORDS, 0.0)
        for name, shares in by_beam.items():
            for cause, share in shares.items():
                merged[cause] += share * energies[name] / total
        return described(self.beams[max(energies, key=energies.__getitem__)], merged)


def among(names: Sequence[str], others: Sequence[str], modes: Complex) -> Complex:
    """Express modes (k, n) in coordinates called `names` by the coordinates `others`, which include these."""
    lifted = np.zeros((len(modes), len(others)), dtype=complex)
    lifted[:, [others.index(name) for name in names]] = modes
    return lifted


def pole_errors(state: Any) -> tuple[Floats, FrequencyErrors]:
    """Frequencies (k,) Hz of the oscillating poles about a steady state, in ascending order, and their errors."""
    vibrations = state.moving
    errors = RicherModels(state).errors(state, vibrations.value, vibrations.modes[state.first :].T)
    return vibrations.frequency / (2 * np.pi), errors


def unknown_errors(system: System, count: int) -> FrequencyErrors | None:
    """Errors of `count` frequencies that are NaN, with the reason why they are unknown,
    or None if there is no reason.
    """
    note, unknown = left_unjudged(system), np.full(count, np.nan)
    return FrequencyErrors(unknown, unknown, unknown, unknown, unknown, note=note) if note else None


def _enriched(state: SteadySystem, *, exact: bool) -> More:
    """Return the model of a steady state with more shapes, of its own kinds or exact.

    A beam alone, which turns about one axis at most, gets none in a plane in which it has none.
    """
    system, directions = state.system, dict[str, Directions]()
    bases = state.solution.bases(judged_bodies(system))
    for name, body in system.flexible.items():
        if len(system.flexible) == 1 and len(system.tree.unknowns) <= body.size + 1:
            directions[name] = True, body.counts[1] > 0, body.counts[2] > 0
    rich = richer(system, bases, exact=exact, bent_directions=directions)
    return More(rich.system, rich.renamed)


def _oscillating(state: Steady, *, gyroscopic: bool) -> tuple[Floats, Complex]:
    """Circular frequencies (k,) of the oscillating modes, ascending, and the modes (k, n) in bodies' coordinates."""
    vibrations = state.vibrations(gyroscopic=gyroscopic)
    return vibrations.frequency, vibrations.modes[state.first :].T
