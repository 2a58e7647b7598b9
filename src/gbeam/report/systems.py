"""Results of systems of bodies in words: responses, places at rest, small vibrations."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

import numpy as np

from gbeam.report.words import (
    columns,
    largest_loads,
    number,
    percent,
    resting_loads,
    sentence,
    tidy,
    warning_lines,
)
from gbeam.results.errors import SystemErrors
from gbeam.results.system import SystemModes, SystemResponse, SystemRest, named


def system_response(response: SystemResponse) -> str:
    """The largest motions of the points, the joints at the end, what is kept, and the error."""
    lines = [f"{response.name or response.environment}: {response.outcome}"]
    lines += [f"  {sentence(response.message)}"] if response.message else []
    lines += [f"  {line}" for line in of_system(response)]
    return "\n".join([*lines, *warning_lines(response)])


def of_system(response: SystemResponse) -> Iterator[str]:
    """Sentences on points, joints, loads, energy and the error."""
    far, hard = (tidy(each, float(each.max())) for each in (response.largest, response.largest_acceleration))
    heads, across = ["point", "moves by, m", "acceleration, m/s²"], [far, hard]
    if response.residual_size is not None:
        heads.append(f"residual from {response.residual_from:g} s, m")
        across.append(tidy(response.residual_size, max(far)))
    rows = [[name, *map(number, row)] for name, *row in zip(response.points, *across, strict=True)]
    yield from columns(heads, rows)
    every = named(response)
    size = max((float(np.abs(each).max()) for each in every.values()), default=0.0)
    ends = tidy([float(each[-1]) for each in every.values()], max(size, max(far)))
    joints = ", ".join(f"{name} {number(end)}" for name, end in zip(every, ends, strict=True))
    if joints:
        yield f"at the end {joints}"
    yield from (f"{body}: {largest_loads(each.peaks)}" for body, each in response.beams.items())
    yield from (f"{body}: {line}" for body, each in response.solids.items() for line in each.lines)
    kept = response.invariants
    if kept is not None:
        first, last = (number(float(each.sum())) for each in kept.energy[[0, -1]])
        yield f"energy {first} J at the start, {last} J at the end"
    error = percent(response.error_estimate)
    known = f"estimated error {error}" if math.isfinite(response.error_estimate) else "no error estimate"
    yield f"{response.integrator}, {response.steps} steps of {1e3 * response.step:.4g} ms, {known}"
    yield from _by_beam(response.errors)


def _by_beam(errors: SystemErrors) -> Iterator[str]:
    if len(errors.by_beam):
        alone = zip(errors.beams, errors.by_beam, strict=True)
        yield f"errors by shapes and model of {', '.join(f'{name} {percent(float(each))}' for name, each in alone)}"
    if len(errors.loads_by_beam):
        each = zip(errors.beams, errors.loads_by_beam, errors.stress_by_beam, strict=True)
        listed = ", ".join(
            f"{name} {percent(float(loads))} and {percent(float(stress))}" for name, loads, stress in each
        )
        yield f"errors of root loads and of stress of {listed}"
    if math.isfinite(errors.displacement.beam_theory):
        yield f"errors by the theory of slender beams {percent(errors.displacement.beam_theory)}"


def system_rest(rests: Iterable[SystemRest]) -> str:
    """Displacements of the points at rest, and what the ground carries."""
    return "\n".join(line for each in rests for line in _rest(each))


def _rest(rest: SystemRest) -> Iterator[str]:
    yield f"{rest.name} at {rest.time:.4g} s:"
    size = float(np.abs(rest.displacement).max(initial=0.0))
    rows = [
        [name, *(f"{each:.6g}" for each in tidy(1e3 * moved, 1e3 * size))]
        for name, moved in zip(rest.points, rest.displacement, strict=True)
    ]
    yield from (f"  {line}" for line in columns(["point", "x, mm", "y, mm", "z, mm"], rows))
    force, moment = rest.ground_force, rest.ground_moment
    largest = float(np.abs(np.concatenate([force, moment])).max())
    pair = (", ".join(f"{each:.5g}" for each in tidy(vector, largest)) for vector in (force, moment))
    yield "  on the ground: force ({}) N, moment ({}) N m".format(*pair)
    for body, loads in rest.loads.items():
        yield f"  {body}: {resting_loads(loads)}"
    yield from (f"  {line}" for line in _by_beam(rest.errors))
    yield from warning_lines(rest)


def system_modes(modes: SystemModes) -> str:
    """Modes on a line each, with the bodies' shares of the kinetic energy."""
    lines = [f"{modes.name} at {modes.time:.4g} s:"]
    rows = zip(modes.frequency, modes.damping_ratio, modes.error_estimate, strict=True)
    for k, (frequency, ratio, error) in enumerate(rows):
        shares = ((share, body) for share, body in zip(modes.share[k], modes.bodies, strict=True) if share > 0.005)
        listed = ", ".join(f"{body} {share:.0%}" for share, body in sorted(shares, reverse=True))
        damping = ratio if abs(ratio) > 1e-10 else 0.0
        known = f"  error {percent(error):>7}" if math.isfinite(error) else ""
        lines.append(f"  {k + 1:>3}  {frequency:12.6g} Hz  damping {damping:8.4g}{known}  {listed}")
    if modes.rigid:
        lines.append(f"  and {modes.rigid} motions of zero frequency")
    lines += [f"  {each}" for each in modes.instabilities]
    return "\n".join([*lines, *warning_lines(modes)])
