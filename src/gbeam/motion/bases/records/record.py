"""Flight records: read from a file of any kind, checked and conditioned before they are used."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from gbeam.errors import InputError
from gbeam.guards.limits import BINARY_BYTES, SAMPLES, refuse_large_file, refuse_more
from gbeam.motion.bases.conditioning import FEWEST, filtered, spikes, without_spikes
from gbeam.motion.bases.records.clock import check_interval, check_sampling
from gbeam.motion.bases.records.hdf5 import read_hdf5
from gbeam.motion.bases.records.mat import read_mat
from gbeam.motion.bases.records.soundness import CHECKS, Samples, refuse_unsound
from gbeam.motion.bases.records.table import NO_COLUMN, Table
from gbeam.motion.bases.records.text import read_text
from gbeam.motion.bases.records.uff import read_uff
from gbeam.motion.bases.records.units import UNITS, unit_of
from gbeam.motion.profiles.piecewise import PiecewiseLinear

Quantity = Literal["specific-force", "acceleration"]

_HDF5 = (".h5", ".hdf5", ".hdf", ".he5", ".nc", ".nc4", ".cdf")
# By the end of a file's name; everything else is text.
READERS: dict[str, Callable[[str | os.PathLike[str]], Table]] = {
    ".mat": read_mat,
    **dict.fromkeys(_HDF5, read_hdf5),
    **dict.fromkeys((".uff", ".unv", ".ufb", ".uf"), read_uff),
}


@dataclass(frozen=True)
class Rates:
    """Columns of a record that hold the body's rates about the base axes, with their signs, and their unit."""

    p: str
    q: str
    r: str
    unit: str


@dataclass(frozen=True)
class Conditioning:
    """What is done to a record.

    Parameters
    ----------
    cutoff : float or None
        Of a zero-phase low-pass (fourth-order Butterworth forwards and backwards, −6 dB), Hz.
    resample : float or None
        New sampling rate, Hz.
    despike : bool
        Replace single samples far off their neighbours.
    skip_checks : bool or tuple of str
        Checks to leave out, of ``sampling``, ``spikes``, ``unit``, ``sign`` and ``dropouts``; True leaves out all.
    """

    cutoff: float | None = None
    resample: float | None = None
    despike: bool = False
    skip_checks: bool | tuple[str, ...] = False

    @property
    def skipped(self) -> tuple[str, ...]:
        """Names of the checks that are left out."""
        if isinstance(self.skip_checks, bool):
            return CHECKS if self.skip_checks else ()
        for name in self.skip_checks:
            if name not in CHECKS:
                raise InputError("record.skip_checks", f"names no check {name!r}", f"choose of {', '.join(CHECKS)}")
        return self.skip_checks


@dataclass(frozen=True)
class FlightRecord:
    """A record ready to be flown.

    Parameters
    ----------
    acceleration : PiecewiseLinear
        m/s², base axes.
    rates : PiecewiseLinear or None
        Angular velocity, rad/s, base axes.
    notes : tuple of str
        What was done to it, and what looks odd.
    """

    acceleration: PiecewiseLinear
    rates: PiecewiseLinear | None = None
    notes: tuple[str, ...] = ()


def read_record(
    path: str | os.PathLike[str],
    time: str,
    x: str,
    y: str,
    z: str,
    unit: str,
    conditioning: Conditioning = Conditioning(),
    *,
    time_unit: str | None = None,
    quantity: Quantity = "specific-force",
) -> PiecewiseLinear:
    """Read an acceleration (or specific-force) record.

    Parameters
    ----------
    path : path
        Of text (commas, semicolons, tabs or white space; decimal point or comma), or by its suffix a MAT file
        (``.mat``), HDF5 or netCDF (``.h5``, ``.hdf5``, ``.nc``) or a universal file (``.uff``, ``.unv``).
    time : str
        Name of the column of times.
    x, y, z : str
        Names of the columns that hold the components in base axes; a leading ``-`` changes the sign (aircraft
        records have z down), ``0`` stands for a component that is zero.
    unit : str
        ``g`` (9.80665 m/s²) or ``m/s^2``.
    conditioning : Conditioning
        Of :class:`gbeam.motion.bases.records.record.Conditioning`; by default nothing is done to the record.
    time_unit : str, optional
        ``s``, ``ms``, ``us`` or ``min``; what the file says if left out, or else s.
    quantity : str
        ``specific-force``, 1 g upwards in level flight, which is checked; or ``acceleration``.

    Returns
    -------
    PiecewiseLinear
        Vector profile, m/s², over the record's own times, s.

    Raises
    ------
    InputError
        If the file, a column, a cell or the sampling is wrong, the file states other units, or the record looks
        unsound; rows are counted from 1, samples too.
    """
    return read_flight(
        path, time, x, y, z, unit, conditioning=conditioning, time_unit=time_unit, quantity=quantity
    ).acceleration


