"""Names of signals, drives and coordinates, and what the names say."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from gbeam.guards.kinds import KINDS
from gbeam.mechanics.tree.joints import SPIN, kind_of_value

# Kinds of what is measured at points, of joints but for their coordinates, and of what sections carry, axes of its own.
OF_POINTS = {
    "place": "length",
    "velocity": "speed",
    "attitude": "angle",
    "acceleration": "acceleration",
    "spin": "angular rate",
}
CARRIED = {"force": "force", "moment": "torque"}


def kind_of_signal(name: str) -> str:
    """Kind of quantity, such as "speed", that a signal measures, from its name."""
    signal = name.rpartition(".")[2]
    kind = (OF_POINTS | CARRIED).get(signal.rpartition("_")[0])
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


def rate_signal(rate: str) -> str:
    """Name of a rate's signal: of a spin wx, wy or wz the same, of others with ``_rate`` behind."""
    return rate if rate in SPIN else f"{rate}_rate"


def deforming(names: Sequence[str], body: str) -> list[int]:
    """Indices of the coordinates, among these names, that deform a body."""
    return [k for k, name in enumerate(names) if name.startswith(f"{body}.q")]


def local_names(coordinates: Iterable[str]) -> list[str]:
    """Names of the coordinates of :meth:`Tree.local`: rx, ry and rz in the place of Euler parameters e0 to e3."""
    turns = {"e1": "rx", "e2": "ry", "e3": "rz"}
    parts = [name.rpartition(".") for name in coordinates]
    return [f"{owner}.{turns.get(name, name)}" for owner, _, name in parts if name != "e0"]
