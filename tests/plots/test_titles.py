"""Titles are drawn as they are written: no mathematics between dollar signs, no control characters."""

from __future__ import annotations

from pathlib import Path

from matplotlib.figure import Figure

from gbeam.plots import save
from gbeam.plots.style import panels, styled


@styled
def _titled(title: str) -> Figure:
    figure, axes = panels(title, 1)
    axes[0].plot([0, 1])
    return figure


def test_dollars_and_control_characters(tmp_path: Path) -> None:
    figure = _titled("$a_b^$x$ \\frac \x1b[31m \0 \ud800")
    assert figure.get_suptitle() == r"$a_b^$x$ \frac \x1b[31m \x00 \ud800"
    assert [file.suffix for file in save(figure, tmp_path, "title")] == [".png", ".svg"]  # mathtext raised here
