"""A case: one beam in one model, the environments it is put into, and how its response is computed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

from gbeam.analysis.response.settings import ResponseSettings
from gbeam.arrays.tree import Value
from gbeam.errors import InputError
from gbeam.guards.arguments import typed
from gbeam.mechanics.assembly import assemble
from gbeam.mechanics.models import Model
from gbeam.mechanics.structure import Structure
from gbeam.motion.protocol import Motion
from gbeam.results.provenance import Provenance
from gbeam.structure.beam import Beam

if TYPE_CHECKING:
    from gbeam.scenario.schema.scenario import Scenario


@typed
@dataclass(frozen=True, eq=False)
class Case(Value):
    """What a scenario describes, as objects.

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
        What the case was read from, of which studies make others; None of one that is made, or changed, by hand.
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
