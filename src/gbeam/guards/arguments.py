"""Refusal of arguments of the wrong type, by the annotations of public functions, and conversion to SI."""

from __future__ import annotations

import functools
import os
import types
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from inspect import Parameter, signature
from typing import Annotated, Any, Literal, TypeVar, get_args, get_origin, get_type_hints, is_typeddict

from gbeam.arrays.namespace import has_unit, holds_jax, looks_at_traced
from gbeam.errors import GbeamError, InputError
from gbeam.guards.parameters import Parameter as Declared
from gbeam.guards.parameters import (
    alternatives,
    declares,
    kind_of_argument,
    parameters_of,
    resolved_hints,
    with_parameters,
)
from gbeam.guards.units import BEGINNING, in_si
from gbeam.printable import shortened
from gbeam.progress import Bar

_NUMBERS = frozenset({float, int, bool, type(None)})
_BARE = _NUMBERS | {complex, str, bytes}


def refuse_units(where: str, value: Any) -> None:
    """Raise InputError if a value, or an element of a list or mapping, is a number with a unit."""
    if type(value) in _BARE:
        return
    if has_unit(value):
        raise InputError(where, f"is {shortened(str(value), 60)}", f"give numbers without a unit, in SI{_in_si(value)}")
    listed = value.tolist() if getattr(getattr(value, "dtype", None), "kind", "") == "O" else value
    if isinstance(listed, Mapping):
        elements = {f"{where}[{key!r}]": entry for key, entry in listed.items()}
    elif isinstance(listed, (list, tuple, set)) and not _BARE.issuperset(map(type, listed)):
        elements = {f"{where}[{i}]": entry for i, entry in enumerate(listed)}
    else:
        return
    for place, element in elements.items():
        refuse_units(place, element)


def _in_si(value: Any) -> str:
    """Expression, for a message, by which a quantity of pint becomes a number in SI, or empty for another library's."""
    try:
        unit = f"{value.to_base_units().units:~}" or "dimensionless"
    except (AttributeError, ValueError):
        return ""
    hertz = "; 1 Hz is 6.2832 rad/s as an angular rate" if unit == "1 / s" else ""
    return f': .to("{unit}").magnitude{hertz}'


F = TypeVar("F", bound=Callable[..., Any])
C = TypeVar("C", bound=type)
Test = Callable[[Any], bool]
_SEQUENCES = (list, tuple, Sequence, Iterable, Collection)
_MAPPINGS = (dict, Mapping)
_NUMERIC = ("f", "i", "u")  # NumPy's letters for kinds of numbers
_OF_NUMBERS = (float, int, Any)
_PLAIN = (str, bytes, bool, int, float, complex, type(None), list, tuple, dict, set)  # shown by their repr
_WORDS = {str: "a text", bool: "True or False", int: "a whole number", float: "a number", os.PathLike: "a path"}
_MAKERS = {
    "Structure": "gbeam.assemble",
    "Case": "gbeam.read_scenario",
    "Response": "gbeam.simulate",
    "StateSpace": "gbeam.linearize",
    "Choice": "gbeam.choice_of",
}


def typed(function: F) -> F:
    """Decorate a function or class, so that it refuses arguments that do not fit its annotations.

    The error is an InputError with the argument's name. Missing and unknown arguments stay Python's TypeError. Texts
    with a unit and pint's quantities become SI where the argument has a kind of quantity
    (:func:`gbeam.guards.parameters.kind_of_argument`). Elsewhere numbers with a unit are refused. Other texts for
    numbers, and fractions for whole numbers, are refused only if the call fails: its own checks of values say more
    about them. ``progress=True`` becomes a Bar.

    Numbers whose quantity is declared in the signature have its sign and range, and parameters that are declared with
    words are told in the docstring (`gbeam.guards.parameters`).
    """
    declared = parameters_of(function) if declares(function) else {}
    function.__doc__ = with_parameters(function.__doc__ or "", declared)
    if isinstance(function, type):
        function.__init__ = _typed(function.__init__, function, declared)  # type: ignore[misc]
        return typed_methods(function)
    return _typed(function, function, declared)


