"""The measures by which a place for the specimen is judged: histories of what the mismatch does, per measure."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any, Literal, get_args

import numpy as np

from gbeam.analysis.imitation.accounting import gradients
from gbeam.analysis.imitation.specimen import Answer, Specimen
from gbeam.analysis.response.settings import ResponseSettings
from gbeam.analysis.response.stepping import RIGID, even_steps
from gbeam.arrays.types import Flags, Floats, Numbers
from gbeam.constants import Measure, Mounting
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import choice
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.system import System
from gbeam.motion import Flight
from gbeam.motion.centrifuge.centrifuge import MOUNTINGS, Centrifuge, rotation_of
from gbeam.motion.centrifuge.course import INVERSES
from gbeam.motion.protocol import SAMPLES
from gbeam.numerics.minimise import coarse
from gbeam.numerics.samples import displacement

Turn = tuple[float, float, float]
Ways = Literal["own", "right-angles", "any"]
SAME = 1e-9
_FACTOR = 4.0  # of the centrifuge's own smoothing, either way


@typed
@dataclass(frozen=True)
class Choice:
    """Options beside the control point: mountings, ways round and widths of smoothing.

    Parameters
    ----------
    make : callable
        Of mounting and width of smoothing, s, and of a turn where `turns` has some: a centrifuge that tracks the
        flight; InputError where it cannot.
    mountings : tuple of str
        The scenario's own first.
    widths : tuple of float
        Tried with every mounting, ascending, s.
    refined : bool
        Whether to search on between the best of them and its neighbours.
    limited : bool
        Whether the machine's limits must be kept.
    turns : tuple of (3,)
        Rotation vectors of the specimen in the machine, rad, the scenario's own first; where none is given, its own
        alone.
    between : bool
        Whether to search on between them for the best direction of axis 3.

    Examples
    --------
    >>> load = gb.Sum((gb.constant(20.0), gb.trapezoid(50.0, jerk=25.0, start=1.0, hold=2.0)))
    >>> machine = gb.Centrifuge(
    ...     gb.Flight(z=load), arm=3.3, control_point=0.22, gravity=True, smoothing=0.1, span=(0.0, 8.0)
    ... )
    >>> gb.choice_of(machine, smoothing=[0.1]).mountings
    ('upright', 'inverted')
    """

    make: Callable[..., Centrifuge]
    mountings: Sequence[Mounting]
    widths: Numbers
    refined: bool = True
    limited: bool = True
    turns: tuple[Turn, ...] = ()
    between: bool = False


@dataclass(frozen=True)
class Altered:
    """A centrifuge with another mounting, width of smoothing and turn."""

    centrifuge: Centrifuge

    def __call__(self, mounting: str, width: float, turn: Turn | None = None) -> Centrifuge:
        """Return the centrifuge itself where all are its own: it need not be planned again."""
        of = self.centrifuge
        wanted = mounting, width, of.turn if turn is None else turn
        if wanted == (of.mounting, width_of(of), of.turn):
            return of
        return of.altered(mounting=mounting, smoothing=width, turn=wanted[2])


def width_of(centrifuge: Centrifuge) -> float:
    """Width of the smoothing of its target, s; zero where there is none."""
    return float(centrifuge.smoothing or 0.0)


@typed
def choice_of(
    centrifuge: Centrifuge,
    smoothing: Numbers = (),
    *,
    limited: bool = True,
    turns: Ways = "own",
) -> Choice:
    """Return both mountings of a centrifuge, its own first, and widths of smoothing.

    Parameters
    ----------
    centrifuge : Centrifuge
        Prepared for the times that are looked at.
    smoothing : sequence of float
        Width of the kernel to keep, s, or the two ends of a range; without it from a quarter to four times the
        centrifuge's own, or, where the axis motions are planned within the limits and need no smoothing, its own.
    limited : bool
        Whether the machine's limits must be kept.
    turns : str
        Ways round that are tried. ``own``: the centrifuge's; ``right-angles``: with x, y and z along axis 3 too;
        ``any``: these, the directions between them and, from the best, any. A roll about axis 3 changes nothing.

    Raises
    ------
    InputError
        If `turns` has no such name, there are more than two widths, or one of two is not positive.

    Examples
    --------
    >>> load = gb.Sum((gb.constant(20.0), gb.trapezoid(50.0, jerk=25.0, start=1.0, hold=2.0)))
    >>> machine = gb.Centrifuge(
    ...     gb.Flight(z=load), arm=3.3, control_point=0.22, gravity=True, smoothing=0.1, span=(0.0, 8.0)
    ... )
    >>> gb.choice_of(machine, smoothing=[0.05, 0.2]).refined
    True
    """
    if len(smoothing) > 2:
        raise InputError("smoothing", f"is given {len(smoothing)} times", "give one width, or the ends of a range")
    if len(smoothing) == 2 and min(smoothing) <= 0:
        raise InputError("smoothing", f"is {min(smoothing):g} s", "give two positive widths")
    width = width_of(centrifuge)
    searched = [width] if INVERSES[centrifuge.method].plans else [width / _FACTOR, width * _FACTOR]
    ends = sorted(smoothing) or searched
    widths = coarse(ends[0], ends[-1])

    choice("turns", turns, get_args(Ways))
    others = tuple(name for name in MOUNTINGS if name != centrifuge.mounting)
    return Choice(
        Altered(centrifuge), (centrifuge.mounting, *others), widths, len(widths) > 1, limited,
        turns_of(centrifuge.turn, turns), between=turns == "any",
    )  # fmt: skip


def turns_of(turn: Turn, ways: Ways) -> tuple[Turn, ...]:
    """Turns by name: the scenario's own first, then those that bring other directions of the specimen along axis 3,
    each once of the two that are opposite, which are the two mountings.
    """
    if ways == "own":
        return ()
    directions = [each for each in product((1, 0, -1), repeat=3) if each > (0, 0, 0)]
    turns, along = [turn], [rotation_of(turn)[0]]
    for each in sorted(directions, key=np.count_nonzero):
        direction = np.array(each) / np.linalg.norm(each)
        if (np.count_nonzero(each) == 1 or ways == "any") and max(np.abs(along @ direction)) < 1 - SAME:
            along.append(direction)
            turns.append(bringing(direction))
    return tuple(turns)


def bringing(direction: Floats) -> Turn:
    """Shortest turn that brings a direction of the specimen along x, as axis 3 lies."""
    axis = np.cross(direction, [1.0, 0.0, 0.0])
    size = float(np.linalg.norm(axis))
    x, y, z = (axis / size * math.atan2(size, direction[0])).tolist() if size else (0.0, 0.0, 0.0)
    return x, y, z


@dataclass(frozen=True)
class Histories:
    """A measure over the times compared: of the load's error at C, of the growth's, and of the growth along x, y and z,
    (3, ...); (t, ..., k) each; flight's own peak.
    """

    at_control_point: Floats
    growing: Floats
    uniform: Floats
    scale: float

    def size(self, at: Floats, total: bool) -> float:
        """Largest size with the control point at `at` (3,) m, over flight's peak; in `total` with the load's error."""
        return self.steepest(at, total)[0]

    def steepest(self, at: Floats, total: bool) -> tuple[float, Floats]:
        """Size as `size` gives, and its slope (3,) in the place of the control point, 1/m."""
        values = self.growing - np.tensordot(at, self.uniform, 1) + (self.at_control_point if total else 0.0)
        sizes = np.linalg.norm(values, axis=-1)
        worst = np.unravel_index(int(np.argmax(sizes)), sizes.shape)
        slope = -self.uniform[(slice(None), *self._there(worst))] @ values[worst] / max(float(sizes[worst]), 1e-300)
        return float(sizes[worst]) / self.scale, slope / self.scale

    def _there(self, worst: tuple[Any, ...]) -> tuple[Any, ...]:
        """Index of what is uniform: where it does not depend on the place, it has one."""
        return tuple(min(k, size - 1) for k, size in zip(worst, self.uniform.shape[1:-1], strict=True))

    @property
    def error(self) -> float:
        """Measure of the load's error at C alone, which no control point changes."""
        return float(np.linalg.norm(self.at_control_point, axis=-1).max(initial=0.0)) / self.scale


