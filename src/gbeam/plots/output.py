"""Plots as axes to work on, or as files: PNG to look at and SVG to print."""

from __future__ import annotations

import re
from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from typing import Any, BinaryIO, cast
from xml.etree.ElementTree import iterparse

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from PIL.PngImagePlugin import PngImageFile

from gbeam.figures.registry import Describe, figure_of
from gbeam.plots.draw import Shown, draw, style
from gbeam.progress import Progress, tell


class Panels(tuple[Axes, ...]):
    """The axes of one figure from top to bottom, a tuple also where there is one; a notebook shows the figure."""

    __slots__ = ()

    @property
    def figure(self) -> Shown:
        """The figure that they are in."""
        return cast(Shown, self[0].get_figure(root=True))

    def _repr_png_(self) -> bytes:
        return self.figure._repr_png_()


def plot(result: Any, what: str = "", title: str = "") -> Panels:
    """Draw one figure of a result, the first that it has or the one of that name, and return its axes."""
    return Panels(draw(figure_of(result, what, title)).axes)


def write_figures(
    described: Mapping[str, Describe], folder: Path, source: str = "", progress: Progress = None
) -> list[Path]:
    """Draw figures and write each under its name, as far as files may have it: ``axes_rate_spin`` of axes_rate spin."""
    files: list[Path] = []
    figures = {re.sub(r"[^\w.-]+", "_", re.sub(r"[\[\]]", "", name)): describe for name, describe in described.items()}
    with style():
        for k, (name, describe) in enumerate(figures.items()):
            tell(progress, f"drawing {name}", k / len(figures))
            files += save(draw(describe()), folder, name, source)
    return files


DPI = 150
_LEVEL = 3  # of compression: more takes longer than it is worth
_BEGINNING = 2000  # bytes of an SVG file that hold its signature
_SOURCE = "{http://purl.org/dc/elements/1.1/}source"  # element of SVG's metadata


def save(figure: Figure, folder: Path, name: str, source: str = "") -> list[Path]:
    """Write a figure as PNG (150 dpi) and SVG; return the files."""
    compression = {"pil_kwargs": {"compress_level": _LEVEL}}
    files: dict[Path, dict[str, Any]] = {folder / f"{name}.png": compression, folder / f"{name}.svg": {}}
    with style():  # some settings are read only when a figure is drawn
        engine = figure.get_layout_engine()
        if engine is not None:  # once for both files, and not by drawing each of them twice
            engine.execute(figure)
            figure.set_layout_engine(None)
        for file, options in files.items():
            signed = {"Source": f"{source}: {file.name}"} if source else None
            figure.savefig(file, dpi=DPI, metadata=signed, **options)
    return list(files)


def signature(file: Path) -> str:
    """Return the `source` that :func:`save` signed a file with, or empty where there is none, or for another name."""
    with file.open("rb") as opened:
        source, _, name = (_in_png if file.suffix == ".png" else _in_svg)(opened).rpartition(": ")
    return source if name == file.name else ""


def _in_png(opened: BinaryIO) -> str:
    """Source that the text before the pixels of a PNG file states, or empty where there is none."""
    try:
        with PngImageFile(opened) as image:
            return str(image.info.get("Source", ""))
    except (OSError, SyntaxError, ValueError):  # no PNG file, or none that is whole
        return ""


def _in_svg(opened: BinaryIO) -> str:
    """Source that the metadata of an SVG file state, or empty where there are none."""
    try:
        elements = (element for _, element in iterparse(BytesIO(opened.read(_BEGINNING))))
        return next((element.text or "" for element in elements if element.tag == _SOURCE), "")
    except (LookupError, SyntaxError, ValueError):  # no XML, or in an encoding that is none
        return ""
