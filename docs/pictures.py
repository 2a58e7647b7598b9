"""Pictures of the README and of pages: the F-16, a held strip, and a board on rails."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from PIL import Image

import gbeam as gb

DOCS = Path(__file__).parent
EXAMPLE = DOCS.parent / "examples" / "f16_8g_turn.toml"
MIDDLE = "motion.centrifuge.control_point=150 mm"
G = 9.80665
FLIGHT, MACHINE, DARK, FAINT = "#9CC3E0", "#D55E00", "#333333", "#BBBBBB"
LARGER = 5.0  # the specimen beside the machine is drawn so many times as large
BENT = 20.0  # and its deflection so many times
STYLE = {
    "font.size": 9.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlesize": 9.0,
    "axes.titlelocation": "left",
    "legend.frameon": False,
    "legend.fontsize": 8.5,
}


def main(folder: Path = DOCS, frames: int = 96) -> None:
    """Draw all pictures, from the example and from it mounted by its middle."""
    study, by_the_middle = (
        gb.study(gb.read_scenario(EXAMPLE, overrides=changes))
        for changes in ((), (MIDDLE,))
    )
    with mpl.rc_context(STYLE):
        pictures = {
            "record": record(study),
            "machine": machine(study),
            "limits": limits(study),
            "verdict": verdict(study, by_the_middle),
        }
        for name, drawing in pictures.items():
            drawing.savefig(folder / f"f16_{name}.png", dpi=150)
        film(study, folder / "f16.gif", frames)
        held().savefig(folder / "held_at_both_ends.png", dpi=150)
        heated().savefig(folder / "heated.png", dpi=150)
        rails().savefig(folder / "board_on_rails.png", dpi=150)
        snapping().savefig(folder / "snapping_strip.png", dpi=150)
        warming().savefig(folder / "board_warms_up.png", dpi=150)
        linkage().savefig(folder / "slider_crank.png", dpi=150)
    tracking, tip = study.responses["centrifuge"].plot("tracking"), study.plot("tip")
    tracking[0].figure.savefig(folder / "f16_tracking.png", dpi=150)
    tip[0].figure.savefig(folder / "f16_tip.png", dpi=150)


def snapping() -> Figure:
    """Equilibria of a shallow strip under growing multiples of a turn."""
    case = gb.read_scenario(EXAMPLE.parent / "snapping_strip.toml")
    path = gb.equilibrium_path(
        case.subject,
        case.motions["turn"],
        0.5,
        vary="motion",
        upper=2.5,
        errors=False,
    )
    sunk = -1e3 * path.displacement[:, path.points.index("beam.contact"), 2]
    load = 8 * path.factor
    drawing = Figure(figsize=(6.4, 3.0), layout="constrained")
    axes = drawing.subplots()
    first, second = (
        int(np.argmin(abs(load - 8 * each.factor))) for each in path.critical
    )
    for part, dash in (
        (slice(None, first + 1), "-"),
        (slice(first, second + 1), "--"),
        (slice(second, None), "-"),
    ):
        axes.plot(sunk[part], load[part], dash, color=MACHINE, lw=1.6)
    for k, words, above in ((first, "snaps at", 7), (second, "snaps back at", 26)):
        axes.annotate(
            f"{words} {load[k]:.1f} g",
            (sunk[k], load[k]),
            xytext=(0, above),
            textcoords="offset points",
            ha="center",
        )
    axes.set(xlabel="the contact sinks by, mm", ylabel="load, g", ylim=(0, None))
    return drawing


def heated() -> Figure:
    """Lowest frequency of a strip between clamps and between pins as it warms."""
    strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    metal = gb.Material(2700, 70e9, poissons_ratio=0.33, expansion=23e-6)
    pin = gb.Support(0.0, ["x", "y", "z", "rx", "rz"])
    drawing = Figure(figsize=(6.4, 3.0), layout="constrained")
    axes = drawing.subplots()
    for words, supports, warmest, colour in (
        ("between clamps", [gb.Support(0.6, ["x", "z", "ry"])], 6.361, FLIGHT),
        ("between pins", [pin, gb.Support(0.6, ["x", "z"])], 1.589, MACHINE),
    ):
        rises = warmest - (warmest + 4.0) * np.linspace(1.0, 0.0, 25) ** 2
        frequency = []
        for rise in rises:
            warm = gb.Temperature(293.15 + rise, reference=293.15)
            beam = gb.Beam(0.6, strip, metal, supports=supports, temperature=warm)
            modes = gb.modes(gb.assemble(beam, "FOAM", axial=1, z=5))
            frequency.append(modes.frequency[0])
        axes.plot(20 + rises, frequency, color=colour, lw=1.6, label=words)
    axes.set(xlabel="temperature, °C", ylabel="lowest frequency, Hz", ylim=(0, None))
    axes.legend(frameon=False)
    return drawing


def held() -> Figure:
    """Deflection of a clamped strip against its load; one clamp slides or does not."""
    strip = gb.Section.rectangle(width=0.02, thickness=0.004)
    metal = gb.Material(2700, 70e9, poissons_ratio=0.33)
    loads = np.linspace(0.0, 60.0, 13)
    drawing = Figure(figsize=(6.4, 3.0), layout="constrained")
    axes = drawing.subplots()
    for words, holds, colour in (
        ("one clamp slides", ["z", "ry"], FLIGHT),
        ("both are fixed", ["x", "z", "ry"], MACHINE),
    ):
        beam = gb.Beam(0.6, strip, metal, supports=[gb.Support(0.6, holds)])
        model = gb.assemble(beam, "exact", axial=2, z=6)
        moved = [
            -1e3
            * gb.static(model, acceleration=(0.0, 0.0, G * load)).at("beam.span")[2]
            for load in loads
        ]
        axes.plot(loads, moved, color=colour, lw=1.6)
        axes.annotate(
            words,
            (loads[-1], moved[-1]),
            xytext=(-4, 4),
            textcoords="offset points",
            ha="right",
        )
    axes.set(
        xlabel="load, g",
        ylabel="deflection in the middle, mm",
        title="A strip of 600 mm by 20 mm by 4 mm, clamped at both ends",
        xlim=(0, loads[-1]),
    )
    axes.set_ylim(bottom=0)
    return drawing


def rails() -> Figure:
    """Forces of plug and rails on the board, across it, in the F-16's turn."""
    study = gb.study(gb.read_scenario(EXAMPLE.parent / "board_on_rails.toml"))
    response = study.responses["flight"]
    loads = response.body.loads
    drawing = Figure(figsize=(6.4, 3.0), layout="constrained")
    axes = drawing.subplots()
    for k, (name, colour) in enumerate(
        zip(loads.support_names, ("#009E73", MACHINE, "#0072B2"), strict=True)
    ):
        force = loads.support_force[:, k, 2]
        axes.plot(
            response.time, force, color=colour, lw=1.4, label=name.replace("_", " ")
        )
    axes.set(
        xlabel="time, s",
        ylabel="force across the board, N",
        title="A board of 280 g in its plug and rails, in the 8 g turn",
        xlim=(response.time[0], response.time[-1]),
    )
    axes.legend()
    return drawing


