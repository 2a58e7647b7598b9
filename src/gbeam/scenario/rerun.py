"""A result computed again from what its file says."""

from __future__ import annotations

import hashlib
import math
import os
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np

from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.limits import BINARY_BYTES, existing, parse_json, refuse_large_file
from gbeam.io.hdf5 import RECORD
from gbeam.io.netcdf import FACTS
from gbeam.results.provenance import Provenance, present
from gbeam.results.study import Difference, Reproduction
from gbeam.scenario.build import build
from gbeam.scenario.load import fingerprint, loads
from gbeam.scenario.text.overrides import override
from gbeam.scenario.text.source import parse

if TYPE_CHECKING:
    from gbeam.io.netcdf import Stored

# Attributes of the computation, not of its result.
_ABOUT = {"date", "command", "overrides", "scenario_sha256"}
_ABOUT |= {"gbeam_version", "python_version", "platform", "dependencies"}


@typed
def rerun(path: str | os.PathLike[str]) -> Reproduction:
    """Compute a result again, from the scenario and the records that its file holds, and compare every number.

    Parameters
    ----------
    path : path
        A ``result.nc`` that ``gbeam run`` or :meth:`gbeam.Study.save` wrote. A record that is too large to be in it is
        read from where it was.

    Returns
    -------
    Reproduction
        It is reproduced where nothing differs, or, with other versions or on another platform, by no more than 1e-9.

    Raises
    ------
    InputError
        If the file cannot be read or holds no responses or no scenario, or the scenario or a record is not the one
        that was run.
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

    before = read_stored(path)
    if not is_run(facts_of(before)):
        raise InputError(str(path), "holds no responses but another answer", "`gbeam rerun` runs its verb again")
    return run_again(path, before)


def facts_of(stored: Stored) -> dict[str, Any]:
    """The facts that a netCDF file holds; none where it has none, or they are damaged."""
    try:
        facts = parse_json(str(stored.variables[FACTS]))
    except (KeyError, ValueError):
        return {}
    return facts if isinstance(facts, dict) else {}


def is_run(facts: Mapping[str, Any]) -> bool:
    """True if facts are of responses, or do not say."""
    form = facts.get("form")
    return not isinstance(form, dict) or form.get("kind") in ("Study", "SystemStudy")


def origin_of(path: str | os.PathLike[str], stored: Stored) -> Provenance:
    """Provenance of a file, which must be that of its scenario."""
    try:
        origin = stored.provenance
    except Exception:  # zlib's, where bytes are damaged, or what lacks an attribute
        fix = "give the file as gbeam wrote it"
        raise InputError(str(path), "does not say where it comes from: it is damaged", fix) from None
    checked(str(path), origin)
    return origin


def run_again(path: str | os.PathLike[str], before: Stored) -> Reproduction:
    """Compute the responses of a file again."""
    from gbeam.analysis.environments import study
    from gbeam.io.netcdf import stored

    origin = origin_of(path, before)
    with TemporaryDirectory(prefix="gbeam-") as folder:
        changes = [*origin.overrides, *records(origin, Path(folder))]
        case = build(loads(origin.scenario, str(path), changes, folder=folder), ahead=True)
        after = stored(study(replace(case, provenance=None)))
    return reproduction(os.fspath(path), _facts(before), _facts(after), origin)


def reproduction(file: str, then: Mapping[str, Any], now: Mapping[str, Any], origin: Provenance) -> Reproduction:
    """Compare what a file holds with what has been computed again."""
    assert origin.environment is not None
    changed = origin.environment.changes(present())
    # A later version may hold more. Of another one's file, what both hold is compared.
    names = [name for name in then if "gbeam" not in changed or name in now]
    differences = [each for name in names if (each := _difference(name, then.get(name), now.get(name))) is not None]
    return Reproduction(
        file=file,
        compared=len(names),
        differences=tuple(sorted(differences, key=lambda each: -each.size)),
        changed=changed,
    )


def checked(file: str, origin: Provenance) -> None:
    """Raise InputError unless there is a scenario, and it is the one that was run."""
    if not origin.scenario:
        fix = "give the result of a scenario: a result.nc of `gbeam run`, or a verb's JSON"
        raise InputError(file, "holds no scenario to run again", fix)
    data, _ = override(parse(file, origin.scenario), file, origin.overrides)
    if fingerprint(data) != origin.sha256:
        fix = "the file was changed after the run; run the scenario again"
        raise InputError(file, "holds another scenario than the one that was run", fix)


def records(origin: Provenance, folder: Path) -> Iterator[str]:
    """Put the records into a folder, or find them where they were; the changes that make the scenario read them."""
    for number, record in enumerate(origin.records):
        if record.content is None:
            file = Path(record.file).resolve()
            if not existing(file):
                raise InputError(record.file, "is not where it was", "put the record back: it was too large to be kept")
            refuse_large_file(record.file, file, BINARY_BYTES, "put the record back")
            content = file.read_bytes()
        else:
            # Not by a name that the file gives: it could lead elsewhere.
            content, file = record.content, folder / f"{number}{Path(record.file).suffix}"
            file.write_bytes(content)
        if hashlib.sha256(content).hexdigest() != record.sha256:
            fix = "put back the one with the SHA-256 " + record.sha256
            raise InputError(record.file, "is another record than the one that was run", fix)
        yield f"{record.path}={file}"


def _facts(of: Stored) -> dict[str, Any]:
    """Variables and attributes by their names, but those that say of the computation and not of its result."""
    apart = ("scenario", FACTS)  # the facts are the other variables once more
    computed = {name: each for name, each in of.variables.items() if name not in apart and not name.startswith(RECORD)}
    for place, attrs in of.attrs.items():
        if place not in of.variables:  # whose attributes are words about them
            computed |= {f"{place}@{name}": each for name, each in attrs.items() if place or name not in _ABOUT}
    return computed


@np.errstate(all="ignore")  # a damaged file may hold any number
def _difference(name: str, then: Any, now: Any) -> Difference | None:
    """Difference of a variable or an attribute, if there is one."""
    if then is None or now is None:
        return Difference(name, math.inf, "is not there any more" if now is None else "was not there")
    old, new = np.asarray(then), np.asarray(now)
    if old.shape != new.shape:
        return Difference(name, math.inf, f"had the shape {old.shape}, has {new.shape}")
    if old.dtype.kind != "f" or new.dtype.kind != "f":
        return None if np.array_equal(old, new) else Difference(name, math.inf, f"was {_short(then)}, is {_short(now)}")
    if np.array_equal(old, new, equal_nan=True):
        return None
    finite = np.isfinite(old) & np.isfinite(new)
    if not np.array_equal(old[~finite], new[~finite], equal_nan=True):
        return Difference(name, math.inf, f"was {_short(then)}, is {_short(now)}")
    old, new = old[finite], new[finite]
    size = float(np.abs(old - new).max() / np.abs(old).max(initial=np.finfo(float).tiny))
    return Difference(name, size, f"differs by up to {size:.2g} of its largest value")


def _short(value: Any) -> str:
    text = str(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
