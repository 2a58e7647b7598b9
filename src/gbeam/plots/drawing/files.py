"""A figure as PNG and SVG, drawn once: most of the time goes into placing ticks and letters, which both share."""

from __future__ import annotations

import re
import struct
import zlib
from pathlib import Path
from typing import Any, TextIO

import numpy as np
from matplotlib.backend_bases import GraphicsContextBase, RendererBase
from matplotlib.backends.backend_agg import FigureCanvasAgg, RendererAgg
from matplotlib.backends.backend_svg import RendererSVG
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties, findfont, get_font
from matplotlib.transforms import Affine2D, TransformedBbox, TransformedPath
from numpy.typing import NDArray

from gbeam.plots.drawing.scales import draw_scale, without_scales
from gbeam.plots.drawing.style import style

DPI = 150
_POINTS = 72 / DPI  # points of the SVG to a pixel of the PNG
_LEVEL = 3  # of compression: more takes longer than it is worth
_BEGINNING = 2000  # bytes of a file that hold its signature
_ESCAPED = ("&lt;", "<"), ("&gt;", ">"), ("&amp;", "&")  # of XML; its own module imports what fetches from the net
_SIGNATURE = {
    ".png": re.compile(rb"iTXtSource\0\0\0\0\0([^\0]*)\0"),
    ".svg": re.compile(rb"<dc:source>([^<]*)</dc:source>"),
}


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
    png, svg = (folder / f"{name}.{kind}" for kind in ("png", "svg"))
    dpi = figure.dpi
    # Some settings are read only when a figure is drawn.
    with style(), svg.open("w", encoding="utf-8") as file:
        try:
            figure.set_dpi(DPI)
            both = _Both(figure, file, _signed(svg, source))
            with without_scales(figure) as scales:
                figure.draw(both)
            for scale in scales:
                draw_scale(scale, both)
            both.vector.finalize()
        finally:
            figure.set_dpi(dpi)
    write_png(png, np.asarray(both.raster.buffer_rgba())[:, :, :3], _signed(png, source))
    return [png, svg]


def _signed(file: Path, source: str) -> str:
    return f"{source}: {file.name}" if source else ""


def signature(file: Path) -> str:
    """Return the `source` that :func:`save` signed a file with; empty where there is none, or for another name."""
    with file.open("rb") as opened:
        beginning = opened.read(_BEGINNING)
    match = _SIGNATURE[file.suffix].search(beginning)
    source, _, name = (match[1].decode(errors="replace") if match else "").rpartition(": ")
    for escaped, letter in _ESCAPED:
        name = name.replace(escaped, letter)
    return source if name == file.name else ""


def write_png(path: Path, pixels: NDArray[np.uint8], signed: str = "") -> None:
    """Write pixels (h, w, 3), RGB, without a filter: between lines of one colour there is nothing to predict."""
    height, width, channels = pixels.shape
    rows = np.zeros((height, 1 + channels * width), dtype=np.uint8)  # the first byte of a row names its filter
    for k in range(channels):  # one after the other: NumPy copies long rows five times as quickly as triples
        rows[:, 1 + k :: channels] = pixels[:, :, k]

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)  # 8 bits a channel, RGB
    resolution = struct.pack(">IIB", round(DPI / 0.0254), round(DPI / 0.0254), 1)
    parts = [(b"IHDR", header), (b"pHYs", resolution), (b"IDAT", zlib.compress(rows.data, _LEVEL)), (b"IEND", b"")]
    if signed:  # keyword, no compression, no language
        parts.insert(2, (b"iTXt", b"Source\0\0\0\0\0" + signed.encode() + b"\0"))
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + b"".join(chunk(kind, data) for kind, data in parts))


class _Both(RendererBase):
    """Draws to pixels and to SVG: artists measure and place by the pixels, and the SVG takes the same at 72 dpi."""

    def __init__(self, figure: Figure, file: TextIO, signed: str) -> None:
        super().__init__()
        width, height = figure.get_size_inches()
        FigureCanvasAgg(figure)
        self.raster: Any = RendererAgg(width * DPI, height * DPI, DPI)
        self.vector: Any = RendererSVG(width * 72, height * 72, file, metadata={"Source": signed} if signed else None)
        self._heights: dict[FontProperties, Any] = {}
        self._scale = Affine2D().scale(_POINTS)

    def _vector_gc(self, gc: Any) -> GraphicsContextBase:
        """The same with its clipping in points."""
        scaled: Any = GraphicsContextBase()
        scaled.copy_properties(gc)
        rectangle, (path, transform) = gc.get_clip_rectangle(), gc.get_clip_path()
        if rectangle is not None:
            scaled.set_clip_rectangle(TransformedBbox(rectangle, self._scale))
        if path is not None and transform is not None:
            scaled.set_clip_path(TransformedPath(path, transform + self._scale))
        return scaled

    def draw_path(self, gc: Any, path: Any, transform: Any, rgbFace: Any = None) -> None:
        self.raster.draw_path(gc, path, transform, rgbFace)
        self.vector.draw_path(self._vector_gc(gc), path, transform + self._scale, rgbFace)

    def draw_markers(self, gc: Any, marker: Any, marker_trans: Any, path: Any, trans: Any, rgbFace: Any = None) -> None:
        self.raster.draw_markers(gc, marker, marker_trans, path, trans, rgbFace)
        scaled = marker_trans + self._scale, path, trans + self._scale
        self.vector.draw_markers(self._vector_gc(gc), marker, *scaled, rgbFace)

    def draw_text(
        self, gc: Any, x: float, y: float, s: str, prop: Any, angle: float, ismath: Any = False, mtext: Any = None
    ) -> None:
        self.raster.draw_text(gc, x, y, s, prop, angle, ismath, mtext)
        self.vector.draw_text(self._vector_gc(gc), _POINTS * x, _POINTS * y, s, prop, angle, ismath, mtext)

    def get_text_width_height_descent(self, s: str, prop: Any, ismath: Any) -> tuple[float, float, float]:
        return self.raster.get_text_width_height_descent(s, prop, ismath)

    def _get_font_height_metrics(self, prop: FontProperties) -> tuple[float | None, float | None, float | None]:
        """Ascent, descent and line gap of a font, pixels; matplotlib 3.11 else reads its tables for every text."""
        if prop not in self._heights:
            font = get_font(findfont(prop))
            table: Any = font.get_sfnt_table("OS/2")
            scale = prop.get_size_in_points() * DPI / 72 / font.units_per_EM
            names = ("sTypoAscender", 1), ("sTypoDescender", -1), ("sTypoLineGap", 1)
            self._heights[prop] = tuple(sign * scale * table[name] if table else None for name, sign in names)
        return self._heights[prop]

    def get_canvas_width_height(self) -> tuple[float, float]:
        return self.raster.get_canvas_width_height()

    def points_to_pixels(self, points: Any) -> Any:
        return self.raster.points_to_pixels(points)

    def flipy(self) -> bool:
        return True

    def open_group(self, s: str, gid: str | None = None) -> None:
        self.vector.open_group(s, gid)

    def close_group(self, s: str) -> None:
        self.vector.close_group(s)
