"""Names of what may be measured of a system and of what may drive it, and the values of measurements."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from gbeam.arrays.namespace import Array, concatenated, namespace
from gbeam.guards.kinds import KINDS
from gbeam.mechanics.tree.frames import turned
from gbeam.mechanics.tree.joints import SPIN, kind_of_value
from gbeam.mechanics.tree.steps import parameters_of_all, vector_of

if TYPE_CHECKING:
    from gbeam.mechanics.tree.system import System


class Driven(NamedTuple):
    """One number that drives a tree: the effort on coordinate `at`, component `at` of force `force` (wrenches), of the
    base's acceleration (a, alpha), or the acceleration of prescribed coordinate `at`.
    """

    way: str
    at: int
    unit: str
    force: int = 0


# Kinds of what is measured at points, of joints but for their coordinates, and of what sections carry, axes of its own.
_OF_POINTS = {
    "place": "length",
    "velocity": "speed",
    "attitude": "angle",
    "acceleration": "acceleration",
    "spin": "angular rate",
}
CARRIED = {"force": "force", "moment": "torque"}


def kind_of_signal(name: str) -> str:
    """Kind of quantity, such as "speed", of a signal by its name."""
    signal = name.rpartition(".")[2]
    kind = (_OF_POINTS | CARRIED).get(signal.rpartition("_")[0])
    if kind is not None:
        return kind
    rate = signal.removesuffix("_rate")
    return kind_of_value("initial_rate" if rate != signal or signal in SPIN else "initial", rate)


def kind_of_drive(name: str) -> str:
    """Kind of quantity, such as "torque", of a drive by its name."""
    drive = name.rpartition(".")[2]
    return CARRIED.get(drive.rpartition("_")[0]) or kind_of_value("effort", drive)


def unit_of_effort(coordinate: str) -> str:
    """Unit, N or N m, of an effort along a coordinate or rate of a joint."""
    return KINDS[kind_of_value("effort", coordinate)].unit


def deforming(names: Sequence[str], body: str) -> list[int]:
    """Indices of the coordinates, among these names, that deform a body."""
    return [k for k, name in enumerate(names) if name.startswith(f"{body}.q")]


def local_names(coordinates: Iterable[str]) -> list[str]:
    """Names of the coordinates of :meth:`Tree.local`: rx, ry and rz in the place of Euler parameters e0 to e3."""
    turns = {"e1": "rx", "e2": "ry", "e3": "rz"}
    parts = [name.rpartition(".") for name in coordinates]
    return [f"{owner}.{turns.get(name, name)}" for owner, _, name in parts if name != "e0"]


def drives_of(system: System) -> dict[str, Driven]:
    """Efforts on the coordinates of joints, ``joint.angle``, and components of forces, ``thrust.force_x``, by name."""
    drives = {}
    rates = [f"{owner}.{rate}" for owner, joint in system.joints.items() for rate in joint.rate_names]
    for name in sorted(rates, key=system.row):
        drives[name] = Driven("effort", system.row(name), KINDS[kind_of_drive(name)].unit)
    for k, owner in enumerate(system.forces):
        for i, (part, kind) in enumerate(CARRIED.items()):
            unit = KINDS[kind].unit
            drives |= {f"{owner}.{part}_{axis}": Driven("wrenches", 3 * i + j, unit, k) for j, axis in enumerate("xyz")}
    return drives


def signals_of(system: System) -> dict[str, str]:
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
            signals |= {each: KINDS[kind_of_signal(each)].unit for each in names}
    for point in system.points:
        signals |= {f"{point}.{each}_{axis}": KINDS[kind].unit for each, kind in _OF_POINTS.items() for axis in "xyz"}
    return signals


def units_of(system: System) -> tuple[str, ...]:
    """SI units of the coordinates; "" for Euler parameters and for those that deform a body."""
    signals = signals_of(system)
    return tuple(signals.get(name, "") for name in system.coordinates)


def rate_signal(rate: str) -> str:
    """Name of a rate's signal: of a spin wx, wy or wz the same, of others with ``_rate`` behind."""
    return rate if rate in SPIN else f"{rate}_rate"


def carried_of(system: System) -> dict[str, str]:
    """Names, with units, of the section forces and moments at the beams' points: ``strip.root.moment_y``."""
    beams = [name for name in system.order if getattr(system.bodies[name], "sections", None) is not None]
    points = [f"{name}.{point}" for name in beams for point in system.points_of(name)]
    names = [f"{point}.{kind}_{axis}" for point in points for kind in CARRIED for axis in "xyz"]
    return {name: KINDS[kind_of_signal(name)].unit for name in names}


def measurable(system: System) -> dict[str, str]:
    """Names of all that controllers may measure and outputs may be, with their units."""
    return signals_of(system) | carried_of(system)


def measurements(system: System, tree: Any, y: Array, yd: Array, ydd: Array, inputs: Any, wanted: Sequence[str]) -> Any:
    """Values (..., k) of the `wanted` signals at unknown coordinates (..., n) of the system's tree or its local one."""
    xp, state, columns = namespace(y, inputs.ground.a), tree.motion(y, yd, ydd, inputs), []
    read = {
        "place": lambda frame: frame.p,
        "velocity": lambda frame: turned(frame.R, frame.v),
        "attitude": lambda frame: vector_of(parameters_of_all(xp.broadcast_to(frame.R, (*state.shape, 3, 3)))),
        "acceleration": lambda frame: frame.a,
        "spin": lambda frame: frame.w,
    }
    vectors = dict[tuple[str, str], Any]()  # of which several components may be wanted
    for signal in wanted:
        owner, _, kind = signal.rpartition(".")
        if owner in system.joints:
            joint = system.joints[owner]
            body = system.order.index(joint.body)
            names = [*joint.values, *map(rate_signal, joint.rate_names)]
            values_and_rates = tree.links[body].held(state.q[body][:-1], state.qd[body][:-1])
            columns.append(xp.broadcast_to(concatenated(list(values_and_rates))[..., names.index(kind)], state.shape))
        else:
            name, _, axis = kind.partition("_")
            if (owner, name) not in vectors:
                of_point, point = system.point("outputs", owner)
                vectors[owner, name] = read[name](state.points_of(system.order.index(of_point))[point])
            columns.append(xp.broadcast_to(vectors[owner, name][..., "xyz".index(axis)], state.shape))
    return xp.stack(columns, axis=-1) if columns else xp.zeros((*y.shape[:-1], 0))