def warming() -> Figure:
    """Push of a rail on the board that warms up, and the frequency, by wedge lock."""
    drawing = Figure(figsize=(7.2, 3.0), layout="constrained")
    push, frequency = drawing.subplots(1, 2)
    stiffness = "bodies.board.supports[2].stiffness.y"
    for lock, colour in (
        ("0.5 MN/m", "#009E73"),
        ("2 MN/m", MACHINE),
        ("10 MN/m", "#0072B2"),
    ):
        path = EXAMPLE.parent / "board_warms_up.toml"
        scenario = gb.read_scenario(path, [f"{stiffness}={lock}"])
        system, flight = scenario.system, scenario.motions["flight"]
        time = np.linspace(0.0, 15.9, 54)
        rests = [gb.static(system, flight, time=t) for t in time]
        loads = [rest.bodies["board"].loads for rest in rests]
        force = [load.support_force[0, 2, 1] for load in loads]
        push.plot(time, np.abs(force), color=colour, lw=1.4, label=lock)
        warm = np.linspace(2.0, 14.0, 9)
        lowest = [gb.modes(system, time=t).frequency[0] for t in warm]
        degrees = 20 + 35 * (warm - 2) / 12
        frequency.plot(degrees, lowest, color=colour, lw=1.4, label=lock)
    push.set(
        xlabel="time, s",
        ylabel="push of the right rail along y, N",
        title="35 K in twelve seconds of the turn",
        xlim=(0, 16),
        ylim=(0, None),
    )
    frequency.set(
        xlabel="temperature of the board, °C",
        ylabel="lowest frequency, Hz",
        title="Its lowest frequency",
        ylim=(0, None),
    )
    frequency.legend(title="wedge lock", loc="lower left")
    return drawing


