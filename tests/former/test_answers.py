"""Answers of today are those of 0.3.0.dev0, when one structure and a system of bodies were computed apart."""

from __future__ import annotations

import numpy as np
import pytest

from tests.former.answers import Answers, answers, recorded
from tests.former.cases import INTEGRATORS, MODELS, MOTIONS, QUESTIONS, SPECIMENS, case

EVERY = 3  # of the seeds, one in so many is tried by every run of the tests, the others by `make thorough`
# Of these the seeds that repeat others: a specimen on a motion, a model, an integrator, a question and its refusal.
REPEATED = {*range(0, 24, EVERY), 27, 45, 51, 171, 177, 180, 183, 186, 189, 195}
EQUAL, ALIKE = 1e-9, 1e-2  # answers, and stated errors
PEAKS = {"tip_peaks", "root", "stress"}  # between samples: of two neighbours nearly as large either may be looked at
NEXT = 3e-5  # difference of the two
# The condition of a mesh's stiffness multiplies rounding, which is another one on another processor; and of points that
# are equally stressed it chooses those whose stress is followed, by whose error that of steps changes.
MESHED, FOLLOWED = 1e-6, 0.5
SLIGHT = 1e-7  # a stated error below is that of rounding
# Differences that are faults of what was, of stated errors by the theory of slender beams. Thick beams were linearised
# about straight ones, which leaves out the twist that bending couples to, see tests of bent strips;
# and where fast modes ring, they were read at the coarser times of a first look. They change by 18 % at most.
# Rounding in the torque of a beam that does not twist kept the peak of its stress between two samples from being seen.
# The least number of steps was 502 for 500 where a quotient was rounded up; so were its multiples.
FAULTS = {seed: {"errors"} for seed in (7, 56, 76, 77, 105, 132)}
FAULTS |= {seed: {"steps", "tip", "root", "stress", "errors"} for seed in (21, 32, 102, 152, 190)}
# Rounding decides whether a polynomial through seven samples of steps that ring converges, whose vertex is 2 % higher.
FAULTS |= {185: {"root"}}


def apart(before: Answers, now: Answers) -> list[str]:
    """Names of what is not as it was."""
    names = [name for name in before.keys() | now.keys() if (before.get(name) is None) != (now.get(name) is None)]
    solid = before["model"] == "solid"
    for name in before.keys() & now.keys():
        one, other = before[name], now[name]
        if not isinstance(one, list):
            names += [name] if one != other else []
            continue
        was, is_now = (np.array(each, dtype=float) for each in (one, other))
        equal = NEXT if name in PEAKS else MESHED if solid else EQUAL
        close, size = (equal, equal * np.nanmax(np.abs(was), initial=0.0))
        if "errors" in name:
            close, size = np.array([ALIKE, ALIKE, FOLLOWED]) if solid and name == "errors" else ALIKE, SLIGHT
        same = was.shape == is_now.shape and np.isclose(is_now, was, rtol=close, atol=size, equal_nan=True).all()
        names += [] if same else [name]
    return sorted(names)


def often(seed: int) -> bool:
    return seed % EVERY == 0 and seed not in REPEATED


@pytest.mark.parametrize(
    "before",
    [
        pytest.param(before, id=f"{before['seed']}", marks=() if often(before["seed"]) else pytest.mark.thorough)
        for before in recorded()
    ],
)
def test_it_is_as_it_was(before: Answers) -> None:
    assert set(apart(before, answers(before["seed"]))) <= FAULTS.get(before["seed"], set())


def test_every_kind_is_among_those_that_are_tried_often() -> None:
    """Specimens on every motion, models, integrators, steps and beginnings, and answers and refusals of questions."""
    tried = [(before, case(before["seed"])) for before in recorded() if often(before["seed"])]
    motions = [(of.kind, MOTIONS[before["seed"] // len(SPECIMENS) % len(MOTIONS)]) for before, of in tried]
    assert len(set(motions)) == len(SPECIMENS) * len(MOTIONS)
    assert {of.structure.kind for _, of in tried} == {*MODELS, "matrices", "rigid", "solid"}
    assert {of.settings.integrator for _, of in tried} == set(INTEGRATORS)
    assert {of.settings.step is None for _, of in tried} == {True, False}
    assert {before["question"] for before, _ in tried if "refused" not in before} == set(QUESTIONS)
    assert {before["question"] for before, _ in tried if "refused" in before} == {"static", "modes", "critical"}
    assert {before["found"] for before, _ in tried if "found" in before} == {"done"}


def test_a_difference_is_seen() -> None:
    before = recorded()[0]
    assert apart(before, before | {"tip": [each * (1 + 1e-8) for each in before["tip"]]}) == ["tip"]
    assert apart(before, before | {"errors": [each * 1.02 for each in before["errors"]]}) == ["errors"]
    assert apart(before, before | {"steps": before["steps"] + 1}) == ["steps"]
