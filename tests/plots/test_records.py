"""Figures of records: what was read, over what is flown, and a file with the parts that are flown of it."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gbeam as gb
from gbeam.figures import Figure, figures_of
from gbeam.plots import plot
from gbeam.results import Description

EXAMPLES = Path(__file__).parents[2] / "examples"
CAMPAIGN, F16 = EXAMPLES / "campaign.toml", EXAMPLES / "f16_8g_turn.toml"
G = 9.80665


def described(path: Path, *overrides: str) -> dict[str, Figure]:
    description = gb.describe(gb.read_scenario(path, overrides))
    return {name: describe() for name, describe in figures_of(description).items()}


@pytest.fixture(scope="module")
def campaign() -> dict[str, Figure]:
    return described(CAMPAIGN)


def table(path: Path) -> Any:
    return np.genfromtxt(path, delimiter=",", names=True)


def test_a_campaign_has_a_figure_of_its_file_and_one_of_each_flight(campaign: dict[str, Figure]) -> None:
    assert [*campaign] == ["file turn", "record turn", "record pull", "record push"]
    assert [*described(F16)] == ["record flight"]  # of a file that is flown whole there is one
    assert [*described(F16, "motion.flight.record.to=9 s")] == ["file flight", "record flight"]


def test_what_was_read_is_what_the_file_holds(campaign: dict[str, Figure]) -> None:
    """In the file's own axes and units: signs and units of the keys are undone."""
    held = table(EXAMPLES / "data" / "campaign.csv")
    whole = campaign["file turn"].panels
    assert [panel.y for panel in whole] == ["as read, g", "as read, rad/s"]
    for panel in whole:
        for line in panel.lines:
            np.testing.assert_array_equal(line.x, held["time_s"])
            np.testing.assert_allclose(line.y, held[line.label], rtol=0, atol=1e-15)
    part = held[held["event"] == 2]
    read = campaign["record pull"].panels[0]
    assert [line.label for line in read.lines] == ["n_x_g", "n_y_g", "n_z_g"]
    for line in read.lines:
        np.testing.assert_array_equal(line.x, part["time_s"])
        np.testing.assert_allclose(line.y, part[line.label], rtol=0, atol=1e-15)


def test_what_is_flown_is_what_the_flight_gives_the_specimen() -> None:
    """With turn, arm, level factor and cut-off, against the motion itself; rates in deg/s."""
    keys = ['turn=["0 deg", "5 deg", 0]', 'arm=["0.3 m", 0, "-0.1 m"]', "cutoff=5 Hz", "resample=200 Hz"]
    turning = ["p=p_rad_s", "q=-q_rad_s", "r=-r_rad_s", "rate_unit=rad/s"]
    changes = [f"motion.flight.record.{each}" for each in (*keys, *turning)] + ["motion.flight.scale=1.25"]
    figure = described(F16, *changes)["record flight"]
    assert [panel.y for panel in figure.panels] == ["as read, g", "flown, g", "as read, rad/s", "flown, deg/s"]
    flight = gb.read_scenario(F16, changes).motions["flight"]
    loads, rates = figure.panels[1].lines, figure.panels[3].lines
    base = flight.base(loads[0].x[10:-10])
    for i, line in enumerate(loads):
        np.testing.assert_allclose(line.y[10:-10] * G, np.asarray(base.a_WO_B)[:, i], atol=1e-9)
    for i, line in enumerate(rates):  # which are flown rounded over four samples
        np.testing.assert_allclose(np.radians(line.y[10:-10]), np.asarray(base.w_WB_B)[:, i], atol=0.02)
    assert (
        "low-pass at 5 Hz, zero phase" in figure.notes
        and "accelerations × 1.25, rates as they are recorded" in figure.notes
    )


