"""A linear state-space model as data, with its way to other tools."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any, ClassVar, Literal

import numpy as np

from gbeam.arrays.tree import Value
from gbeam.arrays.types import Indices, Numbers
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import vector
from gbeam.guards.quantities import OfKind, Quantity
from gbeam.results.declared import INSIDE, declared, fact, internal, labels, part, quantity, rows
from gbeam.results.errors import FRAME, Accelerated, FrequencyErrors, Noted, accelerated, acceleration_lines
from gbeam.results.result import Complex, Figured, Floats, Part

MARGINS = ("gain", "gain_low", "phase", "delay", "modulus")
_RICHER = "by the same laws around exact models with more shapes, thick beams and coarser meshes; NaN if not known"
_ERROR = "estimated error, a fraction of it"
ACCURATE = 0.01  # error of a frequency that is within what a design takes for accurate


@dataclass(frozen=True, repr=False, eq=False)
class Signal(Part):
    """A state, input or output."""

    name: str = labels("name of the signal", key="")
    unit: str = quantity("", "unit of the signal")


@typed
@dataclass(frozen=True, eq=False)
class Gauge(Value):
    """A strain gauge on a beam or a solid, alone or in a system.

    Along a beam it measures the normal strain of what its section carries, on a solid that of a direction.

    Parameters
    ----------
    at : float or str
        Position from the root of a beam, m; of a solid the name of a point.
    y, z : float
        Where it sits in the section of a beam, m from the axis.
    along : (3,)
        Direction of its grid on a solid, in axes of the point.
    body : str
        Of a system the name of the body that it is on.

    Raises
    ------
    InputError
        If the direction is none.

    Examples
    --------
    >>> gb.Gauge(at=0.01, z=0.002)
    Gauge(at=0.01, z=0.002)
    """

    at: Annotated[float | str, OfKind("length")]
    y: Annotated[float, Quantity("length")] = 0.0
    z: Annotated[float, Quantity("length")] = 0.0
    along: Numbers = (1.0, 0.0, 0.0)
    body: str = ""

    def __post_init__(self) -> None:
        if not np.any(vector("along", self.along)):
            raise InputError("along", "is zero", "give a direction, such as (1, 0, 0)")


@dataclass(frozen=True, repr=False, eq=False)
class Truncation(Part):
    """Part of a model that a smaller one leaves out.

    Gains are those from an input to an output, (p, m) in the unit of the output by that of the input. They are compared
    from half the lowest frequency that oscillates to the highest that is kept; of a balanced truncation to twice the
    highest there is.
    """

    method: str = fact("modal or balanced", name=INSIDE)
    states: int = fact("number of states that are left out", name="/states_left_out", key="states_left_out")
    hankel: Floats = internal(
        "mixed", "Hankel singular values of what decays", "hankel", note="of a balanced truncation"
    )
    start: float = fact("lowest frequency at which gains are compared", "Hz", name=None, key="from")
    end: float = fact("highest frequency at which gains are compared", "Hz", name="to", key="to")
    error: Floats = quantity("mixed", "largest gain of what is left out", "output input", note="up to `end`")
    gain: Floats = quantity(
        "mixed",
        "largest gain of the larger model",
        "output input",
        note="from `start` to `end`, among the inputs and outputs of the same units",
    )

    @declared("mixed", "bound of the error", role="fact")
    def bound(self) -> float:
        """Twice the sum of the Hankel singular values left out, which the difference's largest singular value never
        exceeds at any frequency (Glover 1984), or NaN of a modal truncation."""
        return float(2 * self.hankel[len(self.hankel) - self.states :].sum()) if self.method == "balanced" else math.nan

    @declared("", "the error over the gain", "output input", name=None)
    def share(self) -> Floats:
        """The error over the gain, (p, m), or zero where there is no gain at all."""
        return np.divide(self.error, self.gain, out=np.zeros_like(self.error), where=self.gain > 0)


@dataclass(frozen=True, repr=False, eq=False)
class Margin(Part):
    """Stability margins of a loop that is cut at one drive, the others closed,
    or NaN where an error exceeds one half.
    """

    drive: str = labels("name of the controller and its drive", key="")
    gain: float = quantity(
        "", "least factor above one by which the loop's gain may grow", note="inf where it may by any"
    )
    gain_frequency: float = quantity("Hz", "frequency at which the loop would oscillate then")
    gain_low: float = quantity("", "largest factor below one to which it may fall", note="0 where it may to any")
    phase: float = quantity("rad", "least change of phase, either way, at a gain of one")
    phase_frequency: float = quantity("Hz", "frequency of that gain")
    delay: float = quantity("s", "time by which the loop may be later")
    modulus: float = quantity("", "least distance of the loop's gain from -1")
    unknown: str = quantity("", "margins that are not known", note="by name; their errors exceed one half", default="")
    gain_error: float = quantity("", _ERROR, note=_RICHER, default=math.nan)
    gain_low_error: float = quantity("", _ERROR, default=math.nan)
    phase_error: float = quantity("", _ERROR, default=math.nan)
    delay_error: float = quantity("", _ERROR, default=math.nan)
    modulus_error: float = quantity("", _ERROR, default=math.nan)


@dataclass(frozen=True, repr=False, eq=False)
class StateSpace(Noted, Figured[Literal["poles"]]):
    """ẋ = Ax + Bu, y = Cx + Du; with a `step` x⁺ = Ax + Bu. All are departures from the operating point.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    >>> structure = gb.assemble(beam, "FOAM", axial=1, y=2, z=2)
    >>> gauge = gb.Gauge(0.01, z=0.002)
    >>> plant = gb.linearize(structure, gb.Flight(z=0.0), gauges=[gauge])
    >>> plant.a.shape, plant.inputs[2].name
    ((10, 10), 'base_acceleration_z')
    """

    json_rows: ClassVar[dict[str, str]] = {kind: f"{kind}s" for kind in ("state", "input", "output", "pole")}

    a: Floats = quantity("mixed", "rates of the states from the states", "state state_of", name="A", key="/A")
    b: Floats = quantity("mixed", "rates of the states from the inputs", "state input", name="B", key="/B")
    c: Floats = quantity("mixed", "outputs from the states", "output state", name="C", key="/C")
    d: Floats = quantity("mixed", "outputs from the inputs", "output input", name="D", key="/D")
    states: tuple[Signal, ...] = rows("states", "state", name="state_")
    inputs: tuple[Signal, ...] = rows("inputs", "input", name="input_")
    outputs: tuple[Signal, ...] = rows("outputs", "output", name="output_")
    state: Floats = quantity("mixed", "state at the operating point", "state", name="state_value", key="value")
    input: Floats = quantity("mixed", "input at the operating point", "input", name="input_value", key="value")
    output: Floats = quantity("mixed", "output at the operating point", "output", name="output_value", key="value")
    model: str = fact("kind of the model", default="")
    motion: str = fact("name of the motion", default="")
    time: float = fact("time of the operating point", "s", default=float("nan"))
    frequency: Floats = quantity(
        "Hz",
        "frequency of a pole that oscillates",
        "pole",
        name="pole_frequency",
        note="|λ|/2π, ascending; none of a balanced truncation, whose poles are no beam's",
        default_factory=lambda: np.zeros(0),
    )
    errors: FrequencyErrors | None = part(
        "errors of these frequencies", "pole", name=None, note="None where there is no estimate", default=None
    )
    frame: str = fact(FRAME, default="ground")
    step: float = fact(
        "time between samples", "s", note="of several their common period; 0 in continuous time", default=0.0
    )
    margins: tuple[Margin, ...] = rows(
        "margins of the loop at every drive of a controller", "drive", name="margin_", optional=True, default=()
    )
    decay_error: Floats = quantity(
        "", "estimated error of the eigenvalue's real part, a fraction of it", "eigenvalue", key="/decay_error",
        optional=True, note="of a loop", default_factory=lambda: np.zeros(0),
    )  # fmt: skip
    oscillation_error: Floats = quantity(
        "", "estimated error of the eigenvalue's imaginary part, a fraction of it", "eigenvalue",
        key="/oscillation_error", optional=True, note="of a loop", default_factory=lambda: np.zeros(0),
    )  # fmt: skip
    accelerated: tuple[Accelerated, ...] = accelerated()
    truncation: Truncation | None = part("what a smaller model leaves out", name="truncation_", default=None)

    @declared("", "names of the states", "state_of", role="labels", key=None)
    def state_of(self) -> tuple[str, ...]:
        return tuple(signal.name for signal in self.states)

    @declared("", "estimated error of the frequency, a fraction", "pole", key=None, optional=True)
    def pole_error(self) -> Floats:
        """Total errors of the poles' frequencies, (k,), or empty where there is no estimate."""
        return np.zeros(0) if self.errors is None else self.errors.total

    @declared("1/s", "eigenvalue of A; of samples ln z over their step", "eigenvalue", key="/eigenvalue")
    def eigenvalue(self) -> Complex:
        """Eigenvalues s of A, (n,) 1/s, the slowest to decay first; of a sampled model ln z/T of its z."""
        poles: Any = np.asarray(np.linalg.eigvals(self.a), dtype=complex)
        poles = np.log(poles + 1e-300) / self.step if self.step else poles
        return poles[slowest_first(poles)]

    @declared("mixed", "of what decays", "hankel", name="hankel_singular_value", key="hankel_singular_values")
    def hankel(self) -> Floats:
        """Hankel singular values of a balanced truncation, (k,); else empty."""
        return np.zeros(0) if self.truncation is None else self.truncation.hankel

    @declared("Hz", "frequency up to which every pole is accurate", role="fact", name=None)
    def accurate_to(self) -> float:
        """Frequency up to which every pole's is within one in a hundred of the exact model's, Hz, or NaN if not known.

        Zero where the first is not.
        """
        if self.errors is None or not np.isfinite(self.errors.total).any():
            return math.nan
        count = self.errors.count_within(ACCURATE)
        return float(self.frequency[count - 1]) if count else 0.0

    def select(self, *, inputs: Sequence[str] | None = None, outputs: Sequence[str] | None = None) -> StateSpace:
        """Return the system with some of its inputs and outputs only, by name.

        Parameters
        ----------
        inputs, outputs : tuple of str, optional
            Those that are kept, in this order; all where left out.

        Raises
        ------
        InputError
            If there is no such signal.
        """
        ins, outs = _indices("inputs", inputs, self.inputs), _indices("outputs", outputs, self.outputs)
        gains = np.ix_(outs, ins)
        truncation = self.truncation
        if truncation is not None:
            truncation = replace(truncation, error=truncation.error[gains], gain=truncation.gain[gains])
        return replace(
            self,
            b=self.b[:, ins],
            c=self.c[outs],
            d=self.d[gains],
            inputs=tuple(self.inputs[k] for k in ins),
            outputs=tuple(self.outputs[k] for k in outs),
            input=self.input[ins],
            output=self.output[outs],
            truncation=truncation,
        )

    def to_scipy(self) -> Any:
        """As scipy.signal.StateSpace."""
        import scipy.signal  # half a second to import

        step = {"dt": self.step} if self.step else {}
        return scipy.signal.StateSpace(self.a, self.b, self.c, self.d, **step)

    def to_control(self) -> Any:
        """As python-control's StateSpace with named signals.

        Raises
        ------
        InputError
            If python-control is not installed.
        """
        control = import_control()
        # It takes no dots, as those of a system's signals.
        names = {}
        for kind, signals in (("states", self.states), ("inputs", self.inputs), ("outputs", self.outputs)):
            names[kind] = [re.sub(r"\W+", "_", signal.name) for signal in signals]
        return control.ss(self.a, self.b, self.c, self.d, self.step, **names)

    @typed
    def to_mat(self, path: str | os.PathLike[str]) -> None:
        """Write a MATLAB file: A, B, C, D, the operating point, names and units, frequencies and their errors.

        Parameters
        ----------
        path : path
            Replaced if it exists.
        """
        import scipy.io

        groups = {"state": self.states, "input": self.inputs, "output": self.outputs}
        texts: dict[str, Any] = {}
        for key, signals in groups.items():
            texts[f"{key}_name"] = np.array([signal.name for signal in signals], dtype=object)
            texts[f"{key}_unit"] = np.array([signal.unit for signal in signals], dtype=object)
        if self.provenance is not None:
            stated, environment = self.provenance.stated()
            texts["provenance"] = f"gbeam {environment.gbeam}: {stated.command}; scenario SHA-256 {stated.sha256}"
        numbers = {"x0": self.state, "u0": self.input, "y0": self.output}
        if self.errors is not None:
            numbers |= {"frequency_Hz": self.frequency, "frequency_error": self.errors.total}
        if self.step:
            numbers |= {"Ts": np.array(self.step)}
        if self.truncation is not None:
            numbers |= {"truncation_error": self.truncation.error, "truncation_bound": np.array(self.truncation.bound)}
        scipy.io.savemat(
            os.fspath(path),
            {"A": self.a, "B": self.b, "C": self.c, "D": self.d, **numbers, **texts},
            appendmat=False,
            oned_as="column",
        )

    def __repr__(self) -> str:
        model = f" of {self.model}" if self.model else ""
        motion = f" on {self.motion!r}" if self.motion else ""
        lines = acceleration_lines(self.accelerated)
        for kind, signals in (("states", self.states), ("inputs", self.inputs), ("outputs", self.outputs)):
            names = ", ".join(signal.name for signal in signals[:4])
            lines.append(f"{len(signals)} {kind} ({names}{', …' if len(signals) > 4 else ''})")
        if not math.isnan(self.accurate_to):
            lines.append(
                f"frequencies within {100 * ACCURATE:g} % of the exact model's up to {self.accurate_to:.4g} Hz"
            )
        for margin in self.margins:
            gain = "not known" if "gain" in margin.unknown else f"{margin.gain:.3g}"
            phase = "not known" if "phase" in margin.unknown else f"{math.degrees(margin.phase):.3g} deg"
            lines.append(f"{margin.drive}: gain margin {gain}, phase margin {phase}")
        if self.truncation is not None:
            share = float(self.truncation.share.max(initial=0.0))
            lines.append(
                f"{self.truncation.method} truncation: {self.truncation.states} states left out, at most "
                f"{100 * share:.2g} % of the largest gain up to {self.truncation.end:.4g} Hz"
            )
        return self._with_warnings(f"StateSpace{model}{motion}", *lines)


def _indices(argument: str, names: Sequence[str] | None, signals: Sequence[Signal]) -> list[int]:
    """Indices of named signals, of all without names; InputError, at an argument, for an unknown name."""
    if names is None:
        return list(range(len(signals)))
    choices = [signal.name for signal in signals]
    for name in names:
        if name not in choices:
            raise InputError(argument, f"has no {name!r}", f"choose from {', '.join(choices)}")
    return [choices.index(name) for name in names]


def slowest_first(poles: Complex) -> Indices:
    """Indices (n,) of eigenvalues 1/s in the order of their decay, the slowest first."""
    return np.lexsort((poles.imag, np.abs(poles.imag), -poles.real))


def import_control() -> Any:
    """Import python-control, which takes 3 s; an InputError says how to install it where it is not."""
    try:
        import control
    except ImportError:
        fix = 'install it with: pip install "gbeam[control]"'
        raise InputError("", "python-control is not installed", fix) from None
    return control
