"""Put a beam into a model."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from gbeam.arrays.namespace import holds_jax, is_jax, namespace
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.limits import NODES, refuse_more
from gbeam.mechanics.equations.inertia import inertia_of
from gbeam.mechanics.equations.linear import coefficients, damping_matrix
from gbeam.mechanics.equations.virtual_work import LoadHistory, LoadWork
from gbeam.mechanics.fields.adapted import adapted_shapes
from gbeam.mechanics.fields.basis import Families, Quadrature, closed_forms, polynomials, quadrature
from gbeam.mechanics.fields.projected import projected_field
from gbeam.mechanics.fields.rooted import Field, RootedField
from gbeam.mechanics.fields.strains import StrainField, bending_strains, strain_field
from gbeam.mechanics.fields.taylor import Places
from gbeam.mechanics.models import KINDS, Kind, Model
from gbeam.mechanics.structure import Sections, Source, Structure
from gbeam.motion.profiles.piecewise import constant
from gbeam.structure.attachments import TIP
from gbeam.structure.beam import Beam
from gbeam.structure.plausibility import implausible_beam, refuse_disparate

Array = Any


@typed
def assemble(
    beam: Beam,
    model: Model | str,
    stations: ArrayLike = (),
    *,
    axial: int = 0,
    y: int = 0,
    z: int = 0,
    shapes: str | None = None,
) -> Structure:
    """Put a beam into a model.

    Parameters
    ----------
    beam : Beam
    model : Model or str
        A model, or the kind of one with the numbers of its shapes: ``assemble(beam, "FOAM", axial=1, y=3, z=3)``.
    stations : (s,) positions along the beam where displacements are put out, m; the tip is always added last
    axial, y, z, shapes
        Of the model where only its kind is given, see :class:`Model`; without any number those of :meth:`Model.of`.

    Returns
    -------
    Structure

    Raises
    ------
    InputError
        If a station lies off the beam, the list of damping ratios does not fit the model, the section has too many
        stations to integrate between, or numbers do not hold a body or a spring beside the beam.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    >>> gb.assemble(beam, "FOAM", axial=1, y=2, z=2, stations=[0.1, 0.2]).stations
    array([0.1, 0.2, 0.3])
    """
    if isinstance(model, str):
        has_counts = axial or y or z
        model = Model(model, axial, y, z, shapes or "clamped-free") if has_counts else Model.of(model, shapes)
    row, counts = model.row, model.counts
    _refuse_traced_places(beam, adapted=model.shapes == "adapted")
    refuse_disparate(beam)
    at = _stations(beam, stations)
    bodies = [m.at for m in beam.masses]
    adapted = model.shapes == "adapted"
    breaks = [*beam.section.stations, *(bodies if adapted else ())]
    rule = quadrature(beam.length, _nodes(row, max(counts)), breaks)
    # Integrals from the root are a matrix of all nodes to all.
    nodes = len(rule.node)
    refuse_more("section.stations", "nodes of integration", nodes, NODES, 24.0 * nodes, "give fewer, or fewer shapes")
    families = adapted_shapes(beam, rule, counts) if adapted else None
    return assembled(beam, model.kind, counts, rule, at, families, model.shapes)


def assembled(
    beam: Beam,
    kind: str,
    counts: tuple[int, int, int],
    rule: Quadrature,
    at: Array,
    families: Families | None,
    shapes: str,
) -> Structure:
    """Put a beam into a model with given shapes, quadrature and stations of output (s,) m, the tip last."""
    row = KINDS[kind]
    bodies = [m.at for m in beam.masses]
    loaded = [load.at for load in beam.loads if load.at is not None]
    x = np.concatenate([rule.node, bodies, loaded, at])
    move, turn = beam.root.directions()
    springs = [*beam.root.springs.values()]
    still = np.zeros((3, sum(counts)))
    move, turn = (np.concatenate([still, each], axis=1) for each in (move, turn))
    shapes_of = families or (polynomials if row.exact else closed_forms)(beam.length, counts)
    strains = np.pad(bending_strains(rule, counts, shapes_of), ((0, 0), (0, 0), (0, len(springs))))
    field: Field
    if row.exact:
        field = strain_field(rule, x, strains, move, turn)
    else:
        field = projected_field(rule, x, counts, shapes_of, foreshortening=row.foreshortening)
        if springs:
            field = RootedField(field, x, *beam.root.directions(), linear=not row.foreshortening)
    particles, mass, station = particles_of(beam, field, rule)
    inertia = inertia_of(particles, mass)
    stiffness = stiffness_of(beam, rule, strains)
    history = _history(beam)
    work, loaded_at = None, np.zeros(0, int)
    if beam.loads:
        work, loaded_at = load_work(beam, field, rule, len(rule.node) + len(bodies))
    rest = np.zeros(len(stiffness))
    places, geometric = inertia.about(rest)
    c = coefficients(
        mass,
        places,
        stiffness,
        geometric=geometric,
        loads=None if work is None else work.about(len(beam.loads), rest),
    )
    first_station, ratio = len(rule.node) + len(bodies) + len(loaded), beam.damping_ratio
    return Structure(
        kind=kind,
        linear=row.truncated,
        hub_force=row.hub_force,
        counts=counts,
        length=beam.length,
        mass=mass,
        places=places,
        stations=at,
        station_places=field.points(slice(first_station, None)).at_rest(),
        coefficients=c.damped(damping_matrix(0.0 if ratio is None else ratio, c.mass, c.stiffness)),
        inertia=inertia,
        field=field,
        first_station=first_station,
        sections=sections_of(beam, at, rule.cumulative(x), (mass, station), loaded_at, first_station),
        history=history,
        work=work,
        load_values=None if history is None else history(np.zeros(())),
        damping_ratio=ratio,
        warnings=implausible_beam(beam, (counts[1] > 0, counts[2] > 0)),
        source=None if is_jax(c.mass) else Source(beam, shapes),
    )


def at_stations(structure: Structure, stations: ArrayLike) -> Structure:
    """Return the same structure of a beam with other stations of output, m; the tip is added last."""
    assert structure.source is not None
    model = Model(structure.kind, *structure.counts, structure.source.shapes)
    return replace(assemble(structure.source.beam, model, stations), load_values=structure.load_values)


def _nodes(kind: Kind, shapes: int) -> int:
    """Nodes per panel, for integrals to rounding."""
    if kind.exact:  # sines of smooth angles are smooth
        return 10 + 2 * shapes
    # Fourth powers of the highest shape (2009's tensors: 32 for five), and products of two integrated to a body midway.
    return 12 + 4 * shapes


def _refuse_traced_places(beam: Beam, *, adapted: bool) -> None:
    """Raise InputError where shapes and quadrature would need a number that JAX traces."""
    places: dict[str, Any] = {
        "length": beam.length,
        **{f"masses[{i}].at": body.at for i, body in enumerate(beam.masses)},
    }
    places |= {f"loads[{i}].at": load.at for i, load in enumerate(beam.loads)}
    for where, value in places.items():
        if is_jax(value):
            raise InputError(where, "is traced by JAX, and the shapes are placed by its number", "give a number")
    material, dimensions = beam.material, list(beam.section.dimensions.values())
    if adapted and holds_jax(material.youngs_modulus, material.density, material.poissons_ratio, dimensions):
        fix = 'give shapes = "clamped-free"'
        raise InputError("shapes", "adapted to a beam that JAX traces would be traced with it", fix)


def _stations(beam: Beam, stations: ArrayLike) -> Array:
    positions = np.asarray(stations, dtype=float).ravel()
    for i, x in enumerate(positions):
        if not 0 <= x <= beam.length:
            raise InputError(f"stations[{i}]", f"is {x:g} m, off the beam", f"give 0 to {beam.length:g} m")
    named = [at for name, at in beam.named_points.items() if name != TIP and at < beam.length]
    if named:  # among the others, from root to tip
        positions = np.unique(np.concatenate([positions, named]))
    return np.append(positions[positions < beam.length], beam.length)


def particles_of(beam: Beam, field: Field, rule: Quadrature) -> tuple[StrainField | Places, Array, Array]:
    """The beam's quadrature points and its bodies' particles: their field, their masses kg, and each one's point."""
    nodes, area = len(rule.node), beam.section.at(rule.node).area
    station, mass, offset = [np.arange(nodes)], [beam.material.density * area * rule.weight], [np.zeros((nodes, 3))]
    for k, body in enumerate(beam.masses):
        masses, places = body.particles()
        station.append(np.full(len(masses), nodes + k))
        mass.append(masses)
        offset.append(places)
    xp = namespace(*mass, *offset)
    off_axis = xp is not np or any(place.any() for place in offset)
    at, arm = np.concatenate(station), xp.concatenate(offset)
    return field.points(at, arm if off_axis else None), xp.concatenate(mass), at