def linkage() -> Figure:
    """A slider-crank with a flexible rod, and the load in the joint that closes it."""
    case = gb.read_scenario(EXAMPLE.parent / "slider_crank.toml")
    response = gb.simulate(case.system, duration=0.2, initial="undeformed")
    drawing = Figure(figsize=(7.2, 3.0), layout="constrained")
    scene, load = drawing.subplots(1, 2)
    chosen = [np.argmin(abs(response.q[:, 0] - turn)) for turn in (19.4, 20.4, 23.0)]
    for step, colour in zip(chosen, ("#009E73", MACHINE, "#0072B2"), strict=True):
        names = "crank.root", "rod.root", "rod.tip"
        root, pin, tip = (1e3 * response.at(name)[step] for name in names)
        scene.plot(*zip(root[::2], pin[::2], strict=True), color=colour, lw=3)
        share = np.linspace(0.0, 1.0, 40)[:, None]
        sag = 1e3 * response.at("rod.middle")[step] - (pin + tip) / 2
        line = pin + share * (tip - pin)
        line = line + 4 * share * (1 - share) * LARGER * sag
        scene.plot(line[:, 0], line[:, 2], color=colour, lw=1.2)
        scene.plot(tip[0], tip[2], "s", color=colour, ms=7)
    scene.set(xlabel="x, mm", ylabel="z, mm", aspect="equal")
    scene.set_title(f"Crank, rod and piston; bending {LARGER:g} times")
    force = response.closures.force[:, 0]
    time = 1e3 * response.time
    load.plot(time, force[:, 0], color=MACHINE, lw=1.2, label="along")
    load.plot(time, force[:, 2], color="#0072B2", lw=1.2, label="across")
    title = "Force in the wrist, which closes the loop"
    load.set(xlabel="time, ms", ylabel="N", title=title)
    load.legend()
    return drawing


def record(study: Any) -> Figure:
    """Load of the flight in the specimen's axes, and idle."""
    flight, idle = study.responses["flight"], study.responses["centrifuge"].axes.idle
    load = flight.base.a_WO_B / G
    drawing = Figure(figsize=(7.2, 2.9), layout="constrained")
    axes = drawing.subplots()
    for k, colour in enumerate(("#009E73", "#CC79A7", "#0072B2")):
        axes.plot(flight.time, load[:, k], color=colour, lw=1.2, label=f"n_{'xyz'[k]}")
    axes.axhline(idle / G, color=DARK, ls="--", lw=0.8)
    axes.annotate(
        f"idle, {idle / G:.1f} g", (flight.time[-1], idle / G + 0.15), ha="right"
    )
    size = np.linalg.norm(load, axis=1)
    top = int(size.argmax())
    axes.annotate(
        f"{size[top]:.1f} g",
        (flight.time[top], size[top]),
        xytext=(4, 2),
        textcoords="offset points",
    )
    axes.set(
        xlabel="time, s",
        ylabel="load factor, g",
        title="The record: an F-16 in an 8 g turn",
        xlim=flight.time[[0, -1]],
    )
    axes.legend(ncols=3, loc="upper right")
    return drawing


def limits(study: Any) -> Figure:
    """Largest share that the machine uses of each of its limits."""
    uses = [
        use
        for use in study.responses["centrifuge"].axes.limits
        if np.isfinite(use.allowed)
    ]
    names = [f"{use.axis} {use.quantity}" for use in uses]
    written = [
        f"{figure(use.used)} of {figure(use.allowed)} {use.unit}" for use in uses
    ]
    written = [words.replace("^2", "²").replace("^3", "³") for words in written]
    title = "Largest use of the machine's limits"
    return bars(names, [use.share for use in uses], written, title, "#8FB4CC")


def figure(value: float) -> str:
    """Write a number with three digits and without an exponent."""
    return f"{value:,.0f}" if value >= 100 else f"{value:.3g}"


