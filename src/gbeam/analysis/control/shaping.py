"""Command shaping: the drive of a hub or a joint that leaves the least vibration.

A command is a quintic B-spline. The vibration that it leaves in the modes of the linear model is linear in its
coefficients, and is minimised by least squares or, within a limit, by a quadratic program. The vibration that it leaves
in the given model, which stiffens as it turns, is then minimised by Gauss-Newton steps with exact derivatives.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Annotated, Any

import numpy as np

from gbeam.analysis.control.commands import Commands, Vibration, check_goal, reference_drives
from gbeam.analysis.control.plants import DRIVES, Goal, Plant, Ran
from gbeam.analysis.response.settings import ResponseSettings
from gbeam.analysis.steady.subject import subject_of
from gbeam.arrays.types import Floats
from gbeam.errors import ComputationError, InputError
from gbeam.guards.arguments import typed
from gbeam.guards.kinds import kinds
from gbeam.guards.quantities import Angle, OfKind, Ratio, Seconds
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.system import System
from gbeam.motion.hub import Hub
from gbeam.motion.profiles.pulse import SplineProfile
from gbeam.numerics.minimise import solve_quadratic
from gbeam.progress import Progress, tell
from gbeam.results.searches import CommandRun, ShapedCommand

RATIOS = np.linspace(0.7, 1.3, 61)
# Weight of a smooth step's roughness beside its vibration; less for a span of frequencies, which takes a larger drive.
_SMOOTH, _SMOOTH_ROBUST = 1e-3, 1e-4
_ROBUST = 9  # ratios over the span
_PERIODS = 3  # of the lowest frequency, over which the residual is measured
_ROUNDS, _MOVED = 4, 1e-3  # Gauss-Newton steps, and the difference of the drive over the largest for a derivative
_MISSED = 0.01  # of the goal, as a run's vibration moves what is driven
_BETTER = 0.9  # of the vibration before: a step that leaves more is the last


def _drive(arguments: Mapping[str, Any]) -> tuple[bool, bool]:
    """Flags of a command: an effort drives, and what is driven slides."""
    hub = arguments.get("hub")
    if isinstance(hub, Hub):
        return hub.free, False
    driven = Plant(subject_of(arguments["structure"], None).system, str(hub), "")
    return driven.free, driven.slides


@kinds(
    limit=lambda arguments: DRIVES[_drive(arguments)][1],
    rate=lambda arguments: "speed" if _drive(arguments)[1] else "angular rate",
)
@typed
def shape_command(
    structure: Structure | System,
    hub: Hub | str,
    *,
    angle: Angle | None = None,
    rate: float | None = None,
    distance: Annotated[float | None, OfKind("length")] = None,
    duration: Seconds,
    limit: float = np.inf,
    robust: Ratio = 0.0,
    pieces: int = 24,
    check: Structure | System | None = None,
    point: str | None = None,
    progress: Progress = None,
) -> ShapedCommand:
    """Find the command of a hub, or of a joint of a system, that leaves the least vibration.

    The design knows the modes about rest. Without `robust` it is refined on `structure` itself, by Gauss-Newton steps
    along the exact derivatives of its response. Then the command is run beside a smooth step of the same duration and
    one with a ZVD shaper (Singer and Seering 1990) of the first mode.

    Parameters
    ----------
    structure : Structure or System
        To design on; a system is on the ground, and gravity may act on it where its sag stays the same as it moves.
    hub : Hub or str
        With an inertia and no rate it is free, and the command is its torque; else the command is its rate. Of a system
        a coordinate, ``joint.angle`` or ``joint.displacement``, of any joint: where it has a rate that is the command,
        else the torque or force of its drive.
    angle : float, optional
        To turn, from rest to rest, rad.
    rate : float, optional
        To reach from rest, rad/s, of what slides m/s, in its place.
    distance : float, optional
        To move, from rest to rest, of what slides, m, in place of the angle.
    duration : float
        s.
    limit : float
        On the torque, N m, or the angular acceleration, rad/s²; of what slides the force, N, or acceleration, m/s².
    robust : float
        Share by which all frequencies may be wrong, such as 0.2: the mean square of what is left over that span is made
        least.
    pieces : int
        Of the spline, 12 or more.
    check : Structure or System, optional
        That the commands are run on, such as one of the exact model; by default `structure`.
    point : str, optional
        Of a system, which is to rest, ``body.point``: of a flexible body the displacement from its root, of others the
        place; by default the tip of the only flexible body.
    progress : callable or bool, optional
        Called with what is being done and the fraction of it done; True shows a bar.

    Returns
    -------
    ShapedCommand

    Raises
    ------
    InputError
        If it moves already or gravity bends it otherwise as it moves, there is not one goal, a number is impossible, or
        a joint that an effort drives is held by a spring or braked.
    ComputationError
        If no command within the limit does it in that time, or a run diverges.

    Examples
    --------
    >>> strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    >>> beam = gb.Beam(0.3, strip, gb.Material(2700, 70e9), damping_ratio=0.01)
    >>> structure = gb.assemble(beam, "FOAM", axial=1, y=2, z=2)
    >>> hub = gb.Hub(radius=0.0, rate=0.0)
    >>> command = gb.shape_command(structure, hub, angle=1.0, duration=0.5)
    >>> command.residual < 1e-9
    True
    """
    plant = _plant(structure, hub, point)
    goal = check_goal(plant, {"angle": angle, "distance": distance, "rate": rate}, duration)
    plant.refuse_moving(goal)
    if not pieces >= 12:
        raise InputError("pieces", f"is {pieces}", "give 12 or more")
    if not 0 <= robust < 1:
        raise InputError("robust", f"is {robust:g}", "give a share from 0 to less than 1, such as 0.2")
    if not limit > 0:
        raise InputError("limit", f"is {limit:g}", "give a positive number")
    commands, vibration = Commands(plant, goal, pieces), Vibration.from_plant(plant)
    reference_commands = reference_drives(commands, vibration)
    scale = float(np.mean(vibration.amplitude(commands.time, reference_commands["smooth-step"], np.ones(1))))
    design = _Design(commands, vibration, limit, robust, scale)
    inner = design.linear()
    if robust == 0:
        inner = _refined(plant, design, inner, progress)
    profiles = {
        "shaped": commands.command(inner),
        **{name: commands.profile(drive) for name, drive in reference_commands.items()},
    }
    drives = {"shaped": commands.fixed + commands.drive @ inner, **reference_commands}
    tested = plant if check is None else _plant(check, hub, point)
    settings = _settings(vibration, goal.duration)
    runs, warnings = [], list[str]()
    for name, profile in profiles.items():
        response = tested.run(
            profile, replace(settings, step=None), name, _part_progress(progress, f"{tested.kind}: {name}")
        )
        warnings += _missed(response, goal, name) if plant.free else []
        runs.append(
            CommandRun(
                name, np.asarray(profile(commands.time)), float(np.abs(drives[name]).max()),
                vibration.amplitude(commands.time, drives[name], RATIOS), response.time, response.tip,
                response.residual, response.outcome,
            )
        )  # fmt: skip
    return ShapedCommand(
        kind=DRIVES[plant.free, plant.slides][0],
        goal=goal.value,
        to_rate=goal.to_rate,
        duration=goal.duration,
        coefficients=np.asarray(profiles["shaped"].coefficients),
        time=commands.time,
        limit=float(limit),
        robust=robust,
        frequency=np.abs(vibration.eigenvalue) / (2 * np.pi),
        ratio=RATIOS,
        runs=tuple(runs),
        design=plant.kind,
        check=tested.kind,
        warnings=tuple(warnings),
    )


def _missed(ran: Ran, goal: Goal, name: str) -> tuple[str, ...]:
    """Warn if a run under a torque or force misses the goal, since the inertia changes on the way."""
    if ran.driven is None or ran.outcome != "done":
        return ()
    history = ran.driven[1] if goal.to_rate else ran.driven[0]
    reached = float(history[ran.time >= goal.duration].mean())
    if abs(reached - goal.value) <= _MISSED * abs(goal.value):
        return ()
    verb = "reaches" if goal.to_rate else "moves by"
    words = f"{name} {verb} {reached:.4g}, not {goal.value:.4g}"
    return (f"{words}: what is moved has another inertia on its way; give a rate",)


class _Design:
    """Least-squares problem of the vibration left and of the roughness, among the commands that reach the goal.

    The vibration is `left` times the coefficients plus `offset`, the roughness `rough` times these plus `rough_offset`.
    """

    def __init__(self, commands: Commands, vibration: Vibration, limit: float, robust: float, scale: float) -> None:
        """Set up the rows of the vibration, over a `scale`, for frequencies that may be wrong by the share `robust`."""
        self.commands, self.limit, self.scale = commands, limit, scale
        t = commands.time
        ratios = np.linspace(1 - robust, 1 + robust, _ROBUST) if robust else np.ones(1)
        drives = np.concatenate([commands.drive, commands.fixed[:, None]], axis=1)
        rows = np.concatenate([vibration.rows(t, drives, float(ratio)) for ratio in ratios]) / np.sqrt(len(ratios))
        rows = np.concatenate([rows.real, rows.imag]) / scale
        self.left, self.offset = rows[:, :-1], rows[:, -1]
        # Roughness: the drive's slope, over that of a smooth step.
        weight = np.sqrt(np.diff(t) * commands.goal.duration)[:, None]
        goal, smooth = commands.goal, _SMOOTH_ROBUST if robust else _SMOOTH
        size = abs(goal.value) * commands.inertia / goal.duration ** (1 if goal.to_rate else 2)
        self.rough = smooth * weight * commands.slope / size
        self.rough_offset = smooth * weight[:, 0] * np.diff(commands.fixed) / np.diff(t) / size

    def linear(self) -> Floats:
        """Coefficients that leave the least vibration in the modes of the linear model."""
        return self.solved(self.left, self.offset, self.commands.particular)

    def solved(self, rows: Floats, offset: Floats, centre: Floats) -> Floats:
        """Coefficients c that minimise |rows c + offset|² and roughness, within the limit. `centre` are coefficients
        that reach the goal. ComputationError if no command within the limit does.
        """
        commands = self.commands
        a = np.concatenate([rows, self.rough]) @ commands.free
        b = np.concatenate([rows @ centre + offset, self.rough @ centre + self.rough_offset])
        coefficients = centre + commands.free @ np.linalg.lstsq(a, -b, rcond=None)[0]
        sampled = slice(None, None, 8)
        drive, fixed = commands.drive[sampled], commands.fixed[sampled]
        if np.abs(drive @ coefficients + fixed).max() <= self.limit:
            return coefficients
        from scipy.sparse import csc_array

        size, limited = np.linalg.norm(a, axis=0).max(), (drive @ commands.free) / self.limit
        middle = (drive @ centre + fixed) / self.limit
        change = solve_quadratic(
            csc_array(a.T @ a / size**2), a.T @ b / size**2, csc_array(limited), -1.0 - middle, 1.0 - middle
        )
        if change is None:
            word = DRIVES[commands.plant.free, commands.plant.slides][1]
            problem = f"no command of {word} {self.limit:.4g} or less does it in {commands.goal.duration:g} s"
            raise ComputationError("limits exceeded", problem)
        return np.asarray(centre + commands.free @ change)


def _settings(vibration: Vibration, duration: float) -> ResponseSettings:
    """Settings of a run that lasts for the command and for some periods of the slowest mode after it."""
    decay_time = _PERIODS * 2 * np.pi / float(vibration.eigenvalue[0].imag)
    return ResponseSettings(
        duration + decay_time, residual_from=duration, integrator="gauss", estimate=False, loads=False
    )


def _plant(structure: Structure | System, hub: Hub | str, point: str | None) -> Plant:
    """The plant of a command, a hub with its beam or a joint of a system. InputError if they do not go together."""
    system = subject_of(structure, None).system
    return Plant.from_hub(system, hub, point) if isinstance(hub, Hub) else Plant.from_coordinate(system, hub, point)


def _refined(plant: Plant, design: _Design, inner: Floats, progress: Progress) -> Floats:
    """Coefficients improved by Gauss-Newton steps on the vibration that the plant's own run leaves."""
    commands = design.commands
    settings = _settings(Vibration.from_plant(plant), commands.goal.duration)
    first = plant.run(
        commands.command(inner), settings, progress=_part_progress(progress, f"{plant.kind}: the linear design")
    )
    if first.outcome != "done":
        raise ComputationError(first.outcome, first.message)
    settings = replace(settings, step=first.step)
    moves = commands.free / np.abs(commands.drive @ commands.free).max(axis=0)
    best_step, least_vibration = inner, np.inf
    for k in range(_ROUNDS):
        words = f"{plant.kind}: refining, round {k + 1} of at most {_ROUNDS}"
        tell(progress, words, 0.0)
        width = _MOVED * np.abs(commands.drive @ inner + commands.fixed).max()
        pairs = [
            (commands.command(inner - width / 2 * move), commands.command(inner + width / 2 * move)) for move in moves.T
        ]
        try:
            nominal, varied = plant.perturbed_runs(
                commands.command(inner), settings, pairs, width, partial(tell, progress, words)
            )
        except ComputationError:
            if not k:
                raise
            break  # the last step went too far
        residual = _departures(nominal, commands.goal.duration) / design.scale
        size = float(np.linalg.norm(residual))
        if size < least_vibration:
            is_better, best_step, least_vibration = size < _BETTER * least_vibration, inner, size
        else:
            is_better = False
        if not is_better or k == _ROUNDS - 1:
            break
        slopes = [
            (_departures(after, commands.goal.duration) - _departures(before, commands.goal.duration))
            / width
            / design.scale
            for before, after in varied
        ]
        # From derivatives along the free directions to those by coefficients.
        rows = np.stack(slopes, axis=1) @ np.linalg.pinv(moves)
        inner = design.solved(rows, residual - rows @ inner, inner)
    return best_step


def _part_progress(progress: Progress, words: str) -> Progress:
    """Progress of a part, which is told with `words` before its own."""
    return lambda stage, share: tell(progress, f"{words}, {stage}", share)


def _departures(run: Ran, duration: float) -> Floats:
    """Departures (m,) of the point from its mean after the command, scaled so that their norm is an amplitude, m."""
    tip = run.tip[run.time >= duration]
    return ((tip - tip.mean(axis=0)) * np.sqrt(2 / len(tip))).ravel()


def profile_of(command: ShapedCommand) -> SplineProfile:
    """The profile of a shaped command, for a hub's torque or rate."""
    return SplineProfile(command.duration, command.coefficients)
