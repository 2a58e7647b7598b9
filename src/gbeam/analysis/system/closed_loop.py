"""A linear plant with the sampled controllers of a system around it, closed or cut at one drive, and its margins.

Commands are held from sample to sample and act after their delay. The plant between these events is exact, by the
matrix exponential. The map over the common period of all samples is the product of the maps from event to event. Its
states are those of the plant, those of the laws, and the commands that act or are still to act, all as the period
begins. Its inputs are held over the period. Laws that are functions are taken by their slopes where they ask for
nothing.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache, cached_property
from itertools import count
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from scipy.linalg import expm, schur

from gbeam.analysis.system.gauges import Strained
from gbeam.analysis.system.linear import default_inputs, default_outputs, linearize_system
from gbeam.analysis.system.steady import SteadySystem
from gbeam.arrays.types import Complex, Floats
from gbeam.errors import InputError
from gbeam.mechanics.tree.control import Feedback, Law, naming_controller, refuse_memory, signal_names
from gbeam.results.state_space import Margin, Signal, StateSpace

SAMPLES = 1000  # of all controllers in their common period, at most
FINEST = 10**9  # parts of a step by which a delay is known
ROUNDING = 1e-6  # of z about one, where two motions of zero frequency meet
HALVINGS = 45  # of an interval of the grid, about a crossing
TINY = 1e-30  # beside z, of which it is no part unless z is a pole
GRID = 2000  # frequencies, evenly in their logarithm, besides those about each pole
DECADES = 5  # below Nyquist's frequency
ABOUT = np.concatenate([[0.0], *(sign * np.geomspace(0.02, 50, 40) for sign in (1, -1))])  # a pole, in its widths


class Channel(NamedTuple):
    """A controller at its plant: its law's matrices, the plant's inputs that it drives and outputs that it measures."""

    law: tuple[Floats, Floats, Floats, Floats]
    driven: slice
    measured: slice
    sign: float  # of the measurements in the error
    samples: int  # in the common period
    late: int  # delay in whole samples
    part: Fraction  # the rest of the delay, in samples


def channels_of(plant: StateSpace, controllers: dict[str, Feedback]) -> tuple[float, list[Channel]]:
    """Common period, s, of the samples, and a channel for each controller. InputError unless the period is short.

    The first inputs and outputs of the plant are those of the controllers, in their order.
    """
    unit = next(iter(controllers.values())).sample
    ratios, common = list[Fraction](), Fraction(1)
    for name, controller in controllers.items():
        ratios.append(Fraction(controller.sample / unit).limit_denominator(SAMPLES))
        common = Fraction(math.lcm(*(r.numerator for r in ratios)), math.gcd(*(r.denominator for r in ratios)))
        commensurate = math.isclose(ratios[-1], controller.sample / unit, rel_tol=1e-9)
        if not commensurate or sum(common / r for r in ratios) > SAMPLES:
            problem = (
                f"is {controller.sample:.10g} s beside {unit:.10g} s: no common period has at most {SAMPLES:,} samples"
            )
            raise InputError(f"controllers.{name}.sample", problem, "choose times in the ratio of small whole numbers")
    channels, drive, measure = [], 0, 0
    for (name, controller), ratio in zip(controllers.items(), ratios, strict=True):
        late, part = divmod(Fraction(controller.delay / controller.sample).limit_denominator(FINEST), 1)
        stops = drive + len(controller.drive), measure + len(controller.measure)
        sign = 1.0 if controller.reference is None else -1.0
        slices = slice(drive, stops[0]), slice(measure, stops[1])
        law = linear_law(name, controller, plant.time, plant.output[slices[1]], plant.inputs[slices[0]])
        channels.append(Channel(law, *slices, sign, int(common / ratio), late, part))
        drive, measure = stops
    return unit * float(common), channels


class Loop(NamedTuple):
    """Map over a period, by states and by inputs: next states (a, b), outputs and last commands."""

    a: Floats
    b: Floats
    y: tuple[Floats, Floats]
    command: tuple[Floats, Floats]


Propagator = Callable[[Fraction], tuple[Floats, Floats]]


def propagator(plant: StateSpace, period: float) -> Propagator:
    """Return a function that computes Φ and Γ of a plant over a fraction of a period, s: x₊ = Φ x + Γ u with u held."""
    n, count = plant.b.shape
    block = np.zeros((n + count, n + count))
    block[:n, :n], block[:n, n:] = plant.a, plant.b

    @cache
    def propagate(part: Fraction) -> tuple[Floats, Floats]:
        """Φ and Γ are blocks of the exponential of [[A, B], [0, 0]]."""
        transition = expm(block * (period * float(part)))
        return transition[:n, :n], transition[:n, n:]

    return propagate


def loop_of(plant: StateSpace, channels: list[Channel], propagate: Propagator, cut: int | None = None) -> Loop:
    """Map over the common period of a plant in the loop of `channels`.

    Its inputs are the plant's free ones, then the references. With a `cut`, the index of a drive, a first input
    replaces that drive's commands.
    """
    m, k = channels[-1].driven.stop, channels[-1].measured.stop
    free, first = plant.b.shape[1] - m, 0 if cut is None else 1
    delays = [channel.late + 1 for channel in channels for _ in range(channel.driven.stop - channel.driven.start)]
    ends = np.cumsum([len(plant.a), *(len(channel.law[0]) for channel in channels), *delays])
    size = int(ends[-1])
    # Each quantity is a row: its derivatives by the states and the inputs as the period begins.
    rows = np.eye(size + first + free + k)
    inputs, references = rows[size + first : size + first + free], rows[size + first + free :]
    x, *queues = np.split(rows[:size], ends[:-1])
    laws, waiting = queues[: len(channels)], [list(queue) for queue in queues[len(channels) :]]  # the last one acts
    commands = np.zeros((m, len(rows)))

    def measured() -> Floats:
        acting = np.array([queue[-1] for queue in waiting])
        return np.asarray(plant.c @ x + plant.d[:, :m] @ acting + plant.d[:, m:] @ inputs)

    y = measured()
    # At one time all samples come before any command begins to act.
    events = list[tuple[Fraction, bool, int]]()  # time, True if a command begins to act, number of the channel
    for c, channel in enumerate(channels):
        for j in range(channel.samples):
            events.append((j * Fraction(1, channel.samples), False, c))
            events.append(((j + channel.part) * Fraction(1, channel.samples), True, c))
    events.sort()
    for (time, acts, c), end in zip(events, [*(event[0] for event in events[1:]), Fraction(1)], strict=True):
        channel = channels[c]
        if acts:
            for queue in waiting[channel.driven]:
                queue.pop()
        else:
            la, lb, lc, ld = channel.law
            error = channel.sign * measured()[channel.measured] + references[channel.measured]
            commands[channel.driven], laws[c] = lc @ laws[c] + ld @ error, la @ laws[c] + lb @ error
            for i in range(channel.driven.start, channel.driven.stop):
                waiting[i].insert(0, rows[size] if i == cut else commands[i].copy())
        if end > time:
            phi, gamma = propagate(end - time)
            x = phi @ x + gamma[:, :m] @ np.array([queue[-1] for queue in waiting]) + gamma[:, m:] @ inputs
    next_state = np.concatenate([x, *laws, *(np.array(queue) for queue in waiting)])
    (a, b), by_y, by_commands = ((block[:, :size], block[:, size:]) for block in (next_state, y, commands))
    return Loop(a, b, by_y, by_commands)


def response_of(loop: tuple[Floats, Floats, Floats, Floats], step: float) -> Callable[[Floats], Complex]:
    """Function that gives the complex gain (k,) at frequencies (k,) rad/s of a discrete loop (a, b, c, d) with one
    input and one output.

    The triangle of Schur's form is solved by substitution at all frequencies at once.
    """
    triangle, basis = schur(loop[0], output="complex")
    b, c, d = basis.conj().T @ loop[1][:, 0], loop[2][0] @ basis, loop[3][0, 0]

    def response(w: Floats) -> Complex:
        z = np.exp(1j * w * step)
        states = np.empty((len(b), len(w)), dtype=complex)
        for i in reversed(range(len(b))):
            states[i] = (b[i] + triangle[i, i + 1 :] @ states[i + 1 :]) / (z - triangle[i, i] + TINY)
        return np.asarray(c @ states + d)

    return response


def margin_of(name: str, loop: tuple[Floats, Floats, Floats, Floats], step: float) -> Margin:
    """Gain, phase, delay and modulus margins of an open loop (a, b, c, d) with steps, s, under negative feedback."""
    highest, response = math.pi / step, response_of(loop, step)
    poles = np.log(np.linalg.eigvals(loop[0]).astype(complex) + 1e-300) / step
    widths = np.maximum(np.abs(poles.real), 1e-9 * highest)[:, None]
    about_poles = (np.abs(poles.imag)[:, None] + widths * ABOUT).ravel()
    w = np.unique(np.concatenate([np.geomspace(10.0**-DECADES * highest, highest, GRID), about_poles]))
    w = w[(w >= 10.0**-DECADES * highest) & (w <= highest)]
    gains = response(w)

    def crossings(function: Callable[[Complex], Floats]) -> tuple[Floats, Complex]:
        """Frequencies at which a function of the gain changes its sign, by halving, and the gains there."""
        values = function(gains)
        products = values[:-1] * values[1:]
        starts = np.flatnonzero(np.isfinite(products) & (products < 0))
        low, high, is_above = w[starts], w[starts + 1], values[starts] > 0
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            is_crossed = (function(response(middle)) > 0) != is_above
            low, high = np.where(is_crossed, low, middle), np.where(is_crossed, middle, high)
        return high, response(high)

    # Frequencies of gains that are real and negative, and the factors that make them -1.
    frequencies, reals = crossings(np.imag)
    frequencies, reals = np.append(frequencies, highest), np.append(reals, gains[-1])  # real at Nyquist's, too
    factors = [(x, -1 / gain.real) for x, gain in zip(frequencies, reals, strict=True) if gain.real < 0]
    ones = zip(*crossings(lambda gain: np.abs(gain) - 1), strict=True)
    phases = [(x, float(np.angle(-gain))) for x, gain in ones]
    upper = min(((k, x) for x, k in factors if k > 1), default=(math.inf, math.nan))
    lower = max((k for _, k in factors if k < 1), default=0.0)
    phase = min(((abs(angle), x) for x, angle in phases), default=(math.inf, math.nan))
    delay = min(((angle % (2 * math.pi)) / x for x, angle in phases), default=math.inf)
    return Margin(
        drive=name,
        gain=float(upper[0]),
        gain_frequency=float(upper[1] / (2 * math.pi)),
        gain_low=float(lower),
        phase=phase[0],
        phase_frequency=float(phase[1] / (2 * math.pi)),
        delay=float(delay),
        modulus=float(np.abs(1 + gains).min()),
    )


@dataclass(frozen=True, eq=False)
class Loops:
    """A plant with sampled controllers around it, closed and cut at each drive, over their common `period`, s.

    The first inputs and outputs of the plant are those of the controllers. Loops around several plants have one set of
    laws.
    """

    plant: StateSpace
    controllers: Mapping[str, Feedback]
    period: float
    channels: list[Channel]

    @staticmethod
    def from_state(
        state: SteadySystem,
        *,
        inputs: Sequence[str] | None = None,
        outputs: Sequence[str] | None = None,
        strained: Mapping[str, Strained] = MappingProxyType({}),
        name: str = "",
    ) -> Loops:
        """Make the loops of a system about a state, with further `inputs` and `outputs`."""
        controllers = state.system.controllers
        free = default_inputs(state.system, state.drive.motion) if inputs is None else inputs
        wanted = [*default_outputs(state.system), *strained] if outputs is None else outputs
        plant = _plant(state, controllers, inputs=free, outputs=wanted, strained=strained, name=name)
        return Loops(plant, controllers, *channels_of(plant, dict(controllers)))

    def rebuild(self, state: SteadySystem) -> Loops:
        """Return the loops of the same laws about a state of another system, without further inputs and outputs."""
        return replace(self, plant=_plant(state, self.controllers, inputs=[], outputs=[]))

    @property
    def drives(self) -> tuple[str, ...]:
        """Names of the drives."""
        return signal_names(self.controllers, "drive")

    @property
    def often(self) -> dict[str, int]:
        """Drives that are sampled more than once in the period, with how often: a cut loop's gain changes with time."""
        counts = [channel.samples for channel in self.channels for _ in self.drives[channel.driven]]
        return {drive: count for drive, count in zip(self.drives, counts, strict=True) if count > 1}

    @cached_property
    def _propagator(self) -> Propagator:
        return propagator(self.plant, self.period)

    @cached_property
    def closed(self) -> Loop:
        """The closed loop."""
        return loop_of(self.plant, self.channels, self._propagator)

    @cached_property
    def cuts(self) -> dict[str, Loop]:
        """Loops that are cut at each drive that is sampled once in the period, while the others stay closed."""
        once = [name for name in self.drives if name not in self.often]
        return {
            name: loop_of(self.plant, self.channels, self._propagator, cut=self.drives.index(name)) for name in once
        }

    @cached_property
    def growth(self) -> float:
        """Rate, 1/s, at which the closed loop grows, or zero if it does not."""
        size = float(np.abs(np.linalg.eigvals(self.closed.a)).max(initial=0.0))
        return math.log(size) / self.period if size > 1 + ROUNDING else 0.0

    @cached_property
    def margins(self) -> tuple[Margin, ...]:
        """Margins of the loops that are cut; none if the closed loop grows, since it has none to lose."""
        margins = []
        for name, opened in self.cuts.items() if not self.growth else ():
            c, d = (-part[self.drives.index(name)][None] for part in opened.command)
            margins.append(margin_of(name, (opened.a, opened.b[:, :1], c, d[:, :1]), self.period))
        return tuple(margins)

    def state_space(self, cut: str | None) -> StateSpace:
        """State-space model over the period: the closed loop or, with a drive's name as `cut`, the open loop from that
        drive to its commands. It has the margins at every drive that has any.
        """
        plant, drives, channels = self.plant, self.drives, self.channels
        period = f"the common period of {1e3 * self.period:.4g} ms"
        if cut in self.often:
            problem = f"cuts {cut}, sampled {self.often[cut]} times in {period}, whose gain changes with time"
            raise InputError("loop", problem, "ask for 'closed'")
        loop = self.closed if cut is None else self.cuts[cut]
        warnings = plant.warnings
        if self.often:
            warnings += (f"no margins of {', '.join(self.often)}, sampled more than once in {period}",)
        if self.growth:
            warnings += (f"the closed loop is not stable: it grows with {self.growth:.4g} 1/s, and has no margins",)
        of_laws = [
            f"{name}.state_{i + 1}"
            for name, channel in zip(self.controllers, channels, strict=True)
            for i in range(len(channel.law[0]))
        ]
        of_commands = [
            f"{drives[i]}, {j + 1} before"
            for channel in channels
            for i in range(channel.driven.start, channel.driven.stop)
            for j in range(channel.late + 1)
        ]
        begun = [np.ravel(controller.start) for controller in self.controllers.values() if controller.stateful]
        m, k = channels[-1].driven.stop, channels[-1].measured.stop
        if cut is None:
            aims = zip(signal_names(self.controllers, "measure"), plant.outputs, strict=False)
            inputs = plant.inputs[m:] + tuple(Signal(name, signal.unit) for name, signal in aims)
            b, c, d = loop.b, loop.y[0][k:], loop.y[1][k:]
            signals, value = plant.outputs[k:], plant.output[k:]
        else:
            column = drives.index(cut)
            b, c, d = loop.b[:, :1], -loop.command[0][column : column + 1], -loop.command[1][column : column + 1, :1]
            signals = inputs = (Signal(cut, plant.inputs[column].unit),)
            value = np.zeros(1)
        return replace(
            plant,
            a=loop.a,
            b=b,
            c=c,
            d=d,
            states=plant.states + tuple(Signal(name, "") for name in (*of_laws, *of_commands)),
            inputs=inputs,
            outputs=signals,
            state=np.concatenate([plant.state, *begun, np.zeros(len(of_commands))]),
            input=np.zeros(len(inputs)),
            output=value,
            step=self.period,
            margins=self.margins,
            warnings=warnings,
        )


