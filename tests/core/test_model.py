"""Putting a beam into a model: what is refused, damping, tapers, stations, the table of models."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import quad

from gbeam import Beam, InputError, Model, PointMass, Section, Structure, assemble
from gbeam.mechanics import MODEL_KINDS as KINDS
from gbeam.mechanics import bar_shapes, bending_shapes

from ..specimens import ALUMINIUM, TIP, appendage
from ..specimens import STRIP_DENSITY as DENSITY
from ..specimens import STRIP_LENGTH as L
from ..specimens import STRIP_YOUNG as E
from ..specimens import strip_beam as strip

EXACT = 1e-10

REFUSED: list[tuple[str, str, Callable[[], object]]] = [
    ("kind", "is 'foam'", lambda: Model("foam", 1, 1, 1)),
    ("modes.axial", "is -1", lambda: Model("FOAM", -1, 1, 1)),
    ("modes.y", "is 1.5", lambda: Model("FOAM", 1, 1.5, 1)),  # type: ignore[arg-type]
    ("z", "is '3'", lambda: Model("FOAM", 1, 1, "3")),  # type: ignore[arg-type]
    ("modes", "are all zero", lambda: Model("exact", 0, 0, 0)),
    ("modes.axial", "is 1 for SFOAM", lambda: Model("SFOAM", 1, 1, 1)),
    ("stations[1]", "is 0.31 m, off the beam", lambda: assemble(strip(), Model("FOAM", 0, 0, 1), [0.1, 0.31])),
    ("stations[0]", "is -0.1 m", lambda: assemble(strip(), Model("FOAM", 0, 0, 1), -0.1)),
    ("stations[0]", "is nan m", lambda: assemble(strip(), Model("FOAM", 0, 0, 1), np.nan)),
    (
        "damping_ratio",
        "lists 2 values for the 3 modes",
        lambda: assemble(strip(damping_ratio=[0.01, 0.02]), Model("FOAM", 1, 1, 1)),
    ),
]


@pytest.mark.parametrize(
    ("where", "problem", "make"), REFUSED, ids=[f"{where}: {problem}" for where, problem, _ in REFUSED]
)
def test_refused(where: str, problem: str, make: Callable[[], object]) -> None:
    with pytest.raises(InputError) as caught:
        make()
    assert caught.value.where == where
    assert problem in caught.value.problem
    assert caught.value.fix


def test_table_of_models() -> None:
    """TLAM does not shorten; three are complete, two by strains; SFOAM has no Q_θ and no axial coordinates."""
    assert list(KINDS) == ["TLAM", "FOAM", "SFOAM", "CFOAM", "fourth-order", "exact"]
    assert [row.order for row in KINDS.values()] == [1, 2, 2, 2, 4, None]
    assert [k for k, row in KINDS.items() if not row.truncated] == ["CFOAM", "fourth-order", "exact"]
    assert [k for k, row in KINDS.items() if row.strains] == ["fourth-order", "exact"]
    assert [k for k, row in KINDS.items() if not row.hub_force] == ["SFOAM"]
    assert [k for k, row in KINDS.items() if not row.axial] == ["SFOAM"]
    structure = assemble(appendage(TIP), Model("SFOAM", 0, 2, 0))
    assert (structure.linear, structure.hub_force, structure.counts, structure.size) == (
        True,
        False,
        (0, 2, 0, 0, 0, 0),
        2,
    )


def test_stations_end_with_the_tip_once() -> None:
    for asked, wanted in (((), [L]), ([0.0, 0.2], [0.0, 0.2, L]), ([0.2, L], [0.2, L]), (L, [L])):
        structure = assemble(strip(), Model("FOAM", 1, 1, 1), asked)
        np.testing.assert_array_equal(structure.stations, wanted)
        assert structure.displacement(np.zeros(3)).shape == (len(wanted), 3)


def test_displacement_at_stations_is_the_shapes() -> None:
    x = np.array([0.1, 0.2])
    moved = assemble(strip(), Model("TLAM", 1, 1, 1), x).displacement(np.array([1e-3, 2e-3, 3e-3]))
    s, f = bar_shapes(np.append(x, L), L, 1).value[:, 0], bending_shapes(np.append(x, L), L, 1).value[:, 0]
    np.testing.assert_allclose(moved, np.stack([1e-3 * s, 2e-3 * f, 3e-3 * f], axis=1), atol=1e-15)


def at_rest(structure: Structure) -> tuple[np.ndarray, np.ndarray]:
    """Mass and stiffness of the straight beam on a base at rest."""
    return structure.coefficients.mass, structure.coefficients.stiffness


def test_uniform_beam_has_closed_form_matrices_and_frequencies() -> None:
    """M = ρAL, K = diag(EA L k², EI_z λ⁴/L³, EI_y λ⁴/L³): 2020 (14), (22); I_y goes with z (its (8) swaps them)."""
    mass, stiffness = at_rest(assemble(strip(), Model("FOAM", 2, 2, 2)))
    area = 8e-5
    np.testing.assert_allclose(mass, DENSITY * area * L * np.eye(6), atol=1e-15)
    k = np.array([1, 3]) * np.pi / (2 * L)
    lam4 = np.array([1.875104068711961, 4.694091132974175]) ** 4 / L**3
    wanted = np.concatenate([E * area * L * k**2, E * 0.004 * 0.02**3 / 12 * lam4, E * 0.02 * 0.004**3 / 12 * lam4])
    np.testing.assert_allclose(stiffness, np.diag(wanted), atol=EXACT * wanted.max())


def test_taper_and_point_mass_against_quadrature() -> None:
    """A taper with a corner: M = ∫ρA f fᵀ + m f(l) f(l)ᵀ and K = ∫EI f'' f''ᵀ by adaptive quadrature."""
    taper = Section.rectangle([0.03, 0.02, 0.02], [0.006, 0.004, 0.001], [0.0, 0.1, L])
    loaded = Beam(L, taper, ALUMINIUM, [PointMass(0.22, 0.05)], rotary_inertia=False)
    mass, stiffness = at_rest(assemble(loaded, Model("FOAM", 0, 0, 2)))

    def integral(entry: Callable[[float], float]) -> float:
        return sum(quad(entry, *panel, epsabs=0, epsrel=1e-12)[0] for panel in ((0, 0.1), (0.1, L)))

    def f(x: float, order: int) -> np.ndarray:
        return bending_shapes(np.array([x]), L, 2)[order][0]

    at_mass = f(0.22, 0)
    for i in range(2):
        for j in range(2):
            m = integral(lambda x, i=i, j=j: DENSITY * float(taper.at(x).area) * f(x, 0)[i] * f(x, 0)[j])
            k = integral(lambda x, i=i, j=j: E * float(taper.at(x).inertia_y) * f(x, 2)[i] * f(x, 2)[j])
            np.testing.assert_allclose(mass[i, j], m + 0.05 * at_mass[i] * at_mass[j], rtol=EXACT, atol=1e-12)
            np.testing.assert_allclose(stiffness[i, j], k, rtol=EXACT)


@pytest.mark.parametrize("ratio", [0.02, [0.01, 0.02, 0.03, 0.04, 0.05]])
def test_modal_damping_ratios(ratio: float | list[float]) -> None:
    structure = assemble(appendage(TIP, damping_ratio=ratio), Model("FOAM", 1, 2, 2))
    frequency, modes = structure.rest
    modal = modes.T @ structure.coefficients.damping @ modes
    np.testing.assert_allclose(modal, np.diag(2 * np.broadcast_to(ratio, 5) * frequency), atol=1e-9)


def test_rest_modes_are_normalised_and_ascending() -> None:
    structure = assemble(appendage(TIP), Model("exact", 1, 3, 2))
    (mass, stiffness), (frequency, modes) = at_rest(structure), structure.rest
    assert (np.diff(frequency) >= 0).all()
    np.testing.assert_allclose(modes.T @ mass @ modes, np.eye(6), atol=1e-10)
    np.testing.assert_allclose(modes.T @ stiffness @ modes, np.diag(frequency**2), atol=1e-6 * frequency[-1] ** 2)


def test_all_models_are_one_beam_at_rest() -> None:
    """Without a moving base all models have the same small vibrations; exact's shapes are others but span them."""
    exact = assemble(strip(), Model("exact", 1, 0, 7)).rest[0][:2]
    for kind in ("FOAM", "CFOAM"):
        frequency = assemble(strip(), Model(kind, 1, 0, 4)).rest[0][:2]
        np.testing.assert_allclose(frequency, exact, rtol=1e-7, err_msg=kind)
