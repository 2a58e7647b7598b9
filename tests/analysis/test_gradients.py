"""Derivatives and batches through assembly and response: JAX's arrays pass where physical values are numbers."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import jax
import numpy as np
import pytest

import gbeam as gb
import gbeam.arrays.jax_setup
from gbeam.arrays import namespace
from gbeam.results import Base

from ..lagrange import quickly_compiled
from ..specimens import ALUMINIUM, BOX, HUB_INERTIA, HUB_RADIUS, LENGTH, METAL, STRIP

AGREES = 1e-6  # relative, with central differences
SAME = "newmark"  # takes the same steps of a linear structure under JAX; gauss fits them to modes, which are not traced
E = METAL.youngs_modulus
KINDS = {"FOAM": (0, 1, 1), "CFOAM": (1, 1, 1), "exact": (1, 1, 1)}
# What the other direction adds is a program three times as large: one complete model bends in both.
IN_PLANE = {("CFOAM", "slew"): (1, 1, 0), ("exact", "slew"): (1, 1, 0), ("exact", "torque"): (1, 1, 0),
            ("fourth-order", "torque"): (1, 1, 0),
            ("CFOAM", "machine"): (1, 0, 1), ("CFOAM", "tip"): (1, 0, 1), ("exact", "tip"): (1, 0, 1)}  # fmt: skip
OF_BEAM = {"modulus": E, "density": METAL.density, "damping": 0.2}
Values = dict[str, Any]


def slew(at: Values) -> gb.Hub:
    return gb.Hub(radius=at["radius"], rate=gb.SmoothStep(at["rate"], 2.0))


def torque(at: Values) -> gb.Hub:
    return gb.Hub(radius=at["radius"], inertia=at["inertia"], torque=gb.Sine(200.0, 2.0))


def machine(at: Values) -> gb.Centrifuge:
    """The load rises, in 0.1 s, when the machine is up to speed."""
    flight = gb.Flight(z=gb.Sum((gb.constant(2.0), gb.trapezoid(1.0, jerk=10.0, start=0.5037, hold=9.0))))
    ends = {"spin_up": 4.0, "spin_down": 4.0}
    return gb.Centrifuge(flight, arm=at["arm"], control_point=0.1, inverse="flat", gravity=False, smoothing=0.1, **ends)


BASES: dict[str, tuple[Callable[[Values], Any], Values]] = {
    "slew": (slew, {"rate": 3.0, "radius": HUB_RADIUS}),
    "torque": (torque, {"radius": HUB_RADIUS, "inertia": HUB_INERTIA}),
    "machine": (machine, {"arm": 3.3}),
}


def tip_of(kind: str, base: str, *, step: float = 0.02, integrator: str = "gauss") -> Callable[[Values], Any]:
    """Sum of the tip's displacements over time, in lengths, as a function of what beam and base are made of."""
    motion, counts = BASES[base][0], IN_PLANE.get((kind, base)) or KINDS[kind]

    def tip(at: Values) -> Any:
        material = gb.Material(at.get("density", METAL.density), at.get("modulus", E))
        damping = at.get("damping", 0.2)
        length, section, mass = (0.3, STRIP, 0.01) if base == "machine" else (LENGTH, BOX, 0.1)
        beam = gb.Beam(length, section, material, [gb.PointMass(length, mass)], damping_ratio=damping)
        structure = gb.assemble(beam, gb.Model(kind, *counts))
        how = {"step": step, "integrator": integrator, "estimate": False, "loads": False}
        response = gb.simulate(structure, motion(at), duration=3.0, **how)
        return (response.tip / length).sum(axis=1)

    return tip


def agree(function: Callable[[Values], Any], at: Values, slopes: Values | None = None) -> None:
    """The derivative along a change of every value is a central difference of fourth order, of runs without JAX."""
    shares = {name: value * (0.5 + k) for k, (name, value) in enumerate(sorted(at.items()))}
    slopes, h = slopes or quickly_compiled(jax.grad(function))(at), 1e-3

    def apart(steps: int) -> float:
        """Difference of the function over twice so many steps."""
        ends = [{name: value + sign * steps * h * shares[name] for name, value in at.items()} for sign in (1, -1)]
        return float(function(ends[0])) - float(function(ends[1]))

    finite = (8 * apart(1) - apart(2)) / (12 * h)
    assert sum(float(slopes[name]) * shares[name] for name in at) == pytest.approx(finite, rel=AGREES, abs=0.0)
    assert all(slopes.values())


