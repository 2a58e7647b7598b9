"""Objectivity, mirrors, dimensions and time: what may be turned, scaled or reversed without changing an answer."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given

from gbeam import (
    Beam,
    Flight,
    Hub,
    Material,
    Model,
    PointMass,
    Section,
    Sine,
    assemble,
    constant,
    simulate,
    solve_equilibrium,
    vector,
)
from gbeam.integrate import LinearEquations, gauss, integrate, newmark
from gbeam.results import Base

from .strategies import EXACT, beams, few, first_frequency, frequencies, numbers, theorem, vectors


def about_x(angle: float) -> np.ndarray:
    """Rotation matrix."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


@pytest.mark.parametrize("kind", ["TLAM", "FOAM", "exact"])
@few
@given(beam=beams(square=True, taper=False), a=vectors(20.0), w=vectors(1.0), al=vectors(1.0), angle=numbers(-3.0, 3.0))
def test_turning_the_world_about_the_beam(
    kind: str, beam: Beam, a: np.ndarray, w: np.ndarray, al: np.ndarray, angle: float
) -> None:
    """A section with equal second moments: the deflection turns with the acceleration, the rate and its change."""
    structure = assemble(beam, Model(kind, *EXACT))
    scale, R = first_frequency(beam), about_x(angle)
    motion = a, 0.2 * scale * w, 0.02 * scale**2 * al
    as_is, turned = (
        structure.displacement(solve_equilibrium(structure, Base(*(turn @ x for x in motion))).q)[-1]
        for turn in (np.eye(3), R)
    )
    np.testing.assert_allclose(turned, R @ as_is, atol=1e-9 * np.linalg.norm(as_is))


@theorem
@given(beam=beams(square=True), rate=numbers(0.0, 1.0), radius=numbers(0.0, 1.0), angle=numbers(-3.0, 3.0))
def test_a_setting_angle_turns_nothing_round(beam: Beam, rate: float, radius: float, angle: float) -> None:
    """Frequencies on a hub do not depend on how a round beam is turned about its axis."""
    structure, speed = assemble(beam, Model("FOAM", 1, 2, 2)), rate * first_frequency(beam)
    plain, turned = (
        frequencies(structure, Hub(radius=radius * beam.length, rate=constant(speed), setting_angle=psi))
        for psi in (0.0, angle)
    )
    np.testing.assert_allclose(turned, plain, rtol=1e-8)


@theorem
@given(beam=beams(square=True, bodies=False, damping=0.0), share=numbers(0.01, 0.8))
def test_a_spin_about_the_beam_is_seen_from_outside_as_none(beam: Beam, share: float) -> None:
    """A round beam spinning about its axis, points on it, vibrates in the world as at rest: seen at |ω ± Ω|."""
    structure = assemble(replace(beam, rotary_inertia=False), Model("FOAM", 0, 3, 3))
    spin = share * first_frequency(beam)
    base = Flight(x=0.0, rates=vector(x=constant(spin)))
    rest = structure.rest[0][::2]  # in pairs
    wanted = np.sort(np.concatenate([rest - spin, rest + spin]))
    np.testing.assert_allclose(2 * np.pi * frequencies(structure, base), wanted, rtol=1e-9)


@theorem
@given(angle=numbers(-3.0, 3.0), by=numbers(-3.0, 3.0), gravity=vectors(10.0), rate=numbers(-5.0, 5.0))
def test_turning_gravity_with_the_hub(angle: float, by: float, gravity: np.ndarray, rate: float) -> None:
    """The load on a base depends on the angle between gravity and the hub alone."""
    R = np.array([[np.cos(by), -np.sin(by), 0.0], [np.sin(by), np.cos(by), 0.0], [0.0, 0.0, 1.0]])
    first, second = (
        Hub(radius=0.7, inertia=1.0, gravity=g, setting_angle=0.4).mount.base(
            np.array(at), np.array(rate), np.zeros(())
        )
        for g, at in ((gravity, angle), (R @ gravity, angle + by))
    )
    np.testing.assert_allclose(second.a_WO_B, first.a_WO_B, atol=1e-12)


