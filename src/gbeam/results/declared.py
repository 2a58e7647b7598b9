"""Fields of results declared once: unit, words and dimensions, from which files, JSON, units and docstrings follow.

A result says of each field, where it stands, all that its outputs need to know::

    speed: Floats = quantity("rad/s", "hub rate", "speed", role="coordinate")

:func:`gbeam.io.layout.group_of` makes of it a variable of a file, :mod:`gbeam.results.facts` the JSON and the
units of the figures in it, and :func:`parameters` the docstring. Where a record has ``json_rows``, such as
``{"mode": "modes"}``, JSON has all that stands along that dimension row by row: in a list, or, where the dimension is
``axis`` or has `labels`, by name. Of `rows`, a field with the role labels is the name of each.
"""

from __future__ import annotations

import dataclasses
import sys
import textwrap
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache, partial
from operator import attrgetter
from types import EllipsisType, SimpleNamespace
from typing import TYPE_CHECKING, Any, Generic, Literal, TypeVar, get_args, get_origin, get_type_hints

Role = Literal["variable", "coordinate", "labels", "fact", "part", "rows"]
INSIDE = "."  # name or key of a part whose fields stand among those of the record that has it
# Names of the places along dimensions that are the same everywhere.
NAMES = {"axis": ("x", "y", "z"), "ends": ("start", "end"), "end": ("root", "tip")}
# Dimensions of histories: what stands along one JSON has only where its declaration says a key.
_HISTORIES = {"time", "run_time", "at", "better"}
_SIZES = {"axis": 3, "principal": 3, "euler": 4, "stress_component": 6}  # of an array that is empty
BESIDE = attrgetter("unit")  # unit of a field of a record whose field `unit` says it
_METADATA = "declared"
_T = TypeVar("_T")


@dataclass(frozen=True)
class Declaration:
    """Declaration of a field of a result, or of a property."""

    words: str  # the quantity, as files describe it
    # SI, or of the record; of a part that of its fields of BESIDE, "1" for none, of a mapping of records by name
    unit: str | Callable[[Any], str] | dict[str, str]
    dims: tuple[str, ...]  # of the array; of a part those before its own
    # labels: a coordinate of words; fact: an attribute of files; rows: a tuple of records, or a mapping of them by name
    role: Role
    # in files; of a part a pattern, ``root_*`` or ``root_``, left out by a slash in front; None: not there
    name: str | None
    # in JSON, with dots where it stands deeper, a slash in front where it is in no row; None: not there
    key: str | None
    note: str = ""  # more for the docstring
    frame: str = ""  # of vectors that are not in base axes
    flags: tuple[str, ...] = ()  # meanings of false and true in files
    optional: bool = False  # whether JSON and files leave it out where nothing is known

    @property
    def sentence(self) -> str:
        """The words and the note."""
        return f"{self.words[:1].upper()}{self.words[1:]}{f'; {self.note}' if self.note else ''}."


def quantity(
    unit: str | Callable[[Any], str] | dict[str, str],
    words: str,
    *dims: str,
    role: Role = "variable",
    name: str | None = "",
    key: str | EllipsisType | None = ...,
    note: str = "",
    frame: str = "",
    flags: tuple[str, ...] = (),
    optional: bool = False,
    empty: bool = False,
    **default: Any,
) -> Any:
    """Declare a field of a result; see :class:`Declaration`, where an empty name or key is the field's own.

    Dimensions are one text, "time point axis"; an `empty` array of them is the default of what may be left out. A key
    that is not given is the field's own name, and none along time: JSON has no histories.
    """
    dim_names, json_key = _dims_and_key(dims, key)
    declaration = Declaration(words, unit, dim_names, role, name, json_key, note, frame, flags, optional)
    if empty:
        default["default_factory"] = lambda: _empty_array(declaration.dims)
    return dataclasses.field(metadata={_METADATA: declaration}, **default)


