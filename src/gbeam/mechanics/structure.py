"""The structure that every analysis reads: in its coordinates, with its equations, its places and its sections."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any

import numpy as np

from gbeam.arrays.namespace import Array, holds_jax, is_jax, namespace
from gbeam.arrays.tree import record, static
from gbeam.errors import InputError
from gbeam.guards.arguments import typed, typed_methods
from gbeam.guards.checks import implausible, positive
from gbeam.guards.quantities import Coordinates, OfKind, Seconds
from gbeam.mechanics.equations.dalembert import Complete
from gbeam.mechanics.equations.held import HeldComplete, HeldInertia, Springs
from gbeam.mechanics.equations.inertia import Inertia
from gbeam.mechanics.equations.linear import Bending, Coefficients, Geometric, coefficients, damping_matrix, rest_modes
from gbeam.mechanics.equations.moments import Moments
from gbeam.mechanics.equations.virtual_work import LoadHistory, LoadWork
from gbeam.mechanics.fields.basis import FAMILIES, Counts
from gbeam.mechanics.fields.held import Conditions, HeldField
from gbeam.mechanics.fields.measures import Measures, measures_of
from gbeam.mechanics.fields.projected import Field
from gbeam.mechanics.fields.series import SeriesField
from gbeam.mechanics.fields.strains import StrainField
from gbeam.mechanics.fields.taylor import Expanded, Places, Polynomials, exponential
from gbeam.mechanics.recovery import Recovery, Sections, Source
from gbeam.numerics.eigen import positive_definite
from gbeam.numerics.series import STEP
from gbeam.results.parts import judged_point
from gbeam.structure.supports import Label


@record
class Grip:
    """Grip of supports on a structure, and the structure that they hold.

    Its coordinates q (m,) are `basis` (m, n) times those of the structure. Conditions are zero, `rows` (k, m) times q,
    by which the `dependents` of q follow. They are `curved` where the rows change with q. Springs and dampers act along
    `yielding` (j, m) rows. All act on stations in the directions, 0 to 5, of `held` and `sprung`. Where supports have
    `labels`, on these at their `places`. What is not `rooted` has no other hold. What bends beside what is held pulls
    on conditions by ½ q · `second` (k, m, m) q.
    """

    free: Structure
    basis: Array
    rows: Array
    yielding: Array
    stiffness: Array
    damping: Array
    dependents: tuple[int, ...] = static()
    held: tuple[tuple[int, int], ...] = static()
    sprung: tuple[tuple[int, int], ...] = static()
    curved: bool = static(default=False)
    labels: tuple[Label, ...] = static(default=())
    places: Places | None = None
    second: Array | None = None
    rooted: bool = static(default=True)

    def measures(self, which: tuple[tuple[int, int], ...]) -> Measures:
        """Displacements and rotations of the free structure's stations, each in a direction."""
        field: Any = self.free.field
        return measures_of(field, self.free.first_station, which)

    @property
    def conditions(self) -> Conditions:
        """Conditions of the rigid supports."""
        return Conditions(self.measures(self.held), self.dependents, self.free.size)

    @property
    def equations(self) -> HeldComplete:
        """Equations under the supports."""
        c, springs = self.free.coefficients, None
        stiffness, damping = c.stiffness, c.damping
        if self.sprung:
            springs = Springs(self.measures(self.sprung), self.stiffness, self.damping)
            stiffness = stiffness - self.yielding.T @ (self.stiffness[:, None] * self.yielding)
            damping = damping - self.yielding.T @ (self.damping[:, None] * self.yielding)
        if self.free.linear:
            free: Any = Moments(replace(c, damping=damping, stiffness=stiffness))
        else:
            assert isinstance(self.free.inertia, Inertia)
            free = Complete(self.free.inertia, damping, stiffness, self.free.work)
        return HeldComplete(free, self.conditions, springs)


