"""Frequencies by Rayleigh, Cauchy and Weyl: more mass, more shapes, more stiffness, more speed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hypothesis import given

from gbeam import Beam, Hub, Model, PointMass, Root, assemble, constant
from gbeam.results import Base

from .strategies import beams, first_frequency, frequencies, numbers, theorem, vectors

ROUNDING = 1e-9  # relative


def at_rest(beam: Beam, *counts: int) -> np.ndarray:
    """Circular frequencies, rad/s, ascending."""
    return assemble(beam, Model("FOAM", *counts)).rest[0]


@theorem
@given(beam=beams(springs=True), share=numbers(0.01, 2.0), place=numbers(0.1, 1.0), arm=vectors(0.1))
def test_mass_lowers_every_frequency(beam: Beam, share: float, place: float, arm: np.ndarray) -> None:
    (body,) = beam.masses
    inertia = tuple(share * np.array(body.inertia))
    more = PointMass(place * beam.length, share * body.mass, inertia=inertia, offset=tuple(beam.length * arm))
    light, heavy = at_rest(beam, 1, 3, 3), at_rest(replace(beam, masses=(body, more)), 1, 3, 3)
    assert (heavy <= light * (1 + ROUNDING)).all()


@theorem
@given(beam=beams(springs=True), factor=numbers(1.0, 5.0))
def test_springs_raise_every_frequency(beam: Beam, factor: float) -> None:
    stiffer = Root(**{name: factor * value for name, value in beam.root.springs.items()})
    soft, hard = at_rest(beam, 1, 3, 3), at_rest(replace(beam, root=stiffer), 1, 3, 3)
    assert (hard >= soft * (1 - ROUNDING)).all()


@theorem
@given(beam=beams(springs=True), rate=vectors(0.5), a=vectors(1.0))
def test_another_shape_lowers_every_frequency_and_interlaces(beam: Beam, rate: np.ndarray, a: np.ndarray) -> None:
    """Cauchy: λ_k(n + 1) <= λ_k(n) <= λ_{k+1}(n + 1), on a base in steady motion."""
    scale = first_frequency(beam)
    base = Base(0.1 * scale**2 * beam.length * a, scale * rate, np.zeros(3))
    fewer, more = (eigenvalues(beam, base, n) for n in (2, 3))
    slack = ROUNDING * np.abs(more).max()
    assert (more[: len(fewer)] <= fewer + slack).all()
    assert (fewer <= more[1:] + slack).all()


def eigenvalues(beam: Beam, base: Base, along_z: int) -> np.ndarray:
    """Eigenvalues of K in the measure of M, ascending, rad²/s²."""
    c = assemble(beam, Model("FOAM", 1, 2, along_z)).coefficients
    _, stiffness, _ = c.evaluate(base.a_WO_B, base.w_WB_B, base.alpha_WB_B)
    return np.sort(np.linalg.eigvals(np.linalg.solve(c.mass, stiffness)).real)


@theorem
@given(beam=beams(), radius=numbers(0.0, 1.0), speed=numbers(0.2, 3.0))
def test_the_first_flap_is_concave_in_the_square_of_the_speed(beam: Beam, radius: float, speed: float) -> None:
    """ω² is the least of sums that are linear in Ω²: Southwell's straight line lies above, Weyl's chord below."""
    structure = assemble(beam, Model("FOAM", 0, 0, 4))
    rate = speed * first_frequency(beam)

    def square(share: float) -> float:
        hub = Hub(radius=radius * beam.length, rate=constant(float(np.sqrt(share)) * rate))
        return float(frequencies(structure, hub, gyroscopic=False)[0] ** 2)

    still, tenth, half, whole = (square(share) for share in (0.0, 0.1, 0.5, 1.0))
    assert half >= (still + whole) / 2 * (1 - ROUNDING)
    assert whole <= still + 10 * (tenth - still) * (1 + ROUNDING)