# A field that stays in the record: neither files nor JSON have it.
internal = partial(quantity, name=None, key=None)


def _dims_and_key(dims: tuple[str, ...], key: str | EllipsisType | None) -> tuple[tuple[str, ...], str | None]:
    """Dimensions one by one, and the key in JSON: if left out "", the field's own name, or None of a history."""
    names = tuple(" ".join(dims).split())
    if not isinstance(key, EllipsisType):
        return names, key
    return names, None if _HISTORIES & set(names) else ""


def _empty_array(dims: tuple[str, ...]) -> Any:
    import numpy as np  # which reading a scenario needs not

    return np.empty([_SIZES.get(dim, 0) for dim in dims])


def fact(words: str, unit: str = "", **options: Any) -> Any:
    """Declare a field that is one word, number or truth: an attribute of a file."""
    return quantity(unit, words, role="fact", **options)


def part(words: str, *dims: str, unit: str = "", **options: Any) -> Any:
    """Declare a field that is another record."""
    return quantity(unit, words, *dims, role="part", **options)


def rows(words: str, dim: str, units: dict[str, str] | None = None, **options: Any) -> Any:
    """Declare a field that is a tuple of records, one for each place along a dimension of its own, or a mapping."""
    return quantity(units or "", words, dim, role="rows", **options)


def labels(words: str, *dim: str, key: str | None = None, **options: Any) -> Any:
    """Declare a field that is a tuple of words, the names of the places along a dimension; of a row its own name."""
    return quantity("", words, *dim, role="labels", key=key, **options)


class Declared(property, Generic[_T]):
    """A property with its declaration, which is its docstring where the getter has none."""

    def __init__(self, getter: Callable[[Any], _T], declaration: Declaration) -> None:
        super().__init__(getter)
        self.declaration = declaration
        unit = declaration.unit if isinstance(declaration.unit, str) else ""
        size = " ".join(filter(None, (_shape(declaration), unit)))
        self.__doc__ = getter.__doc__ or ", ".join(filter(None, (declaration.sentence[:-1], size))) + "."

    if TYPE_CHECKING:  # which knows the type of a property by its decorator alone

        def __get__(self, record: Any, kind: type | None = None, /) -> _T: ...  # type: ignore[override]


def declared(
    unit: str | Callable[[Any], str] | dict[str, str],
    words: str,
    *dims: str,
    role: Role = "variable",
    name: str | None = "",
    key: str | EllipsisType | None = ...,
    optional: bool = False,
) -> Callable[[Callable[[Any], _T]], Declared[_T]]:
    """Return a decorator that makes a declared property of a getter; see :func:`quantity`."""
    dim_names, json_key = _dims_and_key(dims, key)
    return lambda getter: Declared(getter, Declaration(words, unit, dim_names, role, name, json_key, optional=optional))


def declarations(kind: type) -> tuple[tuple[str, Declaration], ...]:
    """Return the declared fields of a record, then its declared properties, each name with its declaration."""
    hashable: Any = kind  # which type checkers deny of classes of records
    return _declarations(hashable)


@cache
def _declarations(kind: type) -> tuple[tuple[str, Declaration], ...]:
    declared_fields = []
    for field in dataclasses.fields(kind):
        declaration = field.metadata.get(_METADATA)
        if declaration is not None:
            declared_fields.append((field.name, declaration))
    properties = []
    for base in reversed(kind.__mro__):
        properties += [(name, value.declaration) for name, value in vars(base).items() if isinstance(value, Declared)]
    return (*declared_fields, *properties)


def along_time(record: Any) -> dict[str, Any]:
    """Return the arrays of a record that stand along time, by the name of their field."""
    fields = {field.name for field in dataclasses.fields(record)}
    dims = {name: declaration.dims for name, declaration in declarations(type(record)) if name in fields}
    histories = {name: getattr(record, name) for name in dims if dims[name][:1] == ("time",)}
    return {name: history for name, history in histories.items() if history is not None}


