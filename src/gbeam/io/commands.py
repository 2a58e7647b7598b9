"""Axis motions as files for a machine's controller: CSV and MATLAB's MAT, with what the numbers mean beside them."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from scipy.io import savemat

from gbeam.printable import storable
from gbeam.results.comparison import MachinePlan
from gbeam.results.machine import Commands
from gbeam.results.provenance import Provenance
from gbeam.results.result import part_words

_UNITS = {"angle": "rad", "rate": "rad_per_s", "acceleration": "rad_per_s2"}
_STILL = 1e-9  # rad/s, rad/s²: what is slower stands still
COLUMNS = ("time_s", *(f"{quantity}{i}_{unit}" for quantity, unit in _UNITS.items() for i in (1, 2, 3)))
FRAME = (
    "Frame: a1 points outward along the arm, a2 along its motion for a positive rate1, Z up.",
    "Axis 1 turns the arm about Z, counterclockwise seen from above; its angle is zero at the first sample.",
    "Axis 2 (yaw, parallel to axis 1) turns the gimbal at the arm's end, positive about Z; it is zero where the beam's",
    "x axis, from the root to the tip, points outward along a1.",
    "Axis 3 (roll) turns the specimen about its x axis, positive by the right-hand rule; it is zero where the beam's y",
    "axis is horizontal and its z axis points up.",
    "Angles are continuous: they are not folded into one turn. Rates and accelerations are their derivatives.",
)


def write_commands(plan: MachinePlan, commands: Commands, folder: Path) -> list[Path]:
    """Write the commands of one machine as CSV and MAT, with the frame, units and signs of their numbers in both."""
    lines_above = header(plan, commands)
    csv, mat = folder / f"commands_{plan.name}.csv", folder / f"commands_{plan.name}.mat"
    table = np.column_stack([commands.time, commands.angle, commands.rate, commands.acceleration])
    lines = [*(f"# {line}" for line in lines_above), ",".join(COLUMNS)]
    with csv.open("w", encoding="utf-8", newline="\n") as file:
        file.write("\n".join(lines) + "\n")
        # %.12g keeps the angle of axis 1 to a microradian over a thousand turns.
        np.savetxt(file, table, fmt="%.12g", delimiter=",")
    savemat(
        mat,
        {
            "time": commands.time[:, None],
            "angle": commands.angle,
            "rate": commands.rate,
            "acceleration": commands.acceleration,
            "sample": commands.sample,
            "arm": plan.arm,
            "title": plan.title,
            "control_point": plan.axes.control_point if plan.axes.place is None else plan.axes.place,
            "turn": np.zeros(3) if plan.axes.turn is None else plan.axes.turn,
            "gravity": plan.gravity,
            "mounting": plan.mounting,
            "limits": _limits(plan),
            "conventions": "\n".join(lines_above),
        },
        do_compression=True,
    )
    return [csv, mat]


def header(plan: MachinePlan, commands: Commands) -> list[str]:
    """Lines above the commands: what machine they are for, and the frame, units, zeros and signs of their numbers."""
    first, last = plan.axes.span
    lines = [
        f"gbeam: axis motions of {plan.name}" + (f", which imitates {plan.tracks}" if plan.tracks else ""),
        *([f"Scenario: {plan.title}"] if plan.title else []),
        f"Gravity {plan.gravity:g} m/s^2 on the machine is a part of the load, which is specific force."
        if plan.gravity
        else "NO GRAVITY: the load is acceleration; a machine on the earth adds its gravity of 9.80665 m/s^2.",
        _mounting_words(plan),
        _limit_words(plan),
        f"Arm {plan.arm:g} m; sample time {commands.sample:g} s; {len(commands.time)} samples.",
        f"Time is the flight's: it lasts from {first:.6g} to {last:.6g} s."
        if plan.whole is None
        else f"Time is the flight's, of which this is a PART: {part_words(plan.axes.span, plan.whole)}.",
        f"Beginning, {_state(commands, 0)}.",
        f"End, {_state(commands, -1)}.",
        "Units: time s, angles rad, rates rad/s, accelerations rad/s^2.",
        *FRAME,
    ]
    lines[1:1] = [
        f"TARGET OTHER THAN FLIGHT {start:.3f} to {end:.3f} s: {reason}" for start, end, reason in plan.axes.episodes
    ]
    if plan.provenance is not None:
        lines += origin_lines(plan.provenance)
    if plan.outcome != "done":
        lines.insert(1, f"{plan.outcome.upper()}: {plan.message}")
    return lines


def _mounting_words(plan: MachinePlan) -> str:
    """Place and turn of the specimen in the machine, in words."""
    place, turn = plan.axes.place, plan.axes.turn
    point = f"{plan.axes.control_point:g} m from the root along the beam"
    if place is not None:
        point = "({:g}, {:g}, {:g}) m from the root".format(*place)
    turned = (
        ""
        if turn is None
        else "; specimen turned from axis 3's axes by the rotation vector ({:g}, {:g}, {:g}) rad".format(*turn)
    )
    return f"Control point {point}; mounting {plan.mounting}{turned}."


def _limits(plan: MachinePlan) -> dict[str, list[float]]:
    """Limits by quantity: one for each of axes 1, 2, 3; of the power one, of the arm."""
    allowed: dict[str, list[float]] = {}
    for use in plan.axes.limits:
        allowed.setdefault(use.quantity, []).append(use.allowed)
    return allowed


def _limit_words(plan: MachinePlan) -> str:
    uses = [use for use in plan.axes.limits if math.isfinite(use.allowed)]
    words = [f"{use.axis} {use.quantity} {use.allowed:.6g} {use.unit}" for use in uses]
    return f"Limits: {', '.join(words)}." if words else "Limits: none are given."


def origin_lines(provenance: Provenance) -> list[str]:
    """Lines on the origin of the numbers: version, command, scenario and records."""
    provenance, environment = provenance.stated()
    records = [f"Record of {record.motion}: {record.file}, SHA-256 {record.sha256}." for record in provenance.records]
    origin = f"Made by gbeam {environment.gbeam}, Python {environment.python}, {environment.platform}"
    lines = [f"{origin}: {provenance.command}", f"Scenario SHA-256 {provenance.sha256}.", *records]
    return [storable(line) for line in lines]


def _state(commands: Commands, sample: int) -> str:
    """State of the axes at the first sample (0) or the last (-1): a controller brings them there, or takes over."""
    rate, acceleration = commands.rate[sample], commands.acceleration[sample]
    angles = ", ".join(f"axis {i + 1} at {commands.angle[sample, i]:.9g} rad" for i in (1, 2))
    is_moving = np.abs(np.concatenate([rate, acceleration])).max() > _STILL
    if not is_moving:
        return f"{commands.time[sample]:.6g} s: STANDSTILL; {angles}"
    rates = ", ".join(
        f"axis {i + 1} at {w:.9g} rad/s and {a:.9g} rad/s^2"
        for i, (w, a) in enumerate(zip(rate, acceleration, strict=True))
    )
    return f"{commands.time[sample]:.6g} s: TURNING; {angles}; {rates}"