MOST = 2_000_000  # numbers in a history of the load at all ends of a specimen


class Answers:
    """Quasi-static answers, and those of the mode by which the flight displaces the tip most, to loads of a flight and
    of a centrifuge at times when the first centrifuge's target is not held: begin with the widest smoothing, which
    holds longest.
    """

    def __init__(self, structure: Structure | System, flight: Flight, settings: ResponseSettings) -> None:
        span = np.linspace(settings.start, settings.start + settings.duration, SAMPLES)
        self.specimen, flown = Specimen.of(structure, span), flight.base(span)
        loads = flown.a_WO_B, gradients(flown.w_WB_B, flown.alpha_WB_B)
        displacement, modes, self.tip, self.mode = self.specimen.displacement, self.specimen.modes, "", None
        if modes is not None:
            moved = [_largest(each.at(*loads)) for each in displacement.values()]
            point = int(np.argmax(moved))
            self.tip, self.mode = list(displacement)[point], modes.foremost(point, *loads)
            self.reach = float(np.linalg.norm(self.mode.shape[point]))
        longest = RIGID if self.mode is None else 2 * np.pi / float(self.mode.frequency) / 20
        longest = min(longest, settings.duration / 500)
        corners = np.concatenate([flight.corners(longest), self.specimen.corners(longest)])
        self.step = settings.duration / even_steps(longest, corners, settings)
        self.time = settings.start + self.step * np.arange(round(settings.duration / self.step) + 1)
        self.left_out: Flags | None = None
        flown = flight.base(self.time)
        self.load, self.growth = flown.a_WO_B, gradients(flown.w_WB_B, flown.alpha_WB_B)

    def refuse_unfelt(self, weights: Mapping[Measure, float]) -> None:
        """Refuse a measure that has weight, and of which the flight makes none."""
        of, loads = self.specimen, (self.load, self.growth)
        known = {"root-shear": of.force, "root-moment": of.moment}
        if self.tip:
            known |= dict.fromkeys(("vibration", "tip"), of.displacement[self.tip])
        felt = [*(name for name, each in known.items() if _largest(self._across(each).at(*loads)) > 0), "load"]
        for name, weight in weights.items():
            if weight and name not in felt:
                raise InputError(
                    "measure", f"is {name}, of which the flight makes none", f"choose of {', '.join(felt)}"
                )

    def _across(self, answer: Answer) -> Answer:
        """The answer without what is along a straight beam, which is stiff there."""
        return answer.onto(np.diag([0.0, 1.0, 1.0])) if self.specimen.straight else answer

    def histories(
        self, flight: Flight, centrifuge: Centrifuge
    ) -> tuple[dict[str, Histories], tuple[float, float, float]]:
        """Every measure that the flight's load has any of, and the largest accelerations of the axes, rad/s²."""
        axes, at_c = centrifuge.axes(self.time), centrifuge.at_control_point(self.time)
        # No machine answers for times that the first leaves out; times that another one does not follow are its error.
        self.left_out = centrifuge.not_followed(self.time) if self.left_out is None else self.left_out
        covered = ~self.left_out
        if not covered.any():
            raise InputError("tracks", "is never carried: the target is held all the time", "lower idle")
        error, growth = at_c.a_WO_B - self.load, gradients(at_c.w_WB_B, at_c.alpha_WB_B)
        # About C the machine adds its growth times the place less C; at the root the flight's load is its own.
        growing, columns = growth - self.growth, np.moveaxis(growth, -1, 0)
        specimen = self.specimen

        def histories(answer: Answer, shaped: Callable[[Floats], Floats], scale: float) -> Histories:
            parts = answer.at(error, 0 * growing), answer.at(0 * error, growing)
            uniform = np.stack([shaped(answer.at(column, 0 * growing)) for column in columns])
            at_c, grown = map(shaped, parts)
            return Histories(at_c, grown, uniform, scale)

        def quasi_static(answer: Answer) -> Histories:
            answer = self._across(answer)
            return histories(answer, lambda each: each[covered], _largest(answer.at(self.load, self.growth)[covered]))

        measures = {"root-shear": quasi_static(specimen.force), "root-moment": quasi_static(specimen.moment)}
        if self.mode is not None:
            measures["tip"] = quasi_static(specimen.displacement[self.tip])
            measures["vibration"] = histories(self.mode.force, self._vibration(covered), measures["tip"].scale)
        measures["load"] = self._loads(covered, error, growing, columns)
        turning = np.abs(axes.accelerations).max(axis=0)
        largest = float(turning[0]), float(turning[1]), float(turning[2])
        return {name: each for name, each in measures.items() if each.scale > 0}, largest

    def _vibration(self, covered: Flags) -> Callable[[Floats], Floats]:
        """Displacement (t, 1) by the foremost mode beside its trend, of a force on it (t,)."""
        assert self.mode is not None
        frequency, damping = float(self.mode.frequency), float(self.mode.damping)

        def moved(force: Floats) -> Floats:
            riding = displacement(force, frequency, damping, self.step) - force / frequency**2
            return np.asarray(self.reach * riding[covered, None])

        return moved

    def _loads(self, covered: Flags, error: Floats, growing: Floats, columns: Floats) -> Histories:
        """Load at every end of the specimen."""
        ends = np.array([*self.specimen.ends.values()])
        some = np.flatnonzero(covered)[:: max(1, math.ceil(3 * len(ends) * len(error) / MOST))]
        in_flight = self.load[some, None] + ends @ self.growth[some].swapaxes(1, 2)
        at_ends = np.broadcast_to(error[some, None], in_flight.shape)
        return Histories(at_ends, ends @ growing[some].swapaxes(1, 2), columns[:, some, None], _largest(in_flight))


def _largest(values: Floats) -> float:
    return float(np.linalg.norm(values, axis=-1).max(initial=0.0))
