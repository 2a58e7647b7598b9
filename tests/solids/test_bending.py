"""Solids that their loads bend far: what a stiffness of first order leaves out, and what is then not known."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import meshio
import numpy as np
import pytest

import gbeam as gb
from gbeam.report import text
from gbeam.results import json_of

from ..calling import Answer, gbeam
from .bodies import STEEL, block, solid

__all__ = ["gbeam"]
G = 9.80665
LENGTH = 0.3
# Of a strip of steel, 300 × 30 × 0.5 mm, clamped at one end under a steady load across its flat, g: the chordwise mode
# with twist, Hz (CalculiX, NLGEOM). At 2 g it is stable, with modes at 71.3 and 159.2 Hz, and its tip moves 34.1 mm.
CHORDWISE = {0.5: 229.1, 1.0: 194.1, 1.1: 188.8}


def strip(modes: int, thickness: float = 0.0005, **more: object) -> gb.Structure:
    mesh = block("hexahedron20", (30, 3, 1), (LENGTH, 0.03, thickness))
    return solid(mesh, **more).reduced(modes=modes, damping_ratio=0.02).structure


@pytest.fixture(scope="module")
def thin() -> gb.Structure:
    return strip(10)


def across(load: float) -> gb.Flight:
    """A steady load across the flat, g."""
    return gb.Flight(z=load * G)


@pytest.mark.parametrize("load", CHORDWISE)
def test_frequencies_of_a_bent_strip_state_what_they_leave_out(thin: gb.Structure, load: float) -> None:
    """The chordwise mode is 4 to 38 % too low, and the error says so within a factor of three."""
    modes = gb.modes(thin, across(load))
    assert modes.errors is not None and modes.outcome == "done"
    chordwise = int(np.flatnonzero((modes.frequency > 100) & (np.abs(modes.frequency - 163.1) > 0.2))[0])
    true = abs(modes.frequency[chordwise] / CHORDWISE[load] - 1)
    assert true > 0.04 and true / 3 < modes.errors.model[chordwise] < 3 * true
    assert any("it bends by" in each and "stated as error of the model" in each for each in modes.warnings)
    assert "errors are of modes left out and of the bend" in text(modes)


def test_torsion_of_a_bent_strip(thin: gb.Structure) -> None:
    """To first order 91.6 Hz at any load; 90.02 and 85.48 Hz by Green's strain on the same mesh. So in a system."""
    for load, torsion in ((0.5, 90.02), (1.0, 85.48)):
        held = gb.System({"strip": thin}, {"root": gb.Joint("fixed", "strip")}, gravity=(0, 0, -load * G))
        for modes in (gb.modes(thin, across(load)), gb.modes(held)):
            assert modes.errors is not None and modes.frequency[3] == pytest.approx(91.6, abs=0.01)
            assert modes.errors.model[3] == pytest.approx(modes.frequency[3] / torsion - 1, rel=0.1)


@pytest.mark.parametrize("load", [0.1, 0.5, 1.0])
def test_a_tip_that_moves_far_comes_nearer(thin: gb.Structure, load: float) -> None:
    """A cantilever under an even load comes 4/7 w²/L nearer, ½∫w'² of Euler's shape; the error of its place says so."""
    rest = gb.static(thin, acceleration=(0, 0, load * G))
    share = abs(rest.tip[2]) / LENGTH
    assert rest.errors.displacement.model == pytest.approx(4 / 7 * share, rel=0.02)
    assert rest.errors.displacement.total == pytest.approx(rest.errors.displacement.model, rel=1e-3)
    assert any("of first order" in each for each in rest.warnings) == (share > 0.02)


def test_a_rod_bends_far_in_any_direction() -> None:
    """Two modes of equal frequency bend it: its tip comes nearer by as much in a direction between them."""
    rod = solid(block("hexahedron20", (15, 1, 1), (LENGTH, 0.005, 0.005))).reduced(modes=4, damping_ratio=0.0).structure
    for direction in ((0, 0, 1), (0, 0.6, 0.8)):
        rest = gb.static(rod, acceleration=30 * G * np.array(direction))
        share = float(np.linalg.norm(rest.tip)) / LENGTH
        # The tip is a corner of the end, which turns.
        assert share > 0.01 and rest.errors.displacement.model == pytest.approx(4 / 7 * share, rel=0.06)


