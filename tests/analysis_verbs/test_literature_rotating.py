"""Rotating beams of the literature through `modes` (validation/published/tables.py).

Errata of the sources: 2009 Table 2 divides rad/s by 2 × 3.14; its captions are swapped. Hamza Cherif's chord column has
no centrifugal pre-stretch, which the exact model has.
"""

from __future__ import annotations

import numpy as np
import pytest

from gbeam import Hub, Model, PointMass, assemble, constant, critical_speed, modes
from validation.published.tables import TIP_MASS_FLAP, UNIFORM_FLAP

from .beams import FREE_2009, HUB, HUB_2009, slender, structure_2009


def spin(rate: float) -> Hub:
    return Hub(radius=0.0, rate=constant(rate))


def along(structure, motion, direction):
    """Circular frequencies of the modes in one direction, rad/s."""
    vibration = modes(structure, motion, 0.0)
    return 2 * np.pi * vibration.frequency[[d == direction for d in vibration.direction]]


def test_wright_1982_flap():
    structure = assemble(slender(1e4), Model("FOAM", 0, 0, 15))
    # Clamped-free shapes converge as n⁻³: 4e-6 is what fifteen give at the highest speed.
    for gamma, (_, wanted) in UNIFORM_FLAP.items():
        assert along(structure, spin(gamma), "z")[:3] == pytest.approx(wanted, rel=1e-5), gamma


def test_wright_1982_tip_mass():
    structure = assemble(slender(1e4, PointMass(1.0, 1.0)), Model("FOAM", 0, 0, 8, shapes="adapted"))
    for gamma, (_, wanted) in TIP_MASS_FLAP.items():
        assert along(structure, spin(gamma), "z")[:2] == pytest.approx(wanted, rel=5e-4), gamma


def test_southwell():
    """The slope dω²/dΩ² at rest, here a secant; exactly, and why a list has 6.47744: literature/test_rotating_beams."""
    structure = assemble(slender(1e4), Model("FOAM", 0, 0, 12))
    rest, slow = (along(structure, spin(rate), "z")[:3] ** 2 for rate in (0.0, 0.05))
    assert (slow - rest) / 0.05**2 == pytest.approx([1.193336, 6.478225, 17.859520], abs=1e-5)


@pytest.mark.parametrize(("gamma", "chord"), [(2, 3.6195), (10, 4.9700)])
def test_hamza_cherif_2004_chord_and_flap(gamma: float, chord: float) -> None:
    """Coriolis coupling to the linear stretch, Yoo and Shin's model, is FOAM's."""
    structure = assemble(slender(70.0), Model("FOAM", 6, 10, 10))
    assert along(structure, spin(gamma), "y")[0] == pytest.approx(chord, rel=1e-4)
    assert along(structure, spin(gamma), "z")[0] == pytest.approx({2: 4.1373, 10: 11.2023}[gamma], rel=1e-4)


def test_the_exact_chord_is_pre_stretched():
    """The exact beam is longer as it spins: its chord frequencies must not be the table's."""
    structure = assemble(slender(70.0), Model("exact", 3, 8, 0))
    answer = [along(structure, spin(gamma), "y")[0] for gamma in (2, 10)]
    # Converged to nine digits with more shapes; 4.9484 has been quoted for the second.
    assert answer == pytest.approx([3.618592, 4.948718], abs=5e-6)


def test_2009_table_2():
    """To the printed digit with its π = 3.14, and the true values beside it."""
    tables = {
        ("TLAM", 0.0): ([0.46326, 2.90320, 8.12903, 15.92965, 26.33286], [0.4635, 2.9047, 8.1332, 15.9377, 26.3462]),
        ("TLAM", 1.0): ([0.43506, 2.89883, 8.12747, 15.92886, 26.33238], [0.4353, 2.9003, 8.1316, 15.9369, 26.3457]),
        ("FOAM", 1.0): ([0.47111, 2.92933, 8.15767, 15.96005, 26.36425], [0.4714, 2.9308, 8.1618, 15.9682, 26.3776]),
    }
    for (kind, rate), (true, printed) in tables.items():
        answer = along(structure_2009(kind, 5, 5), Hub(radius=0.5, rate=constant(rate)), "y")[:5]
        assert answer / (2 * np.pi) == pytest.approx(true, abs=2e-5)
        assert answer / (2 * 3.14) == pytest.approx(printed, abs=1.01e-4)  # FOAM's fourth is one digit off in print


def test_free_hub_2009():
    vibration = modes(structure_2009("FOAM", 2, 5), FREE_2009, 0.0)
    assert vibration.rigid == 1
    assert 2 * np.pi * vibration.frequency[0] == pytest.approx(3.18239, abs=1e-5)
    heavy = modes(structure_2009("FOAM", 2, 5, mass=0.5), FREE_2009, 0.0)
    assert 2 * np.pi * heavy.frequency[0] == pytest.approx(2.26615, abs=1e-5)


@pytest.mark.parametrize(("mass", "wanted"), [(0.0, 2.9107), (0.1, 2.6043), (0.5, 1.9365)])
def test_critical_speeds_of_tlam(mass: float, wanted: float) -> None:
    """2009 prints 2.91, 2.60 and 1.91; the last would need 0.525 kg."""
    critical = critical_speed(structure_2009("TLAM", 5, 5, mass=mass), HUB_2009)
    assert critical.value == pytest.approx(wanted, abs=1e-4 if mass == 0.5 else 5e-5)
    assert (critical.kind, critical.direction) == ("divergence", "y")


def test_critical_speed_exact():
    """cos λ cosh λ + 1 = λ μ (sin λ cosh λ − cos λ sinh λ), Ω = the natural frequency at rest: 1.93645."""
    from .beams import beam_2009

    structure = assemble(beam_2009(0.5), Model("TLAM", 1, 6, 0, shapes="adapted"))
    assert critical_speed(structure, HUB_2009).value == pytest.approx(1.93645, abs=6e-6)


def test_hub_radius_is_irrelevant_to_tlam_and_stiffens_foam():
    structure = structure_2009("TLAM", 5, 5)
    far = critical_speed(structure, Hub(radius=4.0, rate=constant(1.0))).value
    assert far == pytest.approx(critical_speed(structure, HUB_2009).value, abs=1e-9)
    first = along(structure_2009("FOAM", 5, 5), HUB, "y")[0]
    assert first / (2 * np.pi) == pytest.approx(0.46847, abs=1e-5)
    assert first / (2 * 3.14) == pytest.approx(0.46871, abs=1e-5)  # as 2009 divides
