"""From a validated scenario to the objects of the core, which are imported only when it is called."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from gbeam.errors import InputError
from gbeam.scenario import schema
from gbeam.scenario.collect import Collector
from gbeam.scenario.explain import placed

if TYPE_CHECKING:
    from gbeam.analysis.study.case import Case, ResponseSettings
    from gbeam.mechanics.assembly import Model
    from gbeam.motion import Centrifuge, PiecewiseLinear
    from gbeam.structure.beam import Beam
    from gbeam.structure.loads import Load


def build(scenario: schema.Scenario) -> Case:
    """Make the objects of a scenario.

    Parameters
    ----------
    scenario : Scenario

    Returns
    -------
    Case

    Raises
    ------
    ScenarioError
        With every InputError of the objects, each at its place in the file.
    """
    from gbeam.analysis.study.case import Case
    from gbeam.scenario.build_motion import centrifuges, flights_and_hubs

    parts = Collector()
    beam = _beam(parts, scenario.beam)
    model = _model(parts, scenario.model)
    motions, records = flights_and_hubs(parts, scenario)
    response = _response(parts, scenario.response, [_covered(r) for r in records])
    if response is not None:
        span = (response.start, response.start + response.duration)
        motions |= centrifuges(parts, scenario, motions, span)
    if parts.errors or beam is None or model is None or response is None:
        raise placed(scenario, parts.errors)
    return Case(
        title=scenario.title,
        beam=beam,
        model=model,
        motions={name: motions[name] for name in scenario.motion},
        response=response,
        tracks={name: it.tracks for name, it in scenario.motion.items() if isinstance(it, schema.Centrifuge)},
        stations=scenario.response.stations or (),
    )


def build_machines(scenario: schema.Environments) -> dict[str, Centrifuge]:
    """Make the centrifuges of a scenario, which need no beam.

    Parameters
    ----------
    scenario : Environments

    Returns
    -------
    dict of str to Centrifuge
        By name; empty if the scenario has none.

    Raises
    ------
    ScenarioError
        With every InputError of the objects, each at its place in the file.
    """
    from gbeam.motion import Centrifuge
    from gbeam.scenario.build_motion import centrifuges, flights_and_hubs

    parts = Collector()
    motions, records = flights_and_hubs(parts, scenario)
    response = _response(parts, scenario.response, [_covered(r) for r in records])
    if response is not None:
        span = (response.start, response.start + response.duration)
        motions |= centrifuges(parts, scenario, motions, span)
    if parts.errors or response is None:
        raise placed(scenario, parts.errors)
    return {name: it for name in scenario.motion if isinstance(it := motions[name], Centrifuge)}


def _beam(parts: Collector, it: schema.Beam) -> Beam | None:
    from gbeam.structure.beam import Beam, Material, PointMass
    from gbeam.structure.section import Section
    from gbeam.structure.support import Root

    dimensions = it.section.model_dump(exclude={"shape", "stations"}, exclude_none=True)
    section = parts.attempt("beam.section", Section.of, it.section.shape, it.section.stations, **dimensions)
    material = parts.attempt("beam.material", Material, it.material.density, it.material.youngs_modulus)
    masses = []
    for i, m in enumerate(it.masses):
        moments = (m.inertia.x, m.inertia.y, m.inertia.z) if m.inertia else (0.0, 0.0, 0.0)
        masses.append(parts.attempt(f"beam.masses[{i}]", PointMass, m.at, m.mass, moments, m.offset or (0.0, 0.0, 0.0)))
    root = parts.attempt("beam.root", Root, **it.root.model_dump())
    loads = [_load(parts, f"beam.loads[{i}]", load) for i, load in enumerate(it.loads)]
    if section is None or material is None or root is None or None in masses or None in loads:
        return None
    return parts.attempt("beam", Beam, it.length, section, material, masses, it.damping_ratio, root, loads)


def _load(parts: Collector, where: str, it: schema.Load) -> Load | None:
    from gbeam.scenario.build_motion import components
    from gbeam.structure.loads import Load

    tables = {"force": it.force, "distributed": it.distributed, "moment": it.moment}
    built = {
        "moment" if name == "moment" else "force": components(parts, f"{where}.{name}", table)
        for name, table in tables.items()
        if table is not None
    }
    return None if None in built.values() else parts.attempt(where, Load, it.at, follower=it.follower, **built)


def _model(parts: Collector, it: schema.Model) -> Model | None:
    from gbeam.mechanics.assembly import Model

    return parts.attempt("model", Model, it.kind, it.modes.axial, it.modes.y, it.modes.z, it.shapes)


def _covered(record: PiecewiseLinear) -> tuple[float, float, float]:
    """First and last time of a record, and the end of its last interval: 1600 samples at 100 Hz are 16 s of flight."""
    import numpy as np

    times = np.asarray(record.times)
    return float(times[0]), float(times[-1]), float(2 * times[-1] - times[-2])


def _response(
    parts: Collector, it: schema.Response, records: list[tuple[float, float, float]]
) -> ResponseSettings | None:
    """Settings; `records` are what they cover, and without a duration the time that all do."""
    from gbeam import integrate
    from gbeam.analysis.study.case import ResponseSettings

    schemes: dict[str, Callable[..., object]] = {
        "newmark": integrate.newmark,
        "hht": integrate.hht,
        "generalized-alpha": integrate.generalized_alpha,
    }
    if it.parameters:
        # Made for its refusals only: the analysis makes its own.
        parts.attempt("response", schemes[it.integrator], **it.parameters)
    start = max((first for first, _, _ in records), default=0.0)
    duration = it.duration
    if duration is None:
        if not records:
            return None  # the record could not be read, which has been said
        duration = min(last for _, last, _ in records) - start
        if duration <= 0:
            parts.errors.append(InputError("response", "has no time that all records cover", "add a duration"))
            return None
    end = start + duration
    last = min((end_of_interval for _, _, end_of_interval in records), default=end)
    if end > last + 1e-6 * duration:
        problem = f"asks for an end at {end:g} s, and the record ends at {last:g} s"
        fix = f"give {last - start:g} s or less, or leave it out"
        parts.errors.append(InputError("response.duration", problem, fix))
    if it.residual_from is not None and not start <= it.residual_from < end:
        fix = f"give a time from {start:g} s to {end:g} s"
        parts.errors.append(InputError("response.residual_from", f"is {it.residual_from:g} s", fix))
    return ResponseSettings(
        start=start,
        duration=duration,
        step=None if isinstance(it.step, str) else it.step,
        integrator=it.integrator,
        parameters=it.parameters,
        tolerance=it.tolerance,
        residual_from=it.residual_from,
    )