def typed_methods(cls: C) -> C:
    """Let the public methods of a class that take quantities, or plain numbers, do as typed functions do.

    Bare numbers and arrays of them, which are most, go straight through.
    """
    for name, method in [*vars(cls).items()]:
        if not isinstance(method, types.FunctionType) or (name.startswith("_") and name != "__call__"):
            continue
        if not hasattr(method, "__wrapped__") and declares(method):
            setattr(cls, name, _typed(method, method, {}, method=True))
    return cls


def _typed(function: F, declaring: Callable[..., Any], declared: Mapping[str, Declared], method: bool = False) -> F:
    """The function, or constructor of the class `declaring`, with checks of its arguments."""
    kinds = (Parameter.POSITIONAL_ONLY, Parameter.POSITIONAL_OR_KEYWORD)
    parameters = signature(function).parameters.values()
    names = [parameter.name for parameter in parameters if parameter.kind in kinds]
    rest = [parameter.name for parameter in parameters if parameter.kind is Parameter.VAR_POSITIONAL]

    def name_arguments(args: tuple[Any, ...]) -> list[tuple[str, Any]]:
        pairs = list(zip(names, args, strict=False))
        for name in rest:  # at most one
            pairs += [(name, value) for value in args[len(names) :]]
        return pairs

    generates = str(signature(function).return_annotation).startswith("Iterator")  # and shows its own bar

    def check(pairs: Iterable[tuple[str, Any]], texts: bool) -> None:
        tests = _tests(function, texts, method)
        for name, value in pairs:
            refuse_units(name, value)
            if name in tests and not tests[name](value):
                refused = _type_error(name, value, _hints(function, method)[name], texts)
                refused.of_type = True
                raise refused

    @functools.wraps(function)
    def call(*args: Any, **keywords: Any) -> Any:
        if method and not keywords and all(map(_is_bare, args[1:])):
            return function(*args)
        pairs = (*name_arguments(args), *keywords.items())
        if not generates and ("progress", True) in pairs:
            with Bar() as bar:
                return call(**dict(pairs) | {"progress": bar})
        if any(type(value) not in _NUMBERS for _, value in pairs):
            read = functools.partial(_read, declaring, dict(pairs))
            args = (*map(read, names, args), *args[len(names) :])
            keywords = {name: read(name, value) for name, value in keywords.items()}
            pairs = (*name_arguments(args), *keywords.items())
        check(pairs, True)
        for name, value in pairs:
            if name in declared:
                declared[name].check(value)
        try:
            return function(*args, **keywords)
        except (AttributeError, LookupError, TypeError, ValueError) as error:
            if not isinstance(error, GbeamError) or getattr(error, "of_type", False):
                check(pairs, False)
            if not isinstance(error, GbeamError) and looks_at_traced(error):
                name = next((name for name, value in pairs if _holds_jax(value)), pairs[0][0])
                fix = "give numbers: JAX follows motions, structures, systems and simulate with a given step"
                problem = f"is traced by JAX, and {declaring.__name__} looks at its numbers"
                raise InputError(name, problem, fix) from error
            raise

    return call  # type: ignore[return-value]


def _holds_jax(value: Any) -> bool:
    return bool(getattr(value, "holds_jax", False)) or holds_jax(value)


def _is_bare(value: Any) -> bool:
    """True for a number, an array of numbers of NumPy, and a plain list or mapping of these."""
    kind = type(value)
    if kind in _NUMBERS:
        return True
    if kind.__module__ == "numpy":
        return hasattr(value, "dtype") and value.dtype.kind in "fiuc"  # complex ones are steps of derivatives
    if kind not in (list, tuple, dict):
        return False
    listed = value.values() if kind is dict else value
    return _NUMBERS.issuperset(map(type, listed)) or all(map(_is_bare, listed))


