"""Modal damping: where it is needed, and what its ratio is of."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from gbeam import Beam, Flight, Hub, InputError, PointMass, assemble, linearize, modes, simulate, static

from ..calling import Answer, gbeam
from ..scenarios import FAST, FREE_HUB
from ..specimens import ALUMINIUM, HUB_INERTIA, HUB_RADIUS, LENGTH, STRIP, appendage

__all__ = ["gbeam"]

UNDAMPED = assemble(Beam(0.3, STRIP, ALUMINIUM), "FOAM", z=2)
FLIGHT = Flight(z=10.0)


@pytest.mark.parametrize(
    ("answer", "compute"),
    [
        ("the response", lambda: simulate(UNDAMPED, FLIGHT, duration=0.1)),
        ("the state-space model", lambda: linearize(UNDAMPED, FLIGHT)),
    ],
)
def test_what_depends_on_damping_needs_it(answer: str, compute: Callable[[], object]) -> None:
    with pytest.raises(InputError, match=f"beam.damping_ratio is missing, and {answer} depends on it; give"):
        compute()


def test_what_does_not_has_none() -> None:
    assert static(UNDAMPED, FLIGHT).tip[2] < 0
    vibration = modes(UNDAMPED)
    assert not vibration.damping_given and np.abs(vibration.damping_ratio).max() < 1e-12


def test_files_have_the_same_rule(gbeam: Callable[..., Answer], tmp_path: Path) -> None:
    file = tmp_path / "undamped.toml"
    file.write_text(FAST.replace("damping_ratio = 0.01\n", ""))
    for verb in ("check", "static"):
        assert gbeam(verb, file).status == 0
    assert "undamped: beam.damping_ratio is not given" in gbeam("modes", file, "--motion", "flight").out
    for verb in ("run", "place", "models"):
        answer = gbeam(verb, file)
        assert answer.status == 2 and answer.err.startswith(f"{file}:2:"), verb
        assert "beam.damping_ratio: is missing" in answer.err


@pytest.mark.parametrize("inertia", [HUB_INERTIA, 20.0])
def test_what_one_per_cent_means_on_a_free_hub(inertia: float) -> None:
    """With one shape ζ ω_free/ω_clamped: the hub takes part, C stays."""
    beam = appendage(PointMass(LENGTH, 0.5), damping_ratio=0.01)
    one, five = (assemble(beam, "FOAM", y=count) for count in (1, 5))
    hub = Hub(radius=HUB_RADIUS, inertia=inertia)
    clamped, free = modes(one), modes(one, hub)
    assert free.damping_ratio[0] == pytest.approx(0.01 * free.frequency[0] / clamped.frequency[0], rel=1e-9)
    several = modes(five, hub)
    if inertia == HUB_INERTIA:
        np.testing.assert_allclose(several.frequency[0], 0.361, atol=5e-4)
        np.testing.assert_allclose(several.damping_ratio[:2], [0.0117, 0.0101], atol=5e-5)


def test_the_summary_says_so(gbeam: Callable[..., Answer], tmp_path: Path) -> None:
    file = tmp_path / "hub.toml"
    file.write_text(FREE_HUB)
    answer = gbeam("run", file, "--set", "beam.damping_ratio=0.01", "--out", tmp_path / "out")
    assert "damping 1 % of critical, of the modes of the beam on a hub at rest" in answer.out
    assert "of critical" not in gbeam("run", file, "--out", tmp_path / "out").out
