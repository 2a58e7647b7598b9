"""The state in which a response begins: as it is said, by points of bodies, and their shapes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, NamedTuple, get_args

import numpy as np

from gbeam.arrays.namespace import Array, namespace
from gbeam.arrays.tree import Value
from gbeam.constants import Across, Axis, State
from gbeam.errors import ComputationError, InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import choice, finite
from gbeam.guards.quantities import AccelerationVector, Components, Quantity
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.body_terms import stations_of

_ITERATIONS = 60
TIP = Components(
    "A displacement or velocity of the tip across the beam, by components; those left out are free.",
    y="component along the width",
    z="component through the thickness",
)
POINT = Components(
    "A displacement or velocity of a point relative to its body's root, by components; those left out are free.",
    x="component along the body, which needs axial shapes",
    y="component along the width",
    z="component through the thickness",
)
STATE_WORDS: dict[State, str] = {
    "equilibrium": "in relative equilibrium",
    "undeformed": "undeformed",
    "relief": "in inertia relief",
}


@typed
@dataclass(frozen=True, eq=False)
class Initial(Value):
    """The state of what deforms, relative to its root, in which a response begins; a machine's with its spin-up.

    Joints begin at their own initial values.
    What is given of the displacement takes the place of the equilibrium, of the bodies whose points are displaced. What
    is not given of the velocity is zero.

    Raises
    ------
    InputError
        If a value is impossible, or two displacements are given.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    >>> structure = gb.assemble(beam, "FOAM", axial=1, y=2, z=2)
    >>> drawn = gb.Initial(tip_displacement={"z": 2e-3})
    >>> response = gb.simulate(structure, gb.Flight(z=0.0), duration=0.5, initial=drawn)
    >>> print(f"{1e3 * response.displacement[0, -1, 2]:.3f} mm")
    2.000 mm
    """

    state: Annotated[
        State,
        "equilibrium: at rest in the relative equilibrium with the base's motion and the loads then, a free hub at "
        "rest; of a system as where joints hold what they move, and what floats, held by nothing but a free joint "
        "without springs and prescribed rates, undeformed. Springs of a clamp are bent, too, unless it says where they "
        "begin; those at the root of a body that deforms let it go at once. undeformed: straight and at rest. relief: "
        "inertia relief, bent as what the forces at the start accelerate is bent by its inertia",
    ] = "equilibrium"
    acceleration: Annotated[
        AccelerationVector | None,
        'released from the static deflection under this acceleration of the root, or specific force, [0, 0, "2 g"], '
        "and under the loads then; of a system under this of its ground, joints held where they begin",
    ] = None
    tip_displacement: Annotated[
        Annotated[Mapping[Across, float], Quantity("length"), TIP] | None,
        "displacement of the tip of the only body that deforms, in short: { y, z }",
    ] = None
    tip_velocity: Annotated[
        Annotated[Mapping[Across, float], Quantity("speed"), TIP] | None,
        "velocity of the tip of the only body that deforms, in short: { y, z }",
    ] = None
    displacement: Annotated[
        Mapping[str, Annotated[Mapping[Axis, float], Quantity("length"), POINT]] | None,
        "released from the static deflection by forces at points that displace these so, relative to their bodies' "
        'roots: { "arm.tip" = { z = "2 mm" } }; of one body by the names of its points alone',
    ] = None
    velocity: Annotated[
        Mapping[str, Annotated[Mapping[Axis, float], Quantity("speed"), POINT]] | None,
        "velocities of points relative to their bodies' roots, the bodies moving in the shapes of such deflections: "
        '{ "arm.tip" = { z = "0.1 m/s" } }',
    ] = None

    def __post_init__(self) -> None:
        choice("state", self.state, STATE_WORDS)
        names = "acceleration", "tip_displacement", "displacement"
        displaced = [name for name in names if getattr(self, name) is not None]
        if displaced and self.state != "equilibrium":
            raise InputError(displaced[0], f'is given beside state = "{self.state}"', "keep one of them")
        if "acceleration" in displaced and len(displaced) > 1:
            raise InputError(displaced[1], f"is given beside {displaced[0]}", "keep one of them")
        if self.acceleration is not None:
            if np.shape(self.acceleration) != (3,):
                fix = "give three finite components, x, y and z"
                raise InputError("acceleration", f"is {self.acceleration!r}", fix)
            object.__setattr__(self, "acceleration", tuple(float(component) for component in self.acceleration))
        for name in ("tip_displacement", "tip_velocity"):
            for axis in getattr(self, name) or {}:
                choice(name, axis, get_args(Across))
        for where, _, axis, value in (*self.displaced, *self.moving):
            choice(where.rpartition(".")[0], axis, get_args(Axis))
            finite(where, value)

    @property
    def displaces(self) -> bool:
        """True if it says more than a state by its name."""
        return self != Initial(self.state)

    @property
    def settled(self) -> bool:
        """True if it is the relative equilibrium at rest."""
        return self == Initial()

    @property
    def displaced(self) -> tuple[Moved, ...]:
        """Components of points' displacements."""
        return (
            *_displacements("tip_displacement", {"tip": self.tip_displacement}),
            *_displacements("displacement", self.displacement),
        )

    @property
    def moving(self) -> tuple[Moved, ...]:
        """Components of points' velocities."""
        return (*_displacements("tip_velocity", {"tip": self.tip_velocity}), *_displacements("velocity", self.velocity))

    def __str__(self) -> str:
        if self.acceleration is not None:
            words = f"in the static deflection under ({', '.join(f'{a:.4g}' for a in self.acceleration)}) m/s²"
        elif self.displaced:
            words = f"with {_in_words(self.displaced, 'displaced by', 1e3, 'mm')}, as by a force there"
        else:
            words = STATE_WORDS[self.state]
        return f"begins {words}, {self.speed}"

    @property
    def speed(self) -> str:
        """Words on the rates at which it begins."""
        return _in_words(self.moving, "moving at", 1.0, "m/s") if self.moving else "at rest"


