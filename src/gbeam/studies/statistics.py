"""Statistics of a figure with their confidence: mean, spread, quantiles, probability, Sobol indices.

Every bound is of 95 % confidence for independent draws; samples that are spread evenly (sobol, latin) estimate a smooth
figure better than their bounds say.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from gbeam.results.cases import (
    BOUNDS,
    CONFIDENCE,
    MEAN,
    PROBABILITY,
    QUANTILES,
    SPREAD,
    Indices,
    Statistics,
)
from gbeam.results.result import Floats

RESAMPLES = 200  # of the bootstrap of Sobol indices
TOGETHER = 10  # of them at once, to bound their memory
LEAST = 8  # base samples from which indices are estimated


def statistics(values: Floats, *, truth: bool = False) -> Statistics:
    """Estimate the distribution of independent draws (..., n). NaN, of cases without a figure, are left out.

    The mean's bounds are Student's. The standard deviation's come from the fourth moment. A quantile's are order
    statistics, of a binomial number, and NaN where there are too few draws. Those of a probability, of a `truth` that
    is 0 or 1, are Clopper and Pearson's.
    """
    names = (PROBABILITY,) if truth else (MEAN, SPREAD, *QUANTILES)
    estimates = np.full((*values.shape[:-1], len(names), len(BOUNDS)), math.nan)
    count = np.isfinite(values).sum(axis=-1)
    for size in np.unique(count[count > 0]):
        chosen = count == size  # all figures with as many draws at once
        draws = np.sort(values[chosen], axis=-1)[..., :size]  # NaN is last
        estimates[chosen] = _probability(draws) if truth else _moments_and_quantiles(draws)
    return Statistics(names, estimates, count)


def _probability(draws: Floats) -> Floats:
    """Share of ones among draws (m, n), with its lower and upper bound, (m, 1, 3)."""
    from scipy.stats import beta

    n = draws.shape[-1]
    ones = draws.sum(axis=-1)
    tail = (1 - CONFIDENCE) / 2
    low = np.where(ones > 0, beta.ppf(tail, ones, n - ones + 1), 0.0)
    high = np.where(ones < n, beta.ppf(1 - tail, ones + 1, n - ones), 1.0)
    return np.stack([ones / n, low, high], axis=-1)[:, None]


def _moments_and_quantiles(draws: Floats) -> Floats:
    """Mean, standard deviation and q quantiles of sorted draws (m, n), with lower and upper bounds, (m, 2 + q, 3)."""
    from scipy.stats import binom, norm, t

    n, tail = draws.shape[-1], (1 - CONFIDENCE) / 2
    mean = draws.mean(axis=-1)
    rows = [np.stack([mean, np.full_like(mean, math.nan), np.full_like(mean, math.nan)], axis=-1)]
    rows.append(np.full_like(rows[0], math.nan))
    if n > 1:
        spread = draws.std(axis=-1, ddof=1)
        half = t.ppf(1 - tail, n - 1) * spread / math.sqrt(n)  # width of the confidence interval
        rows[0] = np.stack([mean, mean - half, mean + half], axis=-1)
        rows[1][:, 0] = spread
    if n > 3:
        fourth = ((draws - mean[:, None]) ** 4).mean(axis=-1)
        # Variance of the sample variance: (μ₄ − σ⁴ (n − 3)/(n − 1))/n, and that of its root from the derivative.
        variance = np.maximum(fourth - spread**4 * (n - 3) / (n - 1), 0.0) / n
        with np.errstate(invalid="ignore", divide="ignore"):
            half = np.where(spread > 0, norm.ppf(1 - tail) * np.sqrt(variance) / (2 * spread), 0.0)
        rows[1] = np.stack([spread, np.maximum(spread - half, 0.0), spread + half], axis=-1)
    for share in QUANTILES.values():
        # The draws below the quantile are a binomial number: P(X_(low) <= quantile <= X_(high)) >= the confidence.
        low, high = int(binom.ppf(tail, n, share)), int(binom.ppf(1 - tail, n, share)) + 1  # ranks, from 1
        nans = np.full_like(mean, math.nan)
        lower = draws[:, low - 1] if low >= 1 else nans
        upper = draws[:, high - 1] if high <= n else nans
        rows.append(np.stack([np.quantile(draws, share, axis=-1), lower, upper], axis=-1))
    return np.stack(rows, axis=1)


def indices(values: Floats, parameters: Sequence[str], seed: int) -> Indices:
    """Sobol indices of values (..., (d + 2) n) in the order of the sampler saltelli: A, B, and A with each column of B.

    The estimators are Saltelli's (2010) and, for the total, Jansen's (1999). Bounds are normal, with a bootstrap's
    standard error. Base samples with a NaN in one of their d + 2 cases are left out; with fewer than 8 others, or equal
    values, the indices are NaN. ``scipy.stats.sobol_indices`` would need a power of 2.
    """
    from scipy.stats import bootstrap, norm

    d = len(parameters)
    blocks = np.moveaxis(values.reshape(*values.shape[:-1], d + 2, -1), -2, -1)  # (..., n, d + 2)
    bounds = np.full((*values.shape[:-1], d, 2, len(BOUNDS)), math.nan)
    count = np.zeros(values.shape[:-1], dtype=int)
    for index in np.ndindex(values.shape[:-1]):
        complete = blocks[index][np.isfinite(blocks[index]).all(axis=-1)]
        count[index] = len(complete)
        if len(complete) < LEAST or np.ptp(complete) <= 1e-12 * np.abs(complete).max():
            continue
        samples = tuple((complete - complete.mean()).T)  # a mean far from zero would spread the estimates
        share = _first_and_total(*samples)
        spread = bootstrap(
            samples, _first_and_total, paired=True, vectorized=True, n_resamples=RESAMPLES, batch=TOGETHER,
            method="percentile", random_state=np.random.default_rng(seed),
        ).standard_error  # fmt: skip
        half = norm.ppf((1 + CONFIDENCE) / 2) * spread
        bounds[index] = np.stack([share, share - half, share + half], axis=-1)
    return Indices(tuple(parameters), bounds, count)


def _first_and_total(a: Floats, b: Floats, *mixed: Floats, axis: int = -1) -> Floats:
    """First-order and total indices (d, 2, ...) of A, B and A with each column of B, (..., n) about a mean of 0."""
    change = np.stack(mixed) - a
    variance = np.var(np.concatenate([a, b], axis=axis), axis=axis)
    parts = np.stack([np.mean(b * change, axis=axis), np.mean(change**2, axis=axis) / 2], axis=1)
    return np.divide(parts, variance, out=np.zeros_like(parts), where=variance > 0)
