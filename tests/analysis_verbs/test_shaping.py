"""Shaped commands do what they must, and leave less than a ZVD shaper and a smooth step, on a model that turns far."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import gbeam as gb

from ..specimens import BOX, HUB_INERTIA, HUB_RADIUS, LENGTH, METAL

MODEL = gb.assemble(gb.Beam(LENGTH, BOX, METAL, [gb.PointMass(LENGTH, 0.1)], damping_ratio=0.005), "FOAM", y=2)
PRESCRIBED, FREE = gb.Hub(radius=HUB_RADIUS), gb.Hub(radius=HUB_RADIUS, inertia=HUB_INERTIA)


def test_a_rate_turns_by_the_angle_and_leaves_a_hundredth_of_a_zvd_shaper() -> None:
    command = gb.shape_command(MODEL, PRESCRIBED, angle=1.0, duration=6.0)
    profile = gb.SplineProfile(command.duration, command.coefficients)
    assert gb.Hub(radius=HUB_RADIUS, rate=profile).angle(8.0) == pytest.approx(1.0, abs=1e-9)
    assert profile(6.0) == pytest.approx(0, abs=1e-12) and profile(7.0) == pytest.approx(0, abs=1e-12)
    shaped, zvd, smooth = command.runs
    assert (shaped.name, zvd.name, smooth.name) == ("shaped", "ZVD", "smooth-step")
    assert shaped.residual < 0.1 * zvd.residual < 0.01 * smooth.residual
    # What the modes leave is what a run of the linear model leaves: of a small angle FOAM is one.
    small = gb.shape_command(MODEL, PRESCRIBED, angle=1e-4, duration=6.0)
    for run in small.runs[1:]:
        assert run.residual == pytest.approx(run.by_ratio[command.ratio == 1][0], rel=0.1)
    assert {each.outcome for each in command.runs} == {"done"} and command.kind == "rate"


def test_a_rate_is_reached() -> None:
    shaped = gb.shape_command(MODEL, PRESCRIBED, rate=3.0, duration=10.0)
    assert gb.SplineProfile(10.0, shaped.coefficients)(np.array([0.0, 10.0, 12.0])) == pytest.approx(
        [0, 3, 3], abs=1e-9
    )
    assert shaped.residual < 1e-3 * shaped.runs[2].residual


def test_a_torque_within_a_limit_turns_a_free_hub_from_rest_to_rest() -> None:
    shaped = gb.shape_command(MODEL, FREE, angle=1.0, duration=6.0, limit=45.0)
    assert np.abs(shaped.runs[0].command).max() < 45.0 * 1.001 < shaped.runs[1].largest
    torque = gb.SplineProfile(shaped.duration, shaped.coefficients)
    hub = gb.Hub(radius=HUB_RADIUS, inertia=HUB_INERTIA, torque=torque)
    run = gb.simulate(MODEL, hub, duration=8.0, integrator="gauss", estimate=False)
    assert run.hub is not None
    assert run.hub.angle[-1] == pytest.approx(1.0, abs=1e-2) and abs(run.hub.rate[-1]) < 1e-3
    assert shaped.residual < 0.1 * shaped.runs[1].residual and shaped.kind == "torque"
    with pytest.raises(gb.ComputationError, match="no command of torque 20 or less does it in 6 s"):
        gb.shape_command(MODEL, FREE, angle=1.0, duration=6.0, limit=20.0)


def test_a_robust_command_leaves_least_over_the_span() -> None:
    plain, robust = (gb.shape_command(MODEL, PRESCRIBED, angle=1.0, duration=9.0, robust=r) for r in (0.0, 0.2))
    inside = np.abs(robust.ratio - 1) <= 0.2 + 1e-9

    def left(run: object) -> float:
        return float(np.sqrt(np.mean(np.asarray(run.by_ratio)[inside] ** 2)))  # type: ignore[attr-defined]

    assert left(robust.runs[0]) < 0.5 * min(left(robust.runs[1]), left(plain.runs[0]))


def test_a_beam_that_the_hub_does_not_bend_is_refused() -> None:
    across = gb.assemble(gb.Beam(LENGTH, BOX, METAL, damping_ratio=0.005), "FOAM", z=2)
    with pytest.raises(gb.InputError, match="no vibration that the drive excites"):
        gb.shape_command(across, PRESCRIBED, angle=1.0, duration=6.0)


def test_its_results_are_drawn_and_saved() -> None:
    shaped = gb.shape_command(MODEL, PRESCRIBED, angle=0.1, duration=6.0)
    assert len(shaped.plot()) == 2 and len(shaped.plot("robustness")) == 1
    ds = shaped.to_xarray()
    assert ds["residual"].sel(run="ZVD").item() == shaped.runs[1].residual and "Shaped rate by 0.1 rad" in repr(shaped)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"duration": 6.0}, "both given or both missing"),
        ({"angle": 1.0, "rate": 1.0, "duration": 6.0}, "both given or both missing"),
        ({"angle": 0.0, "duration": 6.0}, "angle is 0"),
        ({"angle": 1.0, "duration": -1.0}, "duration is -1 s"),
        ({"angle": 1.0, "duration": 6.0, "pieces": 5}, "pieces is 5"),
        ({"angle": 1.0, "duration": 6.0, "robust": 1.5}, "robust is 1.5"),
        ({"angle": 1.0, "duration": 6.0, "limit": 0.0}, "limit is 0"),
    ],
)
def test_what_is_no_command_is_refused(options: dict[str, float], words: str) -> None:
    with pytest.raises(gb.InputError, match=words):
        gb.shape_command(MODEL, PRESCRIBED, **options)  # type: ignore[arg-type]
    with pytest.raises(gb.InputError, match="the hub turns already"):
        gb.shape_command(MODEL, gb.Hub(radius=0.5, rate=1.0), angle=1.0, duration=6.0)


PANEL = gb.assemble(
    gb.Beam(3.0, gb.Section.rectangle(0.5, 0.02), gb.Material(100, 1e9), damping_ratio=0.005), "FOAM", z=2
)


def on_axis(**axis: object) -> gb.System:
    """The panel on a wheel that turns: a system that is a beam on a hub."""
    rim = gb.Place((0.5, 0, 0), (np.pi / 2, 0, 0))
    return gb.System(
        {"wheel": gb.RigidBody(1.0, (50.0, 50.0, 50.0), points={"rim": rim}), "panel": PANEL},
        {
            "axis": gb.Joint("revolute", "wheel", axes=[(0, 0, 1)], **axis),  # type: ignore[arg-type]
            "clamp": gb.Joint("fixed", "panel", "wheel.rim"),
        },
    )


@pytest.mark.parametrize("free", [True, False])
def test_a_joint_of_a_system_is_driven_as_a_hub(free: bool) -> None:
    """The commands are those of the beam on the hub, designed and, but for steps fitted to its modes, refined."""
    hub = gb.Hub(radius=0.5, setting_angle=np.pi / 2, **({"inertia": 50.0} if free else {}))  # type: ignore[arg-type]
    system = on_axis(effort=0.0) if free else on_axis(rate=0.0)
    for robust, close in ((0.1, 1e-6 if free else 1e-10), (0.0, 1e-6)):
        options = {"angle": 0.5, "duration": 6.0, "robust": robust}
        one = gb.shape_command(PANEL, hub, **options)  # type: ignore[arg-type]
        other = gb.shape_command(system, "axis.angle", **options)  # type: ignore[arg-type]
        np.testing.assert_allclose(other.coefficients, one.coefficients, atol=close * np.abs(one.coefficients).max())
        np.testing.assert_allclose(other.frequency, one.frequency, rtol=1e-10)
        assert other.kind == one.kind == ("torque" if free else "rate")
        for a, b in zip(one.runs[1:], other.runs[1:], strict=True):
            assert b.residual == pytest.approx(a.residual, rel=0.02)
        assert other.residual < 0.3 * other.runs[1].residual


def crane(begin: float = 0.0, **rail: object) -> gb.System:
    """A trolley of 100 kg with a load of 50 kg on a rope of 2 m."""
    load = gb.RigidBody(50.0, (1.0, 1.0, 1.0), centre=(0, 0, -2), points={"hook": (0, 0, -2)})
    joints = {"rail": gb.Joint("prismatic", "trolley", axes=[(1, 0, 0)], **rail)}  # type: ignore[arg-type]
    joints["rope"] = gb.Joint("revolute", "load", "trolley.root", axes=[(0, 1, 0)], initial=begin)
    return gb.System({"trolley": gb.RigidBody(100.0, (1.0, 1.0, 1.0)), "load": load}, joints, gravity=(0, 0, -9.81))


def test_a_crane_moves_its_load_by_the_equation_of_its_pendulum() -> None:
    """No beam at all: J θ'' = −m l (g sin θ + x'' cos θ) under the speed that was found, by SciPy's integrator."""
    # Whatever its own rate is.
    slewed = crane(rate=gb.SmoothStep(0.5, 8.0))
    said = list[tuple[str, float]]()
    shaped = gb.shape_command(
        slewed,
        "rail.displacement",
        distance=5.0,
        duration=8.0,
        point="load.hook",
        progress=lambda *news: said.append(news),
    )
    rounds = [share for words, share in said if words == "system: refining, round 1 of at most 4"]
    assert len(rounds) > 3 and rounds == sorted(rounds) and 0.3 < rounds[-1] <= 1
    assert {words.partition(", ")[0] for words, _ in said[-6:]} <= {"system: ZVD", "system: smooth-step"}
    profile, inertia = gb.SplineProfile(shaped.duration, shaped.coefficients), 50.0 * 2.0**2 + 1.0
    assert shaped.frequency[0] == pytest.approx(np.sqrt(50.0 * 2.0 * 9.81 / inertia) / 2 / np.pi, rel=1e-9)

    def pendulum(t: float, y: np.ndarray) -> list[float]:
        pull = float(profile.derivatives(t)[1])
        return [y[1], -50.0 * 2.0 / inertia * (9.81 * np.sin(y[0]) + pull * np.cos(y[0])), float(profile(t))]

    end = float(shaped.runs[0].time[-1])
    swung = solve_ivp(pendulum, (0.0, end), [0.0, 0.0, 0.0], rtol=1e-10, atol=1e-12, max_step=0.05)
    after = swung.t >= 8.0
    assert swung.y[2, -1] == pytest.approx(5.0, rel=1e-6) and np.abs(swung.y[0]).max() > 0.05
    assert np.ptp(2.0 * swung.y[0, after]) / 2 < 2e-5 and shaped.residual < 2e-5 < 1e-3 * shaped.runs[2].residual
    assert (shaped.kind, shaped.unit, shaped.aim) == ("speed", "m/s", {"distance": 5.0})


