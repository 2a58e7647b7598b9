"""Command shaping of a scenario: the rate or effort that does its slew and leaves the least vibration."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any, Literal

import numpy as np

from gbeam.analysis.case import Case
from gbeam.analysis.control.plants import DRIVES, movable
from gbeam.analysis.control.shaping import profile_of, shape_command
from gbeam.analysis.model_study import convert_models
from gbeam.arrays.tree import altered
from gbeam.constants import ModelKind
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.guards.checks import choice
from gbeam.guards.kinds import kinds
from gbeam.guards.quantities import Angle, OfKind, Ratio, Seconds
from gbeam.mechanics.models import MODEL_KINDS
from gbeam.mechanics.tree.joints import SLIDES
from gbeam.mechanics.tree.system import System
from gbeam.motion.hub import Hub
from gbeam.motion.profiles.piecewise import constant
from gbeam.motion.protocol import notes_on
from gbeam.printable import advise
from gbeam.progress import Progress
from gbeam.questions import motion_of
from gbeam.results.searches import ShapedCommand
from gbeam.scenario.build import scenario_of
from gbeam.studies.template import template_of

_REST = 1e-9  # of the largest rate: below it at the end the goal is an angle, above it a rate
_POINTS = 401  # of a table: straight lines between them are off by 1e-4 of a smooth step
_AFTER = 1.25  # least duration of a scenario with the command, over the command's


def _drive(arguments: Mapping[str, Any]) -> tuple[bool, bool]:
    """Two truths about the command that arguments ask for: it is an effort. Its coordinate is a displacement."""
    case = template_of(arguments["scenario"], arguments.get("overrides", ())).built()
    command = driven_of(case, arguments.get("motion"), arguments.get("joint"))
    return command.hub.free, slides(command.name)


@kinds(
    limit=lambda arguments: DRIVES[_drive(arguments)][1],
    rate=lambda arguments: "speed" if _drive(arguments)[1] else "angular rate",
)
@typed
def shape_hub_command(
    scenario: str | os.PathLike[str] | Case,
    *,
    angle: Angle | None = None,
    rate: float | None = None,
    distance: Annotated[float | None, OfKind("length")] = None,
    duration: Seconds | None = None,
    limit: float = np.inf,
    robust: Ratio = 0.0,
    check: ModelKind | Literal[""] = "",
    motion: str | None = None,
    joint: str | None = None,
    point: str | None = None,
    overrides: Sequence[str] = (),
    progress: Progress = None,
) -> ShapedCommand:
    """Find the command of a scenario's hub, or of a joint of its system, that leaves the least vibration.

    It is that of :func:`gbeam.shape_command`.

    Parameters
    ----------
    scenario : path or Case
        The scenario's file, or a case, of :func:`gbeam.read_scenario` or made in Python.
    angle, rate, distance : float, optional
        To turn by, rad, to reach, rad/s, or of what slides m/s, or to move by, m; by default what the scenario's own
        rate does. A free hub, or what an effort drives, needs one of them.
    duration : float, optional
        Of the command, s; by default that of the scenario's own.
    limit : float
        On the torque, N m, or the angular acceleration, rad/s²; of what slides the force, N, or acceleration, m/s².
    robust : float
        Share by which all frequencies may be wrong.
    check : str
        Kind of model that the commands are run on, such as exact; by default the scenario's.
    motion : str, optional
        Which hub, or which flight of constant acceleration carries a system, where there are several.
    joint, point : str, optional
        Of a system what moves, ``joint.angle`` or ``joint.displacement``, where more than one has a rate or a drive,
        and the point that is to rest, as of :func:`gbeam.shape_command`.
    overrides : sequence of str
        Changes of the scenario, such as ``beam.length=250 mm``.
    progress : callable or bool, optional
        Called with what is being done and the fraction of it done; True shows a bar.

    Returns
    -------
    ShapedCommand

    Raises
    ------
    InputError
        If the scenario is wrong, has no such hub or leaves the numbers of shapes out; or as
        :func:`gbeam.shape_command` does.
    ComputationError
        If no command within the limit does it in that time, or a run diverges.

    Examples
    --------
    >>> hub = "examples/hubbeam2009_slew_2p8.toml"
    >>> gb.shape_hub_command(hub, duration=20.0).outcome
    'done'
    """
    command = driven_of(template_of(scenario, overrides).built(), motion, joint)
    case, name, hub, where = command.case, command.name, command.hub, command.where
    case.refuse_automatic("is left out, and a command knows the modes of given shapes", "give it")
    if check and check not in MODEL_KINDS:
        raise InputError("--check", f"is {check!r}", advise(check, MODEL_KINDS))
    if check and not any(body.source for body in case.system.flexible.values()):
        raise InputError(
            "--check", f"is {check!r}, and no body is a beam, whose model could be another", "leave it out"
        )
    if angle is None and rate is None and distance is None:
        angle, rate = _goal(hub, where)
        if slides(name):
            angle, distance = None, angle
    if duration is None:
        duration = _end(hub, where)
    tested = replace(case, system=convert_models(case.system, check)).subject if check else None
    try:
        shaped = shape_command(
            case.subject, command.drive, angle=angle, rate=rate, distance=distance, duration=duration, limit=limit,
            robust=robust, check=tested, point=point, progress=progress,
        )  # fmt: skip
    except InputError as error:
        raise error.at(command.gravity) if error.where == "gravity" else error from None
    return replace(shaped, motion=name, notes=command.notes, provenance=case.provenance)


@dataclass(frozen=True)
class Driven:
    """Hub, or coordinate of a joint, that a command drives: `drive` as :func:`shape_command` takes it, in a case."""

    name: str
    hub: Hub  # with the rate of the scenario's own command, or free
    drive: Hub | str
    where: str  # place of the command in the scenario
    gravity: str  # place of what says gravity
    case: Case
    notes: tuple[str, ...]


def driven_of(case: Case, motion: str | None, joint: str | None) -> Driven:
    """Hub or joint that a command drives: a hub that turns a single body, or a coordinate of a joint of a system."""
    notes = notes_on(case.motions)
    if case.system.only_structure is None:
        name, hub = driven_joint(case.system, joint)
        gravity = f"motion.{motion_of(case.motions, motion)}" if case.motions else "system.gravity"
        grounded = replace(case, system=_grounded(case, motion), motions={}, tracks={}, accept={})
        return Driven(name, hub, name, f"joints.{name}", gravity, grounded, notes)
    if joint is not None:
        fix = "name it by --motion"
        raise InputError("--joint", f"is {joint!r}, and {case.system.order[0]} is on a hub, without joints", fix)
    name, hub = hub_of(case, motion)
    # The hub with its mounting, at rest: without torque, or at rate zero.
    hub_at_rest: Hub = altered(hub, **{"torque" if hub.free else "rate": constant(0.0)})
    return Driven(name, hub, hub_at_rest, f"motion.{name}", f"motion.{name}.gravity", case, notes)


def hub_of(case: Case, name: str | None) -> tuple[str, Hub]:
    """Name and hub of a case, chosen by `name` if there are several. InputError if there is none."""
    hubs = {key: motion for key, motion in case.motions.items() if isinstance(motion, Hub)}
    if not hubs:
        raise InputError("motion", "has no hub", "add a motion of kind hub")
    if name is not None and name not in hubs:
        raise InputError("--motion", f"is {name!r}", f"name one of {', '.join(hubs)}")
    chosen = motion_of(hubs, name)
    return chosen, hubs[chosen]


def driven_joint(system: System, name: str | None) -> tuple[str, Hub]:
    """Coordinate that a command moves, `name` or the only one driven, and a hub with its rate, or a free one."""
    commands = {}
    for owner, joint in system.joints.items():
        for coordinate in (*joint.rates, *joint.efforts):
            commands[f"{owner}.{coordinate}"] = joint.rates.get(coordinate)
    if name is None:
        if len(commands) != 1:
            fix = 'give a joint a rate or an effort, such as "0 N m"'
            if commands:
                fix = f"choose from {', '.join(commands)}"
            raise InputError("--joint", "is missing: it says what moves", fix)
        name = next(iter(commands))
    choice("--joint", name, movable(system))
    rate = commands.get(name)
    return name, Hub(radius=0.0, inertia=1.0) if rate is None else Hub(radius=0.0, rate=rate)


def slides(coordinate: str) -> bool:
    """True if a coordinate, ``joint.displacement``, is a displacement; false for the name of a hub."""
    joint, _, moved = coordinate.rpartition(".")
    return bool(joint) and moved in SLIDES


def _grounded(case: Case, name: str | None) -> System:
    """The system on the ground, with gravity in place of the constant load of the motion that carries it.

    InputError unless that motion has a constant acceleration and does not turn.
    """
    if not case.motions:
        return case.system
    chosen = motion_of(case.motions, name)
    settings = case.settings_of(chosen)
    times = np.linspace(settings.start, settings.start + settings.duration, _POINTS)
    base = case.motions[chosen].base(times)
    load = np.asarray(base.a_WO_B)
    largest_rate = max(float(np.abs(rates).max()) for rates in (base.w_WB_B, base.alpha_WB_B))
    if largest_rate > 0 or np.ptp(load, axis=0).max() > _REST * max(float(np.abs(load).max()), 1e-300):
        fix = "give a flight of constant acceleration, or leave it out"
        raise InputError(f"motion.{chosen}", "shakes or turns the system, which no command undoes", fix)
    return replace(case.system, gravity=tuple((-load[0]).tolist()))


def _end(hub: Hub, name: str) -> float:
    """Time of the last corner of the scenario's own command, s."""
    end = float(np.max(hub.corners(np.inf), initial=0.0))
    if not end > 0:
        raise InputError("--duration", f"is missing, and {name} has no end of its own", "give it, in s")
    return end


