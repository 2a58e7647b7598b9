"""Least squares between a scenario and a measurement, by exact derivatives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from gbeam.analysis.response.tangents.differentiated import Grid
from gbeam.analysis.study.case import Case
from gbeam.errors import ComputationError, GbeamError, InputError
from gbeam.mechanics.models import Model
from gbeam.progress import Progress
from gbeam.results.result import Floats
from gbeam.studies.derivatives import Neighbourhood
from gbeam.studies.measurement import Measurement
from gbeam.studies.parameters import PhysicalValue
from gbeam.sweeps.computing.evaluate import Question

ALIKE = "not identifiable"  # an outcome
_ALIKE = 1e-6  # least singular value of the normalised derivatives, of the largest
_IDLE = 1e-2  # of the noise: less than that the data change where a value is doubled
_ROUNDS, _SETTLED = 4, 0.05  # searches, the columns' noise found anew, until its change is less
_PRECISE = 1e-8  # of the search
_IMPOSSIBLE = 1e3  # times the first residual: of values that the scenario does not allow


@dataclass
class Fitted:
    """What the scenario says of the measured quantities at any values of the parameters."""

    question: Question
    parameters: Sequence[PhysicalValue]
    measurement: Measurement
    progress: Progress
    grids: dict[str, Grid] | None = None
    shapes: Model | None = None
    evaluations: int = 0
    _last: tuple[Floats, Neighbourhood] | None = None

    def __post_init__(self) -> None:
        if self.measurement.modal:
            return
        # Steps and shapes of all runs are those that the scenario's own run needs.
        own = Neighbourhood(self.question, self.parameters, progress=self.progress)
        self.shapes = own.case.model
        self.grids = {name: own.grid(name) for name in self.measurement.motions}

    def about(self, values: Floats) -> Neighbourhood:
        """The neighbourhood of some values; the last one is kept."""
        if self._last is None or not np.array_equal(self._last[0], values):
            self.evaluations += 1
            made = Neighbourhood(
                self.question, self.parameters, values.tolist(), grids=self.grids, parts=self.measurement.parts,
                adapt=self._adapted, progress=self.progress,
            )  # fmt: skip
            self._last = values.copy(), made
        return self._last[1]

    def __call__(self, values: Floats) -> Floats:
        """The measured quantities."""
        about = self.about(values)
        for name in self.measurement.motions if self.grids is not None else ():
            about.done(name)
        return self.measurement.read(about.case, about.answer)

    def slopes(self, values: Floats) -> Floats:
        """Their derivatives, (m, p)."""
        measurement = self.measurement
        return self.about(values).slopes(measurement.read, measurement.motions).slopes

    def _adapted(self, case: Case) -> Case:
        case = self.measurement.instrumented(case)
        return case if self.shapes is None else replace(case, model=self.shapes)


@dataclass(frozen=True)
class Solution:
    """The values of least squares, and what they were found from."""

    before: Floats
    values: Floats
    weights: Floats
    jacobian: Floats


def search_from(model: Fitted, starts: Sequence[Floats], limits: Floats) -> tuple[Solution, list[Floats]]:
    """The best of searches from several values, the scenario's own first, and the values at which each ended."""
    found = [search(model, starts[0], limits)]
    for start in starts[1:]:
        try:
            found.append(search(model, start, limits))
        except GbeamError:  # values that the scenario does not allow, or at which the data say nothing
            continue
    # Of noise that is not known, the likelihood is a product of the weights.
    best = max(found, key=lambda each: float(np.log(each.weights).sum()))
    return replace(best, before=found[0].before), [each.values for each in found]


def search(model: Fitted, start: Floats, limits: Floats) -> Solution:
    """Least squares, the weight of every column found anew from its residuals."""
    from scipy.optimize import least_squares

    measured = model.measurement.values
    before = model(start)
    scale = np.where(start == 0, limits[:, 1] - limits[:, 0], np.abs(start))
    weights = model.measurement.weights(None, len(start))
    tell_apart(model.slopes(start) * scale * weights[:, None], model.parameters)
    first = max(float(np.linalg.norm((before - measured) * weights)), 1.0)

    def residual(x: Floats, weights: Floats) -> Floats:
        try:
            return np.asarray((model(x * scale) - measured) * weights)
        except (InputError, ComputationError):  # the scenario does not allow it, or diverges: the step is taken back
            return np.full(len(measured), _IMPOSSIBLE * first / np.sqrt(len(measured)))

    def jacobian(x: Floats, weights: Floats) -> Floats:
        return np.asarray(model.slopes(x * scale) * scale * weights[:, None])

    x = start / scale
    for _ in range(_ROUNDS):
        found = least_squares(
            residual, x, jacobian, bounds=(limits / scale[:, None]).T, x_scale="jac", args=(weights,),
            xtol=_PRECISE, ftol=_PRECISE, gtol=None,
        )  # fmt: skip
        x = found.x
        new = model.measurement.weights(model(x * scale) - measured, len(x))
        change = new / weights
        weights = new
        if change.max() <= (1 + _SETTLED) * change.min():
            break
    return Solution(before, x * scale, weights, model.slopes(x * scale) * weights[:, None])


def tell_apart(jacobian: Floats, parameters: Sequence[PhysicalValue]) -> float:
    """Condition of weighted derivatives (m, p), each parameter's of unit length.

    Raises
    ------
    ComputationError
        If the data do not depend on a parameter, or cannot tell some apart.
    """
    lengths = np.linalg.norm(jacobian, axis=0)
    names = [each.path for each in parameters]
    least = max(_ALIKE * lengths.max(), _IDLE)
    idle = [name for name, length in zip(names, lengths, strict=True) if length <= least]
    if idle:
        raise ComputationError(ALIKE, f"the data do not depend on {' and '.join(idle)}: leave that out of --free")
    _, sizes, directions = np.linalg.svd(jacobian / lengths, full_matrices=False)
    if sizes[-1] > _ALIKE * sizes[0]:
        return float(sizes[0] / sizes[-1])
    alike = [names[k] for k in np.argsort(-np.abs(directions[-1])) if abs(directions[-1][k]) > 0.1]
    problem = f"the data cannot tell {' and '.join(alike)} apart: changed together they leave it as it is"
    raise ComputationError(ALIKE, f"{problem}; free only one of them, or measure what they do differently")
