"""Put a beam into a model."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from gbeam.arrays.namespace import Array, holds_jax, is_jax, namespace
from gbeam.constants import ModelKind, Shapes
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.limits import NODES, refuse_more
from gbeam.guards.quantities import Positions
from gbeam.mechanics.beam_terms import (
    heat_of,
    load_history,
    load_work,
    particles_of,
    root_dashpots,
    sections_of,
    stiffness_of,
)
from gbeam.mechanics.equations.held import held_inertia
from gbeam.mechanics.equations.linear import coefficients, damping_matrix
from gbeam.mechanics.fields.adapted import adapted_shapes
from gbeam.mechanics.fields.basis import Counts, Families, Quadrature, closed_forms, polynomials, quadrature
from gbeam.mechanics.fields.held import Conditions, HeldField, null_basis
from gbeam.mechanics.fields.measures import components, measures_of
from gbeam.mechanics.fields.projected import Field, ReducedField, RootedField, projected_field
from gbeam.mechanics.fields.series import SeriesField
from gbeam.mechanics.fields.strains import ExpandedField, shaped_strains, strain_field
from gbeam.mechanics.models import MODEL_KINDS, Kind, Model
from gbeam.mechanics.plausibility import implausible_beam, refuse_disparate, refuse_unknown
from gbeam.mechanics.recovery import Source
from gbeam.mechanics.structure import Grip, Structure
from gbeam.mechanics.supports import (
    chosen_dependents,
    counts_without,
    plus,
    refuse_shapeless,
    rigid_conditions,
    static_counts,
    strain_sizes,
    supported_shapes,
    turned,
    yielding_conditions,
)
from gbeam.structure.attachments import TIP
from gbeam.structure.beam import Beam


@typed
def assemble(
    beam: Beam,
    model: Model | ModelKind,
    stations: Positions = (),
    *,
    axial: int = 0,
    y: int = 0,
    z: int = 0,
    shapes: Shapes | None = None,
    twist: int = 0,
    shear_y: int = 0,
    shear_z: int = 0,
) -> Structure:
    """Put a beam into a model.

    Parameters
    ----------
    beam : Beam
    model : Model or str
        A model, or the kind of one with the numbers of its shapes: ``assemble(beam, "FOAM", axial=1, y=3, z=3)``.
    stations : (s,) positions along the beam where displacements are put out, m; the tip is always added last
    axial, y, z, shapes, twist, shear_y, shear_z
        Of the model where only its kind is given, see :class:`Model`; without any number those of :meth:`Model.of`.

    Returns
    -------
    Structure

    Raises
    ------
    InputError
        If a station lies off the beam, the list of damping ratios does not fit the model, the section has too many
        stations to integrate between, numbers do not hold a body or a spring beside the beam, or the beam lacks what
        twist and shear need.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    >>> gb.assemble(beam, "FOAM", axial=1, y=2, z=2, stations=[0.1, 0.2]).stations
    array([0.1, 0.2, 0.3])
    """
    if isinstance(model, str):
        if any((axial, y, z, twist, shear_y, shear_z)):
            model = Model(model, axial, y, z, shapes or "clamped-free", False, twist, shear_y, shear_z)
        else:
            model = Model.of(model, shapes or ("clamped-free" if beam.coupled else None))
    row, counts = model.row, model.counts
    _refuse_traced_places(beam, adapted=model.shapes == "adapted")
    refuse_disparate(beam)
    if beam.line is not None and model.shapes == "adapted":
        fix = 'give shapes = "clamped-free", which are polynomials there'
        raise InputError("shapes", "are adapted, and the beam is not straight at rest", fix)
    if beam.material is None and model.shapes == "adapted":
        fix = 'give shapes = "clamped-free"'
        raise InputError("shapes", "are adapted, and the section's matrices couple the directions", fix)
    refuse_unknown(beam, twist=model.twist > 0, shear_y=model.shear_y > 0, shear_z=model.shear_z > 0)
    at = _stations(beam, stations)
    bodies = [m.at for m in beam.masses]
    adapted = model.shapes == "adapted"
    breaks = [*breaks_of(beam), *(bodies if adapted else ())]
    rule = quadrature(beam.length, _nodes(row, max(counts)), breaks)
    # Integrals from the root are a matrix of all nodes to all.
    nodes = len(rule.node)
    refuse_more("section.stations", "nodes of integration", nodes, NODES, 24.0 * nodes, "give fewer, or fewer shapes")
    refuse_shapeless(beam, counts)
    if beam.temperature is not None and not counts[0]:
        fix = "leave it out, or choose FOAM with modes.axial = 1" if not row.axial else "give modes.axial = 1 or more"
        raise InputError("temperature", "stretches the beam, and the model has no shapes along it", fix)
    counts = plus(counts, static_counts(beam, counts))
    families = families_of(beam, model.kind, counts, rule, model.shapes)
    return assembled(beam, model.kind, counts, rule, at, families, model.shapes, automatic=model.automatic)


def assembled(
    beam: Beam,
    kind: str,
    counts: Counts,
    rule: Quadrature,
    at: Array,
    families: Families,
    shapes: Shapes,
    *,
    automatic: bool = False,
    dependents: tuple[int, ...] | None = None,
) -> Structure:
    """Put a beam into a kind of model, with a quadrature `rule` and stations of output `at` (s,) m, the tip last. The
    functions of its shapes are `families`; `automatic` marks their numbers. Rigid supports make as many coordinates
    dependent as they have conditions: those at the indices `dependents`, or some that suit.
    """
    field, stiffness, heat = _unheld(beam, kind, counts, rule, at, families)

    def build(
        field: Field, stiffness: Array, damping: Array | None, heat: Array | None, dependents: tuple[int, ...]
    ) -> Structure:
        """Structure in the coordinates that are not taken by supports."""
        remaining = counts_without(counts, dependents)
        source = Source(beam, shapes, counts, automatic)
        return _structure(source, kind, rule, at, remaining, field, stiffness, damping, heat)

    if not beam.held_places:
        free = build(field, stiffness, None, heat, ())
        c = free.coefficients
        return replace(free, coefficients=c.damped(c.damping + root_dashpots(beam, c.size)))
    first_station = len(rule.node) + len(beam.masses) + sum(load.at is not None for load in beam.loads)
    return hold(
        beam, rule, field, stiffness, heat, build, at, first_station, sum(counts), dependents, MODEL_KINDS[kind].order
    )


def hold(
    beam: Beam,
    rule: Quadrature,
    field: Field,
    stiffness: Array,
    heat: Array | None,
    build: Callable[[Any, Array, Array | None, Array | None, tuple[int, ...]], Structure],
    at: Array,
    first_station: int,
    shapes: int,
    dependents: tuple[int, ...] | None,
    order: int | None = None,
) -> Structure:
    """Hold a beam at its supports beyond the root, in `at` (s,) m, the stations.

    The points of its `field` begin with the nodes of its `rule`. `field`, `stiffness` (n, n) and `heat` (n,) are those
    without supports, of `shapes` shapes and then the root's springs. `build` makes a structure of a field, a stiffness,
    a damping, by default that of the modes, a heat and indices that are taken. These are the `dependents`, or some that
    suit, as many as there are rigid conditions. The places of the field are polynomials that end at an `order`; None is
    without end.
    """
    conditions, yielding = rigid_conditions(beam), yielding_conditions(beam)
    conditions_and_springs = [*conditions, *yielding]
    # What bends shortens along x: of polynomials of a straight beam the conditions along x alone are of second order.
    bent = beam.line is not None or any(condition.direction == "x" for condition in conditions_and_springs)
    curved = order is None or order > 2 or (order > 1 and bent)
    everywhere, turns = field.sections(slice(None)).jacobians(np.zeros(len(stiffness)))
    slopes, angles = everywhere[first_station:], turns[first_station:]
    places = tuple(
        (int(np.argmin(np.abs(at - condition.at))), condition.number) for condition in conditions_and_springs
    )
    parted = places[: len(conditions)], places[len(conditions) :]
    rows = components(places, slopes, angles)
    held_rows, sprung_rows = rows[: len(conditions)], rows[len(conditions) :]
    yields = [
        [getattr(beam.supports[condition.support], name).get(condition.direction, 0.0) for condition in yielding]
        for name in ("stiffness", "damping")
    ]
    xp = namespace(stiffness, *yields[0], *yields[1])
    spring, damper = (xp.asarray(values, dtype=float) for values in yields)
    stiffness = stiffness + sprung_rows.T @ (spring[:, None] * sprung_rows)
    dashpots = sprung_rows.T @ (damper[:, None] * sprung_rows) + root_dashpots(beam, len(stiffness))
    if dependents is None:
        # On a straight beam what is held along x at rest is the stretch alone, and energies choose what is soft.
        by_strains = beam.line is not None or is_jax(stiffness)
        sizes = strain_sizes(beam, rule, everywhere, turns) if by_strains else np.diag(stiffness)
        dependents = chosen_dependents(conditions, held_rows, sizes, shapes)
    basis = null_basis(held_rows, dependents)
    in_fewer = _held_field(field, basis, dependents, parted[0], first_station, curved=curved)
    in_those = heat if curved or heat is None else heat @ basis
    supported = build(in_fewer, turned(stiffness, basis), None, in_those, dependents)
    c = supported.coefficients
    # The damping of modes acts where their elastic forces do.
    free_basis = np.delete(np.eye(len(stiffness)), dependents, axis=1)
    felt = stiffness @ basis @ xp.linalg.solve(c.stiffness, c.damping) @ free_basis.T
    supported = replace(supported, coefficients=c.damped(c.damping + turned(dashpots, basis)))
    free = build(field, stiffness, felt + dashpots, heat, ())
    return replace(
        supported, grip=Grip(free, basis, held_rows, sprung_rows, spring, damper, dependents, *parted, curved)
    )


def _held_field(
    field: Any,
    basis: Array,
    dependents: tuple[int, ...],
    held: tuple[tuple[int, int], ...],
    first_station: int,
    *,
    curved: bool,
) -> Field:
    """Field in the coordinates that rigid supports leave: they hold stations in directions, `held`."""
    if not held:
        held_field: Field = field
        return held_field
    if not curved:
        return ReducedField(field, basis)
    conditions = Conditions(measures_of(field, first_station, held), dependents, len(basis))
    return HeldField(field, conditions)


class _Unheld(NamedTuple):
    """Field of a beam without supports beyond its root, the stiffness of its shapes, and what heats them."""

    field: Field
    stiffness: Array
    heat: Array | None


def _unheld(beam: Beam, kind: str, counts: Counts, rule: Quadrature, at: Array, families: Families) -> _Unheld:
    """Field, stiffness and heat of a beam by the functions of its shapes, without supports beyond its root."""
    row = MODEL_KINDS[kind]
    loaded = [load.at for load in beam.loads if load.at is not None]
    x = np.concatenate([rule.node, [m.at for m in beam.masses], loaded, at])
    move, turn = beam.root.directions()
    springs = [*beam.root.springs.values()]
    zeros = np.zeros((3, sum(counts)))
    move, turn = (np.concatenate([zeros, columns], axis=1) for columns in (move, turn))
    strains = np.pad(shaped_strains(rule, families), ((0, 0), (0, 0), (0, len(springs))))
    field: Field
    if row.strains or beam.line is not None or any(counts[3:]):
        field = strain_field(rule, x, strains, move, turn, beam.line)
        if row.order is not None:
            field = SeriesField.of(field, row.order) if row.strains else ExpandedField.of(field, linear=row.order < 2)
    else:
        field = projected_field(rule, x, counts, families, foreshortening=row.order != 1)
        if springs:
            field = RootedField(field, x, *beam.root.directions(), linear=row.order == 1)
    return _Unheld(field, stiffness_of(beam, rule, strains), heat_of(beam, rule, strains))


def _structure(
    source: Source,
    kind: str,
    rule: Quadrature,
    at: Array,
    counts: Counts,
    field: Field,
    stiffness: Array,
    damping: Array | None,
    heat: Array | None,
) -> Structure:
    """Structure of a beam from its field, its stiffness, its damping (n, n), by default that of its modes, and the
    forces of a rise of its temperature by 1 K.
    """
    beam, row = source.beam, MODEL_KINDS[kind]
    loaded = [load.at for load in beam.loads if load.at is not None]
    first_station, ratio = len(rule.node) + len(beam.masses) + len(loaded), beam.damping_ratio
    station, mass, offset = particles_of(beam, rule, rotary=beam.rotary_inertia)
    off_axis = namespace(offset) is not np or offset.any()
    line = len(station) - sum(len(body.particles()[0]) for body in beam.masses)
    points = field.points(station, offset if off_axis else None)
    inertia = held_inertia(points, mass, line, len(rule.node), symmetric=beam.material is not None)
    history = load_history(beam)
    work, loaded_at = None, np.zeros(0, int)
    if history is not None:
        work, loaded_at = load_work(beam, field, rule, len(rule.node) + len(beam.masses), heat)
    rest = np.zeros(len(stiffness))
    places, geometric = inertia.expand(rest)
    c = coefficients(
        mass,
        places,
        stiffness,
        geometric=geometric,
        loads=None if work is None or history is None else work.linearise(len(history.profiles), rest),
    )
    if damping is None:
        damping = damping_matrix(0.0 if ratio is None else ratio, c.mass, c.stiffness)
    x = np.concatenate([rule.node, [m.at for m in beam.masses], loaded, at])
    return Structure(
        kind=kind,
        linear=row.truncated and not isinstance(field, HeldField),
        hub_force=row.hub_force,
        counts=counts,
        length=beam.length,
        mass=mass,
        places=places,
        stations=at,
        station_places=field.points(slice(first_station, None)).expand_rest(),
        coefficients=c.damped(damping),
        inertia=inertia,
        field=field,
        first_station=first_station,
        sections=sections_of(beam, at, rule.cumulative(x), (mass, station), loaded_at, first_station),
        history=history,
        work=work,
        load_values=None if history is None else history(np.zeros(())),
        heated=work is not None and work.heat is not None,
        damping_ratio=ratio,
        warnings=implausible_beam(beam, (counts[1] > 0, counts[2] > 0)),
        source=None if is_jax(c.mass) else source,
    )


def families_of(beam: Beam, kind: str, counts: Counts, rule: Quadrature, shapes: Shapes) -> Families:
    """Functions of a beam's shapes of a kind of model, with the static ones of its supports among their `counts`."""

    def base(counts: Counts) -> Families:
        """Functions of shapes without supports."""
        if shapes == "adapted":
            return adapted_shapes(beam, rule, counts)
        return forms_of(beam, MODEL_KINDS[kind], counts)

    return supported_shapes(beam, rule, counts, base)


