"""The models, as data: which field, which truncation, which coordinates."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import equinox as eqx
import jax.numpy as jnp
import numpy as np
import scipy.linalg
from jaxtyping import Array, Float
from numpy.typing import ArrayLike, NDArray

import gbeam.arrays.jax_setup  # noqa: F401
from gbeam.errors import InputError
from gbeam.mechanics.adapted import adapted_shapes
from gbeam.mechanics.basis import Quadrature, quadrature
from gbeam.mechanics.energy import FieldEnergy, rest_matrices, second_order
from gbeam.mechanics.equations import Damped
from gbeam.mechanics.field import Coordinates, Field, Points, RootedField, Strains, exact_field, projected_field
from gbeam.mechanics.virtual_work import FieldWork, LoadHistory, Work, first_order
from gbeam.motion import constant
from gbeam.structure.beam import Beam


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


SHAPES = ("clamped-free", "adapted")
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
    shapes : str
        clamped-free: those of the bare uniform beam (for exact, polynomials). adapted: the modes at rest of the beam
        with its tapers, bodies and root springs.

    Raises
    ------
    InputError
        If the kind or the shapes are unknown, a number is negative, or there is no coordinate.
    """

    kind: str
    axial: int
    y: int
    z: int
    shapes: str = "clamped-free"

    def __post_init__(self) -> None:
        for name, value, choices in (("kind", self.kind, tuple(KINDS)), ("shapes", self.shapes, SHAPES)):
            if value not in choices:
                raise InputError(name, f"is {value!r}", f"choose one of {', '.join(choices)}")
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
        """Numbers of shapes: axial, along y, along z."""
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
        Energy, damping matrix and the work of the loads, as they are at time zero.
    field : Field
        Displacement field at the quadrature nodes, the bodies, the loads and the stations.
    particles : FieldEnergy
        The field's complete energy: its particles carry the inertia, also where the system's energy is truncated.
    stations : (s,) positions of output along the beam, m; the last is the tip
    first_station : int
        Index of the first station among the field's points.
    linear, hub_force : bool
        From the model's row.
    counts : (axial, along y, along z)
        Numbers of shapes; the root's springs come after them.
    length : float
        m.
    history : LoadHistory or None
        The loads over time.
    applied : FieldWork or None
        Where they act on the field, not truncated.
    """

    system: Damped
    field: Field
    particles: FieldEnergy
    stations: Float[Array, " s"]
    first_station: int = eqx.field(static=True)
    linear: bool = eqx.field(static=True)
    hub_force: bool = eqx.field(static=True)
    counts: tuple[int, int, int] = eqx.field(static=True)
    kind: str = eqx.field(static=True)
    length: float
    history: LoadHistory | None = None
    applied: FieldWork | None = None

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return self.system.damping.shape[0]

    def at_time(self, time: float) -> Structure:
        """The same structure with its loads frozen as they are at a time, s; static, modes and stability see those."""
        if self.history is None:
            return self
        return eqx.tree_at(lambda s: s.system, self, self.system.under(self.history(jnp.asarray(time, dtype=float))))

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
    bodies = [m.at for m in beam.masses]
    adapted = model.shapes == "adapted"
    # Enough for the fourth powers of the highest shape (2009's tensors need 32 nodes for five modes).
    breaks = [*beam.section.stations, *(bodies if adapted else ())]
    rule = quadrature(beam.length, 12 + 4 * max(counts), breaks)
    loaded = [load.at for load in beam.loads if load.at is not None]
    x = np.concatenate([rule.node, bodies, loaded, wanted])
    families = adapted_shapes(beam, rule, counts) if adapted else None
    if row.exact:
        field: Field = exact_field(beam.length, rule, x, counts, families)
    else:
        foreshortening = row.foreshortening
        field = projected_field(beam.length, rule, x, counts, foreshortening=foreshortening, families=families)
    springs = beam.root.springs
    if springs:
        move, turn = map(jnp.array, beam.root.directions())
        field = RootedField(field, jnp.array(x), move, turn, linear=not row.foreshortening)
    size = sum(counts) + len(springs)

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
            jnp.array(e * section.area * rule.weight),
            jnp.array(e * section.inertia_y * rule.weight),
            jnp.array(e * section.inertia_z * rule.weight),
            jnp.array([*springs.values()]),
        ),
        size=size,
    )
    energy = second_order(complete) if row.truncated else complete
    history = _history(beam)
    work: Work | None = None
    applied, full = None, None
    if history is not None:
        applied = history(jnp.zeros(()))
        full = _work(beam, field, rule, nodes + len(bodies))
        work = first_order(full, applied, size) if row.truncated else full
    ratio = beam.damping_ratio if isinstance(beam.damping_ratio, (int, float)) else tuple(beam.damping_ratio)
    return Structure(
        system=Damped(energy, _damping(ratio, *rest_matrices(energy)), work, applied),
        field=field,
        particles=complete,
        stations=jnp.array(wanted),
        first_station=nodes + len(bodies) + len(loaded),
        linear=row.truncated,
        hub_force=row.hub_force,
        counts=counts,
        kind=model.kind,
        length=beam.length,
        history=history,
        applied=full,
    )


def _history(beam: Beam) -> LoadHistory | None:
    def profile(value: Any) -> Any:
        return value if callable(value) else constant(np.zeros(3) if value is None else value)

    return LoadHistory(tuple((profile(it.force), profile(it.moment)) for it in beam.loads)) if beam.loads else None


def _work(beam: Beam, field: Field, rule: Quadrature, first: int) -> FieldWork:
    """Where the loads act: at a point of their own, counted from `first`, or on all quadrature nodes."""
    station, load, weight = [], [], []
    for k, it in enumerate(beam.loads):
        if it.at is None:
            station.append(np.arange(len(rule.node)))
            weight.append(rule.weight)
        else:
            station.append(np.array([first]))
            weight.append(np.ones(1))
            first += 1
        load.append(np.full(len(station[-1]), k))
    which = np.concatenate(load)
    return FieldWork(
        field=field,
        station=jnp.array(np.concatenate(station)),
        load=jnp.array(which),
        weight=jnp.array(np.concatenate(weight)),
        follower=jnp.array([it.follower for it in beam.loads])[which],
    )
