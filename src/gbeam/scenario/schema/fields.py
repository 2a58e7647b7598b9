"""Types of fields of the schema, such as quantities with units, and functions that read declarations and values."""

from __future__ import annotations

import pathlib
from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeVar, get_args

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    Tag,
    ValidationInfo,
    WithJsonSchema,
    model_validator,
)
from pydantic import ValidationError as PydanticError
from pydantic_core import InitErrorDetails, PydanticCustomError

from gbeam.guards.limits import ENTRIES, NAME, existing
from gbeam.guards.quantities import Angle, Offset, Position, Quantity, Ratio
from gbeam.mechanics.tree.joints import GROUND
from gbeam.printable import closest, shortened
from gbeam.scenario.values import Path, path_text

if TYPE_CHECKING:
    from pydantic.fields import FieldInfo


Loc = tuple[int | str, ...]
TAGS = ("kind", "shape", "profile")  # keys that say which of several tables one is


class Table(BaseModel):
    """A table of the scenario: frozen, and no key beside the declared ones."""

    # Validators are built with that of the whole scenario, not once more for each of the fifty tables.
    model_config = ConfigDict(extra="forbid", frozen=True, defer_build=True)


def optional(words: str, **options: Any) -> Any:
    """Declare a key that may be left out, and is None then."""
    return Field(default=None, description=words, **options)


def listed(words: str) -> Any:
    """Declare a list that may be left out."""
    return Field(default=(), max_length=ENTRIES, description=words)


def by_name(words: str) -> Any:
    """Declare tables or values by names that the user gives, which may be left out."""
    return Field(default_factory=dict, max_length=ENTRIES, description=words)


def wrong(message: str, hint: str = "", *, mark: Literal["value", "key"] = "value") -> PydanticCustomError:
    """Return the error of one value, whose caret stands under the value or its key."""
    return PydanticCustomError("scenario", "{message}", {"message": message, "hint": hint, "mark": mark})


def motion_name(name: str) -> str:
    """Return a name of letters, digits, underscores and hyphens; an error of validation for any other."""
    if not name.replace("-", "_").isidentifier() or not name.isascii():
        raise wrong(
            f"{shortened(repr(name))} is not a word",
            "name a motion with letters, digits, _ and -, a letter first",
            mark="key",
        )
    if len(name) > NAME:
        raise wrong(f"{shortened(name)!r} has {len(name)} characters", f"give {NAME} or fewer", mark="key")
    return name


def _check_name(name: str) -> str:
    if not name.isidentifier() or not name.isascii() or len(name) > NAME or name == GROUND:
        raise wrong(f"{shortened(repr(name))} is not a name", "give letters, digits and underscores", mark="key")
    return name


Name = Annotated[str, AfterValidator(_check_name)]
Direction = tuple[Ratio, Ratio, Ratio]


def existing_file(file: str, info: ValidationInfo) -> str:
    """Path of an existing file, relative to the scenario's folder, which the context of validation holds."""
    path = pathlib.Path((info.context or {}).get("folder", ".")) / file
    if existing(path) and not path.is_dir():
        return str(path)
    folder = path.parent
    try:
        neighbours = sorted(p.name for p in folder.iterdir() if p.is_file())
    except (OSError, ValueError):
        neighbours = []
    suggestion = closest(path.name, neighbours)
    hint = f"it is looked for in {folder}"
    if suggestion:
        hint = f"did you mean {str(pathlib.Path(file).with_name(suggestion))!r}?"
    raise wrong("there is no file {value}", hint)


# In the JSON schema the format "file-path" marks keys that name files.
File = Annotated[str, AfterValidator(existing_file), WithJsonSchema({"type": "string", "format": "file-path"})]


def missing_one_of(first: str, second: str) -> tuple[Loc, PydanticCustomError]:
    """Problem of a table that has neither of two keys."""
    hint = f"add one of them: {first} = ... or {second} = ..."
    return (), wrong(f"{first} or {second} is missing", hint, mark="key")


