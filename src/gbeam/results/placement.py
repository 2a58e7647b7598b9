"""Placements of a specimen on a centrifuge: frozen records."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, get_args

from gbeam.constants import Measure
from gbeam.results.accounting import PeakPair
from gbeam.results.declared import INSIDE, declared, fact, internal, part, quantity, rows
from gbeam.results.machine import LimitUse
from gbeam.results.result import Figured, Part

MEASURES = get_args(Measure)


def degrees(turn: Sequence[float]) -> str:
    """Write a rotation vector, rad, in degrees."""
    return "({}) deg".format(", ".join(f"{math.degrees(angle):.4g}" for angle in turn))


_LEVER = 0.1  # least part of the total error that a move must save to be worth it
_FULL = 0.99  # share of a limit from which on it is used up
_SAME = 1e-3  # of the length: control points nearer than this are one


@dataclass(frozen=True, repr=False, eq=False)
class Candidate(Part):
    """One way of mounting and smoothing, with the control point that is best for it."""

    mounting: str = quantity("", "which way up the specimen is mounted", note="upright or inverted")
    smoothing: float = quantity("s", "width of the target's kernel")
    control_point: float = quantity("m", "control point, from the root along x", note="best for this candidate")
    difference: float = quantity(
        "", "weighted measure of the load's difference along the specimen", note="as a fraction of flight's peak"
    )
    total_error: float = quantity(
        "", "the same with what smoothing and tracking change", note="what candidates are chosen by"
    )
    accelerations: tuple[float, float, float] = quantity(
        "rad/s^2", "largest acceleration of each axis", "machine_axis", name="acceleration"
    )
    share: float = quantity(
        "", "largest share of a limit that is used", note="zero where the machine has none", default=0.0
    )
    exceeded: tuple[LimitUse, ...] = rows("limits that it breaks", "limit", name=None, default=())
    most_used: LimitUse | None = part("limit of which the largest share is used", name=None, default=None)
    tracking: float = quantity(
        "",
        "weighted measure of what smoothing and tracking alone change of the load",
        name=None,
        note="which no control point changes",
        default=math.nan,
    )
    largest_load: PeakPair = part(
        "largest load of the base anywhere on the rigid specimen",
        unit="m/s^2",
        name=None,
        note="on the machine from the beginning of its spin-up to the end of its spin-down",
        default_factory=PeakPair,
    )

    beside: tuple[float, float] = internal("m", "control point along y and z", default=(0.0, 0.0))
    turn: tuple[float, float, float] = quantity(
        "rad", "rotation vector of the specimen in the machine", "axis", default=(0.0, 0.0, 0.0)
    )

    @declared("m", "control point, from the root", "axis", name="control_place", key="place")
    def place(self) -> tuple[float, float, float]:
        return (self.control_point, *self.beside)

    @declared("m/s^2", "largest load anywhere on the specimen", name="largest_load", key=None)
    def load(self) -> float:
        return self.largest_load.machine

    @declared("", "where that is", name="largest_load_place", key=None)
    def load_place(self) -> str:
        return self.largest_load.place_machine

    @declared("", "limits exceeded", name="exceeded", key=None)
    def exceeding(self) -> str:
        return "; ".join(map(str, self.exceeded))


@dataclass(frozen=True)
class Verification:
    """Simulation of the full model at a control point, over the times at which the target is the flight's load."""

    name: str = quantity("", "best, current or middle")
    control_point: float = quantity("m", "control point, from the root")
    tip_difference: float = quantity("m", "largest difference of the tip from flight across the beam")
    vibration: float = quantity(
        "m",
        "largest elastic vibration of the tip that the load's difference along the specimen causes",
        note="across the beam, against a base that carries the same load at the control point without turning",
    )
    moment_difference: float = quantity("N m", "largest difference of the bending moment at the root")
    force_difference: float = quantity("N", "largest difference of the shear force at the root", default=math.nan)


@dataclass(frozen=True, repr=False, eq=False)
class Setting(Part):
    """Placement of a specimen on a centrifuge."""

    control_point: float = quantity("m", "control point, from the root")
    mounting: str = fact("upright or inverted")
    smoothing: float = quantity("s", "width of the target's kernel")
    place: tuple[float, float, float] = quantity("m", "control point, from the root", "axis", name="control_place")
    turn: tuple[float, float, float] = quantity("rad", "rotation vector of the specimen in the machine", "axis")


