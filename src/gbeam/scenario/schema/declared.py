"""Tables of a scenario that follow from the parameters of classes and functions, and the objects of such tables.

A table has the keys of a signature: their types, quantities, words and defaults are declared there and nowhere else
(`gbeam.guards.quantities`). Its object is what the class or function makes of the values that are written.
"""

from __future__ import annotations

import dataclasses
import sys
import types
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cache, reduce
from inspect import getdoc, unwrap
from operator import or_
from typing import Annotated, Any, Literal, NamedTuple, Union, get_args, get_origin

from numpy import ndarray
from numpy.typing import ArrayLike
from pydantic import BaseModel, Discriminator, Field, StrictBool, StrictInt, Tag, create_model

from gbeam.guards.limits import ENTRIES
from gbeam.guards.parameters import Parameter, parameters_of
from gbeam.guards.quantities import Components, Count, OfProfile, OneOrSome, Quantity, Rows, Shape
from gbeam.motion.profiles.combine import vector
from gbeam.motion.profiles.profile import Profile
from gbeam.scenario.collector import Collector
from gbeam.scenario.schema.fields import ONE_OR_LIST, Table, Vector, fields_of

Make = Callable[..., Any]
_LISTS = (Sequence, Iterable, list, tuple)
_PLAIN = {bool: StrictBool, int: StrictInt, str: str}
_NUMBER = Annotated[float, Field(strict=True, allow_inf_nan=False)]
_OURS = (str, Quantity, Count, Shape, Rows, OneOrSome, OfProfile, Components)  # annotations that are not pydantic's


class _Maker(NamedTuple):
    """The class or function that makes the object of a table, from all keys but that of the `tag`."""

    make: Make
    tag: str


_parameters = cache(parameters_of)  # of a profile for each of its quantities
_MAKERS: dict[type, _Maker] = {}  # by the table
_TYPES: dict[type, Any] = {}  # of values in a file, by the class of their objects
OVER_TIME: dict[str, Any] = {}  # types of quantities over time by their kinds: gbeam.scenario.schema.profile


def table_of(
    make: Make,
    *declaring: Make,
    name: str = "",
    tag: tuple[str, str] | None = None,
    known: bool = False,
    without: Collection[str] = (),
    optional: Collection[str] = (),
    types: Mapping[str, Any] | None = None,
    changed: Mapping[str, tuple[Any, Any]] | None = None,
    base: type[Table] = Table,
    of: str = "",
    about: str = "",
) -> Any:
    """Return the table of the parameters of what makes its objects, or of the classes and functions `declaring` them.

    `tag` is a key with the word that tells the table from others in its place, such as shape and rectangle; it may be
    left out where the table is `known` by its other keys. Parameters `without` a key are left to who makes the object,
    and those that are `optional` follow from others. A key has one of the `types` where a file has others than Python;
    types and declarations of keys that a signature cannot say are `changed`. A parameter called as a word of Python
    with an underscore, such as ``from_``, is that word in the file. `of` is the kind of quantity of which a profile is;
    `about` describes the table in place of the docstring's first sentence.
    """
    fields: dict[str, Any] = {}
    tagged: dict[str, Any] = {}
    if tag is not None:
        default = tag[1] if known else ...
        tagged[tag[0]] = (Literal[tag[1]], Field(default=default, description=f"name of the {tag[0]}"))
    title = name or make.__name__
    for source in declaring or (make,):
        factories = _factories(source)
        for key, parameter in _parameters(unwrap(source)).items():
            if key in without:
                continue
            if key in optional:
                parameter = replace(parameter, default=None)
            own_title = f"{title}{key.title().replace('_', '')}"
            written = (types or {}).get(key) or value_type(parameter.hint, own_title, of)
            fields[key] = _field(parameter, written, factories.get(key))
    of_file = dict(changed or {})
    fields = tagged | {key: declaration for key, declaration in of_file.items() if key not in fields} | fields | of_file
    module = sys.modules[sys._getframe(1).f_globals["__name__"]]
    about = about or (getdoc(make) or "").partition("\n\n")[0].partition("  #")[0].removeprefix("Return ")
    doc = about[:1].upper() + about[1:]
    table = create_model(title, __base__=base, __module__=module.__name__, __doc__=doc, **fields)
    registered = vars(module).setdefault(title, table)  # by which it is pickled
    assert registered is table, f"{module.__name__} has another {title}"
    _MAKERS[table] = _Maker(make, "" if tag is None else tag[0])
    return table


