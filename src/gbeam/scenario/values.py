"""Values of a scenario: their paths, and distributions in place of one, ``{ normal = ["70 GPa", "2 GPa"] }``."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from gbeam.errors import InputError
from gbeam.guards.units import NUMBER
from gbeam.printable import closest

Path = tuple[str | int, ...]

_STEP = re.compile(r"([^.\[\]=\s]+)((?:\[[0-9]{1,9}\])*)")


@dataclass(frozen=True)
class Span:
    """A stretch of one line: `line` and `column` count from 1, in characters. `end` is past its last."""

    line: int
    column: int
    end: int


@dataclass(frozen=True)
class Place:
    """Places of an entry's key and value. Elements of lists have the value's twice, tables with a header its name."""

    key: Span
    value: Span


def path_text(path: Path) -> str:
    """Write a path: ``("beam", "masses", 0, "at")`` is ``beam.masses[0].at``."""
    text = "".join(f"[{step}]" if isinstance(step, int) else f".{step}" for step in path)
    return text.removeprefix(".")


def parse_path(text: str) -> Path | None:
    """Read a path, or None if `text` is not one."""
    path: Path = ()
    for part in text.split("."):
        match = _STEP.fullmatch(part)
        if match is None:
            return None
        path += (match[1], *(int(index) for index in re.findall(r"\d+", match[2])))
    return path


def walk(node: Any, closed: Callable[[Any], bool], path: Path = ()) -> Iterator[tuple[Path, Any]]:
    """Yield path and value of all below a node but tables and lists; of those, only the `closed`, not looked into."""
    if closed(node) or not isinstance(node, (dict, list)):
        yield path, node
        return
    for step, value in node.items() if isinstance(node, dict) else enumerate(node):
        yield from walk(value, closed, (*path, step))


def written_at(data: Any, path: Path) -> Any:
    """Return what a parsed scenario holds at `path`, None if nothing."""
    for step in path:
        try:
            data = data[step]
        except (LookupError, TypeError):
            return None
    return data


@dataclass(frozen=True)
class Family:
    """A named family of distributions."""

    arguments: tuple[str, ...]  # meanings of its numbers, for messages
    # Functions of the numbers:
    fault: Callable[..., str]  # words for the numbers that are needed instead; empty if they are sound
    centre: Callable[..., float]  # value where nothing is drawn
    law: Callable[..., tuple[Any, ...]]  # name and arguments of SciPy's distribution


FAMILIES = {
    "normal": Family(
        ("mean", "standard deviation"),
        lambda _, spread: "" if spread > 0 else "a standard deviation above zero",
        lambda mean, _: mean,
        lambda mean, spread: ("norm", mean, spread),
    ),
    "lognormal": Family(
        ("median", "standard deviation of the logarithm"),
        lambda median, spread: "" if median > 0 and spread > 0 else "a median and a spread above zero",
        lambda median, _: median,
        lambda median, spread: ("lognorm", spread, 0.0, median),
    ),
    "uniform": Family(
        ("from", "to"),
        lambda low, high: "" if high > low else "a range that ascends",
        lambda low, high: (low + high) / 2,
        lambda low, high: ("uniform", low, high - low),
    ),
    "triangular": Family(
        ("from", "most likely", "to"),
        lambda low, mode, high: "" if low <= mode <= high and low < high else "three values that ascend",
        lambda _low, mode, _high: mode,
        lambda low, mode, high: ("triang", (mode - low) / (high - low), low, high - low),
    ),
}


@dataclass(frozen=True)
class Distribution:
    """A distribution of one value. `arguments` are in `unit`, and `words` are these as they were written."""

    family: str
    arguments: tuple[float, ...]
    unit: str
    words: str

    def __str__(self) -> str:
        return f"{self.family}({self.words})"

    @property
    def centre(self) -> str | float:
        """Mean, median, midpoint or most likely value, as a scenario writes it."""
        value = FAMILIES[self.family].centre(*self.arguments)
        return with_unit(value, self.unit) if self.unit else value

    def quantile(self, probability: Any) -> Any:
        """Quantiles (n,) at probabilities (n,)."""
        from scipy import stats  # half a second

        name, *arguments = FAMILIES[self.family].law(*self.arguments)
        return getattr(stats, name).ppf(probability, *arguments)


def read_distribution(family: str, parts: Sequence[str]) -> Distribution:
    """Read a distribution from its name and its numbers."""
    law = FAMILIES.get(family)
    if law is None:
        match = closest(family, FAMILIES)
        fix = f"did you mean {match!r}?" if match else f"choose {', '.join(FAMILIES)}"
        raise InputError("", f"has the unknown distribution {family!r}", fix)
    words = ", ".join(part.strip() for part in parts)
    if len(parts) != len(law.arguments):
        raise InputError(
            "", f"has {len(parts)} values in {family}({words})", f"give {len(law.arguments)}: {_argument_words(law)}"
        )
    if family == "lognormal":
        (median,), unit = quantities(parts[:1])
        (spread,), spread_unit = quantities(parts[1:])
        if spread_unit:
            raise InputError("", f"has a spread in {spread_unit}", "the logarithm's has no unit")
        arguments = [median, spread]
    else:
        arguments, unit = quantities(parts)
    fault = law.fault(*arguments)
    if fault:
        raise InputError("", f"has {family}({words})", f"give {fault}")
    return Distribution(family, tuple(arguments), unit, words)


def find_distributions(data: Mapping[str, Any]) -> Iterator[tuple[Path, str, Any]]:
    """Yield path, family and numbers of every table, outside the scenario's sweep, that stands for a distribution."""
    for key, table in data.items():
        for path, node in walk(table, _is_distribution, (key,)):
            if key != "sweep" and _is_distribution(node):
                yield path, *next(iter(node.items()))


