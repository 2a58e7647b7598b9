"""Internal loads along the beam by the inertia-force integral; nothing here differentiates a mode shape.

The section at x carries what the particles outboard of it need and do not get: F(x) = −Σ m_k a_k and
M(x) = −Σ (r_k − r_x) × m_k a_k, and what loads on the outboard part bring besides, with the absolute acceleration (or
specific force, where gravity acts) a = a_O + α × r + ω × (ω × r) + 2ω × ṙ + r̈ (2020 (4), complete). The beam's share
of the sum is an integral from x to the tip, as accurate as the quadrature of the energy.

A truncated model (TLAM, FOAM, SFOAM) takes its loads from the positions of its displacement field, which are those of
the complete energy: its loads differ from its own generalised forces by terms of third order in (q, q̇).
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array

import gbeam.arrays.jax_setup  # noqa: F401
from gbeam.analysis.study.case import Motion
from gbeam.mechanics.assembly import Structure
from gbeam.mechanics.equations import coefficients
from gbeam.mechanics.field import ExactField, ProjectedField, RootedField
from gbeam.motion import Base, HubRate, HubTorque
from gbeam.results.response import BaseHistory, Floats, Response
from gbeam.results.section_forces import Influence, Loads
from gbeam.structure.beam import Beam

_BLOCK = 1024  # times per compiled call


class Outboard(eqx.Module):
    """Sections, and what lies outboard of each.

    Parameters
    ----------
    points : (s − 1,) index of the sections' points in the field; the first section is the root
    mass : (s, particles) kg
    loaded : (s, loaded points) 1, or m of a load per length
    """

    points: Array
    mass: Array
    loaded: Array


def cumulative_of(structure: Structure) -> Floats:
    """Weights (points, nodes) that integrate nodal values from the root to each of the field's points."""
    field = structure.field
    inner = field.inner if isinstance(field, RootedField) else field
    assert isinstance(inner, (ProjectedField, ExactField))
    return np.asarray(inner.cumulative)


def outboard_of(structure: Structure) -> Outboard:
    """Return what lies outboard of the root and of the structure's stations.

    The root is put before the structure's stations: on the base's side of its springs, if it has any.
    """
    particles, until = structure.particles, cumulative_of(structure)
    first, nodes = structure.first_station, until.shape[1]
    weight = until[-1]  # the tip is the last point: the whole integral
    at = until.sum(axis=1)
    inboard = np.concatenate([np.zeros((1, nodes)), until[first:]])
    stations = np.concatenate([[0.0], at[first:]])
    share = 1 - inboard / weight
    # Of each of the field's points: of a node the share of its panel, of another point all or nothing.
    whole = at[None, nodes:] >= stations[:, None] - 1e-9 * structure.length
    beyond = np.concatenate([share, whole], axis=1)
    mass = beyond[:, np.asarray(particles.station)] * np.asarray(particles.mass)
    work = structure.applied
    loaded = np.empty((len(stations), 0)) if work is None else beyond[:, np.asarray(work.station)] * work.weight
    return Outboard(jnp.arange(first, len(at)), jnp.asarray(mass), jnp.asarray(loaded))


def sections(
    structure: Structure, outboard: Outboard, base: Base, q: Array, qd: Array, qdd: Array, applied: Array | None
) -> tuple[Array, ...]:
    """Return what the sections carry at one time, and how they accelerate.

    Parameters
    ----------
    structure : Structure
    outboard : Outboard
    base : Base
        Arrays (3,).
    q, qd, qdd : (n,)
    applied : (loads, 6) or None
        Components of the loads on the beam.

    Returns
    -------
    force, moment : (s, 3) base axes, N and N m
    force, moment : (s, 3) section axes
    acceleration : (s, 3) base axes, m/s²; specific force where gravity acts
    """
    field, work = structure.field, structure.applied
    w, al = base.w_WB_B, base.alpha_WB_B

    def everything(q: Array) -> tuple[Array, Array]:
        stations = jnp.concatenate([jnp.zeros((1, 3)), field.position(q)[outboard.points]])
        return structure.particles.particles(q), stations

    def moving(q: Array, qd: Array) -> Any:
        return jax.jvp(everything, (q,), (qd,))

    (r, rd), (_, rdd) = jax.jvp(moving, (q, qd), (qd, qdd))

    def absolute(r: Array, rd: Array, rdd: Array) -> Array:
        turning = jnp.cross(al, r) + jnp.cross(w, jnp.cross(w, r) + 2 * rd)
        return base.a_WO_B + turning + rdd

    (particle, station), a = r, [absolute(*each) for each in zip(r, rd, rdd, strict=True)]
    # Σ m (r − r_x) × a = Σ m r × a − r_x × Σ m a, and so for the loads.
    force, about_root = -outboard.mass @ a[0], -outboard.mass @ jnp.cross(particle, a[0])
    if work is not None and applied is not None:
        at, rotation = field.position(q)[work.station], field.rotation(q)[work.station]
        axes = jnp.where(work.follower[:, None, None], rotation, jnp.eye(3))
        here = applied[work.load]
        pull, turn = (jnp.einsum("pij,pj->pi", axes, part) for part in (here[:, :3], here[:, 3:]))
        force, about_root = force + outboard.loaded @ pull, about_root + outboard.loaded @ (jnp.cross(at, pull) + turn)
    moment = about_root - jnp.cross(station, force)
    rotation = jnp.concatenate([jnp.eye(3)[None], field.rotation(q)[outboard.points]])
    inward = jnp.swapaxes(rotation, 1, 2)
    return force, moment, jnp.einsum("sij,sj->si", inward, force), jnp.einsum("sij,sj->si", inward, moment), a[1]


