"""Sampled controllers of systems, held between samples, and the linear laws, (A, B, C, D), that they may follow."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial, reduce
from inspect import signature
from pathlib import Path
from traceback import extract_tb
from typing import Annotated, Any, Literal

import numpy as np

from gbeam.arrays.namespace import holds_tracer, is_traced, looks_at_traced, namespace
from gbeam.arrays.tree import Value
from gbeam.arrays.types import Floats
from gbeam.errors import ComputationError, InputError, placing_within
from gbeam.guards.arguments import typed
from gbeam.guards.checks import array, refuse_traced
from gbeam.guards.kinds import Kinds, kinds
from gbeam.guards.quantities import Duration, Factor, Quantity, Ratio, Seconds, Time
from gbeam.mechanics.tree.signal_names import kind_of_drive, kind_of_signal
from gbeam.motion.profiles.combine import as_profile
from gbeam.printable import on_one_line, shortened

LAW_FAILED = "law failed"  # an outcome
SI = "in SI units of effort and measurement"
Rows = Sequence[Sequence[Ratio]]
Corner = Annotated[float, Quantity("angular rate", "positive")]  # of a law's gain over frequency
Step = Callable[[float, Floats, Any], tuple[Any, Any]]


def _kinds(key: str, kind: Callable[[str], str], arguments: Mapping[str, Any]) -> Kinds:
    """Kinds of quantity of the signals that the argument `key` names, one each, by a function of a signal's name."""
    names = arguments.get(key)
    return tuple(kind(str(name)) for name in names) if isinstance(names, (list, tuple)) else ""


