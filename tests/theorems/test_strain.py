"""A strain is what its section carries: of linear models, of fits, of a run's loads, and by statics."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import gbeam as gb
from gbeam.analysis import surface_gauge
from gbeam.results import FrequencyErrors
from gbeam.studies import read_measurement

from .strategies import EXACT, beams, few, first_frequency, numbers, theorem, vectors

AGREES = 1e-6  # of the largest strain
FACES = ("z", "y", "-z", "-y")


@pytest.fixture(autouse=True, scope="module")
def _no_errors_of_poles() -> Iterator[None]:
    """Leave out the errors of poles, which take most of a linear model's time and have tests of their own."""
    with pytest.MonkeyPatch.context() as patch:
        none = np.ones(1), FrequencyErrors(*np.zeros((5, 1)))
        patch.setattr("gbeam.analysis.control.linearization.pole_errors", lambda *_: none)
        yield


@st.composite
def stepped(draw: st.DrawFn, *, size: float = 1.0) -> gb.Beam:
    """Tapered beams with a step in width and thickness, a body off the axis, root springs and loads of all kinds.

    Of `size` 1 the loads bend a beam by a hundredth of its length or so.
    """
    beam = draw(beams(springs=True, damping=0.01))
    length, at = beam.length, draw(numbers(0.2, 0.8))
    ends = np.array([1.0, draw(numbers(0.8, 1.0)), draw(numbers(0.4, 0.7)), draw(numbers(0.3, 0.4))])
    width, thickness = (beam.section.dimensions[name][0] * ends for name in ("width", "thickness"))
    stations = length * np.array([0.0, at, at + draw(numbers(1e-3, 1e-2)), 1.0])
    push = 0.01 * size * beam.material.youngs_modulus * width[-1] * thickness[-1] ** 3 / 12 / length**2
    loads = [
        gb.Load(length * draw(numbers(0.1, 1.0)), push * draw(vectors(1.0)), push * length * draw(vectors(1.0))),
        gb.Load(length * draw(numbers(0.1, 1.0)), push * draw(vectors(1.0)), follower=True),
        gb.Load(distributed=push / length * draw(vectors(1.0)), distributed_moment=push * draw(vectors(1.0))),
    ]
    return replace(beam, section=gb.Section.rectangle(width, thickness, stations), loads=loads)


def gauges_of(beam: gb.Beam, places: np.ndarray) -> list[gb.Gauge]:
    """Gauges at places from −1 to 1, mapped to the beam, beside its step and its body, and at root and tip."""
    corners, side = [*beam.section.stations[1:3], beam.masses[0].at], 1e-4 * beam.length
    beside = [x + way * side for x in corners for way in (-1, 1)]
    at = np.clip([0.0, *(beam.length * (1 + places) / 2), *beside, beam.length], 0.0, beam.length)
    return [gb.Gauge(float(x), y=0.3e-2 * k, z=0.2e-2 * (-1) ** k) for k, x in enumerate(at)]


def by_hand(beam: gb.Beam, gauge: gb.Gauge, force: np.ndarray, moment: np.ndarray) -> np.ndarray:
    """Strain (...,) of a rectangle that carries a force and a moment, (..., 3)."""
    at = beam.section.stations
    b, t = (np.interp(gauge.at, at, beam.section.dimensions[name]) for name in ("width", "thickness"))
    bent = 12 * (moment[..., 1] * gauge.z / (b * t**3) - moment[..., 2] * gauge.y / (t * b**3))
    return np.asarray((force[..., 0] / (b * t) + bent) / beam.material.youngs_modulus)


def by_statics(beam: gb.Beam, gauge: gb.Gauge, a: np.ndarray) -> np.ndarray:
    """Strain of the straight beam on a root with an acceleration: what acts beyond the gauge, and its moment there."""
    xi, weight = np.polynomial.legendre.leggauss(8)
    corners = np.array([0.0, *beam.section.stations[1:3], beam.length])
    force, moment = np.zeros((2, 3))

    def act(x: float, f: np.ndarray, m: np.ndarray | float = 0.0, offset: np.ndarray | float = 0.0) -> None:
        nonlocal force, moment
        force = force + f
        moment = moment + np.cross(np.array([x - gauge.at, 0.0, 0.0]) + offset, f) + m

    pull, twist = beam.loads[2].acting
    for low, high in zip(np.maximum(corners[:-1], gauge.at), np.maximum(corners[1:], gauge.at), strict=True):
        for x, w in zip((low + high) / 2 + (high - low) / 2 * xi, (high - low) / 2 * weight, strict=True):
            b, t = (np.interp(x, beam.section.stations, beam.section.dimensions[n]) for n in ("width", "thickness"))
            act(x, w * (pull - beam.material.density * b * t * a), w * np.asarray(twist))
    for load in beam.loads[:2]:
        if load.at >= gauge.at:
            act(load.at, load.force, 0.0 if load.moment is None else load.moment)
    (body,) = beam.masses
    if body.at >= gauge.at:
        act(body.at, -body.mass * a, offset=np.array(body.offset))
    return by_hand(beam, gauge, force, moment)