def arc(angle: float, across: int = 24, **more: object) -> gb.SolidMesh:
    """Strip of 0.3 m along an arc towards z, whose tip is in the middle of its inner edge."""
    radius, thickness = LENGTH / angle, 0.003

    def bent(x: np.ndarray) -> np.ndarray:
        turn, out = x[:, 0] / radius, radius - x[:, 2]
        return np.stack([out * np.sin(turn), x[:, 1], radius - out * np.cos(turn)], axis=1)

    tip = bent(np.array([[LENGTH, 0.0, thickness / 2]]))[0]
    mesh = block("hexahedron20", (across, 1, 1), (LENGTH, 0.02, thickness), bent)
    return solid(mesh, points={"tip": tip}, **more)


def test_a_curved_strip_states_its_error() -> None:
    """An arc under a load in its plane, beside the exact beam."""
    strip = arc(1.0).reduced(modes=4, damping_ratio=0.0).structure
    line = gb.Line.of_pieces([LENGTH], turn_y=-1.0)
    section = gb.Section.rectangle(width=0.02, thickness=0.003)
    beam = gb.assemble(gb.Beam(LENGTH, section, STEEL, line=line, damping_ratio=0.0), "exact", axial=1, z=6)

    def tips(of: gb.Structure, load: float) -> np.ndarray:
        return np.array([gb.static(of, acceleration=(0, 0, each * G)).tip for each in (load, 1e-4 * load)])

    for load in (20.0, -20.0):
        computed, exact = tips(strip, load), tips(beam, load)
        # Beside what is wrong in the linear answer, by the mesh and the theory of beams.
        change, true_change = (each[0] - 1e4 * each[1] for each in (computed, exact))
        true = np.linalg.norm(change - true_change) / np.linalg.norm(computed[0])
        stated = gb.static(strip, acceleration=(0, 0, load * G)).errors.displacement.model
        assert true > 0.01 and stated == pytest.approx(true, rel=0.1)


@pytest.mark.parametrize(
    ("load", "tip"), [((0, 0, 2.0), (7.622730, 0, -6.009326)), ((2.0, 0, 0), (-10.721062, 0, 6.938297))]
)
def test_a_weight_on_a_curved_strip(load: tuple[float, ...], tip: tuple[float, ...]) -> None:
    """Its deflection, mm, by Newton's method on all nodes of the same mesh, with Green's strain: forces of second order
    change the bend itself, beside which the model counts them in full where half of them acts.
    """
    rest = gb.static(
        arc(1.5, 12, point_masses={"tip": 1.0}).reduced(modes=4, damping_ratio=0.0).structure,
        acceleration=G * np.array(load),
    )
    true = np.linalg.norm(1e3 * rest.tip - tip) / np.linalg.norm(1e3 * rest.tip)
    assert true > 0.02 and rest.errors.displacement.model == pytest.approx(true, rel=0.05)


def test_a_strip_that_first_order_would_let_go_is_not_known(thin: gb.Structure) -> None:
    """At 2 g, where it stays (CalculiX): its rest, its vibrations and its flight say so, with how far it bends."""
    rest = gb.static(thin, acceleration=(0, 0, 2 * G))
    assert rest.stable is None and rest.outcome == "not known"
    assert "whether it would stay there is not known: what deviates grows by" in rest.message
    assert "it bends by 12 % of its length" in rest.message and rest.message in repr(rest)
    assert json_of(rest)["stable"] is None and json_of(rest)["outcome"] == "not known"

    modes = gb.modes(thin, across(2.0))
    assert modes.stable is None and not modes.instabilities and modes.outcome == "not known"
    assert "divergence along" in modes.message and modes.message in text(modes)

    rise = gb.Flight(z=gb.trapezoid(2 * G, jerk=40 * G, start=0.0, hold=1.0))
    run = gb.simulate(thin, rise, duration=0.3, step=1e-4, estimate=False)
    assert run.outcome == "not known" and "whether it diverges is not known: solid's stiffness" in run.message
    assert f"not known\n  W{run.message[1:]}" in text(run)