def forms_of(beam: Beam, row: Kind, counts: Counts) -> Families:
    """Functions of shapes that are not adapted: polynomials of strains, or closed forms of the bare uniform beam."""
    if beam.line is not None:
        return polynomials(beam.length, counts, [corner for corner in beam.line.corners if corner > 0])
    return (polynomials if row.strains else closed_forms)(beam.length, counts)


def breaks_of(beam: Beam) -> list[float]:
    """Positions between which the section, the line and what supports bend are smooth, m."""
    supports = [support.place for support in beam.held_places.values()]
    return [*beam.section.stations, *(() if beam.line is None else beam.line.panels), *supports]


def replace_stations(structure: Structure, stations: ArrayLike) -> Structure:
    """Return the same structure of a beam with other stations of output, m. The tip is added last."""
    return remade(structure, model_of(structure), stations)


def model_of(structure: Structure) -> Model:
    """Return the model of a structure of a beam."""
    assert structure.source is not None
    kind: Any = structure.kind
    source = structure.source
    statics = static_counts(source.beam, source.counts)  # which come on top
    axial, y, z, *others = (count - more for count, more in zip(source.counts, statics, strict=True))
    return Model(kind, axial, y, z, structure.source.shapes, structure.source.automatic, *others)


def stations_asked(structure: Structure) -> tuple[float, ...]:
    """Return the stations of output of a beam's structure, m, beside its named points and the tip."""
    assert structure.source is not None
    named = [*structure.source.beam.named_points.values()]
    return tuple(float(station) for station in structure.stations[:-1] if station not in named)


