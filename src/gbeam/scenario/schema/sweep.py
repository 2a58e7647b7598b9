"""[sweep]: what `gbeam sweep` varies and measures, where the command line does not say."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from pydantic import Field

from gbeam.questions import QUESTIONS
from gbeam.scenario.schema.common.fields import Table

if TYPE_CHECKING:
    Verb = str
else:
    Verb = Literal[tuple(QUESTIONS)]


class Sweep(Table):
    """Figures of many cases; `gbeam run` and the others answer for the scenario as it stands."""

    over: dict[str, str] = Field(
        default_factory=dict,
        description='values by the path of a key: a range "1 m:12 m:12" (from, to, how many), a list "FOAM, exact", or '
        'a distribution "normal(70 GPa, 2 GPa)", lognormal, uniform or triangular; what is a distribution where it '
        "stands is drawn too",
    )
    measure: tuple[str, ...] = Field(
        default=(),
        description="figures by the end of their path in the verb's JSON, such as tip.z.max_abs or verdict.tip",
    )
    history: tuple[str, ...] = Field(
        default=(), description="histories over time by motion, quantity and axis, such as flight.tip.z"
    )
    verb: Verb = Field(default="run", description="whose figures")
    samples: int | None = Field(
        default=None, ge=1, strict=True, description="how many are drawn from distributions; 64"
    )
    sampler: Literal["sobol", "latin", "random", "saltelli"] = Field(
        default="sobol", description="how they are drawn; saltelli for Sobol indices"
    )
    seed: int = Field(default=0, ge=0, strict=True, description="the same seed draws the same samples")
