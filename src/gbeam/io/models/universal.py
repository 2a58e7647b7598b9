"""Modes and nodes of universal files (data sets 15, 2411 and 55), by pyuff."""

from __future__ import annotations

from typing import Any

import numpy as np

from gbeam.errors import InputError
from gbeam.io.models.contents import Contents

NODES, MODES = (15, 2411), 55
NORMAL, COMPLEX = 2, (3, 7)  # analysis types


def read(path: str) -> Contents:
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
