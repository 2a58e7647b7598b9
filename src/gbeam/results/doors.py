"""Doors that results lead to: files, figures, pages. The rooms behind them are above; `gbeam.doors` has them."""

from __future__ import annotations

import os
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


class Panels(Protocol):
    """Axes of one figure, from top to bottom."""

    @property
    def figure(self) -> Figure:
        """Figure that they are in, made without pyplot."""
        ...

    def __len__(self) -> int: ...

    def __getitem__(self, number: Any, /) -> Any: ...

    def __iter__(self) -> Iterator[Axes]: ...


class Doors(Protocol):
    """Functions of results in the rooms above."""

    def to_xarray(self, result: Any) -> Any:
        """Return a result as xarray.Dataset or DataTree."""
        ...

    def save(self, result: Any, path: str | os.PathLike[str]) -> None:
        """Write a result to a netCDF file."""
        ...

    def report(self, result: Any, path: str | os.PathLike[str]) -> None:
        """Write a result as a page of HTML."""
        ...

    def summary(self, result: Any) -> str:
        """Return the verdict and a small table as HTML."""
        ...

    def view(self, result: Any) -> Any:
        """Return a notebook's view of what moves."""
        ...

    def plot(self, result: Any, what: str, title: str) -> Panels:
        """Draw one of a result's figures."""
        ...


_bound: list[Doors] = []


def bind(doors: Doors) -> None:
    """Open the doors of all results."""
    _bound[:] = [doors]


def doors() -> Doors:
    """Return the doors of all results."""
    return _bound[0]