@kinds(limit=partial(_kinds, "drive", kind_of_drive), reference=partial(_kinds, "measure", kind_of_signal))
@typed
@dataclass(frozen=True, eq=False)
class Feedback(Value):
    """A controller in the loop of a system: it samples measurements, and holds its efforts until the next sample.

    Its law is a function ``law(t, y)`` of time, s, and measurements (k,), which gives the efforts (m,). With a state of
    its own it is ``law(t, y, state)``, which gives efforts and the state at the next sample, a new value. A sample is
    taken more than once, so that a function must keep nothing itself. Else it is a linear law with states of its own:
    (A, B, C, D), a :class:`StateSpace`, or a StateSpace or TransferFunction of python-control. One in continuous time
    (matrices are) is sampled by Tustin's rule, one in discrete time has the step `sample`.

    Accelerations, and forces and moments of sections, are those just before the sample. The attitude is the rotation
    vector from the ground's axes to the point's, with the same components in both. At half a turn it jumps to that of
    the shorter way.

    Raises
    ------
    InputError
        If a value is impossible, or the law does not fit the numbers of measurements and efforts.

    Examples
    --------
    >>> damper = gb.Feedback(lambda t, y: -20.0 * y, ["axis.angle_rate"], ["axis.angle"], sample=0.01, limit=5.0)
    >>> print(damper.effort(0.0, 0.1, None)[0])
    [-2.]
    """

    law: Annotated[Any, "a function, matrices, or a system of python-control, which acts on reference less measurement"]
    measure: Annotated[
        Sequence[str],
        'what is sampled: "joint.angle", "joint.angle_rate", "body.point.place_x", velocity_x, attitude_x (rotation '
        "vector, rad), acceleration_x, spin_x, of a section of a beam force_x, moment_y, by which a strain gauge there "
        "is known",
    ]
    drive: Annotated[
        Sequence[str],
        'efforts: "joint.angle", "force.force_x", "force.moment_z"; they are added to what acts there otherwise',
    ]
    sample: Annotated[Duration, "time between samples, the first at the start"]
    delay: Annotated[Time, "time from a sample until its efforts act"] = 0.0
    limit: Annotated[Any, "largest size of every effort, of all or of each, N or N m: [20]"] = None
    reference: Annotated[
        Any, "aim of every measurement, in SI units, one for all or for each, or profiles; zero unless given: [0.5, 0]"
    ] = None
    state: Annotated[Any, "state at the start of a function that has one; of a linear law zero"] = None
    stateful: bool = field(init=False, repr=False, compare=False, default=True)

    def __post_init__(self) -> None:
        """Refuse what does not fit the signals, and read reference, limit and law as :meth:`effort` takes them."""
        for name in ("measure", "drive"):
            if not getattr(self, name):
                raise InputError(name, "is empty", "name one quantity or more")
            names = tuple(getattr(self, name))
            repeated = [signal for k, signal in enumerate(names) if signal in names[:k]]
            if name == "drive" and repeated:
                raise InputError(name, f"has {repeated[0]!r} twice", "name every drive once")
            object.__setattr__(self, name, names)
        for name in ("sample", "delay"):
            refuse_traced(name, getattr(self, name), "steps end by its number")
        if self.limit is not None:
            limit = array("limit", self.limit)
            if limit.shape not in ((), (len(self.drive),)) or not (is_traced(limit) or (limit > 0).all()):
                raise InputError("limit", f"is {self.limit!r}", f"give one positive size, or {len(self.drive)}")
        references = (
            self.reference if isinstance(self.reference, (list, tuple)) else [self.reference] * len(self.measure)
        )
        if len(references) != len(self.measure):
            raise InputError("reference", f"has {len(references)} values", f"give one, or {len(self.measure)}")
        if self.reference is not None:
            object.__setattr__(self, "reference", tuple(as_profile("reference", value) for value in references))
        if not callable(self.law) or hasattr(self.law, "dt"):
            if self.state is not None:
                raise InputError("state", "is given of a linear law, which starts at zero", "leave it out")
            object.__setattr__(self, "law", self._sampled())
        else:
            parameters = signature(self.law)
            object.__setattr__(self, "stateful", len(parameters.parameters) > 2)
            try:
                parameters.bind(*range(3 if self.stateful else 2))
            except TypeError as error:
                raise InputError("law", f"takes {parameters}", "write law(t, y), or law(t, y, state)") from error

    def _sampled(self) -> tuple[Floats, Floats, Floats, Floats]:
        """Return A, B, C and D of the linear law, in steps of `sample`; InputError unless they fit the signals.

        Continuous laws are sampled by Tustin's rule.
        """
        law: Any = self.law
        step = getattr(law, "dt", 0)
        if hasattr(law, "num"):
            import control

            try:
                law = control.ss(law)
            except ValueError as error:
                fix = "give as many poles as zeros or more: a rate is measured, or smoothed by s/(1 + s T)"
                raise InputError("law", f"cannot be made of states: {error}", fix) from error
        parts = law
        if not isinstance(law, (tuple, list)):
            names = ("A", "B", "C", "D") if hasattr(law, "A") else ("a", "b", "c", "d")
            if not all(hasattr(law, name) for name in names):
                fix = "give a function, (A, B, C, D), or a StateSpace or TransferFunction"
                raise InputError("law", f"is a {type(law).__name__}", fix)
            parts = [getattr(law, name) for name in names]
        if len(parts) != 4:
            raise InputError("law", f"has {len(parts)} parts", "give (A, B, C, D)")
        matrices = [array("law", part) for part in parts]
        xp = namespace(*filter(is_traced, matrices))
        a, b, c, d = (xp.atleast_2d(xp.asarray(matrix)) for matrix in matrices)
        n, m, p = len(a) if a.size else 0, len(self.measure), len(self.drive)
        shapes = {"A": (a, (n, n)), "B": (b, (n, m)), "C": (c, (p, n)), "D": (d, (p, m))}
        for name, (matrix, shape) in shapes.items():
            if matrix.size != math.prod(shape):
                fix = f"give {shape}: {m} measurements, {p} efforts"
                raise InputError("law", f"has a matrix {name} of shape {matrix.shape}", fix)
        a, b, c, d = (matrix.reshape(shape) for matrix, shape in shapes.values())
        if step is None or step is True or (step and not math.isclose(step, self.sample, rel_tol=1e-9)):
            raise InputError("law", f"has the step {step}", f"give one of {self.sample:g} s, or in continuous time")
        if not step and n:
            half = self.sample / 2 * a  # Tustin's rule
            implicit = np.eye(n) - half
            a, b = xp.linalg.solve(implicit, np.eye(n) + half), xp.linalg.solve(implicit, self.sample * b)
            c, d = xp.linalg.solve(implicit.T, c.T).T, d + c @ b / 2
        return a, b, c, d

    @property
    def start(self) -> Any:
        """State at the start."""
        return np.zeros(len(self.law[0])) if isinstance(self.law, tuple) else self.state

    @property
    def traced(self) -> bool:
        """True if JAX traces its law, limit, reference or state."""
        parts = [self.limit, self.reference, self.start]
        if isinstance(self.law, tuple):
            return holds_tracer(*parts, self.law)
        if holds_tracer(*parts):
            return True
        if "jax" not in sys.modules:
            return False
        try:  # what a function refers to shows in what it gives
            with np.errstate(all="ignore"):
                return holds_tracer(self.law(0.0, np.zeros(len(self.measure)), *[self.state] * self.stateful))
        except Exception:  # that it fails is said where it is sampled
            return False

    def effort(self, t: Seconds, measured: Floats, state: Any) -> tuple[Floats, Any]:
        """Return the efforts (m,), before they are limited, and the state at the next sample.

        Parameters
        ----------
        t : float
            Time of the sample, s.
        measured : (k,)
            Measurements.
        state : object
            State at this sample.

        Raises
        ------
        ComputationError
            If a function raises an error, gives other than `drive` names, or an effort that is not finite.
        InputError
            If JAX traces what a function gives at some samples only.
        """
        if self.reference is not None:
            measured = np.array([float(profile(t)) for profile in self.reference]) - measured
        if isinstance(self.law, tuple):
            a, b, c, d = self.law
            return self._finite(t, c @ state + d @ measured), a @ state + b @ measured
        efforts, next_state = answer_of(self, t, np.array(measured), state), state
        if self.stateful:
            if not isinstance(efforts, (tuple, list)) or len(efforts) != 2:
                raise self._failed(f"gives {efforts!r}", t, " and the state at the next sample")
            efforts, next_state = efforts
        if holds_tracer(efforts):
            fix = "write jax.numpy.where in place of if"
            raise InputError("law", f"gives what JAX traces at {t:.6g} s, and nothing of it where all is zero", fix)
        try:
            command = np.asarray(efforts).reshape(-1)
        except ValueError:  # of rows that differ in length
            command = np.empty(0)
        if command.dtype.kind not in "bifu" or command.shape != (len(self.drive),):
            raise self._failed(f"gives {efforts!r}", t)
        return self._finite(t, command.astype(float)), next_state

    def _failed(self, problem: str, t: float, detail: str = "") -> ComputationError:
        """Error of a function that gives something else than finite efforts, and `detail`."""
        count = f"{len(self.drive)} finite effort{'s' * (len(self.drive) > 1)}"
        words = f"{_law_of(self)} {shortened(on_one_line(problem))} at {t:.6g} s: give {count}{detail}"
        return ComputationError(LAW_FAILED, words)

    def _finite(self, t: float, efforts: Floats) -> Floats:
        """Return the efforts; ComputationError unless all are finite."""
        if not all(map(math.isfinite, efforts.tolist())):
            problem = f"{_law_of(self)} gives {efforts} at {t:.6g} s"
            fix = "limit it, or look" if self.limit is None else "look"
            raise ComputationError("diverged", f"{problem}: {fix} for what grows there")
        return efforts

    def limited(self, efforts: Floats) -> Floats:
        """Return efforts within the limit.

        Parameters
        ----------
        efforts : (..., m)
            What the law asks for.
        """
        return efforts if self.limit is None else np.asarray(clip_efforts(np, np.asarray(self.limit), efforts))


