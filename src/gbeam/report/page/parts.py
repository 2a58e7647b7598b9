"""Parts of a page, everything from outside escaped: headings, paragraphs, lists, tables, bars, and plots that zoom."""

from __future__ import annotations

import base64
import hashlib
import html
import math
import re
from collections.abc import Iterable, Iterator, Mapping
from itertools import groupby
from typing import Any

import numpy as np

from gbeam.figures.description import GREY, REFERENCE, Bars, Figure, Line, Map, Panel
from gbeam.numerics.samples import thinned
from gbeam.printable import printable
from gbeam.report.blocks import Block, Cell, Items, Place, Sentence, Table, Verbatim
from gbeam.report.words import number, sentence
from gbeam.results.criteria import GOOD
from gbeam.results.result import Floats


def escaped(text: object) -> str:
    """Return text as HTML shows it, whatever characters it has."""
    return html.escape(printable(str(text)))


def heading(text: str, level: int = 2) -> str:
    """A heading."""
    return f"<h{level}>{escaped(text)}</h{level}>"


def paragraph(text: str, kind: str = "") -> str:
    """A paragraph, with a capital letter in front."""
    return f"<p{_class(kind)}>{escaped(sentence(text))}</p>"


def draw_blocks(blocks: Iterable[Block], viewer: str, figures: str, level: int = 2) -> str:
    """Return blocks as HTML, under headings of a level. The viewer and the figures stand at their places."""
    groups = []
    for are_tables, group in groupby(blocks, lambda block: isinstance(block, Table)):
        parts = list(filter(None, (_draw_block(block, viewer, figures, level) for block in group)))
        side_by_side = are_tables and len(parts) > 1
        groups.append(f'<div class="gbeam-tables">{"".join(parts)}</div>' if side_by_side else "".join(parts))
    return "".join(groups)


def _draw_block(block: Block, viewer: str, figures: str, level: int) -> str:
    """HTML of one block, or empty if it has nothing to show."""
    match block:
        case Table():
            return table(block)
        case Sentence():
            return paragraph(block.text, block.tone)
        case Items():
            items = "".join(f"<li>{escaped(sentence(line))}</li>" for line in block.lines)
            return f"<ul{_class(block.tone)}>{items}</ul>" if items else ""
        case Verbatim():
            return f"<pre>{escaped(block.text)}</pre>"
        case Place():
            content = viewer if block.of == "viewer" else figures
            return (paragraph(block.hint, "faint gbeam-screen") if content and block.hint else "") + content
    inner = draw_blocks(block.blocks, viewer, figures, level + bool(block.title))
    if not inner:
        return ""
    if block.folded:
        return f"<details><summary>{escaped(block.folded)}</summary>{inner}</details>"
    return (heading(block.title, level) if block.title else "") + inner


def table(block: Table) -> str:
    """Return a table as HTML, with columns of numbers flush right, or empty if it has no rows."""
    if not block.rows:
        return ""
    numeric = [block.numeric(k) for k in range(len(block.heads))]
    top = ""
    for head, is_number in zip(block.heads, numeric, strict=True):
        style = _class("number" if is_number else "")
        top += f'<th scope="col"{style}>{_breaking(head)}</th>' if head else "<td></td>"
    body = "".join(f"<tr>{''.join(map(_cell, row, numeric))}</tr>" for row in block.rows)
    title = f"<caption>{escaped(block.caption)}</caption>" if block.caption else ""
    top = f"<thead><tr>{top}</tr></thead>" if any(block.heads) else ""
    return f'<div class="gbeam-wide"><table>{title}{top}<tbody>{body}</tbody></table></div>'


def _breaking(name: str) -> str:
    """The head of a column, whose path breaks between its words where the page is narrow."""
    return re.sub(r"(?<=[a-z\]])([._])(?=[a-z])", r"\1<wbr>", escaped(name))


def badge(state: str) -> str:
    """Outcome of a result, as a badge that must not be overlooked."""
    return f'<span class="badge {"good" if state in GOOD else "bad"}">{escaped(state)}</span>'


