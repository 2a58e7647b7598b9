"""Conveniences of a case whose system is one body on the base."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated, Any, Self

from gbeam.arrays.types import Numbers
from gbeam.errors import InputError
from gbeam.guards.arguments import typed_methods
from gbeam.guards.quantities import OfKind
from gbeam.mechanics.assembly import assemble, model_of, stations_asked
from gbeam.mechanics.models import Model
from gbeam.mechanics.structure import Structure
from gbeam.mechanics.tree.system import System
from gbeam.printable import advise
from gbeam.structure.beam import Beam


def structure_of(beam: Beam, model: Model, stations: Sequence[float] = ()) -> Structure:
    """Assemble the structure of a beam in a model. InputErrors have their place in the scenario."""
    try:
        return assemble(beam, model, stations)
    except InputError as error:
        raise error.within("response" if error.where.startswith("stations") else "beam") from None


def points_of(system: System) -> tuple[str, ...]:
    """Names of the points that results have: ``tip`` of a body alone on the base, else ``body.point``."""
    return system.points if system.only_structure is None else system.points_of(system.order[0])[:-1]


def refuse_no_point(system: System, where: str, name: str) -> tuple[str, int]:
    """Body and index of a point by its name in results; InputError at `where` if there is none."""
    if system.only_structure is None:
        return system.point(where, name)
    names = points_of(system)
    if name not in names:
        raise InputError(where, f"is no point: {name!r}", advise(name, names))
    return system.order[0], names.index(name)


@typed_methods
class OneBody:
    """A case as the only body of its system sees it."""

    system: System

    @property
    def subject(self) -> Structure | System:
        """Argument of the analyses: the structure of the only body where nothing but its base moves it, else the
        system. Nothing but this property says which of the two a case is computed as.
        """
        return self.system if self.system.only_structure is None else self.system.only_structure

    @property
    def only_beam(self) -> Structure | None:
        """Structure of the only body, where that is a beam and nothing but its base moves it."""
        body = self.system.only_structure
        return None if body is None or body.source is None else body

    def require_beam(self) -> Structure:
        """Return the structure of the beam that the base holds by its root; InputError where the case has none."""
        if self.only_beam is None:
            body, names = self.system.only_structure, ", ".join(self.system.order)
            words = f"{names} is {body.kind}" if body is not None else f"it is of {names} on joints"
            raise InputError("case", f"needs a beam that the base holds by its root, and {words}", "give one [beam]")
        return self.only_beam

    @property
    def beam(self) -> Beam:
        """The only beam; InputError where the case is of another system."""
        beam: Any = self.require_beam().source
        return beam.beam

    @property
    def model(self) -> Model:
        """Model of the only beam; InputError where the case is of another system."""
        return model_of(self.require_beam())

    @property
    def stations(self) -> tuple[float, ...]:
        """Positions of output of the only beam besides its named points, m; InputError where there is no such beam."""
        return stations_asked(self.require_beam())

    def remade(
        self,
        *,
        beam: Beam | None = None,
        model: Model | None = None,
        stations: Annotated[Numbers | None, OfKind("length")] = None,
    ) -> Self:
        """Return the case with another beam, model or stations in place of its only one's.

        Parameters
        ----------
        beam : Beam, optional
        model : Model, optional
        stations : sequence of float, optional
            Positions of output from the root besides the tip, m.
        """
        body = structure_of(
            self.beam if beam is None else beam,
            self.model if model is None else model,
            self.stations if stations is None else tuple(stations),
        )
        return replace(self, system=System.of(body, self.system.order[0]))  # type: ignore[type-var]
