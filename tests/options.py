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


def choose(beam: gb.Beam, flight: gb.Flight, case: gb.Case) -> None:
    """Names of another kind are refused where they are misspelt."""
    gb.assemble(beam, "FOAM", z=3)
    gb.assemble(beam, "FOMA", z=3)  # type: ignore[arg-type]
    gb.Model("exact", z=3, shapes="adaptive")  # type: ignore[arg-type]
    gb.Hub(radius=0.5, pointing="outwards")  # type: ignore[arg-type]
    gb.Centrifuge(flight, arm=3.3, control_point=0.1, gravity=False, inverse="quasistatic")  # type: ignore[arg-type]
    gb.Centrifuge(flight, arm=3.3, control_point=0.1, gravity=False, mounting="down")  # type: ignore[arg-type]
    gb.Centrifuge(flight, arm=3.3, control_point=0.1, gravity=False, start="yawed")  # type: ignore[arg-type]
    gb.linearize(gb.assemble(beam, "FOAM", z=3), flight, at="begin")  # type: ignore[arg-type]
    gb.ResponseSettings(1.0, integrator="rk4")  # type: ignore[arg-type]
    gb.compare_models(case, ["FOAM", "FOMA"])  # type: ignore[list-item]
