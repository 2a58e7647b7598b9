"""Doubts about the joints of a run: stops that its steps may miss, springs turned over, friction that creeps."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np

from gbeam.analysis.system.point import in_words
from gbeam.arrays.types import Floats
from gbeam.integrate.equations import Trajectory
from gbeam.mechanics.tree.equations import Inputs
from gbeam.mechanics.tree.joints import SLIDES, SPIN, Joint
from gbeam.mechanics.tree.links import SLIP, SLIPS, STUCK, Link
from gbeam.mechanics.tree.signal_names import unit_of_effort
from gbeam.mechanics.tree.system import System
from gbeam.numerics.series import STEP

BEYOND = 1e-8  # of a coordinate's range: a stop is not met by less
STOPPED = 10  # times in which friction alone would stop a coordinate: held is what is slow for longer
LITTLE = 1e-3  # of a coordinate's way: less is no creep


def creeping(
    system: System, run: Trajectory, inputs: Callable[[], Inputs], inertia: Callable[[str, int], float]
) -> tuple[str, ...]:
    """Warn of coordinates that creep, or are driven, at rates at which friction has less than its size.

    `inertia` returns the mass, kg or kg m², that an effort on a local coordinate accelerates at a step. The coordinate
    is given by its name.
    """
    if not any(joint.frictions for joint in system.joints.values()):
        return ()
    warnings = list[str]()
    for name, joint, link, q, qd in _states(system, run, inputs()):
        values, rates = link.spring_values(q, qd)
        for kind, friction in joint.frictions.items():
            k, driven, step = joint.rate_names.index(kind), kind in joint.rates, np.diff(run.time)
            rate = rates[:, k]
            mean = (rate[1:] + rate[:-1]) / 2 if kind in SPIN else np.diff(values[:, k]) / step
            limit = SLIP if driven else STUCK
            # Rates at the ends of steps ring about the creep by as much as its size.
            slow = (np.abs(mean) < limit) & (np.maximum(np.abs(rate[1:]), np.abs(rate[:-1])) < 2 * limit)
            ends = np.flatnonzero(np.diff(slow, prepend=False, append=False)).reshape(-1, 2)
            if not driven and ends.size:
                # Friction stops an inertia in a few times m v/F; what turns back is slow for a shorter while.
                stopping = inertia(f"{name}.{joint.values[k]}", int(ends[0, 0])) * STUCK / friction
                lasting = np.diff(run.time[ends])[:, 0] > STOPPED * stopping
                ends = ends[lasting]
            moved = np.append(0.0, np.cumsum(mean * step))
            way = sum(float(np.ptp(moved[first : last + 1])) for first, last in ends)
            if way > LITTLE * np.abs(mean * step).sum():
                felt = max(float(np.abs(mean[first:last]).max()) for first, last in ends)
                sizes = way, float(np.diff(run.time[ends]).sum()), friction * math.tanh(felt / SLIP), friction
                warnings.append(_creeping(f"{name}.{kind}", *sizes, driven=driven))
    return tuple(warnings)


def _creeping(name: str, way: float, time: float, felt: float, friction: float, *, driven: bool) -> str:
    """Warning of a coordinate that moves by a `way`, m or rad, where friction, N or N m, is felt in part."""
    kind = name.rpartition(".")[2]
    far, smooth = in_words(kind, way), f"friction is smooth below {SLIPS[kind not in SLIDES]}"
    share = f"{felt:.4g} of {friction:.4g} {unit_of_effort(kind)} at most"
    if driven:
        return f"{name} moves by {far} in {time:.4g} s so slowly that its drive feels {share}: {smooth}"
    problem = f"{name} creeps by {far} in {time:.4g} s in which friction would hold it with {share}"
    return f"{problem}: {smooth}; rate = 0 holds what should not move"


def _states(
    system: System, run: Trajectory, inputs: Inputs
) -> Iterator[tuple[str, Joint, Link, list[Floats], list[Floats]]]:
    """Yield name, joint, link, and coordinates and rates of its steps over the times of a run, of every joint with
    springs, dampers, friction or stops.
    """
    states = [run.q, run.qd]
    if inputs.prescribed is not None:
        states = [system.tree.complete(state, inputs.prescribed[..., k, :]) for k, state in enumerate(states)]
    by_link = zip(*system.tree.parted(*states), strict=True)
    for name, link, (q, qd) in zip(system.linked, system.tree.links, by_link, strict=True):
        if not link.loose:
            yield name, system.joints[name], link, q[:-1], qd[:-1]  # the last are the body's own


def _held_coordinates(system: System, run: Trajectory, inputs: Inputs) -> Iterator[tuple[str, Joint, Floats, Floats]]:
    """Yield the name of each joint, the joint, and its held coordinates (t, h) and their rates over the times of a run.

    Of a ball the rotation vector is held.
    """
    for name, joint, link, q, qd in _states(system, run, inputs):
        # Rates are derivatives along time, by a complex step.
        ahead = [value + 1j * STEP * rate for value, rate in zip(q, qd, strict=True)]
        values, further = (link.spring_values(of_joint, qd)[0] for of_joint in (q, ahead))
        yield name, joint, values, further.imag / STEP


def missed_stop(system: System, run: Trajectory, inputs: Callable[[], Inputs]) -> tuple[str, ...]:
    """Warn of a stop that a coordinate meets and leaves between two times of a run, so that the steps may miss it."""
    if len(run.time) < 2 or not any(np.any(joint.holder.stop) for joint in system.joints.values()):
        return ()
    from scipy.interpolate import CubicHermiteSpline  # which takes a while to import

    for name, joint, values, rates in _held_coordinates(system, run, inputs()):
        components = zip(joint.values, values.T, rates.T, joint.holder.low, joint.holder.high, strict=True)
        for value, q, qd, low, high in components:
            for sign, end in ((1.0, high), (-1.0, -low)):
                if not np.isfinite(end):
                    continue
                spline = CubicHermiteSpline(run.time, sign * q, sign * qd)
                turns = spline.derivative().roots(extrapolate=False)
                step = np.clip(np.searchsorted(run.time, turns, side="right") - 1, 0, len(q) - 2)
                ends = sign * q[step], sign * q[step + 1]
                is_beyond = (spline(turns) > end + BEYOND * np.ptp(q)) & (np.abs(np.subtract(*ends)) < math.pi)
                missed = turns[is_beyond & (np.minimum(*ends) <= end)]
                if missed.size:
                    words = f"{name}.{value} meets a stop and leaves it within one step, at {missed[0]:.4g} s"
                    return (f"{words}: the steps may miss it, and their error is not known; give a smaller step",)
    return ()


def half_turn_warnings(system: System, run: Trajectory, inputs: Callable[[], Inputs]) -> tuple[str, ...]:
    """Warn of a ball that turns beyond 180°, from where its springs and stops act in the opposite direction."""
    if not any(joint.holds_turns for joint in system.joints.values()):
        return ()
    for name, joint, values, _ in _held_coordinates(system, run, inputs()):
        jumps = np.linalg.norm(np.diff(values[:, -3:], axis=0), axis=1) > math.pi
        if joint.holds_turns and jumps.any():
            words = (
                f"{name} turns by more than half a turn, at {run.time[int(jumps.argmax())]:.4g} s, and from there its"
            )
            return (f"{words} springs and stops hold it the other way round; let a revolute joint turn it so far",)
    return ()