def test_parts_rests_and_lost_samples_are_marked(campaign: dict[str, Figure], tmp_path: Path) -> None:
    first, other = campaign["file turn"].panels
    spans = [("flown", 8, 18), ("flown", 20, 27.5), ("flown", 28, 43.5), ("at rest", 0, 5), ("at rest", 47, 52)]
    assert [(reason, start, end) for start, end, reason in first.spans] == spans and other.spans == first.spans
    assert [(x, words) for x, _, words in first.texts] == [(13, "turn"), (23.75, "pull"), (35.75, "push")]
    assert first.limits is not None
    highest = max(line.y.max() for line in first.lines)
    assert all(highest < y < first.limits[1] for _, y, _ in first.texts)  # above all lines
    assert not campaign["record push"].panels[0].spans
    lines = (EXAMPLES / "data" / "f16_8g_turn.csv").read_text(encoding="utf-8").split("\n")
    (tmp_path / "holed.csv").write_text("\n".join([*lines[:300], *lines[310:]]), encoding="utf-8")
    keys = [f"file={tmp_path / 'holed.csv'}", "bridge=200 ms", "resample=100 Hz"]
    figure = described(F16, *(f"motion.flight.record.{each}" for each in keys))["record flight"]
    ((start, end, reason),) = figure.panels[0].spans
    assert reason == "lost samples" and (start, end) == pytest.approx((2.98, 3.09))


def test_a_level_stretch_outside_the_part_is_marked_on_the_file_alone(tmp_path: Path) -> None:
    keys = ['level=["0 s", "4 s"]', "rest=[]", "from=20 s", "to=26 s", "section=2"]
    changes = [f"motion.turn.record.{each}" for each in keys]
    figures = described(CAMPAIGN, *changes)
    assert ("level", 0, 4) in [(reason, start, end) for start, end, reason in figures["file turn"].panels[0].spans]
    assert not figures["record turn"].panels[0].spans
    assert figures["record turn"].panels[0].lines[0].x[[0, -1]].tolist() == [20, 26]


def test_names_of_many_parts_do_not_lie_on_one_another(campaign: dict[str, Figure]) -> None:
    """Eleven parts of 0.5 s of 52 s that touch: their names stand in rows, and a hairline is between them."""
    parts = [f'motion.part{k}={{kind="flight", record={{of="turn", from="{8 + k / 2} s", to="{8.5 + k / 2} s"}}}}'
             for k in range(11)]  # fmt: skip
    figure = described(CAMPAIGN, *parts, "response.tolerance=0.02")["file turn"]
    (first, _), width = figure.panels, 52.0
    places = [(x, y, len(name)) for x, y, name in first.texts]
    for k, (x, y, letters) in enumerate(places):
        for other, beside, others in places[:k]:
            assert y != beside or abs(x - other) > 0.009 * width * (letters + others) / 2
    left_out = 14 - len(places)
    assert figure.notes == ((f"{left_out} names of parts are left out for want of room",) if left_out else ())
    shaded = sorted((a, b) for a, b, reason in first.spans if reason == "flown" and b - a < 1)
    assert all(0.1 < b[0] - a[1] < 0.2 for a, b in pairwise(shaded))


def test_holes_outside_a_part_stay_holes(tmp_path: Path) -> None:
    lines = (EXAMPLES / "data" / "f16_8g_turn.csv").read_text(encoding="utf-8").split("\n")
    lines[1501] = "15,nan,nan,nan" + "," * 7
    (tmp_path / "holed.csv").write_text("\n".join(lines), encoding="utf-8")
    keys = [f"file={tmp_path / 'holed.csv'}", "to=9 s"]
    changes = [f"motion.flight.record.{each}" for each in keys]
    figure = described(F16, *changes)["file flight"]
    assert np.isnan(figure.panels[0].lines[0].y[1500]) and figure.panels[0].limits is not None
    description = gb.describe(gb.read_scenario(F16, changes))
    assert len(plot(description, "file flight")) == 1


def test_a_description_without_records_has_no_figures() -> None:
    description = gb.describe(gb.read_scenario(EXAMPLES / "hubbeam2009_slew_3.toml"))
    assert isinstance(description, Description) and figures_of(description) == {}