# Every kind of model and every base once; the others cross them.
CROSSED = [("FOAM", "machine"), ("CFOAM", "slew"), ("exact", "torque"), ("fourth-order", "torque")]
OTHERS = [("FOAM", "slew"), ("FOAM", "torque"), ("CFOAM", "torque"), ("CFOAM", "machine"), ("exact", "slew")]


@pytest.mark.parametrize(
    ("kind", "base"), CROSSED + [pytest.param(*each, marks=pytest.mark.thorough) for each in OTHERS]
)
def test_derivatives_of_a_deflection_with_respect_to_what_beam_and_base_are_made_of(kind: str, base: str) -> None:
    tip = tip_of(kind, base, integrator=SAME if (kind, base) == ("FOAM", "machine") else "gauss")
    agree(lambda at: (tip(at)[-50:] ** 2).sum(), OF_BEAM | BASES[base][1])


@pytest.mark.parametrize("base", ["slew", "torque"])
def test_a_batch_of_moduli_is_as_many_runs(base: str) -> None:
    tip, moduli = tip_of("FOAM", base, integrator=SAME), np.array([0.8, 1.0, 1.3]) * E
    at = BASES[base][1]
    together = quickly_compiled(jax.vmap(lambda modulus: tip(at | {"modulus": modulus})))(moduli)
    for batched, modulus in zip(together, moduli, strict=True):
        alone = tip(at | {"modulus": modulus})
        np.testing.assert_allclose(batched, alone, atol=1e-8 * np.abs(alone).max())


def test_steps_that_jax_does_not_fit_have_a_derivative_of_fourth_order() -> None:
    """Against a central difference of runs without JAX, in short steps."""

    def tip(modulus: Any, step: float) -> Any:
        beam = gb.Beam(0.3, STRIP, gb.Material(METAL.density, modulus), damping_ratio=0.01)
        how = {"duration": 0.1, "step": step, "initial": gb.Initial(tip_displacement={"z": 0.02})}
        hub = gb.Hub(radius=HUB_RADIUS, rate=gb.constant(1.0))
        return gb.simulate(gb.assemble(beam, gb.Model("FOAM", z=1)), hub, estimate=False, loads=False, **how).tip[-1, 2]

    wanted = (float(tip(1.001 * E, 1e-4)) - float(tip(0.999 * E, 1e-4))) / (0.002 * E)
    slopes = [quickly_compiled(jax.grad(partial(tip, step=step)))(E) for step in (2.5e-3, 1.25e-3)]
    first, second = (float(slope) / wanted - 1 for slope in slopes)
    assert 12 < first / second < 20 and abs(second) < 1e-3


def test_steps_too_long_for_a_few_corrections_have_a_derivative() -> None:
    """They were NaN, and their derivative 0.0, as if the tip did not mind."""
    tip = tip_of("CFOAM", "slew", step=0.2)
    agree(lambda at: tip(at)[-1], OF_BEAM | BASES["slew"][1])


def test_a_run_that_is_no_number_has_no_derivative() -> None:
    tip = tip_of("CFOAM", "slew", step=0.2)
    slope = quickly_compiled(jax.grad(lambda rate: tip({"rate": rate, "radius": HUB_RADIUS})[-1]))(1e160)
    assert np.isnan(slope)