def _cell(cell: Cell, numeric: bool) -> str:
    content = escaped(cell.text)
    if math.isfinite(cell.share):
        bar = f'<meter class="share" min="0" max="1" value="{min(cell.share, 1.0):.3f}"></meter>'
        content = f"{bar}<span>{content}</span>"
    return f"<td{_class(' '.join(filter(None, (cell.tone, 'number' if numeric else ''))))}>{content}</td>"


def _class(names: str) -> str:
    return f' class="{names}"' if names else ""


def variables_under(place: str, variables: Mapping[str, Any]) -> dict[str, Any]:
    """Return the variables whose names begin with `place`, by the rest of their names."""
    return {name.removeprefix(place): variable for name, variable in variables.items() if name.startswith(place)}


COLUMNS = 600  # across a plot, of which a line has no more samples than show
Ref = dict[str, Any]  # where an array begins, and its shape


class Numbers:
    """Arrays one after the other."""

    def __init__(self) -> None:
        self._parts: list[np.ndarray[Any, np.dtype[np.float32]]] = []
        self._known: dict[tuple[bytes, tuple[int, ...]], Ref] = {}
        self._size = 0

    def add(self, values: Any) -> Ref:
        """Add an array and return a reference to it. Equal arrays are stored once."""
        part = np.ascontiguousarray(values, dtype="<f4")
        key = hashlib.sha256(part.tobytes()).digest(), part.shape
        if key not in self._known:
            self._known[key] = {"at": self._size, "shape": list(part.shape)}
            self._parts.append(part.ravel())
            self._size += part.size
        return self._known[key]

    @property
    def array(self) -> np.ndarray[Any, np.dtype[np.float32]]:
        """All arrays one after the other, flat."""
        return np.concatenate(self._parts) if self._parts else np.empty(0, dtype="<f4")

    def encoded(self) -> str:
        """All arrays one after the other, in base64."""
        return base64.b64encode(self.array.tobytes()).decode("ascii")


FITTING = 30  # letters beside an axis; of longer labels the caption has the quantity
_NUDGE = 1e-5  # of the whole width: places that are the same are drawn beside each other


def draw_figures(figures: Iterable[Figure], numbers: Numbers, header: dict[str, Any]) -> str:
    """Return the places of figures on a page. What is drawn there goes into `header`, its arrays into `numbers`."""
    return "".join(_figure(figure, numbers, header) for figure in figures)


def _figure(figure: Figure, numbers: Numbers, header: dict[str, Any]) -> str:
    """HTML of a figure, with places for its plots and maps. Their data are added to `header` and `numbers`."""
    notes = list(figure.notes)
    reasons = dict.fromkeys(reason for panel in figure.panels for *_, reason in panel.spans)
    if reasons:
        notes.append(f"grey: {', '.join(reasons)}")
    parts = [heading(figure.subject, 3), *(paragraph(note, "faint") for note in notes)]
    places = ""
    for panel in figure.panels:
        if panel.bars is None and panel.map is None:
            name, title = _plot(panel, figure.subject, numbers, header["plots"])
            places += f'<figure><figcaption>{escaped(title)}</figcaption><div id="{escaped(name)}"></div></figure>'
    parts.append(f'<div class="gbeam-plots">{places}</div>' if places else "")
    parts += [_table(panel, panel.bars) for panel in figure.panels if panel.bars is not None]
    parts += [_map(panel, panel.map, numbers, header["maps"]) for panel in figure.panels if panel.map is not None]
    return "".join(parts)


def _plot(panel: Panel, subject: str, numbers: Numbers, specs: list[dict[str, Any]]) -> tuple[str, str]:
    """Add the data of a panel to `specs` and `numbers`; return the id of its place in the page, and its caption."""
    place = f"plot-{len(specs)}"
    quantity, _, unit = panel.y.rpartition(", ")
    quantity = quantity or panel.y
    label = panel.y if len(panel.y) <= FITTING else unit
    low, high = panel.limits or (-np.inf, np.inf)
    series = []
    for look, x, y in _series(panel):
        series.append({**look, "x": numbers.add(x), "y": numbers.add(np.clip(y, low, high))})
    shaded = [[start, end] for start, end, _ in panel.spans] + [[mark.value, mark.value] for mark in panel.marks]
    levels = [{"label": level.label, "value": level.value} for level in panel.levels]
    title = f"{subject}: {panel.title or quantity}"
    spec: dict[str, Any] = {"id": place, "title": title, "x": panel.x, "y": label}
    spec |= {"time": panel.x == "time, s", "series": series, "bands": shaded, "levels": levels}
    specs.append(spec | ({"logX": True, "logY": True} if panel.logarithmic else {}))
    return place, "; ".join([": ".join(filter(None, (quantity, panel.title))), *_caption_words(panel)])


