"""Small vibrations about an equilibrium."""

from __future__ import annotations

from gbeam.report.words import percent, warning_lines
from gbeam.results.modal import Modes, along

RESTING = 1e-9  # rad/s: a smaller rate of a base is a profile's rounding
ROUNDING = 1e-10  # a damping ratio smaller than this is none


def text(modes: Modes) -> str:
    """Modes on a line each."""
    turning = float((modes.base.w_WB_B**2).sum() ** 0.5)
    rate = turning if turning > RESTING else 0.0
    lines = [f"{modes.motion} at {modes.time:.4g} s: {modes.model}, base turning at {rate:.4g} rad/s"]
    width = max((len(along(d)) for d in modes.direction), default=0)
    rows = enumerate(zip(modes.frequency, modes.damping_ratio, modes.direction, modes.error_estimate, strict=True), 1)
    for i, (frequency, ratio, direction, error) in rows:
        damping, way = ratio if abs(ratio) > ROUNDING else 0.0, f"{along(direction):<{width}}"
        lines.append(f"  {i:>3}  {frequency:12.6g} Hz  damping {damping:8.4g}  {way}  error {percent(error):>10}")
    if not modes.damping_given:
        lines.append("  undamped: beam.damping_ratio is not given")
    if modes.rigid:
        lines.append("  and the free rotation of hub and beam, of zero frequency")
    lines += [
        f"  {growing.kind} {along(growing.direction)}: grows by {growing.growth_rate:.4g} per second"
        for growing in modes.instabilities
    ]
    return "\n".join([*lines, *warning_lines(modes)])
