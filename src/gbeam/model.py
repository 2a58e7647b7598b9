"""The models, as data: which field, which truncation, which coordinates."""

from __future__ import annotations

from dataclasses import dataclass

import equinox as eqx
import jax.numpy as jnp
import numpy as np
import scipy.linalg
from jaxtyping import Array, Float
from numpy.typing import ArrayLike, NDArray

import gbeam._jax  # noqa: F401
from gbeam.basis import quadrature
from gbeam.beam import Beam
from gbeam.energy import FieldEnergy, rest_matrices, second_order
from gbeam.equations import Damped
from gbeam.errors import InputError
from gbeam.field import Coordinates, Field, Points, Strains, exact_field, projected_field


@dataclass(frozen=True)
class Kind:
    """A row of the table of models.

    Parameters
    ----------
    exact : bool
        The exact field, or the one of the projected displacements.
    foreshortening : bool
        Whether transverse displacement shortens the projected field.
    truncated : bool
        Whether T is taken to second order in (q, q̇), which makes the equations linear on a prescribed base.
    hub_force : bool
        Whether a free hub feels Q_θ.
    axial : bool
        Whether there are axial coordinates.
    """

    exact: bool = False
    foreshortening: bool = True
    truncated: bool = True
    hub_force: bool = True
    axial: bool = True


KINDS = {
    "TLAM": Kind(foreshortening=False),
    "FOAM": Kind(),
    "SFOAM": Kind(hub_force=False, axial=False),
    "CFOAM": Kind(truncated=False),
    "exact": Kind(exact=True, truncated=False),
}


@dataclass(frozen=True)
class Model:
    """Which model to use and how many coordinates.

    Parameters
    ----------
    kind : str
        TLAM, FOAM, SFOAM (as printed: no axial coordinates, Q_θ dropped), CFOAM or exact. FOAM with ``axial=0`` is
        the Lagrangian form of SFOAM.
    axial, y, z : int
        Numbers of axial shapes and of bending shapes along y and along z; for exact: strain shapes, and rotation
        shapes for bending along y and along z.

    Raises
    ------
    InputError
        If the kind is unknown, a number is negative, or there is no coordinate.
    """

    kind: str
    axial: int
    y: int
    z: int

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise InputError("kind", f"is {self.kind!r}", f"choose one of {', '.join(KINDS)}")
        for name, count in zip(("axial", "y", "z"), self.counts, strict=True):
            if not isinstance(count, int) or count < 0:
                raise InputError(f"modes.{name}", f"is {count!r}", "give a whole number, 0 or more")
        if sum(self.counts) == 0:
            raise InputError("modes", "are all zero", "give at least one mode in one direction")
        if self.axial and not KINDS[self.kind].axial:
            raise InputError(
                "modes.axial",
                f"is {self.axial} for SFOAM, which has no axial coordinates",
                "give 0, or use FOAM",
            )

    @property
    def counts(self) -> tuple[int, int, int]:
        """Numbers of coordinates: axial, along y, along z."""
        return self.axial, self.y, self.z

    @property
    def row(self) -> Kind:
        """The model's row in the table."""
        return KINDS[self.kind]


class Structure(eqx.Module):
    """A beam put into a model: its energy, its damping, and where its stations are.

    Parameters
    ----------
    system : Damped
        Energy and damping matrix.
    field : Field
        Displacement field at the quadrature nodes, the bodies and the stations.
    stations : (s,) positions of output along the beam, m; the last is the tip
    first_station : int
        Index of the first station among the field's points.
    linear, hub_force : bool
        From the model's row.
    length : float
        m.
    """

    system: Damped
    field: Field
    stations: Float[Array, " s"]
    first_station: int = eqx.field(static=True)
    linear: bool = eqx.field(static=True)
    hub_force: bool = eqx.field(static=True)
    counts: tuple[int, int, int] = eqx.field(static=True)
    kind: str = eqx.field(static=True)
    length: float

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return sum(self.counts)

    def displacement(self, q: Coordinates) -> Points:
        """Displacement of the stations relative to the base axes, (s, 3) m."""
        undeformed = jnp.stack([self.stations, 0 * self.stations, 0 * self.stations], axis=-1)
        return self.field.position(q)[self.first_station :] - undeformed


