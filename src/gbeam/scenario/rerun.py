"""A result computed again from what its file says."""

from __future__ import annotations

import hashlib
import math
import os
import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.limits import BINARY_BYTES, SMALLEST, existing, parse_json, refuse_large_file
from gbeam.io.hdf5 import RECORD
from gbeam.io.netcdf import FACTS, Stored
from gbeam.progress import Progress
from gbeam.results.provenance import Provenance, current_environment
from gbeam.results.study import Difference, Reproduction
from gbeam.scenario.build import build
from gbeam.scenario.load import fingerprint, loads
from gbeam.scenario.text.overrides import override
from gbeam.scenario.text.source import parse

# Names, in files and in JSON, of estimates of errors, which are shares where no unit is said.
_SHARE = re.compile(r"(^|[@./])(error_\w+|errors?|total_error|run_error)($|[.])")
_NUMBER = re.compile(r"-?\d+(\.\d+)?(e[+-]?\d+)?")  # in words
# Names of times of peaks: rounding may decide between equal peaks. The peaks themselves are compared.
_WHEN = re.compile(r"_time($|_)|(^|[./])time_|time_of_|limits\.\d+\.time$")
ROUNDING = 1e-12  # of the largest value with the same unit, and of 1 if dimensionless: a smaller difference is rounding
# A unit of a rate, as netCDF files and JSON write it: the unit of the quantity, and the power of time.
_RATE = re.compile(r"(.+?)(?: s-(\d)|/s(?:\^(\d))?)")

# Attributes of the computation, not of its result.
_ABOUT = {"date", "command", "overrides", "scenario_sha256"}
_ABOUT |= {"gbeam_version", "python_version", "platform", "dependencies"}


@typed
def rerun(path: str | os.PathLike[str], *, progress: Progress = None) -> Reproduction:
    """Compute a result again, from the scenario and the records that its file holds, and compare every number.

    Parameters
    ----------
    path : path
        A ``result.nc`` that ``gbeam run`` or :meth:`gbeam.Study.save` wrote. A record that is too large to be in it is
        read from where it was.
    progress : callable or bool, optional
        Called with what is being done and the fraction of it done; True shows a bar.

    Returns
    -------
    Reproduction
        It is reproduced where nothing differs, or, with other versions or on another platform, by no more than
        rounding: 1e-12 of the largest value of its unit, or 1e-9 of its own.

    Raises
    ------
    InputError
        If the file cannot be read, is of another release of gbeam, holds no responses or no scenario, or the scenario
        or a record is not the one that was run.
    ComputationError
        If there is no answer any more.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import mkdtemp
    >>> shorter = ["response.duration=2 s", "response.residual_from=1 s"]
    >>> case = gb.read_scenario("examples/hubbeam2009_slew_2p8.toml", shorter)
    >>> path = Path(mkdtemp()) / "result.nc"
    >>> gb.study(case).save(path)
    >>> gb.rerun(path).reproduced
    True
    """
    from gbeam.io.netcdf import read_stored

    result = read_stored(path)
    if not is_run(result):
        raise InputError(str(path), "holds no responses but another answer", "`gbeam rerun` runs its verb again")
    return run_again(path, result, progress)


def facts_of(stored: Stored) -> dict[str, Any]:
    """Facts in a netCDF file; an empty dict if it has none, or they are damaged."""
    try:
        facts = parse_json(str(stored.variables[FACTS]))
    except (KeyError, ValueError):
        return {}
    return facts if isinstance(facts, dict) else {}


def is_run(stored: Stored) -> bool:
    """True if a file holds responses."""
    form = facts_of(stored).get("form")
    return isinstance(form, dict) and form.get("kind") in ("Study", "Response")


def origin_of(path: str | os.PathLike[str], stored: Stored) -> Provenance:
    """Provenance of a file; InputError if it is damaged, lacks a scenario, or has another than the one that was run."""
    try:
        origin = stored.provenance
    except Exception:  # zlib's error for damaged bytes, or of a missing attribute
        fix = "give the file as gbeam wrote it"
        raise InputError(str(path), "does not say where it comes from: it is damaged", fix) from None
    check_origin(str(path), origin)
    return origin


