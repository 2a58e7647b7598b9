"""Maxwell and Betti: what a force here does there, the same force there does here; still, and at any frequency."""

from __future__ import annotations

import numpy as np
from hypothesis import given

from gbeam import Beam, Hub, Load, Model, assemble, constant, linearize, solve_equilibrium
from gbeam.results import Base

from .strategies import beams, few, first_frequency, numbers, theorem, vectors


@theorem
@given(beam=beams(springs=True), places=vectors(0.5, 2), first=vectors(1.0), second=vectors(1.0), a=vectors(30.0))
def test_influence(beam: Beam, places: np.ndarray, first: np.ndarray, second: np.ndarray, a: np.ndarray) -> None:
    """F₁·u₁(F₂) = F₂·u₂(F₁), on a base that accelerates along the beam as well."""
    at = beam.length * (0.505 + 0.99 * places)  # at the root a force moves nothing but rounding
    base = Base(np.array([a[0], 0.0, 0.0]), np.zeros(3), np.zeros(3))
    across = np.array([0.0, 1.0, 1.0])
    forces = [1e-3 * (f + 0.1) * across for f in (first, second)]

    def moved(force: np.ndarray, at_load: float, at_point: float) -> np.ndarray:
        load = Load(at_load, force=tuple(force))
        loaded = Beam(beam.length, beam.section, beam.material, beam.masses, beam.damping_ratio, beam.root, [load])
        structure = assemble(loaded, Model("FOAM", 1, 4, 4), [at_point])
        return structure.displacement(solve_equilibrium(structure, base).q)[0]

    none = np.zeros(3)
    second_there = moved(forces[0], at[0], at[1]) - moved(none, at[0], at[1])
    first_there = moved(forces[1], at[1], at[0]) - moved(none, at[1], at[0])
    size = np.linalg.norm(forces[1]) * np.linalg.norm(second_there)
    np.testing.assert_allclose(forces[1] @ second_there, forces[0] @ first_there, atol=1e-6 * size, rtol=0)


@few
@given(beam=beams(), share=numbers(0.1, 4.0), speed=numbers(0.0, 0.5), way=vectors(1.0))
def test_transfer_functions(beam: Beam, share: float, speed: float, way: np.ndarray) -> None:
    """H_yz(iω; Ω) = H_zy(iω; −Ω) of the tip under tip forces: the spin turns with the roles (Onsager, Casimir)."""
    loaded = Beam(beam.length, beam.section, beam.material, beam.masses, beam.damping_ratio, beam.root,
                  [Load(beam.length, force=(0.0, 0.0, 0.0))])  # fmt: skip
    structure = assemble(loaded, Model("FOAM", 1, 3, 3))
    scale = first_frequency(beam)

    def transfer(rate: float) -> np.ndarray:
        plant = linearize(structure, Hub(radius=0.3, rate=constant(rate), setting_angle=float(way[0])))
        rows = [[s.name for s in plant.outputs].index(f"tip_{i}") for i in "xyz"]
        columns = [[s.name for s in plant.inputs].index(f"load_1_force_{i}") for i in "xyz"]
        return plant.c[rows] @ np.linalg.solve(
            1j * share * scale * np.eye(len(plant.a)) - plant.a, plant.b[:, columns]
        ) + plant.d[np.ix_(rows, columns)]  # fmt: skip

    forward, back = transfer(speed * scale), transfer(-speed * scale)
    np.testing.assert_allclose(forward, back.T, atol=1e-9 * np.abs(forward).max(), rtol=0)
