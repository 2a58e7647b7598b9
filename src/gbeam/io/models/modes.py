"""Flexible bodies in files: universal files (data sets 15, 2411, 55 and 2414), and standard input data (SID).

Universal files are read by pyuff. Standard input data hold Taylor polynomials in the body's coordinates, after
Wallrapp (1993, 1994).
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np

from gbeam.errors import InputError
from gbeam.io.models.arrays import Contents

NODES, MODES, RESULTS, UNITS = (15, 2411), 55, 2414, 164
NORMAL, COMPLEX = 2, (3, 7)  # analysis types
GLOBAL = (0, 1)  # coordinate systems
AT_NODES, OF_COMPLEX = 1, (5, 6)  # location of results, types of their numbers
MOVES = (2, 3)  # data of three translations, and with rotations
DERIVATIVES = {0: 0, 1: 0, 8: 0, 11: 1, 12: 2}  # of displacements by time: data that are unknown, general, and motions


def read_universal(path: str) -> Contents:
    """Read the nodes and the modes, normal or complex, of a universal file, in SI by the file's units."""
    import pyuff  # 0.2 s to import

    with open(path, "rb") as opened:
        if sum(line.strip() == b"-1" for line in opened) % 2:
            raise InputError("path", f"{path} ends within a data set", "export it again: it was cut off")
    file = pyuff.UFF(path)
    kinds = [int(kind) for kind in file.get_set_types()]
    sets = {i: file.read_sets(i) for i, kind in enumerate(kinds) if kind in (*NODES, MODES, RESULTS, UNITS)}
    contents: Contents = {}
    numbers, places = np.empty(0, dtype=int), np.empty((0, 3))
    length = mass = 1.0  # units of the file
    for units in (sets[i] for i, kind in enumerate(kinds) if kind == UNITS):
        length, mass = 1 / units["length"], units["length"] / units["force"]
    for i, data_set in sets.items():
        if kinds[i] in NODES:
            node_numbers, node_places = _nodes(path, data_set, length)
            unseen = ~np.isin(node_numbers, numbers)
            numbers, places = np.append(numbers, node_numbers[unseen]), np.concatenate([places, node_places[unseen]])
            contents |= {"numbers": numbers, "places": places}
    # Results are of many kinds, as of stress beside displacements.
    results = [_as_mode(sets[i]) for i, kind in enumerate(kinds) if kind == RESULTS and _moves(sets[i])]
    modes = [sets[i] for i, kind in enumerate(kinds) if kind == MODES] or results
    modes = [mode for mode in modes if mode["analysis_type"] in (NORMAL, *COMPLEX)]
    # Of a conjugate pair one mode is enough.
    modes = [mode for mode in modes if mode["analysis_type"] == NORMAL or complex(mode["eig"]).imag >= 0]
    if modes:
        numbers = np.asarray(modes[0]["node_nums"], dtype=int)
        if any(not np.array_equal(numbers, np.asarray(mode["node_nums"], dtype=int)) for mode in modes):
            raise InputError("path", f"{path} has modes at different nodes", "export them at the same ones")
        parts = [_mode(path, mode) for mode in modes]
        for part in parts:
            part["modal_mass"] *= mass
        contents["modes"] = {"numbers": numbers}
        for key in ("frequency", "damping_ratio", "modal_mass", "shape"):
            contents["modes"][key] = np.stack([part[key] for part in parts], axis=-1)
    return contents


def _nodes(path: str, data_set: dict[str, Any], length: float) -> tuple[Any, Any]:
    """Numbers and places of the nodes of a data set; InputError unless they are in the global coordinate system."""
    for system in np.unique([data_set["def_cs"], data_set["disp_cs"]]).astype(int):
        if system not in GLOBAL:
            raise InputError(
                "path", f"{path} has nodes in coordinate system {system}", "export them in the global one, 0 or 1"
            )
    places = length * np.column_stack([data_set[axis] for axis in "xyz"]).astype(float)
    return np.asarray(data_set["node_nums"], dtype=int), places


def _moves(data_set: dict[str, Any]) -> bool:
    """Tell whether a data set of results has a motion of the nodes in a mode."""
    moves = data_set["data_characteristic"] in MOVES and data_set["result_type"] in DERIVATIVES
    return moves and data_set["dataset_location"] == AT_NODES and data_set["analysis_type"] in (NORMAL, *COMPLEX)


def _as_mode(data_set: dict[str, Any]) -> dict[str, Any]:
    """Return a data set 2414 with the keys of a data set 55."""
    shape = np.array(data_set["data_at_node"], dtype=float)
    if data_set["data_type"] in OF_COMPLEX:
        shape = shape[:, ::2] + 1j * shape[:, 1::2]
    _, frequency, _, mass, viscous, hysteretic = (data_set[f"record12_field{i}"] for i in range(1, 7))
    real, imaginary, *a = (data_set[f"record13_field{i}"] for i in range(1, 5))
    return {
        "analysis_type": data_set["analysis_type"],
        "spec_data_type": data_set["result_type"],
        "data_ch": data_set["data_characteristic"],
        "node_nums": data_set["node_nums"],
        "mode_n": data_set["record10_field6"],
        "freq": frequency,
        "modal_m": mass,
        "modal_damp_vis": viscous,
        "modal_damp_his": hysteretic,
        "eig": complex(real, imaginary),
        "modal_a": complex(*a),
        **dict(zip(("r1", "r2", "r3"), shape.T, strict=False)),  # rotations may follow
    }


