"""Beams that are heated, against closed forms: expansion, reactions, frequencies up to buckling, and histories."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gbeam as gb

LENGTH, WIDTH, THICKNESS, MODULUS, EXPANSION, COLD = 0.6, 0.02, 0.004, 70e9, 23e-6, 293.15
EA = MODULUS * WIDTH * THICKNESS
METAL = gb.Material(2700.0, MODULUS, expansion=EXPANSION)
PIN = gb.Support(0.0, ["x", "y", "z", "rx", "rz"])
HELD = {
    "pinned": ([PIN, gb.Support(LENGTH, ["x", "z"])], np.pi**2),
    "clamped": ([gb.Support(LENGTH, ["x", "z", "ry"])], 4 * np.pi**2),
}


def beam(rise: Any, supports: Any = (), **keys: Any) -> gb.Beam:
    """A strip of aluminium that is warmer by a rise, K, than where it is free of strain."""
    section = keys.pop("section", gb.Section.rectangle(WIDTH, THICKNESS))
    temperature = gb.Temperature(COLD + rise, reference=COLD)
    return gb.Beam(LENGTH, section, METAL, supports=supports, temperature=temperature, **keys)


def buckling_rise(root: float) -> float:
    """Rise, K, at which a strip buckles between its ends: α ΔT EA = c EI/L²."""
    return root * THICKNESS**2 / 12 / LENGTH**2 / EXPANSION


@pytest.mark.parametrize("kind", ["TLAM", "FOAM", "CFOAM", "exact"])
def test_a_free_end_moves_by_the_expansion_and_nothing_carries_a_force(kind: str) -> None:
    """Of a tapered beam as well."""
    tapered = gb.Section.rectangle(WIDTH, [2 * THICKNESS, THICKNESS], stations=[0.0, LENGTH])
    for section in (gb.Section.rectangle(WIDTH, THICKNESS), tapered):
        rest = gb.static(gb.assemble(beam(60.0, section=section), kind, axial=1, z=3))
        assert rest.loads is not None
        assert rest.tip[0] == pytest.approx(EXPANSION * 60.0 * LENGTH, rel=1e-6)
        assert np.abs(rest.loads.force).max() < 1e-9 * EA * EXPANSION * 60.0


@pytest.mark.parametrize("kind", ["FOAM", "exact"])
def test_a_curved_beam_grows_in_proportion(kind: str) -> None:
    arc = gb.Line(LENGTH, lambda x: np.stack([0 * x, 2.0 + 0 * x, 0 * x], axis=1))
    rest = gb.static(gb.assemble(beam(60.0, line=arc), kind, axial=2, y=2, z=4))
    at_rest = arc.places([LENGTH])[0][0]
    assert rest.tip == pytest.approx(EXPANSION * 60.0 * at_rest, rel=2e-3, abs=1e-6)


@pytest.mark.parametrize("kind", ["TLAM", "FOAM", "exact"])
def test_two_ends_that_are_held_are_pushed_by_what_the_expansion_would_be(kind: str) -> None:
    rest = gb.static(gb.assemble(beam(1.0, HELD["clamped"][0]), kind, axial=1, z=3))
    assert rest.loads is not None and rest.loads.support_force is not None
    assert rest.loads.support_force[0, 0, 0] == pytest.approx(-EA * EXPANSION, rel=1e-9)
    assert rest.loads.stress_compression.min() == pytest.approx(-MODULUS * EXPANSION, rel=1e-9)


@pytest.mark.parametrize("kind", ["FOAM", "CFOAM", "exact"])
@pytest.mark.parametrize("name", HELD)
def test_it_buckles_at_the_temperature_of_the_closed_form(name: str, kind: str) -> None:
    """A rise by 1 K times the load factor."""
    supports, root = HELD[name]
    critical = gb.critical_load(gb.assemble(beam(1.0, supports), kind, axial=1, z=5))
    assert critical.value == pytest.approx(buckling_rise(root), rel=1e-3)
    assert critical.errors is not None
    assert abs(critical.value / buckling_rise(root) - 1) <= 3 * critical.errors.total


@pytest.mark.parametrize("kind", ["FOAM", "exact"])
@pytest.mark.parametrize("share", [-1.0, 0.5, 0.9, 0.99])
def test_its_frequency_falls_to_zero_where_it_buckles(kind: str, share: float) -> None:
    """Between pins f = f₀ √(1 − ΔT/ΔT_c); cooled, it rises."""
    supports, root = HELD["pinned"]
    warm, cold = (
        gb.modes(gb.assemble(beam(rise, supports), kind, axial=1, z=5)).frequency[0]
        for rise in (share * buckling_rise(root), 0.0)
    )
    assert warm / cold == pytest.approx(np.sqrt(1 - share), rel=2e-4)


def test_a_history_of_the_temperature_heats_in_a_run() -> None:
    """Between two clamps, in a slow rise by 4 K, below buckling; the reaction follows, and so does a static answer."""
    rise = gb.tabulated([0.0, 0.5, 1.0], [COLD, COLD + 4.0, COLD + 4.0])
    section = gb.Section.rectangle(WIDTH, THICKNESS)
    temperature = gb.Temperature(rise, reference=COLD)
    supports = HELD["clamped"][0]
    heated = gb.Beam(LENGTH, section, METAL, damping_ratio=0.05, supports=supports, temperature=temperature)
    model = gb.assemble(heated, "FOAM", axial=1, z=3)
    run = gb.simulate(model, gb.Flight(z=0.0), duration=1.0, step=2e-3, estimate=False)
    assert run.loads is not None and run.loads.support_force is not None
    push = -run.loads.support_force[:, 0, 0] / (EA * EXPANSION)
    assert push == pytest.approx(np.interp(run.time, [0.0, 0.5], [0.0, 4.0]), abs=1e-3)
    rest = gb.static(model, time=0.25)
    assert rest.loads is not None and rest.loads.support_force is not None
    assert rest.loads.support_force[0, 0, 0] == pytest.approx(-2.0 * EA * EXPANSION, rel=1e-6)


def test_a_linear_model_has_the_temperature_as_an_input() -> None:
    linear = gb.linearize(gb.assemble(beam(10.0, damping_ratio=0.01), "FOAM", axial=1, z=3), gb.Flight(z=0.0))
    gain = linear.d - linear.c @ np.linalg.solve(linear.a, linear.b)
    tip = [signal.name for signal in linear.outputs].index("tip_x")
    assert (linear.inputs[-1].name, linear.inputs[-1].unit) == ("temperature", "K")
    assert gain[tip, -1] == pytest.approx(EXPANSION * LENGTH, rel=1e-9)


SCENARIO = """
[beam]
length = "600 mm"
section = { shape = "rectangle", width = "20 mm", thickness = "4 mm" }
material = { density = "2700 kg/m^3", youngs_modulus = "70 GPa", expansion = "23e-6 1/K" }
supports = [ { at = "600 mm", holds = ["x", "z", "ry"] } ]
temperature = { value = "25 degC", reference = "20 °C" }
[model]
kind = "FOAM"
modes = { axial = 1, z = 4 }
"""


def test_a_scenario_says_temperatures_as_people_do(tmp_path: Path) -> None:
    path = tmp_path / "warm.toml"
    path.write_text(SCENARIO, encoding="utf-8")
    ours = gb.modes(gb.read_scenario(path).system).frequency[0]
    same = gb.modes(gb.assemble(beam(5.0, HELD["clamped"][0]), "FOAM", axial=1, z=4)).frequency[0]
    assert ours == pytest.approx(same, rel=1e-9)


@pytest.mark.parametrize(("text", "change", "problem"), [
    ('"25 degC"', '"-300 degC"', "beam.temperature.value: is -26.85"),
    ('"25 degC"', '"25 deg"', "beam.temperature.value"),
    (', expansion = "23e-6 1/K"', "", "material.expansion: is missing, and the body has a temperature"),
    ("axial = 1, ", "", "temperature: stretches the beam, and the model has no shapes along it"),
])  # fmt: skip
def test_what_cannot_be_heated_is_refused(tmp_path: Path, text: str, change: str, problem: str) -> None:
    path = tmp_path / "warm.toml"
    scenario = SCENARIO.replace(text, change)
    if "axial" in text:
        scenario = scenario.replace('"x", ', "")
    path.write_text(scenario, encoding="utf-8")
    with pytest.raises(gb.InputError) as refusal:
        _ = gb.read_scenario(path).system
    assert problem in str(refusal.value)
