"""Preview of a record: its columns, their quantities, and the load that a scenario makes of it."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from gbeam.constants import STANDARD_GRAVITY
from gbeam.motion import Flight
from gbeam.motion.records.record import read_table
from gbeam.motion.records.units import UNITS, spelled
from gbeam.scenario import build, loads

SAMPLES = 1500
MOST = 500  # columns


def head(file: Path) -> dict[str, Any]:
    """Name of a record, its columns, and what these are by their names."""
    columns = read_table(file).columns[:MOST]
    known = suggested((each.name, each.unit) for each in columns)
    return {"name": file.name, "columns": [each.name for each in columns], "suggested": known}


def load_curves(text: str, folder: Path) -> dict[str, Any]:
    """The acceleration (or specific force) of every flight over the response's time, in g, base axes."""
    case = build(loads(text, folder=folder))
    start, duration = case.response.start, case.response.duration
    time = np.linspace(start, start + duration, SAMPLES)
    flights = {name: motion for name, motion in case.motions.items() if isinstance(motion, Flight)}
    return {
        "time": time.tolist(),
        "flights": {
            name: (np.asarray(flight.over(start, start + duration).base(time).a_WO_B) / STANDARD_GRAVITY).T.tolist()
            for name, flight in flights.items()
        },
    }


_BRACKETS = re.compile(r"\s*[\[(][^\])]*[\])]\s*$")
_WORDS = re.compile(r"[A-Za-z]+\d?|\d+")
_TIME = re.compile(r"t|time|timestamp|elapsed|elapsedtime|sec|seconds?|zeit|temps")
_LOADS = "n|a|acc|accel|acceleration|accelerometer|specificforce|loadfactor"  # fz may be a force in N
_LOAD = re.compile(rf"(?P<before>{_LOADS})(?P<axis>[xyz])|(?P<first>[xyz])(?P<after>acc|accel|acceleration|loadfactor)")
_RATE = re.compile(
    r"[pqr]|(?P<turn>roll|pitch|yaw)rate|(?:omega|w|gyro|rate|angularrate|angularvelocity)(?P<axis>[xyz])"
)
_RATES = {"roll": "p", "pitch": "q", "yaw": "r", "x": "p", "y": "q", "z": "r"}
_FACTORS = ("n", "loadfactor")  # which have no dimension: g
_LONGEST = 3  # words of a unit in a name, m_s_2


def suggested(columns: Iterable[tuple[str, str]]) -> dict[str, str]:
    """Return the keys of a scenario's record that names and units of columns suggest, where there is one answer; no
    signs.
    """
    candidates: dict[str, list[tuple[str, str]]] = defaultdict(list)  # columns and their units, by what they may hold
    for name, unit in columns:
        for key, stated in _meanings(name, unit):
            candidates[key].append((name, stated))
    turning = all(key in candidates for key in "pqr")  # one rate alone is none
    return {
        **_together(candidates, ("time",), "time_unit"),
        **_together(candidates, "xyz", "unit"),
        **(_together(candidates, "pqr", "rate_unit") if turning else {}),
    }


def _together(found: Mapping[str, list[tuple[str, str]]], keys: Iterable[str], unit: str) -> dict[str, str]:
    """Columns of one quantity, unless one of them has several; with their unit, unless it is another for each."""
    held = {key: found[key] for key in keys if key in found}
    units = {stated for each in held.values() for _, stated in each}
    if any(len(each) > 1 for each in held.values()) or len(units) > 1:
        return {}
    return {key: each[0][0] for key, each in held.items()} | ({unit: stated} if (stated := "".join(units)) else {})


def _meanings(name: str, unit: str) -> Iterable[tuple[str, str]]:
    """Quantities that a column may hold, with its unit as a scenario spells it; none where the unit is another's."""
    plain = _BRACKETS.sub("", name)
    for words, written in (*_readings(plain, unit), *_readings(re.split(r"[./]", plain)[-1], unit)):
        for quantity, pattern in (("time", _TIME), ("acceleration", _LOAD), ("rate", _RATE)):
            match = pattern.fullmatch(words)
            known = spelled(written, quantity) if written else ""
            if match is None or known is None or (known and known not in UNITS[quantity]):
                continue
            groups = match.groupdict()
            if quantity == "acceleration":
                factor = (groups["before"] or groups["after"]) in _FACTORS
                return [(groups["axis"] or groups["first"], known or ("g" if factor else ""))]
            if quantity == "rate":
                return [(_RATES[groups["turn"] or groups["axis"]] if len(words) > 1 else words, known)]
            return [("time", known)]
    return []


def _readings(name: str, unit: str) -> Iterable[tuple[str, str]]:
    """A name in small letters alone with its unit, which may be its own last words: n_z_g, p_rad_s."""
    words = [each.lower() for each in _WORDS.findall(name)]
    if unit:
        yield "".join(words), unit
        return
    for count in range(min(_LONGEST, len(words) - 1), 0, -1):
        tail = words[-count:]
        written = "/".join(tail[:2]) + "^".join(["", *tail[2:]])  # m s 2: m/s^2
        if any(spelled(written, quantity) is not None for quantity in UNITS):
            yield "".join(words[:-count]), written
    yield "".join(words), ""
