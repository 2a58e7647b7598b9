"""Flexible bodies by standard input data, whose constant coefficients are those of gbeam's linear equations."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Annotated, Any

import numpy as np

from gbeam.arrays.types import Floats
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.quantities import ModalDamping
from gbeam.io.models.registry import model_of
from gbeam.mechanics.equations.linear import PAIRS, Coefficients, rest_modes
from gbeam.mechanics.fields.taylor import EPSILON, Places
from gbeam.mechanics.holding import held_at_points
from gbeam.mechanics.reduction import equivalent_particles
from gbeam.mechanics.structure import Structure, linear_structure
from gbeam.solids.matrices import with_tip
from gbeam.structure.supports import Support

ALIKE = 1e-6  # of the largest: two ways to the same moments
# Columns of the centrifugal terms: the standard's, and another that is met.
ORDERS = (((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)), ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))
SHAPES = "supports hold the body in the shapes that it has: what shapes it lacks there is not known"


@typed
def read_sid(
    path: Annotated[
        str | os.PathLike[str],
        "text of the object ``modal``, in SI: mass, centre, inertia, coupling, gyroscopic and centrifugal terms with "
        "their geometric stiffness, stiffness, damping, and nodes",
    ],
    *,
    damping_ratio: Annotated[ModalDamping | None, "of critical damping, in place of the damping in the file"] = None,
    points: Annotated[
        Mapping[str, int] | None,
        "numbers of nodes of output by name; the ``tip`` is the farthest from the root otherwise",
    ] = None,
    supports: Annotated[
        Sequence[Support],
        "places that the base holds besides: [ { at, holds, stiffness, damping } ], each a point by its name; the body "
        "keeps the shapes of its file",
    ] = (),
    kind: Annotated[str, "name for results"] = "standard input data",
) -> Structure:
    """Read a flexible body of standard input data (SID).

    Returns
    -------
    Structure
        Bodies of a :class:`gbeam.System` hang on its points, which turn as the file says.

    Raises
    ------
    InputError
        If the file lacks a part, its parts contradict one another, it has stress at rest, or it has no damping and none
        is given.

    Notes
    -----
    The polynomials are those of Wallrapp, O., "Standardization of flexible body modeling in multibody system codes",
    Mechanics of Structures and Machines 22 (1994) 283-304. Geometric stiffness is in the slopes of Ct, Cr and Oe; where
    those of Ct are zero, every result says that it is left out, and of how much in its motion.

    Examples
    --------
    >>> gb.read_sid("examples/data/strip.sid", damping_ratio=0.01)
    Structure(standard input data, 2 coordinates, 0.0648 kg)
    """
    body = model_of([path]).body
    if body is None or not body["nodes"]:
        raise InputError("path", f"{path} has no body with nodes", "export standard input data with one node or more")
    terms = _coefficients(body, os.fspath(path))
    if damping_ratio is None and not terms.damping.any():
        raise InputError("damping_ratio", "is missing, and the file has no damping", "give one, such as 0.01, or 0")
    places = np.stack([node["origin"]["m0"][:, 0] for node in body["nodes"]])
    numbers = list(body["numbers"])
    for name, number in (points or {}).items():
        if number not in numbers:
            fix = f"choose from {', '.join(map(str, numbers))}"
            raise InputError(f"points.{name}", f"is {number}, which is no node of the file", fix)
    chosen = with_tip({name: numbers.index(number) for name, number in (points or {}).items()}, places)
    nodes = [body["nodes"][k] for k in chosen.values()]
    second = np.stack([np.moveaxis(_slope(node["phi"], terms.size), 1, 2) for node in nodes])
    stations = Places(
        places[list(chosen.values())],
        np.stack([node["phi"]["m0"] for node in nodes]),
        (second + second.swapaxes(2, 3)) / 2,
    )
    sums, moments = -terms.f_a, _moments(terms)
    lacking = not np.any(terms.k_a)
    mass, *paths = equivalent_particles(np.asarray(terms.rigid), sums, moments)
    structure = linear_structure(
        terms,
        mass,
        Places(*paths),
        stations,
        length=float(np.linalg.norm(places, axis=1).max()),
        turns=np.stack([node["psi"]["m0"] for node in nodes]),
        damping_ratio=0.0 if damping_ratio is None else damping_ratio,
        points=tuple(chosen),
        kind=kind,
        warnings=("Ct has no geometric stiffness: what the stress of loads stiffens or softens is left out",) * lacking,
        unstiffened=lacking,
    )
    if damping_ratio is None:
        structure = replace(structure, coefficients=terms)
    if supports:
        structure = held_at_points(structure, supports, damping_ratio, rooted=True)
        if not structure.size:
            fix = "hold fewer directions, or export the body with more shapes"
            raise InputError("supports", f"hold all {terms.size} shapes of the body", fix)
        structure = replace(structure, warnings=(*structure.warnings, SHAPES))
    if damping_ratio is not None:
        return structure
    terms = structure.coefficients
    frequency, modes = rest_modes(terms.mass, terms.stiffness)
    ratios = tuple(np.diagonal(modes.T @ terms.damping @ modes) / (2 * frequency))
    return replace(structure, damping_ratio=ratios)


def _slope(block: Mapping[str, Floats], count: int) -> Floats:
    """Change of a polynomial with the coordinates, (rows, n, columns); zero if the file has a constant part alone."""
    slope = block["m1"]
    return slope if slope.shape[1] == count else np.zeros((slope.shape[0], count, slope.shape[2]))


def _coefficients(body: Mapping[str, Any], path: str) -> Coefficients:
    """Coefficients of the linear equations from the blocks of a body, named as in the standard: `m0` is the constant
    part of each, `m1` its change with the coordinates.
    """
    n = body["Me"]["m0"].shape[0]
    if "ksigma" in body and body["ksigma"]["m0"].any():
        raise InputError("path", f"{path} has stress at rest (ksigma)", "export the body at rest, without a load")
    f_ww, order = _centrifugal(body, path, n)
    ge = body["Ge"]["m0"].reshape(n, n, 3)  # [row, coordinate, axis]
    inertia = body["J"]["m0"]
    second = np.trace(inertia) / 2 * np.eye(3) - inertia
    pairs = (second[i, j] for i, j in PAIRS)
    return Coefficients(
        mass=body["Me"]["m0"],
        damping=body["De"]["m0"] if "De" in body and body["De"]["m0"].any() else np.zeros((n, n)),
        stiffness=body["Ke"]["m0"],
        gyroscopic=np.moveaxis(ge, -1, 0),
        k_ww=_pair_coefficients(np.moveaxis(_slope(body["Oe"], n), -1, 0), order),
        k_al=np.moveaxis(_slope(body["Cr"], n), -1, 0),
        k_a=np.moveaxis(_slope(body["Ct"], n), -1, 0),
        f_ww=f_ww,
        f_al=-body["Cr"]["m0"].T,
        f_a=-body["Ct"]["m0"].T,
        rigid=np.array([float(body["mass"]), *body["mdCM"]["m0"][:, 0], *pairs]),
    )


def _centrifugal(body: Mapping[str, Any], path: str, n: int) -> tuple[Floats, Any]:
    """Centrifugal loads (3, 3, n), and the order of the rates' products in the file's terms Oe.

    It is the order in which Oe agrees with the inertia J = J₀ + J₁ q, where ½ ω J₁ ω is the load.
    """
    f_ww = np.moveaxis(_slope(body["J"], n), 1, -1) / 2
    along = -body["Oe"]["m0"]
    for order in ORDERS:
        f_oe = _pair_coefficients(along.T[:, :, None], order)[..., 0]
        if np.abs(f_oe - f_ww).max() <= ALIKE * np.abs(along).max():
            return f_ww, order
    if f_ww.any():
        fix = "export it again: ½ dJ/dq is the force of a rotation"
        raise InputError("path", f"{path} has centrifugal terms Oe that its inertia J contradicts", fix)
    return _pair_coefficients(along.T[:, :, None], ORDERS[0])[..., 0], ORDERS[0]


def _pair_coefficients(columns: Floats, order: Any) -> Floats:
    """Symmetric coefficients (3, 3, ...) of pairs of rates, from those (6, ...) of their six products in an order."""
    full = np.zeros((3, 3, *columns.shape[1:]))
    for column, (i, j) in zip(columns, order, strict=True):
        full[i, j] += column / 2
        full[j, i] += column / 2
    return full


def _moments(terms: Coefficients) -> Floats:
    """Moments Σ m r_b ∂r_a/∂q (3, 3, n), symmetric parts from centrifugal loads, antisymmetric from Euler's force."""
    half = np.einsum("aai->i", terms.f_ww) / 2
    even = -terms.f_ww + np.eye(3)[..., None] * half
    return even + np.einsum("cab,ci->abi", EPSILON, terms.f_al) / 2