def _mode(path: str, data_set: dict[str, Any]) -> dict[str, Any]:
    """Frequency, Hz, damping ratio, modal mass and shape (k, 3) of a mode; a modal mass that is not given is NaN."""
    kind = int(data_set["spec_data_type"])
    if kind not in DERIVATIVES or data_set["data_ch"] not in MOVES:
        problem = f"{path} has mode {data_set['mode_n']} in data of type {kind}, characteristic {data_set['data_ch']}"
        raise InputError("path", problem, "export displacements along x, y and z: type 8, characteristic 2")
    shape = np.column_stack([data_set[f"r{i}"] for i in (1, 2, 3)])
    normal = data_set["analysis_type"] == NORMAL
    root = 2j * np.pi * float(data_set["freq"]) if normal else complex(data_set["eig"])
    if DERIVATIVES[kind] and root:
        shape = shape / root ** DERIVATIVES[kind]
    if normal:
        mass = float(data_set["modal_m"]) or np.nan
        ratio = float(data_set["modal_damp_vis"]) or float(data_set["modal_damp_his"]) / 2
        return {"frequency": float(data_set["freq"]), "damping_ratio": ratio, "modal_mass": mass, "shape": shape}
    size = abs(root)
    modal = complex(data_set["modal_a"]) / (2j * root.imag) if root.imag else 0j
    mode = {"frequency": size / (2 * np.pi), "damping_ratio": -root.real / size, "modal_mass": modal or np.nan}
    return mode | {"shape": shape}


OF_NODES = ("origin", "phi", "psi", "AP")
OF_BODY = ("mdCM", "J", "Ct", "Cr", "Me", "Gr", "Ge", "Oe", "ksigma", "Ke", "De")
_ENTRY = re.compile(r"^m([01])\s*\(([\d\s,]+)\)\s*=\s*(\S+)", re.IGNORECASE)
_SIZE = re.compile(r"^(order|nrow|ncol|nq|nqn|structure|mass|nelastq)\s*=\s*(\S+)", re.IGNORECASE)
SYMMETRIC, UNIT = 2, 4


def read_standard_input(path: str) -> Contents:
    """Read standard input data (SID, Wallrapp): the body's and the nodes' quantities by name.

    Each quantity is m0 + Σ m1 q with arrays m0 and m1.
    """
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
            index = tuple(int(number) - 1 for number in match[2].split(","))
            block[f"m{match[1]}"][index] = _number(match[3])
        elif match := _SIZE.match(line):
            (body if block is None else block)[match[1].lower()] = _number(match[2])
    lacking = [name for name in OF_BODY if name not in body and name not in ("ksigma", "Gr", "De")]
    if lacking:
        raise InputError("path", f"{path} lacks {', '.join(lacking)}", "export the whole body, after Wallrapp")
    blocks = [(name, block) for name, block in body.items() if name in OF_BODY]
    blocks += [pair for node in body["nodes"] for pair in node.items()]
    # The standard writes m1(row, coordinate, column); some programs swap the last two.
    single = [index for _, block in blocks if block["ncol"] == 1 for index in block["m1"]]
    swapped = any(index[2] > 0 for index in single)
    for name, block in blocks:
        owner = body if name in OF_BODY else next(node for node in body["nodes"] if node.get(name) is block)
        owner[name] = _arrays(block, swapped)
    return {"body": body}


def _number(text: str) -> float:
    return float(text.replace("D", "E").replace("d", "e"))


def _arrays(block: dict[str, Any], swapped: bool) -> dict[str, Any]:
    """Constant part (rows, columns), and change with each coordinate (rows, coordinates, columns).

    The indices of coordinate and column are exchanged if `swapped`. One half of a symmetric array gives the other.
    """
    rows, columns, count = (int(block.get(key, 0)) for key in ("nrow", "ncol", "nq"))
    indices = {index for index in block["m1"]}
    count = max([count, *(index[2 if swapped else 1] + 1 for index in indices)])
    constant, slope = np.zeros((rows, columns)), np.zeros((rows, count, columns))
    kind = int(block.get("structure", 3))
    if kind == UNIT:
        constant[:] = np.eye(rows, columns)
    for index, value in block["m0"].items():
        constant[index] = value
        if kind == SYMMETRIC:
            constant[index[::-1]] = value
    for (i, j, k), value in block["m1"].items():
        j, k = (k, j) if swapped else (j, k)
        slope[i, j, k] = value
        if kind == SYMMETRIC:
            slope[k, j, i] = value
    return {"m0": constant, "m1": slope}