def refuse(problems: Iterable[tuple[Loc, PydanticCustomError]]) -> None:
    """Raise all `problems` at once, each at its place within the table; do nothing if there are none."""
    details = [InitErrorDetails(type=error, loc=loc, input=None) for loc, error in problems]
    if details:
        # A validator may raise ValidationError: pydantic keeps each of its errors and prefixes their places.
        raise PydanticError.from_exception_data("scenario", details)


class Vector(Table):
    """Components x, y and z, at least one of them given."""

    @model_validator(mode="after")
    def _refuse_empty(self) -> Vector:
        if all(getattr(self, axis) is None for axis in "xyz"):
            refuse([((), wrong("has no component", "give one or more of x, y and z"))])
        return self


def fields_of(table: type[BaseModel]) -> dict[str, FieldInfo]:
    """Fields of a table by their keys in the file, which may be words of Python such as ``from``."""
    return {field.alias or name: field for name, field in table.model_fields.items()}


def kind_of(table: BaseModel, key: str) -> str:
    """Kind of quantity, a key of ``KINDS``, of the value at a key of a table, or empty if it is no quantity."""
    return _kind_in(parts_of(fields_of(type(table)).get(key)))


def _kind_in(parts: Iterable[Any]) -> str:
    return next((part.kind for part in parts if isinstance(part, Quantity)), "")


def parts_of(field: FieldInfo | None) -> tuple[Any, ...]:
    """Metadata of a field and the parts of its annotation at any depth, or empty for None."""
    return () if field is None else (*field.metadata, *annotation_parts(field.annotation))


def annotation_parts(annotation: Any) -> Iterator[Any]:
    """Parts of an annotation at any depth, itself first."""
    yield annotation
    for part in get_args(annotation):
        yield from annotation_parts(part)


Step = Annotated[float | Literal["auto"], Quantity("time", "positive", words=("auto",))]
Place3 = tuple[Offset, Offset, Offset]
Turn3 = tuple[Angle, Angle, Angle]

# A union would report the errors of both branches; the tags pick one, and explain drops them from the place.
ONE_OR_LIST = Discriminator(lambda value: "list" if isinstance(value, (list, tuple)) else "one")
_SOME = Field(min_length=1, max_length=ENTRIES)
_T = TypeVar("_T")
ControlPoint = Annotated[Annotated[Position, Tag("one")] | Annotated[Place3, Tag("list")], ONE_OR_LIST]
OneOrSome = Annotated[Annotated[_T, Tag("one")] | Annotated[tuple[_T, ...], _SOME, Tag("list")], ONE_OR_LIST]
Ratios = OneOrSome[Ratio]


def quantities(table: BaseModel) -> dict[str, tuple[float, str]]:
    """Value in SI and kind, a key of ``KINDS``, of every quantity that a scenario gives, by its path."""
    numbers = ((path, value, _kind_in(parts)) for path, value, parts in _leaves(table) if type(value) in (int, float))
    return {path_text(path): (float(value), kind) for path, value, kind in numbers if kind}


def files(tables: Any, path: Path) -> Iterator[tuple[str, str]]:
    """Yield path of the key, and name, of every file named in a table, or in several, at `path`."""
    for place, value, parts in _leaves(tables, path):
        if isinstance(value, str) and any(getattr(part, "func", None) is existing_file for part in parts):
            yield path_text(place), value


def _leaves(node: Any, path: Path = (), parts: tuple[Any, ...] = ()) -> Iterator[tuple[Path, Any, tuple[Any, ...]]]:
    """Yield path and value of all values that are written below a node, with the annotation's parts of each key."""
    if isinstance(node, BaseModel):
        for (key, field), name in zip(fields_of(type(node)).items(), type(node).model_fields, strict=True):
            if name in node.model_fields_set:
                yield from _leaves(getattr(node, name), (*path, key), parts_of(field))
    elif isinstance(node, (Mapping, tuple)):
        for step, value in node.items() if isinstance(node, Mapping) else enumerate(node):
            yield from _leaves(value, (*path, step), parts)
    else:
        yield path, node, parts
