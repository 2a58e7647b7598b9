"""A linear state-space model as data, with its way to other tools."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import scipy.io
import scipy.signal

from gbeam.errors import InputError
from gbeam.results.response import Floats


class Signal(NamedTuple):
    """A state, input or output: its name and unit."""

    name: str
    unit: str


@dataclass(frozen=True)
class StateSpace:
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

    def select(self, *, inputs: tuple[str, ...] | None = None, outputs: tuple[str, ...] | None = None) -> StateSpace:
        """The same system with some of its inputs and outputs only, by name.

        Raises
        ------
        InputError
            If there is no such signal.
        """

        def places(wanted: tuple[str, ...] | None, signals: tuple[Signal, ...], what: str) -> list[int]:
            names = [it.name for it in signals]
            for name in wanted or ():
                if name not in names:
                    raise InputError(what, f"has no {name!r}", f"choose from {', '.join(names)}")
            return list(range(len(names))) if wanted is None else [names.index(name) for name in wanted]

        i, o = places(inputs, self.inputs, "inputs"), places(outputs, self.outputs, "outputs")
        return StateSpace(
            a=self.a,
            b=self.b[:, i],
            c=self.c[o],
            d=self.d[np.ix_(o, i)],
            states=self.states,
            inputs=tuple(self.inputs[k] for k in i),
            outputs=tuple(self.outputs[k] for k in o),
            state=self.state,
            input=self.input[i],
            output=self.output[o],
            model=self.model,
            motion=self.motion,
            time=self.time,
        )

    def to_scipy(self) -> Any:
        """As scipy.signal.StateSpace."""
        return scipy.signal.StateSpace(self.a, self.b, self.c, self.d)

    def to_control(self) -> Any:
        """As python-control's StateSpace with named signals.

        Raises
        ------
        InputError
            If python-control is not installed.
        """
        control = import_control()  # takes 3 s: not at the top
        return control.ss(
            self.a,
            self.b,
            self.c,
            self.d,
            states=[it.name for it in self.states],
            inputs=[it.name for it in self.inputs],
            outputs=[it.name for it in self.outputs],
        )

    def to_mat(self, path: str | os.PathLike[str]) -> None:
        """Write a MATLAB file: A, B, C, D, the operating point, names and units."""
        named = {"state": self.states, "input": self.inputs, "output": self.outputs}
        words: dict[str, Any] = {}
        for key, signals in named.items():
            words[f"{key}_name"] = np.array([it.name for it in signals], dtype=object)
            words[f"{key}_unit"] = np.array([it.unit for it in signals], dtype=object)
        points = {"x0": self.state, "u0": self.input, "y0": self.output}
        scipy.io.savemat(
            os.fspath(path),
            {"A": self.a, "B": self.b, "C": self.c, "D": self.d, **points, **words},
            appendmat=False,
            oned_as="column",
        )


def import_control() -> Any:
    """Import python-control, or say how to get it."""
    try:
        import control
    except ImportError:
        fix = 'install it with: pip install "gbeam[control]"'
        raise InputError("", "python-control is not installed", fix) from None
    return control
