"""Answers in all environments of a scenario, by several models, and computed again; every kind of result by name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isnan
from math import nan as NAN
from typing import Any, Literal

from gbeam.results.cases import Sensitivity, Sweep
from gbeam.results.comparison import Comparison, MachinePlan
from gbeam.results.criteria import NOT_ACCEPTED, NOT_DECIDED, Judged, state_of
from gbeam.results.declared import declared, fact, internal, quantity, rows
from gbeam.results.equilibrium import Critical, CriticalMap, EquilibriumPath, Rest
from gbeam.results.facts import ANY, Entry, json_of, tree_of
from gbeam.results.modal import Campbell, Modes
from gbeam.results.placement import Placement
from gbeam.results.response import Response
from gbeam.results.result import Figured, Floats, Part, Result
from gbeam.results.searches import Fit, Optimum, ShapedCommand
from gbeam.results.solids import SolidStress, SpecimenLoads
from gbeam.results.state_space import StateSpace


@dataclass(frozen=True)
class Failure:
    """Reason for no whole response in an environment: the outcome, such as diverged, and what happened."""

    outcome: str = fact("the outcome, such as diverged")
    message: str = fact("what happened")


@dataclass(frozen=True, repr=False, eq=False)
class Study(Figured[str]):
    """The responses in all environments of a scenario, and their comparisons.

    Examples
    --------
    >>> study = gb.study(gb.read_scenario("examples/zhang2020_example1.toml"))
    >>> study.outcome, list(study.responses)
    ('done', ['flight', 'centrifuge'])
    """

    title: str = fact("title of the scenario")
    responses: Mapping[str, Response] = rows(
        "responses by the name of the base's motion", "motion", key="motions", note="ground where it rests"
    )
    comparisons: tuple[Comparison, ...] = rows("comparisons of centrifuges with flight", "comparison", default=())
    failures: Mapping[str, Failure] = rows(
        "where a response has no state to start from", "motion", key="motions", default_factory=dict
    )

    @property
    def _specimens(self) -> list[tuple[str, str, SpecimenLoads]]:
        """Names of motions and bodies, the latter empty where there is one alone, with the loads of rigid specimens."""
        specimens = []
        for name, response in self.responses.items():
            several = len(response.bodies) > 1
            for body_name, body in response.bodies.items():
                if body.specimen is not None:
                    specimens.append((name, body_name if several else "", body.specimen))
        return specimens

    @property
    def exceeding(self) -> Mapping[str, str]:
        """Limits of machines that are exceeded, by the motion's name."""
        machines = {name: response.axes for name, response in self.responses.items() if response.axes is not None}
        return {name: axes.exceeding for name, axes in machines.items() if axes.exceeding}

    @property
    def not_accepted(self) -> Mapping[str, str]:
        """Limits of acceptance that are not kept, of imitations and of rigid specimens, by the motion's name."""
        reasons = dict[str, str]()
        for name, body, specimen in self._specimens:
            refusal = f"{body}: {specimen.refusal}" if body and specimen.refusal else specimen.refusal
            reasons[name] = ", ".join(filter(None, (reasons.get(name, ""), refusal)))
        for comparison in self.comparisons:
            name = comparison.centrifuge
            refusal = comparison.refusal if comparison.decision == NOT_ACCEPTED else ""
            reasons[name] = ", ".join(filter(None, (refusal, reasons.get(name, ""))))
        return {name: reason for name, reason in reasons.items() if reason}

    @property
    def not_decided(self) -> Mapping[str, str]:
        """Limits of acceptance whose values are not known, by the motion's name."""
        undecided = (comparison for comparison in self.comparisons if comparison.decision == NOT_DECIDED)
        return {comparison.centrifuge: comparison.refusal for comparison in undecided}

    @property
    def refusals(self) -> Mapping[str, str]:
        """Limits of acceptance that are not kept and limits of machines that are exceeded, by the motion's name."""
        return self.not_accepted or self.not_decided or self.exceeding

    @declared("", "the outcome, with what limits make of it", role="fact")
    def state(self) -> str:
        axes = [response.axes for response in self.responses.values() if response.axes is not None]
        exceeded = any(not machine.within_limits for machine in axes)
        verdicts = [loads.within_limit for *_, loads in self._specimens]
        return state_of(self.outcome, self.comparisons, exceeded=exceeded, verdicts=verdicts)

    def __repr__(self) -> str:
        parts = [repr(response) for response in self.responses.values()]
        parts += [f"{name}: {failure.outcome}\n  {failure.message}" for name, failure in self.failures.items()]
        parts += [repr(comparison) for comparison in self.comparisons]
        title = f" {self.title!r}" if self.title else ""
        return "\n".join([f"{type(self).__name__}{title}: {self.state}", *parts])

    @property
    def unfinished(self) -> Mapping[str, Failure]:
        """Failures of the environments that are not done, by name."""
        ended_early = {name: Failure(r.outcome, r.message) for name, r in self.responses.items() if r.outcome != "done"}
        return {**ended_early, **self.failures}

    @property
    def outcome(self) -> str:
        """``done`` where every response is, else the first other outcome."""
        return next((failure.outcome for failure in self.unfinished.values()), "done")