def _read(declaring: Callable[..., Any], arguments: Mapping[str, Any], name: str, value: Any) -> Any:
    """Return an argument with its texts with a unit, and quantities of pint, in SI."""
    kinds = "" if _is_bare(value) else kind_of_argument(declaring, name, arguments)
    return in_si(name, value, kinds) if kinds else value


@functools.cache
def _tests(function: Callable[..., Any], texts: bool, method: bool) -> dict[str, Test]:
    """Test of every annotated argument by name; with `texts` texts pass as numbers."""
    return {name: _test(hint, texts) for name, hint in _hints(function, method).items()}


@functools.cache
def _hints(function: Callable[..., Any], method: bool) -> dict[str, Any]:
    """Types of the arguments by name. Names imported for type checkers only are Any, and so are numbers of a function.

    Numbers of a method are those of NumPy's arrays.
    """
    from numpy.typing import ArrayLike

    hints = resolved_hints(function)
    numbers = {name for name, hint in hints.items() if method and Any in alternatives(hint) and hint is not Any}
    return hints | dict.fromkeys(numbers, ArrayLike)


def _test(hint: Any, texts: bool) -> Test:
    """Return a test of values for a type hint; with `texts` it lets texts pass as numbers."""
    tests = [_single(alternative, texts) for alternative in alternatives(hint)]
    return tests[0] if len(tests) == 1 else lambda value: any(test(value) for test in tests)


def _single(kind: Any, texts: bool) -> Test:
    """Return a test of values for a type that is no union."""
    from numpy.typing import ArrayLike

    if get_origin(kind) is Annotated:
        return _test(kind.__origin__, texts)
    origin, parts = get_origin(kind) or kind, get_args(kind)
    if kind is ArrayLike:
        return lambda value: _are_numbers(value, texts)
    if isinstance(kind, TypeVar) and kind.__bound__ is not None:
        return _single(kind.__bound__, texts)
    if origin is Literal:
        return lambda value: isinstance(value, str)  # the word is checked by the function
    if origin is bool:
        return lambda value: isinstance(value, bool) or _kind(value) == "b"
    if origin is int and not texts:
        return lambda value: (isinstance(value, int) and not isinstance(value, bool)) or _kind(value) in ("i", "u")
    if origin is float or origin is int:
        return lambda value: _is_number(value, texts)
    if origin is Callable:
        return callable
    if origin in _SEQUENCES:
        wrong = _first_wrong(kind, texts)
        return lambda value: _has_elements(value, origin) and wrong(value) is None
    if is_typeddict(kind):
        entries = {name: _test(hint, texts) for name, hint in get_type_hints(kind).items()}
        # Unknown names are refused by the function.
        return lambda value: (
            isinstance(value, Mapping) and all(entries[key](member) for key, member in value.items() if key in entries)
        )
    if origin in _MAPPINGS:
        entry = _test(parts[1], texts)
        return lambda value: isinstance(value, Mapping) and all(map(entry, value.values()))
    if getattr(origin, "__name__", "") == "ndarray":
        return lambda value: _kind(value) in _NUMERIC
    if origin is Any or not isinstance(origin, type):
        return lambda value: True
    return lambda value: isinstance(value, origin) and not isinstance(value, type)


def _kind(value: Any) -> str:
    """NumPy's letter for the kind of an array's elements, or empty for no array."""
    return str(getattr(getattr(value, "dtype", None), "kind", ""))


def _is_number(value: Any, texts: bool) -> bool:
    """True for numbers, arrays and what has ``__float__``; for texts that do not begin with a number if `texts`."""
    if isinstance(value, (float, int)) or _kind(value) in _NUMERIC:
        return True
    if isinstance(value, str):
        return texts and not BEGINNING.match(value)
    return not hasattr(value, "dtype") and not isinstance(value, type) and hasattr(value, "__float__")


def _are_numbers(value: Any, texts: bool) -> bool:
    listed = value.tolist() if _kind(value) == "O" else value
    if isinstance(listed, (list, tuple)):
        return all(_are_numbers(entry, texts) for entry in listed)
    return _is_number(value, texts)


