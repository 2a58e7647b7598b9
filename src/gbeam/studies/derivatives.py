"""Derivatives of whatever is read from an answer, with respect to physical values of the scenario.

Those of responses over time come from the derivative of the run (`gbeam.analysis.response.differentiated`).
Where a jump moves with the value, which the run's fixed steps would miss, and for all other answers, they are central
differences of fourth order. Their error is the difference from those of second order.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

import numpy as np

from gbeam.analysis.case import Case
from gbeam.analysis.environments import studied, study_of
from gbeam.analysis.response.differentiated import Differentiated, Grid, Variant
from gbeam.analysis.response.simulation import simulate
from gbeam.errors import ComputationError, GbeamError, InputError
from gbeam.io.kept import unkept
from gbeam.mechanics.assembly import model_of, remade, stations_asked
from gbeam.mechanics.tree.system import System
from gbeam.progress import Progress, tell
from gbeam.results.response import Response
from gbeam.results.result import Floats
from gbeam.results.study import Study
from gbeam.studies.evaluate import Inquiry
from gbeam.studies.parameters import PhysicalValue, changes_to

# Reads the quantities to differentiate, (m,), from a case and its answer: a Study, or another verb's facts.
Read = Callable[[Case, Any], Floats]
_NEAR = 1e-5  # step over the value, where the derivative of the run is exact
_RUNS, _FACTS = 1e-4, 1e-3  # the same, of differences of whole runs and of other answers
_AT_ZERO = 1e-6  # in SI units, in place of a share of what is zero
EXACT, DIFFERENCE = "exact", "difference"


@dataclass(frozen=True)
class Slopes:
    """Values (m,) read from an answer, and their derivatives with respect to p parameters."""

    values: Floats
    slopes: Floats  # (m, p)
    errors: Floats  # (m, p), NaN of exact ones
    methods: tuple[str, ...]
    bends: Floats  # (m, p), difference between the one-sided slopes: of the order of the step where all is smooth


class Neighbourhood:
    """A case with its answer, and the cases with a little less and a little more of each value.

    With `grids`, by motion, runs take those steps and estimate no errors; `parts` (``loads``, ``axes``) that are
    false are not computed. `adapt` changes every case before it is answered.
    """

    def __init__(
        self,
        inquiry: Inquiry,
        parameters: Sequence[PhysicalValue],
        values: Sequence[float] | None = None,
        *,
        grids: Mapping[str, Grid] | None = None,
        parts: Mapping[str, bool] = MappingProxyType({}),
        adapt: Callable[[Any], Any] | None = None,
        progress: Progress = None,
    ) -> None:
        """Build the case with these values of the parameters, and answer it, in the steps of `grids` if given."""
        self.inquiry, self.parameters, self.parts = inquiry, parameters, parts
        self._by_motion: dict[str, Differentiated] = {}
        self.edges = set[int]()  # parameters on one side of whose value the scenario refuses a step
        self.progress, self.adapt = progress, adapt or (lambda case: case)
        self.values = [parameter.value for parameter in parameters]
        if values is not None:
            self.values = [float(value) for value in values]
        self.case: Case = self._built(None, 0.0)
        # Runs are differentiated themselves, all other answers by differences.
        self.runs = inquiry.verb == "run" and _differentiable(self.case.system)
        self.answer: Any
        if self.runs:
            if grids is None:
                self.case, self.answer = studied(self.case, self.progress)
            else:
                runs = {name: self._differentiated(name, grid).unvaried() for name, grid in grids.items()}
                self.answer = study_of(self.case, runs)
        else:
            self.answer = inquiry.facts(self.case)

    def slopes(self, read: Read, motions: Sequence[str] = (), *, rough: bool = False) -> Slopes:
        """Derivatives, by all parameters, of the quantities that `read` takes from the answers in `motions`.

        Without `motions` all are taken. `rough` ones take half as many answers: one-sided differences at an edge of the
        scenario, and, of verbs other than run, no errors and bends.
        """
        if self.runs:
            return self._of_runs(read, motions or list(self.case.environments), rough)
        values = read(self.case, self.answer)
        rows = []
        for k, parameter in enumerate(self.parameters):
            tell(self.progress, parameter.path, k / len(self.parameters))
            step = self._step(k, _FACTS)
            if rough:
                smaller, larger = (read(case, self.inquiry.facts(case)) for case in self._neighbours(k, step, rough))
                nans = np.full(len(values), np.nan)
                rows.append(((larger - smaller) / (2 * step), nans, nans))
                continue

            def shifted(count: float, k: int = k, step: float = step) -> Floats:
                case = self._case(k, count * step)
                return read(case, self.inquiry.facts(case))

            rows.append(_differences(shifted, values, step))
        return _stack_slopes(values, rows, [DIFFERENCE] * len(rows))

    def require_response(self, name: str) -> Response:
        """The response in one environment; ComputationError if it is not done."""
        end = self.answer.failures.get(name) or self.answer.responses[name]
        if end.outcome != "done":
            raise ComputationError(end.outcome, f"motion.{name}: {end.message}")
        response: Response = self.answer.responses[name]
        return response

    def grid(self, name: str) -> Grid:
        """Steps of the run of a motion."""
        case = self.case
        return Grid.from_run(case.system, case.environments[name], case.settings_of(name), self.require_response(name))

    def _differentiated(self, name: str, grid: Grid) -> Differentiated:
        motion, settings = self.case.environments[name], self.case.settings_of(name)
        self._by_motion[name] = Differentiated(self.case.system, motion, settings, grid, name, **self.parts)
        return self._by_motion[name]

    def _of_runs(self, read: Read, motions: Sequence[str], rough: bool) -> Slopes:
        """Slopes of runs: all parameters along which the jumps stay are right-hand sides of one solution."""
        originals = {name: self.require_response(name) for name in motions}
        for name in motions:
            if name not in self._by_motion:
                self._differentiated(name, self.grid(name))
        runs = {name: self._by_motion[name] for name in motions}
        values = read(self.case, self.answer)
        steps = np.array([self._step(k, _NEAR) for k in range(len(self.parameters))])
        # By motion and parameter, of those that it feels: the problems with a little less and a little more of it.
        pairs: dict[str, dict[int, Any]] = {name: {} for name in motions}
        jumping, cases = set(), []
        for k, step in enumerate(steps):
            smaller, larger = self._neighbours(k, step, rough)
            cases.append((smaller, larger))
            for name in motions:
                if not self._felt(k, name):
                    continue
                pair = runs[name].pair(self._variant(smaller, k, name), self._variant(larger, k, name))
                if runs[name].jumps_move(pair):
                    jumping.add(k)
                pairs[name][k] = pair
        smooth = {name: [k for k in of_motion if k not in jumping] for name, of_motion in pairs.items()}
        responses = {
            name: runs[name].responses([pairs[name][k] for k in chosen], 2 * steps[chosen])
            for name, chosen in smooth.items()
        }
        rows = []
        for k, parameter in enumerate(self.parameters):
            tell(self.progress, parameter.path, k / len(self.parameters))
            if k in jumping:
                step = self._step(k, _RUNS)

                def shifted(count: float, k: int = k, step: float = step) -> Floats:
                    case = self._case(k, count * step)
                    return read(case, _runs(case, {name: originals[name].step for name in motions}))

                rows.append(_differences(shifted, values, step))
                continue
            sides: tuple[dict[str, Response], dict[str, Response]] = (dict(originals), dict(originals))
            for name in motions:
                if k in pairs[name]:
                    sides[0][name], sides[1][name] = next(responses[name])
            ends = [read(case, study_of(case, side)) for case, side in zip(cases[k], sides, strict=True)]
            rows.append((*_slope(ends[0], values, ends[1], steps[k]), np.full(len(values), np.nan)))
        return _stack_slopes(values, rows, [DIFFERENCE if k in jumping else EXACT for k in range(len(rows))])

    def _neighbours(self, k: int, step: float, rough: bool) -> tuple[Case, Case]:
        """Cases with parameter `k` smaller and larger by `step`.

        Where the scenario refuses one of them, `rough` takes the case itself and one two steps to the other side, and
        notes that `k` is at an edge.
        """
        ends = []
        for sign in (-1, 1):
            try:
                ends.append(self._case(k, sign * step))
            except InputError:
                if not rough:
                    raise
                self.edges.add(k)
                unchanged, second = self._case(k, 0.0), self._case(k, -sign * 2 * step)
                return (unchanged, second) if sign < 0 else (second, unchanged)
        return ends[0], ends[1]

    def _case(self, k: int, step: float) -> Case:
        """Case with parameter `k` larger by `step`, and beams in the same model; InputError if it is refused."""
        parameter = self.parameters[k]
        try:
            case = self._built(k, step)
        except GbeamError as error:
            value, word = self.values[k], "less" if step < 0 else "more"
            problem = f"{parameter.path} = {value:.6g} {parameter.unit}".rstrip() + f" may not be a little {word}"
            raise InputError(
                "--with", f"{problem} ({str(error).splitlines()[0]})", "leave it out, or move it off its bound"
            ) from None
        return in_model_of(self.case, case)

    def _built(self, k: int | None, step: float) -> Any:
        """The case with parameter `k` more by `step`. Reduced meshes are kept on disk of the unchanged case only."""
        changes = self._changes(k, step)
        with unkept() if changes else nullcontext():
            return self.adapt(self.inquiry.case(changes))

    def _changes(self, k: int | None, step: float) -> tuple[str, ...]:
        values = [value + (step if i == k else 0.0) for i, value in enumerate(self.values)]
        return changes_to(self.parameters, values)

    def _step(self, k: int, share: float) -> float:
        return share * abs(self.values[k]) or _AT_ZERO

    def _felt(self, k: int, name: str) -> bool:
        """True if a parameter has anything to do with a motion."""
        motion = self.parameters[k].of_motion
        return not motion or motion == name or self.case.tracks.get(name) == motion

    def _variant(self, case: Case, k: int, name: str) -> Variant:
        of_motions = [place.startswith("motion.") for place in self.parameters[k].places]
        motion = case.environments[name] if any(of_motions) else None
        return None if all(of_motions) else case.system, motion


class Quantities:
    """Quantities read from answers at any values of the parameters, and their derivatives.

    Runs of a beam take the time steps and shapes of `start`; without it each answer has its own.
    """

    def __init__(
        self,
        inquiry: Inquiry,
        parameters: Sequence[PhysicalValue],
        read: Read,
        start: Neighbourhood | None,
        motions: Sequence[str],
        parts: Mapping[str, bool],
        adapt: Callable[[Any], Any] = lambda case: case,
        progress: Progress = None,
    ) -> None:
        """Prepare functions of the parameters. Nothing is computed yet."""
        self._inquiry, self._parameters, self._read = inquiry, parameters, read
        self._motions, self._parts, self._adapt, self._progress = motions, parts, adapt, progress
        self._start = start if start is not None and start.runs else None
        self._grids = None if self._start is None else {name: self._start.grid(name) for name in motions}
        self._last: tuple[Floats, Floats, Neighbourhood] | None = None
        self._sloped: tuple[Neighbourhood, Floats] | None = None
        self.evaluations = 0

    def __call__(self, values: Floats) -> Floats:
        """Quantities (m,) at values (p,) of the parameters. The last ones are kept."""
        return self._evaluate(values)[1]

    def slopes(self, values: Floats) -> Floats:
        """Derivatives with respect to the values, (m, p). The last ones are kept."""
        nearby = self._evaluate(values)[2]
        if self._sloped is None or self._sloped[0] is not nearby:
            self._sloped = nearby, nearby.slopes(self._read, self._motions, rough=True).slopes
        return self._sloped[1]

    def edges(self, values: Floats) -> tuple[int, ...]:
        """Parameters whose values lie at the edge of what the scenario allows."""
        nearby = self._evaluate(values)[2]
        self.slopes(values)  # tries both sides
        return tuple(nearby.edges)

    def _evaluate(self, values: Floats) -> tuple[Floats, Floats, Neighbourhood]:
        """The values, the quantities at them, and the neighbourhood; computed unless the last values were the same."""
        if self._last is None or not np.array_equal(self._last[0], values):
            self.evaluations += 1
            try:
                nearby = Neighbourhood(
                    self._inquiry, self._parameters, values.tolist(), grids=self._grids, parts=self._parts,
                    adapt=self._shaped, progress=self._progress,
                )  # fmt: skip
            except InputError as error:
                pairs = zip(self._parameters, values, strict=True)
                tried = (f"{parameter.path} = {value:.6g} {parameter.unit}" for parameter, value in pairs)
                problem = f"allow {', '.join(tried)}, which the scenario refuses: {error.where} {error.problem}"
                raise InputError("--bounds", problem, "give narrower ones") from None
            for name in self._motions if self._grids is not None else ():
                nearby.require_response(name)
            quantities = self._read(nearby.case, nearby.answer)
            if not np.isfinite(quantities).all():
                raise ComputationError("not converged", "a figure of the search has no value")
            self._last = values.copy(), quantities, nearby
        return self._last

    def _shaped(self, case: Any) -> Any:
        case = self._adapt(case)
        return case if self._start is None else in_model_of(self._start.case, case)


def in_model_of(model_case: Case, case: Case) -> Case:
    """Return a case whose beams have as many shapes as those of `model_case`, where the numbers are automatic there."""
    changed = {}
    for name, model_body in model_case.automatic_beams.items():
        body = case.system.flexible[name]
        if model_of(body) != model_of(model_body):
            changed[name] = remade(body, model_of(model_body), stations_asked(body))
    if not changed:
        return case
    return replace(case, system=replace(case.system, bodies={**case.system.bodies, **changed}))


def _differentiable(system: System) -> bool:
    """True if the derivative of its run is known: shapes of a reduced mesh follow its values, laws of controllers have
    no derivative here, and joints with stops or friction change their slope within steps.
    """
    meshes = any(body.source is None for body in system.flexible.values())
    bending = any(joint.holder.bends for joint in system.joints.values())
    return bool(len(system.tree.unknowns)) and not (meshes or bending or system.controllers)


def _runs(case: Case, steps: Mapping[str, float]) -> Study:
    """Study of the motions in `steps`, run by these time steps, s, without estimates of errors."""
    responses = dict[str, Any]()
    for name, step in steps.items():
        settings = replace(case.settings_of(name), step=step, estimate=False)
        responses[name] = simulate(case.system, case.environments[name], settings, name=name)
    return study_of(case, responses)


def _slope(smaller: Floats, middle: Floats, larger: Floats, step: float) -> tuple[Floats, Floats]:
    """The central difference, and by how much the slopes on either side differ."""
    return (larger - smaller) / (2 * step), np.abs(larger - 2 * middle + smaller) / step


def _differences(shifted: Callable[[float], Floats], middle: Floats, step: float) -> tuple[Floats, Floats, Floats]:
    """Difference of fourth order, difference of the one-sided slopes, and difference from second order, (m,) each.

    `shifted` returns the quantities a number of steps away. `middle` are those at no steps.
    """
    inner = shifted(1.0), shifted(-1.0)
    slope, bend = _slope(inner[1], middle, inner[0], step)
    outer = shifted(2.0), shifted(-2.0)
    fourth = (8 * (inner[0] - inner[1]) - (outer[0] - outer[1])) / (12 * step)
    return fourth, bend, np.abs(fourth - slope)


def _stack_slopes(values: Floats, rows: Sequence[tuple[Floats, Floats, Floats]], methods: Sequence[str]) -> Slopes:
    slopes, bends, errors = (np.stack(column, axis=1) for column in zip(*rows, strict=True))
    return Slopes(values, slopes, errors, tuple(methods), bends)