def bars(
    names: list[str], shares: list[float], written: list[str], title: str, colour: str
) -> Figure:
    """Bars of shares of limits, with a line at the limit and each value in words."""
    drawing = Figure(figsize=(7.2, 0.7 + 0.3 * len(names)), layout="constrained")
    axes = drawing.subplots()
    over = [share > 1 + 1e-9 for share in shares]
    colours = [MACHINE if each else colour for each in over]
    axes.barh(names, [100 * share for share in shares], color=colours, height=0.6)
    axes.axvline(100, color=DARK, lw=1.0)
    for k, (share, words) in enumerate(zip(shares, written, strict=True)):
        axes.annotate(
            words,
            (100 * share, k),
            xytext=(4, 0),
            textcoords="offset points",
            va="center",
        )
    axes.set(
        xlabel="share of the limit, %",
        title=title,
        xlim=(0, 175 * max(1, *shares)),
    )
    axes.invert_yaxis()
    axes.tick_params(axis="y", length=0)
    return drawing


def verdict(placed: Any, by_the_middle: Any) -> Figure:
    """Limits of acceptance as both mountings use them."""
    names, shares, written = [], [], []
    for where, study in (
        ("at 150 mm", by_the_middle),
        ("at 220 mm", placed),
    ):
        for each in study.comparisons[0].criteria:
            names.append(f"{each.words}, {where}")
            shares.append(each.use)
            missed = "" if each.passed else ", missed"
            written.append(f"{each.value_words} ({each.limit_written}{missed})")
    return bars(
        names,
        shares,
        written,
        "The verdict's limits, by the control point's place",
        "#7FB3A0",
    )


def machine(study: Any) -> Figure:
    """The machine at the largest load, with its axes named."""
    response = study.responses["centrifuge"]
    drawing = Figure(figsize=(7.2, 3.6), layout="constrained")
    axes = drawing.subplots()
    top = int(np.argmin(np.abs(response.time - 4.92)))
    tip, place = draw_machine(axes, response, top)
    hub, over = projected(np.zeros(3)), projected(np.array([0, 0, 1.2]))
    texts = {
        "axis 1 turns the arm": (over, (-1.6, 0.5)),
        "arm, 3.3 m": (0.5 * (hub + place), (0.2, 0.9)),
        "control point: axes 2 (yaw) and 3 (roll) meet here": (place, (-1.6, -2.0)),
        f"specimen, {LARGER:g} times as large": (tip, (0.5, 1.6)),
    }
    axes.annotate("", over, hub, arrowprops={"arrowstyle": "->", "color": DARK})
    for text, (point, away) in texts.items():
        axes.annotate(
            text,
            point,
            xytext=point + np.array(away),
            ha="center",
            arrowprops={"arrowstyle": "-", "color": DARK, "lw": 0.6},
        )
    axes.set_title("The machine at 4.92 s, where the load is largest")
    return drawing


def projected(points: Any) -> Any:
    """Points (..., 3) in axes of the room as seen from above one side, (..., 2)."""
    x, y, z = np.moveaxis(np.asarray(points, dtype=float), -1, 0)
    return np.stack([x, 0.42 * y + 0.9 * z], axis=-1)


def attitude(angles: Any) -> tuple[Any, Any]:
    """Direction of the arm, and the specimen's axes as columns, by the three angles."""
    first, second, third = angles
    up = np.array([0.0, 0.0, 1.0])
    out = np.array([np.cos(first), np.sin(first), 0.0])
    e1 = np.cos(second) * out + np.sin(second) * np.cross(up, out)
    across = np.cross(up, e1)
    e2 = np.cos(third) * across + np.sin(third) * up
    return out, np.stack([e1, e2, np.cross(e1, e2)], axis=1)


def draw_machine(axes: Axes, response: Any, i: int) -> tuple[Any, Any]:
    """Draw the machine at a sample; return the places of tip and control point."""
    machine = response.axes
    out, turned = attitude(machine.angle[i])
    place, around = machine.arm * out, np.linspace(0, 2 * np.pi, 121)
    circle = machine.arm * np.stack(
        [np.cos(around), np.sin(around), 0 * around], axis=1
    )
    axes.plot(*projected(circle).T, color=FAINT, lw=0.8, ls=":")
    axes.plot(*projected(np.array([[0, 0, -0.9], [0, 0, 0]])).T, color=FAINT, lw=8)
    axes.plot(*projected(np.stack([-0.25 * place, place])).T, color=DARK, lw=3)
    ends = LARGER * np.array(
        [-machine.control_point, float(response.stations[-1]) - machine.control_point]
    )
    half = 0.22
    corners = np.array(
        [
            (ends[0], -half, 0),
            (ends[1], -half, 0),
            (ends[1], half, 0),
            (ends[0], half, 0),
        ]
    )
    plate = place + corners @ turned.T
    axes.fill(*projected(plate).T, facecolor="#F3B88C", edgecolor=MACHINE, lw=1.2)
    axes.plot(*projected(plate[[0, 3]]).T, color=DARK, lw=3)  # the clamped end
    axes.plot(*projected(place), marker="o", color=DARK, ms=3)
    axes.set(xlim=(-4.6, 4.6), ylim=(-2.3, 2.3), aspect="equal")
    axes.axis("off")
    return projected(place + turned[:, 0] * ends[1]), projected(place)


