"""Titles are drawn as they are written: no mathematics between dollar signs, no control characters."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from gbeam.figures import Figure as Described
from gbeam.figures import Line, Panel
from gbeam.plots import draw, save
from gbeam.results import NOT_KNOWN


def _titled(title: str) -> Figure:
    line = Line(np.arange(2.0), np.arange(2.0))
    return draw(Described(title, "", (Panel("", (line,)),)))


def test_what_is_said_above_a_figure_fits_its_width() -> None:
    """A title of 200 letters, and the note of what is left out of the largest stress."""
    line = Line(np.arange(2.0), np.arange(2.0))
    said = ("largest: there", NOT_KNOWN)
    for title in (" ".join(["a camera on a bracket"] * 9), "short"):
        figure = draw(Described(title, "flight", (Panel("", (line,)),), said))
        (drawn,) = [each for each in figure.texts if each.get_text() == figure.get_suptitle()]
        box = drawn.get_window_extent(FigureCanvasAgg(figure).get_renderer())
        assert box.x0 > 0 and box.x1 < figure.bbox.width
        assert " ".join(figure.get_suptitle().split()) == " ".join([title, "flight", *said])
        figure.draw_without_rendering()
        assert drawn.get_window_extent().y0 > figure.axes[0].get_window_extent().y1


def test_dollars_and_control_characters(tmp_path: Path) -> None:
    figure = _titled("$a_b^$x$ \\frac \x1b[31m \0 \ud800")
    assert figure.get_suptitle() == r"$a_b^$x$ \frac \x1b[31m \x00 \ud800"
    assert [file.suffix for file in save(figure, tmp_path, "title")] == [".png", ".svg"]  # mathtext raised here
