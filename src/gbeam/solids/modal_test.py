"""Modes that were measured, or computed by another program, as a structure on a moving base."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike

from gbeam.arrays.tree import Value
from gbeam.arrays.types import Floats
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import array
from gbeam.guards.quantities import OfKind, OneOrSome, Quantity, Rows
from gbeam.io.models.registry import model_of
from gbeam.mechanics.equations.linear import Geometric, coefficients
from gbeam.mechanics.fields.taylor import Places
from gbeam.mechanics.structure import Structure, linear_structure
from gbeam.solids.matrices import EXACT, mass_defect, with_tip

LOOSE = 0.5  # of a modal mass, which the masses of the nodes do not have
CURVED = 0.1  # of a shape, which moves out of phase


@typed
@dataclass(frozen=True, eq=False)
class ModalTest(Value):
    """Modes on a base at rest: frequencies, damping and shapes, as a modal test or another program gives them.

    Raises
    ------
    InputError
        If shapes do not fit, a frequency or a modal mass is not positive, or a shape moves out of phase by over 10 %.

    Examples
    --------
    >>> test = gb.ModalTest([20.0], [0.01], [[[0.0], [0.0], [1.0]]], nodes=[(0.3, 0, 0)], modal_mass=0.1)
    >>> test.structure(mass=[0.1])
    Structure(modes, 1 coordinates, 0.1 kg)
    """

    frequency: Annotated[ArrayLike, Quantity("frequency"), "natural frequencies, one for each mode"]
    damping_ratio: Annotated[
        ArrayLike, Quantity("ratio"), OneOrSome(), "of critical damping, of every mode, or one for each"
    ]
    shapes: Annotated[
        Any,
        "displacements (nodes, 3, modes) along the base axes; of complex modes the part in phase is taken",
    ]
    nodes: Annotated[ArrayLike, Quantity("length"), Rows(3), "places (k, 3) of the nodes from the root, base axes"]
    modal_mass: Annotated[
        Any, OfKind("mass"), "that goes with the shapes, of every mode, or one for each: 1 kg of mass-normalised ones"
    ]
    numbers: Annotated[ArrayLike | None, "numbers (k,) of the nodes, 0 to k - 1 where left out"] = None

    def __post_init__(self) -> None:
        """Check the modes, turn complex shapes in phase, and sort all by frequency."""
        frequency, ratio = (np.atleast_1d(np.asarray(array(n, getattr(self, n)), dtype=float)) for n in _RATES)
        nodes = np.asarray(array("nodes", self.nodes), dtype=float)
        shapes, mass = (_numbers(name, getattr(self, name)) for name in ("shapes", "modal_mass"))
        m = len(frequency)
        if nodes.ndim != 2 or nodes.shape[1:] != (3,) or shapes.shape != (len(nodes), 3, m):
            fix = f"give a row of x, y, z for each node, and shapes ({len(nodes)}, 3, {m})"
            raise InputError("shapes", f"are {shapes.shape}, of {len(nodes)} nodes and {m} frequencies", fix)
        if mass.shape not in ((), (m,)):
            raise InputError("modal_mass", f"has the shape {mass.shape}", f"give {m}, or one for all")
        shapes, mass = _in_phase(shapes, np.broadcast_to(mass, (m,)))
        measured = {"frequency": frequency, "damping_ratio": np.broadcast_to(ratio, (m,)), "modal_mass": mass}
        for name, value in measured.items():
            low = value < 0 if name == "damping_ratio" else ~(value > 0)
            if not np.isfinite(value).all() or low.any():
                i = int(np.argmax(low | ~np.isfinite(value)))
                raise InputError(f"{name}[{i}]", f"is {value[i]:g}", "give a positive one; a file may lack it")
        numbers = np.arange(len(nodes)) if self.numbers is None else np.asarray(self.numbers, dtype=int)
        if not np.isfinite(shapes).all() or numbers.shape != (len(nodes),):
            raise InputError("shapes", "or numbers are not finite, or not one for each node", "give them so")
        order = np.argsort(frequency, kind="stable")
        for name, value in measured.items():
            object.__setattr__(self, name, value[order])
        for name, value in (("shapes", shapes[..., order]), ("nodes", nodes), ("numbers", numbers)):
            object.__setattr__(self, name, value)

    @classmethod
    @typed
    def read(
        cls,
        path: Annotated[str | os.PathLike[str], "universal file (.uff, .unv) of the modes and the nodes"],
        *,
        modal_mass: Annotated[
            ArrayLike | None, Quantity("mass"), "of every mode, or one for each, in place of those in the file"
        ] = None,
    ) -> ModalTest:
        """Read the modes of a universal file (.uff, .unv), data sets 55 or 2414 beside 15 or 2411, in its units, or SI.

        Raises
        ------
        InputError
            If the file has no modes, or no nodes.

        Examples
        --------
        >>> try:
        ...     gb.ModalTest.read("panel.csv")
        ... except gb.InputError as error:
        ...     print(str(error)[:30])
        path panel.csv ends in .csv; g
        """
        model = model_of([path])
        if model.modes is None:
            raise InputError("path", f"{path} has no modes", "export shapes as data sets 55 or 2414")
        numbers = np.asarray(model.modes["numbers"])
        places, _, _, _ = model.nodes_of(None, np.column_stack([numbers, np.ones_like(numbers)]))
        order = np.argsort(numbers, kind="stable")
        mass = model.modes["modal_mass"] if modal_mass is None else modal_mass
        shapes = model.modes["shape"][order]
        return cls(model.modes["frequency"], model.modes["damping_ratio"], shapes, places, mass, numbers[order])

    @typed
    def structure(
        self,
        mass: Annotated[
            ArrayLike,
            Quantity("mass"),
            "share (k,) of the structure's mass at each node: what the base's motion acts on, which modes do not tell",
        ],
        *,
        points: Annotated[
            Mapping[str, int] | None,
            "numbers of nodes of output by name; the ``tip`` is the farthest from the root otherwise",
        ] = None,
        kind: Annotated[str, "name for results"] = "modes",
    ) -> Structure:
        """Structure that moves in these modes.

        Raises
        ------
        InputError
            If the masses do not fit, or hold less than half of a modal mass, or over one and a half.

        Examples
        --------
        >>> test = gb.ModalTest([20.0], [0.01], [[[0.0], [0.0], [1.0]]], nodes=[(0.3, 0, 0)], modal_mass=0.1)
        >>> print(test.structure(mass=[0.11]).warnings[1])
        the masses of the nodes are up to 10 % away from a modal mass
        """
        at, shapes = np.asarray(self.nodes), np.asarray(self.shapes)
        weights = np.asarray(array("mass", mass), dtype=float)
        if weights.shape != (len(at),) or not (np.isfinite(weights).all() and (weights >= 0).all() and weights.any()):
            raise InputError("mass", f"has the shape {weights.shape}, or is negative", f"give {len(at)} masses in kg")
        modal = np.asarray(self.modal_mass)
        missing = mass_defect(np.diag(weights), shapes / np.sqrt(modal))
        if missing > LOOSE:
            problem = f"of the nodes gives a mode a mass that is {100 * missing:.0f} % away from its modal mass"
            raise InputError("mass", problem, "are the shapes scaled with the modal masses? Measure at more nodes")
        doubts = ["no geometric stiffness is given: what the stress of loads stiffens or softens is left out"]
        if missing > EXACT:
            doubts.append(f"the masses of the nodes are up to {100 * missing:.2g} % away from a modal mass")
        numbers, named = list(np.asarray(self.numbers)), points or {}
        for name, number in named.items():
            if number not in numbers:
                raise InputError(f"points.{name}", f"is {number}, which is no node", "give the number of one")
        chosen = with_tip({name: numbers.index(number) for name, number in named.items()}, at)
        n = shapes.shape[-1]
        zero = np.zeros((3, n, n))
        stiffness = np.diag(modal * (2 * np.pi * np.asarray(self.frequency)) ** 2)
        places = Places(at, shapes)
        geometric = Geometric(zero, zero, np.zeros((3, 3, n, n)))
        return linear_structure(
            replace(coefficients(weights, places, stiffness, geometric=geometric), mass=np.diag(modal)),
            weights,
            places,
            places[list(chosen.values())],
            length=float(np.linalg.norm(at, axis=1).max()),
            damping_ratio=tuple(np.asarray(self.damping_ratio).tolist()),
            points=tuple(chosen),
            kind=kind,
            warnings=tuple(doubts),
            unstiffened=True,
        )


_RATES = ("frequency", "damping_ratio")


def _numbers(where: str, value: Any) -> Any:
    """Convert values to an array of real or complex numbers."""
    numbers = np.asarray(value)
    if numbers.dtype.kind not in "iufc":
        raise InputError(where, f"is {type(value).__name__}", "give numbers, real or complex")
    return numbers


def _in_phase(shapes: Floats, mass: Floats) -> tuple[Floats, Floats]:
    """Real shapes of complex ones (k, 3, m), turned in phase, and the modal masses (m,) that go with them."""
    if np.isrealobj(shapes):
        return shapes.astype(float), np.real(mass).astype(float)
    # The phase at which the sum of squares is real and positive: what remains imaginary is then smallest.
    turn = np.exp(-0.5j * np.angle((shapes**2).sum(axis=(0, 1))))
    turned = shapes * turn
    imaginary = np.linalg.norm(turned.imag, axis=(0, 1)) / np.linalg.norm(turned, axis=(0, 1))
    if imaginary.max() > CURVED:
        i = int(imaginary.argmax())
        problem = f"moves out of phase by {100 * imaginary[i]:.0f} %"
        raise InputError(f"shapes[{i}]", problem, "give normal modes: gbeam's damping does not couple modes")
    return turned.real, np.real(mass * turn**2)