@pytest.mark.parametrize("kind", KINDS)
def test_derivatives_of_where_a_loaded_beam_rests(kind: str) -> None:
    """With respect to the modulus, a force and the acceleration of the root."""

    def tip(at: Values) -> Any:
        load = gb.Load(LENGTH, force=[0.0, at["force"], 2.0])
        structure = gb.assemble(
            gb.Beam(LENGTH, BOX, gb.Material(METAL.density, at["modulus"]), loads=[load]), gb.Model(kind, *KINDS[kind])
        )
        nothing = np.zeros(3)
        base = Base(namespace(at["pull"]).stack([0.3, at["pull"], 0.2]), nothing, nothing)
        return structure.tip(gb.solve_equilibrium(structure, base).q)[1] * 100

    agree(tip, {"modulus": E, "force": 1.5, "pull": 2.0})


@pytest.mark.parametrize("kind", ["FOAM", pytest.param("CFOAM", marks=pytest.mark.thorough), "exact"])
def test_derivatives_of_a_run_from_a_displaced_tip(kind: str) -> None:
    """With all that a response has besides."""
    counts = IN_PLANE.get((kind, "tip"), KINDS[kind])
    rest = [0.02] * (sum(counts) - 1)

    def tip(at: Values) -> Any:
        beam = gb.Beam(0.3, STRIP, gb.Material(METAL.density, at["modulus"]), damping_ratio=[at["first"], *rest])
        initial = gb.Initial(tip_displacement={"z": 0.02}, tip_velocity={"z": 0.2})
        hub = gb.Hub(radius=HUB_RADIUS, rate=gb.constant(1.0))
        how = {"duration": 0.1, "step": 0.005, "initial": initial, "integrator": SAME}
        response = gb.simulate(gb.assemble(beam, gb.Model(kind, *counts)), hub, **how)
        return (response.tip[5:] ** 2).sum()

    agree(tip, {"modulus": E, "first": 0.01})


SECTIONS: dict[str, tuple[Callable[..., gb.Section], Values]] = {
    "tapered": (
        lambda width, thickness: gb.Section.rectangle([width, 0.01], [thickness, 0.5 * thickness], [0.0, 0.3]),
        {"width": 0.02, "thickness": 0.004},
    ),
    "tube": (gb.Section.tube, {"diameter": 0.01, "wall": 0.001}),
    "general": (
        lambda area, bent, twisted, sheared: gb.Section.general(
            area, bent, 3e-9, torsion_constant=twisted, shear_coefficient_y=0.8, shear_coefficient_z=sheared
        ),
        {"area": 8e-5, "bent": 1e-10, "twisted": 4e-10, "sheared": 0.8},
    ),
}


@pytest.mark.parametrize("shape", SECTIONS)
def test_derivatives_with_respect_to_a_section_that_twists_and_shears(shape: str) -> None:
    """They failed: torsion constants, shear coefficients and tapers left JAX."""
    section, at = SECTIONS[shape]

    def tip(at: Values) -> Any:
        material = gb.Material(2700.0, E, poissons_ratio=at["ratio"])
        aside = gb.PointMass(0.3, 0.05, offset=(0.0, 0.02, 0.01))
        beam = gb.Beam(0.3, section(**{k: at[k] for k in at if k != "ratio"}), material, [aside], damping_ratio=0.01)
        structure = gb.assemble(beam, "FOAM", z=1, twist=1, shear_z=1)
        how = {"duration": 0.1, "step": 0.005, "initial": "undeformed", "estimate": False, "loads": False}
        how |= {"integrator": SAME}
        response = gb.simulate(structure, gb.Flight(z=gb.Sine(30.0, 12.0)), **how)
        return (response.tip[-5:] @ np.array([1.0, 2.0, 3.0]) * 1e3).sum()

    agree(tip, at | {"ratio": 0.33})


OF_MATRICES = {"stretched": 5.6e6, "bent": 7.0, "twisted": 3.0, "mass": 0.2, "aside": 2e-3, "turned": 7e-6}


