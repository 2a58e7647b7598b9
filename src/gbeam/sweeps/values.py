"""Which values a parameter takes: a range, a list, or a distribution, each as text."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gbeam.errors import InputError
from gbeam.results.sweep import Parameter
from gbeam.scenario.text.paths import parse_path
from gbeam.scenario.text.suggest import advise
from gbeam.scenario.text.units import NUMBER

OPTION = "--over"
_CALL = re.compile(r"\s*([a-z]+)\s*\((.*)\)\s*", re.DOTALL)
MAX_VALUES = 10_000_000  # of one parameter: 80 MB


@dataclass(frozen=True)
class Distribution:
    """A named distribution: its arguments, and the inverse of its cumulative distribution function.

    Parameters
    ----------
    arguments : tuple of str
        What stands in the brackets, for messages.
    quantile : callable
        Of probabilities (n,) and the arguments: values (n,).
    sound : callable
        Of the arguments: what is wrong with them, or nothing.
    """

    arguments: tuple[str, ...]
    quantile: Callable[..., Any]
    sound: Callable[..., str]


def _scipy(name: str) -> Callable[..., Any]:
    def quantile(probability: NDArray[Any], *arguments: float) -> Any:
        from scipy import stats  # half a second

        return getattr(stats, name).ppf(probability, *arguments)

    return quantile


def _lognormal(probability: NDArray[Any], median: float, spread: float) -> Any:
    return median * np.exp(spread * _scipy("norm")(probability))


def _triangular(probability: NDArray[Any], low: float, mode: float, high: float) -> Any:
    return _scipy("triang")(probability, (mode - low) / (high - low), low, high - low)


DISTRIBUTIONS = {
    "normal": Distribution(
        ("mean", "standard deviation"), _scipy("norm"), lambda _, s: "" if s > 0 else "a standard deviation above zero"
    ),
    "lognormal": Distribution(
        ("median", "standard deviation of the logarithm"),
        _lognormal,
        lambda m, s: "" if m > 0 and s > 0 else "a median and a spread above zero",
    ),
    "uniform": Distribution(
        ("from", "to"), lambda p, a, b: a + p * (b - a), lambda a, b: "" if b > a else "a range that ascends"
    ),
    "triangular": Distribution(
        ("from", "most likely", "to"),
        _triangular,
        lambda a, m, b: "" if a <= m <= b and a < b else "three values that ascend",
    ),
}


@dataclass(frozen=True)
class Variation:
    """What one ``PATH=VALUES`` says, before anything is drawn.

    Parameters
    ----------
    path : str
    texts : tuple of str
        The values as they replace the scenario's, for a range or a list.
    values : (n,) array
        The same as numbers in `unit`, or as words.
    unit : str
    distribution : str
        Name of the distribution; empty for a range or a list.
    arguments : tuple of float
        Of the distribution, in `unit`.
    words : str
        The arguments as they were written.
    """

    path: str
    texts: tuple[str, ...] = ()
    values: NDArray[Any] | None = None
    unit: str = ""
    distribution: str = ""
    arguments: tuple[float, ...] = ()
    words: str = ""

    def drawn(self, probability: NDArray[Any]) -> Variation:
        """The same with the values at probabilities (n,), (0, 1)."""
        values = np.asarray(DISTRIBUTIONS[self.distribution].quantile(probability, *self.arguments), dtype=float)
        texts = tuple(written(float(value), self.unit) for value in values)
        return replace(self, texts=texts, values=values)

    def parameter(self, unit: str) -> Parameter:
        """The result's record of it; `unit` is the scenario's where none was written."""
        assert self.values is not None
        drawn = f"{self.distribution}({self.words})" if self.distribution else ""
        numeric = np.issubdtype(self.values.dtype, np.number)
        return Parameter(self.path, self.values, (self.unit or unit) if numeric else "", drawn)


def read_variation(text: str) -> Variation:
    """Read ``PATH=VALUES``.

    Parameters
    ----------
    text : str
        VALUES is a range ``4:10:7`` (from, to, how many; ``4 g/s:10 g/s:7`` with units, ``log(1:100:5)`` in equal
        ratios), a list ``4 g/s, 6 g/s`` or ``FOAM, TLAM``, or a distribution ``normal(70 GPa, 2 GPa)``.

    Raises
    ------
    InputError
        If it cannot be read.
    """
    path, equals, values = text.partition("=")
    path = path.strip()
    if not equals or parse_path(path) is None:
        raise InputError(OPTION, f"{text!r} is not PATH=VALUES", 'write it such as "motion.centrifuge.arm=1 m:12 m:12"')
    if not values.strip():
        raise InputError(
            OPTION, f"{path} has no values", "give a range 1:12:12, a list 1, 2, 5 or normal(70 GPa, 2 GPa)"
        )
    call = _CALL.fullmatch(values)
    if call and call[1] == "log":
        return _range(path, call[2], logarithmic=True)
    if call:
        return _distribution(path, call[1], call[2])
    if values.count(":") == 2 and '"' not in values:
        return _range(path, values, logarithmic=False)
    return _list(path, values)


def written(value: float, unit: str) -> str:
    """Write a value as it replaces the scenario's: with its unit, and without a fraction that is none."""
    number = str(int(value)) if value.is_integer() and abs(value) < 1e15 else repr(value)
    return f"{number} {unit}" if unit else number


