"""The speeds that a hub goes through."""

from __future__ import annotations

import numpy as np

from gbeam.analysis.vibration.stability import hub_of
from gbeam.errors import InputError
from gbeam.motion.protocol import Motion

_SAMPLES = 501


def largest_rate(motion: Motion, name: str = "") -> float:
    """Largest rate that a hub with a prescribed rate reaches, rad/s."""
    hub = hub_of(motion, "a range of speeds", "ask `gbeam modes` for frequencies at a time", name)
    if hub.rate is None:
        raise InputError("speeds", "are not given, and the hub is driven by a torque", "give the largest speed")
    ends = np.append(np.asarray(hub.rate.breaks), 0.0)
    return float(np.abs(np.asarray(hub.rate(np.linspace(ends.min(), ends.max(), _SAMPLES)))).max())
