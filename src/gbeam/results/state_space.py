"""A linear state-space model as data, with its way to other tools."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.results.errors import FrequencyErrors
from gbeam.results.result import Floats, Part, Result

ACCURATE = 0.01  # error of a frequency that is within what a design takes for accurate


class Signal(NamedTuple):
    """A state, input or output: its name and unit."""

    name: str
    unit: str


@typed
@dataclass(frozen=True)
class Gauge:
    """A strain gauge along the beam; it measures the normal strain of what its section carries.

    Parameters
    ----------
    at : float
        Position from the root, m.
    y, z : float
        Where it sits in the section, m from the axis.

    Examples
    --------
    >>> gb.Gauge(at=0.01, z=0.002)
    Gauge(at=0.01, y=0.0, z=0.002)
    """

    at: float
    y: float = 0.0
    z: float = 0.0


@dataclass(frozen=True, repr=False, eq=False)
class Truncation(Part):
    """What a smaller model leaves out of the one that it is made from.

    Gains are those from an input to an output, (p, m) in the unit of the output by that of the input.

    Parameters
    ----------
    method : str
        ``modal`` or ``balanced``.
    states : int
        How many are left out.
    hankel : (k,)
        Hankel singular values of what decays, of a balanced truncation; they tell how much each state matters.
    start, end : float
        Frequencies between which gains are compared, Hz: from half the lowest that oscillates to the highest that is
        kept; of a balanced truncation to twice the highest there is.
    error : (p, m)
        Largest gain of the difference up to `end`.
    gain : (p, m)
        Largest gain of the larger model from `start` to `end`, among the inputs and outputs of the same units.
    """

    method: str
    states: int
    hankel: Floats
    start: float
    end: float
    error: Floats
    gain: Floats

    @property
    def bound(self) -> float:
        """Twice the sum of the Hankel singular values left out, which the difference's largest singular value never
        exceeds at any frequency (Glover 1984); NaN of a modal truncation."""
        return float(2 * self.hankel[len(self.hankel) - self.states :].sum()) if self.method == "balanced" else math.nan

    @property
    def share(self) -> Floats:
        """The error over the gain, (p, m); zero where there is no gain at all."""
        return np.divide(self.error, self.gain, out=np.zeros_like(self.error), where=self.gain > 0)


@dataclass(frozen=True, repr=False, eq=False)
class StateSpace(Result):
    """ẋ = Ax + Bu, y = Cx + Du; all are departures from the operating point.

    Parameters
    ----------
    a, b, c, d : (n, n), (n, m), (p, n), (p, m)
    states, inputs, outputs : tuples of Signal
    state, input, output : (n,), (m,), (p,)
        Values at the operating point.
    model, motion : str
    time : float
        s.
    frequency : (k,) Hz
        |λ|/2π of the poles that oscillate, ascending; none of a balanced truncation, whose poles are no beam's.
    errors : FrequencyErrors or None
        Of these frequencies; None where there is no estimate.
    truncation : Truncation or None
        What a smaller model leaves out.

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

    a: Floats
    b: Floats
    c: Floats
    d: Floats
    states: tuple[Signal, ...]
    inputs: tuple[Signal, ...]
    outputs: tuple[Signal, ...]
    state: Floats
    input: Floats
    output: Floats
    model: str = ""
    motion: str = ""
    time: float = float("nan")
    frequency: Floats = field(default_factory=lambda: np.zeros(0))
    errors: FrequencyErrors | None = None
    truncation: Truncation | None = None

    @property
    def accurate_to(self) -> float:
        """Frequency up to which every pole's is within one in a hundred of the exact model's, Hz; NaN if not known.

        Zero where the first is not.
        """
        if self.errors is None or not len(self.frequency):
            return math.nan
        count = self.errors.within(ACCURATE)
        return float(self.frequency[count - 1]) if count else 0.0

    def select(self, *, inputs: tuple[str, ...] | None = None, outputs: tuple[str, ...] | None = None) -> StateSpace:
        """The same system with some of its inputs and outputs only, by name.

        Parameters
        ----------
        inputs, outputs : tuple of str, optional
            Those that are kept, in this order; all where left out.

        Raises
        ------
        InputError
            If there is no such signal.
        """

        def places(chosen: tuple[str, ...] | None, signals: tuple[Signal, ...], what: str) -> list[int]:
            names = [each.name for each in signals]
            for name in chosen or ():
                if name not in names:
                    raise InputError(what, f"has no {name!r}", f"choose from {', '.join(names)}")
            return list(range(len(names))) if chosen is None else [names.index(name) for name in chosen]

        i, o = places(inputs, self.inputs, "inputs"), places(outputs, self.outputs, "outputs")
        left_out = self.truncation
        if left_out is not None:
            left_out = replace(left_out, error=left_out.error[np.ix_(o, i)], gain=left_out.gain[np.ix_(o, i)])
        return replace(
            self,
            b=self.b[:, i],
            c=self.c[o],
            d=self.d[np.ix_(o, i)],
            inputs=tuple(self.inputs[k] for k in i),
            outputs=tuple(self.outputs[k] for k in o),
            input=self.input[i],
            output=self.output[o],
            truncation=left_out,
        )

    def to_scipy(self) -> Any:
        """As scipy.signal.StateSpace."""
        import scipy.signal  # half a second to import

        return scipy.signal.StateSpace(self.a, self.b, self.c, self.d)

    def to_control(self) -> Any:
        """As python-control's StateSpace with named signals.

        Raises
        ------
        InputError
            If python-control is not installed.
        """
        control = import_control()
        return control.ss(
            self.a,
            self.b,
            self.c,
            self.d,
            states=[each.name for each in self.states],
            inputs=[each.name for each in self.inputs],
            outputs=[each.name for each in self.outputs],
        )

    def to_mat(self, path: str | os.PathLike[str]) -> None:
        """Write a MATLAB file: A, B, C, D, the operating point, names and units, frequencies and their errors.

        Parameters
        ----------
        path : path
            Replaced if it exists.
        """
        import scipy.io

        named = {"state": self.states, "input": self.inputs, "output": self.outputs}
        words: dict[str, Any] = {}
        for key, signals in named.items():
            words[f"{key}_name"] = np.array([each.name for each in signals], dtype=object)
            words[f"{key}_unit"] = np.array([each.unit for each in signals], dtype=object)
        if self.provenance is not None:
            stated, environment = self.provenance.stated()
            words["provenance"] = f"gbeam {environment.gbeam}: {stated.command}; scenario SHA-256 {stated.sha256}"
        points = {"x0": self.state, "u0": self.input, "y0": self.output}
        if self.errors is not None:
            points |= {"frequency_Hz": self.frequency, "frequency_error": self.errors.total}
        if self.truncation is not None:
            points |= {"truncation_error": self.truncation.error, "truncation_bound": np.array(self.truncation.bound)}
        scipy.io.savemat(
            os.fspath(path),
            {"A": self.a, "B": self.b, "C": self.c, "D": self.d, **points, **words},
            appendmat=False,
            oned_as="column",
        )

    def __repr__(self) -> str:
        of = f" of {self.model}" if self.model else ""
        counts = [
            f"{len(signals)} {what} ({', '.join(each.name for each in signals[:4])}{', …' if len(signals) > 4 else ''})"
            for what, signals in (("states", self.states), ("inputs", self.inputs), ("outputs", self.outputs))
        ]
        if not math.isnan(self.accurate_to):
            counts.append(
                f"frequencies within {100 * ACCURATE:g} % of the exact model's up to {self.accurate_to:.4g} Hz"
            )
        if self.truncation is not None:
            share = float(self.truncation.share.max(initial=0.0))
            counts.append(
                f"{self.truncation.method} truncation: {self.truncation.states} states left out, at most "
                f"{100 * share:.2g} % of the largest gain up to {self.truncation.end:.4g} Hz"
            )
        return self._with_warnings(f"StateSpace{of}{f' on {self.motion!r}' if self.motion else ''}", *counts)


def import_control() -> Any:
    """Import python-control, which takes 3 s; an InputError says how to install it where it is not."""
    try:
        import control
    except ImportError:
        fix = 'install it with: pip install "gbeam[control]"'
        raise InputError("", "python-control is not installed", fix) from None
    return control
