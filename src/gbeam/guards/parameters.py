"""Parameters of classes and functions as they are declared in their signatures, and docstrings that tell them."""

from __future__ import annotations

import collections.abc
import re
import types
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from inspect import Parameter as Argument
from inspect import cleandoc, signature, unwrap
from textwrap import fill
from typing import Annotated, Any, Literal, Union, Unpack, get_args, get_origin, get_type_hints

from gbeam.guards.kinds import Kinds
from gbeam.guards.quantities import OfCoordinate, OfKind, OneOrSome, Quantity, Rows, Shape

SECTION = "Parameters\n----------\n"
_FOLLOWING = re.compile(r"^(Returns|Yields|Attributes|Raises|Notes|See Also|References|Examples)\n-+$", re.MULTILINE)
_WORD = re.compile(r"[A-Za-z_]\w*")
_WIDTH = 112
_MANY = 6  # keys of a dictionary, of which more are not listed
_NUMERIC = (float, int, Any)  # types of numbers
_PLAIN = {float: "float", int: "int", bool: "bool", str: "str", Any: "object"}
_LISTS = {list: "list", tuple: "tuple", collections.abc.Sequence: "sequence", collections.abc.Iterable: "iterable"}


@dataclass(frozen=True)
class Parameter:
    """A parameter as it is declared."""

    name: str
    hint: Any  # its type, with all annotations
    words: str  # what it is, beginning with a small letter and without a full stop; empty if it says nothing
    default: Any  # inspect.Parameter.empty where it must be given
    quantity: Quantity | None  # that its numbers are; None if they are none
    of_coordinate: OfCoordinate | None = None  # quantities of which they are, by the coordinate

    @property
    def required(self) -> bool:
        """True if it must be given."""
        return self.default is Argument.empty

    def check(self, value: Any) -> None:
        """Raise InputError unless a value that is a number, or numbers, has the quantity's sign and range."""
        if self.quantity is None:
            return
        kinds = (kind for kind in alternatives(self.hint) if kind not in _NUMERIC)
        if not isinstance(value, tuple(kind for kind in kinds if isinstance(kind, type))):  # None, a profile over time
            self.quantity.check(self.name, value)


def parameters_of(declaring: Callable[..., Any]) -> dict[str, Parameter]:
    """Parameters of a class or function by name; names that only type checkers import are Any."""
    declaring = unwrap(declaring)
    hints = resolved_hints(_annotated(declaring))
    return {
        name: _parameter(name, hints.get(name, Any), argument.default)
        for name, argument in signature(declaring).parameters.items()
        if argument.kind is not Argument.VAR_KEYWORD and name not in ("self", "cls")
    }


def declares(function: Callable[..., Any]) -> bool:
    """True if an annotation of a class or function says more than a type. No annotation is evaluated to see this."""
    annotated = _annotated(function)
    names = unwrap(annotated).__globals__
    for annotation in map(str, annotated.__annotations__.values()):
        if "Annotated[" in annotation or any(_is_annotated(names.get(word)) for word in _WORD.findall(annotation)):
            return True
    return False


def _is_annotated(hint: Any) -> bool:
    return get_origin(hint) is Annotated


def kind_of_argument(declaring: Callable[..., Any], name: str, arguments: Mapping[str, Any]) -> Kinds:
    """Return the kinds of quantity of an argument of a class or function, or empty if it has none.

    They are those of its annotation, or of :func:`gbeam.guards.kinds.kinds`, which may follow from the other
    `arguments`.
    """
    declaring = unwrap(declaring)
    derived = getattr(declaring, "__kinds__", {})
    if name not in derived:
        return _annotated_kinds(declaring).get(name, "")
    declared = derived[name]
    return declared(arguments) if callable(declared) else declared


@cache
def _annotated_kinds(declaring: Callable[..., Any]) -> dict[str, str]:
    """Kinds of the arguments of a class or function by name, as annotations say them, and of keywords unpacked."""
    kinds: dict[str, str] = {}
    for name, hint in resolved_hints(_annotated(declaring)).items():
        kinds |= kinds_of_entries(*get_args(hint)) if get_origin(hint) is Unpack else {name: _kind(hint)}
    return kinds


def kinds_of_entries(typed_dict: type) -> dict[str, str]:
    """Return the kinds of the entries of a TypedDict by name, or empty where there is none."""
    return {name: _kind(hint) for name, hint in get_type_hints(typed_dict, include_extras=True).items()}


def _kind(hint: Any) -> str:
    """Kind of quantity that a type says, or empty if it says none."""
    return next((mark.kind for mark in _annotations(hint) if isinstance(mark, (Quantity, OfKind))), "")


def _annotated(declaring: Callable[..., Any]) -> Callable[..., Any]:
    """The function that has the annotations: of a class its constructor."""
    return declaring.__init__ if isinstance(declaring, type) else declaring  # type: ignore[misc]


def _parameter(name: str, hint: Any, default: Any) -> Parameter:
    """A parameter by the annotations of its type."""
    marks = hint.__metadata__ if get_origin(hint) is Annotated else ()
    words = next((mark for mark in marks if isinstance(mark, str)), "")
    quantity = next((mark for mark in _annotations(hint) if isinstance(mark, Quantity)), None)
    of_coordinate = next((mark for mark in marks if isinstance(mark, OfCoordinate)), None)
    return Parameter(name, hint, words, default, quantity, of_coordinate)


