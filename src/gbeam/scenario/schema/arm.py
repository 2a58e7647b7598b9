"""[motion.NAME] of kind arm: a centrifuge of one axis, in one direction of its specimen or several."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, Literal, Self

from pydantic import (
    AfterValidator,
    Discriminator,
    Field,
    ModelWrapValidatorHandler,
    PrivateAttr,
    StrictBool,
    Tag,
    model_validator,
)
from pydantic_core import PydanticCustomError

from gbeam.constants import Along, PresetName
from gbeam.guards.quantities import Quantity
from gbeam.motion.arm import plain_arm
from gbeam.scenario.presets import PRESETS, preset_of
from gbeam.scenario.schema.declared import table_of
from gbeam.scenario.schema.fields import (
    ONE_OR_LIST,
    ControlPoint,
    Loc,
    by_name,
    missing_one_of,
    motion_name,
    optional,
    refuse,
    wrong,
)

_Component = Annotated[float, Quantity("ratio")]
_AlongOrVector = Annotated[
    Annotated[Along, Tag("one")] | Annotated[tuple[_Component, _Component, _Component], Tag("list")], ONE_OR_LIST
]


def _one_words_or_vector(value: Any) -> str:
    if not isinstance(value, (list, tuple)):
        return "one"
    return "words" if value and all(isinstance(word, str) for word in value) else "list"


def _one_vector_or_table(value: Any) -> str:
    if isinstance(value, str):
        return "one"
    return "list" if isinstance(value, (list, tuple)) else "table"


_Up = Annotated[
    Annotated[Along, Tag("one")]
    | Annotated[tuple[Along, ...], Tag("words")]
    | Annotated[tuple[_Component, _Component, _Component], Tag("list")],
    Discriminator(_one_words_or_vector),
]


_UP = (
    'direction of the specimen that is up: "+z", a vector, or several such as ["+z", "+x"], of which the first that is '
    "not along load is taken"
)
_POINT = "point of the specimen at which the level holds, from the root: along x, or [x, y, z]"
_KEYS = frozenset({"level", "up", "onset", "ramp", "dwell", "down", "radius", "control_point"})
_Direction = table_of(
    plain_arm,
    name="_Direction",
    without={"load", "gravity", "standard"},
    optional=_KEYS,
    changed={
        "up": (_Up | None, Field(default=None, description=_UP)),
        "control_point": (ControlPoint | None, Field(default=None, description=_POINT)),
    },
)


class _Held(_Direction):  # type: ignore[misc, valid-type]
    """Keys of a plain arm that a direction may have of its own."""

    @model_validator(mode="after")
    def _one_way_up(self) -> Self:
        if self.onset is not None and self.ramp is not None:
            refuse([(("ramp",), wrong("is given beside onset", "keep onset or ramp, not both", mark="key"))])
        return self

    @property
    def written_keys(self) -> dict[str, Any]:
        """Keys that are written, by name."""
        values = {key: getattr(self, key) for key in _Direction.model_fields}
        return {key: value for key, value in values.items() if value is not None}


class TestDirection(_Held):
    """One direction in which a plain arm tests its specimen, with keys that differ from the arm's."""

    load: _AlongOrVector | None = optional(
        'direction of the specimen that points to the arm\'s axis: the level accelerates it that way, "+x"; that of '
        "the preset where it is left out"
    )


