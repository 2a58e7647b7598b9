"""The curves of a run's page: of the tip, the load, the stress and root loads, the machine's limits, the shock."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from gbeam.constants import STANDARD_GRAVITY
from gbeam.report.page.series import Plots, thinned
from gbeam.results.result import Floats

SMALL = 0.01  # of the largest: a smaller component is not drawn
REFERENCE = 6  # the colour of what others are compared with
FLIGHT = {"colour": 5, "broad": True}  # one that is imitated, below what does: where they agree both are seen
Drawn = list[tuple[str, str]]  # id and title
Variables = Mapping[str, Any]


def of_run(facts: Mapping[str, Any], motions: Mapping[str, Any], variables: Variables, plots: Plots) -> Drawn:
    """Add the plots of a run, and return their places and titles."""
    present = [name for name in motions if f"motions/{name}/time" in variables]
    if not present:
        return []
    held = [
        [each["start"], each["end"]]
        for compared in facts["comparisons"]
        for each in compared["accounting"]["not_followed"]
        if each["end"] - each["start"] > 0.005
    ]
    flights = {each["centrifuge"]: each["flight"] for each in facts["comparisons"] if each["flight"] in present}
    page = _Page(plots, motions, variables, {"bands": held} if held else {}, flights)
    page.tips(present)
    for name in present:
        page.loads(name)
    page.sizes("Largest stress", "stress, MPa", present, "stress", 1e-6, lambda v: v.max(axis=1))
    page.sizes("Root moment", "moment, N m", present, "section_moment", 1.0, lambda v: np.linalg.norm(v[:, 0], axis=1))
    page.sizes("Root force", "force, N", present, "section_force", 1.0, lambda v: np.linalg.norm(v[:, 0], axis=1))
    for name in present:
        page.limits(name)
        page.hub(name)
    for compared in facts["comparisons"]:
        page.difference(compared["centrifuge"])
        page.shock(compared)
    return page.drawn


def of_plan(motions: Mapping[str, Any], variables: Variables, plots: Plots) -> Drawn:
    """Add the plots of a machine's plan, and return their places and titles."""
    page = _Page(plots, motions, variables, {}, {})
    for name in motions:
        if f"motions/{name}/time" in variables:
            page.loads(name)
            page.limits(name)
    return page.drawn


