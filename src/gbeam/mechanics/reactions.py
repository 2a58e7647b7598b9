"""Reactions of supports: what they do to a structure, from the forces that its motion demands of what they hold."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from gbeam.arrays.namespace import Array, namespace
from gbeam.mechanics.fields.products import quadratic
from gbeam.mechanics.structure import Grip, Structure
from gbeam.mechanics.tree.body_terms import terms_of
from gbeam.mechanics.tree.frames import Frame
from gbeam.results.parts import Base


class Hung(NamedTuple):
    """Forces and moments about the root (t, p, 3) that other bodies demand of the stations (p,) on which they hang."""

    station: Array
    force: Array
    moment: Array

    def during(self, part: Any) -> Hung:
        """Return the forces and moments at some of the times."""
        return self._replace(force=self.force[part], moment=self.moment[part])

    def joined(self, other: Hung) -> Hung:
        """Return these and those of others."""
        xp = namespace(self.force, other.force)
        station = np.concatenate([self.station, other.station])
        force = xp.concatenate([self.force, other.force], axis=1)
        return Hung(station, force, xp.concatenate([self.moment, other.moment], axis=1))


class Reactions(NamedTuple):
    """Forces and moments (t, k, 3) of supports on the stations (k,) of a structure, in axes of its root.

    Moments are about the supports' places (t, k, 3). The supports have names where they are given some.
    """

    station: Array
    place: Array
    force: Array
    moment: Array
    names: tuple[str, ...] = ()

    @property
    def demanded(self) -> Hung:
        """Demand of the supports on the structure, as bodies that hang on it do; by names on its last station."""
        xp = namespace(self.force)
        station = np.full_like(self.station, -1) if self.names else self.station
        return Hung(station, -self.force, -self.moment - xp.cross(self.place, self.force))

    def with_hung(self, hung: Hung | None) -> Hung:
        """Demand of the supports and of bodies that are `hung` on the structure."""
        return self.demanded if hung is None else hung.joined(self.demanded)


def reactions_of(
    structure: Structure, base: Base, q: Array, qd: Array, qdd: Array, loads: Array | None, hung: Hung | None
) -> Reactions | None:
    """Reactions of a structure's supports, or None without supports.

    They follow from motions of the base (t, 3) and the structure's coordinates (t, n), under components of its `loads`
    (t, loads, 6) and of bodies that are `hung` on it.

    The free structure, which nothing but its root holds, demands forces along the coordinates that rigid supports make
    dependent. The reactions do the same work: they solve A_dᵀ R = r_d. Springs and dampers pull by how they are drawn.
    """
    grip = structure.grip
    if grip is None:
        return None
    free = grip.free
    if grip.curved:
        coordinates, rate, change = grip.conditions.motion(q, qd, qdd)
        demanded = grip.equations.whole(coordinates, rate, change, base.a_WO_B, base.w_WB_B, base.alpha_WB_B, loads)[0]
    else:
        coordinates, rate, change = (values @ grip.basis.T for values in (q, qd, qdd))
        root = Frame(None, None, None, base.w_WB_B, base.a_WO_B, base.alpha_WB_B)
        demanded = terms_of(free).demanded(coordinates, rate, change, root, loads)[0]
    xp = namespace(demanded)
    stations = free.poses
    if hung is not None and len(hung.station):
        at_stations = stations[hung.station]
        place = at_stations.positions(coordinates)
        slopes, angles = at_stations.jacobians(coordinates)
        moment = hung.moment - xp.cross(place, hung.force)
        demanded = demanded + xp.einsum("tpai,tpa->ti", slopes, hung.force) + xp.einsum("tpai,tpa->ti", angles, moment)
    rigid = demanded[:, :0]
    if grip.dependents:
        dependents = np.array(grip.dependents)
        rows = grip.conditions.measures.rows(coordinates) if grip.curved else grip.rows
        rigid = xp.linalg.solve(xp.swapaxes(rows[..., dependents], -1, -2), demanded[:, dependents, None])[..., 0]
        if grip.second is not None:
            rigid = rigid + quadratic(grip.second, coordinates)
    if grip.curved and grip.sprung:
        drawn, sprung_rows = grip.measures(grip.sprung).values_and_rows(coordinates)
        drawn_rate = (sprung_rows @ rate[..., None])[..., 0]
    else:
        drawn, drawn_rate = coordinates @ grip.yielding.T, rate @ grip.yielding.T
    yielding = -grip.stiffness * drawn - grip.damping * drawn_rate
    return _by_station(grip, stations, coordinates, xp.concatenate([rigid, yielding], axis=1))


def demanded_with_supports(
    structure: Structure, base: Base, q: Array, qd: Array, qdd: Array, loads: Array | None, hung: Hung | None
) -> Hung | None:
    """Forces and moments that bodies `hung` on a structure demand of its stations, and its supports."""
    reactions = reactions_of(structure, base, q, qd, qdd, loads, hung)
    return hung if reactions is None else reactions.with_hung(hung)


def _by_station(grip: Grip, stations: Any, q: Array, sizes: Array) -> Reactions:
    """Reactions of supports by their components (t, m), those of conditions and then those of springs."""
    xp, conditions = namespace(sizes), (*grip.held, *grip.sprung)
    places = np.array(sorted({station for station, _ in conditions}))
    unit = np.zeros((len(conditions), len(places), 6))
    for k, (station, direction) in enumerate(conditions):
        unit[k, np.searchsorted(places, station), direction] = 1.0
    wrench = xp.einsum("tm,mkd->tkd", sizes, unit)
    station_indices = stations[places] if grip.places is None else grip.places[places]
    names = tuple(label.name for label in grip.labels)
    return Reactions(places, station_indices.positions(q), wrench[..., :3], wrench[..., 3:], names)
