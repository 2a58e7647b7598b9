"""How a centrifuge gets under way: it turns already, or it spins up from standstill while its target waits.

Over the spin-up the target stands still at the load that it has at the end, f₁ with the horizontal part H₁, and the
arm's rate rises as ω1 = S(s) Ω, Ω = sqrt(H₁/R), s = (t − t₀)/T; S is flat to the fourth order at both ends, so that
angles, rates, accelerations and jerks meet the inverse's. The load asked for on the way has the direction of f₁ (its
part along the beam and across it rise together; gravity stays) and the size p H₁:

- ``rest``: p = S². The arm's tangential acceleration R dω1/dt is ignored, as quasi-static does: axis 2 stands still.
- ``pre-yawed``: p = sqrt(S⁴ + (S'/ΩT)²) and axis 2 lags by δ = atan2(dω1/dt, ω1²), theory.md A1 (9), so that the load
  has its direction and size from the first instant. At standstill all of it is tangential: δ starts at 90°.
"""

from __future__ import annotations

from abc import abstractmethod

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from gbeam.errors import InputError
from gbeam.motion.centrifuge.inverses.closed_form import Geometry, Inverse, Pose, speed
from gbeam.motion.centrifuge.target.target import Target
from gbeam.motion.profiles.profile import Profile

STARTS = ("idle", "rest", "pre-yawed")
# rad of ΩT, from which on p never falls: (ΩT)² >= −S''/2S³ everywhere, with S'' = 2520 s³ (1 − s)³ (1 − 2s).
LEAST_TURNED = 2.982


class Start(eqx.Module):
    """What a start makes of the axis motions of an inverse and of the load that is asked of them."""

    @abstractmethod
    def pose(self, inverse: Inverse, target: Profile, t: Float[Array, "*t"]) -> Pose:
        """Rate of axis 1 (rad/s) and angles of axes 2 and 3 (rad) at times `t` (s)."""

    @abstractmethod
    def load(self, target: Profile, t: Float[Array, "*t"]) -> Float[Array, "... 3"]:
        """Load asked for at the control point at times `t` (s), base axes, m/s²."""


class Turning(Start):
    """The arm turns from the first instant: nothing is changed."""

    def pose(self, inverse: Inverse, target: Profile, t: Float[Array, "*t"]) -> Pose:
        """The inverse's own."""
        return inverse(target, t)

    def load(self, target: Profile, t: Float[Array, "*t"]) -> Float[Array, "... 3"]:
        """The target's own."""
        return target(t)