def test_a_strip_that_nothing_is_known_of(thin: gb.Structure) -> None:
    """As of matrices, without the forces of higher order."""
    assert thin.richer is not None
    matrices = replace(thin, richer=replace(thin.richer, bending=None))
    rest = gb.static(matrices, acceleration=(0, 0, G))
    assert any("it bends by 5.8 % of its length" in each and "is not known" in each for each in rest.warnings)
    assert np.isnan(rest.errors.displacement.model)


def test_a_bend_of_one_in_fifty_is_warned_of(thin: gb.Structure) -> None:
    """Of what rests, vibrates and flies, alone and in a system."""
    share = abs(gb.static(thin, acceleration=(0, 0, G)).tip[2]) / LENGTH
    for factor, far in ((0.99, False), (1.01, True)):
        load = factor * 0.02 / share
        held = gb.System({"strip": thin}, {"root": gb.Joint("fixed", "strip")}, gravity=(0, 0, -load * G))
        flight = gb.Flight(z=gb.SmoothStep(load * G, 2.0))  # so slow that it does not swing
        answers = (
            gb.static(thin, acceleration=(0, 0, load * G)),
            gb.modes(thin, across(load), errors=False),
            gb.simulate(thin, flight, duration=2.1, step=2e-3, estimate=False),
            gb.static(held),
            gb.modes(held, errors=False),
        )
        for answer in answers:
            assert any("it bends by 2 % of its length" in each for each in answer.warnings) == far


def test_a_system_of_a_bent_strip_is_not_known(thin: gb.Structure) -> None:
    held = gb.System({"strip": thin}, {"root": gb.Joint("fixed", "strip")}, gravity=(0, 0, -2 * G))
    rest, modes = gb.static(held), gb.modes(held)
    assert rest.stable is None and modes.stable is None
    assert all(each.outcome == "not known" and each.message in text(each) for each in (rest, modes))


def test_a_speed_that_a_bent_strip_would_not_keep_is_not_known() -> None:
    """Pointing inward on a hub, but askew, so that this bends it."""
    hub = gb.Hub(radius=0.3, pointing="inward")
    askew = strip(4, thickness=0.001, turn=(0.0, 0.2, 0.0))
    lost = gb.critical_speed(askew, hub)
    assert (lost.kind, lost.outcome, lost.value) == ("not known", "not known", None)
    assert "solid keeps its equilibrium up to there, and whether it would stay there is not known" in lost.reason
    assert lost.message in lost.reason and "it bends by" in lost.message
    # The diagram ends there, and says why.
    diagram = gb.campbell(askew, hub, end=1.5 * lost.searched_to, count=4, modes=2)
    assert diagram.speed[-1] == pytest.approx(lost.searched_to, rel=1e-3)
    assert any(each.startswith("whether it would stay there is not known") for each in diagram.warnings)


SCENARIO = """
[bodies.strip]
mesh = "strip.inp"
unit = "m"
clamp = "wall"
modes = 7
damping_ratio = "2 %"
material = { density = "7850 kg/m^3", youngs_modulus = "210 GPa", poissons_ratio = 0.3 }
[motion.flight]
kind = "flight"
acceleration = { z = { profile = "trapezoid", level = "2 g", jerk = "40 g/s", start = "0 s", hold = "1 s" } }
[response]
duration = "0.3 s"
step = "0.1 ms"
estimate = false
"""


@pytest.mark.usefixtures("reading_in_process")
def test_verbs_end_as_not_known(gbeam: Callable[..., Answer], tmp_path: Path) -> None:
    """With exit status 1, a sentence on stderr, and the answer as far as it goes; in a sweep it is a case's outcome."""
    meshio.write(tmp_path / "strip.inp", block("hexahedron20", (12, 2, 1), (LENGTH, 0.03, 0.0005)))
    scenario = tmp_path / "strip.toml"
    scenario.write_text(SCENARIO)
    at = "--at", "0.1 s"
    for verb in ("static", "modes"):
        answer = gbeam(verb, scenario, *at, "--json", "--out", tmp_path / verb)
        assert answer.status == 1 and answer.json["outcome"] == "not known"
        assert "not known: " in answer.err and "of its length, and its stiffness is of first order" in answer.err
    loads = "motion.flight.acceleration.z.level=0.1 g, 2 g"
    swept = gbeam("sweep", scenario, "--verb", "modes", *at, "--over", loads, "--json", "--out", tmp_path / "sweep")
    assert swept.status == 1 and swept.json["outcomes"] == ["done", "not known"]
