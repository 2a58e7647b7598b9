"""The place of the specimen: the control point, mounting and smoothing that change its response least.

About the control point C the centrifuge adds Δa(x, t) = g(t)(x − x_c) to the load of the flight (2020 (4)), and the
axis motions, so g, do not depend on where C lies in the specimen. Each measure of the response to Δa is then the size
of A(t) − x_c B(t): two histories computed once, and a convex function of x_c. Mountings and widths of smoothing, each
with axis motions of its own, are tried in turn for the best such point within the machine's limits.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

import numpy as np

from gbeam.analysis.imitation.accounting import largest_load, largest_pair
from gbeam.analysis.imitation.comparison import CUTOFF, compare
from gbeam.analysis.imitation.place_measures import Answers, Choice, Histories, Turn, Ways, turn_to_axis
from gbeam.analysis.imitation.quantities import Quantities
from gbeam.analysis.response.settings import ResponseSettings
from gbeam.analysis.response.simulation import simulate
from gbeam.analysis.steady.subject import subject_of
from gbeam.arrays.namespace import namespace
from gbeam.arrays.tree import record
from gbeam.arrays.types import Floats
from gbeam.constants import Measure
from gbeam.errors import ComputationError, InputError
from gbeam.guards.arguments import typed
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.system import System
from gbeam.motion.centrifuge.centrifuge import Centrifuge
from gbeam.motion.centrifuge.histories import times_between
from gbeam.motion.centrifuge.limits import exceeded
from gbeam.motion.flight import Flight
from gbeam.numerics.minimise import minimise_convex, refine
from gbeam.numerics.samples import interpolated, low_pass
from gbeam.printable import advise
from gbeam.progress import Progress, tell
from gbeam.results.criteria import BROKEN
from gbeam.results.parts import Base
from gbeam.results.placement import MEASURES, Candidate, Placement, Verification, degrees
from gbeam.results.response import Response


@record
class _Carried:
    """A base that translates with the load of a centrifuge at its control point, so that no point's load differs."""

    kind: ClassVar[str] = "flight"
    free: ClassVar[bool] = False
    centrifuge: Centrifuge

    def base(self, t: Any) -> Base:
        load = self.centrifuge.actual(t)
        zeros = namespace(load).zeros_like(load)
        return Base(load, zeros, zeros)

    def corners(self, step: float) -> Floats:
        return self.centrifuge.corners(step)

    def over(self, start: float, end: float) -> Self:
        return self

    def beyond(self, start: float, end: float) -> tuple[float, float]:
        return self.centrifuge.beyond(start, end)


def verify(
    system: System,
    flight: Flight,
    machines: Mapping[str, Centrifuge],
    settings: ResponseSettings,
    answers: Answers,
    progress: Progress = None,
) -> tuple[Verification, ...]:
    """Simulate the flight and machines, by the names of their control points, and compare each with the flight."""
    settings = replace(settings, estimate=False)  # a verification states no errors
    mode, axes = answers.mode, slice(1 if answers.specimen.straight else 0, 3)

    def simulated(motion: Any, words: str) -> Response:
        """Response to a motion; ComputationError if it is not done."""

        def report(doing: str, share: float) -> None:
            tell(progress, f"checking {words}: {doing}", share)

        response = simulate(system, motion, settings, progress=report)
        if response.outcome != "done":
            raise ComputationError(response.outcome, f"a run that verifies the places is no answer: {response.message}")
        return response

    in_flight = simulated(flight, "flight")
    tip = Quantities.from_response("flight", in_flight).index("point", answers.tip)
    # Machines at different control points share their axis motions, and the current one may be at the middle.
    carried: dict[int, Response] = {}  # by axis motions
    responses: dict[tuple[int, bytes], Response] = {}  # by axis motions and control point
    verifications = []
    for name, machine in machines.items():
        place = np.asarray(machine.place)
        motion, key = id(machine.course), place.tobytes()
        if (motion, key) not in responses:
            responses[motion, key] = simulated(machine, name)
        response = responses[motion, key]
        of_tip = Quantities.from_response(name, response).displacement[:, tip]
        comparison = compare(in_flight, response, point=answers.tip or None)
        compared = np.isin(response.time, comparison.time[comparison.covered])
        vibration, moved = np.nan, np.nan
        step = float(response.time[1] - response.time[0])
        cutoff = CUTOFF * float(mode.frequency) / (2 * np.pi) if mode is not None else 0.0
        if cutoff * step * (len(response.time) - 1) > 1:  # time enough to part trend from vibration
            if motion not in carried:
                carried[motion] = simulated(_Carried(machine), f"{name}, carried")
            # Interpolated, since automatic steps may differ.
            free = Quantities.from_response(name, carried[motion]).displacement[:, tip]
            swing = of_tip - interpolated(response.time, carried[motion].time, free)
            swing -= low_pass(swing, step, cutoff)
            difference = comparison.difference[comparison.covered]
            vibration = float(np.linalg.norm(swing[compared][:, axes], axis=1).max(initial=0.0))
            moved = float(np.linalg.norm(difference[:, axes], axis=1).max(initial=0.0))
        force, moment = np.nan, np.nan
        if comparison.root is not None:
            force = float(comparison.root.force_difference[axes].max())
            moment = float(comparison.root.moment_difference[axes].max())
        verifications.append(Verification(name, float(place[0]), moved, vibration, moment, force))
    return tuple(verifications)


