"""The measures by which a place for the specimen is judged: histories of what the mismatch does, per measure."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gbeam.analysis.response.settings import ResponseSettings
from gbeam.analysis.response.steps.stepping import first_step
from gbeam.errors import InputError
from gbeam.mechanics.influence import influence
from gbeam.mechanics.structure import Structure
from gbeam.motion import Centrifuge, Flight
from gbeam.motion.bases.base import gradient
from gbeam.motion.centrifuge.machine.kinematics import forward
from gbeam.numerics.filters.oscillators import displacement
from gbeam.results.result import Flags, Floats


@dataclass(frozen=True)
class Histories:
    """A measure over the times compared: of the load's error at C, and of g x and g; (t, k) each; flight's own peak."""

    at_control_point: Floats
    linear: Floats
    uniform: Floats
    scale: float

    def size(self, at: float, total: bool) -> float:
        """Largest size with the control point at `at` m, over flight's peak; in `total` with the load's error at C."""
        return self._largest(self.linear - at * self.uniform + (self.at_control_point if total else 0.0))

    @property
    def error(self) -> float:
        """The same of the load's error at C alone, which no control point changes."""
        return self._largest(self.at_control_point)

    def _largest(self, values: Floats) -> float:
        return float(np.linalg.norm(values, axis=-1).max(initial=0.0)) / self.scale


class Answers:
    """Quasi-static answers and the first mode's, to uniform or linear loads, at times when the first centrifuge's
    target is not held: begin with the widest smoothing, which holds longest.
    """

    def __init__(self, structure: Structure, flight: Flight, settings: ResponseSettings) -> None:
        self.step = first_step(structure, flight, settings)
        self.time = settings.start + self.step * np.arange(round(settings.duration / self.step) + 1)
        self.left_out: Flags | None = None
        self.influence = influence(structure)
        c = structure.coefficients
        frequency, modes = structure.rest
        self.frequency, first = float(frequency[0]), modes[:, 0]
        self.damping = float(first @ c.damping @ first) / (2 * self.frequency)
        self.tip = float(np.abs(structure.station_places.first[-1] @ first).max())
        self.uniform = c.f_a @ first
        self.linear = np.array([0.0, c.f_al[2] @ first, -c.f_al[1] @ first])

    def histories(
        self, flight: Flight, centrifuge: Centrifuge
    ) -> tuple[dict[str, Histories], tuple[float, float, float]]:
        """Every measure's, and the largest accelerations of the axes, rad/s²."""
        error, gradient, load, turning, not_followed = self._mismatch(flight, centrifuge)
        self.left_out = not_followed if self.left_out is None else self.left_out
        covered = ~(not_followed | self.left_out)
        if not covered.any():
            raise InputError("tracks", "is never carried: the target is held all the time", "lower idle")
        static, across = self.influence, np.array([0.0, 1.0, 1.0])

        def quasi_static(uniform: Floats, linear: Floats) -> Histories:
            parts = error * uniform, gradient * linear, gradient * uniform
            at_c, growing, even = ((part * across)[covered] for part in parts)
            return Histories(at_c, growing, even, _peak((load * uniform * across)[covered]))

        def vibration(force: Floats) -> Floats:
            trend = force / self.frequency**2
            return self.tip * (displacement(force, self.frequency, self.damping, self.step) - trend)[covered, None]

        measures = {
            "root-shear": quasi_static(static.force_uniform, static.force_linear),
            "root-moment": quasi_static(static.moment_uniform, static.moment_linear),
            "tip": quasi_static(static.tip_uniform, static.tip_linear),
        }
        transverse = self.uniform * across
        measures["vibration"] = Histories(
            vibration(error @ transverse), vibration(gradient @ self.linear), vibration(gradient @ transverse),
            scale=measures["tip"].scale,
        )  # fmt: skip
        accelerations = np.abs(turning).max(axis=0)
        return measures, (float(accelerations[0]), float(accelerations[1]), float(accelerations[2]))

    def _mismatch(self, flight: Flight, centrifuge: Centrifuge) -> tuple[Floats, Floats, Floats, Floats, Flags]:
        """Load at C and gradient less the flight's, the flight's load; axis accelerations; where it is not followed."""
        axes = centrifuge.axes(self.time)
        geometry = centrifuge.geometry
        at_c, flown = forward(axes, geometry.arm, geometry.gravity), flight.base(self.time)
        turning = axes.accelerations
        return (
            at_c.a_WO_B - flown.a_WO_B,
            gradient(at_c.w_WB_B, at_c.alpha_WB_B) - gradient(flown.w_WB_B, flown.alpha_WB_B),
            flown.a_WO_B,
            turning,
            centrifuge.not_followed(self.time),
        )


def _peak(values: Floats) -> float:
    peak = float(np.linalg.norm(values, axis=-1).max(initial=0.0))
    if peak == 0:
        raise InputError("tracks", "loads the beam along its axis only", "track a flight that loads it across")
    return peak
