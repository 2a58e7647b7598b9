"""Modes followed through a true crossing, and the crossings with multiples of the speed."""

from __future__ import annotations

import numpy as np
import pytest

from gbeam import Flight, Hub, InputError, Model, assemble, campbell, constant, critical_speed_map, modes
from gbeam.results import json_of

from .beams import HUB, HUB_2009, beam_2009, slender


def test_a_true_crossing_is_followed():
    """Flap stiffens with speed and passes the chord, which is stiffer at rest and does not couple to it."""
    structure = assemble(slender(1e3, chord=2.0), Model("FOAM", 0, 4, 4))
    diagram = campbell(structure, HUB, end=12.0, count=24, modes=4, orders=(1, 5))
    assert diagram.direction == ("z", "y", "z", "y")
    gap = diagram.frequency[:, 1] - diagram.frequency[:, 0]
    assert gap[0] > 0 > gap[-1]
    assert diagram.mac.min() > 0.99
    # Each track alone, by the model that has its direction only.
    for track, counts in ((0, (0, 0, 4)), (1, (0, 4, 0))):
        alone = modes(
            assemble(slender(1e3, chord=2.0), Model("FOAM", *counts)), Hub(radius=0.0, rate=constant(12.0)), 0.0
        )
        assert diagram.frequency[-1, track] == pytest.approx(alone.frequency[0], rel=1e-9)


def test_engine_orders():
    structure = assemble(slender(1e3, chord=2.0), Model("FOAM", 0, 2, 4))
    diagram = campbell(structure, HUB, end=6.0, count=12, modes=2, orders=(2, 3))
    assert diagram.crossings
    for crossing in diagram.crossings:
        assert crossing.frequency == pytest.approx(crossing.order * crossing.speed / (2 * np.pi), rel=1e-12)
        spinning = modes(structure, Hub(radius=0.0, rate=constant(crossing.speed)), 0.0)
        assert np.abs(spinning.frequency / crossing.frequency - 1).min() < 1e-8


@pytest.mark.parametrize(("kind", "counts"), [("FOAM", (0, 2, 2)), ("TLAM", (0, 3, 3))])
def test_crossings_state_their_errors(kind, counts):
    """Against 20 shapes of FOAM, which is the exact model's linearisation about a beam that turns straight."""

    def speeds(model, shapes):
        structure = assemble(slender(1e3, chord=2.0), Model(model, *shapes))
        answer = campbell(structure, HUB, end=6.0, count=12, modes=3, orders=(1, 2))
        return answer, {(each.direction, each.order): each for each in answer.crossings}

    answer, few = speeds(kind, counts)
    _, many = speeds("FOAM", (0, 20, 20))
    alike = few.keys() & many.keys()
    assert len(alike) >= 3
    for key in alike:
        errors, true = few[key].errors, abs(few[key].speed / many[key].speed - 1)
        assert errors.slender == pytest.approx(true, rel=0.05, abs=1e-5)  # and the stretch
        assert (errors.model > errors.shapes) == (kind == "TLAM")
    assert any("the speed at which mode" in each for each in answer.warnings) == (kind == "TLAM")


def test_it_ends_at_the_critical_speed():
    structure = assemble(beam_2009(), Model("TLAM", 0, 3, 0))
    told: list[tuple[str, float]] = []
    diagram = campbell(structure, HUB_2009, end=5.0, count=10, modes=2, progress=lambda *news: told.append(news))
    assert told[1] == ("equilibrium, hub rate 0.07812 rad/s", 1 / 64)
    assert dict(told)["frequencies at 1.455 rad/s"] == pytest.approx(2.91074 / 2 / 5)
    assert diagram.critical is not None and diagram.critical.value == pytest.approx(2.91074, abs=1e-5)
    assert diagram.speed[-1] < diagram.critical.value and diagram.frequency[-1, 0] < 1e-2
    assert diagram.critical.errors.shapes < 1e-8  # without a mass the first shape is the mode
    assert json_of(diagram)["critical_speed_errors"]["shapes"] == diagram.critical.errors.shapes
    assert sum("TLAM's own" in each for each in diagram.warnings) == 1


def test_a_flight_has_none():
    structure = assemble(beam_2009(), Model("TLAM", 0, 3, 0))
    with pytest.raises(InputError, match="gbeam modes"):
        campbell(structure, Flight(z=constant(9.8)), end=5.0, name="flight")


def test_map_falls_with_mass_and_towards_the_tip():
    """2009 Fig. 9."""
    answer = critical_speed_map(beam_2009(), Model("TLAM", 0, 5, 0), HUB_2009, (0.1, 0.5), (2.0, 5.0, 8.0), 4.0)
    assert answer.speed[:, -1] == pytest.approx([2.6043, 1.9366], abs=1e-4)
    assert (np.diff(answer.speed, axis=1) < 0).all() and (np.diff(answer.speed, axis=0) < 0).all()
    many = critical_speed_map(beam_2009(), Model("TLAM", 0, 14, 0), HUB_2009, (0.1, 0.5), (2.0, 5.0, 8.0), 4.0)
    np.testing.assert_allclose(answer.errors.shapes, answer.speed / many.speed - 1, rtol=0.1, atol=1e-6)
    assert np.isinf(answer.errors.total).all()
