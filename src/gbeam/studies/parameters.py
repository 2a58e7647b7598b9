"""Physical values of a scenario, their bounds, and the points from which searches change them."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import numpy as np

from gbeam.errors import GbeamError, InputError, naming
from gbeam.guards.kinds import KINDS
from gbeam.guards.limits import refuse_more
from gbeam.guards.units import read_quantity
from gbeam.printable import advise
from gbeam.results.result import Flags, Floats
from gbeam.scenario.load import load
from gbeam.scenario.text.revise import with_quantities
from gbeam.studies.template import ScenarioTemplate, Template

# Values that no derivative is taken by, and the reason.
_FIXED = {
    r"response\.(?!initial\.)": "is a setting of the computation, which stays as it is while one differentiates",
    r"motion\.[\w-]+\.accept\.": "is a limit of acceptance, which changes no response",
    r"motion\.[\w-]+\.commands\.": "is the controller's sample time, which changes no response",
}
# Left out where no value is named: lists of points, and limits, which a motion may not use.
_UNUSUAL = re.compile(r"\.(times|values|stations)\[|\.limits\.|\.record\.|fatigue_exponent")
_LENGTH = re.compile(r"(beam|bodies\..+?)\.(?:line\.pieces\[\d+\]\.)?length")
_AT_TIP = re.compile(r"(\.at|stations\[\d+\]|\.control_point|\.length)$")
_NEAR_TIP = 1e-9  # of the length: written with as many digits


@dataclass(frozen=True)
class PhysicalValue:
    """A number of a scenario, SI, at a path, or at all `places` of a pattern such as ``springs.*.stiffness.z``.

    `followers` are values by path that change by as much: positions at the tip of the beam whose length it is.
    """

    path: str
    value: float
    kind: str
    followers: Mapping[str, float]
    places: tuple[str, ...]

    @property
    def unit(self) -> str:
        """SI unit, or empty for a plain number."""
        return KINDS[self.kind].unit

    @property
    def of_motion(self) -> str:
        """Name of the only motion that it belongs to, or empty if it belongs to none, or to several."""
        motions = {place.split(".")[1] if place.startswith("motion.") else "" for place in self.places}
        return motions.pop() if len(motions) == 1 else ""


def physical_values(scenario: Template, names: Sequence[str] = ()) -> list[PhysicalValue]:
    """Return the physical values at these paths or patterns; by default every usual one that is not zero."""
    quantities = scenario.quantities()
    possible = [path for path in quantities if _why_fixed(path) is None]
    if not names:
        usual = (path for path in possible if quantities[path][0] and not _UNUSUAL.search(path))
        return [_physical_value(path, (path,), quantities) for path in usual]
    chosen: list[PhysicalValue] = []
    for name in names:
        places = _matching(name, possible) or ((name,) if name in quantities else ())
        named_paths = {path for value in chosen for path in value.places}
        repeated = [path for path in places if path in named_paths]
        if repeated:
            raise InputError("--with", f"names {repeated[0]} twice", "name each value once")
        if not places:
            path, equals, _ = name.partition("=")
            fix = advise(path, possible, listed="the scenario has")
            if equals and path in possible:
                fix = f"give {path} alone; a range is one of the bounds"
            raise InputError("--with", f"{name!r} is no physical value that the scenario gives", fix)
        reason = _why_fixed(name)
        if reason is not None:
            raise InputError("--with", f"{name} {reason}", "leave it out, or compare runs by gbeam sweep")
        differing = [path for path in places if quantities[path] != quantities[places[0]]]
        if differing:
            pair = ((path, *quantities[path]) for path in (places[0], differing[0]))
            texts = (f"{path} = {value:g} {KINDS[kind].unit}".strip() for path, value, kind in pair)
            raise InputError("--with", f"{name!r} names values that differ, {' and '.join(texts)}", "make them alike")
        chosen.append(_physical_value(name, places, quantities))
    return chosen


def _matching(name: str, paths: Sequence[str]) -> tuple[str, ...]:
    """Paths that match a pattern, whose ``*`` stand for part of one step, but not of the first; () without ``*``."""
    first, *further_parts = name.split("*")
    if not further_parts or "." not in first:
        return ()
    pattern = re.compile(r"[^.\[\]]+".join(map(re.escape, (first, *further_parts))))
    return tuple(filter(pattern.fullmatch, paths))


def _physical_value(name: str, places: tuple[str, ...], quantities: dict[str, tuple[float, str]]) -> PhysicalValue:
    value, kind = quantities[places[0]]
    followers: dict[str, float] = {}
    for path in places:
        followers |= _at_tip(path, quantities)
    return PhysicalValue(name, value, kind, followers, places)


def _at_tip(path: str, quantities: dict[str, tuple[float, str]]) -> Iterator[tuple[str, float]]:
    """Path and value of positions at the tip of a beam, whose length, or a piece's length, is at `path`."""
    match = _LENGTH.fullmatch(path)
    if match is None:
        return
    beam = match[1]
    pieces = re.compile(rf"{re.escape(beam)}\.line\.pieces\[\d+\]\.length")
    lengths = [value for place, (value, _) in quantities.items() if pieces.fullmatch(place)]
    length = sum(lengths) or quantities[path][0]
    for place, (value, _) in quantities.items():
        on_beam = place.startswith(f"{beam}.") or (beam == "beam" and place.startswith("motion."))
        if on_beam and place != path and _AT_TIP.search(place) and math.isclose(value, length, rel_tol=_NEAR_TIP):
            yield place, value