def _has_elements(value: Any, origin: Any) -> bool:
    """True for a sequence, or any iterable if `origin` is Iterable, but not for texts, mappings and types."""
    if isinstance(value, (str, bytes, Mapping, type)):
        return False
    return isinstance(value, Iterable) if origin is Iterable else hasattr(value, "__getitem__")


def _first_wrong(kind: Any, texts: bool) -> Callable[[Any], int | None]:
    """Return a function that gives the index of the first element of a wrong type in a list, or None."""
    parts = get_args(kind)
    fixed = get_origin(kind) is tuple and Ellipsis not in parts
    tests = [_test(part, texts) for part in parts if part is not Ellipsis]

    def find(value: Any) -> int | None:
        if not tests or not isinstance(value, Collection) or (_kind(value) in _NUMERIC and parts[0] in _OF_NUMBERS):
            return None  # to look at another iterable would consume it
        if fixed and len(value) != len(parts):
            return len(parts)
        return next((k for k, element in enumerate(value) if not tests[k if fixed else 0](element)), None)

    return find


def _type_error(name: str, value: Any, hint: Any, texts: bool) -> InputError:
    """Error of an argument, or of its first wrong element."""
    for kind in alternatives(hint):
        if is_typeddict(kind) and isinstance(value, Mapping):
            for key, entry in get_type_hints(kind).items():
                if key in value and not _test(entry, texts)(value[key]):
                    return _type_error(f"{name}.{key}", value[key], entry, texts)
        origin = get_origin(kind)
        if origin not in _SEQUENCES or not _has_elements(value, origin):
            continue
        parts, wrong = get_args(kind), _first_wrong(kind, texts)(value)
        if wrong is not None and wrong < len(value):
            part = parts[wrong] if origin is tuple and Ellipsis not in parts else parts[0]
            return _type_error(f"{name}[{wrong}]", list(value)[wrong], part, texts)
    if isinstance(value, type):
        value_words = f"the class {value.__name__} itself"
    else:
        value_words = shortened(repr(value), 60) if isinstance(value, _PLAIN) else f"of type {type(value).__name__}"
    expected = _type_words(hint)
    in_si = " in SI" if isinstance(value, str) and BEGINNING.match(value) and "whole" not in expected else ""
    return InputError(name, f"is {value_words}", f"give {expected}{in_si}")


def _type_words(hint: Any) -> str:
    kinds = [alternative for alternative in alternatives(hint) if alternative is not type(None)]
    words = dict.fromkeys(_word(kind) for kind in kinds)
    listed = any(word.endswith(" numbers") for word in words)
    return " or ".join(word for word in words if word != "numbers" or not listed)


def _word(kind: Any) -> str:
    """Words, for a message, for a value of a type, such as a number."""
    from numpy.typing import ArrayLike

    origin, parts = get_origin(kind) or kind, get_args(kind)
    if kind is ArrayLike or getattr(origin, "__name__", "") == "ndarray":
        return "numbers"
    if origin in _WORDS:
        return _WORDS[origin]
    if origin is Literal:
        return " or ".join(map(repr, parts))
    if origin is Callable:
        return "a function"
    if origin in _SEQUENCES:
        count = f"{len(parts)} " if origin is tuple and Ellipsis not in parts else ""
        simple = _WORDS.get(parts[0], "").partition(" ")[2]
        return f"a list of {count}{f'{simple}s' if simple else getattr(parts[0], '__name__', 'them')}"
    if is_typeddict(kind):
        return "a mapping from text"
    if origin in _MAPPINGS:
        return f"a mapping from text to {_type_words(parts[1])}"
    name = getattr(origin, "__name__", str(origin))
    if getattr(origin, "_is_protocol", False):  # such as Motion, whose docstring begins with the classes that fit
        line = str(origin.__doc__ or name).splitlines()[0].rstrip(".")
        return line[0].lower() + line[1:]
    maker = f" (from {_MAKERS[name]})" if name in _MAKERS else ""
    return f"{'an' if name[0] in 'AEIOU' else 'a'} {name}{maker}"
