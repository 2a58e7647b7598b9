"""Responses that begin elsewhere than in equilibrium, against closed forms."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gbeam import Flight, Hub, Initial, InputError, Response, Structure, System, modes, simulate, static
from gbeam.analysis import starting_point

from ..calling import Answer, gbeam
from ..scenarios import FAST
from ..specimens import HUB_INERTIA, HUB_RADIUS, STRIP_LENGTH, hub_beam, strip

__all__ = ["gbeam"]

REST = Flight(z=0.0)


def run(structure: Structure, motion: Any = REST, duration: float = 0.1, **more: Any) -> Response:
    response = simulate(structure, motion, duration=duration, step=2e-5, integrator="gauss", **more)
    assert response.outcome == "done"
    return response


def test_an_undeformed_start_overshoots_to_twice_the_static_deflection() -> None:
    """One undamped shape under a constant acceleration: u (1 − cos ωt)."""
    one, flight = strip(z=1), Flight(z=50.0)
    still, period = static(one, flight).tip[2], 1 / modes(one).frequency[0]
    response = run(one, flight, initial="undeformed")
    np.testing.assert_allclose(response.tip[:, 2], still * (1 - np.cos(2 * np.pi * response.time / period)), atol=1e-9)
    assert response.peaks.max_abs[2] == pytest.approx(2 * abs(still), rel=1e-9)
    assert response.initial == "begins undeformed, at rest"
    settled = run(one, flight)
    np.testing.assert_allclose(settled.tip[:, 2], still, rtol=1e-12)
    assert settled.initial == "begins in relative equilibrium, at rest"


def test_a_released_static_deflection_rings_at_the_first_frequencies() -> None:
    """Σ ±4σ/(λ ω²) a cos ωt, the cantilever's modes in the deflection wL⁴/8EI by a uniform load (Blevins)."""
    two, a = strip(z=2), 2 * 9.80665
    response = run(two, initial=Initial(acceleration=(0.0, 0.0, a)))
    eigenvalue, sigma, sign = np.array([[1.875104069, 4.694091133], [0.734095514, 1.018467319], [1, -1]])
    inertia, area = 0.02 * 0.004**3 / 12, 0.02 * 0.004
    omega = eigenvalue**2 * np.sqrt(70e9 * inertia / (2700 * area * STRIP_LENGTH**4))
    amplitude = sign * 4 * sigma / (eigenvalue * omega**2) * a
    tip = -(amplitude * np.cos(np.outer(response.time, omega))).sum(axis=1)
    np.testing.assert_allclose(response.tip[:, 2], tip, atol=1e-7 * np.abs(tip).max())
    uniform = 2700 * area * a * STRIP_LENGTH**4 / (8 * 70e9 * inertia)
    assert abs(response.tip[0, 2]) == pytest.approx(uniform, rel=1e-3)  # to what two shapes have of it


def test_a_tip_drawn_aside_has_the_shape_of_a_force_there() -> None:
    """x²(3L − x)/2L³ of the tip's, but for what the shapes lack."""
    from gbeam import assemble

    from ..specimens import strip_beam

    many = assemble(strip_beam(damping_ratio=0.0), "FOAM", z=8, y=1, stations=[0.1, 0.2])
    response = run(many, duration=0.001, initial=Initial(tip_displacement={"z": 3e-3}))
    x = np.array([0.1, 0.2, 0.3]) / STRIP_LENGTH
    np.testing.assert_allclose(response.displacement[0, :, 2], 3e-3 * x**2 * (3 - x) / 2, rtol=2e-4)
    assert not response.displacement[0, :, 1].any()  # free, and not moved
    np.testing.assert_allclose(response.qd[0], 0, atol=1e-15)
    assert response.initial == "begins with its tip displaced by z 3 mm, as by a force there, at rest"


def test_a_tip_velocity_rings_with_its_amplitude_over_the_frequency() -> None:
    one = strip(z=1)
    response = run(one, initial=Initial(tip_velocity={"z": 0.2}))
    omega = 2 * np.pi * modes(one).frequency[0]
    np.testing.assert_allclose(response.tip[:, 2], 0.2 / omega * np.sin(omega * response.time), atol=1e-9)


