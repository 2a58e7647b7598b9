"""Loss of a relative equilibrium as a load or rate grows, and the error of the critical value."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from gbeam.analysis.accuracy.estimate import (
    LIMIT,
    error_warning,
    not_known,
    percent,
    reference_model,
    relative_difference,
)
from gbeam.analysis.steady.frequency_errors import RicherModels, among
from gbeam.analysis.steady.subject import Subject
from gbeam.analysis.system.linear import instabilities
from gbeam.analysis.system.path import Path
from gbeam.analysis.system.rest import transfer
from gbeam.analysis.system.richer import judged_bodies, left_unjudged
from gbeam.analysis.system.steady import SteadySystem, open_loops
from gbeam.arrays.types import Floats
from gbeam.errors import ComputationError
from gbeam.mechanics.plausibility import input_warnings
from gbeam.mechanics.tree.system import System
from gbeam.numerics.eigen import ZERO, symmetric, symmetric_modes, vibrations
from gbeam.progress import Progress, tell
from gbeam.results.equilibrium import Critical
from gbeam.results.errors import ErrorEstimate, direction_words
from gbeam.results.result import NOT_KNOWN

SCAN = 64  # values at which the equilibrium is looked at before Brent's method


def _state(path: Path, system: System, value: float) -> SteadySystem | None:
    """Steady state at a value of a path, or None if there is none."""
    try:
        return path(system, value)
    except (ComputationError, np.linalg.LinAlgError):
        return None


def _in_turn(path: Path, system: System, values: Sequence[float]) -> Iterator[float]:
    """Yield values in turn. Before, states are solved for in groups of the next 1, 2, 4, ... values at once."""
    for k, value in enumerate(values):
        power_of_two = k & (k - 1) == 0
        if k and power_of_two:
            path.prepare(system, values[k : 2 * k])
        yield value


def _doubts(path: Path, subject: Subject, value: float) -> tuple[str, ...]:
    """Doubts about one body, or about a system: its bodies, open loops, and friction that holds it just below a
    value.
    """
    if subject.body:
        return input_warnings(subject.structure)
    state = _state(path, subject.system, (1 - CLOSE) * value)
    of_system = subject.system.warnings + open_loops(subject.system)
    return of_system + (() if state is None else state.point.sticking(subject.system))


def first_loss_along(
    path: Path, subject: Subject, upper: float, quantity: str, unit: str, progress: Progress = None
) -> Critical:
    """Least value up to `upper` at which the relative equilibrium is lost, by a grid of 64 and Brent's method."""
    system = subject.system

    @cache
    def margin(value: float) -> float:
        """Stability margin of the state at a value; negative where it is lost, too."""
        tell(progress, f"equilibrium, {quantity} {value:.4g} {unit}", value / upper)
        state = _state(path, system, value)
        return -1.0 if state is None else state.margin

    def answer(value: float | None, kind: str, direction: str, reason: str) -> Critical:
        words = kind, direction, reason, subject.kind
        doubts = _doubts(path, subject, upper if value is None else value)
        return Critical(quantity, unit, value, upper, *words, warnings=doubts)

    grid = [float(value) for value in np.linspace(0.0, upper, SCAN + 1)]
    first = next((i for i, value in enumerate(_in_turn(path, system, grid)) if margin(value) < 0), None)
    if first is None:
        why = f"{subject.kind} keeps its equilibrium at every {quantity} up to {upper:.4g} {unit}"
        return answer(None, "none", "", why)
    if first == 0:
        return answer(0.0, "divergence", "", f"the {subject.noun} is unstable before anything moves")
    from scipy.optimize import brentq

    root = brentq(margin, grid[first - 1], grid[first], xtol=1e-11, rtol=1e-9, maxiter=200)
    state = _state(path, system, root) or path(system, grid[first - 1])
    lost_state = _state(path, system, root * (1 + 1e-5))
    if lost_state is None:
        kind, direction = "no equilibrium", ""
    else:
        grown = instabilities(lost_state, lost_state.moving, subject.directions)
        kind, direction = (grown[0].kind, grown[0].direction) if grown else ("divergence", "")
    if kind == "divergence":
        # Only symmetric parts store energy.
        stiffness, mass = symmetric(state.linear.stiffness), symmetric(state.linear.mass)
        direction = subject.directions(state, symmetric_modes(stiffness, mass)[1][:, :1])[0]
    way = f" {direction_words(direction)}" if direction else ""
    reason = f"{kind}{way} at {root:.6g} {unit}"
    # Half way, where nothing grows yet without bound, with half of the load or less.
    undecided = not_known(2 * path(system, root / 2).bend, reason)
    if undecided:
        words = f"{subject.kind} keeps its equilibrium up to there, and {undecided['message']}"
        return replace(answer(None, NOT_KNOWN, direction, words), searched_to=root, **undecided)
    return answer(root, kind, direction, f"{subject.kind}: {reason}")