@typed_methods
@record
class Structure:
    """A structure in a model's coordinates; made by :func:`gbeam.assemble`, or of particles by :meth:`of_particles`.

    Parameters
    ----------
    kind : str
        The model's.
    linear : bool
        Whether the polynomial of the places is the whole model: equations linear on a prescribed base.
    hub_force : bool
        Whether a free hub feels Q_θ.
    counts : (axial, along y, along z, of twist, of shear along y, along z)
        Numbers of shapes; the root's springs come after them.
    length : float
        m; of particles, the largest distance of one from the root.
    mass : (particles,) kg
    places : Places
        Of the particles, to second order.
    stations : (s,) positions of output along the beam, m; the last is the tip
    station_places : Places
        Of the stations.
    coefficients : Coefficients
        Of the linear equations about the straight structure.
    inertia : Inertia or None
        Particles of a displacement field, without truncation; None for a structure of particles.
    field : Field or None
        Its points are the quadrature nodes, the bodies, the loaded points and the stations.
    first_station : int
        Index of the first station among the field's points.
    sections : Sections or None
        None where the structure has none: no loads along it are computed.
    history : LoadHistory or None
        The loads over time.
    work : LoadWork or None
        Where they act on the field.
    load_values : (loads, 6) or None
        Components of the loads that static, modes and stability see: those of time zero, see :meth:`at_time`.
    heated : bool
        True if the last of the loads is the rise of its temperature, K, in the first component.
    damping_ratio : float, sequence of float or None
        Modal, of the modes at rest; None where none is given: then there is no damping, and no response either.
    warnings : tuple of str
        What is implausible in the beam; every result has them.
    source : Source or None
        What it was made of; None for a structure of particles, whose errors of shapes and model are unknown.
    points : tuple of str
        Names of the stations of a structure of particles, where they have some.
    turns : (s, 3, n) or None
        Rotations of the stations of a structure of particles per coordinate, rad; not a number where unknown.
    unstiffened : bool
        Whether the stress of loads is left out of the stiffness of a structure of particles.
    recovery : Recovery or None
        What responses of a solid or a rigid specimen have besides.
    corners : Places or None
        Of the box around a rigid body that supports hold, for pictures.
    bending : Bending or None
        Of a solid, forces of higher order where it bends far; only the equations of `bent` have them.
    richer : Structure or None
        The same with more coordinates, of which its own come first, where some more modes were kept than it has: by
        these the error of those left out is judged.
    coarser : Structure or None
        Made of a coarser mesh, in coordinates as like its own as can be: by it the error of the mesh is judged.
    modes : int or None
        Number of modes where static shapes are among the coordinates: their frequencies are the lowest, and those
        above are none of the specimen's.
    grip : Grip or None
        What supports beyond the root hold, if there are any.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    >>> structure = gb.assemble(beam, "FOAM", axial=1, y=2, z=2)
    >>> structure.size, structure.kind
    (5, 'FOAM')
    """

    kind: str = static()
    linear: bool = static()
    hub_force: bool = static()
    counts: Counts = static()
    length: float
    mass: Array
    places: Places
    stations: Array
    station_places: Places
    coefficients: Coefficients
    inertia: Inertia | HeldInertia | None = None
    field: Field | None = None
    first_station: int = static(default=0)
    sections: Sections | None = None
    history: LoadHistory | None = None
    work: LoadWork | None = None
    load_values: Array | None = None
    heated: bool = static(default=False)
    damping_ratio: Any = None
    warnings: tuple[str, ...] = static(default=())
    source: Source | None = static(default=None)
    points: tuple[str, ...] = static(default=())
    turns: Array | None = None
    unstiffened: bool = static(default=False)
    recovery: Recovery | None = static(default=None)
    corners: Places | None = None
    modes: int | None = static(default=None)
    grip: Grip | None = None
    bending: Bending | None = static(default=None)
    richer: Structure | None = static(default=None)
    coarser: Structure | None = static(default=None)

    def __repr__(self) -> str:
        shapes = ", ".join(f"{n} {way}" for n, way in zip(self.counts, FAMILIES, strict=True) if n)
        size = "traced" if self.traced else f"{float(self.coefficients.rigid[0]):.4g} kg"
        return f"Structure({self.kind}, {self.size} coordinates{f' ({shapes})' if shapes else ''}, {size})"

    @classmethod
    @typed
    def of_particles(
        cls,
        mass: Annotated[Array, OfKind("mass")],
        r0: Annotated[Array, OfKind("length")],
        first: Array,
        stiffness: Array,
        *,
        second: Array | None = None,
        geometric: Geometric | None = None,
        damping_ratio: Annotated[Any, OfKind("ratio")] = 0.0,
        stations: Array | None = None,
        turns: Array | None = None,
        points: tuple[str, ...] = (),
        kind: str = "particles",
        warnings: tuple[str, ...] = (),
    ) -> Structure:
        """A linear structure of any shape: particles with places, and an elastic stiffness.

        Parameters
        ----------
        mass : (k,) kg
        r0 : (k, 3) places at rest, base axes, m
        first : (k, 3, n) first derivatives of the places, per coordinate
        stiffness : (n, n)
        second : (k, 3, n, n), optional
            Second derivatives of the places; this or `geometric`.
        geometric : Geometric, optional
            Geometric stiffness at the static stress of unit inertial loads.
        damping_ratio : float or sequence
            Modal.
        stations : (s,) int, optional
            Indices of the particles whose displacement is put out, the "tip" last; by default the last particle.
        turns : (s, 3, n), optional
            Rotations of the stations per coordinate, rad: other bodies can hang on them. Not a number where unknown.
        points : tuple of str
            Names of the stations in results.
        kind : str
            For results.
        warnings : tuple of str
            What is implausible in it, for results.

        Raises
        ------
        InputError
            If neither or both of `second` and `geometric` are given, an array has another shape, a mass is negative, or
            a motion of the coordinates moves no mass.
        """
        if (second is None) == (geometric is None):
            raise InputError("second", "and geometric are one in place of the other", "give exactly one of them")
        length = float(np.linalg.norm(np.asarray(r0), axis=-1).max())
        chosen = np.array([-1]) if stations is None else np.asarray(stations)
        k, n = len(mass), np.shape(first)[-1]
        arrays = (mass, r0, first, stiffness, second)
        names, shapes = ("mass", "r0", "first", "stiffness", "second"), ((k,), (k, 3), (k, 3, n), (n, n), (k, 3, n, n))
        for name, value, shape in zip(names, arrays, shapes, strict=True):
            if value is None:
                continue
            if np.shape(value) != shape:
                raise InputError(name, f"has the shape {np.shape(value)}", f"give {shape}, as mass and first have")
            if not (is_jax(value) or np.isfinite(value).all()):
                raise InputError(name, "has values that are not finite", "give finite ones")
        for i, particle_mass in enumerate(() if is_jax(mass) else mass):
            positive(f"mass[{i}]", particle_mass, "kg", zero=True)
        places = Places(r0, first, np.zeros((*first.shape, n)) if second is None else second)
        c = coefficients(mass, places, stiffness, geometric=geometric)
        if not (is_jax(c.mass) or positive_definite(c.mass)):
            fix = "give the particles mass, or leave out the coordinates that move none"
            raise InputError("mass", "leaves a motion of the coordinates without mass", fix)
        words = {"damping_ratio": damping_ratio, "points": points, "kind": kind, "warnings": warnings, "turns": turns}
        return linear_structure(c, mass, places, places[chosen], length=length, **words)

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return self.coefficients.size

    def require_damping(self, answer: str) -> None:
        """Raise InputError where no damping ratio is given and an `answer` depends on it."""
        if self.damping_ratio is None:
            raise InputError(
                "beam.damping_ratio",
                f"is missing, and {answer} depends on it",
                "give a ratio of critical damping, such as 0.01, or 0 for none",
            )

    def require_coordinates(self) -> None:
        """Raise InputError where nothing deforms, and an answer is about what does."""
        if not self.size:
            fix = "ask simulate, which has the load at its corners, or give it as a solid"
            raise InputError("structure", "is rigid, and this is of what deforms", fix)

    @property
    def farthest_station(self) -> int:
        """Index of the station that moves farthest under even loads where supports hold the tip; else the last."""
        places, c = self.station_places.first, self.coefficients
        if self.grip is None:
            return len(places) - 1
        return judged_point(np.linalg.norm(places @ np.linalg.solve(c.stiffness, c.f_a.T), axis=(1, 2)))

    def require_free_tip(self, answer: str) -> None:
        """Raise InputError where supports hold the tip, and an `answer` is judged by what the tip does."""
        if self.farthest_station != len(self.station_places.first) - 1:
            fix = "ask run, which compares the point that moves farthest, or sweep it"
            raise InputError("supports", f"hold the tip, by which {answer} is judged", fix)

    @property
    def traced(self) -> bool:
        """True if JAX traces its values, which then have no numbers to decide anything by."""
        c = self.coefficients
        return is_jax(c.mass) or is_jax(c.damping) or is_jax(c.stiffness)

    @property
    def holds_jax(self) -> bool:
        """True if any array of it is JAX's, or traced by it."""
        return holds_jax(self)

    @property
    def equations(self) -> Coefficients | Complete | HeldComplete:
        """The equations of motion on a prescribed base."""
        if self.linear:
            return self.coefficients
        if self.grip is not None and self.grip.curved:
            return self.grip.equations
        assert isinstance(self.inertia, Inertia)
        return Complete(self.inertia, self.coefficients.damping, self.coefficients.stiffness, self.work)

    def linearise(self, q: Coordinates) -> tuple[Coefficients, Array]:
        """Coefficients of the equations linearised at coordinates `q` (n,), and the elastic forces there, (n,)."""
        c = self.coefficients
        if self.linear:
            return c.linearise(q), c.elastic(q)
        assert self.inertia is not None
        places, geometric = self.inertia.expand(q)
        loads = None if self.work is None or self.load_values is None else self.work.linearise(len(self.load_values), q)
        elastic, tangent = c.stiffness @ q, c.stiffness
        if isinstance(self.equations, HeldComplete):
            steps = q + 1j * STEP * np.eye(self.size)
            elastic, tangent = self.equations.elastic(q), np.imag(self.equations.elastic(steps)).T / STEP
        linear = coefficients(self.mass, places, tangent, damping=c.damping, geometric=geometric, loads=loads)
        return linear, elastic

    @property
    def rest(self) -> tuple[Array, Array]:
        """Circular frequencies (n,) rad/s, ascending, and mass-normalised modes (n, n) on a base at rest."""
        return rest_modes(self.coefficients.mass, self.coefficients.stiffness)

    @property
    def judged(self) -> bool:
        """True if the errors of the shapes that it leaves out can be estimated."""
        return (self.source is not None or self.richer is not None) and not self.traced

    @property
    def exact(self) -> bool:
        """True if no model is known that is more exact, with as many shapes."""
        return self.kind == "exact" or (self.richer is not None and self.richer.bending is None)

    @property
    def bent(self) -> Structure:
        """Structure of kind exact with elastic forces of higher order, for large bending; itself where
        none are known.
        """
        if self.bending is None:
            return self
        stations, soft = self.station_places, self.bending.soft
        second = soft @ self.bending.places @ soft.T + (0.0 if stations.second is None else stations.second)
        coefficients = replace(self.coefficients, bending=self.bending)
        return replace(self, kind="exact", coefficients=coefficients, station_places=replace(stations, second=second))

    @property
    def resolved(self) -> int:
        """Number of the lowest frequencies that are the specimen's, and not of static shapes."""
        return self.size if self.modes is None else self.modes

    def at_time(self, time: Seconds) -> Structure:
        """Return the structure with its loads frozen at a `time`, s: as static, modes and stability take it."""
        if self.history is None:
            return self
        history = self.history.freeze(float(time))
        return replace(self, history=history, load_values=history(np.zeros(())))

    @property
    def poses(self) -> Any:
        """Places and rotations of the stations."""
        if self.field is not None:
            return self.field.sections(slice(self.first_station, None))
        places, xp = self.station_places, namespace(self.station_places.first)
        turns = 0 * places.first if self.turns is None else xp.nan_to_num(self.turns)
        return Polynomials(places, exponential(turns, xp.zeros((*turns.shape, self.size))))

    def turned(self, basis: Array) -> Structure:
        """Return a linear structure of particles in coordinates p with q = basis p, without what is recovered.

        Parameters
        ----------
        basis : (n, k)
            Coordinates q of each of the new ones.

        Returns
        -------
        Structure
            With k coordinates, whose answers are those of the old ones that the basis reaches.
        """
        c = self.coefficients.turned(basis)
        turns = None if self.turns is None else self.turns @ basis
        grip = self.grip and replace(self.grip, basis=self.grip.basis @ basis)
        places, stations = self.places.turned(basis), self.station_places.turned(basis)
        corners = self.corners and self.corners.turned(basis)
        return replace(
            self, coefficients=c, places=places, station_places=stations, turns=turns, grip=grip, corners=corners,
            recovery=None,
        )  # fmt: skip

    @property
    def particles(self) -> StrainField | SeriesField | HeldField | Places:
        """Places of the particles: a field of strains, or polynomials."""
        return self.places if self.linear or self.inertia is None else self.inertia.field

    @property
    def output(self) -> StrainField | SeriesField | HeldField | Places:
        """Places of the stations: a field of strains, or polynomials."""
        if self.field is None or isinstance(self.field, Expanded):
            return self.station_places
        return self.field[self.first_station :]

    @property
    def axes_without_shapes(self) -> tuple[int, ...]:
        """Axes across the beam, 1 for y and 2 for z, along which no station moves."""
        return tuple(axis for axis in (1, 2) if not np.any(self.station_places.first[:, axis]))

    def strain_energy(self, q: Coordinates) -> Array:
        """Strain energy at coordinates `q` (n,), J."""
        return self.equations.strain_energy(q)

    def station_slopes(self, q: Coordinates) -> Array:
        """Derivatives of the stations' places with respect to coordinates `q` (n,), (s, 3, n)."""
        return self.output.slopes(q)

    def twist_slopes(self, q: Coordinates, chosen: Array | None = None) -> Array | None:
        """Derivatives (s, n), by the coordinates at `q` (n,), of the angles of sections about the beam's axis.

        The sections are the stations, or the `chosen` points of the field. None of a model without twist.
        """
        if self.field is None or not (self.counts[3] or (self.source and self.source.beam.line)):
            return None
        field = self.field.sections(slice(self.first_station, None) if chosen is None else chosen)
        axes, (_, angles) = field.rotation(q)[..., 0], field.jacobians(q)
        return namespace(angles).einsum("sa,san->sn", axes, angles)

    def displacement(self, q: Coordinates) -> Array:
        """Displacement of the stations relative to the base axes at coordinates `q` (..., n), (..., s, 3) m."""
        return self.output.positions(q) - self.station_places.r0

    def station_displacement(self, q: Coordinates, chosen: Any) -> Array:
        """Displacement of some stations relative to the base axes, (..., k, 3) m.

        Parameters
        ----------
        q : (..., n)
            Coordinates.
        chosen : slice or (k,) int
            Indices of the stations.
        """
        return self.output[chosen].positions(q) - self.station_places.r0[chosen]

    def tip(self, q: Coordinates) -> Array:
        """Displacement of the tip, the last station, likewise at coordinates `q` (..., n), (..., 3) m."""
        return self.station_displacement(q, slice(-1, None))[..., 0, :]


def linear_structure(
    terms: Coefficients,
    mass: Array,
    places: Places,
    stations: Places,
    *,
    length: float,
    damping_ratio: Any,
    points: tuple[str, ...],
    kind: str,
    turns: Array | None = None,
    warnings: tuple[str, ...] = (),
    unstiffened: bool = False,
    modes: int | None = None,
) -> Structure:
    """Linear structure from the coefficients `terms`, the places of its particles (k,) kg, and of its stations."""
    ratio = 0.0 if holds_jax(damping_ratio) else float(np.max(damping_ratio))
    return Structure(
        kind=kind,
        linear=True,
        hub_force=True,
        counts=(0,) * 6,
        length=length,
        mass=mass,
        places=places,
        stations=stations.r0[:, 0],
        station_places=stations,
        coefficients=terms.damped(damping_matrix(damping_ratio, terms.mass, terms.stiffness)),
        damping_ratio=damping_ratio,
        warnings=(*warnings, *implausible("damping_ratio", "damping", ratio)),
        points=points,
        turns=turns,
        unstiffened=unstiffened,
        modes=modes,
    )
