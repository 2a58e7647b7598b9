"""What a record holds, and the load that a scenario makes of it: looked at before anything is run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from gbeam.constants import STANDARD_GRAVITY
from gbeam.motion import Flight
from gbeam.motion.bases.records.record import READERS
from gbeam.motion.bases.records.text import read_text
from gbeam.scenario import build, loads

SAMPLES = 1500


def columns(file: Path) -> list[str]:
    """Names of the columns of a record."""
    table = READERS.get(file.suffix.lower(), read_text)(file)
    return [each.name for each in table.columns][:500]


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
