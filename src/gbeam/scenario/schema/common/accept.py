"""[motion.NAME.accept]: how well a centrifuge must reproduce its flight."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, model_validator

from gbeam.scenario.schema.common.fields import Quantity, Table, refuse, wrong

Share = Annotated[float, Quantity("ratio", "positive")]


class Accept(Table):
    """Limits of the differences from flight; one that is not kept ends in exit status 1."""

    tip: Share | None = Field(default=None, description="largest change of the tip's peak displacement, such as 2 %")
    root_force: Share | None = Field(default=None, description="the same of the force at the root")
    root_moment: Share | None = Field(default=None, description="the same of the moment at the root")
    stress: Share | None = Field(default=None, description="the same of the largest stress")
    peaks: Share | None = Field(
        default=None, description="largest error of any peak of the flight's load above idle, as a vector"
    )
    spread: Share | None = Field(
        default=None,
        description="largest difference of the load at the root or the tip from the control point's at these peaks",
    )
    followed: Share | None = Field(default=None, description="least share of the flight's time that must be followed")
    tolerance: Share | None = Field(
        default=None,
        description="difference from the flight's load, over its peak, within which it counts as followed; 5 % if left "
        "out",
    )

    @model_validator(mode="after")
    def _possible(self) -> Accept:
        if self.followed is not None and self.followed > 1:
            refuse([(("followed",), wrong("{value} is more than all of the time", 'give "100 %" or less'))])
        return self

    @property
    def given(self) -> dict[str, float]:
        """What is given, by name."""
        return {name: value for name, value in self if value is not None}
