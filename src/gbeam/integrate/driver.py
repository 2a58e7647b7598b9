"""Run a scheme over a time span, in compiled chunks of fixed length."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray

from gbeam.integrate.gauss import Gauss4
from gbeam.integrate.stepper import OneStep
from gbeam.integrate.system import LinearSystem, NonlinearSystem, State, System

CHUNK = 1000  # steps per compiled call: long enough to hide the call, short enough for progress and an early stop
Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Trajectory:
    """Coordinates over time, as far as the integration got.

    Parameters
    ----------
    time : (t,) s
    q, qd, qdd : (t, n)
    converged : bool
        False where the acceleration could not be found in the step after the last time.
    stopped : bool
        Whether the caller's condition stopped it.
    """

    time: Floats
    q: Floats
    qd: Floats
    qdd: Floats
    converged: bool = True
    stopped: bool = False


@eqx.filter_jit
def evaluate(drive: Callable[[Any], Any], t: Any) -> Any:
    """What drives a system at times t: the one compiled form of it, so give CHUNK times."""
    return drive(t)


@eqx.filter_jit
def _begin(system: System, scheme: OneStep | Gauss4, state: State, inputs: Any) -> Any:
    return scheme.start(system, state, inputs)


@eqx.filter_jit
def _chunk(system: System, scheme: OneStep | Gauss4, state: State, inputs: tuple[Any, ...], h: Any) -> Any:
    """CHUNK steps with the inputs at the scheme's offsets in each."""

    def step(carry: tuple[State, Any], at: tuple[Any, ...]) -> Any:
        state, fine = carry
        new, ok = scheme.step(system, state, h, at)
        return (new, fine & ok), (new.q, new.qd, new.qdd, fine & ok)

    (state, _), history = jax.lax.scan(step, (state, jnp.array(True)), inputs)
    return state, history


def integrate(
    system: LinearSystem | NonlinearSystem,
    scheme: OneStep | Gauss4,
    state: State,
    *,
    step: float,
    count: int,
    start: float = 0.0,
    stop: Callable[[Floats], int | None] | None = None,
    progress: Callable[[float], None] | None = None,
) -> Trajectory:
    """Integrate `count` steps of length `step`.

    Parameters
    ----------
    system : LinearSystem or NonlinearSystem
    scheme : OneStep or Gauss4
    state : State
        Initial q and q̇; the accelerations are found.
    step : float
        s.
    count : int
    start : float
        Initial time, s.
    stop : callable, optional
        Of the coordinates (k, n) of a chunk: the number of steps after which the run ends, or None.
    progress : callable, optional
        Called with the fraction done.

    Returns
    -------
    Trajectory
        Of count + 1 times; fewer where a step failed, a value was not finite, or `stop` said so.
    """
    # Apart from its drive a system is the same for every environment, and so is its compiled program.
    drive, system = system.drive, replace(system, drive=None)  # type: ignore[arg-type]
    first = evaluate(drive, jnp.asarray(np.full(CHUNK, start)))
    state, ok = _begin(system, scheme, state, jax.tree.map(lambda x: x[0], first))
    pieces: list[tuple[Floats, ...]] = [tuple(np.asarray(x)[None] for x in state[:3])]
    converged, stopped, done = bool(ok), False, 0
    while converged and not stopped and done < count:
        # Times are products, not sums, so that they do not drift.
        number = done + np.arange(CHUNK)
        inputs = tuple(evaluate(drive, jnp.asarray(start + (number + c) * step)) for c in scheme.offsets)
        state, history = _chunk(system, scheme, state, inputs, jnp.asarray(step))
        wanted = min(CHUNK, count - done)
        q, qd, qdd, good = (np.asarray(x)[:wanted] for x in history)
        good = good & np.isfinite(qdd).all(axis=1)
        valid = wanted if good.all() else int(np.argmin(good))
        converged = valid == wanted
        last = None if stop is None or valid == 0 else stop(q[:valid])
        stopped = last is not None
        valid = valid if last is None else last
        pieces.append((q[:valid], qd[:valid], qdd[:valid]))
        done += valid
        if progress is not None:
            progress(done / count)
    q, qd, qdd = (np.concatenate(p) for p in zip(*pieces, strict=True))
    time = np.asarray(start + step * np.arange(len(q)), dtype=np.float64)
    return Trajectory(time, q, qd, qdd, converged, stopped)
