"""Calibration: the values of a scenario nearest to a measurement, by least squares along exact derivatives."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from gbeam.analysis.case import Case
from gbeam.errors import ComputationError, GbeamError, InputError
from gbeam.guards.arguments import typed
from gbeam.guards.kinds import WRITTEN, kinds
from gbeam.guards.quantities import Seconds
from gbeam.progress import Progress
from gbeam.questions import Needs, Options, reduced
from gbeam.results.result import Floats
from gbeam.results.searches import Fit, FittedColumn
from gbeam.studies.derivatives import Neighbourhood, Quantities
from gbeam.studies.evaluate import Inquiry
from gbeam.studies.measurement import Measurement, read_measurement
from gbeam.studies.parameters import (
    Bounds,
    PhysicalValue,
    bounds_of,
    count_agreeing,
    on_bound,
    search_all,
    select_values,
)
from gbeam.studies.template import template_of

OPTION = "--free"
_HARDLY = 0.99  # correlation of two values
_TIED = 0.7  # correlation of residuals with the next ones, above which they are not noise
_VISIBLE = 1e-5  # of the largest datum: residuals that are less are rounding


@kinds(bounds=WRITTEN, options=WRITTEN)
@typed
def fit(
    scenario: str | os.PathLike[str] | Case,
    data: str | os.PathLike[str],
    free: Sequence[str],
    *,
    bounds: Bounds | None = None,
    motion: str | None = None,
    at: Seconds | None = None,
    options: Options | None = None,
    starts: int = 1,
    overrides: Sequence[str] = (),
    progress: Progress = None,
) -> Fit:
    """Find values of a scenario by least squares from measured histories, or from frequencies and damping.

    The columns of the data have unknown noise each, which is found from their residuals and weighs them. Errors hold if
    the residuals are noise without correlation. Where they are not, a warning says so.

    Parameters
    ----------
    scenario : path or Case
        The scenario's file, or a case, of :func:`gbeam.read_scenario` or made in Python.
        Its values are where the search starts.
    data : path
        A text file with a header. Columns ``time`` and what :meth:`Response.signal` reads, such as ``tip.z``,
        ``root_moment.y``, ``hub.angle`` or ``strip.tip.place_z``, or strain gauges, ``strain.z@10 mm``, with a unit in
        brackets or SI, after the motion's name where the scenario has several; or columns ``mode``, ``frequency`` and
        ``damping_ratio``.
    free : sequence of str
        Paths of the values to find, such as ``beam.material.youngs_modulus``; ``*`` stands for part of one step, and
        values that it fits, which the scenario gives alike, stay alike: ``bodies.plate.springs.*.stiffness.z``.
    bounds : mapping of str to a pair, optional
        By path, in SI or as text with a unit; a tenth to ten times the scenario's value where not given.
    motion : str, optional
        Of columns that name none, and of modes.
    at : float, optional
        Time at which that motion is frozen for modes, s; the start of the response by default.
    options : mapping of str to values, optional
        Options of ``modes`` by their names on its command line, such as ``{"gyroscopic": False}``.
    starts : int
        Searches: one from the scenario's values, the others from values spread over the bounds. The likeliest is given,
        with how many of them agree.
    overrides : sequence of str
        Changes of the scenario, such as ``beam.length=250 mm``.
    progress : callable or bool, optional
        Called with what is being done and the fraction of it done; True shows a bar.

    Returns
    -------
    Fit

    Raises
    ------
    InputError
        If the scenario, the data, a value or a bound is wrong, or there are more values than data.
    ComputationError
        If the data cannot tell two values apart, or do not depend on one; or a run is not done.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import mkdtemp
    >>> import numpy as np
    >>> taps = Path(mkdtemp()) / "taps.csv"
    >>> measured = [(1, 0.46, 0.01), (2, 2.88, 0.01), (3, 8.06, 0.01)]
    >>> np.savetxt(taps, measured, delimiter=",", header="mode,frequency,damping_ratio", comments="")
    >>> hub = "examples/hubbeam2009_slew_2p8.toml"
    >>> answer = gb.fit(hub, taps, ["beam.material.youngs_modulus"])
    >>> print(f"{answer.values[0]:.4g} {answer.units[0]}")
    6.788e+10 Pa
    """
    template = template_of(scenario, overrides)
    if not free:
        raise InputError(OPTION, "is missing", 'name values: --free "beam.material.youngs_modulus"')
    parameters = select_values(template, free, OPTION)
    case = template.built()
    measurement = read_measurement(data, case, motion)
    verb, read = ("modes", "modes") if measurement.modal else ("run", "motions")
    inquiry = Inquiry(template, verb, motion, at, options or {}, keys=((read,),))  # without estimates of errors
    if len(measurement.values) <= len(parameters):
        problem = f"names {len(parameters)} values for {len(measurement.values)} data"
        raise InputError(OPTION, problem, "measure more, or free fewer")
    limits = np.array([bounds_of(parameter, bounds or {}, OPTION) for parameter in parameters])
    adapt = partial(reduced, needs=Needs(errors=False))
    start = None if measurement.modal else Neighbourhood(inquiry, parameters, adapt=adapt, progress=progress)
    model = Quantities(
        inquiry, parameters, measurement.read, start, measurement.motions, measurement.parts,
        measurement.instrumented, progress,
    )  # fmt: skip
    solutions = search_all(parameters, limits, starts, lambda x: _search(model, measurement, parameters, x, limits))
    likeliest = max(solutions, key=lambda solution: solution.likelihood)
    solution = replace(likeliest, before=solutions[0].before)
    described = _result_of(model, measurement, parameters, limits, solution)
    agreed = count_agreeing([solution.values for solution in solutions], solution.values, limits)
    return replace(
        described, title=template.title([parameter.path for parameter in parameters]), starts=starts, agreed=agreed,
        notes=template.notes, provenance=template.provenance,
    )  # fmt: skip


def _result_of(
    model: Quantities,
    measurement: Measurement,
    parameters: Sequence[PhysicalValue],
    limits: Floats,
    solution: Solution,
) -> Fit:
    """Result of a solution: standard errors, 95 % intervals, correlations of the values inside their bounds."""
    from scipy.special import stdtrit

    fitted, measured = model(solution.values), measurement.values
    count, size = len(measured), len(parameters)
    at_edge = np.isin(np.arange(size), model.edges(solution.values))
    at_bound = on_bound(solution.values, limits) | at_edge
    free_indices = np.flatnonzero(~at_bound)
    variance = float(np.sum(((fitted - measured) * solution.weights) ** 2)) / (count - size)
    spread = np.full((size, size), np.nan)  # covariance over variance, which may be zero
    condition = np.nan
    if free_indices.size:
        jacobian = solution.jacobian[:, free_indices]
        condition = tell_apart(jacobian * solution.values[free_indices], [parameters[int(k)] for k in free_indices])
        lengths = np.linalg.norm(jacobian, axis=0)
        unit = jacobian / lengths
        spread[np.ix_(free_indices, free_indices)] = np.linalg.inv(unit.T @ unit) / np.outer(lengths, lengths)
    sizes = np.sqrt(np.diag(spread))
    errors = np.sqrt(variance) * sizes
    half = float(stdtrit(count - size, 0.975)) * errors
    correlation = spread / np.outer(sizes, sizes)
    columns = _columns(measurement, fitted, solution.before, size)
    return Fit(
        title="",
        data=measurement.file,
        parameters=tuple(parameter.path for parameter in parameters),
        units=tuple(parameter.unit for parameter in parameters),
        before=np.array([parameter.value for parameter in parameters]),
        values=solution.values,
        errors=errors,
        intervals=np.stack([solution.values - half, solution.values + half], axis=1),
        covariance=variance * spread,
        correlation=correlation,
        bounds=limits,
        at_bound=at_bound,
        columns=columns,
        at=measurement.at,
        modal=measurement.modal,
        evaluations=model.evaluations,
        condition=condition,
        warnings=tuple(_doubts(parameters, at_bound, at_edge, correlation, columns)),
    )


def _columns(measurement: Measurement, fitted: Floats, start_values: Floats, size: int) -> tuple[FittedColumn, ...]:
    """Each measured column with the model's values, its noise, and the correlation of neighbouring residuals.

    `size` is the number of parameters, `start_values` are the model's values before the fit.
    """
    ends = np.cumsum([len(column.values) for column in measurement.columns])[:-1]
    share = 1 - size / len(fitted)  # of the degrees of freedom that the parameters leave
    columns = []
    for column, fitted_values, start in zip(
        measurement.columns, np.split(fitted, ends), np.split(start_values, ends), strict=True
    ):
        r = column.values - fitted_values
        power = float(np.sum(r**2))
        correlation = float(np.sum(r[1:] * r[:-1])) / power if power > 0 and not measurement.modal else np.nan
        noise = float(np.sqrt(power / (len(r) * share)))
        columns.append(FittedColumn(column.name, column.unit, column.values, fitted_values, start, noise, correlation))
    return tuple(columns)


def _doubts(
    parameters: Sequence[PhysicalValue],
    at_bound: Any,
    at_edge: Any,
    correlation: Floats,
    columns: Sequence[FittedColumn],
) -> Iterator[str]:
    """Warn of values on bounds, of pairs that the data hardly tell apart, and of residuals that are not noise."""
    names = [parameter.path for parameter in parameters]
    for k, name in enumerate(names):
        if at_edge[k]:
            yield f"{name} lies at the edge of what the scenario allows, and has no error"
        elif at_bound[k]:
            yield f"{name} lies on its bound: the least squares are beyond, and it has no error"
        for j in range(k):
            pair = float(correlation[k, j])
            if abs(pair) > _HARDLY:
                yield f"the data hardly tell {names[j]} and {name} apart: their errors have a correlation of {pair:.4f}"
    for column in columns:
        if column.correlation > _TIED and column.noise > _VISIBLE * np.abs(column.measured).max():
            yield (
                f"the residuals of {column.name} are no noise: each is like the next, with a correlation of "
                f"{column.correlation:.2f}. The scenario cannot follow the data, and the errors are too small"
            )


ALIKE = "not identifiable"  # an outcome
_ALIKE = 1e-6  # least singular value of the normalised derivatives, of the largest
_IDLE = 1e-2  # of the noise: a value whose doubling changes the data by less is not seen
_ROUNDS, _SETTLED = 4, 0.05  # searches at most, with the noise of columns estimated anew, until it changes by less
_PRECISE = 1e-8  # of the search
_IMPOSSIBLE = 1e3  # times the first residual: residual at values that the scenario refuses


@dataclass(frozen=True)
class Solution:
    """Values of least squares, with the last weights and weighted derivatives, and the log-likelihood."""

    before: Floats  # (m,), the model at the start
    values: Floats  # (p,)
    weights: Floats  # (m,)
    jacobian: Floats  # (m, p)
    likelihood: float


def _search(
    model: Quantities, measurement: Measurement, parameters: Sequence[PhysicalValue], start: Floats, limits: Floats
) -> Solution:
    """Solve the least squares from `start` (p,), again while the columns' weights, from the residuals, change."""
    from scipy.optimize import least_squares

    measured = measurement.values
    start_values = model(start)
    scale = np.where(start == 0, limits[:, 1] - limits[:, 0], np.abs(start))
    weights = measurement.weights(None, len(start))
    tell_apart(model.slopes(start) * scale * weights[:, None], parameters)
    first_residual = max(float(np.linalg.norm((start_values - measured) * weights)), 1.0)

    def residual(x: Floats, weights: Floats) -> Floats:
        try:
            return np.asarray((model(x * scale) - measured) * weights)
        except GbeamError:  # the scenario refuses the values, or diverges: the search takes the step back
            return np.full(len(measured), _IMPOSSIBLE * first_residual / np.sqrt(len(measured)))

    def jacobian(x: Floats, weights: Floats) -> Floats:
        return np.asarray(model.slopes(x * scale) * scale * weights[:, None])

    x = start / scale
    for _ in range(_ROUNDS):
        fitted = least_squares(
            residual, x, jacobian, bounds=(limits / scale[:, None]).T, x_scale="jac", args=(weights,),
            xtol=_PRECISE, ftol=_PRECISE, gtol=None,
        )  # fmt: skip
        x = fitted.x
        new_weights = measurement.weights(model(x * scale) - measured, len(x))
        change = new_weights / weights
        weights = new_weights
        if change.max() <= (1 + _SETTLED) * change.min():
            break
    misfit = (model(x * scale) - measured) * weights
    # Where noise is estimated from the residuals the misfit is the same in all searches, else the weights are.
    likelihood = float(np.log(weights).sum() - (misfit @ misfit) / 2)
    return Solution(start_values, x * scale, weights, model.slopes(x * scale) * weights[:, None], likelihood)


def tell_apart(jacobian: Floats, parameters: Sequence[PhysicalValue]) -> float:
    """Condition number of weighted derivatives (m, p), with columns scaled to unit length.

    ComputationError if a parameter changes no data, or if parameters change them alike, so that a singular value
    vanishes.
    """
    lengths = np.linalg.norm(jacobian, axis=0)
    names = [parameter.path for parameter in parameters]
    threshold = max(_ALIKE * lengths.max(), _IDLE)
    idle = [name for name, length in zip(names, lengths, strict=True) if length <= threshold]
    if idle:
        raise ComputationError(ALIKE, f"the data do not depend on {' and '.join(idle)}: leave that out of --free")
    _, sizes, directions = np.linalg.svd(jacobian / lengths, full_matrices=False)
    if sizes[-1] > _ALIKE * sizes[0]:
        return float(sizes[0] / sizes[-1])
    confused = [names[k] for k in np.argsort(-np.abs(directions[-1])) if abs(directions[-1][k]) > 0.1]
    problem = f"the data cannot tell {' and '.join(confused)} apart: changed together they leave it as it is"
    raise ComputationError(ALIKE, f"{problem}; free only one of them, or measure what they do differently")
