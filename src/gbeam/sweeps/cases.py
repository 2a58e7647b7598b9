"""The cases of a sweep: every combination of the values of a grid, with every sample of what is drawn."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from gbeam.errors import InputError
from gbeam.guards.limits import refuse_more
from gbeam.results.studies.sweep import SAMPLE
from gbeam.scenario.values.distributions import Distribution
from gbeam.sweeps.values import MAX_VALUES, OPTION, Variation, drawn_from, read_variation

SAMPLERS = ("sobol", "latin", "random", "saltelli")
DEFAULT_SAMPLES = 64


@dataclass(frozen=True)
class Cases:
    """All cases, in the order of the result's arrays.

    Parameters
    ----------
    grid, drawn : tuple of Variation
        Each with its values.
    samples : int
        Zero where nothing is drawn.
    sampler : str
    """

    grid: tuple[Variation, ...]
    drawn: tuple[Variation, ...]
    samples: int
    sampler: str = "sobol"

    @property
    def variations(self) -> tuple[Variation, ...]:
        """All that varies."""
        return self.grid + self.drawn

    @property
    def shape(self) -> tuple[int, ...]:
        """Of the result's arrays."""
        return tuple(len(each.texts) for each in self.grid) + ((self.samples,) if self.drawn else ())

    @property
    def independent(self) -> int:
        """How many samples, of the first, are draws from all distributions: the others repeat parts of them."""
        return 2 * self.samples // (len(self.drawn) + 2) if self.sampler == "saltelli" else self.samples

    def __len__(self) -> int:
        return math.prod(self.shape)

    def overrides(self, case: int) -> tuple[str, ...]:
        """Changes of the scenario that make a case."""
        at = [int(i) for i in np.unravel_index(case, self.shape)]
        chosen = [(each, each.texts[i]) for each, i in zip(self.grid, at, strict=False)]  # the sample is the last
        chosen += [(each, each.texts[at[-1]]) for each in self.drawn]
        return tuple(f"{each.path}={text}" for each, text in chosen)


def read_cases(
    over: Sequence[str],
    samples: int | None = None,
    sampler: str = "sobol",
    seed: int = 0,
    distributions: Mapping[str, Distribution] | None = None,
) -> Cases:
    """Read what varies, and draw what is to be drawn.

    Parameters
    ----------
    over : sequence of str
        ``PATH=VALUES`` each: see :func:`gbeam.sweeps.values.read_variation`.
    samples : int, optional
        How many are drawn from the distributions; 64 by default.
    sampler : str
        sobol (scrambled), latin (hypercube) or random; saltelli for Sobol indices: of d distributions it makes
        samples × (d + 2) cases.
    seed : int
        The same seed draws the same samples.
    distributions : mapping of str to Distribution, optional
        Those that stand in the scenario, by path: what `over` does not vary is drawn from them.

    Raises
    ------
    InputError
        If nothing varies, a path is given twice, or there is nothing to draw the samples from.
    """
    variations = [read_variation(text) for text in over]
    paths = [each.path for each in variations]
    own = distributions or {}
    variations += [drawn_from(path, each) for path, each in own.items() if path not in paths]
    if not variations:
        raise InputError(OPTION, "is missing", 'say what varies: --over "motion.centrifuge.arm=1 m:12 m:12"')
    for path in paths:
        if paths.count(path) > 1:
            raise InputError(OPTION, f"varies {path} twice", "give all its values in one")
        if path == SAMPLE:
            raise InputError(OPTION, f"varies {path!r}, which is no key of a scenario", "check the key")
    grid = tuple(each for each in variations if not each.distribution)
    drawn = tuple(each for each in variations if each.distribution)
    if samples is not None and not drawn:
        raise InputError(
            "--samples", "stands without a distribution", 'draw from one: "beam.damping_ratio=uniform(0.5 %, 2 %)"'
        )
    if sampler == "saltelli" and not drawn:
        raise InputError("--sampler", "is saltelli, without a distribution", "draw from one, or leave it out")
    if not drawn:
        return Cases(grid, (), 0)
    count = DEFAULT_SAMPLES if samples is None else samples
    if count < 1:
        raise InputError("--samples", f"is {count}", "give one or more")
    size = count * len(drawn) * (len(drawn) + 2 if sampler == "saltelli" else 1)
    refuse_more("--samples", "values", size, MAX_VALUES, 8.0, "give fewer")
    if seed < 0:
        raise InputError("--seed", f"is {seed}", "give zero or more")
    if sampler not in SAMPLERS:
        raise InputError("--sampler", f"is {sampler!r}", f"choose {', '.join(SAMPLERS)}")
    if sampler == "saltelli":
        unit = _saltelli(_points(count, 2 * len(drawn), "sobol", seed))
    else:
        unit = _points(count, len(drawn), sampler, seed)
    return Cases(grid, tuple(each.drawn(unit[:, k]) for k, each in enumerate(drawn)), len(unit), sampler)


def _saltelli(points: np.ndarray) -> np.ndarray:
    """Two halves A and B of points (n, 2 d), and A with each column of B in turn: ((d + 2) n, d).

    Saltelli et al., Computer Physics Communications 181 (2010), 259-270, Table 2.
    """
    a, b = np.split(points, 2, axis=1)
    mixed = []
    for column in range(a.shape[1]):
        mixed.append(a.copy())
        mixed[-1][:, column] = b[:, column]
    return np.concatenate([a, b, *mixed])


def _points(count: int, dimensions: int, sampler: str, seed: int) -> np.ndarray:
    """Points in the open unit cube, (count, dimensions)."""
    from scipy.stats import qmc  # half a second

    if sampler == "sobol":
        # Of a power of two, which alone is balanced, the first: more samples later begin with the same.
        points = qmc.Sobol(dimensions, rng=seed).random_base2(math.ceil(math.log2(count)))[:count]
    elif sampler == "latin":
        points = qmc.LatinHypercube(dimensions, rng=seed).random(count)
    else:
        points = np.random.default_rng(seed).random((count, dimensions))
    tiny = np.finfo(float).eps
    return np.asarray(np.clip(points, tiny, 1 - tiny))
