"""Errors of a closed loop: the same laws around systems with more shapes, of thick beams and of coarser meshes."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from gbeam.analysis.accuracy.estimate import MORE_SHAPES, ROUGH_MESH
from gbeam.analysis.steady.frequency_errors import NO_REST, More, RicherModels
from gbeam.analysis.system.closed_loop import ROUNDING, Loops
from gbeam.analysis.system.linear import frozen
from gbeam.analysis.system.rest import transfer
from gbeam.analysis.system.richer import judged_bodies, left_unjudged
from gbeam.analysis.system.steady import SteadySystem
from gbeam.arrays.types import Complex, Floats, Indices
from gbeam.constants import DEGREE
from gbeam.errors import ComputationError, InputError
from gbeam.mechanics.tree.system import System
from gbeam.motion.protocol import Motion
from gbeam.results.errors import FrequencyErrors
from gbeam.results.state_space import MARGINS, Margin, StateSpace, slowest_first

UNKNOWN = 0.5  # of a margin: with a larger error it is not known
OWN, MORE, COARSER = "", "with more shapes", "with a coarser mesh"
SLENDER, THICK, PLATED = "of slender beams", "of thick beams", "with plate action"
CURES = {MORE: f"; {MORE_SHAPES}", COARSER: f"; {ROUGH_MESH[1]}"}
SHOWN = {  # words, factors and units
    "gain": ("gain", 1.0, ""),
    "gain_low": ("gain not below", 1.0, ""),
    "phase": ("phase", 1 / DEGREE, " deg"),
    "delay": ("delay", 1e3, " ms"),
    "modulus": ("least distance from -1", 1.0, ""),
}


class Other(NamedTuple):
    """Loops around another system. `columns` are the indices there of the states of the loops that are judged."""

    loops: Loops
    columns: Indices


class JudgedLoops:
    """The loops of a system about a state, one perhaps `cut` at a drive, and the same laws around richer systems."""

    def __init__(self, state: SteadySystem, loops: Loops, cut: str | None = None) -> None:
        """Put the laws around each richer model. If one has no such state, the errors are not known."""
        self.loops, self.cut, self.note, self.others = loops, cut, left_unjudged(state.system), dict[str, Other]()
        self.known = bool(judged_bodies(state.system)) or not self.note
        if not judged_bodies(state.system):
            return
        richer = RicherModels(state)
        models = {MORE: richer.exact}
        if richer.theories:
            theories = richer.systems_by_theory(state.system, state)[0]
            models |= zip((SLENDER, THICK, PLATED), (More(model, {}) for model in theories), strict=True)
        if richer.rough is not None:
            models[COARSER] = richer.rough
        try:
            self.others = {name: self._other_loops(state, model) for name, model in models.items()}
        except (ComputationError, np.linalg.LinAlgError):
            self.known, self.note = False, "; ".join(filter(None, (self.note, NO_REST)))

    def _other_loops(self, state: SteadySystem, model: More) -> Other:
        """The same laws around another model, about its state under the same drives."""
        transferred, count = transfer(state, model.model), len(state.names)
        first = np.array([transferred.names.index(model.renamed.get(name, name)) for name in state.names], dtype=int)
        added = len(transferred.names) - count
        of_laws = np.arange(2 * count, len(self.loops.closed.a)) + 2 * added  # and of commands
        return Other(self.loops.rebuild(transferred), np.concatenate([first, first + len(transferred.names), of_laws]))

    @property
    def unstable(self) -> tuple[str, ...]:
        """Warning if the closed loop decays, but one around a richer system grows; else empty."""
        growing = {name: model.loops.growth for name, model in self.others.items() if model.loops.growth}
        if self.loops.growth or not growing:
            return ()
        name, growth = next(iter(growing.items()))
        return (f"the closed loop is not stable {name}: it grows with {growth:.4g} 1/s{CURES.get(name, '')}",)

    def judge(self, computed: StateSpace) -> StateSpace:
        """Return a model of these loops with the errors of its poles and margins. A margin that is not known is NaN."""
        margins, warnings = [], [*computed.warnings, *self.unstable]
        by_cause = self._errors(self._margins)
        for k, margin in enumerate(computed.margins):
            of_drive = {cause: errors[k] for cause, errors in by_cause.items()}
            errors = np.sum([*of_drive.values()], axis=0)
            stated: dict[str, Any] = {f"{name}_error": float(e) for name, e in zip(MARGINS, errors, strict=True)}
            unknown = np.flatnonzero(errors > UNKNOWN)
            names = [MARGINS[i] for i in unknown]
            unjudged = [*names, *(f"{name}_frequency" for name in names if name in ("gain", "phase"))]
            stated |= dict.fromkeys(unjudged, math.nan)
            margins.append(replace(margin, unknown=", ".join(names), **stated))
            if names and not self.unstable:
                cause = max(of_drive, key=lambda name: of_drive[name][unknown].max())
                words = "; ".join(
                    _margin_words(name, margin, self.others[cause].loops.margins[k], cause) for name in names
                )
                warnings.append(f"margins of {margin.drive} are not known: {words}{CURES.get(cause, '')}")
        decay, oscillation = np.sum([*self._errors(self._poles).values()], axis=0).T
        poles: dict[str, Any] = {"decay_error": decay, "oscillation_error": oscillation}
        empty = np.zeros(0)
        note = FrequencyErrors(empty, empty, empty, empty, empty, note=self.note) if self.note else None
        return replace(computed, margins=tuple(margins), warnings=tuple(warnings), errors=note, **poles)

    def _errors(self, read: Callable[[str], Floats]) -> dict[str, Floats]:
        """Relative errors by cause of the values that `read` gives for a loop's name, or NaN where they are unknown."""
        computed = read(OWN)
        if not self.known:
            return {MORE: np.full_like(computed, np.nan)}
        errors = {MORE: np.zeros_like(computed)}
        errors |= {name: _relative_difference(read(name), computed) for name in (MORE, COARSER) if name in self.others}
        if SLENDER in self.others:
            errors[THICK] = np.maximum(*(_relative_difference(read(name), read(SLENDER)) for name in (THICK, PLATED)))
        return errors

    def _margins(self, name: str) -> Floats:
        """Margins (d, 5) of the loops of a name, NaN where these grow and have none."""
        loops = self.others[name].loops if name else self.loops
        if not loops.margins:
            return np.full((len(self.loops.margins), len(MARGINS)), np.nan)
        return np.array([[getattr(margin, kind) for kind in MARGINS] for margin in loops.margins])

    def _poles(self, name: str) -> Floats:
        """Real and imaginary parts (n, 2) 1/s of the poles, the slowest to decay first.

        Those of the loops of another name are the ones most like these, by the trace of the product of their
        projectors, in which no unit of a state counts.
        """
        value, right, left = _modes(self._matrix(self.loops))
        chosen = value
        if name:
            loops, columns = self.others[name]
            others, right_of, left_of = _modes(self._matrix(loops))
            likeness = np.abs((left @ right_of[columns]) * (left_of[:, columns] @ right).T)
            chosen = others[likeness.argmax(axis=1)]
        period = self.loops.period
        value, chosen = (np.asarray(np.log(z + 1e-300) / period, dtype=complex) for z in (value, chosen))
        parts = np.stack([chosen.real, chosen.imag], axis=1)[slowest_first(value)]
        return np.asarray(np.where(np.abs(parts) > ROUNDING / period, parts, 0.0))

    def _matrix(self, loops: Loops) -> Floats:
        return loops.closed.a if self.cut is None else loops.cuts[self.cut].a


