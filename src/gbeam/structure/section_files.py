"""Stiffness and mass matrices of sections in files of VABS and BECAS."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gbeam.errors import InputError
from gbeam.guards.limits import TEXT_BYTES, refuse_large_file
from gbeam.guards.units import UnitError, quantity

Array = NDArray[np.float64]


class Program(NamedTuple):
    """A program that writes a section's matrices: their titles, its rows in our order, and what to ask it for."""

    stiffness: str
    mass: str
    rows: tuple[int, ...]
    fix: str


# VABS writes x along the beam, BECAS z. Another program is one line here.
PROGRAMS = {
    "VABS": Program(
        "Timoshenko Stiffness Matrix (1-extension",
        "The 6X6 Mass Matrix",
        (0, 1, 2, 3, 4, 5),
        "ask VABS for Timoshenko's model, with densities of the materials",
    ),
    "BECAS": Program(
        "Stiffness matrix w.r.t. to the cross section reference point",
        "Mass matrix w.r.t. to the cross section reference point",
        (2, 0, 1, 5, 3, 4),
        "write the output by BECAS 2.3 or later, which has the mass matrix",
    ),
}


def read_matrices(path: str | os.PathLike[str], length_unit: str, mass_unit: str) -> tuple[Array, Array]:
    """Stiffness and mass matrices (6, 6) of a file, in SI, whose unit of time is the second."""
    refuse_large_file("path", path, TEXT_BYTES, "give the output of one section")
    lines = Path(path).read_text(encoding="utf-8", errors="replace").splitlines()
    written = [name for name, each in PROGRAMS.items() if _rows(lines, each.stiffness) or _rows(lines, each.mass)]
    if not written:
        known = "the .K of VABS, or the .out of BECAS"
        raise InputError("path", f"{path} has no matrices of a section", f"give {known}; or the matrices themselves")
    program = PROGRAMS[written[0]]
    both = []
    for what, title in (("stiffness", program.stiffness), ("mass", program.mass)):
        rows = _rows(lines, title)
        if len(rows) != 6:
            raise InputError("path", f"{path} of {written[0]} has no {what} matrix of six rows", program.fix)
        both.append(np.array(rows)[np.ix_(program.rows, program.rows)])
    length, mass = _size("length_unit", length_unit, "length"), _size("mass_unit", mass_unit, "mass")
    turned = np.repeat([1.0, length], 3)
    scale = np.outer(turned, turned)
    return both[0] * scale * mass * length, both[1] * scale * mass / length


def _rows(lines: list[str], title: str) -> list[list[float]]:
    """Rows of six numbers below the first line that has a title."""
    at = next((k for k, line in enumerate(lines) if line.strip().startswith(title)), None)
    return [] if at is None else list(_matrix(lines[at + 1 : at + 12]))


def _matrix(lines: list[str]) -> Iterator[list[float]]:
    count = 0
    for line in lines:
        try:
            row = [float(each.replace("D", "E")) for each in line.split()]
        except ValueError:  # rules, names
            row = []
        if len(row) == 6:
            count += 1
            yield row
        if count == 6 or (count and len(row) != 6):
            return


def _size(where: str, unit: str, kind: str) -> float:
    try:
        return quantity(f"1 {unit}", kind)
    except UnitError as error:
        raise InputError(where, f"is {unit!r}: {error.problem}", error.hint or "give one such as mm, or kg") from None
