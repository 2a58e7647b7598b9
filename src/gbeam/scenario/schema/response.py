"""[response]: its times, steps, integrator and the state in which it begins."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Self

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from gbeam.analysis.response.settings import ResponseSettings
from gbeam.analysis.system.initial import Initial as _Initial
from gbeam.constants import Integrator, Parameter
from gbeam.guards.limits import ENTRIES
from gbeam.guards.quantities import Duration, Position, Ratio
from gbeam.scenario.schema.declared import read_as, table_of
from gbeam.scenario.schema.fields import Loc, Step, Table, optional, refuse, wrong

# Which parameters each integrator takes.
PARAMETERS: dict[Integrator, tuple[Parameter, ...]] = {
    "newmark": ("beta", "gamma"),
    "hht": ("alpha",),
    "generalized-alpha": ("rho_inf",),
    "gauss": (),
}


Initial = read_as(_Initial, table_of(_Initial))


class _Integration(Table):
    """Parameters of integrators, and where the output is."""

    beta: Ratio | None = optional("parameter of newmark")
    gamma: Ratio | None = optional("parameter of newmark")
    alpha: Ratio | None = optional("parameter of hht")
    rho_inf: Ratio | None = optional("parameter of generalized-alpha: spectral radius at infinite frequency")
    stations: tuple[Position, ...] | None = optional(
        "positions from the root for the output; the tip if left out", min_length=1, max_length=ENTRIES
    )

    @property
    def parameters(self) -> dict[Parameter, float]:
        """Parameters of the integrator that are written."""
        table: Any = self
        values = {name: getattr(self, name) for name in PARAMETERS[table.integrator]}
        return {name: value for name, value in values.items() if value is not None}

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        table: Any = self

        def problems() -> Iterator[tuple[Loc, PydanticCustomError]]:
            takes = PARAMETERS[table.integrator]
            for owner, names in PARAMETERS.items():
                for name in names:
                    if name not in takes and getattr(self, name) is not None:
                        hint = f"it takes {' and '.join(takes)}" if takes else f'give integrator = "{owner}" with it'
                        yield (name,), wrong(f"does not belong to {table.integrator}", hint, mark="key")
            if table.duration is not None and table.step != "auto" and table.step > table.duration:
                hint = "give a time before the end, {response.duration}"
                yield ("step",), wrong("{value} is longer than the computation", hint)

        refuse(problems())
        return self


_DURATION = (
    "length of what is computed over time; left out beside a record, of which `to` asks for a part, and where answers "
    "of one time are asked for, such as modes"
)
_HISTORIES = (
    "time between the samples of histories in the result file, such as 10 ms; auto keeps those of the results' steps, "
    "up to 50,000 of a motion, else every second, third and so on. Peaks are of all steps"
)
Response = table_of(
    ResponseSettings,
    name="Response",
    base=_Integration,
    without={"start", "loads", "parameters"},
    changed={
        "duration": (Duration | None, Field(default=None, description=_DURATION)),
        "step": (Step, Field(default="auto", description="time step, or auto")),
        "histories": (Step, Field(default="auto", description=_HISTORIES)),
        "initial": (
            Initial,
            Field(default_factory=Initial, description="state at the start; the relative equilibrium if left out"),
        ),
    },
)