def by_matrices(at: Values, kind: Any) -> gb.Structure:
    """A beam that couples stretch, twist and bending, with the mass beside its axis and half as much of all at the tip;
    its slices are as thick as "lengthwise" says.
    """
    xp = namespace(*at.values())
    coupled = np.zeros((6, 6))
    coupled[4, [0, 3]] = 1000.0, 1.4
    stiffness = xp.diag(xp.stack([at["stretched"], 1e6, 1e6, at["twisted"], at["bent"], 170.0])) + coupled + coupled.T
    arm, each = at["aside"] * np.array([0.0, 2.0, 1.0]), at["mass"] * np.eye(3)
    lever = xp.cross(arm, np.eye(3))  # the rows are c × e, of m [c]×ᵀ
    about = at["turned"] * np.array([[3.0, 0.0, 0.0], [0.0, 1.0, 0.3], [0.0, 0.3, 2.0]])
    about = about - at.get("lengthwise", 0.0) * np.diag([1.0, 0.0, 0.0])
    mass = xp.block([[each, at["mass"] * lever], [at["mass"] * lever.T, about + at["mass"] * lever @ lever.T]])
    both = (xp.stack([matrix, 0.5 * matrix]) for matrix in (stiffness, mass))
    beam = gb.Beam(0.3, gb.Section.of_matrices(*both, stations=[0.0, 0.3]), damping_ratio=0.01, rotary_inertia=True)
    return gb.assemble(beam, kind, y=1, z=1, twist=1)


@pytest.mark.parametrize(
    ("kind", "of_slices"),
    [pytest.param("FOAM", {}, marks=pytest.mark.thorough), ("exact", {"lengthwise": 3e-6})],
)
def test_derivatives_with_respect_to_a_sections_matrices(kind: str, of_slices: Values) -> None:
    """They were refused."""

    def tip(at: Values) -> Any:
        how = {"duration": 0.1, "step": 0.005, "initial": "undeformed", "estimate": False, "loads": False}
        how |= {"integrator": SAME}
        response = gb.simulate(by_matrices(at, kind), gb.Hub(radius=HUB_RADIUS, rate=gb.SmoothStep(10.0, 0.1)), **how)
        return (response.tip[-5:] @ np.array([1.0, 2.0, 3.0]) * 1e3).sum()

    agree(tip, OF_MATRICES | of_slices)


def test_slices_without_thickness_have_a_derivative_with_respect_to_it() -> None:
    """A root of their moment along the beam, zero, has none; the mass matrix is linear in it."""

    def mass(lengthwise: Any) -> Any:
        return by_matrices(OF_MATRICES | {"lengthwise": lengthwise}, "FOAM").coefficients.mass.sum()

    assert quickly_compiled(jax.grad(mass))(0.0) == pytest.approx((mass(1e-6) - mass(0.0)) / 1e-6, rel=1e-8)


def test_a_held_target_is_turned_by_the_arms_number() -> None:
    def turned(arm: Any) -> Any:
        flight = gb.Flight(z=gb.Sine(20.0, 1.0))
        held = gb.Centrifuge(flight, arm=arm, control_point=0.1, gravity=False, smoothing=0.1, idle=20.0)
        return held.over(0.0, 3.0).base(1.0).a_WO_B.sum()

    with pytest.raises(gb.InputError, match="arm is traced by JAX, and by its number the target turns"):
        quickly_compiled(jax.grad(turned))(3.3)


@pytest.mark.parametrize(
    ("beam", "words"),
    [
        (lambda x: gb.Beam(x, STRIP, ALUMINIUM), "length is traced by JAX"),
        (lambda x: gb.Beam(0.3, STRIP, ALUMINIUM, [gb.PointMass(x, 0.1)]), r"masses\[0\].at is traced by JAX"),
    ],
)
def test_what_places_the_shapes_cannot_be_traced(beam: Any, words: str) -> None:
    with pytest.raises(gb.InputError, match=words):
        jax.grad(lambda x: gb.assemble(beam(x), "FOAM", z=2).coefficients.mass.sum())(0.25)


def test_adapted_shapes_cannot_be_traced() -> None:
    def stiffness(modulus: Any) -> Any:
        beam = gb.Beam(0.3, STRIP, gb.Material(2700.0, modulus))
        return gb.assemble(beam, "FOAM", z=2, shapes="adapted").coefficients.stiffness.sum()

    with pytest.raises(gb.InputError, match="shapes adapted to a beam that JAX traces"):
        quickly_compiled(jax.grad(stiffness))(70e9)