class Moved(NamedTuple):
    """A component, m or m/s, of a point's displacement or velocity, and where it is given."""

    where: str
    point: str
    axis: Axis
    value: float


def _displacements(where: str, points: Mapping[str, Mapping[Any, float] | None] | None) -> list[Moved]:
    """Components of points by name. Those of the tip alone are given at `where`, others at the point's name below."""
    moved = list[Moved]()
    for name, values in (points or {}).items():
        place = where if where.startswith("tip_") else f"{where}.{name}"
        moved += [Moved(f"{place}.{axis}", name, axis, value) for axis, value in (values or {}).items()]
    return moved


def _in_words(moved: Sequence[Moved], verb: str, size: float, unit: str) -> str:
    """Say how points are displaced or move."""
    by_point = dict[str, list[str]]()
    for _, point, axis, value in moved:
        by_point.setdefault("its tip" if point == "tip" else point, []).append(f"{axis} {size * value:.4g} {unit}")
    return " and ".join(f"{point} {verb} {', '.join(values)}" for point, values in by_point.items())


def begun(initial: Initial | State) -> Initial:
    """The initial state, or that which a name stands for; InputError if it is neither."""
    if isinstance(initial, Initial):
        return initial
    choice("initial", initial, STATE_WORDS)
    return Initial(initial)


def assign_to_bodies(flexible: Mapping[str, Structure], moved: Sequence[Moved]) -> dict[str, list[Moved]]:
    """Assign components to the bodies that deform, by name; the points lose their bodies' names.

    A point may be named without its body where one body alone deforms. InputError if there is no such point, or no
    shape moves it in this direction.
    """
    by_body: dict[str, list[Moved]] = {name: [] for name in flexible}
    deforming = {name: body for name, body in flexible.items() if body.size}
    points = [f"{name}.{station}" for name, body in deforming.items() for station in stations_of(body)]
    for component in moved:
        owner, _, point = component.point.rpartition(".")
        if not owner and len(deforming) == 1:
            (owner,) = deforming
        where = f"response.initial.{component.where}"
        if f"{owner}.{point}" not in points:
            problem = f"is of {component.point}, which is no point of a body that deforms"
            if not owner and len(deforming) > 1:
                problem = f"is of {component.point}, and {len(deforming)} bodies deform"
            fix = f"name one of {', '.join(points)}" if points else "leave it out: no body deforms"
            raise InputError(where.rpartition(".")[0], problem, fix)
        body = flexible[owner]
        number = "xyz".index(component.axis)
        if not np.any(body.station_places.first[stations_of(body)[point], number]):
            family = ("axial", "y", "z")[number]
            fix = f"give model.modes.{family} = 1 or more"
            raise InputError(where, "is along a direction without shapes", fix)
        if any((point, component.axis) == (assigned.point, assigned.axis) for assigned in by_body[owner]):
            raise InputError(where, "is given twice", "keep one of them")
        by_body[owner].append(Moved(where, point, component.axis, component.value))
    return by_body


def shape_of(body: Structure, moved: Sequence[Moved]) -> Array:
    """Coordinates (n,) of least strain energy with displacements of points.

    They are found by Newton's method with Lagrange's multipliers, or NaN where JAX traces the body and there are none.
    """
    stations, axes, wanted = _rows(body, moved)
    if body.traced:
        from gbeam.mechanics.equations.compiled import displaced

        return displaced(body, stations, axes, wanted)
    q = np.zeros(body.size)
    for _ in range(_ITERATIONS):
        coefficients, elastic = body.linearise(q)
        remainder = wanted - body.displacement(q)[stations, axes]
        change = _constrained(coefficients.stiffness, -elastic, body.station_slopes(q)[stations, axes], remainder)
        q = q + change
        if np.abs(change).max() <= 1e-12 * np.abs(q).max():
            return q
    words = _in_words(moved, "displaced by", 1e3, "mm")
    raise ComputationError("not converged", f"no shape of the beam has {words}; give less")


def rates_of(body: Structure, q: Array, moved: Sequence[Moved]) -> Array:
    """Rates (n,) with the velocities of points, in the shape of least strain energy, or zero without any velocity."""
    if not moved:
        return 0.0 * q
    stations, axes, wanted = _rows(body, moved)
    return _constrained(body.coefficients.stiffness, 0.0 * q, body.station_slopes(q)[stations, axes], wanted)


def _rows(body: Structure, moved: Sequence[Moved]) -> tuple[tuple[int, ...], tuple[int, ...], Array]:
    """Numbers of the stations and of the axes of components, and their values (k,)."""
    indices = stations_of(body)
    stations = tuple(indices[component.point] for component in moved)
    axes = tuple("xyz".index(component.axis) for component in moved)
    return stations, axes, np.asarray([component.value for component in moved], dtype=float)


def _constrained(stiffness: Array, force: Array, slopes: Array, value: Array) -> Array:
    """Solve K x = f + Jᵀ λ with J x = v for x (n,); J are the `slopes`, v the `value`."""
    solve = namespace(stiffness, force, slopes).linalg.solve
    unconstrained, shapes = solve(stiffness, force), solve(stiffness, slopes.T)
    return unconstrained + shapes @ solve(slopes @ shapes, value - slopes @ unconstrained)
