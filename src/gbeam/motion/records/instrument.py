"""Instrument of a record: how its block is turned, given or found at rest, and the way from it to the root."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from gbeam.arrays.types import Floats, Numbers
from gbeam.constants import STANDARD_GRAVITY
from gbeam.errors import InputError
from gbeam.guards.checks import vector
from gbeam.guards.quantities import Quantity, Shape
from gbeam.motion.flight import body_rates
from gbeam.motion.profiles.piecewise import PiecewiseLinear
from gbeam.motion.records.rest import STILL, Rest, mean_of
from gbeam.motion.records.times import Moment, Times
from gbeam.motion.rigid import rotation_of, shift_base
from gbeam.results.parts import Base

_SIZE = 0.03  # of 1 g: scale error of an accelerometer at most
_TILT = math.radians(45)  # beyond that the shortest way is not the block's
_REST = f"{STILL} and level"


TurnOfBlock = Annotated[
    Annotated[Numbers, Quantity("angle"), Shape((3,))],
    "rotation vector of the axes that x, y and z name in base axes, where the instrument's block sits askew",
]
LevelStretch = Annotated[
    tuple[Moment, Moment] | None,
    "first and last time of a stretch at rest and level, on the record's own clock: the block is turned on by the "
    "shortest way, so that the specific force there points along z",
]
KnownLoads = Annotated[
    Sequence[Rest],
    "stretches at rest, or of another known load: what the sensors of x, y, z, p, q and r read there besides is their "
    "offset, and is subtracted; of several stretches it drifts on straight lines from one to the next, and on",
]


@dataclass(frozen=True)
class Instrument:
    """Accelerometers and gyros of a record on one block.

    The level stretch tells no turn about the vertical.
    """

    turn: TurnOfBlock = (0.0, 0.0, 0.0)
    level: LevelStretch = None
    rest: KnownLoads = ()
    arm: Annotated[
        Annotated[Numbers, Quantity("length"), Shape((3,))],
        "from the instrument to the specimen's root, base axes: by p, q and r it adds α × r + ω × (ω × r)",
    ] = (0.0, 0.0, 0.0)

    def axes(
        self, times: Times, load: Floats, rates: Floats, counted: Callable[[int], str], *, specific: bool
    ) -> tuple[Floats, list[str], tuple[float, float] | None]:
        """Return the rotation from the block's to base axes, words for it, and the ends of the level stretch, s.

        Loads (t, 3), m/s², and rates (t, 3) or (t, 0), rad/s, are in axes of the block.
        """
        matrix, notes, ends = np.eye(3), list[str](), None
        if np.any(turn := vector("record.turn", self.turn)):
            matrix = rotation_of(turn)
            notes.append(f"the block's axes are turned by {_words(turn)} in base axes")
        if self.level is not None:
            if not specific:
                problem = "is given, and the record holds acceleration, which is none at rest"
                raise InputError("record.level", problem, "give the block's turn in its place")
            stretch = times.part(self.level, counted, ("level[0]", "level[1]"))
            ends = float(times.values[stretch][0]), float(times.values[stretch][-1])
            span = f"from {ends[0]:.6g} to {ends[1]:.6g} s"
            tilt = _tilt(load[stretch] @ matrix.T, rates[stretch], span)
            matrix = rotation_of(tilt) @ matrix
            notes.append(f"levelled by the rest {span}: turned by {_words(tilt)} in base axes")
        return matrix, notes, ends

    def carried(self, time: Floats, load: Floats, rates: Floats) -> tuple[Floats, list[str]]:
        """Return the load (t, 3), m/s², at the root instead of at the instrument, and words for it. Rates (t, 3),
        rad/s, are in base axes.

        Angular accelerations are derivatives of the rates without their corners: the flight turns with these.
        """
        if not any(self.arm):
            return load, []
        rates_profile = body_rates(PiecewiseLinear(time, rates))
        root = shift_base(Base(load, *rates_profile.derivatives(time)), np.array(self.arm)).a_WO_B
        largest_change = np.linalg.norm(root - load, axis=1).max() / STANDARD_GRAVITY
        arm = ", ".join(f"{1e3 * component:.4g}" for component in self.arm)
        return root, [f"at the root, ({arm}) mm from the instrument: turning adds up to {largest_change:.4g} g"]


def _tilt(load: Floats, rates: Floats, span: str) -> Floats:
    """Rotation vector that turns the mean of a load (t, 3) to point along z. InputError unless the load
    is one at rest.
    """
    mean = mean_of("level", load, rates, span, _REST)[0] / STANDARD_GRAVITY
    size = float(np.linalg.norm(mean))
    if abs(size - 1) > _SIZE:
        problem = f"is no stretch at rest: the load is {size:.4g} g {span}, and at rest 1 g"
        raise InputError("record.level", problem, f"{_REST}; or mend the unit")
    axis, angle = np.cross(mean, [0.0, 0.0, 1.0]), float(np.arctan2(np.hypot(*mean[:2]), mean[2]))
    if angle > _TILT:
        problem = f"turns the block by {math.degrees(angle):.4g} deg: the load {span} is {_listed(mean)} g"
        fix = "say by the columns of x, y and z, or by turn, how the block sits: level finds what is left, below 45 deg"
        raise InputError("record.level", problem, fix)
    sine = float(np.linalg.norm(axis))
    return axis * (angle / sine) if sine else axis


def _words(turn: Floats) -> str:
    """Rotation vector as an angle about an axis."""
    angle = float(np.linalg.norm(turn))
    return f"{math.degrees(angle):.4g} deg" + (f" about {_listed(turn / angle)}" if angle else "")


def _listed(values: Floats) -> str:
    return f"({', '.join(f'{value:.3g}' for value in values)})"