def resolved_hints(function: Callable[..., Any]) -> dict[str, Any]:
    """Types of the arguments of a function by name, with annotations; names that cannot be resolved are Any."""
    unresolved: dict[str, Any] = {}
    while True:
        try:
            return get_type_hints(function, localns=unresolved, include_extras=True)
        except NameError as error:
            unresolved[str(error.name)] = Any


def _annotations(hint: Any) -> Iterator[Any]:
    """Annotations of a type at any depth, outer ones first."""
    if get_origin(hint) is Annotated:
        yield from hint.__metadata__
        yield from _annotations(hint.__origin__)
        return
    for part in get_args(hint) if get_origin(hint) is not Literal else ():
        yield from _annotations(part)


def alternatives(hint: Any) -> tuple[Any, ...]:
    """Types among which a type lets choose; ArrayLike, which is a union too, stays one type."""
    from numpy.typing import ArrayLike

    if get_origin(hint) is Annotated:
        return alternatives(hint.__origin__)
    parts = get_args(hint) if get_origin(hint) in (Union, types.UnionType) else (hint,)
    of_arrays = set(get_args(ArrayLike)) & set(parts)
    if len(of_arrays) < 2:
        return parts
    return (*(part for part in parts if part not in of_arrays), ArrayLike)


def with_parameters(docstring: str, parameters: Mapping[str, Parameter]) -> str:
    """Return a docstring with a section of its parameters, before its other sections, if they have words."""
    if not any(parameter.words for parameter in parameters.values()):
        return docstring
    text = cleandoc(docstring)
    next_section = _FOLLOWING.search(text)
    place = next_section.start() if next_section else len(text)
    section = SECTION + "\n".join(map(_entry, parameters.values()))
    return "\n\n".join(filter(None, (text[:place].rstrip(), section, text[place:])))


def _entry(parameter: Parameter) -> str:
    """Name, type, unit and words of a parameter as numpydoc has them."""
    kind = [type_words(parameter.hint)]
    if parameter.quantity is not None:
        kind[0] = kind[0].replace("object", "float")  # of any kind of number, JAX's among them
        kind += [parameter.quantity.unit] if parameter.quantity.unit else []
    if parameter.of_coordinate is not None:
        kind.append(parameter.of_coordinate.unit)
    if not parameter.required:
        kind.append("optional")
    return f"{parameter.name} : {', '.join(kind)}" + (f"\n{_sentence(parameter)}" if parameter.words else "")


def _sentence(parameter: Parameter) -> str:
    """Words of a parameter as a sentence in indented lines; a symbol or a choice at their beginning stays small."""
    words, choices = parameter.words, literals(parameter.hint)
    if re.match("[a-z]{2}|a ", words) and words.partition(":")[0] not in choices:
        words = words[0].upper() + words[1:]
    return fill(f"{words}.", _WIDTH, initial_indent=" " * 4, subsequent_indent=" " * 4, break_on_hyphens=False)


def literals(hint: Any) -> tuple[Any, ...]:
    """Words among which a type lets choose, at any depth."""
    if get_origin(hint) is Literal:
        return get_args(hint)
    parts = (hint.__origin__,) if get_origin(hint) is Annotated else get_args(hint)
    return tuple(word for part in parts for word in literals(part))


def type_words(hint: Any) -> str:
    """A type in words: its shape where that is declared, and no None."""
    from numpy.typing import ArrayLike

    marks = [*hint.__metadata__] if get_origin(hint) is Annotated else []
    for mark in marks:
        if isinstance(mark, Shape):
            sizes = ", ".join(map(str, mark.sizes))
            return f"({sizes},) of float" if len(mark.sizes) == 1 else f"({sizes}) of float"
        if isinstance(mark, Rows):
            return f"(n, {mark.size}) of float"
        if isinstance(mark, OneOrSome):
            one = f"({', '.join(map(str, mark.sizes))}) of float" if mark.sizes else "float"
            return f"{one}, or a sequence of them"
    if marks:
        return type_words(hint.__origin__)
    if hint is ArrayLike:
        return "array_like"
    origin, parts = get_origin(hint), get_args(hint)
    if origin in (Union, types.UnionType):
        kinds = (alternative for alternative in alternatives(hint) if alternative is not type(None))
        return " or ".join(sorted(dict.fromkeys(map(type_words, kinds)), key=lambda words: words.startswith("dict")))
    if origin is Literal:
        return f"{{{', '.join(map(repr, parts))}}}"
    if origin in _LISTS:
        return f"{_LISTS[origin]} of {type_words(parts[0])}" if parts else _LISTS[origin]
    if origin in (dict, Mapping, collections.abc.Mapping):
        keys = "str" if len(get_args(parts[0])) > _MANY else type_words(parts[0])
        return f"dict of {keys} to {type_words(parts[1])}"
    if getattr(origin, "__name__", "") == "ndarray":
        return "ndarray"
    return _PLAIN.get(hint, getattr(hint, "__name__", str(hint)))
