"""Motions and structures as values: made twice they are equal, and they go to other processes."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import jax
import numpy as np
import pytest

import gbeam.arrays.jax_setup  # noqa: F401
from gbeam import Centrifuge, Flight, Hub, Model, Sine, SmoothStep, Sum, assemble, constant, modes, static, trapezoid
from gbeam.results import Base

from ..specimens import strip_beam

MOTIONS: dict[str, Callable[[float], Any]] = {
    "hub": lambda x: Hub(radius=0.5, rate=SmoothStep(x, 2.0)),
    "hub at a rate": lambda x: Hub(radius=0.5, rate=x),
    "free hub": lambda x: Hub(radius=0.5, inertia=3.0, torque=Sine(x, 2.0)),
    "flight": lambda x: Flight(y=x, z=Sum((constant(2.0), trapezoid(1.0, jerk=10.0, start=0.5, hold=9.0)))),
    "machine": lambda x: Centrifuge(Flight(z=x), arm=3.3, control_point=0.1, gravity=False),
    "base": lambda x: Base(np.array([x, 0.0, np.nan]), np.zeros(3), np.zeros(3)),
}


@pytest.mark.parametrize("name", MOTIONS)
def test_motions_are_equal_where_their_values_are(name: str) -> None:
    of = MOTIONS[name]
    assert of(2.0) == of(2.0) and hash(of(2.0)) == hash(of(2.0))
    assert of(2.0) != of(2.5) and of(2.0) != 2.0
    assert pickle.loads(pickle.dumps(of(2.0))) == of(2.0)


def test_what_jax_traces_is_like_itself_alone() -> None:
    def answers(x: Any) -> Any:
        held = Base(x, np.zeros(3), np.zeros(3))
        assert held == held and held == replace(held) and held != Base(2.0 * x, np.zeros(3), np.zeros(3))
        return x

    jax.jit(answers)(np.ones(3))


@pytest.mark.parametrize("kind", ["TLAM", "FOAM", "CFOAM", "fourth-order", "exact"])
def test_structures_are_pickled_after_they_were_used(kind: str) -> None:
    structure = assemble(strip_beam(), Model(kind, int(kind in ("CFOAM", "exact")), 0, 2))
    before = modes(structure), static(structure, acceleration=(0.0, 0.0, 5.0)), structure.rest
    again = pickle.loads(pickle.dumps(structure))
    assert set(vars(again)) == set(structure.__dataclass_fields__)  # and nothing that analyses have kept
    np.testing.assert_array_equal(modes(again).frequency, before[0].frequency)
    np.testing.assert_array_equal(static(again, acceleration=(0.0, 0.0, 5.0)).tip, before[1].tip)
