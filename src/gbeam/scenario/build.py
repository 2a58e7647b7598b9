"""From a validated scenario to the objects of the core, which are imported only when it is called."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from gbeam.errors import InputError
from gbeam.scenario import schema
from gbeam.scenario.collect import Collector
from gbeam.scenario.explain import placed

if TYPE_CHECKING:
    from gbeam.beam import Beam
    from gbeam.case import Case, ResponseSettings
    from gbeam.model import Model


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
    from gbeam.case import Case
    from gbeam.scenario.build_motion import centrifuges, flights_and_hubs

    parts = Collector()
    beam = _beam(parts, scenario.beam)
    model = _model(parts, scenario.model)
    motions, records = flights_and_hubs(parts, scenario)
    response = _response(parts, scenario.response, [(float(r.times[0]), float(r.times[-1])) for r in records])
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


def _beam(parts: Collector, it: schema.Beam) -> Beam | None:
    from gbeam.beam import Beam, Material, PointMass, Section

    dimensions = it.section.model_dump(exclude={"shape", "stations"}, exclude_none=True)
    section = parts.attempt("beam.section", Section.of, it.section.shape, it.section.stations, **dimensions)
    material = parts.attempt("beam.material", Material, it.material.density, it.material.youngs_modulus)
    masses = []
    for i, m in enumerate(it.masses):
        moments = (m.inertia.x, m.inertia.y, m.inertia.z) if m.inertia else (0.0, 0.0, 0.0)
        masses.append(parts.attempt(f"beam.masses[{i}]", PointMass, m.at, m.mass, moments, m.offset or (0.0, 0.0, 0.0)))
    sound = [mass for mass in masses if mass is not None]
    if section is None or material is None or len(sound) < len(masses):
        return None
    return parts.attempt("beam", Beam, it.length, section, material, sound, it.damping_ratio)


def _model(parts: Collector, it: schema.Model) -> Model | None:
    from gbeam.model import Model

    return parts.attempt("model", Model, it.kind, it.modes.axial, it.modes.y, it.modes.z)


def _response(parts: Collector, it: schema.Response, records: list[tuple[float, float]]) -> ResponseSettings | None:
    """Settings; `records` are their first and last times, and without a duration the time that all cover."""
    from gbeam import integrate
    from gbeam.case import ResponseSettings

    schemes: dict[str, Callable[..., object]] = {
        "newmark": integrate.newmark,
        "hht": integrate.hht,
        "generalized-alpha": integrate.generalized_alpha,
    }
    if it.parameters:
        # Made for its refusals only: the analysis makes its own.
        parts.attempt("response", schemes[it.integrator], **it.parameters)
    start = max((first for first, _ in records), default=0.0)
    duration = it.duration
    if duration is None:
        if not records:
            return None  # the record could not be read, which has been said
        duration = min(last for _, last in records) - start
        if duration <= 0:
            parts.errors.append(InputError("response", "has no time that all records cover", "add a duration"))
            return None
    end = start + duration
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