def test_a_force_moves_it_too_and_an_inertia_that_changes_is_said() -> None:
    shaped = gb.shape_command(crane(effort=0.0), "rail.displacement", distance=5.0, duration=8.0, point="load.hook")
    heavier = np.sqrt(50.0 * 2.0 * 9.81 / (201.0 - (50.0 * 2.0) ** 2 / 150.0)) / 2 / np.pi
    assert shaped.frequency[0] == pytest.approx(heavier, rel=1e-6) and shaped.residual < 1e-2 * shaped.runs[1].residual
    assert "Shaped force by 5 m in 8 s" in repr(shaped) and shaped.warnings == ()
    # The panel on the elbow of an arm that a spring holds: its inertia depends on the elbow's angle.
    arm = gb.RigidBody(10.0, (0.1, 3.0, 3.0), (0.5, 0, 0), points={"elbow": gb.Place((1, 0, 0), (np.pi / 2, 0, 0))})
    joints = {"shoulder": gb.Joint("revolute", "arm", axes=[(0, 0, 1)], stiffness=100.0)}
    joints["elbow"] = gb.Joint("revolute", "panel", "arm.elbow", axes=[(0, 1, 0)], effort=0.0)
    options = {"angle": 1.0, "duration": 5.0, "robust": 0.1}
    turned = gb.shape_command(gb.System({"arm": arm, "panel": PANEL}, joints), "elbow.angle", **options)  # type: ignore[arg-type]
    assert "shaped moves by 0.96" in turned.warnings[0] and "another inertia on its way" in turned.warnings[0]


