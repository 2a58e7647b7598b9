"""Figures as PNG and SVG files, signed by what made them."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from gbeam.plots.drawing.style import style

DPI = 150
_LEVEL = 3  # of compression: more takes longer than it is worth
_BEGINNING = 2000  # bytes of a file that hold its signature
_ESCAPED = ("&lt;", "<"), ("&gt;", ">"), ("&amp;", "&")  # of XML; its own module imports what fetches from the net
_TEXT = re.compile(rb"(....)(tEXtSource\0|iTXtSource\0{5})", re.DOTALL)  # of PNG: length, kind and key
_ELEMENT = re.compile(rb"<dc:source>([^<]*)</dc:source>")  # of SVG


def save(figure: Figure, folder: Path, name: str, source: str = "") -> list[Path]:
    """Write a figure as PNG (150 dpi) and SVG; return the files.

    Parameters
    ----------
    figure : Figure
    folder : Path
        Which exists.
    name : str
        Of the files.
    source : str
        What made it, such as ``gbeam run``: the files carry it with their name, and :func:`signature` reads it.
    """
    compression = {"pil_kwargs": {"compress_level": _LEVEL}}
    files: dict[Path, dict[str, Any]] = {folder / f"{name}.png": compression, folder / f"{name}.svg": {}}
    with style():  # some settings are read only when a figure is drawn
        for file, options in files.items():
            signed = {"Source": f"{source}: {file.name}"} if source else None
            figure.savefig(file, dpi=DPI, metadata=signed, **options)
    return list(files)


def signature(file: Path) -> str:
    """Return the `source` that :func:`save` signed a file with; empty where there is none, or for another name."""
    with file.open("rb") as opened:
        beginning = opened.read(_BEGINNING)
    source, _, name = (_in_png if file.suffix == ".png" else _in_svg)(beginning).rpartition(": ")
    return source if name == file.name else ""


def _in_png(beginning: bytes) -> str:
    match = _TEXT.search(beginning)
    if match is None:
        return ""
    text = beginning[match.end() : match.start(2) + 4 + int.from_bytes(match[1])]
    # Version 0.2 ended it with a zero.
    return text.rstrip(b"\0").decode("latin-1" if match[2].startswith(b"tEXt") else "utf-8", errors="replace")


def _in_svg(beginning: bytes) -> str:
    match = _ELEMENT.search(beginning)
    text = match[1].decode(errors="replace") if match else ""
    for escaped, letter in _ESCAPED:
        text = text.replace(escaped, letter)
    return text