def _plant(
    state: SteadySystem,
    controllers: Mapping[str, Feedback],
    *,
    inputs: Sequence[str],
    outputs: Sequence[str],
    strained: Mapping[str, Strained] = MappingProxyType({}),
    name: str = "",
) -> StateSpace:
    """Linear model of a system about a state. Its first inputs and outputs are those of the controllers."""
    commanded = [drive for controller in controllers.values() for drive in controller.drive]
    measured = [signal for controller in controllers.values() for signal in controller.measure]
    options = {"inputs": [*commanded, *inputs], "outputs": [*measured, *outputs]}
    return linearize_system(state, **options, strained=strained, name=name)


STEPS = 1e-5, 1e-6  # of errors and states, by their size or one, both ways
AGREE = 1e-3  # of the largest slope of an effort or state, between the steps
NEAR = 1e-7  # of errors and states, by their size or one, within which the law is at rest


def linear_law(name: str, controller: Feedback, t: float, measured: Floats, drives: tuple[Signal, ...]) -> Law:
    """Matrices of a controller's law.

    A function is linearised about the error with which its system rests, or about zero error, if there it asks for no
    effort and keeps its state; InputError otherwise.
    """
    if isinstance(controller.law, tuple):
        return controller.law
    where, fix = f"controllers.{name}.law", "give matrices, or a system of python-control"
    try:
        state = np.asarray(controller.start if controller.stateful else [], dtype=float)
    except (TypeError, ValueError):
        state = np.array(np.nan)
    if not np.isfinite(state).all():
        raise InputError(where, "is a function, whose state is no array of finite numbers", fix)
    aims, sign = np.zeros(len(measured)), 1.0
    if controller.reference is not None:
        aims, sign = np.array([float(profile(t)) for profile in controller.reference]), -1.0
    k, m, n, later = len(measured), len(drives), state.size, count(t + controller.sample, controller.sample)

    def stepped(point: Floats) -> Floats:
        """Efforts and next states, one after the other, from errors and states."""
        sample = aims + sign * point[:k], point[k:].reshape(state.shape) if controller.stateful else None
        with naming_controller(name):
            asked, next_state = answer = controller.effort(t, *sample)
            controller.effort(next(later), *sample)  # as time goes on, what a law kept itself shows
            refuse_memory(controller, t, *sample, answer)
        values = np.concatenate([asked, np.asarray(next_state, dtype=float).ravel() if controller.stateful else []])
        if len(values) != m + n:
            raise InputError(where, f"hands on a state of {len(values) - m} numbers, and starts with {n}", fix)
        return values

    asks = list[str]()
    for error in (sign * (measured - aims), np.zeros(k)):
        origin = np.concatenate([error, state.ravel()])
        size, value = np.maximum(1.0, np.abs(origin)), stepped(origin)
        # Slopes (output, input), forward and backward by each step.
        slopes = np.array(
            [
                np.stack([(stepped(origin + h * part) - value) / (h * part.sum()) for part in np.diag(size)], axis=1)
                for step in STEPS
                for h in (step, -step)
            ]
        )
        slope = slopes[-2:].mean(axis=0)
        change = value - np.concatenate([np.zeros(m), state.ravel()])
        if (np.abs(change) <= NEAR * np.abs(slope) @ size).all():
            largest = np.abs(slope).max(axis=1, keepdims=True)
            if not (np.abs(slopes - slope) <= AGREE * largest).all():
                problem = "is a function, which has no transfer function: it does not answer small errors in proportion"
                raise InputError(where, problem, fix)
            return slope[m:, k:], slope[m:, :k], slope[:m, k:], slope[:m, :k]
        asks += [f"{change[i]:.4g} {drive.unit} of {drive.name}" for i, drive in enumerate(drives) if change[i]]
    problem = f"is a function that asks for {asks[0]}" if asks else "is a function whose state changes"
    fix = "let the system rest where the law asks for nothing, by `initial` of joints and `state` of the law"
    raise InputError(where, f"{problem} where the system rests, and is not at rest without an error either", fix)
