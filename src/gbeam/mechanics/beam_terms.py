"""Terms of a beam in a model: its particles, its stiffness, its loads and its sections."""

from __future__ import annotations

from typing import Any

import numpy as np

from gbeam.arrays.namespace import Array, namespace
from gbeam.mechanics.equations.virtual_work import LoadHistory, LoadWork
from gbeam.mechanics.fields.basis import Quadrature
from gbeam.mechanics.fields.projected import Field
from gbeam.mechanics.recovery import Sections
from gbeam.motion.profiles.piecewise import constant
from gbeam.structure.beam import Beam
from gbeam.structure.matrices import condensed
from gbeam.structure.matrices import particles as particles_of_slices

# Particles in place of a section, in radii of gyration: of its mass, centre and second moments.
TRIANGLE = np.sqrt(2) * np.array([(np.cos(angle), np.sin(angle)) for angle in 2 * np.pi / 3 * np.arange(3)])


def particles_of(beam: Beam, rule: Quadrature, *, rotary: bool) -> tuple[Array, Array, Array]:
    """Particles (p,) that stand for the beam's sections and its bodies.

    Returns the index of the field's point (a node or a body), the mass, kg, and the offset from the axis (p, 3), m.
    Sections come first: one particle a node, or three with `rotary` inertia, or as many as a section's mass matrix
    needs.
    """
    nodes, section = len(rule.node), beam.section.at(rule.node)
    line_mass = beam.density * section.area * rule.weight
    station, mass, offset = [np.arange(nodes)], [line_mass], [np.zeros((nodes, 3))]
    if beam.material is None:
        mass_shares, places = particles_of_slices(beam.section.matrices(rule.node)[1], rotary=rotary)
        station, mass, offset = station * len(mass_shares), [*(line_mass * mass_shares)], [*places]
    elif rotary:
        xp = namespace(line_mass, section.area, section.inertia_y, section.inertia_z)
        # Three equal particles in a triangle that is stretched to the radii of gyration.
        radius_y = xp.sqrt(section.inertia_z / section.area)
        radius_z = xp.sqrt(section.inertia_y / section.area)
        station, mass = station * 3, [line_mass / 3] * 3
        offset = [xp.stack([0 * line_mass, y * radius_y, z * radius_z], axis=1) for y, z in TRIANGLE]
    for k, body in enumerate(beam.masses):
        masses, places = body.particles()
        station.append(np.full(len(masses), nodes + k))
        mass.append(masses)
        offset.append(places)
    xp = namespace(*mass, *offset)
    return np.concatenate(station), xp.concatenate(mass), xp.concatenate(offset)


def stiffness_of(beam: Beam, rule: Quadrature, strains: Array) -> Array:
    """Stiffness (n, n) of shapes with strains (6, g, n). The last coordinates are the root's springs.

    It holds the second derivatives of the energy ½ ∫ Σ rigidity · strain² dx + ½ Σ k s² (2009 (10); 2020 (8),
    corrected; shear and twist as Timoshenko has them). A section without material has a full stiffness matrix in place
    of rigidities.
    """
    springs = [*beam.root.springs.values()]
    if beam.material is None:
        shaped = [k for k in range(6) if strains[k].any()]
        matrix = condensed(beam.section.matrices(rule.node)[0], shaped)
        einsum = namespace(matrix).einsum
        forces = einsum("g,gab,bgj->agj", rule.weight, matrix, strains[shaped])
        parts = [einsum("agi,agj->ij", strains[shaped], forces)]
    else:
        parts = []
        for rigidity, shapes in zip(beam.stiffnesses(rule.node), strains, strict=True):
            if shapes.any():
                parts.append(shapes.T @ ((rigidity * rule.weight)[:, None] * shapes))
    xp = namespace(*springs, *parts)
    n = strains.shape[2]
    by_springs = xp.concatenate([np.zeros(n - len(springs)), xp.asarray(springs, dtype=float)])
    return sum(parts, start=xp.diag(by_springs))