def answer_of(controller: Feedback, t: Any, measured: Any, state: Any) -> Any:
    """Answer of a law that is a function, at a time, s; ComputationError if it raises an error."""
    try:
        return controller.law(t, measured, *[state] * controller.stateful)
    except Exception as error:
        if looks_at_traced(error):
            raise
        time_words = "where JAX traces it" if is_traced(t) else f"at {t:.6g} s"
        raise ComputationError(LAW_FAILED, f"{_law_of(controller)} raises {_in_words(error)}, {time_words}") from error


def refuse_memory(controller: Feedback, t: float, measured: Floats, state: Any, answer: tuple[Floats, Any]) -> None:
    """Raise InputError if a function answers otherwise when called again: it keeps something between calls."""
    if not callable(controller.law):
        return
    repeated = controller.effort(t, measured, state)
    if _are_equal(repeated, answer):
        return
    texts = [str(efforts) for efforts, _ in (answer, repeated)]
    if texts[0] == texts[1]:  # they differ in later digits, or in the state
        texts = [f"{efforts.tolist()} and {next_state!r}" for efforts, next_state in (answer, repeated)]
    before, now = (shortened(on_one_line(text)) for text in texts)
    problem = f"answers {before}, and called again {now}, to the same measurements at {t:.6g} s"
    fix = "keep nothing between calls: a sample is taken more than once. "
    if controller.stateful:
        fix += "Return the state at the next sample as a new value, and change nothing in place"
    else:
        fix += "Write law(t, y, state), which returns the efforts and the state at the next sample, and give state"
    raise InputError("law", problem, fix)