def makes(table: type[Table], make: Make) -> type[Table]:
    """Declare the class or function that makes the objects of a table that follows from no signature; return it."""
    _MAKERS[table] = _Maker(make, "")
    return table


def read_as(kind: type, written: Any) -> Any:
    """Declare the type of values in a file that become objects of a class, and return it."""
    _TYPES[kind] = written
    return written


def chosen(key: str, tables: Mapping[str, Any], tag_of: Callable[[Any], Any] | None = None) -> Any:
    """Return the type of a value that is one of several tables: by a key, or by what a function says of the value."""
    if tag_of is None:
        return Annotated[reduce(or_, tables.values()), Discriminator(key)]
    types = (Annotated[table, Tag(tag)] for tag, table in tables.items())
    return Annotated[reduce(or_, types), Discriminator(tag_of)]


def object_of(parts: Collector, where: str, value: Any) -> Any:
    """Return the object of a table, or of a list or mapping of them, or None if one is refused, with why in `parts`."""
    if isinstance(value, (list, tuple)):
        return tuple(object_of(parts, f"{where}[{i}]", entry) for i, entry in enumerate(value))
    if isinstance(value, Mapping):
        return {key: object_of(parts, f"{where}.{key}", entry) for key, entry in value.items()}
    if not isinstance(value, BaseModel):
        return value
    maker = _MAKERS[type(value)]
    errors_before = len(parts.errors)
    arguments = arguments_of(parts, where, value, {maker.tag})
    return parts.attempt(where, maker.make, **arguments) if len(parts.errors) == errors_before else None


def arguments_of(parts: Collector, where: str, table: BaseModel, without: Collection[str] = ()) -> dict[str, Any]:
    """Objects of the values that are written in a table, by their keys as names of parameters."""
    keys = zip(fields_of(type(table)), type(table).model_fields, strict=True)
    names = [(key, name) for key, name in keys if name in table.model_fields_set and name not in without]
    written = [(key, name, getattr(table, name)) for key, name in names]
    return {name: object_of(parts, f"{where}.{key}", value) for key, name, value in written if value is not None}


def _factories(make: Make) -> dict[str, Callable[[], Any]]:
    """Functions that give the defaults of parameters, by name."""
    if not dataclasses.is_dataclass(make):
        return {}
    fields = dataclasses.fields(make)
    return {field.name: field.default_factory for field in fields if field.default_factory is not dataclasses.MISSING}


def _field(parameter: Parameter, written: Any, factory: Callable[[], Any] | None) -> tuple[Any, Any]:
    """Type, and declaration, of a key whose values are `written` in a file."""
    about: dict[str, Any] = {"description": parameter.words}
    if parameter.name.endswith("_"):
        about["alias"] = parameter.name.removesuffix("_")
    if parameter.required:
        return written, Field(**about)
    if factory is not None and isinstance(written, type) and issubclass(written, Table):
        return written, Field(default_factory=written, **about)
    if _is_mapping(written):
        return written, Field(default_factory=dict, **about)
    default = factory() if factory is not None else parameter.default
    return (written | None if default is None else written), Field(default=default, **about)


def _is_mapping(written: Any) -> bool:
    """True for the type of values by names that the user gives."""
    return _origin(written) is dict


def _is_list(written: Any) -> bool:
    """True for the type of a list."""
    return _origin(written) is tuple


def _origin(written: Any) -> Any:
    """The generic class of a type without its annotations, such as tuple, or None of others."""
    return get_origin(written.__origin__ if get_origin(written) is Annotated else written)


def value_type(hint: Any, title: str, of: str = "", quantity: Quantity | None = None) -> Any:
    """Type of the values in a file for the type of a parameter; `title` names a table of its own."""
    origin, parts = get_origin(hint), get_args(hint)
    if origin is Annotated:
        return _annotated(hint.__origin__, hint.__metadata__, title, of, quantity)
    if hint is not ArrayLike and origin in (Union, types.UnionType):
        return _alternatives([part for part in parts if part is not type(None)], title, of, quantity)
    if hint in _TYPES:
        return _TYPES[hint]
    if origin is Literal:
        return hint
    if origin is tuple and Ellipsis not in parts:
        return tuple.__class_getitem__(tuple(value_type(part, title, of, quantity) for part in parts))
    if origin in _LISTS:
        return _list_of(value_type(parts[0], title, of, quantity))
    if origin in (Mapping, dict):
        entry = value_type(parts[1], title, of, quantity)
        return Annotated[dict.__class_getitem__((str, entry)), Field(max_length=ENTRIES)]
    return _PLAIN.get(hint) or _number(quantity)