@pytest.mark.parametrize("kind", ["FOAM", "exact"])
def test_large_displacements_are_those_of_the_tip(kind: str) -> None:
    structure = hub_beam(kind)
    initial = Initial(tip_displacement={"y": 1.5}, tip_velocity={"y": 0.3})
    point = starting_point(System.of(structure), None, 0.0, initial)
    q, qd = point.y, point.yd
    tip = np.asarray(structure.displacement(q))[-1]
    assert tip[1] == pytest.approx(1.5, rel=1e-12)
    assert (structure.station_slopes(q)[-1] @ qd)[1] == pytest.approx(0.3, rel=1e-12)
    # The beam is drawn in as far as it bends: 3 d²/5L for a force at the tip, to second order.
    assert tip[0] == pytest.approx(-0.6 * 1.5**2 / 8, rel=0.05)


def test_on_a_free_hub_momentum_stays_zero() -> None:
    structure = hub_beam("FOAM", axial=0, y=2)
    hub = Hub(radius=HUB_RADIUS, inertia=HUB_INERTIA, torque=0.0)
    response = simulate(structure, hub, duration=2.0, step=5e-3, initial=Initial(tip_displacement={"y": 0.1}))
    assert response.tip[0, 1] == pytest.approx(0.1) and response.hub is not None
    # The hub swings against the beam, as far one way as the coupled mode asks for.
    assert response.hub.angle[0] == 0 and np.abs(response.hub.angle).max() > 1e-4


def test_the_error_of_a_given_start_is_small_where_its_shapes_are_enough() -> None:
    response = simulate(strip(z=3), REST, duration=0.2, initial=Initial(acceleration=(0, 0, 9.81)))
    assert response.errors.displacement.slender < 1e-2


REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "state": ({"state": "undeformd"}, "did you mean 'undeformed'"),
    "acceleration": ({"acceleration": (1.0, 2.0)}, "three finite components"),
    "acceleration beside": ({"state": "undeformed", "acceleration": (0, 0, 1)}, "keep one of them"),
    "tip_displacement beside": ({"acceleration": (0, 0, 1), "tip_displacement": {"z": 1}}, "is given beside"),
    "tip_velocity.z": ({"tip_velocity": {"z": np.nan}}, "give a finite value"),
    "tip_velocity": ({"tip_velocity": {"x": 1.0}}, "choose one of y, z"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_impossible_states_are_refused(case: str) -> None:
    arguments, words = REFUSED[case]
    with pytest.raises(InputError, match=words) as caught:
        Initial(**arguments)
    assert caught.value.where == case.split()[0]


def test_a_direction_without_shapes_is_refused() -> None:
    with pytest.raises(InputError, match=r"tip_velocity\.y is along a direction without shapes"):
        simulate(strip(z=1), REST, duration=0.1, initial=Initial(tip_velocity={"y": 1.0}))


def test_files_have_it(gbeam: Callable[..., Answer], tmp_path: Path) -> None:
    file = tmp_path / "s.toml"
    file.write_text(FAST.partition("[motion.spin]")[0] + '[response]\nduration = "0.2 s"\n', encoding="utf-8")
    begin = ("--set", "response.initial.tip_displacement.z=2 mm", "--set", "response.initial.tip_velocity.z=1 mm/s")
    answer = gbeam("run", file, *begin, "--out", tmp_path)
    assert answer.status == 0
    assert "begins with its tip displaced by z 2 mm, as by a force there, its tip moving at z 0.001 m/s" in answer.out
    assert (
        gbeam("run", file, "--json").json["motions"]["flight"]["initial"] == "begins in relative equilibrium, at rest"
    )
    facts = gbeam("run", file, "--set", "response.initial.state=undeformed", "--json").json
    assert facts["motions"]["flight"]["initial"] == "begins undeformed, at rest"
    refused = gbeam("run", file, *begin, "--set", "response.initial.state=undeformed")
    assert refused.status == 2 and "response.initial.tip_displacement: is given beside state" in refused.err
    wrong = gbeam("run", file, "--set", "response.initial.tip_velocity.z=2 mm")
    assert wrong.status == 2 and "response.initial.tip_velocity.z" in wrong.err


def test_a_machine_begins_so_with_its_spin_up() -> None:
    from gbeam import Centrifuge

    flight = Flight(z=20.0)
    machine = Centrifuge(flight, arm=3.3, control_point=0.15, gravity=False, inverse="flat", spin_up=2.0)
    response = simulate(strip(y=1), machine, duration=0.1, step=1e-3, initial=Initial(tip_velocity={"z": 0.1}))
    omega = 2 * np.pi * modes(strip(y=1)).frequency
    assert response.time[0] < -1.9
    assert np.abs(response.tip[:30, 2]).max() > 0.5 * 0.1 / omega.max()
