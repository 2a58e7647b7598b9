"""Sensitivities: derivatives of figures with respect to physical values."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from gbeam.analysis.case import Case
from gbeam.constants import Verb
from gbeam.errors import GbeamError, InputError, naming
from gbeam.guards.arguments import typed
from gbeam.guards.kinds import WRITTEN, kinds
from gbeam.guards.quantities import Seconds
from gbeam.progress import Progress
from gbeam.questions import Options
from gbeam.results.cases import Sensitivity
from gbeam.results.result import Flags, Floats
from gbeam.results.study import Study
from gbeam.scenario.values import path_text
from gbeam.studies.derivatives import Neighbourhood, Slopes
from gbeam.studies.evaluate import Inquiry, of_loads
from gbeam.studies.figures import (
    Facts,
    Keys,
    answer_facts,
    check_figures,
    find,
    node_at,
    own_keys,
    unit_at,
    usual_figures,
    value_at,
)
from gbeam.studies.parameters import PhysicalValue, changes_to, physical_values
from gbeam.studies.template import template_of

OPTION = "--of"
_SHARE = 0.05  # of the slope, by which the one-sided slopes may differ
_SMOOTH = 1e-3  # of the figure over the value: a smaller difference is rounding, or the bend of a high power
# Figures that are no function of the physics: counts, steps, estimates, flags.
_NOT_PHYSICAL = re.compile(r"(^|\.)(steps|step|errors|error_estimate|accepted|passed|yielded|margin_estimate)(\.|\[|$)")


@kinds(options=WRITTEN)
@typed
def sensitivity(
    scenario: str | os.PathLike[str] | Case,
    of: Sequence[str] = (),
    parameters: Sequence[str] = (),
    *,
    verb: Verb = "run",
    motion: str | None = None,
    at: Seconds | None = None,
    options: Options | None = None,
    overrides: Sequence[str] = (),
    progress: Progress = None,
) -> Sensitivity:
    """Differentiate figures of a scenario with respect to physical values in it.

    Derivatives of responses over time are those of the discrete solution, with its steps and shapes held fixed: all
    parameters are right-hand sides of the equations linearised about one run. Where a jump of a motion or load moves
    with a value, and for the other verbs, they are central differences, which come with an error.

    Parameters
    ----------
    scenario : path or Case
        The scenario's file, or a case, of :func:`gbeam.read_scenario` or made in Python.
    of : sequence of str
        Figures of the verb's JSON by the end of their path, such as ``tip.z.max_abs`` or ``verdict.tip``; of run
        by default the largest of tip and root moment in every motion.
    parameters : sequence of str
        Paths of values, such as ``beam.length``; by default every physical value that is not zero, but for lists over
        positions and times and a machine's limits. What sits at the tip moves with the beam's length.
    verb : str
        run (the default), static, modes, critical-speed or plan.
    motion : str, optional
        Which motion, for a verb that answers for one.
    at : float, optional
        Time at which that motion is frozen, s; the start of the response by default.
    options : mapping of str to values, optional
        Options of the verb by their names on its command line, such as ``{"turning": "base.angle", "to": "60 rpm"}``.
    overrides : sequence of str
        Changes of the scenario, such as ``beam.length=250 mm``.
    progress : callable or bool, optional
        Called with what is being done and the fraction of it done; True shows a bar.

    Returns
    -------
    Sensitivity

    Raises
    ------
    InputError
        If the scenario, a figure or a value is wrong; or a value that is named may not be a little more or less.
    ComputationError
        If a run whose figures are differentiated is not done.

    Examples
    --------
    >>> slew = "examples/hubbeam2009_slew_2p8.toml"
    >>> answer = gb.sensitivity(slew, ["modes[0].frequency"], ["beam.length"], verb="modes")
    >>> print(answer.relative.round(2))
    [[-2.]]
    """
    template = template_of(scenario, overrides)
    of = of or usual_figures(template, verb)
    if not of:
        raise InputError(OPTION, "is missing", 'name figures: --of "tip.z.max_abs, verdict.tip"; list prints all')
    check_figures(verb, of, OPTION)
    inquiry = Inquiry(template, verb, motion, at, options or {})
    chosen, refused = _possible(inquiry, physical_values(template, parameters), strict=bool(parameters))
    if not chosen:
        raise InputError("--with", "has no value that may be a little more and a little less", "name some")
    nearby = Neighbourhood(inquiry, chosen, progress=progress)
    facts = facts_of(nearby.answer)
    keys = tuple(figure(facts, name) for name in of)
    motions, nearby.parts = needed_parts(keys, nearby.case.tracks)
    nearby.inquiry = replace(inquiry, keys=keys)  # further answers hold only what these figures are read from
    slopes = nearby.slopes(lambda _, answer: values_at(facts_of(answer), keys), motions)
    units = tuple(unit_at(facts, figure_keys) for figure_keys in keys)
    kinks = _kinks(slopes, [value.value for value in chosen], units)
    kinked = [
        f"{name} has a kink in {chosen[j].path}: its derivative is the mean of those on either side"
        for k, name in enumerate(of)
        for j in np.flatnonzero(kinks[k])
    ]
    return Sensitivity(
        title=template.title(),
        verb=verb,
        measures=tuple(of),
        units=units,
        figures=slopes.values,
        parameters=tuple(parameter.path for parameter in chosen),
        parameter_units=tuple(parameter.unit for parameter in chosen),
        values=np.array([parameter.value for parameter in chosen]),
        derivatives=slopes.slopes,
        errors=slopes.errors,
        methods=slopes.methods,
        kinks=kinks,
        run_error=_run_error(nearby.answer, motions),
        not_varied=tuple(refused),
        warnings=tuple(kinked),
        notes=template.notes,
        provenance=template.provenance,
    )


def _run_error(answer: Any, motions: Sequence[str]) -> float:
    """Largest estimated error of the runs in some motions, or NaN if none is known."""
    if not isinstance(answer, Study):
        return math.nan
    totals = []
    for name in motions:
        errors = answer.responses[name].errors
        totals += [errors.displacement.total, errors.loads.total]
    return max((total for total in totals if not math.isnan(total)), default=math.nan)


def _kinks(slopes: Slopes, values: Sequence[float], units: Sequence[str]) -> Flags:
    """True (m, p) where the one-sided slopes differ by more than a share of the slope, rounding and curvature."""
    # A figure without a unit is a ratio, or a ratio less one, which may be small beside its rounding.
    sizes = np.maximum(np.abs(slopes.values), [0.0 if unit else 1.0 for unit in units])
    size = sizes[:, None] / np.maximum(np.abs(values), 1e-6)
    return np.asarray(slopes.bends > _SHARE * np.abs(slopes.slopes) + _SMOOTH * size)


def figure(facts: Facts, name: str, option: str = OPTION) -> Keys:
    """Keys of a figure. InputError unless it has a finite value and can have a derivative."""
    with naming(option):
        keys = find(facts, name)
    if isinstance(node_at(facts, keys), (bool, int)) or _NOT_PHYSICAL.search(path_text(own_keys(keys))):
        raise InputError(option, f"{name!r} is a count, a flag or an estimate, without a derivative", "name a figure")
    if not math.isfinite(value_at(facts, keys)):
        raise InputError(option, f"{name!r} has no value in this scenario", "name a figure that has one")
    return keys


def needed_parts(keys: Sequence[Keys], tracks: Mapping[str, str]) -> tuple[list[str], dict[str, bool]]:
    """Motions whose responses the figures of ``run`` are read from, and whether their loads and axes are needed."""
    motions: dict[str, None] = {}  # an ordered set
    axes = False
    for table, *rest in keys:
        if table == "comparisons":
            motions |= dict.fromkeys((tracks[str(rest[0])], str(rest[0])))
            axes = True
        elif table == "motions":
            motions[str(rest[0])] = None
            axes |= rest[1] not in ("tip", "stations", "loads", "hub")
    return list(motions), {"loads": any(map(of_loads, keys)), "axes": axes}


def facts_of(answer: Any) -> Facts:
    return answer_facts(answer) if isinstance(answer, Study) else answer


def values_at(facts: Facts, keys: Sequence[Keys]) -> Floats:
    return np.array([value_at(facts, figure_keys) for figure_keys in keys])


def _possible(
    inquiry: Inquiry, values: Sequence[PhysicalValue], *, strict: bool
) -> tuple[list[PhysicalValue], list[str]]:
    """Values that the scenario allows to be a little smaller and larger, and the others with reasons.

    `strict` raises InputError for the first of these.
    """
    possible, refused = [], []
    for parameter in values:
        value = parameter.value
        try:
            for share in (-1e-3, 1e-3):
                inquiry.case(changes_to([parameter], [value * (1 + share) if value else share * 1e-3]))
        except GbeamError as error:
            reason = re.sub(rf"^--set [^:]*: |{re.escape(parameter.path)}:? ", "", str(error).splitlines()[0])
            if strict:
                problem = f"names {parameter.path}, which may not be a little less and a little more ({reason})"
                raise InputError("--with", problem, "leave it out: it has no derivative there") from None
            refused.append(f"{parameter.path}: {reason}")
            continue
        possible.append(parameter)
    return possible, refused
