"""What a sweep found: figures of many cases, along the parameters that were varied."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gbeam.results.imitation.criteria import EXCEEDED, NOT_ACCEPTED
from gbeam.results.result import Figured, Flags, Floats, Part
from gbeam.results.studies.uncertainty import Indices, Statistics

SAMPLE = "sample"  # the dimension of what is drawn from distributions
# Outcomes of cases that are computed to the end, with every figure, and do not keep limits.
ANSWERED = (NOT_ACCEPTED, EXCEEDED, "limits exceeded")


@dataclass(frozen=True, repr=False, eq=False)
class Parameter(Part):
    """One value of the scenario that varies.

    Parameters
    ----------
    path : str
        Its key, such as ``motion.centrifuge.arm``.
    values : (n,)
        Numbers in `unit`, or words.
    unit : str
        As written, such as ``g/s``; the SI unit where none was; empty for words and plain numbers.
    drawn : str
        The distribution that the values are drawn from; empty for a grid.
    """

    path: str
    values: NDArray[Any]
    unit: str = ""
    drawn: str = ""

    @property
    def numeric(self) -> bool:
        """Whether the values are numbers."""
        return bool(np.issubdtype(self.values.dtype, np.number))

    @property
    def dimension(self) -> str:
        """Dimension of the result along which it varies."""
        return SAMPLE if self.drawn else self.path


@dataclass(frozen=True, repr=False, eq=False)
class Sweep(Figured):
    """Figures of many cases of one scenario.

    Parameters
    ----------
    title : str
        Of the scenario.
    verb : str
        Whose figures they are: run, static, modes, critical-speed, plan, place.
    parameters : tuple of Parameter
        Those of a grid span one dimension each, in order; all that are drawn share the last, ``sample``.
    measures : mapping of str to (...) array
        By the measure's name; NaN where the case has none.
    units : mapping of str to str
        Of the measures; empty where there is none.
    outcome : (...) array of str
        Of each case: that of its verb (done, diverged, not converged), ``not accepted`` where limits of acceptance are
        not kept, ``machine limits exceeded`` or, of plan and place, ``limits exceeded``, ``refused`` where the scenario
        does not allow its values, ``failed`` where the computation broke down, ``pending`` where it has not been
        computed.
    message : (...) array of str
        Why a case is not done, or which limits it does not keep.
    histories : mapping of str to (..., t) array
        At the times `time`, which all cases share; NaN where the case has no value. Units are in `units`.
    time : (t,)
        s.
    statistics : mapping of str to Statistics
        Of measures and, at every time, of histories, where something is drawn: at every point of the grid.
    indices : mapping of str to Indices
        Sobol indices of the measures, of what the sampler saltelli draws.
    """

    title: str
    verb: str
    parameters: tuple[Parameter, ...]
    measures: Mapping[str, Floats]
    units: Mapping[str, str]
    outcome: NDArray[Any]
    message: NDArray[Any]
    histories: Mapping[str, Floats] = field(default_factory=dict)
    time: Floats = field(default_factory=lambda: np.empty(0))
    statistics: Mapping[str, Statistics] = field(default_factory=dict)
    indices: Mapping[str, Indices] = field(default_factory=dict)

    @property
    def dimensions(self) -> tuple[str, ...]:
        """Names of the dimensions of every array."""
        return tuple(dict.fromkeys(parameter.dimension for parameter in self.parameters))

    @property
    def counts(self) -> dict[str, int]:
        """How many cases ended how; ``done`` first."""
        names, numbers = np.unique(self.outcome.astype(str), return_counts=True)
        found = dict(zip(names.tolist(), numbers.tolist(), strict=True))
        return dict(sorted(found.items(), key=lambda each: (each[0] != "done", each[0])))

    @property
    def computed(self) -> Flags:
        """Which cases are computed to the end, whether or not they keep limits, (...)."""
        return np.isin(self.outcome.astype(str), ("done", *ANSWERED))

    @property
    def lost(self) -> int:
        """How many cases are not computed to the end."""
        return int((~self.computed).sum())

    @property
    def state(self) -> str:
        """How the sweep ended: done, some cases failed, or some cases not accepted."""
        if self.lost:
            return "some cases failed"
        return "done" if set(self.counts) <= {"done"} else "some cases not accepted"

    def __repr__(self) -> str:
        shape = " × ".join(f"{size} {name}" for name, size in zip(self.dimensions, self.outcome.shape, strict=True))
        ended = ", ".join(f"{number} {name}" for name, number in self.counts.items())
        words = f"Sweep of {self.verb} over {shape}: {ended}; {', '.join([*self.measures, *self.histories])}"
        return self._with_warnings(words)
