"""A whole case: the response in every environment, and the comparison of each centrifuge with the flight it tracks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from types import MappingProxyType
from typing import Any

import numpy as np

from gbeam.analysis.automatic import sufficient
from gbeam.analysis.case import Case
from gbeam.analysis.imitation.comparison import compare
from gbeam.analysis.response.simulation import simulate
from gbeam.errors import ComputationError, placing_within
from gbeam.guards.arguments import typed
from gbeam.numerics.peaks import vector_peaks
from gbeam.progress import Progress, tell
from gbeam.results.comparison import Comparison
from gbeam.results.criteria import judging
from gbeam.results.errors import Errors
from gbeam.results.parts import Extremes, VectorPeaks
from gbeam.results.response import Response
from gbeam.results.result import each_once
from gbeam.results.sensors import Readings, Sensor
from gbeam.results.study import Failure, Study

ENOUGH = 1e-3  # error from too few shapes, at most, where their numbers are automatic


@typed
def study(case: Case, progress: Progress = None) -> Any:
    """Compute the response in every environment of a case and compare each centrifuge with its flight.

    Parameters
    ----------
    case : Case
        From :func:`gbeam.read_scenario`, or made by hand.
    progress : callable or bool, optional
        Called with what is being done and the fraction of it done; True shows a bar.

    Returns
    -------
    Study

    Raises
    ------
    InputError
        With its place in the scenario.
    ComputationError
        If no motion has a relative equilibrium to start from; the message names each.

    Examples
    --------
    >>> answer = gb.study(gb.read_scenario("examples/zhang2020_example1.toml"))
    >>> answer.outcome
    'done'
    >>> print(f"{answer.comparisons[0].relative[2]:.1%}")
    0.0%
    """
    return studied(case, progress)[1]


def studied(case: Case, progress: Progress = None) -> tuple[Case, Study]:
    """Raise automatic numbers of shapes as far as a case's responses need; return the case and its study."""
    settings = case.over_time
    if not settings.estimate:
        fix = "give it, or leave response.estimate out"
        case.refuse_automatic("is left out, and estimate = false leaves nothing to choose it by", fix)
    limits = {"shapes": min(settings.tolerance / 3, ENOUGH), "strains": settings.tolerance}
    case, (responses, failures) = sufficient(case, partial(_answers, progress=progress), _errors_of, **limits)
    return case, study_of(case, responses, failures)


def study_of(case: Case, responses: Mapping[str, Any], failures: Mapping[str, Failure] = MappingProxyType({})) -> Study:
    """Join responses by name into a study, and compare each centrifuge with its flight if both are done.

    ComputationError if there are no responses.
    """
    if not responses:
        first = next(iter(failures.values()))
        message = "; ".join(f"motion.{name}: {failure.message}" for name, failure in failures.items())
        raise ComputationError(first.outcome, message)

    if case.sensors:
        responses = {name: replace(run, readings=_readings(run, case.sensors)) for name, run in responses.items()}

    def compared(name: str, flight: str) -> Comparison:
        settings = judging(case.accept.get(name, {})) | {"sensors": case.sensors}
        return replace(compare(responses[flight], responses[name], **settings), provenance=case.provenance)

    comparisons = tuple(
        compared(name, flight)
        for name, flight in case.tracks.items()
        if {flight, name} <= responses.keys() and responses[flight].outcome == responses[name].outcome == "done"
    )
    warnings = each_once({name: run.warnings for name, run in responses.items()})
    notes = each_once({name: run.notes for name, run in responses.items()})
    return Study(
        case.title,
        dict(responses),
        comparisons,
        dict(failures),
        provenance=case.provenance,
        warnings=warnings,
        notes=notes,
    )


def _readings(response: Response, sensors: Mapping[str, Sensor]) -> Readings | None:
    """Readings of accelerometers, with their peaks, or None in a response that is not done or has no accelerations.

    Peaks are the larger ones of the times of output and of all steps, where these are recorded.
    """
    if response.outcome != "done":
        return None
    readings, peaks_of = [], []
    at_steps = response.felt_at_steps
    for point, sensor in sensors.items():
        with placing_within(f"sensors.{point}"):
            reading = response.reading_at(point, sensor)
        readings.append(reading)
        largest = vector_peaks(response.time, reading)
        if at_steps is not None:
            steps, felt = at_steps
            finer = sensor.reads(felt[:, response.point("point", point)], float(steps[1] - steps[0]))
            coarse, fine = np.asarray(largest), np.asarray(vector_peaks(steps, finer))  # values, and their times
            largest = tuple(np.where(fine[0] >= coarse[0], fine, coarse))
        peaks_of.append(largest)
    value, time = np.stack(peaks_of, axis=1)
    peaks = VectorPeaks(Extremes(value[:, :3], time[:, :3]), Extremes(value[:, 3], time[:, 3]))
    return Readings(tuple(sensors), np.stack(readings, axis=1), peaks)


def _answers(case: Case, progress: Progress) -> tuple[dict[str, Any], dict[str, Failure]]:
    """Responses by environment, and the failures of those that have no state to start from."""

    def answer(name: str) -> Response:
        """Response in one environment."""
        motion = case.environments[name]

        def report(stage: str, share: float) -> None:
            tell(progress, f"{name}: {stage}", share)

        response = simulate(case.system, motion, case.settings_of(name), name=name, progress=report)
        return replace(response, provenance=case.provenance)

    responses: dict[str, Any] = {}
    failures: dict[str, Failure] = {}
    for name in case.environments:
        try:
            responses[name] = answer(name)
        except ComputationError as error:
            failures[name] = Failure(error.outcome, str(error))
    return responses, failures


def _errors_of(answers: tuple[Mapping[str, Any], Any]) -> list[Errors]:
    """Errors of responses."""
    return [response.errors for response in answers[0].values()]
