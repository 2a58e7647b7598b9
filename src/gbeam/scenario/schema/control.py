"""[controllers.NAME]: controllers in the loop, and their laws."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from gbeam.errors import InputError
from gbeam.guards.quantities import Factor, Ratio
from gbeam.io.models.arrays import read_state_space
from gbeam.mechanics.tree.control import Feedback, gains, in_series, lead_lag, notch, pid
from gbeam.scenario.schema.declared import chosen, table_of
from gbeam.scenario.schema.fields import File

Matrix = Sequence[Sequence[Ratio]]


def _matrices(
    *,
    file: Annotated[
        File | None,
        "file of matrices A, B, C, D: .npz, .mat or .json, relative to the scenario's folder; with dt, Ts or step, s, "
        "above zero it is in discrete time, and then the only law",
    ] = None,
    a: Annotated[Matrix | None, "A, by rows, in continuous time"] = None,
    b: Annotated[Matrix | None, "B, by rows: a column for every measurement"] = None,
    c: Annotated[Matrix | None, "C, by rows: a row for every effort"] = None,
    d: Annotated[Matrix | None, "D, by rows"] = None,
) -> Any:
    """A law with states of its own: x' = A x + B e, efforts = C x + D e, by rows or from a file."""
    matrices = {"a": a, "b": b, "c": c, "d": d}
    names = [name for name, matrix in matrices.items() if matrix is not None]
    if file is not None:
        if names:
            raise InputError(names[0], "is given beside file", "give the matrices or their file")
        stored = read_state_space(file)
        return stored if stored.dt else (stored.a, stored.b, stored.c, stored.d)
    if len(names) < len(matrices):
        lacking = next(name for name in matrices if name not in names)
        raise InputError("", f"{lacking} is missing", 'give a, b, c and d, or file = "controller.mat"')
    return tuple(np.array(matrix, dtype=float, ndmin=2) for matrix in matrices.values())


Law = chosen(
    "kind",
    {
        "gains": table_of(gains, name="Gains", tag=("kind", "gains")),
        "pid": table_of(pid, name="PID", tag=("kind", "pid")),
        "lead-lag": table_of(lead_lag, name="LeadLag", tag=("kind", "lead-lag")),
        "notch": table_of(notch, name="Notch", tag=("kind", "notch")),
        "state-space": table_of(_matrices, name="Matrices", tag=("kind", "state-space")),
    },
)


def _controller(
    *, law: Sequence[Any], measure: Sequence[str], reference: Sequence[float] | None = None, **others: Any
) -> Feedback:
    """A controller that samples measurements and holds its efforts; its laws act on reference less measurement."""
    aims = [0.0] * len(measure) if reference is None else list(reference)
    return Feedback(_in_series(law, len(measure), len(others["drive"])), measure, reference=aims, **others)


def _in_series(laws: Sequence[Any], measured: int, driven: int) -> Any:
    """Law of laws in series, or the only one, in discrete time; InputError unless they fit one another."""
    for k, law in enumerate(laws):
        if not isinstance(law, tuple):
            if len(laws) > 1:
                fix = "give it alone, or one in continuous time"
                raise InputError(f"law[{k}].file", f"is in discrete time, in steps of {law.dt:g} s", fix)
            return law
        if law[3].shape == (1, 1) and max(measured, driven) > 1:
            fix = "name one measurement and one effort, or give gains or a state-space"
            raise InputError(f"law[{k}]", "is of one error and one effort", fix)
    try:
        return in_series(laws)
    except ValueError:
        fix = "give as many columns as the law before gives values, and as many rows as the next one takes"
        raise InputError("law", "has matrices that do not fit one another", fix) from None


_LIMIT = "largest size of every effort, N or N m: [20]"
_AIMS = "aim of every measurement, in SI units; zero unless given: [0.5, 0]"
_LAWS = "laws one after the other, which act on reference less measurement: [{ kind, ... }, ...]"
Controller = table_of(
    _controller,
    Feedback,
    name="Controller",
    without={"state"},
    changed={
        "law": (tuple.__class_getitem__((Law, ...)), Field(min_length=1, description=_LAWS)),
        "limit": (tuple[Factor, ...] | None, Field(default=None, description=_LIMIT)),
        "reference": (tuple[Ratio, ...] | None, Field(default=None, description=_AIMS)),
    },
)
