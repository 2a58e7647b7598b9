"""Frequencies in the ground frame of what vibrates in a turning one."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from gbeam.arrays.types import Complex, Flags, Floats

QUARTERS = np.pi / 2 * np.arange(4)  # angles of turn, rad
SMALL = 1e-6  # of a mode's largest motion: less is none
STILL = 1e-9  # of the extent: less is no displacement


class Whirl(NamedTuple):
    """Points in the ground frame, at quarters of a turn with a `rate`, rad/s: places (4, p, 3), and displacements and
    rotations (4, p, m, n) by coordinates.
    """

    rate: float
    places: Floats
    slopes: Floats

    @property
    def carried(self) -> Flags:
        """Flags (p,) of points that are off the axis, and move by the coordinates."""
        extent = np.ptp(self.places, axis=(0, 1)).max(initial=1e-300)
        is_off = np.abs(self.places - self.places[0]).max(axis=(0, 2)) > STILL * extent
        return np.asarray(is_off & self.slopes.any(axis=(0, 2, 3)))

    @property
    def turning(self) -> bool:
        """True if coordinates move points along what turns, or points that are carried round."""
        change = np.abs(self.slopes - self.slopes[0]).max(initial=0.0)
        return bool(change > SMALL * np.abs(self.slopes).max(initial=0.0) or self.carried.any())

    def in_ground(self, frequency: Floats, modes: Complex) -> Floats:
        """Frequencies (k,) Hz in the ground frame of modes (n, k) with frequencies (k,) Hz.

        It is NaN of a mode that has more than one there, or moves points off the axis.
        """
        # After a turn by θ a mode moves Σ v_n exp(i n θ), and over time Re Σ v_n exp(i (ω + n Ω) t).
        size = np.abs(np.fft.fft(self.slopes @ modes, axis=0)).max(axis=2, initial=0.0)  # (orders, points, modes)
        orders = size.max(axis=1) > SMALL * size.max(axis=(0, 1))
        is_off = size[:, self.carried].max(axis=(0, 1), initial=0.0) > SMALL * size.max(axis=(0, 1))
        is_known = (orders.sum(axis=0) == 1) & ~orders[2] & ~is_off
        order = np.array([0.0, 1.0, np.nan, -1.0])[orders.argmax(axis=0)]
        return np.where(is_known, np.abs(frequency + order * self.rate / (2 * np.pi)), np.nan)


def whirl_of(places: Floats, slopes: Floats, rate: float, spin: Floats, acceleration: Floats) -> Whirl | None:
    """Points on what turns with a `rate`, rad/s, at quarters of a turn or at one instant, or None where nothing turns.

    The base turns with a `spin` (3,), rad/s, and accelerates, m/s². No frequency is known where both turn.
    """
    rate = rate if rate > STILL else 0.0
    square = float(spin @ spin)
    base_turns = square > STILL**2
    if not (rate or base_turns):
        return None
    places, slopes = (np.broadcast_to(history, (4, *history.shape[1:])) for history in (places, slopes))
    if not base_turns:
        return Whirl(rate, places, slopes)
    # The base's axis passes through the point whose acceleration across it is zero.
    radial = acceleration - (acceleration @ spin) * spin / square
    centre = radial / square
    x, y, z = spin / np.sqrt(square)
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turns = np.array([np.eye(3) + np.sin(t) * skew + (1 - np.cos(t)) * skew @ skew for t in QUARTERS])
    vectors = slopes.reshape(4, places.shape[1], -1, 3, slopes.shape[-1])
    return Whirl(
        math.nan if rate else math.sqrt(square),
        np.einsum("qab,qpb->qpa", turns, places - centre),
        np.einsum("qab,qpmbn->qpman", turns, vectors).reshape(slopes.shape),
    )
