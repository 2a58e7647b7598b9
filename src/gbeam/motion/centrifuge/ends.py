"""Beginning and end of a centrifuge's motion: from standstill and back to it, or turning already."""

from __future__ import annotations

from dataclasses import dataclass

from gbeam.errors import InputError
from gbeam.guards.checks import choice, positive

STARTS = ("rest", "pre-yawed", "idle")


@dataclass(frozen=True)
class Ends:
    """Beginning and end of a centrifuge's motion, before the flight's first time and after its last.

    Parameters
    ----------
    start : str
        ``rest``: from standstill to standstill, the arm's tangential acceleration on the way ignored. ``pre-yawed``:
        likewise, with axis 2 turned across the arm at standstill so that the load has its direction on the way.
        ``idle``: the motion begins and ends in the state that it has at the flight's first and last time.
    spin_up, spin_down : float, optional
        From standstill to the flight's first time, and from its last to standstill, s; found within the machine's
        limits where left out.

    Raises
    ------
    InputError
        If the start is unknown, a time is not positive, or one is given for a machine that begins at idle.
    """

    start: str = "rest"
    spin_up: float | None = None
    spin_down: float | None = None

    def __post_init__(self) -> None:
        choice("start", self.start, STARTS)
        for name in ("spin_up", "spin_down"):
            duration = getattr(self, name)
            if duration is None:
                continue
            if self.start == "idle":
                raise InputError(name, "does not go with start = idle", f'leave it out, or give start = "{STARTS[0]}"')
            object.__setattr__(self, name, float(positive(name, duration, "s")))
