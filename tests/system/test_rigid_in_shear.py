"""Errors that a system of beams states of shear and twist, beside the models that have them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import gbeam as gb

SECTION = gb.Section.rectangle(0.02, 0.015)
UNKNOWN = gb.Material(2700.0, 70e9)
KNOWN = gb.Material(2700.0, 70e9, poissons_ratio=0.3)


def bracket(material: gb.Material, *, thick: bool, gravity: float = 0.0) -> gb.System:
    """Two beams at a right angle: the first is twisted by what hangs on it."""
    strained: dict[str, Any] = {"twist": 3, "shear_y": 3, "shear_z": 3} if thick else {}
    leg = gb.assemble(gb.Beam(0.15, SECTION, material, damping_ratio=0.01), "exact", axial=1, y=4, z=5, **strained)
    corner = gb.Joint("fixed", "arm", "foot.tip", turn=(0, 0, np.pi / 2))
    joints = {"clamp": gb.Joint("fixed", "foot"), "corner": corner}
    return gb.System({"foot": leg, "arm": leg}, joints, gravity=(0.0, 0.0, -gravity))


@pytest.mark.parametrize("material", [UNKNOWN, KNOWN], ids=["by an assumed ratio", "by its own ratio"])
def test_places_at_rest_state_what_twist_and_shear_add(material: gb.Material) -> None:
    rigid = gb.static(bracket(material, thick=False, gravity=9.81))
    thick = gb.static(bracket(KNOWN, thick=True, gravity=9.81))
    moved = np.linalg.norm(thick.point_displacement - rigid.point_displacement, axis=-1).max()
    true = moved / np.linalg.norm(rigid.point_displacement, axis=-1).max()
    assert true > 1  # the arm goes down more by the foot's twist than by bending
    assert rigid.errors.place.beam_theory == pytest.approx(true, rel=1e-5)
    assert rigid.errors.theory[0].startswith("twist") and ("assumed" in rigid.errors.theory[0]) == (material is UNKNOWN)


def test_frequencies_state_what_twist_and_shear_take() -> None:
    rigid = gb.modes(bracket(UNKNOWN, thick=False))
    true = gb.modes(bracket(KNOWN, thick=True), errors=False).frequency
    # Bending in the bracket's plane, which shears alone, and out of it, which twists the foot.
    pairs = {0: 0, 1: 1, 2: 3, 3: 2}
    expected = [rigid.frequency[one] / true[other] - 1 for one, other in pairs.items()]
    assert rigid.errors is not None
    np.testing.assert_allclose(rigid.errors.beam_theory[:4], expected, rtol=1e-3)
    assert max(expected) > 0.6 and min(expected) < 3e-3
    assert rigid.errors.theory == "twist; assumed: Poisson's ratio 0.3"


def test_a_system_of_one_beam_states_of_its_frequencies_what_the_beam_does() -> None:
    beam = gb.Beam(0.3, gb.Section.rectangle(0.03, 0.03), KNOWN, damping_ratio=0.01, rotary_inertia=False)
    structure = gb.assemble(beam, "FOAM", axial=1, y=3, z=3)
    alone, inside = (
        gb.modes(each) for each in (structure, gb.System({"beam": structure}, {"clamp": gb.Joint("fixed", "beam")}))
    )
    assert alone.errors is not None and inside.errors is not None
    np.testing.assert_allclose(inside.errors.beam_theory, alone.errors.beam_theory, rtol=1e-6, atol=1e-12)
    np.testing.assert_allclose(inside.errors.unseen, alone.errors.unseen, rtol=1e-6)
    assert inside.errors.theory == alone.errors.theory != ("",)
