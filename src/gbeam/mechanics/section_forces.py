"""Internal loads along the beam by the inertia-force integral; nothing here differentiates a mode shape.

The section at x carries what the particles outboard of it need and do not get: F(x) = −Σ m_k a_k and
M(x) = −Σ (r_k − r_x) × m_k a_k, and what loads on the outboard part bring besides, with the absolute acceleration (or
specific force, where gravity acts) a = a_O + α × r + ω × (ω × r) + 2ω × ṙ + r̈ (2020 (4), complete). The beam's share
of the sum is an integral from x to the tip, as accurate as the quadrature of the energy.

A truncated model (TLAM, FOAM, SFOAM) takes its loads from the places' polynomial, where the model ends: its loads
differ from its own generalised forces by terms of third order in (q, q̇).
"""

from __future__ import annotations

from dataclasses import replace
from operator import itemgetter
from typing import Any, NamedTuple

import numpy as np

from gbeam.arrays.namespace import Array, is_jax, namespace
from gbeam.arrays.tree import each_leaf
from gbeam.mechanics.causes import loads_at
from gbeam.mechanics.fields.held import HeldField
from gbeam.mechanics.fields.taylor import Places
from gbeam.mechanics.fields.vectors import cross, joined, skew, split
from gbeam.mechanics.reactions import Hung, Reactions, reactions_of
from gbeam.mechanics.recovery import Sections
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.body_terms import terms_of
from gbeam.mechanics.tree.frames import Frame
from gbeam.motion.protocol import Motion
from gbeam.results.parts import Base, Loads
from gbeam.structure.section import extreme_stresses, worst_fibres
from gbeam.structure.shapes import von_mises

_BLOCK = 256  # times handled together: what stays in a cache


class Carried(NamedTuple):
    """Forces and moments (t, s, 3) that sections carry, in axes of the base and in their own.

    With them are absolute accelerations (specific forces where gravity acts) and places of the sections, base axes.
    """

    force: Array
    moment: Array
    section_force: Array
    section_moment: Array
    acceleration: Array
    place: Array


def section_forces(
    structure: Structure,
    base: Base,
    q: Array,
    qd: Array,
    qdd: Array,
    time: Array,
    *,
    motion: Motion | None = None,
    hung: Hung | None = None,
) -> Loads:
    """Loads at root and stations by motions of the base (t, 3) and of the beam (t, n), with bodies `hung` on it.

    A structure without sections has them at its root and tip only.
    """
    if structure.sections is None:
        return add_hub_torques(_end_loads(structure, base, q, qd, qdd, time, hung), motion, base.alpha_WB_B)
    xp = namespace(q, base.a_WO_B)
    applied = loads_at(structure, time)
    reactions = reactions_of(structure, base, q, qd, qdd, applied, hung)
    if reactions is not None:
        hung = reactions.with_hung(hung)
    pieces = []
    for i in range(0, len(q), _BLOCK):
        part = slice(i, i + _BLOCK)
        values = None if applied is None else applied[part]
        on_stations = None if hung is None else hung.during(part)
        base_then, p, pd, pdd = each_leaf(itemgetter(part), (base, q, qd, qdd))
        pieces.append(sections(structure, structure.sections, base_then, p, pd, pdd, values, on_stations))
    force, moment, section_force, section_moment, a, _ = (
        xp.concatenate(blocks) if len(pieces) > 1 else blocks[0] for blocks in zip(*pieces, strict=True)
    )
    section_data = structure.sections
    tension, compression = extreme_stresses(section_data.values, section_force, section_moment)
    loads = Loads(
        stations=np.append(0.0, structure.stations),
        force=force,
        moment=moment,
        section_force=section_force,
        section_moment=section_moment,
        stress_tension=tension,
        stress_compression=compression,
        von_mises=None if is_jax(tension) else _equivalent(section_data, section_force, section_moment),
        acceleration=a,
        fibre=None if is_jax(tension) else worst_fibres(section_data.values, section_force, section_moment),
        yield_strength=section_data.yield_strength,
        fatigue_exponent=section_data.fatigue_exponent,
    )
    if reactions is not None:
        loads = with_supports(loads, structure, reactions)
    return add_hub_torques(loads, motion, base.alpha_WB_B)