@pytest.mark.parametrize("kind", ["TLAM", "FOAM"])
@theorem
@given(beam=stepped(size=1e-7), a=vectors(1e-6), places=vectors(0.99, 4))
def test_strain_of_a_linear_model_is_that_of_statics(
    kind: str, beam: gb.Beam, a: np.ndarray, places: np.ndarray
) -> None:
    """The loads of a beam held at its root alone need no shape: statics knows them."""
    gauges = gauges_of(beam, places)
    structure = gb.assemble(beam, kind, axial=1, y=2, z=2, shapes="adapted")
    flight = gb.Flight(x=gb.constant(a[0]), y=gb.constant(a[1]), z=gb.constant(a[2]))
    answer = strains(gb.linearize(structure, flight, gauges=gauges)).output
    wanted = np.array([by_statics(beam, gauge, a) for gauge in gauges])
    np.testing.assert_allclose(answer, wanted, atol=AGREES * np.abs(wanted).max(), rtol=0)


def strains(system: gb.StateSpace) -> gb.StateSpace:
    """The strains among its outputs."""
    return system.select(outputs=tuple(each.name for each in system.outputs if "strain" in each.name))


@few
@given(beam=stepped(), a=vectors(30.0), places=vectors(0.99, 4))
def test_strains_of_linear_models_of_fits_and_of_loads_agree(
    tmp_path_factory: pytest.TempPathFactory, beam: gb.Beam, a: np.ndarray, places: np.ndarray
) -> None:
    """Along a small vibration about a bent equilibrium, beside the step and the body and anywhere."""
    at = [gauge.at for gauge in gauges_of(beam, places)]
    period = 2 * np.pi / first_frequency(beam)
    swing = gb.Sine(1e-6, 0.9 * period)
    across = (gb.Sum((gb.constant(each), swing)) for each in a[1:])
    flight = gb.Flight(gb.constant(a[0]), *across)
    settings = gb.ResponseSettings(2 * period, step=period / 40, integrator="gauss", estimate=False)
    case = gb.Case.of_beam("strain", beam, gb.Model("FOAM", 1, 2, 2, "adapted"), {"flight": flight}, settings)
    time = np.linspace(0.0, 2 * period, 81)
    data = tmp_path_factory.mktemp("strain") / "data.csv"
    heads = [f"strain.{FACES[k % 4]}@{x!r} m" for k, x in enumerate(at)]
    np.savetxt(data, np.column_stack([time, *np.ones((len(at), len(time)))]), delimiter=",", comments="",
               header=",".join(["time", *heads]))  # fmt: skip
    measurement = read_measurement(data, case)
    run = gb.simulate(measurement.instrumented(case).subject, flight, settings)
    assert run.outcome == "done" and run.loads is not None and run.outcome == "done"
    of_fit = measurement.read(case, gb.Study("strain", {"flight": run}, ())).reshape(len(at), -1)

    gauges = [surface_gauge(beam, x, FACES[k % 4]) for k, x in enumerate(at)]
    which = [int(np.abs(run.loads.stations - x).argmin()) for x in at]
    carried = run.loads.section_force[:, which], run.loads.section_moment[:, which]
    of_loads = [by_hand(beam, gauge, *(x[:, k] for x in carried)) for k, gauge in enumerate(gauges)]

    system = strains(gb.linearize(case.subject, flight, gauges=gauges))
    state = np.concatenate([run.q, run.qd], axis=1) - system.state
    drive = np.concatenate([run.base.a_WO_B, run.base.alpha_WB_B], axis=1) - system.input[:6]
    of_plant = system.output[:, None] + system.c @ state.T + system.d[:, :6] @ drive.T

    vibration = np.ptp(of_loads, axis=1).max()
    np.testing.assert_allclose(of_fit, of_loads, atol=AGREES * vibration, rtol=0)
    np.testing.assert_allclose(of_plant, of_loads, atol=AGREES * vibration, rtol=0)


@few
@given(beam=stepped(), a=vectors(30.0), places=vectors(0.99, 4))
def test_strain_of_the_exact_model_is_that_of_its_loads(beam: gb.Beam, a: np.ndarray, places: np.ndarray) -> None:
    """At its equilibrium, bent by per cents of its length."""
    gauges = gauges_of(beam, places)
    model = gb.Model("exact", *EXACT)
    flight = gb.Flight(x=gb.constant(a[0]), y=gb.constant(a[1]), z=gb.constant(a[2]))
    loads = gb.static(gb.assemble(beam, model, [gauge.at for gauge in gauges]), flight).loads
    assert loads is not None
    which = [int(np.abs(loads.stations - gauge.at).argmin()) for gauge in gauges]
    carried = loads.section_force[0, which], loads.section_moment[0, which]
    wanted = [by_hand(beam, gauge, *(x[k] for x in carried)) for k, gauge in enumerate(gauges)]
    answer = strains(gb.linearize(gb.assemble(beam, model), flight, gauges=gauges)).output
    np.testing.assert_allclose(answer, wanted, atol=AGREES * np.abs(wanted).max(), rtol=0)
