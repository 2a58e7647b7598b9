"""Motions on NumPy and on JAX alike: derivatives in time, gradients with respect to what a motion is made of, maps."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.constants import g as STANDARD_GRAVITY  # fmt: skip

import gbeam as gb
from gbeam.motion import Profile, clamped

G = STANDARD_GRAVITY
F16 = Path(__file__).parents[2] / "examples" / "data" / "f16_8g_turn.csv"
T = np.linspace(0.03, 3.97, 23)
FEW = np.array([0.61, 1.4, 2.7])
RAMP, STEP, SINE = (
    gb.trapezoid(3.0, jerk=2.0, start=0.5, hold=0.4),
    gb.SmoothStep(2.0, 1.5, 0.4),
    gb.Sine(1.0, 2.5, 0.2),
)

PROFILES: dict[str, Profile] = {
    "smooth step": STEP,
    "sum clamped, then smoothed": gb.smoothed(clamped(gb.Sum((STEP, RAMP)), 0.9, 1.7), 0.3),
    "vector": gb.smoothed(gb.vector(x=1.0, y=SINE, z=RAMP), 0.2),
}


@pytest.mark.parametrize("name", PROFILES)
def test_closed_derivatives_are_those_of_forward_differentiation(name: str) -> None:
    def rate(function: Callable[[Any], Any]) -> Callable[[Any], Any]:
        return lambda t: jax.jvp(function, (t,), (jnp.ones_like(t),))[1]

    profile = PROFILES[name]
    first = rate(profile)
    second = rate(first)
    values = jax.jit(lambda t: (profile(t), first(t), second(t), rate(second)(t)))(jnp.asarray(T))
    for closed, traced in zip(profile.derivatives(T, 3), values, strict=True):
        np.testing.assert_allclose(closed, traced, rtol=1e-11, atol=1e-11 * (1 + np.abs(closed).max()))


def centrifuge(level: Any, arm: Any = 3.3, control_point: Any = 0.2, **options: Any) -> gb.Centrifuge:
    flight = gb.Flight(z=gb.Sum((gb.tabulated([0.0], [5 * G]), gb.trapezoid(level, jerk=2 * G, start=0.5, hold=1.0))))
    arguments = {"inverse": "flat", "gravity": False, "smoothing": 0.06, **options}
    return gb.Centrifuge(flight, arm=arm, control_point=control_point, span=(0.0, 4.0), **arguments)


MADE_OF: dict[str, tuple[Callable[[Any], Any], float]] = {
    "a flight's level": (lambda x: gb.Flight(z=gb.smoothed(gb.trapezoid(x, jerk=3.0, hold=1.0), 0.2)), 4.0),
    "a table's value": (lambda x: gb.Flight(x=gb.tabulated([0.0, 4.0], jnp.stack([x, 2 * x]))), 4.0),
    "a hub's radius": (lambda x: gb.Hub(radius=x, rate=STEP), 0.5),
    "a hub's final rate": (lambda x: gb.Hub(radius=0.5, rate=gb.SmoothStep(x, 2.0), gravity=(0.0, -9.8, 0.0)), 2.0),
    "a setting angle": (lambda x: gb.Hub(radius=0.5, rate=STEP, setting_angle=x), 0.4),
    "a centrifuge's arm": (lambda x: centrifuge(3 * G, arm=x), 3.3),
    "a control point": (lambda x: centrifuge(3 * G, control_point=x, gravity=True), 0.2),
    "the load that is tracked": (lambda x: centrifuge(x, gravity=True), 3 * G),
}


def size(motion: Any) -> Any:
    base = motion.base(FEW)
    return sum((part**2).sum() for part in (base.a_WO_B, base.w_WB_B, base.alpha_WB_B))


@pytest.mark.parametrize("name", MADE_OF)
def test_derivatives_of_the_motion_of_the_base_with_respect_to_what_it_is_made_of(name: str) -> None:
    make, at = MADE_OF[name]
    h = 1e-5 * at
    finite = (float(size(make(at + h))) - float(size(make(at - h)))) / (2 * h)
    exact = jax.jit(lambda x: jax.jvp(lambda x: size(make(x)), (x,), (1.0,))[1])(at)
    assert float(exact) == pytest.approx(finite, rel=1e-6, abs=1e-6)


def test_gradient_with_respect_to_the_values_of_a_profile() -> None:
    values = np.array([1.0, 3.0, 2.0])

    def load(values: Any) -> Any:
        return (gb.smoothed(gb.tabulated([0.0, 1.0, 2.5], values), 0.4)(FEW) ** 2).sum()

    finite = [(load(values + step) - load(values - step)) / 2e-6 for step in 1e-6 * np.eye(3)]
    np.testing.assert_allclose(jax.jit(jax.grad(load))(values), finite, rtol=1e-6, atol=1e-8)


def test_what_is_solved_for_numerically_says_so() -> None:
    with pytest.raises(gb.InputError, match="JAX traces the machine"):
        jax.grad(lambda arm: centrifuge(3 * G, arm=arm, inverse="planned").base(T).a_WO_B.sum())(3.3)
    # A machine of numbers, prepared, is a pytree: derivatives with respect to what it is made of go through.
    machine = centrifuge(3 * G, inverse="exact", idle=2 * G)
    other = machine.altered(control_point=0.21)
    step = jax.tree.map(jnp.subtract, other, machine)
    slope = jax.jit(lambda *along: jax.jvp(lambda moved: moved.base(FEW).a_WO_B, *along)[1])((machine,), (step,))
    np.testing.assert_allclose(slope, other.base(FEW).a_WO_B - machine.base(FEW).a_WO_B, atol=1e-9)


def test_maps_over_values_and_over_times() -> None:
    arms = np.array([2.0, 3.3, 7.0])
    mapped = jax.jit(jax.vmap(lambda arm: centrifuge(3 * G, arm=arm).base(FEW).alpha_WB_B))(arms)
    one_by_one = np.stack([centrifuge(3 * G, arm=arm).base(FEW).alpha_WB_B for arm in arms])
    np.testing.assert_allclose(mapped, one_by_one, atol=1e-9)
    machine = centrifuge(3 * G, gravity=True)
    times = jax.jit(jax.vmap(lambda t: machine.base(t).a_WO_B))(FEW)
    np.testing.assert_allclose(times, machine.base(FEW).a_WO_B, atol=1e-10)


def test_numpy_in_numpy_out() -> None:
    for motion in (gb.Flight(z=RAMP), gb.Hub(radius=0.5, rate=STEP, gravity=(0.0, 0.0, -9.8)), centrifuge(3 * G)):
        base = motion.base(T)
        assert all(type(part) is np.ndarray for part in (base.a_WO_B, base.w_WB_B, base.alpha_WB_B))


def test_no_motion_imports_jax() -> None:
    program = f"""
import sys
from gbeam import Centrifuge, Flight, Hub, SmoothStep, machines, read_record
from gbeam.motion import INVERSES
record = read_record({str(F16)!r}, "time_s", "n_x_g", "-n_y_g", "-n_z_g", "g")
for inverse in INVERSES:
    machine = Centrifuge(Flight(acceleration=record), control_point=0.2, limits=machines["specimen-3.3m"], gravity=True,
                         inverse=inverse, smoothing=0.3, span=(0.0, 5.0))
    machine.base([1.0, 2.0]), machine.usage(), machine.shortfalls()
Hub(radius=0.5, rate=SmoothStep(3.0, 2.0), gravity=(0, 0, -9.8)).base(1.0)
assert "jax" not in sys.modules
"""
    subprocess.run([sys.executable, "-c", program], check=True, timeout=120)
