"""Settings of sweeps, as the [sweep] of a scenario and :func:`gbeam.sweep` take them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated

from gbeam.arrays.tree import Value
from gbeam.constants import Sampler, Verb
from gbeam.guards.quantities import Count

SAMPLES = 64  # drawn where no number is given


@dataclass(frozen=True, eq=False)
class SweepSettings(Value):
    """Figures of many cases; `gbeam run` and the others answer for the scenario as it stands."""

    over: Annotated[
        Mapping[str, str],
        'values by the path of a key: a range "1 m:12 m:12" (from, to, how many), a list "FOAM, exact", or a '
        'distribution "normal(70 GPa, 2 GPa)", lognormal, uniform or triangular; what is a distribution where it '
        "stands is drawn too",
    ] = field(default_factory=dict)
    measure: Annotated[
        Sequence[str], "figures by the end of their path in the verb's JSON, such as tip.z.max_abs or verdict.tip"
    ] = ()
    history: Annotated[Sequence[str], "histories over time by motion, quantity and axis, such as flight.tip.z"] = ()
    verb: Annotated[Verb, "whose figures"] = "run"
    samples: Annotated[Annotated[int, Count(1)] | None, f"how many are drawn from distributions; {SAMPLES}"] = None
    sampler: Annotated[Sampler, "how they are drawn; saltelli for Sobol indices"] = "sobol"
    seed: Annotated[Annotated[int, Count(0)], "the same seed draws the same samples"] = 0
