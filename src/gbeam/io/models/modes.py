"""Flexible bodies in files: universal files (data sets 15, 2411 and 55), and standard input data (SID).

Universal files are read by pyuff; standard input data hold Taylor polynomials in the body's coordinates, after
Wallrapp (1993, 1994).
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np

from gbeam.errors import InputError
from gbeam.io.models.arrays import Contents

NODES, MODES = (15, 2411), 55
NORMAL, COMPLEX = 2, (3, 7)  # analysis types


def read_universal(path: str) -> Contents:
    """Read the nodes, and the modes that are normal or complex ones."""
    import pyuff  # 0.2 s to import

    file = pyuff.UFF(path)
    kinds = [int(kind) for kind in file.get_set_types()]
    sets = {i: file.read_sets(i) for i, kind in enumerate(kinds) if kind in (*NODES, MODES)}
    contents: Contents = {}
    for i, kind in enumerate(kinds):
        if kind in NODES:
            places = np.column_stack([sets[i][axis] for axis in "xyz"]).astype(float)
            contents |= {"numbers": np.asarray(sets[i]["node_nums"], dtype=int), "places": places}
    modes = [sets[i] for i, kind in enumerate(kinds) if kind == MODES]
    modes = [each for each in modes if each["analysis_type"] in (NORMAL, *COMPLEX)]
    if modes:
        numbers = np.asarray(modes[0]["node_nums"], dtype=int)
        if any(not np.array_equal(numbers, np.asarray(each["node_nums"], dtype=int)) for each in modes):
            raise InputError("path", f"{path} has modes at different nodes", "export them at the same ones")
        parts = [_mode(each) for each in modes]
        keys = ("frequency", "damping_ratio", "modal_mass", "shape")
        contents["modes"] = {"numbers": numbers} | {
            key: np.stack([each[key] for each in parts], axis=-1) for key in keys
        }
    return contents


def _mode(each: dict[str, Any]) -> dict[str, Any]:
    """Frequency, Hz, damping ratio, modal mass and shape (k, 3); not a number what is not given."""
    shape = np.column_stack([each[f"r{i}"] for i in (1, 2, 3)])
    if each["analysis_type"] == NORMAL:
        mass = float(each["modal_m"]) or np.nan
        ratio = float(each["modal_damp_vis"]) or float(each["modal_damp_his"]) / 2
        return {"frequency": float(each["freq"]), "damping_ratio": ratio, "modal_mass": mass, "shape": shape}
    root = complex(each["eig"])
    size = abs(root)
    modal = complex(each["modal_a"]) / (2j * root.imag) if root.imag else 0j
    known = {"frequency": size / (2 * np.pi), "damping_ratio": -root.real / size, "modal_mass": modal or np.nan}
    return known | {"shape": shape}


OF_NODES = ("origin", "phi", "psi", "AP")
OF_BODY = ("mdCM", "J", "Ct", "Cr", "Me", "Gr", "Ge", "Oe", "ksigma", "Ke", "De")
_ENTRY = re.compile(r"^m([01])\s*\(([\d\s,]+)\)\s*=\s*(\S+)", re.IGNORECASE)
_SIZE = re.compile(r"^(order|nrow|ncol|nq|nqn|structure|mass|nelastq)\s*=\s*(\S+)", re.IGNORECASE)
SYMMETRIC, UNIT = 2, 4


def read_standard_input(path: str) -> Contents:
    """Read the polynomials of the body and of its nodes."""
    body: dict[str, Any] = {"nodes": [], "numbers": []}
    names = {name.lower(): name for name in (*OF_NODES, *OF_BODY)}
    block: dict[str, Any] | None = None
    for line in Path(path).read_text(encoding="ascii", errors="replace").splitlines():
        line = line.strip()
        word = line.lower().removeprefix("new ").split("=")[0].strip()
        if word == "node":
            body["numbers"].append(int(line.split("=")[1].split()[0]))
            body["nodes"].append({})
        elif word in names and block is None:
            block = {"m0": {}, "m1": {}}
        elif line.lower().startswith("end ") and block is not None:
            name = names[line[4:].strip().lower()]
            (body["nodes"][-1] if name in OF_NODES else body)[name] = block
            block = None
        elif match := _ENTRY.match(line):
            assert block is not None
            at = tuple(int(each) - 1 for each in match[2].split(","))
            block[f"m{match[1]}"][at] = _number(match[3])
        elif match := _SIZE.match(line):
            (body if block is None else block)[match[1].lower()] = _number(match[2])
    if missing := [name for name in OF_BODY if name not in body and name not in ("ksigma", "Gr", "De")]:
        raise InputError("path", f"{path} lacks {', '.join(missing)}", "export the whole body, after Wallrapp")
    every = [(name, each) for name, each in body.items() if name in OF_BODY]
    every += [pair for node in body["nodes"] for pair in node.items()]
    # The standard writes m1(row, coordinate, column); some programs swap the last two.
    single = [at for _, each in every if each["ncol"] == 1 for at in each["m1"]]
    swapped = any(at[2] > 0 for at in single)
    for name, each in every:
        where = body if name in OF_BODY else next(node for node in body["nodes"] if node.get(name) is each)
        where[name] = _arrays(each, swapped)
    return {"body": body}


def _number(text: str) -> float:
    return float(text.replace("D", "E").replace("d", "e"))


def _arrays(block: dict[str, Any], swapped: bool) -> dict[str, Any]:
    """Constant (rows, columns), and change with each coordinate (rows, coordinates, columns)."""
    rows, columns, count = (int(block.get(key, 0)) for key in ("nrow", "ncol", "nq"))
    shape = {at for at in block["m1"]}
    count = max([count, *(at[2 if swapped else 1] + 1 for at in shape)])
    constant, slope = np.zeros((rows, columns)), np.zeros((rows, count, columns))
    kind = int(block.get("structure", 3))
    if kind == UNIT:
        constant[:] = np.eye(rows, columns)
    for at, value in block["m0"].items():
        constant[at] = value
        if kind == SYMMETRIC:
            constant[at[::-1]] = value
    for (i, j, k), value in block["m1"].items():
        j, k = (k, j) if swapped else (j, k)
        slope[i, j, k] = value
        if kind == SYMMETRIC:
            slope[k, j, i] = value
    return {"m0": constant, "m1": slope}
