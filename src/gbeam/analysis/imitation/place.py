"""The place of the specimen: the control point, mounting and smoothing that change its response least.

About the control point C the centrifuge adds Δa(x, t) = g(t)(x − x_c) to the load of the flight (2020 (4)), and the
axis motions, so g, do not depend on where C lies in the specimen. Each measure of the response to Δa is then the size
of A(t) − x_c B(t): two histories computed once, and a convex function of x_c. Which mounting and width of smoothing
give the best such point within the machine's limits is searched for, each with axis motions of its own.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

import numpy as np

from gbeam.analysis.imitation.accounting import largest_load, largest_pair, points_of, times_between
from gbeam.analysis.imitation.comparison import CUTOFF, compare
from gbeam.analysis.imitation.place_measures import Answers, Choice, Histories
from gbeam.analysis.response.settings import ResponseSettings
from gbeam.analysis.response.simulation import simulate
from gbeam.arrays.namespace import namespace
from gbeam.arrays.tree import record
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.mechanics.plausibility import input_warnings
from gbeam.mechanics.structure import Structure
from gbeam.motion import Base, Centrifuge, Flight
from gbeam.motion.centrifuge.kinematics import forward
from gbeam.motion.centrifuge.limits import exceeded
from gbeam.numerics.filters import low_pass
from gbeam.numerics.minimise import refine
from gbeam.numerics.samples import interpolated
from gbeam.results.imitation.criteria import BROKEN
from gbeam.results.imitation.placement import MEASURES, Candidate, Placement, Verification
from gbeam.results.response import Response
from gbeam.results.result import Floats
from gbeam.structure.beam import refuse_curved


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

    def corners(self, step: float) -> Floats:
        return self.centrifuge.corners(step)

    def over(self, start: float, end: float) -> Self:
        return self

    def beyond(self, start: float, end: float) -> tuple[float, float]:
        return self.centrifuge.beyond(start, end)


def verify(
    structure: Structure, flight: Flight, machines: Mapping[str, Centrifuge], settings: ResponseSettings
) -> tuple[Verification, ...]:
    """Simulate flight and machines, prepared for the settings' span and named by their places, and compare."""
    settings = replace(settings, estimate=False)  # a verification states none
    in_flight = simulate(structure, flight, settings)
    cutoff = CUTOFF * float(in_flight.frequencies[0]) / (2 * np.pi)
    # Machines at different control points share their axis motions, and the current one may be at the middle.
    carried: dict[int, Response] = {}
    responses: dict[tuple[int, float], Response] = {}
    verifications = []
    for name, machine in machines.items():
        motion, at = id(machine.course), float(machine.control_point)
        if (motion, at) not in responses:
            responses[motion, at] = simulate(structure, machine, settings)
        if motion not in carried:
            carried[motion] = simulate(structure, _Carried(machine), settings)
        response = responses[motion, at]
        comparison = compare(in_flight, response)
        # Whose automatic step may differ.
        carried_tip = interpolated(response.time, carried[motion].time, carried[motion].tip)
        swing = response.tip - carried_tip
        swing -= low_pass(swing, float(response.time[1] - response.time[0]), cutoff)
        compared = np.isin(response.time, comparison.time[comparison.covered])
        force, moment = np.nan, np.nan
        if comparison.root is not None:
            root = comparison.root
            force, moment = (float(each[1:].max()) for each in (root.force_difference, root.moment_difference))
        verifications.append(
            Verification(
                name,
                at,
                _largest(comparison.difference[comparison.covered]),
                _largest(swing[compared]),
                moment,
                force,
            )
        )
    return tuple(verifications)


def _largest(vectors: Floats) -> float:
    """Largest of the parts across the beam."""
    return float(np.linalg.norm(vectors[:, 1:], axis=1).max(initial=0.0))


_WORTH = 0.02  # of the total error: what another mounting must save at least


