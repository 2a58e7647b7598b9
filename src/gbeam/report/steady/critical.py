"""Critical values in words: one, or a map of hub rates against a mass and its position."""

from __future__ import annotations

import math

import numpy as np

from gbeam.report.words import error_words, percent, warning_lines
from gbeam.results.equilibrium import Critical, CriticalMap


def text(critical: Critical, motion: str) -> str:
    """The answer as one sentence, and warnings."""
    return "\n".join([f"{motion}: {answer(critical)}", *warning_lines(critical)])


def answer(critical: Critical) -> str:
    """The answer as one sentence, with its error."""
    errors, error = critical.errors, ""
    if math.isfinite(errors.total):
        error = f"; estimated error {error_words(errors)}"
    elif math.isfinite(errors.shapes):
        error = f"; estimated error from too few shapes {percent(errors.shapes)}"
    return f"{critical.reason}{error}"


def map_text(critical: CriticalMap) -> str:
    """Map as a table, positions down and masses across."""
    lines = [f"{critical.motion}: {critical.model}, critical hub rate in rad/s with one more mass"]
    lines.append("  at, m    " + "".join(f"{m:>9.4g} kg" for m in critical.mass))
    for place, speeds in zip(critical.position, critical.speed.T, strict=True):
        lines.append(f"  {place:<9.4g}" + "".join("           –" if np.isnan(v) else f"{v:12.5f}" for v in speeds))
    if np.isnan(critical.speed).any():
        lines.append(f"  –: none up to {critical.searched_to:.4g} rad/s")
    if critical.errors is not None and not np.isnan(critical.speed).all():
        shapes, total = (float(np.nanmax(each)) for each in (critical.errors.shapes, critical.errors.total))
        every = f", {percent(total)} in all" if math.isfinite(total) else ""
        lines.append(f"  estimated errors up to {percent(shapes)} from too few shapes{every}")
    return "\n".join([*lines, *warning_lines(critical)])


def map_csv(critical: CriticalMap) -> str:
    """Map as comma-separated values: a row per position, a column per mass, nan where there is none; then errors."""
    heads = ["position_m", *(f"critical_rad_per_s_with_{m:g}_kg" for m in critical.mass)]
    columns = [critical.position, *critical.speed]
    if critical.errors is not None:
        heads += [f"error_with_{m:g}_kg" for m in critical.mass]
        columns += [*critical.errors.total]
    rows = (",".join(f"{value:.12g}" for value in row) for row in zip(*columns, strict=True))
    return "\n".join([",".join(heads), *rows, ""])