def root_dashpots(beam: Beam, size: int) -> Array:
    """Damping (n, n) of the dampers beside a root's springs, the last of `size` coordinates."""
    dampers = beam.root_dampers
    xp = namespace(*dampers)
    return xp.diag(xp.concatenate([np.zeros(size - len(dampers)), xp.asarray(dampers, dtype=float)]))


def load_history(beam: Beam) -> LoadHistory | None:
    """Components of the beam's loads over time, as profiles, and the rise of its temperature behind them, as the first
    component of one more, or None without any.
    """

    def profile(value: Any) -> Any:
        return value if callable(value) else constant(np.zeros(3) if value is None else value)

    profiles = [tuple(map(profile, load.acting)) for load in beam.loads]
    if beam.temperature is not None:
        profiles.append(beam.temperature.profiles)
    return LoadHistory(tuple(profiles)) if profiles else None


def heat_of(beam: Beam, rule: Quadrature, strains: Array) -> Array | None:
    """Forces (n,) by which a rise of the temperature by 1 K stretches shapes with strains (6, g, n): α ∫ EA ε dx.

    None where the beam has no temperature.
    """
    if beam.temperature is None:
        return None
    axial, *_ = beam.rigidities(rule.node)
    return beam.metal.expansion * (axial * rule.weight) @ strains[0]


def load_work(beam: Beam, field: Field, rule: Quadrature, first: int, heat: Array | None) -> tuple[LoadWork, Array]:
    """Work of the beam's loads, and the indices of the field's points where they act.

    A spread load acts at all quadrature nodes. A load at one place has its own point. These begin at index `first`.
    `heat` (n,) are the forces of a rise of the temperature by 1 K, which acts along no point: it has the first one
    with no weight.
    """
    station, load_index, weight = [], [], []
    for k, load in enumerate(beam.loads):
        if load.at is None:
            station.append(np.arange(len(rule.node)))
            weight.append(rule.weight)
        else:
            station.append(np.array([first]))
            weight.append(np.ones(1))
            first += 1
        load_index.append(np.full(len(station[-1]), k))
    followers = [load.follower for load in beam.loads]
    if heat is not None:
        station.append(np.zeros(1, dtype=int))
        load_index.append(np.full(1, len(beam.loads)))
        weight.append(np.zeros(1))
        followers.append(False)
    points, load_of_point = np.concatenate(station), np.concatenate(load_index)
    follower = np.array(followers)[load_of_point]
    return LoadWork(field.sections(points), load_of_point, np.concatenate(weight), follower, heat), points


def sections_of(
    beam: Beam,
    positions: Array,
    until: Array,
    particles: tuple[Array, Array],
    loaded: Array,
    first: int,
) -> Sections:
    """Sections at the root, on the base's side of its springs, and at stations `at`, m, with the masses and loads
    outboard of each.

    `until` (points, g) integrates from the root to the field's points, of which the stations begin at index `first`.
    `particles` are the masses, kg, and the indices of their points. `loaded` are the points of the loads.
    """
    nodes = until.shape[1]
    weight, x = until[-1], until.sum(axis=1)  # the tip is the last point: the whole integral
    node_share = 1 - np.concatenate([np.zeros((1, nodes)), until[first:]]) / weight
    stations = np.concatenate([[0.0], x[first:]])
    # Share of each point that is outboard of a station: of a node part of its integral, of others all or none.
    is_outboard = x[None, nodes:] >= stations[:, None] - 1e-9 * beam.length
    outboard_share = np.concatenate([node_share, is_outboard], axis=1)
    return Sections(
        values=beam.section.at(np.append(0.0, positions)),
        along=x,
        stresses=beam.section.stresses(np.append(0.0, positions)),
        root_axes=np.eye(3) if beam.line is None else beam.line.places(0.0)[1][0],
        mass=outboard_share[:, particles[1]] * particles[0],
        loaded=outboard_share[:, loaded],
        yield_strength=None if beam.material is None else beam.material.yield_strength,
        fatigue_exponent=np.nan if beam.material is None else beam.material.fatigue_exponent,
    )
