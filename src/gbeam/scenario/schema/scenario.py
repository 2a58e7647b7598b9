"""The whole scenario with its [model], [response] and [sweep], and what its tables must agree on."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import (
    AfterValidator,
    Field,
    PrivateAttr,
    ValidationInfo,
    model_validator,
)
from pydantic_core import PydanticCustomError

from gbeam.guards.limits import TITLE
from gbeam.printable import advise, level_words, unprintable
from gbeam.questions import QUESTIONS
from gbeam.scenario.schema.arm import Arm
from gbeam.scenario.schema.declared import table_of
from gbeam.scenario.schema.fields import Loc, Table, by_name, motion_name, optional, refuse, wrong
from gbeam.scenario.schema.motion import Centrifuge, Flight, Hub
from gbeam.scenario.schema.record import PartOfRecord, Record
from gbeam.scenario.text.source import Source
from gbeam.sweeps import SweepSettings

if TYPE_CHECKING:
    Beam = Any
    Response = Any
    Model = Any
    Motion = Any
    Sensor = Any
    Sweep = Any
else:
    from gbeam.scenario.schema.beam import Beam, Model
    from gbeam.scenario.schema.motion import Motion, Sensor
    from gbeam.scenario.schema.response import Response

    # Verbs are those of all questions, those that are declared elsewhere among them.
    Sweep = table_of(SweepSettings, name="Sweep", types={"verb": Literal[tuple(QUESTIONS)]})


def _printable(title: str) -> str:
    if len(title) > TITLE:
        raise wrong(f"has {len(title)} characters", f"give {TITLE} or fewer")
    character = unprintable(title)
    if character:
        raise wrong(f"holds {character}, which cannot be printed", "leave it out")
    return title


class Titled(Table):
    """Common keys of scenarios; a class of its own only to keep the tables in the order they are written in."""

    title: Annotated[str, AfterValidator(_printable)] = Field("", description="what the scenario is about, for reports")


class _Structure(Titled):
    beam: Beam = Field(description="the structure")
    model: Model = Field(description="the model of its deformation")


class Environments(Titled):
    """A scenario without a beam: the motions and how long they last. Enough to plan a machine's."""

    motion: dict[Annotated[str, AfterValidator(motion_name)], Motion] = Field(
        default_factory=dict,
        description="what the base does, each [motion.NAME]; without any it rests, which run of one structure refuses",
    )
    response: Response = Field(default_factory=Response, description="response over time")
    sensors: dict[str, Sensor] = by_name(
        "accelerometers by the names of points, each [sensors.POINT]: what they read is put out over time, and in "
        "accept srs is of it, in place of the acceleration itself"
    )
    sweep: Sweep | None = optional("many cases, for gbeam sweep")

    _source: Source | None = PrivateAttr(None)

    def heading(self, varied: Collection[str] = ()) -> str:
        """Title, and flights at another level than their own: ``8 g turn; flight × 1.25``; none of those at paths that
        are `varied`.
        """
        levels = [
            level_words(name, motion.scale)
            for name, motion in self.motion.items()
            if isinstance(motion, Flight) and motion.scale != 1 and f"motion.{name}.scale" not in varied
        ]
        return "; ".join(filter(None, [self.title, *levels]))

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all motions in their order: of an arm in several directions NAME-DIRECTION of each."""
        names = []
        for name, table in self.motion.items():
            directions = table.motions if isinstance(table, Arm) else ("",)
            names += ["-".join(filter(None, (name, direction))) for direction in directions]
        return tuple(names)

    @property
    def source(self) -> Source | None:
        """Text the scenario was read from, with its overrides; for messages and provenance."""
        return self._source

    def model_post_init(self, context: Any) -> None:
        """Keep the source, which load passes as context."""
        self._source = (context or {}).get("source")

    @model_validator(mode="after")
    def _agree(self, info: ValidationInfo) -> Self:
        # One validator for every kind of scenario, so that all errors are reported at once.
        refuse([*self._about_motions(), *self.about_structure()])
        return self

    def about_structure(self) -> Iterator[tuple[Loc, PydanticCustomError]]:
        """Errors of tables that do not agree with the structure, or with one another."""
        yield from ()

    def _about_motions(self) -> Iterator[tuple[Loc, PydanticCustomError]]:
        """Errors of centrifuges that track no flight, or of a response without a duration."""
        for name, motion in self.motion.items():
            if isinstance(motion, Centrifuge):
                yield from self._tracking(name, motion)
            if isinstance(motion, Flight) and isinstance(motion.record, PartOfRecord):
                yield from self._part(name, motion.record)
        for name in self.motion:
            homonyms = [candidate for candidate in self.names if candidate == name]
            if len(homonyms) > 1:
                yield ("motion", name), wrong("has the name of a direction of an arm", "give it another", mark="key")
        recorded = any(isinstance(motion, Flight) and motion.record for motion in self.motion.values())
        machines = any(isinstance(motion, Centrifuge) for motion in self.motion.values())  # which plan for these times
        if machines and self.response.duration is None and not recorded:
            yield (
                ("response",),
                wrong("duration is missing", 'no record gives one: add duration = "16 s"', mark="key"),
            )

    def _part(self, name: str, part: Any) -> Iterator[tuple[Loc, PydanticCustomError]]:
        """Errors of a record that is part of another flight's."""
        flights = {key: flight for key, flight in self.motion.items() if isinstance(flight, Flight)}
        recorded = [key for key, flight in flights.items() if isinstance(flight.record, Record)]
        where = ("motion", name, "record")
        if part.of not in recorded:
            message = "names a flight without a record of its own" if part.of in flights else "names no flight"
            hint = advise(part.of, recorded) if recorded else "give the record itself: file, time, x, y, z and unit"
            yield (*where, "of"), wrong(f"{{value}} {message}", hint)
            return
        if part.section is not None and flights[part.of].record.sections is None:
            hint = f'name the column that numbers them, such as sections = "event" in [motion.{part.of}.record]'
            yield (*where, "section"), wrong("is given, and its record has no sections", hint, mark="key")

    def _tracking(self, name: str, motion: Any) -> Iterator[tuple[Loc, PydanticCustomError]]:
        flights = [name for name, candidate in self.motion.items() if isinstance(candidate, Flight)]
        if motion.tracks not in flights:
            target = self.motion.get(motion.tracks)
            message = f"names a {target.kind}, not a flight" if target else "names no motion"
            hint = advise(motion.tracks, flights) if flights else "add a motion of kind flight"
            yield ("motion", name, "tracks"), wrong(f"{{value}} {message}", hint)


class Scenario(Environments, _Structure):
    """A validated scenario: SI floats throughout, frozen.

    Built by :func:`gbeam.scenario.load` and :func:`gbeam.scenario.loads`.
    """

    def about_structure(self) -> Iterator[tuple[Loc, PydanticCustomError]]:
        """Motions that do not agree with the beam or its model."""
        for name, motion in self.motion.items():
            length = math.inf if self.beam.length is None else self.beam.length
            if isinstance(motion, Centrifuge) and motion.control_point_x > length * (1 + 1e-12):
                hint = "give 0 to {beam.length} from the root"
                yield ("motion", name, "control_point"), wrong("{value} is beyond the tip", hint)
            if isinstance(motion, Hub):
                # A section set at a right angle bends along z in the plane of the hub.
                axis = "y" if abs(math.cos(motion.setting_angle or 0.0)) > 1e-9 else "z"
                if self.model.modes is not None and not getattr(self.model.modes, axis):
                    problem = f"there is no bending shape along {axis}, the plane of the hub {name!r}"
                    yield ("model", "modes", axis), wrong(problem, f"give {axis} = 1 or more")
