"""Which values a parameter takes: a range, a list, or a distribution, each as text."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gbeam.errors import InputError
from gbeam.results.studies.sweep import Parameter
from gbeam.scenario.values.distributions import Distribution, quantities, read_distribution, written
from gbeam.scenario.values.paths import parse_path
from gbeam.scenario.values.units import NUMBER

OPTION = "--over"
_CALL = re.compile(r"\s*([a-z]+)\s*\((.*)\)\s*", re.DOTALL)
MAX_VALUES = 10_000_000  # of one parameter: 80 MB


def _scipy(name: str) -> Callable[..., Any]:
    def quantile(probability: NDArray[Any], *arguments: float) -> Any:
        from scipy import stats  # half a second

        return getattr(stats, name).ppf(probability, *arguments)

    return quantile


def _lognormal(probability: NDArray[Any], median: float, spread: float) -> Any:
    return median * np.exp(spread * _scipy("norm")(probability))


def _triangular(probability: NDArray[Any], low: float, mode: float, high: float) -> Any:
    return _scipy("triang")(probability, (mode - low) / (high - low), low, high - low)


# Inverses of the cumulative distribution functions: of probabilities (n,) and the distribution's arguments.
QUANTILES: Mapping[str, Callable[..., Any]] = {
    "normal": _scipy("norm"),
    "lognormal": _lognormal,
    "uniform": lambda probability, low, high: low + probability * (high - low),
    "triangular": _triangular,
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
    distribution : Distribution or None
        What the values are drawn from; None for a range or a list.
    """

    path: str
    texts: tuple[str, ...] = ()
    values: NDArray[Any] | None = None
    unit: str = ""
    distribution: Distribution | None = None

    def drawn(self, probability: NDArray[Any]) -> Variation:
        """The same with the values at probabilities (n,), (0, 1)."""
        assert self.distribution is not None
        quantile = QUANTILES[self.distribution.family]
        with np.errstate(over="ignore"):
            values = np.asarray(quantile(probability, *self.distribution.arguments), dtype=float)
        if not np.isfinite(values).all():
            fix = "give a smaller spread"
            raise InputError(f"{OPTION} {self.path}", f"{self.distribution} draws values beyond every number", fix)
        texts = tuple(written(float(value), self.unit) for value in values)
        return replace(self, texts=texts, values=values)

    def parameter(self, unit: str) -> Parameter:
        """The result's record of it; `unit` is the scenario's where none was written."""
        assert self.values is not None
        drawn = str(self.distribution) if self.distribution else ""
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
        with _of(path):
            return drawn_from(path, read_distribution(call[1], call[2].split(",")))
    if values.count(":") == 2 and '"' not in values:
        return _range(path, values, logarithmic=False)
    return _list(path, values)


def drawn_from(path: str, distribution: Distribution) -> Variation:
    """What is drawn from a distribution for a path."""
    return Variation(path, unit=distribution.unit, distribution=distribution)


def _range(path: str, text: str, *, logarithmic: bool) -> Variation:
    parts = text.split(":")
    if len(parts) != 3:
        raise InputError(OPTION, f"{path} has the range {text!r}", "write FROM:TO:COUNT, such as 1 m:12 m:12")
    with _of(path):
        (low, high), unit = quantities(parts[:2])
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
        with _of(path):
            values, unit = quantities(parts)
        return Variation(path, tuple(written(value, unit) for value in values), np.array(values), unit)
    return Variation(path, tuple(parts), np.array(parts, dtype=object))


@contextmanager
def _of(path: str) -> Iterator[None]:
    """Name the option and the path in the InputErrors raised inside."""
    try:
        yield
    except InputError as error:
        raise InputError(OPTION, f"{path} {error.problem}", error.fix) from None