def rest_modes(mass: ArrayLike, stiffness: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Circular frequencies (n,) rad/s, ascending, and mass-normalised modes (n, n) of the beam on a base at rest."""
    square, modes = scipy.linalg.eigh(np.asarray(stiffness), np.asarray(mass))
    return np.sqrt(np.maximum(square, 0)), modes


def _damping(ratio: float | tuple[float, ...], mass: Array, stiffness: Array) -> Float[Array, "n n"]:
    """Modal damping matrix M Φ diag(2ζω) Φᵀ M of the beam on a base at rest."""
    frequency, modes = rest_modes(mass, stiffness)
    if not isinstance(ratio, (int, float)) and len(ratio) != len(frequency):
        raise InputError(
            "damping_ratio",
            f"lists {len(ratio)} values for the {len(frequency)} modes of the model",
            f"give one value for all, or {len(frequency)}, ascending in frequency",
        )
    weighted = np.asarray(mass) @ modes
    return jnp.array(weighted * (2 * np.broadcast_to(ratio, frequency.shape) * frequency) @ weighted.T)


def assemble(beam: Beam, model: Model, stations: ArrayLike = ()) -> Structure:
    """Put a beam into a model.

    Parameters
    ----------
    beam : Beam
    model : Model
    stations : (s,) positions along the beam where displacements are wanted, m; the tip is always added last

    Returns
    -------
    Structure

    Raises
    ------
    InputError
        If a station lies off the beam, or the list of damping ratios does not fit the model.
    """
    row, counts = model.row, model.counts
    wanted = np.asarray(stations, dtype=float).ravel()
    for i, x in enumerate(wanted):
        if not 0 <= x <= beam.length:
            raise InputError(f"stations[{i}]", f"is {x:g} m, off the beam", f"give 0 to {beam.length:g} m")
    wanted = np.append(wanted[wanted < beam.length], beam.length)
    # Enough for the fourth powers of the highest shape (2009's tensors need 32 nodes for five modes).
    rule = quadrature(beam.length, 12 + 4 * max(counts), beam.section.stations)
    bodies = np.array([m.at for m in beam.masses])
    x = np.concatenate([rule.node, bodies, wanted])
    if row.exact:
        field: Field = exact_field(beam.length, rule, x, counts)
    else:
        field = projected_field(beam.length, rule, x, counts, foreshortening=row.foreshortening)

    nodes, section, e = len(rule.node), beam.section.at(rule.node), beam.material.youngs_modulus
    station, mass, offset = [np.arange(nodes)], [beam.material.density * section.area * rule.weight], []
    offset.append(np.zeros((nodes, 3)))
    for k, body in enumerate(beam.masses):
        masses, places = body.particles()
        station.append(np.full(len(masses), nodes + k))
        mass.append(masses)
        offset.append(places)
    places = np.concatenate(offset)
    complete = FieldEnergy(
        field=field,
        station=jnp.array(np.concatenate(station)),
        mass=jnp.array(np.concatenate(mass)),
        offset=jnp.array(places) if places.any() else None,
        rigidity=Strains(
            *(jnp.array(e * r * rule.weight) for r in (section.area, section.inertia_y, section.inertia_z))
        ),
        size=sum(counts),
    )
    energy = second_order(complete) if row.truncated else complete
    ratio = beam.damping_ratio if isinstance(beam.damping_ratio, (int, float)) else tuple(beam.damping_ratio)
    return Structure(
        system=Damped(energy, _damping(ratio, *rest_matrices(energy))),
        field=field,
        stations=jnp.array(wanted),
        first_station=nodes + len(bodies),
        linear=row.truncated,
        hub_force=row.hub_force,
        counts=counts,
        kind=model.kind,
        length=beam.length,
    )