def with_supports(loads: Loads, structure: Structure, reactions: Reactions) -> Loads:
    """Add to loads those of the supports, and what the base does to the structure in all, about its root."""
    demanded, places = reactions.demanded, structure.grip and structure.grip.places
    return replace(
        loads,
        supports=places.r0[:, 0] if places else np.asarray(structure.stations)[reactions.station],
        support_names=reactions.names or None,
        support_force=reactions.force,
        support_moment=reactions.moment,
        base_force=loads.root_force - demanded.force.sum(axis=1),
        base_moment=loads.root_moment - demanded.moment.sum(axis=1),
    )


def _end_loads(
    structure: Structure, base: Base, q: Array, qd: Array, qdd: Array, time: Array, hung: Hung | None
) -> Loads:
    """Loads at the root of a structure without sections, and at its tip, which carries nothing; without stress."""
    xp = namespace(q, base.a_WO_B)
    applied = loads_at(structure, time)
    root = Frame(None, None, None, base.w_WB_B, base.a_WO_B, base.alpha_WB_B)
    wrench = terms_of(structure).demanded(q, qd, qdd, root, applied)[1]
    demanded = [wrench.force, wrench.moment]
    reactions = reactions_of(structure, base, q, qd, qdd, applied, hung)
    on_root = hung if reactions is None else reactions.with_hung(hung)
    if on_root is not None:
        demanded = [demanded[0] + on_root.force.sum(axis=1), demanded[1] + on_root.moment.sum(axis=1)]
    force, moment = (xp.stack([-at_root, 0 * at_root], axis=1) for at_root in demanded)
    tip = absolute_accelerations(xp, base, *structure.output[-1:].paths(q, qd, qdd))
    unknown = xp.full(force.shape[:2], np.nan)
    loads = Loads(
        stations=np.append(0.0, structure.stations[-1:]),
        force=force,
        moment=moment,
        section_force=force,
        section_moment=moment,
        stress_tension=unknown,
        stress_compression=unknown,
        acceleration=xp.concatenate([base.a_WO_B[:, None], tip], axis=1),
    )
    if reactions is None or structure.grip is None:
        return loads
    all_loads, nothing = with_supports(loads, structure, reactions), 0 * force
    if structure.grip.rooted:
        return all_loads
    return replace(all_loads, force=nothing, moment=nothing, section_force=nothing, section_moment=nothing)


def _equivalent(section_data: Sections, force: Array, moment: Array) -> Array:
    """Largest von Mises stress of sections (t, s), Pa: at their points, or of the normal stress alone between these."""
    tension, compression = extreme_stresses(section_data.values, force, moment)
    at_points = von_mises(section_data.stresses, force, moment)
    return np.maximum(at_points, np.maximum(tension, -compression)) + 0.0  # no minus zero


def sections(
    structure: Structure,
    outboard: Sections,
    base: Base,
    q: Array,
    qd: Array,
    qdd: Array,
    values: Array | None,
    hung: Hung | None = None,
) -> Carried:
    """Loads (t, s, 3) that the root and the s − 1 stations carry, from what is `outboard` of each.

    `values` (t, loads, 6) are load components; bodies `hung` on the structure pull, too.
    """
    count = outboard.mass.shape[0] - 1
    particles, stations, turned = _paths_outward(structure, count, q, qd, qdd)
    xp = namespace(q, particles[0], base.a_WO_B)
    root = (xp.zeros_like(stations[0][:, :1]),) * 3
    stations = tuple(xp.concatenate(pair, axis=1) for pair in zip(root, stations, strict=True))
    a_particles, a_stations = absolute_accelerations(xp, base, *particles), absolute_accelerations(xp, base, *stations)
    # Σ m (r − r_x) × a = Σ m r × a − r_x × Σ m a, and so for the loads.
    mass = xp.asarray(outboard.mass)
    force, moment_about_root = -mass @ a_particles, -mass @ _cross(xp, particles[0], a_particles)
    if structure.work is not None and values is not None:
        loaded = structure.work.field
        load_force, load_moment = structure.work.forces(loaded.rotation(q), values)
        share = xp.asarray(outboard.loaded)
        force, moment_about_root = (
            force + share @ load_force,
            moment_about_root + share @ (_cross(xp, loaded.positions(q), load_force) + load_moment),
        )
    if hung is not None:
        sections_at = np.append(0.0, structure.stations)
        is_beyond = (structure.stations[hung.station] >= sections_at[:, None] - 1e-9 * structure.length).astype(float)
        force, moment_about_root = force - is_beyond @ hung.force, moment_about_root - is_beyond @ hung.moment
    moment = moment_about_root - _cross(xp, stations[0], force)
    straight = xp.broadcast_to(xp.asarray(outboard.root_axes), (len(q), 1, 3, 3))
    rotation = xp.concatenate([straight, turned], axis=1)

    def inward(vectors: Array) -> Array:
        return xp.einsum("tsji,tsj->tsi", rotation, vectors)

    return Carried(force, moment, inward(force), inward(moment), a_stations, stations[0])


