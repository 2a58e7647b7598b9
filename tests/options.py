"""Options that mypy refuses: it is an error where one of these ``ignore`` is not needed."""

from __future__ import annotations

import gbeam as gb


def respond(structure: gb.Structure, motion: gb.Flight) -> None:
    """The first call is right; the others are misspelt or of a wrong type."""
    gb.simulate(structure, motion, duration=10.0, step=1e-3)
    gb.simulate(structure, motion, duratoin=10.0)  # type: ignore[call-overload]
    gb.simulate(structure, motion, duration=[10.0])  # type: ignore[call-overload]
    gb.simulate_batch([(structure, motion)], duration=1.0, stpe=0.1)  # type: ignore[call-arg]
    gb.static(structure, motoin=motion)  # type: ignore[call-overload]
