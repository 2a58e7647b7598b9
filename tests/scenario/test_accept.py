"""[motion.NAME.accept]: shares with their names, and nothing else."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from gbeam.scenario import ScenarioError, build, loads

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
    assert set(case.accept["spin"]) == {"tip", "peaks", "spread", "followed", "tolerance"}


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ('tips = "2 %"', "motion.spin.accept.tips"),
        ('tip = "-2 %"', "is negative"),
        ('tip = "2 mm"', "ratio"),
        ('followed = "120 %"', "more than all of the time"),
    ],
)
def test_what_is_wrong_is_named(line: str, message: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        loads(with_accept(line))
    assert message in str(caught.value)
