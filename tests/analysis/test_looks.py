"""Times at which richer systems are read: where it matters, so that errors are those of all times."""

from __future__ import annotations

import numpy as np
import pytest

import gbeam as gb
from gbeam.analysis import Looks, highest, times_of_peaks
from gbeam.analysis.accuracy import looks
from gbeam.numerics import peak_difference

TIME = np.linspace(0.0, 10.0, 2001)


def ringing(frequency: float, start: float) -> np.ndarray:
    """A decaying vibration (t,) from a time on."""
    after = np.maximum(TIME - start, 0.0)
    return np.exp(-after) * np.sin(frequency * after)


def test_peaks_and_differences_are_those_of_all_times() -> None:
    force = np.stack([ringing(9.0, 1.0), 0.5 * ringing(31.0, 4.0), np.zeros_like(TIME)], axis=1)
    departure = 0.01 * np.stack([ringing(25.0, 6.0), 0 * TIME, ringing(9.0, 1.0)], axis=1)
    near = times_of_peaks(TIME, {("rod", "force"): force})
    chosen = Looks.chosen(TIME, near, 0.0, np.linalg.norm(departure, axis=1)[:, None])
    assert len(chosen.at) < 0.3 * len(TIME)
    other, size = force + departure, np.linalg.norm(departure, axis=1)
    assert size[chosen.at].max() == size.max()
    expected = peak_difference(TIME, force, other)
    assert chosen.peak_difference(force[chosen.at], other[chosen.at]) == pytest.approx(expected, rel=1e-6)


def test_all_of_few_times_are_looked_at() -> None:
    few = TIME[: looks.FEW]
    assert len(Looks.chosen(few, few[:0], 0.0, np.zeros((len(few), 1))).at) == len(few)


def test_windows_are_wide_enough_for_peaks_that_were_found_at_coarser_times() -> None:
    history, coarse = ringing(9.0, 1.0)[:, None], slice(None, None, 10)
    near = TIME[coarse][highest(history[coarse], 1)]
    chosen = Looks.chosen(TIME, near, TIME[10], np.zeros((len(TIME), 1)))
    assert history[chosen.at[chosen.windows]].max() == history.max()


def test_highest_are_local_maxima_of_each_column() -> None:
    columns = np.array([[0.0, 5.0], [2.0, 1.0], [1.0, 4.0], [3.0, 4.0], [0.0, 0.0]])
    np.testing.assert_array_equal(highest(columns, 1), [0, 3])
    np.testing.assert_array_equal(highest(columns, 2), [0, 1, 2, 3])


@pytest.mark.parametrize("kind", ["FOAM", "exact"])
def test_stated_errors_are_those_of_all_times(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A strip that corners of its load make ring, read where it matters and at all times."""
    strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    structure = gb.assemble(beam, kind, axial=1, y=1, z=2)
    turn = gb.Flight(z=gb.trapezoid(78.5, jerk=390.0, start=0.1, hold=0.4), y=gb.Sine(3.0, 0.7))

    def stated() -> list[float]:
        errors = gb.simulate(structure, turn, duration=1.5, step=1e-3).errors
        return [
            getattr(error, cause)
            for error in (errors.displacement, errors.loads, errors.stress)
            for cause in ("shapes", "model", "beam_theory", "total")
        ] + [errors.loads.peak, errors.stress.peak]

    chosen = stated()
    monkeypatch.setattr(looks, "FEW", 1_000_000)
    np.testing.assert_allclose(chosen, stated(), rtol=0.01)