def _law_of(controller: Feedback) -> str:
    """Name a law by what it drives."""
    return f"the law of {', '.join(controller.drive)}"


def _in_words(error: Exception) -> str:
    """Type and message of an error that a user's function raised, and the last line of its file that led there."""
    frames = extract_tb(error.__traceback__)[1:]  # after the line here that called it
    lines = [frame for frame in frames if frame.filename == frames[0].filename]
    line = lines[-1].line if lines else ""
    place = ""
    if lines:
        source = f": {line}" if line else ""
        place = f" ({Path(lines[-1].filename).name}, line {lines[-1].lineno}{source})"
    message = shortened(on_one_line(str(error)))
    return f"{type(error).__name__}{f': {message}' if message else ''}{shortened(on_one_line(place))}"


def _are_equal(one: Any, other: Any) -> bool:
    """True if two values are equal to the last digit, of numbers, sequences and mappings. Others are not compared."""
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        return one.keys() == other.keys() and all(_are_equal(one[key], other[key]) for key in one)
    if isinstance(one, (list, tuple)) and isinstance(other, (list, tuple)):
        return len(one) == len(other) and all(map(_are_equal, one, other))
    values = np.asarray(one), np.asarray(other)
    numbers = all(value.dtype.kind in "biufc" for value in values)
    return not numbers or np.array_equal(*values, equal_nan=True)


def clip_efforts(xp: Any, limit: Any, efforts: Any) -> Any:
    """Return efforts (..., m) cut at a limit; one of exactly that size keeps its derivative under JAX."""
    return xp.where(abs(efforts) <= limit, efforts, xp.copysign(limit, efforts))


@contextmanager
def naming_controller(name: str) -> Iterator[None]:
    """Put the name of a controller before errors of its law that are raised inside."""
    try:
        with placing_within(f"controllers.{name}"):
            yield
    except ComputationError as error:
        raise ComputationError(error.outcome, f"controllers.{name}: {error}") from error.__cause__


def signal_names(controllers: Mapping[str, Feedback], kind: Literal["drive", "measure"]) -> tuple[str, ...]:
    """Names of all that controllers drive or measure, as ``controller: signal``."""
    signals = [(name, getattr(controller, kind)) for name, controller in controllers.items()]
    return tuple(f"{name}: {signal}" for name, names in signals for signal in names)


