"""Where a machine cannot make a flight's load: when, by how much, and the smallest change that would help."""

from __future__ import annotations

from collections.abc import Callable

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float
from numpy.typing import NDArray

from gbeam.motion.bases.record import STANDARD_GRAVITY
from gbeam.motion.centrifuge.target.load_limits import REACH, UNTOUCHED, missing_across
from gbeam.motion.centrifuge.target.required_smoothing import widths_that_do
from gbeam.motion.centrifuge.target.target import LEAST_IDLE, Target
from gbeam.motion.profiles.profile import Profile, sampled
from gbeam.numerics.batching import in_blocks
from gbeam.numerics.time_derivative import with_rate
from gbeam.results.response import Shortfall

_GRID = 0.002  # s
_JOINED = 0.1  # s: two stretches of one kind nearer than this are told as one
_ROUNDING = 1e-6

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]


def shortfalls(target: Target, arm: float) -> tuple[Shortfall, ...]:
    """Find where the flight's load is below idle, across the beam below gravity, or turns too sharply.

    Parameters
    ----------
    target : Target
    arm : float
        R, m.
    """
    time = _times(target)
    flight, _, _ = in_blocks(_seen, target, time)
    idle, gravity = float(target.idle), float(target.gravity)
    found = [it for it, _ in sharp_turns(target, arm)]
    total, across = np.linalg.norm(flight, axis=-1), np.linalg.norm(flight[:, 1:], axis=-1)
    found += _below(time, total, idle, "below idle", lambda run: _idle_remedy(total[run], across[run], gravity))
    if gravity:
        found += _below(time, across, REACH, "across below gravity", lambda run: _across_remedy(np.min(across[run])))
    return tuple(sorted(found, key=lambda it: it.start))


def sharp_turns(target: Target, arm: float) -> list[tuple[Shortfall, float | None]]:
    """Find where the load turns too sharply, and the smoothing, s, that would do; None where none does.

    theory.md A1: at a maximum, and at the corner before a plateau, the horizontal load a can be followed without a jump
    of the yaw rate only where −ä <= a²/R. A corner of slope change j rounded over T has −ä = 2j/T, and a straight
    slope j of a load f that gravity is part of −ä = (jγ)²/a³, which no rounding changes. At a corner short of a maximum
    somewhat more can be followed, and axis 2 pays: 2.3 times the acceleration for 1.3 times the turn.
    """
    time = _times(target)
    flight, (size, _, turn), held = in_blocks(_seen, target, time)
    allowed, total = size**2 / arm, np.linalg.norm(flight, axis=-1)
    runs = _runs((-turn > allowed * (1 + _ROUNDING)) & ~held, time)
    if not runs:
        return []
    widths = widths_that_do(target.corners, float(target.gravity), arm, time, held, runs, 2 * float(target.reach))
    remedies = [_sharp_remedy(it, float(np.max(total[run]))) for it, run in zip(widths, runs, strict=True)]
    return list(zip(_too_sharp(time, -turn, allowed, runs, remedies), widths, strict=True))


def _times(target: Target) -> Floats:
    return sampled(float(target.ready), float(target.span[1]), _GRID)


@eqx.filter_jit
def _seen(target: Target, time: Array) -> tuple[Array, tuple[Array, Array, Array], Array]:
    """The flight's load; size of the horizontal target with two rates; whether it is held."""
    return target.flight(time), size_and_rates(target.load, target.gravity, time), target.not_followed(time)


def size_and_rates(
    load: Profile, gravity: Float[Array, ""], time: Float[Array, "*t"]
) -> tuple[Float[Array, "*t"], Float[Array, "*t"], Float[Array, "*t"]]:
    """Horizontal load H = sqrt(f² − γ²), m/s², with its first and second time derivatives."""

    def size(t: Array) -> Array:
        return jnp.sqrt(jnp.maximum(jnp.sum(load(t) ** 2, axis=-1) - gravity**2, 1e-12))

    (value, rate), (_, second) = with_rate(lambda t: with_rate(size, t), time)
    return value, rate, second


def _idle_remedy(total: Floats, across: Floats, gravity: float) -> str:
    """What would let loads below idle, m/s², be followed."""
    least = np.floor(100 * np.min(total) / UNTOUCHED / STANDARD_GRAVITY) / 100
    if least >= (LEAST_IDLE if gravity else 0.02):
        return f'idle = "{least:.2f} g" or less would follow it'
    if not gravity:
        return "no machine follows a load so near to zero: it is held"
    if np.min(across) >= REACH:
        return "without idle it would be followed"
    return f"no machine follows a load below {REACH / STANDARD_GRAVITY:g} g across the beam: it is held"


def _sharp_remedy(width: float | None, load: float) -> str:
    """What would let a turn be followed, or held: the smoothing, s, that does, if any; the largest load then, m/s²."""
    if width is not None:
        return f'smoothing = "{np.ceil(1e3 * width):.0f} ms" or more would let it'
    return (
        f'no smoothing lets it; idle = "{np.ceil(100 * load / UNTOUCHED / STANDARD_GRAVITY) / 100:.2f} g" would hold it'
    )


def _across_remedy(least: float) -> str:
    reach = REACH / STANDARD_GRAVITY
    return f"add {missing_across(least)} across the beam, or track a part of the flight with {reach:g} g there"


def _runs(flags: Flags, time: Floats) -> list[slice]:
    """Stretches of true flags, those nearer than _JOINED as one."""
    edges = np.diff(flags.astype(int), prepend=0, append=0)
    runs: list[slice] = []
    for start, stop in zip(np.flatnonzero(edges > 0), np.flatnonzero(edges < 0), strict=True):
        if runs and time[start] - time[runs[-1].stop - 1] < _JOINED:
            runs[-1] = slice(runs[-1].start, int(stop))
        else:
            runs.append(slice(int(start), int(stop)))
    return runs


def _below(time: Floats, load: Floats, least: float, reason: str, remedy: Callable[[slice], str]) -> list[Shortfall]:
    found = []
    for run in _runs(load < least * (1 - _ROUNDING), time):
        worst = run.start + int(np.argmin(load[run]))
        wanted, possible = load[worst] / STANDARD_GRAVITY, least / STANDARD_GRAVITY
        start, end, when = float(time[run.start]), float(time[run.stop - 1]), float(time[worst])
        found.append(Shortfall(start, end, reason, when, float(wanted), float(possible), "g", remedy(run)))
    return found


def _too_sharp(time: Floats, turn: Floats, allowed: Floats, runs: list[slice], remedies: list[str]) -> list[Shortfall]:
    found = []
    for run, remedy in zip(runs, remedies, strict=True):
        worst = run.start + int(np.argmax(turn[run] / allowed[run]))
        start, end, when = float(time[run.start]), float(time[run.stop - 1]), float(time[worst])
        wanted, possible = float(turn[worst]), float(allowed[worst])
        found.append(Shortfall(start, end, "turns sharply", when, wanted, possible, "m/s^4", remedy))
    return found
