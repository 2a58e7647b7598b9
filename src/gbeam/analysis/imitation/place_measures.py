"""The measures by which a place for the specimen is judged: histories of what the mismatch does, per measure."""

from __future__ import annotations

from dataclasses import dataclass

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray

from gbeam.analysis.response.section_forces import influence
from gbeam.analysis.response.stepping import first_step
from gbeam.analysis.study.case import ResponseSettings
from gbeam.errors import InputError
from gbeam.mechanics.assembly import Structure, rest_modes
from gbeam.mechanics.energy import rest_matrices
from gbeam.mechanics.equations import coefficients
from gbeam.motion import Base, Centrifuge, Flight
from gbeam.numerics.oscillators import displacement
from gbeam.results.response import Floats

_BLOCK = 4096


@dataclass(frozen=True)
class Histories:
    """A measure over the times compared: of the load's error at C, and of g x and g; (t, k) each; flight's own peak."""

    whole: Floats
    linear: Floats
    uniform: Floats
    scale: float

    def size(self, at: float, whole: bool) -> float:
        """Largest size with the control point at `at` m, over flight's peak."""
        values = self.linear - at * self.uniform + (self.whole if whole else 0.0)
        return float(np.sqrt(np.sum(values**2, axis=-1)).max(initial=0.0)) / self.scale


@eqx.filter_jit
def _load_error(flight: Flight, centrifuge: Centrifuge, t: jax.Array) -> tuple[jax.Array, ...]:
    """Load at C less the flight's, gradient less the flight's, the flight's load; axis accelerations; held or not."""
    axes = centrifuge.axes(t)
    there, here = flight.base(t), centrifuge.base(t)

    def gradient(base: Base) -> jax.Array:
        w, al = base.w_WB_B, base.alpha_WB_B
        wx, wy, wz = w[..., 0], w[..., 1], w[..., 2]
        return jnp.stack([-(wy**2 + wz**2), wx * wy + al[..., 2], wx * wz - al[..., 1]], axis=-1)

    turning = jnp.stack([axes.acceleration1, axes.acceleration2, axes.acceleration3], axis=-1)
    error = centrifuge.actual(t) - there.a_WO_B
    return error, gradient(here) - gradient(there), there.a_WO_B, turning, centrifuge.not_followed(t)


class Answers:
    """The structure's quasi-static answers and its first mode's, to loads that are uniform or linear along the beam.

    The times at which the first centrifuge's target is held are left out for all, so that options are judged over the
    same times: begin with the widest smoothing, which holds longest.
    """

    def __init__(self, structure: Structure, settings: ResponseSettings) -> None:
        self.step = first_step(structure, settings)
        self.time = settings.start + self.step * np.arange(round(settings.duration / self.step) + 1)
        self.left_out: NDArray[np.bool_] | None = None
        self.influence = influence(structure)
        c = coefficients(structure.system)
        frequency, modes = rest_modes(*rest_matrices(structure.system.energy))
        self.frequency, first = float(frequency[0]), modes[:, 0]
        self.damping = float(first @ np.asarray(c.damping) @ first) / (2 * self.frequency)
        per_q = np.asarray(jax.jacfwd(structure.displacement)(jnp.zeros(structure.size)))[-1]
        self.tip = float(np.abs(per_q @ first).max())
        self.uniform = np.asarray(c.f_a) @ first
        self.linear = np.array([0.0, np.asarray(c.f_al)[2] @ first, -np.asarray(c.f_al)[1] @ first])

    def histories(
        self, flight: Flight, centrifuge: Centrifuge
    ) -> tuple[dict[str, Histories], tuple[float, float, float]]:
        """Every measure's, and the largest accelerations of the axes, rad/s²."""
        error, gradient, load, turning, held = self._sampled(flight, centrifuge)
        self.left_out = held if self.left_out is None else self.left_out
        covered = ~(held | self.left_out)
        if not covered.any():
            raise InputError("tracks", "is never carried: the target is held all the time", "lower idle")
        it, across = self.influence, np.array([0.0, 1.0, 1.0])

        def quasi_static(uniform: Floats, linear: Floats) -> Histories:
            parts = ((error * uniform), (gradient * linear), (gradient * uniform))
            own = (load * uniform * across)[covered]
            whole, linear_part, uniform_part = ((part * across)[covered] for part in parts)
            return Histories(whole, linear_part, uniform_part, _peak(own))

        def vibration(force: Floats) -> Floats:
            trend = force / self.frequency**2
            return self.tip * (displacement(force, self.frequency, self.damping, self.step) - trend)[covered, None]

        found = {
            "root-shear": quasi_static(it.force_uniform, it.force_linear),
            "root-moment": quasi_static(it.moment_uniform, it.moment_linear),
            "tip": quasi_static(it.tip_uniform, it.tip_linear),
        }
        transverse = self.uniform * across
        found["vibration"] = Histories(
            vibration(error @ transverse), vibration(gradient @ self.linear), vibration(gradient @ transverse),
            scale=found["tip"].scale,
        )  # fmt: skip
        accelerations = np.abs(turning).max(axis=0)
        return found, (float(accelerations[0]), float(accelerations[1]), float(accelerations[2]))

    def _sampled(self, flight: Flight, centrifuge: Centrifuge) -> list[np.ndarray]:
        """In blocks of one compiled shape."""
        count = len(self.time)
        padded = np.concatenate([self.time, np.repeat(self.time[-1], -count % _BLOCK)])
        parts = [_load_error(flight, centrifuge, jnp.asarray(t)) for t in np.split(padded, len(padded) // _BLOCK)]
        return [np.concatenate([np.asarray(part[k]) for part in parts])[:count] for k in range(5)]


def _peak(values: Floats) -> float:
    peak = float(np.linalg.norm(values, axis=-1).max(initial=0.0))
    if peak == 0:
        raise InputError("tracks", "loads the beam along its axis only", "track a flight that loads it across")
    return peak
