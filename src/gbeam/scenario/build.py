"""Objects of the core from a validated scenario. Their modules are imported only when one is built."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.results.criteria import RULES, Acceptance
from gbeam.scenario import schema
from gbeam.scenario.collector import Collector
from gbeam.scenario.load import load, loads, placed, provenance, text_of
from gbeam.scenario.schema.declared import object_of

if TYPE_CHECKING:
    from gbeam.analysis.case import Case
    from gbeam.analysis.response.settings import ResponseSettings
    from gbeam.mechanics.tree.system import System
    from gbeam.motion.centrifuge.centrifuge import Centrifuge
    from gbeam.motion.protocol import Motion
    from gbeam.results.description import RecordSummary
    from gbeam.scenario.load import AnyScenario


Spans = dict[str, tuple[float, float]]


@typed
def read_scenario(path: str | os.PathLike[str], overrides: Iterable[str] = ()) -> Case:
    """Read a scenario file and make its objects.

    Parameters
    ----------
    path : path
        TOML, or JSON if its text begins with a brace. File names in it are relative to its folder.
    overrides : iterable of str
        Changes such as ``beam.length=250 mm`` or ``beam.masses[0].mass=0.2 kg``, made before validation.

    Returns
    -------
    Case
        Bodies, motions by name and response settings; SI.

    Raises
    ------
    InputError
        With everything that is wrong, each with its place in the file.

    Examples
    --------
    >>> case = gb.read_scenario("examples/f16_8g_turn.toml", ["beam.length=320 mm"])
    >>> case.beam.length
    0.32
    """
    return build(load(path, overrides))


def build(scenario: AnyScenario, *, ahead: bool = False, system: System | None = None) -> Case:
    """Make the objects of a scenario; `ahead` plans its centrifuges' motions now rather than when they are used. A
    `system` that was built from the same tables is taken as it is.
    """
    from gbeam.analysis.case import Case, refusals
    from gbeam.scenario.build_motion import centrifuges, flights_and_hubs

    parts = Collector()
    system = system or _system(parts, scenario)
    motions = flights_and_hubs(parts, scenario)
    response, spans = _response(parts, scenario, motions)
    if response is not None:
        motions |= centrifuges(parts, scenario, motions, _span_of(response, spans), ahead=ahead)
    accept, sensors = _acceptance(parts, scenario), _sensors(parts, scenario.sensors)
    if system is not None:
        parts.errors += refusals(system, accept, sensors)
    if parts.errors or system is None:
        raise placed(scenario, parts.errors)
    case = parts.attempt(
        "",
        Case,
        title=scenario.heading(),
        system=system,
        motions={name: motions[name] for name in scenario.names},
        response=response,
        tracks={name: table.tracks for name, table in scenario.motion.items() if isinstance(table, schema.Centrifuge)},
        accept=accept,
        provenance=provenance(scenario),
        sensors=sensors,
        read_from=text_of(scenario),
        spans=spans,
    )
    if case is None:
        raise placed(scenario, parts.errors)
    return case


def _system(parts: Collector, scenario: schema.Environments) -> System | None:
    """The bodies of a scenario, or None if they cannot be made, with the reasons in `parts`."""
    if isinstance(scenario, schema.Scenario):  # whose modules are fewer
        return parts.attempt("", _of_beam, parts, scenario)
    from gbeam.scenario.build_system import system_of

    return system_of(parts, scenario)  # type: ignore[arg-type]


def _of_beam(parts: Collector, scenario: schema.Scenario) -> System | None:
    from gbeam.analysis.case import BEAM
    from gbeam.analysis.one_body import structure_of
    from gbeam.mechanics.tree.system import System

    beam, model_for = object_of(parts, "beam", scenario.beam), object_of(parts, "model", scenario.model)
    if beam is None or model_for is None:
        return None
    model = parts.attempt("model", model_for, beam)
    if model is None:
        return None
    return System.of(structure_of(beam, model, scenario.response.stations or ()), BEAM)


def scenario_of(
    case: str | os.PathLike[str] | Case, overrides: Iterable[str] = (), *, distributions: bool = False
) -> AnyScenario:
    """Validated scenario of a file, or of the file that a case was read from, with changes; else InputError."""
    if isinstance(case, (str, os.PathLike)):
        return load(case, overrides, distributions=distributions)
    text = case.scenario
    if text is None:
        fix = "give the file, or what read_scenario makes of it; changes as overrides"
        raise InputError("scenario", "is a case that was not read from a file, or was changed since", fix)
    changes = (*text.overrides, *overrides)
    return loads(text.text, text.name, changes, folder=text.folder, distributions=distributions)


def build_machines(scenario: schema.Environments) -> dict[str, Centrifuge]:
    """Make the centrifuges of a scenario, which need no beam."""
    from gbeam.motion.centrifuge.centrifuge import Centrifuge
    from gbeam.scenario.build_motion import centrifuges, flights_and_hubs

    parts = Collector()
    motions = flights_and_hubs(parts, scenario)
    response, spans = _response(parts, scenario, motions)
    if response is not None:
        motions |= centrifuges(parts, scenario, motions, _span_of(response, spans), ahead=True)
    _acceptance(parts, scenario)
    if parts.errors:
        raise placed(scenario, parts.errors)
    built = {name: motions[name] for name in scenario.motion}
    return {name: machine for name, machine in built.items() if isinstance(machine, Centrifuge)}


def build_specimen(scenario: schema.Environments) -> System | None:
    """System of a scenario, or None if it has no specimen."""
    if type(scenario) is schema.Environments:
        return None
    parts = Collector()
    system = _system(parts, scenario)
    if parts.errors or system is None:
        raise placed(scenario, parts.errors)
    return system


def _acceptance(parts: Collector, scenario: schema.Environments) -> dict[str, Acceptance]:
    """Limits of acceptance and their settings, by the name of the centrifuge. `parts` collects what is wrong."""
    machines = {name: table for name, table in scenario.motion.items() if isinstance(table, schema.Centrifuge)}
    by_machine = ((name, table.limits_of_acceptance) for name, table in machines.items())
    limited: dict[str, Any] = {name: limits for name, limits in by_machine if limits}
    for name, limits in limited.items():
        for key, limit in limits.items():
            if key in RULES:
                parts.attempt(f"motion.{name}.accept", RULES[key].checked, limit)
    return limited


def _sensors(parts: Collector, tables: Mapping[str, Any]) -> dict[str, Any]:
    """Accelerometers by the names of their points."""
    return {name: object_of(parts, f"sensors.{name}", table) for name, table in tables.items()}


def _span_of(response: ResponseSettings, spans: Spans) -> Callable[[str], tuple[float, float]]:
    """Function that says first and last time, s, of the response in a motion."""
    return lambda name: spans.get(name, (response.start, response.start + response.duration))


def _response(
    parts: Collector, scenario: schema.Environments, motions: Mapping[str, Motion]
) -> tuple[ResponseSettings | None, Spans]:
    """Settings, over the time that all records cover if no duration is written, and without one where they last
    differently the times of each motion; None, without a time, or refused.
    """
    from gbeam.analysis.response.settings import ResponseSettings
    from gbeam.integrate.schemes import SCHEMES
    from gbeam.motion.arm import extent_of
    from gbeam.motion.flight import Flight

    table = scenario.response
    if table.parameters:
        # Only to refuse wrong parameters: the analysis makes its own scheme.
        parts.attempt("response", SCHEMES[table.integrator], **table.parameters)
    flights = {name: motion for name, motion in motions.items() if isinstance(motion, Flight)}
    records = {name: flight.record for name, flight in flights.items() if flight.record is not None}
    of_records = {name: flights[name].acceleration.extent for name in records}
    of_arms = {name: extent_of(motion) for name, motion in motions.items()}
    arms = {name: extent for name, extent in of_arms.items() if extent is not None}
    extents = {name: extent for name, extent in of_records.items() if extent is not None} | arms
    start, duration, spans = max((first for first, _ in extents.values()), default=0.0), table.duration, Spans()
    if duration is None:
        if not extents:
            return None, spans
        duration = min(last for _, last in extents.values()) - start
        other_ends = [last for _, last in arms.values() if not math.isclose(last, start + duration, rel_tol=1e-9)]
        partly = [_not_all_of(name, record, start, start + duration) for name, record in records.items()]
        if other_ends or any(next(errors, None) for errors in partly):
            machines = {name: table for name, table in scenario.motion.items() if isinstance(table, schema.Centrifuge)}
            tracked = {name: machine.tracks for name, machine in machines.items() if machine.tracks in extents}
            spans = extents | {name: extents[flight] for name, flight in tracked.items()}
            parts.errors += _without_time(motions, spans)
            start, last = next(iter(extents.values()))
            duration = last - start
    end = start + duration
    if not spans:
        for name, record in records.items():
            parts.errors += _not_all_of(name, record, start, end)
        for name, (_, last) in arms.items():
            if end < last * (1 - 1e-9):
                problem = f"ends at {end:g} s, and {name} comes to rest at {last:g} s"
                fix = "leave it out: each motion has its own time then; a shorter dwell is one of the arm's keys"
                parts.errors.append(InputError("response.duration", problem, fix))
    for first, last in spans.values() or [(start, end)]:
        if table.residual_from is not None and not first <= table.residual_from < last:
            fix = f"give a time from {first:g} s on, before {last:g} s"
            parts.errors.append(InputError("response.residual_from", f"is {table.residual_from:g} s", fix))
            break
    initial = object_of(parts, "response.initial", table.initial)
    if initial is None:
        return None, spans
    settings = parts.attempt(
        "response",
        ResponseSettings,
        initial=initial,
        start=start,
        duration=duration,
        step=None if isinstance(table.step, str) else table.step,
        integrator=table.integrator,
        parameters=table.parameters,
        tolerance=table.tolerance,
        estimate=table.estimate,
        residual_from=table.residual_from,
        histories=None if isinstance(table.histories, str) else table.histories,
    )
    return settings, spans


def _without_time(motions: Iterable[str], spans: Spans) -> Iterator[InputError]:
    """Refuse motions without a time of their own beside records and arms that last differently."""
    for name in motions:
        if name not in spans:
            listed = ", ".join(f"{motion} {first:g} to {last:g} s" for motion, (first, last) in spans.items())
            problem = f"has no time of its own, and those beside it last differently: {listed}"
            yield InputError(f"motion.{name}", problem, "put it into a scenario of its own")


def _not_all_of(name: str, record: RecordSummary, start: float, end: float) -> Iterator[InputError]:
    """Refuse a run from `start` to `end`, s, beyond a record, or over a part that its table does not ask for."""
    first, last = record.span
    interval = (1 + 1e-6) / record.read.rate  # 1600 samples at 100 Hz are 16 s of flight
    flown = f"{last - first:.6g} s" if first == 0 else f"{last - first:.6g} s, from {first:.6g} to {last:.6g} s"
    record_words = f"the record of {name!r} lasts {flown}"
    if end > last + interval:
        span = last + 1 / record.read.rate - start
        fix = f"give {span:g} s or less, or leave it out" if span > 0 else "leave it out: each has its own time then"
        yield InputError("response.duration", f"reaches to {end:g} s, and {record_words}", fix)
        return
    keys = [f'from = "{start:g} s"'] if start > first + interval else []
    keys += [f'to = "{end:g} s"'] if end < last - interval else []
    if keys:
        problem = f"is {end - start:g} s, and {record_words}: the rest would be left out"
        part = f"ask for a part on the record itself: {', '.join(keys)} in [motion.{name}.record]"
        yield InputError("response.duration", problem, f"leave it out, or {part}")
