"""The planned inverse: axis motions with the least tracking error over the whole record, within the machine's limits.

The three axes are quintic splines. Their coefficients minimise, by Levenberg and Marquardt's method,

    ∫ w |a_C − wanted|²/g0² + μ Σ over(share of each limit)² + ease of the motion  dt,

where w is small while the target is held anyway, over(s) = max(s − 0.98, 0) keeps a margin below every limit, and the
last term, too small to be seen in the load, picks the gentlest of equally good motions. Every row acts on six
neighbouring coefficients of the axes, so the normal equations are banded and a minute's record takes seconds.
"""

from __future__ import annotations

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float
from numpy.typing import NDArray

from gbeam.motion.blocks import in_blocks
from gbeam.motion.inverse import Flat, Geometry, Inverse, Pose, QuasiStatic
from gbeam.motion.kinematics import Axes, forward
from gbeam.motion.limits import Limits
from gbeam.motion.profile import Profile
from gbeam.motion.record import STANDARD_GRAVITY
from gbeam.motion.spline import PIECE, Grid, Normal, Spline
from gbeam.motion.target import Target

HELD = 0.01  # weight of the tracking error while the target is held, where it is 1 otherwise
MARGIN = 0.98  # of a limit: where the penalty sets in
_EASE = 1e-5, 1e-7  # weights of 1 rad/s² and of 1 rad/s³ beside a tracking error of 1 g0
_PENALTIES = 0.1, 1.0, 10.0, 100.0  # sqrt(μ), one after the other until the limits are kept
_ROUNDS = 11  # at most
_COARSEST, _FINEST, _PER_WIDTH = 0.02, 0.005, 6  # s between knots; knots per width of the target's smoothing
_STEPS, _ENOUGH = 60, 1e-4  # steps at most per penalty; relative gain of a step that ends them
_POINTS = np.array([1, 3, 5]) / 6  # of each piece
_DENSE = np.arange(16) / 16  # where limits are checked
_ORDERS = 4  # value, rate and so on

Floats = NDArray[np.float64]


class Planned(Inverse):
    """ω1, θ2 and θ3 as splines, found in advance for one target."""

    axes: Spline

    def __call__(self, target: Profile, t: Float[Array, "*t"]) -> Pose:
        """Rate of axis 1 (rad/s) and angles of axes 2 and 3 (rad) at times `t` (s)."""
        at = self.axes(t)
        return at[..., 0], at[..., 1], at[..., 2]


class _Problem(eqx.Module):
    """What the residuals know of the machine."""

    geometry: Geometry
    limits: Limits
    penalty: Float[Array, ""]


def planned(target: Target, geometry: Geometry, limits: Limits) -> Planned:
    """Plan the axes, starting from those of the flat inverse."""
    first, last = (float(end) for end in target.span)
    step = float(np.clip(2 * float(target.reach) / _PER_WIDTH, _FINEST, _COARSEST))
    grid = Grid(first, last, step, _POINTS)
    starts = Flat(geometry), QuasiStatic(geometry)
    poses, wanted, held = in_blocks(_start, (target, starts), grid.time)
    weight = np.sqrt(np.where(held, HELD, 1.0))
    basis = np.stack([grid.weights(order) for order in range(_ORDERS)], axis=1)  # (times, orders, 6)
    dense = Grid(first, last, step, _DENSE)
    dense_basis = np.stack([dense.weights(order) for order in range(_ORDERS)], axis=1)
    # Without limits first, and of several starts the best: far from what the arm can do, flat's is a poor one.
    free = _Problem(geometry, limits, jnp.asarray(0.0))
    tried = [
        _minimise(free, grid, basis, grid.fit(np.column_stack([rate, *np.unwrap(angles)])), wanted, weight)
        for rate, *angles in poses
    ]
    c, _ = min(tried, key=lambda each: each[1])
    kept, penalties = limits, iter(_PENALTIES)
    penalty = 0.0
    for _ in range(_ROUNDS):
        shares = in_blocks(_shares, limits, _states(dense, dense_basis, c)).max(axis=0)
        if shares.max() <= 1.0:
            break
        if penalty == _PENALTIES[-1] or (penalty and in_blocks(_shares, kept, _states(grid, basis, c)).max() <= 1.0):
            # What is above a limit lies between the points: aim lower by as much.
            lower = np.where(shares > 1.0, 1.01 * shares, 1.0)
            factors = (kept.axes / lower[:9].reshape(3, 3), kept.power / lower[9])
            kept = eqx.tree_at(lambda it: (it.axes, it.power), kept, factors)
        else:
            penalty = next(penalties, penalty)
        problem = _Problem(geometry, kept, jnp.asarray(penalty))
        c, _ = _minimise(problem, grid, basis, c, wanted, weight)
    return Planned(grid.spline(c))