def changed(parameters: Sequence[PhysicalValue], values: Sequence[float]) -> dict[str, float]:
    """Values to change in the scenario, by path, so that the parameters have `values`. Their followers move along."""
    changes: dict[str, float] = {}
    for parameter, value in zip(parameters, values, strict=True):
        if value != parameter.value:
            changes |= dict.fromkeys(parameter.places, float(value))
            for path, position in parameter.followers.items():
                changes[path] = changes.get(path, position) + float(value) - parameter.value
    return changes


def changes_to(parameters: Sequence[PhysicalValue], values: Sequence[float]) -> tuple[str, ...]:
    """Changes of the scenario, as text, that give parameters these values."""
    return tuple(f"{path}={value!r}" for path, value in changed(parameters, values).items())


def _why_fixed(path: str) -> str | None:
    return next((reason for pattern, reason in _FIXED.items() if re.match(pattern, path)), None)


Bounds = Mapping[str, tuple[float | str, float | str]]  # by path, SI or text with a unit
_NEAR, _FAR = 0.1, 10.0  # times the scenario's value: bounds where none are given


def select_values(template: Template, names: Sequence[str], option: str) -> list[PhysicalValue]:
    """Physical values of these names; InputErrors name the option of the command line."""
    with naming(option):
        return physical_values(template, names)


def bounds_of(parameter: PhysicalValue, bounds: Bounds, option: str) -> tuple[float, float]:
    """Return the bounds of a value, by default a tenth to ten times it. InputError unless they contain the value."""
    if parameter.path in bounds:
        ends_given = []
        for end in bounds[parameter.path]:
            if isinstance(end, str):
                end = read_quantity("--bounds", end, parameter.kind, f"of {parameter.path}: ")
            ends_given.append(float(end))
        low, high = ends_given
        if not low < high:
            raise InputError(
                "--bounds", f"of {parameter.path} go from {low:g} to {high:g}", "give the smaller one first"
            )
        if not low <= parameter.value <= high:
            fix = f"begin between them: --set {parameter.path}={(low + high) / 2:g}"
            raise InputError(
                "--bounds", f"of {parameter.path} leave out the scenario's value, {parameter.value:g}", fix
            )
        return low, high
    if parameter.value == 0:
        fix = f"give a value to begin with (--set {parameter.path}=...), or bounds"
        raise InputError(option, f"names {parameter.path}, which is zero", fix)
    ends = sorted((_NEAR * parameter.value, _FAR * parameter.value))
    return ends[0], ends[1]


def with_values(
    paths: Sequence[str], values: Sequence[float], scenario: str | os.PathLike[str], folder: str | os.PathLike[str]
) -> str:
    """Return a scenario's text with other values (SI), each in its own unit, to be saved in a folder; comments stay."""
    base = load(scenario)
    assert base.source is not None  # it was read from a file
    recorded = any(getattr(motion, "record", None) is not None for motion in base.motion.values())
    if recorded and Path(folder).resolve() != base.source.folder.resolve():
        fix = f"write it into {base.source.folder.resolve()}"
        raise InputError(os.fspath(folder), "is not the folder that the scenario's records are named from", fix)
    template = ScenarioTemplate(base)
    changes = changed(physical_values(template, paths), values)
    quantities = template.quantities()
    return with_quantities(base.source, {path: (value, quantities[path][1]) for path, value in changes.items()})


MAX_STARTS = 1000
Answer = TypeVar("Answer")
_ON = 1e-6  # of the bounds' width
_SAME = 1e-2  # of the bounds' width: values that are nearer to each other count as the same
_WIDE = 10.0  # ratio of bounds above which starting points are spread in equal ratios


def search_all(
    parameters: Sequence[PhysicalValue], limits: Floats, count: int, search: Callable[[Floats], Answer]
) -> list[Answer]:
    """Answers of searches from the scenario's values and from further points. Searches from further points may fail."""
    answers: list[Answer] = []
    for start in _starting_points(np.array([parameter.value for parameter in parameters]), limits, count):
        try:
            answers.append(search(start))
        except GbeamError:  # the scenario refuses the values, or its run is not done
            if not answers:
                raise
    return answers


def on_bound(values: Floats, limits: Floats) -> Flags:
    """True (p,) where values (p,) lie on one of their bounds (p, 2)."""
    low, high = limits.T
    return np.asarray(np.minimum(values - low, high - values) < _ON * (high - low))


def _starting_points(start: Floats, limits: Floats, count: int) -> list[Floats]:
    """Starting points (p,) of searches: the scenario's values, and further points spread evenly between bounds (p, 2).

    They are Sobol points. Between bounds far apart they are spread in equal ratios.
    """
    if count < 1:
        raise InputError("--starts", f"is {count}", "give one or more")
    refuse_more("--starts", "searches", count, MAX_STARTS, 1e5, "give fewer")
    if count == 1:
        return [start]
    from scipy.stats import qmc  # half a second

    low, high = limits.T
    sequence = qmc.Sobol(len(start), rng=0).random_base2(max(1, int(np.ceil(np.log2(count - 1)))))
    share = sequence[: count - 1]
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = high / low
        far_apart = (low > 0) & (ratio > _WIDE)
        points = np.where(far_apart, low * ratio**share, low + share * (high - low))
    return [start, *points]


def count_agreeing(ends: Sequence[Floats], solution: Floats, limits: Floats) -> int:
    """Number of searches that ended at the best values."""
    width = limits[:, 1] - limits[:, 0]
    return sum(bool((np.abs(end - solution) <= _SAME * width).all()) for end in ends)
