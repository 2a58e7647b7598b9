"""A linear plant with the sampled controllers of a system around it: closed, or cut at one drive; its margins.

Commands are held from sample to sample and act after their delay; the plant between these events is exact, by the
matrix exponential. The map over the common period of all samples is the product of the maps from event to event: the
states are those of the plant, those of the laws, and the commands that act or are still to act, all as the period
begins; its inputs are held over it. Laws that are functions are taken by their slopes where they ask for nothing.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from scipy.linalg import expm
from scipy.optimize import brentq

from gbeam.arrays.types import Complex, Floats
from gbeam.errors import InputError
from gbeam.mechanics.tree.control import Feedback, Law, signal_names
from gbeam.results.state_space import Margin, Signal, StateSpace

SAMPLES = 1000  # of all controllers in their common period, at most
FINEST = 10**9  # parts of a step by which a delay is known
ROUNDING = 1e-6  # of z about one, where two motions of zero frequency meet
GRID = 2000  # frequencies, evenly in their logarithm, besides those about each pole
DECADES = 5  # below Nyquist's frequency
ABOUT = np.concatenate([[0.0], *(sign * np.geomspace(0.02, 50, 40) for sign in (1, -1))])  # a pole, in its widths


class Channel(NamedTuple):
    """A controller among the signals of its plant: columns of what it drives, rows of what it measures."""

    law: tuple[Floats, Floats, Floats, Floats]
    driven: slice
    measured: slice
    sign: float
    samples: int  # in the common period
    late: int  # whole steps of its delay
    part: Fraction  # of a step, the rest of it


def channels_of(plant: StateSpace, controllers: dict[str, Feedback]) -> tuple[float, list[Channel]]:
    """The common period, s, and the controllers of a plant, whose drives and measurements come one after the other."""
    unit = next(iter(controllers.values())).sample
    ratios, common = list[Fraction](), Fraction(1)
    for name, each in controllers.items():
        ratios.append(Fraction(each.sample / unit).limit_denominator(SAMPLES))
        common = Fraction(math.lcm(*(r.numerator for r in ratios)), math.gcd(*(r.denominator for r in ratios)))
        near = math.isclose(ratios[-1], each.sample / unit, rel_tol=1e-9)
        if not near or sum(common / r for r in ratios) > SAMPLES:
            problem = f"is {each.sample:.10g} s beside {unit:.10g} s: no common period has at most {SAMPLES:,} samples"
            raise InputError(f"controllers.{name}.sample", problem, "choose times in the ratio of small whole numbers")
    channels, drive, measure = [], 0, 0
    for (name, each), ratio in zip(controllers.items(), ratios, strict=True):
        late, part = divmod(Fraction(each.delay / each.sample).limit_denominator(FINEST), 1)
        ends = drive + len(each.drive), measure + len(each.measure)
        sign = 1.0 if each.reference is None else -1.0
        places = slice(drive, ends[0]), slice(measure, ends[1])
        law = linear_law(name, each, plant.time, plant.output[places[1]], plant.inputs[places[0]])
        channels.append(Channel(law, *places, sign, int(common / ratio), late, part))
        drive, measure = ends
    return unit * float(common), channels


class Loop(NamedTuple):
    """A plant and its controllers over a period: next states, outputs and last commands from states and inputs."""

    a: Floats
    b: Floats
    y: tuple[Floats, Floats]
    command: tuple[Floats, Floats]


Over = Callable[[Fraction], tuple[Floats, Floats]]


def over_parts(plant: StateSpace, period: float) -> Over:
    """Φ and Γ of a plant over parts of a period, s."""
    n, count = plant.b.shape
    block = np.zeros((n + count, n + count))
    block[:n, :n], block[:n, n:] = plant.a, plant.b

    @cache
    def over(part: Fraction) -> tuple[Floats, Floats]:
        whole = expm(block * (period * float(part)))
        return whole[:n, :n], whole[:n, n:]

    return over


def loop_of(plant: StateSpace, channels: list[Channel], over: Over, cut: int | None = None) -> Loop:
    """A plant whose first inputs and outputs are of controllers; an input replaces the drive `cut`."""
    m, k = channels[-1].driven.stop, channels[-1].measured.stop
    free, first = plant.b.shape[1] - m, 0 if cut is None else 1
    held = [each.late + 1 for each in channels for _ in range(each.driven.stop - each.driven.start)]
    ends = np.cumsum([len(plant.a), *(len(each.law[0]) for each in channels), *held])
    size = int(ends[-1])
    # Rows of all that changes, from the states and the inputs as the period begins.
    every = np.eye(size + first + free + k)
    inputs, references = every[size + first : size + first + free], every[size + first + free :]
    x, *others = np.split(every[:size], ends[:-1])
    laws, waiting = others[: len(channels)], [list(each) for each in others[len(channels) :]]  # the last one acts
    commands = np.zeros((m, len(every)))

    def measured() -> Floats:
        acting = np.array([each[-1] for each in waiting])
        return np.asarray(plant.c @ x + plant.d[:, :m] @ acting + plant.d[:, m:] @ inputs)

    y = measured()
    # At one time all samples come before any command begins to act.
    events = sorted(
        ((j + (each.part if acts else 0)) * Fraction(1, each.samples), acts, c)
        for c, each in enumerate(channels)
        for j in range(each.samples)
        for acts in (False, True)
    )
    for (time, acts, c), end in zip(events, [*(event[0] for event in events[1:]), Fraction(1)], strict=True):
        each = channels[c]
        if acts:
            for queue in waiting[each.driven]:
                queue.pop()
        else:
            la, lb, lc, ld = each.law
            error = each.sign * measured()[each.measured] + references[each.measured]
            commands[each.driven], laws[c] = lc @ laws[c] + ld @ error, la @ laws[c] + lb @ error
            for i in range(each.driven.start, each.driven.stop):
                waiting[i].insert(0, every[size] if i == cut else commands[i].copy())
        if end > time:
            whole, into = over(end - time)
            x = whole @ x + into[:, :m] @ np.array([queue[-1] for queue in waiting]) + into[:, m:] @ inputs
    after = np.concatenate([x, *laws, *(np.array(queue) for queue in waiting)])
    (a, b), of_y, of_commands = ((each[:, :size], each[:, size:]) for each in (after, y, commands))
    return Loop(a, b, of_y, of_commands)


def response_at(loop: tuple[Floats, Floats, Floats, Floats], step: float, w: Any) -> Complex:
    """Gain (k,) at frequencies (k,) rad/s of a loop of one input and output in steps."""
    a, b, c, d = loop
    z = np.exp(1j * np.atleast_1d(w) * step)
    states = np.linalg.solve(z[:, None, None] * np.eye(len(a)) - a, np.broadcast_to(b, (len(z), *b.shape)))
    return np.asarray(c @ states + d, dtype=complex)[:, 0, 0]


def margin_of(name: str, loop: tuple[Floats, Floats, Floats, Floats], step: float) -> Margin:
    """Margins of a loop with negative feedback."""
    highest = math.pi / step
    poles = np.log(np.linalg.eigvals(loop[0]).astype(complex) + 1e-300) / step
    near = (np.abs(poles.imag)[:, None] + np.maximum(np.abs(poles.real), 1e-9 * highest)[:, None] * ABOUT).ravel()
    w = np.unique(np.concatenate([np.geomspace(10.0**-DECADES * highest, highest, GRID), near]))
    w = w[(w >= 10.0**-DECADES * highest) & (w <= highest)]
    gains = response_at(loop, step, w)

    def crossings(values: Floats, of: Callable[[complex], float]) -> list[float]:
        at = np.flatnonzero(np.isfinite(values[:-1] * values[1:]) & (values[:-1] * values[1:] < 0))
        return [float(brentq(lambda x: of(response_at(loop, step, x)[0]), w[i], w[i + 1], rtol=1e-12)) for i in at]

    turned = [(x, -1 / each.real) for x in crossings(gains.imag, lambda g: g.imag)
              if (each := response_at(loop, step, x)[0]).real < 0]  # fmt: skip
    if gains[-1].real < 0:  # real at Nyquist's frequency
        turned.append((highest, -1 / gains[-1].real))
    with np.errstate(divide="ignore"):  # where there is no gain at all
        ones = crossings(np.log(np.abs(gains)), lambda g: math.log(abs(g)))
    phases = [(x, float(np.angle(-response_at(loop, step, x)[0]))) for x in ones]
    above = min(((k, x) for x, k in turned if k > 1), default=(math.inf, math.nan))
    below = max((k for _, k in turned if k < 1), default=0.0)
    phase = min(((abs(angle), x) for x, angle in phases), default=(math.inf, math.nan))
    delay = min(((angle % (2 * math.pi)) / x for x, angle in phases), default=math.inf)
    return Margin(
        drive=name,
        gain=above[0],
        gain_frequency=above[1] / (2 * math.pi),
        gain_low=below,
        phase=phase[0],
        phase_frequency=phase[1] / (2 * math.pi),
        delay=delay,
        modulus=float(np.abs(1 + gains).min()),
    )


def closed_loop(
    plant: StateSpace, controllers: dict[str, Feedback], outputs: Sequence[int], cut: str | None
) -> StateSpace:
    """A plant and its controllers in steps: closed, or cut at a drive, with the margins at every drive."""
    step, channels = channels_of(plant, controllers)
    drives, measured = signal_names(controllers, "drive"), signal_names(controllers, "measure")
    aims = [Signal(name, signal.unit) for name, signal in zip(measured, plant.outputs, strict=False)]
    m, over, period = len(drives), over_parts(plant, step), f"the common period of {1e3 * step:.4g} ms"
    # The gain of a loop that is cut changes with time where it is sampled more than once in the period.
    counts = dict(zip(drives, (each.samples for each in channels for _ in drives[each.driven]), strict=True))
    if cut is not None and counts[cut] > 1:
        problem = f"cuts {cut}, sampled {counts[cut]} times in {period}, whose gain changes with time"
        raise InputError("loop", problem, "ask for 'closed'")
    loops = {name: loop_of(plant, channels, over, cut=k) for k, name in enumerate(drives) if counts[name] == 1}
    loop = loop_of(plant, channels, over) if cut is None else loops[cut]
    margins = []
    for name, each in loops.items():
        c, d = (-part[drives.index(name)][None] for part in each.command)
        margins.append(margin_of(name, (each.a, each.b[:, :1], c, d[:, :1]), step))
    warnings = plant.warnings
    if several := [name for name in drives if counts[name] > 1]:
        warnings += (f"no margins of {', '.join(several)}, sampled more than once in {period}",)
    size = float(np.abs(np.linalg.eigvals(loop.a)).max())
    if cut is None and size > 1 + ROUNDING:
        warnings += (f"the closed loop is not stable: it grows with {math.log(size) / step:.4g} 1/s",)
    names = [
        f"{name}.state_{i + 1}" for name, one in zip(controllers, channels, strict=True) for i in range(len(one.law[0]))
    ]
    late = [
        f"{drives[i]}, {j + 1} before"
        for each in channels
        for i in range(each.driven.start, each.driven.stop)
        for j in range(each.late + 1)
    ]
    begun = [np.ravel(one.start) for one in controllers.values() if one.stateful]
    states = plant.states + tuple(Signal(each, "") for each in (*names, *late))
    chosen = list(outputs)
    if cut is None:
        b, c, d = loop.b, loop.y[0][chosen], loop.y[1][chosen]
        inputs, signals = plant.inputs[m:] + tuple(aims), tuple(plant.outputs[k] for k in chosen)
        value = plant.output[chosen]
    else:
        k = drives.index(cut)
        b, c, d = loop.b[:, :1], -loop.command[0][k : k + 1], -loop.command[1][k : k + 1, :1]
        signals = inputs = (Signal(cut, plant.inputs[k].unit),)
        value = np.zeros(1)
    return StateSpace(
        a=loop.a,
        b=b,
        c=c,
        d=d,
        states=states,
        inputs=inputs,
        outputs=signals,
        state=np.concatenate([plant.state, *begun, np.zeros(len(late))]),
        input=np.zeros(len(inputs)),
        output=value,
        model=plant.model,
        motion=plant.motion,
        time=plant.time,
        accelerated=plant.accelerated,
        step=step,
        margins=tuple(margins),
        warnings=warnings,
    )


STEPS = 1e-5, 1e-6  # of errors and states, by their size or one, both ways
AGREE = 1e-3  # of the largest slope of an effort or state, between the steps
NEAR = 1e-7  # of errors and states, by their size or one, within which the law is at rest


def linear_law(name: str, each: Feedback, t: float, measured: Floats, drives: tuple[Signal, ...]) -> Law:
    """A law as matrices; a function about what is measured where its system rests, or else about no error."""
    if isinstance(each.law, tuple):
        return each.law
    where, fix = f"controllers.{name}.law", "give matrices, or a system of python-control"
    try:
        begun = np.asarray(each.start if each.stateful else [], dtype=float)
    except (TypeError, ValueError):
        begun = np.array(np.nan)
    if not np.isfinite(begun).all():
        raise InputError(where, "is a function, whose state is no array of finite numbers", fix)
    aims, sign = np.zeros(len(measured)), 1.0
    if each.reference is not None:
        aims, sign = np.array([float(one(t)) for one in each.reference]), -1.0
    k, m, n = len(measured), len(drives), begun.size

    def stepped(at: Floats) -> Floats:
        """Efforts and next states, one after the other, from errors and states."""
        asked, after = each.effort(t, aims + sign * at[:k], at[k:].reshape(begun.shape) if each.stateful else None)
        values = np.concatenate([asked, np.asarray(after, dtype=float).ravel() if each.stateful else []])
        if len(values) != m + n:
            raise InputError(where, f"hands on a state of {len(values) - m} numbers, and starts with {n}", fix)
        return values

    rests = list[str]()
    for error in (sign * (measured - aims), np.zeros(k)):
        at = np.concatenate([error, begun.ravel()])
        size, value = np.maximum(1.0, np.abs(at)), stepped(at)
        # Slopes (output, input), forward and backward by each step.
        slopes = np.array(
            [
                np.stack([(stepped(at + h * part) - value) / (h * part.sum()) for part in np.diag(size)], axis=1)
                for step in STEPS
                for h in (step, -step)
            ]
        )
        slope = slopes[-2:].mean(axis=0)
        left = value - np.concatenate([np.zeros(m), begun.ravel()])
        if (np.abs(left) <= NEAR * np.abs(slope) @ size).all():
            largest = np.abs(slope).max(axis=1, keepdims=True)
            if not (np.abs(slopes - slope) <= AGREE * largest).all():
                problem = "is a function, which has no transfer function: it does not answer small errors in proportion"
                raise InputError(where, problem, fix)
            return slope[m:, k:], slope[m:, :k], slope[:m, k:], slope[:m, :k]
        rests += [f"{left[i]:.4g} {drive.unit} of {drive.name}" for i, drive in enumerate(drives) if left[i]]
    problem = f"is a function that asks for {rests[0]}" if rests else "is a function whose state changes"
    fix = "let the system rest where the law asks for nothing, by `initial` of joints and `state` of the law"
    raise InputError(where, f"{problem} where the system rests, and is not at rest without an error either", fix)
