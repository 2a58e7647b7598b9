"""A rigid specimen: a box on a centrifuge, of which the load at its corners and on its bolts is asked."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike

from gbeam.arrays.tree import Value
from gbeam.arrays.types import Floats, Numbers
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import array, choice, positive, vector
from gbeam.guards.limits import SAMPLES, refuse_more
from gbeam.guards.quantities import Coordinates, Factor, Mass, OfKind, PositionVector, Quantity, Rows, Seconds, Shape
from gbeam.mechanics.equations.linear import PAIRS, Coefficients
from gbeam.mechanics.fields.taylor import Places
from gbeam.mechanics.holding import held_at_points
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.rigid_body import RigidBody
from gbeam.motion.protocol import Motion, kind_of, notes_on
from gbeam.results.solids import SpecimenLoads
from gbeam.solids.held import about, levers, refuse_free
from gbeam.solids.links import six_particles
from gbeam.solids.stress import hull
from gbeam.structure.attachments import TIP
from gbeam.structure.supports import Support

ALIKE = 1e-9  # of the largest second moment: bolts on a line
SAME = 1e-6  # of the time between samples: corners nearer to one are that one


@typed
@dataclass(frozen=True, eq=False)
class RigidSpecimen(Value):
    """A rigid body on a base that moves; see :meth:`box`.

    Raises
    ------
    InputError
        If the mass is not positive, no body has such an inertia, or the bolts cannot carry a moment.

    Examples
    --------
    >>> inertia = ((0.01, 0, 0), (0, 0.02, 0), (0, 0, 0.02))
    >>> rod = gb.RigidSpecimen(2.0, (0.1, 0, 0), inertia, corners=[(0, 0, 0), (0.2, 0, 0)])
    >>> loads = rod.loads(gb.Hub(radius=1.0, rate=10.0), duration=1.0, sample=0.5)
    >>> loads.acceleration[0, :, 0]
    array([-100., -120.])
    """

    mass: Annotated[Annotated[float, Quantity("mass", "positive")], "mass"]
    centre: Annotated[PositionVector, "centre of mass from the root, base axes: [x, y, z]"]
    inertia: Annotated[
        Annotated[ArrayLike, Quantity("moment of inertia"), Shape((3, 3))],
        "moments of inertia about the centre of mass, base axes: the diagonal, and beside it minus the products",
    ]
    corners: Annotated[
        Annotated[ArrayLike, Quantity("length"), Rows(3)],
        "corners of its envelope, or other points whose load is told, from the root: [ [x, y, z], ... ]",
    ]
    bolts: Annotated[
        Annotated[ArrayLike, Quantity("length"), Rows(3)] | None,
        "places of the bolts that hold it by its root, or of other points that hold it: [ [x, y, z], ... ]",
    ] = None
    bolt_axis: Annotated[
        Annotated[Numbers, Quantity("ratio"), Shape((3,))] | None,
        "direction of the bolts, away from the fixture: [x, y, z]",
    ] = None
    spread_limit: Annotated[
        Factor | None,
        "largest difference of the load at a corner to the centre's that the test order accepts, over the largest of "
        'the centre, such as "10 %"; beyond it the run is not accepted',
    ] = None
    points: Annotated[
        Mapping[str, Numbers],
        Quantity("length"),
        "places of output by name, from the root, at which accelerations and spectra are given; ``tip`` is the corner "
        "farthest from the root where it is not given",
    ] = field(default_factory=dict)

    supports: Annotated[
        Sequence[Support],
        "places that hold it in place of its root, at its points: [ { at, holds, stiffness, damping } ]. On springs it "
        "moves, as on isolators",
    ] = ()

    def __post_init__(self) -> None:
        """Check the places, the inertia and the bolts, and store them as arrays."""
        shapes = {"centre": (3,), "inertia": (3, 3), "corners": (-1, 3), "bolts": (-1, 3), "bolt_axis": (3,)}
        for name, shape in shapes.items():
            value = getattr(self, name)
            if value is None and name.startswith("bolt"):
                continue
            value = np.asarray(array(name, value), dtype=float)
            if value.ndim != len(shape) or value.shape[-1] != 3 or not value.size or not np.isfinite(value).all():
                words = "three numbers" if shape == (3,) else "3 × 3 numbers" if name == "inertia" else "rows of three"
                raise InputError(name, f"has the shape {value.shape}, or is not finite", f"give {words}")
            object.__setattr__(self, name, value)
        named = {name: tuple(vector(f"points.{name}", place)) for name, place in self.points.items()}
        object.__setattr__(self, "points", named)
        inertia = np.asarray(self.inertia)
        value = np.linalg.eigvalsh((inertia + inertia.T) / 2)
        if inertia.shape != (3, 3) or not np.allclose(inertia, inertia.T, atol=1e-9 * np.abs(inertia).max()):
            raise InputError("inertia", "is not symmetric", "give moments on the diagonal, and minus the products")
        if value[0] < -1e-12 * value[2] or value[2] > (1 + 1e-9) * (value[0] + value[1]):
            problem = f"has the principal moments {value[0]:.4g}, {value[1]:.4g} and {value[2]:.4g} kg m²"
            raise InputError("inertia", problem, "none is larger than the sum of the others; is it about the centre?")
        object.__setattr__(self, "supports", tuple(self.supports))
        if self.supports and self.bolts is not None:
            raise InputError("supports", "and bolts are both given, and hold it", "keep one of them")
        if self.supports and self.spread_limit is not None:
            raise InputError("spread_limit", "is of a body that its root holds", "leave it out beside supports")
        if self.bolts is None:
            if self.bolt_axis is not None:
                raise InputError("bolt_axis", "is given without bolts", "give their places, or leave it out")
            return
        if self.bolt_axis is None or not np.any(self.bolt_axis):
            problem = "is missing beside bolts" if self.bolt_axis is None else "is zero"
            raise InputError("bolt_axis", problem, "give their direction, such as (0, 0, 1)")
        bolts = np.asarray(self.bolts)
        moments = np.linalg.eigvalsh(_second_moments(bolts))
        if not moments[0] > ALIKE * moments[2]:
            raise InputError("bolts", f"are {len(bolts)} on a line, which carry no moment about it", "add one off it")

    @classmethod
    @typed
    def box(
        cls,
        mass: Mass,
        size: Annotated[Numbers, OfKind("length")],
        centre: PositionVector,
        *,
        bolts: Annotated[ArrayLike | None, OfKind("length")] = None,
        bolt_axis: Numbers | None = None,
    ) -> RigidSpecimen:
        """A box of uniform density along the base axes.

        Parameters
        ----------
        mass : float
            kg.
        size : (3,)
            Edges along x, y and z, m.
        centre : (3,)
            From the root, m.
        bolts, bolt_axis : optional
            As of the class.

        Raises
        ------
        InputError
            If an edge is not positive.

        Examples
        --------
        >>> gb.RigidSpecimen.box(3.0, (0.3, 0.2, 0.1), (0, 0, 0.05)).corners.shape
        (8, 3)
        """
        edges = np.array([positive(f"size[{i}]", edge, "m") for i, edge in enumerate(size)])
        if edges.shape != (3,):
            raise InputError("size", f"has {len(edges)} edges", "give three")
        inertia = np.diag(mass / 12 * (edges @ edges - edges**2))
        corners = np.asarray(centre, dtype=float) + edges / 2 * np.array(list(product((-1, 1), repeat=3)))
        return cls(mass, centre, inertia, corners, bolts, bolt_axis)

    @typed
    def loads(
        self, motion: Motion, duration: Seconds, *, sample: Seconds, start: Seconds = 0.0, name: str = ""
    ) -> SpecimenLoads:
        """Loads in a motion.

        Parameters
        ----------
        motion : Flight, Centrifuge or Hub
        duration : float
            s.
        sample : float
            Longest time between the results' times, to which the motion's corners are added, s.
        start : float
            s.
        name : str
            For the result.

        Returns
        -------
        SpecimenLoads

        Raises
        ------
        InputError
            If the motion is a result itself, as that of a free hub.

        Examples
        --------
        >>> turn = gb.Flight(z=gb.trapezoid(78.5, jerk=39.2, start=0.5, hold=1.0))
        >>> box = gb.RigidSpecimen.box(3.0, (0.3, 0.2, 0.1), (0, 0, 0.05))
        >>> print(f"{box.loads(turn, duration=6.0, sample=0.01).force_max:.1f} N")
        235.5 N
        """
        if motion.free:
            raise InputError("motion", "is a free hub, whose motion is a result", "give a hub with a rate")
        corners = np.asarray(self.corners)
        count = math.ceil(positive("duration", duration, "s") / positive("sample", sample, "s")) + 1
        refuse_more("sample", "times", count, SAMPLES, 8.0 * 9 * len(corners), "take a longer one")
        end = start + duration
        moving = motion.over(start, end)
        breaks = np.asarray(moving.corners(sample))
        inside = breaks[(breaks > start) & (breaks < end)]
        time = np.union1d(np.linspace(start, end, count), inside)
        time = time[np.append(True, np.diff(time) > SAME * sample)]
        return replace(self._loads(time, moving.base(time), name, kind_of(motion)), notes=notes_on({name: motion}))

    def _loads(self, time: Floats, base: Any, name: str, environment: str) -> SpecimenLoads:
        """Loads at times (t,), s, from the motion `base` of the root at these times."""
        corners = np.asarray(self.corners)
        vectors = base.a_WO_B, base.w_WB_B, base.alpha_WB_B
        a, w, alpha = (np.broadcast_to(vector, (len(time), 3)) for vector in vectors)

        def accelerations(places: Floats) -> Floats:
            """Accelerations (t, k, 3) of places (k, 3): a + α × r + ω × (ω × r)."""
            spin, turn = w[:, None], alpha[:, None]
            return a[:, None] + np.cross(turn, places) + np.cross(spin, np.cross(spin, places))

        centre, inertia = np.asarray(self.centre), np.asarray(self.inertia)
        of_centre = accelerations(centre[None])[:, 0]
        force = self.mass * of_centre
        about_centre = alpha @ inertia + np.cross(w, w @ inertia)  # I α + ω × I ω; the inertia is symmetric
        moment = about_centre + np.cross(centre, force)
        of_bolts: dict[str, Any] = {} if self.bolts is None else self._shared(np.asarray(self.bolts), force, moment)
        return SpecimenLoads(
            motion=name,
            environment=environment,
            mass=float(self.mass),
            time=time,
            corners=corners,
            acceleration=accelerations(corners),
            centre=of_centre,
            force=force,
            moment=moment,
            spread_limit=self.spread_limit,
            **of_bolts,
        )

    @property
    def structure(self) -> Structure:
        """The specimen as a structure without coordinates, or with those that its supports leave it. Its tip is the
        farthest corner unless it is named.
        """
        return self._on_supports() if self.supports else self._fixed()

    def _on_supports(self) -> Structure:
        """Structure that supports hold, in displacements and rotations of the centre of mass, six or fewer."""
        named, tip = self._stations()
        inertia = (np.asarray(self.inertia) + np.asarray(self.inertia).T) / 2
        particles, masses = six_particles(RigidBody(self.mass, inertia, self.centre))
        stations = np.stack([*named.values(), tip])
        places = np.concatenate([particles, stations])
        first, second = _rigid_motions(places - np.asarray(self.centre))
        body = Structure.of_particles(
            np.concatenate([masses, np.zeros(len(stations))]),
            places,
            first,
            np.zeros((6, 6)),
            second=second,
            stations=len(masses) + np.arange(len(stations)),
            turns=np.broadcast_to(np.eye(3, 6, 3), (len(stations), 3, 6)).copy(),
            points=(*named, TIP),
            kind="rigid",
        )
        elastic = [(held.name, way) for held in self.supports for way in (*held.rigid, *held.stiffness)]
        known = dict(zip(body.points, stations, strict=True))
        for i, support in enumerate(self.supports):
            choice(f"supports[{i}].at", support.name, body.points)
        rows = [levers(np.zeros((1, 3)), way) @ about(known[name]) for name, way in elastic]
        refuse_free("supports", np.concatenate([np.zeros((0, 6)), *rows]), np.asarray(self.corners))
        ends = np.array([*product(*zip(self.envelope.min(axis=0), self.envelope.max(axis=0), strict=True))])
        corners = Places(ends, *_rigid_motions(ends - np.asarray(self.centre)))
        return held_at_points(replace(body, corners=corners), self.supports, rooted=False)

    def _stations(self) -> tuple[dict[str, Floats], Floats]:
        """Places of the named points, and of the tip, m."""
        named, corners = {name: np.asarray(at) for name, at in self.points.items()}, np.asarray(self.corners)
        return named, named.pop(TIP, corners[np.linalg.norm(corners, axis=1).argmax()])

    def _fixed(self) -> Structure:
        """Structure without coordinates, fixed at its root."""
        centre, inertia = map(np.asarray, (self.centre, self.inertia))
        second = (np.trace(inertia) / 2 * np.eye(3) - inertia) + self.mass * np.outer(centre, centre)
        products = (second[i, j] for i, j in PAIRS)
        named, tip = self._stations()
        points = np.stack([centre, *named.values(), tip])
        count = len(points)
        square, rate = np.zeros((0, 0)), np.zeros((3, 0, 0))
        rigid = np.array([self.mass, *(self.mass * centre), *products])
        coefficients = Coefficients(
            mass=square, damping=square, stiffness=square, gyroscopic=rate,
            k_ww=np.zeros((3, 3, 0, 0)), k_al=rate, k_a=rate,
            f_ww=np.zeros((3, 3, 0)), f_al=np.zeros((3, 0)), f_a=np.zeros((3, 0)), rigid=rigid,
        )  # fmt: skip
        places = Places(points, np.zeros((count, 3, 0)), np.zeros((count, 3, 0, 0)))
        return Structure(
            kind="rigid",
            linear=True,
            hub_force=True,
            counts=(0,) * 6,
            length=float(np.linalg.norm(tip)),
            mass=np.append(self.mass, np.zeros(count - 1)),
            places=places,
            stations=points[1:, 0],
            station_places=places[list(range(1, count))],
            coefficients=coefficients,
            damping_ratio=0.0,
            points=(*named, TIP),
            recovery=self,
        )

    @property
    def envelope(self) -> Floats:
        """Corners of the convex hull of its corners and its bolts, (c, 3) m."""
        corners = np.asarray(self.corners)
        return hull(corners if self.bolts is None else np.concatenate([corners, np.asarray(self.bolts)]))

    @property
    def clamps(self) -> dict[str, str]:
        """Nothing: it is held by its root, not by nodes."""
        return {}

    def parts(
        self,
        time: Annotated[Floats, OfKind("time")],
        base: Any,
        causes: Coordinates,
        *,
        motion: str,
        model: str,
        environment: str,
    ) -> dict[str, Any]:
        """Return the loads of a response of the :attr:`structure`, by the name of its field.

        Parameters
        ----------
        time : (t,)
            s.
        base : Base
            Of the root, (t, 3).
        causes : (t, 0)
            Coordinates, of which it has none.
        motion, model, environment : str
            Names of the response's.
        """
        return {"specimen": self._loads(time, base, motion, environment)}

    def in_modes(self, modes: Any) -> None:
        """Return nothing: a rigid body has no modes.

        Parameters
        ----------
        modes : (k, 0)
            Coordinates.
        """

    def felt(self, causes: Coordinates) -> Floats:
        """Return no number: the stress of a rigid body is not known.

        Parameters
        ----------
        causes : (t, 0)
            Coordinates.
        """
        return np.full((len(causes), 1), np.nan)

    def strain(self, point: str, along: Any) -> Floats:
        """Refuse a strain, which a rigid body has none of.

        Parameters
        ----------
        point : str
            Name of a point.
        along : (3,)
            Direction.

        Raises
        ------
        InputError
            Always.
        """
        raise InputError("at", f"is {point!r}, on a rigid body, which has no strain", "give a mesh, or leave it out")

    def _shared(self, bolts: Floats, force: Floats, moment: Floats) -> dict[str, Any]:
        """Fields of the bolts: the forces (t, b, 3) by which they share a force and a moment (t, 3), their places and
        their direction.

        Bolts are alike between rigid bodies: each has an equal part of the force, and takes up the moment in proportion
        to its arm.
        """
        centroid, axis = bolts.mean(axis=0), np.asarray(self.bolt_axis)
        turn = np.linalg.solve(_second_moments(bolts), (moment - np.cross(centroid, force)).T).T
        forces = force[:, None] / len(bolts) + np.cross(turn[:, None], bolts - centroid)
        return {"bolts": bolts, "bolt_force": forces, "bolt_axis": axis / np.linalg.norm(axis)}


def _rigid_motions(arms: Floats) -> tuple[Floats, Floats]:
    """First (p, 3, 6) and second (p, 3, 6, 6) derivatives of places at arms (p, 3) from a point, by its displacement
    and the rotation vector of the body.
    """
    unit = np.eye(3)
    turned = np.cross(unit, arms[:, None])  # e × r, (p, 3 axes, 3)
    first = np.concatenate([np.broadcast_to(unit, (len(arms), 3, 3)), turned.swapaxes(1, 2)], axis=2)
    twice = np.cross(unit[:, None], turned[:, None])  # e × (f × r), (p, e, f, 3)
    second = np.zeros((len(arms), 3, 6, 6))
    second[:, :, 3:, 3:] = np.moveaxis(twice + twice.swapaxes(1, 2), -1, 1) / 2
    return first, second


def _second_moments(bolts: Floats) -> Floats:
    """Second moments Σ (r² − r r) (3, 3) of points (b, 3) about their centroid, m²: moment per turn of equal bolts."""
    arms = bolts - bolts.mean(axis=0)
    return np.asarray((arms**2).sum() * np.eye(3) - arms.T @ arms)