def _annotated(hint: Any, metadata: tuple[Any, ...], title: str, of: str, quantity: Quantity | None) -> Any:
    """Type of values by the annotations of a parameter's type; those of pydantic are kept."""
    marks: dict[type, Any] = {type(mark): mark for mark in metadata}
    quantity = next((mark for mark in metadata if isinstance(mark, Quantity)), quantity)
    if OfProfile in marks:
        quantity = marks[OfProfile].quantity(of)
    if Components in marks:
        assert quantity is not None
        return _by_components(title, marks[Components], hint, quantity)
    if Count in marks:
        return Annotated[StrictInt, Field(ge=marks[Count].least, le=marks[Count].most)]
    if OneOrSome in marks:
        return _one_or_some(_array(_number(quantity), marks[OneOrSome].sizes), len(marks[OneOrSome].sizes))
    if Shape in marks:
        return _array(_number(quantity), marks[Shape].sizes)
    if Rows in marks:
        return _list_of(_array(_number(quantity), (marks[Rows].size,)))
    if quantity is not None and str in get_args(hint):  # texts that the quantity keeps, such as times of day
        return Annotated[hint, quantity]
    other_marks = (mark for mark in metadata if not isinstance(mark, _OURS))
    annotated = value_type(hint, title, of, quantity)
    for mark in other_marks:
        annotated = Annotated[annotated, mark]
    return annotated


def _number(quantity: Quantity | None) -> Any:
    """Type of a number: of a quantity with its unit."""
    return _NUMBER if quantity is None else Annotated[float, quantity]


def _alternatives(parts: Sequence[Any], title: str, of: str, quantity: Quantity | None) -> Any:
    """Type of a value that has one of several types: of a number or a profile, a profile of its quantity."""
    if Profile in parts and quantity is not None:
        return OVER_TIME[quantity.kind]
    listed = any(get_origin(part) in _LISTS for part in parts)  # and so are arrays of NumPy, in a file
    kinds = dict.fromkeys(
        value_type(part, title, of, quantity) for part in parts if not (listed and get_origin(part) is ndarray)
    )
    if len(kinds) == 2 and listed:
        one, list_type = sorted(kinds, key=_is_list)
        if not _is_list(one):  # by tags, or a value that is neither would be refused twice
            return Annotated[Annotated[one, Tag("one")] | Annotated[list_type, Tag("list")], ONE_OR_LIST]
    return reduce(or_, kinds)


def _array(number: Any, sizes: tuple[int, ...]) -> Any:
    """Type of an array of these sizes, as lists in lists."""
    array = number
    for size in reversed(sizes):
        array = tuple.__class_getitem__((array,) * size)
    return array


def _list_of(entry: Any) -> Any:
    """Type of a list of any length."""
    return Annotated[tuple.__class_getitem__((entry, ...)), Field(max_length=ENTRIES)]


def _one_or_some(one: Any, depth: int) -> Any:
    """Type of one value, a number or lists so many deep, or of a list of such values."""
    list_type: Any = Annotated[tuple.__class_getitem__((one, ...)), Field(min_length=1, max_length=ENTRIES)]

    def tag(value: Any) -> str:
        for _ in range(depth):
            value = value[0] if isinstance(value, (list, tuple)) and value else None
        return "list" if isinstance(value, (list, tuple)) else "one"

    return Annotated[Annotated[one, Tag("one")] | Annotated[list_type, Tag("list")], Discriminator(tag)]


def _by_components(title: str, words: Components, hint: Any, quantity: Quantity) -> Any:
    """Table of the components of a vector; those of a profile, and of a mapping by axes, may be left out."""
    varies, by_axis = Profile in get_args(hint), get_origin(hint) in (Mapping, dict)
    component: Any = OVER_TIME[quantity.kind] if varies else Annotated[float, quantity]
    default: Any = ...
    if varies or by_axis:
        component, default = component | None, None
    fields: dict[str, Any] = {}
    for axis, description in (("x", words.x), ("y", words.y), ("z", words.z)):
        if description:
            fields[axis] = (component, Field(default=default, description=description))
    base = Vector if varies else Table
    table = create_model(title, __base__=base, __module__=__name__, __doc__=words.about, **fields)
    globals()[title] = table  # by which it is pickled
    make: Make = vector
    if not varies:
        make = dict if by_axis else _triple
    _MAKERS[table] = _Maker(make, "")
    return table


def _triple(*, x: float, y: float, z: float) -> tuple[float, float, float]:
    return x, y, z