def _paths_outward(structure: Structure, count: int, q: Array, qd: Array, qdd: Array) -> tuple[Any, Any, Array]:
    """Paths (t, p, 3) of particles and the last `count` stations, and rotations (t, count, 3, 3) of the stations."""
    particles: Any = structure.particles
    last = slice(-count, None)
    stations: Any = structure.output[last]
    if not isinstance(particles.free if isinstance(particles, HeldField) else particles, Places):
        paths, turned = particles.joined(stations).poses(q, qd, qdd, last)
        return tuple(path[:, :-count] for path in paths), tuple(path[:, last] for path in paths), turned
    xp = namespace(q, structure.mass)
    turned = xp.broadcast_to(xp.eye(3), (len(q), count, 3, 3))
    if structure.field is not None:
        turned = structure.field.rotation(q, last)
    return particles.paths(q, qd, qdd), stations.paths(q, qd, qdd), turned


def accelerations(structure: Structure, base: Base, q: Array, qd: Array, qdd: Array) -> Array:
    """Absolute accelerations (t, s, 3) of the stations (specific force where gravity acts), base axes."""
    return absolute_accelerations(namespace(q, base.a_WO_B), base, *structure.output.paths(q, qd, qdd))


def absolute_accelerations(xp: Any, base: Base, r: Array, rd: Array, rdd: Array) -> Array:
    """Absolute accelerations (t, p, 3) of points, base axes, from their motion (t, p, 3) relative to the base.

    They are a_O + (α× + ω×ω×) r + 2 ω × ṙ + r̈. The products with r and ṙ are one product of matrices.
    """
    w, alpha, linear = base.w_WB_B, base.alpha_WB_B, base.a_WO_B[:, None, :]
    if xp is np and not (w.any() or alpha.any()):
        return linear + rdd
    spin = skew(xp, w)
    by_place_and_rate = xp.concatenate([skew(xp, alpha) + spin @ spin, 2 * spin], axis=-1)
    return linear + xp.concatenate([r, rd], axis=-1) @ xp.swapaxes(by_place_and_rate, -1, -2) + rdd


def _cross(xp: Any, left: Array, right: Array) -> Array:
    """left × right, (..., 3)."""
    return joined(xp, cross(split(left), split(right)), np.broadcast_shapes(left.shape[:-1], right.shape[:-1]))


def add_hub_torques(loads: Loads, motion: Motion | None, alpha_WB_B: Array) -> Loads:
    """Add to loads the beam's torque about a hub's axis and, if the hub's inertia is given, the torque of its drive.

    With other motions the loads are returned as they are. `alpha_WB_B` (t, 3), rad/s², is the base's.
    """
    if motion is None or motion.kind != "hub":
        return loads
    hub: Any = motion
    xp = namespace(loads.force, hub.mount.R_HB)
    R_BH = xp.asarray(hub.mount.R_HB).T
    force, moment = loads.root_force, loads.root_moment
    if loads.base_force is not None and loads.base_moment is not None:  # of the root and the supports
        force, moment = loads.base_force, loads.base_moment
    force_H, moment_H, alpha_H = force @ R_BH, moment @ R_BH, alpha_WB_B @ R_BH
    along, across = hub.mount.place[0], hub.mount.place[1]
    torque = moment_H[:, 2] + along * force_H[:, 1] - across * force_H[:, 0]
    drive = None if hub.inertia is None else torque + hub.inertia * alpha_H[:, 2]
    return replace(loads, beam_torque=torque, drive_torque=drive)