def stiffness_of(beam: Beam, rule: Quadrature, strains: Array) -> Array:
    """Second derivatives (n, n) of the energy ½ ∫ EA ε² + EI_y κ_y² + EI_z κ_z² dx + ½ Σ k s² of strains (6, g, n), the
    root's springs last (2009 (10); 2020 (8), corrected).
    """
    springs = [*beam.root.springs.values()]
    axial, about_y, about_z = beam.rigidities(rule.node)
    parts = []
    for rigidity, shapes in zip((axial, about_y, about_z), strains[[0, 4, 5]], strict=True):
        parts.append(shapes.T @ ((rigidity * rule.weight)[:, None] * shapes))
    xp = namespace(*springs, *parts)
    n = strains.shape[2]
    held = xp.concatenate([np.zeros(n - len(springs)), xp.asarray(springs, dtype=float)])
    return sum(parts[1:], start=parts[0]) + xp.diag(held)


def _history(beam: Beam) -> LoadHistory | None:
    def profile(value: Any) -> Any:
        return value if callable(value) else constant(np.zeros(3) if value is None else value)

    if not beam.loads:
        return None
    return LoadHistory(tuple((profile(load.force), profile(load.moment)) for load in beam.loads))


def load_work(beam: Beam, field: Field, rule: Quadrature, first: int) -> tuple[LoadWork, Array]:
    """Find the work of the loads, at points of their own, counted from `first`, or on all quadrature nodes; and these
    points.
    """
    station, which, weight = [], [], []
    for k, load in enumerate(beam.loads):
        if load.at is None:
            station.append(np.arange(len(rule.node)))
            weight.append(rule.weight)
        else:
            station.append(np.array([first]))
            weight.append(np.ones(1))
            first += 1
        which.append(np.full(len(station[-1]), k))
    at, of_load = np.concatenate(station), np.concatenate(which)
    follower = np.array([load.follower for load in beam.loads])[of_load]
    return LoadWork(field.sections(at), of_load, np.concatenate(weight), follower), at


def sections_of(
    beam: Beam,
    at: Array,
    until: Array,
    particles: tuple[Array, Array],
    loaded: Array,
    first: int,
) -> Sections:
    """Sections at the root, on the base's side of its springs, and at the stations, with what is outboard of each;
    `until` (points, g) integrates from the root to the field's points.
    """
    nodes = until.shape[1]
    weight, x = until[-1], until.sum(axis=1)  # the tip is the last point: the whole integral
    share = 1 - np.concatenate([np.zeros((1, nodes)), until[first:]]) / weight
    stations = np.concatenate([[0.0], x[first:]])
    # Of each of the field's points: of a node the share of its panel, of another point all or nothing.
    whole = x[None, nodes:] >= stations[:, None] - 1e-9 * beam.length
    beyond = np.concatenate([share, whole], axis=1)
    return Sections(
        values=beam.section.at(np.append(0.0, at)),
        mass=beyond[:, particles[1]] * particles[0],
        loaded=beyond[:, loaded],
        yield_strength=beam.material.yield_strength,
        fatigue_exponent=beam.material.fatigue_exponent,
    )
