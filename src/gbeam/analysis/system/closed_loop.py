"""A linear plant with the sampled controllers of a system around it: closed, or cut at one drive; its margins.

Commands are held from sample to sample and act after their delay; the plant between samples is exact, by the matrix
exponential. With a delay of m samples and a part f of one, x⁺ = Φ(T) x + Φ(T − f) Γ(f) u_{k−m−1} + Γ(T − f) u_{k−m}:
the states are those of the plant at samples, those of the laws, and the commands that are still to act.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm
from scipy.optimize import brentq

from gbeam.errors import InputError
from gbeam.mechanics.tree.control import Feedback, signal_names
from gbeam.results.state_space import Margin, Signal, StateSpace

Array = Any
Floats = NDArray[np.float64]
Complex = NDArray[np.complex128]
WHOLE = 1e-9  # of a sample: a shorter part of one is none
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
    late: int
    part: float


def channels_of(controllers: dict[str, Feedback]) -> tuple[float, list[Channel]]:
    """The step, s, and the controllers of a system, drives and measurements one after the other."""
    step = next(iter(controllers.values())).sample
    channels, drive, measure = [], 0, 0
    for name, each in controllers.items():
        where = f"controllers.{name}"
        if not isinstance(each.law, tuple):
            fix = "give matrices, or a system of python-control"
            raise InputError(f"{where}.law", "is a function, which has no transfer function", fix)
        if not math.isclose(each.sample, step, rel_tol=1e-9):
            fix = f"sample all controllers every {step:g} s"
            raise InputError(f"{where}.sample", f"is {each.sample:g} s beside {step:g} s", fix)
        late, part = divmod(each.delay / step + WHOLE, 1.0)
        part = step * (part - WHOLE) if part > 2 * WHOLE else 0.0
        ends = drive + len(each.drive), measure + len(each.measure)
        sign = 1.0 if each.reference is None else -1.0
        channels.append(Channel(each.law, slice(drive, ends[0]), slice(measure, ends[1]), sign, int(late), part))
        drive, measure = ends
    return step, channels


class Loop:
    """A plant whose first inputs and outputs are of controllers, in steps; an input replaces the drive `cut`."""

    def __init__(self, plant: StateSpace, step: float, channels: list[Channel], cut: int | None = None) -> None:
        self.plant, self.step, self.channels = plant, step, channels
        m = channels[-1].driven.stop
        k = channels[-1].measured.stop
        n, free = len(plant.a), plant.b.shape[1] - m
        laws = [len(each.law[0]) for each in channels]
        held = [each.late + 1 for each in channels for _ in range(each.driven.stop - each.driven.start)]
        ends = np.cumsum([n, *laws, *held])
        size, first = int(ends[-1]), 0 if cut is None else 1
        inputs = first + free + k
        past = [slice(*pair) for pair in pairwise(ends[len(laws) :])]  # of each drive: u_{k−1}, u_{k−2} and so on

        def rows(count: int) -> tuple[Floats, Floats]:
            return np.zeros((count, size)), np.zeros((count, inputs))

        # Measurements from states and inputs: just before the sample, with the commands that acted then.
        y_x, y_w = rows(len(plant.c))
        y_x[:, :n] = plant.c
        y_w[:, first : first + free] = plant.d[:, m:]
        for i in range(m):
            y_x[:, past[i].stop - 1] += plant.d[:, i]
        u_x, u_w = rows(m)
        a, b = rows(size)
        for each, start, count in zip(channels, ends, laws, strict=False):
            la, lb, lc, ld = each.law
            error_x, error_w = (each.sign * part[each.measured] for part in (y_x, y_w))
            error_w = error_w.copy()
            error_w[:, first + free :][:, each.measured] += np.eye(each.measured.stop - each.measured.start)
            state = slice(start, start + count)
            a[state] = lb @ error_x
            a[state, state] += la
            b[state] = lb @ error_w
            u_x[each.driven], u_w[each.driven] = ld @ error_x, ld @ error_w
            u_x[each.driven, state] += lc
        self.command = u_x.copy(), u_w.copy()
        if cut is not None:
            u_x[cut], u_w[cut] = 0.0, np.eye(inputs)[0]
        whole, into = self._over(step)
        a[:n, :n] = whole
        b[:n, first : first + free] = into[:, m:]
        for i in range(m):
            each = next(one for one in channels if one.driven.start <= i < one.driven.stop)
            over, late = self._over(step - each.part)
            if each.part:
                a[:n, past[i].start + each.late] += over @ self._over(each.part)[1][:, i]
            if each.late:
                a[:n, past[i].start + each.late - 1] += late[:, i]
            else:
                a[:n] += np.outer(late[:, i], u_x[i])
                b[:n] += np.outer(late[:, i], u_w[i])
            a[past[i].start], b[past[i].start] = u_x[i], u_w[i]
            for j in range(past[i].start + 1, past[i].stop):
                a[j, j - 1] = 1.0
        self.a, self.b, self.y = a, b, (y_x, y_w)

    @property
    def growth(self) -> float:
        """Rate of what grows fastest, 1/s; zero where nothing grows."""
        size = float(np.abs(np.linalg.eigvals(self.a)).max())
        return math.log(size) / self.step if size > 1 + ROUNDING else 0.0

    def _over(self, time: float) -> tuple[Floats, Floats]:
        """Φ and Γ over a time, s."""
        n, count = self.plant.b.shape
        block = np.zeros((n + count, n + count))
        block[:n, :n], block[:n, n:] = self.plant.a, self.plant.b
        over = expm(block * time)
        return over[:n, :n], over[:n, n:]


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
    step, channels = channels_of(controllers)
    drives, measured = signal_names(controllers, "drive"), signal_names(controllers, "measure")
    aims = [Signal(name, signal.unit) for name, signal in zip(measured, plant.outputs, strict=False)]
    m = len(drives)
    loops = [Loop(plant, step, channels, cut=k) for k in range(m)]
    loop = Loop(plant, step, channels) if cut is None else loops[drives.index(cut)]
    margins = []
    for k, each in enumerate(loops):
        c, d = (-part[k : k + 1] for part in each.command)
        margins.append(margin_of(drives[k], (each.a, each.b[:, :1], c, d[:, :1]), step))
    growth = loop.growth if cut is None else 0.0
    unstable = (f"the closed loop is not stable: it grows with {growth:.4g} 1/s",) if growth > 0 else ()
    names = [f"{name}.state_{i + 1}" for name, one in controllers.items() for i in range(len(one.law[0]))]
    late = [
        f"{drives[i]}, {j + 1} before"
        for each in channels
        for i in range(each.driven.start, each.driven.stop)
        for j in range(each.late + 1)
    ]
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
        state=np.concatenate([plant.state, np.zeros(len(states) - len(plant.states))]),
        input=np.zeros(len(inputs)),
        output=value,
        model=plant.model,
        motion=plant.motion,
        time=plant.time,
        accelerated=plant.accelerated,
        step=step,
        margins=tuple(margins),
        warnings=plant.warnings + unstable,
    )
