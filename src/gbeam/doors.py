"""Doors of results, :class:`gbeam.results.doors.Doors`: each imports the room behind it when it is opened."""

from __future__ import annotations

import os
from typing import Any

from gbeam.results.doors import Panels


def to_xarray(result: Any) -> Any:
    """Return a result as xarray.Dataset or DataTree."""
    from gbeam.io.netcdf import to_xarray

    return to_xarray(result)


def save(result: Any, path: str | os.PathLike[str]) -> None:
    """Write a result to a netCDF file, whole or not at all."""
    from gbeam.io.netcdf import save
    from gbeam.report.facts import facts_text

    save(result, path, facts_text(result))


def report(result: Any, path: str | os.PathLike[str]) -> None:
    """Write a result as a page of HTML that opens without a network."""
    from gbeam.report.page.result import write_report

    write_report(result, path)


def summary(result: Any) -> str:
    """Return the verdict and a small table as HTML, for notebooks."""
    from gbeam.report.page.document import html_of

    return html_of(result)


def view(result: Any) -> Any:
    """Return a notebook's view of what moves."""
    from gbeam.report.page.result import widget

    return widget(result)


def plot(result: Any, what: str, title: str) -> Panels:
    """Draw one of a result's figures with Matplotlib."""
    from gbeam.plots.output import plot

    return plot(result, what, title)
