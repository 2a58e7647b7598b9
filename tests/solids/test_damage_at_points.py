"""Shock spectra and fatigue damage at points of solids, rigid boxes and systems, beside a beam's and beside SciPy's."""

from __future__ import annotations

from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.signal import lsim

import gbeam as gb
from gbeam.analysis import Quantities, cyclic_stress
from gbeam.report import comparison_lines
from gbeam.solids import critical_plane_stress

from .bodies import STIFF, block, solid

L, B, H = 0.3, 0.02, 0.01
METAL = gb.Material(STIFF.density, STIFF.youngs_modulus, poissons_ratio=0.0, fatigue_exponent=4.0)
LOAD = gb.Sum((gb.constant(20.0), gb.trapezoid(50.0, jerk=100.0, start=0.5, hold=0.5)))
TURN = gb.Flight(z=LOAD)
MACHINE = gb.Centrifuge(TURN, arm=3.3, control_point=0.22, gravity=True, smoothing=0.1, span=(0.0, 3.0))
OPTIONS: dict[str, Any] = {"duration": 3.0, "step": 0.002, "integrator": "gauss", "estimate": False}
HALF = L / 2


def runs(structure: Any) -> tuple[Any, Any]:
    return gb.simulate(structure, TURN, **OPTIONS), gb.simulate(structure, MACHINE, **OPTIONS)


@cache
def of_solid() -> tuple[gb.Response, gb.Response]:
    mesh = block("hexahedron20", (12, 1, 1), (L, B, H))
    points = {"half": (HALF, 0.5 * B, 0.5 * H), "foot": (0.0, 0.5 * B, 0.5 * H)}
    return runs(solid(mesh, METAL, points=points).reduced(modes=4, damping_ratio=0.02).structure)


@cache
def beam() -> gb.Structure:
    section = gb.Section.rectangle(width=B, thickness=H)
    strip = gb.Beam(L, section, METAL, damping_ratio=0.02, points=[gb.Point("half", HALF)])
    return gb.assemble(strip, "FOAM", axial=1, y=2, z=3)


@cache
def of_beam() -> tuple[gb.Response, gb.Response]:
    return runs(beam())


def test_damage_of_a_solid_beam_is_the_beams() -> None:
    """Half-way, where the clamp no longer matters: ranges of cycles and damage."""
    ours, theirs = (gb.compare(*pair(), damage_at="half").fatigue for pair in (of_solid, of_beam))
    assert ours is not None and theirs is not None
    assert ours.exponent == theirs.exponent == 4.0 and ours.place == theirs.place == "at half"
    for one, other in ((ours.flight, theirs.flight), (ours.machine, theirs.machine)):
        assert one.largest == pytest.approx(other.largest, rel=5e-3)
    assert ours.damage_ratio == pytest.approx(theirs.damage_ratio, rel=5e-3)


def test_stress_at_a_point_is_judged_there() -> None:
    """Half-way by a solid, by the beam and by the beam in a system; anywhere it is that of the clamp."""
    system = gb.System({"strip": beam()}, {"clamp": gb.Joint("fixed", "strip")})
    answers = []
    for pair, more in ((of_solid(), {}), (of_beam(), {}), (runs(system), {"point": "strip.tip"})):
        at = "strip.half" if more else "half"
        compared = gb.compare(*pair, stress_at=at, accept={"stress": 0.5}, **more)
        (judged,), stress, anywhere = compared.criteria, compared.peaks["stress_at"], compared.peaks["stress"]
        assert judged.value == stress.ratio - 1 and judged.where.startswith(f"at {at} at ")
        assert stress.flight < 0.4 * anywhere.flight and f"stress at {at}" in " ".join(comparison_lines(compared))
        answers.append((stress.flight, stress.machine))
    assert answers[0] == pytest.approx(answers[1], rel=1e-2) and answers[2] == pytest.approx(answers[1], rel=5e-3)
    with pytest.raises(gb.InputError, match="stress_at is 'knee'"):
        gb.compare(*of_beam(), stress_at="knee")


def test_left_out_it_is_where_a_solid_is_stressed_most() -> None:
    """At the foot of the bar, whose normal stress there is the beam's root's to what one element does to a clamp."""
    compared = gb.compare(*of_solid(), accept={"damage": 1.5})
    (judged,), fatigue = compared.criteria, compared.fatigue
    assert fatigue is not None and judged.value == fatigue.damage_ratio and np.isfinite(judged.value)
    assert judged.where == fatigue.place == "where it is stressed most"
    foot, root = gb.compare(*of_solid(), damage_at="foot").fatigue, gb.compare(*of_beam()).fatigue
    assert foot is not None and root is not None and root.place == "of the root"
    assert fatigue.flight.largest == pytest.approx(foot.flight.largest, rel=0.01)
    assert fatigue.flight.largest == pytest.approx(root.flight.largest, rel=0.05)
    with pytest.raises(gb.InputError, match="damage_at is 'nose'; choose from half, foot, tip"):
        gb.compare(*of_solid(), damage_at="nose")


def test_spectra_of_a_solid_beam_are_the_beams() -> None:
    ours, theirs = (gb.compare(*pair(), control={"half": 1.0}) for pair in (of_solid, of_beam))
    assert ours.shock is not None and theirs.shock is not None
    low = ours.shock.frequency < 50.0  # of modes at 90 and 560 Hz; along z, for the point lies beside the beam's axis
    assert low.sum() > 30
    for name in ("flight", "centrifuge"):
        one, other = (getattr(each.shock, name)[low, 2] for each in (ours, theirs))
        np.testing.assert_allclose(one, other, rtol=2e-2)