def run_again(path: str | os.PathLike[str], result: Stored, progress: Progress = None) -> Reproduction:
    """Compute the responses of a file again, and compare them with the file."""
    from gbeam.analysis.environments import study
    from gbeam.io.netcdf import stored

    origin = origin_of(path, result)
    with TemporaryDirectory(prefix="gbeam-") as folder:
        changes = [*origin.overrides, *record_changes(origin, Path(folder))]
        scenario = loads(origin.scenario, str(path), changes, folder=folder)
        answers = study(replace(build(scenario, ahead=True), provenance=None), progress=progress)
        result_now = stored(answers)
    values_before, values_now = computed_values(result), computed_values(result_now)
    holds_a_study = any(name.startswith("motions/") for name in result.variables)
    if not holds_a_study:
        (motion, *further_motions) = facts_of(result).get("motions") or answers.responses
        if further_motions:
            fix = "give the result.nc of all its motions"
            raise InputError(str(path), "holds one response, and does not say of which motion", fix)
        values_now = _of_one_motion(values_now, motion, values_before)
    return reproduction(os.fspath(path), values_before, values_now, origin, units_in(result))


def _of_one_motion(study: Mapping[str, Any], motion: str, names: Collection[str]) -> dict[str, Any]:
    """Variables of one motion of a study as a file of this response alone has them.

    Variables of the whole study, such as its notes, stay if they are among the `names`.
    """
    place = f"motions/{motion}"
    common = {name: value for name, value in study.items() if name in names}
    response = {name.removeprefix(place).lstrip("/"): value for name, value in study.items() if name.startswith(place)}
    return common | response


def units_in(stored: Stored) -> Callable[[str], str]:
    """The unit of a variable of a file by its name."""
    return lambda name: str(stored.attrs.get(name, {}).get("units", ""))


def reproduction(
    file: str,
    before: Mapping[str, Any],
    now: Mapping[str, Any],
    origin: Provenance,
    unit_of: Callable[[str], str],
) -> Reproduction:
    """Compare variables of a file, by name, with those computed again. `unit_of` gives the unit of a name.

    In another environment than that of the file, differences are allowed that rounding makes.
    """
    assert origin.environment is not None
    changed = origin.environment.changes(current_environment())
    names = [*before, *(name for name in now if name not in before)]
    scales = _scales(before, [name for name in before if name in now], unit_of) if changed else {}

    def scale_of(name: str) -> float:
        """Size against which rounding of a variable is measured, or zero in the same environment."""
        is_share = bool(changed) and unit_of(name) in ("", "1") and _SHARE.search(name) is not None
        return 1.0 if is_share else scales.get(unit_of(name), 0.0)

    compared = [_difference(name, before.get(name), now.get(name), unit_of(name), scale_of(name)) for name in names]
    unequal = [difference for difference in compared if difference is not None]
    differences = []
    for difference in sorted(unequal, key=lambda difference: -difference.size):
        values = before.get(difference.name), now.get(difference.name)
        if difference.size and not (changed and _by_rounding(difference, *values)):
            differences.append(difference)
    return Reproduction(
        file=file,
        compared=len(names),
        differences=tuple(differences),
        rounded=len(unequal) - len(differences),
        changed=changed,
    )


def _by_rounding(difference: Difference, before: Any, now: Any) -> bool:
    """True of times of peaks, of which equal ones change places, and of texts that differ in their numbers alone.

    These numbers are compared as variables themselves.
    """
    if isinstance(before, str) and isinstance(now, str):
        return _NUMBER.sub("", before) == _NUMBER.sub("", now)
    return _WHEN.search(difference.name) is not None and math.isfinite(difference.size)


def check_origin(file: str, origin: Provenance) -> None:
    """Raise InputError unless there is a scenario, the one that was run, by this release of gbeam."""
    assert origin.environment is not None
    version, ours = origin.environment.gbeam, current_environment().gbeam
    if version.split(".")[:2] != ours.split(".")[:2]:
        fix = f"compute it again by gbeam {version}, or run its scenario anew"
        raise InputError(file, f"was computed by gbeam {version}, and this is {ours}", fix)
    if not origin.scenario:
        fix = "give the result of a scenario: a result.nc of `gbeam run`, or a verb's JSON"
        raise InputError(file, "holds no scenario to run again", fix)
    data, _ = override(parse(file, origin.scenario), file, origin.overrides)
    if fingerprint(data) != origin.sha256:
        fix = "the file was changed after the run; run the scenario again"
        raise InputError(file, "holds another scenario than the one that was run", fix)


