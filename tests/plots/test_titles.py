"""Titles are drawn as they are written: no mathematics between dollar signs, no control characters."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from gbeam.figures.description import Figure as Described
from gbeam.figures.description import Line, Panel
from gbeam.plots import draw, save


def _titled(title: str) -> Figure:
    line = Line(np.arange(2.0), np.arange(2.0))
    return draw(Described(title, "", (Panel("", (line,)),)))


def test_dollars_and_control_characters(tmp_path: Path) -> None:
    figure = _titled("$a_b^$x$ \\frac \x1b[31m \0 \ud800")
    assert figure.get_suptitle() == r"$a_b^$x$ \frac \x1b[31m \x00 \ud800"
    assert [file.suffix for file in save(figure, tmp_path, "title")] == [".png", ".svg"]  # mathtext raised here