def _range(path: str, text: str, *, logarithmic: bool) -> Variation:
    parts = text.split(":")
    if len(parts) != 3:
        raise InputError(OPTION, f"{path} has the range {text!r}", "write FROM:TO:COUNT, such as 1 m:12 m:12")
    (low, high), unit = _quantities(path, parts[:2])
    try:
        count = int(parts[2])
    except ValueError:
        # The unit may stand at the very end: 4:10:7 g/s.
        match = NUMBER.fullmatch(parts[2])
        if match is None or not match[1].isdigit() or unit:
            raise InputError(OPTION, f"{path} has the count {parts[2].strip()!r}", "give a whole number") from None
        count, unit = int(match[1]), match[2]
    if count < 1:
        raise InputError(OPTION, f"{path} has {count} values", "give one or more")
    if count > MAX_VALUES:
        raise InputError(OPTION, f"{path} has {count:g} values", f"give {MAX_VALUES:g} or fewer")
    if count == 1 and low != high:
        raise InputError(OPTION, f"{path} goes from {low:g} to {high:g} in one value", "give two or more")
    if logarithmic and not low * high > 0:
        raise InputError(OPTION, f"{path} goes from {low:g} to {high:g} in equal ratios", "give two values above zero")
    values = np.geomspace(low, high, count) if logarithmic else np.linspace(low, high, count)
    # 0.1 + 0.2 is no value that anyone wants to read back.
    values = np.array([float(f"{value:.12g}") for value in values])
    return Variation(path, tuple(written(float(value), unit) for value in values), values, unit)


def _list(path: str, text: str) -> Variation:
    parts = [part.strip().strip('"') for part in text.split(",")]
    if not all(parts):
        raise InputError(OPTION, f"{path} has an empty value in {text.strip()!r}", "leave no comma without a value")
    if len(set(parts)) < len(parts):
        twice = next(part for part in parts if parts.count(part) > 1)
        raise InputError(OPTION, f"{path} has {twice!r} twice", "give each value once")
    if all(NUMBER.fullmatch(part) for part in parts):
        values, unit = _quantities(path, parts)
        return Variation(path, tuple(written(value, unit) for value in values), np.array(values), unit)
    return Variation(path, tuple(parts), np.array(parts, dtype=object))


def _distribution(path: str, name: str, text: str) -> Variation:
    known = DISTRIBUTIONS.get(name)
    if known is None:
        hint = advise(name, [*DISTRIBUTIONS, "log"])
        raise InputError(OPTION, f"{path} has the unknown distribution {name!r}", hint)
    parts = text.split(",")
    if len(parts) != len(known.arguments):
        expected = f"{name}({', '.join(known.arguments)})"
        raise InputError(OPTION, f"{path} has {len(parts)} values in {name}({text})", f"write {expected}")
    if name == "lognormal":
        (median,), unit = _quantities(path, parts[:1])
        (spread,), plain = _quantities(path, parts[1:])
        if plain:
            raise InputError(OPTION, f"{path} has a spread in {plain}", "the logarithm's has no unit")
        arguments = [median, spread]
    else:
        arguments, unit = _quantities(path, parts)
    wrong = known.sound(*arguments)
    if wrong:
        raise InputError(OPTION, f"{path} has {name}({text.strip()})", f"give {wrong}")
    return Variation(path, unit=unit, distribution=name, arguments=tuple(arguments), words=text.strip())


def _quantities(path: str, parts: list[str]) -> tuple[list[float], str]:
    """Numbers and their one unit; where some have none they have the others'."""
    values, units = [], []
    for part in parts:
        match = NUMBER.fullmatch(part)
        if match is None or not math.isfinite(float(match[1])):
            raise InputError(OPTION, f"{path} has {part.strip()!r}, which is no number", 'write it such as "4 g/s"')
        values.append(float(match[1]))
        units.append(match[2])
    given = sorted({unit for unit in units if unit})
    if len(given) > 1:
        raise InputError(OPTION, f"{path} has values in {' and in '.join(given)}", "write them in one unit")
    return values, given[0] if given else ""
