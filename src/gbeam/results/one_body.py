"""Conveniences of results about systems in which one body deforms: what stands under its name, without the name."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from gbeam.arrays.types import Numbers
from gbeam.errors import InputError
from gbeam.results.parts import Loads, Peaks
from gbeam.results.result import Complex, Floats
from gbeam.results.solids import SolidStress, SpecimenLoads


class OneBody:
    """A result as the only body that deforms sees it; each property raises InputError where there are others."""

    bodies: Mapping[str, Any]

    @property
    def body(self) -> Any:
        """Entry of the only body that deforms."""
        names = [*self.bodies]
        if not names:
            raise InputError("bodies", "are rigid, and this is of one that deforms", "ask for points")
        if len(names) > 1:
            problem = f"are {', '.join(names)}, and this is of one"
            raise InputError("bodies", problem, f"ask one of them: bodies[{names[0]!r}]")
        return self.bodies[names[0]]

    @property
    def model(self) -> str:
        """Kind of the body's model."""
        return self.body.model

    @property
    def stations(self) -> Floats:
        """Positions along the body from its root, (s,) m. The last is the tip."""
        return self.body.stations


class DeflectedBody(OneBody):
    """A result with the displacement of a body, likewise. Over time its arrays begin with an axis of times."""

    @property
    def displacement(self) -> Floats:
        """Displacement of the stations relative to the body's root, (..., s, 3) m."""
        return self.body.displacement

    @property
    def tip(self) -> Floats:
        """Displacement of the tip, the last station, (..., 3) m."""
        return self.body.tip

    @property
    def loads(self) -> Loads | None:
        """Forces, moments and stresses of the body's sections, or None where they are not computed."""
        return self.body.loads

    @property
    def solid(self) -> SolidStress | None:
        """Stress of the body, where it is a solid; else None."""
        return self.body.solid

    @property
    def specimen(self) -> SpecimenLoads | None:
        """Loads of the body, where it is a rigid specimen; else None."""
        return self.body.specimen


class RestingBody(DeflectedBody):
    """A result at rest, likewise."""

    @property
    def strain_energy(self) -> float:
        """Strain energy of the body, J."""
        return self.body.strain_energy


class MovedBody(DeflectedBody):
    """A result over time, likewise."""

    @property
    def peaks(self) -> Peaks:
        """Largest values of the body's displacement and loads, between all steps."""
        return self.body.peaks

    def strain_at(self, point: str, along: Numbers = (1.0, 0.0, 0.0)) -> Floats:
        """Return what a strain gauge at a named `point` of the body reads `along` a direction, (t,)."""
        return self.body.strain_at(point, along)


class ShapedBody(OneBody):
    """A result with shapes of a body, likewise."""

    @property
    def shape(self) -> Complex:
        """Displacement of the stations relative to the body's root, (k, s, 3)."""
        return self.body.shape

    @property
    def twist(self) -> Complex | None:
        """Angle of the sections about the body's axis, (k, s) rad/m, or None of a model without twist."""
        return self.body.twist

    @property
    def equilibrium(self) -> Floats:
        """Displacement of the stations about which the body vibrates, (s, 3) m."""
        return self.body.equilibrium
