"""[sweep]: what `gbeam sweep` varies and measures, where the command line does not say."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from gbeam.scenario.schema.fields import Table


class Sweep(Table):
    """Figures of many cases; `gbeam run` and the others answer for the scenario as it stands."""

    over: dict[str, str] = Field(
        min_length=1,
        description='values by the path of a key: a range "1 m:12 m:12" (from, to, how many), a list "FOAM, exact", or '
        'a distribution "normal(70 GPa, 2 GPa)", lognormal, uniform or triangular',
    )
    measure: Annotated[tuple[str, ...], Field(min_length=1)] = Field(
        description="figures by the end of their path in the verb's JSON, such as tip.z.max_abs or verdict.tip"
    )
    verb: Literal["run", "static", "modes", "critical-speed", "plan", "place"] = Field(
        default="run", description="whose figures"
    )
    samples: int | None = Field(
        default=None, ge=1, strict=True, description="how many are drawn from distributions; 64"
    )
    sampler: Literal["sobol", "latin", "random"] = Field(default="sobol", description="how they are drawn")
    seed: int = Field(default=0, ge=0, strict=True, description="the same seed draws the same samples")