@dataclass(frozen=True, repr=False, eq=False)
class ModelRow(Part):
    """One model's answer to a scenario, beside the reference's."""

    model: str = quantity("", "kind of the model")
    motion: str = quantity("", "name of the motion")
    outcome: str = quantity(
        "", "how it ended", note="done, diverged, not converged, or cannot: the model is not made for this"
    )
    message: str = quantity("", "why it is not done", note="what follows is then NaN")
    warnings: tuple[str, ...] = quantity("", "why the row may not be what it seems", name=None)
    peak: float = quantity(
        "m", "peak of the tip's displacement", note="in the direction in which the reference moves most", default=NAN
    )
    time_of_peak: float = quantity("s", "time of the peak", default=NAN)
    peak_error: float = quantity("", "peak over the reference's, less one", default=NAN)
    residual: float = quantity(
        "m",
        "amplitude of the vibration left",
        note="NaN where the scenario has no time from which it is measured",
        default=NAN,
    )
    residual_error: float = quantity("", "the same over the reference's, less one", default=NAN)
    phase: float = quantity(
        "rad",
        "phase of the vibration left, ahead of the reference's",
        note="at the reference's dominant frequency",
        default=NAN,
    )
    difference: float = quantity("", "largest distance of the histories over the reference's peak", default=NAN)
    hub_angle: float = quantity("rad", "angle of a free hub at the end", default=NAN)
    error_estimate: float = quantity("", "total estimated error over the largest displacement", default=NAN)
    steps: int = quantity("", "number of steps", default=0)
    seconds: float = quantity("s", "time to compute it", default=NAN)
    time: Floats = internal("s", "times of the history", "time", empty=True)
    history: Floats = internal(
        "m",
        "displacement of the tip in the direction compared",
        "time",
        note="empty where there is no answer",
        empty=True,
    )

    @declared("", "warnings", name="warnings", key=None)
    def doubts(self) -> str:
        return "\n".join(self.warnings)

    def __str__(self) -> str:
        if self.outcome != "done":
            return f"{self.model} on {self.motion}: {self.outcome}; {self.message}"
        error = "" if isnan(self.difference) else f", differs by up to {self.difference:.2g} of the peak"
        return f"{self.model} on {self.motion}: peak {1e3 * self.peak:.4g} mm at {self.time_of_peak:.4g} s{error}"


@dataclass(frozen=True, repr=False, eq=False)
class ModelStudy(Figured[Literal["models"]]):
    """A scenario by every model; rows by motion, then model."""

    title: str = fact("title of the scenario")
    reference: str = fact("model that the others are compared with")
    direction: dict[str, str] = fact("direction compared, by motion", name=None)
    rows: tuple[ModelRow, ...] = rows("a row for each motion and model", "row")

    @declared("", "direction compared", "row", name="direction", key=None)
    def directions(self) -> tuple[str, ...]:
        return tuple(self.direction[row.motion] for row in self.rows)

    @declared("", "how it ended", role="fact", name=None)
    def outcome(self) -> str:
        """``done``, or ``not compared`` where the reference has no answer in some environment."""
        return "done" if self.compared else "not compared"

    @property
    def compared(self) -> bool:
        """True if there is a reference in every environment."""
        return all(row.outcome == "done" for row in self.rows if row.model == self.reference)

    def __repr__(self) -> str:
        title = f" {self.title!r}" if self.title else ""
        return "\n  ".join([f"ModelStudy{title}, against {self.reference}", *(str(row) for row in self.rows)])


