"""Headings, paragraphs, lists and tables of a page, with everything that comes from outside escaped."""

from __future__ import annotations

import html
import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from gbeam.printable import printable
from gbeam.report.words import number, sentence
from gbeam.results.imitation.criteria import GOOD


def escaped(text: object) -> str:
    """Text as HTML shows it, whatever is in it."""
    return html.escape(printable(str(text)))


@dataclass(frozen=True)
class Cell:
    """A cell of a table with a class, or a bar beside it."""

    text: str
    kind: str = ""  # good, bad or empty
    share: float = math.nan  # of the bar, 0 to 1; NaN for none


def heading(text: str, level: int = 2) -> str:
    """A heading."""
    return f"<h{level}>{escaped(text)}</h{level}>"


def section(title: str, inside: str) -> str:
    """A heading and what stands below it; nothing where there is nothing."""
    return heading(title) + inside if inside else ""


def paragraph(text: str, kind: str = "") -> str:
    """A paragraph, with a capital letter in front."""
    return f"<p{_class(kind)}>{escaped(sentence(text))}</p>"


def listed(lines: Iterable[str], kind: str = "") -> str:
    """A list; nothing where there is no line."""
    items = "".join(f"<li>{escaped(sentence(line))}</li>" for line in lines)
    return f"<ul{_class(kind)}>{items}</ul>" if items else ""


def folded(summary: str, inside: str) -> str:
    """Content that shows once its summary is clicked."""
    return f"<details><summary>{escaped(summary)}</summary>{inside}</details>"


def verbatim(text: str) -> str:
    """Text as it stands in a file."""
    return f"<pre>{escaped(text)}</pre>"


Value = Cell | str | float | None  # of a cell


def table(
    head: Sequence[str],
    rows: Iterable[Sequence[Value]],
    caption: str = "",
    words: Iterable[int] = (0,),
) -> str:
    """A table whose columns are numbers, to the right with four digits, but for those of `words`."""
    texts = set(words)
    cells = [[_cell(value, column not in texts) for column, value in enumerate(row)] for row in rows]
    if not cells:
        return ""
    top = "".join(
        f'<th scope="col"{_class("" if column in texts else "number")}>{_breaking(name)}</th>' if name else "<td></td>"
        for column, name in enumerate(head)
    )
    body = "".join(f"<tr>{''.join(row)}</tr>" for row in cells)
    title = f"<caption>{escaped(caption)}</caption>" if caption else ""
    top = f"<thead><tr>{top}</tr></thead>" if any(head) else ""
    return f'<div class="gbeam-wide"><table>{title}{top}<tbody>{body}</tbody></table></div>'


def _breaking(name: str) -> str:
    """The head of a column, whose path breaks between its words where the page is narrow."""
    return re.sub(r"(?<=[a-z\]])([._])(?=[a-z])", r"\1<wbr>", escaped(name))


def badge(state: str) -> str:
    """Outcome of a result, as a badge that must not be overlooked."""
    return f'<span class="badge {"good" if state in GOOD else "bad"}">{escaped(state)}</span>'


def plot_places(drawn: Iterable[tuple[str, str]]) -> str:
    """Places of plots, each by its id and title; nothing where there is none."""
    places = "".join(
        f'<figure><figcaption>{escaped(title)}</figcaption><div id="{escaped(name)}"></div></figure>'
        for name, title in drawn
    )
    return f'<div class="gbeam-plots">{places}</div>' if places else ""


def known(value: float | None) -> float:
    """A number of JSON, which has null for what is none."""
    return math.nan if value is None else float(value)


def _cell(value: Value, numeric: bool) -> str:
    kind = bar = ""
    if isinstance(value, Cell):
        kind = value.kind
        if math.isfinite(value.share):
            bar = f'<meter class="share" min="0" max="1" value="{min(value.share, 1.0):.3f}"></meter>'
        text = value.text
    elif value is None or isinstance(value, (int, float)):
        text = number(known(value))
    else:
        text = value
    names = " ".join(each for each in (kind, "number" if numeric else "") if each)
    inside = f"{bar}<span>{escaped(text)}</span>" if bar else escaped(text)
    return f"<td{_class(names)}>{inside}</td>"


def _class(names: str) -> str:
    return f' class="{names}"' if names else ""
