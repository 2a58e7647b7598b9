"""[response]: how long, by which integrator, which output."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, Literal

from pydantic import Field, StrictBool, field_validator, model_validator
from pydantic_core import PydanticCustomError

from gbeam.constants import Integrator
from gbeam.guards.limits import ENTRIES
from gbeam.scenario.schema.fields import (
    Acceleration,
    Duration,
    Loc,
    Offset,
    Position,
    Quantity,
    Ratio,
    Speed,
    Step,
    Table,
    Time,
    optional,
    refuse,
    wrong,
)

# Which parameters each integrator takes.
PARAMETERS: dict[str, tuple[str, ...]] = {
    "newmark": ("beta", "gamma"),
    "hht": ("alpha",),
    "generalized-alpha": ("rho_inf",),
    "gauss": (),
}


class TipDisplacement(Table):
    """A displacement of the tip across the beam, by components; those left out are free."""

    y: Offset | None = optional("component along the width")
    z: Offset | None = optional("component through the thickness")


class TipVelocity(Table):
    """A velocity of the tip across the beam, by components; those left out are free."""

    y: Speed | None = optional("component along the width")
    z: Speed | None = optional("component through the thickness")


class Initial(Table):
    """The state of the beam, relative to its base, in which a response begins; a machine's with its spin-up."""

    state: Literal["equilibrium", "undeformed"] = Field(
        default="equilibrium",
        description="equilibrium: at rest in the relative equilibrium with the base's motion and the loads then; "
        "undeformed: straight and at rest",
    )
    acceleration: tuple[Acceleration, Acceleration, Acceleration] | None = optional(
        'released from the static deflection under this acceleration of the root, [0, 0, "2 g"], and under '
        "the loads then"
    )
    tip_displacement: TipDisplacement | None = optional(
        "released from the static deflection by a force at the tip that displaces it so: { y, z }"
    )
    tip_velocity: TipVelocity | None = optional(
        "velocity of the tip relative to the base, the beam moving in the shape of that deflection: { y, z }"
    )

    @property
    def settings(self) -> dict[str, Any]:
        """Settings that are given, as the object takes them."""
        return self.model_dump(exclude_none=True)


class Response(Table):
    """Response over time."""

    duration: Duration | None = optional(
        "length of what is computed over time; left out beside a record, of which `to` asks for a part, and where "
        "answers of one time are asked for, such as modes"
    )
    step: Step = Field(default="auto", description="time step, or auto")
    integrator: Integrator | None = optional(
        "time integrator; left out gauss of systems and on free hubs, newmark otherwise"
    )
    beta: Ratio | None = optional("parameter of newmark")
    gamma: Ratio | None = optional("parameter of newmark")
    alpha: Ratio | None = optional("parameter of hht")
    rho_inf: Ratio | None = optional("parameter of generalized-alpha: spectral radius at infinite frequency")
    tolerance: Annotated[float, Quantity("ratio", "positive")] = Field(
        default=1e-2,
        description="largest total error, of displacement, root loads and stress, without a warning; an automatic step "
        "aims at a third of it, and at 1e-4 at most",
    )
    estimate: StrictBool = Field(
        default=True,
        description="whether the error is estimated; false: a given step is run once, and the result says that no "
        "error is known; an automatic one, which nothing but its own error can choose, is found from several runs all "
        "the same, and only shapes and model are not judged",
    )
    initial: Initial = Field(
        default_factory=Initial, description="state at the start; the relative equilibrium if left out"
    )
    residual_from: Time | None = optional("time from which the residual vibration is measured")
    stations: tuple[Position, ...] | None = optional(
        "positions from the root for the output; the tip if left out", min_length=1, max_length=ENTRIES
    )

    histories: Step = Field(
        default="auto",
        description="time between the samples of histories in the result file, such as 10 ms; auto keeps all up to "
        "50,000 of a motion, else every second, third and so on. Peaks, errors and verdict are of all",
    )

    @property
    def scheme(self) -> str:
        """The integrator whose parameters these are."""
        return self.integrator or "newmark"

    @property
    def parameters(self) -> dict[str, float]:
        """The integrator's parameters that are given."""
        named = {name: getattr(self, name) for name in PARAMETERS[self.scheme]}
        return {name: value for name, value in named.items() if value is not None}

    @field_validator("integrator", mode="before")
    @classmethod
    def _offered(cls, value: object) -> object:
        """Refuse an integrator that earlier versions offered."""
        if value == "adaptive":
            raise wrong("{value} is no longer offered", 'use "gauss" with step = "auto": as accurate, and faster')
        return value

    @model_validator(mode="after")
    def _consistent(self) -> Response:
        def problems() -> Iterator[tuple[Loc, PydanticCustomError]]:
            takes = PARAMETERS[self.scheme]
            for name in ("beta", "gamma", "alpha", "rho_inf"):
                if name not in takes and getattr(self, name) is not None:
                    hint = f"it takes {' and '.join(takes)}" if takes else "it has no parameters"
                    yield (name,), wrong(f"does not belong to {self.scheme}", hint, mark="key")
            if self.duration is not None and self.step != "auto" and self.step > self.duration:
                hint = "give a time before the end, {response.duration}"
                yield ("step",), wrong("{value} is longer than the computation", hint)

        refuse(problems())
        return self
