"""Measures by which a place of the specimen is judged: per measure histories of what the load's difference does."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Annotated, Any, Literal, get_args

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
from gbeam.guards.quantities import OfKind, Quantity
from gbeam.mechanics.tree.system import System
from gbeam.motion.centrifuge.centrifuge import MOUNTINGS, Centrifuge
from gbeam.motion.centrifuge.course import INVERSES
from gbeam.motion.flight import Flight
from gbeam.motion.protocol import SAMPLES
from gbeam.motion.rigid import rotation_of
from gbeam.numerics.minimise import coarse
from gbeam.numerics.samples import displacement

Turn = tuple[float, float, float]
Ways = Literal["own", "right-angles", "any"]
SAME = 1e-9  # of the cosine between directions: opposite or equal ones differ by less
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
    widths: Annotated[Numbers, OfKind("time")]
    refined: bool = True
    limited: bool = True
    turns: Annotated[tuple[Turn, ...], Quantity("angle")] = ()
    between: bool = False


@dataclass(frozen=True)
class Altered:
    """A centrifuge with another mounting, width of smoothing and turn."""

    centrifuge: Centrifuge

    def __call__(self, mounting: str, width: float, turn: Turn | None = None) -> Centrifuge:
        """Return the altered centrifuge, or the same object if nothing differs, which is not planned again then."""
        machine = self.centrifuge
        turn = machine.turn if turn is None else turn
        if (mounting, width, turn) == (machine.mounting, width_of(machine), machine.turn):
            return machine
        return machine.altered(mounting=mounting, smoothing=width, turn=turn)


def width_of(centrifuge: Centrifuge) -> float:
    """Width of the smoothing of a centrifuge's target, s, or zero without smoothing."""
    return float(centrifuge.smoothing or 0.0)


