"""Where to put the specimen: the control point, mounting and smoothing that change its response least.

About the control point C the centrifuge adds Δa(x, t) = g(t)(x − x_c) to the load of the flight (2020 (4)), and the
axis motions, so g, do not depend on where C lies in the specimen. Each measure of the response to Δa is then the size
of A(t) − x_c B(t): two histories found once, and a convex function of x_c. Which mounting and width of smoothing give
the best such point within the machine's limits is searched for, each with axis motions of its own.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import scipy.optimize

from gbeam.analysis.imitation.comparison import CUTOFF, compare
from gbeam.analysis.imitation.place_measures import Answers, Histories
from gbeam.analysis.response.section_forces import internal_loads
from gbeam.analysis.response.simulation import simulate
from gbeam.analysis.study.case import ResponseSettings
from gbeam.errors import ComputationError, InputError
from gbeam.mechanics.assembly import Structure
from gbeam.motion import Base, Centrifuge, Flight
from gbeam.motion.centrifuge.limits import exceeded
from gbeam.numerics.bounded_search import refine
from gbeam.numerics.low_pass import low_pass
from gbeam.results.placement import MEASURES, Candidate, Placement, Verification
from gbeam.results.response import Response
from gbeam.structure.beam import Beam

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
    beam: Beam | None = None,
) -> Placement:
    """Find the control point, mounting and smoothing that change a specimen's response least.

    Parameters
    ----------
    structure : Structure
    flight : Flight
    choice : Choice
        Mountings and widths of smoothing.
    settings : ResponseSettings
        Its span is what is looked at.
    weights : mapping of str to float
        Measures to add up, each as a fraction of its peak in flight, across the beam: ``root-shear`` and
        ``root-moment`` (quasi-static), ``vibration`` (of the first mode, at the tip), ``tip`` (quasi-static
        displacement). For each option they choose the control point by what Δa does, and then the option by that
        together with what smoothing and tracking change of the load.
    current : Centrifuge
        The scenario's own: its control point is compared with.
    names : tuple of str
        Of flight and centrifuge.
    beam : Beam, optional
        With it the answer is proven by the model's own response, and so are the current control point and the middle
        of the beam.

    Raises
    ------
    InputError
        If a measure is unknown or none has weight, or no option can be built: the first one's reason.
    ComputationError
        If every option exceeds the machine's limits (outcome ``limits exceeded``); it names the nearest.
    """
    check_weights(weights)
    tried = _Tried(structure, flight, choice, settings, weights)
    for width in reversed(choice.widths):  # the widest first, see Answers
        for mounting in choice.mountings:
            tried(mounting, width)
    if not tried.found:
        raise tried.reasons[0].within(f"motion.{names[1]}")
    if choice.refined:
        leader = tried.ranked()[0].option.mounting
        refine(lambda width: tried(leader, width), choice.widths)
    ranked = tried.ranked()
    best = ranked[0]
    if best.option.exceeded and choice.limited:
        broken = "; ".join(str(use) for use in best.option.exceeded)
        raise ComputationError(
            EXCEEDED,
            f"motion.{names[1]}: none of {len(ranked)} options keeps the machine's limits; nearest comes "
            f"{best.option.mounting}, {1e3 * best.option.smoothing:.4g} ms: {broken}; "
            'try wider smoothing or inverse = "planned"',
        )
    length, at = structure.length, best.option.control_point
    places = {"best": at, "current": float(current.control_point), "middle": length / 2}
    verifications = () if beam is None else _prove(structure, beam, flight, best.centrifuge, settings, places)
    return Placement(
        flight=names[0],
        centrifuge=names[1],
        weights=dict(weights),
        length=length,
        best=best.option,
        options=tuple(it.option for it in ranked),
        current=places["current"],
        values={name: {m: h.size(x, False) for m, h in best.histories.items()} for name, x in places.items()},
        verifications=verifications,
        refused=tuple(tried.refused),
        widths=(choice.widths[0], choice.widths[-1]),
    )


@dataclass(frozen=True)
class _Found:
    """An option with what it came from."""

    option: Candidate
    histories: dict[str, Histories]
    centrifuge: Centrifuge


class _Tried:
    """The options tried so far; calling it tries one more."""

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
        self.found: dict[tuple[str, float], _Found] = {}
        self.refused: list[str] = []
        self.reasons: list[InputError] = []

    def __call__(self, mounting: str, width: float) -> tuple[float, float]:
        """Weighted measure at the best control point, and the largest share of a limit."""
        if (mounting, width) not in self.found:
            try:
                self.found[mounting, width] = self._option(mounting, width)
            except InputError as error:
                self.refused.append(f"{mounting}, {1e3 * width:.4g} ms: {error}")
                self.reasons.append(error)
                return np.inf, np.inf
        it = self.found[mounting, width].option
        return it.total_error, it.share if self.choice.limited else 0.0

    def ranked(self) -> list[_Found]:
        """Best first; those that break limits last, by how much."""

        def rank(it: _Found) -> tuple[float, float]:
            # Rounding must not choose between mirror images: then the scenario's own comes first.
            excess = it.option.share if self.choice.limited and it.option.exceeded else 0.0
            return excess, float(f"{it.option.total_error:.6g}")

        return sorted(self.found.values(), key=rank)

    def _option(self, mounting: str, width: float) -> _Found:
        centrifuge = self.choice.make(mounting, width)
        histories, accelerations = self.answers.histories(self.flight, centrifuge)

        def size(at: float, whole: bool = False) -> float:
            return sum(weight * histories[name].size(at, whole) for name, weight in self.weights.items())

        least = scipy.optimize.minimize_scalar(
            size, bounds=(0, self.length), method="bounded", options={"xatol": 1e-7 * self.length}
        )
        at, uses = float(least.x), centrifuge.usage()
        share = max(use.share for use in uses)
        broken = exceeded(uses)
        return _Found(
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


class _Carried(eqx.Module):
    """A base in translation with the load that a centrifuge makes at its control point: no mismatch anywhere."""

    centrifuge: Centrifuge

    def base(self, t: jax.Array) -> Base:
        load = self.centrifuge.actual(t)
        return Base(load, jnp.zeros_like(load), jnp.zeros_like(load))

    @property
    def breaks(self) -> jax.Array:
        return self.centrifuge.breaks


def _prove(
    structure: Structure,
    beam: Beam,
    flight: Flight,
    centrifuge: Centrifuge,
    settings: ResponseSettings,
    places: Mapping[str, float],
) -> tuple[Verification, ...]:
    """The model's own response at each control point against that in flight."""

    def computed(motion: Flight | Centrifuge) -> Response:
        response = simulate(structure, motion, settings)
        return replace(response, loads=internal_loads(structure, beam, response))

    there, verifications = computed(flight), []
    carried = simulate(structure, _Carried(centrifuge), settings)  # type: ignore[arg-type]  # a motion like any other
    step = float(there.time[1] - there.time[0])
    cutoff = CUTOFF * float(there.frequencies[0]) / (2 * np.pi)
    for name, at in places.items():
        here = computed(eqx.tree_at(lambda it: it.control_point, centrifuge, jnp.asarray(at)))
        answer = compare(there, here)
        swing = (here.tip - carried.tip)[:, 1:]
        swing = swing - low_pass(swing, step, cutoff)
        moment = np.nan if answer.root is None else float(answer.root.moment_difference[1:].max())
        apart, swung = (
            float(np.linalg.norm(values[answer.covered], axis=1).max()) for values in (answer.difference[:, 1:], swing)
        )
        verifications.append(Verification(name, at, apart, swung, moment))
    return tuple(verifications)
