"""Units of figures: declared for every one, whatever the scenario calls its motions."""

from __future__ import annotations

from functools import cache

import pytest

from gbeam.scenario import loads
from gbeam.studies import Facts, Inquiry, ScenarioTemplate, declared_unit, figures_in, find, own_keys, unit_at

from ..scenarios import FAST, FREE_HUB, RAMPS, SLEWING

LOADED = (
    FAST.replace("6 g", "3 g").replace('"70 GPa" }', '"70 GPa", yield_strength = "200 MPa" }')
    + '[motion.spin.limits]\naxis1 = { rate = "20 rad/s" }\ninertia = "2000 kg m^2"\npower = "90 kW"\n'
    + '[motion.spin.accept]\ntip = "50 %"\n'
)
# A ramp that begins below idle: stretches that are not followed, load peaks and a placement.
RAMP = '{ profile = "table", times = [0, 0.2, 0.4, 0.5], values = [2, 50, 30, 30] }'
RISING = (
    LOADED.replace(RAMPS, "")
    .replace('{ profile = "constant", level = "3 g" }', RAMP)
    .replace("gravity = false", 'gravity = false\nidle = "1.4 g"\nsmoothing = "60 ms"')
)
ASKED = [
    (LOADED, "run", None),
    (RISING, "run", None),
    (LOADED, "static", None),
    (LOADED, "modes", "flight"),
    (RISING, "plan", None),
    (RISING, "place", None),
    (FREE_HUB, "run", None),
    (SLEWING, "run", None),
    (SLEWING, "modes", None),
    (SLEWING, "critical-speed", None),
    (SLEWING.replace("2 rad/s", "6 rad/s"), "modes", None),  # beyond the critical speed
]


@cache
def facts_of(text: str, verb: str, motion: str | None) -> Facts:
    base = loads(text, "scenario.toml")
    inquiry = Inquiry(ScenarioTemplate(base), verb, motion, at=34.0 if verb == "modes" and text != LOADED else None)
    return inquiry.facts(inquiry.case(()))


@pytest.mark.parametrize(("text", "verb", "motion"), ASKED)
def test_every_figure_has_a_unit_declared(text: str, verb: str, motion: str | None) -> None:
    facts = facts_of(text, verb, motion)
    places = [keys for keys, _ in figures_in(facts) if keys[-1] not in ("written", "reason")]  # null or words
    assert places and [keys for keys in places if declared_unit(facts, keys) is None] == []


@pytest.mark.parametrize("name", ["torque", "force", "stress-test", "error_case", "step", "time", "axes"])
def test_the_name_of_a_motion_decides_no_unit(name: str) -> None:
    plain = facts_of(LOADED, "run", None)
    named = facts_of(LOADED.replace("flight]", f"{name}]").replace('"flight"\narm', f'"{name}"\narm'), "run", None)
    assert name in named["motions"]
    units = {own_keys(keys): unit_at(plain, keys) for keys, _ in figures_in(plain) if keys[1] == "flight"}
    assert units == {own_keys(keys): unit_at(named, keys) for keys, _ in figures_in(named) if keys[1] == name}


@pytest.mark.parametrize(
    ("text", "verb", "figure", "unit"),
    [
        (LOADED, "run", "flight.tip.z.max_abs", "m"),
        (LOADED, "run", "flight.errors.loads.step", ""),
        (LOADED, "run", "flight.loads.stress.tension.station", "m"),
        (LOADED, "run", "flight.loads.yield_strength", "Pa"),
        (LOADED, "run", "flight.loads.margin.min", ""),
        (LOADED, "run", "spin_up", "s"),
        (LOADED, "run", "limits.arm.power.used", "W"),
        (LOADED, "run", "limits.arm.power.share", ""),
        (LOADED, "run", "limits.axis1.rate.time", "s"),
        (LOADED, "run", "verdict.stress", ""),
        (RISING, "run", "tracking_error.max", "m/s^2"),
        (RISING, "run", "spin.flight_error.max", "m/s^2"),
        (RISING, "run", "spin.flight_error.fraction", ""),
        (RISING, "run", "accounting.idle", "m/s^2"),
        (RISING, "run", "peaks.largest_load.machine", "m/s^2"),
        (RISING, "plan", "peaks.largest_load.time_machine", "s"),
        (RISING, "plan", "accounting.peaks[0].instant_error", ""),
        (RISING, "run", "fatigue.machine.largest_range", "Pa"),
        (RISING, "run", "comparisons.spin.load_difference.max_gradient.z", "1/s^2"),
        (RISING, "place", "smoothing", "s"),
        (RISING, "place", "options[0].largest_load.flight", "m/s^2"),
        (RISING, "place", "difference.best.tip", ""),
        (LOADED, "static", "flight.tip.z", "m"),
        (LOADED, "static", "flight.loads.stress[0]", "Pa"),
        (FREE_HUB, "run", "angle_end", "rad"),
        (FREE_HUB, "run", "slew.tip.y.residual_amplitude", "m"),
        (SLEWING, "critical-speed", "critical_speed", "rad/s"),
        (SLEWING, "critical-speed", "error_estimate", ""),
        (SLEWING, "modes", "modes[0].frequency", "Hz"),
    ],
)
def test_units(text: str, verb: str, figure: str, unit: str) -> None:
    facts = facts_of(text, verb, None)
    assert unit_at(facts, find(facts, figure)) == unit
