"""The centrifuge as a motion: the root, the axes over time, the F-16 record, refusals."""

from pathlib import Path

import equinox as eqx
import numpy as np
import pytest

from gbeam.errors import InputError
from gbeam.motion import (
    STANDARD_GRAVITY,
    Centrifuge,
    Target,
    axis_history,
    build_target,
    constant,
    moved,
    read_record,
    stack,
    trapezoid,
)

G, R, XC = STANDARD_GRAVITY, 3.3, 0.15
F16 = Path(__file__).parents[2] / "examples" / "data" / "f16_8g_turn.csv"
TRAPEZOID = stack(z=trapezoid(10 * G, 4 * G, 1.0, 4.0))


def target(smoothing: float | None = 0.06, gravity: bool = True) -> Target:
    return build_target(TRAPEZOID, span=(0.0, 12.0), idle=1.4 * G, smoothing=smoothing, gravity=gravity)


@pytest.fixture(scope="module")
def f16() -> Centrifuge:
    record = read_record(F16, "time_s", "n_x_g", "-n_y_g", "-n_z_g", "g")
    made = build_target(record, span=(0.0, 15.99), idle=1.4 * G, smoothing=0.06, gravity=True)
    return Centrifuge(made, R, XC, "flat", gravity=True)


def test_root_has_the_control_points_motion_moved() -> None:
    machine = Centrifuge(target(), R, XC, "flat", gravity=True)
    t = np.linspace(0, 12, 61)
    root, here = eqx.filter_jit(lambda m, s: (m.base(s), m.actual(s)))(machine, t)
    back = moved(root, [XC, 0.0, 0.0])
    np.testing.assert_allclose(back.a_WO_B, here, atol=1e-11)
    scalar = eqx.filter_jit(lambda m, s: m.base(s))(machine, 3.0)
    np.testing.assert_allclose(scalar.a_WO_B, root.a_WO_B[15], atol=1e-12)


def test_steady_load_at_the_root_is_less_the_centrifugal_one() -> None:
    still = build_target(stack(z=constant(6 * G)), span=(0.0, 1.0), idle=None, smoothing=None, gravity=False)
    base = Centrifuge(still, R, XC, "flat", gravity=False).base(0.5)
    # C is at rest in the turning axes, the root XC nearer the tip of r = (−XC, 0, 0): a_O = a_C + XC Ω² e1
    np.testing.assert_allclose(base.a_WO_B, [XC * 6 * G / R, 0, 6 * G], atol=1e-12)


def test_f16_record_on_a_short_arm(f16: Centrifuge) -> None:
    t = np.linspace(0, 15.99, 4001)
    base, error, held = eqx.filter_jit(lambda m, s: (m.base(s), m.tracking_error(s), m.not_followed(s)))(f16, t)
    for part in (base.a_WO_B, base.w_WB_B, base.alpha_WB_B):
        assert np.isfinite(part).all()
    wanted = np.asarray(f16.reference(t))
    assert np.hypot(wanted[:, 1], wanted[:, 2]).min() > 1.01 * G
    # The 8 g turn. Near idle the aileron's steps change the load faster than so slow an arm can follow.
    turn = (t > 3.2) & (t < 11.2)
    assert not np.asarray(held)[turn].any()
    relative = np.linalg.norm(np.asarray(error), axis=1) / np.linalg.norm(wanted, axis=1)
    assert relative[turn].max() < 0.3 and np.sqrt(np.mean(relative[(t > 4.5) & (t < 10)] ** 2)) < 1e-3
    reasons = {episode.reason for episode in f16.episodes()}
    assert reasons == {"below idle", "out of reach of the gimbals"}
    assert all(0 <= e.start < e.end <= 15.99 for e in f16.episodes())


def test_axis_history_integrates_and_unwraps(f16: Centrifuge) -> None:
    t = np.linspace(0, 15.99, 20001)
    history = axis_history(eqx.filter_jit(lambda m, s: m.axes(s))(f16, t), t)
    for angle, rate in ((history.angle1, history.axes.rate1), (history.axes.angle3, history.axes.rate3)):
        assert np.abs(np.diff(angle)).max() < np.pi
        np.testing.assert_allclose(np.gradient(angle, t)[1:-1], rate[1:-1], atol=0.02 * np.abs(rate).max())
    assert history.angle1[0] == 0


def test_like_scenarios_share_one_compiled_function() -> None:
    traces = []

    @eqx.filter_jit
    def base(machine: Centrifuge, t: np.ndarray) -> object:
        traces.append(1)
        return machine.base(t)

    t = np.linspace(0, 12, 11)
    for arm, sign, level in ((3.3, 1, 10.0), (5.0, -1, 10.0), (5.0, 1, 9.9)):
        raw = stack(z=trapezoid(level * G, level * 0.4 * G, 1.0, 4.0))
        made = build_target(raw, span=(0.0, 12.0), idle=0.14 * level * G, smoothing=0.06, gravity=True)
        base(Centrifuge(made, arm, XC, "flat", True, sign), t)
    assert len(traces) == 1


def test_sharp_corners_only_for_quasi_static_and_a_load_that_does_not_turn() -> None:
    sharp = Centrifuge(target(smoothing=None, gravity=False), R, XC, "quasi-static", gravity=False)
    assert np.isfinite(sharp.base(np.linspace(0, 12, 61)).alpha_WB_B).all() and sharp.breaks.size
    for inverse, gravity in (("flat", False), ("quasi-static", True)):
        with pytest.raises(InputError, match="60 ms") as caught:
            Centrifuge(target(smoothing=None, gravity=gravity), R, XC, inverse, gravity)
        assert caught.value.where == "smoothing"


@pytest.mark.parametrize(
    ("change", "where", "words"),
    [
        ({"inverse": "quasistatic"}, "inverse", "did you mean 'quasi-static'"),
        ({"inverse": "newton"}, "inverse", "choose one of quasi-static, flat"),
        ({"arm": 0.0}, "arm", "positive"),
        ({"control_point": -0.1}, "control_point", "non-negative"),
        ({"sign": 0}, "sign", "1 or -1"),
        ({"gravity": False}, "gravity", "both"),
    ],
)
def test_refusals(change: dict[str, object], where: str, words: str) -> None:
    arguments = {"arm": R, "control_point": XC, "inverse": "flat", "gravity": True, "sign": 1, **change}
    with pytest.raises(InputError, match=words) as caught:
        Centrifuge(target(), **arguments)  # type: ignore[arg-type]
    assert caught.value.where == where