@typed
def choice_of(
    centrifuge: Centrifuge,
    smoothing: Annotated[Numbers, OfKind("time")] = (),
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
    other_mountings = tuple(name for name in MOUNTINGS if name != centrifuge.mounting)
    return Choice(
        Altered(centrifuge), (centrifuge.mounting, *other_mountings), widths, len(widths) > 1, limited,
        turns_of(centrifuge.turn, turns), between=turns == "any",
    )  # fmt: skip


def turns_of(turn: Turn, ways: Ways) -> tuple[Turn, ...]:
    """Turns to try: the scenario's own first, then those that bring other directions of the specimen along axis 3.

    Of opposite directions, which are the two mountings, one is tried. There are none where the scenario's own is the
    only way.
    """
    if ways == "own":
        return ()
    grid = [steps for steps in product((1, 0, -1), repeat=3) if steps > (0, 0, 0)]
    turns, beam_axes = [turn], [rotation_of(turn)[0]]
    for steps in sorted(grid, key=np.count_nonzero):
        direction = np.array(steps) / np.linalg.norm(steps)
        if (np.count_nonzero(steps) == 1 or ways == "any") and max(np.abs(beam_axes @ direction)) < 1 - SAME:
            beam_axes.append(direction)
            turns.append(turn_to_axis(direction))
    return tuple(turns)


def turn_to_axis(direction: Floats) -> Turn:
    """Shortest turn, a rotation vector in rad, that brings a direction (3,) of the specimen along x, as axis 3 is."""
    axis = np.cross(direction, [1.0, 0.0, 0.0])
    size = float(np.linalg.norm(axis))
    x, y, z = (axis / size * math.atan2(size, direction[0])).tolist() if size else (0.0, 0.0, 0.0)
    return x, y, z


@dataclass(frozen=True)
class Histories:
    """Histories (t, ..., k) of a measure over the times compared. `scale` is the measure's peak in flight.

    They are its answers to the load's error at the control point, to the error of the load's growth, and to unit shifts
    of the control point (3, t, ..., k).
    """

    at_control_point: Floats
    growing: Floats
    uniform: Floats
    scale: float

    def size(self, at: Floats, total: bool) -> float:
        """Largest size as a share of the flight's peak, with the control point at a place (3,) m. In `total` it
        includes the load's error.
        """
        return self.steepest(at, total)[0]

    def steepest(self, at: Floats, total: bool) -> tuple[float, Floats]:
        """The value of `size`, and its slope (3,), 1/m, with respect to the place of the control point."""
        values = self.growing - np.tensordot(at, self.uniform, 1) + (self.at_control_point if total else 0.0)
        sizes = np.linalg.norm(values, axis=-1)
        worst = np.unravel_index(int(np.argmax(sizes)), sizes.shape)
        largest = float(sizes[worst])
        slope = -self.uniform[(slice(None), *self._shared(worst))] @ values[worst] / max(largest, 1e-300)
        return largest / self.scale, slope / self.scale

    def _shared(self, worst: tuple[Any, ...]) -> tuple[Any, ...]:
        """Index into `uniform` for an index into the values. Axes along which `uniform` is broadcast have one entry."""
        return tuple(min(k, size - 1) for k, size in zip(worst, self.uniform.shape[1:-1], strict=True))

    @property
    def error(self) -> float:
        """Largest answer to the load's error alone, which no control point changes, as a share of flight's peak."""
        return float(np.linalg.norm(self.at_control_point, axis=-1).max(initial=0.0)) / self.scale


MOST = 2_000_000  # numbers of a history of the load at all ends of a specimen, at most


class Answers:
    """Answers of a specimen to the loads of a flight and of centrifuges: quasi-static ones, and vibration in the mode
    by which the flight displaces the tip most.

    Times at which the first centrifuge's target is not the flight's load are left out for all. So begin with the widest
    smoothing, which holds longest.
    """

    def __init__(self, system: System, flight: Flight, settings: ResponseSettings) -> None:
        """Find the point and the mode that the flight moves most, and times that are close enough for that mode."""
        span = np.linspace(settings.start, settings.start + settings.duration, SAMPLES)
        self.specimen, flown = Specimen.from_system(system, span), flight.base(span)
        loads = flown.a_WO_B, gradients(flown.w_WB_B, flown.alpha_WB_B)
        displacement, modes, self.tip, self.mode = self.specimen.displacement, self.specimen.modes, "", None
        if modes is not None:
            moved = [_largest(answer.evaluate(*loads)) for answer in displacement.values()]
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
        """Raise InputError if a measure with a weight is zero in flight."""
        specimen, loads = self.specimen, (self.load, self.growth)
        answers = {"root-shear": specimen.force, "root-moment": specimen.moment}
        if self.tip:
            answers |= dict.fromkeys(("vibration", "tip"), specimen.displacement[self.tip])
        felt = [name for name, answer in answers.items() if _largest(self._lateral_part(answer).evaluate(*loads)) > 0]
        felt.append("load")
        for name, weight in weights.items():
            if weight and name not in felt:
                problem = f"is {name}, of which the flight makes none"
                raise InputError("measure", problem, f"choose of {', '.join(felt)}")

    def _lateral_part(self, answer: Answer) -> Answer:
        """Return the answer of a straight beam without its component along x, which is stiff; others as they are."""
        return answer.map(np.diag([0.0, 1.0, 1.0])) if self.specimen.straight else answer

    def histories(
        self, flight: Flight, centrifuge: Centrifuge
    ) -> tuple[dict[str, Histories], tuple[float, float, float]]:
        """Histories by measure, but for those that are zero in flight, and the axes' largest accelerations, rad/s²."""
        axes, at_c = centrifuge.axes(self.time), centrifuge.at_control_point(self.time)
        # Times that the first machine leaves out count for none; at others, not to follow is an error.
        self.left_out = centrifuge.not_followed(self.time) if self.left_out is None else self.left_out
        covered = ~self.left_out
        if not covered.any():
            raise InputError("tracks", "is never followed: the target is at no time the flight's load", "lower idle")
        error, growth = at_c.a_WO_B - self.load, gradients(at_c.w_WB_B, at_c.alpha_WB_B)
        # The machine's load at r is that at C plus growth × (r − C), the flight's that at the root plus growth × r.
        growing, columns = growth - self.growth, np.moveaxis(growth, -1, 0)
        specimen = self.specimen

        def histories(answer: Answer, shaped: Callable[[Floats], Floats], scale: float) -> Histories:
            """Histories of an answer, whose values (t, ...) are `shaped` into those of the measure."""
            at_c = shaped(answer.evaluate(error, 0 * growing))
            grown = shaped(answer.evaluate(0 * error, growing))
            uniform = np.stack([shaped(answer.evaluate(column, 0 * growing)) for column in columns])
            return Histories(at_c, grown, uniform, scale)

        def quasi_static(answer: Answer) -> Histories:
            answer = self._lateral_part(answer)
            in_flight = answer.evaluate(self.load, self.growth)
            return histories(answer, lambda values: values[covered], _largest(in_flight[covered]))

        measures = {"root-shear": quasi_static(specimen.force), "root-moment": quasi_static(specimen.moment)}
        if self.mode is not None:
            measures["tip"] = quasi_static(specimen.displacement[self.tip])
            measures["vibration"] = histories(self.mode.force, self._vibration(covered), measures["tip"].scale)
        measures["load"] = self._loads(covered, error, growing, columns)
        angular_size = np.abs(axes.accelerations).max(axis=0)
        largest = float(angular_size[0]), float(angular_size[1]), float(angular_size[2])
        return {name: measure for name, measure in measures.items() if measure.scale > 0}, largest

    def _vibration(self, covered: Flags) -> Callable[[Floats], Floats]:
        """Function from the force (t,) on the foremost mode to its vibration (t, 1) m about its trend."""
        assert self.mode is not None
        frequency, damping = float(self.mode.frequency), float(self.mode.damping)

        def vibration(force: Floats) -> Floats:
            deviation = displacement(force, frequency, damping, self.step) - force / frequency**2
            return np.asarray(self.reach * deviation[covered, None])

        return vibration

    def _loads(self, covered: Flags, error: Floats, growing: Floats, columns: Floats) -> Histories:
        """Histories of the load at all ends of the specimen, thinned out in time so that they fit in memory."""
        ends = np.array([*self.specimen.ends.values()])
        thinned = np.flatnonzero(covered)[:: max(1, math.ceil(3 * len(ends) * len(error) / MOST))]
        in_flight = self.load[thinned, None] + ends @ self.growth[thinned].swapaxes(1, 2)
        at_ends = np.broadcast_to(error[thinned, None], in_flight.shape)
        return Histories(
            at_ends, ends @ growing[thinned].swapaxes(1, 2), columns[:, thinned, None], _largest(in_flight)
        )


def _largest(values: Floats) -> float:
    """Largest norm of vectors (..., k), or zero if there are none."""
    return float(np.linalg.norm(values, axis=-1).max(initial=0.0))
