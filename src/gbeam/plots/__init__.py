"""Figures of results: PNG to look at and SVG to print, or to work on with matplotlib.

`figures` knows which figures a result has; a module for each kind of result draws them; `drawing` is what they share. A
figure reads results only, never a model.
"""

from gbeam.plots.comparison import plot_comparison, plot_shock
from gbeam.plots.drawing.files import save, signature
from gbeam.plots.environment import plot_base, plot_hub
from gbeam.plots.figures import figures, plot, write_plots
from gbeam.plots.loads import plot_loads, plot_loads_along
from gbeam.plots.machine import plot_axes, plot_tracking
from gbeam.plots.steady import plot_campbell, plot_critical_map, plot_modes, plot_static
from gbeam.plots.tip import plot_tip

__all__ = [
    "figures",
    "plot",
    "plot_axes",
    "plot_base",
    "plot_campbell",
    "plot_comparison",
    "plot_critical_map",
    "plot_hub",
    "plot_loads",
    "plot_loads_along",
    "plot_modes",
    "plot_shock",
    "plot_static",
    "plot_tip",
    "plot_tracking",
    "save",
    "signature",
    "write_plots",
]