class SpinUp(Start):
    """From standstill to an inverse's motion at a target that waits.

    Parameters
    ----------
    geometry : Geometry
    begin, end : float
        Of the spin-up, s; the target stands still between.
    turned : float
        ΩT, rad: what the arm would turn by at its full rate.
    yawed : float
        1 to make up for the tangential acceleration by the lag of axis 2, 0 not to.
    """

    geometry: Geometry
    begin: Float[Array, ""]
    end: Float[Array, ""]
    turned: Float[Array, ""]
    yawed: Float[Array, ""]

    def pose(self, inverse: Inverse, target: Profile, t: Float[Array, "*t"]) -> Pose:
        """The inverse's, its rate times S, its angles as the load on the way has them."""
        s = self._part(t)
        rise, still = _rise(s), inverse(target, jnp.full_like(t, self.end))
        rate, yaw, roll = inverse(target, t)
        # A plan need not stand still: its gimbals fade in. Angles are compared within half a turn.
        yaw, roll = (
            there + rise * (angle - there - 2 * jnp.pi * jnp.round((angle - there) / (2 * jnp.pi)))
            for angle, there in zip((yaw, roll), still[1:], strict=True)
        )
        # tan δ = (dω1/dt)/ω1² = S'/(ΩT S²), with the powers of s and 1 − s that both hold taken out.
        lag = jnp.pi / 2 - jnp.arctan2(self.turned * s**6 * _quotient(s) ** 2, 630 * (1 - s) ** 4)
        share = self._share(s)
        across = self._across(target(t))
        pulls = self.geometry.gravity > 0
        down = jnp.where(pulls, self.geometry.gravity, 1.0)  # arctan2(0, 0) has no derivative
        tilt = jnp.arctan2(down, share * across) - jnp.arctan2(down, across)
        return rise * rate, yaw - self.yawed * lag, roll + jnp.where(pulls, tilt, 0.0)

    def load(self, target: Profile, t: Float[Array, "*t"]) -> Float[Array, "... 3"]:
        """The horizontal part of the target's, p of it, with gravity."""
        full, share = target(t), self._share(self._part(t))
        across, pulls = self._across(full), self.geometry.gravity > 0
        total2 = jnp.where(pulls, (share * across) ** 2 + self.geometry.gravity**2, 1.0)
        size = jnp.where(pulls, jnp.sqrt(total2), share * jnp.abs(across))
        before2 = jnp.sum(full[..., 1:] ** 2, axis=-1)
        before = jnp.sqrt(jnp.where(before2 > 0, before2, 1.0))
        return full * jnp.stack([share, size / before, size / before], axis=-1)

    def _part(self, t: Float[Array, "*t"]) -> Float[Array, "*t"]:
        return jnp.clip((t - self.begin) / (self.end - self.begin), 0.0, 1.0)

    def _share(self, s: Float[Array, "*t"]) -> Float[Array, "*t"]:
        """p, with s⁴ taken out of the root."""
        tangential = self.yawed * 630 * (1 - s) ** 4 / self.turned
        still = self.yawed == 0
        root = jnp.where(still, 1.0, s**12 * _quotient(s) ** 4 + tangential**2)
        return jnp.where(still, _rise(s) ** 2, s**4 * jnp.sqrt(root))

    def _across(self, load: Float[Array, "... 3"]) -> Float[Array, "*t"]:
        """B2 = ±sqrt(f_y² + f_z² − γ²) of a load, m/s²."""
        horizontal2 = jnp.sum(load[..., 1:] ** 2, axis=-1) - self.geometry.gravity**2
        bent = horizontal2 > 0
        return jnp.where(bent, self.geometry.sign * jnp.sqrt(jnp.where(bent, horizontal2, 1.0)), 0.0)


def _quotient(s: Float[Array, "*t"]) -> Float[Array, "*t"]:
    """S over s⁵."""
    return 126 - 420 * s + 540 * s**2 - 315 * s**3 + 70 * s**4


def _rise(s: Float[Array, "*t"]) -> Float[Array, "*t"]:
    """S = s⁵ (126 − 420 s + 540 s² − 315 s³ + 70 s⁴), S' = 630 s⁴ (1 − s)⁴."""
    return s**5 * _quotient(s)


def build_start(kind: str, target: Target, geometry: Geometry) -> Start:
    """Make the start of a motion.

    Parameters
    ----------
    kind : str
        One of ``STARTS``.
    target : Target
        Built with a `spin_up` unless it is idle.
    geometry : Geometry

    Raises
    ------
    InputError
        If the kind is unknown, the target has no spin-up, or a pre-yawed one so short that the load would overshoot.
    """
    if kind not in STARTS:
        raise InputError("start", f"is {kind!r}", f"choose one of {', '.join(STARTS)}")
    first, ready, width = float(target.span[0]), float(target.ready), 2 * float(target.reach)
    if (kind == "idle") != (ready == first):
        raise InputError("spin_up", f"does not go with start = {kind}", "give both start and spin_up, or neither")
    if kind == "idle":
        return Turning()
    end = ready - width  # from there on the target's corner is being rounded
    full = float(eqx.filter_jit(lambda load, t: speed(load(t), geometry))(target.load, jnp.asarray(first)))
    turned, yawed = full * (end - first), kind == "pre-yawed"
    if yawed and turned < LEAST_TURNED:
        raise InputError(
            "spin_up",
            f"is {ready - first:.3g} s, so short that a pre-yawed start would overshoot its load",
            f'give "{np.ceil(10 * (LEAST_TURNED / full + width)) / 10:g} s" or more, or start = "rest"',
        )
    numbers = (jnp.asarray(it, dtype=float) for it in (first, end, turned, float(yawed)))
    return SpinUp(geometry, *numbers)
