"""Faults that axe finds in a page for those who cannot see, or not well, or use no mouse."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest


def violations(page: Any) -> list[str]:
    """Rules of axe that a page breaks, each with the first element that does; skipped where axe is not installed."""
    answer = find_spec("axe_playwright_python")
    if answer is None or answer.origin is None:
        pytest.skip("axe-playwright-python is not installed")
    if not page.evaluate("() => 'axe' in window"):
        script = Path(answer.origin).with_name("axe.min.js").read_text(encoding="utf-8")
        page.evaluate(f"() => {{ {script}\n }}")
    # A page answers to a new size in the frame after.
    page.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
    result = page.evaluate("() => axe.run(document, {resultTypes: ['violations'], preload: false})")
    return [f"{each['id']}: {each['nodes'][0]['html'][:200]}" for each in result["violations"]]
