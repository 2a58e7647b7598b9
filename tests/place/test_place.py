"""On a uniform cantilever the best control points are those of theory: 1/2, 2/3, 0.7265 and 11/15 of the length."""

from __future__ import annotations

from typing import Any

import pytest

from gbeam import Beam, InputError, Material, Section
from gbeam.analysis.place import Candidate, place
from gbeam.cli.place import parse

SPECIMEN = Beam(0.3, Section.rectangle(0.02, 0.004), Material(2700.0, 70e9))


@pytest.mark.parametrize(
    ("measure", "fraction"),
    [("root-shear", 1 / 2), ("root-moment", 2 / 3), ("vibration", 0.726477), ("tip", 11 / 15)],
)
def test_best_control_point(
    structure: Any, flight: Any, spin: Any, settings: Any, measure: str, fraction: float
) -> None:
    found = place(structure, flight, [Candidate("upright", 0.0596, spin())], settings, {measure: 1.0})
    # Three shapes put the static tip of a linear load 2e-4 of the length off.
    assert found.fraction == pytest.approx(fraction, abs=3e-4 if measure == "tip" else 1e-5)
    assert (
        found.values["best"][measure] < 1e-4 * found.values["present"]["vibration" if measure != "vibration" else "tip"]
    )
    assert found.present == 0.15


def test_weighted_sum_lies_between(structure: Any, flight: Any, spin: Any, settings: Any) -> None:
    candidate = Candidate("upright", 0.0596, spin())
    found = place(structure, flight, [candidate], settings, {"root-shear": 1.0, "tip": 1.0})
    assert 0.5 - 1e-5 <= found.fraction <= 0.7334


def test_proof_shows_the_gain_over_mid_span(structure: Any, flight: Any, spin: Any, settings: Any) -> None:
    """theory.md A3: 0.0873 mm at mid-span, 0.0009 mm at 0.7265 L."""
    found = place(
        structure, flight, [Candidate("upright", 0.0596, spin())], settings, {"vibration": 1.0}, beam=SPECIMEN
    )
    proofs = {proof.name: proof for proof in found.proofs}
    # The corner's 0.0873 mm, and what the start on the ramp adds to it.
    assert 0.08e-3 < proofs["middle"].vibration < 0.2e-3
    assert found.vibration_gain > 50
    assert proofs["best"].tip_difference < proofs["middle"].tip_difference


def test_mirror_images_keep_the_scenario_and_smoothing_is_weighed(
    structure: Any, flight: Any, spin: Any, settings: Any
) -> None:
    options = [Candidate("upright", 0.0596, spin()), Candidate("inverted", 0.0596, spin(sign=-1))]
    found = place(structure, flight, options, settings, {"tip": 1.0})
    assert found.best.mounting == "upright"
    assert found.options[0].whole == pytest.approx(found.options[1].whole, rel=1e-6)
    options.append(Candidate("upright", 0.03, spin(0.03)))
    # With no lever left, rounding the corners less changes the load less.
    assert place(structure, flight, options, settings, {"tip": 1.0}).best.smoothing == 0.03


def test_refusals(structure: Any, flight: Any, spin: Any, settings: Any) -> None:
    with pytest.raises(InputError, match="choose of root-shear"):
        place(structure, flight, [], settings, {"tips": 1.0})
    with pytest.raises(InputError, match="no weight"):
        place(structure, flight, [], settings, {"tip": 0.0})
    with pytest.raises(InputError, match="weight 'x'"):
        parse("tip=x")
    assert parse("tip=2, root-moment") == {"tip": 2.0, "root-moment": 1.0}
