"""Figures of results: PNG to look at and SVG to print, or to work on with matplotlib.

`figures` knows which figures a result has; a module for each kind of result draws them; `lines`, `style` and `units`
are what they share. A figure reads results only, never a model.
"""

from gbeam.plots.comparison import plot_comparison, plot_shock
from gbeam.plots.figures import figures, plot, save, signature, write_plots
from gbeam.plots.machine import plot_axes, plot_base, plot_hub, plot_tracking
from gbeam.plots.response import plot_loads, plot_loads_along, plot_tip
from gbeam.plots.steady import plot_campbell, plot_critical_map, plot_modes, plot_static

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