def remade(structure: Structure, model: Model, stations: ArrayLike) -> Structure:
    """Return the beam of a structure in another model, with stations of output, m. The tip is added last."""
    assert structure.source is not None
    return replace(assemble(structure.source.beam, model, stations), load_values=structure.load_values)


def _nodes(kind: Kind, shapes: int) -> int:
    """Quadrature nodes per panel by which integrals with so many shapes are exact to rounding."""
    if kind.strains:  # sines of smooth angles are smooth
        return 10 + 2 * shapes
    # Fourth powers of the highest shape (2009's tensors: 32 for five), and products of two integrated to a body midway.
    return 12 + 4 * shapes


def _refuse_traced_places(beam: Beam, *, adapted: bool) -> None:
    """Raise InputError where JAX traces the length or a position: shapes and quadrature need their numbers.

    Adapted shapes need numbers of the material and the section, too.
    """
    places: dict[str, Any] = {
        "length": beam.length,
        **{f"masses[{i}].at": body.at for i, body in enumerate(beam.masses)},
    }
    places |= {f"loads[{i}].at": load.at for i, load in enumerate(beam.loads)}
    for where, value in places.items():
        if is_jax(value):
            raise InputError(where, "is traced by JAX, and the shapes are placed by its number", "give a number")
    material, dimensions = beam.material, list(beam.section.dimensions.values())
    if adapted and material and holds_jax([*vars(material).values()], dimensions):
        fix = 'give shapes = "clamped-free"'
        raise InputError("shapes", "adapted to a beam that JAX traces would be traced with it", fix)


def _stations(beam: Beam, stations: ArrayLike) -> Array:
    """Positions of output, m. Named points and supports join the stations, from root to tip; without them the stations
    keep their order. The tip is last.
    """
    positions = np.asarray(stations, dtype=float).ravel()
    for i, x in enumerate(positions):
        if not 0 <= x <= beam.length:
            raise InputError(f"stations[{i}]", f"is {x:g} m, off the beam", f"give 0 to {beam.length:g} m")
    named_positions = [
        position for name, position in beam.named_points.items() if name != TIP and position < beam.length
    ]
    named_positions += [support.place for support in beam.held_places.values() if support.place < beam.length]
    if named_positions:
        positions = np.unique(np.concatenate([positions, named_positions]))
    return np.append(positions[positions < beam.length], beam.length)
