"""Figures drawn with Matplotlib: PNG to look at and SVG to print, or axes to work on.

`gbeam.figures` describes them; `draw` draws what is described.
"""

from gbeam.plots.draw import draw
from gbeam.plots.files import plot, save, signature, write_figures

__all__ = ["draw", "plot", "save", "signature", "write_figures"]
