"""Universal files as tables: the time responses of data sets 58, by name or by node and direction."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np

from gbeam.errors import InputError
from gbeam.io.tables.table import Column, Table

_TIME = "time"
_RESPONSES = (0, 1)  # function types: general, time response
_DIRECTIONS = ("", "X", "Y", "Z", "RX", "RY", "RZ")
_NO_NAME = ("", "NONE")


def read_uff(path: str | os.PathLike[str], words: Sequence[str] = ()) -> Table:
    """Read the time responses (data set 58, text or binary) of a universal file.

    A column goes by the first line of the data set's identification, and by its node and direction, ``12+Z``; the
    abscissa is the column ``time``.
    """
    import pyuff  # 0.2 s to import

    try:
        file = pyuff.UFF(os.fspath(path))
        sets = [file.read_sets(i) for i, kind in enumerate(file.get_set_types()) if int(kind) == 58]
    except MemoryError:
        raise
    except Exception as error:  # pyuff raises Exception itself
        raise InputError("record.file", f"{path} is not a universal file ({error})", "export it as UFF 58") from None
    sets = [one for one in sets if one["func_type"] in _RESPONSES and np.isrealobj(one["data"])]
    if not sets:
        raise InputError("record.file", f"{path} holds no time response", "export data sets of type 58")
    time = _samples(sets[0], "x")
    names = Counter(_name(one) for one in sets)
    columns = [Column(_TIME, lambda: time, _unit(sets[0]["abscissa_axis_units_lab"]))]
    for one in sets:
        point = _point(one)
        name = _name(one) if names[_name(one)] == 1 else point
        abscissa = _samples(one, "x")
        if abscissa.shape != time.shape or not np.allclose(abscissa, time, rtol=0, atol=1e-6 * np.ptp(time)):
            raise InputError(
                "record.file", f"{path} has responses at different times, such as {name!r}", "export them at one rate"
            )
        values = _samples(one, "data")
        unit = _unit(one["ordinate_axis_units_lab"])
        columns.append(Column(name, lambda values=values: values, unit, (point,)))  # type: ignore[misc]
    return Table(tuple(columns))


def _samples(one: dict[str, Any], key: str) -> np.ndarray[Any, np.dtype[np.float64]]:
    return np.asarray(one[key], dtype=np.float64)[: int(one["num_pts"])]


def _name(one: dict[str, Any]) -> str:
    name = one["id1"].strip()
    return _point(one) if name.upper() in _NO_NAME else name


def _point(one: dict[str, Any]) -> str:
    direction = int(one["rsp_dir"])
    return f"{int(one['rsp_node'])}{'-' if direction < 0 else '+'}{_DIRECTIONS[abs(direction)]}"


def _unit(label: str) -> str:
    label = label.strip()
    return "" if label.upper() in _NO_NAME else label