def record_changes(origin: Provenance, folder: Path) -> Iterator[str]:
    """Yield changes PATH=FILE for records that are written into `folder`, or found where they were if not kept."""
    for number, record in enumerate(origin.records):
        if record.content is None:
            file = Path(record.file).resolve()
            if not existing(file):
                raise InputError(record.file, "is not where it was", "put the record back: it was too large to be kept")
            refuse_large_file(record.file, file, BINARY_BYTES, "put the record back")
            content = file.read_bytes()
        else:
            # Not named as the result says: such a name could lead out of the folder.
            content, file = record.content, folder / f"{number}{Path(record.file).suffix}"
            file.write_bytes(content)
        if hashlib.sha256(content).hexdigest() != record.sha256:
            fix = "put back the one with the SHA-256 " + record.sha256
            raise InputError(record.file, "is another record than the one that was run", fix)
        yield f"{record.path}={file}"


def computed_values(result: Stored) -> dict[str, Any]:
    """Variables by name and attributes by ``PLACE@NAME``, without those about the computation and the facts."""
    left_out = ("scenario", FACTS)  # the facts repeat the other variables
    values = {name: value for name, value in result.variables.items() if name not in left_out}
    values = {name: value for name, value in values.items() if not name.startswith(RECORD)}
    for place, attrs in result.attrs.items():
        if place not in result.variables:  # attributes of variables only describe them
            values |= {f"{place}@{name}": value for name, value in attrs.items() if place or name not in _ABOUT}
    return values


def _scales(values: Mapping[str, Any], names: Sequence[str], unit_of: Callable[[str], str]) -> dict[str, float]:
    """Largest size of values by unit; that of a rate at least the quantity's over the longest time."""
    of_any_unit = any(name.endswith("unit") for name in names)  # where a file says units, a value without may have any
    scales = {"rad": 1.0} | ({} if of_any_unit else {"1": 1.0})
    for name in names:
        value = np.asarray(values[name])
        if value.dtype.kind == "f" and unit_of(name) not in ("", "1"):
            size = float(np.max(np.abs(value), initial=0.0, where=np.isfinite(value)))
            scales[unit_of(name)] = max(scales.get(unit_of(name), 0.0), size)
    time = scales.get("s") or 1.0
    bounds = {}
    for unit in scales:
        rate = _RATE.fullmatch(unit)
        if rate:
            bounds[unit] = scales.get(rate[1], 0.0) / time ** int(rate[2] or rate[3] or 1)
    return {unit: max(size, bounds.get(unit, 0.0), SMALLEST / ROUNDING) for unit, size in scales.items()}


@np.errstate(all="ignore")  # a damaged file may hold any number
def _difference(name: str, before: Any, now: Any, unit: str, scale: float) -> Difference | None:
    """Difference of a value then and now; of size zero if it is within rounding at the scale of its unit."""
    if before is None or now is None:
        return Difference(name, math.inf, "is not there any more" if now is None else "is lacking in the file")
    x, y = np.asarray(before), np.asarray(now)
    if x.shape != y.shape:
        return Difference(name, math.inf, f"had the shape {x.shape}, has {y.shape}")
    numbers = x.dtype.kind == "f" and y.dtype.kind == "f"
    if np.array_equal(x, y, equal_nan=numbers):
        return None
    finite = np.isfinite(x) & np.isfinite(y) if numbers else None
    if finite is None or not np.array_equal(x[~finite], y[~finite], equal_nan=True):
        return Difference(name, math.inf, f"was {_shorten(before)}, is {_shorten(now)}")
    largest = float(np.abs(x[finite]).max(initial=0.0))
    change = float(np.abs(x[finite] - y[finite]).max())
    size = 0.0 if change <= ROUNDING * scale else change / max(largest, float(np.finfo(float).tiny))
    words = f"differs by up to {size:.2g} of its largest value, {largest:.4g}"
    return Difference(name, size, f"{words} {unit}" if unit not in ("", "1") else words)


def _shorten(value: Any) -> str:
    text = str(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
