"""Names of what may be measured of a system and of what may drive it, and the values of measurements."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple, Protocol

from gbeam.arrays.namespace import Array, concatenated, namespace
from gbeam.guards.kinds import KINDS
from gbeam.mechanics.fields.products import turned
from gbeam.mechanics.tree.frames import Frame
from gbeam.mechanics.tree.joints import Joint
from gbeam.mechanics.tree.signal_names import CARRIED, OF_POINTS, kind_of_drive, kind_of_signal, rate_signal
from gbeam.mechanics.tree.steps import parameters_of_matrices, rotation_vector


class Measured(Protocol):
    """System as far as its signals ask, :class:`gbeam.System`."""

    @property
    def bodies(self) -> Mapping[str, Any]:
        """Rigid bodies and structures by name."""
        ...

    @property
    def joints(self) -> Mapping[str, Joint]:
        """Joints by name."""
        ...

    @property
    def forces(self) -> Mapping[str, Any]:
        """Forces at points by name."""
        ...

    @property
    def order(self) -> tuple[str, ...]:
        """Names of the bodies, each behind the one that carries it."""
        ...

    @property
    def points(self) -> tuple[str, ...]:
        """Names of all points, as ``body.point``."""
        ...

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of all coordinates."""
        ...

    def points_of(self, body: str) -> tuple[str, ...]:
        """Return the names of a body's points."""
        ...

    def point(self, where: str, name: str) -> tuple[str, int]:
        """Return the body and the index of a point."""
        ...

    def row(self, name: str) -> int:
        """Return the index of the equation on which an effort on a joint acts."""
        ...

    def link(self, joint: str) -> int:
        """Return the index of the link of a joint in the tree."""
        ...


class Driven(NamedTuple):
    """One number that drives a tree: the effort on coordinate `at`, component `at` of force `force` (wrenches), of the
    base's acceleration (a, alpha), or the acceleration of prescribed coordinate `at`.
    """

    way: str
    at: int
    unit: str
    force: int = 0


def drives_of(system: Measured) -> dict[str, Driven]:
    """Efforts that may be driven, by name: those of joints, ``joint.angle``, and components of forces,
    ``thrust.force_x``.
    """
    drives = {}
    rates = [f"{owner}.{rate}" for owner, joint in system.joints.items() for rate in joint.rate_names]
    for name in sorted(rates, key=system.row):
        drives[name] = Driven("effort", system.row(name), KINDS[kind_of_drive(name)].unit)
    for k, owner in enumerate(system.forces):
        for i, (part, kind) in enumerate(CARRIED.items()):
            unit = KINDS[kind].unit
            drives |= {f"{owner}.{part}_{axis}": Driven("wrenches", 3 * i + j, unit, k) for j, axis in enumerate("xyz")}
    return drives


def signals_of(system: Measured) -> dict[str, str]:
    """Names of the motions that may be measured of a system, with their units.

    Of joints: each value and its rate, ``joint.angle`` and ``joint.angle_rate``, of balls the rotation vector
    ``joint.rx`` and the angular velocity ``joint.wx``. Of points: ``place`` and ``velocity`` (axes of the ground),
    ``attitude``, the rotation vector of at most half a turn from the ground's axes to the point's, ``acceleration`` and
    ``spin``, as sensors there read them (axes of the point).
    """
    signals: dict[str, str] = {}
    for name, joint in system.joints.items():
        for value, rate in zip(joint.values, joint.rate_names, strict=True):
            names = f"{name}.{value}", f"{name}.{rate_signal(rate)}"
            signals |= {signal: KINDS[kind_of_signal(signal)].unit for signal in names}
    for point in system.points:
        for vector, kind in OF_POINTS.items():
            signals |= {f"{point}.{vector}_{axis}": KINDS[kind].unit for axis in "xyz"}
    return signals


def units_of(system: Measured) -> tuple[str, ...]:
    """SI units of the coordinates, or "" for Euler parameters and for those that deform a body."""
    signals = signals_of(system)
    return tuple(signals.get(name, "") for name in system.coordinates)


def carried_of(system: Measured) -> dict[str, str]:
    """Names, with units, of the section forces and moments at the beams' points: ``strip.root.moment_y``."""
    beams = [name for name in system.order if getattr(system.bodies[name], "sections", None) is not None]
    points = [f"{name}.{point}" for name in beams for point in system.points_of(name)]
    names = [f"{point}.{kind}_{axis}" for point in points for kind in CARRIED for axis in "xyz"]
    return {name: KINDS[kind_of_signal(name)].unit for name in names}


def measurable(system: Measured) -> dict[str, str]:
    """Names of all that controllers may measure and outputs may be, with their units."""
    return signals_of(system) | carried_of(system)


def measurements(
    system: Measured, tree: Any, y: Array, yd: Array, ydd: Array, inputs: Any, wanted: Sequence[str]
) -> Any:
    """Values (..., k) of the `wanted` signals at unknown coordinates (..., n) and their rates.

    The tree is the system's, or its local one. Vectors at a point are computed once for all their components.
    """
    xp, state, columns = namespace(y, inputs.ground.a), tree.motion(y, yd, ydd, inputs), []

    def attitude(frame: Frame) -> Array:
        return rotation_vector(parameters_of_matrices(xp.broadcast_to(frame.R, (*state.shape, 3, 3))))

    read: dict[str, Callable[[Frame], Any]] = {
        "place": lambda frame: frame.p,
        "velocity": lambda frame: turned(frame.R, frame.v),
        "attitude": attitude,
        "acceleration": lambda frame: frame.a,
        "spin": lambda frame: frame.w,
    }
    vectors = dict[tuple[str, str], Any]()  # of which several components may be wanted
    for signal in wanted:
        owner, _, kind = signal.rpartition(".")
        if owner in system.joints:
            joint = system.joints[owner]
            body = system.link(owner)
            names = [*joint.values, *map(rate_signal, joint.rate_names)]
            values_and_rates = tree.links[body].spring_values(state.q[body][:-1], state.qd[body][:-1])
            columns.append(xp.broadcast_to(concatenated(list(values_and_rates))[..., names.index(kind)], state.shape))
        else:
            name, _, axis = kind.partition("_")
            if (owner, name) not in vectors:
                body_name, point = system.point("outputs", owner)
                vectors[owner, name] = read[name](state.points_of(system.order.index(body_name))[point])
            columns.append(xp.broadcast_to(vectors[owner, name][..., "xyz".index(axis)], state.shape))
    return xp.stack(columns, axis=-1) if columns else xp.zeros((*y.shape[:-1], 0))