FOLLOWED = 20  # steps to the critical value, closer to one another near it, where frequencies fall by a root
LOWEST = 4  # frequencies followed


def with_frequencies(critical: Critical, path: Path, system: System, progress: Progress = None) -> Critical:
    """Add to a critical value the lowest undamped frequencies on the way to it."""
    end = critical.searched_to if critical.value is None else (1 - CLOSE) * critical.value
    values = end * np.sin(np.linspace(0.0, np.pi / 2, FOLLOWED + 1)) if end else np.zeros(1)
    frequency, last = np.full((len(values), LOWEST), np.nan), None
    for row, value in zip(frequency, _in_turn(path, system, values.tolist()), strict=True):
        tell(progress, "frequencies on the way to it", value / end if end else 0.0)
        state = _state(path, system, value)
        if state is not None:
            c = state.linear.velocity
            undamped = state.linear._replace(velocity=(c - c.T) / 2)  # what is overdamped has no frequency
            lowest = vibrations(undamped, zero=max(state.zero, ZERO)).frequency[:LOWEST]
            row[: len(lowest)] = lowest / (2 * np.pi)
            last = state
    is_turning = last is not None and last.whirl is not None and last.whirl.turning
    return replace(critical, followed=values, frequency=frequency, frame="turning" if is_turning else "ground")


# Shares of the critical value at which richer models are tried, ascending.
SHARES = 0.25, 0.5, 0.7, 0.8, 0.9, 0.95, 0.98, 0.995, 1.005, 1.02, 1.05, 1.1, 1.2, 1.5, 2.0, 3.0
HALVINGS = 16
CLOSE = 1e-6  # of the critical value: tolerance of its root


def judged(critical: Critical, path: Path, subject: Subject, progress: Progress = None) -> Critical:
    """Add to a critical value its errors, estimated by richer models, and warnings if they exceed 1 %."""
    system, critical = subject.system, replace(critical, error_note=left_unjudged(subject.system))
    if critical.value == 0 or critical.kind == NOT_KNOWN or not judged_bodies(system):
        return critical
    if critical.value is None:
        doubts = _unseen(critical, path, system, progress)
        return replace(critical, warnings=critical.warnings + doubts)
    critical_value = critical.value
    point = path(system, (1 - CLOSE) * critical_value)
    richer = RicherModels(point)
    count = 5 if richer.theories else 2
    exact = loss_of_model(richer.exact.model, path, critical_value, progress, part=(0, count))
    same = (
        exact
        if richer.same is richer.exact
        else loss_of_model(richer.same.model, path, critical_value, progress, part=(1, count))
    )
    errors = _errors(critical_value, same, exact)
    if richer.rough is not None:
        errors = errors.adding(
            mesh=relative_difference(loss_of_model(richer.rough.model, path, critical_value, progress), critical_value)
        )
    if not richer.theories:
        errors = replace(errors, model=richer.model_share(errors.model))
        doubts = doubtful_loss(critical.quantity, critical.model, errors)
        return replace(critical, errors=errors, warnings=critical.warnings + doubts)
    models, plates = richer.systems_by_theory(system)
    slender, *thick = (
        loss_of_model(model, path, critical_value, progress, part=(k, count)) for k, model in enumerate(models, start=2)
    )
    beam_theory = max(relative_difference(critical_value if math.isinf(slender) else slender, value) for value in thick)
    errors = errors.adding(beam_theory=0.0 if math.isinf(errors.model) else beam_theory)
    words = _in_words(richer, point, models, plates)
    model = critical.model if subject.body else "the system"
    doubts = doubtful_loss(critical.quantity, model, errors, words)
    return replace(critical, errors=errors, warnings=critical.warnings + doubts)