def _table(path: str | os.PathLike[str]) -> Table:
    try:
        refuse_large_file("record.file", path, BINARY_BYTES, "cut the record, or export it at a lower rate")
    except OSError as error:
        problem = f"{path} cannot be read ({error.strerror})"
        raise InputError("record.file", problem, "give the path of a record") from None
    return READERS.get(Path(path).suffix.lower(), read_text)(path)


@np.errstate(all="ignore")  # numbers beyond a float's are refused by their row, without a warning before
def read_flight(
    path: str | os.PathLike[str],
    time: str,
    x: str,
    y: str,
    z: str,
    unit: str,
    *,
    rates: Rates | None = None,
    conditioning: Conditioning = Conditioning(),
    time_unit: str | None = None,
    quantity: Quantity = "specific-force",
) -> FlightRecord:
    """Read a record with the body's rates, and say what was done to it; see :func:`read_record`.

    Parameters
    ----------
    rates : Rates, optional
        Which columns hold them.
    """
    skip = conditioning.skipped
    names = {"x": x, "y": y, "z": z}
    turns = {} if rates is None else {"p": rates.p, "q": rates.q, "r": rates.r}
    if {*names.values()} == {NO_COLUMN}:
        raise InputError("record", 'takes nothing of the file: x, y and z are "0"', "name a column for one of them")
    table = _table(path)

    def scale(key: str, kind: str, declared: str | None, columns: dict[str, str], otherwise: str) -> tuple[str, float]:
        stated = table.stated_units(columns)
        agreed = unit_of(key, kind, declared, stated, trust="unit" in skip) or otherwise
        return agreed, UNITS[kind][agreed]

    unit, load_scale = scale("unit", "acceleration", unit, names, unit)
    seconds, time_scale = scale("time_unit", "time", time_unit, {"time": time}, "s")
    rate_scale = 1.0 if rates is None else scale("rate_unit", "rate", rates.unit, turns, rates.unit)[1]
    clock = time_scale * table.numbers("time", time)
    refuse_more("record.file", "samples", len(clock), SAMPLES, 200.0, "cut the record, or export it at a lower rate")
    if len(clock) < FEWEST:
        word = "row" if table.rows is not None else "sample"
        raise InputError("record.file", f"{path} has {len(clock)} {word}(s)", f"give {FEWEST} samples or more")
    check_sampling(clock, table.place)
    if "sampling" not in skip:
        check_interval(clock, seconds)
    load = load_scale * table.vector(names, len(clock))
    checked = Samples(clock, load, names, unit, quantity == "specific-force", table.place)
    refuse_unsound(checked, (*skip, "spikes") if conditioning.despike else skip)
    notes = [] if time_unit is not None or seconds == "s" else [f"time in {seconds}, as the file says"]
    odd = spikes(load)
    if odd.any():
        first = int(np.argmax(odd.any(axis=1)))
        where = f"{int(odd.any(axis=1).sum())} sample(s) that look like spikes, the first at {clock[first]:g} s ("
        where += f"{table.place(first)})"
        notes.append(
            f"{where}, {'were replaced' if conditioning.despike else 'are kept; despike = true replaces them'}"
        )
        load = without_spikes(clock, load, odd) if conditioning.despike else load
    turning = rate_scale * table.vector(turns, len(clock)) if turns else np.empty((len(clock), 0))
    new, both = filtered(clock, np.concatenate([load, turning], axis=1), conditioning.cutoff, conditioning.resample)
    if conditioning.cutoff is not None:
        notes.append(f"low-pass at {conditioning.cutoff:g} Hz, zero phase")
    if conditioning.resample is not None:
        notes.append(f"resampled at {conditioning.resample:g} Hz")
    about = None if rates is None else PiecewiseLinear(new, both[:, 3:])
    return FlightRecord(PiecewiseLinear(new, both[:, :3]), about, tuple(notes))
