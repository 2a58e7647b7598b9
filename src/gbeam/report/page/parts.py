"""Headings, paragraphs, lists and tables of a page, with everything that comes from outside escaped."""

from __future__ import annotations

import html
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from gbeam.printable import printable
from gbeam.report.words import number, sentence


def escaped(text: object) -> str:
    """Text as HTML shows it, whatever is in it."""
    return html.escape(printable(str(text)))


@dataclass(frozen=True)
class Cell:
    """A cell of a table with a class, or a bar beside it.

    Parameters
    ----------
    text : str
    kind : str
        good, bad or empty.
    share : float
        Of the bar, 0 to 1; NaN for none.
    """

    text: str
    kind: str = ""
    share: float = math.nan


def heading(text: str, level: int = 2) -> str:
    """A heading."""
    return f"<h{level}>{escaped(text)}</h{level}>"


def paragraph(text: str, kind: str = "") -> str:
    """A paragraph, with a capital letter in front."""
    return f"<p{_class(kind)}>{escaped(sentence(text))}</p>"


def listed(lines: Iterable[str], kind: str = "") -> str:
    """A list; nothing where there is no line."""
    items = "".join(f"<li>{escaped(sentence(line))}</li>" for line in lines)
    return f"<ul{_class(kind)}>{items}</ul>" if items else ""


def folded(summary: str, inside: str) -> str:
    """What is shown once its summary is clicked."""
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
    made = [[_cell(value, column not in texts) for column, value in enumerate(row)] for row in rows]
    if not made:
        return ""
    top = "".join(
        f'<th scope="col"{_class("" if column in texts else "number")}>{escaped(name)}</th>' if name else "<td></td>"
        for column, name in enumerate(head)
    )
    body = "".join(f"<tr>{''.join(row)}</tr>" for row in made)
    title = f"<caption>{escaped(caption)}</caption>" if caption else ""
    return f'<div class="gbeam-wide"><table>{title}<thead><tr>{top}</tr></thead><tbody>{body}</tbody></table></div>'


def badge(text: str, good: bool) -> str:
    """A word that must not be overlooked."""
    return f'<span class="badge {"good" if good else "bad"}">{escaped(text)}</span>'


def plot_place(name: str, title: str) -> str:
    """Where a plot is drawn."""
    return f'<figure><figcaption>{escaped(title)}</figcaption><div id="{escaped(name)}"></div></figure>'


def _cell(value: Value, numeric: bool) -> str:
    kind = bar = ""
    if isinstance(value, Cell):
        kind = value.kind
        if math.isfinite(value.share):
            bar = f'<meter class="share" min="0" max="1" value="{min(value.share, 1.0):.3f}"></meter>'
        text = value.text
    elif value is None or isinstance(value, (int, float)):
        text = number(math.nan if value is None else float(value))
    else:
        text = value
    names = " ".join(each for each in (kind, "number" if numeric else "") if each)
    return f"<td{_class(names)}>{bar}{escaped(text)}</td>"


def _class(names: str) -> str:
    return f' class="{names}"' if names else ""
