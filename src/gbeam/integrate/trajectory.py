"""Coordinates over time, which is what an integration gives."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from gbeam.integrate.steps import Floats


@dataclass(frozen=True)
class Trajectory:
    """Coordinates (t, n) over time (t,), as far as the integration got before it failed or was stopped."""

    time: Floats
    q: Any
    qd: Any
    qdd: Any
    converged: bool = True
    stopped: bool = False

    @property
    def whole(self) -> bool:
        """Whether it came to its end."""
        return self.converged and not self.stopped