@theorem
@given(beam=beams(), a=vectors(20.0), w=vectors(1.0), al=vectors(1.0))
def test_mirror(beam: Beam, a: np.ndarray, w: np.ndarray, al: np.ndarray) -> None:
    """y → −y of offsets and accelerations, and of what turns (ω_x, ω_z, α_x, α_z), mirrors the deflection."""
    polar, axial = np.array([1.0, -1.0, 1.0]), np.array([-1.0, 1.0, -1.0])
    (body,) = beam.masses
    mirrored = Beam(beam.length, beam.section, beam.material,
                    [PointMass(body.at, body.mass, inertia=body.inertia, offset=tuple(polar * body.offset))],
                    beam.damping_ratio)  # fmt: skip
    scale = first_frequency(beam)
    motion = a, 0.2 * scale * w, 0.02 * scale**2 * al
    structures = (assemble(each, Model("FOAM", 2, 3, 3)) for each in (beam, mirrored))
    bases = Base(*motion), Base(*(s * x for s, x in zip((polar, axial, axial), motion, strict=True)))
    as_is, reflected = (s.displacement(solve_equilibrium(s, b).q)[-1] for s, b in zip(structures, bases, strict=True))
    np.testing.assert_allclose(reflected, polar * as_is, atol=1e-10 * np.linalg.norm(as_is))


@few
@given(beam=beams(), lengths=numbers(0.1, 10.0), moduli=numbers(0.1, 10.0), densities=numbers(0.1, 10.0))
def test_dimensionless_groups(beam: Beam, lengths: float, moduli: float, densities: float) -> None:
    """A model to scale, of another metal, at times and accelerations to scale, answers to scale."""
    times = lengths * np.sqrt(densities / moduli)
    (body,) = beam.masses
    mass = densities * lengths**3
    widths = [lengths * np.array(beam.section.dimensions[name]) for name in ("width", "thickness")]
    ends = lengths * np.array(beam.section.stations)
    scaled = Beam(
        lengths * beam.length,
        Section.rectangle(*widths, ends),
        Material(densities * beam.material.density, moduli * beam.material.youngs_modulus),
        [PointMass(lengths * body.at, mass * body.mass, inertia=tuple(mass * lengths**2 * np.array(body.inertia)),
                   offset=tuple(lengths * np.array(body.offset)))],
        beam.damping_ratio,
    )  # fmt: skip
    period = 2 * np.pi / first_frequency(beam)
    tips, moments = [], []
    for each, t, g in ((beam, 1.0, 1.0), (scaled, times, lengths / times**2)):
        flight = Flight(y=Sine(10.0 * g, 1.4 * period * t), z=Sine(20.0 * g, 0.9 * period * t))
        run = simulate(
            assemble(each, Model("FOAM", 1, 2, 2)),
            flight,
            duration=3 * period * t,
            step=period * t / 40,
            estimate=False,
        )
        assert run.loads is not None
        tips.append(run.tip / each.length)
        moments.append(run.loads.moment[:, 0] / (each.material.youngs_modulus * each.length**3))
    np.testing.assert_allclose(tips[1], tips[0], atol=1e-9 * np.abs(tips[0]).max())
    np.testing.assert_allclose(moments[1], moments[0], atol=1e-9 * np.abs(moments[0]).max())


@pytest.mark.parametrize("scheme", [newmark(), gauss()], ids=["newmark", "gauss"])
@theorem
@given(beam=beams(damping=0.0), a=vectors(30.0), w=vectors(1.0), start=vectors(1.0, 10))
def test_time_reversal(scheme: object, beam: Beam, a: np.ndarray, w: np.ndarray, start: np.ndarray) -> None:
    """Run to the end, reverse all rates and the drive's time, and run back: symmetric schemes return to the start."""
    c, scale = assemble(beam, Model("FOAM", 1, 2, 2)).coefficients, first_frequency(beam)
    spin, end, count = 0.3 * scale * w, 8.0 / scale, 40

    def drive(t: np.ndarray, way: float) -> Base:
        now = t if way > 0 else end - t
        swing = np.sin(2.0 * scale * now)[:, None]
        change = 2.0 * scale * np.cos(2.0 * scale * now)[:, None]
        return Base(a * (1 + swing), way * spin * swing, spin * change)  # α is even in time, ω odd

    def run(q: np.ndarray, qd: np.ndarray, way: float) -> tuple[np.ndarray, np.ndarray]:
        def matrices(base: Base) -> tuple[np.ndarray, ...]:
            return c.evaluate(base.a_WO_B, base.w_WB_B, base.alpha_WB_B)

        equations = LinearEquations(c.mass, matrices, lambda t: drive(t, way))
        answer = integrate(equations, scheme, q, qd, step=end / count, count=count)  # type: ignore[arg-type]
        return answer.q[-1], answer.qd[-1]

    small = beam.length * np.array([1e-5, 0.02, 0.01, 0.02, 0.01])
    q, qd = start[:5] * small, start[5:] * small * scale
    at_end, speed = run(q, qd, 1.0)
    back, against = run(at_end, -speed, -1.0)
    size = max(np.abs(at_end).max(), np.abs(q).max(), 1e-9 * beam.length)
    np.testing.assert_allclose(back, q, atol=1e-8 * size)
    np.testing.assert_allclose(against, -qd, atol=1e-8 * max(np.abs(speed).max(), np.abs(qd).max(), size * scale))