@eqx.filter_jit
def _over_time(structure: Structure, outboard: Outboard, t: Array, base: Base, *state: Array) -> tuple[Array, ...]:
    """Sections at times (t, ...)."""

    def at(t: Array, base: Base, q: Array, qd: Array, qdd: Array) -> tuple[Array, ...]:
        applied = None if structure.history is None else structure.history(t)
        return sections(structure, outboard, base, q, qd, qdd, applied)

    return jax.vmap(at)(t, base, *state)


def section_loads(
    structure: Structure,
    beam: Beam,
    base: BaseHistory,
    q: Floats,
    qd: Floats,
    qdd: Floats,
    time: Floats | None = None,
) -> Loads:
    """Return the loads at the root and the structure's stations for given motions of beam and base.

    Parameters
    ----------
    structure : Structure
    beam : Beam
        The one that the structure was assembled from: its section tells the stress.
    base : BaseHistory
        (t, 3) each.
    q, qd, qdd : (t, n)
        Coordinates, their rates and accelerations; zeros of the last two for a relative equilibrium.
    time : (t,), optional
        s; needed where loads act on the beam that change with time, else zero.

    Returns
    -------
    Loads
    """
    outboard = outboard_of(structure)
    when = np.zeros(len(q)) if time is None else time
    given = tuple(np.asarray(x) for x in (when, base.a_WO_B, base.w_WB_B, base.alpha_WB_B, q, qd, qdd))
    count = len(given[0])
    size = min(_BLOCK, max(count, 1))
    padded = [np.concatenate([x, np.repeat(x[-1:], -count % size, axis=0)]) for x in given]
    pieces = []
    for i in range(0, len(padded[0]), size):
        part = [jnp.asarray(x[i : i + size]) for x in padded]
        pieces.append([np.asarray(x) for x in _over_time(structure, outboard, part[0], Base(*part[1:4]), *part[4:])])
    force, moment, section_force, section_moment, a = (
        np.concatenate([piece[k] for piece in pieces])[:count] for k in range(5)
    )
    stations = np.append(0.0, np.asarray(structure.stations))
    here = beam.section.at(stations)
    bending = np.abs(section_moment[..., 1]) * here.extreme_fibre_z / here.inertia_y
    bending = bending + np.abs(section_moment[..., 2]) * here.extreme_fibre_y / here.inertia_z
    stress = section_force[..., 0] / here.area + bending
    return Loads(stations, force, moment, section_force, section_moment, stress, a)


def internal_loads(
    structure: Structure,
    beam: Beam,
    response: Response,
    motion: Motion | None = None,
) -> Loads:
    """Return the internal loads of a response.

    Parameters
    ----------
    structure : Structure
        Of the response's model; its stations may be others than the response's.
    beam : Beam
    response : Response
    motion : Flight, Centrifuge, HubRate or HubTorque, optional
        Of the response: with a hub's the torque that a slew needs is told.

    Returns
    -------
    Loads
    """
    loads = section_loads(structure, beam, response.base, response.q, response.qd, response.qdd, response.time)
    return about_the_hub(loads, motion, response.base.alpha_WB_B)


def about_the_hub(loads: Loads, motion: Motion | None, alpha_WB_B: Floats) -> Loads:
    """The same loads, on a hub with the torque about its axis, however the beam is mounted on it.

    Parameters
    ----------
    loads : Loads
    motion : Flight, Centrifuge, HubRate, HubTorque or None
        Of the base. A free hub's inertia is known, and so is the torque of its drive.
    alpha_WB_B : (t, 3)
        Angular acceleration of the base, rad/s².
    """
    if not isinstance(motion, (HubRate, HubTorque)):
        return loads
    mount, inertia = motion.mount, float(motion.inertia) if isinstance(motion, HubTorque) else np.nan
    turned = np.asarray(mount.R_HB).T
    force_H, moment_H, al_H = (x @ turned for x in (loads.root_force, loads.root_moment, alpha_WB_B))
    torque = moment_H[:, 2] + float(mount.radius) * force_H[:, 1]
    return replace(loads, beam_torque=torque, drive_torque=torque + inertia * al_H[:, 2])


@eqx.filter_jit
def _straight(structure: Structure) -> tuple[Array, Array]:
    """Displacement of the tip per coordinate, (3, n), and the places of the particles, of the straight beam."""
    zero = jnp.zeros(structure.size)
    return jax.jacfwd(structure.displacement)(zero)[-1], structure.particles.particles(zero)


def influence(structure: Structure) -> Influence:
    """Return the static answer of the straight beam at rest to uniform and linearly growing acceleration fields.

    The fields are those of the base itself: translation, angular acceleration about z and y (a_y = α_z x, a_z = −α_y x)
    and a centripetal field (a_x = −ω² x), so that the answer holds for any model, section and bodies.
    """
    c = coefficients(structure.system)
    stiffness = np.asarray(c.stiffness)
    uniform = np.asarray(c.f_a)
    linear = np.stack([-np.asarray(c.f_ww)[2, 2], np.asarray(c.f_al)[2], -np.asarray(c.f_al)[1]])
    per_q, places = (np.asarray(it) for it in _straight(structure))

    def tip(load: Floats) -> Floats:
        return np.asarray(np.diagonal(per_q @ np.linalg.solve(stiffness, load.T)))

    mass, x = np.asarray(structure.particles.mass), places[:, 0]
    first, second = float(mass @ x), float(mass @ x**2)
    across = np.array([0.0, 1.0, 1.0])
    return Influence(
        tip_uniform=tip(uniform),
        tip_linear=tip(linear),
        force_uniform=np.full(3, -float(mass.sum())),
        force_linear=np.full(3, -first),
        moment_uniform=-first * across,
        moment_linear=-second * across,
    )