class _Page:
    """The plots of one page, all over the variables of one file; `flights` are compared with, by their machines."""

    def __init__(
        self,
        plots: Plots,
        motions: Mapping[str, Any],
        variables: Variables,
        common: dict[str, Any],
        flights: Mapping[str, str],
    ) -> None:
        self.drawn: Drawn = []
        self._plots, self._motions, self._variables = plots, motions, variables
        self._common, self._flights = common, flights
        self._times: dict[str, Floats] = {}

    def _of(self, name: str, key: str) -> Any:
        return self._variables.get(f"motions/{name}/{key}")

    def _line(self, label: str, name: str, values: Floats, colour: int, **more: Any) -> dict[str, Any]:
        time, kept = thinned(self._of(name, "time"), values)
        look = FLIGHT if name in self._flights.values() else {"colour": colour}
        # Lines of one motion share their times, which are the same numbers.
        return {"label": label, "x": self._times.setdefault(name, time), "y": kept, **look, **more}

    def _add(self, title: str, y: str, lines: list[dict[str, Any]], **more: Any) -> None:
        over_time = self._common if "x" not in more else {}
        self.drawn.append((self._plots.add(title, y, lines, **over_time, **more), title))

    def tips(self, names: list[str]) -> None:
        tips = {name: 1e3 * self._of(name, "displacement")[:, -1] for name in names}
        for i in _moving(*tips.values()):
            lines = [self._line(name, name, tip[:, i], k) for k, (name, tip) in enumerate(tips.items())]
            self._add(f"Tip along {'xyz'[i]}", "displacement, mm", lines)

    def loads(self, name: str) -> None:
        """The load at a machine's control point, the one that it should be, and the flight's; or that of a flight."""
        actual, reference = self._of(name, "load_actual"), self._of(name, "load_reference")
        if actual is None:
            if self._motions[name]["environment"] == "flight" and name not in self._flights.values():
                load = self._of(name, "root_acceleration") / STANDARD_GRAVITY
                lines = [self._line(f"along {'xyz'[i]}", name, load[:, i], i) for i in _moving(load)]
                self._add(f"{name}: load of the base", "load, g", lines)
            return
        flight = self._flights.get(name)
        for i in _moving(reference, actual):
            lines = [
                self._line("target", name, reference[:, i] / STANDARD_GRAVITY, REFERENCE, dash=True),
                self._line("machine", name, actual[:, i] / STANDARD_GRAVITY, 1),
            ]
            if flight is not None:
                flown = self._of(flight, "root_acceleration")[:, i] / STANDARD_GRAVITY
                lines.insert(0, self._line(flight, flight, flown, 0))
            self._add(f"{name}: load at the control point along {'xyz'[i]}", "load, g", lines)

    def sizes(self, title: str, y: str, names: list[str], key: str, scale: float, size: Any) -> None:
        lines = []
        for colour, name in enumerate(names):
            values = self._of(name, key)
            if values is not None and np.isfinite(values).any():
                lines.append(self._line(name, name, scale * size(values), colour))
        if lines:
            self._add(title, y, lines)

    def limits(self, name: str) -> None:
        for quantity, unit in (("rate", "rad/s"), ("acceleration", "rad/s²"), ("jerk", "rad/s³")):
            values, allowed = self._of(name, f"axis_{quantity}"), self._of(name, f"{quantity}_allowed")
            if values is None:
                continue
            limited = allowed is not None and np.isfinite(allowed).all()
            shown = 100 * np.abs(values) / allowed if limited else values
            lines = [self._line(f"axis {i + 1}", name, shown[:, i], i) for i in range(3)]
            title = f"{name}: {quantity} of the axes"
            if limited:
                self._add(title, "share of the limit, %", lines, levels=[{"label": "limit", "value": 100.0}])
            else:
                self._add(title, f"{quantity}, {unit}", lines)

    def hub(self, name: str) -> None:
        for key, y in (("hub_angle", "angle, rad"), ("hub_rate", "rate, rad/s"), ("drive_torque", "torque, N m")):
            values = self._of(name, key)
            if values is not None and np.isfinite(values).any():
                what = key.replace("hub_", "hub's ").replace("drive_", "drive's ")
                self._add(f"{name}: {what}", y, [self._line(what, name, values, 0)])

    def difference(self, name: str) -> None:
        place = f"comparisons/{name}"
        if f"{place}/difference" not in self._variables:
            return
        values = 1e3 * self._variables[f"{place}/difference"]
        parts = _moving(values)
        time, kept = thinned(self._variables[f"{place}/time"], values[:, parts])
        lines = [{"label": f"along {'xyz'[i]}", "x": time, "y": kept[:, k], "colour": k} for k, i in enumerate(parts)]
        self._add(f"{name}: tip less flight's", "difference, mm", lines)

    def shock(self, compared: Mapping[str, Any]) -> None:
        shock = compared.get("shock")
        if shock is None:
            return
        frequency, flight, machine = (np.array(shock[key]) for key in ("frequency", "flight", "centrifuge"))
        peaks = (np.array([[*compared[f"peak_{place}"].values()]]) for place in ("flight", "centrifuge"))
        for i in _moving(*peaks):
            lines = [
                {"label": compared["flight"], "x": frequency, "y": flight[:, i], **FLIGHT},
                {"label": compared["centrifuge"], "x": frequency, "y": machine[:, i], "colour": 1},
            ]
            title = f"Shock response of the tip along {'xyz'[i]}, Q {shock['quality']:g}"
            self._add(title, "acceleration, m/s²", lines, x="frequency, Hz", logX=True, logY=True)


def _moving(*values: Floats) -> list[int]:
    """Components that are more than a hundredth of the largest; the largest where none is."""
    size = np.max([np.nan_to_num(np.abs(each)).max(axis=0) for each in values], axis=0)
    return [i for i in range(3) if size[i] > SMALL * size.max()] or [int(size.argmax())]