@dataclass(frozen=True, repr=False, eq=False)
class Placement(Figured[Literal["difference"]]):
    """The best control point, mounting and smoothing for a measure."""

    flight: str = fact("name of the flight")
    centrifuge: str = fact("name of the centrifuge")
    weights: Mapping[Measure, float] = fact("weights of the measures", name="weight_", key="measure")
    length: float = fact(
        "length of a straight beam, from root to tip; else the specimen's largest extent", "m", key=None
    )
    best: Candidate = internal("", "the best")
    options: tuple[Candidate, ...] = rows("all that were tried, the best first, those that break limits last", "option")
    current: float = fact(
        "the scenario's control point", "m", name="current_control_point", key="current_control_point"
    )
    values: Mapping[str, Mapping[str, float]] = fact(
        "each measure of the load's difference along the specimen, as a fraction of flight's peak",
        name=None,
        key="difference",
        note="for best, current (the scenario's own mounting, smoothing and control point) and middle of the beam",
    )
    verifications: tuple[Verification, ...] = internal("", "simulations", "check", default=())
    refused: tuple[str, ...] = fact("candidates that could not be built, and why", default=())
    widths: tuple[float, float] = fact(
        "first and last width of smoothing that was tried", "s", name=None, key="smoothing_range", default=(0.0, 0.0)
    )
    totals: Mapping[str, Mapping[str, float]] = fact(
        "as `values`, with what smoothing and tracking change of the load",
        name=None,
        key="total_error",
        default_factory=dict,
    )
    before: Candidate | None = part("the scenario's own", name=None, default=None)
    point: str = fact("of a system, the point whose displacement and vibration are judged", default="")
    straight: bool = internal("", "whether the specimen is one straight beam", default=True)
    outcome: str = fact(
        "how it ended", note="done, or limits exceeded where every candidate breaks one: the best is then the nearest",
        default="done",
    )  # fmt: skip

    @declared("", "simulations by name", "check", role="rows", name=None, key="verifications")
    def checks(self) -> Mapping[str, Verification]:
        return {verification.name: verification for verification in self.verifications}

    @declared("", "control point, mounting and smoothing of the best", role="part", name=None, key=INSIDE)
    def placed(self) -> Setting:
        chosen = self.best
        return Setting(chosen.control_point, chosen.mounting, chosen.smoothing, chosen.place, chosen.turn)

    @declared("", "the changes as KEY=VALUE of --set", role="fact", name=None, key="set")
    def settings(self) -> tuple[str, ...]:
        return tuple(f"motion.{self.centrifuge}.{key}={value}" for key, value in self.changes.items())

    @property
    def changes(self) -> dict[str, str | list[str]]:
        """Keys of the centrifuge to change, with their values as in a scenario, or empty where the placement is the
        best already, or every option breaks a limit.
        """
        chosen, present = self.best, self.before
        if self.outcome != "done":
            return {}
        changes: dict[str, str | list[str]] = {}
        present_place = (self.current, 0.0, 0.0) if present is None else present.place
        if math.dist(chosen.place, present_place) > _SAME * self.length:
            place = [f"{1e3 * component:.6g} mm" for component in chosen.place]
            changes["control_point"] = place if any(chosen.place[1:]) or chosen.place[0] < 0 else place[0]
        if present is not None and chosen.turn != present.turn:
            changes["turn"] = [f"{math.degrees(component):.6g} deg" for component in chosen.turn]
        if present is not None and chosen.mounting != present.mounting:
            changes["mounting"] = chosen.mounting
        if present is not None and abs(chosen.smoothing - present.smoothing) > 1e-3 * present.smoothing:
            # Upwards: rounding must not sharpen the corners of a machine at its limit.
            changes["smoothing"] = f"{math.ceil(1e5 * chosen.smoothing - 1e-6) / 100:g} ms"
        return changes

    @declared("", "why none is allowed, or why placing saves little", role="fact")
    def message(self) -> str:
        """Sentence on why no option is allowed, that the placement is the best already, or that placing saves little;
        empty where it helps.
        """
        chosen, present = self.best, self.before
        if self.outcome != "done":
            broken = "; ".join(str(use) for use in chosen.exceeded)
            return (
                f"none of {len(self.options)} options keeps the machine's limits; nearest comes {chosen.mounting}, "
                f'{1e3 * chosen.smoothing:.4g} ms: {broken}; try wider smoothing or inverse = "planned"'
            )
        if not self.changes:
            return "the scenario has the best placement already"
        if present is None or present.exceeded or chosen.total_error <= (1 - _LEVER) * present.total_error:
            return ""
        most_used = chosen.most_used
        at_limit = most_used is not None and most_used.share >= _FULL
        limit = f"; the machine is at its limit: {most_used}" if at_limit else ""
        return (
            f"another place changes little: the measure goes from {100 * present.total_error:.3g} % to "
            f"{100 * chosen.total_error:.3g} % of flight's peak, of which the error of the load at the control point "
            f"makes {100 * chosen.tracking:.3g} %{limit}"
        )

    @declared(
        "", "best control point over the length of a straight beam", role="fact", name=None, key="fraction_of_length"
    )
    def fraction(self) -> float:
        return self.best.control_point / self.length if self.straight else math.nan

    @declared(
        "",
        "vibration with the control point at mid-span over that with the best",
        role="fact",
        name="vibration_gain_over_middle",
        key="vibration_gain_over_middle",
    )
    def vibration_gain(self) -> float:
        """Vibration with the control point at mid-span over that with the best, simulated, or NaN where it was not."""
        vibration = {check.name: check.vibration for check in self.verifications}
        if not {"best", "middle"} <= vibration.keys() or vibration["best"] <= 0:
            return float("nan")
        return vibration["middle"] / vibration["best"]

    def __repr__(self) -> str:
        chosen = self.best
        measure = " + ".join(f"{weight:g} × {name}" for name, weight in self.weights.items() if weight)
        share = f" ({self.fraction:.4f} of the length)" if self.straight else ""
        lines = [
            f"Placement of {self.centrifuge!r}, tracking {self.flight!r}, by {measure}",
            f"control point {1e3 * chosen.control_point:.2f} mm from the root{share}, "
            f"{chosen.mounting}, smoothing {1e3 * chosen.smoothing:.4g} ms",
            f"difference of the load {100 * chosen.difference:.3g} % of flight's peak, "
            f"in total {100 * chosen.total_error:.3g} %; {len(self.options)} candidates",
        ]
        return "\n  ".join(lines)
