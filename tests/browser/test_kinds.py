"""Reports of every kind, each made once: looked at by axe, and printed by headless Chromium and read page by page."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from .axe import violations

A4 = (595.3, 841.9)  # points
MARGIN = 15 * 72 / 25.4
IMAGE = 3  # FPDF_PAGEOBJ_IMAGE


WORDS = "h1, h2, h3, figcaption, caption, summary, li, .badge, .verdict, .gbeam-wide :is(th, td), .u-label"
HEADS = "h2, h3, figcaption, caption, summary"


@dataclass
class Printed:
    """Faults of a page on screens of several widths, what it says there, and what is printed of it."""

    wrong: list[str]
    words: list[str]
    heads: list[str]
    scenario: str
    drawn: int
    document: Any


@pytest.fixture(scope="module")
def known() -> dict[Path, Printed]:
    """Pages that have been printed, each once."""
    return {}


@pytest.fixture
def printed(opened: Any, any_report: Path, known: dict[Path, Printed]) -> Printed:
    """A report of each kind, looked at in both colours and printed in dark ones."""
    pdfium = pytest.importorskip("pypdfium2")
    if any_report not in known:
        page, wrong = opened(any_report, color_scheme="dark"), []
        for width, scheme in ((360, "light"), (1200, "dark")):  # no colour depends on the width
            page.set_viewport_size({"width": width, "height": 900})
            page.emulate_media(color_scheme=scheme)
            wrong += [f"{width} {scheme}: {each}" for each in violations(page)]
            if (inside := page.evaluate("document.documentElement.scrollWidth")) > width:
                wrong.append(f"{width}: {inside} wide")
        page.evaluate("for (const each of document.querySelectorAll('.u-series:first-child')) each.remove()")  # of x
        known[any_report] = Printed(
            wrong,
            page.locator(WORDS).all_text_contents(),
            page.locator(HEADS).all_text_contents(),
            page.locator("details", has_text="Scenario file").locator("pre").text_content(),
            page.locator("figure").count() + page.locator(".gbeam-canvas").count(),
            pdfium.PdfDocument(page.pdf(prefer_css_page_size=True)),
        )
    return known[any_report]


def _words(text: str) -> str:
    """Without spaces and hyphens, at which paper breaks lines elsewhere."""
    return re.sub(r"[\s\u00ad\ufffe\x02-]", "", text)


def _texts(document: Any) -> list[str]:
    """The text of every page, without its number."""
    every = (document[i].get_textpage().get_text_range() for i in range(len(document)))
    return [
        re.sub(rf"^\s*{i} / {len(document)}\s|\s{i} / {len(document)}\s*$", "", each) for i, each in enumerate(every, 1)
    ]


def _pictures(document: Any) -> Iterator[tuple[float, float, float, float]]:
    """Left, bottom, right and top of every picture, points."""
    for i in range(len(document)):
        for each in document[i].get_objects(filter=[IMAGE]):
            yield each.get_bounds()


def _written(page: Any) -> list[tuple[float, float, float, float]]:
    """Left, bottom, right and top of every stretch of text, points."""
    text = page.get_textpage()
    return [text.get_rect(i) for i in range(text.count_rects())]


def test_axe_finds_nothing_in_any_kind_and_small_windows_hold_it(printed: Printed) -> None:
    assert printed.wrong == []


def test_everything_comes_out(printed: Printed) -> None:
    texts = _texts(printed.document)
    assert all(len(_words(each)) > 60 for each in texts)  # no page has its number alone
    whole = _words("".join(texts))
    assert len(printed.words) > 20 and len(printed.scenario.splitlines()) > 10
    for each in (*printed.words, *printed.scenario.splitlines()):
        assert _words(each) in whole, each
    large = [box for box in _pictures(printed.document) if box[2] - box[0] > 200]
    assert len(large) == printed.drawn
    for no in ("Drag across", "Theme", "Play", "Reset view", "Speed"):
        assert _words(no) not in whole


def test_pages_are_a4_with_white_margins_and_dark_ink(printed: Printed) -> None:
    document = printed.document
    scale = 2
    edge = int(scale * (MARGIN - 2))
    for i in range(len(document)):
        assert document[i].get_size() == pytest.approx(A4, abs=1.0)
        grey = np.asarray(document[i].render(scale=scale).to_pil().convert("L"), dtype=float)
        for margin in (grey[:, :edge], grey[:, -edge:], grey[:edge], grey[-edge // 2 :]):
            assert margin.min() > 250
        assert np.median(grey) > 250 and grey.min() < 90
        for left, _, right, _ in _written(document[i]):
            assert MARGIN - 1 <= left < right <= A4[0] - MARGIN + 1  # also where it would be clipped
    for left, bottom, right, top in _pictures(document):
        assert MARGIN - 1 <= left < right <= A4[0] - MARGIN + 1
        assert MARGIN - 1 <= bottom < top <= A4[1] - MARGIN + 1


def test_no_heading_ends_a_page(printed: Printed) -> None:
    heads = {_words(each) for each in printed.heads}
    for text in _texts(printed.document):
        assert _words(text.rstrip().splitlines()[-1]) not in heads


def test_a_page_is_after_a_print_as_it_was(opened: Any, report: Path) -> None:
    """With its colours, and what was folded folded."""
    page = opened(report, color_scheme="dark")
    before = _pixels(page)
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    assert page.locator("details:not([open])").count() == 0
    assert (_pixels(page) != before).mean() > 0.5  # light
    page.evaluate("dispatchEvent(new Event('afterprint'))")
    assert page.locator("details[open]").count() == 0
    assert (_pixels(page) != before).mean() < 1e-3  # the drawing of lines may differ by a rounding


def _pixels(page: Any) -> Any:
    page.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
    return np.asarray(Image.open(BytesIO(page.screenshot())).convert("L"))
