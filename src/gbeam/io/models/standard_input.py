"""Standard input data (SID) of a flexible body, after Wallrapp (1993, 1994): Taylor polynomials in its coordinates."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np

from gbeam.errors import InputError
from gbeam.io.models.contents import Contents

OF_NODES = ("origin", "phi", "psi", "AP")
OF_BODY = ("mdCM", "J", "Ct", "Cr", "Me", "Gr", "Ge", "Oe", "ksigma", "Ke", "De")
_ENTRY = re.compile(r"^m([01])\s*\(([\d\s,]+)\)\s*=\s*(\S+)", re.IGNORECASE)
_SIZE = re.compile(r"^(order|nrow|ncol|nq|nqn|structure|mass|nelastq)\s*=\s*(\S+)", re.IGNORECASE)
SYMMETRIC, UNIT = 2, 4


def read(path: str) -> Contents:
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
        elif found := _ENTRY.match(line):
            assert block is not None
            at = tuple(int(each) - 1 for each in found[2].split(","))
            block[f"m{found[1]}"][at] = _number(found[3])
        elif found := _SIZE.match(line):
            (body if block is None else block)[found[1].lower()] = _number(found[2])
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