def test_a_refinement_that_cannot_be_run_keeps_the_command_before_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """A free body under a constant thrust had a refined command so large that its run broke off: an IndexError."""
    from gbeam.analysis import Plant

    about, rounds = Plant.perturbed_runs, []

    def breaking(self: Plant, *of: Any) -> Any:
        rounds.append(of)
        if len(rounds) > 1:
            raise gb.ComputationError("diverged", "the run of a command ends at 0.01 s, before its time")
        return about(self, *of)

    monkeypatch.setattr(Plant, "perturbed_runs", breaking)
    options: dict[str, Any] = {"distance": 5.0, "duration": 8.0, "point": "load.hook"}
    shaped = gb.shape_command(crane(effort=0.0), "rail.displacement", **options)
    assert len(rounds) == 2 and shaped.outcome == "done"


def test_joints_that_no_command_leaves_at_rest_are_refused() -> None:
    to = {"distance": 5.0, "duration": 8.0, "point": "load.hook"}
    for system, coordinate, goal, said in (
        (crane(0.1, rate=0.0), "rail.displacement", to, r"joints.rope.initial.angle is 0.1, and it rests at 0"),
        (crane(rate=0.0), "rail.displacement", to | {"distance": None, "rate": 1.0}, "goes on at the rate"),
        (crane(rate=0.0), "rail.displacement", to | {"distance": None, "angle": 1.0}, "what is driven slides; give d"),
        (crane(rate=0.0), "rail.displacement", to | {"point": None}, "choose from trolley.root, load.hook"),
        (crane(effort=0.0), "rope.angle", to | {"distance": None, "angle": 1.0}, "a spring or gravity holds"),
    ):
        with pytest.raises(gb.InputError, match=said):
            gb.shape_command(system, coordinate, **goal)  # type: ignore[arg-type]
    tilted = gb.System(on_axis(rate=0.0).bodies, on_axis(rate=0.0).joints, gravity=(0, -9.81, 0))
    with pytest.raises(gb.InputError, match="bends the beam otherwise as it moves"):
        gb.shape_command(tilted, "axis.angle", angle=0.5, duration=6.0)
    options = {"angle": 0.5, "duration": 6.0}
    law = gb.Feedback(lambda t, y: -y, ["axis.angle_rate"], ["axis.angle"], sample=0.01)
    with pytest.raises(gb.InputError, match="controllers act besides the command"):
        gb.shape_command(replace(on_axis(effort=0.0), controllers={"damper": law}), "axis.angle", **options)  # type: ignore[arg-type]
    for more, said in (
        ({"stiffness": 5.0}, "a spring or gravity holds"),
        ({"damping": 5.0}, "friction or a damper brakes"),
        ({"friction": 5.0}, "friction or a damper brakes"),
        ({"initial_rate": 1.0}, "moves already"),
    ):
        with pytest.raises(gb.InputError, match=said):
            gb.shape_command(on_axis(effort=0.0, **more), "axis.angle", **options)  # type: ignore[arg-type]
    with pytest.raises(gb.InputError, match="choose"):
        gb.shape_command(on_axis(), "axis.angel", **options)  # type: ignore[arg-type]
    with pytest.raises(gb.InputError, match="give a Hub"):
        gb.shape_command(PANEL, "axis.angle", **options)  # type: ignore[arg-type]
    with pytest.raises(gb.InputError, match="carries a system"):
        gb.shape_command(on_axis(), FREE, **options)  # type: ignore[arg-type]


def test_modes_that_decay_long_before_the_end_leave_nothing() -> None:
    """Over 3 s one of 1144 Hz decays by exp(-2000): its numbers overflowed, and no command was found."""
    beam = gb.Beam(0.3, gb.Section.rectangle(0.02, 0.004), gb.Material(2700, 70e9), damping_ratio=0.1)
    structure = gb.assemble(beam, "FOAM", axial=1, y=2, z=2)
    command = gb.shape_command(structure, gb.Hub(radius=0.0, rate=0.0), angle=1.0, duration=3.0)
    assert command.residual < 1e-9