def _is_distribution(node: Any) -> bool:
    """True if a table stands for a distribution, whose name may be misspelt."""
    name, numbers = next(iter(node.items())) if isinstance(node, dict) and len(node) == 1 else ("", None)
    return name in FAMILIES or (isinstance(numbers, list) and bool(closest(name, FAMILIES)))


def from_table(name: str, numbers: Any) -> Distribution:
    """Read a distribution from a table ``{ name = numbers }``, of any types."""
    family = FAMILIES.get(name)
    if family is not None and not _are_numbers(numbers):
        raise InputError("", f"has no list of numbers in {name}", f"write {{ {name} = [{_argument_words(family)}] }}")
    return read_distribution(name, [number if isinstance(number, str) else repr(number) for number in numbers])


def _are_numbers(numbers: Any) -> bool:
    """True for a list of numbers and texts."""
    if not isinstance(numbers, list):
        return False
    return all(isinstance(number, (str, int, float)) and not isinstance(number, bool) for number in numbers)


def quantities(parts: Sequence[str]) -> tuple[list[float], str]:
    """Numbers of texts, and the one unit that those with a unit share; InputError if there are several."""
    values, units = [], []
    for part in parts:
        match = NUMBER.fullmatch(part)
        if match is None or not math.isfinite(float(match[1])):
            raise InputError("", f"has {part.strip()!r}, which is no number", 'write it such as "4 g/s"')
        values.append(float(match[1]))
        units.append(match[2])
    named = sorted({unit for unit in units if unit})
    if len(named) > 1:
        raise InputError("", f"has values in {' and in '.join(named)}", "write them in one unit")
    return values, named[0] if named else ""


def with_unit(value: float, unit: str) -> str:
    """Write a value for a scenario, with its unit; whole numbers without a decimal point."""
    number = str(int(value)) if value.is_integer() and abs(value) < 1e15 else repr(value)
    return f"{number} {unit}" if unit else number


def _argument_words(family: Family) -> str:
    return ", ".join(family.arguments)