@typed
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
        The scenario's own, which the answer is compared with.
    names : tuple of str
        Of flight and centrifuge.
    check : bool
        Whether to check the answer, the current placement and the middle of the beam by simulation.

    Returns
    -------
    Placement
        Its outcome is ``limits exceeded`` where every option exceeds the machine's limits; the best is then the
        nearest, and nothing is simulated.

    Raises
    ------
    InputError
        If the beam has no damping ratio where vibration is judged, a measure is unknown or none has weight, or no
        option can be built: the first one's reason.

    Examples
    --------
    >>> case = gb.read_scenario("examples/f16_8g_turn.toml")
    >>> flight, machine = case.motions["flight"], case.motions["centrifuge"]
    >>> choice = gb.choice_of(machine)
    >>> placement = gb.place(case.assemble(), flight, choice, case.response, {"tip": 1.0}, current=machine)
    >>> print(f"{1e3 * placement.best.control_point:.0f} mm from the root")
    220 mm from the root
    """
    check_weights(weights)
    if check or "vibration" in weights:
        structure.require_damping("the vibration")
    trials = _Trials(structure, flight, choice, settings, weights)
    for width in reversed(choice.widths):  # the widest first, see Answers
        for mounting in choice.mountings:
            trials(mounting, width)
    if not trials.evaluated:
        raise trials.reasons[0].within(f"motion.{names[1]}")
    if choice.refined:
        leader = trials.ranked()[0].candidate.mounting
        refine(lambda width: trials(leader, width), choice.widths)
    ranked, before = trials.ranked(), trials.assess(current, at=float(current.control_point))
    best, middle = ranked[0], structure.length / 2
    allowed = not (best.candidate.exceeded and choice.limited)
    places = {"best": (best, best.candidate.control_point), "current": (before, before.candidate.control_point)}
    places["middle"] = best, middle
    machines = {name: each.centrifuge.altered(control_point=at) for name, (each, at) in places.items()}
    values, totals = (
        {name: {m: h.size(at, total) for m, h in each.histories.items()} for name, (each, at) in places.items()}
        for total in (False, True)
    )
    return Placement(
        flight=names[0],
        centrifuge=names[1],
        weights=dict(weights),
        length=structure.length,
        best=best.candidate,
        options=tuple(trial.candidate for trial in ranked),
        current=before.candidate.control_point,
        values=values,
        totals=totals,
        before=before.candidate,
        verifications=verify(structure, flight, machines, settings) if check and allowed else (),
        refused=tuple(trials.refused),
        widths=(choice.widths[0], choice.widths[-1]),
        outcome="done" if allowed else BROKEN,
        warnings=input_warnings(structure, flight, name=names[0], span=trials.span),
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
        self.answers, self.length, self.flight = Answers(structure, flight, settings), structure.length, flight
        self.choice, self.weights = choice, weights
        self.span = settings.start, settings.start + settings.duration
        if structure.recovery is not None:
            fix = "vary motion.NAME.control_point, and origin and turn of the body, by `gbeam sweep`"
            raise InputError("bodies", "is no beam, of which alone a place along x is searched", fix)
        refuse_curved(None if structure.source is None else structure.source.beam, "place")
        bodies = np.empty((0, 3)) if structure.source is None else structure.source.beam.body_centres
        self.points = points_of(structure.length, bodies)
        times = times_between(*self.span)
        self.in_flight = largest_load(times, flight.base(times), self.points)
        self.evaluated: dict[tuple[str, float], _Evaluated] = {}
        self.refused: list[str] = []
        self.reasons: list[InputError] = []

    def __call__(self, mounting: str, width: float) -> tuple[float, float]:
        """Weighted measure at the best control point, and the largest share of a limit."""
        if (mounting, width) not in self.evaluated:
            try:
                self.evaluated[mounting, width] = self.assess(self.choice.make(mounting, width))
            except InputError as error:
                self.refused.append(f"{mounting}, {1e3 * width:.4g} ms: {error}")
                self.reasons.append(error)
                return np.inf, np.inf
        candidate = self.evaluated[mounting, width].candidate
        return candidate.total_error, candidate.share if self.choice.limited else 0.0

    def ranked(self) -> list[_Evaluated]:
        """Best first; those that break limits last, by how much."""

        def rank(trial: _Evaluated) -> tuple[float, float]:
            candidate = trial.candidate
            excess = candidate.share if self.choice.limited and candidate.exceeded else 0.0
            # Mirror images differ by rounding, and by what a search leaves: then the scenario's own comes first.
            as_mounted = candidate.mounting == self.choice.mountings[0]
            return excess, candidate.total_error * (1.0 if as_mounted else 1 + _WORTH)

        return sorted(self.evaluated.values(), key=rank)

    def assess(self, centrifuge: Centrifuge, *, at: float | None = None) -> _Evaluated:
        """Evaluate a centrifuge with its best control point, or with one that is given, m."""
        import scipy.optimize

        machine = centrifuge.over(*self.span)
        histories, accelerations = self.answers.histories(self.flight, machine)

        def size(x: float, total: bool = False) -> float:
            return sum(weight * histories[name].size(x, total) for name, weight in self.weights.items())

        if at is None:
            at = float(
                scipy.optimize.minimize_scalar(
                    size, bounds=(0, self.length), method="bounded", options={"xatol": 1e-7 * self.length}
                ).x
            )
        uses = machine.usage()
        times = times_between(*(float(end) for end in machine.extent))
        at_c = forward(machine.axes(times), machine.geometry.arm, machine.geometry.gravity)
        most = max(uses, key=lambda use: use.share)
        return _Evaluated(
            Candidate(
                machine.mounting, float(machine.smoothing or 0.0), at, size(at), size(at, True), accelerations,
                most.share, exceeded(uses), most_used=most,
                tracking=sum(w * histories[name].error for name, w in self.weights.items()),
                largest_load=largest_pair(self.in_flight, largest_load(times, at_c, self.points, at)),
            ),
            histories,
            machine,
        )  # fmt: skip


def check_weights(weights: Mapping[str, float], where: str = "measure") -> None:
    """Raise InputError, naming `where` they were given, unless every measure is known and one has weight."""
    for name, weight in weights.items():
        if name not in MEASURES:
            raise InputError(where, f"names {name!r}", f"choose of {', '.join(MEASURES)}")
        if not (np.isfinite(weight) and weight >= 0):
            raise InputError(where, f"gives {name} the weight {weight:g}", "give weights of 0 or more")
    if not any(weights.values()):
        raise InputError(where, "has no weight", "give one measure a weight above 0")
