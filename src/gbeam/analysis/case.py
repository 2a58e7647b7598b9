"""A case: one beam in one model, the environments it is put into, and how its response is computed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from gbeam.analysis.response.settings import ResponseSettings
from gbeam.arrays.tree import Value
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.mechanics.assembly import assemble
from gbeam.mechanics.fields.basis import FAMILIES, quadrature
from gbeam.mechanics.models import Model
from gbeam.mechanics.plausibility import input_warnings
from gbeam.mechanics.structure import Structure
from gbeam.motion import Flight
from gbeam.motion.protocol import Motion
from gbeam.results.description import Description
from gbeam.results.provenance import Provenance
from gbeam.structure.beam import Beam

if TYPE_CHECKING:
    from gbeam.scenario.schema.scenario import Scenario


@typed
@dataclass(frozen=True, eq=False)
class Case(Value):
    """Objects that a scenario describes.

    Parameters
    ----------
    title : str
    beam : Beam
    model : Model
    motions : mapping of str to motion
        By name, in the scenario's order.
    response : ResponseSettings
    tracks : mapping of str to str
        Name of the flight that each centrifuge tracks.
    stations : tuple of float
        Positions of output from the root besides the tip, m.
    accept : mapping of str to mapping
        By the centrifuge's name, the limits that decide whether it is accepted, and ``tolerance`` and ``tolerance_of``:
        see :func:`gbeam.compare`.
    provenance : Provenance, optional
        Of the scenario; results of the whole case have it.

    Attributes
    ----------
    scenario : Scenario or None
        The scenario that the case was read from; None of one that is made, or changed, in Python.

    Examples
    --------
    >>> case = gb.read_scenario("examples/f16_8g_turn.toml")
    >>> list(case.motions)
    ['flight', 'centrifuge']
    >>> case.tracks["centrifuge"]
    'flight'
    """

    title: str
    beam: Beam
    model: Model
    motions: Mapping[str, Motion]
    response: ResponseSettings
    tracks: Mapping[str, str] = field(default_factory=dict)
    stations: tuple[float, ...] = ()
    accept: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    provenance: Provenance | None = None
    # Not an argument, so that dataclasses.replace leaves it behind.
    scenario: Scenario | None = field(default=None, init=False, repr=False, compare=False)

    def __repr__(self) -> str:
        motions = ", ".join(f"{name}: {motion.kind}" for name, motion in self.motions.items())
        return f"Case({self.title!r}, {self.model.kind}, {{{motions}}}, {self.response.duration:g} s)"

    def assemble(self, stations: ArrayLike | None = None) -> Structure:
        """Put the beam into its model.

        Parameters
        ----------
        stations : (s,), optional
            Positions of output from the root besides the tip, m; by default the case's own.

        Raises
        ------
        InputError
            If the beam does not fit its model, with its place in the scenario.
        """
        try:
            return assemble(self.beam, self.model, self.stations if stations is None else stations)
        except InputError as error:
            raise error.within("response" if error.where.startswith("stations") else "beam") from None


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

    Examples
    --------
    >>> case = gb.read_scenario("examples/f16_8g_turn.toml")
    >>> description = gb.describe(case)
    >>> print(f"{description.mass:.4f} kg, {description.duration} s, {description.counts}")
    0.0648 kg, 15.99 s, {'axial': 1, 'y': 3, 'z': 3}
    """
    structure, beam, settings = case.assemble(), case.beam, case.response
    span = settings.start, settings.start + settings.duration
    doubts = [input_warnings(structure, motion, name=name, span=span) for name, motion in case.motions.items()]
    frequencies, modes = structure.rest
    # Which group of coordinates moves most says along which axis a mode bends.
    groups = np.repeat(FAMILIES, structure.counts)
    rule = quadrature(beam.length, 4, beam.section.stations)
    return Description(
        title=case.title,
        length=beam.length,
        mass=beam.density * float(np.sum(beam.section.at(rule.node).area * rule.weight)),
        bodies=tuple((body.at, body.mass) for body in beam.masses),
        model=case.model.kind,
        counts={name: n for name, n in zip(FAMILIES, case.model.counts, strict=True) if n or name in FAMILIES[:3]},
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