@eqx.filter_jit
def _start(it: tuple[Target, tuple[Inverse, ...]], t: Array) -> tuple[list[Pose], Array, Array]:
    target, starts = it
    return [inverse(target.load, t) for inverse in starts], target.load(t), target.held(t)


def _states(grid: Grid, basis: Floats, c: Floats) -> Floats:
    """Axes and their rates, (times, orders, 3)."""
    return np.asarray(np.einsum("toi,tia->toa", basis, c[grid.first[:, None] + np.arange(PIECE)], optimize=True))


def _minimise(
    problem: _Problem, grid: Grid, basis: Floats, c: Floats, wanted: Floats, weight: Floats
) -> tuple[Floats, float]:
    """Levenberg and Marquardt's method with banded normal equations: coefficients and cost."""
    damping, columns = 1e-8, (wanted, weight)
    states = _states(grid, basis, c)
    cost = float(np.sum(in_blocks(_residuals, problem, states, *columns) ** 2))
    for _ in range(_STEPS):
        residual, slopes = in_blocks(_linearised, problem, states, *columns)
        # A state of order k is a sum over six coefficients: so is the row of each residual.
        rows = np.einsum("tmoa,toi->tmia", slopes, basis, optimize=True).reshape(*residual.shape, 3 * PIECE)
        normal = Normal(grid.size, 3)
        normal.add(grid.first, rows, -residual)
        gained = 0.0
        for _ in range(8):
            move = normal.solve(damping).reshape(-1, 3)
            new = _states(grid, basis, c + move)
            better = float(np.sum(in_blocks(_residuals, problem, new, *columns) ** 2))
            if better < cost:
                gained, c, states, cost = (cost - better) / cost, c + move, new, better
                damping = max(damping / 10, 1e-13)
                break
            damping *= 10
        if gained < _ENOUGH:
            break
    return c, cost


def _axes(state: Float[Array, "o 3"]) -> Axes:
    (w1, th2, th3), (al1, w2, w3), (_, al2, al3) = state[0], state[1], state[2]
    return Axes(w1, al1, th2, w2, al2, th3, w3, al3)


def _machine(state: Float[Array, "o 3"]) -> Float[Array, "3 3"]:
    """Rate, acceleration and jerk (rows) of the three axes; the spline of axis 1 is that of its rate."""
    return jnp.stack([jnp.concatenate([state[k, :1], state[k + 1, 1:]]) for k in range(3)])


def _share(limits: Limits, state: Float[Array, "o 3"]) -> Float[Array, " 10"]:
    """Shares of all limits that are used, with their signs."""
    moving = _machine(state)
    power = limits.inertia * moving[0, 0] * moving[1, 0] / limits.power
    return jnp.append((moving / limits.axes).ravel(), power)


def _one(problem: _Problem, state: Float[Array, "o 3"], wanted: Array, weight: Array) -> Float[Array, " m"]:
    load = forward(_axes(state), problem.geometry.arm, problem.geometry.gravity).a_WO_B
    over = jnp.maximum(jnp.abs(_share(problem.limits, state)) - MARGIN, 0.0)
    ease = _machine(state)[1:] * jnp.array(_EASE)[:, None]
    return jnp.concatenate([weight * (load - wanted) / STANDARD_GRAVITY, problem.penalty * over, ease.ravel()])


_each = jax.vmap(_one, (None, 0, 0, 0))
_residuals = eqx.filter_jit(_each)
_linearised = eqx.filter_jit(lambda *it: (_each(*it), jax.vmap(jax.jacfwd(_one, 1), (None, 0, 0, 0))(*it)))
_shares = eqx.filter_jit(lambda limits, state: jnp.abs(jax.vmap(_share, (None, 0))(limits, state)))
