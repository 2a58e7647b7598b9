"""The cases of a sweep: combinations of ranges and lists of values, with samples of distributions."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any, get_args

import numpy as np
from numpy.typing import NDArray

from gbeam.constants import Sampler
from gbeam.errors import InputError
from gbeam.guards.limits import refuse_more
from gbeam.guards.units import NUMBER
from gbeam.results.cases import SAMPLE, Parameter
from gbeam.scenario.values import Distribution, parse_path, quantities, read_distribution, with_unit
from gbeam.sweeps import SAMPLES


@dataclass(frozen=True)
class Cases:
    """Cases in the order of the result's arrays: every combination of the grid's values with every sample."""

    grid: tuple[Variation, ...]
    drawn: tuple[Variation, ...]
    samples: int
    sampler: Sampler = "sobol"

    @property
    def variations(self) -> tuple[Variation, ...]:
        """Variations of the grid, then those that are drawn."""
        return self.grid + self.drawn

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the result's arrays, the samples last."""
        return tuple(len(variation.texts) for variation in self.grid) + ((self.samples,) if self.drawn else ())

    @property
    def independent(self) -> int:
        """Number of samples, from the first, that are independent draws; saltelli's others combine these."""
        return 2 * self.samples // (len(self.drawn) + 2) if self.sampler == "saltelli" else self.samples

    def __len__(self) -> int:
        return math.prod(self.shape)

    def overrides(self, case: int) -> tuple[str, ...]:
        """Changes of the scenario that make the case of this number."""
        index = [int(i) for i in np.unravel_index(case, self.shape)]  # the sample's, if any, is the last
        changes = [f"{variation.path}={variation.texts[i]}" for variation, i in zip(self.grid, index, strict=False)]
        changes += [f"{variation.path}={variation.texts[index[-1]]}" for variation in self.drawn]
        return tuple(changes)


def read_cases(
    over: Sequence[str],
    samples: int | None = None,
    sampler: Sampler = "sobol",
    seed: int = 0,
    distributions: Mapping[str, Distribution] | None = None,
) -> Cases:
    """Read variations ``PATH=VALUES``, and draw samples of theirs and the scenario's distributions (by path)."""
    variations = [read_variation(text) for text in over]
    paths = [variation.path for variation in variations]
    declared = distributions or {}
    variations += [drawn_from(path, distribution) for path, distribution in declared.items() if path not in paths]
    if not variations:
        raise InputError(OPTION, "is missing", 'say what varies: --over "motion.centrifuge.arm=1 m:12 m:12"')
    for path in paths:
        if paths.count(path) > 1:
            raise InputError(OPTION, f"varies {path} twice", "give all its values in one")
        if path == SAMPLE:
            raise InputError(OPTION, f"varies {path!r}, which is no key of a scenario", "check the key")
    grid = tuple(variation for variation in variations if not variation.distribution)
    drawn = tuple(variation for variation in variations if variation.distribution)
    if samples is not None and not drawn:
        raise InputError(
            "--samples", "stands without a distribution", 'draw from one: "beam.damping_ratio=uniform(0.5 %, 2 %)"'
        )
    if sampler == "saltelli" and not drawn:
        raise InputError("--sampler", "is saltelli, without a distribution", "draw from one, or leave it out")
    if not drawn:
        return Cases(grid, (), 0)
    count = SAMPLES if samples is None else samples
    if count < 1:
        raise InputError("--samples", f"is {count}", "give one or more")
    size = count * len(drawn) * (len(drawn) + 2 if sampler == "saltelli" else 1)
    refuse_more("--samples", "values", size, MAX_VALUES, 8.0, "give fewer")
    if seed < 0:
        raise InputError("--seed", f"is {seed}", "give zero or more")
    if sampler not in get_args(Sampler):
        raise InputError("--sampler", f"is {sampler!r}", f"choose {', '.join(get_args(Sampler))}")
    if sampler == "saltelli":
        unit = _saltelli(_points(count, 2 * len(drawn), "sobol", seed))
    else:
        unit = _points(count, len(drawn), sampler, seed)
    return Cases(grid, tuple(variation.sample(unit[:, k]) for k, variation in enumerate(drawn)), len(unit), sampler)


def _saltelli(points: np.ndarray) -> np.ndarray:
    """Points ((d + 2) n, d) for Sobol indices, after Saltelli (2010), from the two halves A and B of points (n, 2 d).

    They are A, B, and A with each column in turn taken from B.
    """
    a, b = np.split(points, 2, axis=1)
    mixed = []
    for column in range(a.shape[1]):
        mixed.append(a.copy())
        mixed[-1][:, column] = b[:, column]
    return np.concatenate([a, b, *mixed])