def parameters(kind: type) -> str:
    """Return the section `Parameters` of a docstring: type and words of every declared field."""
    lines = ["Parameters", "----------"]
    bases = [base for base in reversed(kind.__mro__) if base is kind or "__dataclass_fields__" in vars(base)]
    owners = {name: base for base in bases for name in vars(base).get("__annotations__", {})}
    for name, base in owners.items():
        field: Any = vars(base).get(name) if base is kind else vars(base)["__dataclass_fields__"].get(name)
        declaration = getattr(field, "metadata", {}).get(_METADATA)
        if declaration is not None and (base is kind or field.repr):  # the warnings are those of any result
            lines += [f"{name} : {_type_words(base.__annotations__[name], declaration)}", f"    {declaration.sentence}"]
    return "\n".join(lines)


def document(kind: type) -> None:
    """Add the section `Parameters` to a docstring that has none, where fields are declared."""
    text = kind.__doc__ or ""
    section = parameters(kind)
    if "Parameters\n" not in text and section.count("\n") > 1:
        start, examples, end = text.partition("    Examples\n")
        section = textwrap.indent(section, "    ")
        kind.__doc__ = f"{start.rstrip()}\n\n{section}\n" + (f"\n{examples}{end}" if examples else "")


def _type_words(annotation: str, declaration: Declaration) -> str:
    """Type of a field as docstrings have it: shape, kind and unit."""
    kinds = {"Floats": "", "Complex": "complex", "Flags": "bool", "NDArray[np.int_]": "int"}
    parts = annotation.removesuffix(" | None").split(" | ")
    words = " | ".join(kinds.get(part, _word(part)) for part in parts)
    if annotation.endswith(" | None"):
        words += " or None"
    if parts[0] in kinds:
        words = f"{_shape(declaration)} {words.strip()}"
    unit = declaration.unit if isinstance(declaration.unit, str) else ""
    return ", ".join(filter(None, (words.strip(), unit)))


def _word(annotation: str) -> str:
    element = annotation.removeprefix("tuple[").removesuffix(", ...]")
    return f"tuple of {element}" if annotation == f"tuple[{element}, ...]" and element.isidentifier() else annotation


def _shape(declaration: Declaration) -> str:
    dims = [dim.rstrip("_") for dim in declaration.dims]
    if not dims:
        return ""
    return f"({dims[0]},)" if len(dims) == 1 else f"({', '.join(dims)})"


def annotation(kind: type, name: str) -> Any:
    """Return the type of a field, or of what a property returns, or None where there is none."""
    for base in kind.__mro__:
        if name in vars(base).get("__annotations__", {}):
            return _type_of(vars(base)["__annotations__"][name], base.__module__)
        if isinstance(vars(base).get(name), property):
            return _type_of(vars(base)[name].fget.__annotations__.get("return"), base.__module__)
    return None


@cache
def _type_of(annotation: str | None, module: str) -> Any:
    """Type that an annotation of a module names."""
    return get_type_hints(SimpleNamespace(__annotations__={"": annotation}), vars(sys.modules[module]))[""]


def types_in(hint: Any) -> Iterator[Any]:
    """Yield a type and all that it is made of, such as float and None of ``float | None``; of arrays their numbers'."""
    yield hint
    parts = get_args(hint)
    for part in get_args(parts[1]) if getattr(get_origin(hint), "__name__", "") == "ndarray" else parts:
        yield from types_in(part)


def record_in(kind: type, name: str) -> Any:
    """Return the record that a field's type has in it, such as Crossing of ``tuple[Crossing, ...]``,
    or None if none.
    """
    return next(iter(records_in(kind, name)), None)


def records_in(kind: type, name: str) -> tuple[Any, ...]:
    """Return the records that a field's type has in it, of which a value is any."""
    return tuple(
        member
        for member in types_in(annotation(kind, name))
        if isinstance(member, type) and get_origin(member) is None and dataclasses.is_dataclass(member)
    )
