"""The pages of modes and of a Campbell diagram."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from gbeam.report.page.curves import REFERENCE
from gbeam.report.page.parts import heading, listed, paragraph, plot_places, table
from gbeam.report.page.scene import shape
from gbeam.report.page.series import Numbers, Plots
from gbeam.report.steady.modes import ROUNDING
from gbeam.report.words import number, percent
from gbeam.results.modal import near_multiples

Facts = Mapping[str, Any]

SHOWN = 33  # points of a mode shape in the viewer
_SIZES = {"width": 0.03, "thickness": 0.012}  # of the length: of a beam whose section a result does not hold


def modes_body(facts: Facts, _: Mapping[str, Any], numbers: Numbers, plots: Plots, header: dict[str, Any]) -> str:
    """Frequencies, damping and errors, and the shapes as they move."""
    base = facts["base"]
    rate = float(np.linalg.norm(list(base["angular_velocity"].values())))
    coupling = "in" if facts["gyroscopic"] else "left out"
    rate = rate if rate > 1e-9 else 0.0  # a profile's rounding
    where = f"motion {facts['motion']} at {number(facts['time'])} s, model {facts['model']}"
    parts = [paragraph(f"{where}, base turning at {number(rate)} rad/s, Coriolis coupling {coupling}")]
    growing = [
        f"{each['kind']} along {each['direction']}: grows by {number(each['growth_rate'])} per second"
        for each in facts["instabilities"]
    ]
    parts += [listed(growing, "bad"), heading("Modes"), modes_table(facts)]
    if not facts["damping_given"]:
        parts.append(paragraph("undamped: beam.damping_ratio is not given", "faint"))
    if facts["modes"]:
        header["modes"] = shapes(facts, numbers)
        parts += [heading("Shapes"), '<div id="gbeam-viewer"></div>']
        scale = "to scale" if facts.get("section", {}).get("width") else "not to scale: the result does not hold it"
        parts.append(paragraph(f"largest displacement 15 % of the length; the section is drawn {scale}", "faint"))
        x = np.array(facts["stations"])
        lines = [
            {"label": f"mode {i}, {number(each['frequency'])} Hz", "x": x, "y": _main(each), "colour": i - 1}
            for i, each in enumerate(facts["modes"][:6], 1)
        ]
        name = plots.add("Shapes", "displacement, largest 1", lines, x="position along the beam, m")
        parts.append(plot_places([(name, "Shapes along their main direction")]))
    return "".join(parts)


def campbell_body(facts: Facts, _: Mapping[str, Any], numbers: Numbers, plots: Plots, header: dict[str, Any]) -> str:
    """Frequencies against speed, the multiples of the speed, and where they meet."""
    speed = np.array(facts["speed"])
    tracks = [_numbers(each["frequency"]) for each in facts["tracks"]]
    shown = near_multiples(np.array(tracks), speed, facts["orders"])
    lines = [
        {
            "label": f"mode {i + 1}, along {facts['tracks'][i]['direction']}",
            "x": speed,
            "y": tracks[i],
            "colour": i % REFERENCE,
            "dash": i >= REFERENCE,
        }
        for i in shown
    ]
    top = max((np.nanmax(line["y"]) for line in lines if np.isfinite(line["y"]).any()), default=np.inf)
    for order in facts["orders"]:
        multiple = order * speed / (2 * np.pi)
        seen = np.where(multiple <= 1.05 * top, multiple, np.nan)
        lines.append({"label": f"{order} × speed", "x": speed, "y": seen, "colour": REFERENCE, "dash": True})
    if facts["crossings"]:
        at = [np.array([each[key] for each in facts["crossings"]]) for key in ("speed", "frequency")]
        order = np.argsort(at[0])
        lines.append({"label": "crossings", "x": at[0][order], "y": at[1][order], "colour": 1, "points": True})
    name = plots.add("Campbell diagram", "frequency, Hz", lines, x="speed, rad/s")
    parts = [heading("Campbell diagram"), plot_places([(name, f"{facts['motion']}: {facts['model']}")])]
    if len(shown) < len(tracks):
        parts.append(paragraph(f"modes not drawn, far above all multiples: {len(tracks) - len(shown)}", "faint"))
    if facts["critical_speed"] is not None:
        parts.append(paragraph(f"the equilibrium is lost at {number(facts['critical_speed'])} rad/s", "bad"))
    parts += [heading("Modes"), tracks_table(facts), heading("Crossings")]
    return "".join([*parts, crossings_table(facts) or paragraph("none in this range", "faint")])


def modes_table(facts: Facts) -> str:
    """Frequencies, damping ratios and errors."""
    rows = [
        [
            str(i),
            each["frequency"],
            percent(each["damping_ratio"] if abs(each["damping_ratio"]) > ROUNDING else 0.0),
            each["direction"],
            _error(each),
        ]
        for i, each in enumerate(facts["modes"], 1)
    ]
    return table(("mode", "frequency, Hz", "damping ratio", "along", "estimated error"), rows, words=(3,))


def tracks_table(facts: Facts) -> str:
    """First and last frequency of every mode of a Campbell diagram."""
    low, high = (f"Hz at {number(facts['speed'][at])} rad/s" for at in (0, -1))
    rows = [
        [str(i), each["direction"], each["frequency"][0], each["frequency"][-1], _error(each)]
        for i, each in enumerate(facts["tracks"], 1)
    ]
    return table(("mode", "along", low, high, "estimated error"), rows, words=(1,))


def crossings_table(facts: Facts) -> str:
    """Where multiples of the speed meet modes."""
    rows = [
        [
            str(each["track"] + 1),
            f"{each['order']} ×",
            each["speed"],
            60 * each["speed"] / (2 * np.pi),
            each["frequency"],
            _error(each),
        ]
        for each in facts["crossings"]
    ]
    heads = "mode", "multiple", "speed, rad/s", "speed, rpm", "frequency, Hz", "estimated error"
    return table(heads, rows)


def _error(facts: Facts) -> str:
    error = facts.get("error_estimate")
    return percent(np.nan if error is None else error)


def shapes(facts: Facts, numbers: Numbers) -> dict[str, Any]:
    """Shapes of every mode at some of the stations."""
    x = np.array(facts["stations"])
    some = np.unique(np.linspace(0, len(x) - 1, SHOWN).round().astype(int))
    section = facts.get("section", {})
    width, thickness = (
        np.array(section.get(key) or x[-1] * part * np.ones(len(x)))[some] for key, part in _SIZES.items()
    )
    parts = [
        np.array([[each[key][axis] for axis in "xyz"] for each in facts["modes"]])[:, :, some].transpose(0, 2, 1)
        for key in ("shape", "shape_imaginary")
    ]
    return {
        **shape(x[some], width, thickness, is_round=section.get("round", False)),
        "labels": [
            f"{i}: {number(each['frequency'])} Hz, {each['direction']}" for i, each in enumerate(facts["modes"], 1)
        ],
        "real": numbers.add(parts[0]),
        "imaginary": numbers.add(parts[1]),
    }


def _main(mode: Facts) -> Any:
    parts = [np.array(mode["shape"][axis]) for axis in "xyz"]
    return max(parts, key=lambda part: np.abs(part).max())


def _numbers(values: list[float | None]) -> Any:
    return np.array([np.nan if each is None else each for each in values])
