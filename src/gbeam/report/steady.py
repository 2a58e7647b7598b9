"""Results of one instant in words: equilibrium and its loss, small vibrations, the state-space model."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from textwrap import wrap

import numpy as np

from gbeam.report.words import by_beam, columns, error_words, number, percent, resting_loads, tidy, warning_lines
from gbeam.results.equilibrium import Critical, CriticalMap, Deflection
from gbeam.results.errors import Errors, Noted, along
from gbeam.results.modal import Campbell, Modes
from gbeam.results.solids import SpecimenLoads
from gbeam.results.state_space import ACCURATE, Gauge, StateSpace, Truncation
from gbeam.results.system import SystemModes, SystemRest


def deflection(deflections: Iterable[Deflection]) -> str:
    """Deflections on two lines each."""
    return "\n".join(map(_deflection, deflections))


def _deflection(deflection: Deflection) -> str:
    if deflection.specimen is not None:
        return _rigid(deflection, deflection.specimen)
    x, y, z = tidy(1e3 * deflection.tip, 1e3 * float(np.abs(deflection.displacement).max()))
    warning = "" if deflection.stable else "; UNSTABLE: no beam would stay there"
    tip = f"tip x {x:.6g} mm, y {y:.6g} mm, z {z:.6g} mm"
    first = f"{deflection.motion} at {deflection.time:.4g} s: {tip} ({deflection.model}){warning}"
    loads = [] if deflection.loads is None else [f"  {resting_loads(deflection.loads)}"]
    more = [] if deflection.solid is None else [f"  {line}" for line in deflection.solid.lines]
    return "\n".join([first, *loads, *more, f"  {_deflection_errors(deflection.errors)}", *warning_lines(deflection)])


def _rigid(deflection: Deflection, specimen: SpecimenLoads) -> str:
    """Fixture and bolts that hold a rigid specimen."""
    lines = [f"{deflection.motion} at {deflection.time:.4g} s: {deflection.model}"]
    lines += [] if deflection.loads is None else [f"  {resting_loads(deflection.loads)}"]
    lines += [f"  {specimen.lines[0]}"]
    rows = zip(specimen.bolts, specimen.tension[0], specimen.shear[0], strict=True)
    for k, (place, tension, shear) in enumerate(rows, 1):
        x, y, z = (1e3 * float(each) for each in place)
        lines.append(f"  bolt {k} at ({x:.4g}, {y:.4g}, {z:.4g}) mm: tension {tension:.4g} N, shear {shear:.4g} N")
    return "\n".join([*lines, *warning_lines(deflection)])


def _deflection_errors(errors: Errors) -> str:
    if not math.isfinite(errors.displacement.total):
        return f"no error estimate: {errors.note}" if errors.note else "no error estimate"
    tip, loads = error_words(errors.displacement), percent(errors.loads.total)
    note = f"; {errors.note}" if errors.note else ""
    return f"estimated error {tip} of the tip's displacement, {loads} of the root loads{note}"


RESTING = 1e-9  # rad/s: a smaller rate of a base is a profile's rounding
ROUNDING = 1e-10  # a damping ratio smaller than this is none


def modes(modes: Modes) -> str:
    """Modes on a line each."""
    turning = float((modes.base.w_WB_B**2).sum() ** 0.5)
    rate = turning if turning > RESTING else 0.0
    lines = [f"{modes.motion} at {modes.time:.4g} s: {modes.model}, base turning at {rate:.4g} rad/s"]
    width, known = max((len(along(d)) for d in modes.direction), default=0), np.isfinite(modes.error_estimate).any()
    rows = enumerate(zip(modes.frequency, modes.damping_ratio, modes.direction, modes.error_estimate, strict=True), 1)
    for i, (frequency, ratio, direction, error) in rows:
        damping, way = ratio if abs(ratio) > ROUNDING else 0.0, f"{along(direction):<{width}}"
        stated = f"  error {percent(error):>10}" if known else ""
        lines.append(f"  {i:>3}  {frequency:12.6g} Hz  damping {damping:8.4g}  {way}{stated}".rstrip())
    lines += _noted(modes, known=bool(known))
    if not modes.damping_given:
        lines.append("  undamped: beam.damping_ratio is not given")
    if modes.rigid:
        lines.append("  and the free rotation of hub and beam, of zero frequency")
    lines += [f"  {each}" for each in modes.instabilities]
    return "\n".join([*lines, *warning_lines(modes)])


def _noted(result: Noted, *, known: bool) -> list[str]:
    """Line on what the errors of frequencies leave out, or why there are none."""
    note = result.error_note
    return [f"  {'errors are of modes left out' if known else 'no error estimate'}: {note}"] if note else []


def campbell(diagram: Campbell, unit: str = "rad/s", size: float = 1.0) -> str:
    """First and last frequency of each mode, crossings, and a critical speed if there is one."""
    low, high = diagram.speed[[0, -1]] / size
    lines = [f"{diagram.motion}: {diagram.model}, {low:.4g} to {high:.4g} {unit}"]
    width = max(map(len, ("along", *diagram.direction)))
    lines.append(f"  mode {'along':<{width}}   Hz at the start   at the end  largest error")
    ends = diagram.frequency[0], diagram.frequency[-1]
    rows = enumerate(zip(diagram.direction, *ends, diagram.error_estimate, strict=True), 1)
    lines += [
        f"  {i:>4} {d:>{width}} {first:17.6g} {last:12.6g} {percent(error):>14}" for i, (d, first, last, error) in rows
    ]
    lines += [
        f"  mode {each.track + 1} meets {each.order} × speed at {each.speed / size:.6g} {unit}, "
        f"{each.frequency:.6g} Hz; error {percent(each.errors.total)}"
        for each in diagram.crossings
    ]
    lines += _noted(diagram, known=bool(np.isfinite(diagram.error_estimate).any()))
    if diagram.critical is not None:
        lines.append(f"  {answer(diagram.critical)}")
    return "\n".join([*lines, *warning_lines(diagram)])


def critical(critical: Critical, motion: str) -> str:
    """The answer as one sentence, and warnings."""
    return "\n".join([f"{motion}: {answer(critical)}", *warning_lines(critical)])


def answer(critical: Critical) -> str:
    """The answer as one sentence, with its error."""
    errors, error = critical.errors, ""
    if math.isfinite(errors.total):
        error = f"; estimated error {error_words(errors)}"
    elif math.isfinite(errors.shapes):
        error = f"; estimated error from too few shapes {percent(errors.shapes)}"
    note = f"; {critical.error_note}" if critical.error_note else ""
    return f"{critical.reason}{error}{note}"


def critical_map(critical: CriticalMap) -> str:
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


SLOWEST = 4  # poles of a loop that are named
_WIDTH = 100  # columns of the state_space


def state_space(system: StateSpace, gauges: Iterable[Gauge] = ()) -> str:
    """Names and units of the signals."""
    lines = [f"{system.motion}: {system.model}, {len(system.a)} states"]
    for what in ("states", "inputs", "outputs"):
        # No line ends between a name and its unit.
        words = (f"{each.name} [{each.unit}]" if each.unit else each.name for each in getattr(system, what))
        signals = ", ".join(each.replace(" ", "\N{NO-BREAK SPACE}") for each in words)
        lines += wrap(
            signals, _WIDTH, initial_indent=f"  {what:<8} ", subsequent_indent=11 * " ", break_on_hyphens=False
        )
    names = {signal.name for signal in system.outputs}
    for k, gauge in enumerate(gauges, 1):
        if f"strain_{k}" in names:
            fibre = f"fibre y {1e3 * gauge.y:g} mm, z {1e3 * gauge.z:g} mm"
            x, y, z = gauge.along
            at = f"{gauge.at}, along ({x:g}, {y:g}, {z:g})" if isinstance(gauge.at, str) else f"{gauge.at:g} m, {fibre}"
            lines.append(f"  strain_{k} at {gauge.body and f'{gauge.body}, '}{at}")
    lines += _accuracy(system) + _in_steps(system)
    if system.truncation is not None:
        lines += _left_out(system, system.truncation)
    return "\n".join([*lines, *warning_lines(system), "--json prints the matrices, --out writes them for MATLAB too."])


def _in_steps(system: StateSpace) -> list[str]:
    """Slowest decay of a loop in steps, and its margins."""
    if not system.step:
        return []
    slowest = [each for each in system.eigenvalue if each.imag >= 0 and each.real > -math.pi / system.step][:SLOWEST]
    lines = [f"  in steps of {1e3 * system.step:.4g} ms; slowest to decay:"]
    for each in slowest:
        turning = f", {number(each.imag / (2 * math.pi))} Hz" if each.imag else ""
        lines.append(f"    {number(each.real)} 1/s{turning}")
    for each in system.margins:
        gain = (
            f"gain margin {number(each.gain)} at {number(each.gain_frequency)} Hz" if math.isfinite(each.gain) else ""
        )
        low = f"gain not below {number(each.gain_low)}" if each.gain_low > 0 else ""
        phase = f"phase margin {math.degrees(each.phase):.3g} deg at {number(each.phase_frequency)} Hz"
        phase = f"{phase}, delay margin {number(1e3 * each.delay)} ms" if math.isfinite(each.phase) else ""
        parts = (gain, low, phase, f"least distance from -1 {number(each.modulus, 3)}")
        lines.append(f"  {each.drive}: {'; '.join(filter(None, parts))}")
    return lines


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
        return _noted(system, known=False)
    good = errors.within(ACCURATE)
    worst = percent(float(np.max(errors.total[:good]))) if good else ""
    words = f"frequencies within {worst} up to {system.accurate_to:.5g} Hz ({good} of {count})" if good else ""
    if good < count:
        known = errors.total[good:][np.isfinite(errors.total[good:])]
        beyond = f"up to {percent(float(known.max()))} off" if len(known) else "not judged"
        words += f"{'; ' if good else 'frequencies '}{'higher ones ' if good else ''}{beyond}"
    modes = np.isnan(errors.model).all()
    by = "the model with more modes" if modes else "the exact model with more shapes and the theory of thick beams"
    return [f"  {words}, by {by}{f'; {errors.note}' if errors.note else ''}"]


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
    yield from (f"  {body}: {line}" for body, each in rest.solids.items() for line in each.lines)
    yield from (f"  {line}" for line in by_beam(rest.errors))
    yield from warning_lines(rest)


def system_modes(modes: SystemModes) -> str:
    """Modes on a line each, with the bodies' shares of the kinetic energy."""
    lines = [f"{modes.name} at {modes.time:.4g} s:"]
    rows = zip(modes.frequency, modes.damping_ratio, modes.error_estimate, strict=True)
    for k, (frequency, ratio, error) in enumerate(rows):
        shares = ((share, body) for share, body in zip(modes.share[k], modes.bodies, strict=True) if share > 0.005)
        # Bodies of equal shares in their own order, whatever the last digits say.
        ranked = sorted(shares, key=lambda each: -round(each[0], 2))
        listed = ", ".join(f"{body} {share:.0%}" for share, body in ranked)
        damping = ratio if abs(ratio) > 1e-10 else 0.0
        known = f"  error {percent(error):>7}" if math.isfinite(error) else ""
        lines.append(f"  {k + 1:>3}  {frequency:12.6g} Hz  damping {damping:8.4g}{known}  {listed}")
    lines += _noted(modes, known=bool(np.isfinite(modes.error_estimate).any()))
    if (modes.frequency > modes.reached).any():
        lines.append(f"  above {modes.reached:.4g} Hz, to which the modes of meshes and matrices reach, upper bounds")
    if modes.rigid:
        lines.append(f"  and {modes.rigid} motion{'' if modes.rigid == 1 else 's'} of zero frequency")
    lines += [f"  {each}" for each in modes.instabilities]
    return "\n".join([*lines, *warning_lines(modes)])
