"""Coordinates over time, which is what an integration gives."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from gbeam.integrate.steps import Floats


@dataclass(frozen=True)
class Trajectory:
    """Coordinates over time, as far as the integration got.

    Parameters
    ----------
    time : (t,) s
    q, qd, qdd : (t, n)
    converged : bool
        False where the acceleration could not be computed in the step after the last time.
    stopped : bool
        Whether the caller's condition stopped it.
    """

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
