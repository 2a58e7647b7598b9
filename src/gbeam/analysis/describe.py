"""Meaning of a case before any run: its bodies, joints and forces, motions, records and settings."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from gbeam.analysis.case import Case
from gbeam.analysis.one_body import points_of
from gbeam.analysis.outline import labels_of
from gbeam.analysis.system.mobility import mobility_in_words
from gbeam.guards.arguments import typed
from gbeam.mechanics.assembly import model_of
from gbeam.mechanics.fields.basis import FAMILIES
from gbeam.mechanics.plausibility import input_warnings
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.joints import GROUND, Joint
from gbeam.mechanics.tree.rigid_body import RigidBody
from gbeam.mechanics.tree.system import System
from gbeam.motion.arm import level_of
from gbeam.motion.flight import Flight
from gbeam.motion.protocol import kind_of, notes_on
from gbeam.results.description import (
    BodyDescription,
    ControllerDescription,
    Description,
    ForceDescription,
    JointDescription,
    MassOnBeam,
)
from gbeam.structure.supports import Label

MODES = 6  # natural frequencies at most


@typed
def describe(case: Case) -> Description:
    """Describe a case: masses, frequencies of the bodies, joints, forces, motions, records, and settings.

    Parameters
    ----------
    case : Case
        From :func:`gbeam.read_scenario`, or made by hand.

    Returns
    -------
    Description

    Examples
    --------
    >>> case = gb.read_scenario("examples/f16_8g_turn.toml")
    >>> description = gb.describe(case)
    >>> print(f"{description.mass:.4f} kg, {description.duration} s, {description.bodies['beam'].counts}")
    0.0648 kg, 15.99 s, {'axial': 1, 'y': 3, 'z': 3}
    """
    system, settings = case.system, case.response
    masses, centres = zip(*(_mass(system.bodies[name]) for name in system.order), strict=True)
    total, roots = float(sum(masses)), zip(system.start_state.roots, centres, strict=True)
    moment = np.einsum("b,bi->i", masses, [root.p + root.R @ centre for root, centre in roots])
    over_time: dict[str, Any] = {}
    doubts = [*_doubts(case), *(() if settings is None else settings.warnings)]
    if settings is not None:
        common = () if case.spans else ("start", "duration")
        over_time = {key: getattr(settings, key) for key in (*common, "step", "integrator")}
    flights = {name: motion for name, motion in case.motions.items() if isinstance(motion, Flight)}
    levels = {name: level_of(motion) for name, motion in case.motions.items()}
    return Description(
        title=case.title,
        mass=total,
        centre=moment / total if total else np.full(3, np.nan),
        bodies={name: _body(system, name) for name in system.order},
        loops=mobility_in_words(system) if system.closing else "",
        joints={name: _joint(joint) for name, joint in system.joints.items() if joint.steps or joint.on != GROUND},
        forces={name: ForceDescription(force.on, force.follower) for name, force in system.forces.items()},
        controllers={
            name: ControllerDescription(tuple(law.measure), tuple(law.drive), law.sample, law.delay)
            for name, law in system.controllers.items()
        },
        gravity=None if system.gravity is None else np.asarray(system.gravity, dtype=float),
        motions={name: kind_of(motion) for name, motion in case.motions.items()},
        tracks=dict(case.tracks),
        spans=dict(case.spans),
        levels={name: level for name, level in levels.items() if level is not None},
        scales={name: flight.level_factor for name, flight in flights.items() if flight.level_factor is not None},
        records={name: flight.record for name, flight in flights.items() if flight.record is not None},
        notes=notes_on({name: motion for name, motion in case.motions.items() if name not in flights}),
        warnings=tuple(dict.fromkeys(doubts)),
        **over_time,
    )


def _doubts(case: Case) -> tuple[str, ...]:
    """Warnings of what is implausible in the bodies and, where one is alone on its base, in the motions."""
    body = case.system.only_structure
    if body is None:
        return case.system.warnings

    def span(name: str) -> tuple[float, float]:
        if case.response is None:
            return case.start, case.start
        settings = case.settings_of(name)
        return settings.start, settings.start + settings.duration

    if not case.motions:
        return tuple(input_warnings(body))
    by_motion = [input_warnings(body, motion, name=name, span=span(name)) for name, motion in case.motions.items()]
    return tuple(doubt for doubts in by_motion for doubt in doubts)


def _mass(body: RigidBody | Structure) -> tuple[float, Any]:
    """Mass of a body, kg, and its centre of mass (3,) m from the root, undeformed."""
    if isinstance(body, RigidBody):
        return body.mass, np.asarray(body.centre, dtype=float)
    mass, *moment = (float(value) for value in body.coefficients.rigid[:4])
    return mass, np.array(moment) / mass


def _body(system: System, name: str) -> BodyDescription:
    """Describe a body: its mass and points and, if it deforms, its frequencies and what its model has."""
    body = system.bodies[name]
    points = system.points_of(name) if system.only_structure is None else points_of(system)
    mass, centre = _mass(body)
    described: dict[str, Any] = {"mass": mass, "centre": centre, "points": points}
    if isinstance(body, RigidBody):
        return BodyDescription(kind="rigid", coordinates=0, **described)
    frequencies, modes = body.rest
    described |= {"kind": body.kind, "coordinates": body.size}
    described["frequency"] = np.asarray(frequencies)[: min(MODES, body.resolved)] / (2 * np.pi)
    described["supports"] = _joined(labels_of(body))
    if body.recovery is not None:
        described["clamps"] = body.recovery.clamps
    if body.source is not None:
        beam, counts = body.source.beam, model_of(body).counts
        # A mode bends along the axis of the group of coordinates that moves most.
        groups = np.repeat(FAMILIES, body.counts)
        described |= {
            "length": float(beam.length),
            "masses": tuple(MassOnBeam(mass.at, mass.mass) for mass in beam.masses),
            "counts": {way: n for way, n in zip(FAMILIES, counts, strict=True) if n or way in FAMILIES[:3]},
            "direction": tuple(str(groups[i]) for i in np.abs(modes[: len(groups)]).argmax(axis=0)[:MODES]),
        }
    return BodyDescription(**described)


def _joined(labels: Iterable[Label]) -> dict[str, str]:
    """Join words on what supports hold by the places of these."""
    words = dict[str, str]()
    for label in labels:
        words[label.name] = f"{words[label.name]}; {label.words}" if label.name in words else label.words
    return words


def _joint(joint: Joint) -> JointDescription:
    """Describe a joint: which of its coordinates move freely, which an effort drives, and which are prescribed."""
    driven, prescribed = tuple(joint.efforts), tuple(joint.rates)
    moving = (kind for kind in joint.rate_names if kind not in (*driven, *prescribed))
    return JointDescription(joint.kind, joint.body, joint.on, tuple(moving), driven, prescribed)
