"""The whole scenario, and what its tables must agree on."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import AfterValidator, Field, PrivateAttr, ValidationInfo, model_validator
from pydantic_core import PydanticCustomError

from gbeam.scenario.fields import Loc, Table, refuse, wrong
from gbeam.scenario.schema.beam import Beam, beyond_the_tip
from gbeam.scenario.schema.model import Model
from gbeam.scenario.schema.motion import Centrifuge, Flight, Hub, Motion
from gbeam.scenario.schema.response import Response
from gbeam.scenario.suggest import advise

if TYPE_CHECKING:
    from gbeam.scenario.source import Source


def _word(name: str) -> str:
    if not name.replace("-", "_").isidentifier() or not name.isascii():
        raise wrong(
            f"{name!r} is not a word",
            "name a motion with letters, digits, _ and -, a letter first",
            mark="key",
        )
    return name


class Scenario(Table):
    """A validated scenario: SI floats throughout, frozen.

    Built by :func:`gbeam.scenario.load` and :func:`gbeam.scenario.loads`.
    """

    title: str = Field("", description="what the scenario is about, for reports")
    beam: Beam = Field(description="the structure")
    model: Model = Field(description="the model of its deformation")
    motion: dict[Annotated[str, AfterValidator(_word)], Motion] = Field(
        min_length=1, description="what the base does: one environment or more, each [motion.NAME]"
    )
    response: Response = Field(default=Response(), description="response over time")

    _source: Source | None = PrivateAttr(None)

    @property
    def source(self) -> Source | None:
        """Text the scenario was read from, with its overrides; for messages and provenance."""
        return self._source

    def model_post_init(self, context: Any) -> None:
        """Keep the source, which load passes as context."""
        self._source = (context or {}).get("source")

    @model_validator(mode="after")
    def _agree(self, info: ValidationInfo) -> Scenario:
        refuse(self._problems())
        return self

    def _problems(self) -> Iterator[tuple[Loc, PydanticCustomError]]:
        for name, motion in self.motion.items():
            if isinstance(motion, Centrifuge):
                yield from self._tracking(name, motion)
            if isinstance(motion, Hub) and not self.model.modes.y:
                yield (
                    ("model", "modes", "y"),
                    wrong(
                        f"there is no bending shape along y, the plane of the hub {name!r}",
                        "give y = 1 or more",
                    ),
                )
        for i, station in enumerate(self.response.stations or ()):
            if self._beyond(station):
                yield ("response", "stations", i), beyond_the_tip()
        recorded = any(isinstance(motion, Flight) and motion.record for motion in self.motion.values())
        if self.response.duration is None and not recorded:
            yield (
                ("response",),
                wrong("duration is missing", 'no record gives one: add duration = "16 s"', mark="key"),
            )

    def _tracking(self, name: str, motion: Centrifuge) -> Iterator[tuple[Loc, PydanticCustomError]]:
        place = ("motion", name)
        flights = [other for other, it in self.motion.items() if isinstance(it, Flight)]
        if motion.tracks not in flights:
            target = self.motion.get(motion.tracks)
            message = f"names a {target.kind}, not a flight" if target else "names no motion"
            hint = advise(motion.tracks, flights) if flights else "add a motion of kind flight"
            yield (*place, "tracks"), wrong(f"{{value}} {message}", hint)
        if self._beyond(motion.control_point):
            yield (*place, "control_point"), beyond_the_tip()

    def _beyond(self, position: float) -> bool:
        return position > self.beam.length * (1 + 1e-12)