_WORTH = 0.02  # of the total error, which another mounting must save at least to be preferred
TILT, NEAR, TILTS = 0.35, 0.01, 40  # first and last change of a turn in a search, rad; evaluations at most


@typed
def place(
    structure: Structure | System,
    flight: Flight,
    choice: Choice,
    settings: ResponseSettings,
    weights: Mapping[Measure, float],
    *,
    current: Centrifuge,
    names: tuple[str, str] = ("flight", "centrifuge"),
    check: bool = False,
    along: str = "",
    progress: Progress = None,
) -> Placement:
    """Find the control point, mounting and smoothing that change a specimen's response least.

    Parameters
    ----------
    structure : Structure or System
    flight : Flight
    choice : Choice
        Mountings and widths of smoothing.
    settings : ResponseSettings
        Whose span is judged.
    weights : mapping of str to float
        Measures to add up, each as a fraction of its peak in flight, across the beam: ``root-shear`` and
        ``root-moment`` (quasi-static), ``vibration`` (at the tip, of the mode by which the flight displaces it most),
        ``tip`` (quasi-static displacement), ``load`` (at the ends of the beam, or wherever else the specimen's is
        largest). Shear and moment are the whole force and moment of a specimen that is no straight beam; the tip of a
        system is the point that the flight displaces most. For each option they choose the control point by what Δa
        does, and then the option by that together with what smoothing and tracking change of the load.
    current : Centrifuge
        The scenario's own, which the answer is compared with.
    names : tuple of str
        Of flight and centrifuge.
    check : bool
        Whether to check the answer, the current placement and the middle of the specimen by simulation.
    along : str
        Directions in which the control point may be moved within the specimen, such as ``"xz"``; by default x in a
        straight beam, and all three in another specimen.
    progress : callable or bool, optional
        Called with what is being done and the fraction of it done; True shows a bar.

    Returns
    -------
    Placement
        Its outcome is ``limits exceeded`` where every option exceeds the machine's limits; the best is then the
        nearest, and nothing is simulated.

    Raises
    ------
    InputError
        If the beam has no damping ratio where vibration is judged, supports hold its tip, a measure is unknown, the
        flight makes none of it or none has weight, something of a system moves at rest or is held by nothing, or no
        option can be built: the first one's reason.

    Examples
    --------
    >>> case = gb.read_scenario("examples/f16_8g_turn.toml")
    >>> flight, machine = case.motions["flight"], case.motions["centrifuge"]
    >>> choice = gb.choice_of(machine)
    >>> placement = gb.place(case.subject, flight, choice, case.response, {"tip": 1.0}, current=machine)
    >>> print(f"{1e3 * placement.best.control_point:.0f} mm from the root")
    220 mm from the root
    """
    check_weights(weights)
    subject = subject_of(structure, None)
    system = subject.system
    for body in system.flexible.values():
        body.require_free_tip("a place")
    if check or "vibration" in weights:
        structure.require_damping("the vibration")
    trials = _Trials(system, flight, choice, settings, weights, along, np.asarray(current.place), progress)
    for width in reversed(choice.widths):  # the widest first, see Answers
        for turn in choice.turns or (None,):
            for mounting in choice.mountings:
                trials(mounting, width, turn)
    if not trials.evaluated:
        raise trials.reasons[0].within(f"motion.{names[1]}")
    if choice.refined:
        first = trials.ranked()[0]
        refine(lambda width: trials(first.candidate.mounting, width, first.turn), tuple(choice.widths))
    if choice.between:
        trials.search_turn()
    ranked, present = trials.ranked(), trials.assess(current, at=np.array(current.place))
    best_trial, specimen = ranked[0], trials.answers.specimen
    middle = np.where(trials.moved, specimen.extent.mean(axis=0), current.place)
    allowed = not (best_trial.candidate.exceeded and choice.limited)
    places = {"best": (best_trial, np.array(best_trial.candidate.place)), "current": (present, np.array(current.place))}
    places["middle"] = best_trial, middle
    machines = {name: trial.centrifuge.altered(control_point=_written(at)) for name, (trial, at) in places.items()}

    def sizes(total: bool) -> dict[str, dict[str, float]]:
        """Sizes of all measures, by the places' names; in `total` with the error of the load."""
        return {
            name: {measure: history.size(at, total) for measure, history in trial.histories.items()}
            for name, (trial, at) in places.items()
        }

    return Placement(
        flight=names[0],
        centrifuge=names[1],
        weights=dict(weights),
        length=float(np.ptp(specimen.extent, axis=0).max()),
        best=best_trial.candidate,
        options=tuple(trial.candidate for trial in ranked),
        current=present.candidate.control_point,
        values=sizes(False),
        totals=sizes(True),
        before=present.candidate,
        verifications=verify(system, flight, machines, settings, trials.answers, progress) if check and allowed else (),
        refused=tuple(trials.refused),
        widths=(choice.widths[0], choice.widths[-1]),
        outcome="done" if allowed else BROKEN,
        warnings=replace(subject, motion=flight).doubts(names[0], span=trials.span)
        + tuple(f"friction of {name} is left out: its joint moves freely" for name in system.rubbing),
        point=trials.answers.tip if len(system.bodies) > 1 else "",
        straight=specimen.straight,
    )


