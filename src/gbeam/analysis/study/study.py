"""A whole case answered: the response in every environment, and the comparisons of those that track one another."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

from gbeam.analysis.imitation.comparison import compare
from gbeam.analysis.response.simulation import simulate
from gbeam.analysis.study.case import Case
from gbeam.errors import ComputationError
from gbeam.results.imitation.accounting import TOLERANCE
from gbeam.results.imitation.comparison import Comparison
from gbeam.results.response import Response
from gbeam.results.study import Failure, Study


def study(case: Case, progress: Callable[[str, float], None] | None = None) -> Study:
    """Compute the response in every environment of a case and compare each centrifuge with its flight.

    Parameters
    ----------
    case : Case
        From :func:`gbeam.read_scenario`, or made by hand.
    progress : callable, optional
        Called with what is being done and the fraction of it done.

    Returns
    -------
    Study

    Raises
    ------
    InputError
        With its place in the scenario.
    ComputationError
        If no motion has a relative equilibrium to start from; the message names each.
    """
    structure = case.assemble()

    def answer(name: str) -> Response:
        motion = case.motions[name]

        def report(what: str, share: float) -> None:
            if progress is not None:
                progress(f"{name}: {what}", share)

        response = simulate(structure, motion, case.response, name=name, progress=report)
        return replace(response, provenance=case.provenance)

    responses: dict[str, Response] = {}
    failures: dict[str, Failure] = {}
    for name in case.motions:
        try:
            responses[name] = answer(name)
        except ComputationError as error:
            failures[name] = Failure(error.outcome, str(error))
    if not responses:
        first = next(iter(failures.values()))
        raise ComputationError(
            first.outcome, "; ".join(f"motion.{n}: {failure.message}" for n, failure in failures.items())
        )
    comparisons = tuple(
        replace(_compared(responses[flight], responses[name], case.accept.get(name, {})), provenance=case.provenance)
        for name, flight in case.tracks.items()
        if {flight, name} <= responses.keys() and responses[flight].outcome == responses[name].outcome == "done"
    )
    return Study(case.title, responses, comparisons, failures, provenance=case.provenance)


def _compared(flight: Response, centrifuge: Response, accept: Mapping[str, float]) -> Comparison:
    limits = dict(accept)
    return compare(flight, centrifuge, tolerance=limits.pop("tolerance", TOLERANCE), accept=limits)