class Arm(_Held):
    """A plain arm: one axis that turns up to a level, holds it and stops, with a specimen in a fixed mounting."""

    kind: Literal["arm"] = Field(description="kind of the motion")
    preset: PresetName | None = optional(
        "test of a standard, by name: `gbeam presets` lists them, with their figures and clauses. It gives keys that "
        "are left out here, and asks for those whose text could not be read; a direction may leave load to it"
    )
    load: _AlongOrVector | None = optional(
        "direction of the specimen that points to the arm's axis: the level accelerates it that way, such as "
        '"+x", or a vector; or directions'
    )
    directions: dict[
        Annotated[str, AfterValidator(motion_name)],
        Annotated[
            Annotated[Along, Tag("one")]
            | Annotated[tuple[_Component, _Component, _Component], Tag("list")]
            | Annotated[TestDirection, Tag("table")],
            Discriminator(_one_vector_or_table),
        ],
    ] = by_name(
        "several directions by name, each a motion of its own, NAME-DIRECTION: the load's direction, or a table with "
        'keys that differ: { fore = "+x", up = { load = "+z", level = "6 g" } }'
    )
    gravity: StrictBool = Field(
        default=True, description="false to leave out the weight, which a test on the ground always has"
    )
    _taken: tuple[str, ...] = PrivateAttr(default=())  # keys that are the preset's

    @property
    def motions(self) -> dict[str, dict[str, Any]]:
        """Keys of the motion of every direction, by its name; of one direction the name is empty."""
        common = self.written_keys
        if not self.directions:
            return {"": common | {"load": self.load}}
        return {name: _merged(common, direction) for name, direction in self.directions.items()}

    @property
    def standard(self) -> str:
        """Words on the preset's standard and the clauses of what is taken from it, or empty without a preset."""
        return "" if self.preset is None else preset_of(self.preset).words(self.preset, self._taken)

    @model_validator(mode="wrap")
    @classmethod
    def _preset(cls, value: Any, read: ModelWrapValidatorHandler[Self]) -> Self:
        """Take keys that are left out from the preset, and of directions their loads."""
        if not isinstance(value, dict) or value.get("preset") not in PRESETS:
            return read(value)
        preset = preset_of(value["preset"])
        left_out = {key: part for key, part in preset.arm.items() if key not in value}
        directions = value.get("directions")
        if "load" in value:
            left_out.pop("directions", None)
        elif isinstance(directions, dict):
            left_out["directions"] = {name: _with_load(direction, preset.directions.get(name)) for name, direction in
                                      directions.items()}  # fmt: skip
        arm = read(value | left_out)
        arm._taken = tuple(key for key, part in left_out.items() if value.get(key) != part)
        return arm

    @model_validator(mode="after")
    def _complete(self) -> Arm:
        refuse(self._problems())
        return self

    def _problems(self) -> Iterator[tuple[Loc, PydanticCustomError]]:
        """Errors of an arm without directions or loads, or without keys that every direction needs."""
        if self.load is None and not self.directions:
            advice = self._request("directions")
            yield ((), wrong("directions are missing", advice, mark="key")) if advice else _UNDIRECTED
        unloaded = [name for name, keys in self.motions.items() if name and keys["load"] is None]
        if unloaded:
            hint = self._request("directions") or 'add load = "+x" to each'
            yield ("directions",), wrong(f"load is missing in the directions {', '.join(unloaded)}", hint, mark="key")
        if self.load is not None and self.directions:
            yield ("load",), wrong("is given beside directions", "keep load or directions, not both", mark="key")
        for key, example in _NEEDED.items():
            alternatives = (key, *_OR.get(key, ()))
            lacking = [name for name, keys in self.motions.items() if not {*alternatives} & keys.keys()]
            if lacking:
                directions = f" in the directions {', '.join(lacking)}" if len(lacking) < len(self.motions) else ""
                hint = self._request(key) or f"add {key} = {example}"
                yield (), wrong(f"{' or '.join(alternatives)} is missing{directions}", hint, mark="key")

    def _request(self, key: str) -> str:
        """Words that ask for a key that the preset's standard fixes, or empty where it does not."""
        advice = "" if self.preset is None else preset_of(self.preset).advice(key)
        return f"give {key} by {advice}" if advice else ""


# What every direction needs, with examples; onset or ramp.
_NEEDED = {"radius": '"3.3 m"', "control_point": "[0, 0, 0]", "level": '"9 g"', "onset": '"0.5 g/s"', "dwell": '"60 s"',
           "up": '["+z", "+x"]'}  # fmt: skip
_OR = {"onset": ("ramp",)}
_UNDIRECTED = missing_one_of("load", "directions")


def _with_load(direction: Any, load: Any) -> Any:
    """Table of a direction with the load that a preset gives it, where it is a table that has none."""
    return {"load": load} | direction if isinstance(direction, dict) and load is not None else direction


def _merged(common: dict[str, Any], direction: Any) -> dict[str, Any]:
    """Keys of an arm with those that one of its directions has of its own."""
    if not isinstance(direction, TestDirection):
        return common | {"load": direction}
    changed = direction.written_keys
    alternatives = {"onset": "ramp", "ramp": "onset"}
    common_keys = {key: value for key, value in common.items() if alternatives.get(key) not in changed}
    return common_keys | changed | {"load": direction.load}