def default_weights(system: System) -> dict[Measure, float]:
    """Weights by default: the tip's displacement or, if nothing can be displaced, the load."""
    return {"tip" if len(system.tree.unknowns) else "load": 1.0}


def default_turns(system: System) -> Ways:
    """Ways round by default: a beam's own, with its mountings, and right angles for other specimens."""
    beams = [body for body in system.flexible.values() if body.source is not None]
    return "own" if beams and len(system.bodies) == 1 else "right-angles"


def _written(position: Floats) -> Any:
    """A place (3,) m as a centrifuge takes it: one number if it lies on the positive x axis."""
    return position if np.any(position[1:]) or position[0] < 0 else float(position[0])


@dataclass(frozen=True)
class _Evaluated:
    """A candidate with the measures' histories, the centrifuge and the turn that it was evaluated by."""

    candidate: Candidate
    histories: dict[str, Histories]
    centrifuge: Centrifuge
    turn: Turn | None


class _Trials:
    """The candidates evaluated so far. A call evaluates one more."""

    def __init__(
        self,
        system: System,
        flight: Flight,
        choice: Choice,
        settings: ResponseSettings,
        weights: Mapping[Measure, float],
        along: str,
        start: Floats,
        progress: Progress,
    ) -> None:
        """Read the flight, and check the measures and the directions in which the control point may be moved."""
        self.progress = progress
        tell(progress, "flight", 0.0)
        self.answers, self.flight = Answers(system, flight, settings), flight
        self.answers.refuse_unfelt(weights)
        self.choice, self.weights = choice, weights
        self.span = settings.start, settings.start + settings.duration
        self.points = dict(self.answers.specimen.ends)
        times = times_between(*self.span)
        self.in_flight = largest_load(times, flight.base(times), self.points)
        along = along or ("x" if self.answers.specimen.straight else "xyz")
        if not along or set(along) - set("xyz"):
            raise InputError("along", f"is {along!r}", "give some of x, y and z")
        self.moved = np.array([axis in along for axis in "xyz"])
        self.start = start
        self.evaluated: dict[tuple[str, float, Turn | None], _Evaluated] = {}
        self.refused: list[str] = []
        self.reasons: list[InputError] = []

    def __call__(self, mounting: str, width: float, turn: Turn | None = None) -> tuple[float, float]:
        """Evaluate a candidate, unless it has been.

        Returns its total error at the best control point and the largest share of a limit, 0 if limits do not count.
        Both are infinite if the machine cannot be made.
        """
        key, options = (mounting, width, turn), (mounting, width) if turn is None else (mounting, width, turn)
        if key not in self.evaluated:
            tell(self.progress, f"placement {len(self.evaluated) + len(self.refused) + 1}", 0.0)
            try:
                self.evaluated[key] = self.assess(self.choice.make(*options), turn=turn)
            except InputError as error:
                way = "" if turn is None else f", turned by {degrees(turn)}"
                self.refused.append(f"{mounting}, {1e3 * width:.4g} ms{way}: {error}")
                self.reasons.append(error)
                return np.inf, np.inf
        candidate = self.evaluated[key].candidate
        return candidate.total_error, candidate.share if self.choice.limited else 0.0

    def search_turn(self) -> None:
        """Search for the turn with the least error, starting from the best candidate."""
        import scipy.optimize
        from scipy.spatial.transform import Rotation

        best_trial = self.ranked()[0]
        begun = Rotation.from_rotvec(best_trial.centrifuge.turn)

        def error(tilt: Floats) -> float:
            # About two axes of the module: a roll about axis 3 changes nothing.
            direction = (Rotation.from_rotvec([0.0, *tilt]) * begun).as_matrix()[0]
            value, share = self(best_trial.candidate.mounting, best_trial.candidate.smoothing, turn_to_axis(direction))
            return value if share <= 1 else np.inf

        simplex = TILT * np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
        options = {"initial_simplex": simplex, "xatol": NEAR, "fatol": 0.0, "maxfev": TILTS}
        scipy.optimize.minimize(error, np.zeros(2), method="Nelder-Mead", options=options)

    def ranked(self) -> list[_Evaluated]:
        """Candidates from the best to the worst. Those that exceed limits come last, by their excess."""

        def rank(trial: _Evaluated) -> tuple[float, float]:
            candidate = trial.candidate
            excess = candidate.share if self.choice.limited and candidate.exceeded else 0.0
            # Mirror images differ by rounding and by the search's tolerance: the scenario's own is preferred.
            own_turn = self.choice.turns[0] if self.choice.turns else None
            as_mounted = candidate.mounting == self.choice.mountings[0] and trial.turn == own_turn
            return excess, candidate.total_error * (1.0 if as_mounted else 1 + _WORTH)

        return sorted(self.evaluated.values(), key=rank)

    def assess(self, centrifuge: Centrifuge, *, at: Floats | None = None, turn: Turn | None = None) -> _Evaluated:
        """Evaluate a centrifuge with its best control point, or with one `at` a place (3,) m."""
        machine = centrifuge.over(*self.span)
        histories, accelerations = self.answers.histories(self.flight, machine)
        judged = {name: weight for name, weight in self.weights.items() if weight}

        def size(x: Floats, total: bool = False) -> float:
            """Weighted sum of the measures; in `total` with the load's error."""
            return sum(weight * histories[name].size(x, total) for name, weight in judged.items())

        def steepest(x: Floats) -> tuple[float, Floats]:
            """Weighted measure without the load's error, and its slope (3,)."""
            parts = [histories[name].steepest(x, False) for name in judged]
            sizes, slopes = zip(*parts, strict=True)
            weights = np.array([*judged.values()])
            return float(weights @ sizes), weights @ np.array(slopes)

        if at is None:
            low, high = (np.where(self.moved, corner, self.start) for corner in self.answers.specimen.extent)
            at = minimise_convex(steepest, low, high, self.start)
        uses = machine.usage()
        times = times_between(*(float(end) for end in machine.extent))
        placed = machine.altered(control_point=_written(at))
        largest_use = max(uses, key=lambda use: use.share)
        return _Evaluated(
            Candidate(
                mounting=machine.mounting,
                smoothing=float(machine.smoothing or 0.0),
                control_point=float(at[0]),
                beside=(float(at[1]), float(at[2])),
                turn=machine.turn,
                difference=size(at),
                total_error=size(at, True),
                accelerations=accelerations,
                share=largest_use.share,
                exceeded=exceeded(uses),
                most_used=largest_use,
                tracking=sum(w * histories[name].error for name, w in judged.items()),
                largest_load=largest_pair(self.in_flight, largest_load(times, placed.base(times), self.points)),
            ),
            histories,
            machine,
            turn,
        )


def check_weights(weights: Mapping[Measure, float], where: str = "measure") -> None:
    """Raise InputError, naming `where` they were given, unless every measure is known and one has weight."""
    for name, weight in weights.items():
        if name not in MEASURES:
            raise InputError(where, f"names {name!r}", advise(name, MEASURES))
        if not (np.isfinite(weight) and weight >= 0):
            raise InputError(where, f"gives {name} the weight {weight:g}", "give weights of 0 or more")
    if not any(weights.values()):
        raise InputError(where, "has no weight", "give one measure a weight above 0")
