"""Reports of systems of bodies over time."""

from __future__ import annotations

from gbeam.report.blocks import (
    FIGURES,
    Block,
    Blocks,
    Columns,
    Facts,
    Items,
    Place,
    Section,
    Sentence,
    named,
    quantities,
    table,
)
from gbeam.report.loads import READ, at_points, errors_by_body, loads_table, stress_table
from gbeam.report.words import errors_in_words, known


def units_in(facts: Facts) -> dict[str, str]:
    """Units of the quantities of one motion, by their paths in it."""
    return {path.removeprefix("motions.*."): unit for path, unit in facts.get("units", {}).items()}


def _others(facts: Facts, *told: str) -> Block:
    """All quantities but those with the keys `told`, for a page only."""
    return Section("", tuple(quantities({key: value for key, value in facts.items() if key not in told})), detail=True)


def errors_of_system(errors: Facts) -> Blocks:
    """Errors of deflections and of the points' places, and those that every body brings."""
    deflection, place = errors["displacement"], errors["place"]
    if deflection != place and any(known(each) > 0 for each in deflection.values()):
        yield Sentence(f"estimated error {errors_in_words(deflection)} of a body's largest deflection")
    if any(known(each) > 0 for each in place.values()):
        of_places = "" if deflection == place else "of places "
        yield Sentence(f"estimated error {of_places}{errors_in_words(place)} of the largest displacement")
    if errors.get("note"):
        yield Sentence(errors["note"], "faint")
    yield errors_by_body(errors)


def system_response(facts: Facts) -> Blocks:
    """The largest motions of the points, loads, and the error."""
    yield Sentence(f"{facts['name'] or facts['environment']}: {facts['outcome']}")
    if facts["message"]:
        yield Sentence(facts["message"], "bad")
    yield Section("Motion", (Place("viewer"),))
    yield from of_points(facts)
    yield Items(tuple(facts.get("lines", ())))
    yield Section("Histories", (FIGURES,))


def of_points(facts: Facts) -> Blocks:
    """Motions of points and coordinates, loads, stress and errors of a response, and on a page all else."""
    residual = f"residual from {known(facts.get('residual_from')):g} s, m"
    cells: Columns = {"point": "name", "moves by, m": "displacement_max", "acceleration, m/s²": "acceleration_max"}
    cells |= READ | {residual: "residual_size"}
    yield table(at_points(facts, facts["points"]), cells, optional=(*READ, residual))
    yield table(named(facts["coordinates"]), {"coordinate": "name", "at the end, m or rad": "end"}, detail=True)
    beams = {name: {"loads": each} for name, each in facts.get("beams", {}).items()}
    yield loads_table(beams, "beam")
    yield from stress_table(facts.get("solids", {}), "body")
    yield from errors_of_system(facts["errors"])
    yield _others(
        facts, "points", "coordinates", "beams", "solids", "errors", "limits", "name", "environment", "message"
    )
