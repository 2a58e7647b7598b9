"""Where to put the specimen: the control point, mounting and smoothing that change its response least.

About the control point C the centrifuge adds Δa(x, t) = g(t)(x − x_c) to the load of the flight (2020 (4)), and the
axis motions, so g, do not depend on where C lies in the specimen. Each measure of the response to Δa is then the size
of A(t) − x_c B(t): two histories computed once, and a convex function of x_c. Which mounting and width of smoothing
give the best such point within the machine's limits is searched for, each with axis motions of its own.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np

from gbeam.analysis.imitation.comparison import CUTOFF, compare
from gbeam.analysis.imitation.place_measures import Answers, Histories
from gbeam.analysis.response.settings import ResponseSettings
from gbeam.analysis.response.simulation import simulate
from gbeam.arrays.namespace import namespace
from gbeam.arrays.tree import record
from gbeam.errors import ComputationError, InputError
from gbeam.mechanics.structure import Structure
from gbeam.motion import Base, Centrifuge, Flight
from gbeam.motion.centrifuge.machine.limits import exceeded
from gbeam.numerics.filters.low_pass import low_pass
from gbeam.numerics.solvers.bounded_search import refine
from gbeam.results.placement import MEASURES, Candidate, Placement, Verification

EXCEEDED = "limits exceeded"  # an outcome


@dataclass(frozen=True)
class Choice:
    """What may be chosen beside the control point.

    Parameters
    ----------
    make : callable
        Of mounting and width of smoothing, s: a centrifuge that tracks the flight; InputError where it cannot.
    mountings : tuple of str
        The scenario's own first.
    widths : tuple of float
        Tried with every mounting, ascending, s.
    refined : bool
        Whether to search on between the best of them and its neighbours.
    limited : bool
        Whether the machine's limits must be kept.
    """

    make: Callable[[str, float], Centrifuge]
    mountings: tuple[str, ...]
    widths: tuple[float, ...]
    refined: bool = True
    limited: bool = True


def place(
    structure: Structure,
    flight: Flight,
    choice: Choice,
    settings: ResponseSettings,
    weights: Mapping[str, float],
    *,
    current: Centrifuge,
    names: tuple[str, str] = ("flight", "centrifuge"),
    check: bool = False,
) -> Placement:
    """Find the control point, mounting and smoothing that change a specimen's response least.

    Parameters
    ----------
    structure : Structure
    flight : Flight
    choice : Choice
        Mountings and widths of smoothing.
    settings : ResponseSettings
        Whose span is judged.
    weights : mapping of str to float
        Measures to add up, each as a fraction of its peak in flight, across the beam: ``root-shear`` and
        ``root-moment`` (quasi-static), ``vibration`` (of the first mode, at the tip), ``tip`` (quasi-static
        displacement). For each option they choose the control point by what Δa does, and then the option by that
        together with what smoothing and tracking change of the load.
    current : Centrifuge
        The scenario's own: its control point is compared with.
    names : tuple of str
        Of flight and centrifuge.
    check : bool
        Whether to check the answer, the current control point and the middle of the beam by simulation.

    Raises
    ------
    InputError
        If a measure is unknown or none has weight, or no option can be built: the first one's reason.
    ComputationError
        If every option exceeds the machine's limits (outcome ``limits exceeded``); it names the nearest.
    """
    check_weights(weights)
    trials = _Trials(structure, flight, choice, settings, weights)
    for width in reversed(choice.widths):  # the widest first, see Answers
        for mounting in choice.mountings:
            trials(mounting, width)
    if not trials.evaluated:
        raise trials.reasons[0].within(f"motion.{names[1]}")
    if choice.refined:
        leader = trials.ranked()[0].candidate.mounting
        refine(lambda width: trials(leader, width), choice.widths)
    ranked = trials.ranked()
    best = ranked[0]
    if best.candidate.exceeded and choice.limited:
        broken = "; ".join(str(use) for use in best.candidate.exceeded)
        raise ComputationError(
            EXCEEDED,
            f"motion.{names[1]}: none of {len(ranked)} options keeps the machine's limits; nearest comes "
            f"{best.candidate.mounting}, {1e3 * best.candidate.smoothing:.4g} ms: {broken}; "
            'try wider smoothing or inverse = "planned"',
        )
    length, at = structure.length, best.candidate.control_point
    places = {"best": at, "current": float(current.control_point), "middle": length / 2}
    verifications = _verifications(structure, flight, best.centrifuge, settings, places) if check else ()
    return Placement(
        flight=names[0],
        centrifuge=names[1],
        weights=dict(weights),
        length=length,
        best=best.candidate,
        options=tuple(trial.candidate for trial in ranked),
        current=places["current"],
        values={name: {m: h.size(x, False) for m, h in best.histories.items()} for name, x in places.items()},
        verifications=verifications,
        refused=tuple(trials.refused),
        widths=(choice.widths[0], choice.widths[-1]),
    )


@dataclass(frozen=True)
class _Evaluated:
    """A candidate with what it came from."""

    candidate: Candidate
    histories: dict[str, Histories]
    centrifuge: Centrifuge


class _Trials:
    """The candidates evaluated so far; calling it evaluates one more."""

    def __init__(
        self,
        structure: Structure,
        flight: Flight,
        choice: Choice,
        settings: ResponseSettings,
        weights: Mapping[str, float],
    ) -> None:
        self.answers, self.length, self.flight = Answers(structure, settings), structure.length, flight
        self.choice, self.weights = choice, weights
        self.span = settings.start, settings.start + settings.duration
        self.evaluated: dict[tuple[str, float], _Evaluated] = {}
        self.refused: list[str] = []
        self.reasons: list[InputError] = []

    def __call__(self, mounting: str, width: float) -> tuple[float, float]:
        """Weighted measure at the best control point, and the largest share of a limit."""
        if (mounting, width) not in self.evaluated:
            try:
                self.evaluated[mounting, width] = self._evaluate(mounting, width)
            except InputError as error:
                self.refused.append(f"{mounting}, {1e3 * width:.4g} ms: {error}")
                self.reasons.append(error)
                return np.inf, np.inf
        candidate = self.evaluated[mounting, width].candidate
        return candidate.total_error, candidate.share if self.choice.limited else 0.0

    def ranked(self) -> list[_Evaluated]:
        """Best first; those that break limits last, by how much."""

        def rank(trial: _Evaluated) -> tuple[float, float]:
            # Rounding must not choose between mirror images: then the scenario's own comes first.
            excess = trial.candidate.share if self.choice.limited and trial.candidate.exceeded else 0.0
            return excess, float(f"{trial.candidate.total_error:.6g}")

        return sorted(self.evaluated.values(), key=rank)

    def _evaluate(self, mounting: str, width: float) -> _Evaluated:
        import scipy.optimize

        centrifuge = self.choice.make(mounting, width).over(*self.span)
        histories, accelerations = self.answers.histories(self.flight, centrifuge)

        def size(at: float, total: bool = False) -> float:
            return sum(weight * histories[name].size(at, total) for name, weight in self.weights.items())

        least = scipy.optimize.minimize_scalar(
            size, bounds=(0, self.length), method="bounded", options={"xatol": 1e-7 * self.length}
        )
        at, uses = float(least.x), centrifuge.usage()
        share = max(use.share for use in uses)
        broken = exceeded(uses)
        return _Evaluated(
            Candidate(mounting, width, at, size(at), size(at, True), accelerations, share, broken),
            histories,
            centrifuge,
        )


def check_weights(weights: Mapping[str, float], where: str = "measure") -> None:
    """Raise InputError, naming `where` they were given, unless every measure is known and one has weight."""
    for name, weight in weights.items():
        if name not in MEASURES:
            raise InputError(where, f"names {name!r}", f"choose of {', '.join(MEASURES)}")
        if not (np.isfinite(weight) and weight >= 0):
            raise InputError(where, f"gives {name} the weight {weight:g}", "give weights of 0 or more")
    if not any(weights.values()):
        raise InputError(where, "has no weight", "give one measure a weight above 0")


@record
class _Carried:
    """A base in translation with the load that a centrifuge makes at its control point: no mismatch anywhere."""

    kind: ClassVar[str] = "flight"
    free: ClassVar[bool] = False
    centrifuge: Centrifuge

    def base(self, t: Any) -> Base:
        load = self.centrifuge.actual(t)
        none = namespace(load).zeros_like(load)
        return Base(load, none, none)

    @property
    def breaks(self) -> Any:
        return self.centrifuge.breaks

    def over(self, start: float, end: float) -> Self:
        return self

    def beyond(self, start: float, end: float) -> tuple[float, float]:
        return self.centrifuge.beyond(start, end)


def _verifications(
    structure: Structure,
    flight: Flight,
    centrifuge: Centrifuge,
    settings: ResponseSettings,
    places: Mapping[str, float],
) -> tuple[Verification, ...]:
    """The model's own response at each control point against that in flight."""
    in_flight = simulate(structure, flight, settings)
    carried = simulate(structure, _Carried(centrifuge), settings)
    step = float(in_flight.time[1] - in_flight.time[0])
    cutoff = CUTOFF * float(in_flight.frequencies[0]) / (2 * np.pi)
    verifications = []
    for name, at in places.items():
        response = simulate(structure, centrifuge.altered(control_point=at), settings)
        comparison = compare(in_flight, response)
        swing = (response.tip - carried.tip)[:, 1:]
        swing = swing - low_pass(swing, step, cutoff)
        moment = np.nan if comparison.root is None else float(comparison.root.moment_difference[1:].max())
        apart, swung = (
            float(np.linalg.norm(values[comparison.covered], axis=1).max())
            for values in (comparison.difference[:, 1:], swing)
        )
        verifications.append(Verification(name, at, apart, swung, moment))
    return tuple(verifications)
