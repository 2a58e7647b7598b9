"""What a record holds, and the load that a scenario makes of it: looked at before anything is run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from gbeam.app.columns import suggested
from gbeam.constants import STANDARD_GRAVITY
from gbeam.motion import Flight
from gbeam.motion.bases.records.files import read_table
from gbeam.scenario import build, loads

SAMPLES = 1500
MOST = 500  # columns


def head(file: Path) -> dict[str, Any]:
    """Name of a record, its columns, and what these are by their names."""
    columns = read_table(file).columns[:MOST]
    known = suggested((each.name, each.unit) for each in columns)
    return {"name": file.name, "columns": [each.name for each in columns], "suggested": known}


def load_curves(text: str, folder: Path) -> dict[str, Any]:
    """The acceleration (or specific force) of every flight over the response's time, in g, base axes.

    Parameters
    ----------
    text : str
        Of a scenario.
    folder : Path
        Of its records.
    """
    case = build(loads(text, folder=folder))
    start, duration = case.response.start, case.response.duration
    time = np.linspace(start, start + duration, SAMPLES)
    flights = {name: motion for name, motion in case.motions.items() if isinstance(motion, Flight)}
    return {
        "time": time.tolist(),
        "flights": {
            name: (np.asarray(flight.over(start, start + duration).base(time).a_WO_B) / STANDARD_GRAVITY).T.tolist()
            for name, flight in flights.items()
        },
    }
