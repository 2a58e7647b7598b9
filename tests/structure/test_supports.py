"""Beams that supports hold, against closed forms: frequencies, reactions, stretching, buckling and errors."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import ellipk

import gbeam as gb

LENGTH, WIDTH, THICKNESS, DENSITY, MODULUS = 0.6, 0.02, 0.004, 2700.0, 70e9
EI = MODULUS * WIDTH * THICKNESS**3 / 12
EA = MODULUS * WIDTH * THICKNESS
LINE_MASS = DENSITY * WIDTH * THICKNESS
PIN = gb.Support(0.0, ["x", "y", "z", "rx", "rz"])
# First roots of the frequency equations, β L.
ROOTS: dict[str, tuple[list[gb.Support], list[float]]] = {
    "clamped": ([gb.Support(LENGTH, ["z", "ry"])], [4.73004074, 7.85320462, 10.9956079]),
    "clamped and pinned": ([gb.Support(LENGTH, ["z"])], [3.92660231, 7.06858275, 10.21017612]),
    "pinned": ([PIN, gb.Support(LENGTH, ["z"])], [np.pi, 2 * np.pi, 3 * np.pi]),
    "guided": ([gb.Support(LENGTH, ["ry"])], [2.36502037, 5.49780392, 8.63937983]),
}


def beam(*supports: gb.Support, **keys: Any) -> gb.Beam:
    section, metal = gb.Section.rectangle(WIDTH, THICKNESS), gb.Material(DENSITY, MODULUS, poissons_ratio=0.3)
    return gb.Beam(LENGTH, section, metal, rotary_inertia=False, supports=list(supports), **keys)


@pytest.mark.parametrize(("kind", "shapes"), [("TLAM", None), ("FOAM", "adapted"), ("CFOAM", None), ("exact", None)])
@pytest.mark.parametrize("name", ROOTS)
def test_frequencies_are_those_of_the_closed_forms(name: str, kind: str, shapes: Any) -> None:
    supports, roots = ROOTS[name]
    modes = gb.modes(gb.assemble(beam(*supports), kind, z=6, shapes=shapes))
    betas = np.sqrt(2 * np.pi * modes.frequency[:3] / np.sqrt(EI / LINE_MASS)) * LENGTH
    assert betas[:2] == pytest.approx(roots[:2], rel=1e-4) and betas[2] == pytest.approx(roots[2], rel=2e-3)
    assert modes.errors is not None
    stated, true = modes.errors.slender[:3], np.square(betas / roots) - 1
    assert (np.abs(true) <= 3 * stated + 1e-8).all()


# Of a clamped beam under an even load: at the root and at the other end, force over p L and moment over p L².
@pytest.mark.parametrize("kind", ["FOAM", "exact"])
@pytest.mark.parametrize(
    ("supports", "forces", "moment"),
    [
        ([gb.Support(LENGTH, ["z", "ry"])], [1 / 2], 1 / 12),
        ([gb.Support(LENGTH, ["z"])], [3 / 8], 0.0),
        ([PIN, gb.Support(LENGTH, ["z"])], [1 / 2], 0.0),
        ([PIN, gb.Support(LENGTH / 2, ["z"]), gb.Support(LENGTH, ["z"])], [5 / 8, 3 / 16], 0.0),
    ],
)
def test_reactions_are_those_of_the_closed_forms(
    supports: list[gb.Support], forces: list[float], moment: float, kind: str
) -> None:
    load = LINE_MASS * 1.0 * LENGTH  # of 1 m/s²
    rest = gb.static(gb.assemble(beam(*supports), kind, z=6), acceleration=(0.0, 0.0, 1.0))
    loads = rest.loads
    assert loads is not None and loads.support_force is not None and loads.support_moment is not None
    assert loads.support_force[0, :, 2] / load == pytest.approx(forces, rel=1e-6)
    assert loads.support_moment[0, -1, 1] / (load * LENGTH) == pytest.approx(moment, rel=1e-6, abs=1e-9)
    assert loads.root_force[0, 2] / load == pytest.approx(1 - sum(forces), rel=1e-6)


def even_load_on_a_held_beam(load: float, *, clamped: bool) -> tuple[float, float]:
    """Tension, N, and deflection in the middle, m, by von Kármán: EI w'''' − T w'' = p, T = EA/2L ∫ w'² dx."""
    x = np.linspace(0.0, LENGTH, 20_001)

    def deflection(tension: float) -> np.ndarray:
        k = np.sqrt(tension / EI)
        particular = load * x * (LENGTH - x) / (2 * tension)
        wave = np.cosh(k * (x - LENGTH / 2)) / np.cosh(k * LENGTH / 2)
        if clamped:  # its slope at the ends is that of the particular solution, with the other sign
            scale = -load * LENGTH / (2 * tension) / (k * np.tanh(k * LENGTH / 2))
            return np.asarray(particular + scale * (1 - wave))
        return np.asarray(particular - load / (tension * k**2) * (1 - wave))

    def excess(tension: float) -> float:
        slope = np.gradient(deflection(tension), x)
        return float(EA / (2 * LENGTH) * np.trapezoid(slope**2, x) - tension)

    tension = brentq(excess, 1e-3, 1e6, rtol=1e-12)
    return float(tension), float(deflection(tension)[len(x) // 2])


@pytest.mark.parametrize("kind", ["FOAM", "CFOAM", "fourth-order", "exact"])
@pytest.mark.parametrize("clamped", [True, False])
def test_a_beam_held_at_both_ends_stretches_as_von_karman_says(kind: str, *, clamped: bool) -> None:
    """The deflection is 1.6 and 1.9 thicknesses; that without the stretch is three and twelve times as much."""
    supports = [gb.Support(LENGTH, ["x", "z", "ry"])] if clamped else [PIN, gb.Support(LENGTH, ["x", "z"])]
    held = gb.assemble(beam(*supports), kind, axial=3, z=8)
    rest = gb.static(held, acceleration=(0.0, 0.0, 2000.0))
    tension, middle = even_load_on_a_held_beam(LINE_MASS * 2000.0, clamped=clamped)
    assert rest.loads is not None and rest.loads.support_force is not None
    assert rest.at("beam.span")[2] == pytest.approx(-middle, rel=3e-3)
    assert rest.loads.support_force[0, 0, 0] == pytest.approx(tension, rel=5e-3)


@pytest.mark.parametrize("kind", ["FOAM", "exact"])
def test_a_wide_vibration_between_pins_has_the_frequency_of_woinowsky_krieger(kind: str) -> None:
    """Journal of Applied Mechanics 17, 1950: ω/ω₀ = π √(1 + a²/4) / 2 K(k), k² = a²/8 (1 + a²/4), a over the radius of
    gyration.

    The beam is let go from the deflection under an even load, which is not quite a sine.
    """
    held = gb.assemble(beam(PIN, gb.Support(LENGTH, ["x", "z"]), damping_ratio=0.0), kind, axial=2, z=5)
    lowest = gb.modes(held).frequency[0]
    drawn = gb.Initial(acceleration=(0.0, 0.0, 90.0))
    settings = {"duration": 6 / lowest, "step": 1 / lowest / 200, "initial": drawn, "estimate": False}
    run = gb.simulate(held, gb.Flight(z=0.0), **settings)  # type: ignore[arg-type]
    assert run.outcome == "done"
    middle, time = run.at("beam.span")[:, 2], run.time
    before = np.flatnonzero((middle[:-1] < 0) & (middle[1:] >= 0))
    crossed = time[before] - middle[before] * (time[before + 1] - time[before]) / np.diff(middle)[before]
    amplitude = abs(middle[0]) / (THICKNESS / np.sqrt(12.0))
    wide = 1 + amplitude**2 / 4
    raised = np.pi / 2 * np.sqrt(wide) / ellipk(amplitude**2 / 8 / wide)
    assert raised > 1.2
    assert (len(crossed) - 1) / (crossed[-1] - crossed[0]) / lowest == pytest.approx(raised, rel=5e-3)


@pytest.mark.parametrize("kind", ["FOAM", "CFOAM", "fourth-order", "exact"])
def test_a_load_bends_a_held_beam_as_an_acceleration_does(kind: str) -> None:
    """Spread as the mass is; the reactions are those of the load."""
    load = gb.Load(distributed=(0.0, 0.0, -1000.0 * LINE_MASS))
    fixed = gb.Support(LENGTH, ["x", "z", "ry"])
    loaded = gb.static(gb.assemble(beam(fixed, loads=[load]), kind, axial=2, z=4))
    accelerated = gb.static(gb.assemble(beam(fixed), kind, axial=2, z=4), acceleration=(0.0, 0.0, 1000.0))
    assert loaded.at("beam.span") == pytest.approx(accelerated.at("beam.span"), rel=1e-6, abs=1e-12)
    assert loaded.loads is not None and accelerated.loads is not None
    assert loaded.loads.support_force == pytest.approx(accelerated.loads.support_force, rel=1e-6, abs=1e-6)


def test_a_spring_along_the_beam_stretches_it_less() -> None:
    """Of a strip between a pin and a spring: T = (δ/L) / (1/EA + 1/kL), by which FOAM is as stiff as exact."""
    spring = gb.Support(LENGTH, ["z"], stiffness={"x": 2e6})
    answers = []
    for kind in ("FOAM", "exact"):
        held = gb.assemble(beam(PIN, spring), kind, axial=2, z=6)
        rest = gb.static(held, acceleration=(0.0, 0.0, 1000.0))
        assert rest.loads is not None and rest.loads.support_force is not None
        answers.append((rest.at("beam.span")[2], rest.loads.support_force[0, 0, 0]))
    rigid = gb.static(
        gb.assemble(beam(PIN, gb.Support(LENGTH, ["x", "z"])), "FOAM", axial=2, z=6), acceleration=(0.0, 0.0, 1000.0)
    )
    assert answers[0] == pytest.approx(answers[1], rel=5e-3)
    assert abs(answers[0][0]) > 1.1 * abs(rigid.at("beam.span")[2])


@pytest.mark.parametrize(("supports", "root"), [
    ([gb.Support(LENGTH, ["z", "ry"])], 4 * np.pi**2),
    ([gb.Support(LENGTH, ["z"])], 20.1907286),
    ([PIN, gb.Support(LENGTH, ["z"])], np.pi**2),
])  # fmt: skip
@pytest.mark.parametrize("kind", ["FOAM", "exact"])
def test_it_buckles_between_its_supports_at_eulers_load(supports: list[gb.Support], root: float, kind: str) -> None:
    """The force at the tip pushes towards the root; its factor's stated error bounds the true one within three."""
    push = gb.Load(at=LENGTH, force=(-1.0, 0.0, 0.0))
    critical = gb.critical_load(gb.assemble(beam(*supports, loads=[push]), kind, z=6))
    assert critical.value == pytest.approx(root * EI / LENGTH**2, rel=5e-4)
    assert critical.errors is not None
    assert abs(critical.value / (root * EI / LENGTH**2) - 1) <= 3 * critical.errors.total


def test_a_point_that_is_called_as_a_span_keeps_its_place() -> None:
    held = beam(gb.Support(LENGTH, ["z"]), points=[gb.Point("span", at=0.1)])
    assert held.named_points == {"span": 0.1, "tip": LENGTH}


def test_moving_a_support_moves_answers_continuously() -> None:
    """Also past a station, past the middle, and to the tip."""
    places = np.concatenate([0.3 + np.array([-1e-6, 0.0, 1e-6]), LENGTH - np.array([1e-6, 0.0])])
    frequencies = [
        gb.modes(gb.assemble(beam(gb.Support(x, ["z"])), "FOAM", z=6, stations=[0.3])).frequency[0] for x in places
    ]
    assert frequencies[:3] == pytest.approx([frequencies[1]] * 3, rel=1e-4)
    assert frequencies[3] == pytest.approx(frequencies[4], rel=1e-4)


@pytest.mark.parametrize("kind", ["FOAM", "exact"])
def test_stiff_springs_hold_as_rigid_supports_do(kind: str) -> None:
    rigid = gb.assemble(beam(gb.Support(0.45, ["z", "ry"])), kind, z=6)
    springs = gb.Support(0.45, stiffness={"z": 1e8, "ry": 1e7})
    soft = gb.assemble(beam(springs), kind, z=6)
    assert gb.modes(soft).frequency[:3] == pytest.approx(gb.modes(rigid).frequency[:3], rel=3e-4)
    under = [gb.static(model, acceleration=(0.0, 0.0, 200.0)) for model in (rigid, soft)]
    first, second = (rest.loads.support_force[0, 0, 2] for rest in under if rest.loads is not None)
    assert second == pytest.approx(first, rel=1e-3)


def test_a_damper_takes_the_energy_out() -> None:
    """Beside no other damping: the tip's motion decays as the modes' damping ratio says."""
    damped = beam(gb.Support(LENGTH, damping={"z": 0.4}), damping_ratio=0.0)
    modes = gb.modes(gb.assemble(damped, "FOAM", z=4))
    assert modes.damping_ratio[0] == pytest.approx(
        0.4 * 4 / (2 * LINE_MASS * LENGTH * 2 * np.pi * modes.frequency[0]), rel=0.02
    )


BAD = {
    "holds x, in which the model has no shapes; give modes.axial = 1": ("FOAM", [gb.Support(LENGTH, ["x"])]),
    "holds y, in which the model has no shapes": ("FOAM", [gb.Support(LENGTH, ["y"])]),
    "holds z at 600 mm, where it is held already": ("FOAM", [gb.Support(LENGTH, ["z"]), gb.Support(LENGTH, ["z"])]),
}


@pytest.mark.parametrize("problem", BAD)
def test_what_cannot_be_held_is_refused_by_name(problem: str) -> None:
    kind, supports = BAD[problem]
    with pytest.raises(gb.InputError) as refusal:
        gb.assemble(beam(*supports), kind, z=4)  # type: ignore[arg-type]
    assert problem in str(refusal.value) and "supports[" in str(refusal.value)


@pytest.mark.parametrize(("keys", "problem"), [
    ({"supports": [gb.Support(0.7, ["z"])]}, "supports[0].at is 0.7 m, beyond the tip"),
    ({"supports": [PIN]}, "leaves the beam free to turn about y, as a whole"),
    ({"supports": [PIN, PIN]}, "supports[1].at is 0 a second time"),
    ({"supports": [PIN, gb.Support(0.6, ["z"])], "root": gb.Root(rotation_y=5.0)}, "both say what the root holds"),
    ({"root": gb.Root(rotation_y=0.0)}, "leaves the beam free to turn about y"),
    ({"supports": [gb.Support(0.0, ["x", "y", "z", "ry", "rz"])]}, "free to turn about x, as a whole; give the root a"),
    ({"supports": [gb.Support(0.0, ["y", "z", "rx", "ry", "rz"])]}, "free to move along x, as a whole"),
    (
        {"supports": [gb.Support(0.0, ["x", "y", "rx", "rz"]), gb.Support(0.45, ["z"])]},
        "free to turn about y at 450 mm, as a whole",
    ),
    (
        {"supports": [gb.Support(0.0, ["x", "y", "rx", "rz"]), gb.Support(0.45, ["ry"])]},
        "free to move along z, as a whole",
    ),
])  # fmt: skip
def test_a_beam_that_is_not_held_is_refused(keys: dict[str, Any], problem: str) -> None:
    section, metal = gb.Section.rectangle(WIDTH, THICKNESS), gb.Material(DENSITY, MODULUS)
    with pytest.raises(gb.InputError) as refusal:
        gb.Beam(LENGTH, section, metal, **keys)
    assert problem in str(refusal.value)


@pytest.mark.parametrize("kind", ["FOAM", "exact"])
def test_a_linear_model_has_the_moment_of_the_root_alone(kind: str) -> None:
    """Of a beam clamped at both ends it is a twelfth of what its mass times its length is accelerated by."""
    clamped = beam(gb.Support(LENGTH, ["z", "ry"]), damping_ratio=0.01)
    linear = gb.linearize(gb.assemble(clamped, kind, z=4), gb.Flight(z=0.0))
    gain = linear.d - linear.c @ np.linalg.solve(linear.a, linear.b)
    moment = [signal.name for signal in linear.outputs].index("root_moment_y")
    push = [signal.name for signal in linear.inputs].index("base_acceleration_z")
    assert gain[moment, push] == pytest.approx(-LINE_MASS * LENGTH**2 / 12, rel=1e-5)


@pytest.mark.parametrize(("kind", "along"), [("exact", []), ("FOAM", ["x"]), ("CFOAM", ["x"])])
def test_reactions_and_inertia_balance_at_every_instant(kind: str, along: list[str]) -> None:
    """In a turn with an even load across the beam, whose mass is beside its axis as well."""
    camera = gb.PointMass(0.2, 0.3, inertia=(2e-5, 3e-5, 4e-5), offset=(0.01, 0.02, 0.015))
    supports = [
        gb.Support(0.4, ["y", "z"], stiffness={"y": 2e4}, damping={"y": 3.0}),
        gb.Support(LENGTH, [*along, "z", "rz"]),
    ]
    held = gb.assemble(beam(*supports, masses=[camera], damping_ratio=0.01), kind, axial=1, y=3, z=3)
    motion = gb.Flight(
        y=gb.Sine(30.0, 0.2),
        z=gb.trapezoid(50.0, jerk=500.0, start=0.05, hold=0.1),
        rates=gb.constant(np.array([2.0, 0.5, 0.0])),
    )
    response = gb.simulate(held, motion, duration=0.3, step=1e-3, estimate=False)
    loads = response.loads
    assert loads is not None and loads.base_force is not None
    accelerated = -response.ground_force  # by the whole tree, of which the supports are no part
    size = np.abs(accelerated).max()
    np.testing.assert_allclose(loads.base_force, accelerated, atol=1e-10 * size)


def test_a_support_beside_the_tip_leaves_every_motion_its_mass() -> None:
    """Nine polynomials contain its static deflection but for 1e-5: with that as a shape, one motion had no mass."""
    roots = ROOTS["clamped and pinned"][1]
    modes = gb.modes(gb.assemble(beam(gb.Support(0.998 * LENGTH, ["z"])), "exact", z=9))
    assert modes.outcome == "done"
    betas = np.sqrt(2 * np.pi * modes.frequency[:2] / np.sqrt(EI / LINE_MASS)) * 0.998 * LENGTH
    assert betas == pytest.approx(roots[:2], rel=1e-3)


def test_answers_that_are_about_the_tip_are_refused_where_it_is_held() -> None:
    """A place was judged by 8e-17 mm; a command would have been."""
    held = gb.assemble(beam(gb.Support(LENGTH, ["z", "ry"]), damping_ratio=0.01), "FOAM", axial=1, z=3)
    flight = gb.Flight(z=gb.trapezoid(50.0, jerk=50.0, start=0.5, hold=1.0))
    machine = gb.Centrifuge(flight, arm=3.3, control_point=0.3, gravity=False, idle=14.0)
    settings = gb.ResponseSettings(3.0)
    with pytest.raises(gb.InputError, match="hold the tip, by which a place is judged"):
        gb.place(held, flight, gb.choice_of(machine), settings, {"tip": 1.0}, current=machine)
    with pytest.raises(gb.InputError, match="hold the tip, by which a command is judged"):
        gb.shape_command(held, gb.Hub(radius=0.1), angle=0.5, duration=1.0)


TAPPED = """
title = "A strip on a spring"
[beam]
length = "600 mm"
section = { shape = "rectangle", width = "20 mm", thickness = "4 mm" }
material = { density = "2700 kg/m^3", youngs_modulus = "70 GPa" }
damping_ratio = 0.01
supports = [ { at = "500 mm", stiffness = { z = "5 N/mm" } } ]
[model]
kind = "FOAM"
modes = { z = 4 }
"""


def test_a_spring_follows_from_a_tap_test(tmp_path: Path) -> None:
    """From three frequencies of a strip on 2 N/mm, the scenario of which says 5."""
    scenario, taps, path = tmp_path / "strip.toml", tmp_path / "taps.csv", "beam.supports[0].stiffness.z"
    scenario.write_text(TAPPED, encoding="utf-8")
    true = gb.read_scenario(scenario, [f"{path}=2 N/mm"])
    frequency = gb.modes(true.system).frequency[:3]
    table = np.stack([np.arange(1, 4), frequency], axis=1)
    np.savetxt(taps, table, delimiter=",", header="mode,frequency", comments="")
    fit = gb.fit(gb.read_scenario(scenario), taps, [path])
    assert fit.before[0] == pytest.approx(5000.0) and fit.values[0] == pytest.approx(2000.0, rel=1e-4)


def test_supports_and_loads_stand_where_a_named_point_is() -> None:
    camera, joint = gb.PointMass(0.2, 0.1, name="camera"), gb.Point("joint", 0.4)
    keys: dict[str, Any] = {"masses": [camera], "points": [joint]}
    push = (0.0, 0.0, 1.0)
    named = beam(gb.Support("joint", ["z"]), gb.Support("tip", ["z"]), loads=[gb.Load("camera", push)], **keys)
    placed = beam(gb.Support(0.4, ["z"]), gb.Support(LENGTH, ["z"]), loads=[gb.Load(0.2, push)], **keys)
    first, second = (gb.static(gb.assemble(each, "FOAM", z=4)) for each in (named, placed))
    np.testing.assert_array_equal(first.q, second.q)
    with pytest.raises(gb.InputError, match=r"supports\[0\].at is 'jiont'; did you mean 'joint'\? .* camera, tip"):
        beam(gb.Support("jiont", ["z"]), **keys)


NAMED = TAPPED.replace('at = "500 mm", stiffness = { z = "5 N/mm" }', 'at = "tip", holds = ["z"]').replace(
    "[model]",
    'loads = [ { at = "camera", force = { z = "1 N" } } ]\npoints = [ { name = "camera", at = "0.2 m" } ]\n[model]',
)


def test_a_file_keeps_the_names_of_places(tmp_path: Path) -> None:
    """A support at the tip goes with it, and a load with its point."""
    path = tmp_path / "strip.toml"
    path.write_text(NAMED, encoding="utf-8")
    case = gb.read_scenario(path, ["beam.length=500 mm", "beam.points[0].at=100 mm"])
    source = case.system.flexible["beam"].source
    assert source is not None
    described = source.beam
    assert [each.at for each in described.supports] == [0.5] and [each.at for each in described.loads] == [0.1]
    with pytest.raises(gb.InputError, match="did you mean 'camera'"):
        gb.read_scenario(path, ["beam.supports[0].at=camra"])


OPEN = ["x", "y", "z", "ry", "rz"]  # what a root holds that turns about the beam's axis
SHAFT = gb.Material(DENSITY, MODULUS, poissons_ratio=0.3)


def shaft(*supports: gb.Support, **keys: Any) -> gb.Beam:
    return gb.Beam(LENGTH, gb.Section.rectangle(WIDTH, THICKNESS), SHAFT, supports=list(supports), **keys)


@pytest.mark.parametrize("shapes", ["clamped-free", "adapted"])
@pytest.mark.parametrize("kind", ["FOAM", "exact"])
def test_a_root_turns_about_the_axis_where_something_else_holds_that(kind: Any, shapes: Any) -> None:
    """A quarter of a wave of torsion, whichever end is held; and with a spring at the root β tan β = k L / GJ."""
    section = gb.Section.rectangle(WIDTH, THICKNESS)
    torsion = SHAFT.rigidity * float(section.torsion_constant(np.zeros(1))[0])
    polar = DENSITY * WIDTH * THICKNESS * (WIDTH**2 + THICKNESS**2) / 12
    for supports, root in (
        ([gb.Support(0.0, OPEN), gb.Support(LENGTH, ["rx"])], np.pi / 2),
        ([gb.Support(0.0, OPEN, {"rx": 5.0})], brentq(lambda b: b * np.tan(b) - 5.0 * LENGTH / torsion, 0.01, 1.57)),
    ):
        modes = gb.modes(gb.assemble(shaft(*supports), kind, z=1, twist=3, shapes=shapes))
        expected = root / LENGTH * np.sqrt(torsion / polar) / (2 * np.pi)
        assert np.abs(modes.frequency / expected - 1).min() < 3e-5


def test_a_root_slides_along_the_beam_where_something_else_holds_that() -> None:
    """A quarter of a wave along the beam, and under the beam's own weight the root moves by ρ g L² / 2E."""
    held = gb.assemble(
        shaft(gb.Support(0.0, ["y", "z", "rx", "ry", "rz"]), gb.Support(LENGTH, ["x"])), "exact", axial=3, z=1
    )
    modes = gb.modes(held)
    assert np.abs(modes.frequency * 4 * LENGTH / np.sqrt(MODULUS / DENSITY) - 1).min() < 1e-4
    rest = gb.static(held, acceleration=(1e4, 0.0, 0.0))
    assert rest.loads is not None and rest.loads.support_force is not None
    assert rest.loads.support_force[0, 0, 0] == pytest.approx(LINE_MASS * LENGTH * 1e4)
    assert rest.loads.root_force[0, 0] == pytest.approx(0.0, abs=1e-6)
    assert rest.q[-1] == pytest.approx(-DENSITY * 1e4 * LENGTH**2 / (2 * MODULUS), rel=1e-5)


@pytest.mark.parametrize("kind", ["FOAM", "exact"])
def test_springs_and_dampers_at_the_root_are_those_of_a_support_seen_from_the_other_end(kind: Any) -> None:
    """A clamp with a sprung, damped end; and the same beam turned round, its root sprung and damped."""
    spring, damper = {"z": 500.0, "ry": 3.0}, {"z": 2.0, "ry": 1e-3}
    first = beam(gb.Support(LENGTH, [], spring, damper), damping_ratio=0.0)
    root = gb.Support(0.0, ["x", "y", "rx", "rz"], spring, damper)
    second = beam(root, gb.Support(LENGTH, ["z", "ry"]), damping_ratio=0.0)
    before, after = (gb.modes(gb.assemble(each, kind, z=6)) for each in (first, second))
    assert after.frequency[:3] == pytest.approx(before.frequency[:3], rel=2e-3)
    assert after.damping_ratio[:3] == pytest.approx(before.damping_ratio[:3], rel=1e-2)
    alone = beam(gb.Support(0.0, ["x", "y", "rx", "ry", "rz"], {"z": 0.5}, {"z": 0.1}), damping_ratio=0.0)
    ratio = gb.modes(gb.assemble(alone, kind, z=4)).damping_ratio[0]
    assert ratio == pytest.approx(0.1 / (2 * np.sqrt(0.5 * LINE_MASS * LENGTH)), rel=1e-2)  # nearly rigid


@pytest.mark.parametrize("kind", ["FOAM", "exact"])
def test_reactions_balance_where_the_root_gives_way(kind: Any) -> None:
    """Also its damper's force is in them, in a turn, with a body beside the axis."""
    camera = gb.PointMass(0.2, 0.3, inertia=(2e-5, 3e-5, 4e-5), offset=(0.01, 0.02, 0.015))
    supports = [gb.Support(0.0, OPEN, {"z": 2e4}, {"rx": 1e-3, "z": 3.0}), gb.Support(LENGTH, ["rx", "y"])]
    held = gb.assemble(shaft(*supports, masses=[camera], damping_ratio=0.01), kind, y=2, z=2, twist=1)
    motion = gb.Flight(y=gb.Sine(30.0, 0.2), z=gb.constant(50.0), rates=gb.constant(np.array([2.0, 0.5, 0.0])))
    response = gb.simulate(held, motion, duration=0.1, step=1e-3, estimate=False)
    assert response.loads is not None and response.loads.base_force is not None
    accelerated = -response.ground_force
    np.testing.assert_allclose(response.loads.base_force, accelerated, atol=1e-10 * np.abs(accelerated).max())


def test_a_beam_without_rotary_inertia_does_not_turn_about_its_axis() -> None:
    with pytest.raises(gb.InputError, match="rotary_inertia is false, and the root gives way about x"):
        gb.assemble(beam(gb.Support(0.0, OPEN, {"rx": 5.0})), "FOAM", z=2)


@pytest.mark.parametrize("kind", ["FOAM", "exact"])
def test_a_rod_that_only_stretches_is_held_at_both_ends(kind: str) -> None:
    """Its lowest frequency is that of half a wave, c/2L; half of its weight is on either end."""
    rod = gb.assemble(beam(gb.Support(LENGTH, ["x"])), kind, axial=3)
    assert gb.modes(rod).frequency[0] == pytest.approx(np.sqrt(MODULUS / DENSITY) / (2 * LENGTH), rel=1e-4)
    loads = gb.static(rod, acceleration=(100.0, 0.0, 0.0)).loads
    assert loads is not None and loads.support_force is not None
    assert loads.support_force[0, 0, 0] == pytest.approx(100.0 * LINE_MASS * LENGTH / 2, rel=1e-6)


def test_a_strip_over_three_supports_bends_far() -> None:
    """Springs count where dependent coordinates are chosen: without them it was lost at 0.81 of the load."""
    supports = [
        gb.Support(0.412, ["z"], stiffness={"ry": 7.6}),
        gb.Support(0.607, ["z"]),
        gb.Support(0.622, ["z"], stiffness={"z": 207.0, "ry": 1.14}),
    ]
    strip = gb.Section.rectangle(0.0111, 0.00244)
    mass = gb.PointMass(0.6215, 0.0258)
    beam = gb.Beam(0.622, strip, gb.Material(2700, 70e9), [mass], supports=supports, rotary_inertia=False)
    rest = gb.static(gb.assemble(beam, "exact", axial=2, z=3), acceleration=(0, 0, 287.1))
    assert rest.stable and 0 < np.linalg.norm(rest.tip) < 1e-3
