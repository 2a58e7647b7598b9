"""[model]: which displacement field, with how many shapes."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, StrictInt

from gbeam.guards.limits import SHAPES
from gbeam.scenario.schema.common.fields import Table

Count = Annotated[StrictInt, Field(ge=0, le=SHAPES)]


class Modes(Table):
    """Numbers of shape functions."""

    axial: Count = Field(description="axial shapes; for `exact` strain shapes")
    y: Count = Field(description="bending shapes along y; for `exact` rotation shapes for bending along y")
    z: Count = Field(description="bending shapes along z; for `exact` rotation shapes for bending along z")


class Model(Table):
    """The model of the beam's deformation."""

    kind: Literal["TLAM", "FOAM", "SFOAM", "CFOAM", "exact"] = Field(
        description="TLAM: linear, no foreshortening. FOAM: first order with foreshortening. SFOAM: FOAM "
        "without axial coordinates. CFOAM: FOAM's field, complete energy. exact: any rotation"
    )
    modes: Modes | None = Field(
        default=None,
        description="numbers of shapes: { axial, y, z }; where left out, `run` raises them until they are enough",
    )
    shapes: Literal["clamped-free", "adapted"] | None = Field(
        default=None,
        description="clamped-free: shapes of the bare uniform beam (for `exact`, polynomials); the default for `exact` "
        "and where `modes` are given. adapted: the modes at rest of this beam with its tapers, masses and root "
        "springs, of which fewer are needed; the default where `modes` are left out",
    )
