"""Measured histories or modes, and the same quantities computed of a case."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gbeam.analysis.case import Case
from gbeam.analysis.control.outputs import surface_gauge
from gbeam.errors import InputError
from gbeam.guards.kinds import KINDS
from gbeam.guards.units import read_quantity
from gbeam.io.table import Table
from gbeam.mechanics.assembly import model_of, remade, stations_asked
from gbeam.mechanics.structure import Structure
from gbeam.motion.records.text import read_text
from gbeam.printable import advise
from gbeam.results.response import Response
from gbeam.results.result import Floats
from gbeam.results.study import Study
from gbeam.structure.beam import fibre_strain
from gbeam.studies.figures import History, read_history

OPTION = "--data"
_TIME = ("time", "time_s", "t")
_MODE = "mode"
_STRAIN = re.compile(r"((?:\w+\.)*)strain\.(-?[xyz])@(.+)")
_MODAL = {"frequency": ("frequency", "Hz"), "damping_ratio": ("ratio", "")}  # kinds and units
_USUAL = {"history": 1e-2, "frequency": 1e-3, "damping_ratio": 0.1}  # assumed noise, of the largest or of the value
_LEAST = 1e-6  # of that: least noise, as of data that were computed
_SIGNALS = "length", "angle", "speed", "angular rate", "acceleration", "force", "torque"  # kinds of signals
_KIND_OF = {KINDS[kind].unit: kind for kind in _SIGNALS}
_MICROSTRAIN = {"µm/m": 1e-6, "um/m": 1e-6, "microstrain": 1e-6}


@dataclass(frozen=True)
class Measured:
    """A column of the data: `values` (t,), SI.

    It is of a quantity such as ``tip.z`` of a motion, of a strain of a `body` at `at`, m, on `face`, or of a strain at
    a point of a solid along an axis.
    """

    name: str
    motion: str
    quantity: str
    values: Floats
    unit: str
    at: float | str = math.nan
    face: str = ""
    body: str = ""


@dataclass(frozen=True)
class Measurement:
    """Columns measured at times `at` (t,), s; if `modal`, of the modes with these numbers, from 1."""

    file: str
    at: Floats
    modal: bool
    columns: tuple[Measured, ...]

    @property
    def values(self) -> Floats:
        """All columns, one after the other, (m,)."""
        return np.concatenate([column.values for column in self.columns])

    @property
    def motions(self) -> tuple[str, ...]:
        """Names of the motions whose responses are measured."""
        return tuple(dict.fromkeys(column.motion for column in self.columns))

    @property
    def parts(self) -> dict[str, bool]:
        """Parts of a response, loads and axes, that the columns need."""
        return {"loads": any("root_" in column.quantity or column.face for column in self.columns), "axes": False}

    def weights(self, residuals: Floats | None, freed: int) -> Floats:
        """Reciprocals (m,) of the noise of the data.

        The noise is estimated from residuals (m,) of a fit of `freed` values, or assumed if they are None. It is the
        same at all times of a column, and in proportion to the values of modes.
        """
        weights, start = [], 0
        for column in self.columns:
            rows = slice(start, start + len(column.values))
            start = rows.stop
            size = np.abs(column.values)
            size = size if self.modal else np.full(len(size), size.max())
            size = np.where(size > 0, size, 1.0)
            noise = _USUAL[column.quantity] if self.modal else _USUAL["history"]
            if residuals is not None and len(size) > 2 * freed + 2:  # fewer data say nothing of the noise
                shares = residuals[rows] / size
                degrees_share = 1 - freed / len(self.values)
                noise = max(float(np.sqrt(np.mean(shares**2) / degrees_share)), _LEAST * noise)
            weights.append(1 / (noise * size))
        return np.concatenate(weights)

    def instrumented(self, case: Case) -> Case:
        """Case whose beams have the positions of the strain gauges among their stations."""
        bodies = dict(case.system.bodies)
        for column in self.columns:
            if isinstance(column.at, float) and column.at > 0:
                body = case.system.flexible[column.body]
                positions = {gauge.at for gauge in self.columns if gauge.body == column.body}
                bodies[column.body] = remade(body, model_of(body), sorted({*stations_asked(body), *positions} - {0.0}))
        return replace(case, system=replace(case.system, bodies=bodies))

    def read(self, case: Case, answer: Any) -> Floats:
        """Values (m,) of the measured quantities in an answer to a case, in the order of `values`."""
        if self.modal:
            modes = [int(number) for number in self.at]
            return np.array([_modal(answer, column.quantity, k) for column in self.columns for k in modes])
        study = answer if isinstance(answer, Study) else answer["study"]
        return np.concatenate([self._history(case, study, column) for column in self.columns])

    def _history(self, case: Case, answer: Study, column: Measured) -> Floats:
        """Values at the measured times: a signal of the response, or the strain of a gauge."""
        if not column.face:
            return History(column.name, column.motion, column.quantity, column.unit).interpolate(answer, self.at)
        from scipy.interpolate import CubicSpline

        response = answer.responses[column.motion]
        values = _strain(case, response, column)
        return np.asarray(CubicSpline(response.time, values)(self.at))


def read_measurement(path: str | os.PathLike[str], case: Case, motion: str | None = None) -> Measurement:
    """Read measured histories (a column ``time``) or modes (a column ``mode``) from a text file: see :func:`fit`.

    ``strain.z@10 mm`` is on the face towards +z, ``strain.-z@...`` towards −z; of a solid ``strain.x@fillet`` is along
    an axis of a point.
    """
    try:
        return _read(os.fspath(path), case, motion)
    except InputError as error:
        where = OPTION if error.where.startswith("record") else error.where
        raise error.at(where) from None


def _read(path: str, case: Case, motion: str | None) -> Measurement:
    """Measurement in a file. InputError unless it has a column of times or modes, and further columns."""
    table = read_text(path)
    names = {(column.aliases or (column.name,))[0]: column.unit for column in table.columns}
    clock = next((name for name in names if name.lower() in (*_TIME, _MODE)), None)
    if clock is None:
        raise InputError(OPTION, f"{path} has no column time or mode", f"its columns are {', '.join(names)}")
    if motion is not None and motion not in case.environments:
        raise InputError("--motion", f"is {motion!r}", f"the scenario has {', '.join(case.environments)}")
    modal = clock.lower() == _MODE
    clock_values = table.numbers("file", clock) * _factor(names[clock], "time" if not modal else "ratio", clock)
    names_of_data = [name for name in names if name != clock]
    if not names_of_data:
        examples = "frequency" if modal else "tip.z or root_moment.y"
        raise InputError(OPTION, f"{path} has nothing but {clock}", f"add columns such as {examples}")
    _check_clock(clock_values, path, modal, case, list(case.environments) if motion is None else [motion])
    columns = tuple(_column(table, name, names[name], modal, case, motion) for name in names_of_data)
    return Measurement(path, clock_values, modal, columns)


def _check_clock(clock: Floats, path: str, modal: bool, case: Case, motions: Sequence[str]) -> None:
    """Raise InputError unless times increase within the responses in all motions, or each mode is numbered once."""
    if modal:
        if (clock < 1).any() or (clock % 1 != 0).any() or len(set(clock)) < len(clock):
            raise InputError(OPTION, f"{path} has modes that are no numbers 1, 2, …", "number each mode once")
        return
    settings = [case.settings_of(name) for name in motions]
    start, end = (
        max(setting.start for setting in settings),
        min(setting.start + setting.duration for setting in settings),
    )
    if len(clock) < 2:
        raise InputError(OPTION, f"{path} has one time", "give two or more, which increase")
    if (np.diff(clock) <= 0).any():
        raise InputError(OPTION, f"{path} has times that do not increase", "sort its rows")
    slack = 1e-9 * (end - start)
    if clock[0] < start - slack or clock[-1] > end + slack:
        problem = (
            f"{path} has times from {clock[0]:g} to {clock[-1]:g} s, and the response goes from {start:g} to {end:g} s"
        )
        raise InputError(OPTION, problem, "give response.duration the data's, or cut the data")


def _column(table: Table, name: str, unit: str, modal: bool, case: Case, motion: str | None) -> Measured:
    """A column of the file in SI, with its quantity and the motion that its name or else `motion` says."""
    values = table.numbers("file", name)
    if modal:
        if name not in _MODAL:
            raise InputError(OPTION, f"has the column {name!r}", advise(name, _MODAL))
        kind, si = _MODAL[name]
        return Measured(name, motion or "", name, values * _factor(unit, kind, name), si)
    strain = _STRAIN.fullmatch(name)
    if strain is not None:
        return _gauge(name, unit, values, strain, case, motion)
    signal = read_history(name, case, OPTION, motion)
    factor = _factor(unit, _KIND_OF[signal.unit], name)
    return Measured(name, signal.motion, signal.quantity, values * factor, signal.unit)


def _gauge(name: str, unit: str, values: Floats, strain: re.Match[str], case: Case, motion: str | None) -> Measured:
    """A column of a strain gauge, such as ``flight.strip.strain.z@10 mm``.

    Its name has the motion and the body that deforms. Each may be left out if there is only one.
    """
    owners, (prefix, face, place) = case.system.flexible, strain.groups()
    names = prefix.split(".")[:-1]
    run = names.pop(0) if names and names[0] in case.environments else motion or _only_motion(case, name)
    owner = ".".join(names) or (next(iter(owners)) if len(owners) == 1 else "")
    if owner not in owners:
        raise InputError(OPTION, f"has the column {name!r}, which names no body", advise(owner, owners))
    body = owners[owner]
    if body.source is not None and face.endswith("x"):
        raise InputError(OPTION, f"has the column {name!r}", "write strain.z@10 mm: the face is towards y or z")
    factor = _MICROSTRAIN.get(unit) or _factor(unit, "ratio", name)
    gauge_place: float | str = (_gauge_point if body.source is None else _position)(place, face, body)
    return Measured(name, run, "strain", values * factor, unit="", at=gauge_place, face=face, body=owner)


def _factor(unit: str, kind: str, name: str) -> float:
    """Factor from a column's unit to SI; InputError, with the column's name, unless it is of that kind."""
    return read_quantity(OPTION, f"1 {unit}" if unit else "1", kind, f"has the column {name!r} in {unit!r}: ")


def _gauge_point(text: str, axis: str, solid: Structure) -> str:
    """Return the name of the gauge's point. InputError unless the solid has a strain there along `axis`."""
    name, recovery = text.strip(), solid.recovery
    if recovery is None:
        raise InputError(OPTION, f"has a gauge at {name!r}, on no mesh", "leave it out")
    try:
        recovery.strain(name, _way(axis))
    except InputError as error:
        raise InputError(OPTION, f"has a gauge that {error.problem}", error.fix) from None
    return name