Law = tuple[Floats, Floats, Floats, Floats]


def gains(
    gains: Annotated[Rows, f"a row for every effort, a gain for every measurement, {SI}"],
) -> Law:
    """State feedback: every effort is a sum of gains times errors, without states."""
    k = np.asarray(gains, dtype=float)
    return np.zeros((0, 0)), np.zeros((0, k.shape[1])), np.zeros((k.shape[0], 0)), k


def pid(
    kp: Annotated[Ratio, f"proportional gain, {SI}"] = 0.0,
    ki: Annotated[Ratio, f"integral gain, {SI} s"] = 0.0,
    kd: Annotated[Ratio, f"derivative gain, {SI}/s"] = 0.0,
    smoothing: Annotated[Duration | None, "time constant of the filter of the derivative: needed with kd"] = None,
) -> Law:
    """Proportional, integral and derivative gain of one error, kp + ki/s + kd s/(1 + s T), T the `smoothing`.

    It has one state for the integral and one for the derivative.

    Raises
    ------
    InputError
        If a derivative has no filter.
    """
    if kd and smoothing is None:
        raise InputError("", "smoothing is missing", 'a derivative needs a filter: smoothing = "50 ms"')
    parts = [gains([[kp]])]
    if ki:
        parts.append((np.zeros((1, 1)), np.ones((1, 1)), np.full((1, 1), ki), np.zeros((1, 1))))
    if smoothing is not None and kd:
        rate = 1 / smoothing
        parts.append(
            (np.full((1, 1), -rate), np.full((1, 1), rate), np.full((1, 1), -kd * rate), np.full((1, 1), kd * rate))
        )
    return reduce(_add_laws, parts)


def lead_lag(
    gain: Annotated[Ratio, f"gain at rest, {SI}"],
    zero: Annotated[Corner, "zero, such as 1 Hz"],
    pole: Annotated[Corner, "pole: above the zero a lead, below it a lag"],
) -> Law:
    """Lead or lag: gain (1 + s/zero)/(1 + s/pole) of one error."""
    feedthrough = gain * pole / zero
    return (
        np.full((1, 1), -pole),
        np.full((1, 1), pole),
        np.full((1, 1), gain - feedthrough),
        np.full((1, 1), feedthrough),
    )


def notch(
    frequency: Annotated[Corner, "of the notch, such as 4.2 Hz"],
    depth: Annotated[Ratio, "gain at the frequency, such as 0.1"],
    damping: Annotated[Factor, "half the width over the frequency"],
) -> Law:
    """A notch at a vibration: a gain of one but near its frequency, (s² + 2 d ζ ω s + ω²)/(s² + 2 ζ ω s + ω²)."""
    w, width = frequency, 2 * damping * frequency  # rad/s
    a = np.array([[0.0, 1.0], [-(w**2), -width]])
    return a, np.array([[0.0], [1.0]]), np.array([[0.0, (depth - 1) * width]]), np.ones((1, 1))


def in_series(laws: Sequence[Law]) -> Law:
    """Law of laws in series, the first of which takes the measurements."""
    return reduce(_chain_laws, laws)


def _add_laws(one: Law, other: Law) -> Law:
    """Return the law whose efforts are the sum of those of two laws, each x₊ = A x + B y with the effort C x + D y."""
    (a, b, c, d), (e, f, g, h) = one, other
    zero = np.zeros((len(a), len(e)))
    return np.block([[a, zero], [zero.T, e]]), np.concatenate([b, f]), np.concatenate([c, g], axis=1), d + h


def _chain_laws(inner: Law, outer: Law) -> Law:
    """Return the law of two in series: `outer` takes the efforts of `inner`."""
    (a, b, c, d), (e, f, g, h) = inner, outer
    zero = np.zeros((len(a), len(e)))
    return np.block([[a, zero], [f @ c, e]]), np.concatenate([b, f @ d]), np.concatenate([h @ c, g], axis=1), h @ d
