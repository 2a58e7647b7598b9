"""A linear state-space model as data, with its way to other tools."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from gbeam.errors import InputError
from gbeam.results.parts.errors import FrequencyErrors
from gbeam.results.result import Floats, Result

ACCURATE = 0.01  # error of a frequency that is within what a design takes for accurate


class Signal(NamedTuple):
    """A state, input or output: its name and unit."""

    name: str
    unit: str


@dataclass(frozen=True)
class Gauge:
    """A strain gauge along the beam.

    Parameters
    ----------
    at : float
        Position from the root, m.
    y, z : float
        Where it sits in the section, m from the axis.
    """

    at: float
    y: float = 0.0
    z: float = 0.0


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
        return replace(
            self,
            b=self.b[:, i],
            c=self.c[o],
            d=self.d[np.ix_(o, i)],
            inputs=tuple(self.inputs[k] for k in i),
            outputs=tuple(self.outputs[k] for k in o),
            input=self.input[i],
            output=self.output[o],
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
        return self._with_warnings(f"StateSpace{of}{f' on {self.motion!r}' if self.motion else ''}", *counts)


def import_control() -> Any:
    """Import python-control, which takes 3 s; an InputError says how to install it where it is not."""
    try:
        import control
    except ImportError:
        fix = 'install it with: pip install "gbeam[control]"'
        raise InputError("", "python-control is not installed", fix) from None
    return control