def _caption_words(panel: Panel) -> Iterator[str]:
    """Yield, in words, the marks, texts and ticks that Matplotlib would write into the plot."""
    for mark in panel.marks:
        yield f"{mark.label} at {number(mark.value)}"
    line_names = {line.label.removeprefix("_") for line in panel.lines}
    yield from (words for *_, words in panel.texts if words not in line_names)
    if panel.ticks:
        yield ", ".join(f"{k}: {word}" for k, word in enumerate(panel.ticks))


def _series(panel: Panel) -> Iterator[tuple[dict[str, Any], Floats, Floats]]:
    """Yield look, x and y of every line of a panel, including the edges of its areas."""
    for area in panel.areas:
        edges = {"lower end": area.low, "upper end": area.high} if np.any(area.low) else {"": area.high}
        for end, values in edges.items():
            label = ", ".join(filter(None, (area.label, end)))
            yield {"label": label, "colour": area.colour, "dash": bool(end)}, _ascending(area.x), values
    for line in panel.lines:
        yield _look(line, panel.y), *thinned(_ascending(line.x), line.y, COLUMNS)


def _look(line: Line, quantity: str) -> dict[str, Any]:
    """Look of a line for the page's script: its label, colour, breadth, dash and points."""
    look: dict[str, Any] = {"label": line.label.removeprefix("_") or quantity, "colour": min(line.colour, REFERENCE)}
    if line.broad:
        look["broad"] = True
    if line.dash != "solid" or line.colour == GREY:
        look["dash"] = True
    if line.marks == "supports":
        look["supports"] = True
    elif line.marks in ("dots", "rings") or len(line.x) == 1:
        look["points"] = True
    return look


def _ascending(x: Floats) -> Floats:
    """Return x with every value that repeats the one before moved on by a little."""
    repeated = np.concatenate([[False], np.diff(x) <= 0])
    return x + _NUDGE * np.ptp(x) * repeated if repeated.any() else x


def _table(panel: Panel, bars: Bars) -> str:
    """Table of bars: a row for each name, with its values, their intervals, and bars beside them."""
    sizes = [float(np.nanmax(np.abs(values), initial=0.0)) for values in bars.values.values()]
    largest = max(sizes, default=0.0) or 1.0

    def cell(label: str, k: int) -> Cell:
        value, words = bars.values[label][k], number(bars.values[label][k])
        if bars.low:
            words += f" ({number(bars.low[label][k])} to {number(bars.high[label][k])})"
        return Cell(words, share=abs(value) / largest)

    rows = tuple((Cell(name), *(cell(label, k) for label in bars.values)) for k, name in enumerate(bars.names))
    return table(Table((panel.x, *bars.values), rows, panel.title))


def _map(panel: Panel, cells: Map, numbers: Numbers, maps: list[dict[str, Any]]) -> str:
    """Add the data of a heat map to `maps` and `numbers`, and return its place in the page."""
    place = f"map-{len(maps)}"
    title, _, unit = cells.label.rpartition(", ")
    x = {"label": panel.x, "ticks": [f"{value:.6g}" for value in cells.x]}
    y = {"label": panel.y, "ticks": [f"{value:.6g}" for value in cells.y]}
    maps.append(
        {"id": place, "title": title or unit, "x": x, "y": y, "unit": unit if title else "",
         "values": numbers.add(cells.values), "outcomes": list(cells.outcome)}
    )  # fmt: skip
    return f'<div id="{place}"></div>'
