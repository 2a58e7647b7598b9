"""Files of results as their users open them."""

from __future__ import annotations

from pathlib import Path

import xarray as xr


def opened(path: str | Path) -> xr.DataTree:
    """Return all of a netCDF file, in memory."""
    with xr.open_datatree(path, engine="h5netcdf") as tree:
        return tree.load()
