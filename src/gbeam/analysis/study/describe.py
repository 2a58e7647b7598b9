"""What a case means, before anything is simulated."""

from __future__ import annotations

import numpy as np

from gbeam.analysis.study.case import Case
from gbeam.guards.arguments import typed
from gbeam.mechanics.fields.basis import quadrature
from gbeam.mechanics.plausibility import input_warnings
from gbeam.motion import Flight
from gbeam.results.description import Description

MODES = 6  # natural frequencies at most


@typed
def describe(case: Case) -> Description:
    """Describe a case: the beam's mass, its frequencies at rest, motions, records, and the response's settings.

    Parameters
    ----------
    case : Case
        From :func:`gbeam.read_scenario`, or made by hand.

    Returns
    -------
    Description

    Raises
    ------
    InputError
        If the beam does not fit its model, with its place in the scenario.
    """
    structure, beam, settings = case.assemble(), case.beam, case.response
    span = settings.start, settings.start + settings.duration
    doubts = [input_warnings(structure, motion, name=name, span=span) for name, motion in case.motions.items()]
    frequencies, modes = structure.rest
    # Which group of coordinates moves most says along which axis a mode bends.
    groups = np.repeat(("axial", "y", "z"), structure.counts)
    rule = quadrature(beam.length, 4, beam.section.stations)
    return Description(
        title=case.title,
        length=beam.length,
        mass=beam.material.density * float(np.sum(beam.section.at(rule.node).area * rule.weight)),
        bodies=tuple((body.at, body.mass) for body in beam.masses),
        model=case.model.kind,
        counts=case.model.counts,
        frequency=np.asarray(frequencies)[:MODES] / (2 * np.pi),
        direction=tuple(str(groups[i]) for i in np.abs(modes[: len(groups)]).argmax(axis=0)[:MODES]),
        motions={name: motion.kind for name, motion in case.motions.items()},
        tracks=dict(case.tracks),
        records={
            name: motion.record
            for name, motion in case.motions.items()
            if isinstance(motion, Flight) and motion.record is not None
        },
        start=settings.start,
        duration=settings.duration,
        step=settings.step,
        integrator=settings.integrator,
        warnings=tuple(dict.fromkeys(warning for each in doubts for warning in (*each, *settings.warnings))),
    )
