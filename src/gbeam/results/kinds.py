"""Every kind of result by its name, and the JSON of several that stand one by one by their motions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from gbeam.results.cases import Sensitivity, Sweep
from gbeam.results.equilibrium import Critical, CriticalMap, Deflection
from gbeam.results.facts import ANY, Entry, json_of, tree_of
from gbeam.results.imitation.comparison import Comparison, MachinePlan
from gbeam.results.imitation.criteria import Judged, state_of
from gbeam.results.imitation.placement import Placement
from gbeam.results.modal import Campbell, Modes
from gbeam.results.response import Response
from gbeam.results.result import Result
from gbeam.results.searches import Fit, Optimum, ShapedCommand
from gbeam.results.solids import SolidStress, SpecimenLoads
from gbeam.results.state_space import StateSpace
from gbeam.results.study import ModelStudy, Study, SystemStudy
from gbeam.results.system import SystemModes, SystemResponse, SystemRest

KINDS: dict[str, type[Result]] = {
    kind.__name__: kind
    for kind in (
        Study,
        Response,
        Comparison,
        ModelStudy,
        Deflection,
        Modes,
        Campbell,
        Critical,
        CriticalMap,
        StateSpace,
        MachinePlan,
        Placement,
        Sweep,
        Sensitivity,
        Fit,
        Optimum,
        ShapedCommand,
        SystemStudy,
        SystemResponse,
        SystemRest,
        SystemModes,
        SolidStress,
        SpecimenLoads,
    )
}


def by_motion(answers: Sequence[Any], title: str = "") -> dict[str, Any]:
    """Return results of one kind in several motions as JSON, by the motions' names."""
    outcome = next((end for each in answers if (end := getattr(each, "outcome", "done")) != "done"), "done")
    judged = [each for each in answers if isinstance(each, Judged)]
    state = {"state": state_of(outcome, judged)} if judged else {}
    named = {getattr(each, each.listed_by): json_of(each) for each in answers}
    return {"title": title, "outcome": outcome, **state, "motions": named}


def tree_of_answers(kind: type) -> dict[str, Any]:
    """Return the tree of the JSON of a verb: of some kinds it lists one by one what each motion answers."""
    if not getattr(kind, "listed_by", ""):
        return tree_of(kind)
    return {"motions": {ANY: {"outcome": Entry("", "how it ended", types=("string",)), **tree_of(kind)}}}