def test_points_of_beams_in_a_system_are_those_of_the_beam() -> None:
    system = gb.System({"strip": beam()}, {"clamp": gb.Joint("fixed", "strip")})
    pair = runs(system)
    for at in (None, "half"):
        theirs = gb.compare(*of_beam(), damage_at=at).fatigue
        ours = gb.compare(*pair, damage_at=at).fatigue
        assert ours is not None and theirs is not None
        assert ours.flight.largest == pytest.approx(theirs.flight.largest, rel=1e-4)
        assert ours.damage_ratio == pytest.approx(theirs.damage_ratio, rel=1e-3)
        named = gb.compare(*pair, damage_at=None if at is None else f"strip.{at}").fatigue
        assert named is not None and named.damage_ratio == ours.damage_ratio
    with pytest.raises(gb.InputError, match=r"damage_at is 'knee'; choose from half, tip"):
        gb.compare(*pair, damage_at="knee")


def test_spectra_at_the_corner_of_a_rigid_box() -> None:
    """SciPy's integration of the oscillator on the acceleration that the corner has by its rigid motion."""
    corner = np.array([0.16, 0.1, 0.12])
    box = gb.RigidSpecimen(
        6.5, (0.012, 0.0, 0.052), np.diag([0.03, 0.063, 0.076]), [tuple(corner), (-0.16, -0.1, 0.0)],
        points={"corner": tuple(corner)},
    )  # fmt: skip
    flight, machine = runs(box.structure)
    shock = gb.compare(flight, machine, control={"corner": 1.0}).shock
    assert shock is not None and shock.control == "corner (100 %)"
    during = (machine.time >= -1e-9) & (machine.time <= 3.0 + 1e-9)
    w, alpha = machine.base.w_WB_B[during], machine.base.alpha_WB_B[during]
    felt = machine.base.a_WO_B[during] + np.cross(alpha, corner) + np.cross(w, np.cross(w, corner))
    time = machine.time[during]
    for k in (5, 20, 40):
        omega = 2 * np.pi * shock.frequency[k]
        damping = omega / shock.quality
        # Absolute acceleration over that of the base: (2 ζ ω s + ω²)/(s² + 2 ζ ω s + ω²).
        for axis in range(3):
            rides = ([damping, omega**2], [1.0, damping, omega**2])
            whole = lsim(rides, felt[:, axis] - felt[0, axis], time)[1] + felt[0, axis]
            assert shock.centrifuge[k, axis] == pytest.approx(np.abs(whole).max(), rel=5e-3, abs=1e-3)


def test_damage_is_unknown_where_there_is_no_stress() -> None:
    box = gb.RigidSpecimen.box(3.0, (0.3, 0.2, 0.1), (0.0, 0.0, 0.05))
    compared = gb.compare(*runs(box.structure), accept={"damage": 2.0})
    assert compared.fatigue is None and compared.decision == "NOT DECIDED"


def test_the_plane_where_a_stress_ranges_most() -> None:
    """Among ten thousand planes none has a larger range, of stresses that turn; in a pull it is the pull."""
    rng = np.random.default_rng(5)
    ways = rng.normal(size=(10000, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    for _ in range(20):
        stress = rng.normal(size=(50, 6))
        x, y, z = ways.T
        on_planes = stress @ np.stack([x * x, y * y, z * z, 2 * y * z, 2 * x * z, 2 * x * y])
        chosen = np.ptp(critical_plane_stress(stress))
        assert chosen >= np.ptp(on_planes, axis=0).max() * (1 - 1e-12)
        assert chosen < 1.02 * np.ptp(on_planes, axis=0).max()
    pulled = np.outer(np.sin(np.arange(30.0)), np.outer(ways[0], ways[0])[[0, 1, 2, 1, 0, 0], [0, 1, 2, 2, 2, 1]])
    np.testing.assert_allclose(critical_plane_stress(pulled), np.sin(np.arange(30.0)), atol=1e-9)


def test_every_section_has_its_fibre() -> None:
    """The fibre lies within tension and compression, and reaches them where the bending keeps its direction."""
    flight, _ = of_beam()
    assert flight.loads is not None and flight.loads.fibre is not None
    loads, fibre = flight.loads, flight.loads.fibre
    assert (fibre <= loads.stress_tension + 1).all() and (fibre >= loads.stress_compression - 1).all()
    sizes = np.abs(fibre).max(axis=0)
    assert all(a > b for a, b in pairwise(sizes[[0, 1]])) and sizes[0] == pytest.approx(
        loads.stress[:, 0].max(), rel=1e-9
    )
    cyclic = cyclic_stress(Quantities.from_response("flight", flight), "half")
    assert cyclic is not None and cyclic.exponent == 4.0


def test_a_stress_that_ranges_by_rounding_only_has_a_plane_too() -> None:
    """Its ranges on planes that follow one another went up and down for ever."""
    for seed in (1, 16, 22):
        generator = np.random.default_rng(seed)
        steady = np.tile(1e4 * generator.normal(size=6), (101, 1))
        sides = np.where(generator.random((101, 6)) < 0.5, -np.inf, np.inf)
        assert np.ptp(critical_plane_stress(np.nextafter(steady, sides))) < 1e-10
