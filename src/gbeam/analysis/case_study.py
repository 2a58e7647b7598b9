"""A whole case answered: the response in every environment, and the comparisons of those that track one another."""

from __future__ import annotations

from collections.abc import Callable

from gbeam.analysis.comparison import compare
from gbeam.analysis.response import respond
from gbeam.case import Case
from gbeam.errors import ComputationError, InputError
from gbeam.model import Structure, assemble
from gbeam.results import Study


def structure_of(case: Case) -> Structure:
    """Put a case's beam into its model; an InputError names its place in the scenario."""
    try:
        return assemble(case.beam, case.model, case.stations)
    except InputError as error:
        raise error.within("response" if error.where.startswith("stations") else "beam") from None


def study(case: Case, progress: Callable[[str, float], None] | None = None) -> Study:
    """Compute the response in every environment of a case and compare each centrifuge with its flight.

    Parameters
    ----------
    case : Case
        From :func:`gbeam.build`, or made by hand.
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
        If a motion has no relative equilibrium to start from; the message names the motion.
    """
    structure = structure_of(case)
    responses = {}
    for name, motion in case.motions.items():

        def report(what: str, share: float, name: str = name) -> None:
            if progress is not None:
                progress(f"{name}: {what}", share)

        try:
            responses[name] = respond(structure, motion, case.response, name=name, progress=report)
        except ComputationError as error:
            raise ComputationError(error.outcome, f"motion.{name}: {error}") from None
    comparisons = tuple(
        compare(responses[flight], responses[name])
        for name, flight in case.tracks.items()
        if responses[flight].outcome == responses[name].outcome == "done"
    )
    return Study(case.title, responses, comparisons)
