"""[motion.NAME.accept]: how well a centrifuge must reproduce its flight; its limits are those that are judged."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, Tag, create_model

from gbeam.results.imitation.criteria import RULES
from gbeam.scenario.schema.common.fields import ONE_OR_LIST, Quantity, Table

Share = Annotated[float, Quantity("ratio", "positive")]
Ratio = Annotated[float, Quantity("ratio", "positive")]
Level = Annotated[float, Quantity("amplitude ratio", "positive")]
Ratios = Annotated[Annotated[Ratio, Tag("one")] | Annotated[tuple[Ratio, Ratio], Tag("list")], ONE_OR_LIST]
Levels = Annotated[Annotated[Level, Tag("one")] | Annotated[tuple[Level, Level], Tag("list")], ONE_OR_LIST]

_TYPES: dict[str, Any] = {"most": Share, "least": Share, "ratio": Ratios, "level": Levels}
_FIELDS: dict[str, Any] = {
    rule.name: (_TYPES[rule.kind] | None, Field(default=None, description=rule.words)) for rule in RULES.values()
}
_Limits = create_model("_Limits", __base__=Table, **_FIELDS)


class Accept(_Limits):  # type: ignore[misc, valid-type]
    """Limits of the differences from flight; one that is not kept ends in exit status 1."""

    tolerance: Share | None = Field(
        default=None,
        description="difference from the flight's load within which it counts as followed, as a share; 5 % if left out",
    )
    tolerance_of: Literal["peak", "instant"] | None = Field(
        default=None,
        description="what tolerance is a share of. peak: the flight's largest load, as where it is left out; instant: "
        "its load at each time",
    )

    @property
    def given(self) -> dict[str, Any]:
        """What is given, by name."""
        return {name: value for name, value in self if value is not None}
