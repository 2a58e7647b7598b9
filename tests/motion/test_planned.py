"""The planned inverse: least tracking error within the limits; the F-16 record; splines."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from gbeam.motion import (
    STANDARD_GRAVITY,
    AxisLimit,
    Centrifuge,
    Flight,
    Limits,
    MachineLimits,
    read_record,
    trapezoid,
)  # fmt: skip
from gbeam.motion.centrifuge.inverses.closed_form import Geometry
from gbeam.motion.centrifuge.inverses.planned import Tracking
from gbeam.numerics.bspline import Grid

G, R = STANDARD_GRAVITY, 3.3
F16 = Path(__file__).parents[2] / "examples" / "data" / "f16_8g_turn.csv"
TIGHT = MachineLimits(AxisLimit(10, 20, 40), AxisLimit(20, 60, 3e3), AxisLimit(10, 30, 1e3), inertia=2e3, power=1e5)
Spin = Callable[..., Centrifuge]


@pytest.fixture(scope="module")
def spin() -> Spin:
    flight = Flight(acceleration=read_record(F16, "time_s", "n_x_g", "-n_y_g", "-n_z_g", "g"))

    def make(inverse: str, limits: MachineLimits | None = None, mounting: str = "upright") -> Centrifuge:
        return Centrifuge(
            flight, arm=R, control_point=0.15, inverse=inverse, limits=limits, gravity=True, idle=1.4 * G,
            mounting=mounting, span=(0.0, 15.99),
        )  # fmt: skip

    return make


def tracked(machine: Centrifuge) -> np.ndarray:
    """Size of the tracking error, m/s², while the target is the flight's load."""
    t = np.linspace(0, 15.99, 16001)
    error, held = machine.tracking_error(t), machine.not_followed(t)
    return np.linalg.norm(error, axis=1)[~held]


@pytest.mark.parametrize("mounting", ["upright", "inverted"])
def test_the_f16_record_is_followed_ten_times_better_than_flat_with_gentler_axes(spin: Spin, mounting: str) -> None:
    flat, best = (spin(inverse, mounting=mounting) for inverse in ("flat", "planned"))
    assert tracked(flat).max() > 4 and tracked(best).max() < 0.02
    use = {(each.axis, each.quantity): each.used for each in flat.usage()}
    planned = {(each.axis, each.quantity): each.used for each in best.usage()}
    assert planned["axis 2", "acceleration"] < use["axis 2", "acceleration"] / 5


def test_limits_are_kept_where_flat_breaks_them(spin: Spin) -> None:
    flat, best = (spin(inverse, TIGHT) for inverse in ("flat", "planned"))
    assert any(use.exceeded for use in flat.usage()) and not any(use.exceeded for use in best.usage())
    assert len(best.usage()) == 10 and max(use.share for use in best.usage()) > 0.99
    assert tracked(best).max() < 0.2


def test_limits_just_above_what_the_free_plan_uses_cost_nothing(spin: Spin) -> None:
    free = spin("planned")
    used = {(each.axis, each.quantity): each.used for each in free.usage()}

    def times(arm: float, gimbals: float) -> MachineLimits:
        quantities = ("rate", "acceleration", "jerk")
        factors = ("axis 1", arm), ("axis 2", gimbals), ("axis 3", gimbals)
        return MachineLimits(*(AxisLimit(*(by * used[axis, each] for each in quantities)) for axis, by in factors))

    limits = times(1.02, 1.02), times(1.0, 1.0), times(1.02, 0.8)
    near, at, below = (spin("planned", each) for each in limits)
    assert tracked(near).max() < 1.001 * tracked(free).max()
    assert tracked(at).max() < 1.2 * tracked(free).max()
    assert tracked(free).max() < tracked(below).max() < 0.2
    assert not any(use.exceeded for each in (near, at, below) for use in each.usage())


def test_limits_that_leave_nothing_of_the_load_are_kept_all_the_same(spin: Spin) -> None:
    nearly_still = MachineLimits(AxisLimit(0.5, 0.01), AxisLimit(acceleration=0.1), AxisLimit(rate=0.01))
    machine = spin("planned", nearly_still)
    assert not any(use.exceeded for use in machine.usage())
    assert 8 * G - R * 0.5**2 - G < tracked(machine).max() < 9 * G


def test_what_no_machine_of_this_speed_can_do_is_left_out_but_the_limit_is_kept() -> None:
    flight = Flight(z=trapezoid(8 * G, jerk=8 * G, start=1.0, hold=2.0))
    # 8 g needs 4.88 rad/s; with a strong arm and a quick gimbal it would swing to and fro to make up for that.
    slow = MachineLimits(AxisLimit(4.5, 6.0, 200.0), AxisLimit(acceleration=100.0))
    machine = Centrifuge(
        flight, arm=R, control_point=0.15, inverse="planned", limits=slow, idle=2 * G, smoothing=0.1, span=(0.0, 5.0)
    )
    assert max(use.share for use in machine.usage()) <= 1
    # In the middle of the plateau nothing helps; at its ends the arm's tangential acceleration does.
    assert 8 * G - R * 4.5**2 <= float(np.linalg.norm(machine.tracking_error(3.0))) < 1.3 * (8 * G - R * 4.5**2)


def test_a_hull_holds_the_derivative_and_is_near_it() -> None:
    grid = Grid(0.0, 2.0, 0.1, np.linspace(0, 1, 50))
    c = np.random.default_rng(1).normal(size=(grid.size, 2))
    near = grid.windows(c).reshape(grid.pieces, 6, 2)
    for order in range(4):
        values = (near.swapaxes(1, 2)[:, None] @ grid.weights(order)[:50, :, None])[..., 0]
        gap = []
        for parts in (1, 2, 4):
            hull = np.einsum("mi,kia->kma", grid.hull(order, parts), near)
            assert (hull.min(axis=1) <= values.min(axis=1) + 1e-9).all()
            assert (hull.max(axis=1) >= values.max(axis=1) - 1e-9).all()
            gap.append(np.mean(hull.max(axis=1) - values.max(axis=1)))
        assert gap[0] > 2 * gap[1] > 4 * gap[2] > 0


def test_spline_reproduces_quintics_and_their_derivatives() -> None:
    grid = Grid(1.0, 3.0, 0.11, np.array([0.1, 0.5, 0.8]))
    polynomial = np.polynomial.Polynomial([1, -2, 0.5, 3, -1, 0.2])
    c = grid.fit(polynomial(grid.time)[:, None])
    for order in range(4):
        values = np.sum(grid.weights(order) * c[grid.first[:, None] + np.arange(6), 0], axis=1)
        np.testing.assert_allclose(
            values, (polynomial.deriv(order) if order else polynomial)(grid.time), rtol=10.0 ** (order - 7)
        )
    t = np.array([1.0, 1.7, 3.0])
    np.testing.assert_allclose(grid.spline(c)(t)[:, 0], polynomial(t), rtol=1e-8)


def test_the_derivatives_of_the_tracking_error_are_those_of_its_differences() -> None:
    rng = np.random.default_rng(3)
    grid = Grid(0.0, 1.0, 0.2, np.array([1, 3, 5]) / 6)
    count = grid.time.size
    cost = Tracking(grid, Geometry(R, G, -1.0), Limits(), rng.normal(size=(count, 3)), rng.uniform(0.1, 1, count))
    state = rng.normal(size=(count, 4))
    slope = cost.derivatives(state)
    for k, step in enumerate(1e-6 * np.eye(4)):
        finite = (cost.residual(state + step) - cost.residual(state - step)) / 2e-6
        np.testing.assert_allclose(slope[:, :, k], finite, atol=1e-8)