def _modes(a: Floats) -> tuple[Complex, Complex, Complex]:
    """Eigenvalues (n,) of a matrix, right eigenvectors (n, n) in columns, and the dual left ones in rows."""
    value, right = np.linalg.eig(a)
    return value + 0j, right + 0j, np.linalg.pinv(right) + 0j


def _relative_difference(values: Floats, references: Floats) -> Floats:
    """Relative differences of values from references, or infinite where only one of both is finite and not zero."""
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = np.abs(values / references - 1)
    return np.where(values == references, 0.0, np.where(np.isfinite(shares), shares, np.inf))


def _margin_words(kind: str, margin: Margin, other: Margin, cause: str) -> str:
    """A margin of a kind, and the one of another loop, in the words of tables."""
    word, factor, unit = SHOWN[kind]
    computed, reference = (f"{factor * getattr(of_loop, kind):.4g}{unit}" for of_loop in (margin, other))
    return f"{word} {computed}, {reference} {cause}"


def unstable_richer_loop(system: System, motion: Motion | None, time: float) -> tuple[str, ...]:
    """Warn if the closed loop of a system decays as it starts, but one around a richer system grows.

    The warning is empty otherwise, also where a law has no slope.
    """
    try:
        state = frozen(system, motion, time, "start")
        return JudgedLoops(state, Loops.from_state(state, inputs=(), outputs=())).unstable
    except (InputError, ComputationError, np.linalg.LinAlgError):
        return ()
