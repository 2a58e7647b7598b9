"""Plots of a study, as files: PNG to look at and SVG to print.

One module per figure; style is what they share. A plot reads results only, never a model.
"""

from pathlib import Path

from gbeam.plots.axes import plot_axes
from gbeam.plots.base import plot_base
from gbeam.plots.comparison import plot_comparison, plot_shock
from gbeam.plots.hub import plot_hub
from gbeam.plots.loads import plot_loads
from gbeam.plots.style import save
from gbeam.plots.tip import plot_tip
from gbeam.results.response import Study

__all__ = [
    "plot_axes",
    "plot_base",
    "plot_comparison",
    "plot_hub",
    "plot_loads",
    "plot_shock",
    "plot_tip",
    "write_plots",
]


def write_plots(study: Study, folder: Path) -> list[Path]:
    """Write all plots of a study.

    Parameters
    ----------
    study : Study
    folder : Path
        Which exists.

    Returns
    -------
    list of Path
        The files: ``tip``, and per environment ``base_NAME``, ``loads_NAME``, ``axes_NAME`` (centrifuges),
        ``hub_NAME`` (hubs); per comparison ``comparison_NAME`` and ``shock_NAME``, NAME being the centrifuge's.
    """
    files = save(plot_tip(study), folder, "tip")
    for name, it in study.responses.items():
        files += save(plot_base(it, study.title), folder, f"base_{name}")
        if it.loads is not None:
            files += save(plot_loads(it, it.loads, study.title), folder, f"loads_{name}")
        if it.axes is not None:
            files += save(plot_axes(it, it.axes, study.title), folder, f"axes_{name}")
        if it.hub is not None:
            files += save(plot_hub(it, it.hub, study.title), folder, f"hub_{name}")
    for compared in study.comparisons:
        name = compared.centrifuge
        if compared.root or compared.stations or compared.mismatch:
            both = study.responses[compared.flight], study.responses[name]
            files += save(plot_comparison(compared, *both, study.title), folder, f"comparison_{name}")
        if compared.shock:
            files += save(plot_shock(compared, compared.shock, study.title), folder, f"shock_{name}")
    return files
