"""The deliberate errors of `make mutants` still fit the source and name tests that exist; one is judged here."""

from __future__ import annotations

from pathlib import Path

import pytest

from mutants.mutant import CAUGHT, SOURCE, Mutant, judge, mutants

ROOT = Path(__file__).parents[1]
ALL = mutants()


def test_there_are_enough_and_no_two_are_the_same() -> None:
    assert len(ALL) >= 24 and len({each.name for each in ALL}) == len(ALL)


@pytest.mark.parametrize("mutant", ALL, ids=lambda each: each.name)
def test_its_text_stands_once_in_the_source_and_its_tests_exist(mutant: Mutant) -> None:
    text = (SOURCE / mutant.file).read_text(encoding="utf-8")
    compile(mutant.mutated(text), mutant.file, "exec")
    for test in mutant.tests:
        path, _, name = test.partition("::")
        assert not name or f"def {name}(" in (ROOT / path).read_text(encoding="utf-8")


def test_a_text_that_is_not_there_or_twice_is_refused() -> None:
    mutant = Mutant("typo", "x.py", "a + b", "a - b", ())
    for text in ("a * b", "a + b + a + b"):
        with pytest.raises(ValueError, match="typo"):
            mutant.mutated(text)


def test_the_tests_catch_one() -> None:
    verdict = judge(next(each for each in ALL if each.name == "stress of a round section, sum of both moments"))
    assert (verdict.outcome, verdict.by.partition("[")[0]) == (
        CAUGHT,
        "structure/test_stress.py::test_extremes_are_those_of_the_boundary",
    )
