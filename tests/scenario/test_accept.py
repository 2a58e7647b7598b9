"""[motion.NAME.accept]: shares with their names, and nothing else."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from gbeam.results import RULES, SETTINGS
from gbeam.scenario import Accept, ScenarioError, build, loads

from ..scenarios import FAST


def with_accept(lines: str) -> str:
    return FAST + f"[motion.spin.accept]\n{lines}\n"


def test_what_is_given_reaches_the_case() -> None:
    case = build(loads(with_accept('tip = "2 %"\npeaks = 0.03\nfollowed = "70 %"\ntolerance = "3 %"')))
    assert case.accept == {"spin": pytest.approx({"tip": 0.02, "peaks": 0.03, "followed": 0.7, "tolerance": 0.03})}
    assert build(loads(FAST)).accept == {}


def test_the_table_in_the_documents() -> None:
    page = Path(__file__).parents[2] / "docs" / "verdict.md"
    (block,) = re.findall(r"```toml\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
    case = build(loads(FAST + block.replace("motion.centrifuge", "motion.spin")))
    assert list(case.accept["spin"]) == [*RULES, *SETTINGS]


def test_the_schema_has_every_criterion_and_nothing_else() -> None:
    assert list(Accept.model_fields) == [*RULES, *SETTINGS]
    assert all(Accept.model_fields[name].description == rule.words for name, rule in RULES.items())


def test_levels_are_ratios_in_decibels() -> None:
    case = build(loads(with_accept('srs = ["-1.5 dB", "3 dB"]\ndamage = 2')))
    assert case.accept["spin"] == {"srs": pytest.approx((10**-0.075, 10**0.15)), "damage": 2.0}
    assert build(loads(with_accept('srs = "6 dB"'))).accept["spin"]["srs"] == pytest.approx(10**0.3)
    assert build(loads(with_accept("srs = 1.4"))).accept["spin"]["srs"] == 1.4
    assert build(loads(with_accept('tolerance_of = "instant"'))).accept["spin"] == {"tolerance_of": "instant"}


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ('tips = "2 %"', "motion.spin.accept.tips"),
        ('tip = "-2 %"', "is negative"),
        ('tip = "2 mm"', "ratio"),
        ('followed = "120 %"', "motion.spin.accept.followed: is 120 %, more than all of it"),
        ('largest_load = "3 dB"', "unknown unit 'dB'"),
        ("srs = 0.5", "motion.spin.accept.srs: is 0.5, and not above 1"),
        ('srs = ["1 dB", "3 dB"]', "without 1 in between"),
        ("damage = [0.5, 1.5, 2]", "has 3 entries"),
        ('srs = "3 mm"', "ratio of amplitudes"),
        ('tolerance_of = "time"', "peak, instant"),
    ],
)
def test_what_is_wrong_is_named(line: str, message: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        build(loads(with_accept(line)))
    assert message in str(caught.value)