def _points(count: int, dimensions: int, sampler: str, seed: int) -> np.ndarray:
    """Points (count, dimensions) in the open unit cube, by a sampler's name."""
    from scipy.stats import qmc  # half a second

    if sampler == "sobol":
        # The first of a power of two, as only such a number is balanced; a larger number begins with the same ones.
        points = qmc.Sobol(dimensions, rng=seed).random_base2(math.ceil(math.log2(count)))[:count]
    elif sampler == "latin":
        points = qmc.LatinHypercube(dimensions, rng=seed).random(count)
    else:
        points = np.random.default_rng(seed).random((count, dimensions))
    tiny = np.finfo(float).eps
    return np.asarray(np.clip(points, tiny, 1 - tiny))


OPTION = "--over"
_CALL = re.compile(r"\s*([a-z]+)\s*\((.*)\)\s*", re.DOTALL)
MAX_VALUES = 10_000_000  # of one parameter: 80 MB


@dataclass(frozen=True)
class Variation:
    """One ``PATH=VALUES``: texts for the scenario, and `values` (n,) in `unit`, None before they are drawn."""

    path: str
    texts: tuple[str, ...] = ()
    values: NDArray[Any] | None = None
    unit: str = ""
    distribution: Distribution | None = None

    def sample(self, probability: NDArray[Any]) -> Variation:
        """Variation with the distribution's quantiles at probabilities (n,) between 0 and 1."""
        assert self.distribution is not None
        with np.errstate(over="ignore"):
            values = np.asarray(self.distribution.quantile(probability), dtype=float)
        if not np.isfinite(values).all():
            fix = "give a smaller spread"
            raise InputError(f"{OPTION} {self.path}", f"{self.distribution} draws values beyond every number", fix)
        texts = tuple(with_unit(float(value), self.unit) for value in values)
        return replace(self, texts=texts, values=values)

    def parameter(self, unit: str) -> Parameter:
        """Record of the variation in the result. `unit` is the scenario's, used where the values have none."""
        assert self.values is not None
        distribution = str(self.distribution) if self.distribution else ""
        numeric = np.issubdtype(self.values.dtype, np.number)
        return Parameter(self.path, self.values, (self.unit or unit) if numeric else "", distribution)


def read_variation(text: str) -> Variation:
    """Read ``PATH=VALUES``.

    VALUES is a range ``4:10:7`` (from, to, how many; ``4 g/s:10 g/s:7``, ``log(1:100:5)`` in equal ratios), a list ``4
    g/s, 6 g/s`` or ``FOAM, TLAM``, or a distribution ``normal(70 GPa, 2 GPa)``.
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
        with _naming_path(path):
            return drawn_from(path, read_distribution(call[1], call[2].split(",")))
    if values.count(":") == 2 and '"' not in values:
        return _range(path, values, logarithmic=False)
    return _list(path, values)


def drawn_from(path: str, distribution: Distribution) -> Variation:
    """Variation whose values are to be drawn from a distribution."""
    return Variation(path, unit=distribution.unit, distribution=distribution)


def _range(path: str, text: str, *, logarithmic: bool) -> Variation:
    """Variation of a range FROM:TO:COUNT, which includes both ends, in equal steps or, if
    `logarithmic`, equal ratios.
    """
    parts = text.split(":")
    if len(parts) != 3:
        raise InputError(OPTION, f"{path} has the range {text!r}", "write FROM:TO:COUNT, such as 1 m:12 m:12")
    with _naming_path(path):
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
    # Twelve digits, so that 0.1 + 0.2 is written as 0.3.
    values = np.array([float(f"{value:.12g}") for value in values])
    return Variation(path, tuple(with_unit(float(value), unit) for value in values), values, unit)


def _list(path: str, text: str) -> Variation:
    """Variation of a list of words, or of quantities, which share a unit."""
    parts = [part.strip().strip('"') for part in text.split(",")]
    if not all(parts):
        raise InputError(OPTION, f"{path} has an empty value in {text.strip()!r}", "leave no comma without a value")
    if len(set(parts)) < len(parts):
        repeated = next(part for part in parts if parts.count(part) > 1)
        raise InputError(OPTION, f"{path} has {repeated!r} twice", "give each value once")
    if all(NUMBER.fullmatch(part) for part in parts):
        with _naming_path(path):
            values, unit = quantities(parts)
        return Variation(path, tuple(with_unit(value, unit) for value in values), np.array(values), unit)
    return Variation(path, tuple(parts), np.array(parts, dtype=object))


@contextmanager
def _naming_path(path: str) -> Iterator[None]:
    """Name the option and the path in the InputErrors raised inside."""
    try:
        yield
    except InputError as error:
        raise InputError(OPTION, f"{path} {error.problem}", error.fix) from None