def _way(axis: str) -> Floats:
    return np.eye(3)["xyz".index(axis[-1])]


def _position(text: str, face: str, structure: Structure) -> float:
    """Position of a gauge on a face of a beam, m, from a named point or a length."""
    assert structure.source is not None
    beam = structure.source.beam
    position = beam.named_points.get(text.strip())
    position = (
        read_quantity(OPTION, text.strip(), "length", f"has a gauge at {text!r}: ") if position is None else position
    )
    try:
        surface_gauge(beam, position, face)
    except InputError as error:
        raise InputError(OPTION, f"has a gauge that {error.problem}", error.fix) from None
    return float(position)


def _only_motion(case: Case, name: str) -> str:
    if len(case.motions) > 1:
        choice = " or ".join(f"{motion}.{name}" for motion in case.motions)
        raise InputError(OPTION, f"has the column {name!r}, and the scenario several motions", f"name it {choice}")
    return next(iter(case.motions))


def _modal(facts: Mapping[str, Any], quantity: str, mode: int) -> float:
    modes: Sequence[Mapping[str, float]] = facts["modes"]
    if mode > len(modes):
        raise InputError(OPTION, f"has mode {mode}, and the model {len(modes)}", "raise model.modes, or leave it out")
    return float(modes[mode - 1][quantity])


def _strain(case: Case, response: Response, column: Measured) -> Floats:
    """Strain of a gauge over the response's own times: of a solid at a point, of a beam by the section's loads."""
    body, source = response.bodies[column.body], case.system.flexible[column.body].source
    if isinstance(column.at, str):
        return body.strain_at(column.at, _way(column.face).tolist())
    assert source is not None and body.loads is not None
    gauge = surface_gauge(source.beam, column.at, column.face)
    k = int(np.argmin(np.abs(body.loads.stations - column.at)))
    carried = body.loads.section_force[:, k], body.loads.section_moment[:, k]
    return np.asarray(fibre_strain(source.beam, gauge.at, *carried, gauge.y, gauge.z))