def _goal(hub: Hub, name: str) -> tuple[float | None, float | None]:
    """Angle to turn by, or rate to reach, of the scenario's own command. The other one is None."""
    if hub.free or hub.rate is None:
        fix = "give --angle or --rate"
        raise InputError("--angle", f"is missing, and the torque of {name} says of no angle or rate", fix)
    end = _end(hub, name)
    rates = np.asarray(hub.rate(np.linspace(0.0, end, _POINTS)))
    if abs(rates[-1]) > _REST * np.abs(rates).max():
        return None, float(rates[-1])
    return float(hub.angle(end)), None


def scenario_with(
    command: ShapedCommand, scenario: str | os.PathLike[str] | Case, overrides: Sequence[str] = ()
) -> str:
    """Return a scenario, as JSON, in which a table of the shaped command drives the hub or joint."""
    base = scenario_of(scenario, overrides)
    assert base.source is not None  # it was read from a file
    data: dict[str, Any] = json.loads(json.dumps(base.source.data))
    times = np.linspace(0.0, command.duration, _POINTS)
    table = {"profile": "table", "times": times.tolist(), "values": np.asarray(profile_of(command)(times)).tolist()}
    if "joints" in data:
        name, _, coordinate = command.motion.rpartition(".")
        key = "effort" if command.kind in ("torque", "force") else "rate"
        command_before = data["joints"][name].get(key)
        several = isinstance(command_before, dict) and "profile" not in command_before
        data["joints"][name][key] = {**command_before, coordinate: table} if several else table
    else:
        data["motion"] = {command.motion: {**data["motion"][command.motion], command.kind: table}}
    lasting = max(base.response.duration or 0.0, _AFTER * command.duration)
    data["response"] = {**data.get("response", {}), "duration": lasting, "residual_from": command.duration}
    data.pop("sweep", None)
    return json.dumps(data, indent=1)
