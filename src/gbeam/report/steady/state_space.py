"""State-space models."""

from __future__ import annotations

from collections.abc import Iterable
from textwrap import wrap

import numpy as np

from gbeam.report.words import percent, warning_lines
from gbeam.results.state_space import ACCURATE, Gauge, StateSpace, Truncation

WIDTH = 100  # columns of the text


def text(system: StateSpace, gauges: Iterable[Gauge] = ()) -> str:
    """Names and units of the signals."""
    lines = [f"{system.motion}: {system.model}, {len(system.a)} states"]
    for what in ("states", "inputs", "outputs"):
        # No line ends between a name and its unit.
        words = (f"{signal.name} [{signal.unit}]" for signal in getattr(system, what))
        signals = ", ".join(each.replace(" ", "\N{NO-BREAK SPACE}") for each in words)
        lines += wrap(
            signals, WIDTH, initial_indent=f"  {what:<8} ", subsequent_indent=11 * " ", break_on_hyphens=False
        )
    names = {signal.name for signal in system.outputs}
    for k, gauge in enumerate(gauges, 1):
        if f"strain_{k}" in names:
            fibre = f"fibre y {1e3 * gauge.y:g} mm, z {1e3 * gauge.z:g} mm"
            lines.append(f"  strain_{k} at {gauge.at:g} m, {fibre}")
    lines += _accuracy(system)
    if system.truncation is not None:
        lines += _left_out(system, system.truncation)
    return "\n".join([*lines, *warning_lines(system), "--json prints the matrices, --out writes them for MATLAB too."])


def _left_out(system: StateSpace, left_out: Truncation) -> list[str]:
    """States left out, their share, and of a balanced truncation the bound of the error."""
    share = left_out.share
    worst = np.unravel_index(int(share.argmax()), share.shape) if share.size else (0, 0)
    count = f"{left_out.states} of {left_out.states + len(system.a)} states"
    words = f"  {left_out.method} truncation leaves out {count}"
    if share.size:
        to, by = system.outputs[worst[0]].name, system.inputs[worst[1]].name
        words += f": up to {left_out.end:.5g} Hz at most {percent(float(share[worst]))} of the largest gain"
        words += f" ({to} by {by})" if share.size > 1 else ""
    lines = [words]
    if left_out.method == "balanced":
        lines.append(f"  no gain is wrong by more than {left_out.bound:.3g}, twice the sum of the values left out, of")
        lines.append("  Hankel singular values " + " ".join(f"{value:.3g}" for value in left_out.hankel))
    return lines


def _accuracy(system: StateSpace) -> list[str]:
    """Up to which frequency its poles are those of the exact model, and how far off the others are."""
    errors, count = system.errors, len(system.frequency)
    if errors is None or not count:
        return []
    good = errors.within(ACCURATE)
    worst = percent(float(np.max(errors.total[:good]))) if good else ""
    words = f"frequencies within {worst} up to {system.accurate_to:.5g} Hz ({good} of {count})" if good else ""
    if good < count:
        known = errors.total[good:][np.isfinite(errors.total[good:])]
        beyond = f"up to {percent(float(known.max()))} off" if len(known) else "not judged"
        words += f"{'; ' if good else 'frequencies '}{'higher ones ' if good else ''}{beyond}"
    return [f"  {words}, by the exact model with more shapes and the theory of thick beams"]