def draw_specimen(axes: Axes, flown: Any, spun: Any, i: int, j: int) -> None:
    """Draw the specimen from its side, by a sample of either response."""
    shapes = {
        "in flight": (flown, i, FLIGHT, 7.0),
        "on the machine": (spun, j, MACHINE, 1.6),
    }
    for name, (response, k, colour, width) in shapes.items():
        x = 1e3 * np.append(0.0, response.stations)
        bent = BENT * 1e3 * np.append(0.0, response.displacement[k, :, 2])
        fine = np.linspace(0, x[-1], 61)
        curve = np.polyval(fitted(x, bent), fine)
        axes.plot(
            fine, curve, color=colour, lw=width, label=name, solid_capstyle="butt"
        )
    axes.plot([0, 0], [-14, 14], color=DARK, lw=4)
    axes.set(xlim=(-12, 330), ylim=(-62, 36), xlabel="along the specimen, mm")
    axes.set_yticks([])
    axes.spines["left"].set_visible(False)
    axes.set_title(f"The specimen, its deflection {BENT:g} times as large")
    axes.legend(loc="upper left", ncols=2)


def fitted(x: Any, bent: Any) -> Any:
    """Polynomial of fourth order through a clamped end and the stations."""
    powers = np.stack([x[1:] ** n for n in (4, 3, 2)], axis=1)
    return np.append(np.linalg.solve(powers, bent[1:]), [0.0, 0.0])


def film(study: Any, file: Path, frames: int) -> None:
    """Draw the machine's run from standstill to standstill as a moving picture."""
    flown, spun = study.responses["flight"], study.responses["centrifuge"]
    times = np.linspace(spun.time[0], spun.time[-1], frames)
    pictures = [_frame(flown, spun, time) for time in times]
    palette = pictures[frames // 2].quantize(48, dither=Image.Dither.NONE)
    still = [
        each.quantize(palette=palette, dither=Image.Dither.NONE) for each in pictures
    ]
    still[0].save(
        file,
        save_all=True,
        append_images=still[1:],
        duration=110,
        loop=0,
        optimize=True,
    )


def _frame(flown: Any, spun: Any, time: float) -> Image.Image:
    """One picture of the film: machine, specimen, and the load over time."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    drawing = Figure(figsize=(8.4, 4.4), dpi=100, facecolor="white")
    canvas = FigureCanvasAgg(drawing)
    left, right = (
        drawing.add_axes((0.01, 0.36, 0.47, 0.57)),
        drawing.add_axes((0.52, 0.45, 0.46, 0.45)),
    )
    below = drawing.add_axes((0.07, 0.11, 0.91, 0.2))
    j = int(np.argmin(np.abs(spun.time - time)))
    i = int(np.argmin(np.abs(flown.time - np.clip(time, *flown.time[[0, -1]]))))
    draw_machine(left, spun, j)
    left.set_title(
        f"The machine at {time:.1f} s, its specimen {LARGER:g} times as large"
    )
    draw_specimen(right, flown, spun, i, j)
    loads = (
        (flown.time, flown.base.a_WO_B, FLIGHT, 4.0, "flight"),
        (spun.time, spun.axes.actual, MACHINE, 1.0, "machine, at the control point"),
    )
    for times, load, colour, width, name in loads:
        size = np.linalg.norm(load, axis=1) / G
        below.plot(times[::8], size[::8], color=colour, lw=width, label=name)
    below.axvline(time, color=DARK, lw=1.0)
    felt = float(np.linalg.norm(spun.axes.actual[j])) / G
    right.annotate(
        f"load {felt:.1f} g", (1, 1.04), xycoords="axes fraction", ha="right"
    )
    below.set(xlabel="time, s", ylabel="load, g", ylim=(0, 9), xlim=spun.time[[0, -1]])
    below.legend(loc="upper right")
    canvas.draw()
    return Image.fromarray(np.asarray(canvas.buffer_rgba())[..., :3])


if __name__ == "__main__":
    main(*(Path(each) for each in sys.argv[1:2]))
