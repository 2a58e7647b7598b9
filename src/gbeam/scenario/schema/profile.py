"""Profiles: quantities over time, by the functions of `gbeam.motion` that make them."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Annotated, Any

from pydantic import Field

from gbeam.guards.kinds import KINDS
from gbeam.guards.quantities import Quantity, Time
from gbeam.motion.profiles.combine import Sum
from gbeam.motion.profiles.piecewise import constant, tabulated, trapezoid
from gbeam.motion.profiles.profile import Profile, smoothed
from gbeam.motion.profiles.pulse import Sine, SmoothStep
from gbeam.scenario.schema.declared import OVER_TIME, chosen, table_of
from gbeam.scenario.schema.fields import Table

_BY_WORD: dict[str, tuple[str, Callable[..., Profile]]] = {
    "constant": ("Constant", constant),
    "trapezoid": ("Trapezoid", trapezoid),
    "smooth-step": ("SmoothStep", SmoothStep),
    "sine": ("Sine", Sine),
    "table": ("Listed", tabulated),
}


class Smoothed(Table):
    """Common keys of profiles."""

    smoothing: Time = Field(
        default=0.0, description="width of the kernel that rounds the profile's corners; 0 leaves them sharp"
    )


def rounded(profile: Profile, width: float) -> Profile:
    """Return a profile whose corners are rounded over a width, s; itself where that is zero."""
    return smoothed(profile, width) if width else profile


def _rounded(make: Callable[..., Profile]) -> Callable[..., Profile]:
    """Return a function that makes a profile, whose parameters are the same, and rounds its corners."""

    @wraps(make)
    def smoothed(*, smoothing: float = 0.0, **arguments: Any) -> Profile:
        return rounded(make(**arguments), smoothing)

    return smoothed


def _summed(terms: tuple[Profile, ...]) -> Profile:
    """The sum of other profiles."""
    return Sum(terms)


def _tag(value: Any) -> Any:
    """Tag of a value: a table's profile, or ``one`` for a bare quantity, which is constant."""
    return value.get("profile") if isinstance(value, dict) else getattr(value, "profile", "one")


def _over_time(kind: str) -> Any:
    """Type of a quantity over time; its tables become names of this module, by which they are pickled."""
    tables = {
        word: table_of(_rounded(make), name=f"{name} of {kind}", tag=("profile", word), base=Smoothed, of=kind)
        for word, (name, make) in _BY_WORD.items()
    }
    listed = tuple.__class_getitem__((chosen("profile", tables), ...))
    terms = listed, Field(min_length=1, description="the profiles that are added")
    tables["sum"] = table_of(
        _rounded(_summed), name=f"Sum of {kind}", tag=("profile", "sum"), base=Smoothed, changed={"terms": terms}
    )
    globals().update({table.__name__: table for table in tables.values()})
    return chosen("profile", {"one": Annotated[float, Quantity(kind)], **tables}, _tag)


OVER_TIME |= {kind: _over_time(kind) for kind, quantity_kind in KINDS.items() if quantity_kind.rate}