SAME, ELSEWHERE = 0.0, 1e-9  # differences allowed in the same environment, and in another


@dataclass(frozen=True)
class Difference:
    """A variable or an attribute that came out otherwise."""

    name: str = fact("path in the file")
    size: float = fact("largest difference over the largest value; infinite where the two cannot be compared")
    what: str = fact("the difference in words")

    def __str__(self) -> str:
        return f"{self.name}: {self.what}"


@dataclass(frozen=True, repr=False, eq=False)
class Reproduction(Part):
    """A result computed again from what its file says, and compared with it."""

    file: str = fact("the file")
    compared: int = fact("number of variables and attributes compared")
    differences: tuple[Difference, ...] = rows("differences, the largest first", "difference")
    rounded: int = fact(
        "number of those that differ by rounding alone, beside the largest value of their unit, in the numbers of "
        "sentences, or in which of equal peaks is the first"
    )
    changed: Mapping[str, tuple[str, str]] = fact(
        "what of gbeam, Python, the platform and the dependencies is otherwise: then, and now"
    )

    @property
    def tolerance(self) -> float:
        """Largest difference allowed: none in the same environment, 1e-9 in another."""
        return ELSEWHERE if self.changed else SAME

    @property
    def reproduced(self) -> bool:
        """True if no difference is larger than the tolerance."""
        return not self.excess_count

    @property
    def excess_count(self) -> int:
        """Number of differences that are larger than the tolerance."""
        return sum(difference.size > self.tolerance for difference in self.differences)

    @property
    def agreement(self) -> str:
        """``to the last digit``; ``within rounding``, with other versions or elsewhere; or ``NOT reproduced``."""
        if not self.reproduced:
            return "NOT reproduced"
        return "within rounding" if self.differences or self.rounded else "to the last digit"

    def __repr__(self) -> str:
        lines = [f"Reproduction of {self.file}: {self.agreement}, {self.compared} values and arrays compared"]
        lines += [str(difference) for difference in self.differences[:10]]
        lines += self.circumstances()
        return "\n  ".join(lines)

    def circumstances(self) -> list[str]:
        """Lines on what has changed since the file was written."""
        return [f"{name} was {old_value}, is {new_value}" for name, (old_value, new_value) in self.changed.items()]


# Every kind of result by its name.
KINDS: dict[str, type[Result]] = {
    kind.__name__: kind
    for kind in (
        Study,
        Response,
        Comparison,
        ModelStudy,
        Rest,
        Modes,
        Campbell,
        Critical,
        CriticalMap,
        EquilibriumPath,
        StateSpace,
        MachinePlan,
        Placement,
        Sweep,
        Sensitivity,
        Fit,
        Optimum,
        ShapedCommand,
        SolidStress,
        SpecimenLoads,
    )
}


def by_motion(answers: Sequence[Any], title: str = "") -> dict[str, Any]:
    """Return results of one kind in several motions as JSON, by the motions' names."""
    outcomes = (getattr(answer, "outcome", "done") for answer in answers)
    outcome = next((outcome for outcome in outcomes if outcome != "done"), "done")
    judged = [answer for answer in answers if isinstance(answer, Judged)]
    state = {"state": state_of(outcome, judged)} if judged else {}
    motions = {getattr(answer, answer.listed_by): json_of(answer) for answer in answers}
    return {"title": title, "outcome": outcome, **state, "motions": motions}


def tree_of_answers(kind: type) -> dict[str, Any]:
    """Return the tree of the JSON of a verb that answers with a kind: by motion where JSON lists that kind so."""
    if not getattr(kind, "listed_by", ""):
        return tree_of(kind)
    return {"motions": {ANY: {"outcome": Entry("", "how it ended", types=("string",)), **tree_of(kind)}}}
