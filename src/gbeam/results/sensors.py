"""Accelerometers, and what they read."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import numpy as np

from gbeam.arrays.tree import Value
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import array, positive
from gbeam.guards.quantities import Factor, OfKind, Quantity, RotationVector, Seconds, Shape
from gbeam.numerics.samples import displacement
from gbeam.results.declared import INSIDE, labels, part, quantity
from gbeam.results.parts import VectorPeaks
from gbeam.results.result import Floats, Part

RESOLVED = 4.0  # samples to a period of the sensor


@typed
@dataclass(frozen=True, eq=False)
class Sensor(Value):
    """An accelerometer of three axes: a mass on a spring along each, of which the deflection is read.

    Raises
    ------
    InputError
        If a value is impossible.

    Examples
    --------
    >>> gb.Sensor(turn=(0, 0, 1.5708), frequency=200.0).damping_ratio
    0.7
    """

    turn: Annotated[
        RotationVector,
        "rotation vector of its axes in the base axes, of a system in those of its point: [x, y, z]",
    ] = (0.0, 0.0, 0.0)
    frequency: Annotated[
        Annotated[float, Quantity("frequency", "positive")] | None,
        "natural frequency of the spring, or the cut-off of a filter of second order; without one it reads the "
        "acceleration itself",
    ] = None
    damping_ratio: Annotated[Factor, "of the spring; 0.7 gives the widest flat range"] = 0.7
    sensitivity: Annotated[
        Annotated[Any, Quantity("ratio"), Shape((3, 3))] | None,
        "rows with the reading of each axis for a unit along each: one on the diagonal, and beside it what leaks from "
        "the others",
    ] = None

    def __post_init__(self) -> None:
        turn = np.asarray(array("turn", self.turn), dtype=float)
        if turn.shape != (3,):
            raise InputError("turn", f"is {self.turn!r}", "give three components in rad")
        if self.sensitivity is not None:
            matrix = np.asarray(array("sensitivity", self.sensitivity), dtype=float)
            if matrix.shape != (3, 3) or not np.isfinite(matrix).all():
                raise InputError("sensitivity", f"has the shape {matrix.shape}", "give 3 × 3 numbers")

    @typed
    def reads(self, acceleration: Annotated[Any, OfKind("acceleration")], step: Seconds) -> Floats:
        """Return what it reads of an acceleration over time, after having settled in the first.

        Parameters
        ----------
        acceleration : (t, 3)
            Base axes, m/s²; specific force where gravity acts, as sensors feel it.
        step : float
            Between the samples, s.

        Raises
        ------
        InputError
            If the samples do not resolve its frequency.

        Examples
        --------
        >>> import numpy as np
        >>> still = np.tile([0.0, 0.0, 9.81], (50, 1))
        >>> print(gb.Sensor(frequency=50.0).reads(still, step=1e-3)[-1])
        [0.   0.   9.81]
        """
        from scipy.spatial.transform import Rotation

        felt = np.asarray(array("acceleration", acceleration), dtype=float)
        if felt.ndim != 2 or felt.shape[1] != 3:
            raise InputError("acceleration", f"has the shape {felt.shape}", "give three components at each time")
        felt = felt @ Rotation.from_rotvec(self.turn).as_matrix()
        if self.frequency is not None:
            omega = 2 * np.pi * self.frequency
            if RESOLVED * self.frequency * positive("step", step, "s") > 1:
                problem = f"is {self.frequency:g} Hz, with samples {step:g} s apart"
                raise InputError("frequency", problem, f"simulate in steps of {1 / (RESOLVED * self.frequency):.2g} s")
            felt = omega**2 * displacement(felt, omega, self.damping_ratio, step)
        return felt if self.sensitivity is None else felt @ np.asarray(self.sensitivity, dtype=float).T


@dataclass(frozen=True, repr=False, eq=False)
class Readings(Part):
    """Readings of accelerometers at points over time, along their own axes."""

    json_rows: ClassVar[dict[str, str]] = {"sensor": ""}

    points: tuple[str, ...] = labels("name of the point at which the sensor is", "sensor")
    acceleration: Floats = quantity("m/s^2", "reading of the sensor", "time sensor axis", frame="axes of the sensor")
    peaks: VectorPeaks = part("largest readings", "sensor", unit="m/s^2", name="max_", key=INSIDE)