def _errors(value: float, same: float, exact: float) -> ErrorEstimate:
    """Errors of a critical `value`, from those of the same model and of the exact one with more shapes."""
    if math.isinf(exact):
        model = total = math.inf
    else:
        model, total = abs(same / exact - 1), abs(value / exact - 1)
    return ErrorEstimate(0.0, abs(value / same - 1), model, total=total)


def _in_words(richer: RicherModels, point: Any, models: Sequence[Any], plates: Mapping[str, Floats]) -> str:
    """Causes of the beam theory's error in words, by the mode with the least stiffness, or "" without equilibrium."""
    try:
        slender, thick = (transfer(point, model) for model in models[:2])
    except ComputationError:
        return ""
    stiffness, mass = symmetric(slender.linear.stiffness), symmetric(slender.linear.mass)
    lowest = symmetric_modes(stiffness, mass)[1][:, :1].T
    shape = among(slender.names, thick.names, lowest)
    return richer.in_words(slender, thick, shape, np.zeros(1), plates)


def _unseen(critical: Critical, path: Path, system: System, progress: Progress) -> tuple[str, ...]:
    """Warn if a richer model, with twist or more modes, loses its equilibrium before the end of the search."""
    shares = tuple(2.0**-k for k in range(HALVINGS, -1, -1))
    richer, lacked = RicherModels(path(system, 0.0)), "more modes"
    rich = richer.exact.model
    if richer.theories:
        (_, rich, *_), lacked = richer.systems_by_theory(system)[0], "shear and twist"
    rich_loss = loss_of_model(rich, path, critical.searched_to, progress, shares)
    if math.isinf(rich_loss):
        return ()
    value = f"{rich_loss:.4g} {critical.unit}"
    return (f"with {lacked}, which this model has not, the equilibrium is lost at an estimated {value}",)


def loss_of_model(
    rich: System,
    path: Path,
    expected: float,
    progress: Progress,
    shares: Sequence[float] = SHARES,
    part: tuple[int, int] = (0, 1),
) -> float:
    """Value at which a richer model loses its equilibrium, or infinite if it keeps it up to the last share of
    `expected`.

    `part` has the number of models done and the number of all, for the progress.
    """

    @cache
    def margin(value: float) -> float:
        """Stability margin of the state at a value; negative if there is none."""
        state = _state(path, rich, value)
        return -1.0 if state is None else state.margin

    from scipy.optimize import brentq

    low, kinds = 0.0, " and ".join(sorted({body.kind for body in rich.flexible.values()}))
    for i, value in enumerate(_in_turn(path, rich, [share * expected for share in shares])):
        done = (part[0] + i / len(shares)) / part[1]
        tell(progress, f"errors of the critical value, by {kinds} with more shapes", done)
        if margin(value) < 0:
            return brentq(margin, low, value, xtol=CLOSE * expected, maxiter=200)
        low = value
    return math.inf


def doubtful_loss(quantity: str, model: str, errors: ErrorEstimate, theory: str = "") -> tuple[str, ...]:
    """Warn of a critical value that is wrong by more than 1 %, or that the richer model does not have."""
    if math.isinf(errors.total):
        return (
            f"the critical {quantity} is {model}'s own: {reference_model(errors)} keeps its equilibrium to "
            f"{SHARES[-1]:g} times that at least",
        )
    if not errors.total > LIMIT:
        return ()
    return (error_warning(f"the critical {quantity}", percent(errors.total), errors, theory),)
