"""Normal stress over sections, against the stress at every point of their boundaries."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.constants import g as STANDARD_GRAVITY

from gbeam import Flight, Section, assemble, compare, simulate, static
from gbeam.structure import extreme_stresses, worst_fibres

from ..calling import Answer, gbeam
from ..scenarios import FAST, response
from ..specimens import strip_beam

__all__ = ["gbeam"]

ANGLE = np.linspace(0, 2 * np.pi, 7201)
ROUND = np.cos(ANGLE), np.sin(ANGLE)
CORNERS = np.array([1, 1, -1, -1]), np.array([1, -1, 1, -1])
SECTIONS = {
    "rectangle": (Section.rectangle(0.02, 0.004), 0.01, 0.002, CORNERS),
    "circle": (Section.circle(0.01), 0.005, 0.005, ROUND),
    "tube": (Section.tube(0.012, 0.001), 0.006, 0.006, ROUND),
    "general": (
        Section.general(8e-5, 1e-10, 2e-9, extreme_fibre_y=0.011, extreme_fibre_z=0.003),
        0.011,
        0.003,
        CORNERS,
    ),
}


@pytest.mark.parametrize("shape", SECTIONS)
def test_extremes_are_those_of_the_boundary(shape: str) -> None:
    section, c_y, c_z, (y, z) = SECTIONS[shape]
    values = section.at(np.zeros(1))
    rng = np.random.default_rng(2)
    force, moment = rng.normal(size=(50, 1, 3)) * 300, rng.normal(size=(50, 1, 3))
    bent = moment[:, 0, 1, None] * z * c_z / values.inertia_y - moment[:, 0, 2, None] * y * c_y / values.inertia_z
    everywhere = force[:, 0, 0, None] / values.area + bent
    tension, compression = extreme_stresses(values, force, moment)
    np.testing.assert_allclose(tension[:, 0], everywhere.max(axis=1), atol=1e-6 * tension.max())
    np.testing.assert_allclose(compression[:, 0], everywhere.min(axis=1), atol=1e-6 * tension.max())


def test_a_round_section_bent_both_ways_is_bent_once() -> None:
    """√2 of the stress of one moment, and not twice it."""
    values = Section.circle(0.01).at(np.zeros(1))
    one, both = (extreme_stresses(values, np.zeros((1, 3)), np.array([[0, 1.25, m]]))[0] for m in (0.0, 1.25))
    np.testing.assert_allclose(both, np.sqrt(2) * one)
    np.testing.assert_allclose(one, 32 * 1.25 / (np.pi * 0.01**3))
    np.testing.assert_allclose(1e-6 * both, 18.01, atol=5e-3)  # and not 25.46


@pytest.mark.parametrize("shape", ["rectangle", "tube"])
def test_the_worst_fibre_ranges_as_far_as_any(shape: str) -> None:
    section, c_y, c_z, (y, z) = SECTIONS[shape]
    values = section.at(np.zeros(2))
    rng = np.random.default_rng(3)
    force, moment = rng.normal(size=(40, 2, 3)) * 100, rng.normal(size=(40, 2, 3))
    bent = moment[:, 1, 1, None] * z * c_z / values.inertia_y[1] - moment[:, 1, 2, None] * y * c_y / values.inertia_z[1]
    ranges = np.ptp(force[:, 1, 0, None] / values.area[1] + bent, axis=0)
    answer = np.ptp(worst_fibres(values, force, moment)[:, 1])
    assert 0.99 * ranges.max() <= answer <= ranges.max() * (1 + 1e-9)


def test_a_specimen_pushed_along_x_says_so_everywhere(gbeam: Callable[..., Answer], tmp_path: Path) -> None:
    """1000 g on 64.8 g: 635 N on 80 mm², −7.94 MPa, in the result, static, the summary, JSON and the comparison."""
    push, root = 1000 * STANDARD_GRAVITY, 2700 * 8e-5 * 0.3 * 1000 * STANDARD_GRAVITY
    assert root == pytest.approx(635.5, abs=0.1)
    structure = assemble(strip_beam(damping_ratio=0.0), "FOAM", axial=3, z=1)
    still = static(structure, acceleration=(push, 0, 0)).loads
    assert still is not None and still.root_force[0, 0] == pytest.approx(root, rel=1e-6)
    for loads in (still, simulate(structure, Flight(x=push), duration=0.01, step=1e-4).loads):
        assert loads is not None
        np.testing.assert_allclose([loads.stress_compression[0, 0], loads.stress[0, 0]], [-root / 8e-5, root / 8e-5])
    file = tmp_path / "push.toml"
    file.write_text(
        FAST.replace("z = {", "x = {").replace('"6 g"', '"1000 g"').partition("[motion.spin]")[0]
        + response("10 ms", step="0.1 ms"),
        encoding="utf-8",
    )
    for answer, place in ((gbeam("static", file), ", 0 m"), (gbeam("run", file, "--out", tmp_path), " at 0 m")):
        assert "-7.943 to" in answer.out and f"compression{place}" in answer.out
    facts = gbeam("run", file, "--json").json["motions"]["flight"]["bodies"]["beam"]["loads"]
    assert facts["stress"]["compression"]["min"] == pytest.approx(-7.943e6, rel=1e-3)
    assert facts["sections"][0]["compression"] == pytest.approx(-7.943e6, rel=1e-3)
    assert facts["root_force"]["x"]["max_abs"] == pytest.approx(root, rel=1e-6)
    pushed = simulate(structure, Flight(x=push), duration=0.01, step=1e-4)
    assert compare(pushed, pushed).peaks["stress"].flight == pytest.approx(root / 8e-5, rel=1e-6)
