"""Small vibrations about an equilibrium."""

from __future__ import annotations

from typing import Any

from gbeam.report.steady.deflection import base_json
from gbeam.report.words import frequency_errors, percent, warning_lines, xyz_lists
from gbeam.results.steady.modal import Modes

ROUNDING = 1e-10  # a damping ratio smaller than this is none


def to_json(modes: Modes) -> dict[str, Any]:
    """Modes as JSON: ascending; Hz, 1/s; the shapes are complex, with the largest component 1."""
    columns = zip(modes.frequency, modes.damping_ratio, modes.direction, modes.shape, strict=True)
    errors = frequency_errors(modes.errors, len(modes.frequency))
    return {
        "outcome": "done",
        "motion": modes.motion,
        "time": modes.time,
        "model": modes.model,
        "gyroscopic": modes.gyroscopic,
        "damping_given": modes.damping_given,
        "base": base_json(modes.base),
        "stable": modes.stable,
        "modes": [
            {
                "frequency": float(frequency),
                "damping_ratio": float(ratio),
                "direction": direction,
                "shape": xyz_lists(shape.real),
                "shape_imaginary": xyz_lists(shape.imag),
                "error_estimate": error["total"],
                "errors": error,
            }
            for (frequency, ratio, direction, shape), error in zip(columns, errors, strict=True)
        ],
        "stations": modes.stations.tolist(),
        "section": {"width": modes.width.tolist(), "thickness": modes.thickness.tolist(), "round": modes.round},
        "instabilities": [
            {
                "kind": growing.kind,
                "growth_rate": growing.growth_rate,
                "frequency": growing.frequency,
                "direction": growing.direction,
            }
            for growing in modes.instabilities
        ],
        "rigid": modes.rigid,
        "overdamped": [float(value) for value in modes.overdamped],
        "warnings": list(modes.warnings),
    }


def text(modes: Modes) -> str:
    """Modes on a line each."""
    rate = float((modes.base.w_WB_B**2).sum() ** 0.5)
    lines = [f"{modes.motion} at {modes.time:.4g} s: {modes.model}, base turning at {rate:.4g} rad/s"]
    errors = [error["total"] for error in frequency_errors(modes.errors, len(modes.frequency))]
    rows = enumerate(zip(modes.frequency, modes.damping_ratio, modes.direction, errors, strict=True), 1)
    lines += [
        f"  {i:>3}  {f:12.6g} Hz  damping {z if abs(z) > ROUNDING else 0.0:8.4g}  along {d}  error {percent(e):>10}"
        for i, (f, z, d, e) in rows
    ]
    if not modes.damping_given:
        lines.append("  undamped: beam.damping_ratio is not given")
    if modes.rigid:
        lines.append("  and the free rotation of hub and beam, of zero frequency")
    lines += [
        f"  {growing.kind} along {growing.direction}: grows by {growing.growth_rate:.4g} per second"
        for growing in modes.instabilities
    ]
    return "\n".join([*lines, *warning_lines(modes)])
