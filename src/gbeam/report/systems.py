"""Reports of systems of bodies: at rest, their vibrations, and their responses over time."""

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
    Value,
    named,
    quantities,
    table,
)
from gbeam.report.loads import READ, at_points, loads_table, resting_loads, stress_table
from gbeam.report.steady import ERROR, evenly, growing, modes_table
from gbeam.report.words import errors_in_words, known, tidy


def system_modes(facts: Facts) -> Blocks:
    """Modes with the bodies' shares of the kinetic energy."""

    def shares(each: Facts) -> Value:
        pairs = zip(facts["body_names"], each["share"], strict=True)
        # Bodies of equal shares in their own order, whatever the last digits say.
        ranked = sorted(pairs, key=lambda pair: -round(pair[1], 2))
        return ", ".join(f"{body} {share:.0%}" for body, share in ranked if share > 0.005)

    yield Sentence(f"{facts['name']} at {facts['time']:.4g} s".lstrip())
    yield from evenly(facts)
    yield growing(facts, lambda each: "")
    yield Section("View", (Place("viewer"),))
    yield modes_table(facts, ERROR | {"kinetic energy": shares})
    reached = known(facts["reached"])
    if any(each["frequency"] > reached for each in facts["modes"]):
        yield Sentence(f"above {reached:.4g} Hz, to which the modes of meshes and matrices reach, upper bounds")
    if facts["rigid"]:
        yield Sentence(f"and {facts['rigid']} motion{'' if facts['rigid'] == 1 else 's'} of zero frequency")
    yield Section("Figures", (FIGURES,))


def system_rest(facts: Facts) -> Blocks:
    """Displacements of the points at rest, and the loads of the ground and of every beam."""
    yield Section("View", (Place("viewer"),))
    for name, rest in facts["motions"].items():
        of_motion = _rest({**rest, "units": units_in(facts)})
        yield Section(f"motion {name} at {rest['time']:.4g} s", tuple(of_motion), titled=True)
    yield Section("Figures", (FIGURES,))


def _rest(rest: Facts) -> Blocks:
    """Displacements and coordinates of a system at rest, its loads, stress and errors, and on a page all else."""
    yield Items(tuple(filter(None, [rest.get("message")])), "bad")
    yield from evenly(rest)
    cells = {"point": "name", **{f"{axis}, mm": f"displacement.{axis}:.6g" for axis in "xyz"}}
    places = (abs(each) for point in rest["points"].values() for each in point["place"].values())
    yield table(named(rest["points"]), cells, scale=max(places, default=0.0))
    coordinates: Columns = {"coordinate": "name", "at rest, m or rad": "q", "drive, N or N m": "effort"}
    yield table(named(rest["coordinates"]), coordinates, detail=True)
    force, moment = ([*rest[key].values()] for key in ("ground_force", "ground_moment"))
    largest = max(map(abs, force + moment))
    pair = (", ".join(f"{each:.5g}" for each in tidy(vector, largest)) for vector in (force, moment))
    yield Sentence("on the ground: force ({}) N, moment ({}) N m".format(*pair))
    yield resting_loads(rest.get("beams", {}), "beam")
    yield from stress_table(rest.get("solids", {}), "body")
    yield from errors_of_system(rest["errors"])
    yield _others(
        rest,
        "points",
        "coordinates",
        "time",
        "ground_force",
        "ground_moment",
        "beams",
        "solids",
        "errors",
        "accelerated",
    )


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
    count = len(errors.get("beams", ()))
    rows = [{key: each[k] for key, each in errors.items() if isinstance(each, list) and each} for k in range(count)]
    shares = {"deflection": "displacement_by_beam:%", "places: shapes and model": "by_beam:%"}
    shares |= {"root loads": "loads_by_beam:%", "their peaks": "load_peaks_by_beam:%"}
    shares |= {"stress": "stress_by_beam:%", "its peak": "stress_peaks_by_beam:%"}
    cells = {"body": "beams", **shares, "beam theory": "theory"}
    yield table(rows, cells, "Estimated errors that each body brings, of the largest", optional=tuple(cells)[1:])


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
